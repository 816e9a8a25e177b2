//! Constants of a sum in one, constants of a product in one, and terms that a sum holds several times.

use std::collections::BTreeMap;

use super::circuit::{Circuit, Edge, Gate, GateId};
use crate::ring::ExprId;

impl Circuit {
    /// Takes sums and products of one use into those that use them, and tidies them up, until nothing changes; how often each gate is used then.
    pub(super) fn tidy(&mut self) -> Vec<u32> {
        loop {
            let uses = self.flatten();
            if !self.merge(&uses) {
                return uses;
            }
        }
    }

    fn merge(&mut self, uses: &[u32]) -> bool {
        let mut changed = false;
        // The last sum that a gate was seen in.
        let mut seen: Vec<usize> = vec![usize::MAX; self.gates.len()];
        for id in 0..self.gates.len() {
            if uses[id] == 0 {
                continue;
            }
            changed |= match &self.gates[id] {
                // Most sums hold one constant at most, and everything else once.
                Gate::Sum(terms) => {
                    let constants = terms.iter().filter(|t| self.constant(t.gate).is_some()).count();
                    let repeated = |t: &Edge| std::mem::replace(&mut seen[t.gate as usize], id) == id;
                    (constants > 1 || terms.iter().any(repeated)) && self.merge_terms(id as GateId, &terms.clone(), uses)
                }
                Gate::Product(factors) => {
                    let constants = factors.iter().filter(|&&f| self.constant(f).is_some()).count();
                    constants > 1 && self.merge_factors(id as GateId, &factors.clone())
                }
                Gate::Leaf(_) | Gate::Reciprocal(_) => false,
            };
        }
        changed
    }

    /// One constant a sum; x - x gone; x + x with x = k y, that nothing else uses, as (2 k) y.
    fn merge_terms(&mut self, id: GateId, terms: &[Edge], uses: &[u32]) -> bool {
        let (constants, others): (Vec<Edge>, Vec<Edge>) = terms.iter().partition(|t| self.constant(t.gate).is_some());
        let mut counts: BTreeMap<GateId, i64> = BTreeMap::new();
        for term in &others {
            *counts.entry(term.gate).or_default() += if term.negated { -1 } else { 1 };
        }
        let times = |gate: GateId| others.iter().filter(|t| t.gate == gate).count();
        let scaled = |circuit: &Circuit, gate: GateId, count: i64| {
            let alone = usize::try_from(uses[gate as usize]).is_ok_and(|uses| uses == times(gate));
            let constant = match &circuit.gates[gate as usize] {
                Gate::Product(factors) if alone => factors.iter().copied().find(|&f| circuit.constant(f).is_some()),
                _ => None,
            };
            (count.unsigned_abs() > 1).then_some(constant).flatten()
        };
        let untouched = constants.len() < 2
            && counts.iter().all(|(&gate, &count)| {
                count != 0 && count.unsigned_abs() as usize == times(gate) && scaled(self, gate, count).is_none()
            });
        if untouched {
            return false;
        }
        let mut merged: Vec<Edge> = Vec::new();
        for term in &others {
            let Some(count) = counts.remove(&term.gate) else { continue };
            let negated = count < 0;
            match scaled(self, term.gate, count) {
                Some(constant) => {
                    let Gate::Product(factors) = &self.gates[term.gate as usize] else { unreachable!("has a constant factor") };
                    let mut factors: Vec<GateId> = factors.clone();
                    let at = factors.iter().position(|&f| f == constant).expect("is a factor");
                    let value = self.constant(constant).expect("is a constant");
                    let by = self.constants.integer(count.abs());
                    let product = self.constants.mul(by, value);
                    if let Some(gate) = self.push_constant(product) {
                        factors[at] = gate;
                    } else {
                        factors.remove(at);
                    }
                    let value = self.product_value(&factors);
                    let gate = if let [only] = factors[..] { only } else { self.push(Gate::Product(factors), value) };
                    merged.push(Edge::new(gate, negated));
                }
                None => merged.extend((0..count.abs()).map(|_| Edge::new(term.gate, negated))),
            }
        }
        let mut sum = ExprId::ZERO;
        for constant in constants {
            let value = self.constant(constant.gate).expect("is a constant").signed(constant.negated);
            sum = self.constants.add(sum, value);
        }
        if sum != ExprId::ZERO {
            let gate = self.push_constant_or_one(sum.unsigned());
            merged.push(Edge::new(gate, sum.is_negated()));
        }
        self.gates.set(id, Gate::Sum(merged));
        true
    }

    /// One constant a product.
    fn merge_factors(&mut self, id: GateId, factors: &[GateId]) -> bool {
        let (constants, mut others): (Vec<GateId>, Vec<GateId>) = factors.iter().partition(|&&f| self.constant(f).is_some());
        if constants.len() < 2 || others.is_empty() {
            return false;
        }
        let mut product = ExprId::ONE;
        for constant in constants {
            let value = self.constant(constant).expect("is a constant");
            product = self.constants.mul(product, value);
        }
        if product.is_negated() || !self.constants.is_constant(product) {
            return false;
        }
        others.extend(self.push_constant(product));
        let gate = if let [only] = others[..] { Gate::Sum(vec![Edge::new(only, false)]) } else { Gate::Product(others) };
        self.gates.set(id, gate);
        true
    }

    /// The value of a gate that is a constant, in the pool of constants.
    pub(super) fn constant(&self, gate: GateId) -> Option<ExprId> {
        match self.gates[gate as usize] {
            Gate::Leaf(expr) if self.constants.is_constant(expr) => Some(expr),
            _ => None,
        }
    }

    /// A gate for a constant that is not negative; none for 1.
    fn push_constant(&mut self, value: ExprId) -> Option<GateId> {
        (value != ExprId::ONE).then(|| self.push_constant_or_one(value))
    }

    pub(super) fn push_constant_or_one(&mut self, value: ExprId) -> GateId {
        self.leaf(value).unwrap_or_else(|| self.push(Gate::Leaf(value), self.constants.fingerprint(value)))
    }
}
