//! Least squares in order of priority, within rows that all of them keep (Kanoun et al., 2011; Escande, Mansard, Wieber, 2014).
//!
//! ```text
//! level 1:  least |A_1 x - v_1|^2 + lambda^2 |x|^2
//! level k:  least |A_k x - v_k|^2 + lambda^2 |x|^2    among the x with the A_i x of all levels before
//! always:   c_i' x >= b_i
//! ```
//!
//! Each level moves x = x_before + Z y, Z an orthonormal basis of the directions that no level before it sees. The singular directions
//! of A_k Z are the unknowns, so the matrix of the quadratic program is diagonal and no condition number is squared. y = 0 keeps all rows,
//! so only the first level can be without a solution.

use super::{left_singular, lit, quadratic_program, NoOptimum};
use nalgebra::{RealField, SMatrix, SVector};

/// A solution of the levels so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Levels<T, const N: usize, const K: usize> {
    x: SVector<T, N>,
    /// Z: the columns that are not zero are orthonormal.
    free: SMatrix<T, N, N>,
    rows: [SMatrix<T, N, N>; K],
    bounds: [SVector<T, N>; K],
    is_first: bool,
    is_limited: bool,
}

/// A level in its singular directions.
#[derive(Clone, Copy)]
struct Directions<T, const N: usize> {
    /// Columns: directions of x.
    along: SMatrix<T, N, N>,
    /// Whether the level sees a direction.
    seen: [bool; N],
    /// The diagonal of H, and g.
    h: SVector<T, N>,
    g: SVector<T, N>,
}

/// The weight of directions that a level does not see, as a share of the largest singular value squared: they shrink.
fn least_share<T: RealField + Copy>() -> T {
    if T::default_epsilon() > lit(1e-9) {
        lit(2e-5)
    } else {
        lit(1e-10)
    }
}

impl<T: RealField + Copy, const N: usize, const K: usize> Levels<T, N, K> {
    /// No level yet, under the `rows` c_i of `bounds` b_i.
    pub(crate) fn new(rows: [SMatrix<T, N, N>; K], bounds: [SVector<T, N>; K]) -> Self {
        Self { x: SVector::zeros(), free: SMatrix::identity(), rows, bounds, is_first: true, is_limited: false }
    }

    /// x.
    pub(crate) fn x(&self) -> &SVector<T, N> {
        &self.x
    }

    /// Whether a row holds a level back.
    pub(crate) fn is_limited(&self) -> bool {
        self.is_limited
    }

    fn directions<const M: usize>(&self, a: &SMatrix<T, M, N>, v: &SVector<T, M>, lambda: T) -> Directions<T, N> {
        let modes = left_singular(&(a * self.free).transpose());
        let along = self.free * modes.u;
        let largest = modes.sigma.amax();
        let seen = core::array::from_fn(|i| modes.sigma[i] > largest * T::default_epsilon() * lit(64.0));
        let share = largest * largest * least_share();
        let least = if share > T::zero() { share } else { T::one() };
        let asked = (a * along).tr_mul(&(v - a * self.x));
        let now = along.tr_mul(&self.x);
        let (mut h, mut g) = (SVector::zeros(), SVector::zeros());
        for i in 0..N {
            let weight = if seen[i] { lambda * lambda } else { least };
            h[i] = weight;
            g[i] = now[i] * weight;
            if seen[i] {
                h[i] += modes.sigma[i] * modes.sigma[i];
                g[i] -= asked[i];
            }
        }
        Directions { along, seen, h, g }
    }

    /// y of the program of `directions`.
    fn solve(&self, directions: &Directions<T, N>) -> Result<(SVector<T, N>, bool), NoOptimum<T, N, N, K>> {
        let rows: [_; K] = core::array::from_fn(|k| self.rows[k] * directions.along);
        let bounds: [_; K] = core::array::from_fn(|k| {
            let left = self.bounds[k] - self.rows[k] * self.x;
            // Rounding must not take y = 0 away.
            if self.is_first {
                left
            } else {
                left.map(|left| left.min(T::zero()))
            }
        });
        let found = quadratic_program(&SMatrix::from_diagonal(&directions.h), &directions.g, &rows, &bounds)?;
        Ok((found.x, found.active.iter().flatten().any(|active| *active)))
    }

    fn take(&mut self, directions: &Directions<T, N>, (y, is_limited): (SVector<T, N>, bool)) {
        self.x += directions.along * y;
        self.is_first = false;
        self.is_limited |= is_limited;
        for i in 0..N {
            if directions.seen[i] {
                self.free.set_column(i, &SVector::zeros());
            } else {
                self.free.set_column(i, &directions.along.column(i).into_owned());
            }
        }
    }

    /// Adds a level: `a` x near `v`.
    pub(crate) fn level<const M: usize>(
        &mut self,
        a: &SMatrix<T, M, N>,
        v: &SVector<T, M>,
        lambda: T,
    ) -> Result<(), NoOptimum<T, N, N, K>> {
        self.take_level(&self.directions(a, v, lambda))
    }

    fn take_level(&mut self, directions: &Directions<T, N>) -> Result<(), NoOptimum<T, N, N, K>> {
        let found = self.solve(directions)?;
        self.take(directions, found);
        Ok(())
    }

