//! The texts of an arm, as the program writes them.

use armgen_codegen::show::{Form, Reading, Sheet, Style};
use armgen_codegen::source::Source;
use armgen_codegen::Model;
use armgen_texts::shown;

/// A quantity as `armgen show` writes it.
///
/// # Errors
/// No quantity has this name, this arm does not have it, or what is asked for does not exist.
pub(crate) fn shown(
    model: &Model,
    quantity: &str,
    symbolic: bool,
    form: Option<&str>,
    digits: Option<u8>,
    format: &str,
) -> Result<String, String> {
    let form = match form {
        None => shown::usual_form(model),
        Some("shortest") => Form::Shortest,
        Some("closed") => Form::Closed,
        Some("steps") => Form::Steps,
        Some(other) => return Err(format!("form: \"shortest\", \"closed\" or \"steps\", not \"{other}\"")),
    };
    if digits.is_some_and(|digits| !(1..=17).contains(&digits)) {
        return Err("digits: 1 to 17".to_owned());
    }
    if let Some(steps) = shown::steps_of(model, quantity).filter(|_| format == "text") {
        return Ok(steps);
    }
    let items = shown::items(model, &[quantity.to_owned()])?;
    let reading = if symbolic { Reading::Symbolic } else { Reading::Nominal };
    let sheet = Sheet::in_style(model, &items, reading, Style { form, digits });
    if let (true, Some(absent)) = (sheet.quantities.is_empty(), sheet.absent.first()) {
        return Err(format!("there is no `{}` of this arm: {}", absent.function, absent.reason));
    }
    Ok(match format {
        "latex" => sheet.latex(),
        "json" => sheet.json(),
        _ => sheet.text(),
    })
}

/// The page of an arm.
pub(crate) fn page(source: &Source) -> Option<String> {
    armgen_page::page(source, &[]).ok()?.0
}
