//! Impedance control: the end effector as a spring and a damper, with the arm's own inertia (Hogan, 1985; Albu-Schaeffer, Ott,
//! Hirzinger, IJRR 26, 2007).
//!
//! ```text
//! u = g(q) + J' (K e + D de) + B ddq_r + C(q, dq) dq_r + L P L' y_0,    e = x_d - x,  de = v_d - J dq
//! ```
//!
//! **Motion.** dq_r and ddq_r are the joint rates and accelerations of the reference, J dq_r = v_d and J ddq_r + dJ dq_r = a_d. They
//! vanish for a pose that is held. The Coriolis matrix multiplies dq_r, not dq. With s = dq - dq_r then B ds + C s = J' (K e + D de),
//! and dB/dt - 2 C is skew, so
//!
//! ```text
//! V = 1/2 s' B s + 1/2 e' K e,    dV/dt = -de' D de + (power of the hand)
//! ```
//!
//! The arm is passive: a hand gets no more energy out of it than it has put in. Cancelling C dq instead would leave 1/2 s' (dB/dt) s,
//! whose sign is free. That e' K e is an energy holds for linear rows, and for angular rows with equal stiffness.
//!
//! **Inertia.** The inertia is not shaped, so no force is measured. With B = L L' and G = K^1/2 J L^-T, singular values w_i, left vectors
//! u_i and right vectors r_i, w_i is the natural frequency of a direction, 1/s, since
//! Lambda = (J B^-1 J')^-1 = K^1/2 U diag(w^-2) U' K^1/2.
//! A damping ratio z in every direction is the double diagonalisation of Lambda and K:
//!
//! ```text
//! D = 2 z K^1/2 U diag(1 / w_i) U' K^1/2
//! ```
//!
//! Joint rates then decay at 2 z w_i, and at the largest w_i the sampling decides: choose K so that 2 z w_i T is below 1/2.
//!
//! **Singular postures.** A direction that the arm cannot move in has w_i = 0, and J' u = 0 along it: nothing else happens to a pose
//! that is held. For D, for dq_r and for the null space w_i^-2 becomes 1 / (w_i^2 + l^2), l = w_0 - w_i, where w_i is below w_0.
//!
//! **Null space.** y_0 = K_N (q_N - q) - D_N dq is the acceleration of [`NullSpace`]. P = 1 - sum r_i r_i' leaves the task alone, as the
//! dynamically consistent projection 1 - J' Lambda J B^-1 = L P L^-1 does. L P L' is symmetric: with equal D_N its damping takes
//! energy from every motion. The spring of the null space is no gradient, so V does not hold it.
//!
//! The book has the law with C dq cancelled in Sect. 9.3.

use super::{check, issue, ControlError, FrictionCompensation, NullSpace, Torque, TorqueLimits};
use crate::{
    linalg::{left_singular, lit, Cholesky, LeftSingular},
    reference::{OperationalReference, Pose, State},
    robot::Dynamics,
    settings::{self, Setting, SettingError},
    task::Task,
};
use nalgebra::{RealField, SMatrix, SVector};

/// How the damping D is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Damper<T, const M: usize> {
    /// The same ratio in every direction.
    Ratio(T),
    /// Row by row.
    Diagonal(SVector<T, M>),
}

/// u = g + J' (K e + D de) + B ddq_r + C dq_r + L P L' y_0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impedance<T, const N: usize, const M: usize> {
    pub(crate) task: Task<M>,
    pub(crate) stiffness: SVector<T, M>,
    pub(crate) damper: Damper<T, M>,
    pub(crate) slowest: T,
    pub(crate) null_space: Option<NullSpace<T, N>>,
    pub(crate) friction: Option<FrictionCompensation<T>>,
    pub(crate) limits: Option<TorqueLimits<T, N>>,
}

/// The directions of the task at one posture.
pub(crate) struct Directions<T, const N: usize, const M: usize> {
    /// L of B = L L'.
    factors: Cholesky<T, N>,
    /// G = K^1/2 J L^-T.
    g: SMatrix<T, M, N>,
    modes: LeftSingular<T, M>,
    /// 1 / w_i^2, damped.
    square: SVector<T, M>,
    damped: bool,
}

impl<T: RealField + Copy, const N: usize, const M: usize> Directions<T, N, M> {
    /// The largest natural frequency, 1/s.
    #[cfg(feature = "std")]
    pub(crate) fn fastest(&self) -> T {
        self.modes.sigma.max()
    }

    /// G^+ x, damped.
    fn inverse(&self, x: &SVector<T, M>) -> SVector<T, N> {
        self.g.tr_mul(&(self.modes.u * self.square.component_mul(&self.modes.u.tr_mul(x))))
    }

    /// L P L' y.
    fn beside(&self, y: &SVector<T, N>) -> SVector<T, N> {
        let l = self.factors.factor();
        let y = l.tr_mul(y);
        l * (y - self.inverse(&(self.g * y)))
    }
}

