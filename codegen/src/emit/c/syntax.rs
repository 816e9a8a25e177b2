//! How C writes numbers and signs, in functions for one state and for many states.

use super::header::constant;
use crate::emit::plain::Syntax;
use crate::exact::Number;
use crate::program::Module;

/// Most lanes of a vector of angles.
pub(super) const VECTOR: usize = 4;

/// A module under the names that C gives it.
pub(super) struct C<'a> {
    pub(super) module: &'a Module,
    pub(super) name: String,
    pub(super) upper: String,
}

impl Syntax for C<'_> {
    fn number(&self, value: &Number) -> String {
        constant(value, self.module.scalar)
    }

    fn sign(&self, entry: &str) -> String {
        format!("{}_sign({entry})", self.name)
    }

    fn stribeck(&self, entry: &str, velocity: &str) -> String {
        format!("{}_stribeck({entry}, {velocity})", self.name)
    }

    fn fused(&self, [a, b, c]: [String; 3]) -> String {
        format!("{}_FMA({a}, {b}, {c})", self.upper)
    }
}
