//! Strictly convex quadratic programs of few unknowns: the dual method of active sets (Goldfarb, Idnani, 1983).
//!
//! ```text
//! least 1/2 x' H x + g' x    with    c_i' x >= b_i,  i = 1 .. R,     H symmetric, positive definite
//! ```
//!
//! The method starts at the unconstrained optimum and adds the most violated row, one after the other. Each point on its way is
//! the optimum under the rows that are active there. A row that would get a negative multiplier leaves. With H = L L' it carries
//! J = L^-T Q and R with J' H J = 1 and J' C_A' = [R; 0], C_A the active rows, so every step is a triangular solution.
//!
//! The rows have no common point exactly where a violated row is a combination of active rows and no active row can leave. The
//! multipliers of that combination are the proof (Farkas): y >= 0, C' y = 0, b' y > 0.

use super::{is_finite, lit, Cholesky};
use nalgebra::{RealField, SMatrix, SVector};

/// Rows added and removed, after which a program is given up; of random programs with 8 unknowns and 36 rows the worst takes 50.
const MOST_STEPS: u32 = 120;

/// Refinements of x at most, each with new active rows.
const MOST_ROUNDS: usize = 3;

/// An optimum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimum<T, const N: usize, const R: usize, const K: usize> {
    /// The unknowns x.
    pub x: SVector<T, N>,
    /// The multipliers u >= 0 of H x + g = C' u, block by block and row by row; zero in rows that are not active.
    pub multipliers: [SVector<T, R>; K],
    /// Which rows are active: c_i' x = b_i.
    pub active: [[bool; R]; K],
    /// The largest of the errors of stationarity, feasibility and complementarity, each divided by the size of its terms.
    pub residual: T,
    /// Rows added and removed.
    pub steps: u32,
}

/// Why there is no optimum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NoOptimum<T, const N: usize, const R: usize, const K: usize> {
    /// A number is infinite or NaN; a bound may be minus infinity, which never acts.
    NotFinite,
    /// H is not positive definite.
    NotConvex,
    /// No x keeps all rows.
    Infeasible {
        /// y >= 0 with C' y = 0 and b' y > 0: the sum of the rows, so weighted, has no solution. Zero in rows without a part in it.
        conflict: [SVector<T, R>; K],
    },
    /// A hundred and twenty steps did not suffice.
    Limit {
        /// The last iterate. It violates a row.
        last: Optimum<T, N, R, K>,
    },
}

impl<T, const N: usize, const R: usize, const K: usize> core::fmt::Display for NoOptimum<T, N, R, K> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            NoOptimum::NotFinite => "a number of the quadratic program is infinite or NaN",
            NoOptimum::NotConvex => "the matrix of the quadratic program is not positive definite",
            NoOptimum::Infeasible { .. } => "no point keeps all rows of the quadratic program",
            NoOptimum::Limit { .. } => "the quadratic program is not solved within 120 steps",
        })
    }
}

impl<T: core::fmt::Debug, const N: usize, const R: usize, const K: usize> core::error::Error for NoOptimum<T, N, R, K> {}

/// The place of a row: its block, and its number there.
type Place = (usize, usize);

/// The active rows and the factors that belong to them.
struct Active<T, const N: usize> {
    /// J, N x N.
    j: SMatrix<T, N, N>,
    /// R, upper triangular; its first `count` columns count.
    r: SMatrix<T, N, N>,
    /// The rows, by their places in the program, and their multipliers.
    rows: [Place; N],
    multipliers: SVector<T, N>,
    count: usize,
}

impl<T: RealField + Copy, const N: usize> Active<T, N> {
    /// R^-1 of the first `count` elements of `d`; the others are zero.
    fn solve(&self, d: &SVector<T, N>) -> SVector<T, N> {
        let mut x = SVector::<T, N>::zeros();
        for i in (0..N).rev() {
            if i < self.count {
                let mut sum = d[i];
                for k in i + 1..N {
                    sum -= self.r[(i, k)] * x[k];
                }
                x[i] = sum / self.r[(i, i)];
            }
        }
        x
    }

    /// The rotation of columns `k` and `k` + 1 of J by (c, s).
    fn rotate(&mut self, k: usize, c: T, s: T) {
        if k + 1 < N {
            for i in 0..N {
                let (a, b) = (self.j[(i, k)], self.j[(i, k + 1)]);
                self.j[(i, k)] = c * a + s * b;
                self.j[(i, k + 1)] = c * b - s * a;
            }
        }
    }

