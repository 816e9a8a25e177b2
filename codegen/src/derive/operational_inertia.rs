//! The operational-space inertia: what the end effector seems to weigh along and about the rows of the task.
//!
//! ```text
//! B_A = (J B^-1 J')^-1                                              (the book, Sect. 7.8, with the rows of J that make up the task)
//! ```
//!
//! B = L D L' gives J B^-1 J' = (L^-1 J')' D^-1 (L^-1 J') without B^-1, and the inverse of that comes from its own factors.
//! There is none where the rows of J depend on each other: at singular configurations, where a reciprocal is infinite, and for every q
//! where the task asks for more than the arm can do ([`is_defined`]).

use super::arm::Arm;
use super::factors::Factors;
use super::inertia::inertia_matrix;
use super::kinematics::geometric_jacobian;
use super::plan::Plan;
use crate::ring::field::{Element, Field};
use crate::ring::{ExprId, Pool};

/// (J B^-1 J')^-1, all entries, for the rows of the task; only where it [`is_defined`].
pub fn operational_inertia(pool: &mut Pool, arm: &Arm, plan: &mut Plan, task: &[usize]) -> Vec<Vec<ExprId>> {
    let jacobian = geometric_jacobian(pool, arm);
    let rows: Vec<Vec<ExprId>> = task.iter().map(|&row| jacobian[row].clone()).collect();
    let b = inertia_matrix(pool, arm, plan);
    let mobility = Factors::new(pool, &b).congruent(pool, &rows);
    Factors::new(pool, &mobility).inverse(pool)
}

/// Whether the rows of the task are independent but for singular configurations.
pub fn is_defined(field: &Field, arm: &Arm, pool: &mut Pool, task: &[usize]) -> bool {
    let jacobian = geometric_jacobian(pool, arm);
    let mut rows: Vec<Vec<Element>> =
        task.iter().map(|&row| jacobian[row].iter().map(|&e| pool.fingerprint(e)[0]).collect()).collect();
    let mut rank = 0;
    for column in 0..arm.dof() {
        let Some(found) = (rank..rows.len()).find(|&r| rows[r][column] != field.zero()) else { continue };
        rows.swap(rank, found);
        let pivot = rows[rank].clone();
        let inverse = field.inverse(pivot[column]);
        for row in &mut rows[rank + 1..] {
            let factor = field.mul(row[column], inverse);
            for (x, &p) in row.iter_mut().zip(&pivot) {
                *x = field.sub(*x, field.mul(factor, p));
            }
        }
        rank += 1;
    }
    rank == task.len()
}
