//! Numbers exactly as written: no float until emission.
//!
//! A [`Number`] is a polynomial with rational coefficients in *atoms* ([`Atom`]): square roots, pi, angles of points, sines and cosines of
//! angles that are not multiples of pi/12, and what is not multiplied out. Products are reduced at once by
//!
//! ```text
//! sqrt(n)² = n,    sin(a)² = 1 - cos(a)²,    pi^i pi^j = pi^(i+j)
//! ```
//!
//! so that a constant that is multiplied out has one form: equal numbers are equal values, and `sqrt(2)·sqrt(3)` is `sqrt(6)`. Long ones are
//! not multiplied out (`shared`).
//! (Relations beyond these, say between cos(0.7) and cos(1.4), are not known here. Nothing wrong follows: two ways to write one
//! number may then stay two numbers, two numbers never become one.)
//!
//! Emission asks [`Number::to_f64`] and [`Number::to_f32`] for the nearest float; they enclose the number ever more tightly until
//! both ends of the enclosure round alike (`enclosure.rs`).

mod enclosure;
mod polynomial;
mod shared;
mod text;

use std::cmp::Ordering;
use std::collections::btree_map::Entry;
use std::collections::BTreeMap;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};
use std::sync::Arc;

use dashu_base::{Abs, Signed, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, UBig};

pub use polynomial::Polynomial;
pub use shared::{Shared, Sum};
pub use text::Definitions;

/// An exact fraction in lowest terms.
pub type Rational = dashu_ratio::RBig;

/// A named quantity of a description by its place in the list of them; the variables of every polynomial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ParameterId(pub u32);

/// What a [`Number`] is made of, besides fractions.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Atom {
    /// The positive square root of a prime (or of an integer without a square factor that trial division finds).
    Root(UBig),
    /// The positive square root of a positive number that is not rational.
    RootOf(Arc<Shared>),
    /// The number pi.
    Pi,
    /// Sine of an angle in (0, pi/4], rad.
    Sine(Arc<Shared>),
    /// Cosine of an angle in (0, pi/4], rad.
    Cosine(Arc<Shared>),
    /// One over a number that has no simpler inverse.
    Inverse(Arc<Shared>),
    /// The angle of the point (1, t) from the x axis: the arc tangent of a fraction in (0, 1), rad.
    Arctangent(Rational),
    /// A sum that is not multiplied out (`shared`).
    Sum(Arc<Sum>),
}

/// A product of powers of atoms, sorted; empty for the number 1.
pub type Monomial = Vec<(Atom, i32)>;

/// An exact real constant.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Number {
    terms: BTreeMap<Monomial, Rational>,
}

/// Integers are searched for square factors up to this prime.
const TRIAL_DIVISION: u32 = 10_000;

/// An inverse is rationalised in so many steps, each of which removes a root and may double the terms and their digits; beyond, it
/// stays the atom [`Atom::Inverse`].
const RATIONALISING_STEPS: u32 = 6;
/// The same for the number of terms on the way.
const RATIONALISED_TERMS: usize = 64;

static ZERO: Rational = Rational::ZERO;

impl Number {
    /// 0.
    pub fn zero() -> Number {
        Number::default()
    }

    /// 1.
    pub fn one() -> Number {
        Number::from(1)
    }

    /// pi.
    pub fn pi() -> Number {
        Number::atom(Atom::Pi)
    }

    /// The angle from the x axis to the point (x, y), in (-pi, pi] rad; of the origin 0.
    pub fn angle_of(x: &Rational, y: &Rational) -> Number {
        let (width, height) = (x.clone().abs(), y.clone().abs());
        let quarter = &Number::pi() * &Number::from(Rational::from_parts(1.into(), 2u8.into()));
        let arctangent = |ratio: Rational| match ratio {
            ratio if ratio.is_zero() => Number::zero(),
            ratio if ratio.is_one() => &quarter * &Number::from(Rational::from_parts(1.into(), 2u8.into())),
            ratio => Number::atom(Atom::Arctangent(ratio)),
        };
        let first = match width.cmp(&height) {
            Ordering::Less => &quarter - &arctangent(width / height),
            _ if width.is_zero() => Number::zero(),
            _ => arctangent(height / width),
        };
        let upper = if x.is_negative() { &Number::pi() - &first } else { first };
        if y.is_negative() {
            -&upper
        } else {
            upper
        }
    }

