//! The keys of a description: the one declaration from which the file is read and its [schema](super::schema) is made.
//!
//! Units are SI units: the schema states them, and a file that names others by `units` is converted to them.

use std::borrow::Borrow;

use super::{Convention, Products};
use crate::document::reader::{self, Key};
use crate::kinds::{JointKind, Target};

/// A key with its value.
pub(super) struct Entry {
    key: Key,
    /// The values that it takes.
    pub(super) shape: Shape,
    /// Its meaning, in one or two sentences.
    pub(super) about: &'static str,
}

impl Borrow<Key> for Entry {
    fn borrow(&self) -> &Key {
        &self.key
    }
}

/// The values of a key.
#[derive(Clone, Copy)]
pub(super) enum Shape {
    /// An identifier of Rust that no equation uses.
    Name,
    /// An identifier of Rust. A keyword is free, so YAML's `true` is a name, too.
    RobotName,
    /// Any text.
    Text,
    /// One of these words.
    Word(&'static [&'static str]),
    /// An expression in this unit; the unit is empty for a pure number.
    Expression(&'static str),
    /// A list of so many expressions in this unit.
    Vector(usize, &'static str),
    /// The acceleration of free fall, or a mapping of [`GRAVITY`].
    Gravity,
    /// A mapping, by the name of its definition in the schema.
    Mapping(&'static str, &'static [Entry]),
    /// A list of such mappings.
    List(&'static str, &'static [Entry]),
    /// One pose, or a list of at most [`MOST_POSES`].
    Pose,
    /// A mapping of free names to expressions.
    Parameters,
    /// A mapping of names of joints to factors.
    Factors,
    /// A mapping of the keys of `units` to units.
    Units,
    /// A list of joints, whose keys depend on the convention.
    Joints,
    /// A list of end effectors.
    Tips,
    /// A list of distinct rows of the task.
    Task,
    /// A word of [`REGRESSORS`], or a list of distinct names.
    Regressor,
    /// A list of kinds of warnings.
    Warnings,
}

const fn required(name: &'static str, example: &'static str, shape: Shape, about: &'static str) -> Entry {
    Entry { key: reader::required(name, example), shape, about }
}

const fn usual(name: &'static str, example: &'static str, shape: Shape, about: &'static str) -> Entry {
    Entry { key: reader::usual(name, example), shape, about }
}

const fn optional(name: &'static str, shape: Shape, about: &'static str) -> Entry {
    Entry { key: reader::optional(name), shape, about }
}

/// Poses in one list.
pub(super) const MOST_POSES: usize = 64;

/// The words of `convention`.
pub(super) const CONVENTIONS: [(&str, Convention); 3] =
    [("standard", Convention::Standard), ("modified", Convention::Modified), ("urdf", Convention::Urdf)];
/// The words of `products`.
pub(super) const PRODUCTS: [(&str, Products); 2] = [("tensor", Products::Tensor), ("integral", Products::Integral)];
/// The words of a joint's `type`.
pub(super) const JOINT_KINDS: [(&str, JointKind); 2] = [("revolute", JointKind::Revolute), ("prismatic", JointKind::Prismatic)];
/// The words of `target`.
pub(super) const TARGETS: [(&str, Target); 4] =
    [("pose", Target::Pose), ("position", Target::Position), ("planar", Target::Planar), ("pointing", Target::Pointing)];
/// The words of `regressor`.
pub(super) const REGRESSORS: [&str; 2] = ["standard", "base"];
/// The keys that begin a rotation; a pose or a tensor has at most one of them. `axis` needs `angle`.
pub(super) const ROTATIONS: [&str; 4] = ["rpy", "quat", "axis", "xyaxes"];

/// The words of a table of words and meanings.
const fn words<T: Copy, const N: usize>(table: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = table[i].0;
        i += 1;
    }
    names
}

const CONVENTION_WORDS: &[&str] = &words(&CONVENTIONS);
const PRODUCT_WORDS: &[&str] = &words(&PRODUCTS);
const JOINT_KIND_WORDS: &[&str] = &words(&JOINT_KINDS);
const TARGET_WORDS: &[&str] = &words(&TARGETS);

const LENGTH: &str = "m";
const ANGLE: &str = "rad";
const MASS: &str = "kg";
const MOMENT: &str = "kg m²";
const POSITION: &str = "rad or m";
const RATE: &str = "rad/s or m/s";
const EFFORT: &str = "N m or N";

/// The keys of `gravity` where it is an argument.
pub(super) const GRAVITY: &[Entry] = &[required(
    "argument",
    "argument: [0, 0, -9.81]",
    Shape::Vector(3, "m/s²"),
    "Nominal acceleration of free fall in the base frame; functions that depend on it take it as an argument.",
)];

