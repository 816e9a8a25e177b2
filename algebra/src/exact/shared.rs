//! Constants that are not multiplied out.
//!
//! A product of rotations by general angles has more terms with every rotation: multiplied out, the constants of an arm would grow
//! exponentially with its joints. [`Number::plus`] and [`Number::times`] therefore multiply out what stays short, and take a longer operand as
//! one factor, an [`Atom::Sum`], that all results share:
//!
//! ```text
//! x y = X Y    with X = Σ of the terms of x,  Y = Σ of the terms of y
//! ```
//!
//! A constant is then a graph whose size grows with the number of operations. It has no normal form: two graphs may have one value. Whoever
//! has to know compares values, in a prime field and by enclosures (`Pool::constant`, in the module `ring`).
//!
//! A graph is as deep as a chain of joints is long. Nothing that reads it calls itself once for each level: whoever needs values of what is inside
//! takes them in the order of [`Number::shared_inside`]; comparisons and texts end at a sum.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Deref;
use std::sync::Arc;

use super::enclosure::Known;
use super::{multiply_monomials, Atom, Monomial, Number};
use crate::scramble::scramble;

/// A sum or a product of more terms is not multiplied out.
pub(super) const MOST_TERMS: usize = 32;

/// A number that atoms share, with the enclosures that are known.
#[derive(Default)]
pub struct Shared {
    number: Number,
    pub(super) sine: Known,
    pub(super) cosine: Known,
    /// Of what else an atom may be of it: the number itself, its root, its inverse.
    pub(super) own: Known,
}

impl Shared {
    pub(super) fn new(number: Number) -> Arc<Shared> {
        Arc::new(Shared { number, sine: Known::default(), cosine: Known::default(), own: Known::default() })
    }
}

/// What it alone holds is taken apart here, level by level, not by the drops of what is inside.
impl Drop for Shared {
    fn drop(&mut self) {
        let mut open = vec![std::mem::take(&mut self.number)];
        while let Some(number) = open.pop() {
            for (atom, _) in number.terms.into_keys().flatten() {
                let inner = match atom {
                    Atom::RootOf(of) | Atom::Sine(of) | Atom::Cosine(of) | Atom::Inverse(of) => Some(of),
                    Atom::Sum(sum) => Arc::into_inner(sum).map(|sum| sum.terms),
                    Atom::Root(_) | Atom::Pi | Atom::Arctangent(_) => None,
                };
                open.extend(inner.and_then(Arc::into_inner).map(|mut alone| std::mem::take(&mut alone.number)));
            }
        }
    }
}

impl Deref for Shared {
    type Target = Number;
    fn deref(&self) -> &Number {
        &self.number
    }
}

impl fmt::Debug for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.number.fmt(f)
    }
}

impl fmt::Display for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.number.fmt(f)
    }
}

impl PartialEq for Shared {
    fn eq(&self, other: &Shared) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Shared {}

impl PartialOrd for Shared {
    fn partial_cmp(&self, other: &Shared) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Shared {
    fn cmp(&self, other: &Shared) -> Ordering {
        if std::ptr::eq(self, other) {
            return Ordering::Equal;
        }
        self.number.cmp(&other.number)
    }
}

impl Hash for Shared {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.number.hash(state);
    }
}

/// A sum that is one factor. Sums are told apart by 128 bits that follow from their text, in which the sums inside them stand as such
/// bits: comparing two graphs node by node would take exponential time.
#[derive(Clone)]
pub struct Sum {
    digest: [u64; 2],
    terms: Arc<Shared>,
    /// How many terms it would have multiplied out.
    multiplied_out: usize,
}

impl Sum {
    fn of(number: &Number) -> Sum {
        let text = Digested(number).to_string();
        let digest = [1, 2].map(|lane| {
            let words = text.as_bytes().chunks(8).map(|bytes| bytes.iter().fold(0, |word, &byte| word << 8 | u64::from(byte)));
            words.fold(scramble(lane), |hash, word| scramble(hash ^ word))
        });
        Sum { digest, terms: Shared::new(number.clone()), multiplied_out: number.terms_multiplied_out() }
    }

