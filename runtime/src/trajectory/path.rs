//! Paths in space: lines and arcs, one after another.
//!
//! A line from p_i to p_f is p(s) = p_i + s (p_f - p_i) (the book, eq. 4.34). An arc about centre c and unit axis r starts at p_i
//! and spans the angle theta. It is p(s) = c + u cos(theta s) + r x u sin(theta s) with u = p_i - c (eq. 4.36, in the base
//! frame). Positive angles turn right-handed about r.

use super::{
    chain::{last_started, next_slot, span, Slot},
    law::{Profile, TimeLaw},
    PlanError, PlanFault,
};
use crate::{
    linalg::{direction, is_finite, lit},
    scalar::sin_cos,
};
use core::{marker::PhantomData, time::Duration};
use nalgebra::{RealField, Vector3};

/// One segment of a path: where it leads, how, and under which time law.
///
/// It starts where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<T> {
    shape: Shape<T>,
    law: TimeLaw<T>,
    anticipation: Duration,
    run: Run<T>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape<T> {
    Line { to: Vector3<T> },
    Arc { centre: Vector3<T>, axis: Vector3<T>, sweep: T, to: Option<Vector3<T>> },
    ArcThrough { via: Vector3<T>, to: Vector3<T> },
    Pause,
}

/// What planning adds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Run<T> {
    slot: Slot,
    profile: Profile<T>,
    from: Vector3<T>,
    to: Vector3<T>,
    length: T,
    arc: Option<Arc<T>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Arc<T> {
    centre: Vector3<T>,
    /// u = p_i - c and r x u.
    u: Vector3<T>,
    w: Vector3<T>,
    sweep: T,
}

/// Position, velocity and acceleration of a point; base frame, m, m/s, m/s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSample<T> {
    /// Position.
    pub position: Vector3<T>,
    /// Velocity.
    pub velocity: Vector3<T>,
    /// Acceleration.
    pub acceleration: Vector3<T>,
}

impl<T: RealField + Copy> Segment<T> {
    fn new(shape: Shape<T>, law: TimeLaw<T>) -> Self {
        let run = Run {
            slot: Slot::default(),
            profile: Profile::rest(Duration::ZERO),
            from: Vector3::zeros(),
            to: Vector3::zeros(),
            length: T::zero(),
            arc: None,
        };
        Self { shape, law, anticipation: Duration::ZERO, run }
    }

    /// A straight line to `to`, m.
    pub fn line(to: [T; 3], law: TimeLaw<T>) -> Self {
        Self::new(Shape::Line { to: to.into() }, law)
    }

    /// An arc about `centre`, m, in the plane at right angles to `axis`, through `sweep`, rad, right-handed about the axis.
    ///
    /// A sweep of 2 pi is a full circle.
    pub fn arc(centre: [T; 3], axis: [T; 3], sweep: T, law: TimeLaw<T>) -> Self {
        Self::new(Shape::Arc { centre: centre.into(), axis: axis.into(), sweep, to: None }, law)
    }

    /// The same arc, with its end stated: it is an error if centre, sweep and points do not fit within a millionth of the radius.
    pub fn arc_to(centre: [T; 3], axis: [T; 3], sweep: T, to: [T; 3], law: TimeLaw<T>) -> Self {
        Self::new(Shape::Arc { centre: centre.into(), axis: axis.into(), sweep, to: Some(to.into()) }, law)
    }

    /// The arc through `via` to `to`, m, on the circle through the start and both.
    pub fn arc_through(via: [T; 3], to: [T; 3], law: TimeLaw<T>) -> Self {
        Self::new(Shape::ArcThrough { via: via.into(), to: to.into() }, law)
    }

    /// A stop that lasts.
    pub fn pause(duration: Duration) -> Self {
        Self::new(Shape::Pause, TimeLaw::Cubic { duration })
    }

    /// The same segment, starting `anticipation` before the previous one ends: the point between them becomes a via point.
    #[must_use]
    pub fn anticipating(self, anticipation: Duration) -> Self {
        Self { anticipation, ..self }
    }

