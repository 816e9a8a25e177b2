//! What a module says of itself in comments, against what was found: the description it was made from, the functions that it lacks, the box
//! and the size of rounding errors, the operations of each function. All other documentation must be that of the catalogue, word for word;
//! in other languages than Rust all comments must be those that armgen writes (`comments`).
//!
//! Not judged: the name of the file and the number of the version in the first line, and which of the ways to derive a function was taken.

mod comments;

use std::collections::BTreeMap;

use armgen_codegen::catalogue::{self, Quantity, METHODS};
use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::derive::Model;
use armgen_codegen::emit::{rust, Described, DescribedParameters, Language};
use armgen_codegen::exact::Number;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::manipulator::{Manipulator, RegressorChoice};
use armgen_codegen::program::listing::decimal;

use crate::bounds::{self, Bound};
use crate::check::Check;
use crate::checker::Checker;
use crate::claims::Claims;
use crate::constants;
use crate::enclosure::Float;
use crate::program::{Program, Step};
use crate::reader::{is_hidden, Function, Module};
use crate::report::Report;

/// The head behind its first line.
const CONVENTIONS: [&str; 3] = [
    "",
    "Conventions: B(q) ddq + C(q, dq) dq + F(dq) + g(q) = tau; SI units and radians; `m[i][j]` is row i, column j; frames are those of",
    "the description. Reference: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control, Springer 2009.",
];

/// Digits of the hash of the description in the head.
const DIGITS: usize = 16;

/// All that is said and is not so. Bounds are judged where the checker has them.
pub fn faults(checker: &Checker, module: &Module, report: &Report) -> Vec<String> {
    let manipulator = checker.manipulator();
    let known: BTreeMap<String, Bound> =
        report.functions.iter().filter_map(|f| Some((f.name.clone(), f.bound.clone()?))).collect();
    let notes = bounds::notes(&known);
    let model = Model::new(manipulator.clone());
    let bounded = match head(module, &report.input, &notes.head, &absent(&model, module)) {
        Ok(bounded) => bounded,
        Err(fault) if Check::Head.is_made() => return vec![format!("the head of the file: {fault}")],
        Err(_) => false,
    };
    let gravity = manipulator.gravity.each_ref().map(|component| nominal(manipulator, component));
    let mut faults = Vec::new();
    for (name, function) in &module.functions {
        let Ok(function) = function else { continue };
        let before = faults.len();
        let rounding = notes.functions.get(name).map(|sentence| bounded.then_some(sentence.as_str()));
        let mut check = |check: Check, prefix: &str, expected: Option<&str>| {
            if let Err(fault) =
                sentence(function, prefix, expected).or_else(|fault| if check.is_made() { Err(fault) } else { Ok(()) })
            {
                faults.push(format!("{name}: {fault}"));
            }
        };
        check(Check::Cost, "Cost: ", Some(&format!("Cost: {}. Derived by ", operations(&function.program))));
        if let Some(expected) = rounding {
            check(Check::Rounding, "Rounding error: ", expected);
        }
        // A line of its own that is wrong is said once.
        if faults.len() == before && module.documentation.is_some() && Check::Prose.is_made() {
            let described = described(manipulator, &gravity, name, function);
            let fault = described.and_then(|described| prose(&described, function, bounded));
            faults.extend(fault.map(|fault| format!("{name}: {fault}")));
        }
    }
    if Check::Meanings.is_made() {
        faults.extend(meanings(&model, module));
    }
    if Check::Combinations.is_made() {
        faults.extend(combinations(&model, module, checker));
    }
    if module.language != Language::Rust && faults.is_empty() && Check::Comments.is_made() {
        let mut functions = Vec::new();
        for (name, function) in &module.functions {
            let Some(described) = function.as_ref().ok().and_then(|own| described(manipulator, &gravity, name, own)) else {
                continue;
            };
            functions.push((name.as_str(), described, notes.functions.get(name).filter(|_| bounded).map(String::as_str)));
        }
        let parameters = described_parameters(&model, module);
        let words = comments::Words { robot: &manipulator.name, parameters, functions };
        faults.extend(comments::fault(module, &words));
    }
    faults
}

/// What the documentation of a function says, from the catalogue, the description and its program; how it was derived as it says itself.
fn described<'a>(manipulator: &Manipulator, gravity: &'a [Number; 3], name: &str, function: &Function) -> Option<Described<'a>> {
    let (quantity, with_parameters) = catalogue::named(name)?;
    let turned = function.program.steps.iter().find_map(|step| match step {
        Step::Sine(angle) | Step::Cosine(angle) if angle.turn.is_some() => angle.terms.last().map(|(joint, _)| joint + 1),
        _ => None,
    });
    let says = |method: &&str| function.documentation.iter().any(|line| line.contains(&format!("Derived by {method}.")));
    let method = METHODS.into_iter().find(says).unwrap_or("a way of its own");
    Some(Described {
        quantity,
        with_parameters,
        gravity,
        has_springs: manipulator.has_springs(),
        has_more_friction: manipulator.has_more_friction(),
        has_stribeck: manipulator.has_stribeck(),
        has_load_friction: manipulator.has_load_friction(),
        grouped: manipulator.regressor == RegressorChoice::Base,
        turned_joint: turned,
        cost: operations(&function.program),
        method,
    })
}

