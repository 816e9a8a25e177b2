//! The traits of a robot: `Kinematics`, `Dynamics` and `Regressor`, each extending the one before it, `InverseKinematics`, and one for each
//! function that not every robot has or not every controller needs.
//!
//! With the feature `runtime` of its crate, the emitted module of a robot implements these traits for two types. `Nominal` is a
//! unit struct for the robot of the description. `WithParameters` is the same robot with parameters chosen at run time. Where the
//! description has gravity as an argument, `Mounted` is the same robot under another gravity, and `WithParameters` has one, too. The
//! methods take `&self` so that a robot may carry data.
//!
//! Frames and signs, for all methods. The base frame is the frame before the description's first row, or before `base` if given. The end
//! effector is the last link's frame times `tool`. Vectors of Jacobians are expressed in the base frame. The equation of motion is
//!
//! ```text
//! B(q) ddq + C(q, dq) dq + F(dq) + g(q) = tau                       (the book, Sect. 7.2, eq. 7.42 without contact)
//! ```
//!
//! with `g` on the left: the torque that holds the arm at rest is `tau = g(q)`.
//! "The book" is Siciliano, Sciavicco, Villani, Oriolo, *Robotics: Modelling, Planning and Control*.

mod postures;
#[rustfmt::skip] // it is written by a test
mod single;

pub use postures::{InverseKinematics, JointRanges, Posture, Postures, RedundantInverseKinematics, Verdict};
pub use single::*;

use nalgebra::{Matrix4, RealField, SMatrix, SVector, Scalar};

/// The matrices of the equation of motion at one state, computed together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquationsOfMotion<T, const N: usize> {
    /// Inertia matrix B(q): symmetric, positive definite; kg m^2, kg m or kg.
    pub inertia: SMatrix<T, N, N>,
    /// Coriolis and centrifugal matrix C(q, dq) by Christoffel symbols: dB/dt - 2C is skew-symmetric; units of B, per s.
    pub coriolis: SMatrix<T, N, N>,
    /// Gravity term g(q), on the left of the equation of motion; N m or N.
    pub gravity: SVector<T, N>,
}

/// The entries of a vector as the array that emitted functions take.
pub fn array<T, const N: usize>(vector: &SVector<T, N>) -> &[T; N] {
    &vector.data.0[0]
}

/// The matrix of an emitted array `m[row][column]`. nalgebra stores columns: this is the one place that knows both orders.
pub fn matrix<T: Scalar, const R: usize, const C: usize>(rows: &[[T; C]; R]) -> SMatrix<T, R, C> {
    SMatrix::from_fn(|i, j| rows[i][j].clone())
}

/// Kinematics of an arm with `N` joints.
pub trait Kinematics<const N: usize> {
    /// The scalar of the emitted module: `f64` or `f32`.
    type Real: RealField + Copy;

    /// End-effector frame in the base frame, T_e(q), 4 x 4; translation in m.
    fn direct_kinematics(&self, q: &SVector<Self::Real, N>) -> Matrix4<Self::Real>;

    /// Frame of each link in the base frame, T_i(q), as the description defines link frames; translations in m.
    fn link_frames(&self, q: &SVector<Self::Real, N>) -> [Matrix4<Self::Real>; N];

    /// Geometric Jacobian J(q) of the end effector: (v_e, omega_e) = J dq, rows linear then angular, base frame; m/s or rad/s per
    /// rad/s or m/s of a joint.
    fn geometric_jacobian(&self, q: &SVector<Self::Real, N>) -> SMatrix<Self::Real, 6, N>;

    /// Time derivative of the geometric Jacobian along `dq`, rad/s or m/s; units of J, per s.
    fn geometric_jacobian_dot(&self, q: &SVector<Self::Real, N>, dq: &SVector<Self::Real, N>) -> SMatrix<Self::Real, 6, N>;
}

