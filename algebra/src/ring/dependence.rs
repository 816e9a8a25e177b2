//! Variables that cancel: an expression may be written with a variable that its value does not depend on.
//!
//! A polynomial in a long slide that is added and taken away again is nothing over the reals, and loses digits in floats. Whether a value
//! depends on a variable shows in the prime field: it changes with it, or does not (with the odds of equal fingerprints). Where it does
//! not, the variable may have any value:
//!
//! ```text
//! f(x, y) = f(x, 0) if f does not depend on y
//! ```
//!
//! with sin = 0 and cos = 1 for an angle. So an entry is written again without the variable, in another pool, where its value is not yet known
//! by the longer way.

use std::collections::BTreeSet;

use super::field::Element;
use super::{AngleSum, ExprId, Fingerprint, Node, Pool, Symbol};
use crate::scramble::scramble;

/// What an expression may depend on, as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Variable {
    /// The joint variable: q_i itself, its sine and cosine, those of sums that it is a term of.
    Joint(u16),
    /// All rates, with their signs.
    Rates,
    /// All accelerations.
    Accelerations,
    /// All reference rates.
    ReferenceRates,
    /// All reference accelerations.
    ReferenceAccelerations,
}

impl Variable {
    /// The joint variables of so many joints, and all others.
    fn all(joints: u16) -> impl Iterator<Item = Variable> {
        let others = [Variable::Rates, Variable::Accelerations, Variable::ReferenceRates, Variable::ReferenceAccelerations];
        (0..joints).map(Variable::Joint).chain(others)
    }

    /// Whether the value of the symbol follows from it.
    fn has(self, symbol: Symbol) -> bool {
        match (self, symbol) {
            (Variable::Joint(i), Symbol::Position(j)) => i == j,
            (Variable::Joint(i), symbol) => symbol
                .angle()
                .is_some_and(|sum| (sum.plus | sum.minus).checked_shr(u32::from(i)).is_some_and(|bits| bits & 1 == 1)),
            (Variable::Rates, Symbol::Rate(_) | Symbol::RateSign(_) | Symbol::Stribeck(_)) => true,
            (Variable::Accelerations, Symbol::Acceleration(_)) => true,
            (Variable::ReferenceRates, Symbol::ReferenceRate(_)) => true,
            (Variable::ReferenceAccelerations, Symbol::ReferenceAcceleration(_)) => true,
            _ => false,
        }
    }
}

/// More than a sine and a cosine, or the square of one, of a variable that cancels is too much; of a length, a rate or an acceleration anything is.
const TOO_MUCH: u32 = 3;

impl Pool {
    /// The variables of each expression that it is written with to a high degree and does not depend on; those that no expression depends on,
    /// whatever their degree.
    fn cancelled(&self, exprs: &[ExprId], joints: u16) -> Vec<BTreeSet<Variable>> {
        let needed = self.reachable(exprs);
        let symbols: Vec<Symbol> = (0..self.len())
            .filter(|&index| needed[index])
            .filter_map(|index| if let Node::Symbol(symbol) = self.nodes[index] { Some(symbol) } else { None })
            .collect();
        let mut found = vec![BTreeSet::new(); exprs.len()];
        for variable in Variable::all(joints) {
            if !symbols.iter().any(|&symbol| variable.has(symbol)) {
                continue;
            }
            let independent = self.independent(exprs, variable, &needed);
            if !independent.contains(&true) {
                continue;
            }
            let whole = !independent.contains(&false);
            let degrees = self.degrees(exprs, &needed, |symbol| match symbol {
                symbol if !variable.has(symbol) => 0,
                symbol if symbol.angle().is_some() && !whole => 1,
                _ => TOO_MUCH,
            });
            for ((found, independent), degree) in found.iter_mut().zip(independent).zip(degrees) {
                if independent && degree >= TOO_MUCH {
                    found.insert(variable);
                }
            }
        }
        found
    }

