//! Every kind of diagnostic has a file that gets it, and what its reader sees is a snapshot.
//!
//! A file in `bad/` is named for the code that it must get, perhaps with a word more: `wrong-kind-number.yaml`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use armgen_codegen::diagnostic::{Code, Colour, Diagnostics, Severity};
use armgen_codegen::source::Source;
use armgen_codegen::validate;

/// Files that show how several kinds of faults come out together.
const MIXED: [&str; 2] = ["many-faults", "windows-lines-and-umlauts"];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("bad")
}

fn stems() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).expect("the folder of bad files");
    let mut stems: Vec<String> = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
        .map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned())
        .collect();
    stems.sort();
    stems
}

fn read(stem: &str) -> (Source, bool, Diagnostics) {
    let name = format!("{stem}.yaml");
    let text = std::fs::read_to_string(folder().join(&name)).expect("a readable file");
    let source = Source::new(name, text);
    let (valid, diagnostics) = validate::read(&source);
    (source, valid.is_some(), diagnostics)
}

/// The code that a file is named for.
fn code_of(stem: &str) -> Option<Code> {
    let fits = |code: &&Code| stem.strip_prefix(code.name()).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'));
    Code::ALL.iter().filter(fits).max_by_key(|code| code.name().len()).copied()
}

#[test]
fn every_bad_file_is_told_what_is_wrong() {
    for stem in stems() {
        let (source, valid, diagnostics) = read(&stem);
        let rendered = diagnostics.render(&source, Colour::Never);
        assert_eq!(valid, !diagnostics.has_errors(), "{rendered}");
        if !MIXED.contains(&stem.as_str()) {
            let code = code_of(&stem).unwrap_or_else(|| panic!("no code is called as {stem}.yaml is"));
            assert!(diagnostics.iter().any(|d| d.code == code), "{stem}.yaml does not get {code}:\n{rendered}");
            assert_eq!(diagnostics.has_errors(), code.severity() == Severity::Error, "{rendered}");
        }
        // Each one with place, source line and help, and the place is that of its first label.
        let parts: Vec<&str> = rendered.trim_end().split("\n\n").filter(|part| !part.is_empty()).collect();
        assert_eq!(parts.len(), diagnostics.iter().count(), "{rendered}");
        for (part, diagnostic) in parts.iter().zip(diagnostics.iter()) {
            let place = source.place(diagnostic.span().start);
            assert!(part.contains(&format!("--> {}:{place}\n", source.name())), "{part}");
            assert!(part.contains("\n  = help: ") || part.contains(" = help: "), "{part}");
            let line = source.text().lines().nth(place.line - 1).unwrap_or("").trim();
            // Long lines are cut, control characters made visible.
            assert!(line.len() > 80 || line.contains(char::is_control) || part.contains(line), "{part}");
            assert!(!diagnostic.help.is_empty() && !diagnostic.message.is_empty());
        }
        insta::with_settings!({ omit_expression => true, prepend_module_to_snapshot => false, snapshot_path => "../bad/snapshots" }, {
            insta::assert_snapshot!(stem.as_str(), rendered);
        });
    }
}

#[test]
fn every_code_has_a_bad_file() {
    let with_file: BTreeSet<Code> = stems().iter().filter_map(|stem| code_of(stem)).collect();
    let without: Vec<&Code> = Code::ALL.iter().filter(|code| !with_file.contains(code)).collect();
    assert!(without.is_empty(), "no bad file for {without:?}");
    assert!(stems().len() >= 45);
}

#[test]
fn all_faults_of_a_file_come_in_one_go() {
    let (_, _, diagnostics) = read("many-faults");
    assert_eq!((diagnostics.errors(), diagnostics.warnings()), (17, 2));
    let places: Vec<usize> = diagnostics.iter().map(|d| d.span().start).collect();
    assert!(places.is_sorted());
}