/// The first line of a function's documentation that is not the one of the catalogue; the line of its bound is not looked at.
fn prose(described: &Described<'_>, function: &Function, bounded: bool) -> Option<String> {
    let mut found: Vec<&str> = function.documentation.iter().map(String::as_str).collect();
    if bounded {
        found.pop();
        if found.pop() != Some("") {
            return Some("the documentation does not end in an empty line and the rounding error".into());
        }
    }
    different(&found, &rust::function_documentation(described))
}

/// The first line that is not as expected.
fn different(found: &[&str], expected: &[String]) -> Option<String> {
    let (_, found, expected) = first_difference(found.iter().copied(), expected.iter().map(String::as_str))?;
    Some(format!("the documentation says {found}, not {expected}"))
}

/// The first line in which two texts differ, counted from 0, as it stands in each.
pub(crate) fn first_difference<'a>(
    mut found: impl Iterator<Item = &'a str>,
    mut expected: impl Iterator<Item = &'a str>,
) -> Option<(usize, String, String)> {
    let shown = |line: Option<&str>| line.map_or("nothing".to_string(), |line| format!("`{}`", line.trim()));
    for number in 0.. {
        match (found.next(), expected.next()) {
            (None, None) => break,
            (found, expected) if found != expected => return Some((number, shown(found), shown(expected))),
            _ => {}
        }
    }
    None
}

/// What the documentation says of parameters.
fn meanings(model: &Model, module: &Module) -> Vec<String> {
    let Some(documentation) = &module.documentation else { return Vec::new() };
    let grouped = model.manipulator.regressor == RegressorChoice::Base;
    let mut faults = Vec::new();
    for (constant, found) in documentation {
        let found: Vec<&str> = found.iter().map(String::as_str).collect();
        let parameters = named(model, module, constant);
        let base_parameters = Some(parameters.clone());
        let described = DescribedParameters { grouped, parameters, base_parameters, turn: turn(model, module) };
        let expected = rust::constants_documentation(&described).into_iter().find(|(name, _)| name == constant);
        let expected = expected.map_or(Vec::new(), |(_, lines)| lines);
        faults.extend(different(&found, &expected).map(|fault| format!("{constant}: {fault}")));
    }
    faults
}

/// The base parameters of `base_regressor` that are not those of the description, all of them and each with the value of the combination that is
/// stated beside it.
fn combinations(model: &Model, module: &Module, checker: &Checker) -> Option<String> {
    let own = checker.base()?;
    let names = constants::names(module, "BASE_PARAMETER_NAMES")?;
    let stated = &model.base_parameters().entries;
    if let Some(lost) = stated.iter().find(|parameter| !names.contains(&parameter.name)) {
        return Some(format!("BASE_PARAMETER_NAMES: the base parameter `{}` is not there", lost.name));
    }
    let of_name = |name: &String| Some(stated.iter().find(|parameter| parameter.name == *name)?.nominal.clone());
    let Some(numbers) = names.iter().map(of_name).collect::<Option<Vec<Number>>>() else {
        return Some("BASE_PARAMETER_NAMES: not all of them are base parameters of the arm".into());
    };
    let right = Claims::from_numbers(&BTreeMap::from([(String::new(), numbers)]));
    checker.points().iter().find_map(|point| {
        let (claimed, right) = (point.literals(&own.nominal)?, point.literals(right.of(""))?);
        let k = claimed.iter().zip(&right).position(|(claimed, right)| claimed != right)?;
        Some(format!(
            "NOMINAL_BASE_PARAMETERS: [{k}] is not the combination that is stated of `{}`: {}",
            names[k], own.nominal[k]
        ))
    })
}

/// What the comments of constants say.
fn described_parameters(model: &Model, module: &Module) -> DescribedParameters {
    let of = |constant: &str| named(model, module, constant);
    let has_base = module.constants.contains_key("BASE_PARAMETERS");
    DescribedParameters {
        grouped: model.manipulator.regressor == RegressorChoice::Base,
        parameters: of("PARAMETER_NAMES"),
        base_parameters: has_base.then(|| of("BASE_PARAMETER_NAMES")),
        turn: turn(model, module),
    }
}

/// The names that a constant holds and what they mean.
fn named(model: &Model, module: &Module, constant: &str) -> Vec<(String, String)> {
    let known = if constant == "BASE_PARAMETER_NAMES" { &model.base_parameters().entries } else { &model.parameters.entries };
    let of = |name: String| {
        let meaning = known.iter().find(|parameter| parameter.name == name).map(|parameter| parameter.meaning.clone());
        (name, meaning.unwrap_or_default())
    };
    constants::names(module, constant).unwrap_or_default().into_iter().map(of).collect()
}

