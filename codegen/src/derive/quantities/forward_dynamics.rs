//! Forward dynamics: ddq = B^-1 (tau - C dq - F - g), by factors of B.

use super::inertia::inertia_matrix;
use super::load_friction::add_load_friction;
use crate::derive::arm::Arm;
use crate::derive::factors::LdlFactors;
use crate::derive::motion::Motion;
use crate::derive::newton_euler::inverse_dynamics;
use crate::derive::passes::RewriteScope;
use crate::derive::plan::Plan;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::ring::{ExprId, Pool, Symbol};

/// ddq(q, dq, tau).
pub static FORWARD_DYNAMICS: Quantity = Quantity {
    name: "forward_dynamics",
    symbol: Typeset::new("ddq(q, dq, tau)", "\\ddot q(q, \\dot q, \\tau)"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq, Argument::Tau],
    result: &[ResultPart::whole(
        Typeset::new("ddq(q, dq, tau)", "\\ddot q(q, \\dot q, \\tau)"),
        Typeset::new("ddq", "\\ddot q"),
        &[Length::Dof],
        "rad/s² or m/s²",
    )],
    structure: None,
    has_parameters: true,
    documentation: Documentation {
        failure: ["cannot fail", "not finite where B is singular"],
        ..Documentation::new(
            "Accelerations that torques cause, friction included.",
            "ddq = B(q)^-1 (tau - C(q, dq) dq - F(dq) - g(q))                    (Siciliano et al., Sect. 7.6)",
            "an acceleration for each joint, rad/s² (revolute) or m/s² (prismatic).",
        )
        .with(Feature::LoadFriction, "F is {friction} and {load_friction} together.")
    },
    recursion: Recursion {
        in_coordinates: true,
        ..Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| forward_dynamics(pool, arm, plan))
    },
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Dynamics"),
};

/// ddq(q, dq, tau).
pub fn forward_dynamics(pool: &mut Pool, arm: &Arm, plan: &mut Plan) -> Vec<ExprId> {
    let b = inertia_matrix(pool, arm, plan);
    let b = arm.project_matrix(pool, b);
    let motion = Motion::unaccelerated(pool, arm);
    let mut bias = inverse_dynamics(pool, arm, &motion);
    add_load_friction(pool, arm, plan, &mut bias);
    let bias = arm.project(pool, bias);
    let torque = |pool: &mut Pool, (i, bias): (u16, ExprId)| {
        let tau = pool.symbol(Symbol::Torque(i));
        pool.sub(tau, bias)
    };
    let right: Vec<ExprId> = (0..).zip(bias).map(|entry| torque(pool, entry)).collect();
    LdlFactors::of_inertia_under_gravity(pool, arm, &b).solve(pool, &right)
}
