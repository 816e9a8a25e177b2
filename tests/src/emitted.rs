//! The emitted modules, compiled into this crate as a user compiles one into theirs, and each as [`Functions`].

use armgen_runtime::nalgebra::{SMatrix, SVector, Scalar};
#[allow(clippy::wildcard_imports)] // all traits that a robot may have
use armgen_runtime::robot::*;

use crate::answers::{array as numbers, Flat, Float};
use crate::functions::{Arguments, Functions};
use crate::signatures;

/// An emitted module.
#[derive(Clone, Copy)]
pub struct Emitted {
    /// Name of the module here.
    pub module: &'static str,
    /// Path of the description, from `tests/`.
    pub path: &'static str,
    /// The emitted text.
    pub text: &'static str,
    /// The emitted implementation of the traits.
    pub runtime_text: &'static str,
    /// Name of the robot.
    pub name: &'static str,
    /// Whether `Real` is f32.
    pub narrow: bool,
    dof: usize,
    parameter_names: &'static [&'static str],
    free: fn(&str, &Arguments) -> Vec<f64>,
    traits: fn(&str, &Arguments) -> Vec<f64>,
}

impl Emitted {
    /// The description's text.
    pub fn description(&self) -> String {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(self.path);
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// The same robot through the traits of the runtime.
    pub fn through_traits(&self) -> ThroughTraits {
        ThroughTraits(*self)
    }
}

impl Functions for Emitted {
    fn dof(&self) -> usize {
        self.dof
    }

    fn parameter_names(&self) -> Vec<String> {
        self.parameter_names.iter().map(ToString::to_string).collect()
    }

    fn nominal(&self) -> Vec<f64> {
        self.call("nominal", &Arguments::default())
    }

    fn nominal_base(&self) -> Vec<f64> {
        self.call("nominal_base", &Arguments::default())
    }

    fn has(&self, function: &str) -> bool {
        self.text.contains(&format!("pub fn {function}("))
    }

    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64> {
        (self.free)(function, arguments)
    }
}

/// The robots `Nominal` and `WithParameters` of an emitted module.
#[derive(Clone, Copy)]
pub struct ThroughTraits(Emitted);

impl Functions for ThroughTraits {
    fn dof(&self) -> usize {
        self.0.dof
    }

    fn parameter_names(&self) -> Vec<String> {
        self.0.parameter_names()
    }

    fn nominal(&self) -> Vec<f64> {
        (self.0.traits)("parameters", &Arguments::default())
    }

    fn nominal_base(&self) -> Vec<f64> {
        self.0.nominal_base()
    }

    fn has(&self, function: &str) -> bool {
        let (method, robot) = function.strip_suffix("_with").map_or((function, "Nominal"), |method| (method, "WithParameters"));
        signatures::of_robot(self.0.runtime_text, robot).iter().any(|(name, _)| name == method)
    }

    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64> {
        (self.0.traits)(function, arguments)
    }
}

/// The module called `name` here.
///
/// Panics where no robot has this name.
pub fn emitted(name: &str) -> &'static Emitted {
    ALL.iter().find(|robot| robot.module == name).unwrap_or_else(|| panic!("no emitted module `{name}`"))
}

impl<T: Flat + Scalar + Copy, const R: usize, const C: usize> Flat for SMatrix<T, R, C> {
    fn flat(self) -> Vec<f64> {
        (0..R).flat_map(|i| (0..C).flat_map(move |j| self[(i, j)].flat())).collect()
    }
}

impl<T: Flat + Scalar + Copy, const N: usize> Flat for EquationsOfMotion<T, N> {
    fn flat(self) -> Vec<f64> {
        [self.inertia.flat(), self.coriolis.flat(), self.gravity.flat()].concat()
    }
}

/// The vector that a method of the traits takes.
fn vector<T: Float + Scalar, const N: usize>(values: &[f64]) -> SVector<T, N> {
    SVector::from(numbers::<T, N>(values))
}

/// The value of a method of the traits, by its name: `ask!(robot, function, arguments; method(argument, ..), ..)`.
macro_rules! ask {
    ($robot:expr, $name:ident, $a:ident; $($method:ident($($argument:ident),*)),*) => {{
        let robot = $robot;
        match $name {
            $(stringify!($method) => robot.$method($(&vector(&$a.$argument)),*).flat(),)*
            _ => panic!("the traits have no `{}`", $name),
        }
    }};
}

/// The table entry of an emitted module: its name and the path of its description; its functions, and the methods that the traits of the
/// runtime have for `Nominal` and for `WithParameters`.
macro_rules! emitted {
    ($module:ident, $path:literal; [$($functions:tt)*] [$($nominal:tt)*] [$($with:tt)*]) => {{
        fn traits(function: &str, a: &Arguments) -> Vec<f64> {
            match function.strip_suffix("_with") {
                None => ask!($module::Nominal, function, a; $($nominal)*),
                Some(function) => ask!($module::WithParameters { parameters: numbers(&a.pi) }, function, a; $($with)*),
            }
        }
        Emitted {
            module: stringify!($module),
            path: $path,
            text: include_str!(concat!(env!("OUT_DIR"), "/", stringify!($module), ".rs")),
            runtime_text: include_str!(concat!(env!("OUT_DIR"), "/", stringify!($module), "_runtime.rs")),
            name: $module::NAME,
            narrow: size_of::<$module::Real>() == 4,
            dof: $module::DOF,
            parameter_names: &$module::PARAMETER_NAMES,
            free: answers!($module; $($functions)*),
            traits,
        }
    }};
}

include!(concat!(env!("OUT_DIR"), "/emitted.rs"));
