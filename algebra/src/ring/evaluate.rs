//! Exact evaluation: over exact constants and, through the fingerprints, over the prime field.

use std::collections::HashMap;
use std::sync::Arc;

use super::{AngleSum, Elementary, ExprId, Node, Pool, Symbol};
use crate::exact::Number;

/// A constant with more terms and factors stays the expression that it arises from.
const LONGEST_CONSTANT: usize = 500;

/// A value at the origin that may be that of a constant; 0 where there is none or it is too long to be one. Callers compare with the fingerprint,
/// and reject what is wrong.
fn value_if_short(value: Option<Number>) -> Number {
    value.filter(|value| value.is_within(LONGEST_CONSTANT)).unwrap_or_default()
}

impl Pool {
    /// The exact values of expressions where each symbol has the value `of` says. `None` where a reciprocal meets 0 or a number that has no
    /// simple inverse.
    pub fn evaluate(&self, exprs: &[ExprId], of: &dyn Fn(Symbol) -> Number) -> Option<Vec<Number>> {
        let needed = self.reachable(exprs);
        let mut values: Vec<Number> = vec![Number::zero(); self.len()];
        for index in 0..self.len() {
            if needed[index] {
                values[index] = self.combine(self.nodes[index], of, |e| values[e.index()].clone())?;
            }
        }
        Some(exprs.iter().map(|e| if e.is_negated() { -&values[e.index()] } else { values[e.index()].clone() }).collect())
    }

    fn combine(&self, node: Node, of: &dyn Fn(Symbol) -> Number, value: impl Fn(ExprId) -> Number) -> Option<Number> {
        let signed = |e: ExprId| if e.is_negated() { -&value(e) } else { value(e) };
        Some(match node {
            Node::Constant(id) => (*self.constants[id.0 as usize]).clone(),
            Node::Symbol(symbol) => self.value_of_symbol(symbol, of),
            Node::Add(a, b) => signed(a).plus(&signed(b)),
            Node::Mul(a, b) => signed(a).times(&signed(b)),
            Node::Reciprocal(a) => signed(a).simple_inverse()?,
        })
    }

    /// Turned sums have the values that follow from those of the sums.
    fn value_of_symbol(&self, symbol: Symbol, of: &dyn Fn(Symbol) -> Number) -> Number {
        match (symbol, self.field.turn()) {
            (Symbol::SineOf(sum) | Symbol::CosineOf(sum), Some(turn)) if sum.turned => {
                let sum = sum.unturned();
                let (sine, cosine) = turn.after(&of(Symbol::SineOf(sum)), &of(Symbol::CosineOf(sum)));
                if matches!(symbol, Symbol::SineOf(_)) {
                    sine
                } else {
                    cosine
                }
            }
            _ => of(symbol),
        }
    }

    /// The value of a node of constant value: where all angles are 0 and everything else is 0 too.
    pub(super) fn value_at_origin(&mut self, node: Node) -> Number {
        let computed = self.field.computed().cloned();
        let turn = |index: u16| computed.as_ref().and_then(|angles| angles.get(index)).map(|angle| angle.turn.clone());
        let origin = |symbol| match symbol {
            Symbol::Sine(i) => turn(i).map_or_else(Number::zero, |[sine, _]| sine),
            Symbol::Cosine(i) => turn(i).map_or_else(Number::one, |[_, cosine]| cosine),
            Symbol::CosineOf(_) => Number::one(),
            _ => Number::zero(),
        };
        let operands = match node {
            Node::Add(a, b) | Node::Mul(a, b) => vec![a, b],
            Node::Reciprocal(a) => vec![a],
            Node::Constant(_) | Node::Symbol(_) => vec![],
        };
        let mut stack: Vec<usize> = operands.iter().map(|e| e.index()).collect();
        while let Some(&index) = stack.last() {
            if self.at_origin[index].is_some() {
                stack.pop();
                continue;
            }
            let pending: Vec<usize> = match self.nodes[index] {
                Node::Add(a, b) | Node::Mul(a, b) => vec![a.index(), b.index()],
                Node::Reciprocal(a) => vec![a.index()],
                Node::Constant(_) | Node::Symbol(_) => vec![],
            }
            .into_iter()
            .filter(|&i| self.at_origin[i].is_none())
            .collect();
            if pending.is_empty() {
                let value = self.combine(self.nodes[index], &origin, |e| self.origin_value(e));
                self.at_origin[index] = Some(Arc::new(value_if_short(value)));
                stack.pop();
            } else {
                stack.extend(pending);
            }
        }
        value_if_short(self.combine(node, &origin, |e| self.origin_value(e)))
    }

    fn origin_value(&self, expr: ExprId) -> Number {
        Number::clone(self.at_origin[expr.index()].as_ref().expect("operands come first"))
    }

