//! `armgen check`: a summary of a description, and its faults.

mod judged;
mod sarif;

use std::path::{Path, PathBuf};

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::parallel::both;
use armgen_codegen::schedule::Options;
use armgen_codegen::{validate, Model};
use armgen_texts::{json, summary};

use crate::{input, terminal, DONE, FAULTY};

use super::verify::with_spinner;
use judged::Judged;

/// Checks every file; the exit code is the worst of them.
pub(crate) fn run(files: &[PathBuf], doubts: &Doubts, full: bool) -> u8 {
    let mut worst = DONE;
    for (i, file) in files.iter().enumerate() {
        let code = match checked(file, doubts, full) {
            Ok((summary, code)) => code.max(terminal::print(&if i > 0 { format!("\n{summary}") } else { summary })),
            Err(code) => code,
        };
        worst = worst.max(code);
    }
    worst
}

/// Checks every file and prints one document for programs; files that cannot be read are not in it.
pub(crate) fn run_for_programs(files: &[PathBuf], doubts: &Doubts, form: Form) -> u8 {
    let (mut worst, mut readable) = (DONE, Vec::new());
    for file in files {
        match Judged::of(file, doubts) {
            Ok(judged) => {
                worst = worst.max(judged.code);
                readable.push(judged);
            }
            Err(code) => worst = worst.max(code),
        }
    }
    let document = match form {
        Form::Json => json::document(readable.iter().map(Judged::in_json)),
        Form::Sarif => sarif::document(&readable),
    };
    worst.max(terminal::print(&format!("{document}\n")))
}

/// Forms of the document for programs.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form {
    /// A form of armgen's own.
    Json,
    /// SARIF 2.1.0.
    Sarif,
}

/// The treatment of warnings.
#[derive(Debug)]
pub(crate) struct Doubts {
    /// Warnings are failures.
    pub(crate) strict: bool,
    /// Kinds that are hidden.
    pub(crate) allow: Vec<String>,
}

/// The summary, and the exit code.
fn checked(file: &Path, doubts: &Doubts, full: bool) -> Result<(String, u8), u8> {
    let source = input::description(file)?;
    let (valid, mut diagnostics) = validate::read_for(&source, Scalar::F64);
    diagnostics.allow(&doubts.allow);
    let (manipulator, places) = input::report_or_exit_code(&source, valid, &diagnostics, input::Warnings::Shown)?;
    let model = Model::new(manipulator);
    let (summary, too_large) = with_spinner("deriving", || {
        both(
            || summary::of_arm(&source, &model, &diagnostics, full),
            // Only its programs show whether products of valid numbers still fit the scalar.
            || armgen_codegen::programs(&model, &places, &Options::default()).err(),
        )
    });
    if let Some(fault) = too_large {
        // The other diagnostics are already printed.
        let mut faults = Diagnostics::new();
        faults.push(*fault);
        terminal::diagnose(&faults.render(&source, terminal::colour(&std::io::stderr())));
        diagnostics.extend(faults);
        terminal::error(&input::verdict(&source, &diagnostics));
        return Err(FAULTY);
    }
    let code = if doubts.strict && diagnostics.warnings() > 0 {
        let warnings = input::counted(diagnostics.warnings(), "warning");
        terminal::error(&format!("{}: {warnings}, and --strict", source.name()));
        FAULTY
    } else {
        DONE
    };
    let (title, rest) = summary.split_once('\n').unwrap_or((&summary, ""));
    Ok((format!("{}\n{rest}", terminal::bold(title, &std::io::stdout())), code))
}
