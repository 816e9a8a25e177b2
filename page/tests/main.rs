//! The page of a robot. A single program for all tests of the crate: each file in this folder is a module here.

mod browser;
#[path = "../../tests/src/installed.rs"]
mod installed;
mod text;
mod vendor;
mod web;
