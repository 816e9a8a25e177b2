//! Motors that ride on any link and spin with several joints: values of other programs, the same rotors as bodies on joints of their own, the
//! checker in every language, base parameters, and what is refused.

use armgen_codegen::derive::base;
use armgen_codegen::description::Convention;
use armgen_codegen::diagnostic::Colour;
use armgen_codegen::emit::Language;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::Model;
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::precision::{deviation, REFERENCE};
use armgen_tests::random::Random;
use armgen_verify::certificate::report::Verdict::Equal;
use serde_json::Value;

use crate::coupled::{generated, judged};

/// The drives of a wrist ride on the forearm, and spin with the joints before theirs.
const WRIST: &str = include_str!("../data/trees/coupled_wrist.yaml");

/// A wrist of three joints, whose drives are those of `FEW`.
const SMALL: &str = "
name: small
convention: urdf
gravity: [0.5, -1, -9.81]
joints:
  - {name: forearm, type: revolute, axis: [0, 1, 0], link: {mass: 8, com: [0.2, 0, 0.03], inertia: {xx: 0.05, yy: 0.3, zz: 0.3}}}
  - {name: roll, type: revolute, origin: {xyz: [0.4, 0, 0]}, axis: [1, 0, 0], link: {mass: 2, com: [0.05, 0.01, 0], inertia: {xx: 0.01, yy: 0.02, zz: 0.02}}}
  - {name: pitch, type: revolute, origin: {xyz: [0.1, 0, 0]}, axis: [0, 1, 0], link: {mass: 1, com: [0.04, 0, 0.02], inertia: {xx: 0.002, yy: 0.003, zz: 0.003}}}
";
/// As `ROTORS`, of [`SMALL`].
const FEW: [Rotor; 2] = [
    (
        "roll",
        "ratio: 9, inertia: 5e-4, on: base, axis: [0, 0, 1], coupling: {forearm: 2}, viscous: 1e-4",
        "base: {roll: 9, forearm: 2}",
    ),
    (
        "pitch",
        "ratio: 8, inertia: 4e-4, on: forearm, axis: [1, 0, 0], coupling: {roll: -1}, mass: 0.4, position: [0.1, 0, 0.05]",
        "forearm: {pitch: 8, roll: -1}",
    ),
];

/// What an arm with both keys has: branches, a follower, a slide, a rotor on another branch, on the base, on the last link, and one that is
/// coupled with a follower. Ratios are whole numbers, so that a joint can follow as the rotor spins.
const DRIVES: &str = "
name: drives
convention: urdf
gravity: [0.5, -1, -9.81]
joints:
  - {name: torso, type: revolute, axis: [0, 0, 1], link: {mass: 8, com: [0.05, 0.02, 0.2], inertia: {xx: 0.2, yy: 0.3, zz: 0.25, xy: 0.01, xz: 0.02, yz: 0.03}}}
  - {name: left, type: revolute, origin: {xyz: [0, 0.2, 0.4]}, axis: [0, 1, 0], link: {mass: 3, com: [0.1, 0.03, -0.1], inertia: {xx: 0.03, yy: 0.04, zz: 0.02, xy: 0.001}}, friction: {viscous: 0.3}}
  - {name: elbow, type: revolute, origin: {xyz: [0.3, 0.1, 0]}, axis: [0, 1, 0], link: {mass: 2, com: [0.1, -0.02, 0.05], inertia: {xx: 0.02, yy: 0.03, zz: 0.02}}}
  - {name: hand, type: revolute, origin: {xyz: [0.25, 0, 0.1]}, axis: [1, 0, 1], link: {mass: 1, com: [0.05, 0.01, 0.02], inertia: {xx: 0.004, yy: 0.003, zz: 0.002}}}
  - {name: right, type: revolute, parent: torso, origin: {xyz: [0, -0.2, 0.4], rpy: [0.3, 0, 0]}, axis: [0, 1, 0], link: {mass: 3, com: [0.1, -0.03, -0.1], inertia: {xx: 0.03, yy: 0.04, zz: 0.02}}}
  - {name: slide, type: prismatic, parent: right, axis: [1, 0, 0], link: {mass: 1, com: [0.1, 0.02, 0], inertia: {xx: 0.003, yy: 0.004, zz: 0.002}}}
  - {name: mirror, type: revolute, parent: slide, origin: {xyz: [0.1, 0, 0]}, axis: [0, 0, 1], follows: {elbow: -1, left: 1}, offset: 0.2, link: {mass: 0.7, com: [0.04, 0.02, 0], inertia: {xx: 0.002, yy: 0.003, zz: 0.002}}}
