//! Values of experiment files: numbers, durations, lists and words under their keys. Reading continues after a reported fault.

use std::time::Duration;

use armgen_codegen::diagnostic::{AnyCode, Code as Shared};
use armgen_codegen::document::excerpt;
use armgen_codegen::document::reader::{self, optional, Fields, Key};
use armgen_codegen::document::yaml::{Kind, Node};
use armgen_codegen::source::{Span, Spanned};
use armgen_codegen::suggest::did_you_mean;
use armgen_runtime::task::Row;

use super::Code;
use crate::model::Robot;

/// The allowed range of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Allowed {
    Any,
    NotNegative,
    Positive,
}

/// The length, meaning and allowed range of a list of numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers<'w> {
    pub(super) len: usize,
    /// The meaning of an element, for the help: "one per joint".
    pub(super) each: &'w str,
    pub(super) allowed: Allowed,
}

/// The document reader, with the robot of the experiment.
pub(super) struct Reader<'r> {
    pub(super) document: reader::Reader<'r>,
    pub(super) robot: &'r Robot,
}

/// Keys that may be left out.
pub(super) fn optionals(names: &[&'static str]) -> Vec<Key> {
    names.iter().copied().map(optional).collect()
}

const NUMBER: &str = "write for instance `0.5`, `1e-3` or `pi/2`";

impl Reader<'_> {
    /// Reports a fault.
    pub(super) fn report(
        &mut self,
        code: impl Into<AnyCode>,
        span: Span,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.document.report(code, span, message, label, help);
    }

    /// The keys of the mapping at `at`; reports unknown and missing keys.
    pub(super) fn mapping<'n>(&mut self, node: &'n Node, what: &str, at: Span, keys: &[Key]) -> Option<Fields<'n>> {
        self.document.mapping(node, what, at, keys)
    }

    /// Reports keys that are meaningless here.
    pub(super) fn out_of_place(&mut self, fields: &Fields<'_>, names: &[&str], why: &str) {
        for name in names {
            if let Some((span, _)) = fields.get(name) {
                let message = format!("`{name}` has no meaning here: {why}");
                self.report(Code::OutOfPlace, span, message, "out of place", "remove it");
            }
        }
    }

    /// Reports the absence of a key that other keys require.
    pub(super) fn require(&mut self, fields: &Fields<'_>, name: &str, what: &str, example: &str) {
        if !fields.has(name) {
            let message = format!("{what} lacks `{name}`");
            self.report(Shared::MissingKey, fields.at(), message, "required here", format!("write for instance `{example}`"));
        }
    }

    fn value(&mut self, node: &Node, at: Span, name: &str, allowed: Allowed) -> Option<Spanned<f64>> {
        let expression = self.document.expression(node, at, name, NUMBER)?;
        let x = match expression.to_f64() {
            Ok(x) => x,
            Err(place) => {
                let help = "write a number, `pi`, `deg(...)` or `sqrt(...)`";
                self.report(Shared::UnknownName, place, "an experiment has no named numbers", "not a number", help);
                return None;
            }
        };
        let (code, wanted): (AnyCode, _) = match allowed {
            _ if !x.is_finite() => (Shared::NotFinite.into(), "a finite number"),
            Allowed::NotNegative if x < 0.0 => (Code::Negative.into(), "zero or more"),
            Allowed::Positive if x <= 0.0 => (Code::NotPositive.into(), "a number above zero"),
            _ => return Some(Spanned::new(x, node.span)),
        };
        let message = format!("`{name}` must be {wanted}, found {x}");
        self.report(code, node.span, message, "cannot be", format!("write {wanted}"));
        None
    }

    /// The number under a key; `None` if the key is absent.
    pub(super) fn number(&mut self, fields: &Fields<'_>, name: &str, allowed: Allowed) -> Option<f64> {
        let (at, node) = fields.get(name)?;
        self.value(node, at, name, allowed).map(|x| x.value)
    }

    /// The duration under a key, in seconds.
    pub(super) fn seconds(&mut self, fields: &Fields<'_>, name: &str, allowed: Allowed) -> Option<Duration> {
        let (at, node) = fields.get(name)?;
        let x = self.value(node, at, name, if allowed == Allowed::Any { Allowed::NotNegative } else { allowed })?;
        let duration = Duration::try_from_secs_f64(x.value).ok().filter(|d| *d <= Duration::from_secs(86_400));
        if duration.is_none_or(|d| d.is_zero() && allowed == Allowed::Positive) {
            let help = "durations are in seconds, from a nanosecond to a day";
            self.report(Shared::OutOfRange, x.span, format!("`{name}` cannot be {} s", x.value), "out of range", help);
            return None;
        }
        duration
    }

    /// The whole number under a key.
    pub(super) fn count(&mut self, fields: &Fields<'_>, name: &str, least: u32, most: u32) -> Option<u32> {
        let (at, node) = fields.get(name)?;
        let x = self.value(node, at, name, Allowed::Any)?;
        if x.value.fract() != 0.0 || x.value < f64::from(least) || x.value > f64::from(most) {
            let help = format!("write a whole number from {least} to {most}");
            self.report(Shared::OutOfRange, x.span, format!("`{name}` cannot be {}", x.value), "out of range", help);
            return None;
        }
        Some(x.value as u32)
    }

    /// A list of exactly `len` numbers.
    pub(super) fn list(&mut self, node: &Node, at: Span, name: &str, wanted: Numbers<'_>) -> Option<Vec<f64>> {
        let Numbers { len, each, allowed } = wanted;
        let help = format!("write {len} numbers in brackets, {each}");
        let items = self.items(node, at, name, &help)?;
        if items.len() != len {
            let message = format!("`{name}` takes {len} numbers, found {}", items.len());
            self.report(Shared::WrongLength, node.span, message, format!("{} instead of {len}", items.len()), help);
            return None;
        }
        let values: Vec<Option<Spanned<f64>>> = items.iter().map(|item| self.value(item, item.span, name, allowed)).collect();
        values.into_iter().map(|value| value.map(|x| x.value)).collect()
    }

    /// The list of numbers under a key; for gains and limits a single number means equal entries.
    pub(super) fn numbers(&mut self, fields: &Fields<'_>, name: &str, wanted: Numbers<'_>) -> Option<Vec<f64>> {
        let (at, node) = fields.get(name)?;
        if let (Kind::Scalar(_), Allowed::Positive | Allowed::NotNegative) = (&node.kind, wanted.allowed) {
            return self.value(node, at, name, wanted.allowed).map(|x| vec![x.value; wanted.len]);
        }
        self.list(node, at, name, wanted)
    }

    /// Exactly `N` numbers under a key.
    pub(super) fn array<const N: usize>(
        &mut self,
        fields: &Fields<'_>,
        name: &str,
        each: &str,
        allowed: Allowed,
    ) -> Option<[f64; N]> {
        self.numbers(fields, name, Numbers { len: N, each, allowed })?.try_into().ok()
    }

    /// Joint variables under a key.
    pub(super) fn joints(&mut self, fields: &Fields<'_>, name: &str) -> Option<Vec<f64>> {
        let each = format!("one per joint of {}, rad or m", self.robot.name);
        self.numbers(fields, name, Numbers { len: self.robot.dof(), each: &each, allowed: Allowed::Any })
    }

    /// Positive numbers under a key, a number per row of the task.
    pub(super) fn rows_of_numbers(&mut self, fields: &Fields<'_>, name: &str, rows: usize) -> Option<Vec<f64>> {
        self.numbers(fields, name, Numbers { len: rows, each: "one per row of the task", allowed: Allowed::Positive })
    }

    /// The elements of a list.
    pub(super) fn items<'n>(&mut self, node: &'n Node, at: Span, name: &str, help: &str) -> Option<&'n [Node]> {
        self.document.list(node, at, name, "a list", help)
    }

    /// The text under a key.
    pub(super) fn word(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<String>> {
        let (at, node) = fields.get(name)?;
        self.document.text(node, at, name, "a text", "write words on one line")
    }

    /// A word from a fixed set under a key.
    pub(super) fn choice<T: Copy>(&mut self, fields: &Fields<'_>, name: &str, words: &[(&'static str, T)]) -> Option<Spanned<T>> {
        let (at, node) = fields.get(name)?;
        let names: Vec<String> = words.iter().map(|(word, _)| format!("`{word}`")).collect();
        self.document.choice(node, at, name, words, Code::UnknownWord, &format!("one of {}", names.join(", ")))
    }

    /// `true` or `false` under a key.
    pub(super) fn switch(&mut self, fields: &Fields<'_>, name: &str) -> Option<bool> {
        self.choice(fields, name, &[("true", true), ("false", false)]).map(|word| word.value)
    }

    /// Distinct rows of the operational space.
    pub(super) fn rows(&mut self, fields: &Fields<'_>, name: &str) -> Option<Vec<Row>> {
        const WORDS: [(&str, Row); 6] =
            [("x", Row::X), ("y", Row::Y), ("z", Row::Z), ("rx", Row::Rx), ("ry", Row::Ry), ("rz", Row::Rz)];
        let (at, node) = fields.get(name)?;
        let help = "name rows out of x y z rx ry rz in brackets, each once";
        let items = self.items(node, at, name, help)?;
        let mut rows = Vec::new();
        for item in items {
            let what = format!("a row of `{name}`");
            let row = self.document.choice(item, item.span, &what, &WORDS, Code::UnknownWord, help)?.value;
            if rows.contains(&row) {
                self.report(Shared::DuplicateTaskRow, item.span, format!("the row `{row}` is named twice"), "again", help);
                return None;
            }
            rows.push(row);
        }
        if rows.is_empty() {
            self.report(Shared::EmptyList, at, format!("`{name}` names no row"), "empty", help);
            return None;
        }
        Some(rows)
    }

    /// A mapping from parameter names to numbers, merged into `values`; `None` if the key is absent.
    pub(super) fn parameters(&mut self, fields: &Fields<'_>, name: &str, mut values: Vec<f64>) -> Option<Vec<f64>> {
        let (at, node) = fields.get(name)?;
        let robot = self.robot;
        let names = robot.parameter_names();
        let Kind::Mapping(entries) = &node.kind else {
            let help = format!("write one `name: value` per parameter; names: {}", names.join(", "));
            self.document.wrong_kind(node, at, name, "a mapping of parameters to values", &help);
            return None;
        };
        for (key, value) in entries {
            match names.iter().position(|known| *known == key.value) {
                Some(index) => {
                    if let Some(x) = self.value(value, key.span, &key.value, Allowed::Any) {
                        values[index] = x.value;
                    }
                }
                None => {
                    let meant = did_you_mean(&key.value, &names).map_or_else(String::new, |m| format!("did you mean `{m}`? "));
                    let message = format!("the robot has no parameter `{}`", excerpt(&key.value));
                    let help = format!("{meant}parameters: {}", names.join(", "));
                    self.report(Shared::UnknownParameter, key.span, message, "unknown parameter", help);
                }
            }
        }
        Some(values)
    }
}
