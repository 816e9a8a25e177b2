//! From the entries of an item to its matrices, each in a form: closed, or in steps.

use std::sync::OnceLock;

use armgen_algebra::optimise::optimise;

use super::derived::{Derived, Factored};
use super::item::DETERMINANT;
use super::{Content, Form, Item, Shown, Style};
use crate::catalogue::{Length, Quantity, ResultPart, Typeset};
use crate::derive::derivation::Derivation;
use crate::derive::determinant::Factor;
use crate::ring::normal_form::NormalForm;
use crate::ring::{AngleSum, ExprId, Pool, Symbol};
use crate::Model;

impl Derived {
    /// The matrices of the item that it was derived for.
    pub(super) fn shown(self, model: &Model, item: Item, style: Style) -> Vec<Shown> {
        let parameters = match item {
            Item::With(_) => model.parameters.entries.iter().map(|entry| entry.name.clone()).collect(),
            _ => model.manipulator.parameters.iter().map(|parameter| parameter.name.clone()).collect(),
        };
        let names = Names { parameters, style };
        match item {
            Item::Determinant => vec![determinant(model, self, &names)],
            Item::Plain(quantity) => parts(model, quantity, quantity.name, self.derivation, &names),
            Item::Element(quantity, i) => {
                let all = parts(model, quantity, quantity.name, self.derivation, &names);
                all.into_iter().skip(i).take(1).collect()
            }
            Item::With(quantity) => parts(model, quantity, &quantity.function_name(true), self.derivation, &names),
        }
    }
}

/// What symbols are called, and how quantities are shown.
struct Names {
    parameters: Vec<String>,
    style: Style,
}

/// The matrices of a quantity: of each part of its result, or of each element of a list.
fn parts(model: &Model, quantity: &Quantity, name: &str, derivation: Derivation, names: &Names) -> Vec<Shown> {
    let sizes = model.sizes();
    let all_entries = derivation.entries.clone();
    let mut entries = all_entries.as_slice();
    let mut all = Vec::new();
    let of = |entries: &[ExprId]| Derivation { entries: entries.to_vec(), ..derivation.clone() };
    for part in quantity.result {
        let (own, rest) = entries.split_at(part.len(&sizes));
        entries = rest;
        match part.element {
            Some(element) => {
                let size = part.rows().of(&sizes) * part.columns().of(&sizes);
                all.extend(own.chunks(size).enumerate().map(|(i, entries)| {
                    let i = i + 1;
                    let symbol = [format!("{}_{i}(q)", element.letter), format!("{}_{{{i}}}(q)", element.letter)];
                    matrix(model, part, format!("{}_{i}", element.name), symbol, of(entries), names)
                }));
            }
            None => {
                let Typeset { text, latex } = part.symbol;
                let name = if part.name == ResultPart::RESULT { name.to_owned() } else { format!("{name}_{}", part.name) };
                all.push(matrix(model, part, name, [text.into(), latex.into()], of(own), names));
            }
        }
    }
    all
}

/// The determinant with its factors, its closed form if that is not too long; or the minors with those that they share.
fn determinant(model: &Model, derived: Derived, names: &Names) -> Shown {
    let shown = |symbol: [&str; 2], letter, rows, factors: Vec<Factor>| Shown {
        name: DETERMINANT.into(),
        symbol: symbol.map(String::from),
        letter,
        rows,
        columns: 1,
        column_names: None,
        factors: (!factors.is_empty()).then_some(factors),
        content: Content::Closed(Vec::new()),
        parameters: names.parameters.clone(),
        velocities: model.manipulator.friction_velocities(),
        computed: derived.derivation.pool.field().computed().cloned(),
        digits: names.style.digits,
        text: OnceLock::new(),
    };
    let of_determinant = |factors| shown(["det J(q)", "\\det J(q)"], ["det J", "\\det J"], 1, factors);
    match derived.factored {
        Some(Factored::Minors(common, left)) => {
            Shown { content: Content::Minors(left.clone()), ..shown(["d(q)"; 2], ["d"; 2], left.len(), common) }
        }
        Some(Factored::Determinant(closed, factors)) => {
            in_form(of_determinant(factors), closed.map(|form| vec![form]), derived.derivation, names.style.form)
        }
        None => in_form(of_determinant(Vec::new()), None, derived.derivation, names.style.form),
    }
}

fn matrix(model: &Model, part: &ResultPart, name: String, symbol: [String; 2], derivation: Derivation, names: &Names) -> Shown {
    let sizes = model.sizes();
    let columns_of = match part.columns() {
        Length::Parameters => Some(&model.parameters),
        Length::BaseParameters => model.base_parameters(),
        _ => None,
    };
    let closed = if names.style.form == Form::Steps { None } else { derivation.closed_forms() };
    let shown = Shown {
        name,
        symbol,
        letter: [part.letter.text, part.letter.latex],
        rows: part.rows().of(&sizes),
        columns: part.columns().of(&sizes),
        column_names: columns_of.map(|vector| vector.entries.iter().map(|entry| entry.name.clone()).collect()),
        content: Content::Closed(Vec::new()),
        parameters: names.parameters.clone(),
        velocities: model.manipulator.friction_velocities(),
        computed: derivation.pool.field().computed().cloned(),
        factors: None,
        digits: names.style.digits,
        text: OnceLock::new(),
    };
    in_form(shown, closed, derivation, names.style.form)
}

/// The quantity with its content in a form.
fn in_form(shown: Shown, closed: Option<Vec<NormalForm>>, derivation: Derivation, form: Form) -> Shown {
    let closed = closed.filter(|_| form != Form::Steps).map(Content::Closed);
    let closed = match closed {
        Some(content) if form == Form::Closed => return Shown { content, ..shown },
        Some(content) => {
            let shown = Shown { content, ..shown.clone() };
            if shown.is_table() {
                return shown;
            }
            Some(shown.content)
        }
        None => None,
    };
    let derivation = without_turn(derivation);
    let fewer = optimise(&derivation.pool, &derivation.entries, &derivation.parallel, &[]);
    let (method, parallel) = (derivation.method, derivation.parallel.clone());
    let fewer = fewer.map(|(pool, entries)| Derivation { pool, entries, method, parallel });
    let steps = std::iter::once(derivation).chain(fewer).map(|derivation| Content::Program(Box::new(derivation)));
    shown.with_shortest(closed.into_iter().chain(steps))
}

/// The same without the constant angle that the last link may be rotated by: its sine and cosine are constants that people can read.
fn without_turn(derivation: Derivation) -> Derivation {
    let Some(turn) = derivation.pool.field().turn().cloned() else { return derivation };
    let mut pool = Pool::new(derivation.pool.field().clone());
    let entries = derivation.pool.substitute_into(&mut pool, &derivation.entries, &|pool, symbol| {
        let plain = |sum: AngleSum| AngleSum { turned: false, ..sum };
        let (sum, is_sine) = match symbol {
            Symbol::SineOf(sum) if sum.turned => (plain(sum), true),
            Symbol::CosineOf(sum) if sum.turned => (plain(sum), false),
            _ => return pool.symbol(symbol),
        };
        let (s, c) = (pool.symbol(Symbol::SineOf(sum)), pool.symbol(Symbol::CosineOf(sum)));
        let (sine, cosine) = (pool.constant(&turn.sine), pool.constant(&turn.cosine));
        let (first, second) =
            if is_sine { (pool.mul(s, cosine), pool.mul(c, sine)) } else { (pool.mul(c, cosine), -pool.mul(s, sine)) };
        pool.add(first, second)
    });
    Derivation { pool, entries, ..derivation }
}
