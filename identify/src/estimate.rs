//! The estimation: delays, friction, drive gains, base parameters and their intervals, from filtered pieces of logs.

mod delays;
mod instruments;

pub use delays::From;

use nalgebra::{DMatrix, DVector};

use crate::arm::Arm;
use crate::fit::{covariance, eliminate, solve, solve_fast, Covariance, Equations, Gram, Pattern, Row, Solution, Sums};
use crate::options::Load;
use crate::prepare::{Friction, Piece};

/// A log as its equations need it.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Its session, by its place among the sessions.
    pub session: usize,
    /// Its load.
    pub load: Load,
    /// Whether it holds currents.
    pub is_current: bool,
}

/// What a column of the equations is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// A base parameter.
    Base(usize),
    /// One of the ten of the load of a log.
    Load(usize, usize),
    /// A term of friction of a joint in a session.
    Friction(usize, usize, Friction),
    /// The reciprocal of the correction of a drive gain.
    Gain(usize),
    /// A change of the delay of a joint, s.
    Delay(usize),
}

/// The state of an estimation.
#[derive(Clone, Debug)]
pub struct Estimate<'a> {
    /// The arm.
    pub arm: &'a Arm,
    /// Filtered stretches.
    pub pieces: &'a [Piece],
    /// The same along the reference of the drives, where columns along it are instruments.
    pub along_reference: Option<&'a [Piece]>,
    /// The logs.
    pub runs: &'a [Run],
    /// Number of sessions.
    pub sessions: usize,
    /// All columns.
    pub columns: Vec<Column>,
    /// Columns that are identified.
    pub active: Vec<usize>,
    /// Columns with a given value.
    pub fixed: Vec<(usize, f64)>,
    /// s, by joint.
    pub delays: Vec<f64>,
    /// Whether a delay is unknown, by joint.
    pub seeks_delay: Vec<bool>,
    /// Velocities of Stribeck friction, by joint.
    pub velocities: Vec<f64>,
    /// Drive gains over those that torques were computed with, by joint.
    pub corrections: Vec<f64>,
    /// |g| at the full rate, state by state, by piece.
    pub sizes: Vec<Vec<f64>>,
    /// Values of all columns; 0 of those that are not active or fixed.
    pub x: DVector<f64>,
    /// Weights of the rows.
    pub weights: Vec<f64>,
    /// Robust spread of the residuals, N m or N, by joint.
    pub spreads: Vec<f64>,
}

/// Least improvement, of the root of the mean square, that Stribeck friction must bring.
const WORTH: f64 = 0.99;

/// Blocks of time of the cross-validation.
const FOLDS: usize = 5;

/// The standard error of a sum of parts, from their spread.
pub(crate) fn error_of_sum(parts: &[f64]) -> f64 {
    let n = parts.len() as f64;
    let mean = parts.iter().sum::<f64>() / n;
    (parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>() * n / (n - 1.0)).sqrt()
}

