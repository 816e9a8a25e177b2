//! Sums from other sums.
//!
//! Written out, a sum is a linear form: products and symbols with small integers before them, and a constant. Where another sum that is
//! there anyway holds much of it, it is that sum and what is missing. The plain pairs of `share` do not see this where terms would
//! have to cancel.

use super::circuit::{Circuit, Edge, Gate, GateId};
use crate::ring::ExprId;

/// Circuits with more gates than this are left alone: the work grows with the square.
const GATES: usize = 2000;

/// A sum, written out.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Form {
    /// Ascending by gate, none of them zero.
    terms: Vec<(GateId, i64)>,
    constant: ExprId,
}

/// Rewrites sums as long as that saves operations; the number of those saved.
pub(super) fn sums_from_sums(circuit: &mut Circuit) -> usize {
    let before = circuit.operations();
    let mut best = before;
    let mut order = circuit.order();
    if order.len() > GATES {
        return 0;
    }
    let mut forms = forms(circuit, &order);
    for target in order.clone().into_iter().rev() {
        if forms.get(target as usize).is_none_or(Option::is_none) {
            continue;
        }
        let Some(terms) = rewritten(circuit, &forms, &order, target) else { continue };
        let (gates, values) = (circuit.gates.clone(), circuit.values.len());
        circuit.gates[target as usize] = Gate::Sum(terms);
        circuit.tidy();
        let found = circuit.operations();
        if found < best {
            best = found;
            order = circuit.order();
            forms = self::forms(circuit, &order);
        } else {
            circuit.gates = gates;
            circuit.values.truncate(values);
        }
    }
    before - best
}

/// Every sum that is needed, written out, by gate.
fn forms(circuit: &mut Circuit, order: &[GateId]) -> Vec<Option<Form>> {
    let mut forms: Vec<Option<Form>> = vec![None; circuit.gates.len()];
    for &gate in order {
        let Gate::Sum(terms) = circuit.gates[gate as usize].clone() else { continue };
        let mut all: Vec<(GateId, i64)> = Vec::new();
        let mut constant = ExprId::ZERO;
        for term in terms {
            let sign = if term.negated { -1 } else { 1 };
            let (inner, part): (&[(GateId, i64)], ExprId) = match (circuit.constant(term.gate), &forms[term.gate as usize]) {
                (Some(constant), _) => (&[], constant),
                (None, Some(inner)) => (&inner.terms, inner.constant),
                (None, None) => (&[(term.gate, 1)], ExprId::ZERO),
            };
            all.extend(inner.iter().map(|&(g, k)| (g, sign * k)));
            constant = circuit.constants.add(constant, part.signed(term.negated));
        }
        all.sort_unstable();
        let mut merged: Vec<(GateId, i64)> = Vec::with_capacity(all.len());
        for (g, k) in all {
            match merged.last_mut() {
                Some((last, sum)) if *last == g => *sum += k,
                _ => merged.push((g, k)),
            }
        }
        merged.retain(|&(_, k)| k != 0);
        forms[gate as usize] = Some(Form { terms: merged, constant });
    }
    forms
}

/// A sum as other sums and what is missing, if that is shorter than it is.
fn rewritten(circuit: &mut Circuit, forms: &[Option<Form>], order: &[GateId], target: GateId) -> Option<Vec<Edge>> {
    let Gate::Sum(now) = &circuit.gates[target as usize] else { return None };
    let now = now.len();
    if now < 3 {
        return None;
    }
    let above = circuit.above(order, target);
    let form = forms[target as usize].as_ref()?;
    let mut rest = vec![0i64; forms.len()];
    form.terms.iter().for_each(|&(g, k)| rest[g as usize] = k);
    let mut constant = form.constant;
    let mut terms: Vec<Edge> = Vec::new();
    loop {
        let mut best: Option<(i64, GateId, i64)> = None;
        for &gate in order.iter().filter(|&&gate| !above[gate as usize]) {
            let Some(form) = &forms[gate as usize] else { continue };
            for sign in [1, -1] {
                let shorter = |g: GateId, k: i64| rest[g as usize].abs() - (rest[g as usize] - sign * k).abs();
                let mut gain: i64 = form.terms.iter().map(|&(g, k)| shorter(g, k)).sum::<i64>() - 1;
                if gain < 0 {
                    continue;
                }
                let difference_vanishes = constant == form.constant.signed(sign < 0);
                gain += i64::from(constant != ExprId::ZERO) - i64::from(!difference_vanishes);
                if gain > best.map_or(0, |(most, ..)| most) {
                    best = Some((gain, gate, sign));
                }
            }
        }
        let Some((_, gate, sign)) = best else { break };
        let form = forms[gate as usize].as_ref().expect("a sum");
        form.terms.iter().for_each(|&(g, k)| rest[g as usize] -= sign * k);
        constant = circuit.constants.sub(constant, form.constant.signed(sign < 0));
        terms.push(Edge::new(gate, sign < 0));
    }
    let left: i64 = rest.iter().map(|k| k.abs()).sum();
    if terms.is_empty() || terms.len() + left as usize + usize::from(constant != ExprId::ZERO) >= now {
        return None;
    }
    for (gate, &k) in rest.iter().enumerate() {
        terms.extend((0..k.abs()).map(|_| Edge::new(gate as GateId, k < 0)));
    }
    if constant != ExprId::ZERO {
        let gate = circuit.push_constant_or_one(constant.unsigned());
        terms.push(Edge::new(gate, constant.is_negated()));
    }
    Some(terms)
}
