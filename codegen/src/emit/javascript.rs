//! The module in JavaScript: an ES module without imports, and its declarations for TypeScript.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::documentation::{self, Block, Described, DescribedParameters, Link};
use super::parameters::{
    has_payload, payload_blocks, DECLARED_INDEX, DECLARED_PAYLOAD, INDEX, JAVASCRIPT_INDEX, JAVASCRIPT_PAYLOAD,
};
use super::plain::{
    asks_for_exponentials, asks_for_signs, camel, constants, constants_documentation, described, expression, head, waves, Syntax,
    Value,
};
use super::private::filled;
use super::rust::asks_for_sines;
use super::{Language, Notes, Origin};
use crate::catalogue::{Length, Quantity};
use crate::exact::Number;
use crate::kinds::Scalar;
use crate::program::listing::{decimal, BodyPart, Line, Listing, Name};
use crate::program::{Function, Module, Trig};

const CHECK: &str = include_str!("javascript/check.mjs");
const SIGN: &str = include_str!("javascript/sign.mjs");
const STRIBECK: &str = include_str!("javascript/stribeck.mjs");
const STD: &str = include_str!("javascript/std.mjs");
const FAST: &str = include_str!("javascript/sines.mjs");

struct JavaScript;

impl Syntax for JavaScript {
    fn number(&self, value: &Number) -> String {
        decimal(value, Scalar::F64)
    }

    fn sign(&self, entry: &str) -> String {
        format!("sign({entry})")
    }

    fn stribeck(&self, entry: &str, velocity: &str) -> String {
        format!("stribeck({entry}, {velocity})")
    }
}

/// The module.
pub fn print(module: &Module, origin: &Origin, notes: &Notes) -> String {
    let mut text = head(module, Language::JavaScript, origin, notes, "//");
    let documentation = constants_comments(&DescribedParameters::of(module));
    for (constant, (_, comment)) in constants(module, 0).iter().zip(&documentation) {
        let _ = writeln!(text, "\n{comment}export const {} = {};", constant.name, value_of(&constant.value));
    }
    if !module.parameters.is_empty() {
        let _ = write!(text, "\n{}{JAVASCRIPT_INDEX}", comment(&[Block::text(INDEX)], &[]));
    }
    text += "\n";
    text += CHECK;
    if asks_for_sines(module) {
        text += "\n";
        text += &private(if module.trig == Trig::Fast { FAST } else { STD });
    }
    if asks_for_signs(module) {
        text += "\n";
        text += &private(SIGN);
    }
    if asks_for_exponentials(module) {
        text += "\n";
        text += &private(STRIBECK);
    }
    if has_payload(module) {
        let _ = write!(text, "\n{}{JAVASCRIPT_PAYLOAD}", comment(&payload_blocks(), &[]));
    }
    for function in &module.functions {
        print_function(&mut text, module, function, notes);
    }
    text
}

/// A private function from its template.
fn private(template: &str) -> String {
    filled(template, Scalar::F64, "@adding@", &str::to_string)
}

/// The declarations of the module.
pub fn declarations(module: &Module, origin: &Origin, notes: &Notes) -> String {
    let mut text = head(module, Language::JavaScript, origin, notes, "//");
    let documentation = constants_comments(&DescribedParameters::of(module));
    for (constant, (_, comment)) in constants(module, 0).iter().zip(&documentation) {
        let _ = writeln!(text, "\n{comment}export declare const {}: {};", constant.name, type_of(&constant.value));
    }
    if !module.parameters.is_empty() {
        let _ = write!(text, "\n{}{DECLARED_INDEX}", comment(&[Block::text(INDEX)], &[]));
    }
    if has_payload(module) {
        let _ = write!(text, "\n{}{DECLARED_PAYLOAD}", comment(&payload_blocks(), &[]));
    }
    let mut shapes: BTreeSet<Vec<usize>> = BTreeSet::new();
    for function in &module.functions {
        for part in function.quantity.result {
            let lengths: Vec<usize> = part.lengths.iter().map(|length| length.of(&module.sizes())).collect();
            shapes.extend((0..lengths.len()).map(|from| lengths[from..].to_vec()));
        }
    }
    let mut shapes: Vec<Vec<usize>> = shapes.into_iter().collect();
    shapes.sort_by_key(|shape| (shape.len(), shape.clone()));
    text += "\n";
    for shape in shapes {
        let inner = shape_name(&shape[1..]);
        let _ = writeln!(text, "export type {} = [{}];", shape_name(&shape), vec![inner; shape[0]].join(", "));
    }
    for function in &module.functions {
        let kind = |lengths: &[Length]| shape_name(&lengths.iter().map(|length| length.of(&module.sizes())).collect::<Vec<_>>());
        let result = match function.quantity.result {
            [one] => kind(one.lengths),
            parts => {
                let fields: Vec<String> =
                    parts.iter().map(|part| format!("{}: {}", camel(part.name), kind(part.lengths))).collect();
                format!("{{ {} }}", fields.join("; "))
            }
        };
        let arguments: Vec<String> = function.arguments.iter().map(|a| format!("{}: ArrayLike<number>", a.name())).collect();
        let (described, note) = described(module, function, notes);
        text += "\n";
        text += &comment(&described.blocks(true, note), &[]);
        let _ = writeln!(text, "export declare function {}({}): {result};", camel(&function.name()), arguments.join(", "));
    }
    text
}

