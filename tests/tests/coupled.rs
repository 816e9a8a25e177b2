//! Coupled joints: values of other programs, the checker in every language, base parameters, limits, and what is refused.

use armgen_codegen::derive::base;
use armgen_codegen::description::Convention;
use armgen_codegen::diagnostic::{Colour, Severity};
use armgen_codegen::emit::Language;
use armgen_codegen::exact::Number;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_codegen::show::{Form, Item, Reading, Sheet, Style};
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::{Generated, Model};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::robot::{Dynamics, Kinematics, LinkJacobians};
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::precision::{deviation, REFERENCE};
use armgen_verify::checker::Effort;
use armgen_verify::claims::Claims;
use armgen_verify::reader::ModuleText;
use armgen_verify::report::Report;
use armgen_verify::report::Verdict::Equal;
use armgen_verify::verify_with;
use serde_json::Value;

#[allow(unreachable_pub, clippy::all, clippy::pedantic)]
mod gripper {
    include!(concat!(env!("OUT_DIR"), "/gripper_arm.rs"));
    include!(concat!(env!("OUT_DIR"), "/gripper_arm_runtime.rs"));
}
use gripper::{Hand, LeftPad, COUPLING, DOF, JOINTS};

/// Five bars with both drives at the base (Siciliano et al., Sect. 7.3.3).
const PARALLELOGRAM: &str = include_str!("../data/trees/parallelogram.yaml");
/// A finger that mirrors another one, on a branch of its own.
const GRIPPER: &str = include_str!("../data/trees/gripper_arm.yaml");
/// The third coordinate is counted from the horizontal.
const LINKED: &str = include_str!("../data/trees/linked_3.yaml");
const ALL: [(&str, &str); 3] = [("parallelogram", PARALLELOGRAM), ("gripper_arm", GRIPPER), ("linked_3", LINKED)];

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[test]
fn coupled_arms_have_the_values_of_other_programs() {
    let all: Value = serde_json::from_str(include_str!("../data/trees/coupled.json")).expect("JSON");
    for (name, text) in ALL {
        let robot = Interpreted::new(text).unwrap_or_else(|fault| panic!("{fault}"));
        for state in all[name]["states"].as_array().expect("states") {
            let [q, dq, ddq, tau] = ["q", "dq", "ddq", "inverse_dynamics"].map(|key| numbers(&state[key]));
            let arguments = Arguments { q, dq, ddq: ddq.clone(), tau, ..Arguments::default() };
            let agrees = |function: &str, expected: &[f64]| {
                let off = deviation(&robot.call(function, &arguments), expected);
                assert!(off < REFERENCE, "{name}: {function}: {off:e}");
            };
            for function in [
                "joint_variables",
                "inertia_matrix",
                "coriolis_matrix",
                "gravity",
                "friction",
                "inverse_dynamics",
                "kinetic_energy",
            ] {
                agrees(function, &numbers(&state[function]));
            }
            agrees("forward_dynamics", &ddq);
            for (tip, own) in state["tips"].as_object().expect("end effectors") {
                for function in ["direct_kinematics", "geometric_jacobian", "geometric_jacobian_dot"] {
                    agrees(&format!("{tip}_{function}"), &numbers(&own[function]));
                }
            }
        }
    }
}

fn generated(text: &str) -> (Source, Generated) {
    let source = Source::new("robot.yaml", text);
    let (generated, faults) = armgen_codegen::generate(&source, &Options { trig: Trig::Fast, ..Options::default() });
    let generated = generated.unwrap_or_else(|| panic!("{}", faults.render(&source, Colour::Never)));
    (source, generated)
}

fn judged(source: &Source, generated: &Generated, language: Language, text: &str) -> Report {
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    verify_with(source, ModuleText { language, text }, claims, Effort { points: 2, exact_points: 1, seed: 1 })
}

#[test]
fn the_checker_proves_coupled_arms_in_every_language() {
    for text in [PARALLELOGRAM, GRIPPER] {
        let (source, generated) = generated(text);
        for language in Language::ALL {
            let report = judged(&source, &generated, language, &generated.in_language(language));
            assert!(report.passed(), "{}: {}", language.title(), report.first_fault().unwrap_or_default());
            assert!(report.functions.iter().any(|function| function.name == "joint_variables"), "{}", language.title());
        }
    }
    let (source, generated) = generated(LINKED);
    let report = judged(&source, &generated, Language::Rust, &generated.module);
    assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
}

