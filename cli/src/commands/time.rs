//! `armgen time`: the fastest motion on a joint path, and what duration no motion can come below.
//!
//! ```text
//! file.rs    the file of a path -> points or pieces, limits, ends
//! curve.rs   points -> pieces
//! tip.rs     a path of the end effector -> pieces
//! arm.rs     the description, executed
//! faults.rs  why a path cannot be timed, at its place in the file
//! result.rs  the motion as numbers, CSV and JSON
//! check.rs   trajectories of others against limits
//! ```

mod arc;
mod arm;
mod check;
#[allow(dead_code)] // The list of all codes serves tools; the page and the tests name them.
mod code;
mod curve;
mod faults;
mod file;
mod result;
mod tip;

use std::path::{Path, PathBuf};
use std::time::Duration;

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::kinds::{JointKind, Scalar, MAX_JOINTS};
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::source::Source;
use armgen_runtime::timing::{self, time_optimal, Ends, JointPath, Node, Piece, Segment, Workspace};

use super::verify::with_spinner;
use crate::output::write_other;
use crate::{input, terminal, DONE, FAULTY, UNREADABLE};
use arm::Arm;
use faults::Faults;
use file::{File, Form, Tip};
use result::Motion;

/// How a path is timed, and what is written.
#[derive(Debug, clap::Args)]
pub(crate) struct Asked {
    /// File of samples to write: t, and q, dq, ddq, tau of each joint
    #[arg(long, value_name = "MOTION.csv", value_hint = clap::ValueHint::FilePath)]
    csv: Option<PathBuf>,
    /// File of the law, its bound and the limits to write
    #[arg(long, value_name = "TIMING.json", value_hint = clap::ValueHint::FilePath)]
    json: Option<PathBuf>,
    /// Judge the samples of a file instead: t, and q, dq, ddq of each joint, the last two optional
    #[arg(long, value_name = "TRAJECTORY.csv", value_hint = clap::ValueHint::FilePath, conflicts_with_all = ["csv", "json"])]
    check: Option<PathBuf>,
    /// Time between samples, s
    #[arg(long, value_name = "SECONDS", default_value = "0.001", value_parser = period)]
    period: Duration,
    /// Segments at most
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(5..=100_000))]
    segments: u32,
    /// Refinement stops at this gap between duration and lower bound
    #[arg(long, value_name = "SHARE", default_value = "0.001", value_parser = share)]
    gap: f64,
}

fn period(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "a number of seconds is needed".to_owned())?;
    let period = Duration::try_from_secs_f64(seconds).map_err(|_| "a positive number of seconds is needed".to_owned())?;
    if period < Duration::from_micros(1) {
        return Err("the shortest period is a microsecond, 1e-6".to_owned());
    }
    Ok(period)
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if share > 0.0 && share.is_finite() => Ok(share),
        _ => Err("a share above 0 is needed, for instance 0.001 for 0.1 %".to_owned()),
    }
}

/// Arms of up to this many joints are timed as such: the others, as arms of [`MAX_JOINTS`]. Joints that the arm does not have rest.
const USUAL: usize = 8;

pub(crate) fn run(robot: &Path, path: Option<&Path>, asked: &Asked) -> u8 {
    let code = match (&asked.check, path) {
        (Some(trajectory), path) => check::run(robot, path, trajectory),
        (None, Some(path)) => timed(robot, path, asked),
        (None, None) => Err(UNREADABLE),
    };
    code.unwrap_or_else(|code| code)
}

fn timed(robot: &Path, path: &Path, asked: &Asked) -> Result<u8, u8> {
    let source = input::description(robot)?;
    let (manipulator, _) = input::manipulator(&source, Scalar::F64, input::Warnings::Counted)?;
    input::without_coupling(&source, &manipulator, "time")?;
    let given = input::source(path)?;
    let (file, mut diagnostics) = file::read(&given, &manipulator, true);
    let Some(file) = file else { return Err(refused(&given, &diagnostics)) };
    let job = Job { description: source.name(), manipulator: &manipulator, file: &file, asked };
    let motion =
        if manipulator.dof() <= USUAL { job.run::<USUAL>(&mut diagnostics) } else { job.run::<MAX_JOINTS>(&mut diagnostics) }?;
    diagnostics.sort();
    let Some(motion) = motion else { return Err(refused(&given, &diagnostics)) };
    input::show(&given, &diagnostics);
    for (out, text) in [(&asked.csv, &motion.csv), (&asked.json, &motion.json)] {
        let (Some(out), Some(text)) = (out, text) else { continue };
        let code = write_other([(robot, "the description"), (path, "the path")], out, text);
        if code != DONE {
            return Err(code);
        }
    }
    Ok(terminal::print(&motion.text))
}

fn refused(source: &Source, diagnostics: &Diagnostics) -> u8 {
    input::show(source, diagnostics);
    terminal::error(&input::verdict(source, diagnostics));
    FAULTY
}

/// The arm of a description, `is_led`: with the speed of its end effector; or the exit code after the message why it cannot be timed.
fn arm<const N: usize>(description: &str, manipulator: &Manipulator, is_led: bool) -> Result<Arm<N>, u8> {
    with_spinner("deriving", || Arm::new(manipulator, is_led)).ok_or_else(|| {
        let reason = "massless: nothing of this arm has mass, so it has no equations of motion";
        terminal::error(&format!("{description}: {reason}"));
        FAULTY
    })
}

/// A path of pieces.
type Curve<const N: usize> = JointPath<f64, N, Vec<Piece<f64, N>>>;

struct Job<'a> {
    /// Where the description comes from.
    description: &'a str,
    manipulator: &'a Manipulator,
    file: &'a File,
    asked: &'a Asked,
}

