//! The regressor Y(q, dq, dqr, ddqr) and the known rest: B ddqr + C(q, dq) dqr + F + g = Y pi + tau_known.
//!
//! How its columns are derived is in `derive/regressor.rs`, since the base parameters are found by their rank.

use crate::derive::motion::Motion;
use crate::derive::newton_euler::inverse_dynamics;
use crate::derive::parameters::View;
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::derive::regressor::{regressor_by_plan, STARTS};

/// In the order of the emitted module.
pub(super) static DECLARED: [&Quantity; 2] = [&REGRESSOR, &KNOWN_TORQUE];

/// Y(q, dq, dqr, ddqr): the derivative of tau by the parameters.
pub static REGRESSOR: Quantity = Quantity {
    name: "regressor",
    symbol: Typeset::new("Y(q, dq, dqr, ddqr)", "Y(q, \\dot q, \\dot q_r, \\ddot q_r)"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq, Argument::Dqr, Argument::Ddqr],
    result: &[ResultPart::whole(Typeset::new("Y(q, dq, dqr, ddqr)", "Y(q, \\dot q, \\dot q_r, \\ddot q_r)"), Typeset::plain("y"), &[Length::Dof, Length::Parameters], "Y pi is a torque")],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Regressor Y(q, dq, dqr, ddqr): the dynamics as a linear function of the parameters.",
        "B(q) ddqr + C(q, dq) dqr + F + g(q) = Y pi + tau_known             (Siciliano et al., Sects. 7.2.2 and 8.5.4)",
        "`y[joint][parameter]`, parameters in the order of {PARAMETER_NAMES}. In F viscous friction acts on dqr, Coulomb friction on sign(dq). \
         With dqr = dq and ddqr = ddq this is the regressor of inverse dynamics.",
    )
    .with(Feature::OffsetOrCubic, "In F cubic friction is F_3 dq² dqr.")
    .with(Feature::SmoothFriction, "In F and in the column of F_c smooth friction has tanh(dq / v) in place of sign(dq).")
    .with(Feature::Stribeck, "In F Stribeck friction is F_s sign(dq) exp(-|dq| / v_s), linear in F_s; v_s is a number of the description.")
    .with(Feature::LoadFriction, "Friction that grows with the load is not linear in parameters and not in F: {load_friction} is added to Y pi + tau_known."),
    recursion: Recursion { view: |model, _| View::Vector(&model.parameters), starts: &STARTS, ..Recursion::new(RewriteScope::Frames, |pool, arm, plan, input| regressor_by_plan(pool, arm, &input.model.parameters, plan).concat()) },
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Regressor"),
};

/// tau_known(q, dq, dqr, ddqr): the torque of everything except the parameters.
pub static KNOWN_TORQUE: Quantity = Quantity {
    name: "known_torque",
    symbol: Typeset::new("tau_known(q, dq, dqr, ddqr)", "\\tau_0(q, \\dot q, \\dot q_r, \\ddot q_r)"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq, Argument::Dqr, Argument::Ddqr],
    result: &[ResultPart::whole(
        Typeset::new("tau_known(q, dq, dqr, ddqr)", "\\tau_0(q, \\dot q, \\dot q_r, \\ddot q_r)"),
        Typeset::new("tau_known", "\\tau_0"),
        &[Length::Dof],
        "N m or N",
    )],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "The torque of what is not among the parameters: tau_known of the regressor's equation.",
        "tau_known = B(q) ddqr + C(q, dq) dqr + F + g(q) - Y pi",
        "a torque, N m (revolute), or a force, N (prismatic), for each joint.",
    )
    .with(Feature::LoadFriction, "Friction that grows with the load is not in it: {load_friction}."),
    recursion: Recursion {
        view: |model, _| View::VectorZero(&model.parameters),
        ..Recursion::new(RewriteScope::KeepParameters, |pool, arm, _, _| {
            let motion = Motion::with_reference(pool, arm);
            inverse_dynamics(pool, arm, &motion)
        })
    },
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Regressor"),
};
