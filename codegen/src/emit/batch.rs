//! The functions once more, for many states at a time.
//!
//! `lanes` takes a block: LANES states side by side, `q[joint][lane]`. Each function is one loop over the lanes, whose body is that of the
//! function for one state. A body so long is never unrolled, reads and writes only neighbouring numbers and branches nowhere, so the compiler does
//! every step for several lanes in one vector instruction. Values kept as vectors of a type of their own would leave the compiler to find the
//! vectors again, step by step, in thousands of scalars.
//!
//! `batch` takes slices of states as the functions for one state know them, and turns them into blocks and back.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::rust::{self, argument, usize_literal};
use super::{documentation, sincos};
use crate::equations::Shape;
use crate::program::{Function, Module};

const BLOCKS: &str = include_str!("batch/blocks.rs");

/// The modules `lanes` and `batch`, of so many lanes.
pub(super) fn modules(module: &Module, lanes: usize) -> TokenStream {
    let width = usize_literal(lanes);
    let of_blocks = module.functions.iter().map(|f| of_block(module, f));
    let of_slices = module.functions.iter().map(|f| of_slices(module, f));
    let sines = rust::asks_for_sines(module).then(|| sincos::of_lanes(module));
    let terms = rust::returns(module, Shape::EquationsOfMotion).then(|| {
        quote! {
            /// The terms of the equation of motion of a block.
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct EquationsOfMotion {
                /// Inertia matrix B(q).
                pub inertia: [[Lanes; DOF]; DOF],
                /// Coriolis and centrifugal matrix C(q, dq).
                pub coriolis: [[Lanes; DOF]; DOF],
                /// Gravity term g(q).
                pub gravity: [Lanes; DOF],
            }
        }
    });
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
            #terms
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
    let dof = module.joints.len();
    let arguments = function.arguments.iter().map(|&a| {
        let (name, length) = argument(a);
        quote!(#name: &[Lanes; #length])
    });
    let (used, ignored) = rust::used_and_ignored(function);
    let (sine_lines, names) = sincos::lines_of_lanes(module, &rust::symbols(function));
    let inputs = used.iter().map(|&a| {
        let (name, _) = argument(a);
        let length = if name == "pi" { module.parameters.len() } else { dof };
        let entries = (0..length).map(usize_literal).map(|i| quote!(#name[#i][k]));
        quote!(let #name = [#(#entries),*];)
    });
    let (lines, entries) = super::body::whole(module, function);
    let places = places(function.quantity.shape(), dof, entries.len());
    let kind = block_of(function.quantity.shape());
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
    let mut lines: Vec<String> = documentation::function(function, &module.gravity).into_iter().take(1).collect();
    lines.extend([String::new(), format!(" As `{}` of one state.", function.name())]);
    lines
}

/// The type of a block of results.
fn block_of(shape: Shape) -> TokenStream {
    match shape {
        Shape::Scalar => quote!(Lanes),
        Shape::Vector => quote!([Lanes; DOF]),
        Shape::Frame => quote!([[Lanes; 4]; 4]),
        Shape::Frames => quote!([[[Lanes; 4]; 4]; DOF]),
        Shape::Jacobian => quote!([[Lanes; DOF]; 6]),
        Shape::Square => quote!([[Lanes; DOF]; DOF]),
        Shape::Regressor => quote!([[Lanes; PARAMETERS]; DOF]),
        Shape::BaseRegressor => quote!([[Lanes; BASE_PARAMETERS]; DOF]),
        Shape::Task => quote!([[Lanes; TASK_ROWS]; TASK_ROWS]),
        Shape::Squares(count) => {
            let types = (0..count).map(|_| quote!([[Lanes; DOF]; DOF]));
            quote!((#(#types),*))
        }
        Shape::EquationsOfMotion => quote!(EquationsOfMotion),
    }
}

/// Where the entries of a result stand in a block, in the order of the entries.
fn places(shape: Shape, dof: usize, count: usize) -> Vec<TokenStream> {
    let matrix = |field: TokenStream, rows: usize, columns: usize| -> Vec<TokenStream> {
        let indices = (0..rows * columns).map(|i| (usize_literal(i / columns), usize_literal(i % columns)));
        indices.map(|(row, column)| quote!(#field [#row][#column])).collect()
    };
    let vector = |field: TokenStream| (0..dof).map(usize_literal).map(move |i| quote!(#field [#i])).collect::<Vec<_>>();
    match shape {
        Shape::Scalar => vec![quote!()],
        Shape::Vector => vector(quote!()),
        Shape::Frame => matrix(quote!(), 4, 4),
        Shape::Frames => (0..dof).map(usize_literal).flat_map(|link| matrix(quote!([#link]), 4, 4)).collect(),
        Shape::Jacobian => matrix(quote!(), 6, dof),
        Shape::Square => matrix(quote!(), dof, dof),
        Shape::Regressor | Shape::BaseRegressor => matrix(quote!(), dof, count / dof),
        Shape::Task => matrix(quote!(), count.isqrt(), count.isqrt()),
        Shape::Squares(squares) => {
            let field = |i: u8| usize_literal(usize::from(i));
            (0..squares).map(field).flat_map(|field| matrix(quote!(.#field), dof, dof)).collect()
        }
        Shape::EquationsOfMotion => {
            [matrix(quote!(.inertia), dof, dof), matrix(quote!(.coriolis), dof, dof), vector(quote!(.gravity))].concat()
        }
    }
}

fn of_slices(module: &Module, function: &Function) -> TokenStream {
    let name = format_ident!("{}", function.name());
    let documentation = documentation(module, function);
    let names: Vec<Ident> = function.arguments.iter().map(|&a| argument(a).0).collect();
    let arguments = function.arguments.iter().map(|&a| {
        let (name, length) = argument(a);
        quote!(#name: &[[Real; #length]])
    });
    let shape = function.quantity.shape();
    let of_one = rust::type_of(shape);
    let (zero, scatter) = match shape {
        Shape::Scalar => (quote!([0.0; LANES]), quote!(scatter(k, &[block], core::slice::from_mut(result));)),
        Shape::Vector => (quote!([[0.0; LANES]; DOF]), quote!(scatter(k, &block, result);)),
        Shape::Frame => (quote!([[[0.0; LANES]; 4]; 4]), flat()),
        Shape::Frames => (
            quote!([[[[0.0; LANES]; 4]; 4]; DOF]),
            quote!(scatter(k, block.as_flattened().as_flattened(), result.as_flattened_mut().as_flattened_mut());),
        ),
        Shape::Jacobian => (quote!([[[0.0; LANES]; DOF]; 6]), flat()),
        Shape::Square => (quote!([[[0.0; LANES]; DOF]; DOF]), flat()),
        Shape::Regressor => (quote!([[[0.0; LANES]; PARAMETERS]; DOF]), flat()),
        Shape::BaseRegressor => (quote!([[[0.0; LANES]; BASE_PARAMETERS]; DOF]), flat()),
        Shape::Task => (quote!([[[0.0; LANES]; TASK_ROWS]; TASK_ROWS]), flat()),
        Shape::Squares(count) => {
            let zeros = (0..count).map(|_| quote!([[[0.0; LANES]; DOF]; DOF]));
            let fields = (0..count).map(|i| usize_literal(usize::from(i)));
            let scattered =
                fields.map(|field| quote!(scatter(k, block.#field.as_flattened(), result.#field.as_flattened_mut());));
            (quote!((#(#zeros),*)), quote!(#(#scattered)*))
        }
        Shape::EquationsOfMotion => (
            quote!(lanes::EquationsOfMotion {
                inertia: [[[0.0; LANES]; DOF]; DOF],
                coriolis: [[[0.0; LANES]; DOF]; DOF],
                gravity: [[0.0; LANES]; DOF],
            }),
            quote! {
                scatter(k, block.inertia.as_flattened(), result.inertia.as_flattened_mut());
                scatter(k, block.coriolis.as_flattened(), result.coriolis.as_flattened_mut());
                scatter(k, &block.gravity, &mut result.gravity);
            },
        ),
    };
    let lengths = names.iter().skip(1).map(|n| quote!(.min(#n.len())));
    let first = &names[0];
    let chunks = names.iter().skip(1).map(|n| quote!(.zip(#n.chunks(LANES))));
    let pattern = names.iter().skip(1).fold(quote!(#first), |pattern, n| quote!((#pattern, #n)));
    quote! {
        #(#[doc = #documentation])*
        #[allow(clippy::all)]
        pub fn #name(#(#arguments,)* results: &mut [#of_one]) {
            let mut block = #zero;
            for (#pattern, results) in #first.chunks(LANES) #(#chunks)* .zip(results.chunks_mut(LANES)) {
                lanes::#name(#(&gather(#names),)* &mut block);
                for (result, k) in results.iter_mut().zip(0 .. #first.len() #(#lengths)*) {
                    #scatter
                }
            }
        }
    }
}

fn flat() -> TokenStream {
    quote!(scatter(k, block.as_flattened(), result.as_flattened_mut());)
}
