//! From a log to filtered rows: the model's columns and the torques go through one low pass.
//!
//! Positions and rates are smoothed wide, accelerations are central differences of rates. Columns are computed from these at the full rate, then
//! they and the torques pass the same zero-phase low pass, and every few samples are kept. A filter that both sides pass changes no parameter.

use std::ops::Range;

use crate::arm::Arm;
use crate::log::Log;
use crate::signal::{derivative, interpolate, period, pieces, spread, LowPass};

/// Terms of friction, in the order of the columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Friction {
    /// Fv dq.
    Viscous,
    /// Fc sign(dq).
    Coulomb,
    /// F0.
    Offset,
    /// Fl |g| sign(dq).
    Load,
    /// F3 dq³.
    Cubic,
    /// Fs sign(dq) exp(-|dq|/vs).
    Stribeck,
}

impl Friction {
    /// All terms.
    pub const ALL: [Friction; 6] =
        [Friction::Viscous, Friction::Coulomb, Friction::Offset, Friction::Load, Friction::Cubic, Friction::Stribeck];

    /// Its key in a description.
    pub fn key(self) -> &'static str {
        match self {
            Friction::Viscous => "viscous",
            Friction::Coulomb => "coulomb",
            Friction::Offset => "offset",
            Friction::Load => "load",
            Friction::Cubic => "cubic",
            Friction::Stribeck => "stribeck",
        }
    }

    /// Whether its coefficient is at least 0.
    pub fn is_not_negative(self) -> bool {
        matches!(self, Friction::Viscous | Friction::Coulomb | Friction::Load | Friction::Stribeck)
    }

    /// The column at a rate with a sign; `size` is |g| of the joint, `velocity` that of Stribeck friction.
    pub fn column(self, dq: f64, sign: f64, size: f64, velocity: f64) -> f64 {
        match self {
            Friction::Viscous => dq,
            Friction::Coulomb => sign,
            Friction::Offset => 1.0,
            Friction::Load => sign * size,
            Friction::Cubic => dq * dq * dq,
            Friction::Stribeck => sign * (-dq.abs() / velocity).exp(),
        }
    }
}

/// A stretch of a log on an even grid.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The log, by its place.
    pub log: usize,
    /// s between samples.
    pub period: f64,
    /// The first stamp, s.
    pub start: f64,
    /// Positions and rates, smoothed wide, state by state.
    pub q: Vec<f64>,
    /// Rates.
    pub dq: Vec<f64>,
    /// Accelerations.
    pub ddq: Vec<f64>,
    /// Filtered torques at the full rate, by joint.
    pub tau: Vec<Vec<f64>>,
    /// Samples that are kept.
    pub kept: Vec<usize>,
    /// Filtered Y_b of the kept samples, state by state, row by row; empty where it is not wanted.
    pub y: Vec<f64>,
    /// Filtered known torques of the kept samples, state by state.
    pub known: Vec<f64>,
    /// Whether a row counts, by kept sample and joint.
    pub counts: Vec<bool>,
    /// Smoothing of the sign, by joint.
    pub eps: Vec<f64>,
    /// Smooth signs of the rates, state by state.
    pub signs: Vec<f64>,
    /// The low pass.
    pub filter: LowPass,
    /// Filtered columns of friction that depend on rates alone, by joint.
    of_rates: Vec<[Vec<f64>; 3]>,
}

/// These terms.
const OF_RATES: [Friction; 3] = [Friction::Viscous, Friction::Coulomb, Friction::Cubic];

/// Columns that are filtered side by side.
const TOGETHER: usize = 4;

/// Samples of a stretch that are filtered at once.
const LONGEST: usize = 16_384;

/// Least smoothing of a sign, rad/s or m/s.
const LEAST_EPS: f64 = 0.003;

/// How long a rate keeps its sign where friction at low rates counts, s.
const STEADY: f64 = 0.1;

/// The stretches of a log on grids of its median period. `flawed` are stretches of time with torques that do not count, by joint. Without
/// `columns` there is no filtered Y_b.
pub fn prepare(arm: &Arm, place: usize, log: &Log, cutoff: f64, flawed: &[Vec<Range<f64>>], columns: bool) -> Vec<Piece> {
    let period = period(&log.t);
    let rate = 1.0 / period;
    let margin = (4.0 / cutoff * rate).ceil() as usize;
    let mut all = Vec::new();
    for range in pieces(&log.t, period) {
        let (t, span) = (&log.t[range.clone()], log.t[range.end - 1] - log.t[range.start]);
        let samples = (span / period + 1.0 + 1e-6).floor() as usize;
        let mut first = 0;
        while first + 2 * margin + 4 < samples {
            let last = (first + LONGEST + 2 * margin).min(samples);
            let grid: &[f64] = &(first..last).map(|k| t[0] + k as f64 * period).collect::<Vec<_>>();
            // Stamps that are even but for rounding are the grid, so that nothing is interpolated.
            let even =
                t.len() == samples && t.iter().enumerate().all(|(k, t0)| (t0 - t[0] - k as f64 * period).abs() < 1e-3 * period);
            let on_grid = |x: &[f64]| {
                let x = &x[range.clone()];
                if even {
                    x[first..last].to_vec()
                } else {
                    interpolate(t, x, grid)
                }
            };
            all.push(piece(arm, place, log, cutoff, flawed, columns, &on_grid, grid, margin));
            if last == samples {
                break;
            }
            first = last - 2 * margin;
        }
    }
    all
}

