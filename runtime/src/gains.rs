//! Gains and limits, checked once.
//!
//! All gain matrices are diagonal: positive definite where every element is positive.

use nalgebra::{RealField, SVector};

/// What a refused number was meant for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gain {
    /// K_P, 1/s^2 (or N m/rad for [`PdGravity`](crate::control::PdGravity)).
    Proportional,
    /// K_D, 1/s (or N m s/rad).
    Derivative,
    /// K_I, 1/s^3.
    Integral,
    /// Lambda, 1/s.
    Filter,
    /// K_pi, the weight of the estimate.
    Adaptation,
    /// The interval that an estimate is projected on.
    Interval,
    /// P of the Lyapunov equation.
    LyapunovWeight,
    /// rho, the bound of the uncertainty.
    UncertaintyBound,
    /// epsilon, the width of the boundary layer.
    BoundaryLayer,
    /// Gains of the null space.
    NullSpace,
    /// Limits of joint variables.
    PositionLimit,
    /// Limits of joint rates.
    RateLimit,
    /// Tolerance of the error of a task row.
    Tolerance,
    /// Limit of the integral.
    IntegralLimit,
    /// Torque limit.
    TorqueLimit,
    /// Sampling period.
    Period,
    /// Initial estimate.
    Estimate,
}

/// Why gains were refused; `index` is the joint, task row or parameter, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GainError {
    /// It is infinite or NaN.
    NotFinite {
        /// What it was meant for.
        gain: Gain,
        /// Which of its elements.
        index: usize,
    },
    /// It is negative, or zero where only a positive value makes sense: the gain matrix would not be positive definite.
    NotPositive {
        /// What it was meant for.
        gain: Gain,
        /// Which of its elements.
        index: usize,
    },
}

fn each<T: RealField + Copy, const K: usize>(
    gain: Gain,
    values: &SVector<T, K>,
    allowed: impl Fn(T) -> bool,
) -> Result<(), GainError> {
    for (index, x) in values.iter().enumerate() {
        if !x.is_finite() {
            return Err(GainError::NotFinite { gain, index });
        }
        if !allowed(*x) {
            return Err(GainError::NotPositive { gain, index });
        }
    }
    Ok(())
}

/// All elements positive and finite.
pub(crate) fn positive<T: RealField + Copy, const K: usize>(gain: Gain, values: &SVector<T, K>) -> Result<(), GainError> {
    each(gain, values, |x| x > T::zero())
}

/// All elements finite and not negative.
pub(crate) fn not_negative<T: RealField + Copy, const K: usize>(gain: Gain, values: &SVector<T, K>) -> Result<(), GainError> {
    each(gain, values, |x| x >= T::zero())
}

/// All elements finite.
pub(crate) fn finite<T: RealField + Copy, const K: usize>(gain: Gain, values: &SVector<T, K>) -> Result<(), GainError> {
    each(gain, values, |_| true)
}

/// Positive and finite.
pub(crate) fn positive_scalar<T: RealField + Copy>(gain: Gain, value: T) -> Result<(), GainError> {
    positive(gain, &SVector::<T, 1>::new(value))
}

/// Finite and not negative.
pub(crate) fn not_negative_scalar<T: RealField + Copy>(gain: Gain, value: T) -> Result<(), GainError> {
    not_negative(gain, &SVector::<T, 1>::new(value))
}
