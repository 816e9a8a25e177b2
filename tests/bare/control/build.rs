//! Generates the SCARA in f32 with its inverse kinematics, a call of each of its functions, and the inverse kinematics of the Puma.

use std::{env, fs, path::PathBuf};

fn main() {
    use armgen_codegen::build_script::{Robot, Scalar, Trig};
    Robot::new("../../../robots/scara.yaml").scalar(Scalar::F32).trig(Trig::Fast).inverse_kinematics().generate();
    let puma = Robot::new("../../../robots/puma560.yaml").scalar(Scalar::F32).trig(Trig::Fast).inverse_kinematics();
    puma.functions(["direct_kinematics"]).generate();
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let module = fs::read_to_string(out.join("scara.rs")).expect("the module was just written");
    fs::write(out.join("calls.rs"), armgen_bare_calls::calls(&module)).expect("OUT_DIR can be written");
}
