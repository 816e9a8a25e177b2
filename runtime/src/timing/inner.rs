//! From below: a motion that keeps every row on every segment.
//!
//! On a segment a row has five Bernstein coefficients, linear in X0 and X2 once k is chosen: half-planes. Backwards, the interval of the X0
//! from which some X2 in the next interval keeps all of them; forwards, the largest X2. So x is found as by reachability analysis
//! (Pham, Pham, *IEEE T-RO* 34, 2018), and every limit holds between nodes.
//! Friction that is no line over x is replaced, on the side that counts, by a tangent or a chord.

use super::limits::Limits;
use super::model::JointFriction;
use super::outer::ROUNDING;
use super::row::{Form, Row, Window};
use super::segment::{Assumed, Segment};
use crate::linalg::lit;
use nalgebra::RealField;

/// x0 X0 + x2 X2 <= most.
#[derive(Clone, Copy)]
pub(super) struct HalfPlane<T> {
    x0: T,
    x2: T,
    most: T,
}

impl<T: RealField + Copy> HalfPlane<T> {
    /// Of a form at most 0.
    pub(super) fn of(form: &Form<T>, k: T) -> Self {
        Self { x0: form.x0, x2: form.x2, most: -form.rest - form.k * k }
    }
}

/// The forms of row `index`, at most 0 on the segment; `None` where its limit is infinite or cannot bind.
pub(super) fn of_row<T: RealField + Copy, const N: usize>(
    segment: &Segment<T, N>,
    index: usize,
    limits: &Limits<T, N>,
    friction: &[JointFriction<T>; N],
    assumed: &Assumed<T>,
    window: &Window<T>,
) -> Option<[Form<T>; 5]> {
    let most = assumed.x[1];
    let row = segment.row(index, limits, friction, false)?;
    let slack = row.bound.abs() * lit(ROUNDING) + row.m_error * assumed.u + row.v_error * most.sqrt() + row.d_error;
    // Speed that the bound does not reach.
    if index >= Segment::<T, N>::SLOPED && row.c.iter().all(|c| (*c + row.c_error) * most <= row.bound * lit(1.0 - 1e-6)) {
        return None;
    }
    // x >= 0, so the error of c is a part of c.
    let mut row = Row { c: row.c.map(|c| c + row.c_error), ..row };
    if row.is_curved() {
        row = row.straight(window, true);
    }
    let bound = row.bound - slack;
    Some(row.forms(segment.length).map(|form| Form { rest: form.rest - bound, ..form }))
}

/// The half-planes of the middle coefficient, of u and of the interval at the end, for k: those from above and from below.
pub(super) fn others<T: RealField + Copy>(h: T, k: T, assumed: &Assumed<T>, next: [T; 2]) -> [[HalfPlane<T>; 4]; 2] {
    let (zero, one, half) = (T::zero(), T::one(), lit::<T>(0.5));
    let ([least, most], u) = (assumed.x, assumed.u);
    let (g, bend) = (half / h, k / h);
    let plane = |x0: T, x2: T, most: T| HalfPlane { x0, x2, most };
    [
        [plane(zero, one, next[1].min(most)), plane(half, half, most - k), plane(-g, g, u - bend), plane(-g, g, u + bend)],
        [plane(zero, -one, -next[0].max(least)), plane(-half, -half, k - least), plane(g, -g, u + bend), plane(g, -g, u - bend)],
    ]
}

/// The X0 in [least, most] for which the interval of X2 is not empty: the ends, each with that interval; `None` where there is no such X0.
pub(super) fn backwards<T: RealField + Copy>(
    least: T,
    most: T,
    mut interval: impl FnMut(T) -> Interval<T>,
) -> Option<[(T, [T; 2]); 2]> {
    let (mut low, mut high) = (least, most);
    let tiny = lit::<T>(64.0) * T::default_epsilon();
    let mut found = None;
    for _ in 0..60 {
        let at = interval(high);
        if at.alone[1] < high {
            high = at.alone[1];
            if high < low {
                return None;
            }
            continue;
        }
        low = low.max(at.alone[0]);
        let width = at.width();
        // It is a difference of X0 and X2, and rounds as these do.
        if width >= -tiny * at.size().max(high) {
            found = Some(at.ends());
            break;
        }
        let slope = at.high.1 - at.low.1;
        if !(slope < T::zero()) {
            return None;
        }
        // Where m is nearly zero the width is steep, and its rounding larger than any of X0: a step passes that, too.
        high = (high - width / slope).min(high * (T::one() - tiny));
        if high < low {
            return None;
        }
    }
    // Within the interval, not on its edge, so that rounding does not leave it empty.
    high *= T::one() - tiny;
    let top = (high, found?);
    for _ in 0..60 {
        if low >= high {
            return Some([top, top]);
        }
        let at = interval(low);
        let width = at.width();
        if width >= T::zero() {
            return Some([(low, at.ends()), top]);
        }
        let slope = at.high.1 - at.low.1;
        if !(slope > T::zero()) {
            return Some([top, top]);
        }
        low = (low - width / slope) * (T::one() + tiny);
    }
    Some([top, top])
}