    /// When it starts, in a planned path.
    pub fn start(&self) -> Duration {
        self.run.slot.start
    }

    /// When it ends, in a planned path.
    pub fn end(&self) -> Duration {
        self.run.slot.end
    }

    /// Where it starts, m, base frame, in a planned path.
    pub fn from(&self) -> Vector3<T> {
        self.run.from
    }

    /// Where it ends, m, base frame, in a planned path.
    pub fn to(&self) -> Vector3<T> {
        self.run.to
    }

    /// Length of its path, m, in a planned path.
    pub fn length(&self) -> T {
        self.run.length
    }

    fn plan(&mut self, from: Vector3<T>, earlier: Option<Slot>, before_earlier: Option<Slot>) -> Result<(), PlanFault> {
        let (to, length, arc) = match self.shape {
            Shape::Line { to } => (to, (to - from).norm(), None),
            Shape::Pause => (from, T::zero(), None),
            Shape::Arc { centre, axis, sweep, to } => {
                let arc = Arc::about(from, centre, axis, sweep)?;
                let end = arc.at(T::one());
                if to.is_some_and(|to| !((to - end).norm() <= arc.u.norm() * fit::<T>())) {
                    return Err(PlanFault::ArcEndMismatch);
                }
                // Stated ends win over computed ones: no rounding is handed from segment to segment.
                (to.unwrap_or(end), (arc.u.norm() * sweep).abs(), Some(arc))
            }
            Shape::ArcThrough { via, to } => {
                let arc = Arc::through(from, via, to)?;
                (to, (arc.u.norm() * arc.sweep).abs(), Some(arc))
            }
        };
        if !(is_finite(&to) && length.is_finite()) {
            return Err(PlanFault::NotFinite);
        }
        let profile = match (self.shape, self.law) {
            (Shape::Pause, TimeLaw::Cubic { duration }) => Profile::rest(duration),
            _ => self.law.resolve(length)?,
        };
        let slot = next_slot(earlier, before_earlier, self.anticipation, profile.duration())?;
        self.run = Run { slot, profile, from, to, length, arc };
        Ok(())
    }

    /// Position, velocity and acceleration at `t`, clock of the path.
    #[inline]
    fn sample(&self, t: Duration) -> PathSample<T> {
        let p = self.run.profile.at(span(self.run.slot.start, t).unwrap_or_default());
        match &self.run.arc {
            None => {
                let d = self.run.to - self.run.from;
                // Past the middle count from the end: both ends are hit exactly.
                let position = if p.s > lit(0.5) { self.run.to - d * (T::one() - p.s) } else { self.run.from + d * p.s };
                PathSample { position, velocity: d * p.ds, acceleration: d * p.dds }
            }
            Some(arc) => {
                let (sine, cosine) = sin_cos(arc.sweep * p.s);
                let (rate, acceleration) = (arc.sweep * p.ds, arc.sweep * p.dds);
                let radial = arc.u * cosine + arc.w * sine;
                let tangential = arc.w * cosine - arc.u * sine;
                PathSample {
                    // s may round to 1 before the end, where the arm still moves.
                    position: if p.s == T::one() { self.run.to } else { arc.centre + radial },
                    velocity: tangential * rate,
                    acceleration: tangential * acceleration - radial * (rate * rate),
                }
            }
        }
    }
}

/// How well the points of an arc must fit, as a part of its radius.
fn fit<T: RealField + Copy>() -> T {
    lit::<T>(1e-6).max(T::default_epsilon() * lit(64.0))
}

impl<T: RealField + Copy> Arc<T> {
    fn about(from: Vector3<T>, centre: Vector3<T>, axis: Vector3<T>, sweep: T) -> Result<Self, PlanFault> {
        if !(is_finite(&centre) && is_finite(&axis) && sweep.is_finite()) {
            return Err(PlanFault::NotFinite);
        }
        let axis = direction(&axis).ok_or(PlanFault::AxisZero)?;
        let u = from - centre;
        let radius = u.norm();
        if !(radius > T::zero()) {
            return Err(PlanFault::ArcRadiusZero);
        }
        if axis.dot(&u).abs() > radius * fit::<T>() {
            return Err(PlanFault::ArcOffPlane);
        }
        Ok(Self { centre, u, w: axis.cross(&u), sweep })
    }

