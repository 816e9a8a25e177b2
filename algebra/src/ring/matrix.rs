//! Small vectors and matrices of expressions.

use super::{ExprId, Pool};

/// A vector of three expressions.
pub type Vector = [ExprId; 3];
/// A 3 x 3 matrix of expressions, `[row][column]`.
pub type Matrix = [[ExprId; 3]; 3];

/// 0.
pub const ZERO: Vector = [ExprId::ZERO; 3];
/// The identity.
pub const IDENTITY: Matrix = [
    [ExprId::ONE, ExprId::ZERO, ExprId::ZERO],
    [ExprId::ZERO, ExprId::ONE, ExprId::ZERO],
    [ExprId::ZERO, ExprId::ZERO, ExprId::ONE],
];

impl Pool {
    /// a + b.
    pub fn add_vectors(&mut self, a: &Vector, b: &Vector) -> Vector {
        [0, 1, 2].map(|i| self.add(a[i], b[i]))
    }

    /// a - b.
    pub fn sub_vectors(&mut self, a: &Vector, b: &Vector) -> Vector {
        [0, 1, 2].map(|i| self.sub(a[i], b[i]))
    }

    /// s a.
    pub fn scale(&mut self, s: ExprId, a: &Vector) -> Vector {
        a.map(|x| self.mul(s, x))
    }

    /// a · b.
    pub fn dot3(&mut self, a: &Vector, b: &Vector) -> ExprId {
        self.dot(a, b)
    }

    /// a × b.
    pub fn cross(&mut self, a: &Vector, b: &Vector) -> Vector {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
            let (left, right) = (self.mul(a[i], b[j]), self.mul(a[j], b[i]));
            self.sub(left, right)
        })
    }

    /// M a.
    pub fn transform(&mut self, m: &Matrix, a: &Vector) -> Vector {
        m.map(|row| self.dot(&row, a))
    }

    /// M' a.
    pub fn transform_back(&mut self, m: &Matrix, a: &Vector) -> Vector {
        self.transform(&transpose(m), a)
    }

    /// A B.
    pub fn product(&mut self, a: &Matrix, b: &Matrix) -> Matrix {
        let columns = transpose(b);
        a.map(|row| columns.map(|column| self.dot(&row, &column)))
    }

    /// A + B.
    pub fn add_matrices(&mut self, a: &Matrix, b: &Matrix) -> Matrix {
        [0, 1, 2].map(|i| self.add_vectors(&a[i], &b[i]))
    }
}

/// M'.
pub fn transpose(m: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[j][i]))
}

/// The matrix of a ×.
pub fn skew(a: &Vector) -> Matrix {
    let zero = ExprId::ZERO;
    [[zero, -a[2], a[1]], [a[2], zero, -a[0]], [-a[1], a[0], zero]]
}
