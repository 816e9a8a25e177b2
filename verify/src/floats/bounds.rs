//! A-priori error bounds: how far rounding can take the entries of a function from the exact ones, anywhere in a box of arguments.
//!
//! Every step has an interval that its exact value cannot leave and a bound of its error; both follow from those of its operands, by interval
//! arithmetic and by the rules of [`mod@crate::floats::companion`] with the largest sizes in place of the values:
//!
//! ```text
//! |fl(x + y) - (x* + y*)| ≤ e_x + e_y + u (|x + y|max + e_x + e_y)          and so on
//! ```
//!
//! Divisors are pivots of B, positive for every arm, or their negatives; how small they can become intervals do not show. A bound for a
//! function that divides is therefore one for states where every divisor is at least half of the smallest among some thousand states of the
//! box, and says so.
//!
//! A value that can leave the scalar has no bound. One that can come below the normal numbers may be off by what they are spaced there,
//! after an exact product with ½ too. Sines and cosines of angles beyond 10⁶ rad take any value.

use std::collections::BTreeMap;

use armgen_description::kinds::{JointKind, ParameterId};
use armgen_description::manipulator::{Coordinate, Manipulator};
use armgen_description::parallel::parallel_map;

use crate::floats::residual::{residual, Equations, Residual};
use crate::read::claims::Claims;
use crate::read::reader::{Constant, Module};
use crate::textbook::equations::arm::formula;
use crate::values::arithmetic::wide::Wide;
use crate::values::divisors::undivided_operands;
use crate::values::enclosure::Float;
use crate::values::float::{Arguments, Lanes, LANES};
use crate::values::formula::Formula;
use crate::values::program::Program;
use crate::values::ranges::{literal_errors, ranges, worst, Domain};
use crate::values::stream::Stream;

/// A bound over a domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// By entry; infinite where there is none.
    pub entries: Vec<f64>,
    /// The bound holds where no divisor is smaller than this, if there are divisors.
    pub smallest_divisor: Option<f64>,
    /// For accelerations: how far they are from solving the equations of motion.
    pub residual: Option<Residual>,
    /// Of a function that divides: the largest error of what no reciprocal takes part in, where it meets one. Infinite where such a value
    /// can leave the scalar.
    pub undivided: f64,
}

impl Bound {
    /// In a few words: over the box, of the torques where that is what is bounded, or nothing.
    pub fn short(&self) -> String {
        let largest = self.largest();
        match (self.residual, largest.is_finite()) {
            (Some(r), _) => format!("of torques {} + {} max|ddq|", two_digits(r.constant), two_digits(r.factor)),
            (None, true) if largest == 0.0 => "none".into(),
            (None, true) => two_digits(largest),
            (None, false) => "bounded at a state alone".into(),
        }
    }

    /// The largest of all entries.
    pub fn largest(&self) -> f64 {
        worst(self.entries.iter().copied())
    }
}

/// The box for an arm: position and velocity limits and efforts where the description gives them; else a full turn or a metre to either
/// side, 4 rad/s or 1 m/s, 200 N m or N. Accelerations up to 10, references like what they are references of, parameters within a fifth of
/// the nominal.
pub fn domain(manipulator: &Manipulator, nominal: &[f64]) -> Domain {
    let float = |n: &armgen_description::exact::Number| Float::F64.nearest(&formula(n));
    let mut domain = Domain::default();
    for Coordinate { joint, limits: given, .. } in manipulator.coordinates() {
        let revolute = joint.kind == JointKind::Revolute;
        let free = if revolute { std::f64::consts::PI } else { 1.0 };
        let limits = given.position.as_ref().and_then(|[low, high]| Some((float(low)?, float(high)?)));
        domain.q.push(limits.unwrap_or((-free, free)));
        let symmetric = |limit: Option<f64>, otherwise: f64| {
            let size = limit.unwrap_or(otherwise);
            (-size, size)
        };
        let rate = symmetric(given.velocity.as_ref().and_then(float), if revolute { 4.0 } else { 1.0 });
        domain.dq.push(rate);
        domain.dqr.push(rate);
        domain.ddq.push((-10.0, 10.0));
        domain.ddqr.push((-10.0, 10.0));
        domain.tau.push(symmetric(given.effort.as_ref().and_then(float), 200.0));
    }
    let around = |&value: &f64| {
        let ends = (value * 0.8, value * 1.2);
        if value < 0.0 {
            (ends.1, ends.0)
        } else {
            ends
        }
    };
    domain.pi = nominal.iter().map(around).collect();
    if manipulator.gravity_is_argument {
        let size = free_fall(manipulator);
        domain.g0 = vec![(-size, size); 3];
    }
    domain
}

