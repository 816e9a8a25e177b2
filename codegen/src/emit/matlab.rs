//! The module in MATLAB and Octave: a package, a folder with a file for each function. Columns of arguments are states, and the
//! last dimension of results counts states. Inside a function entries are columns, in blocks of as many states as the processor's
//! cache holds: MATLAB takes a column from a matrix without a copy.
//!
//! Every file has its helpers as local functions, so that any file can be copied into a block of Simulink.

use std::fmt::Write;

use super::documentation::{self, Block, Described, DescribedParameters, Link};
use super::parameters::{has_payload, payload_blocks, INDEX, MATLAB_PAYLOAD};
use super::plain::{camel, constants, constants_documentation, described, expression, head, places, waves, Syntax, Value};
use super::private::filled;
use super::{Language, Notes, Origin};
use crate::catalogue::{Argument, Quantity, ResultPart};
use crate::exact::Number;
use crate::kinds::Scalar;
use crate::program::listing::{decimal, BodyPart, Line, Listing, Name};
use crate::program::{Function, Module, Operation, Trig};

const CHECK: &str = include_str!("matlab/check.m");
const SIGN: &str = include_str!("matlab/sign.m");
const STRIBECK: &str = include_str!("matlab/stribeck.m");
const STD: &str = include_str!("matlab/std.m");
const FAST: &str = include_str!("matlab/sines.m");
/// As many states are computed at a time.
const BLOCK: usize = 4096;

/// A file of a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its name in the folder.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// The files of a package as one text, in the order of their names: a line with its name precedes each.
pub fn joined(files: &[File]) -> String {
    let mut files: Vec<&File> = files.iter().collect();
    files.sort_by(|a, b| a.name.cmp(&b.name));
    files.iter().map(|file| format!("%%% {}\n{}", file.name, file.text)).collect()
}

struct Matlab;

impl Syntax for Matlab {
    fn number(&self, value: &Number) -> String {
        decimal(value, Scalar::F64)
    }

    fn sign(&self, entry: &str) -> String {
        format!("signOf({entry})")
    }

    fn stribeck(&self, entry: &str, velocity: &str) -> String {
        format!("stribeck({entry}, {velocity})")
    }

    fn entry(&self, argument: Argument, index: usize) -> String {
        format!("{}(:, {})", argument.name(), index + 1)
    }

    fn operator(&self, operation: Operation) -> &'static str {
        match operation {
            Operation::Add => "+",
            Operation::Subtract => "-",
            Operation::Multiply => ".*",
            Operation::Divide => "./",
            Operation::Sign | Operation::OppositeSign => unreachable!("a listing writes the sign of one operand"),
        }
    }
}

/// The files of the package.
pub fn print(module: &Module, origin: &Origin, notes: &Notes) -> Vec<File> {
    let head = head(module, Language::Matlab, origin, notes, "%");
    let mut files = vec![contents(module, &head), model(module, &head)];
    if has_payload(module) {
        let [signature, body] = MATLAB_PAYLOAD;
        let comment = comment(&payload_blocks(), "PAYLOADPARAMETERS  ");
        let text = format!("{signature}{comment}\n{}%#codegen\n{body}", origin_of(&head));
        files.push(File { name: "payloadParameters.m".into(), text });
    }
    files.extend(module.functions.iter().map(|function| file(module, function, &head, notes)));
    files
}

/// What `help` shows of the package.
fn contents(module: &Module, head: &str) -> File {
    let functions: Vec<_> = module.functions.iter().map(|function| (function.name(), function.quantity)).collect();
    File {
        name: "Contents.m".into(),
        text: format!("{}\n{head}", contents_comment(&module.name, &functions, has_payload(module))),
    }
}

/// First comment of the file of contents.
fn contents_comment(robot: &str, functions: &[(String, &Quantity)], has_payload: bool) -> String {
    let mut rows = vec![("model".to_string(), "Names, limits and parameters.".to_string())];
    if has_payload {
        rows.push((
            "payloadParameters".into(),
            "Parameters of a payload from its mass, its centre of mass and its inertia.".into(),
        ));
    }
    let title = |quantity: &Quantity| documentation::linked(quantity.documentation.title, &link);
    rows.extend(functions.iter().map(|(name, quantity)| (camel(name), title(quantity))));
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut text = format!("% Equations of motion of the robot {robot}\n%\n");
    for (name, described) in rows {
        let _ = writeln!(text, "%   {name:width$} - {described}");
    }
    text
}

