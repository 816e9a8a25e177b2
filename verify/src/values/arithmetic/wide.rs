//! Floating point with 256 bits: no exact arithmetic, but far finer than any float, for values to measure rounding errors by.
//!
//! A value is ±m 2^e with m in [2^255, 2^256); sums, products and quotients are cut off, with relative errors below 2^-253.

use dashu_base::{BitTest, Signed, UnsignedAbs};
use dashu_int::{IBig, UBig};

use crate::values::element::Element;
use crate::values::enclosure::{enclose, sine_cosine_of};
use crate::values::float::Arguments;
use crate::values::formula::{Formula, Rational};
use crate::values::program::{by_addition, Argument, Inputs, Program, Scaled, Turn};

/// A number with 256 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wide {
    negative: bool,
    exponent: i64,
    /// Lowest word first; 0 for the number 0, else with the highest bit set.
    words: [u64; 4],
}

const ZERO: Wide = Wide { negative: false, exponent: 0, words: [0; 4] };

/// Shifts right by less than 256 bits.
fn shifted(words: [u64; 4], by: u32) -> [u64; 4] {
    let (skip, bits) = ((by / 64) as usize, by % 64);
    let word = |i: usize| words.get(i).copied().unwrap_or(0);
    std::array::from_fn(|i| {
        let low = word(i + skip) >> bits;
        if bits == 0 {
            low
        } else {
            low | (word(i + skip + 1) << (64 - bits))
        }
    })
}

fn compare(a: &[u64; 4], b: &[u64; 4]) -> std::cmp::Ordering {
    a.iter().rev().cmp(b.iter().rev())
}

impl Wide {
    /// Normalises ±(words) 2^exponent.
    fn new(negative: bool, mut exponent: i64, mut words: [u64; 4]) -> Wide {
        let Some(top) = words.iter().rposition(|&w| w != 0) else { return ZERO };
        let lift = (3 - top) * 64 + words[top].leading_zeros() as usize;
        if lift > 0 {
            let (skip, bits) = (lift / 64, lift % 64);
            let old = words;
            let word = |i: usize, back: usize| if i >= back { old[i - back] } else { 0 };
            for i in (0..4).rev() {
                let high = word(i, skip) << bits;
                words[i] = if bits == 0 { high } else { high | (word(i, skip + 1) >> (64 - bits)) };
            }
            exponent -= lift as i64;
        }
        Wide { negative, exponent, words }
    }

    /// The fraction that it is.
    fn exact(&self) -> Rational {
        let size = self.words.iter().rev().fold(IBig::ZERO, |sum, &word| (sum << 64) + IBig::from(word));
        let size = if self.negative { -size } else { size };
        let power = UBig::ONE << self.exponent.unsigned_abs() as usize;
        if self.exponent < 0 {
            Rational::from_parts(size, power)
        } else {
            Rational::from(size * IBig::from(power))
        }
    }

    /// An integer times a power of two, cut off after 256 bits.
    fn from_integer(value: &IBig, exponent: i64) -> Wide {
        let size = value.clone().unsigned_abs();
        let excess = size.bit_len().saturating_sub(256);
        let size: UBig = size >> excess;
        let mut words = [0; 4];
        // A word of the integer has 32 bits on some machines.
        for (word, bytes) in words.iter_mut().zip(size.to_le_bytes().chunks(8)) {
            let mut whole = [0; 8];
            whole[..bytes.len()].copy_from_slice(bytes);
            *word = u64::from_le_bytes(whole);
        }
        Wide::new(value.is_negative(), exponent + excess as i64, words)
    }

