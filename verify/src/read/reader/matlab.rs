//! Reads a MATLAB package, joined into one text.
//!
//! ```text
//! package  = { %%% FILE  file }                    files in the order of their names: Contents.m, which is a comment, model.m, functions
//! model    = function m = model()  m = struct();  { m.FIELD = VALUE; }  end
//! function = function RESULTS = NAME(ARGUMENTS)  n = COLUMNS;  { check('ARGUMENT', ARGUMENT, ROWS, n); } a call of the block or one of
//!            each 4096 states  end  block { part } check [ sines ] [ sign ] [ stribeck ]
//! block    = function RESULTS = NAMEBlock(ARGUMENTS, n)  { ARGUMENT = ARGUMENT.'; } [ waves ] { line } { call { line } }
//!            { RESULT = zeros(n, ENTRIES); } { RESULT(:, ENTRY) = SUM; } { RESULT = reshape(RESULT.', SIZES, n); } end
//! waves    = [sine, cosine] = sinCos([ANGLES]);  { NAME = sine(:, I); | NAME = cosine(:, I); }
//! line     = NAME = SUM;
//! call     = givenK = NAMEPartK(ARGUMENTS, {NAMES});  { NAME = givenK{I}; }
//! ```

use std::collections::BTreeMap;

use armgen_description::language::Language;

use super::parameters::{has_payload, names, MATLAB_PAYLOAD};
use super::plain::{
    camel, in_order, is_of_some_arms, names_of, promised, sizes, Body, Comments, Constants, Entry, Lines, Parts, Syntax,
    CONSTANTS,
};
use super::{Constant, Fault, Function, Module, LONGEST};
use crate::values::contract::{Array, Length, Promise, Sizes};
use crate::values::enclosure::Float;
use crate::values::program::{Argument, Program};

pub(super) const COMMENTS: Comments = Comments { line: Some("%"), block: None, behind: "" };

const CHECK: &str = include_str!("matlab/check.m");
const SIGN: &str = include_str!("matlab/sign.m");
const STRIBECK: &str = include_str!("matlab/stribeck.m");
const STD: &str = include_str!("matlab/std.m");
const FAST: &str = include_str!("matlab/sines.m");

/// The file with the parameters of a payload.
const PAYLOAD: &str = "payloadParameters.m";

/// Prefix of the line before each file; the file name follows.
pub(super) const FILE: &str = "%%% ";

/// Joins the files of a package, given by names and texts; an error gives the name of a file that would not stay a single file, with the reason.
pub fn joined(mut files: Vec<(String, String)>) -> Result<String, (String, &'static str)> {
    files.sort();
    let mut all = String::new();
    for (name, text) in files {
        let is_head = |line: &str| line.starts_with(FILE);
        if name.contains('\n') {
            return Err((name, "has a line break in its name"));
        }
        if text.split('\n').any(is_head) {
            return Err((name, "has a line that begins with `%%%`, as no file of a package does"));
        }
        if !text.ends_with('\n') {
            return Err((name, "does not end with a line break"));
        }
        all += &format!("{FILE}{name}\n{text}");
    }
    Ok(all)
}

/// The file and the line in it for a line of the joined text.
pub fn file_of(text: &str, line: usize) -> Option<(&str, usize)> {
    let before = text.split('\n').zip(1..=line).filter_map(|(text, number)| Some((text.strip_prefix(FILE)?, number)));
    before.last().map(|(name, number)| (name, line - number))
}

/// A file: its name, its text, and the number of lines before it.
struct File<'a> {
    name: &'a str,
    text: &'a str,
    before: usize,
}

impl<'a> File<'a> {
    fn lines(&self) -> Result<Lines<'a>, Fault> {
        let lines = Lines::new(self.text, COMMENTS).map_err(|fault| Fault { line: fault.line + self.before, ..fault })?;
        // Alone in a line, these begin and end a block comment.
        let braces = |line: &str| matches!(line.strip_prefix('%').map(str::trim), Some("{" | "}"));
        match self.text.split('\n').position(braces) {
            Some(at) => {
                Err(Fault { line: at + 1 + self.before, reason: "a comment that begins or ends one of many lines".into() })
            }
            None => Ok(lines.behind(self.before)),
        }
    }
}

