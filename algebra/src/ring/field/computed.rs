//! Angles that a function computes: sums of coordinates with factors that are no whole numbers, and a constant.
//!
//! Their sines and cosines are inputs, like sin q and cos q, with indices after the coordinates. A field relates them. For each
//! coordinate p the unit angle is p/D, D the common denominator of its factors: p is D units, and each other angle a whole number of
//! units. The point of a unit is free, and the point of an angle is a product of its powers. So sin(2/3 p) and sin(1/3 p) satisfy in the
//! field what they satisfy over the reals. A factor with roots or pi has a unit of its own for each of its irrational parts.

use std::collections::{BTreeMap, BTreeSet};

use dashu_base::{Gcd, Signed, UnsignedAbs};
use dashu_int::UBig;

use super::{Element, Field};
use crate::exact::{Monomial, Number, Rational};

/// The most units that an angle has. A factor that would need more has a unit of its own.
const MOST_UNITS: u64 = 1 << 40;
/// The same at points with rational sines and cosines, which get as long. Expressions of an arm have low powers: more units have no relation there.
const MOST_RATIONAL_UNITS: u64 = 64;

/// The first unit that is no part of a coordinate's own angle; coordinates have lower indices.
const FIRST_OTHER: u16 = 1 << 10;

/// Σ k p + c.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComputedAngle {
    /// Coordinates with their factors: those with positive factors first, each kind ascending; there is a positive one.
    pub factors: Vec<(u16, Number)>,
    /// The constant.
    pub offset: Number,
    /// Its sine and cosine.
    pub turn: [Number; 2],
}

impl ComputedAngle {
    /// How many multiplications and additions form the angle.
    pub fn operations(&self) -> (usize, usize) {
        let scaled = self.factors.iter().filter(|(_, factor)| !is_one(factor)).count();
        (scaled, self.factors.len() - 1 + usize::from(!self.offset.is_zero()))
    }
}

/// Whether a number is 1 or -1.
fn is_one(factor: &Number) -> bool {
    factor.is_one() || (-factor).is_one()
}

/// The computed angles of a field.
#[derive(Clone, Debug)]
pub struct ComputedAngles {
    /// The index of the first one: the number of coordinates.
    first: u16,
    angles: Vec<ComputedAngle>,
    /// Units of each coordinate, and of each computed angle without its constant.
    units: Vec<Units>,
    /// The same at rational points.
    rational: Vec<Units>,
    /// Sine and cosine of each constant.
    turns: Vec<(Element, Element)>,
}

impl ComputedAngles {
    /// Those of an arm with so many coordinates; `field` gives constants their values.
    pub(super) fn new(coordinates: u16, angles: Vec<ComputedAngle>, field: &mut Field) -> ComputedAngles {
        let turns = angles.iter().map(|angle| angle.turn.each_ref().map(|number| field.number(number)).into()).collect();
        let [units, rational] = [MOST_UNITS, MOST_RATIONAL_UNITS].map(|most| units(coordinates, &angles, most).0);
        ComputedAngles { first: coordinates, units, rational, angles, turns }
    }

    /// The places of angles that are unrelated to a coordinate by a rational factor: their numbers of units would exceed 2^40.
    pub fn unrelated(angles: &[ComputedAngle]) -> Vec<usize> {
        let coordinates = angles.iter().flat_map(|angle| &angle.factors).map(|(a, _)| a + 1).max().unwrap_or(0);
        units(coordinates, angles, MOST_UNITS).1.into_iter().map(|index| index - usize::from(coordinates)).collect()
    }

    /// All of them with their indices.
    pub fn all(&self) -> impl Iterator<Item = (u16, &ComputedAngle)> {
        (self.first..).zip(&self.angles)
    }

    /// The angle of an index.
    pub fn get(&self, index: u16) -> Option<&ComputedAngle> {
        self.angles.get(usize::from(index.checked_sub(self.first)?))
    }

