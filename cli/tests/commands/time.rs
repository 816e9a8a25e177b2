//! `armgen time`: exact optima, a real arm, curves, every fault with its code and its place.

use std::fs;

use serde_json::Value;

use super::{armgen, check, err, file, folder, out};

/// A slide of 2 kg with friction.
const SLIDE: &str = "name: slide
convention: standard
gravity: [0, 0, 0]
joints:
  - {name: slide, type: prismatic, a: 0, alpha: 0, d: 0, theta: 0, limits: {velocity: 3, effort: 10, position: [-5, 5]},
     friction: {viscous: 1.5, coulomb: 2}, link: {mass: 2, com: [0, 0, 0], inertia: {}}}
";

/// A point mass on a rod in a vertical plane; q = 0 hangs down.
const PENDULUM: &str = "name: pendulum
convention: standard
gravity: [9.81, 0, 0]
joints:
  - {name: pivot, type: revolute, a: 1, alpha: 0, d: 0, theta: 0, limits: {velocity: 20, effort: 15},
     link: {mass: 1, com: [0, 0, 0], inertia: {}}}
";

/// A vertical slide that carries a horizontal one, 1 kg each.
const CRANE: &str = "name: crane
convention: standard
gravity: [0, 0, -9.81]
joints:
  - {name: lift, type: prismatic, a: 0, alpha: pi/2, d: 0, theta: 0, limits: {velocity: 2, effort: 100},
     link: {mass: 1, com: [0, 0, 0], inertia: {}}}
  - {name: boom, type: prismatic, a: 0, alpha: 0, d: 0, theta: 0, limits: {velocity: 2},
     link: {mass: 1, com: [0, 0, 0], inertia: {}}}
";

/// Two links of 1 m in a horizontal plane.
const PLANAR: &str = "name: planar
convention: standard
gravity: [0, 0, -9.81]
task: [x, y]
joints:
  - {name: shoulder, type: revolute, a: 1, alpha: 0, d: 0, theta: 0, limits: {velocity: 3, effort: 40},
     link: {mass: 3, com: [-0.5, 0, 0], inertia: {zz: 0.2}}}
  - {name: elbow, type: revolute, a: 1, alpha: 0, d: 0, theta: 0, limits: {velocity: 3, effort: 20},
     link: {mass: 2, com: [-0.5, 0, 0], inertia: {zz: 0.1}}}
";

const SCARA_PATH: &str = "points: [[0, 0.5, 0.1, 0], [1, 1, 0.2, 1], [-0.5, 1.5, 0, 2]]
limits: {velocity: [4, 5, 1.2, 12], effort: [250, 120, 400, 30]}
";

/// Standard output, standard error and timing.json of a path; `code` is the exit code.
fn timed(name: &str, robot: &str, path: &str, options: &[&str], code: i32) -> (String, String, Value) {
    let folder = folder(&format!("time-{name}"));
    let [arm, at, json] = ["robot.yaml", "path.yaml", "timing.json"].map(|file| folder.join(file));
    fs::write(&arm, robot).expect("a file");
    fs::write(&at, path).expect("a file");
    let [arm, at, json_of] = [&arm, &at, &json].map(|path| path.to_str().expect("a UTF-8 path"));
    let output = check(&[&["time", arm, at, "--json", json_of], options].concat(), code);
    let json = fs::read_to_string(&json).map_or(Value::Null, |text| serde_json::from_str(&text).expect("JSON"));
    (out(&output), err(&output), json)
}

fn number(of: &Value) -> f64 {
    of.as_f64().expect("a number")
}

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().expect("a list").iter().map(number).collect()
}

/// q and its first two derivatives of a joint at both ends and in the middle of each piece.
fn pieces(json: &Value, joint: usize) -> Vec<[[f64; 3]; 3]> {
    let knots = numbers(&json["path"]["knots"]);
    let all = json["path"]["coefficients"].as_array().expect("pieces");
    all.iter()
        .zip(knots.windows(2))
        .map(|(piece, knots)| {
            let powers = numbers(&piece[joint]);
            [0.0, 0.5, 1.0].map(|share| {
                let t = share * (knots[1] - knots[0]);
                let sum = |order: usize| {
                    let factor = |k: usize| (0..order).map(|i| (k - i) as f64).product::<f64>();
                    (order..6).map(|k| factor(k) * powers[k] * t.powi((k - order) as i32)).sum()
                };
                [sum(0), sum(1), sum(2)]
            })
        })
        .collect()
}

