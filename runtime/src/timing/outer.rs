//! From above: x that no motion on the path exceeds.
//!
//! **Barrier.** Let X be a quadratic on a segment and one row with m > 0 and m U + c X + v sqrt(X) + d >= bound on all of it. A motion that
//! keeps the row has m u <= m U wherever x = X, so it does not cross X upwards: x <= X at the left end implies x <= X on the segment
//! (Walter, *Differential and Integral Inequalities*, 1970). The same with m < 0 from the right end. With m = 0, x <= X at every place.
//! Nothing here assumes that an optimum has been found, is smooth or is unique.

use super::curve::{Curve, Line};
use super::law::Law;
use super::limits::Limits;
use super::model::JointFriction;
use super::row::{Row, Window};
use super::segment::{Barrier, Column, Segment};
use crate::linalg::lit;
use nalgebra::RealField;

/// Rounding of what follows the functions, of the limit.
pub(super) const ROUNDING: f64 = 1e-11;

/// In place of infinity, so that differences stay numbers.
fn huge<T: RealField>() -> T {
    lit(1e30)
}

/// A row at a node.
#[derive(Clone, Copy)]
struct AtNode<T> {
    index: usize,
    m: T,
    c: T,
    v: T,
    rest: T,
    m_error: T,
}

/// What a node allows.
#[derive(Clone, Copy, Debug)]
pub(super) enum NodeBound<T> {
    /// x at most this.
    AtMost(T),
    /// No x, with the row that cannot be kept.
    Nothing(usize),
}

/// The largest x at a node for which some u keeps all rows, with the functions of both segments there.
pub(super) fn node_bound<T: RealField + Copy, const N: usize>(
    left: Option<&Segment<T, N>>,
    right: Option<&Segment<T, N>>,
    limits: &Limits<T, N>,
    friction: &[JointFriction<T>; N],
    side: &mut Side<T, N>,
) -> NodeBound<T> {
    let x = within_speeds::<_, N, 0>(right, limits, within_speeds::<_, N, 2>(left, limits, huge()));
    // u may jump at a node, as q'' and the signs of friction do: each side has an interval of its own.
    // Within a piece, and with the same signs, both have the same functions within their errors: one of them is enough.
    let is_smooth = left.zip(right).is_some_and(|(left, right)| left.piece == right.piece && left.signs == right.signs);
    let mut bound = NodeBound::AtMost(x);
    if let Some(segment) = left.filter(|_| !is_smooth) {
        side.fill::<2>(segment, limits, friction);
        bound = side.bound(x);
    }
    match (bound, right) {
        (NodeBound::AtMost(x), Some(segment)) => {
            side.fill::<0>(segment, limits, friction);
            side.bound(x)
        }
        _ => bound,
    }
}

/// What the limits of speed leave of an x at an end of a segment.
fn within_speeds<T: RealField + Copy, const N: usize, const END: usize>(
    segment: Option<&Segment<T, N>>,
    limits: &Limits<T, N>,
    mut x: T,
) -> T {
    let Some(segment) = segment else { return x };
    let tool = segment.tool.iter().zip(limits.tool.iter().flat_map(|tool| tool.both()));
    for (square, limit) in segment.rates[2].iter().zip(limits.velocity).chain(tool) {
        let c = square.quadratic[END] - square.error;
        if c > T::zero() {
            let bound = segment.most(limit);
            x = x.min((bound + bound * lit(ROUNDING)) / c);
        }
    }
    x
}

/// The rows with a slope at an end of a segment.
pub(super) struct Side<T, const N: usize> {
    /// `count` of them.
    rows: [[AtNode<T>; 4]; N],
    count: usize,
    curves: [[Option<Curve<T>>; 4]; N],
    curved: bool,
}

impl<T: RealField + Copy, const N: usize> Side<T, N> {
    /// Storage without content.
    pub(super) fn empty() -> Self {
        let zero = T::zero();
        let empty = AtNode { index: 0, m: zero, c: zero, v: zero, rest: zero, m_error: zero };
        Self { rows: [[empty; 4]; N], count: 0, curves: [[None; 4]; N], curved: false }
    }

