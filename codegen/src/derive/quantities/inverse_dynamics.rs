//! Inverse dynamics by Newton and Euler's equations: tau = B ddq + C dq + F + g.

use super::load_friction::add_load_friction;
use crate::derive::motion::Motion;
use crate::derive::newton_euler::inverse_dynamics;
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};

/// tau(q, dq, ddq).
pub static INVERSE_DYNAMICS: Quantity = Quantity {
    name: "inverse_dynamics",
    symbol: Typeset::new("tau(q, dq, ddq)", "\\tau(q, \\dot q, \\ddot q)"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq, Argument::Ddq],
    result: &[ResultPart::whole(
        Typeset::new("tau(q, dq, ddq)", "\\tau(q, \\dot q, \\ddot q)"),
        Typeset::new("tau", "\\tau"),
        &[Length::Dof],
        "N m or N",
    )],
    structure: None,
    has_parameters: true,
    documentation: Documentation::new(
        "Torques that a motion needs, friction included.",
        "tau = B(q) ddq + C(q, dq) dq + F(dq) + g(q)                        (Siciliano et al., eq. 7.42)",
        "a torque, N m (revolute), or a force, N (prismatic), for each joint.",
    )
    .with(Feature::LoadFriction, "F is {friction} and {load_friction} together."),
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| {
        let motion = Motion::plain(pool, arm);
        let mut tau = inverse_dynamics(pool, arm, &motion);
        add_load_friction(pool, arm, plan, &mut tau);
        tau
    }),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Dynamics"),
};
