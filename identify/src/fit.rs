//! Weighted least squares on rows of joints: Gram matrices, robust weights, standard errors that hold for coloured residuals.

mod sums;

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::signal::{rms, spread};

pub use sums::Sums;

/// A row of the equations: a joint at a time.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The joint.
    pub joint: usize,
    /// The log.
    pub log: usize,
    /// The stamp, s.
    pub time: f64,
    /// Whether it counts.
    pub counts: bool,
}

/// The columns that rows of a kind have; all others are 0 in them.
#[derive(Clone, Debug, Default)]
pub struct Pattern {
    /// The columns.
    pub places: Vec<usize>,
    /// The entry of each column in such a row; none beyond the last and where it is 0.
    entries: Vec<Option<usize>>,
}

impl Pattern {
    /// Of these columns.
    pub fn new(places: Vec<usize>) -> Pattern {
        let mut entries = vec![None; places.iter().max().map_or(0, |last| last + 1)];
        places.iter().enumerate().for_each(|(entry, &place)| entries[place] = Some(entry));
        Pattern { places, entries }
    }

    /// The entry of a column.
    pub fn entry(&self, place: usize) -> Option<usize> {
        self.entries.get(place).copied().flatten()
    }
}

/// Equations A x = b, row by row. A joint feels a part of the columns, and only these are kept: most of A is 0.
#[derive(Clone, Debug, Default)]
pub struct Equations {
    /// Columns.
    pub columns: usize,
    /// Patterns of rows.
    pub patterns: Vec<Pattern>,
    /// The pattern of each row, and the place of its first entry.
    starts: Vec<(usize, usize)>,
    /// The entries of A, row by row.
    a: Vec<f64>,
    /// b.
    pub b: Vec<f64>,
    /// Where the rows come from; those of one log in the order of time.
    pub rows: Vec<Row>,
}

/// A'WA, A'Wb, b'Wb.
#[derive(Clone, Debug, Default)]
pub struct Gram {
    /// A'WA.
    pub h: DMatrix<f64>,
    /// A'Wb.
    pub g: DVector<f64>,
    /// b'Wb.
    pub bb: f64,
}

impl Gram {
    /// Nothing yet.
    pub fn zero(columns: usize) -> Gram {
        Gram { h: DMatrix::zeros(columns, columns), g: DVector::zeros(columns), bb: 0.0 }
    }

    /// The sum.
    pub fn add(&mut self, other: &Gram) {
        self.h += &other.h;
        self.g += &other.g;
        self.bb += other.bb;
    }

    /// The difference.
    pub fn subtract(&mut self, other: &Gram) {
        self.h -= &other.h;
        self.g -= &other.g;
        self.bb -= other.bb;
    }

    /// The part of some columns.
    pub fn of(&self, active: &[usize]) -> Gram {
        Gram {
            h: DMatrix::from_fn(active.len(), active.len(), |i, j| self.h[(active[i], active[j])]),
            g: DVector::from_fn(active.len(), |i, _| self.g[active[i]]),
            bb: self.bb,
        }
    }

    /// Sum of squares of the weighted residuals of x.
    pub fn squares(&self, x: &DVector<f64>) -> f64 {
        (self.bb - 2.0 * self.g.dot(x) + x.dot(&(&self.h * x))).max(0.0)
    }
}

/// Directions of the scaled equations, and their inverse without those that the rows do not show.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The least squares solution; along directions not shown, `start`.
    pub x: DVector<f64>,
    /// The pseudo-inverse of A'WA over the directions that are shown.
    pub inverse: DMatrix<f64>,
    /// Largest over least singular value of the scaled W^(1/2) A, those not shown included.
    pub condition: f64,
    /// Mean of the logarithms of the eigenvalues of the scaled A'WA that are shown.
    pub log_det_per_column: f64,
    /// Directions that are not shown, as unit vectors over scaled columns.
    pub hidden: Vec<DVector<f64>>,
}

/// Directions with singular values below the largest over this are not shown.
pub const LARGEST_CONDITION: f64 = 1e6;

