//! The examples of docs/robot-yaml.md are read without a fault, and that page and docs/diagnostics.md name every kind of diagnostic.
//!
//! A block is a whole robot (`yaml robot`), keys of the file (`yaml top`) or keys of a joint (`yaml joint`).

use std::path::Path;

use armgen_codegen::diagnostic::{Code, Colour};
use armgen_codegen::source::Source;
use armgen_codegen::validate;

const TOP: [(&str, &str); 4] =
    [("name", "name: arm"), ("convention", "convention: standard"), ("gravity", "gravity: [0, 0, -9.81]"), ("parameters", "")];
const JOINT: [(&str, &str); 7] = [
    ("name", "name: shoulder"),
    ("type", "type: revolute"),
    ("a", "a: 0.5"),
    ("alpha", "alpha: 0"),
    ("d", "d: 0"),
    ("theta", "theta: 0"),
    ("link", "link: {mass: 2, com: [-0.25, 0, 0], inertia: {xx: 1, yy: 1, zz: 1}}"),
];

fn page() -> String {
    text("robot-yaml.md")
}

fn text(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name)).expect("the page")
}

/// The blocks, each with its kind.
fn blocks(page: &str) -> Vec<(String, String)> {
    let mut blocks: Vec<(String, String)> = Vec::new();
    let mut open = false;
    for line in page.lines() {
        match line.strip_prefix("```") {
            Some(kind) if !open => {
                open = true;
                blocks.push((kind.to_owned(), String::new()));
            }
            Some(_) => open = false,
            None if open => {
                let (_, text) = blocks.last_mut().expect("a block is open");
                text.push_str(line);
                text.push('\n');
            }
            None => {}
        }
    }
    blocks
}

/// The lines of `defaults` that `text` does not give itself, with `text` after them.
fn completed(defaults: &[(&str, &str)], text: &str) -> String {
    let given = |key: &str| text.lines().any(|line| line.split(':').next() == Some(key));
    let missing: Vec<&str> =
        defaults.iter().filter(|(key, line)| !given(key) && !line.is_empty()).map(|(_, line)| *line).collect();
    format!("{}\n{text}", missing.join("\n"))
}

fn as_file(kind: &str, text: &str) -> String {
    let joint = |text: &str| {
        let lines: Vec<String> = completed(&JOINT, text).lines().map(|line| format!("    {line}\n")).collect();
        format!("joints:\n  -\n{}", lines.concat())
    };
    match kind {
        "yaml robot" => text.to_owned(),
        "yaml top" => format!("{}\n{}", completed(&TOP, text), joint("")),
        "yaml joint" => format!("{}\n{}", completed(&TOP, ""), joint(text)),
        other => panic!("a block of the page is marked `{other}`"),
    }
}

#[test]
fn the_examples_of_the_page_are_valid() {
    let blocks = blocks(&page());
    assert!(blocks.len() >= 6);
    for (kind, text) in blocks {
        let source = Source::new("example", as_file(&kind, &text));
        let (valid, diagnostics) = validate::read(&source);
        let unexpected = diagnostics.iter().filter(|d| d.code != Code::UnusedParameter).count();
        assert!(valid.is_some() && unexpected == 0, "{}\n{}", source.text(), diagnostics.render(&source, Colour::Never));
    }
}

#[test]
fn the_page_names_every_kind_of_diagnostic() {
    let page = page() + &text("diagnostics.md");
    let missing: Vec<&str> =
        Code::ALL.iter().map(|code| code.name()).filter(|name| !page.contains(&format!("`{name}`"))).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
