//! Trajectories in the operational space: a path and an orientation profile on one clock.

use super::{OrientationProfile, Path, PlanError, PlanFault, Reach, Segment, Turn};
use crate::reference::{OperationalReference, Pose};
use core::time::Duration;
use nalgebra::{RealField, Vector6};

/// Position along a [`Path`], orientation by an [`OrientationProfile`]; each rests at its end once it is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperationalTrajectory<T, S, O> {
    /// Where the end effector goes.
    pub path: Path<T, S>,
    /// How it turns meanwhile.
    pub orientation: OrientationProfile<T, O>,
}

impl<T: RealField + Copy, S: AsRef<[Segment<T>]>, O: AsRef<[Turn<T>]>> OperationalTrajectory<T, S, O> {
    /// When both have ended.
    pub fn duration(&self) -> Duration {
        self.path.duration().max(self.orientation.duration())
    }

    /// Desired pose, velocity and acceleration at `t`.
    pub fn sample(&self, t: Duration) -> OperationalReference<T> {
        let (p, o) = (self.path.sample(t), self.orientation.sample(t));
        let stack = |a: nalgebra::Vector3<T>, b: nalgebra::Vector3<T>| Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z);
        OperationalReference {
            pose: Pose { position: p.position, rotation: o.rotation },
            velocity: stack(p.velocity, o.velocity),
            acceleration: stack(p.acceleration, o.acceleration),
        }
    }

    /// Checks the position against the reach of the arm at every multiple of `period`, and at the end.
    ///
    /// # Errors
    /// [`PlanFault::OutOfReach`] with the number of the segment at the first such sample; [`PlanFault::NoDuration`] for a zero period.
    pub fn check_reach(&self, reach: &Reach<T>, period: Duration) -> Result<(), PlanError> {
        self.path.check_reach(reach, period)
    }
}

impl<T: RealField + Copy, S: AsRef<[Segment<T>]>> Path<T, S> {
    /// Checks the position against the reach of the arm at every multiple of `period`, and at the end.
    ///
    /// # Errors
    /// [`PlanFault::OutOfReach`] with the number of the segment at the first such sample; [`PlanFault::NoDuration`] for a zero period.
    pub fn check_reach(&self, reach: &Reach<T>, period: Duration) -> Result<(), PlanError> {
        if period.is_zero() {
            return Err(PlanError { segment: 0, fault: PlanFault::NoDuration });
        }
        let end = self.duration();
        let mut t = Duration::ZERO;
        loop {
            if !reach.contains(&self.sample(t).position) {
                return Err(PlanFault::OutOfReach.at(self.segment_at(t)));
            }
            if t == end {
                return Ok(());
            }
            t = t.saturating_add(period).min(end);
        }
    }
}
