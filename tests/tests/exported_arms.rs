//! Arms with the numbers of real files: each has a module that equals its equations, or a diagnostic that names its remedy.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_tests::exported_arms::{arm, Before};
use armgen_verify::checker::Effort;
use armgen_verify::claims::Claims;
use armgen_verify::verify_with;

/// Less than any thread has: how deep calls go must not follow from numbers.
const STACK: usize = 1 << 20;

fn answered(seeds: std::ops::Range<u64>, joints: (i64, i64), before: Before) {
    let work = move || {
        for seed in seeds {
            println!("seed {seed}, {before:?}");
            let source = Source::new("robot.yaml", arm(seed, joints, before));
            let (generated, said) = armgen_codegen::generate(&source, &Options::default());
            let said = said.render(&source, Colour::Never);
            assert!(generated.is_some() || said.contains("error[") && said.contains("help:"), "seed {seed}:\n{said}");
        }
    };
    std::thread::Builder::new().stack_size(STACK).spawn(work).expect("a thread").join().expect("an answer to each");
}

#[test]
fn arms_with_numbers_of_real_files_have_an_answer() {
    answered(0..6, (2, 3), Before::Nothing);
    answered(0..2, (2, 2), Before::Mobile);
}

/// Forty arms, on the ground, on a rail and on a mobile base, every third in single precision. `ARMGEN_FIRST_ARM` is the first seed.
#[test]
#[ignore = "wide"]
fn many_arms_with_numbers_of_real_files_equal_their_equations() {
    let first: u64 = std::env::var("ARMGEN_FIRST_ARM").map_or(100, |text| text.parse().expect("a number"));
    let mut refused = 0;
    for (count, joints, before) in [(28, (2, 4), Before::Nothing), (6, (2, 3), Before::Rail), (6, (2, 3), Before::Mobile)] {
        answered(first..first + count, joints, before);
        for seed in first..first + count {
            let source = Source::new("robot.yaml", arm(seed, joints, before));
            let scalar = if seed.is_multiple_of(3) { Scalar::F32 } else { Scalar::F64 };
            let Some(generated) = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() }).0 else {
                refused += 1;
                continue;
            };
            let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
            let report = verify_with(&source, &generated.module, claims, Effort { points: 2, exact_points: 1, seed });
            let fault = report.first_fault().unwrap_or_default();
            assert!(report.passed(), "seed {seed}, {before:?}, {scalar:?}: {fault}\n{}", source.text());
        }
    }
    // A value that leaves the scalar; few arms have any.
    assert!(refused <= 2, "{refused} of 40 are refused");
}
