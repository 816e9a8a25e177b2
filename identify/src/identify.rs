//! From logs and a description to an identified arm.

mod locked;
mod reduced;
mod shown;

use std::ops::Range;

use armgen_codegen::document::excerpt;
use armgen_codegen::suggest::did_you_mean;
use nalgebra::{DMatrix, DVector};

use crate::arm::Arm;
use crate::estimate::{Column, Estimate, From, Run};
use crate::finding::{Code, Finding, Findings};
use crate::fit::{Covariance, Equations, Solution, FEW_BLOCKS};
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

/// So many samples, those of half a minute at a cutoff of 10 Hz, tell terms of friction, and delays nearly.
const ENOUGH: usize = 1500;

/// Blocks of time that last longer have residuals that no noise of a drive has, s.
const COLOURED: f64 = 2.0;

/// Identifies an arm. Nothing is returned where the findings hold errors.
pub fn identify(arm: &Arm, inputs: &[Input], options: &Options, findings: &mut Findings) -> Option<Identified> {
    fitting(arm, &inputs[0].log.name, options, findings);
    let torques = Torques::new(arm, inputs, options, findings)?;
    let (cutoff, pieces) = torques.filtered(arm, options, findings)?;
    // By parts of long logs delays and terms of friction are found, by all of them their values.
    let every = (pieces.iter().map(|piece| piece.kept.len()).sum::<usize>() / ENOUGH).max(1);
    let parts = (every > 1).then(|| torques.pieces(arm, cutoff, every));
    let along_reference = |every| options.instruments.then(|| torques.along_reference(arm, cutoff, every));
    let [parts_along, along] = [parts.as_ref().and_then(|_| along_reference(every)), along_reference(1)];
    let mut estimate = torques.estimate(arm, parts.as_ref().unwrap_or(&pieces), options);
    if !enough_rows(&pieces, estimate.active.len(), &inputs[0].log.name, findings) {
        return None;
    }
    estimate.fit_active();
    if suspect::torques(&estimate, &inputs[0].log, &torques.gains, findings) {
        return None;
    }
    let with_gains = torques.is_of_currents && options.gains == Gains::Identify;
    if with_gains {
        // Beside torques that are off by a part, delays and terms of friction would be those of what is left.
        let simple = first_terms(&estimate, options);
        drive_gains(&mut estimate, &simple, &torques.gains);
    }
    match &options.delay {
        Some(given) => {
            estimate.delays = (0..arm.dof()).map(|j| given.get(j).or(given.first()).copied().unwrap_or(0.0)).collect();
        }
        None => estimate.seek_delays(),
    }
    let mut terms = chosen_terms(&mut estimate, options);
    estimate.along_reference = parts_along.as_deref().or(along.as_deref());
    let mut errors_of_delays = match options.delay {
        Some(_) => vec![None; arm.dof()],
        None => settled_delays(&mut estimate, &mut terms, options),
    };
    if !findings.iter().any(|of| matches!(of.code, Code::SignSuspected | Code::JointOrder)) {
        suspect::again(&estimate, &inputs[0].log, &torques.gains, findings);
    }
    if parts.is_some() {
        let of_parts = estimate;
        estimate = torques.estimate(arm, &pieces, options);
        estimate.along_reference = along.as_deref();
        estimate.begin_with(&of_parts);
        if options.delay.is_none() {
            errors_of_delays = settled(&mut estimate, From::Rows);
        }
    }
    if options.delay.is_none() {
        last_delays(&estimate, &inputs[0].log, findings);
    }
    let of_gains = with_gains.then(|| drive_gains(&mut estimate, &terms, &torques.gains));
    let (equations, solution, covariance) = estimate.finish();
    few_blocks(&covariance, &inputs[0].log.name, findings);
    let (gains, matrix, reach) = match of_gains {
        Some(of) => {
            // The estimate whose intervals these are.
            estimate.x = of.x;
            (of.gains, of.matrix, of.reach)
        }
        None => {
            let own = estimate.active.len();
            (torques.gains_as_given(), covariance.matrix.view((0, 0), (own, own)).into_owned(), covariance.reach)
        }
    };
    // A term of friction that was left out may be there, too small to be seen: the intervals of all others allow for it.
    let wider = (options.friction.is_none() && !with_gains).then(|| with_terms_left_out(&estimate, &terms));
    let intervals = intervals(&estimate, &matrix, reach, wider.as_ref());
    if !options.instruments && !with_gains {
        moved_by_half_the_cutoff(&estimate, &equations, &solution, cutoff, &intervals, &inputs[0].log.name, findings);
    }
    let unshown = unshown(&estimate, &solution, &matrix, !torques.locked.is_empty());
    let shown = |k: usize| Interval { excited: !unshown.hidden[k], ..intervals[k] };
    let of_base: Vec<usize> =
        (0..estimate.active.len()).filter(|&k| matches!(estimate.columns[estimate.active[k]], Column::Base(_))).collect();
    let last_session = torques.sessions.len() - 1;
    let mut found = Identified {
        base: of_base.iter().map(|&k| shown(k)).collect(),
        friction: of_friction(&estimate, shown),
        velocities: estimate.velocities.clone(),
        gains,
        loads: of_loads(&estimate, &intervals),
        delays: of_delays(&estimate, &errors_of_delays, options.delay.is_some()),
        cutoff,
        rate: 1.0 / period(&torques.logs[0].t),
        used: pieces.iter().map(|piece| piece.kept.len()).sum(),
        condition: solution.condition,
        log_det_per_parameter: solution.log_det_per_column,
        inseparable: inseparable(arm, options).into_iter().chain(unshown.kept(&options.without)).collect(),
        unexcited: unshown.directions,
        spreads: (0..arm.dof()).map(|j| if torques.locked.contains(&j) { f64::INFINITY } else { estimate.spreads[j] }).collect(),
        covariance: DMatrix::from_fn(of_base.len(), of_base.len(), |a, b| matrix[(of_base[a], of_base[b])]),
        blocks: covariance.blocks,
        reduced: reduce(&estimate, &equations, last_session, &matrix, reach),
        held: held(&estimate, last_session),
        sessions: torques.sessions.clone(),
        judgements: Vec::new(),
    };
    if !with_gains {
        loads(&estimate, &terms, inputs, findings);
    }
    let judged = |(place, log): (usize, &Log)| {
        // The correction of gains applies to the torques that the model is judged by.
        let log = in_torques(log.clone(), &estimate.corrections);
        judge(arm, &log, &model_of(arm, &estimate, place, &found))
    };
    found.judgements = torques.logs.iter().enumerate().map(judged).collect();
    for (input, judgement) in inputs.iter().zip(&found.judgements) {
        poor_fits(arm, &input.log, judgement, findings);
    }
    Some(found)
}

