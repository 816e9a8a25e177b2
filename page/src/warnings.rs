//! Warnings of a description, each at the row that it is about.

use std::fmt::Write;

use armgen_codegen::description::RobotDescription;
use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Source;

use crate::html::{escape, sentence, with_code};

/// The warnings by row, and those that are about no row.
pub(crate) struct Warnings<'d> {
    rows: Vec<Vec<Placed<'d>>>,
    others: Vec<Placed<'d>>,
    source: &'d Source,
}

/// A diagnostic, and where it is said.
type Placed<'d> = (&'d Diagnostic, usize);

impl<'d> Warnings<'d> {
    pub(crate) fn new(source: &'d Source, description: &RobotDescription, diagnostics: &'d Diagnostics) -> Warnings<'d> {
        let joints: Vec<usize> = description.joints.iter().flat_map(|all| &all.value).map(|joint| joint.span.start).collect();
        let mut warnings = Warnings { rows: joints.iter().map(|_| Vec::new()).collect(), others: Vec::new(), source };
        // What is about several rows stands at each.
        let places =
            diagnostics.iter().flat_map(|diagnostic| diagnostic.labels.iter().map(move |label| (diagnostic, label.span.start)));
        for (diagnostic, at) in places {
            // A key of the file itself ends the rows.
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

    /// The name of the description's file, without its folder: a page is the same wherever the description lies.
    pub(crate) fn file(&self) -> &str {
        self.source.name().rsplit(['/', '\\']).next().unwrap_or_default()
    }

    /// Those of a row, as a list.
    pub(crate) fn of_row(&self, row: usize) -> String {
        self.rows.get(row).map_or_else(String::new, |all| self.list(all))
    }

    /// Those of no row, as a list.
    pub(crate) fn others(&self) -> String {
        self.list(&self.others)
    }

    fn list(&self, all: &[Placed<'_>]) -> String {
        let mut text = String::new();
        for &(diagnostic, at) in all {
            let line = self.source.place(at).line;
            // What to do is said at the first place.
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
