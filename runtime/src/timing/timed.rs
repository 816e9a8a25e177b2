//! The result: the law, its proof in numbers, samples.

use super::law::Law;
use super::limits::Limits;
use super::model::{JointFriction, PathTorques};
use super::path::Piece;
use super::segment::{limit, Limit, Segment};
use crate::linalg::lit;
use crate::reference::JointReference;
use crate::scalar::seconds;
use crate::trajectory::Progress;
use core::time::Duration;
use nalgebra::{RealField, SVector};

/// A timed path: the fastest motion found, and the time that no motion on the path can beat.
#[derive(Clone, Copy, Debug)]
pub struct Timing<'a, T, const N: usize> {
    pieces: &'a [Piece<T, N>],
    segments: &'a [Segment<T, N>],
    pub(super) limits: Limits<T, N>,
    pub(super) friction: [JointFriction<T>; N],
    duration: T,
    lower_bound: T,
}

/// The largest values of a motion, each as a share of its limit; 0 where the limit is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins<T, const N: usize> {
    /// |dq| over its limit.
    pub velocity: [T; N],
    /// |ddq| over its limit.
    pub acceleration: [T; N],
    /// tau over its limit of the same sign.
    pub effort: [T; N],
    /// The end effector's speed and turn rate over their limits.
    pub tool: [T; 2],
}

/// The law of one segment, for files and figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile<T> {
    /// Where the segment begins and how long it is, in s.
    pub start: T,
    /// Its length.
    pub length: T,
    /// When it begins, s.
    pub time: T,
    /// x = ds² at its ends, and k of X1 = (X0 + X2)/2 + k.
    pub x: [T; 2],
    /// By how much the middle Bernstein coefficient exceeds the mean of the ends.
    pub k: T,
    /// x at its start is at most this, by the rows there alone; 1e30 where nothing bounds it.
    pub most: T,
    /// x at its start is at most this for every motion from the start to the end of the path.
    pub bound: T,
    /// From an x at its start between these the end can be reached.
    pub interval: [T; 2],
}

/// A barrier: no motion has an x above this law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpperBound<T> {
    /// 1 where it holds for motions that are below it at the left end, -1 at the right end, 0 always.
    pub direction: i8,
    /// x at the ends.
    pub x: [T; 2],
    /// By how much the middle coefficient exceeds the mean of the ends.
    pub k: T,
    /// The limit that proves it.
    pub limit: Limit,
    /// The joint of the limit.
    pub joint: usize,
}

impl<'a, T: RealField + Copy, const N: usize> Timing<'a, T, N> {
    #[allow(clippy::too_many_arguments)] // one caller
    pub(super) fn new(
        pieces: &'a [Piece<T, N>],
        segments: &'a [Segment<T, N>],
        count: usize,
        limits: &Limits<T, N>,
        friction: &[JointFriction<T>; N],
        duration: T,
        lower_bound: T,
    ) -> Self {
        let segments = segments.get(..count).unwrap_or(segments);
        Self { pieces, segments, limits: *limits, friction: *friction, duration, lower_bound }
    }

