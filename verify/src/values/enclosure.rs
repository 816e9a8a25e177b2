//! Decides whether a float is nearest to an exact constant.
//!
//! The constant is enclosed between two multiples of 2^-bits with increasing precision, until the enclosure contains none of the midpoints
//! between the float and its neighbours. A fraction is compared with the midpoints directly, with ties to even.
//!
//! Square roots come from integer roots, pi = 4 atan(1/2) + 4 atan(1/3), sine and cosine from their series, and the arc tangent from its series
//! after repeated halving of the angle.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use dashu_base::{Abs, BitTest, Signed, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, UBig};

use crate::values::formula::{definitions, Formula, Rational, Root};
use crate::values::interval::{ceil_shift, floor_div, floor_shift, invert, multiply, Interval};

/// Precisions, tried in this order, bits.
const PRECISIONS: [usize; 5] = [128, 256, 1024, 4096, 12_288];

/// Additional working bits: deep graphs of definitions lose many.
const GUARDS: [usize; 3] = [64, 512, 4096];

/// Two fractions around a constant, less than 2^-bits apart; `None` if it is undefined (root of a negative, division by 0) or out of reach.
pub fn enclose(formula: &Formula, bits: usize) -> Option<(Rational, Rational)> {
    GUARDS.into_iter().find_map(|guard| {
        let working = bits + guard;
        let interval = interval(formula, working)?;
        if (&interval.high - &interval.low).bit_len() > guard {
            return None;
        }
        let fraction = |n: IBig| Rational::from_parts(n, UBig::ONE << working);
        Some((fraction(interval.low), fraction(interval.high)))
    })
}

/// The number of bits of a constant before the point; `None` if it is undefined or out of reach.
pub(crate) fn bits_before_the_point(formula: &Formula) -> Option<usize> {
    // The first enclosures are those that a float's digits need.
    let workings = GUARDS.into_iter().map(|guard| PRECISIONS[0] + guard).chain([PRECISIONS[PRECISIONS.len() - 1]]);
    workings.into_iter().find_map(|working| {
        let Interval { low, high } = interval(formula, working)?;
        Some((low.abs().max(high.abs()) >> working).bit_len())
    })
}

/// Sine and cosine of a fraction, as integers over 2^bits, and the number of bits; the error is below two units of 2^-`fine`.
pub fn sine_cosine_of(angle: &Rational, fine: usize) -> Option<(IBig, IBig, usize)> {
    let bits = fine + 8;
    let scaled = (angle * Rational::from(UBig::ONE << bits)).floor();
    let angle = Interval { high: &scaled + IBig::ONE, low: scaled };
    Some((series(&angle, 1, bits)?.low, series(&angle, 0, bits)?.low, bits))
}

/// Enclosures of pi and of angles, sines and cosines, by formula and number of bits. An arm has few angles, and thousands of constants made of
/// them; a series is the whole cost of such a constant.
static SERIES: Mutex<BTreeMap<(usize, Formula), Option<Interval>>> = Mutex::new(BTreeMap::new());

/// Entries that are kept before all are dropped; those of hundreds of arms.
const KEPT: usize = 1 << 13;

/// The value of a series, computed once. A name means another formula in another text, so that a formula with names is not kept.
fn once(formula: &Formula, bits: usize, compute: impl FnOnce() -> Option<Interval>) -> Option<Interval> {
    if definitions::has_names(formula) {
        return compute();
    }
    let key = (bits, formula.clone());
    let kept = || SERIES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = kept().get(&key) {
        return known.clone();
    }
    let value = compute();
    let mut kept = kept();
    if kept.len() >= KEPT {
        kept.clear();
    }
    kept.insert(key, value.clone());
    value
}

/// pi = 4 atan(1/2) + 4 atan(1/3).
fn pi(bits: usize) -> Option<Interval> {
    once(&Formula::Pi, bits, || {
        let (half, third) = (arctangent(2, bits), arctangent(3, bits));
        Some(Interval { low: (half.low + third.low) * IBig::from(4), high: (half.high + third.high) * IBig::from(4) })
    })
}

