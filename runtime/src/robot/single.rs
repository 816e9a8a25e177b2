//! Traits of one function each, for what not every robot has. Written from the catalogue of emitted functions; a test says when that differs.

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
