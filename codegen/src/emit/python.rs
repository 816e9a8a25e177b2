//! The module in Python: functions over arrays of any library that has the array API (2023.12), many states at a time.
//!
//! Entries of an argument are taken along its first axis, so that a line is that of other languages; results are put together at the end.

mod native;

use std::fmt::Write;

use super::documentation::{self, Block, Described, DescribedParameters, Link};
use super::parameters::{has_payload, payload_blocks, INDEX, PYTHON_INDEX, PYTHON_PAYLOAD};
use super::plain::{
    asks_for_exponentials, asks_for_signs, constants, constants_documentation, described, expression, head, waves, Syntax, Value,
};
use super::private::filled;
use super::rust::asks_for_sines;
use super::{Language, Notes, Origin};
use crate::catalogue::{Length, Quantity};
use crate::exact::Number;
use crate::kinds::Scalar;
use crate::program::listing::{decimal, BodyPart, Line, Listing, Name};
use crate::program::{Function, Module, Trig};

pub use native::{print as native, Native};

const ARRAYS: &str = include_str!("python/arrays.py");
const SIGN: &str = include_str!("python/sign.py");
const STRIBECK: &str = include_str!("python/stribeck.py");
const STD: &str = include_str!("python/std.py");
const FAST: &str = include_str!("python/sines.py");

struct Python {
    scalar: Scalar,
}

impl Syntax for Python {
    fn number(&self, value: &Number) -> String {
        decimal(value, self.scalar)
    }

    fn sign(&self, entry: &str) -> String {
        format!("_sign(xp, {entry})")
    }

    fn stribeck(&self, entry: &str, velocity: &str) -> String {
        format!("_stribeck(xp, {entry}, {velocity})")
    }
}