impl<'a> Estimate<'a> {
    /// Starts from nothing: no delay, and the simplest friction.
    pub fn new(arm: &'a Arm, pieces: &'a [Piece], runs: &'a [Run], sessions: usize) -> Estimate<'a> {
        let n = arm.dof();
        let mut columns: Vec<Column> = (0..arm.base.len()).map(Column::Base).collect();
        for (log, _) in runs.iter().enumerate().filter(|(_, run)| run.load.is_there) {
            columns.extend((0..10).map(|k| Column::Load(log, k)));
        }
        for session in 0..sessions {
            for joint in 0..n {
                columns.extend(Friction::ALL.map(|term| Column::Friction(session, joint, term)));
            }
        }
        columns.extend((0..n).map(Column::Gain));
        columns.extend((0..n).map(Column::Delay));
        let x = DVector::zeros(columns.len());
        Estimate {
            arm,
            pieces,
            along_reference: None,
            runs,
            sessions,
            columns,
            active: Vec::new(),
            fixed: Vec::new(),
            delays: vec![0.0; n],
            seeks_delay: vec![false; n],
            velocities: arm.joints.iter().map(|joint| joint.stribeck_velocity).collect(),
            corrections: vec![1.0; n],
            sizes: vec![Vec::new(); pieces.len()],
            x,
            weights: Vec::new(),
            spreads: vec![0.0; n],
        }
    }

    /// Begins with what another estimate found from other rows of the same logs: delays, terms of friction and the values of all columns.
    pub fn begin_with(&mut self, other: &Estimate<'_>) {
        self.active.clone_from(&other.active);
        self.delays.clone_from(&other.delays);
        self.seeks_delay.clone_from(&other.seeks_delay);
        self.velocities.clone_from(&other.velocities);
        self.corrections.clone_from(&other.corrections);
        self.x.clone_from(&other.x);
        self.renew_sizes();
        if self.along_reference.is_some() {
            // Instruments go by weights.
            self.fit_active();
        }
    }

    /// The place of a column.
    pub fn place(&self, column: Column) -> usize {
        self.columns.iter().position(|known| *known == column).expect("a column of the equations")
    }

    /// Chooses the columns that are identified: base parameters, what of loads is unknown and felt, and terms of friction of joints.
    pub fn activate(&mut self, terms: &dyn Fn(usize, Friction) -> bool) {
        let felt = self.felt_of_loads();
        let fixed: Vec<usize> = self.fixed.iter().map(|(place, _)| *place).collect();
        self.active = (0..self.columns.len())
            .filter(|place| !fixed.contains(place))
            .filter(|&place| match self.columns[place] {
                Column::Base(_) => true,
                Column::Load(log, k) => {
                    let load = &self.runs[log].load;
                    let known = match k {
                        0 => load.mass.is_some(),
                        1..=3 => load.mass.is_some() && load.com.is_some(),
                        _ => false,
                    };
                    felt[k] && !known
                }
                Column::Friction(_, joint, term) => terms(joint, term),
                Column::Gain(_) | Column::Delay(_) => false,
            })
            .collect();
    }

    /// Which of the ten of a load the base parameters tell apart, taken in order.
    fn felt_of_loads(&self) -> [bool; 10] {
        let mut basis: Vec<DVector<f64>> = Vec::new();
        std::array::from_fn(|k| {
            let column: DVector<f64> = self.arm.load.column(k).into_owned();
            let size = column.norm();
            let rest = basis.iter().fold(column, |rest, unit| &rest - unit * unit.dot(&rest));
            let felt = rest.norm() > 1e-9 * size.max(1e-9);
            if felt {
                basis.push(rest.normalize());
            }
            felt
        })
    }

    /// What of the load of a log is known, as ten.
    pub fn known_load(&self, log: usize) -> [f64; 10] {
        let load = &self.runs[log].load;
        let mut ten = [0.0; 10];
        if let Some(mass) = load.mass {
            ten[0] = mass;
            for (k, c) in load.com.iter().flatten().enumerate() {
                ten[1 + k] = mass * c;
            }
        }
        ten
    }

    /// The equations, and by row the torque that is known. Columns of load and Stribeck friction take time: those that are neither active nor
    /// fixed are 0, but for a candidate.
    pub fn equations(&self, candidate: Option<Friction>) -> (Equations, Vec<f64>) {
        let (n, base) = (self.arm.dof(), self.arm.base.len());
        let rows = n * self.pieces.iter().map(|piece| piece.kept.len()).sum::<usize>();
        let felt = self.felt();
        let patterns = self.patterns(&felt);
        let of_piece = |piece: &Piece| piece.kept.len() * (0..n).map(|j| patterns[piece.log * n + j].places.len()).sum::<usize>();
        let entries = self.pieces.iter().map(of_piece).sum();
        let mut equations = Equations::new(self.columns.len(), patterns, rows, entries);
        let mut known = Vec::with_capacity(rows);
        for (place, piece) in self.pieces.iter().enumerate() {
            let run = &self.runs[piece.log];
            let tau: Vec<Vec<f64>> = (0..n).map(|j| piece.delayed(j, self.delays[j])).collect();
            let is_wanted = |j: usize, term: Friction| {
                let column = self.place(Column::Friction(run.session, j, term));
                let is_fixed = || self.fixed.iter().any(|(place, value)| *place == column && *value != 0.0);
                let takes_time = matches!(term, Friction::Load | Friction::Stribeck);
                !takes_time || candidate == Some(term) || self.active.contains(&column) || is_fixed()
            };
            let column = |j: usize, term: Friction| {
                is_wanted(j, term).then(|| piece.friction(j, term, self.velocities[j], &self.sizes[place], self.delays[j]))
            };
            let friction: Vec<Option<Vec<f64>>> = (0..n).flat_map(|j| Friction::ALL.map(|term| column(j, term))).collect();
            let known_load = self.known_load(piece.log);
            let fixed: Vec<Vec<(usize, f64)>> = (0..n)
                .map(|j| {
                    let pattern = &equations.patterns[piece.log * n + j];
                    self.fixed.iter().filter_map(|&(place, value)| Some((pattern.entry(place)?, value))).collect()
                })
                .collect();
            for row in 0..piece.kept.len() {
                for j in 0..n {
                    let (felt, counts) = (&felt[j], piece.counts[row * n + j]);
                    let of = Row { joint: j, log: piece.log, time: piece.time(row), counts };
                    let a = equations.push(of, 0.0, piece.log * n + j);
                    let y = &piece.y[(row * n + j) * base..(row * n + j + 1) * base];
                    a.iter_mut().zip(felt).for_each(|(a, &place)| *a = y[place]);
                    let mut next = felt.len();
                    let mut of_load = 0.0;
                    if run.load.is_there {
                        for k in 0..10 {
                            let entry: f64 = y.iter().zip(self.arm.load.column(k).iter()).map(|(y, l)| y * l).sum();
                            a[next + k] = entry;
                            of_load += entry * known_load[k];
                        }
                        next += 10;
                    }
                    for term in 0..6 {
                        a[next + term] = friction[6 * j + term].as_ref().map_or(0.0, |column| column[row]);
                    }
                    let fixed: f64 = fixed[j].iter().map(|(entry, value)| a[*entry] * value).sum();
                    let this = piece.known[row * n + j] + of_load;
                    *equations.b.last_mut().expect("the row") = tau[j][row] * self.corrections[j] - this - fixed;
                    known.push(this);
                }
            }
        }
        (equations, known)
    }

    /// The columns of the rows of each joint in each log, log by log: base parameters that it feels, the load of the log, its friction, gain and delay.
    fn patterns(&self, felt: &[Vec<usize>]) -> Vec<Pattern> {
        let pattern = |log: usize, joint: usize| {
            let run = &self.runs[log];
            let loads = (0..10).filter(|_| run.load.is_there).map(|k| Column::Load(log, k));
            let friction = Friction::ALL.map(|term| Column::Friction(run.session, joint, term));
            let others = loads.chain(friction).chain([Column::Gain(joint), Column::Delay(joint)]);
            Pattern::new(felt[joint].iter().copied().chain(others.map(|column| self.place(column))).collect())
        };
        (0..self.runs.len() * self.arm.dof()).map(|k| pattern(k / self.arm.dof(), k % self.arm.dof())).collect()
    }

    /// The base parameters that each joint feels.
    fn felt(&self) -> Vec<Vec<usize>> {
        let feels = |j: usize, column: &usize| self.pieces.iter().any(|piece| piece.felt[j].contains(column));
        (0..self.arm.dof()).map(|j| (0..self.arm.base.len()).filter(|column| feels(j, column)).collect()).collect()
    }

    /// Base parameters of the arm without load.
    pub fn pi(&self) -> Vec<f64> {
        self.x.as_slice()[..self.arm.base.len()].to_vec()
    }

    /// Renews |g| from the base parameters.
    pub fn renew_sizes(&mut self) {
        for (place, piece) in self.pieces.iter().enumerate() {
            let mut pi = DVector::from_vec(self.pi());
            if self.runs[piece.log].load.is_there {
                let mut ten = DVector::from_row_slice(&self.known_load(piece.log));
                for k in 0..10 {
                    ten[k] += self.x[self.place(Column::Load(piece.log, k))];
                }
                pi += &self.arm.load * ten;
            }
            self.sizes[place] = self.arm.gravity(&piece.q, pi.as_slice());
        }
    }

    /// Robust weights and the solution of the active columns.
    pub fn fit(&mut self, equations: &Equations) -> Gram {
        let sums = Sums::new(equations, &self.active);
        (self.weights, self.spreads) = equations.robust(&sums, self.arm.dof(), &self.weights);
        let gram = sums.gram(&self.weights);
        let x = solve_fast(&gram);
        self.take(&x);
        gram
    }

    /// The same for the active columns.
    pub fn fit_active(&mut self) -> Gram {
        let (equations, _) = self.equations(None);
        self.fit(&equations)
    }

    /// The same with these terms of friction of each joint.
    pub fn fit_terms(&mut self, terms: &[Vec<Friction>]) -> Gram {
        self.activate(&|joint, term| terms[joint].contains(&term));
        self.fit_active()
    }

    /// Takes values of the active columns; the others are 0, or fixed.
    pub(crate) fn take(&mut self, x: &DVector<f64>) {
        self.x.fill(0.0);
        for (&place, value) in self.active.iter().zip(x.iter()) {
            self.x[place] = *value;
        }
        for &(place, value) in &self.fixed {
            self.x[place] = value;
        }
    }

    /// Adds a term of friction to the joints whose residual of cross-validation in blocks of time it lowers; `chosen` has what there is.
    pub fn choose(&mut self, chosen: &mut [Vec<Friction>], candidate: Friction) {
        let n = self.arm.dof();
        let (equations, _) = self.equations(Some(candidate));
        let bounds: Vec<(f64, f64)> = (0..self.runs.len())
            .map(|log| {
                let times = equations.rows.iter().filter(|row| row.log == log).map(|row| row.time);
                times.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)))
            })
            .collect();
        let fold = |k: usize| {
            let row = &equations.rows[k];
            let (start, end) = bounds[row.log];
            ((FOLDS as f64 * (row.time - start) / (end - start).max(1e-9)) as usize).min(FOLDS - 1)
        };
        let fixed: Vec<usize> = self.fixed.iter().map(|(place, _)| *place).collect();
        // Active columns, and all that may come.
        let mut columns = self.active.clone();
        for joint in (0..n).filter(|&joint| !chosen[joint].contains(&candidate)) {
            columns.extend((0..self.sessions).map(|session| self.place(Column::Friction(session, joint, candidate))));
        }
        columns.retain(|place| !fixed.contains(place));
        columns.sort_unstable();
        columns.dedup();
        let sums = Sums::new(&equations, &columns);
        let grams = sums.grams(&self.weights, n * FOLDS, |k| equations.rows[k].joint * FOLDS + fold(k));
        let mut folds = vec![Gram::zero(columns.len()); FOLDS];
        for (class, gram) in grams.iter().enumerate() {
            folds[class % FOLDS].add(gram);
        }
        let mut whole = Gram::zero(columns.len());
        folds.iter().for_each(|gram| whole.add(gram));
        // Of each fold the solution of the others, and what it leaves of a joint.
        let places =
            |active: &[usize]| -> Vec<usize> { active.iter().filter_map(|place| columns.binary_search(place).ok()).collect() };
        let solutions = |places: &[usize]| -> Vec<DVector<f64>> {
            let rest = |fold: &Gram| {
                let mut rest = whole.of(places);
                rest.subtract(&fold.of(places));
                rest
            };
            folds.iter().map(|fold| solve_fast(&rest(fold))).collect()
        };
        let scores = |places: &[usize], solutions: &[DVector<f64>], joint: usize| -> Vec<f64> {
            solutions.iter().enumerate().map(|(f, x)| grams[joint * FOLDS + f].of(places).squares(x)).collect()
        };
        let own = places(&self.active);
        let of_own = solutions(&own);
        let mut taken = self.active.clone();
        for joint in 0..n {
            if chosen[joint].contains(&candidate) {
                continue;
            }
            let mut active = self.active.clone();
            active.extend((0..self.sessions).map(|session| self.place(Column::Friction(session, joint, candidate))));
            active.retain(|place| !fixed.contains(place));
            active.sort_unstable();
            if active.len() == self.active.len() {
                continue;
            }
            let with = places(&active);
            let (before, after) = (scores(&own, &of_own, joint), scores(&with, &solutions(&with), joint));
            let gains: Vec<f64> = before.iter().zip(&after).map(|(before, after)| before - after).collect();
            let (gain, all) = (gains.iter().sum::<f64>(), before.iter().sum::<f64>());
            let wanted = match candidate {
                // Where the sign of a rate is smoothed there is a little of such a term.
                Friction::Stribeck => ((1.0 - WORTH * WORTH) * all).max(error_of_sum(&gains)),
                _ => 0.0,
            };
            if gain > wanted {
                chosen[joint].push(candidate);
                taken.extend(active);
            }
        }
        taken.sort_unstable();
        taken.dedup();
        self.active = taken;
    }

    /// Takes back, the least significant first, those of the terms that are smaller than their three-sigma interval, or brake negatively. Without
    /// one the others are those of the same weights.
    pub fn prune(&mut self, chosen: &mut [Vec<Friction>], terms: &[Friction]) {
        let n = self.arm.dof();
        let (_, Solution { mut x, mut inverse, .. }, mut covariance) = self.finish();
        let mut left = covariance.columns.len();
        loop {
            let significance = |(k, &place): (usize, &usize)| match self.columns[place] {
                Column::Friction(session, joint, term)
                    if session + 1 == self.sessions && terms.contains(&term) && chosen[joint].contains(&term) =>
                {
                    let sigma = covariance.matrix[(k, k)].max(0.0).sqrt();
                    let value = if term.is_not_negative() { x[k] } else { x[k].abs() };
                    Some((value / (covariance.reach * sigma).max(f64::MIN_POSITIVE), joint, term))
                }
                _ => None,
            };
            let least = self.active.iter().enumerate().filter_map(significance).min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, joint, term)) = least.filter(|(ratio, ..)| *ratio < 1.0) else { break };
            chosen[joint].retain(|chosen| *chosen != term);
            let is_gone = |place: &usize| match self.columns[*place] {
                Column::Friction(_, of, other) => (of, other) == (joint, term),
                // That of the velocity.
                Column::Gain(of) => of == joint && term == Friction::Stribeck,
                _ => false,
            };
            let gone: Vec<usize> = covariance.columns.iter().copied().filter(is_gone).collect();
            for (k, _) in self.active.iter().enumerate().filter(|(_, place)| gone.contains(place)) {
                eliminate(&mut inverse, &mut x, k);
            }
            left -= gone.len();
            covariance.without(&gone, left, n);
        }
        self.activate(&|joint, term| chosen[joint].contains(&term));
    }

    /// The velocities of Stribeck friction of some joints. False: that of the joint is at an end of those that the log shows, and stays.
    pub fn stribeck_velocities(&mut self, is_wanted: &dyn Fn(usize) -> bool) -> Vec<bool> {
        let (equations, _) = self.equations(None);
        let residuals = equations.residuals(&self.active, &DVector::from_fn(self.active.len(), |k, _| self.x[self.active[k]]));
        (0..self.arm.dof()).map(|joint| is_wanted(joint) && self.stribeck_velocity(joint, &equations, &residuals)).collect()
    }

    /// The velocity of Stribeck friction of a joint with the least residual, among those that the log shows: from where the sign of the rate is
    /// certain to half of the highest rate.
    fn stribeck_velocity(&mut self, joint: usize, equations: &Equations, residuals: &[f64]) -> bool {
        let n = self.arm.dof();
        let of: Vec<usize> = (0..residuals.len()).filter(|&k| equations.rows[k].joint == joint).collect();
        // Friction is that of a session, the velocity that of all.
        let sessions = 1 + self.runs.iter().map(|run| run.session).max().unwrap_or(0);
        let firsts: Vec<usize> =
            (0..sessions).map(|session| self.place(Column::Friction(session, joint, Friction::Viscous))).collect();
        let has_cubic = self.active.contains(&(firsts[0] + Friction::Cubic as usize));
        let cost = |log: f64| {
            let mut column = Vec::new();
            for (piece, sizes) in self.pieces.iter().zip(&self.sizes) {
                column.extend(piece.friction(joint, Friction::Stribeck, log.exp(), sizes, self.delays[joint]));
            }
            let patterns = (0..sessions).map(|session| Pattern::new((5 * session..5 * session + 5).collect())).collect();
            let mut small = Equations::new(5 * sessions, patterns, of.len(), 5 * of.len());
            let mut weights = Vec::new();
            for (&k, stribeck) in of.iter().zip(&column) {
                let session = self.runs[equations.rows[k].log].session;
                let first = firsts[session];
                let cubic = if has_cubic { equations.at(k, first + Friction::Cubic as usize) } else { 0.0 };
                let row = [equations.at(k, first), equations.at(k, first + 1), 1.0, *stribeck, cubic];
                small.push(equations.rows[k], residuals[k], session).copy_from_slice(&row);
                weights.push(self.weights[k]);
            }
            let gram = small.gram(&weights);
            gram.squares(&solve_fast(&gram))
        };
        let fastest =
            self.pieces.iter().flat_map(|piece| piece.dq.iter().skip(joint).step_by(n)).fold(0.0f64, |a, dq| a.max(dq.abs()));
        let certain = self.pieces.iter().fold(0.0f64, |most, piece| most.max(3.0 * piece.eps[joint]));
        let (from, to) = (certain.ln(), (0.5 * fastest).min(1.0).ln());
        if from + 0.5 > to {
            return false;
        }
        let grid: Vec<f64> = (0..=8).map(|k| from + (to - from) * f64::from(k) / 8.0).collect();
        let costs: Vec<f64> = grid.iter().map(|&log| cost(log)).collect();
        let best = (0..grid.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).expect("a grid");
        if best == 0 || best + 1 == grid.len() {
            return false;
        }
        let ratio = 0.5 * (5f64.sqrt() - 1.0);
        let (mut low, mut high) = (grid[best - 1], grid[best + 1]);
        let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
        let (mut cost_a, mut cost_b) = (cost(a), cost(b));
        for _ in 0..8 {
            if cost_a < cost_b {
                (high, b, cost_b) = (b, a, cost_a);
                a = high - ratio * (high - low);
                cost_a = cost(a);
            } else {
                (low, a, cost_a) = (a, b, cost_b);
                b = low + ratio * (high - low);
                cost_b = cost(b);
            }
        }
        self.velocities[joint] = (0.5 * (low + high)).exp();
        true
    }

    /// The solution with intervals, for the columns that are active.
    pub fn finish(&mut self) -> (Equations, Solution, Covariance) {
        let n = self.arm.dof();
        let (mut equations, _) = self.equations_with_delays(true);
        let mut gram = self.fit(&equations);
        // The intervals allow for delays.
        let all = self.with_delays();
        let own = std::mem::replace(&mut self.active, all);
        let projected = self.with_instruments(&mut equations);
        self.active = own;
        if let Some(projected) = &projected {
            // Weights are those of the residuals behind the instruments.
            for _ in 0..2 {
                gram = Sums::new(projected, &self.active).gram(&self.weights);
                (self.weights, self.spreads) = equations.weights(&equations.residuals(&self.active, &solve_fast(&gram)), n);
            }
            gram = Sums::new(projected, &self.active).gram(&self.weights);
        }
        let mut start = DVector::zeros(self.active.len());
        let nominal = &self.arm.combination * self.arm.nominal();
        for (k, &place) in self.active.iter().enumerate() {
            if let Column::Base(base) = self.columns[place] {
                start[k] = nominal[base];
            }
        }
        let solution = solve(&gram, &start);
        self.take(&solution.x);
        let residuals = equations.residuals(&self.active, &solution.x);
        let equations = projected.unwrap_or(equations);
        let covariance = self.covariance(&equations, &residuals, &solution, n);
        (equations, solution, covariance)
    }

    /// The covariance of the active columns. Delays and velocities of Stribeck friction were found from the logs, too: their columns are part of
    /// it.
    fn covariance(&self, equations: &Equations, residuals: &[f64], solution: &Solution, n: usize) -> Covariance {
        let step = 1e-3;
        let of_stribeck = |&place: &usize| match self.columns[place] {
            Column::Friction(session, joint, Friction::Stribeck) => Some((place, session, joint)),
            _ => None,
        };
        let stribeck: Vec<(usize, usize, usize)> = self.active.iter().filter_map(of_stribeck).collect();
        let mut active = self.with_delays();
        if stribeck.is_empty() && active.len() == self.active.len() {
            return covariance(equations, &self.active, residuals, &self.weights, &solution.inverse, n);
        }
        let mut extended = equations.clone();
        for (place, session, joint) in stribeck {
            // Columns of gains are empty where no gain is found.
            let slope = self.place(Column::Gain(joint));
            let column = |velocity: f64| -> Vec<f64> {
                let pieces = self.pieces.iter().zip(&self.sizes);
                pieces
                    .flat_map(|(piece, sizes)| piece.friction(joint, Friction::Stribeck, velocity, sizes, self.delays[joint]))
                    .collect()
            };
            let velocity = self.velocities[joint];
            let difference = column(velocity * (1.0 + step)).into_iter().zip(column(velocity)).map(|(a, b)| (a - b) / step);
            let rows = (0..extended.rows.len()).filter(|&k| equations.rows[k].joint == joint);
            for (k, difference) in rows.zip(difference).collect::<Vec<_>>() {
                if self.runs[equations.rows[k].log].session == session {
                    *extended.at_mut(k, slope) += self.x[place] * difference;
                }
            }
            active.extend((!active.contains(&slope)).then_some(slope));
        }
        let gram = Sums::new(&extended, &active).gram(&self.weights);
        let whole = solve(&gram, &DVector::zeros(active.len()));
        covariance(&extended, &active, residuals, &self.weights, &whole.inverse, n)
    }

    /// Drive gains by maximum likelihood in the currents: Gauss-Newton in (1/K, pi, f), noise on the currents.
    ///
    /// The torque of the drive with the gain at hand is `b`; `b = (Y pi + known)/c + F f'` with the correction c and `f = c f'`. The result are the
    /// corrections with sigmas, and the covariance of the active columns with friction scaled back.
    pub fn gains(&mut self, held: &[bool]) -> (Vec<f64>, Vec<f64>, DMatrix<f64>, f64) {
        let n = self.arm.dof();
        // From the corrections at hand.
        let mut reciprocal: Vec<f64> = (0..n).map(|j| if held[j] { 1.0 } else { 1.0 / self.corrections[j] }).collect();
        self.corrections = vec![1.0; n];
        let (mut equations, known) = self.equations(None);
        let fixed: Vec<f64> = (0..equations.b.len()).map(equations.product(&self.fixed)).collect();
        // The torque as it is measured, and friction of given values, which is no part of the scaled torque.
        let measured: Vec<f64> = (0..equations.b.len()).map(|k| equations.b[k] + known[k]).collect();
        let is_dynamic = |column: Column| matches!(column, Column::Base(_) | Column::Load(..));
        let mut active = self.active.clone();
        active.extend((0..n).filter(|&j| !held[j]).map(|j| self.place(Column::Gain(j))));
        let plain = equations.clone();
        let start = |&place: &usize| match self.columns[place] {
            Column::Friction(_, j, _) => self.x[place] * reciprocal[j],
            _ => self.x[place],
        };
        let mut x = DVector::from_iterator(self.active.len(), self.active.iter().map(start));
        let mut inverse = DMatrix::zeros(0, 0);
        let mut residuals = vec![0.0; equations.b.len()];
        let mut spreads = self.spreads.clone();
        for round in 0..25 {
            for k in 0..equations.b.len() {
                let j = equations.rows[k].joint;
                let (mut dynamic, mut friction) = (known[k], fixed[k]);
                for (&place, value) in self.active.iter().zip(x.iter()) {
                    let Some(entry) = plain.pattern(k).entry(place) else { continue };
                    let a = plain.row(k)[entry];
                    if is_dynamic(self.columns[place]) {
                        dynamic += a * value;
                        *equations.at_mut(k, place) = a * reciprocal[j];
                    } else {
                        friction += a * value;
                    }
                }
                residuals[k] = measured[k] + fixed[k] - dynamic * reciprocal[j] - friction;
                *equations.at_mut(k, self.place(Column::Gain(j))) = dynamic;
            }
            equations.b.clone_from(&residuals);
            if round < 6 {
                (self.weights, spreads) = equations.weights(&residuals, n);
            }
            let gram = Sums::new(&equations, &active).gram(&self.weights);
            let solution = solve(&gram, &DVector::zeros(active.len()));
            inverse = solution.inverse;
            let mut step = solution.x;
            // A reciprocal stays positive.
            for (place, j) in (0..n).filter(|&j| !held[j]).enumerate() {
                let delta = step[self.active.len() + place];
                if reciprocal[j] + delta < 0.2 * reciprocal[j] {
                    step *= 0.8 * reciprocal[j] / -delta;
                }
            }
            let mut largest = 0.0f64;
            for k in 0..self.active.len() {
                x[k] += step[k];
            }
            for (place, j) in (0..n).filter(|&j| !held[j]).enumerate() {
                let delta = step[self.active.len() + place];
                reciprocal[j] += delta;
                largest = largest.max((delta / reciprocal[j]).abs());
            }
            if largest < 1e-9 && round >= 6 {
                break;
            }
        }
        let found = covariance(&equations, &active, &residuals, &self.weights, &inverse, n);
        // From (x', 1/c) to (x, c): friction is c f'.
        let mut jacobian = DMatrix::zeros(active.len(), active.len());
        let corrections: Vec<f64> = reciprocal.iter().map(|r| 1.0 / r).collect();
        let free: Vec<usize> = (0..n).filter(|&j| !held[j]).collect();
        for (k, &place) in active.iter().enumerate() {
            jacobian[(k, k)] = 1.0;
            match self.columns[place] {
                Column::Friction(_, j, _) => {
                    jacobian[(k, k)] = corrections[j];
                    if let Some(gain) = free.iter().position(|&other| other == j) {
                        jacobian[(k, self.active.len() + gain)] = -x[k] * corrections[j] * corrections[j];
                    }
                    x[k] *= corrections[j];
                }
                Column::Gain(j) => jacobian[(k, k)] = -corrections[j] * corrections[j],
                _ => {}
            }
        }
        let matrix = &jacobian * found.matrix * jacobian.transpose();
        let mut sigmas = vec![0.0; n];
        for (place, &j) in free.iter().enumerate() {
            let k = self.active.len() + place;
            sigmas[j] = matrix[(k, k)].max(0.0).sqrt();
        }
        self.spreads = spreads.iter().zip(&corrections).map(|(s, c)| s * c).collect();
        self.take(&x);
        self.corrections.clone_from(&corrections);
        let of_x = matrix.view((0, 0), (self.active.len(), self.active.len())).into_owned();
        (corrections, sigmas, of_x, found.reach)
    }
}
