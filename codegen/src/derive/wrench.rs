//! Wrenches: a force and a moment about the origin of a joint frame, both in the axes of that frame.

use super::arm::Arm;
use crate::ring::matrix::{Vector, ZERO};
use crate::ring::{ExprId, Pool};

/// A wrench on link i, about its origin, in its joint frame, as one on the parent.
pub(super) fn wrench_to_parent(pool: &mut Pool, arm: &Arm, i: usize, force: &Vector, moment: &Vector) -> (Vector, Vector) {
    let joint = &arm.joints[i];
    let force = if *force == ZERO { ZERO } else { joint.to_parent(pool, force) };
    let moment = joint.to_parent(pool, moment);
    let lever = pool.cross(&joint.origin, &force);
    (force, pool.add_vectors(&moment, &lever))
}

/// The component of a wrench, in a joint's frame, along the joint's axis.
pub(super) fn axis_component(arm: &Arm, i: usize, force: &Vector, moment: &Vector) -> ExprId {
    if arm.joints[i].is_revolute() {
        moment[2]
    } else {
        force[2]
    }
}
