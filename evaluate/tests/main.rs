//! Executed programs against compiled modules.

#[path = "../../codegen/tests/inverse_kinematics/arms.rs"]
mod arms;
mod bits;
mod postures;
