//! Illustrates the error of a wrong function: its value and the value of the equations in floats at a state. This proves nothing.

use armgen_description::manipulator::{Coordinate, Manipulator};

use crate::certificate::report::{FunctionReport, Verdict};
use crate::floats::bounds;
use crate::judge::checker::Checker;
use crate::read::reader::Module;
use crate::textbook::base;
use crate::textbook::equations::angles::Angles;
use crate::textbook::equations::state::State;
use crate::textbook::reference::{BaseParameters, Wanted};
use crate::values::arithmetic::Arithmetic;
use crate::values::contract::Promise;
use crate::values::enclosure::Float;
use crate::values::float::Arguments;
use crate::values::formula::Formula;
use crate::values::program::Argument;

/// Floats with a smaller relative difference count as equal.
const AGREE: f64 = 1e-6;

/// Float arithmetic with rounded constants.
struct Floats;

impl Arithmetic for Floats {
    type Element = f64;
    fn integer(&self, value: i64) -> f64 {
        value as f64
    }
    fn constant(&self, formula: &Formula) -> Option<f64> {
        Float::F64.nearest(formula)
    }
    fn draw(&mut self) -> f64 {
        1.0
    }
}

/// Adds to the verdict of each differing function its values and those of the equations at a state within the box.
pub(crate) fn say(functions: &mut [FunctionReport], module: &Module, checker: &Checker, nominal: &[Formula]) {
    if functions.iter().all(|function| !matches!(function.verdict, Verdict::Different { .. })) {
        return;
    }
    let mut domain = bounds::domain_of(checker.manipulator(), module);
    let parameters: Option<Vec<f64>> = nominal.iter().map(|value| Float::F64.nearest(value)).collect();
    domain.pi = parameters.unwrap_or_default().into_iter().map(|value| (value, value)).collect();
    let drawn = bounds::draw(&domain, &mut checker.rest(), Float::F64);
    // Few digits, so that a reader can type them.
    let thousandths = |x: f64| (x * 1e3).round() / 1e3;
    let arguments = Arguments { pi: drawn.pi.clone(), ..drawn.map(thousandths) };
    let state = state(&arguments, checker.manipulator());
    let wanted = Wanted { base: BaseParameters::LeftOut, pivots: false };
    let Ok(equations) = base::values(&mut Floats, checker.manipulator(), checker.vector(), None, state, wanted) else {
        return;
    };
    for function in functions {
        let Verdict::Different { entry, why } = &mut function.verdict else { continue };
        let (Some(program), Some(expected)) = (module.program(&function.name), equations.get(&function.name)) else {
            continue;
        };
        let Some(index) = program.outputs.iter().position(|output| output.place == *entry) else { continue };
        let values = program.run_float(&arguments, module.real);
        let (Some(&found), Some(&right)) = (values.get(index), expected.get(index)) else { continue };
        let place = place(&function.name, &arguments);
        *why += &if (found - right).abs() <= AGREE * found.abs().max(right.abs()) {
            format!("; at {place} both are {right:.6e} to 1e-6: it differs elsewhere, or by less")
        } else {
            format!("; at {place} the module says {found:.6e}, the equations {right:.6e}")
        };
    }
}

fn state(arguments: &Arguments<f64>, manipulator: &Manipulator) -> State<f64> {
    let sign = |rate: &f64| if *rate == 0.0 { 0.0 } else { rate.signum() };
    let of_arm = Angles::of(manipulator);
    let values = of_arm.values(&Floats, &arguments.q).unwrap_or_default();
    let angles = arguments.q.iter().chain(&values).map(|q| q.sin_cos()).collect();
    let computed = of_arm.factors(&Floats).unwrap_or_default();
    let fading = |(rate, of): (&f64, Coordinate<'_>)| {
        of.joint.decay_velocity().map_or(0.0, |velocity| libm::exp(-rate.abs() / velocity.to_f64()))
    };
    let stribeck = arguments.dq.iter().zip(manipulator.coordinates()).map(fading).collect();
    State { stribeck, computed, ..State::of(arguments.clone(), angles, arguments.dq.iter().map(sign).collect(), [0.0, 1.0]) }
}

/// The arguments of a function in readable form; parameters have the values of the description.
fn place(name: &str, arguments: &Arguments<f64>) -> String {
    let promise = Promise::of(name);
    let of = |argument: &&str| {
        let found = Argument::named(argument)?;
        let numbers: Vec<String> = arguments.of(found).iter().map(f64::to_string).collect();
        if numbers.is_empty() {
            return None;
        }
        Some(format!("{argument} = [{}]", numbers.join(", ")))
    };
    let all: Vec<String> = promise.iter().flat_map(|(promise, _)| promise.arguments).filter_map(of).collect();
    all.join(", ")
}
