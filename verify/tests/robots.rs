//! Verifies every robot of the project in both scalars; a certificate lets anyone verify again.

use crate::common;

use std::path::Path;

use armgen_certify::{certify, verify};
use armgen_codegen::exact::Number;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_verify::certificate::Certificate;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::values::formula::Rational;
use armgen_verify::verify_with;
use dashu_int::UBig;

/// Prints each report with `--nocapture`.
fn check(options: &Options, of: impl Fn(&Path) -> bool) {
    for path in common::paths().into_iter().filter(|path| of(path)) {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let source = common::source(&name);
        let generated = common::generate_with(&source, options);
        let start = std::time::Instant::now();
        let report = certify(&source, &generated);
        println!("{:?}\n{report}\n", start.elapsed());
        assert!(report.passed(), "{name}: {}", report.first_fault().unwrap_or_default());
        for function in &report.functions {
            assert!(function.log2_odds < -100.0, "{name}: {}: odds 2^{}", function.name, function.log2_odds);
        }
    }
}

/// The robots that the documentation shows.
#[test]
fn robots_of_the_documentation_are_verified() {
    check(&Options::default(), |path| path.parent().is_some_and(|folder| folder.ends_with("../robots")));
}

#[test]
#[ignore = "wide"]
fn all_robots_are_verified_in_f64() {
    check(&Options::default(), |_| true);
}

#[test]
#[ignore = "wide"]
fn all_robots_are_verified_in_f32() {
    check(&Options { scalar: Scalar::F32, ..Options::default() }, |_| true);
}

#[test]
#[ignore = "wide"]
fn all_robots_are_verified_with_fast_sines() {
    check(&Options { trig: Trig::Fast, ..Options::default() }, |_| true);
}

#[test]
#[ignore = "wide"]
fn all_robots_are_verified_with_fused_operations() {
    check(&Options { fuse: true, ..Options::default() }, |_| true);
}

/// Covers all robots: the inverse kinematics is certified, or the module states why it is missing.
#[test]
#[ignore = "wide"]
fn the_inverse_kinematics_of_every_robot_is_certified_or_says_why_not() {
    let mut without = Vec::new();
    for path in common::paths() {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let source = common::source(&name);
        let text = common::generate(&source, Scalar::F64).inverse_kinematics();
        let report = armgen_certify::verify_inverse_kinematics(&source, &text, 8);
        println!("{report}\n");
        assert!(report.passed(), "{name}: {report}");
        if report.absent {
            assert!(text.contains("// There is no `inverse_kinematics`: "), "{text}");
            without.push(name);
        }
    }
    assert_eq!(without, ["counterbalance", "everything"]);
}

/// Two arms of a robot of the project on one base, the right one turned, with an end effector each.
fn two_of(robot: &str) -> Source {
    let text = common::source(robot).text().to_owned();
    let (head, joints) = text.split_once("\njoints:\n").expect("joints");
    let joints = joints.split("\nregressor:").next().expect("they come first");
    let last = format!("joint{}", joints.matches("  - name: joint").count());
    let places = [("left", "{xyz: [0, 0.3, 0.1]}"), ("right", "{xyz: [0.05, -0.3, 0.1], rpy: [0, 0.2, 0.7]}")];
    let mounted = |(arm, place): (&str, &str)| {
        let named = joints.replace("- name: joint", &format!("- name: {arm}_joint"));
        named.replacen("_joint1\n", &format!("_joint1\n    parent: base\n    mount: {place}\n"), 1)
    };
    let tip = |(arm, _): (&str, &str)| format!("  - {{name: {arm}, joint: {arm}_{last}, tool: {{xyz: [0, 0.01, 0.1]}}}}\n");
    Source::new("two.yaml", format!("{head}\njoints:\n{}tips:\n{}", places.map(mounted).concat(), places.map(tip).concat()))
}

