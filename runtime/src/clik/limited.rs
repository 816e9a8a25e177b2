//! First-order inverse kinematics within limits, with tasks in order of priority.
//!
//! ```text
//! level 1:  least |J_1 dq - v_1|^2_W + lambda^2 |dq|^2,    v_1 = v_d + K e
//! level 2:  least |J_2 dq - v_2|^2  among the dq with the J_1 dq of level 1, and so on
//! always:   low <= dq <= high
//! ```
//!
//! The box is that of [`JointLimits::rate_bounds`]: after the sample every joint is within its limits and can still brake. It is never
//! empty, so there is always a step. The quadratic program of each level is solved exactly: no rate is cut afterwards.
//!
//! A lower level moves only what the levels above do not see, the null space to rounding. So it never worsens them, at singular postures
//! either. Joint centring, a posture or a second frame's rows are such levels: dq = dq_0 is the level with J = 1.
//!
//! References: Kanoun, Lamiraux, Wieber, *IEEE T-RO* 27, 2011; Escande, Mansard, Wieber, *IJRR* 33, 2014; Del Prete, *RA-L* 3, 2018.

use super::{Bounds, ClikError, JointLimits};
use crate::{
    linalg::{Damping, Levels},
    reference::{OperationalReference, Pose, State},
    robot::Kinematics,
    settings::{self, Setting, SettingError},
    task::Task,
};
use nalgebra::{RealField, SMatrix, SVector};

/// Joint rates within limits: q += T_s dq.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limited<T, const N: usize, const M: usize> {
    task: Task<M>,
    k: SVector<T, M>,
    weight: SVector<T, M>,
    damping: Option<Damping<T>>,
    period: T,
    limits: JointLimits<T, N>,
    keeps_direction: bool,
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitedStep<T, const N: usize, const M: usize> {
    /// Joint variables and rates after the step, rad or m, rad/s or m/s: the state of the next step.
    pub state: State<T, N>,
    /// Error of the task rows before the step, desired minus actual; m or rad.
    pub error: SVector<T, M>,
    /// The share of v_1 that the limits leave, 0 to 1, where the direction is kept; 0 where they leave nothing of it, and 1 without.
    pub scale: T,
    /// Whether a limit changed the step.
    pub limited: bool,
    /// Whether level 1 was damped, near a singularity.
    pub damped: bool,
}

/// A sample with some levels solved.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct LimitedSample<T, const N: usize, const M: usize> {
    levels: Levels<T, N, 2>,
    bounds: Bounds<T, N>,
    limits: JointLimits<T, N>,
    period: T,
    q: SVector<T, N>,
    error: SVector<T, M>,
    scale: T,
    damped: bool,
}

impl<T: RealField + Copy, const N: usize, const M: usize> Limited<T, N, M> {
    /// Diagonal of K, 1/s, for these task rows at the sampling period `period`, s, within `limits`.
    ///
    /// # Errors
    /// Where an element of K or the period is not positive and finite.
    pub fn new(task: Task<M>, k: [T; M], period: T, limits: JointLimits<T, N>) -> Result<Self, SettingError> {
        let k = k.into();
        settings::positive(Setting::Proportional, &k)?;
        settings::positive_scalar(Setting::Period, period)?;
        Ok(Self { task, k, weight: SVector::repeat(T::one()), damping: None, period, limits, keeps_direction: false })
    }

    /// The same with the diagonal of W, the weights of task rows against each other where the limits do not allow all of them.
    ///
    /// # Errors
    /// Where a weight is not positive and finite.
    pub fn with_weights(self, weight: [T; M]) -> Result<Self, SettingError> {
        let weight = weight.into();
        settings::positive(Setting::Weight, &weight)?;
        Ok(Self { weight, ..self })
    }

    /// The same with level 1 damped near singularities. Without it, only the limits bound the rates there.
    #[must_use]
    pub fn with_damping(self, damping: Damping<T>) -> Self {
        Self { damping: Some(damping), ..self }
    }

    /// The same with the direction of v_1 kept: where limits are in the way, the end effector slows down on its path.
    #[must_use]
    pub fn with_direction(self) -> Self {
        Self { keeps_direction: true, ..self }
    }

    /// One step of level 1 alone, with least rates otherwise.
    ///
    /// # Errors
    /// Those of [`Limited::sample`].
    pub fn step<R: Kinematics<N, Real = T>>(
        &self,
        robot: &R,
        state: &State<T, N>,
        reference: &OperationalReference<T>,
    ) -> Result<LimitedStep<T, N, M>, ClikError> {
        Ok(self.sample(robot, state, reference)?.step())
    }

    /// Level 1 at `state`, the joint variables and the rates of the step before, after the reference of this sample.
    ///
    /// # Errors
    /// Where the state or the reference is not finite, or the program has no solution.
    pub fn sample<R: Kinematics<N, Real = T>>(
        &self,
        robot: &R,
        state: &State<T, N>,
        reference: &OperationalReference<T>,
    ) -> Result<LimitedSample<T, N, M>, ClikError> {
        if !state.is_finite() {
            return Err(ClikError::StateNotFinite);
        }
        if !reference.is_finite() {
            return Err(ClikError::ReferenceNotFinite);
        }
        let error = self.task.error(&reference.pose, &Pose::of(robot, &state.q));
        let j = self.task.jacobian(&robot.geometric_jacobian(&state.q));
        let v = self.task.select(&reference.velocity) + self.k.component_mul(&error);
        let lambda = self.damping.map_or_else(T::zero, |damping| damping.at(&j));
        let bounds = self.limits.rate_bounds(state, self.period);
        let unit = SMatrix::<T, N, N>::identity();
        let mut levels = Levels::new([unit, -unit], [bounds.low, -bounds.high]);
        let root = self.weight.map(|w| w.sqrt());
        let (j, v) = (SMatrix::<T, M, N>::from_fn(|i, k| root[i] * j[(i, k)]), root.component_mul(&v));
        let scale =
            if self.keeps_direction { levels.along(&j, &v, lambda) } else { levels.level(&j, &v, lambda).map(|()| T::one()) };
        let scale = scale.map_err(|_| ClikError::NotSolved)?;
        let damped = lambda > T::zero();
        Ok(LimitedSample { levels, bounds, limits: self.limits, period: self.period, q: state.q, error, scale, damped })
    }
}

impl<T: RealField + Copy, const N: usize, const M: usize> LimitedSample<T, N, M> {
    /// Adds a level below: `j` dq near `v`, in what the levels so far leave free.
    ///
    /// # Errors
    /// Where the numbers are not finite, or the program has no solution.
    pub fn then<const L: usize>(mut self, j: &SMatrix<T, L, N>, v: &SVector<T, L>) -> Result<Self, ClikError> {
        self.levels.level(j, v, T::zero()).map_err(|_| ClikError::NotSolved)?;
        Ok(self)
    }

    /// The step of the levels so far.
    pub fn step(&self) -> LimitedStep<T, N, M> {
        let mut dq = *self.levels.x();
        for i in 0..N {
            // Rounding may exceed a bound.
            dq[i] = dq[i].max(self.bounds.low[i]).min(self.bounds.high[i]);
        }
        let q = self.limits.stop(&self.q, &(self.q + dq * self.period)).q;
        LimitedStep {
            state: State { q, dq },
            error: self.error,
            scale: self.scale,
            limited: self.levels.is_limited(),
            damped: self.damped,
        }
    }
}
