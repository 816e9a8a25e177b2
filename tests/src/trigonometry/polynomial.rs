//! Polynomials in canonical form: sorted monomials with rational coefficients, sines and roots at most to the first power.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};

/// An angle that a sine or cosine is taken of.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Angle {
    /// A name.
    Name(String),
    /// A positive constant in rad.
    Radians(BigRational),
    /// A positive multiple of pi that is no multiple of pi/12.
    Pi(BigRational),
}

/// An indeterminate.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Atom {
    /// Root of a prime (or of a number too large to factor).
    Root(BigInt),
    Pi,
    Name(String),
    /// Sign of a name; sign(0) = 0, so its square is not 1.
    Sign(String),
    Sine(Angle),
    Cosine(Angle),
}

/// Atoms with their powers, all positive.
type Monomial = BTreeMap<Atom, u32>;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Polynomial {
    /// No coefficient is zero.
    terms: BTreeMap<Monomial, BigRational>,
}

impl Polynomial {
    pub(super) fn constant(value: BigRational) -> Self {
        let mut polynomial = Polynomial::default();
        polynomial.add_term(Monomial::new(), value);
        polynomial
    }

    pub(super) fn integer(n: i64) -> Self {
        Self::constant(BigRational::from_integer(n.into()))
    }

    pub(super) fn atom(atom: Atom) -> Self {
        Polynomial { terms: BTreeMap::from([(Monomial::from([(atom, 1)]), BigRational::one())]) }
    }

    pub(super) fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The value, if it is a rational number.
    pub(super) fn rational(&self) -> Option<BigRational> {
        match self.terms.len() {
            0 => Some(BigRational::zero()),
            1 => self.terms.get(&Monomial::new()).cloned(),
            _ => None,
        }
    }

    /// The parts of a linear combination of atoms, the constant as `None`; `None` if a monomial has a higher degree.
    pub(super) fn linear(&self) -> Option<Vec<(Option<&Atom>, &BigRational)>> {
        let part = |(monomial, coefficient)| {
            let monomial: &Monomial = monomial;
            let mut atoms = monomial.iter();
            match (atoms.next(), atoms.next()) {
                (None, _) => Some((None, coefficient)),
                (Some((atom, 1)), None) => Some((Some(atom), coefficient)),
                _ => None,
            }
        };
        self.terms.iter().map(part).collect()
    }

    pub(super) fn scaled(&self, factor: &BigRational) -> Self {
        if factor.is_zero() {
            return Polynomial::default();
        }
        Polynomial { terms: self.terms.iter().map(|(m, c)| (m.clone(), c * factor)).collect() }
    }

    /// (f, rest) with rest = f · self free of its constant factor. The constant factor is the coefficient and roots of a single
    /// term, otherwise the first term's coefficient. `None` if there is nothing to do.
    pub(super) fn constant_inverse(&self) -> Option<(Polynomial, Polynomial)> {
        let (monomial, coefficient) = self.terms.iter().next()?;
        let mut factor = Polynomial::constant(coefficient.recip());
        if self.terms.len() == 1 {
            for atom in monomial.keys() {
                if let Atom::Root(p) = atom {
                    // 1/√p = √p / p
                    let root = Polynomial::atom(atom.clone()).scaled(&BigRational::new(BigInt::one(), p.clone()));
                    factor = &factor * &root;
                }
            }
        }
        if factor == Polynomial::integer(1) {
            return None;
        }
        let rest = self * &factor;
        Some((factor, rest))
    }

    pub(super) fn derivative(&self, name: &str) -> Self {
        let angle = Angle::Name(name.to_owned());
        let mut sum = Polynomial::default();
        for (monomial, coefficient) in &self.terms {
            for (atom, &power) in monomial {
                let inner = match atom {
                    Atom::Name(n) if n == name => Polynomial::integer(1),
                    Atom::Sine(a) if *a == angle => Polynomial::atom(Atom::Cosine(angle.clone())),
                    Atom::Cosine(a) if *a == angle => -&Polynomial::atom(Atom::Sine(angle.clone())),
                    _ => continue,
                };
                let mut rest = monomial.clone();
                match power {
                    1 => _ = rest.remove(atom),
                    _ => _ = rest.insert(atom.clone(), power - 1),
                }
                let scale = coefficient * BigRational::from_integer(power.into());
                sum = &sum + &(&inner * &Polynomial { terms: BTreeMap::from([(rest, scale)]) });
            }
        }
        sum
    }

