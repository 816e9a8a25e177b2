//! A companion module: for every function of a module one that returns the running error bound of its entries at a state.
//!
//! For z = fl(x ∘ y) = (x ∘ y)(1 + δ), |δ| ≤ u, with |x - x*| ≤ e_x and |y - y*| ≤ e_y (Higham, 2002, Sect. 3.3):
//!
//! ```text
//! sum, difference   e_z = e_x + e_y + u |z|
//! product           e_z = |x| e_y + |y| e_x + e_x e_y + u |z|
//! fused x y + w     e_z = |x| e_y + |y| e_x + e_x e_y + e_w + u |z|: one rounding
//! quotient          e_z = (e_x + |x/y| e_y) / (|y| - e_y) + u |z|
//! sine, cosine      e = 2 u |s|: one unit in the last place; of a sum of k angles besides k u (|q_1| + ... + |q_k|),
//!                   a constant angle among them, with what its literal is off by
//! exponential       e = (2 + 2 |dq| / v) u exp(-|dq| / v), and 1e-17 where that is taken to be 0
//! sign of a value   e = 0; 2 where |x| ≤ e_x
//! literal           e = u |c|, 0 where the float is the exact value
//! ```
//!
//! Functions that divide, and long ones of few entries, are bounded by sensitivities, as the text says that is taken in:
//! `companion/template.rs`. The companion holds the steps of each function as a table and runs through it. The checker runs the same text
//! on the same tables: what is measured is what is emitted.

use std::fmt::Write;

use crate::read::claims::Claims;
use crate::read::marked::{marked, FUSED, GRAVITY, LOAD, STRIBECK};
use crate::read::reader::Module;
use crate::values::contract::{of_module, Promise};
use crate::values::enclosure::Float;
use crate::values::float::{Arguments, LANES};
use crate::values::program::{Angle, Argument, Program, Step};
use crate::values::ranges::{is_power_of_two, literal_errors};

/// The text taken in, as a module of this crate in each scalar: the same lines that companions have.
macro_rules! face {
    ($name:ident, $real:ty, $sincos:path) => {
        #[allow(missing_docs, unreachable_pub, dead_code)]
        mod $name {
            type Real = $real;
            fn sin_cos(x: Real) -> (Real, Real) {
                $sincos(x)
            }
            include!("companion/template.rs");
            include!("companion/stribeck.rs");
            include!("companion/sign.rs");
            include!("../read/reader/sines/stribeck.rs");
            include!("companion/lanes.rs");

            use crate::values::float::{Arguments, LANES};

            /// A program as a table of any length.
            pub(super) fn run(
                steps: &[super::Row],
                angles: &[super::Sum],
                entries: &[u32],
                sensitive: bool,
                given: &Arguments<f64>,
            ) -> Vec<(f64, f64)> {
                let single = given.map(|x| x as Real);
                let given = Given {
                    pi: &single.pi,
                    q: &single.q,
                    dq: &single.dq,
                    ddq: &single.ddq,
                    dqr: &single.dqr,
                    ddqr: &single.ddqr,
                    tau: &single.tau,
                    g0: &single.g0,
                };
                let steps: Vec<Step> = steps.iter().map(step).collect();
                let mut values = vec![NOTHING; steps.len()];
                let sums: Vec<_> = angles.iter().map(terms).collect();
                let angles: Vec<Angle<'_>> = sums.iter().zip(angles).map(|(terms, sum)| angle_of(terms, sum)).collect();
                forward(&steps, &angles, &given, &mut values);
                let mut scratch = vec![NOTHING; if sensitive { steps.len() } else { 0 }];
                let mut bounds = vec![0.0; entries.len()];
                all_bounds(&steps, entries, &values, &mut scratch, &mut bounds);
                entries.iter().zip(bounds).map(|(&e, bound)| (f64::from(values[e as usize].value), f64::from(bound))).collect()
            }

            fn terms(sum: &super::Sum) -> Vec<(u32, Real)> {
                sum.terms.iter().map(|&(joint, factor)| (joint as u32, factor as Real)).collect()
            }

            fn angle_of<'a>(terms: &'a [(u32, Real)], sum: &super::Sum) -> Angle<'a> {
                Angle { terms, turn: sum.turn as Real, off: sum.off as Real }
            }

            fn name(argument: crate::values::program::Argument) -> Name {
                use crate::values::program::Argument;
                match argument {
                    Argument::Pi => Name::Pi,
                    Argument::Q => Name::Q,
                    Argument::Dq => Name::Dq,
                    Argument::Ddq => Name::Ddq,
                    Argument::Dqr => Name::Dqr,
                    Argument::Ddqr => Name::Ddqr,
                    Argument::Tau => Name::Tau,
                    Argument::Gravity => Name::Gravity,
                }
            }

            fn step(row: &super::Row) -> Step {
                use super::Row;
                match *row {
                    Row::In(argument, index) => Step::In(name(argument), index),
                    Row::Lit(value, error) => Step::Lit(value as Real, error as Real),
                    Row::Sin(joint) => Step::Sin(joint),
                    Row::Cos(joint) => Step::Cos(joint),
                    Row::Sign(joint) => Step::Sign(joint),
                    Row::Stribeck(joint, velocity) => Step::Stribeck(joint, velocity as Real),
                    Row::SignOf(a) => Step::SignOf(a),
                    Row::Neg(a) => Step::Neg(a),
                    Row::Add(a, b) => Step::Add(a, b),
                    Row::Sub(a, b) => Step::Sub(a, b),
                    Row::Mul(a, b) => Step::Mul(a, b),
                    Row::Scale(a, b) => Step::Scale(a, b),
                    Row::Fma(a, b, c) => Step::Fma(a, b, c),
                    Row::Div(a, b) => Step::Div(a, b),
                }
            }
        }
    };
}

