//! The lines of a function: named values, the angles of its sines, and the sums of its results.

use std::collections::BTreeMap;

use super::lines::Lines;
use super::place::Place;
use crate::read::reader::lexer::Fault;
use crate::values::check::Check;
use crate::values::enclosure::Float;
use crate::values::program::{Angle, Argument, Output, Program, Step};

/// Maximum number of steps and result entries in a module.
const MOST_STEPS: usize = 4_000_000;
/// Maximum depth of brackets.
const MOST_BRACKETS: usize = 16;
/// Significant characters of a name: in C 63 within a function (C99, 5.2.4.1), in MATLAB the first 63 (`namelengthmax`).
const LONGEST_NAME: usize = 63;

/// The name of a value: a letter, a digit, and digits, small letters and `_`.
fn is_value(word: &str) -> bool {
    let rest = word.strip_prefix(['s', 'c', 't', 'r']).unwrap_or("");
    (word.len() <= LONGEST_NAME || !Check::Long.is_made())
        && rest.starts_with(|c: char| c.is_ascii_digit())
        && rest.bytes().all(|b| b.is_ascii_digit() || b.is_ascii_lowercase() || b == b'_')
}

/// Checks that a bracket may open inside this number of others.
fn not_too_deep(place: &Place<'_>, brackets: usize) -> Result<(), Fault> {
    match brackets == MOST_BRACKETS {
        true => Err(place.fault(&format!("brackets are in more than {MOST_BRACKETS} others"))),
        false => Ok(()),
    }
}

/// The notation of a language within a line.
#[derive(Clone, Debug)]
pub(in crate::read::reader) struct Syntax {
    /// Texts around the index of an entry.
    pub(in crate::read::reader) index: (&'static str, &'static str),
    /// The index of the first entry.
    pub(in crate::read::reader) first: usize,
    /// Multiplication and division.
    pub(in crate::read::reader) operators: [&'static str; 2],
    /// Suffix of a number.
    pub(in crate::read::reader) suffix: &'static str,
    /// Text before the entry whose sign is taken.
    pub(in crate::read::reader) sign: String,
    /// Text before the entry of a Stribeck exponential.
    pub(in crate::read::reader) stribeck: String,
    /// Text before the two factors and the summand of a fused operation, if the language has it.
    pub(in crate::read::reader) fused: Option<String>,
    /// Texts around a definition: `const double `, ` = `, `;`.
    pub(in crate::read::reader) define: [String; 3],
    /// Texts around the index of a value in a list.
    pub(in crate::read::reader) list: (&'static str, &'static str),
    /// Separator of angles.
    pub(in crate::read::reader) angles: &'static str,
}

impl Syntax {
    /// A value of a list, counted from 0.
    pub(super) fn value(&self, list: &str, index: usize) -> String {
        let (open, close) = self.list;
        format!("{list}{open}{}{close}", index + self.first)
    }
}

/// A function while its program is built.
pub(in crate::read::reader) struct Body<'a, 's> {
    pub(super) syntax: &'s Syntax,
    real: Float,
    pub(in crate::read::reader) program: Program,
    scope: BTreeMap<&'a str, usize>,
    /// Whether it uses sines, signs and Stribeck friction.
    pub(in crate::read::reader) asks: [bool; 3],
    /// Number of steps and entries of the functions before.
    steps: usize,
}

impl<'a, 's> Body<'a, 's> {
    pub(in crate::read::reader) fn new(
        name: &str,
        arguments: Vec<Argument>,
        syntax: &'s Syntax,
        real: Float,
        steps: usize,
    ) -> Body<'a, 's> {
        let program = Program {
            name: name.into(),
            arguments,
            steps: Vec::new(),
            literals: Vec::new(),
            turns: Vec::new(),
            outputs: Vec::new(),
        };
        Body { syntax, real, program, scope: BTreeMap::new(), asks: [false; 3], steps }
    }

    /// Number of steps and entries of this function and those before.
    pub(in crate::read::reader) fn steps(&self) -> usize {
        self.steps + self.program.steps.len() + self.program.outputs.len()
    }

    fn push(&mut self, step: Step, place: &Place<'_>) -> Result<usize, Fault> {
        if self.steps() >= MOST_STEPS {
            let reason = format!("functions of more than {MOST_STEPS} steps and entries in all");
            return Err(Fault { line: place.line, reason });
        }
        self.program.steps.push(step);
        Ok(self.program.steps.len() - 1)
    }

