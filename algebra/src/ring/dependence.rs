//! Variables that cancel: expressions may be written with a variable that none of them depends on.
//!
//! A slide that is added and subtracted again is 0 over the reals, and loses digits in floats. In the prime field a sweep from the expressions
//! inwards gives the derivative of a random combination of them by every symbol, and so by every variable:
//!
//! ```text
//! df/dq = df/ds c - df/dc s,   s = sin q, c = cos q, summed over all angles with q in them
//! ```
//!
//! Where it is 0, f(x, y) = f(x, 0): the expressions are written again with 0 for the variable. Divisors count as expressions,
//! so that they keep their values, too.

use std::collections::{BTreeMap, BTreeSet};

use super::{Angle, AngleSum, ExprId, Fingerprint, Node, Pool, Symbol};
use crate::scramble::scramble;

/// What symbols depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Variable {
    /// A joint angle: sines and cosines of sums that contain it.
    Angle(u16),
    /// A symbol that is a variable itself.
    Symbol(Symbol),
}

impl Pool {
    /// The expressions without the variables that none of them depends on, in a pool of their own; `None` where there are no such variables.
    pub fn without_cancelled_variables(&self, exprs: &[ExprId]) -> Option<(Pool, Vec<ExprId>)> {
        let zero = [self.field.zero(); 2];
        let slopes = self.slopes(exprs);
        // What a computed angle depends on stays: without a coordinate it would be another angle.
        let computed: Vec<u16> = self.angles(exprs).into_iter().flat_map(|sum| sum.terms().map(|(i, _)| i)).collect();
        let computed = computed.into_iter().filter_map(|i| Some((i, self.field.computed()?.get(i)?)));
        let kept: BTreeSet<u16> = computed.flat_map(|(i, angle)| angle.factors.iter().map(|(a, _)| *a).chain([i])).collect();
        let is_kept = |variable: Variable| match variable {
            Variable::Angle(i) | Variable::Symbol(Symbol::Position(i)) => kept.contains(&i),
            Variable::Symbol(_) => false,
        };
        let cancelled = slopes.into_iter().filter(|(variable, slope)| *slope == zero && !is_kept(*variable));
        let cancelled: BTreeSet<Variable> = cancelled.map(|(variable, _)| variable).collect();
        if cancelled.is_empty() {
            return None;
        }
        let mut pool = Pool::new(self.field.clone());
        let found = self.substitute_into(&mut pool, exprs, &|pool, symbol| without(pool, symbol, &cancelled));
        for (&before, &after) in exprs.iter().zip(&found) {
            assert_eq!(self.fingerprint(before), pool.fingerprint(after), "a variable without influence changes no value");
        }
        Some((pool, found))
    }

    /// The derivative of a random combination of the expressions and of all divisors by each variable that they are written with.
    fn slopes(&self, exprs: &[ExprId]) -> BTreeMap<Variable, Fingerprint> {
        let (field, zero) = (&self.field, [self.field.zero(); 2]);
        let plus = |a: Fingerprint, b: Fingerprint| [field.add(a[0], b[0]), field.add(a[1], b[1])];
        let times = |a: Fingerprint, b: Fingerprint| [field.mul(a[0], b[0]), field.mul(a[1], b[1])];
        let signed = |a: Fingerprint, negate: bool| if negate { self.negated(a) } else { a };
        let mut weights = (1..).map(|k| [field.from_u64(scramble(k)); 2]);
        let mut weight = || weights.next().unwrap_or(zero);
        let needed = self.reachable(exprs);
        let mut all = vec![zero; self.len()];
        let mut slopes = BTreeMap::new();
        for expr in exprs {
            all[expr.index()] = plus(all[expr.index()], signed(weight(), expr.is_negated()));
        }
        for index in (0..self.len()).rev().filter(|&index| needed[index]) {
            let own = all[index];
            let mut add = |operand: ExprId, slope: Fingerprint| {
                all[operand.index()] = plus(all[operand.index()], signed(slope, operand.is_negated()));
            };
            match self.nodes[index] {
                Node::Constant(_) => {}
                Node::Add(a, b) => {
                    add(a, own);
                    add(b, own);
                }
                Node::Mul(a, b) => {
                    add(a, times(own, self.fingerprint(b)));
                    add(b, times(own, self.fingerprint(a)));
                }
                Node::Reciprocal(a) => {
                    let value = self.fingerprints[index];
                    add(a, self.negated(times(own, times(value, value))));
                    add(a, weight());
                }
                Node::Symbol(symbol) => {
                    let mut count = |variable, slope| {
                        let sum = slopes.entry(variable).or_insert(zero);
                        *sum = plus(*sum, slope);
                    };
                    let Some(angle) = symbol.angle() else {
                        count(Variable::Symbol(symbol), own);
                        continue;
                    };
                    let value = |symbol| [0, 1].map(|point| self.symbol_value(symbol, point));
                    let [sine, cosine] = angle.circle();
                    let derivative = if is_sine(symbol) { value(cosine) } else { self.negated(value(sine)) };
                    let slope = times(own, derivative);
                    angle.terms().for_each(|(joint, minus)| count(Variable::Angle(joint), signed(slope, minus)));
                }
            }
        }
        slopes
    }
}

fn is_sine(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Sine(_) | Symbol::SineOf(_))
}

