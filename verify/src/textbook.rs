//! The equations of the arm, the way that the book writes them.

#[doc(hidden)]
pub mod base;
#[doc(hidden)]
pub mod equations;
#[doc(hidden)]
pub mod reference;
