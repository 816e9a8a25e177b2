//! Along a path with one posture: [`follow`] keeps to a branch of the inverse kinematics and says, before anything moves, where it ends.
//!
//! A pose has several postures; each is continued along a path until it meets another one (the Jacobian is singular there and, in general,
//! both end), the path leaves the reach of the arm, or a joint comes to a limit. All postures at a pose are known ([`InverseKinematics`]),
//! so the posture that continues one is told from the others by distances: a step of the path's parameter is accepted if the nearest of the
//! postures behind it is within 0.5 rad or m, every other at least four times as far from that one, and the signs that tell branches apart
//! are the same ([`InverseKinematics::branch_signs`]). Otherwise the step is halved. Where a step of 1e-9 of the path is refused the branch
//! ends.
//!
//! ```
//! use armgen_runtime::inverse_kinematics::{follow, BranchEnd};
//! use armgen_runtime::nalgebra::{SVector, Vector3};
//! use armgen_runtime::reference::Pose;
//! use armgen_runtime::robot::InverseKinematics;
//!
//! /// Whether the arm can carry out a straight line from `start` on: 1, or the part of it that it can.
//! fn part<R: InverseKinematics<6, 8, Real = f64>>(robot: &R, start: &SVector<f64, 6>, by: Vector3<f64>) -> f64 {
//!     let from = Pose::of(robot, start);
//!     let line = |s: f64| Pose { position: from.position + by * s, ..from };
//!     let followed = follow(robot, line, start, 100, |_, _| ());
//!     if let Some(BranchEnd::Singular) = followed.end {
//!         // Singular at `followed.s`: take another posture at the start, or move the path.
//!     }
//!     followed.s
//! }
//! ```

use crate::linalg::{is_finite, lit};
use crate::reference::Pose;
use crate::robot::{InverseKinematics, JointRanges, Postures, RedundantInverseKinematics, Verdict};
use nalgebra::{RealField, SVector};

/// Where following a branch came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed<T, const N: usize> {
    /// The path's parameter up to which the branch was followed; 1 at the path's end.
    pub s: T,
    /// The posture there, angles continued from the start: beyond a half turn they keep counting.
    pub q: SVector<T, N>,
    /// What ends the branch within 1e-9 behind `s` (in single precision 1e-6); none where the path's end was reached.
    pub end: Option<BranchEnd>,
}

/// What ends a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BranchEnd {
    /// No posture reaches the poses behind.
    Unreachable,
    /// The posture is singular: it meets another one, or would go over into another branch. Others may go on.
    Singular,
    /// Joints can move while the end effector stays: the posture is not determined by the pose.
    Continuum,
    /// The path gives a pose that is none, or the start is not finite.
    Invalid,
    /// The joint (counted from 0) comes to its limit.
    Limit {
        /// The joint, counted from 0.
        joint: usize,
    },
    /// No posture at the start of the path is within 1e-3 of the posture to start from.
    Start,
    /// The path itself jumps.
    Jump,
    /// Too many poses were asked for; so often does the branch come near others.
    TooManyPoses,
}

messages! { BranchEnd,
    BranchEnd::Unreachable => "the path leaves the reach of the arm";
    BranchEnd::Singular => "the posture is singular: it meets another one, or would go over into another branch";
    BranchEnd::Continuum => "joints can move while the end effector stays: the pose does not determine the posture";
    BranchEnd::Invalid => "a pose of the path, or the start, is not finite or has no rotation";
    BranchEnd::Limit { joint } => "joint {} comes to its limit", joint + 1;
    BranchEnd::Start => "the posture to start from does not reach the start of the path";
    BranchEnd::Jump => "the path jumps";
    BranchEnd::TooManyPoses => "the branch comes near others too often to be followed";
}

/// Beyond a limit by at most this times the root of the scalar's epsilon, rad or m, a joint variable has been moved there by rounding: 7e-10 in
/// double precision. It is put at the limit.
const LIMIT_ERROR: f64 = 0.05;

/// A posture that continues another is at least so many times nearer than the others.
const APART: f64 = 4.0;