/// The interval of X2 for an X0: (lowest, its slope by X0), (highest, its slope), and the X0 that the planes without X2 allow.
pub(super) struct Interval<T> {
    low: (T, T),
    high: (T, T),
    pub(super) alone: [T; 2],
}

impl<T: RealField + Copy> Interval<T> {
    pub(super) fn new() -> Self {
        Self { low: (-lit::<T>(1e30), T::zero()), high: (lit(1e30), T::zero()), alone: [T::zero(), lit(1e30)] }
    }

    /// What [`others`] leave, without their slopes.
    pub(super) fn within(h: T, k: T, assumed: &Assumed<T>, next: [T; 2], x0: T) -> Self {
        let two = lit::<T>(2.0);
        let ([least, most], half) = (assumed.x, lit::<T>(0.5));
        let g = half / h;
        let room = assumed.u - (k / h).abs();
        let high = next[1].min(most).min(((most - k) - half * x0) * two).min((room + g * x0) / g);
        let low = next[0].max(least).max(((least - k) - half * x0) * two).max((g * x0 - room) / g);
        Self { low: (low, T::zero()), high: (high, T::zero()), ..Self::new() }
    }

    /// Takes what a plane with x2 > 0 leaves; whether it moves the upper end.
    #[inline]
    pub(super) fn lower(&mut self, plane: &HalfPlane<T>, x0: T) -> bool {
        moves(&mut self.high, plane, x0)
    }

    /// The same with x2 < 0 and the lower end.
    #[inline]
    pub(super) fn raise(&mut self, plane: &HalfPlane<T>, x0: T) -> bool {
        moves(&mut self.low, plane, x0)
    }

    /// Takes what a plane leaves; which end of the interval it moves.
    pub(super) fn cut(&mut self, plane: &HalfPlane<T>, x0: T) -> Option<usize> {
        let zero = T::zero();
        if plane.x2 > zero {
            return self.lower(plane, x0).then_some(1);
        }
        if plane.x2 < zero {
            return self.raise(plane, x0).then_some(0);
        }
        if plane.x0 > zero {
            self.alone[1] = self.alone[1].min(plane.most / plane.x0);
        } else if plane.x0 < zero {
            self.alone[0] = self.alone[0].max(plane.most / plane.x0);
        } else if plane.most < zero {
            self.alone[1] = -T::one();
        }
        None
    }

    /// The ends, at least 0; the upper one counts within rounding.
    pub(super) fn ends(&self) -> [T; 2] {
        let high = self.high.0.max(T::zero());
        [self.low.0.min(high), high]
    }

    pub(super) fn width(&self) -> T {
        self.high.0 - self.low.0
    }

    pub(super) fn size(&self) -> T {
        self.high.0.abs().max(self.low.0.abs())
    }
}

/// Moves the end of an interval to a plane that does not keep it; whether it does. It divides only there.
#[inline]
fn moves<T: RealField + Copy>(end: &mut (T, T), plane: &HalfPlane<T>, x0: T) -> bool {
    let room = plane.most - plane.x0 * x0;
    let moves = room < end.0 * plane.x2;
    if moves {
        *end = (room / plane.x2, -plane.x0 / plane.x2);
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::*;

    /// c X0 + m X2 <= most with m close to zero: the width of X2 rounds by far more than X0 does.
    #[test]
    fn a_row_nearly_without_inertia_leaves_an_interval() {
        let mut state = 3u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..1000 {
            let (c, m, most) = (0.1 + random(), 1e-8 * random(), 5.0 + random());
            let found = backwards(0.0, 2.0 * most / c, |x0| {
                let mut found = Interval::new();
                found.lower(&HalfPlane { x0: c, x2: m, most }, x0);
                found.lower(&HalfPlane { x0: 0.0, x2: 1.0, most: 30.0 }, x0);
                found.raise(&HalfPlane { x0: 1.0, x2: -1.0, most: 1.0 }, x0);
                found
            });
            let [(low, _), (high, _)] = found.expect("an interval");
            assert!(low == 0.0 && (high - (most / c).min(31.0)).abs() < 1e-5, "{low} {high}");
        }
    }
}
