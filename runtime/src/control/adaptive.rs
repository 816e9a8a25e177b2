//! Adaptive control (Slotine, Li, 1987; the book, Sect. 8.5.4, eqs. 8.88-8.97).
//!
//! The dynamics are linear in the parameters: B ddq_r + C dq_r + F + g = Y(q, dq, dq_r, ddq_r) pi + tau_known. With the reference rates
//! dq_r = dq_d + Lambda e, ddq_r = ddq_d + Lambda de and sigma = dq_r - dq,
//!
//! ```text
//! u = Y pi^ + tau_known + F_l^(q, dq) + K_D sigma,        d pi^/dt = K_pi^-1 Y' sigma
//! ```
//!
//! F_l^ is the friction that grows with the load; it is not linear in the parameters, so the law takes it from the model. Where
//! it equals the friction of the plant, V = 1/2 sigma' B sigma + e' Lambda K_D e + 1/2 (pi^ - pi)' K_pi (pi^ - pi) decreases.
//! Then the errors vanish, although the estimate need not be right. Where another load makes it differ, dV/dt gains the term
//! sigma' (F_l^ - F_l): the errors need not vanish, and without a projection the estimate may drift.
//!
//! That holds in continuous time. The sampled law is unstable where Lambda and K_D are too large for the period, whatever V
//! suggests: compute the spectral radius of the sampled loop first (module `stability`).

use super::{check_joint, issue, ControlError, Torque, TorqueLimits};
use crate::{
    linalg::is_finite,
    reference::{JointReference, State},
    robot::Regressor,
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SVector};

/// An interval that the estimate is known to lie in; the estimate is projected onto it after each step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<T, const P: usize> {
    lower: SVector<T, P>,
    upper: SVector<T, P>,
}

impl<T: RealField + Copy, const P: usize> Interval<T, P> {
    /// Bounds of each parameter; equal bounds pin it.
    ///
    /// # Errors
    /// Where a bound is not finite, or the lower one exceeds the upper one.
    pub fn new(lower: [T; P], upper: [T; P]) -> Result<Self, SettingError> {
        let (lower, upper) = (SVector::from(lower), SVector::from(upper));
        settings::finite(Setting::Interval, &lower)?;
        settings::finite(Setting::Interval, &upper)?;
        // Not by their difference, which may be beyond the range of the scalar.
        match (0..P).find(|i| lower[*i] > upper[*i]) {
            Some(index) => Err(SettingError::NotPositive { setting: Setting::Interval, index }),
            None => Ok(Self { lower, upper }),
        }
    }
}

/// u = Y(q, dq, dq_r, ddq_r) pi^ + tau_known + F_l^ + K_D sigma, with pi^ adapted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive<T, const N: usize, const P: usize> {
    pub(crate) lambda: SVector<T, N>,
    pub(crate) k_d: SVector<T, N>,
    /// Diagonal of K_pi^-1, zero for frozen parameters.
    pub(crate) adaptation_gain: SVector<T, P>,
    pub(crate) estimate: SVector<T, P>,
    pub(crate) period: T,
    pub(crate) interval: Option<Interval<T, P>>,
    pub(crate) limits: Option<TorqueLimits<T, N>>,
}

impl<T: RealField + Copy, const N: usize, const P: usize> Adaptive<T, N, P> {
    /// Diagonals of three gains: Lambda in 1/s; K_D in N m s/rad or N s/m; K_pi in J per squared unit of its parameter (J/kg^2
    /// for a mass). Then the initial estimate, and the sampling period in s.
    ///
    /// # Errors
    /// Where a gain or the period is not positive and finite, or the estimate is not finite.
    pub fn new(lambda: [T; N], k_d: [T; N], k_pi: [T; P], estimate: [T; P], period: T) -> Result<Self, SettingError> {
        let (lambda, k_d, k_pi, estimate) = (lambda.into(), k_d.into(), SVector::from(k_pi), estimate.into());
        settings::positive(Setting::Filter, &lambda)?;
        settings::positive(Setting::Derivative, &k_d)?;
        settings::positive(Setting::Adaptation, &k_pi)?;
        settings::finite(Setting::Estimate, &estimate)?;
        settings::positive_scalar(Setting::Period, period)?;
        let adaptation_gain = k_pi.map(|k| T::one() / k);
        Ok(Self { lambda, k_d, adaptation_gain, estimate, period, interval: None, limits: None })
    }

