//! Every quantity of an arm as people read it: plain text, LaTeX, JSON.
//!
//! A quantity is one matrix; a vector has one column, a scalar one entry, and each link frame is one matrix. It has up to three
//! forms. In the closed form the entries are sums of sines and cosines of integer combinations of the joint angles. It exists if
//! no entry needs a reciprocal or more than 300 terms.
//!
//! ```text
//! b11 = 10*cos(q2) + 10763/500
//! ```
//!
//! The other forms are numbered steps; each step uses only earlier steps. They write out the plain recursion over the links,
//! and the recursion with the savings of the emitted function. By default a closed form that fits a table is shown, else the form
//! with the fewest characters. No term is ever left out.
//!
//! ```text
//! show.rs         sheets of quantities
//! show/item.rs    items by name
//! show/derived.rs its entries, derived
//! show/forms.rs   its matrices, each in a form
//! show/steps.rs   an expression as numbered steps
//! show/lines.rs   long formulas in several lines
//! show/minors.rs  the minors of a Jacobian that is not square, without shared factors
//! show/json.rs    for programs
//! show/text.rs    for a terminal
//! show/latex.rs   for a paper
//! ```

mod derived;
mod forms;
mod item;
mod json;
mod latex;
mod lines;
mod minors;
mod steps;
mod text;

use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

pub use derived::ASK_THE_PAGE;
pub use item::Item;

use crate::catalogue::Absent;
use crate::derive::derivation::Derivation;
use crate::derive::determinant::minors::Product;
use crate::derive::determinant::{Factor, Zeros};
use crate::exact::Number;
use crate::parallel::parallel_map;
use crate::ring::field::computed::ComputedAngles;
use crate::ring::normal_form::NormalForm;
use crate::ring::print::{Notation, Printer};
use crate::Model;

/// Numbers or names for the parameters of the description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The values of the description.
    Nominal,
    /// The names under `parameters`, where they enter linearly, by products or by powers.
    Symbolic,
}

/// Which of the forms of a quantity is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// The closed form where it fits a table; else the one with the fewest characters.
    #[default]
    Shortest,
    /// The closed form if it exists, whatever its length; else steps.
    Closed,
    /// Numbered steps.
    Steps,
}

/// How quantities are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Which form.
    pub form: Form,
    /// Constants as decimals with this many digits, 1 to 17; `None` for exact constants.
    pub digits: Option<u8>,
}

/// Quantities of one arm.
#[derive(Clone)]
pub struct Sheet {
    /// Name of the robot.
    pub robot: String,
    /// The quantities, in the order of the emitted module.
    pub quantities: Vec<Shown>,
    /// Functions that the arm does not have.
    pub absent: Vec<Absent>,
}

/// One matrix.
#[derive(Clone)]
pub struct Shown {
    /// Name of the emitted function, with a number for the frame of a link.
    pub name: String,
    /// Symbol in plain text and in LaTeX.
    pub symbol: [String; 2],
    /// Letter of an entry in plain text and in LaTeX.
    pub letter: [&'static str; 2],
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Names of the columns, where they have their own.
    pub column_names: Option<Vec<String>>,
    /// The entries, row by row.
    pub content: Content,
    /// Names of the symbols [`Symbol::Parameter`](crate::ring::Symbol::Parameter), by index.
    pub parameters: Vec<String>,
    /// Velocities of the joints' friction; 1 where it has no velocity.
    pub velocities: Vec<Number>,
    /// Angles that functions compute.
    pub computed: Option<Arc<ComputedAngles>>,
    /// For the determinant, its factors and where each is zero; for minors, the factors that they share.
    pub factors: Option<Vec<Factor>>,
    /// Digits of constants; none: exactly.
    pub digits: Option<u8>,
    /// The entries in plain text, computed at the first use.
    text: OnceLock<Formulas>,
}

/// The entries of a quantity.
#[derive(Clone)]
pub enum Content {
    /// Each a sum of harmonics.
    Closed(Vec<NormalForm>),
    /// Expressions that share steps.
    Program(Box<Derivation>),
    /// The minors of the task Jacobian without their common factors.
    Minors(Vec<Product>),
}

/// The entries of a quantity in one notation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formulas {
    /// Name and formula of each step; none for closed forms.
    pub steps: Vec<(String, String)>,
    /// Entries, row by row.
    pub entries: Vec<String>,
}

