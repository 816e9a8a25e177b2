//! The exact values of a text's literals.
//!
//! A literal is a float that represents an exact constant known only to the generator. The generator passes its constants, or a certificate
//! lists them; neither needs trust. The literal must be the float nearest to the claimed value, and the function, run with the claimed values,
//! must equal the equations exactly. A literal without a matching claim has its decimal value.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use armgen_description::exact::{self, Number};

use crate::read::reader::Module;
use crate::values::element::Element;
use crate::values::enclosure::{bits_before_the_point, Float};
use crate::values::formula::definitions::Definitions;
use crate::values::formula::parse::decimal;
use crate::values::formula::{Formula, Rational};
use crate::values::program::{Literal, Program, Step};

/// Claimed constants by function (or constant) name, in the order of the text if known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Claims {
    by_name: BTreeMap<String, Vec<Formula>>,
    known: Known,
}

/// The literals of functions that were resolved before, by name: the odds, the points, the comparison and the bounds all need their values, and each
/// value takes an enclosure.
#[derive(Debug, Default)]
struct Known(Mutex<BTreeMap<String, (Float, Vec<Literal>, Arc<Resolved>)>>);

impl Known {
    fn all(&self) -> MutexGuard<'_, BTreeMap<String, (Float, Vec<Literal>, Arc<Resolved>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn get(&self, name: &str, literals: &[Literal], real: Float) -> Option<Arc<Resolved>> {
        let all = self.all();
        let (of_real, of_literals, resolved) = all.get(name)?;
        (*of_real == real && of_literals == literals).then(|| resolved.clone())
    }

    fn insert(&self, name: &str, literals: &[Literal], real: Float, resolved: &Arc<Resolved>) {
        self.all().insert(name.to_string(), (real, literals.to_vec(), resolved.clone()));
    }
}

impl Clone for Known {
    fn clone(&self) -> Known {
        Known(Mutex::new(self.all().clone()))
    }
}

/// Claims are equal whatever was resolved before.
impl PartialEq for Known {
    fn eq(&self, _: &Known) -> bool {
        true
    }
}

impl Claims {
    /// No claims: every literal has its decimal value.
    pub fn none() -> Claims {
        Claims::default()
    }

    /// The constants of a generator. An error if the formula of one exceeds a limit of the checker: without it nothing can be verified.
    pub fn from_numbers(constants: &BTreeMap<String, Vec<Number>>) -> Result<Claims, String> {
        Claims::read(constants).map(|(claims, _)| claims)
    }

    /// The same with the definitions that the formulas use.
    fn read(constants: &BTreeMap<String, Vec<Number>>) -> Result<(Claims, Definitions), String> {
        let mut texts = exact::Definitions::default();
        let lists: Vec<(&String, Vec<String>)> = constants
            .iter()
            .map(|(name, numbers)| (name, numbers.iter().map(|number| texts.formula(number)).collect()))
            .collect();
        let mut definitions = Definitions::default();
        for (index, text) in texts.texts().iter().enumerate() {
            definitions.define(index, text, bits_before_the_point)?;
        }
        let lists = lists.iter().map(|(name, texts)| (name.as_str(), texts.as_slice()));
        Ok((Claims::with_definitions(lists, &definitions)?, definitions))
    }