/// Solves, with directions that are not shown left at `start`.
pub fn solve(gram: &Gram, start: &DVector<f64>) -> Solution {
    let n = gram.g.len();
    let scale = DVector::from_fn(n, |i, _| if gram.h[(i, i)] > 0.0 { 1.0 / gram.h[(i, i)].sqrt() } else { 0.0 });
    let scaled = DMatrix::from_fn(n, n, |i, j| gram.h[(i, j)] * scale[i] * scale[j]);
    let eigen = SymmetricEigen::new(scaled);
    let largest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let least = eigen.eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
    let shown = |i: usize| eigen.eigenvalues[i] > largest / (LARGEST_CONDITION * LARGEST_CONDITION);
    let mut inverse = DMatrix::zeros(n, n);
    let mut hidden = Vec::new();
    let (mut logs, mut count) = (0.0, 0);
    for i in 0..n {
        let direction = eigen.eigenvectors.column(i);
        if shown(i) {
            let scaled = direction.component_mul(&scale);
            inverse.ger(1.0 / eigen.eigenvalues[i], &scaled, &scaled, 1.0);
            logs += eigen.eigenvalues[i].ln();
            count += 1;
        } else {
            hidden.push(direction.into_owned());
        }
    }
    let mut x = start + &inverse * (&gram.g - &gram.h * start);
    // One step of refinement: the columns differ by many powers of ten.
    x += &inverse * (&gram.g - &gram.h * &x);
    Solution {
        x,
        inverse,
        condition: (largest / least.max(0.0)).sqrt(),
        log_det_per_column: logs / f64::from(count.max(1)),
        hidden,
    }
}

/// Solves fast, for comparisons: directions that are not shown are damped.
pub fn solve_fast(gram: &Gram) -> DVector<f64> {
    let n = gram.g.len();
    let scale = DVector::from_fn(n, |i, _| if gram.h[(i, i)] > 0.0 { 1.0 / gram.h[(i, i)].sqrt() } else { 0.0 });
    let mut scaled = DMatrix::from_fn(n, n, |i, j| gram.h[(i, j)] * scale[i] * scale[j]);
    (0..n).for_each(|i| scaled[(i, i)] += 1e-11);
    let g = gram.g.component_mul(&scale);
    match scaled.cholesky() {
        Some(factor) => factor.solve(&g).component_mul(&scale),
        None => DVector::zeros(n),
    }
}

/// The least spread of residuals over the torque of a joint. Its reciprocal is below [`LARGEST_CONDITION`].
const LEAST_SPREAD: f64 = 1e-5;

impl Equations {
    /// No row yet, with room for some whose columns all patterns together have.
    pub fn new(columns: usize, patterns: Vec<Pattern>, rows: usize, entries: usize) -> Equations {
        Equations {
            columns,
            patterns,
            starts: Vec::with_capacity(rows),
            a: Vec::with_capacity(entries),
            b: Vec::with_capacity(rows),
            rows: Vec::with_capacity(rows),
        }
    }

    /// Of all columns, row by row.
    pub fn dense(columns: usize, a: Vec<f64>, b: Vec<f64>, rows: Vec<Row>) -> Equations {
        let starts = (0..rows.len()).map(|k| (0, k * columns)).collect();
        Equations { columns, patterns: vec![Pattern::new((0..columns).collect())], starts, a, b, rows }
    }

    /// Adds a row of a pattern; its entries, which are 0.
    pub fn push(&mut self, row: Row, b: f64, pattern: usize) -> &mut [f64] {
        let start = self.a.len();
        self.a.resize(start + self.patterns[pattern].places.len(), 0.0);
        self.starts.push((pattern, start));
        self.b.push(b);
        self.rows.push(row);
        &mut self.a[start..]
    }

    /// The pattern of a row.
    pub fn pattern(&self, k: usize) -> &Pattern {
        &self.patterns[self.starts[k].0]
    }

    /// The entries of a row, in the order of its pattern.
    pub fn row(&self, k: usize) -> &[f64] {
        let (pattern, start) = self.starts[k];
        &self.a[start..start + self.patterns[pattern].places.len()]
    }

    /// An entry of A.
    pub fn at(&self, k: usize, place: usize) -> f64 {
        self.pattern(k).entry(place).map_or(0.0, |entry| self.row(k)[entry])
    }

    /// An entry that the pattern of its row has.
    pub fn at_mut(&mut self, k: usize, place: usize) -> &mut f64 {
        let (pattern, start) = self.starts[k];
        &mut self.a[start + self.patterns[pattern].entry(place).expect("a column of the row")]
    }

