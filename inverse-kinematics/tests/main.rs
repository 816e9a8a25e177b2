//! The building blocks of inverse kinematics, in both scalars. One program for all tests of the crate: a file beside this one is a module here.

#[macro_use]
mod common;

mod circle_roots;
mod classes;
mod closed_forms;
mod determinant;
mod few_joints;
mod reference;
mod regional;
mod shoulder_elbow_wrist;
mod solutions;
mod special;
mod texts;
