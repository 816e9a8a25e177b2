//! The importer from outside. One program for all tests of the crate: a file beside this one is a module here.

mod bad_files;
mod build_script;
mod common;
mod convert;
mod export;
mod hostile;
mod import;
mod mimic;
mod mjcf;