    fn atom(atom: Atom) -> Number {
        Number { terms: BTreeMap::from([(vec![(atom, 1)], Rational::ONE)]) }
    }

    /// The terms: coefficient by monomial, in a fixed order.
    pub fn terms(&self) -> impl Iterator<Item = (&Monomial, &Rational)> {
        self.terms.iter()
    }

    /// Whether this is 0.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// Whether this is 1.
    pub fn is_one(&self) -> bool {
        self.as_rational().is_some_and(|r| r.is_one())
    }

    /// Whether this is made of fractions and square roots of integers alone: sums, products and quotients of such numbers are reduced to
    /// one form, so that equal ones look equal.
    pub fn is_reduced(&self) -> bool {
        self.terms.keys().flatten().all(|(atom, _)| matches!(atom, Atom::Root(_)))
    }

    /// Whether it has at most so many terms and factors, those inside of roots, angles and divisors included.
    pub fn is_within(&self, most: usize) -> bool {
        self.left_of(most).is_some()
    }

    fn left_of(&self, mut left: usize) -> Option<usize> {
        for monomial in self.terms.keys() {
            left = left.checked_sub(1)?;
            for (atom, _) in monomial {
                left = left.checked_sub(1)?;
                match atom {
                    Atom::RootOf(n) | Atom::Sine(n) | Atom::Cosine(n) | Atom::Inverse(n) => left = n.left_of(left)?,
                    Atom::Sum(sum) => left = sum.terms().left_of(left)?,
                    Atom::Root(_) | Atom::Pi | Atom::Arctangent(_) => {}
                }
            }
        }
        Some(left)
    }

    /// The fraction, if this is one.
    pub fn as_rational(&self) -> Option<&Rational> {
        match self.terms.len() {
            0 => Some(&ZERO),
            1 => self.terms.get(&Vec::new() as &Monomial),
            _ => None,
        }
    }

    /// Sign of the number: its order against 0.
    pub fn sign(&self) -> Ordering {
        let of = |r: &Rational| {
            if r.is_zero() {
                Ordering::Equal
            } else if r.is_negative() {
                Ordering::Less
            } else {
                Ordering::Greater
            }
        };
        if let Some(r) = self.as_rational() {
            return of(r);
        }
        for bits in enclosure::PRECISIONS {
            let (low, high) = self.enclose(bits);
            if of(&low) == of(&high) {
                return of(&low);
            }
        }
        // Beyond the last precision the number is a zero that the reductions do not see.
        Ordering::Equal
    }

    /// Whether enclosures to the first of the precisions leave open that the two are one number.
    pub fn is_near(&self, other: &Number) -> bool {
        let (a, b) = (self.enclose(enclosure::PRECISIONS[0]), other.enclose(enclosure::PRECISIONS[0]));
        a.0 <= b.1 && b.0 <= a.1
    }

    /// Whether it is below 0.
    pub fn is_negative(&self) -> bool {
        match self.as_rational() {
            Some(value) => value.is_negative(),
            None => self.sign() == Ordering::Less,
        }
    }

    /// Whether the leading coefficient is negative: a sign that costs nothing and that negation flips.
    pub fn leads_negative(&self) -> bool {
        self.terms.values().next().is_some_and(|c| c.is_negative())
    }

    /// The quotient, or `None` if `divisor` is 0.
    pub fn checked_div(&self, divisor: &Number) -> Option<Number> {
        Some(self * &divisor.inverse()?)
    }

    /// One over the number; `None` exactly where [`Number::sign`] finds a zero.
    pub fn inverse(&self) -> Option<Number> {
        (self.sign() != Ordering::Equal).then(|| self.inverse_within(RATIONALISING_STEPS))
    }

    /// One over the number, made of roots, pi, sines and cosines as it is; `None` of 0, and where it would be an [`Atom::Inverse`].
    pub fn simple_inverse(&self) -> Option<Number> {
        let is_inverse = |(atom, power): &(Atom, i32)| matches!((atom, power), (Atom::Inverse(_), _) | (Atom::Sum(_), ..0));
        self.inverse().filter(|inverse| !inverse.terms.keys().flatten().any(is_inverse))
    }

