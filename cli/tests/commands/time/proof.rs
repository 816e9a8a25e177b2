//! `armgen verify` on a timing: proved again, and refused after a change.

use std::fs;

use serde_json::Value;

use super::{armgen, err, file, number, numbers, out, own_folder, timed, CRANE, PENDULUM, SCARA_PATH, SLIDE};

/// The answer of `armgen verify` on a timing; "" where it is proved.
pub(super) fn refused(name: &str, robot: &str, timing: &Value) -> String {
    let folder = own_folder(&format!("verify-{name}"));
    let [arm, json] = ["robot.yaml", "timing.json"].map(|file| folder.join(file));
    fs::write(&arm, robot).expect("a file");
    fs::write(&json, timing.to_string()).expect("a file");
    let [arm, json] = [&arm, &json].map(|path| path.to_str().expect("a UTF-8 path"));
    let output = armgen(&["verify", arm, json]);
    assert_eq!(output.status.success(), out(&output).ends_with("verified\n"), "{}", err(&output));
    if output.status.success() {
        String::new()
    } else {
        err(&output)
    }
}

/// Friction of all kinds, a torque that binds, and a motor that needs momentum.
fn arms() -> Vec<(&'static str, String, &'static str)> {
    let curved = SLIDE.replace("coulomb: 2", "coulomb: 1, cubic: 0.4, stribeck: {torque: 2, velocity: 0.3}");
    vec![
        ("curved", curved, "points: [[0], [2]]\n"),
        ("slide", SLIDE.to_owned(), "points: [[0], [2]]\n"),
        ("pendulum", PENDULUM.to_owned(), "points: [[0], [2]]\n"),
        ("momentum", PENDULUM.to_owned(), "points: [[0], [3]]\nlimits: {effort: [8]}\n"),
    ]
}

fn verified(name: &str, robot: &str, path: &str) -> Value {
    let (_, _, timing) = timed(&format!("verified-{name}"), robot, path, &["--gap", "0.005"], 0);
    assert_eq!(refused(name, robot, &timing), "", "{name}");
    timing
}

#[test]
fn a_timing_is_proved_again() {
    for (name, robot, path) in arms() {
        let timing = verified(name, &robot, path);
        // Another arm: 1 % more mass.
        let heavier = robot.replace("mass: 2,", "mass: 2.02,").replace("mass: 1,", "mass: 1.01,");
        assert!(refused(name, &heavier, &timing).contains("not proved: at s = "), "{name}");
    }
    // Four joints.
    let scara = fs::read_to_string(file("robots/scara.yaml")).expect("a description");
    verified("scara", &scara, SCARA_PATH);
    // Nodes at which no pair of rows excludes all larger speeds, but one pair after the other does.
    verified("crane", CRANE, "points: [[0, 0], [1, 1], [2, 0]]\nlimits: {acceleration: [8, 4]}\n");
    // A motion that does not rest at its ends.
    verified("passing", PENDULUM, "points: [[0], [1], [2]]\ncurve: through\nends: {speed: [0.7, 1.1]}\n");
    // Joints that turn round, with friction that is no line of the rate.
    let friction = "friction: {coulomb: 1, cubic: 0.5, stribeck: {torque: 4, velocity: 0.1}}, limits: {velocity: 2";
    let curved = CRANE.replace("limits: {velocity: 2", friction).replace("effort: 100", "effort: 40");
    verified("crane-curved", &curved, "points: [[0, 0], [1, 1], [2, 0]]\nlimits: {effort: {boom: 8}}\n");
    let (name, robot, _) = &arms()[1];
    let mut cut = verified(name, robot, "points: [[0], [2]]\n");
    cut["grid"]["k"].as_array_mut().expect("a list").pop();
    assert!(refused(name, robot, &cut).contains("lengths of its lists"));
}

/// Every digit that matters, in all lists.
#[test]
#[ignore = "wide"]
fn changed_digits_of_a_timing_are_refused() {
    let mut count = 0;
    for (name, robot, path) in arms() {
        let timing = verified(name, &robot, path);
        let mut changed = |pointer: &str, by: f64| {
            let mut timing = timing.clone();
            let value = timing.pointer_mut(pointer).unwrap_or_else(|| panic!("{name}: {pointer}"));
            *value = number(value).mul_add(1.0 + by, by * 1e-3).into();
            count += 1;
            let why = refused(name, &robot, &timing);
            assert!(why.contains("timing.json: "), "{name}: {pointer} by {by} is accepted");
        };
        let segments = timing["grid"]["k"].as_array().expect("a list").len();
        for part in 1..10 {
            let i = part * segments / 10;
            for (list, by) in [("x", 1e-4), ("x", -1e-4), ("t", 1e-3), ("s", 1e-3)] {
                changed(&format!("/grid/{list}/{i}"), by);
            }
            if timing["bound"]["row"][i].is_string() {
                ["x0", "x2"].into_iter().for_each(|list| changed(&format!("/bound/{list}/{i}"), -1e-2));
            }
        }
        for (pointer, by) in [("/duration", -1e-6), ("/duration", 1e-6), ("/lower_bound", 1e-3)] {
            changed(pointer, by);
        }
        changed("/path/coefficients/0/0/1", 1e-3);
    }
    assert!(count > 150, "{count}");
}

