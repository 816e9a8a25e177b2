//! For a terminal: matrices that fit as tables, others one line per entry that is not zero.

use crate::catalogue::Absent;
use std::fmt::Write;

use super::lines::broken;
use super::minors::Words;
use super::{Formulas, Sheet, Shown};
use crate::derive::determinant::minors::Product;
use crate::ring::print::Notation;

/// Lines are at most so long where a formula can be broken.
const WIDTH: usize = 110;

impl Sheet {
    /// The sheet as plain text.
    pub fn text(&self) -> String {
        let mut parts: Vec<String> = self.quantities.iter().map(Shown::text).collect();
        parts.extend(self.absent.iter().map(|Absent { function, reason }| prose(&format!("{function}: {reason}"))));
        parts.join("\n")
    }
}

/// A sentence in lines of at most [`WIDTH`], those after the first one indented.
fn prose(sentence: &str) -> String {
    let mut lines = vec![String::new()];
    for word in sentence.split(' ') {
        let line = lines.last_mut().expect("there is one");
        if line.len() + 1 + word.len() > WIDTH {
            lines.push(format!("    {word}"));
        } else {
            let blank = if line.is_empty() { "" } else { " " };
            line.push_str(&format!("{blank}{word}"));
        }
    }
    lines.join("\n") + "\n"
}

impl Shown {
    pub(super) fn text(&self) -> String {
        let formulas = self.plain_text();
        if let Some(left) = self.minors() {
            return self.text_of_minors(left, formulas);
        }
        let mut text = format!("{}: {}", self.name, self.symbol[0]);
        match (self.rows, self.columns) {
            (1, 1) => {}
            (rows, columns) => write!(text, ", {rows} x {columns}").expect("writing to a string"),
        }
        let factors = self.text_factors();
        if !factors.is_empty() {
            text = format!("{text}, the product of\n{factors}multiplied out");
        }
        if !formulas.steps.is_empty() {
            let count = formulas.steps.len();
            write!(text, ", in {count} {}", if count == 1 { "step" } else { "steps" }).expect("writing to a string");
        }
        match self.table(formulas) {
            Some(table) => text + "\n" + &table,
            None => self.lines(text, formulas),
        }
    }

    /// The minors: their common factors, and the rest of each.
    fn text_of_minors(&self, left: &[Product], formulas: &Formulas) -> String {
        let Words { head, where_lost } = self.words(left, Notation::Text);
        let title = format!("{}: {head}\n{}{where_lost}\n", self.name, self.text_factors());
        let names = self.equal_minors(left, |k| self.entry_name(k, 0));
        title + &named(names.iter().map(|(names, k)| (names.clone(), formulas.entries[*k].as_str())).collect())
    }

    /// The factors of the determinant, and where they are zero.
    fn text_factors(&self) -> String {
        let mut text = String::new();
        for (factor, zeros) in self.factors(Notation::Text).unwrap_or_default() {
            const INDENT: usize = 10;
            let pieces = broken(&factor, Notation::Text, WIDTH - INDENT);
            let factor = pieces.join(&format!("\n{:INDENT$}", ""));
            writeln!(text, "  factor  {factor}\n{:INDENT$}{}", "", zeros.sentence()).expect("writing to a string");
        }
        text
    }

    /// The whole matrix, if it fits.
    pub(super) fn table(&self, formulas: &Formulas) -> Option<String> {
        if !self.is_closed() || self.columns == 1 || self.column_names.is_some() {
            return None;
        }
        let rows: Vec<&[String]> = formulas.entries.chunks(self.columns).collect();
        let widths: Vec<usize> = (0..self.columns).map(|j| rows.iter().map(|row| row[j].len()).max().unwrap_or(0)).collect();
        if widths.iter().sum::<usize>() + 3 * self.columns > WIDTH {
            return None;
        }
        let mut table = String::new();
        for row in rows {
            let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}")).collect();
            writeln!(table, "  [ {} ]", cells.join("   ")).expect("writing to a string");
        }
        Some(table)
    }

    /// One line per step and per entry that is not zero; of a symmetric matrix the upper half.
    fn lines(&self, title: String, formulas: &Formulas) -> String {
        let symmetric = self.is_symmetric();
        let mut entries = Vec::new();
        let mut zeros = 0;
        for i in 0..self.rows {
            for j in if symmetric { i } else { 0 }..self.columns {
                match formulas.entries[i * self.columns + j].as_str() {
                    "0" => zeros += 1,
                    formula => entries.push((self.entry_name(i, j), formula)),
                }
            }
        }
        let mut text = title;
        text.push_str(match (symmetric, zeros, entries.is_empty()) {
            (_, _, true) => ", all 0",
            (true, 0, _) => ", symmetric",
            (true, _, _) => ", symmetric, other entries 0",
            (false, 0, _) => "",
            (false, _, _) => ", other entries 0",
        });
        text.push('\n');
        let steps = formulas.steps.iter().map(|(name, formula)| (name.clone(), formula.as_str()));
        text + &named(steps.chain(entries).collect())
    }
}

/// Formulas with their names, a line each or, where they are long, several.
fn named(all: Vec<(String, &str)>) -> String {
    let width = all.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let indent = width + 5;
    let mut text = String::new();
    for (name, formula) in all {
        let pieces = broken(formula, Notation::Text, WIDTH.saturating_sub(indent));
        let separator = format!("\n{:indent$}", "");
        writeln!(text, "  {name:<width$} = {}", pieces.join(&separator)).expect("writing to a string");
    }
    text
}