/// Dynamics of an arm with `N` joints.
pub trait Dynamics<const N: usize>: Kinematics<N> {
    /// Inertia matrix B(q), rotors included; kg m^2, kg m or kg.
    fn inertia_matrix(&self, q: &SVector<Self::Real, N>) -> SMatrix<Self::Real, N, N>;

    /// Coriolis and centrifugal matrix C(q, dq) by Christoffel symbols of the first kind: dB/dt - 2C is skew-symmetric; units
    /// of B, per s.
    fn coriolis_matrix(&self, q: &SVector<Self::Real, N>, dq: &SVector<Self::Real, N>) -> SMatrix<Self::Real, N, N>;

    /// Gravity term g(q) = dU/dq, springs included, on the left of the equation of motion; N m or N.
    fn gravity(&self, q: &SVector<Self::Real, N>) -> SVector<Self::Real, N>;

    /// Friction torque, N m or N, at the joints on the left of the equation of motion. It sums viscous and Coulomb friction,
    /// which have the sign of `dq`, and the other friction of the description.
    fn friction(&self, dq: &SVector<Self::Real, N>) -> SVector<Self::Real, N>;

    /// Friction torque, N m or N, that grows with the load of its joint, F_l |g_i(q)| sign(dq_i). It adds to
    /// [`friction`](Dynamics::friction) on the left of the equation of motion. It is part of `inverse_dynamics` and
    /// `forward_dynamics`, and of no regressor. 0 for robots without such friction.
    fn load_friction(&self, q: &SVector<Self::Real, N>, dq: &SVector<Self::Real, N>) -> SVector<Self::Real, N> {
        let _ = (q, dq);
        SVector::zeros()
    }

    /// B, C and g at one state, sharing their work; `q` in rad or m, `dq` in rad/s or m/s.
    fn equations_of_motion(&self, q: &SVector<Self::Real, N>, dq: &SVector<Self::Real, N>) -> EquationsOfMotion<Self::Real, N>;

    /// tau = B ddq + C dq + F(dq) + g, N m or N, with all friction in F.
    fn inverse_dynamics(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
        ddq: &SVector<Self::Real, N>,
    ) -> SVector<Self::Real, N>;

    /// ddq = B^-1 (tau - C dq - F(dq) - g), rad/s^2 or m/s^2, with all friction in F.
    fn forward_dynamics(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
        tau: &SVector<Self::Real, N>,
    ) -> SVector<Self::Real, N>;

    /// Kinetic energy of links and rotors, T = 1/2 dq' B dq, J.
    fn kinetic_energy(&self, q: &SVector<Self::Real, N>, dq: &SVector<Self::Real, N>) -> Self::Real;

    /// Potential energy U(q), J: gravity, plus 1/2 k_s (q - rest)^2 of each spring. Its zero has all masses, rotors included, at
    /// the origin of the base frame. Base parameters omit terms that affect no torque, so with them U differs by a constant;
    /// differences and the gradient are the same.
    fn potential_energy(&self, q: &SVector<Self::Real, N>) -> Self::Real;
}

/// The dynamics as a linear function of `P` parameters pi.
pub trait Regressor<const N: usize, const P: usize>: Dynamics<N> {
    /// Y(q, dq, dqr, ddqr), `N` x `P`: B(q) ddqr + C(q, dq) dqr + F + g(q) = Y pi + tau_known.
    ///
    /// Viscous friction acts on `dqr`, Coulomb friction on the sign of `dq`.
    fn regressor(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
        dqr: &SVector<Self::Real, N>,
        ddqr: &SVector<Self::Real, N>,
    ) -> SMatrix<Self::Real, N, P>;

    /// The torque of all terms outside the parameter vector, N m or N: tau_known of the equation above, without `load_friction`.
    fn known_torque(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
        dqr: &SVector<Self::Real, N>,
        ddqr: &SVector<Self::Real, N>,
    ) -> SVector<Self::Real, N>;

    /// The parameters of this robot, in the order of the columns of Y; SI units.
    fn parameters(&self) -> SVector<Self::Real, P>;
}