    /// A x row by row, for values of some columns.
    pub fn product<'e>(&'e self, values: &[(usize, f64)]) -> impl Fn(usize) -> f64 + 'e {
        let of = |pattern: &Pattern| -> Vec<(usize, f64)> {
            values.iter().filter_map(|&(place, x)| Some((pattern.entry(place)?, x))).collect()
        };
        let of_patterns: Vec<Vec<(usize, f64)>> = self.patterns.iter().map(of).collect();
        move |k| {
            let (pattern, start) = self.starts[k];
            of_patterns[pattern].iter().map(|(entry, x)| self.a[start + entry] * x).sum()
        }
    }

    /// A'WA, A'Wb, b'Wb of all columns.
    pub fn gram(&self, weights: &[f64]) -> Gram {
        Sums::new(self, &(0..self.columns).collect::<Vec<_>>()).gram(weights)
    }

    /// b - A x.
    pub fn residuals(&self, active: &[usize], x: &DVector<f64>) -> Vec<f64> {
        let product = self.product(&active.iter().copied().zip(x.iter().copied()).collect::<Vec<_>>());
        (0..self.b.len()).map(|k| self.b[k] - product(k)).collect()
    }

    /// Robust weights of residuals: 1/s_j² times Huber's weight at 1.5 s_j; and s_j, by joint.
    pub fn weights(&self, residuals: &[f64], joints: usize) -> (Vec<f64>, Vec<f64>) {
        let spreads: Vec<f64> = self
            .of_joints(residuals, joints, true)
            .iter()
            .zip(self.of_joints(&self.b, joints, true))
            // An exact fit has residuals of rounding alone: beside its weights, joints whose friction is not known yet would not count at all.
            .map(|(of, size)| spread(of).max(LEAST_SPREAD * rms(&size)).max(f64::MIN_POSITIVE.sqrt()))
            .collect();
        let weight = |(row, residual): (&Row, &f64)| {
            let s = spreads[row.joint];
            if row.counts {
                (1.5 * s / residual.abs().max(1.5 * s)) / (s * s)
            } else {
                0.0
            }
        };
        let weights = self.rows.iter().zip(residuals).map(weight).collect();
        (weights, spreads)
    }

    /// Values of rows by joint, those of rows that count alone where that is wanted.
    fn of_joints(&self, values: &[f64], joints: usize, counting: bool) -> Vec<Vec<f64>> {
        let mut of = vec![Vec::with_capacity(self.rows.len() / joints.max(1) + 1); joints];
        for (row, value) in self.rows.iter().zip(values).filter(|(row, _)| row.counts || !counting) {
            of[row.joint].push(*value);
        }
        of
    }

    /// Robust weights and spreads: five rounds, or two from the weights of nearly the same equations.
    pub fn robust(&self, sums: &Sums, joints: usize, before: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let size: Vec<f64> = self.of_joints(&self.b, joints, false).iter().map(|of| rms(of).max(1e-12)).collect();
        let first = |row: &Row| if row.counts { 1.0 / (size[row.joint] * size[row.joint]) } else { 0.0 };
        let is_first = before.len() != self.rows.len();
        let mut weights: Vec<f64> = if is_first { self.rows.iter().map(first).collect() } else { before.to_vec() };
        let mut spreads = vec![1.0; joints];
        for _ in 0..if is_first { 5 } else { 2 } {
            let x = solve_fast(&sums.gram(&weights));
            (weights, spreads) = self.weights(&sums.residuals(&x), joints);
        }
        (weights, spreads)
    }
}

/// The covariance of a solution, and what it rests on.
#[derive(Clone, Debug)]
pub struct Covariance {
    /// The sandwich.
    pub matrix: DMatrix<f64>,
    /// Its columns.
    pub columns: Vec<usize>,
    /// (A'WA)^-1.
    inverse: DMatrix<f64>,
    /// The sum over blocks of time g_b g_b'.
    meat: DMatrix<f64>,
    /// Blocks of time.
    pub blocks: usize,
    /// How long each lasts, s.
    pub length: f64,
    /// Half the width of a three-sigma interval, in sigma: more than 3 where there are few blocks.
    pub reach: f64,
}

/// Fewer blocks than this give Student's t.
pub const FEW_BLOCKS: f64 = 20.0;

/// The sandwich (A'WA)^-1 (sum over blocks of time g_b g_b') (A'WA)^-1, g_b the score of a block over all joints. A block lasts 1 s or five
/// times the correlation time of the residuals, whichever is longer. The factor n/(n - p/joints) is for few blocks.
pub fn covariance(
    equations: &Equations,
    active: &[usize],
    residuals: &[f64],
    weights: &[f64],
    inverse: &DMatrix<f64>,
    joints: usize,
) -> Covariance {
    let length = block_length(equations, residuals, weights, joints);
    let scores = scores(equations, active, residuals, weights, length);
    let blocks = scores.len();
    let mut meat = DMatrix::zeros(active.len(), active.len());
    for score in &scores {
        meat.ger(1.0, score, score, 1.0);
    }
    let mut found = Covariance {
        matrix: DMatrix::zeros(0, 0),
        columns: active.to_vec(),
        inverse: inverse.clone(),
        meat,
        blocks,
        length,
        reach: 0.0,
    };
    found.renew(active.len(), joints);
    found
}

