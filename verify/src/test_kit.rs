//! A test file for a user's project: it checks that the module gives the same results on the user's machine.
//!
//! It contains reference states with the values of every function, computed from the equations in 256 bits and rounded once, and the identities of
//! the dynamics at many states in floats. It needs only the module. Its part common to all robots is `test_kit/template.rs`; each other language
//! (`test_kit/languages.rs`) has its own template.

mod languages;

use std::fmt::Write;

use armgen_description::manipulator::{Coordinate, Manipulator};
use armgen_description::{language::Language, origin::Origin};

use crate::read::marked::{marked, GRAVITY, LOAD, PAYLOAD};
use crate::read::reader::{parameters, Module};
use crate::textbook::base;
use crate::textbook::equations::angles::Angles;
use crate::textbook::equations::arm::formula;
use crate::textbook::equations::parameters::Vector;
use crate::textbook::equations::state::State;
use crate::textbook::reference::{BaseParameters, Wanted, PROMISES};
use crate::values::arithmetic::wide::{wide_circle, Wide, WideArguments};
use crate::values::arithmetic::Arithmetic;
use crate::values::contract::{Promise, Sizes};
use crate::values::enclosure::Float;
use crate::values::float::Arguments;
use crate::values::formula::Formula;
use crate::values::program::{Argument, Inputs};
use crate::values::stream::Stream;

/// Float arithmetic with 256 bits.
struct Fine(Stream);

impl Arithmetic for Fine {
    type Element = Wide;
    fn integer(&self, value: i64) -> Wide {
        Wide::from_f64(value as f64)
    }
    fn constant(&self, formula: &Formula) -> Option<Wide> {
        Wide::from_formula(formula)
    }
    fn draw(&mut self) -> Wide {
        Wide::from_f64(uniform(&mut self.0, 0.5, 2.0))
    }
}

fn uniform(stream: &mut Stream, low: f64, high: f64) -> f64 {
    // Few digits, so that the file is readable and f32 represents them exactly.
    let steps = ((high - low) * 64.0) as u64;
    low + stream.below(steps + 1) as f64 / 64.0
}

const STATES: usize = 3;

/// Random arguments of typical size.
fn arguments(stream: &mut Stream, sizes: &Sizes) -> Arguments<f64> {
    let (n, p) = (sizes.n, sizes.p);
    let mut many = |count: usize, low: f64, high: f64| (0..count).map(|_| uniform(stream, low, high)).collect();
    Arguments {
        q: many(n, -3.0, 3.0),
        dq: many(n, -2.0, 2.0),
        ddq: many(n, -4.0, 4.0),
        dqr: many(n, -2.0, 2.0),
        ddqr: many(n, -4.0, 4.0),
        tau: many(n, -20.0, 20.0),
        pi: many(p, 0.5, 2.0),
        g0: if sizes.gravity { many(3, -10.0, 10.0) } else { Vec::new() },
    }
}

fn wide_state(arguments: &Arguments<f64>, manipulator: &Manipulator) -> Option<State<Wide>> {
    let inputs = WideArguments::new(arguments)?;
    let joints = 0..arguments.q.len();
    let mut angles: Vec<_> = joints.clone().map(|i| inputs.sine_cosine(&[(i, 1)])).collect();
    let (of_arm, fine) = (Angles::of(manipulator), Fine(Stream::new(0)));
    let values = of_arm.values(&fine, &arguments.map(Wide::from_f64).q)?;
    angles.extend(values.iter().map(wide_circle).collect::<Option<Vec<_>>>()?);
    let computed = of_arm.factors(&fine)?;
    let signs = joints.map(|i| Inputs::<Wide>::sign(&inputs, i)).collect();
    let fading = |(i, of): (usize, Coordinate<'_>)| match of.joint.decay_velocity() {
        Some(velocity) => Some(inputs.stribeck(i, &Wide::from_formula(&formula(&velocity))?)),
        None => Some(Wide::from_f64(0.0)),
    };
    let stribeck = manipulator.coordinates().into_iter().enumerate().map(fading).collect::<Option<_>>()?;
    Some(State { stribeck, computed, ..State::of(arguments.map(Wide::from_f64), angles, signs, [0.0, 1.0].map(Wide::from_f64)) })
}

