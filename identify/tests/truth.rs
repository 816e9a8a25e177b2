//! Numbers that come back: base parameters, friction, gains, loads.

use armgen_identify::arm::Arm;
use armgen_identify::finding::Findings;
use armgen_identify::fit::{solve, Equations, Row};
use armgen_identify::identify::{identify, Identified, Input};
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
        let equations = Equations { columns: base, a, b, rows };
        let gram = equations.gram(&vec![1.0; motion.tau.len()]);
        let truth = &arm.combination * arm.nominal();
        let found = solve(&gram, &DVector::zeros(base));
        assert!(found.hidden.is_empty());
        // One step of refinement from the residuals themselves: normal equations lose half of the digits.
        let active: Vec<usize> = (0..base).collect();
        let residuals = equations.residuals(&active, &found.x);
        let again = Equations { b: residuals, ..equations.clone() };
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

/// A log without noise gives the truth back, and torques of other motions.
#[test]
fn a_log_without_noise_gives_the_friction_and_the_torques_of_another_motion() {
    let arm = arm(ELBOW);
    let text = csv(&arm, &motion(ELBOW, 5, 20.0, 100.0), 6);
    let found = identified(&arm, &[input(&arm, &text)], &Options::default());
    let truth = &arm.combination * arm.nominal();
    for (k, base) in found.base.iter().enumerate() {
        let error = (base.value - truth[k]).abs();
        assert!(error < 3e-3 * truth.amax(), "{}: {} and not {}", arm.base[k].name, base.value, truth[k]);
    }
    for of in &found.friction {
        let truth = arm.joints[of.joint].friction[of.term as usize].unwrap_or(0.0);
        assert!((of.value.value - truth).abs() < 0.05 + 0.03 * truth.abs(), "{of:?} {truth}");
    }
    assert!(found.judgements[0].moving.iter().all(|moving| *moving < 4e-3), "{:?}", found.judgements[0].moving);
}

/// Drive gains from currents with and without a known load, from gains that are wrong by a fifth.
#[test]
fn gains_come_from_a_known_load() {
    let arm = arm(ELBOW);
    let gains = [14.0, 10.5, 10.0];
    let mut random = Random(9);
    let mut currents = |mass: f64, seed: u64| {
        let payload = format!("payload: {{mass: {mass}, com: [0.02, 0.01, 0.06]}}");
        let truth = if mass > 0.0 { format!("{ELBOW}{payload}\n") } else { ELBOW.to_owned() };
        let mut motion = motion(&truth, seed, 30.0, 100.0);
        for (k, tau) in motion.tau.iter_mut().enumerate() {
            *tau = (*tau + 0.5 * random.normal()) / gains[k % 3];
        }
        let text = csv(&arm, &motion, 6).replace(",tau_", ",current_");
        input(&arm, &text)
    };
    let free = currents(0.0, 1);
    let mut loaded = currents(3.0, 2);
    loaded.load = Load { is_there: true, mass: Some(3.0), com: None };
    let options = Options { gains: Gains::Identify, ..Options::default() };
    let found = identified(&arm, &[free, loaded], &options);
    for j in [1, 2] {
        let gain = found.gains[j];
        assert!(gain.excited && (gain.value / gains[j] - 1.0).abs() < 0.03, "{j}: {gain:?}");
        assert!(gain.low < gains[j] && gains[j] < gain.high, "{j}: {gain:?}");
    }
}