    /// A float, exactly.
    pub fn from_f64(value: f64) -> Wide {
        let bits = value.to_bits();
        let (field, fraction) = ((bits >> 52) & 0x7ff, bits & ((1 << 52) - 1));
        debug_assert!(field != 0x7ff, "a finite float");
        let (size, exponent) = if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field as i64 - 1075) };
        Wide::new(value.is_sign_negative(), exponent, [size, 0, 0, 0])
    }

    /// An exact constant, cut off.
    pub fn from_formula(formula: &Formula) -> Option<Wide> {
        let of = |value: &Rational| {
            let numerator = Wide::from_integer(value.numerator(), 0);
            numerator.over(&Wide::from_integer(&IBig::from(value.denominator().clone()), 0))
        };
        match formula.as_rational() {
            Some(value) => of(value),
            None => of(&enclose(formula, 320)?.0),
        }
    }

    /// The nearest float but for the last bit.
    pub fn to_f64(self) -> f64 {
        let size = self.words[3] as f64 + self.words[2] as f64 * 2f64.powi(-64);
        let exponent = (self.exponent + 192).clamp(-2000, 2000) as i32;
        // In two steps, so that the power of two does not leave the range before the value does.
        let scaled = size * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
        if self.negative {
            -scaled
        } else {
            scaled
        }
    }

    fn add_sizes(larger: Wide, smaller: Wide) -> Wide {
        let distance = larger.exponent - smaller.exponent;
        if distance >= 256 || smaller == ZERO {
            return larger;
        }
        let other = shifted(smaller.words, distance as u32);
        let mut words = [0; 4];
        if larger.negative == smaller.negative {
            let mut carry = 0u64;
            for i in 0..4 {
                let sum = u128::from(larger.words[i]) + u128::from(other[i]) + u128::from(carry);
                (words[i], carry) = (sum as u64, (sum >> 64) as u64);
            }
            if carry == 1 {
                let mut halved = shifted(words, 1);
                halved[3] |= 1 << 63;
                return Wide { negative: larger.negative, exponent: larger.exponent + 1, words: halved };
            }
        } else {
            let mut borrow = 0i128;
            for i in 0..4 {
                let difference = i128::from(larger.words[i]) - i128::from(other[i]) - borrow;
                (words[i], borrow) = (difference as u64, i128::from(difference < 0));
            }
        }
        Wide::new(larger.negative, larger.exponent, words)
    }
}

impl Element for Wide {
    fn plus(&self, other: &Self) -> Self {
        if *self == ZERO {
            return *other;
        }
        let larger = self.exponent.cmp(&other.exponent).then(compare(&self.words, &other.words)).is_ge();
        if larger || *other == ZERO {
            Wide::add_sizes(*self, *other)
        } else {
            Wide::add_sizes(*other, *self)
        }
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }

    fn times(&self, other: &Self) -> Self {
        if *self == ZERO || *other == ZERO {
            return ZERO;
        }
        let mut product = [0u64; 8];
        for i in 0..4 {
            let mut carry = 0u64;
            for j in 0..4 {
                let sum = u128::from(self.words[i]) * u128::from(other.words[j]) + u128::from(product[i + j]) + u128::from(carry);
                (product[i + j], carry) = (sum as u64, (sum >> 64) as u64);
            }
            product[i + 4] = carry;
        }
        let negative = self.negative != other.negative;
        let exponent = self.exponent + other.exponent + 256;
        let high = [product[4], product[5], product[6], product[7]];
        if high[3] >> 63 == 1 {
            return Wide { negative, exponent, words: high };
        }
        let words = std::array::from_fn(|i| (high[i] << 1) | (product[i + 3] >> 63));
        Wide { negative, exponent: exponent - 1, words }
    }

    fn negated(&self) -> Self {
        Wide { negative: !self.negative && *self != ZERO, ..*self }
    }

    /// Newton's iteration y (2 - x y) doubles the correct bits.
    fn inverse(&self) -> Option<Self> {
        if *self == ZERO {
            return None;
        }
        // The size brought near 1: 0.5 to 1.
        let near = Wide { negative: false, exponent: -256, words: self.words };
        let two = Wide::from_f64(2.0);
        let mut inverse = Wide::from_f64(1.0 / near.to_f64());
        for _ in 0..3 {
            inverse = inverse.times(&two.minus(&near.times(&inverse)));
        }
        Some(Wide { negative: self.negative, exponent: inverse.exponent - (self.exponent + 256), words: inverse.words })
    }

    fn sign(&self) -> Self {
        match (*self == ZERO, self.negative) {
            (true, _) => ZERO,
            (false, true) => Wide::from_f64(-1.0),
            (false, false) => Wide::from_f64(1.0),
        }
    }

    fn is_zero(&self) -> bool {
        *self == ZERO
    }
}

/// Sine and cosine of a float.
fn circle(angle: f64) -> Option<(Wide, Wide)> {
    circle_of(&Rational::try_from(angle).ok()?, angle)
}

/// Sine and cosine of a wide number.
pub(crate) fn wide_circle(angle: &Wide) -> Option<(Wide, Wide)> {
    circle_of(&angle.exact(), angle.to_f64())
}