#[allow(clippy::too_many_arguments)]
fn piece(
    arm: &Arm,
    place: usize,
    log: &Log,
    cutoff: f64,
    flawed: &[Vec<Range<f64>>],
    with_columns: bool,
    on_grid: &dyn Fn(&[f64]) -> Vec<f64>,
    grid: &[f64],
    margin: usize,
) -> Piece {
    let (n, samples) = (arm.dof(), grid.len());
    let period = (grid[samples - 1] - grid[0]) / (samples - 1) as f64;
    let rate = 1.0 / period;
    let wide_cutoff = (5.0 * cutoff).min(0.4 * rate);
    let wide = LowPass::new(wide_cutoff, rate);
    let filter = LowPass::new(cutoff, rate);
    let (mut q, mut dq, mut ddq) = (vec![0.0; n * samples], vec![0.0; n * samples], vec![0.0; n * samples]);
    let (mut eps, mut noises) = (Vec::new(), Vec::new());
    let mut steady = vec![false; n * samples];
    for i in 0..n {
        let position = on_grid(&log.q[i]);
        let rough = match &log.dq {
            Some(rates) => on_grid(&rates[i]),
            None => derivative(&position, period),
        };
        // Second differences of white noise have six times its variance.
        let second: Vec<f64> = rough.windows(3).map(|x| x[0] - 2.0 * x[1] + x[2]).collect();
        let noise = spread(&second) / 6f64.sqrt() * (2.0 * wide_cutoff / rate).sqrt().min(1.0);
        eps.push((3.0 * noise).max(LEAST_EPS));
        noises.push(noise);
        let (smooth, rates) = (wide.both_ways(&position), wide.both_ways(&rough));
        let accelerations = derivative(&rates, period);
        let mut start = 0;
        for k in 0..samples {
            (q[k * n + i], dq[k * n + i], ddq[k * n + i]) = (smooth[k], rates[k], accelerations[k]);
            let ends = k + 1 == samples || rates[k + 1].signum() != rates[k].signum() || rates[k] == 0.0;
            if ends {
                let long = (k + 1 - start) as f64 * period >= STEADY && rates[k] != 0.0;
                (start..=k).for_each(|k| steady[k * n + i] = long);
                start = k + 1;
            }
        }
    }
    let tau: Vec<Vec<f64>> = log.effort.iter().map(|tau| filter.both_ways(&on_grid(tau))).collect();
    let step = ((rate / (5.0 * cutoff)).round() as usize).max(1);
    let kept: Vec<usize> = (margin..samples.saturating_sub(margin)).step_by(step).collect();
    let counts = kept
        .iter()
        .flat_map(|&k| (0..n).map(move |i| (k, i)))
        .map(|(k, i)| {
            let moves = dq[k * n + i].abs() > 3.0 * eps[i] || (steady[k * n + i] && dq[k * n + i].abs() > 1e-9);
            moves && !flawed.get(i).is_some_and(|flawed| flawed.iter().any(|stretch| stretch.contains(&grid[k])))
        })
        .collect();
    let keep = |full: &[f64], columns: usize| {
        let mut kept_rows = vec![0.0; kept.len() * columns];
        let mut is_zero = vec![true; columns];
        full.chunks_exact(columns).for_each(|row| is_zero.iter_mut().zip(row).for_each(|(zero, x)| *zero &= *x == 0.0));
        let filled: Vec<usize> = (0..columns).filter(|&column| !is_zero[column]).collect();
        for group in filled.chunks(TOGETHER) {
            let mut signals = vec![[0.0; TOGETHER]; samples];
            for (signal, row) in signals.iter_mut().zip(full.chunks_exact(columns)) {
                for i in 0..group.len() {
                    signal[i] = row[group[i]];
                }
            }
            let filtered = filter.side_by_side(&signals);
            for (row, &k) in kept.iter().enumerate() {
                group.iter().zip(filtered[k]).for_each(|(column, x)| kept_rows[row * columns + column] = x);
            }
        }
        kept_rows
    };
    let y = if with_columns { keep(&arm.regressor(&q, &dq, &ddq), n * arm.base.len()) } else { Vec::new() };
    let known = keep(&arm.known(&q, &dq, &ddq), n);
    let signs = dq.iter().enumerate().map(|(k, dq)| smooth_sign(*dq, eps[k % n], noises[k % n])).collect();
    let start = grid[0];
    let mut piece =
        Piece { log: place, period, start, q, dq, ddq, tau, kept, y, known, counts, eps, signs, filter, of_rates: Vec::new() };
    piece.of_rates = (0..n).map(|i| OF_RATES.map(|term| piece.column(i, term, 1.0, &[]))).collect();
    piece
}

