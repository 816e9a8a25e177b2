//! `armgen time --check`: whether a trajectory of samples keeps limits, between samples, too.
//!
//! On each interval a joint is the polynomial that the columns define: of degree 5 by q, dq, ddq at both ends, of degree 3 by q and dq, and
//! with q alone the natural cubic spline through all samples.

use std::fmt::Write as _;
use std::path::Path;

use armgen_codegen::kinds::{JointKind, Scalar, MAX_JOINTS};
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::source::Source;
use armgen_runtime::timing::Piece;
use armgen_terminal::table::{Align, Table};
use nalgebra::SVector;

use super::arm::Arm;
use super::file::{self, Limits};
use super::result::{four, short};
use super::USUAL;
use crate::commands::verify::with_spinner;
use crate::{input, terminal, DONE, FAULTY};

/// A limit counts as exceeded from this share of it on: sums of the spline round.
const ROUNDING: f64 = 1e-9;
/// Torques are looked at in this many places of an interval, both ends included,
const PLACES: usize = 9;
/// and this often at the vertex of the parabola through the three places around an extreme,
const VERTICES: usize = 4;
/// which is exact to this part of the distance of places.
const NEAR: f64 = 1e-6;

/// Samples of a trajectory.
struct Samples {
    t: Vec<f64>,
    /// q, dq, ddq: `[joint][sample]`.
    values: [Option<Vec<Vec<f64>>>; 3],
}

/// The worst value of a joint against a limit.
#[derive(Clone, Copy, Debug)]
struct Worst {
    value: f64,
    limit: f64,
    /// By how much of the limit it exceeds the limit; below zero where it does not. Of a range: of its length.
    excess: f64,
    t: f64,
    /// The largest share of the limit at a sample.
    sampled: f64,
}

/// The kinds of limits, in the order of the report; from [`TOOL`] on of the end effector.
const KINDS: [&str; 6] = ["position", "speed", "acceleration", "torque", "speed", "turn rate"];
const TOOL: usize = 4;

/// The worst values, `[kind][joint]`; `None` without a limit. Those of the end effector are in the place of the first joint.
type Verdict = [Vec<Option<Worst>>; 6];

/// Who has a limit, for tables.
fn owner(manipulator: &Manipulator, kind: usize, joint: usize) -> &str {
    if kind >= TOOL {
        "end effector"
    } else {
        &manipulator.joints[joint].name
    }
}

pub(super) fn run(robot: &Path, path: Option<&Path>, trajectory: &Path) -> Result<u8, u8> {
    let source = input::description(robot)?;
    let (manipulator, _) = input::manipulator(&source, Scalar::F64, input::Warnings::Counted)?;
    input::without_coupling(&source, &manipulator, "time")?;
    let limits = match path {
        None => Limits::of(&manipulator),
        Some(path) => {
            let given = input::source(path)?;
            let (file, diagnostics) = file::read(&given, &manipulator, false);
            input::show(&given, &diagnostics);
            file.ok_or(FAULTY)?.limits
        }
    };
    let text = input::source(trajectory)?;
    let samples = read(&text, &manipulator).map_err(|faults| {
        terminal::diagnose(&faults);
        FAULTY
    })?;
    let name = source.name();
    let verdict = if manipulator.dof() <= USUAL {
        judged::<USUAL>(&manipulator, &limits, &samples, name)
    } else {
        judged::<MAX_JOINTS>(&manipulator, &limits, &samples, name)
    }?;
    if verdict.iter().flatten().all(Option::is_none) {
        let message = "missing-limit: neither the description nor a path file has a limit to judge by";
        terminal::error(&format!("{}: {message}; write for instance `limits: {{velocity: [...]}}`", source.name()));
        return Err(FAULTY);
    }
    let code = terminal::print(&report(&manipulator, &samples, &verdict));
    let mut exceeded = false;
    for (kind, (name, worst)) in KINDS.iter().zip(&verdict).enumerate() {
        let of = worst.iter().enumerate().filter_map(|(joint, worst)| Some((joint, (*worst)?)));
        let Some((joint, worst)) = of.max_by(|a, b| a.1.excess.total_cmp(&b.1.excess)) else { continue };
        if worst.excess > ROUNDING {
            exceeded = true;
            let unit = units(&manipulator, joint)[kind];
            let owner = owner(&manipulator, kind, joint);
            let owner = if kind >= TOOL { format!("the {owner}") } else { format!("joint `{owner}`") };
            terminal::error(&format!(
                "{}: limit-exceeded: at t = {} s the {name} of {owner} is {} {unit}, beyond its limit of {} {unit}",
                text.name(),
                short(worst.t),
                short(worst.value),
                short(worst.limit)
            ));
        }
    }
    Ok(if code == DONE && exceeded { FAULTY } else { code })
}

