//! The permitted divisors of a function.
//!
//! ```text
//! forward dynamics and its derivatives   pivots of B(q)
//! operational inertia                    pivots of B(q) and of J B^-1 J'
//! centre of mass                         the mass of the arm
//! all others                             nothing
//! ```
//!
//! A pivot is the quotient of two leading minors, in ascending or descending order of joints or rows. B is the matrix of the kinetic energy.
//! If every motion has positive energy, all its minors are positive for every q. The minors of J B^-1 J' are positive except at singular
//! configurations, where the function has no value. Any other divisor is not required by the equations, and may be 0 where they have a value.
//!
//! A divisor must be a pivot or its negative without a further factor. It then keeps its sign, and is no smaller than the quantity to invert.
//! The check uses two states in each prime field, with two parameter vectors.

use std::collections::BTreeSet;

use crate::values::contract::{tip_of, Promise};
use crate::values::element::Element;
use crate::values::program::Program;

/// Matrices whose pivots are permitted divisors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Matrix {
    /// B(q).
    Inertia,
    /// B(q) with run-time parameters.
    InertiaWith,
    /// J B^-1 J' for the rows of the task of the end effector of this number.
    Mobility(usize),
    /// The mass of the arm, a 1×1 matrix.
    Mass,
    /// The mass with run-time parameters.
    MassWith,
}

/// The matrices whose pivots a function may divide by; the number of its end effector is left open.
pub fn needed(function: &str) -> &'static [Matrix] {
    match Promise::of(function).filter(|(promise, _)| promise.of_tip).map_or(function, |(promise, _)| promise.name) {
        "forward_dynamics" | "forward_dynamics_derivatives" => &[Matrix::Inertia],
        "forward_dynamics_with" => &[Matrix::InertiaWith],
        "operational_inertia" => &[Matrix::Inertia, Matrix::Mobility(0)],
        "center_of_mass" => &[Matrix::Mass],
        "center_of_mass_with" => &[Matrix::MassWith],
        _ => &[],
    }
}

/// Pivots of matrices at a state.
#[derive(Clone, Debug)]
pub struct Pivots<E> {
    all: Vec<(Matrix, Vec<E>)>,
    /// What names of functions of each end effector begin with.
    tips: Vec<String>,
}

impl<E: Element> Pivots<E> {
    /// The pivots of matrices, given row by row.
    pub fn of(matrices: Vec<(Matrix, Vec<Vec<E>>)>, tips: Vec<String>) -> Pivots<E> {
        let both = |rows: &[Vec<E>]| {
            let turned: Vec<Vec<E>> = rows.iter().rev().map(|row| row.iter().rev().cloned().collect()).collect();
            [eliminated(rows), eliminated(&turned)].concat()
        };
        Pivots { all: matrices.into_iter().map(|(matrix, rows)| (matrix, both(&rows))).collect(), tips }
    }

    fn of_function<'a>(&'a self, function: &'a str) -> impl Iterator<Item = &'a E> {
        let needed = needed(function);
        let is_needed = move |matrix: Matrix| match matrix {
            Matrix::Mobility(tip) => needed.contains(&Matrix::Mobility(0)) && is_of(function, &self.tips[tip]),
            other => needed.contains(&other),
        };
        self.all.iter().filter(move |(matrix, _)| is_needed(*matrix)).flat_map(|(_, pivots)| pivots)
    }
}

/// Whether a function is of the end effector that names begin with this for.
fn is_of(function: &str, prefix: &str) -> bool {
    tip_of(function).map_or(String::new(), |tip| format!("{tip}_")) == prefix
}

/// The pivots of a matrix, up to the first 0.
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

/// Whether a divisor with these values at two states equals a pivot at both states, or the negative of one at both.
pub fn is_needed<E: Element>(function: &str, values: [&E; 2], pivots: [&Pivots<E>; 2]) -> bool {
    let [here, there] = pivots.map(|pivots| pivots.of_function(function));
    let negatives = values.map(E::negated);
    here.zip(there).any(|(p, q)| values == [p, q] || negatives.each_ref() == [p, q])
}

/// For a function with divisions: the steps independent of any quotient that are divisors, entries, or operands of steps that depend on a
/// quotient.
pub fn undivided_operands(program: &Program) -> Vec<usize> {
    let mut divided: Vec<bool> = Vec::with_capacity(program.steps.len());
    let mut operands = BTreeSet::new();
    for step in &program.steps {
        let of = || step.operands().into_iter().flatten();
        let takes_part = program.divisor(step).is_some() || of().any(|operand| divided[operand]);
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
