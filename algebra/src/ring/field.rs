//! The prime field in which expressions have their fingerprints.
//!
//! Arithmetic modulo p = 2^64 - 2^32 + 1, in which -1, 2 and 3 have square roots (p = 1 mod 24), in Montgomery form. Every
//! exact constant has a value here: a fraction by division, a root by a square root of the field, pi and the angles that are
//! no multiples of pi/12 by fixed values on which nothing is known, with every (sine, cosine) a point of the circle. If the
//! constants of a robot hold a root that the field lacks, the next smaller prime = 1 mod 24 that has it is taken instead.
//!
//! Roots of integers are products of the roots of a *basis*: integers without common factors, found by greatest common divisors alone, since
//! the norm of an axis is too long to be factored. No product of some of them is a square, so that the sign of each root is free.

pub mod computed;

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::sync::Arc;

use dashu_base::{Gcd, Signed, SquareRoot, UnsignedAbs};
use dashu_int::UBig;
use num_modular::ModularSymbols;

use super::turn::Turn;
use super::AngleSum;
use crate::exact::{Atom, Number, Rational, Shared};
use crate::scramble::scramble;
use computed::{ComputedAngle, ComputedAngles};

/// 2^64 - 2^32 + 1.
const FIRST_PRIME: u64 = 0xffff_ffff_0000_0001;

/// Most different square roots besides those of 2 and 3, with nested ones. Half of all fields lack a root: the field of an arm is one in 2^16 then,
/// for the generator, which looks for one, and for the checker, which looks for many.
pub const MOST_ROOTS: usize = 16;

/// How many numbers = 1 mod 24 are looked at for a prime. One in 14 of them is a prime: the odds that none of
/// them has 16 roots are e^-18.
const CANDIDATES: usize = 1 << 24;

/// An element of the field, in Montgomery form: equal elements have equal representations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Element(u64);

impl Element {
    /// The bits that stand for the element: equal for equal elements, and as good as random for those of a computation.
    pub fn bits(self) -> u64 {
        self.0
    }
}

/// The field, with the values of the atoms met so far.
#[derive(Clone, Debug)]
pub struct Field {
    /// The constant angle of [`AngleSum::turned`], with its sine and cosine.
    turn: Option<(Arc<Turn>, (Element, Element))>,
    /// Angles that functions compute.
    computed: Option<Arc<ComputedAngles>>,
    /// The basis of the integers under roots, with a root of each.
    roots: Vec<(UBig, Element)>,
    p: u64,
    /// 1/p mod 2^64.
    inverse: u64,
    /// 2^128 mod p.
    r_squared: u64,
    atoms: BTreeMap<Atom, Element>,
}