    /// One over a number other than 0, rationalised in at most so many steps.
    fn inverse_within(&self, steps: u32) -> Number {
        let mut terms = self.terms.iter();
        let (monomial, coefficient) = terms.next().expect("a number other than 0 has a term");
        if terms.next().is_none() {
            let mut inverse = Number::from(Rational::ONE / coefficient);
            for (atom, power) in monomial {
                inverse = &inverse * &invert_power(atom, *power, steps);
            }
            return inverse;
        }
        // a + b sqrt(n), with sqrt(n) in neither a nor b: multiply by the conjugate until no root is left. The conjugate can be a zero
        // that reduction does not see, as that of sqrt(3 - 2 sqrt(2)) + 1 + sqrt(2) by sqrt(2) nearly is: it leads nowhere.
        let root =
            self.terms.keys().flatten().find(|(a, _)| matches!(a, Atom::Root(_) | Atom::RootOf(_))).map(|(a, _)| a.clone());
        if let Some(root) = root.filter(|_| steps > 0 && self.terms.len() <= RATIONALISED_TERMS) {
            let mut conjugate = self.clone();
            for (monomial, coefficient) in &mut conjugate.terms {
                if monomial.iter().any(|(a, _)| *a == root) {
                    *coefficient = -coefficient.clone();
                }
            }
            let norm = self * &conjugate;
            if norm.terms.len() <= RATIONALISED_TERMS && conjugate.sign() != Ordering::Equal && norm.sign() != Ordering::Equal {
                let inverse = &conjugate * &norm.inverse_within(steps - 1);
                if inverse.terms.len() <= RATIONALISED_TERMS {
                    return inverse;
                }
            }
        }
        if self.is_shared() {
            return self.as_factor().inverse_within(steps);
        }
        Number::atom(Atom::Inverse(Shared::new(self.clone())))
    }

    /// Adds a term.
    fn add_term(&mut self, monomial: Monomial, coefficient: Rational) {
        match self.terms.entry(monomial) {
            Entry::Vacant(entry) => {
                if !coefficient.is_zero() {
                    entry.insert(coefficient);
                }
            }
            Entry::Occupied(mut entry) => {
                *entry.get_mut() += coefficient;
                if entry.get().is_zero() {
                    entry.remove();
                }
            }
        }
    }

    /// The positive square root, or `None` of a negative number.
    pub fn sqrt(&self) -> Option<Number> {
        match self.sign() {
            Ordering::Less => return None,
            Ordering::Equal => return Some(Number::zero()),
            Ordering::Greater => {}
        }
        let mut terms = self.terms.iter();
        let (monomial, coefficient) = terms.next().expect("a positive number has a term");
        // Of the atoms, only sums may be negative.
        let simple = |(atom, power): &(Atom, i32)| power % 2 == 0 && !matches!(atom, Atom::Sum(_));
        if terms.next().is_some() || !monomial.iter().all(simple) || coefficient.is_negative() {
            return Some(Number::atom(Atom::RootOf(Shared::new(self.clone()))));
        }
        // sqrt(p/q · Π a^2k) = sqrt(p q)/q · Π a^k: the atoms with an even power are positive (pi; sines and cosines of first-octant angles).
        let (p, q) = (coefficient.numerator().unsigned_abs(), coefficient.denominator().clone());
        let half: Monomial = monomial.iter().map(|(a, power)| (a.clone(), power / 2)).collect();
        let mut root = Number { terms: BTreeMap::from([(half, Rational::from_parts(IBig::ONE, q.clone()))]) };
        let mut rest = p * q;
        let mut divide_out = |prime: UBig, rest: &mut UBig| {
            while (&*rest % &prime).is_zero() {
                *rest = &*rest / &prime;
                root = &root * &Number::atom(Atom::Root(prime.clone()));
            }
        };
        let mut divisor = 2u32;
        while divisor <= TRIAL_DIVISION && UBig::from(divisor) * divisor <= rest {
            divide_out(UBig::from(divisor), &mut rest);
            divisor += if divisor == 2 { 1 } else { 2 };
        }
        if !rest.is_one() {
            let whole = rest.sqrt();
            root = if &whole * &whole == rest {
                &root * &Number::from(Rational::from(whole))
            } else {
                &root * &Number::atom(Atom::Root(rest))
            };
        }
        Some(root)
    }

