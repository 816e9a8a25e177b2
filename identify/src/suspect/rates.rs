//! Positions and rates against each other: units, clocks, signs, orders, steps, slopes and lags.

use armgen_codegen::diagnostic::Severity;

use crate::arm::Arm;
use crate::finding::{Code, Finding, Findings};
use crate::log::Log;
use crate::signal::{derivative, pieces, shifted, LowPass, LONGEST_GAP};

use super::{range, STILL};

/// Rates against derivatives of positions: unit, clock, sign, order, slope and lag. True: the angles are in degrees, so nothing else counts.
pub(super) fn rates(arm: &Arm, log: &Log, period: f64, findings: &mut Findings) -> bool {
    let n = arm.dof();
    let rate = 1.0 / period;
    let Some(longest) = pieces(&log.t, period).into_iter().max_by_key(|piece| piece.len()).filter(|piece| piece.len() > 20)
    else {
        return false;
    };
    let filter = LowPass::new((0.1 * rate).min(10.0).max(0.02 * rate), rate);
    let smooth = |x: &[f64]| filter.both_ways(&x[longest.clone()]);
    let slopes: Vec<Vec<f64>> = (0..n).map(|i| derivative(&smooth(&log.q[i]), period)).collect();
    let Some(dq) = &log.dq else { return degrees_throughout(arm, log, findings) };
    // A central difference is the mean rate of two periods, by Simpson's rule.
    let mean = |x: &[f64]| -> Vec<f64> {
        let at = |k: usize, by: isize| x[k.saturating_add_signed(by).min(x.len() - 1)];
        (0..x.len()).map(|k| (at(k, -1) + 4.0 * x[k] + at(k, 1)) / 6.0).collect()
    };
    let rates: Vec<Vec<f64>> = (0..n).map(|i| mean(&smooth(&dq[i]))).collect();
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
        return false;
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
    let is_slow = period > 0.5 && off(1000.0).is_some();
    if is_slow {
        let text = format!("the period is {period} and rates are 1000 times the slopes of the positions");
        let help = "stamps are in seconds: with milliseconds write `units: {time: ms}` into the options";
        findings.push(Finding::new(Code::MillisecondsSuspected, &log.name, text, help).at(first, 0).in_column("t"));
    }
    if is_slow || off(1.0 / turn).is_some() || off(turn).is_some() {
        return false;
    }
    if off(1.0).is_some() && degrees_throughout(arm, log, findings) {
        return true;
    }
    for &(i, _) in &ratios {
        let Some(text) = Alignment::of(&rates[i], &slopes[i], period).and_then(|found| found.words(period)) else { continue };
        let (name, column) = (name_of(arm, i), format!("dq_{}", name_of(arm, i)));
        let help = "look at the unit and the filter of the rate; without the `dq_` columns rates come from positions";
        let text = format!("{column} {text} the derivative of q_{name}");
        let finding = Finding::new(Code::RateMismatch, &log.name, text, help).at(first, 0).in_column(column);
        // Drives filter their rates: most estimates bear it.
        findings.push(finding.as_bad_as(Severity::Warning));
    }
    false
}

fn name_of(arm: &Arm, i: usize) -> &str {
    &arm.joints[i].name
}

