//! Every quantity of an arm as people read it: plain text, LaTeX, JSON.
//!
//! A quantity is one matrix; a vector has one column, a scalar one entry, the frames of the links are one matrix each. Its entries are
//! closed forms, sums of sines and cosines of integer combinations of the joint angles, wherever these stay short:
//!
//! ```text
//! b11 = 10*cos(q2) + 10763/500
//! ```
//!
//! A quantity with an entry that is too long, or with a reciprocal as in forward dynamics, is shown as numbered steps instead, each using
//! earlier ones only. Nothing is ever left out.
//!
//! ```text
//! show.rs        which quantities, and their derivations
//! show/steps.rs  an expression as numbered steps
//! show/json.rs   for programs
//! show/text.rs   for a terminal
//! show/latex.rs  for a paper
//! ```

mod json;
mod latex;
mod steps;
mod text;

use std::collections::BTreeSet;

use crate::derive::arm::Arm;
use crate::derive::newton_euler::{inverse_dynamics, Motion};
use crate::derive::parameters::{ParameterKind, View};
use crate::derive::regressor::{derivative_by_parameter, regressor};
use crate::derive::{self, determinant::Factor};
use crate::equations::{Derivation, Quantity, Shape, CLOSED_FORM_TERMS};
use crate::ring::normal_form::NormalForm;
use crate::ring::print::{Notation, Printer};
use crate::ring::{ExprId, Pool, Symbol};
use crate::Model;

/// What can be asked for by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Item {
    /// A function of the emitted module.
    Plain(Quantity),
    /// Its form with the parameters as arguments.
    With(Quantity),
    /// The frame of one link, by index.
    LinkFrame(usize),
    /// The determinant of the task Jacobian.
    Determinant,
}

/// The name of the determinant of the task Jacobian, which is no emitted function.
const DETERMINANT: &str = "determinant";

/// Numbers or names for the parameters of the description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The values of the description.
    Nominal,
    /// The names under `parameters`, where they enter linearly, by products or by powers.
    Symbolic,
}

/// Quantities of one arm.
#[derive(Clone)]
pub struct Sheet {
    /// Name of the robot.
    pub robot: String,
    /// The quantities, in the order of the emitted module.
    pub quantities: Vec<Shown>,
    /// What there is not, and why.
    pub absent: Vec<(String, String)>,
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
    /// What the columns stand for, where they have names of their own.
    pub column_names: Option<Vec<String>>,
    /// The entries, row by row.
    pub content: Content,
    /// Names of the symbols [`Symbol::Parameter`], by index.
    pub parameters: Vec<String>,
    /// Of the determinant: its factors, and where each is zero.
    pub factors: Option<Vec<Factor>>,
}

/// The entries of a quantity.
#[derive(Clone)]
pub enum Content {
    /// Each a sum of waves.
    Closed(Vec<NormalForm>),
    /// Expressions that share steps.
    Program(Box<Derivation>),
}

/// The entries of a quantity in one notation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formulas {
    /// Name and formula of each step; none for closed forms.
    pub steps: Vec<(String, String)>,
    /// Entries, row by row.
    pub entries: Vec<String>,
}

impl Item {
    /// All that is shown where nothing is asked for: every function but `equations_of_motion`, which only gathers three others, and the
    /// determinant.
    pub fn all() -> Vec<Item> {
        let functions = Quantity::ALL.iter().filter(|q| **q != Quantity::EquationsOfMotion).map(|&q| Item::Plain(q));
        functions.chain([Item::Determinant]).collect()
    }

    /// What a name stands for; nothing if it is no name of a quantity of an arm with `dof` joints.
    pub fn named(name: &str, dof: usize) -> Vec<Item> {
        if name == DETERMINANT {
            return vec![Item::Determinant];
        }
        if let Some(number) = name.strip_prefix("link_frame_").and_then(|n| n.parse::<usize>().ok()) {
            return if (1..=dof).contains(&number) { vec![Item::LinkFrame(number - 1)] } else { Vec::new() };
        }
        let (plain, with) = name.strip_suffix("_with").map_or((name, false), |plain| (plain, true));
        let Some(&quantity) = Quantity::ALL.iter().find(|q| q.name() == plain && (!with || q.has_parameters())) else {
            return Vec::new();
        };
        let parts: &[Quantity] = match &quantity {
            Quantity::EquationsOfMotion => &[Quantity::InertiaMatrix, Quantity::CoriolisMatrix, Quantity::Gravity],
            other => std::slice::from_ref(other),
        };
        parts.iter().map(|&q| if with { Item::With(q) } else { Item::Plain(q) }).collect()
    }

