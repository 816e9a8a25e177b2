//! `allow`: kinds of warnings that the file accepts, and the only kind of error that it may accept.

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::source::Spanned;
use crate::suggest::did_you_mean;

/// The names that are kinds of warnings; others are reported.
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

/// Whether the file accepts a tensor that no body has. Vendors publish such tensors; users can inspect them, but B(q) need not be
/// positive definite.
pub(super) fn takes_inertia_as_written(names: &[Spanned<String>]) -> bool {
    names.iter().any(|name| name.value == Code::ImpossibleInertia.name())
}

/// Whether this is the name of a kind of warning; otherwise the help.
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
