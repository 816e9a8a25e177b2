//! Keys and kinds of values: the required form of a tree of nodes, and the messages about deviations.
//!
//! A reader goes on after every fault, so that all faults of a file come in one go: a value that cannot be read is `None`, and reported.

use std::borrow::Borrow;

use super::yaml::{Kind, Node};
use super::{excerpt, expression, Expression};
use crate::diagnostic::{AnyCode, Code, Diagnostic, Diagnostics};
use crate::source::{Source, Span, Spanned};
use crate::suggest::did_you_mean;

/// A key that a mapping may hold.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The key.
    pub name: &'static str,
    /// Whether its mapping must have it.
    pub required: bool,
    /// An example of the key with a value, for the help; empty if there is no example.
    example: &'static str,
}

/// A key that its mapping must have, and an example.
pub const fn required(name: &'static str, example: &'static str) -> Key {
    Key { name, required: true, example }
}

/// A key that its mapping usually has but may omit, and an example.
pub const fn usual(name: &'static str, example: &'static str) -> Key {
    Key { name, required: false, example }
}

/// A key that may be left out.
pub const fn optional(name: &'static str) -> Key {
    Key { name, required: false, example: "" }
}

/// The known keys of one mapping, with their places and values.
#[derive(Clone, Debug)]
pub struct Fields<'n> {
    at: Span,
    entries: Vec<(&'static str, Span, &'n Node)>,
}

impl<'n> Fields<'n> {
    /// Place of the key and its value.
    pub fn get(&self, name: &str) -> Option<(Span, &'n Node)> {
        self.entries.iter().find(|(known, ..)| *known == name).map(|(_, span, node)| (*span, *node))
    }

    /// Whether the key stands here.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// The beginning of the mapping: the place of diagnostics about missing keys.
    pub fn at(&self) -> Span {
        self.at
    }

    /// Place of a key; if the key is absent, place of the mapping.
    pub fn place(&self, name: &str) -> Span {
        self.get(name).map_or(self.at, |(span, _)| span)
    }
}

/// Reads values; faults go to the diagnostics.
#[derive(Debug)]
pub struct Reader<'d> {
    diagnostics: &'d mut Diagnostics,
    /// Keys that other formats use, and the keys of this format with the same meaning.
    other_names: &'static [(&'static str, &'static str)],
    /// Keys of other formats without an equivalent here. The second word is a key of a mapping in which the first is out of place;
    /// the third is the help.
    other_places: &'static [(&'static str, &'static str, &'static str)],
}

