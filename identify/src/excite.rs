//! Motions that show the parameters: log det of the information is large, and limits hold at all times, proved.
//!
//! ```text
//! maximise  log det M,   M = mean over time of A' E^-2 A,   A = [Y_b, columns of friction]
//! ```
//!
//! E are the limits of effort, or the sizes of the gravity torques (Swevers et al., IEEE T-RA 13, 1997, with determinants).

mod enclosure;
mod model;
mod motion;
pub mod options;
mod proof;
mod search;
mod simulated;
mod tape;
mod written;

use std::fmt;

use armgen_codegen::manipulator::Manipulator;
use nalgebra::{DMatrix, SymmetricEigen};

pub use model::{Limits, TOOL};
pub use motion::{Course, LeadIn, Motion};
pub use proof::{Kind, Margin, Proof, Unproved};

use crate::arm::Arm;
use model::{slides, Frame, Model};
use options::Options;
use search::{Bound, Random, Search};

armgen_codegen::codes! {
    /// Reasons why there is no motion.
    pub enum Code {
        /// A joint without limits that bound its motion.
        MissingLimit Error "missing-limit",
        /// A start outside the range of a joint, or one that cannot be left within the limits.
        InfeasibleStart Error "infeasible-start",
        /// No motion within the limits was found.
        NoMotion Error "no-motion",
        /// A frame that the arm does not have.
        UnknownFrame Error "unknown-frame",
        /// A joint that the arm does not have.
        UnknownJoint Error "unknown-joint",
        /// A number of an options file outside of its range.
        OutOfRange Error "out-of-range",
    }
}

/// Why there is no motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Its kind.
    pub code: Code,
    /// The reason.
    pub text: String,
    /// The remedy.
    pub help: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error[{}]: {}\n = help: {}\n", self.code, self.text, self.help)
    }
}

fn fault(code: Code, text: String, help: &str) -> Fault {
    Fault { code, text, help: help.to_owned() }
}

/// A motion with its proof.
#[derive(Clone, Debug, Default)]
pub struct Excitation {
    /// The robot.
    pub robot: String,
    /// Its joints.
    pub joints: Vec<String>,
    /// Whether they slide.
    pub slides: Vec<bool>,
    /// Their limits.
    pub limits: Limits,
    /// Frame and axis of each bound of a frame.
    pub bounds: Vec<(String, String)>,
    /// The motion.
    pub motion: Motion,
    /// What leads to it.
    pub lead_in: LeadIn,
    /// Columns: base parameters and friction.
    pub unknowns: usize,
    /// log det M over the columns, per column.
    pub log_det_per_parameter: f64,
    /// Largest over least eigenvalue of M with scaled columns.
    pub condition: f64,
    /// What is proved of the motion.
    pub proof: Proof,
    /// What is proved of the lead-in.
    pub of_lead_in: Proof,
}

/// Parts of the work, for a progress bar.
pub const PARTS: usize = search::PARTS + 2;

/// How often a motion with an unproved limit is planned again with less of it.
const ROUNDS: usize = 12;

