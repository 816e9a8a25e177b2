//! The documentation of emitted functions, in no language: formula, arguments, result, frames, units and signs, cost. Written for readers
//! who never saw the generator. Each language writes the [`Block`]s as its comments are written, and its own names for the links.

use crate::catalogue::Parameter;
use crate::catalogue::{Argument, Documentation, Length, Quantity};
use crate::exact::Number;
use crate::kinds::Feature;
use crate::program::listing::decimal;
use crate::program::{Cost, Function, Module, Operand};
use crate::ring::Symbol;

/// A piece of documentation; between two there is an empty line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Block {
    /// Running text, line by line, with links.
    Text(Vec<String>),
    /// A formula, with links.
    Formula(&'static str),
    /// Lines, verbatim.
    Verbatim(Vec<String>),
    /// Items, with links.
    List(Vec<String>),
    /// Names and their meanings, verbatim.
    Table(Vec<(String, String)>),
}

/// Target of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Link<'a> {
    /// A function of the module.
    Function(&'a str),
    /// An argument of the function.
    Argument(&'a str),
    /// A constant of the module.
    Constant(&'a str),
}

impl Block {
    pub(super) fn text(line: impl Into<String>) -> Block {
        Block::Text(vec![line.into()])
    }
}

/// A text with its links as a language writes them.
pub(super) fn linked(text: &str, write: &dyn Fn(Link<'_>) -> String) -> String {
    let mut result = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, (name, after))) =
        rest.split_once('{').and_then(|(before, after)| Some((before, after.split_once('}')?)))
    {
        let link = if Argument::ALL.iter().any(|argument| argument.name() == name) {
            Link::Argument(name)
        } else if name.contains(|c: char| c.is_ascii_lowercase()) {
            Link::Function(name)
        } else {
            Link::Constant(name)
        };
        result += before;
        result += &write(link);
        rest = after;
    }
    result + rest
}

/// The documentation of a quantity, whatever the arm.
pub(super) fn of_quantity(quantity: &Quantity) -> Vec<Block> {
    let Documentation { title, formula, result, .. } = quantity.documentation;
    let items = quantity.arguments_of(false, false).map(argument).chain([format!("Returns {result}")]);
    vec![Block::text(title), Block::Formula(formula), Block::List(items.collect())]
}

fn argument(argument: Argument) -> String {
    format!("{{{}}}: {}", argument.name(), argument.meaning())
}

/// Documentation of a function beyond the words of the catalogue.
#[derive(Clone, Debug)]
pub struct Described<'a> {
    /// The quantity that it computes.
    pub quantity: &'a Quantity,
    /// Whether it takes the parameters at run time.
    pub with_parameters: bool,
    /// Acceleration of free fall in the base frame, m/s².
    pub gravity: &'a [Number; 3],
    /// Whether that is an argument.
    pub gravity_is_argument: bool,
    /// What the joints of the arm have.
    pub features: &'a [Feature],
    /// Whether the parameters at run time are base parameters.
    pub grouped: bool,
    /// The joint whose variable it turns by a constant angle, counted from 1.
    pub turned_joint: Option<usize>,
    /// Its operations in words.
    pub cost: String,
    /// How it was derived: one of [`METHODS`](crate::catalogue::METHODS).
    pub method: &'a str,
}

/// Documentation of a function.
pub(super) fn described<'a>(function: &Function, module: &'a Module) -> Described<'a> {
    Described {
        quantity: function.quantity,
        with_parameters: function.with_parameters,
        gravity: &module.gravity,
        gravity_is_argument: module.gravity_is_argument,
        features: &module.features,
        grouped: module.base_parameters,
        turned_joint: turned_joint(function),
        cost: cost(&Cost::of(function)),
        method: function.method,
    }
}

/// The documentation of a function; `allocates`: whether its results take memory of their own in the language.
pub(super) fn function(function: &Function, module: &Module, allocates: bool) -> Vec<Block> {
    described(function, module).blocks(allocates, None)
}

