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

impl<T: RealField + Copy> HalfPlane<T> {
    /// Of a form at most 0.
    fn of(form: &Form<T>, k: T) -> Self {
        Self { x0: form.x0, x2: form.x2, most: -form.rest - form.k * k }
    }
}

/// The forms of a row, at most 0 on the segment; `None` where its limit is infinite or cannot bind.
fn of_row<T: RealField + Copy, const N: usize>(
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

/// The half-planes of the middle coefficient, of u and of the interval at the end, for k.
fn others<T: RealField + Copy>(h: T, k: T, assumed: &Assumed<T>, next: [T; 2]) -> [HalfPlane<T>; 8] {
    let (zero, one, half) = (T::zero(), T::one(), lit::<T>(0.5));
    let ([least, most], u) = (assumed.x, assumed.u);
    let (g, bend) = (half / h, k / h);
    let plane = |x0: T, x2: T, most: T| HalfPlane { x0, x2, most };
    [
        plane(zero, one, next[1].min(most)),
        plane(zero, -one, -next[0].max(least)),
        plane(half, half, most - k),
        plane(-half, -half, k - least),
        plane(-g, g, u - bend),
        plane(g, -g, u + bend),
        plane(-g, g, u + bend),
        plane(g, -g, u - bend),
    ]
}

/// The half-planes of a segment for one k.
pub(super) struct HalfPlanes<T, const N: usize> {
    /// In the order of the rows.
    rows: [[Option<[HalfPlane<T>; 5]>; 5]; N],
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
        let window = Window::new(assumed.x, assumed.touch);
        let mut rows = [[None; 5]; N];
        let places = rows.iter_mut().flatten();
        for (index, to) in places.enumerate() {
            let forms = of_row(segment, index, limits, friction, assumed, &window);
            *to = forms.map(|forms| forms.map(|form| HalfPlane::of(&form, k)));
        }
        Self { rows, others: others(segment.length, k, assumed, next) }
    }

    /// The interval of X2 for an X0.
    fn interval(&self, x0: T) -> Interval<T> {
        let mut found = Interval::new();
        for plane in self.rows.iter().flatten().flatten().flatten().chain(&self.others) {
            found.cut(plane, x0);
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

/// The X2 that follow an X0, for one k and one assumption after another. The rows that bounded the last interval come first, so a trial that
/// leads nowhere ends after a few rows.
pub(super) struct Trial<'a, T, const N: usize> {
    segment: &'a Segment<T, N>,
    limits: &'a Limits<T, N>,
    friction: &'a [JointFriction<T>; N],
    x0: T,
    /// Rows of the lower and the upper end of the last interval.
    first: [Option<usize>; 2],
    /// Of the last assumption the forms of the rows that were needed: no k enters.
    assumed: Assumed<T>,
    window: Window<T>,
    forms: [[Option<Option<[Form<T>; 5]>>; 5]; N],
}

impl<'a, T: RealField + Copy, const N: usize> Trial<'a, T, N> {
    pub(super) fn new(segment: &'a Segment<T, N>, limits: &'a Limits<T, N>, friction: &'a [JointFriction<T>; N], x0: T) -> Self {
        let assumed = segment.inner.assumed;
        let window = Window::new(assumed.x, assumed.touch);
        Self { segment, limits, friction, x0, first: [None; 2], assumed, window, forms: [[None; 5]; N] }
    }

    /// The X2 that keep all rows, within rounding; `None` where there is no such X2, or where an interval around them does not serve.
    pub(super) fn interval(
        &mut self,
        k: T,
        assumed: &Assumed<T>,
        next: [T; 2],
        serves: impl Fn([T; 2]) -> bool,
    ) -> Option<[T; 2]> {
        let slack = lit::<T>(256.0) * T::default_epsilon();
        let ([least, most], x0) = (assumed.x, self.x0);
        let is_inside = |low: T, high: T| x0 >= least.max(low) - most * slack && x0 <= most.min(high) + most * slack;
        // Each row leaves less of the interval.
        let is_left = |found: &Interval<T>| {
            let [low, high] = found.alone;
            is_inside(low, high) && found.width() >= -slack * found.size() && serves(found.ends())
        };
        let mut found = Interval::new();
        for plane in others(self.segment.length, k, assumed, next) {
            found.cut(&plane, x0);
        }
        if !is_left(&found) {
            return None;
        }
        if self.assumed != *assumed {
            (self.assumed, self.window) = (*assumed, Window::new(assumed.x, assumed.touch));
            self.forms = [[None; 5]; N];
        }
        for index in self.first.into_iter().flatten().chain(0..Segment::<T, N>::ROWS) {
            let Some(place) = self.forms.get_mut(index / 5).and_then(|of| of.get_mut(index % 5)) else { continue };
            let new = || of_row(self.segment, index, self.limits, self.friction, assumed, &self.window);
            let Some(forms) = place.get_or_insert_with(new) else { continue };
            for form in forms {
                let plane = HalfPlane::of(form, k);
                if let Some(first) = found.cut(&plane, x0).and_then(|end| self.first.get_mut(end)) {
                    *first = Some(index);
                }
            }
            if !is_left(&found) {
                return None;
            }
        }
        Some(found.ends())
    }
}

/// The interval of X2 for an X0: (lowest, its slope by X0), (highest, its slope), and the X0 that the planes without X2 allow.
struct Interval<T> {
    low: (T, T),
    high: (T, T),
    alone: [T; 2],
}

impl<T: RealField + Copy> Interval<T> {
    fn new() -> Self {
        Self { low: (-lit::<T>(1e30), T::zero()), high: (lit(1e30), T::zero()), alone: [T::zero(), lit(1e30)] }
    }

    /// Takes what a plane leaves; which end of the interval it moves.
    fn cut(&mut self, plane: &HalfPlane<T>, x0: T) -> Option<usize> {
        let zero = T::zero();
        if plane.x2 > zero {
            let x2 = (plane.most - plane.x0 * x0) / plane.x2;
            if x2 < self.high.0 {
                self.high = (x2, -plane.x0 / plane.x2);
                return Some(1);
            }
        } else if plane.x2 < zero {
            let x2 = (plane.most - plane.x0 * x0) / plane.x2;
            if x2 > self.low.0 {
                self.low = (x2, -plane.x0 / plane.x2);
                return Some(0);
            }
        } else if plane.x0 > zero {
            self.alone[1] = self.alone[1].min(plane.most / plane.x0);
        } else if plane.x0 < zero {
            self.alone[0] = self.alone[0].max(plane.most / plane.x0);
        } else if plane.most < zero {
            self.alone[1] = -T::one();
        }
        None
    }

    /// The ends, at least 0; the upper one counts within rounding.
    fn ends(&self) -> [T; 2] {
        let high = self.high.0.max(T::zero());
        [self.low.0.min(high), high]
    }

    fn width(&self) -> T {
        self.high.0 - self.low.0
    }

    fn size(&self) -> T {
        self.high.0.abs().max(self.low.0.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timing::segment::Column;

    /// In whatever order the rows come, a trial leaves the interval of all half-planes, and ends early only where that does not serve.
    #[test]
    fn a_trial_leaves_what_all_half_planes_leave() {
        let mut state = 5u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let curved = JointFriction { cubic: 0.3, stribeck: 0.5, stribeck_velocity: 0.2, ..JointFriction::default() };
        let friction = [JointFriction { viscous: 0.4, coulomb: 0.1, ..JointFriction::default() }, curved];
        let limits = Limits::velocity([1.2, 1.5]).and_then(|of| of.with_effort([-3.0; 2], [3.0; 2])).expect("limits");
        let (mut some, mut none, mut early) = (0, 0, 0);
        for _ in 0..500 {
            let mut segment = Segment::<f64, 2> { length: 0.1, signs: [1.0, -1.0], ..Segment::empty() };
            for (part, of) in segment.torques.iter_mut().chain(&mut segment.rates).enumerate() {
                let least = if part == 5 { 0.0 } else { -1.0 };
                *of = [0, 1]
                    .map(|_| Column { quadratic: [0; 3].map(|_| least + (1.0 - least) * random()), error: 1e-3 * random() });
            }
            let (x0, target, next) = (random(), random(), [0.0, 0.3 + random()]);
            let mut trial = Trial::new(&segment, &limits, &friction, x0);
            for k in [0.0, 0.1, -0.1] {
                let assumed = Assumed { x: [0.0, 0.2 + 1.3 * random()], touch: 0.1 + random(), u: 4.0 };
                let at = HalfPlanes::new(&segment, &limits, &friction, k, &assumed, next).interval(x0);
                let inside = x0 <= assumed.x[1].min(at.alone[1]) && x0 >= at.alone[0];
                let expected = (inside && at.width() >= 0.0).then(|| at.ends());
                let found = trial.interval(k, &assumed, next, |_| true);
                assert_eq!(found, expected, "{segment:?} {assumed:?} {x0} {k}");
                let near = |[low, high]: [f64; 2]| (target.max(low).min(high) - target).abs() < 0.1;
                assert_eq!(trial.interval(k, &assumed, next, near), expected.filter(|ends| near(*ends)));
                (some, none) = (some + usize::from(found.is_some()), none + usize::from(found.is_none()));
                early += usize::from(expected.is_some_and(|ends| !near(ends)));
            }
        }
        assert!(some > 100 && none > 100 && early > 50, "{some} {none} {early}");
    }
}
