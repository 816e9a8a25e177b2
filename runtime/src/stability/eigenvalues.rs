//! Eigenvalues of a general real matrix: Hessenberg form, then implicit double-shift QR steps (Francis, 1961; Golub, Van Loan,
//! *Matrix Computations*, Alg. 7.5.1) with exceptional shifts.
//!
//! Decoupled loops with equal gains have equal eigenvalues. On these, steps with the usual shifts alone may cycle for ever, as in
//! nalgebra's Schur decomposition. So every tenth step without success takes another shift.

use crate::linalg::lit;
use nalgebra::{linalg::Hessenberg, DMatrix, RealField};

/// Steps for one eigenvalue, beyond which something is wrong with the matrix.
const STEPS: u32 = 300;

/// The moduli of all eigenvalues of `m`, in no particular order; `None` if they were not found.
pub(super) fn moduli<T: RealField + Copy>(m: DMatrix<T>) -> Option<Vec<T>> {
    let n = m.nrows();
    let mut found = Vec::with_capacity(n);
    if n == 0 {
        return Some(found);
    }
    let mut h = if n > 2 { Hessenberg::new(m).unpack_h() } else { m };
    let size = h.iter().fold(T::zero(), |sum, x| sum + x.abs());
    let mut steps = 0;
    // low..end is the active block; all eigenvalues beyond `end` are found.
    let mut end = n;
    while end > 0 {
        let last = end - 1;
        let low = deflate(&mut h, last, size);
        if low == last {
            found.push(h[(last, last)].abs());
            end -= 1;
            steps = 0;
        } else if low + 1 == last {
            found.extend(pair(h[(low, low)], h[(low, last)], h[(last, low)], h[(last, last)]));
            end -= 2;
            steps = 0;
        } else {
            steps += 1;
            if steps > STEPS || !h[(last, last)].is_finite() {
                return None;
            }
            francis(&mut h, low, last, steps % 10 == 0);
        }
    }
    Some(found)
}

/// Start of the last block that does not fall apart: clears the subdiagonal element before it, which is negligible.
fn deflate<T: RealField + Copy>(h: &mut DMatrix<T>, last: usize, size: T) -> usize {
    for k in (1..=last).rev() {
        let neighbours = h[(k - 1, k - 1)].abs() + h[(k, k)].abs();
        let scale = if neighbours > T::zero() { neighbours } else { size };
        if h[(k, k - 1)].abs() <= T::default_epsilon() * scale {
            h[(k, k - 1)] = T::zero();
            return k;
        }
    }
    0
}

/// Moduli of the eigenvalues of [[a, b], [c, d]].
fn pair<T: RealField + Copy>(a: T, b: T, c: T, d: T) -> [T; 2] {
    let half = lit::<T>(0.5);
    let (middle, p) = ((a + d) * half, (a - d) * half);
    let discriminant = p * p + b * c;
    if discriminant < T::zero() {
        return [middle.hypot((-discriminant).sqrt()); 2];
    }
    let root = discriminant.sqrt();
    [(middle + root).abs(), (middle - root).abs()]
}

/// One double step on the block low..=last of a Hessenberg matrix, at least three rows high.
fn francis<T: RealField + Copy>(h: &mut DMatrix<T>, low: usize, last: usize, exceptional: bool) {
    // The shifts are the eigenvalues of [[a, b], [c, d]].
    let (a, b, c, d) = if exceptional {
        let size = h[(last, last - 1)].abs() + h[(last - 1, last - 2)].abs();
        let a = h[(last, last)] + lit::<T>(0.75) * size;
        (a, -lit::<T>(0.4375) * size, size, a)
    } else {
        (h[(last - 1, last - 1)], h[(last - 1, last)], h[(last, last - 1)], h[(last, last)])
    };
    // First column of (H - shift)(H - other shift), divided by its subdiagonal element, in differences: eigenvalues that nearly
    // coincide leave nothing of it otherwise.
    let (h00, h10) = (h[(low, low)], h[(low + 1, low)]);
    let (r, s) = (a - h00, d - h00);
    let mut x = [(r * s - b * c) / h10 + h[(low, low + 1)], h[(low + 1, low + 1)] - h00 - r - s, h[(low + 2, low + 1)]];
    for k in low..last {
        let rows = if k + 2 <= last { 3 } else { 2 };
        reflect(h, &x[..rows], k, k.saturating_sub(1).max(low)..=last, low..=(k + 3).min(last));
        x = [
            h[(k + 1, k)],
            if k + 2 <= last { h[(k + 2, k)] } else { T::zero() },
            if k + 3 <= last { h[(k + 3, k)] } else { T::zero() },
        ];
    }
}

