//! Enclosures: two fractions between which a [`Number`] lies, as close together as one asks.
//!
//! Everything is enclosed between multiples of 2^-places, rounded outwards. Roots by integer square root, pi by Machin's formula
//! pi/4 = 4 atan(1/5) - atan(1/239), sine and cosine by their series (arguments are at most pi/4): an
//! alternating series of falling terms lies between two partial sums. The arc tangent by Euler's series, whose terms are positive and fall by
//! more than a half each below 1. What comes out wide, a small fraction times a large root say, is done again with as many places more as
//! were lost.

use std::collections::BTreeMap;
use std::sync::Arc;

use dashu_base::{BitTest, DivEuclid, SquareRoot};
use dashu_int::{IBig, UBig};

use super::{Atom, Number, Rational};

/// Numbers of bits to try in turn; the last is beyond what any written number needs to be told apart.
pub(super) const PRECISIONS: [usize; 5] = [96, 160, 320, 1280, 5120];

/// Enclosures wider than 2^LOST multiples of 2^-places are done again with more of them.
const LOST: usize = 16;

/// Two multiples of 2^-places.
type Interval = (IBig, IBig);

impl Number {
    /// Two fractions around the number, less than 2^-bits apart.
    pub fn enclose(&self, bits: usize) -> (Rational, Rational) {
        let places = bits + 64;
        let (low, high) = Enclosures::new(places).number(self);
        let fraction = |n: IBig| Rational::from_parts(n, UBig::ONE << places);
        (fraction(low), fraction(high))
    }
}

/// What has been enclosed so far to so many places: the terms of a number share their atoms.
struct Enclosures {
    places: usize,
    roots: BTreeMap<UBig, Interval>,
    /// By what the atom is of, which outlives this.
    others: BTreeMap<(&'static str, *const Number), Interval>,
}

impl Enclosures {
    fn new(places: usize) -> Enclosures {
        Enclosures { places, roots: BTreeMap::new(), others: BTreeMap::new() }
    }

    /// Within about 2^LOST multiples of 2^-places: what sines and cosines are taken of is as short as it looks.
    fn number(&mut self, number: &Number) -> Interval {
        let mut guard = 0;
        loop {
            let (low, high) = self.to(self.places + guard, |all| all.sum(number));
            let width = (&high - &low).bit_len();
            if width <= guard + LOST {
                return (floor_shift(low, guard), ceil_shift(high, guard));
            }
            guard = width;
        }
    }

    fn sum(&mut self, number: &Number) -> Interval {
        let mut sum = (IBig::ZERO, IBig::ZERO);
        for (monomial, coefficient) in number.terms() {
            let scaled = coefficient.numerator() << self.places;
            let denominator = IBig::from(coefficient.denominator().clone());
            let mut product = (floor_quotient(&scaled, &denominator), ceil_quotient(&scaled, &denominator));
            for (atom, power) in monomial {
                let enclosed = if *power < 0 { self.inverse_atom(atom) } else { self.atom(atom) };
                for _ in 0..power.unsigned_abs() {
                    product = multiply(&product, &enclosed, self.places);
                }
            }
            sum = (sum.0 + product.0, sum.1 + product.1);
        }
        sum
    }

    fn atom(&mut self, atom: &Atom) -> Interval {
        let places = self.places;
        match atom {
            Atom::Root(n) => {
                let root = || {
                    let floor = IBig::from((n << (2 * places)).sqrt());
                    (floor.clone(), floor + IBig::ONE)
                };
                self.roots.entry(n.clone()).or_insert_with(root).clone()
            }
            Atom::RootOf(n) => self.once("root", n, |_| {
                let (low, high) = Enclosures::new(2 * places).number(n);
                let floor = |n: IBig| IBig::from(UBig::try_from(n).unwrap_or(UBig::ZERO).sqrt());
                (floor(low), floor(high) + IBig::ONE)
            }),
            Atom::Pi => match self.others.get(&("pi", std::ptr::null())) {
                Some(known) => known.clone(),
                None => {
                    let pi = pi(places);
                    self.others.insert(("pi", std::ptr::null()), pi.clone());
                    pi
                }
            },
            Atom::Arctangent(ratio) => arctangent(ratio, places),
            Atom::Sine(angle) => self.once("sine", angle, |all| {
                let (low, high) = all.number(angle);
                widen(series(&low, places, 1), &(high - low))
            }),
            Atom::Cosine(angle) => self.once("cosine", angle, |all| {
                let (low, high) = all.number(angle);
                widen(series(&low, places, 0), &(high - low))
            }),
            Atom::Inverse(n) => self.once("inverse", n, |all| inverse(places, |places| all.to(places, |all| all.number(n)))),
        }
    }

