//! Rotors that ride elsewhere than on the link before their joint, or spin with the rates of several joints.
//!
//! A rotor of inertia I about a, on a link that turns at ω, with the rate θ' = n · dq beside it, has the kinetic energy
//!
//! ```text
//! ½ I (a · ω + θ')²  =  ½ I (a · ω)²  +  I (a · ω) θ'  +  ½ I θ'²
//! ```
//!
//! The first part is an inertia of the link. The others are no recursion: with u_i = a · z_i for the joints that turn the link, else 0, and
//! w_ij = a · (z_i × z_j), both in instantaneous axes,
//!
//! ```text
//! B_ij += I (u_i n_j + n_i u_j + n_i n_j)
//! C_ij += ½ I (n_j z_i · (ω × a) + n_i z_j · ((ω - 2 ω_j) × a) + θ' w_ij)            Christoffel's, as ∂u_i/∂q_k = z_i · (z_k × a) for k beyond i
//! τ_i  += I (n_i (a · dω/dt + θ'') + z_i · (a θ'' + ω × a θ'))
//! ```
//!
//! with ω_j of link j. Vectors of the link go from joint to joint towards the base, where the z component is what a joint feels.
//! The rotor turns by θ whatever its angle is, so that no function needs θ itself.

use super::arm::{Arm, CoupledRotor, Joint};
use super::motion::{polarised_cross, LinkMotion, Motion};
use crate::ring::matrix::{Vector, ZERO};
use crate::ring::{ExprId, Pool};

impl CoupledRotor {
    /// The rotor of a joint with a motor.
    pub(super) fn of(arm: &Arm, joint: usize) -> CoupledRotor {
        let beside = arm.rotors.iter().find(|rotor| rotor.joint == joint).cloned();
        beside.unwrap_or_else(|| {
            let plain = arm.joints[joint].rotor.expect("the joint has a motor");
            CoupledRotor {
                joint,
                inertia: plain.inertia,
                viscous: ExprId::ZERO,
                axis: plain.axis,
                carrier: arm.joints[joint].parent,
                rates: vec![(joint, plain.ratio)],
            }
        })
    }

    /// n · x.
    pub(super) fn spin(&self, pool: &mut Pool, x: &[ExprId]) -> ExprId {
        let mut sum = ExprId::ZERO;
        for &(joint, factor) in &self.rates {
            let part = pool.mul(factor, x[joint]);
            sum = pool.add(sum, part);
        }
        sum
    }

    /// A vector of the carrier in the frames of the joints that turn it, and z · of it.
    fn felt(&self, pool: &mut Pool, arm: &Arm, vector: &Vector) -> Vec<ExprId> {
        let mut felt = vec![ExprId::ZERO; arm.dof()];
        for (joint, vector) in outward(pool, arm, self.carrier, vector) {
            felt[joint] = vector[2];
        }
        felt
    }

    /// n, an entry for each joint.
    fn row(&self, arm: &Arm) -> Vec<ExprId> {
        let mut row = vec![ExprId::ZERO; arm.dof()];
        self.rates.iter().for_each(|&(joint, factor)| row[joint] = factor);
        row
    }
}

/// A vector in the frame of a link, in the frames of the joints from that link to the base that turn.
fn outward(pool: &mut Pool, arm: &Arm, link: Option<usize>, vector: &Vector) -> Vec<(usize, Vector)> {
    let mut vector = *vector;
    let mut all = Vec::new();
    let mut next = link;
    while let Some(joint) = next {
        if arm.joints[joint].is_revolute() {
            all.push((joint, vector));
        }
        next = arm.joints[joint].parent;
        if next.is_some() {
            vector = to_parent(pool, &arm.joints[joint], &vector);
        }
    }
    all
}

fn to_parent(pool: &mut Pool, joint: &Joint, vector: &Vector) -> Vector {
    if *vector == ZERO {
        ZERO
    } else {
        joint.to_parent(pool, vector)
    }
}

/// Adds to B.
pub(super) fn add_inertia(pool: &mut Pool, arm: &Arm, b: &mut [Vec<ExprId>]) {
    for rotor in &arm.rotors {
        let (u, n) = (rotor.felt(pool, arm, &rotor.axis), rotor.row(arm));
        let coupling: Vec<ExprId> = n.iter().map(|&factor| pool.mul(rotor.inertia, factor)).collect();
        for i in 0..arm.dof() {
            for j in 0..=i {
                let whole = pool.add(u[i], n[i]);
                let (spun, carried) = (pool.mul(coupling[j], whole), pool.mul(coupling[i], u[j]));
                b[i][j] = pool.sum([b[i][j], spun, carried]);
                b[j][i] = b[i][j];
            }
        }
    }
}

