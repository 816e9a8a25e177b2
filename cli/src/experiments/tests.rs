//! Every experiment of the repository gives what is expected; faulty files say where and why.

use std::path::{Path, PathBuf};

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;
use tempfile::TempDir;

use super::file::{self, Parsed};
use super::*;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments")
}

fn text_of(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).expect("the experiment is in the repository")
}

fn parse(name: &str, text: &str) -> Parsed {
    file::parse(&folder().join(name), &Source::new(name, text), Colour::Never)
}

fn files() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).expect("the repository has experiments");
    let mut names: Vec<String> =
        entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).filter(|name| name.ends_with(".yaml")).collect();
    names.sort();
    assert!(names.len() >= 24, "{names:?}");
    names
}

/// A folder for figures and logs, gone with the test.
fn out() -> TempDir {
    tempfile::tempdir().expect("a folder for figures")
}

#[test]
fn every_experiment_gives_what_is_expected() {
    let out = out();
    let (mut jobs, mut other) = (Vec::new(), 0);
    for name in files() {
        match parse(&name, &text_of(&name)) {
            Parsed::Experiment(experiment) => {
                assert!(!experiment.expect.is_empty(), "{name} expects nothing");
                // 1.2 million steps of the whole loop: for optimised builds.
                let long = matches!(&experiment.body, Body::Control(run) if run.continuous.is_some());
                if !(cfg!(debug_assertions) && long) {
                    jobs.push(Job::new(*experiment));
                }
            }
            Parsed::OtherRobot(_) => other += 1,
            Parsed::Faulty(text, _) => panic!("{text}"),
        }
    }
    // With another robot.yaml there is nothing to be run.
    assert!(!jobs.is_empty() || other > 0);
    in_parallel(&mut jobs, |job| {
        job.prepare();
        job.run(out.path());
    });
    for job in &jobs {
        for line in job.lines() {
            assert!(line.met, "{}: {} is {}, expected {}", job.experiment.name, line.what, line.found, line.expected);
        }
        assert!(job.figures > 0, "{} is drawn", job.experiment.name);
        let unstable = job.experiment.name.ends_with("_delayed") || job.experiment.name.starts_with("adaptive_reported");
        assert_eq!(job.warning().is_some(), unstable, "{}: {:?}", job.experiment.name, job.warning());
    }
}

#[test]
fn the_reported_adaptive_gains_are_called_unstable_before_anything_moves() {
    let Parsed::Experiment(experiment) = parse("adaptive_reported.yaml", &text_of("adaptive_reported.yaml")) else { return };
    let mut job = Job::new(*experiment);
    job.prepare();
    assert!(job.record.log.is_empty());
    assert_eq!(
        job.warning().as_deref(),
        Some("unstable when sampled at 1 ms: spectral radius 7.19; a period up to 0.2444 ms would hold")
    );
}

/// A file with `old` replaced must give a fault `code` at the `place` (line:column), with `help` in its text; what is not so.
fn refused(name: &str, old: &str, new: &str, code: &str, place: &str, help: &str) -> Option<String> {
    let text = text_of(name);
    if !text.contains(&format!("robot: {NAME}\n")) {
        return None;
    }
    assert!(text.contains(old), "{name} holds no `{old}`");
    match parse(name, &text.replacen(old, new, 1)) {
        Parsed::Faulty(text, _) => {
            let parts = [format!("error[{code}]"), format!("{name}:{place}\n"), help.to_owned()];
            let missing: Vec<&String> = parts.iter().filter(|part| !text.contains(*part)).collect();
            (!missing.is_empty()).then(|| format!("no {missing:?} in\n{text}"))
        }
        _ => Some(format!("`{new}` was taken")),
    }
}

