//! Sums and products of any number of operands.

use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use std::ops::Deref;

use crate::ring::field::{Element, Field};
use crate::ring::{ExprId, Fingerprint, FingerprintHasher, Node, Pool, Symbol};

/// Index of a gate.
pub(super) type GateId = u32;

/// Bits of the Bloom filter over `known`.
const FILTER_BITS: usize = 1 << 16;

/// A gate and a sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Edge {
    pub(super) gate: GateId,
    pub(super) negated: bool,
}

/// What a gate computes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Gate {
    /// A constant or a symbol of the pool.
    Leaf(ExprId),
    /// The sum of the terms.
    Sum(Vec<Edge>),
    /// The product of the factors.
    Product(Vec<GateId>),
    /// One over the operand.
    Reciprocal(GateId),
}

/// Gates, and while a change of them is tried, those that it has replaced.
#[derive(Clone, Default)]
pub(super) struct Gates {
    all: Vec<Gate>,
    replaced: Option<Vec<(GateId, Gate)>>,
}

impl Gates {
    pub(super) fn set(&mut self, id: GateId, gate: Gate) {
        let before = std::mem::replace(&mut self.all[id as usize], gate);
        if let Some(replaced) = &mut self.replaced {
            replaced.push((id, before));
        }
    }
}

impl Deref for Gates {
    type Target = [Gate];

    fn deref(&self) -> &[Gate] {
        &self.all
    }
}

/// Gates and outputs. Gates that no output needs any more stay, and count for nothing.
pub(super) struct Circuit {
    pub(super) field: Field,
    /// The pool that the leaves are of, with the constants that merging brings.
    pub(super) constants: Pool,
    pub(super) gates: Gates,
    pub(super) values: Vec<Fingerprint>,
    pub(super) outputs: Vec<Edge>,
    /// The gate of a value or of its negative, by the lesser of the two, and whether that is the negative.
    known: HashMap<Fingerprint, Edge, BuildHasherDefault<FingerprintHasher>>,
    /// Bloom filter over `known` and the negatives of its values, by their last bits: it rejects most lookups.
    filter: Vec<u64>,
    /// The first gate of each constant and symbol.
    leaves: HashMap<ExprId, GateId>,
}

/// What stands for a factor in the product that takes it in.
enum Inner<'a> {
    Product(&'a [GateId]),
    Other(GateId),
}

impl Edge {
    pub(super) fn new(gate: GateId, negated: bool) -> Edge {
        Edge { gate, negated }
    }

    pub(super) fn flipped(self, flip: bool) -> Edge {
        Edge { negated: self.negated != flip, ..self }
    }
}

impl Circuit {
    /// The circuit of expressions.
    pub(super) fn of(pool: &Pool, entries: &[ExprId]) -> Circuit {
        let mut circuit = Circuit {
            field: pool.field().clone(),
            constants: pool.clone(),
            gates: Gates::default(),
            values: Vec::new(),
            outputs: Vec::new(),
            known: HashMap::default(),
            filter: vec![0; FILTER_BITS / 64],
            leaves: HashMap::new(),
        };
        let needed = pool.reachable(entries);
        let mut ids: HashMap<usize, GateId> = HashMap::new();
        for index in (0..pool.len()).filter(|&i| needed[i]) {
            let expr = pool.expr(index);
            let edge = |e: ExprId| Edge::new(ids[&e.index()], e.is_negated());
            let gate = match pool.node(expr) {
                Node::Constant(_) | Node::Symbol(_) => Gate::Leaf(expr),
                Node::Add(a, b) => Gate::Sum(vec![edge(a), edge(b)]),
                Node::Mul(a, b) => Gate::Product(vec![edge(a).gate, edge(b).gate]),
                Node::Reciprocal(a) => Gate::Reciprocal(edge(a).gate),
            };
            let id = circuit.push(gate, pool.fingerprint(expr));
            ids.insert(index, id);
        }
        circuit.outputs = entries.iter().map(|e| Edge::new(ids[&e.index()], e.is_negated())).collect();
        circuit
    }

    /// A new gate.
    pub(super) fn push(&mut self, gate: Gate, value: Fingerprint) -> GateId {
        let id = self.gates.len() as GateId;
        if let Gate::Leaf(expr) = gate {
            if self.leaf(expr).is_none() {
                self.leaves.insert(expr, id);
            }
        }
        self.gates.all.push(gate);
        self.values.push(value);
        id
    }

    /// The gate of a constant or a symbol, if there is one: a trial that was taken back has removed those that it had added.
    pub(super) fn leaf(&self, expr: ExprId) -> Option<GateId> {
        self.leaves.get(&expr).copied().filter(|&id| self.gates.get(id as usize) == Some(&Gate::Leaf(expr)))
    }

