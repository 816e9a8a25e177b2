//! Runs that begin on their path, and how hard they ask the joints to work.

use crate::common;

use armgen_experiments::campaign::Job;
use armgen_experiments::model::{JointQuantity, Quantity};
use common::{experiment, folder, text_of};

const START: &str = "start: [-1.3913099976180494, 2.0650786546949544, 0.4, 0.673768657076905]";

/// `adaptive_a.yaml`, shortened, with this start.
fn text(start: &str) -> String {
    let text = text_of(&folder(), "adaptive_a.yaml");
    let (head, _) = text.split_once("expect:").expect("expectations");
    assert!(head.contains(START) && head.contains("duration: 22"));
    let head = head.replace(START, start).replace("duration: 22", "duration: 0.1");
    head + "expect:\n  - {quantity: eq_quill, peak: [0, 0.1], at_most: 0.1}\n"
}

/// The tip starts on the path. Two postures reach it; the run takes the one on the requested side.
#[test]
fn a_start_from_the_path_is_on_the_path() {
    let arm = armgen_experiment_tests::scara();
    let begin = |start: &str| {
        let experiment = experiment("start.yaml", &text(start), arm.robot());
        let mut job = Job::new(&experiment, &*arm);
        job.run();
        let of = |quantity| job.record().values(quantity)[0];
        for row in &arm.robot().task {
            let off = of(Quantity::TaskError(*row));
            assert!(off.abs() < 1e-8, "{start}: {off}");
        }
        assert!(job.lines().iter().all(|line| line.met), "{start}: {:?}", job.lines());
        of(Quantity::Joint(JointQuantity::Position, 1))
    };
    begin("start: {from: path}");
    let (above, below) =
        (begin("start: {from: path, near: [-1.4, 2, 0.4, 0.7]}"), begin("start: {from: path, near: [0.7, -2, 0.4, 0.7]}"));
    assert!((above - 2.065).abs() < 1e-3 && (above + below).abs() < 1e-6, "{above} {below}");
}

/// The peaks reported with the limits match the log.
#[test]
fn peaks_are_the_largest_of_what_is_logged() {
    let arm = armgen_experiment_tests::scara();
    let experiment = experiment("peaks.yaml", &text("start: {from: path}"), arm.robot());
    let mut job = Job::new(&experiment, &*arm);
    job.run();
    assert_eq!(job.record().peaks.len(), 4);
    for (i, peak) in job.record().peaks.iter().enumerate() {
        let efforts = job.record().values(Quantity::Joint(JointQuantity::Effort, i));
        assert_eq!(peak.effort, efforts.iter().fold(0.0f64, |a, x| a.max(x.abs())), "{i}");
        // No sample is farther from the one before it than the largest rate allows, and it is about that for one of them.
        let q = job.record().values(Quantity::Joint(JointQuantity::Position, i));
        let fastest = q.windows(2).fold(0.0f64, |a, two| a.max((two[1] - two[0]).abs())) / 1e-3;
        assert!(peak.rate > 0.0 && (peak.rate / fastest - 1.0).abs() < 0.1, "{i}: {} {fastest}", peak.rate);
    }
}

/// Without a posture to start near, each of the two postures of a pose is possible, and the run takes the nearer to zero, without whole turns.
#[test]
fn a_start_from_the_path_is_the_nearest_to_zero() {
    let arm = armgen_experiment_tests::scara();
    let begin = |path: &str, start: &str| -> Vec<f64> {
        // Without expectations: the run is drawn and not judged.
        let text = text(start).replace("path: paths/ghost.yaml", "path: way");
        let text = text.split_once("expect:").expect("expectations").0;
        assert!(text.contains("path: way"), "{text}");
        let open = |_: &std::path::Path| Ok(path.to_owned());
        let source = armgen_codegen::source::Source::new("start.yaml", text);
        let parsed = armgen_experiments::read::experiment(source.name().as_ref(), &source, arm.robot(), &open);
        let armgen_experiments::read::Parsed::Experiment(experiment) = parsed else { panic!("{}", common::said(&parsed)) };
        let mut job = Job::new(&experiment, &*arm);
        assert!(job.implausible_settings().is_empty(), "{path}: {:?}", job.implausible_settings());
        job.run();
        assert!(job.lines().is_empty() && !job.figures().is_empty(), "{:?}", job.lines());
        (0..4).map(|joint| job.record().values(Quantity::Joint(JointQuantity::Position, joint))[0]).collect()
    };
    let half_turns = |q: &[f64]| [0, 1, 3].iter().all(|&joint| q[joint].abs() <= std::f64::consts::PI);
    for [x, y, z] in [[0.5, -0.1, 0.2], [-0.4, 0.4, 0.3], [0.6, 0.2, 0.1], [0.3, 0.5, 0.1], [0.7, 0.0, 0.2]] {
        let path = format!("start: [{x}, {y}, {z}]\nsegments:\n  - {{line: [{x}, {y}, 0.25], duration: 1, law: cubic}}\n");
        let found = begin(&path, "start: {from: path}");
        assert!(half_turns(&found), "{path}: {found:?}");
        // The other elbow reaches the same point, turned as much the other way.
        let heading = 2.0 * f64::atan2(y, x);
        let other = begin(&path, &format!("start: {{from: path, near: [{}, {}, {z}, 0]}}", heading - found[0], -found[1]));
        // The turn of the wrist is free: the path asks for a point.
        let size = |q: &[f64]| q[..3].iter().map(|x| x * x).sum::<f64>();
        assert!((found[1] + other[1]).abs() < 1e-6 && size(&found) <= size(&other) + 1e-6, "{path}: {found:?}, {other:?}");
    }
}