tips:
  - {name: one, joint: hand, tool: {xyz: [0.1, 0, 0]}, payload: {mass: 0.5}}
  - {name: two, joint: slide}
";
/// A joint, the words of its motor, and the carrier and the leaders of the joint that its rotor would have as a body.
type Rotor = (&'static str, &'static str, &'static str);
const ROTORS: [Rotor; 5] = [
    ("torso", "ratio: 7, inertia: 0.002, on: hand, axis: [1, 0, 0], coupling: {left: -2}", "hand: {torso: 7, left: -2}"),
    ("left", "ratio: -5, inertia: 0.003, viscous: 0.01, mass: 0.3, position: [0.1, 0, 0.2], on: right, axis: [0, 0, 1], coupling: {hand: 3, torso: 1}", "right: {left: -5, hand: 3, torso: 1}"),
    ("elbow", "ratio: 6, inertia: 0.004, on: base, axis: [1, 0, 0], coupling: {right: 2}, viscous: 0.02", "base: {elbow: 6, right: 2}"),
    ("hand", "ratio: 4, inertia: 0.001, on: elbow, axis: [0, 0, 1], coupling: {mirror: 3}, viscous: 0.03", "elbow: {hand: 4, mirror: 3}"),
    ("right", "ratio: 9, inertia: 0.005, on: mirror, axis: [0, 1, 0]", "mirror: {right: 9}"),
];

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[test]
fn a_coupled_wrist_has_the_values_of_other_programs() {
    let all: Value = serde_json::from_str(include_str!("../data/trees/coupled.json")).expect("JSON");
    let robot = Interpreted::new(WRIST).unwrap_or_else(|fault| panic!("{fault}"));
    for state in all["coupled_wrist"]["states"].as_array().expect("states") {
        let [q, dq, ddq, tau] = ["q", "dq", "ddq", "inverse_dynamics"].map(|key| numbers(&state[key]));
        let arguments = Arguments { q, dq, ddq: ddq.clone(), tau, ..Arguments::default() };
        for function in ["inertia_matrix", "coriolis_matrix", "gravity", "friction", "inverse_dynamics", "kinetic_energy"] {
            let off = deviation(&robot.call(function, &arguments), &numbers(&state[function]));
            assert!(off < REFERENCE, "{function}: {off:e}");
        }
        let off = deviation(&robot.call("forward_dynamics", &arguments), &ddq);
        assert!(off < REFERENCE, "forward_dynamics: {off:e}");
    }
}

/// An arm with motors, or with their rotors as bodies on joints that follow others as these turn.
fn driven(arm: &str, rotors: &[Rotor], as_bodies: bool) -> String {
    let (mut text, mut bodies) = (String::new(), String::new());
    if as_bodies {
        bodies = rotors.iter().map(body).collect();
    }
    for line in arm.trim_start().lines() {
        let motor = rotors.iter().find(|(joint, ..)| line.starts_with(&format!("  - {{name: {joint},")));
        match (motor, line.strip_suffix('}')) {
            (Some((_, words, _)), Some(row)) if !as_bodies => text += &format!("{row}, motor: {{{words}}}}}\n"),
            _ => {
                if line == "tips:" {
                    text += &std::mem::take(&mut bodies);
                }
                text += &format!("{line}\n");
            }
        }
    }
    if bodies.is_empty() {
        return text;
    }
    // Without `tips` the end effector stays on the last joint before the bodies.
    let last = arm.lines().rev().find_map(|line| line.strip_prefix("  - {name: ")).and_then(|row| row.split_once(','));
    format!("{text}{bodies}tip: {}\n", last.expect("a joint").0)
}

fn small() -> String {
    driven(SMALL, &FEW, false)
}

/// The joint of a rotor's body: a mass on the spin axis, and inertia about that axis alone.
fn body(&(joint, words, leaders): &Rotor) -> String {
    let word = |key: &str| -> Option<&str> {
        let behind = words.split_once(&format!("{key}: "))?.1;
        Some(behind.split_once(if behind.starts_with('[') { "]" } else { "," }).map_or(behind, |(value, _)| value))
    };
    let moment = ["[1, 0, 0", "[0, 1, 0", "[0, 0, 1"].iter().position(|axis| word("axis") == Some(axis)).expect("an axis");
    let (parent, leaders) = leaders.split_once(": ").expect("a carrier");
    let place = word("position").map_or(String::new(), |place| format!(", origin: {{xyz: {place}]}}"));
    let friction = word("viscous").map_or(String::new(), |viscous| format!(", friction: {{viscous: {viscous}}}"));
    format!(
        "  - {{name: rotor_of_{joint}, type: revolute, parent: {parent}{place}, axis: {}], follows: {leaders}, link: {{mass: {}, inertia: {{{}: {}}}}}{friction}}}\n",
        word("axis").expect("an axis"),
        word("mass").unwrap_or("0"),
        ["xx", "yy", "zz"][moment],
        word("inertia").expect("an inertia")
    )
}

/// A rotor is a body on a joint of its own that follows others, since its inertia is the same in every posture of that joint. The equations of
/// such bodies come from recursions alone.
#[test]
fn rotors_move_as_bodies_on_joints_that_follow() {
    rotors_move_as_bodies(SMALL, &FEW);
}

#[test]
#[ignore = "wide"]
fn rotors_on_branches_move_as_bodies_on_joints_that_follow() {
    rotors_move_as_bodies(DRIVES, &ROTORS);
}

fn rotors_move_as_bodies(arm: &str, rotors: &[Rotor]) {
    let [motors, bodies] = [false, true].map(|as_bodies| {
        let text = driven(arm, rotors, as_bodies);
        Interpreted::new(&text).unwrap_or_else(|fault| panic!("{fault}\n{text}"))
    });
    let n = motors.dof();
    assert_eq!(n, bodies.dof());
    let mut random = Random::new(7);
    let mut vector = || (0..n).map(|_| random.real(-2.0, 2.0)).collect::<Vec<f64>>();
    let arguments = Arguments { q: vector(), dq: vector(), ddq: vector(), tau: vector(), ..Arguments::default() };
    for function in [
        "inertia_matrix",
        "coriolis_matrix",
        "gravity",
        "friction",
        "inverse_dynamics",
        "forward_dynamics",
        "kinetic_energy",
        "potential_energy",
        "momentum",
        "coriolis_transpose_times",
        "center_of_mass",
        "inverse_dynamics_derivatives",
        "forward_dynamics_derivatives",
        "equations_of_motion",
    ] {
        let [found, expected] = [&motors, &bodies].map(|robot| robot.call(function, &arguments));
        let off = deviation(&found, &expected);
        assert!(off < REFERENCE, "{function}: {off:e}");
    }
}

#[test]
fn the_checker_proves_coupled_motors_in_every_language() {
    let (source, generated) = generated(&small());
    for language in Language::ALL {
        let text = generated.in_language(language);
        assert!(text.contains("MOTOR_RATES") || text.contains("motorRates"), "{}", language.title());
        let report = judged(&source, &generated, language, &text);
        assert!(report.passed(), "{}: {}", language.title(), report.first_fault().unwrap_or_default());
    }
}

#[test]
#[ignore = "wide"]
fn the_checker_proves_coupled_motors_of_whole_arms() {
    for text in [WRIST.to_owned(), driven(DRIVES, &ROTORS, false)] {
        let (source, generated) = generated(&text);
        for language in [Language::Rust, Language::C] {
            let report = judged(&source, &generated, language, &generated.in_language(language));
            assert!(report.passed(), "{}: {}", language.title(), report.first_fault().unwrap_or_default());
        }
    }
}

/// With base parameters at run time.
#[test]
#[ignore = "wide"]
fn the_checker_proves_base_parameters_beside_coupled_motors() {
    let (source, generated) = generated(&WRIST.replacen("tips:", "regressor: base\ntips:", 1));
    let report = judged(&source, &generated, Language::Rust, &generated.module);
    assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
}

/// A rotor on another link, a factor of the other sign or left out, an axis turned: each is another robot.
#[test]
fn a_module_of_other_motors_is_refused() {
    let text = small();
    let (source, right) = generated(&text);
    for (of, by, wrong) in [
        ("coupling: {roll: -1}", "coupling: {roll: 1}", "inertia_matrix"),
        ("on: forearm, axis: [1, 0, 0], coupling: {roll: -1}", "on: forearm, axis: [1, 0, 0]", "momentum"),
        ("on: base, axis: [0, 0, 1], coupling: {forearm: 2}", "on: base, axis: [0, 0, 1]", "friction"),
        ("inertia: 4e-4, on: forearm", "inertia: 4e-4, on: roll", "coriolis_matrix"),
        ("on: forearm, axis: [1, 0, 0]", "on: forearm, axis: [0, 1, 0]", "inverse_dynamics"),
    ] {
        let other = text.replacen(of, by, 1);
        assert_ne!(other, text);
        let (_, other) = generated(&other);
        let report = judged(&source, &other, Language::Rust, &other.module);
        let refused: Vec<&str> = report.functions.iter().filter(|f| f.verdict != Equal).map(|f| f.name.as_str()).collect();
        assert!(!report.passed() && refused.contains(&wrong), "{of}: {refused:?}");
    }
    let swapped = right.module.replacen("[0.0, -1.0, 8.0]", "[0.0, 1.0, 8.0]", 1);
    assert_ne!(swapped, right.module);
    let report = judged(&source, &right, Language::Rust, &swapped);
    assert!(report.first_fault().is_some_and(|fault| fault.contains("MOTOR_RATES")));
}

/// Motors hide no parameter of a link (the rank by singular values of Pinocchio's regressor).
#[test]
fn base_parameters_beside_coupled_motors_are_counted_exactly() {
    let (arm, _) = validate::read(&Source::new("robot.yaml", WRIST)).0.expect("valid");
    let model = Model::new(arm);
    let (vector, _) = base::base_combinations(&model.manipulator, &model.field).expect("short combinations");
    let of_links = vector.entries.iter().filter(|entry| !["Im", "Fm"].iter().any(|of| entry.name.starts_with(of)));
    assert_eq!(of_links.count(), 36, "{:?}", vector.entries.iter().map(|entry| &entry.name).collect::<Vec<_>>());
}

/// Rows of every convention keep the motors. A URDF has none, and its note names those whose friction it lacks.
#[test]
fn conversion_keeps_coupled_motors_and_export_names_them() {
    conversion_keeps(&small());
    let (exported, _) = armgen_import::export(&Source::new("robot.yaml", WRIST));
    let lines = exported.expect("valid").lines;
    assert!(lines.iter().any(|line| line.contains("several joints") && line.ends_with("`J5`, `J6`")), "{lines:?}");
}

#[test]
#[ignore = "wide"]
fn conversion_keeps_coupled_motors_of_whole_arms() {
    [WRIST.to_owned(), driven(DRIVES, &ROTORS, false)].iter().for_each(|text| conversion_keeps(text));
}

#[track_caller]
fn conversion_keeps(text: &str) {
    let robot = Interpreted::new(text).expect("valid");
    let q: Vec<f64> = [0.3, -0.2, 0.5, 0.7, -0.4, 0.1][..robot.dof()].to_vec();
    let arguments = Arguments { dq: q.clone(), ddq: q.clone(), q, ..Arguments::default() };
    for to in [Convention::Standard, Convention::Modified] {
        let source = Source::new("robot.yaml", text);
        let (converted, faults) = armgen_import::convert(&source, to);
        let yaml = converted.unwrap_or_else(|| panic!("{}", faults.render(&source, Colour::Never))).yaml;
        let other = Interpreted::new(&yaml).unwrap_or_else(|faults| panic!("{faults}\n{yaml}"));
        for function in ["inertia_matrix", "coriolis_matrix", "friction", "inverse_dynamics"] {
            let off = deviation(&other.call(function, &arguments), &robot.call(function, &arguments));
            assert!(off < REFERENCE, "{to:?} {function}: {off:e}\n{yaml}");
        }
    }
}
