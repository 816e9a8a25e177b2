//! Uses of both generator and checker. The generator proposes exact values of literals; the independent checker decides.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use armgen_codegen::source::Source;
//! let source = Source::new("robot.yaml", std::fs::read_to_string("robot.yaml")?);
//! let report = armgen_certify::verify(&source, &std::fs::read_to_string("robot.rs")?, None);
//! println!("{report}");
//! std::fs::write("robot.cert.json", armgen_verify::certificate::Certificate::of(&report).to_json())?;
//! # Ok(())
//! # }
//! ```

// The unit tests of the checker take this file in, and execute nothing.
#[cfg(not(test))]
mod executed;

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::diagnostic::{Colour, Diagnostics};
use armgen_codegen::emit::c::print_solver;
use armgen_codegen::emit::rust::print_inverse_kinematics;
use armgen_codegen::emit::{Language, Notes, Origin};
use armgen_codegen::exact::Number;
use armgen_codegen::inverse_kinematics as construction;
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::{Joint, Manipulator, Placement};
use armgen_codegen::pass::{Pass, Passes};
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Generated, Scalar};
use armgen_verify::certificate::report::Report;
use armgen_verify::certificate::Certificate;
use armgen_verify::floats::companion::Extent;
use armgen_verify::inverse_kinematics::{self, Proposal, Values};
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::{Module, ModuleText};
use armgen_verify::values::enclosure::Float;
use armgen_verify::{floats::bounds, floats::companion, hash, verify_with};

#[cfg(not(test))]
pub use executed::verify_executed;

/// Verifies the text of a module against the text of its description.
///
/// The exact values of literals come from `certificate` or, without it, from a run of the generator; the checker trusts neither.
/// A certificate must equal the certificate of the report; each difference is a fault.
/// [`Report::faults`] also contains rendered faults of the description.
pub fn verify<'a>(source: &Source, text: impl Into<ModuleText<'a>>, certificate: Option<&Certificate>) -> Report {
    let text = text.into();
    let refused = |fault: String| Report { faults: vec![fault], ..Report::of(hash(source.text()), hash(text.text)) };
    let module = match Module::read(text) {
        Ok(module) => module,
        Err(fault) => return refused(fault.into()),
    };
    if let Err(faults) = valid(source) {
        return refused(faults);
    }
    let Some(certificate) = certificate else { return verify_by_generator(source, text, &module) };
    let report = armgen_verify::verify(source, text, certificate);
    if !report.functions.is_empty() {
        return report;
    }
    // The certificate does not match the texts. A run of the generator still shows which function is wrong, if any.
    let by_generator = verify_by_generator(source, text, &module);
    let others: Vec<String> = report.faults.into_iter().filter(|fault| !by_generator.faults.contains(fault)).collect();
    Report { faults: [by_generator.faults, others].concat(), ..by_generator }
}

/// Verifies a freshly generated module against its description.
pub fn certify(source: &Source, generated: &Generated) -> Report {
    certify_in(source, generated, Language::Rust)
}

/// The same for the module in another language.
pub fn certify_in(source: &Source, generated: &Generated, language: Language) -> Report {
    let text = generated.in_language(language);
    let text = ModuleText { language, text: &text };
    verify_by_constants(source, text, Claims::from_numbers(&generated.constants))
}

/// The diagnostic that a function's value can exceed the scalar's range within the joint limits, with its position.
pub fn beyond_the_scalar(source: &Source, function: &str, scalar: Scalar) -> Diagnostics {
    let (read, mut diagnostics) = validate::read_for(source, scalar);
    if let Some((manipulator, places)) = read {
        diagnostics = Diagnostics::default();
        diagnostics.push(validate::values_leave_the_scalar(&manipulator, &places, scalar, function));
    }
    diagnostics
}

/// Adds the error bounds of all functions to the documentation of a generated module: see [`bounds`](mod@bounds).
pub fn document_bounds(source: &Source, generated: &mut Generated) -> Result<(), String> {
    let manipulator = valid(source)?;
    let module = Module::read(&generated.module)?;
    let found = bounds::of(&manipulator, &module, &Claims::from_numbers(&generated.constants)?);
    let bounds::Notes { head, functions } = bounds::notes(&found, module.sizes().gravity);
    generated.annotate(&Notes { head, functions });
    Ok(())
}

/// The companion of a generated module, with a running error bound for each function: see [`companion`](mod@companion). `import` must
/// bring the module's types into scope: `use super::robot::*;`.
pub fn companion(generated: &Generated, import: &str) -> Result<String, String> {
    companion::companion(&Module::read(&generated.module)?, &Claims::from_numbers(&generated.constants)?, import)
}

/// The final part of the companion for emitted inverse kinematics: see [`companion::of_inverse_kinematics`].
pub fn companion_of_inverse_kinematics(generated: &Generated) -> Result<String, String> {
    let extent = generated.solvers().next().map_or_else(Extent::default, |solver| extent(&solver.solved().arm));
    Ok(companion::of_inverse_kinematics(&Module::read(&generated.module)?, extent))
}

