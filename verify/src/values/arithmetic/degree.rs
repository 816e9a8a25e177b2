//! Degree and height of the polynomials that a program computes: what the odds of a false equality follow from.
//!
//! A value is N/(L^k Π D_i^e_i): N a polynomial with integer coefficients in the inputs and atoms, L the common denominator of all
//! constants, D_i the polynomials that the program divides by. Kept are the degree of N, the logarithm of the sum of the sizes of its
//! coefficients, k and the e_i: upper bounds of all of them, since nothing here sees a cancellation.
//!
//! A polynomial of degree d that is not 0 has a zero at a random point with odds of at most d/p (Schwartz 1980, Zippel 1979), and one whose
//! coefficients are below 2^h is 0 modulo one of h/62 primes at most.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock};

use dashu_base::{Abs, EstimatedLog2, UnsignedAbs};
use dashu_int::UBig;

use super::Arithmetic;
use crate::values::element::Element;
use crate::values::formula::definitions::{self, Defined};
use crate::values::formula::{Formula, Rational, Root};

/// What all values of a program share.
#[derive(Debug, Default)]
struct Table {
    /// log2 L.
    common: f64,
    /// Degree, logarithm of the height and power of 1/L of each D_i.
    divisors: RwLock<Vec<(f64, f64, f64)>>,
}

impl Table {
    fn divisor(&self, index: usize) -> (f64, f64, f64) {
        self.divisors.read().unwrap_or_else(PoisonError::into_inner)[index]
    }
}

/// Bounds on a value.
#[derive(Clone, Debug)]
pub struct Degree {
    table: Arc<Table>,
    /// Degree of N, log2 of its height, k; `None` for 0.
    size: Option<(f64, f64, f64)>,
    divisors: BTreeMap<usize, i64>,
}

impl PartialEq for Degree {
    fn eq(&self, other: &Degree) -> bool {
        self.size == other.size && self.divisors == other.divisors
    }
}

fn log2_sum(a: f64, b: f64) -> f64 {
    let (large, small) = if a > b { (a, b) } else { (b, a) };
    large + (small - large).exp2().ln_1p() / std::f64::consts::LN_2
}

impl Degree {
    /// Which powers of which divisors this value lacks of those given.
    fn missing<'a>(&'a self, divisors: &'a BTreeMap<usize, i64>) -> impl Iterator<Item = (f64, (f64, f64, f64))> + 'a {
        divisors.iter().filter_map(|(divisor, power)| {
            let extra = power.saturating_sub(self.divisors.get(divisor).copied().unwrap_or(0));
            (extra != 0).then(|| (extra as f64, self.table.divisor(*divisor)))
        })
    }

    /// Degree and height of this value brought to the denominators given.
    fn raised(&self, divisors: &BTreeMap<usize, i64>, k: f64) -> (f64, f64) {
        let (mut degree, mut height, own) = self.size.unwrap_or((0.0, 0.0, 0.0));
        let mut missing = k - own;
        for (extra, (d, h, l)) in self.missing(divisors) {
            degree += extra * d;
            height += extra * h;
            missing -= extra * l;
        }
        (degree, height + missing.max(0.0) * self.table.common)
    }

    /// Bounds for the numerator of a difference of this value and another: degree and log2 of the height.
    pub fn of_difference(&self, other: &Degree) -> (f64, f64) {
        let sum = self.plus(other);
        let (degree, height, _) = sum.size.unwrap_or((0.0, 0.0, 0.0));
        (degree, height)
    }
}

