//! Expression -> exact number, or polynomial in the names that are symbols.
//!
//! Exact values can grow without bound where floats only lose digits (`(1+sqrt(2)+pi)*(...)`, squares of squares of squares), so
//! every intermediate value has a size that it may not exceed.

use std::cmp::Ordering;

use dashu_base::{BitTest, UnsignedAbs};

use super::parameters::Parameters;
use super::{Context, Scalar};
use crate::description::Value;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::document::{excerpt, out_of_range, Expression, ExpressionKind, Operator};
use crate::exact::{Atom, Number, Polynomial, Rational};

/// Terms of an exact number.
const MAX_TERMS: usize = 8;
/// Bits of a numerator or denominator.
const MAX_BITS: usize = 1 << 12;
/// Roots within roots.
const MAX_NESTING: usize = 2;
/// Different roots in a divisor: rationalising it doubles the terms with each.
const MAX_DIVISOR_ATOMS: usize = 3;
/// Terms of a polynomial in the symbols.
const MAX_POLYNOMIAL: usize = 256;
/// Degree of a polynomial in the symbols.
const MAX_DEGREE: u32 = 12;
/// Terms of all abbreviations, and of all values of an arm: an arm of as many joints as can be, each quantity a sum of ten names, has less.
const MAX_ALL_TERMS: usize = 16_384;

type Evaluated<T> = Result<T, Option<Box<Diagnostic>>>;

