//! Descriptions from files: read and checked, with faults on standard error.

use std::path::Path;

use armgen_codegen::catalogue::Absent;
use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::kinds::{Feature, Scalar};
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::Selection;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::Model;
pub(crate) use armgen_terminal::input::{counted, source};
use armgen_terminal::input::{text, LONGEST, OTHERS_ARE_SHORT};

use crate::terminal;
use crate::{FAULTY, UNREADABLE};

/// The text of a description; of a file of XML, the exit code after a message with the command that makes it a description.
pub(crate) fn description(path: &Path) -> Result<Source, u8> {
    let source = source(path)?;
    if source.text().trim_start().starts_with('<') {
        let name = source.name();
        terminal::error(&format!(
            "{name} is XML, not a description: of a URDF or a MuJoCo model `armgen import {name} --out robot.yaml` makes one"
        ));
        return Err(FAULTY);
    }
    Ok(source)
}

/// Prints the diagnostics of a source, if there are any.
pub(crate) fn show(source: &Source, diagnostics: &Diagnostics) {
    if !diagnostics.is_empty() {
        terminal::diagnose(&diagnostics.render(source, terminal::colour(&std::io::stderr())));
    }
}

/// The content that a reader found in a source, after its diagnostics; the exit code if one of them is an error.
pub(crate) fn accepted<T>(source: &Source, (content, diagnostics): (T, Diagnostics)) -> Result<T, u8> {
    show(source, &diagnostics);
    if diagnostics.has_errors() {
        return Err(FAULTY);
    }
    Ok(content)
}

/// The text of a log. A log may be longer than the limit; the message then has a remedy.
pub(crate) fn log(path: &Path) -> Result<Source, u8> {
    let samples = armgen_page::SAMPLES;
    let remedy = format!("a page keeps {samples} samples at most, so give it the first line and, of the others, every tenth");
    Ok(Source::new(path.display().to_string(), text(path, &remedy)?))
}

/// A file that armgen has written: its text is what it is judged by, so a byte order mark in front of it, which reading drops, is refused.
pub(crate) fn written(path: &Path) -> Result<Source, u8> {
    let (name, text) = (path.display().to_string(), text(path, OTHERS_ARE_SHORT)?);
    if text.starts_with('\u{feff}') {
        terminal::error(&format!("{name} begins with a byte order mark, which no file that armgen writes does"));
        return Err(FAULTY);
    }
    Ok(Source::new(name, text))
}

/// The files of a package of MATLAB as one text. Other files in the folder could take the place of a function.
pub(crate) fn package(folder: &Path) -> Result<Source, u8> {
    let name = folder.display().to_string();
    let unreadable = |error: std::io::Error| {
        terminal::error(&format!("cannot read {name}: {error}"));
        UNREADABLE
    };
    let mut files = Vec::new();
    let mut length = 0;
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if file.starts_with('.') {
            continue;
        }
        if path.is_dir() || !file.ends_with(".m") {
            terminal::error(&format!(
                "{} is not of a package that armgen writes, and could hide a function of it",
                path.display()
            ));
            return Err(FAULTY);
        }
        let text = written(&path)?.text().to_string();
        length += text.len();
        if length > LONGEST {
            terminal::error(&format!(
                "the files of {name} are longer than {} MiB: no package that armgen writes is",
                LONGEST >> 20
            ));
            return Err(UNREADABLE);
        }
        files.push((file, text));
    }
    let joined = armgen_verify::read::reader::matlab::joined(files);
    joined.map(|text| Source::new(name, text)).map_err(|(file, reason)| {
        terminal::error(&format!("{}: this file {reason}", folder.join(file).display()));
        FAULTY
    })
}

/// The exit code, after a message, where joints or motors are coupled, or joints have smooth friction: for commands that need a coordinate of each joint and the
/// signs of rates.
pub(crate) fn without_coupling(source: &Source, manipulator: &Manipulator, command: &str) -> Result<(), u8> {
    if let Some(joint) = manipulator.joints.iter().find(|joint| joint.smooth.is_some()) {
        terminal::error(&format!(
            "{}: smooth-friction: joint `{}` has smooth friction, and `armgen {command}` does not take it; leave out `smooth`",
            source.name(),
            joint.name
        ));
        return Err(FAULTY);
    }
    let name = source.name();
    if let Some(joint) = manipulator.joints.iter().find(|joint| joint.has(Feature::CoupledMotor)) {
        terminal::error(&format!(
            "{name}: the motor of joint `{}` turns with several joints, and `armgen {command}` takes friction of single joints alone; leave out `coupling`",
            joint.name
        ));
        return Err(FAULTY);
    }
    let Some(joint) = manipulator.coupled_joint() else { return Ok(()) };
    terminal::error(&format!(
        "{name}: joint `{}` is coupled with others, and `armgen {command}` does not take coupled joints; without `follows` and `adds`, \
         in a copy of the file, each joint moves freely",
        joint.name
    ));
    Err(FAULTY)
}

/// How much of a valid file's warnings goes to standard error.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Warnings {
    /// All of them.
    Shown,
    /// One line with their number.
    Counted,
}

/// The valid arm of a file; faults go to standard error.
pub(crate) fn manipulator(source: &Source, scalar: Scalar, warnings: Warnings) -> Result<(Manipulator, Diagnostics), u8> {
    let (valid, diagnostics) = validate::read_for(source, scalar);
    let (manipulator, _) = report_or_exit_code(source, valid, &diagnostics, warnings)?;
    Ok((manipulator, diagnostics))
}

/// The result of reading a file, or the exit code; faults go to standard error.
pub(crate) fn report_or_exit_code<T>(
    source: &Source,
    given: Option<T>,
    diagnostics: &Diagnostics,
    warnings: Warnings,
) -> Result<T, u8> {
    if warnings == Warnings::Shown || diagnostics.has_errors() {
        show(source, diagnostics);
    } else if diagnostics.warnings() > 0 {
        let name = source.name();
        terminal::diagnose(&format!(
            "{name}: {}; `armgen check {name}` shows it all\n",
            counted(diagnostics.warnings(), "warning")
        ));
    }
    given.ok_or_else(|| {
        terminal::error(&verdict(source, diagnostics));
        FAULTY
    })
}

/// How many faults a file has.
pub(crate) fn verdict(source: &Source, diagnostics: &Diagnostics) -> String {
    let (errors, warnings) = (diagnostics.errors(), diagnostics.warnings());
    let also = if warnings == 0 { String::new() } else { format!(" and {}", counted(warnings, "warning")) };
    format!("{}: {}{also}", source.name(), counted(errors, "error"))
}

/// The model of a file's arm.
pub(crate) fn model(path: &Path) -> Result<Model, u8> {
    let source = description(path)?;
    let (manipulator, _) = manipulator(&source, Scalar::F64, Warnings::Counted)?;
    Ok(Model::new(manipulator))
}

/// The functions with these names, all without names; faults go to standard error.
pub(crate) fn selection(names: &[String]) -> Option<Selection> {
    if names.is_empty() {
        return Some(Selection::ALL);
    }
    Selection::named(names).map_err(|unknown| terminal::error(&unknown.to_string())).ok()
}

/// Whether the arm has every function that was asked for; those that it does not have, and why, go to standard error.
pub(crate) fn all_there(robot: &str, absent: &[Absent], selection: &Selection) -> bool {
    if selection.is_all() {
        return true;
    }
    for Absent { function, reason } in absent {
        terminal::error(&format!("{robot} has no `{function}`: {reason}"));
    }
    absent.is_empty()
}
