//! The functions once more, for many states at a time.
//!
//! `lanes` takes a block: LANES states side by side, `q[joint][lane]`. Each function is one loop over the lanes, whose body is
//! that of the function for one state. The compiler never unrolls such a long body. The body has no branches and accesses only
//! neighbouring numbers, so the compiler does every step for several lanes in one vector instruction. Values kept as vectors of a
//! type of their own would leave the compiler to find the vectors again, step by step, in thousands of scalars.
//!
//! `batch` takes slices of states as the functions for one state know them, and turns them into blocks and back.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::signature::{self, argument, length as length_of, usize_literal};
use super::{body, documentation, sincos};
use crate::catalogue::{Length, Quantity, ResultPart, Sizes};
use crate::emit::documentation::{self as common, Block};
use crate::program::{Function, Module};

const BLOCKS: &str = include_str!("batch/blocks.rs");

/// The modules `lanes` and `batch`, with this many lanes.
pub(super) fn modules(module: &Module, lanes: usize) -> TokenStream {
    let width = usize_literal(lanes);
    let of_blocks = module.functions.iter().map(|f| of_block(module, f));
    let of_slices = module.functions.iter().map(|f| of_slices(module, f));
    let sines = super::asks_for_sines(module).then(|| sincos::of_lanes(module));
    let structures = signature::structures(module, true);
    let blocks = syn::parse_file(BLOCKS).expect("the text to take in is a Rust file").items;
    quote! {
        /// The functions for `LANES` states at a time, side by side: `q[joint][lane]`, `b[row][column][lane]`. The result is written into the last argument.
        #[allow(dead_code)]
        pub mod lanes {
            use super::*;
            /// States in a block.
            pub const LANES: usize = #width;
            /// A number for each state of a block.
            pub type Lanes = [Real; LANES];
            #(#structures)*
            #(#of_blocks)*
            #sines
        }
        /// The functions over slices of states. Slices are used as far as the shortest of them goes; the results are written into the last one.
        #[allow(dead_code)]
        pub mod batch {
            use super::lanes::LANES;
            use super::*;
            #(#of_slices)*
            #(#blocks)*
        }
    }
}

