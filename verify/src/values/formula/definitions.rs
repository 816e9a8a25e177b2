//! Formulas that are defined once and referenced by name.
//!
//! ```text
//! k0 = 3/10*cos(7/10) - sin(7/10)    k1 = k0^2 + 1/4    ...
//! ```
//!
//! Each uses only earlier definitions, so the list is an acyclic graph. Values and enclosures are cached and computed in the order of the
//! list, without recursion, in time proportional to its length.

use std::cell::{Cell, RefCell};
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use dashu_base::BitTest;

use super::{root_of_rational, Formula, Rational, Root};
use crate::values::check::Check;
use crate::values::interval::Interval;

/// Prefix of a name; its number follows.
pub const PREFIX: &str = "k";

/// Maximum number of bits; no constant of a robot has more.
pub(super) const LARGEST: usize = 1 << 18;

/// Maximum depth of formulas and definitions; no constant of a robot is deeper.
const DEEPEST: usize = 8000;

/// A formula with a name.
pub struct Definition {
    index: usize,
    formula: Formula,
    /// Number of bits of its value before the point.
    size: usize,
    /// Nesting depth.
    depth: usize,
    /// A hash of its meaning, independent of names.
    hash: String,
    /// The definitions that it uses directly.
    refers: Vec<Arc<Definition>>,
    enclosures: Mutex<Vec<(usize, Option<Interval>)>>,
}

impl Definition {
    /// Its place in the list of definitions.
    pub fn index(&self) -> usize {
        self.index
    }

    /// `k0`.
    pub fn name(&self) -> String {
        format!("{PREFIX}{}", self.index)
    }

    /// Its formula.
    pub fn formula(&self) -> &Formula {
        &self.formula
    }

    /// The enclosure with this many bits; `enclose` computes it for a formula.
    pub(crate) fn enclosure(self: &Arc<Self>, bits: usize, enclose: impl Fn(&Formula) -> Option<Interval>) -> Option<Interval> {
        if let Some(known) = self.known(bits) {
            return known;
        }
        for definition in reachable(vec![self.clone()], |other| other.known(bits).is_some()) {
            let enclosed = enclose(&definition.formula);
            definition.enclosures.lock().unwrap_or_else(PoisonError::into_inner).push((bits, enclosed));
        }
        self.known(bits).flatten()
    }

    fn known(&self, bits: usize) -> Option<Option<Interval>> {
        let list = self.enclosures.lock().unwrap_or_else(PoisonError::into_inner);
        list.iter().find(|(of, _)| *of == bits).map(|(_, known)| known.clone())
    }
}

impl fmt::Debug for Definition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name())
    }
}

/// Positions identify the definitions of a list.
impl PartialEq for Definition {
    fn eq(&self, other: &Definition) -> bool {
        self.index == other.index
    }
}

impl Eq for Definition {}

impl PartialOrd for Definition {
    fn partial_cmp(&self, other: &Definition) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Definition {
    fn cmp(&self, other: &Definition) -> Ordering {
        self.index.cmp(&other.index)
    }
}

/// Limit on the cost of a module's formulas, in nanoseconds; an arm of 32 prismatic joints with general angles takes a fifth of it.
const MOST_WORK: u64 = 1 << 37;

/// Cost of copying and comparing a character, in nanoseconds.
const WORK_OF_CHARACTER: u64 = 50;

/// A list of definitions by number, with the remaining budget for them and for formulas that use them.
#[derive(Clone, Debug)]
pub struct Definitions {
    list: BTreeMap<usize, Arc<Definition>>,
    left: Cell<u64>,
    /// Cache of parsed texts, because most constants occur many times.
    read: RefCell<BTreeMap<String, Formula>>,
    /// Roots of fractions: each takes a trial division, and an arm has few.
    roots: RefCell<BTreeMap<Rational, Formula>>,
}

impl Default for Definitions {
    fn default() -> Definitions {
        Definitions { list: BTreeMap::new(), left: Cell::new(MOST_WORK), read: RefCell::default(), roots: RefCell::default() }
    }
}

impl Definitions {
    /// Parses a formula that may use these definitions; a cached formula only costs its length.
    pub fn formula(&self, text: &str) -> Result<Formula, String> {
        self.charge(WORK_OF_CHARACTER.saturating_mul(text.len() as u64))?;
        if let Some(known) = self.read.borrow().get(text) {
            return Ok(known.clone());
        }
        let formula = Formula::parse_with(text, self)?;
        self.read.borrow_mut().insert(text.into(), formula.clone());
        Ok(formula)
    }

