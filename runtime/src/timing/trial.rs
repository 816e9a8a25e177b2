//! From an X0 the X2 nearest to a wish, for one k after another, with few of the rows.
//!
//! With X2 known, x and u lie in short intervals, and so does every row. A row that these intervals keep is no bound of X2 there. So rows
//! are formed only where the intervals do not keep them, and the X2 nearest to the wish within all formed rows is that within all rows.

use super::inner::{backwards, of_row, others, HalfPlane, Interval};
use super::limits::Limits;
use super::model::JointFriction;
use super::row::{least, most, Form, Quadratic, Window};
use super::segment::{Assumed, Segment};
use crate::linalg::lit;
use nalgebra::RealField;

/// Values within `reach` of `middle`.
#[derive(Clone, Copy, Debug)]
struct Spread<T> {
    middle: T,
    reach: T,
}

impl<T: RealField + Copy> Spread<T> {
    fn between(low: T, high: T) -> Self {
        let half = lit::<T>(0.5);
        Self { middle: (low + high) * half, reach: (high - low) * half }
    }

    fn of([a, b, c]: Quadratic<T>, error: T) -> Self {
        let of = Self::between(least(least(a, b), c), most(most(a, b), c));
        Self { reach: of.reach + error, ..of }
    }

    /// The largest size.
    fn size(&self) -> T {
        self.middle.abs() + self.reach
    }

    fn plus(&self, other: Self) -> Self {
        Self { middle: self.middle + other.middle, reach: self.reach + other.reach }
    }

    fn times(&self, other: &Self) -> Self {
        Self {
            middle: self.middle * other.middle,
            reach: self.middle.abs() * other.reach + self.reach * (other.middle.abs() + other.reach),
        }
    }

    fn scaled(&self, by: T) -> Self {
        Self { middle: self.middle * by, reach: self.reach * by.abs() }
    }
}

/// The functions of a joint on a segment.
#[derive(Clone, Copy, Debug)]
struct Functions<T> {
    /// m, c, d of the torque; v of viscous friction.
    torque: [Spread<T>; 3],
    v: Option<Spread<T>>,
    /// q', without its error, and q''.
    rate: Spread<T>,
    rate_error: T,
    curvature: Spread<T>,
    /// q'² in the middle, and at most.
    square: [T; 2],
    sign: T,
}

/// What a law leaves of the segment: sqrt(x) by its lines, x and u.
struct Reached<T> {
    u: Spread<T>,
    x: Spread<T>,
    root: Spread<T>,
}

/// Storage of formed rows, for one trial after another.
#[derive(Debug)]
pub(super) struct Formed<T, const N: usize> {
    joints: [[Option<FormedRow<T>>; 5]; N],
    tool: [Option<FormedRow<T>>; 2],
}

impl<T: RealField + Copy, const N: usize> Formed<T, N> {
    pub(super) fn new() -> Self {
        Self { joints: [[None; 5]; N], tool: [None; 2] }
    }

    /// All places, of rows of whatever kind.
    fn all(&self) -> impl Iterator<Item = &Option<FormedRow<T>>> {
        self.joints.as_flattened().iter().chain(&self.tool)
    }

    fn at(&self, place: usize) -> Option<&FormedRow<T>> {
        let joints = self.joints.as_flattened();
        joints.get(place).or_else(|| self.tool.get(place - joints.len().min(place))).and_then(Option::as_ref)
    }

    fn put(&mut self, place: usize, row: FormedRow<T>) -> bool {
        let joints = self.joints.as_flattened_mut();
        let count = joints.len();
        let to = if place < count { joints.get_mut(place) } else { self.tool.get_mut(place - count) };
        to.map(|to| *to = Some(row)).is_some()
    }
}

/// A row that was formed; no k enters. `None` where it cannot bind.
#[derive(Clone, Copy, Debug)]
struct FormedRow<T> {
    index: usize,
    forms: Option<[Form<T>; 5]>,
}

/// The X2 that follow an X0, for one k and one assumption after another.
pub(super) struct Trial<'a, T, const N: usize> {
    segment: &'a Segment<T, N>,
    limits: &'a Limits<T, N>,
    friction: &'a [JointFriction<T>; N],
    x0: T,
    joints: [Functions<T>; N],
    assumed: Assumed<T>,
    window: Window<T>,
    /// What the assumption adds to the torque of each joint: errors, and friction over dq².
    assumption: [Spread<T>; N],
    is_spread: bool,
    /// The rows that were formed for the last assumption: `count` of them.
    formed: &'a mut Formed<T, N>,
    count: usize,
    /// The rows that moved the lower and the upper end last.
    pub(super) first: [Option<usize>; 2],
}

