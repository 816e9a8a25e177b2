//! Numbers as plain formulas: `1/2*sqrt(3) - 2*pi`. What several terms are divided by stands once: `(cos(7/10) - 2*pi)*(1/(1 + pi))`.
//!
//! Sums that are not multiplied out make a formula longer than anybody can read, or a machine print. For people those that are long stand as
//! decimals; for machines each is defined once, and the formulas refer to it ([`Definitions`]).

use std::collections::BTreeMap;
use std::fmt;

use dashu_base::{Abs, Signed};

use super::{Atom, Monomial, Number, Sum};

/// For people, sums of more terms and factors stand as decimals.
const READABLE: usize = 64;

impl Number {
    /// Whether people may want to read it as a formula.
    pub fn is_readable(&self) -> bool {
        self.is_within(READABLE)
    }
}

/// For people: exact as long as no sum stands as a decimal, which has the sign ≈ in front.
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |sum: &Sum| match sum.terms().is_readable() {
            true => format!("({})", sum.terms()),
            false => format!("(≈{:?})", sum.terms().to_f64()),
        };
        f.write_str(&text(self, &name))
    }
}

/// Formulas of numbers in which each sum that is not multiplied out has a name, `k0` and so on.
#[derive(Clone, Debug, Default)]
pub struct Definitions {
    names: BTreeMap<Sum, usize>,
    texts: Vec<String>,
}

impl Definitions {
    /// The formula of a number; the sums that it is made of are defined from now on.
    pub fn formula(&mut self, number: &Number) -> String {
        self.define(number);
        self.written(number)
    }

    /// The formula of a number whose sums are defined.
    fn written(&self, number: &Number) -> String {
        text(number, &|sum| format!("k{}", self.names[sum]))
    }

    /// The formulas of `k0`, `k1` and so on; each refers to those before it.
    pub fn texts(&self) -> &[String] {
        &self.texts
    }

    /// Defines the sums of a number, those inside others first.
    fn define(&mut self, number: &Number) {
        let known = |atom: &Atom| matches!(atom, Atom::Sum(sum) if self.names.contains_key(sum));
        for atom in number.shared_inside(&known) {
            if let Atom::Sum(sum) = atom {
                let formula = self.written(sum.terms());
                self.names.insert(Sum::clone(&sum), self.texts.len());
                self.texts.push(formula);
            }
        }
    }
}

/// The formula of a number in which sums that are not multiplied out have the text that `name` gives.
fn text(number: &Number, name: &dyn Fn(&Sum) -> String) -> String {
    if number.is_zero() {
        return "0".into();
    }
    let mut by_divisors: BTreeMap<Monomial, Number> = BTreeMap::new();
    for (monomial, coefficient) in &number.terms {
        let (divisors, rest) = split_divisors(monomial);
        by_divisors.entry(divisors).or_default().terms.insert(rest, coefficient.clone());
    }
    let mut formula = String::new();
    for (monomial, coefficient) in &number.terms {
        let (divisors, _) = split_divisors(monomial);
        let together = match by_divisors.get(&divisors) {
            _ if divisors.is_empty() => None,
            Some(sum) if sum.terms.len() == 1 => None,
            Some(_) => by_divisors.remove(&divisors),
            None => continue,
        };
        let negative = together.is_none() && coefficient.is_negative();
        formula += match (formula.is_empty(), negative) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        let size = coefficient.clone().abs();
        let mut factors: Vec<String> = Vec::new();
        let atoms = match &together {
            Some(sum) => {
                factors.push(format!("({})", text(sum, name)));
                &divisors
            }
            None => {
                if !size.is_one() || monomial.is_empty() {
                    factors.push(size.to_string());
                }
                monomial
            }
        };
        factors.extend(atoms.iter().map(|(atom, power)| power_text(atom, *power, name)));
        formula += &factors.join("*");
    }
    formula
}

/// What a term is divided by, and the rest of it.
fn split_divisors(monomial: &Monomial) -> (Monomial, Monomial) {
    monomial.iter().cloned().partition(|(atom, _)| matches!(atom, Atom::Inverse(_)))
}

fn power_text(atom: &Atom, power: i32, name: &dyn Fn(&Sum) -> String) -> String {
    let base = match atom {
        Atom::Root(n) => format!("sqrt({n})"),
        Atom::RootOf(n) => format!("sqrt({})", text(n, name)),
        Atom::Pi => "pi".into(),
        Atom::Sine(angle) => format!("sin({})", text(angle, name)),
        Atom::Cosine(angle) => format!("cos({})", text(angle, name)),
        Atom::Inverse(n) => format!("(1/({}))", text(n, name)),
        Atom::Arctangent(ratio) => format!("atan({ratio})"),
        Atom::Sum(sum) => name(sum),
    };
    match power {
        1 => base,
        ..=-1 => format!("{base}^({power})"),
        _ => format!("{base}^{power}"),
    }
}
