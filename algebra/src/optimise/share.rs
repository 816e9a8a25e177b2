//! Common factors of a sum, pairs of terms of several sums, pairs of factors of several products.

use super::circuit::{Circuit, Edge, Gate, GateId};

/// A step that saves operations.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Step {
    /// Two terms, with the sign of the second relative to the first.
    Terms(GateId, GateId, bool),
    /// Two factors.
    Factors(GateId, GateId),
    /// A factor of several terms of a sum.
    Factor(GateId, GateId),
}

/// A step, what it saves, and the sums or products that it changes.
struct Candidate {
    step: Step,
    gain: usize,
    users: Vec<GateId>,
}

/// Does what saves most, as long as anything saves: in each round all steps of the greatest saving that do not touch each other; how
/// often each gate is used then.
pub(super) fn share(circuit: &mut Circuit) -> Vec<u32> {
    let mut uses = circuit.uses();
    loop {
        let candidates = candidates(circuit, &uses);
        let Some(most) = candidates.iter().map(|candidate| candidate.gain).max() else { return uses };
        let mut touched = vec![false; circuit.gates.len()];
        for Candidate { step, users, .. } in candidates.into_iter().filter(|candidate| candidate.gain == most) {
            if users.iter().any(|&user| touched[user as usize]) {
                continue;
            }
            users.iter().for_each(|&user| touched[user as usize] = true);
            match step {
                Step::Terms(a, b, negated) => share_terms(circuit, &users, a, b, negated),
                Step::Factors(a, b) => share_factors(circuit, &users, a, b),
                Step::Factor(sum, factor) => take_factor(circuit, &uses, sum, factor),
            }
        }
        uses = circuit.flatten();
    }
}

/// Two operands, with the sign of the second relative to the first.
type Pair = (GateId, GateId, bool);

/// All steps that save something, in a fixed order.
fn candidates(circuit: &Circuit, uses: &[u32]) -> Vec<Candidate> {
    // Pairs of a sum or product, with their number in it.
    let mut terms: Vec<(Pair, GateId, usize)> = Vec::new();
    let mut factors: Vec<(Pair, GateId, usize)> = Vec::new();
    let mut all: Vec<Candidate> = Vec::new();
    for (id, gate) in circuit.gates.iter().enumerate().filter(|&(id, _)| uses[id] > 0) {
        let id = id as GateId;
        match gate {
            Gate::Sum(list) => {
                pairs_apart(list.iter().copied(), |pair, count| terms.push((pair, id, count)));
                let mut common: Vec<(GateId, GateId)> = Vec::new();
                for term in list.iter().filter(|t| uses[t.gate as usize] == 1) {
                    if let Gate::Product(list) = &circuit.gates[term.gate as usize] {
                        let once = list.iter().enumerate().filter(|&(k, factor)| !list[..k].contains(factor));
                        common.extend(once.map(|(_, &factor)| (factor, term.gate)));
                    }
                }
                common.sort_by_key(|&(factor, _)| factor);
                for of_factor in common.chunk_by(|a, b| a.0 == b.0).filter(|of_factor| of_factor.len() > 1) {
                    let users = of_factor.iter().map(|&(_, term)| term).chain([id]).collect();
                    all.push(Candidate { step: Step::Factor(id, of_factor[0].0), gain: of_factor.len() - 1, users });
                }
            }
            Gate::Product(list) => {
                pairs_apart(list.iter().map(|&factor| Edge::new(factor, false)), |pair, count| factors.push((pair, id, count)));
            }
            Gate::Leaf(_) | Gate::Reciprocal(_) => {}
        }
    }
    let mut offer = |mut pairs: Vec<(Pair, GateId, usize)>, step: fn(Pair) -> Step| {
        pairs.sort_unstable();
        for of_pair in pairs.chunk_by(|a, b| a.0 == b.0) {
            let count: usize = of_pair.iter().map(|(_, _, count)| count).sum();
            if count > 1 {
                let users = of_pair.iter().map(|&(_, user, _)| user).collect();
                all.push(Candidate { step: step(of_pair[0].0), gain: count - 1, users });
            }
        }
    };
    offer(terms, |(a, b, negated)| Step::Terms(a, b, negated));
    offer(factors, |(a, b, _)| Step::Factors(a, b));
    all
}