    /// Adds the first level with its direction kept: a x = s a x_0 with the largest s from 0 to 1 that the rows allow, x_0 the solution without
    /// rows. Returns s. Where the rows allow no such x, the level is as without direction, and s is 0.
    pub(crate) fn along<const M: usize>(
        &mut self,
        a: &SMatrix<T, M, N>,
        v: &SVector<T, M>,
        lambda: T,
    ) -> Result<T, NoOptimum<T, N, N, K>> {
        let directions = self.directions(a, v, lambda);
        let mut whole = SVector::<T, N>::zeros();
        for i in 0..N {
            if directions.seen[i] {
                whole -= directions.along.column(i) * (directions.g[i] / directions.h[i]);
            }
        }
        let length = whole.norm();
        if length > T::zero() {
            // One unknown for s, the others move what the level does not see.
            let mut one = directions;
            for i in 0..N {
                if one.seen[i] {
                    one.along.set_column(i, &SVector::zeros());
                    (one.h[i], one.g[i]) = (T::one(), T::zero());
                } else {
                    one.h[i] = least_share();
                    one.g[i] = T::zero();
                }
            }
            one.along.set_column(0, &(whole / length));
            one.g[0] = -length;
            if let Ok((y, is_limited)) = self.solve(&one) {
                if y[0] >= T::zero() {
                    self.take(&directions, (SVector::zeros(), is_limited));
                    self.x += one.along * y;
                    return Ok((y[0] / length).min(T::one()));
                }
            }
        }
        self.take_level(&directions)?;
        Ok(if length > T::zero() { T::zero() } else { T::one() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{matrix, vector, SMatrix};

    type Box3 = Levels<f64, 3, 2>;

    fn within(low: f64, high: f64) -> Box3 {
        let unit = SMatrix::identity();
        Levels::new([unit, -unit], [SVector::repeat(low), SVector::repeat(-high)])
    }

    #[test]
    fn levels_without_rows_are_projections() {
        let (a, b) = (matrix![1.0, 2.0, 2.0; 0.0, 1.0, -1.0], matrix![1.0, 0.0, 1.0]);
        let (v, w) = (vector![1.0, -0.5], vector![4.0]);
        let mut levels = within(-100.0, 100.0);
        levels.level(&a, &v, 0.0).unwrap();
        let inverse = crate::linalg::RightInverse::new(&a).unwrap();
        assert!((levels.x() - inverse.solve(&v)).amax() < 1e-15);
        levels.level(&b, &w, 0.0).unwrap();
        assert!((a * levels.x() - v).amax() < 1e-14 && (b * levels.x() - w).amax() < 1e-14 && !levels.is_limited());
        // Nothing is left: a third level moves nothing.
        let before = *levels.x();
        levels.level(&SMatrix::identity(), &vector![1.0, 1.0, 1.0], 0.0).unwrap();
        assert!((levels.x() - before).amax() < 1e-15);
    }

    #[test]
    fn a_row_of_the_second_level_gives_way() {
        let mut levels = within(-1.0, 1.0);
        levels.level(&matrix![1.0, 1.0, 0.0], &vector![1.5], 0.0).unwrap();
        assert!((levels.x() - vector![0.75, 0.75, 0.0]).amax() < 1e-9 && !levels.is_limited());
        levels.level(&matrix![1.0, 0.0, 0.0; 0.0, 0.0, 1.0], &vector![2.0, 5.0], 0.0).unwrap();
        assert!((levels.x() - vector![1.0, 0.5, 1.0]).amax() < 1e-14 && levels.is_limited(), "{}", levels.x());
    }

    #[test]
    fn a_direction_is_kept_by_its_scale_and_by_what_is_free() {
        // x_1 = 4 s, x_2 + x_3 = 3 s: the first joint allows s = 1/4.
        let a = matrix![1.0, 0.0, 0.0; 0.0, 1.0, 1.0];
        let mut levels = within(-1.0, 1.0);
        let s = levels.along(&a, &vector![4.0, 3.0], 0.0).unwrap();
        assert!((s - 0.25).abs() < 1e-9 && (a * levels.x() - vector![1.0, 0.75]).amax() < 1e-9, "{s} {}", levels.x());
        // The third joint takes over what the second cannot: x_2 from -1 to 0.2.
        let unit = SMatrix::<f64, 3, 3>::identity();
        let mut levels = Levels::new([unit, -unit], [SVector::repeat(-1.0), vector![-1.0, -0.2, -1.0]]);
        let s = levels.along(&a, &vector![0.0, 1.0], 0.0).unwrap();
        assert!((s - 1.0).abs() < 1e-9 && (levels.x() - vector![0.0, 0.2, 0.8]).amax() < 1e-9, "{s} {}", levels.x());
        // No x = s x_0 within the rows: the nearest.
        let mut levels = Levels::new([unit, -unit], [SVector::repeat(0.5), SVector::repeat(-1.0)]);
        let s = levels.along(&a, &vector![-1.0, 1.0], 0.0).unwrap();
        assert!(s == 0.0 && (levels.x() - vector![0.5, 0.5, 0.5]).amax() < 1e-9, "{s} {}", levels.x());
    }
}
