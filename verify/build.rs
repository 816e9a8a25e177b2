//! Writes the building blocks of inverse kinematics with another scalar, so that they run in prime fields. The texts stay the same, but
//! every number has the type `Real` that `src/inverse_kinematics/soundness.rs` defines.

use std::fmt::Write;

use armgen_inverse_kinematics::texts::TEXTS;

/// The blocks of closed forms.
const CLOSED: [&str; 16] = [
    "frame",
    "line_and_circle",
    "turn",
    "two_links",
    "three_turns",
    "branches",
    "regional",
    "regional_one_prismatic",
    "regional_prismatic",
    "parallel_axes",
    "spherical_triple",
    "parallel_turns",
    "three_prismatic",
    "arrangement",
    "given",
    "shoulder_elbow_wrist",
];

fn main() {
    let mut text = String::new();
    for block in TEXTS.iter().filter(|block| CLOSED.contains(&block.name)) {
        block.source.lines().for_each(|line| {
            let _ = writeln!(text, "{}", in_field(line));
        });
    }
    let out = std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    std::fs::write(std::path::Path::new(&out).join("blocks.rs"), text).expect("OUT_DIR can be written");
    println!("cargo::rerun-if-changed=build.rs");
}

/// A line with its decimal numbers as field elements. Scalar constants are a tolerance or pi; both become 0, because a field is exact.
fn in_field(line: &str) -> String {
    if line.trim_start().starts_with("//") {
        return String::new();
    }
    if let Some((name, _)) = line.split_once(": Real = ").filter(|(name, _)| name.contains("const ")) {
        return format!("{name}: Real = Real::ZERO;");
    }
    let mut text = String::new();
    let mut rest = line;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, behind) = rest.split_at(at);
        text += before;
        let end = behind.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.')).unwrap_or(behind.len());
        let word = &behind[..end];
        // `0..n` is a range, `x1` a name, `1.0` a number.
        let is_name = before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
        if word.contains('.') && !word.contains("..") && !is_name {
            let _ = write!(text, "Real::of({word})");
        } else {
            text += word;
        }
        rest = &behind[end..];
    }
    text + rest
}
