//! Segments: a part of a piece with its functions as quadratics, each with a proved bound of what the quadratic misses.
//!
//! Nodes lie at distance d on a piece. Through the nine nearest nodes of the piece runs a polynomial p of degree 8; a segment takes the
//! quadratic through p's values at its ends and its middle. For a function f, with w half the length of the segment in node distances,
//!
//! ```text
//! |f - quadratic| <= max|p'''| w³/(9 sqrt 3) + M_9 d^9 max prod_{k=0..8} |t - k| + rounding
//! ```
//!
//! where p''' is bounded by its Bernstein coefficients and M_9 by majorants (`majorant.rs`). Halves of a segment use the same p, so they
//! need no dynamics, and the first term falls by eight.

use super::curve::Curve;
use super::law::Law;
use super::limits::Limits;
use super::majorant::{Bounds, NINE};
use super::model::{JointFriction, PathTorques};
use super::path::Piece;
use super::polynomial;
use super::row::{most, Quadratic, Row};
use crate::linalg::lit;
use nalgebra::{RealField, SVector};

/// A node: the torques of the arm at one place of the path.
#[derive(Clone, Copy, Debug)]
pub struct Node<T, const N: usize> {
    pub(super) torques: [SVector<T, N>; 3],
    /// Squares of the end effector's speed and turn rate for ds = 1; 0 where they are not limited.
    pub(super) tool: [T; 2],
}

impl<T: RealField + Copy, const N: usize> Node<T, N> {
    /// Storage without content.
    pub fn empty() -> Self {
        Self { torques: [SVector::zeros(); 3], tool: [T::zero(); 2] }
    }

    pub(super) fn new(torques: PathTorques<T, N>, tool: [T; 2]) -> Self {
        Self { torques: [torques.inertial, torques.velocity, torques.gravity], tool }
    }
}

/// A function on a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column<T> {
    pub quadratic: Quadratic<T>,
    /// |f - quadratic| is at most this.
    pub error: T,
}

/// An upper bound of x on a segment, of all motions: a law and the row that proves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Barrier<T> {
    pub law: Law<T>,
    pub row: usize,
}

/// A part of a path: functions, bounds, and the law. Storage of a timing, and its result.
#[derive(Clone, Copy, Debug)]
pub struct Segment<T, const N: usize> {
    pub(super) piece: usize,
    /// The node at the left end of the base segment, and the first of its nine nodes.
    pub(super) node: usize,
    pub(super) window: usize,
    /// The ends, in distances of nodes from `node`.
    pub(super) ends: [T; 2],
    /// Where it begins, in s.
    pub(super) start: T,
    pub(super) length: T,
    /// inertial, velocity, gravity of each joint.
    pub(super) torques: [[Column<T>; N]; 3],
    /// q', q'' and q'^2 of each joint.
    pub(super) rates: [[Column<T>; N]; 3],
    /// Squares of the end effector's speed and turn rate for ds = 1.
    pub(super) tool: [Column<T>; 2],
    /// Signs of q'.
    pub(super) signs: [T; N],
    /// The share of the limits of speed.
    pub(super) speed: T,
    /// Whether the motion rests at its left end.
    pub(super) stop: bool,
    pub(super) bound: Bound<T>,
    pub(super) inner: Inner<T>,
    /// Time at which it begins, s.
    pub(super) time: T,
    pub(super) split: bool,
    /// Whether its functions are new since the last bounds.
    pub(super) is_new: bool,
    /// Whether functions or bounds are others than those of which the law was made.
    pub(super) changed: bool,
    /// Whether the last pass made the interval anew.
    pub(super) fresh: bool,
}

/// What no motion exceeds: at the left end, and over the segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound<T> {
    /// From the rows at the left end alone.
    pub node: T,
    /// Reached from the start.
    pub forward: T,
    /// From which the end can be reached.
    pub backward: T,
    /// Over the segment: from the left, from the right, by speed.
    pub barriers: [Option<Barrier<T>>; 3],
}

impl<T: RealField + Copy> Bound<T> {
    /// x at the left end is at most this.
    pub(super) fn x(&self) -> T {
        self.node.min(self.forward).min(self.backward)
    }
}

/// What the rows of a segment assume of the law on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Assumed<T> {
    /// X0, X1 and X2 lie in this interval.
    pub x: [T; 2],
    /// Where the tangent of sqrt(x) touches.
    pub touch: T,
    /// |u| is at most this.
    pub u: T,
}

