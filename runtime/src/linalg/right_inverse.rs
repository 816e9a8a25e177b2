//! The right pseudo-inverse of a wide matrix of full rank, and its damped form.
//!
//! For J, M x N with M <= N, factor the transpose: J' = Q R with Q' Q = I (N x M) and R upper triangular (M x M). Then
//!
//! ```text
//! J+ = J' (J J')^-1 = Q R^-T,    I - J+ J = I - Q Q',    det(J J') = prod r_ii^2
//! ```
//!
//! which neither squares the condition number, as J J' would, nor needs M = N. Q comes from modified Gram-Schmidt applied twice,
//! orthogonal to rounding unless a row is dependent to rounding (Giraud, Langou, Rozloznik, 2005).

use super::lit;
use nalgebra::{RealField, SMatrix, SVector};

/// J' = Q R of a matrix J with full row rank.
#[derive(Clone, Copy, Debug)]
pub struct RightInverse<T, const M: usize, const N: usize> {
    q: SMatrix<T, N, M>,
    r: SMatrix<T, M, M>,
}

impl<T: RealField + Copy, const M: usize, const N: usize> RightInverse<T, M, N> {
    /// Factors J; `None` where a row depends on those before it within 64 roundings: J is singular, not finite, or has M > N.
    pub fn new(j: &SMatrix<T, M, N>) -> Option<Self> {
        let (factors, full_rank) = Self::factor(j);
        full_rank.then_some(factors)
    }

    fn factor(j: &SMatrix<T, M, N>) -> (Self, bool) {
        let mut q: SMatrix<T, N, M> = j.transpose();
        let mut r = SMatrix::<T, M, M>::zeros();
        let mut full_rank = true;
        let tiny = T::default_epsilon() * lit(64.0);
        for k in 0..M {
            let mut v: SVector<T, N> = q.column(k).into_owned();
            let length = v.norm();
            for _ in 0..2 {
                for i in 0..k {
                    let along = q.column(i).dot(&v);
                    r[(i, k)] += along;
                    v -= q.column(i) * along;
                }
            }
            let rest = v.norm();
            // Not `rest <= ...`: a NaN must count as dependent.
            if rest > tiny * length && rest.is_finite() {
                r[(k, k)] = rest;
                q.set_column(k, &(v / rest));
            } else {
                full_rank = false;
                q.set_column(k, &SVector::zeros());
            }
        }
        (Self { q, r }, full_rank)
    }

    /// The factors of [J, lambda I], M x (N + M); q is kept without its last rows. `solve` then returns the x of the least (x, z)
    /// with J x + lambda z = v. This is x = J' (J J' + lambda^2 I)^-1 v, computed without squaring a condition number.
    fn damped(j: &SMatrix<T, M, N>, lambda: T) -> Self {
        let (mut q, mut tails) = (j.transpose(), SMatrix::<T, M, M>::from_diagonal_element(lambda));
        let mut r = SMatrix::<T, M, M>::zeros();
        for k in 0..M {
            let (mut v, mut tail): (SVector<T, N>, SVector<T, M>) = (q.column(k).into_owned(), tails.column(k).into_owned());
            for _ in 0..2 {
                for i in 0..k {
                    let along = q.column(i).dot(&v) + tails.column(i).dot(&tail);
                    r[(i, k)] += along;
                    v -= q.column(i) * along;
                    tail -= tails.column(i) * along;
                }
            }
            let rest = v.norm().hypot(tail.norm());
            r[(k, k)] = rest;
            q.set_column(k, &(v / rest));
            tails.set_column(k, &(tail / rest));
        }
        Self { q, r }
    }

    /// J+ v: the vector of least norm with J x = v.
    pub fn solve(&self, v: &SVector<T, M>) -> SVector<T, N> {
        // R' y = v, forward.
        let mut y = *v;
        for i in 0..M {
            let mut sum = y[i];
            for k in 0..i {
                sum -= self.r[(k, i)] * y[k];
            }
            y[i] = sum / self.r[(i, i)];
        }
        self.q * y
    }

