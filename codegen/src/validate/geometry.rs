//! Angles, and Denavit-Hartenberg rows as placements.
//!
//! ```text
//! standard: A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)     joint frame: after Rz(theta) Tz(d);  link frame: after Tx(a) Rx(alpha)
//! modified: A_i = Rx(alpha) Tx(a) Rz(theta) Tz(d)     joint frame = link frame
//! ```

use std::cmp::Ordering;

use super::number::text_of;
use super::{zeros, Context};
use crate::description::{Convention, JointDescription, ToolDescription, Value};
use crate::diagnostic::Code;
use crate::document::Expression;
use crate::exact::{Angle, Number, Polynomial, Rational};
use crate::manipulator::Placement;
use crate::source::Span;

/// An angle beyond this many radians is a mistake.
const LARGEST_ANGLE: i64 = 1_000_000;
/// How near, in rad, a decimal must come to a multiple of pi/12 to be called a rounded one.
const NEAR: f64 = 2e-3;
/// Terms of the squared length of an axis.
const MAX_SQUARE: usize = 32;
/// A limit beyond this many radians is probably one in degrees: nearly five turns.
const SUSPECT_LIMIT: f64 = 30.0;

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

/// Warns of a limit in degrees, or rounded.
pub(super) fn doubt_limit(expression: &Expression, radians: &Number, what: &str, context: &mut Context<'_>) {
    doubt_angle(expression, radians, what, SUSPECT_LIMIT, context);
}

/// Warns of an angle above `suspect` that is written as a decimal, and of one that is nearly a multiple of pi/12.
fn doubt_angle(expression: &Expression, radians: &Number, what: &str, suspect: f64, context: &mut Context<'_>) {
    // A name that stands for a decimal is as doubtful as the decimal; the remedy belongs to its definition.
    let definition = expression.as_name().and_then(|name| context.evaluator.parameters.get(name));
    let definition = definition.and_then(|entry| entry.value.zip(entry.nominal.clone()));
    let (written, radians) = definition.unwrap_or((expression, radians.clone()));
    let float = radians.to_f64();
    if float.abs() > suspect {
        if written.is_decimal() {
            let text = context.source.slice(written.span).to_owned();
            let turns = rounded(float.abs() / std::f64::consts::TAU, 2);
            let message = format!("{what}: {} rad are {turns} turns", text_of(&radians));
            let help = format!("angles are in radians; write `deg({text})` if degrees are meant");
            context.report(Code::DegreesSuspected, written.span, message, "in degrees?", help);
        }
        return;
    }
    if radians.as_rational().is_none() {
        return;
    }
    let step = std::f64::consts::PI / 12.0;
    let multiple = (float / step).round();
    if multiple == 0.0 || (float - multiple * step).abs() > NEAR {
        return;
    }
    let twelfths = Number::from(Rational::from(multiple as i64) / Rational::from(12));
    let off = (&radians - &(&twelfths * &Number::pi())).to_f64();
    let meant = multiple_of_pi(multiple as i64);
    let message = format!("{what}: {} rad is nearly, but not, {meant} (off by {:.1e} rad)", text_of(&radians), off.abs());
    let help = format!("write `{meant}` if that is meant; it has an exact sine and cosine. The decimal is taken as written");
    context.report(Code::RoundedAngle, written.span, message, format!("`{meant}`?"), help);
}

/// `n` twelfths of pi as one writes it.
fn multiple_of_pi(n: i64) -> String {
    let fraction = Rational::from(n) / Rational::from(12);
    let (numerator, denominator) = (fraction.numerator().to_string(), fraction.denominator().to_string());
    let start = match numerator.as_str() {
        "1" => "pi".to_owned(),
        "-1" => "-pi".to_owned(),
        n => format!("{n}*pi"),
    };
    if denominator == "1" {
        start
    } else {
        format!("{start}/{denominator}")
    }
}

fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (value * scale).round() / scale
}

/// The frames of one row: what stands before the joint's motion, and what after.
pub(super) struct Row {
    pub(super) before: Placement,
    pub(super) after: Placement,
    /// The joint axis in the previous link's frame.
    pub(super) axis: [Number; 3],
}

