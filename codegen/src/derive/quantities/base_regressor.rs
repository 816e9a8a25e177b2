//! The regressor of the base parameters, Y_b(q, dq, ddq): columns of full rank, from `base.rs`.

use crate::derive::base;
use crate::derive::model::Model;
use crate::derive::parameters::{ParameterVector, View};
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::derive::regressor::STARTS;

/// The base parameters of an arm that has the function.
fn kept(model: &Model) -> &ParameterVector {
    model.base_parameters().expect("the function is left out without them")
}

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
    recursion: Recursion { view: |model, _| View::Vector(kept(model)), prepare: base::place_frames_for_base_parameters, starts: &STARTS, ..Recursion::new(RewriteScope::Frames, |pool, arm, plan, input| base::base_regressor(pool, arm, kept(input.model), plan).concat()) },
    missing: |model, with_parameters| {
        let unknown = || model.base_parameters().is_none().then(|| "exact combinations of its parameters are too long to be formed".into());
        Quantity::MISSING_WITHOUT_MASS(model, with_parameters).or_else(unknown)
    },
    gathers: &[],
    interface: Some("BaseRegressor"),
};
