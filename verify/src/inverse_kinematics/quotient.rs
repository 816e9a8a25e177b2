//! The quotient algebra of polynomials modulo the equations of a pose. Its dimension is the number of complex solutions with multiplicities.
//!
//! Isotropic points, 1 + tan² = 0, are at infinity in c and s and do not count. Elimination covers all products of the equations up to a degree
//! bound in each joint, highest degrees first. Monomials without a pivot form a basis of the algebra, and every other monomial has a normal
//! form in it. Mourrain's criterion (1999) proves that the bound was high enough: the multiplication matrices of c, s and d exist, commute, and
//! give every monomial its normal form. The dimension is then exact.

use super::forms::System;
use super::modular::Modulus;
use super::polynomials::{add_product, generators_of, power};

/// The algebra, with the data that determined its basis.
#[derive(Clone, Debug)]
pub(super) struct Quotient {
    modulus: Modulus,
    /// Number of solutions.
    pub(super) dimension: usize,
    /// Whether Mourrain's criterion holds.
    pub(super) exact: bool,
    /// The multiplication matrices of c and s of each revolute joint and d of each prismatic joint; columns are images of basis elements.
    generators: Vec<Option<Matrix>>,
    /// The normal form of 1.
    one: Vec<u64>,
    /// The independent products; other primes need only these.
    pub(super) recipe: Vec<Step>,
}

/// Columns.
type Matrix = Vec<Vec<u64>>;

/// A product in the elimination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The product of an equation and the monomial with this number.
    Equation(usize),
    /// The product of a pivot's row and the generator with this number.
    Row(usize, usize),
}

/// Monomials up to a degree in each place, in order of their number.
struct Monomials {
    sizes: Vec<usize>,
}

impl Monomials {
    fn new(bound: &[u8]) -> Monomials {
        Monomials { sizes: bound.iter().map(|degree| 2 * usize::from(*degree) + 1).collect() }
    }

    fn count(&self) -> usize {
        self.sizes.iter().product()
    }

    fn number(&self, monomial: &[u8]) -> Option<usize> {
        let mut digits = monomial.iter().zip(&self.sizes);
        digits.try_fold(0, |number, (i, size)| (usize::from(*i) < *size).then(|| number * size + usize::from(*i)))
    }

    fn at(&self, mut number: usize) -> Vec<u8> {
        let mut monomial = vec![0; self.sizes.len()];
        for (i, size) in monomial.iter_mut().zip(&self.sizes).rev() {
            *i = (number % size) as u8;
            number /= size;
        }
        monomial
    }
}

