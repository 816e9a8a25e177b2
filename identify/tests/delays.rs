//! Delays of torques behind positions: drawn at random, found without bias, and named where a log does not determine them.

use armgen_identify::identify::{identify, Identified, Input};
use armgen_identify::log::{read, Format};
use armgen_identify::options::Options;

use crate::arms::{arm, format, late_motion, Random, ELBOW, SCARA};

/// An arm's log of 20 s with late torques, noise of a part of each torque, and positions with white noise beside their reference.
fn identified(text: &str, seed: u64, delays: &[f64], part: f64, of_positions: Option<f64>) -> Identified {
    let arm = arm(text);
    let n = arm.dof();
    let motion = late_motion(text, seed, if of_positions.is_some() { 40.0 } else { 20.0 }, 100.0, delays);
    let mut random = Random(seed + 100);
    let sizes: Vec<f64> = (0..n).map(|j| crate::arms::rms(motion.tau.iter().skip(j).step_by(n))).collect();
    let prefixes: &[&str] = if of_positions.is_some() { &["q", "qr", "tau"] } else { &["q", "dq", "tau"] };
    let mut log = String::from("t");
    for prefix in prefixes {
        arm.joints.iter().for_each(|joint| log += &format!(",{prefix}_{}", joint.name));
    }
    for (k, t) in motion.t.iter().enumerate() {
        log += &format!("\n{t:.5}");
        let noise = of_positions.unwrap_or(0.0);
        motion.q[k * n..(k + 1) * n].iter().for_each(|q| log += &format!(",{:.8}", q + noise * random.normal()));
        let second = if of_positions.is_some() { &motion.q } else { &motion.dq };
        second[k * n..(k + 1) * n].iter().for_each(|x| log += &format!(",{x:.8}"));
        (0..n).for_each(|j| log += &format!(",{:.8}", motion.tau[k * n + j] + part * sizes[j] * random.normal()));
    }
    let instruments = of_positions.is_some();
    let (log, mut findings) = read("log.csv", (log + "\n").as_bytes(), &Format { with_reference: instruments, ..format(&arm) });
    let options = Options { instruments, cutoff: instruments.then_some(8.0), ..Options::default() };
    let input = Input { log, ..Input::default() };
    identify(&arm, &[input], &options, &mut findings).unwrap_or_else(|| panic!("{}", findings.render()))
}

/// Draws delays, and returns for each its error in ms and in standard errors, and whether its interval has it.
fn errors(text: &str, seeds: std::ops::RangeInclusive<u64>, part: f64, of_positions: Option<f64>) -> Vec<(f64, f64, bool)> {
    let mut errors = Vec::new();
    for seed in seeds {
        let mut random = Random(seed);
        let delays: Vec<f64> = (0..arm(text).dof()).map(|_| random.within(-6e-3, 18e-3)).collect();
        let found = identified(text, seed, &delays, part, of_positions);
        for (truth, of) in delays.iter().zip(&found.delays) {
            assert!(of.excited, "seed {seed}: {of:?}");
            let off = of.value - truth;
            println!("seed {seed}: {:.3} ms, found {:.3}, {:.1} sigma", 1e3 * truth, 1e3 * of.value, off / of.sigma);
            errors.push((1e3 * off, off / of.sigma, of.low <= *truth && *truth <= of.high));
        }
    }
    errors
}

#[track_caller]
fn check(errors: &[(f64, f64, bool)], largest: f64) {
    let worst = errors.iter().map(|(ms, ..)| ms.abs()).fold(0.0, f64::max);
    assert!(worst < largest, "{worst} ms");
}

/// Without noise a sampled reversal is up to a period late: all of them together show the delay to a part of the period.
#[test]
fn intervals_of_delays_hold_and_no_delay_is_drawn_to_zero_or_to_a_sample() {
    for (text, part) in [(ELBOW, 0.0), (SCARA, 0.0), (ELBOW, 0.002), (ELBOW, 0.02), (SCARA, 0.02)] {
        let errors = errors(text, 1..=4, part, None);
        check(&errors, 2.0);
        assert!(errors.iter().all(|(.., holds)| *holds), "{part}: {errors:?}");
        let mean = errors.iter().map(|(_, sigmas, _)| sigmas).sum::<f64>() / errors.len() as f64;
        assert!(mean.abs() < 1.0, "{part}: {mean}");
    }
}

/// Noise of positions moves delays; instruments take it away.
#[test]
fn delays_come_from_instruments_too() {
    let errors = errors(ELBOW, 1..=3, 0.01, Some(2e-4));
    check(&errors, 1.0);
    assert!(errors.iter().all(|(.., holds)| *holds), "{errors:?}");
}

#[test]
fn a_delay_that_a_log_does_not_determine_is_zero_and_named() {
    let found = identified(ELBOW, 5, &[8e-3; 3], 8.0, None);
    assert!(found.delays.iter().all(|of| !of.excited && of.value == 0.0), "{:?}", found.delays);
}
