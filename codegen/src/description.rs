//! The file as read: every value with its place, not yet validated.
//!
//! ```text
//! Source -> document: tree of nodes -> reader.rs: which keys there are, and what stands under each -> RobotDescription
//! ```
//!
//! Absent from here on: YAML, unknown keys, wrong kinds of values, malformed expressions. What could not be read is `None`, and its
//! fault is reported; so validation goes on with the rest, and every fault of a file comes in one go.

mod reader;

use crate::diagnostic::Diagnostics;
use crate::document::{yaml, Expression};
use crate::kinds::{JointKind, TaskRow};
use crate::source::{Source, Span, Spanned};

/// A value that may have been unreadable.
pub type Value = Option<Expression>;

/// A description of a robot arm as written. `None`: not given, or unreadable and reported.
#[derive(Clone, Debug, Default)]
pub struct RobotDescription {
    /// Name of the robot.
    pub name: Option<Spanned<String>>,
    /// Which Denavit-Hartenberg convention the rows follow.
    pub convention: Option<Spanned<Convention>>,
    /// Acceleration of gravity in the base frame.
    pub gravity: Option<Spanned<[Value; 3]>>,
    /// Named quantities.
    pub parameters: Vec<ParameterDescription>,
    /// Joints from base to tip; `None` if the key is missing or holds no list.
    pub joints: Option<Spanned<Vec<JointDescription>>>,
    /// End-effector frame in the last link's frame.
    pub tool: Option<ToolDescription>,
    /// Load in the end-effector frame.
    pub payload: Option<BodyDescription>,
    /// Rows of the operational space; those that exist. The span is the key's.
    pub task: Option<Spanned<Vec<Spanned<TaskRow>>>>,
    /// The regressor's columns. The span is the key's.
    pub regressor: Option<Spanned<RegressorDescription>>,
}

/// A Denavit-Hartenberg convention.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha).
    Standard,
    /// A_i = Rx(alpha) Tx(a) Rz(theta) Tz(d).
    Modified,
}

/// A named quantity.
#[derive(Clone, Debug)]
pub struct ParameterDescription {
    /// Its name.
    pub name: Spanned<String>,
    /// Its value.
    pub value: Value,
}

/// A joint and its link.
#[derive(Clone, Debug)]
pub struct JointDescription {
    /// Name of the joint.
    pub name: Option<Spanned<String>>,
    /// Revolute or prismatic.
    pub kind: Option<Spanned<JointKind>>,
    /// Length a, m.
    pub a: Value,
    /// Twist alpha, rad.
    pub alpha: Value,
    /// Offset d, m.
    pub d: Value,
    /// Angle theta, rad.
    pub theta: Value,
    /// Limits.
    pub limits: LimitsDescription,
    /// Mass distribution of the link.
    pub link: Option<BodyDescription>,
    /// The rotor.
    pub motor: Option<MotorDescription>,
    /// Friction at the joint.
    pub friction: FrictionDescription,
    /// Where the joint begins: its first key.
    pub span: Span,
}

/// Limits of a joint.
#[derive(Clone, Debug, Default)]
pub struct LimitsDescription {
    /// Lowest and highest position.
    pub position: Option<Spanned<[Value; 2]>>,
    /// Highest rate.
    pub velocity: Value,
    /// Highest torque or force.
    pub effort: Value,
}

/// Friction at a joint.
#[derive(Clone, Debug, Default)]
pub struct FrictionDescription {
    /// Viscous coefficient.
    pub viscous: Value,
    /// Coulomb friction.
    pub coulomb: Value,
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct BodyDescription {
    /// Place of the key that holds it.
    pub key: Span,
    /// Mass.
    pub mass: Value,
    /// Centre of mass.
    pub com: Option<Spanned<[Value; 3]>>,
    /// Inertia about the centre of mass.
    pub inertia: Option<InertiaDescription>,
}

/// The six elements of an inertia tensor.
#[derive(Clone, Debug)]
pub struct InertiaDescription {
    /// Place of the key that holds them.
    pub key: Span,
    /// xx, xy, yy, xz, yz, zz, those that are given.
    pub elements: [Value; 6],
    /// Whether all that is given could be read.
    pub complete: bool,
}

/// Names of the elements in the order of [`InertiaDescription::elements`].
pub const INERTIA_ELEMENTS: [&str; 6] = ["xx", "xy", "yy", "xz", "yz", "zz"];

/// A rotor.
#[derive(Clone, Debug)]
pub struct MotorDescription {
    /// Place of the key that holds it.
    pub key: Span,
    /// Gear ratio.
    pub ratio: Value,
    /// Inertia about the spin axis.
    pub inertia: Value,
    /// Mass.
    pub mass: Value,
    /// Position in the previous link's frame.
    pub position: Option<Spanned<[Value; 3]>>,
    /// Spin axis in the previous link's frame.
    pub axis: Option<Spanned<[Value; 3]>>,
    /// Viscous friction at the rotor.
    pub viscous: Value,
}

/// The end-effector frame.
#[derive(Clone, Debug)]
pub struct ToolDescription {
    /// Translation.
    pub xyz: Option<Spanned<[Value; 3]>>,
    /// Angles about x, y, z.
    pub rpy: Option<Spanned<[Value; 3]>>,
}

/// The choice of the regressor's columns.
#[derive(Clone, Debug)]
pub enum RegressorDescription {
    /// All standard parameters: ten per link, then rotors, friction and payload.
    Standard,
    /// The minimal set.
    Base,
    /// Names of parameters.
    Names(Vec<Spanned<String>>),
}

impl RobotDescription {
    /// Reads a YAML description; `None` if the text holds no mapping at all.
    pub fn parse(source: &Source) -> (Option<RobotDescription>, Diagnostics) {
        let mut diagnostics = Diagnostics::new();
        let root = yaml::read(source, &mut diagnostics);
        let description = reader::read(source, root.as_ref(), &mut diagnostics);
        (description, diagnostics)
    }
}

#[cfg(test)]
mod tests;