/// Of the kinds of limits.
fn units(manipulator: &Manipulator, joint: usize) -> [&'static str; 6] {
    match manipulator.joints[joint].kind {
        JointKind::Prismatic => ["m", "m/s", "m/s²", "N", "m/s", "rad/s"],
        JointKind::Revolute => ["rad", "rad/s", "rad/s²", "N m", "m/s", "rad/s"],
    }
}

/// The samples of a file, or the messages about its faults.
fn read(source: &Source, manipulator: &Manipulator) -> Result<Samples, String> {
    /// Faults beyond this are counted.
    const SHOWN: usize = 20;
    let name = source.name();
    let mut faults: Vec<String> = Vec::new();
    let mut lines = source.text().lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((head, header)) = lines.next() else {
        return Err(format!(
            "error: {name}: empty-trajectory: the file has no line of column names; write for instance `t,q1,q2`\n"
        ));
    };
    let columns: Vec<&str> = header.split(',').map(|column| column.trim().trim_matches('"')).collect();
    let find = |names: &[String]| columns.iter().position(|column| names.iter().any(|name| name == column));
    let time = find(&["t".to_owned(), "time".to_owned()]);
    let mut missing = Vec::new();
    if time.is_none() {
        missing.push("t".to_owned());
    }
    let mut places: [Vec<Option<usize>>; 3] = Default::default();
    for (order, prefix) in ["q", "dq", "ddq"].into_iter().enumerate() {
        for (joint, of) in manipulator.joints.iter().enumerate() {
            let mut names = vec![format!("{prefix}_{}", of.name), format!("{prefix}{}", joint + 1)];
            if order == 0 {
                names.push(of.name.clone());
            }
            places[order].push(find(&names));
        }
        let known = places[order].iter().flatten().count();
        if known < manipulator.dof() && (order == 0 || known > 0) {
            let absent = places[order].iter().enumerate().filter(|(_, place)| place.is_none());
            missing.extend(absent.map(|(joint, _)| format!("{prefix}_{}", manipulator.joints[joint].name)));
        }
    }
    for (i, column) in columns.iter().enumerate() {
        if columns[..i].contains(column) {
            faults.push(format!("{name}:{}: duplicate-column: there are two columns `{column}`; leave one out", head + 1));
        }
    }
    if !missing.is_empty() {
        faults.push(format!(
            "{name}:{}: missing-column: no column `{}`; columns are t, and for all joints q_JOINT (or q1, q2, ...), and dq_JOINT \
             and ddq_JOINT for all joints or for none",
            head + 1,
            missing.join("`, `")
        ));
    }
    let has = |order: usize| places[order].iter().all(Option::is_some);
    if has(2) && !has(1) && faults.is_empty() {
        faults.push(format!("{name}:{}: missing-column: ddq is there and dq is not; write both, or neither", head + 1));
    }
    if !faults.is_empty() {
        return Err(faults.iter().map(|fault| format!("error: {fault}\n")).collect());
    }
    let mut samples = Samples { t: Vec::new(), values: Default::default() };
    for order in 0..3 {
        samples.values[order] = has(order).then(|| vec![Vec::new(); manipulator.dof()]);
    }
    for (line, text) in lines {
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        if fields.len() != columns.len() {
            faults.push(format!("{name}:{}: wrong-length: {} fields for {} columns", line + 1, fields.len(), columns.len()));
            continue;
        }
        let mut number = |place: usize| match fields[place].parse::<f64>() {
            Ok(x) if x.is_finite() => x,
            other => {
                let code = if other.is_ok() { "not-finite" } else { "bad-number" };
                faults.push(format!("{name}:{}: {code}: `{}` in column `{}`", line + 1, fields[place], columns[place]));
                0.0
            }
        };
        let t = number(time.unwrap_or_default());
        for (values, places) in samples.values.iter_mut().zip(&places) {
            for (values, place) in values.iter_mut().flatten().zip(places.iter().flatten()) {
                values.push(number(*place));
            }
        }
        if samples.t.last().is_some_and(|last| t <= *last) {
            faults.push(format!("{name}:{}: time-not-increasing: t = {t} is not above the one before it", line + 1));
        }
        samples.t.push(t);
    }
    if samples.t.len() < 2 && faults.is_empty() {
        faults.push(format!("{name}: empty-trajectory: a trajectory has two samples at least, found {}", samples.t.len()));
    }
    if faults.is_empty() {
        return Ok(samples);
    }
    let mut text = String::new();
    for fault in faults.iter().take(SHOWN) {
        let _ = writeln!(text, "error: {fault}");
    }
    if faults.len() > SHOWN {
        let _ = writeln!(text, "error: and {} more", faults.len() - SHOWN);
    }
    Err(text)
}

