//! Enclosures: two fractions between which a [`Number`] lies, as close together as one asks.
//!
//! Everything is enclosed between multiples of 2^-places, rounded outwards. Roots by integer square root, pi by Machin's formula
//! pi/4 = 4 atan(1/5) - atan(1/239), sine and cosine by their series (arguments are at most pi/4): an
//! alternating series of falling terms lies between two partial sums. The arc tangent by Euler's series, whose terms are positive and fall by
//! more than a half each below 1. What comes out wide, a small fraction times a large root say, is done again with as many places more as
//! were lost.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use dashu_base::{BitTest, DivEuclid, Signed, SquareRoot};
use dashu_int::{IBig, UBig};

use super::{Atom, Number, Rational};

/// Numbers of bits to try in turn; the last is beyond what any written number needs to be told apart.
pub(super) const PRECISIONS: [usize; 5] = [96, 160, 320, 1280, 5120];

/// So many more places are worked with than bits are asked for: products of rotations lose one or two with each of them.
const GUARD: usize = 160;

/// Enclosures wider than 2^LOST multiples of 2^-places are done again with more of them.
const LOST: usize = 16;

/// Two multiples of 2^-places.
type Interval = (IBig, IBig);

/// The enclosures found so far of what many numbers share, by their places.
#[derive(Default)]
pub(super) struct Known(Mutex<Vec<(usize, Interval)>>);

impl Known {
    /// Whether the enclosure to so many places is there.
    pub(super) fn has(&self, places: usize) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().any(|(of, _)| *of == places)
    }

    /// The enclosure to so many places, found by `enclose` if it is not there.
    fn at(&self, places: usize, enclose: impl FnOnce() -> Interval) -> Interval {
        let list = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = list().iter().find(|(of, _)| *of == places) {
            return known.clone();
        }
        let enclosed = enclose();
        list().push((places, enclosed.clone()));
        enclosed
    }
}

impl Number {
    /// Two fractions around the number, less than 2^-bits apart.
    pub fn enclose(&self, bits: usize) -> (Rational, Rational) {
        let places = bits + GUARD;
        let (low, high) = Enclosures::new(places).within(GUARD, self);
        let fraction = |n: IBig| Rational::from_parts(n, UBig::ONE << places);
        (fraction(low), fraction(high))
    }
}

/// What has been enclosed so far to so many places: the terms of a number share their atoms.
struct Enclosures {
    places: usize,
    roots: BTreeMap<UBig, Interval>,
    pi: Option<Interval>,
}

impl Enclosures {
    fn new(places: usize) -> Enclosures {
        Enclosures { places, roots: BTreeMap::new(), pi: None }
    }

    /// Within about 2^LOST multiples of 2^-places: what sines and cosines are taken of is as short as it looks.
    fn number(&mut self, number: &Number) -> Interval {
        self.within(LOST, number)
    }

    /// Within about 2^lost multiples of 2^-places.
    fn within(&mut self, lost: usize, number: &Number) -> Interval {
        let mut guard = 0;
        loop {
            let places = self.places + guard;
            let (low, high) = self.to(places, |all| {
                // Those inside others first: however deep they are, nothing is called deeper.
                for atom in number.shared_inside(&|atom| atom.is_enclosed(places)) {
                    all.atom(&atom);
                }
                all.sum(number)
            });
            let width = (&high - &low).bit_len();
            if width <= guard + lost {
                return (floor_shift(low, guard), ceil_shift(high, guard));
            }
            // In steps, so that what is shared is enclosed to few different places.
            guard = width.next_multiple_of(GUARD);
        }
    }

    fn sum(&mut self, number: &Number) -> Interval {
        let mut sum = (IBig::ZERO, IBig::ZERO);
        for (monomial, coefficient) in number.terms() {
            let scaled = coefficient.numerator() << self.places;
            let mut product = match coefficient.denominator() {
                one if one.is_one() => (scaled.clone(), scaled),
                other => {
                    let other = IBig::from(other.clone());
                    (floor_quotient(&scaled, &other), ceil_quotient(&scaled, &other))
                }
            };
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
            Atom::RootOf(n) => n.own.at(places, || {
                // How wide that of a small number comes out, only the number that it is a factor of can judge.
                let (low, high) = self.number(n);
                let floor = |n: IBig| IBig::from((UBig::try_from(n).unwrap_or(UBig::ZERO) << places).sqrt());
                (floor(low), floor(high) + IBig::ONE)
            }),
            Atom::Pi => self.pi.get_or_insert_with(|| pi(places)).clone(),
            Atom::Arctangent(ratio) => arctangent(ratio, places),
            Atom::Sine(angle) => angle.sine.at(places, || {
                let (low, high) = self.number(angle);
                widen(series(&low, places, 1), &(high - low))
            }),
            Atom::Cosine(angle) => angle.cosine.at(places, || {
                let (low, high) = self.number(angle);
                widen(series(&low, places, 0), &(high - low))
            }),
            Atom::Inverse(n) => n.own.at(places, || inverse(places, |places| self.to(places, |all| all.number(n)))),
            // How wide it comes out, only the number that it is a factor of can judge.
            Atom::Sum(sum) => sum.terms().own.at(places, || self.sum(sum.terms())),
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
    let (low, high) = match (a.0.is_negative(), b.0.is_negative()) {
        (false, false) => (&a.0 * &b.0, &a.1 * &b.1),
        (true, false) if a.1.is_negative() => (&a.0 * &b.1, &a.1 * &b.0),
        (false, true) if b.1.is_negative() => (&a.1 * &b.0, &a.0 * &b.1),
        (true, true) if a.1.is_negative() && b.1.is_negative() => (&a.1 * &b.1, &a.0 * &b.0),
        _ => {
            let products = [&a.0 * &b.0, &a.0 * &b.1, &a.1 * &b.0, &a.1 * &b.1];
            let low = products.iter().min().expect("four products").clone();
            (low, products.into_iter().max().expect("four products"))
        }
    };
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