/// The nominal value of `expression`. `None`: there is none, which is reported here or was already.
pub(super) fn number(
    expression: &Expression,
    parameters: &Parameters<'_>,
    scalar: Scalar,
    diagnostics: &mut Diagnostics,
) -> Option<Number> {
    let value = match nominal(expression, parameters) {
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

fn nominal(expression: &Expression, parameters: &Parameters<'_>) -> Evaluated<Number> {
    let of = |e: &Expression| nominal(e, parameters);
    let value = match &expression.kind {
        ExpressionKind::Decimal(value) => Number::from(value.clone()),
        ExpressionKind::Pi => Number::pi(),
        ExpressionKind::Name(name) => parameters.get(name).and_then(|entry| entry.nominal.clone()).ok_or(None)?,
        ExpressionKind::Negate(a) => -&of(a)?,
        ExpressionKind::Degrees(a) => degrees(&of(a)?),
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
            let (a, divisor, b) = (of(a)?, b, of(b)?);
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

fn degrees(value: &Number) -> Number {
    let unit = &Number::pi() * &Number::from(Rational::from_parts(1.into(), 180u8.into()));
    value * &unit
}

fn too_complex(expression: &Expression) -> Option<Box<Diagnostic>> {
    let message = "the exact value of this expression grows too large";
    let help = "numbers are kept exactly, roots included: use fewer different roots and shorter decimals here";
    Some(Box::new(Diagnostic::new(Code::TooComplex, expression.span, message, "too large to be kept exactly", help)))
}

fn is_small(value: &Number) -> bool {
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

/// Evaluates the expressions of a description.
pub(super) struct Evaluator<'d> {
    pub(super) parameters: Parameters<'d>,
    scalar: Scalar,
    /// What each abbreviation stands for; `None` for other names, and where there is no value.
    abbreviations: Vec<Option<Polynomial>>,
    /// Terms of the polynomials evaluated so far.
    terms: usize,
}

impl<'d> Evaluator<'d> {
    pub(super) fn new(parameters: Parameters<'d>, scalar: Scalar) -> Evaluator<'d> {
        let mut evaluator = Evaluator { parameters, scalar, abbreviations: Vec::new(), terms: 0 };
        for i in 0..evaluator.parameters.entries.len() {
            let entry = &evaluator.parameters.entries[i];
            let value = entry.value.filter(|_| entry.abbreviation && entry.number.is_none() && entry.nominal.is_some());
            // A value that is too complex is reported where it is used.
            let polynomial = value.and_then(|v| evaluator.counted(v).ok());
            evaluator.abbreviations.push(polynomial);
        }
        evaluator.terms = 0;
        evaluator
    }

    /// The polynomial of an expression, as long as all of them together are not too long.
    fn counted(&mut self, expression: &Expression) -> Evaluated<Polynomial> {
        if self.terms > MAX_ALL_TERMS {
            return Err(too_complex(expression));
        }
        let polynomial = self.symbolic(expression)?;
        self.terms += polynomial.terms().count();
        Ok(polynomial)
    }

    fn symbolic(&self, expression: &Expression) -> Evaluated<Polynomial> {
        let number = |e: &Expression| nominal(e, &self.parameters);
        let value = match &expression.kind {
            ExpressionKind::Decimal(_) | ExpressionKind::Pi | ExpressionKind::Root(_) => Polynomial::from(number(expression)?),
            ExpressionKind::Name(name) => {
                let i = self.parameters.position(name).ok_or(None)?;
                let entry = &self.parameters.entries[i];
                match (entry.symbol, &entry.number) {
                    (Some(symbol), _) => Polynomial::variable(symbol),
                    (None, Some(_)) => Polynomial::from(entry.nominal.clone().ok_or(None)?),
                    (None, None) => match self.abbreviations.get(i) {
                        Some(Some(polynomial)) => polynomial.clone(),
                        _ => return Err(too_complex(expression)),
                    },
                }
            }
            ExpressionKind::Negate(a) => -&self.symbolic(a)?,
            ExpressionKind::Degrees(a) => &self.symbolic(a)? * &Polynomial::from(degrees(&Number::one())),
            ExpressionKind::Binary(operator, a, b) => {
                let a = self.symbolic(a)?;
                let b = match operator {
                    Operator::Divide => Polynomial::from(Number::one().checked_div(&number(b)?).ok_or(None)?),
                    _ => self.symbolic(b)?,
                };
                match operator {
                    Operator::Add => &a + &b,
                    Operator::Subtract => &a - &b,
                    Operator::Multiply | Operator::Divide => {
                        if a.terms().count() * b.terms().count() > 2 * MAX_POLYNOMIAL {
                            return Err(too_complex(expression));
                        }
                        &a * &b
                    }
                }
            }
        };
        let small = value.terms().count() <= MAX_POLYNOMIAL
            && value.terms().all(|(powers, c)| powers.values().sum::<u32>() <= MAX_DEGREE && is_small(c));
        if small {
            Ok(value)
        } else {
            Err(too_complex(expression))
        }
    }
}

impl Context<'_> {
    /// The nominal value of `expression`; faults are reported.
    pub(super) fn number(&mut self, expression: &Expression) -> Option<Number> {
        number(expression, &self.evaluator.parameters, self.evaluator.scalar, self.diagnostics)
    }

    /// The polynomial that `expression` is in the symbols; faults are reported.
    pub(super) fn polynomial(&mut self, expression: &Expression) -> Option<Polynomial> {
        let value = self.number(expression)?;
        if expression.named().is_empty() {
            return Some(Polynomial::from(value));
        }
        match self.evaluator.counted(expression) {
            Ok(polynomial) => Some(polynomial),
            Err(fault) => {
                if let Some(fault) = fault {
                    self.diagnostics.push(*fault);
                }
                None
            }
        }
    }

    /// The polynomial of a value that the file must give.
    pub(super) fn given(&mut self, value: &Value) -> Option<Polynomial> {
        value.as_ref().and_then(|e| self.polynomial(e))
    }

    /// The polynomials of three values.
    pub(super) fn polynomials(&mut self, values: &[Value; 3]) -> Option<[Polynomial; 3]> {
        let [x, y, z] = [0, 1, 2].map(|i| self.given(&values[i]));
        Some([x?, y?, z?])
    }

    /// The nominal values of as many expressions.
    pub(super) fn numbers<const N: usize>(&mut self, values: &[Value; N]) -> Option<[Number; N]> {
        let numbers: Vec<Number> =
            values.iter().map(|v| v.as_ref().and_then(|e| self.number(e))).collect::<Vec<_>>().into_iter().flatten().collect();
        numbers.try_into().ok()
    }
}
