//! What the readers of languages other than Rust share: lines, and what stands in a line.
//!
//! An emitted file is taken as it was written, line by line: what is the same in every module is compared with texts that stand here once
//! more, and where a line is a robot's own, it has one of a few forms, blanks included. So nothing that a language would read differently
//! (ends of lines, indentation, continued lines, operators of two characters) can stand anywhere.
//!
//! ```text
//! sum     = product { (" + " | " - ") product }          product = factor { (" * " | " / ") factor }
//! factor  = ["-"] primary                                primary = number | name | entry | sign(entry) | "(" sum ")"
//! angle   = entry { (" + " | " - ") entry } [ (" + " | " - ") number ]
//! ```

use std::collections::BTreeMap;

use super::constant::Constant;
use super::lexer::{is_hidden, name_of, Fault};
use super::{Function, LONGEST};
use crate::check::Check;
use crate::contract::{Promise, Sizes};
use crate::enclosure::Float;
use crate::program::{Angle, Argument, Literal, Output, Program, Step};

/// What a language reads in comments: escapes in Python's, splices and trigraphs that end those of C, the encoding of a Python file.
const ESCAPES: [&str; 4] = ["\\", "??/", "coding:", "coding="];

/// Steps and entries of results in a module.
const MOST_STEPS: usize = 4_000_000;
/// Brackets in brackets.
const MOST_BRACKETS: usize = 16;
/// Entries of an array of constants.
const MOST_ENTRIES: usize = 4096;
/// Joints, as many as a description can have and more.
const MOST_JOINTS: usize = 128;

/// A line of code.
#[derive(Clone, Debug)]
pub(super) struct Line<'a> {
    pub(super) number: usize,
    pub(super) text: &'a str,
    /// The lines of the comment in front of it.
    pub(super) comment: Vec<&'a str>,
}

/// The lines of code of a text, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Lines<'a> {
    pub(super) all: Vec<Line<'a>>,
    pub(super) at: usize,
    last: usize,
}

/// How comments stand in a language: each begins at the beginning of a line and ends at the end of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Comments {
    /// What a comment of one line begins with.
    pub(super) line: Option<&'static str>,
    /// What a longer comment begins and ends with.
    pub(super) block: Option<(&'static str, &'static str)>,
}

impl<'a> Lines<'a> {
    /// The lines of a text, without comments and empty lines.
    pub(super) fn new(text: &'a str, comments: Comments) -> Result<Lines<'a>, Fault> {
        let mut all = Vec::new();
        let mut comment: Vec<&str> = Vec::new();
        let mut open = None;
        let mut last = 0;
        if text.len() > LONGEST {
            return Err(Fault { line: 1, reason: format!("the text is longer than {} MiB", LONGEST >> 20) });
        }
        for (line, number) in text.split('\n').zip(1..) {
            last = number;
            if let Some(c) = line.chars().find(|c| is_hidden(*c)) {
                return Err(Fault { line: number, reason: format!("the character {}, which cannot be seen", name_of(c)) });
            }
            let commented = open.is_some()
                || comments.line.is_some_and(|begin| line.starts_with(begin))
                || comments.block.is_some_and(|(begin, _)| line.starts_with(begin));
            if let Some(escape) = ESCAPES.into_iter().find(|escape| commented && line.contains(escape)) {
                let reason = format!("`{escape}` in a comment, which a compiler can read as something else");
                return Err(Fault { line: number, reason });
            }
            let begins = comments.block.filter(|(begin, _)| open.is_none() && line.starts_with(begin));
            if let Some((begin, end)) = open.or(begins) {
                let rest = if open.is_none() { &line[begin.len()..] } else { line };
                open = match rest.split_once(end) {
                    None => Some((begin, end)),
                    Some((_, "")) => None,
                    Some(_) => return Err(Fault { line: number, reason: "something behind the end of a comment".into() }),
                };
                comment.push(rest.split_once(end).map_or(rest, |(text, _)| text));
            } else if let Some(text) = comments.line.and_then(|begin| line.strip_prefix(begin)) {
                comment.push(text);
            } else if !line.is_empty() {
                all.push(Line { number, text: line, comment: std::mem::take(&mut comment) });
            }
        }
        match open {
            Some(_) => Err(Fault { line: last, reason: "a comment that does not end".into() }),
            None => Ok(Lines { all, at: 0, last }),
        }
    }

    /// The line that stands here, nothing behind the last.
    pub(super) fn peek(&self) -> &'a str {
        self.all.get(self.at).map_or("", |line| line.text)
    }