/// `number`, `Vector4`, `Matrix4x4`, `Matrices4x6x4`.
fn shape_name(shape: &[usize]) -> String {
    let lengths: Vec<String> = shape.iter().map(ToString::to_string).collect();
    match shape.len() {
        0 => "number".into(),
        1 => format!("Vector{}", lengths[0]),
        2 => format!("Matrix{}", lengths.join("x")),
        _ => format!("Matrices{}", lengths.join("x")),
    }
}

fn link(link: Link<'_>) -> String {
    match link {
        Link::Function(name) => format!("`{}`", camel(name)),
        Link::Argument(name) | Link::Constant(name) => format!("`{name}`"),
    }
}

/// A comment of JSDoc, followed by tags.
fn comment(blocks: &[Block], tags: &[String]) -> String {
    let mut lines = documentation::plain(blocks, &link);
    if !tags.is_empty() {
        lines.push(String::new());
        lines.extend(tags.iter().cloned());
    }
    let line = |line: &String| format!(" * {}", line.replace("*/", "* /")).trim_end().to_string() + "\n";
    format!("/**\n{} */\n", lines.iter().map(line).collect::<String>())
}

/// The comments of constants, by their names.
pub fn constants_comments(described: &DescribedParameters) -> Vec<(String, String)> {
    constants_documentation(described, 0).into_iter().map(|(name, blocks)| (name, comment(&blocks, &[]))).collect()
}

/// The comment of a function; `note` ends it.
pub fn function_comment(described: &Described<'_>, note: Option<&str>) -> String {
    let tags = described.arguments().map(|a| format!("@param {{ArrayLike<number>}} {}", a.name()));
    let returned = |lengths: usize| format!("number{}", "[]".repeat(lengths));
    let returns = match described.quantity.result {
        [one] => returned(one.lengths.len()),
        several => {
            let fields = several.iter().map(|part| format!("{}: {}", camel(part.name), returned(part.lengths.len())));
            format!("{{{}}}", fields.collect::<Vec<_>>().join(", "))
        }
    };
    let tags: Vec<String> = tags.chain([format!("@returns {{{returns}}}")]).collect();
    comment(&described.blocks(true, note), &tags)
}

/// A constant as it is written.
fn value_of(value: &Value) -> String {
    match value {
        Value::Text(text) => format!("\"{text}\""),
        Value::Count(count) => count.to_string(),
        Value::Truth(truth) => truth.to_string(),
        Value::Number(number) => JavaScript.number(number),
        Value::Infinite(negative) => if *negative { "-Infinity" } else { "Infinity" }.into(),
        Value::Array(entries) => format!("Object.freeze([{}])", entries.iter().map(value_of).collect::<Vec<_>>().join(", ")),
    }
}

/// The type of a constant.
fn type_of(value: &Value) -> String {
    match value {
        Value::Text(_) => "string".into(),
        Value::Count(count) => count.to_string(),
        Value::Truth(_) => "boolean".into(),
        Value::Number(_) | Value::Infinite(_) => "number".into(),
        Value::Array(entries) => format!("readonly [{}]", entries.iter().map(type_of).collect::<Vec<_>>().join(", ")),
    }
}

