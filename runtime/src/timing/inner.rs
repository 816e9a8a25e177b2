//! From below: a motion that keeps every row on every segment.
//!
//! On a segment a row has five Bernstein coefficients, linear in X0 and X2 once k is chosen: half-planes. Backwards, the interval of the X0
//! from which some X2 in the next interval keeps all of them; forwards, the largest X2. So x is found as by reachability analysis
//! (Pham, Pham, *IEEE T-RO* 34, 2018), and every limit holds between nodes.
//! Friction that is no line over x is replaced, on the side that counts, by a tangent or a chord.

use super::limits::Limits;
use super::model::JointFriction;
use super::outer::ROUNDING;
use super::row::{least, most, Form, Quadratic, Row, Window};
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
    let row = segment.row(index, limits, friction, false)?;
    let row = binding(&row, assumed, assumed.x[1].sqrt(), window)?;
    Some(row.forms(segment.length).map(|form| Form { rest: form.rest - row.bound, ..form }))
}

/// The row as lines over x, with all errors in its limit; `None` where nothing that is assumed breaks it. `root` is that of the largest x.
#[inline]
fn binding<T: RealField + Copy>(row: &Row<T>, assumed: &Assumed<T>, root: T, window: &Window<T>) -> Option<Row<T>> {
    let ([_, most_x], u) = (assumed.x, assumed.u);
    // x >= 0, so the error of c is a part of c.
    let mut row = Row { c: row.c.map(|c| c + row.c_error), ..*row };
    let slack = row.bound.abs() * lit(ROUNDING) + row.m_error * u + row.v_error * root + row.d_error;
    if row.is_curved() {
        row = row.straight(window, true);
    }
    let largest = |[a, b, c]: Quadratic<T>| most(most(a, b), c);
    let reaches = largest(row.m.map(|m| m.abs())) * u + most(largest(row.c), T::zero()) * most_x + largest(row.d);
    row.bound -= slack;
    (!(reaches <= row.bound * lit(1.0 - 1e-6))).then_some(row)
}

/// The half-planes of the middle coefficient, of u and of the interval at the end, for k: those from above and from below.
fn others<T: RealField + Copy>(h: T, k: T, assumed: &Assumed<T>, next: [T; 2]) -> [[HalfPlane<T>; 4]; 2] {
    let (zero, one, half) = (T::zero(), T::one(), lit::<T>(0.5));
    let ([least, most], u) = (assumed.x, assumed.u);
    let (g, bend) = (half / h, k / h);
    let plane = |x0: T, x2: T, most: T| HalfPlane { x0, x2, most };
    [
        [plane(zero, one, next[1].min(most)), plane(half, half, most - k), plane(-g, g, u - bend), plane(-g, g, u + bend)],
        [plane(zero, -one, -next[0].max(least)), plane(-half, -half, k - least), plane(g, -g, u + bend), plane(g, -g, u - bend)],
    ]
}

/// The half-planes of a segment for one k.
pub(super) struct HalfPlanes<T, const N: usize> {
    /// Of rows: those that bound X2 from above, first to last, and those that bound it from below, last to first.
    rows: [[HalfPlane<T>; 25]; N],
    /// Where the first end and the others begin.
    ends: [usize; 2],
    others: [[HalfPlane<T>; 4]; 2],
    /// The X0 that planes without X2 allow.
    alone: [T; 2],
}

