//! Logs that are not what they seem: other units, other orders, other signs, frozen columns, torques at a limit.

use std::ops::Range;

use armgen_codegen::diagnostic::Severity;
use nalgebra::DVector;

use crate::arm::Arm;
use crate::estimate::Estimate;
use crate::finding::{Code, Finding, Findings};
use crate::fit::{solve_fast, Gram, Sums};
use crate::log::Log;
use crate::signal::{derivative, median, period, pieces, LowPass, LONGEST_GAP};

/// A joint that stays within this does not move, rad or m.
const STILL: f64 = 1e-3;

/// Equal values in a row that are a frozen signal, and how long they last at least, s.
const FROZEN: (usize, f64) = (20, 0.25);

/// Looks at the signals of a log; the stretches of time, by joint, with torques that do not count.
pub fn signals(arm: &Arm, log: &Log, findings: &mut Findings) -> Vec<Vec<Range<f64>>> {
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
    rates(arm, log, period, findings);
    for i in 0..n {
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
            let help = "its friction and inertia do not show: move every joint, or take the joint out with `fixed` and `keep`";
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

/// Rates against derivatives of positions: unit, clock, sign and order.
fn rates(arm: &Arm, log: &Log, period: f64, findings: &mut Findings) {
    let n = arm.dof();
    let rate = 1.0 / period;
    let Some(longest) = pieces(&log.t, period).into_iter().max_by_key(|piece| piece.len()).filter(|piece| piece.len() > 20)
    else {
        return;
    };
    let filter = LowPass::new((0.1 * rate).min(10.0).max(0.02 * rate), rate);
    let smooth = |x: &[f64]| filter.both_ways(&x[longest.clone()]);
    let slopes: Vec<Vec<f64>> = (0..n).map(|i| derivative(&smooth(&log.q[i]), period)).collect();
    let Some(dq) = &log.dq else {
        for i in (0..n).filter(|&i| !arm.joints[i].slides) {
            let (least, most) = range(&log.q[i]);
            if most - least > 4.0 * std::f64::consts::PI {
                let text = format!("q of joint `{}` ranges from {least} to {most}", arm.joints[i].name);
                let help = "angles are in radians: with degrees write `units: {angle: deg}` into the options";
                let finding = Finding::new(Code::DegreesSuspected, &log.name, text, help);
                findings.push(finding.at(log.lines[0] as usize, 0).in_column(format!("q_{}", arm.joints[i].name)));
            }
        }
        return;
    };
    let rates: Vec<Vec<f64>> = (0..n).map(|i| smooth(&dq[i])).collect();
    // The middle, where the filter has no ends.
    let skip = longest.len() / 20;
    let middle = |x: &[f64]| x[skip..x.len() - skip].to_vec();
    let (slopes, rates): (Vec<Vec<f64>>, Vec<Vec<f64>>) =
        (slopes.iter().map(|x| middle(x)).collect(), rates.iter().map(|x| middle(x)).collect());
    let size = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let correlation = |a: &[f64], b: &[f64]| {
        let shifted = |lag: usize| {
            let forwards: f64 = a[lag..].iter().zip(b).map(|(a, b)| a * b).sum();
            let backwards: f64 = a.iter().zip(&b[lag..]).map(|(a, b)| a * b).sum();
            if forwards.abs() > backwards.abs() {
                forwards
            } else {
                backwards
            }
        };
        let best = (0..=5.min(a.len() - 1)).map(shifted).fold(0.0f64, |a, b| if b.abs() > a.abs() { b } else { a });
        best / (size(a) * size(b)).max(1e-300)
    };
    let moving: Vec<usize> = (0..n)
        .filter(|&i| {
            let (a, b) = range(&log.q[i]);
            b - a > 0.01 && size(&slopes[i]) > 0.0
        })
        .collect();
    let mut misfits = Vec::new();
    let mut ratios = Vec::new();
    for &i in &moving {
        let own = correlation(&rates[i], &slopes[i]);
        if own > 0.9 {
            let slope: f64 = rates[i].iter().zip(&slopes[i]).map(|(a, b)| a * b).sum::<f64>() / size(&slopes[i]).powi(2);
            ratios.push((i, slope));
        } else {
            misfits.push((i, own));
        }
    }
    let first = log.lines[longest.start] as usize;
    if !misfits.is_empty() {
        let best: Vec<usize> = (0..n)
            .map(|i| {
                let fits = (0..n).map(|k| correlation(&rates[i], &slopes[k]).abs());
                fits.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(i, |(k, _)| k)
            })
            .collect();
        let name = |i: usize| arm.joints[i].name.as_str();
        let swapped: Vec<String> = misfits
            .iter()
            .filter(|(i, own)| best[*i] != *i && correlation(&rates[*i], &slopes[best[*i]]) > 0.95f64.max(own + 0.05))
            .map(|(i, _)| format!("dq_{} follows q_{}", name(*i), name(best[*i])))
            .collect();
        if swapped.is_empty() {
            for (i, own) in misfits {
                let column = format!("dq_{}", name(i));
                if own < -0.9 {
                    let text = format!("{column} has the sign of the derivative of q_{} turned", name(i));
                    let help = "turn the sign of one of the two columns";
                    findings.push(Finding::new(Code::SignSuspected, &log.name, text, help).at(first, 0).in_column(column));
                } else {
                    let text = format!("{column} is not the derivative of q_{}: their correlation is {own:.2}", name(i));
                    let help =
                        "look at names, units and clocks of the columns; without the `dq_` columns rates come from positions";
                    findings.push(Finding::new(Code::RateMismatch, &log.name, text, help).at(first, 0).in_column(column));
                }
            }
        } else {
            let help = "give the columns the names of their joints, or rename them under `columns` of the options";
            let text = format!("columns stand under the names of other joints: {}", swapped.join(", "));
            let column = format!("dq_{}", name(misfits[0].0));
            findings.push(Finding::new(Code::JointOrder, &log.name, text, help).at(first, 0).in_column(column));
        }
        return;
    }
    let off = |factor: f64| {
        let near: Vec<usize> = ratios.iter().filter(|(_, ratio)| (ratio / factor - 1.0).abs() < 0.02).map(|(i, _)| *i).collect();
        (!near.is_empty() && near.len() == ratios.len()).then(|| near[0])
    };
    let turn = 180.0 / std::f64::consts::PI;
    for (factor, where_, other) in [(1.0 / turn, "q", "dq"), (turn, "dq", "q")] {
        if let Some(i) = off(factor) {
            let column = format!("{where_}_{}", arm.joints[i].name);
            let text = format!("{where_} is in degrees, or {other} in radians: their slopes differ by 180/pi");
            let help = "write all angles in one unit; with degrees throughout write `units: {angle: deg}` into the options";
            findings.push(Finding::new(Code::DegreesSuspected, &log.name, text, help).at(first, 0).in_column(column));
        }
    }
    if period > 0.5 && off(1000.0).is_some() {
        let text = format!("the period is {period} and rates are 1000 times the slopes of the positions");
        let help = "stamps are in seconds: with milliseconds write `units: {time: ms}` into the options";
        findings.push(Finding::new(Code::MillisecondsSuspected, &log.name, text, help).at(first, 0).in_column("t"));
    }
}

/// A fit that another order or another sign of the torques makes three times better; that is reported, and whether it was.
pub fn torques(estimate: &Estimate<'_>, log: &Log, findings: &mut Findings) -> bool {
    let n = estimate.arm.dof();
    let (equations, _) = estimate.equations(None);
    let active = &estimate.active;
    let rows: Vec<usize> = (0..equations.rows.len()).filter(|&k| equations.rows[k].joint == 0).collect();
    let size: Vec<f64> = (0..n)
        .map(|j| {
            let of: Vec<f64> = rows.iter().map(|k| equations.b[k + j]).collect();
            crate::signal::rms(&of).max(1e-12)
        })
        .collect();
    // Every row counts alike, whatever its joint: A_j' W_j b_k of all pairs of joints.
    let sums = Sums::new(&equations, active);
    let ones: Vec<f64> = equations.rows.iter().map(|row| if row.counts { 1.0 } else { 0.0 }).collect();
    let h = sums.grams(&ones, n, |k| equations.rows[k].joint);
    let cross: Vec<Vec<DVector<f64>>> = (0..n)
        .map(|j| {
            let of = |other: usize| sums.times(j, sums.rows(j).iter().map(|&k| ones[k] * equations.b[k - j + other]));
            (0..n).map(of).collect()
        })
        .collect();
    let cost = |order: &[usize], signs: &[f64]| {
        let mut gram = Gram::zero(active.len());
        for j in 0..n {
            let w = 1.0 / (size[order[j]] * size[order[j]]);
            gram.h += &h[j].h * w;
            gram.g += &cross[j][order[j]] * (w * signs[j]);
            gram.bb += rows.len() as f64;
        }
        gram.squares(&solve_fast(&gram))
    };
    let same: Vec<usize> = (0..n).collect();
    let ones = vec![1.0; n];
    let before = cost(&same, &ones);
    let better = |found: f64| found < before / 9.0;
    let mut best = (before, None);
    for flips in 1u32..1 << n.min(10) {
        if flips.count_ones() as usize > n / 2 + 1 {
            continue;
        }
        let signs: Vec<f64> = (0..n).map(|j| if flips >> j & 1 == 1 { -1.0 } else { 1.0 }).collect();
        let found = cost(&same, &signs);
        if found < best.0 * (1.0 - 1e-9) {
            best = (found, Some(signs));
        }
    }
    let name = |i: usize| estimate.arm.joints[i].name.as_str();
    if let (found, Some(signs)) = &best {
        if better(*found) {
            let turned: Vec<String> = (0..n).filter(|&j| signs[j] < 0.0).map(|j| log.effort_column(name(j))).collect();
            let text = format!(
                "the residual falls to {:.0} % if the sign of {} is turned",
                100.0 * (found / before).sqrt(),
                turned.join(", ")
            );
            let help = "torques act from the link before on the link behind, along the joint axis: turn the sign, or the axis";
            let column = turned[0].clone();
            findings.push(Finding::new(Code::SignSuspected, &log.name, text, help).in_column(column));
            return true;
        }
    }
    let mut best = (before, None);
    for i in 0..n {
        for k in i + 1..n {
            let mut order = same.clone();
            order.swap(i, k);
            let found = cost(&order, &ones);
            if found < best.0 {
                best = (found, Some(order));
            }
        }
    }
    // From the best exchange on, exchanges that help further.
    while let Some(order) = best.1.clone() {
        let mut improved = false;
        for i in 0..n {
            for k in i + 1..n {
                let mut other = order.clone();
                other.swap(i, k);
                let found = cost(&other, &ones);
                if found < best.0 * 0.999 {
                    best = (found, Some(other));
                    improved = true;
                }
            }
        }
        if !improved {
            break;
        }
    }
    if let (found, Some(order)) = &best {
        if better(*found) {
            let moved: Vec<String> = (0..n)
                .filter(|&j| order[j] != j)
                .map(|j| format!("{} is that of {}", log.effort_column(name(order[j])), name(j)))
                .collect();
            let text =
                format!("the residual falls to {:.0} % in another order: {}", 100.0 * (found / before).sqrt(), moved.join(", "));
            let help = "rename the columns under `columns` of the options";
            let column = log.effort_column(name((0..n).find(|&j| order[j] != j).unwrap_or(0)));
            findings.push(Finding::new(Code::JointOrder, &log.name, text, help).in_column(column));
            return true;
        }
    }
    false
}
