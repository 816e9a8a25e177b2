//! Friction that grows with the load of a joint: what its gravity torque adds to its dry friction.
//!
//! ```text
//! tau_i = F_l |g_i(q)| sign(dq_i)
//! ∂tau_i/∂q_j = F_l sign(g_i) ∂g_i/∂q_j sign(dq_i),   ∂tau_i/∂dq_j = 0
//! ```
//!
//! F_l >= 0 has no unit. g_i is the entry of g(q), springs included: the torque that the drive holds at rest.
//! |g_i| and sign(g_i) are no polynomials: they are inputs here, and the pool keeps the expression of g_i.
//! The torque is not linear in masses, so the regressors omit it.

use super::gravity::gravity;
use crate::derive::arm::Arm;
use crate::derive::passes::RewriteScope;
use crate::derive::plan::Plan;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::ring::{Elementary, ExprId, Pool, Symbol};

/// F_l |g| sign(dq).
pub static LOAD_FRICTION: Quantity = Quantity {
    name: "load_friction",
    symbol: Typeset::new("F_l(q, dq)", "F_l(q, \\dot q)"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq],
    result: &[ResultPart::whole(
        Typeset::new("F_l(q, dq)", "F_l(q, \\dot q)"),
        Typeset::new("fl", "f_l"),
        &[Length::Dof],
        "N m or N",
    )],
    structure: None,
    has_parameters: true,
    documentation: Documentation {
        names_gravity: true,
        said_missing: false,
        ..Documentation::new(
            "Friction that grows with the load of its joint, beside {friction} on the left of the equation of motion: it has the sign of dq.",
            "F_l,i |g_i(q)| sign(dq_i), sign(0) = 0, F_l,i a number without unit, g_i(q) as {gravity} returns it",
            "a torque, N m (revolute), or a force, N (prismatic), for each joint; 0 where the description has no `load`.",
        )
        .with(Feature::Spring, "What a spring of a joint adds to g_i is part of its load.")
    },
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| {
        let mut torques = vec![ExprId::ZERO; arm.dof()];
        add_load_friction(pool, arm, plan, &mut torques);
        torques
    }),
    missing: |model, with_parameters| {
        let without = || (!model.manipulator.has_load_friction()).then(|| "no joint has friction that grows with its load".into());
        Quantity::MISSING_WITHOUT_MASS(model, with_parameters).or_else(without)
    },
    gathers: &[],
    interface: Some("Dynamics"),
};

/// F_l sign(dq_i) of each joint that has it, and g(q).
fn loaded_joints(pool: &mut Pool, arm: &Arm, plan: &mut Plan) -> (Vec<(usize, ExprId)>, Vec<ExprId>) {
    if arm.joints.iter().all(|joint| joint.load == ExprId::ZERO) {
        return (Vec::new(), Vec::new());
    }
    let g = gravity(pool, arm, plan);
    let mut loaded = Vec::new();
    for (i, joint) in arm.joints.iter().enumerate() {
        if joint.load != ExprId::ZERO && g[i] != ExprId::ZERO {
            pool.set_gravity(i as u16, g[i]);
            let sign = pool.symbol(Symbol::OfRate(Elementary::Sign, i as u16));
            loaded.push((i, pool.mul(joint.load, sign)));
        }
    }
    (loaded, g)
}

/// Adds F_l |g_i| sign(dq_i) to torques.
pub(super) fn add_load_friction(pool: &mut Pool, arm: &Arm, plan: &mut Plan, torques: &mut [ExprId]) {
    for (i, along) in loaded_joints(pool, arm, plan).0 {
        let size = pool.symbol(Symbol::GravitySize(i as u16));
        let torque = pool.mul(along, size);
        torques[i] = pool.add(torques[i], torque);
    }
}

/// Adds F_l sign(g_i) ∂g_i/∂q_j sign(dq_i) to derivatives of torques by joint variables.
pub(super) fn add_load_friction_derivatives(pool: &mut Pool, arm: &Arm, plan: &mut Plan, by_positions: &mut [Vec<ExprId>]) {
    let (loaded, g) = loaded_joints(pool, arm, plan);
    for (i, along) in loaded {
        let sign = pool.symbol(Symbol::GravitySign(i as u16));
        let along = pool.mul(along, sign);
        for j in 0..arm.dof() {
            let slope = pool.partial_derivative(&g[i..=i], j as u16)[0];
            let change = pool.mul(along, slope);
            by_positions[i][j] = pool.add(by_positions[i][j], change);
        }
    }
}