    /// The square root of a fraction; a known one costs nothing, another `work`.
    pub(super) fn root(&self, value: &Rational, work: u64) -> Result<Formula, String> {
        if let Some(known) = self.roots.borrow().get(value) {
            return Ok(known.clone());
        }
        self.charge(work)?;
        let root = root_of_rational(value)?;
        self.roots.borrow_mut().insert(value.clone(), root.clone());
        Ok(root)
    }

    /// The spent fraction of the budget.
    #[cfg(test)]
    pub(crate) fn spent(&self) -> f64 {
        1.0 - self.left.get() as f64 / MOST_WORK as f64
    }

    /// Charges work before it is done.
    pub(super) fn charge(&self, work: u64) -> Result<(), String> {
        let left = self.left.get().checked_sub(work);
        if left.is_none() && Check::Work.is_made() {
            return Err("the formulas cost more than the constants of any robot".into());
        }
        self.left.set(left.unwrap_or(0));
        Ok(())
    }

    /// Parses the definition with this number. `bits` measures the bits of a value before the point, `None` if it is undefined.
    pub fn define(&mut self, index: usize, text: &str, bits: impl Fn(&Formula) -> Option<usize>) -> Result<(), String> {
        let formula = Formula::parse_with(text, self)?;
        let (most, depth) = (size(&formula), depth(&formula));
        if most > LARGEST || depth > DEEPEST {
            return Err(format!(
                "`{PREFIX}{index}` is too large to be a constant of a robot: {most} bits, {depth} formulas deep"
            ));
        }
        // The value itself, not the sum over its factors: a pivot of a matrix is a quotient of long products, and the estimate of such
        // a quotient doubles with each row.
        let Some(size) = bits(&formula) else {
            return Err(format!("`{PREFIX}{index}` divides by zero, or has the root of a negative number"));
        };
        let (hash, refers) = (crate::hash(&spelled(&formula)), references_of(&formula));
        let definition = Definition { index, formula, size, depth, hash, refers, enclosures: Mutex::default() };
        match self.list.insert(index, Arc::new(definition)) {
            None => Ok(()),
            Some(_) => Err(format!("`{PREFIX}{index}` is defined twice")),
        }
    }