    /// Every name that [`Item::named`] knows, but those of single frames.
    pub fn names() -> Vec<String> {
        let plain = Quantity::ALL.iter().map(|q| q.name().to_string());
        let with = Quantity::ALL.iter().filter(|q| q.has_parameters()).map(|q| format!("{}_with", q.name()));
        plain.chain(with).chain([DETERMINANT.to_string()]).collect()
    }
}

impl Item {
    fn name(self) -> String {
        match self {
            Item::Plain(quantity) => quantity.name().into(),
            Item::With(quantity) => format!("{}_with", quantity.name()),
            Item::LinkFrame(i) => format!("link_frame_{}", i + 1),
            Item::Determinant => DETERMINANT.into(),
        }
    }
}

impl Sheet {
    /// The quantities asked for, each once, in the order of asking.
    pub fn new(model: &Model, items: &[Item], reading: Reading) -> Sheet {
        let mut seen = BTreeSet::new();
        let mut sheet = Sheet { robot: model.manipulator.name.clone(), quantities: Vec::new(), absent: Vec::new() };
        for &item in items {
            match shown(model, item, reading) {
                Ok(all) => sheet.quantities.extend(all.into_iter().filter(|shown| seen.insert(shown.name.clone()))),
                Err(reason) => sheet.absent.push((item.name(), reason)),
            }
        }
        sheet.absent.dedup();
        sheet
    }
}

impl Shown {
    /// Whether the entries are closed forms.
    pub fn is_closed(&self) -> bool {
        matches!(self.content, Content::Closed(_))
    }

    /// The entries as formulas.
    pub fn formulas(&self, notation: Notation) -> Formulas {
        let printer = Printer { notation, parameters: &self.parameters };
        match &self.content {
            Content::Closed(forms) => {
                Formulas { steps: Vec::new(), entries: forms.iter().map(|form| printer.form(form)).collect() }
            }
            Content::Program(derivation) => steps::formulas(derivation, &printer, &self.step_letter()),
        }
    }

    /// The factors of the determinant in one notation, and where each is zero.
    pub fn factors(&self, notation: Notation) -> Option<Vec<(String, Option<String>)>> {
        let printer = Printer { notation, parameters: &self.parameters };
        let factors = self.factors.as_ref()?;
        Some(factors.iter().map(|factor| (printer.form(&factor.form), factor.singular.clone())).collect())
    }

