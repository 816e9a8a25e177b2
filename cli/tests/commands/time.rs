//! `armgen time`: exact optima, a real arm, curves.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use super::{armgen, check, err, file, folder, out};

#[path = "time/changed.rs"]
mod changed;
#[path = "time/faults.rs"]
mod faults;
#[path = "time/passing.rs"]
mod passing;
#[path = "time/proof.rs"]
mod proof;
#[path = "time/trajectory.rs"]
mod trajectory;

use proof::refused;

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

/// A folder of the test that runs: several time the same arms at the same time.
fn own_folder(name: &str) -> PathBuf {
    let thread = std::thread::current();
    folder(&format!("{}-{name}", thread.name().unwrap_or_default().replace("::", "-")))
}

/// Standard output, standard error and timing.json of a path; `code` is the exit code.
fn timed(name: &str, robot: &str, path: &str, options: &[&str], code: i32) -> (String, String, Value) {
    let folder = own_folder(name);
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

/// Three joints for two rows: at nodes q' has no part in the null space of J, a finer spline ends at the same joint values, q'' hardly jumps,
/// and a second proof holds.
#[test]
fn a_joint_too_many_moves_the_least() {
    let wrist = "  - {name: wrist, type: revolute, a: 0.5, alpha: 0, d: 0, theta: 0, limits: {velocity: 3, effort: 10},
     link: {mass: 1, com: [-0.25, 0, 0], inertia: {zz: 0.02}}}
";
    let robot = format!("{PLANAR}{wrist}");
    let path = |tolerance: &str| {
        format!(
            "tip: {{points: [[1.2, 0.6, 0], [1.2, -0.6, 0]], start: [-0.6, 1.2, 0.6], tolerance: {tolerance}}}\ncurve: lines\n"
        )
    };
    let (_, _, json) = timed("tip-redundant", &robot, &path("1e-5"), &["--gap", "0.01"], 0);
    let joints = [0, 1, 2].map(|joint| pieces(&json, joint));
    let (mut jump, mut largest) = (0.0f64, 0.0f64);
    for i in 0..joints[0].len() {
        for place in 0..3 {
            let [q, dq, ddq] = [0, 1, 2].map(|order| [0, 1, 2].map(|joint: usize| joints[joint][i][place][order]));
            let [a, b, c] = [q[0], q[0] + q[1], q[0] + q[1] + q[2]];
            let x = [a.cos(), b.cos(), 0.5 * c.cos()];
            let y = [a.sin(), b.sin(), 0.5 * c.sin()];
            assert!((x.iter().sum::<f64>() - 1.2).abs() < 1e-5, "{q:?}");
            let [jx, jy] = [[0, 1, 2].map(|k| -y[k..].iter().sum::<f64>()), [0, 1, 2].map(|k| x[k..].iter().sum::<f64>())];
            let null = [jx[1] * jy[2] - jx[2] * jy[1], jx[2] * jy[0] - jx[0] * jy[2], jx[0] * jy[1] - jx[1] * jy[0]];
            let beside = null.iter().zip(dq).map(|(n, dq)| n * dq).sum::<f64>().abs();
            assert!(place == 1 || beside < 1e-9, "{q:?} {dq:?}: {beside}");
            largest = ddq.iter().fold(largest, |most, x| most.max(x.abs()));
        }
        if i > 0 {
            jump = joints.iter().fold(jump, |most, of| most.max((of[i][0][2] - of[i - 1][2][2]).abs()));
        }
    }
    assert!(jump < 0.02 * largest, "{jump} of {largest}");
    assert_eq!(refused("tip-redundant", &robot, &json), "");
    let (_, _, fine) = timed("tip-redundant-fine", &robot, &path("1e-8"), &["--gap", "0.01"], 0);
    for (joint, coarse) in joints.iter().enumerate() {
        let [coarse, fine] = [coarse, &pieces(&fine, joint)].map(|of| of[of.len() - 1][2][0]);
        assert!((coarse - fine).abs() < 1e-6, "{joint}: {coarse} {fine}");
    }
    let narrow = robot.replace("effort: 10}", "effort: 10, position: [0.5, 0.7]}");
    let (_, error, _) = timed("tip-redundant-narrow", &narrow, &path("1e-4"), &[], 1);
    assert!(error.contains("outside-limits") && error.contains("wrist"), "{error}");
}

