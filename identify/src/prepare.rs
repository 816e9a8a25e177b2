//! From a log to filtered rows: the model's columns and the torques go through one low pass.
//!
//! Positions and rates are smoothed wide, accelerations are central differences of rates. Columns are computed from these at the full rate, then
//! they and the torques pass the same zero-phase low pass, and every few samples are kept. A filter that both sides pass changes no parameter.

use std::ops::Range;

use crate::arm::Arm;
use crate::log::Log;
use crate::signal::{interpolate, noise, period, pieces, shifted, slopes, LowPass, NOISE_OF_SLOPES};

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

    /// Whether it jumps where the rate changes its sign.
    pub fn is_dry(self) -> bool {
        matches!(self, Friction::Coulomb | Friction::Load | Friction::Stribeck)
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
    /// Its columns that are not 0 throughout, by joint.
    pub felt: Vec<Vec<usize>>,
    /// Filtered known torques of the kept samples, state by state.
    pub known: Vec<f64>,
    /// Whether a row counts, by kept sample and joint.
    pub counts: Vec<bool>,
    /// Rates below this may be noise, by joint.
    pub eps: Vec<f64>,
    /// Standard deviations of the noise of rates, by joint.
    noises: Vec<f64>,
    /// The low pass.
    pub filter: LowPass,
    /// Filtered columns of friction that depend on rates alone, by joint, in the order of [`OF_RATES`].
    of_rates: Vec<Vec<Vec<f64>>>,
    /// Whether it has some of the samples of another piece, too few to be filtered.
    is_part: bool,
}

/// Terms that depend on rates alone; Stribeck friction has a velocity, too, and is there only in a part of a piece.
const OF_RATES: [Friction; 4] = [Friction::Viscous, Friction::Coulomb, Friction::Cubic, Friction::Stribeck];

/// Columns that are filtered side by side.
const TOGETHER: usize = 4;

/// Samples of a stretch that are filtered at once.
const LONGEST: usize = 16_384;

/// Rates below this may be noise in any log, rad/s or m/s.
const LEAST_EPS: f64 = 0.003;

/// The width of a smooth sign over the standard deviation of the noise of its rate.
const WIDTH: f64 = 3.0;

/// A rate passes 0 swiftly where it is hidden by its noise for less than this part of the period of the cutoff.
const SWIFT: f64 = 0.3;

/// Where the sign of a rate is not known, rows do not count for this part of the period of the cutoff before and behind, either.
const AROUND: f64 = 0.5;

/// Rates below this part of the highest may be what a filter leaves of rest; where noise hides rates above the other part, too much would be left out.
const HIDDEN: [f64; 2] = [1e-4, 0.02];

/// How long a rate keeps its sign where friction at low rates counts, s.
const STEADY: f64 = 0.1;