fn interval(formula: &Formula, bits: usize) -> Option<Interval> {
    let exact = |n: IBig| Interval { low: n.clone(), high: n };
    Some(match formula {
        Formula::Rational(value) => {
            let (n, d) = (value.numerator().clone() << bits, IBig::from(value.denominator().clone()));
            Interval { low: floor_div(&n, &d), high: -floor_div(&-n, &d) }
        }
        Formula::Pi => pi(bits)?,
        Formula::Root(Root::Integer(n)) => {
            let floor = IBig::from((n << (2 * bits)).sqrt());
            Interval { high: &floor + IBig::ONE, low: floor }
        }
        Formula::Root(Root::Nested(inner)) => {
            let inner = interval(inner, bits)?;
            if inner.low.is_negative() {
                return None;
            }
            let root = |n: &IBig| IBig::from((n.clone().unsigned_abs() << bits).sqrt());
            Interval { low: root(&inner.low), high: root(&inner.high) + IBig::ONE }
        }
        Formula::Sine(angle) => once(formula, bits, || series(&interval(angle, bits)?, 1, bits))?,
        Formula::Cosine(angle) => once(formula, bits, || series(&interval(angle, bits)?, 0, bits))?,
        Formula::Arctangent(tangent) => once(formula, bits, || {
            let (n, d) = (tangent.numerator().clone() << bits, IBig::from(tangent.denominator().clone()));
            arctangent_of(Interval { low: floor_div(&n, &d), high: -floor_div(&-n, &d) }, bits)
        })?,
        Formula::Defined(definition) => definition.enclosure(bits, |formula| interval(formula, bits))?,
        Formula::Sum(terms) => {
            let mut sum = exact(IBig::ZERO);
            for term in terms.iter() {
                let term = interval(term, bits)?;
                sum = Interval { low: sum.low + term.low, high: sum.high + term.high };
            }
            sum
        }
        Formula::Product(factors) => {
            let mut product = exact(IBig::ONE << bits);
            for factor in factors.iter() {
                product = multiply(&product, &interval(factor, bits)?, bits);
            }
            product
        }
        Formula::Power(base, exponent) => {
            let base = interval(base, bits)?;
            let one = exact(IBig::ONE << bits);
            let power = (0..exponent.unsigned_abs()).fold(one, |power, _| multiply(&power, &base, bits));
            if *exponent < 0 {
                invert(&power, bits)?
            } else {
                power
            }
        }
    })
}

/// atan(1/n) = Σ (-1)^k / ((2k+1) n^(2k+1)). Each truncation error is below one unit, the remainder below the first omitted term.
fn arctangent(n: u32, bits: usize) -> Interval {
    let mut power = (IBig::ONE << bits) / IBig::from(n);
    let (mut sum, mut k) = (IBig::ZERO, 0u32);
    while !power.is_zero() {
        let term = &power / IBig::from(2 * k + 1);
        sum = if k.is_multiple_of(2) { sum + term } else { sum - term };
        power /= IBig::from(n * n);
        k += 1;
    }
    // A term inherits an error below two units from its power and adds less than one.
    let slack = IBig::from(3 * k + 3);
    Interval { low: &sum - &slack, high: sum + slack }
}

/// atan(t) = 8 atan(t_3) for t in [0, 1), where t_(k+1) = t_k/(1 + sqrt(1 + t_k²)) is the tangent of half the angle. The series
/// Σ (-1)^k t^(2k+1)/(2k+1) gives atan(t_3), t_3 < 1/10, at the lower end, widened by the width of t_3 (the slope is at most 1).
fn arctangent_of(tangent: Interval, bits: usize) -> Option<Interval> {
    let one = IBig::ONE << bits;
    let mut t = tangent;
    for _ in 0..3 {
        let square = multiply(&t, &t, bits);
        let root = |n: &IBig| IBig::from(((n + &one).unsigned_abs() << bits).sqrt());
        let below = Interval { low: &one + root(&square.low), high: &one + root(&square.high) + IBig::ONE };
        t = multiply(&t, &invert(&below, bits)?, bits);
    }
    let square: IBig = (&t.low * &t.low) >> bits;
    let mut power = t.low.clone();
    let (mut sum, mut k) = (IBig::ZERO, 0u32);
    while !power.is_zero() {
        let term = &power / IBig::from(2 * k + 1);
        sum = if k.is_multiple_of(2) { sum + term } else { sum - term };
        power = (power * &square) >> bits;
        k += 1;
    }
    // A term inherits an error below two units from its power and adds less than one.
    let slack = IBig::from(3 * k + 3) + (&t.high - &t.low);
    let eight = IBig::from(8);
    Some(Interval { low: (&sum - &slack) * &eight, high: (sum + slack) * eight })
}

