//! The checker from outside. One program for all tests of the crate: a file beside this one is a module here.

mod adversary;
#[allow(dead_code)]
#[path = "../../codegen/tests/inverse_kinematics/arms.rs"]
mod arms;
mod base_regressor;
mod bounds;
mod certificate_page;
mod common;
mod contract;
mod floats;
mod gravity;
mod hostile_modules;
mod languages;
mod mutations;
mod points;
mod robots;
mod test_kit;