/// The stretches of a log on grids of its median period. `flawed` are stretches of time with torques that do not count, by joint. Without
/// `columns` there is no filtered Y_b. With `every` above 1 they are short, and one of so many.
pub fn prepare(
    arm: &Arm,
    place: usize,
    log: &Log,
    cutoff: f64,
    flawed: &[Vec<Range<f64>>],
    columns: bool,
    every: usize,
) -> Vec<Piece> {
    let period = period(&log.t);
    let rate = 1.0 / period;
    let margin = (4.0 / cutoff * rate).ceil() as usize;
    // Short ones are twice as long as what the filter takes from their ends.
    let longest = if every > 1 { 4 * margin } else { LONGEST };
    let mut all = Vec::new();
    for range in pieces(&log.t, period) {
        let (t, span) = (&log.t[range.clone()], log.t[range.end - 1] - log.t[range.start]);
        let samples = (span / period + 1.0 + 1e-6).floor() as usize;
        let mut first = 0;
        while first + 2 * margin + 4 < samples {
            let last = (first + longest + 2 * margin).min(samples);
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
            first += every * longest;
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
    let (mut eps, mut noises, mut unsure) = (Vec::new(), Vec::new(), Vec::new());
    let mut steady = vec![false; n * samples];
    for i in 0..n {
        let position = on_grid(&log.q[i]);
        let (rough, noise) = match &log.dq {
            Some(rates) => {
                let rates = on_grid(&rates[i]);
                let noise = noise(&rates);
                (rates, noise)
            }
            None => (slopes(&position, period), NOISE_OF_SLOPES / period * noise(&position)),
        };
        let noise = noise * (2.0 * wide_cutoff / rate).sqrt().min(1.0);
        eps.push((WIDTH * noise).max(LEAST_EPS));
        noises.push(noise);
        let (smooth, rates) = (wide.both_ways(&position), wide.both_ways(&rough));
        let accelerations = slopes(&rates, period);
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
        unsure.push(unsure_signs(&rates, noise, (SWIFT / cutoff * rate) as usize));
    }
    let tau: Vec<Vec<f64>> = log.effort.iter().map(|tau| filter.both_ways(&on_grid(tau))).collect();
    let step = ((rate / (5.0 * cutoff)).round() as usize).max(1);
    let kept: Vec<usize> = (margin..samples.saturating_sub(margin)).step_by(step).collect();
    let around = (AROUND / cutoff * rate) as usize;
    let counts = kept
        .iter()
        .flat_map(|&k| (0..n).map(move |i| (k, i)))
        .map(|(k, i)| {
            let moves = dq[k * n + i].abs() > 3.0 * eps[i] || (steady[k * n + i] && dq[k * n + i].abs() > 1e-9);
            let is_sure = unsure[i].iter().all(|stretch| k + around < stretch.start || stretch.end + around <= k);
            moves && is_sure && !flawed.get(i).is_some_and(|flawed| flawed.iter().any(|stretch| stretch.contains(&grid[k])))
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
    let start = grid[0];
    let mut piece = Piece {
        log: place,
        period,
        start,
        q,
        dq,
        ddq,
        tau,
        kept,
        felt: felt(arm, &y),
        y,
        known,
        counts,
        eps,
        noises,
        filter,
        of_rates: Vec::new(),
        is_part: false,
    };
    piece.of_rates = (0..n).map(|i| OF_RATES[..3].iter().map(|term| piece.column(i, *term, 1.0, &[], 0.0)).collect()).collect();
    piece
}

/// Columns of Y_b that are not 0 throughout, by joint.
fn felt(arm: &Arm, y: &[f64]) -> Vec<Vec<usize>> {
    let (n, base) = (arm.dof(), arm.base.len());
    let mut is_felt = vec![false; n * base];
    y.chunks_exact(n * base).for_each(|row| is_felt.iter_mut().zip(row).for_each(|(felt, y)| *felt |= *y != 0.0));
    (0..n).map(|j| (0..base).filter(|column| is_felt[j * base + column]).collect()).collect()
}

/// Stretches of samples at which the sign of a rate is not known: those below its noise, but for those at which it passes 0 within so many
/// samples. Without noise only a rate of 0 has no sign.
fn unsure_signs(rates: &[f64], noise: f64, swift: usize) -> Vec<Range<usize>> {
    let fastest = rates.iter().fold(0.0f64, |fastest, rate| fastest.max(rate.abs()));
    let [rest, most] = HIDDEN.map(|part| part * fastest);
    let below = rest.max(WIDTH * noise);
    if below > most {
        return Vec::new();
    }
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for k in (0..rates.len()).filter(|&k| rates[k].abs() < below) {
        match stretches.last_mut().filter(|last| last.end == k) {
            Some(last) => last.end = k + 1,
            None => stretches.push(k..k + 1),
        }
    }
    let passes = |of: &Range<usize>| {
        let turns = of.start > 0 && of.end < rates.len() && rates[of.start - 1] * rates[of.end] < 0.0;
        let has_zero = below == rest && rates[of.clone()].iter().any(|rate| rate.abs() < 0.05 * rest);
        turns && of.len() <= swift.max(1) && !has_zero
    };
    stretches.retain(|of| !passes(of));
    stretches
}

/// The sign of a rate with noise, smooth within eps = 3 noise.
///
/// tanh u + k u sech² u with u = dq/eps. The first term alone lacks eps ln 2 of the integral of a sign on either side of 0, which seems to be
/// less Coulomb friction, and more Stribeck friction. With k the mean over the noise has the whole integral, and a reversal is short before
/// the low pass. For noise n, E[eps ln cosh(n/eps)] and the like are n²/(2 eps).
fn smooth_sign(dq: f64, noise: f64) -> f64 {
    let (u, part) = (dq / (WIDTH * noise).max(f64::MIN_POSITIVE), 0.5 / (WIDTH * WIDTH));
    let k = (std::f64::consts::LN_2 + part) / (std::f64::consts::LN_2 - part);
    // Beyond, tanh is 1 to all digits.
    if u.abs() > 20.0 {
        return u.signum();
    }
    let t = u.tanh();
    t + k * u * (1.0 - t * t)
}

impl Piece {
    /// Every few of the kept samples. `delays` are taken out, and Stribeck friction has `velocities`. Y_b and what is known are left out: only
    /// [`exchanged`](Self::exchanged) has them.
    pub fn part(&self, delays: &[f64], velocities: &[f64], step: usize) -> Piece {
        let n = delays.len();
        let rows: Vec<usize> = (0..self.kept.len()).step_by(step).collect();
        let of_states =
            |x: &[f64]| rows.iter().flat_map(|&row| x[self.kept[row] * n..][..n].iter().copied()).collect::<Vec<f64>>();
        let some = |column: Vec<f64>| rows.iter().map(|&row| column[row]).collect::<Vec<f64>>();
        let of_rates = |j: usize| OF_RATES.map(|term| some(self.friction(j, term, velocities[j], &[], delays[j]))).to_vec();
        let spacing = if rows.len() > 1 { self.kept[rows[1]] - self.kept[rows[0]] } else { step };
        Piece {
            log: self.log,
            period: self.period * spacing as f64,
            start: self.time(0),
            q: of_states(&self.q),
            dq: of_states(&self.dq),
            ddq: of_states(&self.ddq),
            tau: (0..n).map(|j| some(self.delayed(j, delays[j]))).collect(),
            kept: (0..rows.len()).collect(),
            felt: Vec::new(),
            y: Vec::new(),
            known: Vec::new(),
            counts: rows.iter().flat_map(|&row| self.counts[row * n..(row + 1) * n].iter().copied()).collect(),
            eps: self.eps.clone(),
            noises: self.noises.clone(),
            filter: self.filter.clone(),
            of_rates: (0..n).map(of_rates).collect(),
            is_part: true,
        }
    }

    /// A [`part`](Self::part) as it would be with the states under other joints and signs: joint j has the states of `order[j]` times a sign, and
    /// the torque of `torques[j]` times a scale. Y is not filtered.
    pub fn exchanged(&self, arm: &Arm, order: &[(usize, f64)], torques: &[(usize, f64)]) -> Piece {
        let n = order.len();
        let of_states = |x: &[f64]| -> Vec<f64> {
            x.chunks_exact(n).flat_map(|state| order.iter().map(|&(j, sign)| sign * state[j])).collect()
        };
        let (q, dq, ddq) = (of_states(&self.q), of_states(&self.dq), of_states(&self.ddq));
        let times = |column: &Vec<f64>, factor: f64| column.iter().map(|x| factor * x).collect::<Vec<f64>>();
        // All of these are odd functions of the rate.
        let of_rates = |&(j, sign): &(usize, f64)| self.of_rates[j].iter().map(|column| times(column, sign)).collect();
        let y = arm.regressor(&q, &dq, &ddq);
        Piece {
            tau: torques.iter().map(|&(j, scale)| times(&self.tau[j], scale)).collect(),
            kept: self.kept.clone(),
            felt: felt(arm, &y),
            y,
            known: arm.known(&q, &dq, &ddq),
            counts: self.counts.chunks_exact(n).flat_map(|counts| order.iter().map(|&(j, _)| counts[j])).collect(),
            eps: order.iter().map(|&(j, _)| self.eps[j]).collect(),
            noises: order.iter().map(|&(j, _)| self.noises[j]).collect(),
            filter: self.filter.clone(),
            of_rates: order.iter().map(of_rates).collect(),
            q,
            dq,
            ddq,
            ..*self
        }
    }

    /// The stamp of a kept sample, s.
    pub fn time(&self, row: usize) -> f64 {
        self.start + self.kept[row] as f64 * self.period
    }

    /// Filtered torque of a joint at the kept samples, of a time later by a delay.
    pub fn delayed(&self, joint: usize, delay: f64) -> Vec<f64> {
        shifted(&self.tau[joint], self.kept.iter().copied(), delay / self.period)
    }

    /// The sign of a rate of a joint, smooth within its noise.
    pub fn sign(&self, joint: usize, dq: f64) -> f64 {
        smooth_sign(dq, self.noises[joint])
    }

    /// A filtered column of a joint at the kept samples. `sizes` has g state by state, and is used by load friction.
    ///
    /// With a delay, the column that belongs to [`delayed`](Self::delayed) torques: a sampled torque has the sign of the rate that was there a
    /// delay before the sample. Between samples that is no shift of a sampled sign.
    pub fn friction(&self, joint: usize, term: Friction, velocity: f64, sizes: &[f64], delay: f64) -> Vec<f64> {
        let known = OF_RATES.iter().position(|known| *known == term).and_then(|place| self.of_rates[joint].get(place));
        match known {
            Some(column) if !term.is_dry() || delay == 0.0 => column.clone(),
            _ if term == Friction::Offset => vec![1.0; self.kept.len()],
            // g changes little while the filter responds.
            _ if self.is_part => {
                let signs = self.of_rates[joint][1].iter().enumerate();
                signs.map(|(row, sign)| sign * sizes.get(row * self.tau.len() + joint).map_or(0.0, |g| g.abs())).collect()
            }
            _ => self.column(joint, term, velocity, sizes, delay),
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

    fn column(&self, joint: usize, term: Friction, velocity: f64, sizes: &[f64], delay: f64) -> Vec<f64> {
        let [column] = self.columns(joint, term, velocity, sizes, [delay]);
        column
    }

    /// [`friction`](Self::friction) of dry terms with delays, side by side.
    pub fn columns<const L: usize>(
        &self,
        joint: usize,
        term: Friction,
        velocity: f64,
        sizes: &[f64],
        delays: [f64; L],
    ) -> [Vec<f64>; L] {
        let n = self.tau.len();
        let of_joint = |states: &[f64]| states.iter().skip(joint).step_by(n).copied().collect::<Vec<f64>>();
        let (rates, sizes) = (of_joint(&self.dq), of_joint(sizes));
        let by = delays.map(|delay| delay / self.period);
        let mut signals = vec![[0.0; L]; rates.len()];
        for (i, &by) in by.iter().enumerate() {
            let before = |x: &[f64]| if by == 0.0 { x.to_vec() } else { shifted(x, 0..x.len(), -by) };
            let (rates, sizes) = (before(&rates), before(&sizes));
            for (k, (signal, dq)) in signals.iter_mut().zip(rates).enumerate() {
                let size = sizes.get(k).map_or(0.0, |g| g.abs());
                signal[i] = term.column(dq, self.sign(joint, dq), size, velocity);
            }
        }
        let filtered = self.filter.side_by_side(&signals);
        let mut columns = by.iter().enumerate();
        std::array::from_fn(|_| {
            let (i, &by) = columns.next().expect("a delay");
            let own: Vec<f64> = filtered.iter().map(|x| x[i]).collect();
            shifted(&own, self.kept.iter().copied(), by)
        })
    }
}