impl Described<'_> {
    /// The arguments of the function.
    pub(super) fn arguments(&self) -> impl Iterator<Item = Argument> {
        self.quantity.arguments_of(self.with_parameters, self.gravity_is_argument)
    }

    /// Its name in the module.
    pub(super) fn name(&self) -> String {
        format!("{}{}", self.quantity.name, if self.with_parameters { "_with" } else { "" })
    }

    /// `allocates`: whether its results take memory of their own in the language; `note`: the last paragraph.
    pub(super) fn blocks(&self, allocates: bool, note: Option<&str>) -> Vec<Block> {
        let Documentation { title, formula, result, result_with, failure, names_gravity, features, base, .. } =
            self.quantity.documentation;
        let (result, failure) = match self.with_parameters {
            false => (result, failure[0]),
            true => (result_with.unwrap_or(result), failure[1]),
        };
        let mut blocks = vec![Block::text(title)];
        if names_gravity && !self.gravity_is_argument {
            let [x, y, z] = self.gravity.each_ref().map(Number::to_f64);
            blocks.push(Block::text(format!("The acceleration of free fall is g0 = ({x}, {y}, {z}) m/s² in the base frame.")));
        }
        let of_joints = self.features.iter().filter_map(|&feature| features[feature as usize]);
        blocks.extend(of_joints.map(Block::text));
        if self.with_parameters {
            blocks.push(Block::text("The parameters are given at run time; what is not among them is as in the description."));
            blocks.extend(base.filter(|_| self.grouped).map(Block::text));
        }
        blocks.push(Block::Formula(formula));
        blocks.push(Block::List(self.arguments().map(argument).chain([format!("Returns {result}")]).collect()));
        if let Some(joint) = self.turned_joint {
            blocks.push(Block::text(format!(
                "Inside, the last link has axes whose x axis points to its centre of mass, seen along the joint axis: q{joint} and a constant angle."
            )));
        }
        let nothing = if allocates { "" } else { "Allocates nothing, " };
        let failure = format!("{nothing}{failure}");
        let (first, rest) = failure.split_at(1);
        blocks.push(Block::text(format!("Cost: {}. Derived by {}. {}{rest}.", self.cost, self.method, first.to_uppercase())));
        blocks.extend(note.map(Block::text));
        blocks
    }
}

/// Meaning of the names of base parameters.
pub(super) fn base_note() -> Block {
    Block::Text(
        [
            "A name that ends in R is a base parameter: a standard parameter in the joint frame, whose z axis is the joint's, grouped with all",
            "that cannot be told from it. Beside it stands its value in the standard parameters, of links in their own frames, inertia about",
            "their origins; SI units; a factor of more than 60 characters as the nearest float.",
        ]
        .map(String::from)
        .to_vec(),
    )
}

/// Meaning of the names of base parameters of `base_regressor`; `turn`: angle, rad, of the turn of the last link's frame, if any.
pub(super) fn own_base_note(turn: Option<&str>) -> Block {
    let first = [
        "A name that ends in R is a base parameter: a standard parameter in the joint frame, whose z axis is the joint's and whose origin is where",
        "that comes nearest to the axis before, grouped with all that cannot be told from it. Links of revolute joints have Izz = Ixx + Iyy there.",
        "Beside it stands its value in the standard parameters, of links in their own frames, inertia about their origins; SI units; a factor",
        "of more than 60 characters as the nearest float.",
        "Those that are 0 there, at the values of the description, have no column: for identification take `regressor: base`, which has all.",
    ];
    let turned = turn.map(|angle| {
        [
            format!("The x axis of the last link stands {angle} rad after the joint variable, about the joint axis; seen along that, the centre"),
            "of mass of the link, payload included, lies on it: its mcy is 0.".to_string(),
        ]
    });
    Block::Text(first.into_iter().map(String::from).chain(turned.into_iter().flatten()).collect())
}

/// Angle, rad, of the turn of the last link's frame, if any, as text for documentation.
pub(super) fn turn(module: &Module) -> Option<String> {
    module.turn.as_ref().map(|turn| decimal(turn, module.scalar))
}

/// Documentation of constants beyond fixed words.
#[derive(Clone, Debug, Default)]
pub struct DescribedParameters {
    /// Whether the parameters are base parameters.
    pub grouped: bool,
    /// Names of the parameters and their meanings.
    pub parameters: Vec<(String, String)>,
    /// Names of the base parameters of `base_regressor` and their meanings, in modules with this function.
    pub base_parameters: Option<Vec<(String, String)>>,
    /// By how many rad the frame of the last link is turned, if it is, as it is written.
    pub turn: Option<String>,
    /// Whether the acceleration of free fall is an argument.
    pub gravity_is_argument: bool,
    /// The names of end effectors; none where there is one without a name.
    pub tips: Vec<String>,
    /// Whether joints are coupled.
    pub is_coupled: bool,
    /// Names of the joints with motors, if the module has the speeds of these.
    pub motors: Vec<String>,
}

impl DescribedParameters {
    pub(super) fn of(module: &Module) -> DescribedParameters {
        DescribedParameters {
            grouped: module.base_parameters,
            parameters: named(&module.parameters),
            base_parameters: has_base_parameters(module).then(|| named(&module.base_set)),
            turn: turn(module),
            gravity_is_argument: module.gravity_is_argument,
            tips: module.tips.iter().map(|tip| tip.name.clone()).collect(),
            is_coupled: module.coupling.is_some(),
            motors: module.motors.iter().flat_map(|motors| &motors.joints).cloned().collect(),
        }
    }

