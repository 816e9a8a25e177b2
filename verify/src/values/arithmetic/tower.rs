//! Fractions with square roots adjoined: Q(√a1)(√a2)..., each ak a number of the field below it.
//!
//! An element of the k-th field is a pair (x, y) of elements of the one below, x + y √ak, stored flat; products and inverses follow from
//! (x + y√a)(u + v√a) = (xu + yv a) + (xv + yu)√a. Roots that follow from others are no levels of their own ([`super::roots`]).
//! All coordinates share one denominator: a product of fractions reduces each of its 4^k parts, and so takes most of its time for divisors.
//! The ak have integer coordinates: √(n/d) is √(nd)/d.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::Arc;

use dashu_base::{BitTest, Gcd, Signed, UnsignedAbs};
use dashu_int::{IBig, UBig};

use super::Arithmetic;
use crate::values::element::{scrambled, Element};
use crate::values::formula::definitions::Defined;
use crate::values::formula::{root_from_coprime, Atoms, Dependent, Formula, Rational, Root};
use crate::values::stream::Stream;

/// What all numbers of a tower share.
#[derive(Debug)]
struct Shared {
    /// The squares of the adjoined roots, each in the coordinates of the field below.
    squares: Vec<Vec<IBig>>,
    /// How many products of words may still be formed; `UNLIMITED` are never used up.
    left: AtomicU64,
}

const UNLIMITED: u64 = u64::MAX;

impl Shared {
    fn new(squares: Vec<Vec<IBig>>) -> Shared {
        Shared { squares, left: AtomicU64::new(UNLIMITED) }
    }

    /// Takes some work from what is left; whether there is enough.
    fn take(&self, work: u64) -> bool {
        let less = |left: u64| if left == UNLIMITED { left } else { left.saturating_sub(work) };
        let left = self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| Some(less(left)));
        left.is_ok_and(|left| less(left) > 0)
    }
}

/// Coordinates over the products of the adjoined roots: the k-th bit of a place says whether the k-th root is a factor.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Coordinates {
    numerators: Vec<IBig>,
    /// Without a factor that all numerators have.
    denominator: UBig,
}

/// A number of the tower.
#[derive(Clone, Debug)]
pub struct Surd {
    coordinates: Coordinates,
    shared: Arc<Shared>,
}

/// As many roots are adjoined: a product costs up to 4^k products of fractions.
pub const MOST_ROOTS: usize = 5;

/// And 4^k times the angles of constants are at most so many: each makes the fractions longer.
const MOST_WORK: usize = 4096;

/// As many products of words are formed to find what a function should be at a rational point.
const MOST_PRODUCTS: u64 = 1 << 30;

/// Numerator and denominator of the tangents of half the joint angles, of arms of up to eight joints.
const LONGEST: u64 = 127;

impl Coordinates {
    pub(super) fn new(numerators: Vec<IBig>, denominator: UBig) -> Coordinates {
        let factor = denominator.clone();
        Coordinates::reduced(numerators, denominator, factor)
    }

    /// Reduced by the common factor of all numerators and a factor of the denominator.
    fn reduced(mut numerators: Vec<IBig>, mut denominator: UBig, factor: UBig) -> Coordinates {
        let common = common_factor(factor, &numerators);
        if !common.is_one() {
            let divisor = IBig::from(common.clone());
            numerators.iter_mut().filter(|n| !n.is_zero()).for_each(|n| *n /= &divisor);
            denominator /= common;
        }
        Coordinates { numerators, denominator }
    }

    /// A fraction among so many coordinates.
    pub(super) fn rational(value: &Rational, count: usize) -> Coordinates {
        let mut numerators = vec![IBig::ZERO; count];
        numerators[0] = value.numerator().clone();
        Coordinates { numerators, denominator: value.denominator().clone() }
    }

