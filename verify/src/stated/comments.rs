//! The comments of a module in a language other than Rust, against those that armgen writes: one after the other, each in front of its line of
//! code. The first one, the head of the file, is judged by itself.

use std::collections::VecDeque;

use armgen_codegen::emit::{c, javascript, matlab, python, Described, DescribedParameters, Language};

use super::first_difference;
use crate::contract::Promise;
use crate::reader::{camel, fixed_comments, structure, Comment, Module};
use crate::reference::PROMISES;

/// What a comment should be: its text, nothing for the head, and what the line of code behind it begins with.
struct Expected {
    text: Option<String>,
    before: String,
}

impl Expected {
    fn new(text: impl Into<String>, before: impl Into<String>) -> Expected {
        Expected { text: Some(text.into()), before: before.into() }
    }

    fn head() -> Expected {
        Expected { text: None, before: String::new() }
    }
}

/// What a module is described by.
pub(super) struct Words<'a> {
    /// The robot's name.
    pub(super) robot: &'a str,
    /// What is said of parameters.
    pub(super) parameters: DescribedParameters,
    /// What is said of functions, in the order of the module, and of their rounding errors.
    pub(super) functions: Vec<(&'a str, Described<'a>, Option<&'a str>)>,
}

/// The first comment that is not as armgen writes it.
pub(super) fn fault(module: &Module, words: &Words<'_>) -> Option<String> {
    let fixed = fixed_comments(module.language, words.robot);
    let mut expected: VecDeque<Expected> = expected(module, words).into();
    for (k, comment) in module.comments.iter().enumerate() {
        let shown = comment.text.lines().next().unwrap_or("").trim();
        let is_again =
            |other: &Comment| (&other.text, &other.behind, &other.before) == (&comment.text, &comment.behind, &comment.before);
        if k > 0 && is_again(&module.comments[k - 1]) {
            return Some(format!("line {}: the comment `{shown}` stands twice", comment.line));
        }
        let is_same = |other: &Comment| other.text == comment.text && comment.before.starts_with(&*other.before);
        if fixed.iter().any(is_same) || is_of_part(module.language, words.robot, comment) || is_of_results(comment) {
            continue;
        }
        let Some(wanted) = expected.pop_front().filter(|wanted| comment.before.starts_with(&wanted.before)) else {
            return Some(format!(
                "line {}: the comment `{shown}` stands where an emitted module has none of its kind",
                comment.line
            ));
        };
        let Some(text) = wanted.text.filter(|text| *text != comment.text) else { continue };
        if let Some((number, found, wanted)) = first_difference(comment.text.lines(), text.lines()) {
            return Some(format!("line {}: the comment says {found}, not {wanted}", comment.line + number));
        }
    }
    let missing = expected.pop_front()?;
    let text = missing.text.as_deref().and_then(|text| text.lines().next()).unwrap_or("the head of the file").trim();
    Some(format!("the comment `{text}` is not there, in front of `{}`", missing.before.trim()))
}

/// All comments but those that are the same in every module.
fn expected(module: &Module, words: &Words<'_>) -> Vec<Expected> {
    let Words { robot, parameters, functions } = words;
    let mut all = vec![Expected::head()];
    match module.language {
        Language::Rust => all.clear(),
        Language::C => {
            let name = c::spelled(robot);
            if !parameters.parameters.is_empty() {
                all.push(Expected::new(c::parameters_comment(parameters), ""));
            }
            if parameters.base_parameters.as_ref().is_some_and(|named| !named.is_empty()) {
                all.push(Expected::new(c::base_parameters_comment(parameters, &name), ""));
            }
            all.extend(functions.iter().map(|(own, described, note)| {
                let returns = if matches!(described.quantity.result, [part] if part.lengths.is_empty()) {
                    format!("{name}_real")
                } else {
                    "void".into()
                };
                Expected::new(c::function_comment(described, *note, &name), format!("static inline {returns} {name}_{own}("))
            }));
        }
        Language::JavaScript => {
            let constants = javascript::constants_comments(parameters);
            all.extend(constants.into_iter().map(|(name, text)| Expected::new(text, format!("export const {name} = "))));
            all.extend(functions.iter().map(|(own, described, note)| {
                Expected::new(javascript::function_comment(described, *note), format!("export function {}(", camel(own)))
            }));
        }
        Language::Python => {
            let constants = python::constants_comments(parameters);
            all.extend(constants.into_iter().map(|(name, text)| Expected::new(text, format!("{name}: Final = "))));
            all.extend(
                functions
                    .iter()
                    .map(|(_, described, note)| Expected::new(python::function_comment(described, *note), "    xp, shape, (")),
            );
        }
        Language::Matlab => {
            let named: Vec<_> = functions.iter().map(|(own, described, _)| ((*own).to_string(), described.quantity)).collect();
            all.insert(0, Expected::new(matlab::contents_comment(robot, &named), ""));
            // Each file says where it came from.
            let origin =
                |before| Expected::new(format!("%{}\n%#codegen\n", module.head.first().map_or("", String::as_str)), before);
            let constant =
                |(name, text): (&str, String)| Expected::new(text, format!("    m.{} = ", camel(&name.to_ascii_lowercase())));
            let mut files: Vec<(String, Vec<Expected>)> = functions
                .iter()
                .map(|(own, described, note)| {
                    let text = matlab::function_comment(described, *note);
                    let name = camel(own);
                    let block = Expected::new(matlab::block_comment(&name), "    ");
                    (format!("{name}.m"), vec![Expected::new(text, "    n = "), origin("    n = "), block])
                })
                .collect();
            let constants = matlab::constants_comments(parameters).into_iter().map(constant);
            files.push(("model.m".into(), [origin("    m = struct();")].into_iter().chain(constants).collect()));
            files.sort_by(|a, b| a.0.cmp(&b.0));
            all.extend(files.into_iter().flat_map(|(_, comments)| comments));
        }
    }
    all
}

/// Whether a comment says of a part of a long function what it is.
fn is_of_part(language: Language, robot: &str, comment: &Comment) -> bool {
    let (open, close) = match language {
        Language::C | Language::Rust => ("/* ", " */\n"),
        Language::JavaScript => ("/** ", " */\n"),
        Language::Python => return false,
        Language::Matlab => ("% ", "\n"),
    };
    let said =
        comment.text.strip_prefix(open).and_then(|text| text.strip_suffix(close)?.strip_prefix("Part ")?.split_once(" of `"));
    let Some((number, name)) = said.and_then(|(number, name)| Some((number.parse::<u32>().ok()?, name.strip_suffix("`.")?)))
    else {
        return false;
    };
    match language {
        Language::C => {
            let begins = format!("{}_", c::spelled(robot));
            name.starts_with(&begins) && comment.before.starts_with(&format!("static inline void {name}_part_{number}("))
        }
        Language::JavaScript => comment.before.starts_with(&format!("function {name}Part{number}(")),
        _ => comment.behind.starts_with(&format!("function given = {name}Part{number}(")),
    }
}

/// Whether a comment says in Python what holds the results of a function that has several.
fn is_of_results(comment: &Comment) -> bool {
    let of = |promise: &Promise| {
        structure(promise).is_some_and(|name| *comment.behind == *format!("class {name}(NamedTuple):"))
            && comment.text == format!("    \"\"\"Results of `{}`.\"\"\"\n", promise.name)
    };
    PROMISES.iter().any(of)
}
