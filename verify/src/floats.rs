//! How far rounding takes functions from their equations.

pub mod bounds;
pub mod companion;
pub mod errors;
#[doc(hidden)]
pub mod residual;