    /// The definition whose number has these digits.
    pub fn get(&self, digits: &str) -> Option<Arc<Definition>> {
        self.list.get(&digits.parse().ok()?).cloned()
    }
}

/// Upper bound, nearly, on the number of bits of a formula's value before the point; for a fraction, the bits of its numerator and denominator.
pub(super) fn size(formula: &Formula) -> usize {
    match formula {
        Formula::Rational(value) => value.numerator().bit_len() + value.denominator().bit_len(),
        Formula::Root(Root::Integer(n)) => n.bit_len(),
        Formula::Root(Root::Nested(inner)) => size(inner),
        Formula::Pi | Formula::Sine(_) | Formula::Cosine(_) | Formula::Arctangent(_) => 2,
        Formula::Sum(terms) => terms.iter().map(size).max().unwrap_or(0).saturating_add(terms.len()),
        Formula::Product(factors) => factors.iter().map(size).fold(0, usize::saturating_add),
        Formula::Power(base, exponent) => size(base).saturating_mul(exponent.unsigned_abs() as usize),
        Formula::Defined(definition) => definition.size,
    }
}

/// Nesting depth of a formula.
fn depth(formula: &Formula) -> usize {
    let inner = match formula {
        Formula::Rational(_) | Formula::Pi | Formula::Arctangent(_) | Formula::Root(Root::Integer(_)) => 0,
        Formula::Root(Root::Nested(inner)) | Formula::Sine(inner) | Formula::Cosine(inner) | Formula::Power(inner, _) => {
            depth(inner)
        }
        Formula::Sum(parts) | Formula::Product(parts) => parts.iter().map(depth).max().unwrap_or(0),
        Formula::Defined(definition) => definition.depth,
    };
    inner + 1
}

/// The definitions that a formula uses directly.
fn references(formula: &Formula, found: &mut BTreeMap<usize, Arc<Definition>>) {
    match formula {
        Formula::Rational(_) | Formula::Pi | Formula::Arctangent(_) | Formula::Root(Root::Integer(_)) => {}
        Formula::Root(Root::Nested(inner)) | Formula::Sine(inner) | Formula::Cosine(inner) | Formula::Power(inner, _) => {
            references(inner, found);
        }
        Formula::Sum(parts) | Formula::Product(parts) => parts.iter().for_each(|part| references(part, found)),
        Formula::Defined(definition) => {
            found.insert(definition.index, definition.clone());
        }
    }
}

/// Whether a formula uses definitions.
pub(crate) fn has_names(formula: &Formula) -> bool {
    match formula {
        Formula::Rational(_) | Formula::Pi | Formula::Arctangent(_) | Formula::Root(Root::Integer(_)) => false,
        Formula::Root(Root::Nested(inner)) | Formula::Sine(inner) | Formula::Cosine(inner) | Formula::Power(inner, _) => {
            has_names(inner)
        }
        Formula::Sum(parts) | Formula::Product(parts) => parts.iter().any(has_names),
        Formula::Defined(_) => true,
    }
}

fn references_of(formula: &Formula) -> Vec<Arc<Definition>> {
    let mut found = BTreeMap::new();
    references(formula, &mut found);
    found.into_values().collect()
}

/// The formula with hashes in place of names, so that it depends neither on names nor on other definitions.
pub fn spelled(formula: &Formula) -> String {
    // From the last to the first, because `k1` is a prefix of `k12`.
    references_of(formula)
        .iter()
        .rev()
        .fold(formula.to_string(), |text, definition| text.replace(&definition.name(), &format!("[{}]", definition.hash)))
}

/// The definitions that formulas use, directly or indirectly, in the order of the list.
pub fn of<'a>(formulas: impl IntoIterator<Item = &'a Formula>) -> Vec<Arc<Definition>> {
    let mut first = BTreeMap::new();
    formulas.into_iter().for_each(|formula| references(formula, &mut first));
    reachable(first.into_values().collect(), |_| false)
}

/// These definitions and all that they use, in the order of the list, without `known` definitions and their own definitions.
fn reachable(mut stack: Vec<Arc<Definition>>, known: impl Fn(&Definition) -> bool) -> Vec<Arc<Definition>> {
    let mut found = BTreeMap::new();
    while let Some(definition) = stack.pop() {
        if !found.contains_key(&definition.index) && !known(&definition) {
            stack.extend(definition.refers.iter().cloned());
            found.insert(definition.index, definition);
        }
    }
    found.into_values().collect()
}

/// Values of definitions in an arithmetic.
#[derive(Debug)]
pub struct Defined<E>(Mutex<BTreeMap<usize, Option<E>>>);

impl<E> Default for Defined<E> {
    fn default() -> Defined<E> {
        Defined(Mutex::default())
    }
}

impl<E: Clone> Clone for Defined<E> {
    fn clone(&self) -> Defined<E> {
        Defined(Mutex::new(self.values().clone()))
    }
}

