//! What a function may take the sign of.
//!
//! ```text
//! torques of a load, of the equation of motion, and their derivatives   g_i(q) of joints with friction that grows with their load
//! all others                                                            nothing
//! ```
//!
//! |g_i| = sign(g_i) g_i is as exact as g_i is, and in derivatives sign(g_i) jumps where the equations jump. The sign of any other value
//! that can be 0 is as good as random in floats where the value is small, and no bound over a box counts that. Two steps that are equal
//! over the reals have different signs there, so that each g_i, or its negative, is the operand in one step. Signs of rates are
//! inputs.
//!
//! Over a field a product is 0 where a factor is: an operand that is some ±g_i at every point is one of them everywhere.

use crate::element::Element;
use crate::program::{Program, Step};

/// The gravity torques whose signs a function may take, by the name of the function that gives them; of an arm that has friction of loads.
pub fn of_torques(function: &str) -> Option<&'static str> {
    match function {
        "load_friction" | "inverse_dynamics" | "forward_dynamics" => Some("gravity"),
        "inverse_dynamics_derivatives" | "forward_dynamics_derivatives" => Some("gravity"),
        "load_friction_with" | "inverse_dynamics_with" | "forward_dynamics_with" => Some("gravity_with"),
        _ => None,
    }
}

/// The steps that a function takes the signs of; a step and its negative are one, and so is a number or an argument that stands there again.
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

/// Whether each of these values at a point is one of the torques there or its negative.
pub fn are_torques<E: Element>(values: &[E], torques: &[&E]) -> bool {
    values.iter().all(|value| torques.iter().any(|torque| value == *torque || *value == torque.negated()))
}

/// Whether two of these values at a point are the same, up to their signs.
pub fn are_equal<E: Element>(values: &[E]) -> bool {
    let same = |a: &E, b: &E| a == b || *a == b.negated();
    values.iter().enumerate().any(|(k, a)| values[..k].iter().any(|b| same(a, b)))
}
