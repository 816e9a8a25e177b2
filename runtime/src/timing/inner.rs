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
struct HalfPlane<T> {
    x0: T,
    x2: T,
    most: T,
}

/// The half-planes of a segment for one k.
pub(super) struct HalfPlanes<T, const N: usize> {
    /// Of each joint: torque, acceleration, both sides, and speed. `None` where a limit is infinite or cannot bind.
    rows: [[Option<[HalfPlane<T>; 5]>; 5]; N],
    /// X0 lies between these.
    x0: [T; 2],
    /// Of the middle coefficient, of u and of the next interval.
    others: [HalfPlane<T>; 8],
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
        let (zero, one, half) = (T::zero(), T::one(), lit::<T>(0.5));
        let h = segment.length;
        let [least, most] = assumed.x;
        let window = Window::new(assumed.x, assumed.touch);
        let mut rows = [[None; 5]; N];
        for index in 0..Segment::<T, N>::ROWS {
            let Some(row) = segment.row(index, limits, friction, false) else { continue };
            let slack = row.bound.abs() * lit(ROUNDING) + row.m_error * assumed.u + row.v_error * most.sqrt() + row.d_error;
            let place = if index < 4 * N { (index % (2 * N) / 2, index / (2 * N) * 2 + index % 2) } else { (index - 4 * N, 4) };
            // Speed that the bound does not reach.
            if index >= 4 * N && row.c.iter().all(|c| (*c + row.c_error) * most <= row.bound * lit(1.0 - 1e-6)) {
                continue;
            }
            // x >= 0, so the error of c is a part of c.
            let mut row = Row { c: row.c.map(|c| c + row.c_error), ..row };
            if row.is_curved() {
                row = row.straight(&window, true);
            }
            let bound = row.bound - slack;
            let planes =
                row.forms(h).map(|form: Form<T>| HalfPlane { x0: form.x0, x2: form.x2, most: bound - form.rest - form.k * k });
            if let Some(to) = rows.get_mut(place.0).and_then(|of: &mut [Option<[HalfPlane<T>; 5]>; 5]| of.get_mut(place.1)) {
                *to = Some(planes);
            }
        }
        let g = half / h;
        let plane = |x0: T, x2: T, most: T| HalfPlane { x0, x2, most };
        let others = [
            plane(zero, one, next[1].min(most)),
            plane(zero, -one, -next[0].max(least)),
            plane(half, half, most - k),
            plane(-half, -half, k - least),
            plane(-g, g, assumed.u - k / h),
            plane(g, -g, assumed.u + k / h),
            plane(-g, g, assumed.u + k / h),
            plane(g, -g, assumed.u - k / h),
        ];
        Self { rows, x0: assumed.x, others }
    }

    /// The interval of X2 for an X0: (lowest, its slope by X0), (highest, its slope), and the X0 that the planes without X2 allow.
    fn interval(&self, x0: T) -> Interval<T> {
        let mut found =
            Interval { low: (-lit::<T>(1e30), T::zero()), high: (lit(1e30), T::zero()), alone: [T::zero(), lit(1e30)] };
        let rows = self.rows.iter().flatten().flatten().flatten();
        for plane in rows.chain(&self.others) {
            if plane.x2 > T::zero() {
                let x2 = (plane.most - plane.x0 * x0) / plane.x2;
                if x2 < found.high.0 {
                    found.high = (x2, -plane.x0 / plane.x2);
                }
            } else if plane.x2 < T::zero() {
                let x2 = (plane.most - plane.x0 * x0) / plane.x2;
                if x2 > found.low.0 {
                    found.low = (x2, -plane.x0 / plane.x2);
                }
            } else if plane.x0 > T::zero() {
                found.alone[1] = found.alone[1].min(plane.most / plane.x0);
            } else if plane.x0 < T::zero() {
                found.alone[0] = found.alone[0].max(plane.most / plane.x0);
            } else if plane.most < T::zero() {
                found.alone[1] = -T::one();
            }
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

    /// The X2 that keep all planes from an X0, within rounding; `None` where there is no such X2.
    pub(super) fn interval_from(&self, x0: T) -> Option<[T; 2]> {
        let at = self.interval(x0);
        let slack = lit::<T>(256.0) * T::default_epsilon();
        let [least, most] = self.x0;
        let is_inside = x0 >= least.max(at.alone[0]) - most * slack && x0 <= most.min(at.alone[1]) + most * slack;
        let high = at.high.0.max(T::zero());
        (is_inside && at.width() >= -slack * at.size()).then(|| [at.low.0.min(high), high])
    }

    /// The largest X2 from an X0.
    pub(super) fn forwards(&self, x0: T) -> T {
        self.interval(x0).high.0
    }
}

struct Interval<T> {
    low: (T, T),
    high: (T, T),
    alone: [T; 2],
}

impl<T: RealField + Copy> Interval<T> {
    fn width(&self) -> T {
        self.high.0 - self.low.0
    }

    fn size(&self) -> T {
        self.high.0.abs().max(self.low.0.abs())
    }
}
