//! Traits of one function each, for what not every controller needs or not every robot has. Written from the catalogue of emitted functions; a test says when that differs.

use super::Kinematics;
use nalgebra::{SMatrix, SVector};

/// The function `link_jacobians` of a robot.
pub trait LinkJacobians<const N: usize>: Kinematics<N> {
    /// Geometric Jacobian J_i(q) of the origin of every link frame, in the base frame.
    ///
    /// ```text
    /// (v_i, omega_i) = J_i(q) dq                                        (Siciliano et al., Sect. 3.1)
    /// ```
    ///
    /// - `q`: joint variables, rad (revolute) or m (prismatic).
    /// - Returns `j[link][row][joint]`, 6 rows each: three linear (velocity of the origin of the frame that `link_frames` gives, m/s), then three angular (rad/s). Joints beyond a link have columns of zeros.
    fn link_jacobians(
        &self,
        q: &SVector<Self::Real, N>,
    ) -> [SMatrix<Self::Real, 6, N>; N];
}

/// The function `center_of_mass` of a robot.
pub trait CenterOfMass<const N: usize>: Kinematics<N> {
    /// Centre of mass of the whole arm in the base frame: links, load and rotors, those that the base carries included.
    ///
    /// ```text
    /// p_c(q) = sum_i m_i p_li / m,  m = sum_i m_i,  U(q) = - m g0' p_c
    /// ```
    ///
    /// - `q`: joint variables, rad (revolute) or m (prismatic).
    /// - Returns its x, y and z, m.
    fn center_of_mass(&self, q: &SVector<Self::Real, N>) -> SVector<Self::Real, 3>;
}

/// The function `momentum` of a robot.
pub trait Momentum<const N: usize>: Kinematics<N> {
    /// Generalised momentum B(q) dq, for a momentum observer.
    ///
    /// ```text
    /// p = B(q) dq = dT/d(dq)                                            (De Luca and Mattone 2003)
    /// ```
    ///
    /// - `q`: joint variables, rad (revolute) or m (prismatic).
    /// - `dq`: joint rates, rad/s or m/s.
    /// - Returns a momentum, N m s (revolute) or N s (prismatic), for each joint.
    fn momentum(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
    ) -> SVector<Self::Real, N>;
}

/// The function `coriolis_transpose_times` of a robot.
pub trait CoriolisTransposeTimes<const N: usize>: Kinematics<N> {
    /// C(q, dq)' dq with C by Christoffel symbols, for a momentum observer.
    ///
    /// ```text
    /// C' dq = dT/dq = (dB/dt) dq - C dq,  dp/dt = tau + C' dq - F - g    (De Luca and Mattone 2003)
    /// ```
    ///
    /// - `q`: joint variables, rad (revolute) or m (prismatic).
    /// - `dq`: joint rates, rad/s or m/s.
    /// - Returns a torque, N m (revolute), or a force, N (prismatic), for each joint, on the right of the equation of dp/dt.
    fn coriolis_transpose_times(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
    ) -> SVector<Self::Real, N>;
}

/// The function `base_regressor` of a robot.
pub trait BaseRegressor<const N: usize, const B: usize>: Kinematics<N> {
    /// Regressor Y_b(q, dq, ddq) of the base parameters: columns of full rank.
    ///
    /// ```text
    /// B(q) ddq + C(q, dq) dq + F(dq) + g(q) = Y_b pi_b                  (Gautier and Khalil 1990)
    /// ```
    ///
    /// - `q`: joint variables, rad (revolute) or m (prismatic).
    /// - `dq`: joint rates, rad/s or m/s.
    /// - `ddq`: joint accelerations, rad/s² or m/s².
    /// - Returns `y[joint][base parameter]`, parameters in the order of `BASE_PARAMETER_NAMES`: those of the links in their joint frames, inertias of rotors, viscous and Coulomb friction, as far as the description gives them and they are not 0 at its values. Masses of rotors are part of the links that carry them. With `NOMINAL_BASE_PARAMETERS` it is the torque of `inverse_dynamics`. For identification take `regressor` with `regressor: base` in the description: it has all base parameters, zero or not.
    fn base_regressor(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
        ddq: &SVector<Self::Real, N>,
    ) -> SMatrix<Self::Real, N, B>;
}

/// The function `operational_inertia` of a robot.
pub trait OperationalInertia<const N: usize, const M: usize>: Kinematics<N> {
    /// Inertia of the end effector along and about the rows of the task, in the base frame.
    ///
    /// ```text
    /// B_A(q) = (J B(q)^-1 J')^-1, J the rows `TASK` of the geometric Jacobian (Siciliano et al., Sect. 7.8)
    /// ```
    ///
    /// - `q`: joint variables, rad (revolute) or m (prismatic).
    /// - Returns `b[row][column]` in the order of `TASK`, symmetric; kg, kg m, kg m². Positive definite where those rows of J are independent; at a singular configuration it is infinite, and its entries are not finite or, by rounding, very large.
    fn operational_inertia(
        &self,
        q: &SVector<Self::Real, N>,
    ) -> SMatrix<Self::Real, M, M>;
}

/// The function `inverse_dynamics_derivatives` of a robot.
pub trait InverseDynamicsDerivatives<const N: usize>: Kinematics<N> {
    /// Derivatives of the torques of `inverse_dynamics` by joint variables and by rates.
    ///
    /// ```text
    /// (dtau/dq, dtau/d(dq)) at (q, dq, ddq);  dtau/d(ddq) = B(q)         (Singh, Russell and Wensing 2022)
    /// ```
    ///
    /// - `q`: joint variables, rad (revolute) or m (prismatic).
    /// - `dq`: joint rates, rad/s or m/s.
    /// - `ddq`: joint accelerations, rad/s² or m/s².
    /// - Returns two matrices `m[joint of tau][joint of q or dq]`; units of tau per rad or m, and per rad/s or m/s. Coulomb friction counts as constant: its derivative is taken as 0, at rest too.
    fn inverse_dynamics_derivatives(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
        ddq: &SVector<Self::Real, N>,
    ) -> (SMatrix<Self::Real, N, N>, SMatrix<Self::Real, N, N>);
}

/// The function `forward_dynamics_derivatives` of a robot.
pub trait ForwardDynamicsDerivatives<const N: usize>: Kinematics<N> {
    /// Derivatives of the accelerations of `forward_dynamics` by joint variables, by rates and by torques.
    ///
    /// ```text
    /// (-B^-1 dtau/dq, -B^-1 dtau/d(dq), B^-1) at ddq = forward_dynamics(q, dq, tau)  (Carpentier and Mansard 2018)
    /// ```
    ///
    /// - `q`: joint variables, rad (revolute) or m (prismatic).
    /// - `dq`: joint rates, rad/s or m/s.
    /// - `tau`: joint torques (forces) on the joint side of the gears, N m or N.
    /// - Returns three matrices `m[joint of ddq][joint of q, dq or tau]`; units of ddq per rad or m, per rad/s or m/s, and per N m or N. The third is the inverse of the inertia matrix. Coulomb friction counts as constant: its derivative is taken as 0, at rest too.
    fn forward_dynamics_derivatives(
        &self,
        q: &SVector<Self::Real, N>,
        dq: &SVector<Self::Real, N>,
        tau: &SVector<Self::Real, N>,
    ) -> (
        SMatrix<Self::Real, N, N>,
        SMatrix<Self::Real, N, N>,
        SMatrix<Self::Real, N, N>,
    );
}
