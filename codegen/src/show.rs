//! Every quantity of an arm as people read it: plain text, LaTeX, JSON.
//!
//! A quantity is one matrix; a vector has one column, a scalar one entry, the frames of the links are one matrix each. It has up to three
//! forms: the closed form, whose entries are sums of sines and cosines of integer combinations of the joint angles, where no reciprocal
//! and no more than 300 terms stand in one,
//!
//! ```text
//! b11 = 10*cos(q2) + 10763/500
//! ```
//!
//! and numbered steps, each using earlier ones only, of the recursion over the links as it stands and with the operations saved that the
//! emitted function saves. A closed form that fits a table is shown as one, else the form with the fewest characters, unless another is
//! asked for. Nothing is ever left out.
//!
//! ```text
//! show.rs        which quantities, their derivations and forms
//! show/steps.rs  an expression as numbered steps
//! show/lines.rs  long formulas in several lines
//! show/minors.rs what is left of the minors of a Jacobian that is not square
//! show/json.rs   for programs
//! show/text.rs   for a terminal
//! show/latex.rs  for a paper
//! ```

mod json;
mod latex;
mod lines;
mod minors;
mod steps;
mod text;

use std::collections::BTreeSet;
use std::sync::OnceLock;

use armgen_algebra::optimise::optimise;

use crate::catalogue::quantities::regressor::{KNOWN_TORQUE, REGRESSOR};
use crate::catalogue::{self, Absent, Length, Quantity, ResultPart, Typeset};
use crate::derive::arm::Arm;
use crate::derive::derivation::{Derivation, CLOSED_FORM_TERMS};
use crate::derive::newton_euler::{inverse_dynamics, Motion};
use crate::derive::parameters::{ParameterKind, View};
use crate::derive::regressor::{derivative_by_parameter, regressor};
use crate::derive::{
    self,
    determinant::minors::{minors, NoMinors, Product},
    determinant::{Factor, Zeros},
};
use crate::exact::Number;
use crate::parallel::parallel_map;
use crate::ring::normal_form::NormalForm;
use crate::ring::print::{Notation, Printer};
use crate::ring::{AngleSum, ExprId, Pool, Symbol};
use crate::Model;

