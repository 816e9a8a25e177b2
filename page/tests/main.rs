//! The page of a robot. One program for all tests of the crate: a file beside this one is a module here.

mod browser;
#[path = "../../tests/src/installed.rs"]
mod installed;
mod text;
mod vendor;
mod web;
