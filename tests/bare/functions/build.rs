//! Generates the SCARA and the Panda in f32 with either source of sines, and a call of each of their functions. Also generates
//! the inverse kinematics of the SCARA and the Puma.

use armgen_codegen::build_script::{Robot, Scalar, Trig};
use std::{env, fs, path::PathBuf};

fn single(robot: &str) -> Robot {
    Robot::new(format!("../../../robots/{robot}.yaml")).scalar(Scalar::F32)
}

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    for robot in ["scara", "panda7"] {
        for (trig, ending) in [(Trig::Fast, "fast"), (Trig::Libm, "libm")] {
            let stem = format!("{robot}_{ending}");
            single(robot).trig(trig).file_stem(&stem).generate();
            let module = fs::read_to_string(out.join(format!("{stem}.rs"))).expect("the module was just written");
            fs::write(out.join(format!("{stem}_calls.rs")), armgen_bare_calls::calls(&module)).expect("OUT_DIR can be written");
        }
    }
    single("scara").trig(Trig::Fast).inverse_kinematics().functions(["direct_kinematics"]).generate();
    single("puma560").trig(Trig::Fast).inverse_kinematics().functions(["direct_kinematics"]).generate();
}
