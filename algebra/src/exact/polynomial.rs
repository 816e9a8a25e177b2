//! Polynomials in the named parameters of a description, with exact coefficients; long ones are not multiplied out ([`Number::times`]).

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::{Add, Mul, Neg, Sub};

use super::{Number, ParameterId};

/// Powers of parameters, sorted; empty for the constant term.
pub(super) type Powers = BTreeMap<ParameterId, u32>;

/// A polynomial in parameters.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polynomial {
    terms: BTreeMap<Powers, Number>,
}

impl Polynomial {
    /// 0.
    pub fn zero() -> Polynomial {
        Polynomial::default()
    }

    /// The parameter itself.
    pub fn variable(parameter: ParameterId) -> Polynomial {
        Polynomial { terms: BTreeMap::from([(Powers::from([(parameter, 1)]), Number::one())]) }
    }

    /// Coefficients by powers, in a fixed order.
    pub fn terms(&self) -> impl Iterator<Item = (&Powers, &Number)> {
        self.terms.iter()
    }

    /// Whether this is 0.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The number, if no parameter occurs.
    pub fn as_number(&self) -> Option<Number> {
        match self.terms.len() {
            0 => Some(Number::zero()),
            1 => self.terms.get(&Powers::new()).cloned(),
            _ => None,
        }
    }

    /// The value where each parameter has the value `of` says.
    pub fn evaluate(&self, of: &dyn Fn(ParameterId) -> Number) -> Number {
        let mut sum = Number::zero();
        for (powers, coefficient) in &self.terms {
            sum = sum.plus(&powers.iter().fold(coefficient.clone(), |term, (&parameter, &power)| {
                let value = of(parameter);
                (0..power).fold(term, |term, _| term.times(&value))
            }));
        }
        sum
    }

    /// Adds a term.
    fn add_term(&mut self, powers: Powers, coefficient: &Number) {
        match self.terms.entry(powers) {
            Entry::Vacant(entry) => {
                if !coefficient.is_zero() {
                    entry.insert(coefficient.clone());
                }
            }
            Entry::Occupied(mut entry) => {
                let sum = entry.get().plus(coefficient);
                *entry.get_mut() = sum;
                if entry.get().is_zero() {
                    entry.remove();
                }
            }
        }
    }

    /// The parameters that occur.
    pub fn variables(&self) -> BTreeSet<ParameterId> {
        self.terms.keys().flat_map(|powers| powers.keys().copied()).collect()
    }

    /// Whether each term holds at most one of `parameters`, to the first power.
    pub fn is_affine_in(&self, parameters: &BTreeSet<ParameterId>) -> bool {
        self.terms
            .keys()
            .all(|powers| powers.iter().filter(|(p, _)| parameters.contains(p)).map(|(_, power)| power).sum::<u32>() <= 1)
    }
}

impl From<Number> for Polynomial {
    fn from(value: Number) -> Polynomial {
        if value.is_zero() {
            return Polynomial::zero();
        }
        Polynomial { terms: BTreeMap::from([(Powers::new(), value)]) }
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;
    fn add(self, other: &Polynomial) -> Polynomial {
        let mut sum = self.clone();
        for (powers, coefficient) in &other.terms {
            sum.add_term(powers.clone(), coefficient);
        }
        sum
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;
    fn neg(self) -> Polynomial {
        Polynomial { terms: self.terms.iter().map(|(powers, c)| (powers.clone(), -c)).collect() }
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;
    fn sub(self, other: &Polynomial) -> Polynomial {
        self + &-other
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "powers add where factors multiply")]
    fn mul(self, other: &Polynomial) -> Polynomial {
        let mut product = Polynomial::zero();
        for (a, ca) in &self.terms {
            for (b, cb) in &other.terms {
                let mut powers = a.clone();
                for (&parameter, &power) in b {
                    *powers.entry(parameter).or_default() += power;
                }
                product.add_term(powers, &ca.times(cb));
            }
        }
        product
    }
}
