//! The body of an emitted function: the lines of its listing, and a long one in parts.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::literal::literal;
use super::signature::{argument, input, name, typed, usize_literal};
use crate::kinds::Scalar;
use crate::program::listing::{BodyPart, Expression, Line, Listing};
use crate::program::{Function, Module, Operation};

/// What stands in a function.
pub(super) struct Body {
    /// Private functions that it calls.
    pub(super) parts: Vec<TokenStream>,
    /// Its lines.
    pub(super) lines: Vec<TokenStream>,
    /// The entries of the result.
    pub(super) entries: Vec<TokenStream>,
}

/// The body of a function in one piece: its lines, and the entries of the result.
pub(super) fn whole(module: &Module, function: &Function) -> (Vec<TokenStream>, Vec<TokenStream>) {
    let listing = Listing::of(function);
    (lines(&listing.lines, module.scalar), entries(&listing, module.scalar))
}

/// The body of a function.
pub(super) fn body(module: &Module, function: &Function) -> Body {
    let listing = Listing::of(function);
    let entries = entries(&listing, module.scalar);
    let parts = listing.parts();
    if parts.is_empty() {
        return Body { parts: Vec::new(), lines: lines(&listing.lines, module.scalar), entries };
    }
    let (parts, lines) = parts.iter().zip(1..).map(|(part, number)| of_part(module, function, part, number)).unzip();
    Body { parts, lines, entries }
}

/// A part of a long function, and the line that calls it.
fn of_part(module: &Module, function: &Function, part: &BodyPart, number: usize) -> (TokenStream, TokenStream) {
    let idents = |names: &[_]| names.iter().copied().map(name).collect::<Vec<Ident>>();
    let (taken, given) = (idents(&part.taken), idents(&part.given));
    let own = format_ident!("{}_part_{}", function.name(), number);
    let (takes, gives) = (usize_literal(taken.len()), usize_literal(given.len()));
    let signature = part.arguments.iter().map(typed);
    let inner = lines(&part.lines, module.scalar);
    let documentation = format!(" Part {number} of `{}`.", function.name());
    let text = quote! {
        #[doc = #documentation]
        #[allow(dead_code, clippy::all)]
        #[inline(never)]
        fn #own(#(#signature,)* values: [Real; #takes]) -> [Real; #gives] {
            let [#(#taken),*] = values;
            #(#inner)*
            [#(#given),*]
        }
    };
    let passed = part.arguments.iter().map(|&a| argument(a).0);
    (text, quote!(let [#(#given),*] = #own(#(#passed,)* [#(#taken),*]);))
}

/// `let tN = ...;`
fn lines(lines: &[Line], scalar: Scalar) -> Vec<TokenStream> {
    let line = |line: &Line| {
        let (name, value) = (format_ident!("t{}", line.name), expression(&line.value, scalar));
        quote!(let #name = #value;)
    };
    lines.iter().map(line).collect()
}

fn entries(listing: &Listing, scalar: Scalar) -> Vec<TokenStream> {
    listing.entries.iter().map(|entry| expression(entry, scalar)).collect()
}

fn expression(of: &Expression, scalar: Scalar) -> TokenStream {
    match of {
        Expression::Input(symbol) => input(*symbol),
        Expression::Constant(value) => literal(value, scalar),
        Expression::Stribeck(i, velocity) => {
            let (index, velocity) = (usize_literal(usize::from(*i)), literal(velocity, scalar));
            quote!(stribeck(dq[#index], #velocity))
        }
        Expression::Step(i) => {
            let name = format_ident!("t{i}");
            quote!(#name)
        }
        Expression::Operation(operation, left, right) => {
            let (a, b) = (expression(left, scalar), expression(right, scalar));
            match operation {
                Operation::Add => quote!(#a + #b),
                Operation::Subtract => quote!(#a - #b),
                Operation::Multiply => quote!(#a * #b),
                Operation::Divide => quote!(#a / #b),
                Operation::Sign | Operation::OppositeSign => unreachable!("a listing writes the sign of one operand"),
            }
        }
        Expression::Fused(parts) => {
            let [a, b, c] = parts.each_ref().map(|part| expression(part, scalar));
            quote!(Real::mul_add(#a, #b, #c))
        }
        Expression::Sign(inner) => {
            let inner = expression(inner, scalar);
            quote!(sign(#inner))
        }
        Expression::Negation(inner) => {
            let inner = expression(inner, scalar);
            quote!(-#inner)
        }
        Expression::Brackets(inner) => {
            let inner = expression(inner, scalar);
            quote!((#inner))
        }
    }
}
