//! Small types that all stages share: kinds of numbers, joints, targets and rows of the task.

use armgen_algebra::exact::Number;
pub use armgen_algebra::exact::ParameterId;
use armgen_algebra::ring::AngleSum;

/// Equations and emitted code grow with the number of joints; an arm of more than this is a mistake.
pub const MAX_JOINTS: usize = AngleSum::MOST_JOINTS;

/// Most end effectors with names.
pub const MAX_TIPS: usize = 8;

/// The floating-point type of the emitted code; its range bounds the numbers of a description.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scalar {
    /// 64 bits.
    #[default]
    F64,
    /// 32 bits.
    F32,
}

impl Scalar {
    /// Whether the nearest float of a number is finite, and zero only for zero.
    pub fn holds(self, value: &Number) -> bool {
        let nearest = match self {
            Scalar::F64 => value.to_f64(),
            Scalar::F32 => f64::from(value.to_f32()),
        };
        nearest.is_finite() && (nearest != 0.0 || value.is_zero())
    }
}

/// Kinds of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Turns about the z axis of the joint frame; q in rad.
    Revolute,
    /// Slides along the z axis of the joint frame; q in m.
    Prismatic,
}

/// The target of inverse kinematics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The pose of the end effector.
    Pose,
    /// Its position and the turn about the arm's axes, which are all parallel.
    Planar,
    /// Its position.
    Position,
    /// Its position and the direction of its z axis.
    Pointing,
}

impl Target {
    /// The first column of T that the target fixes; it fixes all later columns, too.
    pub fn first_column(self) -> usize {
        match self {
            Target::Pose | Target::Planar => 0,
            Target::Pointing => 2,
            Target::Position => 3,
        }
    }
}

/// A row of the operational space: rows of the geometric Jacobian in the base frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TaskRow {
    /// Linear along x0.
    X,
    /// Linear along y0.
    Y,
    /// Linear along z0.
    Z,
    /// Angular about x0.
    Rx,
    /// Angular about y0.
    Ry,
    /// Angular about z0.
    Rz,
}

impl TaskRow {
    /// All rows, in the order of the geometric Jacobian.
    pub const ALL: [TaskRow; 6] = [TaskRow::X, TaskRow::Y, TaskRow::Z, TaskRow::Rx, TaskRow::Ry, TaskRow::Rz];

    /// Index of the row in the geometric Jacobian.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The word of the file.
    pub fn name(self) -> &'static str {
        ["x", "y", "z", "rx", "ry", "rz"][self.index()]
    }
}

/// What joints may have beyond viscous and Coulomb friction, in the order of documentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// A spring.
    Spring,
    /// Friction with an offset, or that grows with the cube of the rate.
    OffsetOrCubic,
    /// Coulomb friction without a jump.
    SmoothFriction,
    /// Stribeck friction.
    Stribeck,
    /// Friction that grows with the load.
    LoadFriction,
    /// A motor that spins with several joints.
    CoupledMotor,
}

impl Feature {
    /// Every feature.
    pub const ALL: [Feature; 6] = [
        Feature::Spring,
        Feature::OffsetOrCubic,
        Feature::SmoothFriction,
        Feature::Stribeck,
        Feature::LoadFriction,
        Feature::CoupledMotor,
    ];
}
