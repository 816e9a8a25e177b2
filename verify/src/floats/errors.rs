//! Measures rounding errors: runs the functions of a module in its scalar and with much higher precision, at random states of the box, and
//! compares the errors with both bounds.
//!
//! All states run in lanes, with a reference of 106 bits ([`twofold`]). A state whose error approaches a bound, or is the largest so far, is
//! evaluated again with 256 bits ([`Wide`]); reported errors come from there.
//!
//! A single state near a singular configuration can have the largest bound of a million states, but its error is only one sample of the possible
//! rounding errors. So, for each new largest bound, states that differ in the last digits are tried, too: they have the same bound and other
//! rounding errors.

use armgen_description::manipulator::Manipulator;

use crate::floats::bounds::{corner, domain_of, draw, of_function, Bound};
use crate::floats::companion::{LaneArguments, LaneTable, Table};
use crate::floats::residual::{Equations, Residual};
use crate::read::claims::Claims;
use crate::read::reader::{Function, Module};
use crate::values::arithmetic::twofold::{self, Circle, Pair, Twofold, TwofoldArguments};
use crate::values::arithmetic::wide::{Wide, WideArguments};
use crate::values::element::Element;
use crate::values::enclosure::Float;
use crate::values::float::{Arguments, LANES};
use crate::values::program::Program;
use crate::values::ranges::{literal_errors, Domain};
use crate::values::stream::Stream;

/// Measurements of a function; sizes are those of the largest entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// The function.
    pub name: String,
    /// Number of states. Neighbours of states with a large bound only count for sizes and for exceeded bounds.
    pub states: u64,
    /// Largest value.
    pub value: f64,
    /// Largest error.
    pub error: f64,
    /// Largest running bound.
    pub running: f64,
    /// The a-priori bound.
    pub a_priori: f64,
    /// Number of states whose error exceeded the running bound.
    pub beyond_running: u64,
    /// Number of states whose error exceeded the a-priori bound.
    pub beyond_a_priori: u64,
    /// Number of states outside the scope of the a-priori bound, because a divisor is too small.
    pub outside: u64,
    /// Measurements of the residual, if it has a bound.
    pub residual: Option<Torques>,
    /// Number of states where a divisor may have a relative error above √u, half of its digits, as at singular configurations of
    /// `operational_inertia`. They do not count for the sizes above, but the bounds must still hold.
    pub singular: u64,
}

/// Residuals of accelerations in the equations of motion, for states with positive pivots.
#[derive(Clone, Debug, PartialEq)]
pub struct Torques {
    /// The bound.
    pub bound: Residual,
    /// Largest residual of any row.
    pub largest: f64,
    /// Largest quotient of residual and bound.
    pub part: f64,
    /// Number of states whose residual exceeded the bound.
    pub beyond: u64,
}

impl Seen {
    /// The quotient of running bound and error; `None` without an error.
    pub fn ratio(&self) -> Option<f64> {
        (self.error > 0.0).then(|| self.running / self.error)
    }

    /// Merges the measurements at other states.
    pub fn join(&mut self, other: &Seen) {
        self.states += other.states;
        self.value = self.value.max(other.value);
        self.error = self.error.max(other.error);
        self.running = self.running.max(other.running);
        self.beyond_running += other.beyond_running;
        self.beyond_a_priori += other.beyond_a_priori;
        self.outside += other.outside;
        self.singular += other.singular;
        if let (Some(own), Some(other)) = (&mut self.residual, &other.residual) {
            own.largest = own.largest.max(other.largest);
            own.part = own.part.max(other.part);
            own.beyond += other.beyond;
        }
    }
}

/// A function prepared for measurement.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The program under measurement.
    pub program: Program,
    exact: Vec<Wide>,
    pairs: Vec<Pair>,
    table: LaneTable,
    bound: Bound,
    /// The steps that are entries, each once, with its largest a-priori bound.
    entries: Vec<(usize, f64)>,
    divisors: Vec<usize>,
    equations: Option<Equations>,
}

impl Subject {
    /// The functions of a module, with the exact values of their literals.
    pub fn all(manipulator: &Manipulator, module: &Module, claims: &Claims) -> Result<Vec<Subject>, String> {
        let domain = domain_of(manipulator, module);
        let of = |(name, function): &(String, Result<Function, String>)| {
            let program = function.as_ref().map_err(|e| format!("`{name}`: {e}"))?.program.clone();
            let values = claims.resolve(name, &program.literals, module.real).values.clone();
            let errors = literal_errors(&program, &values, module.real);
            let exact: Option<Vec<Wide>> = program.exact_literals(&values).iter().map(Wide::from_formula).collect();
            let exact = exact.ok_or(format!("`{name}`: a literal out of reach"))?;
            let table = Table::of(&program, &errors, module.real)?.lanes();
            let bound = of_function(&program, &values, &domain, module, claims);
            let divisors = program.divisors();
            let mut entries: Vec<(usize, f64)> =
                program.outputs.iter().map(|o| o.step).zip(bound.entries.iter().copied()).collect();
            entries.sort_by_key(|entry| entry.0);
            entries.dedup_by_key(|entry| entry.0);
            let pairs = exact.iter().map(twofold::pair).collect();
            let equations = Equations::of(name, module, claims);
            Ok(Subject { program, exact, pairs, table, bound, entries, divisors, equations })
        };
        module.functions.iter().map(of).collect()
    }

