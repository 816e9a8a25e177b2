//! Generates the robot of robot.yaml.

fn main() {
    armgen_codegen::build_script::Robot::new("../robot.yaml").inverse_kinematics().generate();
}