    pub(super) fn names(&self) -> BTreeSet<String> {
        let name = |atom: &Atom| match atom {
            Atom::Name(n) | Atom::Sign(n) | Atom::Sine(Angle::Name(n)) | Atom::Cosine(Angle::Name(n)) => Some(n.clone()),
            _ => None,
        };
        self.terms.keys().flat_map(|m| m.keys().filter_map(name)).collect()
    }

    fn add_term(&mut self, monomial: Monomial, coefficient: BigRational) {
        if coefficient.is_zero() {
            return;
        }
        match self.terms.entry(monomial) {
            std::collections::btree_map::Entry::Vacant(entry) => _ = entry.insert(coefficient),
            std::collections::btree_map::Entry::Occupied(mut entry) => {
                *entry.get_mut() += coefficient;
                if entry.get().is_zero() {
                    entry.remove();
                }
            }
        }
    }

    /// Adds coefficient · monomial, where roots and sines may have the second power.
    fn add_product(&mut self, mut monomial: Monomial, mut coefficient: BigRational) {
        let mut squares = Vec::new();
        monomial.retain(|atom, power| match atom {
            Atom::Root(p) if *power == 2 => {
                coefficient *= BigRational::from_integer(p.clone());
                false
            }
            Atom::Sine(angle) if *power == 2 => {
                squares.push(angle.clone());
                false
            }
            _ => true,
        });
        // Every sin² doubles the terms: 1 - cos².
        let mut terms = vec![(monomial, coefficient)];
        for angle in squares {
            for k in 0..terms.len() {
                let (mut monomial, coefficient) = terms[k].clone();
                *monomial.entry(Atom::Cosine(angle.clone())).or_default() += 2;
                terms.push((monomial, -coefficient));
            }
        }
        for (monomial, coefficient) in terms {
            self.add_term(monomial, coefficient);
        }
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;
    fn add(self, other: &Polynomial) -> Polynomial {
        let (mut sum, less) = if self.terms.len() >= other.terms.len() { (self.clone(), other) } else { (other.clone(), self) };
        for (monomial, coefficient) in &less.terms {
            sum.add_term(monomial.clone(), coefficient.clone());
        }
        sum
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;
    fn sub(self, other: &Polynomial) -> Polynomial {
        self + &-other
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;
    fn neg(self) -> Polynomial {
        Polynomial { terms: self.terms.iter().map(|(m, c)| (m.clone(), -c)).collect() }
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    fn mul(self, other: &Polynomial) -> Polynomial {
        let mut product = Polynomial::default();
        for (m1, c1) in &self.terms {
            for (m2, c2) in &other.terms {
                let mut monomial = m1.clone();
                for (atom, power) in m2 {
                    *monomial.entry(atom.clone()).or_default() += power;
                }
                product.add_product(monomial, c1 * c2);
            }
        }
        product
    }
}

impl fmt::Display for Atom {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Atom::Root(p) => write!(f, "sqrt({p})"),
            Atom::Pi => write!(f, "pi"),
            Atom::Name(name) => write!(f, "{name}"),
            Atom::Sign(name) => write!(f, "sign({name})"),
            Atom::Sine(angle) => write!(f, "sin({angle})"),
            Atom::Cosine(angle) => write!(f, "cos({angle})"),
        }
    }
}

impl fmt::Display for Angle {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Angle::Name(name) => write!(f, "{name}"),
            Angle::Radians(x) => write!(f, "{x}"),
            Angle::Pi(x) => write!(f, "{x}*pi"),
        }
    }
}

impl fmt::Display for Polynomial {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.is_zero() {
            return write!(f, "0");
        }
        for (i, (monomial, coefficient)) in self.terms.iter().enumerate() {
            write!(f, "{}{coefficient}", if i == 0 { "" } else { " + " })?;
            for (atom, power) in monomial {
                write!(f, "*{atom}")?;
                if *power != 1 {
                    write!(f, "^{power}")?;
                }
            }
        }
        Ok(())
    }
}
