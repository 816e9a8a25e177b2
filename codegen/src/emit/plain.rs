//! Common part of the languages whose text is composed line by line. Lines, angles and the places of results come from the
//! program. A language only defines how it writes an entry, a number and an operator.

use super::documentation::{self, Block, Described, DescribedParameters};
use super::{Language, Notes, Origin};
use crate::catalogue::{Argument, Parameter, Quantity, ResultPart, Sizes};
use crate::exact::Number;
use crate::program::listing::{angles, Angle, Expression, Name};
use crate::program::{EndEffector, Function, Joint, Module, Operation};
use crate::ring::{Elementary, Symbol};

/// How a language writes the elements of a line.
pub(super) trait Syntax {
    /// A constant, with its sign.
    fn number(&self, value: &Number) -> String;

    /// The sign of an entry or of another value.
    fn sign(&self, value: &str) -> String;

    /// Share of Stribeck friction at an entry that remains at a velocity.
    fn stribeck(&self, entry: &str, velocity: &str) -> String;

    /// The product of the first two and the third, in one operation that rounds once; only programs of languages that have one hold it.
    fn fused(&self, _parts: [String; 3]) -> String {
        unreachable!("this language is given programs without fused operations")
    }

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
            Operation::Sign | Operation::OppositeSign => unreachable!("a listing writes the sign of one operand"),
        }
    }
}

/// A line or an entry of a result.
pub(super) fn expression(of: &Expression, syntax: &dyn Syntax) -> String {
    let mut text = String::new();
    write(of, syntax, &mut text);
    text
}

fn write(of: &Expression, syntax: &dyn Syntax, text: &mut String) {
    match of {
        Expression::Input(symbol) => *text += &input(*symbol, syntax),
        Expression::Constant(value) => *text += &syntax.number(value),
        Expression::Stribeck(i, velocity) => {
            *text += &syntax.stribeck(&syntax.entry(Argument::Dq, usize::from(*i)), &syntax.number(velocity));
        }
        Expression::Step(i) => *text += &Name::Step(*i).text(),
        Expression::Operation(operation, left, right) => {
            write(left, syntax, text);
            for part in [" ", syntax.operator(*operation), " "] {
                *text += part;
            }
            write(right, syntax, text);
        }
        Expression::Fused(parts) => *text += &syntax.fused(parts.each_ref().map(|part| expression(part, syntax))),
        Expression::Sign(inner) => *text += &syntax.sign(&expression(inner, syntax)),
        Expression::Negation(inner) => {
            text.push('-');
            write(inner, syntax, text);
        }
        Expression::Brackets(inner) => {
            text.push('(');
            write(inner, syntax, text);
            text.push(')');
        }
    }
}

fn input(symbol: Symbol, syntax: &dyn Syntax) -> String {
    if symbol.angle().is_some() {
        return Name::SineOrCosine(symbol).text();
    }
    let entry = syntax.entry(Argument::of(symbol), usize::from(symbol.index()));
    match symbol {
        Symbol::OfRate(Elementary::Sign, _) => syntax.sign(&entry),
        _ => entry,
    }
}

/// Whether a line reads an argument.
pub(super) fn reads_an_argument(of: &Expression) -> bool {
    match of {
        Expression::Input(symbol) => symbol.angle().is_none(),
        Expression::Stribeck(..) => true,
        Expression::Constant(_) | Expression::Step(_) => false,
        Expression::Operation(_, left, right) => reads_an_argument(left) || reads_an_argument(right),
        Expression::Fused(parts) => parts.iter().any(reads_an_argument),
        Expression::Sign(inner) | Expression::Negation(inner) | Expression::Brackets(inner) => reads_an_argument(inner),
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
    angles(&function.symbols(), &function.computed).into_iter().map(wave).collect()
}

fn sum(angle: &Angle, turn: Option<&Number>, syntax: &dyn Syntax) -> String {
    let mut text = String::new();
    for (k, (&(joint, minus), factor)) in angle.terms.iter().zip(angle.factors()).enumerate() {
        if k > 0 {
            text += if minus { " - " } else { " + " };
        }
        if let Some(factor) = factor {
            text += &format!("{} * ", syntax.number(&factor));
        }
        text += &syntax.entry(Argument::Q, usize::from(joint));
    }
    if let Some(turn) = angle.constant(turn) {
        let turn = syntax.number(turn);
        text += &match turn.strip_prefix('-') {
            Some(size) => format!(" - {size}"),
            None => format!(" + {turn}"),
        };
    }
    text
}

/// Each entry of a result, in order: the part that it belongs to and its indices there, counted from 0.
pub(super) fn places(quantity: &'static Quantity, sizes: &Sizes) -> Vec<(&'static ResultPart, Vec<usize>)> {
    let of_part = |part: &'static ResultPart| {
        part.lengths.iter().fold(vec![(part, Vec::new())], |places: Vec<(&ResultPart, Vec<usize>)>, length| {
            let within = |(part, place): (&'static ResultPart, Vec<usize>)| {
                (0..length.of(sizes)).map(move |i| (part, place.iter().copied().chain([i]).collect()))
            };
            places.into_iter().flat_map(within).collect()
        })
    };
    quantity.result.iter().flat_map(of_part).collect()
}

