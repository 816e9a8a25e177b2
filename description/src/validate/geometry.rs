//! Angles, rows of joints of every convention, poses and rotations in all their writings, as placements.
//!
//! ```text
//! urdf:     A_i = origin_i · motion about or along axis_i
//! standard: A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)     joint frame: after Rz(theta) Tz(d);  link frame: after Tx(a) Rx(alpha)
//! modified: A_i = Rx(alpha) Tx(a) Rz(theta) Tz(d)     joint frame = link frame
//! ```

use std::cmp::Ordering;

use super::number::text_of;
use super::Context;
use crate::description::{Convention, JointDescription, PoseDescription, RotationDescription, Value};
use crate::diagnostic::Code;
use crate::document::{multiple_of_pi, Expression};
use crate::exact::{Angle, Number, Polynomial, Rational};
use crate::manipulator::{Placement, Pose, Row};
use crate::source::Span;

/// An angle beyond this many radians is a mistake.
const LARGEST_ANGLE: i64 = 1_000_000;
/// How near, in rad, a decimal must come to a multiple of pi/12 to be called a rounded one.
const NEAR: f64 = 2e-3;
/// Terms of the squared length of an axis.
const MAX_SQUARE: usize = 32;
/// A limit, or the rest of a spring, beyond this many radians is probably one in degrees: nearly five turns.
const SUSPECT_LIMIT: f64 = 30.0;
/// Two turns: joints of more are rare, and their limits no whole numbers of radians.
const SUSPECT_WHOLE: f64 = 4.0 * std::f64::consts::PI;

/// Sine and cosine of an angle of the file.
pub(super) fn sine_cosine(value: &Value, what: &str, context: &mut Context<'_>) -> Option<(Number, Number)> {
    let expression = value.as_ref()?;
    let radians = context.number(expression)?;
    let size = if radians.sign() == Ordering::Less { -&radians } else { radians.clone() };
    if (&size - &Number::from(LARGEST_ANGLE)).sign() == Ordering::Greater {
        let message = format!("{what} is {} rad, which is no angle of an arm", text_of(&radians));
        context.report(Code::OutOfRange, expression.span, message, "too large", "angles are in radians, at most 1e6");
        return None;
    }
    doubt_angle(expression, &radians, what, std::f64::consts::TAU + NEAR, context);
    let angle = Angle::new(radians);
    Some((angle.sin(), angle.cos()))
}

/// Warns of limits, or of the rest of a spring, in degrees; where one of two is, both are. A rounded one is as good as another.
pub(super) fn doubt_limits(limits: &[(&Expression, &Number)], what: &str, context: &mut Context<'_>) {
    let is_suspect = |(expression, radians): &(&Expression, &Number), context: &Context<'_>| {
        let (written, radians) = defined(expression, radians, context);
        let size = radians.to_f64().abs();
        size > SUSPECT_LIMIT || size > SUSPECT_WHOLE && written.as_decimal().is_some_and(|value| value.is_int())
    };
    if limits.iter().any(|limit| is_suspect(limit, context)) {
        for (expression, radians) in limits {
            let _ = doubt_degrees(expression, radians, what, 0.0, context);
        }
    }
}

/// The definition of a name, and its value: a name that stands for a decimal is as doubtful as the decimal; the remedy belongs to its definition.
fn defined(expression: &Expression, radians: &Number, context: &Context<'_>) -> (Expression, Number) {
    let definition = expression.as_name().and_then(|name| context.evaluator.parameters.get(name));
    let definition = definition.and_then(|entry| entry.value.zip(entry.nominal.clone()));
    definition.map_or_else(|| (expression.clone(), radians.clone()), |(expression, radians)| (expression.clone(), radians))
}

/// Warns of an angle above `suspect` that is written as a decimal, and of one that is nearly a multiple of pi/12.
fn doubt_angle(expression: &Expression, radians: &Number, what: &str, suspect: f64, context: &mut Context<'_>) {
    if let Some((written, radians)) = doubt_degrees(expression, radians, what, suspect, context) {
        doubt_rounded(written, &radians, what, context);
    }
}

/// Warns of an angle above `suspect` that is written as a decimal; where it is written and its value, if it is not above.
fn doubt_degrees(
    expression: &Expression,
    radians: &Number,
    what: &str,
    suspect: f64,
    context: &mut Context<'_>,
) -> Option<(Span, Number)> {
    let (written, radians) = defined(expression, radians, context);
    let float = radians.to_f64();
    if float.abs() > suspect {
        if written.is_decimal() {
            let text = context.source.slice(written.span).to_owned();
            let turns = rounded(float.abs() / std::f64::consts::TAU, 2);
            let message = format!("{what}: {} rad are {turns} turns", text_of(&radians));
            let help = format!("angles are in radians; write `deg({text})` if degrees are meant");
            context.report(Code::DegreesSuspected, written.span, message, "in degrees?", help);
        }
        return None;
    }
    Some((written.span, radians))
}