    /// Indexes these gates by value, for `find`.
    pub(super) fn index(&mut self, gates: &[GateId]) {
        self.known.clear();
        self.filter.fill(0);
        for &gate in gates {
            let value = self.values[gate as usize][0];
            for bit in [value, self.field.neg(value)].map(|x| x.bits() as usize % FILTER_BITS) {
                self.filter[bit / 64] |= 1 << (bit % 64);
            }
            let (key, negated) = self.field.size(self.values[gate as usize]);
            self.known.entry(key).or_insert(Edge { gate, negated });
        }
    }

    /// Whether a gate may have a value with this first half, or its negative; if not, none has.
    #[inline]
    pub(super) fn may_hold(&self, first: Element) -> bool {
        let bit = first.bits() as usize % FILTER_BITS;
        self.filter[bit / 64] >> (bit % 64) & 1 == 1
    }

    /// The gate of a value, with the sign that it is found by.
    pub(super) fn find(&self, value: &Fingerprint) -> Option<Edge> {
        let (key, negated) = self.field.size(*value);
        self.known.get(&key).map(|edge| edge.flipped(negated))
    }

    pub(super) fn value(&self, edge: Edge) -> Fingerprint {
        let value = self.values[edge.gate as usize];
        if edge.negated {
            value.map(|x| self.field.neg(x))
        } else {
            value
        }
    }

    fn combine(&self, a: &Fingerprint, b: &Fingerprint, with: impl Fn(&Field, Element, Element) -> Element) -> Fingerprint {
        [with(&self.field, a[0], b[0]), with(&self.field, a[1], b[1])]
    }

    pub(super) fn plus(&self, a: &Fingerprint, b: &Fingerprint) -> Fingerprint {
        self.combine(a, b, Field::add)
    }

    pub(super) fn times(&self, a: &Fingerprint, b: &Fingerprint) -> Fingerprint {
        self.combine(a, b, Field::mul)
    }

    pub(super) fn sum_value(&self, terms: &[Edge]) -> Fingerprint {
        let zero = [self.field.zero(); 2];
        terms.iter().fold(zero, |sum, &term| self.plus(&sum, &self.value(term)))
    }

    pub(super) fn product_value(&self, factors: &[GateId]) -> Fingerprint {
        let one = [self.field.one(); 2];
        factors.iter().fold(one, |product, &factor| self.times(&product, &self.values[factor as usize]))
    }

    /// Does something with each operand of a gate.
    pub(super) fn each_operand(&self, gate: GateId, mut visit: impl FnMut(GateId)) {
        match &self.gates[gate as usize] {
            Gate::Leaf(_) => {}
            Gate::Sum(terms) => terms.iter().for_each(|t| visit(t.gate)),
            Gate::Product(factors) => factors.iter().for_each(|&f| visit(f)),
            Gate::Reciprocal(a) => visit(*a),
        }
    }

    /// How often each gate is an operand or an output, counting only gates that the outputs need.
    pub(super) fn uses(&self) -> Vec<u32> {
        let mut uses = vec![0u32; self.gates.len()];
        let mut stack: Vec<GateId> = Vec::new();
        for output in &self.outputs {
            uses[output.gate as usize] += 1;
            if uses[output.gate as usize] == 1 {
                stack.push(output.gate);
            }
        }
        while let Some(gate) = stack.pop() {
            self.each_operand(gate, |operand| {
                uses[operand as usize] += 1;
                if uses[operand as usize] == 1 {
                    stack.push(operand);
                }
            });
        }
        uses
    }

    /// Makes a change, and takes it back unless it says of itself that it is to stay; the same is returned.
    pub(super) fn attempt(&mut self, change: impl FnOnce(&mut Circuit) -> bool) -> bool {
        let gates = self.gates.len();
        debug_assert!(self.gates.replaced.is_none(), "one change is tried at a time");
        self.gates.replaced = Some(Vec::new());
        let kept = change(self);
        let replaced = self.gates.replaced.take().unwrap_or_default();
        if !kept {
            for (id, before) in replaced.into_iter().rev() {
                self.gates.all[id as usize] = before;
            }
            self.gates.all.truncate(gates);
            self.values.truncate(gates);
        }
        kept
    }

    /// Operations: k - 1 of a sum or product of k, one of a reciprocal.
    pub(super) fn operations(&self) -> usize {
        self.operations_of(&self.uses())
    }

    /// The same where the uses are known.
    pub(super) fn operations_of(&self, uses: &[u32]) -> usize {
        (0..self.gates.len()).filter(|&i| uses[i] > 0).map(|i| self.cost(i as GateId)).sum()
    }

    pub(super) fn cost(&self, gate: GateId) -> usize {
        match &self.gates[gate as usize] {
            Gate::Leaf(_) => 0,
            Gate::Sum(terms) => terms.len().saturating_sub(1),
            Gate::Product(factors) => factors.len() - 1,
            Gate::Reciprocal(_) => 1,
        }
    }

