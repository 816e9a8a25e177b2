//! Any text as a URDF: import it; what comes out is a description that reads without a fault.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| armgen_fuzz::check_import("robot.urdf", data));