    fn fill<const END: usize>(&mut self, segment: &Segment<T, N>, limits: &Limits<T, N>, friction: &[JointFriction<T>; N]) {
        (self.count, self.curved) = (0, false);
        segment.each_sloped(
            limits,
            friction,
            true,
            |_, _| true,
            |index, row| {
                let at = AtNode {
                    index,
                    m: row.m[END],
                    c: row.c[END] - row.c_error,
                    v: row.v[END],
                    rest: row.bound + row.bound.abs() * lit(ROUNDING) + row.d_error - row.d[END],
                    m_error: row.m_error,
                };
                self.curved |= row.is_curved();
                if let Some(to) = self.rows.as_flattened_mut().get_mut(self.count) {
                    *to = at;
                }
                if let Some(to) = self.curves.as_flattened_mut().get_mut(self.count) {
                    *to = row.curve.map(|curve| curve.at(END));
                }
                self.count += 1;
            },
        );
    }

    /// The largest x at most `x` for which some u keeps all rows of a node.
    fn bound(&mut self, x: T) -> NodeBound<T> {
        // A first solution tells how large u is, and so how much the errors of m count.
        let (first, u) = self.largest(x);
        let from = match first {
            // With these errors no row bounds more than without.
            NodeBound::AtMost(first) if first == x => return NodeBound::AtMost(x),
            NodeBound::AtMost(first) => x.min(first.max(T::zero()) * lit(1.0 + 1e-6)),
            NodeBound::Nothing(_) => x,
        };
        for row in self.rows.as_flattened_mut() {
            row.rest += row.m_error * u * lit(2.0);
        }
        self.largest(from).0
    }

    /// Newton from the right on the width of the interval of u, and |u| there.
    fn largest(&self, mut x: T) -> (NodeBound<T>, T) {
        let curved = self.curved;
        // With friction that is no line the width is bounded from above on [x (1 - share), x].
        let mut share = T::one();
        let mut size = T::zero();
        for _ in 0..200 {
            let low = if curved { x * (T::one() - share) } else { T::zero() };
            let (above, below) = (Line::tangent(x.max(lit(1e-30)).sqrt()), Line::chord(low, x));
            // u of the row that bounds it most at x, its value at x = 0 and its slope, and the row.
            let mut high = (huge::<T>(), huge::<T>(), T::zero(), 0);
            let mut least = (-huge::<T>(), -huge::<T>(), T::zero(), 0);
            let mut flat: Option<(T, usize)> = None;
            let rows = self.rows.as_flattened().get(..self.count).unwrap_or(&[]);
            for (row, curve) in rows.iter().zip(self.curves.as_flattened()) {
                let (index, mut c, mut rest) = (row.index, row.c, row.rest);
                if curved {
                    let line = if row.v > T::zero() { below } else { above };
                    (c, rest) = (c + row.v * line.slope, rest - row.v * line.height);
                    if let Some(curve) = curve {
                        let (line, rounding) = curve.line([low, x], x, false);
                        c += line.slope * curve.square[0];
                        rest -= line.height - rounding;
                    }
                }
                if row.m == T::zero() {
                    // No u helps: c x <= rest.
                    if c * x > rest {
                        let at = if c > T::zero() { rest / c } else { -T::one() };
                        if flat.is_none_or(|(most, _)| at < most) {
                            flat = Some((at, index));
                        }
                    }
                    continue;
                }
                let u = (rest - c * x) / row.m;
                if row.m > T::zero() {
                    if u < high.0 {
                        high = (u, rest / row.m, -c / row.m, index);
                    }
                } else if u > least.0 {
                    least = (u, rest / row.m, -c / row.m, index);
                }
            }
            size = if high.0 < huge() { high.0.abs() } else { T::zero() };
            size = size.max(if least.0 > -huge::<T>() { least.0.abs() } else { T::zero() });
            let width = high.0 - least.0;
            let (mut next, mut culprit) = (x, high.3);
            if let Some((at, index)) = flat {
                (next, culprit) = (at, index);
            } else if width < T::zero() {
                let slope = high.2 - least.2;
                // The row that gravity or friction breaks by itself is the one with the smaller share of m.
                if least.2.abs() > high.2.abs() {
                    culprit = least.3;
                }
                // Where both rows meet, and not a step from x: from a huge x that rounds by more than the result.
                next = if slope < T::zero() { (high.1 - least.1) / -slope } else { -T::one() };
            }
            if next >= x * (T::one() - T::default_epsilon() * lit(16.0)) {
                return (NodeBound::AtMost(x), size);
            }
            if next < low {
                if low <= T::zero() {
                    return (NodeBound::Nothing(culprit), size);
                }
                x = low;
                continue;
            }
            if curved {
                share = share.min((T::one() - next / x) * lit(4.0));
            }
            x = next;
        }
        (NodeBound::AtMost(x), size)
    }
}

