//! Whether rounding leaves of a function what the equations say: a function can equal them over the real numbers and be useless in floats,
//! as `x + 1e17 - 1e17` is.
//!
//! There is one rule. With u the unit roundoff, n the number of joints, e the proved bound of an entry as it follows from the text, E that of a
//! plain program of the equations ([`mod@crate::judge::plain`]), and T the size of the largest entry of its kind:
//!
//! ```text
//! e ≤ 2^(4 + n) (E + u T)
//! ```
//!
//! Entries of a kind belong to one part of the result and have one unit: torques of joints that turn, forces of joints that slide, metres,
//! rotations (`kinds`). The rule is applied
//!
//! ```text
//! in the box   to functions without a division: e and E by intervals, T the largest size there. All angles, positions as far to
//!              one side as to the other, parameters of the description; the box holds every state within the limits
//! at a state   to all functions: e is the smaller of the two bounds of `companion`, T the largest size at states of the same sort, behind a
//!              quotient at this state; 16 states within the limits, 16 with entries at ends of the box, at 0 or next to 0, and 8 at rest or slow
//! ```
//!
//! The states follow from the module as its points do. No interval bounds a quotient in a box: what stands before the first
//! division must have a bound there, and the rest is judged at states. A state counts for an entry where the rule allows at most a 256th of T, behind a
//! quotient where it does of all entries: near a singular posture the equations themselves lose their digits, and squares of errors count. In f32 few states of a long arm count, so
//! that its functions run in f64 as well, with the exact values of their literals.
//!
//! Where the factor comes from. Emitted text differs from the plain program by exact identities: sums in another order, products multiplied
//! out, constants folded, bodies grouped. Each can double a bound or triple it; 2^4 allows for several of them in one entry. Bounds know
//! no correlation, so that a turn by a matrix without zeros makes that of a vector up to √3 times as large though its length
//! stays, and that of a tensor 3 times. Emitted text turns tensors where the plain program turns vectors, once a joint: √3 < 2.

use std::collections::BTreeMap;

use armgen_description::kinds::JointKind;

use crate::certificate::report::Unfit;
use crate::floats::bounds::{corner, draw, symmetric, two_digits};
use crate::floats::companion::{LaneArguments, LaneTable, Table};
use crate::judge::checker::Checker;
use crate::judge::plain::{Entry, Plain};
use crate::read::reader::Module;
use crate::textbook::equations::parameters::{units, Unit};
use crate::values::check::Check;
use crate::values::contract::{tip_of, Length, Promise};
use crate::values::divisors::undivided_operands;
use crate::values::enclosure::Float;
use crate::values::float::{Arguments, LANES};
use crate::values::formula::Formula;
use crate::values::program::{Output, Program};
use crate::values::ranges::{literal_errors, ranges, worst, Domain};
use crate::values::stream::Stream;

/// What the rule may allow of the largest entry of a kind at a state that counts.
const COUNTS: f64 = 1.0 / 256.0;

/// Where states are drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Sort {
    Random,
    Special,
    Slow,
}

/// The sorts of the batches.
const BATCHES: [Sort; 5] = [Sort::Random, Sort::Special, Sort::Random, Sort::Special, Sort::Slow];

impl Sort {
    fn draw(self, lane: usize, domain: &Domain, stream: &mut Stream, real: Float) -> Arguments<f64> {
        match self {
            Sort::Random => draw(domain, stream, real),
            Sort::Special => {
                let mut state = corner(domain, stream, real);
                // A little beside it.
                let dust = if lane.is_multiple_of(2) { 0.0 } else { 2f64.powi(-30) };
                state.q.iter_mut().for_each(|q| *q = real.rounded(*q + dust * (*q + 1.0)));
                state
            }
            Sort::Slow => {
                let factor = if lane.is_multiple_of(2) { 0.0 } else { 2f64.powi(-10) };
                let Arguments { q, tau, pi, g0, .. } = draw(domain, stream, real);
                let slow = draw(domain, stream, real).map(|rate| factor * rate);
                Arguments { q, tau, pi, g0, ..slow }
            }
        }
    }
}

