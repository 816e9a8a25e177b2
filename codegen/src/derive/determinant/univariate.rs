//! Polynomials in one variable over the exact constants: division, greatest common divisor, and the harmonics of an angle in t = tan(q/2):
//!
//! ```text
//! cos kq + i sin kq = (1 + i t)^2k / (1 + t²)^k
//! ```
//!
//! A coefficient counts as zero if it is zero in the prime field, since a quotient of general constants can be zero without
//! showing it.

use crate::exact::Number;
use crate::ring::field::{Element, Field};

/// Coefficients from the lowest power up.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Univariate {
    coefficients: Vec<Number>,
}

impl Univariate {
    /// c x^power.
    pub(super) fn monomial(power: usize, c: Number) -> Univariate {
        let mut coefficients = vec![Number::zero(); power + 1];
        coefficients[power] = c;
        Univariate { coefficients }
    }

    /// The numerator over (1 + t²)^|k| of c cos kq or c sin kq; its formal degree is 2|k|.
    pub(super) fn harmonic(k: i32, sine: bool, c: &Number) -> Univariate {
        let n = 2 * k.unsigned_abs() as usize;
        let mut coefficients = vec![Number::zero(); n + 1];
        let mut binomial = Number::one();
        for power in 0..=n {
            // (1 + i t)^n: i^power t^power, real for even powers.
            if (power % 2 == 1) == sine {
                let negative = (power / 2 % 2 == 1) != (sine && k < 0);
                let value = &binomial * c;
                coefficients[power] = if negative { -&value } else { value };
            }
            let step = Number::from((n - power) as i64);
            binomial = (&binomial * &step).checked_div(&Number::from(power as i64 + 1)).expect("positive");
        }
        Univariate { coefficients }
    }

    /// The coefficients.
    pub(super) fn coefficients(&self) -> &[Number] {
        &self.coefficients
    }

    /// The formal degree: that of the numerator over a power of 1 + t².
    pub(super) fn degree(&self) -> usize {
        self.coefficients.len().saturating_sub(1)
    }

    /// The degree of the highest power that is there.
    pub(super) fn proper_degree(&self) -> usize {
        self.coefficients.iter().rposition(|c| !c.is_zero()).unwrap_or(0)
    }

    /// Whether this is 0.
    pub(super) fn is_zero(&self) -> bool {
        self.coefficients.iter().all(Number::is_zero)
    }

    /// -self.
    pub(super) fn negated(&self) -> Univariate {
        Univariate { coefficients: self.coefficients.iter().map(|c| -c).collect() }
    }

    /// self += other; of two numerators the one of lower formal degree is expanded by 1 + t².
    pub(super) fn add(&mut self, other: &Univariate) {
        let even = self.degree().is_multiple_of(2) && other.degree().is_multiple_of(2);
        let degree = self.degree().max(other.degree());
        let (mut sum, other) = (self.to_degree(degree, even), other.to_degree(degree, even));
        for (a, b) in sum.coefficients.iter_mut().zip(&other.coefficients) {
            *a = &*a + b;
        }
        *self = sum;
    }

    /// The same with a higher formal degree: times powers of 1 + t² for an angle, padded otherwise.
    pub(super) fn to_degree(&self, degree: usize, angle: bool) -> Univariate {
        let mut result = self.clone();
        if result.coefficients.is_empty() {
            result.coefficients.push(Number::zero());
        }
        while angle && result.degree() + 2 <= degree {
            let mut next = vec![Number::zero(); result.coefficients.len() + 2];
            for (power, c) in result.coefficients.iter().enumerate() {
                next[power] = &next[power] + c;
                next[power + 2] = &next[power + 2] + c;
            }
            result.coefficients = next;
        }
        if result.coefficients.len() < degree + 1 {
            result.coefficients.resize(degree + 1, Number::zero());
        }
        result
    }

    /// Without leading zeros, scaled to a leading coefficient of 1.
    pub(super) fn monic(&self, field: &mut Field) -> Univariate {
        let mut coefficients = self.coefficients.clone();
        trim(field, &mut coefficients);
        if let Some(leading) = coefficients.last().cloned() {
            for c in &mut coefficients {
                *c = c.checked_div(&leading).expect("the leading coefficient is not zero");
            }
        }
        Univariate { coefficients }
    }
}

fn trim(field: &mut Field, coefficients: &mut Vec<Number>) {
    let zero = field.zero();
    for c in coefficients.iter_mut() {
        if field.number(c) == zero {
            *c = Number::zero();
        }
    }
    while coefficients.last().is_some_and(Number::is_zero) {
        coefficients.pop();
    }
}

