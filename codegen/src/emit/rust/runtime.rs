//! The implementation of the runtime's traits for an emitted module: text that names `armgen_runtime` and `nalgebra`, and nothing of either here.

use proc_macro2::TokenStream;
use quote::{format_ident, quote, ToTokens};

use super::documentation;
use super::signature::{accesses, argument, length, of_parts, usize_literal, with_fields};
use crate::catalogue::{self, Argument, Length, Quantity, ResultPart};
use crate::emit::documentation as common;
use crate::program::Module;

/// Two robots that call the functions of the module, in scope by `use super::*` or in the same module. `Nominal` is the robot of
/// the description, `WithParameters` the same robot with parameters chosen at run time.
///
/// None of a module without kinematics, which all other traits build on; of one without dynamics there is the kinematics of `Nominal` alone.
pub(super) fn implementation(module: &Module) -> Option<TokenStream> {
    if !is_implemented(module, "Kinematics") {
        return None;
    }
    let doc = format!(" The robot `{}` as described.", module.name);
    let nominal = traits(module, &quote!(Nominal), false);
    let (chosen, with_parameters) = if is_implemented(module, "Dynamics") {
        (with_parameters_type(), traits(module, &quote!(WithParameters), true))
    } else {
        (quote!(), quote!())
    };
    Some(quote! {
        #[doc = #doc]
        #[allow(dead_code)]
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Nominal;

        #chosen
        #nominal
        #with_parameters
    })
}

fn with_parameters_type() -> TokenStream {
    quote! {
        /// The same robot with other parameters, in the order of `PARAMETER_NAMES`.
        #[allow(dead_code)]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct WithParameters {
            /// The parameter vector.
            pub parameters: [Real; PARAMETERS],
        }

        impl Default for WithParameters {
            /// The parameters of the description.
            fn default() -> Self {
                WithParameters { parameters: NOMINAL_PARAMETERS }
            }
        }
    }
}

/// The traits of what controllers and the plant need, each building on those before it; every other is of one function.
const BASIC: [&str; 3] = ["Kinematics", "Dynamics", "Regressor"];

/// The methods of a trait.
fn methods(interface: &str) -> impl Iterator<Item = &'static Quantity> + use<'_> {
    catalogue::quantities().filter(move |quantity| quantity.interface == Some(interface))
}

/// The quantities that have a trait of their own, each with the trait's name.
fn single() -> impl Iterator<Item = (&'static Quantity, &'static str)> {
    catalogue::quantities().filter_map(|quantity| Some((quantity, quantity.interface.filter(|name| !BASIC.contains(name))?)))
}

fn has(module: &Module, quantity: &Quantity, with_parameters: bool) -> bool {
    module.functions.iter().any(|f| (f.quantity, f.with_parameters) == (quantity, with_parameters))
}

/// Basic traits that have functions which the module does not have, and these.
pub(super) fn lacking(module: &Module) -> Vec<(&'static str, Vec<String>)> {
    let absent = |interface: &str| -> Vec<String> {
        let of_interface = catalogue::functions().filter(|(quantity, _)| quantity.interface == Some(interface));
        let needed = of_interface.filter(|(quantity, _)| quantity.documentation.said_missing);
        let absent = needed.filter(|(quantity, with)| !has(module, quantity, *with));
        absent.map(|(quantity, with)| quantity.function_name(with)).collect()
    };
    BASIC.into_iter().map(|interface| (interface, absent(interface))).filter(|(_, absent)| !absent.is_empty()).collect()
}

/// Whether a basic trait and those that it builds on are implemented.
pub(super) fn is_implemented(module: &Module, interface: &str) -> bool {
    let lacking = lacking(module);
    let needed = BASIC.into_iter().take_while(|name| *name != interface).chain([interface]);
    needed.into_iter().all(|name| lacking.iter().all(|(other, _)| *other != name))
}

fn traits(module: &Module, robot: &TokenStream, with_parameters: bool) -> TokenStream {
    let parameters = if with_parameters { quote!(self.parameters) } else { quote!(NOMINAL_PARAMETERS) };
    let basic = BASIC.into_iter().filter(|interface| is_implemented(module, interface)).map(|interface| {
        // The others have a default in their trait.
        let there = |quantity: &&Quantity| quantity.documentation.said_missing || has(module, quantity, with_parameters);
        let methods = methods(interface).filter(there).map(|quantity| method(quantity, with_parameters));
        let (lengths, first, last) = match interface {
            "Kinematics" => (
                quote!(DOF),
                quote!(
                    type Real = Real;
                ),
                quote!(),
            ),
            "Dynamics" => (quote!(DOF), quote!(), quote!()),
            _ => {
                let parameters = quote! {
                    fn parameters(&self) -> armgen_runtime::nalgebra::SVector<Real, PARAMETERS> {
                        armgen_runtime::nalgebra::SVector::from(#parameters)
                    }
                };
                (quote!(DOF, PARAMETERS), quote!(), parameters)
            }
        };
        let interface = format_ident!("{interface}");
        quote! {
            impl armgen_runtime::robot::#interface<#lengths> for #robot {
                #first
                #(#methods)*
                #last
            }
        }
    });
    // With other parameters, a function that does not take them would describe another robot. A regressor is independent of them.
    let answers =
        |quantity: &Quantity| !with_parameters || quantity.has_parameters || quantity.has_length(Length::BaseParameters);
    let single = single().filter(|(quantity, _)| answers(quantity));
    let single = single.filter(|(quantity, _)| has(module, quantity, with_parameters && quantity.has_parameters));
    let single = single.map(|(quantity, interface)| {
        let (interface, method) = (format_ident!("{interface}"), method(quantity, with_parameters));
        let lengths = constants(quantity).into_iter().map(length);
        quote! {
            impl armgen_runtime::robot::#interface<#(#lengths),*> for #robot {
                #method
            }
        }
    });
    quote! {
        #(#basic)*

        #(#single)*
    }
}

