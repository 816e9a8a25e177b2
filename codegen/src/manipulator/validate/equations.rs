//! Faults of a description that only its equations show: the diagnostics about them, given what was found.
//!
//! - tau is not linear in the names that `regressor` lists together (a length, say, or a mass and its centre of mass both):
//!   [`nonlinear`].
//! - No joint moves any row of the task that the file writes: [`immovable_task`].
//! - The inertia matrix B(q) is singular for every q (a massless last link without inertia, say): [`singular_inertia`].

use super::{Places, Role};
use crate::diagnostic::{Code, Diagnostic};
use crate::manipulator::{Manipulator, ParameterId, RegressorChoice};
use crate::source::Span;

/// tau is not linear in `parameter`: it occurs with a power, or multiplied by `other`, which is listed too.
/// `None` if the regressor does not list `parameter`.
pub fn nonlinear(
    manipulator: &Manipulator,
    places: &Places,
    parameter: ParameterId,
    other: Option<ParameterId>,
) -> Option<Diagnostic> {
    let RegressorChoice::Names(names) = &manipulator.regressor else { return None };
    let listed = |id: ParameterId| names.iter().position(|n| *n == id).and_then(|i| places.regressor_names.get(i).copied());
    let name = |id: ParameterId| manipulator.parameters.get(id.0 as usize).map_or("", |p| p.name.as_str());
    let span = listed(parameter)?;
    let (message, help) = match other.filter(|other| *other != parameter) {
        Some(other) => (
            format!(
                "the torques are not linear in `{}` and `{}` together: they occur multiplied by each other",
                name(parameter),
                name(other)
            ),
            "take one of the two off the list: it stays the number that it is; or list a name for their product instead"
                .to_owned(),
        ),
        None => (
            format!("the torques are not linear in `{}`: it occurs in a power or product of itself", name(parameter)),
            format!("take `{}` off the list: it stays the number that it is", name(parameter)),
        ),
    };
    let mut diagnostic = Diagnostic::new(Code::NonlinearParameter, span, message, "cannot have a column", help);
    if let Some(other) = other.filter(|other| *other != parameter).and_then(listed) {
        diagnostic = diagnostic.also(other, "listed with it");
    }
    // The most telling use: a geometric one, if there is one.
    let geometric =
        |role: Role| matches!(role, Role::Length | Role::CentreOfMass | Role::Gravity | Role::Ratio | Role::RotorPosition);
    let uses = places.uses.get(parameter.0 as usize).map_or(&[][..], Vec::as_slice);
    if let Some(found) = uses.iter().find(|u| geometric(u.role)).or(uses.first()) {
        diagnostic = diagnostic.also(found.span, format!("enters here as {}", found.role.text()));
    }
    Some(diagnostic)
}

/// No joint moves any row of the task. `None` if the file writes no task.
pub fn immovable_task(manipulator: &Manipulator, places: &Places) -> Option<Diagnostic> {
    let span = places.task_rows.iter().copied().reduce(Span::to).or(places.task)?;
    let rows: Vec<&str> = manipulator.task.iter().map(|row| row.name()).collect();
    let message = format!("no joint moves any row of the task ({})", rows.join(", "));
    let help = "name rows that the arm can move: x y z are along, rx ry rz about the axes of the base frame";
    Some(Diagnostic::new(Code::ImmovableTask, span, message, "zero for every q", help))
}

/// B(q) is singular for every q, because `joint` (by index) accelerates nothing beyond what the joints before it do.
pub fn singular_inertia(manipulator: &Manipulator, places: &Places, joint: usize) -> Option<Diagnostic> {
    let at = places.joints.get(joint)?;
    let name = manipulator.joints.get(joint).map_or("", |j| j.name.as_str());
    let message = format!("the inertia matrix is singular for every q: joint `{name}` moves no inertia");
    let help = "give its link (or one after it) mass or inertia about the joint axis, or the joint a motor with inertia; without any, its acceleration is undefined";
    Some(
        Diagnostic::new(Code::SingularInertia, at.name, message, "moves nothing that has inertia", help)
            .also(at.link, "this link"),
    )
}
