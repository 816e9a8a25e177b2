//! The two scalars.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use armgen_elementary as elementary;

/// A scalar: `f64` or `f32`.
pub trait Scalar:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + sealed::Sealed
    + 'static
{
    /// 1
    const ONE: Self;

    /// (sin x, cos x) by the crate `libm`.
    fn sin_cos_of_libm(self) -> (Self, Self);

    /// (sin x, cos x) by the standard library.
    fn sin_cos_of_std(self) -> (Self, Self);

    /// (sin x, cos x) by polynomials, where [`Scalar::is_within`] holds; any numbers elsewhere.
    fn sin_cos_within(self) -> (Self, Self);

    /// (sin x, cos x) with the same bits there, of any angle.
    fn sin_cos_of_any(self) -> (Self, Self);

    /// Whether the polynomials hold for this angle.
    fn is_within(self) -> bool;

    /// exp(-|x| / velocity)
    fn fading(self, velocity: Self) -> Self;

    /// 1, -1, or x itself where it is a zero or not a number.
    #[inline(always)]
    fn sign(self) -> Self {
        let zero = Self::default();
        if self > zero {
            Self::ONE
        } else if self < zero {
            -Self::ONE
        } else {
            self
        }
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for f32 {}
}

macro_rules! scalar {
    ($scalar:ident, $libm:path) => {
        impl Scalar for $scalar {
            const ONE: Self = 1.0;

            #[inline]
            fn sin_cos_of_libm(self) -> (Self, Self) {
                $libm(self)
            }

            #[inline]
            fn sin_cos_of_std(self) -> (Self, Self) {
                self.sin_cos()
            }

            #[inline(always)]
            fn sin_cos_within(self) -> (Self, Self) {
                elementary::$scalar::sin_cos_within(self)
            }

            #[inline]
            fn sin_cos_of_any(self) -> (Self, Self) {
                elementary::$scalar::sin_cos_of_any(self)
            }

            #[inline(always)]
            fn is_within(self) -> bool {
                self.abs() <= elementary::$scalar::RANGE
            }

            #[inline]
            fn fading(self, velocity: Self) -> Self {
                elementary::$scalar::fading(self, velocity)
            }
        }
    };
}

scalar!(f64, libm::sincos);
scalar!(f32, libm::sincosf);
