//! Controllers: the torque for each sample, from the reference and the measurement.
//!
//! All start from the equation of motion B ddq + n = tau with n = C dq + F + g and a model of it, marked ^:
//!
//! | controller | law | the book |
//! |---|---|---|
//! | [`PdGravity`] | u = g^(q) + K_P e + K_D de | Sect. 8.5.1 |
//! | [`InverseDynamics`] | u = B^ y + n^, y = ddq_d + K_D de + K_P e | Sect. 8.5.2 |
//! | [`Robust`] | the same with y + w, w bounded by the uncertainty | Sect. 8.5.3 |
//! | [`Adaptive`] | u = Y(q, dq, dq_r, ddq_r) pi^ + tau_known + F_l^ + K_D sigma, pi^ adapted | Sect. 8.5.4 |
//! | [`OperationalSpace`] | u = B^ y + n^, y = J^+ (a_d + K_D de + K_P e + K_I int e - dJ dq) | Sect. 8.6.2 |
//! | [`Limited`] | the same with ddq within limits: least |J ddq + dJ dq - a|, then least |ddq - y_0| | |
//! | [`Impedance`] | u = g^ + J' (K e + D de) + B^ ddq_r + C^ dq_r | Sect. 9.3 |
//! | [`HandGuiding`] | u = g^ - D dq + walls + hold | |
//!
//! with e = q_d - q (or the pose error of the task), de its derivative. Gains are diagonal, hence positive definite where every
//! element is positive; the constructors check it. A controller holds gains, no robot and no clock: the caller owns the loop and
//! passes the model, the reference and the measurement of each sample. Only [`Adaptive`], [`OperationalSpace`] and [`Limited`] have a controller state
//! that is advanced by forward Euler after the torque is computed; [`HandGuiding`] drags the anchor of its hold.
//!
//! [`Admittance`] is for arms that take positions: a measured force moves their reference.
//!
//! Each has a method `torque`; the trait [`Controller`] is their common interface, for a loop that runs any of them.
//!
//! A measurement that is not finite gives [`ControlError::MeasurementNotFinite`], never a torque, and leaves the controller state as it was.
//!
//! The robot is any type that implements the traits, such as `Nominal` of an emitted module.
//!
//! ```
//! use armgen_runtime::control::{ControlError, InverseDynamics, TorqueLimits};
//! use armgen_runtime::reference::{JointReference, State};
//! use armgen_runtime::robot::Dynamics;
//!
//! type Law = InverseDynamics<f64, 6>;
//!
//! /// Errors die away as exp(-20 t), without overshoot.
//! fn law() -> Law {
//!     let limits = TorqueLimits::new([330.0, 330.0, 150.0, 56.0, 56.0, 56.0]).expect("positive numbers");
//!     Law::new([400.0; 6], [40.0; 6]).expect("positive numbers").with_torque_limits(limits)
//! }
//!
//! /// One sample: the torques to hold until the next.
//! fn sample<R: Dynamics<6, Real = f64>>(
//!     robot: &R,
//!     law: &Law,
//!     desired: &JointReference<f64, 6>,
//!     measured: &State<f64, 6>,
//! ) -> Result<[f64; 6], ControlError> {
//!     Ok(law.torque(robot, desired, measured)?.tau.into())
//! }
//! let _ = law();
//! ```

mod adaptive;
mod admittance;
mod friction;
mod hand_guiding;
mod impedance;
mod inverse_dynamics;
mod limited;
mod limits;
mod operational_space;
mod pd;
mod robust;

pub use adaptive::{Adaptive, Interval};
pub use admittance::Admittance;
pub use friction::FrictionCompensation;
pub use hand_guiding::{HandGuiding, Walls};
pub use impedance::Impedance;
pub use inverse_dynamics::InverseDynamics;
pub use limited::{Limited, LimitedTorque};
pub use limits::TorqueLimits;
pub use operational_space::{NullSpace, OperationalSpace};
pub use pd::PdGravity;
pub use robust::{BoundaryLayer, Robust};

use crate::{
    linalg::{self, is_finite},
    reference::{JointReference, OperationalReference, State},
    robot::{Dynamics, Kinematics, Regressor},
};
use nalgebra::{RealField, SVector};

/// Why there is no torque for this sample; the caller brakes or holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ControlError {
    /// A measured joint variable or rate is infinite or NaN: the sensor has failed.
    MeasurementNotFinite,
    /// The reference is infinite or NaN.
    ReferenceNotFinite,
    /// The Jacobian has lost a row of the task: allow damping, or keep away from singular postures.
    Singular,
    /// The law gave an infinite or NaN torque: gains or model are beyond the range of the scalar.
    TorqueNotFinite,
    /// The damped inverse gave no joint acceleration: Jacobian or gains are beyond the range of the scalar.
    AccelerationNotFinite,
    /// The inertia matrix of the model is not positive definite.
    Inertia,
    /// The quadratic program has no solution: its numbers are infinite or NaN, or beyond the range of the scalar.
    NotSolved,
    /// The next estimate or integral would be infinite or NaN: gains or model are beyond the range of the scalar.
    StateNotFinite,
}

