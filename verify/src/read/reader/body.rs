//! Reads the body of a function as steps.
//!
//! ```text
//! body   = { { line } result } | { let mut result = zeros; NAME_into(arguments, &mut result); result }
//! body of NAME_into = { { line | part[index]... = sum ; | barrier(); } }    each entry of each part once, in the place of a result
//! line   = let _ = ignored ;                                        arguments that are not needed: q or (q, dq)
//!        | let (name, name) = sin_cos(angle) ;                      sin_cos_one in a module with the fast sines
//!        | let name = sin_one(angle) ;                              or cos_one, in a module with the fast sines, in f64
//!        | let ([names], [names]) = sin_cos_four(count, angles) ;   four or eight, names of the first `count` ones
//!        | let name = sum ;
//!        | let [names] = part(arguments, [names]) ;                 each part once, in order
//! result = sum | [ result, ... ] | ([ ... ], [ ... ]) | EquationsOfMotion { inertia: ..., coriolis: ..., gravity: ... }
//! sum    = product { (+ | -) product }      product = factor { (* | /) factor }      factor = [-] primary
//! primary = number | name | entry | sign(dq[index]) | Real::mul_add(sum, sum, sum) | ( sum )
//! angle  = term { (+ | -) term } [ (+ | -) number ]                 added joints first, each kind in their order, each joint once
//! term   = [ number * ] entry
//! ```
//!
//! A name is a letter s, c or t, a digit, then digits, small letters and `_`. No keyword, item or prelude has such a name, and no name occurs
//! twice in a function. An unused name may be `_`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use super::constant::{decimal, integer};
use super::items::{Part, Public, INTO};
use super::lexer::{Fault, Kind, Token};
use super::parser::{Parser, Reads};
use crate::values::check::Check;
use crate::values::contract::{of_module, Promise, Returned};
use crate::values::enclosure::Float;
use crate::values::program::{Angle, Argument, Output, Program, Step};

/// Maximum number of steps and result entries in a module; a module of 32 joints has a third of it.
const MOST_STEPS: usize = 4_000_000;
/// Maximum number of indices of a result entry; a list of matrices has three.
const MOST_INDICES: usize = 3;
/// Maximum depth of brackets, in a sum and in a result.
const MOST_BRACKETS: usize = 16;

/// Data shared by all functions of a module.
#[derive(Debug)]
pub(super) struct Shared<'a, 'm> {
    pub(super) real: Float,
    pub(super) parts: &'m BTreeMap<&'a str, Part<'a>>,
    /// The bodies of functions that write their result into memory of the caller.
    pub(super) written: &'m BTreeMap<&'a str, Parser<'a>>,
    /// Whether the module has the fast sines.
    pub(super) fast: bool,
    /// Whether joints are coupled.
    pub(super) is_coupled: bool,
    /// Total number of steps and entries of all functions so far, across threads.
    pub(super) steps: AtomicUsize,
}

impl Shared<'_, '_> {
    /// Whether the functions together are longer than those of any robot.
    pub(super) fn is_too_long(&self) -> bool {
        self.steps.load(Relaxed) > MOST_STEPS
    }

    /// The message about that.
    pub(super) fn too_long() -> String {
        format!("functions of more than {MOST_STEPS} steps and entries in all")
    }
}

/// A function after reading.
#[derive(Debug)]
pub(super) struct Compiled<'a> {
    pub(super) program: Program,
    /// Private items it calls.
    pub(super) calls: BTreeSet<&'static str>,
    /// Parts it calls.
    pub(super) parts_called: BTreeSet<&'a str>,
}

type Scope<'a> = BTreeMap<&'a str, usize>;

struct Compiler<'a, 'm, 's> {
    shared: &'s Shared<'a, 'm>,
    parser: Parser<'a>,
    /// The arguments of the current function or part.
    arguments: Vec<Argument>,
    scope: Scope<'a>,
    program: Program,
    calls: BTreeSet<&'static str>,
    parts_called: BTreeSet<&'a str>,
    /// Number of parts called so far.
    parts: usize,
    /// Number of values defined before the current place; all if the text is read in order.
    given: usize,
}

impl<'a> Reads<'a> for Compiler<'a, '_, '_> {
    fn parser(&mut self) -> &mut Parser<'a> {
        &mut self.parser
    }
}

