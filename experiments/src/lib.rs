//! Experiments as data: YAML files that describe a robot's motion and the expected results.
//!
//! ```text
//! model/     experiments and their results: typed channels, records, expectations
//! read/      text -> Experiment, or every fault with its position
//! run/       Experiment -> Record, generic over the robot; `Arm` is a robot with all its runs
//! judge.rs   Record and Expectation -> a line of the table
//! draw/      Experiment and Record -> SVG
//! campaign   many experiments at once: prepare, warn, run, judge, draw
//! ```
//!
//! Each module depends only on those above it; `campaign` depends on all. No robot is compiled into this crate, and it accesses no files:
//! the caller passes a function that returns texts of files, and receives figures and logs as texts.

pub mod campaign;
pub mod draw;
pub mod judge;
pub mod model;
pub mod read;
pub mod run;
