//! The runs of experiments, compiled for the robot of robot.yaml.
//!
//! The controllers and the simulation are generic over the robot: their machine code is made here, once, and everything else reaches it
//! through [`Arm`]. So an edit of robot.yaml compiles `armgen-generated`, this crate and the three lines of the program again, and nothing that
//! reads, judges, draws or verifies.

use armgen_experiments::run::Arm;

/// The robot that the program was built with.
pub fn built() -> Box<dyn Arm> {
    // Behind a pointer already here: the machine code is made where the pointer is.
    Box::new(armgen_experiments::instance!(armgen_generated))
}
