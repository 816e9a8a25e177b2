//! Sums from other sums.
//!
//! Written out, a sum is a linear form: products and symbols with small integers before them, and a constant. Where another sum that is
//! there anyway holds much of it, it is that sum and what is missing. The plain pairs of `share` do not see this where terms would
//! have to cancel.

use super::circuit::{Circuit, Edge, Gate, GateId};
use super::share::share;
use crate::ring::ExprId;

/// Circuits with more gates than this are left alone: the work grows with the square.
const GATES: usize = 2000;

/// In circuits with more gates than this no sums are written out: pairs are shared anew for each.
const FEW_GATES: usize = 700;

/// A sum that is written out may become so much longer.
const LONGER: usize = 1;

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
        if keep_if_cheaper(circuit, &mut best, |circuit| {
            circuit.gates.set(target, Gate::Sum(terms));
            circuit.tidy()
        }) {
            order = circuit.order();
            forms = self::forms(circuit, &order);
        }
    }
    before - best
}

/// Writes out sums that become at most `LONGER` terms longer, shares pairs anew, and keeps what is cheaper; the number of operations saved.
///
/// Parts of the sums that a sum consists of may cancel or meet: a + b, with a = x + 2 y and b = z - x, is z + 2 y, and 2 y may be there anyway.
pub(super) fn write_out(circuit: &mut Circuit) -> usize {
    let before = circuit.operations();
    let mut best = before;
    let mut order = circuit.order();
    if order.len() > FEW_GATES {
        return 0;
    }
    let mut forms = forms(circuit, &order);
    for target in order.clone().into_iter().rev() {
        let Some(Some(form)) = forms.get(target as usize) else { continue };
        let Gate::Sum(now) = &circuit.gates[target as usize] else { continue };
        let length =
            form.terms.iter().map(|(_, k)| k.unsigned_abs() as usize).sum::<usize>() + usize::from(form.constant != ExprId::ZERO);
        let mut written: Vec<Edge> =
            form.terms.iter().flat_map(|&(gate, k)| (0..k.abs()).map(move |_| Edge::new(gate, k < 0))).collect();
        if length > now.len() + LONGER || now.len() < 3 || now.iter().all(|term| written.contains(term)) {
            continue;
        }
        let constant = form.constant;
        if keep_if_cheaper(circuit, &mut best, |circuit| {
            written.extend(constant_term(circuit, constant));
            circuit.gates.set(target, Gate::Sum(written));
            circuit.tidy();
            share(circuit)
        }) {
            order = circuit.order();
            forms = self::forms(circuit, &order);
        }
    }
    before - best
}

/// Forms a sum from another one that differs from it by a constant, where that saves operations; the number of those saved.
///
/// With a = x + y + 1, a + 2 and a - 3 one of the last two is x + y + 3 and the other one a constant away, if nothing else needs a.
pub(super) fn shift_constants(circuit: &mut Circuit) -> usize {
    let before = circuit.operations();
    let mut best = before;
    let mut order = circuit.order();
    if order.len() > GATES {
        return 0;
    }
    let mut forms = forms(circuit, &order);
    for target in order.clone() {
        let Some(Some(form)) = forms.get(target as usize).cloned() else { continue };
        let negative: Vec<(GateId, i64)> = form.terms.iter().map(|&(gate, k)| (gate, -k)).collect();
        let alike: Vec<(GateId, bool, ExprId)> = order
            .iter()
            .filter(|&&other| other != target)
            .filter_map(|&other| {
                let of_other = forms[other as usize].as_ref()?;
                let negated = of_other.terms == negative;
                (negated || of_other.terms == form.terms).then_some((other, negated, of_other.constant))
            })
            .collect();
        if alike.is_empty() {
            continue;
        }
        let above = circuit.above(&order, target);
        for (other, negated, constant) in alike {
            if above[other as usize] {
                continue;
            }
            let difference = circuit.constants.sub(form.constant, constant.signed(negated));
            if keep_if_cheaper(circuit, &mut best, |circuit| {
                let sum = [Edge::new(other, negated)].into_iter().chain(constant_term(circuit, difference)).collect();
                circuit.gates.set(target, Gate::Sum(sum));
                circuit.tidy()
            }) {
                order = circuit.order();
                forms = self::forms(circuit, &order);
                break;
            }
        }
    }
    before - best
}

/// Changes the circuit, and takes the change back unless it has fewer operations than the best so far. The change gives how often each gate is
/// used after it.
fn keep_if_cheaper(circuit: &mut Circuit, best: &mut usize, change: impl FnOnce(&mut Circuit) -> Vec<u32>) -> bool {
    circuit.attempt(|circuit| {
        let uses = change(circuit);
        let found = circuit.operations_of(&uses);
        let cheaper = found < *best;
        *best = found.min(*best);
        cheaper
    })
}

/// A constant as a term of a sum; none for 0.
fn constant_term(circuit: &mut Circuit, constant: ExprId) -> Option<Edge> {
    (constant != ExprId::ZERO).then(|| Edge::new(circuit.push_constant_or_one(constant.unsigned()), constant.is_negated()))
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
    terms.extend(constant_term(circuit, constant));
    Some(terms)
}
