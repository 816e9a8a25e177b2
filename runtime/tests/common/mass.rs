//! A point mass of 2 kg on a line.

use armgen_runtime::robot::{Dynamics, EquationsOfMotion, Kinematics, Regressor};
use nalgebra::{vector, Matrix4, SMatrix, SVector};
use std::cell::Cell;

/// The mass, held back by a force and a spring; its friction is a force that does not change.
#[derive(Clone, Debug)]
pub struct Mass {
    pub force: f64,
    pub stiffness: f64,
    pub friction: f64,
}

pub const FREE: Mass = Mass { force: 0.0, stiffness: 0.0, friction: 0.0 };

thread_local! {
    /// How often this thread asked for its forward dynamics.
    pub static EVALUATIONS: Cell<u32> = const { Cell::new(0) };
}

impl Kinematics<1> for Mass {
    type Real = f64;
    fn direct_kinematics(&self, q: &SVector<f64, 1>) -> Matrix4<f64> {
        let mut t = Matrix4::identity();
        t[(0, 3)] = q[0];
        t
    }
    fn link_frames(&self, q: &SVector<f64, 1>) -> [Matrix4<f64>; 1] {
        [self.direct_kinematics(q)]
    }
    fn geometric_jacobian(&self, _: &SVector<f64, 1>) -> SMatrix<f64, 6, 1> {
        SVector::<f64, 6>::x()
    }
    fn geometric_jacobian_dot(&self, _: &SVector<f64, 1>, _: &SVector<f64, 1>) -> SMatrix<f64, 6, 1> {
        SMatrix::zeros()
    }
}

impl Dynamics<1> for Mass {
    fn inertia_matrix(&self, _: &SVector<f64, 1>) -> SMatrix<f64, 1, 1> {
        SMatrix::from_element(2.0)
    }
    fn coriolis_matrix(&self, _: &SVector<f64, 1>, _: &SVector<f64, 1>) -> SMatrix<f64, 1, 1> {
        SMatrix::zeros()
    }
    fn gravity(&self, q: &SVector<f64, 1>) -> SVector<f64, 1> {
        vector![self.force] + q * self.stiffness
    }
    fn friction(&self, _: &SVector<f64, 1>) -> SVector<f64, 1> {
        vector![self.friction]
    }
    fn equations_of_motion(&self, q: &SVector<f64, 1>, dq: &SVector<f64, 1>) -> EquationsOfMotion<f64, 1> {
        EquationsOfMotion { inertia: self.inertia_matrix(q), coriolis: self.coriolis_matrix(q, dq), gravity: self.gravity(q) }
    }
    fn inverse_dynamics(&self, q: &SVector<f64, 1>, _: &SVector<f64, 1>, ddq: &SVector<f64, 1>) -> SVector<f64, 1> {
        ddq * 2.0 + self.gravity(q) + self.friction(ddq)
    }
    fn forward_dynamics(&self, q: &SVector<f64, 1>, _: &SVector<f64, 1>, tau: &SVector<f64, 1>) -> SVector<f64, 1> {
        EVALUATIONS.set(EVALUATIONS.get() + 1);
        (tau - self.gravity(q) - self.friction(tau)) / 2.0
    }
    fn kinetic_energy(&self, _: &SVector<f64, 1>, dq: &SVector<f64, 1>) -> f64 {
        dq[0] * dq[0]
    }
    fn potential_energy(&self, q: &SVector<f64, 1>) -> f64 {
        self.force * q[0] + 0.5 * self.stiffness * q[0] * q[0]
    }
}

/// The force in two halves, which no motion can distinguish; the rest is known.
impl Regressor<1, 2> for Mass {
    fn regressor(
        &self,
        _: &SVector<f64, 1>,
        _: &SVector<f64, 1>,
        _: &SVector<f64, 1>,
        _: &SVector<f64, 1>,
    ) -> SMatrix<f64, 1, 2> {
        SMatrix::repeat(1.0)
    }
    fn known_torque(
        &self,
        q: &SVector<f64, 1>,
        _: &SVector<f64, 1>,
        _: &SVector<f64, 1>,
        ddqr: &SVector<f64, 1>,
    ) -> SVector<f64, 1> {
        ddqr * 2.0 + q * self.stiffness + vector![self.friction]
    }
    fn parameters(&self) -> SVector<f64, 2> {
        SVector::repeat(0.5 * self.force)
    }
}
