//! The experiments of the repository. One program for all tests of the crate: a file beside this one is a module here.

mod bad_files;
mod common;
mod experiments;
mod stability;
mod start;
