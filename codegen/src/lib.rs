//! From the description of a robot arm to its equations of motion, and from these to plain `no_std` Rust.

pub mod derive;
pub mod description;
pub mod diagnostic;
pub mod emit;
pub mod equations;
pub mod exact;
pub mod manipulator;
pub mod program;
pub mod ring;
pub mod source;
