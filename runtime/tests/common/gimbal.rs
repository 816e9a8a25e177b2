//! Three axes through one point, z, y and x in turn, each with a rotor of 1 kg m². There is no other inertia.

use armgen_runtime::robot::{Dynamics, EquationsOfMotion, Kinematics};
use nalgebra::{Matrix3, Matrix4, Rotation3, SMatrix, SVector, Vector3};

/// The gimbal under a constant load, N m.
#[derive(Clone, Debug)]
pub struct Gimbal {
    pub load: Vector3<f64>,
}

impl Kinematics<3> for Gimbal {
    type Real = f64;
    fn direct_kinematics(&self, q: &Vector3<f64>) -> Matrix4<f64> {
        Rotation3::from_euler_angles(q[2], q[1], q[0]).to_homogeneous()
    }
    fn link_frames(&self, q: &Vector3<f64>) -> [Matrix4<f64>; 3] {
        [[q[0], 0.0, 0.0], [q[0], q[1], 0.0], [q[0], q[1], q[2]]].map(|q| self.direct_kinematics(&q.into()))
    }
    fn geometric_jacobian(&self, q: &Vector3<f64>) -> SMatrix<f64, 6, 3> {
        let first = Rotation3::from_euler_angles(0.0, 0.0, q[0]);
        let second = first * Rotation3::from_euler_angles(0.0, q[1], 0.0);
        let axes = Matrix3::from_columns(&[Vector3::z(), first * Vector3::y(), second * Vector3::x()]);
        let mut j = SMatrix::<f64, 6, 3>::zeros();
        j.fixed_view_mut::<3, 3>(3, 0).copy_from(&axes);
        j
    }
    fn geometric_jacobian_dot(&self, q: &Vector3<f64>, dq: &Vector3<f64>) -> SMatrix<f64, 6, 3> {
        let h = 1e-6;
        (self.geometric_jacobian(&(q + dq * h)) - self.geometric_jacobian(&(q - dq * h))) / (2.0 * h)
    }
}

impl Dynamics<3> for Gimbal {
    fn inertia_matrix(&self, _: &Vector3<f64>) -> Matrix3<f64> {
        Matrix3::identity()
    }
    fn coriolis_matrix(&self, _: &Vector3<f64>, _: &Vector3<f64>) -> Matrix3<f64> {
        Matrix3::zeros()
    }
    fn gravity(&self, _: &Vector3<f64>) -> Vector3<f64> {
        self.load
    }
    fn friction(&self, _: &Vector3<f64>) -> Vector3<f64> {
        Vector3::zeros()
    }
    fn equations_of_motion(&self, q: &Vector3<f64>, dq: &Vector3<f64>) -> EquationsOfMotion<f64, 3> {
        EquationsOfMotion { inertia: self.inertia_matrix(q), coriolis: self.coriolis_matrix(q, dq), gravity: self.gravity(q) }
    }
    fn inverse_dynamics(&self, _: &Vector3<f64>, _: &Vector3<f64>, ddq: &Vector3<f64>) -> Vector3<f64> {
        ddq + self.load
    }
    fn forward_dynamics(&self, _: &Vector3<f64>, _: &Vector3<f64>, tau: &SVector<f64, 3>) -> Vector3<f64> {
        tau - self.load
    }
    fn kinetic_energy(&self, _: &Vector3<f64>, dq: &Vector3<f64>) -> f64 {
        0.5 * dq.norm_squared()
    }
    fn potential_energy(&self, q: &Vector3<f64>) -> f64 {
        self.load.dot(q)
    }
}
