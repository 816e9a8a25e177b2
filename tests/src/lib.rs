//! The judges of armgen: code that finds by other ways what the generator finds, and shares no helper with it.
//!
//! - [`oracle`]: a numerical model of an arm, straight from the description, in f64 and dual numbers;
//! - [`mod@reference`]: values that another library computed, stored in `data/reference`;
//! - [`formula`] and [`trigonometry`]: plain formulas, compared exactly as rational trigonometric expressions;
//! - [`random`]: random arms and states from a seed;
//! - [`precision`]: every tolerance, with its reason.

pub mod formula;
pub mod oracle;
pub mod precision;
pub mod random;
pub mod reference;
pub mod trigonometry;