impl<'a, T: RealField + Copy, const N: usize> Trial<'a, T, N> {
    pub(super) fn new(
        segment: &'a Segment<T, N>,
        limits: &'a Limits<T, N>,
        friction: &'a [JointFriction<T>; N],
        assumed: Assumed<T>,
        x0: T,
        first: [Option<usize>; 2],
        formed: &'a mut Formed<T, N>,
    ) -> Self {
        let zero = Spread { middle: T::zero(), reach: T::zero() };
        let none = Functions {
            torque: [zero; 3],
            v: None,
            rate: zero,
            rate_error: T::zero(),
            curvature: zero,
            square: [T::zero(); 2],
            sign: T::zero(),
        };
        Self {
            segment,
            limits,
            friction,
            x0,
            joints: core::array::from_fn(|joint| {
                let is_limited = limits.acceleration.get(joint).is_some_and(|limit| limit.is_finite());
                friction.get(joint).and_then(|friction| functions(segment, friction, joint, is_limited)).unwrap_or(none)
            }),
            assumed,
            window: Window::new(assumed.x, assumed.touch),
            assumption: [zero; N],
            is_spread: false,
            formed,
            count: 0,
            first,
        }
    }

    /// Rows are formed anew.
    fn assume(&mut self, assumed: &Assumed<T>) {
        self.assumed = *assumed;
        self.window = Window::new(assumed.x, assumed.touch);
        self.count = 0;
        self.is_spread = false;
    }

    /// What the assumption adds to torques: most trials end before it is asked for.
    fn spread(&mut self) {
        let assumed = &self.assumed;
        let (root, [inertial, ..]) = (assumed.x[1].max(T::zero()).sqrt(), &self.segment.torques);
        let rates = inertial.iter().zip(&self.segment.rates[0]);
        let joints = self.friction.iter().zip(&self.joints);
        for ((to, (of, joint)), (inertial, rate)) in self.assumption.iter_mut().zip(joints).zip(rates) {
            let reach = inertial.error * assumed.u + of.viscous * rate.error * root;
            *to = Spread { middle: T::zero(), reach };
            if of.has_curve() {
                *to = to.plus(curve(of, joint, assumed));
            }
        }
        self.is_spread = true;
    }

    /// The X2 nearest to `target` that keeps all rows, within rounding; `None` where there is no such X2, or where it cannot serve.
    /// `serves` is asked for nearer and nearer ones.
    pub(super) fn nearest(
        &mut self,
        k: T,
        assumed: &Assumed<T>,
        next: [T; 2],
        target: T,
        serves: impl Fn(T) -> bool,
    ) -> Option<T> {
        let slack = lit::<T>(256.0) * T::default_epsilon();
        let ([least, most], x0) = (assumed.x, self.x0);
        let is_inside = |low: T, high: T| x0 >= least.max(low) - most * slack && x0 <= most.min(high) + most * slack;
        let nearest = |found: &Interval<T>| {
            let [low, high] = found.ends();
            target.max(low).min(high)
        };
        // Each row leaves less of the interval.
        let is_left = |found: &Interval<T>| {
            let [low, high] = found.alone;
            is_inside(low, high) && found.width() >= -slack * found.size().max(x0) && serves(nearest(found))
        };
        let mut found = Interval::within(self.segment.length, k, assumed, next, x0);
        if !is_left(&found) {
            return None;
        }
        if self.assumed != *assumed {
            self.assume(assumed);
        }
        // Faster or slower: the row that ended that last is likely to do so again.
        let end = usize::from(target > x0);
        if let Some(index) = self.first.get(end).copied().flatten() {
            self.form(index);
        }
        for at in 0..self.count {
            self.cut(at, k, &mut found);
        }
        if !is_left(&found) {
            return None;
        }
        if !self.is_spread {
            self.spread();
        }
        // Each round but the last one forms a row.
        for _ in 0..=Segment::<T, N>::ROWS {
            let x2 = nearest(&found);
            let reached = self.reached(k, x2);
            let before = self.count;
            for joint in 0..=N {
                let doubtful = self.doubtful(joint, &reached);
                if doubtful == [false; 5] {
                    continue;
                }
                for (index, doubtful) in rows::<N>(joint).into_iter().zip(doubtful) {
                    if doubtful && self.form(index) {
                        self.cut(self.count - 1, k, &mut found);
                        if !is_left(&found) {
                            return None;
                        }
                    }
                }
            }
            if self.count == before || nearest(&found) == x2 {
                break;
            }
        }
        Some(nearest(&found))
    }

