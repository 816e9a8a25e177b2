//! Generates the robot that the experiments of the repository are written for.

fn main() {
    armgen_codegen::build_script::Robot::new("../../robots/scara.yaml").generate();
}
