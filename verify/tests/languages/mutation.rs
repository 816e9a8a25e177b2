//! Small changes of a module's text in any language, and the checker's reaction.

use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_codegen::validate;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::{Module, ModuleText};
use armgen_verify::values::program::{Program, Step};
use armgen_verify::values::stream::Stream;
use armgen_verify::{prepare, verify_with};

use crate::common;

/// Whether the entries of two programs are the same trees of operations, with the same operands in the same order, regardless of names.
pub(crate) fn same_operations(a: &Program, b: &Program) -> bool {
    fn numbered(program: &Program) -> Vec<usize> {
        // Equal steps have equal numbers; leaves are identified by their content.
        let mut known: Vec<String> = Vec::new();
        let mut index = std::collections::HashMap::new();
        let mut numbers: Vec<usize> = Vec::new();
        for step in &program.steps {
            let key = match step {
                Step::Literal(k) => format!("literal {}", program.literals[*k].text),
                Step::Sine(angle) | Step::Cosine(angle) => {
                    let turn = angle.turn.map(|(k, minus)| (program.literals[program.turns[k]].text.clone(), minus));
                    format!("{} {:?} {turn:?}", if matches!(step, Step::Sine(_)) { "sine" } else { "cosine" }, angle.terms)
                }
                Step::Input(..) | Step::Sign(_) => format!("{step:?}"),
                Step::Stribeck(joint, velocity) => format!("stribeck {joint} {}", program.literals[*velocity].text),
                Step::SignOf(a) => format!("sign of {}", numbers[*a]),
                Step::Negate(a) => format!("-{}", numbers[*a]),
                Step::Add(a, b) => format!("{} + {}", numbers[*a], numbers[*b]),
                Step::Subtract(a, b) => format!("{} - {}", numbers[*a], numbers[*b]),
                Step::Multiply(a, b) => format!("{} * {}", numbers[*a], numbers[*b]),
                Step::Product(a, b) => format!("{} * {} not rounded", numbers[*a], numbers[*b]),
                Step::Divide(a, b) => format!("{} / {}", numbers[*a], numbers[*b]),
            };
            let next = known.len();
            let number = *index.entry(key.clone()).or_insert(next);
            if number == next {
                known.push(key);
            }
            numbers.push(number);
        }
        numbers
    }
    // Both programs share a list of numbers.
    let mut both = a.clone();
    let offset = both.steps.len();
    let (literals, turns) = (both.literals.len(), both.turns.len());
    both.literals.extend(b.literals.iter().cloned());
    both.turns.extend(b.turns.iter().map(|k| k + literals));
    both.steps.extend(b.steps.iter().map(|step| match step.clone() {
        Step::Literal(k) => Step::Literal(k + literals),
        Step::Stribeck(joint, velocity) => Step::Stribeck(joint, velocity + literals),
        Step::Sine(mut angle) => {
            angle.turn = angle.turn.map(|(k, minus)| (k + turns, minus));
            Step::Sine(angle)
        }
        Step::Cosine(mut angle) => {
            angle.turn = angle.turn.map(|(k, minus)| (k + turns, minus));
            Step::Cosine(angle)
        }
        Step::SignOf(a) => Step::SignOf(a + offset),
        Step::Negate(a) => Step::Negate(a + offset),
        Step::Add(a, b) => Step::Add(a + offset, b + offset),
        Step::Subtract(a, b) => Step::Subtract(a + offset, b + offset),
        Step::Multiply(a, b) => Step::Multiply(a + offset, b + offset),
        Step::Product(a, b) => Step::Product(a + offset, b + offset),
        Step::Divide(a, b) => Step::Divide(a + offset, b + offset),
        leaf => leaf,
    }));
    let numbers = numbered(&both);
    let texts = |program: &Program| program.literals.iter().map(|literal| literal.text.clone()).collect::<Vec<_>>();
    a.arguments == b.arguments
        && texts(a) == texts(b)
        && a.outputs.len() == b.outputs.len()
        && a.outputs.iter().zip(&b.outputs).all(|(x, y)| x.place == y.place && numbers[x.step] == numbers[y.step + offset])
}

/// Changes a term or a character of code: a digit, a sign, a letter of a name, a bracket. `None` for a comment line, or if nothing changes.
fn changed(text: &str, code: &[(usize, usize)], stream: &mut Stream) -> Option<(String, String)> {
    let (start, end) = code[stream.below(code.len() as u64) as usize];
    let line = &text[start..end];
    if let Some(new) = larger_change(line, stream) {
        let changed = format!("{}{new}{}", &text[..start], &text[end..]);
        return Some((changed, format!("`{}` for `{}`", new.trim(), line.trim())));
    }
    let places: Vec<usize> = line.char_indices().filter(|(_, c)| c.is_ascii_graphic()).map(|(at, _)| at).collect();
    let at = places[stream.below(places.len() as u64) as usize];
    let old = line.as_bytes()[at] as char;
    let choices: &[char] = match old {
        '0'..='9' => &['0', '1', '2', '3', '4', '5', '6', '7', '8', '9'],
        '+' | '-' | '*' | '/' => &['+', '-', '*', '/'],
        's' | 'c' | 't' | 'q' | 'd' => &['s', 'c', 't', 'q', 'd'],
        _ => &['(', ')', ',', '1', 'x', ' '],
    };
    let new = choices[stream.below(choices.len() as u64) as usize];
    if new == old {
        return None;
    }
    let line = format!("{}{new}{}", &line[..at], &line[at + 1..]);
    let changed = format!("{}{line}{}", &text[..start], &text[end..]);
    Some((changed, format!("`{}` for `{}`", line.trim(), text[start..end].trim())))
}