    /// Whether this is a square matrix equal to its transpose.
    fn is_symmetric(&self) -> bool {
        let at = |i: usize, j: usize| i * self.columns + j;
        let equal = |a: usize, b: usize| match &self.content {
            Content::Closed(forms) => forms[a] == forms[b],
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

/// The matrices of an item, or why there is none.
fn shown(model: &Model, item: Item, reading: Reading) -> Result<Vec<Shown>, String> {
    let view = match (item, reading) {
        (Item::With(_), _) => View::Vector(&model.parameters),
        (_, Reading::Nominal) => View::Nominal,
        (_, Reading::Symbolic) => View::Symbolic,
    };
    let dof = model.manipulator.dof();
    Ok(match item {
        Item::Determinant => vec![determinant(model, view)?],
        Item::Plain(Quantity::LinkFrames) => {
            let derivation = Quantity::LinkFrames.by_recursion(model, view);
            (0..dof).map(|i| frame(model, &derivation, i)).collect()
        }
        Item::LinkFrame(i) => vec![frame(model, &Quantity::LinkFrames.by_recursion(model, view), i)],
        Item::Plain(quantity @ (Quantity::Regressor | Quantity::KnownTorque)) if reading == Reading::Symbolic => {
            let derivation = symbolic_regressor(model, quantity).unwrap_or_else(|| quantity.by_recursion(model, view));
            vec![matrix(model, quantity, quantity.name().into(), derivation)]
        }
        Item::Plain(quantity) if quantity.missing(model).is_some() => return Err(quantity.missing(model).unwrap_or_default()),
        Item::Plain(quantity @ (Quantity::InverseDynamicsDerivatives | Quantity::ForwardDynamicsDerivatives)) => {
            let derivation = quantity.by_recursion(model, view);
            derivatives(quantity)
                .iter()
                .zip(derivation.entries.chunks(dof * dof))
                .map(|((by, text, latex), entries)| {
                    let part = Derivation { entries: entries.to_vec(), ..derivation.clone() };
                    let mut shown = matrix(model, Quantity::InertiaMatrix, format!("{}_{by}", quantity.name()), part);
                    shown.symbol = [(*text).into(), (*latex).into()];
                    shown.letter = letter(quantity);
                    shown
                })
                .collect()
        }
        Item::Plain(quantity) => vec![matrix(model, quantity, quantity.name().into(), quantity.by_recursion(model, view))],
        Item::With(quantity) => {
            let mut shown = matrix(model, quantity, format!("{}_with", quantity.name()), quantity.by_recursion(model, view));
            shown.parameters = model.parameters.entries.iter().map(|entry| entry.name.clone()).collect();
            vec![shown]
        }
    })
}

/// The matrices of a quantity that has several: by what the derivative is, and its symbol in plain text and in LaTeX.
fn derivatives(quantity: Quantity) -> &'static [(&'static str, &'static str, &'static str)] {
    match quantity {
        Quantity::InverseDynamicsDerivatives => {
            &[("q", "dtau/dq", "\\partial\\tau/\\partial q"), ("dq", "dtau/d(dq)", "\\partial\\tau/\\partial\\dot q")]
        }
        Quantity::ForwardDynamicsDerivatives => &[
            ("q", "d(ddq)/dq", "\\partial\\ddot q/\\partial q"),
            ("dq", "d(ddq)/d(dq)", "\\partial\\ddot q/\\partial\\dot q"),
            ("tau", "B^-1", "B^{-1}"),
        ],
        _ => &[],
    }
}

/// The determinant with its factors; its closed form if that is not too long.
fn determinant(model: &Model, view: View<'_>) -> Result<Shown, String> {
    let found = derive::determinant::determinant(model, view)?;
    Ok(Shown {
        name: DETERMINANT.into(),
        symbol: ["det J(q)".into(), "\\det J(q)".into()],
        letter: ["det J", "\\det J"],
        rows: 1,
        columns: 1,
        column_names: None,
        factors: (!found.factors.is_empty()).then_some(found.factors),
        content: match found.form {
            Some(form) if form.len() <= CLOSED_FORM_TERMS => Content::Closed(vec![form]),
            _ => Content::Program(Box::new(Derivation {
                pool: found.pool,
                entries: vec![found.value],
                method: "minors",
                parallel: Vec::new(),
            })),
        },
        parameters: names(model),
    })
}

fn names(model: &Model) -> Vec<String> {
    model.manipulator.parameters.iter().map(|parameter| parameter.name.clone()).collect()
}

fn frame(model: &Model, frames: &Derivation, i: usize) -> Shown {
    let derivation = Derivation { entries: frames.entries[16 * i..16 * (i + 1)].to_vec(), ..frames.clone() };
    let mut shown = matrix(model, Quantity::LinkFrames, format!("link_frame_{}", i + 1), derivation);
    shown.symbol = [format!("T_{}(q)", i + 1), format!("T_{{{}}}(q)", i + 1)];
    shown
}

fn matrix(model: &Model, quantity: Quantity, name: String, derivation: Derivation) -> Shown {
    let (rows, columns) = quantity.shape().rows_columns(&model.sizes());
    debug_assert_eq!(derivation.entries.len(), rows * columns);
    let (text, latex) = quantity.symbol();
    Shown {
        name,
        symbol: [text.into(), latex.into()],
        letter: letter(quantity),
        rows,
        columns,
        column_names: match quantity.shape() {
            Shape::Regressor => Some(&model.parameters),
            Shape::BaseRegressor => Some(model.base_parameters()),
            _ => None,
        }
        .map(|vector| vector.entries.iter().map(|entry| entry.name.clone()).collect()),
        content: match derivation.closed_forms() {
            Some(forms) => Content::Closed(forms),
            None => Content::Program(Box::new(derivation)),
        },
        parameters: names(model),
        factors: None,
    }
}

/// Y or the known rest with all names of the description as symbols: Y_k = ∂tau/∂name_k, and the rest is tau - Y pi.
///
/// None where the rest of a base parameter set is asked for: its combinations hold the description's numbers.
fn symbolic_regressor(model: &Model, quantity: Quantity) -> Option<Derivation> {
    let (manipulator, vector) = (&model.manipulator, &model.parameters);
    let mut pool = Pool::new(model.field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Symbolic);
    let motion = Motion::with_reference(&mut pool, &arm);
    let (y, pi): (Vec<Vec<ExprId>>, Vec<ExprId>) = match &vector.kind {
        ParameterKind::Names(names) => {
            let tau = inverse_dynamics(&mut pool, &arm, &motion);
            let symbols: Vec<u16> = names.iter().map(|id| id.0 as u16).collect();
            let columns: Vec<_> = symbols.iter().map(|&k| derivative_by_parameter(&mut pool, &tau, k)).collect();
            let y = (0..arm.dof()).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
            (y, symbols.into_iter().map(|k| pool.symbol(Symbol::Parameter(k))).collect())
        }
        ParameterKind::Standard(all) => {
            let pi = all.iter().map(|&p| View::Symbolic.standard(&mut pool, manipulator, p)).collect();
            (regressor(&mut pool, &arm, vector), pi)
        }
        ParameterKind::Base(_) if quantity == Quantity::Regressor => (regressor(&mut pool, &arm, vector), Vec::new()),
        ParameterKind::Base(_) => return None,
    };
    let entries = if quantity == Quantity::Regressor {
        y.concat()
    } else {
        let tau = inverse_dynamics(&mut pool, &arm, &motion);
        tau.iter()
            .zip(&y)
            .map(|(&tau, row)| {
                let known = pool.dot(row, &pi);
                pool.sub(tau, known)
            })
            .collect()
    };
    Some(Derivation { pool, entries, method: "derivatives by the names", parallel: Vec::new() })
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit())
}

