//! The last part of validation: faults of a description that only its equations show.
//!
//! - tau is not linear in the names that `regressor` lists together (for instance a length, or both a mass and its centre of
//!   mass): second derivatives of tau.
//! - No joint moves any row of the task that the file writes: rows of the Jacobian that are identically zero.
//! - The base parameters, where `regressor` asks for them, are too long to be formed.
//! - The inertia matrix B(q) is singular for every q (for instance a massless last link without inertia): pivots of an elimination.
//! - Two links do not share a point that `closes` names, in every posture (`closures`).
//!
//! Each is decided exactly, in the prime field of the expressions' fingerprints.

mod closures;

use std::ops::Range;

use crate::derive::arm::Arm;
use crate::derive::base;
use crate::derive::constants::find_field;
use crate::derive::motion::Motion;
use crate::derive::newton_euler::inverse_dynamics;
use crate::derive::parameters::{ParameterVector, View};
use crate::derive::plan::Plan;
use crate::derive::quantities::{inertia, kinematics};
use crate::derive::regressor::derivative_by_parameter;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::exact::Number;
use crate::kinds::{ParameterId, Scalar};
use crate::manipulator::{Limits, Manipulator, RegressorChoice};
use crate::ring::field::{Element, Field, MOST_ROOTS};
use crate::ring::{ExprId, Pool, Symbol};
use crate::source::{Source, Span};
use armgen_description::validate::structure;
pub use armgen_description::validate::{
    density_of_cuboid, doubt_of_density, impossible_inertia, is_free_name, is_rust_name, module_name, warning, Closure,
    JointPlaces, NominalValues, Occurrence, Places, Role, MAX_PARAMETERS,
};

/// The arm that `source` describes, with the places of its parts, and all diagnostics, in the order of the text. There is an arm
/// if and only if no diagnostic is an error.
pub fn read(source: &Source) -> (Option<(Manipulator, Places)>, Diagnostics) {
    read_for(source, Scalar::F64)
}

/// As [`read`], with numbers that must fit `scalar`.
pub fn read_for(source: &Source, scalar: Scalar) -> (Option<(Manipulator, Places)>, Diagnostics) {
    let mut read = structure(source, scalar);
    if let Some((manipulator, places)) = &read.arm {
        check(manipulator, places, &mut read.diagnostics);
    }
    read.finish()
}

/// Reports every fault of a description that only its equations show.
fn check(manipulator: &Manipulator, places: &Places, diagnostics: &mut Diagnostics) {
    let Some(field) = find_field(manipulator) else {
        let message = "the numbers of this arm hold too many different square roots to work with them exactly";
        let help = format!(
            "use at most {MOST_ROOTS} different roots besides those of 2 and 3; write a length that is measured as the decimal that it is"
        );
        diagnostics.push(Diagnostic::new(Code::TooComplex, places.name, message, "the equations of this arm", help));
        return;
    };
    let mut found: Vec<Option<Diagnostic>> = Vec::new();
    for (one, other) in nonlinear_pairs(manipulator, &field) {
        found.push(nonlinear(manipulator, places, one, Some(other)));
    }
    let mut pool = Pool::new(field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Nominal);
    for (tip, place) in places.tasks.iter().enumerate() {
        let Some(place) = *place else { continue };
        let of_tip = if manipulator.tips.is_empty() { manipulator.clone() } else { manipulator.at(tip) };
        let arm = Arm::new(&mut pool, &of_tip, View::Nominal);
        let jacobian = kinematics::geometric_jacobian(&mut pool, &arm);
        let jacobian = arm.project_columns(&mut pool, jacobian);
        if of_tip.task.iter().all(|row| jacobian[row.index()].iter().all(|&e| e == ExprId::ZERO)) {
            found.push(Some(immovable_task(&of_tip, place)));
        }
    }
    found.extend(closures::open_loops(manipulator, &field, &places.closures).into_iter().map(Some));
    if manipulator.is_massless() {
        found.push(Some(no_dynamics(places)));
        found.into_iter().flatten().for_each(|diagnostic| diagnostics.push(diagnostic));
        return;
    }
    if manipulator.regressor == RegressorChoice::Base && base::base_parameters(manipulator, &field).is_none() {
        found.push(Some(long_combinations(places)));
    }
    let b = inertia::inertia_matrix(&mut pool, &arm, &mut Plan::default());
    let b = arm.project_matrix(&mut pool, b);
    let (pool, b) = arm.in_coordinates(pool, b.concat());
    let values = b.chunks(arm.coordinates()).map(|row| row.iter().map(|&e| pool.fingerprint(e)[0]).collect()).collect();
    let coordinates = manipulator.coordinates();
    let singular = zero_pivots(&field, values).into_iter().map(|a| singular_inertia(manipulator, places, coordinates[a].index));
    found.extend(singular);
    found.into_iter().flatten().for_each(|diagnostic| diagnostics.push(diagnostic));
}

