//! What follows from the first moment of the whole arm in the base frame: the potential energy of gravity.
//!
//! ```text
//! h = Σ_i m_i p_li,   U = -g0' h                                                      (the book, eq. 7.36)
//! ```

use super::kinematics::frames;
use crate::derive::arm::Arm;
use crate::derive::passes::Use;
use crate::derive::quantity::{Argument, Documentation, Part, Quantity, Recursion, Typeset};
use crate::ring::matrix::Vector;
use crate::ring::{ExprId, Pool};

/// In the order of the emitted module.
pub(super) static DECLARED: [&Quantity; 1] = [&POTENTIAL_ENERGY];

/// U(q).
pub static POTENTIAL_ENERGY: Quantity = Quantity {
    name: "potential_energy",
    symbol: Typeset::new("U(q)", "\\mathcal U(q)"),
    arguments: &[Argument::Q],
    result: &[Part::whole(Typeset::new("U(q)", "\\mathcal U(q)"), Typeset::new("U", "\\mathcal U"), &[], "J")],
    structure: None,
    has_parameters: true,
    documentation: Documentation {
        names_gravity: true,
        ..Documentation::new(
            "Potential energy of gravity; zero where all masses, rotors included, lie at the origin of the base frame.",
            "U(q) = - sum_i m_i g0' p_li                                       (Siciliano et al., eq. 7.36)",
            "an energy, J.",
        )
    },
    recursion: Recursion::new(Use::Plain, |pool, arm, _, _| vec![potential_energy(pool, arm)]),
    missing: Quantity::NEVER_MISSING,
    gathers: &[],
    interface: Some("Dynamics"),
};

/// h(q), kg m: links, load and rotors, those that the base carries included.
fn first_moment(pool: &mut Pool, arm: &Arm) -> Vector {
    let frames = frames(pool, arm);
    let mut total = arm.base_moment;
    for (joint, (rotation, origin)) in arm.joints.iter().zip(&frames.joints) {
        let turned = pool.transform(rotation, &joint.body.first);
        let weighted = pool.scale(joint.body.mass, origin);
        let first = pool.add_vectors(&turned, &weighted);
        total = pool.add_vectors(&total, &first);
    }
    total
}

/// U(q), J: zero where all masses, rotors included, lie at the origin of the base frame.
pub fn potential_energy(pool: &mut Pool, arm: &Arm) -> ExprId {
    let first = first_moment(pool, arm);
    -pool.dot3(&arm.gravity, &first)
}