/// Logs with torques in place of currents, and all that is known of them before they are filtered.
struct Torques {
    logs: Vec<Log>,
    /// Stretches of time with torques that do not count, by log and joint.
    flawed: Vec<Vec<Vec<Range<f64>>>>,
    /// Joints that are locked in all logs.
    locked: Vec<usize>,
    is_of_currents: bool,
    /// Torque over what the logs hold, by joint.
    gains: Vec<f64>,
    /// Names of the sessions.
    sessions: Vec<String>,
    runs: Vec<Run>,
}

impl Torques {
    fn new(arm: &Arm, inputs: &[Input], options: &Options, findings: &mut Findings) -> Option<Torques> {
        let locked: Vec<usize> = (0..arm.dof()).filter(|&j| options.without.contains(&arm.joints[j].name)).collect();
        let mut logs: Vec<Log> = inputs.iter().map(|input| input.log.clone()).collect();
        let mut flawed: Vec<Vec<Vec<Range<f64>>>> = Vec::new();
        for log in &mut logs {
            locked::hold(arm, &locked, log, findings);
            let mut of_joints = suspect::signals(arm, log, &locked, findings);
            // The torque of a lock is a reaction.
            locked.iter().for_each(|&j| of_joints[j] = vec![f64::NEG_INFINITY..f64::INFINITY]);
            flawed.push(of_joints);
        }
        let is_of_currents = inputs.iter().any(|input| input.log.is_current);
        let gains = start_gains(arm, inputs, options, is_of_currents, findings);
        if findings.has_errors() {
            return None;
        }
        let mut sessions: Vec<String> = Vec::new();
        let mut session_of = |name: &String| {
            sessions.iter().position(|known| known == name).unwrap_or_else(|| {
                sessions.push(name.clone());
                sessions.len() - 1
            })
        };
        let run = |input: &Input| Run {
            session: session_of(&input.session),
            load: input.load.clone(),
            is_current: input.log.is_current,
        };
        let runs: Vec<Run> = inputs.iter().map(run).collect();
        let logs = logs.into_iter().map(|log| in_torques(log, &gains)).collect();
        Some(Torques { logs, flawed, locked, is_of_currents, gains, sessions, runs })
    }

