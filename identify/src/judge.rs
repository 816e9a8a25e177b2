//! A model against a log: residuals and contacts.
//!
//! Both sides pass one zero-phase low pass of 8 Hz, and the delay of each joint is taken out.

use nalgebra::{DMatrix, DVector};

use crate::arm::Arm;
use crate::log::Log;
use crate::prepare::{prepare, Friction, Piece};
use crate::signal::{rms, spread};

/// Hz.
pub const CUTOFF: f64 = 8.0;

/// A model of an arm.
#[derive(Clone, Debug)]
pub struct Model {
    /// Base parameters of the arm with the load of the log.
    pub pi: Vec<f64>,
    /// Friction of each joint, in the order of [`Friction::ALL`].
    pub friction: Vec<[f64; 6]>,
    /// Velocities of Stribeck friction.
    pub velocities: Vec<f64>,
    /// s, by joint; found for the log where there are none.
    pub delays: Option<Vec<f64>>,
    /// Spread of the residuals, by joint; that of the log where there is none.
    pub spreads: Option<Vec<f64>>,
    /// Covariance of the base parameters, where it is known.
    pub covariance: Option<DMatrix<f64>>,
}

/// A stretch of time with torques that the model does not explain.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// s.
    pub from: f64,
    /// s.
    pub to: f64,
    /// Joints with a residual beyond the threshold.
    pub joints: Vec<usize>,
}

/// What a log says of a model.
#[derive(Clone, Debug, Default)]
pub struct Judgement {
    /// Stamps, s.
    pub times: Vec<f64>,
    /// Measured torque, by joint.
    pub measured: Vec<Vec<f64>>,
    /// Predicted torque, by joint.
    pub predicted: Vec<Vec<f64>>,
    /// Rates, by joint.
    pub rates: Vec<Vec<f64>>,
    /// Positions, by joint.
    pub positions: Vec<Vec<f64>>,
    /// Root of the mean square of the residual, by joint.
    pub rms: Vec<f64>,
    /// The same over that of the torque.
    pub relative: Vec<f64>,
    /// The same where the joint moves faster than 0.02 rad/s.
    pub moving: Vec<f64>,
    /// Delays that were taken out, s.
    pub delays: Vec<f64>,
    /// Contacts.
    pub contacts: Vec<Contact>,
}

impl Judgement {
    /// Samples as CSV: t, then q, dq, measured and predicted torque of each joint, filtered as they are judged.
    pub fn csv(&self, arm: &Arm) -> String {
        let signals = [("q", &self.positions), ("dq", &self.rates), ("measured", &self.measured), ("predicted", &self.predicted)];
        let mut text = String::from("t");
        for (prefix, _) in signals {
            arm.joints.iter().for_each(|joint| text += &format!(",{prefix}_{}", joint.name));
        }
        text.push('\n');
        for (k, t) in self.times.iter().enumerate() {
            text += &format!("{t:.6}");
            signals.iter().flat_map(|(_, joints)| joints.iter()).for_each(|x| text += &format!(",{:.7}", x[k] + 0.0));
            text.push('\n');
        }
        text
    }
}

/// Slower is standstill, rad/s or m/s.
const SLOW: f64 = 0.02;

