//! The warnings of a description, each at the rows it concerns.

use std::fmt::Write;

use armgen_codegen::description::RobotDescription;
use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Source;

use crate::html::{escape, sentence, with_code};

/// The warnings by row, and those without a row.
pub(crate) struct Warnings<'d> {
    rows: Vec<Vec<Placed<'d>>>,
    others: Vec<Placed<'d>>,
    source: &'d Source,
}

/// A diagnostic and its position in the text.
type Placed<'d> = (&'d Diagnostic, usize);

impl<'d> Warnings<'d> {
    pub(crate) fn new(source: &'d Source, description: &RobotDescription, diagnostics: &'d Diagnostics) -> Warnings<'d> {
        let joints: Vec<usize> = description.joints.iter().flat_map(|all| &all.value).map(|joint| joint.span.start).collect();
        let mut warnings = Warnings { rows: joints.iter().map(|_| Vec::new()).collect(), others: Vec::new(), source };
        // A warning about several rows appears at each.
        let places =
            diagnostics.iter().flat_map(|diagnostic| diagnostic.labels.iter().map(move |label| (diagnostic, label.span.start)));
        for (diagnostic, at) in places {
            // A top-level key of the file ends the rows.
            let after = |start: usize| {
                let between = source.text().get(start..at).unwrap_or_default();
                between.lines().skip(1).any(|line| line.starts_with(|c: char| c.is_ascii_alphabetic()))
            };
            match joints.iter().rposition(|&start| start <= at).filter(|&row| !after(joints[row])) {
                Some(row) => warnings.rows[row].push((diagnostic, at)),
                None => warnings.others.push((diagnostic, at)),
            }
        }
        warnings
    }

    /// The file name of the description without its folder: a page does not depend on the description's location.
    pub(crate) fn file(&self) -> &str {
        self.source.name().rsplit(['/', '\\']).next().unwrap_or_default()
    }

    /// The warnings of a row, as a list.
    pub(crate) fn of_row(&self, row: usize) -> String {
        self.rows.get(row).map_or_else(String::new, |all| self.list(all))
    }

    /// The warnings without a row, as a list.
    pub(crate) fn others(&self) -> String {
        self.list(&self.others)
    }

    fn list(&self, all: &[Placed<'_>]) -> String {
        let mut text = String::new();
        for &(diagnostic, at) in all {
            let line = self.source.place(at).line;
            // The remedy appears only at the first place.
            let help = if at == diagnostic.span().start { with_code(&sentence(&diagnostic.help)) + "." } else { String::new() };
            let _ = writeln!(
                text,
                "<p class=\"warning\" data-warning=\"{}\"><strong>Warning</strong> (line {line} of {}): {}. {help}</p>",
                escape(diagnostic.code.name()),
                escape(self.file()),
                with_code(&diagnostic.message),
            );
        }
        text
    }
}