    /// Gains that nothing was found of; none where the logs hold torques.
    fn gains_as_given(&self) -> Vec<Interval> {
        let given = |gain: &f64| Interval { value: *gain, low: *gain, high: *gain, ..Interval::default() };
        self.gains.iter().filter(|_| self.is_of_currents).map(given).collect()
    }

    /// Filtered stretches of the logs with a cutoff, Hz: all, or one of so many.
    fn pieces(&self, arm: &Arm, cutoff: f64, every: usize) -> Vec<Piece> {
        let of_log = |(place, log)| prepare(arm, place, log, cutoff, &self.flawed[place], true, every);
        self.logs.iter().enumerate().flat_map(of_log).collect()
    }

    /// The cutoff of the options, or the lowest that the motion needs, and the stretches of the logs that it leaves.
    fn filtered(&self, arm: &Arm, options: &Options, findings: &mut Findings) -> Option<(f64, Vec<Piece>)> {
        let slowest = self.logs.iter().map(|log| 1.0 / period(&log.t)).fold(f64::INFINITY, f64::min);
        let highest = (0.1 * slowest).max(3.0f64.min(0.2 * slowest));
        let cutoff = options.cutoff.unwrap_or(highest);
        let pieces = self.pieces(arm, cutoff, 1);
        if pieces.is_empty() {
            let text = format!("no stretch of the logs is longer than {:.1} s", 8.0 / cutoff);
            let help = "log at least 10 s without a gap";
            findings.push(Finding::new(Code::NoMotion, &self.logs[0].name, text, help));
            return None;
        }
        if options.cutoff.is_none() {
            let mut first = self.estimate(arm, &pieces, options);
            first.fit_active();
            let chosen = cutoff_of(&first, highest);
            if chosen < cutoff {
                return Some((chosen, self.pieces(arm, chosen, 1)));
            }
        }
        Some((cutoff, pieces))
    }

    /// The same stretches along the reference of the drives.
    fn along_reference(&self, arm: &Arm, cutoff: f64, every: usize) -> Vec<Piece> {
        let along = |log: &Log| {
            let reference = log.reference.iter().flatten().zip(&log.q);
            // Drives follow late: a sign that changes early is no instrument.
            Log { q: reference.map(|(reference, q)| nearest(&log.t, reference, q)).collect(), dq: None, ..log.clone() }
        };
        let of_log = |(place, log): (usize, &Log)| prepare(arm, place, &along(log), cutoff, &self.flawed[place], true, every);
        self.logs.iter().enumerate().flat_map(of_log).collect()
    }

    /// An estimate that begins with the simplest friction.
    fn estimate<'a>(&'a self, arm: &'a Arm, pieces: &'a [Piece], options: &Options) -> Estimate<'a> {
        let mut estimate = Estimate::new(arm, pieces, &self.runs, self.sessions.len());
        fix(arm, options, &mut estimate);
        estimate.activate(&|_, term| SIMPLE.contains(&term));
        estimate
    }
}

/// A log of currents times gains; a log of torques as it is.
fn in_torques(mut log: Log, gains: &[f64]) -> Log {
    for (column, gain) in log.effort.iter_mut().zip(gains).filter(|_| log.is_current) {
        column.iter_mut().for_each(|x| *x *= gain);
    }
    log
}

/// Terms of friction that every joint may have.
const SIMPLE: [Friction; 3] = [Friction::Viscous, Friction::Coulomb, Friction::Offset];