impl Sheet {
    /// The requested quantities, each once, in the order of the request, in their shortest form with exact constants.
    pub fn new(model: &Model, items: &[Item], reading: Reading) -> Sheet {
        Sheet::in_style(model, items, reading, Style::default())
    }

    /// The same in another style.
    pub fn in_style(model: &Model, items: &[Item], reading: Reading, style: Style) -> Sheet {
        let all = parallel_map(items, |&item| Ok(derived::derived(model, item, reading)?.shown(model, item, style)));
        Sheet::of(model, items, all)
    }

    /// With the numbers of the description, and what holds names of its parameters with these.
    pub fn in_both_readings(model: &Model, items: &[Item], style: Style) -> [Sheet; 2] {
        let nominal = Sheet::in_style(model, items, Reading::Nominal, style);
        if model.manipulator.parameters.is_empty() {
            let symbolic = Sheet { quantities: Vec::new(), ..nominal.clone() };
            return [nominal, symbolic];
        }
        let named = parallel_map(items, |&item| {
            let derived = derived::derived(model, item, Reading::Symbolic)?;
            let named = derived.derivation.pool.has_parameters(&derived.derivation.entries);
            Ok(if named { derived.shown(model, item, style) } else { Vec::new() })
        });
        [nominal, Sheet::of(model, items, named)]
    }

    /// The sheet of the result for each item, or of the reason why it is missing.
    fn of(model: &Model, items: &[Item], all: Vec<Result<Vec<Shown>, String>>) -> Sheet {
        let mut seen = BTreeSet::new();
        let mut sheet = Sheet { robot: model.manipulator.name.clone(), quantities: Vec::new(), absent: Vec::new() };
        let everything = items == Item::all(&model.manipulator.tips);
        for (item, shown) in items.iter().zip(all) {
            match shown {
                Ok(all) => sheet.quantities.extend(all.into_iter().filter(|shown| seen.insert(shown.name.clone()))),
                Err(_) if everything && !item.said_missing() => {}
                Err(reason) => sheet.absent.push(Absent { function: item.name(), reason }),
            }
        }
        sheet.absent.dedup();
        sheet
    }
}

impl Shown {
    /// Whether the entries are closed forms.
    pub fn is_closed(&self) -> bool {
        !matches!(self.content, Content::Program(_))
    }

    /// The minors of the task Jacobian without their common factors, where they are shown.
    fn minors(&self) -> Option<&[Product]> {
        if let Content::Minors(left) = &self.content {
            Some(left)
        } else {
            None
        }
    }