    /// Formulas without definitions, by function.
    pub fn from_texts<'a>(constants: impl IntoIterator<Item = (&'a str, &'a [String])>) -> Result<Claims, String> {
        Claims::with_definitions(constants, &Definitions::default())
    }

    /// The claims of a certificate.
    pub fn with_definitions<'a>(
        constants: impl IntoIterator<Item = (&'a str, &'a [String])>,
        definitions: &Definitions,
    ) -> Result<Claims, String> {
        let mut by_name = BTreeMap::new();
        for (name, texts) in constants {
            let formulas: Result<Vec<Formula>, String> = texts.iter().map(|text| definitions.formula(text)).collect();
            by_name.insert(name.to_string(), formulas.map_err(|e| format!("`{name}`: {e}"))?);
        }
        Ok(Claims { by_name, known: Known::default() })
    }

    /// The claims for literals of the module, including alternative claims for the same literals, and those for the entries of `constants`.
    /// Other claims have no influence.
    pub fn used(&self, module: &Module, constants: &[&str]) -> Claims {
        let (mut by_name, known) = (BTreeMap::new(), Known::default());
        for (name, program) in module.programs().filter(|(name, _)| self.by_name.contains_key(*name)) {
            let resolved = self.resolve(name, &program.literals, module.real);
            let Resolved { values, others } = &*resolved;
            by_name.insert(name.to_string(), values.iter().chain(others.values().flatten()).cloned().collect());
            // One value for each literal is resolved by position.
            if others.is_empty() {
                known.insert(name, &program.literals, module.real, &resolved);
            }
        }
        for name in constants {
            by_name.insert((*name).to_string(), self.of(name).to_vec());
        }
        Claims { by_name, known }
    }

    /// A useless claim of a certificate: a constant that does not round to its literal, or that is closer to a boundary between floats than any
    /// constant of a robot.
    pub fn misfit(&self, module: &Module) -> Option<String> {
        module.programs().find_map(|(name, program)| {
            let mut pairs = self.of(name).iter().zip(&program.literals);
            pairs.find_map(|(claim, literal)| match module.real.decides(literal.value, claim, MOST_BITS) {
                Some(true) => None,
                Some(false) => Some(format!("{name}: the literal {} is not the float nearest to {claim}", literal.text)),
                None => {
                    Some(format!("{name}: {MOST_BITS} bits do not tell whether {} is the float nearest to {claim}", literal.text))
                }
            })
        })
    }

    /// All claimed constants.
    pub fn formulas(&self) -> impl Iterator<Item = &Formula> {
        self.by_name.values().flatten()
    }

    /// The claims for a name, in order.
    pub fn of(&self, name: &str) -> &[Formula] {
        self.by_name.get(name).map_or(&[], Vec::as_slice)
    }

    /// The claimed values of a function's literals; each literal is the float nearest to its value.
    pub fn resolve(&self, name: &str, literals: &[Literal], real: Float) -> Arc<Resolved> {
        if let Some(known) = self.known.get(name, literals, real) {
            return known;
        }
        let resolved = Arc::new(self.resolved(name, literals, real));
        self.known.insert(name, literals, real, &resolved);
        resolved
    }

    fn resolved(&self, name: &str, literals: &[Literal], real: Float) -> Resolved {
        let claims = self.of(name);
        // By position, if the certificate lists a value for each literal.
        let in_order = claims.len() == literals.len()
            && claims.iter().zip(literals).all(|(claim, literal)| real.is_nearest(literal.value, claim));
        if in_order {
            return Resolved { values: claims.to_vec(), others: BTreeMap::new() };
        }
        let mut by_value: BTreeMap<u64, Vec<Formula>> = BTreeMap::new();
        for claim in claims {
            let Some(value) = real.nearest(claim) else { continue };
            let size = if value.is_sign_negative() { claim.negated() } else { claim.clone() };
            let list = by_value.entry(value.abs().to_bits()).or_default();
            if !list.contains(&size) {
                list.push(size);
            }
        }
        let mut others = BTreeMap::new();
        let mut values = Vec::new();
        for (index, literal) in literals.iter().enumerate() {
            let fitting = by_value.get(&literal.value.to_bits()).map_or(&[][..], Vec::as_slice);
            let fitting: Vec<&Formula> = fitting.iter().filter(|claim| real.is_nearest(literal.value, claim)).collect();
            match fitting.split_first() {
                Some((first, rest)) => {
                    values.push((*first).clone());
                    if !rest.is_empty() {
                        others.insert(index, rest.iter().map(|&f| f.clone()).collect());
                    }
                }
                // The reader has already refused anything but decimal numbers.
                None => values.push(decimal(&literal.text).unwrap_or(Formula::Rational(Rational::ZERO))),
            }
        }
        Resolved { values, others }
    }

    /// A description of a literal of an entry that matches no claimed constant; it may explain the difference.
    pub fn suspect(&self, program: &Program, entry: &str, real: Float) -> Option<String> {
        let claims: Vec<(f64, &Formula)> =
            self.of(&program.name).iter().filter_map(|claim| Some((real.nearest(claim)?.abs(), claim))).collect();
        let known: BTreeSet<u64> = claims.iter().map(|(value, _)| value.to_bits()).collect();
        let output = program.outputs.iter().find(|output| output.place == entry)?;
        let needed = program.needed(&[output.step]);
        let of_entry = program.steps.iter().zip(needed).filter_map(|(step, needed)| match step {
            Step::Literal(index) if needed => Some(&program.literals[*index]),
            _ => None,
        });
        let literal = of_entry.into_iter().find(|literal| !known.contains(&literal.value.abs().to_bits()))?;
        let distance = |value: f64| (value - literal.value.abs()).abs();
        let (value, claim) = claims.into_iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)))?;
        Some(if distance(value) < 1e-6 * value {
            format!("its literal {} is not the float nearest to {claim}", literal.text)
        } else {
            format!(
                "its literal {} is no constant of the equations as armgen writes them, and what else it stands for only a certificate can say",
                literal.text
            )
        })
    }
}

/// The exact values of a function's literals.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// A value for each literal.
    pub values: Vec<Formula>,
    /// For a literal whose float is the nearest to several claimed constants: the other constants.
    pub others: BTreeMap<usize, Vec<Formula>>,
}

/// Maximum number of bits to find the float nearest to a constant of a robot; slightly more than twice a float's bits suffice.
const MOST_BITS: usize = 1024;

/// Maximum number of tried choices among constants with the same float.
const MOST_CHOICES: usize = 256;

impl Resolved {
    /// All choices of values up to the maximum, the first choice first.
    pub fn choices(&self) -> Vec<Vec<Formula>> {
        let mut choices = vec![self.values.clone()];
        for (&index, others) in &self.others {
            if choices.len() * (others.len() + 1) > MOST_CHOICES {
                break;
            }
            let before = choices.clone();
            for other in others {
                for choice in &before {
                    let mut choice = choice.clone();
                    choice[index] = other.clone();
                    choices.push(choice);
                }
            }
        }
        choices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use armgen_codegen::schedule::Options;
    use armgen_description::source::Source;

    /// No robot may come near the limit.
    #[test]
    fn constants_of_robots_cost_little() {
        for name in ["robots/panda7", "tests/robots/everything", "tests/robots/general_angles", "tests/robots/base_set"] {
            let path = format!("{}/../{name}.yaml", env!("CARGO_MANIFEST_DIR"));
            let source = Source::new("robot.yaml", std::fs::read_to_string(path).expect("a robot"));
            let generated = armgen_codegen::generate(&source, &Options::default()).0.expect("a module");
            let (_, definitions) = Claims::read(&generated.constants).expect("short formulas");
            println!("{name}: {:.4} of what formulas may cost", definitions.spent());
            assert!(definitions.spent() < 0.1, "{name}");
        }
    }
}