impl<E> Defined<E> {
    /// Each value is inserted atomically, so the map is valid even after another thread's panic.
    fn values(&self) -> MutexGuard<'_, BTreeMap<usize, Option<E>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<E: Clone> Defined<E> {
    /// The value of a definition; `of` computes that of a formula.
    pub(super) fn get(&self, definition: &Arc<Definition>, of: impl Fn(&Formula) -> Option<E>) -> Option<E> {
        let known = |index: usize| self.values().get(&index).cloned();
        if let Some(value) = known(definition.index) {
            return value;
        }
        for definition in reachable(vec![definition.clone()], |other| self.values().contains_key(&other.index)) {
            let value = of(&definition.formula);
            self.values().insert(definition.index, value);
        }
        known(definition.index).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::arithmetic::prime::Prime;
    use crate::values::arithmetic::tower::Tower;
    use crate::values::arithmetic::Arithmetic;
    use crate::values::enclosure::{bits_before_the_point, Float};
    use crate::values::formula::{Atoms, Dependent};
    use crate::values::stream::Stream;

    fn list(texts: &[&str]) -> Result<Definitions, String> {
        let mut definitions = Definitions::default();
        texts.iter().enumerate().try_for_each(|(index, text)| definitions.define(index, text, bits_before_the_point))?;
        Ok(definitions)
    }

    #[test]
    fn what_is_defined_has_the_value_of_its_formula() {
        let definitions = list(&["1/2 + cos(7/10)", "k0^2 - sin(7/10)", "k1*k0"]).expect("definitions");
        let short = Formula::parse_with("2*k2 - k0", &definitions).expect("a formula");
        let long =
            Formula::parse("2*((1/2 + cos(7/10))^2 - sin(7/10))*(1/2 + cos(7/10)) - (1/2 + cos(7/10))").expect("a formula");
        assert_eq!(short.to_string(), "2*k2 - k0");
        assert_eq!(Atoms::of([&short]), Atoms::of([&long]));
        assert_eq!(Float::F64.nearest(&short), Float::F64.nearest(&long));
        let field = Prime::new(&mut Stream::new(1), &Atoms::of([&short]), &Dependent::new()).expect("no roots");
        assert_eq!(field.constant(&short), field.constant(&long));
        let indices: Vec<usize> = of([&short]).iter().map(|definition| definition.index()).collect();
        assert_eq!(indices, [0, 1, 2]);
    }

    #[test]
    fn a_hash_is_of_what_is_defined_and_not_of_names() {
        let spelled_with = |texts: &[&str], text: &str| {
            spelled(&Formula::parse_with(text, &list(texts).expect("definitions")).expect("a formula"))
        };
        let one = spelled_with(&["1 + pi", "k0^2"], "k1 - 3");
        assert_eq!(spelled_with(&["7*pi", "1 + pi", "k1^2"], "k2 - 3"), one);
        assert_ne!(spelled_with(&["2 + pi", "k0^2"], "k1 - 3"), one);
        assert!(!one.contains('k'), "{one}");
        let many: Vec<String> = (0..13).map(|n| format!("{n} + pi")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert_eq!(spelled_with(&many, "k1*k12"), spelled_with(&["12 + pi", "1 + pi"], "k1*k0"));
    }

    #[test]
    fn names_are_defined_once_with_a_value_and_before_they_are_used() {
        for (wrong, why) in [
            (&["pi - pi", "1/k0"][..], "divides by zero"),
            (&["k0"][..], "not defined"),
            (&["1", "k2"], "not defined"),
            (&["k"], "not defined"),
            (&["1", "kk0"], "where a number"),
        ] {
            assert!(list(wrong).is_err_and(|error| error.contains(why)), "{wrong:?}");
        }
        let mut twice = list(&["pi"]).expect("a definition");
        assert!(twice.define(0, "pi", bits_before_the_point).is_err());
        assert!(Formula::parse("k0").is_err());
    }

    #[test]
    fn graphs_of_no_robot_are_refused() {
        // First, each is the square of the previous; then a chain too deep for recursion.
        let mut definitions = list(&["sqrt(2) + 1"]).expect("a definition");
        let wrong = (1..100)
            .find_map(|n| definitions.define(n, &format!("k{0}*k{0}", n - 1), bits_before_the_point).err())
            .expect("an end");
        assert!(wrong.contains("too large"), "{wrong}");
        let mut definitions = list(&["pi"]).expect("a definition");
        let wrong = (1..100_000)
            .find_map(|n| definitions.define(n, &format!("k{} + 1", n - 1), bits_before_the_point).err())
            .expect("an end");
        assert!(wrong.contains("deep"), "{wrong}");
    }

    /// Pivots of a matrix without zeros, each a quotient of what the ones before leave: as long as a constant, though their formulas, multiplied out,
    /// would double with each row.
    #[test]
    fn pivots_of_a_matrix_are_short() {
        const ROWS: usize = 16;
        let mut definitions = Definitions::default();
        let mut count = 0;
        let name = &mut |text: String| {
            definitions.define(count, &text, bits_before_the_point).unwrap_or_else(|error| panic!("{text}: {error}"));
            count += 1;
            format!("k{}", count - 1)
        };
        let entry = |i: usize, j: usize| if i == j { "40 + sin(3/10)".into() } else { format!("cos({}/10)", i + 2 * j) };
        let mut rows: Vec<Vec<String>> = (0..ROWS).map(|i| (0..=i).map(|j| name(entry(i, j))).collect()).collect();
        for k in 0..ROWS {
            for i in k + 1..ROWS {
                let factor = name(format!("{}/{}", rows[i][k], rows[k][k]));
                for j in k + 1..=i {
                    rows[i][j] = name(format!("{} - {factor}*{}", rows[i][j], rows[j][k]));
                }
            }
        }
        let last = Formula::parse_with(&rows[ROWS - 1][ROWS - 1], &definitions).expect("a formula");
        assert!(size(&last) < 8, "{}", size(&last));
        let value = Float::F64.nearest(&last).expect("a pivot");
        assert!(value > 30.0 && value < 41.0, "{value}");
    }

    /// A square of a square is small before the point where the first number is, and yet long in fractions.
    #[test]
    fn fractions_of_no_robot_have_no_value() {
        let mut definitions = list(&["1/2*sqrt(2)*cos(7/10)"]).expect("a definition");
        (1..64).for_each(|n| definitions.define(n, &format!("k{0}*k{0}", n - 1), bits_before_the_point).expect("small"));
        let [short, long] = ["k10", "k63"].map(|text| Formula::parse_with(text, &definitions).expect("a formula"));
        let tower = Tower::new(&mut Stream::new(1), &Atoms::of([&long]), &Dependent::new(), 4).expect("a root");
        assert!(tower.constant(&short).is_some());
        assert!(tower.constant(&long).is_none());
    }

    #[test]
    fn long_chains_have_values_and_enclosures() {
        let mut definitions = list(&["cos(7/10)"]).expect("a definition");
        for n in 1..=2000 {
            definitions.define(n, &format!("1/2*k{0} + 1/2*k{0}", n - 1), bits_before_the_point).expect("not too deep");
        }
        let last = Formula::parse_with("k2000", &definitions).expect("a formula");
        assert_eq!(Float::F64.nearest(&last), Float::F64.nearest(&Formula::parse("cos(7/10)").expect("a formula")));
        let field = Prime::new(&mut Stream::new(1), &Atoms::of([&last]), &Dependent::new()).expect("no roots");
        assert_eq!(field.constant(&last), field.constant(&Formula::parse("cos(7/10)").expect("a formula")));
    }
}
