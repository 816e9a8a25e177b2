//! What is expected of a run: a channel, how one number is taken of it, and what that number should be.

use super::Channel;

/// One line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// Of a log, or of the numbers of the whole run.
    pub channel: Channel,
    /// How the number is taken.
    pub take: Take,
    /// What it should be.
    pub target: Target,
}

/// How one number is taken of a channel; times in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Take {
    /// It is a number of the whole run.
    Number,
    /// The value at a time.
    At(f64),
    /// The largest absolute value in an interval.
    Peak(f64, f64),
    /// The largest value in an interval.
    Highest(f64, f64),
    /// The smallest value in an interval.
    Lowest(f64, f64),
    /// The rate at which it decays from the beginning to the end of an interval, 1/s.
    Decay(f64, f64),
}

impl Take {
    /// The last time that is looked at, s; `None` for a number of the whole run.
    pub fn end(self) -> Option<f64> {
        match self {
            Take::Number => None,
            Take::At(to) | Take::Peak(_, to) | Take::Highest(_, to) | Take::Lowest(_, to) | Take::Decay(_, to) => Some(to),
        }
    }
}

/// What a number should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// This value, within a tolerance, which may have been given in percent of it.
    Near {
        /// The value.
        value: f64,
        /// The tolerance.
        tolerance: f64,
        /// The tolerance in percent, if it was given so.
        percent: Option<f64>,
    },
    /// This or less.
    AtMost(f64),
    /// This or more.
    AtLeast(f64),
}