impl<T: RealField + Copy, const N: usize> HalfPlanes<T, N> {
    pub(super) fn new(
        segment: &Segment<T, N>,
        limits: &Limits<T, N>,
        friction: &[JointFriction<T>; N],
        k: T,
        assumed: &Assumed<T>,
        next: [T; 2],
    ) -> Self {
        let window = Window::new(assumed.x, assumed.touch);
        let (zero, root, h) = (T::zero(), assumed.x[1].sqrt(), segment.length);
        let mut rows = [[HalfPlane { x0: zero, x2: zero, most: zero }; 25]; N];
        let places = rows.as_flattened_mut();
        let mut ends = [0, places.len()];
        let mut rest = Interval::new();
        let mut add = |row: Option<Row<T>>| {
            let Some(row) = row.and_then(|row| binding(&row, assumed, root, &window)) else { return };
            for form in row.forms(h) {
                let plane = HalfPlane::of(&Form { rest: form.rest - row.bound, ..form }, k);
                let place = if plane.x2 > zero {
                    ends[0] += 1;
                    ends[0] - 1
                } else if plane.x2 < zero {
                    ends[1] -= 1;
                    ends[1]
                } else {
                    rest.cut(&plane, zero);
                    continue;
                };
                if let Some(to) = places.get_mut(place) {
                    *to = plane;
                }
            }
        };
        // Most rows cannot bind, and most of these show it before they are made.
        let share = lit::<T>(1.0 - 1e-6);
        for (joint, (effort, of)) in limits.effort.iter().zip(friction).enumerate() {
            let torque = segment.largest_torque(joint, of, assumed.u, root);
            if torque.is_none_or(|torque| !(torque <= least(-effort[0], effort[1]) * share)) {
                add(segment.torque(joint, 0, effort, of, false));
                add(segment.torque(joint, 1, effort, of, false));
            }
        }
        for (joint, limit) in limits.acceleration.iter().enumerate().filter(|(_, limit)| limit.is_finite()) {
            add(segment.acceleration(joint, 0, *limit));
            add(segment.acceleration(joint, 1, *limit));
        }
        for (joint, (limit, square)) in limits.velocity.iter().zip(&segment.rates[2]).enumerate() {
            if !(square.size() * assumed.x[1] <= *limit * *limit * share) {
                add(segment.speed(joint, *limit));
            }
        }
        Self { rows, ends, others: others(h, k, assumed, next), alone: rest.alone }
    }

    /// The interval of X2 for an X0.
    pub(super) fn interval(&self, x0: T) -> Interval<T> {
        let mut found = Interval { alone: self.alone, ..Interval::new() };
        let rows = self.rows.as_flattened();
        let [above, below] = &self.others;
        for planes in [rows.get(..self.ends[0]).unwrap_or(&[]), above] {
            for plane in planes {
                found.lower(plane, x0);
            }
        }
        for plane in rows.get(self.ends[1]..).unwrap_or(&[]).iter().rev() {
            found.raise(plane, x0);
        }
        for plane in below {
            found.raise(plane, x0);
        }
        found
    }

    /// The X0 in [least, most] from which some X2 keeps all planes; `None` where there is no such X0.
    pub(super) fn backwards(&self, least: T, most: T) -> Option<[T; 2]> {
        let (mut low, mut high) = (least, most);
        let tiny = lit::<T>(64.0) * T::default_epsilon();
        let mut found = false;
        for _ in 0..60 {
            let at = self.interval(high);
            if at.alone[1] < high {
                high = at.alone[1];
                if high < low {
                    return None;
                }
                continue;
            }
            low = low.max(at.alone[0]);
            let width = at.width();
            if width >= -tiny * at.size() {
                found = true;
                break;
            }
            let slope = at.high.1 - at.low.1;
            if !(slope < T::zero()) {
                return None;
            }
            high -= width / slope;
            if high < low {
                return None;
            }
        }
        if !found {
            return None;
        }
        // Within the interval, not on its edge, so that rounding does not leave it empty.
        high *= T::one() - tiny;
        let top = high;
        for _ in 0..60 {
            if low >= top {
                return Some([top, top]);
            }
            let at = self.interval(low);
            let width = at.width();
            if width >= T::zero() {
                return Some([low, top]);
            }
            let slope = at.high.1 - at.low.1;
            if !(slope > T::zero()) {
                return Some([top, top]);
            }
            low = (low - width / slope) * (T::one() + tiny);
        }
        Some([top, top])
    }

    /// The largest X2 from an X0.
    pub(super) fn forwards(&self, x0: T) -> T {
        self.interval(x0).high.0
    }
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

    /// Takes what a plane with x2 > 0 leaves; whether it moves the upper end. It divides only where it does.
    #[inline]
    fn lower(&mut self, plane: &HalfPlane<T>, x0: T) -> bool {
        let room = plane.most - plane.x0 * x0;
        let moves = room < self.high.0 * plane.x2;
        if moves {
            self.high = (room / plane.x2, -plane.x0 / plane.x2);
        }
        moves
    }

    /// The same with x2 < 0 and the lower end.
    #[inline]
    fn raise(&mut self, plane: &HalfPlane<T>, x0: T) -> bool {
        let room = plane.most - plane.x0 * x0;
        let moves = room < self.low.0 * plane.x2;
        if moves {
            self.low = (room / plane.x2, -plane.x0 / plane.x2);
        }
        moves
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
