//! Second-order closed-loop inverse kinematics: joint accelerations, hence references for controllers.
//!
//! ddq = J^+ (a_d + K_D de + K_P e - dJ dq) (the book, Sect. 3.7.4, eq. 3.100). The accelerations are held from sample to sample,
//! so the integration matters. Explicit Euler, q += T_s dq with the old rates, lags the motion under a held acceleration by half
//! a step. The hold-consistent form is this motion exactly:
//!
//! ```text
//! q += T_s dq + 1/2 T_s^2 ddq,    dq += T_s ddq
//! ```
//!
//! A controller that receives (q_d, dq_d, ddq_d) and holds its torque needs the hold-consistent form. With explicit Euler q_d and
//! ddq_d contradict each other, and the controller follows the contradiction.
//!
//! One sample of the hold-consistent form is inconsistent too: the sample at which a joint meets its limit. At the next sample
//! the joint is at the limit with rate 0, so ddq = -dq / T_s. Its q differs from the held motion by at most T_s / 2 times the
//! larger of its rate and the rate without the limit.
//!
//! Sampled, errors of linear rows die away where
//!
//! ```text
//! k_D T_s < 2  and  k_P T_s < 2 k_D                            hold-consistent
//! k_P T_s < k_D  and  4 - 2 k_D T_s + k_P T_s^2 > 0            explicit Euler
//! ```

use super::{ClikError, JointLimits, Outcome, WithinRange};
use crate::{
    linalg::{is_finite, lit, Damping, Limited, RightInverse},
    reference::{JointReference, OperationalReference, Pose, State},
    robot::Kinematics,
    settings::{self, Setting, SettingError},
    task::Task,
};
use nalgebra::{RealField, SVector};

/// How held accelerations become rates and positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integration {
    /// q += T_s dq, then dq += T_s ddq.
    ExplicitEuler,
    /// q += T_s dq + 1/2 T_s^2 ddq, dq += T_s ddq: exact for a held acceleration.
    HoldConsistent,
}

/// ddq = J^+ (a_d + K_D de + K_P e - dJ dq) at a sampling period, with limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondOrder<T, const N: usize, const M: usize> {
    task: Task<M>,
    k_p: SVector<T, M>,
    k_d: SVector<T, M>,
    period: T,
    integration: Integration,
    limits: JointLimits<T, N>,
    tolerance: SVector<T, M>,
    damping: Option<Damping<T>>,
    null_damping: T,
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondOrderStep<T, const N: usize, const M: usize> {
    /// The joint reference of this sample: the state that the step started from, and the acceleration held from then on.
    pub reference: JointReference<T, N>,
    /// The state at the next sample.
    pub next: State<T, N>,
    /// Error of the task rows at this sample, desired minus actual; m or rad.
    pub error: SVector<T, M>,
    /// What happened.
    pub outcome: Outcome,
}

impl<T: RealField + Copy, const N: usize, const M: usize> SecondOrder<T, N, M> {
    /// Diagonals of K_P, 1/s^2, and K_D, 1/s, for these task rows; the sampling period, s; the integration; limits; and the errors,
    /// m or rad, that count as converged.
    ///
    /// # Errors
    /// Where a gain, the period or a tolerance is not positive and finite.
    pub fn new(
        task: Task<M>,
        k_p: [T; M],
        k_d: [T; M],
        period: T,
        integration: Integration,
        limits: JointLimits<T, N>,
        tolerance: [T; M],
    ) -> Result<Self, SettingError> {
        let (k_p, k_d, tolerance) = (k_p.into(), k_d.into(), tolerance.into());
        settings::positive(Setting::Proportional, &k_p)?;
        settings::positive(Setting::Derivative, &k_d)?;
        settings::positive_scalar(Setting::Period, period)?;
        settings::positive(Setting::Tolerance, &tolerance)?;
        Ok(Self { task, k_p, k_d, period, integration, limits, tolerance, damping: None, null_damping: T::zero() })
    }

