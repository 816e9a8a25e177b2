//! The matrix exponential by scaling, Taylor series and squaring: exp(M) = (exp(M / 2^s))^(2^s).
//!
//! With |M| / 2^s <= 1/2 the rest of the series after 16 terms is below the rounding of f64: 1/2^17/17! = 2e-20. The function
//! `exp` of nalgebra needs its feature `std`, which also brings matrix products whose bits depend on the machine.

use crate::linalg::lit;
use nalgebra::{DMatrix, RealField};

/// Halvings: a norm of 2^60 and beyond has no exponential worth a digit.
const HALVINGS: u32 = 60;

/// exp(m) of a square matrix.
pub(super) fn exponential<T: RealField + Copy>(m: &DMatrix<T>) -> DMatrix<T> {
    let norm = m.row_iter().map(|row| row.iter().fold(T::zero(), |sum, x| sum + x.abs())).fold(T::zero(), |a, b| a.max(b));
    let (mut halvings, mut scale) = (0, T::one());
    while norm * scale > lit(0.5) && halvings < HALVINGS {
        scale *= lit(0.5);
        halvings += 1;
    }
    let small = m * scale;
    let identity = DMatrix::identity(m.nrows(), m.ncols());
    // Horner: I + M (I + M/2 (I + M/3 (...))).
    let mut sum = identity.clone();
    for k in (1..=16u32).rev() {
        sum = &identity + &small * sum / lit::<T>(f64::from(k));
    }
    for _ in 0..halvings {
        sum = &sum * &sum;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_and_a_decay() {
        let m = DMatrix::from_row_slice(3, 3, &[0.0, -2.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, -3.0]);
        let e = exponential::<f64>(&m);
        assert!((e[(0, 0)] - 2f64.cos()).abs() < 1e-15 && (e[(1, 0)] - 2f64.sin()).abs() < 1e-15);
        assert!((e[(2, 2)] - (-3f64).exp()).abs() < 1e-16);
    }

    #[test]
    fn a_nilpotent_matrix_is_its_series() {
        let m = DMatrix::from_row_slice(2, 2, &[0.0, 1e-3, 0.0, 0.0]);
        assert_eq!(exponential(&m), DMatrix::from_row_slice(2, 2, &[1.0, 1e-3, 0.0, 1.0]));
    }
}
