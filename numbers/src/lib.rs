//! Straight-line programs, executed over blocks of states without a compiler, with the bits of compiled code.
//!
//! A [`Function`] is plain data: inputs, operations on earlier values and constants, outputs.
//! [`Program::new`] checks it and assigns places to values by their last use.
//! [`Program::run`] then computes any number of states with this processor's vector instructions.
//! It takes blocks of 64 states and performs each operation on the whole block before the next operation.
//! A single state runs the same program with one number in each place.
//!
//! Every operation rounds by itself, in the order of the function. The bits therefore equal those of compiled code, for any
//! number of states and on any processor. Sines, cosines and the exponential are the compiled texts of `armgen-elementary`, or
//! `libm`.
//!
//! The compiled blocks of `armgen-inverse-kinematics` find all solutions of inverse kinematics ([`postures`]).
//!
//! [`Program::over`] executes the same program over another [`Arithmetic`], as a checker does.
//!
//! No state causes a panic: infinities and NaN pass through all operations by the rules of IEEE 754. [`Program::run`] allocates
//! nothing; the caller prepares its [`Workspace`].
//!
//! ```
//! use armgen_numbers::{Argument, Function, Input, Operand, Operation, Operator, Output, Program, Result, Sines};
//!
//! // m g l sin q of a pendulum
//! let pendulum = Function {
//!     name: "gravity".into(),
//!     arguments: vec![Argument { name: "q".into(), length: 1 }],
//!     results: vec![Result { name: "g".into(), shape: vec![1] }],
//!     sines: Sines::Libm,
//!     angles: vec![armgen_numbers::Angle { argument: 0, terms: vec![(0, false)], factors: vec![], turn: None }],
//!     inputs: vec![Input::Sine(0)],
//!     operations: vec![Operation { operator: Operator::Multiply, left: Operand::Constant(9.81), right: Operand::Value(0) }],
//!     outputs: vec![Output { operand: Operand::Value(1), negated: false }],
//! };
//! let program = Program::new(&pendulum).expect("every value stands before its use");
//! let mut torque = [0.0; 3];
//! program.run(&[&[0.0, 0.5, 1.0]], &mut torque, &mut program.workspace()).expect("three states");
//! assert_eq!(torque[2], 9.81 * libm::sin(1.0));
//! ```

mod arithmetic;
mod execute;
mod function;
pub mod postures;
mod program;
mod scalar;
#[cfg(test)]
mod tests;

pub use arithmetic::Arithmetic;
pub use execute::{Compiled, Mismatch, Workspace};
pub use function::{Angle, Argument, Function, Input, Operand, Operation, Operator, Output, Result, Sines};
pub use program::{Invalid, Program};
pub use scalar::Scalar;
