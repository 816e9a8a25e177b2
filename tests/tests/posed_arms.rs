//! Arms of poses: rows with origin and axis, tensors in turned axes, attached bodies, armatures, a base. Each equals its equations exactly, by
//! the checker's own reading of them, and agrees with the oracle, whose reading is another one.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_tests::interpreter::Interpreted;
use armgen_tests::judge::{judge, Tolerance};
use armgen_tests::oracle::Description;
use armgen_tests::precision::{FORWARD_RESIDUAL, ORACLE};
use armgen_tests::random;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::verify_with;

/// How many arms, from seed 0 on; another number, or seeds such as 200..500, with `ARMGEN_RANDOM_ARMS`.
const ARMS: u64 = 24;

/// Seeds that exposed faults. In 96 the acceleration of the slide cancels in the torque of the first joint. In 116 accelerations
/// at a rational point have very many bits. In 187 a rate cancels in a column of a base parameter. 292 divides by the negative of
/// a pivot. In 360 an offset of friction, an armature and the weight on a slide are constant torques, which the base parameters
/// of gravity and friction share out.
const SINGULAR: [u64; 5] = [96, 116, 187, 292, 360];

fn arms() -> impl Iterator<Item = u64> {
    let seeds = std::env::var("ARMGEN_RANDOM_ARMS").map_or(0..ARMS, |text| {
        let (from, to) = text.split_once("..").unwrap_or(("0", &text));
        let number = |text: &str| text.parse().expect("ARMGEN_RANDOM_ARMS is a number, or two with `..` between them");
        number(from)..number(to)
    });
    seeds.clone().chain(SINGULAR.into_iter().filter(move |seed| !seeds.contains(seed)))
}

#[test]
#[ignore = "wide"]
fn arms_of_poses_agree_with_the_oracle() {
    for seed in arms() {
        let text = random::posed_arm(seed);
        let robot = Interpreted::with_options(&text, &Options::default()).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
        judge(
            &format!("posed arm {seed}\n{text}"),
            &robot,
            &text,
            seed,
            Tolerance { values: ORACLE, residual: FORWARD_RESIDUAL },
        );
    }
}

#[test]
#[ignore = "wide"]
fn arms_of_poses_equal_their_equations_exactly() {
    for seed in arms() {
        let text = random::posed_arm(seed);
        let source = Source::new("robot.yaml", text.clone());
        let (generated, said) = armgen_codegen::generate(&source, &Options::default());
        let generated = generated.unwrap_or_else(|| panic!("{}\n{text}", said.render(&source, Colour::Never)));
        let effort = Effort { points: 2, exact_points: 1, seed };
        let report =
            verify_with(&source, &generated.module, Claims::from_numbers(&generated.constants).expect("short formulas"), effort);
        assert!(report.passed(), "seed {seed}: {}\n{text}", report.first_fault().unwrap_or_default());
    }
}

#[test]
fn every_part_of_the_format_occurs() {
    let all: String = arms().map(random::posed_arm).collect();
    for part in [
        "urdf",
        "standard",
        "modified",
        "base:",
        "origin: [",
        "rpy",
        "quat",
        "angle",
        "xyaxes",
        "attached",
        "armature",
        "offset:",
        "cubic:",
        "stribeck:",
        "load:",
        "spring:",
        "rest:",
        "payload",
    ] {
        assert!(all.contains(part), "{part} never occurs");
    }
}

const ONE_BODY: &str = "
name: one
convention: urdf
gravity: [0, 0, -9.81]
joints:
  - {name: a, type: revolute, axis: [0, 0, 1], link: LINK}
";

/// The ten standard parameters of the link, exactly, as formulas.
fn ten(link: &str) -> Vec<String> {
    let source = Source::new("robot.yaml", ONE_BODY.replace("LINK", link));
    let (arm, said) = armgen_codegen::validate::read(&source);
    let (manipulator, _) = arm.unwrap_or_else(|| panic!("{}", said.render(&source, Colour::Never)));
    armgen_codegen::Model::new(manipulator).parameters.entries.iter().take(10).map(|entry| entry.nominal.to_string()).collect()
}

/// I = R I R' with the axes turned about z by 30 degrees, and a turn by a right angle that exchanges two moments.
#[test]
fn a_turned_tensor_is_the_tensor_in_the_axes_of_the_link() {
    let moments = |link: &str| ten(link)[4..].to_vec();
    assert_eq!(
        moments("{mass: 1, inertia: {xx: 3, yy: 4, zz: 5, rpy: [0, 0, pi/6]}}"),
        moments("{mass: 1, inertia: {xx: 3.25, xy: -sqrt(3)/4, yy: 3.75, zz: 5}}")
    );
    assert_eq!(
        moments("{mass: 1, inertia: {xx: 3, yy: 4, zz: 5, quat: [1, 1, 0, 0]}}"),
        moments("{mass: 1, inertia: {xx: 3, yy: 5, zz: 4}}")
    );
}

/// A link that is cut in two, the second half with a frame of its own, is the link.
#[test]
fn attached_bodies_lump_to_the_whole() {
    let halves = "{mass: 2, com: [1, 0, 0], inertia: {zz: 1}, attached: [{origin: {xyz: [4, 0, 0], rpy: [0, 0, pi]}, mass: 2, com: [1, 0, 0], inertia: {zz: 1}}]}";
    // Two masses of 2 at 1 and 3: 4 at 2, with 1 + 1 + 2 (1² + 1²) = 6 about it; along y the same without the 1 + 1.
    let whole = "{mass: 4, com: [2, 0, 0], inertia: {yy: 4, zz: 6}}";
    assert_eq!(ten(halves), ten(whole));
}

/// The oracle reads the format by itself; the fields that only this format has are not ignored there.
#[test]
fn the_oracle_sees_each_part_of_the_format() {
    let text = "name: a\nconvention: urdf\ngravity: [0, 0, -9.81]\nbase: {rpy: [0, 0.3, 0]}\njoints:\n  - {name: a, type: revolute, origin: {xyz: [0, 0.2, 0]}, axis: [0, 1, 0], armature: 0.5, friction: {viscous: 0.3, offset: 0.2, cubic: 0.1}, spring: {stiffness: 30, rest: 0.7}, link: {mass: 2, com: [0.1, 0, 0.3], inertia: {xx: 1, yy: 2, zz: 2, rpy: [0, 0, 1]}, attached: [{origin: {xyz: [0, 0, 1]}, mass: 3}]}}\n  - {name: b, type: revolute, axis: [0, 0, 1], link: {mass: 2, com: [0.1, 0, 0.3], inertia: {xx: 1, yy: 2, zz: 2}}}\n";
    let torque = |text: &str| {
        let model = Description::read(text).and_then(|d| d.model()).expect("it is valid");
        model.inverse_dynamics(&[0.4, 0.3], &[1.0, 2.0], &[1.0, -1.0])
    };
    let whole = torque(text);
    for (part, without) in [
        ("base: {rpy: [0, 0.3, 0]}\n", ""),
        ("armature: 0.5, ", ""),
        (", offset: 0.2", ""),
        (", cubic: 0.1", ""),
        (", rest: 0.7", ""),
        ("spring: {stiffness: 30, rest: 0.7}, ", ""),
        ("axis: [0, 1, 0]", "axis: [0, 1, 0.1]"),
        (", rpy: [0, 0, 1]", ""),
        ("origin: {xyz: [0, 0, 1]}, mass: 3", "mass: 3"),
    ] {
        assert!(text.contains(part));
        assert_ne!(torque(&text.replace(part, without)), whole, "{part}");
    }
}
