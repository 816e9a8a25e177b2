//! B, C and g at one state, from one recursion over the columns of B and C.

use super::coriolis::{inertia_and_coriolis, CORIOLIS_MATRIX};
use super::gravity::{gravity, GRAVITY};
use super::inertia::INERTIA_MATRIX;
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Structure, Typeset};

/// B, C and g together.
pub static EQUATIONS_OF_MOTION: Quantity = Quantity {
    name: "equations_of_motion",
    symbol: Typeset::plain("B, C, g"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq],
    result: &[
        ResultPart {
            name: "inertia",
            meaning: ["Inertia matrix B(q)", ": symmetric, positive definite"],
            ..ResultPart::whole(Typeset::plain("B(q)"), Typeset::plain("b"), &[Length::Dof, Length::Dof], "kg m², kg m, kg")
        },
        ResultPart {
            name: "coriolis",
            meaning: ["Coriolis and centrifugal matrix C(q, dq)", " by Christoffel symbols: dB/dt - 2C is skew-symmetric"],
            ..ResultPart::whole(
                Typeset::new("C(q, dq)", "C(q, \\dot q)"),
                Typeset::plain("c"),
                &[Length::Dof, Length::Dof],
                "as B, per s",
            )
        },
        ResultPart {
            name: "gravity",
            meaning: ["Gravity term g(q)", ", on the left of the equation of motion"],
            ..ResultPart::whole(Typeset::plain("g(q)"), Typeset::plain("g"), &[Length::Dof], "N m or N")
        },
    ],
    structure: Some(Structure { name: "EquationsOfMotion", title: "The terms of the equation of motion" }),
    has_parameters: true,
    documentation: Documentation::new(
        "B(q), C(q, dq) and g(q) at one state, sharing their work.",
        "B(q) ddq + C(q, dq) dq + F(dq) + g(q) = tau                        (Siciliano et al., eq. 7.42)",
        "the three terms as the functions of their own return them.",
    )
    .with(Feature::Spring, "A spring of a joint adds k_s (q_i - rest) to g_i, and 1/2 k_s (q_i - rest)² to U."),
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| {
        let (b, c) = inertia_and_coriolis(pool, arm, plan);
        let g = gravity(pool, arm, plan);
        [b.concat(), c.concat(), g].concat()
    }),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[&INERTIA_MATRIX, &CORIOLIS_MATRIX, &GRAVITY],
    interface: Some("Dynamics"),
};
