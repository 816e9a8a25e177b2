//! Reads a Python module.
//!
//! ```text
//! module   = imports names constants arrays [ sines ] [ sign ] [ stribeck ] { [ class ] { part } function }
//! function = def NAME(ARGUMENTS) -> TYPE:  xp, shape, (ARGUMENTS,) = _enter(("ARGUMENT", ARGUMENT, LENGTH), ...)
//!            if _many(xp, shape, (ARGUMENTS,)):  return _in_blocks(xp, shape, NAME, (ARGUMENTS,))  [ waves ] { line } { call { line } } result
//! waves    = sine, cosine = _sin_cos(xp, (ANGLES,))  { NAME = sine[I] | NAME = cosine[I] }     `_` for one that no line takes
//! line     = NAME = SUM
//! call     = given_K = _NAME_part_K(xp, ARGUMENTS, (NAMES,))  { NAME = given_K[I] }
//! result   = return ARRAY | return TYPE( { ARRAY, } )            ARRAY = _leave(xp, ARGUMENT, shape, (LENGTHS,), ( { SUM, } ))
//! ```

use std::collections::BTreeMap;

use armgen_description::language::Language;

use super::parameters::{has_payload, names, PYTHON_INDEX, PYTHON_PAYLOAD};
use super::plain::{
    in_order, is_of_some_arms, names_of, promised, sizes, Body, Comments, Constants, Functions, Lines, Parts, Syntax, CONSTANTS,
};
use super::{Constant, Fault, Function, Module};
use crate::values::contract::{of_module, Length, Promise, Returned, Sizes};
use crate::values::enclosure::Float;

pub(super) const COMMENTS: Comments = Comments { line: Some("#"), block: Some(("    \"\"\"", "\"\"\"")), behind: ":" };

const ARRAYS: &str = include_str!("python/arrays.py");
const SIGN: &str = include_str!("python/sign.py");
const STRIBECK: &str = include_str!("python/stribeck.py");
const STD: &str = include_str!("python/std.py");
const FAST_F64: &str = include_str!("python/sines_f64.py");
const FAST_F32: &str = include_str!("python/sines_f32.py");

fn tuple(entries: &[String]) -> String {
    match entries {
        [] => "()".into(),
        entries => format!("({},)", entries.join(", ")),
    }
}

/// The entries of a tuple in its source form.
fn entries(text: &str, line: usize) -> Result<Vec<&str>, Fault> {
    let inner = match text {
        "()" => return Ok(Vec::new()),
        text => text.strip_prefix('(').and_then(|text| text.strip_suffix(",)")),
    };
    let inner = inner.ok_or_else(|| Fault { line, reason: format!("`{text}` where a tuple can stand") })?;
    Ok(inner.split(", ").collect())
}

/// The result type of a function with several results.
pub(crate) fn structure(promise: &Promise) -> Option<String> {
    let capital = |word: &str| word[..1].to_uppercase() + &word[1..];
    (!matches!(promise.returned, Returned::One(_))).then(|| promise.name.split('_').map(capital).collect())
}

