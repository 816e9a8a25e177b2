//! Experiments as data: files in YAML that say how a robot moves and what should come out.
//!
//! ```text
//! model/     what an experiment is, what a run leaves behind: typed channels, records, expectations
//! read/      text -> Experiment, or every fault with its place
//! run/       Experiment -> Record, generic over the robot; `Arm` is one robot with all its runs
//! judge.rs   Record and Expectation -> a line of the table
//! draw/      Experiment and Record -> SVG
//! campaign   many experiments at once: prepare, warn, run, judge, draw
//! ```
//!
//! Each knows those above it and none below; `campaign` knows all. No robot is compiled into this crate, and it touches no files: the
//! texts of files come in by a function that the caller gives, figures and logs go out as texts.

pub mod campaign;
pub mod draw;
pub mod judge;
pub mod model;
pub mod read;
pub mod run;