/// The row of a joint; faults are reported.
pub(super) fn row(
    joint: &JointDescription,
    called: &str,
    convention: Option<Convention>,
    context: &mut Context<'_>,
) -> Option<Row> {
    let alpha = sine_cosine(&joint.alpha, &format!("alpha of joint {called}"), context);
    let theta = sine_cosine(&joint.theta, &format!("theta of joint {called}"), context);
    let (a, d) = (context.given(&joint.a), context.given(&joint.d));
    let (alpha, theta, a, d, convention) = (alpha?, theta?, a?, d?, convention?);
    let twist = compose(&translation([a, Polynomial::zero(), Polynomial::zero()]), &about(0, &alpha));
    let turn = compose(&about(2, &theta), &translation([Polynomial::zero(), Polynomial::zero(), d]));
    Some(match convention {
        Convention::Standard => Row { before: turn, after: twist, axis: [Number::zero(), Number::zero(), Number::one()] },
        // Tx and Rx about the same axis commute.
        Convention::Modified => {
            Row { before: compose(&twist, &turn), after: identity(), axis: [Number::zero(), -&alpha.0, alpha.1] }
        }
    })
}

/// The end-effector frame.
pub(super) fn tool(tool: Option<&ToolDescription>, context: &mut Context<'_>) -> Option<Placement> {
    let Some(tool) = tool else { return Some(identity()) };
    let position = match &tool.xyz {
        Some(xyz) => context.polynomials(&xyz.value),
        None => Some(zeros()),
    };
    let rotation = match &tool.rpy {
        Some(rpy) => {
            let angles =
                [0, 1, 2].map(|i| sine_cosine(&rpy.value[i], &format!("the tool's angle about {}", ["x", "y", "z"][i]), context));
            let [x, y, z] = angles;
            x.zip(y).zip(z).map(|((x, y), z)| compose(&about(2, &z), &compose(&about(1, &y), &about(0, &x))))
        }
        None => Some(identity()),
    };
    Some(Placement { rotation: rotation?.rotation, translation: position? })
}

/// A unit vector along `direction`; faults are reported at `span`.
pub(super) fn unit_vector(direction: [Number; 3], span: Span, called: &str, context: &mut Context<'_>) -> Option<[Number; 3]> {
    let square = direction.iter().fold(Number::zero(), |sum, x| &sum + &(x * x));
    if square.terms().count() > MAX_SQUARE {
        let message = format!("the motor axis of joint {called} grows too large when its length becomes 1");
        let help = "numbers are kept exactly, roots included: use fewer different roots and shorter decimals here";
        context.report(Code::TooComplex, span, message, "too large to be kept exactly", help);
        return None;
    }
    let length = square.sqrt().filter(|length| !length.is_zero());
    let Some(length) = length else {
        let help = "give the direction as a vector other than 0, or leave `axis` out for the joint axis";
        context.report(
            Code::ZeroAxis,
            span,
            format!("the motor axis of joint {called} has no direction"),
            "the zero vector",
            help,
        );
        return None;
    };
    Some(direction.map(|x| x.checked_div(&length).expect("a length other than 0")))
}

/// No rotation, no translation.
pub(super) fn identity() -> Placement {
    let rotation = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { Number::one() } else { Number::zero() }));
    Placement { rotation, translation: zeros() }
}

fn translation(by: [Polynomial; 3]) -> Placement {
    Placement { translation: by, ..identity() }
}

/// The rotation about axis x, y, z (0, 1, 2) of an angle given by sine and cosine.
fn about(axis: usize, (sine, cosine): &(Number, Number)) -> Placement {
    let mut placement = identity();
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    placement.rotation[i][i] = cosine.clone();
    placement.rotation[j][j] = cosine.clone();
    placement.rotation[i][j] = -sine;
    placement.rotation[j][i] = sine.clone();
    placement
}

/// The frame `inner`, given in `outer`.
pub(super) fn compose(outer: &Placement, inner: &Placement) -> Placement {
    let rotation = std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..3).fold(Number::zero(), |sum, k| &sum + &(&outer.rotation[i][k] * &inner.rotation[k][j])))
    });
    let translation = std::array::from_fn(|i| {
        (0..3).fold(outer.translation[i].clone(), |sum, k| {
            &sum + &(&Polynomial::from(outer.rotation[i][k].clone()) * &inner.translation[k])
        })
    });
    Placement { rotation, translation }
}
