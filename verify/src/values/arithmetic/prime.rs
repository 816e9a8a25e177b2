//! Arithmetic modulo a random prime.
//!
//! p lies between 2^62 and 2^63 and p = 1 mod 24, so that -1, 2 and 3 have square roots; primes that lack a root which the robot needs are
//! passed over. About 2^62/(ln 2^62.5 · 8) = 2^53 primes of this kind exist: an equality that holds by chance modulo one of them is found
//! by the next, as every point has a prime of its own.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use dashu_base::{Signed, UnsignedAbs};
use dashu_int::UBig;
use num_modular::ModularSymbols;

use super::Arithmetic;
use crate::values::element::{scrambled, Element};
use crate::values::formula::definitions::Defined;
use crate::values::formula::{root_from_coprime, Atoms, Dependent, Formula, Rational, Root};
use crate::values::stream::Stream;

/// An integer modulo a prime.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Residue {
    value: u64,
    prime: u64,
}

impl Residue {
    /// The representative in 0..p.
    pub fn value(self) -> u64 {
        self.value
    }

    /// Whether it is no square.
    pub fn is_no_square(self) -> bool {
        !self.is_zero() && self.power((self.prime - 1) / 2).value != 1
    }

    fn power(self, mut exponent: u64) -> Residue {
        let (mut result, mut base) = (Residue { value: 1, prime: self.prime }, self);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = result.times(&base);
            }
            base = base.times(&base);
            exponent >>= 1;
        }
        result
    }

    /// A square root, if there is one (Cipolla's method: (a + sqrt(a² - n))^((p+1)/2) in the field of p² elements).
    fn sqrt(self, stream: &mut Stream) -> Option<Residue> {
        let (p, one) = (self.prime, Residue { value: 1, prime: self.prime });
        if self.is_zero() {
            return Some(self);
        }
        if self.is_no_square() {
            return None;
        }
        let (a, w) = loop {
            let a = Residue { value: stream.below(p), prime: p };
            let w = a.times(&a).minus(&self);
            if w.is_no_square() {
                break (a, w);
            }
        };
        let multiply = |x: (Residue, Residue), y: (Residue, Residue)| {
            (x.0.times(&y.0).plus(&x.1.times(&y.1).times(&w)), x.0.times(&y.1).plus(&x.1.times(&y.0)))
        };
        let (mut result, mut base) = ((one, one.minus(&one)), (a, one));
        let mut exponent = p.div_ceil(2);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = multiply(result, base);
            }
            base = multiply(base, base);
            exponent >>= 1;
        }
        debug_assert!(result.1.is_zero() && result.0.times(&result.0) == self);
        Some(result.0)
    }
}

impl Element for Residue {
    fn plus(&self, other: &Self) -> Self {
        let sum = self.value + other.value;
        Residue { value: if sum >= self.prime { sum - self.prime } else { sum }, prime: self.prime }
    }
    fn minus(&self, other: &Self) -> Self {
        let value = if self.value >= other.value { self.value - other.value } else { self.value + self.prime - other.value };
        Residue { value, prime: self.prime }
    }
    fn times(&self, other: &Self) -> Self {
        if self.value == 0 || other.value == 0 {
            return Residue { value: 0, prime: self.prime };
        }
        Residue { value: multiply(self.value, other.value, self.prime), prime: self.prime }
    }
    fn negated(&self) -> Self {
        Residue { value: if self.value == 0 { 0 } else { self.prime - self.value }, prime: self.prime }
    }
    fn inverse(&self) -> Option<Self> {
        (!self.is_zero()).then(|| self.power(self.prime - 2))
    }
    fn sign(&self) -> Self {
        let opposite = self.negated();
        let random = |value: u64| Residue { value: 1 + scrambled(value ^ self.prime) % (self.prime - 1), prime: self.prime };
        match self.value.cmp(&opposite.value) {
            Ordering::Less => random(self.value),
            Ordering::Equal => *self,
            Ordering::Greater => random(opposite.value).negated(),
        }
    }
    fn is_zero(&self) -> bool {
        self.value == 0
    }
}

fn multiply(a: u64, b: u64, p: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(p)) as u64
}

/// A field of residues with the values of the atoms of a robot.
#[derive(Clone, Debug)]
pub struct Prime {
    prime: u64,
    stream: Stream,
    pi: Residue,
    roots: BTreeMap<Root, Residue>,
    angles: BTreeMap<Formula, (Residue, Residue)>,
    defined: Defined<Residue>,
}

/// How many numbers are looked at for a prime before the roots of a robot are given up: one in 14 is a prime, and each further independent
/// root halves the chance of one.
const CANDIDATES: usize = 1 << 24;

impl Prime {
    /// The field of the next random prime in which all roots of `atoms` exist, any of two for those that are independent; `None` if there
    /// are too many of them.
    pub fn new(stream: &mut Stream, atoms: &Atoms, dependent: &Dependent) -> Option<Prime> {
        Prime::next(stream, atoms, dependent, 24)
    }

    /// The same among all primes: those that are 1 mod 24 cannot tell 2 and 3 from squares.
    pub fn any(stream: &mut Stream, atoms: &Atoms) -> Option<Prime> {
        Prime::next(stream, atoms, &Dependent::new(), 2)
    }

