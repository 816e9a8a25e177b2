//! `armgen export`: a description as a URDF.

use std::path::{Path, PathBuf};

use super::generate::{same_file, write};
use crate::{input, terminal, DONE, UNREADABLE};

/// What can be written.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum Format {
    /// As in wiki.ros.org/urdf/XML
    Urdf,
}

pub(crate) fn run(file: &Path, format: Format, out: Option<&PathBuf>) -> u8 {
    let source = match input::source(file) {
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
    let Some(out) = out else { return terminal::print(&exported.urdf) };
    if same_file(file, out) {
        terminal::error(&format!("{} is the description: it would be overwritten; name another file", out.display()));
        return UNREADABLE;
    }
    if let Err(error) = write(out, &exported.urdf) {
        terminal::error(&format!("cannot write {}: {error}", out.display()));
        return UNREADABLE;
    }
    DONE
}