#[test]
fn a_slide_takes_the_time_of_its_closed_form() {
    // Bang-bang with viscous and Coulomb friction: 0.65917303 s (runtime/tests/timing.rs computes it).
    let (text, _, json) = timed("slide", SLIDE, "points: [[0], [0.5]]\n", &["--gap", "1e-4"], 0);
    let [duration, bound] = ["duration", "lower_bound"].map(|key| number(&json[key]));
    assert!(bound < 0.659_173_04 && duration > 0.659_173_02 && duration < bound * 1.0001, "{duration}, {bound}");
    assert!(text.contains("slide torque"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn a_scara_gets_samples_and_a_law() {
    let folder = folder("time-scara");
    let [path, csv, json] = ["path.yaml", "motion.csv", "timing.json"].map(|file| folder.join(file).to_str().unwrap().to_owned());
    fs::write(&path, SCARA_PATH).expect("a file");
    let output = check(&["time", &file("robots/scara.yaml"), &path, "--csv", &csv, "--json", &json, "--period", "0.005"], 0);
    assert!(out(&output).lines().all(|line| line.chars().count() <= 100), "{}", out(&output));
    let json: Value = serde_json::from_str(&fs::read_to_string(&json).expect("a law")).expect("JSON");
    let [duration, bound] = ["duration", "lower_bound"].map(|key| number(&json[key]));
    assert!(bound <= duration && duration < bound * 1.001, "{duration}, {bound}");
    let csv = fs::read_to_string(&csv).expect("samples");
    assert!(csv.starts_with("t,q_"), "{csv}");
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().expect("a number")).collect()).collect();
    assert_eq!((rows[0].len(), rows[1][0]), (17, 0.005));
    for row in &rows {
        for (tau, limit) in row[13..].iter().zip([250.0, 120.0, 400.0, 30.0]) {
            assert!(tau.abs() <= limit * (1.0 + 1e-9), "{tau} of {limit} at {}", row[0]);
        }
    }
    let last = &rows[rows.len() - 1];
    assert!((last[0] - duration).abs() < 1e-12 && (last[1] + 0.5).abs() < 1e-9, "{last:?}");
    // The times of the file are those of the law: between two nodes T = h/(mean of ds) to first order.
    let [s, t, x] = ["s", "t", "x"].map(|key| numbers(&json["grid"][key]));
    assert_eq!((s.len(), t.len()), (x.len(), x.len()));
    assert_eq!(numbers(&json["grid"]["k"]).len() + 1, s.len());
    let middle = s.len() / 2;
    let mean = 0.5 * (x[middle].sqrt() + x[middle + 1].sqrt());
    let law = (s[middle + 1] - s[middle]) / (t[middle + 1] - t[middle]);
    assert!((law / mean - 1.0).abs() < 1e-2, "{law}, {mean}");
    // Nobody's file is overwritten.
    check(&["time", &file("robots/scara.yaml"), &path, "--csv", &path], 2);
}

#[test]
fn corners_are_passed_at_the_distance_of_the_blend() {
    let path = "points: [[0, 0], [1, 0], [1, 1]]\ncurve: lines\nblend: 0.05\n";
    let (_, _, json) = timed("blend", CRANE, path, &[], 0);
    let (lift, boom) = (pieces(&json, 0), pieces(&json, 1));
    assert_eq!(lift.len(), 3);
    let distance = (lift[1][1][0] - 1.0).hypot(boom[1][1][0]);
    assert!((distance - 0.05).abs() < 1e-12, "{distance}");
    for joint in [lift, boom] {
        for i in 0..2 {
            for order in 0..3 {
                let [before, after] = [joint[i][2][order], joint[i + 1][0][order]];
                assert!((before - after).abs() < 1e-9, "derivative {order} jumps at knot {i}: {before}, {after}");
            }
        }
    }
    // A blend that does not fit takes half of the lines.
    let (_, _, json) = timed("blend-large", CRANE, &path.replace("0.05", "7"), &[], 0);
    assert_eq!(numbers(&json["path"]["knots"]), [0.0, 0.5, 1.5, 2.0]);
}

/// The tip stays on its line and on its rounded corner, by closed forms, on the branch of the start; a second proof holds.
#[test]
fn the_tip_follows_its_path() {
    let path = "tip: {points: [[1, 0.6, 0], [1, -0.6, 0], [0.4, -0.6, 0]], start: [START], tolerance: 1e-5}
curve: lines
blend: 0.05
";
    for (name, start, side) in [("tip-left", "-0.3, 1.8", 1.0), ("tip-right", "1.5, -1.8", -1.0)] {
        let (text, _, json) = timed(name, PLANAR, &path.replace("START", start), &["--gap", "0.01"], 0);
        assert!(text.contains("The tip leaves its path by at most"), "{text}");
        let (shoulder, elbow) = (pieces(&json, 0), pieces(&json, 1));
        let (mut corner, mut count) = (f64::INFINITY, 0);
        for (a, b) in shoulder.iter().zip(&elbow) {
            for ([q1, ..], [q2, ..]) in a.iter().zip(b) {
                let [x, y] = [q1.cos() + (q1 + q2).cos(), q1.sin() + (q1 + q2).sin()];
                assert!(q2 * side > 0.0, "{name}: the elbow turned over, {q2}");
                let off = (x - 1.0).abs().min((y + 0.6).abs());
                let near = (x - 1.0).hypot(y + 0.6);
                assert!(off < 1e-5 || near < 0.3, "{name}: {x} {y}");
                (corner, count) = (corner.min(near), count + 1);
            }
        }
        assert!((0.05 - 1e-5..0.08).contains(&corner) && count > 30, "{name}: {corner} {count}");
        assert_eq!(refused(name, PLANAR, &json), "", "{name}");
    }
}

#[test]
fn through_does_not_swing_beyond_its_points() {
    let points = "points: [[0, 0], [0.1, 1], [1, 1.1], [1.1, 1.2], [1.2, 3]]\n";
    let overshoot = |curve: &str| {
        let (_, _, json) = timed(curve, CRANE, &format!("{points}curve: {curve}\n"), &[], 0);
        let mut least = f64::INFINITY;
        for joint in 0..2 {
            let pieces = pieces(&json, joint);
            for pair in pieces.windows(2) {
                for order in 0..3 {
                    assert!((pair[0][2][order] - pair[1][0][order]).abs() < 1e-7, "{curve}: {pair:?}");
                }
            }
            least = pieces.iter().flatten().fold(least, |least, of| least.min(of[1]));
        }
        least
    };
    // All joints move forwards only.
    assert!(overshoot("through") >= 0.0);
    assert!(overshoot("spline") < 0.0);
}

#[test]
fn limits_by_name_replace_those_of_the_description() {
    let path =
        "points: [[0, 0], [1, 0.1]]\nlimits: {velocity: {lift: 0.5}, acceleration: {boom: 3}, effort: {lift: [-50, 25]}}\n";
    let (text, _, json) = timed("limits", CRANE, path, &[], 0);
    let expected =
        serde_json::json!({"velocity": [0.5, 2.0], "acceleration": [null, 3.0], "effort": [[-50.0, 25.0], [null, null]]});
    assert_eq!(json["limits"], expected);
    assert!(text.contains("lift speed"), "{text}");
}

#[test]
fn an_arm_of_many_joints_is_timed() {
    let joint = "  - {name: JOINT, type: revolute, a: 0.2, alpha: 0, d: 0, theta: 0, limits: {velocity: 1},
     link: {mass: 1, com: [0, 0, 0], inertia: {}}}\n";
    let joints: String = (1..=9).map(|i| joint.replace("JOINT", &format!("j{i}"))).collect();
    let robot = format!("name: snake\nconvention: standard\ngravity: [0, 0, 0]\njoints:\n{joints}");
    let zeros = ["0"; 9].join(", ");
    let (_, _, json) = timed("snake", &robot, &format!("points: [[{zeros}], [2, {}]]\n", ["1"; 8].join(", ")), &[], 0);
    // Speeds alone: 2 rad at 1 rad/s, and as short a while as the goal allows to leave rest.
    let [duration, bound] = ["duration", "lower_bound"].map(|key| number(&json[key]));
    assert!((2.0..2.002).contains(&duration) && (1.999..=2.0).contains(&bound), "{duration}, {bound}");
}