/// The bound of an entry beside what is allowed of it.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Whether it is one over the box; else at a state.
    pub in_box: bool,
    /// The scalar that it is computed in.
    pub real: Float,
    /// The entry.
    pub place: String,
    /// e
    pub bound: f64,
    /// 2^(4 + n) (E + u T)
    pub allowed: f64,
}

/// What is known of the entries of a function from the plain program.
struct PlainBounds {
    /// By entry, in the box.
    in_box: Vec<Entry>,
    /// By state and entry.
    at_states: Vec<Vec<Entry>>,
    /// By entry: the number of its kind.
    kinds: Vec<usize>,
}

/// States at which functions of a module are run.
pub struct Trial<'a> {
    module: &'a Module,
    /// 2^(4 + n).
    factor: f64,
    states: Vec<[Arguments<f64>; LANES]>,
    domain: Domain,
    /// By function.
    plain_bounds: BTreeMap<String, PlainBounds>,
}

impl<'a> Trial<'a> {
    /// States of a box, for the functions of a module that equal the equations.
    pub fn new(module: &'a Module, domain: &Domain, checker: &Checker) -> Trial<'a> {
        let (stream, manipulator) = (&mut checker.rest(), checker.manipulator());
        let domain = symmetric(manipulator, domain);
        let plain = Plain { manipulator, vector: checker.vector(), base: checker.base() };
        let mut plain_bounds: BTreeMap<String, PlainBounds> = BTreeMap::new();
        for (name, in_box) in plain.in_box(&domain) {
            let kinds = kinds(&name, checker);
            plain_bounds.insert(name, PlainBounds { kinds, in_box, at_states: Vec::new() });
        }
        let mut states = Vec::new();
        for sort in BATCHES {
            let batch = std::array::from_fn(|lane| sort.draw(lane, &domain, stream, module.real));
            for (name, at_states) in plain.at_states(&batch) {
                plain_bounds.entry(name).and_modify(|known| known.at_states.extend(at_states));
            }
            states.push(batch);
        }
        let factor = (4.0 + manipulator.joints.len() as f64).exp2();
        Trial { module, factor, states, domain, plain_bounds }
    }

    /// What makes a function useless in floats, if it is.
    pub fn fault(&self, program: &Program, values: &[Formula]) -> Option<Unfit> {
        let (real, errors) = (self.module.real, literal_errors(program, values, self.module.real));
        let over = ranges(program, &errors, &self.domain, None, real);
        let mut needed = undivided_operands(program);
        if needed.is_empty() {
            needed = program.outputs.iter().map(|output| output.step).collect();
        }
        if Check::Leaves.is_made() && !needed.iter().all(|&step| over[step].error.is_finite()) {
            return Some(Unfit::Leaves(format!("a value can leave {} anywhere in the box", real.name())));
        }
        let exceeds = |compared: &Compared| {
            let check = if compared.in_box { Check::Box } else { Check::States };
            // A bound that is not a number fits nowhere.
            let fits = compared.bound <= compared.allowed;
            check.is_made() && !fits
        };
        let in_box = self.in_box(program, values).into_iter().find(exceeds);
        let at_states = || self.scalars().flat_map(|real| self.at_states(program, values, real, false)).find(exceeds);
        let compared = in_box.or_else(at_states)?;
        let place = if compared.in_box { "in the box" } else { "at a state of the box" };
        if !compared.bound.is_finite() {
            return Some(Unfit::Leaves(format!("a value can leave {} {place}", compared.real.name())));
        }
        let entry = if compared.place.is_empty() { String::new() } else { format!(" in {}", compared.place) };
        let (bound, allowed) = (two_digits(compared.bound), two_digits(compared.allowed));
        Some(Unfit::Loses(format!(
            "rounding can make an error of {bound} in {}, {place}{entry}: the equations ask for {allowed} at most",
            compared.real.name()
        )))
    }

    /// All bounds beside what is allowed of them; running bounds may be larger than those by sensitivities.
    pub fn compared(&self, program: &Program, values: &[Formula]) -> Vec<Compared> {
        let mut all = self.in_box(program, values);
        all.extend(self.scalars().flat_map(|real| self.at_states(program, values, real, true)));
        all
    }

    /// Those that a function is run in at states.
    fn scalars(&self) -> impl Iterator<Item = Float> {
        let single = (self.module.real == Float::F32).then_some(Float::F32);
        [Float::F64].into_iter().chain(single)
    }

    /// What is allowed of an entry in a scalar, its bound and the size of the largest of its kind being those of the plain program.
    fn allowed(&self, real: Float, error: f64, size: f64) -> f64 {
        let double = Float::F64.unit();
        // Next to zero, errors of underflow decide. Division by a pivot enlarges them, so that the floor is where a product loses digits.
        let underflow = real.smallest_normal() / real.unit();
        self.factor * (real.unit() / double * (error + double * size) + underflow)
    }

    fn in_box(&self, program: &Program, values: &[Formula]) -> Vec<Compared> {
        let Some(plain) = self.plain_bounds.get(&program.name) else { return Vec::new() };
        if !undivided_operands(program).is_empty() {
            return Vec::new();
        }
        let real = self.module.real;
        let over = ranges(program, &literal_errors(program, values, real), &self.domain, None, real);
        let sizes = plain.largest(std::iter::once(&plain.in_box));
        let entries = program.outputs.iter().zip(&plain.in_box).zip(&plain.kinds);
        let known = entries.filter(|((_, entry), _)| entry.error.is_finite());
        let compared = |((output, entry), kind): ((&Output, &Entry), &usize)| Compared {
            in_box: true,
            real,
            place: output.place.clone(),
            bound: over[output.step].error,
            allowed: self.allowed(real, entry.error, sizes.get(kind).copied().unwrap_or(0.0)),
        };
        known.map(compared).collect()
    }

    /// At all states that count. `sensitive`: the smaller of both bounds everywhere, not only where the running one is more than what is allowed.
    fn at_states(&self, program: &Program, values: &[Formula], real: Float, sensitive: bool) -> Vec<Compared> {
        let Some(plain) = self.plain_bounds.get(&program.name) else { return Vec::new() };
        let program = &if real == self.module.real { program.clone() } else { with_exact_literals(program, values, real) };
        let Ok(table) = Table::of(program, &literal_errors(program, values, real), real) else { return Vec::new() };
        let mut table = table.sensitive().lanes();
        let divides = !undivided_operands(program).is_empty();
        let mut all = Vec::new();
        for ((batch, sort), states) in self.states.iter().zip(BATCHES).zip(plain.at_states.chunks(LANES)) {
            let of_sort = BATCHES.iter().zip(plain.at_states.chunks(LANES)).filter(|(of, _)| **of == sort);
            let of_sort = plain.largest(of_sort.flat_map(|(_, states)| states));
            let sizes = states.iter().map(|state| if divides { plain.largest(std::iter::once(state)) } else { of_sort.clone() });
            let sizes: Vec<_> = sizes.collect();
            let allowed = |entry: usize, lane: usize| {
                let size = sizes[lane].get(&plain.kinds[entry]).copied().unwrap_or(0.0);
                let allowed = self.allowed(real, states[lane][entry].error, size);
                (allowed <= COUNTS * size || size == 0.0 && allowed.is_finite()).then_some(allowed)
            };
            let counts: [bool; LANES] =
                std::array::from_fn(|lane| (0..plain.kinds.len()).all(|entry| allowed(entry, lane).is_some()));
            table.run(&LaneArguments::new(batch, real));
            for entry in 0..program.outputs.len().min(plain.kinds.len()) {
                let allowed = std::array::from_fn(|lane| if divides && !counts[lane] { None } else { allowed(entry, lane) });
                let bounds = bounds(&mut table, program.outputs[entry].step, &allowed, sensitive);
                let of_lanes = bounds.into_iter().zip(allowed).filter_map(|(bound, allowed)| Some((bound, allowed?)));
                let place = &program.outputs[entry].place;
                all.extend(of_lanes.map(|(bound, allowed)| Compared {
                    in_box: false,
                    real,
                    place: place.clone(),
                    bound,
                    allowed,
                }));
            }
        }
        all
    }
}

/// The program whose literals are the floats next to their exact values.
fn with_exact_literals(program: &Program, values: &[Formula], real: Float) -> Program {
    let mut program = program.clone();
    for (literal, exact) in program.literals.iter_mut().zip(values) {
        literal.value = real.nearest(exact).unwrap_or(literal.value);
    }
    program
}

/// The running bounds of a step; where these are more than what is allowed, those by sensitivities, which take a run backwards.
fn bounds(table: &mut LaneTable, step: usize, allowed: &[Option<f64>; LANES], sensitive: bool) -> [f64; LANES] {
    let running = table.running(step);
    let holds = |(bound, allowed): (&f64, &Option<f64>)| allowed.is_none_or(|allowed| *bound <= allowed);
    if !sensitive && running.iter().zip(allowed).all(holds) {
        return running;
    }
    let other = table.bound(step);
    std::array::from_fn(|lane| running[lane].min(other[lane]))
}

impl PlainBounds {
    /// By kind: the largest size of an entry at some states.
    fn largest<'b>(&self, states: impl Iterator<Item = &'b Vec<Entry>>) -> BTreeMap<usize, f64> {
        let mut largest: BTreeMap<usize, f64> = BTreeMap::new();
        for entries in states {
            for (entry, kind) in entries.iter().zip(&self.kinds).filter(|(entry, _)| entry.size.is_finite()) {
                let size = largest.entry(*kind).or_default();
                *size = worst([*size, entry.size]);
            }
        }
        largest
    }
}

