//! Number types that can execute a program.

use std::fmt::Debug;

/// An exact number with the operations of a field.
pub trait Element: Clone + PartialEq + Debug + Send + Sync {
    /// a + b.
    fn plus(&self, other: &Self) -> Self;
    /// a - b.
    fn minus(&self, other: &Self) -> Self;
    /// a b.
    fn times(&self, other: &Self) -> Self;
    /// a b + c; floats round once.
    fn times_plus(&self, factor: &Self, other: &Self) -> Self {
        self.times(factor).plus(other)
    }
    /// -a.
    fn negated(&self) -> Self;
    /// 1/a, if it exists.
    fn inverse(&self) -> Option<Self>;
    /// Whether this is 0.
    fn is_zero(&self) -> bool;
    /// The sign: 0 for 0, and opposite for opposite numbers. In a field without an order it is a pseudo-random value determined by the number. So
    /// an equality holds there only if it holds for any odd function, including the sign.
    fn sign(&self) -> Self;
    /// Number of bits of its representation, for types without fixed size.
    fn bits(&self) -> usize {
        0
    }
    /// The quotient, if it exists.
    fn over(&self, other: &Self) -> Option<Self> {
        Some(self.times(&other.inverse()?))
    }
}

impl Element for f64 {
    fn plus(&self, other: &f64) -> f64 {
        self + other
    }
    fn minus(&self, other: &f64) -> f64 {
        self - other
    }
    fn times(&self, other: &f64) -> f64 {
        self * other
    }
    fn times_plus(&self, factor: &f64, other: &f64) -> f64 {
        self.mul_add(*factor, *other)
    }
    fn negated(&self) -> f64 {
        -self
    }
    fn inverse(&self) -> Option<f64> {
        Some(1.0 / self)
    }
    fn is_zero(&self) -> bool {
        *self == 0.0
    }
    fn sign(&self) -> f64 {
        if *self > 0.0 {
            1.0
        } else if *self < 0.0 {
            -1.0
        } else {
            *self
        }
    }
    fn over(&self, other: &f64) -> Option<f64> {
        Some(self / other)
    }
}

impl Element for f32 {
    fn plus(&self, other: &f32) -> f32 {
        self + other
    }
    fn minus(&self, other: &f32) -> f32 {
        self - other
    }
    fn times(&self, other: &f32) -> f32 {
        self * other
    }
    fn times_plus(&self, factor: &f32, other: &f32) -> f32 {
        self.mul_add(*factor, *other)
    }
    fn negated(&self) -> f32 {
        -self
    }
    fn inverse(&self) -> Option<f32> {
        Some(1.0 / self)
    }
    fn is_zero(&self) -> bool {
        *self == 0.0
    }
    fn sign(&self) -> f32 {
        if *self > 0.0 {
            1.0
        } else if *self < 0.0 {
            -1.0
        } else {
            *self
        }
    }
    fn over(&self, other: &f32) -> Option<f32> {
        Some(self / other)
    }
}

/// A pseudo-random number determined by another (Steele, Lea and Flood 2014, SplitMix64).
pub(crate) fn scrambled(value: u64) -> u64 {
    let z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
