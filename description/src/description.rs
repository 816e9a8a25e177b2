//! The file as read: every value with its place, not yet validated.
//!
//! ```text
//! Source -> document: tree of nodes -> reader.rs: which keys there are, and what stands under each -> RobotDescription
//!                                     keys.rs:   the keys, their values, meaning and units; schema.rs: the same as a JSON Schema
//!                                     values.rs: every value, with its role and its dimension
//!                                     units.rs:  the units that the file names, applied to them
//! ```
//!
//! Absent from here on: YAML, unknown keys, wrong kinds of values, malformed expressions. What could not be read is `None`, and its
//! fault is reported; so validation goes on with the rest, and every fault of a file comes in one go.

mod keys;
mod other_formats;
mod reader;
pub mod schema;
mod units;
mod values;

use crate::diagnostic::Diagnostics;
use crate::document::{yaml, Expression, Unit};
use crate::kinds::{JointKind, Target, TaskRow};
use crate::source::{Source, Span, Spanned};
pub use values::{Dimension, Role};

/// The text of a list in the file, or in SI units if the file names others.
pub fn list_text<const N: usize>(list: &Spanned<[Value; N]>, source: &Source) -> String {
    let converted = list.value.iter().flatten().any(|value| matches!(value.kind, crate::document::ExpressionKind::InUnit(..)));
    if !converted {
        return source.slice(list.span).to_owned();
    }
    let texts: Vec<String> =
        list.value.iter().map(|value| value.as_ref().map_or(String::new(), |value| value.text(source))).collect();
    format!("[{}]", texts.join(", "))
}

/// A value that may have been unreadable.
pub type Value = Option<Expression>;

/// A description of a robot arm as written. `None`: not given, or unreadable and reported.
#[derive(Clone, Debug, Default)]
pub struct RobotDescription {
    /// Name of the robot.
    pub name: Option<Spanned<String>>,
    /// The kind of rows that joints have.
    pub convention: Option<Spanned<Convention>>,
    /// Acceleration of gravity in the base frame.
    pub gravity: Option<Spanned<[Value; 3]>>,
    /// Whether that is an argument of functions, and `gravity` its nominal value.
    pub gravity_is_argument: bool,
    /// The units of plain numbers, those that the file names. The values are in SI units already.
    pub units: Vec<NamedUnit>,
    /// The meaning of products of inertia. The values are elements of the tensor already.
    pub products: Option<Spanned<Products>>,
    /// Named quantities.
    pub parameters: Vec<ParameterDescription>,
    /// Joints from base to tip; `None` if the key is missing or holds no list.
    pub joints: Option<Spanned<Vec<JointDescription>>>,
    /// The frame that rows on the base start from, in the base frame.
    pub base: Option<PoseDescription>,
    /// The joint whose link carries the end effector; if absent, the last one.
    pub tip: Option<Spanned<String>>,
    /// End-effector frame in that link's frame.
    pub tool: Option<PoseDescription>,
    /// Load in the end-effector frame.
    pub payload: Option<BodyDescription>,
    /// Rows of the operational space; those that exist. The span is the key's.
    pub task: Option<Spanned<Vec<Spanned<TaskRow>>>>,
    /// The regressor's columns. The span is the key's.
    pub regressor: Option<Spanned<RegressorDescription>>,
    /// The choices for inverse kinematics.
    pub inverse_kinematics: PosturesDescription,
    /// Named end effectors, instead of the keys for a single one. The span is the key's.
    pub tips: Option<Spanned<Vec<TipDescription>>>,
    /// Points that two links share in every posture.
    pub closes: Vec<ClosureDescription>,
    /// Kinds of warnings that the file accepts.
    pub allow: Vec<Spanned<String>>,
}

/// The meaning of a joint's row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha).
    Standard,
    /// A_i = Rx(alpha) Tx(a) Rz(theta) Tz(d).
    Modified,
    /// A_i = origin · motion about or along `axis`, as in a URDF.
    Urdf,
}

/// A unit that the file names for values of one kind.
#[derive(Clone, Debug)]
pub struct NamedUnit {
    /// The key under `units`.
    pub key: &'static str,
    /// As it is written.
    pub text: Spanned<String>,
    /// The unit.
    pub unit: Unit,
}

