//! A valid arm with what all its derivations share.

use std::sync::OnceLock;

use super::parameters::ParameterVector;
use super::{base, constants, parameter_vector};
use crate::manipulator::Manipulator;
use crate::ring::field::Field;

/// Numbers of an arm that determine the dimensions of its quantities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Number of coordinates.
    pub dof: usize,
    /// Number of joints.
    pub joints: usize,
    /// Number of parameters.
    pub parameters: usize,
    /// Number of base parameters.
    pub base_parameters: usize,
    /// Number of rows of the task.
    pub task: usize,
}

/// A valid arm with what its equations are formed in.
#[derive(Clone, Debug)]
pub struct Model {
    /// The arm.
    pub manipulator: Manipulator,
    /// The field of the fingerprints.
    pub field: Field,
    /// The parameter vector that its `regressor` chooses.
    pub parameters: ParameterVector,
    /// Its base parameters, computed at the first use.
    base: OnceLock<Option<ParameterVector>>,
}

impl Model {
    /// The model of a valid arm.
    pub fn new(manipulator: Manipulator) -> Model {
        let field = constants::field_of(&manipulator);
        let parameters = parameter_vector(&manipulator, &field);
        Model { manipulator, field, parameters, base: OnceLock::new() }
    }

    /// The same with one of its named end effectors as the one that its equations are of.
    pub fn at(&self, tip: usize) -> Model {
        Model { manipulator: self.manipulator.at(tip), ..self.clone() }
    }

    /// The base parameters, the masses of rotors among their values; `None` where their exact combinations are too long to be formed.
    pub fn base_parameters(&self) -> Option<&ParameterVector> {
        self.base.get_or_init(|| base::base_parameters_with_rotors(&self.manipulator, &self.field)).as_ref()
    }

    /// How many there are, 0 where they are not formed.
    pub fn base_count(&self) -> usize {
        self.base_parameters().map_or(0, ParameterVector::len)
    }

    /// The numbers that determine the dimensions of the quantities.
    pub fn sizes(&self) -> Sizes {
        self.sizes_with(self.base_count())
    }

    /// The same with that number of base parameters, which are not looked for.
    pub fn sizes_with(&self, base_parameters: usize) -> Sizes {
        Sizes {
            dof: self.manipulator.dof(),
            joints: self.manipulator.joints.len(),
            parameters: self.parameters.len(),
            base_parameters,
            task: self.manipulator.task.len(),
        }
    }
}
