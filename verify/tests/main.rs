//! The checker from outside. One program for all tests of the crate: a file beside this one is a module here.

mod adversary;
mod base_regressor;
mod bounds;
mod certificate_page;
mod common;
mod contract;
mod exported;
#[allow(dead_code, unreachable_pub)]
#[path = "../../tests/src/exported_arms.rs"]
mod exported_arms;
mod floats;
mod hostile_modules;
mod languages;
mod mutations;
mod points;
#[allow(dead_code, unreachable_pub)]
#[path = "../../tests/src/random.rs"]
mod random;
mod robots;
mod test_kit;