fn letter(quantity: Quantity) -> [&'static str; 2] {
    match quantity {
        Quantity::DirectKinematics | Quantity::LinkFrames => ["t", "t"],
        Quantity::GeometricJacobian => ["j", "j"],
        Quantity::GeometricJacobianDot => ["dj", "\\dot j"],
        Quantity::InertiaMatrix | Quantity::EquationsOfMotion => ["b", "b"],
        Quantity::CoriolisMatrix => ["c", "c"],
        Quantity::Gravity => ["g", "g"],
        Quantity::Friction => ["f", "f"],
        Quantity::InverseDynamics => ["tau", "\\tau"],
        Quantity::ForwardDynamics => ["ddq", "\\ddot q"],
        Quantity::Regressor => ["y", "y"],
        Quantity::KnownTorque => ["tau_known", "\\tau_0"],
        Quantity::KineticEnergy => ["T", "\\mathcal T"],
        Quantity::PotentialEnergy => ["U", "\\mathcal U"],
        Quantity::Momentum => ["p", "p"],
        Quantity::CoriolisTransposeTimes => ["c", "c"],
        Quantity::BaseRegressor => ["y_b", "y_b"],
        Quantity::OperationalInertia => ["b_a", "b_A"],
        Quantity::InverseDynamicsDerivatives => ["dtau", "\\partial\\tau"],
        Quantity::ForwardDynamicsDerivatives => ["dddq", "\\partial\\ddot q"],
    }
}

/// Breaks a formula in front of the plus and minus signs of its outermost sum, into pieces of at most `width` as `measure` counts it;
/// a single term may be longer.
fn break_sum(formula: &str, width: usize, measure: &dyn Fn(&str) -> usize) -> Vec<String> {
    let mut terms: Vec<&str> = Vec::new();
    let (mut depth, mut start) = (0i32, 0);
    for (at, c) in formula.char_indices() {
        match c {
            '(' | '{' | '[' => depth += 1,
            ')' | '}' | ']' => depth -= 1,
            ' ' if depth == 0 && (formula[at..].starts_with(" + ") || formula[at..].starts_with(" - ")) => {
                terms.push(&formula[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    terms.push(&formula[start..]);
    let mut lines: Vec<String> = Vec::new();
    for term in terms {
        match lines.last_mut() {
            Some(line) if measure(line) + 1 + measure(term) <= width => {
                line.push(' ');
                line.push_str(term);
            }
            _ => lines.push(term.to_string()),
        }
    }
    lines
}

#[cfg(test)]
mod tests;