impl Element for Degree {
    fn plus(&self, other: &Self) -> Self {
        let (Some(a), Some(b)) = (self.size, other.size) else {
            return if self.size.is_none() { other.clone() } else { self.clone() };
        };
        let mut divisors = self.divisors.clone();
        for (&divisor, &power) in &other.divisors {
            let entry = divisors.entry(divisor).or_default();
            *entry = (*entry).max(power);
        }
        for (divisor, entry) in &mut divisors {
            *entry = (*entry).max(other.divisors.get(divisor).copied().unwrap_or(0));
        }
        // The power of 1/L that both reach once they stand over the common denominators.
        let power = |value: &Degree, k: f64| value.missing(&divisors).fold(k, |k, (extra, (.., l))| k + extra * l);
        let k = power(self, a.2).max(power(other, b.2));
        let (x, y) = (self.raised(&divisors, k), other.raised(&divisors, k));
        let size = (x.0.max(y.0), log2_sum(x.1, y.1), k);
        Degree { table: self.table.clone(), size: Some(size), divisors }
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(other)
    }

    fn times(&self, other: &Self) -> Self {
        let (Some(a), Some(b)) = (self.size, other.size) else {
            return Degree { table: self.table.clone(), size: None, divisors: BTreeMap::new() };
        };
        let mut divisors = self.divisors.clone();
        for (&divisor, &power) in &other.divisors {
            let entry = divisors.entry(divisor).or_default();
            *entry = entry.saturating_add(power);
        }
        divisors.retain(|_, power| *power != 0);
        let size = Some((a.0 + b.0, a.1 + b.1, a.2 + b.2));
        Degree { table: self.table.clone(), size, divisors }
    }

    fn negated(&self) -> Self {
        self.clone()
    }

    fn inverse(&self) -> Option<Self> {
        let size = self.size?;
        let index = {
            let mut list = self.table.divisors.write().unwrap_or_else(PoisonError::into_inner);
            list.push(size);
            list.len() - 1
        };
        let mut divisors: BTreeMap<usize, i64> = self.divisors.iter().map(|(&d, &power)| (d, power.saturating_neg())).collect();
        divisors.insert(index, 1);
        Some(Degree { table: self.table.clone(), size: Some((0.0, 0.0, 0.0)), divisors })
    }

    /// Drawn at random, as an input is.
    fn sign(&self) -> Self {
        let size = self.size.map(|_| (1.0, 0.0, 0.0));
        Degree { table: self.table.clone(), size, divisors: BTreeMap::new() }
    }

    fn is_zero(&self) -> bool {
        self.size.is_none()
    }
}

/// Where bounds come from.
#[derive(Clone, Debug)]
pub struct Degrees {
    table: Arc<Table>,
    defined: Defined<Degree>,
}

fn log2(n: &UBig) -> f64 {
    if n.is_zero() {
        0.0
    } else {
        f64::from(n.log2_bounds().1)
    }
}

/// The largest denominator that a constant brings in, as a factor of L.
fn denominator(formula: &Formula, common: &mut UBig) {
    match formula {
        Formula::Rational(value) => {
            use dashu_base::Gcd;
            let d = value.denominator();
            let shared = (&*common).gcd(d);
            *common = &*common / shared * d;
        }
        Formula::Sum(parts) | Formula::Product(parts) => parts.iter().for_each(|p| denominator(p, common)),
        Formula::Power(base, _) => denominator(base, common),
        Formula::Root(Root::Nested(inner)) => denominator(inner, common),
        // Pi and angles have none; what is defined stands among the constants itself.
        _ => {}
    }
}

impl Degrees {
    /// Bounds for programs with these constants.
    pub fn new<'a>(constants: impl IntoIterator<Item = &'a Formula>) -> Degrees {
        let mut common = UBig::ONE;
        let constants: Vec<&Formula> = constants.into_iter().collect();
        definitions::of(constants.iter().copied()).iter().for_each(|definition| denominator(definition.formula(), &mut common));
        constants.into_iter().for_each(|formula| denominator(formula, &mut common));
        Degrees { defined: Defined::default(), table: Arc::new(Table { common: log2(&common), divisors: RwLock::default() }) }
    }

    fn with(&self, degree: f64, height: f64, k: f64) -> Degree {
        Degree { table: self.table.clone(), size: Some((degree, height, k)), divisors: BTreeMap::new() }
    }

    fn rational(&self, value: &Rational) -> Degree {
        if value.is_zero() {
            return Degree { table: self.table.clone(), size: None, divisors: BTreeMap::new() };
        }
        let size = log2(&value.numerator().clone().abs().unsigned_abs()) - log2(value.denominator());
        if value.is_int() {
            self.with(0.0, size.max(0.0), 0.0)
        } else {
            self.with(0.0, (size + self.table.common).max(0.0), 1.0)
        }
    }
}

