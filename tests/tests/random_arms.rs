//! Random arms, from the text of a description to numbers: their programs are carried out without a compiler and judged like emitted code.

use std::sync::atomic::{AtomicU64, Ordering};

use armgen_tests::functions::FUNCTIONS;
use armgen_tests::interpreter::Interpreted;
use armgen_tests::judge::{judge, Tolerance};
use armgen_tests::precision::{FORWARD_RESIDUAL, ORACLE};
use armgen_tests::random;

/// How many arms, from seed 0 on. Each is generated in full, which takes up to some seconds for eight joints.
const ARMS: u64 = 64;

#[test]
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

fn check(seed: u64) {
    let text = random::arm(seed);
    let robot = Interpreted::new(&text).unwrap_or_else(|faults| panic!("seed {seed}:\n{faults}\n{text}"));
    let names: Vec<String> = robot.module.functions.iter().map(|f| f.name()).collect();
    assert_eq!(names, FUNCTIONS);
    judge(&format!("arm {seed}"), &robot, &text, seed, Tolerance { values: ORACLE, residual: FORWARD_RESIDUAL });
}