/// Quotient and remainder by a monic divisor.
fn divide_with_rest(field: &mut Field, a: &Univariate, b: &Univariate) -> (Univariate, Univariate) {
    let mut rest = a.coefficients.clone();
    trim(field, &mut rest);
    let n = b.coefficients.len();
    let mut quotient = vec![Number::zero(); (rest.len() + 1).saturating_sub(n).max(1)];
    while rest.len() >= n && !rest.is_empty() {
        let (shift, factor) = (rest.len() - n, rest[rest.len() - 1].clone());
        for (k, c) in b.coefficients.iter().enumerate() {
            rest[shift + k] = &rest[shift + k] - &(&factor * c);
        }
        rest.pop();
        quotient[shift] = factor;
        trim(field, &mut rest);
    }
    (Univariate { coefficients: quotient }, Univariate { coefficients: rest })
}

/// a/b where b divides a.
pub(super) fn divide(field: &mut Field, a: &Univariate, b: &Univariate) -> Univariate {
    let (quotient, rest) = divide_with_rest(field, a, b);
    debug_assert!(rest.is_zero());
    quotient
}

/// The monic greatest common divisor of some polynomials that are not all 0.
///
/// In the prime field no leading coefficient vanishes, so the degree there bounds the degree over the constants. It is most often
/// 0, and then no quotient of long constants is formed.
pub(super) fn gcd_of_all(field: &mut Field, mut all: Vec<Univariate>) -> Univariate {
    let degree = degree_of_gcd(field, &all);
    if degree == 0 {
        return Univariate::monomial(0, Number::one());
    }
    all.retain(|polynomial| !polynomial.is_zero());
    all.sort_by_cached_key(|p| {
        (p.proper_degree(), p.coefficients.iter().map(Number::terms_multiplied_out).fold(0, usize::saturating_add))
    });
    let mut divisor = Univariate::default();
    for polynomial in &all {
        divisor = gcd(field, polynomial, &divisor);
        if divisor.proper_degree() == degree {
            break;
        }
    }
    divisor
}

/// The degree of the greatest common divisor in the prime field.
fn degree_of_gcd(field: &mut Field, all: &[Univariate]) -> usize {
    let zero = field.zero();
    let trimmed = |mut a: Vec<Element>| {
        a.truncate(a.iter().rposition(|c| *c != zero).map_or(0, |k| k + 1));
        a
    };
    let mut divisor: Vec<Element> = Vec::new();
    for polynomial in all {
        let mut rest = trimmed(polynomial.coefficients.iter().map(|c| field.number(c)).collect());
        while let Some(&leading) = rest.last() {
            // rest and divisor change places: the remainder of the longer one.
            std::mem::swap(&mut rest, &mut divisor);
            let inverse = field.inverse(leading);
            while rest.len() >= divisor.len() {
                let shift = rest.len() - divisor.len();
                let factor = field.mul(rest[rest.len() - 1], inverse);
                for (k, c) in divisor.iter().enumerate() {
                    rest[shift + k] = field.sub(rest[shift + k], field.mul(factor, *c));
                }
                rest = trimmed(rest);
            }
        }
    }
    divisor.len().saturating_sub(1)
}

/// The monic greatest common divisor.
fn gcd(field: &mut Field, a: &Univariate, b: &Univariate) -> Univariate {
    let (mut a, mut b) = (a.monic(field), b.monic(field));
    while !b.is_zero() {
        let (_, rest) = divide_with_rest(field, &a, &b);
        a = b;
        b = rest.monic(field);
    }
    a
}

/// Factors with their formal degrees: for an angle sines (roots 0 and infinity) and cosines (roots 1 and -1) by themselves, then the rest.
pub(super) fn split_known_roots(
    field: &mut Field,
    divisor: &Univariate,
    infinite: usize,
    angle: bool,
) -> Vec<(Univariate, usize)> {
    let mut parts = Vec::new();
    let (mut rest, mut infinite) = (divisor.clone(), infinite);
    if angle {
        let t = Univariate::monomial(1, Number::one());
        while infinite > 0 && rest.coefficients.first().is_some_and(Number::is_zero) {
            rest = divide(field, &rest, &t);
            infinite -= 1;
            parts.push((t.clone(), 2));
        }
        // 1 - t² is the cosine's numerator.
        let cosine = Univariate { coefficients: vec![Number::from(-1), Number::zero(), Number::one()] };
        loop {
            let (quotient, remainder) = divide_with_rest(field, &rest, &cosine);
            if rest.proper_degree() < 2 || !remainder.is_zero() {
                break;
            }
            rest = quotient;
            parts.push((cosine.clone(), 2));
        }
    }
    let degree = rest.proper_degree() + infinite;
    if degree > 0 {
        parts.push((rest, degree));
    } else if let (Some((first, _)), Some(scale)) = (parts.first_mut(), rest.coefficients.first()) {
        first.coefficients.iter_mut().for_each(|c| *c = &*c * scale);
    }
    parts
}
