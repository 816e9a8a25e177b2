//! Enclosures: two fractions between which a [`Number`] lies, as close together as one asks.
//!
//! Every atom is enclosed by dyadic fractions; sums and products of enclosures are exact, so the result is an enclosure too.
//! Roots by integer square root, pi by Machin's formula pi/4 = 4 atan(1/5) - atan(1/239), sine and cosine by their series
//! (arguments are at most pi/4 here, but nothing depends on it): an alternating series of falling terms lies between two
//! partial sums. The arc tangent by Euler's series, whose terms are positive and fall by more than a half each below 1.

use dashu_base::{Abs, Signed, SquareRoot};
use dashu_int::{IBig, UBig};

use super::{Atom, Number, Rational};

/// Numbers of bits to try in turn; the last is beyond what any written number needs to be told apart.
pub(super) const PRECISIONS: [usize; 5] = [96, 160, 320, 1280, 5120];

type Interval = (Rational, Rational);

impl Number {
    /// Two fractions around the number; they are about 2^-bits apart for numbers of moderate size.
    pub fn enclose(&self, bits: usize) -> (Rational, Rational) {
        let mut sum = (Rational::ZERO, Rational::ZERO);
        for (monomial, coefficient) in self.terms() {
            let mut product = (coefficient.clone(), coefficient.clone());
            for (atom, power) in monomial {
                let enclosed = enclose_atom(atom, bits + 32);
                for _ in 0..power.unsigned_abs() {
                    product = multiply(&product, &if *power < 0 { inverse(&enclosed) } else { enclosed.clone() });
                }
            }
            sum = (sum.0 + product.0, sum.1 + product.1);
        }
        (round_out(&sum.0, bits + 32, false), round_out(&sum.1, bits + 32, true))
    }
}

fn multiply(a: &Interval, b: &Interval) -> Interval {
    let products = [&a.0 * &b.0, &a.0 * &b.1, &a.1 * &b.0, &a.1 * &b.1];
    let low = products.iter().min().expect("four products").clone();
    let high = products.iter().max().expect("four products").clone();
    (low, high)
}

fn inverse(a: &Interval) -> Interval {
    debug_assert!(a.0.is_positive() == a.1.is_positive() && !a.0.is_zero() && !a.1.is_zero());
    (Rational::ONE / &a.1, Rational::ONE / &a.0)
}

/// The dyadic fraction with `bits` bits after the point next below or above.
fn round_out(value: &Rational, bits: usize, up: bool) -> Rational {
    let scaled = value * Rational::from(UBig::ONE << bits);
    let rounded = if up { scaled.ceil() } else { scaled.floor() };
    Rational::from_parts(rounded, UBig::ONE << bits)
}

fn enclose_atom(atom: &Atom, bits: usize) -> Interval {
    match atom {
        Atom::Root(n) => root(&Rational::from(n.clone()), &Rational::from(n.clone()), bits),
        Atom::RootOf(n) => {
            let (low, high) = n.enclose(2 * bits);
            root(&low, &high, bits)
        }
        Atom::Pi => pi(bits),
        Atom::Sine(angle) => {
            let (low, high) = angle.enclose(bits);
            widen(series(&low, bits, 1), &(high - low))
        }
        Atom::Cosine(angle) => {
            let (low, high) = angle.enclose(bits);
            widen(series(&low, bits, 0), &(high - low))
        }
        Atom::Inverse(n) => {
            let mut more = bits;
            loop {
                let (low, high) = n.enclose(more);
                if low.is_positive() == high.is_positive() && !low.is_zero() && !high.is_zero() {
                    return inverse(&(low, high));
                }
                more *= 2;
            }
        }
        Atom::Arctangent(ratio) => arctangent(ratio, bits),
    }
}

fn widen(interval: Interval, by: &Rational) -> Interval {
    (interval.0 - by, interval.1 + by)
}

