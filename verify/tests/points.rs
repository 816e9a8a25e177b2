//! The random points: their dependence on the texts, and the real signs of roots there.

use crate::common;

use armgen_certify::{certify, verify};
use armgen_codegen::kinds::Scalar;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_verify::certificate::report::MOST_LOG2_ODDS;
use armgen_verify::certificate::Certificate;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::Module;
use armgen_verify::values::stream::Stream;
use armgen_verify::{judge::seed, verify_with};

/// The first bits of the points for a text.
fn bits(source: &Source, text: &str, claims: &Claims) -> u64 {
    let (manipulator, _) = validate::read(source).0.expect("a valid description");
    let module = Module::read(text).expect("a module");
    let mut stream: Stream = seed::stream(&manipulator, &module, &claims.used(&module, &[]), 0);
    stream.bits()
}

fn replaced(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old} is not in the text");
    text.replacen(old, new, 1)
}

#[test]
fn what_has_no_influence_gives_no_other_points() {
    let source = common::source("scara");
    let generated = common::generate(&source, Scalar::F64);
    let (text, claims) = (&generated.module, Claims::from_numbers(&generated.constants).expect("short formulas"));
    let points = bits(&source, text, &claims);
    let same = |what: &str, source: &Source, text: &str, claims: &Claims| {
        assert_eq!(bits(source, text, claims), points, "{what}");
    };
    same("a comment", &source, &format!("// 7\n{text}"), &claims);
    same("blanks", &source, &text.replace("    let", "\n  let"), &claims);
    same("documentation", &source, &replaced(text, "/// Gravity term g(q) on", "/// The term g(q) on"), &claims);
    same("names", &source, &text.replace("t1", "t1_renamed"), &claims);
    same(
        "an unused step",
        &source,
        &replaced(text, "    let (_, c2) = sin_cos(q[1]);", "    let (_, c2) = sin_cos(q[1]); let t99 = 3.0 * c2;"),
        &claims,
    );
    same("the order of summands", &source, &replaced(text, "let t1 = 5.0 * c2 + 8.766;", "let t1 = 8.766 + c2 * 5.0;"), &claims);
    let at = text.find("/// Viscous and Coulomb").or_else(|| text.find("pub fn friction(")).expect("a function");
    let from = text[..at].rfind("\n\n").expect("a blank line") + 2;
    let end = from + text[from..].find("\n}\n").expect("its end") + 3;
    let moved = format!("{}{}\n{}", &text[..from], &text[end..], &text[from..end]);
    same("the order of items", &source, &moved, &claims);
    let more: Vec<(String, Vec<String>)> = generated
        .constants
        .iter()
        .map(|(name, list)| {
            (name.clone(), list.iter().map(ToString::to_string).chain(["12345/6789*sqrt(7)".to_string()]).collect())
        })
        .collect();
    let more = Claims::from_texts(more.iter().map(|(name, list)| (name.as_str(), list.as_slice()))).expect("formulas");
    same("a claim for no literal", &source, text, &more);
    let described = |text: &str| Source::new("robot.yaml", text.to_string());
    same("a comment in the description", &described(&format!("{}\n# 7\n", source.text())), text, &claims);
}

#[test]
fn what_has_influence_gives_other_points() {
    let source = common::source("scara");
    let generated = common::generate(&source, Scalar::F64);
    let (text, claims) = (&generated.module, Claims::from_numbers(&generated.constants).expect("short formulas"));
    let points = bits(&source, text, &claims);
    for (old, new) in [("5.0 * c2", "5.5 * c2"), ("5.0 * c2 + 8.766", "5.0 * c2 - 8.766"), ("sin_cos(q[1])", "sin_cos(q[0])")] {
        assert_ne!(bits(&source, &replaced(text, old, new), &claims), points, "{new}");
    }
    // The same float represents another number.
    let other =
        Claims::from_texts([("inertia_matrix", &["8766/1000 + 1/10^30".to_string(), "5".to_string()][..])]).expect("formulas");
    assert_ne!(bits(&source, text, &other), points);
    let described = Source::new("robot.yaml", replaced(source.text(), "-9.81", "-9.82"));
    assert_ne!(bits(&described, text, &claims), points);
}

#[test]
fn odds_allow_for_tries() {
    for name in ["single_joint", "scara", "panda7"] {
        let source = common::source(name);
        let report = certify(&source, &common::generate(&source, Scalar::F64));
        assert!(report.passed(), "{report}");
        for function in &report.functions {
            assert!(function.log2_odds <= MOST_LOG2_ODDS, "{name} {}: 2^{}", function.name, function.log2_odds);
            assert_eq!(function.exact_points, 1, "{name} {}", function.name);
        }
    }
}

/// a1 = sqrt(2 + sqrt(3)), a2 = sqrt(2 - sqrt(3)), so that a1 a2 = 1. A module with a1 a2 = -1 is wrong at every point.
#[test]
fn roots_of_roots_have_their_real_signs() {
    let source = common::source("nest");
    let generated = common::generate(&source, Scalar::F64);
    let certificate = Certificate::of(&certify(&source, &generated));
    let right = verify(&source, &generated.module, Some(&certificate));
    assert!(
        right.passed() && right.to_string().contains("at no rational point, prime fields alone: direct_kinematics"),
        "{right}"
    );
    let wrong = generated.module.replace("1.0 * c2", "-(0.5 + 0.5) * c2").replace("2.0 * c2", "-(1.0 + 1.0) * c2");
    let wrong = if wrong == generated.module { generated.module.replace("c2", "(-(0.5 + 0.5) * c2)") } else { wrong };
    assert_ne!(wrong, generated.module);
    for seed in 0..40 {
        let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
        let report = verify_with(&source, &wrong, claims, Effort { points: 1, seed, ..Effort::default() });
        let fault = report.first_fault().unwrap_or_default();
        assert!(fault.contains("differs from the equations"), "run {seed}: {fault}");
    }
}