/// Plans a motion. `done` is called after each of [`PARTS`] parts of the work.
///
/// # Errors
/// The faults of description and options, or that no motion was found.
pub fn excite(given: &Manipulator, arm: &Arm, options: &Options, done: &(dyn Fn() + Sync)) -> Result<Excitation, Vec<Fault>> {
    let limits = Limits::of(given);
    let mut faults = missing(given, &limits);
    let frames: Vec<(usize, Frame)> = options
        .frames
        .iter()
        .filter_map(|name| {
            let found = Model::frame(given, name);
            if found.is_none() {
                let names: Vec<&str> = given.joints.iter().map(|joint| joint.name.as_str()).collect();
                let text = format!("the arm has no frame `{name}`");
                let help = format!("frames have the names of joints, {}, and `{TOOL}`", names.join(", "));
                faults.push(fault(Code::UnknownFrame, text, &help));
            }
            found
        })
        .collect();
    let start = start(given, &limits, options, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let mut bounds = Vec::new();
    let mut names = Vec::new();
    for (function, frame) in &frames {
        for (axis, range) in options.box_.iter().enumerate() {
            let Some([low, high]) = *range else { continue };
            bounds.push(Bound { function: *function, entry: frame.start + 4 * axis + 3, low, high });
            names.push((frame.name.clone(), ["x", "y", "z"][axis].to_owned()));
        }
    }
    // In the order of the proof: by function.
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    order.sort_by_key(|&k| bounds[k].function);
    let bounds: Vec<Bound> = order.iter().map(|&k| bounds[k]).collect();
    let names: Vec<(String, String)> = order.iter().map(|&k| names[k].clone()).collect();
    let model = Model::new(given, arm, &limits, !bounds.is_empty());
    let mut result = Excitation {
        robot: given.name.clone(),
        joints: given.joints.iter().map(|joint| joint.name.clone()).collect(),
        slides: (0..given.dof()).map(|joint| slides(given, joint)).collect(),
        bounds: names,
        limits: limits.clone(),
        unknowns: model.unknowns(),
        ..Excitation::default()
    };
    let at_rest = LeadIn { duration: 1.0, from: start.clone(), to: start.clone() };
    if let Err(of) = proof::pieces(&model, &limits, &bounds, &at_rest) {
        let text = format!("the start exceeds {} by {:.1} %", result.name_of(&of.kind), 100.0 * of.excess);
        return Err(vec![fault(Code::InfeasibleStart, text, "choose another `start` in the options")]);
    }
    let scale = scales(&model, &limits);
    let w = std::f64::consts::TAU / options.duration;
    let search = Search {
        model: &model,
        limits: &limits,
        bounds: &bounds,
        start: &start,
        scale: &scale,
        w,
        harmonics: options.harmonics,
        share: SHARE,
    };
    let none = |text: String| {
        let help = "raise the limits of the description, make the box larger, or give a longer `--duration`";
        vec![fault(Code::NoMotion, text, help)]
    };
    let best = search.best(options.seed, done);
    let mut x = best.ok_or_else(|| none("no motion shows all parameters".to_owned()))?;
    let mut share = SHARE;
    let mut unproved = None;
    let mut found = None;
    for _ in 0..ROUNDS {
        Search { share, ..search }.polish(&mut x);
        let motion = within(&search.motion(&x), &limits);
        match proved(&model, &limits, &bounds, &motion) {
            Ok(proof) => {
                found = Some((motion, proof));
                break;
            }
            Err(of) => {
                share -= of.excess.clamp(2e-4, 0.05) + 2e-4;
                unproved = Some(of);
            }
        }
    }
    done();
    let Some((motion, proof)) = found else {
        let of = unproved.expect("a round ends with a proof or without");
        let text = format!(
            "no motion within the limits was found: {} is exceeded by {:.2} %",
            result.name_of(&of.kind),
            100.0 * of.excess
        );
        return Err(none(text));
    };
    (result.motion, result.proof) = (motion, proof);
    (result.lead_in, result.of_lead_in) = lead_in(&model, &limits, &bounds, &result, &start, 1.0 / options.rate)?;
    (result.log_det_per_parameter, result.condition) = information(arm, &model, &scale, &result.motion);
    done();
    Ok(result)
}

/// Proves the limits of a motion at all times, without those of frames.
///
/// # Errors
/// A limit that is exceeded, or not proved with the shortest pieces.
pub fn prove(given: &Manipulator, arm: &Arm, limits: &Limits, motion: &Motion) -> Result<Proof, Unproved> {
    proved(&Model::new(given, arm, limits, false), limits, &[], motion)
}

fn proved(model: &Model, limits: &Limits, bounds: &[Bound], motion: &Motion) -> Result<Proof, Unproved> {
    let margins = proof::joints(motion, limits)?;
    let mut proof = proof::pieces(model, limits, bounds, motion)?;
    proof.margins.splice(0..0, margins);
    Ok(proof)
}

/// The part of limits that the first plan uses: what samples miss between them.
const SHARE: f64 = 0.9995;

impl Excitation {
    /// A limit in words.
    pub fn name_of(&self, kind: &Kind) -> String {
        let joint = |joint: &usize, limit: &str| format!("the limit of {limit} of joint `{}`", self.joints[*joint]);
        match kind {
            Kind::Position(at) => joint(at, "position"),
            Kind::Velocity(at) => joint(at, "velocity"),
            Kind::Acceleration(at) => joint(at, "acceleration"),
            Kind::Effort(at) => joint(at, "effort"),
            Kind::Box(at) => format!("the box in {} of frame `{}`", self.bounds[*at].1, self.bounds[*at].0),
        }
    }
}

fn missing(given: &Manipulator, limits: &Limits) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (k, joint) in given.joints.iter().enumerate() {
        let mut lacks = Vec::new();
        if !limits.velocity[k].is_finite() {
            lacks.push("velocity");
        }
        if !limits.acceleration[k].is_finite() && !limits.effort[k].is_finite() {
            lacks.push("acceleration");
        }
        if slides(given, k) && !limits.position[k][0].is_finite() {
            lacks.push("position");
        }
        if !lacks.is_empty() {
            let text = format!("joint `{}` has no limit of {}", joint.name, lacks.join(" and of "));
            let help =
                "give `limits: {velocity: ..., acceleration: ...}` in the description; sliding joints need `position`, too";
            faults.push(fault(Code::MissingLimit, text, help));
        }
    }
    faults
}

