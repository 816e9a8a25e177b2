//! The emitted modules, compiled into this crate as a user compiles one into theirs, and each as [`Functions`].

use armgen_runtime::nalgebra::{convert, RealField, SMatrix, SVector};
use armgen_runtime::robot::{Kinematics, Regressor};

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
    nominal: fn() -> Vec<f64>,
    nominal_base: fn() -> Vec<f64>,
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
        (self.nominal)()
    }

    fn nominal_base(&self) -> Vec<f64> {
        (self.nominal_base)()
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

/// f64 or f32.
pub trait Real: RealField + Copy + Into<f64> {}

impl<T: RealField + Copy + Into<f64>> Real for T {}

/// The array that an emitted function takes.
fn array<T: Real, const N: usize>(values: &[f64]) -> [T; N] {
    assert_eq!(values.len(), N);
    std::array::from_fn(|i| convert(values[i]))
}

/// Numbers, however they are nested, in order.
trait Flat {
    fn flat(self) -> Vec<f64>;
}

impl Flat for f64 {
    fn flat(self) -> Vec<f64> {
        vec![self]
    }
}

impl Flat for f32 {
    fn flat(self) -> Vec<f64> {
        vec![f64::from(self)]
    }
}

impl<T: Flat, const N: usize> Flat for [T; N] {
    fn flat(self) -> Vec<f64> {
        self.into_iter().flat_map(Flat::flat).collect()
    }
}

impl<A: Flat, B: Flat> Flat for (A, B) {
    fn flat(self) -> Vec<f64> {
        [self.0.flat(), self.1.flat()].concat()
    }
}

impl<A: Flat, B: Flat, C: Flat> Flat for (A, B, C) {
    fn flat(self) -> Vec<f64> {
        [self.0.flat(), self.1.flat(), self.2.flat()].concat()
    }
}

fn flat_matrix<T: Real, const R: usize, const C: usize>(m: &SMatrix<T, R, C>) -> Vec<f64> {
    (0..R).flat_map(|i| (0..C).map(move |j| m[(i, j)].into())).collect()
}

/// Calls a method of the traits.
fn through<T: Real, R, const N: usize, const P: usize>(robot: &R, function: &str, a: &Arguments) -> Vec<f64>
where
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

/// Calls a free function of a module: `call!(module, function, arguments...)`.
macro_rules! call {
    ($module:ident :: $function:ident, $a:ident, $($argument:ident),*) => {
        $module::$function($(&array(&$a.$argument)),*)
    };
}

/// The table entry of an emitted module, with what computes the function that not every module has.
macro_rules! emitted {
    ($module:ident, $path:literal, $operational_inertia:expr) => {{
        fn nominal_base() -> Vec<f64> {
            $module::NOMINAL_BASE_PARAMETERS.flat()
        }
        fn nominal() -> Vec<f64> {
            $module::NOMINAL_PARAMETERS.flat()
        }
        fn terms(terms: $module::EquationsOfMotion) -> Vec<f64> {
            [terms.inertia.flat(), terms.coriolis.flat(), terms.gravity.flat()].concat()
        }
        fn free(function: &str, a: &Arguments) -> Vec<f64> {
            match function {
                "direct_kinematics" => call!($module::direct_kinematics, a, q).flat(),
                "link_frames" => call!($module::link_frames, a, q).flat(),
                "geometric_jacobian" => call!($module::geometric_jacobian, a, q).flat(),
                "geometric_jacobian_dot" => call!($module::geometric_jacobian_dot, a, q, dq).flat(),
                "inertia_matrix" => call!($module::inertia_matrix, a, q).flat(),
                "inertia_matrix_with" => call!($module::inertia_matrix_with, a, pi, q).flat(),
                "coriolis_matrix" => call!($module::coriolis_matrix, a, q, dq).flat(),
                "coriolis_matrix_with" => call!($module::coriolis_matrix_with, a, pi, q, dq).flat(),
                "gravity" => call!($module::gravity, a, q).flat(),
                "gravity_with" => call!($module::gravity_with, a, pi, q).flat(),
                "friction" => call!($module::friction, a, dq).flat(),
                "friction_with" => call!($module::friction_with, a, pi, dq).flat(),
                "equations_of_motion" => terms(call!($module::equations_of_motion, a, q, dq)),
                "equations_of_motion_with" => terms(call!($module::equations_of_motion_with, a, pi, q, dq)),
                "inverse_dynamics" => call!($module::inverse_dynamics, a, q, dq, ddq).flat(),
                "inverse_dynamics_with" => call!($module::inverse_dynamics_with, a, pi, q, dq, ddq).flat(),
                "forward_dynamics" => call!($module::forward_dynamics, a, q, dq, tau).flat(),
                "forward_dynamics_with" => call!($module::forward_dynamics_with, a, pi, q, dq, tau).flat(),
                "regressor" => call!($module::regressor, a, q, dq, dqr, ddqr).flat(),
                "known_torque" => call!($module::known_torque, a, q, dq, dqr, ddqr).flat(),
                "kinetic_energy" => call!($module::kinetic_energy, a, q, dq).flat(),
                "kinetic_energy_with" => call!($module::kinetic_energy_with, a, pi, q, dq).flat(),
                "potential_energy" => call!($module::potential_energy, a, q).flat(),
                "potential_energy_with" => call!($module::potential_energy_with, a, pi, q).flat(),
                "momentum" => call!($module::momentum, a, q, dq).flat(),
                "coriolis_transpose_times" => call!($module::coriolis_transpose_times, a, q, dq).flat(),
                "base_regressor" => call!($module::base_regressor, a, q, dq, ddq).flat(),
                "operational_inertia" => {
                    let operational_inertia: fn(&Arguments) -> Vec<f64> = $operational_inertia;
                    operational_inertia(a)
                }
                "inverse_dynamics_derivatives" => call!($module::inverse_dynamics_derivatives, a, q, dq, ddq).flat(),
                "forward_dynamics_derivatives" => call!($module::forward_dynamics_derivatives, a, q, dq, tau).flat(),
                _ => panic!("no function `{function}`"),
            }
        }
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
            nominal,
            nominal_base,
            free,
            traits,
        }
    }};
}

include!(concat!(env!("OUT_DIR"), "/emitted.rs"));
