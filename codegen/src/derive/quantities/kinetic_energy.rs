//! Kinetic energy of links and rotors.
//!
//! ```text
//! T = Σ_i ½ m v·v + v·(omega × h) + ½ omega' (tr(S) 1 - S) omega + rotors                   (the book, Sect. 7.1.1)
//! ```

use crate::derive::arm::{symmetric, Arm};
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Quantity, Recursion, ResultPart, Typeset};
use crate::derive::rotors;
use crate::ring::matrix::{Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// T(q, dq).
pub static KINETIC_ENERGY: Quantity = Quantity {
    name: "kinetic_energy",
    symbol: Typeset::new("T(q, dq)", "\\mathcal T(q, \\dot q)"),
    arguments: &[Argument::Q, Argument::Dq],
    result: &[ResultPart::whole(Typeset::new("T(q, dq)", "\\mathcal T(q, \\dot q)"), Typeset::new("T", "\\mathcal T"), &[], "J")],
    structure: None,
    has_parameters: true,
    documentation: Documentation::new(
        "Kinetic energy of links and rotors.",
        "T = 1/2 dq' B(q) dq                                               (Siciliano et al., eq. 7.31)",
        "an energy, J.",
    ),
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, _, _| vec![kinetic_energy(pool, arm)]),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Dynamics"),
};

/// T(q, dq), J.
pub fn kinetic_energy(pool: &mut Pool, arm: &Arm) -> ExprId {
    let rates = arm.symbols(pool, Symbol::Rate);
    let half = pool.fraction(1, 2);
    let mut motions: Vec<(Vector, Vector)> = Vec::with_capacity(arm.dof());
    let mut twice = ExprId::ZERO;
    for (i, joint) in arm.joints.iter().enumerate() {
        let (outer_omega, outer_v) = joint.parent.map_or((ZERO, ZERO), |p| motions[p]);
        let carried = pool.cross(&outer_omega, &joint.origin);
        let origin = pool.add_vectors(&outer_v, &carried);
        let (mut omega, mut v) = (joint.from_parent(pool, &outer_omega), joint.from_parent(pool, &origin));
        let moving = if joint.is_revolute() { &mut omega } else { &mut v };
        moving[2] = pool.add(moving[2], rates[i]);
        motions.push((omega, v));

        let body = &joint.body;
        let square = pool.dot3(&v, &v);
        let linear = pool.mul(body.mass, square);
        let omega_cross_h = pool.cross(&omega, &body.first);
        let two_v = v.map(|x| {
            let two = pool.integer(2);
            pool.mul(two, x)
        });
        let mixed = pool.dot3(&two_v, &omega_cross_h);
        let second = symmetric(&body.second);
        let trace = pool.sum([second[0][0], second[1][1], second[2][2]]);
        let mut inertia = second.map(|row| row.map(|x| -x));
        for k in 0..3 {
            inertia[k][k] = pool.add(trace, inertia[k][k]);
        }
        let momentum = pool.transform(&inertia, &omega);
        let angular = pool.dot3(&omega, &momentum);
        twice = pool.sum([twice, linear, mixed, angular]);
        if let Some(rotor) = joint.rotor {
            // I_m k dq (2 z·omega_p + k dq)
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let along = pool.dot3(&rotor.axis, &outer_omega);
            let two = pool.integer(2);
            let (carried, own) = (pool.mul(two, along), pool.mul(rotor.ratio, rates[i]));
            let speed = pool.add(carried, own);
            let momentum = pool.mul(coupling, speed);
            let energy = pool.mul(momentum, rates[i]);
            twice = pool.add(twice, energy);
        }
        let momentum = pool.mul(joint.armature, rates[i]);
        let energy = pool.mul(momentum, rates[i]);
        twice = pool.add(twice, energy);
    }
    let omegas: Vec<Vector> = motions.iter().map(|(omega, _)| *omega).collect();
    let of_rotors = rotors::twice_energy(pool, arm, &omegas, &rates);
    twice = pool.add(twice, of_rotors);
    pool.mul(half, twice)
}