/// The sizes of an arm for the bound of inverse kinematics.
fn extent(arm: &Manipulator) -> Extent {
    let origin = |frame: &Placement| frame.translation.each_ref().map(|length| nominal(arm, length));
    let is_beside = |[x, y]: &[Number; 2]| !(x.is_zero() && y.is_zero());
    let turns = |joint: &Joint| joint.kind == JointKind::Revolute;
    let beside = arm.joints.iter().filter(|joint| turns(joint)).filter_map(|joint| {
        let [x, y, _] = origin(&joint.link_frame);
        let of_base = || std::array::from_fn(|_| Number::zero());
        let before = joint.parent.map_or_else(of_base, |parent| origin(&arm.joints[parent.index()].link_frame));
        let place = origin(&joint.placement);
        // Across the axis, in the joint frame.
        let across = |axis: usize| {
            (0..3).fold(Number::zero(), |sum, k| {
                let along = &before[k] - &place[k];
                sum.plus(&joint.placement.rotation[k][axis].times(&along))
            })
        };
        (is_beside(&[x.clone(), y.clone()]) && is_beside(&[across(0), across(1)])).then(|| x.to_f64().hypot(y.to_f64()))
    });
    let change = |joint: usize| match &arm.coupling {
        None => 1.0,
        Some(coupling) => coupling.variables[joint].factors.iter().map(|(_, factor)| factor.to_f64().abs()).sum(),
    };
    let path = arm.path_to(arm.tip.index());
    let of = |turning: bool| {
        let those = path.iter().filter(|&&joint| turns(&arm.joints[joint]) == turning);
        1.000_001 * those.map(|&joint| change(joint)).sum::<f64>()
    };
    Extent { lever: beside.fold(0.0, f64::max), turning: of(true), sliding: of(false) }
}

/// Verifies a module of inverse kinematics against its description, and counts solutions at this number of rational poses.
pub fn verify_inverse_kinematics(source: &Source, text: &str, poses: usize) -> inverse_kinematics::Report {
    match valid(source).and_then(|manipulator| proposal(source, &manipulator, text)) {
        Ok(proposal) => inverse_kinematics::verify(source, text, &proposal, poses),
        Err(faults) => inverse_kinematics::Report {
            input: hash(source.text()),
            output: hash(text),
            faults: vec![faults],
            ..inverse_kinematics::Report::default()
        },
    }
}

/// The generator's exact values and texts for inverse kinematics, in the language and scalar of `text`, of the end effector that it names.
///
/// # Errors
/// An end effector that the arm does not have.
pub fn proposal(source: &Source, manipulator: &Manipulator, text: &str) -> Result<Proposal, String> {
    let solved = match inverse_kinematics::end_effector(manipulator, text)? {
        Some(tip) => construction::Solved::at(manipulator, tip),
        None => construction::Solved::all(manipulator).swap_remove(0),
    };
    let (scalar, origin) = (inverse_kinematics::scalar_of(text), Origin::of(source));
    let c = inverse_kinematics::is_c(text).then(|| print_solver(&solved, scalar, &origin));
    Ok(Proposal {
        rust: print_inverse_kinematics(&solved, scalar, &origin),
        c,
        values: solved.found.as_ref().map(values).map_err(Clone::clone),
    })
}

/// The exact values of a construction, in the order of its text.
fn values(found: &construction::InverseKinematics) -> Values {
    let numbers = |way: &construction::Arrangement| {
        let frames = way.links.iter().chain([&way.before, &way.after]).flatten().flatten();
        frames.chain(way.offsets.iter().flatten()).cloned().collect()
    };
    let given = found.given().into_iter().flat_map(|given| [&given.before, &given.after]).flatten().flatten();
    Values {
        loops: found.loops().iter().map(numbers).collect(),
        own: found.own.as_ref().map(numbers),
        given: given.cloned().collect(),
        length: found.length.clone(),
        coordinates: found.coordinates.as_ref().map(|of| (of.coordinates.factors.clone(), of.coordinates.offset.clone())),
    }
}

/// The arm of a valid description, or its faults in words.
fn valid(source: &Source) -> Result<Manipulator, String> {
    let (read, diagnostics) = validate::read(source);
    read.map(|(manipulator, _)| manipulator).ok_or_else(|| diagnostics.render(source, Colour::Never))
}

/// Verifies with the generator's constants. A module that was generated without some passes has other constants; its head names them.
fn verify_by_generator(source: &Source, text: ModuleText<'_>, module: &Module) -> Report {
    let without = module.listed("without").iter().flatten().filter_map(|name| Pass::named(name)).collect();
    verify_by_constants(source, text, generated_claims(source, module.real, without))
}

/// Verifies with the generator's constants, unless the checker cannot read them.
fn verify_by_constants(source: &Source, text: ModuleText<'_>, claims: Result<Claims, String>) -> Report {
    match claims {
        Ok(claims) => verify_with(source, text, claims, Effort::default()),
        Err(fault) => Report {
            faults: vec![format!("the constants of the generator: {fault}")],
            ..Report::of(hash(source.text()), hash(text.text))
        },
    }
}

/// The constants of the generator for a scalar, without some passes.
fn generated_claims(source: &Source, real: Float, without: Passes) -> Result<Claims, String> {
    let scalar = match real {
        Float::F32 => Scalar::F32,
        Float::F64 => Scalar::F64,
    };
    #[allow(clippy::needless_update)]
    let options = Options { scalar, without, ..Default::default() };
    let (generated, _) = armgen_codegen::generate(source, &options);
    generated.map_or(Ok(Claims::none()), |generated| Claims::from_numbers(&generated.constants))
}
