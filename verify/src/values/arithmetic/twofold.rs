//! Numbers of two floats in lanes: 106 bits, for values to measure rounding errors by that are cheap enough for millions of states.
//!
//! A number is the sum of `high` and `low`, `low` at most half a unit in the last place of `high`. Sums are right to 3 · 2^-106 of the
//! result, products to 7, quotients to 15 (Joldes, Muller, Popescu: Tight and rigorous error bounds for basic building blocks of
//! double-word arithmetic, 2017, algorithms 6, 10 and 17), literals to 1, sines and cosines to 2^-92 by the tests below. So a program runs
//! here as it does in f64, with a unit roundoff of 2^-92 in place of 2^-53 at the worst: **its error is below 2^-38 of the running bound**,
//! and 256 bits ([`super::wide`]) are needed only to show the worst cases.

use super::wide::{stribeck, wide_circle, Wide, WideArguments};
use crate::values::element::Element;
use crate::values::float::{Arguments, LANES};
use crate::values::program::{Angle, Argument, Inputs, Program, Scaled, Step};

/// high + low.
pub type Pair = (f64, f64);

/// Numbers in lanes.
#[derive(Clone, Copy, Debug)]
pub struct Twofold {
    /// The nearest floats.
    pub high: [f64; LANES],
    /// What is left.
    pub low: [f64; LANES],
}

