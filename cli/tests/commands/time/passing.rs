//! How a path is passed: stops, shares of the limits of speed, limits of the end effector; and their second proof.

use std::fs;

use serde_json::json;

use super::{check, err, number, numbers, out, own_folder, pieces, proof::refused, timed, CRANE, PENDULUM, PLANAR, SLIDE};

/// The duration and the bound, which belong together.
fn duration(timing: &serde_json::Value) -> f64 {
    let [duration, bound] = ["duration", "lower_bound"].map(|key| number(&timing[key]));
    assert!(bound <= duration && duration < 1.005 * bound, "{duration} {bound}");
    duration
}

#[test]
fn a_path_rests_where_it_stops() {
    let gap = &["--gap", "0.002"][..];
    let way = |name: &str, path: &str| timed(name, SLIDE, path, gap, 0);
    let (_, _, once) = way("once", "points: [[0], [1]]\n");
    for (name, path) in [
        ("on", "points: [[0], {q: [1], stop: true}, [2]]\n"),
        ("back", "points: [[0], {q: [1], stop: true}, {q: [0]}]\n"),
        ("through", "points: [[0], {q: [1], stop: true}, [0]]\ncurve: through\n"),
    ] {
        let (_, error, twice) = way(name, path);
        assert!(!error.contains("slow-point"), "{error}");
        assert!((duration(&twice) - 2.0 * duration(&once)).abs() < 0.01, "{name}: {} {}", duration(&twice), duration(&once));
        assert_eq!(twice["path"]["stops"], json!([1.0]));
        assert_eq!(refused(name, SLIDE, &twice), "", "{name}");
    }
    // A corner, and a corner of the tip: directions change, positions do not.
    let points = "points: [[0, 0], {q: [1, 1], stop: true}, [2, 0], [3, 0.5]]\ncurve: lines\nblend: 0.05\n";
    let (_, _, crane) = timed("corner", CRANE, points, gap, 0);
    let [lift, boom] = [0, 1].map(|joint| pieces(&crane, joint));
    assert_eq!((lift[0][2][1].signum(), boom[0][2][1].signum(), boom[1][0][1].signum()), (1.0, 1.0, -1.0));
    assert_eq!(refused("corner", CRANE, &crane), "");
    let tip =
        "tip:\n  points: [[1.5, 0.3, 0], {to: [1.2, 0.3, 0], stop: true}, [1.2, 0.8, 0]]\n  start: [-0.5, 1.2]\ncurve: lines\n";
    let (_, _, planar) = timed("tip", PLANAR, tip, gap, 0);
    let stop = number(&planar["path"]["stops"][0]);
    assert!((stop - 0.3).abs() < 1e-9, "{stop}");
    assert_eq!(refused("tip", PLANAR, &planar), "");
    // Without the stop, with speed at it, with another path behind it: no proof.
    let node = numbers(&crane["grid"]["s"]).iter().position(|s| *s == number(&crane["path"]["stops"][0])).expect("a node");
    for (pointer, value, why) in [
        ("/path/stops".to_owned(), json!([]), "jumps at s = "),
        (format!("/grid/x/{node}"), json!(1e-9), "the motion does not rest at s = "),
        ("/path/stops/0".to_owned(), json!(0.5), "knots inside the path"),
        ("/path/coefficients/1/0/0".to_owned(), json!(1.1), "jumps at s = "),
    ] {
        let mut changed = crane.clone();
        *changed.pointer_mut(&pointer).expect("a value") = value;
        let found = refused("corner-changed", CRANE, &changed);
        assert!(found.contains(why), "{pointer}: {found}");
    }
}