/// Adds to C; `omega`: angular velocity of each joint frame, in its own axes.
pub(super) fn add_coriolis(pool: &mut Pool, arm: &Arm, omega: &[Vector], rates: &[ExprId], c: &mut [Vec<ExprId>]) {
    let half = pool.fraction(1, 2);
    for rotor in &arm.rotors {
        let Some(carrier) = rotor.carrier else { continue };
        let n = rotor.row(arm);
        let halved = pool.mul(half, rotor.inertia);
        let coupling: Vec<ExprId> = n.iter().map(|&factor| pool.mul(halved, factor)).collect();
        let rate = rotor.spin(pool, rates);
        let momentum = pool.mul(halved, rate);
        let mut turning = omega[carrier];
        turning[2] = pool.add(turning[2], arm.joints[carrier].link_rate);
        let sweep = pool.cross(&turning, &rotor.axis);
        let swept = rotor.felt(pool, arm, &sweep);
        let two = pool.integer(2);
        for (j, a) in outward(pool, arm, Some(carrier), &rotor.axis) {
            // z_j · (ω_j × a).
            let own = pool.dot(&[omega[j][0], -omega[j][1]], &[a[1], a[0]]);
            let twice = pool.mul(two, own);
            let seen = pool.sub(swept[j], twice);
            for i in 0..arm.dof() {
                let (by_column, by_row) = (pool.mul(coupling[i], swept[j]), pool.mul(coupling[i], seen));
                c[j][i] = pool.add(c[j][i], by_column);
                c[i][j] = pool.add(c[i][j], by_row);
            }
            // w_ij = z_i · (z_j × a) for each i before j.
            let lever = pool.scale(momentum, &[-a[1], a[0], ExprId::ZERO]);
            for (i, lever) in outward(pool, arm, Some(j), &lever).into_iter().skip(1) {
                c[i][j] = pool.add(c[i][j], lever[2]);
                c[j][i] = pool.sub(c[j][i], lever[2]);
            }
        }
    }
}

/// Adds the moments on carriers to the wrenches of links; what the joints feel besides.
pub(super) fn add_wrenches(
    pool: &mut Pool,
    arm: &Arm,
    motion: &Motion,
    motions: &[LinkMotion],
    wrench: &mut [(Vector, Vector)],
) -> Vec<ExprId> {
    let mut felt = vec![ExprId::ZERO; arm.dof()];
    for rotor in &arm.rotors {
        let change = rotor.spin(pool, &motion.accelerations);
        let mut whole = change;
        if let Some(carrier) = rotor.carrier {
            let m = &motions[carrier];
            let of_link = pool.dot3(&rotor.axis, &m.domega);
            whole = pool.add(change, of_link);
            let (rate, reference) = (rotor.spin(pool, &motion.rates), rotor.spin(pool, &motion.reference));
            let (axis_rate, axis_reference) = (pool.scale(rate, &rotor.axis), pool.scale(reference, &rotor.axis));
            let turning = polarised_cross(pool, &m.omega, &axis_reference, &m.omega_r, &axis_rate);
            let accelerated = pool.scale(change, &rotor.axis);
            let moment = pool.add_vectors(&accelerated, &turning);
            let moment = pool.scale(rotor.inertia, &moment);
            wrench[carrier].1 = pool.add_vectors(&wrench[carrier].1, &moment);
        }
        let momentum = pool.mul(rotor.inertia, whole);
        for &(joint, factor) in &rotor.rates {
            let own = pool.mul(factor, momentum);
            felt[joint] = pool.add(felt[joint], own);
        }
    }
    felt
}

/// Adds to B dq; `omegas`: angular velocity of each link, in its joint frame.
pub(super) fn add_momentum(pool: &mut Pool, arm: &Arm, omegas: &[Vector], rates: &[ExprId], p: &mut [ExprId]) {
    for rotor in &arm.rotors {
        let rate = rotor.spin(pool, rates);
        let momentum = pool.mul(rotor.inertia, rate);
        let carried = rotor.carrier.map_or(ExprId::ZERO, |carrier| pool.dot3(&rotor.axis, &omegas[carrier]));
        let speed = pool.add(rate, carried);
        let whole = pool.mul(rotor.inertia, speed);
        let own = pool.scale(momentum, &rotor.axis);
        for (p, felt) in p.iter_mut().zip(rotor.felt(pool, arm, &own)) {
            *p = pool.add(*p, felt);
        }
        for &(joint, factor) in &rotor.rates {
            let spun = pool.mul(factor, whole);
            p[joint] = pool.add(p[joint], spun);
        }
    }
}

/// Adds to ∂T/∂q: I θ' a · (ω_j × z_j).
pub(super) fn add_energy_gradient(pool: &mut Pool, arm: &Arm, omegas: &[Vector], rates: &[ExprId], gradient: &mut [ExprId]) {
    for rotor in &arm.rotors {
        let rate = rotor.spin(pool, rates);
        let momentum = pool.mul(rotor.inertia, rate);
        let own = pool.scale(momentum, &rotor.axis);
        for (j, own) in outward(pool, arm, rotor.carrier, &own) {
            let change = pool.dot(&[omegas[j][1], -omegas[j][0]], &[own[0], own[1]]);
            gradient[j] = pool.add(gradient[j], change);
        }
    }
}

