//! Joints that are locked in all logs.

use crate::arm::Arm;
use crate::finding::{Code, Finding, Findings};
use crate::log::Log;
use crate::signal::median;

/// A locked joint yields by less, rad or m.
const YIELD: f64 = 0.02;

/// Holds locked joints still, and finds those that move.
pub(super) fn hold(arm: &Arm, locked: &[usize], log: &mut Log, findings: &mut Findings) {
    for &j in locked {
        let q = &mut log.q[j];
        let (least, most) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        if most - least > YIELD {
            let name = &arm.joints[j].name;
            let text = format!("joint `{name}` is left out as a locked joint, and moves from {least} to {most}");
            let help = "take it out of `without`";
            findings.push(Finding::new(Code::BadOptions, &log.name, text, help).in_column(format!("q_{name}")));
        }
        let at = median(q);
        q.fill(at);
        log.dq.iter_mut().for_each(|dq| dq[j].fill(0.0));
        log.reference.iter_mut().for_each(|reference| reference[j].fill(at));
    }
}
