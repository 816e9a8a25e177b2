//! Columns under other signs, other joints and other units: each joint and each pair is named.

use armgen_identify::consistent::{consistent, rise};
use armgen_identify::finding::{Code, Findings};
use armgen_identify::identify::{identify, Identified, Input};
use armgen_identify::log::read;
use armgen_identify::options::Options;

use crate::arms::{arm, csv, format, motion, Motion, Random, ELBOW, SCARA};

/// What an identification finds in a log with noise that `change` has spoilt.
fn found(text: &str, change: &dyn Fn(&mut Motion)) -> Findings {
    identified(text, change).1
}

fn identified(text: &str, change: &dyn Fn(&mut Motion)) -> (Option<Identified>, Findings) {
    let arm = arm(text);
    let mut motion = motion(text, 4, 15.0, 50.0);
    let n = arm.dof();
    let mut random = Random(8);
    let sizes: Vec<f64> = (0..n).map(|j| motion.tau.iter().skip(j).step_by(n).fold(0.0f64, |a, x| a.max(x.abs()))).collect();
    motion.tau.iter_mut().enumerate().for_each(|(k, tau)| *tau += 0.01 * sizes[k % n] * random.normal());
    change(&mut motion);
    let (log, mut findings) = read("log.csv", csv(&arm, &motion, 6).as_bytes(), &format(&arm));
    let found = identify(&arm, &[Input { log, ..Input::default() }], &Options::default(), &mut findings);
    (found, findings)
}

/// The columns and texts of a code.
fn of(findings: &Findings, code: Code) -> Vec<(&str, &str)> {
    findings
        .iter()
        .filter(|finding| finding.code == code)
        .map(|finding| (finding.column.as_str(), finding.text.as_str()))
        .collect()
}

#[test]
fn every_pattern_of_turned_torques_is_named_and_not_its_complement() {
    for text in [ELBOW, SCARA] {
        let arm = arm(text);
        let n = arm.dof();
        for pattern in 0..1usize << n {
            let turned = |j: usize| pattern >> j & 1 == 1;
            let findings = found(text, &|motion| {
                (0..motion.tau.len()).filter(|k| turned(k % n)).for_each(|k| motion.tau[k] *= -1.0);
            });
            let columns: Vec<String> = (0..n).filter(|&j| turned(j)).map(|j| format!("tau_{}", arm.joints[j].name)).collect();
            let named = match columns.len() {
                0 => {
                    assert!(!findings.has_errors(), "{}", findings.render());
                    continue;
                }
                all if all == n => "all torques".to_owned(),
                _ => columns.join(", "),
            };
            let said = of(&findings, Code::SignSuspected);
            assert!(said.len() == 1 && said[0].1.contains(&format!("the sign of {named} is turned")), "{}", findings.render());
        }
    }
}

/// Exchanges joints i and k of a state-by-state signal.
fn exchange(x: &mut [f64], n: usize, i: usize, k: usize) {
    x.chunks_exact_mut(n).for_each(|state| state.swap(i, k));
}

#[test]
fn every_pair_of_exchanged_joints_is_named() {
    for text in [ELBOW, SCARA] {
        let arm = arm(text);
        let n = arm.dof();
        for (i, k) in [(0, 1), (0, 2), (1, 2)] {
            for whole in [true, false] {
                let findings = found(text, &|motion| {
                    exchange(&mut motion.q, n, i, k);
                    exchange(&mut motion.dq, n, i, k);
                    if whole {
                        exchange(&mut motion.tau, n, i, k);
                    }
                });
                let name = |j: usize| &arm.joints[j].name;
                let torque = |j: usize| if whole { format!(", tau_{}", name(j)) } else { String::new() };
                let words = |j: usize, of: usize| format!("q_{0}, dq_{0}{1} hold those of {2}", name(j), torque(j), name(of));
                let named = format!("{}; {}", words(i, k), words(k, i));
                let said = of(&findings, Code::JointOrder);
                assert!(said.len() == 1 && said[0].1.contains(&named), "{named}\n{}", findings.render());
            }
        }
    }
}

