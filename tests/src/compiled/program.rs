//! Emitted modules, asked over standard input. Not a module of the crate that this file lies in: `compiled.rs` adds the arms and writes
//! it into a project of its own.
#![deny(warnings)]

use std::io::{BufRead, Write};

/// The arguments of a question.
struct Given {
    pi: Vec<f64>,
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    dqr: Vec<f64>,
    ddqr: Vec<f64>,
    tau: Vec<f64>,
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

impl<T: Flat, const N: usize> Flat for [T; N] {
    fn flat(self) -> Vec<f64> {
        self.into_iter().flat_map(Flat::flat).collect()
    }
}

fn array<const N: usize>(values: &[f64]) -> [f64; N] {
    values.try_into().expect("as many numbers as the function takes")
}

/// Calls a function of an arm: `call!(arm::function, given, arguments...)`.
macro_rules! call {
    ($arm:ident :: $function:ident, $given:ident, $($argument:ident),*) => {
        $arm::$function($(&array(&$given.$argument)),*)
    };
}

/// What answers for an arm: `answers!(arm, function, ..)` with those functions that only this arm has.
macro_rules! answers {
    ($arm:ident $(, $optional:ident)*) => {{
        fn terms(terms: $arm::EquationsOfMotion) -> Vec<f64> {
            [terms.inertia.flat(), terms.coriolis.flat(), terms.gravity.flat()].concat()
        }
        fn answer(function: &str, a: &Given) -> Vec<f64> {
            match function {
                "dof" => vec![$arm::DOF as f64],
                "nominal" => $arm::NOMINAL_PARAMETERS.flat(),
                "nominal_base" => $arm::NOMINAL_BASE_PARAMETERS.flat(),
                "direct_kinematics" => call!($arm::direct_kinematics, a, q).flat(),
                "link_frames" => call!($arm::link_frames, a, q).flat(),
                "geometric_jacobian" => call!($arm::geometric_jacobian, a, q).flat(),
                "geometric_jacobian_dot" => call!($arm::geometric_jacobian_dot, a, q, dq).flat(),
                "inertia_matrix" => call!($arm::inertia_matrix, a, q).flat(),
                "inertia_matrix_with" => call!($arm::inertia_matrix_with, a, pi, q).flat(),
                "coriolis_matrix" => call!($arm::coriolis_matrix, a, q, dq).flat(),
                "coriolis_matrix_with" => call!($arm::coriolis_matrix_with, a, pi, q, dq).flat(),
                "gravity" => call!($arm::gravity, a, q).flat(),
                "gravity_with" => call!($arm::gravity_with, a, pi, q).flat(),
                "friction" => call!($arm::friction, a, dq).flat(),
                "friction_with" => call!($arm::friction_with, a, pi, dq).flat(),
                "equations_of_motion" => terms(call!($arm::equations_of_motion, a, q, dq)),
                "equations_of_motion_with" => terms(call!($arm::equations_of_motion_with, a, pi, q, dq)),
                "inverse_dynamics" => call!($arm::inverse_dynamics, a, q, dq, ddq).flat(),
                "inverse_dynamics_with" => call!($arm::inverse_dynamics_with, a, pi, q, dq, ddq).flat(),
                "forward_dynamics" => call!($arm::forward_dynamics, a, q, dq, tau).flat(),
                "forward_dynamics_with" => call!($arm::forward_dynamics_with, a, pi, q, dq, tau).flat(),
                "regressor" => call!($arm::regressor, a, q, dq, dqr, ddqr).flat(),
                "known_torque" => call!($arm::known_torque, a, q, dq, dqr, ddqr).flat(),
                "kinetic_energy" => call!($arm::kinetic_energy, a, q, dq).flat(),
                "kinetic_energy_with" => call!($arm::kinetic_energy_with, a, pi, q, dq).flat(),
                "potential_energy" => call!($arm::potential_energy, a, q).flat(),
                "potential_energy_with" => call!($arm::potential_energy_with, a, pi, q).flat(),
                "momentum" => call!($arm::momentum, a, q, dq).flat(),
                "coriolis_transpose_times" => call!($arm::coriolis_transpose_times, a, q, dq).flat(),
                "base_regressor" => call!($arm::base_regressor, a, q, dq, ddq).flat(),
                "inverse_dynamics_derivatives" => call!($arm::inverse_dynamics_derivatives, a, q, dq, ddq).flat(),
                "forward_dynamics_derivatives" => call!($arm::forward_dynamics_derivatives, a, q, dq, tau).flat(),
                $(stringify!($optional) => call!($arm::$optional, a, q).flat(),)*
                _ => panic!("no function `{function}`"),
            }
        }
        answer
    }};
}

fn main() {
    let mut answers = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("text");
        let mut words = line.split(' ');
        let arm: usize = words.next().and_then(|word| word.parse().ok()).expect("an arm");
        let function = words.next().expect("a function");
        let mut list = || -> Vec<f64> {
            let len = words.next().map_or(0, |word| word.parse().expect("a length"));
            let mut number = || f64::from_bits(u64::from_str_radix(words.next().expect("a number"), 16).expect("bits"));
            (0..len).map(|_| number()).collect()
        };
        let given = Given { pi: list(), q: list(), dq: list(), ddq: list(), dqr: list(), ddqr: list(), tau: list() };
        let bits: Vec<String> = ARMS[arm](function, &given).iter().map(|x| format!("{:016x}", x.to_bits())).collect();
        writeln!(answers, "{}", bits.join(" ")).and_then(|()| answers.flush()).expect("the asker reads");
    }
}

