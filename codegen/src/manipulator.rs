//! A valid arm: a tree of links and joints with exact numbers in SI units, whatever convention the file used.
//!
//! Absent from here on: spans, Denavit-Hartenberg conventions, expressions of the file, impossible values.
//! Nothing that takes a [`Manipulator`] can fail.
//!
//! Joint i owns a *joint frame*, fixed in the link that it moves, with the joint axis as its z axis:
//!
//! ```text
//! joint frame i = joint frame of the parent * placement_i * motion_i(q_i),   motion = Rz(q) (revolute) or Tz(q) (prismatic)
//! link frame i  = joint frame i * link_frame_i                               (the frame that the user sees)
//! ```
//!
//! A standard Denavit-Hartenberg row Rz(theta + q) Tz(d) Tx(a) Rx(alpha) gives `placement = (parent's link_frame) Rz(theta) Tz(d)`
//! and `link_frame = Tx(a) Rx(alpha)`; a modified one gives `placement = Rx(alpha) Tx(a) Rz(theta) Tz(d)` and `link_frame = 1`.

use crate::exact::{Number, Polynomial};
use crate::kinds::{JointKind, ParameterId, TaskRow};

/// Index into [`Manipulator::joints`]; link i is the one that joint i moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LinkId(pub u32);

/// A valid robot arm.
#[derive(Clone, Debug)]
pub struct Manipulator {
    /// Name of the robot and of the emitted module: a Rust identifier.
    pub name: String,
    /// Named quantities that stay symbols, in the order of the file (names that enter by division, root or angle are already numbers).
    pub parameters: Vec<Parameter>,
    /// Acceleration of gravity in the base frame, m/s².
    pub gravity: [Polynomial; 3],
    /// Joints from base to tip; a parent always stands before its children.
    pub joints: Vec<Joint>,
    /// The link that carries the end effector.
    pub tip: LinkId,
    /// End-effector frame in the tip's link frame.
    pub tool: Placement,
    /// Rigid load, in the end-effector frame.
    pub payload: Option<Body>,
    /// Rows of the operational space, in the order of the file.
    pub task: Vec<TaskRow>,
    /// What the regressor's columns are.
    pub regressor: RegressorChoice,
}

/// A named quantity of the file.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name: an identifier, not reserved.
    pub name: String,
    /// Its value in the file.
    pub nominal: Number,
}

/// A joint and the link that it moves.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Its name in the file.
    pub name: String,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// The link that carries this joint; `None` for the base.
    pub parent: Option<LinkId>,
    /// The joint frame at q = 0 in the parent's *joint frame* (the base frame if there is no parent).
    pub placement: Placement,
    /// The link's frame, as the user sees it, in the joint frame.
    pub link_frame: Placement,
    /// Limits as written, if any.
    pub limits: Limits,
    /// Mass, centre of mass and inertia of the link, in the *link frame*.
    pub link: Body,
    /// The rotor that drives this joint, on the parent link.
    pub motor: Option<Motor>,
    /// Friction at the joint; `None` where the file does not give it.
    pub viscous: Option<Polynomial>,
    /// Coulomb friction at the joint, N m or N; the torque is coulomb · sign(dq).
    pub coulomb: Option<Polynomial>,
}

/// Limits of a joint; rad or m, rad/s or m/s, N m or N.
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// Lowest and highest q.
    pub position: Option<[Number; 2]>,
    /// Highest |dq|.
    pub velocity: Option<Number>,
    /// Highest |tau|.
    pub effort: Option<Number>,
}

/// A rigid body in a frame F.
#[derive(Clone, Debug)]
pub struct Body {
    /// Mass, kg.
    pub mass: Polynomial,
    /// Centre of mass in F, m.
    pub com: [Polynomial; 3],
    /// Inertia tensor about the centre of mass, axes of F, kg m²: xx, xy, yy, xz, yz, zz (xy is the element Ixy = -∫xy dm).
    pub inertia: [Polynomial; 6],
}

/// A rotor: rides on the parent link and spins about its own axis with `ratio` times the joint rate.
#[derive(Clone, Debug)]
pub struct Motor {
    /// k_r: rotor speed over joint speed; rad/rad or rad/m; not zero.
    pub ratio: Polynomial,
    /// Inertia about the spin axis, kg m²; `None` where the file does not give it.
    pub inertia: Option<Polynomial>,
    /// Mass, kg.
    pub mass: Polynomial,
    /// Its place in the parent's *link frame* (the base frame if there is no parent), m.
    pub position: [Polynomial; 3],
    /// Unit vector of the spin axis in the parent's *link frame* (the base frame if there is no parent).
    pub axis: [Number; 3],
    /// Viscous friction at the rotor, N m s; acts at the joint as ratio² times this. `None` where the file does not give it.
    pub viscous: Option<Polynomial>,
}

/// A fixed frame in another: x_outer = rotation · x_inner + translation.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Rotation matrix, `[row][column]`.
    pub rotation: [[Number; 3]; 3],
    /// Translation, m.
    pub translation: [Polynomial; 3],
}

/// The choice of the regressor's columns.
#[derive(Clone, Debug, PartialEq)]
pub enum RegressorChoice {
    /// Ten per link, then motors and friction, then the payload.
    Standard,
    /// The minimal parameter set of `Standard`.
    Base,
    /// Chosen names; tau is linear in all of them together.
    Names(Vec<ParameterId>),
}

impl Manipulator {
    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Rows of the geometric Jacobian that make up the task.
    pub fn task_rows(&self) -> Vec<usize> {
        self.task.iter().map(|row| row.index()).collect()
    }
}
