//! Exact numbers, angles and poses as expressions of robot.yaml; where none is short, 17 digits.

use std::cmp::Ordering;

use armgen_codegen::document::multiple_of_pi;
use armgen_codegen::exact::{Angle, Number, Rational};
use armgen_codegen::manipulator::Placement;

use crate::number::ending;

/// Digits of a numerator or denominator.
const MAX_DIGITS: usize = 12;

/// Writes numbers and counts those that it rounds.
#[derive(Default)]
pub(super) struct Writer {
    pub(super) rounded: usize,
}

impl Writer {
    /// A number: a decimal, a fraction, one of these times pi or a root; else rounded.
    pub(super) fn number(&mut self, number: &Number) -> String {
        exactly(number).unwrap_or_else(|| {
            self.rounded += 1;
            format!("{:?}", number.to_f64())
        })
    }

    /// The angle of a sine and cosine: a multiple of pi/12, a decimal; else rounded.
    pub(super) fn angle(&mut self, (sine, cosine): &(Number, Number)) -> String {
        let float = sine.to_f64().atan2(cosine.to_f64());
        let is = |angle: Number| {
            let angle = Angle::new(angle);
            is_zero(&sine.minus(&angle.sin())) && is_zero(&cosine.minus(&angle.cos()))
        };
        let twelfths = (float * 12.0 / std::f64::consts::PI).round() as i64;
        if is(&Number::pi() * &Number::from(Rational::from(twelfths) / Rational::from(12))) {
            return multiple_of_pi(twelfths);
        }
        for digits in [6, 12] {
            let text = format!("{float:.digits$}");
            let text = text.trim_end_matches('0').trim_end_matches('.');
            let decimal = crate::number::exact(text);
            if is(decimal) {
                return text.to_owned();
            }
        }
        self.rounded += 1;
        format!("{float:?}")
    }

    /// A frame as a pose; `None` if it is the identity.
    pub(super) fn pose(&mut self, frame: &Placement) -> Option<String> {
        let mut parts = Vec::new();
        let numbers = frame.translation.each_ref().map(|x| x.as_number().unwrap_or_else(Number::zero));
        if !numbers.iter().all(is_zero) {
            parts.push(format!("xyz: [{}]", numbers.each_ref().map(|x| self.number(x)).join(", ")));
        }
        let r = &frame.rotation;
        let twelfths = |sine: &Number, cosine: &Number| sine.to_f64().atan2(cosine.to_f64()) * 12.0 / std::f64::consts::PI;
        if is_zero(&r[2][1]) && is_zero(&r[2][0]) && r[2][2].is_one() {
            let angle = self.angle(&(r[1][0].clone(), r[0][0].clone()));
            if angle != "0" {
                parts.push(format!("rpy: [0, 0, {angle}]"));
            }
        } else if is_zero(&r[1][0]) && is_zero(&r[2][0]) && r[0][0].is_one() {
            let angle = self.angle(&(r[2][1].clone(), r[2][2].clone()));
            parts.push(format!("rpy: [{angle}, 0, 0]"));
        } else if r.iter().flatten().all(|x| is_zero(x) || x.is_one() || (-x).is_one()) {
            let (roll, pitch, yaw) = match is_zero(&r[2][0]) {
                true => (twelfths(&r[2][1], &r[2][2]), 0.0, twelfths(&r[1][0], &r[0][0])),
                false => (0.0, if r[2][0].is_one() { -6.0 } else { 6.0 }, twelfths(&-&r[0][1], &r[1][1])),
            };
            let angles = [roll, pitch, yaw].map(|angle| multiple_of_pi(angle.round() as i64));
            parts.push(format!("rpy: [{}]", angles.join(", ")));
        } else {
            let columns = [0, 1].map(|j| [0, 1, 2].map(|i| self.number(&r[i][j])).join(", "));
            parts.push(format!("xyaxes: [{}]", columns.join(", ")));
        }
        (!parts.is_empty()).then(|| format!("{{{}}}", parts.join(", ")))
    }
}

fn is_zero(number: &Number) -> bool {
    number.sign() == Ordering::Equal
}

/// An expression that is equal to a number, if there is a short one.
fn exactly(number: &Number) -> Option<String> {
    if is_zero(number) {
        return Some("0".into());
    }
    if let Some(text) = number.as_rational().and_then(fraction) {
        return Some(text);
    }
    if let Some(factor) = number.checked_div(&Number::pi()).and_then(|factor| Some(factor.as_rational()?.clone())) {
        return Some(format!("{}*pi", fraction(&factor)?));
    }
    // A fraction times a root is a root of a fraction.
    let square = number.times(number);
    let root = fraction(square.as_rational()?)?;
    let sign = if number.sign() == Ordering::Less { "-" } else { "" };
    Some(format!("{sign}sqrt({root})"))
}

fn fraction(value: &Rational) -> Option<String> {
    ending(value).or_else(|| {
        let (above, below) = (value.numerator().to_string(), value.denominator().to_string());
        (above.trim_start_matches('-').len() <= MAX_DIGITS && below.len() <= MAX_DIGITS).then(|| format!("{above}/{below}"))
    })
}
