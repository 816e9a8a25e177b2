//! Compilers and interpreters: their availability (`tests/src/installed.rs`), and their execution.

use std::path::{Path, PathBuf};
use std::process::Command;

use armgen_codegen::Generated;

pub(crate) use super::installed::there;
use super::installed::{left_out, runs};

/// Runs a command; panics with its output if it fails or warns.
#[track_caller]
pub(crate) fn succeed(command: &mut Command) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && !err.contains("warning"), "{command:?}: {}\n{out}{err}", output.status);
}

pub(crate) fn write(path: PathBuf, text: impl AsRef<[u8]>) {
    std::fs::write(&path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// A Python that has NumPy.
pub(crate) fn numpy() -> Option<&'static str> {
    python_with("numpy")
}

/// A Python that has a library.
pub(crate) fn python_with(library: &str) -> Option<&'static str> {
    python_that(&format!("import {library}"), &format!("with {library} here (Debian: python3-{library})"))
}

/// A Python that executes this text.
pub(crate) fn python_that(executes: &str, is: &str) -> Option<&'static str> {
    let found = ["python3", "/usr/bin/python3"].into_iter().find(|python| runs(python, &["-c", executes]));
    if found.is_none() {
        left_out(&format!("no Python {is}"));
    }
    found
}

/// Writes the files of the package.
pub(crate) fn write_package(folder: &Path, generated: &Generated) {
    std::fs::create_dir_all(folder).expect("a folder");
    generated.package().into_iter().for_each(|file| write(folder.join(file.name), file.text));
}
