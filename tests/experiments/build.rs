//! Generates the robot that the experiments of the repository are written for, and the arm of the tests of stability.

fn main() {
    for robot in ["../../robots/scara.yaml", "robots/ur10.yaml", "robots/ur10_load.yaml"] {
        armgen_codegen::build_script::Robot::new(robot).inverse_kinematics().generate();
    }
}