/// The meaning of the products of inertia of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Products {
    /// Elements of the tensor: xy is -∫xy dm.
    Tensor,
    /// Integrals: xy is ∫xy dm.
    Integral,
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
    /// The joint whose link carries it, or `base`; if absent, the joint before it.
    pub parent: Option<Spanned<String>>,
    /// The frame that its row starts from, in the link frame of the parent.
    pub mount: Option<PoseDescription>,
    /// The joints that it follows without a coordinate of its own.
    pub follows: Option<LeadersDescription>,
    /// The joints whose variables are added to its own coordinate.
    pub adds: Option<LeadersDescription>,
    /// The constant that is added to these variables.
    pub offset: Value,
    /// Length a, m.
    pub a: Value,
    /// Twist alpha, rad.
    pub alpha: Value,
    /// Offset d, m.
    pub d: Value,
    /// Angle theta, rad.
    pub theta: Value,
    /// The link frame at q = 0 in the frame that the row starts from, in rows of the convention urdf.
    pub origin: Option<PoseDescription>,
    /// Direction of the joint axis in the link frame, in rows of the convention urdf.
    pub axis: Option<Spanned<[Value; 3]>>,
    /// Limits.
    pub limits: LimitsDescription,
    /// Mass distribution of the link.
    pub link: Option<BodyDescription>,
    /// The rotor.
    pub motor: Option<MotorDescription>,
    /// Friction at the joint.
    pub friction: FrictionDescription,
    /// A spring at the joint.
    pub spring: Option<SpringDescription>,
    /// The addition to the joint's own entry of the inertia matrix.
    pub armature: Value,
    /// Where the joint begins: its first key.
    pub span: Span,
}

/// Joints whose variables another one depends on, in the order of the file.
#[derive(Clone, Debug)]
pub struct LeadersDescription {
    /// Place of the key that holds them.
    pub key: Span,
    /// Each with its factor.
    pub leaders: Vec<(Spanned<String>, Value)>,
}

/// Limits of a joint.
#[derive(Clone, Debug, Default)]
pub struct LimitsDescription {
    /// Lowest and highest position.
    pub position: Option<Spanned<[Value; 2]>>,
    /// Highest rate.
    pub velocity: Value,
    /// Highest acceleration.
    pub acceleration: Value,
    /// Highest jerk.
    pub jerk: Value,
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
    /// The rate v of tanh(dq/v), which takes the place of the sign of dq in Coulomb friction.
    pub smooth: Value,
    /// The addition to Coulomb friction forwards, subtracted backwards.
    pub offset: Value,
    /// Coefficient of the cube of the rate.
    pub cubic: Value,
    /// How many times the joint's gravity torque is added to dry friction.
    pub load: Value,
    /// The part that fades as the joint begins to move.
    pub stribeck: Option<StribeckDescription>,
}