impl Field {
    /// A field in which the roots of `numbers`, few different ones, exist.
    pub fn for_constants<'a>(numbers: impl IntoIterator<Item = &'a Number>) -> Field {
        Field::with_roots_of(numbers).expect("few roots have a field")
    }

    /// A field in which the roots of `numbers` exist; `None` if they are more than [`MOST_ROOTS`].
    pub fn with_roots_of<'a>(numbers: impl IntoIterator<Item = &'a Number>) -> Option<Field> {
        let (radicands, nested) = collect_roots(numbers);
        let few = |basis: &Vec<UBig>| basis.iter().filter(|n| !in_every_field(n)).count() + nested.len() <= MOST_ROOTS;
        // Each root by itself; where these are too many, all that stand in a product as one.
        let apart = coprime_basis(radicands.iter().flatten().cloned());
        let basis = Some(apart).filter(few).or_else(|| {
            let products = radicands.iter().map(|factors| factors.iter().fold(UBig::ONE, |product, n| product * n));
            Some(coprime_basis(products)).filter(few)
        });
        Field::with_roots(basis?)
    }

    /// A field for `numbers` in which the sine and cosine of a constant angle too have their values; `None` where that takes too many roots.
    pub fn with_turn(numbers: &[Number], turn: Turn) -> Option<Field> {
        let mut field = Field::with_roots_of(numbers.iter().chain([&turn.cosine, &turn.sine]))?;
        let circle = (field.number(&turn.sine), field.number(&turn.cosine));
        field.turn = Some((Arc::new(turn), circle));
        Some(field)
    }

    /// A field that has the roots of a basis. What is no square modulo p is told by Jacobi's symbol, for less than whether p is a prime costs.
    fn with_roots(basis: Vec<UBig>) -> Option<Field> {
        let squares = |p: u64| basis.iter().all(|n| remainder(n, p).jacobi(&p) == 1);
        let mut field = std::iter::successors(Some(FIRST_PRIME), |p| Some(p - 24))
            .take(CANDIDATES)
            .find(|&p| squares(p) && is_prime(p))
            .map(Field::modulo)?;
        field.roots = basis
            .into_iter()
            .map(|n| {
                let root = field.sqrt(field.rational(&Rational::from(n.clone()))).expect("a square modulo this prime");
                (n, root)
            })
            .collect();
        Some(field)
    }

    fn modulo(p: u64) -> Field {
        // Newton's iteration doubles the correct bits of the inverse modulo 2^64.
        let inverse = (0..6).fold(p, |x, _| x.wrapping_mul(2u64.wrapping_sub(p.wrapping_mul(x))));
        let r = (u128::MAX % u128::from(p) + 1) % u128::from(p);
        Field { turn: None, computed: None, roots: Vec::new(), p, inverse, r_squared: r as u64, atoms: BTreeMap::new() }
    }

    /// The constant angle of sums that are turned.
    pub fn turn(&self) -> Option<&Turn> {
        self.turn.as_ref().map(|(turn, _)| &**turn)
    }

    /// The same field for the coordinates of an arm, with angles that are sums of them.
    #[must_use]
    pub fn with_computed(&self, coordinates: u16, angles: Vec<ComputedAngle>) -> Field {
        let mut field = self.clone();
        let angles = ComputedAngles::new(coordinates, angles, &mut field);
        field.computed = Some(Arc::new(angles));
        field
    }

    /// Angles that functions compute.
    pub fn computed(&self) -> Option<&Arc<ComputedAngles>> {
        self.computed.as_ref()
    }

    /// Sine and cosine of the joint variable, or of the computed angle, of an index, where units have the points of these numbers.
    pub fn point(&self, index: u16, unit: impl Fn(u16) -> Element) -> (Element, Element) {
        match &self.computed {
            Some(angles) => angles.point(self, index, |index| self.circle(unit(index))),
            None => self.circle(unit(index)),
        }
    }

    /// The prime.
    pub fn prime(&self) -> u64 {
        self.p
    }

    /// 0.
    pub fn zero(&self) -> Element {
        Element(0)
    }

    /// 1.
    pub fn one(&self) -> Element {
        self.from_u64(1)
    }

    /// An integer modulo p.
    #[allow(clippy::wrong_self_convention)]
    pub fn from_u64(&self, value: u64) -> Element {
        self.reduce(u128::from(value % self.p) * u128::from(self.r_squared))
    }

    /// The representative in 0..p.
    pub fn to_u64(&self, a: Element) -> u64 {
        self.reduce(u128::from(a.0)).0
    }

    /// t / 2^64 of a t below 2^64 p: with m = t/p mod 2^64 the lower half of t - m p is 0.
    fn reduce(&self, t: u128) -> Element {
        let m = (t as u64).wrapping_mul(self.inverse);
        let less = ((u128::from(m) * u128::from(self.p)) >> 64) as u64;
        self.sub(Element((t >> 64) as u64), Element(less))
    }

    /// a + b.
    pub fn add(&self, a: Element, b: Element) -> Element {
        let (sum, carried) = a.0.overflowing_add(b.0);
        let (less, borrowed) = sum.overflowing_sub(self.p);
        Element(if carried || !borrowed { less } else { sum })
    }

    /// -a.
    pub fn neg(&self, a: Element) -> Element {
        Element(if a.0 == 0 { 0 } else { self.p - a.0 })
    }

    /// a - b.
    pub fn sub(&self, a: Element, b: Element) -> Element {
        let (difference, borrowed) = a.0.overflowing_sub(b.0);
        Element(if borrowed { difference.wrapping_add(self.p) } else { difference })
    }

    /// The lesser of a pair and its negative, and whether that is the negative.
    pub(crate) fn size(&self, pair: [Element; 2]) -> ([Element; 2], bool) {
        let negative = pair.map(|x| self.neg(x));
        if negative < pair {
            (negative, true)
        } else {
            (pair, false)
        }
    }

    /// a b.
    pub fn mul(&self, a: Element, b: Element) -> Element {
        self.reduce(u128::from(a.0) * u128::from(b.0))
    }

    /// a^n.
    pub fn pow(&self, a: Element, n: u64) -> Element {
        let mut result = self.one();
        for bit in (0..64).rev() {
            result = self.mul(result, result);
            if n >> bit & 1 == 1 {
                result = self.mul(result, a);
            }
        }
        result
    }

    /// 1/a; 0 for 0.
    pub fn inverse(&self, a: Element) -> Element {
        self.pow(a, self.p - 2)
    }

    /// A square root, the one with the smaller representative, if there is one (Tonelli and Shanks).
    pub fn sqrt(&self, a: Element) -> Option<Element> {
        if a.0 == 0 {
            return Some(a);
        }
        let (one, minus_one) = (self.one(), self.neg(self.one()));
        if self.pow(a, (self.p - 1) / 2) != one {
            return None;
        }
        let twos = (self.p - 1).trailing_zeros();
        let odd = (self.p - 1) >> twos;
        let non_residue =
            (2..).map(|n| self.from_u64(n)).find(|&n| self.pow(n, (self.p - 1) / 2) == minus_one).expect("half of the field");
        let (mut m, mut c) = (twos, self.pow(non_residue, odd));
        let (mut t, mut r) = (self.pow(a, odd), self.pow(a, odd.div_ceil(2)));
        while t != one {
            let mut i = 0;
            let mut square = t;
            while square != one {
                square = self.mul(square, square);
                i += 1;
            }
            let b = (0..m - i - 1).fold(c, |b, _| self.mul(b, b));
            m = i;
            c = self.mul(b, b);
            t = self.mul(t, c);
            r = self.mul(r, b);
        }
        Some(if self.to_u64(r) <= self.p / 2 { r } else { self.neg(r) })
    }

    /// The value of an exact constant.
    pub fn number(&mut self, number: &Number) -> Element {
        // Those inside others first, each once: however deep they are, nothing is called deeper.
        let unknown = number.shared_inside(&|atom| self.atoms.contains_key(atom));
        for atom in unknown {
            let value = match &atom {
                Atom::Inverse(number) => self.inverse(self.terms(number)),
                Atom::Sum(sum) => self.terms(sum.terms()),
                other => self.alone(other),
            };
            self.atoms.insert(atom, value);
        }
        let mut lone: Vec<&Atom> = number.terms().flat_map(|(monomial, _)| monomial).map(|(atom, _)| atom).collect();
        lone.retain(|atom| !matches!(atom, Atom::Root(_)) && !self.atoms.contains_key(atom));
        for atom in lone {
            let value = self.alone(atom);
            self.atoms.insert(atom.clone(), value);
        }
        self.terms(number)
    }

    /// The value of a number whose shared atoms are known.
    fn terms(&self, number: &Number) -> Element {
        let mut sum = self.zero();
        for (monomial, coefficient) in number.terms() {
            let mut product = self.rational(coefficient);
            let mut radicand = UBig::ONE;
            for (atom, power) in monomial {
                if let (Atom::Root(n), 1) = (atom, power) {
                    radicand *= n;
                    continue;
                }
                let value = self.atoms.get(atom).copied().unwrap_or_else(|| self.alone(atom));
                let value = if *power < 0 { self.inverse(value) } else { value };
                product = self.mul(product, self.pow(value, u64::from(power.unsigned_abs())));
            }
            if !radicand.is_one() {
                product = self.mul(product, self.root(&radicand));
            }
            sum = self.add(sum, product);
        }
        sum
    }

    /// The value of an atom that holds no other; that of a product of roots is `root`.
    fn alone(&self, atom: &Atom) -> Element {
        match atom {
            Atom::Sine(angle) => self.circle(self.unrelated(&Atom::Cosine(angle.clone()))).0,
            Atom::Cosine(_) => self.circle(self.unrelated(atom)).1,
            Atom::Root(n) => self.root(n),
            other => self.unrelated(other),
        }
    }

    /// The root of an integer, from the roots of the basis. A value on which nothing is known where they are not enough.
    fn root(&self, n: &UBig) -> Element {
        let (mut rest, mut product) = (n.clone(), self.one());
        for (factor, root) in &self.roots {
            while (&rest % factor).is_zero() {
                rest /= factor;
                product = self.mul(product, *root);
            }
        }
        if rest.is_one() {
            product
        } else {
            self.unrelated(&Atom::Root(n.clone()))
        }
    }

    fn rational(&self, value: &Rational) -> Element {
        let modulo = |n: &UBig| self.from_u64(remainder(n, self.p));
        let size = self.mul(modulo(&value.numerator().unsigned_abs()), self.inverse(modulo(value.denominator())));
        if value.is_negative() {
            self.neg(size)
        } else {
            size
        }
    }

    /// (sine, cosine) = (2t, 1 - t²)/(1 + t²): a point of the circle.
    pub fn circle(&self, t: Element) -> (Element, Element) {
        let square = self.mul(t, t);
        let scale = self.inverse(self.add(self.one(), square));
        (self.mul(self.add(t, t), scale), self.mul(self.sub(self.one(), square), scale))
    }

    /// Sine and cosine of a sum of two angles.
    pub(super) fn plus(&self, (s, c): (Element, Element), (t, d): (Element, Element)) -> (Element, Element) {
        (self.add(self.mul(s, d), self.mul(c, t)), self.sub(self.mul(c, d), self.mul(s, t)))
    }

    /// Sine and cosine of so many times an angle.
    pub(super) fn multiple(&self, point: (Element, Element), count: u64) -> (Element, Element) {
        (0..u64::BITS - count.leading_zeros()).rev().fold((self.zero(), self.one()), |sum, bit| {
            let twice = self.plus(sum, sum);
            if count >> bit & 1 == 1 {
                self.plus(twice, point)
            } else {
                twice
            }
        })
    }

    /// Sine and cosine of a sum of angles from those of its terms.
    pub fn circle_of(&self, sum: AngleSum, of: impl Fn(u16) -> (Element, Element)) -> (Element, Element) {
        let turn = || self.turn.as_ref().map(|(_, circle)| *circle).expect("only a field with a turn has turned sums");
        sum.circle((self.zero(), self.one()), of, turn, |&(s, c), &(t, d), minus| {
            self.plus((s, c), (if minus { self.neg(t) } else { t }, d))
        })
    }

    /// A value on which nothing is known, fixed by the atom's text.
    fn unrelated(&self, atom: &Atom) -> Element {
        let text = format!("{atom:?}");
        self.from_u64(text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| scramble(hash ^ u64::from(byte))))
    }
}

