//! Exact numbers, enclosures and floats, and programs that compute with them.

#[doc(hidden)]
pub mod arithmetic;
pub(crate) mod check;
#[doc(hidden)]
pub mod contract;
#[doc(hidden)]
pub mod divisors;
#[doc(hidden)]
pub mod element;
#[doc(hidden)]
pub mod enclosure;
#[doc(hidden)]
pub mod float;
#[doc(hidden)]
pub mod formula;
#[doc(hidden)]
pub(crate) mod interval;
#[doc(hidden)]
pub mod number;
#[doc(hidden)]
pub mod program;
#[doc(hidden)]
pub mod ranges;
#[doc(hidden)]
pub mod signs;
#[doc(hidden)]
pub mod stream;
