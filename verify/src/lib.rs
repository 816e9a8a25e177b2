//! Whether an emitted module is right: a certificate that its text equals the equations of its description.
//!
//! ```text
//! text of the module   -> reader    -> constants and straight-line programs
//! text of robot.yaml   -> Manipulator -> equations, the plain way, at random points
//! programs at these points = equations there, exactly; every literal the float nearest to the exact value it is run with
//! ```
//!
//! The checker does not depend on the generator. Both read robot.yaml into a [`Manipulator`] with `armgen-description`; its numbers are taken
//! over as text ([`values::formula`]). The exact values of literals come from a certificate, or from a caller that has the generator
//! (`armgen-certify`), and need no trust ([`read::claims`]).
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use armgen_description::source::Source;
//! use armgen_verify::certificate::Certificate;
//! let source = Source::new("robot.yaml", std::fs::read_to_string("robot.yaml")?);
//! let certificate = Certificate::from_json(&std::fs::read_to_string("robot.cert.json")?)?;
//! println!("{}", armgen_verify::verify(&source, &std::fs::read_to_string("robot.rs")?, &certificate));
//! # Ok(())
//! # }
//! ```
//!
//! What is not covered: that the compiler and libm do what they promise. How far rounding takes the functions
//! from the equations is bounded a priori ([`floats::bounds`]) and at a state ([`floats::companion`]), and measured ([`floats::errors`]).

// Tests of the checks leave them out one by one, so they need the caller with the generator around this very crate.
#[cfg(test)]
#[path = "../../certify/src/lib.rs"]
#[allow(dead_code, unreachable_pub)]
pub(crate) mod certify;
#[cfg(test)]
extern crate self as armgen_verify;

pub mod certificate;
pub mod floats;
pub mod inverse_kinematics;
pub mod judge;
pub mod read;
pub mod test_kit;
pub mod textbook;
pub mod timing;
pub mod values;

use armgen_description::diagnostic::Colour;
use armgen_description::kinds::Scalar;
use armgen_description::manipulator::Manipulator;
use armgen_description::origin::Origin;
use armgen_description::source::Source;
use armgen_description::validate;
use sha2::{Digest, Sha256};

use certificate::report::{Report, Verdict};
use certificate::Certificate;
use floats::bounds;
use judge::checker::{Checker, Effort};
use judge::rounding::Trial;
use judge::{at_state, constants, identities, stated};
use read::claims::Claims;
use read::reader::{Constant, Module, ModuleText};
use textbook::equations::parameters::Vector;
use values::check::{parallel_map, Check};
use values::enclosure::Float;
use values::formula::Formula;
use values::program::{JOINTS, MOTORS, NOMINAL_GRAVITY, TIPS};

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
    let mut module = Module::read(text)?;
    if let Some(Constant::Text(name)) = module.constants.get("NAME") {
        if *name != manipulator.name && Check::Robot.is_made() {
            return Err(format!("NAME: the module is of the robot `{name}`, the description of `{}`", manipulator.name));
        }
    }
    match (module.sizes().gravity, manipulator.gravity_is_argument) {
        (true, false) => return Err(format!("{NOMINAL_GRAVITY}: gravity is no argument in the description")),
        (false, true) => return Err(format!("{NOMINAL_GRAVITY} is missing: gravity is an argument in the description")),
        _ => {}
    }
    match (module.constants.contains_key(JOINTS), manipulator.coupling.is_some()) {
        (true, false) => return Err(format!("{JOINTS}: no joint is coupled in the description")),
        (false, true) => return Err(format!("{JOINTS} is missing: joints are coupled in the description")),
        _ => {}
    }
    match (module.constants.contains_key(MOTORS), constants::has_motor_rates(&manipulator)) {
        (true, false) => return Err(format!("{MOTORS}: each motor turns with one coordinate in the description")),
        (false, true) => return Err(format!("{MOTORS} is missing: motors turn with several coordinates in the description")),
        _ => {}
    }
    match (module.constants.contains_key(TIPS), manipulator.tips.is_empty()) {
        (true, true) => return Err(format!("{TIPS}: the end effector has no name in the description")),
        (false, false) => return Err(format!("{TIPS} is missing: the end effectors have names in the description")),
        (true, false) if module.constants.contains_key("TASK") => {
            return Err(format!("TASK stands beside {TIPS}: each end effector has a task of its own"));
        }
        _ => {}
    }
    let vector = Vector::of(&manipulator, &constants::parameter_names(&module))?;
    let claims = claims.used(&module, &constants::claimed_constants(&vector, &module));
    constants::name_angles(&mut module, &manipulator, &claims);
    let base = constants::base_parameters(&manipulator, &claims, &module);
    let checker = Checker::new(manipulator, vector, claims, effort, &module, base)?;
    Ok(Prepared { module, checker })
}

