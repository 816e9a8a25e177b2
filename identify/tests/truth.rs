//! Numbers that come back: base parameters, friction, gains, loads.

use armgen_identify::arm::Arm;
use armgen_identify::consistent::{consistent, rise};
use armgen_identify::finding::{Code, Findings};
use armgen_identify::fit::{solve, Equations, Row};
use armgen_identify::identify::{identify, poor_fits, Identified, Input};
use armgen_identify::judge::{judge, Model};
use armgen_identify::log::read;
use armgen_identify::options::{Gains, Load, Options};
use nalgebra::DVector;

use crate::arms::{arm, csv, format, motion, Random, ELBOW, SCARA};

fn without_friction(text: &str) -> String {
    let mut lines = String::new();
    for line in text.lines() {
        lines += &match line.split_once(", friction:") {
            Some((before, _)) => format!("{before}}}\n"),
            None => format!("{line}\n"),
        };
    }
    lines
}

/// With exact states, base parameters come back to 1e-9 of the largest of their kind.
#[test]
fn exact_states_give_base_parameters_to_nine_digits() {
    for text in [ELBOW, SCARA] {
        let text = without_friction(text);
        let arm = arm(&text);
        let motion = motion(&text, 3, 10.0, 20.0);
        let (n, base) = (arm.dof(), arm.base.len());
        let a = arm.regressor(&motion.q, &motion.dq, &motion.ddq);
        let known = arm.known(&motion.q, &motion.dq, &motion.ddq);
        let b: Vec<f64> = motion.tau.iter().zip(&known).map(|(tau, known)| tau - known).collect();
        let rows = (0..b.len()).map(|k| Row { joint: k % n, log: 0, time: motion.t[k / n], counts: true }).collect();
        let equations = Equations::dense(base, a, b, rows);
        let gram = equations.gram(&vec![1.0; motion.tau.len()]);
        let truth = &arm.combination * arm.nominal();
        let found = solve(&gram, &DVector::zeros(base));
        assert!(found.hidden.is_empty());
        // One step of refinement from the residuals themselves: normal equations lose half of the digits.
        let active: Vec<usize> = (0..base).collect();
        let residuals = equations.residuals(&active, &found.x);
        let mut again = equations.clone();
        again.b = residuals;
        let x = &found.x + &found.inverse * again.gram(&vec![1.0; motion.tau.len()]).g;
        let error = (0..base).map(|k| (x[k] - truth[k]).abs()).fold(0.0, f64::max);
        assert!(error < 1e-9 * truth.amax(), "{}: {error:e}", arm.name);
    }
}

fn input(arm: &Arm, text: &str) -> Input {
    let (log, findings) = read("log.csv", text.as_bytes(), &format(arm));
    assert!(!findings.has_errors(), "{}", findings.render());
    Input { log, ..Input::default() }
}

fn identified(arm: &Arm, inputs: &[Input], options: &Options) -> Identified {
    let mut findings = Findings::default();
    identify(arm, inputs, options, &mut findings).unwrap_or_else(|| panic!("{}", findings.render()))
}

/// A log without noise gives the truth back to its digits: parameters, friction, and that nothing is late; a long one, too, by parts of which
/// terms of friction are chosen.
#[test]
fn a_log_without_noise_gives_parameters_friction_and_no_delay() {
    for (seed, seconds) in [(5, 20.0), (6, 20.0), (7, 20.0), (8, 160.0)] {
        let arm = arm(ELBOW);
        let text = csv(&arm, &motion(ELBOW, seed, seconds, 100.0), 8);
        let found = identified(&arm, &[input(&arm, &text)], &Options::default());
        let truth = &arm.combination * arm.nominal();
        for (k, base) in found.base.iter().enumerate() {
            let error = (base.value - truth[k]).abs();
            assert!(error < 1e-5 * truth.amax(), "{}: {} and not {}", arm.base[k].name, base.value, truth[k]);
        }
        for of in &found.friction {
            let truth = arm.joints[of.joint].friction[of.term as usize].unwrap_or(0.0);
            assert!((of.value.value - truth).abs() < 1e-4 * (1.0 + truth.abs()), "{of:?} {truth}");
        }
        assert!(found.delays.iter().all(|delay| delay.value.abs() < 1e-6), "{:?}", found.delays);
        assert!(found.judgements[0].moving.iter().all(|moving| *moving < 1e-4), "{:?}", found.judgements[0].moving);
    }
}

/// A log of 30 s with currents that have noise, of an arm that carries a mass, which is known.
fn currents(arm: &Arm, text: &str, gains: &[f64], mass: f64, seed: u64, random: &mut Random) -> Input {
    let payload = format!("payload: {{mass: {mass}, com: [0.02, 0.01, 0.06]}}");
    let truth = if mass > 0.0 { format!("{text}{payload}\n") } else { text.to_owned() };
    let mut motion = motion(&truth, seed, 30.0, 100.0);
    for (k, tau) in motion.tau.iter_mut().enumerate() {
        *tau = (*tau + 0.5 * random.normal()) / gains[k % gains.len()];
    }
    let mut input = input(arm, &csv(arm, &motion, 6).replace(",tau_", ",current_"));
    if mass > 0.0 {
        input.load = Load { is_there: true, mass: Some(mass), com: None };
    }
    input
}