/// The keys of the file.
pub(super) const ROBOT: &[Entry] = &[
    required("name", "name: my_robot", Shape::RobotName, "Name of the robot: the constant NAME of the module, and the beginning of names in C."),
    required("convention", "convention: standard", Shape::Word(CONVENTION_WORDS), "The kind of rows. standard: Rz(theta) Tz(d) Tx(a) Rx(alpha), as Siciliano writes them. modified: Rx(alpha) Tx(a) Rz(theta) Tz(d), as Craig and Khalil write them. urdf: origin, then the motion about or along axis."),
    required("gravity", "gravity: [0, 0, -9.81]", Shape::Gravity, "Acceleration of free fall in the base frame: [0, 0, -9.81] if z0 points up."),
    optional("units", Shape::Units, "Units of the numbers of this file; SI units if left out."),
    optional("products", Shape::Word(PRODUCT_WORDS), "Sign of the products of inertia. tensor (the default): xy is the element -∫xy dm of the tensor. integral: xy is ∫xy dm."),
    optional("parameters", Shape::Parameters, "Named quantities for every expression, also for later parameters."),
    optional("base", Shape::Pose, "The frame that rows on the base start from, in the base frame."),
    required("joints", "joints:` and below it one `- name: ...", Shape::Joints, "Joints, each with the link that it moves; from base to tip, and in an arm with branches each behind its parent."),
    optional("tip", Shape::Name, "The joint whose link carries the end effector; the last joint if left out."),
    optional("tool", Shape::Pose, "The frame of the end effector, in the frame of the link that carries it."),
    optional("payload", Shape::Mapping("payload", PAYLOAD), "A load in the frame of the end effector."),
    optional("task", Shape::Task, "Rows of the operational space in your order, in the base frame: x y z linear, rx ry rz angular; all six if left out."),
    optional("regressor", Shape::Regressor, "Columns of the regressor. standard: ten parameters a link, and those of drives. base: the smallest set. Or names of parameters."),
    optional("inverse_kinematics", Shape::Mapping("inverse_kinematics", INVERSE_KINEMATICS), "The target of inverse kinematics, and the joint whose value the caller gives."),
    optional("tips", Shape::Tips, "End effectors, each with a name, in place of tip, tool, payload, task and inverse_kinematics here."),
    optional("closes", Shape::List("closure", CLOSURE), "Points that two links share in every posture, where loops of links close; that they do is proved."),
    optional("allow", Shape::Warnings, "Kinds of warnings that this file accepts."),
];

const NAME_OF_JOINT: Entry = required("name", "name: shoulder", Shape::Name, "Name of the joint.");
const TYPE: Entry = required(
    "type",
    "type: revolute",
    Shape::Word(JOINT_KIND_WORDS),
    "revolute: turns about its axis. prismatic: slides along it. A fixed joint belongs to its link.",
);
const PARENT: Entry = optional(
    "parent",
    Shape::Name,
    "The joint whose link carries this joint, or base; if left out, the joint before it in the list.",
);
const MOUNT: Entry = optional("mount", Shape::Pose, "The frame that the row starts from, in the link frame of parent.");
const FOLLOWS: Entry = optional(
    "follows",
    Shape::Factors,
    "Joints with factors: the joint's variable is the sum of factor · variable, plus offset. The joint has no coordinate of its own.",
);
const ADDS: Entry = optional(
    "adds",
    Shape::Factors,
    "Joints with factors: the joint's variable is its own coordinate, plus the sum of factor · variable, plus offset.",
);
const OFFSET_OF_JOINT: Entry =
    optional("offset", Shape::Expression(POSITION), "Constant that follows or adds adds to the joint's variable; 0 if left out.");
const LIMITS_OF_JOINT: Entry =
    optional("limits", Shape::Mapping("limits", LIMITS), "Limits of the joint: constants of the module, which no equation uses.");
const LINK_OF_JOINT: Entry =
    required("link", "link: {mass: 5}", Shape::Mapping("link", LINK), "Mass distribution of the link, in the link frame.");
const MOTOR_OF_JOINT: Entry = optional(
    "motor",
    Shape::Mapping("motor", MOTOR),
    "The rotor. It moves with the previous link, or with that of on, and spins with ratio times the joint rate, plus coupling.",
);
const FRICTION_OF_JOINT: Entry = optional("friction", Shape::Mapping("friction", FRICTION), "Friction at the joint.");
const SPRING_OF_JOINT: Entry =
    optional("spring", Shape::Mapping("spring", SPRING), "A spring with the torque stiffness · (q - rest).");
const ARMATURE: Entry =
    optional("armature", Shape::Expression("kg m² or kg"), "Inertia that only this joint feels: B_ii gains it.");

