//! Rounding errors as they occur: the functions of a module in its own scalar against 256 bits, at random states of the box, beside what the
//! two bounds say.

use armgen_codegen::manipulator::Manipulator;

use crate::arithmetic::wide::{Wide, WideArguments};
use crate::arithmetic::{Element, Stream};
use crate::bounds::{a_priori, domain_of, draw, literal_errors, Bound, Domain};
use crate::claims::Claims;
use crate::companion::Table;
use crate::enclosure::Float;
use crate::float::Arguments;
use crate::program::{Program, Step};
use crate::reader::Module;

/// What was seen of a function; sizes are those of the largest entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// The function.
    pub name: String,
    /// States tried.
    pub states: u64,
    /// Largest value.
    pub value: f64,
    /// Largest error.
    pub error: f64,
    /// Largest running bound.
    pub running: f64,
    /// The a-priori bound.
    pub a_priori: f64,
    /// States at which the running bound was exceeded.
    pub beyond_running: u64,
    /// States at which the a-priori bound was exceeded.
    pub beyond_a_priori: u64,
    /// States that the a-priori bound does not speak of: a divisor is smaller than it says.
    pub outside: u64,
}

impl Seen {
    /// The running bound by the error; `None` if there was no error.
    pub fn ratio(&self) -> Option<f64> {
        (self.error > 0.0).then(|| self.running / self.error)
    }

    /// What was seen at other states too.
    pub fn join(&mut self, other: &Seen) {
        self.states += other.states;
        self.value = self.value.max(other.value);
        self.error = self.error.max(other.error);
        self.running = self.running.max(other.running);
        self.beyond_running += other.beyond_running;
        self.beyond_a_priori += other.beyond_a_priori;
        self.outside += other.outside;
    }
}

/// What the evaluation with 256 bits may itself be wrong by, in units of values: more than its sines at 0 are.
const REFERENCE: f64 = 1e-60;

/// A function ready to be measured.
pub struct Subject {
    /// The program that runs.
    pub program: Program,
    exact: Vec<Wide>,
    table: Table,
    bound: Bound,
    divisors: Vec<usize>,
}

impl Subject {
    /// The functions of a module, with the exact values of their literals.
    pub fn all(manipulator: &Manipulator, module: &Module, claims: &Claims) -> Result<Vec<Subject>, String> {
        let domain = domain_of(manipulator, module);
        let of = |(name, function): &(String, Result<crate::reader::Function, String>)| {
            let program = function.as_ref().map_err(|e| format!("`{name}`: {e}"))?.program.clone();
            let values = claims.resolve(name, &program.literals, module.real).values;
            let errors = literal_errors(&program, &values, module.real);
            let exact: Option<Vec<Wide>> = values.iter().map(Wide::from_formula).collect();
            let exact = exact.ok_or(format!("`{name}`: a literal out of reach"))?;
            let table = Table::of(&program, &errors, module.real)?;
            let bound = a_priori(&program, &errors, &domain, module.real);
            let divisor = |step: &Step| match step {
                Step::Divide(_, divisor) => Some(*divisor),
                _ => None,
            };
            let divisors = program.steps.iter().filter_map(divisor).collect();
            Ok(Subject { program, exact, table, bound, divisors })
        };
        module.functions.iter().map(of).collect()
    }

    /// The same with another program in place of the one that the bounds are of.
    pub fn with_program(self, program: Program) -> Subject {
        Subject { program, ..self }
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
        }
    }

    fn look(&self, arguments: &Arguments<f64>, wide: &WideArguments, real: Float, seen: &mut Seen) {
        let values = self.program.values(wide, &self.exact);
        let found = self.program.run_float(arguments, real);
        let running = self.table.run(arguments);
        let (mut beyond, mut beyond_a_priori) = (false, false);
        let entries = self.program.outputs.iter().zip(found.iter().zip(&running)).zip(&self.bound.entries);
        for ((output, (&found, &(_, running))), &a_priori) in entries {
            let error = match &values[output.step] {
                Some(exact) => exact.minus(&Wide::from_f64(found)).to_f64().abs(),
                None => f64::INFINITY,
            };
            seen.value = seen.value.max(found.abs());
            seen.error = seen.error.max(error);
            seen.running = seen.running.max(running);
            // Not `error > running`: what is not a number is beyond as well.
            let own = REFERENCE * (1.0 + found.abs());
            beyond |= !(error <= running + own);
            beyond_a_priori |= !(error <= a_priori + own);
        }
        seen.states += 1;
        seen.beyond_running += u64::from(beyond);
        let least = |&divisor: &usize| values[divisor].as_ref().map_or(0.0, |d| d.to_f64().abs());
        let inside = self.bound.smallest_divisor.is_none_or(|smallest| self.divisors.iter().map(least).all(|d| d >= smallest));
        seen.outside += u64::from(!inside);
        seen.beyond_a_priori += u64::from(inside && beyond_a_priori);
    }
}

/// A state of the box; one in 16 lies on its corners and in its middle.
fn state(domain: &Domain, stream: &mut Stream, real: Float) -> Arguments<f64> {
    let drawn = draw(domain, stream, real);
    if stream.below(16) > 0 {
        return drawn;
    }
    let mut corner = |v: &[f64]| v.iter().map(|x| if stream.below(2) == 0 { 0.0 } else { *x }).collect::<Vec<f64>>();
    Arguments {
        q: corner(&drawn.q),
        dq: corner(&drawn.dq),
        ddq: corner(&drawn.ddq),
        dqr: corner(&drawn.dqr),
        ddqr: corner(&drawn.ddqr),
        tau: corner(&drawn.tau),
        pi: drawn.pi,
    }
}

/// What is seen of each function at so many states.
pub fn measure(manipulator: &Manipulator, module: &Module, subjects: &[Subject], states: u64, seed: u64) -> Vec<Seen> {
    let domain = domain_of(manipulator, module);
    let mut stream = Stream::new(seed);
    let mut seen: Vec<Seen> = subjects.iter().map(Subject::nothing).collect();
    for _ in 0..states {
        let arguments = state(&domain, &mut stream, module.real);
        let Some(wide) = WideArguments::new(&arguments) else { continue };
        for (subject, seen) in subjects.iter().zip(&mut seen) {
            subject.look(&arguments, &wide, module.real, seen);
        }
    }
    seen
}