/// What a motion can do: at the left end, and the law.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inner<T> {
    /// From each x between these, at the left end, the end can be reached.
    pub interval: [T; 2],
    /// The law; before it is known, the estimate of the last grid.
    pub law: Law<T>,
    /// The interval of a pass that may fail.
    pub trial: [T; 2],
    /// What the rows assume that prove the law.
    pub assumed: Assumed<T>,
}

impl<T: RealField + Copy, const N: usize> Segment<T, N> {
    /// Storage without content.
    pub fn empty() -> Self {
        let zero = T::zero();
        let law = Law { length: zero, x0: zero, k: zero, x2: zero };
        let column = Column { quadratic: [zero; 3], error: zero };
        Self {
            piece: 0,
            node: 0,
            window: 0,
            ends: [zero; 2],
            start: zero,
            length: zero,
            torques: [[column; N]; 3],
            rates: [[column; N]; 3],
            tool: [column; 2],
            signs: [zero; N],
            speed: T::one(),
            stop: false,
            bound: Bound { node: zero, forward: zero, backward: zero, barriers: [None; 3] },
            inner: Inner { interval: [zero; 2], law, trial: [zero; 2], assumed: Assumed { x: [zero; 2], touch: zero, u: zero } },
            time: zero,
            split: false,
            is_new: true,
            changed: true,
            fresh: true,
        }
    }

    /// The part from the fraction `from` to the end (de Casteljau).
    pub(super) fn part(&self, from: T) -> Self {
        let rest = T::one() - from;
        let mut part = Self { start: self.start + self.length * from, length: self.length * rest, ..*self };
        for of in part.torques.iter_mut().chain(&mut part.rates).flatten().chain(&mut part.tool) {
            let [a, b, c] = of.quadratic;
            let (left, right) = (a * rest + b * from, b * rest + c * from);
            of.quadratic = [left * rest + right * from, right, c];
        }
        part
    }

    /// The first joint that no torque within its limits holds at rest at an end of the segment, with the torque and the limit.
    pub(super) fn unheld(&self, at_end: bool, limits: &Limits<T, N>, friction: &[JointFriction<T>; N]) -> Option<(usize, T, T)> {
        let gravity = self.torques[2].map(|column| if at_end { column.quadratic[2] } else { column.quadratic[0] });
        let joints = gravity.into_iter().zip(friction).zip(limits.effort).enumerate();
        let mut sides = joints.flat_map(|(joint, ((gravity, of), [low, high]))| {
            let torque = gravity + of.offset;
            let dry = of.coulomb + of.stribeck + of.load * gravity.abs();
            [(joint, torque, high + dry), (joint, -torque, -low + dry)]
        });
        sides.find(|(_, torque, limit)| torque > limit)
    }

    /// Where the segment ends, in s.
    pub(super) fn end(&self) -> T {
        self.start + self.length
    }

    /// How many rows a segment has: torque and acceleration of each joint, both sides, and speed; speed and turn rate of the end effector.
    pub(super) const ROWS: usize = Self::TOOL + 2;

    /// Before those of the end effector.
    pub(super) const TOOL: usize = 5 * N;

    /// Of which a slope of x enters.
    pub(super) const SLOPED: usize = 4 * N;

    /// Row `index` as an upper bound, `None` where the limit is infinite. The rows of a joint: torque high, torque low, then of all joints
    /// acceleration high, low, then speed, then the end effector's. Friction that grows with |g| enters from above, or if `relaxed` from below.
    pub(super) fn row(
        &self,
        index: usize,
        limits: &Limits<T, N>,
        friction: &[JointFriction<T>; N],
        relaxed: bool,
    ) -> Option<Row<T>> {
        let (group, joint) = (index / (2 * N), (index % (2 * N)) / 2);
        match group {
            0 => self.torque(joint, index % 2, limits.effort.get(joint)?, friction.get(joint)?, relaxed),
            1 => self.acceleration(joint, index % 2, *limits.acceleration.get(joint)?),
            _ if index < Self::TOOL => {
                Some(self.speed(self.rates[2].get(index - Self::SLOPED)?, *limits.velocity.get(index - Self::SLOPED)?))
            }
            _ => Some(self.speed(self.tool.get(index - Self::TOOL)?, *limits.tool?.both().get(index - Self::TOOL)?)),
        }
        .filter(|row| row.bound.is_finite())
    }

