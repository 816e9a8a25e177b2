//! Rigid displacements with exact entries, and whether a number is 0.

use std::cmp::Ordering;

use crate::exact::Number;
use crate::ring::field::Field;

/// A rigid displacement x -> R x + t: rows of (R | t).
pub type Frame = [[Number; 4]; 3];

/// Whether a number is 0. Numbers of one form are compared by it; of the others enclosures must hold 0, and the value in a prime field be 0.
/// Where they disagree the number counts as one that is not 0: the arm is then of a more general class, which loses nothing.
pub(super) fn is_zero(number: &Number) -> bool {
    if number.is_zero() || number.is_reduced() {
        return number.is_zero();
    }
    number.sign() == Ordering::Equal
        && Field::with_roots_of([number]).is_some_and(|mut field| field.number(number) == field.zero())
}

/// The displacement that moves nothing.
pub(super) fn identity() -> Frame {
    let (o, l) = (Number::zero, Number::one);
    [[l(), o(), o(), o()], [o(), l(), o(), o()], [o(), o(), l(), o()]]
}

/// Rz(theta) for (cos theta, sin theta).
pub(super) fn turn_about_z([c, s]: &[Number; 2]) -> Frame {
    let (o, l) = (Number::zero, Number::one);
    [[c.clone(), -s, o(), o()], [s.clone(), c.clone(), o(), o()], [o(), o(), l(), o()]]
}

/// Tz(d).
pub(super) fn slide_along_z(d: &Number) -> Frame {
    let mut slide = identity();
    slide[2][3] = d.clone();
    slide
}

/// The half turn about x.
pub(super) fn half_turn_about_x() -> Frame {
    let mut turn = identity();
    turn[1][1] = -&Number::one();
    turn[2][2] = -&Number::one();
    turn
}

/// First `g`, then `f`.
pub(super) fn compose(f: &Frame, g: &Frame) -> Frame {
    let entry = |i: usize, j: usize| {
        let sum = (0..3).fold(Number::zero(), |sum, k| &sum + &(&f[i][k] * &g[k][j]));
        if j == 3 {
            &sum + &f[i][3]
        } else {
            sum
        }
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// The displacement that undoes `f`.
pub(super) fn inverse(f: &Frame) -> Frame {
    let back = |i: usize| -&(0..3).fold(Number::zero(), |sum, k| &sum + &(&f[k][i] * &f[k][3]));
    std::array::from_fn(|i| std::array::from_fn(|j| if j == 3 { back(i) } else { f[j][i].clone() }))
}

/// Whether the axes z before and behind a link are parallel.
pub(super) fn is_parallel(f: &Frame) -> bool {
    is_zero(&f[2][0]) && is_zero(&f[2][1])
}

/// Whether they are at right angles.
pub(super) fn is_right(f: &Frame) -> bool {
    is_zero(&f[2][2])
}
