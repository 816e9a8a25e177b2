//! `armgen page`: one HTML file with the arm, its table, its equations, its numbers and its motions.

use std::path::{Path, PathBuf};

use armgen_page::{Log, Misfit, Run};

use super::verify::with_spinner;
use crate::output::{place, write_other};
use crate::{input, terminal, DONE, FAULTY};

/// `out`: the file to write; without it the name of the description with `.html`, in the folder where the program runs.
pub(crate) fn run(file: &Path, out: Option<PathBuf>, logs: &[PathBuf]) -> u8 {
    let is_named = out.is_some();
    let out = out.unwrap_or_else(|| PathBuf::from(file.file_stem().unwrap_or_else(|| "robot".as_ref())).with_extension("html"));
    let names = match names(logs) {
        Ok(names) => names,
        Err(twice) => {
            terminal::error(&format!("{}: the log is named twice, or differs by its extension alone", twice.display()));
            return FAULTY;
        }
    };
    let mut runs: Vec<Run> = Vec::new();
    for (path, name) in logs.iter().zip(names) {
        match read(path, name) {
            Ok(run) => runs.push(run),
            Err(code) => return code,
        }
    }
    let source = match input::description(file) {
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
    let read = logs.iter().map(|log| (log.as_path(), "a log of the page"));
    let code = write_other(read.chain([(file, "the description")]), &out, &page);
    if code == DONE && !is_named {
        terminal::note(&format!("the page is {}: open it in a browser", out.display()));
    }
    code
}

/// A log under a name.
fn read(path: &Path, name: String) -> Result<Run, u8> {
    let source = input::log(path)?;
    let log = Log::read(source.text(), unit).map_err(|reason| {
        terminal::error(&format!("{}: {reason}", path.display()));
        FAULTY
    })?;
    Ok(Run { name, log: Some(log), ..Run::default() })
}

/// The names of logs: their file names, with as many folders in front as needed to distinguish them. Error: a log that is given twice.
fn names(logs: &[PathBuf]) -> Result<Vec<String>, &Path> {
    let places: Vec<PathBuf> = logs.iter().map(|log| place(log).with_extension("")).collect();
    let name = |k: usize, folders: usize| {
        let parts: Vec<_> = places[k].components().map(|part| part.as_os_str().to_string_lossy()).collect();
        parts[parts.len().saturating_sub(folders + 1)..].join("/")
    };
    let most = places.iter().map(|place| place.components().count()).max().unwrap_or_default();
    (0..logs.len())
        .map(|k| {
            let alone = |folders: &usize| (0..logs.len()).all(|other| other == k || name(other, *folders) != name(k, *folders));
            (0..most).find(alone).map(|folders| name(k, folders)).ok_or(logs[k].as_path())
        })
        .collect()
}

/// The unit of a column of an experiment, as far as its name tells it (docs/experiments.md).
fn unit(name: &str) -> String {
    let known = [("t", "s"), ("x", "m"), ("y", "m"), ("z", "m"), ("e_x", "m"), ("e_y", "m"), ("e_z", "m"), ("angle", "rad")];
    let rest = [("speed", "m/s"), ("acceleration", "m/s²"), ("turn_rate", "rad/s"), ("turn_acceleration", "rad/s²")];
    let starts = [("e_r", "rad"), ("q_", "rad, m"), ("eq_", "rad, m"), ("dq_", "rad/s, m/s")];
    let torques = ["tau_", "measured_", "predicted_"].map(|start| (start, "N m, N"));
    let exact = known.iter().chain(&rest).find(|(column, _)| *column == name);
    let found = exact.or_else(|| starts.iter().chain(&torques).find(|(start, _)| name.starts_with(start)));
    found.map_or_else(String::new, |(_, unit)| (*unit).to_owned())
}
