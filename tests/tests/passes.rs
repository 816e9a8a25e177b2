//! The values of a module do not depend on the passes that reduce its cost. Without any single pass, and without all passes, it
//! agrees with the stored reference values equally well. It agrees with the module of all passes except for the last digits.
//!
//! `cargo test -p armgen-tests --test all passes -- --ignored --nocapture` prints by how much; docs/passes.md has the largest.

use armgen_codegen::pass::{Pass, Passes};
use armgen_codegen::schedule::{Options, Selection};
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::precision::{agree, deviation, FORWARD_RESIDUAL, REFERENCE, WITHOUT_A_PASS};
use armgen_tests::reference::{description, reference, Sample, ROBOTS};

/// The functions that the stored values judge, and the regressor of base parameters.
const FUNCTIONS: [&str; 9] = [
    "direct_kinematics",
    "geometric_jacobian",
    "inertia_matrix",
    "coriolis_matrix",
    "gravity",
    "equations_of_motion",
    "inverse_dynamics",
    "forward_dynamics",
    "base_regressor",
];

fn without(robot: &str, without: Passes) -> Interpreted {
    let functions = Selection::named(FUNCTIONS).expect("they are emitted functions");
    Interpreted::with_options(&description(robot), &Options { without, functions: functions.clone(), ..Options::default() })
        .expect("valid")
}

fn arguments(sample: &Sample) -> Arguments {
    let Sample { q, dq, ddq, tau, .. } = sample.clone();
    Arguments { q, dq, ddq, tau, ..Arguments::default() }
}

/// The torque by the regressor of base parameters.
fn torque(robot: &Interpreted, a: &Arguments) -> Vec<f64> {
    let base = robot.nominal_base();
    let rows = robot.call("base_regressor", a);
    rows.chunks(base.len()).map(|row| row.iter().zip(&base).map(|(y, pi)| y * pi).sum()).collect()
}

/// The agreement that every module owes to the stored values.
#[track_caller]
fn check(what: &str, robot: &Interpreted, sample: &Sample) {
    let a = arguments(sample);
    let terms = [sample.inertia_matrix.concat(), sample.coriolis_matrix.concat(), sample.gravity.clone()];
    for (function, expected) in [
        ("direct_kinematics", sample.direct_kinematics.concat()),
        ("geometric_jacobian", sample.geometric_jacobian.concat()),
        ("inertia_matrix", terms[0].clone()),
        ("coriolis_matrix", terms[1].clone()),
        ("gravity", terms[2].clone()),
        ("equations_of_motion", terms.concat()),
        ("inverse_dynamics", sample.tau.clone()),
    ] {
        agree(&format!("{what}: {function}"), &robot.call(function, &a), &expected, REFERENCE);
    }
    agree(&format!("{what}: base_regressor"), &torque(robot, &a), &sample.tau, REFERENCE);
    // B (ddq - ddq_ref) over max(1, |tau|).
    let ddq = robot.call("forward_dynamics", &a);
    let scale = sample.tau.iter().fold(1.0f64, |most, tau| most.max(tau.abs()));
    for row in &sample.inertia_matrix {
        let residual: f64 = row.iter().zip(ddq.iter().zip(&sample.ddq)).map(|(b, (x, y))| b * (x - y)).sum();
        assert!(residual.abs() <= FORWARD_RESIDUAL * scale, "{what}: forward_dynamics: residual {residual:e}");
    }
}

/// By how much a robot's functions differ from those with all passes, at the stored states.
fn difference(all: &Interpreted, other: &Interpreted, samples: &[Sample]) -> f64 {
    let of = |sample: &Sample| {
        let a = arguments(sample);
        let shared = FUNCTIONS.iter().filter(|&&function| function != "forward_dynamics" && function != "base_regressor");
        let direct = shared.map(|function| deviation(&other.call(function, &a), &all.call(function, &a)));
        direct.fold(deviation(&torque(other, &a), &torque(all, &a)), f64::max)
    };
    samples.iter().map(of).fold(0.0, f64::max)
}

#[test]
#[ignore = "wide"]
fn every_module_agrees_with_the_reference_without_any_pass() {
    let none_and_all = [("all passes".to_owned(), Passes::NONE), ("without any".to_owned(), Passes::all())];
    let each = Pass::ALL.map(|pass| (format!("without `{}`", pass.name()), [pass].into_iter().collect()));
    let choices: Vec<(String, Passes)> = none_and_all.into_iter().chain(each).collect();
    let columns: Vec<Vec<f64>> = std::thread::scope(|scope| {
        let robots = ROBOTS.map(|name| {
            let choices = &choices;
            scope.spawn(move || {
                let samples = reference(name).samples;
                let all = without(name, Passes::NONE);
                choices
                    .iter()
                    .map(|(what, passes)| {
                        let robot = without(name, *passes);
                        samples.iter().for_each(|sample| check(&format!("{name} {what}"), &robot, sample));
                        difference(&all, &robot, &samples)
                    })
                    .collect()
            })
        });
        robots.into_iter().map(|robot| robot.join().expect("agrees with the reference")).collect()
    });
    println!("| | {} |", ROBOTS.join(" | "));
    for (k, (what, _)) in choices.iter().enumerate().skip(1) {
        let row: Vec<String> = columns.iter().map(|column| format!("{:.1e}", column[k])).collect();
        println!("| {what} | {} |", row.join(" | "));
    }
    for (name, column) in ROBOTS.iter().zip(&columns) {
        for ((what, _), &difference) in choices.iter().zip(column) {
            assert!(difference <= WITHOUT_A_PASS, "{name} {what}: differs by {difference:e}");
        }
    }
    let changed = columns.iter().flatten().filter(|&&difference| difference > 0.0).count();
    assert!(changed > choices.len(), "the passes are switched off");
}