fn files(text: &str) -> Result<Vec<File<'_>>, Fault> {
    let mut files: Vec<File<'_>> = Vec::new();
    let (mut rest, mut before) = (text, 0);
    while !rest.is_empty() {
        let (head, behind) = rest.split_once('\n').unwrap_or((rest, ""));
        let fault = |reason: String| Fault { line: before + 1, reason };
        let name = head.strip_prefix(FILE).ok_or_else(|| fault("a file of a package has its name in front".into()))?;
        if files.last().is_some_and(|last| last.name >= name) {
            return Err(fault(format!("`{name}` is not behind the file before it")));
        }
        let end = behind.find(&format!("\n{FILE}")).map_or(behind.len(), |at| at + 1);
        let (text, others) = behind.split_at(end);
        files.push(File { name, text, before: before + 1 });
        before += 1 + text.matches('\n').count();
        rest = others;
    }
    Ok(files)
}

/// Reads a package.
pub(super) fn read(text: &str) -> Result<Module, Fault> {
    if text.len() > LONGEST {
        return Err(Fault { line: 1, reason: format!("the text is longer than {} MiB", LONGEST >> 20) });
    }
    let files = files(text)?;
    let named = |name: &str| {
        let file = files.iter().find(|file| file.name == name);
        file.ok_or_else(|| Fault { line: 1, reason: format!("the package has no `{name}`") })
    };
    let (contents, model) = (named("Contents.m")?, named("model.m")?);
    if !contents.lines()?.ended() {
        return Err(contents.lines()?.fault(format!("{} in a file of comments", contents.lines()?.shown())));
    }
    let head = contents.text.split('\n').skip_while(|line| !line.starts_with("% @generated"));
    let head = head.map_while(|line| line.strip_prefix('%')).map(String::from).collect();
    let constants = constants(&mut model.lines()?)?;
    let sizes = sizes(&constants)?;
    let syntax = Syntax {
        index: ("(:, ", ")"),
        first: 1,
        operators: [" .* ", " ./ "],
        suffix: "",
        sign: "signOf(".into(),
        stribeck: "stribeck(".into(),
        fused: None,
        define: ["    ".into(), " = ".into(), ";".into()],
        list: ("{", "}"),
        angles: ", ",
    };
    let mut reader = Reader { syntax: &syntax, sizes, steps: 0, trig: None };
    let mut functions: Vec<(String, Result<Function, String>)> = Vec::new();
    if has_payload(&constants) {
        let mut lines = named(PAYLOAD)?.lines()?;
        lines.expect_all(MATLAB_PAYLOAD, COMMENTS)?;
        if !lines.ended() {
            return Err(lines.fault(format!("{} behind the end of the function", lines.shown())));
        }
    }
    let others = if has_payload(&constants) { &["Contents.m", "model.m", PAYLOAD][..] } else { &["Contents.m", "model.m"] };
    for file in files.iter().filter(|file| !others.contains(&file.name)) {
        let (name, function) = reader.file(file)?;
        functions.push((name, Ok(function)));
    }
    let order: Vec<String> = names_of(&reader.sizes).collect();
    functions.sort_by_key(|(name, _)| order.iter().position(|other| other == name));
    Ok(Module { trig: reader.trig, head, constants, functions, ..Module::empty(Language::Matlab) })
}

