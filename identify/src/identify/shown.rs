//! What logs show of an arm, and what they do not, in words.

use std::collections::BTreeSet;

use nalgebra::DMatrix;

use crate::arm::Arm;
use crate::estimate::{Column, Estimate};
use crate::fit::Solution;
use crate::options::Options;
use crate::prepare::Friction;

/// Names of a direction, and the direction in words.
type Direction = (Vec<String>, String);

/// What logs do not show.
pub(super) struct Unshown {
    /// Directions, in words.
    pub(super) directions: Vec<Direction>,
    /// For each active column whether it is part of one.
    pub(super) hidden: Vec<bool>,
    /// Names of the base parameters of directions that are not shown while joints are locked.
    pub(super) of_locked: BTreeSet<String>,
}

impl Unshown {
    /// What the file keeps since joints are locked, in words.
    pub(super) fn kept(&self, without: &[String]) -> Option<String> {
        let names: Vec<&str> = self.of_locked.iter().map(String::as_str).collect();
        let (locked, names) = (without.join(", "), names.join(", "));
        (!self.of_locked.is_empty())
            .then(|| format!("without {locked}, the logs do not show {names} in full: they keep of the file what is missing"))
    }
}

/// Directions that the logs do not show.
pub(super) fn unshown(estimate: &Estimate<'_>, solution: &Solution, matrix: &DMatrix<f64>, is_locked: bool) -> Unshown {
    let arm = estimate.arm;
    let name = |k: usize| column_name(estimate, k);
    let mut hidden = vec![false; estimate.active.len()];
    let mut found = Vec::new();
    let mut of_locked = BTreeSet::new();
    for direction in &solution.hidden {
        let largest = direction.amax();
        let parts: Vec<usize> = (0..direction.len()).filter(|&k| direction[k].abs() > 0.1 * largest).collect();
        parts.iter().for_each(|&k| hidden[k] = true);
        let names: Vec<String> = parts.iter().map(|&k| name(k)).collect();
        if is_locked && parts.iter().all(|&k| matches!(estimate.columns[estimate.active[k]], Column::Base(_))) {
            of_locked.extend(names);
            continue;
        }
        let words = parts.iter().map(|&k| format!("{:+.2} {}", direction[k] / largest, name(k))).collect::<Vec<_>>().join(" ");
        found.push((names, format!("{words} (each over the size of its column)")));
    }
    // A base parameter that is known worse than ten times the size of such bodies is not shown either.
    let size = |column: usize| {
        let (link, k) = (column / 10, column % 10);
        if link >= arm.links.len() {
            return f64::INFINITY;
        }
        let mass = arm.links[link].own[0].max(0.1);
        let length = arm.links[link].ends.iter().fold(0.1, |length: f64, end| length.max(end.norm()));
        mass * [1.0, length, length * length][usize::from(k > 0) + usize::from(k > 3)]
    };
    for k in 0..estimate.active.len() {
        let Column::Base(base) = estimate.columns[estimate.active[k]] else { continue };
        let row = arm.combination.row(base);
        let reference: f64 = row.iter().enumerate().filter(|(_, t)| **t != 0.0).map(|(column, t)| t.abs() * size(column)).sum();
        let sigma = matrix[(k, k)].max(0.0).sqrt();
        if !hidden[k] && sigma > 10.0 * reference {
            hidden[k] = true;
            found.push((
                vec![name(k)],
                format!("{}: its sigma {sigma:.3e} is more than ten times the size of such bodies", name(k)),
            ));
        }
    }
    Unshown { directions: found, hidden, of_locked }
}

/// The name of an active column.
pub(super) fn column_name(estimate: &Estimate<'_>, k: usize) -> String {
    let arm = estimate.arm;
    match estimate.columns[estimate.active[k]] {
        Column::Base(base) => arm.base[base].name.clone(),
        Column::Load(log, k) => format!("{} of the load of log {}", crate::body::NAMES[k], log + 1),
        Column::Friction(_, j, term) => format!("{}.friction.{}", arm.joints[j].name, term.key()),
        Column::Gain(j) => format!("{}.motor.gain", arm.joints[j].name),
        Column::Delay(j) => format!("the delay of {}", arm.joints[j].name),
    }
}

/// Terms of friction that no motion tells from other parameters, as far as they are asked for or have a value.
pub(super) fn inseparable(arm: &Arm, options: &Options) -> Vec<String> {
    let asked = |term: Friction| match &options.friction {
        Some(listed) => listed.contains(&term),
        None => term == Friction::Offset,
    };
    let mut all = Vec::new();
    for of in &arm.dependent {
        let (joint, term) = (&arm.joints[of.joint], Friction::ALL[of.term]);
        let value = joint.friction[of.term].unwrap_or(0.0);
        let (base, friction) = &of.on;
        if value == 0.0 && !asked(term) {
            continue;
        }
        let name = |joint: usize, term: usize| format!("{}.friction.{}", arm.joints[joint].name, Friction::ALL[term].key());
        let others = base.iter().map(|&k| arm.base[k].name.clone()).chain(friction.iter().map(|&(j, k)| name(j, k)));
        let others: Vec<String> = others.collect();
        let own = name(of.joint, of.term);
        all.push(if others.is_empty() {
            format!("{own} exerts no torque in any motion; it keeps {value}")
        } else {
            format!("no motion tells {own} from {}; it keeps {value}, and the others are found beside it", others.join(", "))
        });
    }
    all
}
