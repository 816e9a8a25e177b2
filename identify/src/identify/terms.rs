//! Which terms of friction each joint has, and delays, which they hide.

use crate::estimate::{Estimate, From};
use crate::finding::{Code, Finding, Findings};
use crate::log::Log;
use crate::options::Options;
use crate::prepare::Friction;

/// Terms of friction that every joint may have.
pub(super) const SIMPLE: [Friction; 3] = [Friction::Viscous, Friction::Coulomb, Friction::Offset];

/// The terms of friction of each joint that are there before any is chosen.
pub(super) fn first_terms(estimate: &Estimate<'_>, options: &Options) -> Vec<Vec<Friction>> {
    vec![options.friction.clone().unwrap_or_else(|| SIMPLE.to_vec()); estimate.arm.dof()]
}

/// The terms of friction of each joint: those of the options, or those that cross-validation chooses. The estimate has them.
pub(super) fn chosen_terms(estimate: &mut Estimate<'_>, options: &Options) -> Vec<Vec<Friction>> {
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
pub(super) fn settled_delays(
    estimate: &mut Estimate<'_>,
    terms: &mut [Vec<Friction>],
    options: &Options,
) -> Vec<Option<[f64; 2]>> {
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
pub(super) fn settled(estimate: &mut Estimate<'_>, from: From) -> Vec<Option<[f64; 2]>> {
    let errors = estimate.settle(from);
    if estimate.leave_undetermined_delays(&errors) {
        return estimate.settle(From::Near);
    }
    errors
}

/// A finding for each delay that was found at the end of those that are tried.
pub(super) fn last_delays(estimate: &Estimate<'_>, log: &Log, findings: &mut Findings) {
    for (joint, delay) in estimate.arm.joints.iter().zip(&estimate.delays).filter(|(_, delay)| Estimate::is_last_delay(**delay)) {
        let text = format!("the delay of joint `{}`, {:.1} ms, is at the end of its range", joint.name, 1e3 * delay);
        let help = "bring the stamps of torques and positions together, or give `delay` in the options; noise of positions leads here, too: log rates (`dq_JOINT`)";
        findings.push(Finding::new(Code::DelayAtLimit, &log.name, text, help).in_column(log.effort_column(&joint.name)));
    }
}
