//! The gravity term g(q) = ∂U/∂q and the potential energy U(q).
//!
//! ```text
//! U = -Σ_i m_i g0' p_li,   g_i = ∂U/∂q_i                                              (the book, eqs. 7.36, 7.39)
//! ```
//!
//! Joint i carries the composite mass m and first moment h: g_i = -z·(h × g0) (revolute) or -m z·g0 (prismatic), in its own frame.

use super::arm::Arm;
use super::kinematics::frames;
use crate::ring::matrix::Vector;
use crate::ring::{ExprId, Pool};

/// Mass and first moment of all that each joint carries, in its joint frame.
fn composite_moments(pool: &mut Pool, arm: &Arm) -> Vec<(ExprId, Vector)> {
    let mut composite: Vec<(ExprId, Vector)> = arm.joints.iter().map(|joint| (joint.body.mass, joint.body.first)).collect();
    for i in (0..arm.dof()).rev() {
        if let Some(p) = arm.joints[i].parent {
            let (mass, first) = composite[i];
            let turned = arm.joints[i].outward(pool, &first);
            let weighted = pool.scale(mass, &arm.joints[i].origin);
            let moved = pool.add_vectors(&turned, &weighted);
            composite[p] = (pool.add(composite[p].0, mass), pool.add_vectors(&composite[p].1, &moved));
        }
    }
    composite
}

/// g(q), with the direction of gravity handed from the base outwards.
pub fn gravity(pool: &mut Pool, arm: &Arm) -> Vec<ExprId> {
    let composite = composite_moments(pool, arm);
    let mut direction: Vec<Vector> = Vec::with_capacity(arm.dof());
    for i in 0..arm.dof() {
        let outer = arm.joints[i].parent.map_or(arm.gravity, |p| direction[p]);
        direction.push(arm.joints[i].inward(pool, &outer));
    }
    (0..arm.dof())
        .map(|i| {
            let ((mass, h), g) = (composite[i], direction[i]);
            if arm.joints[i].is_revolute() {
                pool.dot(&[h[1], -h[0]], &[g[0], g[1]])
            } else {
                -pool.mul(mass, g[2])
            }
        })
        .collect()
}

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
