//! From logs and a description to an identified arm.

mod locked;
mod reduced;
mod shown;

use std::ops::Range;

use armgen_codegen::document::excerpt;
use armgen_codegen::suggest::did_you_mean;
use nalgebra::{DMatrix, DVector};

use crate::arm::Arm;
use crate::estimate::{Column, Estimate, Run};
use crate::finding::{Code, Finding, Findings};
use crate::fit::FEW_BLOCKS;
use crate::judge::{judge, Judgement, Model};
use crate::log::Log;
use crate::options::{Gains, Load, Options};
use crate::prepare::{prepare, Friction, Piece};
use crate::signal::{nearest, period, LowPass};
use crate::suspect;

use reduced::reduce;
pub use reduced::Reduced;
use shown::{column_name, inseparable, unshown};

/// A log with what the options say of it.
#[derive(Clone, Debug, Default)]
pub struct Input {
    /// The log.
    pub log: Log,
    /// Logs of one session share friction.
    pub session: String,
    /// Its load.
    pub load: Load,
}

/// A value with its interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub sigma: f64,
    /// The lower end of three sigma, of Student's t where there are few blocks.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// Whether the logs show it.
    pub excited: bool,
}

/// A term of friction of a joint.
#[derive(Clone, Copy, Debug)]
pub struct FrictionValue {
    /// The session, by its place.
    pub session: usize,
    /// The joint.
    pub joint: usize,
    /// The term.
    pub term: Friction,
    /// Its value.
    pub value: Interval,
}

/// An identified arm.
#[derive(Clone, Debug, Default)]
pub struct Identified {
    /// Base parameters.
    pub base: Vec<Interval>,
    /// Friction of all sessions.
    pub friction: Vec<FrictionValue>,
    /// Velocities of Stribeck friction.
    pub velocities: Vec<f64>,
    /// Names of the sessions.
    pub sessions: Vec<String>,
    /// Drive gains, by joint, where logs hold currents. Not excited: kept.
    pub gains: Vec<Interval>,
    /// The ten of the load of each log that has one.
    pub loads: Vec<(usize, Vec<Option<Interval>>)>,
    /// Of torques behind positions, s, by joint. Not excited: the logs do not determine it, and it is 0. Without a standard error: given.
    pub delays: Vec<Interval>,
    /// Hz.
    pub cutoff: f64,
    /// Hz, of the first log.
    pub rate: f64,
    /// Samples that rows were made of.
    pub used: usize,
    /// The condition of the scaled equations.
    pub condition: f64,
    /// Mean logarithm of the eigenvalues.
    pub log_det_per_parameter: f64,
    /// Directions that the logs do not show: names, and the direction in words.
    pub unexcited: Vec<(Vec<String>, String)>,
    /// Terms of friction that no motion tells from other parameters, in words.
    pub inseparable: Vec<String>,
    /// Robust spread of residuals, by joint.
    pub spreads: Vec<f64>,
    /// Covariance of the base parameters.
    pub covariance: DMatrix<f64>,
    /// Blocks of time that it rests on.
    pub blocks: usize,
    /// Reduced data over base parameters and the friction of the last session.
    pub reduced: Reduced,
    /// Friction that options give: joint, term, value.
    pub held: Vec<(usize, Friction, f64)>,
    /// Each log against the model.
    pub judgements: Vec<Judgement>,
}

/// Blocks of time that last longer have residuals that no noise of a drive has, s.
const COLOURED: f64 = 2.0;

