//! `armgen convert`: a description in rows of another convention.

use std::path::{Path, PathBuf};

use armgen_codegen::description::Convention;

use crate::output::write_other;
use crate::{input, terminal};

/// A convention.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum To {
    /// Denavit-Hartenberg as in Siciliano: A = Rz(theta) Tz(d) Tx(a) Rx(alpha)
    Standard,
    /// Denavit-Hartenberg as in Craig: A = Rx(alpha) Tx(a) Rz(theta) Tz(d)
    Modified,
    /// Frames and axes, as in a URDF
    Urdf,
}

impl From<To> for Convention {
    fn from(to: To) -> Convention {
        match to {
            To::Standard => Convention::Standard,
            To::Modified => Convention::Modified,
            To::Urdf => Convention::Urdf,
        }
    }
}

pub(crate) fn run(file: &Path, to: To, out: Option<&PathBuf>) -> u8 {
    let source = match input::description(file) {
        Ok(source) => source,
        Err(code) => return code,
    };
    let (converted, diagnostics) = armgen_import::convert(&source, to.into());
    let converted = match input::report_or_exit_code(&source, converted, &diagnostics, input::Warnings::Counted) {
        Ok(converted) => converted,
        Err(code) => return code,
    };
    for line in &converted.lines {
        terminal::note(line);
    }
    match out {
        Some(out) => write_other([(file, "the description")], out, &converted.yaml),
        None => terminal::print(&converted.yaml),
    }
}
