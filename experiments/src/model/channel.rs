//! Channels: the recorded quantities of a run, with their names in files and tables, and their units.
//!
//! Runs, figures and expectations identify a channel by its [`Quantity`]; the name serves readers and the headers of logs.

use armgen_runtime::task::Row;

use super::{Robot, Unit};

/// The quantity in a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    // Over time.
    /// t.
    Time,
    /// A quantity of the joint with this index.
    Joint(JointQuantity, usize),
    /// Position of the tip along the axis with this index, m.
    Tip(usize),
    /// Desired position of the tip along the axis with this index, m.
    DesiredTip(usize),
    /// Error of a row of the task, desired minus actual.
    TaskError(Row),
    /// Rotation about z0 from the frame of the path, unwrapped.
    Angle,
    /// |v| of the tip.
    Speed,
    /// |a| of the tip.
    Acceleration,
    /// Rate of the angle.
    TurnRate,
    /// Acceleration of the angle.
    TurnAcceleration,
    /// Distance of the tip from the z0 axis.
    Distance,
    /// Largest change of a velocity component of the tip within a sample.
    VelocityStep,
    /// w = √det(J Jᵀ) of the robot's task.
    Manipulability,
    /// w of the followed rows.
    FollowedManipulability,
    /// T_s lambda_max(J' K J) of the Jacobian transpose.
    LoopGain,
    /// |z| of robust control, z = DᵀQξ.
    ZNorm,
    /// Estimate of the parameter with this index.
    Estimate(usize),

    // Of the whole run.
    /// The largest spectral radius of the sampled loop along the path, linearised about the initial estimate.
    SpectralRadius,
    /// The same with one sample of delay.
    DelayedSpectralRadius,
    /// The largest stable sampling period, linearised about the initial estimate.
    StablePeriod,
    /// The largest spectral radius at rest, where the arm can rest.
    RestRadius,
    /// The largest sampling period with stability at rest.
    RestPeriod,
    /// The largest growth factor of a small deviation in motion.
    MotionGrowth,
    /// The final growth rate of that deviation.
    MotionRate,
    /// Time at which the simulated motion without noise leaves its reference.
    MotionLostAt,
    /// Time of the first joint error above 0.1 rad or m.
    LostAt,
    /// Time of the first limited rate.
    RateLimitedAt,
    /// The end of the path.
    EndsAt,
    /// The number of postures for the first pose of the path.
    PosturesAtStart,
    /// The end of the followed branch, or of the path if the branch continues to it.
    BranchEndsAt,
    /// The largest distance from a stop.
    Stops,
    /// The least distance to a via point: the end of the segment with this index.
    Via(usize),
    /// A quantity of the posture with this index.
    Posture(PostureQuantity, usize),
}