    /// Assigns a name to a value.
    pub(in crate::read::reader) fn bind(&mut self, name: &'a str, value: usize, line: usize) -> Result<(), Fault> {
        if !is_value(name) {
            let reason = format!("`{name}` where the name of a value can stand, such as t1, s2 or c2");
            return Err(Fault { line, reason });
        }
        match self.scope.insert(name, value) {
            Some(_) => Err(Fault { line, reason: format!("`{name}` is given twice") }),
            None => Ok(()),
        }
    }

    /// A value by its name.
    pub(in crate::read::reader) fn value(&self, name: &str, line: usize) -> Result<usize, Fault> {
        let reason = || format!("`{name}` is not a value that is given before");
        self.scope.get(name).copied().ok_or_else(|| Fault { line, reason: reason() })
    }

    /// Hides the names of the caller inside a part, which has its own names; [`Body::leave`] restores them.
    pub(in crate::read::reader) fn enter(&mut self) -> BTreeMap<&'a str, usize> {
        std::mem::take(&mut self.scope)
    }

    pub(in crate::read::reader) fn leave(&mut self, scope: BTreeMap<&'a str, usize>) {
        self.scope = scope;
    }

    /// The name and the value that a line defines, if it is a definition.
    pub(in crate::read::reader) fn definition(&self, lines: &Lines<'a>) -> Option<(&'a str, &'a str)> {
        let [begin, between, end] = &self.syntax.define;
        let inner = lines.peek().strip_prefix(begin.as_str())?.strip_suffix(end.as_str())?;
        inner.split_once(between.as_str()).filter(|(name, _)| is_value(name))
    }

