//! Motions of links in joint frames: rates and accelerations from the base outwards.
//!
//! With a reference rate dqr beside dq the quadratic terms are polarised, x² -> ½ (x y + y x). Christoffel's C(q, dq) dqr is the symmetric bilinear
//! form of the quadratic C(q, dq) dq: so forces and moments of such motions yield it exactly.

use super::arm::Arm;
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
pub(super) fn polarised_cross(pool: &mut Pool, a: &Vector, b_r: &Vector, a_r: &Vector, b: &Vector) -> Vector {
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