/// Tells how often each pair of operands, of one sign or of two, occurs in a list without sharing an operand with another: what is counted here
/// is saved, so that the sharing ends.
fn pairs_apart(list: impl Iterator<Item = Edge>, mut tell: impl FnMut(Pair, usize)) {
    let mut edges: Vec<Edge> = list.collect();
    edges.sort_unstable();
    // How often each operand stands there without and with a sign.
    let counts = edges.chunk_by(|a, b| a.gate == b.gate).map(|all| {
        let minus = all.iter().filter(|edge| edge.negated).count();
        (all[0].gate, [all.len() - minus, minus])
    });
    let counts: Vec<(GateId, [usize; 2])> = counts.collect();
    let mut tell = |pair, count| {
        if count > 0 {
            tell(pair, count);
        }
    };
    for (k, &(a, [plus, minus])) in counts.iter().enumerate() {
        tell((a, a, false), plus / 2 + minus / 2);
        tell((a, a, true), plus.min(minus));
        for &(b, [other_plus, other_minus]) in &counts[k + 1..] {
            tell((a, b, false), plus.min(other_plus) + minus.min(other_minus));
            tell((a, b, true), plus.min(other_minus) + minus.min(other_plus));
        }
    }
}

fn pair(a: Edge, b: Edge) -> Pair {
    (a.gate.min(b.gate), a.gate.max(b.gate), a.negated != b.negated)
}

fn share_terms(circuit: &mut Circuit, users: &[GateId], a: GateId, b: GateId, negated: bool) {
    let parts = vec![Edge::new(a, false), Edge::new(b, negated)];
    let value = circuit.sum_value(&parts);
    // The sum may be a gate that is needed anyway, or one under another guise.
    let is_pair = |list: &[Edge]| list.len() == 2 && pair(list[0], list[1]) == (a, b, negated);
    let whole = users.iter().copied().find(|&id| matches!(&circuit.gates[id as usize], Gate::Sum(list) if is_pair(list)));
    let shared = match whole {
        Some(id) => {
            let Gate::Sum(list) = &circuit.gates[id as usize] else { unreachable!("found as a sum") };
            let first = list.iter().find(|t| t.gate == a).expect("holds the pair");
            Edge::new(id, first.negated)
        }
        None => Edge::new(circuit.push(Gate::Sum(parts), value), false),
    };
    for &id in users.iter().filter(|&&id| id != shared.gate) {
        let Gate::Sum(list) = &circuit.gates[id as usize] else { continue };
        let mut list = list.clone();
        while let Some((i, j)) = positions(&list, a, b, negated) {
            let first = if list[i].gate == a { list[i] } else { list[j] };
            list.remove(j);
            list[i] = shared.flipped(first.negated);
        }
        circuit.gates.set(id, Gate::Sum(list));
    }
}

fn positions(list: &[Edge], a: GateId, b: GateId, negated: bool) -> Option<(usize, usize)> {
    (0..list.len()).find_map(|i| (i + 1..list.len()).find(|&j| pair(list[i], list[j]) == (a, b, negated)).map(|j| (i, j)))
}

fn share_factors(circuit: &mut Circuit, users: &[GateId], a: GateId, b: GateId) {
    let is_pair = |list: &[GateId]| list.len() == 2 && (list[0].min(list[1]), list[0].max(list[1])) == (a, b);
    let whole = users.iter().copied().find(|&id| matches!(&circuit.gates[id as usize], Gate::Product(list) if is_pair(list)));
    let shared = match whole {
        Some(id) => id,
        None => {
            let value = circuit.product_value(&[a, b]);
            circuit.push(Gate::Product(vec![a, b]), value)
        }
    };
    for &id in users.iter().filter(|&&id| id != shared) {
        let Gate::Product(list) = &circuit.gates[id as usize] else { continue };
        let mut list = list.clone();
        while let Some(i) = list.iter().position(|&f| f == a) {
            let Some(j) = (0..list.len()).find(|&j| j != i && list[j] == b) else { break };
            list[i] = shared;
            list.remove(j);
        }
        // A factor that is left alone is no product.
        let gate = if let [only] = list[..] { Gate::Sum(vec![Edge::new(only, false)]) } else { Gate::Product(list) };
        circuit.gates.set(id, gate);
    }
}