    /// The nearest f64 (ties to even); infinite beyond its range.
    pub fn to_f64(&self) -> f64 {
        self.round(|r| r.to_f64().value())
    }

    /// The nearest f32 (ties to even), rounded once; infinite beyond its range.
    pub fn to_f32(&self) -> f32 {
        self.round(|r| r.to_f32().value())
    }

    fn round<T: PartialEq>(&self, nearest: impl Fn(&Rational) -> T) -> T {
        if let Some(r) = self.as_rational() {
            return nearest(r);
        }
        let mut last = None;
        for bits in enclosure::PRECISIONS {
            let (low, high) = self.enclose(bits);
            let (low, high) = (nearest(&low), nearest(&high));
            if low == high {
                return low;
            }
            last = Some(low);
        }
        last.expect("at least one precision is tried")
    }
}

fn invert_power(atom: &Atom, power: i32, steps: u32) -> Number {
    let of = |power: i32| Number { terms: BTreeMap::from([(vec![(atom.clone(), power)], Rational::ONE)]) };
    match atom {
        Atom::Pi | Atom::Sine(_) | Atom::Cosine(_) | Atom::Arctangent(_) | Atom::Sum(_) => of(-power),
        Atom::Root(n) => &of(1) * &Number::from(Rational::from_parts(IBig::ONE, n.clone())),
        Atom::Inverse(n) => (0..power).fold(Number::one(), |product, _| &product * &**n),
        // A root that stands is that of a positive number.
        Atom::RootOf(n) => &of(1) * &n.inverse_within(steps),
    }
}

/// The product of two monomials, reduced; a sum where a sine is squared.
fn multiply_monomials(a: &Monomial, b: &Monomial) -> Number {
    let mut powers: BTreeMap<&Atom, i32> = BTreeMap::new();
    for (atom, power) in a.iter().chain(b) {
        *powers.entry(atom).or_default() += power;
    }
    let mut coefficient = Rational::ONE;
    let mut monomial: Monomial = Vec::with_capacity(powers.len());
    let mut factors: Vec<Number> = Vec::new();
    for (atom, power) in powers {
        match atom {
            _ if power == 0 => {}
            Atom::Root(n) if power == 2 => coefficient *= Rational::from(n.clone()),
            Atom::RootOf(n) if power == 2 => factors.push(Number::clone(n)),
            Atom::Sine(angle) if power == 2 => {
                let cosine = Number { terms: BTreeMap::from([(vec![(Atom::Cosine(angle.clone()), 2)], Rational::ONE)]) };
                factors.push(&Number::one() - &cosine);
            }
            _ => monomial.push((atom.clone(), power)),
        }
    }
    let product = Number { terms: BTreeMap::from([(monomial, coefficient)]) };
    factors.iter().fold(product, |product, factor| &product * factor)
}

impl From<i64> for Number {
    fn from(value: i64) -> Number {
        Number::from(Rational::from(value))
    }
}

impl From<Rational> for Number {
    fn from(value: Rational) -> Number {
        if value.is_zero() {
            return Number::zero();
        }
        Number { terms: BTreeMap::from([(Vec::new(), value)]) }
    }
}

impl Add for &Number {
    type Output = Number;
    fn add(self, other: &Number) -> Number {
        let mut sum = self.clone();
        sum += other;
        sum
    }
}

impl AddAssign<&Number> for Number {
    fn add_assign(&mut self, other: &Number) {
        for (monomial, coefficient) in &other.terms {
            self.add_term(monomial.clone(), coefficient.clone());
        }
    }
}

impl Neg for &Number {
    type Output = Number;
    fn neg(self) -> Number {
        Number { terms: self.terms.iter().map(|(m, c)| (m.clone(), -c)).collect() }
    }
}

impl Sub for &Number {
    type Output = Number;
    fn sub(self, other: &Number) -> Number {
        self + &-other
    }
}

