//! All postures that reach a pose, for robots whose inverse kinematics has a construction.

use super::Kinematics;
use nalgebra::{ComplexField, Matrix4, RealField, SVector};

/// How complete the postures at a pose are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// These are all, as far as the construction can tell; a change of the pose by its rounding keeps their number.
    Complete,
    /// None was found, and none is near.
    Unreachable,
    /// A change of the pose by its own rounding could change their number. Two postures that have met are listed once, as
    /// `double`; two that may have met are each `double`.
    NearDouble,
    /// Some joints can move while the end effector stays.
    Continuum,
    /// The pose has an entry that is not finite, or no rotation.
    Invalid,
}

/// One posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posture<T, const N: usize> {
    /// Joint variables: angles in (-pi, pi], rad; lengths, m.
    pub q: SVector<T, N>,
    /// Which of the construction's ways leads here, as `BRANCHES` of the emitted module names them.
    pub branch: u16,
    /// Two postures meet here.
    pub double: bool,
    /// Bit i: the construction chose one of many values for joint i + 1, because some joints can move while the end effector
    /// stays. The null space of the Jacobian shows which joints; a joint that moves along with them may lack its bit.
    pub free: u32,
}

/// All postures at a pose, at most `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Postures<T, const N: usize, const K: usize> {
    /// How complete they are.
    pub verdict: Verdict,
    /// Without a posture, by how much the construction missed: a hint for people, not a bound. Otherwise how far the rotation of the pose
    /// is from orthonormal, 0 within rounding.
    pub miss: T,
    /// How many there are.
    pub count: usize,
    /// The postures; entries from `count` on have no meaning.
    pub all: [Posture<T, N>; K],
}

impl<T, const N: usize, const K: usize> Postures<T, N, K> {
    /// The postures, in the order of their branches; without branches in that of their joint variables.
    pub fn as_slice(&self) -> &[Posture<T, N>] {
        self.all.get(..self.count).unwrap_or(&self.all)
    }
}

/// What postures are compared by: joints that turn, and limits. Emitted with [`InverseKinematics`] or [`RedundantInverseKinematics`].
pub trait JointRanges<const N: usize>: Kinematics<N> {
    /// Whether a joint turns, so that a whole turn more is the same posture.
    fn turns(&self) -> [bool; N];

    /// Lowest and highest joint variable, rad or m; infinite where the description gives no limit.
    fn position_limits(&self) -> [[Self::Real; 2]; N];

    /// The whole turns nearest to `near` added to the angles of `q`.
    fn unwrapped(&self, q: &SVector<Self::Real, N>, near: &SVector<Self::Real, N>) -> SVector<Self::Real, N> {
        let turn = <Self::Real as RealField>::two_pi();
        let mut unwrapped = *q;
        for ((x, y), turns) in unwrapped.iter_mut().zip(near.iter()).zip(self.turns()) {
            if turns {
                *x += turn * ((*y - *x) / turn).round();
            }
        }
        unwrapped
    }
}

/// Inverse kinematics of an arm with `N` joints: all joint variables that reach a pose, at most `K` where they are finitely many.
///
/// Emitted by `armgen generate --ik --runtime`, and by build scripts with `inverse_kinematics()`.
pub trait InverseKinematics<const N: usize, const K: usize>: JointRanges<N> {
    /// All q with T_e(q) = `pose`, the pose of the end effector in the base frame, in the rows that the task asks for; lengths in m. Limits are not
    /// looked at.
    fn inverse_kinematics(&self, pose: &Matrix4<Self::Real>) -> Postures<Self::Real, N, K>;

    /// The bits of a posture's `branch` that are signs: they stay as long as no singular posture is passed. The others number the roots of an
    /// equation.
    fn branch_signs(&self) -> u16;
}

/// Inverse kinematics of an arm with one joint more than its task has rows. The argument `redundancy` fixes the free motion: at
/// most `K` postures reach a pose then, where they are finitely many.
///
/// The redundancy is the variable of a joint, rad or m, or the swivel angle of the elbow about the line from shoulder to wrist,
/// rad. The emitted module documents which. Emitted as [`InverseKinematics`] is.
pub trait RedundantInverseKinematics<const N: usize, const K: usize>: JointRanges<N> {
    /// All q with T_e(q) = `pose` and [`redundancy`](RedundantInverseKinematics::redundancy)(q) = `redundancy`; lengths in m. Limits are
    /// not looked at.
    fn inverse_kinematics(&self, pose: &Matrix4<Self::Real>, redundancy: Self::Real) -> Postures<Self::Real, N, K>;

    /// The redundancy of a posture, with which `inverse_kinematics` finds it again.
    fn redundancy(&self, q: &SVector<Self::Real, N>) -> Self::Real;

    /// The bits of a posture's `branch` that are signs, as [`InverseKinematics::branch_signs`].
    fn branch_signs(&self) -> u16;
}
