//! `armgen time --check`: any trajectory judged by the limits.

use std::fs;

use super::{check, err, file, folder, out, PENDULUM, SCARA_PATH, SLIDE};

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
