//! Rigid bodies: no negative mass, no inertia that no distribution of mass has.
//!
//! The inertia tensor about the centre of mass is positive semidefinite: every principal minor is at least 0.
//! For a body of ordinary matter the principal moments also satisfy the triangle inequality, lambda_1 + lambda_2 >= lambda_3. This
//! means that tr(I)/2 · 1 - I is positive semidefinite. A violation is a warning, because data sheets of planar arms give Izz alone.

use std::cmp::Ordering;

use super::number::text_of;
use super::{geometry, zeros, Context};
use crate::description::{BodyDescription, InertiaDescription, Value, INERTIA_ELEMENTS};
use crate::diagnostic::{Code, Diagnostic};
use crate::document::{excerpt, Expression};
use crate::exact::{Number, Polynomial, Rational};
use crate::manipulator::{Body, PlacedBody, Placement, Pose};
use crate::source::Span;

/// The bodies that are fixed to each other, the first one in the frame of what carries them; `called` is how messages call it.
pub(super) fn parts(description: &BodyDescription, called: &str, context: &mut Context<'_>) -> Option<Vec<PlacedBody>> {
    let mut all = vec![part(description, Some(Pose::identity()), called, context)];
    for (i, attached) in description.attached.iter().enumerate() {
        let name = attached.name.as_ref().map_or_else(|| format!("body {}", i + 1), |name| format!("`{}`", excerpt(&name.value)));
        let called = format!("{name} attached to {called}");
        let frame = geometry::pose(attached.origin.as_ref(), &format!("the origin of {called}"), context);
        all.push(part(&attached.body, frame, &called, context));
    }
    all.into_iter().collect()
}

/// One body in a frame of its own.
pub(super) fn part(
    description: &BodyDescription,
    frame: Option<Pose>,
    called: &str,
    context: &mut Context<'_>,
) -> Option<PlacedBody> {
    let given = body(description, called, context);
    let axes = match description.inertia.as_ref().and_then(|inertia| inertia.rotation.as_ref()) {
        Some(rotation) => geometry::rotation(rotation, &format!("the inertia of {called}"), context),
        None => Some(Vec::new()),
    };
    let axes = axes?.into_iter().filter(|turn| *turn != Placement::identity()).collect();
    Some(PlacedBody::new(frame?, Pose::new(axes), given?))
}

fn body(description: &BodyDescription, called: &str, context: &mut Context<'_>) -> Option<Body> {
    // A missing mass is reported where it is required, and 0 where it is not.
    let mass = match &description.mass {
        Some(mass) => not_negative(mass, &format!("the mass of {called}"), Code::NegativeMass, context),
        None => Some(Polynomial::zero()),
    };
    let com = match &description.com {
        Some(com) => context.polynomials(&com.value),
        None => Some(zeros()),
    };
    if let (Some(given), Some(mass), Some(com)) = (&description.com, &mass, &com) {
        warn_of_massless(mass, com, given.span, &format!("the centre of mass of {called}"), context);
    }
    let inertia = match &description.inertia {
        Some(inertia) => self::inertia(inertia, called, context),
        None => Some(std::array::from_fn(|_| Polynomial::zero())),
    };
    Some(Body { mass: mass?, com: com?, inertia: inertia? })
}

/// Warns of a position given for a mass of 0, unless an error was reported, which may have caused the 0.
pub(super) fn warn_of_massless(mass: &Polynomial, place: &[Polynomial; 3], span: Span, what: &str, context: &mut Context<'_>) {
    if mass.is_zero() && place.iter().any(|p| !p.is_zero()) && !context.diagnostics.has_errors() {
        let help = "give the mass too, or leave the place out";
        context.report(Code::NoEffect, span, format!("{what} has no effect: the mass there is 0"), "not used", help);
    }
}

/// A value that cannot be below 0.
pub(super) fn not_negative(value: &Expression, what: &str, code: Code, context: &mut Context<'_>) -> Option<Polynomial> {
    let polynomial = context.polynomial(value)?;
    let nominal = context.number(value)?;
    if nominal.sign() == Ordering::Less {
        let why = match code {
            Code::NegativeFriction => "friction takes energy from the arm, so its coefficient is at least 0",
            Code::NegativeStiffness => "a spring pulls back to its rest, so its stiffness is at least 0",
            Code::NegativeArmature => "an armature resists acceleration as a mass does, so it is at least 0",
            Code::NegativeRotorInertia => "a moment of inertia is an integral of squared distances, so it is at least 0",
            _ => "a mass is at least 0; write 0 for a body that has none",
        };
        let label = format!("this is {}", text_of(&nominal));
        context.report(code, value.span, format!("{what} is negative"), label, why);
        return None;
    }
    Some(polynomial)
}

fn inertia(description: &InertiaDescription, called: &str, context: &mut Context<'_>) -> Option<[Polynomial; 6]> {
    let mut polynomials = Vec::new();
    let mut numbers = Vec::new();
    for element in &description.elements {
        polynomials.push(element.as_ref().map_or(Some(Polynomial::zero()), |e| context.polynomial(e)));
        numbers.push(element.as_ref().map_or(Some(Number::zero()), |e| context.number(e)));
    }
    let numbers: Vec<Number> = numbers.into_iter().flatten().collect();
    if let (true, Ok(numbers)) = (description.complete, <[Number; 6]>::try_from(numbers)) {
        judge(description, &numbers, called, context);
    }
    let polynomials: Vec<Polynomial> = polynomials.into_iter().flatten().collect();
    polynomials.try_into().ok()
}

