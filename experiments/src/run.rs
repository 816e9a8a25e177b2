//! Runs: what comes of an experiment on a robot.
//!
//! ```text
//! instance.rs      one robot: its data, its functions, and the runs compiled for it
//! implausible_settings.rs      what can be seen before anything moves
//! start.rs         where a run begins
//! solver.rs        the inverse kinematics of a robot, where it has one
//! postures.rs clik.rs branch.rs control.rs      one kind of run each; path.rs needs no robot
//! demonstration.rs for a robot without experiments: from posture to posture within its limits
//! ```
//!
//! [`Arm`] separates generic code from the rest: the runs behind it are generic over the robot and its numbers of joints, rows and
//! parameters, and are compiled where an [`Instance`] is made; whoever holds an `Arm` is compiled without the robot.

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

/// A robot on which experiments run.
pub trait Arm: Sync {
    /// What is known of it.
    fn robot(&self) -> &Robot;

    /// What can be seen of an experiment before anything moves, and hardly is meant: a start outside the limits, a path beyond reach, a
    /// start off the path.
    fn implausible_settings(&self, experiment: &Experiment) -> Vec<String>;

    /// What is known of a run before anything moves.
    ///
    /// # Errors
    /// Why there is no run, in words.
    fn prepare<'a>(&'a self, experiment: &'a Experiment) -> Result<Box<dyn Run + 'a>, String>;

    /// A motion that shows the arm, whatever it is.
    ///
    /// # Errors
    /// Why it cannot be run, in words.
    fn demonstrate(&self) -> Result<Demonstration, String>;
}

/// What a demonstration leaves behind.
#[derive(Clone, Debug)]
pub struct Demonstration {
    /// What was done, a line each.
    pub summary: Vec<String>,
    /// All samples.
    pub record: Record,
    /// Why the motion is not as expected, if it is not.
    pub fault: Option<String>,
}

/// A run that is prepared.
pub trait Run: Send {
    /// What has to be said before anything moves.
    fn warning(&self) -> Option<String> {
        None
    }

    /// Runs it.
    fn run(self: Box<Self>) -> Record;
}

/// A run of which nothing is known beforehand.
struct Unprepared<F>(F);

impl<F: FnOnce() -> Record + Send> Run for Unprepared<F> {
    fn run(self: Box<Self>) -> Record {
        (self.0)()
    }
}