    /// The sum that it is.
    pub fn terms(&self) -> &Arc<Shared> {
        &self.terms
    }
}

/// By its bits: written out, a graph would be a text of exponential length.
impl fmt::Debug for Sum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Sum({:x?})", self.digest)
    }
}

impl PartialEq for Sum {
    fn eq(&self, other: &Sum) -> bool {
        self.digest == other.digest
    }
}

impl Eq for Sum {}

impl PartialOrd for Sum {
    fn partial_cmp(&self, other: &Sum) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Sum {
    fn cmp(&self, other: &Sum) -> Ordering {
        self.digest.cmp(&other.digest)
    }
}

impl Hash for Sum {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.digest.hash(state);
    }
}

/// The text of a number with the digests of the sums inside.
struct Digested<'a>(&'a Number);

impl fmt::Display for Digested<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (monomial, coefficient) in self.0.terms() {
            write!(f, "+{coefficient}")?;
            for (atom, power) in monomial {
                match atom {
                    Atom::Sum(sum) => write!(f, "*{:x?}^{power}", sum.digest)?,
                    Atom::Inverse(of) => write!(f, "*1/({})^{power}", Digested(of))?,
                    Atom::RootOf(of) => write!(f, "*sqrt({})^{power}", Digested(of))?,
                    other => write!(f, "*{other:?}^{power}")?,
                }
            }
        }
        Ok(())
    }
}

impl Number {
    /// Whether a sum in it is not multiplied out, so that it may look different from a number of the same value.
    pub fn is_shared(&self) -> bool {
        self.terms.keys().flatten().any(|(atom, _)| match atom {
            Atom::Sum(_) => true,
            Atom::Inverse(of) | Atom::RootOf(of) => of.is_shared(),
            _ => false,
        })
    }

    /// Whether there are roots among the factors of its terms.
    pub fn has_roots(&self) -> bool {
        self.terms.keys().flatten().any(|(atom, _)| matches!(atom, Atom::Root(_) | Atom::RootOf(_)))
    }

    /// The atoms in it that hold other numbers (sums, inverses, nested roots; sines and cosines of angles that hold some), those inside others before
    /// these, each once; those that are `known` and what they hold are left out. Sums may be as deep as an arm has joints.
    pub(crate) fn shared_inside(&self, known: &dyn Fn(&Atom) -> bool) -> Vec<Atom> {
        let inside = |number: &Number| -> Vec<(Atom, bool)> {
            let atoms = number.terms.keys().flatten().map(|(atom, _)| atom).rev();
            atoms.filter(|atom| holds_others(atom) && !known(atom)).map(|atom| (atom.clone(), false)).collect()
        };
        let (mut found, mut seen, mut open) = (Vec::new(), BTreeSet::new(), inside(self));
        while let Some((atom, ready)) = open.pop() {
            if ready {
                found.push(atom);
                continue;
            }
            if !seen.insert(atom.clone()) {
                continue;
            }
            let inner = match &atom {
                Atom::Sum(sum) => inside(sum.terms()),
                Atom::Inverse(of) | Atom::RootOf(of) | Atom::Sine(of) | Atom::Cosine(of) => inside(of),
                Atom::Root(_) | Atom::Pi | Atom::Arctangent(_) => Vec::new(),
            };
            open.push((atom, true));
            open.extend(inner);
        }
        found
    }

    /// How many terms it would have multiplied out, if nothing cancelled.
    pub fn terms_multiplied_out(&self) -> usize {
        let of_factor = |(atom, power): &(Atom, i32)| match atom {
            Atom::Sum(sum) => sum.multiplied_out.saturating_pow(power.unsigned_abs()),
            _ => 1,
        };
        let of_term = |monomial: &Monomial| monomial.iter().map(of_factor).fold(1, usize::saturating_mul);
        self.terms.keys().map(of_term).fold(0, usize::saturating_add)
    }