    /// The same with changed literals in the reference, as if the text had wrong literals.
    pub fn with_literals(self, exact: impl Fn(&Wide) -> Wide) -> Subject {
        let all = |literals: &[Wide]| -> Vec<Wide> { literals.iter().map(&exact).collect() };
        let equations = self.equations.as_ref().map(|equations| Equations {
            motion_literals: all(&equations.motion_literals),
            friction_literals: all(&equations.friction_literals),
            ..equations.clone()
        });
        let exact = all(&self.exact);
        Subject { pairs: exact.iter().map(twofold::pair).collect(), exact, equations, ..self }
    }

    fn nothing(&self) -> Seen {
        Seen {
            name: self.program.name.clone(),
            states: 0,
            value: 0.0,
            error: 0.0,
            running: 0.0,
            a_priori: self.bound.largest(),
            beyond_running: 0,
            beyond_a_priori: 0,
            outside: 0,
            singular: 0,
            residual: self.bound.residual.map(|bound| Torques { bound, largest: 0.0, part: 0.0, beyond: 0 }),
        }
    }

    /// Evaluates the states of a batch. Returns the lane with the largest running bound so far, if this batch has it.
    fn look(&mut self, side: &Batch, real: Float, scratch: &mut Vec<Twofold>, seen: &mut Seen) -> Option<Option<usize>> {
        self.table.run(&side.own);
        twofold::values(&self.program, &self.pairs, &side.fine, scratch)?;
        let digits = real.unit().sqrt();
        let (mut singular, mut outside, mut lost_sign) = ([false; LANES], [false; LANES], [false; LANES]);
        for &divisor in &self.divisors {
            let (value, error) = self.table.step(divisor);
            for lane in 0..LANES {
                // A divisor is a positive pivot, or the negative of a pivot.
                lost_sign[lane] |= exceeds(0.0, value[lane] * scratch[divisor].high[lane].signum());
                singular[lane] |= exceeds(error[lane], digits * value[lane].abs());
                outside[lane] |= self.bound.smallest_divisor.is_some_and(|least| exceeds(least, value[lane].abs() - error[lane]));
            }
        }
        // For each lane: whether a bound may be exceeded, and the largest error.
        let (mut near, mut worst) = ([false; LANES], [0.0f64; LANES]);
        let mut largest = None;
        for &(entry, a_priori) in &self.entries {
            let (found, _) = self.table.step(entry);
            let running = self.table.bound(entry);
            let exact = &scratch[entry];
            for lane in 0..LANES {
                let error = ((found[lane] - exact.high[lane]) - exact.low[lane]).abs();
                let beyond = |bound: f64| bound < f64::INFINITY && exceeds(error, bound * (1.0 - 1e-9));
                near[lane] |= beyond(running[lane]) || !outside[lane] && beyond(a_priori);
                if !singular[lane] {
                    worst[lane] = worst[lane].max(error);
                    seen.value = seen.value.max(found[lane].abs());
                    if running[lane] > seen.running {
                        (seen.running, largest) = (running[lane], Some(lane));
                    }
                }
            }
        }
        self.look_at_residuals(side, &lost_sign, scratch, seen)?;
        for lane in 0..LANES {
            seen.outside += u64::from(outside[lane]);
            seen.singular += u64::from(singular[lane]);
            if near[lane] || worst[lane] > seen.error {
                self.look_again(side, lane, singular[lane], outside[lane], seen)?;
            }
        }
        Some(largest)
    }

    /// Measures the residuals of the accelerations.
    fn look_at_residuals(
        &self,
        side: &Batch,
        lost_sign: &[bool; LANES],
        scratch: &mut Vec<Twofold>,
        seen: &mut Seen,
    ) -> Option<()> {
        let (Some(torques), Some(equations)) = (&mut seen.residual, &self.equations) else { return Some(()) };
        let x: Vec<[f64; LANES]> = self.program.outputs.iter().map(|output| self.table.step(output.step).0).collect();
        let wide: Vec<Twofold> = x.iter().map(|x| Twofold::exact(*x)).collect();
        let residuals = equations.residuals(&side.fine, &wide, scratch)?;
        for lane in (0..LANES).filter(|&lane| !lost_sign[lane]) {
            let most = x.iter().fold(0.0f64, |a, x| a.max(x[lane].abs()));
            let bound = torques.bound.constant + torques.bound.factor * most;
            let size =
                residuals
                    .iter()
                    .fold(0.0f64, |a, r| if r.high[lane].is_nan() { f64::INFINITY } else { a.max(r.high[lane].abs()) });
            torques.largest = torques.largest.max(size);
            torques.part = torques.part.max(size / bound);
            torques.beyond += u64::from(exceeds(size, bound));
        }
        Some(())
    }