/// Most names that are reported as nonlinear.
const REPORTED_NAMES: usize = 50;

/// Pairs of listed names, equal ones included, for which the second derivative of tau is not zero: for each name the first from
/// itself on. At most `REPORTED_NAMES` pairs.
fn nonlinear_pairs(manipulator: &Manipulator, field: &Field) -> Vec<(ParameterId, ParameterId)> {
    let RegressorChoice::Names(names) = &manipulator.regressor else { return Vec::new() };
    let vector = ParameterVector::named(manipulator, names);
    let mut pool = Pool::new(field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Vector(&vector));
    let motion = Motion::with_reference(&mut pool, &arm);
    let tau = inverse_dynamics(&mut pool, &arm, &motion);
    // Derivatives by many names at once: along a direction with a symbol of its own for each of them.
    let first = along(&mut pool, &tau, &(0..names.len()));
    if !depends(&mut pool, &first, &(0..names.len())) {
        return Vec::new();
    }
    let mut pairs = Vec::new();
    for one in 0..names.len() {
        if pairs.len() == REPORTED_NAMES {
            break;
        }
        let column = derivative_by_parameter(&mut pool, &tau, one as u16);
        let mut range = one..names.len();
        if !depends(&mut pool, &column, &range) {
            continue;
        }
        // The first name that the column holds, by halving: a few derivatives, not one for each name there is.
        while range.len() > 1 {
            let middle = range.start + range.len() / 2;
            range = if depends(&mut pool, &column, &(range.start..middle)) { range.start..middle } else { middle..range.end };
        }
        pairs.push((names[one], names[range.start]));
    }
    pairs
}

/// The directional derivative along the names in `range`; `Symbol::Torque(k)`, which tau does not contain, is the direction of name k.
fn along(pool: &mut Pool, exprs: &[ExprId], range: &Range<usize>) -> Vec<ExprId> {
    pool.differentiate(exprs, &mut |pool, symbol| match symbol {
        Symbol::Parameter(k) if range.contains(&usize::from(k)) => pool.symbol(Symbol::Torque(k)),
        _ => ExprId::ZERO,
    })
}

/// Whether one of them depends on one of the names in `range`.
fn depends(pool: &mut Pool, exprs: &[ExprId], range: &Range<usize>) -> bool {
    along(pool, exprs, range).iter().any(|&e| e != ExprId::ZERO)
}

/// The joints at which symmetric elimination of B, at a generic state, meets a pivot of 0. B is positive semidefinite: such a joint
/// accelerates nothing that the joints before it do not.
fn zero_pivots(field: &Field, mut b: Vec<Vec<Element>>) -> Vec<usize> {
    let n = b.len();
    let mut zero = Vec::new();
    for k in 0..n {
        if b[k][k] == field.zero() {
            zero.push(k);
            continue;
        }
        let inverse = field.inverse(b[k][k]);
        for i in k + 1..n {
            let factor = field.mul(b[i][k], inverse);
            for j in k + 1..n {
                b[i][j] = field.sub(b[i][j], field.mul(factor, b[k][j]));
            }
        }
    }
    zero
}

/// tau is not linear in `parameter`: it occurs with a power, or multiplied by `other`, which is listed too.
/// `None` if the regressor does not list `parameter`.
fn nonlinear(
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
    // Prefer a geometric use, which explains most.
    let geometric =
        |role: Role| matches!(role, Role::Length | Role::CentreOfMass | Role::Gravity | Role::Ratio | Role::RotorPosition);
    let uses = places.uses.get(parameter.0 as usize).map_or(&[][..], Vec::as_slice);
    if let Some(found) = uses.iter().find(|u| geometric(u.role)).or(uses.first()) {
        diagnostic = diagnostic.also(found.span, format!("enters here as {}", found.role.text()));
    }
    Some(diagnostic)
}

