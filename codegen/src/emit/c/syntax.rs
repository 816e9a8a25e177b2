//! How C writes numbers and signs, in functions for one state and for many states.

use super::header::constant;
use crate::emit::plain::Syntax;
use crate::exact::Number;
use crate::kinds::Scalar;
use crate::program::Module;

/// Most lanes of a vector of angles, those of AVX: with the 16 of AVX-512 functions for one state take a third more time.
pub(super) fn most_lanes(scalar: Scalar) -> usize {
    match scalar {
        Scalar::F64 => 4,
        Scalar::F32 => 8,
    }
}

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