/// Whether joints move in at least five times as many rows as there are unknowns.
fn enough_rows(pieces: &[Piece], unknowns: usize, log: &str, findings: &mut Findings) -> bool {
    let moving: usize = pieces.iter().map(|piece| piece.counts.iter().filter(|counts| **counts).count()).sum();
    if moving < 5 * unknowns {
        let text = format!("{moving} rows of joints in motion, and {unknowns} unknowns");
        let help = "move all joints, longer or faster: `armgen excite` plans such a motion";
        findings.push(Finding::new(Code::NoMotion, log, text, help));
    }
    moving >= 5 * unknowns
}

/// The terms of friction of each joint that are there before any is chosen.
fn first_terms(estimate: &Estimate<'_>, options: &Options) -> Vec<Vec<Friction>> {
    vec![options.friction.clone().unwrap_or_else(|| SIMPLE.to_vec()); estimate.arm.dof()]
}

/// The terms of friction of each joint: those of the options, or those that cross-validation chooses. The estimate has them.
fn chosen_terms(estimate: &mut Estimate<'_>, options: &Options) -> Vec<Vec<Friction>> {
    let n = estimate.arm.dof();
    let is_free = options.friction.is_none();
    let mut terms = first_terms(estimate, options);
    estimate.fit_terms(&terms);
    for round in 0..3 {
        estimate.renew_sizes();
        if round == 0 && is_free {
            estimate.choose(&mut terms, Friction::Load);
        }
        estimate.fit_terms(&terms);
    }
    if !is_free {
        return terms;
    }
    // Cubic friction alone takes a part of Stribeck friction, so it comes last.
    let inside = estimate.stribeck_velocities(&|_| true);
    let mut with = terms.clone();
    estimate.choose(&mut with, Friction::Stribeck);
    (0..n).filter(|&j| inside[j]).for_each(|j| terms[j].clone_from(&with[j]));
    estimate.fit_terms(&terms);
    for _ in 0..2 {
        estimate.stribeck_velocities(&|j| terms[j].contains(&Friction::Stribeck));
        estimate.fit_terms(&terms);
    }
    estimate.choose(&mut terms, Friction::Cubic);
    estimate.fit_terms(&terms);
    // Where the others were missing, they may have hidden it.
    estimate.renew_sizes();
    estimate.choose(&mut terms, Friction::Load);
    without_insignificant(estimate, &mut terms);
    terms
}

/// Takes back terms of friction that are smaller than their intervals, once |g| is that of all others.
fn without_insignificant(estimate: &mut Estimate<'_>, terms: &mut [Vec<Friction>]) {
    estimate.fit_terms(terms);
    estimate.renew_sizes();
    estimate.fit_terms(terms);
    estimate.prune(terms, &[Friction::Load, Friction::Cubic, Friction::Stribeck]);
    estimate.fit_terms(terms);
}

/// The standard errors of delays and halves of their intervals. Delays, and terms of friction that they hid, are those of the estimate.
fn settled_delays(estimate: &mut Estimate<'_>, terms: &mut [Vec<Friction>], options: &Options) -> Vec<Option<[f64; 2]>> {
    let errors = settled(estimate, From::Afar);
    // Delays that were nearly right may have hidden terms.
    let before = terms.to_vec();
    if options.friction.is_none() && !options.instruments {
        estimate.choose(terms, Friction::Cubic);
        estimate.choose(terms, Friction::Load);
    }
    if *terms == *before {
        return errors;
    }
    without_insignificant(estimate, terms);
    estimate.settle(From::Afar)
}

/// The same with the terms that there are.
fn settled(estimate: &mut Estimate<'_>, from: From) -> Vec<Option<[f64; 2]>> {
    let errors = estimate.settle(from);
    if estimate.leave_undetermined_delays(&errors) {
        return estimate.settle(From::Near);
    }
    errors
}

/// A finding for each delay that was found at the end of those that are tried.
fn last_delays(estimate: &Estimate<'_>, log: &Log, findings: &mut Findings) {
    for (joint, delay) in estimate.arm.joints.iter().zip(&estimate.delays).filter(|(_, delay)| Estimate::is_last_delay(**delay)) {
        let text = format!("the delay of joint `{}`, {:.1} ms, is at the end of its range", joint.name, 1e3 * delay);
        let help = "bring the stamps of torques and positions together, or give `delay` in the options; noise of positions leads here, too: log rates (`dq_JOINT`)";
        findings.push(Finding::new(Code::DelayAtLimit, &log.name, text, help).in_column(log.effort_column(&joint.name)));
    }
}

