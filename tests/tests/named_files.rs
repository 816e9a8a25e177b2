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