impl Quotient {
    /// The algebra of a system with products up to a degree in each joint; with a `recipe`, only its products. `None` if the degree is too low or
    /// there are infinitely many solutions.
    pub(super) fn of(m: Modulus, system: &System, bound: &[u8], region: &[u8], recipe: Option<&[Step]>) -> Option<Quotient> {
        let all = Monomials::new(bound);
        // Highest degrees first.
        let mut order: Vec<usize> = (0..all.count()).collect();
        order.sort_by_key(|number| {
            let degrees = all.at(*number).into_iter().map(|i| i.div_ceil(2));
            let outside = degrees.clone().zip(region).any(|(degree, most)| degree > *most);
            (std::cmp::Reverse((outside, degrees.clone().max(), degrees.sum::<u8>())), *number)
        });
        let mut column = vec![0; order.len()];
        for (place, number) in order.iter().enumerate() {
            column[*number] = place;
        }
        let width = order.len();
        let mut pivots: Vec<Option<Vec<u64>>> = vec![None; width];
        // The row of a sum of monomials, times another monomial.
        let multiple = |terms: &mut dyn Iterator<Item = (&[u8], u64)>, factor: &[u8]| {
            let mut row = vec![0; width];
            for (monomial, c) in terms {
                add_product(m, &system.slides, monomial, factor, c, &mut |monomial, value| {
                    if let Some(number) = all.number(monomial) {
                        row[column[number]] = m.plus(row[column[number]], value);
                    }
                });
            }
            row
        };
        let mut used = Vec::new();
        let mut number = 0;
        for equation in &system.equations {
            let left: Option<Vec<u8>> = bound.iter().map(|degree| degree.checked_sub(equation.degree)).collect();
            let Some(left) = left else { continue };
            let by = Monomials::new(&left);
            for factor in 0..by.count() {
                let step = Step::Equation(number);
                number += 1;
                if recipe.is_none_or(|recipe| recipe.get(used.len()) == Some(&step)) {
                    let terms = &mut equation.terms.iter().map(|(monomial, c)| (monomial.as_slice(), *c));
                    if reduce(m, &mut pivots, multiple(terms, &by.at(factor))).is_some() {
                        used.push(step);
                    }
                }
            }
        }
        // Rows of a lower degree than the bound are multiplied again, until no new row arises.
        let monomials: Vec<Vec<u8>> = order.iter().map(|number| all.at(*number)).collect();
        let low = order.len()
            - order
                .iter()
                .rev()
                .take_while(|number| all.at(**number).iter().zip(bound).all(|(i, degree)| i.div_ceil(2) < *degree))
                .count();
        let generators = generators_of(&system.slides);
        let mut waiting: Vec<usize> = (low..width).filter(|place| pivots[*place].is_some()).collect();
        while let Some(place) = waiting.pop() {
            for (number, generator) in generators.iter().enumerate() {
                let step = Step::Row(place, number);
                if !recipe.is_none_or(|recipe| recipe.get(used.len()) == Some(&step)) {
                    continue;
                }
                let Some(row) = &pivots[place] else { continue };
                let terms =
                    &mut monomials.iter().map(Vec::as_slice).zip(row.iter().copied()).skip(place).filter(|(_, c)| *c != 0);
                let row = multiple(terms, generator);
                if let Some(new) = reduce(m, &mut pivots, row) {
                    used.push(step);
                    if new >= low {
                        waiting.push(new);
                    }
                }
            }
        }
        let inside = Monomials::new(region);
        let first = width - inside.count();
        let basis: Vec<usize> = (first..width).filter(|place| pivots[*place].is_none()).collect();
        let dimension = basis.len();
        if dimension > MOST {
            return None;
        }
        // Normal forms, lowest monomials first.
        let mut normal = vec![Vec::new(); width];
        for place in (first..width).rev() {
            let mut form = vec![0; dimension];
            match &pivots[place] {
                None => form[basis.binary_search(&place).ok()?] = m.one,
                Some(row) => {
                    for (other, c) in row.iter().enumerate().skip(place + 1).filter(|(_, c)| **c != 0) {
                        m.add_multiple(&mut form, m.negated(*c), &normal[other]);
                    }
                }
            }
            normal[place] = form;
        }
        let image = |element: &usize, generator: &[u8]| -> Option<Vec<u64>> {
            let (mut form, mut known) = (vec![0; dimension], true);
            add_product(m, &system.slides, &monomials[*element], generator, m.one, &mut |monomial, value| match all
                .number(monomial)
                .filter(|_| inside.number(monomial).is_some())
            {
                Some(number) => m.add_multiple(&mut form, value, &normal[column[number]]),
                None => known = false,
            });
            known.then_some(form)
        };
        let matrix = |generator: &Vec<u8>| basis.iter().map(|element| image(element, generator)).collect::<Option<Vec<_>>>();
        let generators: Vec<Option<Matrix>> = generators.iter().map(matrix).collect();
        let one = normal[column[0]].clone();
        let mut quotient = Quotient { modulus: m, dimension, generators, one, recipe: used, exact: false };
        quotient.exact = recipe.is_none()
            && quotient.commutes()
            && quotient
                .gives(&system.slides, &inside, |monomial| &normal[all.number(monomial).map_or(0, |number| column[number])]);
        Some(quotient)
    }

    fn apply(&self, matrix: &[Vec<u64>], vector: &[u64]) -> Vec<u64> {
        let mut image = vec![0; self.dimension];
        for (x, column) in vector.iter().zip(matrix) {
            self.modulus.add_multiple(&mut image, *x, column);
        }
        image
    }