    /// Evaluates the state of a lane again with 256 bits.
    fn look_again(&mut self, side: &Batch, lane: usize, singular: bool, outside: bool, seen: &mut Seen) -> Option<()> {
        let values = self.program.values(&WideArguments::new(&side.states[lane])?, &self.exact);
        let (mut beyond, mut beyond_a_priori) = (false, false);
        for &(entry, a_priori) in &self.entries {
            let (found, running) = (self.table.step(entry).0[lane], self.table.bound(entry)[lane]);
            let error = match &values[entry] {
                Some(exact) if found.is_finite() => exact.minus(&Wide::from_f64(found)).to_f64().abs(),
                _ => f64::INFINITY,
            };
            beyond |= error > running;
            beyond_a_priori |= !outside && error > a_priori;
            if !singular {
                seen.error = seen.error.max(error);
            }
        }
        seen.beyond_running += u64::from(beyond);
        seen.beyond_a_priori += u64::from(beyond_a_priori);
        Some(())
    }
}

/// Whether a is larger than b, or either is not a number.
fn exceeds(a: f64, b: f64) -> bool {
    a > b || a.is_nan() || b.is_nan()
}

/// States in lanes, in the scalar of the module and with 106 bits.
struct Batch {
    states: [Arguments<f64>; LANES],
    own: LaneArguments,
    fine: TwofoldArguments,
}

impl Batch {
    fn new(states: [Arguments<f64>; LANES], circle: &Circle, real: Float) -> Result<Batch, String> {
        let fine = TwofoldArguments::new(circle, &states).ok_or("a joint variable out of reach")?;
        Ok(Batch { own: LaneArguments::new(&states, real), fine, states })
    }
}

/// Number of batches of neighbours for a state with a new largest bound.
const BATCHES_OF_NEIGHBOURS: usize = 8;

/// A state of the box that differs from another only in the last four bits; zeros stay 0.
fn neighbour(state: &Arguments<f64>, domain: &Domain, stream: &mut Stream, real: Float) -> Arguments<f64> {
    state.beside(domain, |x, (low, high)| {
        let units = 2.0 * real.unit() * (stream.below(17) as f64 - 8.0);
        real.rounded(x * (1.0 + units)).clamp(low, high)
    })
}

/// Number of initial batches with only corners of the box.
const BATCHES_OF_CORNERS: u64 = 32;

/// A state of the box. One in 8 is a corner; one in 16 has about half of its entries at 0, or at the end of the box closest to 0.
fn state(domain: &Domain, stream: &mut Stream, real: Float) -> Arguments<f64> {
    if stream.below(8) == 0 {
        return corner(domain, stream, real);
    }
    let mut drawn = draw(domain, stream, real);
    if stream.below(16) > 0 {
        return drawn;
    }
    let pi = std::mem::take(&mut drawn.pi);
    let corner = drawn.beside(domain, |x, (low, high)| if stream.below(2) == 0 { 0.0 } else { x }.clamp(low, high));
    Arguments { pi, ..corner }
}

/// A run over the states of a separate stream.
pub struct Run {
    subjects: Vec<Subject>,
    domain: Domain,
    real: Float,
    circle: Circle,
    stream: Stream,
    /// A separate stream for neighbours, so that the choice of states does not depend on results.
    of_neighbours: Stream,
    scratch: Vec<Twofold>,
    batches: u64,
    /// The measurements of each function.
    pub seen: Vec<Seen>,
}

impl Run {
    /// A run without measurements yet.
    pub fn new(manipulator: &Manipulator, module: &Module, subjects: Vec<Subject>, seed: u64) -> Run {
        Run {
            seen: subjects.iter().map(Subject::nothing).collect(),
            subjects,
            domain: domain_of(manipulator, module),
            real: module.real,
            circle: Circle::new(),
            stream: Stream::new(seed),
            of_neighbours: Stream::new(!seed),
            scratch: Vec::new(),
            batches: 0,
        }
    }

    /// Continues with this many batches of [`LANES`] states.
    pub fn go_on(&mut self, batches: u64) -> Result<(), String> {
        for _ in 0..batches {
            let of = if self.batches < BATCHES_OF_CORNERS { corner } else { state };
            let states = std::array::from_fn(|_| of(&self.domain, &mut self.stream, self.real));
            self.batches += 1;
            let batch = Batch::new(states, &self.circle, self.real)?;
            for (subject, seen) in self.subjects.iter_mut().zip(&mut self.seen) {
                let mut look = |batch: &Batch, seen: &mut Seen| {
                    subject.look(batch, self.real, &mut self.scratch, seen).ok_or("an angle out of reach")
                };
                let Some(lane) = look(&batch, seen)? else { continue };
                let (outside, singular) = (seen.outside, seen.singular);
                for _ in 0..BATCHES_OF_NEIGHBOURS {
                    let near = |_| neighbour(&batch.states[lane], &self.domain, &mut self.of_neighbours, self.real);
                    look(&Batch::new(std::array::from_fn(near), &self.circle, self.real)?, seen)?;
                }
                (seen.outside, seen.singular) = (outside, singular);
            }
            self.seen.iter_mut().for_each(|seen| seen.states += LANES as u64);
        }
        Ok(())
    }
}