#[test]
fn speeds_are_shares_of_their_limits_near_a_point() {
    let path = |speed: &str| {
        let points = format!("[[0, 0], [0.5, 0.5], {{q: [1.5, 0.7], speed: {speed}}}, [2, 1]]");
        format!("points: {points}\nlimits: {{acceleration: [8, 8]}}\n")
    };
    let (_, _, full) = timed("full", CRANE, &path("1"), &["--gap", "0.002"], 0);
    let (text, _, slow) = timed("slow", CRANE, &path("0.2"), &["--gap", "0.002"], 0);
    assert!(duration(&slow) > 1.5 * duration(&full), "{} {}", duration(&slow), duration(&full));
    // Halfway to the points beside it, by s.
    let [knots, shares] = ["knots", "speed"].map(|key| numbers(&slow["path"][key]));
    let chord = [0.5f64.hypot(0.5), 1.0f64.hypot(0.2), 0.5f64.hypot(0.3)];
    let middles = [chord[0] + 0.5 * chord[1], chord[0] + chord[1] + 0.5 * chord[2]];
    for (pair, share) in knots.windows(2).zip(&shares) {
        let inside = pair[0] > middles[0] - 1e-9 && pair[1] < middles[1] + 1e-9;
        assert_eq!(*share, if inside { 0.2 } else { 1.0 }, "{pair:?}");
    }
    assert!(shares.contains(&0.2) && knots.len() == 6, "{knots:?}");
    // The limit of the lift is 2 m/s: q' times ds stays below 0.4 there, and reaches it.
    let [s, x] = ["s", "x"].map(|key| numbers(&slow["grid"][key]));
    let joints = [0, 1]
        .map(|joint| slow["path"]["coefficients"].as_array().unwrap().iter().map(|of| numbers(&of[joint])).collect::<Vec<_>>());
    let mut most = 0.0f64;
    for (s, x) in s.iter().zip(&x).filter(|(s, _)| **s > middles[0] + 1e-9 && **s < middles[1] - 1e-9) {
        let piece = knots.iter().rposition(|knot| knot <= s).expect("a piece");
        for joint in &joints {
            let t = s - knots[piece];
            let rate: f64 = joint[piece].iter().enumerate().skip(1).map(|(k, c)| k as f64 * c * t.powi(k as i32 - 1)).sum();
            most = most.max(rate.abs() * x.sqrt());
        }
    }
    assert!(most <= 0.4 * (1.0 + 1e-9) && most > 0.399, "{most}\n{text}");
    assert_eq!(refused("slow", CRANE, &slow), "");
    let place = shares.iter().position(|share| *share == 0.2).expect("a share");
    for (share, why) in [(0.199, "the motion may exceed the limit `"), (0.3, "not proved"), (0.0, "other than shares")] {
        let mut changed = slow.clone();
        changed["path"]["speed"][place] = json!(share);
        let found = refused("slow-changed", CRANE, &changed);
        assert!(found.contains(why), "{share}: {found}");
    }
    // Of a blended corner all belongs to its point.
    let lines = "points: [[0, 0], {q: [1, 1], speed: 0.5}, [2, 0]]\ncurve: lines\nblend: 0.1\n";
    let (_, _, corner) = timed("corner", CRANE, lines, &["--gap", "0.01"], 0);
    assert_eq!(corner["path"]["speed"], json!([1.0, 0.5, 0.5, 0.5, 1.0]));
}