impl<T: RealField + Copy, const N: usize, const M: usize> Impedance<T, N, M> {
    /// The diagonal of K, N/m or N m/rad, and the damping ratio z of every direction, row by row of the task.
    ///
    /// # Errors
    /// Where one is not positive and finite.
    pub fn new(task: Task<M>, stiffness: [T; M], ratio: T) -> Result<Self, SettingError> {
        let stiffness = stiffness.into();
        settings::positive(Setting::Stiffness, &stiffness)?;
        settings::positive_scalar(Setting::DampingRatio, ratio)?;
        let damper = Damper::Ratio(ratio);
        Ok(Self { task, stiffness, damper, slowest: T::zero(), null_space: None, friction: None, limits: None })
    }

    /// The same with the diagonal of D, N s/m or N m s/rad, in place of a damping ratio.
    ///
    /// # Errors
    /// Where one is not positive and finite.
    pub fn with_damping(self, damping: [T; M]) -> Result<Self, SettingError> {
        let damping = damping.into();
        settings::positive(Setting::Derivative, &damping)?;
        Ok(Self { damper: Damper::Diagonal(damping), ..self })
    }

    /// The same with directions that are slower than w_0, 1/s, taken as those of a singular posture.
    ///
    /// # Errors
    /// Where w_0 is not positive and finite.
    pub fn with_slowest(self, slowest: T) -> Result<Self, SettingError> {
        settings::positive_scalar(Setting::SlowestDirection, slowest)?;
        Ok(Self { slowest, ..self })
    }

    /// The same with the null space under control; without it the null space is left alone, undamped.
    #[must_use]
    pub fn with_null_space(self, null_space: NullSpace<T, N>) -> Self {
        Self { null_space: Some(null_space), ..self }
    }

    /// The same with friction compensated in part.
    #[must_use]
    pub fn with_friction_compensation(self, friction: FrictionCompensation<T>) -> Self {
        Self { friction: Some(friction), ..self }
    }

    /// The same with torques limited.
    #[must_use]
    pub fn with_torque_limits(self, limits: TorqueLimits<T, N>) -> Self {
        Self { limits: Some(limits), ..self }
    }

    /// The directions at `q` with the Jacobian `j` of the task rows; `None` where the inertia matrix is not positive definite.
    pub(crate) fn directions(&self, b: &SMatrix<T, N, N>, j: &SMatrix<T, M, N>) -> Option<Directions<T, N, M>> {
        let factors = Cholesky::new(b)?;
        let mut g = SMatrix::<T, M, N>::zeros();
        for i in 0..M {
            let row = j.row(i).transpose() * self.stiffness[i].sqrt();
            g.set_row(i, &factors.forward(&row).transpose());
        }
        let modes = left_singular(&g);
        let least = self.slowest.max(modes.sigma.amax() * T::default_epsilon() * lit(64.0));
        let mut damped = false;
        let square = modes.sigma.map(|w| {
            let l = if w < least { least - w } else { T::zero() };
            damped |= l > T::zero();
            let size = w * w + l * l;
            if size > T::zero() {
                T::one() / size
            } else {
                T::zero()
            }
        });
        Some(Directions { factors, g, modes, square, damped })
    }

    /// Torque for one sample.
    ///
    /// # Errors
    /// Where measurement, reference or torque is not finite, or the inertia matrix of the model is not positive definite.
    pub fn torque<R: Dynamics<N, Real = T>>(
        &self,
        model: &R,
        reference: &OperationalReference<T>,
        measured: &State<T, N>,
    ) -> Result<Torque<T, N>, ControlError> {
        check(measured, reference.is_finite())?;
        let State { q, dq } = measured;
        let j = self.task.jacobian(&model.geometric_jacobian(q));
        let b = model.inertia_matrix(q);
        let directions = self.directions(&b, &j).ok_or(ControlError::Inertia)?;
        let root = self.stiffness.map(|k| k.sqrt());
        let (v_d, a_d) = (self.task.select(&reference.velocity), self.task.select(&reference.acceleration));
        let e = self.task.error(&reference.pose, &Pose::of(model, q));
        let de = v_d - j * dq;
        let damper = match &self.damper {
            Damper::Diagonal(d) => d.component_mul(&de),
            Damper::Ratio(ratio) => {
                let LeftSingular { sigma, u } = &directions.modes;
                let along = u.tr_mul(&root.component_mul(&de));
                let along = SVector::from_fn(|i, _| along[i] * sigma[i] * directions.square[i]);
                root.component_mul(&(u * along)) * (lit::<T>(2.0) * *ratio)
            }
        };
        let mut tau = model.gravity(q) + j.tr_mul(&(self.stiffness.component_mul(&e) + damper));
        if v_d.iter().chain(a_d.iter()).any(|x| *x != T::zero()) {
            let joints = |x: &SVector<T, M>| directions.factors.backward(&directions.inverse(&root.component_mul(x)));
            let dq_r = joints(&v_d);
            let dj = self.task.jacobian(&model.geometric_jacobian_dot(q, dq));
            let ddq_r = joints(&(a_d - dj * dq_r));
            tau += b * ddq_r + model.coriolis_matrix(q, dq) * dq_r;
        }
        if let Some(null_space) = &self.null_space {
            tau += directions.beside(&null_space.acceleration(measured));
        }
        if let Some(friction) = &self.friction {
            tau += friction.torque(model, measured);
        }
        issue(tau, &self.limits, directions.damped)
    }
}
