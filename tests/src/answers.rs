//! The functions of an emitted module by their names. `emitted.rs` asks the modules of this crate; `compiled.rs` writes this file into the
//! project that it compiles others in. Who takes the macros in has a type `Arguments` in scope.

/// Numbers, however they are nested, in order.
pub(crate) trait Flat {
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

/// `Real` of a module.
pub(crate) trait Float: Copy {
    fn nearest(x: f64) -> Self;
}

impl Float for f64 {
    fn nearest(x: f64) -> f64 {
        x
    }
}

impl Float for f32 {
    fn nearest(x: f64) -> f32 {
        x as f32
    }
}

/// The array that an emitted function takes.
pub(crate) fn array<T: Float, const N: usize>(values: &[f64]) -> [T; N] {
    assert_eq!(values.len(), N, "as many numbers as the function takes");
    std::array::from_fn(|i| T::nearest(values[i]))
}

/// Calls a function of a module: `call!(module::function, arguments, names of those that it takes...)`.
macro_rules! call {
    ($module:ident :: $function:ident, $a:ident, $($argument:ident),*) => {
        $module::$function($(&$crate::answers::array(&$a.$argument)),*)
    };
}

/// The function that answers for a module: `answers!(module, function, ..)` with those functions of q that not every module has.
macro_rules! answers {
    ($module:ident $(, $optional:ident)*) => {{
        fn terms(terms: $module::EquationsOfMotion) -> Vec<f64> {
            [terms.inertia.flat(), terms.coriolis.flat(), terms.gravity.flat()].concat()
        }
        fn answer(function: &str, a: &Arguments) -> Vec<f64> {
            match function {
                "dof" => vec![$module::DOF as f64],
                "nominal" => $module::NOMINAL_PARAMETERS.flat(),
                "nominal_base" => $module::NOMINAL_BASE_PARAMETERS.flat(),
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
                "inverse_dynamics_derivatives" => call!($module::inverse_dynamics_derivatives, a, q, dq, ddq).flat(),
                "forward_dynamics_derivatives" => call!($module::forward_dynamics_derivatives, a, q, dq, tau).flat(),
                $(stringify!($optional) => call!($module::$optional, a, q).flat(),)*
                _ => panic!("no function `{function}`"),
            }
        }
        answer
    }};
}