    /// Calls `with` with each row into which a slope of x enters and whose m and side (0: high, 1: low) are wanted, and its index, in order.
    #[inline]
    pub(super) fn each_sloped(
        &self,
        limits: &Limits<T, N>,
        friction: &[JointFriction<T>; N],
        relaxed: bool,
        wanted: impl Fn(&Column<T>, usize) -> bool,
        mut with: impl FnMut(usize, Row<T>),
    ) {
        for (joint, ((effort, friction), m)) in limits.effort.iter().zip(friction).zip(&self.torques[0]).enumerate() {
            for side in (0..2).filter(|side| wanted(m, *side)) {
                if let Some(row) = self.torque(joint, side, effort, friction, relaxed) {
                    with(2 * joint + side, row);
                }
            }
        }
        for (joint, (limit, m)) in limits.acceleration.iter().zip(&self.rates[0]).enumerate().filter(|(_, (l, _))| l.is_finite())
        {
            for side in (0..2).filter(|side| wanted(m, *side)) {
                if let Some(row) = self.acceleration(joint, side, *limit) {
                    with(2 * (N + joint) + side, row);
                }
            }
        }
    }

    /// What speeds squared may be at most under a limit.
    pub(super) fn most(&self, limit: T) -> T {
        let limit = limit * self.speed;
        limit * limit
    }

    /// A speed at most `limit`, squared.
    #[inline]
    fn speed(&self, square: &Column<T>, limit: T) -> Row<T> {
        let zero = [T::zero(); 3];
        Row {
            m: zero,
            c: square.quadratic,
            v: zero,
            d: zero,
            m_error: T::zero(),
            c_error: square.error,
            v_error: T::zero(),
            d_error: T::zero(),
            bound: self.most(limit),
            curve: None,
        }
    }

    /// ddq at most `limit`, or at least -`limit`.
    #[inline]
    fn acceleration(&self, joint: usize, side: usize, limit: T) -> Option<Row<T>> {
        let zero = [T::zero(); 3];
        let side = if side == 0 { T::one() } else { -T::one() };
        let signed = |q: Quadratic<T>| q.map(|x| x * side);
        let [rate, curvature] = [self.rates[0].get(joint)?, self.rates[1].get(joint)?];
        limit.is_finite().then(|| Row {
            m: signed(rate.quadratic),
            c: signed(curvature.quadratic),
            v: zero,
            d: zero,
            m_error: rate.error,
            c_error: curvature.error,
            v_error: T::zero(),
            d_error: T::zero(),
            bound: limit,
            curve: None,
        })
    }

    /// The torque at most its upper limit, or at least its lower one.
    #[inline]
    fn torque(&self, joint: usize, side: usize, effort: &[T; 2], of: &JointFriction<T>, relaxed: bool) -> Option<Row<T>> {
        let [low, high] = *effort;
        let (side, bound) = if side == 0 { (T::one(), high) } else { (-T::one(), -low) };
        if !bound.is_finite() {
            return None;
        }
        let signed = |q: Quadratic<T>| q.map(|x| x * side);
        let [m, c, g] = [self.torques[0].get(joint)?, self.torques[1].get(joint)?, self.torques[2].get(joint)?];
        let [rate, square] = [self.rates[0].get(joint)?, self.rates[2].get(joint)?];
        let sign = *self.signs.get(joint)?;
        let curve = (of.has_curve() && sign != T::zero()).then(|| Curve {
            cubic: of.cubic * side * sign,
            stribeck: of.stribeck * side * sign,
            velocity: of.stribeck_velocity,
            square: square.quadratic,
            error: square.error,
        });
        let mut d = signed(g.quadratic).map(|g| g + side * (sign * of.coulomb + of.offset));
        let mut d_error = g.error;
        if of.load > T::zero() && sign != T::zero() {
            d_error += of.load * g.error;
            let all = |sign: T| g.quadratic.iter().all(|g| *g * sign >= T::zero());
            let adds = side * sign > T::zero();
            let load = of.load * side * sign;
            let size = if all(T::one()) {
                g.quadratic
            } else if all(-T::one()) {
                g.quadratic.map(|g| -g)
            } else if adds != relaxed {
                // |g| is convex: its values at the Bernstein coefficients bound it from above.
                g.quadratic.map(|g| g.abs())
            } else {
                [T::zero(); 3]
            };
            for (d, size) in d.iter_mut().zip(size) {
                *d += load * size;
            }
        }
        Some(Row {
            m: signed(m.quadratic),
            c: signed(c.quadratic),
            v: rate.quadratic.map(|q| q * of.viscous * side),
            d,
            m_error: m.error,
            c_error: c.error,
            v_error: of.viscous * rate.error,
            d_error,
            bound,
            curve,
        })
    }
}

