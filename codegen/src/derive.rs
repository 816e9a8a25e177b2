//! From a valid manipulator to its equations: one quantity a file, the formula on top.

pub mod arm;
pub mod base;
pub mod coriolis;
pub mod energy;
pub mod forward_dynamics;
pub mod gravity;
pub mod inertia;
pub mod kinematics;
pub mod newton_euler;
pub mod parameters;
pub mod regressor;

#[cfg(test)]
mod tests;