/// Whether any function of a module uses a sign.
pub(super) fn asks_for_signs(module: &Module) -> bool {
    module.functions.iter().any(Function::takes_signs)
}

/// Whether any function of a module has Stribeck friction.
pub(super) fn asks_for_exponentials(module: &Module) -> bool {
    module.functions.iter().any(|function| !function.stribeck.is_empty())
}

/// A text written for a robot called `robot`, for a robot of another name.
pub(super) fn of_robot(text: &str, name: &str, macros: &str) -> String {
    let pieces: Vec<String> = text.split("robot_").map(|piece| piece.replace("ROBOT_", &format!("{macros}_"))).collect();
    pieces.join(&format!("{name}_"))
}

/// `inertia_matrix` as `inertiaMatrix`.
pub fn camel(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default().to_string();
    words.fold(first, |text, word| {
        let (initial, rest) = word.split_at(word.len().min(1));
        text + &initial.to_uppercase() + rest
    })
}

/// The value of a constant.
pub(super) enum Value {
    Text(String),
    Count(usize),
    Truth(bool),
    Number(Number),
    /// Infinity, and whether it is negative.
    Infinite(bool),
    Array(Vec<Value>),
}

/// A constant of a module.
pub(super) struct Constant {
    pub(super) name: String,
    pub(super) value: Value,
}

/// The constants of a module with these end effectors in order, with the base parameters last.
fn names(tips: &[String]) -> Vec<String> {
    let all = CONSTANTS.into_iter().flat_map(|name| match name {
        TIPS if tips.is_empty() => Vec::new(),
        TIPS => {
            let of_tips = tips.iter().flat_map(|tip| OF_TIP.map(|constant| format!("{}_{constant}", tip.to_ascii_uppercase())));
            [TIPS.to_owned()].into_iter().chain(of_tips).collect()
        }
        // Each end effector has its own.
        "TASK_ROWS" | "TASK" if !tips.is_empty() => Vec::new(),
        name => vec![name.to_owned()],
    });
    all.collect()
}

/// The names of end effectors, with the constants of each behind them.
const TIPS: &str = "TIPS";
/// The constants of a named end effector.
const OF_TIP: [&str; 3] = ["TASK_ROWS", "TASK", "COORDINATES"];

/// The constants of a module with coupled joints.
const OF_COUPLING: [&str; 4] = ["JOINTS", "ALL_JOINT_NAMES", "COUPLING", "COUPLING_OFFSET"];

/// The constants of a module with motors that turn with several coordinates.
const OF_MOTORS: [&str; 2] = ["MOTORS", "MOTOR_RATES"];

/// The constants of any module.
const CONSTANTS: [&str; 25] = [
    "NAME",
    "DOF",
    "JOINT_NAMES",
    "JOINT_IS_REVOLUTE",
    "POSITION_LIMITS",
    "VELOCITY_LIMITS",
    "EFFORT_LIMITS",
    "ACCELERATION_LIMITS",
    "JERK_LIMITS",
    "JOINTS",
    "ALL_JOINT_NAMES",
    "COUPLING",
    "COUPLING_OFFSET",
    "MOTORS",
    "MOTOR_RATES",
    "TASK_ROWS",
    "TASK",
    TIPS,
    "PARAMETERS",
    "PARAMETER_NAMES",
    "NOMINAL_PARAMETERS",
    "NOMINAL_GRAVITY",
    "BASE_PARAMETERS",
    "BASE_PARAMETER_NAMES",
    "NOMINAL_BASE_PARAMETERS",
];