/// The fields of the model.
fn constants(lines: &mut Lines<'_>) -> Result<BTreeMap<String, Constant>, Fault> {
    let form = Constants {
        real: Float::F64,
        suffix: "",
        quotes: '\'',
        list: |entry, inner| match (entry, inner) {
            (Entry::Text, _) => ["{", "; ", "}", "zeros(0, 1)"],
            (_, false) => ["[", "; ", "]", "zeros(0, 1)"],
            (_, true) => ["[", ", ", "]", "zeros(0, 1)"],
        },
        truth: ["false", "true"],
        infinity: "Inf",
    };
    lines.expect("function m = model()")?;
    lines.expect("    m = struct();")?;
    let read = in_order(CONSTANTS.map(|(name, ..)| name), |name| {
        let begin = format!("    m.{} = ", camel(&name.to_ascii_lowercase()));
        if is_of_some_arms(name) && !lines.peek().starts_with(&begin) {
            return Ok(None);
        }
        let number = lines.number();
        let value = lines.between(&begin, ";")?;
        let value = form.read(name, value, number)?;
        let counts = ["TASK", "COORDINATES"].iter().any(|end| name.ends_with(end));
        Ok(Some(match value {
            // MATLAB counts rows and joints from 1.
            Constant::Array(rows) if counts => {
                let from_0 = |row: &Constant| match row {
                    Constant::Integer(row) => row.checked_sub(1).map(Constant::Integer),
                    _ => None,
                };
                let rows: Option<Vec<Constant>> = rows.iter().map(from_0).collect();
                Constant::Array(rows.ok_or_else(|| Fault { line: number, reason: "rows are counted from 1".into() })?)
            }
            value => value,
        }))
    })?;
    let constants = read.into_iter().collect();
    let places: Vec<String> = names(&constants).into_iter().zip(1..).map(|(name, place)| format!("'{name}', {place}")).collect();
    if !places.is_empty() {
        lines.expect(&format!("    m.parameterIndex = struct({});", places.join(", ")))?;
    }
    lines.expect("end")?;
    match lines.ended() {
        true => Ok(constants),
        false => Err(lines.fault(format!("{} behind the end of the function", lines.shown()))),
    }
}

/// Indices or lengths in MATLAB's order for a list of matrices: the list index follows row and column.
fn paged(indices: &[usize]) -> Vec<usize> {
    match indices {
        [page, row, column] => vec![*row, *column, *page],
        others => others.to_vec(),
    }
}

fn list(numbers: &[usize]) -> String {
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

struct Reader<'r> {
    syntax: &'r Syntax,
    sizes: Sizes,
    steps: usize,
    trig: Option<&'static str>,
}

