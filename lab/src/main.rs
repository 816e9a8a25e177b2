//! The lab: runs experiments on the compiled robot of robot.yaml.
//!
//! The controllers and the simulation are generic over the robot, so their machine code belongs to this crate. An edit of robot.yaml
//! therefore recompiles `armgen-generated` and this crate, but not the crates that read, evaluate or draw. The program armgen does not
//! depend on this crate, so it builds even with a faulty robot.yaml.

use std::path::PathBuf;
use std::process::ExitCode;

use armgen_description::source::Source;
use clap::{Parser, Subcommand, ValueHint};

/// The robot of robot.yaml in motion
#[derive(Debug, Parser)]
#[command(name = "lab", version, max_term_width = 100, arg_required_else_help = true)]
#[command(after_help = "Every other command is the program armgen: `cargo install --path cli`, then `armgen --help`.")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run experiments on the robot, draw them, compare them with their expectations
    #[command(after_help = "Examples:
  cargo run --release -- run                               everything in experiments/, into out/
  cargo run --release -- run experiments/adaptive_a.yaml
  cargo run --release -- run my_experiments/*.yaml --out results

The table goes to standard output; DIR receives figures (SVG), logs (CSV) and a page with
them all, index.html. The format: docs/experiments.md.
The robot is the robot of robot.yaml at the time of building: edit it, and the same command
builds and moves yours.
An experiment for another robot is skipped; if none is left, the arm moves along a demonstration.
Exit codes: 0 all as expected, 1 a result is outside its expectation or a file is faulty,
2 a file cannot be opened.")]
    Run {
        /// Experiments; all of `experiments/` if no file is named
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
        /// Folder for figures (SVG), logs (CSV) and the page
        #[arg(long, value_name = "DIR", default_value = "out", value_hint = ValueHint::DirPath)]
        out: PathBuf,
    },
}

fn main() -> ExitCode {
    let Command::Run { files, out } = Arguments::parse().command;
    let description = Source::new("robot.yaml", include_str!("../../robot.yaml"));
    ExitCode::from(armgen_run::run(&files, &out, &armgen_experiments::instance!(armgen_generated), &description))
}
