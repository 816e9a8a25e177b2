//! The texts are what is compiled and tested, and say what they need.

use armgen_inverse_kinematics::texts::TEXTS;
use std::collections::{BTreeMap, BTreeSet};

/// The code of a text, without comments.
fn code(source: &str) -> String {
    source.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The words of a text's code.
fn words(code: &str) -> Vec<&str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty()).collect()
}

/// The names that a text uses: words with a capital letter, and functions that are called or handed on.
fn used(code: &str) -> BTreeSet<&str> {
    let called = |word: &&str| {
        let after = |sign| code.match_indices(&format!("{word}{sign}")).any(|(at, _)| !code[..at].ends_with(is_word));
        word.contains(|c: char| c.is_uppercase()) || after("(") || after("::<")
    };
    words(code).into_iter().collect::<BTreeSet<_>>().into_iter().filter(called).collect()
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

/// The names of a text's items, those of methods aside.
fn items(source: &str) -> BTreeSet<&str> {
    let mut items = BTreeSet::new();
    for line in source.lines().filter(|line| !line.starts_with(' ')) {
        let mut words = words(line).into_iter().skip_while(|word| *word == "pub");
        if let (Some("fn" | "struct" | "enum" | "const" | "type" | "static"), Some(name)) = (words.next(), words.next()) {
            items.insert(name);
        }
    }
    items
}

#[test]
fn a_text_needs_what_it_names() {
    let scalars = ["scalar_f64", "scalar_f32"];
    let mut reached: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (i, text) in TEXTS.iter().enumerate() {
        // All that it needs, and that those need; they come before it.
        let mut all: BTreeSet<&str> = [text.name, "scalar_f64"].into();
        for need in text.needs {
            assert!(TEXTS[..i].iter().any(|t| t.name == *need), "{} needs {need}, which does not come before it", text.name);
            all.extend(&reached[need]);
        }
        let code = code(text.source);
        let words = used(&code);
        for other in TEXTS.iter().filter(|other| !all.contains(other.name) && !scalars.contains(&other.name)) {
            let named: Vec<_> = items(other.source).intersection(&words).copied().collect();
            // A closure may have the name of another text's function.
            let local = |name: &str| code.contains(&format!("let {name} = |"));
            let named: Vec<_> = named.into_iter().filter(|name| !local(name)).collect();
            assert!(named.is_empty(), "{} names {named:?} of {}", text.name, other.name);
        }
        // A text that is needed is used.
        for need in text.needs {
            let Some(other) = TEXTS.iter().find(|t| t.name == *need) else { continue };
            let used = !items(other.source).is_disjoint(&words);
            assert!(used || *need == "branches" || *need == "frame", "{} does not use {need}", text.name);
        }
        reached.insert(text.name, all);
    }
}

#[test]
fn texts_are_items_with_outer_attributes() {
    for text in TEXTS {
        assert!(!text.source.contains("#![") && !text.source.contains("//!"), "{}", text.name);
        let code = code(text.source);
        assert!(!words(&code).contains(&"unsafe") && !words(&code).contains(&"std"), "{}", text.name);
        assert!(!items(text.source).is_empty(), "{}", text.name);
    }
}

/// Two texts of one module may not define the same name.
#[test]
fn names_are_defined_once() {
    let mut known = BTreeMap::new();
    for text in TEXTS.iter().filter(|text| text.name != "scalar_f32") {
        for item in items(text.source) {
            if let Some(other) = known.insert(item, text.name) {
                panic!("{item} is defined by {other} and by {}", text.name);
            }
        }
    }
}

#[test]
fn every_file_is_a_text() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/blocks");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    files.sort();
    let mut names: Vec<&str> = TEXTS.iter().map(|text| text.name).collect();
    names.sort_unstable();
    assert_eq!(files, names);
}
