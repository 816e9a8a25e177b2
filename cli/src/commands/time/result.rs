//! The motion as numbers for people, as CSV and as JSON.

use std::fmt::Write as _;
use std::time::Duration;

use armgen_runtime::timing::{Limit, Piece, Profile, Timing, UpperBound};
use armgen_runtime::trajectory::Progress;
use armgen_terminal::table::{Align, Table};
use nalgebra::SVector;
use serde_json::{json, Value};

use super::arm::Arm;
use super::{Curve, Job};
use crate::number;

/// So many samples has a file at most.
pub(super) const SAMPLES: f64 = 1e7;
/// Places of a segment at which values are taken for the report.
const PLACES: usize = 8;
/// A limit binds where its row comes so close to it in the middle of a segment.
const BINDS: f64 = 0.99;

/// A motion in texts.
pub(super) struct Motion {
    pub(super) text: String,
    pub(super) csv: Option<String>,
    pub(super) json: Option<String>,
}

/// Largest values of a joint, and their shares of the limits.
#[derive(Clone, Copy, Debug, Default)]
struct Largest {
    /// Speed, acceleration, torque.
    value: [f64; 3],
    share: [f64; 3],
}

/// Largest values of all joints, and speed and turn rate of the end effector.
struct AllLargest {
    joints: Vec<Largest>,
    tool: [f64; 2],
}

/// A limit that binds, for how long, and when for the first time.
struct Binding {
    name: String,
    seconds: f64,
    first: f64,
}

/// Six significant digits.
pub(super) fn short(x: f64) -> String {
    number::short(x, 6)
}

pub(super) fn motion<const N: usize>(job: &Job<'_>, arm: &Arm<N>, path: &Curve<N>, timing: &Timing<'_, f64, N>) -> Motion {
    let largest = largest(job, arm, path, timing);
    let bindings = bindings(job, timing);
    Motion {
        text: text(job, path, timing, &largest, &bindings),
        csv: job.asked.csv.as_ref().map(|_| csv(job, arm, path, timing)),
        json: job.asked.json.as_ref().map(|_| lines(&json(job, path, timing, &largest, &bindings))),
    }
}

/// An object as text, one key a line: lists of thousands of numbers would be as many lines.
fn lines(object: &[(&str, Value)]) -> String {
    let lines: Vec<String> = object.iter().map(|(key, value)| format!("  \"{key}\": {value}")).collect();
    format!("{{\n{}\n}}\n", lines.join(",\n"))
}

/// How much of the gap between duration and bound is due to a segment, about.
pub(super) fn gap_of<const N: usize>(timing: &Timing<'_, f64, N>, segment: usize) -> f64 {
    let (Some(own), Some(bound)) = (timing.profile(segment), timing.upper_bound(segment)) else { return 0.0 };
    let middle = |x: [f64; 2], k: f64| 0.5 * (x[0] + x[1]) + 0.5 * k;
    let seconds = end_of(timing, segment) - own.time;
    seconds * (1.0 - (middle(own.x, own.k) / middle(bound.x, bound.k)).max(0.0).sqrt())
}

fn end_of<const N: usize>(timing: &Timing<'_, f64, N>, segment: usize) -> f64 {
    timing.profile(segment + 1).map_or(timing.seconds(), |next| next.time)
}

/// The largest values at places of all segments, by the torques of the arm itself.
fn largest<const N: usize>(job: &Job<'_>, arm: &Arm<N>, path: &Curve<N>, timing: &Timing<'_, f64, N>) -> AllLargest {
    let limits = &job.file.limits;
    let mut largest = vec![Largest::default(); job.manipulator.dof()];
    let mut tool = [0.0f64; 2];
    for segment in 0..timing.segments() {
        for place in 0..=PLACES {
            // At an end itself the sign of a rate may be that of the neighbour.
            let t = 1e-9 + (1.0 - 2e-9) * place as f64 / PLACES as f64;
            let Some(progress) = timing.at(segment, t) else { continue };
            let at = timing.reference(&progress);
            let tau = arm.torque(&at.q, &at.dq, &at.ddq, &slope(path, progress.s));
            for (most, speed) in tool.iter_mut().zip(arm.tool_speeds(&at.q, &at.dq)) {
                *most = most.max(speed);
            }
            for (joint, largest) in largest.iter_mut().enumerate() {
                let [low, high] = limits.effort[joint];
                let values = [
                    (at.dq[joint], limits.velocity[joint]),
                    (at.ddq[joint], limits.acceleration[joint]),
                    (tau[joint], if tau[joint] < 0.0 { -low } else { high }),
                ];
                for (k, (value, limit)) in values.into_iter().enumerate() {
                    largest.value[k] = largest.value[k].max(value.abs());
                    largest.share[k] = largest.share[k].max(value.abs() / limit);
                }
            }
        }
    }
    AllLargest { joints: largest, tool }
}