    /// The same with a damped inverse near singularities, instead of [`ClikError::Singular`] at them.
    ///
    /// While damping is active, I - J* J is no projector, so null-space damping disturbs the task, by at most lambda/2 times its
    /// size with the lambda of [`Damping`].
    #[must_use]
    pub fn with_damping(self, damping: Damping<T>) -> Self {
        Self { damping: Some(damping), ..self }
    }

    /// The same with joint rates in the null space decaying at this rate, 1/s; without it they persist.
    ///
    /// # Errors
    /// Where the rate is negative or not finite.
    pub fn with_null_space_damping(self, rate: T) -> Result<Self, SettingError> {
        settings::not_negative_scalar(Setting::NullSpace, rate)?;
        Ok(Self { null_damping: rate, ..self })
    }

    /// One step from `state` after the reference of this sample.
    ///
    /// # Errors
    /// Where the state or the reference is not finite, or the posture is singular and no damping is set.
    pub fn step<R: Kinematics<N, Real = T>>(
        &self,
        robot: &R,
        state: &State<T, N>,
        reference: &OperationalReference<T>,
    ) -> Result<SecondOrderStep<T, N, M>, ClikError> {
        if !state.is_finite() {
            return Err(ClikError::StateNotFinite);
        }
        if !reference.is_finite() {
            return Err(ClikError::ReferenceNotFinite);
        }
        let State { q, dq } = state;
        let j = self.task.jacobian(&robot.geometric_jacobian(q));
        let dj = self.task.jacobian(&robot.geometric_jacobian_dot(q, dq));
        let error = self.task.error(&reference.pose, &Pose::of(robot, q));
        let de = self.task.select(&reference.velocity) - j * dq;
        let ddq_0 = -dq * self.null_damping;
        let a = self.task.select(&reference.acceleration) + self.k_d.component_mul(&de) + self.k_p.component_mul(&error)
            - dj * dq
            - j * ddq_0;
        let (ddq, damped) = match &self.damping {
            None => (RightInverse::new(&j).ok_or(ClikError::Singular)?.solve(&a), false),
            Some(damping) => {
                let solution = damping.solve(&j, &a).ok_or(ClikError::RatesNotFinite)?;
                (solution.x, solution.damped)
            }
        };
        let ddq = ddq + ddq_0;
        if !is_finite(&ddq) {
            return Err(ClikError::RatesNotFinite);
        }
        let (ddq, next, slowed, stopped) = self.integrate(state, ddq);
        let converged = error.iter().zip(self.tolerance.iter()).all(|(e, tolerance)| e.abs() <= *tolerance);
        let outcome = if converged {
            Outcome::Converged
        } else if let Some(joint) = stopped {
            Outcome::JointLimit { joint }
        } else if damped {
            Outcome::Damped
        } else if slowed {
            Outcome::RateLimited
        } else {
            Outcome::Tracking
        };
        Ok(SecondOrderStep { reference: JointReference { q: *q, dq: *dq, ddq }, next, error, outcome })
    }

    /// The acceleration that respects the limits, the next state, and whether rates or a joint were held back.
    fn integrate(&self, state: &State<T, N>, ddq: SVector<T, N>) -> (SVector<T, N>, State<T, N>, bool, Option<usize>) {
        let State { q, dq } = state;
        let h = self.period;
        let Limited { value: mut next_dq, is_limited: slowed } = self.limits.slow_down(&(dq + ddq * h));
        // Only a step that was held back changes the acceleration: (dq + h ddq - dq) / h would not give ddq back to the last bit.
        let ddq = if slowed { (next_dq - dq) / h } else { ddq };
        let way = match self.integration {
            Integration::ExplicitEuler => dq * h,
            Integration::HoldConsistent => dq * h + ddq * (h * h * lit(0.5)),
        };
        let WithinRange { q: next_q, mut stopped } = self.limits.stop(q, &(q + way));
        let mut ddq = ddq;
        for i in 0..N {
            // A joint at its stop has no rate outwards, whether it arrives there or was there already.
            if self.limits.is_outwards(i, next_q[i], next_dq[i]) {
                next_dq[i] = T::zero();
                ddq[i] = -dq[i] / h;
                stopped = stopped.or(Some(i));
            }
        }
        (ddq, State { q: next_q, dq: next_dq }, slowed, stopped)
    }
}
