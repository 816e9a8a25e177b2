//! Rust as C: the restricted Rust of the building blocks of inverse kinematics, as C99 that is C++11 too.

mod calls;
mod composed;
mod infer;
mod instances;
mod items;
mod iterators;
mod lower;
mod methods;
mod program;
mod scopes;
mod statements;
mod translator;
mod typed_calls;
mod typed_patterns;
mod types;
mod values;
mod views;

use program::Program;
use translator::Translator;

/// The parts of a header.
pub(super) struct Translated {
    pub(super) macros: String,
    pub(super) typedefs: String,
    pub(super) tables: String,
    pub(super) functions: String,
}

/// What these functions of a text need, in C, with names that begin with `name` and macros with `upper`.
pub(super) fn translated(source: &str, wanted: &[&str], name: &str, upper: &str) -> Result<Translated, String> {
    let file = syn::parse_file(source).map_err(|error| error.to_string())?;
    let expanded = program::expanded(&file.items)?;
    let program = Program::of(&file.items, &expanded)?;
    let mut translator = Translator::new(&program, name, upper);
    for function in wanted {
        translator.instance(function, Vec::new(), Vec::new())?;
    }
    let Translator { macros, typedefs, tables, functions, .. } = translator;
    Ok(Translated { macros, typedefs, tables, functions })
}
