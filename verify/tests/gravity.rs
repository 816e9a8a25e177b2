//! Modules that have the acceleration of free fall as an argument.

use crate::common;

use armgen_certify::{certify, certify_in, document_bounds, verify};
use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::source::Source;
use armgen_codegen::Generated;
use armgen_verify::certificate::Certificate;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::verify_with;

const ARM: &str = include_str!("../../tests/data/mounted.yaml");

fn source(more: &str) -> Source {
    Source::new("mounted.yaml", format!("{ARM}{more}"))
}

fn fixed() -> Source {
    Source::new("mounted.yaml", ARM.replace("{argument: [1, -2, -9.81]}", "[1, -2, -9.81]"))
}

fn documented(source: &Source) -> Generated {
    let mut generated = common::generate(source, Scalar::F64);
    document_bounds(source, &mut generated).expect("bounds");
    generated
}

#[test]
#[ignore = "wide"]
fn every_language_is_verified_and_every_regressor() {
    let names = "parameters: {m: 3, k: 20}\nregressor: [m, k]\n";
    let named = ARM.replace("mass: 3", "mass: m").replace("stiffness: 20", "stiffness: k");
    for source in [source(""), source("regressor: base\n"), Source::new("mounted.yaml", format!("{named}{names}"))] {
        let generated = documented(&source);
        let report = certify(&source, &generated);
        assert!(report.passed(), "{report}");
        assert!(generated.module.contains("// Coordinates of g0 within the size of NOMINAL_GRAVITY"));
        let again = verify(&source, &generated.module, Some(&Certificate::of(&report)));
        assert!(again.passed(), "{again}");
    }
    let generated = documented(&source(""));
    for language in Language::ALL.into_iter().filter(|language| *language != Language::Rust) {
        let report = certify_in(&source(""), &generated, language);
        assert!(report.passed(), "{}: {report}", language.title());
    }
}

#[test]
fn what_takes_gravity_otherwise_is_refused() {
    let (source, fixed) = (source(""), fixed());
    let (generated, of_fixed) = (common::generate(&source, Scalar::F64), common::generate(&fixed, Scalar::F64));
    let fault = |source: &Source, text: &str| {
        let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
        verify_with(source, text, claims, Effort::default()).first_fault().unwrap_or_default().to_string()
    };
    let refused = |text: &str, why: &str| {
        assert_ne!(text, generated.module);
        let found = fault(&source, text);
        assert!(found.contains(why), "{found}, instead of: {why}");
    };
    let found = fault(&fixed, &generated.module);
    assert!(found.contains("gravity is no argument in the description"), "{found}");
    refused(&of_fixed.module, "NOMINAL_GRAVITY is missing");

    let begin = generated.module.find("pub fn gravity(").expect("the function");
    let end = begin + generated.module[begin..].find("\n}").expect("its end");
    let in_gravity = |change: &dyn Fn(&str) -> String| {
        let (before, own, after) = (&generated.module[..begin], &generated.module[begin..end], &generated.module[end..]);
        assert!(own.contains("g0[1]"), "{own}");
        format!("{before}{}{after}", change(own))
    };
    let swapped = |own: &str| own.replace("g0[0]", "g0[9]").replace("g0[1]", "g0[0]").replace("g0[9]", "g0[1]");
    refused(&in_gravity(&swapped), "gravity");
    refused(&in_gravity(&|own| own.replacen("g0[1]", "g0[3]", 1)), "index 3 is beyond the end of its argument");
    refused(&in_gravity(&|own| own.replacen("g0: &[Real; 3]", "g0: &[Real; DOF]", 1)), "where the signature");
    refused(&generated.module.replacen("[1.0, -2.0, -9.81]", "[1.0, -2.0, -9.8]", 1), "NOMINAL_GRAVITY");
    let hidden = of_fixed.module.replacen("/// Name", "/// pub const NOMINAL_GRAVITY: [Real; 3]\n/// Name", 1);
    assert_ne!(hidden, of_fixed.module);
    let found = fault(&fixed, &hidden);
    assert!(found.contains("signature"), "{found}");
}
