//! Arms with branches: values of other programs, what follows from independence of branches, operations, and what is refused.

use armgen_codegen::description::Convention;
use armgen_codegen::diagnostic::Colour;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::Model;
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::precision::{deviation, REFERENCE};
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::verify_with;
use serde_json::Value;

const TWO_ARMS: &str = include_str!("../data/trees/two_arms.yaml");
/// Two arms of three parallel axes, listed alternately.
const INTERLEAVED: &str = include_str!("../data/trees/interleaved.yaml");

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[track_caller]
fn agrees(robot: &str, values: &str) {
    let robot = Interpreted::new(robot).expect("valid");
    let values: Value = serde_json::from_str(values).expect("JSON");
    for state in values["states"].as_array().expect("states") {
        let [q, dq, ddq, tau] = ["q", "dq", "ddq", "inverse_dynamics"].map(|key| numbers(&state[key]));
        let arguments = Arguments { q, dq, ddq: ddq.clone(), tau, ..Arguments::default() };
        for function in [
            "direct_kinematics",
            "geometric_jacobian",
            "geometric_jacobian_dot",
            "inertia_matrix",
            "coriolis_matrix",
            "gravity",
            "inverse_dynamics",
            "kinetic_energy",
        ] {
            let off = deviation(&robot.call(function, &arguments), &numbers(&state[function]));
            assert!(off < REFERENCE, "{function}: {off:e}");
        }
        let off = deviation(&robot.call("forward_dynamics", &arguments), &ddq);
        assert!(off < REFERENCE, "forward_dynamics: {off:e}");
    }
}

#[test]
fn two_arms_have_the_values_of_other_programs() {
    agrees(TWO_ARMS, include_str!("../data/trees/two_arms.json"));
}

/// Runs of parallel axes whose joints are not consecutive: with a joint in two runs C alone is wrong.
#[test]
fn interleaved_arms_have_the_values_of_other_programs() {
    agrees(INTERLEAVED, include_str!("../data/trees/interleaved.json"));
}

#[test]
fn the_checker_accepts_both() {
    for text in [TWO_ARMS, INTERLEAVED] {
        let source = Source::new("robot.yaml", text);
        let (generated, _) = armgen_codegen::generate(&source, &Options::default());
        let generated = generated.expect("valid");
        let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
        let report = verify_with(&source, &generated.module, claims, Effort { points: 2, exact_points: 1, seed: 1 });
        assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
        assert!(report.functions.len() >= 32);
    }
}

/// Joints of different arms share no entry of B and C but through the torso.
#[test]
fn branches_share_no_entry() {
    let robot = Interpreted::new(TWO_ARMS).expect("valid");
    let q = vec![0.3, -0.2, 0.5, 0.7, -0.4, 0.1, 0.9];
    let arguments = Arguments { dq: q.clone(), q, ..Arguments::default() };
    for function in ["inertia_matrix", "coriolis_matrix"] {
        let found = robot.call(function, &arguments);
        for (left, right) in (1..4).flat_map(|i| (4..7).map(move |j| (i, j))) {
            assert_eq!([found[7 * left + right], found[7 * right + left]], [0.0; 2], "{function} {left} {right}");
        }
        assert!((1..7).all(|i| found[i] != 0.0), "{function}");
    }
}

/// Of 70 link parameters a motion shows 43, whatever the order of the joints.
#[test]
fn base_parameters_of_trees_are_counted_exactly() {
    for text in [TWO_ARMS, INTERLEAVED] {
        let lines = text.lines().filter(|line| !line.starts_with("    motor:"));
        let text = lines.map(|line| format!("{line}\n")).collect::<String>();
        let (arm, _) = validate::read(&Source::new("robot.yaml", text)).0.expect("valid");
        let model = Model::new(arm);
        let (vector, _) =
            armgen_codegen::derive::base::base_combinations(&model.manipulator, &model.field).expect("short combinations");
        assert_eq!(vector.entries.len(), 43, "{:?}", vector.entries.iter().map(|entry| &entry.name).collect::<Vec<_>>());
    }
}

/// A mount is a pose between the parent's link frame and the row, in every convention.
#[test]
fn a_mount_in_front_of_an_origin_is_one_pose() {
    let split =
        TWO_ARMS.replacen("origin: {xyz: [0, -0.2, 0.4]}", "mount: {xyz: [0, -0.2, 0]}\n    origin: {xyz: [0, 0, 0.4]}", 1);
    assert_ne!(split, TWO_ARMS);
    let [one, other] = [TWO_ARMS, &split].map(|text| Interpreted::new(text).expect("valid"));
    assert_eq!(one.module.functions.len(), other.module.functions.len());
    let q = vec![0.3, -0.2, 0.5, 0.7, -0.4, 0.1, 0.9];
    let arguments = Arguments { dq: q.clone(), ddq: q.clone(), q, ..Arguments::default() };
    for function in ["direct_kinematics", "link_frames", "inverse_dynamics"] {
        let off = deviation(&one.call(function, &arguments), &other.call(function, &arguments));
        assert!(off < REFERENCE, "{function}: {off:e}");
    }
}

