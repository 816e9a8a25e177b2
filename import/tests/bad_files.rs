//! Every code has a file that gets it, named for the code, perhaps with a word more; what its reader sees is a snapshot.
//! A first line `<!-- options: tip two; lock joint=1 -->` holds the options with which it is imported.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use armgen_codegen::description::Convention;
use armgen_codegen::diagnostic::{Colour, Diagnostics, Severity};
use armgen_codegen::source::Source;
use armgen_import::{import, Code, Options};

/// Codes of texts that are too long to keep.
const GENERATED: [Code; 1] = [Code::TooLarge];

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).expect("the folder").map(|e| e.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "urdf" || e == "xml"));
    files.sort();
    files
}

fn options(text: &str) -> Options {
    let mut options = Options::default();
    let Some((words, _)) = text.strip_prefix("<!-- options: ").and_then(|rest| rest.split_once(" -->")) else { return options };
    for option in words.split("; ") {
        match option.split_once(' ') {
            Some(("base", link)) => options.base = Some(link.into()),
            Some(("tip", link)) => options.tip = Some(link.into()),
            Some(("lock", lock)) => options.lock.extend(lock.split_once('=').map(|(joint, value)| (joint.into(), value.into()))),
            Some(("convention", "standard")) => options.convention = Convention::Standard,
            None if option == "massless" => options.massless = true,
            None if option == "inertia-as-written" => options.inertia_as_written = true,
            other => panic!("{other:?}"),
        }
    }
    options
}

fn read(path: &Path) -> (Source, bool, Diagnostics) {
    let text = std::fs::read_to_string(path).expect("a readable file");
    let options = options(&text);
    let source = Source::new(path.file_name().expect("a name").to_string_lossy(), text);
    let (imported, diagnostics) = import(&source, &options);
    (source, imported.is_some(), diagnostics)
}

fn code_of(path: &Path) -> Code {
    let stem = path.file_stem().expect("a name").to_string_lossy();
    let fits = |code: &&Code| stem.strip_prefix(code.name()).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'));
    *Code::ALL.iter().filter(fits).max_by_key(|code| code.name().len()).unwrap_or_else(|| panic!("no code is called as {stem}"))
}

#[test]
fn every_bad_file_is_told_what_is_wrong() {
    for path in files() {
        let (source, imported, diagnostics) = read(&path);
        let rendered = diagnostics.render(&source, Colour::Never);
        let code = code_of(&path);
        assert_eq!(imported, !diagnostics.has_errors(), "{rendered}");
        assert!(diagnostics.iter().any(|d| d.code == code), "{} does not get {code}:\n{rendered}", source.name());
        assert_eq!(diagnostics.has_errors(), code.severity() == Severity::Error, "{}:\n{rendered}", source.name());
        assert!(diagnostics.iter().all(|d| !d.help.is_empty()), "{rendered}");
        insta::with_settings!({prepend_module_to_snapshot => false, snapshot_path => "bad/snapshots", omit_expression => true}, {
            insta::assert_snapshot!(path.file_stem().expect("a name").to_string_lossy().as_ref(), rendered);
        });
    }
}

#[test]
fn every_code_has_a_bad_file() {
    let with_file: BTreeSet<Code> = files().iter().map(|path| code_of(path)).chain(GENERATED).collect();
    let without: Vec<&Code> = Code::ALL.iter().filter(|code| !with_file.contains(code)).collect();
    assert!(without.is_empty(), "no bad file for {without:?}");
}

/// The first columns of the tables of docs/import.md are the codes, errors and warnings, and no others.
#[test]
fn the_page_names_every_code() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/import.md")).expect("the page");
    let section = page.split("\n## ").find(|section| section.starts_with("What is refused\n")).expect("the section");
    let (refused, warned) = section.split_once("Warnings leave the arm valid").expect("the warnings");
    let named = |text: &str| -> BTreeSet<String> {
        let rows = text.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
        rows.flat_map(|cell| cell.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>()).collect()
    };
    for (text, severity) in [(refused, Severity::Error), (warned, Severity::Warning)] {
        let codes = Code::ALL.iter().filter(|code| code.severity() == severity).map(|code| code.name().to_owned());
        assert_eq!(named(text), codes.collect::<BTreeSet<String>>());
    }
}
