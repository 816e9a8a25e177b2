//! Files that the documentation names are there.

use std::fs;
use std::path::{Path, PathBuf};

/// Pages for users and for those who work on the code.
fn pages(root: &Path) -> Vec<PathBuf> {
    let mut pages: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].iter().map(|name| root.join(name)).collect();
    let mut folders = vec![root.join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else if entry.extension().is_some_and(|extension| extension == "md") {
                pages.push(entry);
            }
        }
    }
    pages
}

/// Paths of sources in a text: words that begin with a crate's folder and end with `.rs`.
fn sources(text: &str) -> impl Iterator<Item = &str> {
    const FOLDERS: [&str; 8] =
        ["algebra/src/", "codegen/src/", "verify/src/", "runtime/src/", "experiments/src/", "cli/", "tests/src/", "tests/tests/"];
    text.split(|c: char| !(c.is_ascii_alphanumeric() || "_-./".contains(c)))
        .filter(|word| word.ends_with(".rs") && FOLDERS.iter().any(|folder| word.starts_with(folder)))
}

#[test]
fn files_that_pages_name_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("in the workspace");
    let mut named = 0;
    for page in pages(root) {
        let text = fs::read_to_string(&page).expect("a text");
        for source in sources(&text) {
            assert!(root.join(source).is_file(), "{} names {source}, which is not there", page.display());
            named += 1;
        }
    }
    assert!(named > 10, "pages name {named} files: their form has changed");
}

/// Files of Rust in a folder and in those within it.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let name = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if entry.is_dir() && name != "target" && !name.starts_with('.') {
            files(&entry, found);
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            found.push(entry);
        }
    }
}

/// A test that `cargo test` leaves out is run by somebody: CONTRIBUTING.md has the command of its target.
#[test]
fn ignored_tests_have_a_command() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("in the workspace");
    let page = fs::read_to_string(root.join("CONTRIBUTING.md")).expect("a page");
    let commands: Vec<&str> = page.lines().filter(|line| line.contains("cargo test") && line.contains("-- --ignored")).collect();
    let mut all = Vec::new();
    files(root, &mut all);
    let mut ignored = 0;
    for path in all {
        let text = fs::read_to_string(&path).expect("a text");
        ignored += text.lines().filter(|line| line.trim_start().starts_with("#[ignore")).count();
        if text.lines().any(|line| line.trim_start().starts_with("#[ignore")) {
            // CRATE/tests/TARGET.rs or CRATE/tests/TARGET/FILE.rs.
            let relative = path.strip_prefix(root).expect("in the project").to_string_lossy().into_owned();
            let (package, target) = relative.split_once("/tests/").expect("an ignored test stands in a folder of tests");
            let target = target.split(['/', '.']).next().expect("a name");
            let wanted = format!("-p armgen-{package} --test {target} ");
            assert!(commands.iter().any(|command| command.contains(&wanted)), "{relative}: no command with `{wanted}`");
        }
    }
    assert!(ignored > 3, "{ignored} tests are ignored: their form has changed");
}
