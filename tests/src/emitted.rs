//! The emitted modules, compiled into this crate as a user compiles one into theirs, and each as [`Functions`].

use armgen_runtime::nalgebra::{RealField, SMatrix, SVector};
use armgen_runtime::robot::{Kinematics, Regressor};

use crate::answers::{array, Flat, Float};
use crate::functions::{Arguments, Functions};

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

    fn has(&self, function: &str) -> bool {
        self.0.runtime_text.contains(&format!("fn {}(", function.trim_end_matches("_with")))
    }

    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64> {
        (self.0.traits)(function, arguments)
    }
}

/// The module called `name` here.
///
/// Panics where there is none.
pub fn emitted(name: &str) -> &'static Emitted {
    ALL.iter().find(|robot| robot.module == name).unwrap_or_else(|| panic!("no emitted module `{name}`"))
}

fn flat_matrix<T: RealField + Into<f64> + Copy, const R: usize, const C: usize>(m: &SMatrix<T, R, C>) -> Vec<f64> {
    (0..R).flat_map(|i| (0..C).map(move |j| m[(i, j)].into())).collect()
}

/// Calls a method of the traits.
fn through<T, R, const N: usize, const P: usize>(robot: &R, function: &str, a: &Arguments) -> Vec<f64>
where
    T: RealField + Float + Into<f64>,
    R: Regressor<N, P> + Kinematics<N, Real = T>,
{
    let vector = |values: &[f64]| -> SVector<T, N> { SVector::from(array::<T, N>(values)) };
    match function {
        "parameters" => flat_matrix(&robot.parameters()),
        "direct_kinematics" => flat_matrix(&robot.direct_kinematics(&vector(&a.q))),
        "link_frames" => robot.link_frames(&vector(&a.q)).iter().flat_map(flat_matrix).collect(),
        "geometric_jacobian" => flat_matrix(&robot.geometric_jacobian(&vector(&a.q))),
        "geometric_jacobian_dot" => flat_matrix(&robot.geometric_jacobian_dot(&vector(&a.q), &vector(&a.dq))),
        "inertia_matrix" => flat_matrix(&robot.inertia_matrix(&vector(&a.q))),
        "coriolis_matrix" => flat_matrix(&robot.coriolis_matrix(&vector(&a.q), &vector(&a.dq))),
        "gravity" => flat_matrix(&robot.gravity(&vector(&a.q))),
        "friction" => flat_matrix(&robot.friction(&vector(&a.dq))),
        "equations_of_motion" => {
            let terms = robot.equations_of_motion(&vector(&a.q), &vector(&a.dq));
            [flat_matrix(&terms.inertia), flat_matrix(&terms.coriolis), flat_matrix(&terms.gravity)].concat()
        }
        "inverse_dynamics" => flat_matrix(&robot.inverse_dynamics(&vector(&a.q), &vector(&a.dq), &vector(&a.ddq))),
        "forward_dynamics" => flat_matrix(&robot.forward_dynamics(&vector(&a.q), &vector(&a.dq), &vector(&a.tau))),
        "regressor" => flat_matrix(&robot.regressor(&vector(&a.q), &vector(&a.dq), &vector(&a.dqr), &vector(&a.ddqr))),
        "known_torque" => flat_matrix(&robot.known_torque(&vector(&a.q), &vector(&a.dq), &vector(&a.dqr), &vector(&a.ddqr))),
        "kinetic_energy" => vec![robot.kinetic_energy(&vector(&a.q), &vector(&a.dq)).into()],
        "potential_energy" => vec![robot.potential_energy(&vector(&a.q)).into()],
        _ => panic!("the traits have no `{function}`"),
    }
}

/// The table entry of an emitted module: `emitted!(module, path, function, ..)` with those functions of q that not every module has.
macro_rules! emitted {
    ($module:ident, $path:literal $(, $optional:ident)*) => {{
        fn traits(function: &str, a: &Arguments) -> Vec<f64> {
            match function.strip_suffix("_with") {
                None => through(&$module::Nominal, function, a),
                Some(function) => through(&$module::WithParameters { parameters: array(&a.pi) }, function, a),
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
            free: answers!($module $(, $optional)*),
            traits,
        }
    }};
}

include!(concat!(env!("OUT_DIR"), "/emitted.rs"));
