//! `armgen run`: the robot that this program was built with, in motion.

use std::path::{Path, PathBuf};

use armgen_generated::{DOF, NAME};

use crate::experiments::{self, Outcome};
use crate::motion;
use crate::{terminal, FAULTY, UNREADABLE};

/// Runs the experiments for this robot; where there are none, moves it along a demonstration.
pub(crate) fn run(files: &[PathBuf], out: &Path) -> u8 {
    match experiments::run(files, out) {
        Outcome::Ran(code) => code,
        Outcome::NoneForThisRobot => demonstrate(out),
    }
}

fn demonstrate(out: &Path) -> u8 {
    let outcome = match motion::run() {
        Ok(outcome) => outcome,
        Err(reason) => {
            terminal::error(&reason);
            return FAULTY;
        }
    };
    let title = terminal::bold(&format!("{NAME}: first motion of the arm that this program was built with"), &std::io::stdout());
    let joints = if DOF == 1 { "1 joint".to_string() } else { format!("{DOF} joints") };
    let mut text = format!("{title} ({joints})\n\n{}", outcome.report);
    let mut csv = String::new();
    outcome.log.write_csv(&mut csv).expect("writing to a string");
    let mut code = 0;
    for (extension, content) in [("svg", outcome.figure.svg()), ("csv", csv)] {
        let file = out.join(format!("{}.{extension}", outcome.name));
        match std::fs::create_dir_all(out).and_then(|()| std::fs::write(&file, content)) {
            Ok(()) => text += &format!("\n  {}", file.display()),
            Err(reason) => {
                terminal::error(&format!("cannot write {}: {reason}", file.display()));
                code = UNREADABLE;
            }
        }
    }
    text += "\n";
    code = code.max(terminal::print(&text));
    if let Some(fault) = outcome.fault {
        terminal::error(&fault);
        code = code.max(FAULTY);
    }
    code
}
