//! The commands of the program armgen: a robot arm's description checked, its equations shown, counted, generated and verified.
//!
//! No robot is compiled into it: it builds and works whatever a `robot.yaml` holds.
//!
//! ```text
//! lib.rs         arguments, dispatch
//! commands/      one file per command
//! file_names.rs  what the file of a module may be called
//! hints.rs       what to type instead of arguments that do not exist
//! input.rs       descriptions from files
//! ```
//!
//! The package of Python holds them, too: [`run_with`] is its program, [`generated`] the files that it hands out.

mod commands;
mod companions;
mod file_names;
mod hints;
mod input;
#[cfg(test)]
mod pages;
#[cfg(test)]
mod versions;

use std::ffi::OsString;
use std::path::PathBuf;

use armgen_codegen::emit::Language;
use armgen_codegen::pass::Pass;
use armgen_codegen::show::Form;
use armgen_codegen::source::Source;
use armgen_terminal::{self as terminal, number, output, table, DONE, FAULTY, UNREADABLE};
use clap::builder::styling::{AnsiColor, Styles};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Parser, Subcommand, ValueEnum, ValueHint};

use commands::generate::{Beside, Choices};
use commands::package::Manifest;
use commands::{convert, export, import};

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

const EXAMPLES: &str = "Examples:
  armgen check robot.yaml                      what the file says, and what is wrong with it
  armgen show robot.yaml inertia_matrix        B(q) with the numbers of the file
  armgen generate robot.yaml --out robot.rs    the equations as plain no_std Rust
  armgen verify robot.yaml robot.rs            whether that file equals the equations
  armgen import robot.urdf --out robot.yaml    a URDF or a MuJoCo model as a description
  armgen page robot.yaml --out robot.html      the arm, its equations and numbers, to look at
  armgen time robot.yaml path.yaml             the fastest motion on a path within the limits

Exit codes: 0 done, 1 something is wrong in a file or outside its expectation,
2 a file cannot be read, is not UTF-8 or cannot be written, or the options are wrong.";

/// A kind of warning by its name.
fn kind_of_warning(name: &str) -> Result<String, String> {
    armgen_codegen::validate::warning(name).map(|()| name.to_owned())
}

