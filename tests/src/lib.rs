//! The judges of armgen: code that finds by other ways what the generator finds, and shares no helper with it.
//!
//! - [`formula`] and [`trigonometry`]: plain formulas, compared exactly as rational trigonometric expressions;

pub mod formula;
pub mod trigonometry;