/// Warns of an angle that is nearly a multiple of pi/12.
fn doubt_rounded(written: Span, radians: &Number, what: &str, context: &mut Context<'_>) {
    let float = radians.to_f64();
    if radians.as_rational().is_none() {
        return;
    }
    let step = std::f64::consts::PI / 12.0;
    let multiple = (float / step).round();
    if multiple == 0.0 || (float - multiple * step).abs() > NEAR {
        return;
    }
    let twelfths = Number::from(Rational::from(multiple as i64) / Rational::from(12));
    let off = (radians - &(&twelfths * &Number::pi())).to_f64();
    let meant = multiple_of_pi(multiple as i64);
    let message = format!("{what}: {} rad is nearly, but not, {meant} (off by {:.1e} rad)", text_of(radians), off.abs());
    let help = format!("write `{meant}` if that is meant; it has an exact sine and cosine. The decimal is taken as written");
    context.report(Code::RoundedAngle, written, message, format!("`{meant}`?"), help);
}

fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (value * scale).round() / scale
}

/// The row of a joint; faults are reported.
pub(super) fn row(
    joint: &JointDescription,
    called: &str,
    convention: Option<Convention>,
    context: &mut Context<'_>,
) -> Option<Row> {
    match convention {
        Some(Convention::Urdf) => {
            let origin = pose(joint.origin.as_ref(), &format!("the origin of joint {called}"), context);
            let axis = joint.axis.as_ref().and_then(|axis| {
                let help = "give the direction as a vector other than 0; `[0, 0, 1]` is the z axis of the link";
                let direction = context.numbers(&axis.value)?;
                unit_vector(direction, axis.span, &format!("the axis of joint {called}"), help, context)
            });
            Some(Row { before: origin?, axis: axis?, after: Pose::identity() })
        }
        convention => {
            let alpha = sine_cosine(&joint.alpha, &format!("alpha of joint {called}"), context);
            let theta = sine_cosine(&joint.theta, &format!("theta of joint {called}"), context);
            let (a, d) = (context.given(&joint.a), context.given(&joint.d));
            let (alpha, theta, a, d, convention) = (alpha?, theta?, a?, d?, convention?);
            // Tx and Rx about the same axis commute.
            let twist = [translation([a, Polynomial::zero(), Polynomial::zero()]), about(0, &alpha)];
            let turn = [about(2, &theta), translation([Polynomial::zero(), Polynomial::zero(), d])];
            let product = |two: [Placement; 2]| two[0].then(&two[1]);
            let axis = [Number::zero(), Number::zero(), Number::one()];
            if convention == Convention::Standard {
                Some(Row { before: Pose::new(vec![product(turn)]), axis, after: Pose::new(vec![product(twist)]) })
            } else {
                let before = vec![product(twist), product(turn)];
                Some(Row { before: Pose::new(before), axis, after: Pose::identity() })
            }
        }
    }
}

/// A frame in another, the identity where the file gives none; faults are reported. `what`: of what, as in "the tool".
pub(super) fn pose(description: Option<&PoseDescription>, what: &str, context: &mut Context<'_>) -> Option<Pose> {
    let Some(description) = description else { return Some(Pose::identity()) };
    let mut elements = Some(Vec::new());
    for element in &description.elements {
        let xyz = element.xyz.as_ref().map(|xyz| context.polynomials(&xyz.value));
        let turns = element.rotation.as_ref().map(|rotation| self::rotation(rotation, what, context));
        let moved = match xyz {
            Some(xyz) => xyz.map(|xyz| vec![translation(xyz)]),
            None => Some(Vec::new()),
        };
        let turned = turns.unwrap_or_else(|| Some(Vec::new()));
        elements = elements.zip(moved.zip(turned)).map(|(all, (moved, turned))| [all, moved, turned].concat());
    }
    let elements = elements.filter(|_| description.complete)?;
    Some(Pose::new(elements.into_iter().filter(|element| *element != Placement::identity()).collect()))
}

