//! The generator from outside. One program for all tests of the crate: a file beside this one is a module here.

mod build_script;
mod inverse_kinematics;
mod names;
mod sines;
mod slips;
mod written_files;
