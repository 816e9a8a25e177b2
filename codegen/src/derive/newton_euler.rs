//! Inverse dynamics by Newton and Euler's equations in joint frames.
//!
//! The acceleration field of link i is a + U r, with U = `[domega] + [omega]²` (`[a]`: the matrix of the cross product with a); force
//! and moment follow from m, h and the second moments S alone:
//!
//! ```text
//! f = m a + U h,   n = h × a + vee(U S - (U S)ᵀ)                                     (the book, Sect. 7.5, in second-moment form)
//! ```
//!
//! Motions of links with a reference rate dqr beside dq (`motion.rs`) yield B ddqr + C(q, dq) dqr + g exactly.
//!
//! The rotor of joint i has, beyond what turns with the parent link, the angular momentum I_m k dq z_m, whose change acts on the
//! parent, and feels I_m k (k ddq + z_m · domega_p) itself.

use super::arm::Arm;
use super::friction::friction;
use super::motion::{link_motions, polarised_cross, LinkMotion, Motion};
use super::rotors;
use super::wrench::{axis_component, wrench_to_parent};
use crate::derive::arm::symmetric;
use crate::ring::matrix::{Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// B ddqr + C(q, dq) dqr + g: the torques without friction and springs.
pub fn newton_euler(pool: &mut Pool, arm: &Arm, motion: &Motion, gravity: bool) -> Vec<ExprId> {
    let motions = link_motions(pool, arm, motion, gravity);
    wrenches(pool, arm, motion, &motions).0
}

/// The torques without friction, and the force and moment that move what each joint carries, about the origin of its frame and in its axes.
pub fn wrenches(pool: &mut Pool, arm: &Arm, motion: &Motion, motions: &[LinkMotion]) -> (Vec<ExprId>, Vec<(Vector, Vector)>) {
    let mut wrench: Vec<(Vector, Vector)> = Vec::with_capacity(arm.dof());
    for (joint, LinkMotion { acceleration, field, .. }) in arm.joints.iter().zip(motions) {
        let body = &joint.body;
        let (weighted, turned) = (pool.scale(body.mass, acceleration), pool.transform(field, &body.first));
        let force = pool.add_vectors(&weighted, &turned);
        let lever = pool.cross(&body.first, acceleration);
        let second = symmetric(&body.second);
        let own = [(2, 1), (0, 2), (1, 0)].map(|(i, j)| {
            // vee(M - M')_z = M_yx - M_xy, M = U S
            let (a, b) = (pool.dot(&field[i], &second[j]), pool.dot(&field[j], &second[i]));
            pool.sub(a, b)
        });
        wrench.push((force, pool.add_vectors(&lever, &own)));
    }
    let spun = rotors::add_wrenches(pool, arm, motion, motions, &mut wrench);
    let mut tau = vec![ExprId::ZERO; arm.dof()];
    for i in (0..arm.dof()).rev() {
        let (force, moment) = wrench[i];
        let own = axis_component(arm, i, &force, &moment);
        tau[i] = pool.add(own, spun[i]);
        let parent = arm.joints[i].parent;
        let mut gyroscopic = ZERO;
        if let Some(rotor) = arm.joints[i].rotor {
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let outer = parent.map(|p| motions[p]);
            let of_link = outer.map_or(ExprId::ZERO, |m| pool.dot3(&rotor.axis, &m.domega));
            let own = pool.mul(rotor.ratio, motion.accelerations[i]);
            let sum = pool.add(own, of_link);
            let felt = pool.mul(coupling, sum);
            tau[i] = pool.add(tau[i], felt);
            if let Some(m) = outer {
                let (rate, reference) = (motion.rates[i], motion.reference[i]);
                let (axis_rate, axis_reference) = (pool.scale(rate, &rotor.axis), pool.scale(reference, &rotor.axis));
                let turning = polarised_cross(pool, &m.omega, &axis_reference, &m.omega_r, &axis_rate);
                let accelerated = pool.scale(motion.accelerations[i], &rotor.axis);
                let change = pool.add_vectors(&accelerated, &turning);
                gyroscopic = pool.scale(coupling, &change);
            }
        }
        let felt = pool.mul(arm.joints[i].armature, motion.accelerations[i]);
        tau[i] = pool.add(tau[i], felt);
        if let Some(p) = parent {
            let (force, moment) = wrench_to_parent(pool, arm, i, &force, &moment);
            let moment = pool.add_vectors(&moment, &gyroscopic);
            wrench[p] = (pool.add_vectors(&wrench[p].0, &force), pool.add_vectors(&wrench[p].1, &moment));
        }
    }
    (tau, wrench)
}

/// q - rest of the spring of joint `i`.
pub fn deflection(pool: &mut Pool, arm: &Arm, i: usize) -> ExprId {
    let position = pool.symbol(Symbol::Position(i as u16));
    pool.sub(position, arm.joints[i].rest)
}

/// Adds the torques of springs, k (q - rest), which are part of g(q).
pub fn add_springs(pool: &mut Pool, arm: &Arm, torques: &mut [ExprId]) {
    for i in (0..arm.dof()).filter(|&i| arm.joints[i].stiffness != ExprId::ZERO) {
        let deflection = deflection(pool, arm, i);
        let torque = pool.mul(arm.joints[i].stiffness, deflection);
        torques[i] = pool.add(torques[i], torque);
    }
}

/// The torques with friction and springs.
pub fn inverse_dynamics(pool: &mut Pool, arm: &Arm, motion: &Motion) -> Vec<ExprId> {
    let mut tau = newton_euler(pool, arm, motion, true);
    add_springs(pool, arm, &mut tau);
    let friction = friction(pool, arm, &motion.reference);
    (0..arm.dof()).map(|i| pool.add(tau[i], friction[i])).collect()
}
