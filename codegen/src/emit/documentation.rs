//! The documentation of emitted functions: formula, arguments, result, frames, units and signs, cost. Written for readers who never saw the
//! generator.

use crate::catalogue::{Argument, Documentation};
use crate::exact::Number;
use crate::program::{Cost, Function, Operand};

/// A text with its links as Rust writes them.
fn linked(text: &str) -> String {
    text.replace(['{', '}'], "`")
}

fn argument(argument: Argument) -> String {
    format!("`{}`: {}", argument.name(), linked(argument.meaning()))
}

/// The documentation of a function, line by line; `gravity` is the acceleration of free fall.
pub(super) fn function(function: &Function, gravity: &[Number; 3]) -> Vec<String> {
    let Documentation { title, formula, result, result_with, failure, names_gravity } = function.quantity.documentation;
    let (result, failure) = match function.with_parameters {
        false => (result, failure[0]),
        true => (result_with.unwrap_or(result), failure[1]),
    };
    let mut lines = vec![format!(" {}", linked(title))];
    if names_gravity {
        let [x, y, z] = gravity.each_ref().map(Number::to_f64);
        lines.extend([String::new(), format!(" The acceleration of free fall is g0 = ({x}, {y}, {z}) m/s² in the base frame.")]);
    }
    if function.with_parameters {
        lines.extend([
            String::new(),
            " The parameters are given at run time; what is not among them is as in the description.".into(),
        ]);
    }
    let blank = || String::new();
    lines.extend([blank(), " ```text".into(), format!(" {formula}"), " ```".into(), blank()]);
    lines.extend(function.arguments.iter().map(|&a| format!(" - {}", argument(a))));
    lines.push(format!(" - Returns {}", linked(result)));
    if let Some(joint) = turned_joint(function) {
        lines.extend([
            blank(),
            format!(" Inside, the last link has axes whose x axis points to its centre of mass, seen along the joint axis: q{joint} and a constant angle."),
        ]);
    }
    lines.extend([
        blank(),
        format!(" Cost: {}. Derived by {}. Allocates nothing, {failure}.", cost(&Cost::of(function)), function.method),
    ]);
    lines
}

/// The joint whose variable a function turns by a constant angle, counted from 1.
fn turned_joint(function: &Function) -> Option<u16> {
    let operands = function.steps.iter().flat_map(|step| [&step.left, &step.right]);
    let angles = operands.filter_map(|operand| match operand {
        Operand::Input(symbol) => symbol.angle(),
        _ => None,
    });
    let turned = angles.filter(|angle| angle.turned).filter_map(|angle| angle.terms().last());
    turned.map(|(joint, _)| joint + 1).next()
}

/// Operations in words.
pub(super) fn cost(cost: &Cost) -> String {
    let count = |n: usize, one: &str, many: &str| match n {
        0 => None,
        1 => Some(format!("1 {one}")),
        n => Some(format!("{n} {many}")),
    };
    let parts: Vec<String> = [
        count(cost.mul, "multiplication", "multiplications"),
        count(cost.add, "addition", "additions"),
        count(cost.div, "division", "divisions"),
        count(cost.sincos, "sine and cosine pair", "sine and cosine pairs"),
    ]
    .into_iter()
    .flatten()
    .collect();
    if parts.is_empty() {
        "none, the result is constant".into()
    } else {
        parts.join(", ")
    }
}