/// Reports a tensor that no body has.
fn judge(description: &InertiaDescription, tensor: &[Number; 6], called: &str, context: &mut Context<'_>) {
    let span_of = |element: usize| description.elements[element].as_ref().map_or(description.key, |e: &Expression| e.span);
    if let Some(minor) = negative_minor(tensor) {
        let (reason, element) = minor;
        let name = element.map_or_else(|| "here".to_owned(), |e| format!("I{} is {}", INERTIA_ELEMENTS[e], text_of(&tensor[e])));
        let help = "an inertia tensor about the centre of mass has no negative principal moment; xy is the element -∫xy dm of the tensor, so check signs";
        let span = element.map_or(description.key, span_of);
        if context.inertia_as_written {
            let help = "B(q) may not be positive definite: no controller and no simulation is to be trusted with it";
            let message = format!("the inertia of {called} is impossible, and taken as written: {reason}");
            context.report(Code::InertiaAsWritten, span, message, name, help);
            return;
        }
        context.report(Code::ImpossibleInertia, span, format!("the inertia of {called} is impossible: {reason}"), name, help);
        return;
    }
    let [xx, xy, yy, xz, yz, zz] = tensor;
    let half = Number::from(Rational::from_parts(1.into(), 2u8.into()));
    let trace = &(&(xx + yy) + zz) * &half;
    let complement = [&trace - xx, -xy, &trace - yy, -xz, -yz, &trace - zz];
    if negative_minor(&complement).is_none() {
        return;
    }
    // Which of the moments is too large, if the axes are the principal ones.
    let moments = [(0, 2, 5), (2, 0, 5), (5, 0, 2)];
    let given: Vec<usize> = (0..6).filter(|&e| !tensor[e].is_zero()).collect();
    if let ([only], true) = (given.as_slice(), moments.iter().any(|(large, ..)| given == [*large])) {
        context.planar.push((span_of(*only), format!("the inertia of {called}")));
        return;
    }
    let diagonal = [xy, xz, yz].iter().all(|e| e.is_zero());
    let large = moments.iter().find(|(large, a, b)| (&(&tensor[*a] + &tensor[*b]) - &tensor[*large]).sign() == Ordering::Less);
    let (reason, label, span) = match large.filter(|_| diagonal) {
        Some(&(large, a, b)) => {
            let excess = &tensor[large] - &(&tensor[a] + &tensor[b]);
            let [l, a, b] = [large, a, b].map(|e| INERTIA_ELEMENTS[e]);
            (format!("I{a} + I{b} < I{l}"), format!("too large, by {} kg m² or more", text_of(&excess)), span_of(large))
        }
        None => {
            let reason = "its largest principal moment exceeds the sum of the other two";
            (reason.to_owned(), "too large".to_owned(), description.key)
        }
    };
    let help = "each moment of inertia of a solid body is at most the sum of the other two; check units, signs and axes (centre of mass, link frame)";
    context.report(Code::TriangleInequality, span, format!("no solid body has the inertia of {called}: {reason}"), label, help);
}

/// Why no distribution of mass has this inertia tensor about its centre of mass, xx xy yy xz yz zz: a negative principal minor; `None` if one has.
pub fn impossible_inertia(tensor: &[Number; 6]) -> Option<String> {
    negative_minor(tensor).map(|(reason, _)| reason)
}

/// A principal minor below 0: its name, and the faulty element if only one is involved.
fn negative_minor(tensor: &[Number; 6]) -> Option<(String, Option<usize>)> {
    let [xx, xy, yy, xz, yz, zz] = tensor;
    for element in [0, 2, 5] {
        if tensor[element].sign() == Ordering::Less {
            return Some((format!("I{} < 0", INERTIA_ELEMENTS[element]), Some(element)));
        }
    }
    for (element, a, b) in [(1, 0, 2), (3, 0, 5), (4, 2, 5)] {
        let minor = &(&tensor[a] * &tensor[b]) - &(&tensor[element] * &tensor[element]);
        if minor.sign() == Ordering::Less {
            let [e, a, b] = [element, a, b].map(|e| INERTIA_ELEMENTS[e]);
            return Some((format!("I{e}² > I{a} I{b}"), Some(element)));
        }
    }
    let products = [
        (&(xx * yy) * zz, false),
        (&(&(xy * xz) * yz) * &Number::from(2), false),
        (&(xz * xz) * yy, true),
        (&(xy * xy) * zz, true),
        (&(yz * yz) * xx, true),
    ];
    let determinant = products.iter().fold(Number::zero(), |sum, (p, minus)| if *minus { &sum - p } else { &sum + p });
    (determinant.sign() == Ordering::Less).then(|| ("its determinant is negative, so one principal moment is".to_owned(), None))
}

/// One warning for all bodies with a single moment.
pub(super) fn warn_of_planar(context: &mut Context<'_>) {
    let mut planar = std::mem::take(&mut context.planar).into_iter();
    let Some((span, called)) = planar.next() else { return };
    let help =
        "one moment alone is enough where a body turns about parallel axes only; give the others if the data sheet has them";
    let mut diagnostic = Diagnostic::new(
        Code::TriangleInequality,
        span,
        "one moment of inertia alone belongs to no solid body: it exceeds the sum of the other two",
        called,
        help,
    );
    for (span, called) in planar {
        diagnostic = diagnostic.also(span, called);
    }
    context.diagnostics.push(diagnostic);
}

/// The polynomial of an optional value that cannot be below 0.
pub(super) fn optional_not_negative(
    value: &Value,
    what: &str,
    code: Code,
    context: &mut Context<'_>,
) -> Option<Option<Polynomial>> {
    match value {
        Some(value) => not_negative(value, what, code, context).map(Some),
        None => Some(None),
    }
}
