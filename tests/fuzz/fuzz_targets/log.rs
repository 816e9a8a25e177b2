#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| armgen_fuzz::log::run(data));
