//! The gravity term g(q) = ∂U/∂q.
//!
//! ```text
//! U = -Σ_i m_i g0' p_li,   g_i = ∂U/∂q_i                                              (the book, eqs. 7.36, 7.39)
//! ```
//!
//! Joint i carries the composite mass m and first moment h: g_i = -z·(h × g0) (revolute) or -m z·g0 (prismatic), in its own frame.
//! A spring adds k (q_i - rest) at its joint.

use crate::derive::arm::Arm;
use crate::derive::newton_euler::add_springs;
use crate::derive::passes::RewriteScope;
use crate::derive::plan::{Place, Plan};
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::pass::Pass;
use crate::ring::matrix::Vector;
use crate::ring::{ExprId, Pool};

/// g(q).
pub static GRAVITY: Quantity = Quantity {
    name: "gravity",
    symbol: Typeset::plain("g(q)"),
    arguments: &[Argument::Gravity, Argument::Q],
    result: &[ResultPart::whole(Typeset::plain("g(q)"), Typeset::plain("g"), &[Length::Dof], "N m or N")],
    structure: None,
    has_parameters: true,
    documentation: Documentation {
        names_gravity: true,
        ..Documentation::new(
            "Gravity term g(q) on the left of the equation of motion: the torque that holds the arm at rest.",
            "g(q) = dU/dq                                                      (Siciliano et al., eq. 7.39)",
            "a torque, N m (revolute), or a force, N (prismatic), for each joint.",
        )
        .with(Feature::Spring, "A spring of a joint adds k_s (q_i - rest) to g_i, and 1/2 k_s (q_i - rest)² to U.")
    },
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| gravity(pool, arm, plan)),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Dynamics"),
};

/// Mass and first moment of all that each joint carries, in its joint frame.
fn composite_moments(pool: &mut Pool, arm: &Arm) -> Vec<(ExprId, Vector)> {
    let mut composite: Vec<(ExprId, Vector)> = arm.joints.iter().map(|joint| (joint.body.mass, joint.body.first)).collect();
    for i in (0..arm.dof()).rev() {
        if let Some(p) = arm.joints[i].parent {
            let (mass, first) = composite[i];
            let turned = arm.joints[i].to_parent(pool, &first);
            let weighted = pool.scale(mass, &arm.joints[i].origin);
            let moved = pool.add_vectors(&turned, &weighted);
            composite[p] = (pool.add(composite[p].0, mass), pool.add_vectors(&composite[p].1, &moved));
        }
    }
    composite
}

/// g(q), with the direction of gravity handed from the base outwards.
///
/// Way 0 projects it on the joint axis in the joint frame; way 1 in the joint frame at theta = 0, where the composite first moment is
/// needed for the parent anyway.
pub fn gravity(pool: &mut Pool, arm: &Arm, plan: &mut Plan) -> Vec<ExprId> {
    let composite = composite_moments(pool, arm);
    let mut direction: Vec<Vector> = Vec::with_capacity(arm.dof());
    let mut g = Vec::with_capacity(arm.dof());
    for (i, joint) in arm.joints.iter().enumerate() {
        let outer = joint.parent.map_or(arm.gravity, |p| direction[p]);
        let at_zero = pool.transform_back(&joint.fixed, &outer);
        let own = joint.about_axis_back(pool, &at_zero);
        direction.push(own);
        let (mass, mut h) = composite[i];
        let mut g0 = own;
        if plan.way(Pass::WrenchFrame, Place::Gravity(i), 2) == 1 {
            h = joint.about_axis(pool, &h);
            g0 = at_zero;
        }
        g.push(if joint.is_revolute() { pool.dot(&[h[1], -h[0]], &[g0[0], g0[1]]) } else { -pool.mul(mass, g0[2]) });
    }
    add_springs(pool, arm, &mut g);
    g
}
