//! States, or states and torques, under other joints or with other signs: each such reading of a log is fitted and compared.
//!
//! A joint that is turned in position, rate and torque alike has the friction of the true joint; what it does to other joints, and what
//! gravity does to it, tells. An exchange of two joints that hardly act on others may fit as well: then their inertias tell.

use armgen_codegen::diagnostic::Severity;

use super::sides::{is_better, Fit, Gain, Sides};
use crate::arm::Arm;
use crate::estimate::{Column, Estimate};
use crate::finding::{Code, Finding};
use crate::log::Log;
use crate::prepare::Piece;

/// States that readings are compared by.
const STATES: usize = 400;

/// How many times two inertias together are nearer to the description in the other order, where the fit does not tell.
const NEARER: f64 = 20.0;

/// A fit as good as another has squares below these times its.
const AS_GOOD: f64 = 1.1;

/// An inertia may be off by so many standard errors of white residuals.
const DOUBT: f64 = 10.0;

/// Joints under other names or with other signs.
pub(super) struct Reading {
    order: Vec<usize>,
    /// Of the states.
    signs: Vec<f64>,
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
        let is_turned = self.order.is_sorted();
        self.is_certain && !self.by_inertias && self.fall < if is_turned { 0.5 * least } else { least }
    }

    /// Whether it is worth a word where nothing else is clear.
    pub(super) fn is_left(&self) -> bool {
        self.by_inertias || !self.is_certain
    }

    pub(super) fn told(&self, arm: &Arm, log: &Log) -> Finding {
        let n = self.order.len();
        let name = |i: usize| arm.joints[i].name.as_str();
        let columns = |j: usize| {
            let (rate, effort) = (format!("dq_{}", name(j)), log.effort_column(name(j)));
            let columns = [Some(format!("q_{}", name(j))), log.dq.as_ref().map(|_| rate), self.whole.then_some(effort)];
            columns.into_iter().flatten().collect::<Vec<_>>().join(", ")
        };
        let fall = format!("the residual falls to {:.0} %", 100.0 * self.fall.sqrt());
        // The columns under a name are those of the joint whose states they fit.
        let moved: Vec<usize> = (0..n).filter(|&j| self.order[j] != j).collect();
        let turned: Vec<usize> = (0..n).filter(|&j| self.signs[j] < 0.0).collect();
        let others = moved.iter().map(|&j| format!("{} hold those of {}", columns(j), name(self.order[j])));
        let with = if self.by_inertias { "inertias come near those of the description".to_owned() } else { fall };
        let (code, text, help, first) = match (moved.first(), turned.first()) {
            (Some(&first), _) => {
                let text = format!("{with} with other joints: {}", others.collect::<Vec<_>>().join("; "));
                (Code::JointOrder, text, "rename the columns under `columns` of the options", first)
            }
            (None, first) => {
                let all: Vec<String> = turned.iter().map(|&j| columns(j)).collect();
                let text = format!("{with} with the other sign of {}", all.join(", "));
                let help = "turn the sign of these columns, or the axis of the joint in the description";
                (Code::SignSuspected, text, help, first.copied().unwrap_or(0))
            }
        };
        let severity = if self.is_certain { Severity::Error } else { Severity::Warning };
        Finding::new(code, &log.name, text, help).in_column(format!("q_{}", name(first))).as_bad_as(severity)
    }
}