/// Drive gains, and the estimate that they belong to.
struct DriveGains {
    gains: Vec<Interval>,
    /// Values of all columns.
    x: DVector<f64>,
    /// The covariance of the active columns.
    matrix: DMatrix<f64>,
    reach: f64,
}

/// Drive gains by maximum likelihood, the least certain ones kept one after the other until the logs determine the rest.
fn drive_gains(estimate: &mut Estimate<'_>, terms: &[Vec<Friction>], given: &[f64]) -> DriveGains {
    let n = estimate.arm.dof();
    let mut held = vec![false; n];
    loop {
        estimate.fit_terms(terms);
        let mut trial = estimate.clone();
        let mut of_trial = trial.gains(&held);
        // Load friction takes |g| of the corrected torques.
        trial.renew_sizes();
        if terms.iter().any(|terms| terms.contains(&Friction::Load)) {
            of_trial = trial.gains(&held);
        }
        let (corrections, sigmas, matrix, reach) = of_trial;
        let worst = (0..n)
            .filter(|&j| !held[j] && (reach * sigmas[j] > 0.5 * corrections[j] || !corrections[j].is_finite()))
            .max_by(|&a, &b| (sigmas[a] / corrections[a]).total_cmp(&(sigmas[b] / corrections[b])));
        if let Some(j) = worst {
            held[j] = true;
            continue;
        }
        let interval = |j: usize| {
            let (value, sigma) = (given[j] * corrections[j], given[j] * sigmas[j]);
            Interval { value, sigma, low: value - reach * sigma, high: value + reach * sigma, excited: !held[j] }
        };
        let gains = (0..n).map(interval).collect();
        *estimate = trial;
        return DriveGains { gains, x: estimate.x.clone(), matrix, reach };
    }
}

/// A finding where so few blocks of time are independent that intervals are those of Student's t.
fn few_blocks(covariance: &Covariance, log: &str, findings: &mut Findings) {
    if covariance.blocks as f64 >= FEW_BLOCKS {
        return;
    }
    let mut text = format!("{} independent stretches of time: intervals use Student's t", covariance.blocks);
    let mut help = "log 30 s or more for narrow intervals";
    if covariance.length > COLOURED {
        text += &format!("; residuals are correlated over {:.1} s", covariance.length / 5.0);
        help = "the model or the log is wrong there, and a longer log does not mend it: look at the residuals of each joint, `--report`";
    }
    findings.push(Finding::new(Code::ShortLog, log, text, help));
}

/// The estimate with load and cubic friction of all joints, and its covariance.
fn with_terms_left_out<'a>(estimate: &Estimate<'a>, terms: &[Vec<Friction>]) -> (Estimate<'a>, Covariance) {
    let mut wider = estimate.clone();
    wider.activate(&|joint, term| terms[joint].contains(&term) || matches!(term, Friction::Load | Friction::Cubic));
    let (.., covariance) = wider.finish();
    (wider, covariance)
}