/// The kinds of the entries of a function: one number for those of one part whose indices are of the same sort.
fn kinds(function: &str, checker: &Checker) -> Vec<usize> {
    let (manipulator, sizes) = (checker.manipulator(), checker.sizes().of_function(function));
    let of_tip = tip_of(function).and_then(|tip| manipulator.tips.iter().find(|own| own.name.eq_ignore_ascii_case(tip)));
    let task = of_tip.map_or(&manipulator.task, |tip| &tip.task);
    let base = checker.base().map(|own| units(own.named.iter().map(|(parameter, _)| *parameter))).unwrap_or_default();
    let columns = checker.vector().units();
    let coordinates = manipulator.coordinates();
    let of_unit = |unit: Unit| match unit {
        Unit::Mass => 0,
        Unit::Moment => 1,
        Unit::Inertia => 2,
        Unit::Own(number) => 3 + number,
    };
    let sort = |length: Length, index: usize| match length {
        Length::Dof => usize::from(coordinates[index].joint.kind == JointKind::Revolute),
        Length::Joints => usize::from(manipulator.joints[index].kind == JointKind::Revolute),
        Length::Parameters => of_unit(columns[index]),
        Length::BaseParameters => of_unit(base[index]),
        Length::Task => task[index].index() / 3,
        // Rows of a Jacobian, linear and angular; rotation, origin and last row of a frame; a point.
        Length::Of(_) => index / 3,
    };
    let mut numbers: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    let mut kinds = Vec::new();
    let arrays = Promise::of(function).map(|(promise, _)| promise.returned.named()).unwrap_or_default();
    for (part, (_, lengths)) in arrays.into_iter().enumerate() {
        let mut all = vec![vec![part]];
        for (place, &length) in lengths.iter().enumerate() {
            // What a list of frames or of Jacobians has for each link.
            let of_links = matches!(lengths[place..], [Length::Joints, Length::Of(_), ..]);
            let sort = |index: usize| if of_links { 0 } else { sort(length, index) };
            let extended = |kind: &Vec<usize>| {
                let longer = |index| [&kind[..], &[sort(index)]].concat();
                (0..length.of(&sizes)).map(longer).collect::<Vec<_>>()
            };
            all = all.iter().flat_map(extended).collect();
        }
        for kind in all {
            let next = numbers.len();
            kinds.push(*numbers.entry(kind).or_insert(next));
        }
    }
    kinds
}