fn root(low: &Rational, high: &Rational, bits: usize) -> Interval {
    let scale = UBig::ONE << (2 * bits);
    let floor = |r: &Rational| -> IBig {
        let scaled = (r * Rational::from(scale.clone())).floor();
        IBig::from(UBig::try_from(scaled).unwrap_or(UBig::ZERO).sqrt())
    };
    let dyadic = |n: IBig| Rational::from_parts(n, UBig::ONE << bits);
    (dyadic(floor(low)), dyadic(floor(high) + IBig::ONE))
}

fn pi(bits: usize) -> Interval {
    let (five, other) = (arctangent_of_inverse(5, bits + 8), arctangent_of_inverse(239, bits + 8));
    let (four, sixteen) = (Rational::from(4), Rational::from(16));
    (&sixteen * five.0 - &four * other.1, sixteen * five.1 - four * other.0)
}

/// atan(1/n) = Σ (-1)^k / ((2k+1) n^(2k+1)) in integers scaled by 2^bits; each truncated term is off by less than one unit.
fn arctangent_of_inverse(n: u32, bits: usize) -> Interval {
    let mut power = (IBig::ONE << bits) / IBig::from(n);
    let (mut sum, mut k) = (IBig::ZERO, 0u32);
    while !power.is_zero() {
        let term = &power / IBig::from(2 * k + 1);
        sum = if k % 2 == 0 { sum + term } else { sum - term };
        power /= IBig::from(n * n);
        k += 1;
    }
    let slack = IBig::from(2 * k + 4);
    let dyadic = |x: IBig| Rational::from_parts(x, UBig::ONE << bits);
    (dyadic(&sum - &slack), dyadic(sum + slack))
}

/// atan(t) = Σ a_k for t in (0, 1), with a_0 = t/(1 + t²) and a_(k+1) = a_k z 2(k+1)/(2k+3), z = t²/(1 + t²) < 1/2 (Euler), in integers
/// scaled by 2^bits. What is left after a term is below that term; each term is low by less than five units.
fn arctangent(ratio: &Rational, bits: usize) -> Interval {
    let bits = bits + 16;
    let scaled = |x: Rational| (x * Rational::from(UBig::ONE << bits)).floor();
    let scale = Rational::ONE / (Rational::ONE + ratio * ratio);
    let z = scaled(ratio * ratio * &scale);
    let mut term = scaled(ratio * scale);
    let (mut sum, mut k) = (IBig::ZERO, 0u32);
    while !term.is_zero() {
        sum += &term;
        term = ((term * &z) >> bits) * IBig::from(2 * (k + 1)) / IBig::from(2 * k + 3);
        k += 1;
    }
    let slack = IBig::from(8 * k + 16);
    let dyadic = |x: IBig| Rational::from_parts(x, UBig::ONE << bits);
    (dyadic(&sum - &slack), dyadic(sum + slack))
}

/// Σ (-1)^k x^(2k+first) / (2k+first)! in integers scaled by 2^bits.
fn series(x: &Rational, bits: usize, first: u32) -> Interval {
    // Guard bits for the intermediate terms of arguments above 1, which first grow.
    let guard = 16 + 2 * usize::try_from(x.clone().abs().ceil()).unwrap_or(1 << 16);
    let bits = bits + guard;
    let x = (x * Rational::from(UBig::ONE << bits)).floor();
    let square: IBig = (&x * &x) >> bits;
    let mut term = if first == 1 { x } else { IBig::ONE << bits };
    let (mut sum, mut k) = (IBig::ZERO, first);
    let mut steps = 0u32;
    while !term.is_zero() && term != IBig::NEG_ONE {
        sum += &term;
        term = -((term * &square) >> bits) / IBig::from((k + 1) * (k + 2));
        k += 2;
        steps += 1;
    }
    let slack = IBig::from(4 * steps + 8) << (guard / 2);
    let dyadic = |x: IBig| Rational::from_parts(x, UBig::ONE << bits);
    (dyadic(&sum - &slack), dyadic(sum + slack))
}