#[inline(always)]
fn sum(a: f64, b: f64) -> Pair {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// The sum where |a| ≥ |b|.
#[inline(always)]
fn quick_sum(a: f64, b: f64) -> Pair {
    let s = a + b;
    (s, b - (s - a))
}

/// A float in two halves whose products are exact (Dekker 1971).
#[inline(always)]
fn split(a: f64) -> Pair {
    let c = 134_217_729.0 * a;
    let high = c - (c - a);
    (high, a - high)
}

#[inline(always)]
fn product(a: f64, b: f64) -> Pair {
    let p = a * b;
    // Both are exact; a fused operation that the processor lacks would be slow.
    if cfg!(target_feature = "fma") {
        return (p, a.mul_add(b, -p));
    }
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

#[inline(always)]
fn plus(x: Pair, y: Pair) -> Pair {
    let (sh, sl) = sum(x.0, y.0);
    let (th, tl) = sum(x.1, y.1);
    let (vh, vl) = quick_sum(sh, sl + th);
    quick_sum(vh, tl + vl)
}

#[inline(always)]
fn negated(x: Pair) -> Pair {
    (-x.0, -x.1)
}

#[inline(always)]
fn times(x: Pair, y: Pair) -> Pair {
    let (h, l) = product(x.0, y.0);
    quick_sum(h, l + (x.0 * y.1 + x.1 * y.0))
}

#[inline(always)]
fn over(x: Pair, y: Pair) -> Pair {
    let q = x.0 / y.0;
    let (h, l) = product(y.0, q);
    let (s, t) = quick_sum(h, y.1 * q);
    let (rh, rl) = quick_sum(s, t + l);
    quick_sum(q, ((x.0 - rh) + (x.1 - rl)) / y.0)
}

impl Twofold {
    /// The number 0.
    pub const ZERO: Twofold = Twofold { high: [0.0; LANES], low: [0.0; LANES] };

    #[inline(always)]
    fn of(at: impl Fn(usize) -> Pair) -> Twofold {
        let mut all = Twofold::ZERO;
        for lane in 0..LANES {
            (all.high[lane], all.low[lane]) = at(lane);
        }
        all
    }

    /// Floats, exactly.
    pub fn exact(high: [f64; LANES]) -> Twofold {
        Twofold { high, low: [0.0; LANES] }
    }

    /// a + b.
    #[must_use]
    pub fn plus(&self, other: &Twofold) -> Twofold {
        Twofold::of(|lane| plus(self.at(lane), other.at(lane)))
    }

    /// a - b.
    #[must_use]
    pub fn minus(&self, other: &Twofold) -> Twofold {
        Twofold::of(|lane| plus(self.at(lane), negated(other.at(lane))))
    }

    /// a b.
    #[must_use]
    pub fn times(&self, other: &Twofold) -> Twofold {
        Twofold::of(|lane| times(self.at(lane), other.at(lane)))
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> Pair {
        (self.high[lane], self.low[lane])
    }
}

/// The pair nearest to a wide number.
pub fn pair(value: &Wide) -> Pair {
    let high = value.to_f64();
    let (high, low) = quick_sum(high, value.minus(&Wide::from_f64(high)).to_f64());
    (high, low)
}

/// Steps of the table of sines in a unit; the rest of an angle is at most half a step.
const STEPS: f64 = 16.0;
const ANGLES: usize = 128;
/// Terms of either series: the next one is below 2^-124 at 1/32.
const TERMS: usize = 8;
/// Smaller sines and cosines are asked of 256 bits.
const SMALL: f64 = 0.001;

/// Sine and cosine of floats.
#[derive(Clone, Debug)]
pub struct Circle {
    table: Vec<(Pair, Pair)>,
    reciprocals: Vec<Pair>,
}

fn wide_wave(q: f64) -> Option<(Pair, Pair)> {
    let one = Arguments { q: vec![q], ..Arguments::default() };
    let (sine, cosine) = WideArguments::new(&one)?.sine_cosine(&[(0, 1)]);
    Some((pair(&sine), pair(&cosine)))
}

impl Circle {
    /// The table, from 256 bits.
    pub fn new() -> Circle {
        let entry = |j: usize| wide_wave(j as f64 / STEPS).unwrap_or(((f64::NAN, 0.0), (f64::NAN, 0.0)));
        // 1/(k+1)! from 1/0! on; all factorials are floats.
        let factorial = |k: usize| (1..=k).fold(1.0, |product, i| product * i as f64);
        let reciprocals = (0..2 * TERMS).map(|k| over((1.0, 0.0), (factorial(k), 0.0))).collect();
        Circle { table: (0..=ANGLES).map(entry).collect(), reciprocals }
    }

    /// Sine and cosine of an angle.
    pub fn wave(&self, q: f64) -> Option<(Pair, Pair)> {
        let size = q.abs();
        let j = (size * STEPS).round();
        let Some((sine, cosine)) = self.table.get(j as usize) else { return wide_wave(q) };
        // Exact: a multiple of the last place of q below 1/32, or q itself.
        let r = size - j / STEPS;
        let square = product(r, r);
        let series = |first: usize| {
            let term = |k: usize| {
                let reciprocal = self.reciprocals[2 * k + first];
                if k.is_multiple_of(2) {
                    reciprocal
                } else {
                    negated(reciprocal)
                }
            };
            (0..TERMS - 1).rev().fold(term(TERMS - 1), |tail, k| plus(times(tail, square), term(k)))
        };
        let (s, c) = (times(series(1), (r, 0.0)), series(0));
        let (mut s, c) = if j == 0.0 {
            (s, c)
        } else {
            let (sine, cosine) = (plus(times(*sine, c), times(*cosine, s)), plus(times(*cosine, c), negated(times(*sine, s))));
            if sine.0.abs() < SMALL || cosine.0.abs() < SMALL {
                return wide_wave(q);
            }
            (sine, cosine)
        };
        if q < 0.0 {
            s = negated(s);
        }
        Some((s, c))
    }
}

impl Default for Circle {
    fn default() -> Circle {
        Circle::new()
    }
}

/// Sine and cosine of a sum from those of its two parts.
fn added((sine, cosine): (Twofold, Twofold), (s, c): (Twofold, Twofold)) -> (Twofold, Twofold) {
    let both = |a: &Twofold, b: &Twofold, d: &Twofold, e: &Twofold| {
        Twofold::of(|lane| plus(times(a.at(lane), b.at(lane)), times(d.at(lane), e.at(lane))))
    };
    let minus = Twofold::of(|lane| negated(s.at(lane)));
    (both(&sine, &c, &cosine, &s), both(&cosine, &c, &sine, &minus))
}

/// Arguments in lanes with the sines and cosines of the joint variables.
#[derive(Clone, Debug)]
pub struct TwofoldArguments {
    arguments: Arguments<[f64; LANES]>,
    waves: Vec<(Twofold, Twofold)>,
}

impl TwofoldArguments {
    /// At the floats given, exactly.
    pub fn new(circle: &Circle, states: &[Arguments<f64>; LANES]) -> Option<TwofoldArguments> {
        let arguments = Arguments::gather(states, |states| states);
        let wave = |q: &[f64; LANES]| {
            let (mut sine, mut cosine) = (Twofold::ZERO, Twofold::ZERO);
            for lane in 0..LANES {
                let (s, c) = circle.wave(q[lane])?;
                (sine.high[lane], sine.low[lane]) = s;
                (cosine.high[lane], cosine.low[lane]) = c;
            }
            Some((sine, cosine))
        };
        let waves = arguments.q.iter().map(wave).collect::<Option<Vec<_>>>()?;
        Some(TwofoldArguments { arguments, waves })
    }

    /// An entry of an argument.
    pub fn entry(&self, argument: Argument, index: usize) -> Twofold {
        Twofold::exact(self.arguments.of(argument)[index])
    }

    /// Sine and cosine of a sum of joint variables, by the addition theorem.
    fn wave(&self, angle: &[(usize, i64)]) -> (Twofold, Twofold) {
        let mut sum: Option<(Twofold, Twofold)> = None;
        for &(joint, factor) in angle {
            let (s, c) = self.waves[joint];
            let s = if factor < 0 { Twofold::of(|lane| negated(s.at(lane))) } else { s };
            for _ in 0..factor.unsigned_abs() {
                sum = Some(sum.map_or((s, c), |sum| added(sum, (s, c))));
            }
        }
        sum.unwrap_or((Twofold::ZERO, Twofold::of(|_| (1.0, 0.0))))
    }

    /// Sine and cosine of a sum of joint variables with factors, and a constant.
    fn scaled_wave(&self, terms: &[Scaled<Pair>], constant: Option<(Pair, bool)>) -> (Twofold, Twofold) {
        let (mut sine, mut cosine) = (Twofold::ZERO, Twofold::ZERO);
        for lane in 0..LANES {
            let signed = |size: Pair, minus: bool| if minus { negated(size) } else { size };
            let term = |&(joint, sign, factor): &Scaled<Pair>| {
                let q = (self.arguments.of(Argument::Q)[joint][lane], 0.0);
                signed(factor.map_or(q, |factor| times(factor, q)), sign < 0)
            };
            let constant = constant.map(|(size, minus)| signed(size, minus));
            let sum = terms.iter().map(term).chain(constant).fold((0.0, 0.0), plus);
            let wide = Wide::from_f64(sum.0).plus(&Wide::from_f64(sum.1));
            // A float that is no number has no sine.
            let (s, c) = wide_circle(&wide).map_or(((f64::NAN, 0.0), (f64::NAN, 0.0)), |(s, c)| (pair(&s), pair(&c)));
            (sine.high[lane], sine.low[lane]) = s;
            (cosine.high[lane], cosine.low[lane]) = c;
        }
        (sine, cosine)
    }
}

/// The value of every step; the literals are followed by the circles of constants of angles ([`Program::exact_literals`]).
pub fn values(program: &Program, literals: &[Pair], arguments: &TwofoldArguments, values: &mut Vec<Twofold>) -> Option<()> {
    values.clear();
    let wave = |angle: &Angle| {
        if !angle.factors.is_empty() {
            return arguments
                .scaled_wave(&angle.scaled(literals), angle.turn.map(|(k, minus)| (literals[program.turns[k]], minus)));
        }
        let joints = arguments.wave(&angle.terms);
        let Some((k, minus)) = angle.turn else { return joints };
        let at = program.literals.len() + 2 * k;
        let (s, c) = (literals[at], literals[at + 1]);
        let circle = Twofold::of(|_| if minus { negated(s) } else { s });
        added(joints, (circle, Twofold::of(|_| c)))
    };
    for step in &program.steps {
        let both = |a: usize, b: usize| (&values[a], &values[b]);
        let value = match step {
            Step::Input(argument, index) => arguments.entry(*argument, *index),
            Step::Literal(index) => Twofold::of(|_| literals[*index]),
            Step::Sine(angle) => wave(angle).0,
            Step::Cosine(angle) => wave(angle).1,
            Step::Sign(joint) => {
                Twofold::exact(arguments.arguments.of(Argument::Dq)[*joint].map(|x| if x == 0.0 { 0.0 } else { x.signum() }))
            }
            Step::Stribeck(joint, velocity) => {
                let rates = arguments.arguments.of(Argument::Dq)[*joint];
                let (high, low) = literals[*velocity];
                let velocity = Wide::from_f64(high).plus(&Wide::from_f64(low));
                Twofold::of(|lane| {
                    let exact = stribeck(rates[lane], &velocity);
                    let high = exact.to_f64();
                    (high, exact.minus(&Wide::from_f64(high)).to_f64())
                })
            }
            Step::SignOf(a) => Twofold::exact(values[*a].high.map(|x| x.sign())),
            Step::Negate(a) => {
                let a = &values[*a];
                Twofold::of(|lane| negated(a.at(lane)))
            }
            Step::Add(a, b) => {
                let (a, b) = both(*a, *b);
                a.plus(b)
            }
            Step::Subtract(a, b) => {
                let (a, b) = both(*a, *b);
                a.minus(b)
            }
            Step::Multiply(a, b) | Step::Product(a, b) => {
                let (a, b) = both(*a, *b);
                a.times(b)
            }
            Step::Divide(a, b) => {
                let (a, b) = both(*a, *b);
                Twofold::of(|lane| over(a.at(lane), b.at(lane)))
            }
        };
        values.push(value);
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::stream::Stream;

    /// How far a pair is from a wide number, by the size of that.
    fn relative(found: Pair, exact: &Wide) -> f64 {
        let value = Wide::from_f64(found.0).plus(&Wide::from_f64(found.1));
        (value.minus(exact).to_f64() / exact.to_f64()).abs()
    }

    fn wide(x: Pair) -> Wide {
        Wide::from_f64(x.0).plus(&Wide::from_f64(x.1))
    }

    #[test]
    fn operations_are_as_fine_as_stated() {
        let mut stream = Stream::new(7);
        let unit = 2f64.powi(-106);
        for _ in 0..20_000 {
            let mut draw = || {
                let high = (stream.bits() >> 11) as f64 * 2f64.powi(stream.below(20) as i32 - 63);
                let high = if stream.below(2) == 0 { high } else { -high };
                sum(high, high * 2f64.powi(-54) * ((stream.bits() >> 11) as f64 * 2f64.powi(-53)))
            };
            let x = draw();
            // One time in four the difference cancels.
            let y = if stream_choice(x) { draw() } else { plus(negated(x), (x.0 * 2f64.powi(-40), 0.0)) };
            let (a, b) = (wide(x), wide(y));
            let s = a.plus(&b);
            if !s.is_zero() {
                assert!(relative(plus(x, y), &s) <= 3.1 * unit, "{x:?} + {y:?}");
            }
            assert!(relative(times(x, y), &a.times(&b)) <= 7.0 * unit, "{x:?} * {y:?}");
            assert!(relative(over(x, y), &a.over(&b).expect("not 0")) <= 15.1 * unit, "{x:?} / {y:?}");
        }
    }

    fn stream_choice(x: Pair) -> bool {
        !x.0.to_bits().is_multiple_of(4)
    }

    #[test]
    fn sines_are_as_fine_as_stated() {
        let (circle, mut stream) = (Circle::new(), Stream::new(11));
        let mut angles: Vec<f64> = (0..8000).map(|_| ((stream.bits() >> 11) as f64 * 2f64.powi(-53) - 0.5) * 20.0).collect();
        angles.extend((0..400).map(|k| f64::from(k) / 16.0 + 1.0 / 32.0));
        angles.extend([1e-300, 1e-9, std::f64::consts::PI, std::f64::consts::FRAC_PI_2, 3.1, 7.99, 8.1]);
        for q in angles {
            let exact = WideArguments::new(&Arguments { q: vec![q], ..Arguments::default() }).expect("an angle");
            let (sine, cosine) = exact.sine_cosine(&[(0, 1)]);
            let (s, c) = circle.wave(q).expect("an angle");
            assert!(relative(s, &sine) <= 2f64.powi(-92), "sin {q}: {:e}", relative(s, &sine));
            assert!(relative(c, &cosine) <= 2f64.powi(-92), "cos {q}: {:e}", relative(c, &cosine));
        }
        assert_eq!(circle.wave(0.0), Some(((0.0, 0.0), (1.0, 0.0))));
    }
}