    /// Whether all matrices exist and commute.
    fn commutes(&self) -> bool {
        let pairs = self.generators.iter().enumerate().flat_map(|(i, x)| self.generators[..=i].iter().map(move |y| (x, y)));
        pairs.into_iter().all(|pair| match pair {
            (Some(x), Some(y)) => (0..self.dimension).all(|k| self.apply(x, &y[k]) == self.apply(y, &x[k])),
            _ => false,
        })
    }

    /// Whether the matrices give every monomial its normal form, including c² + s² = 1.
    fn gives<'a>(&self, slides: &[bool], all: &Monomials, normal: impl Fn(&[u8]) -> &'a Vec<u64>) -> bool {
        let mut first = 0;
        let mut matrices = Vec::new();
        for slides in slides {
            let count = if *slides { 1 } else { 2 };
            let Some(pair) = self.generators[first..first + count].iter().map(Option::as_ref).collect::<Option<Vec<_>>>() else {
                return false;
            };
            matrices.push(pair);
            first += count;
        }
        let m = self.modulus;
        let circles = matrices.iter().filter(|pair| pair.len() == 2).all(|pair| {
            (0..self.dimension).all(|k| {
                let (mut sum, squared) = (self.apply(pair[0], &pair[0][k]), self.apply(pair[1], &pair[1][k]));
                m.add_multiple(&mut sum, m.one, &squared);
                sum.iter().enumerate().all(|(i, x)| *x == if i == k { m.one } else { 0 })
            })
        });
        circles
            && (0..all.count()).all(|number| {
                let monomial = all.at(number);
                let mut form = self.one.clone();
                for (place, index) in monomial.iter().enumerate() {
                    let (k, e) = if slides[place] { (*index, 0) } else { power(*index) };
                    for _ in 0..k {
                        form = self.apply(matrices[place][0], &form);
                    }
                    if e == 1 {
                        form = self.apply(matrices[place][1], &form);
                    }
                }
                form == *normal(&monomial)
            })
    }

    /// The minimal polynomial of the combination of c, s and d with these coefficients: monic, lowest coefficient first, without the leading
    /// coefficient.
    pub(super) fn minimal_polynomial(&self, coefficients: &[i64]) -> Vec<u64> {
        let m = self.modulus;
        let mut matrix = vec![vec![0; self.dimension]; self.dimension];
        for (generator, c) in self.generators.iter().zip(coefficients) {
            let Some(generator) = generator else { continue };
            for (column, x) in matrix.iter_mut().zip(generator) {
                m.add_multiple(column, m.integer(*c), x);
            }
        }
        // Its powers with their combinations, until a power depends on the previous ones.
        let n = self.dimension;
        let mut rows: Vec<Option<Vec<u64>>> = vec![None; n];
        let mut vector = self.one.clone();
        for degree in 0..=n {
            let mut row = vector.clone();
            row.resize(2 * n + 1, 0);
            row[n + degree] = m.one;
            let mut free = false;
            for place in 0..n {
                if row[place] == 0 {
                    continue;
                }
                if let Some(pivot) = &rows[place] {
                    let factor = m.negated(row[place]);
                    m.add_multiple(&mut row, factor, pivot);
                } else {
                    let over = m.inverse(row[place]);
                    row.iter_mut().for_each(|x| *x = m.times(*x, over));
                    rows[place] = Some(row.clone());
                    free = true;
                    break;
                }
            }
            if !free {
                return row[n..n + degree].to_vec();
            }
            vector = self.apply(&matrix, &vector);
        }
        Vec::new()
    }
}

/// Maximum number of solutions.
const MOST: usize = 64;

/// Adds a row to the pivots if it is independent of them; returns its place.
fn reduce(m: Modulus, pivots: &mut [Option<Vec<u64>>], mut row: Vec<u64>) -> Option<usize> {
    for place in 0..row.len() {
        if row[place] == 0 {
            continue;
        }
        match &pivots[place] {
            Some(pivot) => {
                let factor = m.negated(row[place]);
                m.add_multiple(&mut row[place..], factor, &pivot[place..]);
            }
            None => {
                let over = m.inverse(row[place]);
                row[place..].iter_mut().for_each(|x| *x = m.times(*x, over));
                pivots[place] = Some(row);
                return Some(place);
            }
        }
    }
    None
}
