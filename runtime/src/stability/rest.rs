//! Where the arm rests under a law without an integral.
//!
//! Only the error of such a law compensates a wrong model: the arm rests at q with e = q_d - q where
//!
//! ```text
//! u(q_d; q) - u(q; q) = λ (g(q) + F(0) - u(q; q))    at λ = 1
//! ```
//!
//! u(q_d; q) is the torque at rest at q under the reference q_d. So u(q; q) is the model's gravity and offset F(0) of friction.
//! At λ = 0 the arm rests on its reference. From there Newton's method follows the posture to λ = 1, with adaptive steps. The
//! loop is linearised at the end. With small gains this may be far from the reference, where the load acts differently.

use super::difference::derivative;
use crate::linalg::lit;
use nalgebra::{RealField, SVector};

/// Newton's steps for one λ.
const STEPS: usize = 12;
/// How far the posture may move from one λ to the next, rad or m: a branch is followed, not left.
const NEAR: f64 = 0.1;
/// The shortest step of λ.
const SHORTEST: f64 = 1.0 / 4096.0;
/// All steps of λ, tried ones included.
const MOST: usize = 400;

/// The posture at which `held` is `lack`; `held` is zero at `reference`. `None` where the way there does not end.
pub(super) fn rest<T: RealField + Copy, const N: usize>(
    reference: &SVector<T, N>,
    held: impl Fn(&SVector<T, N>) -> SVector<T, N>,
    lack: impl Fn(&SVector<T, N>) -> SVector<T, N>,
) -> Option<SVector<T, N>> {
    let (mut q, mut share, mut step) = (*reference, T::zero(), T::one());
    for _ in 0..MOST {
        if share >= T::one() {
            return Some(q);
        }
        let next = (share + step).min(T::one());
        match solved(&q, |q| held(q) - lack(q) * next) {
            Some(found) => (q, share, step) = (found, next, step + step),
            None if step > lit(SHORTEST) => step *= lit(0.5),
            None => return None,
        }
    }
    None
}

/// The zero of `f` near `start`, by Newton's method.
fn solved<T: RealField + Copy, const N: usize>(
    start: &SVector<T, N>,
    f: impl Fn(&SVector<T, N>) -> SVector<T, N>,
) -> Option<SVector<T, N>> {
    // As exact as central differences are.
    let enough = T::default_epsilon().cbrt().powi(2);
    let mut q = *start;
    for _ in 0..STEPS {
        let by = nalgebra::linalg::LU::new(nalgebra::DMatrix::from_column_slice(N, N, derivative(&q, &f).as_slice()))
            .solve(&nalgebra::DVector::from_column_slice(f(&q).as_slice()))?;
        let by = SVector::<T, N>::from_column_slice(by.as_slice());
        q -= by;
        // Not a number is no way either.
        if !((q - start).amax() <= lit(NEAR)) {
            return None;
        }
        if by.amax() <= enough * (T::one() + q.amax()) {
            return Some(q);
        }
    }
    None
}
