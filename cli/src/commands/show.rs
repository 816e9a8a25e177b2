//! `armgen show`: the equations for people and for programs.

use armgen_codegen::catalogue::Absent;
use std::path::Path;

use armgen_codegen::show::{Item, Reading, Sheet, Style};
use armgen_codegen::suggest::did_you_mean;
use armgen_codegen::Model;

use crate::{input, terminal, ShowFormat, UNREADABLE};

pub(crate) fn run(file: &Path, quantities: &[String], symbolic: bool, style: Style, format: ShowFormat) -> u8 {
    let model = match input::model(file) {
        Ok(model) => model,
        Err(code) => return code,
    };
    if quantities.iter().any(|name| name.replace('-', "_") == INVERSE_KINEMATICS) {
        return inverse_kinematics(
            &model,
            quantities.len() > 1 || symbolic || style != Style::default() || format != ShowFormat::Text,
        );
    }
    let items = match items(&model, quantities) {
        Ok(items) => items,
        Err(message) => {
            terminal::error(&message);
            return UNREADABLE;
        }
    };
    let sheet = Sheet::in_style(&model, &items, if symbolic { Reading::Symbolic } else { Reading::Nominal }, style);
    if format == ShowFormat::Json && !quantities.is_empty() {
        for Absent { function: name, reason } in &sheet.absent {
            terminal::note(&format!("{name}: {reason}"));
        }
    }
    // Steps with numbers have one form.
    let with_steps = quantities.is_empty() && !symbolic && style == Style::default();
    terminal::print(&match format {
        ShowFormat::Text if with_steps => format!("{}\n{}", sheet.text(), steps_of_inverse_kinematics(&model)),
        ShowFormat::Text => sheet.text(),
        ShowFormat::Latex => sheet.latex(),
        ShowFormat::Json => sheet.json(),
    })
}

/// What is no quantity but a procedure: its class and its steps.
const INVERSE_KINEMATICS: &str = "inverse_kinematics";

fn inverse_kinematics(model: &Model, otherwise: bool) -> u8 {
    if otherwise {
        terminal::error(&format!("`{INVERSE_KINEMATICS}` is shown alone, as text with numbers: leave the rest out"));
        return UNREADABLE;
    }
    terminal::print(&steps_of_inverse_kinematics(model))
}

fn steps_of_inverse_kinematics(model: &Model) -> String {
    match armgen_codegen::inverse_kinematics::of(&model.manipulator) {
        Ok(found) => found.text(),
        Err(reason) => format!("{INVERSE_KINEMATICS}: none, {reason}\n"),
    }
}

fn items(model: &Model, quantities: &[String]) -> Result<Vec<Item>, String> {
    if quantities.is_empty() {
        return Ok(Item::all());
    }
    let dof = model.manipulator.dof();
    let mut items = Vec::new();
    for name in quantities {
        let named = Item::named(name, dof);
        if named.is_empty() {
            let names: Vec<String> = Item::names().into_iter().chain([INVERSE_KINEMATICS.to_owned()]).collect();
            let meant = did_you_mean(&name.replace('-', "_"), &names.iter().map(String::as_str).collect::<Vec<_>>())
                .map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
            let known: Vec<String> = names.chunks(4).map(|names| names.join(", ")).collect();
            let lists: Vec<String> = Item::lists().iter().map(|of| format!("{of}_1 to {of}_{dof}")).collect();
            return Err(format!(
                "there is no quantity `{name}`\n  {meant}known are\n  {},\n  {}",
                known.join(",\n  "),
                lists.join(", ")
            ));
        }
        items.extend(named);
    }
    Ok(items)
}