/// The places of all numbers of a document.
fn places(of: &Value, at: &str, found: &mut Vec<String>) {
    match of {
        Value::Number(_) => found.push(at.to_owned()),
        Value::Array(all) => all.iter().enumerate().for_each(|(k, of)| places(of, &format!("{at}/{k}"), found)),
        Value::Object(all) => all.iter().for_each(|(key, of)| places(of, &format!("{at}/{key}"), found)),
        _ => {}
    }
}

/// The largest share of a limit of a timing of one joint, at 28 places of each segment; `torque` takes q, dq, ddq and the
/// direction of the path.
fn largest_share(timing: &Value, torque: &dyn Fn(f64, f64, f64, f64) -> f64) -> f64 {
    let of = |key: &str| numbers(&timing["grid"][key]);
    let (s, x, k) = (of("s"), of("x"), of("k"));
    let knots = numbers(&timing["path"]["knots"]);
    let limit = |key: &str| timing["limits"][key][0].as_f64().unwrap_or(f64::INFINITY);
    let effort = &timing["limits"]["effort"][0];
    let mut most = 0.0f64;
    for i in 0..k.len() {
        let h = s[i + 1] - s[i];
        let middle = 0.5 * (x[i] + x[i + 1]) + k[i];
        for place in 0..28 {
            let (b, at) = (f64::from(place) / 27.0, s[i] + h * f64::from(place) / 27.0);
            let a = 1.0 - b;
            let x_here = x[i] * a * a + 2.0 * middle * a * b + x[i + 1] * b * b;
            let u = ((middle - x[i]) * a + (x[i + 1] - middle) * b) / h;
            let piece = knots.iter().rposition(|knot| *knot <= at).unwrap_or(0).min(knots.len() - 2);
            let powers = numbers(&timing["path"]["coefficients"][piece][0]);
            let t = at - knots[piece];
            let sum = |order: usize| -> f64 {
                let factor = |k: usize| (0..order).map(|i| (k - i) as f64).product::<f64>();
                (order..powers.len()).map(|k| factor(k) * powers[k] * t.powi((k - order) as i32)).sum()
            };
            let v = x_here.max(0.0).sqrt();
            let (dq, ddq) = (sum(1) * v, sum(1) * u + sum(2) * x_here);
            let tau = torque(sum(0), dq, ddq, sum(1).signum());
            let [low, high] = [0, 1].map(|k| effort[k].as_f64().unwrap_or(f64::INFINITY));
            most = most
                .max(dq.abs() / limit("velocity"))
                .max(ddq.abs() / limit("acceleration"))
                .max(tau / if tau < 0.0 { low } else { high });
        }
    }
    most
}

/// A thousand random changes of a number: a change that is accepted has a motion within its limits between all nodes, and no bound above the
/// optimum.
#[test]
#[ignore = "wide"]
fn no_change_is_accepted_that_samples_refute() {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let slide = |_: f64, dq: f64, ddq: f64, direction: f64| 2.0 * ddq + 1.5 * dq + 2.0 * direction;
    let curved = |_: f64, dq: f64, ddq: f64, direction: f64| {
        2.0 * ddq + 1.5 * dq + 0.4 * dq.powi(3) + (1.0 + 2.0 * (-dq.abs() / 0.3).exp()) * direction
    };
    let pendulum = |q: f64, _: f64, ddq: f64, _: f64| ddq + 9.81 * q.sin();
    let (mut accepted, mut changes) = (0, 0);
    for (name, robot, path) in arms() {
        let timing = verified(name, &robot, path);
        let given = armgen_codegen::source::Source::new("robot", &robot);
        let (manipulator, _) = armgen_codegen::validate::read(&given).0.expect("a valid arm");
        let torque: &dyn Fn(f64, f64, f64, f64) -> f64 = match name {
            "curved" => &curved,
            "slide" => &slide,
            _ => &pendulum,
        };
        assert!(largest_share(&timing, torque) <= 1.0 + 1e-9, "{name}");
        let mut all = Vec::new();
        places(&timing, "", &mut all);
        for _ in 0..334 {
            let mut changed = timing.clone();
            let place = &all[(random() * all.len() as f64) as usize];
            let value = changed.pointer_mut(place).expect("a number");
            let old = number(value);
            let new = match (random() * 4.0) as u8 {
                0 => old * (1.0 + (2.0 * random() - 1.0) * 10f64.powf(-9.0 * random())),
                1 => old + (2.0 * random() - 1.0) * 10f64.powf(-9.0 * random()),
                2 => -old,
                _ => 0.0,
            };
            *value = new.into();
            changes += usize::from(new != old);
            if armgen_verify::timing::check(&manipulator, &changed.to_string()).is_ok() {
                accepted += usize::from(new != old);
                let share = largest_share(&changed, torque);
                assert!(share <= 1.0 + 1e-9, "{name}: {place} from {old} to {new} is accepted, {share}");
                // Other limits, another path and other speeds at the ends have another optimum.
                let is_claim = ["/limits", "/path", "/ends"].iter().all(|start| !place.starts_with(start));
                let bound = number(&changed["lower_bound"]);
                assert!(!is_claim || bound <= number(&timing["duration"]), "{name}: {place} from {old} to {new}: {bound}");
            }
        }
    }
    println!("{accepted} of {changes} changes are accepted");
    assert!(changes > 900 && accepted < changes / 2, "{accepted} of {changes}");
}