/// No joint moves any row of the task, which the file writes at `span`.
fn immovable_task(manipulator: &Manipulator, span: Span) -> Diagnostic {
    let rows: Vec<&str> = manipulator.task.iter().map(|row| row.name()).collect();
    let message = format!("no joint moves any row of the task ({})", rows.join(", "));
    let help = "name rows that the arm can move: x y z are along, rx ry rz about the axes of the base frame";
    Diagnostic::new(Code::ImmovableTask, span, message, "zero for every q", help)
}

/// The base parameters, which `regressor` asks for, take too many steps.
fn long_combinations(places: &Places) -> Diagnostic {
    let message = "the base parameters of this arm are combinations that are too long to be formed exactly";
    let help = "leave `regressor` out, for ten columns a link: `armgen check --full` counts how many combinations a motion can identify; \
                angles that are multiples of pi/12 keep combinations short";
    Diagnostic::new(Code::TooComplex, places.regressor.unwrap_or(places.name), message, "needs them", help)
}

/// Nothing in the arm has mass or inertia.
fn no_dynamics(places: &Places) -> Diagnostic {
    let message = "nothing in this arm has mass or inertia: its module holds the kinematics alone";
    let help = "give the links `mass`, `com` and `inertia` for the dynamics; `allow: [no-dynamics]` where kinematics are all that is wanted";
    Diagnostic::new(Code::NoDynamics, places.name, message, "has no dynamics", help)
}

/// B(q) is singular for every q, because `joint` (by index) accelerates nothing beyond what the joints before it do.
fn singular_inertia(manipulator: &Manipulator, places: &Places, joint: usize) -> Option<Diagnostic> {
    let at = places.joints.get(joint)?;
    let name = manipulator.joints.get(joint).map_or("", |j| j.name.as_str());
    let message = format!("the inertia matrix is singular for every q: joint `{name}` moves no inertia");
    let help = "give its link (or one after it) mass or inertia about the joint axis, or the joint a motor with inertia; without any, its acceleration is undefined";
    Some(
        Diagnostic::new(Code::SingularInertia, at.name, message, "moves nothing that has inertia", help)
            .also(at.link, "this link"),
    )
}

/// A number in the equations of the arm is beyond the range of the scalar, although all numbers of the file are within it.
pub fn product_out_of_range(places: &Places, scalar: Scalar, value: &Number) -> Diagnostic {
    let (name, size) = match scalar {
        Scalar::F64 => ("f64", value.to_f64()),
        Scalar::F32 => ("f32", f64::from(value.to_f32())),
    };
    let direction = if size == 0.0 { "too small" } else { "too large" };
    let message = format!(
        "a number that the equations of this arm need is {direction} for {name}: a product of lengths, masses or inertias"
    );
    let help = "look for a length, mass, inertia or ratio of an unlikely size: SI units throughout";
    Diagnostic::new(Code::OutOfRange, places.name, message, "the equations of this arm", help)
}

/// A value of the functions can leave the scalar within the limits of the joints.
pub fn values_leave_the_scalar(manipulator: &Manipulator, places: &Places, scalar: Scalar, function: &str) -> Diagnostic {
    let (name, other) = match scalar {
        Scalar::F64 => ("f64", ""),
        Scalar::F32 => ("f32", ", or generate for f64"),
    };
    let message = format!("within the limits of the joints a value of `{function}` can be beyond the range of {name}");
    let help = format!("write narrower limits of position, velocity and effort, or look for a number of an unlikely size: SI units throughout{other}");
    let widest = |limits: &Limits| {
        let ends = limits.position.iter().flatten().chain(&limits.velocity).chain(&limits.effort);
        ends.map(|end| end.to_f64().abs()).fold(0.0, f64::max)
    };
    // The joint with the widest limits, if there are any that are wider than a machine has.
    let widest = manipulator.joints.iter().zip(&places.joints).map(|(joint, place)| (widest(&joint.limits), place.name));
    let joint = widest.filter(|(size, _)| *size > 1e6).max_by(|a, b| a.0.total_cmp(&b.0));
    match joint {
        Some((_, place)) => Diagnostic::new(Code::OutOfRange, place, message, "the joint with the widest limits", help),
        None => Diagnostic::new(Code::OutOfRange, places.name, message, "the equations of this arm", help),
    }
}

#[cfg(test)]
mod tests;