/// The constants that a trait of one function is generic over: the number of joints, and what else its result has as dimensions.
fn constants(quantity: &Quantity) -> Vec<Length> {
    let mut all = vec![Length::Dof];
    for &length in quantity.result.iter().flat_map(|part| part.lengths) {
        if !matches!(length, Length::Fixed(_)) && !all.contains(&length) {
            all.push(length);
        }
    }
    all
}

/// The constant that a trait is generic over.
fn generic(length: Length) -> TokenStream {
    match length {
        Length::Dof => quote!(N),
        Length::Parameters => quote!(P),
        Length::BaseParameters => quote!(B),
        Length::Task => quote!(M),
        Length::Fixed(value) => usize_literal(value).into_token_stream(),
    }
}

/// The text of the runtime's traits of one function each, `runtime/src/robot/single.rs`.
pub fn single_traits() -> String {
    let traits = single().map(|(quantity, interface)| {
        let (interface, name) = (format_ident!("{interface}"), format_ident!("{}", quantity.name));
        let title = format!(" The function `{}` of a robot.", quantity.name);
        let documentation = documentation::lines(&common::of_quantity(quantity));
        let lengths = constants(quantity).into_iter().map(generic);
        let arguments = quantity.arguments.iter().map(|&a| {
            let (name, _) = argument(a);
            quote!(#name: &SVector<Self::Real, N>)
        });
        let returns = of_parts(quantity, |part| part_type(part, &quote!(Self::Real), &quote!(), generic), |name| quote!(#name));
        quote! {
            #[doc = #title]
            pub trait #interface<#(const #lengths: usize),*>: Kinematics<N> {
                #(#[doc = #documentation])*
                fn #name(&self, #(#arguments),*) -> #returns;
            }
        }
    });
    let traits = quote! {
        use super::Kinematics;
        use nalgebra::{SMatrix, SVector};
        #(#traits)*
    };
    "//! Traits of one function each, for what not every controller needs or not every robot has. Written from the catalogue of emitted functions; a test says when that differs.\n\n"
        .to_string()
        + &super::format(traits)
}

fn method(quantity: &Quantity, with_parameters: bool) -> TokenStream {
    let name = format_ident!("{}", quantity.name);
    let run_time = with_parameters && quantity.has_parameters;
    let called = format_ident!("{}", quantity.function_name(run_time));
    let arguments = quantity.arguments.iter().map(|&a| {
        let (name, _) = argument(a);
        quote!(#name: &armgen_runtime::nalgebra::SVector<Real, DOF>)
    });
    let mut passed: Vec<TokenStream> = quantity
        .arguments
        .iter()
        .map(|&a| {
            let (name, _) = argument(a);
            debug_assert!(a != Argument::Pi);
            quote!(armgen_runtime::robot::array(#name))
        })
        .collect();
    if run_time {
        passed.insert(0, quote!(&self.parameters));
    }
    let call = quote!(#called(#(#passed),*));
    let own = |part: &ResultPart| part_type(part, &quote!(Real), &quote!(armgen_runtime::nalgebra::), length);
    let returns = of_parts(quantity, own, |name| quote!(armgen_runtime::robot::#name<Real, DOF>));
    let value = match quantity.result {
        [part] => converted(part, &call),
        parts => {
            let mut terms = parts.iter().zip(accesses(quantity)).map(|(part, access)| converted(part, &quote!(terms #access)));
            let mut part = |_: &ResultPart| terms.next().expect("a term for each part");
            let all = match quantity.structure {
                Some(named) => {
                    let value = with_fields(&format_ident!("{}", named.name), quantity, part);
                    quote!(armgen_runtime::robot::#value)
                }
                None => of_parts(quantity, &mut part, |_| quote!()),
            };
            quote! {{
                let terms = #call;
                #all
            }}
        }
    };
    quote! {
        fn #name(&self, #(#arguments),*) -> #returns {
            #value
        }
    }
}

/// The type of a part of a result in the runtime.
fn part_type(part: &ResultPart, real: &TokenStream, nalgebra: &TokenStream, length: fn(Length) -> TokenStream) -> TokenStream {
    let of_matrix = |rows: Length, columns: Length| match (rows, columns) {
        (Length::Fixed(4), Length::Fixed(4)) => quote!(#nalgebra Matrix4<#real>),
        (rows, columns) => {
            let (rows, columns) = (length(rows), length(columns));
            quote!(#nalgebra SMatrix<#real, #rows, #columns>)
        }
    };
    match *part.lengths {
        [] => real.clone(),
        [entries] => {
            let entries = length(entries);
            quote!(#nalgebra SVector<#real, #entries>)
        }
        [rows, columns] => of_matrix(rows, columns),
        [count, rows, columns, ..] => {
            let (matrix, count) = (of_matrix(rows, columns), length(count));
            quote!([#matrix; #count])
        }
    }
}

/// A part of a result of the module as the runtime's type.
fn converted(part: &ResultPart, value: &TokenStream) -> TokenStream {
    match part.lengths.len() {
        0 => value.clone(),
        1 => quote!(armgen_runtime::nalgebra::SVector::from(#value)),
        2 => quote!(armgen_runtime::robot::matrix(&#value)),
        _ => quote!(#value.map(|frame| armgen_runtime::robot::matrix(&frame))),
    }
}