/// The rotations about one axis each that a rotation of the file is made of; faults are reported.
pub(super) fn rotation(description: &RotationDescription, what: &str, context: &mut Context<'_>) -> Option<Vec<Placement>> {
    let turn = |rotation| Placement { rotation, ..Placement::identity() };
    let help = "give a direction other than 0";
    match description {
        RotationDescription::Rpy(angles) => {
            let names = ["x", "y", "z"];
            let angles =
                [0, 1, 2].map(|i| sine_cosine(&angles.value[i], &format!("{what}: the angle about {}", names[i]), context));
            let [x, y, z] = angles;
            let (x, y, z) = (x?, y?, z?);
            Some(vec![about(2, &z), about(1, &y), about(0, &x)])
        }
        RotationDescription::Quat(quaternion) => {
            let [w, x, y, z] = context.numbers(&quaternion.value)?;
            let square = [&w, &x, &y, &z].iter().fold(Number::zero(), |sum, e| &sum + &(*e * *e));
            let span = quaternion.span;
            if square.sign() == Ordering::Equal {
                let message = format!("{what}: the quaternion is 0, which is no rotation");
                context.report(Code::ZeroAxis, span, message, "all four are 0", "`[1, 0, 0, 0]` is no rotation at all");
                return None;
            }
            let twice = Number::from(2).checked_div(&square).filter(|_| square.terms().count() <= MAX_SQUARE);
            let Some(twice) = twice else {
                too_large(span, what, context);
                return None;
            };
            // 1 + 2 (w [v] + [v]²) / |q|²
            let v = [&x, &y, &z];
            let entry = |i: usize, j: usize| {
                let k = (6 - i - j) % 3;
                if i == j {
                    let rest = (0..3).filter(|k| *k != i).fold(Number::zero(), |sum, k| &sum + &(v[k] * v[k]));
                    return &Number::one() - &(&twice * &rest);
                }
                let skew = &w * v[k];
                let skew = if (i + 1) % 3 == j { -&skew } else { skew };
                &twice * &(&(v[i] * v[j]) + &skew)
            };
            Some(vec![turn(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))])
        }
        RotationDescription::AxisAngle(axis, angle) => {
            let direction = context.numbers(&axis.value);
            let unit =
                direction.and_then(|d| unit_vector(d, axis.span, &format!("{what}: the axis of the rotation"), help, context));
            let angle = sine_cosine(&Some(angle.clone()), &format!("{what}: the angle"), context);
            let (u, (sine, cosine)) = (unit?, angle?);
            // c 1 + s [u] + (1 - c) u u'
            let rest = &Number::one() - &cosine;
            let entry = |i: usize, j: usize| {
                let product = (&u[i] * &u[j]).times(&rest);
                if i == j {
                    return product.plus(&cosine);
                }
                let skew = sine.times(&u[(6 - i - j) % 3]);
                product.plus(&if (i + 1) % 3 == j { -&skew } else { skew })
            };
            Some(vec![turn(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))])
        }
        RotationDescription::XyAxes(axes) => {
            let [a, b, c, d, e, f] = context.numbers(&axes.value)?;
            let (first, second) = ([a, b, c], [d, e, f]);
            let x = unit_vector(first, axes.span, &format!("{what}: the x axis"), help, context)?;
            let along = dot(&x, &second);
            let rest = std::array::from_fn(|i| &second[i] - &(&along * &x[i]));
            let parallel = "give two directions that are not parallel";
            let y = unit_vector(
                rest,
                axes.span,
                &format!("{what}: the y axis, made perpendicular to the x axis,"),
                parallel,
                context,
            )?;
            let z = cross(&x, &y);
            Some(vec![turn(std::array::from_fn(|i| [x[i].clone(), y[i].clone(), z[i].clone()]))])
        }
    }
}

fn too_large(span: Span, what: &str, context: &mut Context<'_>) {
    let message = format!("{what} grows too large when its length becomes 1");
    let help = "numbers are kept exactly, roots included: use fewer different roots and shorter decimals here";
    context.report(Code::TooComplex, span, message, "too large to be kept exactly", help);
}

/// A unit vector along `direction`; faults are reported at `span`.
pub(super) fn unit_vector(
    direction: [Number; 3],
    span: Span,
    what: &str,
    help: &str,
    context: &mut Context<'_>,
) -> Option<[Number; 3]> {
    let square = direction.iter().fold(Number::zero(), |sum, x| &sum + &(x * x));
    if square.terms().count() > MAX_SQUARE {
        too_large(span, what, context);
        return None;
    }
    let length = square.sqrt().filter(|length| !length.is_zero());
    let Some(length) = length else {
        context.report(Code::ZeroAxis, span, format!("{what} has no direction"), "the zero vector", help);
        return None;
    };
    Some(direction.map(|x| x.checked_div(&length).expect("a length other than 0")))
}

/// a'b.
pub(super) fn dot(a: &[Number; 3], b: &[Number; 3]) -> Number {
    (0..3).fold(Number::zero(), |sum, k| sum.plus(&a[k].times(&b[k])))
}

/// a × b.
pub(super) fn cross(a: &[Number; 3], b: &[Number; 3]) -> [Number; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).minus(&a[k].times(&b[j]))
    })
}

fn translation(by: [Polynomial; 3]) -> Placement {
    Placement { translation: by, ..Placement::identity() }
}

/// The rotation about axis x, y, z (0, 1, 2) of an angle given by sine and cosine.
fn about(axis: usize, (sine, cosine): &(Number, Number)) -> Placement {
    let mut placement = Placement::identity();
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    placement.rotation[i][i] = cosine.clone();
    placement.rotation[j][j] = cosine.clone();
    placement.rotation[i][j] = -sine;
    placement.rotation[j][i] = sine.clone();
    placement
}
