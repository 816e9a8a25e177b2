//! The minimal parameter set: which parameters a motion can tell apart, and the exact combinations in which the others appear.
//!
//! tau = Y phi. The columns of Y that depend linearly on others, as functions of the state, add nothing: with
//! Y_d = Y_b K the torque is Y_b (phi_b + K phi_d), and the entries of phi_b + K phi_d are the base parameters
//! (Gautier and Khalil 1990). The rank and the choice of columns are found in the prime field from random states, where a state more never
//! changes the answer but for odds of 1/p; each row of K is then solved for exactly, over the exact constants, from rational states.

use super::arm::Arm;
use super::newton_euler::Motion;
use super::parameters::{nominal, Entry, ParameterKind, ParameterVector, StandardParameter, View};
use super::regressor::{regressor, standard_columns};
use crate::exact::Number;
use crate::manipulator::Manipulator;
use crate::ring::field::{scramble, Element, Field};
use crate::ring::{ExprId, Node, Pool, Symbol};

/// The columns of a regressor, sorted into those that are independent and the rest.
#[derive(Clone, Debug)]
pub struct Dependence {
    /// Columns whose parameters are kept, ascending.
    pub independent: Vec<usize>,
    /// Each other column as a combination of independent ones: (column, [(independent column, coefficient)]), empty for a zero column.
    pub dependent: Vec<(usize, Vec<(usize, Number)>)>,
}

/// The dependence among the columns of `y`, `y[joint][column]`, taken in order: a column is kept unless those before it span it.
pub fn dependence(pool: &Pool, y: &[Vec<ExprId>]) -> Dependence {
    let columns = y.first().map_or(0, Vec::len);
    let rows = y.len();
    let states = columns / rows.max(1) + 4;
    let mut matrix: Vec<Vec<Element>> = Vec::new();
    for state in 0..states as u64 {
        matrix.extend(field_values(pool, y, state));
    }
    let (pivots, reduced) = echelon(pool.field(), matrix, columns);
    let mut dependent = Vec::new();
    for column in (0..columns).filter(|c| !pivots.contains(c)) {
        let support: Vec<usize> =
            pivots.iter().enumerate().filter(|&(row, _)| reduced[row][column] != pool.field().zero()).map(|(_, &p)| p).collect();
        let coefficients = exact_combination(pool, y, column, &support);
        dependent.push((column, support.into_iter().zip(coefficients).collect()));
    }
    Dependence { independent: pivots, dependent }
}

/// Values of Y at a state of the field, row by row.
fn field_values(pool: &Pool, y: &[Vec<ExprId>], state: u64) -> Vec<Vec<Element>> {
    let field = pool.field();
    let draw = |symbol: Symbol| {
        let (kind, index) = match symbol {
            Symbol::Sine(i) | Symbol::Cosine(i) => (1, i),
            Symbol::Position(i) => (2, i),
            Symbol::Rate(i) => (3, i),
            Symbol::RateSign(i) => (4, i),
            Symbol::Acceleration(i) => (5, i),
            Symbol::ReferenceRate(i) => (6, i),
            Symbol::ReferenceAcceleration(i) => (7, i),
            Symbol::Torque(i) => (8, i),
            Symbol::Parameter(i) => (9, i),
        };
        field.from_u64(scramble(scramble(state << 8 | kind) ^ u64::from(index)))
    };
    let mut constants = field.clone();
    let mut values: Vec<Element> = Vec::with_capacity(pool.len());
    for index in 0..pool.len() {
        let of = |e: ExprId| if e.is_negated() { field.neg(values[e.index()]) } else { values[e.index()] };
        let expr = pool.expr(index);
        values.push(match pool.node(expr) {
            Node::Constant(_) => constants.number(&pool.as_constant(expr).expect("a constant")),
            Node::Symbol(symbol @ Symbol::Sine(_)) => field.circle(draw(symbol)).0,
            Node::Symbol(symbol @ Symbol::Cosine(_)) => field.circle(draw(symbol)).1,
            Node::Symbol(symbol) => draw(symbol),
            Node::Add(a, b) => field.add(of(a), of(b)),
            Node::Mul(a, b) => field.mul(of(a), of(b)),
            Node::Reciprocal(a) => field.inverse(of(a)),
        });
    }
    let of = |e: ExprId| if e.is_negated() { field.neg(values[e.index()]) } else { values[e.index()] };
    y.iter().map(|row| row.iter().map(|&e| of(e)).collect()).collect()
}

/// Reduced row echelon form: pivot columns, and the row of each.
fn echelon(field: &Field, mut matrix: Vec<Vec<Element>>, columns: usize) -> (Vec<usize>, Vec<Vec<Element>>) {
    let mut pivots = Vec::new();
    for column in 0..columns {
        let row = pivots.len();
        let Some(found) = (row..matrix.len()).find(|&r| matrix[r][column] != field.zero()) else { continue };
        matrix.swap(row, found);
        let inverse = field.inverse(matrix[row][column]);
        matrix[row].iter_mut().for_each(|x| *x = field.mul(*x, inverse));
        let pivot = matrix[row].clone();
        for (r, other) in matrix.iter_mut().enumerate() {
            let factor = other[column];
            if r != row && factor != field.zero() {
                for (x, &p) in other.iter_mut().zip(&pivot) {
                    *x = field.sub(*x, field.mul(factor, p));
                }
            }
        }
        pivots.push(column);
    }
    (pivots, matrix)
}

