//! Text of modules as constants and programs, and the exact values that a certificate claims for their literals.

#[doc(hidden)]
pub mod claims;
pub(crate) mod marked;
#[doc(hidden)]
pub mod reader;
