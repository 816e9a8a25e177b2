//! [`RobotDescription`] -> [`Manipulator`]: every check that a description must pass, all faults reported together.
//!
//! ```text
//! names.rs       identifiers, reserved words, names used twice
//! parameters.rs  which names stay symbols, which are numbers, which abbreviate an expression
//! number.rs      expression -> exact number
//! nominal.rs     the same for who writes a description in another form
//! evaluate.rs    expression -> polynomial in the symbols
//! geometry.rs    angles, rows of joints, poses, rotations -> placements
//! frames.rs      where joint frames lie
//! bodies.rs      mass, centre of mass, inertia: no impossible body
//! parents.rs     the tree of links, and where rows start
//! closures.rs    points that two links share
//! coupling.rs    joints that follow others
//! joints.rs      limits, friction, spring
//! motors.rs      rotors: what carries them, and what they spin with
//! choices.rs     end effectors, task, regressor
//! places.rs      where things stand, for what is found out later
//! plausible.rs   values that can be, but hardly are meant
//! allow.rs       warnings that the file allows
//! ```
//!
//! Absent from here on: spans, conventions, expressions, impossible values. Faults that only equations show are left to who has equations: the
//! generator and the checker derive them each in its own way.

mod allow;
mod bodies;
mod choices;
mod closures;
mod coupling;
mod evaluate;
mod frames;
mod geometry;
mod joints;
mod motors;
mod names;
mod nominal;
mod number;
mod parameters;
mod parents;
mod places;
mod plausible;

use std::collections::BTreeMap;

use crate::description::{Convention, JointDescription, RobotDescription};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::exact::Polynomial;
use crate::kinds::{Scalar, MAX_JOINTS};
use crate::manipulator::{Joint, Manipulator, Pose, RegressorChoice};
use crate::source::{Source, Span};
pub use allow::warning;
pub use bodies::impossible_inertia;
use evaluate::Evaluator;
pub use names::{is_free_name, is_rust_name, module_name};
pub use nominal::NominalValues;
use parameters::Parameters;
pub use places::{Closure, JointPlaces, Occurrence, Places, Role};
pub use plausible::{density_of_cuboid, doubt_of_density};

/// Most named quantities: more than all numbers of an arm with `MAX_JOINTS` joints.
pub const MAX_PARAMETERS: usize = 1024;

/// Most attached bodies of an arm: their exact tensors grow with every angle that is no multiple of pi/12.
pub const MAX_ATTACHED: usize = 256;

/// The content of a description before the derivation of its equations.
pub struct Structure {
    /// The arm and the places of its parts; none if a part of it could not be read.
    pub arm: Option<(Manipulator, Places)>,
    /// All diagnostics, in the order in which they were found.
    pub diagnostics: Diagnostics,
    /// Kinds of warnings that the file allows.
    allowed: Vec<String>,
}

impl Structure {
    /// The arm, and all diagnostics in the order of the text. There is an arm if and only if no diagnostic is an error.
    pub fn finish(self) -> (Option<(Manipulator, Places)>, Diagnostics) {
        let Structure { arm, mut diagnostics, allowed } = self;
        diagnostics.allow(&allowed);
        assert!(arm.is_some() || diagnostics.has_errors(), "what is no arm has a fault that says why");
        diagnostics.sort();
        (arm.filter(|_| !diagnostics.has_errors()), diagnostics)
    }
}

/// Every check of a description that needs no equations; numbers must fit `scalar`.
pub fn structure(source: &Source, scalar: Scalar) -> Structure {
    let (description, mut diagnostics) = RobotDescription::parse(source);
    let allowed = description.as_ref().map_or_else(Vec::new, |d| allow::check(&d.allow, &mut diagnostics));
    let arm = description.and_then(|d| validate(source, &d, scalar, &mut diagnostics));
    Structure { arm, diagnostics, allowed }
}

/// Everything that the parts of the validation share.
struct Context<'d> {
    source: &'d Source,
    evaluator: Evaluator<'d>,
    diagnostics: &'d mut Diagnostics,
    /// Inertias with only one moment, collected for a single warning.
    planar: Vec<(Span, String)>,
    /// Whether tensors that no body has are taken as written.
    inertia_as_written: bool,
}

impl Context<'_> {
    fn report(&mut self, code: Code, span: Span, message: impl Into<String>, label: impl Into<String>, help: impl Into<String>) {
        self.diagnostics.push(Diagnostic::new(code, span, message, label, help));
    }
}

