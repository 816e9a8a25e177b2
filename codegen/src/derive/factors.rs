//! Symmetric positive definite systems, by factors.
//!
//! ```text
//! M = L D L',   L unit lower triangular, D diagonal and positive
//! M x = r:      L y = r,   D z = y,   L' x = z
//! M^-1 = W' D^-1 W,   W = L^-1
//! ```
//!
//! One reciprocal per row; entries that are identically zero cost no operation. Rows are eliminated in any order. In the inertia matrix of an
//! arm with branches those of the leaves come first: then entries between branches, which are zero, stay zero (Featherstone 2008, Rigid Body
//! Dynamics Algorithms, Sect. 6.5).

use super::arm::Arm;
use crate::ring::{ExprId, Node, Pool, Symbol};

/// L and D^-1, of the rows and columns in the order of their elimination.
pub struct LdlFactors {
    /// The places of the rows in the matrix.
    order: Vec<usize>,
    /// L, below the diagonal.
    unit: Vec<Vec<ExprId>>,
    /// 1/D.
    reciprocal: Vec<ExprId>,
}

impl LdlFactors {
    /// Factors a matrix none of whose leading minors is identically zero.
    pub fn new(pool: &mut Pool, m: &[Vec<ExprId>]) -> LdlFactors {
        LdlFactors::in_order(pool, m, (0..m.len()).collect())
    }

    /// Factors the inertia matrix of an arm, in its coordinates.
    pub fn of_inertia(pool: &mut Pool, arm: &Arm, b: &[Vec<ExprId>]) -> LdlFactors {
        LdlFactors::from_end(pool, b, arm.is_chain())
    }

    /// The same in functions that gravity enters. From the leaves a chain is cheaper, too; from the base it keeps the text of earlier versions,
    /// which had no gravity as an argument.
    pub fn of_inertia_under_gravity(pool: &mut Pool, arm: &Arm, b: &[Vec<ExprId>]) -> LdlFactors {
        let is_argument = arm.gravity.iter().any(|&g| matches!(pool.node(g), Node::Symbol(Symbol::Gravity(_))));
        LdlFactors::from_end(pool, b, arm.is_chain() && !is_argument)
    }

    fn from_end(pool: &mut Pool, b: &[Vec<ExprId>], is_base: bool) -> LdlFactors {
        let joints = 0..b.len();
        LdlFactors::in_order(pool, b, if is_base { joints.collect() } else { joints.rev().collect() })
    }

    fn in_order(pool: &mut Pool, m: &[Vec<ExprId>], order: Vec<usize>) -> LdlFactors {
        let n = m.len();
        // Columns of L D as they come (undivided) and of L (unit): an entry of L D L' needs one of each.
        let mut undivided = vec![vec![ExprId::ZERO; n]; n];
        let mut unit = vec![vec![ExprId::ZERO; n]; n];
        let mut reciprocal = vec![ExprId::ZERO; n];
        for j in 0..n {
            for i in j..n {
                let mut entry = m[order[i]][order[j]];
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
        LdlFactors { order, unit, reciprocal }
    }

    /// L^-1 r.
    fn forward(&self, pool: &mut Pool, right: &[ExprId]) -> Vec<ExprId> {
        let mut y: Vec<ExprId> = self.order.iter().map(|&i| right[i]).collect();
        for i in 0..y.len() {
            for j in 0..i {
                let product = pool.mul(self.unit[i][j], y[j]);
                y[i] = pool.sub(y[i], product);
            }
        }
        y
    }

    /// The solution of M x = r.
    pub fn solve(&self, pool: &mut Pool, right: &[ExprId]) -> Vec<ExprId> {
        let n = right.len();
        let y = self.forward(pool, right);
        let mut x: Vec<ExprId> = (0..n).map(|i| pool.mul(y[i], self.reciprocal[i])).collect();
        for i in (0..n).rev() {
            for j in i + 1..n {
                let product = pool.mul(self.unit[j][i], x[j]);
                x[i] = pool.sub(x[i], product);
            }
        }
        let mut solution = x.clone();
        self.order.iter().zip(x).for_each(|(&i, x)| solution[i] = x);
        solution
    }

    /// A M^-1 A' for a matrix given by rows.
    pub fn congruent(&self, pool: &mut Pool, a: &[Vec<ExprId>]) -> Vec<Vec<ExprId>> {
        // With y_r = L^-1 a_r: y_r · D^-1 y_s.
        let y: Vec<Vec<ExprId>> = a.iter().map(|row| self.forward(pool, row)).collect();
        let mut product = vec![vec![ExprId::ZERO; a.len()]; a.len()];
        for r in 0..a.len() {
            let divided: Vec<ExprId> = (0..self.reciprocal.len()).map(|k| pool.mul(y[r][k], self.reciprocal[k])).collect();
            for s in 0..=r {
                product[r][s] = pool.dot(&divided, &y[s]);
                product[s][r] = product[r][s];
            }
        }
        product
    }

    /// M^-1, all entries.
    pub fn inverse(&self, pool: &mut Pool) -> Vec<Vec<ExprId>> {
        let n = self.reciprocal.len();
        let mut unit_rows = vec![vec![ExprId::ZERO; n]; n];
        (0..n).for_each(|k| unit_rows[k][k] = ExprId::ONE);
        self.congruent(pool, &unit_rows)
    }
}
