//! Reads a JavaScript module.
//!
//! ```text
//! module   = constants check [ sines ] [ sign ] [ stribeck ] { { part } function }
//! function = export function NAME(ARGUMENTS) { { check("ARGUMENT", ARGUMENT, LENGTH); } { wave } { line } { call { line } } result }
//! wave     = sinCos(ANGLE);  { const NAME = wave[0]; | const NAME = wave[1]; }
//! line     = const NAME = SUM;
//! call     = const givenK = NAMEPartK(ARGUMENTS, [NAMES]);  { const NAME = givenK[I]; }
//! result   = return SUM; | return ARRAY; | return { { FIELD: ARRAY, } };          ARRAY = [SUMS] or rows, each in lines of its own
//! ```

use std::collections::BTreeMap;

use armgen_description::language::Language;

use super::parameters::{has_payload, names, JAVASCRIPT_INDEX, JAVASCRIPT_PAYLOAD};
use super::plain::{
    camel, in_order, is_of_some_arms, names_of, promised, sizes, Body, Comments, Constants, Functions, Lines, Parts, Syntax,
    CONSTANTS,
};
use super::{Constant, Fault, Function, Module};
use crate::values::contract::{Length, Returned, Sizes};
use crate::values::enclosure::Float;

pub(super) const COMMENTS: Comments = Comments { line: Some("//"), block: Some(("/**", "*/")), behind: "" };

const CHECK: &str = include_str!("javascript/check.mjs");
const SIGN: &str = include_str!("javascript/sign.mjs");
const STRIBECK: &str = include_str!("javascript/stribeck.mjs");
const STD: &str = include_str!("javascript/std.mjs");
const FAST: &str = include_str!("javascript/sines.mjs");

fn comment(lines: &[&str]) -> Vec<String> {
    lines.iter().map(|line| line.strip_prefix(" *").unwrap_or(line).to_string()).filter(|line| !line.is_empty()).collect()
}

/// Reads a module.
pub(super) fn read(text: &str) -> Result<Module, Fault> {
    let mut lines = Lines::new(text, COMMENTS)?;
    let head = text.split('\n').map_while(|line| line.strip_prefix("//")).map(String::from).collect();
    let form = Constants {
        real: Float::F64,
        suffix: "",
        quotes: '"',
        list: |_, _| ["Object.freeze([", ", ", "])", "Object.freeze([])"],
        truth: ["false", "true"],
        infinity: "Infinity",
    };
    let read = in_order(CONSTANTS.map(|(name, ..)| name), |name| {
        let begin = format!("export const {name} = ");
        if is_of_some_arms(name) && !lines.peek().starts_with(&begin) {
            return Ok(None);
        }
        let number = lines.number();
        let value = lines.between(&begin, ";")?;
        form.read(name, value, number).map(Some)
    })?;
    let constants: BTreeMap<String, Constant> = read.into_iter().collect();
    let sizes = sizes(&constants)?;
    if !names(&constants).is_empty() {
        lines.expect_all(JAVASCRIPT_INDEX, COMMENTS)?;
    }
    lines.expect_all(CHECK, COMMENTS)?;
    let begins = |lines: &Lines<'_>, block: &str, skip: usize| {
        let block = Lines::new(block, COMMENTS)?;
        let wanted = block.all.get(skip).map_or("", |line| line.text);
        Ok::<bool, Fault>(lines.all.get(lines.at + skip).is_some_and(|line| line.text == wanted))
    };
    let mut trig = None;
    if begins(&lines, FAST, 0)? {
        // The two blocks have the same first lines.
        let fast = begins(&lines, FAST, 2)?;
        trig = Some(if fast { "fast" } else { "std" });
        lines.expect_all(if fast { FAST } else { STD }, COMMENTS)?;
    }
    let sign = begins(&lines, SIGN, 0)?;
    if sign {
        lines.expect_all(SIGN, COMMENTS)?;
    }
    let stribeck = begins(&lines, STRIBECK, 0)?;
    if stribeck {
        lines.expect_all(STRIBECK, COMMENTS)?;
    }
    if has_payload(&constants) {
        lines.expect_all(JAVASCRIPT_PAYLOAD, COMMENTS)?;
    }
    let syntax = Syntax {
        index: ("[", "]"),
        first: 0,
        operators: [" * ", " / "],
        suffix: "",
        sign: "sign(".into(),
        stribeck: "stribeck(".into(),
        fused: None,
        define: ["    const ".into(), " = ".into(), ";".into()],
        list: ("[", "]"),
        angles: ", ",
    };
    let mut reader = Reader { syntax: &syntax, sizes, parts: Parts::default(), steps: 0, asks: [false; 3] };
    let functions = reader.all(&mut lines, "", [trig.is_some(), sign, stribeck])?;
    Ok(Module { trig, head, constants, functions, ..Module::empty(Language::JavaScript) })
}

