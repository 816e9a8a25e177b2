//! Formulas as an arithmetic.

use super::Arithmetic;
use crate::values::formula::{Formula, Rational};

/// The constants of an arm with nothing put in for them.
#[derive(Clone, Copy, Debug)]
pub struct Plain;

impl Arithmetic for Plain {
    type Element = Formula;

    fn integer(&self, value: i64) -> Formula {
        Formula::Rational(Rational::from(value))
    }

    fn constant(&self, formula: &Formula) -> Option<Formula> {
        Some(formula.clone())
    }

    /// There is nothing random among formulas: a fixed number stands for it.
    fn draw(&mut self) -> Formula {
        self.integer(1)
    }
}
