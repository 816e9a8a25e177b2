//! Trajectories in joint space: all joints along straight lines of the joint space, under one time law a segment.
//!
//! q(t) = q_i + s(t) (q_f - q_i), all joints starting and ending together. The law's length is the largest |q_f - q_i| of a joint;
//! with limits for every joint the slowest one sets the pace.

use super::{
    chain::{last_started, next_slot, span, Slot},
    law::{Profile, TimeLaw},
    PlanError, PlanFault,
};
use crate::{linalg::is_finite, reference::JointReference};
use core::{marker::PhantomData, time::Duration};
use nalgebra::{RealField, SVector};

/// One segment of a joint trajectory; it starts where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSegment<T, const N: usize> {
    to: SVector<T, N>,
    pace: Pace<T, N>,
    anticipation: Duration,
    slot: Slot,
    profile: Profile<T>,
    from: SVector<T, N>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Pace<T, const N: usize> {
    Law(TimeLaw<T>),
    Limits { velocity: SVector<T, N>, acceleration: SVector<T, N> },
    Pause(Duration),
}

impl<T: RealField + Copy, const N: usize> JointSegment<T, N> {
    fn with(to: SVector<T, N>, pace: Pace<T, N>) -> Self {
        Self {
            to,
            pace,
            anticipation: Duration::ZERO,
            slot: Slot::default(),
            profile: Profile::rest(Duration::ZERO),
            from: SVector::zeros(),
        }
    }

    /// To `to`, rad or m, under a law; its length, velocity and acceleration apply to the joint that moves farthest.
    pub fn to(to: [T; N], law: TimeLaw<T>) -> Self {
        Self::with(to.into(), Pace::Law(law))
    }

    /// To `to`, rad or m, by the shortest trapezoidal speed within these limits of every joint, `velocity` in rad/s or m/s and
    /// `acceleration` in rad/s^2 or m/s^2; all joints start and end together. A limit of velocity may be infinite.
    ///
    /// They are limits of this segment alone: while it overlaps with another one ([`JointSegment::anticipating`]) the rates and the
    /// accelerations of both add.
    pub fn within_limits(to: [T; N], velocity: [T; N], acceleration: [T; N]) -> Self {
        Self::with(to.into(), Pace::Limits { velocity: velocity.into(), acceleration: acceleration.into() })
    }

    /// A stop that lasts.
    pub fn pause(duration: Duration) -> Self {
        Self::with(SVector::zeros(), Pace::Pause(duration))
    }

    /// The same segment, starting `anticipation` before the previous one ends: the point between them becomes a via point.
    ///
    /// Until then the rates and the accelerations of both add, also beyond the limits of [`JointSegment::within_limits`].
    #[must_use]
    pub fn anticipating(self, anticipation: Duration) -> Self {
        Self { anticipation, ..self }
    }

    /// When it starts, in a planned trajectory.
    pub fn start(&self) -> Duration {
        self.slot.start
    }

    /// When it ends, in a planned trajectory.
    pub fn end(&self) -> Duration {
        self.slot.end
    }

    fn plan(&mut self, from: SVector<T, N>, earlier: Option<Slot>, before_earlier: Option<Slot>) -> Result<(), PlanFault> {
        if let Pace::Pause(_) = self.pace {
            self.to = from;
        }
        if !is_finite(&self.to) {
            return Err(PlanFault::NotFinite);
        }
        let way = (self.to - from).abs();
        self.profile = match self.pace {
            Pace::Pause(duration) => Profile::rest(duration),
            Pace::Law(law) => law.resolve(way.max())?,
            Pace::Limits { velocity, acceleration } => {
                // Limits on s, of length 1: the joint with the least of each sets it.
                let mut limits: Option<(T, T)> = None;
                for i in 0..N {
                    if !(velocity[i] > T::zero() && acceleration[i] > T::zero()) {
                        return Err(PlanFault::LimitNotPositive);
                    }
                    if way[i] > T::zero() {
                        let (v, a) = (velocity[i] / way[i], acceleration[i] / way[i]);
                        limits = Some(limits.map_or((v, a), |(v0, a0)| (v0.min(v), a0.min(a))));
                    }
                }
                match limits {
                    Some((velocity, acceleration)) => TimeLaw::TrapezoidalByLimits { velocity, acceleration }.resolve(T::one())?,
                    None => Profile::rest(Duration::ZERO),
                }
            }
        };
        self.slot = next_slot(earlier, before_earlier, self.anticipation, self.profile.duration())?;
        self.from = from;
        Ok(())
    }

    fn sample(&self, t: Duration) -> JointReference<T, N> {
        let p = self.profile.at(span(self.slot.start, t).unwrap_or_default());
        let d = self.to - self.from;
        let q = if p.s == T::one() { self.to } else { self.from + d * p.s };
        JointReference { q, dq: d * p.ds, ddq: d * p.dds }
    }
}

/// A planned joint trajectory; `S` reads as a slice of segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTrajectory<T, const N: usize, S> {
    start: SVector<T, N>,
    segments: S,
    scalar: PhantomData<T>,
}

