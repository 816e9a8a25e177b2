//! The generator from outside. One program for all tests of the crate: the other files of this folder are its modules.

mod build_script;
mod gpu;
mod gravity;
mod inverse_kinematics;
mod names;
mod sines;
mod slips;
mod written_files;
