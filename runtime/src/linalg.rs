//! Small linear algebra over matrices whose sizes are const generics.
//!
//! nalgebra's `cholesky` carries no bound beyond the sizes themselves; its `lu`, `qr`, `svd` and `symmetric_eigen` ask for
//! arithmetic on sizes that a caller with const generics cannot state. The few factorisations needed are here, and the quadratic
//! program, each bounded in its work and without allocation.

mod cholesky;
mod levels;
mod lyapunov;
mod quadratic_program;
mod right_inverse;
mod singular;

pub use cholesky::Cholesky;
pub(crate) use levels::Levels;
pub use lyapunov::{diagonal_lyapunov, LyapunovBlocks};
pub use quadratic_program::{quadratic_program, NoOptimum, Optimum};
pub use right_inverse::{Damping, DampingBelow, DampingError, RightInverse, Solution};
pub use singular::{left_singular, LeftSingular};

use nalgebra::{RealField, SMatrix, SVector, Unit, Vector3};

/// A decimal constant in the scalar `T`.
#[inline]
pub(crate) fn lit<T: RealField>(x: f64) -> T {
    nalgebra::convert(x)
}

/// The value of `x` as `f64`; `None` for a scalar type that has no such reading.
#[inline]
pub(crate) fn to_f64<T: RealField>(x: T) -> Option<f64> {
    nalgebra::try_convert(x)
}

/// Whether every element is finite: neither infinite nor NaN.
#[inline]
pub fn is_finite<T: RealField + Copy, const R: usize, const C: usize>(m: &SMatrix<T, R, C>) -> bool {
    m.iter().all(|x| x.is_finite())
}

/// The direction of `v`, of any finite length but zero; the square of a length may be beyond the range of the scalar.
pub(crate) fn direction<T: RealField + Copy>(v: &Vector3<T>) -> Option<Unit<Vector3<T>>> {
    if !is_finite(v) {
        return None;
    }
    let largest = v.amax();
    (largest > T::zero()).then(|| Unit::new_normalize(v / largest))
}

/// A vector within its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limited<T, const N: usize> {
    /// The vector.
    pub value: SVector<T, N>,
    /// Whether it had to be changed.
    pub is_limited: bool,
}

/// `x` with every element cut to `[-bound, bound]`.
#[inline]
pub fn saturate<T: RealField + Copy, const N: usize>(x: &SVector<T, N>, bound: &SVector<T, N>) -> Limited<T, N> {
    let mut cut = false;
    let y = x.zip_map(bound, |x, b| {
        if x > b {
            cut = true;
            b
        } else if x < -b {
            cut = true;
            -b
        } else {
            x
        }
    });
    Limited { value: y, is_limited: cut }
}
