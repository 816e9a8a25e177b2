//! The runs of experiments, compiled for `robots/scara.yaml`: the robot that the experiments of the repository are written for.
//!
//! The tests of this crate run on it, so their results do not depend on robot.yaml.

use armgen_experiments::run::Arm;

/// The emitted robot.
#[allow(missing_docs)]
#[rustfmt::skip]
pub mod scara {
    include!(concat!(env!("OUT_DIR"), "/scara.rs"));
    include!(concat!(env!("OUT_DIR"), "/scara_runtime.rs"));
}

/// Its inverse kinematics.
#[allow(missing_docs)]
#[rustfmt::skip]
pub mod scara_ik {
    include!(concat!(env!("OUT_DIR"), "/scara_ik.rs"));
}

/// A UR10 with the standard parameters of all links.
#[allow(missing_docs)]
#[rustfmt::skip]
pub mod ur10 {
    include!(concat!(env!("OUT_DIR"), "/ur10.rs"));
    include!(concat!(env!("OUT_DIR"), "/ur10_runtime.rs"));
}

/// Its inverse kinematics.
#[allow(missing_docs)]
#[rustfmt::skip]
pub mod ur10_ik {
    include!(concat!(env!("OUT_DIR"), "/ur10_ik.rs"));
}

/// A UR10 with a load that is its only parameter.
#[allow(missing_docs)]
#[rustfmt::skip]
pub mod ur10_load {
    include!(concat!(env!("OUT_DIR"), "/ur10_load.rs"));
    include!(concat!(env!("OUT_DIR"), "/ur10_load_runtime.rs"));
}

/// Its inverse kinematics.
#[allow(missing_docs)]
#[rustfmt::skip]
pub mod ur10_load_ik {
    include!(concat!(env!("OUT_DIR"), "/ur10_load_ik.rs"));
}

/// The UR10 with a load.
pub fn ur10_load() -> Box<dyn Arm> {
    Box::new(armgen_experiments::instance!(crate::ur10_load))
}

/// The robot of the experiments.
pub fn scara() -> Box<dyn Arm> {
    Box::new(armgen_experiments::instance!(crate::scara))
}