/// Code, robot, path, options, and texts that the message has.
fn faults() -> Vec<(&'static str, String, String, Vec<&'static str>, Vec<&'static str>)> {
    let knots = "knots: [0, 1, 2], coefficients";
    let of = |robot: &str, path: &str| (robot.to_owned(), path.to_owned());
    let crane = "points: [[0, 0], [1, 1], [2, 0]]\n";
    let cases = [
        ("missing-path", of(SLIDE, "curve: spline\n"), "", vec!["path.yaml:1:1", "`points: ["]),
        ("unknown-word", of(SLIDE, "points: [[0], [1]]\ncurve: splines\n"), "", vec!["path.yaml:2:8", "did you mean `spline`"]),
        (
            "unknown-joint",
            of(SLIDE, "points: [[0], [1]]\nlimits: {velocity: {slid: 2}}\n"),
            "",
            vec!["2:21", "did you mean `slide`"],
        ),
        ("limit-not-positive", of(SLIDE, "points: [[0], [1]]\nlimits: {effort: [0]}\n"), "", vec!["path.yaml:2:19"]),
        ("negative-speed", of(SLIDE, "points: [[0], [1]]\nends: {speed: [-1, 0]}\n"), "", vec!["path.yaml:2:15"]),
        ("knot-order", of(SLIDE, "pieces: {knots: [1, 1], coefficients: [[[0, 1]]]}\n"), "", vec!["knot 2 is not above knot 1"]),
        (
            "jump",
            of(SLIDE, &format!("pieces: {{{knots}: [[[0, 1]], [[1.1, 1]]]}}\n")),
            "",
            vec!["at s = 1, piece 2: joint `slide` jumps by 0.1 m", "path.yaml:1:"],
        ),
        ("corner", of(CRANE, &format!("{crane}curve: lines\n")), "", vec!["path.yaml:1:18", "point 2", "90 deg", "blend: 0.05"]),
        ("zero-length", of(SLIDE, "points: [[0], [1], [1]]\n"), "", vec!["points 2 and 3 are equal"]),
        (
            "turning-back",
            of(SLIDE, "pieces: {knots: [0, 1], coefficients: [[[0, -1, 1]]]}\n"),
            "",
            vec!["at s = 0.5, piece 1", "end the path here"],
        ),
        (
            "outside-limits",
            of(SLIDE, "points: [[0], [6]]\n"),
            "",
            vec!["at s = 6, point 2: joint `slide` is at 6, 1 m beyond its range", "s = 5 to 6", "path.yaml:1:16"],
        ),
        (
            "missing-limit",
            of(&CRANE.replace(", limits: {velocity: 2}", ""), crane),
            "",
            vec!["`boom` moves and has neither", "limits: {velocity: {boom: 2}}"],
        ),
        (
            "infeasible-point",
            of(CRANE, "points: [[0, 0], [1, 1]]\nlimits: {effort: [15, 1]}\nends: {hold: false}\n"),
            "",
            vec!["at s = 0, point 1", "19.62 N", "proved"],
        ),
        (
            "infeasible-speed",
            of(PENDULUM, "points: [[0], [3]]\nlimits: {effort: [6]}\nends: {hold: false}\n"),
            "",
            vec!["between points 1 and 2", "joint `pivot`", "6 N m", "this is proved"],
        ),
        (
            "end-not-held",
            of(PENDULUM, "points: [[0], [2]]\nlimits: {effort: [8]}\n"),
            "",
            vec!["at s = 2, point 2", "needs 8.92", "hold: false"],
        ),
        ("too-coarse", of(PENDULUM, "points: [[0], [20]]\n"), "--segments=5", vec!["try `--segments "]),
        ("start-not-held", of(PENDULUM, "points: [[pi/2], [0]]\nlimits: {effort: [8]}\n"), "", vec!["needs 9.81 N m"]),
        ("gap", of(PENDULUM, "points: [[0], [2]]\n"), "--segments=20 --gap=1e-9", vec![" segments leave a gap of"]),
        (
            "slow-point",
            of(CRANE, "points: [[0, 0], [1, 1], [2, 0]]\ncurve: lines\nblend: 1e-6\nlimits: {acceleration: [5, 5]}\n"),
            "--segments=3000",
            vec!["the corner of point 2: the motion slows down to"],
        ),
        ("other-robot", of(SLIDE, "robot: panda\npoints: [[0], [1]]\n"), "", vec!["`panda`", "path.yaml:1:8"]),
        // Of the tip.
        (
            "singular",
            of(PLANAR, "tip: {points: [[1, 0.5, 0], [2, 0, 0]], start: [-0.5, 2]}\n"),
            "",
            vec!["at s = 1.11803, point 2", "least singular value of J", "path.yaml:1:"],
        ),
        (
            "unreachable",
            of(PLANAR, "tip: {points: [[1, 0, 0], [3.2, 0, 0]], start: [-1, 2]}\n"),
            "",
            vec!["at s = 1, between points 1 and 2", "1.2 m and 0 rad"],
        ),
        (
            "tolerance",
            of(PLANAR, "tip: {points: [[1, 0, 0], [1, 1, 0]], start: [-1, 2], tolerance: 1e-18}\n"),
            "",
            vec!["between points 1 and 2", "raise `tolerance`"],
        ),
        // Of a description.
        (
            "smooth-friction",
            of(&SLIDE.replace("coulomb: 2", "coulomb: 2, smooth: 0.1"), "points: [[0], [1]]\n"),
            "",
            vec!["joint `slide` has smooth friction", "leave out `smooth`"],
        ),
        // Shared with other files.
        (
            "not-finite",
            of(SLIDE, "points: [[0], [1e308]]\nlimits: {velocity: [1]}\n"),
            "",
            vec!["between points 1 and 2", "write smaller numbers"],
        ),
        ("wrong-length", of(SLIDE, "points: [[0], [1, 2]]\n"), "", vec!["path.yaml:1:15", "point 2 has 2 numbers, not 1"]),
        ("unknown-key", of(SLIDE, "points: [[0], [1]]\nspeed: 3\n"), "", vec!["path.yaml:2:1"]),
        ("wrong-kind", of(SLIDE, "points: 3\n"), "", vec!["path.yaml:1:9"]),
    ];
    cases
        .into_iter()
        .map(|(code, (robot, path), options, texts)| (code, robot, path, options.split_whitespace().collect(), texts))
        .collect()
}

