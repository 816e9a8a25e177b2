//! Exact constants as plain formulas: `1/2*sqrt(3) - 2*pi`, `0.85*sin(7/10)`.
//!
//! The constants of a description and the claimed values of literals have this text form. They are parsed here, then evaluated in an
//! [`Arithmetic`](crate::values::arithmetic::Arithmetic) or enclosed to any precision ([`crate::values::enclosure`]).
//!
//! A name such as `k0` denotes a formula that is defined once. The constants of an arm with general angles are graphs; their expanded form would
//! have exponential length ([`mod@definitions`]).

pub mod definitions;
pub mod parse;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;

use dashu_base::{Abs, Gcd, Signed, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, UBig};

use crate::values::element::Element;
use definitions::{Defined, Definition};

/// Maximum number of bits of an exact value.
pub(crate) const MOST_BITS: usize = 1 << 20;

/// An exact fraction.
pub type Rational = dashu_ratio::RBig;

/// Nested roots that depend on other roots, each as a formula of earlier roots.
pub type Dependent = BTreeMap<Root, Formula>;

/// An irrational number with a simpler square.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Root {
    /// The square root of an integer without square factors that trial division finds. A product contains at most one.
    Integer(UBig),
    /// The square root of any other number.
    Nested(Box<Formula>),
}

impl Root {
    /// The integer radicand, if it is an integer.
    pub fn integer(&self) -> Option<&UBig> {
        match self {
            Root::Integer(n) => Some(n),
            Root::Nested(_) => None,
        }
    }

    /// The radicand, if it is not an integer.
    pub fn nested(&self) -> Option<&Formula> {
        match self {
            Root::Integer(_) => None,
            Root::Nested(inner) => Some(inner),
        }
    }
}

/// An exact constant.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Formula {
    /// A fraction.
    Rational(Rational),
    /// pi.
    Pi,
    /// A positive square root.
    Root(Root),
    /// The sine of an angle in rad.
    Sine(Box<Formula>),
    /// The cosine of an angle in rad.
    Cosine(Box<Formula>),
    /// The angle in rad whose tangent is this fraction between 0 and 1.
    Arctangent(Rational),
    /// A sum. Long ones are copied many times, so that copies share the terms.
    Sum(Arc<[Formula]>),
    /// A product.
    Product(Arc<[Formula]>),
    /// An integer power.
    Power(Box<Formula>, i32),
    /// A formula with a definition.
    Defined(Arc<Definition>),
}

/// The roots and angles in formulas; a root follows the roots inside it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Atoms {
    /// Roots. Integer radicands are coprime, and every integer radicand of the formulas is a product of them.
    pub roots: Vec<Root>,
    /// Angles of sines and cosines.
    pub angles: BTreeSet<Formula>,
}

const TRIAL_DIVISION: u32 = 10_000;

impl Formula {
    /// The fraction, if the formula is a fraction.
    pub fn as_rational(&self) -> Option<&Rational> {
        match self {
            Formula::Rational(value) => Some(value),
            _ => None,
        }
    }

    /// The value for given values of fractions, roots, pi and angles (sine, cosine); `None` without such a value, for a division by 0, or where a
    /// number on the way is longer than any number of a robot. `defined` caches the values of definitions, for fixed values of the others.
    pub fn evaluate<E: Element>(
        &self,
        rational: &dyn Fn(&Rational) -> Option<E>,
        root: &dyn Fn(&Root) -> Option<E>,
        pi: &dyn Fn() -> Option<E>,
        angle: &dyn Fn(&Formula) -> Option<(E, E)>,
        defined: &Defined<E>,
    ) -> Option<E> {
        let of = |formula: &Formula| formula.evaluate(rational, root, pi, angle, defined);
        // Definitions can square a fraction again and again.
        let short = |value: E| (value.bits() <= MOST_BITS).then_some(value);
        match self {
            Formula::Defined(definition) => defined.get(definition, of),
            Formula::Rational(value) => rational(value),
            Formula::Pi => pi(),
            Formula::Root(inner) => root(inner),
            Formula::Sine(inner) => Some(angle(inner)?.0),
            Formula::Cosine(inner) => Some(angle(inner)?.1),
            // As a number, an angle is independent like pi: a separate random value.
            Formula::Arctangent(_) => Some(angle(self)?.0),
            Formula::Sum(terms) => {
                let (first, rest) = terms.split_first()?;
                rest.iter().try_fold(of(first)?, |sum, term| short(sum.plus(&of(term)?)))
            }
            Formula::Product(factors) => {
                let (first, rest) = factors.split_first()?;
                rest.iter().try_fold(of(first)?, |product, factor| short(product.times(&of(factor)?)))
            }
            Formula::Power(base, exponent) => {
                let base = of(base)?;
                let one = rational(&Rational::ONE)?;
                let power = (0..exponent.unsigned_abs()).try_fold(one, |power, _| short(power.times(&base)))?;
                if *exponent < 0 {
                    power.inverse()
                } else {
                    Some(power)
                }
            }
        }
    }