    /// Adds `row`, whose J' c is `d`: rotations that clear `d` below the new column of R.
    fn add(&mut self, row: Place, multiplier: T, mut d: SVector<T, N>) {
        let count = self.count;
        for k in (0..N).rev() {
            if k >= count && k + 1 < N {
                let (c, s, norm) = rotation(d[k], d[k + 1]);
                d[k] = norm;
                d[k + 1] = T::zero();
                self.rotate(k, c, s);
            }
        }
        for k in 0..N {
            if k == count {
                for i in 0..k + 1 {
                    self.r[(i, k)] = d[i];
                }
                self.rows[k] = row;
                self.multipliers[k] = multiplier;
            }
        }
        self.count += 1;
    }

    /// An element of R, zero outside of it: the optimiser does not see that all places of [`Active::remove`] are within.
    fn of_r(&self, i: usize, k: usize) -> T {
        self.r.get((i, k)).copied().unwrap_or_else(T::zero)
    }

    fn set_r(&mut self, i: usize, k: usize, value: T) {
        if let Some(element) = self.r.get_mut((i, k)) {
            *element = value;
        }
    }

    /// Removes the active row of number `out`: its column of R goes, and rotations make the others triangular again.
    fn remove(&mut self, out: usize) {
        self.count = self.count.saturating_sub(1);
        for k in 0..N {
            let next = (self.rows.get(k + 1).copied(), self.multipliers.get(k + 1).copied());
            if let (true, (Some(row), Some(multiplier))) = (k >= out, next) {
                for i in 0..N {
                    self.set_r(i, k, self.of_r(i, k + 1));
                }
                self.rows[k] = row;
                self.multipliers[k] = multiplier;
            }
        }
        for k in 0..N {
            if k >= out && k < self.count && k + 1 < N {
                let (c, s, norm) = rotation(self.of_r(k, k), self.of_r(k + 1, k));
                self.set_r(k, k, norm);
                self.set_r(k + 1, k, T::zero());
                for m in k + 1..N {
                    let (a, b) = (self.of_r(k, m), self.of_r(k + 1, m));
                    self.set_r(k, m, c * a + s * b);
                    self.set_r(k + 1, m, c * b - s * a);
                }
                self.rotate(k, c, s);
            }
        }
        for k in 0..N {
            if k >= self.count {
                for i in 0..N {
                    self.set_r(i, k, T::zero());
                }
                self.multipliers[k] = T::zero();
            }
        }
    }
}

/// (c, s, norm) with c a + s b = norm and c b - s a = 0.
fn rotation<T: RealField + Copy>(a: T, b: T) -> (T, T, T) {
    let norm = a.hypot(b);
    if norm > T::zero() {
        (a / norm, b / norm, norm)
    } else {
        (T::one(), T::zero(), T::zero())
    }
}

/// Relative violation below which a row counts as kept: 1e-12 in f64, 1e-5 in f32.
fn tolerance<T: RealField + Copy>() -> T {
    if T::default_epsilon() > lit(1e-9) {
        lit(1e-5)
    } else {
        lit(1e-12)
    }
}

/// A program, with the sizes of its numbers.
struct Program<'a, T, const N: usize, const R: usize, const K: usize> {
    h: &'a SMatrix<T, N, N>,
    g: &'a SVector<T, N>,
    rows: &'a [SMatrix<T, R, N>; K],
    bounds: &'a [SVector<T, R>; K],
    /// The sums of |c_i|.
    sums: [SVector<T, R>; K],
    /// The size of x: its largest element since it was refined last.
    size: T,
    /// The largest element of x on its whole way, the unconstrained optimum included.
    largest: T,
}

