//! The Coriolis and centrifugal matrix C(q, dq) by Christoffel symbols of the first kind, by recursion over composite bodies.
//!
//! ```text
//! C_ij = Σ_k c_ijk dq_k,   c_ijk = ½ (∂b_ij/∂q_k + ∂b_ik/∂q_j - ∂b_jk/∂q_i)              (the book, eq. 7.45)
//!      = ∫ ∂x/∂q_i · d/dt (∂x/∂q_j) dm
//! ```
//!
//! since ∫ ∂_i x · ∂_j ∂_k x dm is c_ijk. With this choice dB/dt - 2C is skew-symmetric, as passivity-based control needs.
//!
//! For a revolute joint j, ∂_j x = z × r with r from a point of its axis, and d/dt ∂_j x = dz/dt × r + z × dr/dt, over all that joint j
//! carries. With Ω the angular velocity of the parent link, dr/dt = Ω × r + v: what is left is the velocity v *relative to the
//! parent*, and its moments K = ∫ v r' dm, h' = ∫ v dm beside h = ∫ r dm and S = ∫ r r' dm hold everything. An ancestor i feels
//! the wrench of ∂_j x in B_ij, that of d/dt ∂_j x in C_ij, and in C_ji = ∫ ∂_j x · (dz_i/dt × r + z_i × dr/dt) dm
//!
//! ```text
//! f = z × h,              n = (tr S) z - S z                            B_ij = z_i · n
//! F = Ω × f + z × h',     N = (S Ω) × z + (tr K) z - K z                C_ij = z_i · N
//!                         E = ∫ dr/dt × (z × r) dm                      C_ji = z_i · E + dz_i/dt · n
//! ```
//!
//! E is a moment without a force, because the force of d/dt ∂_j x is the rate of f: moved from o_j to o_i it gains
//! d(o_j - o_i)/dt × f, where n gains (o_j - o_i) × f. No linear velocity occurs elsewhere.
//! The composite method for C is that of Echeandia and Wensing (2021, "Numerical methods to compute the Coriolis matrix and Christoffel
//! symbols for rigid-body systems"); moments instead of 6 x 6 matrices and the relative velocities are ours.
//!
//! A rotor of inertia I_m about a, ratio k, on the parent of joint j, adds I_m k a to n and ½ I_m k ω × a to N and to E; and what
//! carries spinning rotors feels the spin s = Σ I_m k dq a: ½ z × s in N, its opposite in E.