/// Intervals of the active columns; with those of a wider estimate they reach from end to end of both.
fn intervals(
    estimate: &Estimate<'_>,
    matrix: &DMatrix<f64>,
    reach: f64,
    wider: Option<&(Estimate<'_>, Covariance)>,
) -> Vec<Interval> {
    let interval = |(k, &place): (usize, &usize)| {
        let value = estimate.x[place];
        let around = |middle: f64, matrix: &DMatrix<f64>, k: usize, reach: f64| {
            let sigma = matrix[(k, k)].max(0.0).sqrt();
            Interval { value, sigma, low: middle - reach * sigma, high: middle + reach * sigma, excited: true }
        };
        let own = around(value, matrix, k, reach);
        match wider.and_then(|(wider, of)| Some((wider, of, wider.active.binary_search(&place).ok()?))) {
            Some((wider, of, k)) => {
                let wide = around(wider.x[place], &of.matrix, k, of.reach);
                Interval { low: wide.low.min(own.low), high: wide.high.max(own.high), ..wide }
            }
            None => own,
        }
    };
    estimate.active.iter().enumerate().map(interval).collect()
}

/// A finding where estimates leave their intervals at half the cutoff.
fn moved_by_half_the_cutoff(
    estimate: &Estimate<'_>,
    equations: &Equations,
    solution: &Solution,
    cutoff: f64,
    intervals: &[Interval],
    log: &str,
    findings: &mut Findings,
) {
    let is_outside = |k: usize, x: f64| x < intervals[k].low || x > intervals[k].high;
    let moved = estimate.moved_by_half_the_cutoff(equations, solution, cutoff, &is_outside);
    if moved.is_empty() {
        return;
    }
    let names: Vec<String> = moved.iter().take(3).map(|&k| column_name(estimate, k)).collect();
    let text = format!(
        "{} of {} estimates leave their intervals at half the cutoff: {}",
        moved.len(),
        estimate.active.len(),
        names.join(", ")
    );
    let help = "noise of the positions biases them, or terms that the model lacks: log rates (`dq_JOINT`), or the reference of the drives (`qr_JOINT`) for `--instruments`, or choose a lower `cutoff`";
    findings.push(Finding::new(Code::BiasedRegressor, log, text, help));
}

/// Friction of all sessions, with the interval of each active column.
fn of_friction(estimate: &Estimate<'_>, interval: impl Fn(usize) -> Interval) -> Vec<FrictionValue> {
    let of = |(k, &place): (usize, &usize)| match estimate.columns[place] {
        Column::Friction(session, joint, term) => Some(FrictionValue { session, joint, term, value: interval(k) }),
        _ => None,
    };
    estimate.active.iter().enumerate().filter_map(of).collect()
}

/// The ten of the load of each log that has one.
fn of_loads(estimate: &Estimate<'_>, intervals: &[Interval]) -> Vec<(usize, Vec<Option<Interval>>)> {
    let of_log = |log: usize| {
        let known = estimate.known_load(log);
        let of = |k: usize| match estimate.active.binary_search(&estimate.place(Column::Load(log, k))) {
            Ok(k) => Some(intervals[k]),
            Err(_) if known[k] != 0.0 => Some(Interval { value: known[k], low: known[k], high: known[k], ..Interval::default() }),
            Err(_) => None,
        };
        (log, (0..10).map(of).collect())
    };
    (0..estimate.runs.len()).filter(|&log| estimate.runs[log].load.is_there).map(of_log).collect()
}

/// Delays with standard errors and halves of their intervals.
fn of_delays(estimate: &Estimate<'_>, errors: &[Option<[f64; 2]>], is_given: bool) -> Vec<Interval> {
    let delay = |(&value, error): (&f64, &Option<[f64; 2]>)| {
        let [sigma, half] = error.unwrap_or_default();
        Interval { value, sigma, low: value - half, high: value + half, excited: is_given || error.is_some() }
    };
    estimate.delays.iter().zip(errors).map(delay).collect()
}

/// Friction of a session that options give: joint, term, value.
fn held(estimate: &Estimate<'_>, session: usize) -> Vec<(usize, Friction, f64)> {
    let of = |&(place, value): &(usize, f64)| match estimate.columns[place] {
        Column::Friction(of, joint, term) if of == session => Some((joint, term, value)),
        _ => None,
    };
    estimate.fixed.iter().filter_map(of).collect()
}

/// A mass that is given and fits better with another value is off by this part of it at least.
const OTHER_MASS: f64 = 0.02;

/// Known masses of loads against those that the logs show, where a log without this load does.
fn loads(estimate: &Estimate<'_>, terms: &[Vec<Friction>], inputs: &[Input], findings: &mut Findings) {
    for (log, run) in estimate.runs.iter().enumerate() {
        let Some(mass) = run.load.mass else { continue };
        let mut runs = estimate.runs.to_vec();
        runs[log].load = Load { is_there: true, ..Load::default() };
        let mut free = Estimate { runs: &runs, ..estimate.clone() };
        free.activate(&|joint, term| terms[joint].contains(&term));
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
