//! What languages have in common whose text is put together line by line: lines, angles and the places of results are those of the
//! program, and a language says only how it writes an entry, a number and an operator.

use crate::catalogue::{Argument, Part, Quantity, Sizes};
use crate::exact::Number;
use crate::program::listing::{angles, Angle, Expression, Name};
use crate::program::{Function, Module, Operation};
use crate::ring::Symbol;

/// How a language writes what a line is made of.
pub(super) trait Syntax {
    /// A constant, with its sign.
    fn number(&self, value: &Number) -> String;

    /// The sign of an entry.
    fn sign(&self, entry: &str) -> String;

    /// An entry of an argument, counted from 0.
    fn entry(&self, argument: Argument, index: usize) -> String {
        format!("{}[{index}]", argument.name())
    }

    /// An operator.
    fn operator(&self, operation: Operation) -> &'static str {
        match operation {
            Operation::Add => "+",
            Operation::Subtract => "-",
            Operation::Multiply => "*",
            Operation::Divide => "/",
        }
    }
}

/// A line or an entry of a result.
pub(super) fn expression(of: &Expression, syntax: &dyn Syntax) -> String {
    match of {
        Expression::Input(symbol) => input(*symbol, syntax),
        Expression::Constant(value) => syntax.number(value),
        Expression::Step(i) => Name::Step(*i).text(),
        Expression::Operation(operation, left, right) => {
            format!("{} {} {}", expression(left, syntax), syntax.operator(*operation), expression(right, syntax))
        }
        Expression::Negation(inner) => format!("-{}", expression(inner, syntax)),
        Expression::Brackets(inner) => format!("({})", expression(inner, syntax)),
    }
}

fn input(symbol: Symbol, syntax: &dyn Syntax) -> String {
    if symbol.angle().is_some() {
        return Name::SineOrCosine(symbol).text();
    }
    let entry = syntax.entry(Argument::of(symbol), usize::from(symbol.index()));
    match symbol {
        Symbol::RateSign(_) => syntax.sign(&entry),
        _ => entry,
    }
}

/// Whether a line reads an argument.
pub(super) fn reads_an_argument(of: &Expression) -> bool {
    match of {
        Expression::Input(symbol) => symbol.angle().is_none(),
        Expression::Constant(_) | Expression::Step(_) => false,
        Expression::Operation(_, left, right) => reads_an_argument(left) || reads_an_argument(right),
        Expression::Negation(inner) | Expression::Brackets(inner) => reads_an_argument(inner),
    }
}

/// An angle whose sine or cosine a function uses: how it is written, and the names of its sine and cosine.
pub(super) struct Wave {
    pub(super) angle: String,
    pub(super) sine: Option<String>,
    pub(super) cosine: Option<String>,
}

/// The angles of a function.
pub(super) fn waves(module: &Module, function: &Function, syntax: &dyn Syntax) -> Vec<Wave> {
    let name = |name: Option<Name>| name.map(Name::text);
    let wave = |angle: Angle| Wave {
        angle: sum(&angle, module.turn.as_ref(), syntax),
        sine: name(angle.sine),
        cosine: name(angle.cosine),
    };
    angles(&function.symbols()).into_iter().map(wave).collect()
}

fn sum(angle: &Angle, turn: Option<&Number>, syntax: &dyn Syntax) -> String {
    let mut text = String::new();
    for (k, &(joint, minus)) in angle.terms.iter().enumerate() {
        if k > 0 {
            text += if minus { " - " } else { " + " };
        }
        text += &syntax.entry(Argument::Q, usize::from(joint));
    }
    if let Some(turn) = turn.filter(|_| angle.turned) {
        let turn = syntax.number(turn);
        text += &match turn.strip_prefix('-') {
            Some(size) => format!(" - {size}"),
            None => format!(" + {turn}"),
        };
    }
    text
}

/// Each entry of a result, in order: the part that it belongs to and its indices there, counted from 0.
pub(super) fn places(quantity: &'static Quantity, sizes: &Sizes) -> Vec<(&'static Part, Vec<usize>)> {
    let of_part = |part: &'static Part| {
        part.lengths.iter().fold(vec![(part, Vec::new())], |places: Vec<(&Part, Vec<usize>)>, length| {
            let within = |(part, place): (&'static Part, Vec<usize>)| {
                (0..length.of(sizes)).map(move |i| (part, place.iter().copied().chain([i]).collect()))
            };
            places.into_iter().flat_map(within).collect()
        })
    };
    quantity.result.iter().flat_map(of_part).collect()
}

/// Whether any function of a module uses a sign.
pub(super) fn asks_for_signs(module: &Module) -> bool {
    module.functions.iter().flat_map(Function::symbols).any(|symbol| matches!(symbol, Symbol::RateSign(_)))
}

/// A text that stands in the name of a robot called `robot`, for one of another name.
pub(super) fn of_robot(text: &str, name: &str, macros: &str) -> String {
    let pieces: Vec<String> = text.split("robot_").map(|piece| piece.replace("ROBOT_", &format!("{macros}_"))).collect();
    pieces.join(&format!("{name}_"))
}
