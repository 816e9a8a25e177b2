//! The Coriolis and centrifugal matrix C(q, dq) by Christoffel symbols of the first kind, by recursion over composite bodies.
//!
//! ```text
//! C_ij = Σ_k c_ijk dq_k,   c_ijk = ½ (∂b_ij/∂q_k + ∂b_ik/∂q_j - ∂b_jk/∂q_i)              (the book, eq. 7.45)
//!      = ∫ ∂x/∂q_i · d/dt (∂x/∂q_j) dm
//! ```
//!
//! where b_ij = ∫ ∂_i x · ∂_j x dm: of the six terms in the three derivatives two are equal and the others cancel, so that the ½ goes and
//! c_ijk = ∫ ∂_i x · ∂_j ∂_k x dm. With this choice dB/dt - 2C is skew-symmetric, as passivity-based control needs.
//!
//! For a revolute joint j, ∂_j x = z × r with r from a point of its axis, and d/dt ∂_j x = dz/dt × r + z × dr/dt, over all that joint j
//! carries. With Ω the angular velocity of the parent link, dr/dt = Ω × r + v, where v is the velocity *relative to the parent*.
//! The moments K = ∫ v rᵀ dm and h_v = ∫ v dm, with h = ∫ r dm and S = ∫ r rᵀ dm, determine all entries. An ancestor i feels
//! the wrench of ∂_j x in B_ij, that of d/dt ∂_j x in C_ij, and in C_ji = ∫ ∂_j x · (dz_i/dt × r + z_i × dr/dt) dm
//!
//! ```text
//! f = z × h,              n = (tr S) z - S z                            B_ij = z_i · n
//! F = Ω × f + z × h_v,    N = (S Ω) × z + (tr K) z - K z                C_ij = z_i · N
//!                         E = ∫ dr/dt × (z × r) dm                      C_ji = z_i · E + dz_i/dt · n
//! ```
//!
//! E is a moment without a force, because the force of d/dt ∂_j x is the rate of f: moved from o_j to o_i it gains
//! d(o_j - o_i)/dt × f, where n gains (o_j - o_i) × f. No linear velocity occurs elsewhere. Relative to the parent link it is
//! E + n × Ω = z × (S Ω) + (tr K) z - Kᵀ z, with the same S Ω as N.
//! The composite method for C is that of Echeandia and Wensing (2021, "Numerical methods to compute the Coriolis matrix and Christoffel
//! symbols for rigid-body systems"); moments instead of 6 x 6 matrices and the relative velocities are ours.
//!
//! A rotor of inertia I_m about a, ratio k, on the parent of joint j, adds I_m k a to n. What b_ij has of it, I_m k a · z_i, changes with the
//! joints between i and the parent, and b_ik has nothing that changes with q_j: one of the three derivatives is 0, and the ½ stays, as
//! ½ I_m k ω × a in N and in E, ω the angular velocity of the parent link; and what
//! carries turning rotors feels their momentum s = Σ I_m k dq a: ½ z × s in N, its opposite in E.

