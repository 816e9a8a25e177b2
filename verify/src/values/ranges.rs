//! Intervals and error bounds of all steps of a program over a box of arguments.

use crate::values::enclosure::Float;
use crate::values::float::Arguments;
use crate::values::formula::{Formula, Rational};
use crate::values::program::{Angle, Argument, Literal, Program, Step};

/// Whether a float is a power of two whose products neither round nor leave the normal range for values of any robot.
pub fn is_power_of_two(value: f64) -> bool {
    let mantissa = value.to_bits() & ((1 << 52) - 1);
    value != 0.0 && mantissa == 0 && (1e-6..1e6).contains(&value.abs())
}

/// The distances of a program's literals from their exact values; 0 for exact floats.
pub fn literal_errors(program: &Program, values: &[Formula], real: Float) -> Vec<f64> {
    let error = |(literal, exact): (&Literal, &Formula)| {
        let same = exact.as_rational().is_some_and(|e| Rational::try_from(literal.value).is_ok_and(|f| f == *e));
        if same {
            0.0
        } else if literal.value.abs() < real.smallest_normal() {
            // A subnormal literal may have lost all its digits.
            real.smallest()
        } else {
            real.unit() * literal.value.abs()
        }
    };
    program.literals.iter().zip(values).map(error).collect()
}

/// Lowest and highest value of each argument's entries.
pub type Domain = Arguments<(f64, f64)>;

/// The largest of some sizes, at least 0; NaN if any is NaN.
pub fn worst(sizes: impl IntoIterator<Item = f64>) -> f64 {
    sizes.into_iter().fold(0.0, |most, size| if size > most || size.is_nan() { size } else { most })
}

/// An interval around the exact value, and an error bound of the computed value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
    /// The error.
    pub error: f64,
}

/// Margin for the rounding errors of the bounds themselves.
const OUTWARD: f64 = 1.0 + 1e-14;

impl Range {
    fn exact(low: f64, high: f64) -> Range {
        Range { low, high, error: 0.0 }
    }

    /// exp(-|rate| / velocity) over an interval of rates, in floats.
    pub(crate) fn stribeck((low, high): (f64, f64), velocity: f64, real: Float) -> Range {
        let most = low.abs().max(high.abs());
        let least = if low <= 0.0 && high >= 0.0 { 0.0 } else { low.abs().min(high.abs()) };
        let at = |rate: f64| libm::exp(-rate / velocity);
        // Two units for the function, and two of |rate| / velocity, multiplied by at most x exp(-x) <= 0.37. Values below 1e-17 become 0.
        Range::of(&[at(most) - 1e-15, at(least)], 4.0 * real.unit() + 1e-17)
    }

    /// The sign of a value in this range. If the value can be 0, the sign has the relative error of the value: near zero, where the value is as small
    /// as its error, the sign is arbitrary, and no bound over a box covers that.
    pub(crate) fn sign(&self) -> Range {
        let size = self.size();
        if self.low > self.error {
            Range::exact(1.0, 1.0)
        } else if self.high < -self.error {
            Range::exact(-1.0, -1.0)
        } else if size == 0.0 {
            Range::exact(0.0, 0.0)
        } else {
            let error = self.error / size;
            Range { low: -1.0, high: 1.0, error: if error <= 2.0 { error } else { 2.0 } }
        }
    }

    /// The unbounded range.
    pub(crate) const ANYTHING: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY, error: f64::INFINITY };

    /// The range, if neither exact nor computed values leave the scalar.
    fn within(self, real: Float) -> Range {
        if self.size() + self.error <= real.largest() {
            self
        } else {
            Range::ANYTHING
        }
    }

    /// The range of some values, widened by possible rounding errors.
    pub(crate) fn of(ends: &[f64], error: f64) -> Range {
        if ends.iter().any(|end| end.is_nan()) {
            return Range::ANYTHING;
        }
        let low = ends.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let high = ends.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let widen = |x: f64, sign: f64| x + sign * (x.abs() * 1e-15 + f64::MIN_POSITIVE);
        Range { low: widen(low, -1.0), high: widen(high, 1.0), error: error * OUTWARD }
    }

    /// The maximum absolute value.
    pub fn size(&self) -> f64 {
        self.low.abs().max(self.high.abs())
    }
}

