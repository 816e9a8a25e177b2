//! Every experiment of the repository gives its expected results, on the robot that it is written for.

use crate::common;

use std::path::Path;

use armgen_codegen::source::Source;
use armgen_experiments::campaign::{in_parallel, Job};
use armgen_experiments::draw::OutputFile;
use armgen_experiments::model::{ControlLawKind, Experiment, JointQuantity, Quantity};
use armgen_experiments::read::{self, Parsed};
use armgen_experiments::run::Arm;
use common::{experiment, files, folder, said, text_of};

/// How many experiments and expectations there are: none gets lost unseen.
const EXPERIMENTS: usize = 29;
const EXPECTATIONS: usize = 198;

fn all(arm: &dyn Arm) -> Vec<Experiment> {
    let names = files(&folder());
    names.iter().map(|name| experiment(name, &text_of(&folder(), name), arm.robot())).collect()
}

#[test]
fn every_experiment_gives_what_is_expected() {
    let arm = armgen_experiment_tests::scara();
    let experiments = all(&*arm);
    assert_eq!(experiments.len(), EXPERIMENTS);
    assert_eq!(experiments.iter().map(|e| e.expect.len()).sum::<usize>(), EXPECTATIONS);
    assert!(experiments.iter().all(|e| !e.expect.is_empty()));
    let mut jobs: Vec<Job<'_>> = experiments.iter().map(|experiment| Job::new(experiment, &*arm)).collect();
    in_parallel(&mut jobs, Job::prepare);
    for job in &jobs {
        let name = &job.experiment().name;
        let unstable = name.ends_with("_delayed") || name.starts_with("adaptive_reported");
        let unstable = unstable || ["branch_out_of_reach", "branch_singular"].contains(&name.as_str());
        assert!(job.record().log().is_empty(), "{name} has not moved yet");
        assert_eq!(job.warning().is_some(), unstable, "{name}: {:?}", job.warning());
    }
    in_parallel(&mut jobs, Job::run);
    let mut lines = 0;
    for job in &jobs {
        let name = &job.experiment().name;
        for line in job.lines() {
            assert!(line.met, "{name}: {} is {}, expected {}", line.what, line.found, line.expected);
            lines += 1;
        }
        assert!(!job.figures().is_empty(), "{name} is drawn");
        for OutputFile { name: file, text } in job.figures() {
            assert!(file.starts_with(name.as_str()) && text.starts_with("<svg") && !text.contains("NaN"), "{file}");
        }
    }
    assert_eq!(lines, EXPECTATIONS);
}

/// An early end that no expected number reports is a failure, whatever else is expected.
#[test]
fn a_run_that_ends_for_another_reason_is_not_as_expected() {
    let arm = armgen_experiment_tests::scara();
    let ends = |name: &str, text: &str| {
        let experiment = experiment(name, text, arm.robot());
        let mut job = Job::new(&experiment, &*arm);
        job.run();
        let lines = job.lines();
        assert!(lines[0].met, "{name}: {lines:?}");
        lines.get(1).map(|line| (line.what.clone(), line.found.clone()))
    };
    let expect = |text: &str, quantity: &str| {
        let (head, _) = text.split_once("expect:").expect("expectations");
        format!("{head}expect:\n  - {{quantity: {quantity}}}\n")
    };
    let reported = text_of(&folder(), "inverse_dynamics_reported.yaml").replace("duration: 22", "duration: 0.5");
    let noisy = reported.replace("controller:", "sensor: {position_deviation: 2}\ncontroller:");
    // The measurement is off, and the arm never is.
    let (what, found) = ends("noisy.yaml", &expect(&noisy, "lost_at, at_least: 0.1")).expect("it ends early");
    assert!(
        what == "runs to the end" && found.starts_with("given up at ") && found.contains(" is off by more than 1 "),
        "{found}"
    );
    // The arm is off, and is expected to be.
    let lost = text_of(&folder(), "adaptive_reported.yaml");
    assert_eq!(ends("lost.yaml", &expect(&lost, "lost_at, at_most: 1")), None);
    assert!(ends("radius.yaml", &expect(&lost, "radius, at_least: 1")).is_some(), "nothing expected of it");
    // A branch that has not begun does not end.
    let branch =
        text_of(&folder(), "branch_pick_and_place.yaml").replace("{from: path, near: [-1, 1.5, 0.3, 0]}", "[0, 1, 0.3, 0]");
    let (_, found) = ends("branch.yaml", &expect(&branch, "branch_ends_at, at_most: 1")).expect("no branch");
    assert!(found.ends_with("the posture to start from does not reach the start of the path"), "{found}");
}

