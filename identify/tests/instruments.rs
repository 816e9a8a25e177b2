//! Noise of positions: it is seen, and with the reference of the drives it bends nothing.

use armgen_identify::finding::{Code, Findings};
use armgen_identify::identify::{identify, Identified, Input};
use armgen_identify::log::{read, Format};
use armgen_identify::options::Options;

use crate::arms::{arm, format, motion, Random, ELBOW};

/// A log with its reference, positions with white noise (rad) and no rates.
fn log(seed: u64, noise: f64) -> String {
    let arm = arm(ELBOW);
    let (n, motion) = (arm.dof(), motion(ELBOW, seed, 40.0, 100.0));
    let mut random = Random(seed + 50);
    let mut text = String::from("t");
    for prefix in ["q", "qr", "tau"] {
        arm.joints.iter().for_each(|joint| text += &format!(",{prefix}_{}", joint.name));
    }
    for (k, t) in motion.t.iter().enumerate() {
        text += &format!("\n{t:.5}");
        motion.q[k * n..(k + 1) * n].iter().for_each(|q| text += &format!(",{:.7}", q + noise * random.normal()));
        motion.q[k * n..(k + 1) * n].iter().for_each(|q| text += &format!(",{q:.7}"));
        motion.tau[k * n..(k + 1) * n].iter().for_each(|tau| text += &format!(",{:.7}", tau + 0.2 * random.normal()));
    }
    text + "\n"
}

/// The estimate, whether the warning is there, and the largest distance from the truth of a base parameter, in widths of its interval.
fn judged(log: &str, instruments: bool) -> (Identified, bool, f64) {
    let arm = arm(ELBOW);
    let (log, mut findings) = read("log.csv", log.as_bytes(), &Format { with_reference: instruments, ..format(&arm) });
    assert_eq!(log.unused.is_empty(), instruments, "the reference is a column that is not used");
    let options = Options { instruments, cutoff: Some(8.0), ..Options::default() };
    let found = identify(&arm, &[Input { log, ..Input::default() }], &options, &mut findings)
        .unwrap_or_else(|| panic!("{}", findings.render()));
    let warned = findings.iter().any(|finding| finding.code == Code::BiasedRegressor);
    let truth = &arm.combination * arm.nominal();
    let off = |(k, base): (usize, &armgen_identify::identify::Interval)| (base.value - truth[k]).abs() / (base.high - base.low);
    let worst = found.base.iter().enumerate().map(off).fold(0.0, f64::max);
    (found, warned, worst)
}

#[test]
fn noise_of_positions_is_seen_and_instruments_take_its_bias_away() {
    let noisy = log(3, 4e-3);
    let (_, warned, plain) = judged(&noisy, false);
    let (_, again, free) = judged(&noisy, true);
    println!("{plain:.2} widths off, with instruments {free:.2}");
    assert!(warned && !again);
    assert!(plain > 1.0 && free < 0.6, "{plain} {free}");
}

/// The sign of a noisy rate is that of the reference: dry friction is free of the bias, also where drives follow late.
#[test]
fn dry_friction_comes_from_the_reference() {
    let late = |text: String| {
        // The reference of two samples later.
        let lines: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
        let of = |k: usize| {
            let from = if k == 0 { 0 } else { (k + 2).min(lines.len() - 1) };
            let cells = (0..lines[k].len()).map(|i| if (4..7).contains(&i) { &lines[from][i] } else { &lines[k][i] });
            cells.cloned().collect::<Vec<_>>().join(",") + "\n"
        };
        (0..lines.len()).map(of).collect::<String>()
    };
    let arm = arm(ELBOW);
    for (seed, text) in [(3, log(3, 2e-3)), (4, late(log(4, 2e-3)))] {
        let (found, ..) = judged(&text, true);
        for of in &found.friction {
            let truth = arm.joints[of.joint].friction[of.term as usize].unwrap_or(0.0);
            println!("seed {seed}: joint {} {:?} {truth} {:?}", of.joint, of.term, of.value);
            let holds = of.value.low < truth && truth < of.value.high;
            assert!(holds, "seed {seed}, joint {}: {:?} {truth} {:?}", of.joint, of.term, of.value);
        }
    }
}

/// Without noise of positions there is nothing to be warned of, and both ways agree with the truth.
#[test]
#[ignore = "wide"]
fn exact_positions_bend_nothing() {
    for seed in 1..=10 {
        for instruments in [false, true] {
            let (found, warned, off) = judged(&log(seed, 0.0), instruments);
            assert!(!warned, "seed {seed}");
            assert!(off < 0.7, "seed {seed}: {off} {:?}", found.base);
        }
    }
}

/// The reference is asked for by name, and excludes gains that are identified.
#[test]
fn the_reference_is_asked_for() {
    let arm = arm(ELBOW);
    let text = log(1, 0.0).replace("qr_", "ref_");
    let (_, findings) = read("log.csv", text.as_bytes(), &Format { with_reference: true, ..format(&arm) });
    let missing: Vec<&str> = findings.iter().map(|finding| finding.column.as_str()).collect();
    assert_eq!(missing, ["qr_base", "qr_shoulder", "qr_elbow"]);
    let text = log(1, 0.0).replace("tau_", "current_");
    let (log, mut findings): (_, Findings) = read("log.csv", text.as_bytes(), &Format { with_reference: true, ..format(&arm) });
    let options = Options { instruments: true, gains: armgen_identify::options::Gains::Identify, ..Options::default() };
    assert!(identify(&arm, &[Input { log, ..Input::default() }], &options, &mut findings).is_none());
    assert!(findings.iter().any(|finding| finding.code == Code::BadOptions), "{}", findings.render());
}