impl Covariance {
    /// Without some of its columns, as they would be 0; `unknowns` are left.
    pub fn without(&mut self, columns: &[usize], unknowns: usize, joints: usize) {
        for (k, _) in self.columns.iter().enumerate().filter(|(_, place)| columns.contains(place)) {
            eliminate(&mut self.inverse, &mut DVector::zeros(self.columns.len()), k);
        }
        self.renew(unknowns, joints);
    }

    fn renew(&mut self, unknowns: usize, joints: usize) {
        let (free, reach) = reach(self.blocks, unknowns, joints, 1);
        self.matrix = &self.inverse * &self.meat * &self.inverse * (self.blocks as f64 / free);
        self.reach = reach;
    }
}

/// The inverse of a Gram matrix and the solution without an unknown: as its inverse and the solution of all others, with zeros in its place.
pub fn eliminate(inverse: &mut DMatrix<f64>, x: &mut DVector<f64>, k: usize) {
    let pivot = inverse[(k, k)];
    if pivot > 0.0 {
        let column = inverse.column(k) / pivot;
        x.axpy(-x[k], &column, 1.0);
        inverse.ger(-pivot, &column, &column, 1.0);
    }
    inverse.row_mut(k).fill(0.0);
    inverse.column_mut(k).fill(0.0);
    x[k] = 0.0;
}

/// How many blocks are free behind as many unknowns, and half the width of an interval in sigma so that this many of them are as rarely wrong
/// together as 3 sigma of a normal distribution.
pub fn reach(blocks: usize, unknowns: usize, joints: usize, verdicts: usize) -> (f64, f64) {
    let lost = unknowns as f64 / joints as f64;
    // With fewer blocks than unknowns of a joint nothing is left to estimate from: then one in three counts.
    let free = (blocks as f64 - lost).max(blocks as f64 / 3.0).max(1.0);
    let exact = free >= FEW_BLOCKS && verdicts == 1;
    (free, if exact { 3.0 } else { student(free, (1.0 - THREE_SIGMA) / verdicts as f64) })
}

/// How long a block lasts whose residuals hardly know those of the next: 1 s, or five times their correlation time, s.
pub fn block_length(equations: &Equations, residuals: &[f64], weights: &[f64], joints: usize) -> f64 {
    (5.0 * correlation_time(equations, residuals, weights, joints)).max(1.0)
}

/// The score A'W r of each block of time.
pub fn scores(equations: &Equations, active: &[usize], residuals: &[f64], weights: &[f64], length: f64) -> Vec<DVector<f64>> {
    let mut scores: Vec<DVector<f64>> = Vec::new();
    let entries = |pattern: &Pattern| -> Vec<(usize, usize)> {
        active.iter().enumerate().filter_map(|(i, &place)| Some((i, pattern.entry(place)?))).collect()
    };
    let of_patterns: Vec<Vec<(usize, usize)>> = equations.patterns.iter().map(entries).collect();
    let mut block: Option<(usize, f64)> = None;
    for (k, row) in equations.rows.iter().enumerate() {
        let inside = block.is_some_and(|(log, start)| log == row.log && (0.0..length).contains(&(row.time - start)));
        if !inside {
            block = Some((row.log, row.time));
            scores.push(DVector::zeros(active.len()));
        }
        if weights[k] > 0.0 {
            let score = scores.last_mut().expect("a block");
            let a = equations.row(k);
            for &(i, entry) in &of_patterns[equations.starts[k].0] {
                score[i] += weights[k] * residuals[k] * a[entry];
            }
        }
    }
    scores
}

/// Samples after which no residuals are compared: what is correlated over a longer time counts as correlated so long.
const LONGEST_LAG: usize = 200;