/// The polynomials of the intervals, in powers of t - start.
fn pieces<const N: usize>(samples: &Samples) -> Vec<Piece<f64, N>> {
    let t = &samples.t;
    let n = t.len() - 1;
    let h: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let empty = |i: usize| Piece::new(t[i], h[i], [SVector::zeros(); 6]);
    let mut pieces: Vec<Piece<f64, N>> = (0..n).map(empty).collect();
    let [Some(q), dq, ddq] = &samples.values else { return pieces };
    for (joint, q) in q.iter().enumerate() {
        // Second derivatives of the natural spline, where nothing else is known.
        let second = if dq.is_none() { super::curve::natural(&h, q) } else { Vec::new() };
        for (i, piece) in pieces.iter_mut().enumerate() {
            let (h, chord) = (h[i], (q[i + 1] - q[i]) / h[i]);
            let mut c = [q[i], 0.0, 0.0, 0.0, 0.0, 0.0];
            match (dq, ddq) {
                (Some(dq), Some(ddq)) => {
                    let (v, w, a, b) = (dq[joint][i], dq[joint][i + 1], ddq[joint][i], ddq[joint][i + 1]);
                    // What is left of q, dq, ddq at the end when the first three coefficients are there.
                    let rest = (chord - v) / h - 0.5 * a;
                    let rate = (w - v) / h - a;
                    c[1] = v;
                    c[2] = 0.5 * a;
                    c[3] = (10.0 * rest - 4.0 * rate + 0.5 * (b - a)) / h;
                    c[4] = (-15.0 * rest + 7.0 * rate - (b - a)) / (h * h);
                    c[5] = (6.0 * rest - 3.0 * rate + 0.5 * (b - a)) / (h * h * h);
                }
                (Some(dq), None) => {
                    let (v, w) = (dq[joint][i], dq[joint][i + 1]);
                    c[1] = v;
                    c[2] = (3.0 * chord - 2.0 * v - w) / h;
                    c[3] = (v + w - 2.0 * chord) / (h * h);
                }
                (None, _) => {
                    c[1] = chord - (2.0 * second[i] + second[i + 1]) * h / 6.0;
                    c[2] = 0.5 * second[i];
                    c[3] = (second[i + 1] - second[i]) / (6.0 * h);
                }
            }
            for (to, c) in piece.coefficients.iter_mut().zip(c) {
                to[joint] = c;
            }
        }
    }
    pieces
}