/// Drive gains from currents with and without a known load, from gains that are wrong by a fifth.
#[test]
fn gains_come_from_a_known_load() {
    let arm = arm(ELBOW);
    let gains = [14.0, 10.5, 10.0];
    let mut random = Random(9);
    let mut currents = |mass: f64, seed: u64| currents(&arm, ELBOW, &gains, mass, seed, &mut random);
    let free = currents(0.0, 1);
    let loaded = currents(3.0, 2);
    let options = Options { gains: Gains::Identify, ..Options::default() };
    let found = identified(&arm, &[free, loaded], &options);
    for j in [1, 2] {
        let gain = found.gains[j];
        assert!(gain.excited && (gain.value / gains[j] - 1.0).abs() < 0.03, "{j}: {gain:?}");
        assert!(gain.low < gains[j] && gains[j] < gain.high, "{j}: {gain:?}");
    }
}

/// Numbers are the same in every order of the logs. Beside gains that are off by a quarter, residuals of a slide that carries weight are of one
/// sign throughout a log.
#[test]
fn the_order_of_logs_changes_no_number() {
    let arm = arm(SCARA);
    let mut random = Random(3);
    let logs = [(0.0, 1), (3.0, 2), (0.0, 3)].map(|(mass, seed)| currents(&arm, SCARA, &[12.5; 3], mass, seed, &mut random));
    let options = Options { gains: Gains::Identify, ..Options::default() };
    let of = |inputs: &[Input]| {
        let found = identified(&arm, inputs, &options);
        let friction = found.friction.iter().map(|of| of.value);
        let all: Vec<_> = found.gains.iter().chain(&found.base).chain(&found.delays).copied().chain(friction).collect();
        assert!(found.gains[2].low < 12.5 && 12.5 < found.gains[2].high && found.delays.iter().all(|of| of.excited), "{all:?}");
        all
    };
    let first = of(&logs);
    let mut inputs = logs.to_vec();
    for _ in 0..2 {
        for k in 1..inputs.len() {
            inputs.swap(k, (random.unit() * (k + 1) as f64) as usize);
        }
        let other = of(&inputs);
        assert_eq!(first.len(), other.len());
        for (a, b) in first.iter().zip(&other) {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(b.abs());
            assert!(near(a.value, b.value) && near(a.low, b.low) && near(a.high, b.high), "{a:?} {b:?}");
        }
    }
}

/// A mass that is given and is not that of the log has a word; the right one has none.
#[test]
fn a_wrong_mass_of_a_load_is_named() {
    let arm = arm(ELBOW);
    let holding = format!("{ELBOW}payload: {{mass: 3, com: [0.02, 0.01, 0.06]}}\n");
    let logs: Vec<Input> = [(ELBOW, 1), (holding.as_str(), 2)]
        .into_iter()
        .map(|(text, seed)| {
            let mut motion = motion(text, seed, 20.0, 50.0);
            let mut random = Random(seed);
            motion.tau.iter_mut().for_each(|tau| *tau += 0.3 * random.normal());
            let mut input = input(&arm, &csv(&arm, &motion, 6));
            input.log.name = format!("{seed}.csv");
            input
        })
        .collect();
    let of = |mass: f64, com: Option<[f64; 3]>, both: bool| {
        let mut inputs = logs.clone();
        inputs[1].load = Load { is_there: true, mass: Some(mass), com };
        let mut findings = Findings::default();
        identify(&arm, &inputs[if both { 0 } else { 1 }..], &Options::default(), &mut findings).expect("good logs");
        let said = findings.iter().filter(|of| of.code == Code::LoadSuspected);
        said.map(|of| (of.log.clone(), of.text.clone())).collect::<Vec<_>>()
    };
    for com in [None, Some([0.02, 0.01, 0.06])] {
        assert!(of(3.0, com, true).is_empty());
        let said = of(2.0, com, true);
        assert!(
            said.len() == 1 && said[0].0 == "2.csv" && said[0].1.starts_with("the load of 2 kg fits better with "),
            "{said:?}"
        );
    }
    // A loaded log alone does not tell a load from the arm.
    assert!(of(2.0, None, false).is_empty());
}