/// Line, half a circle and line, by closed forms; a second proof holds.
#[test]
fn the_tip_follows_an_arc() {
    let path = "tip:
  points: [[1.2, -0.4, 0], [1.2, 0.1, 0], {via: [1, 0.3, 0], to: [0.8, 0.1, 0]}, [0.8, -0.4, 0]]
  start: [-1.2, 1.8]
  tolerance: 1e-6
curve: lines
blend: 0.05
";
    let (_, _, json) = timed("arc", PLANAR, path, &["--gap", "0.01"], 0);
    let s = numbers(&json["path"]["knots"]);
    assert!((s[s.len() - 1] - 1.0 - 0.2 * std::f64::consts::PI).abs() < 1e-12, "{s:?}");
    let (shoulder, elbow) = (pieces(&json, 0), pieces(&json, 1));
    let (mut highest, mut on_arc) = (0.0f64, 0);
    for ([q1, ..], [q2, ..]) in shoulder.iter().flatten().zip(elbow.iter().flatten()) {
        let [x, y] = [q1.cos() + (q1 + q2).cos(), q1.sin() + (q1 + q2).sin()];
        let off = if y > 0.1 { (x - 1.0).hypot(y - 0.1) - 0.2 } else { (x - 1.0).abs() - 0.2 };
        assert!(off.abs() < 1e-6, "{x} {y}: {off:e}");
        (highest, on_arc) = (highest.max(y), on_arc + usize::from(y > 0.1));
    }
    assert!((highest - 0.3).abs() < 1e-3 && on_arc > 20, "{highest} {on_arc}");
    assert_eq!(refused("arc", PLANAR, &json), "");
}

/// The tip of an arm by its rows of DH: rotation and position, three rows of four.
fn tip_of(rows: &[[f64; 4]], q: &[f64]) -> [[f64; 4]; 3] {
    let mut t = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    for ([a, alpha, d, theta], q) in rows.iter().zip(q) {
        let ((st, ct), (sa, ca)) = ((q + theta).sin_cos(), alpha.sin_cos());
        let row = [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0.0, sa, ca, *d]];
        t = t.map(|t| [0, 1, 2, 3].map(|j| (0..3).map(|k| t[k] * row[k][j]).sum::<f64>() + if j == 3 { t[3] } else { 0.0 }));
    }
    t
}

/// A Panda, seven joints for six rows: on a line and a quarter of a circle the hand keeps its orientation.
#[test]
fn a_panda_leads_its_tip() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    let robot = fs::read_to_string(file("robots/panda7.yaml")).expect("a description");
    let path = "tip:
  points: [[0.307, 0, 0.59], [0.5, 0, 0.59], {via: [0.6060660171779821, 0.0439339828220179, 0.59], to: [0.65, 0.15, 0.59]}]
  start: [0, -pi/4, 0, -3*pi/4, 0, pi/2, pi/4]
  tolerance: 1e-5
curve: lines
limits: {velocity: [2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61], effort: [87, 87, 87, 87, 12, 12, 12]}
";
    let (text, _, json) = timed("panda", &robot, path, &[], 0);
    let [duration, bound] = ["duration", "lower_bound"].map(|key| number(&json[key]));
    assert!(bound <= duration && duration < 1.001 * bound, "{text}");
    let h = FRAC_PI_2;
    let (a, d) = ([0.0, 0.0, 0.0825, 0.0825, 0.0, 0.088, 0.0], [0.333, 0.0, 0.316, 0.0, 0.384, 0.0, 0.107]);
    let (alpha, theta) = ([-h, h, h, h, -h, h, 0.0], [0.0, 0.0, 0.0, PI, 0.0, PI, 0.0]);
    let rows: Vec<[f64; 4]> = (0..7).map(|k| [a[k], alpha[k], d[k], theta[k]]).collect();
    let joints: Vec<Vec<[[f64; 3]; 3]>> = (0..7).map(|joint| pieces(&json, joint)).collect();
    let start = tip_of(&rows, &[0.0, -FRAC_PI_4, 0.0, -3.0 * FRAC_PI_4, 0.0, FRAC_PI_2, FRAC_PI_4]);
    for piece in 0..joints[0].len() {
        for place in 0..3 {
            let q: Vec<f64> = joints.iter().map(|of| of[piece][place][0]).collect();
            let tip = tip_of(&rows, &q);
            let (x, y) = (tip[0][3], tip[1][3]);
            let off = if x > 0.5 { (x - 0.5).hypot(y - 0.15) - 0.15 } else { y };
            assert!(off.hypot(tip[2][3] - 0.59) < 1e-5, "{tip:?}");
            for (row, start) in tip.iter().zip(&start) {
                assert!(row.iter().zip(start).take(3).all(|(a, b)| (a - b).abs() < 1e-5), "{tip:?}");
            }
        }
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
    let expected = serde_json::json!({"velocity": [0.5, 2.0], "acceleration": [null, 3.0], "effort": [[-50.0, 25.0], [null, null]], "tool": [null, null]});
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

/// The first path of a page has the report that the page prints.
#[test]
fn pages_print_what_the_program_prints() {
    let robot = fs::read_to_string(file("robot.yaml")).expect("a description");
    for page in ["pick-and-place", "timing"] {
        let text = fs::read_to_string(file(&format!("docs/{page}.md"))).expect("a page");
        let block = |language: &str| {
            let rest = text.split_once(&format!("```{language}\n")).expect("a block").1;
            rest.split_once("```").expect("an end").0.to_owned()
        };
        let (printed, _, _) = timed(page, &robot, &block("yaml"), &[], 0);
        assert_eq!(printed, block("text"), "{page}");
    }
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