/// Identifies an arm. Nothing is returned where the findings hold errors.
pub fn identify(arm: &Arm, inputs: &[Input], options: &Options, findings: &mut Findings) -> Option<Identified> {
    let n = arm.dof();
    fitting(arm, &inputs[0].log.name, options, findings);
    let is_locked = |j: &usize| options.without.contains(&arm.joints[*j].name);
    let locked: Vec<usize> = (0..n).filter(is_locked).collect();
    let mut logs: Vec<Log> = inputs.iter().map(|input| input.log.clone()).collect();
    let mut flawed: Vec<Vec<Vec<Range<f64>>>> = Vec::new();
    for log in &mut logs {
        locked::hold(arm, &locked, log, findings);
        let mut of_joints = suspect::signals(arm, log, &locked, findings);
        // The torque of a lock is a reaction.
        locked.iter().for_each(|&j| of_joints[j] = vec![f64::NEG_INFINITY..f64::INFINITY]);
        flawed.push(of_joints);
    }
    let has_currents = inputs.iter().any(|input| input.log.is_current);
    let gains = start_gains(arm, inputs, options, has_currents, findings);
    if findings.has_errors() {
        return None;
    }
    for log in logs.iter_mut().filter(|log| log.is_current) {
        for (column, gain) in log.effort.iter_mut().zip(&gains) {
            column.iter_mut().for_each(|x| *x *= gain);
        }
    }
    let mut sessions: Vec<String> = Vec::new();
    let runs: Vec<Run> = inputs
        .iter()
        .map(|input| {
            let session = sessions.iter().position(|known| *known == input.session).unwrap_or_else(|| {
                sessions.push(input.session.clone());
                sessions.len() - 1
            });
            Run { session, load: input.load.clone(), is_current: input.log.is_current }
        })
        .collect();
    let rate = 1.0 / period(&logs[0].t);
    let slowest = logs.iter().map(|log| 1.0 / period(&log.t)).fold(f64::INFINITY, f64::min);
    let highest = (0.1 * slowest).max(3.0f64.min(0.2 * slowest));
    let all = |cutoff: f64| -> Vec<Piece> {
        logs.iter().enumerate().flat_map(|(place, log)| prepare(arm, place, log, cutoff, &flawed[place], true)).collect()
    };
    let mut cutoff = options.cutoff.unwrap_or(highest);
    let mut pieces = all(cutoff);
    if pieces.is_empty() {
        let text = format!("no stretch of the logs is longer than {:.1} s", 8.0 / cutoff);
        let help = "log at least 10 s without a gap";
        findings.push(Finding::new(Code::NoMotion, &logs[0].name, text, help));
        return None;
    }
    let simple = |_: usize, term: Friction| matches!(term, Friction::Viscous | Friction::Coulomb | Friction::Offset);
    if options.cutoff.is_none() {
        let mut first = Estimate::new(arm, &pieces, &runs, sessions.len());
        fix(arm, options, &mut first);
        first.activate(&simple);
        let (equations, _) = first.equations(None);
        first.fit(&equations);
        let chosen = cutoff_of(&first, highest);
        if chosen < cutoff {
            cutoff = chosen;
            pieces = all(cutoff);
        }
    }
    let along_reference: Option<Vec<Piece>> = options.instruments.then(|| {
        let along = |log: &Log| {
            let reference = log.reference.iter().flatten().zip(&log.q);
            // Drives follow late: a sign that changes early is no instrument.
            Log { q: reference.map(|(reference, q)| nearest(&log.t, reference, q)).collect(), dq: None, ..log.clone() }
        };
        let logs = logs.iter().map(along).enumerate();
        logs.flat_map(|(place, log)| prepare(arm, place, &log, cutoff, &flawed[place], true)).collect()
    });
    let mut estimate = Estimate::new(arm, &pieces, &runs, sessions.len());
    fix(arm, options, &mut estimate);
    estimate.activate(&simple);
    let unknowns = estimate.active.len();
    let moving: usize = pieces.iter().map(|piece| piece.counts.iter().filter(|counts| **counts).count()).sum();
    if moving < 5 * unknowns {
        let text = format!("{moving} rows of joints in motion, and {unknowns} unknowns");
        let help = "move all joints, longer or faster: `armgen excite` plans such a motion";
        findings.push(Finding::new(Code::NoMotion, &logs[0].name, text, help));
        return None;
    }
    let (equations, _) = estimate.equations(None);
    estimate.fit(&equations);
    if suspect::torques(&estimate, &inputs[0].log, &gains, findings) {
        return None;
    }
    if let Some(given) = &options.delay {
        estimate.delays = (0..n).map(|j| given.get(j).or(given.first()).copied().unwrap_or(0.0)).collect();
    } else {
        estimate.seek_delays();
    }
    let wanted = options.friction.clone().unwrap_or_else(|| vec![Friction::Viscous, Friction::Coulomb, Friction::Offset]);
    let mut chosen: Vec<Vec<Friction>> = vec![wanted; n];
    let activate = |estimate: &mut Estimate<'_>, chosen: &[Vec<Friction>]| {
        estimate.activate(&|joint, term| chosen[joint].contains(&term));
        let (equations, _) = estimate.equations(None);
        estimate.fit(&equations);
    };
    activate(&mut estimate, &chosen);
    for round in 0..3 {
        estimate.renew_sizes();
        if round == 0 && options.friction.is_none() {
            estimate.choose(&mut chosen, Friction::Load);
        }
        activate(&mut estimate, &chosen);
    }
    if options.friction.is_none() {
        // Cubic friction alone takes a part of Stribeck friction, so it comes last.
        let inside = estimate.stribeck_velocities(&|_| true);
        let mut with = chosen.clone();
        estimate.choose(&mut with, Friction::Stribeck);
        (0..n).filter(|&j| inside[j]).for_each(|j| chosen[j].clone_from(&with[j]));
        activate(&mut estimate, &chosen);
        for _ in 0..2 {
            estimate.stribeck_velocities(&|j| chosen[j].contains(&Friction::Stribeck));
            activate(&mut estimate, &chosen);
        }
        estimate.choose(&mut chosen, Friction::Cubic);
        activate(&mut estimate, &chosen);
        // Where the others were missing, they may have hidden it.
        estimate.renew_sizes();
        estimate.choose(&mut chosen, Friction::Load);
        activate(&mut estimate, &chosen);
        estimate.renew_sizes();
        activate(&mut estimate, &chosen);
        estimate.prune(&mut chosen, &[Friction::Load, Friction::Cubic, Friction::Stribeck]);
        activate(&mut estimate, &chosen);
    }
    estimate.along_reference = along_reference.as_deref();
    let mut of_delays = vec![None; n];
    if options.delay.is_none() {
        of_delays = estimate.settle(true);
        if estimate.leave_undetermined_delays(&of_delays) {
            of_delays = estimate.settle(false);
        }
        // Delays that were nearly right may have hidden terms.
        let before = chosen.clone();
        if options.friction.is_none() && !options.instruments {
            estimate.choose(&mut chosen, Friction::Cubic);
            estimate.choose(&mut chosen, Friction::Load);
        }
        if chosen != before {
            activate(&mut estimate, &chosen);
            estimate.renew_sizes();
            activate(&mut estimate, &chosen);
            estimate.prune(&mut chosen, &[Friction::Load, Friction::Cubic, Friction::Stribeck]);
            activate(&mut estimate, &chosen);
            of_delays = estimate.settle(false);
        }
        for (j, delay) in estimate.delays.iter().enumerate().filter(|(_, delay)| Estimate::is_last_delay(**delay)) {
            let text = format!("the delay of joint `{}`, {:.1} ms, is at the end of its range", arm.joints[j].name, 1e3 * delay);
            let help = "bring the stamps of torques and positions together, or give `delay` in the options; noise of positions leads here, too: log rates (`dq_JOINT`)";
            let column = inputs[0].log.effort_column(&arm.joints[j].name);
            findings.push(Finding::new(Code::DelayAtLimit, &inputs[0].log.name, text, help).in_column(column));
        }
    }
    if !findings.iter().any(|of| matches!(of.code, Code::SignSuspected | Code::JointOrder)) {
        suspect::again(&estimate, &inputs[0].log, &gains, findings);
    }
    let identify_gains = has_currents && options.gains == Gains::Identify;
    let mut gain_intervals: Vec<Interval> = Vec::new();
    let mut of_gains = None;
    if identify_gains {
        let mut held = vec![false; n];
        loop {
            activate(&mut estimate, &chosen);
            let mut trial = estimate.clone();
            let (corrections, sigmas, matrix, reach) = trial.gains(&held);
            // Load friction takes |g| of the corrected torques.
            trial.renew_sizes();
            let (corrections, sigmas, matrix, reach) = if chosen.iter().any(|terms| terms.contains(&Friction::Load)) {
                trial.gains(&held)
            } else {
                (corrections, sigmas, matrix, reach)
            };
            let worst = (0..n)
                .filter(|&j| !held[j] && (reach * sigmas[j] > 0.5 * corrections[j] || !corrections[j].is_finite()))
                .max_by(|&a, &b| (sigmas[a] / corrections[a]).total_cmp(&(sigmas[b] / corrections[b])));
            if let Some(j) = worst {
                held[j] = true;
                continue;
            }
            gain_intervals = (0..n)
                .map(|j| {
                    let (value, sigma) = (gains[j] * corrections[j], gains[j] * sigmas[j]);
                    Interval { value, sigma, low: value - reach * sigma, high: value + reach * sigma, excited: !held[j] }
                })
                .collect();
            of_gains = Some((trial.active.clone(), matrix, reach, trial.x.clone()));
            estimate = trial;
            break;
        }
    } else if has_currents {
        gain_intervals =
            gains.iter().map(|gain| Interval { value: *gain, sigma: 0.0, low: *gain, high: *gain, excited: false }).collect();
    }
    let x_of_gains = of_gains.as_ref().map(|(.., x)| x.clone());
    let (equations, solution, covariance) = estimate.finish();
    let (matrix, reach) = match of_gains {
        Some((_, matrix, reach, _)) => (matrix, reach),
        None => (covariance.matrix.clone(), covariance.reach),
    };
    if let Some(x) = x_of_gains {
        // The estimate whose intervals these are.
        estimate.x = x;
    }
    if (covariance.blocks as f64) < FEW_BLOCKS {
        let text = format!("{} independent stretches of time: intervals use Student's t", covariance.blocks);
        let (text, help) = if covariance.length > COLOURED {
            let text = format!("{text}; residuals are correlated over {:.1} s", covariance.length / 5.0);
            (text, "the model or the log is wrong there, and a longer log does not mend it: look at the residuals of each joint, `--report`")
        } else {
            (text, "log 30 s or more for narrow intervals")
        };
        findings.push(Finding::new(Code::ShortLog, &logs[0].name, text, help));
    }
    // A term of friction that was left out may be there, too small to be seen: the intervals of all others allow for it.
    let wider = (options.friction.is_none() && !identify_gains).then(|| {
        let mut wider = estimate.clone();
        wider.activate(&|joint, term| chosen[joint].contains(&term) || matches!(term, Friction::Load | Friction::Cubic));
        let (.., covariance) = wider.finish();
        (wider, covariance)
    });
    let interval = |k: usize| {
        let place = estimate.active[k];
        let value = estimate.x[place];
        let around = |middle: f64, matrix: &DMatrix<f64>, k: usize, reach: f64| {
            let sigma = matrix[(k, k)].max(0.0).sqrt();
            Interval { value, sigma, low: middle - reach * sigma, high: middle + reach * sigma, excited: true }
        };
        let own = around(value, &matrix, k, reach);
        match wider.as_ref().and_then(|(wider, of)| Some((wider, of, wider.active.binary_search(&place).ok()?))) {
            Some((wider, of, k)) => {
                let wide = around(wider.x[place], &of.matrix, k, of.reach);
                Interval { low: wide.low.min(own.low), high: wide.high.max(own.high), ..wide }
            }
            None => own,
        }
    };
    if !options.instruments && !identify_gains {
        let moved = estimate.moved_by_half_the_cutoff(&equations, &solution, cutoff, &|k, x| {
            let Interval { low, high, .. } = interval(k);
            x < low || x > high
        });
        if !moved.is_empty() {
            let names: Vec<String> = moved.iter().take(3).map(|&k| column_name(&estimate, k)).collect();
            let text = format!(
                "{} of {} estimates leave their intervals at half the cutoff: {}",
                moved.len(),
                estimate.active.len(),
                names.join(", ")
            );
            let help = "noise of the positions biases them, or terms that the model lacks: log rates (`dq_JOINT`), or the reference of the drives (`qr_JOINT`) for `--instruments`, or choose a lower `cutoff`";
            findings.push(Finding::new(Code::BiasedRegressor, &logs[0].name, text, help));
        }
    }
    let unshown = unshown(&estimate, &solution, &matrix, !locked.is_empty());
    let hidden = &unshown.hidden;
    let kept = (!unshown.of_locked.is_empty()).then(|| {
        let names: Vec<&str> = unshown.of_locked.iter().map(String::as_str).collect();
        format!(
            "without {}, the logs do not show {} in full: they keep of the file what is missing",
            options.without.join(", "),
            names.join(", ")
        )
    });
    let mut found = Identified {
        velocities: estimate.velocities.clone(),
        sessions,
        gains: gain_intervals,
        cutoff,
        rate,
        used: pieces.iter().map(|piece| piece.kept.len()).sum(),
        condition: solution.condition,
        log_det_per_parameter: solution.log_det_per_column,
        unexcited: unshown.directions,
        inseparable: inseparable(arm, options).into_iter().chain(kept).collect(),
        spreads: (0..n).map(|j| if locked.contains(&j) { f64::INFINITY } else { estimate.spreads[j] }).collect(),
        blocks: covariance.blocks,
        ..Identified::default()
    };
    let of_base: Vec<usize> =
        (0..estimate.active.len()).filter(|&k| matches!(estimate.columns[estimate.active[k]], Column::Base(_))).collect();
    found.base = of_base.iter().map(|&k| Interval { excited: !hidden[k], ..interval(k) }).collect();
    found.covariance = DMatrix::from_fn(of_base.len(), of_base.len(), |a, b| matrix[(of_base[a], of_base[b])]);
    for (k, &place) in estimate.active.iter().enumerate() {
        if let Column::Friction(session, joint, term) = estimate.columns[place] {
            found.friction.push(FrictionValue { session, joint, term, value: Interval { excited: !hidden[k], ..interval(k) } });
        }
    }
    let delay = |j: usize| {
        let (value, [sigma, half]) = (estimate.delays[j], of_delays[j].unwrap_or_default());
        let excited = options.delay.is_some() || of_delays[j].is_some();
        Interval { value, sigma, low: value - half, high: value + half, excited }
    };
    found.delays = (0..n).map(delay).collect();
    for (log, _) in runs.iter().enumerate().filter(|(_, run)| run.load.is_there) {
        let known = estimate.known_load(log);
        let ten = (0..10)
            .map(|k| {
                let place = estimate.place(Column::Load(log, k));
                match estimate.active.iter().position(|active| *active == place) {
                    Some(k) => Some(interval(k)),
                    None if known[k] != 0.0 => {
                        Some(Interval { value: known[k], low: known[k], high: known[k], ..Interval::default() })
                    }
                    None => None,
                }
            })
            .collect();
        found.loads.push((log, ten));
    }
    found.reduced = reduce(&estimate, &equations, found.sessions.len() - 1, &matrix, reach);
    for &(place, value) in &estimate.fixed {
        if let Column::Friction(session, joint, term) = estimate.columns[place] {
            if session + 1 == found.sessions.len() {
                found.held.push((joint, term, value));
            }
        }
    }
    if !identify_gains {
        loads(&estimate, &chosen, inputs, findings);
    }
    // The correction of gains applies to the torques that the model is judged by.
    for log in logs.iter_mut().filter(|log| log.is_current) {
        for (column, correction) in log.effort.iter_mut().zip(&estimate.corrections) {
            column.iter_mut().for_each(|x| *x *= correction);
        }
    }
    for (place, log) in logs.iter().enumerate() {
        let model = model_of(arm, &estimate, place, &found);
        found.judgements.push(judge(arm, log, &model));
    }
    for (input, judgement) in inputs.iter().zip(&found.judgements) {
        poor_fits(arm, &input.log, judgement, findings);
    }
    Some(found)
}