/// `let ignored = ...; for k in 0..LANES { the body for one state }`
fn of_block(module: &Module, function: &Function) -> TokenStream {
    let name = format_ident!("{}", function.name());
    let documentation = documentation(module, function);
    let sizes = module.sizes();
    let arguments = function.arguments.iter().map(|&a| {
        let (name, length) = argument(a);
        quote!(#name: &[Lanes; #length])
    });
    let ignored = signature::ignored(function);
    let (sine_lines, names) = sincos::lines_of_lanes(module, function);
    let inputs = function.used_arguments().into_iter().map(|a| {
        let (name, _) = argument(a);
        let entries = (0..a.length().of(&sizes)).map(usize_literal).map(|i| quote!(#name[#i][k]));
        quote!(let #name = [#(#entries),*];)
    });
    let (lines, entries) = body::whole(module, function);
    let places = places(function.quantity, &sizes);
    let kind = block_of(function.quantity);
    quote! {
        #(#[doc = #documentation])*
        #[allow(clippy::all)]
        pub fn #name(#(#arguments,)* result: &mut #kind) {
            #ignored
            #(#sine_lines)*
            for k in 0..LANES {
                #(#names)*
                #(#inputs)*
                #(#lines)*
                #(result #places [k] = #entries;)*
            }
        }
    }
}

fn documentation(module: &Module, function: &Function) -> Vec<String> {
    let title = common::function(function, module, false).into_iter().take(1);
    let blocks: Vec<Block> = title.chain([Block::text(format!("As {{{}}} of one state.", function.name()))]).collect();
    documentation::lines(&blocks)
}

/// The type of a block of results.
fn block_of(quantity: &Quantity) -> TokenStream {
    signature::of_parts(quantity, |part| signature::part_type(part, &quote!(Lanes)), |name| quote!(#name))
}

/// Places of the entries of a result in a block, in the order of the entries.
fn places(quantity: &Quantity, sizes: &Sizes) -> Vec<TokenStream> {
    fn indices(lengths: &[Length], sizes: &Sizes) -> Vec<TokenStream> {
        let Some((outer, inner)) = lengths.split_first() else { return vec![quote!()] };
        let inner = indices(inner, sizes);
        let of_row = |row| inner.iter().map(move |rest| quote!([#row] #rest));
        (0..outer.of(sizes)).map(usize_literal).flat_map(of_row).collect()
    }
    let parts = quantity.result.iter().zip(signature::accesses(quantity));
    parts.flat_map(|(part, access)| indices(part.lengths, sizes).into_iter().map(move |at| quote!(#access #at))).collect()
}

/// A block of zeros.
fn zeros(quantity: &Quantity) -> TokenStream {
    let zeros = |part: &ResultPart| {
        part.lengths.iter().rev().fold(quote!([0.0; LANES]), |of, &length| {
            let length = length_of(length);
            quote!([#of; #length])
        })
    };
    signature::of_parts(quantity, zeros, |name| {
        let value = signature::with_fields(name, quantity, zeros);
        quote!(lanes::#value)
    })
}

/// The lines that hand lane `k` of a block to the result of a state.
fn scattered(quantity: &Quantity) -> TokenStream {
    let lines = quantity.result.iter().zip(signature::accesses(quantity)).map(|(part, access)| {
        let flat: TokenStream = part.lengths.iter().skip(1).map(|_| quote!(.as_flattened())).collect();
        let flat_mut: TokenStream = part.lengths.iter().skip(1).map(|_| quote!(.as_flattened_mut())).collect();
        // A result that is one array is a reference already.
        let reference = (!access.is_empty()).then(|| quote!(&mut));
        match part.lengths.len() {
            0 => quote!(scatter(k, &[block #access], core::slice::from_mut(#reference result #access));),
            1 => quote!(scatter(k, &block #access, #reference result #access);),
            _ => quote!(scatter(k, block #access #flat, result #access #flat_mut);),
        }
    });
    quote!(#(#lines)*)
}

fn of_slices(module: &Module, function: &Function) -> TokenStream {
    let name = format_ident!("{}", function.name());
    let documentation = documentation(module, function);
    let names: Vec<Ident> = function.arguments.iter().map(|&a| argument(a).0).collect();
    let arguments = function.arguments.iter().map(|&a| {
        let (name, length) = argument(a);
        quote!(#name: &[[Real; #length]])
    });
    let of_one = signature::type_of(function.quantity);
    let (zero, scatter) = (zeros(function.quantity), scattered(function.quantity));
    let lengths = names.iter().skip(1).map(|n| quote!(.min(#n.len())));
    let first = &names[0];
    let chunks = names.iter().skip(1).map(|n| quote!(.zip(#n.chunks(LANES))));
    let pattern = names.iter().skip(1).fold(quote!(#first), |pattern, n| quote!((#pattern, #n)));
    let blocks: Vec<Ident> = names.iter().map(|n| format_ident!("{n}_block")).collect();
    let sizes = function.arguments.iter().map(|&a| argument(a).1);
    quote! {
        #(#[doc = #documentation])*
        #[allow(clippy::all)]
        pub fn #name(#(#arguments,)* results: &mut [#of_one]) {
            #(let mut #blocks = [[0.0; LANES]; #sizes];)*
            let mut block = #zero;
            for (#pattern, results) in #first.chunks(LANES) #(#chunks)* .zip(results.chunks_mut(LANES)) {
                #(gather(#names, &mut #blocks);)*
                lanes::#name(#(&#blocks,)* &mut block);
                let count = #first.len() #(#lengths)*;
                match results.first_chunk_mut::<LANES>() {
                    Some(results) if count == LANES => {
                        for k in 0..LANES {
                            let result = &mut results[k];
                            #scatter
                        }
                    }
                    _ => {
                        for (result, k) in results.iter_mut().zip(0..count) {
                            #scatter
                        }
                    }
                }
            }
        }
    }
}