/// What can be asked for by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Item {
    /// A function of the emitted module.
    Plain(&'static Quantity),
    /// Its form with the parameters as arguments.
    With(&'static Quantity),
    /// Of a function that returns a list of matrices one of these, by index: the frame of a link.
    Element(&'static Quantity, usize),
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

/// Which of the forms of a quantity is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// The closed form where it fits a table; else the one with the fewest characters.
    #[default]
    Shortest,
    /// The closed form where there is one, whatever its length; else steps.
    Closed,
    /// Numbered steps.
    Steps,
}

/// How quantities are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Which form.
    pub form: Form,
    /// Constants as decimals of so many digits, 1 to 17; none: exactly.
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
    /// What the columns stand for, where they have names of their own.
    pub column_names: Option<Vec<String>>,
    /// The entries, row by row.
    pub content: Content,
    /// Names of the symbols [`Symbol::Parameter`], by index.
    pub parameters: Vec<String>,
    /// Stribeck velocities of the joints; 1 where there is no such friction.
    pub velocities: Vec<Number>,
    /// Of the determinant: its factors, and where each is zero; of minors the factors that they share.
    pub factors: Option<Vec<Factor>>,
    /// Digits of constants; none: exactly.
    pub digits: Option<u8>,
    /// The entries in plain text, once they have been asked for.
    text: OnceLock<Formulas>,
}

/// The entries of a quantity.
#[derive(Clone)]
pub enum Content {
    /// Each a sum of harmonics.
    Closed(Vec<NormalForm>),
    /// Expressions that share steps.
    Program(Box<Derivation>),
    /// What is left of the minors of the task Jacobian once the factors that they share are taken out.
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

impl Item {
    /// All that is shown where nothing is asked for: every function but those that only gather others, and the determinant.
    pub fn all() -> Vec<Item> {
        let functions = catalogue::quantities().filter(|quantity| quantity.gathers.is_empty()).map(Item::Plain);
        functions.chain([Item::Determinant]).collect()
    }

    /// Whether it is said of an arm that lacks it, asked or not.
    fn said_missing(self) -> bool {
        match self {
            Item::Plain(quantity) | Item::Element(quantity, _) | Item::With(quantity) => quantity.documentation.said_missing,
            Item::Determinant => true,
        }
    }

    /// What a name stands for; nothing if it is no name of a quantity of an arm with `dof` joints.
    pub fn named(name: &str, dof: usize) -> Vec<Item> {
        if name == DETERMINANT {
            return vec![Item::Determinant];
        }
        let element = |quantity: &'static Quantity| {
            let number = name.strip_prefix(element_of(quantity)?.name)?.strip_prefix('_')?.parse::<usize>().ok()?;
            (1..=dof).contains(&number).then(|| Item::Element(quantity, number - 1))
        };
        if let Some(item) = catalogue::quantities().find_map(element) {
            return vec![item];
        }
        let Some((quantity, with)) = catalogue::named(name) else { return Vec::new() };
        let parts = if quantity.gathers.is_empty() { &[quantity][..] } else { quantity.gathers };
        parts.iter().map(|&quantity| if with { Item::With(quantity) } else { Item::Plain(quantity) }).collect()
    }

    /// Every name that [`Item::named`] knows, but those of single matrices of a list.
    pub fn names() -> Vec<String> {
        let forms = [false, true].into_iter().flat_map(|with| catalogue::functions().filter(move |(_, form)| *form == with));
        forms.map(|(quantity, with)| quantity.function_name(with)).chain([DETERMINANT.to_string()]).collect()
    }

    /// What the names of single matrices of a list begin with, before an underscore and a number from 1 to that of the joints.
    pub fn lists() -> Vec<&'static str> {
        catalogue::quantities().filter_map(element_of).map(|element| element.name).collect()
    }

    fn name(self) -> String {
        match self {
            Item::Plain(quantity) => quantity.name.into(),
            Item::With(quantity) => quantity.function_name(true),
            Item::Element(quantity, i) => format!("{}_{}", element_of(quantity).map_or(quantity.name, |of| of.name), i + 1),
            Item::Determinant => DETERMINANT.into(),
        }
    }
}

/// One matrix of a function that returns a list of them.
fn element_of(quantity: &Quantity) -> Option<catalogue::Element> {
    quantity.result.iter().find_map(|part| part.element)
}

impl Sheet {
    /// The quantities asked for, each once, in the order of asking: each in its shortest form, with exact constants.
    pub fn new(model: &Model, items: &[Item], reading: Reading) -> Sheet {
        Sheet::in_style(model, items, reading, Style::default())
    }