/// The comments of constants, by their names.
pub fn constants_comments(described: &DescribedParameters) -> Vec<(String, String)> {
    constants_documentation(described, 1).into_iter().map(|(name, blocks)| (name, comment(&blocks, ""))).collect()
}

/// What `help` shows of a function.
pub fn function_comment(described: &Described<'_>, note: Option<&str>) -> String {
    let mut all = described.blocks(true, note);
    all.insert(1, Block::Verbatim(vec![call(described)]));
    let lists = described.quantity.result.iter().find_map(|part| part.element);
    let entries = match lists {
        None => "`m[i][j]` of state k is m(i, j, k), indices from 1.",
        Some(_) => {
            "`m[link][i][j]` of state k is m(i, j, link, k), indices from 1: link 1 is the one that joint 1 moves; the base is none of them, and \
             neither is the end effector's frame, which has the tool."
        }
    };
    all.push(Block::text(format!(
        "Columns of arguments are states, a single column is that of all; {entries} What is said of the head of this file stands in Contents.m."
    )));
    comment(&all, &format!("{}  ", camel(&described.name()).to_uppercase()))
}

/// How a function is called.
fn call(described: &Described<'_>) -> String {
    let names: Vec<&str> = described.arguments().map(|a| a.name()).collect();
    let returned = listed(&results(described.quantity));
    format!("{returned} = {}({})", camel(&described.name()), names.join(", "))
}

/// The constants, as fields of a struct.
fn model(module: &Module, head: &str) -> File {
    let mut text = String::from("function m = model()\n%MODEL  Names, limits and parameters, as fields of a struct.\n");
    let _ = write!(text, "\n{}%#codegen\n    m = struct();\n", origin_of(head));
    let documentation = constants_comments(&DescribedParameters::of(module));
    for (constant, (_, comment)) in constants(module, 1).iter().zip(&documentation) {
        let _ = writeln!(text, "\n{comment}    m.{} = {};", field(&constant.name), value_of(&constant.value));
    }
    if !module.parameters.is_empty() {
        let places = module.parameters.iter().zip(1..).map(|(parameter, place)| format!("'{}', {place}", parameter.name));
        let places: Vec<String> = places.collect();
        let _ = writeln!(text, "\n% {INDEX}\n    m.parameterIndex = struct({});", places.join(", "));
    }
    text += "end\n";
    File { name: "model.m".into(), text }
}

/// The field of a constant: `jointNames` of `JOINT_NAMES`.
fn field(constant: &str) -> String {
    camel(&constant.to_ascii_lowercase())
}

/// The line with the origin of a file.
fn origin_of(head: &str) -> String {
    head.lines().next().unwrap_or_default().to_string() + "\n"
}

fn link(link: Link<'_>) -> String {
    match link {
        Link::Function(name) => format!("`{}`", camel(name)),
        Link::Argument(name) => format!("`{name}`"),
        Link::Constant(name) => format!("`{}` of `model`", field(name)),
    }
}

/// A comment, `first` in front of its first line.
fn comment(blocks: &[Block], first: &str) -> String {
    let line = |(i, line): (usize, String)| {
        let begin = if i > 0 && !first.is_empty() {
            "   "
        } else if first.is_empty() {
            " "
        } else {
            first
        };
        format!("%{begin}{line}").trim_end().to_string() + "\n"
    };
    documentation::plain(blocks, &link).into_iter().enumerate().map(line).collect()
}

/// A constant as written: entries form a column, rows a matrix.
fn value_of(value: &Value) -> String {
    match value {
        Value::Text(text) => format!("'{text}'"),
        Value::Count(count) => count.to_string(),
        Value::Truth(truth) => truth.to_string(),
        Value::Number(number) => Matlab.number(number),
        Value::Infinite(negative) => if *negative { "-Inf" } else { "Inf" }.into(),
        Value::Array(entries) => {
            let all = |separator: &str| entries.iter().map(value_of).collect::<Vec<_>>().join(separator);
            match entries.first() {
                None => "zeros(0, 1)".into(),
                Some(Value::Text(_)) => format!("{{{}}}", all("; ")),
                Some(Value::Array(_)) => {
                    let row = |entry: &Value| match entry {
                        Value::Array(row) => format!("[{}]", row.iter().map(value_of).collect::<Vec<_>>().join(", ")),
                        other => value_of(other),
                    };
                    format!("[{}]", entries.iter().map(row).collect::<Vec<_>>().join("; "))
                }
                Some(_) => format!("[{}]", all("; ")),
            }
        }
    }
}

