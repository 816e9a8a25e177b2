//! What equals the equations over the real numbers and is useless in floats is refused.

use crate::common;

use armgen_certify::{certify, verify};
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::Module;

/// What is wrong first with a module of the SCARA that has another text in it, from a place on.
fn fault(scalar: Scalar, from: &str, old: &str, new: &str) -> String {
    let source = common::source("scara");
    let module = common::generate(&source, scalar).module;
    let at = module.find(from).unwrap_or_else(|| panic!("{from} is not in the module"));
    assert!(module[at..].contains(old), "{old} is not in the module after {from}");
    let edited = module[..at].to_string() + &module[at..].replacen(old, new, 1);
    verify(&source, &edited, None).first_fault().unwrap_or_else(|| panic!("accepted: {new}"))
}

const B: &str = "pub fn inertia_matrix(";
const B11: &str = "10.0 * c2 + 21.526, t1";

#[track_caller]
fn check(scalar: Scalar, entry: &str, why: &str) {
    let fault = fault(scalar, B, B11, &format!("{entry}, t1"));
    assert!(fault.starts_with("inertia_matrix: ") && fault.contains(why), "{fault}");
}

#[test]
#[ignore = "wide"]
fn divisors_that_the_equations_do_not_ask_for_are_refused() {
    let why = "it divides, which its equations do not ask for";
    check(Scalar::F64, "(10.0 * c2 + 21.526) * ((q[2] - 0.2) / (q[2] - 0.2))", why);
    check(Scalar::F64, "(10.0 * c2 + 21.526) * (c2 / c2)", why);
    check(Scalar::F32, "(20.0 * c2 + 43.052) / 2.0", why);
    // Accelerations may be divided by pivots, and by nothing else.
    let forward = |old: &str, new: &str| {
        let fault = fault(Scalar::F64, "pub fn forward_dynamics(", old, new);
        assert!(fault.starts_with("forward_dynamics: it divides by what is no pivot"), "{fault}");
    };
    forward("[t29,", "[t29 * ((q[2] - 0.2) / (q[2] - 0.2)),");
    forward("[t29,", "[t29 * (c2 / c2),");
    forward("[t29,", "[t29 * ((8.766 + t8) / (8.766 + t8)),");
    let operational = fault(Scalar::F64, "pub fn operational_inertia(", "let t2 = ", "let t2 = (q[2] / q[2]) * ");
    assert!(operational.contains("no pivot") || operational.contains("differs"), "{operational}");
}

#[test]
#[ignore = "wide"]
fn what_leaves_the_scalar_or_vanishes_is_refused() {
    let right = "10.0 * c2 + 21.526";
    let why = "a value can leave f64 anywhere in the box";
    check(Scalar::F64, &format!("{right} + (1e200 * 1e200 - 1e200 * 1e200)"), why);
    check(Scalar::F64, &format!("({right}) * (1e-200 * 1e-200) * 1e200 * 1e200"), "rounding can make an error of");
    check(Scalar::F64, &format!("({right}) * 1e160 * 1e160 * 1e-160 * 1e-160"), why);
    check(Scalar::F32, &format!("({right}) * 1e25 * 1e25 * 1e-25 * 1e-25"), "a value can leave f32 anywhere in the box");
    check(Scalar::F32, &format!("({right}) * 1e-30 * 1e-30 * 1e30 * 1e30"), "rounding can make an error of");
    check(Scalar::F32, &format!("({right}) * 1e-20 * 1e-20 * 1e20 * 1e20"), "rounding can make an error of");
    check(Scalar::F64, &format!("({right}) * 1e-160 * 1e-160 * 1e160 * 1e160"), "rounding can make an error of");
}

