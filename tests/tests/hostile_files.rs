//! No text makes the reader or the generator panic or hang. The texts are every prefix of a valid file, files with lines swapped, and
//! expensive files. Expensive files are long or deep, alias long texts, hold numbers whose exact value grows, or sums that multiply out.
//!
//! Counts, not a clock, bound the work: times on a busy machine prove nothing about the program.

use std::path::Path;

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::validate;

use crate::fuzzed::fuzz::check_diagnostics;

fn robot(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).expect("a robot")
}

/// Reads the bytes as a file and renders its diagnostics; returns whether they describe an arm.
fn read(bytes: &[u8]) -> bool {
    let source = Source::new("robot.yaml", String::from_utf8_lossy(bytes));
    let (valid, diagnostics) = validate::read(&source);
    assert_eq!(valid.is_some(), !diagnostics.has_errors());
    check_diagnostics(&source, &diagnostics);
    valid.is_some()
}

/// Generates from the bytes, for both scalars.
fn generate(bytes: &[u8]) {
    let source = Source::new("robot.yaml", String::from_utf8_lossy(bytes));
    for scalar in [Scalar::F64, Scalar::F32] {
        let options = Options { scalar, ..Options::default() };
        let (generated, diagnostics) = armgen_codegen::generate(&source, &options);
        assert_eq!(generated.is_some(), !diagnostics.has_errors(), "{}", diagnostics.render(&source, Colour::Never));
    }
}

#[test]
fn every_prefix_of_a_file_is_read() {
    let text = robot("../robots/scara.yaml");
    for end in 0..=text.len() {
        assert!(read(&text[..end]) || end < text.len(), "the whole file describes an arm");
    }
}

#[test]
fn lines_swapped_dropped_and_doubled_are_read() {
    let text = String::from_utf8(robot("../robots/scara.yaml")).expect("text");
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

#[test]
fn large_and_deep_files_end() {
    let head = "name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\n";
    let row = "type: revolute, a: 0.1, alpha: pi/2, d: 0, theta: 0, link: {mass: 1}";
    let texts = [
        "x".repeat(1 << 20),
        format!("{head}{}", "a: 1\n".repeat(40_000)),
        format!("{head}{}", (0..20_000).map(|i| format!("k{i}: 1\n")).collect::<String>()),
        format!("{head}joints:\n{}", (0..2500).map(|i| format!("  - {{name: j{i}, {row}}}\n")).collect::<String>()),
        format!("{head}joints:\n{}", (0..32).map(|i| format!("  - {{name: j{i}, {row}}}\n")).collect::<String>()),
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

/// An arm of one joint with these lines in it.
fn arm(parameters: &str, link: &str, rest: &str) -> String {
    format!(
        "name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\nparameters: {{{parameters}}}\njoints:\n  - {{name: j, type: revolute, \
         a: 0.5, alpha: pi/2, d: 0.25, theta: 0, link: {link}}}\n{rest}"
    )
}

/// Files that cost much where something is compared with everything, copied, or multiplied out.
#[test]
fn costly_files_end() {
    let names = |letter: &str, n: usize| (0..n).map(|i| format!("{letter}{i}")).collect::<Vec<_>>();
    let each = |names: &[String], value: &str| names.iter().map(|name| format!("{name}: {value}")).collect::<Vec<_>>().join(", ");
    let link = "{mass: 1, com: [0.1, 0, 0]}";
    let sums = |n: usize| {
        let (a, b) = (names("a", n), names("b", n));
        let link = format!("{{mass: {}, com: [{}, 0, 0], inertia: {{xx: 1, yy: 1, zz: 1}}}}", a.join("+"), b.join("+"));
        (each(&[a.clone(), b.clone()].concat(), "1"), link, [a, b].concat())
    };
    let unseen = "sqrt(3-2*sqrt(2))+1-sqrt(2)";
    let mut texts = vec![
        // Names that are not defined, in the values of names, in values and in the list of the regressor.
        arm(&each(&names("p", 12_000), "nosuch"), link, ""),
        arm(&each(&names("p", 1_000), "nosuch+nearly+other"), link, &format!("regressor: [{}]\n", names("q", 20_000).join(", "))),
        arm("", &format!("{{mass: {}}}", names("p", 300).join("+")), ""),
        // Aliases of a long text.
        format!("name: &a {}\nlist: [{}]\n", "x".repeat(128_000), vec!["*a"; 30_000].join(", ")),
        format!("name: &a {}\nlist: [{}]\n", "[x, y]".repeat(20), vec!["*a"; 30_000].join(", ")),
        // Zeros that no reduction sees, and many of them.
        arm("", "{mass: 1/(sqrt(3-2*sqrt(2)) + 1 + sqrt(2)), com: [0.1, 0, 0]}", ""),
        arm(&each(&names("p", 1_000), unseen), link, ""),
        // Long sums, and long lines.
        arm("", &format!("{{mass: {}}}", vec!["1"; 900].join("+")), ""),
        format!("{{{}}}", names("k", 30_000).join(": 1, ")),
    ];
    for n in [12, 24, 60] {
        let (parameters, link, all) = sums(n);
        texts.push(arm(&parameters, &link, ""));
        texts.push(arm(&parameters, &link, "regressor: standard\n"));
        texts.push(arm(&parameters, &link, &format!("regressor: [{}]\n", all.join(", "))));
    }
    for text in &texts {
        read(text.as_bytes());
    }
    let motor = "motor: {inertia: 1, axis: [sqrt(sqrt(3-2*sqrt(2))), 1, sqrt(sqrt(2))]}";
    let (parameters, sums, _) = sums(24);
    for text in [
        arm("", &format!("{link}, {motor}"), ""),
        arm("", "{mass: 1/(sqrt(3-2*sqrt(2)) + 1 + sqrt(2)), com: [0.1, 0, 0]}", ""),
        arm(&parameters, &sums, "regressor: base\n"),
    ] {
        assert!(read(text.as_bytes()), "{text}");
        generate(text.as_bytes());
    }
}
