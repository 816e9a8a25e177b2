//! What a function may divide by.
//!
//! ```text
//! forward dynamics and its derivatives   pivots of B(q)
//! operational inertia                    pivots of B(q) and of J B^-1 J'
//! centre of mass                         the mass of the arm
//! all others                             nothing
//! ```
//!
//! A pivot is the quotient of two leading minors, joints or rows in their order or from the last to the first. B is the matrix of a
//! quadratic form, the kinetic energy: of an arm that no motion leaves at rest all minors are positive, for every q. Those of J B^-1 J'
//! are, but at singular configurations, where the function has no value. So every other divisor is one that the equations do not ask for,
//! and that may be 0 where they have a value.
//!
//! A divisor is a pivot or its negative, without a factor of its own: then it keeps its sign, and is no smaller than what is to be
//! inverted. Tested at two states in each prime field, with two vectors of parameters.

use std::collections::BTreeSet;

use crate::element::Element;
use crate::program::{Program, Step};

/// Matrices whose pivots are divisors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Matrix {
    /// B(q).
    Inertia,
    /// B(q) at run-time parameters.
    InertiaWith,
    /// J B^-1 J' of the rows of the task.
    Mobility,
    /// The mass of the arm, a matrix of one entry.
    Mass,
    /// The same at run-time parameters.
    MassWith,
}

/// Whose pivots a function may divide by.
pub fn needed(function: &str) -> &'static [Matrix] {
    match function {
        "forward_dynamics" | "forward_dynamics_derivatives" => &[Matrix::Inertia],
        "forward_dynamics_with" => &[Matrix::InertiaWith],
        "operational_inertia" => &[Matrix::Inertia, Matrix::Mobility],
        "center_of_mass" => &[Matrix::Mass],
        "center_of_mass_with" => &[Matrix::MassWith],
        _ => &[],
    }
}

/// Pivots of matrices at a state.
#[derive(Clone, Debug)]
pub struct Pivots<E>(Vec<(Matrix, Vec<E>)>);

impl<E: Element> Pivots<E> {
    /// The pivots of matrices given row by row.
    pub fn of(matrices: Vec<(Matrix, Vec<Vec<E>>)>) -> Pivots<E> {
        let both = |rows: &[Vec<E>]| {
            let turned: Vec<Vec<E>> = rows.iter().rev().map(|row| row.iter().rev().cloned().collect()).collect();
            [eliminated(rows), eliminated(&turned)].concat()
        };
        Pivots(matrices.into_iter().map(|(matrix, rows)| (matrix, both(&rows))).collect())
    }

    fn of_function(&self, function: &str) -> impl Iterator<Item = &E> {
        let needed = needed(function);
        self.0.iter().filter(|(matrix, _)| needed.contains(matrix)).flat_map(|(_, pivots)| pivots)
    }
}

/// The pivots of a matrix, up to the first that is 0.
fn eliminated<E: Element>(rows: &[Vec<E>]) -> Vec<E> {
    let mut rows = rows.to_vec();
    let mut pivots = Vec::new();
    for k in 0..rows.len() {
        let pivot = rows[k][k].clone();
        let Some(inverse) = pivot.inverse() else { break };
        pivots.push(pivot);
        let upper = rows[k].clone();
        for row in &mut rows[k + 1..] {
            let factor = row[k].times(&inverse);
            if !factor.is_zero() {
                row.iter_mut().zip(&upper).skip(k).for_each(|(x, u)| *x = x.minus(&factor.times(u)));
            }
        }
    }
    pivots
}

/// The steps that a function divides by.
pub fn divisors(program: &Program) -> Vec<usize> {
    let divisor = |step: &Step| match step {
        Step::Divide(_, divisor) => Some(*divisor),
        _ => None,
    };
    let mut divisors: Vec<usize> = program.steps.iter().filter_map(divisor).collect();
    divisors.sort_unstable();
    divisors.dedup();
    divisors
}

/// Whether a divisor with these values at two states is a pivot there, or the negative of one at both.
pub fn is_needed<E: Element>(function: &str, values: [&E; 2], pivots: [&Pivots<E>; 2]) -> bool {
    let [here, there] = pivots.map(|pivots| pivots.of_function(function));
    let negatives = values.map(E::negated);
    here.zip(there).any(|(p, q)| values == [p, q] || negatives.each_ref() == [p, q])
}

/// Of a function that divides: the steps that no quotient takes part in and that are divisors, or operands of those that a quotient takes
/// part in, or entries.
pub fn undivided_operands(program: &Program) -> Vec<usize> {
    let mut divided: Vec<bool> = Vec::with_capacity(program.steps.len());
    let mut operands = BTreeSet::new();
    for step in &program.steps {
        let of = || step.operands().into_iter().flatten();
        let takes_part = matches!(step, Step::Divide(..)) || of().any(|operand| divided[operand]);
        if takes_part {
            operands.extend(of().filter(|&operand| !divided[operand]));
        }
        divided.push(takes_part);
    }
    if operands.is_empty() {
        return Vec::new();
    }
    let entries = program.outputs.iter().map(|output| output.step).filter(|&step| !divided[step]);
    operands.extend(entries);
    operands.into_iter().collect()
}