/// A mass that is given and fits better with another value is off by this part of it at least.
const OTHER_MASS: f64 = 0.02;

/// Known masses of loads against those that the logs show, where a log without this load does.
fn loads(estimate: &Estimate<'_>, chosen: &[Vec<Friction>], inputs: &[Input], findings: &mut Findings) {
    for (log, run) in estimate.runs.iter().enumerate() {
        let Some(mass) = run.load.mass else { continue };
        let mut runs = estimate.runs.to_vec();
        runs[log].load = Load { is_there: true, ..Load::default() };
        let mut free = Estimate { runs: &runs, ..estimate.clone() };
        free.activate(&|joint, term| chosen[joint].contains(&term));
        let (_, solution, covariance) = free.finish();
        let Ok(k) = free.active.binary_search(&free.place(Column::Load(log, 0))) else { continue };
        let is_hidden = solution.hidden.iter().any(|direction| direction[k].abs() > 1e-3);
        let (found, sigma) = (solution.x[k], covariance.matrix[(k, k)].max(0.0).sqrt());
        let reach = covariance.reach * sigma;
        if is_hidden || (found - mass).abs() < reach.max(OTHER_MASS * mass) {
            continue;
        }
        let text = format!("the load of {mass} kg fits better with {:.3} to {:.3} kg", found - reach, found + reach);
        let help = "look at `load` in the options, or at `--load`: a wrong mass changes the numbers of the arm";
        findings.push(Finding::new(Code::LoadSuspected, &inputs[log].log.name, text, help));
    }
}

