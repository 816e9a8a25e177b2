//! The experiments of the repository. One program for all tests of the crate: the other files of this folder are its modules.

mod bad_files;
mod common;
mod experiments;
mod stability;
mod start;