/// The path beyond the end of a run costs nothing, however long it is and however short the period.
#[test]
fn a_via_point_behind_the_end_of_the_run_is_not_met() {
    let arm = armgen_experiment_tests::scara();
    let path = "start: [0, 0, 0]\nsegments:\n  - {line: [1, 0, 0], duration: 20, law: cubic}\n  - {line: [1, 1, 0], duration: 20, law: cubic, anticipation: 10}\n";
    let via = |duration: f64| {
        let text = format!("robot: scara\ntitle: Two lines\npath: way\nsampling: {}\nduration: {duration}\nexpect:\n  - {{quantity: via_1, at_most: 1}}\n", duration / 100.0);
        let parsed = read::experiment(Path::new("via.yaml"), &Source::new("via.yaml", text), arm.robot(), &|_| Ok(path.into()));
        let Parsed::Experiment(experiment) = parsed else { panic!("{}", said(&parsed)) };
        let mut job = Job::new(&experiment, &*arm);
        job.run();
        assert!(job.record().log().len() <= 101);
        job.record().numbers.iter().find(|(channel, _)| channel.quantity == Quantity::Via(0)).expect("a via point").1
    };
    assert!(via(1e-3).is_nan() && via(19.0).is_nan());
    // By symmetry the least distance is in the middle of both, where each line is 3/16 - 2/64 of its length from the point.
    assert!((via(20.0) - 2.0f64.sqrt() * 0.15625).abs() < 1e-12, "{}", via(20.0));
}

/// The end of a branch is reported before the run starts.
#[test]
fn where_a_branch_ends_is_said_before_anything_moves() {
    let arm = armgen_experiment_tests::scara();
    let warning = |file: &str, text: &str| {
        let experiment = experiment(file, text, arm.robot());
        let mut job = Job::new(&experiment, &*arm);
        job.prepare();
        job.warning().unwrap_or_default()
    };
    let said = warning("branch_out_of_reach.yaml", &text_of(&folder(), "branch_out_of_reach.yaml"));
    assert_eq!(said, "the branch ends at 1.120447 s of 2 s: the path leaves the reach of the arm");
    let said = warning("branch_singular.yaml", &text_of(&folder(), "branch_singular.yaml"));
    assert!(said.starts_with("the branch ends at 1.000000 s of 2 s: "), "{said}");
    let text =
        text_of(&folder(), "branch_pick_and_place.yaml").replace("{from: path, near: [-1, 1.5, 0.3, 0]}", "[0, 1, 0.3, 0]");
    let said = warning("branch_pick_and_place.yaml", &text);
    assert_eq!(said, "the branch ends at 0.000000 s of 4.4 s: the posture to start from does not reach the start of the path");
}

#[test]
fn the_reported_adaptive_gains_are_called_unstable_before_anything_moves() {
    let arm = armgen_experiment_tests::scara();
    let experiment = experiment("adaptive_reported.yaml", &text_of(&folder(), "adaptive_reported.yaml"), arm.robot());
    let mut job = Job::new(&experiment, &*arm);
    job.prepare();
    assert!(job.record().log().is_empty());
    assert_eq!(
        job.warning().as_deref(),
        Some("sampled at 1 ms, unstable at rest: spectral radius 9.01; a period up to 0.2 ms would hold; diverges in motion: simulated without noise, joint `elbow` is lost at 0.005 s; nor does it hold at 0.1 ms")
    );
}

/// `damping` and `threshold` work as documented: above the threshold the law is the inverse, below it errors remain.
#[test]
fn damping_begins_below_the_threshold() {
    let arm = armgen_experiment_tests::scara();
    let text = text_of(&folder(), "clik_inverse.yaml").replace("duration: 20", "duration: 2").replace("[0, 20]", "[0, 2]");
    let run = |law: &str| {
        let text = text.replace("algorithm: inverse", &format!("algorithm: {law}"));
        let experiment = experiment("clik_inverse.yaml", &text, arm.robot());
        let mut job = Job::new(&experiment, &*arm);
        job.run();
        let errors = arm.robot().task.iter().flat_map(|row| job.record().values(Quantity::TaskError(*row)));
        let largest = errors.map(f64::abs).reduce(f64::max).expect("there are samples");
        assert!(largest > 0.0);
        largest
    };
    let damped =
        |damping: f64, threshold: f64| run(&format!("damped_least_squares\n  damping: {damping}\n  threshold: {threshold}"));
    // w is 0.22 at the start.
    let (inverse, above, below) = (run("inverse"), damped(0.5, 1e-3), damped(0.5, 0.5));
    assert_eq!(inverse, above);
    assert!(below > 10.0 * inverse, "{below} {inverse}");
}