impl<'d> Reader<'d> {
    /// A reader that reports to `diagnostics`.
    pub fn new(diagnostics: &'d mut Diagnostics) -> Reader<'d> {
        Reader { diagnostics, other_names: &[], other_places: &[] }
    }

    /// The same with keys of other formats that have another name here.
    #[must_use]
    pub fn with_other_names(self, other_names: &'static [(&'static str, &'static str)]) -> Reader<'d> {
        Reader { other_names, ..self }
    }

    /// The same with keys that other formats use in mappings that know the second key, and what to write instead.
    #[must_use]
    pub fn with_other_places(self, other_places: &'static [(&'static str, &'static str, &'static str)]) -> Reader<'d> {
        Reader { other_places, ..self }
    }

    /// Reports a fault.
    pub fn report(
        &mut self,
        code: impl Into<AnyCode>,
        span: Span,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.push(Diagnostic::new(code, span, message, label, help));
    }

    /// Reports what another reader found.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Whether an error has been reported.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.has_errors()
    }

    /// The top-level mapping of a file. `what` names the kind of file and `begin` its first keys, for messages.
    pub fn root<'n>(&mut self, source: &Source, root: Option<&'n Node>, what: &str, begin: &str) -> Option<&'n Node> {
        let Some(root) = root.filter(|node| !matches!(&node.kind, Kind::Scalar(s) if s.is_nothing())) else {
            if !self.has_errors() {
                let label = if source.text().trim().is_empty() { "" } else { "no key stands here" };
                self.report(Code::EmptyFile, Span::new(0, 0), "the file describes nothing", label, begin);
            }
            return None;
        };
        if !matches!(root.kind, Kind::Mapping(_)) {
            let message = format!("{what} is a mapping of keys to values, found {}", root.describe());
            self.report(Code::WrongKind, root.span, message, "not `key: value`", begin);
            return None;
        }
        Some(root)
    }

    /// The keys of `m:5` where a mapping is wanted; the missing blank is reported.
    pub fn keys_without_space(&mut self, node: &Node) -> Vec<Spanned<String>> {
        super::yaml::keys_without_space(node, self.diagnostics)
    }

    /// The keys of a mapping; unknown and missing ones are reported, the latter at `at`.
    pub fn mapping<'n>(&mut self, node: &'n Node, what: &str, at: Span, keys: &[impl Borrow<Key>]) -> Option<Fields<'n>> {
        let keys: Vec<&Key> = keys.iter().map(Borrow::borrow).collect();
        let names: Vec<&'static str> = keys.iter().map(|key| key.name).collect();
        let Kind::Mapping(entries) = &node.kind else {
            if !self.keys_without_space(node).is_empty() {
                return None;
            }
            let expected = format!("{what} is a mapping of keys to values, found {}", node.describe());
            let help = format!("{}keys here: {}", written_out(node, what, &keys), names.join(", "));
            self.report(Code::WrongKind, visible(node, at), expected, "not `key: value`", help);
            return None;
        };
        let mut fields = Fields { at, entries: Vec::new() };
        let mut unknown = Vec::new();
        for (place, (key, value)) in entries.iter().enumerate() {
            match names.iter().find(|name| **name == key.value) {
                Some(name) => fields.entries.push((name, key.span, value)),
                None => match place.checked_sub(1).and_then(|before| decimal_comma(&entries[before], key, value)) {
                    Some(help) => {
                        self.report(
                            Code::UnknownKey,
                            key.span,
                            "a decimal has a point, and no comma",
                            "behind a decimal comma",
                            help,
                        );
                    }
                    None => unknown.push((key, value)),
                },
            }
        }
        for (key, value) in unknown {
            let absent: Vec<&'static str> = names.iter().copied().filter(|name| !fields.has(name)).collect();
            // `izz= 0.1`, with the sign that other formats have there.
            let assigned = key.value.split_once('=').map(|(word, behind)| (word.trim(), behind.trim()));
            let word = assigned.map_or(key.value.as_str(), |(word, _)| word);
            let other =
                self.other_names.iter().find(|(other, name)| *other == word && names.contains(name)).map(|(_, name)| *name);
            let place = self.other_places.iter().find(|(other, beside, _)| *other == key.value && names.contains(beside));
            let near = || did_you_mean(word, &absent).or_else(|| did_you_mean(word, &names));
            let meant = other.or_else(|| near().filter(|_| place.is_none()));
            let found = excerpt(&key.value);
            // A character that nobody sees may be all that is wrong with it.
            let hidden = key.value.chars().find_map(super::invisible);
            let seen: String = key.value.chars().filter(|c| super::invisible(*c).is_none()).collect();
            let meant = names.iter().copied().find(|name| *name == seen).or(meant);
            let allowed = format!("keys here: {}", names.join(", "));
            let help = match meant {
                _ if key.value == "<<" => "merge keys are not supported: write the values out".to_owned(),
                _ if hidden.is_some() => format!("{}, stands in it: type the key anew", hidden.unwrap_or_default()),
                Some(meant) => match assigned {
                    Some((_, behind)) => format!("write `{meant}: {}`, with a colon and a space", excerpt(behind)),
                    None => format!("did you mean `{meant}`? {allowed}"),
                },
                None => place.map_or(allowed, |(.., help)| (*help).to_owned()),
            };
            self.report(Code::UnknownKey, key.span, format!("{what} has no key `{found}`"), "unknown key", help);
            // Read it as what was meant, so that its value is checked and the other key is not called missing.
            if let Some(meant) = meant.filter(|meant| !fields.has(meant) && assigned.is_none()) {
                fields.entries.push((meant, key.span, value));
            }
        }
        let missing: Vec<&Key> = keys.iter().copied().filter(|key| key.required && !fields.has(key.name)).collect();
        if !missing.is_empty() {
            let names: Vec<String> = missing.iter().map(|key| format!("`{}`", key.name)).collect();
            let examples: Vec<String> = missing.iter().map(|key| format!("`{}`", key.example)).collect();
            let message = format!("{what} lacks {}", and(&names));
            self.report(Code::MissingKey, at, message, "required here", format!("write for instance {}", and(&examples)));
        }
        Some(fields)
    }

    /// The elements of a list under `key`.
    pub fn list<'n>(&mut self, node: &'n Node, key: Span, name: &str, expected: &str, help: &str) -> Option<&'n [Node]> {
        match &node.kind {
            Kind::List(items) => Some(items),
            _ => {
                self.wrong_kind(node, key, name, expected, help);
                None
            }
        }
    }

    /// A number or an expression.
    pub fn expression(&mut self, node: &Node, key: Span, name: &str, help: &str) -> Option<Expression> {
        match &node.kind {
            Kind::Scalar(s) if !s.is_nothing() && !matches!(s.text.as_str(), "true" | "false") => {
                expression::parse(s, node.span).map_err(|diagnostic| self.push(*diagnostic)).ok()
            }
            _ => {
                self.wrong_kind(node, key, name, "a number or an expression", help);
                None
            }
        }
    }

    /// A text that is neither a list nor a mapping; `expected` is its kind, as in "a name".
    pub fn text(&mut self, node: &Node, key: Span, name: &str, expected: &str, help: &str) -> Option<Spanned<String>> {
        match &node.kind {
            Kind::Scalar(s) if !s.is_nothing() => Some(Spanned::new(s.text.clone(), node.span)),
            _ => {
                self.wrong_kind(node, key, name, expected, help);
                None
            }
        }
    }

    /// One of a few words; another one is reported under `code`.
    pub fn choice<T: Copy>(
        &mut self,
        node: &Node,
        key: Span,
        name: &str,
        words: &[(&'static str, T)],
        code: impl Into<AnyCode>,
        help: &str,
    ) -> Option<Spanned<T>> {
        let names: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        let expected = || format!("one of {}", names.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "));
        let found = match &node.kind {
            Kind::Scalar(s) if !s.is_nothing() => s.text.as_str(),
            _ => {
                self.wrong_kind(node, key, name, &expected(), help);
                return None;
            }
        };
        if let Some((_, value)) = words.iter().find(|(word, _)| *word == found) {
            return Some(Spanned::new(*value, node.span));
        }
        let meant = did_you_mean(found, &names).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        let message = format!("{} cannot be `{}`", quoted(name), excerpt(found));
        self.report(code, node.span, message, format!("not {}", or(&names)), format!("{meant}{help}"));
        None
    }

    /// Reports a value of another kind than `expected`.
    pub fn wrong_kind(&mut self, node: &Node, key: Span, name: &str, expected: &str, help: &str) {
        let found = match &node.kind {
            Kind::Scalar(s) if !s.is_nothing() => format!("`{}`", excerpt(&s.text)),
            _ => node.describe().to_owned(),
        };
        let message = format!("{} must be {expected}, found {found}", quoted(name));
        self.report(Code::WrongKind, visible(node, key), message, "wrong kind of value", help);
    }
}

/// The help for `{mass: 1,2}`, where YAML makes a key of the digits after the comma.
fn decimal_comma((before, value): &(Spanned<String>, Node), key: &Spanned<String>, behind: &Node) -> Option<String> {
    let (Kind::Scalar(whole), Kind::Scalar(nothing)) = (&value.kind, &behind.kind) else { return None };
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let fraction = key.value.split_once(['e', 'E']).map_or(key.value.as_str(), |(digits, _)| digits);
    let fits = nothing.is_nothing() && is_number(whole.text.trim_start_matches('-')) && is_number(fraction);
    fits.then(|| format!("write `{}: {}.{}`", excerpt(&before.value), excerpt(&whole.text), excerpt(&key.value)))
}

/// An example of the mapping that `node` should be, if its keys have examples. A lone number becomes the value of the only key with an
/// example, if that is a number.
fn written_out(node: &Node, what: &str, keys: &[&Key]) -> String {
    let examples: Vec<&str> = keys.iter().map(|key| key.example).filter(|example| !example.is_empty()).collect();
    // `inf` and `nan` are floats, but no values.
    let is_number = |text: &str| text.parse::<f64>().is_ok_and(f64::is_finite);
    let entries = match (&node.kind, &examples[..]) {
        (_, []) => return String::new(),
        (Kind::Scalar(scalar), [only]) if is_number(&scalar.text) => match only.split_once(": ") {
            Some((key, value)) if is_number(value) => format!("{key}: {}", excerpt(&scalar.text)),
            _ => (*only).to_owned(),
        },
        (_, all) => all.join(", "),
    };
    match what.strip_prefix('`').and_then(|rest| rest.strip_suffix('`')) {
        Some(key) => format!("write for instance `{key}: {{{entries}}}`; "),
        None => format!("write for instance `{{{entries}}}`; "),
    }
}

/// The first key of a mapping, or the node itself.
pub fn first_key(node: &Node) -> Span {
    match &node.kind {
        Kind::Mapping(entries) => entries.first().map_or(node.span, |(key, _)| key.span),
        _ => node.span,
    }
}

/// The node's place; its key's place if the node is empty.
fn visible(node: &Node, key: Span) -> Span {
    if node.span.start < node.span.end {
        node.span
    } else {
        key
    }
}

/// A key in backquotes; a description ("an element of ...") as it is.
fn quoted(name: &str) -> String {
    if name.contains(' ') {
        name.to_owned()
    } else {
        format!("`{}`", excerpt(name))
    }
}

/// `a, b and c`.
pub fn and(words: &[String]) -> String {
    join(words, "and")
}

fn or(words: &[&str]) -> String {
    join(&words.iter().map(|w| format!("`{w}`")).collect::<Vec<_>>(), "or")
}

fn join(words: &[String], last: &str) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [start @ .., end] => format!("{} {last} {end}", start.join(", ")),
    }
}
