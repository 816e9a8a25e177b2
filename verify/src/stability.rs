//! Whether rounding leaves of a function what the equations say: a function can equal them over the real numbers and be useless in floats,
//! as `x + 1e17 - 1e17` is.
//!
//! With S the largest size of an entry at some states of the box, u the unit roundoff of the scalar and n the number of joints:
//!
//! ```text
//! (a)  no value leaves the scalar anywhere in the box
//! (b)  the bound over the box is at most 2^(12 + 5n/2) u S
//! (c)  at each of 32 states the bound there is at most 2^(12 + n/2) u S, all computed in f64
//! ```
//!
//! (a) and (b) are of the whole box and follow from intervals, which widen by a factor with each joint; (c) is sharp, and of states alone: half of them
//! random, half with arguments at the ends of the box, all drawn from the hash of the module. Emitted functions stay below 2^19 u S over the box and
//! below 2^10 u S at states with seven joints, 2^39 and 2^16 with sixteen: each loss of four more digits than that is refused, in f32 and in f64.
//!
//! Functions that divide are judged in two parts. What no quotient takes part in is held to (a), (b) and (c) where it meets the first one. The whole is held to (c)
//! at each state by its own size there, with a factor κ² more: κ is the largest quotient of a diagonal entry, at any state, and its pivot at this one, for the matrices that are
//! inverted: how much larger an error becomes that was made in them. Where 2^(12 + n/2) κ² u is more than 1, near singular configurations,
//! nothing can be asked for. Intervals say nothing there in general; of `forward_dynamics` the bound of torques ([`mod@crate::residual`]) does.

use std::collections::BTreeMap;
use std::fmt;

use crate::arithmetic::Stream;
use crate::bounds::{corner, draw, literal_errors, two_digits, undivided_operands, Bound, Domain};
use crate::check::Check;
use crate::companion::{LaneArguments, Table, LANES};
use crate::divisors::{needed, Matrix};
use crate::enclosure::Float;
use crate::float::Arguments;
use crate::formula::Formula;
use crate::program::Program;
use crate::reader::Module;

/// Why a function is useless in floats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// A value can leave the scalar: within the limits of the joints, or at one state of the box.
    Leaves(String),
    /// Rounding makes errors that the equations do not ask for.
    Loses(String),
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Unfit::Leaves(why) | Unfit::Loses(why)) = self;
        f.write_str(why)
    }
}

/// Batches of states.
const BATCHES: usize = 4;

/// States at which functions of a module are run.
pub struct Trial<'a> {
    module: &'a Module,
    joints: usize,
    task: Vec<usize>,
    batches: Vec<([Arguments<f64>; LANES], LaneArguments)>,
    /// By state: κ of each matrix.
    conditions: Vec<(Matrix, Vec<f64>)>,
}

/// The largest quotient of a diagonal entry, anywhere, and its pivot here.
fn condition(rows: &[Vec<f64>], diagonal: &[f64]) -> f64 {
    let mut rows = rows.to_vec();
    let mut largest = 1.0f64;
    for k in 0..rows.len() {
        let (pivot, upper) = (rows[k][k], rows[k].clone());
        let quotient = diagonal[k] / pivot;
        if !(quotient >= 0.0 && quotient.is_finite()) {
            return f64::INFINITY;
        }
        largest = largest.max(quotient);
        for row in &mut rows[k + 1..] {
            let factor = row[k] / pivot;
            row.iter_mut().zip(&upper).skip(k).for_each(|(x, u)| *x -= factor * u);
        }
    }
    largest
}

