//! Gains and limits, checked once.
//!
//! All gain matrices are diagonal: positive definite where every element is positive.

use nalgebra::{RealField, SVector};

/// What a refused number was meant for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Gain {
    /// K_P, 1/s^2 (or N m/rad, N/m for [`PdGravity`](crate::control::PdGravity)); K of first-order inverse kinematics, 1/s (or 1/(m^2 s),
    /// 1/s for [`JacobianTranspose`](crate::clik::JacobianTranspose)).
    Proportional,
    /// K_D, 1/s (or N m s/rad, N s/m).
    Derivative,
    /// K_I, 1/s^3.
    Integral,
    /// Lambda, 1/s.
    Filter,
    /// K_pi, the weight of the estimate: J per squared unit of its parameter.
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

impl core::fmt::Display for Gain {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Gain::Proportional => "K_P",
            Gain::Derivative => "K_D",
            Gain::Integral => "K_I",
            Gain::Filter => "Lambda",
            Gain::Adaptation => "K_pi",
            Gain::Interval => "the interval of the estimate",
            Gain::LyapunovWeight => "P",
            Gain::UncertaintyBound => "rho",
            Gain::BoundaryLayer => "epsilon",
            Gain::NullSpace => "the null-space gains",
            Gain::PositionLimit => "the position limits",
            Gain::RateLimit => "the rate limits",
            Gain::Tolerance => "the tolerances",
            Gain::IntegralLimit => "the integral limits",
            Gain::TorqueLimit => "the torque limits",
            Gain::Period => "the sampling period",
            Gain::Estimate => "the initial estimate",
        })
    }
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

messages! { GainError,
    GainError::NotFinite { gain, index } => "element {} (from 0) of {} is infinite or NaN", index, gain;
    GainError::NotPositive { gain, index } => "element {} (from 0) of {} is negative, or zero where only a positive value makes sense", index, gain;
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

/// All elements positive; an infinite one is a limit that never acts.
pub(crate) fn positive_or_infinite<T: RealField + Copy, const K: usize>(
    gain: Gain,
    values: &SVector<T, K>,
) -> Result<(), GainError> {
    // A NaN is not below the largest number either.
    positive(gain, &values.map(|x| if x > T::one() { T::one() } else { x }))
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
