//! Delays of torques behind positions, found together with everything else.
//!
//! ```text
//! tau_j(t + d_j) = (A x)_j(t)        a change of d_j is an unknown with the column -d(A x)_j/dt
//! ```
//!
//! The column is that of the predicted torque: the measured one has noise, which makes a delay seem smaller and more certain than it is.
//!
//! Dry friction jumps where a rate changes its sign, and a sampled torque shows the sign of a delay before its sample. Its columns are taken there:
//! shifted between samples, a sampled jump is off by up to a period. So the sum of squares has a jump wherever a delay moves a reversal to another
//! sample, and between these it is smooth. Gauss and Newton's steps come near, a grid finds the stretch between jumps, further steps the place in it.

use nalgebra::DVector;

use crate::estimate::{Column, Estimate};
use crate::fit::{covariance, solve, solve_fast, Equations, Gram, Row, Solution, Sums};
use crate::prepare::Piece;
use crate::signal::{rms, slopes};

/// A grid of delays about those at hand: steps to either side, and the step, s.
type Grid = (std::ops::RangeInclusive<i32>, f64);

/// All delays that there are.
const COARSE: [Grid; 1] = [(-4..=10, 2.5e-3)];

/// About delays that are nearly right.
const FINE: [Grid; 4] = [(-6..=6, 1e-3), (-4..=4, 2.5e-4), (-4..=4, 6e-5), (-3..=3, 1.5e-5)];

/// The first of these about delays that are off by a part of a period.
const NEAR: usize = 2;

/// Times at most that these are gone through again.
const SWEEPS: usize = 4;

/// The least and the largest delay, s.
const LIMITS: [f64; 2] = [-1e-2, 2.5e-2];

/// Delays of a grid that are tried side by side.
const TOGETHER: usize = 4;

/// A delay this near to them is at its limit, s.
const AT_LIMIT: f64 = 1e-4;

/// Half of an interval is at most that wide where a delay counts as determined, s.
const DETERMINED: f64 = 1e-2;

/// A residual above this part of the torque of its joint is an outlier.
const OUTLIER: f64 = 0.5;

/// Gauss and Newton's steps at most: before a grid, behind it, and where there is none.
const STEPS: [usize; 3] = [5, 4, 12];

/// The largest of these, and the largest behind the fine grid, s.
const LARGEST: [f64; 2] = [5e-3, 4e-5];

/// A delay that changes by less has been found, s: at first, and where no grid follows.
const SETTLED: [f64; 2] = [1e-4, 1e-8];

/// How far delays may be from those that explain the logs best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// Terms of friction hid them.
    Afar,
    /// They are those of a part of the rows.
    Rows,
    /// Terms of friction, or other delays, have changed a little.
    Near,
}