use super::arm::{symmetric, Arm, Body, Joint};
use super::inertia::composite_bodies;
use crate::ring::matrix::{Matrix, Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// What moves in a composite body, in its joint frame and relative to it.
#[derive(Clone, Copy)]
struct Flow {
    /// h' = ∫ v dm.
    first: Vector,
    /// K = ∫ v r' dm.
    second: Matrix,
    /// s = Σ I_m k dq a.
    spin: Vector,
}

/// The wrenches of a column, about the origin of the frame that they are in.
#[derive(Clone, Copy)]
struct Column {
    /// f, n: of ∂x/∂q_j.
    inertial: (Vector, Vector),
    /// F, N: of its rate.
    coriolis: (Vector, Vector),
    /// E.
    transposed: Vector,
}

/// C(q, dq), all entries.
pub fn coriolis_matrix(pool: &mut Pool, arm: &Arm) -> Vec<Vec<ExprId>> {
    let n = arm.dof();
    let composite = composite_bodies(pool, arm);
    let omega = angular_velocities(pool, arm);
    let flows = flows(pool, arm, &composite);
    let mut c = vec![vec![ExprId::ZERO; n]; n];
    for j in 0..n {
        let joint = &arm.joints[j];
        let outer = joint.parent.map_or(ZERO, |p| omega[p]);
        let turning = pool.transform_back(&joint.fixed, &outer);
        let (body, flow) = about_axis(pool, joint, &composite[j], &flows[j]);
        let mut column = column(pool, joint, &turning, &body, &flow);
        c[j][j] = if joint.is_revolute() { column.coriolis.1[2] } else { column.coriolis.0[2] };
        let mut link = j;
        while let Some(parent) = arm.joints[link].parent {
            column = outward(pool, arm, link, &column, &omega[parent], link == j);
            if link == j {
                add_rotor(pool, joint, &omega[parent], &mut column);
            }
            let w = omega[parent];
            if arm.joints[parent].is_revolute() {
                c[parent][j] = column.coriolis.1[2];
                let turned = pool.dot(&[w[1], -w[0]], &[column.inertial.1[0], column.inertial.1[1]]);
                c[j][parent] = pool.add(column.transposed[2], turned);
            } else {
                c[parent][j] = column.coriolis.0[2];
                c[j][parent] = pool.dot(&[w[1], -w[0]], &[column.inertial.0[0], column.inertial.0[1]]);
            }
            link = parent;
        }
    }
    c
}

/// Angular velocity of each joint frame, in its own axes.
fn angular_velocities(pool: &mut Pool, arm: &Arm) -> Vec<Vector> {
    let mut omega: Vec<Vector> = Vec::with_capacity(arm.dof());
    for joint in &arm.joints {
        let outer = joint.parent.map_or(ZERO, |p| omega[p]);
        let mut own = joint.inward(pool, &outer);
        own[2] = pool.add(own[2], joint.spin);
        omega.push(own);
    }
    omega
}

/// Velocity moments of each composite body relative to the link that carries all of it, in its joint frame.
fn flows(pool: &mut Pool, arm: &Arm, composite: &[Body]) -> Vec<Flow> {
    let mut flows = vec![Flow { first: ZERO, second: [ZERO; 3], spin: ZERO }; arm.dof()];
    for i in (0..arm.dof()).rev() {
        let joint = &arm.joints[i];
        let Some(p) = joint.parent else { continue };
        let (body, flow) = about_axis(pool, joint, &composite[i], &flows[i]);
        let (h, rate) = (pool.transform(&joint.fixed, &body.first), pool.transform(&joint.fixed, &flow.first));
        let velocity = origin_rate(pool, arm, i);
        // x = o + r moves with o' + v: ∫ (o' + v)(o + r)' dm.
        let weighted = pool.scale(body.mass, &velocity);
        let first = pool.add_vectors(&rate, &weighted);
        let half = pool.product(&joint.fixed, &flow.second);
        let mut second = pool.product(&half, &crate::ring::matrix::transpose(&joint.fixed));
        for a in 0..3 {
            for b in 0..3 {
                let moved = pool.dot(&[velocity[a], first[a]], &[h[b], joint.origin[b]]);
                second[a][b] = pool.add(second[a][b], moved);
            }
        }
        let mut spin = pool.transform(&joint.fixed, &flow.spin);
        if let Some(rotor) = joint.rotor {
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let rate = pool.symbol(Symbol::Rate(i as u16));
            let momentum = pool.mul(coupling, rate);
            let own = pool.scale(momentum, &rotor.axis);
            spin = pool.add_vectors(&spin, &own);
        }
        flows[p] = Flow {
            first: pool.add_vectors(&flows[p].first, &first),
            second: pool.add_matrices(&flows[p].second, &second),
            spin: pool.add_vectors(&flows[p].spin, &spin),
        };
    }
    flows
}

/// Velocity of the origin of joint frame i relative to its parent's joint frame.
fn origin_rate(pool: &mut Pool, arm: &Arm, i: usize) -> Vector {
    let joint = &arm.joints[i];
    if joint.is_revolute() {
        return ZERO;
    }
    let rate = pool.symbol(Symbol::Rate(i as u16));
    pool.scale(rate, &[joint.fixed[0][2], joint.fixed[1][2], joint.fixed[2][2]])
}

/// A composite body in the axes of its parent turned by `fixed`, and its motion relative to that parent.
fn about_axis(pool: &mut Pool, joint: &Joint, body: &Body, flow: &Flow) -> (Body, Flow) {
    let s = joint.tensor_about_axis(pool, &symmetric(&body.second));
    let h = joint.about_axis(pool, &body.first);
    let mut k = joint.tensor_about_axis(pool, &flow.second);
    let mut rate = joint.about_axis(pool, &flow.first);
    let turn = [-joint.spin, joint.spin];
    for (to, from) in [(0, 1), (1, 0)] {
        let swept = pool.mul(turn[to], h[from]);
        rate[to] = pool.add(rate[to], swept);
        for b in 0..3 {
            let swept = pool.mul(turn[to], s[from][b]);
            k[to][b] = pool.add(k[to][b], swept);
        }
    }
    let second = super::arm::PAIRS.map(|(a, b)| s[a][b]);
    (Body { mass: body.mass, first: h, second }, Flow { first: rate, second: k, spin: joint.about_axis(pool, &flow.spin) })
}

/// The wrenches of column j about the origin of its frame, in the axes of `about_axis`.
fn column(pool: &mut Pool, joint: &Joint, w: &Vector, body: &Body, flow: &Flow) -> Column {
    let (h, rate, k) = (body.first, flow.first, flow.second);
    if !joint.is_revolute() {
        // ∂x = z, its rate Ω × z; E = ∫ dr/dt × z dm.
        let turning = [w[1], -w[0], ExprId::ZERO];
        let swept = pool.cross(w, &h);
        let velocity = pool.add_vectors(&swept, &rate);
        return Column {
            inertial: ([ExprId::ZERO, ExprId::ZERO, body.mass], [h[1], -h[0], ExprId::ZERO]),
            coriolis: (pool.scale(body.mass, &turning), pool.cross(&h, &turning)),
            transposed: [velocity[1], -velocity[0], ExprId::ZERO],
        };
    }
    let [xx, xy, yy, xz, yz, _] = body.second;
    let f = [-h[1], h[0], ExprId::ZERO];
    let swept = pool.cross(w, &f);
    let force = pool.add_vectors(&swept, &[-rate[1], rate[0], ExprId::ZERO]);
    let trace = pool.add(k[0][0], k[1][1]);
    let half = pool.fraction(1, 2);
    let spin = [pool.mul(half, flow.spin[0]), pool.mul(half, flow.spin[1])];
    let (ax, ay) = (pool.dot(&[xx, xy, xz], w), pool.dot(&[xy, yy, yz], w));
    let (bx, by) = (pool.dot(&[xx, -xy], &[w[1], w[0]]), pool.dot(&[xy, -yy], &[w[1], w[0]]));
    let bz = pool.dot(&[xz, -yz], &[w[1], w[0]]);
    Column {
        inertial: (f, [-xz, -yz, pool.add(xx, yy)]),
        coriolis: (force, [pool.sum([ay, -k[0][2], -spin[1]]), pool.sum([-ax, -k[1][2], spin[0]]), trace]),
        transposed: [pool.sum([bx, -k[2][0], spin[1]]), pool.sum([by, -k[2][1], -spin[0]]), pool.add(trace, bz)],
    }
}

/// The column in the parent's frame, about its origin; `first` if it is still in the axes of `about_axis`.
fn outward(pool: &mut Pool, arm: &Arm, i: usize, column: &Column, outer: &Vector, first: bool) -> Column {
    let joint = &arm.joints[i];
    let mut turn = |v: &Vector| if first { pool.transform(&joint.fixed, v) } else { joint.outward(pool, v) };
    let (f, n) = (turn(&column.inertial.0), turn(&column.inertial.1));
    let (force, moment) = (turn(&column.coriolis.0), turn(&column.coriolis.1));
    let transposed = turn(&column.transposed);
    let swept = pool.cross(outer, &joint.origin);
    let sliding = origin_rate(pool, arm, i);
    let velocity = pool.add_vectors(&swept, &sliding);
    let mut moved = |at: &Vector, force: &Vector, moment: &Vector| {
        let lever = pool.cross(at, force);
        pool.add_vectors(moment, &lever)
    };
    Column {
        inertial: (f, moved(&joint.origin, &f, &n)),
        coriolis: (force, moved(&joint.origin, &force, &moment)),
        transposed: moved(&velocity, &f, &transposed),
    }
}

/// What the rotor of a joint adds to its column, in the frame of the link that it rides on.
fn add_rotor(pool: &mut Pool, joint: &Joint, omega: &Vector, column: &mut Column) {
    let Some(rotor) = joint.rotor else { return };
    let coupling = pool.mul(rotor.inertia, rotor.ratio);
    let momentum = pool.scale(coupling, &rotor.axis);
    let half = pool.fraction(1, 2);
    let turning = pool.cross(omega, &momentum);
    let turning = pool.scale(half, &turning);
    column.inertial.1 = pool.add_vectors(&column.inertial.1, &momentum);
    column.coriolis.1 = pool.add_vectors(&column.coriolis.1, &turning);
    column.transposed = pool.add_vectors(&column.transposed, &turning);
}
