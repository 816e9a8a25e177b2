//! Delays of torques behind positions: drawn at random, found without bias, and named where a log does not determine them.

use armgen_identify::identify::{identify, Identified, Input};
use armgen_identify::log::{read, Format};
use armgen_identify::options::Options;

use crate::arms::{arm, format, late_motion, Random, ELBOW, SCARA};

/// Noise of a log.
#[derive(Clone, Copy, Debug, Default)]
struct Noise {
    /// Of torques, as a part of each.
    torque: f64,
    /// What noise of torques keeps from a sample to the next.
    memory: f64,
    /// Of rates, rad/s or m/s.
    rate: f64,
    /// White noise of positions beside their reference, rad or m; without it rates are logged, and no reference.
    position: Option<f64>,
}

/// An arm's log of 20 s with late torques, or of 40 s with noise of positions.
fn identified(text: &str, seed: u64, delays: &[f64], noise: Noise) -> Identified {
    let arm = arm(text);
    let of_positions = noise.position;
    let n = arm.dof();
    let motion = late_motion(text, seed, if of_positions.is_some() { 40.0 } else { 20.0 }, 100.0, delays);
    let mut random = Random(seed + 100);
    let sizes: Vec<f64> = (0..n).map(|j| crate::arms::rms(motion.tau.iter().skip(j).step_by(n))).collect();
    let prefixes: &[&str] = if of_positions.is_some() { &["q", "qr", "tau"] } else { &["q", "dq", "tau"] };
    let mut log = String::from("t");
    for prefix in prefixes {
        arm.joints.iter().for_each(|joint| log += &format!(",{prefix}_{}", joint.name));
    }
    let mut last: Vec<f64> = (0..n).map(|_| random.normal()).collect();
    for (k, t) in motion.t.iter().enumerate() {
        log += &format!("\n{t:.5}");
        let of_position = of_positions.unwrap_or(0.0);
        motion.q[k * n..(k + 1) * n].iter().for_each(|q| log += &format!(",{:.8}", q + of_position * random.normal()));
        let (second, of_second) = if of_positions.is_some() { (&motion.q, 0.0) } else { (&motion.dq, noise.rate) };
        second[k * n..(k + 1) * n].iter().for_each(|x| log += &format!(",{:.8}", x + of_second * random.normal()));
        for (j, last) in last.iter_mut().enumerate() {
            *last = noise.memory * *last + (1.0 - noise.memory * noise.memory).sqrt() * random.normal();
            log += &format!(",{:.8}", motion.tau[k * n + j] + noise.torque * sizes[j] * *last);
        }
    }
    let instruments = of_positions.is_some();
    let (log, mut findings) = read("log.csv", (log + "\n").as_bytes(), &Format { with_reference: instruments, ..format(&arm) });
    let options = Options { instruments, cutoff: instruments.then_some(8.0), ..Options::default() };
    let input = Input { log, ..Input::default() };
    identify(&arm, &[input], &options, &mut findings).unwrap_or_else(|| panic!("{}", findings.render()))
}

/// Draws delays, and returns for each its error in ms and in standard errors, and whether its interval has it.
fn errors(text: &str, seeds: std::ops::RangeInclusive<u64>, noise: Noise) -> Vec<(f64, f64, bool)> {
    let mut errors = Vec::new();
    for seed in seeds {
        let mut random = Random(seed);
        let delays: Vec<f64> = (0..arm(text).dof()).map(|_| random.within(-6e-3, 18e-3)).collect();
        let found = identified(text, seed, &delays, noise);
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

/// A sampled torque has the sign of the rate a delay before the sample, and its columns too: without noise the delay is exact.
#[test]
fn delays_of_logs_without_noise_are_exact() {
    for text in [ELBOW, SCARA] {
        check(&errors(text, 1..=4, Noise::default()), 1e-3);
    }
}

/// A little cubic friction is seen only when delays are nearly right, and hides the rest of them until then.
#[test]
fn delays_are_exact_beside_friction_that_is_found_late() {
    for cubic in ["0.01", "-0.01", "0.02", "-0.02", "0.05", "-0.05"] {
        let text = ELBOW.replace("offset: 0.2, load: 0.04", &format!("offset: 0.2, load: 0.04, cubic: {cubic}"));
        check(&errors(&text, 1..=4, Noise::default()), 1e-3);
    }
}

/// White and coloured noise, with and without noise of rates, which moves reversals to other samples.
#[test]
fn intervals_of_delays_hold_and_no_delay_is_drawn_to_zero_or_to_a_sample() {
    let white = |torque: f64, rate: f64| Noise { torque, rate, ..Noise::default() };
    // exp(-0.01 s / 0.02 s)
    let coloured = |torque: f64, rate: f64| Noise { memory: 0.607, ..white(torque, rate) };
    for noise in [white(0.002, 0.0), white(0.02, 0.0), white(0.02, 2e-3), coloured(0.02, 0.0), coloured(0.02, 2e-3)] {
        for text in [ELBOW, SCARA] {
            let errors = errors(text, 1..=4, noise);
            check(&errors, 4.0);
            assert!(errors.iter().all(|(.., holds)| *holds), "{noise:?}: {errors:?}");
            let mean = errors.iter().map(|(_, sigmas, _)| sigmas).sum::<f64>() / errors.len() as f64;
            assert!(mean.abs() < 1.0, "{noise:?}: {mean}");
        }
    }
}

/// Noise of positions moves delays; instruments take it away.
#[test]
fn delays_come_from_instruments_too() {
    let errors = errors(ELBOW, 1..=3, Noise { torque: 0.01, position: Some(2e-4), ..Noise::default() });
    check(&errors, 1.0);
    assert!(errors.iter().all(|(.., holds)| *holds), "{errors:?}");
}

#[test]
fn a_delay_that_a_log_does_not_determine_is_zero_and_named() {
    let found = identified(ELBOW, 5, &[8e-3; 3], Noise { torque: 8.0, ..Noise::default() });
    assert!(found.delays.iter().all(|of| !of.excited && of.value == 0.0), "{:?}", found.delays);
}