impl Reader<'_> {
    /// The function of a file, with its parts.
    fn file(&mut self, file: &File<'_>) -> Result<(String, Function), Fault> {
        let mut lines = file.lines()?;
        let begin = |reason: String| Fault { line: file.before + 1, reason };
        let name = file.name.strip_suffix(".m").unwrap_or_default();
        let known = names_of(&self.sizes).find(|known| camel(known) == name);
        let (own, (promise, arguments)) = known
            .and_then(|own| Some((own.clone(), promised(&own, &self.sizes)?)))
            .ok_or_else(|| begin(format!("`{}` is not a file that an emitted package has", file.name)))?;
        self.sizes = self.sizes.of_function(&own);
        // Parts follow the functions that call them.
        let mut parts = Parts::default();
        let begins = lines.all.iter().enumerate().filter(|(_, line)| line.text.starts_with("function "));
        lines.at = begins.map(|(at, _)| at).nth(2).unwrap_or(lines.all.len());
        let behind_function = lines.at;
        while lines.peek().starts_with("function given = ") {
            part(&mut parts, &mut lines)?;
        }
        let behind_parts = std::mem::replace(&mut lines.at, 0);

        let documentation = self.in_blocks(&mut lines, promise, &arguments, name)?;
        let (program, asks) = self.block(&mut lines, (&own, promise, arguments), name, &mut parts)?;
        if lines.at != behind_function {
            return Err(lines.fault(format!("{} behind the end of the function", lines.shown())));
        }
        if let Some(part) = parts.unused() {
            return Err(lines.fault(format!("`{part}` is needed by no function of the file")));
        }
        lines.at = behind_parts;
        lines.expect_all(CHECK, COMMENTS)?;
        let [sines, sign, stribeck] = asks;
        if sines {
            let fast = Lines::new(FAST, COMMENTS)?;
            let fast = lines.all.get(lines.at + 1).map(|line| line.text) == fast.all.get(1).map(|line| line.text);
            let trig = if fast { "fast" } else { "std" };
            if *self.trig.get_or_insert(trig) != trig {
                return Err(lines.fault("the functions of a package have the same sines"));
            }
            lines.expect_all(if fast { FAST } else { STD }, COMMENTS)?;
        }
        if sign {
            lines.expect_all(SIGN, COMMENTS)?;
        }
        if stribeck {
            lines.expect_all(STRIBECK, COMMENTS)?;
        }
        match lines.ended() {
            true => Ok((own, Function { documentation, program })),
            false => Err(lines.fault(format!("{} behind the end of the file's functions", lines.shown()))),
        }
    }

    /// The function itself, which passes its arguments on; returns its documentation.
    fn in_blocks(
        &self,
        lines: &mut Lines<'_>,
        promise: &'static Promise,
        arguments: &[Argument],
        name: &str,
    ) -> Result<Vec<String>, Fault> {
        let names: Vec<&str> = arguments.iter().map(|a| a.name()).collect();
        let results = results(promise);
        lines.expect(&format!("function {} = {name}({})", listed(&results), names.join(", ")))?;
        let documentation = lines.all.get(lines.at).map_or(Vec::new(), |line| line.comment.clone());
        let columns: Vec<String> = names.iter().map(|name| format!("size({name}, 2)")).collect();
        match columns.as_slice() {
            [one] => lines.expect(&format!("    n = {one};"))?,
            several => {
                let all = several.join(", ");
                lines.expect(&format!("    n = max([{all}]) * min([{all}, 1]);"))?;
            }
        }
        for argument in arguments {
            let rows = argument.length().of(&self.sizes);
            lines.expect(&format!("    check('{0}', {0}, {rows}, n);", argument.name()))?;
        }
        lines.expect("    if n <= 4096")?;
        lines.expect(&format!("        {} = {name}Block({}, n);", listed(&results), names.join(", ")))?;
        lines.expect("        return")?;
        lines.expect("    end")?;
        let parts = promise.returned.named();
        for ((_, lengths), result) in parts.iter().zip(&results) {
            lines.expect(&format!("    {result} = zeros({}, n);", list(&self.lengths(lengths))))?;
        }
        lines.expect("    for first = 1:4096:n")?;
        lines.expect("        k = first:min(first + 4095, n);")?;
        let own = |((_, lengths), result): (&(String, Array), &String)| match lengths.len() {
            0 | 1 => format!("{result}(:, k)"),
            2 => format!("{result}(:, :, k)"),
            _ => format!("{result}(:, :, :, k)"),
        };
        let own: Vec<String> = parts.iter().zip(&results).map(own).collect();
        let columns: Vec<String> = names.iter().map(|name| format!("{name}(:, min(k, size({name}, 2)))")).collect();
        lines.expect(&format!("        {} = {name}Block({}, numel(k));", listed(&own), columns.join(", ")))?;
        lines.expect("    end")?;
        lines.expect("end")?;
        Ok(documentation.into_iter().map(String::from).collect())
    }

    /// The function for a block of states, and whether it needs sines, signs and Stribeck friction.
    fn block<'a>(
        &mut self,
        lines: &mut Lines<'a>,
        (own, promise, arguments): (&str, &'static Promise, Vec<Argument>),
        name: &str,
        parts: &mut Parts<'a>,
    ) -> Result<(Program, [bool; 3]), Fault> {
        let names: Vec<&str> = arguments.iter().map(|a| a.name()).collect();
        let results = results(promise);
        lines.expect(&format!("function {} = {name}Block({}, n)", listed(&results), names.join(", ")))?;
        for name in &names {
            lines.expect(&format!("    {name} = {name}.';"))?;
        }
        let mut body = Body::new(own, arguments, self.syntax, Float::F64, self.steps);
        if lines.peek().starts_with("    [sine, cosine] = ") {
            let line = lines.number();
            let angles = lines.between("    [sine, cosine] = sinCos([", "]);")?;
            for ((sine, cosine), i) in body.angles(angles, line)?.into_iter().zip(1..) {
                let first = body.element(lines, &format!("sine(:, {i})"), sine)?;
                let second = body.element(lines, &format!("cosine(:, {i})"), cosine)?;
                if !first && !second {
                    return Err(lines.fault(format!("neither the sine nor the cosine of angle {i} has a name")));
                }
            }
        }
        body.definitions(lines)?;
        let mut calls = 0;
        while call(parts, lines, &mut body, name, calls + 1)? {
            calls += 1;
            body.definitions(lines)?;
        }
        let named = promise.returned.named();
        for ((_, lengths), result) in named.iter().zip(&results) {
            let entries: usize = self.lengths(lengths).iter().product();
            lines.expect(&format!("    {result} = zeros(n, {entries});"))?;
        }
        for place in promise.returned.places(&self.sizes) {
            let (part, indices) = promise.returned.part_of(&place);
            let lengths = named.iter().find(|(name, _)| *name == part).map_or(Vec::new(), |(_, array)| self.lengths(array));
            let indices: Vec<usize> = indices.split(['[', ']']).filter_map(|index| index.parse().ok()).collect();
            let column = paged(&indices).iter().zip(&lengths).rev().fold(0, |column, (index, length)| column * length + index);
            let line = lines.number();
            let value = lines.between(&format!("    {}(:, {}) = ", camel(&part), column + 1), ";")?;
            body.output(place, value, line)?;
        }
        for ((_, lengths), result) in named.iter().zip(&results) {
            match lengths.len() {
                0 | 1 => lines.expect(&format!("    {result} = {result}.';"))?,
                _ => lines.expect(&format!("    {result} = reshape({result}.', {}, n);", list(&self.lengths(lengths))))?,
            }
        }
        lines.expect("end")?;
        self.steps = body.steps();
        Ok((body.program, body.asks))
    }

    /// The lengths of a result, also for a number.
    fn lengths(&self, array: &[Length]) -> Vec<usize> {
        let lengths: Vec<usize> = array.iter().map(|length| length.of(&self.sizes)).collect();
        paged(if lengths.is_empty() { &[1] } else { &lengths })
    }
}