    /// The sum, in which a long operand becomes one factor.
    pub fn plus(&self, other: &Number) -> Number {
        let (a, b) = (self.terms.len(), other.terms.len());
        if a + b <= MOST_TERMS {
            return self + other;
        }
        let sum = self + other;
        if sum.terms.len() <= MOST_TERMS {
            return sum;
        }
        match (a > b, 2 * a.min(b) > MOST_TERMS) {
            (_, true) => &self.as_factor() + &other.as_factor(),
            (true, _) => &self.as_factor() + other,
            (false, _) => self + &other.as_factor(),
        }
    }

    /// The difference, likewise.
    pub fn minus(&self, other: &Number) -> Number {
        self.plus(&-other)
    }

    /// The product, multiplied out where that is short.
    pub fn times(&self, other: &Number) -> Number {
        self.expanded(other).unwrap_or_else(|| self.product_of_factors(other))
    }

    /// The product multiplied out, if it has few terms.
    fn expanded(&self, other: &Number) -> Option<Number> {
        if self.terms.len() * other.terms.len() > MOST_TERMS {
            return None;
        }
        let mut product = Number::zero();
        for (a, p) in &self.terms {
            for (b, q) in &other.terms {
                // Each squared sine, 1 - cos², doubles the terms.
                if squared_sines(a, b) > MOST_TERMS.ilog2() as usize {
                    return None;
                }
                let coefficient = p * q;
                for (monomial, c) in multiply_monomials(a, b).terms {
                    product.add_term(monomial, c * &coefficient);
                }
            }
        }
        (product.terms.len() <= MOST_TERMS).then_some(product)
    }

    /// The product of operands of several terms as they are; of products that share sines the second as one factor.
    fn product_of_factors(&self, other: &Number) -> Number {
        let (a, b) = (self.as_factor(), other.as_factor());
        a.expanded(&b).unwrap_or_else(|| {
            let b = Number::atom(Atom::Sum(Arc::new(Sum::of(&b))));
            &a * &b
        })
    }

    /// The number as one term.
    pub(super) fn as_factor(&self) -> Number {
        if self.terms.len() < 2 {
            return self.clone();
        }
        Number::atom(Atom::Sum(Arc::new(Sum::of(self))))
    }
}

impl Atom {
    /// Whether the number that it shares is enclosed to so many places already.
    pub(super) fn is_enclosed(&self, places: usize) -> bool {
        match self {
            Atom::RootOf(of) | Atom::Inverse(of) => of.own.has(places),
            Atom::Sum(sum) => sum.terms().own.has(places),
            _ => false,
        }
    }
}

fn holds_others(atom: &Atom) -> bool {
    let number = |atom: &Atom| matches!(atom, Atom::Sum(_) | Atom::Inverse(_) | Atom::RootOf(_));
    match atom {
        Atom::Sine(angle) | Atom::Cosine(angle) => angle.terms.keys().flatten().any(|(atom, _)| number(atom)),
        atom => number(atom),
    }
}

/// How many sines a product of two monomials squares.
fn squared_sines(a: &Monomial, b: &Monomial) -> usize {
    let sines = |monomial: &Monomial| -> BTreeMap<Arc<Shared>, i32> {
        let sine = |(atom, power): &(Atom, i32)| match atom {
            Atom::Sine(angle) => Some((angle.clone(), *power)),
            _ => None,
        };
        monomial.iter().filter_map(sine).collect()
    };
    let a = sines(a);
    if a.is_empty() {
        return 0;
    }
    sines(b).iter().filter(|(angle, power)| a.get(*angle).is_some_and(|own| own + **power == 2)).count()
}