/// The reading that explains most, where it explains more than the log as it is.
pub(super) fn reading(estimate: &Estimate<'_>, gains: &[f64]) -> Option<Reading> {
    let n = estimate.arm.dof();
    let same: (Vec<usize>, Vec<f64>) = ((0..n).collect(), vec![1.0; n]);
    let all: usize = estimate.pieces.iter().map(|piece| piece.kept.len()).sum();
    let step = (all / STATES).max(1);
    let sides = |(order, signs): &(Vec<usize>, Vec<f64>), whole: bool| {
        let torque = |j: usize| if whole { (order[j], signs[j] * gains[j] / gains[order[j]]) } else { (j, 1.0) };
        let torques: Vec<(usize, f64)> = (0..n).map(torque).collect();
        let pieces: Vec<Piece> =
            estimate.pieces.iter().map(|piece| piece.exchanged(estimate.arm, order, signs, &torques, step)).collect();
        Sides::new(&Estimate {
            pieces: &pieces,
            along_reference: None,
            delays: vec![0.0; n],
            sizes: vec![Vec::new(); pieces.len()],
            ..estimate.clone()
        })
    };
    let own = sides(&same, true);
    let before = own.trial(&same.0).plain();
    let left = own.trial(&same.0).residuals(&same.1, &before.x);
    let pairs = || (0..n).flat_map(|i| (i + 1..n).map(move |k| (i, k)));
    let exchange = |(order, signs): &(Vec<usize>, Vec<f64>), (i, k): (usize, usize)| {
        let (mut order, mut signs) = (order.clone(), signs.clone());
        order.swap(i, k);
        signs.swap(i, k);
        (order, signs)
    };
    let mut found: Option<Reading> = None;
    for whole in [true, false] {
        let mut from = same.clone();
        let (mut least, mut rest) = (before.cost, left.clone());
        let mut is_certain = true;
        // From the best change on, changes that help further.
        loop {
            let turns = (0..n).map(|j| {
                let mut next = from.clone();
                next.1[j] *= -1.0;
                next
            });
            let mut next: Option<(f64, (Vec<usize>, Vec<f64>))> = None;
            for other in pairs().map(|pair| exchange(&from, pair)).chain(turns) {
                let cost = sides(&other, whole).trial(&same.0).plain().cost;
                if cost < next.as_ref().map_or(least, |(cost, _)| *cost) {
                    next = Some((cost, other));
                }
            }
            let Some((cost, other)) = next else { break };
            let of = sides(&other, whole);
            let trial = of.trial(&same.0);
            let after = trial.residuals(&same.1, &trial.plain().x);
            let moved: Vec<usize> = (0..n).filter(|&j| other.0[j] != from.0[j] || other.1[j] != from.1[j]).collect();
            if !is_better(&own.equations, &rest, &after, &moved, n) {
                // A sign that fits better than by chance is worth a word, before anything else was found.
                let gain = Gain::of(&own.equations, &rest, &after, &moved, n);
                if from == same && other.0 == same.0 && gain.sum > (4.0 * gain.error).max(0.01 * gain.left) {
                    (least, from, is_certain) = (cost, other, false);
                }
                break;
            }
            (least, from, rest) = (cost, other, after);
        }
        let fall = least / before.cost;
        if from != same && found.as_ref().is_none_or(|found| fall < found.fall) {
            let (order, signs) = from;
            found = Some(Reading { order, signs, whole, fall, is_certain, by_inertias: false });
        }
    }
    if found.as_ref().is_some_and(|found| found.is_certain) {
        return found;
    }
    // A slide and a turn about one axis that hardly act on others fit in both orders.
    let nominal = &estimate.arm.combination * estimate.arm.nominal();
    let of_description = nalgebra::DVector::from_fn(own.active.len(), |k, _| match estimate.columns[own.active[k]] {
        Column::Base(base) => nominal[base],
        _ => 0.0,
    });
    let first = own.inequalities.nrows() - n;
    let expected = (&own.inequalities * of_description).rows(first, n).into_owned();
    // How far inertias are from those of the description, with the benefit of a doubt.
    let away = |sides: &Sides, fit: &Fit, doubt: &dyn Fn(usize) -> f64, joints: [usize; 2]| -> f64 {
        let inertias = (&sides.inequalities * &fit.x).rows(first, n).into_owned();
        let nearest = |j: usize| expected[j].clamp(inertias[j] - doubt(j), inertias[j] + doubt(j));
        joints.iter().map(|&j| (nearest(j).max(1e-9 * expected[j]) / expected[j]).ln().abs()).sum()
    };
    let trial = own.trial(&same.0);
    let mean_square = before.cost / own.equations.rows.iter().filter(|row| row.counts).count().max(1) as f64;
    let doubt = |j: usize| DOUBT * (mean_square * trial.dual[(first + j, first + j)].max(0.0)).sqrt();
    let differ = |&(i, k): &(usize, usize)| estimate.arm.joints[i].slides != estimate.arm.joints[k].slides;
    let are_given = |&(i, k): &(usize, usize)| expected[i] > 0.0 && expected[k] > 0.0;
    let by_inertias = pairs().filter(differ).filter(are_given).find_map(|(i, k)| {
        let other = exchange(&same, (i, k));
        let of = sides(&other, true);
        let fit = of.trial(&same.0).plain();
        let nearer = away(&own, &before, &doubt, [i, k]) - away(&of, &fit, &|_| 0.0, [i, k]);
        (fit.cost < AS_GOOD * before.cost && nearer > NEARER.ln()).then(|| Reading {
            order: other.0,
            signs: other.1,
            whole: true,
            fall: fit.cost / before.cost,
            is_certain: true,
            by_inertias: true,
        })
    });
    by_inertias.or(found)
}
