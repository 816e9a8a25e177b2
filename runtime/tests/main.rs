//! The runtime, on arms written by hand. One program for all tests of the crate: the other files of this folder are its modules.

mod allocation;
mod bits;
mod clik;
mod common;
mod contact;
mod examples;
mod governor;
mod hands;
mod joint_control;
mod limited;
mod manipulability;
mod model;
mod operational_space;
mod passing;
mod payload;
// The page shows a part of it as a file of its own.
#[allow(unreachable_pub)]
mod pick_and_place;
mod plant;
mod quadratic_program;
mod random_starts;
mod refusals;
mod stability;
mod timing;
mod trajectory;
