//! PD control with gravity compensation (the book, Sect. 8.5.1, eq. 8.51).
//!
//! With the right gravity in the model, u = g^(q) + K_P e + K_D de holds any posture for all positive K_P and K_D in continuous time. V = 1/2
//! dq' B dq + 1/2 e' K_P e decreases through K_D and viscous friction. For a constant posture de = -dq, which gives eq. 8.51.
//!
//! The law knows no friction: Coulomb friction F_c may hold a joint where |K_P e| <= F_c, and an offset F_0 moves its rest to K_P e = F_0.

use super::{check_joint, issue, ControlError, Torque, TorqueLimits};
use crate::{
    reference::{JointReference, State},
    robot::Dynamics,
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SVector};

/// u = g^(q) + K_P (q_d - q) + K_D (dq_d - dq).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdGravity<T, const N: usize> {
    pub(crate) k_p: SVector<T, N>,
    pub(crate) k_d: SVector<T, N>,
    pub(crate) limits: Option<TorqueLimits<T, N>>,
}

impl<T: RealField + Copy, const N: usize> PdGravity<T, N> {
    /// Diagonals of K_P, N m/rad or N/m, and K_D, N m s/rad or N s/m.
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
        let tau = model.gravity(&measured.q) + self.k_p.component_mul(&e) + self.k_d.component_mul(&de);
        issue(tau, &self.limits, false)
    }
}