/// Sine and cosine are unrestricted beyond this angle.
const FARTHEST: f64 = 1e6;

/// The range of the sine of an interval shifted by `shift` (a quarter turn for the cosine).
fn wave(low: f64, high: f64, shift: f64) -> (f64, f64) {
    use std::f64::consts::{FRAC_PI_2, PI};
    let (a, b) = (low + shift, high + shift);
    // Beyond it, additions round by more than the margin below.
    if !(a.abs() <= FARTHEST && b.abs() <= FARTHEST) {
        return (-1.0, 1.0);
    }
    // Whether the interval contains `peak` plus whole turns, with a margin.
    let contains = |peak: f64| ((a - peak - 1e-9) / (2.0 * PI)).ceil() * 2.0 * PI + peak <= b + 1e-9;
    let ends = [a.sin(), b.sin()];
    let low = if contains(-FRAC_PI_2) { -1.0 } else { ends[0].min(ends[1]) - 1e-9 };
    let high = if contains(FRAC_PI_2) { 1.0 } else { ends[0].max(ends[1]) + 1e-9 };
    (low.max(-1.0), high.min(1.0))
}

/// Values and errors of all steps of a program over a domain; `errors` are those of the literals, and no divisor is below `smallest`.
pub fn ranges(program: &Program, errors: &[f64], domain: &Domain, smallest: Option<f64>, real: Float) -> Vec<Range> {
    let evaluation = Evaluation { program, errors, domain, smallest, real };
    let mut ranges: Vec<Range> = Vec::with_capacity(program.steps.len());
    for step in &program.steps {
        ranges.push(evaluation.step(step, &ranges).within(real));
    }
    ranges
}

/// The evaluation of a program over a domain.
struct Evaluation<'a> {
    program: &'a Program,
    /// Errors of its literals.
    errors: &'a [f64],
    domain: &'a Domain,
    /// Lower bound of all divisors that may come close to 0.
    smallest: Option<f64>,
    real: Float,
}

