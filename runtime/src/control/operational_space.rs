//! Inverse-dynamics control in the operational space, with integral action (the book, Sect. 8.6.2, eqs. 8.116-8.118).
//!
//! From v = J dq follows a = J ddq + dJ dq. With u = B^ y + n^ and
//!
//! ```text
//! y = J^+ (a_d + K_D de + K_P e + K_I int e dt - dJ dq) + (I - J^+ J) y_0
//! ```
//!
//! a perfect model leaves dde + K_D de + K_P e + K_I int e = 0: exactly in linear rows, in angular rows to second order in the
//! whole rotation error ([`Task::error`]). The integral removes the error under a constant uncertainty such as an unknown load.
//! J^+ is the right pseudo-inverse of the task rows, the inverse where M = N. y_0 shapes the motion in the null space of an arm
//! with more joints than task rows; the term vanishes where M = N.
//!
//! The integral runs away while a torque limit keeps the error from closing. So, while a torque is cut, a row of the integral moves
//! only towards zero, and it never leaves its own limit where one is given. Damping keeps the error from closing as well, and the
//! integral moves on: give it a limit ([`OperationalSpace::with_integral_limit`]) where the arm may stay near a singular posture.
//!
//! While damping is active, the direction of the singular value sigma obeys dde + g (K_D de + K_P e + K_I int e) = 0 with g = sigma^2 /
//! (sigma^2 + lambda^2). With equal gains in all rows it is stable for K_I < g K_P K_D. Without damping K_I < K_P K_D suffices.

use super::{check, issue, ControlError, Torque, TorqueLimits};
use crate::{
    linalg::{is_finite, saturate, Damping, RightInverse},
    reference::{OperationalReference, Pose, State},
    robot::Dynamics,
    settings::{self, Setting, SettingError},
    task::Task,
};
use nalgebra::{RealField, SMatrix, SVector};

/// Joint accelerations in the null space of the task: y_0 = K_N (q_N - q) - D_N dq.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NullSpace<T, const N: usize> {
    stiffness: SVector<T, N>,
    damping: SVector<T, N>,
    posture: SVector<T, N>,
}

impl<T: RealField + Copy, const N: usize> NullSpace<T, N> {
    /// Diagonals of K_N, 1/s^2, and D_N, 1/s, and the posture q_N, rad or m.
    ///
    /// With K_N = 0 the joints may drift through the null space: the loop has eigenvalues at 1 and does not count as stable.
    ///
    /// # Errors
    /// Where the stiffness is negative, the damping is not positive, or something is not finite.
    pub fn new(stiffness: [T; N], damping: [T; N], posture: [T; N]) -> Result<Self, SettingError> {
        let (stiffness, damping, posture) = (stiffness.into(), damping.into(), posture.into());
        settings::not_negative(Setting::NullSpace, &stiffness)?;
        settings::positive(Setting::NullSpace, &damping)?;
        settings::finite(Setting::NullSpace, &posture)?;
        Ok(Self { stiffness, damping, posture })
    }

    /// The same about another posture.
    #[cfg(feature = "std")]
    pub(crate) fn about(self, posture: SVector<T, N>) -> Self {
        Self { posture, ..self }
    }

    /// Diagonals of K_N and D_N.
    #[cfg(feature = "std")]
    pub(crate) fn gains(&self) -> (SVector<T, N>, SVector<T, N>) {
        (self.stiffness, self.damping)
    }

    /// y_0 of a state.
    pub(super) fn acceleration(&self, state: &State<T, N>) -> SVector<T, N> {
        self.stiffness.component_mul(&(self.posture - state.q)) - self.damping.component_mul(&state.dq)
    }
}

/// u = B^ J^+ (a_d + K_D de + K_P e + K_I int e dt - dJ dq) + n^.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperationalSpace<T, const N: usize, const M: usize> {
    pub(crate) task: Task<M>,
    pub(crate) k_p: SVector<T, M>,
    pub(crate) k_d: SVector<T, M>,
    pub(crate) k_i: SVector<T, M>,
    pub(crate) period: T,
    pub(crate) integral: SVector<T, M>,
    pub(crate) integral_limit: Option<SVector<T, M>>,
    pub(crate) damping: Option<Damping<T>>,
    pub(crate) null_space: Option<NullSpace<T, N>>,
    pub(crate) limits: Option<TorqueLimits<T, N>>,
}

/// J ddq = a for the error e.
pub(super) struct Demand<T, const N: usize, const M: usize> {
    pub(super) j: SMatrix<T, M, N>,
    pub(super) a: SVector<T, M>,
    pub(super) e: SVector<T, M>,
}

