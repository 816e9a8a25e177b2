//! The Coriolis and centrifugal matrix C(q, dq) by Christoffel symbols of the first kind.
//!
//! ```text
//! C_ij = Σ_k c_ijk dq_k,   c_ijk = ½ (∂b_ij/∂q_k + ∂b_ik/∂q_j - ∂b_jk/∂q_i)              (the book, eq. 7.45)
//! ```
//!
//! With this choice dB/dt - 2C is skew-symmetric, as passivity-based control needs.

use super::arm::Arm;
use super::inertia::inertia_matrix;
use crate::ring::{ExprId, Pool, Symbol};

/// C(q, dq) by differentiation of B: the definition itself.
pub fn coriolis_matrix(pool: &mut Pool, arm: &Arm) -> Vec<Vec<ExprId>> {
    let b = inertia_matrix(pool, arm);
    christoffel(pool, arm, &b)
}

/// C(q, dq) of a given B(q).
pub fn christoffel(pool: &mut Pool, arm: &Arm, b: &[Vec<ExprId>]) -> Vec<Vec<ExprId>> {
    let n = arm.dof();
    let rates = arm.symbols(pool, Symbol::Rate);
    let flat: Vec<ExprId> = b.concat();
    // gradient[k][i][j] = ∂b_ij/∂q_k
    let gradient: Vec<Vec<ExprId>> = (0..n).map(|k| pool.partial_derivative(&flat, k as u16)).collect();
    let derivative = |i: usize, j: usize, k: usize| gradient[k][i * n + j];
    let half = pool.fraction(1, 2);
    let mut c = vec![vec![ExprId::ZERO; n]; n];
    for i in 0..n {
        for j in 0..n {
            let mut sum = ExprId::ZERO;
            for k in 0..n {
                let plus = pool.add(derivative(i, j, k), derivative(i, k, j));
                let twice = pool.sub(plus, derivative(j, k, i));
                let symbol = pool.mul(half, twice);
                let term = pool.mul(symbol, rates[k]);
                sum = pool.add(sum, term);
            }
            c[i][j] = sum;
        }
    }
    c
}
