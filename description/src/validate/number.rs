//! Expression -> exact number, at the values of its names.
//!
//! Exact values can grow without bound where floats only lose digits (`(1+sqrt(2)+pi)*(...)`, squares of squares of squares), so
//! every intermediate value has a size that it may not exceed.

use std::cmp::Ordering;

use dashu_base::{BitTest, UnsignedAbs};

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::document::{excerpt, out_of_range, Expression, ExpressionKind, Operator, Unit};
use crate::exact::{Atom, Number, Rational};
use crate::kinds::Scalar;

/// Terms of an exact number.
const MAX_TERMS: usize = 8;
/// Bits of a numerator or denominator.
const MAX_BITS: usize = 1 << 12;
/// Roots within roots.
const MAX_NESTING: usize = 2;
/// Different roots in a divisor: rationalising it doubles the terms with each.
const MAX_DIVISOR_ATOMS: usize = 3;

/// A value, or its fault; `Err(None)` where the fault was reported already.
pub(super) type Evaluated<T> = Result<T, Option<Box<Diagnostic>>>;

/// The values of names.
pub(super) trait Nominals {
    /// The value of a name, if it is known.
    fn nominal(&self, name: &str) -> Option<Number>;
}

/// The nominal value of `expression`, if the scalar can hold it. `None`: the fault is reported, here or earlier.
pub(super) fn number(
    expression: &Expression,
    nominals: &dyn Nominals,
    scalar: Scalar,
    diagnostics: &mut Diagnostics,
) -> Option<Number> {
    let value = match nominal(expression, nominals) {
        Ok(value) => value,
        Err(fault) => {
            if let Some(fault) = fault {
                diagnostics.push(*fault);
            }
            return None;
        }
    };
    let (zero, infinite) = match scalar {
        Scalar::F64 => (value.to_f64() == 0.0, value.to_f64().is_infinite()),
        Scalar::F32 => (value.to_f32() == 0.0, value.to_f32().is_infinite()),
    };
    // A zero that no reduction sees, such as sqrt(3 + 2 sqrt(2)) - 1 - sqrt(2).
    if zero && value.sign() == Ordering::Equal {
        return Some(Number::zero());
    }
    if infinite || (zero && !value.is_zero()) {
        diagnostics.push(out_of_range(expression.span, text_of(&value), infinite));
        return None;
    }
    Some(value)
}

/// A number for a message: short, even where the exact one is long.
pub(super) fn text_of(value: &Number) -> String {
    let text = value.to_string();
    if text.len() <= 24 && !text.contains('/') {
        return text;
    }
    let float = value.to_f64();
    if float.is_finite() && (float != 0.0 || value.is_zero()) {
        let size = float.abs();
        return if float == 0.0 || (1e-4..1e9).contains(&size) { format!("{float}") } else { format!("{float:e}") };
    }
    // Beyond the floats: the power of ten from the number of bits.
    let bits = |r: &Rational| r.numerator().unsigned_abs().bit_len() as f64 - r.denominator().bit_len() as f64;
    match value.as_rational() {
        Some(r) => format!("about 1e{:.0}", bits(r) * std::f64::consts::LOG10_2),
        None => excerpt(&text),
    }
}

