//! Expressions as numbered steps: what is used more than once gets a name, what is used once is written where it is used, up to a length.

use std::collections::BTreeMap;

use super::Formulas;
use crate::derive::Derivation;
use crate::ring::print::{Notation, Printer};
use crate::ring::{ExprId, Node};

/// A step that is used once is written inside the one that uses it, up to so many operands.
const OPERANDS_IN_A_STEP: usize = 6;

/// How a text binds, from loose to tight.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Quotient,
    Whole,
}

#[derive(Clone)]
struct Text {
    text: String,
    operands: usize,
    binding: Binding,
}

impl Text {
    /// In parentheses if it binds more loosely than `least`.
    fn at_least(&self, least: Binding, notation: Notation) -> String {
        match (self.binding >= least, notation) {
            (true, _) => self.text.clone(),
            (false, Notation::Text) => format!("({})", self.text),
            (false, Notation::Latex) => format!("\\left({}\\right)", self.text),
        }
    }
}

/// The steps, named by a letter and counted from 1, each after those that it uses, and the entries.
pub(super) fn formulas(derivation: &Derivation, printer: &Printer<'_>, letter: &str) -> Formulas {
    let pool = &derivation.pool;
    let order = order(derivation);
    let mut uses: BTreeMap<usize, usize> = BTreeMap::new();
    for &expr in &order {
        operands(pool.node(expr)).iter().for_each(|e| *uses.entry(e.index()).or_default() += 1);
    }
    derivation.entries.iter().for_each(|e| *uses.entry(e.index()).or_default() += 1);

    let notation = printer.notation;
    let times = if notation == Notation::Text { "*" } else { "\\," };
    let mut steps: Vec<(String, String)> = Vec::new();
    let mut texts: BTreeMap<usize, Text> = BTreeMap::new();
    for expr in order {
        let of = |e: ExprId| &texts[&e.index()];
        let (text, count, binding) = match pool.node(expr) {
            Node::Constant(_) => {
                let number = pool.as_constant(expr).expect("a constant");
                let text = printer.number(&number);
                let binding = match (number.terms().count(), text.contains(['/', '*', '\\'])) {
                    (0 | 1, false) => Binding::Whole,
                    (0 | 1, true) => Binding::Product,
                    _ => Binding::Sum,
                };
                (text, 1, binding)
            }
            Node::Symbol(symbol) => (printer.symbol(symbol), 1, Binding::Whole),
            Node::Add(a, b) => {
                let (left, right) = (of(a), of(b));
                let sign = if b.is_negated() { '-' } else { '+' };
                let least = if b.is_negated() { Binding::Product } else { Binding::Sum };
                let text = format!("{} {sign} {}", left.text, right.at_least(least, notation));
                (text, left.operands + right.operands, Binding::Sum)
            }
            Node::Mul(a, b) => {
                let (left, right) = (of(a), of(b));
                let (l, r) = (left.at_least(Binding::Product, notation), right.at_least(Binding::Quotient, notation));
                (format!("{l}{times}{r}"), left.operands + right.operands, Binding::Product)
            }
            Node::Reciprocal(a) => {
                let of = of(a);
                match notation {
                    Notation::Text => (format!("1/{}", of.at_least(Binding::Whole, notation)), of.operands + 1, Binding::Product),
                    Notation::Latex => (format!("\\frac{{1}}{{{}}}", of.text), of.operands + 1, Binding::Quotient),
                }
            }
        };
        let leaf = operands(pool.node(expr)).is_empty();
        let text = if leaf || (uses[&expr.index()] == 1 && count <= OPERANDS_IN_A_STEP) {
            Text { text, operands: count, binding }
        } else {
            let name = match notation {
                Notation::Text => format!("{letter}{}", steps.len() + 1),
                Notation::Latex => format!("{letter}_{{{}}}", steps.len() + 1),
            };
            steps.push((name.clone(), text));
            Text { text: name, operands: 1, binding: Binding::Whole }
        };
        texts.insert(expr.index(), text);
    }
    let entries = derivation
        .entries
        .iter()
        .map(|&e| match (pool.as_constant(e), &texts[&e.index()]) {
            (Some(value), _) => printer.number(&value),
            (None, text) if e.is_negated() => format!("-{}", text.at_least(Binding::Product, notation)),
            (None, text) => text.text.clone(),
        })
        .collect();
    Formulas { steps, entries }
}

fn operands(node: Node) -> Vec<ExprId> {
    match node {
        Node::Constant(_) | Node::Symbol(_) => vec![],
        Node::Add(a, b) | Node::Mul(a, b) => vec![a, b],
        Node::Reciprocal(a) => vec![a],
    }
}

/// All nodes that the entries need, operands first, in the order in which the entries ask for them.
fn order(derivation: &Derivation) -> Vec<ExprId> {
    let mut done = vec![false; derivation.pool.len()];
    let mut order = Vec::new();
    for &entry in &derivation.entries {
        let mut stack = vec![(entry.unsigned(), false)];
        while let Some((expr, ready)) = stack.pop() {
            if done[expr.index()] {
                continue;
            }
            if ready {
                done[expr.index()] = true;
                order.push(expr);
            } else {
                stack.push((expr, true));
                stack.extend(operands(derivation.pool.node(expr)).iter().rev().map(|e| (e.unsigned(), false)));
            }
        }
    }
    order
}
