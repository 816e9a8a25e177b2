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

/// (cos, sin) of the sum of two angles.
pub(super) fn sum_of_angles([c, s]: &[Number; 2], [x, y]: &[Number; 2]) -> [Number; 2] {
    [&(c * x) - &(s * y), &(s * x) + &(c * y)]
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

/// Whether the axes z before and after a link are parallel.
pub(super) fn is_parallel(f: &Frame) -> bool {
    is_zero(&f[2][0]) && is_zero(&f[2][1])
}

/// Whether they are at right angles.
pub(super) fn is_right(f: &Frame) -> bool {
    is_zero(&f[2][2])
}

/// The turns about z beside one about x: R = Rz(t) Rx(alpha) Rz(t'), as (cos t, sin t) and (cos t', sin t'). None where the sine of alpha is a
/// root that has no form.
pub(super) fn turns_beside_x(f: &Frame) -> Option<[[Number; 2]; 2]> {
    let none = || [Number::one(), Number::zero()];
    // The rest if one of the turns is known: the first column, or the first row.
    let column = |f: &Frame| [f[0][0].clone(), f[1][0].clone()];
    let row = |f: &Frame| [f[0][0].clone(), -&f[0][1]];
    if is_zero(&f[2][0]) {
        return Some([column(f), none()]);
    }
    if is_zero(&f[0][2]) {
        return Some([none(), row(f)]);
    }
    // The third row is (s' sin alpha, c' sin alpha, cos alpha), the third column (s sin alpha, -c sin alpha, cos alpha).
    let back = |[c, s]: &[Number; 2]| turn_about_z(&[c.clone(), -s]);
    if let Some((second, _)) = polar(&f[2][1], &f[2][0]) {
        return Some([column(&compose(f, &back(&second))), second]);
    }
    let (first, _) = polar(&-&f[1][2], &f[0][2])?;
    let second = row(&compose(&back(&first), f));
    Some([first, second])
}

/// (cos t, sin t) and a with (x, y) = a (cos t, sin t). None where a is a root that has no form.
fn polar(x: &Number, y: &Number) -> Option<([Number; 2], Number)> {
    if is_zero(y) {
        return Some(([Number::one(), Number::zero()], x.clone()));
    }
    if is_zero(x) {
        return Some(([Number::zero(), Number::one()], y.clone()));
    }
    let a = (&(x * x) + &(y * y)).sqrt()?;
    Some(([x.checked_div(&a)?, y.checked_div(&a)?], a))
}

/// Rz(t) Tz(d) Tx(a) Rx(alpha) Rz(t') Tz(d') from one axis z to another.
pub(super) struct BetweenAxes {
    /// (cos t, sin t) and d.
    pub(super) before: ([Number; 2], Number),
    /// a and (cos alpha, sin alpha).
    pub(super) normal: (Number, [Number; 2]),
    /// (cos t', sin t') and d'.
    pub(super) after: ([Number; 2], Number),
}

/// A displacement by the common normal of the axes before and after it. `None` if it needs roots that have no form.
pub(super) fn between_axes(f: &Frame) -> Option<BetweenAxes> {
    let turned_back = |[c, s]: &[Number; 2]| compose(&turn_about_z(&[c.clone(), -s]), f);
    if is_parallel(f) {
        let (t, a) = polar(&f[0][3], &f[1][3])?;
        let rest = turned_back(&t);
        let (before, alpha) = ((t, f[2][3].clone()), [f[2][2].clone(), Number::zero()]);
        return Some(BetweenAxes { before, normal: (a, alpha), after: ([rest[0][0].clone(), -&rest[0][1]], Number::zero()) });
    }
    let [t, after] = turns_beside_x(f)?;
    let rest = turned_back(&t);
    let (c, s) = (&rest[2][2], -&rest[1][2]);
    let behind = (-&rest[1][3]).checked_div(&s)?;
    let d = &rest[2][3] - &(c * &behind);
    Some(BetweenAxes { before: (t, d), normal: (rest[0][3].clone(), [c.clone(), s]), after: (after, behind) })
}