/// The model that an estimate is, for one of its logs.
fn model_of(arm: &Arm, estimate: &Estimate<'_>, log: usize, found: &Identified) -> Model {
    let mut pi = DVector::from_vec(estimate.pi());
    if estimate.runs[log].load.is_there {
        let mut ten = DVector::from_row_slice(&estimate.known_load(log));
        for k in 0..10 {
            ten[k] += estimate.x[estimate.place(Column::Load(log, k))];
        }
        pi += &arm.load * ten;
    }
    let session = estimate.runs[log].session;
    let friction = (0..arm.dof())
        .map(|j| Friction::ALL.map(|term| estimate.x[estimate.place(Column::Friction(session, j, term))]))
        .collect();
    Model {
        pi: pi.as_slice().to_vec(),
        friction,
        velocities: found.velocities.clone(),
        delays: Some(found.delays.iter().map(|delay| delay.value).collect()),
        spreads: None,
        covariance: None,
    }
}

/// Gains that currents become torques by.
fn start_gains(arm: &Arm, inputs: &[Input], options: &Options, has_currents: bool, findings: &mut Findings) -> Vec<f64> {
    let n = arm.dof();
    let name = inputs.iter().find(|input| input.log.is_current).map_or("", |input| input.log.name.as_str());
    if !has_currents {
        return vec![1.0; n];
    }
    match &options.gains {
        Gains::Given(gains) if gains.len() == n => return gains.clone(),
        Gains::Given(gains) => {
            let text = format!("`gains` has {} numbers, and the arm {n} joints", gains.len());
            findings.push(Finding::new(Code::NoGain, name, text, "give one gain for each joint, N m/A or N/A"));
        }
        Gains::File => {
            for joint in arm.joints.iter().filter(|joint| joint.gain.is_none()) {
                let text = format!("the log holds currents, and the motor of joint `{}` has no gain", joint.name);
                let help = "give `gain: ...` (N m/A) under `motor`, or log a known load besides and write `gains: identify`";
                findings.push(Finding::new(Code::NoGain, name, text, help).in_column(format!("current_{}", joint.name)));
            }
        }
        Gains::Identify => {
            if options.instruments {
                let help = "give the gains, or leave `instruments` out";
                findings.push(Finding::new(
                    Code::BadOptions,
                    name,
                    "`instruments` and `gains: identify` exclude each other",
                    help,
                ));
            }
            if !inputs.iter().any(|input| input.load.mass.is_some()) {
                let text = "currents alone determine ratios of gains and masses, and no gain";
                let help =
                    "log a motion with a known mass at the end effector, and give it: `load: {mass: 2.5}`, or `--load 2.5`";
                findings.push(Finding::new(Code::GainScale, name, text, help));
            }
        }
    }
    arm.joints.iter().map(|joint| joint.gain.unwrap_or(10.0)).collect()
}

