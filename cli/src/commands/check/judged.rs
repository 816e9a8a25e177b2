//! A file as programs learn of it: the arm, or its faults.

use std::path::Path;

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};

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
        let (valid, mut diagnostics) = validate::read_for(&source, Scalar::F64);
        diagnostics.allow(&doubts.allow);
        let mut arm = None;
        if let Some((manipulator, places)) = valid {
            let model = Model::new(manipulator);
            // Only the programs show whether products of valid numbers still fit the scalar.
            match armgen_codegen::programs(&model, &places, &Options::default()) {
                Ok(_) => arm = Some(model.manipulator),
                Err(fault) => {
                    let mut faults = Diagnostics::new();
                    faults.push(*fault);
                    diagnostics.extend(faults);
                }
            }
        }
        let code = if diagnostics.has_errors() || doubts.strict && diagnostics.warnings() > 0 { FAULTY } else { DONE };
        Ok(Judged { source, arm, diagnostics, code })
    }
}