/// Sine and cosine of an angle of about this size.
fn circle_of(exact: &Rational, angle: f64) -> Option<(Wide, Wide)> {
    if exact.is_zero() {
        return Some((ZERO, Wide::from_f64(1.0)));
    }
    // The sine of a small angle as finely as others, relative to its size.
    let fine = 320 + (-angle.abs().log2()).clamp(0.0, 1100.0) as usize;
    let (sine, cosine, bits) = sine_cosine_of(exact, fine)?;
    let of = |n: &IBig| Wide::from_integer(n, -(bits as i64));
    Some((of(&sine), of(&cosine)))
}

/// exp(-x), x at least 0: the series for a small part of x, squared as often as x was halved. A relative error of 2^-253 for x up to 1, times x
/// beyond.
fn falling(x: Wide) -> Wide {
    let halvings = (x.to_f64().log2().ceil().max(0.0) as u32).min(2000) + 8;
    let part = Wide { exponent: if x == ZERO { 0 } else { x.exponent - i64::from(halvings) }, ..x }.negated();
    let one = Wide::from_f64(1.0);
    let (mut term, mut sum) = (one, one);
    for k in 1..34 {
        let ratio = part.over(&Wide::from_f64(f64::from(k))).unwrap_or(ZERO);
        term = term.times(&ratio);
        sum = sum.plus(&term);
    }
    (0..halvings).fold(sum, |power, _| power.times(&power))
}

/// exp(-|rate| / velocity), the velocity above 0.
pub fn stribeck(rate: f64, velocity: &Wide) -> Wide {
    Wide::from_f64(rate.abs()).over(velocity).map_or(ZERO, falling)
}

impl Program {
    /// The literals as the floats that they are, with the circles of those that are constants of angles.
    pub fn literals_as_floats(&self) -> Option<Vec<Wide>> {
        let mut all: Vec<Wide> = self.literals.iter().map(|literal| Wide::from_f64(literal.value)).collect();
        for &turn in &self.turns {
            let (sine, cosine) = circle(self.literals[turn].value)?;
            all.extend([sine, cosine]);
        }
        Some(all)
    }
}

/// Arguments with the sines and cosines of the joint variables.
#[derive(Clone, Debug)]
pub struct WideArguments {
    arguments: Arguments<f64>,
    angles: Vec<(Wide, Wide)>,
}

impl WideArguments {
    /// At the floats given, exactly.
    pub fn new(arguments: &Arguments<f64>) -> Option<WideArguments> {
        let angles: Option<Vec<(Wide, Wide)>> = arguments.q.iter().map(|&q| circle(q)).collect();
        Some(WideArguments { arguments: arguments.clone(), angles: angles? })
    }
}

impl Inputs<Wide> for WideArguments {
    fn entry(&self, argument: Argument, index: usize) -> Wide {
        Wide::from_f64(self.arguments.of(argument)[index])
    }

    fn sine_cosine(&self, angle: &[(usize, i64)]) -> (Wide, Wide) {
        let mut sum: Option<(Wide, Wide)> = None;
        for &(joint, factor) in angle {
            let (s, c) = self.angles[joint];
            let s = if factor < 0 { s.negated() } else { s };
            for _ in 0..factor.unsigned_abs() {
                sum = Some(match sum {
                    None => (s, c),
                    Some((sine, cosine)) => (sine.times(&c).plus(&cosine.times(&s)), cosine.times(&c).minus(&sine.times(&s))),
                });
            }
        }
        sum.unwrap_or((ZERO, Wide::from_f64(1.0)))
    }

    fn turned(&self, angle: &[(usize, i64)], turn: &Turn<'_, Wide>) -> (Wide, Wide) {
        by_addition(self.sine_cosine(angle), turn)
    }

    fn scaled(&self, terms: &[Scaled<Wide>], constant: Option<Wide>) -> (Wide, Wide) {
        let term = |(joint, sign, factor): &Scaled<Wide>| {
            let q = Wide::from_f64(self.arguments.q[*joint]);
            let size = factor.map_or(q, |factor| factor.times(&q));
            if *sign < 0 {
                size.negated()
            } else {
                size
            }
        };
        let sum = terms.iter().map(term).chain(constant).fold(ZERO, |sum, term| sum.plus(&term));
        // A float that is no number has no sine.
        wide_circle(&sum).unwrap_or((ZERO, ZERO))
    }

    fn sign(&self, joint: usize) -> Wide {
        let rate = self.arguments.dq[joint];
        if rate == 0.0 {
            ZERO
        } else {
            Wide::from_f64(rate.signum())
        }
    }

