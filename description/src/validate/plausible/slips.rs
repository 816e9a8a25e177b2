//! The replacement of a value that is off by a power of ten, with all its digits, if there is one.

use super::{definition, number, AS_LIKELY, LEAD, OF_LEAD_BALL, UNITS_OF_INERTIA};
use crate::description::{InertiaDescription, INERTIA_ELEMENTS};
use crate::document::{decimal_text, Expression, ExpressionKind};
use crate::exact::Rational;
use crate::validate::Context;

/// The value over a factor as it is to be written where it stands; `None` where the file names a unit for it.
pub(super) fn written_as(value: &Expression, factor: u64, context: &Context<'_>) -> Option<String> {
    let value = definition(value, context);
    if matches!(value.kind, ExpressionKind::InUnit(..)) {
        return None;
    }
    if let Some(text) = value.as_decimal().and_then(|decimal| decimal_text(&(decimal / Rational::from(factor)))) {
        return Some(text);
    }
    let text = value.text(context.source);
    Some(if value.is_decimal() || value.as_name().is_some() { format!("{text}/{factor}") } else { format!("({text})/{factor}") })
}

/// The help where a value may be in another unit.
pub(super) fn in_text(units: &str, unit: &str, text: Option<String>) -> String {
    match text {
        Some(text) => format!("{units}; if this is in {unit}, write {text}"),
        None => "it is in the unit that `units` names: check that, and the number".to_owned(),
    }
}

/// Whether a solid of the mass that spans so much has the tensor xx xy yy xz yz zz: every check of one body.
pub(super) fn passes(tensor: &[f64; 6], mass: f64, span: f64) -> bool {
    let [xx, xy, yy, xz, yz, zz] = *tensor;
    let definite = |a: f64, b: f64, c: f64, sign: f64| {
        let (d, e, f) = (sign * xy, sign * xz, sign * yz);
        let minors = [a, b, c, a * b - d * d, a * c - e * e, b * c - f * f];
        let determinant = a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e);
        minors.iter().all(|minor| *minor >= 0.0) && determinant >= 0.0
    };
    let half = (xx + yy + zz) / 2.0;
    let largest = xx.max(yy).max(zz);
    let radius = (3.0 * mass / (4.0 * std::f64::consts::PI * LEAD)).cbrt();
    definite(xx, yy, zz, 1.0)
        && definite(half - xx, half - yy, half - zz, -1.0)
        && largest <= mass * span * span
        && largest >= OF_LEAD_BALL * 0.4 * mass * radius * radius
}

/// The units, two at most, in which the tensor is one of a body, nearest to the usual first; each with the tensor in SI units.
pub(super) fn likely_tensors(
    inertia: &InertiaDescription,
    mass: f64,
    span: f64,
    context: &mut Context<'_>,
) -> Vec<(&'static str, String)> {
    let tensor = inertia.elements.each_ref().map(|value| number(value, context));
    let largest = tensor[0].max(tensor[2]).max(tensor[5]);
    let off = |factor: f64| ((largest / mass / factor).sqrt() / (0.2 * span)).ln().abs();
    let mut units: Vec<(f64, &'static str)> = UNITS_OF_INERTIA
        .into_iter()
        .filter(|(factor, _)| off(*factor) < AS_LIKELY.ln() && passes(&tensor.map(|element| element / factor), mass, span))
        .collect();
    units.sort_by(|a, b| off(a.0).total_cmp(&off(b.0)));
    units.truncate(2);
    let text = |factor: f64| {
        let elements = INERTIA_ELEMENTS.iter().zip(&inertia.elements);
        let given = elements.filter_map(|(name, value)| value.as_ref().map(|value| (name, value)));
        let texts: Option<Vec<String>> =
            given.map(|(name, value)| Some(format!("{name}: {}", written_as(value, factor as u64, context)?))).collect();
        texts.map(|texts| format!("{{{}}}", texts.join(", ")))
    };
    units.into_iter().filter_map(|(factor, unit)| Some((unit.trim_start_matches("in "), text(factor)?))).collect()
}

/// The only element that a power of ten can change so that the tensor belongs to a body: its name and its new value.
pub(super) fn single_slip(
    inertia: &InertiaDescription,
    mass: f64,
    span: f64,
    context: &mut Context<'_>,
) -> Option<(&'static str, String)> {
    let tensor = inertia.elements.each_ref().map(|value| number(value, context));
    let mut found = Vec::new();
    for element in (0..6).filter(|&element| tensor[element] != 0.0) {
        for power in (-6..=6).filter(|power| *power != 0) {
            let mut other = tensor;
            other[element] *= 10f64.powi(power);
            if passes(&other, mass, span) {
                found.push((element, power));
            }
        }
    }
    let [(element, power)] = found[..] else { return None };
    let value = inertia.elements[element].as_ref().filter(|_| power < 0)?;
    Some((INERTIA_ELEMENTS[element], written_as(value, 10u64.pow(power.unsigned_abs()), context)?))
}