/// The size of the nominal gravity, as far as a mount can turn it; standard gravity (CGPM 1901) where that is 0.
fn free_fall(manipulator: &Manipulator) -> f64 {
    let nominal = |id: ParameterId| manipulator.parameters[id.0 as usize].nominal.clone();
    let coordinates = manipulator.gravity.iter().filter_map(|g| Float::F64.nearest(&formula(&g.evaluate(&nominal))));
    let size = coordinates.fold(0.0, f64::hypot);
    if size > 0.0 {
        size
    } else {
        9.80665
    }
}

/// A box with all angles, prismatic joints as far to one side as to the other, and parameters that are 0 in the description hardly more.
pub fn symmetric(manipulator: &Manipulator, domain: &Domain) -> Domain {
    let mut wide = domain.clone();
    for (of, (low, high)) in manipulator.coordinates().into_iter().zip(&mut wide.q) {
        let size = if of.joint.kind == JointKind::Revolute { std::f64::consts::PI } else { low.abs().max(high.abs()) };
        (*low, *high) = (-size, size);
    }
    let largest = domain.pi.iter().fold(0.0f64, |most, (low, high)| most.max(low.abs()).max(high.abs()));
    let least = if largest > 0.0 { largest * HARDLY } else { 1.0 };
    wide.pi.iter_mut().filter(|range| **range == (0.0, 0.0)).for_each(|range| *range = (-least, least));
    wide
}

/// As a part of the largest parameter.
const HARDLY: f64 = 1.0 / (1 << 30) as f64;

/// A random point of a domain, each entry rounded to the scalar.
pub fn draw(domain: &Domain, stream: &mut Stream, real: Float) -> Arguments<f64> {
    let mut uniform = |&(low, high): &(f64, f64)| {
        let part = (stream.bits() >> 11) as f64 / (1u64 << 53) as f64;
        let width = high - low;
        // A box from end to end of the scalar is wider than any number of it.
        let value = if width.is_finite() { low + width * part } else { low * (1.0 - part) + high * part };
        real.rounded(value).clamp(low, high)
    };
    let mut all = |v: &[(f64, f64)]| v.iter().map(&mut uniform).collect();
    Arguments {
        q: all(&domain.q),
        dq: all(&domain.dq),
        ddq: all(&domain.ddq),
        dqr: all(&domain.dqr),
        ddqr: all(&domain.ddqr),
        tau: all(&domain.tau),
        pi: all(&domain.pi),
        g0: all(&domain.g0),
    }
}

/// A state of a domain whose entries are at its ends, at 0 where that lies within, or anywhere, with the same odds.
pub fn corner(domain: &Domain, stream: &mut Stream, real: Float) -> Arguments<f64> {
    let drawn = draw(domain, stream, real);
    drawn.beside(domain, |x, (low, high)| match stream.below(4) {
        0 => low,
        1 => high,
        2 => 0f64.clamp(low, high),
        _ => x,
    })
}

const STATES_FOR_DIVISORS: usize = 4096;

/// Half of the smallest divisor among random states of the box.
fn smallest_divisor(program: &Program, domain: &Domain, real: Float) -> Option<f64> {
    let divisors = program.divisors();
    if divisors.is_empty() {
        return None;
    }
    let pivots = program.part(&divisors);
    let literals: Vec<Lanes> = pivots.literals.iter().map(|l| Lanes([l.value; LANES])).collect();
    let mut stream = Stream::new(20_240_301);
    let mut smallest = f64::INFINITY;
    for _ in 0..STATES_FOR_DIVISORS / LANES {
        let states: [Arguments<f64>; LANES] = std::array::from_fn(|_| draw(domain, &mut stream, real));
        for value in pivots.run(&states, &literals) {
            let Lanes(sizes) = value.unwrap_or(Lanes([0.0; LANES]));
            smallest = sizes.iter().fold(smallest, |smallest, size| smallest.min(size.abs()));
        }
    }
    Some(smallest / 2.0)
}

/// The bound of a function of a module over a domain; `values` are the exact ones of its literals.
pub fn of_function(program: &Program, values: &[Formula], domain: &Domain, module: &Module, claims: &Claims) -> Bound {
    let (real, errors) = (module.real, literal_errors(program, values, module.real));
    let smallest_divisor = smallest_divisor(program, domain, real);
    let ranges = ranges(program, &errors, domain, smallest_divisor, real);
    let error = |step: usize| {
        let error = ranges[step].error;
        if error.is_nan() {
            f64::INFINITY
        } else {
            error
        }
    };
    let residual = || {
        let equations = Equations::of(&program.name, module, claims)?;
        let literals = program.exact_literals(values).iter().map(Wide::from_formula).collect::<Option<Vec<Wide>>>()?;
        let state = draw(domain, &mut Stream::new(31), real);
        residual(program, &literals, &equations, &state, &ranges, real)
    };
    let undivided = undivided_operands(program).into_iter().map(error).fold(0.0, f64::max);
    Bound { entries: program.outputs.iter().map(|o| error(o.step)).collect(), smallest_divisor, residual: residual(), undivided }
}

