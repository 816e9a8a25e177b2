//! The inverse kinematics of a robot, if it has any.
//!
//! The code that makes an instance decides by autoref: [`Probe`] returns the robot's functions, or `None`. Method lookup tries the type
//! itself before a reference to it, so [`Solves`] takes precedence if the robot implements inverse kinematics.

use std::marker::PhantomData;

use armgen_runtime::inverse_kinematics::{follow, Followed};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::Pose;
use armgen_runtime::robot::InverseKinematics;

/// Minimum number of steps along a path.
const STEPS: u32 = 500;

/// The inverse-kinematics functions that runs need, of a robot.
#[derive(Debug)]
pub struct Solver<R, const N: usize> {
    /// All postures for a pose.
    pub(super) postures: fn(&R, &Pose<f64>) -> Vec<SVector<f64, N>>,
    /// Follows a posture along a path, as `armgen_runtime::inverse_kinematics::follow` does.
    pub(super) follow: Follow<R, N>,
}

/// The robot, the path by its parameter, the first posture, and a function that takes each posture on the way.
type Follow<R, const N: usize> =
    fn(&R, &dyn Fn(f64) -> Pose<f64>, &SVector<f64, N>, &mut dyn FnMut(f64, &SVector<f64, N>)) -> Followed<f64, N>;

impl<R, const N: usize> Solver<R, N> {
    /// The functions of a robot with inverse kinematics.
    pub fn new<const K: usize>() -> Self
    where
        R: InverseKinematics<N, K, Real = f64>,
    {
        Solver {
            postures: |robot, pose| robot.inverse_kinematics(&pose.frame()).as_slice().iter().map(|posture| posture.q).collect(),
            follow: |robot, path, start, each| follow(robot, path, start, STEPS, each),
        }
    }
}

// Not derived: functions are copied, whether the robot is or not.
impl<R, const N: usize> Clone for Solver<R, N> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R, const N: usize> Copy for Solver<R, N> {}

/// A robot whose inverse kinematics is looked up.
#[derive(Clone, Copy, Debug, Default)]
pub struct Probe<R>(PhantomData<R>);

impl<R> Probe<R> {
    /// A probe for this robot.
    pub fn of(_: &R) -> Probe<R> {
        Probe(PhantomData)
    }
}

/// A robot with inverse kinematics.
pub trait Solves<R, const N: usize, const K: usize> {
    /// The robot's functions.
    fn solver(&self) -> Option<Solver<R, N>>;
}

impl<R, const N: usize, const K: usize> Solves<R, N, K> for Probe<R>
where
    R: InverseKinematics<N, K, Real = f64>,
{
    fn solver(&self) -> Option<Solver<R, N>> {
        Some(Solver::new())
    }
}

/// A robot without inverse kinematics.
pub trait SolvesNot<R, const N: usize> {
    /// `None`, because the robot has no inverse kinematics.
    fn solver(&self) -> Option<Solver<R, N>> {
        None
    }
}

impl<R, const N: usize> SolvesNot<R, N> for &Probe<R> {}