/// The posture of the start: that of the options, or the one nearest to 0 within the ranges.
fn start(given: &Manipulator, limits: &Limits, options: &Options, faults: &mut Vec<Fault>) -> Vec<f64> {
    let mut start: Vec<f64> = limits.position.iter().map(|[low, high]| 0.0f64.max(*low).min(*high)).collect();
    for (name, value) in &options.start {
        let Some(joint) = given.joints.iter().position(|joint| joint.name == *name) else {
            let text = format!("`start` has the joint `{name}`, and the arm has none of that name");
            faults.push(fault(Code::UnknownJoint, text, "name joints as the description does"));
            continue;
        };
        start[joint] = *value;
        let [low, high] = limits.position[joint];
        if !(low <= *value && *value <= high) {
            let text = format!("the start has joint `{name}` at {value}, and its range is {low} to {high}");
            faults.push(fault(Code::InfeasibleStart, text, "choose a `start` within the limits of position"));
        }
    }
    start
}

/// Postures for the sizes of gravity torques.
const POSTURES: usize = 64;

/// E: limits of effort, else the largest gravity torque of some postures, else 1.
fn scales(model: &Model, limits: &Limits) -> Vec<f64> {
    if limits.effort.iter().all(|effort| effort.is_finite()) {
        return limits.effort.clone();
    }
    let n = model.joints;
    let mut random = Random(1);
    let mut sizes = vec![0.0f64; n];
    let zero = vec![0.0; n];
    for _ in 0..POSTURES {
        let q: Vec<f64> = limits
            .position
            .iter()
            .map(|[low, high]| if (high - low).is_finite() { low + (high - low) * random.unit() } else { 3.0 * random.signed() })
            .collect();
        let mut g = vec![0.0; n];
        model.bare.run(&[&q, &zero, &zero], &mut g, &mut model.bare.workspace()).expect("vectors of this arm");
        sizes.iter_mut().zip(g).for_each(|(size, g)| *size = size.max(g.abs()));
    }
    let of = |(effort, size): (&f64, &f64)| match effort.is_finite() {
        true => *effort,
        false if *size > 1e-6 => *size,
        false => 1.0,
    };
    limits.effort.iter().zip(&sizes).map(of).collect()
}

/// The motion with the amplitudes of each joint reduced until its own limits are proved.
fn within(motion: &Motion, limits: &Limits) -> Motion {
    let mut motion = motion.clone();
    for joint in 0..motion.dof() {
        for _ in 0..8 {
            let [low, high] = limits.position[joint];
            let of = |derivative: usize, limit: f64| motion.largest(joint, derivative, 0.0, proof::SAMPLES) / limit;
            let mut used = of(1, limits.velocity[joint]).max(of(2, limits.acceleration[joint]));
            if (high - low).is_finite() {
                let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
                used = used.max(motion.largest(joint, 0, middle, proof::SAMPLES) / half);
            }
            if used <= 1.0 - 1e-12 {
                break;
            }
            let by = (1.0 - 1e-9) / used;
            for x in motion.a[joint].iter_mut().chain(&mut motion.b[joint]) {
                *x *= by;
            }
            if (high - low).is_finite() {
                let middle = (low + high) / 2.0;
                motion.q0[joint] = middle + (motion.q0[joint] - middle) * by;
            }
        }
    }
    motion
}