    /// The same lines behind so many of other files.
    pub(super) fn behind(mut self, before: usize) -> Lines<'a> {
        self.all.iter_mut().for_each(|line| line.number += before);
        self.last += before;
        self
    }

    pub(super) fn number(&self) -> usize {
        self.all.get(self.at).map_or(self.last, |line| line.number)
    }

    pub(super) fn is(&self, text: &str) -> bool {
        !text.is_empty() && self.peek() == text
    }

    pub(super) fn ended(&self) -> bool {
        self.at >= self.all.len()
    }

    /// What is wrong with the line that stands here.
    pub(super) fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault { line: self.number(), reason: reason.into() }
    }

    /// The line as it is shown.
    pub(super) fn shown(&self) -> String {
        if self.ended() {
            return "the end of the text".into();
        }
        let text: String = self.peek().trim().chars().take(60).collect();
        format!("`{text}`")
    }

    pub(super) fn eat(&mut self, text: &str) -> bool {
        let found = self.is(text);
        self.at += usize::from(found);
        found
    }

    /// Takes a line, which must stand here.
    pub(super) fn expect(&mut self, text: &str) -> Result<(), Fault> {
        match self.eat(text) {
            true => Ok(()),
            false => Err(self.fault(format!("{} where an emitted module has `{}`", self.shown(), text.trim()))),
        }
    }

    /// Takes all lines of a text.
    pub(super) fn expect_all(&mut self, text: &str, comments: Comments) -> Result<(), Fault> {
        let lines = Lines::new(text, comments)?;
        lines.all.iter().try_for_each(|line| self.expect(line.text))
    }

    /// Takes a line that begins and ends so; what stands between.
    pub(super) fn between(&mut self, begin: &str, end: &str) -> Result<&'a str, Fault> {
        let found = self.peek().strip_prefix(begin).and_then(|rest| rest.strip_suffix(end));
        let found = found.ok_or_else(|| {
            self.fault(format!("{} where an emitted module has `{} ... {end}`", self.shown(), begin.trim_start()))
        })?;
        self.at += 1;
        Ok(found)
    }
}

/// A place in a line.
#[derive(Clone, Copy, Debug)]
struct Place<'a> {
    rest: &'a str,
    line: usize,
}

impl<'a> Place<'a> {
    fn eat(&mut self, text: &str) -> bool {
        match self.rest.strip_prefix(text) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn expect(&mut self, text: &str) -> Result<(), Fault> {
        match self.eat(text) {
            true => Ok(()),
            false => Err(self.fault(&format!("`{text}` can stand"))),
        }
    }

    fn fault(&self, wanted: &str) -> Fault {
        let found: String = self.rest.chars().take(40).collect();
        let found = if found.is_empty() { "the end of the line".into() } else { format!("`{found}`") };
        Fault { line: self.line, reason: format!("{found} where {wanted}") }
    }

    fn word(&mut self) -> &'a str {
        let fits = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let (word, rest) = self.rest.split_at(self.rest.find(|c| !fits(c)).unwrap_or(self.rest.len()));
        self.rest = rest;
        word
    }

    fn integer(&mut self) -> Result<usize, Fault> {
        let start = *self;
        let word = self.word();
        word.parse::<usize>().ok().filter(|value| value.to_string() == word).ok_or_else(|| start.fault("an index can stand"))
    }

    /// A number without a sign, in the shortest decimal of its float, with what the language writes behind it.
    fn literal(&mut self, real: Float, suffix: &str) -> Result<Literal, Fault> {
        let start = *self;
        let bytes = self.rest.as_bytes();
        let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end += 1 + digits(end + 1);
        }
        if bytes.get(end) == Some(&b'e') {
            let sign = usize::from(bytes.get(end + 1) == Some(&b'-'));
            end += 1 + sign + digits(end + 1 + sign);
        }
        let (text, rest) = self.rest.split_at(end);
        self.rest = rest;
        self.expect(suffix).map_err(|_| start.fault(&format!("a number ends in `{suffix}`")))?;
        let value = real.read(text).filter(|value| shortest(*value, real) == text);
        let value = value.ok_or_else(|| start.fault("the shortest decimal of a float can stand"))?;
        Ok(Literal { text: text.into(), value })
    }

    fn ends(&self) -> Result<(), Fault> {
        match self.rest {
            "" => Ok(()),
            _ => Err(self.fault("the line should end")),
        }
    }
}