#[test]
fn what_is_not_as_expected_is_outside() {
    let arm = armgen_experiment_tests::scara();
    let text = text_of(&folder(), "manipulability.yaml");
    let wrong = text.replacen("value: 0.25, tolerance: 6e-13", "value: 0.26, tolerance: 6e-13", 1);
    let experiment = experiment("manipulability.yaml", &wrong, arm.robot());
    let mut job = Job::new(&experiment, &*arm);
    job.run();
    let (lines, met) = (job.lines(), job.lines().iter().filter(|line| line.met).count());
    assert_eq!((lines.len(), met), (33, 32));
}

/// Every law gives a torque and uses every gain that it requires.
#[test]
fn every_law_moves_the_arm() {
    let arm = armgen_experiment_tests::scara();
    let head = text_of(&folder(), "adaptive_a.yaml");
    let (head, _) = head.split_once("controller:").expect("a controller");
    let head = head.replace("duration: 22", "duration: 0.2");
    let gains = |kind: ControlLawKind| {
        match kind {
        ControlLawKind::PdGravity => "k_p: [1e5, 1e5, 1e5, 1e5]\n  k_d: [1e3, 1e3, 1e3, 1e3]",
        ControlLawKind::InverseDynamics => "k_p: [1e4, 1e4, 1e4, 1e4]\n  k_d: [200, 200, 200, 200]",
        ControlLawKind::Robust => {
            "k_p: [1e4, 1e4, 1e4, 1e4]\n  k_d: [200, 200, 200, 200]\n  p_position: [1, 1, 1, 1]\n  p_velocity: [1, 1, 1, 1]\n  rho: 1\n  epsilon: 0.2"
        }
        ControlLawKind::Adaptive => {
            "lambda: [100, 100, 100, 100]\n  k_d: [1000, 500, 2000, 100]\n  k_pi: [10, 10, 0.01, 10, 10, 10, 10, 10, 10, 10, 10, 10, 10, 10]"
        }
        ControlLawKind::OperationalSpace => "k_p: [1e4, 1e4, 1e4, 1e4]\n  k_d: [200, 200, 200, 200]\n  k_i: [0, 0, 0, 0]",
        ControlLawKind::Limited => {
            "k_p: [1e4, 1e4, 1e4, 1e4]\n  k_d: [200, 200, 200, 200]\n  k_i: [0, 0, 0, 0]\n  rate_limits: [10, 10, 5, 20]\n  acceleration_limits: [200, 200, 50, 400]\n  horizon: 8e-3\n  braking: 0.7"
        }
    }
    };
    for kind in ControlLawKind::ALL {
        let name = kind.name();
        let text = |more: &str| {
            let gains = gains(kind);
            let expect = "expect:\n  - {quantity: eq_quill, peak: [0, 0.2], at_most: 0.1}\n";
            format!("{head}controller:\n  law: {name}\n  {gains}\n{more}{expect}")
        };
        let run = |text: &str| {
            let experiment = experiment("law.yaml", text, arm.robot());
            let mut job = Job::new(&experiment, &*arm);
            job.run();
            assert!(job.lines().iter().all(|line| line.met), "{name}: {:?}", job.lines());
            assert_eq!(job.record().log().len(), 201, "{name}");
            job.record().values(Quantity::Joint(JointQuantity::Effort, 2))
        };
        let free = run(&text(""));
        assert!(free.iter().all(|tau| tau.is_finite()));
        let limited = run(&text("  torque_limits: [1e3, 1e3, 120, 1e3]\n"));
        assert!(limited.iter().all(|tau| tau.abs() <= 120.0), "{name} keeps the limit");
        assert!(free.iter().any(|tau| tau.abs() > 120.0), "{name} would not without");
    }
}

#[test]
fn any_arm_can_show_itself() {
    let arm = armgen_experiment_tests::scara();
    let demonstration = arm.demonstrate().expect("it can be run");
    assert_eq!(demonstration.fault, None);
    assert!(demonstration.summary.iter().any(|line| line.contains("spectral radius")), "{:?}", demonstration.summary);
    let log = demonstration.record.log();
    assert!(log.len() > 1000 && log.rows().flatten().all(|x| x.is_finite()));
    let figure = armgen_experiments::draw::demonstration(&demonstration.record, arm.robot());
    assert!(figure.starts_with("<svg") && !figure.contains("NaN"));
}
