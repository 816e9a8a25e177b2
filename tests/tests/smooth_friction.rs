//! Smooth friction, F_c tanh(dq / v) in place of F_c sign(dq): against closed forms, the oracle and the checker, in every language.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::Generated;
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::judge::{judge, Tolerance};
use armgen_tests::precision::{FORWARD_RESIDUAL, ORACLE};
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::ModuleText;
use armgen_verify::verify_with;

const ARM: &str = include_str!("../data/smooth_friction.yaml");

fn generated(scalar: Scalar, fuse: bool) -> (Source, Generated) {
    let source = Source::new("smooth_friction.yaml", ARM);
    let (generated, said) = armgen_codegen::generate(&source, &Options { scalar, fuse, ..Options::default() });
    let generated = generated.unwrap_or_else(|| panic!("{}", said.render(&source, Colour::Never)));
    (source, generated)
}

/// The first fault of a module in a language; `None`: it is proved.
fn fault(source: &Source, generated: &Generated, language: Language, text: &str) -> Option<String> {
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    let effort = Effort { points: 2, exact_points: 1, seed: 0 };
    verify_with(source, ModuleText { language, text }, claims, effort).first_fault()
}

fn interpreted() -> Interpreted {
    Interpreted::with_options(ARM, &Options::default()).expect("a valid arm")
}

/// tanh(½ ln 3) = ½ and artanh(¾) = ½ ln 7.
#[test]
fn friction_has_the_values_of_tanh() {
    let robot = interpreted();
    let friction = |dq: [f64; 3]| robot.call("friction", &Arguments { q: vec![0.0; 3], dq: dq.to_vec(), ..Arguments::default() });
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-14 * b.abs().max(1.0), "{a} {b}");
    let half = [0.6, 0.3].map(|v| 0.5 * v * 3f64.ln());
    let viscous = 0.5 + 50.0 * 50.0 * 1e-4;
    for sign in [1.0, -1.0] {
        let f = friction([sign * half[0], sign * half[1], 0.0]);
        near(f[0], sign * (viscous * half[0] + 0.5 * 1.7) - 0.2);
        near(f[1], sign * (9.0 * half[1] + 0.5 * 6.0));
        near(friction([0.0, sign * 0.5 * 0.3 * 7f64.ln(), 0.0])[1], sign * (9.0 * 0.15 * 7f64.ln() + 0.75 * 6.0));
        near(friction([0.0, sign * 40.0, 0.0])[1], sign * (360.0 + 6.0));
    }
    assert_eq!(friction([0.0; 3]), [-0.2, 0.0, 0.0]);
}

/// F_c / v at rest, where a sign has no derivative, and F_c (1 - ¼) / v at half of F_c.
#[test]
fn derivatives_have_the_slope_of_tanh() {
    let robot = interpreted();
    let slope = |rate: f64| {
        let zero = vec![0.0; 3];
        let a = Arguments { q: zero.clone(), dq: vec![0.0, rate, 0.0], ddq: zero, ..Arguments::default() };
        robot.call("inverse_dynamics_derivatives", &a)[9 + 4]
    };
    for (rate, expected) in [(0.0, 9.0 + 6.0 / 0.3), (0.15 * 3f64.ln(), 9.0 + 0.75 * 6.0 / 0.3), (30.0, 9.0)] {
        assert!((slope(rate) - expected).abs() < 1e-12 * expected, "{rate}: {} {expected}", slope(rate));
    }
}

#[test]
fn functions_agree_with_the_oracle() {
    for text in
        [ARM.to_owned(), ARM.replace("regressor: [dry, heavy]", "regressor: base"), ARM.replace("regressor: [dry, heavy]", "")]
    {
        let robot = Interpreted::with_options(&text, &Options::default()).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
        for seed in 0..4 {
            judge("smooth friction", &robot, &text, seed, Tolerance { values: ORACLE, residual: FORWARD_RESIDUAL });
        }
    }
}

#[test]
fn rust_is_proved() {
    let (source, generated) = generated(Scalar::F64, false);
    assert_eq!(fault(&source, &generated, Language::Rust, &generated.module), None);
}

#[test]
#[ignore = "wide"]
fn all_languages_are_proved() {
    for (scalar, fuse) in [(Scalar::F64, false), (Scalar::F32, false), (Scalar::F64, true)] {
        let (source, generated) = generated(scalar, fuse);
        for language in Language::ALL.into_iter().filter(|language| language.scalars().contains(&scalar)) {
            let text = generated.in_language(language);
            assert_eq!(fault(&source, &generated, language, &text), None, "{} {scalar:?}", language.title());
        }
    }
}

/// Another velocity, a divisor that is not at least 1 in its form, no divisor, the sign of another joint.
#[test]
fn changed_modules_are_refused() {
    let (source, generated) = generated(Scalar::F64, false);
    let text = &generated.module;
    for (from, to, why) in [
        ("stribeck(dq[0], 0.3)", "stribeck(dq[0], 0.6)", "decays at 0.6, in the description at 0.3"),
        ("(1.0 - t1) / (1.0 + t1)", "(1.0 - t1) / (2.0 + t1 - 1.0)", "divides, which its equations do not ask for"),
        ("(1.0 - t1) / (1.0 + t1)", "(1.0 - t1)", "differs from the equations"),
        ("sign(dq[1])", "sign(dq[0])", "differs from the equations"),
    ] {
        assert!(text.contains(from), "{from}\n{text}");
        let found = fault(&source, &generated, Language::Rust, &text.replacen(from, to, 1));
        assert!(found.as_ref().is_some_and(|found| found.contains(why)), "{from} -> {to}: {found:?}");
    }
}