    /// Sine and cosine of the angle of an index, where `unit` gives sines and cosines of units.
    pub(super) fn point(&self, field: &Field, index: u16, unit: impl Fn(u16) -> (Element, Element)) -> (Element, Element) {
        let Some(units) = self.units.get(usize::from(index)) else { return unit(index) };
        let turn = index.checked_sub(self.first).map(|k| self.turns[usize::from(k)]);
        units.iter().fold(turn.unwrap_or((field.zero(), field.one())), |sum, &(index, count, minus)| {
            let (sine, cosine) = field.multiple(unit(index), count);
            field.plus(sum, (if minus { field.neg(sine) } else { sine }, cosine))
        })
    }

    /// The same with exact numbers, where units are rational points.
    pub(in crate::ring) fn rational_point(&self, index: u16, unit: impl Fn(u16) -> (Number, Number)) -> (Number, Number) {
        let Some(units) = self.rational.get(usize::from(index)) else { return unit(index) };
        let turn = self.get(index).map(|angle| angle.turn.clone().into());
        let plus =
            |(s, c): &(Number, Number), (t, d): &(Number, Number)| (s.times(d).plus(&c.times(t)), c.times(d).minus(&s.times(t)));
        units.iter().fold(turn.unwrap_or((Number::zero(), Number::one())), |sum, &(index, count, minus)| {
            let (sine, cosine) = unit(index);
            let point = (if minus { -&sine } else { sine }, cosine);
            (0..count).fold(sum, |sum, _| plus(&sum, &point))
        })
    }
}

/// Units of an angle: the unit, how many of it, and whether they are taken away.
type Units = Vec<(u16, u64, bool)>;

/// Angles with the multiples that they are of one unit, so far.
struct Related {
    /// The rational number that the first one has of its coordinate's irrational part.
    first: Rational,
    /// The common denominator of the multiples of the first one that the others are.
    common: UBig,
    /// Angles, each with its multiple of the first one.
    angles: Vec<(usize, Rational)>,
}

impl Related {
    /// Takes an angle in, if each angle still has at most `most` units.
    fn take(&mut self, index: usize, share: &Rational, most: &UBig) -> bool {
        let multiple = share / &self.first;
        let denominator = multiple.denominator();
        let common = &self.common / (&self.common).gcd(denominator) * denominator;
        let fits = |multiple: &Rational| &common / multiple.denominator() * multiple.numerator().unsigned_abs() <= *most;
        let fits = fits(&multiple) && self.angles.iter().all(|(_, multiple)| fits(multiple));
        if fits {
            self.common = common;
            self.angles.push((index, multiple));
        }
        fits
    }
}