#[test]
fn faulty_experiments_say_where_and_why() {
    let a = "adaptive_a.yaml";
    let grid = format!("second: [{}", "0, ".repeat(1000));
    let found = [
        refused(a, "load:", "laod:", "unknown-key", "9:1", "did you mean `load`?"),
        refused(a, "title: Adaptive control, gains A\n", "", "missing-key", "2:1", "lacks `title`"),
        refused(a, "[500, 500, 500, 500]", "[500, 500, 500]", "wrong-length", "13:11", "3 instead of 4"),
        refused(a, "[500, 500, 500, 500]", "[500, 500, -500, 500]", "not-positive", "13:22", "write a number above zero"),
        refused(a, "[500, 500, 500, 500]", "[500, 500, 1/0, 500]", "not-finite", "13:22", "write a finite number"),
        refused(a, "[500, 500, 500, 500]", "[500, 500, fast, 500]", "unknown-name", "13:22", "no named numbers"),
        refused(a, "[500, 500, 500, 500]", "500", "wrong-kind", "13:11", "must be a list"),
        refused(a, "law: adaptive", "law: adaptiv", "unknown-word", "12:8", "did you mean `adaptive`?"),
        refused(a, "m_l3: 15}", "m_l9: 15}", "unknown-parameter", "9:8", "the robot has no parameter `m_l9`"),
        refused(a, "lambda:", "k_p: [1, 1, 1, 1]\n  lambda:", "out-of-place", "13:3", "does not use it"),
        refused(a, "sampling: 0.001", "sampling: 0", "not-positive", "7:11", "above zero"),
        refused(a, "sampling: 0.001", "sampling: 1e-9", "out-of-range", "7:1", "at most two million samples"),
        refused(a, "load:", "simulation: {substeps: 1000}\nload:", "out-of-range", "9:1", "at most twenty million steps"),
        refused("manipulability.yaml", "second: [", &grid, "out-of-range", "9:1", "at most 10000 combinations"),
        refused(a, "paths/ghost.yaml", "paths/gost.yaml", "unreadable-path", "5:7", "relative to the experiment's file"),
        refused(a, "{quantity: radius,", "{quantity: radios,", "unknown-quantity", "17:16", "did you mean `radius`?"),
        refused(
            a,
            "quantity: estimate_m_l3, at: 5,",
            "quantity: estimate_m_l3,",
            "unknown-quantity",
            "19:16",
            "changes with time",
        ),
        refused(
            a,
            "at: 5, value: 15, tolerance: 0.05",
            "at: 25, value: 15, tolerance: 0.05",
            "after-the-end",
            "19:16",
            "lengthen `duration`",
        ),
        refused(a, "value: 0.999636, tolerance: 1e-4", "value: 0.999636", "no-target", "17:5", "`tolerance` or `percent`"),
        refused(a, "highest: [5, 22]", "highest: [22, 5]", "empty-interval", "20:31", "earlier time first"),
        refused(
            a,
            "controller:",
            "clik: {algorithm: inverse, gains: [1, 1, 1, 1]}\ncontroller:",
            "ambiguous",
            "12:1",
            "two experiments",
        ),
        refused("robust_tuned_delayed.yaml", "delay: 1}", "delay: 11}", "out-of-range", "10:17", "a whole number from 0 to 10"),
        refused("dexterity_none.yaml", "[y, z, rz]", "[y, z, y]", "duplicate-row", "9:14", "named twice"),
        refused(
            "clik_inverse.yaml",
            "algorithm: inverse\n",
            "algorithm: inverse\n  k_0: 3\n",
            "out-of-place",
            "11:3",
            "does not use it",
        ),
        refused("manipulability.yaml", "plane: [x, y]", "plane: [x, rz]", "wrong-length", "8:1", "two linear rows"),
        refused("manipulability.yaml", "robot: scara\n", "robot: scara\nrobot: scara\n", "duplicate-key", "3:1", "keep one"),
    ];
    let wrong: Vec<String> = found.into_iter().flatten().collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn faulty_paths_say_which_segment() {
    let folder = out();
    let folder = folder.path();
    let path = text_of("paths/ghost.yaml");
    let check = |old: &str, new: &str, code: &str, place: &str, why: &str| {
        assert!(path.contains(old));
        std::fs::write(folder.join("path.yaml"), path.replacen(old, new, 1)).expect("a path file");
        let (source, reader) = motion::read(&folder.join("path.yaml")).expect_err("a faulty path");
        let text = reader.faults.render(&source, Colour::Never);
        for part in [format!("error[{code}]"), format!("path.yaml:{place}\n"), why.to_owned()] {
            assert!(text.contains(&part), "no `{part}` in\n{text}");
        }
    };
    check(
        "duration: 1.5, acceleration_time: 0.2",
        "duration: 1.5, acceleration_time: 0.8",
        "infeasible",
        "8:6",
        "segment 2 cannot be planned: its cruise time",
    );
    check("sweep: -pi", "sweep: -3", "infeasible", "9:6", "segment 3 cannot be planned: the arc does not end");
    check(
        "duration: 1, acceleration_time: 0.2, anticipation: 0.2",
        "duration: 1, acceleration_time: 0.2, anticipation: 3",
        "infeasible",
        "12:6",
        "segment 6",
    );
    check("line: [0.48, 0.06, 0]", "lines: [0.48, 0.06, 0]", "unknown-key", "8:6", "did you mean `line`?");
    check("duration: 1.5, acceleration_time: 0.2", "duration: 1.5", "time-law", "8:6", "make no time law");
    check("[[0, 1, 0], [1, 0, 0], [0, 0, -1]]", "[[0, 1, 0], [1, 0, 0]]", "wrong-length", "4:8", "2 instead of 3");
}

#[test]
fn an_experiment_for_another_robot_is_left_alone() {
    assert!(
        matches!(parse("a.yaml", "robot: someone_else\nanything: 1\n"), Parsed::OtherRobot(robot) if robot == "someone_else")
    );
    assert!(matches!(parse("a.yaml", ""), Parsed::Faulty(text, 1) if text.contains("empty-file")));
    assert!(matches!(parse("a.yaml", "robot: [\n"), Parsed::Faulty(..)));
}

/// `damping` and `threshold` mean what the page says: above the threshold the law is the inverse, below it errors stay.
#[test]
fn damping_begins_below_the_threshold() {
    let text = text_of("clik_inverse.yaml").replace("duration: 20", "duration: 2").replace("[0, 20]", "[0, 2]");
    let run = |law: &str| {
        let text = text.replace("algorithm: inverse", &format!("algorithm: {law}"));
        let Parsed::Experiment(experiment) = parse("clik_inverse.yaml", &text) else { return None };
        let mut job = Job::new(*experiment);
        job.run(out().path());
        let errors = job.record.log.rows().flat_map(|row| row[5..9].to_vec());
        Some(errors.map(f64::abs).fold(0.0, f64::max))
    };
    let damped =
        |damping: f64, threshold: f64| run(&format!("damped_least_squares\n  damping: {damping}\n  threshold: {threshold}"));
    // w is 0.22 at the start.
    let (Some(inverse), Some(above), Some(below)) = (run("inverse"), damped(0.5, 1e-3), damped(0.5, 0.5)) else { return };
    assert_eq!(inverse, above);
    assert!(below > 10.0 * inverse, "{below} {inverse}");
}

#[test]
fn what_is_not_as_expected_is_outside() {
    let text = text_of("manipulability.yaml").replacen("value: 0.25, tolerance: 6e-13", "value: 0.26, tolerance: 6e-13", 1);
    let Parsed::Experiment(experiment) = parse("manipulability.yaml", &text) else { return };
    let mut job = Job::new(*experiment);
    job.run(out().path());
    let (report, met) = report(&[job]);
    assert!(!met && report.contains("OUTSIDE") && report.contains("32 of 33"), "{report}");
}
