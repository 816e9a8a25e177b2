//! Logs that are not what they seem: other units, other orders, other signs, frozen columns, torques at a limit.

mod rates;
mod sides;
mod states;
mod torques;

use std::ops::Range;

use armgen_codegen::diagnostic::Severity;

use crate::arm::Arm;
use crate::finding::{Code, Finding, Findings};
use crate::log::Log;
use crate::signal::{median, period, LONGEST_GAP};

pub use states::again;
pub use torques::torques;

/// A joint that stays within this does not move, rad or m.
const STILL: f64 = 1e-3;

/// Equal values in a row that are a frozen signal, and how long they last at least, s.
const FROZEN: (usize, f64) = (20, 0.25);

/// Looks at the signals of a log, but for joints that are known to be locked; the stretches of time, by joint, with torques that do not count.
pub fn signals(arm: &Arm, log: &Log, locked: &[usize], findings: &mut Findings) -> Vec<Vec<Range<f64>>> {
    let n = arm.dof();
    let mut flawed = vec![Vec::new(); n];
    if log.t.len() < 10 {
        return flawed;
    }
    let period = period(&log.t);
    for k in 1..log.t.len() {
        let gap = log.t[k] - log.t[k - 1];
        if gap > LONGEST_GAP * period * (1.0 + 1e-9) {
            let text = format!("{gap:.6} s without a sample, {:.1} periods", gap / period);
            let help = "the log is cut here, and each part filtered by itself";
            findings.push(Finding::new(Code::TimeGap, &log.name, text, help).at(log.lines[k] as usize, 0).in_column("t"));
        }
    }
    if rates::steps(arm, log, period, findings) || rates::rates(arm, log, period, findings) {
        // Nothing else that such columns show counts.
        return flawed;
    }
    for i in (0..n).filter(|i| !locked.contains(i)) {
        let name = &arm.joints[i].name;
        let (least, most) = range(&log.q[i]);
        let frozen_position = frozen(&log.q[i], &log.t);
        let moves_there = |stretch: &Range<usize>| {
            let Some(dq) = &log.dq else { return false };
            let rates: Vec<f64> = dq[i][stretch.clone()].iter().map(|x| x.abs()).collect();
            median(&rates) > 0.02
        };
        let stuck = |findings: &mut Findings, column: String, stretch: Range<usize>, findings_of: &str| {
            let text = format!(
                "the column keeps its value {} for {:.3} s, {findings_of}",
                if column.starts_with("q_") { log.q[i][stretch.start] } else { log.effort[i][stretch.start] },
                log.t[stretch.end - 1] - log.t[stretch.start]
            );
            let help = "look at the recorder or the cable; leave these lines out, or cut the log there";
            let finding = Finding::new(Code::StuckSignal, &log.name, text, help).in_column(column);
            findings.push(finding.at(log.lines[stretch.start] as usize, 0));
        };
        if let Some(stretch) = frozen_position.filter(moves_there) {
            stuck(findings, format!("q_{name}"), stretch, "while its rate shows a motion");
        } else if most - least < STILL {
            let text =
                format!("joint `{name}` stays within {:.2e} {}", most - least, if arm.joints[i].slides { "m" } else { "rad" });
            let help = format!(
                "its friction and inertia do not show: move every joint, or leave a locked joint out, `--without {name}`"
            );
            findings.push(Finding::new(Code::UnexcitedJoint, &log.name, text, help).in_column(format!("q_{name}")));
        }
        let (least, most) = range(&log.effort[i]);
        match frozen(&log.effort[i], &log.t) {
            Some(stretch) if least < most && !is_extreme(log.effort[i][stretch.start], least, most) => {
                stuck(findings, log.effort_column(name), stretch, "while other columns change");
            }
            Some(_) if least == most && log.q.iter().any(|q| range(q).1 - range(q).0 > STILL) => {
                stuck(findings, log.effort_column(name), 0..log.t.len(), "while other columns change");
            }
            _ => {}
        }
        clipped(arm, log, i, &mut flawed[i], findings);
    }
    flawed
}

fn is_extreme(value: f64, least: f64, most: f64) -> bool {
    value == least || value == most
}

fn range(x: &[f64]) -> (f64, f64) {
    x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)))
}

/// The first stretch of equal values that is long enough to be a fault.
fn frozen(x: &[f64], t: &[f64]) -> Option<Range<usize>> {
    let mut start = 0;
    for k in 1..=x.len() {
        if k == x.len() || x[k] != x[start] {
            if k - start >= FROZEN.0 && t[k - 1] - t[start] >= FROZEN.1 {
                return Some(start..k);
            }
            start = k;
        }
    }
    None
}

/// Three or more equal extreme values in a row, and values at the effort limit.
fn clipped(arm: &Arm, log: &Log, i: usize, flawed: &mut Vec<Range<f64>>, findings: &mut Findings) {
    let (x, joint) = (&log.effort[i], &arm.joints[i]);
    let (least, most) = range(x);
    if least == most {
        return;
    }
    let limit = if log.is_current { joint.gain.map_or(f64::INFINITY, |gain| joint.effort / gain) } else { joint.effort };
    let at_limit = |x: f64| x.abs() >= 0.9999 * limit;
    let mut clipped = 0;
    let mut first = None;
    let mut start = 0;
    for k in 1..=x.len() {
        if k < x.len() && x[k] == x[start] {
            continue;
        }
        let run = k - start;
        if (run >= 3 && is_extreme(x[start], least, most)) || at_limit(x[start]) {
            clipped += run;
            first = first.or(Some(start));
            flawed.push(log.t[start] - 0.05..log.t[k - 1] + 0.05);
        }
        start = k;
    }
    if let Some(first) = first {
        let share = clipped as f64 / x.len() as f64;
        let unit = if log.is_current {
            "A"
        } else if joint.slides {
            "N"
        } else {
            "N m"
        };
        let text = format!("{clipped} samples stand at the limit of the signal, first {} {unit}", x[first]);
        let (severity, help) = if share > 0.2 {
            (Severity::Error, "more than a fifth of the column: plan a slower motion, or raise the limit of the drive")
        } else {
            (Severity::Warning, "these samples do not count")
        };
        let column = log.effort_column(&joint.name);
        let finding = Finding::new(Code::ClippedTorque, &log.name, text, help).at(log.lines[first] as usize, 0);
        findings.push(finding.in_column(column).as_bad_as(severity));
    }
}