    /// The X0 in [least, most] from which some X2 in `next` keeps all rows; `None` where there is no such X0. Where rows are kept at both
    /// ends of the X0, they are kept between.
    pub(super) fn backwards(&mut self, k: T, assumed: &Assumed<T>, next: [T; 2], least: T, most: T) -> Option<[T; 2]> {
        if self.assumed != *assumed {
            self.assume(assumed);
        }
        if !self.is_spread {
            self.spread();
        }
        for index in self.first.into_iter().flatten() {
            self.form(index);
        }
        let others = others(self.segment.length, k, assumed, next);
        // Each round but the last one forms a row.
        for _ in 0..=Segment::<T, N>::ROWS {
            let found = backwards(least, most, |x0| self.interval(k, &others, x0))?;
            let before = self.count;
            for (x0, [low, high]) in found {
                self.x0 = x0;
                let reached = self.reached(k, x0.max(low).min(high));
                for joint in 0..=N {
                    let rows = rows::<N>(joint).into_iter().zip(self.doubtful(joint, &reached));
                    for (index, _) in rows.filter(|(_, doubtful)| *doubtful) {
                        self.form(index);
                    }
                }
            }
            if self.count == before {
                return Some(found.map(|(x0, _)| x0));
            }
        }
        None
    }

    /// The largest X2 that formed rows allow, even where rounding leaves none.
    pub(super) fn highest(&mut self, k: T, assumed: &Assumed<T>, next: [T; 2]) -> T {
        let others = others(self.segment.length, k, assumed, next);
        self.interval(k, &others, self.x0).ends()[1]
    }

    /// The interval of X2 that formed rows and `others` leave for an X0.
    fn interval(&mut self, k: T, [above, below]: &[[HalfPlane<T>; 4]; 2], x0: T) -> Interval<T> {
        self.x0 = x0;
        let mut found = Interval::new();
        for at in 0..self.count {
            self.cut(at, k, &mut found);
        }
        for (above, below) in above.iter().zip(below) {
            found.lower(above, x0);
            found.raise(below, x0);
        }
        found
    }

    /// Forms a row; `false` where it has been formed.
    fn form(&mut self, index: usize) -> bool {
        if self.formed.all().take(self.count).flatten().any(|of| of.index == index) {
            return false;
        }
        let forms = of_row(self.segment, index, self.limits, self.friction, &self.assumed, &self.window);
        let is_new = self.formed.put(self.count, FormedRow { index, forms });
        self.count += usize::from(is_new);
        is_new
    }

    /// What a formed row leaves.
    fn cut(&mut self, at: usize, k: T, found: &mut Interval<T>) {
        let Some(FormedRow { index, forms: Some(forms) }) = self.formed.at(at) else { return };
        for form in forms {
            if let Some(first) = found.cut(&HalfPlane::of(form, k), self.x0).and_then(|end| self.first.get_mut(end)) {
                *first = Some(*index);
            }
        }
    }

    /// Bernstein coefficients of x and u for an X2: those of products are means of products of them.
    fn reached(&self, k: T, x2: T) -> Reached<T> {
        let half = lit::<T>(0.5);
        let per = T::one() / self.segment.length;
        let middle = (self.x0 + x2) * half + k;
        let u = Spread { middle: (x2 - self.x0) * half * per, reach: k.abs() * per };
        let (low, high) = (least(least(self.x0, x2), middle), most(most(self.x0, x2), middle));
        let [below, above] = self.window.lines();
        let root = Spread::between(below.slope * low + below.height, above.slope * high + above.height);
        Reached { u, x: Spread::between(low, high), root }
    }