/// The time after which the autocorrelation of the residuals stays below 1/e, the longest of the joints, s. Residuals of different logs have no
/// time between them.
fn correlation_time(equations: &Equations, residuals: &[f64], weights: &[f64], joints: usize) -> f64 {
    (0..joints)
        .map(|j| {
            let of: Vec<(usize, f64, f64)> = (0..residuals.len())
                .filter(|&k| equations.rows[k].joint == j && weights[k] > 0.0)
                .map(|k| (equations.rows[k].log, equations.rows[k].time, residuals[k]))
                .collect();
            let power: f64 = of.iter().map(|(.., r)| r * r).sum();
            let pairs = |lag: usize| (lag..of.len()).map(move |k| (k - lag, k)).filter(|&(a, b)| of[a].0 == of[b].0);
            let last = LONGEST_LAG.min(of.len());
            let is_below = |lag: &usize| pairs(*lag).map(|(a, b)| of[a].2 * of[b].2).sum::<f64>() < power / std::f64::consts::E;
            let lag = (1..last).find(is_below).unwrap_or(last);
            let step = crate::signal::median(&pairs(1).map(|(a, b)| of[b].1 - of[a].1).collect::<Vec<_>>());
            lag as f64 * step.max(0.0)
        })
        .fold(0.0, f64::max)
}

/// What lies within 3 sigma of a normal distribution.
const THREE_SIGMA: f64 = 0.997_300_203_936_74;

/// The quantile of Student's t that all but a part lies within, both signs together.
pub fn student(freedom: f64, outside: f64) -> f64 {
    // With t = sqrt(f) tan(u) the density is cos(u)^(f-1), over -pi/2 to pi/2.
    let density = |u: f64| u.cos().max(0.0).powf(freedom - 1.0);
    let integral = |to: f64| {
        let steps = 2000;
        let h = to / f64::from(steps);
        let sum: f64 = (0..=steps)
            .map(|k| {
                density(f64::from(k) * h)
                    * if k == 0 || k == steps {
                        1.0
                    } else if k % 2 == 1 {
                        4.0
                    } else {
                        2.0
                    }
            })
            .sum();
        sum * h / 3.0
    };
    let whole = integral(std::f64::consts::FRAC_PI_2);
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if integral(middle) < (1.0 - outside) * whole {
            low = middle;
        } else {
            high = middle;
        }
    }
    freedom.sqrt() * low.tan()
}

#[cfg(test)]
mod tests {
    use super::{block_length, student, Equations, Row, LONGEST_LAG};

    /// Residuals of logs have the same length of a block in every order of the logs, and those of one sign throughout have the longest.
    #[test]
    fn blocks_are_as_long_in_every_order_of_logs() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let length = |logs: &[(usize, Vec<f64>)]| {
            let row = |log: usize, k: usize| Row { joint: 0, log, time: 0.1 * k as f64, counts: true };
            let rows: Vec<Row> = logs.iter().flat_map(|(log, of)| (0..of.len()).map(|k| row(*log, k))).collect();
            let residuals: Vec<f64> = logs.iter().flat_map(|(_, of)| of.iter().copied()).collect();
            let count = rows.len();
            block_length(&Equations::dense(1, vec![0.0; count], residuals.clone(), rows), &residuals, &vec![1.0; count], 1)
        };
        for _ in 0..20 {
            // What is left wanders.
            let mut walk = |count: usize| {
                let mut at = 0.0;
                (0..count)
                    .map(|_| {
                        at += random();
                        at
                    })
                    .collect::<Vec<f64>>()
            };
            let mut logs: Vec<(usize, Vec<f64>)> = (0..3).map(|log| (log, walk(250 + 100 * log))).collect();
            let first = length(&logs);
            for k in [2, 1, 2, 1] {
                logs.swap(0, k);
                assert_eq!(length(&logs), first);
            }
        }
        let constant = |sign: f64| (0..1000).map(|_| sign + 0.1 * random()).collect::<Vec<f64>>();
        let longest = 5.0 * 0.1 * LONGEST_LAG as f64;
        assert!((length(&[1.0, -1.0].map(constant).into_iter().enumerate().collect::<Vec<_>>()) - longest).abs() < 1e-9);
    }

    /// Quantiles 0.99865 of Student's t, from the closed forms for 1 and 2 degrees of freedom and the normal limit.
    #[test]
    fn student_has_its_closed_forms() {
        let p = super::THREE_SIGMA;
        let student = |freedom: f64| student(freedom, 1.0 - p);
        let one = (std::f64::consts::FRAC_PI_2 * p).tan();
        assert!((student(1.0) / one - 1.0).abs() < 1e-6, "{} {one}", student(1.0));
        let two = p * (2.0 / (1.0 - p * p)).sqrt();
        assert!((student(2.0) / two - 1.0).abs() < 1e-6, "{} {two}", student(2.0));
        assert!((student(1e5) - 3.0).abs() < 1e-3);
    }
}