/// Judges a model by a log of torques.
pub fn judge(arm: &Arm, log: &Log, model: &Model) -> Judgement {
    let n = arm.dof();
    let rate = 1.0 / crate::signal::period(&log.t);
    let pieces = prepare(arm, 0, log, CUTOFF.min(0.2 * rate), &[], model.covariance.is_some(), 1);
    let mut judgement = Judgement {
        measured: vec![Vec::new(); n],
        predicted: vec![Vec::new(); n],
        rates: vec![Vec::new(); n],
        positions: vec![Vec::new(); n],
        ..Judgement::default()
    };
    let mut gravity = vec![Vec::new(); n];
    let mut uncertain = vec![Vec::new(); n];
    let sizes: Vec<Vec<f64>> = pieces.iter().map(|piece| arm.gravity(&piece.q, &model.pi)).collect();
    for (piece, sizes) in pieces.iter().zip(&sizes) {
        for k in &piece.kept {
            (0..n).for_each(|j| gravity[j].push(sizes[k * n + j].abs()));
        }
    }
    let of_bodies: Vec<Vec<Vec<f64>>> = pieces.iter().map(|piece| piece.torques(arm, &model.pi)).collect();
    let predicted = |delays: &[f64]| {
        let mut torques = of_bodies.clone();
        for ((all, piece), sizes) in torques.iter_mut().zip(&pieces).zip(&sizes) {
            all.iter_mut().enumerate().for_each(|(j, all)| add_friction(all, piece, model, j, sizes, delays[j]));
        }
        torques
    };
    judgement.delays = model.delays.clone().unwrap_or_else(|| {
        let predicted = predicted(&vec![0.0; n]);
        (0..n).map(|j| best_delay(&pieces, &predicted, j)).collect()
    });
    let predicted = predicted(&judgement.delays);
    for (piece, predicted) in pieces.iter().zip(&predicted) {
        let base = arm.base.len();
        judgement.times.extend((0..piece.kept.len()).map(|row| piece.time(row)));
        for j in 0..n {
            judgement.measured[j].extend(piece.delayed(j, judgement.delays[j]));
            judgement.predicted[j].extend(&predicted[j]);
            judgement.rates[j].extend(piece.kept.iter().map(|k| piece.dq[k * n + j]));
            judgement.positions[j].extend(piece.kept.iter().map(|k| piece.q[k * n + j]));
            for row in 0..piece.kept.len() {
                let variance = model.covariance.as_ref().map_or(0.0, |covariance| {
                    let y = DVector::from_row_slice(&piece.y[(row * n + j) * base..(row * n + j + 1) * base]);
                    y.dot(&(covariance * &y)).max(0.0)
                });
                uncertain[j].push(variance.sqrt());
            }
        }
    }
    let residual =
        |j: usize| -> Vec<f64> { judgement.measured[j].iter().zip(&judgement.predicted[j]).map(|(a, b)| a - b).collect() };
    let residuals: Vec<Vec<f64>> = (0..n).map(residual).collect();
    for j in 0..n {
        let of = |rows: &dyn Fn(usize) -> bool| {
            let pick = |x: &[f64]| (0..x.len()).filter(|&k| rows(k)).map(|k| x[k]).collect::<Vec<f64>>();
            (rms(&pick(&residuals[j])), rms(&pick(&judgement.measured[j])))
        };
        let (error, size) = of(&|_| true);
        let (error_moving, size_moving) = of(&|k| judgement.rates[j][k].abs() > SLOW);
        judgement.rms.push(error);
        judgement.relative.push(error / size.max(1e-300));
        judgement.moving.push(error_moving / size_moving.max(1e-300));
    }
    let spreads: Vec<f64> =
        model.spreads.clone().unwrap_or_else(|| residuals.iter().map(|residuals| spread(residuals)).collect());
    let beyond = |j: usize, k: usize| {
        let [_, coulomb, _, load, ..] = model.friction[j];
        let rest = if judgement.rates[j][k].abs() < SLOW { 1.3 * (coulomb + load * gravity[j][k]) } else { 0.0 };
        residuals[j][k].abs() > 4.0 * spreads[j] + 3.0 * uncertain[j][k] + rest
    };
    judgement.contacts = contacts(&judgement.times, n, &beyond);
    judgement
}

/// Stretches beyond the threshold for 0.1 s; gaps below 0.5 s joined.
fn contacts(times: &[f64], joints: usize, beyond: &dyn Fn(usize, usize) -> bool) -> Vec<Contact> {
    let mut found: Vec<Contact> = Vec::new();
    for j in 0..joints {
        let mut start: Option<usize> = None;
        for k in 0..=times.len() {
            let goes_on = k < times.len() && beyond(j, k) && (k == 0 || times[k] - times[k - 1] < 0.2);
            if let (Some(first), false) = (start, goes_on) {
                if times[k - 1] - times[first] >= 0.1 - 1e-9 {
                    found.push(Contact { from: times[first], to: times[k - 1], joints: vec![j] });
                }
                start = None;
            }
            if start.is_none() && k < times.len() && beyond(j, k) {
                start = Some(k);
            }
        }
    }
    found.sort_by(|a, b| a.from.total_cmp(&b.from));
    let mut joined: Vec<Contact> = Vec::new();
    for next in found {
        match joined.last_mut().filter(|last| next.from - last.to < 0.5) {
            Some(last) => {
                last.to = last.to.max(next.to);
                last.joints.extend(next.joints);
                last.joints.sort_unstable();
                last.joints.dedup();
            }
            None => joined.push(next),
        }
    }
    joined
}

fn add_friction(all: &mut [f64], piece: &Piece, model: &Model, j: usize, sizes: &[f64], delay: f64) {
    for (term, value) in Friction::ALL.into_iter().zip(model.friction[j]).filter(|(_, value)| *value != 0.0) {
        for (sum, column) in all.iter_mut().zip(piece.friction(j, term, model.velocities[j], sizes, delay)) {
            *sum += value * column;
        }
    }
}

fn best_delay(pieces: &[Piece], predicted: &[Vec<Vec<f64>>], j: usize) -> f64 {
    let cost = |delay: f64| {
        pieces
            .iter()
            .zip(predicted)
            .flat_map(|(piece, predicted)| {
                piece.delayed(j, delay).into_iter().zip(&predicted[j]).map(|(a, b)| (a - b).powi(2)).collect::<Vec<_>>()
            })
            .sum::<f64>()
    };
    let step = 1.25e-3;
    let grid: Vec<f64> = (-8..=20).map(|k| f64::from(k) * step).collect();
    let costs: Vec<f64> = grid.iter().map(|&delay| cost(delay)).collect();
    let best = (0..grid.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).expect("a grid");
    match costs.get(best.wrapping_sub(1)..best + 2) {
        Some(&[a, b, c]) if a + c > 2.0 * b => grid[best] + 0.5 * step * (a - c) / (a - 2.0 * b + c),
        _ => grid[best],
    }
}