impl Job<'_> {
    /// The motion; `None` where the path has none, after a diagnostic. An exit code where the arm has none, after a message.
    fn run<const N: usize>(&self, diagnostics: &mut Diagnostics) -> Result<Option<Motion>, u8> {
        let is_led = self.file.limits.tool.iter().any(|limit| limit.is_finite());
        let arm: Arm<N> = arm(self.description, self.manipulator, is_led)?;
        let form = self.file.form.as_ref().expect("a file that is timed has a path");
        let (pieces, away) = match &self.file.tip {
            None => (curve::pieces(form), None),
            Some(tip) => match self.along(tip, form, diagnostics) {
                Some((pieces, away)) => (pieces, Some(away)),
                None => return Ok(None),
            },
        };
        let (pieces, origins): (Vec<Piece<f64, N>>, Vec<curve::Origin>) = curve::with_speeds(pieces, form).into_iter().unzip();
        let faults = Faults { manipulator: self.manipulator, file: self.file, form, origins: &origins };
        faults.of_corners(diagnostics);
        faults.of_positions(&pieces, diagnostics);
        faults.of_missing_limits(&pieces, diagnostics);
        if diagnostics.has_errors() {
            return Ok(None);
        }
        let path = match JointPath::new(pieces.clone()) {
            Ok(path) => path,
            Err(error) => {
                diagnostics.push(faults.of_path(&pieces, &error));
                return Ok(None);
            }
        };
        let limits = self.limits(&arm);
        let segments = self.asked.segments as usize;
        let (mut nodes, mut storage) =
            (vec![Node::empty(); 2 * segments + path.pieces().len()], vec![Segment::empty(); segments + 1]);
        let ends = Ends { speed: self.file.speed, hold: self.file.hold };
        let work = Workspace { nodes: &mut nodes, segments: &mut storage };
        let timing = match with_spinner("timing", || time_optimal(&arm, &path, &limits, ends, self.asked.gap, work)) {
            Ok(timing) => timing,
            Err(error) => {
                diagnostics.push(faults.of_timing(&arm, &path, &error));
                return Ok(None);
            }
        };
        faults.of_start(&arm, &path, diagnostics);
        faults.of_gap(&timing, self.asked.gap, diagnostics);
        faults.of_slow_points(&path, &timing, diagnostics);
        let samples = timing.duration().as_secs_f64() / self.asked.period.as_secs_f64();
        if self.asked.csv.is_some() && samples > result::SAMPLES {
            terminal::error(&format!(
                "the motion takes {} s: {samples:.0} samples are more than the {} of a file; choose a longer `--period`",
                result::short(timing.seconds()),
                result::SAMPLES
            ));
            return Err(UNREADABLE);
        }
        let mut motion = result::motion(self, &arm, &path, &timing);
        if let Some(tip::Distance { metres, radians }) = away {
            motion.text += &format!(
                "\nThe tip leaves its path by at most {metres:.1e} m and {radians:.1e} rad, at seven places of each piece.\n"
            );
        }
        Ok(Some(motion))
    }

    /// The joint spline along a path of the tip, and how far it is from it; `None` after a diagnostic.
    fn along<const N: usize>(
        &self,
        tip: &Tip,
        form: &Form,
        diagnostics: &mut Diagnostics,
    ) -> Option<(curve::Pieces<N>, tip::Distance)> {
        let curve = curve::pieces::<6>(form);
        let (pieces, origins): (Vec<Piece<f64, 6>>, Vec<curve::Origin>) = curve.iter().copied().unzip();
        let faults = Faults { manipulator: self.manipulator, file: self.file, form, origins: &origins };
        faults.of_corners(diagnostics);
        if diagnostics.has_errors() {
            return None;
        }
        let arcs = match form {
            Form::Points { arcs, .. } => arcs.as_slice(),
            Form::Pieces { .. } => &[],
        };
        // The pieces of arcs are their chords.
        if let Some(error) = JointPath::new(pieces.clone()).err().filter(|_| arcs.iter().all(Option::is_none)) {
            diagnostics.push(faults.of_path(&pieces, &error));
            return None;
        }
        match with_spinner("following the tip", || tip::spline(self.manipulator, tip, &curve, arcs)) {
            Ok(found) => Some(found),
            Err(fault) => {
                diagnostics.push(faults.of_tip(&fault, &pieces));
                None
            }
        }
    }

    fn joint(&self, joint: usize) -> &str {
        self.manipulator.joints.get(joint).map_or("", |joint| &joint.name)
    }

    fn slides(&self, joint: usize) -> bool {
        self.manipulator.joints.get(joint).is_some_and(|joint| joint.kind == JointKind::Prismatic)
    }

    fn limits<const N: usize>(&self, arm: &Arm<N>) -> timing::Limits<f64, N> {
        let of = |all: &[f64]| std::array::from_fn(|joint| all.get(joint).copied().unwrap_or(f64::INFINITY));
        let limits = &self.file.limits;
        let effort =
            |side: usize, free: f64| std::array::from_fn(|joint| limits.effort.get(joint).map_or(free, |both| both[side]));
        timing::Limits::velocity(of(&limits.velocity))
            .and_then(|all| all.with_acceleration(of(&limits.acceleration)))
            .and_then(|all| all.with_effort(effort(0, -f64::INFINITY), effort(1, f64::INFINITY)))
            .and_then(|all| {
                let [speed, turn_rate] = limits.tool;
                let (joint, distance) = arm.tip();
                if arm.is_led() {
                    all.with_tool(timing::ToolLimit { speed, turn_rate, joint, distance })
                } else {
                    Ok(all)
                }
            })
            .expect("the file and the description have positive limits")
    }
}