fn remainder(n: &UBig, p: u64) -> u64 {
    u64::try_from(n % UBig::from(p)).expect("a remainder of p")
}

/// Whether an integer is 2 or 3, whose roots exist modulo every p = 1 mod 24.
fn in_every_field(n: &UBig) -> bool {
    *n == UBig::from(2u8) || *n == UBig::from(3u8)
}

/// The integers whose roots stand in numbers, those of a product together, and the nested roots.
fn collect_roots<'a>(numbers: impl IntoIterator<Item = &'a Number>) -> (BTreeSet<Vec<UBig>>, BTreeSet<Atom>) {
    let (mut radicands, mut nested) = (BTreeSet::new(), BTreeSet::new());
    let mut open = numbers.into_iter().collect::<Vec<_>>();
    // Sums that are not multiplied out hold each other, one in many: each is looked at once.
    let mut seen: HashSet<*const Shared> = HashSet::new();
    while let Some(number) = open.pop() {
        for (monomial, _) in number.terms() {
            let mut factors = Vec::new();
            for (atom, _) in monomial {
                let inner: &Arc<Shared> = match atom {
                    Atom::Root(n) => {
                        factors.push(n.clone());
                        continue;
                    }
                    Atom::RootOf(inner) => {
                        nested.insert(atom.clone());
                        inner
                    }
                    Atom::Inverse(inner) => inner,
                    Atom::Sum(sum) => sum.terms(),
                    _ => continue,
                };
                if seen.insert(Arc::as_ptr(inner)) {
                    open.push(inner);
                }
            }
            if !factors.is_empty() {
                radicands.insert(factors);
            }
        }
    }
    (radicands, nested)
}

