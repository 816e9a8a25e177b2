//! Objectives for the null space: dq_0 = k_0 (dw/dq)' climbs w without disturbing the task (the book, Sect. 3.5.1, eq. 3.55).
//!
//! With a damped inverse J* it disturbs the task while damping is active, because I - J* J is no projector. J (I - J* J) scales
//! the component of dq_0 along each singular direction by lambda^2 sigma_i / (sigma_i^2 + lambda^2), which is at most lambda/2.

use crate::{
    linalg::lit,
    manipulability::manipulability_gradient,
    robot::Kinematics,
    settings::{self, Setting, SettingError},
    task::Task,
};
use nalgebra::{RealField, SVector};

/// A function w(q) to be increased.
pub trait Objective<R: Kinematics<N>, const N: usize> {
    /// dw/dq, per rad or m; `None` where w has no gradient, and the null space is left alone.
    fn gradient(&self, robot: &R, q: &SVector<R::Real, N>) -> Option<SVector<R::Real, N>>;
}

/// No objective: the joint rates of least norm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoObjective;

impl<R: Kinematics<N>, const N: usize> Objective<R, N> for NoObjective {
    fn gradient(&self, _: &R, _: &SVector<R::Real, N>) -> Option<SVector<R::Real, N>> {
        Some(SVector::zeros())
    }
}

/// The manipulability w of these task rows (the book, eq. 3.56), which need not be those that are followed.
///
/// Where the followed task relaxes a row, take the rows of the *full* task. The w of the relaxed task can grow all the way into a
/// singularity of the full task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Manipulability<const K: usize> {
    /// The rows whose manipulability counts.
    pub task: Task<K>,
}

impl<R: Kinematics<N>, const N: usize, const K: usize> Objective<R, N> for Manipulability<K> {
    fn gradient(&self, robot: &R, q: &SVector<R::Real, N>) -> Option<SVector<R::Real, N>> {
        manipulability_gradient(robot, &self.task, q)
    }
}

/// Distance from the limits of the joints, w = -1/(2 N) sum_i ((q_i - middle_i) / range_i)^2 (the book, eq. 3.57).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointRangeDistance<T, const N: usize> {
    middle: SVector<T, N>,
    range: SVector<T, N>,
}

impl<T: RealField + Copy, const N: usize> JointRangeDistance<T, N> {
    /// Limits of the joint variables, rad or m.
    ///
    /// # Errors
    /// Where a limit is not finite, or the lower one is not below the upper one.
    pub fn new(lower: [T; N], upper: [T; N]) -> Result<Self, SettingError> {
        let (lower, upper) = (SVector::from(lower), SVector::from(upper));
        settings::finite(Setting::PositionLimit, &lower)?;
        settings::finite(Setting::PositionLimit, &upper)?;
        let range = upper - lower;
        settings::positive(Setting::PositionLimit, &range)?;
        Ok(Self { middle: lower + range * lit::<T>(0.5), range })
    }
}

impl<R: Kinematics<N>, const N: usize> Objective<R, N> for JointRangeDistance<R::Real, N> {
    fn gradient(&self, _: &R, q: &SVector<R::Real, N>) -> Option<SVector<R::Real, N>> {
        let scale = -nalgebra::one::<R::Real>() / lit(N as f64);
        Some(SVector::from_fn(|i, _| scale * (q[i] - self.middle[i]) / (self.range[i] * self.range[i])))
    }
}
