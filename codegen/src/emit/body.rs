//! The body of an emitted function: its steps as lines, and a long one in parts.
//!
//! A compiler takes more than twice the time for twice the straight line: scheduling, vectorising and the choice of registers look at a
//! block as a whole. A body of more than [`LONG`] lines therefore becomes several private functions, each of which takes the values that it needs and
//! returns those that later ones need, as arrays; names stay what they would be in one piece.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, TokenStream, TokenTree};
use quote::{format_ident, quote};

use super::literal::literal;
use super::rust::{argument, argument_of, input, usize_literal};
use super::sincos::name_of;
use crate::catalogue::Argument;
use crate::program::{Function, Module, Operand, Operation, Step};
use crate::ring::Symbol;

/// Steps with one use are written inside the step that uses them, up to so many operands in a line.
const OPERANDS_IN_A_LINE: usize = 6;

/// A body of more lines than this is taken apart.
const LONG: usize = 4000;

/// Lines in a part.
const PART: usize = 1500;

/// What stands in a function.
pub(super) struct Body {
    /// Private functions that it calls.
    pub(super) parts: Vec<TokenStream>,
    /// Its lines.
    pub(super) lines: Vec<TokenStream>,
    /// The entries of the result.
    pub(super) entries: Vec<TokenStream>,
}

/// A name that lines use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Name {
    Argument(Argument),
    /// A sine or cosine.
    Angle(Symbol),
    Step(usize),
}

impl Name {
    fn of(symbol: Symbol) -> Name {
        match symbol {
            of_angle if of_angle.angle().is_some() => Name::Angle(of_angle),
            other => Name::Argument(argument_of(other)),
        }
    }

    fn ident(self) -> Ident {
        match self {
            Name::Argument(of) => argument(of).0,
            Name::Angle(symbol) => name_of(symbol),
            Name::Step(i) => format_ident!("t{i}"),
        }
    }
}

/// An expression in the making, with what its surroundings must know of it.
#[derive(Clone)]
struct Text {
    tokens: TokenStream,
    operands: usize,
    operation: Option<Operation>,
    uses: Vec<Name>,
}

