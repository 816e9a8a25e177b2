//! Fits that bodies and friction allow, for every sign and order of the torques.
//!
//! ```text
//! minimise |W^(1/2) (S b - A x)|²   with viscous >= 0, Coulomb >= 0, mean M_jj >= 0
//! ```
//!
//! S has the signs of the joints. The solution is linear in them, so every pattern of signs costs a small dual problem.

use nalgebra::{DMatrix, DVector};

use crate::estimate::{error_of_sum, Column, Estimate};
use crate::fit::{block_length, solve, Equations, Gram, Sums};
use crate::prepare::{Friction, Piece};
use crate::signal::rms;

/// States at which mean inertias are taken.
const INERTIAS: usize = 12;

/// Sums of the equations of an estimate, by joint of the row and joint of the torque.
pub(super) struct Sides {
    pub(super) equations: Equations,
    /// Weights of the rows.
    counts: Vec<f64>,
    pub(super) active: Vec<usize>,
    size: Vec<f64>,
    sums: Sums,
    h: Vec<DMatrix<f64>>,
    /// Rows that give what is at least 0, over the active columns.
    pub(super) inequalities: DMatrix<f64>,
}

/// An order of the torques: the solution of each joint's torque alone, and what the inequalities need.
pub(super) struct Trial<'s> {
    sides: &'s Sides,
    order: Vec<usize>,
    inverse: DMatrix<f64>,
    parts: Vec<DVector<f64>>,
    products: DMatrix<f64>,
    squares: f64,
    values: DMatrix<f64>,
    /// The inverse of the equations over the inequalities.
    pub(super) dual: DMatrix<f64>,
}

/// A fit: the sum of squares and the solution.
pub(super) struct Fit {
    pub(super) cost: f64,
    pub(super) x: DVector<f64>,
}

impl Sides {
    /// `weights` of the rows; without any, all that count have the same.
    pub(super) fn new(estimate: &Estimate<'_>, weights: &[f64]) -> Sides {
        let n = estimate.arm.dof();
        let (equations, _) = estimate.equations(None);
        let active = estimate.active.clone();
        let of = |j: usize| (0..equations.rows.len()).filter(move |k| k % n == j);
        let size = (0..n).map(|j| rms(&of(j).map(|k| equations.b[k]).collect::<Vec<_>>()).max(1e-12)).collect();
        let sums = Sums::new(&equations, &active);
        let weight = |k: usize| if equations.rows[k].counts { weights.get(k).copied().unwrap_or(1.0) } else { 0.0 };
        let counts: Vec<f64> = (0..equations.rows.len()).map(weight).collect();
        let h = sums.grams(&counts, n, |k| equations.rows[k].joint).into_iter().map(|gram| gram.h).collect();
        let inequalities = inequalities(estimate);
        Sides { equations, counts, active, size, sums, h, inequalities }
    }

    pub(super) fn joints(&self) -> usize {
        self.size.len()
    }

    /// Every row counts alike, whatever its joint.
    fn weight(&self, order: &[usize], j: usize) -> f64 {
        1.0 / (self.size[order[j]] * self.size[order[j]])
    }

    /// A'Wb of the rows of a joint with the torque of another one, and its weighted sum of squares.
    fn with_torque(&self, j: usize, other: usize) -> (DVector<f64>, f64) {
        let rows = self.sums.rows(j);
        let torque = |k: usize| self.equations.b[k - j + other];
        let cross = self.sums.times(j, rows.iter().map(|&k| self.counts[k] * torque(k)));
        (cross, rows.iter().map(|&k| self.counts[k] * torque(k).powi(2)).sum())
    }

    pub(super) fn trial(&self, order: &[usize]) -> Trial<'_> {
        let n = self.size.len();
        let mut gram = Gram::zero(self.active.len());
        let (mut sides, mut squares) = (Vec::new(), 0.0);
        for j in 0..n {
            let (weight, (cross, own)) = (self.weight(order, j), self.with_torque(j, order[j]));
            gram.h += &self.h[j] * weight;
            squares += own * weight;
            sides.push(cross * weight);
        }
        let inverse = solve(&gram, &DVector::zeros(self.active.len())).inverse;
        let parts: Vec<DVector<f64>> = sides.iter().map(|side| &inverse * side).collect();
        let products = DMatrix::from_fn(n, n, |i, j| sides[i].dot(&parts[j]));
        let values = DMatrix::from_columns(&parts.iter().map(|part| &self.inequalities * part).collect::<Vec<_>>());
        let dual = &self.inequalities * &inverse * self.inequalities.transpose();
        Trial { sides: self, order: order.to_vec(), inverse, parts, products, squares, values, dual }
    }
}

