//! Numbers that the model computes with: f64, and dual numbers over them, nested for higher derivatives.

use std::fmt::Debug;
use std::ops::{Add, Mul, Neg, Sub};

/// Operations that the model needs of a number.
pub trait Scalar:
    Copy + Debug + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
}

impl Scalar for f64 {
    fn sin_cos(self) -> (f64, f64) {
        f64::sin_cos(self)
    }
}

/// x + ε x', ε² = 0: a value and its derivative along one direction, exact to rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S> {
    /// The value.
    pub value: S,
    /// Its derivative.
    pub derivative: S,
}

impl<S: Scalar> Dual<S> {
    /// The vector `value` moving along `direction`.
    pub fn along(value: &[S], direction: &[S]) -> Vec<Dual<S>> {
        value.iter().zip(direction).map(|(&value, &derivative)| Dual { value, derivative }).collect()
    }
}

impl<S: Scalar> From<f64> for Dual<S> {
    fn from(x: f64) -> Self {
        Dual { value: S::from(x), derivative: S::from(0.0) }
    }
}

impl<S: Scalar> Add for Dual<S> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Dual { value: self.value + o.value, derivative: self.derivative + o.derivative }
    }
}

impl<S: Scalar> Sub for Dual<S> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Dual { value: self.value - o.value, derivative: self.derivative - o.derivative }
    }
}

impl<S: Scalar> Mul for Dual<S> {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Dual { value: self.value * o.value, derivative: self.derivative * o.value + self.value * o.derivative }
    }
}

impl<S: Scalar> Neg for Dual<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Dual { value: -self.value, derivative: -self.derivative }
    }
}

impl<S: Scalar> Scalar for Dual<S> {
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (Dual { value: s, derivative: self.derivative * c }, Dual { value: c, derivative: -(self.derivative * s) })
    }
}
