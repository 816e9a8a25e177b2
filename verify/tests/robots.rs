//! Every robot of the project is verified, in both scalars; a certificate lets anyone verify again.

mod common;

use armgen_codegen::program::{Options, Scalar, Trig};
use armgen_verify::certificate::Certificate;
use armgen_verify::{certify, verify};

/// Prints the report of each with `--nocapture`.
fn check(scalar: Scalar) {
    for path in common::paths() {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let source = common::source(&name);
        let generated = common::generate(&source, scalar);
        let start = std::time::Instant::now();
        let report = certify(&source, &generated);
        println!("{:?}\n{report}\n", start.elapsed());
        assert!(report.passed(), "{name}: {}", report.first_fault().unwrap_or_default());
        for function in &report.functions {
            assert!(function.log2_odds < -100.0, "{name}: {}: odds 2^{}", function.name, function.log2_odds);
        }
    }
}

#[test]
fn all_robots_are_verified_in_f64() {
    check(Scalar::F64);
}

#[test]
fn all_robots_are_verified_in_f32() {
    check(Scalar::F32);
}

#[test]
fn a_certificate_replaces_the_generator_and_belongs_to_its_texts() {
    for name in ["scara", "everything", "base_set"] {
        let source = common::source(name);
        let generated = common::generate(&source, Scalar::F64);
        let certificate = Certificate::of(&certify(&source, &generated));
        let json = certificate.to_json();
        let read = Certificate::from_json(&json).expect("what was written");
        assert_eq!(read, certificate);
        let again = verify(&source, &generated.module, Some(&read));
        assert!(again.passed(), "{name}: {}", again.first_fault().unwrap_or_default());
        assert_eq!(Certificate::of(&again).to_json(), json, "the same texts give the same certificate");

        let edited = generated.module.replace("Do not edit.", "Edited.");
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
fn sines_of_all_angles_together_are_read() {
    for (name, scalar) in [
        ("panda7", Scalar::F64),
        ("panda7", Scalar::F32),
        ("scara", Scalar::F32),
        ("everything", Scalar::F64),
        ("modified_prismatic", Scalar::F32),
    ] {
        let source = common::source(name);
        #[allow(clippy::needless_update)]
        let options = Options { scalar, trig: Trig::Fast, ..Options::default() };
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
        assert!(fault.contains("is not one that is known to be right"), "{fault}");
    }
    let swapped = fault("let ([s1, s2,", "let ([s2, s1,");
    assert!(swapped.starts_with("direct_kinematics[0][0]: "), "{swapped}");
    let left_out = fault("        7,\n        q[0],", "        6,\n        q[0],");
    assert!(left_out.contains("direct_kinematics"), "{left_out}");
}
