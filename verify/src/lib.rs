//! Whether an emitted module is right: a certificate that its text equals the equations of its description.
//!
//! ```text
//! text of the module   -> reader    -> constants and straight-line programs
//! text of robot.yaml   -> Manipulator -> equations, the plain way, at random points
//! programs at these points = equations there, exactly; every literal the float nearest to the exact value it is run with
//! ```
//!
//! Shared with the generator is the reading of robot.yaml into a [`Manipulator`], its numbers taken
//! over as text ([`formula`]), and nothing after it: no expression, no field, no derivation, no optimiser, no emitter. The exact values of
//! literals come from the generator or from a certificate, and need no trust ([`claims`]).
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use armgen_codegen::source::Source;
//! let source = Source::new("robot.yaml", std::fs::read_to_string("robot.yaml")?);
//! let report = armgen_verify::verify(&source, &std::fs::read_to_string("robot.rs")?, None);
//! println!("{report}");
//! std::fs::write("robot.cert.json", armgen_verify::certificate::Certificate::of(&report).to_json())?;
//! # Ok(())
//! # }
//! ```
//!
//! What is not covered: that the compiler and libm do what they promise. How far rounding takes the functions
//! from the equations is bounded a priori ([`bounds`](mod@bounds)) and at a state ([`companion`](mod@companion)), and measured ([`errors`]).

#[doc(hidden)]
pub mod arithmetic;
mod at_state;
#[doc(hidden)]
pub mod base;
pub mod bounds;
pub mod certificate;
mod check;
#[doc(hidden)]
pub mod checker;
#[doc(hidden)]
pub mod claims;
pub mod companion;
#[doc(hidden)]
pub mod constants;
#[doc(hidden)]
pub mod contract;
#[doc(hidden)]
pub mod divisors;
#[doc(hidden)]
pub mod element;
#[doc(hidden)]
pub mod enclosure;
#[doc(hidden)]
pub mod equations;
pub mod errors;
#[doc(hidden)]
pub mod float;
#[doc(hidden)]
pub mod formula;
#[doc(hidden)]
pub mod identities;
#[doc(hidden)]
pub mod influence;
mod interval;
pub mod inverse_kinematics;
mod marked;
#[doc(hidden)]
pub mod number;
#[doc(hidden)]
pub mod powers;
#[doc(hidden)]
pub mod program;
#[doc(hidden)]
pub mod ranges;
#[doc(hidden)]
pub mod reader;
#[doc(hidden)]
pub mod reference;
pub mod report;
#[doc(hidden)]
pub mod residual;
#[doc(hidden)]
pub mod rounding;
#[doc(hidden)]
pub mod seed;
#[doc(hidden)]
pub mod signs;
#[doc(hidden)]
pub mod stated;
#[doc(hidden)]
pub mod stream;
pub mod test_kit;
#[doc(hidden)]
pub mod yardstick;

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::emit::{Language, Origin};
use armgen_codegen::kinds::Scalar;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::pass::{Pass, Passes};
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::Generated;
use sha2::{Digest, Sha256};

use certificate::Certificate;
use check::{parallel_map, Check};
use checker::{Checker, Effort};
use claims::Claims;
use enclosure::Float;
use equations::parameters::Vector;
use formula::Formula;
use reader::{Constant, Module, ModuleText};
use report::{Report, Verdict};
use rounding::Trial;

/// SHA-256 of a text, hexadecimal.
pub fn hash(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The module read and the equations at random points, ready to be compared.
pub struct Prepared {
    /// The module.
    pub module: Module,
    /// The equations.
    pub checker: Checker,
}

/// Reads a module and prepares the equations of its arm.
pub fn prepare<'a>(
    manipulator: Manipulator,
    text: impl Into<ModuleText<'a>>,
    claims: Claims,
    effort: Effort,
) -> Result<Prepared, String> {
    let module = Module::read(text)?;
    if let Some(Constant::Text(name)) = module.constants.get("NAME") {
        if *name != manipulator.name && Check::Robot.is_made() {
            return Err(format!("NAME: the module is of the robot `{name}`, the description of `{}`", manipulator.name));
        }
    }
    let vector = Vector::of(&manipulator, &constants::parameter_names(&module))?;
    let claims = claims.used(&module, &constants::claimed_constants(&vector, &module));
    let base = constants::base_parameters(&manipulator, &claims, &module);
    let checker = Checker::new(manipulator, vector, claims, effort, &module, base)?;
    Ok(Prepared { module, checker })
}