impl<T: RealField + Copy, const N: usize, const R: usize, const K: usize> Program<'_, T, N, R, K> {
    fn row(&self, (block, row): Place) -> SVector<T, N> {
        let rows = self.rows.get(block);
        SVector::from_fn(|k, _| rows.and_then(|rows| rows.get((row, k))).copied().unwrap_or_else(T::zero))
    }

    /// c' x - b of a row.
    fn slack(&self, (block, row): Place, x: &SVector<T, N>) -> T {
        let bound = self.bounds.get(block).and_then(|bounds| bounds.get(row)).copied().unwrap_or_else(T::zero);
        self.row((block, row)).dot(x) - bound
    }

    /// c' x - b of all rows of block `k`, and the sizes of their terms.
    fn slacks(&self, k: usize, x: &SVector<T, N>) -> [SVector<T, R>; 2] {
        match (self.rows.get(k), self.bounds.get(k), self.sums.get(k)) {
            (Some(rows), Some(bounds), Some(sums)) => [rows * x - bounds, sums * self.size + bounds.abs()],
            _ => [SVector::zeros(); 2],
        }
    }

    /// The row that `x` violates most, by the size of its terms; rows of `left_out` do not count.
    fn most_violated(&self, x: &SVector<T, N>, left_out: &[[bool; R]; K]) -> Option<Place> {
        let mut worst: Option<(T, Place)> = None;
        for k in 0..K {
            let [values, sizes] = self.slacks(k, x);
            for i in 0..R {
                let (value, size) = (values[i], sizes[i]);
                if !(value < -(tolerance::<T>() * size)) || left_out[k][i] || !self.bounds[k][i].is_finite() {
                    continue;
                }
                if worst.is_none_or(|(before, _)| value / size < before) {
                    worst = Some((value / size, (k, i)));
                }
            }
        }
        worst.map(|(_, row)| row)
    }

    /// H x + g - C' u, the sum over the active rows.
    fn stationarity(&self, x: &SVector<T, N>, active: &Active<T, N>) -> SVector<T, N> {
        let mut gradient = self.h * x + self.g;
        for k in 0..N {
            if k < active.count {
                gradient -= self.row(active.rows[k]) * active.multipliers[k];
            }
        }
        gradient
    }

    /// One step of refinement of the equations of the active rows.
    fn refine(&self, x: &mut SVector<T, N>, active: &mut Active<T, N>) {
        let along = active.j.tr_mul(&-self.stationarity(x, active));
        // R' y = b - C x, forward, in the span of the active rows; beside it, what remains of the gradient.
        let mut y = along;
        for i in 0..N {
            if i < active.count {
                let mut sum = -self.slack(active.rows[i], x);
                for k in 0..i {
                    sum -= active.r[(k, i)] * y[k];
                }
                y[i] = sum / active.r[(i, i)];
            }
        }
        let by = active.solve(&(y - along));
        if is_finite(&y) && is_finite(&by) {
            *x += active.j * y;
            active.multipliers += by;
        }
    }

    /// The size of a refined `x`. Where it is small beside the unconstrained optimum, roundings of the latter remain in it.
    fn shrink(&mut self, x: &SVector<T, N>) {
        self.size = x.amax().max(self.largest * tolerance::<T>().sqrt());
    }

    /// `x` with its residual.
    fn optimum(mut self, x: SVector<T, N>, active: &Active<T, N>, steps: u32) -> Optimum<T, N, R, K> {
        self.shrink(&x);
        let (mut multipliers, mut is_active) = ([SVector::<T, R>::zeros(); K], [[false; R]; K]);
        let mut size = self.g.amax();
        for k in 0..N {
            if k < active.count {
                let row = active.rows[k];
                // Refinement may leave a multiplier of zero a rounding below it.
                let u = active.multipliers[k].max(T::zero());
                size = size.max(self.row(row).amax() * u);
                if let (Some(multiplier), Some(is_active)) = (at(&mut multipliers, row), is_active.get_mut(row.0)) {
                    *multiplier = u;
                    if let Some(is_active) = is_active.get_mut(row.1) {
                        *is_active = true;
                    }
                }
            }
        }
        for i in 0..N {
            size = size.max(self.h.row(i).iter().fold(T::zero(), |sum, h| sum + h.abs()) * self.size);
        }
        let mut gradient = self.h * x + self.g;
        for (rows, multipliers) in self.rows.iter().zip(&multipliers) {
            gradient -= rows.tr_mul(multipliers);
        }
        let relative = |value: T, size: T| if value > T::zero() { value / size } else { T::zero() };
        let mut residual = relative(gradient.amax(), size);
        for k in 0..K {
            let [slacks, sizes] = self.slacks(k, &x);
            for i in 0..R {
                if self.bounds[k][i].is_finite() {
                    let slack = slacks[i];
                    residual = residual.max(relative(if is_active[k][i] { slack.abs() } else { -slack }, sizes[i]));
                }
            }
        }
        Optimum { x, multipliers, active: is_active, residual, steps }
    }
}

/// The element of a row.
fn at<T, const R: usize, const K: usize>(blocks: &mut [SVector<T, R>; K], (block, row): Place) -> Option<&mut T> {
    blocks.get_mut(block).and_then(|block| block.as_mut_slice().get_mut(row))
}

