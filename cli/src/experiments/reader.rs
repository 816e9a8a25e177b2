//! Tree of nodes -> keys, numbers, lists and words, each with its place; what does not fit is a fault, and reading goes on.

use std::time::Duration;

use armgen_codegen::document::yaml::{Kind, Node};
use armgen_codegen::document::{did_you_mean, excerpt, parse_expression};
use armgen_codegen::source::{Span, Spanned};
use armgen_runtime::task::Row;

use super::fault::Faults;

/// Names of the rows of the operational space, in the order of [`Row`].
pub(crate) const ROWS: [(&str, Row); 6] =
    [("x", Row::X), ("y", Row::Y), ("z", Row::Z), ("rx", Row::Rx), ("ry", Row::Ry), ("rz", Row::Rz)];

/// The name of a row.
pub(crate) fn row_name(row: Row) -> &'static str {
    ROWS[row.index()].0
}

/// The known keys of one mapping.
pub(crate) struct Fields<'n> {
    /// Where the mapping begins, for what is missing in it.
    pub(crate) at: Span,
    entries: Vec<(&'static str, Span, &'n Node)>,
}

impl<'n> Fields<'n> {
    /// Place of the key and its value.
    pub(crate) fn get(&self, name: &str) -> Option<(Span, &'n Node)> {
        self.entries.iter().find(|(known, ..)| *known == name).map(|(_, span, node)| (*span, *node))
    }

    /// Place of a key, or of the mapping where there is none.
    pub(crate) fn place(&self, name: &str) -> Span {
        self.get(name).map_or(self.at, |(span, _)| span)
    }
}

/// What numbers are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Allowed {
    Any,
    NotNegative,
    Positive,
}

/// Reads values; faults gather in it.
#[derive(Default)]
pub(crate) struct Reader {
    pub(crate) faults: Faults,
}

fn is_nothing(node: &Node) -> bool {
    matches!(&node.kind, Kind::Scalar(s) if s.is_nothing())
}

