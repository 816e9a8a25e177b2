//! Any text in the place of any part of an emitted module, given to the checker as that module.
//!
//! The first four bytes choose a part of a module, the others replace it: the checker sees a module that is changed in one place.

use std::sync::OnceLock;

use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;

struct Given {
    source: Source,
    module: String,
    claims: Claims,
}

fn given() -> &'static Given {
    static GIVEN: OnceLock<Given> = OnceLock::new();
    GIVEN.get_or_init(|| {
        let source = Source::new("robot.yaml", include_str!("../../robots/single_joint.yaml"));
        let generated = armgen_codegen::generate(&source, &Options::default()).0.expect("a valid robot");
        let module = generated.module;
        let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
        let report = armgen_verify::verify_with(&source, &module, claims.clone(), Effort::default());
        assert!(report.passed(), "what is changed is not right itself: {report}");
        Given { source, module, claims }
    })
}

/// The place in a text that is a part of it, of 65536.
fn place(text: &str, part: u16) -> usize {
    let at = text.len() * usize::from(part) / 65536;
    (0..=at).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

/// The target.
///
/// # Panics
/// Where the reader is wrong.
pub fn run(data: &[u8]) {
    let Some((&[a, b, c, d], text)) = data.split_first_chunk::<4>() else { return };
    let Given { source, module, claims } = given();
    let (before, rest) = module.split_at(place(module, u16::from_le_bytes([a, b])));
    // Mostly a few characters, sometimes most of it.
    let taken = (rest.len() * usize::from(u16::from_le_bytes([c, d])).pow(3)) >> 48;
    let after = &rest[(taken..=rest.len()).find(|&at| rest.is_char_boundary(at)).unwrap_or(rest.len())..];
    let changed = format!("{before}{}{after}", String::from_utf8_lossy(text));
    let effort = Effort { points: 1, exact_points: 1, ..Effort::default() };
    let report = armgen_verify::verify_with(source, &changed, claims.clone(), effort);
    // A module that is not verified comes with a reason, in the text too.
    assert_eq!(report.passed(), report.first_fault().is_none());
    assert_eq!(report.passed(), !report.to_string().ends_with("NOT verified"));
    let told = |word: &str| report.to_string().contains(word);
    assert!(report.passed() || ["FAULT", "DIFFERENT", "REFUSED", "DOES NOT HOLD", "NOT CHECKED", "2^"].into_iter().any(told));
}