/// q' at s.
fn slope<const N: usize>(path: &Curve<N>, s: f64) -> SVector<f64, N> {
    let index = path.pieces().partition_point(|piece| piece.start <= s).saturating_sub(1);
    path.pieces().get(index).map_or_else(SVector::zeros, |piece| piece.at(s).slope)
}

/// The limits that bind, the longest first.
fn bindings<const N: usize>(job: &Job<'_>, timing: &Timing<'_, f64, N>) -> Vec<Binding> {
    let mut all: Vec<Binding> = Vec::new();
    for i in 0..timing.segments() {
        let (Some((limit, joint, share)), Some(own)) = (timing.binding(i), timing.profile(i)) else { continue };
        if share < BINDS {
            continue;
        }
        let seconds = end_of(timing, i) - own.time;
        let name = match limit {
            Limit::ToolSpeed | Limit::ToolTurnRate => limit.name().to_owned(),
            _ => format!("{} {}", job.joint(joint), quantity(limit)),
        };
        match all.iter_mut().find(|of| of.name == name) {
            Some(of) => of.seconds += seconds,
            None => all.push(Binding { name, seconds, first: own.time }),
        }
    }
    all.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    all
}

fn quantity(limit: Limit) -> &'static str {
    match limit {
        Limit::EffortHigh | Limit::EffortLow => "torque",
        Limit::AccelerationHigh | Limit::AccelerationLow => "acceleration",
        Limit::Velocity | Limit::ToolSpeed => "speed",
        Limit::ToolTurnRate => "turn rate",
    }
}

fn text<const N: usize>(
    job: &Job<'_>,
    path: &Curve<N>,
    timing: &Timing<'_, f64, N>,
    largest: &AllLargest,
    bindings: &[Binding],
) -> String {
    use Align::{Left, Right};
    let pieces = path.pieces();
    let [from, to] = [pieces.first().map_or(0.0, |piece| piece.start), pieces.last().map_or(0.0, Piece::end)];
    let count = |n: usize, word: &str| crate::input::counted(n, word);
    let mut text = format!(
        "{}: {}, {}, s from {} to {}\n\n",
        job.manipulator.name,
        count(job.manipulator.dof(), "joint"),
        count(pieces.len(), "piece"),
        short(from),
        short(to)
    );
    // The duration upwards, the bound downwards: what is printed is true.
    let digits = (5.0 - timing.seconds().log10().floor()).clamp(0.0, 9.0);
    let scale = 10f64.powf(digits);
    let rounded = |x: f64| format!("{:.1$} s", x / scale, digits as usize);
    let mut numbers = Table::new([("", Left), ("", Right), ("", Left)]);
    numbers.row(["duration".into(), rounded((timing.duration().as_secs_f64() * scale).ceil()), String::new()]);
    let meaning = "no motion on this path within these limits is faster".to_owned();
    numbers.row(["lower bound".into(), rounded((timing.lower_bound() * scale).floor()), meaning]);
    numbers.row(["gap".into(), format!("{} %", percent(timing.gap())), count(timing.segments(), "segment")]);
    text += &numbers.text();
    let mut joints = Table::new([
        ("joint", Left),
        ("speed", Right),
        ("of limit", Right),
        ("acceleration", Right),
        ("of limit", Right),
        ("torque", Right),
        ("of limit", Right),
    ]);
    for (joint, of) in largest.joints.iter().enumerate() {
        let units = if job.slides(joint) { ["m/s", "m/s²", "N"] } else { ["rad/s", "rad/s²", "N m"] };
        let mut cells = vec![job.joint(joint).to_owned()];
        for (k, unit) in units.into_iter().enumerate() {
            cells.push(format!("{} {unit}", four(of.value[k])));
            cells.push(if of.share[k] > 0.0 { format!("{:.1} %", 100.0 * of.share[k]) } else { String::new() });
        }
        joints.row(cells);
    }
    text += &format!("\n{}", joints.text());
    let mut tool = Table::new([("end effector", Left), ("largest", Right), ("of limit", Right)]);
    let rows = ["speed", "turn rate"].into_iter().zip(["m/s", "rad/s"]).zip(largest.tool.iter().zip(job.file.limits.tool));
    for ((name, unit), (value, limit)) in rows.filter(|(_, (_, limit))| limit.is_finite()) {
        tool.row([name.to_owned(), format!("{} {unit}", four(*value)), format!("{:.1} %", 100.0 * value / limit)]);
    }
    if job.file.limits.tool.iter().any(|limit| limit.is_finite()) {
        text += &format!("\n{}", tool.text());
    }
    let mut table = Table::new([("at its limit", Left), ("of the time", Right), ("first at", Right)]);
    let share = |seconds: f64| format!("{:.1} %", 100.0 * seconds / timing.seconds());
    for of in bindings {
        table.row([of.name.clone(), share(of.seconds), format!("{} s", four(of.first))]);
    }
    let rest = timing.seconds() - bindings.iter().map(|of| of.seconds).sum::<f64>();
    if rest > 5e-4 * timing.seconds() {
        table.row([format!("none within {:.0} %", 100.0 * (1.0 - BINDS)), share(rest), String::new()]);
    }
    text += &format!("\n{}", table.text());
    text
}