    /// The circle through three points. With a = via - from, b = to - from and n = a x b its centre is from + ((|a|^2 b - |b|^2
    /// a) x n) / (2 |n|^2).
    fn through(from: Vector3<T>, via: Vector3<T>, to: Vector3<T>) -> Result<Self, PlanFault> {
        if !(is_finite(&via) && is_finite(&to)) {
            return Err(PlanFault::NotFinite);
        }
        let (a, b) = (via - from, to - from);
        let n = a.cross(&b);
        if !(n.norm() > a.norm() * b.norm() * fit::<T>()) {
            return Err(PlanFault::ArcPointsCollinear);
        }
        let offset = (b * a.norm_squared() - a * b.norm_squared()).cross(&n) / (lit::<T>(2.0) * n.norm_squared());
        let centre = from + offset;
        let (u, axis) = (-offset, n.normalize());
        let w = axis.cross(&u);
        // The normal of (from, via, to) makes the turn over `via` the positive one.
        let end = to - centre;
        let mut sweep = w.dot(&end).atan2(u.dot(&end));
        if sweep <= T::zero() {
            sweep += T::two_pi();
        }
        Ok(Self { centre, u, w, sweep })
    }

    fn at(&self, s: T) -> Vector3<T> {
        let (sine, cosine) = sin_cos(self.sweep * s);
        self.centre + self.u * cosine + self.w * sine
    }
}

/// A planned path in space; `S` reads as a slice of segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path<T, S> {
    start: Vector3<T>,
    segments: S,
    scalar: PhantomData<T>,
}

impl<T: RealField + Copy, S: AsRef<[Segment<T>]> + AsMut<[Segment<T>]>> Path<T, S> {
    /// Plans the segments one after another from `start`, m.
    ///
    /// # Errors
    /// With the number of the first segment that cannot be.
    pub fn plan(start: [T; 3], mut segments: S) -> Result<Self, PlanError> {
        let start = Vector3::from(start);
        if !is_finite(&start) {
            return Err(PlanError { segment: 0, fault: PlanFault::NotFinite });
        }
        let (mut from, mut earlier, mut before_earlier) = (start, None, None);
        for (i, segment) in segments.as_mut().iter_mut().enumerate() {
            segment.plan(from, earlier, before_earlier).map_err(|fault| fault.at(i))?;
            from = segment.run.to;
            before_earlier = earlier;
            earlier = Some(segment.run.slot);
        }
        Ok(Self { start, segments, scalar: PhantomData })
    }
}

impl<T: RealField + Copy, S: AsRef<[Segment<T>]>> Path<T, S> {
    /// The segments, planned.
    pub fn segments(&self) -> &[Segment<T>] {
        self.segments.as_ref()
    }

    /// When the last segment ends.
    pub fn duration(&self) -> Duration {
        self.segments().last().map_or(Duration::ZERO, Segment::end)
    }

    /// Index of the segment that began last at `t`; zero for an empty path.
    pub fn segment_at(&self, t: Duration) -> usize {
        last_started(self.segments(), |s| s.run.slot, t)
    }

    /// Position, velocity and acceleration at `t`; at rest at the end afterwards.
    pub fn sample(&self, t: Duration) -> PathSample<T> {
        let segments = self.segments();
        let i = self.segment_at(t);
        let Some(segment) = segments.get(i) else {
            return PathSample { position: self.start, velocity: Vector3::zeros(), acceleration: Vector3::zeros() };
        };
        let mut sample = segment.sample(t);
        if let Some(earlier) = i.checked_sub(1).map(|i| &segments[i]).filter(|earlier| t < earlier.run.slot.end) {
            let rest = earlier.sample(t);
            sample.position += rest.position - earlier.run.to;
            sample.velocity += rest.velocity;
            sample.acceleration += rest.acceleration;
        }
        sample
    }
}
