//! `expect`: the expected results.

use armgen_codegen::document::excerpt;
use armgen_codegen::document::reader::{required, Fields};
use armgen_codegen::document::yaml::Node;
use armgen_codegen::source::{Span, Spanned};
use armgen_codegen::suggest::did_you_mean;

use super::values::{optionals, Allowed, Reader};
use super::Code;
use crate::model::{Body, Channel, Expectation, Take, Target};

/// An expectation with the name of its quantity, before resolution.
pub(super) struct Named {
    quantity: Spanned<String>,
    take: Take,
    target: Target,
}

const TAKES: [&str; 5] = ["at", "peak", "highest", "lowest", "decay"];
const TARGETS: [&str; 5] = ["value", "tolerance", "percent", "at_most", "at_least"];

impl Reader<'_> {
    /// The list under `expect`.
    pub(super) fn expectations(&mut self, fields: &Fields<'_>) -> Vec<Named> {
        let Some((at, node)) = fields.get("expect") else { return Vec::new() };
        let help = "write one `- {quantity: ..., ...}` per line";
        let Some(items) = self.items(node, at, "expect", help) else { return Vec::new() };
        items.iter().filter_map(|item| self.expectation(item, at)).collect()
    }

    fn expectation(&mut self, node: &Node, at: Span) -> Option<Named> {
        let at = if node.span.start < node.span.end { node.span } else { at };
        let mut keys = vec![required("quantity", "quantity: e_z")];
        keys.extend(optionals(&TAKES));
        keys.extend(optionals(&TARGETS));
        let fields = self.mapping(node, "an expectation", at, &keys)?;
        let quantity = self.word(&fields, "quantity")?;
        let take = self.take(&fields)?;
        let target = self.target(&fields)?;
        Some(Named { quantity, take, target })
    }

    fn take(&mut self, fields: &Fields<'_>) -> Option<Take> {
        let given: Vec<&str> = TAKES.iter().copied().filter(|name| fields.has(name)).collect();
        let name = match given[..] {
            [] => return Some(Take::Number),
            ["at"] => return Some(Take::At(self.number(fields, "at", Allowed::NotNegative)?)),
            [name] => name,
            _ => {
                let help = format!("write one of {}", TAKES.join(", "));
                let message = "one number is expected, and more than one is named";
                self.report(Code::Ambiguous, fields.at(), message, given.join(" and "), help);
                return None;
            }
        };
        let [from, to] = self.array(fields, name, "begin and end of the interval in s", Allowed::NotNegative)?;
        if from > to {
            let message = format!("the interval of `{name}` ends before it begins");
            self.report(Code::EmptyInterval, fields.place(name), message, "this one", "write the earlier time first");
            return None;
        }
        if name == "decay" && from == to {
            let help = "write a later time second: a rate is taken from one time to another";
            self.report(Code::EmptyInterval, fields.place(name), "the interval of `decay` has no length", "this one", help);
            return None;
        }
        Some(match name {
            "peak" => Take::Peak(from, to),
            "highest" => Take::Highest(from, to),
            "lowest" => Take::Lowest(from, to),
            _ => Take::Decay(from, to),
        })
    }

    fn target(&mut self, fields: &Fields<'_>) -> Option<Target> {
        // An unreadable target has already been reported.
        let numbers = TARGETS.map(|name| {
            let allowed = if ["tolerance", "percent"].contains(&name) { Allowed::Positive } else { Allowed::Any };
            (fields.has(name), self.number(fields, name, allowed))
        });
        if numbers.iter().any(|(given, number)| *given && number.is_none()) {
            return None;
        }
        match numbers.map(|(_, number)| number) {
            [Some(value), Some(tolerance), None, None, None] => Some(Target::Near { value, tolerance, percent: None }),
            [Some(value), None, Some(p), None, None] => {
                Some(Target::Near { value, tolerance: value.abs() * p / 100.0, percent: Some(p) })
            }
            [None, None, None, Some(bound), None] => Some(Target::AtMost(bound)),
            [None, None, None, None, Some(bound)] => Some(Target::AtLeast(bound)),
            _ => {
                let help = "write `value` with `tolerance` or `percent`, or `at_most`, or `at_least`";
                self.report(Code::NoTarget, fields.at(), "it is not clear what is expected", "here", help);
                None
            }
        }
    }

    /// Resolves the names to channels over time or numbers of the whole run. Times must lie within the run.
    pub(super) fn resolve(&mut self, list: Vec<Named>, body: &Body) -> Vec<Expectation> {
        let (channels, numbers, end) = (body.channels(self.robot), body.numbers(self.robot), body.end());
        let mut resolved = Vec::new();
        for Named { quantity, take, target } in list {
            let is_number = take == Take::Number;
            let (known, other) = if is_number { (&numbers, &channels) } else { (&channels, &numbers) };
            let find = |list: &[Channel]| list.iter().find(|channel| channel.name == quantity.value).cloned();
            match find(known) {
                Some(channel) => resolved.push(Expectation { channel, take, target }),
                None => {
                    let name = &quantity.value;
                    let names: Vec<&str> = known.iter().map(|channel| channel.name.as_str()).collect();
                    let help = match (find(other).is_some(), is_number) {
                        (true, true) => format!("`{name}` changes with time: add `at`, `peak`, `highest`, `lowest` or `decay`"),
                        (true, false) => format!("`{name}` is a number of the whole run: remove the time"),
                        _ => {
                            let meant = did_you_mean(name, &names).map_or_else(String::new, |m| format!("did you mean `{m}`? "));
                            format!("{meant}there are: {}", names.join(", "))
                        }
                    };
                    let message = format!("the run gives no such quantity `{}`", excerpt(name));
                    self.report(Code::UnknownQuantity, quantity.span, message, "unknown quantity", help);
                }
            }
            if let Some(to) = take.end().filter(|to| *to > end + 1e-9) {
                let message = format!("the run ends at {end} s, before {to} s");
                let help = "lengthen `duration`, or look earlier";
                self.report(Code::AfterTheEnd, quantity.span, message, "expected after the end", help);
            }
        }
        resolved
    }
}