/// The exact value of `expression` at the values of its names, whatever its size.
pub(super) fn nominal(expression: &Expression, nominals: &dyn Nominals) -> Evaluated<Number> {
    let of = |e: &Expression| nominal(e, nominals);
    let value = match &expression.kind {
        ExpressionKind::Decimal(value) => Number::from(value.clone()),
        ExpressionKind::Pi => Number::pi(),
        ExpressionKind::Name(name) => nominals.nominal(name).ok_or(None)?,
        ExpressionKind::Negate(a) => -&of(a)?,
        ExpressionKind::Degrees(a) => degrees(&of(a)?),
        ExpressionKind::InUnit(a, unit) => &of(a)? * &unit_in_si(unit),
        ExpressionKind::Root(a) => {
            let inner = of(a)?;
            if nesting(&inner) >= MAX_NESTING {
                return Err(too_complex(expression));
            }
            inner.sqrt().ok_or_else(|| {
                let message = format!("the root of {} is not real", text_of(&inner));
                let label = format!("this is {}", text_of(&inner));
                Some(Box::new(Diagnostic::new(
                    Code::NegativeRoot,
                    a.span,
                    message,
                    label,
                    "take the root of a number that is at least 0",
                )))
            })?
        }
        ExpressionKind::Binary(operator, a, b) => {
            let (divisor, a, b) = (b, of(a)?, of(b)?);
            match operator {
                Operator::Add => &a + &b,
                Operator::Subtract => &a - &b,
                Operator::Multiply => multiply(&a, &b).ok_or_else(|| too_complex(expression))?,
                Operator::Divide => {
                    if b.is_zero() || b.sign() == Ordering::Equal {
                        let message = "a division by zero";
                        let help = "a quotient needs a divisor other than 0";
                        return Err(Some(Box::new(Diagnostic::new(
                            Code::DivisionByZero,
                            divisor.span,
                            message,
                            "this is 0",
                            help,
                        ))));
                    }
                    let inverse = if distinct_atoms(&b) <= MAX_DIVISOR_ATOMS { Number::one().checked_div(&b) } else { None };
                    inverse.filter(is_small).and_then(|inverse| multiply(&a, &inverse)).ok_or_else(|| too_complex(expression))?
                }
            }
        }
    };
    if is_small(&value) {
        Ok(value)
    } else {
        Err(too_complex(expression))
    }
}

/// The product, unless it grows too large.
fn multiply(a: &Number, b: &Number) -> Option<Number> {
    (a.terms().count() * b.terms().count() <= 4 * MAX_TERMS).then(|| a * b)
}

pub(super) fn degrees(value: &Number) -> Number {
    let unit = &Number::pi() * &Number::from(Rational::from_parts(1.into(), 180u8.into()));
    value * &unit
}

/// A unit of the file in SI units.
pub(super) fn unit_in_si(unit: &Unit) -> Number {
    let factor = Number::from(unit.factor.clone());
    if unit.degrees {
        degrees(&factor)
    } else {
        factor
    }
}

pub(super) fn too_complex(expression: &Expression) -> Option<Box<Diagnostic>> {
    let message = "the exact value of this expression grows too large";
    let help = "numbers are kept exactly, roots included: use fewer different roots and shorter decimals here";
    Some(Box::new(Diagnostic::new(Code::TooComplex, expression.span, message, "too large to be kept exactly", help)))
}

pub(super) fn is_small(value: &Number) -> bool {
    let bits = |r: &Rational| r.numerator().unsigned_abs().bit_len().max(r.denominator().bit_len());
    value.terms().count() <= MAX_TERMS
        && value.terms().all(|(monomial, coefficient)| {
            bits(coefficient) <= MAX_BITS && monomial.iter().map(|(_, power)| power.unsigned_abs()).sum::<u32>() <= 64
        })
        && nesting(value) <= MAX_NESTING
}

/// How deep roots and inverses stand within each other.
fn nesting(value: &Number) -> usize {
    let of = |atom: &Atom| match atom {
        Atom::Root(_) | Atom::Pi | Atom::Arctangent(_) => 0,
        Atom::RootOf(n) | Atom::Sine(n) | Atom::Cosine(n) | Atom::Inverse(n) => 1 + nesting(n),
        Atom::Sum(sum) => 1 + nesting(sum.terms()),
    };
    value.terms().flat_map(|(monomial, _)| monomial.iter().map(|(atom, _)| of(atom))).max().unwrap_or(0)
}

fn distinct_atoms(value: &Number) -> usize {
    value.terms().flat_map(|(monomial, _)| monomial.iter().map(|(atom, _)| atom)).collect::<std::collections::BTreeSet<_>>().len()
}
