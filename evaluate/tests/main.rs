//! What is executed against what is compiled.

#[path = "../../codegen/tests/inverse_kinematics/arms.rs"]
mod arms;
mod bits;
mod postures;
mod verified;