impl Mul for &Number {
    type Output = Number;
    fn mul(self, other: &Number) -> Number {
        if let (Some(a), Some(b)) = (self.as_rational(), other.as_rational()) {
            return Number::from(a * b);
        }
        let mut product = Number::zero();
        for (a, ca) in &self.terms {
            for (b, cb) in &other.terms {
                let coefficient = ca * cb;
                for (monomial, c) in multiply_monomials(a, b).terms {
                    product.add_term(monomial, c * &coefficient);
                }
            }
        }
        product
    }
}

/// An exact angle, rad.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Angle(Number);

impl Angle {
    /// The angle of so many radians.
    pub fn new(radians: Number) -> Angle {
        Angle(radians)
    }

    /// Its exact sine.
    pub fn sin(&self) -> Number {
        self.sine_cosine().0
    }

    /// Its exact cosine.
    pub fn cos(&self) -> Number {
        self.sine_cosine().1
    }

    /// Sine and cosine: exact roots for multiples of pi/12, a pair of atoms for the rest, brought to the first octant.
    fn sine_cosine(&self) -> (Number, Number) {
        // angle = quarters · pi/2 + reduced with |reduced| ≤ pi/4: exactly by the multiple of pi where there is one, else by enclosure.
        let multiple = self.0.terms.get(&vec![(Atom::Pi, 1)]).cloned().unwrap_or(Rational::ZERO);
        let without_pi = &self.0 - &(&Number::from(multiple.clone()) * &Number::pi());
        let quarters = if without_pi.is_zero() {
            (multiple.clone() * Rational::from(2)).round()
        } else {
            let (low, high) = (&self.0 * &Number::from(2)).checked_div(&Number::pi()).expect("pi is not zero").enclose(256);
            ((low + high) / Rational::from(2)).round()
        };
        let reduced = &self.0
            - &(&Number::from(Rational::from(quarters.clone()) * Rational::from_parts(1.into(), 2u8.into())) * &Number::pi());
        let (sine, cosine) = if without_pi.is_zero() {
            let part = multiple - Rational::from(quarters.clone()) / Rational::from(2);
            debug_assert!(part.clone().abs() <= Rational::from_parts(1.into(), 4u8.into()));
            first_octant(&part, &reduced)
        } else {
            atoms(&reduced)
        };
        match i64::try_from(quarters % IBig::from(4)).expect("a remainder of 4 is small").rem_euclid(4) {
            0 => (sine, cosine),
            1 => (cosine, -&sine),
            2 => (-&sine, -&cosine),
            _ => (-&cosine, sine),
        }
    }
}

/// Sine and cosine of `part · pi`, |part| ≤ 1/4.
fn first_octant(part: &Rational, angle: &Number) -> (Number, Number) {
    let fraction = |n: i64, d: i64| Number::from(Rational::from(n) / Rational::from(d));
    let root = |n: i64| Number::from(n).sqrt().expect("the integer is positive");
    let twelfths = part * Rational::from(12);
    let (sine, cosine) = if twelfths.is_int() {
        match i64::try_from(twelfths.numerator().clone().abs()).expect("at most 3") {
            0 => (Number::zero(), Number::one()),
            1 => (&(&root(6) - &root(2)) * &fraction(1, 4), &(&root(6) + &root(2)) * &fraction(1, 4)),
            2 => (fraction(1, 2), &root(3) * &fraction(1, 2)),
            _ => (&root(2) * &fraction(1, 2), &root(2) * &fraction(1, 2)),
        }
    } else {
        return atoms(angle);
    };
    (if part.is_negative() { -&sine } else { sine }, cosine)
}

fn atoms(angle: &Number) -> (Number, Number) {
    let sign = angle.sign();
    if sign == Ordering::Equal {
        return (Number::zero(), Number::one());
    }
    let negative = sign == Ordering::Less;
    let positive = Shared::new(if negative { -angle } else { angle.clone() });
    let sine = Number::atom(Atom::Sine(positive.clone()));
    (if negative { -&sine } else { sine }, Number::atom(Atom::Cosine(positive)))
}

#[cfg(test)]
mod tests;