/// Larger angles are reduced by whole turns first.
const LARGE_ANGLE: u32 = 256;

/// Maximum number of integer bits of an angle with a sine.
const LONGEST_ANGLE: usize = 4096;

/// An angle minus the largest number of whole turns below its lower end.
fn less_turns(angle: &Interval, bits: usize) -> Option<Interval> {
    let extra = (angle.low.clone() >> bits).bit_len() + 8;
    if extra > LONGEST_ANGLE {
        return None;
    }
    let half = pi(bits + extra)?;
    let turn = Interval { low: half.low * IBig::from(2), high: half.high * IBig::from(2) };
    let turns = floor_div(&(angle.low.clone() << extra), &turn.low);
    let (least, most) = if turns.is_negative() { (&turn.low, &turn.high) } else { (&turn.high, &turn.low) };
    Some(Interval {
        low: floor_shift((angle.low.clone() << extra) - &turns * least, extra),
        high: ceil_shift((angle.high.clone() << extra) - &turns * most, extra),
    })
}

/// sin (first = 1) or cos (first = 0) of an angle: the series at its lower end, widened by its width (slopes are at most 1).
fn series(angle: &Interval, first: u32, bits: usize) -> Option<Interval> {
    let size = angle.low.clone().abs() >> bits;
    if size >= IBig::from(LARGE_ANGLE) {
        return series(&less_turns(angle, bits)?, first, bits);
    }
    // Terms first grow up to e^x < 2^(1.5 x), and the propagated errors with them.
    let guard = 24 + 3 * (usize::try_from(size).unwrap_or(256) + 1);
    let work = bits + guard;
    let x = angle.low.clone() << guard;
    let square: IBig = (&x * &x) >> work;
    let mut term = if first == 1 { x } else { IBig::ONE << work };
    let (mut sum, mut k, mut steps) = (IBig::ZERO, first, 0u32);
    while !term.is_zero() && term != IBig::NEG_ONE {
        sum += &term;
        term = -((term * &square) >> work) / IBig::from((k + 1) * (k + 2));
        k += 2;
        steps += 1;
    }
    let width = &angle.high - &angle.low + IBig::from(2);
    debug_assert!(steps < 1 << 16);
    let value = sum >> guard;
    Some(Interval { low: &value - &width, high: value + width })
}

/// A float format, with its rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Float {
    /// 64 bits.
    F64,
    /// 32 bits.
    F32,
}

impl Float {
    /// The unit roundoff 2^-53 or 2^-24.
    pub fn unit(self) -> f64 {
        match self {
            Float::F64 => f64::EPSILON / 2.0,
            Float::F32 => f64::from(f32::EPSILON) / 2.0,
        }
    }

    /// The largest finite number.
    pub fn largest(self) -> f64 {
        match self {
            Float::F64 => f64::MAX,
            Float::F32 => f64::from(f32::MAX),
        }
    }

    /// The smallest normal number; below it the spacing is constant.
    pub fn smallest_normal(self) -> f64 {
        match self {
            Float::F64 => f64::MIN_POSITIVE,
            Float::F32 => f64::from(f32::MIN_POSITIVE),
        }
    }

    /// The smallest positive number: the spacing below [`Float::smallest_normal`].
    pub fn smallest(self) -> f64 {
        match self {
            Float::F64 => f64::from_bits(1),
            Float::F32 => f64::from(f32::from_bits(1)),
        }
    }