    /// One over an atom, which is not 0.
    fn inverse_atom(&mut self, atom: &Atom) -> Interval {
        let places = self.places;
        inverse(places, |places| self.to(places, |all| all.atom(atom)))
    }

    /// What is asked for, to so many places.
    fn to(&mut self, places: usize, enclose: impl FnOnce(&mut Enclosures) -> Interval) -> Interval {
        if places == self.places {
            enclose(self)
        } else {
            enclose(&mut Enclosures::new(places))
        }
    }

    fn once(&mut self, what: &'static str, of: &Arc<Number>, enclose: impl FnOnce(&mut Enclosures) -> Interval) -> Interval {
        let key = (what, Arc::as_ptr(of));
        if let Some(known) = self.others.get(&key) {
            return known.clone();
        }
        let enclosed = enclose(self);
        self.others.insert(key, enclosed.clone());
        enclosed
    }
}

/// ⌊a/b⌋, b > 0.
fn floor_quotient(a: &IBig, b: &IBig) -> IBig {
    a.div_euclid(b)
}

/// ⌈a/b⌉, b > 0.
fn ceil_quotient(a: &IBig, b: &IBig) -> IBig {
    -(-a).div_euclid(b)
}

fn floor_shift(n: IBig, bits: usize) -> IBig {
    n >> bits
}

fn ceil_shift(n: IBig, bits: usize) -> IBig {
    -(-n >> bits)
}

fn multiply(a: &Interval, b: &Interval, places: usize) -> Interval {
    let products = [&a.0 * &b.0, &a.0 * &b.1, &a.1 * &b.0, &a.1 * &b.1];
    let low = products.iter().min().expect("four products").clone();
    let high = products.into_iter().max().expect("four products");
    (floor_shift(low, places), ceil_shift(high, places))
}

/// One over what `enclosed` encloses to as many places as asked, until 0 is outside.
fn inverse(places: usize, mut enclosed: impl FnMut(usize) -> Interval) -> Interval {
    let mut more = places;
    loop {
        let (low, high) = enclosed(more);
        let one = IBig::ONE << (places + more);
        if low > IBig::ZERO {
            return (floor_quotient(&one, &high), ceil_quotient(&one, &low));
        }
        if high < IBig::ZERO {
            return (-ceil_quotient(&one, &-high), -floor_quotient(&one, &-low));
        }
        more *= 2;
    }
}

fn widen(interval: Interval, by: &IBig) -> Interval {
    (interval.0 - by, interval.1 + by)
}

fn pi(places: usize) -> Interval {
    let (five, other) = (arctangent_of_inverse(5, places), arctangent_of_inverse(239, places));
    let (four, sixteen) = (IBig::from(4), IBig::from(16));
    (&sixteen * five.0 - &four * other.1, sixteen * five.1 - four * other.0)
}

/// atan(1/n) = Σ (-1)^k / ((2k+1) n^(2k+1)); each truncated term is off by less than one unit.
fn arctangent_of_inverse(n: u32, places: usize) -> Interval {
    let mut power = (IBig::ONE << places) / IBig::from(n);
    let (mut sum, mut k) = (IBig::ZERO, 0u32);
    while !power.is_zero() {
        let term = &power / IBig::from(2 * k + 1);
        sum = if k.is_multiple_of(2) { sum + term } else { sum - term };
        power /= IBig::from(n * n);
        k += 1;
    }
    let slack = IBig::from(2 * k + 4);
    (&sum - &slack, sum + slack)
}

/// atan(t) = Σ a_k for t in (0, 1), with a_0 = t/(1 + t²) and a_(k+1) = a_k z 2(k+1)/(2k+3), z = t²/(1 + t²) < 1/2 (Euler). What is left after a
/// term is below that term; each term is low by less than five units.
fn arctangent(ratio: &Rational, places: usize) -> Interval {
    let guard = 16;
    let bits = places + guard;
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
    (floor_shift(&sum - &slack, guard), ceil_shift(sum + slack, guard))
}

/// Σ (-1)^k x^(2k+first) / (2k+first)! for |x| < 1, so that the terms fall from the first on; each is off by less than two units.
fn series(x: &IBig, places: usize, first: u32) -> Interval {
    let guard = 16;
    let bits = places + guard;
    let x = x.clone() << guard;
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
    let slack = IBig::from(4 * steps + 8);
    (floor_shift(&sum - &slack, guard), ceil_shift(sum + slack, guard))
}