    /// The product, with fractions combined in front.
    fn by(self, other: Formula) -> Formula {
        Formula::product_of(vec![self, other])
    }

    fn product_of(formulas: Vec<Formula>) -> Formula {
        let mut scale = Rational::ONE;
        let mut under_root = UBig::ONE;
        let mut factors = Vec::new();
        for formula in formulas {
            let parts = if let Formula::Product(parts) = formula { parts.to_vec() } else { vec![formula] };
            for part in parts {
                match part {
                    Formula::Rational(value) => scale *= value,
                    Formula::Root(Root::Integer(n)) => {
                        let shared = (&under_root).gcd(&n);
                        under_root = (under_root / &shared) * (n / &shared);
                        scale *= Rational::from(shared);
                    }
                    other => factors.push(other),
                }
            }
        }
        if !under_root.is_one() {
            factors.insert(0, Formula::Root(Root::Integer(under_root)));
        }
        if scale.is_zero() || factors.is_empty() {
            return Formula::Rational(scale);
        }
        if !scale.is_one() {
            factors.insert(0, Formula::Rational(scale));
        }
        if factors.len() == 1 {
            factors.remove(0)
        } else {
            Formula::Product(factors.into())
        }
    }

    /// The terms of the sum.
    fn terms(&self) -> &[Formula] {
        match self {
            Formula::Sum(terms) => terms,
            other => std::slice::from_ref(other),
        }
    }

    /// Whether its text begins with a minus sign.
    fn leads_negative(&self) -> bool {
        match self {
            Formula::Rational(value) => value.is_negative(),
            Formula::Product(factors) => matches!(factors.first(), Some(Formula::Rational(value)) if value.is_negative()),
            _ => false,
        }
    }

    /// Exact sine and cosine of this angle, by roots: for eighths of a turn, and for quarter turns plus an arc tangent.
    pub fn circle(&self) -> (Formula, Formula) {
        let mut angle = (Rational::ZERO, None);
        let known = self.add_turns(&Rational::ONE, &mut angle);
        let (mut quarters, mut tangent) = angle;
        let eighth = Rational::from_parts(1.into(), 2u8.into());
        if tangent.is_none() && (&quarters - &eighth).is_int() {
            (quarters, tangent) = (quarters - eighth, Some(Rational::ONE));
        }
        let root = |tangent: &Rational| root_of_rational(&(Rational::ONE / (Rational::ONE + tangent * tangent)));
        let (true, true, Ok(cosine)) = (known, quarters.is_int(), root(&tangent.clone().unwrap_or_default())) else {
            return (Formula::Sine(Box::new(self.clone())), Formula::Cosine(Box::new(self.clone())));
        };
        let sine = Formula::Rational(tangent.unwrap_or_default()).by(cosine.clone());
        match (quarters.numerator() % IBig::from(4) + IBig::from(4)) % IBig::from(4) {
            n if n.is_zero() => (sine, cosine),
            n if n.is_one() => (cosine, sine.negated()),
            n if n == IBig::from(2) => (sine.negated(), cosine.negated()),
            _ => (cosine.negated(), sine),
        }
    }

    /// Adds `factor` times this angle, as quarter turns and the tangent of a single arc tangent; returns whether that is possible.
    fn add_turns(&self, factor: &Rational, angle: &mut (Rational, Option<Rational>)) -> bool {
        match self {
            Formula::Pi => {
                angle.0 += factor * Rational::from(2);
                true
            }
            Formula::Rational(value) => value.is_zero(),
            Formula::Arctangent(tangent) => {
                let sign = if factor.is_negative() { -tangent.clone() } else { tangent.clone() };
                factor.clone().abs().is_one() && angle.1.replace(sign).is_none()
            }
            Formula::Sum(terms) => terms.iter().all(|term| term.add_turns(factor, angle)),
            Formula::Product(factors) => match &factors[..] {
                [Formula::Rational(scale), inner] => inner.add_turns(&(scale * factor), angle),
                _ => false,
            },
            _ => false,
        }
    }

