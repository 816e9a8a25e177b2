//! `armgen export`: a description as a URDF.

use std::path::{Path, PathBuf};

use crate::output::write_other;
use crate::{input, terminal};

/// The formats of the export.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum Format {
    /// As in wiki.ros.org/urdf/XML
    Urdf,
}

pub(crate) fn run(file: &Path, format: Format, out: Option<&PathBuf>) -> u8 {
    let source = match input::description(file) {
        Ok(source) => source,
        Err(code) => return code,
    };
    let (exported, diagnostics) = match format {
        Format::Urdf => armgen_import::export(&source),
    };
    let exported = match input::report_or_exit_code(&source, exported, &diagnostics, input::Warnings::Counted) {
        Ok(exported) => exported,
        Err(code) => return code,
    };
    for line in &exported.lines {
        terminal::note(line);
    }
    match out {
        Some(out) => write_other([(file, "the description")], out, &exported.urdf),
        None => terminal::print(&exported.urdf),
    }
}