    /// A state whose computed angles are related to their coordinates, from one whose angles are independent: that has the units.
    pub fn related_state<'a>(&'a self, of: impl Fn(Symbol) -> Number + 'a) -> impl Fn(Symbol) -> Number + 'a {
        move |symbol| {
            let Some((angle, angles)) = symbol.angle().zip(self.field.computed()) else { return of(symbol) };
            let unit = |unit: u16| (of(Symbol::Sine(unit)), of(Symbol::Cosine(unit)));
            // Coupled arms have no turned sums.
            let zero = (Number::zero(), Number::one());
            let (sine, cosine) = angle.terms().fold(zero, |(s, c), (index, minus)| {
                let (t, d) = angles.rational_point(index, unit);
                let t = if minus { -&t } else { t };
                (s.times(&d).plus(&c.times(&t)), c.times(&d).minus(&s.times(&t)))
            });
            if matches!(symbol, Symbol::Sine(_) | Symbol::SineOf(_)) {
                sine
            } else {
                cosine
            }
        }
    }

    /// Rational points of the circle and small rational numbers for all other symbols: a state to evaluate at, by number.
    pub fn rational_state(number: u64) -> impl Fn(Symbol) -> Number {
        let cache = std::cell::RefCell::new(HashMap::<Symbol, Number>::new());
        move |symbol| cache.borrow_mut().entry(symbol).or_insert_with(|| rational_value(symbol, number)).clone()
    }

    /// Quarter turns for angles and -1, 0, 1 for all other symbols: states whose numbers stay small, by number.
    pub fn simple_state(number: u64) -> impl Fn(Symbol) -> Number {
        move |symbol| {
            let kind = match symbol {
                Symbol::Sine(_) | Symbol::Cosine(_) | Symbol::SineOf(_) | Symbol::CosineOf(_) => 1,
                Symbol::Position(_) => 2,
                Symbol::Rate(_) | Symbol::OfRate(Elementary::Sign, _) => 3,
                Symbol::OfRate(of, _) => of.kind(),
                Symbol::Acceleration(_) => 5,
                Symbol::ReferenceRate(_) => 6,
                Symbol::ReferenceAcceleration(_) => 7,
                Symbol::Torque(_) => 8,
                Symbol::Parameter(_) => 9,
                Symbol::GravitySize(_) => 11,
                Symbol::GravitySign(_) => 12,
                Symbol::Gravity(_) => 13,
            };
            let drawn = draw(number, kind, symbol.index());
            Number::from(match symbol {
                Symbol::Sine(_) => [0, 1, 0, -1][(drawn % 4) as usize],
                Symbol::Cosine(_) => [1, 0, -1, 0][(drawn % 4) as usize],
                Symbol::SineOf(sum) => [0, 1, 0, -1][quarters(number, sum)],
                Symbol::CosineOf(sum) => [1, 0, -1, 0][quarters(number, sum)],
                _ => (drawn % 3) as i64 - 1,
            })
        }
    }
}

/// Quarter turns of a sum of angles.
fn quarters(number: u64, sum: AngleSum) -> usize {
    let turns = sum.terms().map(|(i, minus)| {
        let quarters = draw(number, 1, i) % 4;
        if minus {
            4 - quarters
        } else {
            quarters
        }
    });
    (turns.sum::<u64>() % 4) as usize
}

fn draw(number: u64, kind: u64, index: u16) -> u64 {
    super::scramble(super::scramble(number.wrapping_mul(64) + kind) ^ u64::from(index))
}

fn rational_value(symbol: Symbol, number: u64) -> Number {
    let draw = |kind: u64, index: u16| draw(number, kind, index);
    let small = |kind: u64, index: u16| {
        let bits = draw(kind, index);
        crate::exact::Rational::from((bits % 41) as i64 - 20) / crate::exact::Rational::from((bits >> 32) as i64 % 5 + 1)
    };
    // (sin, cos) = (2t, 1 - t²)/(1 + t²)
    let circle = |index: u16| {
        let t = small(1, index);
        let square = &t * &t;
        let scale = crate::exact::Rational::ONE / (crate::exact::Rational::ONE + &square);
        (t * crate::exact::Rational::from(2) * &scale, (crate::exact::Rational::ONE - square) * scale)
    };
    let circle_of = |sum: AngleSum| {
        use crate::exact::Rational;
        let turn = || unreachable!("turned sums are given the values of what they turn");
        sum.circle((Rational::ZERO, Rational::ONE), circle, turn, |(s, c), (t, d), minus| {
            let t = if minus { -t } else { t.clone() };
            (s * d + c * &t, c * d - s * &t)
        })
    };
    Number::from(match symbol {
        Symbol::Sine(i) => circle(i).0,
        Symbol::Cosine(i) => circle(i).1,
        Symbol::SineOf(sum) => circle_of(sum).0,
        Symbol::CosineOf(sum) => circle_of(sum).1,
        Symbol::Position(i) => small(2, i),
        Symbol::Rate(i) => small(3, i),
        Symbol::OfRate(Elementary::Sign, i) => {
            crate::exact::Rational::from(if draw(3, i) % 41 < 20 { -1 } else { i64::from(draw(3, i) % 41 != 20) })
        }
        Symbol::Acceleration(i) => small(5, i),
        Symbol::ReferenceRate(i) => small(6, i),
        Symbol::ReferenceAcceleration(i) => small(7, i),
        Symbol::Torque(i) => small(8, i),
        Symbol::Parameter(i) => small(9, i),
        Symbol::OfRate(of, i) => small(of.kind(), i),
        Symbol::GravitySize(i) => small(11, i),
        Symbol::GravitySign(i) => small(12, i),
        Symbol::Gravity(i) => small(13, i),
    })
}
