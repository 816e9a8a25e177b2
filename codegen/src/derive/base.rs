//! The minimal parameter set: which parameters a motion can tell apart, and the exact combinations in which the others appear.
//!
//! tau = Y phi. The columns of Y that depend linearly on others, as functions of the state, add nothing: with
//! Y_d = Y_b K the torque is Y_b (phi_b + K phi_d), and the entries of phi_b + K phi_d are the base parameters
//! (Gautier and Khalil 1990). The rank and the choice of columns are found in the prime field from random states, where a state more never
//! changes the answer but for odds of 1/p; each row of K is then solved for exactly, over the exact constants, from rational states.

use super::arm::{Arm, Rest};
use super::newton_euler::Motion;
use super::parameters::{Entry, ParameterKind, ParameterVector, StandardParameter, View};
use super::regressor::{columns_in_joint_frames, derivative_by_parameter, regressor};
use crate::exact::Number;
use crate::manipulator::{JointKind, Manipulator};
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

/// So many states with small numbers are tried first.
const SIMPLE_STATES: u64 = 24;

/// The dependence among the columns of `y`, `y[joint][column]`, taken in order: a column is kept unless those before it span it.
pub fn dependence(pool: &Pool, y: &[Vec<ExprId>]) -> Dependence {
    let columns = y.first().map_or(0, Vec::len);
    let (pivots, reduced) = stacked_echelon(pool, y);
    let mut dependent = Vec::new();
    for column in (0..columns).filter(|c| !pivots.contains(c)) {
        let support: Vec<usize> =
            pivots.iter().enumerate().filter(|&(row, _)| reduced[row][column] != pool.field().zero()).map(|(_, &p)| p).collect();
        let coefficients = exact_combination(pool, y, column, &support);
        dependent.push((column, support.into_iter().zip(coefficients).collect()));
    }
    Dependence { independent: pivots, dependent }
}

/// How many parameters a motion can tell apart: the rank of Y stacked over many states.
pub fn rank(pool: &Pool, y: &[Vec<ExprId>]) -> usize {
    stacked_echelon(pool, y).0.len()
}

