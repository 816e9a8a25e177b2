//! The program armgen.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(armgen_commands::run_with(std::env::args_os()))
}
