//! `armgen show`: the equations for people and for programs.

use armgen_codegen::catalogue::Absent;
use std::path::Path;

use armgen_codegen::show::{Form, Reading, Sheet, Style};
use armgen_texts::shown::{items, steps_of, steps_of_inverse_kinematics, usual_form, INVERSE_KINEMATICS};

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

pub(crate) fn run(file: &Path, quantities: &[String], asked: &Asked) -> u8 {
    let model = match input::model(file) {
        Ok(model) => model,
        Err(code) => return code,
    };
    let Asked { symbolic, form, digits, format } = *asked;
    let style = Style { form: form.unwrap_or_else(|| usual_form(&model)), digits };
    let as_it_comes = form.is_none() && digits.is_none();
    if let Some(steps) = quantities.iter().find_map(|name| steps_of(&model, &name.replace('-', "_"))) {
        if quantities.len() > 1 || symbolic || !as_it_comes || format != ShowFormat::Text {
            terminal::error(&format!("`{INVERSE_KINEMATICS}` is shown alone, as text with numbers: leave the rest out"));
            return UNREADABLE;
        }
        return terminal::print(&steps);
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