impl Trial<'_> {
    /// The least squares with these signs that the inequalities allow.
    pub(super) fn fit(&self, signs: &[f64]) -> Fit {
        let signs = DVector::from_row_slice(signs);
        let values = &self.values * &signs;
        let m = values.len();
        let mut lambda = DVector::<f64>::zeros(m);
        // Gauss-Seidel of the dual, whose only inequalities are lambda >= 0.
        for _ in 0..200 {
            let mut moved = 0.0f64;
            for i in 0..m {
                let diagonal = self.dual[(i, i)];
                if diagonal > 0.0 {
                    let slope = values[i] + self.dual.row(i).transpose().dot(&lambda);
                    let next = (lambda[i] - slope / diagonal).max(0.0);
                    moved = moved.max((next - lambda[i]).powi(2) * diagonal);
                    lambda[i] = next;
                }
            }
            if moved < 1e-12 * self.squares {
                break;
            }
        }
        let raised = -(lambda.dot(&(&self.dual * &lambda)) + 2.0 * lambda.dot(&values));
        let cost = (self.squares - signs.dot(&(&self.products * &signs)) + raised).max(0.0);
        let mut x = &self.inverse * (self.sides.inequalities.transpose() * lambda);
        for (part, sign) in self.parts.iter().zip(signs.iter()) {
            x += part * *sign;
        }
        Fit { cost, x }
    }

    pub(super) fn plain(&self) -> Fit {
        self.fit(&vec![1.0; self.order.len()])
    }

    /// Weighted residuals, row by row.
    pub(super) fn residuals(&self, signs: &[f64], x: &DVector<f64>) -> Vec<f64> {
        let (equations, n) = (&self.sides.equations, self.order.len());
        let values: Vec<(usize, f64)> = self.sides.active.iter().copied().zip(x.iter().copied()).collect();
        let model = equations.product(&values);
        (0..equations.rows.len())
            .map(|k| {
                let j = k % n;
                let torque = signs[j] * equations.b[k - j + self.order[j]];
                (torque - model(k)) * (self.sides.counts[k] * self.sides.weight(&self.order, j)).sqrt()
            })
            .collect()
    }
}

/// Whether residuals are smaller than those before: by more than what is left of some joints, and by more than three standard errors of the
/// difference, from stretches of time that hardly know one another.
pub(super) fn is_better(equations: &Equations, before: &[f64], after: &[f64], joints: &[usize], n: usize) -> bool {
    let gain = Gain::of(equations, before, after, joints, n);
    gain.sum > gain.left && gain.sum > 3.0 * gain.error
}

/// How much smaller the squares of residuals are.
pub(super) struct Gain {
    pub(super) sum: f64,
    /// The standard error of the sum; infinite for a single stretch of time.
    pub(super) error: f64,
    /// The squares that are left of some joints.
    pub(super) left: f64,
}

impl Gain {
    pub(super) fn of(equations: &Equations, before: &[f64], after: &[f64], joints: &[usize], n: usize) -> Gain {
        let ones = vec![1.0; after.len()];
        let length = block_length(equations, after, &ones, n);
        let mut gains: Vec<f64> = Vec::new();
        let mut block: Option<(usize, f64)> = None;
        let mut left = 0.0;
        for (k, row) in equations.rows.iter().enumerate() {
            if !block.is_some_and(|(log, start)| log == row.log && (0.0..length).contains(&(row.time - start))) {
                block = Some((row.log, row.time));
                gains.push(0.0);
            }
            *gains.last_mut().expect("a block") += before[k] * before[k] - after[k] * after[k];
            if joints.contains(&row.joint) {
                left += after[k] * after[k];
            }
        }
        Gain { sum: gains.iter().sum(), error: if gains.len() > 1 { error_of_sum(&gains) } else { f64::INFINITY }, left }
    }
}

/// Of the ten of a body those that are at least 0 whatever the body: its mass, and the moments about the axes of its frame.
const POSITIVE: [usize; 4] = [0, 4, 6, 9];

/// What bodies and friction keep at least 0, as rows over the active columns: viscous and Coulomb friction, sums of masses and moments, and, last,
/// the mean inertia of each joint.
fn inequalities(estimate: &Estimate<'_>) -> DMatrix<f64> {
    let (arm, n, active) = (estimate.arm, estimate.arm.dof(), &estimate.active);
    let mut rows: Vec<DVector<f64>> = Vec::new();
    for (k, &place) in active.iter().enumerate() {
        if matches!(estimate.columns[place], Column::Friction(_, _, Friction::Viscous | Friction::Coulomb)) {
            rows.push(DVector::from_fn(active.len(), |i, _| f64::from(u8::from(i == k))));
        }
    }
    let is_positive = |column: usize| column >= 10 * arm.links.len() || POSITIVE.contains(&(column % 10));
    for (k, &place) in active.iter().enumerate() {
        let Column::Base(base) = estimate.columns[place] else { continue };
        let row = arm.combination.row(base);
        if row.iter().enumerate().all(|(column, factor)| *factor == 0.0 || (*factor > 0.0 && is_positive(column))) {
            rows.push(DVector::from_fn(active.len(), |i, _| f64::from(u8::from(i == k))));
        }
    }
    let all: Vec<(&Piece, usize)> =
        estimate.pieces.iter().flat_map(|piece| piece.kept.iter().map(move |&k| (piece, k))).collect();
    let step = (all.len() / INERTIAS).max(1);
    let q: Vec<f64> = all.iter().step_by(step).flat_map(|(piece, k)| piece.q[k * n..(k + 1) * n].iter().copied()).collect();
    let states = q.len() / n;
    let still = vec![0.0; q.len()];
    let gravity = arm.regressor(&q, &still, &still);
    let base = arm.base.len();
    for j in 0..n {
        let mut row = DVector::zeros(active.len());
        let unit: Vec<f64> = (0..q.len()).map(|k| f64::from(u8::from(k % n == j))).collect();
        let moved = arm.regressor(&q, &still, &unit);
        for (k, &place) in active.iter().enumerate() {
            if let Column::Base(column) = estimate.columns[place] {
                let at = |state: usize| (state * n + j) * base + column;
                row[k] = (0..states).map(|state| moved[at(state)] - gravity[at(state)]).sum::<f64>() / states as f64;
            }
        }
        rows.push(row);
    }
    DMatrix::from_fn(rows.len(), active.len(), |i, k| rows[i][k])
}
