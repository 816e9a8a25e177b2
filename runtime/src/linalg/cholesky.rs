//! The Cholesky factorisation m = L L', and its two triangular solutions apart, which nalgebra gives together only.

use nalgebra::{RealField, SMatrix, SVector};

/// The lower triangular factor L of a symmetric positive definite matrix, m = L L'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cholesky<T, const N: usize> {
    l: SMatrix<T, N, N>,
}

impl<T: RealField + Copy, const N: usize> Cholesky<T, N> {
    /// Factors `m`, of which the lower triangle is read; `None` where it is not positive definite or not finite.
    pub fn new(m: &SMatrix<T, N, N>) -> Option<Self> {
        let mut l = SMatrix::<T, N, N>::zeros();
        for i in 0..N {
            for j in 0..=i {
                let mut sum = m[(i, j)];
                for k in 0..j {
                    sum -= l[(i, k)] * l[(j, k)];
                }
                if i > j {
                    l[(i, j)] = sum / l[(j, j)];
                } else if sum > T::zero() && sum.is_finite() {
                    l[(i, i)] = sum.sqrt();
                } else {
                    return None;
                }
            }
        }
        Some(Self { l })
    }

    /// L.
    pub fn factor(&self) -> &SMatrix<T, N, N> {
        &self.l
    }

    /// x of L x = v.
    pub fn forward(&self, v: &SVector<T, N>) -> SVector<T, N> {
        let mut x = *v;
        for i in 0..N {
            for k in 0..i {
                let x_k = x[k];
                x[i] -= self.l[(i, k)] * x_k;
            }
            x[i] /= self.l[(i, i)];
        }
        x
    }

    /// x of L' x = v.
    pub fn backward(&self, v: &SVector<T, N>) -> SVector<T, N> {
        let mut x = *v;
        for i in (0..N).rev() {
            for k in i + 1..N {
                let x_k = x[k];
                x[i] -= self.l[(k, i)] * x_k;
            }
            x[i] /= self.l[(i, i)];
        }
        x
    }

    /// x of m x = v.
    pub fn solve(&self, v: &SVector<T, N>) -> SVector<T, N> {
        self.backward(&self.forward(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    #[test]
    fn the_factor_and_its_solutions() {
        // L of small integers: every number is exact.
        let l = Matrix3::new(2.0, 0.0, 0.0, -1.0, 4.0, 0.0, 3.0, 1.0, 0.5);
        let factors = Cholesky::new(&(l * l.transpose())).unwrap();
        assert_eq!(*factors.factor(), l);
        let x = Vector3::new(1.0, -2.0, 4.0);
        assert_eq!(factors.forward(&(l * x)), x);
        assert_eq!(factors.backward(&(l.transpose() * x)), x);
        assert_eq!(factors.solve(&(l * l.transpose() * x)), x);
    }

    #[test]
    fn other_matrices_have_no_factor() {
        let diagonal = |d: [f64; 3]| Matrix3::from_diagonal(&Vector3::from(d));
        for d in [[1.0, 0.0, 1.0], [1.0, 1.0, -1.0], [f64::NAN, 1.0, 1.0], [1.0, f64::INFINITY, 1.0]] {
            assert!(Cholesky::new(&diagonal(d)).is_none(), "{d:?}");
        }
        assert!(Cholesky::new(&Matrix3::new(1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0)).is_none());
    }
}
