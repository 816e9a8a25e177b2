//! What `show --format json` prints, read back: closed entries and numbered steps as exact expressions or as numbers.

use std::collections::BTreeMap;

use serde::Deserialize as _;
use serde_derive::Deserialize;
use serde_json::Value;

use crate::formula;
use crate::trigonometry::{Exact, ExactMatrix, Names};

/// Everything shown of one robot.
#[derive(Clone, Debug, Deserialize)]
pub struct Shown {
    /// Name of the robot.
    pub robot: String,
    /// The quantities in the order of the output.
    pub quantities: Vec<Quantity>,
}

/// One matrix of formulas.
#[derive(Clone, Debug, Deserialize)]
pub struct Quantity {
    /// Name of the emitted function, or `determinant`.
    pub name: String,
    /// Symbol in the book.
    pub symbol: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Formulas by rows.
    pub entries: Vec<Vec<String>>,
    /// `closed`, or `program`, whose `entries` use `steps`.
    pub form: String,
    /// Numbered steps, name and formula, each using earlier ones only.
    pub steps: Option<Vec<(String, String)>>,
    /// Factors of the determinant.
    pub factors: Option<Vec<String>>,
    /// Where each factor of the determinant vanishes; null where it depends on more than one angle.
    pub singular: Option<Vec<Option<String>>>,
}

impl Shown {
    /// Reads the output and checks that it is sound: unique names, entries as many as announced, a known form.
    pub fn read(json: &Value) -> Result<Self, String> {
        let shown: Shown = Shown::deserialize(json).map_err(|error| error.to_string())?;
        for (i, quantity) in shown.quantities.iter().enumerate() {
            let name = &quantity.name;
            if shown.quantities[..i].iter().any(|other| other.name == *name) {
                return Err(format!("{name} is shown twice"));
            }
            if quantity.entries.len() != quantity.rows || quantity.entries.iter().any(|row| row.len() != quantity.columns) {
                return Err(format!("{name} is not {} x {}", quantity.rows, quantity.columns));
            }
            // A program may have no steps: a reciprocal fits into one entry.
            match (quantity.form.as_str(), &quantity.steps) {
                ("closed", None) | ("program", Some(_)) => (),
                (form, steps) => return Err(format!("{name}: form `{form}` with steps {steps:?}")),
            }
        }
        Ok(shown)
    }

    /// A quantity by its name.
    pub fn get(&self, name: &str) -> Result<&Quantity, String> {
        self.quantities.iter().find(|q| q.name == name).ok_or_else(|| format!("{name} is not shown"))
    }
}

impl Quantity {
    /// The matrix in exact expressions; steps are put in. `names` replaces some names.
    pub fn exact(&self, names: &Names) -> Result<ExactMatrix, String> {
        let mut names = names.clone();
        for (name, text) in self.steps.iter().flatten() {
            let value = self.named(Exact::read_with(text, &names))?;
            names.insert(name.clone(), value);
        }
        self.entries.iter().map(|row| row.iter().map(|text| self.named(Exact::read_with(text, &names))).collect()).collect()
    }

    /// The matrix in numbers.
    pub fn value(&self, names: &BTreeMap<String, f64>) -> Result<Vec<Vec<f64>>, String> {
        let mut names = names.clone();
        let evaluate = |text: &str, names: &BTreeMap<String, f64>| formula::evaluate(&formula::parse(text)?, names);
        for (name, text) in self.steps.iter().flatten() {
            let value = self.named(evaluate(text, &names))?;
            names.insert(name.clone(), value);
        }
        self.entries.iter().map(|row| row.iter().map(|text| self.named(evaluate(text, &names))).collect()).collect()
    }

    fn named<T>(&self, result: Result<T, String>) -> Result<T, String> {
        result.map_err(|error| format!("{}: {error}", self.name))
    }
}

/// Names of the joints' variables at a state: q1.., dq1.., ddq1.., dqr1.., ddqr1.., tau1...
pub fn state_names(vectors: &[(&str, &[f64])]) -> BTreeMap<String, f64> {
    vectors.iter().flat_map(|(prefix, v)| v.iter().enumerate().map(move |(i, &x)| (format!("{prefix}{}", i + 1), x))).collect()
}
