//! Generates the robot that the experiments of the repository are written for, the arm of the tests of stability, and one more for the table of
//! verdicts.

fn main() {
    for robot in ["../../robots/scara.yaml", "robots/ur10.yaml", "robots/ur10_load.yaml"] {
        armgen_codegen::build_script::Robot::new(robot).inverse_kinematics().generate();
    }
    armgen_codegen::build_script::Robot::new("../../robots/puma560.yaml").generate();
}
