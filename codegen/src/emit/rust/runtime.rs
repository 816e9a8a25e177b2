//! The implementation of the runtime's traits for an emitted module: text that names `armgen_runtime` and `nalgebra`, and nothing of either here.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote, ToTokens};

use super::documentation;
use super::signature::{accesses, argument, length, of_parts, usize_literal, with_fields};
use crate::catalogue::{self, Argument, Length, Of, Quantity, ResultPart};
use crate::emit::documentation as common;
use crate::program::{EndEffector, Module};

/// Two robots that call the functions of the module, in scope by `use super::*` or in the same module. `Nominal` is the robot of
/// the description, `WithParameters` the same robot with parameters chosen at run time.
///
/// None of a module without kinematics, which all other traits build on; of one without dynamics there is the kinematics of `Nominal` alone.
pub(super) fn implementation(module: &Module) -> Option<TokenStream> {
    if !is_implemented(module, "Kinematics") {
        return None;
    }
    let has_dynamics = is_implemented(module, "Dynamics");
    let mounted = (has_dynamics && module.gravity_is_argument).then_some(&MOUNTED);
    let others: Vec<&Robot> = mounted.into_iter().chain(has_dynamics.then_some(&WITH_PARAMETERS)).collect();
    let ends: Vec<Option<&EndEffector>> = match module.tips.as_slice() {
        [] => vec![None],
        tips => tips.iter().map(Some).collect(),
    };
    let all = ends.into_iter().map(|end| {
        let doc = match end {
            None => format!(" The robot `{}` as described.", module.name),
            Some(tip) => format!(" The robot `{}` as described, with the end effector `{}`.", module.name, tip.name),
        };
        let name = NOMINAL.name_with(end);
        let types = others.iter().map(|robot| type_of_robot(module, robot, end));
        let traits = [&NOMINAL].into_iter().chain(others.iter().copied()).map(|robot| traits(module, robot, end));
        quote! {
            #[doc = #doc]
            #[allow(dead_code)]
            #[derive(Clone, Copy, Debug, Default, PartialEq)]
            pub struct #name;

            #(#types)*
            #(#traits)*
        }
    });
    Some(quote!(#(#all)*))
}

impl Robot {
    /// Its name: of an end effector `left` `Left` in place of `Nominal`, and `LeftWithParameters`.
    fn name_with(&self, end: Option<&EndEffector>) -> Ident {
        let capital = |word: &str| {
            let (initial, rest) = word.split_at(word.len().min(1));
            initial.to_uppercase() + rest
        };
        let tip = end.map(|tip| tip.name.split('_').map(capital).collect::<String>());
        let own = if tip.is_some() && self.name == NOMINAL.name { "" } else { self.name };
        format_ident!("{}{own}", tip.unwrap_or_default())
    }
}

/// The quantity of an end effector, or the same one where it is of the robot.
fn of_end(module: &Module, quantity: &'static Quantity, end: Option<&EndEffector>) -> Option<&'static Quantity> {
    let Some(tip) = end.filter(|_| quantity.recursion.of == Of::EndEffector) else { return Some(quantity) };
    let name = format!("{}_{}", tip.name.to_ascii_lowercase(), quantity.name);
    module.functions.iter().map(|function| function.quantity).find(|quantity| quantity.name == name)
}

/// A robot that implements the traits, and the values that it has in fields instead of taking them from the description.
struct Robot {
    name: &'static str,
    title: &'static str,
    default: &'static str,
    parameters: bool,
    gravity: bool,
}

const NOMINAL: Robot = Robot { name: "Nominal", title: "", default: "", parameters: false, gravity: false };

const MOUNTED: Robot = Robot {
    name: "Mounted",
    title: " The same robot under another gravity: mounted another way, or on a base that accelerates.",
    default: " The gravity of the description.",
    parameters: false,
    gravity: true,
};

const WITH_PARAMETERS: Robot = Robot {
    name: "WithParameters",
    title: " The same robot with other parameters, in the order of `PARAMETER_NAMES`.",
    default: " The parameters of the description.",
    parameters: true,
    gravity: true,
};

fn type_of_robot(module: &Module, robot: &Robot, end: Option<&EndEffector>) -> TokenStream {
    let (name, title, default) = (robot.name_with(end), robot.title, robot.default);
    let parameters = robot.parameters.then(|| {
        quote! {
            /// The parameter vector.
            pub parameters: [Real; PARAMETERS],
        }
    });
    let has_gravity = robot.gravity && module.gravity_is_argument;
    let gravity = has_gravity.then(|| {
        quote! {
            /// Acceleration of free fall in the base frame, m/s².
            pub gravity: [Real; 3],
        }
    });
    let parameters_of_default = robot.parameters.then(|| quote!(parameters: NOMINAL_PARAMETERS,));
    let gravity_of_default = has_gravity.then(|| quote!(gravity: NOMINAL_GRAVITY,));
    quote! {
        #[doc = #title]
        #[allow(dead_code)]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct #name {
            #parameters
            #gravity
        }

        impl Default for #name {
            #[doc = #default]
            fn default() -> Self {
                #name { #parameters_of_default #gravity_of_default }
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

/// Whether a module has a function, of each end effector where these have names.
fn has(module: &Module, quantity: &'static Quantity, with_parameters: bool) -> bool {
    let there = |quantity| module.functions.iter().any(|f| (f.quantity, f.with_parameters) == (quantity, with_parameters));
    match module.tips.as_slice() {
        [] => there(quantity),
        tips => tips.iter().all(|tip| of_end(module, quantity, Some(tip)).is_some_and(there)),
    }
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

fn traits(module: &Module, robot: &Robot, end: Option<&EndEffector>) -> TokenStream {
    let (name, with_parameters) = (robot.name_with(end), robot.parameters);
    let parameters = if with_parameters { quote!(self.parameters) } else { quote!(NOMINAL_PARAMETERS) };
    let basic = BASIC.into_iter().filter(|interface| is_implemented(module, interface)).map(|interface| {
        // The others have a default in their trait.
        let there = |quantity: &&'static Quantity| quantity.documentation.said_missing || has(module, quantity, with_parameters);
        let methods = methods(interface).filter(there).map(|quantity| method(module, quantity, robot, end));
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
            impl armgen_runtime::robot::#interface<#lengths> for #name {
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
        let (interface, method) = (format_ident!("{interface}"), method(module, quantity, robot, end));
        let own = of_end(module, quantity, end).unwrap_or(quantity);
        let lengths = constants(own).into_iter().map(length);
        quote! {
            impl armgen_runtime::robot::#interface<#(#lengths),*> for #name {
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
        if !matches!(length, Length::Fixed(_) | Length::Joints | Length::AllJoints) && !all.contains(&length) {
            all.push(length);
        }
    }
    all
}

/// The constant that a trait is generic over.
fn generic(length: Length) -> TokenStream {
    match length {
        Length::Dof | Length::Joints | Length::AllJoints => quote!(N),
        Length::Parameters => quote!(P),
        Length::BaseParameters => quote!(B),
        Length::Task => quote!(M),
        Length::Fixed(value) | Length::Named(_, value) => usize_literal(value).into_token_stream(),
    }
}

/// The text of the runtime's traits of one function each, `runtime/src/robot/single.rs`.
pub fn single_traits() -> String {
    let traits = single().map(|(quantity, interface)| {
        let (interface, name) = (format_ident!("{interface}"), format_ident!("{}", quantity.name));
        let title = format!(" The function `{}` of a robot.", quantity.name);
        let documentation = documentation::lines(&common::of_quantity(quantity));
        let lengths = constants(quantity).into_iter().map(generic);
        let arguments = quantity.arguments_of(false, false).map(|a| {
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

fn method(module: &Module, quantity: &'static Quantity, robot: &Robot, end: Option<&EndEffector>) -> TokenStream {
    let name = format_ident!("{}", quantity.name);
    let quantity = of_end(module, quantity, end).unwrap_or(quantity);
    // With the dimensions that it has in the module.
    let quantity = module.functions.iter().map(|function| function.quantity).find(|own| *own == quantity).unwrap_or(quantity);
    let run_time = robot.parameters && quantity.has_parameters;
    let called = format_ident!("{}", quantity.function_name(run_time));
    let arguments = quantity.arguments_of(false, false).map(|a| {
        let (name, _) = argument(a);
        quote!(#name: &armgen_runtime::nalgebra::SVector<Real, DOF>)
    });
    let passed = quantity.arguments_of(run_time, module.gravity_is_argument).map(|a| match a {
        Argument::Pi => quote!(&self.parameters),
        Argument::Gravity if robot.gravity => quote!(&self.gravity),
        Argument::Gravity => quote!(&NOMINAL_GRAVITY),
        _ => {
            let (name, _) = argument(a);
            quote!(armgen_runtime::robot::array(#name))
        }
    });
    let call = quote!(#called(#(#passed),*));
    let call = match quantity.has_length(Length::AllJoints) {
        false => call,
        true => {
            let places = coordinates(module).into_iter().map(usize_literal);
            quote! {{
                let all = #call;
                [#(all[#places]),*]
            }}
        }
    };
    // Traits have an element for each joint with a coordinate.
    let of_coordinates = |of: Length| length(if of == Length::AllJoints { Length::Dof } else { of });
    let own = |part: &ResultPart| part_type(part, &quote!(Real), &quote!(armgen_runtime::nalgebra::), of_coordinates);
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

/// The places of the joints with a coordinate among all joints.
fn coordinates(module: &Module) -> Vec<usize> {
    let names = module.coupling.iter().flat_map(|coupling| &coupling.names).enumerate();
    let has_coordinate = |name: &String| module.joints.iter().any(|joint| joint.name == *name);
    names.filter(|(_, name)| has_coordinate(name)).map(|(place, _)| place).collect()
}

/// The type of a part of a result in the runtime.
fn part_type(
    part: &ResultPart,
    real: &TokenStream,
    nalgebra: &TokenStream,
    length: impl Fn(Length) -> TokenStream,
) -> TokenStream {
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
