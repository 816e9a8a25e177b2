//! Inverse dynamics by Newton and Euler's equations in joint frames.
//!
//! The acceleration field of link i is a + U r, with U = `[domega] + [omega]²` (`[a]`: the matrix of the cross product with a); force
//! and moment follow from m, h and the second moments S alone:
//!
//! ```text
//! f = m a + U h,   n = h × a + vee(U S - (U S)ᵀ)                                     (the book, Sect. 7.5, in second-moment form)
//! ```
//!
//! With a reference rate dqr beside dq the quadratic terms are polarised, x² -> ½ (x y + y x). As Christoffel's C(q, dq) dqr is the
//! symmetric bilinear form of the quadratic C(q, dq) dq, the recursion then yields B ddqr + C(q, dq) dqr + g exactly.
//!
//! The rotor of joint i has, beyond what turns with the parent link, the angular momentum I_m k dq z_m, whose change acts on the
//! parent, and feels I_m k (k ddq + z_m · domega_p) itself.

use super::arm::Arm;
use super::friction::friction;
use super::wrench::{axis_component, wrench_to_parent};
use crate::derive::arm::symmetric;
use crate::ring::matrix::{Matrix, Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// What drives the recursion: rates, reference rates (the rates themselves for plain inverse dynamics) and accelerations.
#[derive(Clone, Debug)]
pub struct Motion {
    /// dq.
    pub rates: Vec<ExprId>,
    /// dqr.
    pub reference: Vec<ExprId>,
    /// ddq or ddqr.
    pub accelerations: Vec<ExprId>,
}

impl Motion {
    /// (dq, dq, ddq).
    pub fn plain(pool: &mut Pool, arm: &Arm) -> Motion {
        let rates = arm.symbols(pool, Symbol::Rate);
        Motion { reference: rates.clone(), rates, accelerations: arm.symbols(pool, Symbol::Acceleration) }
    }

    /// (dq, dq, 0): the bias C dq + g.
    pub fn unaccelerated(pool: &mut Pool, arm: &Arm) -> Motion {
        Motion { accelerations: vec![ExprId::ZERO; arm.dof()], ..Motion::plain(pool, arm) }
    }

    /// (dq, dqr, ddqr).
    pub fn with_reference(pool: &mut Pool, arm: &Arm) -> Motion {
        Motion {
            rates: arm.symbols(pool, Symbol::Rate),
            reference: arm.symbols(pool, Symbol::ReferenceRate),
            accelerations: arm.symbols(pool, Symbol::ReferenceAcceleration),
        }
    }
}

/// Motion of a link in its joint frame.
#[derive(Clone, Copy, Debug)]
pub struct LinkMotion {
    /// Angular velocity.
    pub omega: Vector,
    /// Angular velocity of the reference rates.
    pub omega_r: Vector,
    /// Angular acceleration, polarised.
    pub domega: Vector,
    /// Acceleration of the origin less gravity.
    pub acceleration: Vector,
    /// U: acceleration of a point r is `acceleration` + U r.
    pub field: Matrix,
}

/// ½ (a × b' + a' × b), the polarised form of a × b.
fn polarised_cross(pool: &mut Pool, a: &Vector, b_r: &Vector, a_r: &Vector, b: &Vector) -> Vector {
    let half = pool.fraction(1, 2);
    let (left, right) = (pool.cross(a, b_r), pool.cross(a_r, b));
    if left == right {
        return left;
    }
    let sum = pool.add_vectors(&left, &right);
    pool.scale(half, &sum)
}

/// U = [domega] + ½ ([omega][omega_r] + [omega_r][omega]) and domega, given its z column and z·domega.
///
/// A point on the joint axis belongs to both links: U z is the parent's, turned. With the products P of the rates,
///
/// ```text
/// domega_x = P_yz - U_yz,  domega_y = U_xz - P_xz,  U_zx = P_xz - domega_y,  U_zy = P_yz + domega_x
/// U_xy = P_xy - domega_z,  U_yx = P_xy + domega_z,  U_yy = -(P_xx + P_zz),  U_xx = U_zz + P_xx - P_zz
/// ```
fn acceleration_field(pool: &mut Pool, w: &Vector, wr: &Vector, column: &Vector, domega_z: ExprId) -> (Matrix, Vector) {
    let mut product = |i: usize, j: usize| polarised_product(pool, w, wr, i, j);
    let (xx, zz, xy, xz, yz) = (product(0, 0), product(2, 2), product(0, 1), product(0, 2), product(1, 2));
    let domega = [pool.sub(yz, column[1]), pool.sub(column[0], xz), domega_z];
    let difference = pool.sub(xx, zz);
    let field = [
        [pool.add(column[2], difference), pool.sub(xy, domega_z), column[0]],
        [pool.add(xy, domega_z), -pool.add(xx, zz), column[1]],
        [pool.sub(xz, domega[1]), pool.add(yz, domega[0]), column[2]],
    ];
    (field, domega)
}

/// ½ (a_i b_j + b_i a_j).
fn polarised_product(pool: &mut Pool, a: &Vector, b: &Vector, i: usize, j: usize) -> ExprId {
    if a == b {
        return pool.mul(a[i], a[j]);
    }
    let half = pool.fraction(1, 2);
    let (left, right) = (pool.mul(a[i], b[j]), pool.mul(b[i], a[j]));
    let sum = pool.add(left, right);
    pool.mul(half, sum)
}

/// Motion of every link.
pub fn link_motions(pool: &mut Pool, arm: &Arm, motion: &Motion, gravity: bool) -> Vec<LinkMotion> {
    let base = LinkMotion {
        omega: ZERO,
        omega_r: ZERO,
        domega: ZERO,
        acceleration: if gravity { arm.gravity.map(|g| -g) } else { ZERO },
        field: [ZERO; 3],
    };
    let mut motions: Vec<LinkMotion> = Vec::with_capacity(arm.dof());
    for (i, joint) in arm.joints.iter().enumerate() {
        let outer = joint.parent.map_or(base, |p| motions[p]);
        let carried = pool.transform(&outer.field, &joint.origin);
        let origin = pool.add_vectors(&outer.acceleration, &carried);
        let mut acceleration = joint.from_parent(pool, &origin);
        let [mut omega, mut omega_r] = [outer.omega, outer.omega_r].map(|v| joint.from_parent(pool, &v));
        let axis = [0, 1, 2].map(|row| joint.fixed[row][2]);
        let on_axis = pool.transform(&outer.field, &axis);
        let column = joint.from_parent(pool, &on_axis);
        let mut domega_z = pool.dot3(&axis, &outer.domega);
        if joint.is_revolute() {
            domega_z = pool.add(domega_z, motion.accelerations[i]);
            omega[2] = pool.add(omega[2], motion.rates[i]);
            omega_r[2] = pool.add(omega_r[2], motion.reference[i]);
        } else {
            let (rate, reference) = (along_z(motion.rates[i]), along_z(motion.reference[i]));
            let turning = polarised_cross(pool, &omega, &reference, &omega_r, &rate);
            let two = pool.integer(2);
            let coriolis = pool.scale(two, &turning);
            acceleration = pool.add_vectors(&acceleration, &coriolis);
            acceleration[2] = pool.add(acceleration[2], motion.accelerations[i]);
        }
        let (field, domega) = acceleration_field(pool, &omega, &omega_r, &column, domega_z);
        motions.push(LinkMotion { omega, omega_r, domega, acceleration, field });
    }
    motions
}

fn along_z(x: ExprId) -> Vector {
    [ExprId::ZERO, ExprId::ZERO, x]
}

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
    let mut tau = vec![ExprId::ZERO; arm.dof()];
    for i in (0..arm.dof()).rev() {
        let (force, moment) = wrench[i];
        tau[i] = axis_component(arm, i, &force, &moment);
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