/// Reads a public function.
pub(super) fn compile<'a>(function: &Public<'a>, shared: &Shared<'a, '_>) -> Result<Compiled<'a>, Fault> {
    let program = Program {
        name: function.name.into(),
        arguments: function.arguments.clone(),
        steps: Vec::new(),
        literals: Vec::new(),
        turns: Vec::new(),
        outputs: Vec::new(),
    };
    let arguments = function.arguments.clone();
    let mut compiler = Compiler {
        shared,
        parser: function.body,
        arguments,
        scope: Scope::new(),
        program,
        calls: BTreeSet::new(),
        parts_called: BTreeSet::new(),
        parts: 0,
        given: usize::MAX,
    };
    match compiler.shared.written.get(function.name).copied().zip(Promise::of(function.name)) {
        Some((body, (promise, _))) => {
            compiler.parser.expect("{")?;
            let written = format!("{}{INTO}", function.name);
            compiler.parser.expect_lists(&of_module(
                function.name,
                compiler.shared.is_coupled,
                &promise.calls_written(&function.arguments, &written),
            ))?;
            compiler.parser.expect("result }")?;
            compiler.parser = body;
            compiler.parser.expect("{")?;
            compiler.written(promise.returned)?;
        }
        None => {
            compiler.parser.expect("{")?;
            while compiler.parser.is("let") {
                compiler.line()?;
            }
            compiler.result(String::new(), 0)?;
        }
    }
    compiler.parser.expect("}")?;
    let Compiler { program, calls, parts_called, .. } = compiler;
    Ok(Compiled { program, calls, parts_called })
}

/// The functions for a single sine or cosine.
const ALONE: [&str; 2] = ["sin_one", "cos_one"];

/// The name of a value.
fn value_name<'a>(token: &Token<'a>) -> Result<&'a str, Fault> {
    let rest = token.text.strip_prefix(['s', 'c', 't']).unwrap_or("");
    let fits = |b: u8| b.is_ascii_digit() || b.is_ascii_lowercase() || b == b'_';
    let is_name = rest.starts_with(|c: char| c.is_ascii_digit()) && rest.bytes().all(fits);
    if token.kind == Kind::Word && (is_name || !Check::Names.is_made()) {
        return Ok(token.text);
    }
    Err(token.fault(format!("{} where the name of a value can stand, such as t1, s2 or c2", token.shown())))
}

impl<'a> Compiler<'a, '_, '_> {
    fn push(&mut self, step: Step) -> Result<usize, Fault> {
        self.count()?;
        self.program.steps.push(step);
        Ok(self.program.steps.len() - 1)
    }

    fn count(&mut self) -> Result<(), Fault> {
        self.shared.steps.fetch_add(1, Relaxed);
        match self.shared.is_too_long() {
            true => Err(self.parser.peek().fault(Shared::too_long())),
            false => Ok(()),
        }
    }

    /// Assigns a name to a value; `_` assigns no name.
    fn bind(&mut self, name: &Token<'a>, value: usize) -> Result<(), Fault> {
        if name.is("_") {
            return Ok(());
        }
        match self.scope.insert(value_name(name)?, value) {
            Some(_) if Check::NamesOnce.is_made() => Err(name.fault(format!("{} is given twice", name.shown()))),
            _ => Ok(()),
        }
    }

    fn line(&mut self) -> Result<(), Fault> {
        self.parser.expect("let")?;
        match self.parser.peek().text {
            "_" => self.ignored(),
            "(" => self.waves(),
            "[" => self.call_of_part(),
            _ => {
                let name = self.parser.take()?;
                value_name(&name)?;
                self.parser.expect("=")?;
                let value = match ALONE.iter().position(|function| self.parser.is(function)) {
                    Some(which) => self.one_of_a_pair(which)?,
                    None => self.sum(0)?,
                };
                self.parser.expect(";")?;
                self.bind(&name, value)
            }
        }
    }

    /// An argument of the current function.
    fn argument(&mut self) -> Result<Argument, Fault> {
        let token = self.parser.take()?;
        let argument = Argument::named(token.text).filter(|argument| self.arguments.contains(argument));
        argument.ok_or_else(|| token.fault(format!("{} is not an argument of the function", token.shown())))
    }

