//! Trajectories: paths with time laws, planned once, sampled without allocation.
//!
//! A path is a chain of segments. Each has a shape (line, arc, pause) and a time law s(t) from 0 to 1, and
//!
//! ```text
//! p(t) = p_0 + sum_i (p_i(s_i(t - t_i)) - p_i(0)),    t_{i+1} = t_i + T_i - dt_{i+1}      (the book, Sect. 4.3)
//! ```
//!
//! With dt = 0 the point between two segments is a stop. With an anticipation dt > 0 the next segment starts before the previous
//! one has ended, and their displacements add. The point becomes a via point that is passed at a distance.
//!
//! - [`TimeLaw`]: how s runs: trapezoidal speed (by duration or by limits), cubic, quintic.
//! - [`Path`]: positions in space. [`OrientationProfile`]: turns. [`OperationalTrajectory`]: both.
//! - [`JointTrajectory`]: the same in joint space.
//!
//! Storage is the caller's: a chain owns anything that reads as a slice of segments, an array on a microcontroller, a `Vec` on a
//! host. Times are integer nanoseconds: at a corner of a law the acceleration is that of the phase that begins, at exactly the
//! sample that is meant. Requests that cannot be met are a [`PlanError`] with the number of the segment.
//!
//! ```
//! use std::time::Duration;
//! use armgen_runtime::trajectory::{JointSegment, JointTrajectory};
//!
//! // As fast as 2 rad/s and 5 rad/s² of the joint that moves farthest allow; both end together.
//! let to = JointSegment::within_limits([1.0, -0.5], [2.0, 2.0], [5.0, 5.0]);
//! let trajectory = JointTrajectory::plan([0.0_f64, 0.0], [to])?;
//! let half = trajectory.sample(trajectory.duration() / 2);
//! assert!((half.q[0] - 0.5).abs() < 1e-9 && (half.q[1] + 0.25).abs() < 1e-9);
//! assert_eq!(trajectory.sample(trajectory.duration() + Duration::from_secs(1)).q[0], 1.0);
//! # Ok::<(), armgen_runtime::trajectory::PlanError>(())
//! ```

mod chain;
mod joint;
mod law;
mod operational;
mod orientation;
mod path;
mod reach;

pub use joint::{JointSegment, JointTrajectory};
pub use law::{Profile, Progress, TimeLaw};
pub use operational::OperationalTrajectory;
pub use orientation::{OrientationProfile, OrientationSample, Turn};
pub use path::{Path, PathSample, Segment};
pub use reach::Reach;

/// Why a trajectory cannot be planned, and in which segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanError {
    /// Number of the segment (or turn), counted from 1; 0 where the fault is in the start.
    pub segment: usize,
    /// The fault.
    pub fault: PlanFault,
}

/// A fault of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanFault {
    /// A number is infinite or NaN.
    NotFinite,
    /// The duration is zero although something has to move.
    NoDuration,
    /// The acceleration time of a trapezoidal law is zero: the acceleration would be infinite.
    NoAccelerationTime,
    /// The cruise time T - 2 t_c is below zero: lengthen the duration or shorten the acceleration time.
    CruiseTimeNegative,
    /// The acceleration is below 4 L / T^2, with which the length cannot be covered in the duration.
    AccelerationTooSmall,
    /// The velocity is not above L / T and at most 2 L / T, between which a trapezoid exists.
    VelocityOutOfRange,
    /// A limit of velocity or acceleration is not positive.
    LimitNotPositive,
    /// The duration that follows from the limits is longer than the clock can count.
    TooLong,
    /// An arc starts at its own centre.
    ArcRadiusZero,
    /// The axis of an arc or turn has no direction.
    AxisZero,
    /// The start of an arc does not lie in the plane through its centre at right angles to its axis.
    ArcOffPlane,
    /// The end of an arc is not the stated one: centre, sweep and points do not fit together.
    ArcEndMismatch,
    /// The three points of an arc lie on a line, or coincide.
    ArcPointsCollinear,
    /// The first segment has nothing before it that it could anticipate.
    NothingToAnticipate,
    /// The anticipation is longer than this segment or the one before it, or reaches into the one before that.
    AnticipationTooLong,
    /// A point of the segment is out of the reach of the arm.
    OutOfReach,
    /// The matrix given as an orientation is not a rotation.
    NotARotation,
}

messages! { PlanError,
    PlanError { segment: 0, fault } => "at the start: {}", fault;
    PlanError { segment, fault } => "segment {}: {}", segment, fault;
}

messages! { PlanFault,
    PlanFault::NotFinite => "a number is infinite or NaN";
    PlanFault::NoDuration => "the duration is zero although something has to move";
    PlanFault::NoAccelerationTime => "the acceleration time is zero: the acceleration would be infinite";
    PlanFault::CruiseTimeNegative => "the acceleration time is more than half the duration: lengthen the duration or shorten the acceleration time";
    PlanFault::AccelerationTooSmall => "the acceleration is below 4 L / T^2, with which the length cannot be covered in the duration";
    PlanFault::VelocityOutOfRange => "the velocity is not above L / T and at most 2 L / T, between which a trapezoid exists";
    PlanFault::LimitNotPositive => "a limit of velocity or acceleration is not positive";
    PlanFault::TooLong => "the duration that follows from the limits is longer than the clock can count";
    PlanFault::ArcRadiusZero => "the arc starts at its own centre";
    PlanFault::AxisZero => "the axis has no direction";
    PlanFault::ArcOffPlane => "the start of the arc does not lie in the plane through its centre at right angles to its axis";
    PlanFault::ArcEndMismatch => "the end of the arc is not the stated one: centre, sweep and points do not fit together";
    PlanFault::ArcPointsCollinear => "the three points of the arc lie on a line, or coincide";
    PlanFault::NothingToAnticipate => "the first segment has nothing before it that it could anticipate";
    PlanFault::AnticipationTooLong => "the anticipation is longer than this segment or the one before it, or reaches into the one before that";
    PlanFault::OutOfReach => "a point of the segment is out of the reach of the arm";
    PlanFault::NotARotation => "the matrix given as an orientation is not a rotation";
}

impl PlanFault {
    /// This fault, in the segment with the given index (counted from 0).
    pub(crate) fn at(self, index: usize) -> PlanError {
        PlanError { segment: index + 1, fault: self }
    }
}
