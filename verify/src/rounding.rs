//! Whether rounding leaves of a function what the equations say: a function can equal them over the real numbers and be useless in floats,
//! as `x + 1e17 - 1e17` is.
//!
//! With u the unit roundoff of the scalar, n the number of joints, k that of axes neither parallel nor perpendicular to the next one beyond
//! four, l the larger one of k and the joints beyond eight, S the largest size of an entry at some states (of a regressor: of the largest
//! one of its unit, and so E over a box), e the bound of the entry (over a box, or at a state in f64, where it is the smaller of the two of
//! [`mod@crate::companion`]), and E the one of a plain program of the equations for that entry ([`mod@crate::yardstick`]):
//!
//! ```text
//! (a)  no value leaves the scalar anywhere in the wide box, or is above 2^64 max(1, S, |x|)³ there, x the arguments
//! (b)  over a box e is at most 2^(4 + 3l/4) (E + u S), E over the same box, by intervals
//! (c)  over a box e is at most 2^(4 + 5n/2 + 2k) (E + u S), E the largest at states
//! (d)  at 16 states within the limits e is at most 2^(4 + 3l/4) (E + u S), both the largest at these states; likewise at these and 16 at the ends
//!      of the wide box together, since at those a single entry can be 0
//! (m)  at 16 states within the limits, and at 8 where the arm is at rest or slow, the error that occurs is at most 2^8 (M + u S) + 2^4 u T, M the one that
//!      occurs in the plain program and T the size of the largest entry, each the largest at these states: bounds of torques of a wrist can be a million
//!      times the errors, since they know no correlation
//! (e)  of functions that divide, at each of the random states among them where E leaves 29 bits of the largest entry, with S that one
//! (f)  powers and angles are those of the equations ([`mod@crate::powers`])
//! (g)  of functions that divide, at the states of (e), no value is above what (a) says, and in f32 an entry is off by at most what (e) says in
//!      units of f32, where that is a 256th of the largest entry or less
//! ```
//!
//! There are two boxes, with all angles and prismatic joints as far to one side as to the other: one has all parameters up to the largest
//! of the description, one those of the description. By (f) what is found in them holds outside, multiplied by at most the powers of the
//! equations. (a) to (c) are of a whole box, since they follow from intervals; these widen with each joint, those of the plain program as
//! those of the text, so that (b) is sharp where n is small and (c) where it is large. (d) and (e) are sharp, and of states alone, drawn
//! from the hash of the module. Emitted functions of the project's robots take at most 0.20 of what (b) allows, 0.04 of (c), 0.35 of (d)
//! and 0.15 of (e), in f32 and in f64; `examples/margins.rs` measures it.
//!
//! Bounds know no correlation: a turn of a vector by a matrix without zeros makes them up to sqrt(3) times as large though its length
//! stays, a turn of a tensor 3 times. The plain program turns vectors along the arm, emitted text tensors, so that its bounds grow faster
//! with the number of such turns: by 0.6 to 0.9 bits an oblique axis at states and over a box ((d), (b)), by 1.1 to 1.5 against states (c),
//! as measured on arms of 4 to 20 revolute joints with random decimals. Where axes are parallel or perpendicular, rows of the matrix have
//! two entries and k is 0; inertia tensors turned along more than eight such joints lose up to 0.8 bits a joint at states all the same, as
//! measured on arms of 8 to 32 revolute joints.
//!
//! The factor 2^4 is a digit and a fifth: a sum in another order, a product multiplied out and a constant that is not folded cost a factor of two or
//! three each, and none is a loss that a user would notice beside the equations themselves.
//!
//! Of functions that divide, what no quotient takes part in is held to (a) to (d) where it meets the first one, beside twice the largest of
//! the torques, the Jacobian and the inertia matrix, of which it is a part, and a rounding of its own, since it is larger than all of these
//! where a link is short, the whole to (e) and (g); an entry in which no quotient takes part, to as many times the same as it is larger. Where E is not finite, as where a mass can be 0 that the plain program divides by, (c) has 2^(12
//! + 5n/2) u S instead of it, with S the largest entry of the function. Intervals say nothing behind a quotient in general; of
//! `forward_dynamics` the bound of torques ([`mod@crate::residual`]) does.