    /// Each as a fraction.
    pub(super) fn fractions(&self) -> impl Iterator<Item = Rational> + '_ {
        self.numerators.iter().map(|n| Rational::from_parts(n.clone(), self.denominator.clone()))
    }

    pub(super) fn is_zero(&self) -> bool {
        is_zero(&self.numerators)
    }

    /// x and y of x + y√a.
    pub(super) fn halves(&self) -> (Coordinates, Coordinates) {
        let (x, y) = self.numerators.split_at(self.numerators.len() / 2);
        let of = |numerators: &[IBig]| Coordinates::new(numerators.to_vec(), self.denominator.clone());
        (of(x), of(y))
    }

    /// x + y√a.
    pub(super) fn joined(x: &Coordinates, y: &Coordinates) -> Coordinates {
        let halves = [scaled(&x.numerators, &y.denominator), scaled(&y.numerators, &x.denominator)];
        Coordinates::new(halves.concat(), &x.denominator * &y.denominator)
    }

    pub(super) fn plus(&self, other: &Coordinates) -> Coordinates {
        if self.denominator == other.denominator {
            return Coordinates::new(add(&self.numerators, &other.numerators), self.denominator.clone());
        }
        let common = (&self.denominator).gcd(&other.denominator);
        let (own, others) = (&self.denominator / &common, &other.denominator / &common);
        let numerators = add(&scaled(&self.numerators, &others), &scaled(&other.numerators, &own));
        // A factor of the rest of either denominator divides one term of the sum alone.
        Coordinates::reduced(numerators, own * &other.denominator, common)
    }

    pub(super) fn negated(&self) -> Coordinates {
        Coordinates { numerators: negate(&self.numerators), denominator: self.denominator.clone() }
    }

    pub(super) fn times(&self, squares: &[Vec<IBig>], other: &Coordinates) -> Coordinates {
        let numerators = multiply(squares, &self.numerators, &other.numerators);
        Coordinates::new(numerators, &self.denominator * &other.denominator)
    }

    pub(super) fn inverse(&self, squares: &[Vec<IBig>]) -> Option<Coordinates> {
        let (numerators, denominator) = invert(squares, &self.numerators)?;
        let inverse = Coordinates::new(scaled(&numerators, &self.denominator), denominator.clone().unsigned_abs());
        Some(if denominator.is_negative() { inverse.negated() } else { inverse })
    }
}

/// The greatest common divisor of a number and all of these.
fn common_factor(number: UBig, numerators: &[IBig]) -> UBig {
    let mut common = number;
    for n in numerators.iter().filter(|n| !n.is_zero()) {
        if common.is_one() {
            break;
        }
        common = common.gcd(n.unsigned_abs());
    }
    common
}

fn scaled(a: &[IBig], factor: &UBig) -> Vec<IBig> {
    let factor = IBig::from(factor.clone());
    a.iter().map(|n| n * &factor).collect()
}

fn is_zero(a: &[IBig]) -> bool {
    a.iter().all(IBig::is_zero)
}

fn add(a: &[IBig], b: &[IBig]) -> Vec<IBig> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn negate(a: &[IBig]) -> Vec<IBig> {
    a.iter().map(|a| -a.clone()).collect()
}

fn multiply(squares: &[Vec<IBig>], a: &[IBig], b: &[IBig]) -> Vec<IBig> {
    if is_zero(a) || is_zero(b) {
        return vec![IBig::ZERO; a.len()];
    }
    let Some((square, below)) = squares.split_last() else { return vec![&a[0] * &b[0]] };
    let ((x, y), (u, v)) = (a.split_at(a.len() / 2), b.split_at(a.len() / 2));
    let (low, high) = (multiply(below, x, u), multiply(below, y, v));
    let mixed = if is_zero(y) || is_zero(v) {
        add(&multiply(below, x, v), &multiply(below, y, u))
    } else {
        // Three products instead of four: xv + yu = (x + y)(u + v) - xu - yv.
        add(&multiply(below, &add(x, y), &add(u, v)), &negate(&add(&low, &high)))
    };
    let mut product = add(&low, &multiply(below, &high, square));
    product.extend(mixed);
    product
}

