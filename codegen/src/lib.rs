//! From the description of a robot arm to its equations of motion, and from these to plain `no_std` Rust.

pub mod description;
pub mod diagnostic;
pub mod exact;
pub mod manipulator;
pub mod ring;
pub mod source;
