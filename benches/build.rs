//! Generates every robot of the tables, with the sines of libm and with the fast ones.

use armgen_codegen::build_script::{Robot, Trig};

fn main() {
    for robot in ["scara4", "puma560", "ur5", "panda7"] {
        for (trig, suffix) in [(Trig::Libm, "libm"), (Trig::Fast, "fast")] {
            Robot::new(format!("../robots/{robot}.yaml")).trig(trig).file_stem(format!("{robot}_{suffix}")).generate();
        }
    }
}