#[test]
fn every_fault_has_its_code_and_its_place() {
    for (code, robot, path, options, texts) in faults() {
        let is_warning = ["start-not-held", "gap", "slow-point", "other-robot"].contains(&code);
        let (_, error, _) = timed(code, &robot, &path, &options, i32::from(!is_warning));
        assert!(error.contains(code), "{code}: {error}");
        for text in texts {
            assert!(error.contains(text), "{code} lacks `{text}`: {error}");
        }
        let count = error.lines().filter(|line| line.starts_with("error[") || line.starts_with("warning[")).count();
        assert_eq!(count, usize::from(code != "smooth-friction"), "{code}: {error}");
    }
}

/// All faults of a file in one go.
#[test]
fn faults_come_together() {
    let path = "points: [[0], [x]]\ncurve: round\nlimits: {velocity: [-1]}\n";
    let (_, error, _) = timed("together", SLIDE, path, &[], 1);
    for code in ["unknown-name", "unknown-word", "limit-not-positive"] {
        assert!(error.contains(code), "{error}");
    }
    // Corners and ranges, too.
    let path = "points: [[0, 0], [1, 1], [2, 0], [3, 1]]\ncurve: lines\n";
    let robot = CRANE.replace("velocity: 2, effort: 100", "velocity: 2, effort: 100, position: [0, 2.5]");
    let (_, error, _) = timed("together-path", &robot, path, &[], 1);
    assert_eq!(error.matches("error[corner]").count(), 2, "{error}");
    assert!(error.contains("error[outside-limits]"), "{error}");
}