/// The nominal parameters as the module holds them.
fn nominal(module: &Module) -> Vec<f64> {
    let Some(Constant::Array(entries)) = module.constants.get("NOMINAL_PARAMETERS") else { return Vec::new() };
    let number = |entry: &Constant| match entry {
        Constant::Number(true, literal) => -literal.value,
        Constant::Number(false, literal) => literal.value,
        _ => 0.0,
    };
    entries.iter().map(number).collect()
}

/// The box of a module's arm.
pub fn domain_of(manipulator: &Manipulator, module: &Module) -> Domain {
    domain(manipulator, &nominal(module)).map(|(low, high)| module.real.between(low, high))
}

/// The bounds of all functions that can be read, by name.
pub fn of(manipulator: &Manipulator, module: &Module, claims: &Claims) -> BTreeMap<String, Bound> {
    let domain = domain_of(manipulator, module);
    let bound = |(name, program): &(&str, &Program)| {
        let values = claims.resolve(name, &program.literals, module.real).values.clone();
        (name.to_string(), of_function(program, &values, &domain, module, claims))
    };
    parallel_map(&module.programs().collect::<Vec<_>>(), bound).into_iter().collect()
}

/// A bound with two digits, rounded up.
pub fn two_digits(bound: f64) -> String {
    if bound == 0.0 || !bound.is_finite() {
        return format!("{bound}");
    }
    let text = format!("{bound:.1e}");
    let Some((digits, exponent)) = text.split_once('e').filter(|_| text.parse::<f64>().is_ok_and(|rounded| rounded < bound))
    else {
        return text;
    };
    // One more in the second digit.
    let tenths = digits.chars().filter_map(|c| c.to_digit(10)).fold(0, |number, digit| 10 * number + digit) + 1;
    match (tenths, exponent.parse::<i32>()) {
        (100, Ok(exponent)) => format!("1.0e{}", exponent + 1),
        _ => format!("{}.{}e{exponent}", tenths / 10, tenths % 10),
    }
}

/// The box in words, for the head of a module; the numbers are those of [`domain`].
const BOX: [&str; 3] = [
    "Box of the rounding errors: q within POSITION_LIMITS (where these are infinite: pi rad or 1 m to either side), dq and dqr within",
    "VELOCITY_LIMITS (4 rad/s, 1 m/s), ddq and ddqr up to 10 rad/s^2 or m/s^2, tau within EFFORT_LIMITS (200 N m, 200 N), pi within a fifth of",
    "NOMINAL_PARAMETERS; arguments exact, sines and cosines within one unit in the last place.",
];

/// What follows it where gravity is an argument.
const BOX_OF_GRAVITY: &str =
    "Coordinates of g0 within the size of NOMINAL_GRAVITY to either side (9.80665 m/s^2 where that is 0).";

/// What the documentation of a function says of its bound.
fn sentence(bound: &Bound) -> String {
    let size = bound.largest();
    if size == 0.0 {
        return "Rounding error: none.".into();
    }
    let of_torques = bound.residual.map(|r| {
        let (constant, factor) = (two_digits(r.constant), two_digits(r.factor));
        format!(
            "ddq is that of torques off by at most {constant} + {factor} max|ddq| N m (N), over the box in the head of this file, where all pivots \
             come out positive; sqrt(DOF) times that over the smallest eigenvalue of B bounds the error of ddq"
        )
    });
    let of_entries = size.is_finite().then(|| {
        let size = two_digits(size);
        let where_it_holds =
            bound.smallest_divisor.map_or(String::new(), |least| format!(", where no divisor is below {}", two_digits(least)));
        format!("at most {size} in any entry, over the box in the head of this file{where_it_holds}")
    });
    match (of_torques, of_entries) {
        (Some(torques), Some(entries)) => format!("Rounding error: {torques}. Also {entries}."),
        (Some(one), None) | (None, Some(one)) => format!("Rounding error: {one}."),
        (None, None) if bound.smallest_divisor.is_none() || bound.undivided.is_infinite() => {
            "Rounding error: no bound over the whole box of the head of this file, values can leave the range of Real there; \
             at a state see the companion (`--bounds`)."
                .into()
        }
        (None, None) => "Rounding error: no bound over the whole box of the head of this file, divisors can come near 0; \
                         at a state see the companion (`--bounds`)."
            .into(),
    }
}

/// The error bounds of a module in words, for its documentation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Notes {
    /// Lines for the head of the file: the box.
    pub head: Vec<String>,
    /// A sentence for each function, by name.
    pub functions: BTreeMap<String, String>,
}

/// The error bounds of the functions of a module in words; `gravity`: whether the acceleration of free fall is an argument.
pub fn notes(bounds: &BTreeMap<String, Bound>, gravity: bool) -> Notes {
    Notes {
        head: BOX.into_iter().chain(gravity.then_some(BOX_OF_GRAVITY)).map(String::from).collect(),
        functions: bounds.iter().map(|(name, bound)| (name.clone(), sentence(bound))).collect(),
    }
}