/// The lines that say which functions the module lacks, and why.
fn absent(model: &Model, module: &Module) -> Vec<String> {
    let is_there = |name: &String| module.functions.iter().any(|(other, _)| other == name);
    let of = |(quantity, with_parameters): (&'static Quantity, bool)| {
        let name = Some(quantity.function_name(with_parameters)).filter(|name| !is_there(name))?;
        let reason = (quantity.missing)(model, with_parameters).filter(|_| quantity.documentation.said_missing)?;
        Some(format!("There is no `{name}`: {reason}."))
    };
    catalogue::functions().filter_map(of).collect()
}

/// The angle by which the frame of the last link is turned, as documentation has it.
fn turn(model: &Model, module: &Module) -> Option<String> {
    let scalar = match module.real {
        Float::F64 => Scalar::F64,
        Float::F32 => Scalar::F32,
    };
    model.field.turn().map(|turn| decimal(&turn.angle, scalar))
}

/// Whether the name of a file can have a character in the head: what ends or disguises a comment, or means something in one, in any language, is
/// written otherwise there.
fn is_of_a_file(c: char) -> bool {
    !is_hidden(c) && (c.is_alphanumeric() || c == ' ' || (c.is_ascii_graphic() && !"*\\?:=".contains(c)))
}

/// The first line of a file: armgen made it from this description. The name of the file and the number of the version are not judged.
pub(crate) fn origin(first: &str, input: &str) -> Result<(), String> {
    let hash = &input[..DIGITS.min(input.len())];
    let named =
        first.strip_prefix("@generated by armgen ").and_then(|rest| rest.strip_suffix(&format!(" (input {hash}). Do not edit.")));
    let is_number = |version: &str| version.chars().all(|c| c.is_ascii_digit() || c == '.');
    let named = named.and_then(|named| named.split_once(" from ")).filter(|(version, _)| is_number(version));
    if named.is_none_or(|(_, file)| file.contains("(input ") || !file.chars().all(is_of_a_file)) {
        return Err(format!("`{first}` does not say that armgen made it from this description, `(input {hash})`"));
    }
    Ok(())
}

/// The lines in front of all items; whether they have those on rounding errors.
fn head(module: &Module, input: &str, notes: &[String], absent: &[String]) -> Result<bool, String> {
    let mut lines = module.head.iter().map(|line| line.strip_prefix(' ').unwrap_or(line));
    origin(lines.next().unwrap_or(""), input)?;
    for expected in CONVENTIONS {
        same(lines.next(), expected)?;
    }
    let mut rest = lines.peekable();
    let bounded = rest.next_if_eq(&"").is_some();
    if bounded {
        notes.iter().try_for_each(|expected| same(rest.next(), expected))?;
    }
    absent.iter().try_for_each(|expected| same(rest.next(), expected))?;
    match rest.next() {
        None => Ok(bounded),
        Some(line) => Err(format!("`{line}` is not true")),
    }
}

fn same(found: Option<&str>, expected: &str) -> Result<(), String> {
    match found {
        Some(found) if found == expected => Ok(()),
        found => Err(format!("`{}` where an emitted module has `{expected}`", found.unwrap_or(""))),
    }
}

/// Whether documentation has one line with this word, as expected; none where nothing is expected. What ends in a blank is the line's beginning.
fn sentence(function: &Function, prefix: &str, expected: Option<&str>) -> Result<(), String> {
    let word = prefix.trim_end_matches(": ");
    let mut lines = function.documentation.iter().filter(|line| line.contains(word));
    let (found, more) = (lines.next(), lines.next());
    let matches = |found: &str, expected: &str| found == expected || expected.ends_with(' ') && found.starts_with(expected);
    let wrong = |found: &str| Err(format!("the documentation says `{}`, not `{}`", found.trim(), expected.unwrap_or("nothing")));
    match (found, more, expected) {
        (None, _, None) => Ok(()),
        (None, _, Some(expected)) => Err(format!("the documentation does not say `{expected}`")),
        (Some(found), None, Some(expected)) if matches(found.trim_start(), expected) => Ok(()),
        (Some(found), None, _) => wrong(found),
        (_, Some(found), _) => wrong(found),
    }
}

/// The operations of a function in words.
fn operations(program: &Program) -> String {
    let count = |counted: fn(&Step) -> bool| program.steps.iter().filter(|step| counted(step)).count();
    let fused = match count(|step| matches!(step, Step::Product(..))) {
        0 => String::new(),
        fused => format!(" ({fused} fused with an addition)"),
    };
    let parts: Vec<String> = [
        (count(|step| matches!(step, Step::Multiply(..) | Step::Product(..))), "multiplication"),
        (count(|step| matches!(step, Step::Add(..) | Step::Subtract(..))), "addition"),
        (count(|step| matches!(step, Step::Divide(..))), "division"),
        (count(|step| matches!(step, Step::Sine(_))), "sine and cosine pair"),
        (count(|step| matches!(step, Step::Stribeck(..))), "exponential"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| {
        let fused = if what == "multiplication" { fused.as_str() } else { "" };
        format!("{count} {what}{}{fused}", if count == 1 { "" } else { "s" })
    })
    .collect();
    if parts.is_empty() {
        "none, the result is constant".to_string()
    } else {
        parts.join(", ")
    }
}
