//! States, or states and torques, under other joints or with other signs: each such reading of a log is fitted and compared.
//!
//! A joint that is turned in position, rate and torque alike has the friction of the true joint; what it does to other joints, and what
//! gravity does to it, tells. An exchange of two joints that hardly act on others may fit as well: then their inertias tell.

use armgen_codegen::diagnostic::Severity;

use super::sides::{is_better, Fit, Gain, Sides};
use crate::arm::Arm;
use crate::estimate::{Column, Estimate};
use crate::finding::{Code, Finding, Findings};
use crate::log::Log;
use crate::prepare::{Friction, Piece};
use crate::signal::spread;

/// States that readings are compared by: where all are tried, and where few are left.
const STATES: [usize; 2] = [400, 2000];

/// A reading whose squares are above so many times those of the log as it is does not become the better one by terms of friction.
const FAR: f64 = 1.2;

/// How many times two inertias together are nearer to the description in the other order, where the fit does not tell: of a slide and a turn, and of
/// two joints of one kind.
const NEARER: [f64; 2] = [20.0, 4.0];

/// A gain above so many of its standard errors is none of chance: before friction is known, and with it.
const CHANCE: [f64; 2] = [4.0, 3.0];

/// A fit as good as another has squares below these times its; of two joints of one kind, which act on others.
const AS_GOOD: [f64; 2] = [1.1, 1.0];

/// An inertia may be off by so many standard errors of white residuals.
const DOUBT: f64 = 10.0;

/// By joint, the joint whose states it has, and their sign.
type Order = Vec<(usize, f64)>;

/// Joints under other names or with other signs.
pub(super) struct Reading {
    order: Order,
    /// Orders that explain as much, but for chance.
    as_well: Vec<Order>,
    /// Whether torques go with the states.
    whole: bool,
    /// The sum of squares over that of the log as it is.
    fall: f64,
    /// Whether it explains clearly more, and not just more than chance.
    pub(super) is_certain: bool,
    /// Whether inertias tell, and not the fit.
    by_inertias: bool,
}

impl Reading {
    /// Whether the fit tells, with squares below a part of those of the log as it is. A turned torque and turned states may be mirror images,
    /// which fit alike.
    pub(super) fn is_clear(&self, least: f64) -> bool {
        let is_turned = is_turned(&self.order);
        self.is_certain && !self.by_inertias && self.fall < if is_turned { 0.5 * least } else { least }
    }

    pub(super) fn told(&self, arm: &Arm, log: &Log) -> Finding {
        let name = |i: usize| arm.joints[i].name.as_str();
        let columns = |j: usize| {
            let (rate, effort) = (format!("dq_{}", name(j)), log.effort_column(name(j)));
            let columns = [Some(format!("q_{}", name(j))), log.dq.as_ref().map(|_| rate), self.whole.then_some(effort)];
            columns.into_iter().flatten().collect::<Vec<_>>().join(", ")
        };
        // The columns under a name are those of the joint whose states they fit.
        let words = |order: &Order| {
            let moved = order.iter().enumerate().filter(|(j, of)| of.0 != *j);
            let others: Vec<String> = moved.map(|(j, of)| format!("{} hold those of {}", columns(j), name(of.0))).collect();
            let turned: Vec<String> = (0..order.len()).filter(|&j| order[j].1 < 0.0).map(columns).collect();
            match (others.is_empty(), turned.is_empty()) {
                (true, _) => format!("with the other sign of {}", turned.join(", ")),
                (false, true) => format!("with other joints: {}", others.join("; ")),
                (false, false) => format!("with other joints, and with other signs: {}", others.join("; ")),
            }
        };
        let with = if self.by_inertias {
            "inertias come near those of the description".to_owned()
        } else {
            format!("the residual falls to {:.0} %", 100.0 * self.fall.sqrt())
        };
        let mut text = format!("{with} {}", words(&self.order));
        self.as_well.iter().for_each(|other| text += &format!(", and as far {}", words(other)));
        let (code, help) = if !is_turned(&self.order) {
            (Code::JointOrder, "rename the columns under `columns` of the options")
        } else {
            (Code::SignSuspected, "turn the sign of these columns, or the axis of the joint in the description")
        };
        let first = self.order.iter().enumerate().position(|(j, of)| *of != (j, 1.0)).unwrap_or(0);
        let severity = if self.is_certain { Severity::Error } else { Severity::Warning };
        Finding::new(code, &log.name, text, help).in_column(format!("q_{}", name(first))).as_bad_as(severity)
    }
}

