//! From a valid manipulator to its equations: one quantity a file, the formula on top.

pub mod arm;
pub mod base;
mod columns;
pub mod coriolis;
pub mod derivatives;
pub mod determinant;
pub mod energy;
pub mod factors;
pub mod forward_dynamics;
pub mod gravity;
pub mod inertia;
pub mod kinematics;
pub mod momentum;
pub mod newton_euler;
pub mod operational_inertia;
pub mod parameters;
pub mod passes;
pub mod plan;
pub mod regressor;

use crate::manipulator::{Manipulator, RegressorChoice};
use crate::ring::field::Field;
use parameters::ParameterVector;

/// The parameter vector that a description chooses by `regressor`.
pub fn parameter_vector(manipulator: &Manipulator, field: &Field) -> ParameterVector {
    match &manipulator.regressor {
        RegressorChoice::Standard => ParameterVector::standard(manipulator),
        RegressorChoice::Base => base::base_parameters(manipulator, field),
        RegressorChoice::Names(names) => ParameterVector::named(manipulator, names),
    }
}

#[cfg(test)]
mod tests;
