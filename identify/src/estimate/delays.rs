//! Delays of torques behind positions, found together with everything else.
//!
//! ```text
//! tau_j(t + d_j) = (A x)_j(t)        a change of d_j is an unknown with the column -d(A x)_j/dt
//! ```
//!
//! The column is that of the predicted torque: the measured one has noise, which makes a delay seem smaller and more certain than it is.
//! A grid finds where Gauss and Newton's steps begin.

use nalgebra::DVector;

use crate::estimate::{Column, Estimate};
use crate::fit::{covariance, solve, solve_fast, Equations, Gram, Row, Sums};
use crate::signal::rms;

/// Delays that are tried, in steps, and the step, s.
const GRID: std::ops::RangeInclusive<i32> = -4..=10;
const STEP: f64 = 2.5e-3;

/// The least and the largest delay, s.
const LIMITS: [f64; 2] = [-1e-2, 2.5e-2];

/// Half of an interval is at most that wide where a delay counts as determined, s.
const DETERMINED: f64 = 1e-2;

/// A residual above this part of the torque of its joint is an outlier.
const OUTLIER: f64 = 0.5;

/// Gauss and Newton's steps at most.
const STEPS: usize = 12;

/// A delay that changes by less has been found, s.
const SETTLED: f64 = 1e-6;