struct Reader<'a, 'r> {
    syntax: &'r Syntax,
    sizes: Sizes,
    parts: Parts<'a>,
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
        if lines.peek().starts_with("function ") {
            self.part(lines)?;
            return Ok(None);
        }
        let documentation = lines.all.get(lines.at).map_or(Vec::new(), |line| comment(&line.comment));
        let line = lines.number();
        let (name, names) = lines.between("export function ", ") {")?.split_once('(').unwrap_or_default();
        let known = names_of(&self.sizes).find(|known| camel(known) == name);
        let (own, (promise, arguments)) = known
            .and_then(|own| Some((own.clone(), promised(&own, &self.sizes)?)))
            .ok_or_else(|| Fault { line, reason: format!("`{name}` is not a function that an emitted module has") })?;
        self.sizes = self.sizes.of_function(&own);
        let wanted: Vec<&str> = arguments.iter().map(|a| a.name()).collect();
        if names != wanted.join(", ") {
            return Err(Fault { line, reason: format!("`{name}` takes ({}), not ({names})", wanted.join(", ")) });
        }
        for argument in &arguments {
            let length = argument.length().rust();
            lines.expect(&format!("    check(\"{0}\", {0}, {length});", argument.name()))?;
        }
        let mut body = Body::new(&own, arguments, self.syntax, Float::F64, self.steps);
        while lines.peek().starts_with("    sinCos(") {
            let line = lines.number();
            let waves = body.angles(lines.between("    sinCos(", ");")?, line)?;
            let &[(sine, cosine)] = waves.as_slice() else {
                return Err(Fault { line, reason: "one angle is asked for at a time".into() });
            };
            let first = body.element(lines, "wave[0]", sine)?;
            let second = body.element(lines, "wave[1]", cosine)?;
            if !first && !second {
                return Err(lines.fault("neither the sine nor the cosine of an angle has a name"));
            }
        }
        body.definitions(lines)?;
        let mut calls = 0;
        while self.call(lines, &mut body, name, calls + 1)? {
            calls += 1;
            body.definitions(lines)?;
        }
        match promise.returned {
            Returned::One(lengths) => self.array(lines, &mut body, "    return ", "    ", ";", lengths, String::new())?,
            returned => {
                lines.expect("    return {")?;
                let places = returned.accesses();
                for ((field, lengths), access) in returned.named().into_iter().zip(places) {
                    let begin = format!("        {}: ", camel(&field));
                    self.array(lines, &mut body, &begin, "        ", ",", lengths, access)?;
                }
                lines.expect("    };")?;
            }
        }
        lines.expect("}")?;
        self.steps = body.steps();
        (0..3).for_each(|k| self.asks[k] |= body.asks[k]);
        Ok(Some((own, Function { documentation, program: body.program })))
    }
}

impl<'a> Reader<'a, '_> {
    /// A number, or an array with a row per line.
    #[expect(clippy::too_many_arguments, reason = "how a line begins, goes on and ends, and what stands there")]
    fn array(
        &self,
        lines: &mut Lines<'a>,
        body: &mut Body<'a, '_>,
        begin: &str,
        indent: &str,
        end: &str,
        lengths: &[Length],
        place: String,
    ) -> Result<(), Fault> {
        let line = lines.number();
        match lengths {
            [] => {
                let value = lines.between(begin, end)?;
                body.output(place, value, line)
            }
            [length] => {
                let inner = lines.between(&format!("{begin}["), &format!("]{end}"))?;
                let values: Vec<&str> = if inner.is_empty() { Vec::new() } else { inner.split(", ").collect() };
                let wanted = length.of(&self.sizes);
                if values.len() != wanted {
                    return Err(Fault { line, reason: format!("{} entries where {wanted} are wanted", values.len()) });
                }
                values.into_iter().enumerate().try_for_each(|(i, value)| body.output(format!("{place}[{i}]"), value, line))
            }
            [outer, inner @ ..] => {
                lines.expect(&format!("{begin}["))?;
                let deeper = format!("{indent}    ");
                for i in 0..outer.of(&self.sizes) {
                    self.array(lines, body, &deeper, &deeper, ",", inner, format!("{place}[{i}]"))?;
                }
                lines.expect(&format!("{indent}]{end}"))
            }
        }
    }

    /// The head of a part; its lines are read at its call.
    fn part(&mut self, lines: &mut Lines<'a>) -> Result<(), Fault> {
        let line = lines.number();
        let (name, arguments) = lines.between("function ", ") {")?.split_once('(').unwrap_or_default();
        let mut arguments: Vec<&str> = arguments.split(", ").collect();
        if arguments.pop() != Some("taken") {
            return Err(Fault { line, reason: "a part takes values, as its last argument".into() });
        }
        let body = lines.at;
        while !lines.is("}") {
            if lines.ended() {
                return Err(lines.fault("the text is cut off"));
            }
            lines.at += 1;
        }
        lines.expect("}")?;
        self.parts.add(name, arguments, body, line)
    }

    /// The call of a part; its lines are read as if they were here.
    fn call(&mut self, lines: &mut Lines<'a>, body: &mut Body<'a, '_>, function: &str, number: usize) -> Result<bool, Fault> {
        let begin = format!("    const given{number} = {function}Part{number}(");
        if !lines.peek().starts_with(&begin) {
            return Ok(false);
        }
        let line = lines.number();
        let name = format!("{function}Part{number}");
        let passed = self.parts.passed(&name, lines)?;
        let names = lines.between(&format!("{begin}{passed}["), "]);")?;
        let names: Vec<&str> = if names.is_empty() { Vec::new() } else { names.split(", ").collect() };
        let results = |lines: &mut Lines<'a>| {
            let names = lines.between("    return [", "];")?.split(", ").collect();
            lines.expect("}")?;
            Ok(names)
        };
        self.parts.take_in(&name, lines, body, (names, line), results, &format!("given{number}"))?;
        Ok(true)
    }
}