/// Verifies the text of a module against the text of its description.
///
/// The exact values of literals come from `certificate` or, without one, from a run of the generator; neither is trusted. A certificate must say
/// what the one says that is written on what is found: each difference is a fault. Faults of the description are rendered into [`Report::faults`].
pub fn verify<'a>(source: &Source, text: impl Into<ModuleText<'a>>, certificate: Option<&Certificate>) -> Report {
    let text = text.into();
    let report = Report::of(hash(source.text()), hash(text.text));
    let module = match Module::read(text) {
        Ok(module) => module,
        Err(fault) => return Report { faults: vec![fault.into()], ..report },
    };
    let by_generator = || verify_by_generator(source, text, &module);
    let Some(certificate) = certificate else { return by_generator() };
    match certificate.claims_for(&module, &report.input, &report.output) {
        Ok(claims) => {
            let mut report = verify_with(source, text, claims, Effort::default());
            if report.passed() {
                report.faults = certificate.differences(&Certificate::of(&report));
            }
            report
        }
        // Which function is wrong, if one is, is worth knowing all the same.
        Err(faults) => {
            let mut report = by_generator();
            report.faults.extend(faults);
            report
        }
    }
}

/// Verifies what the generator has just made from a description.
pub fn certify(source: &Source, generated: &Generated) -> Report {
    certify_in(source, generated, Language::Rust)
}

/// The same for the module in a language.
pub fn certify_in(source: &Source, generated: &Generated, language: Language) -> Report {
    let text = generated.in_language(language);
    let text = ModuleText { language, text: &text };
    verify_with(source, text, Claims::from_numbers(&generated.constants), Effort::default())
}

/// That a value of a function can leave the scalar within the limits of the joints, with the place in the description.
pub fn beyond_the_scalar(source: &Source, function: &str, scalar: Scalar) -> Diagnostics {
    let (read, mut diagnostics) = validate::read_for(source, scalar);
    if let Some((manipulator, places)) = read {
        diagnostics = Diagnostics::default();
        diagnostics.push(validate::values_leave_the_scalar(&manipulator, &places, scalar, function));
    }
    diagnostics
}

/// Verifies with the constants of the generator. One that was left a pass has others: where some literal of the module is none, they are asked for
/// pass by pass.
fn verify_by_generator(source: &Source, text: ModuleText<'_>, module: &Module) -> Report {
    let verify_without = |without: Passes| {
        let claims = generated_claims(source, module.real, without);
        let lacks = claims.lack(module);
        (verify_with(source, text, claims, Effort::default()), lacks)
    };
    let (report, lacks) = verify_without(Passes::default());
    if report.passed() || !lacks {
        return report;
    }
    let of_pass = |pass: Pass| {
        let mut without = Passes::default();
        without.insert(pass);
        without
    };
    let others = Pass::ALL.into_iter().map(of_pass).chain([Passes::all()]).map(verify_without);
    others.map(|(report, _)| report).find(Report::passed).unwrap_or(report)
}

/// The constants of the generator for a scalar, without some passes.
fn generated_claims(source: &Source, real: Float, without: Passes) -> Claims {
    let scalar = match real {
        Float::F32 => Scalar::F32,
        Float::F64 => Scalar::F64,
    };
    #[allow(clippy::needless_update)]
    let options = armgen_codegen::schedule::Options { scalar, without, ..Default::default() };
    let (generated, _) = armgen_codegen::generate(source, &options);
    generated.map_or(Claims::none(), |generated| Claims::from_numbers(&generated.constants))
}

/// Verifies with chosen claims and effort.
pub fn verify_with<'a>(source: &Source, text: impl Into<ModuleText<'a>>, claims: Claims, effort: Effort) -> Report {
    let text = text.into();
    let mut report = Report::of(hash(source.text()), hash(text.text));
    let (read, diagnostics) = validate::read_for(source, Scalar::F64);
    let Some((manipulator, _)) = read else {
        report.faults.push(diagnostics.render(source, armgen_codegen::diagnostic::Colour::Never));
        return report;
    };
    report.robot.clone_from(&manipulator.name);
    match prepare(manipulator, text, claims, effort) {
        Ok(prepared) => fill(&mut report, &prepared),
        Err(fault) => report.faults.push(fault),
    }
    report
}