impl Quantity {
    /// An explanation in words, for readers to whom the name is unclear.
    pub fn meaning(self) -> &'static str {
        use JointQuantity as J;
        match self {
            Quantity::Time => "time",
            Quantity::Joint(J::Position, _) => "joint variable",
            Quantity::Joint(J::Error, _) => "error of a joint, desired minus actual",
            Quantity::Joint(J::Rate, _) => "rate of a joint",
            Quantity::Joint(J::Effort, _) => "torque or force of a joint",
            Quantity::Tip(_) => "position of the end effector",
            Quantity::DesiredTip(_) => "desired position of the end effector",
            Quantity::TaskError(_) => "error of the end effector, desired minus actual",
            Quantity::Angle => "turn of the end effector about z0",
            Quantity::Speed => "speed of the end effector",
            Quantity::Acceleration => "size of the acceleration of the end effector",
            Quantity::TurnRate => "rate of the turn about z0",
            Quantity::TurnAcceleration => "acceleration of the turn about z0",
            Quantity::Distance => "distance of the end effector from the z0 axis",
            Quantity::VelocityStep => "change of the end effector's velocity in one sample, along the axis where it is largest",
            Quantity::Manipulability => "manipulability of the task, the root of det(J Jᵀ)",
            Quantity::FollowedManipulability => "manipulability of the rows that are followed",
            Quantity::LoopGain => "sampling period times the largest eigenvalue of Jᵀ K J: the loop of the transpose is stable below 2",
            Quantity::ZNorm => "norm of z = DᵀQξ, the weighed error of robust control",
            Quantity::Estimate(_) => "estimate of a parameter by adaptive control",
            Quantity::SpectralRadius => {
                "largest spectral radius of the sampled loop about rest along the path, stable below 1; with the estimate of the start"
            }
            Quantity::DelayedSpectralRadius => "that spectral radius with one sample of delay",
            Quantity::StablePeriod => {
                "largest stable sampling period: up to it that spectral radius stays below 1; with the estimate of the start"
            }
            Quantity::RestRadius => "largest spectral radius of the sampled loop about rest, stable below 1",
            Quantity::RestPeriod => "largest sampling period at which the loop is stable about rest",
            Quantity::MotionGrowth => "largest growth of a small deviation in motion",
            Quantity::MotionRate => "rate at which a small deviation goes on growing in motion",
            Quantity::MotionLostAt => "when a joint leaves its reference by more than 1 rad or m, without noise",
            Quantity::LostAt => "when a joint is first off by more than 0.1 rad or m",
            Quantity::RateLimitedAt => "when a rate was first cut to its limit",
            Quantity::EndsAt => "end of the path",
            Quantity::PosturesAtStart => "number of postures that reach the first pose of the path",
            Quantity::BranchEndsAt => "when the branch of postures ends that is followed",
            Quantity::Stops => "largest miss of a stop",
            Quantity::Via(_) => "least distance to a via point",
            Quantity::Posture(of, _) => of.meaning(),
        }
    }
}

/// Quantities of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointQuantity {
    /// q.
    Position,
    /// q_d - q.
    Error,
    /// dq.
    Rate,
    /// tau.
    Effort,
}

/// Quantities of a posture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PostureQuantity {
    /// Position of the tip along the axis with this index.
    Tip(usize),
    /// Manipulability w of the robot's task.
    Manipulability,
    /// Angle of the end effector's y axis in the plane.
    Heading,
    /// Semi-axis of the velocity ellipsoid with this index.
    Velocity(usize),
    /// Direction of that axis.
    Direction(usize),
    /// Semi-axis of the force ellipsoid with this index.
    Force(usize),
    /// Condition number of the Jacobian in the plane.
    Condition,
    /// Distance of the Jacobian in the plane to a singular matrix.
    Distance,
}

impl PostureQuantity {
    /// All posture quantities, in the order of files.
    pub const ALL: [PostureQuantity; 13] = [
        PostureQuantity::Tip(0),
        PostureQuantity::Tip(1),
        PostureQuantity::Tip(2),
        PostureQuantity::Manipulability,
        PostureQuantity::Heading,
        PostureQuantity::Velocity(0),
        PostureQuantity::Velocity(1),
        PostureQuantity::Direction(0),
        PostureQuantity::Direction(1),
        PostureQuantity::Force(0),
        PostureQuantity::Force(1),
        PostureQuantity::Condition,
        PostureQuantity::Distance,
    ];

    fn name(self) -> String {
        match self {
            PostureQuantity::Tip(axis) => AXES[axis].into(),
            PostureQuantity::Manipulability => "w".into(),
            PostureQuantity::Heading => "heading".into(),
            PostureQuantity::Velocity(i) => format!("velocity_{}", i + 1),
            PostureQuantity::Direction(i) => format!("direction_{}", i + 1),
            PostureQuantity::Force(i) => format!("force_{}", i + 1),
            PostureQuantity::Condition => "condition".into(),
            PostureQuantity::Distance => "distance".into(),
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            PostureQuantity::Tip(_) => "position of the end effector at a posture",
            PostureQuantity::Manipulability => "manipulability at a posture, the root of det(J Jᵀ)",
            PostureQuantity::Heading => "angle of the end effector's y axis in the plane",
            PostureQuantity::Velocity(_) => "semi-axis of the velocity ellipsoid in the plane",
            PostureQuantity::Direction(_) => "direction of that semi-axis",
            PostureQuantity::Force(_) => "semi-axis of the force ellipsoid in the plane",
            PostureQuantity::Condition => "condition number of the Jacobian in the plane",
            PostureQuantity::Distance => "distance to a singular posture",
        }
    }

