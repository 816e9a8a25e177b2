//! `armgen check --format json`: one document for all files; `docs/editors.md` describes it.
//!
//! Keys keep their names and meaning within a version; new ones may be added.

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::source::{Source, Span};
use serde_json::{json, Value};

/// The version of the form.
const VERSION: u32 = 1;

/// The document of files.
pub fn document(files: impl IntoIterator<Item = Value>) -> Value {
    json!({ "version": VERSION, "files": files.into_iter().collect::<Vec<_>>() })
}

/// A file: the arm if it is valid, and the diagnostics.
pub fn of_file(source: &Source, arm: Option<&Manipulator>, diagnostics: &Diagnostics) -> Value {
    json!({
        "file": source.name(),
        "valid": !diagnostics.has_errors(),
        "errors": diagnostics.errors(),
        "warnings": diagnostics.warnings(),
        "summary": arm.map(of_arm),
        "diagnostics": diagnostics.iter().map(|diagnostic| of_diagnostic(diagnostic, source)).collect::<Vec<_>>(),
    })
}

/// The arm in SI units.
fn of_arm(arm: &Manipulator) -> Value {
    let number = |value: &Polynomial| nominal(arm, value).to_f64();
    let joints: Vec<Value> = arm
        .joints
        .iter()
        .map(|joint| {
            json!({
                "name": joint.name,
                "type": if joint.kind == JointKind::Revolute { "revolute" } else { "prismatic" },
                "position": joint.limits.position.as_ref().map(|limits| limits.each_ref().map(Number::to_f64)),
                "velocity": joint.limits.velocity.as_ref().map(Number::to_f64),
                "effort": joint.limits.effort.as_ref().map(Number::to_f64),
                "acceleration": joint.limits.acceleration.as_ref().map(Number::to_f64),
                "jerk": joint.limits.jerk.as_ref().map(Number::to_f64),
                "mass": joint.link.iter().map(|part| number(&part.body.mass)).sum::<f64>(),
            })
        })
        .collect();
    let loads = arm.loads();
    let mut object = json!({
        "robot": arm.name,
        "gravity": arm.gravity.each_ref().map(number),
        "gravity_is_argument": arm.gravity_is_argument,
        "joints": joints,
        "payload": (!loads.is_empty()).then(|| loads.iter().map(|load| number(&load.body.body.mass)).sum::<f64>()),
        "task": arm.task.iter().map(|row| row.name()).collect::<Vec<_>>(),
    });
    if arm.coupling.is_some() {
        object["coordinates"] = arm.coordinates().iter().map(|of| of.joint.name.clone()).collect();
    }
    if !arm.tips.is_empty() {
        let tips = arm.tips.iter().map(|tip| {
            let task: Vec<&str> = tip.task.iter().map(|row| row.name()).collect();
            json!({ "name": tip.name, "joint": arm.joints[tip.joint.index()].name, "task": task })
        });
        object["tips"] = tips.collect();
    }
    object
}

fn of_diagnostic(diagnostic: &Diagnostic, source: &Source) -> Value {
    let mut object = place(diagnostic.span(), source);
    object["code"] = json!(diagnostic.code.name());
    object["severity"] = json!(diagnostic.code.severity().name());
    object["message"] = json!(diagnostic.message);
    object["help"] = json!(diagnostic.help);
    object["labels"] = diagnostic
        .labels
        .iter()
        .map(|label| {
            let mut object = place(label.span, source);
            object["text"] = json!(label.text);
            object["start"] = json!(label.span.start);
            object["end"] = json!(label.span.end);
            object
        })
        .collect();
    object
}

/// Lines and columns from 1, columns in characters; the end lies after the last character.
fn place(span: Span, source: &Source) -> Value {
    let (start, end) = (source.place(span.start), source.place(span.end));
    json!({ "line": start.line, "column": start.column, "end_line": end.line, "end_column": end.column })
}
