//! Numbers that are given to constructors of this crate (gains, limits, tolerances, periods), checked once.
//!
//! All gain matrices are diagonal: positive definite where every element is positive.

use nalgebra::{RealField, SVector};

/// The setting that a refused number was meant for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Setting {
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
    /// Limits of joint accelerations.
    AccelerationLimit,
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
    /// Stiffness, N/m or N m/rad.
    Stiffness,
    /// Damping ratio.
    DampingRatio,
    /// w_0, below which a direction counts as that of a singular posture, 1/s.
    SlowestDirection,
    /// The share of friction that is compensated.
    FrictionShare,
    /// The rate from which on friction is compensated, rad/s or m/s.
    FrictionLayer,
    /// The width of a wall before a joint limit.
    WallWidth,
    /// The force that a hold bears.
    HoldForce,
    /// The mass of an admittance.
    Mass,
    /// The gain of an observer, 1/s; below 1/T.
    ObserverGain,
    /// A part of the threshold of an observer.
    Threshold,
    /// The part of the information that is left after a second; at most 1.
    Forgetting,
    /// The spread of the error of torques, N m or N.
    TorqueSpread,
    /// The rate below which a joint does not count, rad/s or m/s.
    LeastRate,
    /// The weight of a task row.
    Weight,
    /// The time for which accelerations are held until joints can brake.
    Horizon,
    /// The share of an acceleration limit that braking counts with; at most 1.
    BrakingShare,
    /// The distance of the end effector from a joint.
    ToolDistance,
}

impl core::fmt::Display for Setting {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Setting::Proportional => "K_P",
            Setting::Derivative => "K_D",
            Setting::Integral => "K_I",
            Setting::Filter => "Lambda",
            Setting::Adaptation => "K_pi",
            Setting::Interval => "the interval of the estimate",
            Setting::LyapunovWeight => "P",
            Setting::UncertaintyBound => "rho",
            Setting::BoundaryLayer => "epsilon",
            Setting::NullSpace => "the null-space gains",
            Setting::PositionLimit => "the position limits",
            Setting::RateLimit => "the rate limits",
            Setting::AccelerationLimit => "the acceleration limits",
            Setting::Tolerance => "the tolerances",
            Setting::IntegralLimit => "the integral limits",
            Setting::TorqueLimit => "the torque limits",
            Setting::Period => "the sampling period",
            Setting::Estimate => "the initial estimate",
            Setting::Stiffness => "the stiffness",
            Setting::DampingRatio => "the damping ratio",
            Setting::SlowestDirection => "w_0",
            Setting::FrictionShare => "the share of friction (or of 0.9 less it)",
            Setting::FrictionLayer => "the rate of full friction compensation",
            Setting::WallWidth => "the widths of the walls",
            Setting::HoldForce => "the forces of the hold",
            Setting::Mass => "the mass",
            Setting::ObserverGain => "the gains of the observer (or 1 less their product with the period)",
            Setting::Threshold => "the threshold",
            Setting::Forgetting => "the forgetting (or 1 less it)",
            Setting::TorqueSpread => "the spreads of torques",
            Setting::LeastRate => "the least rate",
            Setting::Weight => "the weights",
            Setting::Horizon => "the horizon",
            Setting::BrakingShare => "the share of braking (or of 1 less it)",
            Setting::ToolDistance => "the distance of the end effector",
        })
    }
}

/// Why a number was refused; `index` is the joint, task row or parameter, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SettingError {
    /// It is infinite or NaN.
    NotFinite {
        /// The setting that the number was meant for.
        setting: Setting,
        /// Which of its elements.
        index: usize,
    },
    /// It is negative, or zero where only a positive value makes sense: the gain matrix would not be positive definite.
    NotPositive {
        /// The setting that the number was meant for.
        setting: Setting,
        /// Which of its elements.
        index: usize,
    },
}

messages! { SettingError,
    SettingError::NotFinite { setting, index } => "element {} (from 0) of {} is infinite or NaN", index, setting;
    SettingError::NotPositive { setting, index } => "element {} (from 0) of {} is negative, or zero where only a positive value makes sense", index, setting;
}

fn each<T: RealField + Copy, const K: usize>(
    setting: Setting,
    values: &SVector<T, K>,
    allowed: impl Fn(T) -> bool,
) -> Result<(), SettingError> {
    for (index, x) in values.iter().enumerate() {
        if !x.is_finite() {
            return Err(SettingError::NotFinite { setting, index });
        }
        if !allowed(*x) {
            return Err(SettingError::NotPositive { setting, index });
        }
    }
    Ok(())
}

/// All elements positive and finite.
pub(crate) fn positive<T: RealField + Copy, const K: usize>(
    setting: Setting,
    values: &SVector<T, K>,
) -> Result<(), SettingError> {
    each(setting, values, |x| x > T::zero())
}

/// All elements positive; an infinite one is a limit that never acts.
pub(crate) fn positive_or_infinite<T: RealField + Copy, const K: usize>(
    setting: Setting,
    values: &SVector<T, K>,
) -> Result<(), SettingError> {
    // A NaN is not below the largest number either.
    positive(setting, &values.map(|x| if x > T::one() { T::one() } else { x }))
}

/// All elements finite and not negative.
pub(crate) fn not_negative<T: RealField + Copy, const K: usize>(
    setting: Setting,
    values: &SVector<T, K>,
) -> Result<(), SettingError> {
    each(setting, values, |x| x >= T::zero())
}

/// All elements finite.
pub(crate) fn finite<T: RealField + Copy, const K: usize>(setting: Setting, values: &SVector<T, K>) -> Result<(), SettingError> {
    each(setting, values, |_| true)
}

/// Positive and finite.
pub(crate) fn positive_scalar<T: RealField + Copy>(setting: Setting, value: T) -> Result<(), SettingError> {
    positive(setting, &SVector::<T, 1>::new(value))
}

/// Finite and not negative.
pub(crate) fn not_negative_scalar<T: RealField + Copy>(setting: Setting, value: T) -> Result<(), SettingError> {
    not_negative(setting, &SVector::<T, 1>::new(value))
}