/// Every convention writes the tree: frames of the end effector, torques and energies stay what they are.
#[test]
fn conversion_keeps_motions_and_forces() {
    for text in [TWO_ARMS, INTERLEAVED] {
        let robot = Interpreted::new(text).expect("valid");
        let q = vec![0.3, -0.2, 0.5, 0.7, -0.4, 0.1, 0.9];
        let arguments = Arguments { dq: q.clone(), ddq: q.clone(), q, ..Arguments::default() };
        for to in [Convention::Standard, Convention::Modified] {
            let (converted, faults) = armgen_import::convert(&Source::new("robot.yaml", text), to);
            let source = Source::new("robot.yaml", text);
            let yaml = converted.unwrap_or_else(|| panic!("{}", faults.render(&source, Colour::Never))).yaml;
            let back = armgen_import::convert(&Source::new("robot.yaml", yaml.clone()), Convention::Urdf).0.expect("valid").yaml;
            for text in [yaml, back] {
                let other = Interpreted::new(&text).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
                for function in ["direct_kinematics", "geometric_jacobian", "inertia_matrix", "inverse_dynamics"] {
                    let off = deviation(&other.call(function, &arguments), &robot.call(function, &arguments));
                    assert!(off < REFERENCE, "{to:?} {function}: {off:e}\n{text}");
                }
            }
        }
    }
}

/// The end effector of the other hand, and of a link that carries others; conversion keeps both.
#[test]
fn the_tip_is_any_link() {
    let q = vec![0.3, -0.2, 0.5, 0.7, -0.4, 0.1, 0.9];
    let arguments = Arguments { dq: q.clone(), ddq: q.clone(), q, ..Arguments::default() };
    let last = Interpreted::new(TWO_ARMS).expect("valid");
    for (tip, moving) in [("left_3", &[0, 1, 2, 3][..]), ("right_1", &[0, 4]), ("right_3", &[0, 4, 5, 6])] {
        let text = format!("{TWO_ARMS}tip: {tip}\n").replace("tool: {xyz: [0, 0, -0.25], rpy: [0, 0, pi]}\n", "");
        let robot = Interpreted::new(&text).expect("valid");
        let place = robot.module.joints.iter().position(|joint| joint.name == tip).expect("a joint");
        let frames = last.call("link_frames", &arguments);
        let found = robot.call("direct_kinematics", &arguments);
        assert!(deviation(&found, &frames[16 * place..16 * place + 16]) < REFERENCE, "{tip}");
        let jacobian = robot.call("geometric_jacobian", &arguments);
        let moved: Vec<usize> = (0..7).filter(|j| (0..6).any(|row| jacobian[7 * row + j] != 0.0)).collect();
        assert_eq!(moved, moving, "{tip}");
        let (converted, _) = armgen_import::convert(&Source::new("robot.yaml", text), Convention::Standard);
        let other = Interpreted::new(&converted.expect("valid").yaml).expect("valid");
        for function in ["direct_kinematics", "geometric_jacobian", "inverse_dynamics"] {
            let off = deviation(&other.call(function, &arguments), &robot.call(function, &arguments));
            assert!(off < REFERENCE, "{tip} {function}: {off:e}");
        }
    }
}

/// A tree as a URDF is the tree: its chain to the end effector comes back with the same kinematics.
#[test]
fn a_urdf_of_a_tree_has_its_branches() {
    let (exported, _) = armgen_import::export(&Source::new("robot.yaml", TWO_ARMS));
    let urdf = exported.expect("valid").urdf;
    for (joint, parent) in [("left_1", "torso_link"), ("right_1", "torso_link"), ("right_2", "right_1_link"), ("torso", "base")] {
        let start = urdf.find(&format!("<joint name=\"{joint}\"")).expect("a joint");
        let rest = &urdf[start..];
        let end = rest.find("</joint>").expect("its end");
        assert!(rest[..end].contains(&format!("<parent link=\"{parent}\"/>")), "{}", &rest[..end]);
    }
}

/// Elimination from the leaves leaves zeros between branches: operations of forward dynamics, of which a change is to be seen.
#[test]
fn forward_dynamics_costs_the_branches_alone() {
    let robot = Interpreted::new(TWO_ARMS).expect("valid");
    let function = robot.module.functions.iter().find(|function| function.name() == "forward_dynamics").expect("it has mass");
    assert!(function.steps.len() <= 694, "{} steps", function.steps.len());
}
