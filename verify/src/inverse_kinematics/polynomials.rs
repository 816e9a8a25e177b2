//! Polynomials in c and s of revolute joints and d of prismatic joints.
//!
//! The basis in c and s with c² + s² = 1 is 1, c, s, c², c s, c³, c² s ..., by index; the basis in d consists of its powers. The degree of
//! index i is i/2, rounded up: d² counts as much as c and s.

use std::collections::BTreeMap;

use super::modular::Modulus;

/// A polynomial of degree 1 (index 0, 1, 2 in each place) or 2: coefficients with the indices of their monomials.
#[derive(Clone, Debug)]
pub(super) struct Polynomial {
    pub(super) terms: Vec<(Vec<u8>, u64)>,
    /// 1 or 2, for every place.
    pub(super) degree: u8,
}

/// The exponents k and e of c^k s^e for an index; e is 0 or 1.
pub(super) fn power(index: u8) -> (u8, u8) {
    match (index, index % 2) {
        (0, _) => (0, 0),
        (_, 1) => (index.div_ceil(2), 0),
        _ => (index / 2 - 1, 1),
    }
}

fn index((k, e): (u8, u8)) -> u8 {
    match (k, e) {
        (0, 0) => 0,
        (_, 0) => 2 * k - 1,
        _ => 2 * (k + 1),
    }
}

/// The product of two basis elements in a joint: an element, and possibly another to subtract.
fn multiplied(slides: bool, x: u8, y: u8) -> (u8, Option<u8>) {
    if slides {
        return (x + y, None);
    }
    let ((k, e), (l, f)) = (power(x), power(y));
    if e + f == 2 {
        (index((k + l, 0)), Some(index((k + l + 2, 0))))
    } else {
        (index((k + l, e + f)), None)
    }
}

/// Adds `factor` x y to a sum.
pub(super) fn add_product(m: Modulus, slides: &[bool], x: &[u8], y: &[u8], factor: u64, add: &mut impl FnMut(&[u8], u64)) {
    let parts: Vec<(u8, Option<u8>)> = slides.iter().zip(x.iter().zip(y)).map(|(s, (x, y))| multiplied(*s, *x, *y)).collect();
    let mut monomial: Vec<u8> = parts.iter().map(|part| part.0).collect();
    let choices: Vec<usize> = (0..parts.len()).filter(|i| parts[*i].1.is_some()).collect();
    for choice in 0..1usize << choices.len() {
        for (bit, place) in choices.iter().enumerate() {
            let (first, second) = parts[*place];
            monomial[*place] = if choice >> bit & 1 == 1 { second.unwrap_or(first) } else { first };
        }
        add(&monomial, if choice.count_ones() % 2 == 1 { m.negated(factor) } else { factor });
    }
}

/// The product x y of two polynomials of degree 1.
pub(super) fn product(m: Modulus, slides: &[bool], x: &Polynomial, y: &Polynomial) -> Polynomial {
    let mut sum = BTreeMap::<Vec<u8>, u64>::new();
    for (a, c) in &x.terms {
        for (b, d) in &y.terms {
            add_product(m, slides, a, b, m.times(*c, *d), &mut |monomial, value| {
                let entry = sum.entry(monomial.to_vec()).or_insert(0);
                *entry = m.plus(*entry, value);
            });
        }
    }
    Polynomial { terms: sum.into_iter().filter(|(_, c)| *c != 0).collect(), degree: x.degree + y.degree }
}

/// x + y, or x - y.
pub(super) fn sum(m: Modulus, x: Polynomial, y: Polynomial, minus: bool) -> Polynomial {
    let degree = x.degree.max(y.degree);
    let mut sum: BTreeMap<Vec<u8>, u64> = x.terms.into_iter().collect();
    for (monomial, c) in y.terms {
        let entry = sum.entry(monomial).or_insert(0);
        *entry = if minus { m.minus(*entry, c) } else { m.plus(*entry, c) };
    }
    Polynomial { terms: sum.into_iter().filter(|(_, c)| *c != 0).collect(), degree }
}

/// The monomials c and s of each revolute joint and d of each prismatic joint.
pub(super) fn generators_of(slides: &[bool]) -> Vec<Vec<u8>> {
    let mut generators = Vec::new();
    for (place, slides_here) in slides.iter().enumerate() {
        for index in 1..=if *slides_here { 1 } else { 2 } {
            let mut generator = vec![0; slides.len()];
            generator[place] = index;
            generators.push(generator);
        }
    }
    generators
}