face!(double, f64, libm::sincos);
face!(single, f32, libm::sincosf);

/// A step of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Row {
    In(Argument, u32),
    Lit(f64, f64),
    Sin(u32),
    Cos(u32),
    Sign(u32),
    Stribeck(u32, f64),
    SignOf(u32),
    Neg(u32),
    Add(u32, u32),
    Sub(u32, u32),
    Mul(u32, u32),
    Scale(u32, u32),
    Fma(u32, u32, u32),
    Div(u32, u32),
}

/// A sum of joint variables, each with its factor, and a constant with what its literal is off by; 0 where there is none.
#[derive(Clone, Debug, PartialEq)]
struct Sum {
    terms: Vec<(usize, f64)>,
    turn: f64,
    off: f64,
}

/// The table of a function: its steps and which of them are its entries.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    rows: Vec<Row>,
    angles: Vec<Sum>,
    entries: Vec<u32>,
    sensitive: bool,
    real: Float,
}

/// Functions of more steps than this are long, those of more entries have many: each entry takes a run backwards.
const LONG: usize = 500;
const MANY: usize = 64;

impl Table {
    /// The table of a program whose literals are off by `errors`.
    pub fn of(program: &Program, errors: &[f64], real: Float) -> Result<Table, String> {
        let mut angles: Vec<Sum> = Vec::new();
        let mut number_of = |angle: &Angle| {
            let constant = angle.turn.map(|(k, minus)| (program.turns[k], minus));
            let turn = constant.map_or(0.0, |(l, minus)| program.literals[l].value * if minus { -1.0 } else { 1.0 });
            let factor = |i: usize| angle.factors.get(i).copied().flatten();
            let scale = |i: usize| factor(i).map_or(1.0, |literal| program.literals[literal].value);
            let mut terms: Vec<(usize, f64)> =
                angle.terms.iter().enumerate().map(|(i, &(joint, sign))| (joint, sign as f64 * scale(i))).collect();
            // A term of factor 0 counts one rounding more of all: that of factors to their literals.
            if (0..terms.len()).any(|i| factor(i).is_some_and(|literal| errors[literal] != 0.0)) {
                terms.push((terms[0].0, 0.0));
            }
            let sum = Sum { terms, turn, off: constant.map_or(0.0, |(l, _)| errors[l]) };
            let index = angles.iter().position(|known| *known == sum).unwrap_or_else(|| {
                angles.push(sum);
                angles.len() - 1
            });
            index as u32
        };
        let exact_power = |step: usize| match program.steps[step] {
            Step::Literal(l) => errors[l] == 0.0 && is_power_of_two(program.literals[l].value),
            _ => false,
        };
        let mut row = |step: &Step| -> Result<Row, String> {
            let number = |step: &usize| *step as u32;
            Ok(match step {
                Step::Input(argument, index) => Row::In(*argument, *index as u32),
                Step::Literal(l) => Row::Lit(program.literals[*l].value, errors[*l]),
                Step::Sine(angle) => Row::Sin(number_of(angle)),
                Step::Cosine(angle) => Row::Cos(number_of(angle)),
                Step::Sign(joint) => Row::Sign(*joint as u32),
                Step::Stribeck(joint, velocity) => Row::Stribeck(*joint as u32, program.literals[*velocity].value),
                Step::SignOf(a) => Row::SignOf(number(a)),
                Step::Negate(a) => Row::Neg(number(a)),
                Step::Add(a, b) => match program.factors(*a) {
                    Some((x, y)) => Row::Fma(number(&x), number(&y), number(b)),
                    None => Row::Add(number(a), number(b)),
                },
                Step::Subtract(a, b) => Row::Sub(number(a), number(b)),
                Step::Multiply(a, b) if exact_power(*a) || exact_power(*b) => Row::Scale(number(a), number(b)),
                // Of a product in a fused sum nothing but its place is of use: the sum takes its factors.
                Step::Multiply(a, b) | Step::Product(a, b) => Row::Mul(number(a), number(b)),
                Step::Divide(a, b) => Row::Div(number(a), number(b)),
            })
        };
        let rows = program.steps.iter().map(&mut row).collect::<Result<Vec<Row>, String>>()?;
        let entries = program.outputs.iter().map(|output| output.step as u32).collect();
        let divides = !program.divisors().is_empty();
        let sensitive = divides || program.steps.len() > LONG && program.outputs.len() <= MANY;
        Ok(Table { rows, angles, entries, sensitive, real })
    }

