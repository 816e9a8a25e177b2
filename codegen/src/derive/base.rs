//! The minimal parameter set: which parameters a motion can tell apart, and the exact combinations in which the others appear.
//!
//! tau = Y phi. The columns of Y that depend linearly on others, as functions of the state, add nothing: with
//! Y_d = Y_b K the torque is Y_b (phi_b + K phi_d), and the entries of phi_b + K phi_d are the base parameters
//! (Gautier and Khalil 1990). The rank and the choice of columns are found in the prime field from random states, where a state more never
//! changes the answer but for odds of 1/p; each row of K is then solved for exactly, over the exact constants, from rational states.
//! Friction is grouped with nothing else, so that gravity and friction keep their own parameters.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use super::arm::{Arm, GroupingConvention};
use super::motion::Motion;
use super::parameters::{Inertial, Parameter, ParameterKind, ParameterVector, StandardParameter, View};
use super::passes::rotate_last_link;
use super::plan::Plan;
use super::regressor::{columns_in_joint_frames, derivative_by_parameter, regressor};
use crate::exact::{Number, Rational};
use crate::kinds::JointKind;
use crate::manipulator::Manipulator;
use crate::ring::field::{Element, Field};
use crate::ring::matrix::{IDENTITY, ZERO};
use crate::ring::{ExprId, Node, Pool, Symbol};
use armgen_algebra::scramble::scramble;

/// The columns of a regressor, sorted into those that are independent and the rest.
#[derive(Clone, Debug)]
pub struct Dependence {
    /// Columns whose parameters are kept, ascending.
    pub independent: Vec<usize>,
    /// Each other column as a combination of independent ones: (column, [(independent column, coefficient)]), empty for a zero column.
    pub dependent: Vec<(usize, Vec<(usize, Number)>)>,
    /// Columns that are combinations, too, and of which ones: the coefficients would be too long.
    pub too_long: Vec<(usize, Vec<usize>)>,
}

/// Number of states with small numbers that are tried first.
const SIMPLE_STATES: usize = 24;

/// The dependence among the columns of `y`, `y[joint][column]`, taken in order: a column is kept unless those before it span it.
pub fn dependence(pool: &Pool, y: &[Vec<ExprId>]) -> Dependence {
    dependence_within(MOST_PRODUCTS, pool, y)
}

/// The same within so many products.
pub(super) fn dependence_within(most: usize, pool: &Pool, y: &[Vec<ExprId>]) -> Dependence {
    let columns = y.first().map_or(0, Vec::len);
    let (pivots, reduced) = stacked_echelon(pool, y);
    let wanted: Vec<(usize, Vec<usize>)> = (0..columns)
        .filter(|column| !pivots.contains(column))
        .map(|column| {
            let in_row = |row: usize| reduced[row][column] != pool.field().zero();
            (column, pivots.iter().enumerate().filter(|&(row, _)| in_row(row)).map(|(_, &pivot)| pivot).collect())
        })
        .collect();
    let needed = wanted
        .iter()
        .filter(|(_, support)| !support.is_empty())
        .flat_map(|(column, support)| [&[*column], &support[..]].concat());
    let needed: BTreeSet<usize> = needed.collect();
    let mut exact = Exact { field: pool.field().clone(), left: most };
    let mut states = [false, true].map(|related| ExactStates::new(pool, y, &needed, related));
    let mut found = Dependence { independent: pivots, dependent: Vec::new(), too_long: Vec::new() };
    for (column, support) in wanted {
        // One is enough to leave all out: the rest would take its time, too.
        if !found.too_long.is_empty() {
            found.too_long.push((column, support));
            continue;
        }
        match exact_combination(&mut exact, &mut states, column, &support) {
            Ok(Some(coefficients)) => found.dependent.push((column, support.into_iter().zip(coefficients).collect())),
            Ok(None) => found.independent.push(column),
            Err(TooLong) => found.too_long.push((column, support)),
        }
    }
    found.independent.sort_unstable();
    found
}

/// How many parameters a motion can tell apart: the rank of Y stacked over many states.
pub fn rank(pool: &Pool, y: &[Vec<ExprId>]) -> usize {
    stacked_echelon(pool, y).0.len()
}

