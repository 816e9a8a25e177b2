//! No text makes the reader panic or hang: every prefix of a valid file, and many files with one byte changed.

use std::path::Path;

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::manipulator;
use armgen_codegen::source::Source;

fn robot(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../robots").join(name)).expect("a robot")
}

/// Reads the bytes as a file and renders what is said about them.
fn read(bytes: &[u8]) {
    let source = Source::new("robot.yaml", String::from_utf8_lossy(bytes));
    let (valid, diagnostics) = manipulator::read(&source);
    assert_eq!(valid.is_some(), !diagnostics.has_errors());
    let rendered = diagnostics.render(&source, Colour::Never);
    assert_eq!(rendered.is_empty(), diagnostics.is_empty());
    for diagnostic in diagnostics.iter() {
        assert!(diagnostic.labels.iter().all(|label| label.span.end <= source.text().len()), "{diagnostic:?}");
        assert!(!diagnostic.help.is_empty());
    }
}

/// A fixed sequence of numbers below `bound`; the same in every run.
struct Sequence(u64);

impl Sequence {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound
    }
}

#[test]
fn every_prefix_of_a_file_is_read() {
    let text = robot("scara.yaml");
    for end in (0..text.len()).step_by(if cfg!(debug_assertions) { 3 } else { 1 }) {
        read(&text[..end]);
    }
}

#[test]
fn files_with_a_changed_byte_are_read() {
    let text = robot("scara.yaml");
    let mut sequence = Sequence(1);
    let signs = b" \t\n\r:-[]{},#&*!|>'\"%@`?~\\/+()._0123456789eEaq\x00\x7f\x80\xc3\xff\xef\xbb\xbf";
    let rounds = if cfg!(debug_assertions) { 1500 } else { 20_000 };
    for _ in 0..rounds {
        let mut changed = text.clone();
        let at = sequence.below(changed.len());
        match sequence.below(3) {
            0 => changed[at] = signs[sequence.below(signs.len())],
            1 => {
                changed.remove(at);
            }
            _ => changed.insert(at, signs[sequence.below(signs.len())]),
        }
        read(&changed);
    }
}

#[test]
fn lines_swapped_dropped_and_doubled_are_read() {
    let text = String::from_utf8(robot("scara.yaml")).expect("text");
    let lines: Vec<&str> = text.lines().collect();
    for i in 0..lines.len() {
        let mut dropped = lines.clone();
        dropped.remove(i);
        read(dropped.join("\n").as_bytes());
        let mut doubled = lines.clone();
        doubled.insert(i, lines[i]);
        read(doubled.join("\n").as_bytes());
        let mut swapped = lines.clone();
        swapped.swap(i, (i * 7 + 3) % lines.len());
        read(swapped.join("\n").as_bytes());
    }
}

/// Work is bounded by counts, so that each of these ends; no clock is asked, for a busy machine says nothing about the reader.
#[test]
fn large_and_deep_files_end() {
    let head = "name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\n";
    let row = "type: revolute, a: 0.1, alpha: pi/2, d: 0, theta: 0, link: {mass: 1}";
    let texts = [
        "x".repeat(1 << 20),
        format!("{head}{}", "a: 1\n".repeat(40_000)),
        format!("{head}{}", (0..20_000).map(|i| format!("k{i}: 1\n")).collect::<String>()),
        format!("{head}joints:\n{}", (0..2500).map(|i| format!("  - {{name: j{i}, {row}}}\n")).collect::<String>()),
        format!("{head}joints:\n{}", (0..64).map(|i| format!("  - {{name: j{i}, {row}}}\n")).collect::<String>()),
        format!("{head}parameters:\n{}joints: []\n", (0..12_000).map(|i| format!("  p{i}: p{}\n", i + 1)).collect::<String>()),
        format!("{head}joints: [{}", "[".repeat(100_000)),
        format!("{head}gravity: [{}]", vec!["1e400"; 30_000].join(", ")),
        format!("{head}gravity: [{}, 0, 0]", "7".repeat(10_000)),
        format!("{head}gravity: [{}, 0, 0]", vec!["sqrt(2)+pi"; 150].join("*")),
        format!("{head}gravity: [\"{}\", 0, 0]", vec!["(1/(sqrt(2)+sqrt(3)+pi))"; 60].join("+")),
        format!("{head}gravity: [{}, 0, 0]", "sqrt(".repeat(30) + "2" + &")".repeat(30)),
        "? ".repeat(100_000),
        "- - - - ".repeat(20_000),
        "&a ".repeat(50_000),
        "!!x ".repeat(50_000),
        "\"\\u0041".repeat(20_000),
        "%".repeat(200_000),
        "\t".repeat(200_000),
        "\r".repeat(200_000),
        "a:\n".repeat(50_000),
        "{a: ".repeat(50_000),
    ];
    for text in &texts {
        read(text.as_bytes());
    }
}
