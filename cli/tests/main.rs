//! The program, run as a user runs it. One program for all tests of the crate: a file beside this one is a module here.

#[cfg(feature = "run")]
mod any_arm;
mod commands;
#[path = "../../tests/src/installed.rs"]
mod installed;
mod languages;
mod package;
mod site;
mod start;
