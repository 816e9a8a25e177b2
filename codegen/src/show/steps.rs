//! Expressions as numbered steps: a subexpression used more than once gets a name; up to a certain length, a subexpression used
//! once is inlined.

use std::borrow::Cow;
use std::rc::Rc;

use super::Formulas;
use crate::derive::Derivation;
use crate::exact::Number;
use crate::ring::print::{Notation, Printer};
use crate::ring::{ExprId, Node};

/// A step that is used once is inlined into the step that uses it, up to this many operands.
const OPERANDS_IN_A_STEP: usize = 6;

/// A product: an exact coefficient, and factors as they are printed, with their powers.
#[derive(Clone)]
struct Term {
    coefficient: Rc<Number>,
    factors: Vec<(Rc<str>, i32)>,
}

/// Text of a node: a sum of products with equal terms collected, constants multiplied and signs absorbed.
#[derive(Clone)]
struct Text(Vec<Term>);

impl Text {
    fn constant(value: Number) -> Text {
        Text(if value.is_zero() { Vec::new() } else { vec![Term { coefficient: Rc::new(value), factors: Vec::new() }] })
    }

    fn factor(name: &str) -> Text {
        Text(vec![Term { coefficient: Rc::new(Number::one()), factors: vec![(name.into(), 1)] }])
    }

    /// How many operands it shows.
    fn operands(&self) -> usize {
        let of = |term: &Term| term.factors.len() + usize::from(!term.coefficient.is_one() || term.factors.is_empty());
        self.0.iter().map(of).sum()
    }

    fn signed(&self, negated: bool) -> Cow<'_, Text> {
        let of = |term: &Term| Term { coefficient: Rc::new(-&*term.coefficient), factors: term.factors.clone() };
        if negated {
            Cow::Owned(Text(self.0.iter().map(of).collect()))
        } else {
            Cow::Borrowed(self)
        }
    }

    /// The sum; terms with the same factors become one, and none if they cancel.
    fn plus(mut self, other: &Text) -> Text {
        for term in &other.0 {
            match self.0.iter_mut().find(|own| own.factors == term.factors) {
                Some(own) => *Rc::make_mut(&mut own.coefficient) += &term.coefficient,
                None => self.0.push(term.clone()),
            }
        }
        self.0.retain(|term| !term.coefficient.is_zero());
        self
    }

    /// The product of two that are products each; a sum is a factor in parentheses.
    fn times(&self, other: &Text, printer: &Printer<'_>) -> Text {
        let (Some(left), Some(right)) = (self.as_product(printer), other.as_product(printer)) else { return Text(Vec::new()) };
        let mut product = left;
        if product.coefficient.is_one() {
            product.coefficient = right.coefficient;
        } else if !right.coefficient.is_one() {
            product.coefficient = Rc::new(&*product.coefficient * &*right.coefficient);
        }
        for (name, power) in right.factors {
            match product.factors.iter_mut().find(|(own, _)| *own == name) {
                Some((_, own)) => *own += power,
                None => product.factors.push((name, power)),
            }
        }
        product.factors.retain(|(_, power)| *power != 0);
        Text(vec![product])
    }

    /// As one product; nothing for 0.
    fn as_product(&self, printer: &Printer<'_>) -> Option<Term> {
        match &self.0[..] {
            [] => None,
            [term] => Some(term.clone()),
            _ => Some(Term { coefficient: Rc::new(Number::one()), factors: vec![(self.in_parentheses(printer).into(), 1)] }),
        }
    }

    fn in_parentheses(&self, printer: &Printer<'_>) -> String {
        match printer.notation {
            Notation::Text => format!("({})", self.print(printer)),
            Notation::Latex => format!("\\left({}\\right)", self.print(printer)),
        }
    }

    /// One over it: a factor that is divided by.
    fn reciprocal(&self, printer: &Printer<'_>) -> Text {
        let name = match (&self.0[..], printer.notation) {
            ([Term { coefficient, factors }], _) if coefficient.is_one() && matches!(factors[..], [(_, 1)]) => {
                factors[0].0.clone()
            }
            (_, Notation::Text) => self.in_parentheses(printer).into(),
            (_, Notation::Latex) => self.print(printer).into(),
        };
        Text(vec![Term { coefficient: Rc::new(Number::one()), factors: vec![(name, -1)] }])
    }

    fn print(&self, printer: &Printer<'_>) -> String {
        printer.sum_of_products(self.0.iter().map(|term| (&*term.coefficient, &term.factors[..])))
    }
}

/// The steps, named by a letter and counted from 1, each after those that it uses, and the entries.
pub(super) fn formulas(derivation: &Derivation, printer: &Printer<'_>, letter: &str) -> Formulas {
    let pool = &derivation.pool;
    let order = order(derivation);
    let mut uses = vec![0usize; pool.len()];
    for &expr in &order {
        // t + t is written as 2 t, and uses t once.
        let mut used = operands(pool.node(expr)).into_iter().flatten().map(ExprId::index);
        let first = used.next();
        for index in first.into_iter().chain(used.filter(|&index| Some(index) != first)) {
            uses[index] += 1;
        }
    }
    derivation.entries.iter().for_each(|e| uses[e.index()] += 1);

    let mut steps: Vec<(String, String)> = Vec::new();
    let mut texts: Vec<Option<Text>> = vec![None; pool.len()];
    for expr in order {
        let of = |e: ExprId| texts[e.index()].as_ref().expect("operands come first").signed(e.is_negated());
        let node = pool.node(expr);
        let text = match node {
            Node::Constant(_) => Text::constant(pool.as_constant(expr).expect("a constant")),
            Node::Symbol(symbol) => Text::factor(&printer.symbol(symbol)),
            Node::Add(a, b) => of(a).into_owned().plus(&of(b)),
            Node::Mul(a, b) => of(a).times(&of(b), printer),
            Node::Reciprocal(a) => of(a).reciprocal(printer),
        };
        let leaf = matches!(node, Node::Constant(_) | Node::Symbol(_));
        let text = if leaf || (uses[expr.index()] == 1 && text.operands() <= OPERANDS_IN_A_STEP) {
            text
        } else {
            let name = match printer.notation {
                Notation::Text => format!("{letter}{}", steps.len() + 1),
                Notation::Latex => format!("{letter}_{{{}}}", steps.len() + 1),
            };
            let factor = Text::factor(&name);
            steps.push((name, text.print(printer)));
            factor
        };
        texts[expr.index()] = Some(text);
    }
    let entries = derivation
        .entries
        .iter()
        .map(|&e| match pool.as_constant(e) {
            Some(value) => printer.number(&value),
            None => texts[e.index()].as_ref().expect("entries are in the order").signed(e.is_negated()).print(printer),
        })
        .collect();
    Formulas { steps, entries }
}

fn operands(node: Node) -> [Option<ExprId>; 2] {
    match node {
        Node::Constant(_) | Node::Symbol(_) => [None; 2],
        Node::Add(a, b) | Node::Mul(a, b) => [Some(a), Some(b)],
        Node::Reciprocal(a) => [Some(a), None],
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
                let [first, second] = operands(derivation.pool.node(expr));
                stack.extend([second, first].into_iter().flatten().map(|e| (e.unsigned(), false)));
            }
        }
    }
    order
}