/// A slide and a turn about one axis at the end, which hardly act on the joints before them.
fn scara_with_a_turn() -> String {
    SCARA.replace(
        "regressor: base",
        "  - {name: j4, type: revolute, a: 0, alpha: 0, d: 0, theta: 0,
     link: {mass: 1, com: [0.01, 0.005, 0.03], inertia: {xx: 0.002, yy: 0.002, zz: 0.003}},
     motor: {ratio: 20, inertia: 3e-4}, friction: {viscous: 0.2, coulomb: 0.8}}
regressor: base",
    )
}

/// A slide under the name of a turn fits as well: its mass and rotor tell.
#[test]
fn a_slide_and_a_turn_about_one_axis_are_told_apart() {
    let text = scara_with_a_turn();
    assert!(!found(&text, &|_| {}).has_errors());
    for (i, k) in [(0, 3), (1, 3), (2, 3)] {
        let findings = found(&text, &|motion| {
            [&mut motion.q, &mut motion.dq, &mut motion.tau].map(|x| exchange(x, 4, i, k)).into_iter().collect()
        });
        let words = |j: usize, of: usize| format!("q_j{0}, dq_j{0}, tau_j{0} hold those of j{of}", j + 1, of = of + 1);
        let named = format!("{}; {}", words(i, k), words(k, i));
        let said = of(&findings, Code::JointOrder);
        assert!(
            said.len() == 1 && said[0].1.contains(&named) && said[0].0 == format!("q_j{}", i + 1),
            "{named}\n{}",
            findings.render()
        );
    }
}

/// Two joints of one kind whose exchange fits as well are told by their inertias, in a warning: the turning joints of a SCARA whose forearm is light.
/// The right order of a description that is far off is not, and neither is what noise hides.
#[test]
fn inertias_tell_only_what_they_show() {
    let order = |guess: &str, truth: &str, noise: f64, exchanged: Option<(usize, usize)>| {
        let arm = arm(guess);
        let (n, mut motion) = (arm.dof(), motion(truth, 4, 15.0, 50.0));
        let mut random = Random(8);
        for j in 0..n {
            let size = crate::arms::rms(motion.tau.iter().skip(j).step_by(n));
            motion.tau.iter_mut().skip(j).step_by(n).for_each(|tau| *tau += noise * size * random.normal());
        }
        if let Some((i, k)) = exchanged {
            [&mut motion.q, &mut motion.dq, &mut motion.tau].into_iter().for_each(|x| exchange(x, n, i, k));
        }
        let (log, mut findings) = read("log.csv", csv(&arm, &motion, 6).as_bytes(), &format(&arm));
        identify(&arm, &[Input { log, ..Input::default() }], &Options::default(), &mut findings);
        let mut orders = findings.iter().filter(|of| of.code == Code::JointOrder);
        orders.next().map(|of| of.text.clone())
    };
    let truth = scara_with_a_turn();
    // Numbers of a description that are off, but not by the factor that tells.
    let off = truth
        .replace("ratio: 300, inertia: 2e-5", "ratio: 300, inertia: 4e-6")
        .replace("ratio: 20, inertia: 3e-4", "ratio: 20, inertia: 6e-4");
    assert_eq!(order(&off, &truth, 0.01, None), None);
    assert!(order(&off, &truth, 0.01, Some((2, 3))).is_some());
    // Numbers in the wrong order, which the log does not refute.
    let wrong = truth.replace("ratio: 20, inertia: 3e-4", "ratio: 20, inertia: 3e-2");
    assert_eq!(order(&wrong, &truth, 3.0, None), None);
    // A light forearm: the exchange of both turning joints fits as well.
    let light = SCARA
        .replace(
            "mass: 6, com: [0.15, -0.02, 0.03], inertia: {xx: 0.03, yy: 0.06, zz: 0.07}",
            "mass: 0.6, com: [0.02, 0, 0.03], inertia: {xx: 0.01, yy: 0.01, zz: 0.01}",
        )
        .replace("mass: 2.5", "mass: 0.25")
        .replace(
            "ratio: 80, inertia: 1e-4}, friction: {viscous: 2, coulomb: 3}",
            "ratio: 80, inertia: 4e-4}, friction: {viscous: 2, coulomb: 3}",
        );
    println!("{:?}", order(&light, &light, 0.05, Some((0, 1))));
    assert_eq!(order(&light, &light, 0.05, None), None);
    assert!(order(&light, &light, 0.05, Some((0, 1))).is_some_and(|text| text.starts_with("inertias come near")));
}

