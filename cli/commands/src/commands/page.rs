//! `armgen page`: one HTML file with the arm, its table, its equations, its numbers and its motions.

use std::path::{Path, PathBuf};

use armgen_page::{Log, Misfit, Run};

use super::verify::with_spinner;
use crate::output::write_other;
use crate::{input, terminal, FAULTY};

pub(crate) fn run(file: &Path, out: &Path, logs: &[PathBuf]) -> u8 {
    let mut runs: Vec<Run> = Vec::new();
    for path in logs {
        match read(path, &runs) {
            Ok(run) => runs.push(run),
            Err(code) => return code,
        }
    }
    let source = match input::source(file) {
        Ok(source) => source,
        Err(code) => return code,
    };
    let (page, diagnostics) = match with_spinner("deriving", || armgen_page::page(&source, &runs)) {
        Ok(page) => page,
        Err(Misfit { run, reason }) => {
            terminal::error(&format!("the log `{run}` is of another arm: {reason}"));
            return FAULTY;
        }
    };
    let page = match input::report_or_exit_code(&source, page, &diagnostics, input::Warnings::Counted) {
        Ok(page) => page,
        Err(code) => return code,
    };
    write_other(file, out, &page)
}

/// A log by the name of its file.
fn read(path: &Path, others: &[Run]) -> Result<Run, u8> {
    let source = input::log(path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let refuse = |reason: &str| {
        terminal::error(&format!("{}: {reason}", path.display()));
        FAULTY
    };
    if others.iter().any(|other| other.name == name) {
        return Err(refuse("another log has the same name"));
    }
    let log = Log::read(source.text(), unit).map_err(|reason| refuse(&reason))?;
    Ok(Run { name, log: Some(log), ..Run::default() })
}

/// The unit of a column of `armgen run`, as far as its name tells it (docs/experiments.md).
fn unit(name: &str) -> String {
    let known = [("t", "s"), ("x", "m"), ("y", "m"), ("z", "m"), ("e_x", "m"), ("e_y", "m"), ("e_z", "m"), ("angle", "rad")];
    let rest = [("speed", "m/s"), ("acceleration", "m/s²"), ("turn_rate", "rad/s"), ("turn_acceleration", "rad/s²")];
    let starts = [("e_r", "rad"), ("q_", "rad, m"), ("eq_", "rad, m"), ("dq_", "rad/s, m/s"), ("tau_", "N m, N")];
    let exact = known.iter().chain(&rest).find(|(column, _)| *column == name);
    let found = exact.or_else(|| starts.iter().find(|(start, _)| name.starts_with(start)));
    found.map_or_else(String::new, |(_, unit)| (*unit).to_owned())
}