impl Estimate<'_> {
    /// Whether a delay is the first or the last of those that are tried.
    pub fn is_last_delay(delay: f64) -> bool {
        LIMITS.iter().any(|end| (delay - end).abs() < 1e-9)
    }

    /// From now on delays are unknowns. They begin where the sum of squares is least on a grid.
    pub fn seek_delays(&mut self) {
        self.delays_of_grid();
        let (equations, _) = self.equations(None);
        self.fit(&equations);
        for (row, weight) in equations.rows.iter().zip(&self.weights) {
            self.seeks_delay[row.joint] |= *weight > 0.0;
        }
        self.settle();
    }

    /// The active columns, and those of delays.
    pub(super) fn with_delays(&self) -> Vec<usize> {
        let sought = (0..self.arm.dof()).filter(|&j| self.seeks_delay[j]);
        self.active.iter().copied().chain(sought.map(|j| self.place(Column::Delay(j)))).collect()
    }

    /// Gauss and Newton's steps until delays stay, through instruments where there are any. The standard error of each delay, and half of its
    /// interval; infinite where the logs do not show it, none where it is given.
    pub fn settle(&mut self) -> Vec<Option<[f64; 2]>> {
        let n = self.arm.dof();
        let all = self.with_delays();
        let own = std::mem::replace(&mut self.active, all);
        let mut errors = vec![None; n];
        for round in 0..STEPS {
            let (mut equations, _) = self.equations(None);
            let projected = self.with_instruments(&mut equations);
            let columns = projected.as_ref().unwrap_or(&equations);
            let sums = Sums::new(columns, &self.active);
            let mut weights = self.even_weights(&equations);
            self.take(&solve_fast(&sums.gram(&weights)));
            weights = self.even_weights(&equations);
            let solution = solve(&sums.gram(&weights), &DVector::zeros(self.active.len()));
            self.take(&solution.x);
            if self.move_delays() > SETTLED && round + 1 < STEPS {
                continue;
            }
            let residuals = equations.residuals(&self.active, &solution.x);
            let covariance = covariance(columns, &self.active, &residuals, &weights, &solution.inverse, n);
            for (k, &place) in self.active.iter().enumerate() {
                if let Column::Delay(j) = self.columns[place] {
                    let sigma = covariance.matrix[(k, k)].max(0.0).sqrt();
                    let is_hidden = solution.hidden.iter().any(|direction| direction[k].abs() > 0.1 * direction.amax());
                    errors[j] = Some([sigma, if is_hidden { f64::INFINITY } else { covariance.reach * sigma }]);
                }
            }
            break;
        }
        self.active = own;
        errors
    }

    /// Weights of the residuals of the estimate by their root of mean squares, nearly without Huber's: samples show a reversal up to a period
    /// late, and only the mean over all reversals is the delay. Beside a median, rows with a reversal would be outliers.
    fn even_weights(&self, equations: &Equations) -> Vec<f64> {
        let x = DVector::from_fn(self.active.len(), |k, _| self.x[self.active[k]]);
        let residuals = equations.residuals(&self.active, &x);
        let of_joint = |values: &[f64], j: usize| {
            let own = equations.rows.iter().zip(values).filter(|(row, _)| row.joint == j && row.counts);
            rms(&own.map(|(_, x)| *x).collect::<Vec<_>>()).max(f64::MIN_POSITIVE.sqrt())
        };
        let n = self.arm.dof();
        let sizes: Vec<[f64; 2]> = (0..n).map(|j| [of_joint(&residuals, j), of_joint(&equations.b, j)]).collect();
        let weight = |(row, residual): (&Row, &f64)| {
            let [size, torque] = sizes[row.joint];
            let outlier = (1.5 * size).max(OUTLIER * torque);
            f64::from(u8::from(row.counts)) * (outlier / residual.abs().max(outlier)) / (size * size)
        };
        equations.rows.iter().zip(&residuals).map(weight).collect()
    }

    /// Adds the changes that a fit found to the delays; the largest.
    fn move_delays(&mut self) -> f64 {
        let mut largest = 0.0f64;
        for j in (0..self.arm.dof()).filter(|&j| self.seeks_delay[j]) {
            let place = self.place(Column::Delay(j));
            let change = self.x[place].clamp(-2.0 * STEP, 2.0 * STEP);
            let next = (self.delays[j] + change).clamp(LIMITS[0], LIMITS[1]);
            largest = largest.max((next - self.delays[j]).abs());
            (self.delays[j], self.x[place]) = (next, 0.0);
        }
        largest
    }

    /// Leaves delays at 0 whose intervals are wider than delays are. Whether there are any.
    pub fn leave_undetermined_delays(&mut self, errors: &[Option<[f64; 2]>]) -> bool {
        let left: Vec<usize> =
            (0..errors.len()).filter(|&j| errors[j].is_some_and(|[_, half]| half.is_nan() || half > DETERMINED)).collect();
        left.iter().for_each(|&j| (self.seeks_delay[j], self.delays[j]) = (false, 0.0));
        !left.is_empty()
    }

    /// The columns of delays that are unknown: the slope of the torque that the estimate predicts, with the other sign. `known` is by row.
    pub(super) fn fill_delays(&self, equations: &mut Equations, known: &[f64]) {
        let n = self.arm.dof();
        let unknown: Vec<(usize, usize)> =
            (0..n).filter(|&j| self.seeks_delay[j]).map(|j| (j, self.place(Column::Delay(j)))).collect();
        let values: Vec<(usize, f64)> = self
            .active
            .iter()
            .map(|&place| (place, self.x[place]))
            .filter(|(place, _)| !matches!(self.columns[*place], Column::Delay(_)))
            .chain(self.fixed.iter().copied())
            .collect();
        let mut start = 0;
        for piece in self.pieces {
            let samples = piece.kept.len();
            let spacing = piece.kept.windows(2).next().map_or(1.0, |pair| (pair[1] - pair[0]) as f64 * piece.period);
            for &(j, place) in &unknown {
                let at = |row: usize| start + row * n + j;
                let predicted = |row: usize| {
                    let a = equations.row(at(row));
                    known[at(row)] + values.iter().map(|(place, x)| a[*place] * x).sum::<f64>()
                };
                let slopes = slopes(&(0..samples).map(predicted).collect::<Vec<_>>(), spacing);
                for (row, slope) in slopes.into_iter().enumerate() {
                    equations.a[at(row) * equations.columns + place] = -slope;
                }
            }
            start += n * samples;
        }
    }

    /// The delays of a grid that lower the sum of squares most, a joint after the other, all else fitted anew.
    fn delays_of_grid(&mut self) {
        let (equations, known) = self.equations(None);
        let n = self.arm.dof();
        let sums = Sums::new(&equations, &self.active);
        let weights = self.even_weights(&equations);
        let mut grams = sums.grams(&weights, n, |k| equations.rows[k].joint);
        for j in 0..n {
            let rows = sums.rows(j);
            if rows.iter().all(|&k| weights[k] == 0.0) {
                continue;
            }
            // What is known of a torque.
            let fixed = |k: usize| self.fixed.iter().map(|(place, value)| equations.row(k)[*place] * value).sum::<f64>();
            let known: Vec<f64> = rows.iter().map(|&k| known[k] + fixed(k)).collect();
            let with = |delay: f64| {
                let tau = self.pieces.iter().flat_map(|piece| piece.delayed(j, delay));
                let b: Vec<f64> = tau.zip(&known).map(|(tau, known)| tau * self.corrections[j] - known).collect();
                let weighted = rows.iter().zip(&b).map(|(&k, b)| weights[k] * b);
                let bb = weighted.clone().zip(&b).map(|(wb, b)| wb * b).sum();
                Gram { h: grams[j].h.clone(), g: sums.times(j, weighted), bb }
            };
            let cost = |own: &Gram| {
                let mut whole = own.clone();
                grams.iter().enumerate().filter(|(other, _)| *other != j).for_each(|(_, gram)| whole.add(gram));
                whole.squares(&solve_fast(&whole))
            };
            let tried = GRID.map(|k| f64::from(k) * STEP).map(|delay| (delay, with(delay)));
            let best = tried.map(|(delay, own)| (cost(&own), delay, own)).min_by(|a, b| a.0.total_cmp(&b.0)).expect("a grid");
            (self.delays[j], grams[j]) = (best.1, best.2);
        }
    }
}

/// Slopes of an even signal: central differences of the fourth order, of the second near the ends.
fn slopes(x: &[f64], spacing: f64) -> Vec<f64> {
    let mut slopes = crate::signal::derivative(x, spacing);
    for k in 2..x.len().saturating_sub(2) {
        slopes[k] = (8.0 * (x[k + 1] - x[k - 1]) - (x[k + 2] - x[k - 2])) / (12.0 * spacing);
    }
    slopes
}