impl<T: RealField + Copy, const N: usize, const M: usize> OperationalSpace<T, N, M> {
    /// Diagonals of K_P, 1/s^2, K_D, 1/s, and K_I, 1/s^3 (zero for a row without integral), row by row of the task; the sampling
    /// period, s.
    ///
    /// # Errors
    /// Where K_P, K_D or the period is not positive and finite, or K_I negative or not finite.
    pub fn new(task: Task<M>, k_p: [T; M], k_d: [T; M], k_i: [T; M], period: T) -> Result<Self, SettingError> {
        let (k_p, k_d, k_i) = (k_p.into(), k_d.into(), k_i.into());
        settings::positive(Setting::Proportional, &k_p)?;
        settings::positive(Setting::Derivative, &k_d)?;
        settings::not_negative(Setting::Integral, &k_i)?;
        settings::positive_scalar(Setting::Period, period)?;
        Ok(Self {
            task,
            k_p,
            k_d,
            k_i,
            period,
            integral: SVector::zeros(),
            integral_limit: None,
            damping: None,
            null_space: None,
            limits: None,
        })
    }

    /// The same with the integral kept within `limit`, m s or rad s, row by row.
    ///
    /// # Errors
    /// Where a limit is negative or not finite.
    pub fn with_integral_limit(self, limit: [T; M]) -> Result<Self, SettingError> {
        let limit = limit.into();
        settings::not_negative(Setting::IntegralLimit, &limit)?;
        Ok(Self { integral_limit: Some(limit), ..self })
    }

    /// The same with a damped inverse near singularities, instead of [`ControlError::Singular`] at them.
    ///
    /// While damping is active K_I has to be smaller: the documentation of this module gives the bound. I - J* J is then no
    /// projector, so y_0 disturbs the task, by at most lambda/2 |y_0| with the lambda of [`Damping`].
    #[must_use]
    pub fn with_damping(self, damping: Damping<T>) -> Self {
        Self { damping: Some(damping), ..self }
    }

    /// The same with the null space under control; without it the null space is left alone, undamped.
    #[must_use]
    pub fn with_null_space(self, null_space: NullSpace<T, N>) -> Self {
        Self { null_space: Some(null_space), ..self }
    }

    /// The same with torques limited.
    #[must_use]
    pub fn with_torque_limits(self, limits: TorqueLimits<T, N>) -> Self {
        Self { limits: Some(limits), ..self }
    }

    /// The present integral of the error, m s or rad s, row by row of the task.
    pub fn integral(&self) -> &SVector<T, M> {
        &self.integral
    }

    /// Torque for one sample, then the step int e += T_s e, with anti-windup.
    ///
    /// # Errors
    /// Where measurement, reference or torque is not finite, or the posture is singular and no damping is set; the integral stays as
    /// it was.
    pub fn torque<R: Dynamics<N, Real = T>>(
        &mut self,
        model: &R,
        reference: &OperationalReference<T>,
        measured: &State<T, N>,
    ) -> Result<Torque<T, N>, ControlError> {
        let Demand { j, a, e } = self.demand(model, reference, measured)?;
        let y_0 = self.null_space.map_or_else(SVector::zeros, |null_space| null_space.acceleration(measured));
        // J^+ (a - J y_0) + y_0 is the law above, and stays it with a damped inverse.
        let a = a - j * y_0;
        let (y, damped) = match &self.damping {
            None => (RightInverse::new(&j).ok_or(ControlError::Singular)?.solve(&a), false),
            Some(damping) => {
                let solution = damping.solve(&j, &a).ok_or(ControlError::AccelerationNotFinite)?;
                (solution.x, solution.damped)
            }
        };
        let torque = issue(model.inverse_dynamics(&measured.q, &measured.dq, &(y + y_0)), &self.limits, damped)?;
        self.advance(&e, torque.limited)?;
        Ok(torque)
    }

    /// What the law asks of the task rows at this sample.
    pub(super) fn demand<R: Dynamics<N, Real = T>>(
        &self,
        model: &R,
        reference: &OperationalReference<T>,
        measured: &State<T, N>,
    ) -> Result<Demand<T, N, M>, ControlError> {
        check(measured, reference.is_finite())?;
        let j = self.task.jacobian(&model.geometric_jacobian(&measured.q));
        let dj = self.task.jacobian(&model.geometric_jacobian_dot(&measured.q, &measured.dq));
        let e = self.task.error(&reference.pose, &Pose::of(model, &measured.q));
        let de = self.task.select(&reference.velocity) - j * measured.dq;
        let a = self.task.select(&reference.acceleration)
            + self.k_d.component_mul(&de)
            + self.k_p.component_mul(&e)
            + self.k_i.component_mul(&self.integral)
            - dj * measured.dq;
        Ok(Demand { j, a, e })
    }

    /// The step of the integral, with anti-windup where the law was `limited`.
    pub(super) fn advance(&mut self, e: &SVector<T, M>, limited: bool) -> Result<(), ControlError> {
        let step = e * self.period;
        let next = SVector::from_fn(|i, _| {
            let (before, after) = (self.integral[i], self.integral[i] + step[i]);
            match limited {
                false => after,
                // Towards zero and not beyond.
                true if before > T::zero() => after.max(T::zero()).min(before),
                true => after.min(T::zero()).max(before),
            }
        });
        if !is_finite(&next) {
            return Err(ControlError::StateNotFinite);
        }
        self.integral = match &self.integral_limit {
            Some(limit) => saturate(&next, limit).value,
            None => next,
        };
        Ok(())
    }
}
