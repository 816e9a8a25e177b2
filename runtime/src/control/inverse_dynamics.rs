//! Inverse-dynamics control (the book, Sect. 8.5.2, eqs. 8.56-8.60).
//!
//! With u = B y + n and a perfect model, ddq = y. The choice y = ddq_d + K_D de + K_P e leaves dde + K_D de + K_P e = 0. The n
//! errors are decoupled, linear and of second order, with natural frequency sqrt(k_P) and damping k_D / (2 sqrt(k_P)).

use super::{check_joint, issue, ControlError, Torque, TorqueLimits};
use crate::{
    reference::{JointReference, State},
    robot::Dynamics,
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SVector};

/// u = B^ (ddq_d + K_D de + K_P e) + n^.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseDynamics<T, const N: usize> {
    pub(crate) k_p: SVector<T, N>,
    pub(crate) k_d: SVector<T, N>,
    pub(crate) limits: Option<TorqueLimits<T, N>>,
}

impl<T: RealField + Copy, const N: usize> InverseDynamics<T, N> {
    /// Diagonals of K_P, 1/s^2, and K_D, 1/s.
    ///
    /// # Errors
    /// Where one is not positive and finite.
    pub fn new(k_p: [T; N], k_d: [T; N]) -> Result<Self, SettingError> {
        let (k_p, k_d) = (k_p.into(), k_d.into());
        settings::positive(Setting::Proportional, &k_p)?;
        settings::positive(Setting::Derivative, &k_d)?;
        Ok(Self { k_p, k_d, limits: None })
    }

    /// The same with torques limited.
    #[must_use]
    pub fn with_torque_limits(self, limits: TorqueLimits<T, N>) -> Self {
        Self { limits: Some(limits), ..self }
    }

    /// Torque for one sample.
    ///
    /// # Errors
    /// Where measurement, reference or torque is not finite.
    pub fn torque<R: Dynamics<N, Real = T>>(
        &self,
        model: &R,
        reference: &JointReference<T, N>,
        measured: &State<T, N>,
    ) -> Result<Torque<T, N>, ControlError> {
        check_joint(measured, reference)?;
        let e = reference.q - measured.q;
        let de = reference.dq - measured.dq;
        let y = reference.ddq + self.k_d.component_mul(&de) + self.k_p.component_mul(&e);
        issue(model.inverse_dynamics(&measured.q, &measured.dq, &y), &self.limits, false)
    }
}