use super::inertia::composite_bodies;
use crate::derive::arm::{symmetric, Arm, Body, Joint};
use crate::derive::columns::{origin_rate, Column, ColumnPropagator, Rate};
use crate::derive::passes::RewriteScope;
use crate::derive::plan::Plan;
use crate::derive::quantity::{Argument, Documentation, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::derive::rotors;
use crate::ring::matrix::{Matrix, Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// C(q, dq).
pub static CORIOLIS_MATRIX: Quantity = Quantity {
    name: "coriolis_matrix",
    symbol: Typeset::new("C(q, dq)", "C(q, \\dot q)"),
    arguments: &[Argument::Q, Argument::Dq],
    result: &[ResultPart::whole(
        Typeset::new("C(q, dq)", "C(q, \\dot q)"),
        Typeset::plain("c"),
        &[Length::Dof, Length::Dof],
        "as B, per s",
    )],
    structure: None,
    has_parameters: true,
    documentation: Documentation::new(
        "Coriolis and centrifugal matrix C(q, dq) by Christoffel symbols of the first kind: dB/dt - 2C is skew-symmetric.",
        "C_ij = sum_k 1/2 (dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i) dq_k       (Siciliano et al., eq. 7.45)",
        "`c[row][column]`, on the left of the equation of motion: C dq is part of the torque.",
    ),
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| coriolis_matrix(pool, arm, plan).concat()),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Dynamics"),
};

/// What moves in a composite body, in its joint frame and relative to it.
#[derive(Clone, Copy)]
pub(super) struct VelocityMoments {
    /// h_v = ∫ v dm.
    pub(super) first: Vector,
    /// K = ∫ v rᵀ dm.
    pub(super) second: Matrix,
    /// s = Σ I_m k dq a: angular momentum of rotors about their own axes.
    pub(super) rotors: Vector,
}

/// C(q, dq), all entries.
pub fn coriolis_matrix(pool: &mut Pool, arm: &Arm, plan: &mut Plan) -> Vec<Vec<ExprId>> {
    inertia_and_coriolis(pool, arm, plan).1
}

/// B(q) and C(q, dq), all entries.
pub fn inertia_and_coriolis(pool: &mut Pool, arm: &Arm, plan: &mut Plan) -> (Vec<Vec<ExprId>>, Vec<Vec<ExprId>>) {
    let n = arm.dof();
    let composite = composite_bodies(pool, arm);
    let omega = angular_velocities(pool, arm);
    let velocity_moments = velocity_moments(pool, arm, &composite);
    let mut propagator = ColumnPropagator::new(arm, Some(&omega));
    let mut b = vec![vec![ExprId::ZERO; n]; n];
    let mut c = vec![vec![ExprId::ZERO; n]; n];
    for j in (0..n).rev() {
        let joint = &arm.joints[j];
        let column = composite_column(pool, arm, j, &omega, &composite[j], &velocity_moments[j]);
        (b[j][j], c[j][j]) = column.own_entries(pool, joint);
        let mut propagated = propagator.start(pool, plan, column, j);
        while let Some(parent) = propagator.propagate_to_parent(pool, plan, &mut propagated) {
            let entries = propagator.entries(pool, &propagated);
            b[parent][j] = entries.inertia;
            b[j][parent] = entries.inertia;
            c[parent][j] = entries.coriolis;
            c[j][parent] = entries.coriolis_transposed;
        }
    }
    if !arm.rotors.is_empty() {
        let rates = arm.symbols(pool, Symbol::Rate);
        rotors::add_inertia(pool, arm, &mut b);
        rotors::add_coriolis(pool, arm, &omega, &rates, &mut c);
    }
    (b, c)
}

/// Angular velocity of each joint frame, in its own axes.
pub(super) fn angular_velocities(pool: &mut Pool, arm: &Arm) -> Vec<Vector> {
    let mut omega: Vec<Vector> = Vec::with_capacity(arm.dof());
    for joint in &arm.joints {
        let outer = joint.parent.map_or(ZERO, |p| omega[p]);
        let mut own = joint.from_parent(pool, &outer);
        own[2] = pool.add(own[2], joint.frame_rate);
        omega.push(own);
    }
    omega
}

/// Velocity moments of each composite body relative to the link that carries all of it, in its joint frame.
pub(super) fn velocity_moments(pool: &mut Pool, arm: &Arm, composite: &[Body]) -> Vec<VelocityMoments> {
    let still = VelocityMoments { first: ZERO, second: [ZERO; 3], rotors: ZERO };
    let mut velocity_moments: Vec<VelocityMoments> =
        arm.joints.iter().map(|joint| turning_about_z(pool, joint.link_rate, &joint.body, &still)).collect();
    for i in (0..arm.dof()).rev() {
        let joint = &arm.joints[i];
        let Some(p) = joint.parent else { continue };
        let (body, moments) = about_axis(pool, joint, &composite[i], &velocity_moments[i]);
        let (h, rate) = (pool.transform(&joint.fixed, &body.first), pool.transform(&joint.fixed, &moments.first));
        let velocity = origin_rate(pool, arm, i);
        // x = o + r moves with do/dt + v: ∫ (do/dt + v)(o + r)ᵀ dm.
        let weighted = pool.scale(body.mass, &velocity);
        let first = pool.add_vectors(&rate, &weighted);
        let half = pool.product(&joint.fixed, &moments.second);
        let mut second = pool.product(&half, &crate::ring::matrix::transpose(&joint.fixed));
        for a in 0..3 {
            for b in 0..3 {
                let moved = pool.dot(&[velocity[a], first[a]], &[h[b], joint.origin[b]]);
                second[a][b] = pool.add(second[a][b], moved);
            }
        }
        let mut rotors = pool.transform(&joint.fixed, &moments.rotors);
        if let Some(rotor) = joint.rotor {
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let rate = pool.symbol(Symbol::Rate(i as u16));
            let momentum = pool.mul(coupling, rate);
            let own = pool.scale(momentum, &rotor.axis);
            rotors = pool.add_vectors(&rotors, &own);
        }
        velocity_moments[p] = VelocityMoments {
            first: pool.add_vectors(&velocity_moments[p].first, &first),
            second: pool.add_matrices(&velocity_moments[p].second, &second),
            rotors: pool.add_vectors(&velocity_moments[p].rotors, &rotors),
        };
    }
    velocity_moments
}

/// Velocity moments of a body that also turns about z at `rate` w: h_v + w z × h, K + w [z] S.
fn turning_about_z(pool: &mut Pool, rate: ExprId, body: &Body, moments: &VelocityMoments) -> VelocityMoments {
    let s = symmetric(&body.second);
    let mut moments = *moments;
    for (to, from, rate) in [(0, 1, -rate), (1, 0, rate)] {
        let moved = pool.mul(rate, body.first[from]);
        moments.first[to] = pool.add(moments.first[to], moved);
        for b in 0..3 {
            let moved = pool.mul(rate, s[from][b]);
            moments.second[to][b] = pool.add(moments.second[to][b], moved);
        }
    }
    moments
}

/// A composite body in the axes of its parent turned by `fixed`, and its motion relative to that parent.
fn about_axis(pool: &mut Pool, joint: &Joint, body: &Body, moments: &VelocityMoments) -> (Body, VelocityMoments) {
    // Traces of the upper left blocks are invariant under rotation about z: interned before the rotation, they are the nodes that the sums
    // formed after it resolve to.
    pool.intern_sum(body.second[0], body.second[2]);
    pool.intern_sum(moments.second[0][0], moments.second[1][1]);
    let turned = joint.body_about_axis(pool, body);
    let moments = VelocityMoments {
        first: joint.about_axis(pool, &moments.first),
        second: joint.tensor_about_axis(pool, &moments.second),
        rotors: joint.about_axis(pool, &moments.rotors),
    };
    (turned, turning_about_z(pool, joint.frame_rate, &turned, &moments))
}

/// The wrenches of column j of what joint j carries, about the origin of its frame, in the axes of `about_axis`.
pub(super) fn composite_column(
    pool: &mut Pool,
    arm: &Arm,
    j: usize,
    omega: &[Vector],
    body: &Body,
    moments: &VelocityMoments,
) -> Column {
    let joint = &arm.joints[j];
    let outer = joint.parent.map_or(ZERO, |p| omega[p]);
    let w = pool.transform_back(&joint.fixed, &outer);
    let (body, moments) = about_axis(pool, joint, body, moments);
    column(pool, joint, &w, &body, &moments)
}

/// The wrenches of column j about the origin of its frame, in the axes of `about_axis`.
fn column(pool: &mut Pool, joint: &Joint, w: &Vector, body: &Body, moments: &VelocityMoments) -> Column {
    let (h, rate, k) = (body.first, moments.first, moments.second);
    if !joint.is_revolute() {
        // ∂x = z, its rate Ω × z; E + n × Ω = h_v × z + (Ω × z) × h.
        let turning = [w[1], -w[0], ExprId::ZERO];
        let transport = pool.cross(&turning, &h);
        return Column {
            inertial: ([ExprId::ZERO, ExprId::ZERO, body.mass], [h[1], -h[0], ExprId::ZERO]),
            rate: Some(Rate {
                coriolis: (pool.scale(body.mass, &turning), transport.map(|x| -x)),
                transposed_moment: pool.add_vectors(&[rate[1], -rate[0], ExprId::ZERO], &transport),
            }),
        };
    }
    let [xx, xy, yy, xz, yz, _] = body.second;
    let f = [-h[1], h[0], ExprId::ZERO];
    let transport = pool.cross(w, &f);
    let force = pool.add_vectors(&transport, &[-rate[1], rate[0], ExprId::ZERO]);
    let trace = pool.add(k[0][0], k[1][1]);
    let half = pool.fraction(1, 2);
    let rotors = [pool.mul(half, moments.rotors[0]), pool.mul(half, moments.rotors[1])];
    let (ax, ay) = (pool.dot(&[xx, xy, xz], w), pool.dot(&[xy, yy, yz], w));
    Column {
        inertial: (f, [-xz, -yz, pool.add(xx, yy)]),
        rate: Some(Rate {
            coriolis: (force, [pool.sum([ay, -k[0][2], -rotors[1]]), pool.sum([-ax, -k[1][2], rotors[0]]), trace]),
            transposed_moment: [pool.sum([-ay, -k[2][0], rotors[1]]), pool.sum([ax, -k[2][1], -rotors[0]]), trace],
        }),
    }
}
