//! Passes that rewrite an arm into one that moves alike and costs less: `Arm` -> `Arm`, each an exact identity.

mod grouping;
mod last_link;
mod orientation;
mod unit;

use std::collections::BTreeSet;

use super::arm::Arm;
use super::plan::Plan;
use crate::pass::Pass;
use crate::ring::Pool;
pub(crate) use last_link::{angle_of_last_link, rotate_last_link};

/// Which passes may rewrite the arm for a derivation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RewriteScope {
    /// Motion and forces; the parameters of the links are numbers and may be mixed.
    Dynamics,
    /// Motion and forces; the parameters of the links are symbols, or the potential energy is needed, whose constant grouping drops.
    KeepParameters,
    /// Frames, and columns of parameters that stay in them.
    Frames,
}

/// With more different roots than this among its constants an arm keeps the plain ways: each root may double the terms of a divisor.
const ROOTS: usize = 3;

/// Disables the passes that compare and divide the constants of an arm, where these have no short canonical form: where sines and cosines
/// of general angles are among them (two expressions of those may be equal and differ in form), or many roots.
pub fn disable_unsuitable(pool: &Pool, arm: &Arm, plan: &mut Plan) {
    let joints = arm.joints.iter().flat_map(|joint| {
        let vectors = joint.fixed.into_iter().chain([joint.origin, joint.body.first]).flatten();
        vectors.chain(joint.body.second).chain([joint.body.mass])
    });
    let mut roots = BTreeSet::new();
    let short = joints.chain(arm.gravity).all(|entry| {
        pool.as_constant(entry).is_none_or(|number| {
            let reduced = number.is_reduced();
            roots.extend(number.terms().flat_map(|(monomial, _)| monomial.iter().map(|(atom, _)| atom.clone())));
            reduced && roots.len() <= ROOTS
        })
    });
    if !short {
        [Pass::OriginAlongAxis, Pass::GroupingAmount, Pass::LastLinkRotation, Pass::UnitOfLength]
            .into_iter()
            .for_each(|pass| plan.disable(pass));
    }
}

/// The arm after all passes, in the ways that the plan takes.
pub fn rewrite(pool: &mut Pool, arm: &mut Arm, plan: &mut Plan, scope: RewriteScope) {
    match scope {
        RewriteScope::Dynamics => {
            last_link::rotate(pool, arm, plan);
            grouping::group(pool, arm, plan);
            unit::unit_of_length(pool, arm, plan);
        }
        RewriteScope::Frames => grouping::choose_origins(pool, arm, plan),
        RewriteScope::KeepParameters => {}
    }
    orientation::parallel_axes(pool, arm, plan);
}
