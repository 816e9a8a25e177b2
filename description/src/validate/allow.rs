//! `allow`: kinds of warnings that the file asks to be silent about, and the one kind of an error that it may take for a warning.

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::source::Spanned;
use crate::suggest::did_you_mean;

/// The names that are those of warnings; what is none is reported.
pub(super) fn check(names: &[Spanned<String>], diagnostics: &mut Diagnostics) -> Vec<String> {
    let mut allowed = Vec::new();
    for name in names {
        match warning(&name.value) {
            _ if name.value == Code::ImpossibleInertia.name() => {}
            Ok(()) => allowed.push(name.value.clone()),
            Err(help) => {
                let message = format!("`allow` names no kind of warning: `{}`", crate::document::excerpt(&name.value));
                diagnostics.push(Diagnostic::new(Code::UnknownWarning, name.span, message, "no warning", help));
            }
        }
    }
    allowed
}

/// Whether a tensor that no body has is taken as written: what a vendor publishes can be looked at, though its B(q) need not be positive definite.
pub(super) fn takes_inertia_as_written(names: &[Spanned<String>]) -> bool {
    names.iter().any(|name| name.value == Code::ImpossibleInertia.name())
}

/// Whether this is the name of a kind of warning; what to do otherwise.
///
/// # Errors
/// The help for who wrote it.
pub fn warning(name: &str) -> Result<(), String> {
    let with = |severity: Severity| Code::ALL.iter().filter(move |code| code.severity() == severity).map(|code| code.name());
    if with(Severity::Warning).any(|code| code == name) {
        return Ok(());
    }
    if with(Severity::Error).any(|code| code == name) {
        return Err("this is the kind of an error, and nothing is generated from a file with one".to_owned());
    }
    let warnings: Vec<&str> = with(Severity::Warning).collect();
    let guess = did_you_mean(name, &warnings).map_or_else(String::new, |guess| format!("did you mean `{guess}`? "));
    Err(format!("{guess}the kinds of warnings are {}", warnings.join(", ")))
}
