//! The values of emitted functions by name, as far as each has one formula.

use super::{times, Matrix, Model};
use crate::functions::Arguments;

impl Model {
    /// What a function, plain or `_with` the parameters of this model, must return: row by row, the parts of its result one after the
    /// other. `None` for functions that are judged in other ways, as regressors and what divides by B are.
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
            "equations_of_motion" => {
                [self.inertia_matrix(q).concat(), self.coriolis_matrix(q, dq).concat(), self.gravity(q)].concat()
            }
            "inverse_dynamics" => self.inverse_dynamics(q, dq, ddq),
            "kinetic_energy" => vec![self.kinetic_energy(q, dq)],
            "potential_energy" => vec![self.potential_energy(q)],
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

fn transposed(m: &Matrix) -> Matrix {
    (0..m.first().map_or(0, Vec::len)).map(|j| m.iter().map(|row| row[j]).collect()).collect()
}