fn take_factor(circuit: &mut Circuit, uses: &[u32], sum: GateId, factor: GateId) {
    let Gate::Sum(list) = circuit.gates[sum as usize].clone() else { unreachable!("offered as a sum") };
    let mut rest = Vec::new();
    let mut inner = Vec::new();
    for term in list {
        let cofactor = match &circuit.gates[term.gate as usize] {
            Gate::Product(factors) if uses[term.gate as usize] == 1 => factors.iter().position(|&f| f == factor).map(|i| {
                let mut left = factors.clone();
                left.remove(i);
                left
            }),
            _ => None,
        };
        match cofactor {
            None => rest.push(term),
            Some(left) => {
                let gate = if let [only] = left[..] {
                    only
                } else {
                    let value = circuit.product_value(&left);
                    circuit.push(Gate::Product(left), value)
                };
                inner.push(Edge::new(gate, term.negated));
            }
        }
    }
    // The first term positive, so that equal sums look alike.
    let flip = inner[0].negated;
    let inner: Vec<Edge> = inner.into_iter().map(|t| t.flipped(flip)).collect();
    let value = circuit.sum_value(&inner);
    let inner = circuit.push(Gate::Sum(inner), value);
    let product = vec![factor, inner];
    if rest.is_empty() && !flip {
        circuit.gates.set(sum, Gate::Product(product));
        return;
    }
    let value = circuit.product_value(&product);
    let product = circuit.push(Gate::Product(product), value);
    rest.push(Edge::new(product, flip));
    circuit.gates.set(sum, Gate::Sum(rest));
}

#[cfg(test)]
mod tests {
    use super::super::Rewrite;
    use super::*;
    use crate::ring::field::Field;
    use crate::ring::{Pool, Symbol};

    #[test]
    fn a_product_that_is_another_one_is_no_product_of_its_own() {
        let mut pool = Pool::new(Field::for_constants([]));
        let [a, b, c, d, e, x] = [0, 1, 2, 3, 4, 5].map(|i| pool.symbol(Symbol::Rate(i)));
        let ab = pool.mul(a, b);
        let (xa, xe) = (pool.mul(x, a), pool.mul(x, e));
        let xea = pool.mul(xe, a);
        let terms = [pool.mul(xa, b), pool.mul(xea, b), pool.mul(c, x), pool.mul(d, x)];
        let sum = pool.sum(terms);
        let without = [Rewrite::AngleSums, Rewrite::Cancellation, Rewrite::Sums, Rewrite::Resubstitution];
        // a b and x (a b (1 + e) + c + d): six operations.
        let (pool, entries) = super::super::optimise(&pool, &[ab, sum], &[], &without).expect("few gates");
        assert_eq!(pool.operations(&entries, 1), 6);
    }

    #[test]
    fn a_pair_counts_as_often_as_it_can_be_taken() {
        let list = |terms: &[(GateId, bool)]| terms.iter().map(|&(gate, negated)| Edge::new(gate, negated)).collect::<Vec<_>>();
        let count = |terms: &[(GateId, bool)], pair: (GateId, GateId, bool)| {
            let mut found = 0;
            pairs_apart(list(terms).into_iter(), |p, count| found += if p == pair { count } else { 0 });
            found
        };
        // a b^4: one of a and b, two of b and b. Two of the first would be shared and taken apart for ever.
        let power = [(1, false), (2, false), (2, false), (2, false), (2, false)];
        assert_eq!([count(&power, (1, 2, false)), count(&power, (2, 2, false)), count(&power, (1, 2, true))], [1, 2, 0]);
        let signs = [(1, false), (1, true), (1, false), (2, true), (2, false), (2, true)];
        assert_eq!([count(&signs, (1, 2, false)), count(&signs, (1, 2, true)), count(&signs, (1, 1, true))], [2, 3, 1]);
    }
}