/// The keys of a joint with a row of Denavit and Hartenberg.
pub(super) const JOINT: &[Entry] = &[
    NAME_OF_JOINT,
    TYPE,
    PARENT,
    MOUNT,
    FOLLOWS,
    ADDS,
    OFFSET_OF_JOINT,
    required("a", "a: 0.5", Shape::Expression(LENGTH), "Length a of the row."),
    required("alpha", "alpha: pi/2", Shape::Expression(ANGLE), "Twist alpha of the row."),
    required("d", "d: 0", Shape::Expression(LENGTH), "Offset d of the row; a prismatic joint adds its variable."),
    required("theta", "theta: 0", Shape::Expression(ANGLE), "Angle theta of the row; a revolute joint adds its variable."),
    LIMITS_OF_JOINT,
    LINK_OF_JOINT,
    MOTOR_OF_JOINT,
    FRICTION_OF_JOINT,
    SPRING_OF_JOINT,
    ARMATURE,
];
/// The keys of a joint of the convention urdf.
pub(super) const URDF_JOINT: &[Entry] = &[
    NAME_OF_JOINT,
    TYPE,
    PARENT,
    MOUNT,
    FOLLOWS,
    ADDS,
    OFFSET_OF_JOINT,
    optional(
        "origin",
        Shape::Pose,
        "The link frame at q = 0, in the frame that the row starts from; the same frame if left out.",
    ),
    required(
        "axis",
        "axis: [0, 0, 1]",
        Shape::Vector(3, ""),
        "Direction of the joint axis in the link frame, of any length but 0.",
    ),
    LIMITS_OF_JOINT,
    LINK_OF_JOINT,
    MOTOR_OF_JOINT,
    FRICTION_OF_JOINT,
    SPRING_OF_JOINT,
    ARMATURE,
];
/// The keys of an end effector.
pub(super) const TIP: &[Entry] = &[
    required("name", "name: left", Shape::Name, "Name of the end effector, with which the names of its functions begin."),
    required("joint", "joint: left_7", Shape::Name, "The joint whose link carries the end effector."),
    optional("tool", Shape::Pose, "The frame of the end effector, in the frame of the link that carries it."),
    optional("payload", Shape::Mapping("payload", PAYLOAD), "A load in the frame of the end effector."),
    optional(
        "task",
        Shape::Task,
        "Rows of the operational space in your order, in the base frame: x y z linear, rx ry rz angular; all six if left out.",
    ),
    optional(
        "inverse_kinematics",
        Shape::Mapping("inverse_kinematics", INVERSE_KINEMATICS),
        "The target of inverse kinematics, and the joint whose value the caller gives.",
    ),
];
/// The keys of a point that two links share.
pub(super) const CLOSURE: &[Entry] = &[
    optional("name", Shape::Text, "Name of the pin, for messages."),
    required("joint", "joint: rod", Shape::Name, "The joint of a link that has the point, or base."),
    optional("at", Shape::Vector(3, LENGTH), "The point in the frame of that link; its origin if left out."),
    required("with", "with: forearm", Shape::Name, "The joint of the other link, or base."),
    optional("there", Shape::Vector(3, LENGTH), "The same point in the frame of the other link; its origin if left out."),
];
pub(super) const INVERSE_KINEMATICS: &[Entry] = &[
    optional("target", Shape::Word(TARGET_WORDS), "The target; the rows of task if left out."),
    optional("given", Shape::Name, "The joint whose value the caller gives, or swivel for the angle of the elbow."),
];
pub(super) const LIMITS: &[Entry] = &[
    usual("position", "position: [-pi/2, pi/2]", Shape::Vector(2, POSITION), "Lowest and highest position."),
    optional("velocity", Shape::Expression(RATE), "Highest rate."),
    optional("acceleration", Shape::Expression("rad/s² or m/s²"), "Highest acceleration of planned motions."),
    optional("jerk", Shape::Expression("rad/s³ or m/s³"), "Highest rate of the acceleration of planned motions."),
    optional("effort", Shape::Expression(EFFORT), "Highest torque or force, on the joint side of the gear."),
];
const COM: Entry = optional("com", Shape::Vector(3, LENGTH), "Centre of mass in the frame of the body.");
const INERTIA_OF_BODY: Entry = optional(
    "inertia",
    Shape::Mapping("inertia", INERTIA),
    "Inertia tensor about the centre of mass, in the axes of the frame of the body or of the rotation given here.",
);
pub(super) const LINK: &[Entry] = &[
    required("mass", "mass: 5", Shape::Expression(MASS), "Mass."),
    COM,
    INERTIA_OF_BODY,
    optional(
        "attached",
        Shape::List("attached", ATTACHED),
        "Bodies fixed to the link, each in its own frame; the link is the sum of all.",
    ),
];
pub(super) const ATTACHED: &[Entry] = &[
    optional("name", Shape::Text, "Name of the body."),
    optional("origin", Shape::Pose, "Frame of the body in the link's frame."),
    required("mass", "mass: 0.5", Shape::Expression(MASS), "Mass."),
    COM,
    INERTIA_OF_BODY,
];
pub(super) const PAYLOAD: &[Entry] = &[usual("mass", "mass: 1.5", Shape::Expression(MASS), "Mass."), COM, INERTIA_OF_BODY];
const RPY: Entry =
    optional("rpy", Shape::Vector(3, ANGLE), "Angles about the fixed axes x, y and z, in this order: R = Rz(y) Ry(p) Rx(r).");