/// A factor of the other sign, or a follower left out, is another robot: every function that it moves is refused.
#[test]
fn a_module_of_another_coupling_is_refused() {
    let (source, right) = generated(PARALLELOGRAM);
    for (of, by, wrong) in [
        ("follows: {crank: 1, lower: -1}", "follows: {crank: 1, lower: 1}", "inertia_matrix"),
        ("follows: {lower: 1, crank: -1}", "follows: {lower: 1}", "coriolis_matrix"),
    ] {
        let other = PARALLELOGRAM.replacen(of, by, 1);
        assert_ne!(other, PARALLELOGRAM);
        let (_, other) = generated(&other);
        let report = judged(&source, &other, Language::Rust, &other.module);
        assert!(!report.passed());
        let refused: Vec<&str> = report.functions.iter().filter(|f| f.verdict != Equal).map(|f| f.name.as_str()).collect();
        assert!(refused.contains(&wrong) && refused.contains(&"joint_variables"), "{refused:?}");
    }
    let swapped = right.module.replacen(
        "pub const COUPLING_OFFSET: [Real; JOINTS] = [0.0,",
        "pub const COUPLING_OFFSET: [Real; JOINTS] = [0.5,",
        1,
    );
    assert_ne!(swapped, right.module);
    let report = judged(&source, &right, Language::Rust, &swapped);
    assert!(report.first_fault().is_some_and(|fault| fault.contains("COUPLING_OFFSET")));
}

/// How many of the parameters of links a motion tells, without drives and friction (ranks in a field and singular values of two other programs).
#[test]
fn base_parameters_of_coupled_arms_are_counted_exactly() {
    for ((name, text), expected) in ALL.into_iter().zip([8, 10, 36]) {
        let lines = text.lines().filter(|line| !line.starts_with("    motor:") && !line.starts_with("    friction:"));
        let text = lines.map(|line| format!("{line}\n")).collect::<String>();
        let (arm, _) = validate::read(&Source::new("robot.yaml", text)).0.expect("valid");
        let model = Model::new(arm);
        let (vector, _) = base::base_combinations(&model.manipulator, &model.field);
        assert_eq!(vector.entries.len(), expected, "{name}");
    }
}

/// With base parameters at run time, and with gravity as an argument.
#[test]
fn the_checker_proves_regressors_of_coupled_arms() {
    for (of, by) in [("tips:", "regressor: base\ntips:"), ("gravity: [0, -9.81, 0]", "gravity: {argument: [0, -9.81, 0]}")] {
        for text in [PARALLELOGRAM, GRIPPER] {
            let text = text.replacen(of, by, 1);
            let (source, generated) = generated(&text);
            let report = judged(&source, &generated, Language::Rust, &generated.module);
            assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
        }
    }
}

/// b_12 is (m_forearm 0.5 0.2 - m_rod 0.2 0.25) cos(q1 - q2): with a rod of 12 kg B is constant and C is 0 (Siciliano et al., Sect. 7.3.3).
#[test]
fn a_parallelogram_has_the_closed_form_of_the_book() {
    let show = |text: &str, name: &str| {
        let (arm, _) = validate::read(&Source::new("robot.yaml", text)).0.expect("valid");
        let model = Model::new(arm);
        let items = Item::named(name, 4, &model.manipulator.tips);
        Sheet::in_style(&model, &items, Reading::Nominal, Style { form: Form::Shortest, digits: None }).text()
    };
    let text = show(PARALLELOGRAM, "inertia_matrix");
    assert!(text.contains("21/40*cos(q1 - q2)"), "{text}");
    let balanced = PARALLELOGRAM.replacen("mass: 1.5", "mass: 12", 1);
    assert_ne!(balanced, PARALLELOGRAM);
    assert!(!show(&balanced, "inertia_matrix").contains("cos"));
    let robot = Interpreted::new(&balanced).expect("valid");
    let c = robot.module.functions.iter().find(|function| function.name() == "coriolis_matrix").expect("it has mass");
    assert!(c.steps.is_empty(), "{:?}", c.steps);
    let arguments = Arguments { q: vec![0.3, 0.9], dq: vec![1.0, -2.0], ..Arguments::default() };
    assert_eq!(robot.call("coriolis_matrix", &arguments), [0.0; 4]);
}

/// The limits of a coordinate are the meet of its own and of those of joints that move with it alone.
#[test]
fn limits_of_followers_limit_their_leader() {
    let text = GRIPPER
        .replacen(
            "    axis: [0, 1, 0]\n",
            "    axis: [0, 1, 0]\n    limits: {position: [0, 0.04], velocity: 0.2, effort: 30}\n",
            1,
        )
        .replacen(
            "    follows: {finger: 1}\n",
            "    follows: {finger: -2}\n    offset: 0.05\n    limits: {position: [0, 0.05], velocity: 0.2}\n",
            1,
        );
    let robot = Interpreted::new(&text).unwrap_or_else(|fault| panic!("{fault}"));
    let finger = &robot.module.joints[2];
    let number = |value: &Option<Number>| value.as_ref().map(Number::to_f64);
    assert_eq!(finger.position.each_ref().map(number), [Some(0.0), Some(0.025)]);
    assert_eq!([number(&finger.velocity), number(&finger.effort)], [Some(0.1), Some(30.0)]);
    let coupling = robot.module.coupling.as_ref().expect("a follower");
    assert_eq!(coupling.offsets[3].to_f64(), 0.05);
    assert_eq!(coupling.factors[3].iter().map(Number::to_f64).collect::<Vec<_>>(), [0.0, 0.0, -2.0]);
    let arguments = Arguments { q: vec![0.1, 0.2, 0.01], ..Arguments::default() };
    let variables = robot.call("joint_variables", &arguments);
    assert!(deviation(&variables, &[0.1, 0.2, 0.01, 0.03]) < REFERENCE, "{variables:?}");
}

