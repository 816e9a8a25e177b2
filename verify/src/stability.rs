//! Whether rounding leaves of a function what the equations say: a function can equal them over the real numbers and be useless in floats,
//! as `x + 1e17 - 1e17` is.
//!
//! With u the unit roundoff of the scalar, n the number of joints, S the largest size of an entry at some states, e the bound of the function at a state
//! (both computed in f64), and E the one of a plain program of the equations there ([`Running`]):
//!
//! ```text
//! (a)  no value leaves the scalar anywhere in the wide box, or is above 2^64 max(1, S, |x|)³ there, x the arguments
//! (b)  the bound over the wide box is at most 2^(12 + 5n/2) u S
//! (c)  at each of 32 states e is at most 2^(12 + n/2) u S
//! (d)  and at most 2^4 of the largest E; of functions that divide of E at that state, at the random ones, where E leaves 29 bits of the largest entry
//! (e)  no argument has a higher degree than in the equations (growth.rs)
//! ```
//!
//! The wide box has all angles, prismatic joints as far to one side as to the other, and all parameters up to the largest of the description.
//! By (e) what is found in it holds outside, multiplied by at most the powers of the equations. (a) and (b) are of the whole box and follow from intervals,
//! which widen by a factor with each joint; (c) and (d) are sharp, and of states alone: half of them random, half with arguments at the ends of the box, all
//! drawn from the hash of the module. Emitted functions stay below 2^19 u S over the box and below 2^10 u S at states with seven joints, 2^39 and 2^16 with
//! sixteen, and below 2 E: a loss of four more digits than that is refused over the box, of one at states, in f32 and in f64.
//!
//! Of functions that divide, what no quotient takes part in is held to (a), (b) and (c) where it meets the first one, the whole to (d).
//! Intervals say nothing behind a quotient in general; of `forward_dynamics` the bound of torques ([`mod@crate::residual`]) does.

use std::collections::BTreeMap;

use armgen_codegen::manipulator::{Joint, Manipulator};

use crate::arithmetic::running::{Running, RunningNumbers};
use crate::bounds::{corner, draw, two_digits, undivided_bound, widened, Parameters};
use crate::check::Check;
use crate::checker::Checker;
use crate::companion::{LaneArguments, Table};
use crate::divisors::undivided_operands;
use crate::enclosure::Float;
use crate::equations::arm::formula;
use crate::equations::parameters::Vector;
use crate::equations::state::State;
use crate::float::{stribeck, stribeck_error, Arguments, LANES};
use crate::formula::Formula;
use crate::program::{Argument, Program};
use crate::ranges::{literal_errors, worst, Domain};
use crate::reader::Module;
use crate::reference::{BaseParameters, Reference, Wanted};
use crate::report::Unfit;

/// As many times the error that the equations themselves have.
const FACTOR: f64 = 16.0;

/// Where the equations themselves lose more units of the last place nothing is asked for.
const LOST: f64 = (1 << 24) as f64;

/// Batches of states.
const BATCHES: usize = 4;

/// States at which functions of a module are run.
pub struct Trial<'a> {
    module: &'a Module,
    joints: usize,
    batches: Vec<([Arguments<f64>; LANES], LaneArguments)>,
    /// By function, state by state: the largest error of an entry that the equations themselves have in f64, and the size of the largest.
    plain: BTreeMap<String, Vec<(f64, f64)>>,
    /// The box without limits of angles, all parameters up to the largest.
    wide: Domain,
    /// The largest size of an argument there.
    arguments: f64,
    /// The same box with the parameters of the description.
    described: Domain,
}

