//! What is wrong with an experiment file: gathered, then shown with the source line, as for descriptions of robots.

use armgen_codegen::diagnostic::{AnyCode, Colour, Diagnostic, Diagnostics, Severity};
use armgen_codegen::source::{Source, Span};

/// The faults of one file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Faults {
    list: Diagnostics,
}

impl Faults {
    /// Adds a fault at `span`, which says `label` there.
    pub(crate) fn add(
        &mut self,
        code: &'static str,
        span: Span,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.list.push(Diagnostic::new(AnyCode::new(0, code, Severity::Error), span, message, label, help));
    }

    /// Adds those that the reader of YAML and of expressions found.
    pub(crate) fn extend(&mut self, diagnostics: &Diagnostics) {
        self.list.extend(diagnostics.clone());
    }

    /// How many.
    pub(crate) fn len(&self) -> usize {
        self.list.errors()
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All of them as text, in the order of the file.
    pub(crate) fn render(&self, source: &Source, colour: Colour) -> String {
        let mut list = self.list.clone();
        list.sort();
        list.render(source, colour)
    }
}
