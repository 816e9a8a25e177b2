//! Limits of a timing.

use crate::settings::{not_negative_scalar, positive_or_infinite, Setting, SettingError};
use nalgebra::{RealField, SVector};

/// Limits of the joints; an infinite one never acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<T, const N: usize> {
    pub(super) velocity: [T; N],
    pub(super) acceleration: [T; N],
    pub(super) effort: [[T; 2]; N],
    pub(super) tool: Option<ToolLimit<T>>,
}

/// Limits of the end effector's speed, and where it is: lengths bound derivatives. An infinite limit never acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolLimit<T> {
    /// Of its velocity's length, m/s.
    pub speed: T,
    /// Of its angular velocity's length, rad/s.
    pub turn_rate: T,
    /// The joint whose link carries it, counted from 0; beyond the last one, the last one.
    pub joint: usize,
    /// Its distance from that joint's origin, a point on the axis as of [`LinkBound`](super::LinkBound), m. A distance that is too small
    /// makes bounds false.
    pub distance: T,
}

impl<T: RealField + Copy, const N: usize> Limits<T, N> {
    /// Limits of |dq|, rad/s or m/s; `VELOCITY_LIMITS` of an emitted robot.
    ///
    /// # Errors
    /// Where a limit is not positive, or its square is no number.
    pub fn velocity(limits: [T; N]) -> Result<Self, SettingError> {
        usable(Setting::RateLimit, limits)?;
        let infinite = T::one() / T::zero();
        Ok(Self { velocity: limits, acceleration: [infinite; N], effort: [[-infinite, infinite]; N], tool: None })
    }

    /// And of |ddq|, rad/s² or m/s².
    ///
    /// # Errors
    /// Where a limit is not positive, or its square is no number.
    pub fn with_acceleration(self, limits: [T; N]) -> Result<Self, SettingError> {
        usable(Setting::AccelerationLimit, limits)?;
        Ok(Self { acceleration: limits, ..self })
    }

    /// And of the torque (force) at the joint, `lower <= tau <= upper`, N m or N; `EFFORT_LIMITS` of an emitted robot bound both sides.
    ///
    /// # Errors
    /// Where the upper limit is not positive or the lower one not negative, or the square of one is no number.
    pub fn with_effort(self, lower: [T; N], upper: [T; N]) -> Result<Self, SettingError> {
        usable(Setting::TorqueLimit, upper)?;
        usable(Setting::TorqueLimit, lower.map(|limit| -limit))?;
        let mut effort = [[T::zero(); 2]; N];
        for ((to, lower), upper) in effort.iter_mut().zip(lower).zip(upper) {
            *to = [lower, upper];
        }
        Ok(Self { effort, ..self })
    }

    /// And of the end effector.
    ///
    /// # Errors
    /// Where a limit is not positive, its square is no number, or the distance is negative.
    pub fn with_tool(self, tool: ToolLimit<T>) -> Result<Self, SettingError> {
        usable(Setting::RateLimit, [tool.speed, tool.turn_rate])?;
        not_negative_scalar(Setting::ToolDistance, tool.distance)?;
        Ok(Self { tool: Some(tool), ..self })
    }
}

impl<T: Copy> ToolLimit<T> {
    /// Of speed and of turn rate.
    pub(super) fn both(&self) -> [T; 2] {
        [self.speed, self.turn_rate]
    }
}

/// Positive or infinite, and neither so small nor, if finite, so large that squares of numbers of this size are none.
fn usable<T: RealField + Copy, const N: usize>(setting: Setting, limits: [T; N]) -> Result<(), SettingError> {
    let (eps, infinite) = (T::default_epsilon(), T::one() / T::zero());
    let judged = limits.map(|limit| match limit {
        _ if limit < eps * eps => T::zero(),
        _ if limit * eps * eps > T::one() && limit < infinite => -infinite,
        _ => limit,
    });
    positive_or_infinite(setting, &SVector::from(judged))
}