impl Evaluation<'_> {
    /// The sine of an angle plus `shift`, including the rounding of the angle's sum.
    fn sine(&self, angle: &Angle, shift: f64) -> Range {
        let (u, terms, q) = (self.real.unit(), &angle.terms, &self.domain.q);
        let value = |literal: usize| self.program.literals[literal].value;
        let (mut low, mut high) = (0.0, 0.0);
        let scale = |i: usize| terms[i].1 as f64 * angle.factors.get(i).copied().flatten().map_or(1.0, value);
        for (i, &(joint, _)) in terms.iter().enumerate() {
            let (a, b) = (q[joint].0 * scale(i), q[joint].1 * scale(i));
            (low, high) = (low + a.min(b), high + a.max(b));
        }
        let literal = angle.turn.map(|(k, minus)| (self.program.turns[k], minus));
        let turn = literal.map_or(0.0, |(literal, minus)| value(literal) * if minus { -1.0 } else { 1.0 });
        (low, high) = (low + turn, high + turn);
        let parts = terms.len() + usize::from(literal.is_some());
        let slack = if parts > 1 || (0..terms.len()).any(|i| scale(i).abs() != 1.0) {
            let largest = |i: usize| q[terms[i].0].0.abs().max(q[terms[i].0].1.abs());
            let sizes = (0..terms.len()).map(|i| largest(i) * scale(i).abs()).sum::<f64>();
            // What factors are off by.
            let off = |(i, factor): (usize, &Option<usize>)| largest(i) * factor.map_or(0.0, |literal| self.errors[literal]);
            let off = angle.factors.iter().enumerate().map(off).sum::<f64>();
            parts as f64 * u * (sizes + turn.abs()) + off + literal.map_or(0.0, |(l, _)| self.errors[l])
        } else {
            0.0
        };
        let (low, high) = wave(low, high, shift);
        Range::of(&[low, high], 2.0 * u * low.abs().max(high.abs()) + slack + self.real.smallest_normal())
    }

    /// The range of a step with the error `carried` from its operands, plus the rounding.
    fn rounded(&self, ends: &[f64], carried: f64) -> Range {
        Range::of(ends, carried + self.real.unit() * (largest(ends) + carried))
    }

    /// The range of a step from earlier ranges.
    fn step(&self, step: &Step, ranges: &[Range]) -> Range {
        let of = |i: &usize| ranges[*i];
        match step {
            Step::Input(argument, index) => {
                let (low, high) = self.domain.of(*argument)[*index];
                Range::exact(low, high)
            }
            Step::Literal(index) => {
                let (value, error) = (self.program.literals[*index].value, self.errors[*index]);
                Range { low: value - error, high: value + error, error }
            }
            Step::Sine(angle) => self.sine(angle, 0.0),
            Step::Cosine(angle) => self.sine(angle, std::f64::consts::FRAC_PI_2),
            Step::Sign(joint) => {
                let (low, high) = self.domain.of(Argument::Dq)[*joint];
                Range::exact(low.signum().min(0.0), high.signum().max(0.0))
            }
            Step::Stribeck(joint, literal) => {
                Range::stribeck(self.domain.of(Argument::Dq)[*joint], self.program.literals[*literal].value, self.real)
            }
            Step::SignOf(a) => of(a).sign(),
            Step::Negate(a) => {
                let a = of(a);
                Range { low: -a.high, high: -a.low, ..a }
            }
            Step::Add(x, y) => {
                let (a, b) = (of(x), of(y));
                // A fused product may be subnormal, although a sum of floats would be exact there.
                let lost = if self.program.factors(*x).is_some() { self.real.smallest_normal() } else { 0.0 };
                self.rounded(&[a.low + b.low, a.high + b.high], a.error + b.error + lost)
            }
            Step::Subtract(a, b) => {
                let (a, b) = (of(a), of(b));
                self.rounded(&[a.low - b.high, a.high - b.low], a.error + b.error)
            }
            Step::Multiply(x, y) => self.product((*x, of(x)), (*y, of(y))),
            Step::Product(x, y) => {
                let (ends, carried) = products((*x, of(x)), (*y, of(y)));
                Range::of(&ends, carried)
            }
            Step::Divide(x, y) => {
                let least = self.program.divisor(step).and(self.smallest);
                self.quotient(of(x), of(y), least.unwrap_or(0.0))
            }
        }
    }

    fn is_power_of_two(&self, step: usize) -> bool {
        matches!(self.program.steps[step], Step::Literal(l) if self.errors[l] == 0.0 && is_power_of_two(self.program.literals[l].value))
    }

    /// The product of two steps, given by number and range.
    fn product(&self, (x, a): (usize, Range), (y, b): (usize, Range)) -> Range {
        let (ends, carried) = products((x, a), (y, b));
        if self.is_power_of_two(x) || self.is_power_of_two(y) {
            // A product of ½ or less with a barely normal value loses digits.
            let factor = if self.is_power_of_two(x) { a.size() } else { b.size() };
            Range::of(&ends, carried + if factor < 1.0 { self.real.smallest() } else { 0.0 })
        } else {
            self.rounded(&ends, carried + self.real.smallest_normal())
        }
    }

    /// The quotient by a divisor of at least this size.
    fn quotient(&self, a: Range, mut b: Range, least: f64) -> Range {
        // All divisors are positive or all negative, because pivots of B keep their sign.
        if b.high >= -b.low {
            b.low = b.low.max(least);
        } else {
            b.high = b.high.min(-least);
        }
        let left = b.low.abs().min(b.high.abs()) - b.error;
        if left > 0.0 && b.low.signum() == b.high.signum() {
            let ends = [a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high];
            self.rounded(&ends, (a.error + largest(&ends) * b.error) / left + self.real.smallest_normal())
        } else {
            Range::ANYTHING
        }
    }
}

/// The products of the interval ends of two steps, and their propagated error.
fn products((x, a): (usize, Range), (y, b): (usize, Range)) -> ([f64; 4], f64) {
    let carried = a.size() * b.error + b.size() * a.error + a.error * b.error;
    let mut ends = [a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high];
    if x == y && a.low < 0.0 && a.high > 0.0 {
        ends = [0.0, ends[0].max(ends[3]), 0.0, 0.0];
    }
    (ends, carried)
}

fn largest(ends: &[f64]) -> f64 {
    ends.iter().fold(0.0f64, |a, b| a.max(b.abs()))
}
