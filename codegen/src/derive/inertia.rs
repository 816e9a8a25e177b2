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

use super::arm::{Arm, Body};
use crate::manipulator::JointKind;
use crate::ring::matrix::{Vector, ZERO};
use crate::ring::{ExprId, Pool};

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
pub fn inertia_matrix(pool: &mut Pool, arm: &Arm) -> Vec<Vec<ExprId>> {
    let n = arm.dof();
    let composite = composite_bodies(pool, arm);
    let mut b = vec![vec![ExprId::ZERO; n]; n];
    for i in (0..n).rev() {
        let Body { mass, first: h, second: [xx, _, yy, xz, yz, _] } = composite[i];
        let (mut force, mut moment): (Vector, Vector) = match arm.joints[i].kind {
            JointKind::Revolute => ([-h[1], h[0], ExprId::ZERO], [-xz, -yz, pool.add(xx, yy)]),
            JointKind::Prismatic => ([ExprId::ZERO, ExprId::ZERO, mass], [h[1], -h[0], ExprId::ZERO]),
        };
        let mut own = along(arm, i, &force, &moment);
        if let Some(rotor) = arm.joints[i].rotor {
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let seen = pool.mul(coupling, rotor.ratio);
            own = pool.add(own, seen);
        }
        b[i][i] = own;
        let mut link = i;
        while let Some(parent) = arm.joints[link].parent {
            (force, moment) = wrench_outward(pool, arm, link, &force, &moment);
            if link == i {
                if let Some(rotor) = arm.joints[i].rotor {
                    let coupling = pool.mul(rotor.inertia, rotor.ratio);
                    let spin = pool.scale(coupling, &rotor.axis);
                    moment = pool.add_vectors(&moment, &spin);
                }
            }
            b[parent][i] = along(arm, parent, &force, &moment);
            b[i][parent] = b[parent][i];
            link = parent;
        }
    }
    b
}

/// A wrench on link i, about its origin, in its joint frame, as one on the parent.
pub fn wrench_outward(pool: &mut Pool, arm: &Arm, i: usize, force: &Vector, moment: &Vector) -> (Vector, Vector) {
    let joint = &arm.joints[i];
    let force = if *force == ZERO { ZERO } else { joint.outward(pool, force) };
    let moment = joint.outward(pool, moment);
    let lever = pool.cross(&joint.origin, &force);
    (force, pool.add_vectors(&moment, &lever))
}

/// What a joint feels of a wrench in its frame.
pub fn along(arm: &Arm, i: usize, force: &Vector, moment: &Vector) -> ExprId {
    if arm.joints[i].is_revolute() {
        moment[2]
    } else {
        force[2]
    }
}