fn shortest(value: f64, real: Float) -> String {
    match real {
        Float::F64 => format!("{value:?}"),
        Float::F32 => format!("{:?}", value as f32),
    }
}

/// As many characters of a name tell it from others: in C 63 of a name inside of a function (C99, 5.2.4.1), in MATLAB the first 63 (`namelengthmax`).
const LONGEST_NAME: usize = 63;

/// The name of a value: a letter, a digit, and digits, small letters and `_`.
fn is_value(word: &str) -> bool {
    let rest = word.strip_prefix(['s', 'c', 't', 'r']).unwrap_or("");
    (word.len() <= LONGEST_NAME || !Check::Long.is_made())
        && rest.starts_with(|c: char| c.is_ascii_digit())
        && rest.bytes().all(|b| b.is_ascii_digit() || b.is_ascii_lowercase() || b == b'_')
}

/// How a language writes what stands in a line.
#[derive(Clone, Debug)]
pub(super) struct Syntax {
    /// Around the index of an entry.
    pub(super) index: (&'static str, &'static str),
    /// The index of the first entry.
    pub(super) first: usize,
    /// Multiplication and division.
    pub(super) operators: [&'static str; 2],
    /// Behind a number.
    pub(super) suffix: &'static str,
    /// In front of the entry that a sign is of.
    pub(super) sign: String,
    /// In front of the entry that what is left of Stribeck friction is of.
    pub(super) stribeck: String,
    /// Around the value of a name: `const double `, ` = `, `;`.
    pub(super) define: [String; 3],
    /// Around the index of a value in a list.
    pub(super) list: (&'static str, &'static str),
    /// Between two angles.
    pub(super) angles: &'static str,
}

impl Syntax {
    /// A value of a list, counted from 0.
    fn value(&self, list: &str, index: usize) -> String {
        let (open, close) = self.list;
        format!("{list}{open}{}{close}", index + self.first)
    }
}

/// The values of constants, as they stand in a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constants {
    pub(super) real: Float,
    pub(super) suffix: &'static str,
    /// Around a text.
    pub(super) quotes: char,
    /// What an array of such entries begins with, between them, at its end, and an array without entries; whether it stands in another.
    pub(super) list: fn(Entry, bool) -> [&'static str; 4],
    pub(super) truth: [&'static str; 2],
    /// Infinity; a minus sign stands before it where it is negative.
    pub(super) infinity: &'static str,
}

/// What an entry of a constant is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entry {
    Text,
    Integer,
    Truth,
    Real,
}

/// The constants that a module may have: their names, what their entries are, and arrays in arrays.
pub(super) const CONSTANTS: [(&str, Entry, usize); 15] = [
    ("NAME", Entry::Text, 0),
    ("DOF", Entry::Integer, 0),
    ("JOINT_NAMES", Entry::Text, 1),
    ("JOINT_IS_REVOLUTE", Entry::Truth, 1),
    ("POSITION_LIMITS", Entry::Real, 2),
    ("VELOCITY_LIMITS", Entry::Real, 1),
    ("EFFORT_LIMITS", Entry::Real, 1),
    ("TASK_ROWS", Entry::Integer, 0),
    ("TASK", Entry::Integer, 1),
    ("PARAMETERS", Entry::Integer, 0),
    ("PARAMETER_NAMES", Entry::Text, 1),
    ("NOMINAL_PARAMETERS", Entry::Real, 1),
    ("BASE_PARAMETERS", Entry::Integer, 0),
    ("BASE_PARAMETER_NAMES", Entry::Text, 1),
    ("NOMINAL_BASE_PARAMETERS", Entry::Real, 1),
];

impl Constants {
    /// Reads the value of a constant.
    pub(super) fn read(&self, name: &str, text: &str, line: usize) -> Result<Constant, Fault> {
        let mut place = Place { rest: text, line };
        let known = CONSTANTS.iter().find(|(known, ..)| *known == name);
        let (_, entry, depth) = known.ok_or_else(|| place.fault("there is no constant of that name"))?;
        let value = self.value(&mut place, *entry, *depth, false)?;
        place.ends()?;
        Ok(value)
    }