    fn collect(&self, atoms: &mut Atoms) {
        match self {
            Formula::Rational(_) | Formula::Pi => {}
            Formula::Root(root) => {
                if let Root::Nested(inner) = root {
                    inner.collect(atoms);
                }
                if !atoms.roots.contains(root) {
                    atoms.roots.push(root.clone());
                }
            }
            Formula::Sine(angle) | Formula::Cosine(angle) => {
                atoms.angles.insert((**angle).clone());
            }
            Formula::Arctangent(_) => {
                atoms.angles.insert(self.clone());
                self.circle().1.collect(atoms);
            }
            Formula::Sum(parts) | Formula::Product(parts) => parts.iter().for_each(|part| part.collect(atoms)),
            Formula::Power(base, _) => base.collect(atoms),
            // [`Atoms::of`] visits each definition once.
            Formula::Defined(_) => {}
        }
    }
}

/// Arithmetic on formulas: the result is a formula.
impl Element for Formula {
    fn plus(&self, other: &Self) -> Self {
        match (self, other) {
            (Formula::Rational(a), Formula::Rational(b)) => Formula::Rational(a + b),
            (zero, other) if zero.is_zero() => other.clone(),
            (other, zero) if zero.is_zero() => other.clone(),
            (a, b) => Formula::Sum([a.terms(), b.terms()].concat().into()),
        }
    }
    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }
    fn times(&self, other: &Self) -> Self {
        self.clone().by(other.clone())
    }
    fn negated(&self) -> Self {
        Formula::Rational(Rational::from(-1)).by(self.clone())
    }
    fn inverse(&self) -> Option<Self> {
        match self {
            Formula::Rational(value) if value.is_zero() => None,
            Formula::Rational(value) => Some(Formula::Rational(Rational::ONE / value)),
            other => Some(Formula::Power(Box::new(other.clone()), -1)),
        }
    }
    fn sign(&self) -> Self {
        match self {
            Formula::Rational(value) if value.is_zero() => self.clone(),
            Formula::Rational(value) => Formula::Rational(Rational::from(if value.is_negative() { -1 } else { 1 })),
            // Such a sign has no formula. Only kinematics uses formulas as elements, and it takes no signs.
            other => other.clone(),
        }
    }
    fn is_zero(&self) -> bool {
        self.as_rational().is_some_and(Rational::is_zero)
    }
}

impl fmt::Display for Formula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Formula::Rational(value) => write!(f, "{value}"),
            Formula::Pi => f.write_str("pi"),
            Formula::Root(Root::Integer(n)) => write!(f, "sqrt({n})"),
            Formula::Root(Root::Nested(inner)) => write!(f, "sqrt({inner})"),
            Formula::Sine(angle) => write!(f, "sin({angle})"),
            Formula::Cosine(angle) => write!(f, "cos({angle})"),
            Formula::Arctangent(tangent) => write!(f, "atan({tangent})"),
            Formula::Sum(terms) => {
                for (i, term) in terms.iter().enumerate() {
                    match (i, term.leads_negative()) {
                        (0, _) => write!(f, "{term}")?,
                        (_, false) => write!(f, " + {term}")?,
                        (_, true) => match term.negated() {
                            sum @ Formula::Sum(_) => write!(f, " - ({sum})")?,
                            term => write!(f, " - {term}")?,
                        },
                    }
                }
                Ok(())
            }
            Formula::Product(factors) => {
                for (i, factor) in factors.iter().enumerate() {
                    let times = if i > 0 { "*" } else { "" };
                    match factor {
                        Formula::Sum(_) => write!(f, "{times}({factor})")?,
                        factor => write!(f, "{times}{factor}")?,
                    }
                }
                Ok(())
            }
            Formula::Power(base, exponent) => write!(f, "({base})^({exponent})"),
            Formula::Defined(definition) => f.write_str(&definition.name()),
        }
    }
}

