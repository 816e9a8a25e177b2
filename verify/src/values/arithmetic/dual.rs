//! Dual numbers: a value and its derivative along one direction, (a + a'ε)(b + b'ε) = ab + (a'b + ab')ε with ε² = 0.

use crate::values::element::Element;

/// A value with its derivative.
#[derive(Clone, Debug, PartialEq)]
pub struct Dual<E> {
    /// The value.
    pub value: E,
    /// Its derivative.
    pub rate: E,
}

impl<E: Element> Dual<E> {
    /// A constant.
    pub fn constant(value: &E) -> Dual<E> {
        Dual { rate: value.minus(value), value: value.clone() }
    }

    /// (ab)' = a'b + ab'.
    pub fn rate_of_product(&self, other: &Self) -> E {
        match (self.rate.is_zero(), other.rate.is_zero()) {
            (true, true) => self.rate.clone(),
            (true, false) => self.value.times(&other.rate),
            (false, true) => self.rate.times(&other.value),
            (false, false) => self.value.times(&other.rate).plus(&self.rate.times(&other.value)),
        }
    }
}

impl<E: Element> Element for Dual<E> {
    fn plus(&self, other: &Self) -> Self {
        Dual { value: self.value.plus(&other.value), rate: self.rate.plus(&other.rate) }
    }
    fn minus(&self, other: &Self) -> Self {
        Dual { value: self.value.minus(&other.value), rate: self.rate.minus(&other.rate) }
    }
    fn times(&self, other: &Self) -> Self {
        Dual { value: self.value.times(&other.value), rate: self.rate_of_product(other) }
    }
    fn negated(&self) -> Self {
        Dual { value: self.value.negated(), rate: self.rate.negated() }
    }
    fn inverse(&self) -> Option<Self> {
        let value = self.value.inverse()?;
        let rate = self.rate.times(&value).times(&value).negated();
        Some(Dual { value, rate })
    }
    /// A constant: at 0, where it jumps, too.
    fn sign(&self) -> Self {
        Dual::constant(&self.value.sign())
    }
    fn is_zero(&self) -> bool {
        self.value.is_zero() && self.rate.is_zero()
    }
}