const QUAT: Entry = optional("quat", Shape::Vector(4, ""), "Quaternion w, x, y, z of any length but 0.");
const AXIS: Entry = optional("axis", Shape::Vector(3, ""), "Axis of the rotation by angle, of any length but 0.");
const ANGLE_OF_ROTATION: Entry = optional("angle", Shape::Expression(ANGLE), "Angle about axis.");
const XYAXES: Entry = optional("xyaxes", Shape::Vector(6, ""), "Directions of x and y; y is made perpendicular to x.");
pub(super) const INERTIA: &[Entry] = &[
    usual("xx", "xx: 0.01", Shape::Expression(MOMENT), "Moment Ixx."),
    usual("yy", "yy: 0.02", Shape::Expression(MOMENT), "Moment Iyy."),
    usual("zz", "zz: 0.015", Shape::Expression(MOMENT), "Moment Izz."),
    optional("xy", Shape::Expression(MOMENT), "Element Ixy = -∫xy dm."),
    optional("xz", Shape::Expression(MOMENT), "Element Ixz = -∫xz dm."),
    optional("yz", Shape::Expression(MOMENT), "Element Iyz = -∫yz dm."),
    RPY,
    QUAT,
    AXIS,
    ANGLE_OF_ROTATION,
    XYAXES,
];
pub(super) const MOTOR: &[Entry] = &[
    usual("ratio", "ratio: 100", Shape::Expression("rad/rad or rad/m"), "Rotor speed over joint speed, not 0; 1 if left out."),
    optional("on", Shape::Name, "The joint whose link carries the rotor, or base; if left out, the link before."),
    optional("coupling", Shape::Factors, "Further joints with factors: the rotor spins with factor times their rates, too."),
    optional("inertia", Shape::Expression(MOMENT), "Inertia about the spin axis, at the rotor: before the gear."),
    optional("mass", Shape::Expression(MASS), "Mass, only if the masses of the links do not contain it."),
    optional("position", Shape::Vector(3, LENGTH), "Position of the mass, in the frame of the link that carries it."),
    optional("axis", Shape::Vector(3, ""), "Spin axis in that frame; the joint axis if left out, which on does not allow."),
    optional("viscous", Shape::Expression("N m s"), "Viscous friction at the rotor; at the joint it acts as ratio² · viscous."),
    optional(
        "gain",
        Shape::Expression("N m/A or N/A"),
        "Torque or force at the joint per unit of measured current; no equation uses it.",
    ),
];
pub(super) const FRICTION: &[Entry] = &[
    usual("viscous", "viscous: 0.2", Shape::Expression("N m s or N s/m"), "Torque viscous · dq."),
    optional("coulomb", Shape::Expression(EFFORT), "Torque coulomb · sign(dq)."),
    optional("smooth", Shape::Expression(RATE), "Rate v, above 0: the Coulomb torque becomes coulomb · tanh(dq/v)."),
    optional("offset", Shape::Expression(EFFORT), "Torque offset in both directions, of either sign."),
    optional("cubic", Shape::Expression("N m s³ or N s³/m³"), "Torque cubic · dq³."),
    optional("load", Shape::Expression(""), "Torque load · |g(q)| · sign(dq), with the joint's entry of gravity."),
    optional("stribeck", Shape::Mapping("stribeck", STRIBECK), "Torque torque · sign(dq) · exp(-|dq|/velocity)."),
];
pub(super) const STRIBECK: &[Entry] = &[
    required("torque", "torque: 2.5", Shape::Expression(EFFORT), "Torque at the lowest rates, beyond Coulomb friction."),
    required("velocity", "velocity: 0.05", Shape::Expression(RATE), "Rate at which 1/e of the torque remains."),
];
pub(super) const SPRING: &[Entry] = &[
    required("stiffness", "stiffness: 200", Shape::Expression("N m/rad or N/m"), "Stiffness, at least 0."),
    optional("rest", Shape::Expression(POSITION), "Position at which the spring has no torque; 0 if left out."),
];
pub(super) const POSE: &[Entry] =
    &[usual("xyz", "xyz: [0, 0, 0.1]", Shape::Vector(3, LENGTH), "Translation."), RPY, QUAT, AXIS, ANGLE_OF_ROTATION, XYAXES];