/// The reduced row echelon form of Y stacked over enough states of the field.
fn stacked_echelon(pool: &Pool, y: &[Vec<ExprId>]) -> (Vec<usize>, Vec<Vec<Element>>) {
    let columns = y.first().map_or(0, Vec::len);
    let states = columns / y.len().max(1) + 4;
    let matrix = (0..states as u64).flat_map(|state| field_values(pool, y, state)).collect();
    echelon(pool.field(), matrix, columns)
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
    // Quotients of general constants may be zero without looking it: the field knows.
    let mut field = pool.field().clone();
    let mut settle = |x: Number| if field.number(&x) == field.zero() { Number::zero() } else { x };
    for state in 0.. {
        // Simple states keep the numbers small; if they do not tell the columns apart, general ones do.
        let of: Box<dyn Fn(Symbol) -> Number> =
            if state < SIMPLE_STATES { Box::new(Pool::simple_state(state)) } else { Box::new(Pool::rational_state(state)) };
        for row in y {
            let exprs: Vec<ExprId> = support.iter().chain([&column]).map(|&c| row[c]).collect();
            let mut equation = pool.evaluate(&exprs, &of).expect("a regressor has no reciprocals");
            for (known, &pivot) in system.iter().zip(&pivots) {
                let factor = equation[pivot].clone();
                if !factor.is_zero() {
                    for (x, p) in equation.iter_mut().zip(known) {
                        *x = settle(&*x - &(&factor * p));
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
                        *x = settle(&*x - &(&factor * p));
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
///
/// What no joint feels is first grouped towards the base in joint frames, exactly and without a division. What still depends on others
/// then, because a motion near the base is restricted or a rotor turns with a link, is found by rank.
pub fn base_parameters(manipulator: &Manipulator, field: &Field) -> ParameterVector {
    let mut pool = Pool::new(field.clone());
    let standard = ParameterVector::standard(manipulator);
    let mut arm = Arm::new(&mut pool, manipulator, View::Vector(&standard));
    arm.group_towards_base(&mut pool, Rest::NoInertiaAboutY);
    let mut columns = candidates(manipulator);
    columns.sort_by_key(|&column| preference(column));
    let values: Vec<Vec<Number>> = columns.iter().map(|&c| combination(&mut pool, &arm, &standard, c)).collect();

    let motion = Motion::with_reference(&mut pool, &arm);
    let y = columns_in_joint_frames(&mut pool, &arm, &motion, &columns);
    let dependence = dependence(&pool, &y);
    let mut base: Vec<(StandardParameter, Entry)> = dependence
        .independent
        .iter()
        .map(|&column| {
            let mut total = values[column].clone();
            for (other, combination) in &dependence.dependent {
                for (_, k) in combination.iter().filter(|(c, _)| *c == column) {
                    for (sum, value) in total.iter_mut().zip(&values[*other]) {
                        *sum = &*sum + &(k * value);
                    }
                }
            }
            (columns[column], entry(columns[column], &standard, &total))
        })
        .collect();
    base.sort_by_key(|(parameter, _)| *parameter);
    let (kept, entries) = base.into_iter().unzip();
    ParameterVector { entries, kind: ParameterKind::Base(kept) }
}

/// What can be left after grouping: links without m, mcz and Iyy (revolute) or without inertia (prismatic), rotors, friction.
fn candidates(manipulator: &Manipulator) -> Vec<StandardParameter> {
    StandardParameter::all(manipulator)
        .into_iter()
        .filter(|&parameter| match parameter {
            StandardParameter::Link(i, k) if manipulator.joints[usize::from(i)].kind == JointKind::Revolute => {
                ![0, 3, 6].contains(&k)
            }
            StandardParameter::Link(_, k) => k < 4,
            StandardParameter::Payload(_) => false,
            _ => true,
        })
        .collect()
}

/// A parameter of the grouped arm as coefficients of the standard parameters.
fn combination(pool: &mut Pool, arm: &Arm, standard: &ParameterVector, parameter: StandardParameter) -> Vec<Number> {
    let expr = match parameter {
        StandardParameter::Link(i, k) => {
            let body = &arm.joints[usize::from(i)].body;
            let [xx, xy, yy, xz, yz, zz] = body.second;
            match k {
                0 => body.mass,
                1..=3 => body.first[usize::from(k) - 1],
                4 => pool.add(yy, zz),
                5 => -xy,
                6 => pool.add(xx, zz),
                7 => -xz,
                8 => -yz,
                _ => pool.add(xx, yy),
            }
        }
        _ => {
            let column = standard.position(parameter).expect("all that is not a link's is itself a standard parameter");
            pool.symbol(Symbol::Parameter(column as u16))
        }
    };
    // A rotor's column holds all that its inertia does, its turning with the parent link included: that part of the body is not the link's.
    let of_rotor = |k: u16| matches!(&standard.kind, ParameterKind::Standard(all) if matches!(all[usize::from(k)], StandardParameter::RotorInertia(_)));
    let of_link = matches!(parameter, StandardParameter::Link(..));
    (0..standard.len() as u16)
        .map(|k| {
            if of_link && of_rotor(k) {
                return Number::zero();
            }
            let derivative = derivative_by_parameter(pool, &[expr], k)[0];
            pool.as_constant(derivative).expect("grouping is linear in the parameters")
        })
        .collect()
}

/// A base parameter: named after the standard parameter that it is, or with an R where others are regrouped into it.
fn entry(parameter: StandardParameter, standard: &ParameterVector, coefficients: &[Number]) -> Entry {
    let mut nominal = Number::zero();
    let mut meaning = String::new();
    let mut name = format!("{}R", parameter.name());
    let parts: Vec<(&Entry, &Number)> = standard.entries.iter().zip(coefficients).filter(|(_, k)| !k.is_zero()).collect();
    for (entry, k) in &parts {
        nominal = &nominal + &(*k * &entry.nominal);
        let negative = k.leads_negative();
        let size = if negative { -*k } else { (*k).clone() };
        meaning += match (meaning.is_empty(), negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        meaning += &match (size.is_one(), size.terms().count()) {
            (true, _) => entry.name.clone(),
            (false, 1) => format!("{size}*{}", entry.name),
            (false, _) => format!("({size})*{}", entry.name),
        };
    }
    if let [(entry, k)] = parts[..] {
        if k.is_one() {
            name = entry.name.clone();
            meaning = entry.meaning.clone();
        }
    }
    Entry { name, nominal, meaning }
}

/// Columns are kept in this order: friction, then links from the base outwards; within a link inertia about the axis first. Rotors are told
/// apart from links only where nothing else can carry their effect.
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
