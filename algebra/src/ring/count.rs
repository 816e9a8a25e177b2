//! How many operations expressions take.

use std::collections::BTreeSet;

use super::{Angle, ExprId, Node, Pool, Symbol};

/// A division counts like so many additions.
pub const DIVISION_COST: usize = 4;

/// A sine and cosine pair counts like this many additions.
pub const SINE_COSINE_COST: usize = 16;

impl Pool {
    /// Operations that the expressions need together, each node once: one for a sum or product, `reciprocal` for a reciprocal.
    pub fn operations(&self, exprs: &[ExprId], reciprocal: usize) -> usize {
        let mut needed = vec![false; self.len()];
        exprs.iter().for_each(|e| needed[e.index()] = true);
        let mut count = 0;
        for index in (0..self.len()).rev() {
            if !needed[index] {
                continue;
            }
            match self.nodes[index] {
                Node::Add(a, b) | Node::Mul(a, b) => {
                    needed[a.index()] = true;
                    needed[b.index()] = true;
                    count += 1;
                }
                Node::Reciprocal(a) => {
                    needed[a.index()] = true;
                    count += reciprocal;
                }
                Node::Constant(_) | Node::Symbol(_) => {}
            }
        }
        count
    }

    /// The angles whose sines and cosines the expressions need.
    pub fn angles(&self, exprs: &[ExprId]) -> BTreeSet<Angle> {
        let needed = self.reachable(exprs);
        let angle = |index: usize| match self.nodes[index] {
            Node::Symbol(symbol) => symbol.angle(),
            _ => None,
        };
        (0..self.len()).filter(|&index| needed[index]).filter_map(angle).collect()
    }

    /// Whether a parameter is left as a symbol in expressions.
    pub fn has_parameters(&self, exprs: &[ExprId]) -> bool {
        let needed = self.reachable(exprs);
        (0..self.len()).any(|index| needed[index] && matches!(self.nodes[index], Node::Symbol(Symbol::Parameter(_))))
    }
}
