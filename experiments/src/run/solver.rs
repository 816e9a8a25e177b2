//! The inverse kinematics of a robot, where it has one.
//!
//! Which robot has it is known where an instance is made: [`Probe`] gives its functions, or none. A method of a trait that is implemented for a
//! reference is found after one of a trait that is implemented for the type itself, so [`Solves`] comes first where the robot implements it.

use std::marker::PhantomData;

use armgen_runtime::inverse_kinematics::{follow, Followed};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::Pose;
use armgen_runtime::robot::InverseKinematics;

/// Poses of a path that are looked at, at least.
const STEPS: u32 = 500;

/// What is asked of a robot with inverse kinematics.
#[derive(Clone, Copy, Debug)]
pub struct Solver<const N: usize> {
    /// How many postures reach a pose.
    pub(super) count: fn(&Pose<f64>) -> usize,
    /// Follows a posture along a path, as `armgen_runtime::inverse_kinematics::follow` does.
    pub(super) follow: fn(&dyn Fn(f64) -> Pose<f64>, &SVector<f64, N>, &mut dyn FnMut(f64, &SVector<f64, N>)) -> Followed<f64, N>,
}

/// A robot that is asked for its inverse kinematics.
#[derive(Clone, Copy, Debug, Default)]
pub struct Probe<R>(PhantomData<R>);

impl<R> Probe<R> {
    /// Of this robot.
    pub fn of(_: &R) -> Probe<R> {
        Probe(PhantomData)
    }
}

/// A robot with inverse kinematics.
pub trait Solves<const N: usize, const K: usize> {
    /// Its functions.
    fn solver(&self) -> Option<Solver<N>>;
}

impl<R, const N: usize, const K: usize> Solves<N, K> for Probe<R>
where
    R: InverseKinematics<N, K, Real = f64> + Default,
{
    fn solver(&self) -> Option<Solver<N>> {
        Some(Solver {
            count: |pose| R::default().inverse_kinematics(&pose.frame()).count,
            follow: |path, start, each| follow(&R::default(), path, start, STEPS, each),
        })
    }
}

/// A robot without.
pub trait SolvesNot<const N: usize> {
    /// None.
    fn solver(&self) -> Option<Solver<N>> {
        None
    }
}

impl<R, const N: usize> SolvesNot<N> for &Probe<R> {}
