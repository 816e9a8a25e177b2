//! The values of emitted functions by name, as far as each has one formula.

use super::kinematics::Posture;
use super::{times, Dual, Matrix, Model};
use crate::functions::Arguments;

impl Model {
    /// Expected result of a function, plain or `_with` the parameters of this model: row by row, one part after the other. `None`
    /// for functions that are judged in other ways, such as regressors and functions that divide by B.
    pub fn value(&self, function: &str, a: &Arguments) -> Option<Vec<f64>> {
        let Arguments { q, dq, ddq, .. } = a;
        Some(match function.trim_end_matches("_with") {
            "direct_kinematics" => self.direct_kinematics(q).concat(),
            "link_frames" => self.link_frames(q).concat().concat(),
            "geometric_jacobian" => self.geometric_jacobian(q).concat(),
            "geometric_jacobian_dot" => self.geometric_jacobian_dot(q, dq).concat(),
            "inertia_matrix" => self.inertia_matrix(q).concat(),
            "coriolis_matrix" => self.coriolis_matrix(q, dq).concat(),
            "gravity" => self.gravity(q),
            "friction" => self.friction(dq),
            "load_friction" => self.load_friction(q, dq),
            "equations_of_motion" => {
                [self.inertia_matrix(q).concat(), self.coriolis_matrix(q, dq).concat(), self.gravity(q)].concat()
            }
            "inverse_dynamics" => self.inverse_dynamics(q, dq, ddq),
            "kinetic_energy" => vec![self.kinetic_energy(q, dq)],
            "potential_energy" => vec![self.potential_energy(q)],
            "link_jacobians" => (1..=self.dof()).flat_map(|link| self.link_jacobian(q, link).concat()).collect(),
            "center_of_mass" => self.center_of_mass(q),
            "momentum" => times(&self.inertia_matrix(q), dq),
            "coriolis_transpose_times" => times(&transposed(&self.coriolis_matrix(q, dq)), dq),
            "inverse_dynamics_derivatives" => {
                let (by_q, by_dq) = self.inverse_dynamics_derivatives(q, dq, ddq);
                [by_q, by_dq].concat().concat()
            }
            _ => return None,
        })
    }
}

impl Model {
    /// The geometric Jacobian of the origin of link frame `link`, from 1, by the derivatives of that frame: (dp, the vector of dR R').
    fn link_jacobian(&self, q: &[f64], link: usize) -> Matrix {
        let mut rows = vec![vec![]; 6];
        for j in 0..self.dof() {
            let direction: Vec<f64> = (0..self.dof()).map(|i| f64::from(u8::from(i == j))).collect();
            let frame = Posture::new(self, &Dual::along(q, &direction)).frames[link];
            let spin = |i: usize, k: usize| -> f64 { (0..3).map(|c| frame.r[i][c].derivative * frame.r[k][c].value).sum() };
            for i in 0..3 {
                rows[i].push(frame.p[i].derivative);
                rows[i + 3].push(spin((i + 2) % 3, (i + 1) % 3));
            }
        }
        rows
    }

    /// Σ m p / Σ m; the numerator is the potential energy under a free fall of 1 along each axis in turn.
    fn center_of_mass(&self, q: &[f64]) -> Vec<f64> {
        let motors = self.joints.iter().filter_map(|joint| joint.motor.as_ref()).map(|motor| motor.mass);
        let mass: f64 = self.joints.iter().map(|joint| joint.link[0]).chain(motors).chain(self.payload.map(|load| load[0])).sum();
        let moment = |axis: usize| {
            let gravity = [0, 1, 2].map(|i| f64::from(u8::from(i == axis)));
            let joints = self.joints.iter().map(|joint| super::Joint { stiffness: None, ..joint.clone() }).collect();
            -Model { gravity, joints, ..self.clone() }.potential_energy(q)
        };
        (0..3).map(|axis| moment(axis) / mass).collect()
    }
}

fn transposed(m: &Matrix) -> Matrix {
    (0..m.first().map_or(0, Vec::len)).map(|j| m.iter().map(|row| row[j]).collect()).collect()
}