/// Twice the kinetic energy beyond that of the carriers; `omegas`: angular velocity of each link, in its joint frame.
pub(super) fn twice_energy(pool: &mut Pool, arm: &Arm, omegas: &[Vector], rates: &[ExprId]) -> ExprId {
    let mut sum = ExprId::ZERO;
    for rotor in &arm.rotors {
        let rate = rotor.spin(pool, rates);
        let along = rotor.carrier.map_or(ExprId::ZERO, |carrier| pool.dot3(&rotor.axis, &omegas[carrier]));
        let two = pool.integer(2);
        let carried = pool.mul(two, along);
        let speed = pool.add(carried, rate);
        let momentum = pool.mul(rotor.inertia, rate);
        let energy = pool.mul(momentum, speed);
        sum = pool.add(sum, energy);
    }
    sum
}

/// Adds to ∂tau/∂q. With c = ω_j × z_j, the change of ω in the frame of the carrier as joint j turns,
///
/// ```text
/// n_i a · (dω_j/dt × z_j + c × (ω - ω_j)) + [i before j] z_i · (z_j × (a θ'' + ω × a θ')) + θ' z_i · (c × a)
/// ```
pub(super) fn add_position_derivatives(
    pool: &mut Pool,
    arm: &Arm,
    motion: &Motion,
    motions: &[LinkMotion],
    derivative: &mut [Vec<ExprId>],
) {
    for rotor in &arm.rotors {
        let Some(carrier) = rotor.carrier else { continue };
        let omega = motions[carrier].omega;
        let (rate, change) = (rotor.spin(pool, &motion.rates), rotor.spin(pool, &motion.accelerations));
        let (momentum, changed) = (pool.mul(rotor.inertia, rate), pool.mul(rotor.inertia, change));
        let (spun, sweep) = (pool.scale(changed, &rotor.axis), pool.cross(&omega, &rotor.axis));
        let sweep = pool.scale(momentum, &sweep);
        let moment = pool.add_vectors(&spun, &sweep);
        let [axes, omegas, moments] = [&rotor.axis, &omega, &moment].map(|v| outward(pool, arm, Some(carrier), v));
        for (place, &(j, a)) in axes.iter().enumerate() {
            let LinkMotion { omega: own, domega, .. } = motions[j];
            let across = |v: &Vector| [v[1], -v[0], ExprId::ZERO];
            let c = across(&own);
            let beyond = pool.sub_vectors(&omegas[place].1, &own);
            let turned = pool.cross(&c, &beyond);
            let whole = pool.add_vectors(&across(&domega), &turned);
            let along = pool.dot3(&a, &whole);
            let along = pool.mul(rotor.inertia, along);
            for &(i, factor) in &rotor.rates {
                let felt = pool.mul(factor, along);
                derivative[i][j] = pool.add(derivative[i][j], felt);
            }
            let m = moments[place].1;
            let turned = [-m[1], m[0], ExprId::ZERO];
            let shifted = pool.cross(&c, &a);
            let shifted = pool.scale(momentum, &shifted);
            derivative[j][j] = pool.add(derivative[j][j], shifted[2]);
            let before = pool.add_vectors(&turned, &shifted);
            for (i, felt) in outward(pool, arm, Some(j), &before).into_iter().skip(1) {
                derivative[i][j] = pool.add(derivative[i][j], felt[2]);
            }
            // z_i · (c × a) = c · (a × z_i) for the joints i beyond j.
            for (i, a) in &axes[..place] {
                let lever = pool.scale(momentum, &across(a));
                let (_, lever) =
                    outward(pool, arm, Some(*i), &lever).into_iter().find(|(at, _)| *at == j).expect("j is before i");
                let felt = pool.dot3(&c, &lever);
                derivative[*i][j] = pool.add(derivative[*i][j], felt);
            }
        }
    }
}

/// Adds the friction of rotors, F_m n (n · dq), at the joints.
pub(super) fn add_friction(pool: &mut Pool, arm: &Arm, rates: &[ExprId], torques: &mut [ExprId]) {
    for rotor in arm.rotors.iter().filter(|rotor| rotor.viscous != ExprId::ZERO) {
        for (joint, felt) in friction_column(pool, rotor, rates) {
            let torque = pool.mul(rotor.viscous, felt);
            torques[joint] = pool.add(torques[joint], torque);
        }
    }
}

/// n (n · dq), joint by joint.
pub(super) fn friction_column(pool: &mut Pool, rotor: &CoupledRotor, rates: &[ExprId]) -> Vec<(usize, ExprId)> {
    let rate = rotor.spin(pool, rates);
    rotor.rates.iter().map(|&(joint, factor)| (joint, pool.mul(factor, rate))).collect()
}

/// Adds F_m n n' to ∂tau/∂dq.
pub(super) fn add_friction_slopes(pool: &mut Pool, arm: &Arm, by_rates: &mut [Vec<ExprId>]) {
    for rotor in &arm.rotors {
        for &(i, of_row) in &rotor.rates {
            let torque = pool.mul(rotor.viscous, of_row);
            for &(j, of_column) in &rotor.rates {
                let slope = pool.mul(torque, of_column);
                by_rates[i][j] = pool.add(by_rates[i][j], slope);
            }
        }
    }
}