/// The names of the results of a function.
fn results(quantity: &Quantity) -> Vec<String> {
    quantity.result.iter().map(|part| camel(part.name)).collect()
}

/// Documentation of the function for a block of states.
pub fn block_comment(function: &str) -> String {
    format!("% `{function}` of n states, so few that they stay in the processor's cache; inside, an entry is a column.\n")
}

/// A list of names, in brackets where they are several.
fn listed(names: &[String]) -> String {
    match names {
        [one] => one.clone(),
        several => format!("[{}]", several.join(", ")),
    }
}

/// The file of a function.
fn file(module: &Module, function: &Function, head: &str, notes: &Notes) -> File {
    let listing = Listing::of(function);
    let parts = listing.parts();
    let name = camel(&function.name());
    let (described, note) = described(module, function, notes);
    let mut text = format!("function {}\n{}", call(&described), function_comment(&described, note));
    let _ = write!(text, "\n{}%#codegen\n", origin_of(head));
    in_blocks(&mut text, module, function, &name);
    block(&mut text, module, function, &name, &listing);
    for (part, number) in parts.iter().zip(1..) {
        print_part(&mut text, &name, part, number);
    }
    let symbols = function.symbols();
    let sines = symbols.iter().any(|symbol| symbol.angle().is_some());
    let signs = function.takes_signs();
    let sines_text = if module.trig == Trig::Fast { FAST } else { STD };
    let blocks = [(true, CHECK), (sines, sines_text), (signs, SIGN), (!function.stribeck.is_empty(), STRIBECK)];
    for (wanted, block) in blocks {
        if wanted {
            text += "\n";
            text += &filled(block, Scalar::F64, "@adding@", &|value| value.replace(" * ", " .* "));
        }
    }
    File { name: format!("{name}.m"), text }
}

/// Lengths of a part of the result; MATLAB puts the index of a list of matrices last.
fn lengths(module: &Module, part: &ResultPart) -> Vec<usize> {
    let lengths: Vec<usize> = part.lengths.iter().map(|length| length.of(&module.sizes())).collect();
    paged(if lengths.is_empty() { &[1] } else { &lengths })
}

