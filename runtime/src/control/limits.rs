//! Torque limits.

use crate::{
    linalg::{saturate, Limited},
    settings::{positive_or_infinite, Setting, SettingError},
};
use nalgebra::{RealField, SVector};

/// The largest torque (force) that each joint can give, to either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimits<T, const N: usize> {
    bound: SVector<T, N>,
}

impl<T: RealField + Copy, const N: usize> TorqueLimits<T, N> {
    /// The limits of the joints, N m or N, on the joint side of the gears. An infinite limit never acts, so `EFFORT_LIMITS` of an
    /// emitted robot fits even where its description lacks some limits.
    ///
    /// # Errors
    /// Where a limit is not positive.
    pub fn new(bound: [T; N]) -> Result<Self, SettingError> {
        let bound = SVector::from(bound);
        positive_or_infinite(Setting::TorqueLimit, &bound)?;
        Ok(Self { bound })
    }

    /// The limits.
    pub(super) fn bound(&self) -> &SVector<T, N> {
        &self.bound
    }

    /// `tau` within the limits.
    pub fn apply(&self, tau: &SVector<T, N>) -> Limited<T, N> {
        saturate(tau, &self.bound)
    }
}