/// The module.
pub fn print(module: &Module, origin: &Origin, notes: &Notes) -> String {
    let python = Python { scalar: module.scalar };
    let mut text = head(module, Language::Python, origin, notes, "#");
    text += "\nfrom __future__ import annotations\n\nfrom typing import Any, Callable, Final, NamedTuple, TypeVar\n\n";
    let public: Vec<String> = constants(module, 0)
        .iter()
        .map(|constant| constant.name.to_string())
        .chain((!module.parameters.is_empty()).then(|| "PARAMETER_INDEX".into()))
        .chain(["DTYPE".into(), "by_joint".into()])
        .chain(has_payload(module).then(|| "payload_parameters".into()))
        .chain(module.functions.iter().filter_map(|function| structure(function.quantity)))
        .chain(module.functions.iter().map(Function::name))
        .collect();
    let mut names: Vec<String> = Vec::new();
    for name in public {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let names: String = names.iter().map(|name| format!("    \"{name}\",\n")).collect();
    let _ = writeln!(text, "__all__ = [\n{names}]");
    let documentation = constants_comments(&DescribedParameters::of(module));
    for (constant, (_, comment)) in constants(module, 0).iter().zip(&documentation) {
        let _ = writeln!(text, "\n{comment}{}: Final = {}", constant.name, python.value(&constant.value));
    }
    if !module.parameters.is_empty() {
        let _ = write!(text, "\n# {INDEX}\n{PYTHON_INDEX}");
    }
    let dtype = match module.scalar {
        Scalar::F64 => "float64",
        Scalar::F32 => "float32",
    };
    let private = |template: &str| filled(template, module.scalar, "+ 0.0 makes it no -0", &str::to_string);
    let _ = writeln!(text, "\n# The type of the entries of all arrays.\nDTYPE: Final = \"{dtype}\"\n\n\n{ARRAYS}");
    if asks_for_sines(module) {
        let _ = writeln!(text, "\n{}", private(if module.trig == Trig::Fast { FAST } else { STD }));
    }
    if asks_for_signs(module) {
        let _ = writeln!(text, "\n{}", private(SIGN));
    }
    if asks_for_exponentials(module) {
        let _ = writeln!(text, "\n{}", private(STRIBECK));
    }
    if has_payload(module) {
        let [signature, body] = PYTHON_PAYLOAD;
        let _ = writeln!(text, "\n{signature}{}{body}", docstring(&payload_blocks()));
    }
    let mut known: Vec<String> = Vec::new();
    for function in &module.functions {
        result_type(&mut text, function.quantity, &mut known);
        python.function(&mut text, module, function, notes);
    }
    text.trim_end().to_string() + "\n"
}

/// The name of the type that holds several results: `inverse_dynamics_derivatives` returns `InverseDynamicsDerivatives`.
fn structure(quantity: &Quantity) -> Option<String> {
    let capital = |word: &str| {
        let (initial, rest) = word.split_at(word.len().min(1));
        initial.to_uppercase() + rest
    };
    (quantity.result.len() > 1).then(|| quantity.name.split('_').map(capital).collect())
}

/// The type of several results, where it is not known yet.
fn result_type(text: &mut String, quantity: &Quantity, known: &mut Vec<String>) {
    let Some(name) = structure(quantity).filter(|name| !known.contains(name)) else { return };
    let _ = writeln!(text, "\nclass {name}(NamedTuple):\n    \"\"\"Results of `{}`.\"\"\"\n", quantity.name);
    for part in quantity.result {
        let _ = writeln!(text, "    {}: Any", part.name);
    }
    *text += "\n";
    known.push(name);
}

fn link(link: Link<'_>) -> String {
    let (Link::Function(name) | Link::Argument(name) | Link::Constant(name)) = link;
    format!("`{name}`")
}

/// The comments of constants, by their names.
pub fn constants_comments(described: &DescribedParameters) -> Vec<(String, String)> {
    let line = |line: &String| format!("# {line}").trim_end().to_string() + "\n";
    let comment = |blocks: &[Block]| documentation::plain(blocks, &link).iter().map(line).collect();
    constants_documentation(described, 0).into_iter().map(|(name, blocks)| (name, comment(&blocks))).collect()
}

/// The documentation of a function; `note` follows the text that all languages share.
pub fn function_comment(described: &Described<'_>, note: Option<&str>) -> String {
    let mut all = described.blocks(true, note);
    all.push(Block::text("Leading axes are those of many states; `m[..., i, j]` is row i, column j."));
    docstring(&all)
}

/// The documentation of a function as its first statement.
fn docstring(blocks: &[Block]) -> String {
    let mut text = String::new();
    for (i, line) in documentation::plain(blocks, &link).iter().enumerate() {
        let line = line.replace('\\', "/").replace("\"\"\"", "'''");
        text += format!("    {}{line}", if i == 0 { "\"\"\"" } else { "" }).trim_end();
        text += "\n";
    }
    text + "    \"\"\"\n"
}

fn define(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "    {name} = {value}");
}

/// A tuple, with the comma that makes one of a single entry.
fn tuple(entries: &[String]) -> String {
    match entries {
        [] => "()".into(),
        entries => format!("({},)", entries.join(", ")),
    }
}

impl Python {
    fn value(&self, value: &Value) -> String {
        match value {
            Value::Text(text) => format!("\"{text}\""),
            Value::Count(count) => count.to_string(),
            Value::Truth(truth) => if *truth { "True" } else { "False" }.into(),
            Value::Number(number) => self.number(number),
            Value::Infinite(negative) => if *negative { "-float(\"inf\")" } else { "float(\"inf\")" }.into(),
            Value::Array(entries) => tuple(&entries.iter().map(|entry| self.value(entry)).collect::<Vec<_>>()),
        }
    }

