//! The site of docs/build: every link of its pages leads to a file and a heading.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::installed;
use crate::languages::folder;

/// Pages in a folder and in those within it.
fn pages(folder: &Path, found: &mut BTreeMap<PathBuf, String>) {
    for path in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            pages(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "html") {
            let text = fs::read_to_string(&path).expect("a page");
            found.insert(path.canonicalize().expect("it is there"), text);
        }
    }
}

/// The values of an attribute.
fn values<'t>(text: &'t str, attribute: &'t str) -> impl Iterator<Item = &'t str> {
    text.split(attribute).skip(1).filter_map(|rest| rest.split('"').next())
}

#[test]
#[ignore = "wide"]
fn links_of_the_site_lead_somewhere() {
    if !installed::runs("mdbook", &["--version"]) {
        return installed::left_out("no `mdbook` here (cargo install mdbook)");
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let out = folder("site");
    let built = Command::new("docs/build")
        .current_dir(&root)
        .arg("--out")
        .arg(&out)
        .env("ARMGEN", env!("CARGO_BIN_EXE_armgen"))
        .output()
        .expect("docs/build runs");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let mut all = BTreeMap::new();
    pages(&out, &mut all);
    let anchors: BTreeMap<&PathBuf, BTreeSet<&str>> =
        all.iter().map(|(path, text)| (path, values(text, " id=\"").collect())).collect();
    let (mut count, mut lost) = (0, Vec::new());
    for (path, text) in &all {
        // One page for the printer and one for lost addresses are mdBook's own; robots and playground have tests of their own.
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if ["print.html", "404.html", "armgen-playground.html"].contains(&&*name)
            || path.parent().is_some_and(|p| p.ends_with("pages"))
        {
            continue;
        }
        for link in values(text, "href=\"").chain(values(text, "src=\"")) {
            if link.starts_with("https:") || link.starts_with("data:") {
                continue;
            }
            count += 1;
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target =
                if file.is_empty() { Some(path.clone()) } else { path.with_file_name("").join(file).canonicalize().ok() };
            let leads = target
                .is_some_and(|target| anchor.is_empty() || anchors.get(&target).is_some_and(|anchors| anchors.contains(anchor)));
            if !leads {
                lost.push(format!("{}: {link}", path.display()));
            }
        }
    }
    assert!(lost.is_empty(), "{}", lost.join("\n"));
    assert!(count > 1000, "{count} links");
    // Every page of the documentation is in the book.
    for page in fs::read_dir(root.join("docs")).expect("docs").map(|entry| entry.expect("an entry").path()) {
        let name = page.with_extension("html");
        let name = name.file_name().unwrap_or_default();
        let is_page = page.extension().is_some_and(|extension| extension == "md") && !page.ends_with("SUMMARY.md");
        assert!(!is_page || out.join("docs").join(name).is_file(), "docs/SUMMARY.md has no {}", page.display());
    }
}
