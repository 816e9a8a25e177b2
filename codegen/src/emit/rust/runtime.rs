//! The implementation of the runtime's traits for an emitted module: text that names `armgen_runtime` and `nalgebra`, and nothing of either here.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::signature::{accesses, argument, length, of_parts, with_fields};
use crate::catalogue::{self, Argument, Length, Part, Quantity};
use crate::program::Module;

/// Two robots over the functions of the module, in scope by `use super::*` or by standing beside it: `Nominal`, the robot of the description,
/// and `WithParameters`, the same robot with parameters chosen at run time.
pub(super) fn implementation(module: &Module) -> TokenStream {
    let doc = format!(" The robot `{}` as described.", module.name);
    let nominal = traits(&quote!(Nominal), false);
    let with_parameters = traits(&quote!(WithParameters), true);
    quote! {
        #[doc = #doc]
        #[allow(dead_code)]
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Nominal;

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

        #nominal
        #with_parameters
    }
}

/// The methods of a trait.
fn methods(interface: &str) -> impl Iterator<Item = &'static Quantity> + use<'_> {
    catalogue::quantities().filter(move |quantity| quantity.interface == Some(interface))
}

/// Functions that the implementation calls and the module does not have.
pub(super) fn missing(module: &Module) -> Vec<String> {
    let needed = catalogue::functions().filter(|(quantity, _)| quantity.interface.is_some());
    let has = |(quantity, with)| module.functions.iter().any(|f| (f.quantity, f.with_parameters) == (quantity, with));
    needed.filter(|&function| !has(function)).map(|(quantity, with)| quantity.function_name(with)).collect()
}

fn traits(robot: &TokenStream, with_parameters: bool) -> TokenStream {
    let of = |interface: &str| methods(interface).map(|q| method(q, with_parameters)).collect::<Vec<_>>();
    let (kinematics, dynamics, regressor) = (of("Kinematics"), of("Dynamics"), of("Regressor"));
    let parameters = if with_parameters { quote!(self.parameters) } else { quote!(NOMINAL_PARAMETERS) };
    quote! {
        impl armgen_runtime::robot::Kinematics<DOF> for #robot {
            type Real = Real;
            #(#kinematics)*
        }

        impl armgen_runtime::robot::Dynamics<DOF> for #robot {
            #(#dynamics)*
        }

        impl armgen_runtime::robot::Regressor<DOF, PARAMETERS> for #robot {
            #(#regressor)*
            fn parameters(&self) -> armgen_runtime::nalgebra::SVector<Real, PARAMETERS> {
                armgen_runtime::nalgebra::SVector::from(#parameters)
            }
        }
    }
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
    let returns = of_parts(quantity, part_type, |name| quote!(armgen_runtime::robot::#name<Real, DOF>));
    let value = match quantity.result {
        [part] => converted(part, &call),
        parts => {
            let mut terms = parts.iter().zip(accesses(quantity)).map(|(part, access)| converted(part, &quote!(terms #access)));
            let mut part = |_: &Part| terms.next().expect("a term for each part");
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
fn part_type(part: &Part) -> TokenStream {
    let of_matrix = |rows: Length, columns: Length| match (rows, columns) {
        (Length::Fixed(4), Length::Fixed(4)) => quote!(armgen_runtime::nalgebra::Matrix4<Real>),
        (rows, columns) => {
            let (rows, columns) = (length(rows), length(columns));
            quote!(armgen_runtime::nalgebra::SMatrix<Real, #rows, #columns>)
        }
    };
    match *part.lengths {
        [] => quote!(Real),
        [entries] => {
            let entries = length(entries);
            quote!(armgen_runtime::nalgebra::SVector<Real, #entries>)
        }
        [rows, columns] => of_matrix(rows, columns),
        [count, rows, columns, ..] => {
            let (matrix, count) = (of_matrix(rows, columns), length(count));
            quote!([#matrix; #count])
        }
    }
}

/// A part of a result of the module as the runtime's type.
fn converted(part: &Part, value: &TokenStream) -> TokenStream {
    match part.lengths.len() {
        0 => value.clone(),
        1 => quote!(armgen_runtime::nalgebra::SVector::from(#value)),
        2 => quote!(armgen_runtime::robot::matrix(&#value)),
        _ => quote!(#value.map(|frame| armgen_runtime::robot::matrix(&frame))),
    }
}
