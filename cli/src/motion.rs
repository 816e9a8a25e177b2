//! What the robot that this program was built with does to show itself: its first motion.
//!
//! ```text
//! motion/first.rs          the SCARA of the technical project along two lines of its path, in the operational space
//! motion/demonstration.rs  any other arm from posture to posture within its limits, in joint space
//! ```
//!
//! Plant and model are the emitted functions, the torque is held for a millisecond, and the plant is integrated by Runge-Kutta steps. Before
//! anything moves, the spectral radius of the sampled loop along the way tells whether it can.

mod demonstration;
mod first;

use std::time::Duration;

use armgen_generated::{Nominal, DOF, JOINT_IS_REVOLUTE, JOINT_NAMES, NAME};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::simulation::Log;
use armgen_runtime::stability::{analyse, Delay, Linearise, Report, StablePeriod};

use crate::figure::{Figure, Panel, Scale, Style};
use crate::table::{Align, Table};

/// Joint variables, rates or torques of the arm.
type Vector = SVector<f64, DOF>;

/// The sampling period.
const PERIOD: Duration = Duration::from_millis(1);

/// What a motion leaves behind.
pub(crate) struct Outcome {
    /// What was done, what came of it, for the terminal.
    pub(crate) report: String,
    /// File name, without extension, of figure and log.
    pub(crate) name: &'static str,
    /// The figure.
    pub(crate) figure: Figure,
    /// All samples.
    pub(crate) log: Log,
    /// Why the motion is not as expected, if it is not.
    pub(crate) fault: Option<String>,
}

/// Moves the arm: along two lines of the technical project's path if it is that arm, else from posture to posture.
pub(crate) fn run() -> Result<Outcome, String> {
    match first::run() {
        Ok(outcome) => outcome,
        Err(why_not) => {
            let mut outcome = demonstration::run()?;
            outcome.report = format!("  The path of the technical project is skipped: {why_not}.\n\n{}", outcome.report);
            Ok(outcome)
        }
    }
}

/// What the sampled loop is like at these postures; an unstable one is an error, with the period that would hold.
fn stability<C: Linearise<Nominal, DOF>>(controller: &C, postures: &[Vector]) -> Result<String, String> {
    let report = analyse(&Nominal, &Nominal, controller, postures, PERIOD.as_secs_f64(), Delay::NONE)
        .map_err(|error| format!("the sampled loop has no spectral radius: {error:?}"))?;
    let Report { radius, period, .. } = report;
    let milliseconds = |seconds: f64| format!("{:.3} ms", seconds * 1e3);
    let limit = match period {
        StablePeriod::UpTo(limit) => format!("stable up to {}", milliseconds(limit)),
        StablePeriod::AtLeast(limit) => format!("stable up to {} at least", milliseconds(limit)),
        StablePeriod::NotEvenAt(limit) => format!("unstable even at {}", milliseconds(limit)),
    };
    let text = format!("spectral radius {radius:.5} at {}, {limit}", milliseconds(PERIOD.as_secs_f64()));
    if report.is_stable() {
        Ok(text)
    } else {
        Err(format!("the sampled loop is unstable: {text}"))
    }
}

/// `rad` or `m`.
fn unit(joint: usize) -> &'static str {
    if JOINT_IS_REVOLUTE[joint] {
        "rad"
    } else {
        "m"
    }
}

/// `N m` or `N`.
fn effort_unit(joint: usize) -> &'static str {
    if JOINT_IS_REVOLUTE[joint] {
        "N m"
    } else {
        "N"
    }
}

/// Panels of the same quantity of all joints, those that turn apart from those that slide: their units differ.
fn by_kind(title: &str, y: [&str; 2], scale: Scale, log: &Log, column: &dyn Fn(usize) -> String) -> Vec<Panel> {
    [true, false]
        .into_iter()
        .zip(y)
        .filter_map(|(revolute, y)| {
            let joints: Vec<usize> = (0..DOF).filter(|&i| JOINT_IS_REVOLUTE[i] == revolute).collect();
            let panel = Panel::new(title, "t (s)", y, scale);
            let with = |panel: Panel, &i: &usize| panel.line(JOINT_NAMES[i], over_time(log, &column(i)));
            (!joints.is_empty()).then(|| joints.iter().fold(panel, with))
        })
        .collect()
}

/// A column of a log over time.
fn over_time(log: &Log, name: &str) -> Vec<(f64, f64)> {
    let column = |name: &str| log.column(name).into_iter().flatten().collect::<Vec<f64>>();
    column("t").into_iter().zip(column(name)).collect()
}

/// The path of the tip in the plane in which it goes farthest, as desired and as it was.
fn tip_panel(log: &Log) -> Panel {
    let column = |name: &str| log.column(name).into_iter().flatten().collect::<Vec<f64>>();
    let span = |axis: &str| {
        let values = column(&format!("{axis}_d"));
        values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let mut axes = ["x", "y", "z"];
    axes.sort_by(|a, b| span(b).total_cmp(&span(a)));
    let mut seen = [axes[0], axes[1]];
    seen.sort_unstable();
    let [across, up] = seen;
    let way = |suffix: &str| column(&format!("{across}{suffix}")).into_iter().zip(column(&format!("{up}{suffix}")));
    Panel::new("Path of the tip", format!("{across} (m)"), format!("{up} (m)"), Scale::Equal)
        .series("traced", way(""), Style::Line, 6)
        .series("desired", way("_d"), Style::Dashed, 0)
}

/// A table of what each joint did and needed.
fn joint_table(log: &Log, error: Option<&dyn Fn(usize) -> String>) -> String {
    use Align::{Left, Right};
    let mut table = Table::new([
        ("joint", Left),
        ("from", Right),
        ("to", Right),
        ("largest error", Right),
        ("error at end", Right),
        ("largest rate", Right),
        ("largest effort", Right),
    ]);
    for i in 0..DOF {
        let column = |name: String| log.column(&name).into_iter().flatten().collect::<Vec<f64>>();
        let q = column(format!("q{}", i + 1));
        let (low, high) = (q.iter().copied().fold(f64::INFINITY, f64::min), q.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        let largest = |name: String| column(name).into_iter().fold(0.0, |a: f64, x| a.max(x.abs()));
        let last = |name: String| column(name).last().copied().unwrap_or(f64::NAN).abs();
        let u = unit(i);
        table.row([
            format!("{} {}", i + 1, JOINT_NAMES[i]),
            format!("{low:.4} {u}"),
            format!("{high:.4} {u}"),
            error.map_or(String::new(), |name| format!("{:.2e} {u}", largest(name(i)))),
            error.map_or(String::new(), |name| format!("{:.2e} {u}", last(name(i)))),
            format!("{:.4} {u}/s", largest(format!("dq{}", i + 1))),
            format!("{:.3} {}", largest(format!("tau{}", i + 1)), effort_unit(i)),
        ]);
    }
    table.text()
}

/// Names of the columns that belong to each joint.
fn joint_columns(prefix: &'static str) -> impl Iterator<Item = String> {
    (1..=DOF).map(move |i| format!("{prefix}{i}"))
}

fn title(what: &str) -> String {
    format!("{NAME}: {what}")
}