    /// The rows of a joint, as [`rows`] has them, that their intervals do not keep.
    fn doubtful(&self, joint: usize, at: &Reached<T>) -> [bool; 5] {
        let Limits { velocity, acceleration, effort, tool } = self.limits;
        // More than what is lost by rounding.
        let share: T = T::one() - lit::<T>(1e-6) - lit::<T>(64.0) * T::default_epsilon();
        let is_fast = |square: T, limit: T| !(square * (at.x.middle + at.x.reach) <= self.segment.most(limit) * share);
        let (Some(of), Some(assumption)) = (self.joints.get(joint), self.assumption.get(joint)) else {
            let mut doubtful = [false; 5];
            let limits = tool.iter().flat_map(|tool| tool.both());
            for ((to, square), limit) in doubtful.iter_mut().zip(&self.segment.tool).zip(limits) {
                let [a, b, c] = square.quadratic;
                *to = is_fast(most(most(a, b), c).max(T::zero()) + square.error, limit);
            }
            return doubtful;
        };
        let (Some(velocity), Some(acceleration), Some([low, high])) =
            (velocity.get(joint), acceleration.get(joint), effort.get(joint))
        else {
            return [false; 5];
        };
        let [m, c, d] = &of.torque;
        let mut torque = m.times(&at.u).plus(c.times(&at.x)).plus(*d).plus(*assumption);
        if let Some(v) = &of.v {
            torque = torque.plus(v.times(&at.root));
        }
        let is_steep = acceleration.is_finite() && {
            let error = Spread { middle: T::zero(), reach: of.rate_error * self.assumed.u };
            let all = of.rate.times(&at.u).plus(of.curvature.times(&at.x)).plus(error);
            !(all.size() <= *acceleration * share)
        };
        [
            !(torque.middle + torque.reach <= *high * share),
            !(torque.middle - torque.reach >= *low * share),
            is_steep,
            is_steep,
            is_fast(of.square[1], *velocity),
        ]
    }
}

/// The rows of a joint: torque high, torque low, acceleration high, low, speed; with the number N those of the end effector, two of them.
fn rows<const N: usize>(joint: usize) -> [usize; 5] {
    if joint == N {
        return [0, 1, 2, 3, 4].map(|row| 5 * N + row);
    }
    [2 * joint, 2 * joint + 1, 2 * (N + joint), 2 * (N + joint) + 1, 4 * N + joint]
}

/// The functions of a joint, as its rows have them; those of its acceleration if that `is_limited`.
fn functions<T: RealField + Copy, const N: usize>(
    segment: &Segment<T, N>,
    friction: &JointFriction<T>,
    joint: usize,
    is_limited: bool,
) -> Option<Functions<T>> {
    let [m, c, g] = [0, 1, 2].map(|part: usize| segment.torques.get(part).and_then(|of| of.get(joint)));
    let [rate, curvature, square] = [0, 1, 2].map(|part: usize| segment.rates.get(part).and_then(|of| of.get(joint)));
    let (m, c, g, rate, curvature, square, sign) = (m?, c?, g?, rate?, curvature?, square?, *segment.signs.get(joint)?);
    let (zero, one) = (T::zero(), T::one());
    let mut d = Spread::of(g.quadratic, g.error * (one + friction.load));
    d.middle += sign * friction.coulomb + friction.offset;
    if friction.load > zero {
        let size = Spread::of(g.quadratic, zero).size();
        d = d.plus(Spread::between(zero, size).scaled(sign * friction.load));
    }
    let none = Spread { middle: zero, reach: zero };
    let rates = if is_limited || friction.viscous != zero { Spread::of(rate.quadratic, zero) } else { none };
    let [q0, q1, q2] = square.quadratic;
    Some(Functions {
        torque: [Spread::of(m.quadratic, zero), Spread::of(c.quadratic, c.error), d],
        v: (friction.viscous != zero).then(|| rates.scaled(friction.viscous)),
        rate: rates,
        rate_error: rate.error,
        curvature: if is_limited { Spread::of(curvature.quadratic, curvature.error) } else { none },
        square: [(q0 + q1 + q1 + q2) * lit(0.25), most(most(q0, q1), q2).max(zero) + square.error],
        sign,
    })
}