/// The inverse, and an integer that it is to be divided by.
fn invert(squares: &[Vec<IBig>], a: &[IBig]) -> Option<(Vec<IBig>, IBig)> {
    if is_zero(a) {
        return None;
    }
    let Some((square, below)) = squares.split_last() else { return Some((vec![IBig::ONE], a[0].clone())) };
    let (x, y) = a.split_at(a.len() / 2);
    // 1/(x + y√a) = (x - y√a)/(x² - a y²)
    let norm = add(&multiply(below, x, x), &negate(&multiply(below, &multiply(below, y, y), square)));
    let (inverse, denominator) = invert(below, &norm)?;
    let mut result = multiply(below, x, &inverse);
    result.extend(negate(&multiply(below, y, &inverse)));
    Some((result, denominator))
}

impl Surd {
    pub(super) fn coordinates(&self) -> &Coordinates {
        &self.coordinates
    }

    /// Words of 64 bits that its numerators and its denominator take.
    fn words(&self) -> u64 {
        self.bits() as u64 / 64 + 1
    }

    /// The squares of the adjoined roots.
    pub(super) fn squares(&self) -> &[Vec<IBig>] {
        &self.shared.squares
    }

    fn with(&self, coordinates: Coordinates) -> Surd {
        Surd { coordinates, shared: self.shared.clone() }
    }
}

impl PartialEq for Surd {
    fn eq(&self, other: &Surd) -> bool {
        self.coordinates == other.coordinates
    }
}

impl Element for Surd {
    fn plus(&self, other: &Self) -> Self {
        self.with(self.coordinates.plus(&other.coordinates))
    }
    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }
    fn times(&self, other: &Self) -> Self {
        if self.shared.take(self.words() * other.words()) {
            self.with(self.coordinates.times(&self.shared.squares, &other.coordinates))
        } else {
            self.with(Coordinates::rational(&Rational::ZERO, self.coordinates.numerators.len()))
        }
    }
    fn bits(&self) -> usize {
        let Coordinates { numerators, denominator } = &self.coordinates;
        numerators.iter().map(IBig::bit_len).sum::<usize>() + denominator.bit_len()
    }
    fn negated(&self) -> Self {
        self.with(self.coordinates.negated())
    }
    fn inverse(&self) -> Option<Self> {
        Some(self.with(self.coordinates.inverse(&self.shared.squares)?))
    }
    fn sign(&self) -> Self {
        let Coordinates { numerators, denominator } = &self.coordinates;
        let Some(first) = numerators.iter().find(|x| !x.is_zero()) else { return self.clone() };
        let of = if first.is_negative() { negate(numerators) } else { numerators.clone() };
        let words = of.iter().flat_map(|n| [u64::from(n.is_negative())].into_iter().chain(words_of(&n.unsigned_abs())));
        let words = words.chain(words_of(denominator));
        let size = 1 + (words.fold(0, |hash, word| scrambled(hash ^ word)) % 10_000) as i64;
        let size = Rational::from(if first.is_negative() { -size } else { size });
        self.with(Coordinates::rational(&size, numerators.len()))
    }
    fn is_zero(&self) -> bool {
        self.coordinates.is_zero()
    }
}

/// Its digits to the base of 2^64.
fn words_of(n: &UBig) -> Vec<u64> {
    n.to_le_bytes().chunks(8).map(|bytes| bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte))).collect()
}

/// The tower of a robot, with random fractions for its angles without roots and for pi.
#[derive(Clone, Debug)]
pub struct Tower {
    shared: Arc<Shared>,
    stream: Stream,
    pi: Surd,
    roots: BTreeMap<Root, Surd>,
    angles: BTreeMap<Formula, (Surd, Surd)>,
    defined: Defined<Surd>,
    longest: u64,
}

impl Tower {
    /// The tower in which all roots of `atoms` exist, for an arm of so many joints; `None` if too many of them are independent, or there are
    /// too many angles beside them.
    pub fn new(stream: &mut Stream, atoms: &Atoms, dependent: &Dependent, joints: usize) -> Option<Tower> {
        let levels = atoms.roots.len() - dependent.len();
        let short = levels <= MOST_ROOTS && atoms.angles.len() << (2 * levels) <= MOST_WORK;
        // The denominators of all joint angles multiply: numbers stay about as long as those of eight joints.
        let longest = (LONGEST * 64 / (joints * joints).max(1) as u64).clamp(LONGEST / 8, LONGEST);
        short.then(|| Tower::with_levels(levels, stream, atoms, dependent, longest)).flatten()
    }