impl<'a> Trial<'a> {
    /// States of a box, for the functions of a module that equal the equations.
    pub fn new(module: &'a Module, domain: &Domain, task: Vec<usize>, stream: &mut Stream) -> Trial<'a> {
        let batch = |k: usize| {
            let states = std::array::from_fn(|_| match k % 2 {
                0 => draw(domain, stream, module.real),
                _ => corner(domain, stream, module.real),
            });
            let lanes = LaneArguments::new(&states, Float::F64);
            (states, lanes)
        };
        let batches: Vec<_> = (0..BATCHES).map(batch).collect();
        let mut trial = Trial { module, joints: domain.q.len(), task, batches, conditions: Vec::new() };
        let matrices = [Matrix::Inertia, Matrix::InertiaWith, Matrix::Mobility];
        trial.conditions = matrices.into_iter().map(|matrix| (matrix, trial.conditions_of(matrix))).collect();
        trial
    }

    fn states(&self) -> impl Iterator<Item = &Arguments<f64>> {
        self.batches.iter().flat_map(|(states, _)| states)
    }

    fn values(&self, function: &str, state: &Arguments<f64>) -> Option<Vec<f64>> {
        let program = self.module.program(function)?;
        let literals: Vec<f64> = program.literals.iter().map(|literal| literal.value).collect();
        program.run(state, &literals).into_iter().collect()
    }

    fn conditions_of(&self, matrix: Matrix) -> Vec<f64> {
        let n = self.joints;
        let rows = |function: &str, state: &Arguments<f64>| -> Option<Vec<Vec<f64>>> {
            Some(self.values(function, state)?.chunks(n).map(<[f64]>::to_vec).collect())
        };
        let of = |state: &Arguments<f64>| match matrix {
            Matrix::Inertia => rows("inertia_matrix", state),
            Matrix::InertiaWith => rows("inertia_matrix_with", state),
            Matrix::Mobility => {
                let jacobian = rows("geometric_jacobian", state)?;
                let task: Vec<Vec<f64>> = self.task.iter().map(|&row| jacobian[row].clone()).collect();
                mobility(&rows("inertia_matrix", state)?, &task)
            }
            // A sum of masses: nothing cancels.
            Matrix::Mass | Matrix::MassWith => Some(vec![vec![1.0]]),
        };
        let matrices: Vec<Option<Vec<Vec<f64>>>> = self.states().map(of).collect();
        let size = |k: usize| matrices.iter().flatten().map(|rows| rows[k][k].abs()).fold(0.0, f64::max);
        let diagonal: Vec<f64> = (0..matrices.iter().flatten().next().map_or(0, Vec::len)).map(size).collect();
        matrices.iter().map(|rows| rows.as_ref().map_or(f64::INFINITY, |rows| condition(rows, &diagonal))).collect()
    }

    /// κ of what a function inverts, state by state.
    fn conditions_for(&self, function: &str) -> Vec<f64> {
        let needed = needed(function);
        let mut product = vec![1.0; self.batches.len() * LANES];
        for (_, of) in self.conditions.iter().filter(|(matrix, _)| needed.contains(matrix)) {
            product.iter_mut().zip(of).for_each(|(x, k)| *x *= k);
        }
        product
    }

    /// What makes a function useless in floats, if it is.
    pub fn fault(&self, program: &Program, values: &[Formula], bound: &Bound) -> Option<Unfit> {
        let operands = undivided_operands(program);
        if operands.is_empty() {
            return self.undivided_fault(program, values, bound.largest());
        }
        self.undivided_fault(&program.part(&operands), values, bound.undivided).or_else(|| self.divided_fault(program, values))
    }

    fn undivided_fault(&self, program: &Program, values: &[Formula], bound: f64) -> Option<Unfit> {
        let real = self.module.real;
        if !bound.is_finite() && Check::Leaves.is_made() {
            return Some(Unfit::Leaves(format!("a value can leave {} inside the box", real.name())));
        }
        let runs = self.runs(program, values)?;
        let size = runs.iter().flatten().fold(0.0f64, |size, (value, _)| size.max(value.abs()));
        let most = |exponent: f64, real: Float| exponent.exp2() * (real.unit() * size + real.smallest_normal());
        let n = self.joints as f64;
        let allowed = most(12.0 + 2.5 * n, real);
        if exceeds(bound, allowed) && Check::Box.is_made() {
            return Some(too_much("anywhere in the box", bound, allowed, size));
        }
        let worst = runs.iter().flatten().fold(0.0f64, |worst, (_, error)| if exceeds(*error, worst) { *error } else { worst });
        let allowed = most(12.0 + 0.5 * n, Float::F64);
        (exceeds(worst, allowed) && Check::States.is_made())
            .then(|| too_much("in f64, at a state of the box", worst, allowed, size))
    }

    fn divided_fault(&self, program: &Program, values: &[Formula]) -> Option<Unfit> {
        let factor = (12.0 + 0.5 * self.joints as f64).exp2();
        let (real, unit) = (self.module.real, Float::F64.unit());
        let runs = self.runs(program, values)?;
        let states = runs.iter().zip(self.conditions_for(&program.name)).zip(self.states());
        for ((run, condition), state) in states {
            let factor = factor * condition * condition;
            let size = run.iter().fold(0.0f64, |size, (value, _)| size.max(value.abs()));
            let worst = run.iter().fold(0.0f64, |worst, (_, error)| if exceeds(*error, worst) { *error } else { worst });
            let allowed = factor * (unit * size + f64::MIN_POSITIVE);
            if factor * unit < 1.0 && exceeds(worst, allowed) && Check::DividedStates.is_made() {
                return Some(too_much("in f64, at a state of the box", worst, allowed, size));
            }
            // Of a single number the quotients alone are finite in f64.
            if Check::DividedLeaves.is_made()
                && factor * real.unit() < 1.0
                && program.run_float(state, real).iter().any(|value| !value.is_finite())
            {
                return Some(Unfit::Leaves(format!("a value leaves {} at a state of the box", real.name())));
            }
        }
        None
    }

    /// Values and errors of the results in f64, state by state; the arguments are those of the module's scalar.
    fn runs(&self, program: &Program, values: &[Formula]) -> Option<Vec<Vec<(f64, f64)>>> {
        let errors = literal_errors(program, values, Float::F64);
        let mut table = Table::of(program, &errors, Float::F64).ok()?.lanes();
        let mut runs = vec![Vec::with_capacity(program.outputs.len()); self.batches.len() * LANES];
        for (k, (_, lanes)) in self.batches.iter().enumerate() {
            table.run(lanes);
            let mut known: BTreeMap<usize, [f64; LANES]> = BTreeMap::new();
            for output in &program.outputs {
                let (value, _) = table.step(output.step);
                let error = *known.entry(output.step).or_insert_with(|| table.bound(output.step));
                for lane in 0..LANES {
                    runs[k * LANES + lane].push((value[lane], error[lane]));
                }
            }
        }
        Some(runs)
    }
}

/// J B^-1 J'.
fn mobility(b: &[Vec<f64>], task: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let columns: Vec<Vec<f64>> = (0..b.len()).map(|i| task.iter().map(|row| row[i]).collect()).collect();
    let solved = crate::equations::vector::solve(b, &columns)?;
    let entry = |row: &[f64], j: usize| row.iter().zip(&solved).map(|(x, solved)| x * solved[j]).sum();
    Some(task.iter().map(|row| (0..task.len()).map(|j| entry(row, j)).collect()).collect())
}

/// Whether a is larger than b, or one of the two is not a number.
fn exceeds(a: f64, b: f64) -> bool {
    a > b || a.is_nan() || b.is_nan()
}

fn too_much(place: &str, error: f64, allowed: f64, size: f64) -> Unfit {
    Unfit::Loses(format!(
        "rounding can make an error of {} {place}, in values of up to {}: the equations ask for {} at most",
        two_digits(error),
        two_digits(size),
        two_digits(allowed)
    ))
}