/// A module of each end effector, in Rust and in C, is certified for that end effector and for no other.
#[test]
fn the_inverse_kinematics_of_each_end_effector_is_certified() {
    let source = two_of("ur5");
    let functions = Selection::named(["left_direct_kinematics"]).expect("a function");
    let generated = common::generate_with(&source, &Options { functions, ..Options::default() });
    let ends: Vec<_> = generated.solvers().map(|solver| (solver.infix(), solver.text(), solver.in_c().expect("C"))).collect();
    assert_eq!(ends.iter().map(|(infix, ..)| infix.as_str()).collect::<Vec<_>>(), ["_left", "_right"]);
    let verify = |text: &str| armgen_certify::verify_inverse_kinematics(&source, text, 2);
    for (_, rust, c) in &ends {
        for text in [rust, c] {
            let report = verify(text);
            assert!(report.passed() && report.sound == Some(8) && !report.absent, "{report}");
        }
    }
    let [(_, left, c), (_, right, _)] = ends.as_slice() else { panic!("two end effectors") };
    let line = "End effector: left. Entries of q: left_joint1, ";
    assert!(left.contains(line) && c.contains(line) && c.contains("void ur5_left_inverse_kinematics("));
    let exchanged = |text: &str| text.replace("left_joint", "right_joint").replace("effector: left", "effector: right");
    for (spoilt, fault) in [
        (exchanged(left), "LOOP: "),
        (left.replace("left_joint1, left_joint2", "left_joint2, left_joint1"), "where armgen writes"),
        (left.replace("End effector: left", "End effector: middle"), "the arm has no end effector `middle`"),
        (left.lines().filter(|text| !text.contains(line)).collect::<Vec<_>>().join("\n"), "does not name the end effector"),
        (right.replace("End effector: right", "End effector: left"), "LOOP: "),
    ] {
        let report = verify(&spoilt);
        assert!(report.faults.first().is_some_and(|found| found.contains(fault)), "{fault}: {report}");
    }
}

/// In `light` the torque limits are a thousand times the torques of the arm. In `lift` the rate of the shoulder, passed on by the following links,
/// cancels in the momentum of the prismatic joint along its axis.
#[test]
fn small_torques_beside_large_limits_and_rates_that_cancel_are_no_faults() {
    for (name, text) in [("light", include_str!("arms/light.yaml")), ("lift", include_str!("arms/lift.yaml"))] {
        let source = Source::new(format!("{name}.yaml"), text);
        let report = certify(&source, &common::generate(&source, Scalar::F64));
        assert!(report.passed(), "{name}: {}", report.first_fault().unwrap_or_default());
    }
}

#[test]
#[ignore = "wide"]
fn a_certificate_replaces_the_generator_and_belongs_to_its_texts() {
    // An inertia rotated by a general angle is a long formula.
    let attached = ("attached", Source::new("attached.yaml", include_str!("arms/attached.yaml")));
    let arms = ["scara", "everything", "base_set"].map(|name| (name, common::source(name)));
    for (name, source) in arms.into_iter().chain([attached]) {
        let generated = common::generate(&source, Scalar::F64);
        let certificate = Certificate::of(&certify(&source, &generated));
        let json = certificate.to_json();
        let read = Certificate::from_json(&json).expect("what was written");
        assert_eq!(read, certificate);
        let again = verify(&source, &generated.module, Some(&read));
        assert!(again.passed(), "{name}: {}", again.first_fault().unwrap_or_default());
        assert_eq!(Certificate::of(&again).to_json(), json, "the same texts give the same certificate");

        let edited = format!("{}\n", generated.module);
        let report = verify(&source, &edited, Some(&read));
        assert!(!report.passed() && report.faults.len() == 1, "{:?}", report.faults);
    }
}

#[test]
fn without_a_certificate_the_generator_is_asked_for_exact_values() {
    let source = common::source("scara");
    for scalar in [Scalar::F64, Scalar::F32] {
        let generated = common::generate(&source, scalar);
        assert!(verify(&source, &generated.module, None).passed());
    }
}

#[test]
fn fast_sines_in_f32_are_read() {
    for name in ["panda7", "scara", "modified_prismatic"] {
        let source = common::source(name);
        #[allow(clippy::needless_update)]
        let options = Options { scalar: Scalar::F32, trig: Trig::Fast, ..Options::default() };
        let generated = armgen_codegen::generate(&source, &options).0.expect("a valid description");
        assert!(generated.module.contains("fn sin_cos_one"));
        let report = certify(&source, &generated);
        assert!(report.passed(), "{name}: {}", report.first_fault().unwrap_or_default());
    }
}

#[test]
fn what_answers_for_the_sines_is_known_by_its_text_and_its_use_by_the_equations() {
    let source = common::source("panda7");
    #[allow(clippy::needless_update)]
    let options = Options { trig: Trig::Fast, ..Options::default() };
    let module = armgen_codegen::generate(&source, &options).0.expect("a valid description").module;
    let fault = |from: &str, to: &str| {
        let edited = module.replacen(from, to, 1);
        assert_ne!(edited, module);
        verify(&source, &edited, None).first_fault().unwrap_or_default()
    };
    for (from, to) in [
        ("0.166666", "0.166667"),
        ("sines[i], cosines[i]", "cosines[i], sines[i]"),
        ("SIN_COS_RANGE: f64 = 6", "SIN_COS_RANGE: f64 = 7"),
    ] {
        let fault = fault(from, to);
        assert!(fault.contains("where an emitted module has"), "{fault}");
    }
    let swapped = fault("let ([s1, s2,", "let ([s2, s1,");
    assert!(swapped.starts_with("direct_kinematics[0][0]: "), "{swapped}");
    let left_out = fault("        7,\n        q[0],", "        6,\n        q[0],");
    assert!(left_out.contains("is of none of the first 6 angles"), "{left_out}");
}

