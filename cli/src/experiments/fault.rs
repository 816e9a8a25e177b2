//! What is wrong with an experiment file: gathered, then shown with the source line, as for descriptions of robots.

use armgen_codegen::diagnostic::{render_one, Colour, Diagnostics, Label, Severity};
use armgen_codegen::source::{Source, Span};

/// One fault and its place.
#[derive(Clone, Debug)]
pub(crate) struct Fault {
    code: &'static str,
    message: String,
    labels: Vec<Label>,
    help: String,
}

/// The faults of one file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Faults {
    list: Vec<Fault>,
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
        let labels = vec![Label { span, text: label.into() }];
        self.list.push(Fault { code, message: message.into(), labels, help: help.into() });
    }

    /// Adds those that the reader of YAML and of expressions found.
    pub(crate) fn extend(&mut self, diagnostics: &Diagnostics) {
        for d in diagnostics.iter() {
            let fault = Fault { code: d.code.name(), message: d.message.clone(), labels: d.labels.clone(), help: d.help.clone() };
            self.list.push(fault);
        }
    }

    /// How many.
    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All of them as text, in the order of the file.
    pub(crate) fn render(&self, source: &Source, colour: Colour) -> String {
        let mut list: Vec<&Fault> = self.list.iter().collect();
        list.sort_by_key(|fault| fault.labels[0].span.start);
        let one = |f: &&Fault| render_one(source, Severity::Error, f.code, &f.message, &f.labels, &f.help, colour) + "\n\n";
        list.iter().map(one).collect()
    }
}
