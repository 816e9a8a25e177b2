//! Singular values and left singular vectors by one-sided Jacobi rotations.
//!
//! Rotations U' applied to the rows of J make them orthogonal: U' J = diag(sigma) V'. Then J J' = U diag(sigma^2) U'.
//! Working on J itself keeps small singular values accurate, where the eigenvalues of J J' would lose half the digits
//! (Hestenes, 1958; Demmel, Veselic, 1992).

use super::lit;
use nalgebra::{RealField, SMatrix, SVector};

/// J J' = U diag(sigma^2) U'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftSingular<T, const M: usize> {
    /// Singular values, largest first.
    pub sigma: SVector<T, M>,
    /// The left singular vectors in the columns, in the order of `sigma`; orthogonal.
    pub u: SMatrix<T, M, M>,
}

/// Sweeps over all pairs of rows: quadratic convergence makes six to eight typical, the bound ends the loop on numbers that are not finite.
const SWEEPS: usize = 40;

/// Singular values and left singular vectors of J, M x N, for any M and N (with M > N, M - N of them are zero).
///
/// Errors: none; where J is not finite, neither is the result.
pub fn left_singular<T: RealField + Copy, const M: usize, const N: usize>(j: &SMatrix<T, M, N>) -> LeftSingular<T, M> {
    // Rows as columns: nalgebra stores by column.
    let mut rows: SMatrix<T, N, M> = j.transpose();
    let mut u = SMatrix::<T, M, M>::identity();
    let tolerance = T::default_epsilon();
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..M {
            for q in p + 1..M {
                let alpha = rows.column(p).norm_squared();
                let beta = rows.column(q).norm_squared();
                let gamma = rows.column(p).dot(&rows.column(q));
                if gamma.abs() <= tolerance * (alpha * beta).sqrt() || gamma == T::zero() {
                    continue;
                }
                rotated = true;
                let zeta = (beta - alpha) / (lit::<T>(2.0) * gamma);
                let sign = if zeta < T::zero() { -T::one() } else { T::one() };
                let t = sign / (zeta.abs() + (T::one() + zeta * zeta).sqrt());
                let c = T::one() / (T::one() + t * t).sqrt();
                let s = c * t;
                rotate(&mut rows, p, q, c, s);
                rotate(&mut u, p, q, c, s);
            }
        }
        if !rotated {
            break;
        }
    }
    let mut sigma = SVector::<T, M>::from_fn(|i, _| rows.column(i).norm());
    for i in 0..M {
        let mut largest = i;
        for k in i + 1..M {
            if sigma[k] > sigma[largest] {
                largest = k;
            }
        }
        sigma.swap_rows(i, largest);
        u.swap_columns(i, largest);
    }
    LeftSingular { sigma, u }
}

fn rotate<T: RealField + Copy, const R: usize, const C: usize>(m: &mut SMatrix<T, R, C>, p: usize, q: usize, c: T, s: T) {
    for i in 0..R {
        let (a, b) = (m[(i, p)], m[(i, q)]);
        m[(i, p)] = c * a - s * b;
        m[(i, q)] = s * a + c * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3, Matrix3x4, Vector2, Vector3};

    #[test]
    fn rebuilds_the_gram_matrix() {
        let j = Matrix3x4::new(1.0, 2.0, 3.0, -1.0, 0.5, 2.0, 7.0, 1.0, 1.5, -0.5, 0.25, 3.0);
        let s = left_singular(&j);
        let gram: Matrix3<f64> = j * j.transpose();
        let back = s.u * Matrix3::from_diagonal(&s.sigma.component_mul(&s.sigma)) * s.u.transpose();
        assert!((gram - back).norm() < 1e-13 * gram.norm());
        assert!((s.u.transpose() * s.u - Matrix3::identity()).norm() < 1e-15);
        assert!(s.sigma[0] >= s.sigma[1] && s.sigma[1] >= s.sigma[2]);
    }

    #[test]
    fn small_singular_values_keep_their_digits() {
        // diag(1, 1e-12) turned on the left: eigenvalues of J J' would give 1e-12 with no digit right.
        let (c, s) = (0.6, 0.8);
        let j = Matrix2::new(c, -s, s, c) * Matrix2::from_diagonal(&Vector2::new(1.0, 1e-12));
        assert!((left_singular(&j).sigma[1] / 1e-12 - 1.0f64).abs() < 1e-4);
    }

    #[test]
    fn a_nan_ends() {
        assert!(!left_singular(&Matrix3::from_diagonal(&Vector3::new(1.0, f64::NAN, 2.0))).sigma.iter().all(|x| x.is_finite()));
    }
}
