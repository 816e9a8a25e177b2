//! End effectors, task, regressor and inverse kinematics: rows and names, each at most once, each known.

use super::number::text_of;
use super::places::Role;
use super::{bodies, geometry, Context, FirstSeen};
use crate::description::{JointDescription, PosturesDescription, RegressorDescription, RobotDescription};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::document::excerpt;
use crate::exact::Polynomial;
use crate::kinds::TaskRow;
use crate::manipulator::{GivenBeside, LinkId, Pose, Postures, RegressorChoice, Tip};
use crate::source::{Span, Spanned};
use crate::suggest::did_you_mean;

/// After so many unknown names no more is guessed about what was meant: each guess compares the name with all that are defined.
const GUESSES: usize = 50;

/// The rows, all six where the file names none.
pub(super) fn task(task: Option<&Spanned<Vec<Spanned<TaskRow>>>>, diagnostics: &mut Diagnostics) -> Vec<TaskRow> {
    let Some(task) = task else { return TaskRow::ALL.to_vec() };
    let mut seen = FirstSeen::new();
    let mut rows = Vec::new();
    for row in &task.value {
        let name = row.value.name();
        if let Some(first) = seen.get(name) {
            let message = format!("the task names the row `{name}` twice");
            let help = "each row of the operational space stands once; the order is yours";
            diagnostics.push(
                Diagnostic::new(Code::DuplicateTaskRow, row.span, message, "the second one", help).also(*first, "the first one"),
            );
        } else {
            seen.insert(name, row.span);
            rows.push(row.value);
        }
    }
    rows
}

/// The joint whose link carries the end effector, the last one where the file names none.
pub(super) fn tip(description: &RobotDescription, diagnostics: &mut Diagnostics) -> Option<LinkId> {
    let joints = &description.joints.as_ref()?.value;
    let link = |place: usize| u32::try_from(place).ok().map(LinkId);
    let Some(tip) = &description.tip else { return link(joints.len().checked_sub(1)?) };
    let otherwise = "name the joint whose link carries the end effector, or leave the key out for the last one";
    carrier(joints, tip, "tip", otherwise, diagnostics)
}

/// The link of the joint that `key` names; `otherwise` is the remedy where no name is near.
pub(super) fn carrier(
    joints: &[JointDescription],
    named: &Spanned<String>,
    key: &str,
    otherwise: &str,
    diagnostics: &mut Diagnostics,
) -> Option<LinkId> {
    let names: Vec<&str> = joints.iter().filter_map(|joint| joint.name.as_ref()).map(|name| name.value.as_str()).collect();
    let place = joints.iter().position(|joint| joint.name.as_ref().is_some_and(|name| name.value == named.value));
    if place.is_none() {
        let message = format!("`{key}` names `{}`, which is no joint", excerpt(&named.value));
        let help = did_you_mean(&named.value, &names).map_or(otherwise.into(), |meant| format!("did you mean `{meant}`?"));
        diagnostics.push(Diagnostic::new(Code::UnknownTipJoint, named.span, message, "unknown joint", help));
    }
    u32::try_from(place?).ok().map(LinkId)
}

/// The end effectors with names; none where the file has none. Faults are reported.
pub(super) fn tips(description: &RobotDescription, context: &mut Context<'_>) -> Option<Vec<Tip>> {
    let described = description.tips.as_ref().map_or(&[][..], |tips| &tips.value);
    let mut tips = Some(Vec::new());
    for tip in described {
        let name = tip.name.as_ref();
        let called = name.map_or(String::new(), |name| format!(" of end effector `{}`", excerpt(&name.value)));
        let joints = description.joints.as_ref().map_or(&[][..], |joints| &joints.value);
        let otherwise = "name the joint whose link carries the end effector";
        let joint = tip.joint.as_ref().and_then(|joint| carrier(joints, joint, "joint", otherwise, context.diagnostics));
        let tool = geometry::pose(tip.tool.as_ref(), &format!("the tool{called}"), context);
        let load = |body| bodies::part(body, Some(Pose::identity()), &format!("the payload{called}"), context);
        let payload = tip.payload.as_ref().map(load);
        let task = task(tip.task.as_ref(), context.diagnostics);
        let inverse_kinematics = inverse_kinematics(&tip.inverse_kinematics, joints, context.diagnostics);
        let read = || {
            let payload = match payload {
                Some(body) => Some(body?),
                None => None,
            };
            Some(Tip { name: name?.value.clone(), joint: joint?, tool: tool?, payload, task, inverse_kinematics })
        };
        tips = tips.zip(read()).map(|(mut all, tip)| {
            all.push(tip);
            all
        });
    }
    tips
}

/// The word for the swivel angle.
const SWIVEL: &str = "swivel";

