//! The quantities of an arm, one concept a file: the formula on top, the declaration of each emitted function, its derivation.

pub mod base_regressor;
pub mod coriolis;
pub mod derivatives;
pub mod equations_of_motion;
pub mod first_moment;
pub mod forward_dynamics;
pub mod friction;
pub mod gravity;
pub mod inertia;
pub mod inverse_dynamics;
pub mod joint_variables;
pub mod kinematics;
pub mod kinetic_energy;
pub mod load_friction;
pub mod momentum;
pub mod operational_inertia;
pub mod regressor;

use super::quantity::Quantity;

/// All quantities, file by file, in the order of the emitted module.
pub(crate) static DECLARED: [&[&Quantity]; 17] = [
    &kinematics::DECLARED,
    &[&joint_variables::JOINT_VARIABLES],
    &[&inertia::INERTIA_MATRIX],
    &[&coriolis::CORIOLIS_MATRIX],
    &[&gravity::GRAVITY],
    &[&friction::FRICTION],
    &[&load_friction::LOAD_FRICTION],
    &[&equations_of_motion::EQUATIONS_OF_MOTION],
    &[&inverse_dynamics::INVERSE_DYNAMICS],
    &[&forward_dynamics::FORWARD_DYNAMICS],
    &regressor::DECLARED,
    &[&kinetic_energy::KINETIC_ENERGY],
    &first_moment::DECLARED,
    &momentum::DECLARED,
    &[&base_regressor::BASE_REGRESSOR],
    &[&operational_inertia::OPERATIONAL_INERTIA],
    &derivatives::DECLARED,
];
