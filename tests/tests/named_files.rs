//! Files that the documentation names are there.

use std::collections::{BTreeMap, BTreeSet};
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

/// Every test has a tier: *fast* without a mark, *wide* by `#[ignore = "wide"]`, *full* by `#[ignore = "full: REASON"]`. `.ci/run` skips
/// the full tests by name, and CONTRIBUTING.md has a command for each of them.
#[test]
fn ignored_tests_have_a_command() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("in the workspace");
    let page = fs::read_to_string(root.join("CONTRIBUTING.md")).expect("a page");
    let script = fs::read_to_string(root.join(".ci/run")).expect("a script");
    let skipped: Vec<&str> = script.split("--skip ").skip(1).filter_map(|rest| rest.split_whitespace().next()).collect();
    let mut all = Vec::new();
    files(root, &mut all);
    let (mut wide, mut full) = (0, Vec::new());
    for path in all {
        let text = fs::read_to_string(&path).expect("a text");
        let mut lines = text.lines().map(str::trim);
        while let Some(line) = lines.next() {
            if line == "#[ignore = \"wide\"]" {
                wide += 1;
            } else if line.starts_with("#[ignore") {
                assert!(line.starts_with("#[ignore = \"full: "), "{}: `{line}` is no tier", path.display());
                let name = lines.find_map(|line| line.strip_prefix("fn ")?.split('(').next()).expect("a test");
                assert!(skipped.contains(&name), ".ci/run runs {name}, which is full");
                assert!(page.contains(&format!(" {name}`")), "CONTRIBUTING.md has no command for {name}");
                full.push(name.to_owned());
            }
        }
    }
    for name in &skipped {
        assert!(full.iter().any(|full| full == name), ".ci/run skips {name}, which is not full");
    }
    assert!(wide > 50 && full.len() > 3, "{wide} wide and {} full tests: their form has changed", full.len());
}

/// A crate's integration tests are one program, so a file without a line in `tests/main.rs` would not be compiled.
#[test]
fn files_of_tests_are_modules() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("in the workspace");
    let mut all = Vec::new();
    files(root, &mut all);
    let mut programs = 0;
    for main in all.iter().filter(|path| path.ends_with("tests/main.rs")) {
        programs += 1;
        let text = fs::read_to_string(main).expect("a text");
        for path in all.iter().filter(|path| path.parent() == main.parent() && *path != main) {
            let module = format!("mod {};", path.file_stem().expect("a name").to_string_lossy());
            assert!(text.lines().any(|line| line == module), "{}: no line `{module}`", main.display());
        }
    }
    assert!(programs > 5, "{programs} crates have one program of tests: their form has changed");
}

/// The tables of a manifest whose heads begin with this, without comments.
fn tables(manifest: &str, head: &str) -> BTreeMap<String, Vec<String>> {
    let mut found = BTreeMap::new();
    let mut open = None;
    for line in manifest.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        if line.starts_with('[') {
            open = line.starts_with(head).then(|| line.to_owned());
        }
        if let Some(name) = &open {
            found.entry(name.clone()).or_insert_with(Vec::new).extend((line != name).then(|| line.to_owned()));
        }
    }
    found
}

/// Cargo compiles a dependency again where its profile or version differs. It compiles the crates of this repository for each workspace anyway.
#[test]
fn the_package_of_python_shares_compiled_crates() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("in the workspace");
    let read = |file: &str| fs::read_to_string(root.join(file)).expect("a text");
    let (own, of_python) = ("Cargo.toml", "python/Cargo.toml");
    let (own, of_python) = (tables(&read(own), "[profile.dev"), tables(&read(of_python), "[profile.dev"));
    let versions = |lock: &str| -> BTreeMap<String, BTreeSet<String>> {
        let mut found = BTreeMap::new();
        for package in read(lock).split("[[package]]").skip(1) {
            let value = |key: &str| package.lines().find_map(|line| line.strip_prefix(key)).expect("a key").to_owned();
            found.entry(value("name = ")).or_insert_with(BTreeSet::new).insert(value("version = "));
        }
        found
    };
    let (versions, of_lock) = (versions("Cargo.lock"), versions("python/Cargo.lock"));
    let ours = |head: &str| head.contains("package.armgen");
    let (own, of_python): (Vec<_>, Vec<_>) =
        (own.iter().filter(|(head, _)| !ours(head)).collect(), of_python.iter().filter(|(head, _)| !ours(head)).collect());
    let needed = |head: &str| {
        let package = head.strip_prefix("[profile.dev.package.").and_then(|rest| rest.strip_suffix(']'));
        package.is_none_or(|package| package == "\"*\"" || of_lock.contains_key(&format!("\"{package}\"")))
    };
    let own: Vec<_> = own.into_iter().filter(|(head, _)| needed(head)).collect();
    assert!(own == of_python && own.len() > 10, "python/Cargo.toml: profiles of dependencies are not those of Cargo.toml");
    for (name, locked) in of_lock {
        if let Some(known) = versions.get(&name) {
            assert!(locked.is_subset(known), "python/Cargo.lock: {name} {locked:?}, and Cargo.lock has {known:?}");
        }
    }
}
