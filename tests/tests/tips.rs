//! Several end effectors: values of other programs, the checker in every language, costs, payloads, and the interface of the runtime.

use std::collections::BTreeMap;

use armgen_codegen::emit::Language;
use armgen_codegen::program::{Cost, Trig};
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::Generated;
use armgen_runtime::control::PdGravity;
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::{JointReference, State};
use armgen_runtime::robot::{Dynamics, Kinematics, OperationalInertia};
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::precision::{deviation, REFERENCE};
use armgen_verify::certificate::report::{Report, Verdict};
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::ModuleText;
use armgen_verify::verify_with;
use serde_json::Value;

#[allow(unreachable_pub, clippy::all, clippy::pedantic)]
mod two_hands {
    include!(concat!(env!("OUT_DIR"), "/two_hands.rs"));
    include!(concat!(env!("OUT_DIR"), "/two_hands_runtime.rs"));
}
use two_hands::{LeftHand, LeftHandWithParameters, RightHand, RightHandMounted, DOF, NOMINAL_GRAVITY};

const TWO_ARMS: &str = include_str!("../data/trees/two_arms.yaml");
const INTERLEAVED: &str = include_str!("../data/trees/interleaved.yaml");
const OF_TWO_ARMS: &str = "tips:
  - {name: left_hand, joint: left_3, tool: {xyz: [0, 0, -0.25]}}
  - {name: right_hand, joint: right_3, tool: {xyz: [0, 0, -0.25], rpy: [0, 0, pi]}}
";
const OF_INTERLEAVED: &str = "tips:
  - {name: left, joint: left_3, tool: {xyz: [0.1, 0, 0]}}
  - {name: right, joint: right_3, tool: {xyz: [0.1, 0, 0]}}
";
/// Loads, tasks, a tip within a chain, and two on one link.
const MANY: &str = "tips:
  - {name: left_hand, joint: left_3, tool: {xyz: [0, 0, -0.25]}, payload: {mass: 0.5, com: [0, 0.02, -0.05]}, task: [x, y, z]}
  - {name: Camera, joint: torso, tool: {xyz: [0.1, 0, 0.5], rpy: [0, pi/2, 0]}, task: [rz]}
  - {name: right_hand, joint: right_3, tool: {xyz: [0, 0, -0.25], rpy: [0, 0, pi]}, payload: {mass: 2}, task: [z, x]}
  - {name: right_thumb, joint: right_3, tool: {xyz: [0.03, 0, -0.2]}, task: [x, y]}
";
/// The functions of an end effector.
const FUNCTIONS: [&str; 3] = ["direct_kinematics", "geometric_jacobian", "geometric_jacobian_dot"];

