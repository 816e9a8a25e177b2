//! Differentiation: the sum, product and reciprocal rules over the shared graph, each node once.

use std::collections::HashMap;

use super::{AngleSum, ExprId, Node, Pool, Symbol};
use crate::exact::Number;

impl Pool {
    /// The derivative of each expression, where `of` gives the derivative of each symbol.
    pub fn differentiate(&mut self, exprs: &[ExprId], of: &mut dyn FnMut(&mut Pool, Symbol) -> ExprId) -> Vec<ExprId> {
        let mut done: HashMap<usize, ExprId> = HashMap::new();
        exprs.iter().map(|&expr| self.differentiate_one(expr, of, &mut done)).collect()
    }

    fn differentiate_one(
        &mut self,
        expr: ExprId,
        of: &mut dyn FnMut(&mut Pool, Symbol) -> ExprId,
        done: &mut HashMap<usize, ExprId>,
    ) -> ExprId {
        // A stack of its own: expressions of long arms are deep.
        let mut stack = vec![(expr.unsigned(), false)];
        while let Some((expr, ready)) = stack.pop() {
            if done.contains_key(&expr.index()) {
                continue;
            }
            let node = self.node(expr);
            if !ready {
                stack.push((expr, true));
                match node {
                    Node::Add(a, b) | Node::Mul(a, b) => stack.extend([(b.unsigned(), false), (a.unsigned(), false)]),
                    Node::Reciprocal(a) => stack.push((a, false)),
                    Node::Constant(_) | Node::Symbol(_) => {}
                }
                continue;
            }
            let derivative = |x: ExprId| done[&x.index()].signed(x.is_negated());
            let value = match node {
                Node::Constant(_) => ExprId::ZERO,
                Node::Symbol(symbol) => of(self, symbol),
                Node::Add(a, b) => {
                    let (da, db) = (derivative(a), derivative(b));
                    self.add(da, db)
                }
                Node::Mul(a, b) => {
                    let (da, db) = (derivative(a), derivative(b));
                    let (left, right) = (self.mul(da, b), self.mul(a, db));
                    self.add(left, right)
                }
                Node::Reciprocal(a) => {
                    let (da, square) = (derivative(a), self.mul(expr, expr));
                    -self.mul(da, square)
                }
            };
            done.insert(expr.index(), value);
        }
        done[&expr.index()].signed(expr.is_negated())
    }

    /// ∂/∂q_joint of each expression.
    pub fn partial_derivative(&mut self, exprs: &[ExprId], joint: u16) -> Vec<ExprId> {
        self.differentiate(exprs, &mut |pool, symbol| match symbol {
            Symbol::Sine(i) | Symbol::Cosine(i) => {
                let slope = pool.slope(i, |pool, a, factor| if a == joint { pool.constant(factor) } else { ExprId::ZERO });
                let slope = slope.unwrap_or(if i == joint { ExprId::ONE } else { ExprId::ZERO });
                let turned = if slope == ExprId::ZERO { ExprId::ZERO } else { turned(pool, symbol, i) };
                pool.mul(slope, turned)
            }
            Symbol::SineOf(sum) | Symbol::CosineOf(sum) => {
                let Some((_, minus)) = sum.terms().find(|&(i, _)| i == joint) else { return ExprId::ZERO };
                turned_sum(pool, symbol, sum).signed(minus)
            }
            Symbol::Position(i) if i == joint => ExprId::ONE,
            _ => ExprId::ZERO,
        })
    }

    /// d/dt of expressions in q alone, along dq: Σ_i ∂/∂q_i · dq_i.
    pub fn time_derivative(&mut self, exprs: &[ExprId]) -> Vec<ExprId> {
        self.differentiate(exprs, &mut |pool, symbol| match symbol {
            Symbol::Sine(i) | Symbol::Cosine(i) => {
                let of_factor = |pool: &mut Pool, a, factor: &Number| {
                    let (factor, rate) = (pool.constant(factor), pool.symbol(Symbol::Rate(a)));
                    pool.mul(factor, rate)
                };
                let computed = pool.slope(i, of_factor);
                let turned = turned(pool, symbol, i);
                let rate = computed.unwrap_or_else(|| pool.symbol(Symbol::Rate(i)));
                pool.mul(turned, rate)
            }
            Symbol::SineOf(sum) | Symbol::CosineOf(sum) => {
                let rates: Vec<ExprId> = sum.terms().map(|(i, minus)| pool.symbol(Symbol::Rate(i)).signed(minus)).collect();
                let (rate, turned) = (pool.sum(rates), turned_sum(pool, symbol, sum));
                pool.mul(turned, rate)
            }
            Symbol::Position(i) => pool.symbol(Symbol::Rate(i)),
            _ => ExprId::ZERO,
        })
    }
}

/// The derivative of the sine or cosine of an angle by the angle.
fn turned(pool: &mut Pool, symbol: Symbol, i: u16) -> ExprId {
    match symbol {
        Symbol::Sine(_) => pool.symbol(Symbol::Cosine(i)),
        _ => -pool.symbol(Symbol::Sine(i)),
    }
}

/// The derivative of the sine or cosine of a sum of angles by the sum.
fn turned_sum(pool: &mut Pool, symbol: Symbol, sum: AngleSum) -> ExprId {
    match symbol {
        Symbol::SineOf(_) => pool.symbol(Symbol::CosineOf(sum)),
        _ => -pool.symbol(Symbol::SineOf(sum)),
    }
}

impl Pool {
    /// The sum over the coordinates of a computed angle of what `of` gives for a coordinate and its factor; `None` of other angles.
    fn slope(&mut self, index: u16, of: impl Fn(&mut Pool, u16, &Number) -> ExprId) -> Option<ExprId> {
        let factors = self.field().computed()?.get(index)?.factors.clone();
        Some(factors.iter().fold(ExprId::ZERO, |sum, (a, factor)| {
            let term = of(self, *a, factor);
            self.add(sum, term)
        }))
    }

    /// Expressions rebuilt in another pool, with each symbol replaced by what `of` says.
    pub fn substitute_into(&self, target: &mut Pool, exprs: &[ExprId], of: &dyn Fn(&mut Pool, Symbol) -> ExprId) -> Vec<ExprId> {
        let needed = self.reachable(exprs);
        let mut images = vec![ExprId::ZERO; self.len()];
        for index in (0..self.len()).filter(|&i| needed[i]) {
            let image = |e: ExprId| images[e.index()].signed(e.is_negated());
            images[index] = match self.node(self.expr(index)) {
                Node::Constant(_) => target.constant_of(self, self.expr(index)),
                Node::Symbol(symbol) => of(target, symbol),
                Node::Add(a, b) => target.add(image(a), image(b)),
                Node::Mul(a, b) => target.mul(image(a), image(b)),
                Node::Reciprocal(a) => target.reciprocal(image(a)),
            };
        }
        exprs.iter().map(|e| images[e.index()].signed(e.is_negated())).collect()
    }

    /// Which nodes expressions need, by index.
    pub(crate) fn reachable(&self, exprs: &[ExprId]) -> Vec<bool> {
        let mut needed = vec![false; self.len()];
        exprs.iter().for_each(|e| needed[e.index()] = true);
        for index in (0..self.len()).rev() {
            if needed[index] {
                match self.node(self.expr(index)) {
                    Node::Add(a, b) | Node::Mul(a, b) => {
                        needed[a.index()] = true;
                        needed[b.index()] = true;
                    }
                    Node::Reciprocal(a) => needed[a.index()] = true,
                    Node::Constant(_) | Node::Symbol(_) => {}
                }
            }
        }
        needed
    }
}