/// A joint that is turned in position and rate, or in its torque too, where the arm is no mirror image of itself.
#[test]
fn a_turned_joint_is_named() {
    let turned = |joint: usize, whole: bool| {
        found(ELBOW, &|motion| {
            let signals = [Some(&mut motion.q), Some(&mut motion.dq), whole.then_some(&mut motion.tau)];
            signals.into_iter().flatten().for_each(|x| x.iter_mut().skip(joint).step_by(3).for_each(|x| *x *= -1.0));
        })
    };
    for (joint, name) in [(1, "shoulder"), (2, "elbow")] {
        for whole in [true, false] {
            let findings = turned(joint, whole);
            let said = of(&findings, Code::SignSuspected);
            let torque = if whole { format!(", tau_{name}") } else { String::new() };
            let named = format!("with the other sign of q_{name}, dq_{name}{torque}");
            let is_right = said.len() == 1 && said[0].1.ends_with(&named) && said[0].0 == format!("q_{name}");
            assert!(is_right && findings.has_errors(), "{named}\n{}", findings.render());
        }
    }
    // About a vertical axis the mirror image of the arm moves as this one does: the torque alone seems to be turned, or nothing.
    let said = turned(0, false);
    assert!(of(&said, Code::SignSuspected)[0].1.contains("the sign of tau_base is turned"), "{}", said.render());
    assert!(!turned(0, true).has_errors());
}

/// Turns joints in position, rate and torque.
fn turn(motion: &mut Motion, n: usize, joints: &[usize]) {
    for x in [&mut motion.q, &mut motion.dq, &mut motion.tau] {
        x.iter_mut().enumerate().filter(|(k, _)| joints.contains(&(k % n))).for_each(|(_, x)| *x *= -1.0);
    }
}

/// The mirror image of a SCARA has both turning joints turned, so one turned joint is the image of the other: both are named. A slide along gravity
/// that is turned has a negative mass.
#[test]
fn a_turned_joint_of_a_scara_is_named_with_its_image() {
    for (turned, named) in [(0, ["j1", "j2"].as_slice()), (1, ["j1", "j2"].as_slice()), (2, ["j3"].as_slice())] {
        let findings = found(SCARA, &|motion| turn(motion, 3, &[turned]));
        let said = of(&findings, Code::SignSuspected);
        assert!(said.len() == 1, "{}", findings.render());
        for name in named {
            assert!(said[0].1.contains(&format!("with the other sign of q_{name}, dq_{name}, tau_{name}")), "{}", said[0].1);
        }
    }
}

/// Exact symmetries: the mirror image of the arm explains a log with turned joints to its last digit, so no log shows them. The rotor of a slide along
/// gravity turns as the arm does, which is no symmetry: it is left out.
#[test]
fn mirror_images_explain_turned_logs_exactly() {
    let scara = SCARA.replace("motor: {ratio: 300, inertia: 2e-5}, friction: {viscous: 30", "friction: {viscous: 30");
    for (text, turned) in [(ELBOW, [0].as_slice()), (scara.as_str(), [0, 1].as_slice())] {
        let arm = arm(text);
        let mut motion = motion(text, 4, 15.0, 100.0);
        turn(&mut motion, 3, turned);
        let (log, mut findings) = read("log.csv", csv(&arm, &motion, 8).as_bytes(), &format(&arm));
        let found = identify(&arm, &[Input { log, ..Input::default() }], &Options::default(), &mut findings);
        let found = found.unwrap_or_else(|| panic!("{}", findings.render()));
        let named = findings.iter().any(|of| matches!(of.code, Code::SignSuspected | Code::JointOrder | Code::PoorFit));
        assert!(!named, "{}", findings.render());
        assert!(found.judgements[0].moving.iter().all(|moving| *moving < 1e-4), "{:?}", found.judgements[0].moving);
        // Its bodies exist, too.
        let (rise, _) = rise(&arm, &found.reduced, &consistent(&arm, &found.reduced));
        assert!(rise < 1.0, "{rise}");
    }
}

