//! `armgen show`: the equations for people and for programs.

use armgen_codegen::catalogue::Absent;
use std::path::Path;

use armgen_codegen::show::{Form, Item, Reading, Sheet, Style};
use armgen_codegen::suggest::function_meant;
use armgen_codegen::Model;

use crate::{input, terminal, ShowFormat, UNREADABLE};

/// The requested form of the equations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    pub(crate) symbolic: bool,
    /// None: by the size of the arm.
    pub(crate) form: Option<Form>,
    pub(crate) digits: Option<u8>,
    pub(crate) format: ShowFormat,
}

/// Arms of so many joints have closed forms that a person reads.
const FEW_JOINTS: usize = 4;

/// The form of an arm's equations unless another is asked for.
pub fn usual_form(model: &Model) -> Form {
    if model.manipulator.dof() <= FEW_JOINTS {
        Form::Closed
    } else {
        Form::Shortest
    }
}

pub(crate) fn run(file: &Path, quantities: &[String], asked: &Asked) -> u8 {
    let model = match input::model(file) {
        Ok(model) => model,
        Err(code) => return code,
    };
    let Asked { symbolic, form, digits, format } = *asked;
    let style = Style { form: form.unwrap_or_else(|| usual_form(&model)), digits };
    let as_it_comes = form.is_none() && digits.is_none();
    if quantities.iter().any(|name| name.replace('-', "_") == INVERSE_KINEMATICS) {
        return inverse_kinematics(&model, quantities.len() > 1 || symbolic || !as_it_comes || format != ShowFormat::Text);
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
    let with_steps = quantities.is_empty() && !symbolic && as_it_comes;
    terminal::print(&match format {
        ShowFormat::Text if with_steps => format!("{}\n{}", sheet.text(), steps_of_inverse_kinematics(&model)),
        ShowFormat::Text => sheet.text(),
        ShowFormat::Latex => sheet.latex(),
        ShowFormat::Json => sheet.json(),
    })
}

/// Not a quantity but a procedure: its class and its steps.
const INVERSE_KINEMATICS: &str = "inverse_kinematics";

fn inverse_kinematics(model: &Model, otherwise: bool) -> u8 {
    if otherwise {
        terminal::error(&format!("`{INVERSE_KINEMATICS}` is shown alone, as text with numbers: leave the rest out"));
        return UNREADABLE;
    }
    terminal::print(&steps_of_inverse_kinematics(model))
}

/// The class of an arm's inverse kinematics and its steps.
pub fn steps_of_inverse_kinematics(model: &Model) -> String {
    match armgen_codegen::inverse_kinematics::of(&model.manipulator) {
        Ok(found) => found.text(),
        Err(reason) => format!("{INVERSE_KINEMATICS}: none, {reason}\n"),
    }
}

/// The items of names, all if there are none.
///
/// # Errors
/// A name that no quantity has, with the nearest.
pub fn items(model: &Model, quantities: &[String]) -> Result<Vec<Item>, String> {
    if quantities.is_empty() {
        return Ok(Item::all());
    }
    let dof = model.manipulator.dof();
    let mut items = Vec::new();
    for name in quantities {
        let named = Item::named(name, dof);
        if named.is_empty() {
            let names: Vec<String> = Item::names().into_iter().chain([INVERSE_KINEMATICS.to_owned()]).collect();
            let meant = function_meant(&name.replace('-', "_"), &names.iter().map(String::as_str).collect::<Vec<_>>())
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
