//! The variables of all joints, of a robot with coupled joints: q = S p + c.

use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::ring::Symbol;

/// S p + c.
pub static JOINT_VARIABLES: Quantity = Quantity {
    name: "joint_variables",
    symbol: Typeset::new("S q + c", "S q + c"),
    arguments: &[Argument::Q],
    result: &[ResultPart::whole(Typeset::new("S q + c", "S q + c"), Typeset::plain("v"), &[Length::AllJoints], "rad or m")],
    structure: None,
    has_parameters: false,
    documentation: Documentation {
        said_missing: false,
        ..Documentation::new(
            "Variables of all joints, those that follow others included.",
            "S q + c, S and c the constants {COUPLING} and {COUPLING_OFFSET}",
            "a variable for each joint in the order of {ALL_JOINT_NAMES}, rad (revolute) or m (prismatic).",
        )
    },
    recursion: Recursion::new(RewriteScope::Frames, |pool, arm, _, _| arm.symbols(pool, Symbol::Position)),
    missing: |model, _| model.manipulator.coupling.is_none().then(|| "no joint is coupled".into()),
    gathers: &[],
    interface: None,
};