    /// The same with bounds by sensitivities for all entries.
    #[must_use]
    pub fn sensitive(self) -> Table {
        Table { sensitive: true, ..self }
    }

    /// Ready to run in lanes.
    pub fn lanes(&self) -> LaneTable {
        match self.real {
            Float::F64 => LaneTable(Sorts::Double(double::Lanes::new(&self.rows, &self.angles, &self.entries, self.sensitive))),
            Float::F32 => LaneTable(Sorts::Single(single::Lanes::new(&self.rows, &self.angles, &self.entries, self.sensitive))),
        }
    }

    /// Value and running error bound of each entry, in the module's scalar; the arguments are rounded to it first.
    pub fn run(&self, arguments: &Arguments<f64>) -> Vec<(f64, f64)> {
        match self.real {
            Float::F64 => double::run(&self.rows, &self.angles, &self.entries, self.sensitive, arguments),
            Float::F32 => single::run(&self.rows, &self.angles, &self.entries, self.sensitive, arguments),
        }
    }
}

/// Arguments in lanes.
#[derive(Debug)]
pub struct LaneArguments(Sides);

#[derive(Debug)]
enum Sides {
    Double(double::Side),
    Single(single::Side),
}

impl LaneArguments {
    /// The states in the scalar of a module; they are rounded to it first.
    pub fn new(states: &[Arguments<f64>; LANES], real: Float) -> LaneArguments {
        LaneArguments(match real {
            Float::F64 => Sides::Double(double::Side::new(states)),
            Float::F32 => Sides::Single(single::Side::new(states)),
        })
    }
}

/// The table of a function that runs at many states side by side.
#[derive(Clone, Debug)]
pub struct LaneTable(Sorts);

#[derive(Clone, Debug)]
enum Sorts {
    Double(double::Lanes),
    Single(single::Lanes),
}

impl LaneTable {
    /// Runs the function, at arguments of its scalar.
    pub fn run(&mut self, arguments: &LaneArguments) {
        match (&mut self.0, &arguments.0) {
            (Sorts::Double(lanes), Sides::Double(side)) => lanes.forward(side),
            (Sorts::Single(lanes), Sides::Single(side)) => lanes.forward(side),
            _ => unreachable!("arguments of the other scalar"),
        }
    }

    /// Value and running error of a step.
    pub fn step(&self, step: usize) -> ([f64; LANES], [f64; LANES]) {
        match &self.0 {
            Sorts::Double(lanes) => lanes.step(step),
            Sorts::Single(lanes) => lanes.step(step),
        }
    }

    /// The running bound of a step.
    pub fn running(&self, step: usize) -> [f64; LANES] {
        match &self.0 {
            Sorts::Double(lanes) => lanes.running(step),
            Sorts::Single(lanes) => lanes.running(step),
        }
    }

