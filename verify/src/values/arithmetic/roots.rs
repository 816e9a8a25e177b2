//! Which square roots follow from others, with their real signs.
//!
//! A field of residues has two square roots of a number, and nothing in it says which of them is the positive one. Where the roots are
//! independent this does not matter: the field of numbers that they generate has automorphisms for all choices of signs, so that an equality
//! with one choice is an equality with the true one. `sqrt(2 + sqrt(3))` and `sqrt(2 - sqrt(3))` are not independent: their product is 1, and -1
//! for half of all choices. Here such roots are found, and written in terms of the others.
//!
//! The roots of integers without common factors, none of them a square, are independent. Let L be the field of those that occur under
//! nested roots sqrt(x_1), sqrt(x_2), ..., x_i in L, and d_1, d_2, ... the other integers. By Kummer's theory sqrt(x_i) lies in the field
//! of L, the sqrt(d_j) and the sqrt(x_k) before it if and only if
//!
//! ```text
//! x_i Π_(j in D) d_j Π_(k in E) x_k = y²,   y in L,   for some D and E;   then   sqrt(x_i) = |y| / (Π sqrt(d_j) Π sqrt(x_k))
//! ```
//!
//! D and E are found by linear algebra over the field of two elements: under random homomorphisms from L to prime fields a square stays a
//! square, and what is none becomes one with odds of ½. So what is called independent *is* independent; what seems to depend is proved by
//! finding y, whose sign is that of an enclosure.

use dashu_base::{Signed, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, UBig};

use super::prime::{Prime, Residue};
use super::tower::{Coordinates, Tower};
use super::Arithmetic;
use crate::values::element::Element;
use crate::values::enclosure::enclose;
use crate::values::formula::{Atoms, Dependent, Formula, Rational, Root};
use crate::values::stream::Stream;

/// As many roots of integers may occur under dependent nested roots: to find y costs up to 3^k operations.
const MOST_INNER_ROOTS: usize = 8;

/// Homomorphisms beyond the number of roots: what is no product of the others passes for one with odds of 2^-64.
const MORE_HOMOMORPHISMS: usize = 64;

/// The roots among `atoms` that follow from others; an error where that cannot be decided.
pub fn dependent(atoms: &Atoms) -> Result<Dependent, String> {
    let nested: Vec<&Formula> = atoms.roots.iter().filter_map(Root::nested).collect();
    if nested.is_empty() {
        return Ok(Dependent::new());
    }
    let inner = Atoms::of(nested.iter().copied());
    if let Some(Root::Nested(deep)) = inner.roots.iter().find(|root| root.nested().is_some()) {
        return Err(format!("the sign of sqrt({deep}), a root inside of a root inside of a root, cannot be told"));
    }
    // In the parts that all roots of integers together have.
    let integers = || atoms.roots.iter().filter_map(Root::integer);
    let divides = |n: &UBig| inner.roots.iter().filter_map(Root::integer).any(|m| (m % n).is_zero());
    let (below, others): (Vec<&UBig>, Vec<&UBig>) = integers().partition(|n| divides(n));
    let field = Atoms { roots: below.iter().map(|n| Root::Integer((*n).clone())).collect(), angles: inner.angles.clone() };
    let columns: Vec<Formula> = others
        .iter()
        .map(|n| Formula::Rational(Rational::from((*n).clone())))
        .chain(nested.iter().map(|x| (*x).clone()))
        .collect();
    let rows = characters(&field, &columns)?;
    let mut found = Dependent::new();
    let mut independent: Vec<usize> = (0..others.len()).collect();
    for i in others.len()..columns.len() {
        match combination(&rows, &independent, i) {
            None => independent.push(i),
            Some(factors) => {
                let root = root_by_others(&field, &columns, i, &factors)?;
                found.insert(Root::Nested(Box::new(columns[i].clone())), root);
            }
        }
    }
    Ok(found)
}

/// Whether the numbers are squares (false) or not (true) under random homomorphisms: a row for each of these.
fn characters(field: &Atoms, numbers: &[Formula]) -> Result<Vec<Vec<bool>>, String> {
    let mut stream = Stream::new(0x726f_6f74);
    let mut rows = Vec::new();
    while rows.len() < numbers.len() + MORE_HOMOMORPHISMS {
        let prime = Prime::any(&mut stream, field).ok_or("too many roots under nested roots")?;
        let of = |number: &Formula| prime.constant(number).filter(|x| !x.is_zero()).map(Residue::is_no_square);
        // A homomorphism under which a denominator or a number is 0 says nothing.
        rows.extend(numbers.iter().map(of).collect::<Option<Vec<bool>>>());
    }
    Ok(rows)
}

