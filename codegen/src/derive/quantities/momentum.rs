//! For momentum observers: the generalised momentum B dq and C' dq, by one recursion.
//!
//! ```text
//! p = B dq = ∂T/∂dq                                                              (the book, Sect. 7.1.1)
//! C' dq = ∂T/∂q          as Σ_ij c_ijk dq_i dq_j = ½ Σ_ij ∂b_ij/∂q_k dq_i dq_j for Christoffel's symbols
//! tau = dp/dt - C' dq + F + g                                                    (De Luca and Mattone 2003)
//! ```
//!
//! The links that joint k carries have the linear momentum f and the angular momentum n about o_k. The entry p_k is the component
//! along the axis. For these links, turning joint k is the same as turning the motion of the link before it the other way. With ω
//! and v of link k,
//!
//! ```text
//! p_k = z · n,   ∂T/∂q_k = n · (ω × z) + f · (v × z)        (revolute)
//! p_k = z · f,   ∂T/∂q_k = f · (ω × z)                      (prismatic)
//! ```
//!
//! The rotor of joint i contributes I_m k dq_i z_m besides the part that turns with its link, and I_m k (k dq_i + z_m · ω) to
//! p_i.

use crate::derive::arm::{symmetric, Arm};
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::derive::rotors;
use crate::derive::wrench::{axis_component, wrench_to_parent};
use crate::ring::matrix::{Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// In the order of the emitted module.
pub(super) static DECLARED: [&Quantity; 2] = [&MOMENTUM, &CORIOLIS_TRANSPOSE_TIMES];

/// B(q) dq.
pub static MOMENTUM: Quantity = Quantity {
    name: "momentum",
    symbol: Typeset::new("B dq", "B(q) \\dot q"),
    arguments: &[Argument::Q, Argument::Dq],
    result: &[ResultPart::whole(Typeset::new("B dq", "B(q) \\dot q"), Typeset::plain("p"), &[Length::Dof], "N m s or N s")],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Generalised momentum B(q) dq, for a momentum observer.",
        "p = B(q) dq = dT/d(dq)                                            (De Luca and Mattone 2003)",
        "a momentum, N m s (revolute) or N s (prismatic), for each joint.",
    ),
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, _, _| momentum(pool, arm)),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Momentum"),
};

/// C(q, dq)' dq.
pub static CORIOLIS_TRANSPOSE_TIMES: Quantity = Quantity {
    name: "coriolis_transpose_times",
    symbol: Typeset::new("C' dq", "C^T(q, \\dot q) \\dot q"),
    arguments: &[Argument::Q, Argument::Dq],
    result: &[ResultPart::whole(
        Typeset::new("C' dq", "C^T(q, \\dot q) \\dot q"),
        Typeset::plain("c"),
        &[Length::Dof],
        "N m or N",
    )],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "C(q, dq)' dq with C by Christoffel symbols, for a momentum observer.",
        "C' dq = dT/dq = (dB/dt) dq - C dq,  dp/dt = tau + C' dq - F - g    (De Luca and Mattone 2003)",
        "a torque, N m (revolute), or a force, N (prismatic), for each joint, on the right of the equation of dp/dt.",
    )
    .with(Feature::LoadFriction, "F is {friction} and {load_friction} together."),
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, _, _| coriolis_transpose_times(pool, arm)),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("CoriolisTransposeTimes"),
};

/// Velocities of a link, and the momentum of all that it carries, in its joint frame.
struct State {
    omega: Vector,
    velocity: Vector,
    linear: Vector,
    angular: Vector,
}

/// B(q) dq.
pub fn momentum(pool: &mut Pool, arm: &Arm) -> Vec<ExprId> {
    momenta(pool, arm).0
}

/// C(q, dq)' dq.
pub fn coriolis_transpose_times(pool: &mut Pool, arm: &Arm) -> Vec<ExprId> {
    let (_, states) = momenta(pool, arm);
    let mut gradient: Vec<ExprId> = states
        .iter()
        .zip(&arm.joints)
        .map(|(State { omega: w, velocity: v, linear: f, angular: n }, joint)| {
            if joint.is_revolute() {
                pool.dot(&[n[0], -n[1], f[0], -f[1]], &[w[1], w[0], v[1], v[0]])
            } else {
                pool.dot(&[f[0], -f[1]], &[w[1], w[0]])
            }
        })
        .collect();
    let rates = arm.symbols(pool, Symbol::Rate);
    rotors::add_energy_gradient(pool, arm, &omegas(&states), &rates, &mut gradient);
    gradient
}

fn omegas(states: &[State]) -> Vec<Vector> {
    states.iter().map(|state| state.omega).collect()
}

fn momenta(pool: &mut Pool, arm: &Arm) -> (Vec<ExprId>, Vec<State>) {
    let rates = arm.symbols(pool, Symbol::Rate);
    let mut states: Vec<State> = Vec::with_capacity(arm.dof());
    for (joint, &rate) in arm.joints.iter().zip(&rates) {
        let (outer, moving) = joint.parent.map_or((ZERO, ZERO), |p| (states[p].omega, states[p].velocity));
        let transport = pool.cross(&outer, &joint.origin);
        let origin = pool.add_vectors(&moving, &transport);
        let (mut omega, mut velocity) = (joint.from_parent(pool, &outer), joint.from_parent(pool, &origin));
        let driven = if joint.is_revolute() { &mut omega } else { &mut velocity };
        driven[2] = pool.add(driven[2], rate);

        // f = m v + ω × h,   n = h × v + (tr(S) 1 - S) ω
        let body = &joint.body;
        let (weighted, turning) = (pool.scale(body.mass, &velocity), pool.cross(&omega, &body.first));
        let linear = pool.add_vectors(&weighted, &turning);
        let second = symmetric(&body.second);
        let mut inertia = second.map(|row| row.map(|x| -x));
        for (k, (i, j)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
            inertia[k][k] = pool.add(second[i][i], second[j][j]);
        }
        let (turned, lever) = (pool.transform(&inertia, &omega), pool.cross(&body.first, &velocity));
        let angular = pool.add_vectors(&turned, &lever);
        states.push(State { omega, velocity, linear, angular });
    }
    let mut p = vec![ExprId::ZERO; arm.dof()];
    for i in (0..arm.dof()).rev() {
        let joint = &arm.joints[i];
        let (linear, angular) = (states[i].linear, states[i].angular);
        p[i] = axis_component(arm, i, &linear, &angular);
        let mut rotor_momentum = ZERO;
        if let Some(rotor) = joint.rotor {
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let outer = joint.parent.map_or(ZERO, |parent| states[parent].omega);
            let (own, carried) = (pool.mul(rotor.ratio, rates[i]), pool.dot3(&rotor.axis, &outer));
            let speed = pool.add(own, carried);
            let felt = pool.mul(coupling, speed);
            p[i] = pool.add(p[i], felt);
            let momentum = pool.mul(coupling, rates[i]);
            rotor_momentum = pool.scale(momentum, &rotor.axis);
        }
        let own = pool.mul(joint.armature, rates[i]);
        p[i] = pool.add(p[i], own);
        if let Some(parent) = joint.parent {
            let (linear, angular) = wrench_to_parent(pool, arm, i, &linear, &angular);
            let angular = pool.add_vectors(&angular, &rotor_momentum);
            states[parent].linear = pool.add_vectors(&states[parent].linear, &linear);
            states[parent].angular = pool.add_vectors(&states[parent].angular, &angular);
        }
    }
    rotors::add_momentum(pool, arm, &omegas(&states), &rates, &mut p);
    (p, states)
}
