//! From logs and a description to an identified arm.

mod gains;
mod intervals;
mod locked;
mod reduced;
mod shown;
mod terms;
mod torques;

use armgen_codegen::document::excerpt;
use armgen_codegen::suggest::did_you_mean;
use nalgebra::{DMatrix, DVector};

use crate::arm::Arm;
use crate::estimate::{Column, Estimate, From};
use crate::finding::{Code, Finding, Findings};
use crate::fit::{Covariance, Equations, Solution, FEW_BLOCKS};
use crate::judge::{judge, Judgement, Model};
use crate::log::Log;
use crate::options::{Gains, Load, Options};
use crate::prepare::{Friction, Piece};
use crate::signal::period;
use crate::suspect;

use gains::drive_gains;
use intervals::{intervals, of_delays, of_friction, of_loads, with_terms_left_out};
use reduced::reduce;
pub use reduced::Reduced;
use shown::{column_name, inseparable, unshown};
use terms::{chosen_terms, first_terms, last_delays, settled, settled_delays};
use torques::{in_torques, Torques};

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
