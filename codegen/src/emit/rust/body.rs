//! The body of an emitted function: the lines of its listing, and a long one in parts.
//!
//! A formatter of Rust needs many times the memory of its text, and a hundred times the time of writing a line. Nearly every line of a body
//! fits into one line of text, whose form is known, so these lines are written directly. The formatter only handles longer lines.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::signature::{name, typed, usize_literal};
use super::{formatted, tokens};
use crate::emit::plain::{self, Syntax};
use crate::exact::Number;
use crate::kinds::Scalar;
use crate::program::listing::{decimal, BodyPart, Expression, Line, Listing, Name};
use crate::program::{Function, Module};

/// Indentation of a line of a body.
const INDENT: &str = "    ";

/// Characters of a line of formatted text.
const WIDTH: usize = 89;

/// How Rust writes the elements of a line.
struct Rust(Scalar);

impl Syntax for Rust {
    fn number(&self, value: &Number) -> String {
        decimal(value, self.0)
    }

    fn sign(&self, value: &str) -> String {
        format!("sign({value})")
    }

    fn stribeck(&self, entry: &str, velocity: &str) -> String {
        format!("stribeck({entry}, {velocity})")
    }

    fn fused(&self, [a, b, c]: [String; 3]) -> String {
        format!("Real::mul_add({a}, {b}, {c})")
    }
}

/// Body of a function.
pub(super) struct Body {
    /// Private functions that it calls.
    pub(super) parts: Vec<String>,
    /// Its lines.
    pub(super) lines: Vec<String>,
    /// The entries of the result.
    pub(super) entries: Vec<String>,
    /// The entries in the order in which they are written: numbers first, then by columns.
    pub(super) groups: Vec<Group>,
}

/// Entries that are written together.
pub(super) struct Group {
    /// Which these are.
    pub(super) entries: Vec<usize>,
    /// Number of lines before them.
    pub(super) before: usize,
}

/// The body of a function in one piece: its lines, and the entries of the result.
pub(super) fn whole(module: &Module, function: &Function) -> (Vec<TokenStream>, Vec<TokenStream>) {
    let listing = Listing::of(function);
    let all = [lines(&listing.lines, module.scalar), entries(&listing, module.scalar)];
    let [lines, entries] = all.map(|texts| texts.iter().map(|text| tokens(text)).collect());
    (lines, entries)
}

/// The body of a function.
pub(super) fn body(module: &Module, function: &Function) -> Body {
    let listing = Listing::of(function);
    let entries = entries(&listing, module.scalar);
    let mut groups = groups(&listing, function.quantity.entries_by_columns(&module.sizes()));
    let parts = listing.parts();
    if parts.is_empty() {
        return Body { parts: Vec::new(), lines: lines(&listing.lines, module.scalar), entries, groups };
    }
    let (parts, lines): (Vec<String>, Vec<String>) =
        parts.iter().zip(1..).map(|(part, number)| of_part(module, function, part, number)).unzip();
    // Lines are calls, and what an entry needs may come from any of them.
    groups.iter_mut().filter(|group| group.before > 0).for_each(|group| group.before = lines.len());
    Body { parts, lines, entries, groups }
}

/// Numbers first; then the other entries of each column, after the lines that they use.
fn groups(listing: &Listing, columns: Vec<Vec<usize>>) -> Vec<Group> {
    let is_number = |&entry: &usize| matches!(listing.entries[entry], Expression::Constant(_));
    let (numbers, columns): (Vec<Vec<usize>>, Vec<Vec<usize>>) =
        columns.into_iter().map(|column| column.into_iter().partition(is_number)).unzip();
    let mut numbers = numbers.concat();
    numbers.sort_unstable();
    let group = |entries: Vec<usize>| Group { before: listing.lines_before(&entries), entries };
    [numbers].into_iter().chain(columns).filter(|entries| !entries.is_empty()).map(group).collect()
}

/// A part of a long function, and the line that calls it.
fn of_part(module: &Module, function: &Function, part: &BodyPart, number: usize) -> (String, String) {
    let idents = |names: &[Name]| names.iter().copied().map(name).collect::<Vec<Ident>>();
    let (taken, given) = (idents(&part.taken), idents(&part.given));
    let own = format_ident!("{}_part_{}", function.name(), number);
    let (takes, gives) = (usize_literal(taken.len()), usize_literal(given.len()));
    let signature = part.arguments.iter().map(typed);
    let documentation = format!(" Part {number} of `{}`.", function.name());
    let frame = quote! {
        #[doc = #documentation]
        #[allow(dead_code, clippy::all)]
        #[inline(never)]
        fn #own(#(#signature,)* values: [Real; #takes]) -> [Real; #gives] {}
    };
    let text = framed(frame, &quote!(let [#(#taken),*] = values;), &lines(&part.lines, module.scalar), &quote!([#(#given),*]));
    let list = |names: &[Name]| names.iter().map(|name| name.text()).collect::<Vec<String>>().join(", ");
    let passed: String = part.arguments.iter().map(|argument| format!("{}, ", argument.name())).collect();
    (text, format!("let [{}] = {own}({passed}[{}]);", list(&part.given), list(&part.taken)))
}

/// The text of the function `frame` with these lines in its empty body, between `before` and `behind`.
pub(super) fn framed(frame: TokenStream, before: &TokenStream, lines: &[String], behind: &TokenStream) -> String {
    let mut text = formatted(frame);
    text.truncate(text.trim_end().trim_end_matches('}').len());
    text.push('\n');
    text += &inside(before);
    for line in lines {
        if INDENT.len() + line.len() <= WIDTH {
            for part in [INDENT, line, "\n"] {
                text += part;
            }
        } else {
            text += &inside(&tokens(line));
        }
    }
    text + &inside(behind) + "}\n"
}

/// Formatted statements of a body.
fn inside(statements: &TokenStream) -> String {
    let text = formatted(quote!(fn body() { #statements }));
    let lines = text.split_once('\n').and_then(|(_, lines)| lines.strip_suffix("}\n"));
    lines.unwrap_or_default().into()
}

/// `let tN = ...;`
fn lines(lines: &[Line], scalar: Scalar) -> Vec<String> {
    lines.iter().map(|line| format!("let t{} = {};", line.name, plain::expression(&line.value, &Rust(scalar)))).collect()
}

fn entries(listing: &Listing, scalar: Scalar) -> Vec<String> {
    listing.entries.iter().map(|entry| plain::expression(entry, &Rust(scalar))).collect()
}
