//! What a timing needs of an arm: its torques along a path, its friction, and lengths and masses that bound derivatives.

use crate::robot::Dynamics;
use nalgebra::{RealField, SVector, Vector6};

/// The torques along a path, before friction: tau = inertial u + velocity x + gravity with u = dds and x = ds².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTorques<T, const N: usize> {
    /// B(q) q', rotors included.
    pub inertial: SVector<T, N>,
    /// B(q) q'' + C(q, q') q'.
    pub velocity: SVector<T, N>,
    /// g(q), springs included.
    pub gravity: SVector<T, N>,
}

/// Friction of a joint, for q' of either sign: viscous dq + cubic dq³ + (coulomb + load |g| + stribeck exp(-|dq|/stribeck_velocity)) sign(dq)
/// + offset; N m or N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointFriction<T> {
    /// Viscous friction seen at the joint, the motor's included, k_r² F_m + F_v; N m s/rad or N s/m.
    pub viscous: T,
    /// Coulomb friction, N m or N.
    pub coulomb: T,
    /// A torque that does not depend on the motion.
    pub offset: T,
    /// What grows with gravity's torque, without unit.
    pub load: T,
    /// Cubic friction, N m s³/rad³ or N s³/m³.
    pub cubic: T,
    /// Stribeck friction at rest, N m or N.
    pub stribeck: T,
    /// The rate at which 1/e of it is left, rad/s or m/s; above 0 unless `stribeck` is 0.
    pub stribeck_velocity: T,
}

impl<T: RealField + Copy> JointFriction<T> {
    /// Whether it depends on the rate otherwise than by its sign.
    pub(super) fn is_curved(&self) -> bool {
        self.viscous != T::zero() || self.has_curve()
    }

    /// And otherwise than linearly.
    pub(super) fn has_curve(&self) -> bool {
        self.cubic != T::zero() || self.stribeck != T::zero()
    }
}

/// Lengths and inertias of a joint and the link that it moves: no posture enters. They bound derivatives of torques along a path.
///
/// A value that is too large widens bounds; a value that is too small makes them false. Springs need none: along a piece their torque is a
/// polynomial of degree 5, which the interpolation reproduces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkBound<T> {
    /// The joint that carries this one, counted from 0; `None` for the base.
    pub parent: Option<usize>,
    /// Whether the joint slides.
    pub slides: bool,
    /// Distance of the joint's origin at q = 0, a point on its axis, from the origin of the joint that carries it, m.
    pub distance: T,
    /// Mass of the link and of the rotors that ride on it, kg.
    pub mass: T,
    /// Length of the first moment about the joint's origin, kg m.
    pub first_moment: T,
    /// Largest principal moment of inertia about the joint's origin, kg m².
    pub inertia: T,
    /// Inertia of the joint's own rotor about its spin axis, times its ratio: what couples with the turning of the link that carries it.
    pub coupling: T,
    /// Inertia that the joint alone feels: k_r² I_m and the armature, kg m² or kg.
    pub reflected: T,
}

/// An arm as the timing of a path sees it.
pub trait PathDynamics<const N: usize> {
    /// The scalar.
    type Real: RealField + Copy;

    /// The torques at q with the path's derivatives q' and q''.
    fn path_dynamics(
        &self,
        q: &SVector<Self::Real, N>,
        slope: &SVector<Self::Real, N>,
        curvature: &SVector<Self::Real, N>,
    ) -> PathTorques<Self::Real, N>;

    /// J(q) q': velocity and angular velocity of the end effector for ds = 1, in any frame; m and rad. Asked for where it is limited.
    fn tool_rate(&self, q: &SVector<Self::Real, N>, slope: &SVector<Self::Real, N>) -> Vector6<Self::Real>;

    /// Friction of the joints.
    fn joint_friction(&self) -> &[JointFriction<Self::Real>; N];

    /// Lengths and inertias that bound derivatives.
    fn link_bounds(&self) -> &[LinkBound<Self::Real>; N];

    /// Length of the acceleration of gravity, m/s².
    fn gravity_length(&self) -> Self::Real;
}

/// A robot of the runtime with what its emitted module does not contain.
#[derive(Clone, Copy, Debug)]
pub struct PathModel<'a, R, T, const N: usize> {
    /// The robot.
    pub robot: &'a R,
    /// Its friction.
    pub friction: [JointFriction<T>; N],
    /// Its lengths and inertias.
    pub links: [LinkBound<T>; N],
    /// Length of the acceleration of gravity, m/s².
    pub gravity: T,
}

impl<R: Dynamics<N>, const N: usize> PathDynamics<N> for PathModel<'_, R, R::Real, N> {
    type Real = R::Real;

    /// Gravity and two inverse dynamics: B q' is the torque at rest with the acceleration q', less that without.
    fn path_dynamics(
        &self,
        q: &SVector<R::Real, N>,
        slope: &SVector<R::Real, N>,
        curvature: &SVector<R::Real, N>,
    ) -> PathTorques<R::Real, N> {
        let zero = SVector::zeros();
        let gravity = self.robot.gravity(q);
        let at_rest = gravity + self.robot.friction(&zero);
        let friction = self.robot.friction(slope) + self.robot.load_friction(q, slope);
        PathTorques {
            inertial: self.robot.inverse_dynamics(q, &zero, slope) - at_rest,
            velocity: self.robot.inverse_dynamics(q, slope, curvature) - friction - gravity,
            gravity,
        }
    }

    fn tool_rate(&self, q: &SVector<R::Real, N>, slope: &SVector<R::Real, N>) -> Vector6<R::Real> {
        self.robot.geometric_jacobian(q) * slope
    }

    fn joint_friction(&self) -> &[JointFriction<R::Real>; N] {
        &self.friction
    }

    fn link_bounds(&self) -> &[LinkBound<R::Real>; N] {
        &self.links
    }

    fn gravity_length(&self) -> R::Real {
        self.gravity
    }
}