    /// How often each expression multiplies symbols that count as often as `of` says; a quotient counts as its divisor.
    fn degrees(&self, exprs: &[ExprId], needed: &[bool], of: impl Fn(Symbol) -> u32) -> Vec<u32> {
        let mut degrees = vec![0u32; self.len()];
        for index in (0..self.len()).filter(|&i| needed[i]) {
            degrees[index] = match self.nodes[index] {
                Node::Constant(_) => 0,
                Node::Symbol(symbol) => of(symbol),
                Node::Add(a, b) => degrees[a.index()].max(degrees[b.index()]),
                Node::Mul(a, b) => degrees[a.index()].saturating_add(degrees[b.index()]),
                Node::Reciprocal(a) => degrees[a.index()],
            };
        }
        exprs.iter().map(|e| degrees[e.index()]).collect()
    }

    /// Whether each expression keeps its value where the variable has another one.
    fn independent(&self, exprs: &[ExprId], variable: Variable, needed: &[bool]) -> Vec<bool> {
        let field = &self.field;
        let mut values: Vec<Fingerprint> = vec![[field.zero(); 2]; self.len()];
        for index in (0..self.len()).filter(|&i| needed[i]) {
            let of = |e: ExprId| if e.is_negated() { self.negated(values[e.index()]) } else { values[e.index()] };
            values[index] = match self.nodes[index] {
                Node::Symbol(symbol) if variable.has(symbol) => [0, 1].map(|point| self.changed_value(symbol, variable, point)),
                Node::Constant(_) | Node::Symbol(_) => self.fingerprints[index],
                Node::Add(a, b) => [0, 1].map(|i| field.add(of(a)[i], of(b)[i])),
                Node::Mul(a, b) => [0, 1].map(|i| field.mul(of(a)[i], of(b)[i])),
                Node::Reciprocal(a) => of(a).map(|x| field.inverse(x)),
            };
        }
        exprs.iter().map(|e| values[e.index()] == self.fingerprints[e.index()]).collect()
    }

    /// A symbol of the variable, at points where this alone has another value.
    fn changed_value(&self, symbol: Symbol, variable: Variable, point: u64) -> Element {
        // Values of a kind of symbol that there is none of.
        let other = |index: u16| self.field.from_u64(scramble(scramble(63 << 20 | u64::from(index)) ^ (point + 1)));
        let Some(sum) = symbol.angle() else { return other(symbol.index()) };
        let of = |i: u16| match variable {
            Variable::Joint(joint) if joint == i => self.field.circle(other(i)),
            _ => (self.symbol_value(Symbol::Sine(i), point), self.symbol_value(Symbol::Cosine(i), point)),
        };
        let (sine, cosine) = self.field.circle_of(sum, of);
        if matches!(symbol, Symbol::Sine(_) | Symbol::SineOf(_)) {
            sine
        } else {
            cosine
        }
    }

    /// The expressions without variables that cancel in them, in a pool of their own; `None` where there are none.
    pub fn without_cancelled(&self, exprs: &[ExprId], joints: u16) -> Option<(Pool, Vec<ExprId>)> {
        let cancelled = self.cancelled(exprs, joints);
        if cancelled.iter().all(BTreeSet::is_empty) {
            return None;
        }
        let mut pool = Pool::new(self.field.clone());
        let mut found = vec![ExprId::ZERO; exprs.len()];
        // Those with the most to leave out first: what they are written with now is found by the others.
        let mut sets: Vec<&BTreeSet<Variable>> = cancelled.iter().collect();
        sets.sort_by_key(|set| (std::cmp::Reverse(set.len()), *set));
        sets.dedup();
        for set in sets {
            let of: Vec<usize> = (0..exprs.len()).filter(|&k| cancelled[k] == *set).collect();
            let own: Vec<ExprId> = of.iter().map(|&k| exprs[k]).collect();
            let images = self.substitute_into(&mut pool, &own, &|pool, symbol| at_origin(pool, symbol, set));
            for (k, image) in of.into_iter().zip(images) {
                found[k] = image;
            }
        }
        for (&before, &after) in exprs.iter().zip(&found) {
            assert_eq!(self.fingerprint(before), pool.fingerprint(after), "an expression keeps its value without what cancels");
        }
        Some((pool, found))
    }
}