messages! { ControlError,
    ControlError::MeasurementNotFinite => "a measured joint variable or rate is infinite or NaN";
    ControlError::ReferenceNotFinite => "the reference is infinite or NaN";
    ControlError::Singular => "the Jacobian of the task has lost rank: allow damping, or keep away from singular postures";
    ControlError::TorqueNotFinite => "the torque is infinite or NaN: gains or model are beyond the range of the scalar";
    ControlError::AccelerationNotFinite => "the damped inverse gives no joint acceleration: Jacobian or gains are beyond the range of the scalar";
    ControlError::Inertia => "the inertia matrix of the model is not positive definite";
    ControlError::NotSolved => "the quadratic program has no solution: its numbers are infinite, NaN, or beyond the range of the scalar";
    ControlError::StateNotFinite => "the next estimate or integral is infinite or NaN: gains or model are beyond the range of the scalar";
}

/// The torque for one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque<T, const N: usize> {
    /// Joint torques (forces), N m or N.
    pub tau: SVector<T, N>,
    /// Whether a torque limit cut it.
    pub limited: bool,
    /// Whether the inverse of the Jacobian was damped, near a singularity.
    pub damped: bool,
}

/// A controller: the torque for each sample, from the model of the robot, the reference and the measurement.
pub trait Controller<R: Kinematics<N>, const N: usize> {
    /// The reference: a [`JointReference`], or an [`OperationalReference`] of the end effector.
    type Reference;

    /// Torque for one sample; then advances the controller state, if any.
    ///
    /// # Errors
    /// Where there is no torque; the controller state stays as it was.
    fn torque(
        &mut self,
        model: &R,
        reference: &Self::Reference,
        measured: &State<R::Real, N>,
    ) -> Result<Torque<R::Real, N>, ControlError>;
}

/// Implements the trait by the controller's own method of that name.
macro_rules! controller {
    ($controller:ty, $model:path, $reference:ty $(, $size:ident)?) => {
        impl<R: $model, const N: usize $(, const $size: usize)?> Controller<R, N> for $controller {
            type Reference = $reference;

            #[inline]
            fn torque(
                &mut self,
                model: &R,
                reference: &Self::Reference,
                measured: &State<R::Real, N>,
            ) -> Result<Torque<R::Real, N>, ControlError> {
                <$controller>::torque(self, model, reference, measured)
            }
        }
    };
}

controller!(PdGravity<R::Real, N>, Dynamics<N>, JointReference<R::Real, N>);
controller!(InverseDynamics<R::Real, N>, Dynamics<N>, JointReference<R::Real, N>);
controller!(Robust<R::Real, N>, Dynamics<N>, JointReference<R::Real, N>);
controller!(Adaptive<R::Real, N, P>, Regressor<N, P>, JointReference<R::Real, N>, P);
controller!(OperationalSpace<R::Real, N, M>, Dynamics<N>, OperationalReference<R::Real>, M);
controller!(Impedance<R::Real, N, M>, Dynamics<N>, OperationalReference<R::Real>, M);

impl<R: Dynamics<N>, const N: usize, const M: usize> Controller<R, N> for Limited<R::Real, N, M> {
    type Reference = OperationalReference<R::Real>;

    #[inline]
    fn torque(
        &mut self,
        model: &R,
        reference: &Self::Reference,
        measured: &State<R::Real, N>,
    ) -> Result<Torque<R::Real, N>, ControlError> {
        Ok(Limited::torque(self, model, reference, measured)?.torque)
    }
}

/// A hand leads the arm, so there is no reference.
impl<R: Dynamics<N>, const N: usize> Controller<R, N> for HandGuiding<R::Real, N> {
    type Reference = ();

    #[inline]
    fn torque(&mut self, model: &R, (): &(), measured: &State<R::Real, N>) -> Result<Torque<R::Real, N>, ControlError> {
        HandGuiding::torque(self, model, measured)
    }
}

fn check<T: RealField + Copy, const N: usize>(measured: &State<T, N>, reference_is_finite: bool) -> Result<(), ControlError> {
    if !measured.is_finite() {
        Err(ControlError::MeasurementNotFinite)
    } else if !reference_is_finite {
        Err(ControlError::ReferenceNotFinite)
    } else {
        Ok(())
    }
}

fn check_joint<T: RealField + Copy, const N: usize>(
    measured: &State<T, N>,
    reference: &JointReference<T, N>,
) -> Result<(), ControlError> {
    check(measured, reference.is_finite())
}

/// The last step of every controller: nothing that is not finite leaves, nothing beyond the limits.
fn issue<T: RealField + Copy, const N: usize>(
    tau: SVector<T, N>,
    limits: &Option<TorqueLimits<T, N>>,
    damped: bool,
) -> Result<Torque<T, N>, ControlError> {
    if !is_finite(&tau) {
        return Err(ControlError::TorqueNotFinite);
    }
    let linalg::Limited { value: tau, is_limited: limited } = match limits {
        Some(limits) => limits.apply(&tau),
        None => linalg::Limited { value: tau, is_limited: false },
    };
    Ok(Torque { tau, limited, damped })
}