/// The symbol where some variables are 0.
fn without(pool: &mut Pool, symbol: Symbol, zero: &BTreeSet<Variable>) -> ExprId {
    let angle = match symbol.angle() {
        None if zero.contains(&Variable::Symbol(symbol)) => return ExprId::ZERO,
        Some(Angle::One(i)) if zero.contains(&Variable::Angle(i)) => {
            return if is_sine(symbol) { ExprId::ZERO } else { ExprId::ONE };
        }
        None | Some(Angle::One(_)) => return pool.symbol(symbol),
        Some(Angle::Sum(sum)) => sum,
    };
    let bits =
        angle.terms().filter(|&(joint, _)| zero.contains(&Variable::Angle(joint))).fold(0, |bits, (joint, _)| bits | 1 << joint);
    if bits == 0 {
        return pool.symbol(symbol);
    }
    let rest = AngleSum { plus: angle.plus & !bits, minus: angle.minus & !bits, ..angle };
    let sine = is_sine(symbol);
    match (rest.plus | rest.minus, rest.turned) {
        (0, false) if sine => ExprId::ZERO,
        (0, false) => ExprId::ONE,
        (0, true) => {
            let turn = pool.field().turn().expect("a field without a turn has no turned sums").clone();
            pool.constant(if sine { &turn.sine } else { &turn.cosine })
        }
        // A single joint angle has symbols of its own.
        (joints, false) if joints.is_power_of_two() => {
            let joint = joints.trailing_zeros() as u16;
            let symbol = if sine { Symbol::Sine(joint) } else { Symbol::Cosine(joint) };
            pool.symbol(symbol).signed(sine && rest.minus != 0)
        }
        _ => pool.symbol(if sine { Symbol::SineOf(rest) } else { Symbol::CosineOf(rest) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::field::Field;

    fn symbols(pool: &Pool, exprs: &[ExprId]) -> BTreeSet<Symbol> {
        let needed = pool.reachable(exprs);
        let symbol = |index: usize| if let Node::Symbol(symbol) = pool.nodes[index] { Some(symbol) } else { None };
        (0..pool.len()).filter(|&index| needed[index]).filter_map(symbol).collect()
    }

    /// (x + a) b - x b, of which no node has the value a b.
    fn cancelling(pool: &mut Pool, x: ExprId, a: ExprId, b: ExprId) -> ExprId {
        let sum = pool.add(x, a);
        let (left, right) = (pool.mul(sum, b), pool.mul(x, b));
        pool.sub(left, right)
    }

    #[test]
    fn a_variable_that_cancels_is_left_out_of_all_expressions_or_of_no_expression() {
        let mut pool = Pool::new(Field::for_constants([]));
        let all = [Symbol::Position(0), Symbol::Rate(0), Symbol::Position(1), Symbol::Sine(2)];
        let [x, rate, y, s] = all.map(|symbol| pool.symbol(symbol));
        let (one, other) = (cancelling(&mut pool, x, y, s), cancelling(&mut pool, rate, s, s));
        assert_eq!(symbols(&pool, &[one, other]), BTreeSet::from(all));
        let (found, exprs) = pool.without_cancelled_variables(&[one, other]).expect("two cancel");
        assert_eq!(symbols(&found, &exprs), BTreeSet::from([Symbol::Position(1), Symbol::Sine(2)]));
        assert!(found.without_cancelled_variables(&exprs).is_none());
        // Another expression depends on x: it stays, and rate goes.
        let (found, exprs) = pool.without_cancelled_variables(&[one, other, x]).expect("one cancels");
        assert!(symbols(&found, &exprs).contains(&Symbol::Position(0)) && !symbols(&found, &exprs).contains(&Symbol::Rate(0)));
    }

    #[test]
    fn an_angle_cancels_in_sums_of_angles() {
        let mut pool = Pool::new(Field::for_constants([]));
        let sum = AngleSum::of(0).plus(AngleSum { plus: 0, minus: 1 << 1, turned: false });
        let all = [Symbol::SineOf(sum), Symbol::CosineOf(sum), Symbol::Sine(0), Symbol::Cosine(0), Symbol::Position(2)];
        let [s, c, s0, c0, x] = all.map(|symbol| pool.symbol(symbol));
        // sin(q_0 - (q_0 - q_1)) and the cosine.
        let (sine, cosine) = (pool.dot(&[s0, -c0], &[c, s]), pool.dot(&[c0, s0], &[c, s]));
        let scaled = pool.mul(x, cosine);
        let (found, exprs) = pool.without_cancelled_variables(&[sine, scaled]).expect("q_0 cancels");
        assert_eq!(found.node(exprs[0]), Node::Symbol(Symbol::Sine(1)));
        assert_eq!(symbols(&found, &exprs), BTreeSet::from([Symbol::Sine(1), Symbol::Cosine(1), Symbol::Position(2)]));
        assert!(pool.without_cancelled_variables(&[s, c, x]).is_none());
    }

    #[test]
    fn a_divisor_keeps_its_variables() {
        let mut pool = Pool::new(Field::for_constants([]));
        let [x, y, z] = [0, 1, 2].map(|i| pool.symbol(Symbol::Position(i)));
        // (x y) z (1 / x) is y z, and its divisor is x.
        let (inverse, product) = (pool.reciprocal(x), pool.mul(x, y));
        let product = pool.mul(product, z);
        let quotient = pool.mul(product, inverse);
        assert!(symbols(&pool, &[quotient]).contains(&Symbol::Position(0)));
        assert!(pool.without_cancelled_variables(&[quotient]).is_none());
    }
}
