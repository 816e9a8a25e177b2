//! A chain in f32: its functions in f64, rounded. What is lost in a test is lost behind the model.

use crate::common::arms::Chain;
use armgen_runtime::robot::{CoriolisTransposeTimes, Dynamics, EquationsOfMotion, Kinematics, Momentum};
use nalgebra::{Matrix4, SMatrix, SVector};

/// A chain in f32.
pub(crate) struct Single<const N: usize>(pub(crate) Chain<N>);

fn wide<const R: usize, const C: usize>(x: &SMatrix<f32, R, C>) -> SMatrix<f64, R, C> {
    x.map(f64::from)
}

fn narrow<const R: usize, const C: usize>(x: SMatrix<f64, R, C>) -> SMatrix<f32, R, C> {
    x.map(|x| x as f32)
}

type Vector<const N: usize> = SVector<f32, N>;

impl<const N: usize> Kinematics<N> for Single<N> {
    type Real = f32;
    fn direct_kinematics(&self, q: &Vector<N>) -> Matrix4<f32> {
        narrow(self.0.direct_kinematics(&wide(q)))
    }
    fn link_frames(&self, q: &Vector<N>) -> [Matrix4<f32>; N] {
        self.0.link_frames(&wide(q)).map(narrow)
    }
    fn geometric_jacobian(&self, q: &Vector<N>) -> SMatrix<f32, 6, N> {
        narrow(self.0.geometric_jacobian(&wide(q)))
    }
    fn geometric_jacobian_dot(&self, q: &Vector<N>, dq: &Vector<N>) -> SMatrix<f32, 6, N> {
        narrow(self.0.geometric_jacobian_dot(&wide(q), &wide(dq)))
    }
}

impl<const N: usize> Dynamics<N> for Single<N> {
    fn inertia_matrix(&self, q: &Vector<N>) -> SMatrix<f32, N, N> {
        narrow(self.0.inertia_matrix(&wide(q)))
    }
    fn coriolis_matrix(&self, q: &Vector<N>, dq: &Vector<N>) -> SMatrix<f32, N, N> {
        narrow(self.0.coriolis_matrix(&wide(q), &wide(dq)))
    }
    fn gravity(&self, q: &Vector<N>) -> Vector<N> {
        narrow(self.0.gravity(&wide(q)))
    }
    fn friction(&self, dq: &Vector<N>) -> Vector<N> {
        narrow(self.0.friction(&wide(dq)))
    }
    fn equations_of_motion(&self, q: &Vector<N>, dq: &Vector<N>) -> EquationsOfMotion<f32, N> {
        let EquationsOfMotion { inertia, coriolis, gravity } = self.0.equations_of_motion(&wide(q), &wide(dq));
        EquationsOfMotion { inertia: narrow(inertia), coriolis: narrow(coriolis), gravity: narrow(gravity) }
    }
    fn inverse_dynamics(&self, q: &Vector<N>, dq: &Vector<N>, ddq: &Vector<N>) -> Vector<N> {
        narrow(self.0.inverse_dynamics(&wide(q), &wide(dq), &wide(ddq)))
    }
    fn forward_dynamics(&self, q: &Vector<N>, dq: &Vector<N>, tau: &Vector<N>) -> Vector<N> {
        narrow(self.0.forward_dynamics(&wide(q), &wide(dq), &wide(tau)))
    }
    fn kinetic_energy(&self, q: &Vector<N>, dq: &Vector<N>) -> f32 {
        self.0.kinetic_energy(&wide(q), &wide(dq)) as f32
    }
    fn potential_energy(&self, q: &Vector<N>) -> f32 {
        self.0.potential_energy(&wide(q)) as f32
    }
}

impl<const N: usize> Momentum<N> for Single<N> {
    fn momentum(&self, q: &Vector<N>, dq: &Vector<N>) -> Vector<N> {
        narrow(self.0.momentum(&wide(q), &wide(dq)))
    }
}

impl<const N: usize> CoriolisTransposeTimes<N> for Single<N> {
    fn coriolis_transpose_times(&self, q: &Vector<N>, dq: &Vector<N>) -> Vector<N> {
        narrow(self.0.coriolis_transpose_times(&wide(q), &wide(dq)))
    }
}