    /// What work finds, if it takes at most `MOST_PRODUCTS`; `None` if it takes more: numbers with many digits and roots grow with every inverse.
    pub fn within_limits<T>(&mut self, work: impl FnOnce(&mut Tower) -> T) -> Option<T> {
        self.shared.left.store(MOST_PRODUCTS, Ordering::Relaxed);
        let found = work(self);
        let left = self.shared.left.swap(UNLIMITED, Ordering::Relaxed);
        (left > 0).then_some(found)
    }

    /// The tower of some roots of integers without common factors.
    pub fn of_integers(roots: &[Root]) -> Tower {
        let atoms = Atoms { roots: roots.to_vec(), ..Atoms::default() };
        Tower::with_levels(roots.len(), &mut Stream::new(0), &atoms, &Dependent::new(), LONGEST).expect("integers have roots")
    }

    fn with_levels(levels: usize, stream: &mut Stream, atoms: &Atoms, dependent: &Dependent, longest: u64) -> Option<Tower> {
        let mut tower = Tower {
            shared: Arc::new(Shared::new(Vec::new())),
            stream: stream.branch(),
            pi: Surd {
                coordinates: Coordinates::rational(&Rational::ZERO, 1 << levels),
                shared: Arc::new(Shared::new(Vec::new())),
            },
            roots: BTreeMap::new(),
            angles: BTreeMap::new(),
            defined: Defined::default(),
            longest,
        };
        // The squares are found in the full width, the levels above still without a square of their own, and cut to the level below.
        let mut squares: Vec<Vec<IBig>> = (0..levels).map(|level| vec![IBig::ZERO; 1 << level]).collect();
        tower.shared = Arc::new(Shared::new(squares.clone()));
        tower.pi = tower.draw();
        for angle in &atoms.angles {
            let point = tower.draw_angle();
            tower.angles.insert(angle.clone(), point);
        }
        let mut level = 0;
        for root in &atoms.roots {
            let value = match dependent.get(root) {
                Some(by) => tower.constant(by)?,
                None => {
                    let square = match root {
                        Root::Integer(n) => tower.rational(&Rational::from(n.clone())),
                        Root::Nested(inner) => tower.constant(inner)?,
                    };
                    let Coordinates { numerators, denominator } = square.coordinates;
                    squares[level] = scaled(&numerators[..1 << level], &denominator);
                    tower.renew(squares.clone());
                    let mut root = vec![IBig::ZERO; numerators.len()];
                    root[1 << level] = IBig::ONE;
                    level += 1;
                    Surd { coordinates: Coordinates::new(root, denominator), shared: tower.shared.clone() }
                }
            };
            tower.roots.insert(root.clone(), value);
        }
        Some(tower)
    }

    /// Tells all numbers that are kept what the squares are.
    fn renew(&mut self, squares: Vec<Vec<IBig>>) {
        self.shared = Arc::new(Shared::new(squares));
        let angles = self.angles.values_mut().flat_map(|(sine, cosine)| [sine, cosine]);
        let all = angles.chain(self.roots.values_mut()).chain([&mut self.pi]);
        all.for_each(|surd| surd.shared = self.shared.clone());
    }

    fn rational(&self, value: &Rational) -> Surd {
        Surd { coordinates: Coordinates::rational(value, 1 << self.shared.squares.len()), shared: self.shared.clone() }
    }
}

impl Arithmetic for Tower {
    type Element = Surd;

    fn integer(&self, value: i64) -> Surd {
        self.rational(&Rational::from(value))
    }

