//! Imports any text as a URDF; a result must be a valid description.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| armgen_fuzz::check_import("robot.urdf", data));