/// A gap in percent, two digits that count.
fn percent(gap: f64) -> String {
    let percent = 100.0 * gap;
    if percent < 1e-4 {
        return "0.0000".to_owned();
    }
    let digits = (1.0 - percent.log10().floor()).clamp(1.0, 4.0) as usize;
    format!("{percent:.digits$}")
}

/// Four significant digits; 0 in place of errors of rounding.
pub(super) fn four(x: f64) -> String {
    number::short(if x.abs() < 1e-9 { 0.0 } else { x }, 4)
}

/// The end of the path with the acceleration of the last segment.
fn arrival<const N: usize>(timing: &Timing<'_, f64, N>) -> Progress<f64> {
    let last = timing.segments().checked_sub(1).and_then(|i| timing.at(i, 1.0));
    last.unwrap_or_else(|| timing.progress(timing.duration()))
}

fn csv<const N: usize>(job: &Job<'_>, arm: &Arm<N>, path: &Curve<N>, timing: &Timing<'_, f64, N>) -> String {
    let dof = job.manipulator.dof();
    let mut text = String::from("t");
    for quantity in ["q", "dq", "ddq", "tau"] {
        for joint in 0..dof {
            let _ = write!(text, ",{quantity}_{}", job.joint(joint));
        }
    }
    text.push('\n');
    let end = timing.duration();
    for k in 0u32.. {
        // Multiples of the period in nanoseconds: no sample drifts.
        let t = job.asked.period.checked_mul(k).unwrap_or(Duration::MAX).min(end);
        // Beyond the end the motion rests; the last sample is the arrival.
        let progress = if t == end { arrival(timing) } else { timing.progress(t) };
        let at = timing.reference(&progress);
        let tau = arm.torque(&at.q, &at.dq, &at.ddq, &slope(path, progress.s));
        let _ = write!(text, "{}", t.as_secs_f64());
        for values in [&at.q, &at.dq, &at.ddq, &tau] {
            for value in values.iter().take(dof) {
                // Of a joint at rest, 0 in place of -0.
                let _ = write!(text, ",{}", value + 0.0);
            }
        }
        text.push('\n');
        if t == end {
            break;
        }
    }
    text
}

/// Barriers that are not the best of their segment and bound x where a better one begins.
fn beneath<const N: usize>(timing: &Timing<'_, f64, N>, best: &[Option<UpperBound<f64>>]) -> Vec<(usize, UpperBound<f64>)> {
    let mut found: Vec<(usize, UpperBound<f64>)> = Vec::new();
    for (i, bound) in best.iter().enumerate() {
        let Some(mut bound) = bound.filter(|bound| bound.direction != 0) else { continue };
        let (mut segment, direction) = (i, bound.direction);
        loop {
            // The node at which x must be bounded, the segment beyond it, and the bound.
            let (node, beyond, needed) = match direction {
                1 => (segment, segment.checked_sub(1), bound.x[0]),
                _ => (segment + 1, Some(segment + 1), bound.x[1]),
            };
            let Some((beyond, of)) = beyond.and_then(|beyond| Some((beyond, best.get(beyond)?))) else { break };
            let reaches = |of: &UpperBound<f64>| of.x[usize::from(direction == 1)] <= needed;
            let is_bounded = of.as_ref().is_some_and(|of| of.direction == direction || of.direction == 0 && reaches(of));
            let most = timing.profile(node).map_or(f64::INFINITY, |profile| profile.most);
            let known = found.iter().any(|(segment, of)| *segment == beyond && of.direction == direction);
            let next = timing.barriers(beyond)[usize::from(direction != 1)];
            match next {
                Some(next) if !is_bounded && needed < most && !known => {
                    found.push((beyond, next));
                    (bound, segment) = (next, beyond);
                }
                _ => break,
            }
        }
    }
    found
}

