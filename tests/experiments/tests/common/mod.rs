//! Files of the repository, read for the robot of the experiments.
#![allow(dead_code)]

use std::path::{Path, PathBuf};

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;
use armgen_experiments::model::{Experiment, Robot};
use armgen_experiments::read::{self, Parsed};

pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The experiments of the repository.
pub(crate) fn folder() -> PathBuf {
    root().join("experiments")
}

/// The names of the YAML files in a folder, in order.
pub(crate) fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut names: Vec<String> =
        entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).filter(|name| name.ends_with(".yaml")).collect();
    names.sort();
    names
}

pub(crate) fn text_of(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Parses the text of a file in this folder. Messages name paths by file name, so they do not depend on the place of the repository.
pub(crate) fn parse(folder: &Path, name: &str, text: &str, robot: &Robot) -> Parsed {
    let open = |path: &Path| std::fs::read_to_string(folder.join(path));
    read::experiment(Path::new(name), &Source::new(name, text), robot, &open)
}

/// A valid experiment for this robot: anything else is a failure of the test, never a reason to pass it.
#[track_caller]
pub(crate) fn experiment(name: &str, text: &str, robot: &Robot) -> Experiment {
    match parse(&folder(), name, text, robot) {
        Parsed::Experiment(experiment) => *experiment,
        other => panic!("{name}: {}", said(&other)),
    }
}

/// Diagnostics of a file that is no experiment for this robot.
pub(crate) fn said(parsed: &Parsed) -> String {
    match parsed {
        Parsed::Experiment(_) => "taken".into(),
        Parsed::OtherRobot(robot) => format!("for the robot `{robot}`"),
        Parsed::Path => "a path".into(),
        Parsed::Faulty(faulty) => faulty.iter().map(|(source, d)| d.render(source, Colour::Never)).collect(),
    }
}
