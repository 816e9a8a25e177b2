//! Rational trigonometric expressions, compared exactly.
//!
//! An expression becomes a fraction of polynomials with rational coefficients in names, sines and cosines of single angles, roots of
//! primes and pi. Every polynomial is in one canonical form, so that equality is a comparison of coefficients:
//!
//! ```text
//! sin(a + b) = sin a cos b + cos a sin b,  cos(a + b) = cos a cos b - sin a sin b      sums and multiples of angles are expanded
//! sin² = 1 - cos²                                                                      no sine stands to a higher power than 1
//! (√p)² = p,  √(p q) = √p √q,  √(n² p) = n √p                                          no root either
//! sin, cos of multiples of pi/12 by roots of 2 and 3                                   (√6 ± √2)/4 at pi/12
//! a/b = c/d  <=>  a d = b c                                                            there are no divisors of zero
//! ```
//!
//! Sines and cosines of another constant angle (7/10, pi/5) are a pair of their own. Two of them may be related in a way that is not
//! seen here; then equal things are called different, never the other way round.

mod parse;
mod polynomial;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

use polynomial::Polynomial;

/// An exact rational trigonometric expression.
#[derive(Clone, Debug)]
pub struct Exact {
    numerator: Polynomial,
    denominator: Polynomial,
}

/// Values for names.
pub type Names = BTreeMap<String, Exact>;

impl Exact {
    /// Reads a plain formula; every name except `pi` is a variable (and an angle inside `sin` and `cos`).
    ///
    /// Errors: wrong syntax; an unknown function; a division by zero. An angle must be an integer combination of names plus a
    /// constant, a power a small integer, and the argument of a root a rational >= 0.
    pub fn read(text: &str) -> Result<Self, String> {
        Self::read_with(text, &Names::new())
    }

    /// Reads a plain formula in which some names denote expressions.
    pub fn read_with(text: &str, names: &Names) -> Result<Self, String> {
        parse::read(text, names).map_err(|error| if error.contains('`') { error } else { format!("{error} in `{text}`") })
    }

    /// A whole number.
    pub fn integer(n: i64) -> Self {
        Polynomial::integer(n).into()
    }

    /// Whether this is zero.
    pub fn is_zero(&self) -> bool {
        self.numerator.is_zero()
    }

    /// The quotient.
    ///
    /// Errors: `other` is zero.
    pub fn over(&self, other: &Self) -> Result<Self, String> {
        if other.is_zero() {
            return Err("division by zero".to_owned());
        }
        Ok(Exact::fraction(&self.numerator * &other.denominator, &self.denominator * &other.numerator))
    }

    /// Partial derivative with respect to a name, also where it is an angle.
    pub fn derivative(&self, name: &str) -> Self {
        let (n, d) = (&self.numerator, &self.denominator);
        let up = &(&n.derivative(name) * d) - &(n * &d.derivative(name));
        Exact::fraction(up, d * d)
    }

    /// The names that it depends on.
    ///
    /// A fraction is not reduced to lowest terms, so a name that cancels may still be listed.
    pub fn names(&self) -> BTreeSet<String> {
        let mut names = self.numerator.names();
        names.extend(self.denominator.names());
        names
    }

    /// A fraction whose denominator is free of a constant factor.
    fn fraction(numerator: Polynomial, denominator: Polynomial) -> Self {
        if numerator.is_zero() {
            return Exact { numerator, denominator: Polynomial::integer(1) };
        }
        if numerator == denominator {
            return Exact::integer(1);
        }
        match denominator.constant_inverse() {
            Some((factor, rest)) => Exact { numerator: &numerator * &factor, denominator: rest },
            None => Exact { numerator, denominator },
        }
    }
}

impl From<Polynomial> for Exact {
    fn from(numerator: Polynomial) -> Self {
        Exact { numerator, denominator: Polynomial::integer(1) }
    }
}

impl PartialEq for Exact {
    fn eq(&self, other: &Self) -> bool {
        &self.numerator * &other.denominator == &other.numerator * &self.denominator
    }
}

impl Add for &Exact {
    type Output = Exact;
    fn add(self, other: &Exact) -> Exact {
        if self.denominator == other.denominator {
            return Exact::fraction(&self.numerator + &other.numerator, self.denominator.clone());
        }
        let up = &(&self.numerator * &other.denominator) + &(&other.numerator * &self.denominator);
        Exact::fraction(up, &self.denominator * &other.denominator)
    }
}

impl Sub for &Exact {
    type Output = Exact;
    fn sub(self, other: &Exact) -> Exact {
        self + &-other
    }
}

impl Mul for &Exact {
    type Output = Exact;
    fn mul(self, other: &Exact) -> Exact {
        Exact::fraction(&self.numerator * &other.numerator, &self.denominator * &other.denominator)
    }
}

impl Neg for &Exact {
    type Output = Exact;
    fn neg(self) -> Exact {
        Exact { numerator: -&self.numerator, denominator: self.denominator.clone() }
    }
}

impl fmt::Display for Exact {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.denominator == Polynomial::integer(1) {
            return write!(f, "{}", self.numerator);
        }
        write!(f, "({}) / ({})", self.numerator, self.denominator)
    }
}

/// A matrix of exact expressions, by rows.
pub type ExactMatrix = Vec<Vec<Exact>>;

/// Product of two matrices; the inner sizes must agree.
pub fn product(a: &ExactMatrix, b: &ExactMatrix) -> ExactMatrix {
    let columns = b.first().map_or(0, Vec::len);
    a.iter()
        .map(|row| {
            assert_eq!(row.len(), b.len(), "inner sizes");
            let sum = |j: usize| row.iter().zip(b).fold(Exact::integer(0), |sum, (x, other)| &sum + &(x * &other[j]));
            (0..columns).map(sum).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests;
