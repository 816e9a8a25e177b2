//! A numerical model of an arm, written independently of the generator, whose results must agree.
//!
//! Another formulation in other code. It reads the description again, into plain f64. Every vector is expressed in the *base* frame, and a
//! body is ten numbers about the origin of its frame. Newton-Euler (the book, Sect. 7.5, rotors included) is the only dynamics:
//!
//! ```text
//! tau  = NE(q, dq, ddq, g0) + F_v dq + F_c sign(dq)
//! g    = NE(q, 0, 0, g0)                 B e_j = NE(q, 0, e_j, 0)                C dq = NE(q, dq, 0, 0)
//! C_ij = sum_k ½ (∂b_ij/∂q_k + ∂b_ik/∂q_j - ∂b_jk/∂q_i) dq_k                     dB/dq by dual numbers: exact to rounding
//! C(q, a) b = ¼ (NE(q, a+b, 0, 0) - NE(q, a-b, 0, 0))                            Christoffel's C is symmetric in a and b
//! Y_k  = tau(pi = e_k) - tau(pi = 0)                                             linear in pi, so unit parameters give columns
//! ```
//!
//! [`Description::read`] reads a file's text, [`Description::model`] gives its [`Model`]; the functions are methods of it.

mod description;
mod dynamics;
mod functions;
mod kinematics;
mod regressor;
mod scalar;
mod vector;

pub use description::{Description, RegressorChoice};
pub use dynamics::{rank, solve};
pub use regressor::Regressor;
pub use scalar::{Dual, Scalar};

/// A matrix as a list of rows.
pub type Matrix = Vec<Vec<f64>>;

/// Product of a matrix and a vector.
pub fn times(m: &[Vec<f64>], v: &[f64]) -> Vec<f64> {
    m.iter().map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum()).collect()
}

/// Mass, first moments, inertia about the frame's origin: m, mcx, mcy, mcz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz.
///
/// The equations are linear in these ten.
pub type Ten = [f64; 10];

/// A frame in another: rotation by rows, origin.
pub type Placed = ([[f64; 3]; 3], [f64; 3]);

/// An arm in plain numbers, SI units.
#[derive(Clone, Debug)]
pub struct Model {
    /// Modified (Craig, Khalil) instead of standard Denavit-Hartenberg rows.
    pub modified: bool,
    /// Acceleration of gravity in the base frame.
    pub gravity: [f64; 3],
    /// Joints in the order of the file, each with the link that it moves.
    pub joints: Vec<Joint>,
    /// The frame of the link that carries the end effector, counted as `on` of joints.
    pub tip: usize,
    /// End-effector frame in that: rotation by rows, translation.
    pub tool: Placed,
    /// Rigid load, in the end-effector frame.
    pub payload: Option<Ten>,
}

/// A joint and its link.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Slides instead of turning.
    pub prismatic: bool,
    /// The frame of the link that carries it: 0 is the base, i the link of joint i.
    pub on: usize,
    /// The frame there that its row starts from.
    pub start: Placed,
    /// a, alpha, d, theta of the row; the joint variable is added to d or theta.
    pub row: [f64; 4],
    /// For rows that are not Denavit-Hartenberg: the link frame at q = 0 in the previous frame, and the unit axis in it.
    pub origin: Option<(Placed, [f64; 3])>,
    /// The link with its attached bodies, in its own frame.
    pub link: Ten,
    /// The rotor on the previous link.
    pub motor: Option<Motor>,
    /// Viscous friction at the joint, if given.
    pub viscous: Option<f64>,
    /// Coulomb friction at the joint, if given.
    pub coulomb: Option<f64>,
    /// The rate v of F_c tanh(dq / v), if friction is smooth.
    pub smooth: Option<f64>,
    /// Friction at the joint whatever its rate, if given.
    pub offset: Option<f64>,
    /// Coefficient of the cube of the rate, if given.
    pub cubic: Option<f64>,
    /// How many times its gravity torque is added to its dry friction.
    pub load: f64,
    /// Stribeck friction at the lowest rates, if given.
    pub stribeck: Option<f64>,
    /// The rate at which 1/e of it is left.
    pub stribeck_velocity: f64,
    /// Stiffness of the joint's spring, if given.
    pub stiffness: Option<f64>,
    /// Where that is at rest.
    pub rest: f64,
    /// Inertia that the joint alone feels, if given.
    pub armature: Option<f64>,
}

/// The rotor of a joint, in the frame of the link that carries the joint.
#[derive(Clone, Debug)]
pub struct Motor {
    /// k_r.
    pub ratio: f64,
    /// Inertia about the spin axis, if given.
    pub inertia: Option<f64>,
    /// Mass.
    pub mass: f64,
    /// Where the mass is.
    pub position: [f64; 3],
    /// Spin axis, a unit vector.
    pub axis: [f64; 3],
    /// Viscous friction at the rotor, if given.
    pub viscous: Option<f64>,
}

impl Model {
    /// Whether a frame moves with another, from 0, the base.
    fn carries(&self, outer: usize, frame: usize) -> bool {
        frame == outer || frame > 0 && self.carries(outer, self.joints[frame - 1].on)
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }
}