/// A line of joints that slide, each coupled to the one before it in this way.
fn line(joints: usize, coupling: impl Fn(usize) -> String) -> String {
    let mut text = String::from("name: line\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n");
    for i in 0..joints {
        text +=
            &format!("  - name: j{i}\n    type: prismatic\n    axis: [{}, 1, 1]\n    link: {{mass: 1}}\n{}", i % 3, coupling(i));
    }
    text
}

/// Rings, long lines, factors of many digits: an answer, and no panic.
#[test]
fn hostile_couplings_get_an_answer() {
    let codes = |text: &str| -> Vec<String> {
        let (_, diagnostics) = validate::read(&Source::new("robot.yaml", text));
        diagnostics.iter().filter(|d| d.code.severity() == Severity::Error).map(|d| d.code.name().to_owned()).collect()
    };
    let follows = |of: usize, factor: &str| format!("    follows: {{j{}: {factor}}}\n", of % 32);
    assert_eq!(codes(&line(32, |i| follows(i + 1, "1"))), ["ring-of-followers"]);
    assert_eq!(codes(&line(2, |i| if i == 1 { follows(1, "1") } else { String::new() })), ["ring-of-followers"]);
    let after = |factor: &'static str| line(32, move |i| if i == 0 { String::new() } else { follows(i - 1, factor) });
    assert_eq!(codes(&after("0.5")), [""; 0]);
    assert_eq!(codes(&after("-1")), [""; 0]);
    let digits = format!("0.{}", "123456789".repeat(2_000));
    let long = line(32, |i| if i == 0 { String::new() } else { follows(i - 1, &digits) });
    assert!(!codes(&long).is_empty());
    let roots = line(32, |i| if i == 0 { String::new() } else { follows(i - 1, "sqrt(2) + sqrt(3) + pi") });
    assert_eq!(codes(&roots), ["too-complex"]);
    let turning = after("2").replace("prismatic", "revolute");
    assert!(codes(&turning).iter().all(|code| code == "fractional-factor"), "{:?}", codes(&turning));
    assert!(codes(&after("1e300")).contains(&"too-complex".to_owned()));
}

/// Traits of the runtime have coordinates for joints: an element for each joint that has one.
#[test]
fn controllers_see_coordinates() {
    assert_eq!((DOF, JOINTS), (3, 4));
    assert_eq!(COUPLING[3], [0.0, 0.0, 1.0]);
    let q = SVector::from([0.3, -0.4, 0.02]);
    let all = gripper::link_frames(&[0.3, -0.4, 0.02]);
    let frames = Hand.link_frames(&q);
    assert_eq!(frames.len(), DOF);
    assert_eq!(frames[2][(1, 3)], all[2][1][3]);
    assert_eq!(Hand.link_jacobians(&q).len(), DOF);
    assert_eq!(gripper::joint_variables(&[0.3, -0.4, 0.02]), [0.3, -0.4, 0.02, 0.02]);
    // The pads move apart, and the hand does not move with them.
    assert_eq!(Hand.geometric_jacobian(&q).column(2).norm(), 0.0);
    assert!((LeftPad.geometric_jacobian(&q).column(2).norm() - 1.0).abs() < 1e-15);
    let torque = Dynamics::gravity(&LeftPad, &q);
    assert_eq!(torque, Dynamics::gravity(&Hand, &q));
}

/// Rows of every convention keep the coupling, and a URDF has it as `mimic` where it can.
#[test]
fn conversion_and_export_keep_couplings() {
    for (name, text) in ALL {
        let robot = Interpreted::new(text).expect("valid");
        let q: Vec<f64> = [0.3, -0.2, 0.5, 0.7, -0.4, 0.1][..robot.dof()].to_vec();
        let arguments = Arguments { dq: q.clone(), ddq: q.clone(), q, ..Arguments::default() };
        for to in [Convention::Standard, Convention::Modified] {
            let source = Source::new("robot.yaml", text);
            let (converted, faults) = armgen_import::convert(&source, to);
            let yaml = converted.unwrap_or_else(|| panic!("{}", faults.render(&source, Colour::Never))).yaml;
            let other = Interpreted::new(&yaml).unwrap_or_else(|faults| panic!("{faults}\n{yaml}"));
            for function in ["joint_variables", "inertia_matrix", "coriolis_matrix", "inverse_dynamics"] {
                let off = deviation(&other.call(function, &arguments), &robot.call(function, &arguments));
                assert!(off < REFERENCE, "{name} {to:?} {function}: {off:e}\n{yaml}");
            }
        }
    }
    let (exported, _) = armgen_import::export(&Source::new("robot.yaml", GRIPPER));
    let exported = exported.expect("valid");
    assert!(exported.urdf.contains("<mimic joint=\"finger\" multiplier=\"1\" offset=\"0\"/>"), "{}", exported.urdf);
    let (exported, _) = armgen_import::export(&Source::new("robot.yaml", PARALLELOGRAM));
    let lines = exported.expect("valid").lines;
    assert!(lines.iter().any(|line| line.contains("coupling of joints with several others")), "{lines:?}");
}
