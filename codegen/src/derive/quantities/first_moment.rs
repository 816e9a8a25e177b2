//! What follows from the first moment of the whole arm in the base frame: the potential energy of gravity and the centre of mass.
//!
//! ```text
//! h = Σ_i m_i p_li,   U = -g0' h,   p_c = h / Σ_i m_i                                 (the book, eq. 7.36)
//! ```

use super::kinematics::frames;
use crate::derive::arm::Arm;
use crate::derive::model::Model;
use crate::derive::newton_euler::deflection;
use crate::derive::parameters::{ParameterKind, View};
use crate::derive::passes::RewriteScope;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::ring::matrix::Vector;
use crate::ring::{ExprId, Pool};

/// In the order of the emitted module.
pub(super) static DECLARED: [&Quantity; 2] = [&POTENTIAL_ENERGY, &CENTER_OF_MASS];

/// U(q).
pub static POTENTIAL_ENERGY: Quantity = Quantity {
    name: "potential_energy",
    symbol: Typeset::new("U(q)", "\\mathcal U(q)"),
    arguments: &[Argument::Gravity, Argument::Q],
    result: &[ResultPart::whole(Typeset::new("U(q)", "\\mathcal U(q)"), Typeset::new("U", "\\mathcal U"), &[], "J")],
    structure: None,
    has_parameters: true,
    documentation: Documentation {
        names_gravity: true,
        ..Documentation::new(
            "Potential energy of gravity; zero where all masses, rotors included, lie at the origin of the base frame.",
            "U(q) = - sum_i m_i g0' p_li                                       (Siciliano et al., eq. 7.36)",
            "an energy, J.",
        )
        .with(Feature::Spring, "A spring of a joint adds 1/2 k_s (q_i - rest)².")
        .with_base(
            "Base parameters leave out what no torque depends on: this is the energy of the arm that has them in place of the standard ones, and \
             0 for those that are not among them. At {NOMINAL_PARAMETERS} it is {potential_energy} and a constant, \
             U_with(pi, q) - U_with(pi, q0) = U(q) - U(q0) for all q and q0.",
        )
    },
    recursion: Recursion::new(RewriteScope::KeepParameters, |pool, arm, _, _| vec![potential_energy(pool, arm)]),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("Dynamics"),
};

/// p_c(q).
pub static CENTER_OF_MASS: Quantity = Quantity {
    name: "center_of_mass",
    symbol: Typeset::plain("p_c(q)"),
    arguments: &[Argument::Q],
    result: &[ResultPart::whole(Typeset::plain("p_c(q)"), Typeset::plain("p_c"), &[Length::Fixed(3)], "m")],
    structure: None,
    has_parameters: true,
    documentation: Documentation {
        failure: ["cannot fail", "not finite where the masses add up to 0"],
        ..Documentation::new(
            "Centre of mass of the whole arm in the base frame: links, load and rotors, those that the base carries included.",
            "p_c(q) = sum_i m_i p_li / m,  m = sum_i m_i,  U(q) = - m g0' p_c",
            "its x, y and z, m.",
        )
        .with(Feature::Spring, "In {potential_energy} springs have their energies besides.")
    },
    recursion: Recursion::new(RewriteScope::KeepParameters, |pool, arm, _, input| {
        let (first, mass) = (first_moment(pool, arm), total_mass(pool, arm, input.model, input.view));
        let inverse = pool.reciprocal(mass);
        pool.scale(inverse, &first).to_vec()
    }),
    missing: no_center_of_mass,
    gathers: &[],
    interface: Some("CenterOfMass"),
};

/// Why an arm has no centre of mass, or none that its parameters give.
fn no_center_of_mass(model: &Model, with_parameters: bool) -> Option<String> {
    if with_parameters && matches!(model.parameters.kind, ParameterKind::Base(_)) {
        return Some("base parameters are what torques tell apart, which does not give the mass of the arm".into());
    }
    let view = if with_parameters { View::Vector(&model.parameters) } else { View::Nominal };
    let mut pool = Pool::new(model.field.clone());
    let arm = Arm::new(&mut pool, &model.manipulator, view);
    (total_mass(&mut pool, &arm, model, view) == ExprId::ZERO).then(|| "its bodies have no mass".into())
}

/// Σ_i m_i over the bodies of [`first_moment`], kg.
fn total_mass(pool: &mut Pool, arm: &Arm, model: &Model, view: View<'_>) -> ExprId {
    let carried: Vec<ExprId> = arm.joints.iter().map(|joint| joint.body.mass).collect();
    let mut total = pool.sum(carried);
    for motor in model.manipulator.joints.iter().filter_map(|joint| joint.motor.as_ref()).filter(|motor| motor.carrier.is_none())
    {
        let rotor = view.polynomial(pool, &model.manipulator, &motor.mass);
        total = pool.add(total, rotor);
    }
    total
}

/// h(q), kg m: links, load and rotors, those that the base carries included.
fn first_moment(pool: &mut Pool, arm: &Arm) -> Vector {
    let frames = frames(pool, arm);
    let mut total = arm.base_moment;
    for (joint, (rotation, origin)) in arm.joints.iter().zip(&frames.joints) {
        let turned = pool.transform(rotation, &joint.body.first);
        let weighted = pool.scale(joint.body.mass, origin);
        let first = pool.add_vectors(&turned, &weighted);
        total = pool.add_vectors(&total, &first);
    }
    total
}

/// U(q), J: of masses zero where all, rotors included, lie at the origin of the base frame; of a spring ½ k (q - rest)².
pub fn potential_energy(pool: &mut Pool, arm: &Arm) -> ExprId {
    let first = first_moment(pool, arm);
    let mut energy = -pool.dot3(&arm.gravity, &first);
    for i in (0..arm.dof()).filter(|&i| arm.joints[i].stiffness != ExprId::ZERO) {
        let (deflection, half) = (deflection(pool, arm, i), pool.fraction(1, 2));
        let square = pool.mul(deflection, deflection);
        let twice = pool.mul(arm.joints[i].stiffness, square);
        let stored = pool.mul(half, twice);
        energy = pool.add(energy, stored);
    }
    energy
}