    fn next(stream: &mut Stream, atoms: &Atoms, dependent: &Dependent, modulus: u64) -> Option<Prime> {
        // What is no square is told by Jacobi's symbol, for less than whether a number is a prime costs.
        let radicands: Vec<&UBig> = atoms.roots.iter().filter_map(Root::integer).collect();
        let squares = |p: u64| radicands.iter().all(|n| remainder(n, p).jacobi(&p) == 1);
        for _ in 0..CANDIDATES {
            let Some(prime) = candidate(stream, modulus).filter(|&p| squares(p) && is_prime(p)) else { continue };
            let mut field = Prime {
                prime,
                stream: stream.branch(),
                pi: Residue { value: 0, prime },
                roots: BTreeMap::new(),
                angles: BTreeMap::new(),
                defined: Defined::default(),
            };
            field.pi = field.draw();
            for angle in &atoms.angles {
                let point = field.draw_angle();
                field.angles.insert(angle.clone(), point);
            }
            if field.find_roots(atoms, dependent).is_some() {
                return Some(field);
            }
        }
        None
    }

    fn find_roots(&mut self, atoms: &Atoms, dependent: &Dependent) -> Option<()> {
        for root in &atoms.roots {
            let value = match (root, dependent.get(root)) {
                (_, Some(by)) => self.constant(by)?,
                (Root::Integer(n), _) => self.unsigned(n).sqrt(&mut self.stream)?,
                (Root::Nested(inner), _) => self.constant(inner)?.sqrt(&mut self.stream)?,
            };
            self.roots.insert(root.clone(), value);
        }
        Some(())
    }

    /// The prime.
    pub fn prime(&self) -> u64 {
        self.prime
    }

    fn unsigned(&self, n: &UBig) -> Residue {
        Residue { value: remainder(n, self.prime), prime: self.prime }
    }

    fn rational(&self, value: &Rational) -> Option<Residue> {
        let size = self.unsigned(&value.numerator().unsigned_abs()).over(&self.unsigned(value.denominator()))?;
        Some(if value.is_negative() { size.negated() } else { size })
    }
}

impl Arithmetic for Prime {
    type Element = Residue;

    fn integer(&self, value: i64) -> Residue {
        let size = Residue { value: value.unsigned_abs() % self.prime, prime: self.prime };
        if value < 0 {
            size.negated()
        } else {
            size
        }
    }

    fn constant(&self, formula: &Formula) -> Option<Residue> {
        let integers = || self.roots.iter().filter_map(|(root, value)| Some((root.integer()?, *value)));
        let root = |root: &Root| match root {
            Root::Integer(n) => root_from_coprime(n, self.integer(1), integers()),
            nested => self.roots.get(nested).copied(),
        };
        let angle = |angle: &Formula| self.angles.get(angle).copied();
        formula.evaluate(&|r| self.rational(r), &root, &|| Some(self.pi), &angle, &self.defined)
    }

    fn draw(&mut self) -> Residue {
        Residue { value: 1 + self.stream.below(self.prime - 1), prime: self.prime }
    }
}

fn remainder(n: &UBig, p: u64) -> u64 {
    u64::try_from(n % UBig::from(p)).expect("a remainder of p")
}

/// A random number between 2^62 and 2^63 that is 1 modulo `modulus`.
fn candidate(stream: &mut Stream, modulus: u64) -> Option<u64> {
    let any = (1 << 62) + stream.below(1 << 62);
    Some(any - any % modulus + 1).filter(|&candidate| candidate >= 1 << 62)
}

/// Whether an odd n above 40 is prime: Miller and Rabin with the first twelve primes as bases decides below 3.3e24 (Sorenson, Webster 2015).
fn is_prime(n: u64) -> bool {
    const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    if BASES.iter().any(|&b| n.is_multiple_of(b)) {
        return false;
    }
    let twos = (n - 1).trailing_zeros();
    BASES.iter().all(|&base| {
        let mut x = Residue { value: base, prime: n }.power((n - 1) >> twos).value;
        if x == 1 || x == n - 1 {
            return true;
        }
        (1..twos).any(|_| {
            x = multiply(x, x, n);
            x == n - 1
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Formula {
        Formula::parse(text).expect("a formula")
    }

    #[test]
    fn constants_keep_their_relations() {
        let texts = ["sqrt(2)", "sqrt(3)", "sqrt(5)", "sqrt(7 + sqrt(2))", "sin(7/10)", "cos(7/10)"];
        let formulas: Vec<Formula> = texts.iter().map(|t| parse(t)).collect();
        let atoms = Atoms::of(&formulas);
        let mut stream = Stream::new(1);
        for _ in 0..3 {
            let field = Prime::new(&mut stream, &atoms, &Dependent::new()).expect("few roots");
            assert_eq!(field.prime() % 24, 1);
            let of = |text: &str| field.constant(&parse(text)).expect("no division by zero");
            assert_eq!(of("sqrt(6)"), of("sqrt(2)*sqrt(3)"));
            assert_eq!(of("sqrt(2)^2"), of("2"));
            assert_eq!(of("sqrt(7 + sqrt(2))^2"), of("7 + sqrt(2)"));
            assert_eq!(of("sin(7/10)^2"), of("1 - cos(7/10)^2"));
            assert_eq!(of("1/3 - 5/6"), of("-1/2"));
            assert_ne!(of("sqrt(2)"), of("sqrt(3)"));
        }
    }

    #[test]
    fn inverses_and_primes() {
        assert!(is_prime(0xffff_ffff_0000_0001) && is_prime((1 << 61) - 1));
        assert!(is_prime((1 << 62) - 57) && !is_prime((1 << 62) - 55));
        assert!(!is_prime(3_215_031_751) && !is_prime(1_000_003 * 999_983));
        let field = Prime::new(&mut Stream::new(2), &Atoms::default(), &Dependent::new()).expect("no roots");
        let (seven, third) = (field.integer(7), field.integer(-3));
        assert_eq!(seven.over(&third).unwrap().times(&third), seven);
        assert_eq!(field.integer(0).inverse(), None);
    }
}
