//! The private functions for sine, cosine, sign and Stribeck friction, which the equations treat as inputs, and the barrier, which computes nothing.
//! No equation can judge them, so only their exact texts are accepted.
//!
//! The texts are separate copies, not the generator's own, because the checker decides whether they are correct. After a change of the generator's
//! block of sines (`codegen/src/emit/rust/sincos`), review the new block and copy its emitted form to `sines/`.

use std::collections::{BTreeMap, BTreeSet};

use super::lexer::{Fault, Kind, Lexer};
use super::parser::Parser;
use crate::values::check::Check;
use crate::values::enclosure::Float;

const OF_LIBM_F64: &str = "#[inline]\nfn sin_cos(x: Real) -> (Real, Real) {\n    libm::sincos(x)\n}";
const OF_LIBM_F32: &str = "#[inline]\nfn sin_cos(x: Real) -> (Real, Real) {\n    libm::sincosf(x)\n}";
const OF_STD: &str = "#[inline]\nfn sin_cos(x: Real) -> (Real, Real) {\n    x.sin_cos()\n}";
const SIGN: &str = "#[inline]\n\
    fn sign(x: Real) -> Real {\n    if x > 0.0 { 1.0 } else if x < 0.0 { -1.0 } else { x }\n}";
const BARRIER: &str = "#[inline]\nfn barrier() {\n    if cfg!(any(target_feature = \"sse2\", target_feature = \"neon\", \
    target_feature = \"simd128\")) {\n        core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);\n    }\n}";
const STRIBECK: &str = include_str!("sines/stribeck.rs");
const FAST_F64: &str = include_str!("sines/fast_f64.rs");
const FAST_F32: &str = include_str!("sines/fast_f32.rs");

/// All names of private items.
pub(super) const NAMES: [&str; 22] = [
    "barrier",
    "sign",
    "stribeck",
    "sin_cos",
    "SIN_COS_RANGE",
    "SIN_COS_POLYNOMIALS",
    "SIN_COS_QUADRANTS",
    "sin_cos_polynomial",
    "sin_cos_quadrant",
    "sin_cos_of_rest",
    "sin_cos_one",
    "sin_one",
    "cos_one",
    "sin_alone",
    "sin_cos_beyond",
    "sin_cos_reduced",
    "SIN_COS_VECTORS",
    "SIN_COS_PAIRS",
    "sin_cos_four",
    "sin_cos_each_of_four",
    "sin_cos_eight",
    "sin_cos_each_of_eight",
];

/// An item that only modules with the fast sines have.
const OF_FAST: &str = "SIN_COS_RANGE";

/// Private items by name, each positioned after its documentation.
pub(super) type Private<'a> = BTreeMap<&'a str, Parser<'a>>;

/// The texts of a block's items, by name.
fn items(block: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    block.trim_end().split("\n\n").map(|item| {
        let begins = |line: &'static str| line.strip_prefix("fn ").or_else(|| line.strip_prefix("const "));
        let rest = item.lines().find_map(begins).unwrap_or("");
        (rest.split(['(', ':']).next().unwrap_or(""), item)
    })
}

/// The items of the fast sines, if the module has them.
fn fast_of(private: &Private<'_>, real: Float) -> Option<BTreeMap<&'static str, &'static str>> {
    let text = if real == Float::F64 { FAST_F64 } else { FAST_F32 };
    private.contains_key(OF_FAST).then(|| items(text).collect())
}

/// Compares the private items with their required texts; returns the source of the sines.
pub(super) fn check(private: &Private<'_>, real: Float) -> Result<Option<&'static str>, Fault> {
    let fast = fast_of(private, real);
    let mut trig = fast.is_some().then_some("fast");
    for (&name, &place) in private {
        let is = |text: &str| place.clone().expect(text);
        match name {
            "barrier" => is(BARRIER)?,
            "sign" => is(SIGN)?,
            "stribeck" => is(STRIBECK.trim_end())?,
            "sin_cos" if fast.is_none() && is(OF_STD).is_ok() => trig = Some("std"),
            "sin_cos" if fast.is_none() => {
                is(if real == Float::F64 { OF_LIBM_F64 } else { OF_LIBM_F32 })?;
                trig = Some("libm");
            }
            name => match fast.as_ref().and_then(|fast| fast.get(name)) {
                Some(text) => is(text)?,
                None if !Check::PrivateNames.is_made() => {}
                None => {
                    let why = if fast.is_some() {
                        "is none of the fast sines of this scalar"
                    } else {
                        "is one of the fast sines, which the module does not have"
                    };
                    return Err(place.peek().fault(format!("`{name}` {why}")));
                }
            },
        }
    }
    Ok(trig)
}

/// Checks that the private items are exactly those that functions call, and those that these items need.
pub(super) fn check_calls(private: &Private<'_>, calls: &BTreeSet<&'static str>, real: Float) -> Result<(), Fault> {
    let fast = fast_of(private, real).unwrap_or_default();
    let (mut needed, mut new) = (BTreeSet::new(), calls.clone());
    while !new.is_empty() {
        needed.append(&mut new);
        for (_, text) in fast.iter().filter(|(name, _)| needed.contains(*name)) {
            let named = words(text)?;
            new.extend(fast.keys().filter(|name| named.contains(*name) && !needed.contains(*name)));
        }
    }
    if let Some(name) = needed.iter().find(|name| !private.contains_key(*name) && Check::PrivateThere.is_made()) {
        return Err(Fault { line: 1, reason: format!("`{name}` is called, and the module does not have it") });
    }
    match private.iter().find(|(name, _)| !needed.contains(*name) && Check::PrivateNeeded.is_made()) {
        Some((name, place)) => Err(place.peek().fault(format!("`{name}` is needed by no function of the module"))),
        None => Ok(()),
    }
}

/// The words of a text in this module, outside comments.
fn words(text: &'static str) -> Result<BTreeSet<&'static str>, Fault> {
    let (mut lexer, mut words) = (Lexer::new(text), BTreeSet::new());
    loop {
        let token = lexer.next()?;
        match token.kind {
            Kind::End => return Ok(words),
            Kind::Word => drop(words.insert(token.text)),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use armgen_codegen::program::Trig;
    use armgen_codegen::schedule::Options;
    use armgen_description::kinds::Scalar;
    use armgen_description::source::Source;

    /// If this fails, the generator's block has changed: review the new block, then copy it. The first arm has the functions for four angles, for one
    /// and for a single sine; the second arm has those for eight.
    #[test]
    fn the_blocks_are_those_that_are_emitted() {
        for (scalar, block) in [(Scalar::F64, FAST_F64), (Scalar::F32, FAST_F32)] {
            let modules = ["scara", "panda7"].map(|file| {
                let path = format!("{}/../robots/{file}.yaml", env!("CARGO_MANIFEST_DIR"));
                let source = Source::new("robot.yaml", std::fs::read_to_string(path).expect("a robot"));
                #[allow(clippy::needless_update)]
                let options = Options { scalar, trig: Trig::Fast, ..Options::default() };
                armgen_codegen::generate(&source, &options).0.expect("a module").module
            });
            for (name, text) in items(block) {
                let is_fn = text.contains(&format!("\nfn {name}("));
                let begins = if is_fn { format!("\nfn {name}(") } else { format!("\nconst {name}:") };
                let there = modules.each_ref().map(|module| {
                    let is_there = module.contains(&begins);
                    assert_eq!(module.contains(text), is_there, "{scalar:?} {name}");
                    is_there
                });
                assert!(there[0] || there[1], "{scalar:?} {name}");
            }
        }
    }
}
