//! Arms with the numbers of real files, and arms on a rail or a mobile base: each module equals its equations.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_tests::exported_arms::{arm, Before};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::random::tricky;
use armgen_verify::checker::Effort;
use armgen_verify::claims::Claims;
use armgen_verify::verify_with;

/// Points in prime fields, each of its own prime.
const POINTS: usize = 2;

/// Why the module of a description is not right; `None` where it is.
fn fault(text: &str, scalar: Scalar) -> Option<String> {
    let source = Source::new("robot.yaml", text);
    let (generated, said) = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() });
    let Some(generated) = generated else { return Some(said.render(&source, Colour::Never)) };
    let claims = Claims::from_numbers(&generated.constants);
    let report = verify_with(&source, &generated.module, claims, Effort { points: POINTS, exact_points: 0, seed: 1 });
    (!report.passed()).then(|| report.first_fault().unwrap_or_default().to_string())
}

fn check(seeds: std::ops::Range<u64>, joints: (i64, i64), before: Before) {
    let mut faults = Vec::new();
    for seed in seeds {
        println!("seed {seed}, {before:?}");
        let text = arm(seed, joints, before);
        let scalar = if seed.is_multiple_of(3) { Scalar::F32 } else { Scalar::F64 };
        if let Some(fault) = fault(&text, scalar) {
            println!("{fault}\n{text}");
            faults.push(seed);
        }
    }
    assert!(faults.is_empty(), "{before:?}: the arms of seeds {faults:?} fail; each stands above");
}

#[test]
fn arms_with_numbers_of_real_files_equal_their_equations() {
    check(0..6, (2, 3), Before::Nothing);
    check(0..3, (2, 3), Before::Rail);
    check(0..3, (2, 2), Before::Mobile);
}

#[test]
#[ignore = "wide"]
fn many_arms_with_numbers_of_real_files_equal_their_equations() {
    check(100..140, (2, 6), Before::Nothing);
    check(100..120, (2, 6), Before::Rail);
    check(100..120, (2, 6), Before::Mobile);
}

/// The robots of the project.
fn robots() -> Vec<(&'static str, &'static str)> {
    let mut all = vec![
        ("scara", include_str!("../../robots/scara.yaml")),
        ("scara4", include_str!("../../robots/scara4.yaml")),
        ("puma560", include_str!("../../robots/puma560.yaml")),
        ("ur5", include_str!("../../robots/ur5.yaml")),
        ("panda7", include_str!("../../robots/panda7.yaml")),
    ];
    all.extend(tricky());
    all
}

/// The robot behind a slide along z (1), or behind slides along z and y and a turn about z (3), in the convention of its file.
fn carried(text: &str, joints: usize) -> String {
    let of = |convention: &str| text.contains(&format!("convention: {convention}"));
    let rows: [String; 3] = if of("urdf") {
        [("prismatic", "[0, 0, 1]"), ("prismatic", "[0, 1, 0]"), ("revolute", "[0, 0, 1]")]
            .map(|(kind, axis)| format!("type: {kind}, axis: {axis}"))
    } else {
        // The twist stands in the row before or in that of the joint itself.
        let twists = if of("standard") { ["-pi/2", "pi/2", "0"] } else { ["0", "-pi/2", "pi/2"] };
        let twists = if joints == 1 { ["0"; 3] } else { twists };
        let kinds = ["prismatic", "prismatic", "revolute"];
        [0, 1, 2].map(|i| format!("type: {}, a: 0, alpha: {}, d: 0, theta: 0", kinds[i], twists[i]))
    };
    let mut slides = String::from("joints:\n");
    for (i, row) in rows.iter().take(joints).enumerate() {
        slides += &format!("  - {{name: carrier_{i}, {row}, link: {{mass: 30, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n");
    }
    text.replacen("joints:\n", &slides, 1)
}

/// No entry of these depends on where the slides are.
const WITHOUT_SLIDES: [&str; 8] = [
    "geometric_jacobian",
    "geometric_jacobian_dot",
    "link_jacobians",
    "inertia_matrix",
    "coriolis_matrix",
    "gravity",
    "operational_inertia",
    "momentum",
];

fn check_carried(name: &str, text: &str, joints: usize) {
    println!("{name} behind {joints} joints");
    let text = carried(text, joints);
    let robot =
        Interpreted::with_options(&text, &Options::default()).unwrap_or_else(|faults| panic!("{name}:\n{faults}\n{text}"));
    let slides = joints.min(2) as u16;
    for function in robot.module.functions.iter().filter(|function| WITHOUT_SLIDES.contains(&function.quantity.name)) {
        let taken = function
            .symbols()
            .into_iter()
            .find(|symbol| matches!(symbol, armgen_codegen::ring::Symbol::Position(i) if *i < slides));
        assert_eq!(taken, None, "{name} behind {joints} joints: {} takes a slide", function.name());
    }
    if let Some(fault) = fault(&text, Scalar::F64) {
        panic!("{name} behind {joints} joints: {fault}\n{text}");
    }
}

#[test]
fn the_slides_that_carry_an_arm_enter_no_function_that_does_not_depend_on_them() {
    for (name, text) in robots().into_iter().filter(|(name, _)| ["scara", "single_joint"].contains(name)) {
        for joints in [1, 3] {
            check_carried(name, text, joints);
        }
    }
}

#[test]
#[ignore = "wide"]
fn the_slides_that_carry_any_robot_enter_no_function_that_does_not_depend_on_them() {
    for (name, text) in robots() {
        for joints in [1, 3] {
            check_carried(name, text, joints);
        }
    }
}
