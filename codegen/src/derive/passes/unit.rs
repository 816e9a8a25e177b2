//! The unit of length: an arm of revolute joints moves alike in every unit.
//!
//! With lengths in units of L and masses in units that keep m L², second moments and torques stay what they are, first moments
//! are L times what they were and the acceleration of gravity is one L-th. The length that occurs most often becomes 1, and products with it vanish.

use super::super::arm::Arm;
use super::super::plan::{Place, Plan};
use crate::pass::Pass;
use crate::ring::{ExprId, Pool};

/// Lengths in units of one of them.
pub(super) fn unit_of_length(pool: &mut Pool, arm: &mut Arm, plan: &mut Plan) {
    if !arm.joints.iter().all(|joint| joint.is_revolute()) {
        return;
    }
    let mut lengths: Vec<ExprId> = Vec::new();
    for length in arm.joints.iter().flat_map(|joint| joint.origin).chain(arm.gravity) {
        let length = length.unsigned();
        if length != ExprId::ZERO && length != ExprId::ONE && pool.is_constant(length) && !lengths.contains(&length) {
            lengths.push(length);
        }
    }
    let way = plan.way(Pass::UnitOfLength, Place::Arm, lengths.len() + 1);
    if way == 0 {
        return;
    }
    let unit = lengths[way - 1];
    let inverse = pool.reciprocal(unit);
    let square = pool.mul(unit, unit);
    for joint in &mut arm.joints {
        joint.origin = pool.scale(inverse, &joint.origin);
        joint.link_origin = pool.scale(inverse, &joint.link_origin);
        joint.body.mass = pool.mul(square, joint.body.mass);
        joint.body.first = pool.scale(unit, &joint.body.first);
    }
    arm.gravity = pool.scale(inverse, &arm.gravity);
    for tool in std::iter::once(&mut arm.tool).chain(&mut arm.loads) {
        tool.origin = pool.scale(inverse, &tool.origin);
    }
    arm.base_moment = pool.scale(unit, &arm.base_moment);
}
