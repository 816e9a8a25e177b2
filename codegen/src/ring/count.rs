//! How many operations expressions take.

use super::{ExprId, Node, Pool};

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
}