/// Which limit a row is, and of which joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The torque (force) at its upper limit.
    EffortHigh,
    /// The torque (force) at its lower limit.
    EffortLow,
    /// The acceleration at its upper limit.
    AccelerationHigh,
    /// The acceleration at its lower limit.
    AccelerationLow,
    /// The speed.
    Velocity,
    /// The speed of the end effector.
    ToolSpeed,
    /// The angular speed of the end effector.
    ToolTurnRate,
}

/// The limit of row `index` of `joints` joints, and the joint; of the end effector, the last one.
pub(super) fn limit(index: usize, joints: usize) -> (Limit, usize) {
    match index / (2 * joints.max(1)) {
        0 if index.is_multiple_of(2) => (Limit::EffortHigh, index / 2),
        0 => (Limit::EffortLow, index / 2),
        1 if index.is_multiple_of(2) => (Limit::AccelerationHigh, (index - 2 * joints) / 2),
        1 => (Limit::AccelerationLow, (index - 2 * joints) / 2),
        _ if index < 5 * joints => (Limit::Velocity, index - 4 * joints),
        _ => (if index == 5 * joints { Limit::ToolSpeed } else { Limit::ToolTurnRate }, joints.saturating_sub(1)),
    }
}

/// Bernstein coefficients of the third derivative of the polynomial through nine nodes, on the two distances after node `a`: one row of
/// weights of the nine values for each.
pub(super) type ThirdDerivative<T> = [[T; NINE]; polynomial::ORDER];

/// For a = 0, 1, ... 6.
pub(super) struct Interpolation<T> {
    third: [ThirdDerivative<T>; NINE - 2],
}

impl<T: RealField + Copy> Interpolation<T> {
    pub(super) fn new() -> Self {
        let mut third = [[[T::zero(); NINE]; polynomial::ORDER]; NINE - 2];
        for (a, of) in third.iter_mut().enumerate() {
            for j in 0..NINE {
                // The Lagrange polynomial of node j, in x = t - a; its numbers are quotients of integers that the scalar holds.
                let mut powers = [T::zero(); NINE];
                powers[0] = T::one();
                let mut scale = T::one();
                for m in (0..NINE).filter(|m| *m != j) {
                    let x: T = lit(m as f64 - a as f64);
                    for k in (0..NINE).rev() {
                        let lower = if k > 0 { powers[k - 1] } else { T::zero() };
                        powers[k] = lower - powers[k] * x;
                    }
                    scale *= lit(j as f64 - m as f64);
                }
                let mut derivative = [T::zero(); polynomial::ORDER];
                for (k, to) in derivative.iter_mut().enumerate() {
                    *to = powers[k + 3] * lit(((k + 1) * (k + 2) * (k + 3)) as f64) / scale;
                }
                for (row, value) in of.iter_mut().zip(polynomial::bernstein(&derivative, lit(2.0))) {
                    row[j] = value;
                }
            }
        }
        Self { third }
    }
}

/// Weights of the nine values for the value at `t`, in distances from the first node.
fn lagrange<T: RealField + Copy>(t: T) -> [T; NINE] {
    /// (-1)^(8 - j)/(j! (8 - j)!).
    const SCALE: [f64; NINE] = [
        1.0 / 40320.0,
        -1.0 / 5040.0,
        1.0 / 1440.0,
        -1.0 / 720.0,
        1.0 / 576.0,
        -1.0 / 720.0,
        1.0 / 1440.0,
        -1.0 / 5040.0,
        1.0 / 40320.0,
    ];
    // Products from the left and from the right: no division, and a node itself has the weights 0 and 1.
    let mut weights = SCALE.map(lit::<T>);
    let mut left = T::one();
    for (j, weight) in weights.iter_mut().enumerate() {
        *weight *= left;
        left *= t - lit(j as f64);
    }
    let mut right = T::one();
    for (j, weight) in weights.iter_mut().enumerate().rev() {
        *weight *= right;
        right *= t - lit(j as f64);
    }
    weights
}

