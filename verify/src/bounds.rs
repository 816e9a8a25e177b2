//! A-priori error bounds: how far rounding can take the entries of a function from the exact ones, anywhere in a box of arguments.
//!
//! Every step has an interval that its exact value cannot leave and a bound of its error; both follow from those of its operands, by interval
//! arithmetic and by the rules of [`mod@crate::companion`] with the largest sizes in place of the values:
//!
//! ```text
//! |fl(x + y) - (x* + y*)| ≤ e_x + e_y + u (|x + y|max + e_x + e_y)          and so on
//! ```
//!
//! Divisors are pivots of B, positive for every arm; how small they can become intervals do not show. A bound for a function that divides is
//! therefore one for states where every divisor is at least half of the smallest among some thousand states of the box, and says so.
//!
//! A value that can leave the scalar has no bound. One that can come below the normal numbers may be off by what they are spaced there, after an exact product
//! with ½ too. Sines and cosines of angles beyond 10⁶ rad take any value.

use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::emit::Notes;
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::Manipulator;

use crate::arithmetic::wide::Wide;
use crate::arithmetic::Stream;
use crate::claims::Claims;
use crate::enclosure::Float;
use crate::equations::arm::formula;
use crate::float::Arguments;
use crate::formula::{Formula, Rational};
use crate::program::{Angle, Argument, Literal, Program, Step};
use crate::reader::{Constant, Module};
use crate::residual::{residual, Equations, Residual};

/// Whether a float is a power of two whose products neither round nor leave the normal range for values of any robot.
pub fn is_power_of_two(value: f64) -> bool {
    let mantissa = value.to_bits() & ((1 << 52) - 1);
    value != 0.0 && mantissa == 0 && (1e-6..1e6).contains(&value.abs())
}

/// How far the literals of a program are from the exact values they stand for: 0 where the float is exact.
pub fn literal_errors(program: &Program, values: &[Formula], real: Float) -> Vec<f64> {
    let error = |(literal, exact): (&Literal, &Formula)| {
        let same = exact.as_rational().is_some_and(|e| Rational::try_from(literal.value).is_ok_and(|f| f == *e));
        if same {
            0.0
        } else if literal.value.abs() < real.smallest_normal() {
            // Below the normal numbers a literal may have lost all its digits.
            real.smallest()
        } else {
            real.unit() * literal.value.abs()
        }
    };
    program.literals.iter().zip(values).map(error).collect()
}

/// Lowest and highest value of each argument's entries.
pub type Domain = Arguments<(f64, f64)>;

/// A bound over a domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// By entry; infinite where there is none.
    pub entries: Vec<f64>,
    /// The bound holds where no divisor is smaller than this, if there are divisors.
    pub smallest_divisor: Option<f64>,
    /// For accelerations: how far they are from solving the equations of motion.
    pub residual: Option<Residual>,
    /// Of a function that divides: the largest error of what no reciprocal takes part in, where it meets one. Infinite where such a value can leave the
    /// scalar.
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
        self.entries.iter().fold(0.0, |a, &b| if b > a || b.is_nan() { b } else { a })
    }
}

/// The box for an arm: position and velocity limits and efforts where the description gives them; else a full turn or a metre to either
/// side, 4 rad/s or 1 m/s, 200 N m or N. Accelerations up to 10, references like what they are references of, parameters within a fifth of the nominal.
pub fn domain(manipulator: &Manipulator, nominal: &[f64]) -> Domain {
    let float = |n: &armgen_codegen::exact::Number| Float::F64.nearest(&formula(n));
    let mut domain = Domain::default();
    for joint in &manipulator.joints {
        let revolute = joint.kind == JointKind::Revolute;
        let free = if revolute { std::f64::consts::PI } else { 1.0 };
        let limits = joint.limits.position.as_ref().and_then(|[low, high]| Some((float(low)?, float(high)?)));
        domain.q.push(limits.unwrap_or((-free, free)));
        let symmetric = |limit: Option<f64>, otherwise: f64| {
            let size = limit.unwrap_or(otherwise);
            (-size, size)
        };
        let rate = symmetric(joint.limits.velocity.as_ref().and_then(float), if revolute { 4.0 } else { 1.0 });
        domain.dq.push(rate);
        domain.dqr.push(rate);
        domain.ddq.push((-10.0, 10.0));
        domain.ddqr.push((-10.0, 10.0));
        domain.tau.push(symmetric(joint.limits.effort.as_ref().and_then(float), 200.0));
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
    domain
}

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

/// An interval around the exact value, and how far the computed one can be from it.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
    /// The error.
    pub error: f64,
}

/// A little more, for the roundings of the bounds themselves.
const OUTWARD: f64 = 1.0 + 1e-14;

impl Range {
    fn exact(low: f64, high: f64) -> Range {
        Range { low, high, error: 0.0 }
    }

