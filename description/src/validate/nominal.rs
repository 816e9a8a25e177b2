//! Exact values of expressions, for who writes a valid description in another form.

use super::number::nominal;
use super::parameters::Parameters;
use crate::description::RobotDescription;
use crate::diagnostic::Diagnostics;
use crate::document::Expression;
use crate::exact::Number;
use crate::kinds::Scalar;

/// The exact values of the expressions of a description that is valid.
pub struct NominalValues<'d>(Parameters<'d>);

impl<'d> NominalValues<'d> {
    /// With the values that `parameters` of the description gives its names.
    pub fn new(description: &'d RobotDescription) -> NominalValues<'d> {
        NominalValues(Parameters::resolve(description, Scalar::F64, &mut Diagnostics::new()))
    }

    /// The value of an expression; `None` without a value.
    pub fn of(&self, expression: &Expression) -> Option<Number> {
        nominal(expression, &self.0).ok()
    }
}
