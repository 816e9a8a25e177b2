//! Whether an emitted module is right: a certificate that its text equals the equations of its description.
//!
//! ```text
//! text of the module   -> reader    -> constants and straight-line programs
//! text of robot.yaml   -> Manipulator -> equations, the plain way, at random points
//! programs at these points = equations there, exactly; every literal the float nearest to the exact value it is run with
//! ```
//!
//! Shared with the generator is the reading of robot.yaml into a [`Manipulator`](armgen_codegen::manipulator::Manipulator), its numbers taken
//! over as text ([`formula`]), and nothing after it: no expression, no field, no derivation, no optimiser, no emitter. The exact values of
//! literals come from the generator or from a certificate, and need no trust ([`claims`]).
//!
//! What is not covered: that the compiler and libm do what they promise, the size of rounding errors, and documentation comments.

pub mod arithmetic;
pub mod checker;
pub mod claims;
pub mod constants;
pub mod contract;
pub mod enclosure;
pub mod equations;
pub mod formula;
pub mod identities;
pub mod program;
pub mod reader;
pub mod reference;
pub mod report;

use armgen_codegen::manipulator::{self, Manipulator, Scalar};
use armgen_codegen::source::Source;
use sha2::{Digest, Sha256};

use checker::{Checker, Effort};
use claims::Claims;
use contract::Promise;
use enclosure::Float;
use equations::parameters::Vector;
use formula::Formula;
use reader::Module;
use report::{Report, Verdict};

/// SHA-256 of a text, hexadecimal.
pub fn hash(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A seed that follows from both texts: random points that neither can have been written for.
fn seed(input: &str, output: &str) -> u64 {
    u64::from_str_radix(&hash(&format!("{input} {output}"))[..16], 16).unwrap_or(0)
}

/// The module read and the equations at random points, ready to be compared.
pub struct Prepared {
    /// The module.
    pub module: Module,
    /// The equations.
    pub checker: Checker,
}

/// Reads a module and prepares the equations of its arm.
pub fn prepare(manipulator: Manipulator, text: &str, claims: Claims, effort: Effort) -> Result<Prepared, String> {
    let module = Module::read(text)?;
    let vector = Vector::of(&manipulator, &constants::parameter_names(&module))?;
    let extras = module.functions.iter().any(|(name, _)| Promise::of(name).is_some_and(|(promise, _)| !promise.required));
    let checker = Checker::new(manipulator, vector, claims, effort, extras)?;
    Ok(Prepared { module, checker })
}

/// Verifies the text of a module against the text of its description, with claimed exact values for its literals.
///
/// Faults of the description are rendered into [`Report::faults`].
pub fn verify(source: &Source, text: &str, claims: Claims, effort: Effort) -> Report {
    let (input, output) = (hash(source.text()), hash(text));
    let mut report = Report {
        robot: String::new(),
        scalar: String::new(),
        faults: Vec::new(),
        constants: Vec::new(),
        functions: Vec::new(),
        identities: Vec::new(),
        input,
        output,
    };
    let (read, diagnostics) = manipulator::read_for(source, Scalar::F64);
    let Some((manipulator, _)) = read else {
        report.faults.push(diagnostics.render(source, armgen_codegen::diagnostic::Colour::Never));
        return report;
    };
    report.robot.clone_from(&manipulator.name);
    let effort = Effort { seed: effort.seed ^ seed(&report.input, &report.output), ..effort };
    match prepare(manipulator, text, claims, effort) {
        Ok(prepared) => fill(&mut report, &prepared),
        Err(fault) => report.faults.push(fault),
    }
    report
}

fn fill(report: &mut Report, prepared: &Prepared) {
    let Prepared { module, checker } = prepared;
    report.scalar = match module.real {
        Float::F64 => "f64".into(),
        Float::F32 => "f32".into(),
    };
    let nominal = constants::nominal_parameters(checker.manipulator(), checker.vector(), checker.claims(), module);
    let nominal: Vec<Formula> = nominal.unwrap_or_default();
    report.constants = constants::check(checker, module, &nominal);
    report.functions = checker.functions(module);
    report.identities = identities::check(checker, module, &report.functions, &nominal);
    debug_assert!(report.functions.iter().all(|f| f.verdict != Verdict::Equal || f.points > 0));
}
