//! The robot that `robot.yaml` describes: edit that file and rebuild, and every function here follows.
//!
//! The functions are free functions over arrays, without allocation and without `std`; they need libm alone. With the feature `runtime` the
//! robots [`Nominal`] and [`WithParameters`] implement the traits of `armgen-runtime`.
//! [`robot_ik`] has the inverse kinematics, all joint variables that reach a pose, of arms for which there is a construction.
#![no_std]
#![forbid(unsafe_code)]

pub use robot::*;

mod robot {
    include!(concat!(env!("OUT_DIR"), "/robot.rs"));

    #[cfg(feature = "runtime")]
    include!(concat!(env!("OUT_DIR"), "/robot_runtime.rs"));
}

/// Inverse kinematics: all joint variables that reach a pose.
pub mod robot_ik {
    include!(concat!(env!("OUT_DIR"), "/robot_ik.rs"));
}