/// Positions, and rates that agree with them, far beyond the limits of the description, and within them in degrees.
fn degrees_throughout(arm: &Arm, log: &Log, findings: &mut Findings) -> bool {
    let degree = 1f64.to_radians();
    let turning: Vec<usize> = (0..arm.dof()).filter(|&i| !arm.joints[i].slides).collect();
    let moving: Vec<usize> = turning.iter().copied().filter(|&i| range(&log.q[i]).1 - range(&log.q[i]).0 > STILL).collect();
    let fastest = |i: usize| log.dq.as_ref().map_or(0.0, |dq| dq[i].iter().fold(0.0f64, |a, x| a.max(x.abs())));
    // How many times a limit a joint reaches: of its position, or of its rate.
    let reach = |i: usize, scale: f64| -> Option<f64> {
        let (joint, (least, most)) = (&arm.joints[i], range(&log.q[i]));
        let of_position = joint.position.map(|[low, high]| {
            let (middle, half) = (0.5 * (low + high), (0.5 * (high - low)).max(1e-9));
            (scale * least - middle).abs().max((scale * most - middle).abs()) / half
        });
        let of_rate = joint.velocity.is_finite().then(|| scale * fastest(i) / joint.velocity);
        [of_position, of_rate].into_iter().flatten().reduce(f64::max)
    };
    let most = |scale: f64| moving.iter().filter_map(|&i| reach(i, scale)).reduce(f64::max);
    let turns = |&i: &usize| range(&log.q[i]).1 - range(&log.q[i]).0 > 4.0 * std::f64::consts::PI;
    let suspected = match (most(1.0), most(degree)) {
        // Limits tell: between the units lies a factor of 57.
        (Some(plain), Some(converted)) => plain > 3.0 && converted < 1.1,
        _ => !moving.is_empty() && moving.iter().all(turns),
    };
    if !suspected {
        return false;
    }
    let worst = moving.iter().copied().max_by(|&a, &b| {
        let size = |i: usize| reach(i, 1.0).unwrap_or(range(&log.q[i]).1 - range(&log.q[i]).0);
        size(a).total_cmp(&size(b))
    });
    let Some(i) = worst else { return false };
    let (least, most) = range(&log.q[i]);
    let of_limits = reach(i, 1.0).map_or_else(String::new, |reach| format!(", {reach:.0} times as far as its limits"));
    let text = format!("q of joint `{}` ranges from {least} to {most}{of_limits}", name_of(arm, i));
    let help = "angles are in radians: with degrees write `units: {angle: deg}` into the options";
    let finding = Finding::new(Code::DegreesSuspected, &log.name, text, help).at(log.lines[0] as usize, 0);
    findings.push(finding.in_column(format!("q_{}", name_of(arm, i))));
    true
}

/// Positions that jump between two samples: by turns of an encoder, or faster than the joint can move. Whether there are such steps.
pub(super) fn steps(arm: &Arm, log: &Log, period: f64, findings: &mut Findings) -> bool {
    let turn = std::f64::consts::TAU;
    let mut found = false;
    for (i, q) in log.q.iter().enumerate() {
        let joint = &arm.joints[i];
        let slope = |k: usize| (q[k] - q[k - 1]) / (log.t[k] - log.t[k - 1]);
        for k in 2..q.len().saturating_sub(1) {
            let gap = log.t[k] - log.t[k - 1];
            if gap > LONGEST_GAP * period {
                continue;
            }
            // What the neighbours do not do.
            let step = q[k] - q[k - 1] - 0.5 * gap * (slope(k - 1) + slope(k + 1));
            let turns = (step / turn).round();
            let wraps = !joint.slides && turns != 0.0 && (step - turns * turn).abs() < 0.05 * turn;
            // A position that is held for some samples moves for as long in one step; stamps may jitter.
            let held = (0..k - 1).rev().find(|&before| q[before] != q[k - 1]).map_or(k - 1, |before| before + 1);
            let reach = joint.velocity * (log.t[k] - log.t[held]).max(period);
            let too_fast = (q[k] - q[k - 1]).abs() > 2.0 * reach && step.abs() > reach;
            if !wraps && !too_fast {
                continue;
            }
            let column = format!("q_{}", joint.name);
            let (text, help) = if wraps {
                let text = format!("{column} steps by {:.4} rad in {gap:.6} s: the encoder wraps", q[k] - q[k - 1]);
                (text, "add or subtract the turns from here on, so that the position has no step (`numpy.unwrap`)")
            } else {
                let unit = if joint.slides { "m" } else { "rad" };
                let text = format!(
                    "{column} steps by {:.4} {unit} in {gap:.6} s, and the highest rate of the joint is {} {unit}/s",
                    q[k] - q[k - 1],
                    joint.velocity
                );
                (text, "look at the encoder and the recorder; leave the samples out, or cut the log there")
            };
            let finding = Finding::new(Code::RateMismatch, &log.name, text, help).at(log.lines[k] as usize, 0).in_column(column);
            // A wrap is certain; another step may be that of the stamps.
            findings.push(finding.as_bad_as(if wraps { Severity::Error } else { Severity::Warning }));
            found |= wraps;
        }
    }
    found
}