fn validate(
    source: &Source,
    description: &RobotDescription,
    scalar: Scalar,
    diagnostics: &mut Diagnostics,
) -> Option<(Manipulator, Places)> {
    let complete = !diagnostics.has_errors();
    names::check(description, diagnostics);
    if let Some(parameter) = description.parameters.get(MAX_PARAMETERS) {
        let message =
            format!("{} named quantities are more than the {MAX_PARAMETERS} that can be kept", description.parameters.len());
        let help = "give names to what several values share or what the regressor lists; write the others out";
        let label = format!("name {}", MAX_PARAMETERS + 1);
        diagnostics.push(Diagnostic::new(Code::TooLarge, parameter.name.span, message, label, help));
        return None;
    }
    let parameters = Parameters::resolve(description, scalar, diagnostics);
    let evaluator = Evaluator::new(parameters, scalar);
    let inertia_as_written = allow::takes_inertia_as_written(&description.allow);
    let mut context = Context { source, evaluator, diagnostics, planar: Vec::new(), inertia_as_written };
    let convention = description.convention.as_ref().map(|c| c.value);
    let gravity = description.gravity.as_ref().and_then(|g| context.polynomials(&g.value));
    let joints = joints(description, &mut context);
    let coupling = coupling::resolve(description.joints.as_ref().map_or(&[][..], |joints| &joints.value), &mut context);
    let tool = geometry::pose(description.tool.as_ref(), "the tool", &mut context);
    let payload = description.payload.as_ref().map(|p| bodies::part(p, Some(Pose::identity()), "the payload", &mut context));
    let tips = choices::tips(description, &mut context);
    let tip = choices::tip(description, context.diagnostics);
    let task = choices::task(description.task.as_ref(), context.diagnostics);
    let regressor = choices::regressor(description, &mut context);
    if let (Some(gravity), Some(regressor)) = (&gravity, &regressor) {
        choices::gravity_argument(description, gravity, regressor, &mut context);
    }
    let described = description.joints.as_ref().map_or(&[][..], |joints| &joints.value);
    let inverse_kinematics = choices::inverse_kinematics(&description.inverse_kinematics, described, context.diagnostics);
    let closures = closures::closures(description, &mut context);
    bodies::warn_of_planar(&mut context);
    // An unreadable expression may use any name.
    if complete {
        context.evaluator.parameters.warn_of_unused(context.diagnostics);
    }
    if context.diagnostics.has_errors() {
        return None;
    }
    let (mut joints, tool, tip, tips, coupling) = (joints?, tool?, tip?, tips?, coupling?);
    let parents: Vec<Option<usize>> = joints.iter().map(|joint| joint.parent.map(|parent| parent.index())).collect();
    let bare = [(tip.index(), description.tool.as_ref())];
    let named = description.tips.iter().flat_map(|described| tips.iter().zip(&described.value));
    let named: Vec<_> = named.map(|(tip, described)| (tip.joint.index(), described.tool.as_ref())).collect();
    plausible::check(description, &parents, if named.is_empty() { &bare } else { &named }, &mut context);
    let symbols = context.evaluator.parameters.symbols();
    let ends: Vec<_> = match tips.as_slice() {
        [] => vec![(tip.index(), &tool)],
        tips => tips.iter().map(|tip| (tip.joint.index(), &tip.tool)).collect(),
    };
    frames::lay(&mut joints, &ends, convention == Some(Convention::Urdf), &symbols);
    let places = places::gather(description, context.evaluator.parameters.places_of_symbols(), closures?);
    let coupling = coupling.map(|mut coupling| {
        coupling.find_sums(&joints);
        coupling
    });
    let mut manipulator = Manipulator {
        name: description.name.as_ref()?.value.clone(),
        parameters: symbols,
        gravity: gravity?,
        gravity_is_argument: description.gravity_is_argument,
        joints,
        tip,
        tool,
        payload: match payload {
            Some(body) => Some(body?),
            None => None,
        },
        task,
        regressor: regressor?,
        inverse_kinematics,
        tips,
        coupling,
    };
    if !manipulator.tips.is_empty() {
        manipulator = manipulator.at(0);
    }
    if manipulator.is_massless() {
        // There are no torques that a regressor could be of.
        manipulator.regressor = RegressorChoice::Names(Vec::new());
    }
    plausible::check_holding(description, &manipulator, &mut context);
    Some((manipulator, places))
}

/// The joints, if all of them are valid.
fn joints(description: &RobotDescription, context: &mut Context<'_>) -> Option<Vec<Joint>> {
    let list = description.joints.as_ref()?;
    if list.value.is_empty() {
        let help = "write one `- name: ...` per joint, from base to tip, with type, a, alpha, d, theta and link";
        context.report(Code::NoJoints, list.span, "an arm has at least one joint", "no joint", help);
        return None;
    }
    if let Some(joint) = list.value.get(MAX_JOINTS) {
        let message = format!("{} joints are more than the {MAX_JOINTS} that can be generated", list.value.len());
        let help = "leave joints out that never move: they are parts of their links";
        context.report(Code::TooManyJoints, joint.span, message, format!("joint {}", MAX_JOINTS + 1), help);
        return None;
    }
    let attached = list.value.iter().filter_map(|joint| joint.link.as_ref()).flat_map(|link| &link.attached);
    if let Some(body) = attached.clone().nth(MAX_ATTACHED) {
        let message =
            format!("{} attached bodies are more than the {MAX_ATTACHED} of an arm: each is placed exactly", attached.count());
        let help = "write bodies that never move to each other as one, or leave out those too light to matter";
        context.report(Code::TooLarge, body.body.key, message, format!("body {}", MAX_ATTACHED + 1), help);
        return None;
    }
    let convention = description.convention.as_ref().map(|c| c.value);
    let base = geometry::pose(description.base.as_ref(), "the base", context);
    let parents = parents::resolve(&list.value, context.diagnostics);
    let mut valid = Some(Vec::new());
    for i in 0..list.value.len() {
        let parent = parents.as_ref().and_then(|parents| parents[i]);
        let base = base.as_ref().filter(|_| parents.is_some() && parent.is_none());
        let joint = joints::joint(i, &list.value, base, parent, convention, context);
        valid = valid.zip(joint).map(|(mut all, joint)| {
            all.push(joint);
            all
        });
    }
    valid.filter(|_| base.is_some() && parents.is_some())
}

/// How messages call a joint: by its name, else by its number.
fn call(i: usize, joint: &JointDescription) -> String {
    match &joint.name {
        Some(name) => format!("`{}`", crate::document::excerpt(&name.value)),
        None => format!("{}", i + 1),
    }
}

/// The zero vector.
fn zeros() -> [Polynomial; 3] {
    std::array::from_fn(|_| Polynomial::zero())
}

/// Places of first mention by name, to find those that stand twice.
type FirstSeen<'d> = BTreeMap<&'d str, Span>;

#[cfg(test)]
mod tests;
