//! Random arms with the numbers of real files: what the generator makes of a valid arm, the checker accepts.

use armgen_certify::certify;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;

use crate::exported_arms::{arm, Before};

/// Elimination in long arms recurses deeply.
const STACK: usize = 256 << 20;

/// Why the checker refuses the module of an arm, if it does; a description may be refused with a remedy instead.
fn fault(seed: u64, joints: (i64, i64), before: Before) -> Option<String> {
    let text = arm(seed, joints, before);
    let scalar = if seed % 3 == 0 { Scalar::F32 } else { Scalar::F64 };
    let source = Source::new("robot.yaml", text.clone());
    #[allow(clippy::needless_update)]
    let (generated, diagnostics) = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() });
    let Some(generated) = generated else {
        let has_remedies = diagnostics.iter().all(|diagnostic| !diagnostic.help.is_empty());
        return (!has_remedies).then(|| format!("seed {seed}: refused without a remedy: {diagnostics:?}\n{text}"));
    };
    let fault = certify(&source, &generated).first_fault()?;
    Some(format!("seed {seed}, {before:?}, {scalar:?}: {fault}\n{text}"))
}

/// Every second arm stands on a rail or on a mobile base.
fn faults(seeds: std::ops::RangeInclusive<u64>, joints: (i64, i64)) -> Vec<String> {
    let of_seeds = move || {
        let before = |seed: u64| match seed % 4 {
            1 => Before::Rail,
            3 => Before::Mobile,
            _ => Before::Nothing,
        };
        seeds.filter_map(|seed| fault(seed, joints, before(seed))).collect()
    };
    std::thread::Builder::new().stack_size(STACK).spawn(of_seeds).expect("a thread").join().expect("no panic")
}

#[test]
fn a_dozen_arms_are_verified() {
    let faults = faults(1..=12, (2, 3));
    assert!(faults.is_empty(), "{} of 12\n{}", faults.len(), faults.join("\n"));
}

#[test]
#[ignore = "wide: minutes"]
fn two_hundred_arms_are_verified() {
    let faults = faults(100..=299, (2, 6));
    assert!(faults.is_empty(), "{} of 200\n{}", faults.len(), faults.join("\n"));
}
