//! Drive gains from currents.

use nalgebra::{DMatrix, DVector};

use crate::estimate::Estimate;
use crate::prepare::Friction;

use super::Interval;

/// Drive gains, and the estimate that they belong to.
pub(super) struct DriveGains {
    pub(super) gains: Vec<Interval>,
    /// Values of all columns.
    pub(super) x: DVector<f64>,
    /// The covariance of the active columns.
    pub(super) matrix: DMatrix<f64>,
    pub(super) reach: f64,
}

/// Drive gains by maximum likelihood, the least certain ones kept one after the other until the logs determine the rest.
pub(super) fn drive_gains(estimate: &mut Estimate<'_>, terms: &[Vec<Friction>], given: &[f64]) -> DriveGains {
    let n = estimate.arm.dof();
    let mut held = vec![false; n];
    loop {
        estimate.fit_terms(terms);
        let mut trial = estimate.clone();
        let mut of_trial = trial.gains(&held);
        // Load friction takes |g| of the corrected torques.
        trial.renew_sizes();
        if terms.iter().any(|terms| terms.contains(&Friction::Load)) {
            of_trial = trial.gains(&held);
        }
        let (corrections, sigmas, matrix, reach) = of_trial;
        let worst = (0..n)
            .filter(|&j| !held[j] && (reach * sigmas[j] > 0.5 * corrections[j] || !corrections[j].is_finite()))
            .max_by(|&a, &b| (sigmas[a] / corrections[a]).total_cmp(&(sigmas[b] / corrections[b])));
        if let Some(j) = worst {
            held[j] = true;
            continue;
        }
        let interval = |j: usize| {
            let (value, sigma) = (given[j] * corrections[j], given[j] * sigmas[j]);
            Interval { value, sigma, low: value - reach * sigma, high: value + reach * sigma, excited: !held[j] }
        };
        let gains = (0..n).map(interval).collect();
        *estimate = trial;
        return DriveGains { gains, x: estimate.x.clone(), matrix, reach };
    }
}
