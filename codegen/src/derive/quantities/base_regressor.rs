//! The regressor of the base parameters, Y_b(q, dq, ddq): columns of full rank, from `base.rs`.

use crate::derive::base;
use crate::derive::parameters::View;
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::derive::regressor::STARTS;

/// Y_b(q, dq, ddq).
pub static BASE_REGRESSOR: Quantity = Quantity {
    name: "base_regressor",
    symbol: Typeset::new("Y_b(q, dq, ddq)", "Y_b(q, \\dot q, \\ddot q)"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq, Argument::Ddq],
    result: &[ResultPart::whole(Typeset::new("Y_b(q, dq, ddq)", "Y_b(q, \\dot q, \\ddot q)"), Typeset::plain("y_b"), &[Length::Dof, Length::BaseParameters], "Y_b pi_b is a torque")],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Regressor Y_b(q, dq, ddq) of the base parameters: columns of full rank.",
        "B(q) ddq + C(q, dq) dq + F(dq) + g(q) = Y_b pi_b                  (Gautier and Khalil 1990)",
        "`y[joint][base parameter]`, parameters in the order of {BASE_PARAMETER_NAMES}: those of the links in their joint frames, inertias of rotors, \
         viscous and Coulomb friction, as far as the description gives them and they are not 0 at its values. Masses of rotors are part of the links \
         that carry them. With {NOMINAL_BASE_PARAMETERS} it is the torque of {inverse_dynamics}. For identification take {regressor} with \
         `regressor: base` in the description: it has all base parameters, zero or not.",
    )
    .with(Feature::LoadFriction, "Friction that grows with the load is not linear in parameters: the torque of {inverse_dynamics} has {load_friction} besides."),
    recursion: Recursion { view: |model, _| View::Vector(model.base_parameters()), prepare: base::place_frames_for_base_parameters, starts: &STARTS, ..Recursion::new(RewriteScope::Frames, |pool, arm, plan, input| base::base_regressor(pool, arm, input.model.base_parameters(), plan).concat()) },
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("BaseRegressor"),
};
