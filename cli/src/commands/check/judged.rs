//! A file as programs learn of it: the arm, or its faults.

use std::path::Path;

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::source::Source;
use serde_json::Value;

use super::Doubts;
use crate::{input, DONE, FAULTY};

pub(super) struct Judged {
    pub(super) source: Source,
    /// The arm of a file without errors.
    pub(super) arm: Option<Manipulator>,
    pub(super) diagnostics: Diagnostics,
    pub(super) code: u8,
}

impl Judged {
    /// Reads and checks a file; the exit code of one that cannot be read.
    pub(super) fn of(file: &Path, doubts: &Doubts) -> Result<Judged, u8> {
        let source = input::source(file)?;
        let (arm, mut diagnostics) = armgen_texts::judged(&source);
        diagnostics.allow(&doubts.allow);
        let code = if diagnostics.has_errors() || doubts.strict && diagnostics.warnings() > 0 { FAULTY } else { DONE };
        Ok(Judged { source, arm, diagnostics, code })
    }

    /// As `armgen check --format json` has it.
    pub(super) fn in_json(&self) -> Value {
        armgen_texts::json::of_file(&self.source, self.arm.as_ref(), &self.diagnostics)
    }
}