impl Estimate<'_> {
    /// Whether a delay is the first or the last of those that are tried.
    pub fn is_last_delay(delay: f64) -> bool {
        LIMITS.iter().any(|end| (delay - end).abs() < AT_LIMIT)
    }

    /// From now on delays are unknowns. They begin where the sum of squares is least on a grid.
    pub fn seek_delays(&mut self) {
        self.delays_of_grid(&COARSE);
        let (equations, _) = self.equations(None);
        self.fit(&equations);
        for (row, weight) in equations.rows.iter().zip(&self.weights) {
            self.seeks_delay[row.joint] |= *weight > 0.0;
        }
        self.step_delays(0);
        // Terms of friction are chosen next, and a delay that is nearly right makes some seem to be there.
        self.delays_of_grid(&FINE);
        self.step_delays(1);
    }

    /// The active columns, and those of delays.
    pub(super) fn with_delays(&self) -> Vec<usize> {
        let sought = (0..self.arm.dof()).filter(|&j| self.seeks_delay[j]);
        self.active.iter().copied().chain(sought.map(|j| self.place(Column::Delay(j)))).collect()
    }

    /// The delays that explain the logs best, through instruments where there are any. The standard error of each, and half of its interval;
    /// infinite where the logs do not show it, none where it is given.
    pub fn settle(&mut self, from: From) -> Vec<Option<[f64; 2]>> {
        if from == From::Afar {
            self.step_delays(0);
        }
        let is_direct = self.along_reference.is_none();
        let mut weights = None;
        if is_direct {
            self.delays_of_grid(if from == From::Near { &FINE[NEAR..] } else { &FINE });
            weights = self.step_delays(1);
        }
        if is_direct && from == From::Afar {
            self.sweep();
            weights = None;
        }
        let n = self.arm.dof();
        let mut errors = vec![None; n];
        let own = self.activate_delays();
        let (mut equations, known) = self.equations_with_delays(true);
        let projected = self.with_instruments(&mut equations);
        let (weights, solution) = self.fit_delays(projected.as_ref().unwrap_or(&equations), &equations, weights, is_direct);
        let residuals = equations.residuals(&self.active, &solution.x);
        let sigmas = |columns: &Equations, solution: &Solution| {
            let of = covariance(columns, &self.active, &residuals, &weights, &solution.inverse, n);
            let sigma = |k: usize| {
                let is_hidden = solution.hidden.iter().any(|direction| direction[k].abs() > 0.1 * direction.amax());
                if is_hidden {
                    f64::INFINITY
                } else {
                    of.matrix[(k, k)].max(0.0).sqrt()
                }
            };
            ((0..self.active.len()).map(sigma).collect::<Vec<f64>>(), of.reach)
        };
        let (mut found, reach) = sigmas(projected.as_ref().unwrap_or(&equations), &solution);
        if is_direct {
            // Of samples, jumps tell a delay to the distance of their places within a period. What is smooth may tell it better.
            self.fill_delays(&mut equations, &known, false);
            let smooth = solve(&Sums::new(&equations, &self.active).gram(&weights), &DVector::zeros(self.active.len()));
            let (smooth, _) = sigmas(&equations, &smooth);
            for (k, &place) in self.active.iter().enumerate() {
                if let Column::Delay(j) = self.columns[place] {
                    found[k] = found[k].hypot(self.apart(j)).min(smooth[k]);
                }
            }
        }
        for (k, &place) in self.active.iter().enumerate() {
            if let Column::Delay(j) = self.columns[place] {
                errors[j] = Some([found[k], reach * found[k]]);
                self.x[place] = 0.0;
            }
        }
        self.active = own;
        if self.weights.len() != weights.len() {
            // The first of this estimate.
            self.weights = weights;
        }
        errors
    }

    /// Goes through the finest grids again while that makes residuals smaller: before, the delays of other joints were not those yet, nor was |g|.
    fn sweep(&mut self) {
        let mut least = self.logarithm_of_spreads();
        for _ in 0..SWEEPS {
            let before = self.delays.clone();
            self.delays_of_grid(&FINE[NEAR..]);
            self.step_delays(1);
            let next = self.logarithm_of_spreads();
            if next >= least {
                self.delays = before;
                self.logarithm_of_spreads();
                break;
            }
            least = next;
        }
    }

    /// Of the robust spreads that a fit with the delays at hand leaves, the sum of logarithms.
    fn logarithm_of_spreads(&mut self) -> f64 {
        self.renew_sizes();
        self.fit_active();
        self.spreads.iter().map(|spread| spread.ln()).sum()
    }

    /// The mean distance of the places that reversals of a joint have within a period, s.
    fn apart(&self, j: usize) -> f64 {
        let n = self.arm.dof();
        let rate = |piece: &Piece, k: usize| piece.dq[k * n + j];
        let of = |piece: &Piece| piece.kept.windows(2).filter(|k| rate(piece, k[0]) * rate(piece, k[1]) < 0.0).count();
        let reversals: usize = self.pieces.iter().map(of).sum();
        self.pieces.iter().fold(0.0f64, |longest, piece| longest.max(piece.period)) / reversals as f64
    }

    /// Puts the delays among the active columns; those that were active alone.
    fn activate_delays(&mut self) -> Vec<usize> {
        let all = self.with_delays();
        std::mem::replace(&mut self.active, all)
    }

    /// Gauss and Newton's steps until delays stay: from afar, or behind the fine grid. The weights of the rows.
    fn step_delays(&mut self, stage: usize) -> Option<Vec<f64>> {
        let is_last = stage == 1 || self.along_reference.is_some();
        let steps = STEPS[if self.along_reference.is_some() { 2 } else { stage }];
        let own = self.activate_delays();
        let mut weights = None;
        for _ in 0..steps {
            let (mut equations, _) = self.equations_with_delays(stage == 0);
            let projected = self.with_instruments(&mut equations);
            let before = weights.take().filter(|_| stage == 1);
            weights = Some(self.fit_delays(projected.as_ref().unwrap_or(&equations), &equations, before, stage == 1).0);
            if self.move_delays(LARGEST[stage]) < SETTLED[usize::from(is_last)] {
                break;
            }
        }
        self.active = own;
        weights
    }

    /// The fit of the active columns, and its weights, from those of nearly the same equations. Where delays are nearly right, outliers are those
    /// beside the median.
    fn fit_delays(
        &mut self,
        columns: &Equations,
        equations: &Equations,
        before: Option<Vec<f64>>,
        is_near: bool,
    ) -> (Vec<f64>, Solution) {
        let sums = Sums::new(columns, &self.active);
        let rounds = if is_near && before.is_none() { 4 } else { 1 };
        let mut weights = before.unwrap_or_else(|| self.even_weights(equations));
        for _ in 0..rounds {
            self.take(&solve_fast(&sums.gram(&weights)));
            weights = if is_near {
                let x = DVector::from_fn(self.active.len(), |k, _| self.x[self.active[k]]);
                equations.weights(&equations.residuals(&self.active, &x), self.arm.dof()).0
            } else {
                self.even_weights(equations)
            };
        }
        let solution = solve(&sums.gram(&weights), &DVector::zeros(self.active.len()));
        self.take(&solution.x);
        (weights, solution)
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
    fn move_delays(&mut self, most: f64) -> f64 {
        let mut largest = 0.0f64;
        for j in (0..self.arm.dof()).filter(|&j| self.seeks_delay[j]) {
            let place = self.place(Column::Delay(j));
            let next = (self.delays[j] + self.x[place].clamp(-most, most)).clamp(LIMITS[0], LIMITS[1]);
            largest = largest.max((next - self.delays[j]).abs());
            (self.delays[j], self.x[place]) = (next, 0.0);
        }
        largest
    }

    /// Leaves delays at 0 whose intervals are wider than delays are, and have 0. Whether there are any.
    pub fn leave_undetermined_delays(&mut self, errors: &[Option<[f64; 2]>]) -> bool {
        let is_left = |j: usize, half: f64| half.is_nan() || half > DETERMINED.max(self.delays[j].abs());
        let left: Vec<usize> = (0..errors.len()).filter(|&j| errors[j].is_some_and(|[_, half]| is_left(j, half))).collect();
        left.iter().for_each(|&j| (self.seeks_delay[j], self.delays[j]) = (false, 0.0));
        !left.is_empty()
    }

    /// The equations with columns of the delays that are unknown, and what is known.
    pub(super) fn equations_with_delays(&self, with_dry: bool) -> (Equations, Vec<f64>) {
        let (mut equations, known) = self.equations(None);
        self.fill_delays(&mut equations, &known, with_dry);
        (equations, known)
    }

    /// The columns of delays that are unknown: the slope of the torque that the estimate predicts, with the other sign. `known` is by row. Without
    /// dry friction it is that between jumps.
    fn fill_delays(&self, equations: &mut Equations, known: &[f64], with_dry: bool) {
        let n = self.arm.dof();
        let unknown: Vec<(usize, usize)> =
            (0..n).filter(|&j| self.seeks_delay[j]).map(|j| (j, self.place(Column::Delay(j)))).collect();
        let values: Vec<(usize, f64)> = self
            .active
            .iter()
            .map(|&place| (place, self.x[place]))
            .chain(self.fixed.iter().copied())
            .filter(|(place, _)| match self.columns[*place] {
                Column::Delay(_) => false,
                Column::Friction(_, _, term) => with_dry || !term.is_dry(),
                _ => true,
            })
            .collect();
        let mut start = 0;
        for piece in self.pieces {
            let samples = piece.kept.len();
            let spacing = piece.kept.windows(2).next().map_or(1.0, |pair| (pair[1] - pair[0]) as f64 * piece.period);
            for &(j, place) in &unknown {
                let at = |row: usize| start + row * n + j;
                let predicted: Vec<f64> = {
                    let product = equations.product(&values);
                    (0..samples).map(|row| known[at(row)] + product(at(row))).collect()
                };
                for (row, slope) in slopes(&predicted, spacing).into_iter().enumerate() {
                    *equations.at_mut(at(row), place) = -slope;
                }
            }
            start += n * samples;
        }
    }

    /// The delays of grids, each about the best of the one before, that lower the sum of squares most; a joint after the other, all else fitted
    /// anew.
    fn delays_of_grid(&mut self, grids: &[Grid]) {
        let (equations, known) = self.equations(None);
        let n = self.arm.dof();
        let sums = Sums::new(&equations, &self.active);
        let weights = self.even_weights(&equations);
        let fixed = equations.product(&self.fixed);
        let mut grams = sums.grams(&weights, n, |k| equations.rows[k].joint);
        for j in 0..n {
            let rows = sums.rows(j);
            let is_given = grids.len() > COARSE.len() && !self.seeks_delay[j];
            if is_given || rows.iter().all(|&k| weights[k] == 0.0) {
                continue;
            }
            // What is known of a torque.
            let known: Vec<f64> = rows.iter().map(|&k| known[k] + fixed(k)).collect();
            let weights: Vec<f64> = rows.iter().map(|&k| weights[k]).collect();
            let with = |delays: [f64; TOGETHER]| self.with_delays_of(&sums, &grams[j], j, delays, &known, &weights);
            let mut others = Gram::zero(self.active.len());
            grams.iter().enumerate().filter(|(other, _)| *other != j).for_each(|(_, gram)| others.add(gram));
            let cost = |own: &Gram| {
                let mut whole = own.clone();
                whole.add(&others);
                whole.squares(&solve_fast(&whole))
            };
            let mut best = (f64::INFINITY, self.delays[j], grams[j].clone());
            for (steps, step) in grids {
                let middle = best.1;
                let delays: Vec<f64> =
                    steps.clone().map(|k| (middle + f64::from(k) * step).clamp(LIMITS[0], LIMITS[1])).collect();
                for group in delays.chunks(TOGETHER) {
                    let filled = std::array::from_fn(|i| group[i.min(group.len() - 1)]);
                    for (&delay, own) in group.iter().zip(with(filled)) {
                        let cost = cost(&own);
                        if cost < best.0 {
                            best = (cost, delay, own);
                        }
                    }
                }
            }
            (self.delays[j], grams[j]) = (best.1, best.2);
        }
    }

    /// The sums of a joint's rows with other delays of it; `known` and `weights` are those of its rows.
    fn with_delays_of(
        &self,
        sums: &Sums,
        gram: &Gram,
        j: usize,
        delays: [f64; TOGETHER],
        known: &[f64],
        weights: &[f64],
    ) -> [Gram; TOGETHER] {
        // By delay, columns of dry friction with their places.
        let mut dry: [Vec<(usize, Vec<f64>)>; TOGETHER] = Default::default();
        for (k, &place) in self.active.iter().enumerate() {
            let Column::Friction(session, joint, term) = self.columns[place] else { continue };
            if joint != j || !term.is_dry() {
                continue;
            }
            dry.iter_mut().for_each(|dry| dry.push((k, Vec::with_capacity(known.len()))));
            for (piece, sizes) in self.pieces.iter().zip(&self.sizes) {
                let columns = if self.runs[piece.log].session == session {
                    piece.columns(j, term, self.velocities[j], sizes, delays)
                } else {
                    delays.map(|_| vec![0.0; piece.kept.len()])
                };
                for (dry, column) in dry.iter_mut().zip(columns) {
                    dry.last_mut().expect("a column").1.extend(column);
                }
            }
        }
        let mut dry = dry.into_iter();
        delays.map(|delay| self.with_delay(sums, gram, j, delay, [known, weights], &dry.next().unwrap_or_default()))
    }

    /// The sums of a joint's rows with another delay of it and its columns of dry friction; `known` and `weights` are those of its rows.
    fn with_delay(
        &self,
        sums: &Sums,
        gram: &Gram,
        j: usize,
        delay: f64,
        [known, weights]: [&[f64]; 2],
        dry: &[(usize, Vec<f64>)],
    ) -> Gram {
        let mut gram = gram.clone();
        let tau = self.pieces.iter().flat_map(|piece| piece.delayed(j, delay));
        let b: Vec<f64> = tau.zip(known).map(|(tau, known)| tau * self.corrections[j] - known).collect();
        let product = |x: &[f64], y: &[f64]| x.iter().zip(y).zip(weights).map(|((x, y), w)| w * x * y).sum::<f64>();
        let times = |x: &[f64]| sums.times(j, x.iter().zip(weights).map(|(x, w)| w * x));
        (gram.g, gram.bb) = (times(&b), product(&b, &b));
        for (k, column) in dry {
            let with_others = times(column);
            gram.h.set_column(*k, &with_others);
            gram.h.set_row(*k, &with_others.transpose());
            gram.g[*k] = product(column, &b);
        }
        for (k, column) in dry {
            dry.iter().for_each(|(l, other)| gram.h[(*k, *l)] = product(column, other));
        }
        gram
    }
}