/// The documentation of the constants of a module; `first`: first index of the language.
pub(super) fn constants_documentation(described: &DescribedParameters, first: usize) -> Vec<(String, Vec<Block>)> {
    let [a, b, c, d, e, f] = std::array::from_fn(|row| row + first);
    let said = |name: &str| {
        let constant_of = |tip: &String| {
            let constant = name.strip_prefix(&tip.to_ascii_uppercase())?.strip_prefix('_')?;
            OF_TIP.contains(&constant).then_some(constant)
        };
        let of_tip = described.tips.iter().find_map(|tip| Some((tip, constant_of(tip)?)));
        if let Some((tip, constant)) = of_tip {
            return match constant {
                "TASK_ROWS" => format!("Number of rows of the operational space of `{tip}`."),
                "TASK" => format!(
                    "Rows of the geometric Jacobian that make up the operational space of `{tip}`: {a} {b} {c} along x y z, {d} {e} {f} about x y z, in the base frame."
                ),
                _ => format!("The joints that move `{tip}`, from the base on, counted from {first}; all other columns of its Jacobian are 0."),
            };
        }
        match name {
        TIPS => "Names of the end effectors.".into(),
        "NAME" => "Name of the robot.".into(),
        "DOF" if described.is_coupled => "Number of coordinates: of joints that do not follow others.".into(),
        "DOF" => "Number of joints.".into(),
        "JOINT_NAMES" if described.is_coupled => "Names of the joints with a coordinate, base to tip.".into(),
        "JOINT_NAMES" => "Names of the joints, base to tip.".into(),
        "JOINT_IS_REVOLUTE" => "Whether a joint turns (q in rad) or slides (q in m).".into(),
        "POSITION_LIMITS" => "Lowest and highest joint variable, rad or m; infinite where the description gives none.".into(),
        "VELOCITY_LIMITS" => "Highest joint rate, rad/s or m/s; infinite where the description gives none.".into(),
        "EFFORT_LIMITS" => {
            "Highest joint torque on the joint side of the gear, N m or N; infinite where the description gives none.".into()
        }
        "ACCELERATION_LIMITS" => {
            "Highest acceleration of planned motions, rad/s² or m/s²; infinite where the description gives none.".into()
        }
        "JERK_LIMITS" => "Highest jerk of planned motions, rad/s³ or m/s³; infinite where the description gives none.".into(),
        "JOINTS" => "Number of joints, those that follow others included.".into(),
        "ALL_JOINT_NAMES" => "Names of all joints, base to tip.".into(),
        "COUPLING" => "S of the joint variables S q + c: a row for each joint, a column for each coordinate.".into(),
        "COUPLING_OFFSET" => "c of the joint variables S q + c, rad or m.".into(),
        "MOTORS" => format!("Number of motors, of the joints {}.", described.motors.join(", ")),
        "MOTOR_RATES" => {
            "N of the rotor speeds N dq beside the links that carry the rotors: a row for each motor, a column for each coordinate. Torques of motors tau_m do the work of tau = N' tau_m."
                .into()
        }
        "TASK_ROWS" => "Number of rows of the operational space.".into(),
        "TASK" => format!(
            "Rows of the geometric Jacobian that make up the operational space: {a} {b} {c} along x y z, {d} {e} {f} about x y z, in the base frame."
        ),
        "PARAMETERS" => "Number of parameters.".into(),
        "PARAMETER_NAMES" => "Names of the parameters, in the order of the columns of {regressor}:".into(),
        "NOMINAL_PARAMETERS" => "Values of the parameters in the description.".into(),
        "NOMINAL_GRAVITY" => "Acceleration of free fall in the description, in the base frame, m/s².".into(),
        "BASE_PARAMETERS" => {
            "Number of base parameters: as many as a motion can tell apart, without those that are 0 at the values of the description."
                .into()
        }
        "BASE_PARAMETER_NAMES" => {
            "Names of the base parameters, in the order of the columns of {base_regressor}, each a combination of standard parameters:".into()
        }
        _ => "Values of the base parameters in the description, the masses of rotors included.".to_string(),
    }
    };
    let of = |name: String| {
        let title = Block::text(said(&name));
        let blocks = match name.as_str() {
            "PARAMETER_NAMES" => [title].into_iter().chain(described.meanings()).collect(),
            "BASE_PARAMETER_NAMES" => [title].into_iter().chain(described.base_meanings()).collect(),
            _ => vec![title],
        };
        (name, blocks)
    };
    let there = |name: &String| has_constant(name, described);
    names(&described.tips).into_iter().filter(there).map(of).collect()
}

/// Whether a module has a constant.
fn has_constant(name: &str, described: &DescribedParameters) -> bool {
    let has_base_parameters = !name.contains("BASE_") || described.base_parameters.is_some();
    let has_gravity = name != "NOMINAL_GRAVITY" || described.gravity_is_argument;
    has_base_parameters
        && has_gravity
        && (!OF_COUPLING.contains(&name) || described.is_coupled)
        && (!OF_MOTORS.contains(&name) || !described.motors.is_empty())
}