    fn value(&self, place: &mut Place<'_>, entry: Entry, depth: usize, inner: bool) -> Result<Constant, Fault> {
        if depth > 0 {
            let [begin, between, end, empty] = (self.list)(entry, inner);
            if place.eat(empty) {
                return Ok(Constant::Array(Vec::new()));
            }
            place.expect(begin)?;
            let mut entries = Vec::new();
            while entries.is_empty() || !place.eat(end) {
                if !entries.is_empty() {
                    place.expect(between)?;
                }
                if entries.len() == MOST_ENTRIES {
                    return Err(place.fault("a constant has too many entries"));
                }
                entries.push(self.value(place, entry, depth - 1, true)?);
            }
            return Ok(Constant::Array(entries));
        }
        Ok(match entry {
            Entry::Text => {
                place.expect(self.quotes.encode_utf8(&mut [0; 4]))?;
                let start = *place;
                let (text, rest) = place.rest.split_once(self.quotes).ok_or_else(|| start.fault("a text should end"))?;
                if !text.chars().all(|c| c.is_alphanumeric() || c == '_' || !c.is_ascii()) {
                    return Err(start.fault("a name can stand"));
                }
                place.rest = rest;
                Constant::Text(text.into())
            }
            Entry::Integer => Constant::Integer(place.integer()? as u64),
            Entry::Truth => {
                let found = self.truth.iter().position(|word| place.eat(word));
                Constant::Truth(found.ok_or_else(|| place.fault("a truth value can stand"))? == 1)
            }
            Entry::Real => {
                let negative = place.eat("-");
                if place.eat(self.infinity) {
                    Constant::Infinite(negative)
                } else {
                    Constant::Number(negative, place.literal(self.real, self.suffix)?)
                }
            }
        })
    }
}

/// The sizes that constants of a module state.
pub(super) fn sizes(constants: &BTreeMap<String, Constant>) -> Result<Sizes, Fault> {
    let of = |name: &str, most: usize| match constants.get(name) {
        Some(Constant::Integer(value)) if *value <= most as u64 => Ok(*value as usize),
        None => Ok(0),
        Some(_) => Err(Fault { line: 1, reason: format!("`{name}` is more than {most}") }),
    };
    Ok(Sizes {
        n: of("DOF", MOST_JOINTS)?,
        p: of("PARAMETERS", MOST_ENTRIES)?,
        b: of("BASE_PARAMETERS", MOST_ENTRIES)?,
        m: of("TASK_ROWS", 6)?,
    })
}

/// The function of a name, its arguments, and whether it takes parameters.
pub(super) fn promised(name: &str) -> Option<(&'static Promise, Vec<Argument>)> {
    let (promise, with) = Promise::of(name)?;
    let arguments = with.then_some("pi").into_iter().chain(promise.arguments.iter().copied());
    Some((promise, arguments.filter_map(Argument::named).collect()))
}

/// A function on its way to a program.
pub(super) struct Body<'a, 's> {
    syntax: &'s Syntax,
    real: Float,
    pub(super) program: Program,
    scope: BTreeMap<&'a str, usize>,
    /// Sines are used, and signs.
    pub(super) asks: [bool; 3],
    /// Steps and entries of the functions before.
    steps: usize,
}

impl<'a, 's> Body<'a, 's> {
    pub(super) fn new(name: &str, arguments: Vec<Argument>, syntax: &'s Syntax, real: Float, steps: usize) -> Body<'a, 's> {
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

    /// Steps and entries of this function and those before.
    pub(super) fn steps(&self) -> usize {
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

    /// Gives a value a name.
    pub(super) fn bind(&mut self, name: &'a str, value: usize, line: usize) -> Result<(), Fault> {
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
    pub(super) fn value(&self, name: &str, line: usize) -> Result<usize, Fault> {
        let reason = || format!("`{name}` is not a value that is given before");
        self.scope.get(name).copied().ok_or_else(|| Fault { line, reason: reason() })
    }

    /// Leaves the names of the caller, for a part with names of its own; they come back by [`Body::leave`].
    pub(super) fn enter(&mut self) -> BTreeMap<&'a str, usize> {
        std::mem::take(&mut self.scope)
    }

    pub(super) fn leave(&mut self, scope: BTreeMap<&'a str, usize>) {
        self.scope = scope;
    }

    /// What a line defines, if it is one: a name and its value.
    pub(super) fn definition(&self, lines: &Lines<'a>) -> Option<(&'a str, &'a str)> {
        let [begin, between, end] = &self.syntax.define;
        let inner = lines.peek().strip_prefix(begin.as_str())?.strip_suffix(end.as_str())?;
        inner.split_once(between.as_str()).filter(|(name, _)| is_value(name))
    }

    /// Takes the line that gives a name such a value, if it stands here: a value of an array.
    pub(super) fn element(&mut self, lines: &mut Lines<'a>, from: &str, value: usize) -> Result<bool, Fault> {
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
    pub(super) fn definitions(&mut self, lines: &mut Lines<'a>) -> Result<(), Fault> {
        while let Some((name, value)) = self.definition(lines) {
            let value = self.sum_of(value, lines.number())?;
            self.bind(name, value, lines.number())?;
            lines.at += 1;
        }
        Ok(())
    }

    /// Adds an entry of the result.
    pub(super) fn output(&mut self, place: String, text: &'a str, line: usize) -> Result<(), Fault> {
        let step = self.sum_of(text, line)?;
        self.program.outputs.push(Output { place, step });
        Ok(())
    }

    /// A whole sum.
    fn sum_of(&mut self, text: &'a str, line: usize) -> Result<usize, Fault> {
        let mut place = Place { rest: text, line };
        let value = self.sum(&mut place, 0)?;
        place.ends()?;
        Ok(value)
    }

    /// The angles of a list, each followed by steps for its sine and cosine: these.
    pub(super) fn angles(&mut self, text: &'a str, line: usize) -> Result<Vec<(usize, usize)>, Fault> {
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
            let term = if sum.is_some() && place.rest.starts_with(|c: char| c.is_ascii_digit()) {
                let step = self.literal(place)?;
                self.program.turns.push(self.program.literals.len() - 1);
                angle.turn = Some((self.program.turns.len() - 1, minus));
                step
            } else {
                let (argument, joint, step) = self.entry(place)?;
                let factor = if minus { -1 } else { 1 };
                // As rounding depends on the order, it is the same everywhere: added ones first.
                let follows = angle.terms.last().is_none_or(|&(last, before)| (-before, last) < (-factor, joint));
                let new = angle.terms.iter().all(|(other, _)| *other != joint);
                if argument != Argument::Q || !follows || !new {
                    return Err(start.fault("an angle goes on with joint variables in their order, those taken away last"));
                }
                angle.terms.push((joint, factor));
                step
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
        angle.terms.sort_unstable();
        Ok(angle)
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
            if brackets == MOST_BRACKETS {
                return Err(place.fault(&format!("brackets are in more than {MOST_BRACKETS} others")));
            }
            let inner = self.sum(place, brackets + 1)?;
            place.expect(")")?;
            inner
        } else if place.eat(&self.syntax.sign) {
            let (argument, joint, _) = self.entry(place)?;
            if argument != Argument::Dq {
                return Err(start.fault("the sign is of a joint rate"));
            }
            place.expect(")")?;
            self.asks[1] = true;
            self.push(Step::Sign(joint), place)?
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

/// What stands behind the constants of a module: functions, and what belongs to them.
pub(super) trait Functions<'a> {
    /// Takes a function; nothing where something else stands here: a part of one, the type of its results.
    fn item(&mut self, lines: &mut Lines<'a>) -> Result<Option<(String, Function)>, Fault>;

    /// A part that no function calls.
    fn unused(&self) -> Option<&'a str>;

    /// Whether functions use sines, signs, and what is left of Stribeck friction.
    fn asks(&self) -> [bool; 3];

    /// Takes all functions, up to a line or the end of the text; `has`: whether the module has these.
    fn all(&mut self, lines: &mut Lines<'a>, end: &str, has: [bool; 3]) -> Result<Vec<(String, Read)>, Fault> {
        let mut functions: Vec<(String, Read)> = Vec::new();
        while !lines.ended() && !lines.is(end) {
            if let Some((name, function)) = self.item(lines)? {
                if functions.iter().any(|(other, _)| *other == name) {
                    return Err(lines.fault(format!("function `{name}` stands twice")));
                }
                functions.push((name, Ok(function)));
            }
        }
        if let Some(name) = self.unused() {
            return Err(lines.fault(format!("`{name}` is needed by no function of the module")));
        }
        match has == self.asks() {
            true => Ok(functions),
            false => Err(lines
                .fault("the module has sines, a sign or an exponential that no function needs, or lacks those that one needs")),
        }
    }
}

/// A function, or what is wrong with it.
type Read = Result<Function, String>;

/// The names of all functions that a module may have.
pub(super) fn names_of() -> impl Iterator<Item = String> {
    let forms = |promise: &Promise| [promise.name.to_string(), format!("{}_with", promise.name)];
    crate::reference::PROMISES.iter().flat_map(forms).filter(|name| Promise::of(name).is_some())
}

/// The parts of long functions, in languages that hand values to a part as a list and get one back; their lines are read where they are
/// called.
#[derive(Default)]
pub(super) struct Parts<'a>(BTreeMap<&'a str, Part<'a>>);

/// A part of a long function: its arguments, and where its lines begin.
struct Part<'a> {
    arguments: Vec<&'a str>,
    body: usize,
    used: bool,
}

impl<'a> Parts<'a> {
    /// A part whose head stands at `line`.
    pub(super) fn add(&mut self, name: &'a str, arguments: Vec<&'a str>, body: usize, line: usize) -> Result<(), Fault> {
        match self.0.insert(name, Part { arguments, body, used: false }) {
            Some(_) => Err(Fault { line, reason: format!("`{name}` stands twice") }),
            None => Ok(()),
        }
    }

    /// A part that nothing calls.
    pub(super) fn unused(&self) -> Option<&'a str> {
        self.0.iter().find_map(|(name, part)| (!part.used).then_some(*name))
    }

    /// The arguments of the function that a part takes, as its call passes them on.
    pub(super) fn passed(&mut self, name: &str, lines: &Lines<'a>) -> Result<String, Fault> {
        let part = self.0.get_mut(name).ok_or_else(|| lines.fault(format!("there is no part `{name}`")))?;
        part.used = true;
        Ok(part.arguments.iter().map(|argument| format!("{argument}, ")).collect())
    }

    /// Takes the call of a part in as if its lines stood here: the names that it is handed and the line of the call, how the names of its
    /// results are read, and what its results are called.
    pub(super) fn take_in(
        &self,
        name: &str,
        lines: &mut Lines<'a>,
        body: &mut Body<'a, '_>,
        (names, line): (Vec<&'a str>, usize),
        results: impl FnOnce(&mut Lines<'a>) -> Result<Vec<&'a str>, Fault>,
        given: &str,
    ) -> Result<(), Fault> {
        let part = self.0.get(name).ok_or_else(|| lines.fault(format!("there is no part `{name}`")))?;
        let all = body.program.arguments.clone();
        if let Some(wrong) = part.arguments.iter().find(|a| !all.iter().any(|own| own.name() == **a)) {
            return Err(Fault { line, reason: format!("`{wrong}` is not an argument of the function") });
        }
        let taken = names.into_iter().map(|name| body.value(name, line)).collect::<Result<Vec<usize>, Fault>>()?;
        let back = std::mem::replace(&mut lines.at, part.body);
        let scope = body.enter();
        // Of the function's arguments it knows those that it takes.
        body.program.arguments.retain(|own| part.arguments.contains(&own.name()));
        for (i, value) in taken.into_iter().enumerate() {
            if !body.element(lines, &body.syntax.value("taken", i), value)? {
                return Err(lines.fault(format!("value {i} that the part takes has no name")));
            }
        }
        body.definitions(lines)?;
        let line = lines.number();
        let values = results(lines)?.into_iter().map(|name| body.value(name, line)).collect::<Result<Vec<usize>, Fault>>()?;
        body.leave(scope);
        body.program.arguments = all;
        lines.at = back;
        for (i, value) in values.into_iter().enumerate() {
            if !body.element(lines, &body.syntax.value(given, i), value)? {
                return Err(lines.fault(format!("value {i} that the part gives has no name")));
            }
        }
        Ok(())
    }
}

/// `inertia_matrix` as `inertiaMatrix`.
pub(crate) fn camel(name: &str) -> String {
    let mut result = String::new();
    let mut capital = false;
    for c in name.chars() {
        if c == '_' {
            capital = true;
        } else {
            result.push(if capital { c.to_ascii_uppercase() } else { c });
            capital = false;
        }
    }
    result
}
