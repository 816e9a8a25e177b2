//! How fast a value grows with the arguments, as the text shows it: its degree in all joint variables of prismatic joints together, in all
//! rates, accelerations, torques and parameters, each for itself.
//!
//! Nothing here sees a cancellation, so a function that adds a high power and takes it away again shows the degree of the power. A quotient
//! grows in the parameters as its numerator less its denominator; in all else no divisor of an arm's equations shrinks.

use super::Arithmetic;
use crate::element::Element;
use crate::formula::Formula;
use crate::program::{Argument, Inputs, Turn};

/// The degree of a value in each argument; `None` for 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Growth(Option<[i64; 7]>);

impl Growth {
    const CONSTANT: Growth = Growth(Some([0; 7]));

    /// An entry of an argument.
    fn entry(argument: Argument) -> Growth {
        Growth(Some(Argument::ALL.map(|counted| i64::from(counted == argument))))
    }

    /// The degree in an argument; 0 has none.
    pub fn of(&self, argument: Argument) -> Option<i64> {
        self.0.zip(Argument::ALL.iter().position(|&counted| counted == argument)).map(|(degrees, k)| degrees[k])
    }

    /// The larger of two in each argument.
    #[must_use]
    pub fn most(self, other: Growth) -> Growth {
        match (self.0, other.0) {
            (Some(a), Some(b)) => Growth(Some(std::array::from_fn(|k| a[k].max(b[k])))),
            (a, b) => Growth(a.or(b)),
        }
    }
}

impl Element for Growth {
    fn plus(&self, other: &Growth) -> Growth {
        self.most(*other)
    }
    fn minus(&self, other: &Growth) -> Growth {
        self.most(*other)
    }
    fn times(&self, other: &Growth) -> Growth {
        Growth(self.0.zip(other.0).map(|(a, b)| std::array::from_fn(|k| a[k].saturating_add(b[k]))))
    }
    fn negated(&self) -> Growth {
        *self
    }
    fn inverse(&self) -> Option<Growth> {
        let degrees = self.0?;
        Some(Growth(Some(std::array::from_fn(
            |k| if Argument::ALL[k] == Argument::Pi { degrees[k].saturating_neg() } else { 0 },
        ))))
    }
    fn is_zero(&self) -> bool {
        self.0.is_none()
    }
}

/// Where degrees come from: constants and angles have none, what is drawn is a parameter.
#[derive(Clone, Copy, Debug)]
pub struct Growths;

impl Arithmetic for Growths {
    type Element = Growth;

    fn integer(&self, value: i64) -> Growth {
        if value == 0 {
            Growth(None)
        } else {
            Growth::CONSTANT
        }
    }

    fn constant(&self, formula: &Formula) -> Option<Growth> {
        Some(if formula.as_rational().is_some_and(|value| value.is_zero()) { Growth(None) } else { Growth::CONSTANT })
    }

    fn draw(&mut self) -> Growth {
        Growth::entry(Argument::Pi)
    }

    fn draw_angle(&mut self) -> (Growth, Growth) {
        (Growth::CONSTANT, Growth::CONSTANT)
    }
}

/// The arguments themselves, for a program.
impl Inputs<Growth> for Growths {
    fn entry(&self, argument: Argument, _: usize) -> Growth {
        Growth::entry(argument)
    }

    fn sine_cosine(&self, _: &[(usize, i64)]) -> (Growth, Growth) {
        (Growth::CONSTANT, Growth::CONSTANT)
    }

    fn turned(&self, _: &[(usize, i64)], _: &Turn<'_, Growth>) -> (Growth, Growth) {
        (Growth::CONSTANT, Growth::CONSTANT)
    }

    fn sign(&self, _: usize) -> Growth {
        Growth::CONSTANT
    }

    fn stribeck(&self, _: usize, _: &Growth) -> Growth {
        Growth::CONSTANT
    }
}