impl Atoms {
    /// The roots and angles in some formulas.
    pub fn of<'a>(formulas: impl IntoIterator<Item = &'a Formula>) -> Atoms {
        let mut atoms = Atoms::default();
        let formulas: Vec<&Formula> = formulas.into_iter().collect();
        definitions::of(formulas.iter().copied()).iter().for_each(|definition| definition.formula().collect(&mut atoms));
        formulas.into_iter().for_each(|formula| formula.collect(&mut atoms));
        let mut coprime = Vec::new();
        let mut nested = Vec::new();
        for root in atoms.roots {
            match root {
                Root::Integer(n) => add_coprime(&mut coprime, n),
                other => nested.push(other),
            }
        }
        coprime.sort();
        atoms.roots = coprime.into_iter().map(Root::Integer).chain(nested).collect();
        atoms
    }
}

/// Adds an integer to coprime factors, splitting common factors off. No factor stays a square.
fn add_coprime(coprime: &mut Vec<UBig>, n: UBig) {
    let root = n.sqrt();
    if &root * &root == n {
        if !n.is_one() {
            add_coprime(coprime, root);
        }
        return;
    }
    let Some(at) = coprime.iter().position(|other| !other.gcd(&n).is_one()) else { return coprime.push(n) };
    let other = coprime.swap_remove(at);
    if other == n {
        return coprime.push(n);
    }
    let shared = (&other).gcd(&n);
    for part in [other / &shared, n / &shared, shared] {
        add_coprime(coprime, part);
    }
}

