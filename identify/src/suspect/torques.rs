//! Torques and states under other signs or other joints: the fit that bodies and friction allow is compared.
//!
//! A joint whose torque is turned fits without the inequalities, too: with them its friction would have to drive it.

use crate::estimate::Estimate;
use crate::finding::{Code, Finding, Findings};
use crate::log::Log;

use super::sides::{is_better, Fit, Sides, Trial};
use super::states::reading;

/// Joints whose signs are tried in all patterns.
const SIGNS: usize = 10;

/// A fit that another order or another sign makes clearly better; that is reported, and whether it was.
pub fn torques(estimate: &Estimate<'_>, log: &Log, gains: &[f64], findings: &mut Findings) -> bool {
    let n = estimate.arm.dof();
    let same: Vec<usize> = (0..n).collect();
    let ones = vec![1.0; n];
    let sides = Sides::new(estimate, &[]);
    let own = sides.trial(&same);
    let before = own.plain();
    let left = own.residuals(&ones, &before.x);
    let clearly = |trial: &Trial<'_>, signs: &[f64], fit: &Fit, joints: &[usize]| {
        is_better(&sides.equations, &left, &trial.residuals(signs, &fit.x), joints, n)
    };
    let name = |i: usize| estimate.arm.joints[i].name.as_str();
    let mut best: Option<(Fit, Vec<f64>)> = None;
    for flips in 1u32..1 << n.min(SIGNS) {
        let signs: Vec<f64> = (0..n).map(|j| if j < SIGNS && flips >> j & 1 == 1 { -1.0 } else { 1.0 }).collect();
        let fit = own.fit(&signs);
        if fit.cost < best.as_ref().map_or(before.cost, |(best, _)| best.cost) {
            best = Some((fit, signs));
        }
    }
    let mut orders: Option<(Fit, Vec<usize>)> = None;
    // From the best exchange on, exchanges that help further.
    loop {
        let from = orders.as_ref().map_or_else(|| same.clone(), |(_, order)| order.clone());
        let start = orders.as_ref().map_or(before.cost, |(fit, _)| 0.999 * fit.cost);
        let mut next: Option<(Fit, Vec<usize>)> = None;
        for i in 0..n {
            for k in i + 1..n {
                let mut order = from.clone();
                order.swap(i, k);
                let fit = sides.trial(&order).plain();
                if fit.cost < next.as_ref().map_or(start, |(best, _)| best.cost) {
                    next = Some((fit, order));
                }
            }
        }
        let Some(next) = next else { break };
        orders = Some(next);
    }
    let mut reading = reading(estimate, gains);
    let found = |fit: Option<&Fit>| fit.map_or(1.0, |fit| fit.cost / before.cost);
    let least = found(best.as_ref().map(|(fit, _)| fit)).min(found(orders.as_ref().map(|(fit, _)| fit)));
    if let Some(reading) = reading.take_if(|reading| reading.is_clear(least)) {
        findings.push(reading.told(estimate.arm, log));
        return true;
    }
    // Of both that which explains more.
    if let (Some((turned, _)), Some((ordered, _))) = (&best, &orders) {
        if ordered.cost < turned.cost {
            best = None;
        } else {
            orders = None;
        }
    }
    if let Some((fit, signs)) = best {
        let turned: Vec<usize> = (0..n).filter(|&j| signs[j] < 0.0).collect();
        if clearly(&own, &signs, &fit, &turned) {
            let fall = 100.0 * (fit.cost / before.cost).sqrt();
            let columns: Vec<String> = turned.iter().map(|&j| log.effort_column(name(j))).collect();
            let (which, column) = match columns.as_slice() {
                all if all.len() == n && n > 1 => ("all torques".to_owned(), String::new()),
                [first, ..] => (columns.join(", "), first.clone()),
                [] => return false,
            };
            let text = format!(
                "the sign of {which} is turned: the residual that friction and inertia above 0 allow falls to {fall:.0} %"
            );
            let help = "torques act from the link before on the link behind, along the joint axis: turn the sign, or the axis";
            findings.push(Finding::new(Code::SignSuspected, &log.name, text, help).in_column(column));
            return true;
        }
    }
    if let Some((fit, order)) = orders {
        let moved: Vec<usize> = (0..n).filter(|&j| order[j] != j).collect();
        if clearly(&sides.trial(&order), &ones, &fit, &moved) {
            let words = |&j: &usize| format!("{} is that of {}", log.effort_column(name(order[j])), name(j));
            let fall = 100.0 * (fit.cost / before.cost).sqrt();
            let text = format!(
                "the residual falls to {fall:.0} % in another order: {}",
                moved.iter().map(words).collect::<Vec<_>>().join(", ")
            );
            let help = "rename the columns under `columns` of the options";
            let column = log.effort_column(name(moved[0]));
            findings.push(Finding::new(Code::JointOrder, &log.name, text, help).in_column(column));
            return true;
        }
    }
    reading.is_some_and(|reading| {
        findings.push(reading.told(estimate.arm, log));
        reading.is_certain
    })
}
