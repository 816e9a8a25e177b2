//! Imports any text as a MuJoCo model; a result must be a valid description.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| armgen_fuzz::check_import("robot.xml", data));
