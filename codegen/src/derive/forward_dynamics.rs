//! Forward dynamics: ddq = B^-1 (tau - C dq - F - g), by factors of B.
//!
//! ```text
//! B = L D L',   L unit lower triangular, D diagonal and positive (B is positive definite)
//! L y = tau - n,   D x = y,   L' ddq = x
//! ```
//!
//! One reciprocal per joint; entries of B that are identically zero leave no work behind.

use super::arm::Arm;
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
    solve(pool, &b, &right)
}

/// The solution of a symmetric positive definite system.
pub fn solve(pool: &mut Pool, b: &[Vec<ExprId>], right: &[ExprId]) -> Vec<ExprId> {
    let n = right.len();
    // Columns of L D as they come (undivided) and of L (unit): an entry of L D L' needs one of each.
    let mut undivided = vec![vec![ExprId::ZERO; n]; n];
    let mut unit = vec![vec![ExprId::ZERO; n]; n];
    let mut reciprocal = vec![ExprId::ZERO; n];
    for j in 0..n {
        for i in j..n {
            let mut entry = b[i][j];
            for k in 0..j {
                let product = pool.mul(undivided[i][k], unit[j][k]);
                entry = pool.sub(entry, product);
            }
            undivided[i][j] = entry;
        }
        reciprocal[j] = pool.reciprocal(undivided[j][j]);
        for i in j + 1..n {
            unit[i][j] = pool.mul(undivided[i][j], reciprocal[j]);
        }
    }
    let mut y = right.to_vec();
    for i in 0..n {
        for j in 0..i {
            let product = pool.mul(unit[i][j], y[j]);
            y[i] = pool.sub(y[i], product);
        }
    }
    let mut x: Vec<ExprId> = (0..n).map(|i| pool.mul(y[i], reciprocal[i])).collect();
    for i in (0..n).rev() {
        for j in i + 1..n {
            let product = pool.mul(unit[j][i], x[j]);
            x[i] = pool.sub(x[i], product);
        }
    }
    x
}
