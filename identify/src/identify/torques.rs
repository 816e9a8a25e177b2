//! Logs with torques in place of currents, filtered.

use std::ops::Range;

use crate::arm::Arm;
use crate::estimate::{Column, Estimate, Run};
use crate::finding::{Code, Finding, Findings};
use crate::log::Log;
use crate::options::{Gains, Options};
use crate::prepare::{prepare, Friction, Piece};
use crate::signal::{nearest, period, LowPass};
use crate::suspect;

use super::terms::SIMPLE;
use super::{locked, Input, Interval};

/// Logs with torques in place of currents, and all that is known of them before they are filtered.
pub(super) struct Torques {
    pub(super) logs: Vec<Log>,
    /// Stretches of time with torques that do not count, by log and joint.
    pub(super) flawed: Vec<Vec<Vec<Range<f64>>>>,
    /// Joints that are locked in all logs.
    pub(super) locked: Vec<usize>,
    pub(super) is_of_currents: bool,
    /// Torque over what the logs hold, by joint.
    pub(super) gains: Vec<f64>,
    /// Names of the sessions.
    pub(super) sessions: Vec<String>,
    pub(super) runs: Vec<Run>,
}

impl Torques {
    pub(super) fn new(arm: &Arm, inputs: &[Input], options: &Options, findings: &mut Findings) -> Option<Torques> {
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
    pub(super) fn gains_as_given(&self) -> Vec<Interval> {
        let given = |gain: &f64| Interval { value: *gain, low: *gain, high: *gain, ..Interval::default() };
        self.gains.iter().filter(|_| self.is_of_currents).map(given).collect()
    }

    /// Filtered stretches of the logs with a cutoff, Hz: all, or one of so many.
    pub(super) fn pieces(&self, arm: &Arm, cutoff: f64, every: usize) -> Vec<Piece> {
        let of_log = |(place, log)| prepare(arm, place, log, cutoff, &self.flawed[place], true, every);
        self.logs.iter().enumerate().flat_map(of_log).collect()
    }

    /// The cutoff of the options, or the lowest that the motion needs, and the stretches of the logs that it leaves.
    pub(super) fn filtered(&self, arm: &Arm, options: &Options, findings: &mut Findings) -> Option<(f64, Vec<Piece>)> {
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
    pub(super) fn along_reference(&self, arm: &Arm, cutoff: f64, every: usize) -> Vec<Piece> {
        let along = |log: &Log| {
            let reference = log.reference.iter().flatten().zip(&log.q);
            // Drives follow late: a sign that changes early is no instrument.
            Log { q: reference.map(|(reference, q)| nearest(&log.t, reference, q)).collect(), dq: None, ..log.clone() }
        };
        let of_log = |(place, log): (usize, &Log)| prepare(arm, place, &along(log), cutoff, &self.flawed[place], true, every);
        self.logs.iter().enumerate().flat_map(of_log).collect()
    }

    /// An estimate that begins with the simplest friction.
    pub(super) fn estimate<'a>(&'a self, arm: &'a Arm, pieces: &'a [Piece], options: &Options) -> Estimate<'a> {
        let mut estimate = Estimate::new(arm, pieces, &self.runs, self.sessions.len());
        fix(arm, options, &mut estimate);
        estimate.activate(&|_, term| SIMPLE.contains(&term));
        estimate
    }
}

/// A log of currents times gains; a log of torques as it is.
pub(super) fn in_torques(mut log: Log, gains: &[f64]) -> Log {
    for (column, gain) in log.effort.iter_mut().zip(gains).filter(|_| log.is_current) {
        column.iter_mut().for_each(|x| *x *= gain);
    }
    log
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