/// Options that name what the arm does not have.
fn fitting(arm: &Arm, log: &str, options: &Options, findings: &mut Findings) {
    let n = arm.dof();
    let names: Vec<String> =
        arm.joints.iter().flat_map(|joint| Friction::ALL.map(|term| format!("{}.friction.{}", joint.name, term.key()))).collect();
    let known: Vec<&str> = names.iter().map(String::as_str).collect();
    for name in options.keep.iter().chain(options.fixed.iter().map(|(name, _)| name)).filter(|name| !names.contains(name)) {
        let meant = did_you_mean(name, &known).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        let text = format!("`{}` is no entry that can be kept or fixed", excerpt(name));
        let help = format!("{meant}entries are terms of friction: JOINT.friction.KEY");
        findings.push(Finding::new(Code::BadOptions, log, text, help));
    }
    let joints: Vec<&str> = arm.joints.iter().map(|joint| joint.name.as_str()).collect();
    for name in options.without.iter().filter(|name| !joints.contains(&name.as_str())) {
        let meant = did_you_mean(name, &joints).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        let text = format!("`without` has `{}`, and the arm no such joint", excerpt(name));
        findings.push(Finding::new(Code::BadOptions, log, text, format!("{meant}joints: {}", joints.join(", "))));
    }
    if let Some(given) = options.delay.as_ref().filter(|given| given.len() != 1 && given.len() != n) {
        let text = format!("`delay` has {} numbers, and the arm {n} joints", given.len());
        findings.push(Finding::new(Code::BadOptions, log, text, "give one delay for all joints, or one for each, ms"));
    }
}