/// The reflection that turns `x` onto its first axis, applied to rows k.. and columns k.. of `h`.
fn reflect<T: RealField + Copy>(
    h: &mut DMatrix<T>,
    x: &[T],
    k: usize,
    columns: core::ops::RangeInclusive<usize>,
    rows: core::ops::RangeInclusive<usize>,
) {
    // Scaled: squares of tiny elements would vanish.
    let scale = x.iter().fold(T::zero(), |sum, x| sum + x.abs());
    if !(scale > T::zero()) {
        return;
    }
    let mut v = [T::zero(); 3];
    v.iter_mut().zip(x).for_each(|(v, x)| *v = *x / scale);
    let norm = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v[0] += if v[0] < T::zero() { -norm } else { norm };
    let beta = lit::<T>(2.0) / (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    let v = &v[..x.len()];
    for j in columns {
        let along = v.iter().enumerate().fold(T::zero(), |sum, (i, v)| sum + *v * h[(k + i, j)]) * beta;
        v.iter().enumerate().for_each(|(i, v)| h[(k + i, j)] -= along * *v);
    }
    for i in rows {
        let along = v.iter().enumerate().fold(T::zero(), |sum, (j, v)| sum + *v * h[(i, k + j)]) * beta;
        v.iter().enumerate().for_each(|(j, v)| h[(i, k + j)] -= along * *v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(n: usize, m: &[f64], expected: &[f64], tolerance: f64) {
        let mut found = moduli(DMatrix::from_row_slice(n, n, m)).unwrap();
        found.sort_by(f64::total_cmp);
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() <= tolerance, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn known_spectra() {
        check(1, &[-3.0], &[3.0], 0.0);
        check(2, &[0.0, -2.0, 2.0, 0.0], &[2.0, 2.0], 0.0);
        check(3, &[1.0, 2.0, 3.0, 0.0, -4.0, 5.0, 0.0, 0.0, 2.0], &[1.0, 2.0, 4.0], 1e-14);
        // Companion of (z - 1)(z - 2)(z - 3)(z - 4)(z - 5).
        let companion = [
            15.0, -85.0, 225.0, -274.0, 120.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
            0.0, 0.0, 1.0, 0.0,
        ];
        check(5, &companion, &[1.0, 2.0, 3.0, 4.0, 5.0], 1e-11);
    }

    #[test]
    fn a_cycle_needs_exceptional_shifts() {
        // z^n = 1: without exceptional shifts nothing moves.
        for n in [3, 4, 7, 12] {
            let cycle = DMatrix::from_fn(n, n, |i, j| if i == (j + 1) % n { 1.0 } else { 0.0 });
            let found = moduli::<f64>(cycle).unwrap();
            assert!(found.len() == n && found.iter().all(|x| (x - 1.0).abs() < 1e-14), "{found:?}");
        }
    }

    #[test]
    fn similar_matrices_share_their_spectrum() {
        // diag(.9, .9, .5, -.7 +- .3i) under a full similarity transformation, repeated eigenvalue included.
        let mut d = DMatrix::<f64>::from_diagonal(&nalgebra::DVector::from_vec(vec![0.9, 0.9, 0.5, -0.7, -0.7]));
        (d[(3, 4)], d[(4, 3)]) = (0.3, -0.3);
        let t = DMatrix::from_fn(5, 5, |i, j| 1.0 / (1.0 + i as f64 + j as f64) + if i == j { 1.0 } else { 0.0 });
        let m = &t * d * t.clone().try_inverse().unwrap();
        let mut found = moduli(m).unwrap();
        found.sort_by(f64::total_cmp);
        let complex = 0.7f64.hypot(0.3);
        for (a, b) in found.iter().zip([0.5, complex, complex, 0.9, 0.9]) {
            assert!((a - b).abs() < 1e-13, "{found:?}");
        }
    }

    #[test]
    fn equal_eigenvalues_under_rounding() {
        // Four integrals of one rate: c I, except for roundings.
        let noise = |i: usize, j: usize| if i == j { 0.999996 } else { (i as f64 - 1.3 * j as f64) * 4e-16 };
        let found = moduli(DMatrix::<f64>::from_fn(4, 4, noise)).unwrap();
        assert!(found.len() == 4 && found.iter().all(|x| (x - 0.999996).abs() < 1e-14), "{found:?}");
    }

    #[test]
    fn what_is_not_finite_has_no_spectrum() {
        assert!(moduli(DMatrix::from_element(4, 4, f64::NAN)).is_none());
    }
}