/// The arm at some states, in numbers that know their errors.
fn running(states: &[Arguments<f64>; LANES], manipulator: &Manipulator) -> State<Running> {
    let arguments = Arguments::gather(states, Running::exact);
    let circle = |q: &Running| {
        let both = q.value.map(libm::sincos);
        // One unit in the last place each.
        (Running::rounded(both.map(|(sine, _)| sine), 2.0), Running::rounded(both.map(|(_, cosine)| cosine), 2.0))
    };
    let sign = |rate: &Running| Running::exact(rate.value.map(|x| if x == 0.0 { 0.0 } else { x.signum() }));
    let (angles, signs) = (arguments.q.iter().map(circle).collect(), arguments.dq.iter().map(sign).collect());
    let fading = |(rates, joint): (&Running, &Joint)| {
        let velocity = joint.stribeck.as_ref().and_then(|stribeck| Float::F64.nearest(&formula(&stribeck.velocity)));
        velocity.map_or(Running::exact([0.0; LANES]), |velocity| {
            let one = |lane: usize| {
                let x = rates.value[lane].abs() / velocity;
                let value = stribeck(rates.value[lane], velocity);
                (value, stribeck_error(x, value, Float::F64))
            };
            let both: [(f64, f64); LANES] = std::array::from_fn(one);
            Running { value: both.map(|(value, _)| value), error: both.map(|(_, error)| error) }
        })
    };
    let stribeck = arguments.dq.iter().zip(&manipulator.joints).map(fading).collect();
    State { stribeck, ..State::of(arguments, angles, signs, [0.0, 1.0].map(|x| Running::exact([x; LANES]))) }
}

/// Largest error and largest size of the entries of a function at each state.
fn largest(entries: &[Running]) -> [(f64, f64); LANES] {
    std::array::from_fn(|k| {
        (worst(entries.iter().map(|entry| entry.error[k])), worst(entries.iter().map(|entry| entry.value[k].abs())))
    })
}

