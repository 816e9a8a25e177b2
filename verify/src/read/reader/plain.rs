//! Common parts of the readers for languages other than Rust: lines and their contents.
//!
//! An emitted file is read line by line in its original form. Lines common to all modules are compared with texts stored here; each other line has
//! one of a few forms, including blanks. So no text can occur that a language would read differently (line ends, indentation, continued lines,
//! operators of two characters).
//!
//! ```text
//! sum     = product { (" + " | " - ") product }          product = factor { (" * " | " / ") factor }
//! factor  = ["-"] primary                                primary = number | name | entry | sign(entry) | "(" sum ")"
//! angle   = term { (" + " | " - ") term } [ (" + " | " - ") number ]
//! term    = [ number " * " ] entry
//! ```

mod body;
mod constants;
mod lines;
mod parts;
mod place;

pub(super) use body::{Body, Syntax};
pub(super) use constants::{in_order, is_of_some_arms, sizes, Constants, Entry, CONSTANTS};
pub(super) use lines::{Comments, Lines};
pub(super) use parts::Parts;

use super::lexer::Fault;
use super::Function;
use crate::values::contract::{Promise, Sizes};
use crate::values::program::Argument;

/// The function with this name, and its arguments in a module of these sizes.
pub(super) fn promised(name: &str, sizes: &Sizes) -> Option<(&'static Promise, Vec<Argument>)> {
    let (promise, with) = Promise::of(name)?;
    Some((promise, promise.arguments_of(with, sizes.gravity)))
}

/// The functions after the constants of a module, with everything that belongs to them.
pub(super) trait Functions<'a> {
    /// Takes a function; `None` for another item, such as a part of a function or a result type.
    fn item(&mut self, lines: &mut Lines<'a>) -> Result<Option<(String, Function)>, Fault>;

    /// A part without a call.
    fn unused(&self) -> Option<&'a str>;

    /// Whether the functions use sines, signs, and Stribeck friction.
    fn asks(&self) -> [bool; 3];

    /// Takes all functions up to a line or the end of the text; `has`: whether the module has sines, signs and Stribeck friction.
    fn all(&mut self, lines: &mut Lines<'a>, end: &str, has: [bool; 3]) -> Result<Vec<(String, Read)>, Fault> {
        let mut functions: Vec<(String, Read)> = Vec::new();
        while !lines.ended() && !lines.is(end) {
            if let Some((name, function)) = self.item(lines)? {
                if functions.iter().any(|(other, _)| *other == name) {
                    return Err(lines.fault(format!("function `{name}` stands twice")));
                }
                functions.push((name, Ok(function)));
            }
        }
        if let Some(name) = self.unused() {
            return Err(lines.fault(format!("`{name}` is needed by no function of the module")));
        }
        match has == self.asks() {
            true => Ok(functions),
            false => Err(lines
                .fault("the module has sines, a sign or an exponential that no function needs, or lacks those that one needs")),
        }
    }
}

/// A function or its fault.
type Read = Result<Function, String>;

/// The names of all possible functions of a module of these sizes.
pub(super) fn names_of(sizes: &Sizes) -> impl Iterator<Item = String> {
    let tips: Vec<String> = match sizes.tips.as_slice() {
        [] => vec![String::new()],
        tips => tips.iter().map(|(tip, _)| tip.to_ascii_lowercase() + "_").collect(),
    };
    crate::textbook::reference::PROMISES.iter().flat_map(move |promise| promise.names(&tips))
}

/// `inertia_matrix` as `inertiaMatrix`.
pub(crate) fn camel(name: &str) -> String {
    let mut result = String::new();
    let mut capital = false;
    for c in name.chars() {
        if c == '_' {
            capital = true;
        } else {
            result.push(if capital { c.to_ascii_uppercase() } else { c });
            capital = false;
        }
    }
    result
}