/// Verifies the text of a module against the text of its description, with the exact values of literals that a certificate lists.
///
/// The certificate needs no trust. It must equal the certificate of the report: each difference is a fault. Where it does not fit the texts, no
/// function is reported. Faults of the description are rendered into [`Report::faults`].
pub fn verify<'a>(source: &Source, text: impl Into<ModuleText<'a>>, certificate: &Certificate) -> Report {
    let text = text.into();
    let report = Report::of(hash(source.text()), hash(text.text));
    let claims = Module::read(text)
        .map_err(|fault| vec![fault.into()])
        .and_then(|module| certificate.claims_for(&module, &report.input, &report.output));
    match claims {
        Ok(claims) => {
            let mut report = verify_with(source, text, claims, Effort::default());
            if report.passed() {
                report.faults = certificate.differences(&Certificate::of(&report));
            }
            report
        }
        Err(faults) => Report { faults, ..report },
    }
}

/// The arm of a description. Faults that only equations show are not looked for: whatever the arm, its equations are derived here and compared.
fn arm(source: &Source) -> Result<Manipulator, String> {
    let (read, diagnostics) = validate::structure(source, Scalar::F64).finish();
    read.map(|(manipulator, _)| manipulator).ok_or_else(|| diagnostics.render(source, Colour::Never))
}

/// Proves the timing of a path: a file of `armgen time --json`, of the arm of a description.
///
/// # Errors
/// What is not proved, with its place, or why a text cannot be read.
pub fn verify_timing(source: &Source, text: &str) -> Result<timing::Proved, String> {
    timing::check(&arm(source)?, text)
}

/// Verifies with chosen claims and effort.
pub fn verify_with<'a>(source: &Source, text: impl Into<ModuleText<'a>>, claims: Claims, effort: Effort) -> Report {
    let text = text.into();
    let mut report = Report::of(hash(source.text()), hash(text.text));
    let manipulator = match arm(source) {
        Ok(manipulator) => manipulator,
        Err(faults) => return Report { faults: vec![faults], ..report },
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
    test_kit::test_kit(&arm(source)?, &Module::read(text)?, import, &Origin::of(source))
}

/// The same for a module in another language than Rust; `name` is what the module is called where it is taken in: a file of C or JavaScript, a
/// module of Python, a package of MATLAB.
pub fn test_kit_in(source: &Source, text: ModuleText<'_>, name: &str) -> Result<String, String> {
    test_kit::in_language(&arm(source)?, &Module::read(text)?, text.language, name, &Origin::of(source))
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
    if let Some(chosen) = module.chosen() {
        report.left_out = checker.lacking(module).into_iter().filter(|name| !chosen.contains(name)).collect();
        report.identities.retain(|identity| identity.holds != Err(identities::ABSENT.into()));
    }
    report.faults.extend(stated::faults(module, report));
    debug_assert!(report.functions.iter().all(|f| f.verdict != Verdict::Equal || f.points > 0));
}