/// Cubic and Stribeck friction by their chords and tangents within a window.
///
/// A chord of y^(3/2) and the part above 0 of a tangent lie below its largest value, and the tangent is at least -1/2 of its value where it
/// touches. Those of exp(-t), t = sqrt(y)/v, lie below 1, and the tangent is at least -t exp(-t)/2 y/y_touch > -0.184 y/y_touch.
fn curve<T: RealField + Copy>(friction: &JointFriction<T>, of: &Functions<T>, assumed: &Assumed<T>) -> Spread<T> {
    let [middle, largest] = of.square;
    let (highest, touch) = (largest * most(assumed.x[1], assumed.touch), middle * assumed.touch);
    let over = lit::<T>(1.0 + 1e-6);
    let mut sum = Spread { middle: T::zero(), reach: T::zero() };
    if friction.cubic != T::zero() {
        let value = highest * highest.sqrt() * over;
        sum = sum.plus(Spread::between(-value * lit(0.5), value).scaled(friction.cubic * of.sign));
    }
    if friction.stribeck != T::zero() {
        sum = sum.plus(Spread::between(-highest / touch * lit(0.184), over).scaled(friction.stribeck * of.sign));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::segment::Column;
    use super::*;

    /// The interval of X2 that all rows leave.
    fn of_all<const N: usize>(of: &Trial<'_, f64, N>, k: f64, assumed: &Assumed<f64>, next: [f64; 2], x0: f64) -> Interval<f64> {
        let window = Window::new(assumed.x, assumed.touch);
        let rows = (0..Segment::<f64, N>::ROWS)
            .filter_map(|index| of_row(of.segment, index, of.limits, of.friction, assumed, &window))
            .flat_map(|forms| forms.map(|form| HalfPlane::of(&form, k)));
        let mut found = Interval::new();
        for plane in rows.chain(others(of.segment.length, k, assumed, next).into_iter().flatten()) {
            found.cut(&plane, x0);
        }
        found
    }

    /// A trial leaves what all half-planes leave, though it forms few rows, and ends early only where that does not serve.
    #[test]
    fn a_trial_finds_what_all_half_planes_leave() {
        let mut state = 5u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let curved = JointFriction { cubic: 0.3, stribeck: 0.5, stribeck_velocity: 0.2, ..JointFriction::default() };
        let plain = JointFriction { viscous: 0.4, coulomb: 0.1, load: 0.2, offset: 0.1, ..JointFriction::default() };
        let friction = [plain, curved, JointFriction::default()];
        let limits = Limits::velocity([1.2, 1.5, 1.5]).and_then(|of| of.with_acceleration([f64::INFINITY, 3.0, 3.0]));
        let limits = limits.and_then(|of| of.with_effort([-3.0; 3], [3.0; 3])).expect("limits");
        let [mut some, mut none, mut early, mut formed, mut trials] = [0; 5];
        for round in 0..3000 {
            let mut segment = Segment::<f64, 3> { length: 0.1 + 0.9 * random(), signs: [1.0, -1.0, 0.0], ..Segment::empty() };
            for (part, of) in segment.torques.iter_mut().chain(&mut segment.rates).enumerate() {
                let least = if part == 5 { 0.0 } else { -1.0 };
                *of = [0; 3].map(|_| Column {
                    quadratic: [0; 3].map(|_| (least + (1.0 - least) * random()) * if round % 2 == 0 { 1.0 } else { 3.0 }),
                    error: 1e-3 * random(),
                });
            }
            let (x0, target, next) = (random(), 2.0 * random() - 0.5, [0.0, 0.3 + random()]);
            let near = |[low, high]: [f64; 2]| target.max(low).min(high);
            let mut formed_rows = Formed::new();
            let mut trial = Trial::new(&segment, &limits, &friction, segment.inner.assumed, x0, [None; 2], &mut formed_rows);
            for k in [0.0, 0.1, -0.1] {
                let assumed = Assumed { x: [0.0, 0.2 + 1.3 * random()], touch: 0.1 + random(), u: 4.0 };
                let at = of_all(&trial, k, &assumed, next, x0);
                let inside = x0 <= assumed.x[1].min(at.alone[1]) && x0 >= at.alone[0];
                let expected = (inside && at.width() >= 0.0).then(|| near(at.ends()));
                let found = trial.nearest(k, &assumed, next, target, |_| true);
                assert_eq!(found, expected, "{segment:?} {assumed:?} {x0} {k}");
                (formed, trials) = (formed + trial.count, trials + 1);
                let serves = |x2: f64| (x2 - target).abs() < 0.1;
                assert_eq!(trial.nearest(k, &assumed, next, target, serves), expected.filter(|x2| serves(*x2)));
                (some, none) = (some + usize::from(found.is_some()), none + usize::from(found.is_none()));
                early += usize::from(expected.is_some_and(|x2| !serves(x2)));
                let mut formed_rows = Formed::new();
                let mut trial = Trial::new(&segment, &limits, &friction, assumed, x0, [None; 2], &mut formed_rows);
                let range = backwards(assumed.x[0], assumed.x[1], |x0| of_all(&trial, k, &assumed, next, x0));
                let range = range.map(|range| range.map(|(x0, _)| x0));
                let found = trial.backwards(k, &assumed, next, assumed.x[0], assumed.x[1]);
                assert_eq!(found.is_some(), range.is_some(), "{segment:?} {assumed:?} {k}");
                let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * assumed.x[1];
                assert!(found.into_iter().zip(range).all(|(a, b)| near(a[0], b[0]) && near(a[1], b[1])), "{found:?}, {range:?}");
            }
        }
        assert!(some > 1000 && none > 1000 && early > 300, "{some} {none} {early}");
        // Of 13 rows.
        assert!(formed < 8 * trials, "{formed} in {trials}");
    }
}