/// The author of a certificate may choose exact values of literals, but cannot introduce nested roots, whose sign would be free.
#[test]
fn a_nested_root_that_the_description_does_not_have_is_refused() {
    let source = common::source("scara");
    let generated = common::generate(&source, Scalar::F64);
    let claims = |text: &str| {
        let mut texts: Vec<(String, Vec<String>)> = Vec::new();
        for (name, numbers) in &generated.constants {
            let five = |number: String| if name == "inertia_matrix" && number == "5" { text.into() } else { number };
            texts.push((name.clone(), numbers.iter().map(|number| five(number.to_string())).collect()));
        }
        Claims::from_texts(texts.iter().map(|(name, list)| (name.as_str(), list.as_slice()))).expect("formulas")
    };
    let verdict = |text: &str| verify_with(&source, &generated.module, claims(text), Effort::default()).first_fault();
    assert_eq!(verdict("sqrt(5)*sqrt(5)"), None);
    let fault = verdict("5/2*sqrt(4 + pi - pi)").expect("not verified");
    assert!(fault.contains("which the description does not have"), "{fault}");
}

/// Without the exact values of its literals no function can be compared: the report names the constant, and not a function that differs.
#[test]
fn a_constant_that_the_checker_cannot_read_is_named() {
    let source = common::source("single_joint");
    let mut generated = common::generate(&source, Scalar::F64);
    assert!(certify(&source, &generated).passed());
    let long = Number::from(Rational::from(UBig::from(10u8).pow(300_000)));
    generated.constants.entry("gravity".into()).or_default().push(long);
    let report = certify(&source, &generated);
    assert!(!report.passed());
    let fault = report.first_fault().expect("not verified");
    assert!(fault.starts_with("the constants of the generator: `gravity`: a formula of 300001 characters"), "{fault}");
    assert!(report.functions.is_empty());
}

/// A description with nested roots, independent or not. The generator's field does not know their relations, and does not fold what would
/// require them.
#[test]
fn an_arm_with_nested_roots_is_verified() {
    let text = "name: roots\nconvention: standard\ngravity: [0, -9.81, 0]\njoints:\n  \
        - {name: j1, type: revolute, a: sqrt(1 + sqrt(2)), alpha: 0, d: 0, theta: 0, link: {mass: 1.5, com: [-0.3, 0.1, 0.2], inertia: {zz: 0.25, yy: 0.2, xx: 0.1}}}\n  \
        - {name: j2, type: revolute, a: sqrt(3 + sqrt(5)), alpha: pi/2, d: 0, theta: 0, link: {mass: 2.5, com: [-0.3, 0.1, 0.2], inertia: {zz: 0.25, yy: 0.2, xx: 0.1}}, \
        motor: {ratio: 50, inertia: 0.001, mass: 0.5, axis: [1, sqrt(2), 1]}}\n  \
        - {name: j3, type: revolute, a: sqrt(1 + sqrt(2)), alpha: 0.3, d: 0, theta: 0, link: {mass: 1.5, com: [-0.3, 0.1, 0.2]}}\n\
        tool: {xyz: [0.1, sqrt(1 + sqrt(2)), 0], rpy: [0.2, 0, 0]}\n\
        payload: {mass: 1, com: [0.1, 0, 0], inertia: {xx: 0.01, yy: 0.02, zz: 0.025}}\n";
    let source = Source::new("robot.yaml", text);
    let report = certify(&source, &common::generate(&source, Scalar::F64));
    assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
}

/// An arm without masses has no equations of motion: its module is verified without them, and an impossible function is refused.
#[test]
fn kinematics_alone_are_verified() {
    let text = include_str!("../../tests/data/kinematics_alone.yaml");
    let source = Source::new("kinematics_alone.yaml", text);
    for scalar in [Scalar::F64, Scalar::F32] {
        let generated = common::generate(&source, scalar);
        let report = certify(&source, &generated);
        assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
        assert_eq!(report.functions.len(), 5);
        let added = generated.module.replacen(
            "/// End-effector frame",
            "/// Torque.\n#[allow(dead_code, clippy::all)]\npub fn gravity(q: &[Real; DOF]) -> [Real; DOF] {\n    let _ = q;\n    [0.0, 0.0, 0.0]\n}\n\n/// End-effector frame",
            1,
        );
        assert_ne!(added, generated.module);
        let fault = verify(&source, &added, None).first_fault().expect("a fault");
        assert!(fault.contains("there is no equation to compare it with for this robot"), "{fault}");
        let without = generated.module.replacen("pub fn link_jacobians(", "pub fn link_frames(", 1);
        assert!(!verify(&source, &without, None).passed());
    }
}
