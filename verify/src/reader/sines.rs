//! The private functions that answer for sine, cosine, sign and what is left of Stribeck friction, which equations take as inputs, and the barrier, which
//! computes nothing: no equation can judge them, and they are accepted by their texts alone.
//!
//! The texts stand here once more, and are not those of the generator taken in: what is right is decided where it is checked. Whoever changes the
//! generator's block of sines (`codegen/src/emit/rust/sincos`) has to find the new one right and copy it, as it is emitted, to `sines/`.

use std::collections::{BTreeMap, BTreeSet};

use super::lexer::Fault;
use super::parser::Parser;
use crate::check::Check;
use crate::enclosure::Float;

const OF_LIBM_F64: &str =
    "/// Sine and cosine of an angle in rad.\n#[inline]\nfn sin_cos(x: Real) -> (Real, Real) {\n    libm::sincos(x)\n}";
const OF_LIBM_F32: &str =
    "/// Sine and cosine of an angle in rad.\n#[inline]\nfn sin_cos(x: Real) -> (Real, Real) {\n    libm::sincosf(x)\n}";
const OF_STD: &str =
    "/// Sine and cosine of an angle in rad.\n#[inline]\nfn sin_cos(x: Real) -> (Real, Real) {\n    x.sin_cos()\n}";
const SIGN: &str = "/// Sign of a rate: 0 at rest, not a number for what is not a number.\n#[inline]\n\
    fn sign(x: Real) -> Real {\n    if x > 0.0 { 1.0 } else if x < 0.0 { -1.0 } else { x }\n}";
const BARRIER: &str = "/// Between two columns: where there are vectors a compiler would take entries of several columns together, and hold too \
    many values for that.\n#[inline]\nfn barrier() {\n    if cfg!(any(target_feature = \"sse2\", target_feature = \"neon\", \
    target_feature = \"simd128\")) {\n        core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);\n    }\n}";
const STRIBECK: &str = include_str!("sines/stribeck.rs");
const FAST_F64: &str = include_str!("sines/fast_f64.rs");
const FAST_F32: &str = include_str!("sines/fast_f32.rs");

/// All names.
pub(super) const NAMES: [&str; 14] = [
    "barrier",
    "sign",
    "stribeck",
    "sin_cos",
    "SIN_COS_RANGE",
    "sin_cos_one",
    "sin_cos_beyond",
    "sin_cos_reduced",
    "SIN_COS_VECTORS",
    "SIN_COS_PAIRS",
    "sin_cos_four",
    "sin_cos_each_of_four",
    "sin_cos_eight",
    "sin_cos_each_of_eight",
];

/// What the block for several angles at once always has.
const FAST: [&str; 4] = ["SIN_COS_RANGE", "sin_cos", "sin_cos_one", "sin_cos_beyond"];

/// Private items by name, each at its documentation.
pub(super) type Private<'a> = BTreeMap<&'a str, Parser<'a>>;

/// The texts of the items of a block by their names.
fn items(block: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    block.trim_end().split("\n\n").map(|item| {
        let begins = |line: &'static str| line.strip_prefix("fn ").or_else(|| line.strip_prefix("const "));
        let rest = item.lines().find_map(begins).unwrap_or("");
        (rest.split(['(', ':']).next().unwrap_or(""), item)
    })
}

/// Compares the private items with the texts that they must have; where the sines come from.
pub(super) fn check(private: &Private<'_>, real: Float) -> Result<Option<&'static str>, Fault> {
    let fast = private.contains_key("sin_cos_one");
    let block: BTreeMap<&str, &str> = match (fast, real) {
        (false, _) => BTreeMap::new(),
        (true, Float::F64) => items(FAST_F64).collect(),
        (true, Float::F32) => items(FAST_F32).collect(),
    };
    let mut trig = fast.then_some("fast");
    for (&name, &place) in private {
        let is = |text: &str| place.clone().expect(text);
        match name {
            "barrier" => is(BARRIER)?,
            "sign" => is(SIGN)?,
            "stribeck" => is(STRIBECK.trim_end())?,
            "sin_cos" if !fast && is(OF_STD).is_ok() => trig = Some("std"),
            "sin_cos" if !fast => {
                is(if real == Float::F64 { OF_LIBM_F64 } else { OF_LIBM_F32 })?;
                trig = Some("libm");
            }
            name => match block.get(name) {
                Some(text) => is(text)?,
                None if !Check::PrivateNames.is_made() => {}
                None => {
                    return Err(place
                        .peek()
                        .fault(format!("`{name}` belongs to a block for several angles, without `sin_cos_one`")))
                }
            },
        }
    }
    Ok(trig)
}

/// Whether exactly those private items are there that the calls of some functions need.
pub(super) fn check_calls(private: &Private<'_>, calls: &BTreeSet<&'static str>, real: Float) -> Result<(), Fault> {
    let mut needed = calls.clone();
    if calls.iter().any(|name| !["barrier", "sign", "stribeck", "sin_cos"].contains(name)) {
        needed.extend(FAST);
        needed.extend((real == Float::F32).then_some("sin_cos_reduced"));
    }
    for (lanes, each) in [("sin_cos_four", "sin_cos_each_of_four"), ("sin_cos_eight", "sin_cos_each_of_eight")] {
        if calls.contains(lanes) {
            needed.extend([each, "SIN_COS_VECTORS"]);
            needed.extend((real == Float::F64).then_some("SIN_COS_PAIRS"));
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

#[cfg(test)]
mod tests {
    use super::*;
    use armgen_codegen::kinds::Scalar;
    use armgen_codegen::program::Trig;
    use armgen_codegen::schedule::Options;
    use armgen_codegen::source::Source;

    /// Where this fails, the generator's block has changed: decide whether the new one is right, then copy it.
    #[test]
    fn the_blocks_are_those_that_are_emitted() {
        for (file, lanes) in [("scara", "four"), ("panda7", "eight")] {
            let path = format!("{}/../robots/{file}.yaml", env!("CARGO_MANIFEST_DIR"));
            let source = Source::new("robot.yaml", std::fs::read_to_string(path).expect("a robot"));
            for (scalar, block) in [(Scalar::F64, FAST_F64), (Scalar::F32, FAST_F32)] {
                #[allow(clippy::needless_update)]
                let options = Options { scalar, trig: Trig::Fast, ..Options::default() };
                let module = armgen_codegen::generate(&source, &options).0.expect("a module").module;
                for (name, text) in items(block) {
                    let other = if lanes == "four" { "eight" } else { "four" };
                    assert_eq!(module.contains(text), !name.ends_with(other), "{file} {scalar:?} {name}");
                }
            }
        }
    }
}
