//! Generates the SCARA in f32, and a call of each of its functions.

use std::{env, fs, path::PathBuf};

fn main() {
    armgen_codegen::build_script::Robot::new("../../../robots/scara.yaml")
        .scalar(armgen_codegen::build_script::Scalar::F32)
        .generate();
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let module = fs::read_to_string(out.join("scara.rs")).expect("the module was just written");
    fs::write(out.join("calls.rs"), armgen_bare_calls::calls(&module)).expect("OUT_DIR can be written");
}