/// Columns with given values: options, and terms that no motion tells from others.
fn fix(arm: &Arm, options: &Options, estimate: &mut Estimate<'_>) {
    for (j, joint) in arm.joints.iter().enumerate() {
        for (place, term) in Friction::ALL.into_iter().enumerate() {
            let name = format!("{}.friction.{}", joint.name, term.key());
            let given = options.fixed.iter().find(|(fixed, _)| *fixed == name).map(|(_, value)| *value);
            let kept = options.keep.contains(&name).then(|| joint.friction[place].unwrap_or(0.0));
            let dependent = arm.dependent.iter().any(|of| (of.joint, of.term) == (j, place));
            let is_left = dependent || options.without.contains(&joint.name);
            let of_file = is_left.then(|| joint.friction[place].unwrap_or(0.0));
            if let Some(value) = given.or(kept).or(of_file) {
                for session in 0..estimate.sessions {
                    let place = estimate.place(Column::Friction(session, j, term));
                    estimate.fixed.push((place, value));
                }
            }
        }
    }
}

/// The lowest cutoff that keeps 99.9 % of the energy of the model's torque about its mean, from 3 Hz on.
fn cutoff_of(estimate: &Estimate<'_>, highest: f64) -> f64 {
    let arm = estimate.arm;
    let n = arm.dof();
    let pi = estimate.pi();
    let mut signals: Vec<(f64, Vec<f64>)> = Vec::new();
    for piece in estimate.pieces {
        let torque = arm.torque(&piece.q, &piece.dq, &piece.ddq, &pi);
        let session = estimate.runs[piece.log].session;
        for j in 0..n {
            let friction: Vec<(Friction, f64)> = Friction::ALL
                .iter()
                .map(|&term| (term, estimate.x[estimate.place(Column::Friction(session, j, term))]))
                .collect();
            let signal: Vec<f64> = torque
                .iter()
                .enumerate()
                .skip(j)
                .step_by(n)
                .map(|(k, tau)| {
                    let of =
                        |&(term, value): &(Friction, f64)| value * term.column(piece.dq[k], piece.sign(j, piece.dq[k]), 0.0, 1.0);
                    tau + friction.iter().map(of).sum::<f64>()
                })
                .collect();
            let mean = signal.iter().sum::<f64>() / signal.len() as f64;
            signals.push((1.0 / piece.period, signal.into_iter().map(|x| x - mean).collect()));
        }
    }
    let mut cutoff = 3.0f64.min(highest);
    while cutoff < highest {
        let lost: f64 = signals
            .iter()
            .map(|(rate, signal)| {
                let passed = LowPass::new(cutoff, *rate).both_ways(signal);
                let energy: f64 = signal.iter().map(|x| x * x).sum();
                signal.iter().zip(&passed).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / energy.max(1e-300)
            })
            .sum::<f64>()
            / signals.len() as f64;
        if lost < 1e-3 {
            break;
        }
        cutoff += 0.5;
    }
    cutoff.min(highest)
}

/// Joints that a model explains badly.
pub fn poor_fits(arm: &Arm, log: &Log, judgement: &Judgement, findings: &mut Findings) {
    for (j, relative) in judgement.moving.iter().enumerate().filter(|(_, relative)| **relative > 0.3) {
        let name = &arm.joints[j].name;
        let text = format!("the model leaves {:.0} % of the torque of joint `{name}`", 100.0 * relative);
        let help =
            "look at the direction of gravity, at `base`, at a load that the options do not name, and at the unit of torque";
        findings.push(Finding::new(Code::PoorFit, &log.name, text, help).in_column(log.effort_column(name)));
    }
}
