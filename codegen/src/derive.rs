//! From a valid manipulator to its equations. `quantities` has the emitted functions, one concept a file; other modules are
//! shared by them.

pub mod arm;
pub mod base;
mod columns;
pub mod constants;
pub mod coupling;
pub mod derivation;
pub mod determinant;
pub mod factors;
mod friction;
pub mod model;
pub mod motion;
pub mod newton_euler;
pub mod parameters;
pub mod passes;
pub mod plan;
pub mod quantities;
pub mod quantity;
pub mod regressor;
mod rotors;
mod wrench;

pub use derivation::Derivation;
pub use model::Model;

use crate::manipulator::{Manipulator, RegressorChoice};
use crate::ring::field::Field;
use parameters::ParameterVector;

/// The parameter vector that a description chooses by `regressor`.
pub fn parameter_vector(manipulator: &Manipulator, field: &Field) -> ParameterVector {
    match &manipulator.regressor {
        RegressorChoice::Standard => ParameterVector::standard(manipulator),
        // Validation refuses a description whose base parameters are too long.
        RegressorChoice::Base => {
            base::base_parameters(manipulator, field).unwrap_or_else(|| ParameterVector::standard(manipulator))
        }
        RegressorChoice::Names(names) => ParameterVector::named(manipulator, names),
    }
}

#[cfg(test)]
mod tests;