fn quoted(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

impl Reader {
    /// The keys of a mapping that stands under `at`; unknown and missing ones are faults.
    pub(crate) fn mapping<'n>(
        &mut self,
        node: &'n Node,
        what: &str,
        at: Span,
        required: &[&'static str],
        optional: &[&'static str],
    ) -> Option<Fields<'n>> {
        let names: Vec<&'static str> = required.iter().chain(optional).copied().collect();
        let allowed = format!("keys here: {}", names.join(", "));
        let Kind::Mapping(entries) = &node.kind else {
            let span = if node.span.start < node.span.end { node.span } else { at };
            let message = format!("{what} is a mapping of keys to values, found {}", node.describe());
            self.faults.add("wrong-kind", span, message, "not `key: value`", allowed);
            return None;
        };
        let mut fields = Fields { at, entries: Vec::new() };
        for (key, value) in entries {
            match names.iter().find(|name| **name == key.value) {
                Some(name) => fields.entries.push((name, key.span, value)),
                None => {
                    let meant = did_you_mean(&key.value, &names);
                    let help = meant.map_or(allowed.clone(), |meant| format!("did you mean `{meant}`? {allowed}"));
                    let message = format!("{what} has no key `{}`", excerpt(&key.value));
                    self.faults.add("unknown-key", key.span, message, "unknown key", help);
                    if let Some(meant) = meant.filter(|meant| fields.get(meant).is_none()) {
                        fields.entries.push((meant, key.span, value));
                    }
                }
            }
        }
        let missing: Vec<&str> = required.iter().copied().filter(|name| fields.get(name).is_none()).collect();
        if !missing.is_empty() {
            let message = format!("{what} lacks {}", quoted(&missing));
            self.faults.add("missing-key", at, message, "required here", allowed);
        }
        Some(fields)
    }

    fn value(&mut self, node: &Node, at: Span, name: &str, allowed: Allowed) -> Option<Spanned<f64>> {
        let scalar = match &node.kind {
            Kind::Scalar(scalar) if !scalar.is_nothing() => scalar,
            _ => {
                let span = if node.span.start < node.span.end { node.span } else { at };
                let message = format!("`{name}` must be a number, found {}", node.describe());
                self.faults.add("wrong-kind", span, message, "not a number", "write for instance `0.5`, `1e-3` or `pi/2`");
                return None;
            }
        };
        let value = match parse_expression(scalar, node.span) {
            Ok(expression) => expression.to_f64(),
            Err(diagnostic) => {
                let mut one = armgen_codegen::diagnostic::Diagnostics::new();
                one.push(*diagnostic);
                self.faults.extend(&one);
                return None;
            }
        };
        let x = match value {
            Ok(x) => x,
            Err(place) => {
                let help = "write a number, `pi`, `deg(...)` or `sqrt(...)`";
                self.faults.add("unknown-name", place, "an experiment has no named numbers", "not a number", help);
                return None;
            }
        };
        let (bad, what, help) = match allowed {
            _ if !x.is_finite() => (true, "not-finite", "write a finite number"),
            Allowed::Any => (false, "", ""),
            Allowed::NotNegative => (x < 0.0, "negative", "write zero or more"),
            Allowed::Positive => (x <= 0.0, "not-positive", "write a number above zero"),
        };
        if bad {
            let message = format!("`{name}` must be {}, found {x}", help.trim_start_matches("write "));
            self.faults.add(what, node.span, message, "cannot be", help);
            return None;
        }
        Some(Spanned::new(x, node.span))
    }

    /// The number under a key; `None` where there is no such key.
    pub(crate) fn number(&mut self, fields: &Fields<'_>, name: &str, allowed: Allowed) -> Option<f64> {
        let (at, node) = fields.get(name)?;
        self.value(node, at, name, allowed).map(|x| x.value)
    }

    /// The duration under a key, in seconds.
    pub(crate) fn seconds(&mut self, fields: &Fields<'_>, name: &str, allowed: Allowed) -> Option<Duration> {
        let (at, node) = fields.get(name)?;
        let x = self.value(node, at, name, if allowed == Allowed::Any { Allowed::NotNegative } else { allowed })?;
        let duration = Duration::try_from_secs_f64(x.value).ok().filter(|d| *d <= Duration::from_secs(86_400));
        if duration.is_none_or(|d| d.is_zero() && allowed == Allowed::Positive) {
            let help = "durations are in seconds, from a nanosecond to a day";
            self.faults.add("out-of-range", x.span, format!("`{name}` cannot be {} s", x.value), "out of range", help);
            return None;
        }
        duration
    }

    /// The whole number under a key.
    pub(crate) fn count(&mut self, fields: &Fields<'_>, name: &str, least: u32, most: u32) -> Option<u32> {
        let (at, node) = fields.get(name)?;
        let x = self.value(node, at, name, Allowed::Any)?;
        if x.value.fract() != 0.0 || x.value < f64::from(least) || x.value > f64::from(most) {
            let help = format!("write a whole number from {least} to {most}");
            self.faults.add("out-of-range", x.span, format!("`{name}` cannot be {}", x.value), "out of range", help);
            return None;
        }
        Some(x.value as u32)
    }

    /// A list of exactly `len` numbers.
    pub(crate) fn list(
        &mut self,
        node: &Node,
        at: Span,
        name: &str,
        len: usize,
        each: &str,
        allowed: Allowed,
    ) -> Option<Vec<f64>> {
        let help = format!("write {len} numbers in brackets, {each}");
        let items = self.items(node, at, name, &help)?;
        if items.len() != len {
            let message = format!("`{name}` takes {len} numbers, found {}", items.len());
            self.faults.add("wrong-length", node.span, message, format!("{} instead of {len}", items.len()), help);
            return None;
        }
        let values: Vec<Option<Spanned<f64>>> = items.iter().map(|item| self.value(item, item.span, name, allowed)).collect();
        values.into_iter().map(|value| value.map(|x| x.value)).collect()
    }

    /// Under a key: exactly `N` numbers.
    pub(crate) fn array<const N: usize>(
        &mut self,
        fields: &Fields<'_>,
        name: &str,
        each: &str,
        allowed: Allowed,
    ) -> Option<[f64; N]> {
        let (at, node) = fields.get(name)?;
        self.list(node, at, name, N, each, allowed)?.try_into().ok()
    }

    /// The elements of a list.
    pub(crate) fn items<'n>(&mut self, node: &'n Node, at: Span, name: &str, help: &str) -> Option<&'n [Node]> {
        match &node.kind {
            Kind::List(items) => Some(items),
            _ => {
                let span = if node.span.start < node.span.end { node.span } else { at };
                let message = format!("`{name}` must be a list, found {}", node.describe());
                self.faults.add("wrong-kind", span, message, "not a list", help);
                None
            }
        }
    }

    /// The text under a key.
    pub(crate) fn word(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<String>> {
        let (at, node) = fields.get(name)?;
        match &node.kind {
            Kind::Scalar(s) if !is_nothing(node) => Some(Spanned::new(s.text.clone(), node.span)),
            _ => {
                let span = if node.span.start < node.span.end { node.span } else { at };
                let message = format!("`{name}` must be a text, found {}", node.describe());
                self.faults.add("wrong-kind", span, message, "not a text", "write words on one line");
                None
            }
        }
    }

    /// One of a few words.
    pub(crate) fn choice<T: Copy>(&mut self, word: &Spanned<String>, name: &str, words: &[(&str, T)]) -> Option<T> {
        if let Some((_, value)) = words.iter().find(|(known, _)| *known == word.value) {
            return Some(*value);
        }
        let names: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
        let meant = did_you_mean(&word.value, &names).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        let message = format!("`{name}` cannot be `{}`", excerpt(&word.value));
        self.faults.add("unknown-word", word.span, message, "not known", format!("{meant}one of {}", quoted(&names)));
        None
    }

    /// Different rows of the operational space.
    pub(crate) fn rows(&mut self, fields: &Fields<'_>, name: &str) -> Option<Vec<Row>> {
        let (at, node) = fields.get(name)?;
        let help = "name rows out of x y z rx ry rz in brackets, each once";
        let items = self.items(node, at, name, help)?;
        let mut rows = Vec::new();
        for item in items {
            let word = match &item.kind {
                Kind::Scalar(s) => Spanned::new(s.text.clone(), item.span),
                _ => Spanned::new(String::new(), item.span),
            };
            let row = self.choice(&word, name, &ROWS)?;
            if rows.contains(&row) {
                self.faults.add("duplicate-row", item.span, format!("the row `{}` is named twice", word.value), "again", help);
                return None;
            }
            rows.push(row);
        }
        if rows.is_empty() {
            self.faults.add("empty-list", at, format!("`{name}` names no row"), "empty", help);
            return None;
        }
        Some(rows)
    }

    /// A mapping of parameters' names to numbers, applied to `values`.
    pub(crate) fn parameters(&mut self, fields: &Fields<'_>, name: &str, names: &[&str], values: &mut [f64]) -> bool {
        let Some((at, node)) = fields.get(name) else { return false };
        let Kind::Mapping(entries) = &node.kind else {
            let help = format!("write one `name: value` per parameter; names: {}", names.join(", "));
            let message = format!("`{name}` is a mapping of parameters to values, found {}", node.describe());
            self.faults.add("wrong-kind", at, message, "not `name: value`", help);
            return false;
        };
        for (key, value) in entries {
            match names.iter().position(|known| *known == key.value) {
                Some(index) => {
                    if let Some(x) = self.value(value, key.span, &key.value, Allowed::Any) {
                        values[index] = x.value;
                    }
                }
                None => {
                    let meant = did_you_mean(&key.value, names).map_or_else(String::new, |m| format!("did you mean `{m}`? "));
                    let message = format!("the robot has no parameter `{}`", excerpt(&key.value));
                    let help = format!("{meant}parameters: {}", names.join(", "));
                    self.faults.add("unknown-parameter", key.span, message, "unknown parameter", help);
                }
            }
        }
        true
    }
}