/// The sign of a rate with noise, smooth within eps.
///
/// tanh u + k u sech² u with u = dq/eps. The first term alone lacks eps ln 2 of the integral of a sign on either side of 0, which seems to be
/// less Coulomb friction, and more Stribeck friction. With k the mean over the noise has the whole integral, and a reversal is short before
/// the low pass. For noise n, E[eps ln cosh(n/eps)] and the like are n²/(2 eps).
fn smooth_sign(dq: f64, eps: f64, noise: f64) -> f64 {
    let (u, part) = (dq / eps, 0.5 * (noise / eps).powi(2));
    let k = (std::f64::consts::LN_2 + part) / (std::f64::consts::LN_2 - part);
    let t = u.tanh();
    t + k * u * (1.0 - t * t)
}

impl Piece {
    /// A part of the kept samples, as it would be with the states under other joints and signs: joint j has the states of `order[j]` times
    /// `signs[j]`, and the torque of `torques[j]` times a scale. Y is not filtered.
    pub fn exchanged(&self, arm: &Arm, order: &[usize], signs: &[f64], torques: &[(usize, f64)], step: usize) -> Piece {
        let n = order.len();
        let rows: Vec<usize> = (0..self.kept.len()).step_by(step).collect();
        let by_joint = |x: &[f64], at: usize| order.iter().zip(signs).map(|(&j, sign)| sign * x[at * n + j]).collect::<Vec<_>>();
        let of_states = |x: &[f64]| rows.iter().flat_map(|&row| by_joint(x, self.kept[row])).collect::<Vec<f64>>();
        let (q, dq, ddq) = (of_states(&self.q), of_states(&self.dq), of_states(&self.ddq));
        let torque = |&(j, scale): &(usize, f64)| rows.iter().map(|&row| scale * self.tau[j][self.kept[row]]).collect();
        // All of these are odd functions of the rate.
        let of_rates = |(&j, sign): (&usize, &f64)| {
            let thin = |column: Vec<f64>| rows.iter().map(|&row| sign * column[row]).collect();
            OF_RATES.map(|term| thin(self.friction(j, term, 1.0, &[])))
        };
        let spacing = if rows.len() > 1 { self.kept[rows[1]] - self.kept[rows[0]] } else { step };
        Piece {
            log: self.log,
            period: self.period * spacing as f64,
            start: self.time(0),
            tau: torques.iter().map(torque).collect(),
            kept: (0..rows.len()).collect(),
            y: arm.regressor(&q, &dq, &ddq),
            known: arm.known(&q, &dq, &ddq),
            counts: rows.iter().flat_map(|&row| order.iter().map(move |&j| self.counts[row * n + j])).collect(),
            eps: order.iter().map(|&j| self.eps[j]).collect(),
            signs: of_states(&self.signs),
            filter: self.filter.clone(),
            of_rates: order.iter().zip(signs).map(of_rates).collect(),
            q,
            dq,
            ddq,
        }
    }

    /// The stamp of a kept sample, s.
    pub fn time(&self, row: usize) -> f64 {
        self.start + self.kept[row] as f64 * self.period
    }

    /// Filtered torque of a joint at the kept samples, of a time later by a delay.
    pub fn delayed(&self, joint: usize, delay: f64) -> Vec<f64> {
        let shift = delay / self.period;
        if shift == 0.0 {
            return self.kept.iter().map(|&k| self.tau[joint][k]).collect();
        }
        self.kept.iter().map(|&k| crate::signal::between(&self.tau[joint], k as f64 + shift)).collect()
    }

    /// A filtered column of a joint at the kept samples. `sizes` has |g| state by state, and is used by load friction.
    pub fn friction(&self, joint: usize, term: Friction, velocity: f64, sizes: &[f64]) -> Vec<f64> {
        match OF_RATES.iter().position(|known| *known == term) {
            Some(place) => self.of_rates[joint][place].clone(),
            None if term == Friction::Offset => vec![1.0; self.kept.len()],
            None => self.column(joint, term, velocity, sizes),
        }
    }

    /// Filtered torques Y_b pi and those that are known, at the kept samples, by joint.
    pub fn torques(&self, arm: &Arm, pi: &[f64]) -> Vec<Vec<f64>> {
        let n = self.tau.len();
        let full = arm.torque(&self.q, &self.dq, &self.ddq, pi);
        let filtered = |joint: usize| {
            let own: Vec<f64> = full.iter().skip(joint).step_by(n).copied().collect();
            let all = self.filter.both_ways(&own);
            self.kept.iter().zip(self.known.iter().skip(joint).step_by(n)).map(|(&k, known)| all[k] + known).collect()
        };
        (0..n).map(filtered).collect()
    }

    fn column(&self, joint: usize, term: Friction, velocity: f64, sizes: &[f64]) -> Vec<f64> {
        let n = self.tau.len();
        let full: Vec<f64> = (0..self.tau[joint].len())
            .map(|k| {
                let size = sizes.get(k * n + joint).map_or(0.0, |g| g.abs());
                term.column(self.dq[k * n + joint], self.signs[k * n + joint], size, velocity)
            })
            .collect();
        let filtered = self.filter.both_ways(&full);
        self.kept.iter().map(|&k| filtered[k]).collect()
    }
}
