//! Expression -> polynomial in the names that are symbols.

use super::number::{degrees, is_small, nominal, number, too_complex, unit_in_si, Evaluated};
use super::parameters::Parameters;
use super::Context;
use crate::description::Value;
use crate::document::{Expression, ExpressionKind, Operator};
use crate::exact::{Number, Polynomial};
use crate::kinds::Scalar;

/// Terms of a polynomial in the symbols.
const MAX_POLYNOMIAL: usize = 256;
/// Degree of a polynomial in the symbols.
const MAX_DEGREE: u32 = 12;
/// Terms of all abbreviations, and of all values of an arm: an arm of as many joints as can be, each quantity a sum of ten names, has less.
const MAX_ALL_TERMS: usize = 16_384;

/// Evaluates the expressions of a description.
pub(super) struct Evaluator<'d> {
    pub(super) parameters: Parameters<'d>,
    scalar: Scalar,
    /// The value of each abbreviation; `None` for other names, and without a value.
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
            ExpressionKind::InUnit(a, unit) => &self.symbolic(a)? * &Polynomial::from(unit_in_si(unit)),
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