    fn unit(self) -> Unit {
        match self {
            PostureQuantity::Tip(_) | PostureQuantity::Distance => Unit::Metre,
            PostureQuantity::Heading => Unit::Radian,
            PostureQuantity::Direction(_) => Unit::Degree,
            _ => Unit::None,
        }
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// A quantity with its name and its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The quantity.
    pub quantity: Quantity,
    /// Its name in files, tables and the headers of logs.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
}

impl Channel {
    /// The channel of a quantity for a run on this robot.
    pub fn new(quantity: Quantity, robot: &Robot) -> Channel {
        use JointQuantity as J;
        let joint = |i: usize| &robot.joints[i];
        let (name, unit) = match quantity {
            Quantity::Time => ("t".into(), Unit::Second),
            Quantity::Joint(J::Position, i) => (format!("q_{}", joint(i).name), joint(i).unit()),
            Quantity::Joint(J::Error, i) => (format!("eq_{}", joint(i).name), joint(i).unit()),
            Quantity::Joint(J::Rate, i) => (format!("dq_{}", joint(i).name), joint(i).rate_unit()),
            Quantity::Joint(J::Effort, i) => (format!("tau_{}", joint(i).name), joint(i).effort_unit()),
            Quantity::Tip(axis) => (AXES[axis].into(), Unit::Metre),
            Quantity::DesiredTip(axis) => (format!("{}_d", AXES[axis]), Unit::Metre),
            Quantity::TaskError(row) => (format!("e_{row}"), Unit::of_row(row)),
            Quantity::Angle => ("angle".into(), Unit::Radian),
            Quantity::Speed => ("speed".into(), Unit::MetrePerSecond),
            Quantity::Acceleration => ("acceleration".into(), Unit::MetrePerSecondSquared),
            Quantity::TurnRate => ("turn_rate".into(), Unit::RadianPerSecond),
            Quantity::TurnAcceleration => ("turn_acceleration".into(), Unit::RadianPerSecondSquared),
            Quantity::Distance => ("distance".into(), Unit::Metre),
            Quantity::VelocityStep => ("velocity_step".into(), Unit::MetrePerSecond),
            Quantity::Manipulability => ("w".into(), Unit::None),
            Quantity::FollowedManipulability => ("w_followed".into(), Unit::None),
            Quantity::LoopGain => ("loop_gain".into(), Unit::None),
            Quantity::ZNorm => ("z_norm".into(), Unit::None),
            Quantity::Estimate(i) => (format!("estimate_{}", robot.parameters[i].name), Unit::None),
            Quantity::SpectralRadius => ("radius".into(), Unit::None),
            Quantity::DelayedSpectralRadius => ("radius_delayed".into(), Unit::None),
            Quantity::StablePeriod => ("stable_period".into(), Unit::Second),
            Quantity::RestRadius => ("rest_radius".into(), Unit::None),
            Quantity::RestPeriod => ("rest_period".into(), Unit::Second),
            Quantity::MotionGrowth => ("motion_growth".into(), Unit::None),
            Quantity::MotionRate => ("motion_rate".into(), Unit::PerSecond),
            Quantity::MotionLostAt => ("motion_lost_at".into(), Unit::Second),
            Quantity::LostAt => ("lost_at".into(), Unit::Second),
            Quantity::RateLimitedAt => ("rate_limited_at".into(), Unit::Second),
            Quantity::EndsAt => ("ends_at".into(), Unit::Second),
            Quantity::PosturesAtStart => ("postures_at_start".into(), Unit::None),
            Quantity::BranchEndsAt => ("branch_ends_at".into(), Unit::Second),
            Quantity::Stops => ("stops".into(), Unit::Metre),
            Quantity::Via(segment) => (format!("via_{}", segment + 1), Unit::Metre),
            Quantity::Posture(of, i) => (format!("{}.{}", i + 1, of.name()), of.unit()),
        };
        Channel { quantity, name, unit }
    }

    /// The channel of a quantity of the posture with this index and name.
    pub fn of_posture(quantity: PostureQuantity, index: usize, posture: &str) -> Channel {
        let name = format!("{posture}.{}", quantity.name());
        Channel { quantity: Quantity::Posture(quantity, index), name, unit: quantity.unit() }
    }
}
