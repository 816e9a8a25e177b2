//! Robust control (the book, Sect. 8.5.3, eqs. 8.70-8.86).
//!
//! The model is wrong: with u = B^ y + n^ the acceleration is y - eta, eta the uncertainty. The term w added to y shall beat it.
//! With xi = (e, de), D = (0, I)' and Q from H' Q + Q H = -P, let z = D' Q xi = Q12' e + Q22 de. The added term is
//!
//! ```text
//! w = rho z / |z|                outside the boundary layer, |z| >= epsilon
//!   = rho z / epsilon            inside, where chattering would begin
//! ```
//!
//! Outside the layer V = xi' Q xi decreases as long as rho exceeds |eta|. Since eta holds w, of norm up to rho, this needs
//! |1 - B^-1 B^| < 1. Inside, w is smaller than rho, and V need not decrease.
//!
//! There the law is linear, with gains K_P + rho/epsilon Q12 and K_D + rho/epsilon Q22: the error does not vanish under a
//! constant uncertainty, it is bounded.

use super::{check_joint, issue, ControlError, Torque, TorqueLimits};
use crate::{
    linalg::{diagonal_lyapunov, LyapunovBlocks},
    reference::{JointReference, State},
    robot::Dynamics,
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SVector};

/// The added term w: its size and the layer within which it is linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryLayer<T> {
    /// rho, bound of the uncertainty, of the unit of an acceleration; zero leaves plain inverse dynamics.
    pub rho: T,
    /// epsilon, width of the layer, of the unit of z; positive.
    pub epsilon: T,
}

/// u = B^ (ddq_d + K_D de + K_P e + w) + n^.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robust<T, const N: usize> {
    pub(crate) k_p: SVector<T, N>,
    pub(crate) k_d: SVector<T, N>,
    pub(crate) q: LyapunovBlocks<T, N>,
    pub(crate) layer: BoundaryLayer<T>,
    pub(crate) limits: Option<TorqueLimits<T, N>>,
}

impl<T: RealField + Copy, const N: usize> Robust<T, N> {
    /// Diagonals of K_P, 1/s^2, and K_D, 1/s; of the blocks of P for position and velocity; and the boundary layer.
    ///
    /// # Errors
    /// Where one is not positive and finite (rho may be zero).
    pub fn new(
        k_p: [T; N],
        k_d: [T; N],
        p_position: [T; N],
        p_velocity: [T; N],
        layer: BoundaryLayer<T>,
    ) -> Result<Self, SettingError> {
        let (k_p, k_d, p1, p2) = (k_p.into(), k_d.into(), p_position.into(), p_velocity.into());
        settings::positive(Setting::Proportional, &k_p)?;
        settings::positive(Setting::Derivative, &k_d)?;
        settings::positive(Setting::LyapunovWeight, &p1)?;
        settings::positive(Setting::LyapunovWeight, &p2)?;
        settings::not_negative_scalar(Setting::UncertaintyBound, layer.rho)?;
        settings::positive_scalar(Setting::BoundaryLayer, layer.epsilon)?;
        Ok(Self { k_p, k_d, q: diagonal_lyapunov(&k_p, &k_d, &p1, &p2), layer, limits: None })
    }

    /// The same with torques limited.
    #[must_use]
    pub fn with_torque_limits(self, limits: TorqueLimits<T, N>) -> Self {
        Self { limits: Some(limits), ..self }
    }

    /// z = D' Q xi; the law is linear while |z| < epsilon.
    pub fn z(&self, reference: &JointReference<T, N>, measured: &State<T, N>) -> SVector<T, N> {
        self.q.q12.component_mul(&(reference.q - measured.q)) + self.q.q22.component_mul(&(reference.dq - measured.dq))
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
        let z = self.z(reference, measured);
        let w = z * (self.layer.rho / z.norm().max(self.layer.epsilon));
        let y = reference.ddq + self.k_d.component_mul(&de) + self.k_p.component_mul(&e) + w;
        issue(model.inverse_dynamics(&measured.q, &measured.dq, &y), &self.limits, false)
    }
}
