//! For a paper: displayed formulas for a document that uses the package amsmath.
//!
//! A matrix that fits a line is a `bmatrix`; of another each entry that is not zero gets a line, broken where it is long.

use crate::catalogue::Absent;
use std::fmt::Write;

use super::lines::{broken, measure};
use super::minors::Words;
use super::{Formulas, Sheet, Shown};
use crate::derive::determinant::minors::Product;
use crate::derive::determinant::Zeros;
use crate::ring::print::Notation;

/// Width of a displayed line, pt: that of the class `article` is 345.
const WIDTH: usize = 330;
/// Indentation of the second and later lines of a formula, pt.
const INDENT: usize = 14;

/// A `bmatrix` of amsmath has at most this many columns.
const MATRIX_COLUMNS: usize = 10;

/// An aligned block holds at most this many lines: it cannot be broken between pages.
const LINES: usize = 24;

impl Sheet {
    /// The sheet as LaTeX, for the body of a document with `\usepackage{amsmath}`.
    pub fn latex(&self) -> String {
        let mut text = format!("% {}, for a document with \\usepackage{{amsmath}}\n", self.robot);
        for shown in &self.quantities {
            write!(text, "\n% {}\n{}", shown.name, shown.latex()).expect("writing to a string");
        }
        for Absent { function: name, reason } in &self.absent {
            write!(text, "\n% {name}: {reason}\n").expect("writing to a string");
        }
        text
    }
}

impl Shown {
    fn latex(&self) -> String {
        let formulas = self.formulas(Notation::Latex);
        if let Some(left) = self.minors() {
            return self.latex_of_minors(left, &formulas);
        }
        let body = match self.matrix(&formulas) {
            Some(matrix) => format!("\\[\n  {} = {matrix}\n\\]\n", self.symbol[1]),
            None => self.aligned(&formulas),
        };
        let factors = self.latex_factors();
        if factors.is_empty() {
            return body;
        }
        format!("\\noindent ${}$ is the product of\n{factors}multiplied out:\n{body}", self.symbol[1])
    }

    /// The minors: their common factors, and the rest of each.
    fn latex_of_minors(&self, left: &[Product], formulas: &Formulas) -> String {
        let Words { head, where_lost } = self.words(left, Notation::Latex);
        let names = self.equal_minors(left, |k| self.latex_entry_name(k, 0));
        let all: Vec<(String, &str)> = names.iter().map(|(names, k)| (names.clone(), formulas.entries[*k].as_str())).collect();
        format!("\\noindent {head}\n{}{where_lost}:\n{}", self.latex_factors(), named(&all))
    }

    /// The factors of the determinant, and where they are zero.
    fn latex_factors(&self) -> String {
        let mut lines = Vec::new();
        for (factor, zeros) in self.factors(Notation::Latex).unwrap_or_default() {
            lines.extend(broken(&factor, Notation::Latex, WIDTH - INDENT).into_iter().map(|piece| format!("& {piece}")));
            lines.push(match zeros {
                Zeros::Of([_, latex]) => format!("&\\qquad\\text{{zero at }} {latex}"),
                _ => format!("&\\qquad\\text{{{}}}", zeros.sentence()),
            });
        }
        if lines.is_empty() {
            return String::new();
        }
        let lines = lines.join(" \\\\\n    ");
        format!("\\[\n  \\begin{{aligned}}\n    {lines}\n  \\end{{aligned}}\n\\]\n")
    }

    /// The whole matrix, if it fits.
    fn matrix(&self, formulas: &Formulas) -> Option<String> {
        let measure = measure(Notation::Latex);
        let widths = (0..self.columns).map(|j| formulas.entries.iter().skip(j).step_by(self.columns).map(|e| measure(e)).max());
        // Columns are 10 pt apart, and the symbol precedes them.
        let width = widths.map(|w| w.unwrap_or(0) + 10).sum::<usize>() + measure(&self.symbol[1]) + 24;
        if !self.is_closed() || width > WIDTH || self.columns > MATRIX_COLUMNS || self.column_names.is_some() {
            return None;
        }
        if self.rows == 1 && self.columns == 1 {
            return Some(formulas.entries[0].clone());
        }
        let rows: Vec<String> = formulas.entries.chunks(self.columns).map(|row| format!("    {}", row.join(" & "))).collect();
        Some(format!("\\begin{{bmatrix}}\n{}\n  \\end{{bmatrix}}", rows.join(" \\\\\n")))
    }

    /// Steps and entries that are not zero, in blocks; of a symmetric matrix the upper half.
    fn aligned(&self, formulas: &Formulas) -> String {
        let symmetric = self.is_symmetric();
        let mut all: Vec<(String, &str)> =
            formulas.steps.iter().map(|(name, formula)| (name.clone(), formula.as_str())).collect();
        let steps = all.len();
        let mut zeros = false;
        for i in 0..self.rows {
            for j in if symmetric { i } else { 0 }..self.columns {
                match formulas.entries[i * self.columns + j].as_str() {
                    "0" => zeros = true,
                    formula => all.push((self.latex_entry_name(i, j), formula)),
                }
            }
        }
        let notes: Vec<&str> =
            [(symmetric, "symmetric"), (zeros, "other entries 0")].iter().filter(|(holds, _)| *holds).map(|(_, n)| *n).collect();
        let mut text = format!("\\noindent ${}$", self.symbol[1]);
        if all.len() == steps {
            return text + " is zero.\n";
        }
        if !notes.is_empty() {
            write!(text, " ({})", notes.join(", ")).expect("writing to a string");
        }
        text.push_str(":\n");
        text + &named(&all)
    }

    pub(super) fn latex_entry_name(&self, row: usize, column: usize) -> String {
        let letter = self.letter[1];
        // A parameter prints its number as an index, with or without an underscore in its name.
        let is_entry = self.is_entry_of(self.letter[0]);
        let taken = self.parameters.iter().any(|name| is_entry(name) || is_entry(&name.replacen('_', "", 1)));
        let prime = if taken { "'" } else { "" };
        let indexed = |index: String| {
            // The letter may have an index of its own.
            match letter.split_once('_') {
                Some((letter, own)) => format!("{letter}{prime}_{{{own},{index}}}"),
                None => format!("{letter}{prime}_{{{index}}}"),
            }
        };
        match (self.rows, self.columns) {
            (1, 1) => format!("{letter}{prime}"),
            (_, 1) => indexed((row + 1).to_string()),
            (rows, columns) if rows < 10 && columns < 10 => indexed(format!("{}{}", row + 1, column + 1)),
            _ => indexed(format!("{},{}", row + 1, column + 1)),
        }
    }
}

/// Formulas with their names, a line each or, where they are long, several, in blocks.
fn named(all: &[(String, &str)]) -> String {
    let mut lines: Vec<String> = Vec::new();
    // Formulas start after the longest name.
    let names = all.iter().map(|(name, _)| measure(Notation::Latex)(name)).max().unwrap_or(0) + 14;
    for (name, formula) in all {
        for (k, piece) in broken(formula, Notation::Latex, WIDTH.saturating_sub(names + INDENT)).iter().enumerate() {
            lines.push(match k {
                0 => format!("{name} &= {piece}"),
                _ => format!("&\\quad {piece}"),
            });
        }
    }
    let block =
        |lines: &[String]| format!("\\[\n  \\begin{{aligned}}\n    {}\n  \\end{{aligned}}\n\\]\n", lines.join(" \\\\\n    "));
    lines.chunks(LINES).map(block).collect()
}