/// A posture farther from the one before it, in one step, does not continue it; rad or m.
const FAR: f64 = 0.5;

/// A start this far from the path's first pose is off the path, rad or m.
const OFF: f64 = 1e-3;

/// Postures nearer to each other than this, 1e-9 of the path before the branch ends, are about to meet; rad or m.
const MEETING: f64 = 0.05;

/// Follows the posture `start` along `path`, from its parameter 0 to 1, within the limits of the description's joints, and hands each posture
/// on the way to `each` with its parameter. At least `steps` poses are asked for, at equal steps, more where the branch comes near others.
///
/// Two postures that meet and part again between two neighbouring poses, and a path that leaves the reach and comes back there, are not
/// noticed: `steps` says how fine the path is looked at. At most 64 times `steps` poses, and 8192 more, are asked for.
pub fn follow<R, T, const N: usize, const K: usize>(
    robot: &R,
    mut path: impl FnMut(T) -> Pose<T>,
    start: &SVector<T, N>,
    steps: u32,
    each: impl FnMut(T, &SVector<T, N>),
) -> Followed<T, N>
where
    T: RealField + Copy,
    R: InverseKinematics<N, K, Real = T>,
{
    let branches = Branches { ranges: robot, signs: robot.branch_signs() };
    branches.follow(|s| robot.inverse_kinematics(&path(s).frame()), start, steps, each)
}

/// [`follow`] for an arm with one joint more than a pose asks for: `path` gives the redundancy beside the pose. That of the path's start is
/// [`redundancy`](RedundantInverseKinematics::redundancy)(start).
pub fn follow_redundant<R, T, const N: usize, const K: usize>(
    robot: &R,
    mut path: impl FnMut(T) -> (Pose<T>, T),
    start: &SVector<T, N>,
    steps: u32,
    each: impl FnMut(T, &SVector<T, N>),
) -> Followed<T, N>
where
    T: RealField + Copy,
    R: RedundantInverseKinematics<N, K, Real = T>,
{
    let branches = Branches { ranges: robot, signs: robot.branch_signs() };
    let postures = |s| {
        let (pose, redundancy) = path(s);
        robot.inverse_kinematics(&pose.frame(), redundancy)
    };
    branches.follow(postures, start, steps, each)
}

/// What tells postures apart.
struct Branches<'a, R> {
    ranges: &'a R,
    /// The bits of a branch that are signs.
    signs: u16,
}