/// The names of the results of a function.
fn results(promise: &Promise) -> Vec<String> {
    promise.returned.named().iter().map(|(name, _)| camel(name)).collect()
}

/// Names separated by commas, in brackets if there are several.
fn listed(names: &[String]) -> String {
    match names {
        [one] => one.clone(),
        several => format!("[{}]", several.join(", ")),
    }
}

/// The head of a part; its lines are read at its call.
fn part<'a>(parts: &mut Parts<'a>, lines: &mut Lines<'a>) -> Result<(), Fault> {
    let line = lines.number();
    let (name, arguments) = lines.between("function given = ", ")")?.split_once('(').unwrap_or_default();
    let mut arguments: Vec<&str> = arguments.split(", ").collect();
    if arguments.pop() != Some("taken") {
        return Err(Fault { line, reason: "a part takes values, as its last argument".into() });
    }
    let body = lines.at;
    while !lines.is("end") {
        if lines.ended() {
            return Err(lines.fault("the text is cut off"));
        }
        lines.at += 1;
    }
    lines.expect("end")?;
    parts.add(name, arguments, body, line)
}

/// The call of a part; its lines are read as if they were here.
fn call<'a>(
    parts: &mut Parts<'a>,
    lines: &mut Lines<'a>,
    body: &mut Body<'a, '_>,
    function: &str,
    number: usize,
) -> Result<bool, Fault> {
    let name = format!("{function}Part{number}");
    let begin = format!("    given{number} = {name}(");
    if !lines.peek().starts_with(&begin) {
        return Ok(false);
    }
    let line = lines.number();
    let passed = parts.passed(&name, lines)?;
    let names = lines.between(&format!("{begin}{passed}{{"), "});")?;
    let names: Vec<&str> = if names.is_empty() { Vec::new() } else { names.split(", ").collect() };
    let results = |lines: &mut Lines<'a>| {
        let names = lines.between("    given = {", "};")?.split(", ").collect();
        lines.expect("end")?;
        Ok(names)
    };
    parts.take_in(&name, lines, body, (names, line), results, &format!("given{number}"))?;
    Ok(true)
}