mod plain;

use std::collections::{BTreeMap, BTreeSet};

use crate::arithmetic::twofold::{self, pair, Circle, Pair, TwofoldArguments};
use crate::arithmetic::wide::Wide;
use crate::bounds::{corner, draw, two_digits, undivided_bounds, widened, Parameters};
use crate::check::Check;
use crate::checker::Checker;
use crate::companion::{LaneArguments, LaneTable, Table};
use crate::divisors::{needed, undivided_operands, Matrix};
use crate::enclosure::Float;
use crate::float::{Arguments, LANES};
use crate::formula::Formula;
use crate::program::{Argument, Program};
use crate::ranges::{literal_errors, worst, Domain};
use crate::reader::Module;
use crate::report::Unfit;
use crate::yardstick::Subject;
use plain::{beside_their_units, is_finite, Kind, Plain};

/// As many times the error that a plain program of the equations has: at states, and over a box.
const FACTOR: f64 = 16.0;
/// By so much a part of a torque may be off as the torque: what is larger than the whole cancels with other parts.
const PARTS: f64 = 2.0;

/// Where the equations themselves lose more units of the last place nothing is asked for.
const LOST: f64 = (1 << 24) as f64;

/// As many times the error that a plain program really has at states.
const MEASURED: f64 = 256.0;

/// Of errors of this part of a value squares count.
const SQUARES: f64 = 1.0 / 256.0;

/// Batches of states.
const BATCHES: usize = 5;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// (b), of the plain program in intervals.
    Intervals,
    /// (c), of the plain program at states.
    Box,
    /// (d), at states.
    States,
    /// (m), errors as they occur.
    Measured,
    /// (e), of what divides.
    Divided,
}

/// An error beside what the equations ask for.
#[derive(Clone, Debug)]
pub struct Compared {
    /// By what.
    pub criterion: Criterion,
    /// The entry.
    pub place: String,
    /// The bound of its error.
    pub error: f64,
    /// What is allowed.
    pub allowed: f64,
    /// The size of the entry.
    size: f64,
}

impl Compared {
    /// The error as a part of what is allowed.
    pub fn part(&self) -> f64 {
        if self.error == 0.0 {
            0.0
        } else {
            self.error / self.allowed
        }
    }

    fn unfit(&self) -> Option<Unfit> {
        let (check, place) = match self.criterion {
            Criterion::Intervals => (Check::Intervals, "anywhere in the box"),
            Criterion::Box => (Check::Box, "anywhere in the box"),
            Criterion::States => (Check::States, "in f64, at a state of the box"),
            Criterion::Measured => (Check::Measured, "in f64, at a state within the limits"),
            Criterion::Divided => (Check::DividedStates, "in f64, at a state of the box"),
        };
        (exceeds(self.error, self.allowed) && check.is_made()).then(|| {
            let entry = if self.place.is_empty() { String::new() } else { format!(" in {}", self.place) };
            Unfit::Loses(format!(
                "rounding can make an error of {} {place}{entry}, in values of up to {}: the equations ask for {} at most",
                two_digits(self.error),
                two_digits(self.size),
                two_digits(self.allowed)
            ))
        })
    }
}

/// What rounding does to a text.
struct Errors {
    /// Over the two boxes: bounds of the entries, and the largest size of a value.
    boxes: [(Vec<f64>, f64); 2],
    /// At states, in f64.
    runs: Option<Runs>,
}

/// A text at all states, in f64.
struct Runs {
    table: LaneTable,
    /// State by state: values of the entries, and bounds of their errors, running ones until smaller ones are asked for.
    states: Vec<Vec<(f64, f64)>>,
}