/// Integers without common factors, not one of them a square, whose roots give those of `integers`, of 2 and of 3. Primes stay as they are.
fn coprime_basis(integers: impl IntoIterator<Item = UBig>) -> Vec<UBig> {
    let mut basis = vec![UBig::from(2u8), UBig::from(3u8)];
    let mut open: Vec<UBig> = integers.into_iter().collect::<BTreeSet<_>>().into_iter().collect();
    while let Some(n) = open.pop() {
        let root = n.sqrt();
        if &root * &root == n {
            if !n.is_one() {
                open.push(root);
            }
            continue;
        }
        let Some(at) = basis.iter().position(|other| !other.gcd(&n).is_one()) else {
            basis.push(n);
            continue;
        };
        if basis[at] != n {
            let other = basis.swap_remove(at);
            let shared = (&other).gcd(&n);
            open.extend([other / &shared, n / &shared, shared]);
        }
    }
    basis.sort();
    basis
}

/// Whether n is prime: Miller and Rabin with the first twelve primes as bases, which decides below 3.3e24 (Sorenson and Webster 2015).
fn is_prime(n: u64) -> bool {
    const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    if n < 2 || BASES.iter().any(|&b| n.is_multiple_of(b)) {
        return BASES.contains(&n);
    }
    let mul = |a: u64, b: u64| (u128::from(a) * u128::from(b) % u128::from(n)) as u64;
    let twos = (n - 1).trailing_zeros();
    BASES.iter().all(|&base| {
        let mut exponent = (n - 1) >> twos;
        let (mut x, mut square) = (1, base);
        while exponent > 0 {
            if exponent & 1 == 1 {
                x = mul(x, square);
            }
            square = mul(square, square);
            exponent >>= 1;
        }
        if x == 1 || x == n - 1 {
            return true;
        }
        (1..twos).any(|_| {
            x = mul(x, x);
            x == n - 1
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Angle;

    #[test]
    fn the_first_field_has_the_roots_of_minus_one_two_and_three() {
        let field = Field::for_constants([]);
        assert_eq!(field.prime(), FIRST_PRIME);
        for n in [field.neg(field.one()), field.from_u64(2), field.from_u64(3)] {
            let root = field.sqrt(n).expect("has a root");
            assert_eq!(field.mul(root, root), n);
        }
        assert_eq!(field.sqrt(field.from_u64(7)), None);
        assert_eq!(field.mul(field.from_u64(3), field.inverse(field.from_u64(3))), field.one());
        assert_eq!(field.to_u64(field.sub(field.from_u64(3), field.from_u64(5))), FIRST_PRIME - 2);
    }

    #[test]
    fn a_field_has_every_root_or_there_is_none() {
        let root = |n: i64| Number::from(n).sqrt().unwrap();
        let primes = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67];
        let mut all = primes[..MOST_ROOTS + 2].iter().map(|&n| root(n)).collect::<Vec<_>>();
        let mut field = Field::for_constants(&all);
        for number in &all {
            let value = field.number(number);
            assert_eq!(field.mul(value, value), field.number(&(number * number)));
        }
        // One more, also where it is a nested one.
        let nested = (&Number::from(4) + &root(5)).sqrt().unwrap();
        for more in [root(67), nested] {
            all.push(more);
            assert!(Field::with_roots_of(&all).is_none());
            all.pop();
        }
    }

    #[test]
    fn many_roots_that_stand_in_one_product_are_one() {
        let primes = [5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67];
        assert!(primes.len() > MOST_ROOTS);
        let root = |n: i64| Number::from(n).sqrt().unwrap();
        let product = primes.iter().fold(Number::one(), |product, &n| &product * &root(n));
        let doubled = &product * &root(2);
        let mut field = Field::for_constants([&product, &doubled]);
        let [one, other, two] = [&product, &doubled, &root(2)].map(|number| field.number(number));
        assert_eq!(field.mul(one, two), other);
        assert_eq!(field.mul(one, one), field.number(&(&product * &product)));
    }

    #[test]
    fn constants_keep_their_relations() {
        let seven = Number::from(7).sqrt().unwrap();
        let mut field = Field::for_constants([&seven]);
        assert_ne!(field.prime(), FIRST_PRIME);
        let root = field.number(&seven);
        assert_eq!(field.mul(root, root), field.from_u64(7));
        let angle = Angle::new(Number::from(Rational::from(7) / Rational::from(10)));
        let (s, c) = (field.number(&angle.sin()), field.number(&angle.cos()));
        assert_eq!(field.add(field.mul(s, s), field.mul(c, c)), field.one());
        let fifteen = Angle::new(&Number::pi() * &Number::from(Rational::from(1) / Rational::from(12)));
        let (s, c) = (field.number(&fifteen.sin()), field.number(&fifteen.cos()));
        assert_eq!(field.add(field.mul(s, s), field.mul(c, c)), field.one());
    }
}