    /// The same in another style.
    pub fn in_style(model: &Model, items: &[Item], reading: Reading, style: Style) -> Sheet {
        let all = parallel_map(items, |&item| Ok(derived(model, item, reading)?.shown(model, item, style)));
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
            let derived = derived(model, item, Reading::Symbolic)?;
            let named = derived.derivation.pool.has_parameters(&derived.derivation.entries);
            Ok(if named { derived.shown(model, item, style) } else { Vec::new() })
        });
        [nominal, Sheet::of(model, items, named)]
    }

    /// Of what was found for each item, or why there is none of it.
    fn of(model: &Model, items: &[Item], all: Vec<Result<Vec<Shown>, String>>) -> Sheet {
        let mut seen = BTreeSet::new();
        let mut sheet = Sheet { robot: model.manipulator.name.clone(), quantities: Vec::new(), absent: Vec::new() };
        let everything = items == Item::all();
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

    /// What is left of the minors of the task Jacobian, where these are shown.
    fn minors(&self) -> Option<&[Product]> {
        if let Content::Minors(left) = &self.content {
            Some(left)
        } else {
            None
        }
    }

    fn printer(&self, notation: Notation) -> Printer<'_> {
        Printer { notation, parameters: &self.parameters, velocities: &self.velocities, digits: self.digits }
    }

    /// Whether it is a matrix of closed forms that fits a table.
    fn is_table(&self) -> bool {
        self.table(self.plain_text()).is_some()
    }

    /// How many characters the steps and the entries take, spaces apart; of a symmetric matrix those of the upper half.
    fn length(&self) -> usize {
        let Formulas { steps, entries } = self.plain_text();
        let symmetric = self.is_symmetric();
        let shown = |k: &usize| !symmetric || k / self.columns <= k % self.columns;
        let entries = (0..entries.len()).filter(shown).map(|k| entries[k].as_str()).filter(|entry| *entry != "0");
        // What stands around a formula is a name and an equals sign.
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

/// What is shown of an item, before it has a form.
struct Derived {
    derivation: Derivation,
    /// Of the determinant.
    factored: Option<Factored>,
}

/// The determinant of the task Jacobian, or its minors.
enum Factored {
    /// Its closed form where it is short, and its factors.
    Determinant(Option<NormalForm>, Vec<Factor>),
    /// The factors that all minors share, and what is left of each.
    Minors(Vec<Factor>, Vec<Product>),
}

/// The entries of an item, or why there is none.
fn derived(model: &Model, item: Item, reading: Reading) -> Result<Derived, String> {
    let view = match (item, reading) {
        (Item::With(_), _) => View::Vector(&model.parameters),
        (_, Reading::Nominal) => View::Nominal,
        (_, Reading::Symbolic) => View::Symbolic,
    };
    let (quantity, with) = match item {
        Item::Determinant => {
            let of = |pool, entries| Derivation { pool, entries, method: "minors", parallel: Vec::new() };
            return Ok(match derive::determinant::determinant(model, view) {
                Some(found) => {
                    let closed = found.form.filter(|form| form.len() <= CLOSED_FORM_TERMS);
                    let factored = Factored::Determinant(closed, found.factors);
                    Derived { derivation: of(found.pool, vec![found.value]), factored: Some(factored) }
                }
                None => {
                    let found = minors(model, view).map_err(|why| no_minors(model, &why))?;
                    let factored = Factored::Minors(found.common, found.left);
                    Derived { derivation: of(found.pool, found.values), factored: Some(factored) }
                }
            });
        }
        Item::Plain(quantity) | Item::Element(quantity, _) => (quantity, false),
        Item::With(quantity) => (quantity, true),
    };
    (quantity.missing)(model, with).map_or(Ok(()), Err)?;
    let plain = matches!(item, Item::Plain(_));
    let of_names = plain && [&REGRESSOR, &KNOWN_TORQUE].contains(&quantity) && reading == Reading::Symbolic;
    let derivation = if of_names { symbolic_regressor(model, quantity) } else { None };
    Ok(Derived { derivation: derivation.unwrap_or_else(|| quantity.by_recursion(model, view)), factored: None })
}

impl Derived {
    /// The matrices of the item that it was derived for.
    fn shown(self, model: &Model, item: Item, style: Style) -> Vec<Shown> {
        let parameters = match item {
            Item::With(_) => model.parameters.entries.iter().map(|entry| entry.name.clone()).collect(),
            _ => model.manipulator.parameters.iter().map(|parameter| parameter.name.clone()).collect(),
        };
        let names = Names { parameters, style };
        match item {
            Item::Determinant => vec![determinant(model, self, &names)],
            Item::Plain(quantity) => parts(model, quantity, quantity.name, self.derivation, &names),
            Item::Element(quantity, i) => {
                let all = parts(model, quantity, quantity.name, self.derivation, &names);
                all.into_iter().skip(i).take(1).collect()
            }
            Item::With(quantity) => parts(model, quantity, &quantity.function_name(true), self.derivation, &names),
        }
    }
}

/// What symbols are called, and how quantities are shown.
struct Names {
    parameters: Vec<String>,
    style: Style,
}

/// The matrices of a quantity: of each part of its result, or of each element of a list.
fn parts(model: &Model, quantity: &Quantity, name: &str, derivation: Derivation, names: &Names) -> Vec<Shown> {
    let sizes = model.sizes();
    let all_entries = derivation.entries.clone();
    let mut entries = all_entries.as_slice();
    let mut all = Vec::new();
    let of = |entries: &[ExprId]| Derivation { entries: entries.to_vec(), ..derivation.clone() };
    for part in quantity.result {
        let (own, rest) = entries.split_at(part.len(&sizes));
        entries = rest;
        match part.element {
            Some(element) => {
                let size = part.rows().of(&sizes) * part.columns().of(&sizes);
                all.extend(own.chunks(size).enumerate().map(|(i, entries)| {
                    let i = i + 1;
                    let symbol = [format!("{}_{i}(q)", element.letter), format!("{}_{{{i}}}(q)", element.letter)];
                    matrix(model, part, format!("{}_{i}", element.name), symbol, of(entries), names)
                }));
            }
            None => {
                let Typeset { text, latex } = part.symbol;
                let name = if part.name == ResultPart::RESULT { name.to_owned() } else { format!("{name}_{}", part.name) };
                all.push(matrix(model, part, name, [text.into(), latex.into()], of(own), names));
            }
        }
    }
    all
}

/// The determinant with its factors, its closed form if that is not too long; or the minors with those that they share.
fn determinant(model: &Model, derived: Derived, names: &Names) -> Shown {
    let shown = |symbol: [&str; 2], letter, rows, factors: Vec<Factor>| Shown {
        name: DETERMINANT.into(),
        symbol: symbol.map(String::from),
        letter,
        rows,
        columns: 1,
        column_names: None,
        factors: (!factors.is_empty()).then_some(factors),
        content: Content::Closed(Vec::new()),
        parameters: names.parameters.clone(),
        velocities: model.manipulator.stribeck_velocities(),
        digits: names.style.digits,
        text: OnceLock::new(),
    };
    let of_determinant = |factors| shown(["det J(q)", "\\det J(q)"], ["det J", "\\det J"], 1, factors);
    match derived.factored {
        Some(Factored::Minors(common, left)) => {
            Shown { content: Content::Minors(left.clone()), ..shown(["d(q)"; 2], ["d"; 2], left.len(), common) }
        }
        Some(Factored::Determinant(closed, factors)) => {
            in_form(of_determinant(factors), closed.map(|form| vec![form]), derived.derivation, names.style.form)
        }
        None => in_form(of_determinant(Vec::new()), None, derived.derivation, names.style.form),
    }
}

/// Where a reader sees whether a posture is singular if no formula says so.
pub const ASK_THE_PAGE: &str =
    "`armgen page ROBOT.yaml --out robot.html` shows w = sqrt(det(J J')) at any posture, 0 where J loses rank";

/// Why there are no minors, and what to do instead.
fn no_minors(model: &Model, why: &NoMinors) -> String {
    let (rows, joints) = (model.manipulator.task.len(), model.manipulator.dof());
    let number = |n: usize, of: &str| format!("{n} {of}{}", if n == 1 { "" } else { "s" });
    let (rows, joints) = (number(rows, "row"), number(joints, "joint"));
    let head = format!("the task has {rows} and the arm {joints}: ");
    const FEWER: &str = "name fewer rows under `task`";
    match why {
        NoMinors::NotRedundant | NoMinors::AllZero => format!("{head}its Jacobian never has as many independent rows; {FEWER}"),
        NoMinors::TooMany => format!("{head}its Jacobian is not square; {ASK_THE_PAGE}"),
        NoMinors::TooLong(common) if common.is_empty() => {
            format!("{head}the minors of its Jacobian are too long; {ASK_THE_PAGE}")
        }
        NoMinors::TooLong(common) => {
            let parameters: Vec<String> = model.manipulator.parameters.iter().map(|parameter| parameter.name.clone()).collect();
            let printer = Printer { notation: Notation::Text, parameters: &parameters, velocities: &[], digits: None };
            let factor = |factor: &Factor| format!("{} is {}", printer.form(&factor.form), factor.zeros.sentence());
            let common = common.iter().map(factor).collect::<Vec<_>>().join(", ");
            format!("{head}its Jacobian loses rank where a factor of all its minors is 0 ({common}); what is left of these is too long; {ASK_THE_PAGE}")
        }
    }
}

fn matrix(model: &Model, part: &ResultPart, name: String, symbol: [String; 2], derivation: Derivation, names: &Names) -> Shown {
    let sizes = model.sizes();
    let columns_of = match part.columns() {
        Length::Parameters => Some(&model.parameters),
        Length::BaseParameters => Some(model.base_parameters()),
        _ => None,
    };
    let closed = if names.style.form == Form::Steps { None } else { derivation.closed_forms() };
    let shown = Shown {
        name,
        symbol,
        letter: [part.letter.text, part.letter.latex],
        rows: part.rows().of(&sizes),
        columns: part.columns().of(&sizes),
        column_names: columns_of.map(|vector| vector.entries.iter().map(|entry| entry.name.clone()).collect()),
        content: Content::Closed(Vec::new()),
        parameters: names.parameters.clone(),
        velocities: model.manipulator.stribeck_velocities(),
        factors: None,
        digits: names.style.digits,
        text: OnceLock::new(),
    };
    in_form(shown, closed, derivation, names.style.form)
}

/// The quantity with its content in a form.
fn in_form(shown: Shown, closed: Option<Vec<NormalForm>>, derivation: Derivation, form: Form) -> Shown {
    let closed = closed.filter(|_| form != Form::Steps).map(Content::Closed);
    let closed = match closed {
        Some(content) if form == Form::Closed => return Shown { content, ..shown },
        Some(content) => {
            let shown = Shown { content, ..shown.clone() };
            if shown.is_table() {
                return shown;
            }
            Some(shown.content)
        }
        None => None,
    };
    let derivation = without_turn(derivation);
    let (pool, entries) = optimise(&derivation.pool, &derivation.entries, &derivation.parallel, &[]);
    let fewer = Derivation { pool, entries, method: derivation.method, parallel: derivation.parallel.clone() };
    let steps = [derivation, fewer].map(|derivation| Content::Program(Box::new(derivation)));
    shown.with_shortest(closed.into_iter().chain(steps))
}

/// The same without the constant angle that the last link may be rotated by: its sine and cosine are constants that people can read.
fn without_turn(derivation: Derivation) -> Derivation {
    let Some(turn) = derivation.pool.field().turn().cloned() else { return derivation };
    let mut pool = Pool::new(derivation.pool.field().clone());
    let entries = derivation.pool.substitute_into(&mut pool, &derivation.entries, &|pool, symbol| {
        let plain = |sum: AngleSum| AngleSum { turned: false, ..sum };
        let (sum, is_sine) = match symbol {
            Symbol::SineOf(sum) if sum.turned => (plain(sum), true),
            Symbol::CosineOf(sum) if sum.turned => (plain(sum), false),
            _ => return pool.symbol(symbol),
        };
        let (s, c) = (pool.symbol(Symbol::SineOf(sum)), pool.symbol(Symbol::CosineOf(sum)));
        let (sine, cosine) = (pool.constant(&turn.sine), pool.constant(&turn.cosine));
        let (first, second) =
            if is_sine { (pool.mul(s, cosine), pool.mul(c, sine)) } else { (pool.mul(c, cosine), -pool.mul(s, sine)) };
        pool.add(first, second)
    });
    Derivation { pool, entries, ..derivation }
}

/// Y or the known rest with all names of the description as symbols: Y_k = ∂tau/∂name_k, and the rest is tau - Y pi.
///
/// None where the rest of a base parameter set is asked for: its combinations hold the description's numbers.
fn symbolic_regressor(model: &Model, quantity: &Quantity) -> Option<Derivation> {
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
        ParameterKind::Base(_) if *quantity == REGRESSOR => (regressor(&mut pool, &arm, vector), Vec::new()),
        ParameterKind::Base(_) => return None,
    };
    let entries = if *quantity == REGRESSOR {
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

#[cfg(test)]
mod tests;