/// The columns among `independent` that sum up to column `i`, modulo 2.
fn combination(rows: &[Vec<bool>], independent: &[usize], i: usize) -> Option<Vec<usize>> {
    // Row by row: coefficients of the independent columns, then the right-hand side.
    let mut system: Vec<Vec<bool>> =
        rows.iter().map(|row| independent.iter().map(|&j| row[j]).chain([row[i]]).collect()).collect();
    let mut pivots: Vec<Option<usize>> = Vec::new();
    let mut used = 0;
    for column in 0..independent.len() {
        let Some(at) = (used..system.len()).find(|&r| system[r][column]) else {
            pivots.push(None);
            continue;
        };
        system.swap(used, at);
        let pivot = system[used].clone();
        for (r, row) in system.iter_mut().enumerate() {
            if r != used && row[column] {
                row.iter_mut().zip(&pivot).for_each(|(x, p)| *x ^= p);
            }
        }
        pivots.push(Some(used));
        used += 1;
    }
    let last = independent.len();
    if system[used..].iter().any(|row| row[last]) {
        return None;
    }
    let chosen = |(column, pivot): (usize, &Option<usize>)| pivot.filter(|&r| system[r][last]).map(|_| independent[column]);
    Some(pivots.iter().enumerate().filter_map(chosen).collect())
}

/// sqrt(x_i) = |y|/(Π sqrt of the factors).
fn root_by_others(field: &Atoms, columns: &[Formula], i: usize, factors: &[usize]) -> Result<Formula, String> {
    let undecided =
        || format!("whether sqrt({}) follows from other roots cannot be decided: write it in another way", columns[i]);
    let algebraic = factors.iter().chain([&i]).all(|&j| !has_free_atoms(&columns[j]));
    if field.roots.len() > MOST_INNER_ROOTS || !algebraic {
        return Err(undecided());
    }
    let tower = Tower::of_integers(&field.roots);
    let product = factors.iter().try_fold(tower.constant(&columns[i]).ok_or_else(undecided)?, |product, &j| {
        tower.constant(&columns[j]).map(|x| product.times(&x)).ok_or_else(undecided)
    })?;
    let y = square_root(product.squares(), product.coordinates()).ok_or_else(undecided)?;
    let y = in_roots(&field.roots, &y);
    let (low, high) = enclose(&y, 1024).ok_or_else(undecided)?;
    if low.is_negative() != high.is_negative() || low.is_zero() || high.is_zero() {
        return Err(undecided());
    }
    let size = if low.is_negative() { y.negated() } else { y };
    let root_of = |j: usize| match &columns[j] {
        Formula::Rational(n) => Formula::Root(Root::Integer(n.numerator().unsigned_abs())),
        x => Formula::Root(Root::Nested(Box::new(x.clone()))),
    };
    let inverse = |j: &usize| Formula::Power(Box::new(root_of(*j)), -1);
    Ok(Formula::Product([size].into_iter().chain(factors.iter().map(inverse)).collect()))
}

/// Whether a number holds pi or an angle, for which a field takes any value.
fn has_free_atoms(formula: &Formula) -> bool {
    match formula {
        Formula::Rational(_) | Formula::Root(Root::Integer(_)) => false,
        // What a description has under its roots is not defined elsewhere.
        Formula::Pi | Formula::Sine(_) | Formula::Cosine(_) | Formula::Arctangent(_) | Formula::Defined(_) => true,
        Formula::Root(Root::Nested(inner)) | Formula::Power(inner, _) => has_free_atoms(inner),
        Formula::Sum(parts) | Formula::Product(parts) => parts.iter().any(has_free_atoms),
    }
}

/// The number with these coordinates over the products of roots.
fn in_roots(roots: &[Root], coordinates: &Coordinates) -> Formula {
    let term = |(place, x): (usize, Rational)| {
        let factors = roots.iter().enumerate().filter(|(level, _)| place >> level & 1 == 1);
        factors.fold(Formula::Rational(x), |term, (_, root)| term.times(&Formula::Root(root.clone())))
    };
    let terms = coordinates.fractions().enumerate().filter(|(_, x)| !x.is_zero()).map(term);
    terms.reduce(|a, b| a.plus(&b)).unwrap_or(Formula::Rational(Rational::ZERO))
}