/// Units of the coordinates and of the computed angles, none of more than `most`; and the computed angles that have a rational part which is not
/// related to its coordinate.
fn units(coordinates: u16, angles: &[ComputedAngle], most: u64) -> (Vec<Units>, BTreeSet<usize>) {
    // By coordinate and irrational part: angles that have a part of that.
    let mut parts: BTreeMap<(u16, Monomial), Vec<Related>> = BTreeMap::new();
    let most = UBig::from(most);
    let mut take = |key: (u16, Monomial), index: usize, share: &Rational| {
        let known = parts.entry(key).or_default();
        if !known.iter_mut().any(|related| related.take(index, share, &most)) {
            known.push(Related { first: share.clone(), common: UBig::ONE, angles: vec![(index, Rational::ONE)] });
        }
    };
    for a in 0..coordinates {
        take((a, Monomial::new()), usize::from(a), &Rational::ONE);
    }
    for (angle, index) in angles.iter().zip(usize::from(coordinates)..) {
        for (a, factor) in &angle.factors {
            factor.terms().for_each(|(monomial, share)| take((*a, monomial.clone()), index, share));
        }
    }
    let mut units = vec![Units::new(); usize::from(coordinates) + angles.len()];
    let (mut unrelated, mut other) = (BTreeSet::new(), FIRST_OTHER..);
    for ((a, monomial), known) in parts {
        for (place, Related { first, common, angles }) in known.into_iter().enumerate() {
            let own = place == 0 && monomial.is_empty();
            let unit = if own { a } else { other.next().expect("an arm has few factors") };
            for (index, multiple) in angles {
                let count = &common / multiple.denominator() * multiple.numerator().unsigned_abs();
                let count = u64::try_from(&count).expect("at most so many units");
                units[index].push((unit, count, multiple.is_negative() != first.is_negative()));
                if place > 0 && monomial.is_empty() {
                    unrelated.insert(index);
                }
            }
        }
    }
    (units, unrelated)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::{ExprId, Pool, Symbol};

    fn pool(factors: &[Number]) -> Pool {
        let angle = |factor: &Number| ComputedAngle {
            factors: vec![(0, factor.clone())],
            offset: Number::zero(),
            turn: [Number::zero(), Number::one()],
        };
        let angles = factors.iter().map(angle).collect();
        Pool::new(Field::for_constants(factors).with_computed(2, angles))
    }

    fn fraction(n: i64, d: u64) -> Number {
        Number::from(Rational::from_parts(n.into(), d.into()))
    }

    fn wave(pool: &mut Pool, index: u16) -> [ExprId; 2] {
        [Symbol::Sine(index), Symbol::Cosine(index)].map(|symbol| pool.symbol(symbol))
    }

    #[test]
    fn angles_of_one_unit_satisfy_the_theorems_of_addition() {
        let mut pool = pool(&[fraction(2, 3), fraction(1, 3), fraction(157, 200)]);
        let [[s, c], [s2, _], [s1, c1]] = [0, 2, 3].map(|index| wave(&mut pool, index));
        let [half, two] = [pool.mul(s1, c1), pool.integer(2)];
        assert_eq!(pool.mul(two, half), s2);
        let [_, c2] = wave(&mut pool, 2);
        assert_eq!(pool.dot(&[s1, c1], &[c2, s2]), s);
        let [other, _] = wave(&mut pool, 4);
        assert!(other != s && c != ExprId::ZERO);
        let [alone, _] = wave(&mut pool, 1);
        assert_ne!(alone, s);
    }

    #[test]
    fn irrational_parts_have_units_of_their_own() {
        let root = Number::from(2i64).sqrt().expect("positive");
        let twice = root.times(&Number::from(2i64));
        let mut pool = pool(&[root.clone(), twice, root.plus(&Number::one())]);
        let [[s, c], [r, d], [t, _], [sum, _]] = [0, 2, 3, 4].map(|index| wave(&mut pool, index));
        let [half, two] = [pool.mul(r, d), pool.integer(2)];
        assert_eq!(pool.mul(two, half), t);
        assert_eq!(pool.dot(&[s, c], &[d, r]), sum);
    }

    #[test]
    fn a_factor_of_many_digits_is_unrelated() {
        let long = Number::from(Rational::from_parts(1.into(), UBig::from(7u8).pow(30)));
        let mut pool = pool(&[long, fraction(1, 2), Number::from(Rational::from(dashu_int::IBig::from(10u8).pow(300)))]);
        let [[s, _], [long, _], [h, d]] = [0, 2, 3].map(|index| wave(&mut pool, index));
        let [half, two] = [pool.mul(h, d), pool.integer(2)];
        assert_eq!(pool.mul(two, half), s);
        assert_ne!(long, s);
    }

    #[test]
    fn derivatives_have_the_factor() {
        let factor = fraction(-2, 7);
        let mut pool = pool(&[-&factor]);
        let [s, c] = wave(&mut pool, 2);
        let by = |pool: &mut Pool, joint| pool.partial_derivative(&[s, c], joint);
        assert_eq!(by(&mut pool, 1), [ExprId::ZERO; 2]);
        let slope = pool.constant(&factor);
        assert_eq!(by(&mut pool, 0), [-pool.mul(slope, c), pool.mul(slope, s)]);
        let rate = pool.symbol(Symbol::Rate(0));
        let along = pool.mul(slope, rate);
        assert_eq!(pool.time_derivative(&[s]), [-pool.mul(along, c)]);
    }
}
