//! Whether programs equal the equations: points, constants, identities and rounding.

pub(crate) mod at_state;
#[doc(hidden)]
pub mod checker;
#[doc(hidden)]
pub mod constants;
#[doc(hidden)]
pub mod identities;
#[doc(hidden)]
pub mod plain;
#[doc(hidden)]
pub mod rounding;
#[doc(hidden)]
pub mod seed;
#[doc(hidden)]
pub mod stated;