impl<'a> Trial<'a> {
    /// States of a box, for the functions of a module that equal the equations.
    pub fn new(module: &'a Module, domain: &Domain, checker: &Checker) -> Trial<'a> {
        let stream = &mut checker.rest();
        let manipulator = checker.manipulator();
        let wide = widened(manipulator, domain, Parameters::Any);
        let near = widened(manipulator, domain, Parameters::Described);
        let batch = |k: usize| {
            let states = std::array::from_fn(|_| match k % 2 {
                0 => draw(&near, stream, module.real),
                _ => corner(&wide, stream, module.real),
            });
            let lanes = LaneArguments::new(&states, Float::F64);
            (states, lanes)
        };
        let batches: Vec<_> = (0..BATCHES).map(batch).collect();
        let mut plain: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
        for (states, _) in &batches {
            let mut state = running(states, manipulator);
            let mut numbers = RunningNumbers::default();
            if matches!(checker.vector(), Vector::Base(..)) {
                numbers.given = std::mem::take(&mut state.pi).into();
            }
            let wanted = Wanted { base: BaseParameters::Kept, pivots: false };
            let Ok(reference) = Reference::at(&mut numbers, manipulator, checker.vector(), state, wanted) else { continue };
            for (name, entries) in &reference.values {
                plain.entry(name.clone()).or_default().extend(largest(entries));
            }
        }
        plain.retain(|_, states| states.len() == BATCHES * LANES);
        let ranges = Argument::ALL.into_iter().flat_map(|argument| wide.of(argument));
        let arguments = worst(ranges.map(|(low, high)| low.abs().max(high.abs())));
        Trial { module, joints: manipulator.joints.len(), batches, plain, wide, described: near, arguments }
    }

    fn states(&self) -> impl Iterator<Item = &Arguments<f64>> {
        self.batches.iter().flat_map(|(states, _)| states)
    }

    /// What makes a function useless in floats, if it is.
    pub fn fault(&self, program: &Program, values: &[Formula]) -> Option<Unfit> {
        let operands = undivided_operands(program);
        if operands.is_empty() {
            return self.undivided_fault(program, values, true);
        }
        self.undivided_fault(&program.part(&operands), values, false).or_else(|| self.divided_fault(program, values))
    }

    /// Of a whole function, or of what no quotient takes part in.
    fn undivided_fault(&self, program: &Program, values: &[Formula], whole: bool) -> Option<Unfit> {
        let real = self.module.real;
        let over = |domain: &Domain| undivided_bound(program, values, domain, real);
        // Where masses of 1e12 kg stand beside inertias of 1e-12 kg m², each as large as the largest is beyond f32.
        let wide = Some(over(&self.wide)).filter(|(bound, _)| bound.is_finite());
        let (bound, largest) = wide.unwrap_or_else(|| over(&self.described));
        if !bound.is_finite() && Check::Leaves.is_made() {
            return Some(Unfit::Leaves(format!("a value can leave {} inside the box", real.name())));
        }
        let runs = self.runs(program, values)?;
        let size = runs.iter().flatten().fold(0.0f64, |size, (value, _)| size.max(value.abs()));
        if !size.is_finite() && Check::Headroom.is_made() {
            return Some(Unfit::Leaves("a value can leave f64 at a state of the box".into()));
        }
        let headroom = 2f64.powi(64) * size.max(self.arguments).max(1.0).powi(3);
        if largest > headroom && Check::Headroom.is_made() {
            let (largest, size) = (two_digits(largest), two_digits(size));
            return Some(Unfit::Leaves(format!(
                "values of up to {largest} on the way to entries of up to {size} can leave the scalar"
            )));
        }
        let most = |exponent: f64, real: Float| exponent.exp2() * (real.unit() * size + real.smallest_normal());
        let n = self.joints as f64;
        let allowed = most(12.0 + 2.5 * n, real);
        if exceeds(bound, allowed) && Check::Box.is_made() {
            return Some(too_much("anywhere in the box", bound, allowed, size));
        }
        let error = largest_error(runs.iter().flatten());
        let mut allowed = most(12.0 + 0.5 * n, Float::F64);
        if let Some(plain) = whole.then(|| self.plain.get(&program.name)).flatten().filter(|_| Check::Plain.is_made()) {
            let errors = plain.iter().map(|(error, _)| *error);
            allowed = allowed.min(FACTOR * (errors.fold(0.0, f64::max) + Float::F64.unit() * size + f64::MIN_POSITIVE));
        }
        (exceeds(error, allowed) && Check::States.is_made())
            .then(|| too_much("in f64, at a state of the box", error, allowed, size))
    }

    fn divided_fault(&self, program: &Program, values: &[Formula]) -> Option<Unfit> {
        let (real, unit) = (self.module.real, Float::F64.unit());
        let runs = self.runs(program, values)?;
        let plain = self.plain.get(&program.name)?;
        let judged = runs.iter().zip(plain).zip(self.states()).enumerate().filter(|(k, _)| (k / LANES).is_multiple_of(2));
        // Not at the ends of the box: where the arm is exactly singular, errors are as large as what they are errors of.
        for (_, ((run, (error, size)), state)) in judged {
            let lost = error / (unit * size);
            let found = largest_error(run);
            let allowed = FACTOR * (error + unit * size + f64::MIN_POSITIVE);
            if lost < LOST && exceeds(found, allowed) && Check::DividedStates.is_made() {
                return Some(too_much("in f64, at a state of the box", found, allowed, *size));
            }
            // Of a single number the quotients alone are finite in f64.
            if Check::DividedLeaves.is_made()
                && FACTOR * lost * real.unit() < 1.0
                && program.run_float(state, real).iter().any(|value| !value.is_finite())
            {
                return Some(Unfit::Leaves(format!("a value leaves {} at a state of the box", real.name())));
            }
        }
        None
    }

    /// Values and errors of the results in f64, state by state; the arguments are those of the module's scalar.
    fn runs(&self, program: &Program, values: &[Formula]) -> Option<Vec<Vec<(f64, f64)>>> {
        let errors = literal_errors(program, values, Float::F64);
        let mut table = Table::of(program, &errors, Float::F64).ok()?.lanes();
        let mut runs = vec![Vec::with_capacity(program.outputs.len()); self.batches.len() * LANES];
        for (k, (_, lanes)) in self.batches.iter().enumerate() {
            table.run(lanes);
            let mut known: BTreeMap<usize, [f64; LANES]> = BTreeMap::new();
            for output in &program.outputs {
                let (value, _) = table.step(output.step);
                let error = *known.entry(output.step).or_insert_with(|| table.bound(output.step));
                for lane in 0..LANES {
                    runs[k * LANES + lane].push((value[lane], error[lane]));
                }
            }
        }
        Some(runs)
    }
}

/// The largest error among values with their errors.
fn largest_error<'a>(values: impl IntoIterator<Item = &'a (f64, f64)>) -> f64 {
    worst(values.into_iter().map(|(_, error)| *error))
}

/// Whether a is larger than b, or one of the two is not a number.
fn exceeds(a: f64, b: f64) -> bool {
    a > b || a.is_nan() || b.is_nan()
}

fn too_much(place: &str, error: f64, allowed: f64, size: f64) -> Unfit {
    Unfit::Loses(format!(
        "rounding can make an error of {} {place}, in values of up to {}: the equations ask for {} at most",
        two_digits(error),
        two_digits(size),
        two_digits(allowed)
    ))
}