    /// The same with the estimate kept in an interval: an adaptation that would leave it stops at its bound.
    ///
    /// The projection does not increase V where the true parameters lie in the interval. Frozen parameters stay where they are, in it or not.
    #[must_use]
    pub fn with_projection(mut self, interval: Interval<T, P>) -> Self {
        self.estimate = project(&self.estimate, &interval, &self.adaptation_gain);
        self.interval = Some(interval);
        self
    }

    /// The same with the parameters marked `true` kept at their present estimate.
    #[must_use]
    pub fn with_frozen(mut self, frozen: [bool; P]) -> Self {
        for (gain, frozen) in self.adaptation_gain.iter_mut().zip(frozen) {
            if frozen {
                *gain = T::zero();
            }
        }
        self
    }

    /// The same with torques limited; while a limit is active the estimate rests.
    #[must_use]
    pub fn with_torque_limits(self, limits: TorqueLimits<T, N>) -> Self {
        Self { limits: Some(limits), ..self }
    }

    /// The same controller with the estimate at the true parameters. Where the interval excludes a parameter, it takes the
    /// nearest bound; a frozen parameter keeps its present value. A parameter at such a bound does not move, like a frozen one.
    #[cfg(feature = "std")]
    pub(crate) fn at_rest(&self, parameters: &SVector<T, P>) -> Self {
        let mut settled = *self;
        for i in 0..P {
            if self.adaptation_gain[i] > T::zero() {
                settled.estimate[i] = parameters[i];
                if let Some(interval) = &self.interval {
                    settled.estimate[i] = parameters[i].max(interval.lower[i]).min(interval.upper[i]);
                }
                if settled.estimate[i] != parameters[i] {
                    settled.adaptation_gain[i] = T::zero();
                }
            }
        }
        settled
    }

    /// The present estimate pi^.
    pub fn estimate(&self) -> &SVector<T, P> {
        &self.estimate
    }

    /// The law in continuous time, from any estimate: torque and d pi^/dt, without a step of the estimate.
    ///
    /// # Errors
    /// Where measurement, reference or torque is not finite.
    pub fn law<R: Regressor<N, P, Real = T>>(
        &self,
        model: &R,
        reference: &JointReference<T, N>,
        measured: &State<T, N>,
        estimate: &SVector<T, P>,
    ) -> Result<(Torque<T, N>, SVector<T, P>), ControlError> {
        check_joint(measured, reference)?;
        let e = reference.q - measured.q;
        let de = reference.dq - measured.dq;
        let dqr = reference.dq + self.lambda.component_mul(&e);
        let ddqr = reference.ddq + self.lambda.component_mul(&de);
        let sigma = dqr - measured.dq;
        let y = model.regressor(&measured.q, &measured.dq, &dqr, &ddqr);
        let known = model.known_torque(&measured.q, &measured.dq, &dqr, &ddqr);
        let known = known + model.load_friction(&measured.q, &measured.dq);
        let torque = issue(y * estimate + known + self.k_d.component_mul(&sigma), &self.limits, false)?;
        Ok((torque, y.tr_mul(&sigma).component_mul(&self.adaptation_gain)))
    }

    /// Torque for one sample, then the step pi^ += T_s K_pi^-1 Y' sigma, projected.
    ///
    /// # Errors
    /// Where measurement, reference, torque or the next estimate is not finite; the estimate stays as it was.
    pub fn torque<R: Regressor<N, P, Real = T>>(
        &mut self,
        model: &R,
        reference: &JointReference<T, N>,
        measured: &State<T, N>,
    ) -> Result<Torque<T, N>, ControlError> {
        let (torque, rate) = self.law(model, reference, measured, &self.estimate)?;
        if !torque.limited {
            let next = self.estimate + rate * self.period;
            if !is_finite(&next) {
                return Err(ControlError::StateNotFinite);
            }
            self.estimate = match &self.interval {
                Some(interval) => project(&next, interval, &self.adaptation_gain),
                None => next,
            };
        }
        Ok(torque)
    }
}

/// Projects the estimate onto the interval, except frozen parameters (gain 0).
fn project<T: RealField + Copy, const P: usize>(
    estimate: &SVector<T, P>,
    interval: &Interval<T, P>,
    gain: &SVector<T, P>,
) -> SVector<T, P> {
    SVector::from_fn(|i, _| match gain[i] == T::zero() {
        true => estimate[i],
        false => estimate[i].max(interval.lower[i]).min(interval.upper[i]),
    })
}
