//! Steps without influence: what they compute cancels exactly on the way to the result.
//!
//! Such a step is no error (it costs time and rounding), but what it computes is not proved by the equality of the results either. They are found
//! by running the function backwards: the derivative of a random combination of the entries by each step, at a random point of a prime field.

use crate::arithmetic::prime::Prime;
use crate::arithmetic::Arithmetic;
use crate::checker::Point;
use crate::element::Element;
use crate::formula::Formula;
use crate::program::{Program, Step};

/// Numbers of the steps that do not influence any entry, operations only; `None` where the function divides by zero.
pub fn idle_steps(program: &Program, point: &mut Point<Prime>, literals: &[Formula]) -> Option<Vec<usize>> {
    let literals = point.literals_of(program, literals)?;
    let values: Option<Vec<_>> = program.values(&point.reference.state, &literals).into_iter().collect();
    let values = values?;
    let zero = point.arithmetic.integer(0);
    let mut adjoint = vec![zero; values.len()];
    for output in &program.outputs {
        adjoint[output.step] = adjoint[output.step].plus(&point.arithmetic.draw());
    }
    for (i, step) in program.steps.iter().enumerate().rev() {
        let own = adjoint[i];
        let mut add = |to: usize, amount| adjoint[to] = adjoint[to].plus(&amount);
        match step {
            Step::Input(..) | Step::Literal(_) | Step::Sine(_) | Step::Cosine(_) | Step::Sign(_) | Step::Stribeck(..) => {}
            // Its derivative is 0.
            Step::SignOf(_) => {}
            Step::Negate(a) => add(*a, own.negated()),
            Step::Add(a, b) => {
                add(*a, own);
                add(*b, own);
            }
            Step::Subtract(a, b) => {
                add(*a, own);
                add(*b, own.negated());
            }
            Step::Multiply(a, b) | Step::Product(a, b) => {
                add(*a, own.times(&values[*b]));
                add(*b, own.times(&values[*a]));
            }
            Step::Divide(a, b) => {
                let inverse = values[*b].inverse()?;
                add(*a, own.times(&inverse));
                add(*b, own.times(&values[i]).times(&inverse).negated());
            }
        }
    }
    let is_operation = |step: &Step| step.operands()[1].is_some();
    Some((0..values.len()).filter(|&i| is_operation(&program.steps[i]) && adjoint[i].is_zero()).collect())
}
