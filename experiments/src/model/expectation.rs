//! Expectations about a run: a channel, an evaluation that gives a number, and the expected value of that number.

use super::Channel;

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// A channel over time, or a number of the whole run.
    pub channel: Channel,
    /// The evaluation.
    pub take: Take,
    /// The expected value.
    pub target: Target,
}

/// The evaluation of a channel to a number; times in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Take {
    /// The number of the whole run.
    Number,
    /// The value at a time.
    At(f64),
    /// The largest absolute value in an interval.
    Peak(f64, f64),
    /// The largest value in an interval.
    Highest(f64, f64),
    /// The smallest value in an interval.
    Lowest(f64, f64),
    /// Exponential decay rate between the two ends of an interval, 1/s.
    Decay(f64, f64),
}

impl Take {
    /// The last time that the evaluation needs, s; `None` for a number of the whole run.
    pub fn end(self) -> Option<f64> {
        match self {
            Take::Number => None,
            Take::At(to) | Take::Peak(_, to) | Take::Highest(_, to) | Take::Lowest(_, to) | Take::Decay(_, to) => Some(to),
        }
    }
}

/// The expected value of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// This value within a tolerance, which may come from a percentage.
    Near {
        /// The value.
        value: f64,
        /// The tolerance.
        tolerance: f64,
        /// The tolerance in percent, if given so.
        percent: Option<f64>,
    },
    /// This or less.
    AtMost(f64),
    /// This or more.
    AtLeast(f64),
}