    fn function(&self, text: &mut String, module: &Module, function: &Function, notes: &Notes) {
        let listing = Listing::of(function);
        let parts = listing.parts();
        for (part, number) in parts.iter().zip(1..) {
            self.part(text, function, part, number);
        }
        let names: Vec<&str> = function.arguments.iter().map(|a| a.name()).collect();
        let signature: Vec<String> = names.iter().map(|name| format!("{name}: Any")).collect();
        let returns = structure(function.quantity).unwrap_or("Any".into());
        let _ = writeln!(text, "\ndef {}({}) -> {returns}:", function.name(), signature.join(", "));
        let (described, note) = described(module, function, notes);
        *text += &function_comment(&described, note);
        let entered = function.arguments.iter().map(|a| {
            let length = a.length().constant();
            format!("(\"{0}\", {0}, {length})", a.name())
        });
        let entered: Vec<String> = entered.collect();
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        let _ = writeln!(text, "    xp, shape, {} = _enter({})", tuple(&names), entered.join(", "));
        let _ = writeln!(
            text,
            "    if _many(xp, shape, {0}):\n        return _in_blocks(xp, shape, {1}, {0})",
            tuple(&names),
            function.name()
        );
        let waves = waves(module, function, self);
        if !waves.is_empty() {
            let angles: Vec<String> = waves.iter().map(|wave| wave.angle.clone()).collect();
            // An unused result has no name.
            let sine = if waves.iter().any(|wave| wave.sine.is_some()) { "sine" } else { "_" };
            let cosine = if waves.iter().any(|wave| wave.cosine.is_some()) { "cosine" } else { "_" };
            let _ = writeln!(text, "    {sine}, {cosine} = _sin_cos(xp, {})", tuple(&angles));
        }
        for (i, wave) in waves.iter().enumerate() {
            for (value, from) in [(&wave.sine, "sine"), (&wave.cosine, "cosine")] {
                if let Some(value) = value {
                    define(text, value, &format!("{from}[{i}]"));
                }
            }
        }
        if parts.is_empty() {
            self.lines(text, &listing.lines);
        }
        for (part, number) in parts.iter().zip(1..) {
            let taken: Vec<String> = part.taken.iter().map(|value| value.text()).collect();
            let arguments = ["xp".to_string()].into_iter().chain(part.arguments.iter().map(|a| a.name().to_string()));
            let arguments: Vec<String> = arguments.chain([tuple(&taken)]).collect();
            define(text, &format!("given_{number}"), &format!("_{}_part_{number}({})", function.name(), arguments.join(", ")));
            for (i, value) in part.given.iter().enumerate() {
                define(text, &value.text(), &format!("given_{number}[{i}]"));
            }
        }
        self.result(text, module, function, &listing, &names[0]);
        *text += "\n";
    }

    fn lines(&self, text: &mut String, lines: &[Line]) {
        for line in lines {
            define(text, &Name::Step(line.name).text(), &expression(&line.value, self));
        }
    }

    fn result(&self, text: &mut String, module: &Module, function: &Function, listing: &Listing, like: &str) {
        let sizes = module.sizes();
        let mut rest = listing.entries.as_slice();
        let mut array = |text: &mut String, begin: &str, indent: &str, end: &str, lengths: &[Length], count: usize| {
            let (own, others) = rest.split_at(count);
            rest = others;
            let lengths: Vec<String> = lengths.iter().map(|length| length.constant()).collect();
            let _ = writeln!(text, "{begin}_leave(xp, {like}, shape, {}, (", tuple(&lengths));
            for entry in own {
                let _ = writeln!(text, "{indent}    {},", expression(entry, self));
            }
            let _ = writeln!(text, "{indent})){end}");
        };
        match structure(function.quantity) {
            None => {
                let part = &function.quantity.result[0];
                array(text, "    return ", "    ", "", part.lengths, part.len(&sizes));
            }
            Some(name) => {
                let _ = writeln!(text, "    return {name}(");
                for part in function.quantity.result {
                    array(text, "        ", "        ", ",", part.lengths, part.len(&sizes));
                }
                *text += "    )\n";
            }
        }
    }

    fn part(&self, text: &mut String, function: &Function, part: &BodyPart, number: usize) {
        let arguments = part.arguments.iter().map(|a| format!("{}: Any, ", a.name())).collect::<String>();
        let _ = writeln!(
            text,
            "\ndef _{}_part_{number}(xp: Any, {arguments}taken: tuple[Any, ...]) -> tuple[Any, ...]:",
            function.name()
        );
        for (i, value) in part.taken.iter().enumerate() {
            define(text, &value.text(), &format!("taken[{i}]"));
        }
        self.lines(text, &part.lines);
        let given: Vec<String> = part.given.iter().map(|value| value.text()).collect();
        let _ = writeln!(text, "    return {}\n", tuple(&given));
    }
}