    fn constant(&self, formula: &Formula) -> Option<Surd> {
        let integers = || self.roots.iter().filter_map(|(root, value)| Some((root.integer()?, value.clone())));
        formula.evaluate(
            &|r| Some(self.rational(r)),
            &|root| match root {
                Root::Integer(n) => root_from_coprime(n, self.integer(1), integers()),
                nested => self.roots.get(nested).cloned(),
            },
            &|| Some(self.pi.clone()),
            &|angle| self.angles.get(angle).cloned(),
            &self.defined,
        )
    }

    /// A small integer, one of twenty thousand: sums of fractions take a common denominator of all that is drawn.
    fn draw(&mut self) -> Surd {
        let sign = if self.stream.below(2) == 0 { 1 } else { -1 };
        let size = 1 + self.stream.below(10_000) as i64;
        self.integer(sign * size)
    }

    /// Of a small fraction t, one of some twenty thousand (of 32 joints three hundred): with t = a/b the denominator is a² + b², shorter than
    /// that of an integer as long as both.
    fn draw_angle(&mut self) -> (Surd, Surd) {
        let sign = if self.stream.below(2) == 0 { 1 } else { -1 };
        let (a, b) = (sign * (1 + self.stream.below(self.longest) as i64), 1 + self.stream.below(self.longest) as i64);
        let of = |numerator: i64| self.rational(&Rational::from_parts(numerator.into(), (a * a + b * b).unsigned_abs().into()));
        (of(2 * a * b), of(b * b - a * a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_roots_square_to_what_they_are_roots_of() {
        let parse = |text: &str| Formula::parse(text).expect("a formula");
        let formulas: Vec<Formula> =
            ["sqrt(6)", "sqrt(5 + sqrt(2))", "sqrt(3/4 + 1/5*sqrt(2))", "cos(7/10)", "pi"].iter().map(|t| parse(t)).collect();
        let tower = Tower::new(&mut Stream::new(1), &Atoms::of(&formulas), &Dependent::new(), 4).expect("four roots");
        let of = |text: &str| tower.constant(&parse(text)).expect("no division by zero");
        assert_eq!(of("sqrt(6)*sqrt(2)"), of("2*sqrt(3)"));
        assert_eq!(of("sqrt(5 + sqrt(2))^2"), of("5 + sqrt(2)"));
        assert_eq!(of("sqrt(3/4 + 1/5*sqrt(2))^2"), of("3/4 + 1/5*sqrt(2)"));
        assert_eq!(of("sin(7/10)^2 + cos(7/10)^2"), of("1"));
        let odd = of("1 + sqrt(2) - 3*sqrt(6) + 1/7*sqrt(5 + sqrt(2))*pi");
        let other = of("2/9 - sqrt(3)*sqrt(3/4 + 1/5*sqrt(2)) + 1/6*cos(7/10)");
        assert_eq!(odd.times(&odd.inverse().unwrap()), of("1"));
        assert_eq!(odd.plus(&other).times(&odd.minus(&other)), odd.times(&odd).minus(&other.times(&other)));
        assert_eq!(odd.times(&other).over(&other), Some(odd.clone()));
        assert_eq!(odd.minus(&other).plus(&other).minus(&odd), of("0"));
        for number in [&odd, &other, &of("sqrt(6)")] {
            assert_eq!(number.negated().sign(), number.sign().negated());
        }
        assert_ne!(of("sqrt(2)"), of("sqrt(3)"));
        assert_eq!(of("(1/(1 + sqrt(2)))"), of("sqrt(2) - 1"));
    }

    #[test]
    fn numbers_that_grow_beyond_the_limit_have_no_values() {
        let root = Root::Integer(2u8.into());
        let mut tower = Tower::of_integers(&[root]);
        let start = tower.constant(&Formula::parse("7/3 + sqrt(2)").expect("a formula")).expect("no division by zero");
        // Each square is twice as long: 2^60 words are more than any machine has.
        let squared = |times: usize| (0..times).fold(start.clone(), |x, _| x.times(&x));
        assert!(tower.within_limits(|_| squared(60)).is_none());
        assert_eq!(tower.within_limits(|_| squared(3)), Some(squared(3)));
        assert!(!squared(3).is_zero());
    }
}
