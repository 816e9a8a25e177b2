//! Why a path cannot be timed, and where.

use super::segment::Limit;

/// Why a path cannot be timed, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimingError {
    /// The value of s.
    pub s: f64,
    /// The piece, counted from 0.
    pub piece: usize,
    /// The fault.
    pub fault: TimingFault,
}

/// A fault of a path and its limits. Joints are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimingFault {
    /// A torque along the path is infinite or NaN.
    NotFinite,
    /// The joint moves and has neither a limit of speed nor one of torque.
    MissingLimit {
        /// The joint.
        joint: usize,
    },
    /// A speed at an end of the path is negative or not a number.
    SpeedNegative,
    /// No speed and acceleration along the path keeps the limits here: proved.
    InfeasiblePoint {
        /// The joint that cannot keep its limit.
        joint: usize,
        /// The limit.
        limit: Limit,
    },
    /// The path cannot be got through from here.
    InfeasibleSpeed {
        /// The joint whose limit ends the motion.
        joint: usize,
        /// The limit.
        limit: Limit,
        /// The largest ds with which the arm comes here, or that the limits allow, 1/s.
        speed: f64,
        /// The ds asked for, or that the rest of the path needs; NaN where it is not known.
        needed: f64,
        /// Whether it is proved that no motion exists.
        proved: bool,
    },
    /// At rest at the end, or where the path stops, the torque is beyond its limit: the arm gets there and falls.
    EndNotHeld {
        /// The joint.
        joint: usize,
        /// The torque that holds it, N m or N.
        torque: f64,
        /// The limit with friction at rest, N m or N.
        limit: f64,
    },
    /// No motion was found and none was proved to be impossible: the grid is too coarse for the memory given.
    TooCoarse {
        /// So many segments would do, or are worth a try.
        segments: usize,
    },
}

messages! { TimingError,
    TimingError { s, piece, fault } => "at s = {}, piece {}: {}", s, piece + 1, fault;
}

messages! { TimingFault,
    TimingFault::NotFinite => "a torque is infinite or NaN";
    TimingFault::MissingLimit { joint } => "joint {} moves and has neither a limit of speed nor one of torque", joint + 1;
    TimingFault::SpeedNegative => "a speed at an end of the path is negative or not a number";
    TimingFault::InfeasiblePoint { joint, limit } => "at no speed does joint {} keep its limit ({})", joint + 1, limit.name();
    TimingFault::InfeasibleSpeed { joint, limit, speed, needed, proved: true } => "the path cannot be got through from here, which is proved: joint {} ({}), speed {}, needed {}", joint + 1, limit.name(), speed, needed;
    TimingFault::InfeasibleSpeed { joint, limit, speed, needed, .. } => "the path cannot be got through from here, which is not proved: joint {} ({}), speed {}, needed {}", joint + 1, limit.name(), speed, needed;
    TimingFault::EndNotHeld { joint, torque, limit } => "at rest joint {} needs {} and has {}: the arm gets there and falls", joint + 1, torque, limit;
    TimingFault::TooCoarse { segments } => "no motion was found, and none was proved to be impossible: {} segments are worth a try", segments;
}

impl Limit {
    /// Its name: "torque high".
    pub fn name(self) -> &'static str {
        match self {
            Limit::EffortHigh => "torque high",
            Limit::EffortLow => "torque low",
            Limit::AccelerationHigh => "acceleration high",
            Limit::AccelerationLow => "acceleration low",
            Limit::Velocity => "speed",
            Limit::ToolSpeed => "end effector speed",
            Limit::ToolTurnRate => "end effector turn rate",
        }
    }
}