/// A barrier of a row from `x0` at its left end with the least x at its right end, near the estimate `x2`.
fn barrier<T: RealField + Copy>(row: &Row<T>, h: T, x0: T, estimate: T) -> Option<Law<T>> {
    if !row.m.iter().all(|m| *m > row.m_error) {
        return None;
    }
    let half = lit::<T>(0.5);
    let mut law = Law { length: h, x0, k: T::zero(), x2: estimate };
    let slack = row.bound.abs() * lit(ROUNDING);
    // How far the coefficients of the law may lie outside what the line over the root and the error assume.
    let mut margin = lit::<T>(1e-2);
    for _ in 0..8 {
        let coefficients = [law.x0, law.middle(), law.x2];
        let most = coefficients.iter().fold(T::zero(), |m, x| m.max(x.abs())) * (T::one() + margin);
        let least = coefficients.iter().fold(most, |m, x| m.min(*x)).max(T::zero()) * (T::one() - margin);
        let slope = law.acceleration().iter().fold(T::zero(), |m, u| m.max(u.abs())) * lit(1.1);
        if !(most > T::zero()) {
            return None;
        }
        let target = row.bound + slack + row.m_error * slope + row.c_error * most + row.v_error * most.sqrt() + row.d_error;
        let straight = || row.straight(&Window::new([least, most], (least + most) * half), false);
        let forms = if row.is_curved() { straight().forms(h) } else { row.forms(h) };
        let needs = forms.map(|form| target - form.rest - form.x0 * x0);
        let [first, last] = [forms[0], forms[4]];
        let determinant = first.x2 * last.k - first.k * last.x2;
        if determinant == T::zero() {
            return None;
        }
        law.k = (first.x2 * needs[4] - last.x2 * needs[0]) / determinant;
        let mut x2 = -huge::<T>();
        for (form, need) in forms.iter().zip(needs) {
            if !(form.x2 > T::zero()) {
                return None;
            }
            x2 = x2.max((need - form.k * law.k) / form.x2);
        }
        law.x2 = x2;
        if !x2.is_finite() {
            return None;
        }
        let coefficients = [law.x0, law.middle(), law.x2];
        // Where the law ends below zero, nothing gets to its zero, and before that the chord from zero holds.
        let is_below = x2 < T::zero() && least == T::zero();
        let reaches = |x: T| x.abs() <= most && (x >= least || is_below || !row.is_curved());
        let kept = coefficients.iter().all(|x| reaches(*x)) && law.acceleration().iter().all(|u| u.abs() <= slope);
        if kept && (is_below || !row.is_curved() || law.middle() >= T::zero()) {
            return Some(law);
        }
        margin = (margin * lit(2.0)).min(half);
    }
    None
}