fn print_function(text: &mut String, module: &Module, function: &Function, notes: &Notes) {
    let listing = Listing::of(function);
    let parts = listing.parts();
    for (part, number) in parts.iter().zip(1..) {
        print_part(text, function, part, number);
    }
    let (described, note) = described(module, function, notes);
    let names: Vec<&str> = function.arguments.iter().map(|a| a.name()).collect();
    *text += "\n";
    *text += &function_comment(&described, note);
    let _ = writeln!(text, "export function {}({}) {{", camel(&function.name()), names.join(", "));
    for argument in &function.arguments {
        let length = argument.length().constant();
        let _ = writeln!(text, "    check(\"{0}\", {0}, {length});", argument.name());
    }
    for wave in waves(module, function, &JavaScript) {
        let _ = writeln!(text, "    sinCos({});", wave.angle);
        for (name, place) in [(wave.sine, 0), (wave.cosine, 1)] {
            if let Some(name) = name {
                define(text, &name, &format!("wave[{place}]"));
            }
        }
    }
    if parts.is_empty() {
        lines(text, &listing.lines);
    }
    for (part, number) in parts.iter().zip(1..) {
        call(text, function, part, number);
    }
    let entries: Vec<String> = listing.entries.iter().map(|entry| expression(entry, &JavaScript)).collect();
    result(text, function.quantity, module, &entries);
    *text += "}\n";
}

fn define(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "    const {name} = {value};");
}

fn lines(text: &mut String, lines: &[Line]) {
    for line in lines {
        define(text, &Name::Step(line.name).text(), &expression(&line.value, &JavaScript));
    }
}

fn result(text: &mut String, quantity: &Quantity, module: &Module, entries: &[String]) {
    let sizes = module.sizes();
    if let [part] = quantity.result {
        let lengths: Vec<usize> = part.lengths.iter().map(|length| length.of(&sizes)).collect();
        nested(text, "    return ", "    ", ";", &lengths, entries);
        return;
    }
    *text += "    return {\n";
    let mut rest = entries;
    for part in quantity.result {
        let (own, others) = rest.split_at(part.len(&sizes));
        rest = others;
        let lengths: Vec<usize> = part.lengths.iter().map(|length| length.of(&sizes)).collect();
        nested(text, &format!("        {}: ", camel(part.name)), "        ", ",", &lengths, own);
    }
    *text += "    };\n";
}

/// An array of arrays, rows in lines.
fn nested(text: &mut String, begin: &str, indent: &str, end: &str, lengths: &[usize], entries: &[String]) {
    if lengths.len() < 2 {
        let inner = entries.join(", ");
        let _ = if lengths.is_empty() { writeln!(text, "{begin}{inner}{end}") } else { writeln!(text, "{begin}[{inner}]{end}") };
        return;
    }
    let _ = writeln!(text, "{begin}[");
    let inner = format!("{indent}    ");
    let each = entries.len() / lengths[0].max(1);
    for i in 0..lengths[0] {
        nested(text, &inner, &inner, ",", &lengths[1..], &entries[i * each..(i + 1) * each]);
    }
    let _ = writeln!(text, "{indent}]{end}");
}

fn print_part(text: &mut String, function: &Function, part: &BodyPart, number: usize) {
    let name = camel(&function.name());
    let arguments: Vec<&str> = part.arguments.iter().map(|a| a.name()).chain(["taken"]).collect();
    let _ = writeln!(text, "\n/** Part {number} of `{name}`. */\nfunction {name}Part{number}({}) {{", arguments.join(", "));
    for (i, value) in part.taken.iter().enumerate() {
        define(text, &value.text(), &format!("taken[{i}]"));
    }
    lines(text, &part.lines);
    let given: Vec<String> = part.given.iter().map(|value| value.text()).collect();
    let _ = writeln!(text, "    return [{}];\n}}", given.join(", "));
}

fn call(text: &mut String, function: &Function, part: &BodyPart, number: usize) {
    let taken: Vec<String> = part.taken.iter().map(|value| value.text()).collect();
    let arguments = part.arguments.iter().map(|a| a.name().to_string()).chain([format!("[{}]", taken.join(", "))]);
    let arguments: Vec<String> = arguments.collect();
    let _ = writeln!(text, "    const given{number} = {}Part{number}({});", camel(&function.name()), arguments.join(", "));
    for (i, value) in part.given.iter().enumerate() {
        define(text, &value.text(), &format!("given{number}[{i}]"));
    }
}