/// The choices for inverse kinematics.
pub(super) fn inverse_kinematics(
    asked: &PosturesDescription,
    joints: &[JointDescription],
    diagnostics: &mut Diagnostics,
) -> Postures {
    let mut postures = Postures { target: asked.target.as_ref().map(|target| target.value), given: None };
    let Some(given) = &asked.given else { return postures };
    // Faults of the joints are already reported.
    if joints.is_empty() {
        return postures;
    }
    let names: Vec<&str> = joints.iter().filter_map(|joint| joint.name.as_ref()).map(|name| name.value.as_str()).collect();
    let place = joints.iter().position(|joint| joint.name.as_ref().is_some_and(|name| name.value == given.value));
    postures.given = place.and_then(|place| u32::try_from(place).ok()).map(|place| GivenBeside::Joint(LinkId(place)));
    // A joint of that name comes first.
    if postures.given.is_none() && given.value == SWIVEL {
        postures.given = Some(GivenBeside::Swivel);
    }
    if postures.given.is_none() {
        let shown = excerpt(&given.value);
        let message = format!("`given` names `{shown}`, which is no joint");
        let help = match did_you_mean(&given.value, &names) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => "name a joint of an arm with one joint too many, say `swivel`, or leave the key out".into(),
        };
        diagnostics.push(Diagnostic::new(Code::UnknownGivenJoint, given.span, message, "unknown joint", help));
    }
    postures
}

/// The regressor's columns, as far as they can be judged without the equations.
pub(super) fn regressor(description: &RobotDescription, context: &mut Context<'_>) -> Option<RegressorChoice> {
    let names = match description.regressor.as_ref().map(|r| &r.value) {
        None if description.regressor.is_none() => return Some(RegressorChoice::Standard),
        None => return None,
        Some(RegressorDescription::Standard) => return Some(RegressorChoice::Standard),
        Some(RegressorDescription::Base) => return Some(RegressorChoice::Base),
        Some(RegressorDescription::Names(names)) => names,
    };
    let mut seen = FirstSeen::new();
    let mut symbols = Vec::new();
    let mut faults = Vec::new();
    let parameters = &context.evaluator.parameters;
    let known = parameters.names();
    let mut guesses = 0..GUESSES;
    for name in names {
        let shown = excerpt(&name.value);
        if let Some(first) = seen.get(name.value.as_str()) {
            let message = format!("the regressor lists `{shown}` twice");
            let fault =
                Diagnostic::new(Code::RepeatedParameter, name.span, message, "the second one", "each parameter has one column");
            faults.push(fault.also(*first, "the first one"));
            continue;
        }
        seen.insert(&name.value, name.span);
        let Some(entry) = parameters.get(&name.value) else {
            let help = match guesses.next().and_then(|_| did_you_mean(&name.value, &known)) {
                Some(meant) => format!("did you mean `{meant}`? Otherwise define it under `parameters`"),
                None if name.value == "standard" || name.value == "base" => {
                    format!("write `regressor: {}`, without brackets", name.value)
                }
                None => {
                    format!("define it: a line `{shown}: ...` under `parameters`, and use it in the values that it stands for")
                }
            };
            let message = format!("the regressor lists `{shown}`, which is not defined under `parameters`");
            faults.push(Diagnostic::new(Code::UnknownParameter, name.span, message, "unknown parameter", help));
            continue;
        };
        if let Some((place, reason)) = entry.number {
            let message = format!("the torques are not linear in `{shown}`: it enters {}", reason.text());
            let value = entry.nominal.as_ref().map_or_else(String::new, |n| format!(" ({})", text_of(n)));
            let help = format!("take `{shown}` off the list: it stays the number that it is{value}");
            let fault = Diagnostic::new(Code::NonlinearParameter, name.span, message, "cannot have a column", help);
            faults.push(fault.also(place, format!("enters here {}", reason.text())));
            continue;
        }
        symbols.extend(entry.symbol);
    }
    for fault in faults {
        context.diagnostics.push(fault);
    }
    Some(RegressorChoice::Names(symbols))
}

/// Reports names that would be entries of the parameter vector and, in the nominal value of `gravity`, of another argument.
pub(super) fn gravity_argument(
    description: &RobotDescription,
    gravity: &[Polynomial; 3],
    regressor: &RegressorChoice,
    context: &mut Context<'_>,
) {
    let (RegressorChoice::Names(listed), true) = (regressor, description.gravity_is_argument) else { return };
    let mut faults = Vec::new();
    for entry in &context.evaluator.parameters.entries {
        let Some(id) = entry.symbol.filter(|id| listed.contains(id)) else { continue };
        if !gravity.iter().any(|component| component.terms().any(|(powers, _)| powers.iter().any(|(name, _)| *name == id))) {
            continue;
        }
        let shown = excerpt(entry.name);
        let message = format!("`{shown}` is part of `gravity`, which is an argument, and the regressor lists it");
        let help = format!(
            "take `{shown}` off the list: it is then a number of the nominal gravity; \
             or write `gravity` as a list without `argument`: it then changes with the parameters"
        );
        let direct = entry.uses.iter().find(|found| found.role == Role::Gravity).map(|found| found.span);
        let whole = description.gravity.as_ref().map_or_else(Span::default, |gravity| gravity.span);
        let fault = Diagnostic::new(Code::GravityArgument, direct.unwrap_or(whole), message, "an argument", help);
        faults.push(fault.also(entry.span, "a parameter, which is an argument too"));
    }
    for fault in faults {
        context.diagnostics.push(fault);
    }
}
