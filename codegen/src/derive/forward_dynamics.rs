//! Forward dynamics: ddq = B^-1 (tau - C dq - F - g), by factors of B.

use super::arm::Arm;
use super::factors::Factors;
use super::inertia::inertia_matrix;
use super::newton_euler::{inverse_dynamics, Motion};
use super::plan::Plan;
use crate::ring::{ExprId, Pool, Symbol};

/// ddq(q, dq, tau).
pub fn forward_dynamics(pool: &mut Pool, arm: &Arm, plan: &mut Plan) -> Vec<ExprId> {
    let b = inertia_matrix(pool, arm, plan);
    let motion = Motion::unaccelerated(pool, arm);
    let bias = inverse_dynamics(pool, arm, &motion);
    let tau = arm.symbols(pool, Symbol::Torque);
    let right: Vec<ExprId> = (0..arm.dof()).map(|i| pool.sub(tau[i], bias[i])).collect();
    Factors::new(pool, &b).solve(pool, &right)
}