/// The robot with these end effectors instead of its own.
fn with_tips(robot: &str, tips: &str) -> String {
    let lines = robot.lines().filter(|line| !line.starts_with("tool:"));
    lines.map(|line| format!("{line}\n")).collect::<String>() + tips
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn arguments() -> Arguments {
    let q = vec![0.3, -0.2, 0.5, 0.7, -0.4, 0.1, 0.9];
    Arguments { dq: q.iter().map(|x| 1.0 - x).collect(), ddq: q.clone(), tau: q.clone(), q, ..Arguments::default() }
}

#[test]
fn end_effectors_have_the_values_of_other_programs() {
    let all: Value = serde_json::from_str(include_str!("../data/trees/tips.json")).expect("JSON");
    for (name, text) in [("two_arms", with_tips(TWO_ARMS, OF_TWO_ARMS)), ("interleaved", with_tips(INTERLEAVED, OF_INTERLEAVED))]
    {
        let robot = Interpreted::new(&text).expect("valid");
        for state in all[name].as_array().expect("states") {
            let arguments = Arguments { q: numbers(&state["q"]), dq: numbers(&state["dq"]), ..Arguments::default() };
            let tips = state["tips"].as_object().expect("end effectors");
            assert_eq!(tips.len(), 2);
            for (tip, function) in tips.keys().flat_map(|tip| FUNCTIONS.map(|function| (tip, function))) {
                let off = deviation(&robot.call(&format!("{tip}_{function}"), &arguments), &numbers(&tips[tip][function]));
                assert!(off < REFERENCE, "{name}: {tip}_{function}: {off:e}");
            }
        }
    }
}

fn generated(text: &str) -> (Source, Generated) {
    let source = Source::new("robot.yaml", text);
    let (generated, faults) = armgen_codegen::generate(&source, &Options { trig: Trig::Fast, ..Options::default() });
    let generated = generated.unwrap_or_else(|| panic!("{}", faults.render(&source, armgen_codegen::diagnostic::Colour::Never)));
    (source, generated)
}

fn judged(source: &Source, generated: &Generated, language: Language, text: &str) -> Report {
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    verify_with(source, ModuleText { language, text }, claims, Effort { points: 2, exact_points: 1, seed: 1 })
}

#[test]
fn the_checker_proves_the_functions_of_each_end_effector_in_every_language() {
    let (source, generated) = generated(&with_tips(TWO_ARMS, MANY));
    for language in Language::ALL {
        let report = judged(&source, &generated, language, &generated.in_language(language));
        assert!(report.passed(), "{}: {}", language.title(), report.first_fault().unwrap_or_default());
        let names: Vec<&str> = report.functions.iter().map(|function| function.name.as_str()).collect();
        for tip in ["left_hand", "camera", "right_hand", "right_thumb"] {
            for function in FUNCTIONS.into_iter().chain(["operational_inertia"]) {
                assert!(names.contains(&format!("{tip}_{function}").as_str()), "{}: {tip}_{function}", language.title());
            }
        }
    }
}

/// Base parameters carry the payloads; a regressor of standard parameters has ten columns for each.
#[test]
fn the_checker_proves_regressors_with_several_payloads() {
    for regressor in ["regressor: base\n", "gravity: {argument: [0, 0, -9.81]}\n"] {
        let text = with_tips(TWO_ARMS, MANY) + regressor;
        let text = if regressor.starts_with("gravity") { text.replacen("gravity: [0, 0, -9.81]\n", "", 1) } else { text };
        let (source, generated) = generated(&text);
        let report = judged(&source, &generated, Language::Rust, &generated.module);
        assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
    }
    let robot = Interpreted::new(&with_tips(TWO_ARMS, MANY)).expect("valid");
    let of_loads: Vec<String> = robot.parameter_names().into_iter().filter(|name| name.contains("hand")).collect();
    assert_eq!(of_loads.len(), 20);
    assert_eq!([&of_loads[0], &of_loads[19]], ["left_hand_mp", "right_hand_Izzp"]);
}

/// Each function of a module that is of another end effector than its name is refused, and so is a constant.
#[test]
fn two_end_effectors_exchanged_are_refused() {
    let (source, generated) = generated(&with_tips(TWO_ARMS, OF_TWO_ARMS));
    for language in Language::ALL {
        let text = generated.in_language(language);
        let exchange = |text: &str, [left, right]: [&str; 2]| text.replace(left, "@").replace(right, left).replace('@', right);
        // Names of functions in snake case and in camel case; the package of MATLAB has them in names of files, too.
        let names = match language {
            Language::JavaScript | Language::Matlab => ["leftHandDirectKinematics", "rightHandDirectKinematics"],
            _ => ["left_hand_direct_kinematics", "right_hand_direct_kinematics"],
        };
        let report = judged(&source, &generated, language, &exchange(&text, names));
        assert!(!report.passed(), "{}", language.title());
        if language == Language::Rust {
            let refused = report.functions.iter().filter(|function| function.verdict != Verdict::Equal);
            let refused: Vec<&str> = refused.map(|function| function.name.as_str()).collect();
            assert_eq!(refused, ["right_hand_direct_kinematics", "left_hand_direct_kinematics"]);
            let report =
                judged(&source, &generated, language, &exchange(&text, ["LEFT_HAND_COORDINATES", "RIGHT_HAND_COORDINATES"]));
            assert!(report.first_fault().is_some_and(|fault| fault.contains("COORDINATES")));
        }
    }
}

/// Columns beside the path are constant zeros, which `COORDINATES` names, and a function costs what it costs for the chain alone.
#[test]
fn functions_of_an_end_effector_cost_what_its_chain_costs() {
    let tree = Interpreted::new(&with_tips(TWO_ARMS, OF_TWO_ARMS)).expect("valid");
    let left = TWO_ARMS.split("  - name: right_1").next().expect("the beginning").to_owned() + "tool: {xyz: [0, 0, -0.25]}\n";
    let chain = Interpreted::new(&left).expect("valid");
    let cost = |robot: &Interpreted, name: &str| {
        let function = robot.module.functions.iter().find(|function| function.name() == name).expect("a function");
        Cost::of(function).weight()
    };
    for function in FUNCTIONS {
        assert_eq!(cost(&tree, &format!("left_hand_{function}")), cost(&chain, function), "{function}");
    }
    let jacobian = tree.call("left_hand_geometric_jacobian", &arguments());
    let moved: Vec<usize> = (0..7).filter(|j| (0..6).any(|row| jacobian[7 * row + j] != 0.0)).collect();
    assert_eq!(moved, tree.module.tips[0].coordinates);
    let shared = |robot: &Interpreted| -> BTreeMap<String, u64> {
        let own = robot.module.functions.iter().filter(|function| !function.name().contains("hand"));
        own.map(|function| (function.name(), Cost::of(function).weight() as u64)).collect()
    };
    // What is of the robot is that of the same tree with one end effector.
    let one =
        Interpreted::new(&format!("{}tip: left_3\ntool: {{xyz: [0, 0, -0.25]}}\n", with_tips(TWO_ARMS, ""))).expect("valid");
    let mut expected = shared(&one);
    for name in FUNCTIONS.into_iter().chain(["operational_inertia"]) {
        expected.remove(name);
    }
    let found = shared(&tree);
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (name, cost) in found {
        // The frame at the end of the other arm counts for where the joint frame of its last link lies.
        assert!(1000 * cost <= 1001 * expected[&name], "{name}: {cost}, {}", expected[&name]);
    }
}

/// A payload is a body on the link, wherever the description has it.
#[test]
fn payloads_of_end_effectors_are_bodies_of_their_links() {
    let one = with_tips(TWO_ARMS, MANY);
    let loaded = Interpreted::new(&one).expect("valid");
    let bodies =
        one.replacen(", payload: {mass: 0.5, com: [0, 0.02, -0.05]}", "", 1).replacen(", payload: {mass: 2}", "", 1).replacen(
            "yz: 0, zz: 0.002}}",
            "yz: 0, zz: 0.002}, attached: [{origin: {xyz: [0, 0, -0.25]}, mass: 0.5, com: [0, 0.02, -0.05]}]}",
            1,
        );
    let last = bodies.rfind("yz: 0, zz: 0.002}}").expect("the last link");
    let (before, behind) = bodies.split_at(last);
    let bodies = format!("{before}{}", behind.replacen("}}", "}, attached: [{origin: {xyz: [0, 0, -0.25]}, mass: 2}]}", 1));
    let attached = Interpreted::new(&bodies).unwrap_or_else(|fault| panic!("{fault}"));
    let arguments = arguments();
    for function in ["inertia_matrix", "gravity", "inverse_dynamics", "potential_energy", "left_hand_operational_inertia"] {
        let off = deviation(&loaded.call(function, &arguments), &attached.call(function, &arguments));
        assert!(off < REFERENCE, "{function}: {off:e}");
    }
}

/// The names of functions are full names everywhere.
#[test]
fn functions_are_chosen_by_their_full_names() {
    let text = with_tips(TWO_ARMS, OF_TWO_ARMS);
    let chosen = |names: &[&str]| {
        let functions = Selection::named(names).expect("names that a function can have");
        Interpreted::with_options(&text, &Options { functions, ..Options::default() }).expect("valid").module
    };
    let one = chosen(&["right_hand_direct_kinematics", "gravity"]);
    assert_eq!(one.functions.iter().map(|f| f.name()).collect::<Vec<_>>(), ["right_hand_direct_kinematics", "gravity"]);
    assert!(one.absent.is_empty());
    let reason = |name: &str| chosen(&[name]).absent[0].reason.clone();
    assert_eq!(
        reason("direct_kinematics"),
        "each end effector has its own, left_hand_direct_kinematics, right_hand_direct_kinematics"
    );
    assert_eq!(reason("LEFT_HAND_direct_kinematics"), "it is called left_hand_direct_kinematics");
    let capital = text.replace("left_hand", "Left_Hand");
    let functions = Selection::named(["Left_Hand_direct_kinematics"]).expect("a name that a function can have");
    let capital = Interpreted::with_options(&capital, &Options { functions, ..Options::default() }).expect("valid").module;
    assert_eq!(capital.absent[0].reason, "it is called left_hand_direct_kinematics");
    assert_eq!(reason("lefthand_direct_kinematics"), "the end effectors are left_hand, right_hand");
    assert!(Selection::named(["left_hand_gravity"]).is_err());
    let of_one = Interpreted::with_options(
        TWO_ARMS,
        &Options { functions: Selection::named(["left_direct_kinematics"]).expect("a possible name"), ..Options::default() },
    );
    assert!(of_one.expect("valid").module.absent[0].reason.contains("no name"));
}

/// Conversion and export keep the frames of all end effectors.
#[test]
fn conversion_keeps_end_effectors() {
    let text = with_tips(TWO_ARMS, MANY);
    let robot = Interpreted::new(&text).expect("valid");
    let arguments = arguments();
    for to in [armgen_codegen::description::Convention::Standard, armgen_codegen::description::Convention::Modified] {
        let (converted, _) = armgen_import::convert(&Source::new("robot.yaml", text.clone()), to);
        let other = Interpreted::new(&converted.expect("valid").yaml).unwrap_or_else(|fault| panic!("{fault}"));
        for tip in ["left_hand", "camera", "right_hand", "right_thumb"] {
            for function in FUNCTIONS {
                let name = format!("{tip}_{function}");
                let off = deviation(&other.call(&name, &arguments), &robot.call(&name, &arguments));
                assert!(off < REFERENCE, "{to:?} {name}: {off:e}");
            }
        }
        let off = deviation(&other.call("inverse_dynamics", &arguments), &robot.call("inverse_dynamics", &arguments));
        assert!(off < REFERENCE, "{to:?}: {off:e}");
    }
    let (exported, _) = armgen_import::export(&Source::new("robot.yaml", text));
    let urdf = exported.expect("valid").urdf;
    for (tip, link) in [("left_hand", "left_3_link"), ("Camera", "torso_link"), ("right_thumb", "right_3_link")] {
        let start = urdf.find(&format!("<joint name=\"{tip}_joint\"")).expect("a joint");
        let end = start + urdf[start..].find("</joint>").expect("its end");
        assert!(urdf[start..end].contains(&format!("<parent link=\"{link}\"/>")), "{}", &urdf[start..end]);
    }
}

/// A whole URDF comes in by its tips, or by every joint that moves.
#[test]
fn a_urdf_with_two_hands_comes_back_whole() {
    // A URDF has no motors.
    let lines = TWO_ARMS.lines().filter(|line| !line.starts_with("    motor:"));
    let text = with_tips(&lines.map(|line| format!("{line}\n")).collect::<String>(), OF_TWO_ARMS);
    let robot = Interpreted::new(&text).expect("valid");
    let (exported, _) = armgen_import::export(&Source::new("robot.yaml", text));
    let source = Source::new("robot.urdf", exported.expect("valid").urdf);
    let named = |name: &str, link: &str| (Some(name.to_owned()), link.to_owned());
    let tips = vec![(None, "left_hand".to_owned()), named("other", "right_hand")];
    let by_tips = armgen_import::Options { tips, ..armgen_import::Options::default() };
    let whole = armgen_import::Options { all: true, ..armgen_import::Options::default() };
    for (options, right) in [(by_tips, "other"), (whole, "right_hand")] {
        let (imported, faults) = armgen_import::import(&source, &options);
        let yaml =
            imported.unwrap_or_else(|| panic!("{}", faults.render(&source, armgen_codegen::diagnostic::Colour::Never))).yaml;
        let back = Interpreted::new(&yaml).unwrap_or_else(|fault| panic!("{fault}\n{yaml}"));
        assert_eq!(back.module.tips.len(), 2, "{yaml}");
        let arguments = arguments();
        for function in
            ["inertia_matrix", "coriolis_matrix", "gravity", "left_hand_direct_kinematics", "right_hand_geometric_jacobian"]
        {
            let own = function.replacen("right_hand", right, 1);
            let off = deviation(&back.call(&own, &arguments), &robot.call(function, &arguments));
            assert!(off < REFERENCE, "{own}: {off:e}\n{yaml}");
        }
    }
}

/// Each end effector has a type of its own, with its frame and the dynamics of the robot: any controller takes it.
#[test]
fn every_end_effector_is_a_robot_of_the_runtime() {
    fn held<R: Dynamics<DOF, Real = f64>>(robot: &R, q: SVector<f64, DOF>) -> SVector<f64, DOF> {
        let controller = PdGravity::new([100.0; DOF], [10.0; DOF]).expect("positive");
        let reference = JointReference { q, dq: SVector::zeros(), ddq: SVector::zeros() };
        controller.torque(robot, &reference, &State { q, dq: SVector::zeros() }).expect("finite").tau
    }
    let arguments = arguments();
    let q: SVector<f64, DOF> = SVector::from_column_slice(&arguments.q);
    let own: [f64; DOF] = q.into();
    let left = LeftHand.direct_kinematics(&q);
    assert_eq!(left[(0, 3)], two_hands::left_hand_direct_kinematics(&own)[0][3]);
    assert_eq!(RightHand.geometric_jacobian(&q)[(2, 5)], two_hands::right_hand_geometric_jacobian(&own)[2][5]);
    assert_ne!(left, RightHand.direct_kinematics(&q));
    let gravity = SVector::from(two_hands::gravity(&NOMINAL_GRAVITY, &own));
    assert_eq!(held(&LeftHand, q), gravity);
    assert_eq!(held(&RightHandMounted::default(), q), gravity);
    assert!((held(&LeftHandWithParameters::default(), q) - gravity).norm() < 1e-12);
    let (three, two) = (LeftHand.operational_inertia(&q), RightHand.operational_inertia(&q));
    assert_eq!((three.nrows(), two.nrows()), (3, 2));
}