fn rational_root(x: &Rational) -> Option<Rational> {
    if x.is_negative() {
        return None;
    }
    let whole = |n: UBig| {
        let root = n.sqrt();
        (&root * &root == n).then_some(root)
    };
    Some(Rational::from_parts(IBig::from(whole(x.numerator().unsigned_abs())?), whole(x.denominator().clone())?))
}

/// A square root in a tower, if there is one: (u + v√d)² = x + y√d has u² = (x ± n)/2 with n² = x² - d y², and v = y/(2u).
fn square_root(squares: &[Vec<IBig>], a: &Coordinates) -> Option<Coordinates> {
    if a.is_zero() {
        return Some(a.clone());
    }
    let Some((d, below)) = squares.split_last() else {
        return Some(Coordinates::rational(&rational_root(&a.fractions().next()?)?, 1));
    };
    let d = Coordinates::new(d.clone(), UBig::ONE);
    let (x, y) = a.halves();
    let rational = |value: &Rational| Coordinates::rational(value, 1 << below.len());
    let nothing = rational(&Rational::ZERO);
    if y.is_zero() {
        if let Some(u) = square_root(below, &x) {
            return Some(Coordinates::joined(&u, &nothing));
        }
        let v = square_root(below, &x.times(below, &d.inverse(below)?))?;
        return Some(Coordinates::joined(&nothing, &v));
    }
    let norm = x.times(below, &x).plus(&y.times(below, &y).times(below, &d).negated());
    let n = square_root(below, &norm)?;
    let half = rational(&Rational::from_parts(1.into(), 2u8.into()));
    [n.clone(), n.negated()].into_iter().find_map(|n| {
        let u = square_root(below, &x.plus(&n).times(below, &half)).filter(|u| !u.is_zero())?;
        let v = y.times(below, &u.inverse(below)?.times(below, &half));
        Some(Coordinates::joined(&u, &v))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(texts: &[&str]) -> Result<Vec<String>, String> {
        let formulas: Vec<Formula> = texts.iter().map(|text| Formula::parse(text).expect("a formula")).collect();
        let found = dependent(&Atoms::of(&formulas))?;
        for (root, by) in &found {
            // The same number to 300 digits.
            let difference = Formula::Root(root.clone()).minus(by);
            let (low, high) = enclose(&difference, 1000).expect("a number");
            let tiny = Rational::from_parts(1.into(), UBig::ONE << 990);
            assert!(-tiny.clone() < low && low <= high && high < tiny, "{difference}");
        }
        Ok(found.keys().map(|root| Formula::Root(root.clone()).to_string()).collect())
    }

    #[test]
    fn products_that_are_squares_are_found_with_their_signs() {
        // Their product is 1; with sqrt(2) both are (sqrt(6) ± sqrt(2))/2.
        assert_eq!(found(&["sqrt(2 + sqrt(3))", "sqrt(2 - sqrt(3))"]).unwrap(), ["sqrt(2 - sqrt(3))"]);
        assert_eq!(found(&["sqrt(2 + sqrt(3))", "sqrt(2)"]).unwrap(), ["sqrt(2 + sqrt(3))"]);
        // Sines of a tenth and of a fifth of a turn: their product is sqrt(5)/4.
        assert_eq!(found(&["sqrt(5/8 - 1/8*sqrt(5))", "sqrt(5/8 + 1/8*sqrt(5))"]).unwrap().len(), 1);
        // 3 - 2 sqrt(2) = (sqrt(2) - 1)², 5 + 2 sqrt(6) = (sqrt(2) + sqrt(3))².
        assert_eq!(found(&["sqrt(3 - 2*sqrt(2))"]).unwrap().len(), 1);
        assert_eq!(found(&["sqrt(5 + 2*sqrt(6))"]).unwrap().len(), 0);
        assert_eq!(found(&["sqrt(5 + 2*sqrt(6))", "sqrt(2)"]).unwrap().len(), 1);
        // Each alone is a new number.
        assert_eq!(found(&["sqrt(7 + sqrt(2))", "sqrt(5 - sqrt(3))", "sqrt(1 + sqrt(5))"]).unwrap().len(), 0);
        assert_eq!(found(&["sqrt(2 + pi)", "sqrt(3 + pi)", "sqrt(cos(7/10))"]).unwrap().len(), 0);
    }

    #[test]
    fn what_cannot_be_decided_is_said() {
        let said = |texts: &[&str]| found(texts).unwrap_err();
        assert!(said(&["sqrt(pi)", "sqrt(4*pi)"]).contains("cannot be decided"));
        assert!(said(&["sqrt(1 + sqrt(1 + sqrt(2)))"]).contains("cannot be told"));
    }
}
