//! The potential energy of gravity.
//!
//! ```text
//! U = -Σ_i m_i g0' p_li                                                               (the book, eq. 7.36)
//! ```

use super::kinematics::frames;
use crate::derive::arm::Arm;
use crate::derive::passes::Use;
use crate::derive::quantity::{Argument, Documentation, Part, Quantity, Recursion, Typeset};
use crate::ring::{ExprId, Pool};

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

/// U(q), J: zero where all masses, rotors included, lie at the origin of the base frame.
pub fn potential_energy(pool: &mut Pool, arm: &Arm) -> ExprId {
    let frames = frames(pool, arm);
    let mut total = arm.base_moment;
    for (joint, (rotation, origin)) in arm.joints.iter().zip(&frames.joints) {
        let turned = pool.transform(rotation, &joint.body.first);
        let weighted = pool.scale(joint.body.mass, origin);
        let first = pool.add_vectors(&turned, &weighted);
        total = pool.add_vectors(&total, &first);
    }
    -pool.dot3(&arm.gravity, &total)
}
