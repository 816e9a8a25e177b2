//! What uses a robot: manipulability, trajectories, closed-loop inverse kinematics, control, stability, simulation.
#![cfg_attr(not(feature = "std"), no_std)]
pub use nalgebra;

pub mod robot;
