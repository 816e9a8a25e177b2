//! Random arms, from the text of a description to numbers: their programs are carried out without a compiler and judged like emitted code.

use std::sync::atomic::{AtomicU64, Ordering};

use armgen_codegen::pass::{Pass, Passes};
use armgen_codegen::schedule::Options;
use armgen_tests::functions::expected;
use armgen_tests::interpreter::Interpreted;
use armgen_tests::judge::{judge, Tolerance};
use armgen_tests::precision::{FORWARD_RESIDUAL, ORACLE};
use armgen_tests::random;

/// How many arms, from seed 0 on. Each is generated in full, which takes up to some seconds for eight joints.
const ARMS: u64 = 64;

#[test]
#[ignore = "wide"]
fn random_arms_agree_with_the_oracle() {
    // More of them on request, for whoever has changed a derivation.
    let arms = std::env::var("ARMGEN_RANDOM_ARMS").map_or(ARMS, |text| text.parse().expect("ARMGEN_RANDOM_ARMS is a number"));
    let next = AtomicU64::new(0);
    let work = || loop {
        let seed = next.fetch_add(1, Ordering::Relaxed);
        if seed >= arms {
            break;
        }
        check(seed);
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..2).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            worker.join().expect("an arm fails: its seed and text stand above");
        }
    });
}

#[test]
#[ignore = "wide"]
fn random_trees_agree_with_the_oracle() {
    for seed in 0..ARMS / 4 {
        let joints = 3 + (seed % 6) as usize;
        let text = random::tree(&format!("tree_{seed}"), joints, &mut random::Random::new(!seed));
        check_text(&text, &format!("tree {seed}"), seed, Passes::NONE);
    }
}

/// Each pass alone, and all, left out: the same functions at other costs.
#[test]
#[ignore = "wide"]
fn arms_without_a_pass_agree_with_the_oracle() {
    let each = Pass::ALL.map(|pass| (pass.name(), [pass].into_iter().collect::<Passes>()));
    for (k, (name, without)) in each.into_iter().chain([("any", Passes::all())]).enumerate() {
        for seed in 0..2 {
            check_without(ARMS + 2 * k as u64 + seed, without, &format!(" without {name}"));
        }
    }
}

fn check(seed: u64) {
    check_without(seed, Passes::NONE, "");
}

fn check_without(seed: u64, without: Passes, how: &str) {
    check_text(&random::arm(seed), &format!("arm {seed}{how}"), seed, without);
}

fn check_text(text: &str, name: &str, seed: u64, without: Passes) {
    let robot = Interpreted::with_options(text, &Options { without, ..Options::default() })
        .unwrap_or_else(|faults| panic!("{name}:\n{faults}\n{text}"));
    let names: Vec<String> = robot.module.functions.iter().map(|f| f.name()).collect();
    let absent: Vec<String> = robot.module.absent.iter().map(|absent| absent.function.clone()).collect();
    assert_eq!(names, expected(&absent, text));
    judge(name, &robot, text, seed, Tolerance { values: ORACLE, residual: FORWARD_RESIDUAL });
}