/// From a robot arm's data sheet to its exact equations of motion, and to plain no_std Rust
#[derive(Debug, Parser)]
#[command(name = "armgen", version, styles = STYLES, after_help = EXAMPLES, max_term_width = 100, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Check a description: a summary of the arm, or every fault with its place
    #[command(after_help = "Examples:
  armgen check robot.yaml
  armgen check robots/*.yaml
  armgen check robot.yaml --full                  every table
  armgen check robot.yaml --strict --allow triangle-inequality
  armgen check robot.yaml --format json           for programs (docs/editors.md)
  armgen check robot.yaml --format sarif          for code scanning

A file may allow kinds of warnings itself: `allow: [missing-inertia]`.
The summary goes to standard output; errors and warnings go to standard error, each with
FILE:LINE:COLUMN.
Exit codes: 0 valid (perhaps with warnings), 1 faulty (with --strict also: warnings),
2 a file cannot be opened or is not UTF-8.")]
    Check {
        /// Descriptions of robot arms
        #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
        /// Every table: limits, drives, inertias, frames, what can be identified
        #[arg(long)]
        full: bool,
        /// Form of the output
        #[arg(long, value_enum, default_value_t = CheckFormat::Text)]
        format: CheckFormat,
        /// Fail on warnings
        #[arg(long)]
        strict: bool,
        /// Be silent about a kind of warning; may be given several times
        #[arg(long, value_name = "KIND", value_parser = kind_of_warning)]
        allow: Vec<String>,
    },
    /// Show the equations in closed form, or as numbered steps where these are shorter
    #[command(after_help = "Examples:
  armgen show robot.yaml                                  everything
  armgen show robot.yaml inertia_matrix gravity           B(q) and g(q)
  armgen show robot.yaml inertia_matrix --symbolic        with the names under `parameters`
  armgen show robot.yaml determinant                      where the task's Jacobian is singular
  armgen show robot.yaml gravity --form steps --digits 4  numbered steps, constants as decimals
  armgen show robot.yaml --format latex > equations.tex   for a document with amsmath

A QUANTITY is the name of an emitted function (`armgen count FILE` lists them), one frame as
`link_frame_2`, one Jacobian as `link_jacobian_2`, `determinant`, or `inverse_kinematics`.")]
    Show {
        /// Description of the robot arm
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// What to show; everything if nothing is named
        #[arg(value_name = "QUANTITY")]
        quantities: Vec<String>,
        /// Print the names of parameters instead of their values
        #[arg(long)]
        symbolic: bool,
        /// Which form of the equations; `closed` for arms of up to four joints, else `shortest`, if not given
        #[arg(long, value_enum)]
        form: Option<ShowForm>,
        /// Constants as decimals of so many digits instead of exactly
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=17))]
        digits: Option<u8>,
        /// Form of the output
        #[arg(long, value_enum, default_value_t = ShowFormat::Text)]
        format: ShowFormat,
    },
    /// Generate the module of an arm, in Rust or another language
    #[command(after_help = "Examples:
  armgen generate robot.yaml --out src/robot.rs           then: mod robot;
  armgen generate robot.yaml --scalar f32 > robot_f32.rs
  armgen generate robot.yaml --trig fast > robot.rs       for machines with wide vectors
  armgen generate robot.yaml --out robot.rs --verify      with a certificate, robot.cert.json
  armgen generate robot.yaml --out robot.rs --bounds      with robot_bounds.rs, error bounds
  armgen generate robot.yaml --out robot.rs --c-abi       with robot.h, for C
  armgen generate robot.yaml --out robot.rs --runtime     with robot_runtime.rs, for controllers
  armgen generate robot.yaml --language c --out robot.h   the same functions in C, without Rust
  armgen generate robot.yaml --language c --package --out robot_package   for CMake and ROS 2
  armgen generate robot.yaml --language matlab --out +robot
  armgen generate robot.yaml --functions gravity,inertia_matrix_with > robot.rs
  armgen generate robot.yaml --out robot.rs --check       is the file up to date? (for CI)

The module is one file of free functions over arrays, in MATLAB a folder: in Rust no allocation,
no std, no dependency but libm.
Exit codes: 0 done, 1 the description is faulty or with --check a file differs,
2 a file cannot be read or written.")]
    Generate {
        /// Description of the robot arm
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// File to write; standard output if not given
        #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
        out: Option<PathBuf>,
        #[command(flatten)]
        choices: Choices,
        #[command(flatten)]
        beside: Beside,
        #[command(flatten)]
        manifest: Manifest,
    },
    /// Turn a serial chain of a URDF or a MuJoCo model into a description
    #[command(after_help = "Examples:
  armgen import robot.urdf --out robot.yaml
  armgen import robot.urdf --tip tool0 --lock finger_joint=0.04 --out robot.yaml
  armgen import robot.urdf --tip left=left_hand --tip right=right_hand --out robot.yaml
  armgen import robot.urdf --snap 0 --report report.json > robot.yaml
  xacro robot.urdf.xacro | armgen import - --out robot.yaml

The chain goes from the root, or --base, to the only tip that there is, or --tip; of several tips
the arm is all of their chains, and --all takes every joint that moves. Fixed joints
become poses, and what hangs on a link beside the chain becomes part of it, exactly. 1.5708 is
taken for pi/2; how far that can move the end effector and the torques stands in the head of the
description. The format: docs/import.md.
Exit codes: 0 done, 1 the file, or the file with these options, is refused,
2 a file cannot be read or written.")]
    Import {
        /// URDF or MuJoCo model of the robot; `-` for standard input
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        choices: import::Choices,
        #[command(flatten)]
        results: import::Results,
    },
    /// Write a description in rows of another convention
    #[command(after_help = "Examples:
  armgen convert robot.yaml --convention urdf --out frames.yaml
  armgen convert robot.yaml --convention standard --out rows.yaml
  armgen import robot.urdf --out robot.yaml
  armgen convert robot.yaml --convention modified > rows.yaml

Joint axes are lines, exactly; rows of Denavit and Hartenberg are what their common normals say,
and bodies are attached where their frames were. What does not end as a decimal, a fraction or a
root is rounded to 17 digits, which is said. To urdf nothing is rounded.
Exit codes: 0 done, 1 the description is faulty, 2 a file cannot be read or written.")]
    Convert {
        /// Description of the robot arm
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// The convention of the result
        #[arg(long, value_enum)]
        convention: convert::To,
        /// File to write; standard output if not given
        #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
        out: Option<PathBuf>,
    },
    /// Write a description as a URDF
    #[command(after_help = "Examples:
  armgen export robot.yaml --format urdf --out robot.urdf
  armgen export robot.yaml --format urdf > robot.urdf

Decimals are written digit by digit, multiples of pi/12 as the nearest float, which armgen import
takes for what it means. What a URDF cannot hold is named, one line each: rotors, armatures,
payload, gravity, ... `armgen import robot.urdf --tip tool` gives the arm back.
Exit codes: 0 done, 1 the description is faulty, 2 a file cannot be read or written.")]
    Export {
        /// Description of the robot arm
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// What to write
        #[arg(long, value_enum)]
        format: export::Format,
        /// File to write; standard output if not given
        #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
        out: Option<PathBuf>,
    },
    /// Verify that a module equals the equations of its description, exactly
    #[command(after_help = "Examples:
  armgen verify robot.yaml src/robot.rs
  armgen generate robot.yaml --out robot.rs --verify && armgen verify robot.yaml robot.rs
  armgen verify identified.yaml out/certificate.json             of `armgen identify --report out`
  armgen verify robot.yaml timing.json                           of `armgen time --json timing.json`

The text of the module is read back by a checker of its own, which derives the equations from the
description the textbook's way and compares both, exactly, at random points of prime fields and at
a rational one. If a certificate, robot.cert.json, stands beside robot.rs, it must be of these two
texts. In comments the hash of the description, costs and bounds are judged; other words are not.
The compiler is not judged, nor are the sines and cosines themselves: for those see
docs/sine-and-cosine.md.
Exit codes: 0 equal, 1 not equal or faulty (the first entry that differs is named),
2 a file cannot be opened or is not UTF-8.")]
    Verify {
        /// Description of the robot arm
        #[arg(value_name = "ROBOT.yaml", value_hint = ValueHint::FilePath)]
        description: PathBuf,
        /// The module that was generated from it, of MATLAB the folder; or a certificate of identified numbers, or a timing
        #[arg(value_name = "ROBOT.rs", value_hint = ValueHint::FilePath)]
        module: PathBuf,
        /// The language of the module; that of its extension if not given
        #[arg(long, value_parser = language_parser())]
        language: Option<Language>,
    },
    /// Plan a motion that shows the parameters of an arm, within its limits at all times
    #[command(after_help = "Examples:
  armgen excite robot.yaml
  armgen excite robot.yaml --out motion.csv --duration 20 --rate 250
  armgen excite robot.yaml --out motion.csv --options excite.yaml
  armgen excite robot.yaml --out motion.csv --simulate arm.yaml        and motion.log.csv

Limits are those of the description: velocity, acceleration or effort, position. Options give the
posture of the start and a box for the origins of frames (docs/identification.md). Limits hold
between samples, too, by proof. The motion begins and ends at the same posture and can be repeated.
Exit codes: 0 done, 1 the description or the options are faulty, or no motion was found,
2 a file cannot be read or written, or the options are wrong.")]
    Excite {
        /// Description of the robot arm
        #[arg(value_name = "ROBOT.yaml", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        asked: commands::excite::Asked,
    },
    /// Identify base parameters, friction and drive gains from logs of an arm
    #[command(after_help = "Examples:
  armgen identify robot.yaml log.csv --out identified.yaml --report out
  armgen identify robot.yaml free.csv loaded.csv --load 2.5 --options identify.yaml
  armgen identify robot.yaml --validate held_out.csv             judges the numbers of the file

Logs are CSV with columns t, q_JOINT, dq_JOINT (optional), tau_JOINT or current_JOINT; options rename
columns and give units, loads and sessions (docs/identification.md). The file of --out is the
description with new numbers, their intervals as comments; every other byte stays.
Exit codes: 0 done, 1 the description, the options or a log is faulty, or parameters do not show,
2 a file cannot be read or written.")]
    Identify {
        /// Description of the robot arm
        #[arg(value_name = "ROBOT.yaml", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Logs to identify from
        #[arg(value_name = "LOG.csv", value_hint = ValueHint::FilePath)]
        logs: Vec<PathBuf>,
        /// Options: logs with their loads, names of columns, units, friction, cutoff, delays
        #[arg(long, value_name = "IDENTIFY.yaml", value_hint = ValueHint::FilePath)]
        options: Option<PathBuf>,
        /// Log to judge by; may be given several times
        #[arg(long, value_name = "LOG.csv", value_hint = ValueHint::FilePath)]
        validate: Vec<PathBuf>,
        /// Mass of the load at the end effector in the last log, kg
        #[arg(long, value_name = "MASS")]
        load: Option<f64>,
        /// File for the description with the identified numbers
        #[arg(long, value_name = "IDENTIFIED.yaml", value_hint = ValueHint::FilePath)]
        out: Option<PathBuf>,
        /// Folder for report.json, report.html, the certificate, and torques of each log
        #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
        report: Option<PathBuf>,
        /// Leave faulty rows out, with a warning
        #[arg(long)]
        skip_bad: bool,
        /// Lower the bias that noise of positions makes, by the reference of the drives, columns `qr_JOINT`
        #[arg(long)]
        instruments: bool,
        /// Joint that is locked in all logs: its friction, and what only its motion shows, stay; may be given several times
        #[arg(long, value_name = "JOINT")]
        without: Vec<String>,
        /// Keep parameters that the logs do not show
        #[arg(long)]
        accept_unexcited: bool,
    },
    /// Find the fastest motion on a joint path within limits, with a bound for all motions
    #[command(after_help = "Examples:
  armgen time robot.yaml path.yaml
  armgen time robot.yaml path.yaml --csv motion.csv --period 0.004
  armgen time robot.yaml path.yaml --json timing.json --gap 0.0001
  armgen time robot.yaml --check motion.csv       does any trajectory keep the limits?

A path is a YAML file with points or polynomials, limits where they differ from those of the
description, and speeds at its ends (docs/timing.md). Limits of position, speed, acceleration and
torque hold between samples, too.
Exit codes: 0 done, 1 a file is faulty, the path has no motion within the limits, or with --check
a limit is exceeded, 2 a file cannot be read or written, or the options are wrong.")]
    Time {
        /// Description of the robot arm
        #[arg(value_name = "ROBOT.yaml", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// The path; with --check its limits alone are used
        #[arg(value_name = "PATH.yaml", value_hint = ValueHint::FilePath, required_unless_present = "check")]
        path: Option<PathBuf>,
        #[command(flatten)]
        asked: commands::time::Asked,
    },
    /// Count the operations of every emitted function
    #[command(after_help = "Examples:
  armgen count robot.yaml
  armgen count robot.yaml --format json
  armgen count robot.yaml --functions inverse_dynamics,gravity
  armgen count robot.yaml --without grouping,origin-along-axis       what these passes are worth

mul: multiplications, add: additions and subtractions, div: divisions, neg: sign changes of
results, sincos: pairs of sine and cosine, exp: exponentials of Stribeck friction.")]
    Count {
        /// Description of the robot arm
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Form of the output
        #[arg(long, value_enum, default_value_t = CountFormat::Text)]
        format: CountFormat,
        /// Functions to count, separated by commas; all if none is named
        #[arg(long, value_name = "NAMES", value_delimiter = ',')]
        functions: Vec<String>,
        /// Passes to leave out, of those that make the functions cheaper (docs/passes.md), separated by commas
        #[arg(long, value_name = "PASSES", value_delimiter = ',', value_parser = pass_parser())]
        without: Vec<Pass>,
        /// Count multiplications that are fused with an addition, too, as `armgen generate --fma` prints them
        #[arg(long)]
        fma: bool,
    },
    /// Write the page of an arm: one HTML file to look at, without network or server
    #[command(after_help = "Examples:
  armgen page robot.yaml --out robot.html                then open robot.html in a browser
  armgen page robot.yaml --out robot.html --log out/adaptive_a.csv

The page shows the arm with its frames, the rows of the description as a draughtsman would draw
them, the bodies as cuboids of their inertia, and the numbers of the emitted functions at the
posture of its sliders (docs/page.md).
Exit codes: 0 done, 1 the description is faulty, 2 a file cannot be read or written.")]
    Page {
        /// Description of the robot arm
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// File to write; the name of the description with `.html` if not given
        #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
        out: Option<PathBuf>,
        /// Log to be played on the arm, a CSV file of an experiment; may be given several times
        #[arg(long = "log", value_name = "CSV", value_hint = ValueHint::FilePath)]
        logs: Vec<PathBuf>,
    },
    /// Print the JSON Schema of robot.yaml, for editors
    #[command(after_help = "Examples:
  armgen schema > robot.schema.json

Editors use it for completion, explanations and a first check (docs/editors.md). It accepts every
file that armgen accepts; `armgen check` also judges names, signs and sums.")]
    Schema,
    /// Run experiments on an arm, draw them, compare them with their expectations
    #[cfg(feature = "run")]
    #[command(after_help = "Examples:
  armgen run --robot arm.yaml                              everything in experiments/, into out/
  armgen run --robot arm.yaml my_experiments/*.yaml --out results

The table goes to standard output; DIR receives figures (SVG), logs (CSV) and a page with
them all, index.html. The format: docs/experiments.md.
An experiment for another robot is skipped; if none is left, the arm moves along a demonstration.
Exit codes: 0 all as expected, 1 a result is outside its expectation or a file is faulty,
2 a file cannot be opened.")]
    Run {
        /// Description of the arm, robot.yaml: 1 to 8 joints, with six task rows or one for each joint
        #[arg(long, value_name = "ROBOT", value_hint = ValueHint::FilePath)]
        robot: PathBuf,
        /// Experiments; all of `experiments/` if no file is named
        #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
        /// Folder for figures (SVG), logs (CSV) and the page
        #[arg(long, value_name = "DIR", default_value = "out", value_hint = ValueHint::DirPath)]
        out: PathBuf,
    },
    /// Robots move in the lab: `cargo run --release -- run` in the folder of armgen
    #[cfg(not(feature = "run"))]
    #[command(hide = true)]
    Run {
        #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<std::ffi::OsString>,
    },
    /// Print completions for a shell
    #[command(after_help = "Examples:
  armgen completions bash > ~/.local/share/bash-completion/completions/armgen
  armgen completions zsh > ~/.zfunc/_armgen
  armgen completions fish > ~/.config/fish/completions/armgen.fish")]
    Completions {
        /// The shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Write the pages of `man` for the program and its commands
    #[command(after_help = "Examples:
  armgen manual --out ~/.local/share/man/man1       then: man armgen, man armgen-check")]
    Manual {
        /// Folder for the pages
        #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
        out: PathBuf,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ShowForm {
    /// The closed form where it fits a table, else whichever has the fewest characters
    Shortest,
    /// Sums of sines and cosines of joint angles; steps where these are too long
    Closed,
    /// Numbered steps
    Steps,
}

impl From<ShowForm> for Form {
    fn from(form: ShowForm) -> Form {
        match form {
            ShowForm::Shortest => Form::Shortest,
            ShowForm::Closed => Form::Closed,
            ShowForm::Steps => Form::Steps,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ShowFormat {
    /// For a terminal
    Text,
    /// For a document with amsmath
    Latex,
    /// For programs
    Json,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CheckFormat {
    /// For a terminal
    Text,
    /// For programs: one document for all files
    Json,
    /// For code scanning: SARIF 2.1.0
    Sarif,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CountFormat {
    /// For a terminal
    Text,
    /// For programs
    Json,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ScalarName {
    /// 64 bits
    F64,
    /// 32 bits
    F32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TrigName {
    /// The crate libm, angle by angle: the same bits on every machine
    Libm,
    /// The standard library, angle by angle: the module then needs std
    Std,
    /// All angles together in vector instructions, within 1 unit in the last place; libm for large angles
    Fast,
}

fn language_parser() -> impl TypedValueParser<Value = Language> {
    PossibleValuesParser::new(Language::ALL.map(Language::name))
        .map(|name| Language::ALL.into_iter().find(|language| language.name() == name).expect("one of the names of languages"))
}

fn pass_parser() -> impl TypedValueParser<Value = Pass> {
    PossibleValuesParser::new(Pass::ALL.map(Pass::name)).map(|name| Pass::named(&name).expect("one of the names of passes"))
}

/// Does what arguments ask for, the first of which is the name of the program; the exit code.
pub fn run_with(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let given: Vec<OsString> = arguments.into_iter().collect();
    let arguments = match Arguments::try_parse_from(&given) {
        Ok(arguments) => arguments,
        Err(refusal) => {
            let given: Vec<String> = given.iter().skip(1).map(|argument| argument.to_string_lossy().into_owned()).collect();
            let is_of_words =
                matches!(refusal.kind(), ErrorKind::UnknownArgument | ErrorKind::InvalidSubcommand | ErrorKind::InvalidValue);
            if let Some(hint) = hints::of(&given).filter(|_| is_of_words) {
                terminal::error(&hint);
                return UNREADABLE;
            }
            // Help is no failure. Nobody is left to hear that the message cannot be printed.
            let _ = refusal.print();
            return if refusal.use_stderr() { UNREADABLE } else { DONE };
        }
    };
    run(arguments.command)
}

/// The files that `armgen generate` writes with these options, by their names; or why there are none.
///
/// # Errors
/// The options do not go together, or the arm has no such files.
pub fn generated(source: &Source, options: impl IntoIterator<Item = String>) -> Result<Vec<(String, String)>, String> {
    let given = ["armgen", "generate", "robot.yaml"].map(str::to_owned).into_iter().chain(options);
    let arguments = Arguments::try_parse_from(given).map_err(|refusal| refusal.to_string())?;
    match arguments.command {
        Command::Generate { out: Some(out), choices, beside, manifest, .. } => {
            commands::generate::in_memory(source, &out, &choices, &beside, &manifest)
        }
        _ => Err("name the file of the module".to_owned()),
    }
}

fn run(command: Command) -> u8 {
    match command {
        Command::Check { files, full, format, strict, allow } => {
            let doubts = commands::check::Doubts { strict, allow };
            match format {
                CheckFormat::Text => commands::check::run(&files, &doubts, full),
                CheckFormat::Json => commands::check::run_for_programs(&files, &doubts, commands::check::Form::Json),
                CheckFormat::Sarif => commands::check::run_for_programs(&files, &doubts, commands::check::Form::Sarif),
            }
        }
        Command::Show { file, quantities, symbolic, form, digits, format } => {
            let asked = commands::show::Asked { symbolic, form: form.map(Form::from), digits, format };
            commands::show::run(&file, &quantities, &asked)
        }
        Command::Generate { file, out, choices, beside, manifest } => {
            commands::generate::run(&file, out.as_deref(), &choices, &beside, &manifest)
        }
        Command::Import { file, choices, results } => import::run(&file, choices, &results),
        Command::Convert { file, convention, out } => convert::run(&file, convention, out.as_ref()),
        Command::Export { file, format, out } => export::run(&file, format, out.as_ref()),
        Command::Verify { description, module, language } => commands::verify::run(&description, &module, language),
        Command::Excite { file, asked } => commands::excite::run(&file, &asked),
        Command::Identify {
            file,
            logs,
            options,
            validate,
            load,
            out,
            report,
            skip_bad,
            instruments,
            without,
            accept_unexcited,
        } => {
            let asked = commands::identify::Asked {
                logs,
                options,
                validate,
                load,
                report,
                out,
                skip_bad,
                instruments,
                without,
                accept_unexcited,
            };
            commands::identify::run(&file, &asked)
        }
        Command::Time { file, path, asked } => commands::time::run(&file, path.as_deref(), &asked),
        Command::Count { file, format, functions, without, fma } => commands::count::run(&file, format, &functions, without, fma),
        Command::Page { file, out, logs } => commands::page::run(&file, out, &logs),
        #[cfg(feature = "run")]
        Command::Run { robot, files, out } => commands::run::run(&robot, &files, &out),
        #[cfg(not(feature = "run"))]
        Command::Run { arguments: _ } => {
            terminal::error(
                "this armgen was built without experiments; in the folder of its sources, `cargo install --path cli --features run` builds one with `armgen run --robot FILE`, and `cargo run --release -- run` builds the robot of robot.yaml and moves it",
            );
            UNREADABLE
        }
        Command::Schema => commands::schema::run(),
        Command::Completions { shell } => commands::completions::run(shell),
        Command::Manual { out } => commands::manual::run(&out),
    }
}