/// Reads a module.
pub(super) fn read(text: &str) -> Result<Module, Fault> {
    let mut lines = Lines::new(text, COMMENTS)?;
    let head = text.split('\n').map_while(|line| line.strip_prefix('#')).map(String::from).collect();
    lines.expect("from __future__ import annotations")?;
    lines.expect("from typing import Any, Callable, Final, NamedTuple, TypeVar")?;
    let list = lines.number();
    lines.expect("__all__ = [")?;
    let mut public = Vec::new();
    while !lines.is("]") {
        public.push(lines.between("    \"", "\",")?);
    }
    lines.expect("]")?;
    let real = match lines.all.iter().find_map(|line| line.text.strip_prefix("DTYPE: Final = ")) {
        Some("\"float64\"") => Float::F64,
        Some("\"float32\"") => Float::F32,
        _ => return Err(lines.fault("the module has no type of its numbers")),
    };
    let form = Constants {
        real,
        suffix: "",
        quotes: '"',
        list: |_, _| ["(", ", ", ",)", "()"],
        truth: ["False", "True"],
        infinity: "float(\"inf\")",
    };
    let read = in_order(CONSTANTS.map(|(name, ..)| name), |name| {
        let begin = format!("{name}: Final = ");
        if is_of_some_arms(name) && !lines.peek().starts_with(&begin) {
            return Ok(None);
        }
        let number = lines.number();
        let value = lines.between(&begin, "")?;
        form.read(name, value, number).map(Some)
    })?;
    let order: Vec<String> = read.iter().map(|(name, _)| name.clone()).collect();
    let constants: BTreeMap<String, Constant> = read.into_iter().collect();
    let sizes = sizes(&constants)?;
    let indexed = !names(&constants).is_empty();
    if indexed {
        lines.expect_all(PYTHON_INDEX, COMMENTS)?;
    }
    lines.at += 1;
    lines.expect_all(ARRAYS, COMMENTS)?;
    let mut trig = None;
    for (block, name) in [(if real == Float::F64 { FAST_F64 } else { FAST_F32 }, "fast"), (STD, "std")] {
        let own = Lines::new(block, COMMENTS)?;
        // They have the same first line.
        let second = |lines: &Lines<'_>, at: usize| lines.all.get(at + 1).map(|line| line.text.to_string());
        if trig.is_none() && lines.is(own.peek()) && second(&lines, lines.at) == second(&own, 0) {
            lines.expect_all(block, COMMENTS)?;
            trig = Some(name);
        }
    }
    let sign = lines.is(Lines::new(SIGN, COMMENTS)?.peek());
    if sign {
        lines.expect_all(SIGN, COMMENTS)?;
    }
    let stribeck = lines.is(Lines::new(STRIBECK, COMMENTS)?.peek());
    if stribeck {
        lines.expect_all(STRIBECK, COMMENTS)?;
    }
    let loaded = has_payload(&constants);
    if loaded {
        lines.expect_all(PYTHON_PAYLOAD, COMMENTS)?;
    }
    let syntax = Syntax {
        index: ("[", "]"),
        first: 0,
        operators: [" * ", " / "],
        suffix: "",
        sign: "_sign(xp, ".into(),
        stribeck: "_stribeck(xp, ".into(),
        fused: None,
        define: ["    ".into(), " = ".into(), String::new()],
        list: ("[", "]"),
        angles: ", ",
    };
    let mut reader =
        Reader { syntax: &syntax, real, sizes, parts: Parts::default(), structures: Vec::new(), steps: 0, asks: [false; 3] };
    let functions = reader.all(&mut lines, "", [trig.is_some(), sign, stribeck])?;
    let named = constants.len() + 1;
    let mut wanted: Vec<String> = order.into_iter().chain(indexed.then(|| "PARAMETER_INDEX".into())).collect();
    wanted.extend(["DTYPE".into(), "by_joint".into()]);
    wanted.extend(loaded.then(|| "payload_parameters".into()));
    wanted.extend(reader.structures.iter().cloned());
    wanted.extend(functions.iter().map(|(name, _)| name.clone()));
    if public != wanted {
        let reason =
            format!("`__all__` does not list the {named} constants, the types of results and the functions of the module");
        return Err(Fault { line: list, reason });
    }
    Ok(Module { real, trig, head, constants, functions, ..Module::empty(Language::Python) })
}

struct Reader<'a, 'r> {
    syntax: &'r Syntax,
    real: Float,
    sizes: Sizes,
    parts: Parts<'a>,
    structures: Vec<String>,
    steps: usize,
    asks: [bool; 3],
}

impl<'a> Functions<'a> for Reader<'a, '_> {
    fn unused(&self) -> Option<&'a str> {
        self.parts.unused()
    }

    fn asks(&self) -> [bool; 3] {
        self.asks
    }

    fn item(&mut self, lines: &mut Lines<'a>) -> Result<Option<(String, Function)>, Fault> {
        if lines.peek().starts_with("class ") {
            self.class(lines)?;
            return Ok(None);
        }
        if lines.peek().starts_with("def _") {
            self.part(lines)?;
            return Ok(None);
        }
        let line = lines.number();
        let name = lines.peek().strip_prefix("def ").and_then(|rest| rest.split('(').next()).unwrap_or_default();
        self.sizes = self.sizes.of_function(name);
        let known = promised(name, &self.sizes);
        let (promise, arguments) =
            known.ok_or_else(|| Fault { line, reason: format!("`{name}` is not a function that an emitted module has") })?;
        let names: Vec<String> = arguments.iter().map(|a| a.name().to_string()).collect();
        let signature: Vec<String> = names.iter().map(|name| format!("{name}: Any")).collect();
        let structure = structure(promise);
        let returns = structure.as_deref().unwrap_or("Any");
        lines.expect(&format!("def {name}({}) -> {returns}:", signature.join(", ")))?;
        let documentation = lines.all.get(lines.at).map_or(Vec::new(), |line| line.comment.clone());
        let documentation = documentation.into_iter().map(String::from).collect();
        let entered = arguments.iter().map(|argument| {
            let length = argument.length().rust();
            format!("(\"{0}\", {0}, {length})", argument.name())
        });
        let entered: Vec<String> = entered.collect();
        lines.expect(&format!("    xp, shape, {} = _enter({})", tuple(&names), entered.join(", ")))?;
        lines.expect(&format!("    if _many(xp, shape, {}):", tuple(&names)))?;
        lines.expect(&format!("        return _in_blocks(xp, shape, {name}, {})", tuple(&names)))?;
        let mut body = Body::new(name, arguments, self.syntax, self.real, self.steps);
        let forms = [["sine", "cosine"], ["sine", "_"], ["_", "cosine"]];
        let form = forms.into_iter().find(|[s, c]| lines.peek().starts_with(&format!("    {s}, {c} = ")));
        if let Some([sines, cosines]) = form {
            let line = lines.number();
            let angles = lines.between(&format!("    {sines}, {cosines} = _sin_cos(xp, ("), ",))")?;
            let mut taken = [false; 2];
            for (i, (sine, cosine)) in body.angles(angles, line)?.into_iter().enumerate() {
                let first = body.element(lines, &format!("{sines}[{i}]"), sine)?;
                let second = body.element(lines, &format!("{cosines}[{i}]"), cosine)?;
                if !first && !second {
                    return Err(lines.fault(format!("neither the sine nor the cosine of angle {i} has a name")));
                }
                taken = [taken[0] || first, taken[1] || second];
            }
            if taken != [sines, cosines].map(|name| name != "_") {
                let reason = format!("`{sines}, {cosines}` where `_` stands for what no line takes, and for nothing else");
                return Err(Fault { line, reason });
            }
        }
        body.definitions(lines)?;
        let mut calls = 0;
        while self.call(lines, &mut body, name, calls + 1)? {
            calls += 1;
            body.definitions(lines)?;
        }
        match promise.returned {
            Returned::One(lengths) => self.array(lines, &mut body, ["    return ", "    ", ""], &names[0], lengths, "")?,
            returned => {
                lines.expect(&format!("    return {returns}("))?;
                for ((_, lengths), access) in returned.named().into_iter().zip(returned.accesses()) {
                    self.array(lines, &mut body, ["        ", "        ", ","], &names[0], lengths, &access)?;
                }
                lines.expect("    )")?;
            }
        }
        self.steps = body.steps();
        (0..3).for_each(|k| self.asks[k] |= body.asks[k]);
        Ok(Some((name.into(), Function { documentation, program: body.program })))
    }
}