/// What is asked of an entry: the largest bound at some states.
struct Asked {
    criterion: Criterion,
    entry: usize,
    states: StateSet,
    allowed: f64,
    size: f64,
}

/// States by number, one bit each.
type StateSet = u64;
const _: () = assert!(BATCHES * LANES <= StateSet::BITS as usize, "every state has a bit");

fn set_of(states: impl Iterator<Item = usize>) -> StateSet {
    states.fold(0, |set, state| set | 1 << state)
}

/// The states of a batch.
fn set_of_batch(batch: usize) -> StateSet {
    set_of(batch * LANES..(batch + 1) * LANES)
}

/// For which entries bounds by sensitivities are computed, which cost a run backwards each.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sensitivities {
    /// All: what is shown are the smallest bounds.
    Always,
    /// Those whose running bound is more than what is allowed: either bound holds, so that one is enough.
    WhereNeeded,
}

impl Errors {
    /// Whether entries have a bound over a box.
    fn is_bounded(&self, which: usize) -> bool {
        self.boxes[which].0.iter().all(|bound| bound.is_finite())
    }
}

/// The largest size of an entry at states.
fn size_of(states: &[Vec<(f64, f64)>]) -> f64 {
    states.iter().flatten().fold(0.0f64, |size, (value, _)| size.max(value.abs()))
}

/// A state without motion, or a thousand times as slow.
fn slow(mut state: Arguments<f64>, rests: bool) -> Arguments<f64> {
    for rate in [&mut state.dq, &mut state.ddq, &mut state.dqr, &mut state.ddqr].into_iter().flatten() {
        *rate *= if rests { 0.0 } else { 2f64.powi(-10) };
    }
    state
}

/// States at which functions of a module are run.
pub struct Trial<'a> {
    module: &'a Module,
    joints: usize,
    /// k.
    oblique: f64,
    /// l.
    long: f64,
    batches: Vec<([Arguments<f64>; LANES], LaneArguments)>,
    /// The same for finer numbers, where these have sines of the angles.
    fine: Vec<Option<TwofoldArguments>>,
    /// By function, entry by entry.
    plain: BTreeMap<String, Vec<Plain>>,
    /// The box without limits of angles with all parameters up to the largest, and with those of the description.
    boxes: [Domain; 2],
    /// The largest size of an argument in the first.
    arguments: f64,
}

