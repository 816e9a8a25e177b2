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

/// The inverse-kinematics functions that runs need.
#[derive(Clone, Copy, Debug)]
pub struct Solver<const N: usize> {
    /// All postures for a pose.
    pub(super) postures: fn(&Pose<f64>) -> Vec<SVector<f64, N>>,
    /// Follows a posture along a path, as `armgen_runtime::inverse_kinematics::follow` does.
    pub(super) follow: fn(&dyn Fn(f64) -> Pose<f64>, &SVector<f64, N>, &mut dyn FnMut(f64, &SVector<f64, N>)) -> Followed<f64, N>,
}

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
pub trait Solves<const N: usize, const K: usize> {
    /// The robot's functions.
    fn solver(&self) -> Option<Solver<N>>;
}

impl<R, const N: usize, const K: usize> Solves<N, K> for Probe<R>
where
    R: InverseKinematics<N, K, Real = f64> + Default,
{
    fn solver(&self) -> Option<Solver<N>> {
        Some(Solver {
            postures: |pose| R::default().inverse_kinematics(&pose.frame()).as_slice().iter().map(|posture| posture.q).collect(),
            follow: |path, start, each| follow(&R::default(), path, start, STEPS, each),
        })
    }
}

/// A robot without inverse kinematics.
pub trait SolvesNot<const N: usize> {
    /// `None`, because the robot has no inverse kinematics.
    fn solver(&self) -> Option<Solver<N>> {
        None
    }
}

impl<R, const N: usize> SolvesNot<N> for &Probe<R> {}
