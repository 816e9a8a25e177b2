//! Writes a call of every function of an emitted module.
//!
//! The list comes from the module's text, so a newly emitted function is called, measured and compared with a budget automatically.

mod functions;
mod many_states;

pub use functions::{named_functions, public_functions};
pub use many_states::calls_of_many_states;
use quote::{quote, ToTokens};
use syn::{FnArg, Item, ItemFn, Pat, Type, TypeArray, TypeReference, Visibility};

/// Rust text to be included next to the emitted module `module`: the arguments, and `each_function`, which visits a call of every
/// public function by its name.
///
/// A function is called through a pointer, and its arguments and its result are opaque to the optimiser. So the whole function of
/// the module runs: neither specialised for its caller nor evaluated at compile time.
pub fn calls(module: &str) -> String {
    let file = syn::parse_file(module).expect("an emitted module is a Rust file");
    let (helpers, functions): (Vec<_>, Vec<_>) = public(&file.items).partition(|function| is_helper(function));
    let (visits, helpers) = (functions.into_iter().map(visit), helpers.into_iter().map(help));
    let tokens = quote! {
        /// Arguments for every function of the module.
        #[derive(Clone, Copy, Debug)]
        pub struct Arguments {
            /// Joint variables.
            pub q: [Real; DOF],
            /// Joint rates.
            pub dq: [Real; DOF],
            /// Joint accelerations.
            pub ddq: [Real; DOF],
            /// Reference rates.
            pub dqr: [Real; DOF],
            /// Reference accelerations.
            pub ddqr: [Real; DOF],
            /// Joint torques.
            pub tau: [Real; DOF],
            /// Parameters.
            pub pi: [Real; PARAMETERS],
        }

        /// Hands a call of each function to `visit`, with the name of the function.
        pub fn each_function(arguments: &Arguments, visit: &mut dyn FnMut(&'static str, &mut dyn FnMut())) {
            #(#visits)*
        }

        /// Calls the functions of names and bodies, which compute nothing of the arm.
        pub fn each_helper(name: &str, number: Real) {
            let (name, number) = (core::hint::black_box(name), core::hint::black_box(number));
            let _ = (name, number);
            #(#helpers)*
        }
    };
    prettyplease::unparse(&syn::parse2(tokens).expect("calls are a Rust file"))
}

/// Whether a function takes a name or the numbers of a body, not states of the arm.
fn is_helper(function: &ItemFn) -> bool {
    function.sig.ident == "parameter_index" || function.sig.ident == "payload_parameters"
}

/// The call of such a function, with one name and one number.
fn help(function: &ItemFn) -> impl ToTokens {
    let name = &function.sig.ident;
    let values = function.sig.inputs.iter().map(|input| match input {
        FnArg::Typed(input) => match &*input.ty {
            Type::Reference(of) if matches!(&*of.elem, Type::Path(_)) => quote!(name),
            Type::Reference(of) => {
                let filled = filled(&of.elem, "number");
                quote!(&#filled)
            }
            of => filled(of, "number").to_token_stream(),
        },
        FnArg::Receiver(_) => unreachable!("emitted functions are free"),
    });
    quote!(core::hint::black_box(#name(#(#values),*));)
}

/// The public functions among these items.
fn public(items: &[Item]) -> impl Iterator<Item = &ItemFn> {
    items.iter().filter_map(|item| match item {
        Item::Fn(function) if matches!(function.vis, Visibility::Public(_)) => Some(function),
        _ => None,
    })
}

/// Rust text to be included next to `runtime`, the emitted implementation of the traits, and the text of [`calls`]:
/// `each_method`, which calls every method of every trait for both robots.
pub fn method_calls(runtime: &str) -> String {
    let file = syn::parse_file(runtime).expect("an emitted implementation is a Rust file");
    let calls = file.items.iter().filter_map(|item| match item {
        Item::Impl(implementation) => implementation_calls(implementation),
        _ => None,
    });
    let tokens = quote! {
        /// Calls each method of the traits of the runtime.
        pub fn each_method(arguments: &Arguments) {
            use armgen_runtime::nalgebra::SVector;
            let nominal = Nominal;
            let with_parameters = WithParameters { parameters: core::hint::black_box(arguments.pi) };
            #(#calls)*
        }
    };
    prettyplease::unparse(&syn::parse2(tokens).expect("calls are a Rust file"))
}

/// The calls of the methods of a trait of the runtime; none of another trait.
fn implementation_calls(implementation: &syn::ItemImpl) -> Option<impl quote::ToTokens> {
    let (path, _) = implementation.trait_.as_ref()?;
    let name = &path.segments.last()?.ident;
    // Inverse kinematics takes a pose: it is called by hand.
    if path.segments.first()?.ident != "armgen_runtime" || name == "InverseKinematics" || name == "RedundantInverseKinematics" {
        return None;
    }
    let own = &implementation.self_ty;
    let robot = if quote!(#own).to_string() == "Nominal" { quote!(nominal) } else { quote!(with_parameters) };
    let calls = implementation.items.iter().filter_map(|item| match item {
        syn::ImplItem::Fn(method) => {
            let method_name = &method.sig.ident;
            let values = method.sig.inputs.iter().filter_map(|input| match input {
                FnArg::Typed(input) => {
                    let argument = &input.pat;
                    Some(quote!(core::hint::black_box(&SVector::from(arguments.#argument))))
                }
                FnArg::Receiver(_) => None,
            });
            Some(quote!(core::hint::black_box(armgen_runtime::robot::#name::#method_name(&#robot, #(#values),*));))
        }
        _ => None,
    });
    Some(quote!(#(#calls)*))
}

fn visit(function: &ItemFn) -> impl quote::ToTokens {
    let (name, output) = (&function.sig.ident, &function.sig.output);
    let text = name.to_string();
    let (mut types, mut values, mut memory) = (Vec::new(), Vec::new(), None);
    for input in &function.sig.inputs {
        let FnArg::Typed(input) = input else { unreachable!("emitted functions are free") };
        let Pat::Ident(argument) = &*input.pat else { unreachable!("arguments of emitted functions are names") };
        types.push(&input.ty);
        match &*input.ty {
            // Memory of the caller that the function writes to.
            Type::Reference(TypeReference { mutability: Some(_), elem, .. }) => {
                let zeros = filled(elem, "0.0");
                memory = Some(quote!(let mut #argument: #elem = #zeros;));
                values.push(quote!(core::hint::black_box(&mut #argument)));
            }
            _ => values.push(quote!(core::hint::black_box(&arguments.#argument))),
        }
    }
    quote! {
        visit(#text, &mut || {
            #memory
            let function: fn(#(#types),*) #output = #name;
            let _ = core::hint::black_box(core::hint::black_box(function)(#(#values),*));
        });
    }
}

/// A value of a type: a number, or arrays of it.
fn filled(of: &Type, number: &str) -> syn::Expr {
    fn text(of: &Type, number: &str) -> String {
        match of {
            Type::Array(TypeArray { elem, len, .. }) => format!("[{}; {}]", text(elem, number), len.to_token_stream()),
            _ => number.into(),
        }
    }
    syn::parse_str(&text(of, number)).expect("an array of numbers is an expression")
}
