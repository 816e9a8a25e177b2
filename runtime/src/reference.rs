//! References and states of an arm at one instant.

use crate::{linalg::is_finite, robot::Kinematics};
use nalgebra::{Matrix3, Matrix4, RealField, SVector, Vector3, Vector6};

/// Position and orientation of the end effector in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T> {
    /// Position p_e, m.
    pub position: Vector3<T>,
    /// Rotation matrix R_e = [n s a].
    pub rotation: Matrix3<T>,
}

impl<T: RealField + Copy> Pose<T> {
    /// The pose held by a homogeneous transformation.
    pub fn from_frame(frame: &Matrix4<T>) -> Self {
        Self { position: frame.fixed_view::<3, 1>(0, 3).into_owned(), rotation: frame.fixed_view::<3, 3>(0, 0).into_owned() }
    }

    /// The homogeneous transformation of the pose.
    pub fn frame(&self) -> Matrix4<T> {
        let mut frame = self.rotation.to_homogeneous();
        frame.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.position);
        frame
    }

    /// The pose of `robot` at `q`.
    pub fn of<R: Kinematics<N, Real = T>, const N: usize>(robot: &R, q: &SVector<T, N>) -> Self {
        Self::from_frame(&robot.direct_kinematics(q))
    }
}

/// Desired motion of the end effector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperationalReference<T> {
    /// Desired pose.
    pub pose: Pose<T>,
    /// Desired velocity (linear, angular), base frame; m/s, rad/s.
    pub velocity: Vector6<T>,
    /// Desired acceleration (linear, angular), base frame; m/s^2, rad/s^2.
    pub acceleration: Vector6<T>,
}

impl<T: RealField + Copy> OperationalReference<T> {
    /// A pose to be held: velocity and acceleration zero.
    pub fn at_rest(pose: Pose<T>) -> Self {
        Self { pose, velocity: Vector6::zeros(), acceleration: Vector6::zeros() }
    }

    /// Whether every element is finite.
    pub fn is_finite(&self) -> bool {
        is_finite(&self.pose.position)
            && is_finite(&self.pose.rotation)
            && is_finite(&self.velocity)
            && is_finite(&self.acceleration)
    }
}

/// Desired motion of the joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointReference<T, const N: usize> {
    /// Desired joint variables q_d, rad or m.
    pub q: SVector<T, N>,
    /// Desired joint rates, rad/s or m/s.
    pub dq: SVector<T, N>,
    /// Desired joint accelerations, rad/s^2 or m/s^2.
    pub ddq: SVector<T, N>,
}

impl<T: RealField + Copy, const N: usize> JointReference<T, N> {
    /// A posture to be held: rates and accelerations zero.
    pub fn at_rest(q: SVector<T, N>) -> Self {
        Self { q, dq: SVector::zeros(), ddq: SVector::zeros() }
    }

    /// The reference a time `t`, s, later, its acceleration held meanwhile: q + t dq + 1/2 t^2 ddq, dq + t ddq.
    pub fn held(&self, t: T) -> Self {
        let half = nalgebra::convert::<f64, T>(0.5);
        Self { q: self.q + self.dq * t + self.ddq * (half * t * t), dq: self.dq + self.ddq * t, ddq: self.ddq }
    }

    /// Whether every element is finite.
    pub fn is_finite(&self) -> bool {
        is_finite(&self.q) && is_finite(&self.dq) && is_finite(&self.ddq)
    }
}

/// Joint variables and rates: the state of an arm, or its measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T, const N: usize> {
    /// Joint variables, rad or m.
    pub q: SVector<T, N>,
    /// Joint rates, rad/s or m/s.
    pub dq: SVector<T, N>,
}

impl<T: RealField + Copy, const N: usize> State<T, N> {
    /// At rest at `q`.
    pub fn at_rest(q: SVector<T, N>) -> Self {
        Self { q, dq: SVector::zeros() }
    }

    /// Whether every element is finite.
    pub fn is_finite(&self) -> bool {
        is_finite(&self.q) && is_finite(&self.dq)
    }
}
