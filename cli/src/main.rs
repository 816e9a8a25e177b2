//! The program armgen, with the robot of robot.yaml inside.

fn main() -> std::process::ExitCode {
    armgen_commands::run(&*armgen_instance::built(), include_str!("../../robot.yaml"))
}