    fn ignored(&mut self) -> Result<(), Fault> {
        self.parser.expect("_ =")?;
        if self.parser.eat("(")? {
            self.list(")", |own| own.argument().map(drop))?;
        } else {
            self.argument()?;
        }
        self.parser.expect(";")
    }

    /// Names or `_` up to the closing bracket, after the opening one.
    fn names(&mut self, close: &str) -> Result<Vec<Token<'a>>, Fault> {
        let mut names = Vec::new();
        self.list(close, |own| {
            let name = own.parser.take()?;
            if !name.is("_") {
                value_name(&name)?;
            }
            names.push(name);
            Ok(())
        })?;
        Ok(names)
    }

    /// A single sine or cosine.
    fn one_of_a_pair(&mut self, which: usize) -> Result<usize, Fault> {
        let function = self.parser.take()?;
        if !self.shared.fast {
            return Err(function.fault(format!("{} is a function of modules with fast sines", function.shown())));
        }
        self.calls.insert(ALONE[which]);
        self.parser.expect("(")?;
        let angle = self.angle()?;
        self.parser.eat(",")?;
        self.parser.expect(")")?;
        Ok(self.pair(angle)?[which])
    }

    /// Sine and cosine of an angle; they count as a pair even if only one is used.
    fn pair(&mut self, angle: Angle) -> Result<[usize; 2], Fault> {
        Ok([self.push(Step::Sine(angle.clone()))?, self.push(Step::Cosine(angle))?])
    }

    /// After `let`: the sines and cosines of one angle, or of several.
    fn waves(&mut self) -> Result<(), Fault> {
        self.parser.expect("(")?;
        let several = self.parser.is("[");
        let (sines, cosines) = if several {
            self.parser.expect("[")?;
            let sines = self.names("]")?;
            self.parser.expect(", [")?;
            let cosines = self.names("]")?;
            self.parser.eat(",")?;
            self.parser.expect(")")?;
            (sines, cosines)
        } else {
            let names = self.names(")")?;
            let &[sine, cosine] = names.as_slice() else {
                return Err(self.parser.peek().fault("a sine and a cosine have two names"));
            };
            (vec![sine], vec![cosine])
        };
        self.parser.expect("=")?;
        let function = self.parser.take()?;
        let known: &[(&'static str, usize)] = match (several, self.shared.fast) {
            (false, false) => &[("sin_cos", 1)],
            (false, true) => &[("sin_cos_one", 1)],
            (true, true) => &[("sin_cos_four", 4), ("sin_cos_eight", 8)],
            (true, false) => &[],
        };
        let Some(&(name, lanes)) = known.iter().find(|(name, _)| function.is(name)) else {
            return Err(function.fault(format!("{} is no function that gives these sines and cosines", function.shown())));
        };
        self.calls.insert(name);
        self.parser.expect("(")?;
        let mut count = 1;
        if several {
            let token = self.parser.take()?;
            count = integer(&token)?;
            if count > lanes || count == 0 {
                return Err(token.fault(format!("`{name}` does not take {count} angles")));
            }
            self.parser.expect(",")?;
        }
        let mut angles = Vec::new();
        self.list(")", |own| {
            angles.push(own.angle()?);
            Ok(())
        })?;
        if angles.len() != lanes || [&sines, &cosines].iter().any(|names| names.len() != lanes) {
            return Err(function.fault(format!("`{name}` takes {lanes} angles and gives as many sines and cosines")));
        }
        self.parser.expect(";")?;
        for (lane, angle) in angles.into_iter().enumerate() {
            // A processor without vectors omits the other lanes, so nothing may use them.
            if lane >= count {
                if let Some(name) =
                    [&sines[lane], &cosines[lane]].into_iter().find(|name| !name.is("_") && Check::Lanes.is_made())
                {
                    return Err(name.fault(format!("{} is of none of the first {count} angles", name.shown())));
                }
                continue;
            }
            let [sine, cosine] = self.pair(angle)?;
            self.bind(&sines[lane], sine)?;
            self.bind(&cosines[lane], cosine)?;
        }
        Ok(())
    }

    /// `q[1] + 0.7 * q[2] - q[3] + 0.5`: a sum of joint variables, perhaps times numbers, and a constant. Its steps belong to the function.
    fn angle(&mut self) -> Result<Angle, Fault> {
        let mut angle = Angle::default();
        let mut sum = None;
        loop {
            let minus = sum.is_some() && self.parser.eat("-")?;
            if sum.is_some() && !minus {
                self.parser.expect("+")?;
            }
            let place = self.parser.peek();
            let mut scale = None;
            if place.kind == Kind::Number {
                let step = self.literal()?;
                let literal = self.program.literals.len() - 1;
                if sum.is_some() && !self.parser.is("*") {
                    self.program.turns.push(literal);
                    angle.turn = Some((self.program.turns.len() - 1, minus));
                } else {
                    self.parser.expect("*")?;
                }
                scale = Some((step, literal));
            }
            let term = if let (Some((step, _)), Some(_)) = (scale, angle.turn) {
                step
            } else {
                let (argument, joint, entry) = self.entry()?;
                let factor = if minus { -1 } else { 1 };
                // Rounding depends on the order, so the order is fixed: added joints first.
                let follows = angle.terms.last().is_none_or(|&(last, before)| (-before, last) < (-factor, joint));
                let new = angle.terms.iter().all(|(other, _)| *other != joint);
                if argument != Argument::Q || !(follows && new || !Check::Angles.is_made()) {
                    return Err(place.fault("an angle is a sum of joint variables in their order, those taken away last"));
                }
                angle.terms.push((joint, factor));
                angle.factors.push(scale.map(|(_, literal)| literal));
                match scale {
                    Some((step, _)) => self.push(Step::Multiply(step, entry))?,
                    None => entry,
                }
            };
            sum = Some(match sum {
                None => term,
                Some(before) if minus => self.push(Step::Subtract(before, term))?,
                Some(before) => self.push(Step::Add(before, term))?,
            });
            if angle.turn.is_some() || !(self.parser.is("+") || self.parser.is("-")) {
                return Ok(angle.sorted());
            }
        }
    }

    /// `q[3]`
    fn entry(&mut self) -> Result<(Argument, usize, usize), Fault> {
        let argument = self.argument()?;
        self.parser.expect("[")?;
        let index = integer(&self.parser.take()?)?;
        self.parser.expect("]")?;
        Ok((argument, index, self.push(Step::Input(argument, index))?))
    }

    fn literal(&mut self) -> Result<usize, Fault> {
        let literal = decimal(&self.parser.take()?, self.shared.real)?;
        self.program.literals.push(literal);
        self.push(Step::Literal(self.program.literals.len() - 1))
    }

    fn sum(&mut self, brackets: usize) -> Result<usize, Fault> {
        let mut sum = self.product(brackets)?;
        loop {
            let plus = self.parser.is("+");
            if !plus && !self.parser.is("-") {
                return Ok(sum);
            }
            self.parser.take()?;
            let term = self.product(brackets)?;
            sum = self.push(if plus { Step::Add(sum, term) } else { Step::Subtract(sum, term) })?;
        }
    }

    fn product(&mut self, brackets: usize) -> Result<usize, Fault> {
        let mut product = self.factor(brackets)?;
        loop {
            let times = self.parser.is("*");
            if !times && !self.parser.is("/") {
                return Ok(product);
            }
            self.parser.take()?;
            let factor = self.factor(brackets)?;
            product = self.push(if times { Step::Multiply(product, factor) } else { Step::Divide(product, factor) })?;
        }
    }

    /// Checks that a bracket may open inside this number of others.
    fn not_too_deep(&self, brackets: usize) -> Result<(), Fault> {
        match brackets == MOST_BRACKETS && Check::Brackets.is_made() {
            true => Err(self.parser.peek().fault(format!("brackets in more than {MOST_BRACKETS} others"))),
            false => Ok(()),
        }
    }

    /// `Real::mul_add(a, b, c)`: an unrounded product, and its sum with a third operand.
    fn fused(&mut self, brackets: usize) -> Result<usize, Fault> {
        let place = self.parser.peek();
        self.not_too_deep(brackets)?;
        self.parser.expect("Real::mul_add(")?;
        let mut operands = Vec::new();
        self.list(")", |own| {
            operands.push(own.sum(brackets + 1)?);
            Ok(())
        })?;
        let &[a, b, c] = operands.as_slice() else {
            return Err(place.fault("`Real::mul_add` takes two factors and what is added to their product"));
        };
        let product = self.push(Step::Product(a, b))?;
        self.push(Step::Add(product, c))
    }

    fn factor(&mut self, brackets: usize) -> Result<usize, Fault> {
        let negative = self.parser.eat("-")?;
        let token = self.parser.peek();
        let value = match token.kind {
            Kind::Number => self.literal()?,
            Kind::Word if token.is("sign") => {
                self.not_too_deep(brackets)?;
                self.parser.expect("sign(")?;
                let of = self.sum(brackets + 1)?;
                self.parser.expect(")")?;
                self.calls.insert("sign");
                self.push(match self.program.steps[of] {
                    Step::Input(Argument::Dq, joint) => Step::Sign(joint),
                    _ => Step::SignOf(of),
                })?
            }
            Kind::Word if token.is("stribeck") => {
                self.parser.expect("stribeck(")?;
                let place = self.parser.peek();
                let (argument, joint, _) = self.entry()?;
                if argument != Argument::Dq && Check::Signs.is_made() {
                    return Err(place.fault("Stribeck friction of something that is not a joint rate"));
                }
                self.parser.expect(",")?;
                let velocity = self.program.literals.len();
                self.literal()?;
                self.parser.expect(")")?;
                self.calls.insert("stribeck");
                self.push(Step::Stribeck(joint, velocity))?
            }
            Kind::Word if token.is("Real") => self.fused(brackets)?,
            Kind::Word if Argument::named(token.text).is_some() => self.entry()?.2,
            Kind::Word => {
                self.parser.take()?;
                self.value_of(&token)?
            }
            _ if token.is("(") => {
                self.not_too_deep(brackets)?;
                self.parser.take()?;
                let inner = self.sum(brackets + 1)?;
                self.parser.expect(")")?;
                inner
            }
            _ => return Err(token.fault(format!("{} where a number, a name or a bracket can stand", token.shown()))),
        };
        if negative {
            self.push(Step::Negate(value))
        } else {
            Ok(value)
        }
    }

    fn value_of(&self, name: &Token<'a>) -> Result<usize, Fault> {
        let value = self.scope.get(name.text).copied().filter(|&value| value < self.given);
        value.ok_or_else(|| name.fault(format!("{} is not a value that is given before", name.shown())))
    }

    /// After `let`: `[t1, t2] = gravity_part_1(q, [c1, t3]);`. The lines of the part are read as if they were here.
    fn call_of_part(&mut self) -> Result<(), Fault> {
        self.parser.expect("[")?;
        let given = self.names("]")?;
        self.parser.expect("=")?;
        let name = self.parser.take()?;
        let expected = format!("{}_part_{}", self.program.name, self.parts + 1);
        let Some(part) = self.shared.parts.get(name.text).filter(|_| name.is(&expected)) else {
            return Err(name.fault(format!("{} where only part `{expected}` can be called", name.shown())));
        };
        self.parts += 1;
        self.parts_called.insert(name.text);
        self.parser.expect("(")?;
        for wanted in &part.arguments {
            let place = self.parser.peek();
            if self.argument()? != *wanted {
                return Err(place.fault(format!("{} is not the argument that `{expected}` takes here", place.shown())));
            }
            self.parser.expect(",")?;
        }
        self.parser.expect("[")?;
        let taken = self.values("]")?;
        self.parser.eat(",")?;
        self.parser.expect(");")?;
        if [taken.len(), given.len()] != part.counts {
            return Err(name.fault(format!("`{expected}` takes and gives other numbers of values")));
        }

        let caller = std::mem::replace(&mut self.parser, part.body);
        let scope = std::mem::take(&mut self.scope);
        let arguments = std::mem::replace(&mut self.arguments, part.arguments.clone());
        self.parser.expect("{ let [")?;
        let names = self.names("]")?;
        self.parser.expect("= values;")?;
        if names.len() != taken.len() {
            return Err(name.fault(format!("`{expected}` does not name the values that it takes")));
        }
        names.iter().zip(taken).try_for_each(|(name, value)| self.bind(name, value))?;
        while self.parser.is("let") {
            self.parser.take()?;
            let name = self.parser.take()?;
            value_name(&name)?;
            self.parser.expect("=")?;
            let value = self.sum(0)?;
            self.parser.expect(";")?;
            self.bind(&name, value)?;
        }
        self.parser.expect("[")?;
        let values = self.values("]")?;
        self.parser.expect("}")?;
        if values.len() != given.len() {
            return Err(name.fault(format!("`{expected}` does not give the values that it should")));
        }
        (self.parser, self.scope, self.arguments) = (caller, scope, arguments);
        given.iter().zip(values).try_for_each(|(name, value)| self.bind(name, value))
    }

    /// Values by name up to the closing bracket, after the opening one.
    fn values(&mut self, close: &str) -> Result<Vec<usize>, Fault> {
        let mut values = Vec::new();
        self.list(close, |own| {
            let name = own.parser.take()?;
            values.push(own.value_of(&name)?);
            Ok(())
        })?;
        Ok(values)
    }

    /// Lines, result entries and barriers up to the end: `by_q[0][1] = t1;`. Entries are read after all lines, in the order of a returned result. So
    /// the steps and literals of an entry have the same numbers in the program wherever the entry is written.
    fn written(&mut self, returned: Returned) -> Result<(), Fault> {
        let (named, accesses) = (returned.named(), returned.accesses());
        // The place of each entry, and the number of values defined before it.
        let mut entries: BTreeMap<(usize, [usize; MOST_INDICES]), (Parser<'a>, usize)> = BTreeMap::new();
        while !self.parser.is("}") {
            if self.parser.is("let") {
                self.line()?;
                continue;
            }
            let name = self.parser.take()?;
            if name.is("barrier") {
                self.parser.expect("();")?;
                self.calls.insert("barrier");
                continue;
            }
            let part = named.iter().position(|(part, _)| name.is(part));
            let part = part.ok_or_else(|| name.fault(format!("{} is no line and no part of the result", name.shown())))?;
            let mut indices = [0; MOST_INDICES];
            for (index, _) in indices.iter_mut().zip(named[part].1) {
                self.parser.expect("[")?;
                *index = integer(&self.parser.take()?)?;
                self.parser.expect("]")?;
            }
            self.parser.expect("=")?;
            self.count()?;
            let entry = (self.parser, self.program.steps.len());
            if entries.insert((part, indices), entry).is_some() && Check::WrittenOnce.is_made() {
                return Err(name.fault(format!("an entry of {} is written twice", name.shown())));
            }
            while !self.parser.is(";") && self.parser.peek().kind != Kind::End {
                self.parser.take()?;
            }
            self.parser.expect(";")?;
        }
        let end = self.parser;
        for ((part, indices), (beginning, before)) in entries {
            (self.parser, self.given) = (beginning, before);
            let step = self.sum(0)?;
            self.parser.expect(";")?;
            let indices = indices.iter().zip(named[part].1).map(|(index, _)| format!("[{index}]"));
            let place = accesses[part].clone() + &indices.collect::<String>();
            self.program.outputs.push(Output { place, step });
        }
        self.parser = end;
        Ok(())
    }

    /// A returned result, or a row of it.
    fn result(&mut self, place: String, brackets: usize) -> Result<(), Fault> {
        if brackets == MOST_BRACKETS {
            return Err(self.parser.peek().fault(format!("brackets in more than {MOST_BRACKETS} others")));
        }
        let start = self.parser;
        let mut index = 0;
        if self.parser.eat("[")? {
            return self.list("]", |own| {
                index += 1;
                own.result(format!("{place}[{}]", index - 1), brackets + 1)
            });
        }
        if self.parser.eat("(")? && self.parser.is("[") {
            self.list(")", |own| {
                index += 1;
                own.result(format!("{place}.{}", index - 1), brackets + 1)
            })?;
            return match index {
                1 => Err(start.peek().fault("a result in brackets of its own")),
                _ => Ok(()),
            };
        }
        self.parser = start;
        if self.parser.is("EquationsOfMotion") {
            self.parser.expect("EquationsOfMotion {")?;
            for (i, field) in ["inertia", "coriolis", "gravity"].into_iter().enumerate() {
                if i > 0 {
                    self.parser.expect(",")?;
                }
                self.parser.expect(field)?;
                self.parser.expect(":")?;
                self.result(format!("{place}.{field}"), brackets + 1)?;
            }
            self.parser.eat(",")?;
            return self.parser.expect("}");
        }
        self.count()?;
        let step = self.sum(0)?;
        self.program.outputs.push(Output { place, step });
        Ok(())
    }
}