/// A log read in other ways.
struct Readings<'e> {
    estimate: &'e Estimate<'e>,
    gains: &'e [f64],
    /// Some of its samples, without delays.
    parts: Vec<Piece>,
    /// Of the rows of the log as it is; none: all have the same.
    weights: Vec<f64>,
}

/// A reading and its fit.
struct Fitted {
    sides: Sides,
    fit: Fit,
}

impl Fitted {
    fn residuals(&self) -> Vec<f64> {
        let n = self.sides.joints();
        self.sides.trial(&(0..n).collect::<Vec<_>>()).residuals(&vec![1.0; n], &self.fit.x)
    }
}

impl<'e> Readings<'e> {
    fn new(estimate: &'e Estimate<'e>, gains: &'e [f64], states: usize) -> Readings<'e> {
        let all: usize = estimate.pieces.iter().map(|piece| piece.kept.len()).sum();
        let step = (all / states).max(1);
        let parts = estimate.pieces.iter().map(|piece| piece.part(&estimate.delays, &estimate.velocities, step)).collect();
        Readings { estimate, gains, parts, weights: Vec::new() }
    }

    /// The log as it is.
    fn same(&self) -> Order {
        (0..self.gains.len()).map(|j| (j, 1.0)).collect()
    }

    /// Takes Huber's weights of the log as it is: a few reversals at the wrong sample would hide all else.
    fn weigh(&mut self) {
        let n = self.gains.len();
        let residuals = self.fitted(&self.same(), true).residuals();
        let of = |j: usize| residuals.iter().skip(j).step_by(n).filter(|x| **x != 0.0).copied().collect::<Vec<_>>();
        let spreads: Vec<f64> = (0..n).map(|j| 1.5 * spread(&of(j))).collect();
        self.weights = residuals.iter().enumerate().map(|(k, x)| (spreads[k % n] / x.abs()).min(1.0)).collect();
    }

    /// All orders that differ from one by an exchange, then all that differ by a sign.
    fn changes(from: &Order) -> Vec<Order> {
        let n = from.len();
        let exchange = |(i, k): (usize, usize)| {
            let mut order = from.clone();
            order.swap(i, k);
            order
        };
        let turn = |j: usize| {
            let mut order = from.clone();
            order[j].1 *= -1.0;
            order
        };
        (0..n).flat_map(|i| (i + 1..n).map(move |k| (i, k))).map(exchange).chain((0..n).map(turn)).collect()
    }

    fn fitted(&self, order: &Order, whole: bool) -> Fitted {
        let (estimate, n) = (self.estimate, order.len());
        let torque = |j: usize| {
            let (of, sign) = order[j];
            if whole {
                (of, sign * self.gains[j] / self.gains[of])
            } else {
                (j, 1.0)
            }
        };
        let torques: Vec<(usize, f64)> = (0..n).map(torque).collect();
        let pieces: Vec<Piece> = self.parts.iter().map(|part| part.exchanged(estimate.arm, order, &torques)).collect();
        let mut other = Estimate { pieces: &pieces, along_reference: None, delays: vec![0.0; n], ..estimate.clone() };
        other.seeks_delay.fill(false);
        // Load friction takes g of the fit itself.
        let is_load = |place: &usize| matches!(other.columns[*place], Column::Friction(_, _, Friction::Load));
        let has_load = other.active.iter().any(is_load);
        let weights: Vec<f64> = (0..self.weights.len()).map(|k| self.weights[k - k % n + order[k % n].0]).collect();
        let mut found: Option<Fitted> = None;
        for _ in 0..if has_load { 2 } else { 1 } {
            if has_load {
                other.renew_sizes();
            }
            let sides = Sides::new(&other, &weights);
            let fit = sides.trial(&(0..n).collect::<Vec<_>>()).plain();
            other.take(&fit.x);
            found = Some(Fitted { sides, fit });
        }
        found.expect("a round")
    }
}

/// Whether each joint has its own states, perhaps with the other sign.
fn is_turned(order: &Order) -> bool {
    order.iter().enumerate().all(|(j, of)| of.0 == j)
}

/// Joints that an order changes.
fn moved(from: &Order, to: &Order) -> Vec<usize> {
    (0..from.len()).filter(|&j| from[j] != to[j]).collect()
}

/// A reading that explains the log better than by chance with all friction that was found: a weak coupling of joints shows their signs only where
/// nothing else is left.
pub fn again(estimate: &Estimate<'_>, log: &Log, gains: &[f64], findings: &mut Findings) {
    let n = estimate.arm.dof();
    let rough = Readings::new(estimate, gains, STATES[0]);
    let same = rough.same();
    let before = rough.fitted(&same, true).fit.cost;
    let near: Vec<Order> =
        Readings::changes(&same).into_iter().filter(|order| rough.fitted(order, true).fit.cost < FAR * before).collect();
    if near.is_empty() {
        return;
    }
    let mut fine = Readings::new(estimate, gains, STATES[1]);
    fine.weigh();
    let own = fine.fitted(&same, true);
    let left = own.residuals();
    let mut better: Vec<(f64, Order, Vec<f64>)> = Vec::new();
    for order in near {
        let of = fine.fitted(&order, true);
        let after = of.residuals();
        let gain = Gain::of(&own.sides.equations, &left, &after, &moved(&same, &order), n);
        if gain.sum > (CHANCE[1] * gain.error).max(0.01 * gain.left) {
            better.push((of.fit.cost, order, after));
        }
    }
    better.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut better = better.into_iter();
    let Some((cost, order, rest)) = better.next() else { return };
    let as_well = better.filter(|(_, _, other)| {
        let gain = Gain::of(&own.sides.equations, other, &rest, &[], n);
        gain.sum < 3.0 * gain.error
    });
    let as_well = as_well.map(|(_, order, _)| order).collect();
    let fall = cost / own.fit.cost;
    let reading = Reading { order, as_well, whole: true, fall, is_certain: false, by_inertias: false };
    findings.push(reading.told(estimate.arm, log));
}

/// The reading that explains most, where it explains more than the log as it is.
pub(super) fn reading(estimate: &Estimate<'_>, gains: &[f64]) -> Option<Reading> {
    let n = estimate.arm.dof();
    let readings = Readings::new(estimate, gains, STATES[0]);
    let same = readings.same();
    let own = readings.fitted(&same, true);
    let (before, left) = (own.fit.cost, own.residuals());
    let equations = &own.sides.equations;
    let mut found: Option<Reading> = None;
    for whole in [true, false] {
        let mut from = same.clone();
        let (mut least, mut rest) = (before, left.clone());
        let mut is_certain = true;
        let mut as_well: Vec<Order> = Vec::new();
        // From the best change on, changes that help further.
        loop {
            let cost = |order: Order| (readings.fitted(&order, whole).fit.cost, order);
            let mut tried: Vec<(f64, Order)> = Readings::changes(&from).into_iter().map(cost).collect();
            tried.retain(|(cost, _)| *cost < least);
            tried.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut tried = tried.into_iter();
            let Some((mut cost, mut other)) = tried.next() else { break };
            let mut after = readings.fitted(&other, whole).residuals();
            let joints = moved(&from, &other);
            let is_first = from == same;
            if !is_better(equations, &rest, &after, &joints, n) {
                // A sign that fits better than by chance is worth a word, before anything else was found.
                let gain = Gain::of(equations, &rest, &after, &joints, n);
                if is_first && is_turned(&other) && gain.sum > (CHANCE[0] * gain.error).max(0.01 * gain.left) {
                    (least, from, is_certain) = (cost, other, false);
                }
                break;
            }
            as_well.clear();
            if is_first {
                let is_as_good = |(_, order): &(f64, Order)| {
                    let gain = Gain::of(equations, &readings.fitted(order, whole).residuals(), &after, &[], n);
                    gain.sum < 3.0 * gain.error
                };
                let mut as_good: Vec<(f64, Order)> = tried.filter(is_as_good).collect();
                // A sign is turned more often than joints are exchanged.
                if let Some(turned) = as_good.iter_mut().find(|(_, order)| is_turned(order)).filter(|_| !is_turned(&other)) {
                    after = readings.fitted(&turned.1, whole).residuals();
                    std::mem::swap(&mut turned.0, &mut cost);
                    std::mem::swap(&mut turned.1, &mut other);
                }
                as_well.extend(as_good.into_iter().map(|(_, order)| order));
            }
            (least, from, rest) = (cost, other, after);
        }
        let fall = least / before;
        if from != same && found.as_ref().is_none_or(|found| fall < found.fall) {
            found = Some(Reading { order: from, as_well, whole, fall, is_certain, by_inertias: false });
        }
    }
    if found.as_ref().is_some_and(|found| found.is_certain) {
        return found;
    }
    // A slide and a turn about one axis that hardly act on others fit in both orders.
    let sides = &own.sides;
    let nominal = &estimate.arm.combination * estimate.arm.nominal();
    let of_description = nalgebra::DVector::from_fn(sides.active.len(), |k, _| match estimate.columns[sides.active[k]] {
        Column::Base(base) => nominal[base],
        _ => 0.0,
    });
    let first = sides.inequalities.nrows() - n;
    let expected = (&sides.inequalities * of_description).rows(first, n).into_owned();
    // How far inertias are from those of the description, with the benefit of a doubt.
    let away = |of: &Fitted, doubt: &dyn Fn(usize) -> f64, joints: [usize; 2]| -> f64 {
        let inertias = (&of.sides.inequalities * &of.fit.x).rows(first, n).into_owned();
        let nearest = |j: usize| expected[j].clamp(inertias[j] - doubt(j), inertias[j] + doubt(j));
        joints.iter().map(|&j| (nearest(j).max(1e-9 * expected[j]) / expected[j]).ln().abs()).sum()
    };
    let trial = sides.trial(&(0..n).collect::<Vec<_>>());
    let mean_square = before / equations.rows.iter().filter(|row| row.counts).count().max(1) as f64;
    let doubt = |j: usize| DOUBT * (mean_square * trial.dual[(first + j, first + j)].max(0.0)).sqrt();
    let by_inertias = |order: &Order| {
        let &[i, k] = moved(&same, order).as_slice() else { return None };
        if expected[i] <= 0.0 || expected[k] <= 0.0 {
            return None;
        }
        let kind = usize::from(estimate.arm.joints[i].slides == estimate.arm.joints[k].slides);
        let of = readings.fitted(order, true);
        let nearer = away(&own, &doubt, [i, k]) - away(&of, &|_| 0.0, [i, k]);
        (of.fit.cost < AS_GOOD[kind] * before && nearer > NEARER[kind].ln()).then(|| Reading {
            order: order.clone(),
            as_well: Vec::new(),
            whole: true,
            fall: of.fit.cost / before,
            is_certain: kind == 0,
            by_inertias: true,
        })
    };
    let mut by_inertias: Vec<Reading> = Readings::changes(&same).iter().filter_map(by_inertias).collect();
    by_inertias.sort_by_key(|reading| !reading.is_certain);
    by_inertias.into_iter().next().or(found)
}