/// The text of a test file for a project that has the module: what [`test_kit`](mod@test_kit) describes. `import` brings the module in as
/// `robot`: `use my_crate::robot;`, or `#[path = "../src/robot.rs"] mod robot;`.
pub fn test_kit(source: &Source, text: &str, import: &str) -> Result<String, String> {
    let (read, diagnostics) = validate::read_for(source, Scalar::F64);
    let (manipulator, _) = read.ok_or_else(|| diagnostics.render(source, armgen_codegen::diagnostic::Colour::Never))?;
    test_kit::test_kit(&manipulator, &Module::read(text)?, import, &Origin::of(source))
}

/// The same for a module in another language than Rust; `name` is what the module is called where it is taken in: a file of C or JavaScript, a
/// module of Python, a package of MATLAB.
pub fn test_kit_in(source: &Source, text: ModuleText<'_>, name: &str) -> Result<String, String> {
    let (read, diagnostics) = validate::read_for(source, Scalar::F64);
    let (manipulator, _) = read.ok_or_else(|| diagnostics.render(source, armgen_codegen::diagnostic::Colour::Never))?;
    test_kit::in_language(&manipulator, &Module::read(text)?, text.language, name, &Origin::of(source))
}

/// Puts the error bounds of all functions into the documentation of what was generated: see [`bounds`](mod@bounds).
pub fn document_bounds(source: &Source, generated: &mut Generated) -> Result<(), String> {
    let (read, diagnostics) = validate::read_for(source, Scalar::F64);
    let (manipulator, _) = read.ok_or_else(|| diagnostics.render(source, armgen_codegen::diagnostic::Colour::Never))?;
    let module = Module::read(&generated.module)?;
    let bounds = bounds::of(&manipulator, &module, &Claims::from_numbers(&generated.constants));
    generated.annotate(&bounds::notes(&bounds));
    Ok(())
}

/// The companion of what was generated, with a running error bound for each function: see [`companion`](mod@companion). `import` brings in the
/// module's types: `use super::robot::*;`.
pub fn companion(generated: &Generated, import: &str) -> Result<String, String> {
    companion::companion(&Module::read(&generated.module)?, &Claims::from_numbers(&generated.constants), import)
}

/// What follows in the companion where inverse kinematics is emitted too: see [`companion::of_inverse_kinematics`].
pub fn companion_of_inverse_kinematics(generated: &Generated) -> Result<String, String> {
    Ok(companion::of_inverse_kinematics(&Module::read(&generated.module)?))
}

fn fill(report: &mut Report, prepared: &Prepared) {
    let Prepared { module, checker } = prepared;
    report.scalar = match module.real {
        Float::F64 => "f64".into(),
        Float::F32 => "f32".into(),
    };
    report.trig = module.trig.unwrap_or_default().into();
    let nominal = constants::nominal_parameters(checker.manipulator(), checker.vector(), checker.claims(), module);
    let nominal: Vec<Formula> = nominal.unwrap_or_default();
    report.constants = constants::check(checker, module, &nominal);
    report.functions = checker.functions(module);
    report.domain = bounds::domain_of(checker.manipulator(), module);
    at_state::say(&mut report.functions, module, checker, &nominal);
    // The box is of the module's constants, the residual of its equations of motion: what is wrong has no bounds.
    let right = report.constants.iter().all(|constant| constant.verdict == Verdict::Equal)
        && report.functions.iter().all(|function| function.verdict == Verdict::Equal);
    let trial = right.then(|| Trial::new(module, &report.domain, checker));
    if let Some(trial) = trial {
        let of_floats = parallel_map(&report.functions, |function| {
            let program = module.program(&function.name)?;
            let values: Vec<Formula> = function.literals.iter().map(|literal| literal.value.clone()).collect();
            let bound = bounds::of_function(program, &values, &report.domain, module, checker.claims());
            Some((bound, trial.fault(program, &values)))
        });
        for (function, (bound, unfit)) in report.functions.iter_mut().zip(of_floats).filter_map(|(f, found)| Some((f, found?))) {
            (function.bound, function.unfit) = (Some(bound), unfit);
        }
    }
    report.identities = identities::check(checker, module, &report.functions, &nominal);
    report.faults.extend(stated::faults(checker, module, report));
    debug_assert!(report.functions.iter().all(|f| f.verdict != Verdict::Equal || f.points > 0));
}