    pub(super) fn all(&self) -> &'a [Segment<T, N>] {
        self.segments
    }

    /// How long the motion takes, rounded up to a nanosecond.
    pub fn duration(&self) -> Duration {
        // Half a nanosecond more, and one for the rounding of the sum.
        crate::scalar::duration(self.duration + lit(1.5e-9)).unwrap_or(Duration::MAX)
    }

    /// How long the motion takes, s.
    pub fn seconds(&self) -> T {
        self.duration
    }

    /// No motion on this path within these limits takes less, s.
    pub fn lower_bound(&self) -> T {
        self.lower_bound
    }

    /// duration/lower bound - 1.
    pub fn gap(&self) -> T {
        self.duration / self.lower_bound - T::one()
    }

    /// How many segments the law has.
    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// The law of a segment; `None` where there are not as many.
    pub fn profile(&self, index: usize) -> Option<Profile<T>> {
        let segment = self.segments.get(index)?;
        let law = &segment.inner.law;
        Some(Profile {
            start: segment.start,
            length: segment.length,
            time: segment.time,
            x: [law.x0, law.x2],
            k: law.k,
            most: segment.bound.node,
            bound: segment.bound.x(),
            interval: segment.inner.interval,
        })
    }

    /// The barrier of a segment that proves the longest time; `None` where no row gives one.
    pub fn upper_bound(&self, index: usize) -> Option<UpperBound<T>> {
        let length = self.segments.get(index)?.length;
        let mut best: Option<(T, UpperBound<T>)> = None;
        for bound in self.barriers(index).into_iter().flatten() {
            let UpperBound { x: [x0, x2], k, .. } = bound;
            let time = Law { length, x0, k, x2 }.duration();
            if time.is_finite() && best.is_none_or(|(most, _)| time > most) {
                best = Some((time, bound));
            }
        }
        best.map(|(_, bound)| bound)
    }

    /// The barriers of a segment of the directions 1, -1 and 0.
    pub fn barriers(&self, index: usize) -> [Option<UpperBound<T>>; 3] {
        let mut all = [None; 3];
        let Some(segment) = self.segments.get(index) else { return all };
        for ((to, barrier), direction) in all.iter_mut().zip(&segment.bound.barriers).zip([1, -1, 0]) {
            *to = barrier.as_ref().map(|barrier| {
                let (limit, joint) = limit(barrier.row, N);
                let Law { x0, x2, k, .. } = barrier.law;
                UpperBound { direction, x: [x0, x2], k, limit, joint }
            });
        }
        all
    }

    /// s and its derivatives at a time; at rest beyond the ends, unless the motion does not rest there.
    pub fn progress(&self, t: Duration) -> Progress<T> {
        let t = seconds::<T>(t);
        let after = self.segments.partition_point(|segment| segment.time <= t);
        let Some(segment) = self.segments.get(after.saturating_sub(1)) else {
            return Progress { s: T::zero(), ds: T::zero(), dds: T::zero() };
        };
        let end = self.segments.get(after).map_or(self.duration, |next| next.time);
        let law = &segment.inner.law;
        if t >= self.duration {
            let ds = law.x2.max(T::zero()).sqrt();
            return Progress { s: segment.end(), ds, dds: if ds > T::zero() { law.acceleration()[1] } else { T::zero() } };
        }
        let (s, ds, dds) = law.at((t - segment.time).max(T::zero()).min(end - segment.time));
        Progress { s: segment.start + s, ds, dds }
    }

    /// s and its derivatives at the fraction `t` of a segment; `None` where there are not as many.
    pub fn at(&self, index: usize, t: T) -> Option<Progress<T>> {
        let segment = self.segments.get(index)?;
        let law = &segment.inner.law;
        let [u0, u1] = law.acceleration();
        let (ds, dds) = (law.x(t).max(T::zero()).sqrt(), u0 * (T::one() - t) + u1 * t);
        Some(Progress { s: segment.start + segment.length * t, ds, dds })
    }

    /// q, dq, ddq at a time.
    pub fn sample(&self, t: Duration) -> JointReference<T, N> {
        self.reference(&self.progress(t))
    }

    /// q, dq = q' ds and ddq = q' dds + q'' ds² at a place of the path.
    pub fn reference(&self, at: &Progress<T>) -> JointReference<T, N> {
        let index = self.pieces.partition_point(|piece| piece.start <= at.s).saturating_sub(1);
        let Some(piece) = self.pieces.get(index) else {
            return JointReference::at_rest(SVector::zeros());
        };
        let point = piece.at(at.s);
        JointReference { q: point.q, dq: point.slope * at.ds, ddq: point.slope * at.dds + point.curvature * (at.ds * at.ds) }
    }

    /// The quadratics of a segment that stand for the torques along the path, at the fraction `t` of it, and how far the torques are from
    /// them at most.
    pub fn enclosure(&self, index: usize, t: T) -> Option<[PathTorques<T, N>; 2]> {
        let segment = self.segments.get(index)?;
        let r = T::one() - t;
        let value = |[a, b, c]: [T; 3]| a * r * r + b * lit::<T>(2.0) * r * t + c * t * t;
        let of = |[inertial, velocity, gravity]: [[T; N]; 3]| PathTorques {
            inertial: inertial.into(),
            velocity: velocity.into(),
            gravity: gravity.into(),
        };
        Some([
            of(segment.torques.map(|part| part.map(|column| value(column.quadratic)))),
            of(segment.torques.map(|part| part.map(|column| column.error))),
        ])
    }

    /// The row of a segment that comes nearest to its limit in the middle, and its share of the limit.
    pub fn binding(&self, index: usize) -> Option<(Limit, usize, T)> {
        let segment = self.segments.get(index)?;
        let mut best: Option<(T, usize)> = None;
        self.shares(segment, lit(0.5), |row, share| {
            if best.is_none_or(|(most, _)| share > most) {
                best = Some((share, row));
            }
        });
        best.map(|(share, row)| {
            let (limit, joint) = limit(row, N);
            (limit, joint, share)
        })
    }

    /// Largest speeds, accelerations and torques as shares of their limits, at nine places of each segment.
    pub fn margins(&self) -> Margins<T, N> {
        let mut margins =
            Margins { velocity: [T::zero(); N], acceleration: [T::zero(); N], effort: [T::zero(); N], tool: [T::zero(); 2] };
        for segment in self.segments {
            for i in 0..9 {
                self.shares(segment, lit(f64::from(i) / 8.0), |row, share| {
                    let (limit, joint) = limit(row, N);
                    let of = match limit {
                        Limit::EffortHigh | Limit::EffortLow => &mut margins.effort,
                        Limit::AccelerationHigh | Limit::AccelerationLow => &mut margins.acceleration,
                        Limit::Velocity => &mut margins.velocity,
                        Limit::ToolSpeed | Limit::ToolTurnRate => {
                            let [speed, turn_rate] = &mut margins.tool;
                            let most = if limit == Limit::ToolSpeed { speed } else { turn_rate };
                            *most = most.max(share);
                            return;
                        }
                    };
                    if let Some(most) = of.get_mut(joint) {
                        *most = most.max(share);
                    }
                });
            }
        }
        margins
    }

    /// Each row at the fraction `t` of a segment, as a share of its limit; of speeds the root of the row of squares.
    fn shares(&self, segment: &Segment<T, N>, t: T, mut take: impl FnMut(usize, T)) {
        let law = &segment.inner.law;
        let (x, r) = (law.x(t).max(T::zero()), T::one() - t);
        let [u0, u1] = law.acceleration();
        let u = u0 * r + u1 * t;
        let value = |[a, b, c]: [T; 3]| a * r * r + b * lit::<T>(2.0) * r * t + c * t * t;
        for index in 0..Segment::<T, N>::ROWS {
            let Some(row) = segment.row(index, &self.limits, &self.friction, false) else { continue };
            let curve = row.curve.as_ref().map_or(T::zero(), |curve| curve.value(value(curve.square), x));
            let share = (value(row.m) * u + value(row.c) * x + value(row.v) * x.sqrt() + curve + value(row.d)) / row.bound;
            take(index, if index >= Segment::<T, N>::SLOPED { share.max(T::zero()).sqrt() } else { share });
        }
    }
}