#[test]
fn what_loses_its_digits_is_refused() {
    let (right, why) = ("10.0 * c2 + 21.526", "rounding can make an error of");
    check(Scalar::F64, &format!("{right} + 1e25 - 1e25"), why);
    check(Scalar::F64, &format!("{right} - 0.3 + (1e16 + 0.3 - 1e16)"), why);
    // With a variable there is nothing for an interval to see cancel.
    for scalar in [Scalar::F64, Scalar::F32] {
        check(scalar, &format!("{right} + (1000000000.0 * c2 - 1000000000.0 * c2)"), why);
        check(scalar, &format!("{right} + (1000000000.0 * q[2] - 1000000000.0 * q[2])"), why);
    }
    // Where no state is tried, by intervals: (1 - (c2 - 1/5)²)^(2^12) is almost 0 but within a fiftieth of 1/5.
    let squares: String = (0..12).map(|k| format!("let t{} = t{1} * t{1}; ", 901 + k, 900 + k)).collect();
    let spike =
        format!("let t900 = 1.0 - (c2 - 0.2) * (c2 - 0.2); {squares} let t999 = 1e17 * t912;\n    [\n        [t999 - t999 + ");
    let fault = fault(Scalar::F64, B, "[\n        [", &spike);
    assert!(fault.starts_with("inertia_matrix: ") && fault.contains("in the box"), "{fault}");
}

#[test]
#[ignore = "wide"]
fn forward_dynamics_are_judged_as_well() {
    let forward = |scalar: Scalar, new: &str, why: &str| {
        let fault = fault(scalar, "pub fn forward_dynamics(", "[t29,", &format!("[{new},"));
        assert!(fault.starts_with("forward_dynamics: ") && fault.contains(why), "{fault}");
    };
    let why = "rounding can make an error of";
    forward(Scalar::F64, "t29 + (1e17 * t29 - 1e17 * t29)", why);
    forward(Scalar::F64, "t29 + 1e17 - 1e17", why);
    forward(Scalar::F64, "t29 + (1e17 * c2 - 1e17 * c2)", why);
    forward(Scalar::F64, "t29 + (1e200 * 1e200 - 1e200 * 1e200)", "a value can leave f64");
    forward(Scalar::F32, "t29 * 1e25 * 1e25 * 1e-25 * 1e-25", "a value can leave f32");
    forward(Scalar::F32, "t29 * 1e-25 * 1e-25 * 1e25 * 1e25", why);
}

/// A literal has the exact value that stands at its place, and not another one that rounds to the same float.
#[test]
#[ignore = "wide"]
fn every_literal_has_one_exact_value() {
    for path in common::paths().into_iter().chain(common::hostile_paths()) {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        for scalar in [Scalar::F64, Scalar::F32] {
            let source = Source::new(&name, std::fs::read_to_string(&path).expect("a description"));
            #[allow(clippy::needless_update)]
            let Some(generated) = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() }).0
            else {
                continue;
            };
            let module = Module::read(&generated.module).expect("a module");
            let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
            for (function, program) in module.programs() {
                let resolved = claims.resolve(function, &program.literals, module.real);
                assert!(resolved.others.is_empty(), "{name} {function}: {:?}", resolved.others);
                assert_eq!(resolved.values, claims.of(function), "{name} {function}");
            }
        }
    }
}

/// Descriptions that are made to be hard on armgen: right, or refused with a diagnostic, or with what the limits make of it.
#[test]
#[ignore = "wide"]
fn hostile_robots_are_right_or_refused_with_a_reason() {
    let mut verified = 0;
    for path in common::hostile_paths() {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        for scalar in [Scalar::F64, Scalar::F32] {
            let source = Source::new(&name, std::fs::read_to_string(&path).expect("a description"));
            #[allow(clippy::needless_update)]
            let (generated, diagnostics) = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() });
            let Some(generated) = generated else {
                assert!(diagnostics.iter().all(|d| !d.help.is_empty()), "{name}: {diagnostics:?}");
                continue;
            };
            let report = certify(&source, &generated);
            match report.first_fault() {
                None => verified += 1,
                Some(fault) => assert!(fault.contains("a value can leave"), "{name} {scalar:?}: {fault}"),
            }
        }
    }
    assert!(verified >= 14, "{verified}");
}

/// Bounds grow along an arm, and so does what is allowed of them.
#[test]
#[ignore = "wide"]
fn a_long_arm_is_verified() {
    let joint = |i: usize| {
        format!(
            "  - {{name: j{i}, type: revolute, a: 0.1, alpha: pi/2, d: 0, theta: 0, link: {{mass: 1, com: [0.1, 0.2, 0.3]}}}}\n"
        )
    };
    let joints: String = (0..16).map(joint).collect();
    let source = Source::new("long.yaml", format!("name: long\nconvention: standard\ngravity: [1, 2, -9.81]\njoints:\n{joints}"));
    let generated = common::generate_with(&source, &Options::default());
    let report = certify(&source, &generated);
    assert!(report.passed(), "{report}");
}
