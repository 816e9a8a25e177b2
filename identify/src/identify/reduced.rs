//! The least squares of all logs, without what the written file does not have.

use nalgebra::{DMatrix, DVector};

use crate::estimate::{Column, Estimate};
use crate::fit::{solve, Equations, Gram, Sums};
use crate::prepare::Friction;

/// The least squares of all logs, reduced to base parameters and the friction that is written.
#[derive(Clone, Debug, Default)]
pub struct Reduced {
    /// A'WA, A'Wb, b'Wb over base parameters, then `friction`.
    pub gram: Gram,
    /// Joint and term of the columns behind the base parameters.
    pub friction: Vec<(usize, Friction)>,
    /// A'WA of the rows of each joint, and A'Wr with the residuals r of the estimate.
    pub of_joints: Vec<(DMatrix<f64>, DVector<f64>)>,
    /// How far above the least sum of squares the truth is at most, by the covariance of the estimate.
    pub reach: f64,
}

/// The reduced data over base parameters and the friction of a session: all other columns are eliminated.
pub(super) fn reduce(
    estimate: &Estimate<'_>,
    equations: &Equations,
    session: usize,
    covariance: &DMatrix<f64>,
    reach: f64,
) -> Reduced {
    let is_kept = |place: usize| match estimate.columns[place] {
        Column::Base(_) => true,
        Column::Friction(of, ..) => of == session,
        _ => false,
    };
    let kept: Vec<usize> = estimate.active.iter().copied().filter(|&place| is_kept(place)).collect();
    let others: Vec<usize> = estimate.active.iter().copied().filter(|&place| !is_kept(place)).collect();
    let joints = Sums::new(equations, &estimate.active).grams(&estimate.weights, estimate.arm.dof(), |k| equations.rows[k].joint);
    let mut whole = Gram::zero(estimate.active.len());
    joints.iter().for_each(|gram| whole.add(gram));
    let places =
        |of: &[usize]| -> Vec<usize> { of.iter().filter_map(|place| estimate.active.binary_search(place).ok()).collect() };
    let (of_kept, of_others) = (places(&kept), places(&others));
    let mut gram = whole.of(&of_kept);
    if !others.is_empty() {
        let other = whole.of(&of_others);
        let zero = DVector::zeros(others.len());
        let inverse = solve(&other, &zero).inverse;
        let mixed = DMatrix::from_fn(kept.len(), others.len(), |i, j| whole.h[(of_kept[i], of_others[j])]);
        let half = &mixed * &inverse;
        gram.h -= &half * mixed.transpose();
        gram.g -= &half * &other.g;
        gram.bb -= other.g.dot(&(&inverse * &other.g));
        gram.h = 0.5 * (&gram.h + gram.h.transpose());
    }
    let friction = kept
        .iter()
        .filter_map(|&place| match estimate.columns[place] {
            Column::Friction(_, joint, term) => Some((joint, term)),
            _ => None,
        })
        .collect();
    let x = DVector::from_fn(estimate.active.len(), |k, _| estimate.x[estimate.active[k]]);
    let of_joint = |of: &Gram| {
        let score = &of.g - &of.h * &x;
        (of.of(&of_kept).h, DVector::from_fn(of_kept.len(), |k, _| score[of_kept[k]]))
    };
    // The sum of squares rises by e'He with the error e: its mean is tr(HC), its variance 2 tr(HCHC).
    let product = &gram.h * DMatrix::from_fn(kept.len(), kept.len(), |i, j| covariance[(of_kept[i], of_kept[j])]);
    let rise = product.trace() + reach * (2.0 * (&product * &product).trace().max(0.0)).sqrt();
    Reduced { gram, friction, of_joints: joints.iter().map(of_joint).collect(), reach: rise * (reach / 3.0).powi(2) }
}