/// The square root of an integer from roots of coprime integers; `None` if they do not suffice.
pub fn root_from_coprime<'a, E: Element + 'a>(n: &UBig, one: E, roots: impl Iterator<Item = (&'a UBig, E)>) -> Option<E> {
    let (mut rest, mut product) = (n.clone(), one);
    for (factor, root) in roots {
        while (&rest % factor).is_zero() {
            rest /= factor;
            product = product.times(&root);
        }
    }
    rest.is_one().then_some(product)
}

/// The square root of a fraction: sqrt(p/q) = sqrt(p q)/q without square factors.
fn root_of_rational(value: &Rational) -> Result<Formula, String> {
    if value.is_negative() {
        return Err(format!("the square root of {value} is not a number"));
    }
    if value.is_zero() {
        return Ok(Formula::Rational(Rational::ZERO));
    }
    let denominator = value.denominator().clone();
    let mut rest = value.numerator().unsigned_abs() * &denominator;
    let (mut whole, mut under_root) = (UBig::ONE, UBig::ONE);
    let mut divisor = 2u32;
    while divisor <= TRIAL_DIVISION && UBig::from(divisor) * divisor <= rest {
        let prime = UBig::from(divisor);
        while (&rest % (&prime * &prime)).is_zero() {
            rest /= &prime * &prime;
            whole *= &prime;
        }
        if (&rest % &prime).is_zero() {
            rest /= &prime;
            under_root *= prime;
        }
        divisor += if divisor == 2 { 1 } else { 2 };
    }
    let root = rest.sqrt();
    if &root * &root == rest {
        whole *= root;
    } else {
        under_root *= rest;
    }
    let scale = Formula::Rational(Rational::from_parts(IBig::from(whole), denominator));
    Ok(scale.by(Formula::Root(Root::Integer(under_root))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::arithmetic::wide::Wide;

    #[test]
    fn numbers_and_roots_take_one_form() {
        let parse = |text: &str| Formula::parse(text).expect("a formula");
        assert_eq!(parse("1/2 - 0.25"), parse("25e-2"));
        assert_eq!(parse("sqrt(4/9)"), parse("2/3"));
        assert_eq!(parse("sqrt(8)"), parse("2*sqrt(2)"));
        assert_eq!(parse("-sqrt(2)"), parse("1/2*sqrt(2)*(-2)"));
        for text in ["-1/2*sqrt(3) - pi*(1/(1 + sqrt(2)))", "sqrt(5 - sqrt(3))^3 - 2*cos(7/10)", "2*(pi - 3)", "-(1 - pi)"] {
            let once = parse(text);
            assert_eq!(parse(&once.to_string()), once, "{text} is printed as {once}");
        }
        for wrong in ["", "1 +", "2 * x", "sqrt(-1)", "1/0", "(1", "1)", "2^999", "1e500"] {
            assert!(Formula::parse(wrong).is_err(), "{wrong}");
        }
        assert!(Formula::parse(&"(".repeat(100)).is_err());
    }

    /// A printed result parses back to the same formula, whichever term comes first in a sum.
    #[test]
    fn results_are_read_as_they_are_printed() {
        let parse = |text: &str| Formula::parse(text).expect("a formula");
        let all = ["-3/50", "2*sin(3/5)", "-1/50*sin(3/5) - 7/100*cos(3/5)", "1/10 - 3/10*(2 - sin(3/5))"].map(parse);
        let of_two = |x: &Formula, y: &Formula| [x.plus(y), x.minus(y), y.minus(x), x.times(y), x.negated()];
        for (x, y) in all.iter().flat_map(|x| all.iter().map(move |y| (x, y))) {
            for z in of_two(x, y).iter().flat_map(|z| of_two(z, x)) {
                let text = z.to_string();
                assert_eq!(parse(&text).to_string(), text);
                let value = |z: &Formula| Wide::from_formula(z).expect("a number").to_f64();
                assert!((value(&parse(&text)) - value(&z)).abs() < 1e-14, "{text}");
            }
        }
    }

    #[test]
    fn roots_of_integers_are_told_apart_by_their_factors() {
        let parse = |text: &str| Formula::parse(text).expect("a formula");
        assert_eq!(parse("sqrt(6)*sqrt(10)"), parse("2*sqrt(15)"));
        assert_eq!(parse("sqrt(7)*sqrt(7)"), parse("7"));
        let roots = |texts: &[&str]| {
            let formulas: Vec<Formula> = texts.iter().map(|text| parse(text)).collect();
            Atoms::of(&formulas).roots.iter().map(|root| Formula::Root(root.clone()).to_string()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(roots(&["sqrt(2)*sqrt(13)*sqrt(137)", "sqrt(3562)/2"]), "sqrt(3562)");
        assert_eq!(roots(&["sqrt(6)", "sqrt(10)", "1 + sqrt(21)"]), "sqrt(2) sqrt(3) sqrt(5) sqrt(7)");
        // Primes beyond trial division, one of them squared.
        let (p, q) = (10_007u64, 10_009u64);
        assert_eq!(roots(&[&format!("sqrt({})", p * p * q), &format!("sqrt({q})")]), format!("sqrt({p}) sqrt({q})"));
        let values = [(UBig::from(2u8), 2f64.sqrt()), (UBig::from(5u8), 5f64.sqrt())];
        let root = |n: u32| root_from_coprime(&UBig::from(n), 1.0, values.iter().map(|(n, root)| (n, *root)));
        assert!((root(40).expect("2³ · 5") - 40f64.sqrt()).abs() < 1e-12);
        assert_eq!(root(6), None);
    }

    #[test]
    fn angles_have_the_sine_and_cosine_of_their_points() {
        for (text, sine, cosine) in [
            ("atan(3/4)", "3/5", "4/5"),
            ("1/4*pi", "1/2*sqrt(2)", "1/2*sqrt(2)"),
            ("-3/4*pi", "-1/2*sqrt(2)", "-1/2*sqrt(2)"),
            ("1/2*pi - atan(3/4)", "4/5", "3/5"),
            ("-(pi - atan(3/4))", "-3/5", "-4/5"),
            ("-1/2*pi + atan(1/2)", "-2/5*sqrt(5)", "1/5*sqrt(5)"),
            ("pi", "0", "-1"),
            ("atan(1/3) + atan(1/2)", "sin(atan(1/3) + atan(1/2))", "cos(atan(1/3) + atan(1/2))"),
            ("0.7", "sin(7/10)", "cos(7/10)"),
        ] {
            let (s, c) = Formula::parse(text).expect("an angle").circle();
            assert_eq!((s.to_string(), c.to_string()), (sine.into(), cosine.into()), "{text}");
        }
        assert!(Formula::parse("atan(2)").is_err() && Formula::parse("atan(sqrt(1/2))").is_err());
    }

    #[test]
    fn atoms_come_before_what_holds_them() {
        let formula = Formula::parse("sqrt(2 + sqrt(3)) + cos(7/10)*sqrt(5)").expect("a formula");
        let atoms = Atoms::of([&formula]);
        assert_eq!(atoms.roots.len(), 3);
        assert_eq!(atoms.roots[0], Root::Integer(UBig::from(3u8)));
        assert_eq!(atoms.angles.len(), 1);
    }
}