fn json<const N: usize>(
    job: &Job<'_>,
    path: &Curve<N>,
    timing: &Timing<'_, f64, N>,
    largest: &AllLargest,
    bindings: &[Binding],
) -> Vec<(&'static str, Value)> {
    let pieces = path.pieces();
    let dof = job.manipulator.dof();
    let knots: Vec<f64> = pieces.iter().map(|piece| piece.start).chain(pieces.last().map(Piece::end)).collect();
    let of_piece = |piece: &Piece<f64, N>| {
        (0..dof).map(|joint| piece.coefficients.iter().map(|c| c[joint]).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    let profiles: Vec<Profile<f64>> = (0..timing.segments()).filter_map(|i| timing.profile(i)).collect();
    let ends = |of: &dyn Fn(&Profile<f64>) -> [f64; 2]| {
        profiles.iter().map(|p| of(p)[0]).chain(profiles.last().map(|p| of(p)[1])).collect::<Vec<_>>()
    };
    let barriers: Vec<Option<UpperBound<f64>>> = (0..timing.segments()).map(|i| timing.upper_bound(i)).collect();
    let of_barrier =
        |of: &dyn Fn(&UpperBound<f64>) -> Value| barriers.iter().map(|b| b.as_ref().map_or(Value::Null, of)).collect::<Vec<_>>();
    let row = |b: &UpperBound<f64>| match b.limit {
        Limit::ToolSpeed | Limit::ToolTurnRate => b.limit.name().to_owned(),
        limit => format!("{} {}", job.joint(b.joint), limit.name()),
    };
    let shares = |k: usize| largest.joints.iter().map(|of| of.share[k]).collect::<Vec<_>>();
    let limits = &job.file.limits;
    let finite = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
    let all = |of: &[f64]| of.iter().map(|x| finite(*x)).collect::<Vec<_>>();
    let names: Vec<&str> = (0..dof).map(|joint| job.joint(joint)).collect();
    vec![
        ("robot", json!(job.manipulator.name)),
        ("joints", json!(names)),
        ("duration", json!(timing.duration().as_secs_f64())),
        ("lower_bound", json!(timing.lower_bound())),
        ("gap", json!(timing.gap())),
        (
            "path",
            json!({
                "knots": knots,
                "coefficients": pieces.iter().map(of_piece).collect::<Vec<_>>(),
                "speed": pieces.iter().map(|piece| piece.speed).collect::<Vec<_>>(),
                "stops": pieces.iter().filter(|piece| piece.stop).map(|piece| piece.start).collect::<Vec<_>>(),
            }),
        ),
        ("ends", json!({"speed": job.file.speed, "hold": job.file.hold})),
        (
            "limits",
            json!({
                "velocity": all(&limits.velocity),
                "acceleration": all(&limits.acceleration),
                "effort": limits.effort.iter().map(|both| all(both)).collect::<Vec<_>>(),
                "tool": all(&limits.tool),
            }),
        ),
        (
            "margins",
            json!({
                "velocity": shares(0),
                "acceleration": shares(1),
                "effort": shares(2),
                "tool": largest.tool.iter().zip(limits.tool).map(|(value, limit)| value / limit).collect::<Vec<_>>(),
            }),
        ),
        ("binding", bindings.iter().map(|of| json!({"limit": of.name, "seconds": of.seconds})).collect()),
        (
            "grid",
            json!({
                "s": ends(&|p| [p.start, p.start + p.length]),
                "t": profiles.iter().map(|p| p.time).chain([timing.seconds()]).collect::<Vec<_>>(),
                "x": ends(&|p| p.x),
                "k": profiles.iter().map(|p| p.k).collect::<Vec<_>>(),
            }),
        ),
        (
            "bound",
            json!({
                "direction": of_barrier(&|b| json!(b.direction)),
                "x0": of_barrier(&|b| json!(b.x[0])),
                "x2": of_barrier(&|b| json!(b.x[1])),
                "k": of_barrier(&|b| json!(b.k)),
                "row": of_barrier(&|b| json!(row(b))),
                "also": beneath(timing, &barriers).iter().map(|(segment, b)| json!({
                    "segment": segment, "direction": b.direction, "x0": b.x[0], "x2": b.x[1], "k": b.k, "row": row(b),
                })).collect::<Vec<_>>(),
            }),
        ),
    ]
}
