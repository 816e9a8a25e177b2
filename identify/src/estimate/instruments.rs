//! Noise of positions is noise of the columns too, and bends least squares towards 0.
//!
//! With the reference of the drives in the log, columns along it are instruments: they follow those of the motion, and share none of their
//! noise (Janot, Vandanjon and Gautier, IEEE T-CST 22, 2014). Columns of dry friction are those along it. Without it, the same equations at half the cutoff must agree:
//! less of such noise passes, so an estimate that noise bends moves.
//!
//! ```text
//! A' = Z (Z'WZ)^-1 Z'WA                            in place of A; Z has the columns along the reference
//! d  = x_half - x,   cov d = sum_b e_b e_b',   e_b = H_half^-1 g_half,b - H^-1 g_b      over the same blocks of time
//! ```

use nalgebra::{DMatrix, DVector};

use crate::estimate::{Column, Estimate};
use crate::fit::{block_length, reach, scores, solve, Equations, Gram, Pattern, Solution, Sums};
use crate::signal::LowPass;

impl Estimate<'_> {
    /// Equations with the active columns of others in the space of their instruments; the right-hand side stays. Dry friction is not linear
    /// in the rate, so the equations themselves get its columns along the reference.
    pub(crate) fn with_instruments(&self, equations: &mut Equations) -> Option<Equations> {
        let pieces = self.along_reference?;
        let mut along = Estimate { pieces, along_reference: None, ..self.clone() };
        along.renew_sizes();
        let (instruments, _) = along.equations_with_delays(true);
        let is_dry = |place: &usize| matches!(self.columns[*place], Column::Friction(_, _, term) if term.is_dry());
        for &place in self.active.iter().filter(|place| is_dry(place)) {
            for k in 0..equations.rows.len() {
                if equations.pattern(k).entry(place).is_some() {
                    *equations.at_mut(k, place) = instruments.at(k, place);
                }
            }
        }
        let n = self.active.len();
        let gram = Sums::new(&instruments, &self.active).gram(&self.weights);
        let mut mixed = DMatrix::zeros(n, n);
        for (k, &weight) in self.weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let a: Vec<(usize, f64)> = (0..n).map(|j| (j, equations.at(k, self.active[j]))).filter(|(_, a)| *a != 0.0).collect();
            for i in 0..n {
                let z = weight * instruments.at(k, self.active[i]);
                if z != 0.0 {
                    a.iter().for_each(|(j, a)| mixed[(i, *j)] += z * a);
                }
            }
        }
        let by = solve(&gram, &DVector::zeros(n)).inverse * mixed;
        // Behind the projection every row has all active columns. Those of gains are 0.
        let (rows, gains) = (equations.rows.len(), (0..self.arm.dof()).map(|j| self.place(Column::Gain(j))));
        let pattern = Pattern::new(self.active.iter().copied().chain(gains).collect());
        let entries = rows * pattern.places.len();
        let mut projected = Equations::new(equations.columns, vec![pattern], rows, entries);
        for (k, row) in equations.rows.iter().enumerate() {
            let z = DVector::from_fn(n, |i, _| instruments.at(k, self.active[i]));
            projected.push(*row, equations.b[k], 0)[..n].copy_from_slice(by.tr_mul(&z).as_slice());
        }
        Some(projected)
    }

    /// The active columns, by their places among them, that half the cutoff moves out of their intervals and by more than chance; the worst first.
    pub(crate) fn moved_by_half_the_cutoff(
        &self,
        equations: &Equations,
        solution: &Solution,
        cutoff: f64,
        is_outside: &dyn Fn(usize, f64) -> bool,
    ) -> Vec<usize> {
        let n = self.arm.dof();
        let half = self.at_half_the_cutoff(equations, cutoff);
        let weights: Vec<f64> = self.weights.iter().zip(&half.rows).map(|(w, row)| if row.counts { *w } else { 0.0 }).collect();
        if weights.iter().filter(|weight| **weight > 0.0).count() < 5 * self.active.len() {
            return Vec::new();
        }
        let gram: Gram = Sums::new(&half, &self.active).gram(&weights);
        let other = solve(&gram, &solution.x);
        let residuals = [equations.residuals(&self.active, &solution.x), half.residuals(&self.active, &other.x)];
        let lengths = [block_length(equations, &residuals[0], &self.weights, n), block_length(&half, &residuals[1], &weights, n)];
        let length = lengths[0].max(lengths[1]);
        let own = scores(equations, &self.active, &residuals[0], &self.weights, length);
        let of_half = scores(&half, &self.active, &residuals[1], &weights, length);
        let apart: Vec<DVector<f64>> =
            own.iter().zip(&of_half).map(|(own, half)| &other.inverse * half - &solution.inverse * own).collect();
        // As many verdicts as columns: all of them together are as rarely wrong as an interval.
        let (free, reach) = reach(apart.len(), self.active.len(), n, self.active.len());
        let factor = apart.len() as f64 / free;
        let excess = |k: usize| {
            let moved = (other.x[k] - solution.x[k]).abs();
            let of_chance = reach * (factor * apart.iter().map(|of| of[k] * of[k]).sum::<f64>()).sqrt();
            moved / of_chance.max(f64::MIN_POSITIVE)
        };
        let outside = (0..self.active.len()).filter(|&k| is_outside(k, other.x[k]));
        let mut moved: Vec<(usize, f64)> = outside.map(|k| (k, excess(k))).filter(|(_, excess)| *excess > 1.0).collect();
        moved.sort_by(|a, b| b.1.total_cmp(&a.1));
        moved.into_iter().map(|(k, _)| k).collect()
    }

    /// The same equations behind a low pass of half the cutoff. Rows whose neighbours within a period of the cutoff do not count do not, nor do
    /// those near the ends of a piece.
    fn at_half_the_cutoff(&self, equations: &Equations, cutoff: f64) -> Equations {
        let n = self.arm.dof();
        let mut half = equations.clone();
        let mut start = 0;
        for piece in self.pieces {
            let samples = piece.kept.len();
            let period = piece.kept.windows(2).map(|pair| (pair[1] - pair[0]) as f64 * piece.period).next().unwrap_or(1.0);
            let filter = LowPass::new(0.5 * cutoff, 1.0 / period);
            let (near, end) = ((1.0 / (cutoff * period)).ceil() as usize, (8.0 / (cutoff * period)).ceil() as usize);
            for j in 0..n {
                let at = |row: usize| start + row * n + j;
                let filtered = |of: &dyn Fn(usize) -> f64| filter.both_ways(&(0..samples).map(of).collect::<Vec<_>>());
                for &place in self.active.iter().filter(|&&place| (0..samples).any(|row| equations.at(at(row), place) != 0.0)) {
                    let column = filtered(&|row| equations.at(at(row), place));
                    column.iter().enumerate().for_each(|(row, x)| *half.at_mut(at(row), place) = *x);
                }
                let b = filtered(&|row| equations.b[at(row)]);
                b.iter().enumerate().for_each(|(row, x)| half.b[at(row)] = *x);
                for row in 0..samples {
                    let around = row.saturating_sub(near)..(row + near + 1).min(samples);
                    half.rows[at(row)].counts = (end..samples.saturating_sub(end)).contains(&row)
                        && around.into_iter().all(|row| equations.rows[at(row)].counts);
                }
            }
            start += n * samples;
        }
        half
    }
}