#[test]
fn degrees_throughout_are_seen_at_the_limits() {
    let limited = ELBOW.replace("limits: {effort", "limits: {position: [-3, 3], velocity: 4, effort");
    for joint in 0..3 {
        // Frozen before and after the motion, as logs are; one joint alone moves far.
        let findings = found(&limited, &|motion| {
            for x in [&mut motion.q, &mut motion.dq] {
                x.iter_mut()
                    .enumerate()
                    .for_each(|(k, x)| *x *= 180.0 / std::f64::consts::PI * if k % 3 == joint { 1.0 } else { 0.1 });
                (0..120).for_each(|k| x[k] = x[120 + k % 3]);
            }
            (0..120).for_each(|k| motion.dq[k] = 0.0);
        });
        let said = of(&findings, Code::DegreesSuspected);
        assert!(said.len() == 1 && findings.iter().all(|of| of.code != Code::StuckSignal), "{}", findings.render());
        assert_eq!(said[0].0, format!("q_{}", arm(ELBOW).joints[joint].name));
    }
    assert!(!found(&limited, &|_| {}).has_errors());
}

#[test]
fn turns_of_an_encoder_have_their_line() {
    for joint in 0..3 {
        let findings = found(ELBOW, &|motion| {
            let turned = |x: f64| (x + std::f64::consts::PI - 0.3).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI + 0.3;
            motion.q.iter_mut().skip(joint).step_by(3).for_each(|q| *q = turned(*q + 3.0));
        });
        let line = findings.iter().find(|of| of.code == Code::RateMismatch).map(|of| (of.line, of.column.clone()));
        assert!(line.as_ref().is_some_and(|(line, column)| *line > 2 && column.starts_with("q_")), "{}", findings.render());
        assert!(of(&findings, Code::RateMismatch)[0].1.contains("the encoder wraps"), "{}", findings.render());
    }
}

#[test]
fn rates_of_another_slope_or_a_lag_are_named() {
    for joint in 0..3 {
        let column = format!("dq_{}", arm(ELBOW).joints[joint].name);
        for (cutoff, slope, words) in [(0.0, 1.1, "is 1.1"), (0.0, 0.9, "is 0.9"), (5.0, 1.0, "behind"), (2.0, 1.0, "behind")] {
            let findings = found(ELBOW, &|motion| {
                let mut random = Random(3);
                motion.q.iter_mut().for_each(|q| *q += 1e-4 * random.normal());
                let share = if cutoff > 0.0 { 1.0 - (-std::f64::consts::TAU * cutoff / 50.0f64).exp() } else { 1.0 };
                let mut last = motion.dq[joint];
                for dq in motion.dq.iter_mut().skip(joint).step_by(3) {
                    last += share * (*dq - last);
                    *dq = slope * last + 1e-3 * random.normal();
                }
            });
            let said = of(&findings, Code::RateMismatch);
            assert!(said.len() == 1 && said[0].0 == column && said[0].1.contains(words), "{words}\n{}", findings.render());
        }
    }
}

#[test]
fn intervals_reach_to_both_sides_and_coloured_residuals_are_named() {
    let (found, findings) = identified(ELBOW, &|_| {});
    let found = found.unwrap_or_else(|| panic!("{}", findings.render()));
    let all = found.base.iter().chain(found.friction.iter().map(|of| &of.value));
    let inside = |of: &armgen_identify::identify::Interval| (of.value - of.low).min(of.high - of.value) / (of.high - of.low);
    let least = all.map(inside).fold(1.0, f64::min);
    assert!(least > 0.01, "{least}");
    let slow = found_help(&|motion| {
        (0..motion.tau.len()).for_each(|k| motion.tau[k] += 6.0 * (1.3 * motion.t[k / 3]).sin());
    });
    assert!(slow.contains("the model or the log is wrong"), "{slow}");
    assert!(found_help(&|_| {}).contains("log 30 s"));
}

/// The remedy of a log with few stretches of time.
fn found_help(change: &dyn Fn(&mut Motion)) -> String {
    let findings = found(ELBOW, change);
    let found = findings.iter().find(|of| of.code == Code::ShortLog);
    found.map_or_else(|| findings.render(), |of| of.help.clone())
}