/// The exact coefficients of Y_column = Σ k_s Y_s over the support, from rational states.
fn exact_combination(pool: &Pool, y: &[Vec<ExprId>], column: usize, support: &[usize]) -> Vec<Number> {
    if support.is_empty() {
        return Vec::new();
    }
    let mut system: Vec<Vec<Number>> = Vec::new();
    let mut pivots: Vec<usize> = Vec::new();
    for state in 0.. {
        let of = Pool::rational_state(state);
        for row in y {
            let exprs: Vec<ExprId> = support.iter().chain([&column]).map(|&c| row[c]).collect();
            let mut equation = pool.evaluate(&exprs, &of).expect("a regressor has no reciprocals");
            for (known, &pivot) in system.iter().zip(&pivots) {
                let factor = equation[pivot].clone();
                if !factor.is_zero() {
                    for (x, p) in equation.iter_mut().zip(known) {
                        *x = &*x - &(&factor * p);
                    }
                }
            }
            let Some(pivot) = (0..support.len()).find(|&k| !equation[k].is_zero()) else { continue };
            let scale = equation[pivot].clone();
            let equation: Vec<Number> = equation.iter().map(|x| x.checked_div(&scale).expect("the pivot is not zero")).collect();
            for known in &mut system {
                let factor = known[pivot].clone();
                if !factor.is_zero() {
                    for (x, p) in known.iter_mut().zip(&equation) {
                        *x = &*x - &(&factor * p);
                    }
                }
            }
            system.push(equation);
            pivots.push(pivot);
            if system.len() == support.len() {
                let mut solution = vec![Number::zero(); support.len()];
                for (equation, &pivot) in system.iter().zip(&pivots) {
                    solution[pivot] = equation[support.len()].clone();
                }
                return solution;
            }
        }
    }
    unreachable!("independent columns give a full system after finitely many states")
}

/// The regressor of a parameter vector, in a pool of its own.
pub fn regressor_of(manipulator: &Manipulator, field: &Field, vector: &ParameterVector) -> (Pool, Vec<Vec<ExprId>>) {
    let mut pool = Pool::new(field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Vector(vector));
    let y = regressor(&mut pool, &arm, vector);
    (pool, y)
}

/// The base parameters of an arm.
pub fn base_parameters(manipulator: &Manipulator, field: &Field) -> ParameterVector {
    let mut columns = StandardParameter::all(manipulator);
    columns.sort_by_key(|&column| preference(column));
    let mut pool = Pool::new(field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Nominal);
    let motion = Motion::with_reference(&mut pool, &arm);
    let y = standard_columns(&mut pool, &arm, &motion, &columns);
    let dependence = dependence(&pool, &y);
    let value = |column: usize| nominal(manipulator, &columns[column].value(manipulator));
    let mut base: Vec<(StandardParameter, Entry)> = dependence
        .independent
        .iter()
        .map(|&column| {
            let parameter = columns[column];
            let mut total = value(column);
            let mut meaning = parameter.name();
            let mut parts: Vec<(StandardParameter, &Number)> = dependence
                .dependent
                .iter()
                .flat_map(|(other, combination)| {
                    combination.iter().filter(|(c, _)| *c == column).map(|(_, k)| (columns[*other], k))
                })
                .collect();
            parts.sort_by_key(|(other, _)| *other);
            for (other, k) in &parts {
                let negative = k.leads_negative();
                let size = if negative { -*k } else { (*k).clone() };
                let factor = match (size.is_one(), size.terms().count()) {
                    (true, _) => String::new(),
                    (false, 1) => format!("{size} "),
                    (false, _) => format!("({size}) "),
                };
                meaning += &format!(" {} {factor}{}", if negative { '-' } else { '+' }, other.name());
                let position = columns.iter().position(|c| c == other).expect("a column");
                total = &total + &(*k * &value(position));
            }
            let name = if parts.is_empty() { parameter.name() } else { format!("{}R", parameter.name()) };
            (parameter, Entry { name, nominal: total, meaning })
        })
        .collect();
    base.sort_by_key(|(parameter, _)| *parameter);
    let (kept, entries) = base.into_iter().unzip();
    ParameterVector { entries, kind: ParameterKind::Base(kept) }
}

/// Columns are kept in this order: friction, then links from the base outwards, so that what a joint does not feel is regrouped towards the base;
/// within a link the mass last. Rotors and the payload are told apart from links only where nothing else can carry their effect.
fn preference(parameter: StandardParameter) -> (u8, u16, u8) {
    const RANK: [u8; 10] = [9, 3, 4, 8, 5, 1, 7, 2, 6, 0];
    match parameter {
        StandardParameter::RotorViscous(i) => (0, i, 0),
        StandardParameter::Viscous(i) => (0, i, 1),
        StandardParameter::Coulomb(i) => (0, i, 2),
        StandardParameter::Link(i, k) => (1, i, RANK[usize::from(k)]),
        StandardParameter::RotorInertia(i) => (2, i, 0),
        StandardParameter::Payload(k) => (3, 0, k),
    }
}
