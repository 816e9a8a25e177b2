//! Derivatives by central differences.

use nalgebra::{RealField, SMatrix, SVector};

/// Jacobian of `f` at `x` by central differences.
pub(super) fn derivative<T: RealField + Copy, const N: usize, const M: usize>(
    x: &SVector<T, N>,
    f: impl Fn(&SVector<T, N>) -> SVector<T, M>,
) -> SMatrix<T, M, N> {
    let h = T::default_epsilon().cbrt();
    let mut jacobian = SMatrix::<T, M, N>::zeros();
    for i in 0..N {
        let (mut low, mut high) = (*x, *x);
        low[i] -= h;
        high[i] += h;
        jacobian.set_column(i, &((f(&high) - f(&low)) / (high[i] - low[i])));
    }
    jacobian
}
