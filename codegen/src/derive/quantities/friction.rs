//! The friction torque F(dq), rotors included, as Newton and Euler's equations take it in.
//!
//! ```text
//! F_i = (k_r² F_m + F_v) dq_i + F_c sign(dq_i)                                       (the book, eq. 7.42)
//! ```
//!
//! with tanh(dq_i / v) in place of the sign where friction is smooth, and F_0 + F_3 dq_i³ + F_s sign(dq_i) exp(-|dq_i| / v_s) where the description has them.

use crate::derive::friction;
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::ring::Symbol;

/// F(dq).
pub static FRICTION: Quantity = Quantity {
    name: "friction",
    symbol: Typeset::new("F(dq)", "F(\\dot q)"),
    arguments: &[Argument::Dq],
    result: &[ResultPart::whole(Typeset::new("F(dq)", "F(\\dot q)"), Typeset::plain("f"), &[Length::Dof], "N m or N")],
    structure: None,
    has_parameters: true,
    documentation: Documentation::new(
        "Friction torque F(dq) on the left of the equation of motion: it has the sign of dq.",
        "F_i = (k_r² F_m + F_v) dq_i + F_c sign(dq_i), sign(0) = 0          (Siciliano et al., eq. 7.42)",
        "a torque, N m (revolute), or a force, N (prismatic), for each joint.",
    )
    .with(
        Feature::OffsetOrCubic,
        "Where the description has them, F_0 + F_3 dq_i³ are added; with F_0 the torque need not have that sign.",
    )
    .with(
        Feature::SmoothFriction,
        "Smooth friction has F_c tanh(dq_i / v) in place of F_c sign(dq_i), v the number of its joint.",
    )
    .with(Feature::Stribeck, "Stribeck friction adds F_s sign(dq_i) exp(-|dq_i| / v_s), with the numbers of its joint.")
    .with(
        Feature::CoupledMotor,
        "A motor with `coupling` adds F_m N' N dq in place of k_r² F_m dq_i, N its row of {MOTOR_RATES}.",
    )
    .with(Feature::LoadFriction, "What grows with the load of a joint depends on q and is {load_friction}."),
    recursion: Recursion::new(RewriteScope::KeepParameters, |pool, arm, _, _| {
        let rates = arm.symbols(pool, Symbol::Rate);
        friction::friction(pool, arm, &rates)
    }),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Dynamics"),
};
