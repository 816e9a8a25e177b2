//! Verdicts on a UR10, compared with the simulated arm.

use crate::common;

use std::time::Duration;

use armgen_experiment_tests::ur10;
use armgen_experiments::campaign::Job;
use armgen_experiments::read::Parsed;
use armgen_runtime::control::Adaptive;
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::{JointReference, State};
use armgen_runtime::simulation::{run, Integrator, RunOptions};
use armgen_runtime::stability::{analyse, Delay, MotionAnalysis};
use common::{parse, said, text_of};

const K_D: [f64; 6] = [20.0, 20.0, 10.0, 0.5, 0.5, 0.05];

/// The estimate begins at 0 and the load is 5 kg: a transient, since the law is stable in continuous time for all positive gains.
#[test]
fn a_start_from_another_estimate_is_no_alarm() {
    let arm = armgen_experiment_tests::ur10_load();
    let folder = common::root().join("tests/experiments/ur10");
    for period in ["0.002", "0.0001"] {
        let text = text_of(&folder, "adaptive_load.yaml").replace("sampling: 0.002", &format!("sampling: {period}"));
        let experiment = match parse(&folder, "adaptive_load.yaml", &text, arm.robot()) {
            Parsed::Experiment(experiment) => experiment,
            other => panic!("{}", said(&other)),
        };
        let mut job = Job::new(&experiment, &*arm);
        job.prepare();
        assert_eq!(job.warning(), None, "{period} s");
        // It converges, as predicted.
        if period == "0.002" {
            job.run();
            for line in job.lines() {
                assert!(line.met, "{} is {}, expected {}", line.what, line.found, line.expected);
            }
        }
    }
}

/// q_i = c_i + 0.3 (1 - cos w_i t)
fn reference(t: f64) -> JointReference<f64, 6> {
    const W: [f64; 6] = [1.1, 0.9, 1.3, 1.7, 2.0, 2.3];
    const C: [f64; 6] = [0.3, -1.2, 1.4, -0.5, 1.0, 0.2];
    let of = |f: fn(f64, f64) -> f64| SVector::from_fn(|i, _| f(W[i], t));
    let turned = of(|w, t| 0.3 * (1.0 - (w * t).cos()));
    JointReference {
        q: SVector::from(C) + turned,
        dq: of(|w, t| 0.3 * w * (w * t).sin()),
        ddq: of(|w, t| 0.3 * w * w * (w * t).cos()),
    }
}

/// All sixty parameters adapted, 5 kg more in `m6` than they begin with: at rest all is well at every period; in motion it is not.
#[test]
fn what_diverges_in_motion_is_called_so() {
    let mut parameters = ur10::NOMINAL_PARAMETERS;
    let m6 = ur10::PARAMETER_NAMES.iter().position(|name| *name == "m6").expect("a standard parameter");
    parameters[m6] += 5.0;
    let plant = ur10::WithParameters { parameters };
    let postures: Vec<_> = (0..40).map(|k| reference(0.25 * f64::from(k)).q).collect();
    for (period, diverges) in [(1e-3, true), (0.5e-3, true), (0.2e-3, false), (0.1e-3, false)] {
        let controller = || Adaptive::new([20.0; 6], K_D, [10.0; 60], ur10::NOMINAL_PARAMETERS, period).unwrap();
        let rest = analyse(&plant, &ur10::Nominal, &controller(), &postures, period, Delay::NONE).unwrap();
        assert!(rest.is_stable(), "{period}: {rest:?}");
        let seconds = 4.0;
        let joints: Vec<_> = (0..(seconds / period) as usize).map(|k| reference(k as f64 * period)).collect();
        let start = State::at_rest(joints[0].q);
        let analysis = MotionAnalysis { plant: &plant, joints: &joints, start, period, delay: Delay::NONE };
        let motion = analysis.of(&ur10::Nominal, &controller(), &joints).unwrap();
        println!("{period}: {motion:?}");
        assert_eq!(motion.diverges(), diverges, "{period}: {motion:?}");
        assert!(motion.growth.largest < 2.0, "about the true parameters it is stable: {motion:?}");
        // The simulated arm, with another step of its integrator.
        let mut law = controller();
        let mut options = RunOptions::new(Duration::from_secs_f64(period), Duration::from_secs_f64(seconds));
        options.integrator = Integrator::RungeKutta4 { substeps: 2 };
        let mut largest = 0.0f64;
        let end = run(
            &plant,
            start,
            options,
            |t, measured| law.torque(&ur10::Nominal, &reference(t.as_secs_f64()), measured).map(|torque| torque.tau),
            |sample| largest = largest.max((reference(sample.time.as_secs_f64()).q - sample.state.q).amax()),
        );
        assert_eq!(end.is_err() || largest > 1.0, diverges, "{period}: {largest}");
    }
}

/// Implausible settings are reported before the run starts.
#[test]
fn a_start_in_degrees_and_a_path_beyond_reach_are_seen() {
    let arm = armgen_experiment_tests::ur10_load();
    let folder = common::root().join("tests/experiments/ur10");
    let said_of = |from: &str, to: &str| {
        let text = text_of(&folder, "adaptive_load.yaml").replace(from, to);
        let experiment = match parse(&folder, "adaptive_load.yaml", &text, arm.robot()) {
            Parsed::Experiment(experiment) => experiment,
            other => panic!("{}", said(&other)),
        };
        let doubts = Job::new(&experiment, &*arm).implausible_settings();
        doubts
    };
    let start = "[0, -pi/2, pi/2, -pi/2, -pi/2, 0]";
    assert_eq!(said_of("", "").len(), 1, "its start is a little off its path");
    let degrees = said_of(start, "[0, -90, 90, -90, -90, 0]");
    assert_eq!(degrees.iter().filter(|line| line.contains("in degrees? write `deg(")).count(), 4, "{degrees:?}");
    let turned = said_of(start, "[7, -pi/2, pi/2, -pi/2, -pi/2, 0]");
    assert!(turned[0].contains("outside its limits") && turned[0].contains("0.7168"), "{turned:?}");
    assert!(said_of(start, "[3, -pi/2, pi/2, -pi/2, -pi/2, 0]").iter().any(|line| line.starts_with("the start is off the path")));
    let far = said_of("paths/circle.yaml", "paths/far.yaml");
    assert!(far[0].starts_with("the path leaves the reach of the arm: at 0 s it is 5.0249 m from the base"), "{far:?}");
    assert!(far[0].ends_with("it is nearest at 4 s, 3.0414 m"), "{far:?}");
    // A path that is sampled less often is looked at less often.
    let rarely = said_of(
        "paths/circle.yaml
start: [0, -pi/2, pi/2, -pi/2, -pi/2, 0]
sampling: 0.002",
        "paths/far.yaml
start: [0, -pi/2, pi/2, -pi/2, -pi/2, 0]
sampling: 3",
    );
    assert!(rarely[0].contains("it is nearest at 3 s, "), "{rarely:?}");
    assert_eq!(said_of("k_p: [400, 400, 400, 400, 400, 400]", "k_p: 400"), said_of("", ""));
}
