//! `armgen check --format json`: one object a line for each file, for programs.
//!
//! Keys keep their names and meaning; new ones may be added.

use std::path::{Path, PathBuf};

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::diagnostic::{Diagnostic, Diagnostics, Severity};
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::kinds::{JointKind, Scalar};
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::{Source, Span};
use armgen_codegen::{validate, Model};
use serde_json::{json, Value};

use super::Doubts;
use crate::{input, terminal, DONE, FAULTY};

pub(crate) fn run(files: &[PathBuf], doubts: &Doubts) -> u8 {
    let mut worst = DONE;
    for file in files {
        let code = match checked(file, doubts) {
            Ok((object, code)) => code.max(terminal::print(&format!("{object}\n"))),
            Err(code) => code,
        };
        worst = worst.max(code);
    }
    worst
}

fn checked(file: &Path, doubts: &Doubts) -> Result<(Value, u8), u8> {
    let source = input::source(file)?;
    let (valid, mut diagnostics) = validate::read_for(&source, Scalar::F64);
    diagnostics.allow(&doubts.allow);
    let mut summary = Value::Null;
    if let Some((manipulator, places)) = valid {
        let model = Model::new(manipulator);
        match armgen_codegen::programs(&model, &places, &Options::default()) {
            Ok(_) => summary = of_arm(&model.manipulator),
            Err(fault) => {
                let mut faults = Diagnostics::new();
                faults.push(*fault);
                diagnostics.extend(faults);
            }
        }
    }
    let code = if diagnostics.has_errors() || doubts.strict && diagnostics.warnings() > 0 { FAULTY } else { DONE };
    let object = json!({
        "file": source.name(),
        "valid": !diagnostics.has_errors(),
        "errors": diagnostics.errors(),
        "warnings": diagnostics.warnings(),
        "summary": summary,
        "diagnostics": diagnostics.iter().map(|diagnostic| of_diagnostic(diagnostic, &source)).collect::<Vec<_>>(),
    });
    Ok((object, code))
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
                "mass": joint.link.iter().map(|part| number(&part.body.mass)).sum::<f64>(),
            })
        })
        .collect();
    json!({
        "robot": arm.name,
        "gravity": arm.gravity.each_ref().map(number),
        "gravity_is_argument": arm.gravity_is_argument,
        "joints": joints,
        "payload": arm.payload.as_ref().map(|load| number(&load.body.mass)),
        "task": arm.task.iter().map(|row| row.name()).collect::<Vec<_>>(),
    })
}

fn of_diagnostic(diagnostic: &Diagnostic, source: &Source) -> Value {
    let place = |span: Span| {
        let (start, end) = (source.place(span.start), source.place(span.end));
        (start.line, start.column, json!({ "line": end.line, "column": end.column }))
    };
    let (line, column, end) = place(diagnostic.span());
    let others: Vec<Value> = diagnostic.labels[1..]
        .iter()
        .map(|label| {
            let (line, column, end) = place(label.span);
            json!({ "label": label.text, "line": line, "column": column, "end": end })
        })
        .collect();
    json!({
        "code": diagnostic.code.name(),
        "severity": if diagnostic.code.severity() == Severity::Error { "error" } else { "warning" },
        "message": diagnostic.message,
        "label": diagnostic.labels[0].text,
        "help": diagnostic.help,
        "file": source.name(),
        "line": line,
        "column": column,
        "end": end,
        "others": others,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_has_places_and_words() {
        let text = "name: a\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n  - {name: j, type: revolute, a: 145, alpha: 0, d: 0, theta: 0, link: {mass: 1}}\n";
        let source = Source::new("a.yaml", text);
        let (_, diagnostics) = validate::read(&source);
        let reach = diagnostics.iter().find(|d| d.code.name() == "implausible-reach").expect("a length in mm");
        let object = of_diagnostic(reach, &source);
        assert_eq!(object["severity"], "warning");
        assert_eq!((&object["line"], &object["column"]), (&json!(5), &json!(34)));
        assert_eq!(object["end"], json!({ "line": 5, "column": 37 }));
        assert!(object["help"].as_str().is_some_and(|help| help.contains("write 0.145")), "{object}");
    }
}