impl<T: RealField + Copy, const N: usize, S: AsRef<[JointSegment<T, N>]> + AsMut<[JointSegment<T, N>]>> JointTrajectory<T, N, S> {
    /// Plans the segments one after another from `start`, rad or m.
    ///
    /// # Errors
    /// With the number of the first segment that cannot be.
    pub fn plan(start: [T; N], mut segments: S) -> Result<Self, PlanError> {
        let start = SVector::from(start);
        if !is_finite(&start) {
            return Err(PlanError { segment: 0, fault: PlanFault::NotFinite });
        }
        let (mut from, mut earlier, mut before_earlier) = (start, None, None);
        for (i, segment) in segments.as_mut().iter_mut().enumerate() {
            segment.plan(from, earlier, before_earlier).map_err(|fault| fault.at(i))?;
            from = segment.to;
            before_earlier = earlier;
            earlier = Some(segment.slot);
        }
        Ok(Self { start, segments, scalar: PhantomData })
    }
}

impl<T: RealField + Copy, const N: usize, S: AsRef<[JointSegment<T, N>]>> JointTrajectory<T, N, S> {
    /// The segments, planned.
    pub fn segments(&self) -> &[JointSegment<T, N>] {
        self.segments.as_ref()
    }

    /// When the last segment ends.
    pub fn duration(&self) -> Duration {
        self.segments().last().map_or(Duration::ZERO, JointSegment::end)
    }

    /// Desired joint variables, rates and accelerations at `t`; at rest at the end afterwards.
    pub fn sample(&self, t: Duration) -> JointReference<T, N> {
        let segments = self.segments();
        let i = last_started(segments, |s| s.slot, t);
        let Some(segment) = segments.get(i) else {
            return JointReference::at_rest(self.start);
        };
        let mut sample = segment.sample(t);
        if let Some(earlier) = i.checked_sub(1).map(|i| &segments[i]).filter(|earlier| t < earlier.slot.end) {
            let rest = earlier.sample(t);
            sample.q += rest.q - earlier.to;
            sample.dq += rest.dq;
            sample.ddq += rest.ddq;
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn joints_start_and_end_together_within_every_limit() {
        let segments = [
            JointSegment::within_limits([1.0, -0.1, 0.0], [2.0, 0.05, 1.0], [1.0, 1.0, 1.0]),
            JointSegment::pause(SECOND),
            JointSegment::to([0.0, 0.0, 0.5], TimeLaw::Quintic { duration: SECOND }),
        ];
        let trajectory = JointTrajectory::plan([0.0f64; 3], segments).unwrap();
        let first = trajectory.segments()[0].end();
        let mut peak = [0.0f64; 3];
        for k in 0..=1000 {
            let sample = trajectory.sample(first * k / 1000);
            for i in 0..3 {
                peak[i] = peak[i].max(sample.dq[i].abs());
                assert!(sample.ddq[i].abs() <= 1.0);
            }
        }
        assert!(peak[0] <= 2.0 && peak[1] <= 0.05 && peak[1] > 0.0499 && peak[2] == 0.0, "{peak:?}");
        assert_eq!(trajectory.sample(first + SECOND / 2), JointReference::at_rest([1.0, -0.1, 0.0].into()));
        assert_eq!(trajectory.sample(first + 5 * SECOND), JointReference::at_rest([0.0, 0.0, 0.5].into()));
    }

    #[test]
    fn via_points_add_displacements() {
        let law = TimeLaw::Trapezoidal { duration: SECOND, acceleration_time: SECOND / 5 };
        let segments = [JointSegment::to([1.0], law), JointSegment::to([3.0], law).anticipating(SECOND / 5)];
        let trajectory = JointTrajectory::plan([0.0f64], segments).unwrap();
        assert_eq!(trajectory.duration(), 9 * SECOND / 5);
        let mut earlier = trajectory.sample(Duration::ZERO);
        for k in 1..=1800 {
            let sample = trajectory.sample(Duration::from_millis(k));
            assert!((sample.dq[0] - earlier.dq[0]).abs() < 0.0126, "no jump in velocity at {k} ms");
            assert!((sample.q[0] - earlier.q[0] - 0.0005 * (sample.dq[0] + earlier.dq[0])).abs() < 1e-5);
            earlier = sample;
        }
        assert_eq!(earlier.q[0], 3.0);
    }

    #[test]
    fn what_cannot_be_names_its_segment() {
        let law = TimeLaw::Trapezoidal { duration: SECOND, acceleration_time: SECOND / 5 };
        let fault = |third: JointSegment<f64, 1>| {
            JointTrajectory::plan([0.0], [JointSegment::to([1.0], law), JointSegment::pause(SECOND / 10), third]).unwrap_err()
        };
        let third = JointSegment::to([2.0], law);
        assert_eq!(fault(third.anticipating(SECOND / 5)), PlanFault::AnticipationTooLong.at(2));
        assert_eq!(fault(JointSegment::to([f64::NAN], law)), PlanFault::NotFinite.at(2));
        assert_eq!(fault(JointSegment::within_limits([2.0], [0.0], [1.0])), PlanFault::LimitNotPositive.at(2));
        let long = TimeLaw::Trapezoidal { duration: SECOND, acceleration_time: SECOND };
        assert_eq!(fault(JointSegment::to([2.0], long)), PlanFault::CruiseTimeNegative.at(2));
        let first = JointTrajectory::plan([0.0], [third.anticipating(SECOND / 5)]).unwrap_err();
        assert_eq!(first, PlanFault::NothingToAnticipate.at(0));
    }
}