    fn printer(&self, notation: Notation) -> Printer<'_> {
        let computed = self.computed.as_deref();
        Printer { notation, parameters: &self.parameters, velocities: &self.velocities, computed, digits: self.digits }
    }

    /// Whether it is a matrix of closed forms that fits a table.
    fn is_table(&self) -> bool {
        self.table(self.plain_text()).is_some()
    }

    /// Number of characters of the steps and the entries without spaces; for a symmetric matrix only the upper half counts.
    fn length(&self) -> usize {
        let Formulas { steps, entries } = self.plain_text();
        let symmetric = self.is_symmetric();
        let shown = |k: &usize| !symmetric || k / self.columns <= k % self.columns;
        let entries = (0..entries.len()).filter(shown).map(|k| entries[k].as_str()).filter(|entry| *entry != "0");
        // A name and an equals sign surround a formula.
        let count = |text: &str| text.chars().filter(|c| *c != ' ').count();
        steps.iter().map(|(name, formula)| name.len() + count(formula) + 5).chain(entries.map(|entry| count(entry) + 8)).sum()
    }

    /// The same with the content that is the shortest, the first of equals.
    fn with_shortest(self, contents: impl IntoIterator<Item = Content>) -> Shown {
        let all = contents.into_iter().map(|content| Shown { content, text: OnceLock::new(), ..self.clone() });
        all.min_by_key(Shown::length).unwrap_or(self)
    }

    /// The entries as formulas in plain text.
    fn plain_text(&self) -> &Formulas {
        self.text.get_or_init(|| self.formulas(Notation::Text))
    }

    /// The entries as formulas.
    pub fn formulas(&self, notation: Notation) -> Formulas {
        let printer = self.printer(notation);
        match &self.content {
            Content::Closed(forms) => {
                Formulas { steps: Vec::new(), entries: forms.iter().map(|form| printer.form(form)).collect() }
            }
            Content::Minors(left) => {
                Formulas { steps: Vec::new(), entries: left.iter().map(|product| minors::formula(product, &printer)).collect() }
            }
            Content::Program(derivation) => steps::formulas(derivation, &printer, &self.step_letter()),
        }
    }

    /// The factors of the determinant in one notation, and where each is zero.
    pub fn factors(&self, notation: Notation) -> Option<Vec<(String, &Zeros)>> {
        let printer = self.printer(notation);
        let factors = self.factors.as_ref()?;
        Some(factors.iter().map(|factor| (printer.form(&factor.form), &factor.zeros)).collect())
    }

    /// Whether this is a square matrix equal to its transpose.
    fn is_symmetric(&self) -> bool {
        let at = |i: usize, j: usize| i * self.columns + j;
        let equal = |a: usize, b: usize| match &self.content {
            Content::Closed(forms) => forms[a] == forms[b],
            Content::Minors(left) => left[a] == left[b],
            Content::Program(derivation) => derivation.entries[a] == derivation.entries[b],
        };
        self.rows > 1 && self.rows == self.columns && (0..self.rows).all(|i| (0..i).all(|j| equal(at(i, j), at(j, i))))
    }

    /// A letter for steps: not that of the entries, and none that makes the name of a parameter, with an index in LaTeX or without.
    fn step_letter(&self) -> String {
        let taken = |letter: &str| {
            let index = |rest: &str| is_number(rest.strip_prefix('_').unwrap_or(rest));
            self.letter.contains(&letter) || self.parameters.iter().any(|name| name.strip_prefix(letter).is_some_and(index))
        };
        let mut letters = ["t", "z"].map(String::from).into_iter().chain((4..).map(|length| format!("{:_<length$}", "step")));
        letters.find(|letter| !taken(letter)).expect("a longer one is free")
    }

    /// Whether a parameter is called as an entry with this letter would be.
    fn is_entry_of(&self, letter: &str) -> impl Fn(&String) -> bool + use<'_> {
        let letter = letter.to_owned();
        let index = |rest: &str| match (self.rows, self.columns) {
            (1, 1) => rest.is_empty(),
            (_, 1) => is_number(rest),
            (rows, columns) if rows < 10 && columns < 10 => is_number(rest) && rest.len() == 2,
            _ => rest.split_once('_').is_some_and(|(row, column)| is_number(row) && is_number(column)),
        };
        move |name| name.strip_prefix(letter.as_str()).is_some_and(index)
    }

    /// The letter of the entries in plain text, with underscores after it where a parameter is called as an entry would be.
    fn entry_letter(&self) -> String {
        let mut letter = self.letter[0].to_owned();
        while self.parameters.iter().any(self.is_entry_of(&letter)) {
            letter.push('_');
        }
        letter
    }

    /// The name of an entry in plain text: `b12`, `g3`, `y[1, m_l1]`, `T`.
    fn entry_name(&self, row: usize, column: usize) -> String {
        let letter = self.entry_letter();
        match (&self.column_names, self.rows, self.columns) {
            (Some(names), ..) => format!("{letter}[{}, {}]", row + 1, names[column]),
            (None, 1, 1) => letter,
            (None, _, 1) => format!("{letter}{}", row + 1),
            (None, rows, columns) if rows < 10 && columns < 10 => format!("{letter}{}{}", row + 1, column + 1),
            _ => format!("{letter}{}_{}", row + 1, column + 1),
        }
    }
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit())
}

#[cfg(test)]
mod tests;
