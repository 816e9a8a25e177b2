//! Runs: experiments on a robot, and their records.
//!
//! ```text
//! instance.rs      a robot: its data, its functions, and the runs compiled for it
//! implausible_settings.rs      warnings before a run
//! start.rs         the start of a run
//! solver.rs        the inverse kinematics of a robot, if it has any
//! postures.rs clik.rs branch.rs control.rs      the kinds of runs; path.rs needs no robot
//! demonstration.rs motion between postures within the limits, for a robot without experiments
//! ```
//!
//! [`Arm`] hides the generic code. The runs are generic over the robot and its numbers of joints, rows and parameters; they are compiled
//! where an [`Instance`] is made. Users of an `Arm` compile without the robot.

mod branch;
mod clik;
mod control;
mod demonstration;
mod implausible_settings;
mod instance;
mod path;
mod postures;
mod solver;
mod start;

pub use instance::{Functions, Instance};
pub use solver::{Probe, Solver, Solves, SolvesNot};

use crate::model::{Experiment, Record, Robot};

/// A robot that runs experiments.
pub trait Arm: Sync {
    /// The data of the robot.
    fn robot(&self) -> &Robot;

    /// Warnings before a run about settings that are probably mistakes: a start outside the limits, a path out of reach, a start off the
    /// path.
    fn implausible_settings(&self, experiment: &Experiment) -> Vec<String>;

    /// Prepares and analyses a run.
    ///
    /// # Errors
    /// The reason why the run is impossible, in words.
    fn prepare<'a>(&'a self, experiment: &'a Experiment) -> Result<Box<dyn Run + 'a>, String>;

    /// A motion that shows the arm, for any arm.
    ///
    /// # Errors
    /// The reason why the motion is impossible, in words.
    fn demonstrate(&self) -> Result<Demonstration, String>;
}

/// The result of a demonstration.
#[derive(Clone, Debug)]
pub struct Demonstration {
    /// A summary of the motion, in lines.
    pub summary: Vec<String>,
    /// All samples.
    pub record: Record,
    /// The deviation from the expected motion, if any.
    pub fault: Option<String>,
}

/// A prepared run.
pub trait Run: Send {
    /// A warning before the run.
    fn warning(&self) -> Option<String> {
        None
    }

    /// Runs it.
    fn run(self: Box<Self>) -> Record;
}

/// A run without preparation.
struct Unprepared<F>(F);

impl<F: FnOnce() -> Record + Send> Run for Unprepared<F> {
    fn run(self: Box<Self>) -> Record {
        (self.0)()
    }
}