/// The reduced row echelon form of Y stacked over states of the field, until one more adds no row: a generic state then adds none.
fn stacked_echelon(pool: &Pool, y: &[Vec<ExprId>]) -> (Vec<usize>, Vec<Vec<Element>>) {
    let columns = y.first().map_or(0, Vec::len);
    let (mut pivots, mut reduced) = (Vec::new(), Vec::new());
    for state in 0.. {
        let rank = pivots.len();
        reduced.extend(field_values(pool, y, state));
        (pivots, reduced) = echelon(pool.field(), reduced, columns);
        reduced.truncate(pivots.len());
        if pivots.len() == rank {
            break;
        }
    }
    (pivots, reduced)
}

/// Values of Y at a state of the field, row by row.
fn field_values(pool: &Pool, y: &[Vec<ExprId>], state: u64) -> Vec<Vec<Element>> {
    let field = pool.field();
    let draw = |symbol: Symbol| {
        let (kind, index) = match symbol {
            Symbol::Sine(i) | Symbol::Cosine(i) => (1, i),
            Symbol::SineOf(_) | Symbol::CosineOf(_) => (1, symbol.index()),
            Symbol::Position(i) => (2, i),
            Symbol::Rate(i) => (3, i),
            Symbol::OfRate(of, i) => (of.kind(), i),
            Symbol::Acceleration(i) => (5, i),
            Symbol::ReferenceRate(i) => (6, i),
            Symbol::ReferenceAcceleration(i) => (7, i),
            Symbol::Torque(i) => (8, i),
            Symbol::Parameter(i) => (9, i),
            Symbol::GravitySize(i) => (11, i),
            Symbol::GravitySign(i) => (12, i),
            Symbol::Gravity(i) => (13, i),
        };
        field.from_u64(scramble(scramble(state << 8 | kind) ^ u64::from(index)))
    };
    let point = |i: u16| field.point(i, |unit| draw(Symbol::Sine(unit)));
    let mut values: Vec<Element> = Vec::with_capacity(pool.len());
    for index in 0..pool.len() {
        let of = |e: ExprId| if e.is_negated() { field.neg(values[e.index()]) } else { values[e.index()] };
        let expr = pool.expr(index);
        values.push(match pool.node(expr) {
            Node::Constant(_) => pool.fingerprint(expr)[0],
            Node::Symbol(Symbol::Sine(i)) => point(i).0,
            Node::Symbol(Symbol::Cosine(i)) => point(i).1,
            Node::Symbol(Symbol::SineOf(sum)) => field.circle_of(sum, point).0,
            Node::Symbol(Symbol::CosineOf(sum)) => field.circle_of(sum, point).1,
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

/// Most products of numbers that have no one form, as those of sines of general angles, in the combinations of an arm.
const MOST_PRODUCTS: usize = 20_000;

/// The combinations of an arm take more than [`MOST_PRODUCTS`].
struct TooLong;

/// Exact arithmetic, of which the long part is counted.
struct Exact {
    field: Field,
    /// How many products are left.
    left: usize,
}

impl Exact {
    fn times(&mut self, a: &Number, b: &Number) -> Result<Number, TooLong> {
        self.count(a, b)?;
        Ok(a.times(b))
    }

    /// Counts a product; those of reduced numbers, which stay short, are free.
    fn count(&mut self, a: &Number, b: &Number) -> Result<(), TooLong> {
        let counted = usize::from(!a.is_reduced() || !b.is_reduced());
        self.left = self.left.checked_sub(counted).ok_or(TooLong)?;
        Ok(())
    }
}

/// The exact coefficients of Y_column = Σ k_s Y_s over the support: from as many equations as unknowns, those with the smallest numbers. `None`
/// where exact states do not have the relations between computed angles that the column depends by.
fn exact_combination(
    exact: &mut Exact,
    [plain, related]: &mut [ExactStates<'_>; 2],
    column: usize,
    support: &[usize],
) -> Result<Option<Vec<Number>>, TooLong> {
    if support.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let found = combination_at(exact, plain, column, support)?;
    if plain.pool.field().computed().is_none() {
        return Ok(found);
    }
    if found.as_ref().is_some_and(|found| plain.is_combination(&mut exact.field, (column, support), found)) {
        return Ok(found);
    }
    let found = combination_at(exact, related, column, support)?;
    Ok(found.filter(|found| related.is_combination(&mut exact.field, (column, support), found)))
}

/// Exact values of Y at states with numbers as small as possible, each state evaluated once for all columns.
struct ExactStates<'a> {
    pool: &'a Pool,
    y: &'a [Vec<ExprId>],
    /// The entries of the columns that are needed, row by row, and the place of each of these columns.
    entries: Vec<ExprId>,
    places: BTreeMap<usize, usize>,
    /// Whether the states have the relations between computed angles.
    related: bool,
    values: Vec<Vec<Number>>,
}

impl<'a> ExactStates<'a> {
    fn new(pool: &'a Pool, y: &'a [Vec<ExprId>], columns: &BTreeSet<usize>, related: bool) -> Self {
        let entries = y.iter().flat_map(|row| columns.iter().map(|&column| row[column])).collect();
        let places = columns.iter().copied().zip(0..).collect();
        ExactStates { pool, y, entries, places, related, values: Vec::new() }
    }

    /// The values of these columns at a state, row by row.
    fn rows(&mut self, state: usize, columns: &[usize]) -> Vec<Vec<Number>> {
        while self.values.len() <= state {
            let values = self.evaluated(self.values.len());
            self.values.push(values);
        }
        let rows = self.values[state].chunks(self.places.len());
        rows.map(|row| columns.iter().map(|column| row[self.places[column]].clone()).collect()).collect()
    }

    fn evaluated(&self, state: usize) -> Vec<Number> {
        let of: Box<dyn Fn(Symbol) -> Number> = match state.checked_sub(SIMPLE_STATES) {
            None => Box::new(Pool::simple_state(state as u64)),
            Some(state) => Box::new(Pool::rational_state(state as u64)),
        };
        let values = if self.related {
            self.pool.evaluate(&self.entries, &self.pool.related_state(of))
        } else {
            self.pool.evaluate(&self.entries, &of)
        };
        values.expect("a regressor has no reciprocals")
    }

    /// Whether a column of Y is the combination of others, at the points of the field.
    fn is_combination(&self, field: &mut Field, (column, support): (usize, &[usize]), coefficients: &[Number]) -> bool {
        let coefficients: Vec<Element> = coefficients.iter().map(|number| field.number(number)).collect();
        self.y.iter().all(|row| {
            (0..2).all(|point| {
                let value = |column: usize| self.pool.fingerprint(row[column])[point];
                let terms = support.iter().zip(&coefficients).map(|(&c, &k)| field.mul(k, value(c)));
                terms.fold(field.zero(), |sum, term| field.add(sum, term)) == value(column)
            })
        })
    }
}

/// The coefficients that these states give; `None` where they show that the column is no such combination.
fn combination_at(
    exact: &mut Exact,
    states: &mut ExactStates<'_>,
    column: usize,
    support: &[usize],
) -> Result<Option<Vec<Number>>, TooLong> {
    let columns = [support, &[column]].concat();
    let mut equations: Vec<Vec<Number>> = Vec::new();
    let (mut seen, mut wanted) = (0, SIMPLE_STATES);
    loop {
        for state in seen..wanted {
            let rows = states.rows(state, &columns).into_iter();
            equations.extend(rows.filter(|equation| equation.iter().any(|x| !x.is_zero())));
        }
        equations.sort_by_cached_key(|equation| (equation.iter().map(|x| x.terms().count()).sum::<usize>(), equation.clone()));
        equations.dedup();
        let values: Vec<Vec<Element>> =
            (0..columns.len()).map(|k| equations.iter().map(|e| exact.field.number(&e[k])).collect()).collect();
        // Independent equations are the pivots among the columns of the transposed system.
        let (independent, _) = echelon(&exact.field, values, equations.len());
        match independent.len().cmp(&support.len()) {
            Ordering::Less => (seen, wanted) = (wanted, wanted + columns.len()),
            Ordering::Equal => {
                let system: Vec<Vec<Number>> = independent.into_iter().map(|e| equations[e].clone()).collect();
                return solve(exact, system).map(Some);
            }
            Ordering::Greater => return Ok(None),
        }
    }
}

/// The solution of a regular system, the right-hand sides last in each row.
///
/// First unknowns are eliminated by entries that have a short inverse, fractions before others, those that change fewest entries first;
/// quotients of general constants are left to the few equations that then remain.
fn solve(exact: &mut Exact, mut system: Vec<Vec<Number>>) -> Result<Vec<Number>, TooLong> {
    let n = system.len();
    for entry in system.iter_mut().flatten() {
        *entry = zero_if_zero(&mut exact.field, std::mem::take(entry));
    }
    let (mut rows, mut unknowns): (Vec<usize>, Vec<usize>) = ((0..n).collect(), (0..n).collect());
    let mut eliminated = Vec::new();
    while let Some((row, unknown)) = simplest_pivot(&system, &rows, &unknowns) {
        rows.retain(|&r| r != row);
        unknowns.retain(|&c| c != unknown);
        let scale = Divisor::new(&system[row][unknown]);
        for &c in unknowns.iter().chain([&n]) {
            system[row][c] = scale.divide(exact, &system[row][c])?;
        }
        let pivot = system[row].clone();
        for &r in &rows {
            let factor = system[r][unknown].clone();
            if !factor.is_zero() {
                for &c in unknowns.iter().chain([&n]).filter(|&&c| !pivot[c].is_zero()) {
                    let difference = system[r][c].minus(&exact.times(&factor, &pivot[c])?);
                    system[r][c] = zero_if_zero(&mut exact.field, difference);
                }
            }
        }
        eliminated.push((row, unknown, unknowns.clone()));
    }
    let rest = rows.iter().map(|&r| unknowns.iter().chain([&n]).map(|&c| system[r][c].clone()).collect()).collect();
    let mut solution = vec![Number::zero(); n];
    for (&unknown, value) in unknowns.iter().zip(solve_general(exact, rest)?) {
        solution[unknown] = value;
    }
    for (row, unknown, others) in eliminated.into_iter().rev() {
        let mut value = system[row][n].clone();
        for c in others {
            if !system[row][c].is_zero() && !solution[c].is_zero() {
                value = value.minus(&exact.times(&system[row][c], &solution[c])?);
            }
        }
        let value = zero_if_zero(&mut exact.field, value);
        solution[unknown] = as_fraction(&mut exact.field, value);
    }
    Ok(solution)
}

/// Row and unknown of the entry to eliminate by next; `None` if there is no simple one.
fn simplest_pivot(system: &[Vec<Number>], rows: &[usize], unknowns: &[usize]) -> Option<(usize, usize)> {
    let others_in_row = |r: usize| unknowns.iter().filter(|&&c| !system[r][c].is_zero()).count() - 1;
    let others_in_column = |c: usize| rows.iter().filter(|&&r| !system[r][c].is_zero()).count() - 1;
    let entries = rows.iter().flat_map(|&r| unknowns.iter().map(move |&c| (r, c)));
    let simple = entries.filter_map(|(r, c)| {
        let entry = &system[r][c];
        let kind = match entry.terms().count() {
            0 => return None,
            1 => usize::from(entry.as_rational().is_none()),
            terms if entry.is_reduced() => terms,
            _ => return None,
        };
        Some((kind, others_in_row(r) * others_in_column(c), r, c))
    });
    simple.min().map(|(_, _, r, c)| (r, c))
}

/// The number, or an exact 0 where the field shows that an unreduced number is 0.
fn zero_if_zero(field: &mut Field, number: Number) -> Number {
    if !number.is_reduced() && field.number(&number) == field.zero() {
        Number::zero()
    } else {
        number
    }
}

/// The solution of a regular system of general constants.
fn solve_general(exact: &mut Exact, mut system: Vec<Vec<Number>>) -> Result<Vec<Number>, TooLong> {
    let n = system.len();
    if n <= LARGEST_BY_MINORS {
        // By Cramer's rule: no quotient before the last step.
        let determinant = Divisor::new(&minors(exact, &system, &(0..n).collect::<Vec<_>>())?);
        return (0..n)
            .map(|k| {
                let columns: Vec<usize> = (0..n).map(|c| if c == k { n } else { c }).collect();
                let minor = minors(exact, &system, &columns)?;
                determinant.divide(exact, &minor)
            })
            .collect();
    }
    for k in 0..n {
        let pivot = (k..n).find(|&r| !system[r][k].is_zero()).expect("the system is regular");
        system.swap(k, pivot);
        let scale = Divisor::new(&system[k][k]);
        let row: Vec<Number> = system[k].iter().map(|x| scale.divide(exact, x)).collect::<Result<_, _>>()?;
        for (r, other) in system.iter_mut().enumerate() {
            let factor = other[k].clone();
            if r != k && !factor.is_zero() {
                for (x, p) in other.iter_mut().zip(&row) {
                    let product = exact.times(&factor, p)?;
                    *x = zero_if_zero(&mut exact.field, x.minus(&product));
                }
            }
        }
        system[k] = row;
    }
    Ok(system.into_iter().map(|mut row| row.pop().expect("the right-hand side")).collect())
}

/// Systems up to this size over general constants are solved by minors.
const LARGEST_BY_MINORS: usize = 8;

/// The determinant of chosen columns, by expansion along rows over sets of columns, each set once.
fn minors(exact: &mut Exact, system: &[Vec<Number>], columns: &[usize]) -> Result<Number, TooLong> {
    let n = columns.len();
    let mut of_set: Vec<Number> = vec![Number::zero(); 1 << n];
    of_set[0] = Number::one();
    for set in 1usize..1 << n {
        let row = set.count_ones() as usize - 1;
        let mut sum = Number::zero();
        for (place, (k, &column)) in columns.iter().enumerate().filter(|(k, _)| set >> k & 1 == 1).enumerate() {
            let entry = &system[row][column];
            if !entry.is_zero() {
                let term = exact.times(entry, &of_set[set & !(1 << k)])?;
                sum = if (row + place).is_multiple_of(2) { sum.plus(&term) } else { sum.minus(&term) };
            }
        }
        of_set[set] = sum;
    }
    Ok(of_set.pop().expect("the full set"))
}

/// A divisor, inverted once for all that it divides.
struct Divisor {
    inverse: Number,
    is_one_term: bool,
}

impl Divisor {
    fn new(number: &Number) -> Divisor {
        let inverse = number.inverse().expect("the divisor is not zero");
        Divisor { inverse, is_one_term: number.terms().count() == 1 }
    }

    /// The quotient; as a fraction if the value is a fraction, however both are written.
    fn divide(&self, exact: &mut Exact, number: &Number) -> Result<Number, TooLong> {
        exact.count(number, &self.inverse)?;
        let value = number * &self.inverse;
        if value.terms().count() == 1 && self.is_one_term {
            return Ok(value);
        }
        Ok(as_fraction(&mut exact.field, value))
    }
}

/// The number, as a fraction where it is a short one however it is written.
fn as_fraction(field: &mut Field, value: Number) -> Number {
    if value.is_reduced() {
        return value;
    }
    // A short continued fraction that the field and an enclosure confirm.
    let (low, high) = value.enclose(320);
    let fraction = Number::from(Rational::simplest_in(low, high));
    let same = field.number(&fraction) == field.number(&value);
    if same && fraction.to_string().len() < 60 {
        fraction
    } else {
        value
    }
}

/// The regressor of a parameter vector, in a pool of its own.
pub fn regressor_of(manipulator: &Manipulator, field: &Field, vector: &ParameterVector) -> (Pool, Vec<Vec<ExprId>>) {
    let mut pool = Pool::new(field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Vector(vector));
    let y = regressor(&mut pool, &arm, vector);
    in_coordinates(pool, &arm, y)
}

/// Moves the origin of each joint frame to the foot of the common normal with the axis before, so that most lever arms vanish, and rotates the
/// axes of the last link towards its centre of mass, where its first moment has one component. The base parameters of `base_regressor` are
/// those in these frames.
pub fn place_frames_for_base_parameters(pool: &mut Pool, arm: &mut Arm) {
    for i in (0..arm.dof()).filter(|&i| arm.joints[i].parent.is_some() && arm.joints[i].is_revolute()).collect::<Vec<_>>() {
        let axis = arm.joints[i].fixed.map(|row| row[2]);
        let along = pool.dot3(&arm.joints[i].origin, &axis);
        if along != ExprId::ZERO && pool.is_constant(along) {
            arm.slide(pool, i, -along);
        }
    }
    rotate_last_link(pool, arm);
    for joint in &mut arm.joints {
        (joint.own_origin, joint.own_axes) = (ZERO, IDENTITY);
    }
}

/// Y_b(q, dq, ddq): tau is Y_b times the base parameters, links, rotors and friction; of an arm whose frames have been placed for base parameters.
pub fn base_regressor(pool: &mut Pool, arm: &Arm, vector: &ParameterVector, plan: &mut Plan) -> Vec<Vec<ExprId>> {
    let ParameterKind::Base(columns) = &vector.kind else { unreachable!("asked for base parameters only") };
    let motion = Motion::plain(pool, arm);
    columns_in_joint_frames(pool, arm, &motion, columns, plan)
}

/// The base parameters of an arm.
///
/// Parameters that no joint feels are first grouped towards the base in joint frames, exactly and without a division. The rank
/// then shows the remaining dependences, where a motion near the base is restricted or a rotor turns with a link.
///
/// `None` where the exact combinations are too long to be formed, here and for the others.
pub fn base_parameters(manipulator: &Manipulator, field: &Field) -> Option<ParameterVector> {
    base_combinations(manipulator, field).map(|(vector, _)| vector)
}

/// The base parameters of `base_regressor`: those that are not zero, with the masses of its rotors among the values, so that Y pi is the
/// whole torque. Links keep no second moment along their axes, because the moment of a point mass on the x or y axis has two components
/// only.
pub fn base_parameters_with_rotors(manipulator: &Manipulator, field: &Field) -> Option<ParameterVector> {
    let (ParameterVector { entries, kind }, _) = combined(manipulator, field, GroupingConvention::NoSecondMomentAlongAxis, true)?;
    let ParameterKind::Base(columns) = kind else { unreachable!("base parameters are grouped") };
    let used = entries.into_iter().zip(columns).filter(|(entry, _)| !entry.nominal.is_zero());
    let (entries, columns) = used.unzip();
    Some(ParameterVector { entries, kind: ParameterKind::Base(columns) })
}

/// The base parameters of [`base_parameters`], and each as coefficients of the standard parameters.
pub fn base_combinations(manipulator: &Manipulator, field: &Field) -> Option<(ParameterVector, Vec<Vec<Number>>)> {
    combined(manipulator, field, GroupingConvention::NoInertiaAboutY, false)
}

/// The base parameters, and each as coefficients of the standard parameters and, last, its constant part. `own`: the masses of rotors are part of
/// the links' values, for `base_regressor`; otherwise they are known.
fn combined(
    manipulator: &Manipulator,
    field: &Field,
    convention: GroupingConvention,
    own: bool,
) -> Option<(ParameterVector, Vec<Vec<Number>>)> {
    let mut pool = Pool::new(field.clone());
    let standard = ParameterVector::standard(manipulator);
    let mut arm = Arm::new(&mut pool, manipulator, View::Vector(&standard));
    if own {
        place_frames_for_base_parameters(&mut pool, &mut arm);
    }
    arm.group_towards_base(&mut pool, convention);
    let mut columns = candidates(manipulator, convention);
    columns.sort_by_key(|&column| preference(column));
    let mut values: Vec<Vec<Number>> = columns.iter().map(|&c| combination(&mut pool, &arm, &standard, c)).collect();
    if !own {
        values.iter_mut().for_each(|of| *of.last_mut().expect("the rest stands last") = Number::zero());
    }

    let motion = Motion::with_reference(&mut pool, &arm);
    let mut y = columns_in_joint_frames(&mut pool, &arm, &motion, &columns, &mut Plan::default());
    if !own {
        y = with_friction_apart(&y, &columns);
    }
    let (pool, y) = in_coordinates(pool, &arm, y);
    let dependence = dependence(&pool, &y);
    if !dependence.too_long.is_empty() {
        return None;
    }
    let mut base: Vec<(StandardParameter, Parameter, Vec<Number>)> = dependence
        .independent
        .iter()
        .map(|&column| {
            let mut total = values[column].clone();
            for (other, combination) in &dependence.dependent {
                for (_, k) in combination.iter().filter(|(c, _)| *c == column) {
                    for (sum, value) in total.iter_mut().zip(&values[*other]) {
                        *sum = sum.plus(&k.times(value));
                    }
                }
            }
            (columns[column], entry(columns[column], &standard, &total), total)
        })
        .collect();
    base.sort_by_key(|(parameter, ..)| *parameter);
    let combinations = base.iter().map(|(.., total)| total.clone()).collect();
    let (kept, entries) = base.into_iter().map(|(parameter, entry, _)| (parameter, entry)).unzip();
    Some((ParameterVector { entries, kind: ParameterKind::Base(kept) }, combinations))
}

/// The rows of a regressor, or several blocks of them, in coordinates: S' Y.
fn in_coordinates(mut pool: Pool, arm: &Arm, y: Vec<Vec<ExprId>>) -> (Pool, Vec<Vec<ExprId>>) {
    if arm.coupling.is_none() {
        return (pool, y);
    }
    let columns = y.first().map_or(0, Vec::len);
    let mut rows = Vec::new();
    for block in y.chunks(arm.dof()) {
        let projected: Vec<Vec<ExprId>> =
            (0..columns).map(|c| arm.project(&mut pool, block.iter().map(|row| row[c]).collect())).collect();
        rows.extend((0..arm.coordinates()).map(|a| projected.iter().map(|column| column[a]).collect::<Vec<ExprId>>()));
    }
    let (pool, entries) = arm.in_coordinates(pool, rows.concat());
    (pool, entries.chunks(columns.max(1)).map(<[ExprId]>::to_vec).collect())
}

/// The rows of friction below the rows of all other torques.
///
/// Gravity may act along a prismatic joint. Then the torque of a mass minus the torque of an armature is constant, as is an
/// offset of friction. A motion cannot distinguish the three, but friction must not hold part of the weight: `gravity_with` and
/// `friction_with` take them one by one.
fn with_friction_apart(y: &[Vec<ExprId>], columns: &[StandardParameter]) -> Vec<Vec<ExprId>> {
    let rows = |friction: bool| {
        y.iter().map(move |row| {
            let kept = row
                .iter()
                .zip(columns)
                .map(|(&entry, column)| if column.is_friction() == friction { entry } else { ExprId::ZERO });
            kept.collect()
        })
    };
    rows(false).chain(rows(true)).collect()
}

/// What can be left after grouping: links without m, mcz and Iyy or the second moment along the axis (revolute) or without inertia
/// (prismatic), rotors, friction.
fn candidates(manipulator: &Manipulator, convention: GroupingConvention) -> Vec<StandardParameter> {
    let left = |parameter: StandardParameter| match (convention, parameter) {
        (GroupingConvention::NoSecondMomentAlongAxis, StandardParameter::Link(i, Inertial::Ixx)) => {
            StandardParameter::Link(i, Inertial::PlanarIxx)
        }
        (GroupingConvention::NoSecondMomentAlongAxis, StandardParameter::Link(i, Inertial::Izz)) => {
            StandardParameter::Link(i, Inertial::PlanarIyy)
        }
        _ => parameter,
    };
    StandardParameter::all(manipulator)
        .into_iter()
        .filter(|&parameter| match parameter {
            StandardParameter::Link(i, k) if manipulator.joints[usize::from(i)].kind == JointKind::Revolute => {
                ![Inertial::M, Inertial::Mcz, Inertial::Iyy].contains(&k)
            }
            StandardParameter::Link(_, k) => k <= Inertial::Mcz,
            StandardParameter::Payload(..) => false,
            _ => true,
        })
        .map(left)
        .collect()
}

/// A parameter of the grouped arm as coefficients of the standard parameters, and last its constant part.
fn combination(pool: &mut Pool, arm: &Arm, standard: &ParameterVector, parameter: StandardParameter) -> Vec<Number> {
    let expr = match parameter {
        StandardParameter::Link(i, k) => {
            let body = &arm.joints[usize::from(i)].body;
            let [xx, xy, yy, xz, yz, zz] = body.second;
            match k {
                Inertial::M => body.mass,
                Inertial::Mcx => body.first[0],
                Inertial::Mcy => body.first[1],
                Inertial::Mcz => body.first[2],
                Inertial::Ixx => pool.add(yy, zz),
                Inertial::Ixy => -xy,
                Inertial::Iyy => pool.add(xx, zz),
                Inertial::Ixz => -xz,
                Inertial::Iyz => -yz,
                Inertial::Izz => pool.add(xx, yy),
                Inertial::PlanarIxx => yy,
                Inertial::PlanarIyy => xx,
            }
        }
        _ => {
            let column = standard.position(parameter).expect("all that is not a link's is itself a standard parameter");
            pool.symbol(Symbol::Parameter(column as u16))
        }
    };
    // Linear in the parameters and without joint angles: no symbol is left, though a product of nested roots may.
    let value = |pool: &Pool, expr: ExprId| {
        pool.as_constant(expr).unwrap_or_else(|| {
            let values = pool.evaluate(&[expr], &|_| Number::zero()).expect("grouping has no reciprocals");
            values.into_iter().next().expect("one for each")
        })
    };
    // A rotor's column holds all that its inertia does, its turning with the parent link included: that part of the body is not the link's.
    let of_rotor = |k: u16| matches!(&standard.kind, ParameterKind::Standard(all) if matches!(all[usize::from(k)], StandardParameter::RotorInertia(_)));
    let of_link = matches!(parameter, StandardParameter::Link(..));
    let mut coefficients: Vec<Number> = (0..standard.len() as u16)
        .map(|k| {
            if of_link && of_rotor(k) {
                return Number::zero();
            }
            let derivative = derivative_by_parameter(pool, &[expr], k)[0];
            value(pool, derivative)
        })
        .collect();
    let mut without = Pool::new(pool.field().clone());
    let rest = pool.substitute_into(&mut without, &[expr], &|_, _| ExprId::ZERO)[0];
    coefficients.push(value(&without, rest));
    coefficients
}

/// Longer factors are shown by the nearest float.
const LONGEST_FACTOR: usize = 60;

/// A number for people: exact if it is short.
fn shown(number: &Number) -> String {
    let exact = if number.is_readable() { number.to_string() } else { String::new() };
    if exact.is_empty() || exact.len() > LONGEST_FACTOR {
        format!("{:?}", number.to_f64())
    } else {
        exact
    }
}

/// A base parameter. It has the name of its standard parameter, with an R if it belongs to the joint frame or contains regrouped
/// parameters.
fn entry(parameter: StandardParameter, standard: &ParameterVector, coefficients: &[Number]) -> Parameter {
    let mut nominal = Number::zero();
    let mut meaning = String::new();
    let mut name = format!("{}R", parameter.name());
    let parts: Vec<(&Parameter, &Number)> = standard.entries.iter().zip(coefficients).filter(|(_, k)| !k.is_zero()).collect();
    for (entry, k) in &parts {
        nominal = nominal.plus(&k.times(&entry.nominal));
        let negative = if k.is_shared() { k.is_negative() } else { k.leads_negative() };
        let size = if negative { -*k } else { (*k).clone() };
        let factor = shown(&size);
        meaning += match (meaning.is_empty(), negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        meaning += &match (size.is_one(), size.terms().count()) {
            (true, _) => entry.name.clone(),
            (false, 1) => format!("{factor}*{}", entry.name),
            (false, _) if factor.contains(' ') => format!("({factor})*{}", entry.name),
            (false, _) => format!("{factor}*{}", entry.name),
        };
    }
    let rest = &coefficients[standard.len()];
    if !rest.is_zero() {
        nominal = nominal.plus(rest);
        meaning += if meaning.is_empty() { "" } else { " + " };
        meaning += &format!("({} from the masses of rotors)", shown(rest));
    }
    if let ([(entry, k)], true) = (&parts[..], rest.is_zero()) {
        if k.is_one() && entry.name == parameter.name() {
            name = entry.name.clone();
            meaning = entry.meaning.clone();
        }
    }
    Parameter { name, nominal, meaning }
}

/// Columns are kept in this order: friction, then links from the base outwards; within a link inertia about the axis first. Rotors are told
/// apart from links only where nothing else can carry their effect.
fn preference(parameter: StandardParameter) -> (u8, u16, u8) {
    let of_body = |parameter: Inertial| match parameter {
        Inertial::Izz | Inertial::PlanarIxx => 0,
        Inertial::Ixy => 1,
        Inertial::Ixz => 2,
        Inertial::Mcx => 3,
        Inertial::Mcy => 4,
        Inertial::Ixx | Inertial::PlanarIyy => 5,
        Inertial::Iyz => 6,
        Inertial::Iyy => 7,
        Inertial::Mcz => 8,
        Inertial::M => 9,
    };
    match parameter {
        StandardParameter::RotorViscous(i) => (0, i, 0),
        StandardParameter::Viscous(i) => (0, i, 1),
        StandardParameter::Coulomb(i) => (0, i, 2),
        StandardParameter::Offset(i) => (0, i, 3),
        StandardParameter::Cubic(i) => (0, i, 4),
        StandardParameter::Stiffness(i) => (0, i, 5),
        StandardParameter::Stribeck(i) => (0, i, 6),
        StandardParameter::Link(i, k) => (1, i, of_body(k)),
        StandardParameter::RotorInertia(i) => (2, i, 0),
        StandardParameter::Armature(i) => (2, i, 1),
        StandardParameter::Payload(number, k) => (3, u16::from(number), k as u8),
    }
}