    /// Takes the line that assigns a name to this array element, if it is the current line.
    pub(in crate::read::reader) fn element(&mut self, lines: &mut Lines<'a>, from: &str, value: usize) -> Result<bool, Fault> {
        match self.definition(lines) {
            Some((name, found)) if found == from => {
                self.bind(name, value, lines.number())?;
                lines.at += 1;
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// Takes all lines that define a value by a sum.
    pub(in crate::read::reader) fn definitions(&mut self, lines: &mut Lines<'a>) -> Result<(), Fault> {
        while let Some((name, value)) = self.definition(lines) {
            let value = self.sum_of(value, lines.number())?;
            self.bind(name, value, lines.number())?;
            lines.at += 1;
        }
        Ok(())
    }

    /// Adds an entry of the result.
    pub(in crate::read::reader) fn output(&mut self, place: String, text: &'a str, line: usize) -> Result<(), Fault> {
        let step = self.sum_of(text, line)?;
        self.program.outputs.push(Output { place, step });
        Ok(())
    }

    /// A complete sum.
    fn sum_of(&mut self, text: &'a str, line: usize) -> Result<usize, Fault> {
        let mut place = Place { rest: text, line };
        let value = self.sum(&mut place, 0)?;
        place.ends()?;
        Ok(value)
    }

    /// The angles of a list; returns the steps for their sines and cosines.
    pub(in crate::read::reader) fn angles(&mut self, text: &'a str, line: usize) -> Result<Vec<(usize, usize)>, Fault> {
        let mut place = Place { rest: text, line };
        let mut waves = Vec::new();
        loop {
            let angle = self.angle(&mut place)?;
            self.asks[0] = true;
            let (sine, cosine) = (self.push(Step::Sine(angle.clone()), &place)?, self.push(Step::Cosine(angle), &place)?);
            waves.push((sine, cosine));
            if place.rest.is_empty() {
                return Ok(waves);
            }
            place.expect(self.syntax.angles)?;
        }
    }

    fn angle(&mut self, place: &mut Place<'a>) -> Result<Angle, Fault> {
        let mut angle = Angle::default();
        let mut sum = None;
        loop {
            let minus = sum.is_some() && place.eat(" - ");
            if sum.is_some() && !minus && !place.eat(" + ") {
                break;
            }
            let start = *place;
            let mut scale = None;
            if place.rest.starts_with(|c: char| c.is_ascii_digit()) {
                let step = self.literal(place)?;
                let literal = self.program.literals.len() - 1;
                if !place.eat(" * ") {
                    if sum.is_none() {
                        return Err(start.fault("an angle begins with a joint variable"));
                    }
                    self.program.turns.push(literal);
                    angle.turn = Some((self.program.turns.len() - 1, minus));
                }
                scale = Some((step, literal));
            }
            let term = if let (Some((step, _)), Some(_)) = (scale, angle.turn) {
                step
            } else {
                let (argument, joint, entry) = self.entry(place)?;
                let factor = if minus { -1 } else { 1 };
                // Rounding depends on the order, so the order is fixed: added joints first.
                let follows = angle.terms.last().is_none_or(|&(last, before)| (-before, last) < (-factor, joint));
                let new = angle.terms.iter().all(|(other, _)| *other != joint);
                if argument != Argument::Q || !follows || !new {
                    return Err(start.fault("an angle goes on with joint variables in their order, those taken away last"));
                }
                angle.terms.push((joint, factor));
                angle.factors.push(scale.map(|(_, literal)| literal));
                match scale {
                    Some((step, _)) => self.push(Step::Multiply(step, entry), place)?,
                    None => entry,
                }
            };
            sum = Some(match sum {
                None => term,
                Some(before) if minus => self.push(Step::Subtract(before, term), place)?,
                Some(before) => self.push(Step::Add(before, term), place)?,
            });
            if angle.turn.is_some() {
                break;
            }
        }
        Ok(angle.sorted())
    }

    fn literal(&mut self, place: &mut Place<'a>) -> Result<usize, Fault> {
        let literal = place.literal(self.real, self.syntax.suffix)?;
        self.program.literals.push(literal);
        self.push(Step::Literal(self.program.literals.len() - 1), place)
    }

    fn entry(&mut self, place: &mut Place<'a>) -> Result<(Argument, usize, usize), Fault> {
        let start = *place;
        let word = place.word();
        let argument = Argument::named(word).filter(|argument| self.program.arguments.contains(argument));
        let argument = argument.ok_or_else(|| start.fault("an argument of the function can stand"))?;
        place.expect(self.syntax.index.0)?;
        let index = place.integer()?;
        let index = index.checked_sub(self.syntax.first).ok_or_else(|| start.fault("an index can stand"))?;
        place.expect(self.syntax.index.1)?;
        Ok((argument, index, self.push(Step::Input(argument, index), place)?))
    }

    fn sum(&mut self, place: &mut Place<'a>, brackets: usize) -> Result<usize, Fault> {
        let mut sum = self.product(place, brackets)?;
        loop {
            let plus = place.eat(" + ");
            if !plus && !place.eat(" - ") {
                return Ok(sum);
            }
            let term = self.product(place, brackets)?;
            sum = self.push(if plus { Step::Add(sum, term) } else { Step::Subtract(sum, term) }, place)?;
        }
    }

    fn product(&mut self, place: &mut Place<'a>, brackets: usize) -> Result<usize, Fault> {
        let [times, over] = self.syntax.operators;
        let mut product = self.factor(place, brackets)?;
        loop {
            let multiplied = place.eat(times);
            if !multiplied && !place.eat(over) {
                return Ok(product);
            }
            let factor = self.factor(place, brackets)?;
            let step = if multiplied { Step::Multiply(product, factor) } else { Step::Divide(product, factor) };
            product = self.push(step, place)?;
        }
    }

    fn factor(&mut self, place: &mut Place<'a>, brackets: usize) -> Result<usize, Fault> {
        let negative = place.eat("-");
        let start = *place;
        let value = if place.rest.starts_with(|c: char| c.is_ascii_digit()) {
            self.literal(place)?
        } else if place.eat("(") {
            not_too_deep(place, brackets)?;
            let inner = self.sum(place, brackets + 1)?;
            place.expect(")")?;
            inner
        } else if place.eat(&self.syntax.sign) {
            not_too_deep(place, brackets)?;
            let of = self.sum(place, brackets + 1)?;
            place.expect(")")?;
            self.asks[1] = true;
            let sign = match self.program.steps[of] {
                Step::Input(Argument::Dq, joint) => Step::Sign(joint),
                _ => Step::SignOf(of),
            };
            self.push(sign, place)?
        } else if place.eat(&self.syntax.stribeck) {
            let (argument, joint, _) = self.entry(place)?;
            if argument != Argument::Dq {
                return Err(start.fault("Stribeck friction is of a joint rate"));
            }
            place.expect(", ")?;
            let velocity = self.program.literals.len();
            self.literal(place)?;
            place.expect(")")?;
            self.asks[2] = true;
            self.push(Step::Stribeck(joint, velocity), place)?
        } else if self.syntax.fused.as_ref().is_some_and(|fused| place.eat(fused)) {
            not_too_deep(place, brackets)?;
            let a = self.sum(place, brackets + 1)?;
            place.expect(", ")?;
            let b = self.sum(place, brackets + 1)?;
            place.expect(", ")?;
            let c = self.sum(place, brackets + 1)?;
            place.expect(")")?;
            let product = self.push(Step::Product(a, b), place)?;
            self.push(Step::Add(product, c), place)?
        } else {
            let mut after = *place;
            let word = after.word();
            match self.scope.get(word) {
                Some(value) => {
                    *place = after;
                    *value
                }
                None => self.entry(place)?.2,
            }
        };
        match negative {
            true => self.push(Step::Negate(value), place),
            false => Ok(value),
        }
    }
}
