//! Names, arguments and types of emitted functions in Rust.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote, ToTokens};

use crate::catalogue::{Argument, Length, Quantity, ResultPart};
use crate::program::listing::Name;
use crate::program::{Function, Module};

pub(super) fn usize_literal(value: usize) -> Literal {
    Literal::usize_unsuffixed(value)
}

/// A name that lines use.
pub(super) fn name(name: Name) -> Ident {
    format_ident!("{}", name.text())
}

/// The types that hold the parts of results, each once; for functions of many states they hold a block.
pub(super) fn structures(module: &Module, of_blocks: bool) -> Vec<TokenStream> {
    let mut quantities: Vec<&Quantity> = module.functions.iter().map(|function| function.quantity).collect();
    quantities.dedup();
    let structure = |quantity: &Quantity| {
        let structure = quantity.structure?;
        let name = format_ident!("{}", structure.name);
        let entry = if of_blocks { quote!(Lanes) } else { quote!(Real) };
        let title = format!(" {} {}.", structure.title, if of_blocks { "of a block" } else { "at one state" });
        let fields = quantity.result.iter().map(|part| {
            let [words, rest] = part.meaning;
            let (field, kind) = (format_ident!("{}", part.name), part_type(part, &entry));
            let meaning = if of_blocks { format!(" {words}.") } else { format!(" {words}{rest}.") };
            quote!(#[doc = #meaning] pub #field: #kind)
        });
        let allowed = (!of_blocks).then(|| quote!(#[allow(dead_code)]));
        Some(quote! {
            #[doc = #title]
            #allowed
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct #name {
                #(#fields,)*
            }
        })
    };
    quantities.into_iter().filter_map(structure).collect()
}

/// The name of an argument and its array length.
pub(super) fn argument(argument: Argument) -> (Ident, TokenStream) {
    (format_ident!("{}", argument.name()), length(argument.length()))
}

/// An argument with its type.
pub(super) fn typed(of: &Argument) -> TokenStream {
    let (name, length) = argument(*of);
    quote!(#name: &[Real; #length])
}

/// A dimension: the constant that holds it, or the number.
pub(super) fn length(length: Length) -> TokenStream {
    match length {
        Length::Fixed(value) => usize_literal(value).into_token_stream(),
        named => format_ident!("{}", named.constant()).into_token_stream(),
    }
}

/// The line `let _ = ...;` for unused arguments.
pub(super) fn ignored(function: &Function) -> Option<TokenStream> {
    let unused: Vec<Ident> = function.unused_arguments().into_iter().map(|a| argument(a).0).collect();
    match unused.as_slice() {
        [] => None,
        [one] => Some(quote!(let _ = #one;)),
        several => Some(quote!(let _ = (#(#several),*);)),
    }
}

/// The type of a result.
pub(super) fn type_of(quantity: &Quantity) -> TokenStream {
    of_parts(quantity, |part| part_type(part, &quote!(Real)), |name| quote!(#name))
}

/// The type of a part of a result: its entries in arrays, outermost first.
pub(super) fn part_type(part: &ResultPart, entry: &TokenStream) -> TokenStream {
    part.lengths.iter().rev().fold(entry.clone(), |of, &dimension| {
        let dimension = length(dimension);
        quote!([#of; #dimension])
    })
}

/// A result: its only part, the structure of its parts by `structure` of that name, or a list of them.
pub(super) fn of_parts(
    quantity: &Quantity,
    mut part: impl FnMut(&ResultPart) -> TokenStream,
    structure: impl FnOnce(&Ident) -> TokenStream,
) -> TokenStream {
    match (quantity.result, quantity.structure) {
        ([one], _) => part(one),
        (_, Some(named)) => structure(&format_ident!("{}", named.name)),
        (parts, None) => {
            let parts = parts.iter().map(part);
            quote!((#(#parts),*))
        }
    }
}

/// A structure whose parts are these.
pub(super) fn with_fields(name: &Ident, quantity: &Quantity, part: impl FnMut(&ResultPart) -> TokenStream) -> TokenStream {
    let fields = quantity.result.iter().map(|part| format_ident!("{}", part.name));
    let parts = quantity.result.iter().map(part);
    quote!(#name { #(#fields: #parts),* })
}

/// How each part of a result is written after the result: nothing for the only one, `.inertia` in a structure, `.0` in a list.
pub(in crate::emit) fn accesses(quantity: &Quantity) -> Vec<TokenStream> {
    match (quantity.result, quantity.structure) {
        ([_], _) => vec![quote!()],
        (parts, Some(_)) => {
            let fields = parts.iter().map(|part| format_ident!("{}", part.name));
            fields.map(|field| quote!(.#field)).collect()
        }
        (parts, None) => (0..parts.len()).map(usize_literal).map(|field| quote!(.#field)).collect(),
    }
}
