//! The permitted operands of a sign.
//!
//! ```text
//! torques of a load, of the equation of motion, and their derivatives   g_i(q) of joints with load-dependent friction
//! all others                                                            nothing
//! ```
//!
//! |g_i| = sign(g_i) g_i is as exact as g_i, and in derivatives sign(g_i) jumps where the equations jump. For any other value that can be 0, the
//! sign in floats is practically random where the value is small, and no bound over a box covers that. Two steps that are equal over the reals
//! can have different signs there, so each g_i, or its negative, must be the operand in a single step. Signs of rates are inputs.
//!
//! In a field a product is 0 only if a factor is. So an operand that equals some ±g_i at every point equals the same ±g_i everywhere.

use crate::values::element::Element;
use crate::values::program::{Program, Step};

/// The function with the gravity torques whose signs a function may take, for an arm with load-dependent friction.
pub fn of_torques(function: &str) -> Option<&'static str> {
    match function {
        "load_friction" | "inverse_dynamics" | "forward_dynamics" => Some("gravity"),
        "inverse_dynamics_derivatives" | "forward_dynamics_derivatives" => Some("gravity"),
        "load_friction_with" | "inverse_dynamics_with" | "forward_dynamics_with" => Some("gravity_with"),
        _ => None,
    }
}

/// The steps whose signs a function takes. A step and its negative count once, and so do repeated numbers and arguments.
pub fn operands(program: &Program) -> Vec<usize> {
    let first = |step: usize| match &program.steps[step] {
        Step::Literal(k) => {
            let same =
                |other: &Step| matches!(other, Step::Literal(l) if program.literals[*l].value == program.literals[*k].value);
            program.steps.iter().position(same).unwrap_or(step)
        }
        input @ Step::Input(..) => program.steps.iter().position(|other| other == input).unwrap_or(step),
        _ => step,
    };
    let without_minus = |mut step: usize| {
        while let Step::Negate(of) = program.steps[step] {
            step = of;
        }
        step
    };
    let operand = |step: &Step| match step {
        Step::SignOf(of) => Some(first(without_minus(*of))),
        _ => None,
    };
    let mut operands: Vec<usize> = program.steps.iter().filter_map(operand).collect();
    operands.sort_unstable();
    operands.dedup();
    operands
}

/// Whether each of these values at a point equals one of the torques or its negative.
pub fn are_torques<E: Element>(values: &[E], torques: &[&E]) -> bool {
    values.iter().all(|value| torques.iter().any(|torque| value == *torque || *value == torque.negated()))
}

/// Whether two of these values at a point are equal up to sign.
pub fn are_equal<E: Element>(values: &[E]) -> bool {
    let same = |a: &E, b: &E| a == b || *a == b.negated();
    values.iter().enumerate().any(|(k, a)| values[..k].iter().any(|b| same(a, b)))
}