fn list(values: &[f64], real: Float) -> String {
    let digits: Vec<String> = values
        .iter()
        .map(|&value| match real {
            Float::F64 => format!("{value:?}"),
            Float::F32 => format!("{:?}", value as f32),
        })
        .collect();
    digits.join(", ")
}

/// A value from the equations: the function, the state, and the entries by rows.
struct Value {
    name: String,
    promise: &'static Promise,
    with: bool,
    state: usize,
    entries: Vec<f64>,
}

/// The content of a test file, independent of the language.
struct Kit {
    robot: String,
    real: Float,
    sizes: Sizes,
    states: Vec<Arguments<f64>>,
    values: Vec<Value>,
    /// Whether friction depends on the load.
    loaded: bool,
    /// Whether the parameters include those of a payload.
    carries: bool,
}

impl Kit {
    fn of(manipulator: &Manipulator, module: &Module) -> Result<Kit, String> {
        if !manipulator.tips.is_empty() {
            return Err(
                "a test file is for an arm with one end effector; `armgen verify` proves the functions of each of several".into(),
            );
        }
        let missing = Promise::required(&[String::new()]).into_iter().find(|name| module.program(name).is_none());
        if let Some(name) = missing {
            let why = if manipulator.is_massless() { ": nothing in the arm has mass or inertia" } else { "" };
            return Err(format!("a test file is for all functions, and the module has no `{name}`{why}"));
        }
        let vector = Vector::of(manipulator, &crate::judge::constants::parameter_names(module))?;
        let sizes = module.sizes();
        let mut fine = Fine(Stream::new(1));
        let mut stream = Stream::new(20_240_229);
        let present = |name: &str| module.functions.iter().any(|(f, _)| f == name);
        let (states, values, loaded) = (Vec::new(), Vec::new(), present("load_friction"));
        let (robot, carries) = (manipulator.name.clone(), parameters::has_payload(&module.constants));
        let mut kit = Kit { robot, real: module.real, sizes: sizes.clone(), states, values, loaded, carries };
        for index in 0..STATES {
            let arguments = arguments(&mut stream, &sizes);
            let state = wide_state(&arguments, manipulator).ok_or("a joint variable out of reach")?;
            let wanted = Wanted { base: BaseParameters::LeftOut, pivots: false };
            let equations = base::values(&mut fine, manipulator, &vector, None, state, wanted)?;
            for (name, entries) in equations.iter().filter(|(name, _)| present(name)) {
                // The residual judges forward dynamics.
                let Some((promise, with)) = Promise::of(name).filter(|(promise, _)| promise.name != "forward_dynamics") else {
                    continue;
                };
                let entries = nearest(entries);
                kit.values.push(Value { name: name.to_string(), promise, with, state: index, entries });
            }
            kit.states.push(arguments);
        }
        Ok(kit)
    }
}