/// A bound of prod_{k=0..8} |t - k| on the two distances after node `a`: two nodes at most a quarter together, the others by their farther end.
fn product_of_distances(a: usize) -> f64 {
    let between = |j: usize| {
        (0..NINE)
            .filter(|k| *k != j && *k != j + 1)
            .map(|k| (j as f64 - k as f64).abs().max((j as f64 + 1.0 - k as f64).abs()))
            .product::<f64>()
            * 0.25
    };
    between(a).max(between(a + 1))
}

/// How far over its ends a base segment is used, in distances: its end may be moved to a root of a joint's rate.
pub(super) const OVER: f64 = 1e-6;

/// What a piece lends to its segments.
pub(super) struct Source<'a, T, const N: usize> {
    pub piece: &'a Piece<T, N>,
    pub nodes: &'a [Node<T, N>],
    /// Distance of nodes.
    pub distance: T,
    /// Sizes of the torques, and their ninth Taylor coefficients.
    pub bounds: &'a [Bounds<T, N>; 2],
    /// Whether the end effector is limited.
    pub with_tool: bool,
    pub interpolation: &'a Interpolation<T>,
}

impl<T: RealField + Copy, const N: usize> Source<'_, T, N> {
    /// Fills in the functions of a segment: `piece`, `node`, `window`, `ends`, `start` and `length` are there.
    pub(super) fn fill(&self, segment: &mut Segment<T, N>) {
        self.fill_torques(segment);
        self.fill_rates(segment);
        segment.speed = self.piece.speed;
    }

    fn fill_torques(&self, segment: &mut Segment<T, N>) {
        let a = segment.node.saturating_sub(segment.window);
        let (Some(window), Some(third)) =
            (self.nodes.get(segment.window..segment.window + NINE), self.interpolation.third.get(a))
        else {
            return;
        };
        let half = lit::<T>(0.5);
        let [from, to] = segment.ends;
        let places = [from, (from + to) * half, to];
        let shift: T = lit(a as f64);
        // At a node the polynomial has its value.
        let nodes = places.map(|t| {
            let node = [0u8, 1, 2].iter().position(|node| lit::<T>(f64::from(*node)) == t);
            node.and_then(|node| window.get(a + node))
        });
        let weights = places.map(|t| lagrange(t + shift));
        let width = (to - from) * half;
        // 1/(9 sqrt 3); over the ends of its interval a polynomial of degree 5 grows by (1 + 2 OVER)^5.
        let cube = width * width * width * lit(0.064_150_029_909_958_42 * (1.0 + 20.0 * OVER));
        let mut power = T::one();
        for _ in 0..NINE {
            power *= self.distance;
        }
        let remainder = power * lit(product_of_distances(a) * (1.0 + 100.0 * OVER));
        let rounding = T::default_epsilon() * lit(32.0);
        let sizes = [&self.bounds[0].inertial, &self.bounds[0].velocity, &self.bounds[0].gravity];
        let ninth = [&self.bounds[1].inertial, &self.bounds[1].velocity, &self.bounds[1].gravity];
        for part in 0..3 {
            // All joints at once: the compiler takes several side by side.
            let dot = |weights: &[T; NINE]| {
                let mut sum = [T::zero(); N];
                for (weight, node) in weights.iter().zip(window) {
                    for (sum, value) in sum.iter_mut().zip(node.torques[part].iter()) {
                        *sum += *weight * *value;
                    }
                }
                sum
            };
            let at = |place: usize| nodes[place].map_or_else(|| dot(&weights[place]), |node| node.torques[part].into());
            let [left, middle, right] = [at(0), at(1), at(2)];
            let mut steepest = [T::zero(); N];
            for row in third {
                for (steepest, value) in steepest.iter_mut().zip(dot(row)) {
                    *steepest = most(*steepest, value.abs());
                }
            }
            for joint in 0..N {
                segment.torques[part][joint] = Column {
                    quadratic: through(left[joint], middle[joint], right[joint]),
                    error: steepest[joint] * cube + ninth[part][joint] * remainder + sizes[part][joint] * rounding,
                };
            }
        }
        if !self.with_tool {
            return;
        }
        for part in 0..2 {
            let dot = |weights: &[T; NINE]| {
                weights.iter().zip(window).fold(T::zero(), |sum, (weight, node)| sum + *weight * node.tool[part])
            };
            let at = |place: usize| nodes[place].map_or_else(|| dot(&weights[place]), |node| node.tool[part]);
            let [left, middle, right] = [at(0), at(1), at(2)];
            let steepest = third.iter().fold(T::zero(), |steepest, row| most(steepest, dot(row).abs()));
            let [size, ninth] = [self.bounds[0].tool[part], self.bounds[1].tool[part]];
            segment.tool[part] =
                Column { quadratic: through(left, middle, right), error: steepest * cube + ninth * remainder + size * rounding };
        }
    }

    fn fill_rates(&self, segment: &mut Segment<T, N>) {
        let half = lit::<T>(0.5);
        let w = segment.length * half;
        let middle = segment.start - self.piece.start + w;
        for joint in 0..N {
            let q = polynomial::shifted(&self.piece.joint(joint), middle);
            let rate = polynomial::derivative(&q);
            let curvature = polynomial::derivative(&rate);
            let mut square = [T::zero(); 9];
            for (i, a) in rate.iter().take(5).enumerate() {
                for (j, b) in rate.iter().take(5).enumerate() {
                    square[i + j] += *a * *b;
                }
            }
            segment.rates[0][joint] = column(&rate, w);
            segment.rates[1][joint] = column(&curvature, w);
            segment.rates[2][joint] = column(&square, w);
            let middle = rate[0];
            segment.signs[joint] = if middle > T::zero() {
                T::one()
            } else if middle < T::zero() {
                -T::one()
            } else {
                T::zero()
            };
        }
    }
}

