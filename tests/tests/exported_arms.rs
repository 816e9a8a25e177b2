//! Arms with the numbers of real files: each has a module, or a diagnostic that names its remedy.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_tests::exported_arms::{arm, Before};

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

#[test]
#[ignore = "wide"]
fn many_arms_with_numbers_of_real_files_have_an_answer() {
    answered(100..124, (2, 4), Before::Nothing);
    answered(100..106, (2, 3), Before::Rail);
    answered(100..106, (2, 3), Before::Mobile);
}
