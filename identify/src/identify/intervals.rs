//! Intervals of values that were found.

use nalgebra::DMatrix;

use crate::estimate::{Column, Estimate};
use crate::fit::Covariance;
use crate::prepare::Friction;

use super::{FrictionValue, Interval};

/// The estimate with load and cubic friction of all joints, and its covariance.
pub(super) fn with_terms_left_out<'a>(estimate: &Estimate<'a>, terms: &[Vec<Friction>]) -> (Estimate<'a>, Covariance) {
    let mut wider = estimate.clone();
    wider.activate(&|joint, term| terms[joint].contains(&term) || matches!(term, Friction::Load | Friction::Cubic));
    let (.., covariance) = wider.finish();
    (wider, covariance)
}

/// Intervals of the active columns; with those of a wider estimate they reach from end to end of both.
pub(super) fn intervals(
    estimate: &Estimate<'_>,
    matrix: &DMatrix<f64>,
    reach: f64,
    wider: Option<&(Estimate<'_>, Covariance)>,
) -> Vec<Interval> {
    let interval = |(k, &place): (usize, &usize)| {
        let value = estimate.x[place];
        let around = |middle: f64, matrix: &DMatrix<f64>, k: usize, reach: f64| {
            let sigma = matrix[(k, k)].max(0.0).sqrt();
            Interval { value, sigma, low: middle - reach * sigma, high: middle + reach * sigma, excited: true }
        };
        let own = around(value, matrix, k, reach);
        match wider.and_then(|(wider, of)| Some((wider, of, wider.active.binary_search(&place).ok()?))) {
            Some((wider, of, k)) => {
                let wide = around(wider.x[place], &of.matrix, k, of.reach);
                Interval { low: wide.low.min(own.low), high: wide.high.max(own.high), ..wide }
            }
            None => own,
        }
    };
    estimate.active.iter().enumerate().map(interval).collect()
}

/// Friction of all sessions, with the interval of each active column.
pub(super) fn of_friction(estimate: &Estimate<'_>, interval: impl Fn(usize) -> Interval) -> Vec<FrictionValue> {
    let of = |(k, &place): (usize, &usize)| match estimate.columns[place] {
        Column::Friction(session, joint, term) => Some(FrictionValue { session, joint, term, value: interval(k) }),
        _ => None,
    };
    estimate.active.iter().enumerate().filter_map(of).collect()
}

/// The ten of the load of each log that has one.
pub(super) fn of_loads(estimate: &Estimate<'_>, intervals: &[Interval]) -> Vec<(usize, Vec<Option<Interval>>)> {
    let of_log = |log: usize| {
        let known = estimate.known_load(log);
        let of = |k: usize| match estimate.active.binary_search(&estimate.place(Column::Load(log, k))) {
            Ok(k) => Some(intervals[k]),
            Err(_) if known[k] != 0.0 => Some(Interval { value: known[k], low: known[k], high: known[k], ..Interval::default() }),
            Err(_) => None,
        };
        (log, (0..10).map(of).collect())
    };
    (0..estimate.runs.len()).filter(|&log| estimate.runs[log].load.is_there).map(of_log).collect()
}

/// Delays with standard errors and halves of their intervals.
pub(super) fn of_delays(estimate: &Estimate<'_>, errors: &[Option<[f64; 2]>], is_given: bool) -> Vec<Interval> {
    let delay = |(&value, error): (&f64, &Option<[f64; 2]>)| {
        let [sigma, half] = error.unwrap_or_default();
        Interval { value, sigma, low: value - half, high: value + half, excited: is_given || error.is_some() }
    };
    estimate.delays.iter().zip(errors).map(delay).collect()
}
