//! Vectors and 3×3 matrices of exact numbers.

use crate::values::element::Element;

/// x, y, z.
pub type Vector<E> = [E; 3];
/// `[row][column]`.
pub type Matrix<E> = [[E; 3]; 3];

/// a + b.
pub fn add<E: Element>(a: &Vector<E>, b: &Vector<E>) -> Vector<E> {
    [0, 1, 2].map(|i| a[i].plus(&b[i]))
}

/// a - b.
pub fn sub<E: Element>(a: &Vector<E>, b: &Vector<E>) -> Vector<E> {
    [0, 1, 2].map(|i| a[i].minus(&b[i]))
}

/// k a.
pub fn scale<E: Element>(k: &E, a: &Vector<E>) -> Vector<E> {
    [0, 1, 2].map(|i| k.times(&a[i]))
}

/// a · b.
pub fn dot<E: Element>(a: &Vector<E>, b: &Vector<E>) -> E {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

/// a × b.
pub fn cross<E: Element>(a: &Vector<E>, b: &Vector<E>) -> Vector<E> {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].times(&b[j]).minus(&a[j].times(&b[i])))
}

/// M a.
pub fn apply<E: Element>(m: &Matrix<E>, a: &Vector<E>) -> Vector<E> {
    [0, 1, 2].map(|i| dot(&m[i], a))
}

/// M N.
pub fn product<E: Element>(m: &Matrix<E>, n: &Matrix<E>) -> Matrix<E> {
    let columns = transpose(n);
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| dot(&m[i], &columns[j])))
}

/// M'.
pub fn transpose<E: Element>(m: &Matrix<E>) -> Matrix<E> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[j][i].clone()))
}

/// The solution of A X = R by elimination, with R as columns; `None` if A is singular.
pub fn solve<E: Element>(a: &[Vec<E>], right: &[Vec<E>]) -> Option<Vec<Vec<E>>> {
    let n = a.len();
    let mut rows: Vec<Vec<E>> = a.iter().zip(right).map(|(a, r)| [a.as_slice(), r.as_slice()].concat()).collect();
    for column in 0..n {
        let (pivot, inverse) = (column..n).find_map(|r| Some((r, rows[r][column].inverse()?)))?;
        rows.swap(column, pivot);
        rows[column].iter_mut().skip(column).for_each(|x| *x = x.times(&inverse));
        let pivot = rows[column].clone();
        for (r, row) in rows.iter_mut().enumerate() {
            if r != column && !row[column].is_zero() {
                let factor = row[column].clone();
                for (x, p) in row.iter_mut().zip(&pivot).skip(column) {
                    *x = x.minus(&factor.times(p));
                }
            }
        }
    }
    Some(rows.into_iter().map(|row| row[n..].to_vec()).collect())
}