impl Kit {
    /// The template, which has calls without the acceleration of free fall, with this one where it is an argument; `call` is what a call
    /// begins with.
    fn with_gravity(&self, mut template: String, call: &dyn Fn(&str) -> String, gravity: &str) -> String {
        let takes_it = |promise: &&Promise| self.sizes.gravity && promise.arguments.contains(&Argument::Gravity.name());
        for promise in PROMISES.iter().filter(takes_it) {
            for (name, with) in [(promise.name.to_string(), false), (format!("{}_with", promise.name), true)] {
                let call = call(&name);
                let mut rest = std::mem::take(&mut template);
                while let Some(at) = rest.find(&call) {
                    let inside = rest[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
                    let mut end = at + call.len();
                    if with {
                        // Behind the parameters.
                        end += rest[end..].find(", ").map_or(0, |comma| comma + 2);
                    }
                    template += &rest[..end];
                    if !inside {
                        template += &format!("{gravity}, ");
                    }
                    rest.drain(..end);
                }
                template += &rest;
            }
        }
        template
    }
}

/// The text of the test file. `import` must provide the module as `robot`: `use my_crate::robot;`, or
/// `#[path = "../src/robot.rs"] mod robot;`.
pub fn test_kit(manipulator: &Manipulator, module: &Module, import: &str, origin: &Origin) -> Result<String, String> {
    let kit = Kit::of(manipulator, module)?;
    let mut text = format!(
        "// Tests of the robot `{}` on your machine: reference values, computed from its equations in 256 bits, and the identities of its\n\
         // dynamics. Written by {}.\n\n{import}\n\nuse robot::*;\n\n",
        kit.robot,
        origin.made_by()
    );
    let write = |v: &[f64]| list(v, kit.real);
    let _ = writeln!(
        text,
        "/// States at which values are known.\n#[rustfmt::skip]\nconst STATES: [Arguments; {STATES}] = [\n{}];\n",
        kit.states.iter().fold(String::new(), |mut states, arguments| {
            let gravity = if kit.sizes.gravity { format!(", g0: [{}]", write(&arguments.g0)) } else { String::new() };
            let _ = writeln!(
                states,
                "    Arguments {{ q: [{}], dq: [{}], ddq: [{}], dqr: [{}], ddqr: [{}], tau: [{}], pi: [{}]{gravity} }},",
                write(&arguments.q),
                write(&arguments.dq),
                write(&arguments.ddq),
                write(&arguments.dqr),
                write(&arguments.ddqr),
                write(&arguments.tau),
                write(&arguments.pi)
            );
            states
        })
    );
    let mut values = String::new();
    for Value { name, promise, with, state, entries } in &kit.values {
        let arguments = promise.arguments_of(*with, kit.sizes.gravity);
        let call: Vec<String> = arguments.iter().map(|a| format!("&STATES[{state}].{}", a.name())).collect();
        let _ = writeln!(
            values,
            "        (\"{name}\", {state}, robot::{name}({}).flat(), vec![{}]),",
            call.join(", "),
            list(entries, kit.real)
        );
    }
    let _ = writeln!(
        text,
        "/// Function, number of the state, value on this machine, value from the equations.\n#[rustfmt::skip]\n\
         fn values() -> Vec<(&'static str, usize, Vec<Real>, Vec<Real>)> {{\n    vec![\n{values}    ]\n}}\n"
    );
    let template = include_str!("test_kit/template.rs").split_once("// BEGIN\n").map_or("", |(_, rest)| rest);
    let template = marked(template, "//", &[(LOAD, kit.loaded), (PAYLOAD, kit.carries), (GRAVITY, kit.sizes.gravity)]);
    text += &kit.with_gravity(template, &|name| format!("{name}("), "&FREE_FALL");
    Ok(text)
}

/// The text of the test file in another language than Rust; `name` is the name of the imported module: a file in C or JavaScript, a module in
/// Python, a package in MATLAB.
pub fn in_language(
    manipulator: &Manipulator,
    module: &Module,
    language: Language,
    name: &str,
    origin: &Origin,
) -> Result<String, String> {
    Ok(languages::print(&Kit::of(manipulator, module)?, language, name, origin))
}

/// The nearest floats up to the last bit, with an unsigned 0.
///
/// The 256 bits round, so an identically zero entry becomes some 2^-256 of its summands. Values below 2^-200 of the largest entry become 0; no test
/// in floats could distinguish them.
fn nearest(entries: &[Wide]) -> Vec<f64> {
    let entries: Vec<f64> = entries.iter().map(|entry| entry.to_f64()).collect();
    let largest = entries.iter().fold(1.0f64, |largest, x| largest.max(x.abs()));
    entries.into_iter().map(|x| if x.abs() < largest * ROUNDING { 0.0 } else { x }).collect()
}

/// 2^-200.
const ROUNDING: f64 = 1.0 / (1u128 << 100) as f64 / (1u128 << 100) as f64;

#[cfg(test)]
mod tests {
    use super::{nearest, Wide};
    use crate::values::element::Element;

    #[test]
    fn what_256_bits_leave_of_a_zero_is_zero() {
        let of = Wide::from_f64;
        // 1/3 rounds: three times it is 1 up to the last bit.
        let third = of(1.0).times(&of(3.0).inverse().unwrap());
        let left = third.times(&of(3.0)).minus(&of(1.0));
        assert!(left.to_f64() != 0.0);
        assert_eq!(nearest(&[left, of(-2.5), of(1e-50)]), [0.0, -2.5, 1e-50]);
    }
}
