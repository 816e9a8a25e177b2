//! Generates the SCARA in f32, with sines in f32.

use armgen_codegen::build_script::{Robot, Scalar, Trig};

fn main() {
    Robot::new("../../../robots/scara.yaml").scalar(Scalar::F32).trig(Trig::Fast).generate();
}