impl<R> Branches<'_, R> {
    /// Follows a posture: `postures` are all at a parameter of the path.
    fn follow<T, const N: usize, const K: usize>(
        &self,
        mut postures: impl FnMut(T) -> Postures<T, N, K>,
        start: &SVector<T, N>,
        steps: u32,
        mut each: impl FnMut(T, &SVector<T, N>),
    ) -> Followed<T, N>
    where
        T: RealField + Copy,
        R: JointRanges<N, Real = T>,
    {
        let ended = |s, q, end| Followed { s, q, end: Some(end) };
        let (mut q, branch) = match self.continued(&postures(T::zero()), start, None, lit(OFF)) {
            Ok(first) => first,
            Err(BranchEnd::Jump) => return ended(T::zero(), *start, BranchEnd::Start),
            Err(end) => return ended(T::zero(), *start, end),
        };
        let mut s = T::zero();
        each(s, &q);
        let largest = T::one() / lit(f64::from(steps.max(1)));
        let finest = lit::<T>(1e-9).max(lit::<T>(8.0) * T::default_epsilon());
        let mut step = largest;
        // The nearest parameter at which a step was refused.
        let mut refused: Option<T> = None;
        for _ in 0..u64::from(steps) * 64 + 8192 {
            if s >= T::one() {
                break;
            }
            let whole = (s + step).min(T::one());
            let next = match refused {
                Some(at) if whole >= at && at - s > finest => s + (at - s) * lit(0.5),
                Some(at) if whole >= at => at,
                _ => whole,
            };
            match self.continued(&postures(next), &q, Some(branch), lit(FAR)) {
                Ok((there, _)) => {
                    refused = refused.filter(|at| next < *at);
                    step = ((next - s) * lit(2.0)).min(largest);
                    (s, q) = (next, there);
                    each(s, &q);
                }
                Err(_) if next - s > finest => {
                    refused = Some(next);
                    step = (next - s) * lit(0.5);
                }
                Err(end @ (BranchEnd::Singular | BranchEnd::Jump)) => {
                    // At the edge of the workspace both are true: what is a little farther tells.
                    let end = match postures((s + finest * lit(8.0)).min(T::one())).verdict {
                        Verdict::Unreachable => BranchEnd::Unreachable,
                        _ if end == BranchEnd::Singular || self.gap(&postures(s), &q) < lit(MEETING) => BranchEnd::Singular,
                        _ => BranchEnd::Jump,
                    };
                    return ended(s, q, end);
                }
                Err(end) => return ended(s, q, end),
            }
        }
        Followed { s, q, end: (s < T::one()).then_some(BranchEnd::TooManyPoses) }
    }

    /// The one of `postures` that continues `q` of `branch`, not farther than `far`, within the limits; with its branch. Where none does or
    /// another is too near to tell, `Jump`.
    fn continued<T, const N: usize, const K: usize>(
        &self,
        postures: &Postures<T, N, K>,
        q: &SVector<T, N>,
        branch: Option<u16>,
        far: T,
    ) -> Result<(SVector<T, N>, u16), BranchEnd>
    where
        T: RealField + Copy,
        R: JointRanges<N, Real = T>,
    {
        if !is_finite(q) {
            return Err(BranchEnd::Invalid);
        }
        let lost = match postures.verdict {
            Verdict::Invalid => return Err(BranchEnd::Invalid),
            Verdict::Unreachable => return Err(BranchEnd::Unreachable),
            Verdict::Continuum => BranchEnd::Continuum,
            Verdict::Complete | Verdict::NearDouble => BranchEnd::Jump,
        };
        let mut nearest = None;
        let mut least = far;
        for (place, posture) in postures.as_slice().iter().enumerate() {
            let there = self.ranges.unwrapped(&posture.q, q);
            let distance = (there - q).amax();
            if distance <= least {
                (nearest, least) = (Some((place, posture, there)), distance);
            }
        }
        let (place, posture, there) = nearest.ok_or(lost)?;
        if posture.free != 0 {
            return Err(BranchEnd::Continuum);
        }
        if posture.double || branch.is_some_and(|branch| (branch ^ posture.branch) & self.signs != 0) {
            return Err(BranchEnd::Singular);
        }
        for (i, other) in postures.as_slice().iter().enumerate() {
            let apart = (self.ranges.unwrapped(&other.q, &there) - there).amax();
            if i != place && apart < least * lit(APART) {
                return Err(BranchEnd::Jump);
            }
        }
        let mut within = there;
        let slack = T::default_epsilon().sqrt() * lit(LIMIT_ERROR);
        for (joint, ([low, high], x)) in self.ranges.position_limits().iter().zip(within.iter_mut()).enumerate() {
            if !(*low - slack <= *x && *x <= *high + slack) {
                return Err(BranchEnd::Limit { joint });
            }
            *x = x.max(*low).min(*high);
        }
        Ok((within, posture.branch))
    }

    /// How far the nearest other of the postures is from `q`, one of them.
    fn gap<T, const N: usize, const K: usize>(&self, postures: &Postures<T, N, K>, q: &SVector<T, N>) -> T
    where
        T: RealField + Copy,
        R: JointRanges<N, Real = T>,
    {
        let mut nearest = [T::max_value().unwrap_or_else(T::one); 2];
        for posture in postures.as_slice() {
            let distance = (self.ranges.unwrapped(&posture.q, q) - q).amax();
            if posture.double && distance < lit(MEETING) {
                return distance;
            }
            let [first, second] = nearest;
            nearest = if distance < first { [distance, first] } else { [first, second.min(distance)] };
        }
        nearest[1]
    }
}
