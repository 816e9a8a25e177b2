//! Floats with what rounding can have done to them, states side by side: the equations as a plain program of them computes, and how well.
//!
//! The rules are those of [`mod@crate::floats::companion`], for double precision.

use std::collections::VecDeque;

use super::Arithmetic;
use crate::values::element::Element;
use crate::values::enclosure::Float;
use crate::values::float::LANES;
use crate::values::formula::Formula;

const UNIT: f64 = f64::EPSILON / 2.0;

/// Values, each with a bound of how far it is from the exact one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Running {
    /// The values.
    pub value: [f64; LANES],
    /// The bounds.
    pub error: [f64; LANES],
}

impl Running {
    /// Numbers that are exact.
    pub fn exact(value: [f64; LANES]) -> Running {
        Running { value, error: [0.0; LANES] }
    }

    /// What is computed for numbers of these values, off by so many roundings.
    pub fn rounded(value: [f64; LANES], roundings: f64) -> Running {
        Running { value, error: value.map(|x| roundings * UNIT * x.abs()) }
    }

    fn of(at: impl Fn(usize) -> (f64, f64)) -> Running {
        let mut result = Running::exact([0.0; LANES]);
        for k in 0..LANES {
            let (value, carried) = at(k);
            result.value[k] = value;
            result.error[k] = carried + UNIT * value.abs();
        }
        result
    }
}

impl Element for Running {
    fn plus(&self, other: &Running) -> Running {
        // A sum with 0 is exact.
        if other.is_zero() {
            return *self;
        }
        if self.is_zero() {
            return *other;
        }
        Running::of(|k| (self.value[k] + other.value[k], self.error[k] + other.error[k]))
    }
    fn minus(&self, other: &Running) -> Running {
        self.plus(&other.negated())
    }
    fn times(&self, other: &Running) -> Running {
        let one = |x: &Running| x.value == [1.0; LANES] && x.error == [0.0; LANES];
        if one(other) {
            return *self;
        }
        if one(self) {
            return *other;
        }
        Running::of(|k| {
            let (x, y, a, b) = (self.value[k], other.value[k], self.error[k], other.error[k]);
            (x * y, x.abs() * b + y.abs() * a + a * b)
        })
    }
    fn negated(&self) -> Running {
        Running { value: self.value.map(|x| -x), ..*self }
    }
    fn inverse(&self) -> Option<Running> {
        (!self.is_zero()).then(|| {
            Running::of(|k| {
                let (x, error) = (self.value[k], self.error[k]);
                let left = x.abs() - error;
                let carried = if left > 0.0 { error / (x.abs() * left) } else { f64::INFINITY };
                (1.0 / x, carried)
            })
        })
    }
    /// Not known where the value cannot be told from 0.
    fn sign(&self) -> Running {
        let told = |k: usize| self.value[k].abs() > self.error[k] || self.error[k] == 0.0;
        Running { value: self.value.map(|x| x.sign()), error: std::array::from_fn(|k| if told(k) { 0.0 } else { 2.0 }) }
    }
    fn is_zero(&self) -> bool {
        self.value == [0.0; LANES] && self.error == [0.0; LANES]
    }
}

/// Where such numbers come from; what is drawn are given numbers, in their order.
#[derive(Clone, Debug, Default)]
pub struct RunningNumbers {
    /// What is drawn next; 1 where nothing is left.
    pub given: VecDeque<Running>,
}

impl Arithmetic for RunningNumbers {
    type Element = Running;

    fn integer(&self, value: i64) -> Running {
        Running::exact([value as f64; LANES])
    }

    fn constant(&self, formula: &Formula) -> Option<Running> {
        let value = Float::F64.nearest(formula)?;
        let exact =
            formula.as_rational().is_some_and(|e| crate::values::formula::Rational::try_from(value).is_ok_and(|f| f == *e));
        Some(Running::rounded([value; LANES], if exact { 0.0 } else { 1.0 }))
    }

    fn coordinate(&self, formula: &Formula) -> Option<Running> {
        let Running { value, error } = self.constant(formula)?;
        Some(Running { value, error: error.map(|error| if error == 0.0 { 0.0 } else { UNIT }) })
    }

    fn draw(&mut self) -> Running {
        self.given.pop_front().unwrap_or(Running::exact([1.0; LANES]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_rounded_at_the_length_of_their_vector() {
        let errors = |text: &str| {
            let (numbers, formula) = (RunningNumbers::default(), Formula::parse(text).expect("a formula"));
            [numbers.constant(&formula), numbers.coordinate(&formula)].map(|number| number.expect("a number").error[0])
        };
        let [own, of_vector] = errors("sin(3.141592653589793)");
        assert!(own < 1e-31 && of_vector == UNIT, "{own} {of_vector}");
        assert_eq!([errors("0"), errors("1/2"), errors("1")], [[0.0; 2]; 3]);
    }
}