impl<'a> Trial<'a> {
    /// States of a box, for the functions of a module that equal the equations.
    pub fn new(module: &'a Module, domain: &Domain, checker: &Checker) -> Trial<'a> {
        let stream = &mut checker.rest();
        let manipulator = checker.manipulator();
        let boxes = [Parameters::Any, Parameters::Described].map(|parameters| widened(manipulator, domain, parameters));
        let [wide, near] = &boxes;
        let batch = |k: usize| {
            let states = std::array::from_fn(|lane| match Kind::of(k * LANES) {
                Kind::Random => draw(near, stream, module.real),
                Kind::Corner => corner(wide, stream, module.real),
                Kind::Slow => slow(draw(near, stream, module.real), lane % 2 == 0),
            });
            let lanes = LaneArguments::new(&states, Float::F64);
            (states, lanes)
        };
        let batches: Vec<_> = (0..BATCHES).map(batch).collect();
        let circle = Circle::new();
        let fine = batches.iter().map(|(states, _)| TwofoldArguments::new(&circle, states)).collect();
        let subject = Subject { manipulator, vector: checker.vector(), base: checker.base() };
        let mut plain: BTreeMap<String, Vec<Plain>> = BTreeMap::new();
        for (states, _) in &batches {
            for (name, entries) in subject.at_states(states) {
                let own = plain.entry(name).or_insert_with(|| vec![Plain::default(); entries.len()]);
                for (own, at) in own.iter_mut().zip(&entries) {
                    own.states.extend(at.map(|(error, value)| (error, value.abs())));
                    own.values.extend(at.map(|(_, value)| value));
                }
            }
        }
        plain.retain(|_, entries| entries.iter().all(|entry| entry.states.len() == BATCHES * LANES));
        for (k, domain) in boxes.iter().enumerate() {
            let over = subject.over(domain);
            for (name, entries) in &mut plain {
                let errors = over.get(name).into_iter().flatten().copied().chain(std::iter::repeat(f64::INFINITY));
                entries.iter_mut().zip(errors).for_each(|(entry, error)| entry.boxes[k] = error);
            }
        }
        let states = batches.iter().flat_map(|(states, _)| states);
        beside_their_units(&mut plain, checker, states);
        let ranges = Argument::ALL.into_iter().flat_map(|argument| wide.of(argument));
        let arguments = worst(ranges.map(|(low, high)| low.abs().max(high.abs())));
        let oblique = checker.oblique().saturating_sub(4) as f64;
        let joints = manipulator.joints.len();
        let long = oblique.max(joints.saturating_sub(8) as f64);
        Trial { module, joints, oblique, long, batches, fine, plain, boxes, arguments }
    }

    fn states(&self) -> impl Iterator<Item = &Arguments<f64>> {
        self.batches.iter().flat_map(|(states, _)| states)
    }

    /// What makes a function useless in floats, if it is.
    pub fn fault(&self, program: &Program, values: &[Formula]) -> Option<Unfit> {
        let operands = undivided_operands(program);
        let (errors, compared) = self.judge(program, &operands, values, Sensitivities::WhereNeeded);
        let unfit = self.leaves(&errors).or_else(|| compared.iter().find_map(Compared::unfit));
        unfit.or_else(|| if operands.is_empty() { None } else { self.divided_leaves(program) })
    }

    /// All errors beside what is allowed of them.
    pub fn compared(&self, program: &Program, values: &[Formula]) -> Vec<Compared> {
        self.judge(program, &undivided_operands(program), values, Sensitivities::Always).1
    }

    /// The errors of what no quotient takes part in, and all beside what is allowed of them. `operands`: the undivided ones of the program.
    fn judge(
        &self,
        program: &Program,
        operands: &[usize],
        values: &[Formula],
        sensitivities: Sensitivities,
    ) -> (Errors, Vec<Compared>) {
        if operands.is_empty() {
            let mut errors = self.errors(program, values);
            let yardsticks = self.plain.get(&program.name).map_or(&[][..], Vec::as_slice);
            let mut compared = self.undivided(program, &mut errors, yardsticks, sensitivities);
            compared.extend(self.measured(program, values, yardsticks));
            return (errors, compared);
        }
        let part = program.part(operands);
        let mut errors = self.errors(&part, values);
        let mut yardsticks = self.of_operands(program, operands);
        if let Some(runs) = &errors.runs {
            yardsticks.iter_mut().enumerate().for_each(|(k, plain)| plain.hold_value(runs.states.iter().map(|state| state[k].0)));
        }
        let mut compared = self.undivided(&part, &mut errors, &yardsticks, sensitivities);
        compared.extend(self.divided(program, values, sensitivities));
        compared.extend(self.measured(program, values, self.plain.get(&program.name).map_or(&[][..], Vec::as_slice)));
        (errors, compared)
    }

    /// What rounding does to a function in which no quotient takes part.
    fn errors(&self, program: &Program, values: &[Formula]) -> Errors {
        let over = |domain: &Domain| undivided_bounds(program, values, domain, self.module.real);
        Errors { boxes: self.boxes.each_ref().map(over), runs: self.runs(program, values) }
    }

    /// What operands of quotients are held to: the largest of what they can be part of. Of an entry in which no quotient takes part, as of a joint
    /// whose inertia is constant, it is as many times that as the entry is larger: a torque by the constant one over an inertia is an acceleration.
    fn of_operands(&self, program: &Program, operands: &[usize]) -> Vec<Plain> {
        let most = self.most_of_operands(program);
        let own = self.plain.get(&program.name).map_or(&[][..], Vec::as_slice);
        let yardstick = |&operand: &usize| {
            let entries = program.outputs.iter().zip(own).filter(|(output, _)| output.step == operand);
            let scale = worst(entries.map(|(_, entry)| entry.size() / most.size()));
            most.times(PARTS * if scale.is_finite() { scale.max(1.0) } else { 1.0 })
        };
        operands.iter().map(yardstick).collect()
    }

    /// The largest of what operands of quotients can be part of: torques, those that are given among them, Jacobian and inertia; of a centre of mass
    /// the moments are not among them.
    fn most_of_operands(&self, program: &Program) -> Plain {
        let names: &[&str] = match needed(&program.name) {
            [Matrix::Mass | Matrix::MassWith, ..] => return Plain::default(),
            [_, Matrix::Mobility, ..] => &["inertia_matrix", "geometric_jacobian"],
            [Matrix::InertiaWith, ..] => &["inverse_dynamics_with", "inertia_matrix_with"],
            _ => &["inverse_dynamics", "inverse_dynamics_derivatives", "inertia_matrix"],
        };
        let mut most = Plain::default();
        // No number where one of them is none.
        let larger = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
        for plain in names.iter().filter_map(|name| self.plain.get(*name)).flatten() {
            most.states.resize(plain.states.len(), (0.0, 0.0));
            for (most, own) in most.states.iter_mut().zip(&plain.states) {
                *most = (larger(most.0, own.0), larger(most.1, own.1));
            }
            most.boxes = [0, 1].map(|k| larger(most.boxes[k], plain.boxes[k]));
        }
        if program.arguments.contains(&Argument::Tau) {
            // A torque that is given is rounded once where the equations take it, however small those of the arm are.
            let size = |tau: &[f64]| worst(tau.iter().map(|tau| tau.abs()));
            let unit = Float::F64.unit();
            for (most, state) in most.states.iter_mut().zip(self.states()) {
                let given = size(&state.tau);
                *most = (larger(most.0, unit * given), larger(most.1, given));
            }
            for (most, domain) in most.boxes.iter_mut().zip(&self.boxes) {
                let ends = domain.of(Argument::Tau).iter().map(|(low, high)| low.abs().max(high.abs()));
                *most = larger(*most, unit * worst(ends));
            }
        }
        most
    }

    /// That a value of what does not divide can leave the scalar, or comes near to it on the way: over the wide box; with the parameters of the
    /// description where others leave the scalar, as where masses of 1e12 kg stand beside inertias of 1e-12 kg m² in f32.
    fn leaves(&self, errors: &Errors) -> Option<Unfit> {
        let real = self.module.real;
        let which = if errors.is_bounded(0) { 0 } else { 1 };
        if !errors.is_bounded(which) && Check::Leaves.is_made() {
            return Some(Unfit::Leaves(format!("a value can leave {} inside the box", real.name())));
        }
        let size = size_of(&errors.runs.as_ref()?.states);
        if !size.is_finite() && Check::Headroom.is_made() {
            return Some(Unfit::Leaves("a value can leave f64 at a state of the box".into()));
        }
        let (_, largest) = errors.boxes[which];
        (largest > headroom(size, self.arguments) && Check::Headroom.is_made()).then(|| {
            let (largest, size) = (two_digits(largest), two_digits(size));
            Unfit::Leaves(format!("values of up to {largest} on the way to entries of up to {size} can leave the scalar"))
        })
    }

    /// What no quotient takes part in.
    fn undivided(
        &self,
        program: &Program,
        errors: &mut Errors,
        yardsticks: &[Plain],
        sensitivities: Sensitivities,
    ) -> Vec<Compared> {
        let Some(runs) = &errors.runs else { return Vec::new() };
        let real = self.module.real;
        let (unit, n) = (Float::F64.unit(), self.joints as f64);
        let (size, states) = (size_of(&runs.states), runs.states.len());
        // Where there is no yardstick, by sizes alone.
        let (wider, wider_than_states) = ((0.75 * self.long).exp2(), (2.0 * self.oblique).exp2());
        let by_size = wider_than_states * (12.0 + 2.5 * n).exp2() * (real.unit() * size + real.smallest_normal());
        let lost = wider * (4.0 + 0.5 * n).exp2() * unit * size;
        let sized = Plain { states: vec![(lost, size); states], boxes: [f64::INFINITY; 2], ..Plain::default() };
        let plain = |k: usize| yardsticks.get(k).filter(|plain| !plain.states.is_empty()).unwrap_or(&sized);
        let place = |k: usize| program.outputs[k].place.clone();
        let mut compared = Vec::new();
        for (which, (bounds, _)) in errors.boxes.iter().enumerate() {
            // With all parameters up to the largest, values can leave a scalar that those of the description keep.
            if which == 0 && !errors.is_bounded(which) {
                continue;
            }
            for (k, error) in bounds.iter().copied().enumerate() {
                let (plain, place) = (plain(k), place(k));
                let scaled = |in_f64: f64| real.unit() / unit * in_f64 + real.smallest_normal();
                let (intervals, at_states) = (plain.boxes[which], plain.error());
                let of_states = if which == 1 || plain.is_whole() {
                    wider_than_states * (4.0 + 2.5 * n).exp2() * scaled(at_states)
                } else {
                    by_size
                };
                let of_intervals = wider * FACTOR * scaled(intervals + plain.rounding());
                let size = plain.size();
                compared.push(Compared { criterion: Criterion::Box, place: place.clone(), error, allowed: of_states, size });
                if intervals.is_finite() {
                    compared.push(Compared { criterion: Criterion::Intervals, place, error, allowed: of_intervals, size });
                }
            }
        }
        let mut asked = Vec::new();
        for entry in 0..program.outputs.len() {
            let all = plain(entry);
            let finite = (0..states).filter(|&state| is_finite(&all.states[state]));
            let random = finite.clone().filter(|&state| Kind::of(state) == Kind::Random);
            for (states, plain) in [(set_of(random), &all.random()), (set_of(finite), all)] {
                let allowed = wider * FACTOR * (plain.error() + f64::MIN_POSITIVE);
                asked.push(Asked { criterion: Criterion::States, entry, states, allowed, size: plain.size() });
            }
        }
        if let Some(runs) = &mut errors.runs {
            compared.extend(self.at_states(program, runs, &asked, sensitivities));
        }
        compared
    }

    /// Bounds at states beside what is allowed there.
    fn at_states(&self, program: &Program, runs: &mut Runs, asked: &[Asked], sensitivities: Sensitivities) -> Vec<Compared> {
        let error = |runs: &Runs, asked: &Asked| {
            let of_set = runs.states.iter().enumerate().filter(|(state, _)| asked.states >> state & 1 == 1);
            worst(of_set.map(|(_, entries)| entries[asked.entry].1))
        };
        let open = |asked: &&Asked| sensitivities == Sensitivities::Always || exceeds(error(runs, asked), asked.allowed);
        let open: Vec<&Asked> = asked.iter().filter(open).collect();
        for (k, (_, lanes)) in self.batches.iter().enumerate() {
            let states = set_of_batch(k);
            let entries: BTreeSet<usize> =
                open.iter().filter(|asked| asked.states & states != 0).map(|asked| asked.entry).collect();
            if entries.is_empty() {
                continue;
            }
            runs.table.run(lanes);
            let mut known: BTreeMap<usize, [f64; LANES]> = BTreeMap::new();
            for entry in entries {
                let step = program.outputs[entry].step;
                let bound = known.entry(step).or_insert_with(|| runs.table.bound(step));
                for (state, bound) in runs.states[k * LANES..].iter_mut().zip(bound) {
                    state[entry].1 = state[entry].1.min(*bound);
                }
            }
        }
        let compared = |asked: &Asked| Compared {
            criterion: asked.criterion,
            place: program.outputs[asked.entry].place.clone(),
            error: error(runs, asked),
            allowed: asked.allowed,
            size: asked.size,
        };
        asked.iter().map(compared).collect()
    }

    /// Errors as they occur, of states of each kind within the limits.
    fn measured(&self, program: &Program, values: &[Formula], yardsticks: &[Plain]) -> Vec<Compared> {
        let exact: Option<Vec<Wide>> = program.exact_literals(values).iter().map(Wide::from_formula).collect();
        let Some(literals) = exact.map(|exact| exact.iter().map(pair).collect::<Vec<Pair>>()) else { return Vec::new() };
        if yardsticks.len() != program.outputs.len() {
            return Vec::new();
        }
        // As a text in f64 has them.
        let mut program = program.clone();
        program.literals.iter_mut().zip(&literals).for_each(|(literal, (high, _))| literal.value = *high);
        let unit = Float::F64.unit();
        // Kind by kind and entry by entry: the error, that of the plain program, and the size.
        let mut all = [Kind::Random, Kind::Slow].map(|kind| (kind, vec![(0.0f64, 0.0f64, 0.0f64); program.outputs.len()]));
        let mut steps = Vec::new();
        for (k, ((states, _), fine)) in self.batches.iter().zip(&self.fine).enumerate() {
            let of_kind = all.iter_mut().find(|(kind, _)| *kind == Kind::of(k * LANES));
            let (Some((_, largest)), Some(fine)) = (of_kind, fine) else { continue };
            if twofold::values(&program, &literals, fine, &mut steps).is_none() {
                continue;
            }
            for (lane, state) in states.iter().enumerate() {
                let found = program.run_float(state, Float::F64);
                for (((output, found), plain), largest) in
                    program.outputs.iter().zip(found).zip(yardsticks).zip(largest.iter_mut())
                {
                    let exact = &steps[output.step];
                    // Halves of a float beyond 1e292 are none.
                    if !exact.high[lane].is_finite() {
                        continue;
                    }
                    let error = |value: f64| ((value - exact.high[lane]) - exact.low[lane]).abs();
                    largest.0 = worst([largest.0, error(found)]);
                    largest.1 = worst([largest.1, error(plain.values[k * LANES + lane])]);
                    largest.2 = worst([largest.2, exact.high[lane].abs()]);
                }
            }
        }
        let mut compared = Vec::new();
        for (_, largest) in all {
            let whole = worst(largest.iter().map(|(.., size)| *size));
            for (output, (error, plain, size)) in program.outputs.iter().zip(largest) {
                let allowed = MEASURED * (plain + unit * size + f64::MIN_POSITIVE) + FACTOR * unit * whole;
                compared.push(Compared { criterion: Criterion::Measured, place: output.place.clone(), error, allowed, size });
            }
        }
        compared
    }

    /// The random states of what divides. Not those at the ends of the box: where the arm is exactly singular, errors are as large as what
    /// they are errors of.
    fn judged(&self) -> impl Iterator<Item = usize> {
        (0..self.batches.len() * LANES).filter(|state| Kind::of(*state) == Kind::Random)
    }

    /// What divides, state by state.
    fn divided(&self, program: &Program, values: &[Formula], sensitivities: Sensitivities) -> Vec<Compared> {
        let Some(plain) = self.plain.get(&program.name) else { return Vec::new() };
        let unit = Float::F64.unit();
        let mut asked = Vec::new();
        for state in self.judged() {
            let size = worst(plain.iter().map(|entry| entry.states[state].1));
            let lost = worst(plain.iter().map(|entry| entry.states[state].0)) / (unit * size);
            // Not so, either, where this is no number.
            if exceeds(lost, LOST) {
                continue;
            }
            let states = set_of([state].into_iter());
            asked.extend(plain.iter().enumerate().map(|(entry, plain)| {
                let (error, size_of_entry) = plain.states[state];
                let allowed = FACTOR * (error + unit * size + f64::MIN_POSITIVE);
                Asked { criterion: Criterion::Divided, entry, states, allowed, size: size_of_entry }
            }));
        }
        if asked.is_empty() {
            return Vec::new();
        }
        self.runs(program, values).map_or_else(Vec::new, |mut runs| self.at_states(program, &mut runs, &asked, sensitivities))
    }

    /// That what divides leaves the scalar at a state, comes near to it on the way, or loses more in single precision than in double. Bounds are
    /// of f64, in which nothing is too large or too small that is so for f32.
    fn divided_leaves(&self, program: &Program) -> Option<Unfit> {
        let (real, unit) = (self.module.real, Float::F64.unit());
        let plain = self.plain.get(&program.name)?;
        let literals: Vec<f64> = program.literals.iter().map(|literal| literal.value).collect();
        let states: Vec<&Arguments<f64>> = self.states().collect();
        self.judged().find_map(|state| {
            let of = |side: fn(&(f64, f64)) -> f64| worst(plain.iter().map(|entry| side(&entry.states[state])));
            let size = of(|(_, size)| *size);
            let lost = FACTOR * real.unit() * of(|(error, _)| *error) / (unit * size);
            // Of a single number the quotients alone are finite in f64; nor is anything asked where this is no number.
            if exceeds(lost, 1.0) {
                return None;
            }
            let found = program.run_float(states[state], real);
            if Check::DividedLeaves.is_made() && found.iter().any(|value| !value.is_finite()) {
                return Some(Unfit::Leaves(format!("a value leaves {} at a state of the box", real.name())));
            }
            // The arguments that the module has.
            let rounded = states[state].map(|x| if real == Float::F32 { f64::from(x as f32) } else { x });
            let values = program.values(&rounded, &literals);
            let largest = worst(values.iter().flatten().map(|value| value.abs()));
            if Check::DividedHeadroom.is_made() && largest > headroom(size, self.arguments) {
                let (largest, size) = (two_digits(largest), two_digits(size));
                return Some(Unfit::Leaves(format!("values of {largest} on the way to entries of up to {size} can leave the scalar")));
            }
            // Squares of errors count where few digits are left.
            if real == Float::F64 || !Check::DividedSingle.is_made() || lost > SQUARES {
                return None;
            }
            let mut entries = program.outputs.iter().zip(found).zip(plain);
            entries.find_map(|((output, found), plain)| {
                let error = (found - values[output.step]?).abs();
                let allowed = FACTOR * real.unit() / unit * (plain.states[state].0 + unit * size) + real.smallest_normal();
                exceeds(error, allowed).then(|| {
                    let (error, allowed) = (two_digits(error), two_digits(allowed));
                    Unfit::Loses(format!(
                        "rounding makes an error of {error} in {}, in {} at a state of the box: the equations ask for {allowed} at most",
                        output.place,
                        real.name()
                    ))
                })
            })
        })
    }

    /// A text in f64, with running bounds; the arguments are those of the module's scalar.
    fn runs(&self, program: &Program, values: &[Formula]) -> Option<Runs> {
        let errors = literal_errors(program, values, Float::F64);
        let mut table = Table::of(program, &errors, Float::F64).ok()?.lanes();
        let mut states = vec![Vec::with_capacity(program.outputs.len()); self.batches.len() * LANES];
        for ((_, lanes), states) in self.batches.iter().zip(states.chunks_exact_mut(LANES)) {
            table.run(lanes);
            for output in &program.outputs {
                let ((value, _), error) = (table.step(output.step), table.running(output.step));
                for (lane, state) in states.iter_mut().enumerate() {
                    state.push((value[lane], error[lane]));
                }
            }
        }
        Some(Runs { table, states })
    }
}

/// As large as values may be on the way to entries of this size.
fn headroom(size: f64, arguments: f64) -> f64 {
    2f64.powi(64) * size.max(arguments).max(1.0).powi(3)
}

/// Whether a is larger than b, or one of the two is not a number.
fn exceeds(a: f64, b: f64) -> bool {
    a > b || a.is_nan() || b.is_nan()
}