    /// J+ as a matrix, N x M.
    pub fn matrix(&self) -> SMatrix<T, N, M> {
        let mut inverse = SMatrix::<T, N, M>::zeros();
        for i in 0..M {
            let mut unit = SVector::<T, M>::zeros();
            unit[i] = T::one();
            inverse.set_column(i, &self.solve(&unit));
        }
        inverse
    }

    /// (I - J+ J) x: the part of x that the rows of J do not see.
    pub fn null_space(&self, x: &SVector<T, N>) -> SVector<T, N> {
        x - self.q * self.q.tr_mul(x)
    }

    /// sqrt(det(J J')), never negative: the volume spanned by the rows.
    pub fn volume(&self) -> T {
        volume(&self.r)
    }
}

fn volume<T: RealField + Copy, const M: usize>(r: &SMatrix<T, M, M>) -> T {
    (0..M).fold(T::one(), |product, i| product * r[(i, i)])
}

/// Damping near singularities, by the manipulability (Nakamura, Hanafusa, 1986).
///
/// ```text
/// x = J' (J J' + lambda^2 I)^-1 v,    lambda = lambda_0 (1 - w / w_0) for w < w_0,    0 otherwise
/// ```
///
/// with w = sqrt(det(J J')). Where lambda > 0, |x| <= |v| / (2 lambda).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping<T> {
    threshold: T,
    factor: T,
}

/// Why a damping was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DampingError {
    /// The threshold w_0 is not a positive finite number.
    Threshold,
    /// The factor lambda_0 is not a positive finite number.
    Factor,
}

messages! { DampingError,
    DampingError::Threshold => "the threshold w_0 is not a positive finite number";
    DampingError::Factor => "the factor lambda_0 is not a positive finite number";
}

/// What [`Damping::solve`] found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<T, const N: usize> {
    /// The joint vector.
    pub x: SVector<T, N>,
    /// Whether damping was active: J x differs from v.
    pub damped: bool,
}

/// The threshold of a [`Damping`] whose factor is still to be given.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct DampingBelow<T> {
    threshold: T,
}

impl<T: RealField + Copy> DampingBelow<T> {
    /// Damping of at most `factor`, lambda_0 in the units of a singular value of J, which it reaches where w = 0.
    ///
    /// # Errors
    /// Where threshold or factor is not positive and finite.
    pub fn at_most(self, factor: T) -> Result<Damping<T>, DampingError> {
        let threshold = self.threshold;
        if !(threshold > T::zero() && threshold.is_finite()) {
            return Err(DampingError::Threshold);
        }
        if !(factor > T::zero() && factor.is_finite()) {
            return Err(DampingError::Factor);
        }
        Ok(Damping { threshold, factor })
    }
}

impl<T: RealField + Copy> Damping<T> {
    /// Damping where w is below `threshold`, w_0 in the units of w: `Damping::below(0.02).at_most(0.05)`.
    pub fn below(threshold: T) -> DampingBelow<T> {
        DampingBelow { threshold }
    }

    /// The threshold w_0 below which damping is active.
    pub fn threshold(&self) -> T {
        self.threshold
    }

    /// lambda of the factors of a Jacobian; `None` where w >= w_0.
    fn lambda<const M: usize, const N: usize>(&self, (factors, full_rank): &(RightInverse<T, M, N>, bool)) -> Option<T> {
        let w = if *full_rank { factors.volume() } else { T::zero() };
        // Not `w < ...`: a NaN is damped, and found by its solution.
        (!(w >= self.threshold)).then(|| self.factor * (T::one() - w / self.threshold))
    }

    /// lambda at `j`, 0 where damping is not active.
    pub(crate) fn at<const M: usize, const N: usize>(&self, j: &SMatrix<T, M, N>) -> T {
        self.lambda(&RightInverse::factor(j)).unwrap_or_else(T::zero)
    }