/// The optimum of 1/2 x' H x + g' x over c_i' x >= b_i, with C the `rows`, K blocks of R x N, and b the `bounds`.
///
/// H is read in its lower triangle and counts as symmetric. Of the sizes N <= 8 and K R <= 4 N + 4 are tried.
///
/// # Errors
/// [`NoOptimum`].
pub fn quadratic_program<T: RealField + Copy, const N: usize, const R: usize, const K: usize>(
    h: &SMatrix<T, N, N>,
    g: &SVector<T, N>,
    rows: &[SMatrix<T, R, N>; K],
    bounds: &[SVector<T, R>; K],
) -> Result<Optimum<T, N, R, K>, NoOptimum<T, N, R, K>> {
    // Minus infinity is a bound that never acts.
    let is_bound = |b: &T| b.is_finite() || *b < T::zero();
    if !(is_finite(h) && is_finite(g) && rows.iter().all(is_finite) && bounds.iter().flatten().all(is_bound)) {
        return Err(NoOptimum::NotFinite);
    }
    let factors = Cholesky::new(h).ok_or(NoOptimum::NotConvex)?;
    let mut x = -factors.solve(g);
    let mut j = SMatrix::<T, N, N>::zeros();
    for k in 0..N {
        let mut unit = SVector::<T, N>::zeros();
        unit[k] = T::one();
        j.set_column(k, &factors.backward(&unit));
    }
    if !(is_finite(&x) && is_finite(&j)) {
        return Err(NoOptimum::NotFinite);
    }
    let sums = core::array::from_fn(|k| rows.get(k).map_or_else(SVector::zeros, |rows| rows.abs().column_sum()));
    let mut program = Program { h, g, rows, bounds, sums, size: x.amax(), largest: x.amax() };
    let mut active = Active { j, r: SMatrix::zeros(), rows: [(0, 0); N], multipliers: SVector::zeros(), count: 0 };
    // Rows that repeat active ones to rounding.
    let mut left_out = [[false; R]; K];
    let mut steps = 0;
    // Beside a large unconstrained optimum a row counts as kept with its roundings. Once x is refined, it is looked at again.
    for _ in 0..MOST_ROUNDS {
        while let Some(row) = program.most_violated(&x, &left_out) {
            let c = program.row(row);
            let mut multiplier = T::zero();
            loop {
                if steps >= MOST_STEPS {
                    return Err(NoOptimum::Limit { last: program.optimum(x, &active, steps) });
                }
                let d = active.j.tr_mul(&c);
                // The step z of x, beside the active rows, and the rates at which their multipliers fall.
                let mut beside = d;
                for k in 0..N {
                    if k < active.count {
                        beside[k] = T::zero();
                    }
                }
                let falls = active.solve(&d);
                let mut first: Option<(T, usize)> = None;
                for k in 0..N {
                    if k < active.count && falls[k] > T::zero() {
                        let length = active.multipliers[k] / falls[k];
                        if first.is_none_or(|(before, _)| length < before) {
                            first = Some((length, k));
                        }
                    }
                }
                let is_dependent = active.count >= N || !(beside.norm() > tolerance::<T>() * d.norm());
                let slack = program.slack(row, &x);
                let whole = -slack / beside.norm_squared();
                steps += 1;
                match first {
                    Some((length, out)) if is_dependent || length < whole => {
                        if !is_dependent {
                            x += active.j * beside * length;
                        }
                        active.multipliers -= falls * length;
                        multiplier += length;
                        active.remove(out);
                    }
                    None if is_dependent => {
                        let mut conflict = [SVector::<T, R>::zeros(); K];
                        if let Some(weight) = at(&mut conflict, row) {
                            *weight = T::one();
                        }
                        for k in 0..N {
                            if k < active.count {
                                if let Some(weight) = at(&mut conflict, active.rows[k]) {
                                    *weight = -falls[k];
                                }
                            }
                        }
                        if program.is_conflict(&conflict) {
                            return Err(NoOptimum::Infeasible { conflict });
                        }
                        // Violated by rounding alone.
                        if let Some(is_out) = left_out.get_mut(row.0).and_then(|block| block.get_mut(row.1)) {
                            *is_out = true;
                        }
                        break;
                    }
                    _ => {
                        x += active.j * beside * whole;
                        active.multipliers -= falls * whole;
                        active.add(row, multiplier + whole, d);
                        break;
                    }
                }
            }
            program.size = program.size.max(x.amax());
            program.largest = program.largest.max(program.size);
            if !is_finite(&x) {
                return Err(NoOptimum::NotFinite);
            }
        }
        program.refine(&mut x, &mut active);
        program.shrink(&x);
        if program.most_violated(&x, &left_out).is_none() {
            break;
        }
    }
    Ok(program.optimum(x, &active, steps))
}

impl<T: RealField + Copy, const N: usize, const R: usize, const K: usize> Program<'_, T, N, R, K> {
    /// Whether b' y > 0 beyond rounding for y >= 0 of C' y = 0.
    fn is_conflict(&self, y: &[SVector<T, R>; K]) -> bool {
        let (mut sum, mut size) = (T::zero(), T::zero());
        for (y, bounds) in y.iter().zip(self.bounds) {
            for i in 0..R {
                if y[i] > T::zero() {
                    sum += y[i] * bounds[i];
                    size += y[i] * bounds[i].abs();
                }
            }
        }
        sum > size * tolerance()
    }
}