impl FrictionDescription {
    /// Of what is below each key that has one number, and of Stribeck friction.
    pub(super) fn new(mut of: impl FnMut(&'static str) -> Value, stribeck: Option<StribeckDescription>) -> FrictionDescription {
        FrictionDescription {
            viscous: of("viscous"),
            coulomb: of("coulomb"),
            smooth: of("smooth"),
            offset: of("offset"),
            cubic: of("cubic"),
            load: of("load"),
            stribeck,
        }
    }

    /// The keys that have one number, in the order of a file.
    pub fn numbers(&self) -> [(&'static str, &Value); 6] {
        let FrictionDescription { viscous, coulomb, smooth, offset, cubic, load, stribeck: _ } = self;
        [("viscous", viscous), ("coulomb", coulomb), ("smooth", smooth), ("offset", offset), ("cubic", cubic), ("load", load)]
    }
}

/// Stribeck friction at a joint.
#[derive(Clone, Debug)]
pub struct StribeckDescription {
    /// Place of the key that holds it.
    pub key: Span,
    /// The torque at the lowest rates, beyond Coulomb friction.
    pub torque: Value,
    /// The rate at which 1/e of it is left.
    pub velocity: Value,
}

/// A spring at a joint.
#[derive(Clone, Debug)]
pub struct SpringDescription {
    /// Place of the key that holds it.
    pub key: Span,
    /// Stiffness.
    pub stiffness: Value,
    /// Where it is at rest; 0 where it is not given.
    pub rest: Value,
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
    /// Bodies that are fixed to it.
    pub attached: Vec<AttachedDescription>,
}

/// A body that is fixed to a link.
#[derive(Clone, Debug)]
pub struct AttachedDescription {
    /// Its name.
    pub name: Option<Spanned<String>>,
    /// Its frame in the link's frame.
    pub origin: Option<PoseDescription>,
    /// Its mass distribution, in its frame.
    pub body: BodyDescription,
}

/// The six elements of an inertia tensor.
#[derive(Clone, Debug)]
pub struct InertiaDescription {
    /// Place of the key that holds them.
    pub key: Span,
    /// xx, xy, yy, xz, yz, zz, those that are given.
    pub elements: [Value; 6],
    /// The axes of the tensor in the frame of the body.
    pub rotation: Option<RotationDescription>,
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
    /// The joint whose link carries it, or `base`; if absent, the link before.
    pub on: Option<Spanned<String>>,
    /// Further joints whose rates it spins with.
    pub coupling: Option<LeadersDescription>,
    /// Inertia about the spin axis.
    pub inertia: Value,
    /// Mass.
    pub mass: Value,
    /// Position in the frame of the link that carries it.
    pub position: Option<Spanned<[Value; 3]>>,
    /// Spin axis in that frame.
    pub axis: Option<Spanned<[Value; 3]>>,
    /// Viscous friction at the rotor.
    pub viscous: Value,
    /// Torque at the joint per unit of measured current.
    pub gain: Value,
}

/// A frame in another: each element in the one before it.
#[derive(Clone, Debug)]
pub struct PoseDescription {
    /// Place of the key that holds it.
    pub key: Span,
    /// From the outer frame to the inner one.
    pub elements: Vec<PoseElement>,
    /// Whether all that is given could be read.
    pub complete: bool,
}

/// A translation and a rotation: [R | xyz].
#[derive(Clone, Debug)]
pub struct PoseElement {
    /// Translation.
    pub xyz: Option<Spanned<[Value; 3]>>,
    /// Rotation.
    pub rotation: Option<RotationDescription>,
}

/// A rotation in one of its writings.
#[derive(Clone, Debug)]
pub enum RotationDescription {
    /// Rz(yaw) Ry(pitch) Rx(roll) of the angles roll, pitch, yaw.
    Rpy(Spanned<[Value; 3]>),
    /// A quaternion w, x, y, z of any length but 0.
    Quat(Spanned<[Value; 4]>),
    /// About an axis of any length but 0 by an angle.
    AxisAngle(Spanned<[Value; 3]>, Expression),
    /// The directions of the x and y axes, the second made perpendicular to the first.
    XyAxes(Spanned<[Value; 6]>),
}

/// A named end effector.
#[derive(Clone, Debug)]
pub struct TipDescription {
    /// Its name.
    pub name: Option<Spanned<String>>,
    /// The joint whose link carries it.
    pub joint: Option<Spanned<String>>,
    /// Its frame in that link's frame.
    pub tool: Option<PoseDescription>,
    /// Load in its frame.
    pub payload: Option<BodyDescription>,
    /// Rows of its operational space; those that exist. The span is the key's.
    pub task: Option<Spanned<Vec<Spanned<TaskRow>>>>,
    /// The choices for its inverse kinematics.
    pub inverse_kinematics: PosturesDescription,
}

/// A point that two links share in every posture: the pin at which a loop of links closes.
#[derive(Clone, Debug)]
pub struct ClosureDescription {
    /// Its name.
    pub name: Option<Spanned<String>>,
    /// The joint of a link, or `base`.
    pub joint: Option<Spanned<String>>,
    /// The point in the frame of that link.
    pub at: Option<Spanned<[Value; 3]>>,
    /// The joint of the other link, or `base`.
    pub with: Option<Spanned<String>>,
    /// The point in the frame of that link.
    pub there: Option<Spanned<[Value; 3]>>,
    /// Where it begins: its first key.
    pub span: Span,
}

/// The choices for inverse kinematics.
#[derive(Clone, Debug, Default)]
pub struct PosturesDescription {
    /// The target.
    pub target: Option<Spanned<Target>>,
    /// The joint whose value is given, or `swivel`.
    pub given: Option<Spanned<String>>,
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
    /// The unit of the file for numbers of a dimension; `None` for the SI unit.
    pub fn unit(&self, dimension: Dimension) -> Option<Unit> {
        units::of(self).remove(&dimension)
    }

    /// How often a name occurs in expressions, those of `parameters` included.
    pub fn uses(&self, name: &str) -> usize {
        let count = |expression: &Expression| expression.names().iter().filter(|used| **used == name).count();
        let mut uses = self.parameters.iter().filter_map(|parameter| parameter.value.as_ref()).map(count).sum();
        self.each_value(|_, _, expression| uses += count(expression));
        uses
    }

    /// Reads a YAML description; `None` if the text holds no mapping at all.
    pub fn parse(source: &Source) -> (Option<RobotDescription>, Diagnostics) {
        let mut diagnostics = Diagnostics::new();
        let root = yaml::read(source, &mut diagnostics);
        let mut description = reader::read(source, root.as_ref(), &mut diagnostics);
        if let Some(description) = &mut description {
            units::apply(description, &mut diagnostics);
        }
        (description, diagnostics)
    }
}

#[cfg(test)]
mod tests;
