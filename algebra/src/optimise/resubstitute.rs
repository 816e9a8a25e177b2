//! Nodes from others that are there anyway.
//!
//! A gate whose removal frees several operations, its own and those of what only it needs, is tried as a + b, a - b and a b of any two gates
//! that do not depend on it: for each a, the fingerprint that b would need to have is looked up. What a and b need stays, and is not gained.

use std::cell::OnceCell;

use super::circuit::{Circuit, Edge, Gate, GateId};
use crate::ring::field::Element;
use crate::ring::Fingerprint;

/// Circuits with more gates than this are left alone: the work grows with the square.
const GATES: usize = 2000;

/// Replaces what it can; the number of operations saved.
pub(super) fn resubstitute(circuit: &mut Circuit) -> usize {
    let before = circuit.operations();
    let all = circuit.order();
    if all.len() > GATES {
        return 0;
    }
    circuit.index(&all);
    let zero = [circuit.field.zero(); 2];
    let inverses = inverses(circuit, &all);
    let (mut order, mut uses) = (all.clone(), circuit.uses());
    // Gates with the first halves of their values and inverses, those that are 0 left out.
    let firsts = |circuit: &Circuit, order: &[GateId]| -> Vec<(GateId, Element, Element)> {
        let values = order.iter().map(|&a| (a, circuit.values[a as usize], inverses[a as usize][0]));
        values.filter(|(_, value, _)| *value != zero).map(|(a, value, inverse)| (a, value[0], inverse)).collect()
    };
    let mut operands = firsts(circuit, &order);
    for &gate in all.iter().rev() {
        if uses[gate as usize] == 0 || circuit.cost(gate) == 0 {
            continue;
        }
        let freed = freed_with(circuit, &uses, gate);
        let total: usize = freed.iter().map(|&g| circuit.cost(g)).sum();
        if total < 2 {
            continue;
        }
        // Few offers gain anything, and only those ask for it.
        let above: OnceCell<Vec<bool>> = OnceCell::new();
        let mut best: Option<(usize, Gate)> = None;
        let value = circuit.values[gate as usize];
        for &(a, first, first_inverse) in &operands {
            let mut offer = |b: Option<Edge>, make: &dyn Fn(Edge) -> Gate| {
                let Some(b) = b.filter(|b| uses[b.gate as usize] > 0) else { return };
                let gain = total.saturating_sub(kept_for(circuit, &freed, &[a, b.gate]) + 1);
                if gain <= best.as_ref().map_or(0, |(most, _)| *most) {
                    return;
                }
                let above = above.get_or_init(|| circuit.above(&order, gate));
                if !above[a as usize] && !above[b.gate as usize] {
                    best = Some((gain, make(b)));
                }
            };
            let of_a = || circuit.values[a as usize];
            // Most values belong to no gate; the filter rejects them by their first half.
            if circuit.may_hold(circuit.field.sub(value[0], first)) {
                let minus_a = of_a().map(|x| circuit.field.neg(x));
                offer(circuit.find(&circuit.plus(&value, &minus_a)), &|b| Gate::Sum(vec![Edge::new(a, false), b]));
            }
            if circuit.may_hold(circuit.field.add(value[0], first)) {
                offer(circuit.find(&circuit.plus(&value, &of_a())), &|b| Gate::Sum(vec![Edge::new(a, true), b]));
            }
            if circuit.may_hold(circuit.field.mul(value[0], first_inverse)) {
                let quotient = circuit.times(&value, &inverses[a as usize]);
                offer(circuit.find(&quotient).filter(|b| !b.negated), &|b| Gate::Product(vec![a, b.gate]));
            }
        }
        if let Some((_, replacement)) = best {
            circuit.gates.set(gate, replacement);
            (order, uses) = (circuit.order(), circuit.uses());
            operands = firsts(circuit, &order);
        }
    }
    before - circuit.operations()
}

/// 1/value of each gate of a list, 0 for 0, by one inversion in all: products from the left, and back again.
fn inverses(circuit: &Circuit, gates: &[GateId]) -> Vec<Fingerprint> {
    let field = &circuit.field;
    let mut found = vec![[field.zero(); 2]; circuit.gates.len()];
    for point in 0..2 {
        let values = gates.iter().map(|&g| (g as usize, circuit.values[g as usize][point])).filter(|&(_, x)| x != field.zero());
        let values: Vec<(usize, Element)> = values.collect();
        let mut product = field.one();
        let mut before = Vec::with_capacity(values.len());
        for &(_, x) in &values {
            before.push(product);
            product = field.mul(product, x);
        }
        let mut inverse = field.inverse(product);
        for (&(gate, x), before) in values.iter().zip(before).rev() {
            found[gate][point] = field.mul(inverse, before);
            inverse = field.mul(inverse, x);
        }
    }
    found
}

/// The gate and those that only it needs.
fn freed_with(circuit: &Circuit, uses: &[u32], gate: GateId) -> Vec<GateId> {
    let mut left: std::collections::BTreeMap<GateId, u32> = std::collections::BTreeMap::new();
    let mut freed = vec![gate];
    let mut next = 0;
    while next < freed.len() {
        let mut found = Vec::new();
        circuit.each_operand(freed[next], |operand| {
            let count = left.entry(operand).or_insert(uses[operand as usize]);
            *count -= 1;
            if *count == 0 && circuit.cost(operand) > 0 {
                found.push(operand);
            }
        });
        freed.append(&mut found);
        next += 1;
    }
    freed
}

/// Operations among those that would be freed which these gates need.
fn kept_for(circuit: &Circuit, freed: &[GateId], gates: &[GateId]) -> usize {
    let mut kept: Vec<GateId> = Vec::new();
    for &gate in gates {
        if freed.contains(&gate) && !kept.contains(&gate) {
            kept.push(gate);
        }
    }
    let mut next = 0;
    while next < kept.len() {
        let mut found = Vec::new();
        circuit.each_operand(kept[next], |operand| {
            if freed.contains(&operand) && !kept.contains(&operand) && !found.contains(&operand) {
                found.push(operand);
            }
        });
        kept.append(&mut found);
        next += 1;
    }
    kept.iter().map(|&g| circuit.cost(g)).sum()
}