/// The least barrier from `x0` at the left end, or seen from the other end if `BACK`.
pub(super) fn least<T: RealField + Copy, const N: usize, const BACK: bool>(
    segment: &Segment<T, N>,
    limits: &Limits<T, N>,
    friction: &[JointFriction<T>; N],
    x0: T,
) -> Option<Barrier<T>> {
    let h = segment.length;
    // m > 0, seen from where the barrier begins, on all of the segment.
    let is_barrier = |m: &Column<T>, side: usize| {
        let positive = (side == 0) != BACK;
        m.quadratic.iter().all(|value| if positive { *value > m.error } else { *value < -m.error })
    };
    // Rows in the order of what Euler and the trapezoidal rule say.
    let mut estimates = [[(huge::<T>(), 0); 4]; N];
    let mut count = 0;
    segment.each_sloped(limits, friction, true, is_barrier, |index, row| {
        let (from, to, sign) = if BACK { (2, 0, -T::one()) } else { (0, 2, T::one()) };
        let u = |end: usize, x: T| (row.bound - row.d[end] - row.c[end] * x - row.curved(end, x)) / (row.m[end] * sign);
        let first = u(from, x0);
        if let Some(estimate) = estimates.as_flattened_mut().get_mut(count) {
            *estimate = (x0 + h * (first + u(to, x0 + first * h * lit(2.0))), index);
            count += 1;
        }
    });
    let mut best: Option<Barrier<T>> = None;
    for _ in 0..count {
        let mut next = (huge::<T>(), 0);
        let mut place = None;
        for estimate in estimates.as_flattened_mut().iter_mut().take(count) {
            if estimate.0 < next.0 {
                next = *estimate;
                place = Some(estimate);
            }
        }
        let ((value, index), Some(estimate)) = (next, place) else { break };
        if best.is_some_and(|b| value > b.law.x2) {
            break;
        }
        estimate.0 = huge();
        let row = segment.row(index, limits, friction, true).map(|row| if BACK { row.reversed() } else { row });
        if let Some(law) = row.and_then(|row| barrier(&row, h, x0, value)) {
            if best.is_none_or(|b| law.x2 < b.law.x2) {
                best = Some(Barrier { law, row: index });
            }
        }
    }
    best
}

/// The bound of the speed that is least in the middle, at every place of the segment.
pub(super) fn speed<T: RealField + Copy, const N: usize>(
    segment: &Segment<T, N>,
    limits: &Limits<T, N>,
    friction: &[JointFriction<T>; N],
) -> Option<Barrier<T>> {
    let two = lit::<T>(2.0);
    let mut best: Option<(T, usize, Row<T>)> = None;
    for index in Segment::<T, N>::SLOPED..Segment::<T, N>::ROWS {
        let Some(row) = segment.row(index, limits, friction, true) else { continue };
        let middle = (row.c[0] + row.c[1] * two + row.c[2]) / row.bound;
        if middle > T::zero() && best.as_ref().is_none_or(|(most, ..)| middle > *most) {
            best = Some((middle, index, row));
        }
    }
    let (_, index, row) = best?;
    if !row.c.iter().all(|c| *c > row.c_error * two) {
        return None;
    }
    let middle = (row.c[0] + row.c[1] * two + row.c[2]) * lit(0.25);
    let (x0, x2) = (row.bound / row.c[0], row.bound / row.c[2]);
    let mut law = Law { length: segment.length, x0, k: (row.bound / middle - (x0 + x2) * lit(0.5)) * two, x2 };
    let most = x0.max(x2).max(law.middle()) * two;
    let target = row.bound * (T::one() + lit(ROUNDING)) + row.c_error * most;
    let mut scale = T::one();
    for form in row.forms(segment.length) {
        let value = form.x0 * law.x0 + form.x2 * law.x2 + form.k * law.k;
        if !(value > T::zero()) {
            return None;
        }
        scale = scale.max(target / value);
    }
    if !(scale < two) {
        return None;
    }
    law = Law { x0: law.x0 * scale, k: law.k * scale, x2: law.x2 * scale, ..law };
    Some(Barrier { law, row: index })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// m u + x <= 1 bounds x where m is above its error on all of the segment, and nowhere else.
    #[test]
    fn a_barrier_needs_an_inertial_term_of_one_sign() {
        let of = |m: [f64; 3], m_error: f64| {
            let (c, none) = ([1.0; 3], [0.0; 3]);
            let row = Row { m, c, v: none, d: none, m_error, c_error: 0.0, v_error: 0.0, d_error: 0.0, bound: 1.0, curve: None };
            barrier(&row, 0.1, 0.2, 0.3)
        };
        let law = of([0.2; 3], 0.0).expect("a barrier");
        // x' = 2 (1 - x)/m from x = 0.2, or more.
        let exact = 1.0 - 0.8 * (-2.0f64 * 0.1 / 0.2).exp();
        assert!(law.x2 >= exact && law.x2 < exact + 0.05, "{} {exact}", law.x2);
        assert!(of([0.2, 0.1, -0.01], 0.0).is_none() && of([-0.01, 0.1, 0.2], 0.0).is_none());
        assert!(of([0.2; 3], 0.25).is_none());
    }
}
