//! What uses a robot: manipulability, trajectories, closed-loop inverse kinematics, control, stability, simulation.
//!
//! Everything is generic over a robot (the traits of [`robot`]), its `N` joints, the `M` rows of its [`task`], the `P` parameters
//! of its regressor, and its scalar, `f32` or `f64`. Symbols and equation numbers follow "the book": Siciliano, Sciavicco,
//! Villani, Oriolo, *Robotics: Modelling, Planning and Control*. SI units and radians throughout.
//!
//! - **Allocation**: only `stability` and `simulation` allocate; they run on a host and need the feature `std`.
//! - **Panics**: none. A function that can fail returns a small documented `enum`, which is an [`Error`](core::error::Error) with a message.
//! - **Bits**: sine, cosine and root come from `libm` in every build, and no operation is contracted into a fused multiply-add.
//!   So one program gives the same bits on a host and on a microcontroller. Sines and cosines of f32 are computed in f32, by the
//!   method of `--trig fast`.
//! - **Time**: [`core::time::Duration`], integer nanoseconds, so that the phases of a time law change at exactly the sample meant.
#![cfg_attr(not(feature = "std"), no_std)]
// `!(x > 0)` also catches a NaN, which `x <= 0` lets pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

pub use nalgebra;

#[macro_use]
mod message;

pub mod clik;
pub mod contact;
pub mod control;

pub mod inverse_kinematics;
pub mod linalg;
pub mod manipulability;
pub mod orientation;
pub mod payload;
pub mod reference;
pub mod robot;
mod scalar;
pub mod settings;
#[cfg(feature = "std")]
pub mod simulation;
#[cfg(feature = "std")]
pub mod stability;
pub mod task;
pub mod timing;
pub mod trajectory;
