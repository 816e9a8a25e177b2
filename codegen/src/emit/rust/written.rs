//! Functions that write their result to a place of the caller: `NAME_into`, which the function `NAME` and the C interface call.
//!
//! A compiler gathers the entries of a returned value elsewhere and then copies them. If it sees all entries at once, it combines entries of
//! several columns in vectors. Then the steps of all columns are live, and most are spilled to the stack. So each column is written as soon
//! as its steps are done. A barrier separates two columns: the compiler moves no store across it, and it costs no instruction.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::body::{self, Body};
use super::signature::{accesses, argument, part_type, type_of, typed};
use super::{formatted, result_of};
use crate::catalogue::{Length, Quantity, ResultPart, Sizes};
use crate::emit::plain::places;
use crate::program::Function;

/// A function of more steps than this writes its result; a shorter one reads better as the matrix that it returns, and gains nothing.
const MOST_STEPS_RETURNED: usize = 100;

/// Whether users have the form that writes: of a matrix with a column for each parameter.
fn is_public(quantity: &Quantity) -> bool {
    matches!(quantity.result, [ResultPart { lengths: &[_, Length::Parameters | Length::BaseParameters], .. }])
}

/// Whether a function of its own writes the result.
pub(in crate::emit) fn is_written(function: &Function, sizes: &Sizes) -> bool {
    let has_entries = function.quantity.result.iter().all(|part| !part.lengths.is_empty() && part.len(sizes) > 0);
    has_entries && (is_public(function.quantity) || function.steps.len() > MOST_STEPS_RETURNED)
}

/// The name of that function.
pub(in crate::emit) fn name_into(function: &Function) -> String {
    format!("{}_into", function.name())
}

/// The function without its documentation, and its result writer; `first` comes before the lines.
pub(super) fn function(function: &Function, first: &TokenStream, body: &Body, sizes: &Sizes) -> String {
    let quantity = function.quantity;
    let (name, written) = (format_ident!("{}", function.name()), format_ident!("{}", name_into(function)));
    let (arguments, returns) = (function.arguments.iter().map(typed).collect::<Vec<_>>(), type_of(quantity));
    let names = function.arguments.iter().map(|&a| argument(a).0);
    let (parts, zeros) = (accesses(quantity), result_of(quantity, |part| part_type(part, &quote!(0.0))));
    let returning = formatted(quote! {
        #[allow(dead_code, clippy::all)]
        pub fn #name(#(#arguments),*) -> #returns {
            let mut result = #zeros;
            #written(#(#names,)* #(&mut result #parts),*);
            result
        }
    });
    let results = quantity.result.iter().map(|part| {
        let (name, kind) = (format_ident!("{}", part.name), part_type(part, &quote!(Real)));
        quote!(#name: &mut #kind)
    });
    let documentation = format!(" As [`{name}`], written to {}: every entry.", listed(quantity));
    let public = is_public(quantity).then(|| quote!(pub));
    let frame = quote! {
        #[doc = #documentation]
        #[allow(dead_code, clippy::all)]
        #public fn #written(#(#arguments,)* #(#results),*) {}
    };
    returning + &body::framed(frame, first, &by_groups(quantity, body, sizes), &quote!())
}

/// Barrier between two columns.
pub(super) fn barrier() -> TokenStream {
    quote! {
        /// Between two columns: where there are vectors a compiler would take entries of several columns together, and hold too many values for that.
        #[inline]
        fn barrier() {
            if cfg!(any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128")) {
                core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);
            }
        }
    }
}

/// The parts of a result by their names: `by_q`, `by_dq` and `by_tau`.
fn listed(quantity: &Quantity) -> String {
    let names: Vec<String> = quantity.result.iter().map(|part| format!("`{}`", part.name)).collect();
    match names.split_last() {
        Some((last, others @ [_, ..])) => format!("{} and {last}", others.join(", ")),
        _ => names.concat(),
    }
}

/// The lines of a body, with each group of entries right after the lines that it needs.
fn by_groups(quantity: &'static Quantity, body: &Body, sizes: &Sizes) -> Vec<String> {
    let place = |(part, indices): (&ResultPart, Vec<usize>)| {
        part.name.to_string() + &indices.iter().map(|index| format!("[{index}]")).collect::<String>()
    };
    let places: Vec<String> = places(quantity, sizes).into_iter().map(|entry| place((entry.0, entry.1))).collect();
    let (mut written, mut done) = (Vec::new(), 0);
    for (number, group) in body.groups.iter().enumerate() {
        if number > 0 {
            written.push("barrier();".to_string());
        }
        written.extend(body.lines.iter().take(group.before).skip(done).cloned());
        done = done.max(group.before);
        written.extend(group.entries.iter().map(|&entry| format!("{} = {};", places[entry], body.entries[entry])));
    }
    debug_assert_eq!(done, body.lines.len(), "each line is used by an entry");
    written
}