fn joined_by_commas(numbers: &[usize]) -> String {
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// The body of the function: checks, and a call of the function for a block, or one for each.
fn in_blocks(text: &mut String, module: &Module, function: &Function, name: &str) {
    let names: Vec<&str> = function.arguments.iter().map(|a| a.name()).collect();
    let results = results(function.quantity);
    match names.as_slice() {
        [one] => define(text, "n", &format!("size({one}, 2)")),
        several => {
            // None where an argument has no states, though another has the single one of all.
            let sizes = several.iter().map(|name| format!("size({name}, 2)")).collect::<Vec<_>>().join(", ");
            define(text, "n", &format!("max([{sizes}]) * min([{sizes}, 1])"));
        }
    }
    for argument in &function.arguments {
        let rows = argument.length().of(&module.sizes());
        let _ = writeln!(text, "    check('{0}', {0}, {rows}, n);", argument.name());
    }
    let _ = writeln!(text, "    if n <= {BLOCK}");
    let _ = writeln!(text, "        {} = {name}Block({}, n);\n        return\n    end", listed(&results), names.join(", "));
    for (part, result) in function.quantity.result.iter().zip(&results) {
        define(text, result, &format!("zeros({}, n)", joined_by_commas(&lengths(module, part))));
    }
    let _ = writeln!(text, "    for first = 1:{BLOCK}:n\n        k = first:min(first + {}, n);", BLOCK - 1);
    let own = |(part, result): (&ResultPart, &String)| format!("{result}({}k)", ":, ".repeat(part.lengths.len().max(1)));
    let own: Vec<String> = function.quantity.result.iter().zip(&results).map(own).collect();
    let columns: Vec<String> = names.iter().map(|name| format!("{name}(:, min(k, size({name}, 2)))")).collect();
    let _ = writeln!(text, "        {} = {name}Block({}, numel(k));\n    end\nend", listed(&own), columns.join(", "));
}

/// The function for a block of states.
fn block(text: &mut String, module: &Module, function: &Function, name: &str, listing: &Listing) {
    let parts = listing.parts();
    let names: Vec<&str> = function.arguments.iter().map(|a| a.name()).collect();
    let results = results(function.quantity);
    let _ = writeln!(text, "\nfunction {} = {name}Block({}, n)", listed(&results), names.join(", "));
    *text += &block_comment(name);
    names.iter().for_each(|name| define(text, name, &format!("{name}.'")));
    let waves = waves(module, function, &Matlab);
    if !waves.is_empty() {
        let angles: Vec<&str> = waves.iter().map(|wave| wave.angle.as_str()).collect();
        define(text, "[sine, cosine]", &format!("sinCos([{}])", angles.join(", ")));
    }
    for (wave, i) in waves.iter().zip(1..) {
        for (value, from) in [(&wave.sine, "sine"), (&wave.cosine, "cosine")] {
            if let Some(value) = value {
                define(text, value, &format!("{from}(:, {i})"));
            }
        }
    }
    if parts.is_empty() {
        lines(text, &listing.lines);
    }
    for (part, number) in parts.iter().zip(1..) {
        call_of(text, name, part, number);
    }
    for (part, result) in function.quantity.result.iter().zip(&results) {
        define(text, result, &format!("zeros(n, {})", part.len(&module.sizes())));
    }
    for ((part, place), entry) in places(function.quantity, &module.sizes()).iter().zip(&listing.entries) {
        // The first index is the one that changes fastest.
        let sizes = lengths(module, part);
        let column = paged(place).iter().zip(&sizes).rev().fold(0, |column, (index, size)| column * size + index) + 1;
        define(text, &format!("{}(:, {column})", camel(part.name)), &expression(entry, &Matlab));
    }
    for (part, result) in function.quantity.result.iter().zip(&results) {
        let value = match part.lengths.len() {
            0 | 1 => format!("{result}.'"),
            _ => format!("reshape({result}.', {}, n)", joined_by_commas(&lengths(module, part))),
        };
        define(text, result, &value);
    }
    *text += "end\n";
}

/// Indices of an entry, or lengths: the index in a list of matrices comes after row and column.
fn paged(indices: &[usize]) -> Vec<usize> {
    let (pages, matrix) = indices.split_at(indices.len().saturating_sub(2));
    matrix.iter().chain(pages).copied().collect()
}

fn define(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "    {name} = {value};");
}

fn lines(text: &mut String, lines: &[Line]) {
    for line in lines {
        define(text, &Name::Step(line.name).text(), &expression(&line.value, &Matlab));
    }
}

/// The values of a list, as a cell array.
fn cells(values: &[Name]) -> String {
    format!("{{{}}}", values.iter().map(|value| value.text()).collect::<Vec<_>>().join(", "))
}

fn print_part(text: &mut String, function: &str, part: &BodyPart, number: usize) {
    let arguments: Vec<&str> = part.arguments.iter().map(|a| a.name()).chain(["taken"]).collect();
    let _ =
        writeln!(text, "\nfunction given = {function}Part{number}({})\n% Part {number} of `{function}`.", arguments.join(", "));
    for (value, i) in part.taken.iter().zip(1..) {
        define(text, &value.text(), &format!("taken{{{i}}}"));
    }
    lines(text, &part.lines);
    define(text, "given", &cells(&part.given));
    *text += "end\n";
}

fn call_of(text: &mut String, function: &str, part: &BodyPart, number: usize) {
    let arguments = part.arguments.iter().map(|a| a.name().to_string()).chain([cells(&part.taken)]);
    let arguments: Vec<String> = arguments.collect();
    define(text, &format!("given{number}"), &format!("{function}Part{number}({})", arguments.join(", ")));
    for (value, i) in part.given.iter().zip(1..) {
        define(text, &value.text(), &format!("given{number}{{{i}}}"));
    }
}
