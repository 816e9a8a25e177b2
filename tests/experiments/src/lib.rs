//! The runs of experiments, compiled for `robots/scara.yaml`: the robot that the experiments of the repository are written for.
//!
//! The tests of this crate run on it, and say the same whatever robot.yaml describes.

use armgen_experiments::run::Arm;

/// The emitted robot.
#[allow(missing_docs)]
#[rustfmt::skip]
pub mod scara {
    include!(concat!(env!("OUT_DIR"), "/scara.rs"));
    include!(concat!(env!("OUT_DIR"), "/scara_runtime.rs"));
}

/// The robot of the experiments.
pub fn scara() -> Box<dyn Arm> {
    Box::new(armgen_experiments::instance!(crate::scara))
}