impl Arithmetic for Degrees {
    type Element = Degree;

    fn integer(&self, value: i64) -> Degree {
        self.rational(&Rational::from(value))
    }

    fn constant(&self, formula: &Formula) -> Option<Degree> {
        let root = |root: &Root| match root {
            Root::Integer(n) => Some(self.with(0.0, log2(n) / 2.0, 0.0)),
            Root::Nested(inner) => {
                let (degree, height, k) = self.constant(inner)?.size?;
                Some(self.with(degree, (height + k * self.table.common) / 2.0, k))
            }
        };
        let input = || self.with(1.0, 0.0, 0.0);
        formula.evaluate(&|r| Some(self.rational(r)), &root, &|| Some(input()), &|_| Some((input(), input())), &self.defined)
    }

    fn draw(&mut self) -> Degree {
        self.with(1.0, 0.0, 0.0)
    }

    fn draw_angle(&mut self) -> (Degree, Degree) {
        (self.draw(), self.draw())
    }
}

/// log2 of the odds that one point of a random prime misses a difference of such degree and height, with `circles` points of circles among
/// the inputs and `roots` square roots among the constants.
///
/// In the parameters t of the circles, (s, c) = (2t, 1 - t²)/(1 + t²), the degree of the numerator is at most 2 · circles times the degree.
pub fn log2_odds(degree: f64, height: f64, circles: usize, roots: usize) -> f64 {
    let circles = circles as f64;
    let expanded = degree * (2.0 * circles + 1.0);
    let zero_at_point = expanded.max(1.0).log2() - 62.0;
    // Primes between 2^62 and 2^63 that are 1 mod 24 (one in eight) and in which the roots exist (one in two each).
    let primes = 62.0 - (62.5 * std::f64::consts::LN_2).log2() - 3.0 - roots as f64;
    let conjugates = (roots.min(60) as f64).exp2();
    let heights = height + expanded;
    let zero_modulo_prime = (conjugates * heights / 62.0).max(1.0).log2() - primes;
    log2_sum(zero_at_point, zero_modulo_prime).min(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_add_and_denominators_are_shared() {
        let constants = [Formula::parse("1/4").unwrap(), Formula::parse("3/10").unwrap()];
        let mut field = Degrees::new(&constants);
        let (x, y) = (field.draw(), field.draw());
        let quarter = field.constant(&constants[0]).unwrap();
        let product = quarter.times(&x).times(&y);
        let (degree, height) = product.of_difference(&field.integer(3));
        assert_eq!(degree, 2.0);
        // x y·5 against 3·20: |5| + |60|.
        assert!((height - 65f64.log2()).abs() < 0.1, "{height}");
        let d = x.plus(&y);
        let (a, b) = (x.over(&d).unwrap(), y.over(&d).unwrap());
        // Two inversions are two divisors: bounds, not identities.
        assert_eq!(a.plus(&b).size.unwrap().0, 2.0);
        let once = d.inverse().unwrap();
        assert_eq!(x.times(&once).plus(&y.times(&once)).size.unwrap().0, 1.0);
        assert!(field.integer(0).is_zero());
    }

    #[test]
    fn odds_are_tiny_for_what_robots_compute() {
        assert!(log2_odds(40.0, 5000.0, 7, 1) < -38.0);
        assert!(log2_odds(1e19, 1.0, 7, 0) > -1.0);
    }
}