/// The derivative of a piece.
fn derivative<const N: usize>(piece: &Piece<f64, N>) -> Piece<f64, N> {
    let mut of = Piece { coefficients: [SVector::zeros(); 6], ..*piece };
    for k in 1..6 {
        of.coefficients[k - 1] = piece.coefficients[k] * k as f64;
    }
    of
}

/// Where the parabola through three points has its vertex, if the middle value is the largest or the least.
fn vertex(&[(a, x), (b, y), (c, z)]: &[(f64, f64); 3]) -> Option<f64> {
    let (left, right) = ((y - x) / (b - a), (z - y) / (c - b));
    let bend = (right - left) / (c - a);
    let t = 0.5 * (a + b) - 0.5 * left / bend;
    (left * right < 0.0 && a < t && t < c).then_some(t)
}

fn judged<const N: usize>(
    manipulator: &Manipulator,
    limits: &Limits,
    samples: &Samples,
    description: &str,
) -> Result<Verdict, u8> {
    let dof = manipulator.dof();
    let pieces: Vec<Piece<f64, N>> = pieces(samples);
    let mut verdict: Verdict = std::array::from_fn(|_| vec![None; dof]);
    let mut take = |kind: usize, joint: usize, (t, value): (f64, f64), [low, high]: [f64; 2], is_sample: bool| {
        let size = if kind == 0 { high - low } else { high.min(-low) };
        let slot: &mut Option<Worst> = &mut verdict[kind][joint];
        let sampled = slot.map_or(0.0, |worst| worst.sampled);
        let here = if is_sample { (value / if value < 0.0 { low } else { high }).max(0.0) } else { 0.0 };
        for (limit, excess) in [(low, (low - value) / size), (high, (value - high) / size)] {
            if limit.is_finite() && slot.is_none_or(|worst| excess > worst.excess) {
                *slot = Some(Worst { value, limit, excess, t, sampled });
            }
        }
        if let Some(worst) = slot {
            worst.sampled = sampled.max(here);
        }
    };
    for (joint, of) in manipulator.joints.iter().enumerate() {
        let range = of.limits.position.as_ref().map(|range| range.clone().map(|x| x.to_f64()));
        let (v, a) = (limits.velocity[joint], limits.acceleration[joint]);
        for piece in &pieces {
            let rate = derivative(piece);
            let second = derivative(&rate);
            if let Some([low, high]) = range {
                for (t, q) in piece.extremes(joint).into_iter().flatten() {
                    take(0, joint, (t, q), [low, high], t == piece.start);
                }
            }
            for (kind, piece, limit) in [(1, &rate, v), (2, &second, a)] {
                for (t, value) in piece.extremes(joint).into_iter().flatten().filter(|_| limit.is_finite()) {
                    take(kind, joint, (t, value), [-limit, limit], t == piece.start || t == piece.end());
                }
            }
        }
    }
    let is_led = limits.tool.iter().any(|limit| limit.is_finite());
    if is_led || limits.effort.iter().flatten().any(|limit| limit.is_finite()) {
        let arm: Arm<N> = super::arm(description, manipulator, is_led)?;
        with_spinner("checking torques", || {
            for piece in &pieces {
                let mut judge = |t: f64, directions: &dyn Fn(&SVector<f64, N>) -> SVector<f64, N>| {
                    let at = piece.at(t);
                    let tau = arm.torque(&at.q, &at.slope, &at.curvature, &directions(&at.slope));
                    for joint in 0..dof {
                        take(3, joint, (t, tau[joint]), limits.effort[joint], t == piece.start || t == piece.end());
                    }
                    for (kind, (speed, limit)) in arm.tool_speeds(&at.q, &at.slope).into_iter().zip(limits.tool).enumerate() {
                        // A length has one end.
                        take(TOOL + kind, 0, (t, speed), [-limit, limit], t == piece.start || t == piece.end());
                    }
                    tau
                };
                let own = |slope: &SVector<f64, N>| *slope;
                let step = piece.length / (PLACES - 1) as f64;
                let places = (0..PLACES).map(|k| if k + 1 == PLACES { piece.end() } else { piece.start + step * k as f64 });
                let places: Vec<(f64, SVector<f64, N>)> = places.map(|t| (t, judge(t, &own))).collect();
                for kind in (0..2).filter(|&kind| limits.tool[kind].is_finite()) {
                    let speed = |t: f64| {
                        let at = piece.at(t);
                        arm.tool_speeds(&at.q, &at.slope)[kind]
                    };
                    let speeds: Vec<(f64, f64)> = places.iter().map(|(t, _)| (*t, speed(*t))).collect();
                    for three in speeds.windows(3) {
                        let mut three = [three[0], three[1], three[2]];
                        for _ in 0..VERTICES {
                            let Some(t) = vertex(&three).filter(|t| (t - three[1].0).abs() > NEAR * step) else { break };
                            judge(t, &own);
                            let found = (t, speed(t));
                            three = if t < three[1].0 { [three[0], found, three[1]] } else { [three[1], found, three[2]] };
                        }
                    }
                }
                for joint in (0..dof).filter(|&joint| limits.effort[joint].iter().any(|limit| limit.is_finite())) {
                    for three in places.windows(3) {
                        let mut three = [0, 1, 2].map(|k| (three[k].0, three[k].1[joint]));
                        for _ in 0..VERTICES {
                            let Some(t) = vertex(&three).filter(|t| (t - three[1].0).abs() > NEAR * step) else { break };
                            let found = (t, judge(t, &own)[joint]);
                            three = if t < three[1].0 { [three[0], found, three[1]] } else { [three[1], found, three[2]] };
                        }
                    }
                    // Where a joint turns round, friction has either sign.
                    for (t, _) in
                        piece.extremes(joint).into_iter().flatten().filter(|(t, _)| *t > piece.start && *t < piece.end())
                    {
                        for sign in [1.0, -1.0] {
                            let turned =
                                |slope: &SVector<f64, N>| SVector::from_fn(|i, _| if i == joint { sign } else { slope[i] });
                            judge(t, &turned);
                        }
                    }
                }
            }
        });
    }
    Ok(verdict)
}

