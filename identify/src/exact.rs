//! Small matrices of fractions: what proofs about bodies need.

use std::cmp::Ordering;

use armgen_codegen::exact::{Number, Rational};

/// A square or rectangular matrix, row by row.
pub type Matrix = Vec<Vec<Rational>>;

/// A float as the fraction that it is; none of NaN and infinities.
pub fn fraction(x: f64) -> Option<Rational> {
    Rational::try_from(x).ok()
}

/// The nearest float.
pub fn float(x: &Rational) -> f64 {
    Number::from(x.clone()).to_f64()
}

/// Whether it is above 0.
pub fn is_positive(x: &Rational) -> bool {
    x.cmp(&Rational::ZERO) == Ordering::Greater
}

/// Whether it is below 0.
pub fn is_negative(x: &Rational) -> bool {
    x.cmp(&Rational::ZERO) == Ordering::Less
}

/// a'b.
pub fn dot(a: &[Rational], b: &[Rational]) -> Rational {
    let filled = a.iter().zip(b).filter(|(a, b)| **a != Rational::ZERO && **b != Rational::ZERO);
    filled.fold(Rational::ZERO, |sum, (a, b)| sum + a * b)
}

/// The pivots of LDL' of a symmetric matrix up to the first that is not positive, which is the last.
pub fn pivots(matrix: &Matrix) -> Vec<Rational> {
    let mut rest = matrix.clone();
    let mut pivots = Vec::new();
    for k in 0..rest.len() {
        let pivot = rest[k][k].clone();
        pivots.push(pivot.clone());
        if !is_positive(&pivot) {
            break;
        }
        for i in k + 1..rest.len() {
            let factor = &rest[i][k] / &pivot;
            for j in k + 1..rest.len() {
                let part = &factor * &rest[k][j];
                rest[i][j] = &rest[i][j] - part;
            }
        }
    }
    pivots
}

/// Whether a symmetric matrix is positive definite.
pub fn is_definite(matrix: &Matrix) -> bool {
    pivots(matrix).iter().all(is_positive)
}

/// The solution of A X = B for a positive definite A.
pub fn solve(a: &Matrix, b: &Matrix) -> Matrix {
    let (mut a, mut x) = (a.clone(), b.clone());
    for k in 0..a.len() {
        let pivot = a[k][k].clone();
        a[k].iter_mut().chain(&mut x[k]).for_each(|entry| *entry = &*entry / &pivot);
        let (row, right) = (a[k].clone(), x[k].clone());
        for i in (0..a.len()).filter(|&i| i != k) {
            let factor = a[i][k].clone();
            let pairs = a[i].iter_mut().zip(&row).chain(x[i].iter_mut().zip(&right));
            pairs.for_each(|(entry, of)| *entry = &*entry - &factor * of);
        }
    }
    x
}

/// The inverse of a positive definite matrix.
pub fn inverse(a: &Matrix) -> Matrix {
    let unit = |i, j| if i == j { Rational::ONE } else { Rational::ZERO };
    solve(a, &(0..a.len()).map(|i| (0..a.len()).map(|j| unit(i, j)).collect()).collect())
}

/// tr(A B) of symmetric matrices.
pub fn trace_of_product(a: &Matrix, b: &Matrix) -> Rational {
    a.iter().zip(b).fold(Rational::ZERO, |sum, (a, b)| sum + dot(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: &[&[i64]]) -> Matrix {
        rows.iter().map(|row| row.iter().map(|x| Rational::from(*x)).collect()).collect()
    }

    #[test]
    fn pivots_and_inverses_are_those_of_the_book() {
        let a = matrix(&[&[4, 2, 0], &[2, 5, 3], &[0, 3, 6]]);
        let of = |a: i64, b: u32| Rational::from_parts(a.into(), b.into());
        assert_eq!(pivots(&a), [of(4, 1), of(4, 1), of(15, 4)]);
        assert!(is_definite(&a) && !is_definite(&matrix(&[&[1, 2], &[2, 4]])));
        let inverse = inverse(&a);
        for i in 0..3 {
            for j in 0..3 {
                let column: Vec<Rational> = (0..3).map(|k| inverse[k][j].clone()).collect();
                assert_eq!(dot(&a[i], &column), Rational::from(i64::from(i == j)));
            }
        }
        assert_eq!(trace_of_product(&a, &inverse), Rational::from(3));
    }
}
