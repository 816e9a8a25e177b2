//! Gates whose contributions cancel in every output: dead code that only shows after cancellation.
//!
//! A sweep from the outputs inwards gives the derivative of a random combination of the outputs by every gate, in the prime field of the
//! fingerprints. Where it is 0 at both points, the gate is taken as 0, if all outputs then keep their values.

use super::circuit::{Circuit, Edge, Gate, GateId};
use crate::ring::Fingerprint;
use crate::scramble::scramble;

/// At most this many gates are removed from one function.
const MOST_REMOVED: usize = 200;

/// Removes the gates on which no output depends, and returns their number.
pub(super) fn remove_cancelled(circuit: &mut Circuit) -> usize {
    let expected: Vec<Fingerprint> = circuit.outputs.iter().map(|&output| circuit.value(output)).collect();
    let mut removed = 0;
    let mut kept: Vec<GateId> = Vec::new();
    while removed + kept.len() < MOST_REMOVED {
        let order = circuit.order();
        let derivatives = derivatives(circuit, &order);
        let zero = [circuit.field.zero(); 2];
        let cancelled = order.iter().rev().copied().find(|&gate| {
            let inner = !matches!(circuit.gates[gate as usize], Gate::Leaf(_));
            inner && derivatives[gate as usize] == zero && !kept.contains(&gate)
        });
        let Some(gate) = cancelled else { break };
        let (gates, values) = (circuit.gates.clone(), circuit.values.clone());
        circuit.gates.set(gate, Gate::Sum(Vec::new()));
        propagate_zeros(circuit, &order);
        if circuit.outputs.iter().map(|&output| circuit.value(output)).eq(expected.iter().copied()) {
            removed += 1;
        } else {
            (circuit.gates, circuit.values) = (gates, values);
            kept.push(gate);
        }
    }
    removed
}

/// The derivative of a random combination of the outputs by each gate, at both points.
fn derivatives(circuit: &Circuit, order: &[GateId]) -> Vec<Fingerprint> {
    let field = &circuit.field;
    let mut all = vec![[field.zero(); 2]; circuit.gates.len()];
    let add = |all: &mut Vec<Fingerprint>, gate: GateId, value: Fingerprint, negated: bool| {
        let value = if negated { value.map(|x| field.neg(x)) } else { value };
        all[gate as usize] = circuit.plus(&all[gate as usize], &value);
    };
    for (k, output) in circuit.outputs.iter().enumerate() {
        let weight = field.from_u64(scramble(k as u64 + 1));
        add(&mut all, output.gate, [weight; 2], output.negated);
    }
    for &gate in order.iter().rev() {
        let own = all[gate as usize];
        match &circuit.gates[gate as usize] {
            Gate::Leaf(_) => {}
            Gate::Sum(terms) => terms.iter().for_each(|t| add(&mut all, t.gate, own, t.negated)),
            Gate::Product(factors) => {
                for (k, &factor) in factors.iter().enumerate() {
                    let others: Vec<GateId> = factors.iter().enumerate().filter(|&(i, _)| i != k).map(|(_, &f)| f).collect();
                    add(&mut all, factor, circuit.times(&own, &circuit.product_value(&others)), false);
                }
            }
            Gate::Reciprocal(inner) => {
                let value = circuit.values[gate as usize];
                add(&mut all, *inner, circuit.times(&own, &circuit.times(&value, &value)), true);
            }
        }
    }
    all
}

/// Drops operands that have become 0 and recomputes all fingerprints.
fn propagate_zeros(circuit: &mut Circuit, order: &[GateId]) {
    let is_zero = |circuit: &Circuit, gate: GateId| matches!(&circuit.gates[gate as usize], Gate::Sum(terms) if terms.is_empty());
    for &gate in order {
        let (new, value) = match circuit.gates[gate as usize].clone() {
            Gate::Leaf(_) => continue,
            Gate::Sum(terms) => {
                let terms: Vec<Edge> = terms.into_iter().filter(|t| !is_zero(circuit, t.gate)).collect();
                let value = circuit.sum_value(&terms);
                (Gate::Sum(terms), value)
            }
            Gate::Product(factors) if factors.iter().any(|&f| is_zero(circuit, f)) => {
                (Gate::Sum(Vec::new()), [circuit.field.zero(); 2])
            }
            Gate::Product(factors) => {
                let value = circuit.product_value(&factors);
                (Gate::Product(factors), value)
            }
            Gate::Reciprocal(inner) => {
                let value = circuit.values[inner as usize].map(|x| circuit.field.inverse(x));
                (Gate::Reciprocal(inner), value)
            }
        };
        circuit.gates.set(gate, new);
        circuit.values[gate as usize] = value;
    }
}
