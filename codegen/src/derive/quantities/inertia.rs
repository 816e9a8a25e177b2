//! The inertia matrix B(q) by composite bodies.
//!
//! Column i is the wrench that the unit acceleration of joint i alone needs, handed from link i towards the base:
//!
//! ```text
//! B(q) = Σ_i m_i J_Pi' J_Pi + J_Oi' R_i I_i R_i' J_Oi + rotors                     (the book, eq. 7.32)
//!      : f = z × h_i^c, n = ∫ r × (z × r) dm over all that joint i carries,  B_ij = z_j · (n + p_ji × f)
//! ```
//!
//! The rotor of joint i adds I_m k² on the diagonal and, as it rides on the parent link, the moment I_m k z_m there: this couples the joints.
//! Rotors elsewhere, and those that spin with several joints: `rotors.rs`.

use crate::derive::arm::{Arm, Body};
use crate::derive::columns::{Column, ColumnPropagator};
use crate::derive::passes::RewriteScope;
use crate::derive::plan::Plan;
use crate::derive::quantity::{Argument, Documentation, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::derive::rotors;
use crate::kinds::JointKind;
use crate::ring::matrix::Vector;
use crate::ring::{ExprId, Pool};

/// B(q).
pub static INERTIA_MATRIX: Quantity = Quantity {
    name: "inertia_matrix",
    symbol: Typeset::plain("B(q)"),
    arguments: &[Argument::Q],
    result: &[ResultPart::whole(Typeset::plain("B(q)"), Typeset::plain("b"), &[Length::Dof, Length::Dof], "kg m², kg m, kg")],
    structure: None,
    has_parameters: true,
    documentation: Documentation { result_with: Some("`b[row][column]`, symmetric, positive definite where {pi} is physically possible, all entries filled; kg m² between revolute joints, kg m between a revolute and a \
         prismatic one, kg between prismatic ones. J_Pi and J_Oi are the Jacobians of the centre of mass of link i, I_i is about it."), ..Documentation::new(
        "Inertia matrix B(q) of links and rotors.",
        "B(q) = sum_i (m_i J_Pi' J_Pi + J_Oi' R_i I_i R_i' J_Oi) + rotors  (Siciliano et al., eq. 7.32)",
        "`b[row][column]`, symmetric and positive definite, all entries filled; kg m² between revolute joints, kg m between a revolute and a \
         prismatic one, kg between prismatic ones. J_Pi and J_Oi are the Jacobians of the centre of mass of link i, I_i is about it.",
    ) },
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| inertia_matrix(pool, arm, plan).concat()),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Dynamics"),
};

/// For each joint the body of all links that it carries, in its joint frame (Walker and Orin 1982).
pub fn composite_bodies(pool: &mut Pool, arm: &Arm) -> Vec<Body> {
    let mut composite: Vec<Body> = arm.joints.iter().map(|joint| joint.body).collect();
    for i in (0..arm.dof()).rev() {
        if let Some(p) = arm.joints[i].parent {
            let moved = arm.joints[i].body_outward(pool, &composite[i]);
            composite[p] = composite[p].plus(pool, &moved);
        }
    }
    composite
}

/// B(q), all entries.
pub fn inertia_matrix(pool: &mut Pool, arm: &Arm, plan: &mut Plan) -> Vec<Vec<ExprId>> {
    let n = arm.dof();
    let composite = composite_bodies(pool, arm);
    let mut propagator = ColumnPropagator::new(arm, None);
    let mut b = vec![vec![ExprId::ZERO; n]; n];
    for j in (0..n).rev() {
        let joint = &arm.joints[j];
        // The trace xx + yy is invariant under rotation about z: formed before the rotation, it is the node that their sum is found to equal.
        pool.intern_sum(composite[j].second[0], composite[j].second[2]);
        let Body { mass, first: h, second: [xx, _, yy, xz, yz, _] } = joint.body_about_axis(pool, &composite[j]);
        let (force, moment): (Vector, Vector) = match joint.kind {
            JointKind::Revolute => ([-h[1], h[0], ExprId::ZERO], [-xz, -yz, pool.add(xx, yy)]),
            JointKind::Prismatic => ([ExprId::ZERO, ExprId::ZERO, mass], [h[1], -h[0], ExprId::ZERO]),
        };
        let column = Column { inertial: (force, moment), rate: None };
        b[j][j] = column.own_entries(pool, joint).0;
        let mut propagated = propagator.start(pool, plan, column, j);
        while let Some(parent) = propagator.propagate_to_parent(pool, plan, &mut propagated) {
            b[parent][j] = propagator.entries(pool, &propagated).inertia;
            b[j][parent] = b[parent][j];
        }
    }
    rotors::add_inertia(pool, arm, &mut b);
    b
}