    fn stribeck(&self, joint: usize, velocity: &Wide) -> Wide {
        stribeck(self.arguments.dq[joint], velocity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::stream::Stream;

    fn exact(value: Wide) -> Rational {
        let bytes: Vec<u8> = value.words.iter().flat_map(|w| w.to_le_bytes()).collect();
        let size = Rational::from(UBig::from_le_bytes(&bytes));
        let power = Rational::from(UBig::ONE << value.exponent.unsigned_abs() as usize);
        let size = if value.exponent < 0 { size / power } else { size * power };
        if value.negative {
            -size
        } else {
            size
        }
    }

    #[test]
    fn operations_are_as_fine_as_stated() {
        let mut stream = Stream::new(3);
        let bound = Rational::ONE / Rational::from(UBig::ONE << 253);
        let close = |value: Wide, right: Rational, scale: &Rational| {
            let error = exact(value) - &right;
            let limit = &bound * scale;
            assert!(error.clone() <= limit && -error <= limit, "{value:?}");
        };
        let size = |r: &Rational| if r.is_negative() { -r.clone() } else { r.clone() };
        for _ in 0..2000 {
            let mut draw = || {
                let words: [u64; 4] = std::array::from_fn(|_| stream.bits());
                Wide::new(stream.below(2) == 0, -256 + stream.below(40) as i64 - 20, words)
            };
            let (x, y) = (draw(), draw());
            let (a, b) = (exact(x), exact(y));
            let sum = size(&a) + size(&b);
            close(x.plus(&y), &a + &b, &sum);
            close(x.minus(&y), &a - &b, &sum);
            close(x.times(&y), &a * &b, &size(&(&a * &b)));
            close(x.over(&y).unwrap(), &a / &b, &(size(&(&a / &b)) * Rational::from(4)));
            assert!((x.to_f64() - a.to_f64().value()).abs() <= 2f64.powi(-50) * x.to_f64().abs());
        }
        assert_eq!(ZERO.plus(&ZERO), ZERO);
        assert_eq!(Wide::from_f64(0.75).minus(&Wide::from_f64(0.75)), ZERO);
        assert_eq!(Wide::from_f64(-3.5).to_f64(), -3.5);
        assert_eq!(Wide::from_f64(5e-324).to_f64(), 5e-324);
        let pi = Wide::from_formula(&Formula::Pi).unwrap();
        assert_eq!(pi.to_f64(), std::f64::consts::PI);
    }

    #[test]
    fn exponentials_are_as_fine_as_stated() {
        use crate::values::float::{stribeck_f32, stribeck_f64};
        let mut stream = Stream::new(5);
        let mut worst = [0.0f64; 2];
        for k in 0..4000 {
            let x = stream.below(1 << 40) as f64 / (1u64 << 40) as f64 * [0.5, 3.0, 40.0][k % 3];
            let rate = if k % 2 == 0 { x } else { -x };
            let exact = stribeck(rate, &Wide::from_f64(1.0));
            // exp(-x/2) squared is exp(-x), and 256 bits are no worse than a float.
            let half = stribeck(0.5 * x, &Wide::from_f64(1.0));
            assert!((half.times(&half).minus(&exact).to_f64() / exact.to_f64()).abs() < 2f64.powi(-240), "{x}");
            assert!((exact.to_f64() - (-x).exp()).abs() < 1e-15, "{x}");
            let single = rate as f32;
            let of_single = stribeck(f64::from(single), &Wide::from_f64(1.0));
            let off =
                |found: f64, exact: Wide, unit: f64| (Wide::from_f64(found).minus(&exact).to_f64() / exact.to_f64()).abs() / unit;
            worst[0] = worst[0].max(off(stribeck_f64::of(rate, 1.0), exact, f64::EPSILON / 2.0));
            worst[1] = worst[1].max(off(f64::from(stribeck_f32::of(single, 1.0)), of_single, f64::from(f32::EPSILON) / 2.0));
        }
        assert!(worst.iter().all(|&worst| worst > 0.5 && worst < 2.0), "{worst:?} units of roundoff");
        assert_eq!([0.0, 41.0, f64::INFINITY].map(|rate| stribeck_f64::of(rate, 1.0)), [1.0, 0.0, 0.0]);
        assert!(stribeck_f64::of(f64::NAN, 1.0).is_nan());
    }
}