    /// No bound at all.
    const ANYTHING: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY, error: f64::INFINITY };

    /// The range, if no value of it and none that can be computed for it leaves the scalar.
    fn within(self, real: Float) -> Range {
        if self.size() + self.error <= real.largest() {
            self
        } else {
            Range::ANYTHING
        }
    }

    fn of(ends: &[f64], error: f64) -> Range {
        if ends.iter().any(|end| end.is_nan()) {
            return Range::ANYTHING;
        }
        let low = ends.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let high = ends.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let widen = |x: f64, sign: f64| x + sign * (x.abs() * 1e-15 + f64::MIN_POSITIVE);
        Range { low: widen(low, -1.0), high: widen(high, 1.0), error: error * OUTWARD }
    }

    /// The largest size of a value.
    pub fn size(&self) -> f64 {
        self.low.abs().max(self.high.abs())
    }
}

/// Angles beyond this may be any.
const FARTHEST: f64 = 1e6;

/// The range of sine (or cosine, a quarter turn on) over an interval.
fn wave(low: f64, high: f64, shift: f64) -> (f64, f64) {
    use std::f64::consts::{FRAC_PI_2, PI};
    let (a, b) = (low + shift, high + shift);
    // So far out additions round by more than the slack below.
    if !(a.abs() <= FARTHEST && b.abs() <= FARTHEST) {
        return (-1.0, 1.0);
    }
    // Whether a quarter turn plus k turns lies in the interval, with some slack.
    let contains = |peak: f64| ((a - peak - 1e-9) / (2.0 * PI)).ceil() * 2.0 * PI + peak <= b + 1e-9;
    let ends = [a.sin(), b.sin()];
    let low = if contains(-FRAC_PI_2) { -1.0 } else { ends[0].min(ends[1]) - 1e-9 };
    let high = if contains(FRAC_PI_2) { 1.0 } else { ends[0].max(ends[1]) + 1e-9 };
    (low.max(-1.0), high.min(1.0))
}

const STATES_FOR_DIVISORS: usize = 4096;

/// Half of the smallest divisor among random states of the box.
fn smallest_divisor(program: &Program, domain: &Domain, real: Float) -> Option<f64> {
    let divisors: Vec<usize> = program
        .steps
        .iter()
        .filter_map(|step| match step {
            Step::Divide(_, divisor) => Some(*divisor),
            _ => None,
        })
        .collect();
    if divisors.is_empty() {
        return None;
    }
    let pivots = program.part(&divisors);
    let literals: Vec<f64> = pivots.literals.iter().map(|l| l.value).collect();
    let mut stream = Stream::new(20_240_301);
    let mut smallest = f64::INFINITY;
    for _ in 0..STATES_FOR_DIVISORS {
        let values = pivots.run(&draw(domain, &mut stream, real), &literals);
        smallest = values.into_iter().fold(smallest, |smallest, value| smallest.min(value.map_or(0.0, f64::abs)));
    }
    Some(smallest / 2.0)
}

