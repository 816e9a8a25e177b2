//! For programs: `{"robot", "quantities": [{"name", "symbol", "rows", "columns", "entries", "form", "steps"}]}`.
//!
//! `entries` are plain formulas by rows. `form` is `closed` or `program`; the `steps` of a program are pairs of name and formula,
//! empty where an entry alone is shorter with its factors. The determinant also has `factors`, whose product it is, and
//! `singular`, where each is zero: null where more than one joint decides. With one joint more than rows, its entries are the
//! minors (the determinants of J without each column) divided by their `common_factors`; `singular` then belongs to these.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use super::{Sheet, Shown};
use crate::ring::print::Notation;

impl Sheet {
    /// The sheet as JSON text, closed by a line break.
    pub fn json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("strings and numbers always have a JSON form");
        text.push('\n');
        text
    }
}

impl Serialize for Sheet {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut sheet = serializer.serialize_struct("Sheet", 2)?;
        sheet.serialize_field("robot", &self.robot)?;
        sheet.serialize_field("quantities", &self.quantities)?;
        sheet.end()
    }
}

impl Serialize for Shown {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let formulas = self.plain_text();
        let rows: Vec<&[String]> = formulas.entries.chunks(self.columns.max(1)).collect();
        let mut shown = serializer.serialize_struct("Shown", 9)?;
        shown.serialize_field("name", &self.name)?;
        shown.serialize_field("symbol", &self.symbol[0])?;
        shown.serialize_field("rows", &self.rows)?;
        shown.serialize_field("columns", &self.columns)?;
        shown.serialize_field("entries", &rows)?;
        shown.serialize_field("form", if self.is_closed() { "closed" } else { "program" })?;
        if !self.is_closed() {
            shown.serialize_field("steps", &formulas.steps)?;
        }
        if let Some(factors) = self.factors(Notation::Text) {
            let (factors, singular): (Vec<_>, Vec<_>) =
                factors.into_iter().map(|(factor, zeros)| (factor, zeros.words())).unzip();
            shown.serialize_field(if self.minors().is_some() { "common_factors" } else { "factors" }, &factors)?;
            shown.serialize_field("singular", &singular)?;
        }
        shown.end()
    }
}