impl<'a> Reader<'a, '_> {
    /// An array with an entry per line: its beginning, its indent, its end.
    fn array(
        &self,
        lines: &mut Lines<'a>,
        body: &mut Body<'a, '_>,
        [begin, indent, end]: [&str; 3],
        like: &str,
        lengths: &'static [Length],
        access: &str,
    ) -> Result<(), Fault> {
        let dimensions: Vec<String> =
            lengths.iter().map(|length| of_module(&body.program.name, self.sizes.joints.is_some(), &length.rust())).collect();
        lines.expect(&format!("{begin}_leave(xp, {like}, shape, {}, (", tuple(&dimensions)))?;
        for place in Returned::One(lengths).places(&self.sizes) {
            let line = lines.number();
            let value = lines.between(&format!("{indent}    "), ",")?;
            body.output(format!("{access}{place}"), value, line)?;
        }
        lines.expect(&format!("{indent})){end}"))
    }

    /// A type for several results.
    fn class(&mut self, lines: &mut Lines<'a>) -> Result<(), Fault> {
        let name = lines.between("class ", "(NamedTuple):")?;
        let promise = names_of(&self.sizes)
            .filter_map(|own| promised(&own, &self.sizes))
            .find(|(promise, _)| structure(promise).as_deref() == Some(name));
        let (promise, _) = promise.ok_or_else(|| lines.fault(format!("`{name}` is no type of results")))?;
        for (field, _) in promise.returned.named() {
            lines.expect(&format!("    {field}: Any"))?;
        }
        if self.structures.iter().any(|other| other == name) {
            return Err(lines.fault(format!("`{name}` stands twice")));
        }
        self.structures.push(name.into());
        Ok(())
    }

    /// The head of a part; its lines are read at its call.
    fn part(&mut self, lines: &mut Lines<'a>) -> Result<(), Fault> {
        let line = lines.number();
        let text = lines.between("def _", "taken: tuple[Any, ...]) -> tuple[Any, ...]:")?;
        let (name, arguments) = text.split_once("(xp: Any, ").unwrap_or_default();
        let arguments: Vec<&str> = arguments.split(": Any, ").filter(|name| !name.is_empty()).collect();
        let body = lines.at;
        while !lines.peek().starts_with("    return ") {
            if lines.ended() || !lines.peek().starts_with("    ") {
                return Err(lines.fault("a part does not end"));
            }
            lines.at += 1;
        }
        lines.at += 1;
        self.parts.add(name, arguments, body, line)
    }

    /// The call of a part; its lines are read as if they were here.
    fn call(&mut self, lines: &mut Lines<'a>, body: &mut Body<'a, '_>, function: &str, number: usize) -> Result<bool, Fault> {
        let name = format!("{function}_part_{number}");
        let begin = format!("    given_{number} = _{name}(xp, ");
        if !lines.peek().starts_with(&begin) {
            return Ok(false);
        }
        let line = lines.number();
        let passed = self.parts.passed(&name, lines)?;
        let names = entries(lines.between(&format!("{begin}{passed}"), ")")?, line)?;
        let results = |lines: &mut Lines<'a>| {
            let line = lines.number();
            entries(lines.between("    return ", "")?, line)
        };
        self.parts.take_in(&name, lines, body, (names, line), results, &format!("given_{number}"))?;
        Ok(true)
    }
}