/// Values and errors of all steps of a program over a domain; `errors` are those of its literals, no divisor is below `smallest`.
fn ranges(program: &Program, errors: &[f64], domain: &Domain, smallest: Option<f64>, real: Float) -> Vec<Range> {
    let u = real.unit();
    let tiny = real.smallest_normal();
    let angle = |angle: &Angle, shift: f64| {
        let terms = &angle.terms;
        let (mut low, mut high) = (0.0, 0.0);
        for &(joint, factor) in terms {
            let (a, b) = (domain.q[joint].0 * factor as f64, domain.q[joint].1 * factor as f64);
            (low, high) = (low + a.min(b), high + a.max(b));
        }
        let literal = angle.turn.map(|(k, minus)| (program.turns[k], minus));
        let turn = literal.map_or(0.0, |(literal, minus)| program.literals[literal].value * if minus { -1.0 } else { 1.0 });
        (low, high) = (low + turn, high + turn);
        let parts = terms.len() + usize::from(literal.is_some());
        let slack = if parts > 1 || terms.iter().any(|(_, k)| k.abs() != 1) {
            let size =
                |&(joint, factor): &(usize, i64)| domain.q[joint].0.abs().max(domain.q[joint].1.abs()) * factor.abs() as f64;
            parts as f64 * u * (terms.iter().map(size).sum::<f64>() + turn.abs()) + literal.map_or(0.0, |(l, _)| errors[l])
        } else {
            0.0
        };
        let (low, high) = wave(low, high, shift);
        Range::of(&[low, high], 2.0 * u * low.abs().max(high.abs()) + slack + tiny)
    };
    let mut ranges: Vec<Range> = Vec::with_capacity(program.steps.len());
    for (i, step) in program.steps.iter().enumerate() {
        let of = |i: &usize| ranges[*i];
        let power_of_two = |i: &usize| matches!(program.steps[*i], Step::Literal(l) if errors[l] == 0.0 && is_power_of_two(program.literals[l].value));
        // The rounding of this step, whose operands bring in `carried`.
        let rounded = |ends: &[f64], carried: f64, times: f64| {
            let size = ends.iter().fold(0.0f64, |a, b| a.max(b.abs()));
            Range::of(ends, carried + times * u * (size + carried))
        };
        let range = match step {
            Step::Input(argument, index) => {
                let (low, high) = domain.of(*argument)[*index];
                Range::exact(low, high)
            }
            Step::Literal(index) => {
                let value = program.literals[*index].value;
                let error = errors[*index];
                Range { low: value - error, high: value + error, error }
            }
            Step::Sine(combination) => angle(combination, 0.0),
            Step::Cosine(combination) => angle(combination, std::f64::consts::FRAC_PI_2),
            Step::Sign(joint) => {
                let (low, high) = domain.of(Argument::Dq)[*joint];
                Range::exact(low.signum().min(0.0), high.signum().max(0.0))
            }
            Step::Negate(a) => {
                let a = of(a);
                Range { low: -a.high, high: -a.low, ..a }
            }
            Step::Add(a, b) => {
                let (a, b) = (of(a), of(b));
                rounded(&[a.low + b.low, a.high + b.high], a.error + b.error, 1.0)
            }
            Step::Subtract(a, b) => {
                let (a, b) = (of(a), of(b));
                rounded(&[a.low - b.high, a.high - b.low], a.error + b.error, 1.0)
            }
            Step::Multiply(x, y) => {
                let (a, b) = (of(x), of(y));
                let carried = a.size() * b.error + b.size() * a.error + a.error * b.error;
                let mut ends = [a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high];
                if x == y && a.low < 0.0 && a.high > 0.0 {
                    ends = [0.0, ends[0].max(ends[3]), 0.0, 0.0];
                }
                if power_of_two(x) || power_of_two(y) {
                    // A product with ½ or less of what is hardly normal loses digits.
                    let factor = if power_of_two(x) { a.size() } else { b.size() };
                    Range::of(&ends, carried + if factor < 1.0 { real.smallest() } else { 0.0 })
                } else {
                    rounded(&ends, carried + tiny, 1.0)
                }
            }
            Step::Divide(x, y) => {
                let (a, mut b) = (of(x), of(y));
                let least = smallest.unwrap_or(0.0);
                // All divisors are positive or all negative: pivots of B keep their sign.
                if b.high >= -b.low {
                    b.low = b.low.max(least);
                } else {
                    b.high = b.high.min(-least);
                }
                let left = b.low.abs().min(b.high.abs()) - b.error;
                if left > 0.0 && b.low.signum() == b.high.signum() {
                    let ends = [a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high];
                    let size = ends.iter().fold(0.0f64, |a, b| a.max(b.abs()));
                    rounded(&ends, (a.error + size * b.error) / left + tiny, 1.0)
                } else {
                    Range::ANYTHING
                }
            }
        };
        debug_assert_eq!(ranges.len(), i);
        ranges.push(range.within(real));
    }
    ranges
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

/// Of a function that divides: the steps that no quotient takes part in and that are divisors, or operands of those that a quotient takes part in, or entries.
pub fn undivided_operands(program: &Program) -> Vec<usize> {
    let mut divided: Vec<bool> = Vec::with_capacity(program.steps.len());
    let mut operands = BTreeSet::new();
    for step in &program.steps {
        let (of, quotient): (&[usize], bool) = match step {
            Step::Divide(a, b) => (&[*a, *b], true),
            Step::Negate(a) => (&[*a], false),
            Step::Add(a, b) | Step::Subtract(a, b) | Step::Multiply(a, b) => (&[*a, *b], false),
            Step::Input(..) | Step::Literal(_) | Step::Sine(_) | Step::Cosine(_) | Step::Sign(_) => (&[], false),
        };
        let takes_part = quotient || of.iter().any(|&operand| divided[operand]);
        if takes_part {
            operands.extend(of.iter().copied().filter(|&operand| !divided[operand]));
        }
        divided.push(takes_part);
    }
    if operands.is_empty() {
        return Vec::new();
    }
    let entries = program.outputs.iter().map(|output| output.step).filter(|&step| !divided[step]);
    operands.extend(entries);
    operands.into_iter().collect()
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
    let mut bounds = BTreeMap::new();
    for (name, function) in &module.functions {
        let Ok(function) = function else { continue };
        let values = claims.resolve(name, &function.program.literals, module.real).values;
        bounds.insert(name.clone(), of_function(&function.program, &values, &domain, module, claims));
    }
    bounds
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

/// What the documentation of a function says of its bound.
fn sentence(bound: &Bound) -> String {
    let size = bound.largest();
    if size == 0.0 {
        return "Rounding error: none.".into();
    }
    let of_torques = bound.residual.map(|r| {
        let (constant, factor) = (two_digits(r.constant), two_digits(r.factor));
        format!(
            "ddq is that of torques off by at most {constant} + {factor} max|ddq| N m (N), over the box in the head of this file, where all divisors \
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

/// What the documentation of a module says of the bounds of its functions.
pub fn notes(bounds: &BTreeMap<String, Bound>) -> Notes {
    Notes {
        head: BOX.map(String::from).to_vec(),
        functions: bounds.iter().map(|(name, bound)| (name.clone(), sentence(bound))).collect(),
    }
}