/// Omits a term, or exchanges sine and cosine, in half of the lines that allow it.
fn larger_change(line: &str, stream: &mut Stream) -> Option<String> {
    let choice = stream.below(4);
    if choice == 0 {
        let terms: Vec<usize> = line.match_indices(" + ").chain(line.match_indices(" - ")).map(|(at, _)| at).collect();
        let at = *terms.get(stream.below(terms.len().max(1) as u64) as usize)?;
        let rest = &line[at + 3..];
        let ends = [" + ", " - ", ")", ";", ","].iter().filter_map(|end| rest.find(end)).min().unwrap_or(rest.len());
        return Some(format!("{}{}", &line[..at], &rest[ends..]));
    }
    let is_wave = |at: &usize| {
        let (before, name) = line.split_at(*at);
        !before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
            && name.starts_with(['s', 'c'])
            && name[1..].starts_with(|c: char| c.is_ascii_digit())
    };
    let waves: Vec<usize> = line.char_indices().map(|(at, _)| at).filter(is_wave).collect();
    let at = *waves.get(stream.below(waves.len().max(1) as u64) as usize).filter(|_| choice == 1)?;
    let other = if line[at..].starts_with('s') { "c" } else { "s" };
    Some(format!("{}{other}{}", &line[..at], &line[at + 1..]))
}

/// Makes this number of code changes; the checker must refuse each text, or read a function other than that of the equations.
pub(crate) fn check(name: &str, language: Language, fuse: bool, wanted: usize) {
    let source = common::source(name);
    let generated = common::generate_with(&source, &Options { trig: Trig::Fast, fuse, ..Options::default() });
    let text = generated.in_language(language);
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    let effort = Effort { points: 2, exact_points: 0, seed: 7 };
    let (manipulator, _) = validate::read_for(&source, Scalar::F64).0.expect("a valid description");
    let whole = ModuleText { language, text: &text };
    let prepared = prepare(manipulator, whole, claims.clone(), effort).expect("a module that can be read");
    let original = Module::read(whole).expect("it was just read");
    // Beginning and end of each line of code.
    let code = code_lines(&text, language);
    let mut stream = Stream::new(4711);
    let (mut refused, mut different, mut idle) = (0, 0, 0);
    while refused + different < wanted {
        let Some((text, change)) = changed(&text, &code, &mut stream) else { continue };
        let changed = ModuleText { language, text: &text };
        let Ok(module) = Module::read(changed) else {
            refused += 1;
            continue;
        };
        if module.constants != original.constants {
            let report = verify_with(&source, changed, claims.clone(), effort);
            assert!(report.first_fault().is_some(), "{name} {language:?}: {change} is not found");
            different += 1;
            continue;
        }
        let functions = module.functions.iter().zip(&original.functions);
        let spoilt: Vec<&str> = functions
            .filter(|((_, a), (_, b))| match (a, b) {
                (Ok(a), Ok(b)) => !same_operations(&a.program, &b.program),
                _ => true,
            })
            .map(|((function, _), _)| function.as_str())
            .collect();
        if spoilt.is_empty() {
            idle += 1;
            assert!(idle < 20, "{name} {language:?}: {change} changes nothing");
            continue;
        }
        let equal = armgen_verify::certificate::report::Verdict::Equal;
        let found = spoilt.iter().any(|function| {
            let read = module.functions.iter().find(|(other, _)| other == function).expect("it stands there");
            prepared.checker.function(function, &read.1, module.real).verdict != equal
        });
        assert!(found, "{name} {language:?}: {change} is not found");
        different += 1;
    }
    println!("{name} {language:?}: {refused} changes are refused, {different} differ from the equations, {idle} are none");
}

/// The positions of the lines of code, including those of sines.
fn code_lines(text: &str, language: Language) -> Vec<(usize, usize)> {
    let mut code = Vec::new();
    let mut at = 0;
    let mut inside = false;
    for line in text.split('\n') {
        let comment = match language {
            Language::Rust => line.trim_start().starts_with("//"),
            Language::C | Language::Cuda | Language::JavaScript => {
                let was = inside;
                inside = (inside || line.starts_with("/*")) && !line.ends_with("*/");
                was || line.starts_with("/*") || line.starts_with("//")
            }
            Language::Python => {
                let quotes = line.matches("\"\"\"").count();
                let was = inside;
                inside ^= quotes == 1;
                was || quotes > 0 || line.starts_with('#')
            }
            Language::Matlab => line.starts_with('%'),
        };
        if !comment && line.chars().any(|c| c.is_ascii_graphic()) {
            code.push((at, at + line.len()));
        }
        at += line.len() + 1;
    }
    code
}