    /// Takes sums of one use into the sums that use them, and products into products; how often each gate is used then.
    pub(super) fn flatten(&mut self) -> Vec<u32> {
        loop {
            let uses = self.uses();
            let mut changed = false;
            for id in 0..self.gates.len() {
                if uses[id] == 0 {
                    continue;
                }
                // Most gates hold nothing that is taken in.
                let flat = match &self.gates[id] {
                    Gate::Sum(terms) if terms.iter().any(|t| self.inner_sum(t.gate, &uses).is_some()) => {
                        let mut flat: Vec<Edge> = Vec::with_capacity(terms.len() + 1);
                        for &term in terms {
                            match self.inner_sum(term.gate, &uses) {
                                Some(inner) => flat.extend(inner.iter().map(|t| t.flipped(term.negated))),
                                None => flat.push(term),
                            }
                        }
                        Gate::Sum(flat)
                    }
                    Gate::Product(factors) if factors.iter().any(|&f| self.inner_product(f, &uses).is_some()) => {
                        let mut flat: Vec<GateId> = Vec::with_capacity(factors.len() + 1);
                        for &factor in factors {
                            match self.inner_product(factor, &uses) {
                                Some(Inner::Product(inner)) => flat.extend(inner),
                                Some(Inner::Other(gate)) => flat.push(gate),
                                None => flat.push(factor),
                            }
                        }
                        Gate::Product(flat)
                    }
                    _ => continue,
                };
                self.gates.set(id as GateId, flat);
                changed = true;
            }
            if !changed {
                return uses;
            }
        }
    }

    /// The terms of a gate that a sum takes in.
    fn inner_sum(&self, gate: GateId, uses: &[u32]) -> Option<&[Edge]> {
        match &self.gates[gate as usize] {
            Gate::Sum(inner) if uses[gate as usize] == 1 || inner.len() == 1 => Some(inner),
            _ => None,
        }
    }

    /// What a product takes in for a gate.
    fn inner_product(&self, gate: GateId, uses: &[u32]) -> Option<Inner<'_>> {
        match &self.gates[gate as usize] {
            Gate::Product(inner) if uses[gate as usize] == 1 => Some(Inner::Product(inner)),
            Gate::Sum(inner) if inner.len() == 1 && !inner[0].negated => Some(Inner::Other(inner[0].gate)),
            _ => None,
        }
    }

    /// The gates that the outputs need, each after its operands.
    pub(super) fn order(&self) -> Vec<GateId> {
        let mut order = Vec::new();
        let mut done = vec![false; self.gates.len()];
        for output in &self.outputs {
            let mut stack = vec![(output.gate, false)];
            while let Some((gate, ready)) = stack.pop() {
                if done[gate as usize] {
                    continue;
                }
                if ready {
                    done[gate as usize] = true;
                    order.push(gate);
                } else {
                    stack.push((gate, true));
                    let from = stack.len();
                    self.each_operand(gate, |operand| stack.push((operand, false)));
                    stack[from..].reverse();
                }
            }
        }
        order
    }

    /// The expressions of the outputs, in a new pool.
    pub(super) fn to_pool(&self) -> (Pool, Vec<ExprId>) {
        let from = &self.constants;
        let mut pool = Pool::new(self.field.clone());
        let mut built: HashMap<GateId, ExprId> = HashMap::new();
        let order = self.order();
        // Sines of sums of angles first: nothing that is formed from those of single angles shall stand for them.
        for &gate in &order {
            let Gate::Leaf(expr) = self.gates[gate as usize] else { continue };
            if let Node::Symbol(symbol @ (Symbol::SineOf(_) | Symbol::CosineOf(_))) = from.node(expr) {
                pool.symbol(symbol);
            }
        }
        for gate in order {
            let expr = match &self.gates[gate as usize] {
                Gate::Leaf(expr) => match from.node(*expr) {
                    Node::Symbol(symbol) => pool.symbol(symbol),
                    _ => pool.constant_of(from, *expr),
                },
                Gate::Sum(terms) => {
                    let terms: Vec<ExprId> = terms.iter().map(|t| built[&t.gate].signed(t.negated)).collect();
                    pool.sum(terms)
                }
                Gate::Product(factors) => {
                    let mut factors: Vec<ExprId> = factors.iter().map(|f| built[f]).collect();
                    // A constant comes last, so that what it multiplies is formed alone.
                    factors.sort_by_key(|&f| pool.is_constant(f));
                    factors.into_iter().reduce(|a, b| pool.mul(a, b)).expect("a product has factors")
                }
                Gate::Reciprocal(a) => pool.reciprocal(built[a]),
            };
            built.insert(gate, expr);
        }
        let outputs = self.outputs.iter().map(|o| built[&o.gate].signed(o.negated)).collect();
        (pool, outputs)
    }

    /// Which gates depend on one, itself included; `order` has each gate after its operands.
    pub(super) fn above(&self, order: &[GateId], gate: GateId) -> Vec<bool> {
        let mut above = vec![false; self.gates.len()];
        above[gate as usize] = true;
        let own = order.iter().position(|&other| other == gate).unwrap_or(0);
        for &other in &order[own..] {
            let mut depends = above[other as usize];
            self.each_operand(other, |operand| depends |= above[operand as usize]);
            above[other as usize] = depends;
        }
        above
    }
}