impl Text {
    fn inside(&self, outer: Operation, right: bool) -> TokenStream {
        let tokens = &self.tokens;
        let bare = match (self.operation, outer) {
            (None, _) => true,
            (Some(Operation::Multiply | Operation::Divide), Operation::Add | Operation::Subtract) => true,
            (Some(Operation::Add | Operation::Subtract), Operation::Add | Operation::Subtract) => !right,
            (Some(Operation::Multiply | Operation::Divide), Operation::Multiply | Operation::Divide) => !right,
            (Some(Operation::Add | Operation::Subtract), Operation::Multiply | Operation::Divide) => false,
        };
        if bare {
            quote!(#tokens)
        } else {
            quote!((#tokens))
        }
    }
}

/// `let tN = ...;`
struct Line {
    name: usize,
    tokens: TokenStream,
    uses: Vec<Name>,
}

impl Line {
    fn text(&self) -> TokenStream {
        let (name, tokens) = (Name::Step(self.name).ident(), &self.tokens);
        quote!(let #name = #tokens;)
    }
}

/// The body of a function in one piece: its lines, and the entries of the result.
pub(super) fn whole(module: &Module, function: &Function) -> (Vec<TokenStream>, Vec<TokenStream>) {
    let (lines, entries) = written(module, function);
    (lines.iter().map(Line::text).collect(), entries.into_iter().map(|entry| entry.tokens).collect())
}

/// The body of a function.
pub(super) fn body(module: &Module, function: &Function) -> Body {
    let (lines, entries) = written(module, function);
    let texts = entries.iter().map(|entry| entry.tokens.clone()).collect();
    if lines.len() <= LONG {
        return Body { parts: Vec::new(), lines: lines.iter().map(Line::text).collect(), entries: texts };
    }
    // Where each name is used last: beyond the last part for what the result needs.
    let mut last_use: BTreeMap<Name, usize> = BTreeMap::new();
    for (part, chunk) in lines.chunks(PART).enumerate() {
        chunk.iter().flat_map(|line| &line.uses).for_each(|&name| {
            last_use.insert(name, part);
        });
    }
    entries.iter().flat_map(|entry| &entry.uses).for_each(|&name| {
        last_use.insert(name, usize::MAX);
    });
    let (mut parts, mut calls) = (Vec::new(), Vec::new());
    for (part, chunk) in lines.chunks(PART).enumerate() {
        let own: BTreeSet<Name> = chunk.iter().map(|line| Name::Step(line.name)).collect();
        let needed: BTreeSet<Name> =
            chunk.iter().flat_map(|line| line.uses.iter().copied()).filter(|n| !own.contains(n)).collect();
        let handed: Vec<Ident> =
            own.iter().filter(|name| last_use.get(name).is_some_and(|&last| last > part)).map(|name| name.ident()).collect();
        let arguments: Vec<Argument> = needed
            .iter()
            .filter_map(|name| match name {
                Name::Argument(argument) => Some(*argument),
                _ => None,
            })
            .collect();
        let values: Vec<Ident> =
            needed.iter().filter(|name| !matches!(name, Name::Argument(_))).map(|name| name.ident()).collect();
        let name = format_ident!("{}_part_{}", function.name(), part + 1);
        let (taken, given) = (usize_literal(values.len()), usize_literal(handed.len()));
        let signature = arguments.iter().map(|&a| {
            let (name, length) = argument(a);
            quote!(#name: &[Real; #length])
        });
        let inner = chunk.iter().map(Line::text);
        let documentation = format!(" Part {} of `{}`.", part + 1, function.name());
        parts.push(quote! {
            #[doc = #documentation]
            #[allow(dead_code, clippy::all)]
            #[inline(never)]
            fn #name(#(#signature,)* values: [Real; #taken]) -> [Real; #given] {
                let [#(#values),*] = values;
                #(#inner)*
                [#(#handed),*]
            }
        });
        let passed = arguments.iter().map(|&a| argument(a).0);
        calls.push(quote!(let [#(#handed),*] = #name(#(#passed,)* [#(#values),*]);));
    }
    Body { parts, lines: calls, entries: texts }
}

/// Lines and entries of the result, in one piece.
fn written(module: &Module, function: &Function) -> (Vec<Line>, Vec<Text>) {
    let mut uses = vec![0usize; function.steps.len()];
    let operands = function.steps.iter().flat_map(|s| [&s.left, &s.right]).chain(function.outputs.iter().map(|o| &o.operand));
    for operand in operands {
        if let Operand::Step(i) = operand {
            uses[*i as usize] += 1;
        }
    }
    let mut lines = Vec::new();
    let mut texts: Vec<Option<Text>> = vec![None; function.steps.len()];
    let operand = |texts: &[Option<Text>], operand: &Operand| match operand {
        Operand::Step(i) => texts[*i as usize].clone().expect("a step stands after those that it uses"),
        Operand::Input(symbol) => Text { tokens: input(*symbol), operands: 1, operation: None, uses: vec![Name::of(*symbol)] },
        Operand::Constant(value) => {
            Text { tokens: literal(value, module.scalar), operands: 1, operation: None, uses: Vec::new() }
        }
    };
    for (index, Step { operation, left, right }) in function.steps.iter().enumerate() {
        let (left, right) = (operand(&texts, left), operand(&texts, right));
        let (a, b) = (left.inside(*operation, false), right.inside(*operation, true));
        let tokens = match operation {
            Operation::Add => quote!(#a + #b),
            Operation::Subtract => quote!(#a - #b),
            Operation::Multiply => quote!(#a * #b),
            Operation::Divide => quote!(#a / #b),
        };
        let used = [left.uses, right.uses].concat();
        let text = Text { tokens, operands: left.operands + right.operands, operation: Some(*operation), uses: used };
        let text = if uses[index] == 1 && text.operands <= OPERANDS_IN_A_LINE {
            text
        } else {
            let name = lines.len() + 1;
            lines.push(Line { name, tokens: text.tokens, uses: text.uses });
            let ident = Name::Step(name).ident();
            Text { tokens: quote!(#ident), operands: 1, operation: None, uses: vec![Name::Step(name)] }
        };
        texts[index] = Some(text);
    }
    let entries = function.outputs.iter().map(|output| {
        let text = operand(&texts, &output.operand);
        let tokens = &text.tokens;
        // `--x` is no decrement in Rust, but the compiler warns of it.
        let signed = matches!(tokens.clone().into_iter().next(), Some(TokenTree::Punct(p)) if p.as_char() == '-');
        let tokens = match (output.negated, text.operation) {
            (false, _) => quote!(#tokens),
            (true, None | Some(Operation::Multiply | Operation::Divide)) if !signed => quote!(-#tokens),
            (true, _) => quote!(-(#tokens)),
        };
        Text { tokens, ..text }
    });
    let entries = entries.collect();
    (lines, entries)
}
