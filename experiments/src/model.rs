//! Data types of experiments and of their results.

mod channel;
mod expectation;
mod experiment;
mod law;
mod motion;
mod number;
mod record;
mod robot;
mod unit;

pub use channel::{Channel, JointQuantity, PostureQuantity, Quantity};
pub use expectation::{Expectation, Take, Target};
pub use experiment::{
    Algorithm, AlgorithmKind, Body, BranchRun, ClikRun, ControlRun, Experiment, Noise, Posture, Postures, ReferenceGains,
    Sampling, Start,
};
pub use law::{Adaptation, ControlLaw, ControlLawKind, EstimateBounds, Gain, Per};
pub use motion::{Motion, Sheet, Trajectory};
pub use number::{digits, number};
pub use record::{Ended, Peak, Record, Shape, Shapes, Speed};
pub use robot::{Joint, Parameter, Robot};
pub use unit::Unit;