    /// Its name in Rust.
    pub fn name(self) -> &'static str {
        match self {
            Float::F64 => "f64",
            Float::F32 => "f32",
        }
    }

    /// The value of a literal in this format; exact as f64.
    pub fn read(self, text: &str) -> Option<f64> {
        match self {
            Float::F64 => text.parse::<f64>().ok(),
            Float::F32 => text.parse::<f32>().ok().map(f64::from),
        }
    }

    /// Neighbours of a finite float.
    fn neighbours(self, value: f64) -> (f64, f64) {
        match self {
            Float::F64 => (value.next_down(), value.next_up()),
            Float::F32 => {
                let value = value as f32;
                (f64::from(value.next_down()), f64::from(value.next_up()))
            }
        }
    }

    fn is_even(self, value: f64) -> bool {
        match self {
            Float::F64 => value.to_bits() & 1 == 0,
            Float::F32 => (value as f32).to_bits() & 1 == 0,
        }
    }

    /// The nearest number of this format.
    pub fn rounded(self, value: f64) -> f64 {
        match self {
            Float::F64 => value,
            Float::F32 => f64::from(value as f32),
        }
    }

    /// The outermost numbers of this format between two others. Without such numbers, the neighbours of both, so that the interval is never empty.
    /// Numbers beyond the largest number count as that number.
    pub fn between(self, low: f64, high: f64) -> (f64, f64) {
        let most = self.largest();
        let (low, high) = (low.clamp(-most, most), high.clamp(-most, most));
        let (first, last) = (self.rounded(low), self.rounded(high));
        let above = if first < low { self.neighbours(first).1 } else { first };
        let below = if last > high { self.neighbours(last).0 } else { last };
        (above.min(below), above.max(below))
    }

    fn round(self, value: &Rational) -> f64 {
        match self {
            Float::F64 => value.to_f64().value(),
            Float::F32 => f64::from(value.to_f32().value()),
        }
    }

    /// The float nearest to a constant.
    pub fn nearest(self, formula: &Formula) -> Option<f64> {
        if let Some(value) = formula.as_rational() {
            return Some(self.round(value)).filter(|v| v.is_finite());
        }
        PRECISIONS.iter().find_map(|&bits| {
            let (low, high) = enclose(formula, bits)?;
            let (low, high) = (self.round(&low), self.round(&high));
            (low == high && low.is_finite()).then_some(low)
        })
    }

    /// Whether `value` is the float nearest to the constant (ties to even), by comparison with the midpoints to its neighbours.
    pub fn is_nearest(self, value: f64, formula: &Formula) -> bool {
        self.decides(value, formula, usize::MAX).unwrap_or(false)
    }

    /// The same with enclosures of at most this many bits; `None` if they do not decide.
    pub fn decides(self, value: f64, formula: &Formula, bits: usize) -> Option<bool> {
        if !value.is_finite() {
            return Some(false);
        }
        let exact = |x: f64| Rational::try_from(x).ok();
        let own = exact(value)?;
        let (below, above) = self.neighbours(value);
        // Beyond the largest float, the midpoint uses the next float of an unlimited range.
        let midpoint = |neighbour: f64, other: f64| match exact(neighbour) {
            Some(neighbour) => Some((&own + neighbour) / Rational::from(2)),
            None => Some((&own * Rational::from(3) - exact(other)?) / Rational::from(2)),
        };
        let (low, high) = (midpoint(below, above)?, midpoint(above, below)?);
        let inside = |x: &Rational| match (x.cmp(&low), x.cmp(&high)) {
            (Ordering::Greater, Ordering::Less) => Some(true),
            (Ordering::Equal, _) | (_, Ordering::Equal) => None,
            _ => Some(false),
        };
        if let Some(x) = formula.as_rational() {
            return Some(inside(x).unwrap_or(self.is_even(value)));
        }
        for precision in PRECISIONS.into_iter().take_while(|precision| *precision <= bits) {
            let (x, y) = enclose(formula, precision)?;
            match (inside(&x), inside(&y)) {
                (Some(true), Some(true)) => return Some(true),
                (Some(false), Some(false)) if (x < low) == (y < low) => return Some(false),
                _ => {}
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Formula {
        Formula::parse(text).expect("a formula")
    }

    #[test]
    fn the_nearest_float_and_no_other() {
        let cases = [
            ("pi", std::f64::consts::PI),
            ("sqrt(2)", std::f64::consts::SQRT_2),
            ("1/10", 0.1),
            ("sin(1)", 0.841_470_984_807_896_5),
            ("cos(1)", 0.540_302_305_868_139_8),
            ("-sqrt(3)/2", -0.866_025_403_784_438_6),
            ("sqrt(2 + sqrt(3))", 1.931_851_652_578_136_6),
            ("9007199254740993", 9_007_199_254_740_992.0),
            ("pi^(-1)", std::f64::consts::FRAC_1_PI),
            ("0", 0.0),
        ];
        for (text, value) in cases {
            let formula = parse(text);
            assert_eq!(Float::F64.nearest(&formula), Some(value), "{text}");
            assert!(Float::F64.is_nearest(value, &formula), "{text}");
            assert!(!Float::F64.is_nearest(value.next_up(), &formula), "{text}");
            assert!(!Float::F64.is_nearest(value.next_down(), &formula), "{text}");
            let single = value as f32;
            assert!(Float::F32.is_nearest(f64::from(single), &formula), "{text}");
            assert!(!Float::F32.is_nearest(f64::from(single.next_up()), &formula), "{text}");
        }
    }

    #[test]
    fn between_two_numbers_there_is_always_one() {
        for real in [Float::F64, Float::F32] {
            for (low, high) in [
                (0.1, 0.1),
                (0.1, 0.100_000_000_1),
                (-0.3, 0.7),
                (5e12, 5e12 + 0.25),
                (0.0, 1e-50),
                (-1e300, 1e300),
                (1e39, 1e40),
            ] {
                let (first, last) = real.between(low, high);
                assert!(first <= last && first.is_finite() && last.is_finite(), "{low} {high}: {first} {last}");
                assert_eq!((real.rounded(first), real.rounded(last)), (first, last));
            }
        }
        assert_eq!(Float::F64.between(0.1, 0.7), (0.1, 0.7));
        assert_eq!(Float::F32.between(0.1, 0.7), (f64::from(0.1f32), f64::from(0.7f32)));
    }

    /// A name has another meaning in each list of definitions; an angle by its name must not take the value of another list.
    #[test]
    fn values_are_kept_by_meaning() {
        let texts = ["7/10", "-pi/5 + 3/10"];
        for _ in 0..2 {
            for text in texts {
                let mut definitions = definitions::Definitions::default();
                definitions.define(0, text, bits_before_the_point).expect("a definition");
                for function in ["sin", "cos"] {
                    let by_name = Formula::parse_with(&format!("{function}(k0)"), &definitions).expect("a formula");
                    let plain = parse(&format!("{function}({text})"));
                    for bits in [128, 256] {
                        assert_eq!(enclose(&by_name, bits), enclose(&plain, bits), "{function}({text})");
                    }
                }
            }
        }
        let width = |bits: usize| {
            let (low, high) = enclose(&parse("cos(7/10)*pi + atan(1/3)"), bits).expect("a number");
            high - low
        };
        assert!(width(256) < width(128), "more bits are not those of an earlier enclosure");
    }

    #[test]
    fn large_angles_and_impossible_numbers() {
        assert_eq!(Float::F64.nearest(&parse("sin(200)")), Some(200f64.sin()));
        for (angle, value) in [("1000", 1e3), ("-1000", -1e3), ("1e6", 1e6), ("-1e22", -1e22), ("2^400", 2f64.powi(400))] {
            assert_eq!(Float::F64.nearest(&parse(&format!("sin({angle})"))), Some(value.sin()), "{angle}");
            assert_eq!(Float::F64.nearest(&parse(&format!("cos({angle})"))), Some(value.cos()), "{angle}");
        }
        assert_eq!(Float::F64.nearest(&parse("sqrt(1 - sqrt(2))")), None);
        assert_eq!(Float::F64.nearest(&parse("1/(sqrt(2) - sqrt(2))")), None);
        assert!(!Float::F64.is_nearest(f64::INFINITY, &parse("1e400")));
        assert!(!Float::F64.is_nearest(f64::MAX, &parse("1e309")));
    }
}