/// What a locked joint hides is kept, and the rest is that of the same motion; the log of a frozen column names the remedy.
#[test]
fn a_locked_joint_is_left_out() {
    let arm = arm(ELBOW);
    for (joint, name) in [(0, "base"), (1, "shoulder"), (2, "elbow")] {
        let guess = crate::arms::arm(
            &ELBOW.replace("mass: 7", "mass: 5.5").replace("viscous: 6", "viscous: 1").replace("mass: 3", "mass: 2"),
        );
        let mut motion = crate::arms::locked_motion(ELBOW, 5, 20.0, 100.0, joint, 0.4);
        let mut random = Random(2);
        motion.tau.iter_mut().enumerate().for_each(|(k, tau)| {
            *tau += if k % 3 == joint { 30.0 * random.normal() } else { 0.05 * random.normal() };
        });
        motion.dq.iter_mut().for_each(|dq| *dq += 1e-3 * random.normal());
        let log = csv(&arm, &motion, 6);
        let mut findings = Findings::default();
        assert!(identify(&guess, &[input(&guess, &log)], &Options::default(), &mut findings).is_none());
        let said = findings.iter().find(|of| of.code == Code::UnexcitedJoint).expect("it does not move");
        assert!(said.column == format!("q_{name}") && said.help.contains(&format!("`--without {name}`")), "{said}");
        let options = Options { without: vec![name.to_owned()], ..Options::default() };
        let found = identified(&guess, &[input(&guess, &log)], &options);
        assert!(found.unexcited.is_empty(), "{name}: {:?}", found.unexcited);
        assert!(joint == 0 || found.inseparable.iter().any(|words| words.starts_with(&format!("without {name}, "))), "{name}");
        assert!(found.friction.iter().all(|of| of.joint != joint) && !found.delays[joint].excited);
        for of in &found.friction {
            let truth = arm.joints[of.joint].friction[of.term as usize].unwrap_or(0.0);
            assert!(of.value.low < truth && truth < of.value.high, "{name}: {of:?} {truth}");
        }
        // Torques of free joints in another motion with the joint locked there.
        let other = crate::arms::locked_motion(ELBOW, 9, 5.0, 100.0, joint, 0.4);
        let without_friction = without_friction(ELBOW);
        let truth = crate::arms::arm(&without_friction);
        let pi = &truth.combination * truth.nominal();
        let found_pi: Vec<f64> = found.base.iter().map(|of| of.value).collect();
        let torques = [pi.as_slice(), &found_pi].map(|pi| arm.torque(&other.q, &other.dq, &other.ddq, pi));
        for j in (0..3).filter(|&j| j != joint) {
            let size = crate::arms::rms(torques[0].iter().skip(j).step_by(3));
            let apart: Vec<f64> = torques[0].iter().zip(&torques[1]).skip(j).step_by(3).map(|(a, b)| a - b).collect();
            assert!(crate::arms::rms(apart.iter()) < 0.03 * size, "{name}, {j}: {} {size}", crate::arms::rms(apart.iter()));
        }
    }
    // A joint that moves is not locked, and a name is one of the arm's.
    let log = csv(&arm, &motion(ELBOW, 5, 12.0, 100.0), 6);
    for (name, words) in
        [("elbow", "joint `elbow` is left out as a locked joint, and moves from"), ("elbw", "`without` has `elbw`")]
    {
        let mut findings = Findings::default();
        let options = Options { without: vec![name.to_owned()], ..Options::default() };
        assert!(identify(&arm, &[input(&arm, &log)], &options, &mut findings).is_none());
        assert!(findings.iter().any(|of| of.code == Code::BadOptions && of.text.starts_with(words)), "{}", findings.render());
    }
}

/// A torque that no body and no friction exerts raises the sum of squares of those that exist, at its joint; and validation names a bad fit.
#[test]
fn a_rise_is_seen_at_its_joint_and_validation_names_poor_fits() {
    let arm = arm(ELBOW);
    let mut random = Random(6);
    for (part, is_poor) in [(0.0, false), (0.25, true)] {
        let mut motion = motion(ELBOW, 5, 20.0, 100.0);
        for k in 0..motion.t.len() {
            // Less inertia than a rotor may take away.
            motion.tau[3 * k + 2] -= part * motion.ddq[3 * k + 2];
        }
        motion.tau.iter_mut().for_each(|tau| *tau += 0.1 * random.normal());
        let found = identified(&arm, &[input(&arm, &csv(&arm, &motion, 6))], &Options::default());
        let (rise, joints) = rise(&arm, &found.reduced, &consistent(&arm, &found.reduced));
        println!("{part}: {rise} {joints:?}");
        assert_eq!(rise > 1.0, is_poor, "{rise}");
        assert!(!is_poor || joints[2] > joints[0].max(joints[1]), "{joints:?}");
    }
    let model = Model {
        pi: (&arm.combination * arm.nominal()).as_slice().to_vec(),
        friction: arm.joints.iter().map(|joint| joint.friction.map(Option::unwrap_or_default)).collect(),
        velocities: vec![0.1; 3],
        delays: Some(vec![0.0; 3]),
        spreads: None,
        covariance: None,
    };
    for spoilt in 0..3 {
        let mut motion = motion(ELBOW, 6, 10.0, 100.0);
        motion.tau.iter_mut().skip(spoilt).step_by(3).for_each(|tau| *tau *= 2.0);
        let log = input(&arm, &csv(&arm, &motion, 6)).log;
        let mut findings = Findings::default();
        poor_fits(&arm, &log, &judge(&arm, &log, &model), &mut findings);
        let said: Vec<_> = findings.iter().map(|of| (of.code, of.line, of.column.as_str())).collect();
        assert_eq!(said, [(Code::PoorFit, 0, format!("tau_{}", arm.joints[spoilt].name).as_str())]);
    }
}