/// The symbol where some variables are 0.
fn at_origin(pool: &mut Pool, symbol: Symbol, zero: &BTreeSet<Variable>) -> ExprId {
    if !zero.iter().any(|variable| variable.has(symbol)) {
        return pool.symbol(symbol);
    }
    let Some(sum) = symbol.angle() else { return ExprId::ZERO };
    let joints = zero.iter().filter_map(|variable| if let Variable::Joint(i) = variable { Some(1u32 << i) } else { None });
    let left = !joints.fold(0, |set, bit| set | bit);
    let sum = AngleSum { plus: sum.plus & left, minus: sum.minus & left, turned: sum.turned };
    let is_sine = matches!(symbol, Symbol::Sine(_) | Symbol::SineOf(_));
    match (sum.plus | sum.minus, sum.turned) {
        (0, false) if is_sine => ExprId::ZERO,
        (0, false) => ExprId::ONE,
        (0, true) => {
            let turn = pool.field().turn().expect("only a field with a turn has turned sums").clone();
            pool.constant(if is_sine { &turn.sine } else { &turn.cosine })
        }
        // A single joint variable has symbols of its own.
        (joints, false) if joints.is_power_of_two() => {
            let joint = joints.trailing_zeros() as u16;
            let symbol = pool.symbol(if is_sine { Symbol::Sine(joint) } else { Symbol::Cosine(joint) });
            symbol.signed(is_sine && sum.minus != 0)
        }
        _ => pool.symbol(if is_sine { Symbol::SineOf(sum) } else { Symbol::CosineOf(sum) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::field::Field;

    #[test]
    fn what_cancels_is_left_out_and_the_rest_stays() {
        let mut p = Pool::new(Field::for_constants([]));
        let [x, q, s, c] = [Symbol::Position(0), Symbol::Position(1), Symbol::Sine(2), Symbol::Cosine(2)].map(|s| p.symbol(s));
        // (x + q) - x is q at once; x q - (x - 1) q is not.
        let less = p.sub(x, ExprId::ONE);
        let (a, b) = (p.mul(x, s), p.mul(less, s));
        let cancels = p.sub(a, b);
        assert_eq!(cancels, s, "found by its fingerprint");
        // A value that no node has: (x + s)(c + q) - x (c + q).
        let (sum, other) = (p.add(x, s), p.add(c, q));
        let (left, right) = (p.mul(sum, other), p.mul(x, other));
        let spurious = p.sub(left, right);
        let (pool, found) = p.without_cancelled(&[spurious, left], 3).expect("x cancels in the first");
        let symbols = |e: ExprId| -> Vec<Symbol> {
            let needed = pool.reachable(&[e]);
            (0..pool.len())
                .filter(|&i| needed[i])
                .filter_map(|i| if let Node::Symbol(s) = pool.node(pool.expr(i)) { Some(s) } else { None })
                .collect()
        };
        assert!(!symbols(found[0]).contains(&Symbol::Position(0)) && symbols(found[1]).contains(&Symbol::Position(0)));
        assert!(pool.without_cancelled(&found, 3).is_none());
        // An angle in a sum of angles.
        let mut p = Pool::new(Field::for_constants([]));
        let sum = AngleSum::of(0).plus(AngleSum::of(1));
        let [s, c, s0, c0, q] =
            [Symbol::SineOf(sum), Symbol::CosineOf(sum), Symbol::Sine(0), Symbol::Cosine(0), Symbol::Position(2)]
                .map(|s| p.symbol(s));
        let (sine, cosine) = (p.dot(&[s, -c], &[c0, s0]), p.dot(&[c, s], &[c0, s0]));
        let (pool, found) = p.without_cancelled(&[sine, cosine], 3).expect("the first angle cancels in all");
        assert_eq!(pool.node(found[0]), Node::Symbol(Symbol::Sine(1)));
        assert!(p.without_cancelled(&[s, q], 3).is_none());
    }
}
