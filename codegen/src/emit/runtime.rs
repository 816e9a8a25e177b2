//! The implementation of the runtime's traits for an emitted module: text that names `armgen_runtime` and `nalgebra`, and nothing of either here.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::rust::argument;
use crate::equations::{Argument, Quantity, Shape};
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

/// Methods of the trait `Kinematics`.
const KINEMATICS: [Quantity; 4] =
    [Quantity::DirectKinematics, Quantity::LinkFrames, Quantity::GeometricJacobian, Quantity::GeometricJacobianDot];
/// Methods of the trait `Dynamics`.
const DYNAMICS: [Quantity; 9] = [
    Quantity::InertiaMatrix,
    Quantity::CoriolisMatrix,
    Quantity::Gravity,
    Quantity::Friction,
    Quantity::EquationsOfMotion,
    Quantity::InverseDynamics,
    Quantity::ForwardDynamics,
    Quantity::KineticEnergy,
    Quantity::PotentialEnergy,
];
/// Methods of the trait `Regressor`.
const REGRESSOR: [Quantity; 2] = [Quantity::Regressor, Quantity::KnownTorque];

/// Functions that the implementation calls and the module does not have.
pub(super) fn missing(module: &Module) -> Vec<String> {
    let all = KINEMATICS.into_iter().chain(DYNAMICS).chain(REGRESSOR);
    let needed = all.flat_map(|quantity| {
        let with = quantity.has_parameters().then_some((quantity, true));
        std::iter::once((quantity, false)).chain(with)
    });
    let has = |(quantity, with)| module.functions.iter().any(|f| (f.quantity, f.with_parameters) == (quantity, with));
    let name = |(quantity, with): (Quantity, bool)| format!("{}{}", quantity.name(), if with { "_with" } else { "" });
    needed.filter(|&function| !has(function)).map(name).collect()
}

fn traits(robot: &TokenStream, with_parameters: bool) -> TokenStream {
    let of = |quantities: &[Quantity]| quantities.iter().map(|&q| method(q, with_parameters)).collect::<Vec<_>>();
    let (kinematics, dynamics, regressor) = (of(&KINEMATICS), of(&DYNAMICS), of(&REGRESSOR));
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

fn method(quantity: Quantity, with_parameters: bool) -> TokenStream {
    let name = format_ident!("{}", quantity.name());
    let run_time = with_parameters && quantity.has_parameters();
    let called = if run_time { format_ident!("{}_with", quantity.name()) } else { name.clone() };
    let arguments = quantity.arguments().iter().map(|&a| {
        let (name, _) = argument(a);
        quote!(#name: &armgen_runtime::nalgebra::SVector<Real, DOF>)
    });
    let mut passed: Vec<TokenStream> = quantity
        .arguments()
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
    let (returns, value) = match quantity.shape() {
        Shape::Scalar => (quote!(Real), call),
        Shape::Vector => {
            (quote!(armgen_runtime::nalgebra::SVector<Real, DOF>), quote!(armgen_runtime::nalgebra::SVector::from(#call)))
        }
        Shape::Frame => (quote!(armgen_runtime::nalgebra::Matrix4<Real>), quote!(armgen_runtime::robot::matrix(&#call))),
        Shape::Frames => (
            quote!([armgen_runtime::nalgebra::Matrix4<Real>; DOF]),
            quote!(#call.map(|frame| armgen_runtime::robot::matrix(&frame))),
        ),
        Shape::Jacobian => {
            (quote!(armgen_runtime::nalgebra::SMatrix<Real, 6, DOF>), quote!(armgen_runtime::robot::matrix(&#call)))
        }
        Shape::Square => {
            (quote!(armgen_runtime::nalgebra::SMatrix<Real, DOF, DOF>), quote!(armgen_runtime::robot::matrix(&#call)))
        }
        Shape::Regressor => {
            (quote!(armgen_runtime::nalgebra::SMatrix<Real, DOF, PARAMETERS>), quote!(armgen_runtime::robot::matrix(&#call)))
        }
        Shape::BaseRegressor | Shape::Task | Shape::Squares(_) => unreachable!("the traits have no method of this shape"),
        Shape::EquationsOfMotion => (
            quote!(armgen_runtime::robot::EquationsOfMotion<Real, DOF>),
            quote! {{
                let terms = #call;
                armgen_runtime::robot::EquationsOfMotion {
                    inertia: armgen_runtime::robot::matrix(&terms.inertia),
                    coriolis: armgen_runtime::robot::matrix(&terms.coriolis),
                    gravity: armgen_runtime::nalgebra::SVector::from(terms.gravity),
                }
            }},
        ),
    };
    quote! {
        fn #name(&self, #(#arguments),*) -> #returns {
            #value
        }
    }
}
