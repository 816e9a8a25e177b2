//! Sines and cosines of sums of angles, asked for as such.
//!
//! Where axes are parallel, a function needs sin(q2 + q3) beside, or instead of, sin(q3). By the addition theorem the pair costs six operations,
//! by its own argument one, and a function that needs no single angle any more for it evaluates as many sines as before. The
//! gates that have the value of a sum's sine or cosine are found by their fingerprints; a sum is taken if operations are saved and the pairs
//! of sine and cosine do not become more than that is worth.

use std::collections::BTreeSet;

use super::circuit::{Circuit, Edge, Gate, GateId};
use crate::ring::count::SINE_COSINE_COST;
use crate::ring::{Angle, AngleSum, Node};

/// A run of parallel axes with at most this many sums is tried in all combinations; in a longer one each sum is tried by itself.
const TOGETHER: usize = 6;

/// Gates that are a sine or a cosine of a sum, and the leaves that stand for them.
struct Found {
    replaced: Vec<(GateId, Edge)>,
    /// How many operations form the angle.
    operations: usize,
}

/// Replaces the sines and cosines of sums of angles about parallel axes; `parallel` has for each joint the one before it on such an axis, and
/// whether that points the other way. So are those of computed angles, which may be sums.
pub(super) fn sums_of_angles(circuit: &mut Circuit, parallel: &[Option<(u16, bool)>]) {
    let sums = |run: Vec<AngleSum>| run.into_iter().map(|sum| (Angle::Sum(sum), sum.additions())).collect();
    let mut runs: Vec<Vec<(Angle, usize)>> = runs(parallel).into_iter().map(sums).collect();
    let computed = circuit.field.computed().cloned();
    runs.extend(computed.map(|all| {
        let operations = |(mul, add): (usize, usize)| mul + add;
        all.all().map(|(index, angle)| (Angle::One(index), operations(angle.operations()))).collect()
    }));
    for run in runs {
        let found: Vec<Found> = run.into_iter().filter_map(|(angle, operations)| find(circuit, angle, operations)).collect();
        if found.len() <= TOGETHER {
            let chosen = (1usize..1 << found.len()).map(|set| chosen(&found, set)).min_by_key(|chosen| weight(circuit, chosen));
            if let Some(chosen) = chosen {
                take_if_cheaper(circuit, &chosen);
            }
        } else {
            found.iter().for_each(|one| take_if_cheaper(circuit, &[one]));
        }
    }
}

/// The sums of two and more angles of each run of parallel axes.
fn runs(parallel: &[Option<(u16, bool)>]) -> Vec<Vec<AngleSum>> {
    let mut runs: Vec<Vec<AngleSum>> = Vec::new();
    let mut of_joint: Vec<usize> = Vec::new();
    for (last, before) in parallel.iter().enumerate() {
        let Some((first, _)) = before else {
            of_joint.push(runs.len());
            runs.push(Vec::new());
            continue;
        };
        let run = of_joint[usize::from(*first)];
        of_joint.push(run);
        let (mut joint, mut minus) = (last as u16, false);
        let mut sum = AngleSum { plus: 0, minus: 0, turned: false };
        loop {
            *(if minus { &mut sum.minus } else { &mut sum.plus }) |= 1 << joint;
            if joint as usize != last {
                runs[run].push(sum.unsigned().0);
            }
            let Some((before, opposite)) = parallel[usize::from(joint)] else { break };
            minus ^= opposite;
            joint = before;
        }
    }
    runs
}

/// The gates that are the sine or the cosine of an angle.
fn find(circuit: &mut Circuit, angle: Angle, operations: usize) -> Option<Found> {
    let order = circuit.order();
    let mut replaced = Vec::new();
    for symbol in angle.circle() {
        let leaf = circuit.constants.input(symbol);
        let value = circuit.constants.fingerprint(leaf);
        let negative = value.map(|x| circuit.field.neg(x));
        let gates: Vec<(GateId, bool)> = order
            .iter()
            .filter(|&&gate| !matches!(circuit.gates[gate as usize], Gate::Leaf(_)))
            .filter_map(|&gate| {
                let of_gate = circuit.values[gate as usize];
                (of_gate == value || of_gate == negative).then_some((gate, of_gate == negative))
            })
            .collect();
        if !gates.is_empty() {
            let id = circuit.push(Gate::Leaf(leaf), value);
            replaced.extend(gates.into_iter().map(|(gate, negated)| (gate, Edge::new(id, negated))));
        }
    }
    (!replaced.is_empty()).then_some(Found { replaced, operations })
}

fn chosen(found: &[Found], set: usize) -> Vec<&Found> {
    found.iter().enumerate().filter(|(k, _)| set >> k & 1 == 1).map(|(_, one)| one).collect()
}

/// The cost of the circuit with some of the sums.
fn weight(circuit: &mut Circuit, chosen: &[&Found]) -> usize {
    let angles: usize = chosen.iter().map(|one| one.operations).sum();
    let mut weight = 0;
    circuit.attempt(|circuit| {
        take(circuit, chosen);
        weight = circuit.operations() + angles + SINE_COSINE_COST * pairs(circuit);
        false
    });
    weight
}

fn take_if_cheaper(circuit: &mut Circuit, chosen: &[&Found]) {
    if weight(circuit, chosen) < weight(circuit, &[]) {
        take(circuit, chosen);
    }
}

/// Replaces gates by the leaves of sums.
fn take(circuit: &mut Circuit, chosen: &[&Found]) {
    for &(gate, leaf) in chosen.iter().flat_map(|one| &one.replaced) {
        circuit.gates.set(gate, Gate::Sum(vec![leaf]));
    }
}

/// Pairs of sine and cosine that the outputs need.
fn pairs(circuit: &Circuit) -> usize {
    let uses = circuit.uses();
    let used = |gate: usize| uses[gate] > 0;
    let leaves = (0..circuit.gates.len()).filter(|&gate| used(gate)).filter_map(|gate| match circuit.gates[gate] {
        Gate::Leaf(expr) => match circuit.constants.node(expr) {
            Node::Symbol(symbol) => symbol.angle(),
            _ => None,
        },
        _ => None,
    });
    leaves.collect::<BTreeSet<Angle>>().len()
}