/// The constants of a module, in order; `first`: first index of the language.
pub(super) fn constants(module: &Module, first: usize) -> Vec<Constant> {
    let text = |text: &String| Value::Text(text.clone());
    let number = |value: &Option<Number>, negative: bool| match value {
        Some(value) => Value::Number(value.clone()),
        None => Value::Infinite(negative),
    };
    let joints = |of: &dyn Fn(&Joint) -> Value| Value::Array(module.joints.iter().map(of).collect());
    let named = |parameters: &[Parameter]| Value::Array(parameters.iter().map(|parameter| text(&parameter.name)).collect());
    let nominal = |parameters: &[Parameter]| {
        Value::Array(parameters.iter().map(|parameter| Value::Number(parameter.nominal.clone())).collect())
    };
    let position = |joint: &Joint| Value::Array(vec![number(&joint.position[0], true), number(&joint.position[1], false)]);
    let counted = |all: &[usize]| Value::Array(all.iter().map(|&one| Value::Count(one + first)).collect());
    let (coupling, motors) = (module.coupling.as_ref(), module.motors.as_ref());
    let exact = |row: &[Number]| Value::Array(row.iter().cloned().map(Value::Number).collect());
    let of_tip = |name: &str| {
        let of = |tip: &EndEffector| [Value::Count(tip.task.len()), counted(&tip.task), counted(&tip.coordinates)];
        let all = module.tips.iter().flat_map(|tip| OF_TIP.map(|constant| tip.constant(constant)).into_iter().zip(of(tip)));
        all.into_iter().find_map(|(own, value)| (own == name).then_some(value))
    };
    let of = |name: String| Constant {
        value: of_tip(&name).unwrap_or_else(|| match name.as_str() {
            TIPS => Value::Array(module.tips.iter().map(|tip| text(&tip.name)).collect()),
            "NAME" => text(&module.name),
            "DOF" => Value::Count(module.joints.len()),
            "JOINT_NAMES" => joints(&|joint| text(&joint.name)),
            "JOINT_IS_REVOLUTE" => joints(&|joint| Value::Truth(joint.is_revolute)),
            "POSITION_LIMITS" => joints(&position),
            "VELOCITY_LIMITS" => joints(&|joint| number(&joint.velocity, false)),
            "EFFORT_LIMITS" => joints(&|joint| number(&joint.effort, false)),
            "ACCELERATION_LIMITS" => joints(&|joint| number(&joint.acceleration, false)),
            "JERK_LIMITS" => joints(&|joint| number(&joint.jerk, false)),
            "JOINTS" => Value::Count(coupling.map_or(module.joints.len(), |coupling| coupling.names.len())),
            "ALL_JOINT_NAMES" => Value::Array(coupling.iter().flat_map(|coupling| &coupling.names).map(text).collect()),
            "COUPLING" => Value::Array(coupling.iter().flat_map(|coupling| &coupling.factors).map(|row| exact(row)).collect()),
            "COUPLING_OFFSET" => coupling.map_or(Value::Array(Vec::new()), |coupling| exact(&coupling.offsets)),
            "MOTORS" => Value::Count(motors.map_or(0, |motors| motors.joints.len())),
            "MOTOR_RATES" => Value::Array(motors.iter().flat_map(|motors| &motors.rates).map(|row| exact(row)).collect()),
            "TASK_ROWS" => Value::Count(module.task.len()),
            "TASK" => counted(&module.task),
            "PARAMETERS" => Value::Count(module.parameters.len()),
            "PARAMETER_NAMES" => named(&module.parameters),
            "NOMINAL_PARAMETERS" => nominal(&module.parameters),
            "NOMINAL_GRAVITY" => Value::Array(module.gravity.iter().cloned().map(Value::Number).collect()),
            "BASE_PARAMETERS" => Value::Count(module.base_set.len()),
            "BASE_PARAMETER_NAMES" => named(&module.base_set),
            _ => nominal(&module.base_set),
        }),
        name,
    };
    let described = DescribedParameters::of(module);
    let there = |name: &String| has_constant(name, &described);
    names(&described.tips).into_iter().filter(there).map(of).collect()
}

/// The head of a file as comment lines: its origin, and the functions that the module lacks.
pub(super) fn head(module: &Module, language: Language, origin: &Origin, notes: &Notes, sign: &str) -> String {
    let absent = module.absent.iter().map(|absent| format!("There is no `{}`: {}.", absent.function, absent.reason));
    let lines = crate::emit::head::of_module(module, language, origin, &notes.head).into_iter().chain(absent);
    lines.map(|line| format!("{sign} {line}").trim_end().to_string() + "\n").collect()
}

/// Documentation of a function.
pub(super) fn described<'a>(module: &'a Module, function: &Function, notes: &'a Notes) -> (Described<'a>, Option<&'a str>) {
    (documentation::described(function, module), notes.functions.get(&function.name()).map(String::as_str))
}