    /// J+ v, damped where w < w_0; `None` only where J, v or the result is not finite.
    pub fn solve<const M: usize, const N: usize>(&self, j: &SMatrix<T, M, N>, v: &SVector<T, M>) -> Option<Solution<T, N>> {
        let factors = RightInverse::factor(j);
        let Some(lambda) = self.lambda(&factors) else {
            return Some(Solution { x: factors.0.solve(v), damped: false });
        };
        let x = RightInverse::damped(j, lambda).solve(v);
        super::is_finite(&x).then_some(Solution { x, damped: true })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix2x3, Vector2};

    #[test]
    fn solves_with_least_norm_and_projects_on_the_null_space() {
        let j = Matrix2x3::new(1.0, 2.0, 3.0, -1.0, 0.5, 2.0);
        let inverse = RightInverse::new(&j).unwrap();
        let v = Vector2::new(0.3, -0.7);
        let x = inverse.solve(&v);
        assert!((j * x - v).norm() < 1e-15);
        assert!(inverse.null_space(&x).norm() < 1e-15, "least norm has no part in the null space");
        assert!((j * inverse.null_space(&nalgebra::Vector3::new(1.0, 1.0, 1.0))).norm() < 1e-14);
        let gram: nalgebra::Matrix2<f64> = j * j.transpose();
        assert!((inverse.volume() - gram.determinant().sqrt()).abs() < 1e-14);
        assert!((inverse.matrix() * v - x).norm() < 1e-15);
    }

    #[test]
    fn a_dependent_row_and_a_nan_are_singular() {
        assert!(RightInverse::new(&Matrix2x3::new(1.0, 2.0, 3.0, 2.0, 4.0, 6.0)).is_none());
        assert!(RightInverse::new(&Matrix2x3::new(1.0, 2.0, f64::NAN, 2.0, 4.0, 6.0)).is_none());
        assert!(RightInverse::new(&nalgebra::Matrix3x2::new(1.0, 2.0, 3.0, 2.0, 4.0, 7.0)).is_none(), "more rows than joints");
    }

    #[test]
    fn damping_bounds_the_solution() {
        let damping = Damping::below(0.1).at_most(0.05).unwrap();
        let v = Vector2::new(0.3, -0.7);
        for w in [1.0, 0.2, 0.05, 1e-3, 1e-9, 0.0] {
            let j = Matrix2x3::new(1.0, 0.0, 0.0, 0.0, w, 0.0);
            let s = damping.solve(&j, &v).unwrap();
            assert_eq!(s.damped, w < 0.1);
            let lambda = 0.05 * (1.0 - f64::min(w, 0.1) / 0.1);
            assert!(!s.damped || s.x.norm() <= v.norm() / (2.0 * lambda));
        }
        // By the normal equations, where these have digits to spare.
        let j = Matrix2x3::new(1.0, 2.0, 3.0, 1.0, 2.0, 3.1);
        let gram: Matrix2<f64> = j * j.transpose();
        let (w, damping) = (gram.determinant().sqrt(), Damping::below(1.0).at_most(0.2).unwrap());
        let lambda = 0.2 * (1.0 - w);
        let expected = j.transpose() * (gram + Matrix2::from_diagonal_element(lambda * lambda)).try_inverse().unwrap() * v;
        assert!((damping.solve(&j, &v).unwrap().x - expected).norm() < 1e-12 * expected.norm());
        assert!(damping.solve(&Matrix2x3::new(f64::NAN, 0.0, 0.0, 0.0, 1.0, 0.0), &v).is_none());
    }

    #[test]
    fn the_weakest_damping_has_a_solution() {
        // Dependent rows: J J' + lambda^2 I is singular to rounding. Here sigma_1^2 = 10, and along u_2 nothing is asked.
        let j = Matrix2x3::new(1.0, 0.0, 0.0, 3.0, 0.0, 0.0);
        for lambda in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15f64] {
            let damping = Damping::below(1e-3).at_most(lambda).unwrap();
            let s = damping.solve(&j, &Vector2::new(1.0, 3.0)).unwrap();
            assert!(
                s.damped && (s.x - nalgebra::Vector3::x() * (10.0 / (10.0 + lambda * lambda))).norm() < 1e-14,
                "{lambda}: {}",
                s.x
            );
        }
    }
}
