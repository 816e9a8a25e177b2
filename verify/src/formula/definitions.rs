//! Formulas that are defined once and that others refer to by a name.
//!
//! ```text
//! k0 = 3/10*cos(7/10) - sin(7/10)    k1 = k0^2 + 1/4    ...
//! ```
//!
//! Each refers only to those before it, so that a list of them is a graph without circles, and whatever is asked of it takes a time that
//! grows with its length: values and enclosures are kept, and found in the order of the list, not by recursion.

use std::cell::{Cell, RefCell};
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use dashu_base::BitTest;

use super::{Formula, Root};
use crate::check::Check;
use crate::interval::Interval;

/// What a name begins with; its number follows.
pub const PREFIX: &str = "k";

/// What could have more bits is no constant of a robot.
pub(super) const LARGEST: usize = 1 << 18;

/// Formulas in formulas, and definitions in definitions: what stands deeper is no constant of a robot.
const DEEPEST: usize = 8000;

/// A formula with a name.
pub struct Definition {
    index: usize,
    formula: Formula,
    /// About how many bits its value may have before and behind the point.
    size: usize,
    /// How deep it is.
    depth: usize,
    /// A hash of what it stands for, whatever the names are.
    hash: String,
    /// The definitions that it refers to itself.
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

    /// What it stands for.
    pub fn formula(&self) -> &Formula {
        &self.formula
    }

    /// The enclosure to so many bits; `enclose` gives that of a formula.
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

/// Definitions of one list are told apart by their places.
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

/// What the formulas of a module may cost, in nanoseconds; those of an arm of 32 prismatic joints with general angles cost a fifth of it.
const MOST_WORK: u64 = 1 << 37;

/// Copying and comparing, in nanoseconds.
const WORK_OF_CHARACTER: u64 = 50;

/// A list of definitions, by number, and what may be spent on them and on the formulas that are read with them.
#[derive(Clone, Debug)]
pub struct Definitions {
    list: BTreeMap<usize, Arc<Definition>>,
    left: Cell<u64>,
    /// What was read, as most constants stand in many places.
    read: RefCell<BTreeMap<String, Formula>>,
}

impl Default for Definitions {
    fn default() -> Definitions {
        Definitions { list: BTreeMap::new(), left: Cell::new(MOST_WORK), read: RefCell::default() }
    }
}

impl Definitions {
    /// Reads a formula that refers to these definitions, or to none; one that was read before costs its length.
    pub fn formula(&self, text: &str) -> Result<Formula, String> {
        self.charge(WORK_OF_CHARACTER.saturating_mul(text.len() as u64))?;
        if let Some(known) = self.read.borrow().get(text) {
            return Ok(known.clone());
        }
        let formula = Formula::parse_with(text, self)?;
        self.read.borrow_mut().insert(text.into(), formula.clone());
        Ok(formula)
    }

    /// How much of it is spent.
    #[cfg(test)]
    pub(crate) fn spent(&self) -> f64 {
        1.0 - self.left.get() as f64 / MOST_WORK as f64
    }

    /// Counts work before it is done.
    pub(super) fn charge(&self, work: u64) -> Result<(), String> {
        let left = self.left.get().checked_sub(work);
        if left.is_none() && Check::Work.is_made() {
            return Err("the formulas cost more than the constants of any robot".into());
        }
        self.left.set(left.unwrap_or(0));
        Ok(())
    }

    /// Reads the definition of the number given.
    pub fn define(&mut self, index: usize, text: &str) -> Result<(), String> {
        let formula = Formula::parse_with(text, self)?;
        let (size, depth) = (size(&formula), depth(&formula));
        if size > LARGEST || depth > DEEPEST {
            return Err(format!(
                "`{PREFIX}{index}` is too large to be a constant of a robot: {size} bits, {depth} formulas deep"
            ));
        }
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

/// About how many bits the value of a formula may have before and behind the point.
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

/// How deep formulas stand in it.
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

/// The definitions that a formula refers to itself.
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

fn references_of(formula: &Formula) -> Vec<Arc<Definition>> {
    let mut found = BTreeMap::new();
    references(formula, &mut found);
    found.into_values().collect()
}

/// The formula with hashes in the places of names, so that neither the names nor other definitions enter.
pub fn spelled(formula: &Formula) -> String {
    // The last first: `k1` begins `k12`.
    references_of(formula)
        .iter()
        .rev()
        .fold(formula.to_string(), |text, definition| text.replace(&definition.name(), &format!("[{}]", definition.hash)))
}

/// The definitions that formulas refer to, themselves or by others, in the order of the list.
pub fn of<'a>(formulas: impl IntoIterator<Item = &'a Formula>) -> Vec<Arc<Definition>> {
    let mut first = BTreeMap::new();
    formulas.into_iter().for_each(|formula| references(formula, &mut first));
    reachable(first.into_values().collect(), |_| false)
}

/// These definitions and all that they refer to, in the order of the list, without those that are `known` and what these refer to.
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
    /// A value is put in whole: what another thread has left is right.
    fn values(&self) -> MutexGuard<'_, BTreeMap<usize, Option<E>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<E: Clone> Defined<E> {
    /// The value of a definition; `of` gives that of a formula.
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
    use crate::arithmetic::prime::Prime;
    use crate::arithmetic::Arithmetic;
    use crate::enclosure::Float;
    use crate::formula::{Atoms, Dependent};
    use crate::stream::Stream;

    fn list(texts: &[&str]) -> Result<Definitions, String> {
        let mut definitions = Definitions::default();
        texts.iter().enumerate().try_for_each(|(index, text)| definitions.define(index, text))?;
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
    fn names_are_defined_once_and_before_they_are_used() {
        for (wrong, why) in [
            (&["k0"][..], "not defined"),
            (&["1", "k2"], "not defined"),
            (&["k"], "not defined"),
            (&["1", "kk0"], "where a number"),
        ] {
            assert!(list(wrong).is_err_and(|error| error.contains(why)), "{wrong:?}");
        }
        let mut twice = list(&["pi"]).expect("a definition");
        assert!(twice.define(0, "pi").is_err());
        assert!(Formula::parse("k0").is_err());
    }

    #[test]
    fn graphs_of_no_robot_are_refused() {
        // Each the square of the one before; and a chain that is too deep to walk down.
        let mut definitions = list(&["sqrt(2) + 1"]).expect("a definition");
        let wrong = (1..100).find_map(|n| definitions.define(n, &format!("k{0}*k{0}", n - 1)).err()).expect("an end");
        assert!(wrong.contains("too large"), "{wrong}");
        let mut definitions = list(&["pi"]).expect("a definition");
        let wrong = (1..100_000).find_map(|n| definitions.define(n, &format!("k{} + 1", n - 1)).err()).expect("an end");
        assert!(wrong.contains("deep"), "{wrong}");
    }

    #[test]
    fn long_chains_have_values_and_enclosures() {
        let mut definitions = list(&["cos(7/10)"]).expect("a definition");
        for n in 1..=2000 {
            definitions.define(n, &format!("1/2*k{0} + 1/2*k{0}", n - 1)).expect("not too deep");
        }
        let last = Formula::parse_with("k2000", &definitions).expect("a formula");
        assert_eq!(Float::F64.nearest(&last), Float::F64.nearest(&Formula::parse("cos(7/10)").expect("a formula")));
        let field = Prime::new(&mut Stream::new(1), &Atoms::of([&last]), &Dependent::new()).expect("no roots");
        assert_eq!(field.constant(&last), field.constant(&Formula::parse("cos(7/10)").expect("a formula")));
    }
}