fn report(manipulator: &Manipulator, samples: &Samples, verdict: &Verdict) -> String {
    use Align::{Left, Right};
    let spline = match samples.values {
        [_, Some(_), Some(_)] => "the quintics that q, dq and ddq define",
        [_, Some(_), None] => "the cubics that q and dq define (Hermite)",
        _ => "the natural cubic spline through q",
    };
    let span = samples.t.last().copied().unwrap_or_default() - samples.t[0];
    let mut text = format!(
        "{}: {} in {} s; between samples {spline}\n\n",
        manipulator.name,
        input::counted(samples.t.len(), "sample"),
        short(span)
    );
    let mut table = Table::new([
        ("limit", Left),
        ("joint", Left),
        ("worst", Right),
        ("allowed", Right),
        ("of limit", Right),
        ("at samples", Right),
        ("at", Right),
        ("", Left),
    ]);
    for (kind, (name, worst)) in KINDS.iter().zip(verdict).enumerate() {
        for (joint, worst) in worst.iter().enumerate() {
            let Some(worst) = worst else { continue };
            let share = |share: f64| if kind == 0 { String::new() } else { format!("{:.3} %", 100.0 * share) };
            let unit = units(manipulator, joint)[kind];
            let verdict = if worst.excess > ROUNDING { "exceeded" } else { "" };
            table.row([
                (*name).to_owned(),
                owner(manipulator, kind, joint).to_owned(),
                format!("{} {unit}", four(worst.value)),
                format!("{} {unit}", four(worst.limit)),
                share(worst.value / worst.limit),
                share(worst.sampled),
                format!("{} s", four(worst.t)),
                verdict.to_owned(),
            ]);
        }
    }
    text += &table.text();
    text += "\nPositions, speeds and accelerations are judged everywhere, by roots of polynomials;\n\
             torques and the end effector in nine places of each interval, and near those at their extremes.\n";
    text
}