/// The quadratic through three values, in Bernstein form.
fn through<T: RealField + Copy>(left: T, middle: T, right: T) -> Quadratic<T> {
    [left, middle + middle - (left + right) * lit(0.5), right]
}

/// The quadratic through the values of a polynomial at -w, 0, w, and what it misses: |t^k - t| or |t^k - t²| on [-1, 1].
fn column<T: RealField + Copy>(powers: &[T], w: T) -> Column<T> {
    const MISSED: [f64; 9] = [0.0, 0.0, 0.0, 0.384_900_179_459_750_6, 0.25, 0.534_992_243_2, 0.384_900_2, 0.620_6, 0.472_5];
    let (mut even, mut odd, mut power, mut error, mut size) = (T::zero(), T::zero(), T::one(), T::zero(), T::zero());
    for (k, c) in powers.iter().enumerate() {
        let term = *c * power;
        if k > 0 && k % 2 == 0 {
            even += term;
        } else if k % 2 == 1 {
            odd += term;
        }
        error += term.abs() * lit(MISSED.get(k).copied().unwrap_or(1.0));
        size += term.abs();
        power *= w;
    }
    let middle = powers.first().copied().unwrap_or(T::zero());
    Column {
        quadratic: [middle + even - odd, middle - even, middle + even + odd],
        error: error + size * T::default_epsilon() * lit(8.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    /// prod (t - k) vanishes at all nodes, so the polynomial through them is 0 and the ninth coefficient is all that bounds it.
    #[test]
    fn the_ninth_coefficient_bounds_what_the_nodes_do_not_see() {
        let distance = 0.1f64;
        let piece = Piece::new(0.0, 8.0 * distance, [SVector::<f64, 1>::zeros(); 6]);
        let of = |x: f64| Bounds { inertial: [x], velocity: [x], gravity: [x], tool: [x; 2] };
        let bounds = [of(0.0), of(distance.powi(-9))];
        let (nodes, interpolation) = (vec![Node::empty(); NINE], Interpolation::new());
        let source =
            Source { piece: &piece, nodes: &nodes, distance, bounds: &bounds, with_tool: true, interpolation: &interpolation };
        for a in 0..NINE - 2 {
            let mut segment = Segment { node: a, ends: [0.0, 2.0], length: 2.0 * distance, ..Segment::empty() };
            source.fill(&mut segment);
            let product = |t: f64| (0..NINE).map(|k| t - k as f64).product::<f64>().abs();
            let most = (0..=400).map(|i| product(a as f64 + f64::from(i) / 200.0)).fold(0.0, f64::max);
            for of in segment.torques.iter().flatten().chain(&segment.tool) {
                assert!((most..4.0 * most).contains(&of.error), "{a}: {} for {most}", of.error);
            }
        }
    }
}