/// The page has every code, and a test has.
#[test]
fn every_code_is_on_the_page_and_tested() {
    let declared = fs::read_to_string(file("cli/src/commands/time/code.rs")).expect("codes");
    let names: Vec<&str> = declared.lines().filter_map(|line| line.trim().strip_suffix("\",")?.split('"').nth(1)).collect();
    assert!(names.len() > 15, "{names:?}");
    let page = fs::read_to_string(file("docs/timing.md")).expect("a page");
    let tested: Vec<&str> = faults().iter().map(|fault| fault.0).collect();
    for name in names {
        assert!(page.contains(&format!("`{name}`")), "{name} is not on the page");
        assert!(tested.contains(&name), "{name} has no test");
    }
}

/// The answer of `armgen verify` on a timing; "" where it is proved.
fn refused(name: &str, robot: &str, timing: &Value) -> String {
    let folder = folder(&format!("time-verify-{name}"));
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

/// The path of the tutorial has the report that the page prints.
#[test]
fn the_tutorial_prints_what_the_program_prints() {
    let page = fs::read_to_string(file("docs/pick-and-place.md")).expect("a page");
    let block = |language: &str| {
        let rest = page.split_once(&format!("```{language}\n")).expect("a block").1;
        rest.split_once("```").expect("an end").0.to_owned()
    };
    let robot = fs::read_to_string(file("robot.yaml")).expect("a description");
    let (printed, _, _) = timed("tutorial", &robot, &block("yaml"), &[], 0);
    assert_eq!(printed, block("text"));
}

#[test]
fn usage_is_judged() {
    let path = folder("time-usage").join("path.yaml");
    fs::write(&path, "points: [[0, 0, 0, 0], [1, 0, 0, 0]]\n").expect("a file");
    let (robot, path) = (file("robots/scara.yaml"), path.to_str().expect("a UTF-8 path").to_owned());
    for options in [&["--period", "0"][..], &["--gap", "-1"], &["--segments", "0"], &["--period", "x"]] {
        let output = armgen(&[&["time", &robot, &path], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}: {}", err(&output));
    }
    check(&["time", &robot, "nowhere.yaml"], 2);
}

/// Standard output and error of `armgen time --check` on a trajectory; `path` has limits.
fn checked(name: &str, robot: &str, path: Option<&str>, trajectory: &str, code: i32) -> (String, String) {
    let folder = folder(&format!("time-check-{name}"));
    let [arm, at, csv] = ["robot.yaml", "path.yaml", "motion.csv"].map(|file| folder.join(file));
    fs::write(&arm, robot).expect("a file");
    fs::write(&csv, trajectory).expect("a file");
    let [arm, at, csv] = [&arm, &at, &csv].map(|path| path.to_str().expect("a UTF-8 path"));
    let mut arguments = vec!["time", arm];
    if let Some(path) = path {
        fs::write(at, path).expect("a file");
        arguments.push(at);
    }
    let output = check(&[&arguments[..], &["--check", csv]].concat(), code);
    (out(&output), err(&output))
}

/// Rows of numbers with a header.
fn csv(header: &str, rows: impl IntoIterator<Item = Vec<f64>>) -> String {
    let mut text = format!("{header}\n");
    for row in rows {
        text += &row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    text
}

#[test]
fn a_trajectory_is_judged_between_its_samples() {
    // q = t³ - 1.5 t² on [0, 1]: at rest at both samples, dq = 3 t² - 3 t is -0.75 in the middle.
    let rows = || [vec![0.0, 0.0, 0.0], vec![1.0, -0.5, 0.0]];
    let limit = |v: f64| format!("limits: {{velocity: [{v}], acceleration: [3]}}\n");
    let (text, _) = checked("inside", SLIDE, Some(&limit(0.7501)), &csv("t,q1,dq1", rows()), 0);
    assert!(text.contains("the cubics that q and dq define") && !text.contains("exceeded"), "{text}");
    let (text, error) = checked("outside", SLIDE, Some(&limit(0.7499)), &csv("t,q_slide,dq_slide", rows()), 1);
    assert!(
        error.contains("limit-exceeded: at t = 0.5 s the speed of joint `slide` is -0.75 m/s, beyond its limit of -0.7499 m/s"),
        "{error}"
    );
    assert_eq!((error.matches("limit-exceeded").count(), text.matches("  exceeded").count()), (1, 1), "{text}");
    // ddq = 6 t - 3: its largest is at a sample.
    let (_, error) = checked("ddq", SLIDE, Some("limits: {acceleration: [2.9]}\n"), &csv("t,slide,dq1", rows()), 1);
    assert!(error.contains("the acceleration of joint `slide` is ") && error.contains("3 m/s²"), "{error}");
}

#[test]
fn the_columns_define_the_spline() {
    // A quintic and its derivatives at two times: q = t^5, speed 5 t^4.
    let rows = [1.0f64, 2.0].map(|t| vec![t, t.powi(5), 5.0 * t.powi(4), 20.0 * t.powi(3)]);
    let robot = SLIDE.replace("position: [-5, 5]", "position: [-5, 32]").replace("effort: 10, ", "");
    let limits = |v: f64| format!("limits: {{velocity: [{v}]}}\n");
    let text = csv("t,q1,dq1,ddq1", rows);
    let (report, _) = checked("quintic", &robot, Some(&limits(80.001)), &text, 0);
    assert!(report.contains("the quintics that q, dq and ddq define"), "{report}");
    let (_, error) = checked("quintic-fast", &robot, Some(&limits(79.999)), &text, 1);
    assert!(error.contains("at t = 2 s the speed of joint `slide` is 80 m/s"), "{error}");
    // A cubic and its derivative: q = t³, acceleration 6 t.
    let text = csv("t,q1,dq1", [1.0f64, 2.0].map(|t| vec![t, t.powi(3), 3.0 * t * t]));
    let both = |a: f64| format!("limits: {{velocity: [12.001], acceleration: [{a}]}}\n");
    checked("cubic", &robot, Some(&both(12.001)), &text, 0);
    let (_, error) = checked("cubic-fast", &robot, Some(&both(11.999)), &text, 1);
    assert!(error.contains("at t = 2 s the acceleration of joint `slide` is 12 m/s²"), "{error}");
    // The natural spline through (0, 0), (1, 1), (2, 0): q = 1.5 t - 0.5 t³, largest at t = 1.
    let text = csv("t,q1", [vec![0.0, 0.0], vec![1.0, 1.0], vec![2.0, 0.0]]);
    let robot = robot.replace("position: [-5, 32]", "position: [-5, 0.999]");
    let (report, error) = checked("natural", &robot, Some(&limits(1.4999)), &text, 1);
    assert!(report.contains("natural cubic spline"), "{report}");
    assert!(error.contains("at t = 1 s the position of joint `slide` is 1 m, beyond its limit of 0.999 m"), "{error}");
    assert!(error.contains("the speed of joint `slide` is 1.5 m/s") || error.contains("is -1.5 m/s"), "{error}");
}

#[test]
fn torques_of_a_trajectory_are_those_of_the_arm() {
    // Held at 1 rad: m g l sin(1) = 8.255 N m.
    let text = csv("t,q1,dq1,ddq1", [0.0, 0.5, 1.0].map(|t| vec![t, 1.0, 0.0, 0.0]));
    checked("held", PENDULUM, Some("limits: {effort: [8.26]}\n"), &text, 0);
    let (_, error) = checked("falls", PENDULUM, Some("limits: {effort: [[-8.25, 8.25]]}\n"), &text, 1);
    assert!(error.contains("the torque of joint `pivot` is 8.25"), "{error}");
    // At an even rate from 0.3 to 2.5 rad: 9.81 N m at pi/2, at most 9.757 in nine places.
    let text = csv("t,q1,dq1,ddq1", [0.0, 1.0].map(|t| vec![t, 0.3 + 2.2 * t, 2.2, 0.0]));
    let (_, error) = checked("between", PENDULUM, Some("limits: {effort: [9.809]}\n"), &text, 1);
    assert!(error.contains("the torque of joint `pivot` is 9.81 N m") && error.contains("at t = 0.57763"), "{error}");
    // A slide that turns round at 0.37 s: 2 kg, -8 m/s², 2 N of friction before and after.
    let text = csv("t,q1,dq1,ddq1", [0.0, 0.5].map(|t: f64| vec![t, 2.96 * t - 4.0 * t * t, 2.96 - 8.0 * t, -8.0]));
    let robot = SLIDE.replace("viscous: 1.5", "viscous: 0");
    let (_, error) = checked("turns", &robot, Some("limits: {effort: [17.9]}\n"), &text, 1);
    assert!(error.contains("the torque of joint `slide` is -18 N"), "{error}");
    checked("turned", &robot, Some("limits: {effort: [18.1]}\n"), &text, 0);
}

/// What `--csv` writes keeps the limits at its samples, and between them within what the samples leave open.
#[test]
fn a_motion_of_armgen_is_checked() {
    let folder = folder("time-check-own");
    let [path, loose, motion] =
        ["path.yaml", "loose.yaml", "motion.csv"].map(|file| folder.join(file).to_str().unwrap().to_owned());
    fs::write(&path, SCARA_PATH).expect("a file");
    // Limits without a path: a quarter more, since quintics swing where the acceleration jumps.
    fs::write(&loose, "limits: {velocity: [4, 5, 1.2, 12], effort: [312.5, 150, 500, 37.5]}\n").expect("a file");
    let robot = file("robots/scara.yaml");
    check(&["time", &robot, &path, "--csv", &motion], 0);
    let text = out(&check(&["time", &robot, &loose, "--check", &motion], 0));
    let shoulder: Vec<&str> =
        text.lines().find(|line| line.contains("torque  shoulder")).expect("a row").split_whitespace().collect();
    // The columns end with the share at samples, its sign, the time and its unit: 250 of 312.5 N m.
    let share: f64 = shoulder[shoulder.len() - 4].parse().expect("a share");
    assert!((share - 80.0).abs() < 0.01, "{text}");
    let tight = folder.join("tight.yaml");
    fs::write(&tight, "limits: {velocity: [3.9, 5, 1.2, 12]}\n").expect("a file");
    let output = check(&["time", &robot, tight.to_str().unwrap(), "--check", &motion], 1);
    assert!(err(&output).contains("the speed of joint"), "{}", err(&output));
}

#[test]
fn faults_of_a_trajectory_have_their_line() {
    for (name, text, expected) in [
        ("empty", "", "empty-trajectory"),
        ("one", "t,q1\n0,0\n", "empty-trajectory: a trajectory has two samples at least, found 1"),
        ("column", "t,q2\n0,0\n1,1\n", "motion.csv:1: missing-column: no column `q_slide`"),
        ("ddq", "t,q1,ddq1\n0,0,0\n1,1,0\n", "ddq is there and dq is not"),
        ("twice", "t,q1,q1\n0,0,0\n1,1,0\n", "duplicate-column"),
        ("number", "t,q1\n0,0\n1,x\n", "motion.csv:3: bad-number: `x` in column `q1`"),
        ("finite", "t,q1\n0,0\n1,inf\n", "motion.csv:3: not-finite"),
        ("fields", "t,q1\n0,0\n1\n", "motion.csv:3: wrong-length: 1 fields for 2 columns"),
        ("time", "t,q1\n0,0\n0,1\n", "motion.csv:3: time-not-increasing"),
    ] {
        let (_, error) = checked(&format!("fault-{name}"), SLIDE, None, text, 1);
        assert!(error.contains(expected), "{name}: {error}");
    }
    let free = SLIDE.replace("velocity: 3, effort: 10, position: [-5, 5]", "");
    let (_, error) = checked("free", &free, None, "t,q1\n0,0\n1,1\n", 1);
    assert!(error.contains("missing-limit"), "{error}");
}