    /// The bound of the step that an entry is.
    pub fn bound(&mut self, entry: usize) -> [f64; LANES] {
        match &mut self.0 {
            Sorts::Double(lanes) => lanes.bound(entry as u32),
            Sorts::Single(lanes) => lanes.bound(entry as u32),
        }
    }
}

/// The text of the companion. `import` brings in `Real`, `DOF`, `PARAMETERS`, `TASK_ROWS` and `EquationsOfMotion`: `use super::robot::*;`.
pub fn companion(module: &Module, claims: &Claims, import: &str) -> Result<String, String> {
    let sincos = match module.real {
        Float::F64 => "libm::sincos",
        Float::F32 => "libm::sincosf",
    };
    let mut text = format!(
        "//{}\n//\n// Running error bounds of the functions of a robot: how far rounding can have taken each entry \
         from the exact\n// value, in the units of the entry, at the arguments given (taken as exact). Sines and cosines are taken to be right to one\n// unit \
         in the last place. Infinite where a divisor cannot be told from 0. For tests and analysis: a bound costs many times\n// the function, and what \
         it knows of each step lies on the stack.\n\n{import}\n\nuse self::Name::*;\nuse self::Step::*;\n\n",
        module.head.first().map_or("", String::as_str)
    );
    for (name, function) in &module.functions {
        let program = &function.as_ref().map_err(|e| format!("`{name}`: {e}"))?.program;
        let (promise, _) = Promise::of(name).ok_or(format!("`{name}` is not known"))?;
        let values = claims.resolve(name, &program.literals, module.real).values.clone();
        let table = Table::of(program, &literal_errors(program, &values, module.real), module.real)?;
        write_function(&mut text, program, &table, promise, module);
    }
    let _ =
        write!(text, "/// Sine and cosine of an angle in rad.\nfn sin_cos(x: Real) -> (Real, Real) {{\n    {sincos}(x)\n}}\n\n");
    let has = |wanted: fn(&Step) -> bool| module.programs().any(|(_, program)| program.steps.iter().any(wanted));
    let (fades, loaded) = (has(|step| matches!(step, Step::Stribeck(..))), has(|step| matches!(step, Step::SignOf(_))));
    let fused = has(|step| matches!(step, Step::Product(..)));
    let parts = [
        (include_str!("../read/reader/sines/stribeck.rs"), fades),
        (include_str!("companion/stribeck.rs"), fades),
        (include_str!("companion/sign.rs"), loaded),
    ];
    parts.iter().filter(|(_, wanted)| *wanted).for_each(|(part, _)| text += &format!("{part}\n"));
    let template = include_str!("companion/template.rs").split_once("// BEGIN\n").map_or("", |(_, rest)| rest);
    let gravity = module.sizes().gravity;
    let template = marked(template, "//", &[(STRIBECK, fades), (LOAD, loaded), (FUSED, fused), (GRAVITY, gravity)]);
    // The one field within a line.
    text += &if gravity { template } else { template.replace(", g0: &[] }", " }") };
    Ok(text)
}

/// Sizes of an arm for the bound of inverse kinematics.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extent {
    /// The largest distance of a link frame from the axis of its joint, m, of those joints that turn about an axis on which the frame of the link
    /// before them is not either; of others 0.
    pub lever: f64,
    /// The sum of |dq_i/dp_j| of the joints up to the end effector that turn, over all coordinates, with room for rounding.
    pub turning: f64,
    /// That of the joints that slide.
    pub sliding: f64,
}