/// A rate against a slope: the lag that they fit best at, s, and the slopes of both regressions there, each with its standard error.
struct Alignment {
    lag: [f64; 2],
    slopes: [[f64; 2]; 2],
}

/// Lags that are tried, s.
const LAGS: [f64; 2] = [-0.1, 0.25];

/// A block of time of the standard errors, s.
const BLOCK: f64 = 1.0;

impl Alignment {
    fn of(rate: &[f64], slope: &[f64], period: f64) -> Option<Alignment> {
        let [first, last] = LAGS.map(|lag| (lag / period).round() as isize);
        let margin = usize::try_from(last.max(-first)).ok()? + 2;
        let inside = margin..slope.len().checked_sub(margin)?;
        if inside.len() < 20 {
            return None;
        }
        let later = |by: f64| shifted(slope, inside.clone(), -by);
        let own = &rate[inside.clone()];
        let fit = |by: f64| {
            let (ab, bb) = own.iter().zip(later(by)).fold((0.0, 0.0), |(ab, bb), (a, b)| (ab + a * b, bb + b * b));
            ab / f64::max(bb, 1e-300).sqrt()
        };
        let fits: Vec<f64> = (first..=last).map(|by| fit(by as f64)).collect();
        let best = (0..fits.len()).max_by(|&a, &b| fits[a].total_cmp(&fits[b]))?;
        let mut by = (first + best as isize) as f64;
        if best > 0 && best + 1 < fits.len() {
            let bend = fits[best - 1] - 2.0 * fits[best] + fits[best + 1];
            by += if bend < 0.0 { 0.5 * (fits[best - 1] - fits[best + 1]) / bend } else { 0.0 };
        }
        let model = later(by);
        let bent = derivative(&model, period);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (ab, bb, aa) = (dot(own, &model), dot(&model, &model), dot(own, own));
        let length = ((BLOCK / period).ceil() as usize).max(1);
        // The error of sum(e x)/norm, from blocks of time.
        let error = |slope: f64, x: &[f64], norm: f64| {
            let scores = (0..own.len()).map(|k| (own[k] - slope * model[k]) * x[k]).collect::<Vec<_>>();
            let squares: f64 = scores.chunks(length).map(|block| block.iter().sum::<f64>().powi(2)).sum();
            squares.sqrt() / norm
        };
        let (direct, reverse) = (ab / bb, aa / ab);
        let lag = [by * period, error(direct, &bent, direct * dot(&bent, &bent))];
        Some(Alignment { lag, slopes: [[direct, error(direct, &model, bb)], [reverse, error(reverse, own, ab)]] })
    }

    /// What a rate is of the derivative, where that is not the same.
    fn words(&self, period: f64) -> Option<String> {
        let [[direct, of_direct], [reverse, of_reverse]] = self.slopes;
        // Noise of positions lowers the one, noise of rates raises the other: the truth lies between them.
        let (low, high) = (
            (direct - 3.0 * of_direct).min(reverse - 3.0 * of_reverse),
            (direct + 3.0 * of_direct).max(reverse + 3.0 * of_reverse),
        );
        let off = if low > 1.0 { low - 1.0 } else { (1.0 - high).max(0.0) };
        let late = self.lag[0].abs() - 3.0 * self.lag[1];
        let slope = (off > SLOPE).then(|| format!("is {:.3} times", 0.5 * (direct + reverse)));
        let lag = (late > period)
            .then(|| format!("comes {:.1} ms {}", 1e3 * self.lag[0].abs(), if self.lag[0] > 0.0 { "behind" } else { "before" }));
        match (slope, lag) {
            (Some(slope), Some(lag)) => Some(format!("{lag}, and {slope}")),
            (slope, lag) => slope.or(lag),
        }
    }
}

/// A difference of a slope from 1 that rates and positions of a drive have at most.
const SLOPE: f64 = 0.02;
