//! The judges of armgen: independent code that computes the generator's results by other methods and shares no helper with it.
//!
//! - [`oracle`]: a numerical model of an arm, straight from the description, in f64 and dual numbers;
//! - [`mod@reference`]: values that another library computed, stored in `data/reference`;
//! - [`formula`] and [`trigonometry`]: plain formulas, compared exactly as rational trigonometric expressions;
//! - [`shown`]: what `show --format json` prints, read back;
//! - [`technical_project`]: every closed form of the SCARA's technical project, and the comparison with `show`;
//! - [`random`]: random arms and states from a seed;
//! - [`precision`]: every tolerance, with its reason.
//!
//! This crate is also the first downstream project of the generator: its `build.rs` generates every robot that is judged.
//!
//! - [`emitted`]: the emitted modules, compiled; [`compiled`]: further ones, compiled on request in a crate of their own;
//!   [`interpreter`]: programs carried out without a compiler; [`functions`]: any of them;
//! - [`judge`]: every function of a robot against the oracle at one state;
//! - [`count`]: the operations in an emitted text;
//! - [`project`]: projects of strangers, built without network; [`installed`]: compilers and interpreters, where they are there.

#[macro_use]
mod answers;
pub mod compiled;
pub mod count;
pub mod emitted;
pub mod formula;
pub mod functions;
pub mod installed;
pub mod interpreter;
pub mod judge;
pub mod oracle;
pub mod precision;
pub mod project;
pub mod random;
pub mod reference;
pub mod shown;
pub mod signatures;
pub mod technical_project;
pub mod trigonometry;