/// What follows in the companion of a module with inverse kinematics: `inverse_kinematics_error_bound`, how far an exact solution is from joint
/// variables. A comment for an arm whose task has not as many rows as it has joints: nothing can be inverted there.
pub fn of_inverse_kinematics(module: &Module, extent: Extent) -> String {
    let sizes = module.sizes();
    if !sizes.tips.is_empty() {
        return "\n// There is no `inverse_kinematics_error_bound` of an arm with several end effectors.\n".into();
    }
    if sizes.m != sizes.n {
        return "\n// There is no `inverse_kinematics_error_bound`: the task has not as many rows as the arm has joints.\n"
            .into();
    }
    let needed = ["direct_kinematics", "link_frames", "geometric_jacobian"];
    if needed.iter().any(|name| module.program(name).is_none()) {
        return format!(
            "\n// There is no `inverse_kinematics_error_bound`: the module was generated without one of {}.\n",
            needed.join(", ")
        );
    }
    let root = match module.real {
        Float::F64 => "libm::sqrt",
        Float::F32 => "libm::sqrtf",
    };
    let mut text = include_str!("companion/inverse_kinematics.rs.txt").replace("{root}", root);
    let Extent { lever, turning, sliding } = extent;
    if lever > 0.0 {
        let start = format!("    // Beside the frames there is an axis, up to so far from the frame after it.\n    let (mut length, mut last) = ({lever:?}, ");
        text = text.replace("    let (mut length, mut last) = (0.0, ", &start);
    }
    if sizes.joints.is_none() {
        return text;
    }
    // Each joint counts by the change of its variable as coordinates change by at most 1.
    let (before, rest) = text.split_once("    let turning =").expect("the joints are counted");
    let (_, behind) = rest.split_once("    // Slides can").expect("then the length is taken");
    let (before, behind) = (about_coordinates(before), about_coordinates(behind));
    let counts = format!("    let (turning, sliding): (Real, Real) = ({turning:?}, {sliding:?});\n");
    before + &counts + "    // Slides can" + &behind
}

/// A text about an arm's joint variables as one about coordinates of coupled joints.
fn about_coordinates(text: &str) -> String {
    let text = text.replace("in the joint variable that differs most", "in the coordinate that differs most");
    text.replace(
        "k = l r² + 2 r s for r joints that turn and s that slide",
        "k = l r² + 2 r s, r and s the sums of |dq_i/dp_j| of the joints that turn and that slide",
    )
}

fn number(value: f64, real: Float) -> String {
    match real {
        Float::F64 => format!("{value:?}"),
        Float::F32 => format!("{:?}", value as f32),
    }
}

fn row_text(row: &Row, real: Float) -> String {
    match *row {
        Row::Lit(value, error) => format!("Lit({}, {})", number(value, real), number(error, real)),
        Row::Stribeck(joint, velocity) => format!("Stribeck({joint}, {})", number(velocity, real)),
        other => format!("{other:?}"),
    }
}

fn write_function(text: &mut String, program: &Program, table: &Table, promise: &Promise, module: &Module) {
    let typed = |a: &Argument| format!("{}: &[Real; {}]", a.name(), a.length().rust());
    let arguments: Vec<String> = program.arguments.iter().map(typed).collect();
    let given: Vec<&str> = program.arguments.iter().map(|a| a.name()).collect();
    let sizes = module.sizes().of_function(&program.name);
    let angle = |sum: &Sum| {
        let terms: Vec<String> =
            sum.terms.iter().map(|(joint, factor)| format!("({joint}, {})", number(*factor, module.real))).collect();
        let [turn, off] = [sum.turn, sum.off].map(|value| number(value, module.real));
        format!("Angle {{ terms: &[{}], turn: {turn}, off: {off} }}", terms.join(", "))
    };
    let angles: Vec<String> = table.angles.iter().map(angle).collect();
    let rows: Vec<String> = table.rows.iter().map(|row| row_text(row, module.real)).collect();
    let entries: Vec<String> = table.entries.iter().map(ToString::to_string).collect();
    let results: Vec<String> = (0..entries.len()).map(|i| format!("e[{i}]")).collect();
    let value = promise.returned.value(&results, &sizes);
    let value = if results.is_empty() { format!("{{ let _ = e; {value} }}") } else { value };
    let name = &program.name;
    let _ = write!(
        text,
        "/// Running error bound of `{name}`, entry by entry.\n#[allow(clippy::all, dead_code)]\n#[rustfmt::skip]\npub fn {name}_error_bound({}) -> {} {{\n    static \
         STEPS: [Step; {}] = [{}];\n    static ANGLES: [Angle<'static>; {}] = [{}];\n    static ENTRIES: [u32; {}] = [{}];\n    let e = bounds::<_, _, {}>(&STEPS, &ANGLES, &ENTRIES, &Given {{ {}, ..NONE }});\n    {}\n}}\n\n",
        arguments.join(", "),
        of_module(&program.name, sizes.joints.is_some(), &promise.returned.rust()).replace(';', "; ").replace(',', ", "),
        rows.len(),
        rows.join(", "),
        angles.len(),
        angles.join(", "),
        entries.len(),
        entries.join(", "),
        if table.sensitive { rows.len() } else { 0 },
        given.join(", "),
        value,
    );
}