/// A line of the tip in a plane: its speed is ds, and its turn rate dq1 + dq2.
#[test]
fn the_end_effector_keeps_its_limits_and_they_are_proved() {
    let path = |limits: &str| {
        format!(
            "tip: {{points: [[1.2, -0.5, 0], [1.2, 0.5, 0]], start: [-1, 1.2], tolerance: 1e-5}}\ncurve: lines\nlimits: {{tool: {limits}}}\n"
        )
    };
    for (name, limits, kind) in [("speed", "{speed: 0.5}", 0), ("turn", "{turn_rate: 0.3}", 1)] {
        let (text, _, json) = timed(name, PLANAR, &path(limits), &["--gap", "0.003"], 0);
        let limit = [0.5, 0.3][kind];
        assert!(text.contains(["end effector speed", "end effector turn rate"][kind]), "{text}");
        let [s, x, knots] = [&json["grid"]["s"], &json["grid"]["x"], &json["path"]["knots"]].map(numbers);
        let coefficients = json["path"]["coefficients"].as_array().expect("pieces");
        let mut most = 0.0f64;
        for (s, x) in s.iter().zip(&x) {
            let piece = knots.iter().rposition(|knot| knot <= s).expect("a piece").min(coefficients.len() - 1);
            let [q, dq] = [0, 1].map(|order: usize| {
                [0, 1].map(|joint: usize| {
                    let powers = numbers(&coefficients[piece][joint]);
                    let t = s - knots[piece];
                    let of = |k: usize| if order == 0 { t.powi(k as i32) } else { k as f64 * t.powi(k as i32 - 1) };
                    (order..powers.len()).map(|k| powers[k] * of(k)).sum::<f64>()
                })
            });
            let w = [dq[0], dq[0] + dq[1]];
            let a = [q[0], q[0] + q[1]];
            let v = [-a[0].sin() * w[0] - a[1].sin() * w[1], a[0].cos() * w[0] + a[1].cos() * w[1]];
            most = most.max(x.sqrt() * [v[0].hypot(v[1]), w[1].abs()][kind]);
        }
        assert!(most <= limit * (1.0 + 1e-9) && most > 0.999 * limit, "{name}: {most}");
        assert_eq!(refused(name, PLANAR, &json), "");
        for (by, why) in [(0.999, "the motion may exceed the limit `end effector "), (1.01, "not proved")] {
            let mut changed = json.clone();
            changed["limits"]["tool"][kind] = json!(limit * by);
            let found = refused(&format!("{name}-changed"), PLANAR, &changed);
            assert!(found.contains(why), "{name} by {by}: {found}");
        }
    }
    // Of another's trajectory, too.
    let folder = own_folder("led");
    let [arm, at, csv] = ["robot.yaml", "path.yaml", "motion.csv"].map(|file| folder.join(file));
    fs::write(&arm, PLANAR).expect("a file");
    // Both joints turn at 1 rad/s from q2 = 1: |v|² = 5 + 4 cos(q2) falls, so the speed is largest at the start; the turn rate is 2.
    fs::write(&csv, "t,q1,q2,dq1,dq2\n0,0,1,1,1\n1,1,2,1,1\n").expect("a file");
    let [arm, at_text, csv] = [&arm, &at, &csv].map(|path| path.to_str().expect("a UTF-8 path"));
    let speed = (5.0 + 4.0 * 1.0f64.cos()).sqrt();
    for (limits, message) in [
        (format!("{{speed: {}}}", speed * 1.0001), ""),
        (format!("{{speed: {}}}", speed * 0.9999), "at t = 0 s the speed of the end effector is 2.67"),
        ("{turn_rate: 2.0001}".to_owned(), ""),
        ("{turn_rate: 1.9999}".to_owned(), "the turn rate of the end effector is 2 rad/s, beyond its limit of 1.9999 rad/s"),
    ] {
        fs::write(&at, format!("limits: {{tool: {limits}}}\n")).expect("a file");
        let output = check(&["time", arm, at_text, "--check", csv], i32::from(!message.is_empty()));
        assert!(err(&output).contains(message) && out(&output).contains("end effector"), "{}{}", out(&output), err(&output));
    }
}

/// Where it stops the arm holds itself, unless it need not.
#[test]
fn a_stop_that_is_not_held_is_refused() {
    let path = |end: &str| format!("points: [[0], {{q: [2], stop: true}}, [0]]\nlimits: {{effort: [8]}}\n{end}");
    let (_, error, _) = timed("falls", PENDULUM, &path(""), &[], 1);
    assert!(error.contains("end-not-held") && error.contains("at s = 2, point 2: at rest joint `pivot` needs 8.92"), "{error}");
}