/// How often a lead-in is made slower.
const SLOWER: usize = 30;

fn lead_in(
    model: &Model,
    limits: &Limits,
    bounds: &[Bound],
    of: &Excitation,
    start: &[f64],
    step: f64,
) -> Result<(LeadIn, Proof), Vec<Fault>> {
    let to: Vec<f64> = (0..of.joints.len()).map(|joint| of.motion.at(joint, 0.0)[0]).collect();
    let mut lead = motion::lead_in(start, &to, &limits.velocity, &limits.acceleration, step);
    let mut last = None;
    for _ in 0..SLOWER {
        match proof::pieces(model, limits, bounds, &lead) {
            Ok(mut proof) => {
                let margins = (0..to.len()).flat_map(|joint| {
                    let way = (to[joint] - start[joint]).abs();
                    let rate = motion::QUINTIC_RATE * way / lead.duration / limits.velocity[joint];
                    let acceleration = motion::QUINTIC_ACCELERATION * way / lead.duration.powi(2) / limits.acceleration[joint];
                    // Positions are between two that are within the range.
                    let finite = limits.acceleration[joint].is_finite();
                    let of_rate = Some(Margin { kind: Kind::Velocity(joint), margin: 1.0 - rate });
                    [of_rate, finite.then_some(Margin { kind: Kind::Acceleration(joint), margin: 1.0 - acceleration })]
                });
                proof.margins.splice(0..0, margins.flatten());
                return Ok((lead, proof));
            }
            Err(unproved) => last = Some(unproved),
        }
        lead.duration = (lead.duration * 1.2 / step).ceil() * step;
    }
    let unproved = last.expect("a round ends with a proof or without");
    let text = format!(
        "the way from the start to the motion exceeds {} by {:.1} %, however slow",
        of.name_of(&unproved.kind),
        100.0 * unproved.excess.max(0.0)
    );
    Err(vec![fault(
        Code::InfeasibleStart,
        text,
        "choose another `start` in the options, nearer to the motion or better supported",
    )])
}

/// Samples of the reported information.
const REPORTED: usize = 1000;

/// log det M per column, and the condition of M with scaled columns, with true signs of rates.
fn information(arm: &Arm, model: &Model, scale: &[f64], motion: &Motion) -> (f64, f64) {
    let (n, p) = (model.joints, model.unknowns());
    let times = (0..REPORTED).map(|k| motion.duration() * k as f64 / REPORTED as f64);
    let mut x: [Vec<f64>; 3] = Default::default();
    for t in times {
        for joint in 0..n {
            let of = motion.at(joint, t);
            (0..3).for_each(|d| x[d].push(of[d]));
        }
    }
    let y = arm.regressor(&x[0], &x[1], &x[2]);
    let g = arm.gravity(&x[0], &model.pi);
    let mut m = DMatrix::<f64>::zeros(p, p);
    let mut row = vec![0.0; p];
    for (k, of) in y.chunks_exact(model.base).enumerate() {
        let joint = k % n;
        row.fill(0.0);
        row[..model.base].copy_from_slice(of);
        for (column, &(_, term)) in model.columns.iter().enumerate().filter(|(_, (of, _))| *of == joint) {
            let sign = if x[1][k] == 0.0 { 0.0 } else { x[1][k].signum() };
            row[model.base + column] = term.column(x[1][k], sign, g[k].abs(), model.friction[joint].velocity);
        }
        for (i, a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            let a = a / (scale[joint] * scale[joint] * REPORTED as f64);
            m.column_mut(i).iter_mut().zip(&row).for_each(|(m, b)| *m += a * b);
        }
    }
    let size: Vec<f64> = (0..p).map(|i| m[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(p, p, |i, j| m[(i, j)] / (size[i] * size[j]));
    let values = SymmetricEigen::new(scaled).eigenvalues;
    let (least, largest) = values.iter().fold((f64::INFINITY, 0.0f64), |(a, b), x| (a.min(*x), b.max(*x)));
    let log_det: f64 = values.iter().map(|x| x.ln()).sum::<f64>() + size.iter().map(|x| 2.0 * x.ln()).sum::<f64>();
    (log_det / p as f64, largest / least)
}