    /// Meanings of the names of parameters, to follow a title.
    pub(super) fn meanings(&self) -> impl Iterator<Item = Block> + use<> {
        self.grouped.then(base_note).into_iter().chain([Block::Table(self.parameters.clone())])
    }

    /// Meanings of the names of base parameters, to follow a title.
    pub(super) fn base_meanings(&self) -> [Block; 2] {
        [own_base_note(self.turn.as_deref()), Block::Table(self.base_parameters.clone().unwrap_or_default())]
    }
}

/// Whether a module has base parameters.
pub(super) fn has_base_parameters(module: &Module) -> bool {
    module.functions.iter().any(|function| function.quantity.has_length(Length::BaseParameters))
}

/// Names of parameters and their meanings.
pub(super) fn named(parameters: &[Parameter]) -> Vec<(String, String)> {
    parameters.iter().map(|parameter| (parameter.name.clone(), parameter.meaning.clone())).collect()
}

/// The lines of a comment without marks of its own.
pub(super) fn plain(blocks: &[Block], link: &dyn Fn(Link<'_>) -> String) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, block) in blocks.iter().enumerate() {
        if i > 0 {
            lines.push(String::new());
        }
        match block {
            Block::Text(text) => lines.extend(text.iter().map(|line| linked(line, link))),
            Block::Formula(formula) => lines.push(linked(formula, link)),
            Block::Verbatim(text) => lines.extend(text.iter().cloned()),
            Block::List(items) => lines.extend(items.iter().map(|item| format!("- {}", linked(item, link)))),
            Block::Table(table) => lines.extend(rows(table)),
        }
    }
    lines.iter().map(|line| line.trim_end().to_string()).collect()
}

/// The rows of a table, names padded to one width.
pub(super) fn rows(table: &[(String, String)]) -> impl Iterator<Item = String> + use<'_> {
    let width = table.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    table.iter().map(move |(name, meaning)| format!("{name:width$}  {meaning}"))
}

/// The joint whose variable a function turns by a constant angle, counted from 1.
fn turned_joint(function: &Function) -> Option<usize> {
    let operands = function.steps.iter().flat_map(|step| [&step.left, &step.right]);
    let turned = operands.filter_map(|operand| match operand {
        Operand::Input(Symbol::SineOf(sum) | Symbol::CosineOf(sum)) if sum.turned => sum.terms().last(),
        _ => None,
    });
    turned.map(|(joint, _)| usize::from(joint) + 1).next()
}

/// Operations in words.
fn cost(cost: &Cost) -> String {
    let count = |n: usize, one: &str, many: &str| match n {
        0 => None,
        1 => Some(format!("1 {one}")),
        n => Some(format!("{n} {many}")),
    };
    let fused = match cost.fused {
        0 => String::new(),
        n => format!(" ({n} fused with an addition)"),
    };
    let parts: Vec<String> = [
        count(cost.mul, "multiplication", "multiplications").map(|text| text + &fused),
        count(cost.add, "addition", "additions"),
        count(cost.div, "division", "divisions"),
        count(cost.sincos, "sine and cosine pair", "sine and cosine pairs"),
        count(cost.exp, "exponential", "exponentials"),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue;

    #[test]
    fn every_link_leads_somewhere() {
        const CONSTANTS: [&str; 9] = [
            "PARAMETER_NAMES",
            "NOMINAL_PARAMETERS",
            "BASE_PARAMETER_NAMES",
            "NOMINAL_BASE_PARAMETERS",
            "TASK",
            "COUPLING",
            "COUPLING_OFFSET",
            "ALL_JOINT_NAMES",
            "MOTOR_RATES",
        ];
        let shown = |link: Link<'_>| match link {
            Link::Function(name) => {
                assert!(catalogue::named(name).is_some(), "{name} is no function of the module");
                format!("<{name}()>")
            }
            Link::Argument(name) => format!("<{name}>"),
            Link::Constant(name) => {
                assert!(CONSTANTS.contains(&name), "{name} is no constant of the module");
                format!("<{name}>")
            }
        };
        for quantity in catalogue::quantities() {
            let Documentation { title, formula, result, result_with, base, .. } = quantity.documentation;
            for text in [title, formula, result].into_iter().chain(result_with).chain(base) {
                let text = linked(text, &shown);
                assert!(!text.contains(['{', '}']), "{text}");
            }
        }
        assert_eq!(linked("{gravity} of {q} and `m[i][j]`", &shown), "<gravity()> of <q> and `m[i][j]`");
        assert_eq!(linked("a { that is no link", &shown), "a { that is no link");
    }
}
