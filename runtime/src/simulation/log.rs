//! A table of numbers with named columns.

use std::fmt;

/// Record of a run: one row per recorded sample, one named column per quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    names: Vec<String>,
    values: Vec<f64>,
}

impl Log {
    /// An empty table with these columns.
    pub fn new<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Self {
        Self { names: names.into_iter().map(Into::into).collect(), values: Vec::new() }
    }

    /// Appends a row; missing values at its end are NaN, values without a column are dropped.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        let width = self.names.len();
        self.values.extend(row.into_iter().chain(std::iter::repeat(f64::NAN)).take(width));
    }

    /// The names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.values.len().checked_div(self.names.len()).unwrap_or(0)
    }

    /// Whether there is no row yet.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The rows in order.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.names.len().max(1))
    }

    /// The column of this name, from top to bottom, if it exists.
    pub fn column(&self, name: &str) -> Option<impl Iterator<Item = f64> + '_> {
        let index = self.names.iter().position(|n| n == name)?;
        Some(self.rows().map(move |row| row[index]))
    }

    /// Largest |value| of a column over the rows for which `within` holds; `None` if there is no such column.
    ///
    /// NaN where one of the values is NaN, or without such a row: an unknown value must not pass any bound.
    pub fn peak(&self, name: &str, within: impl Fn(&[f64]) -> bool) -> Option<f64> {
        self.reduce(name, within, |a, b| a.abs().max(b.abs())).map(f64::abs)
    }

    /// Largest value of a column over the rows for which `within` holds; NaN and `None` as for [`Log::peak`].
    pub fn highest(&self, name: &str, within: impl Fn(&[f64]) -> bool) -> Option<f64> {
        self.reduce(name, within, f64::max)
    }

    /// Smallest value of a column over the rows for which `within` holds; NaN and `None` as for [`Log::peak`].
    pub fn lowest(&self, name: &str, within: impl Fn(&[f64]) -> bool) -> Option<f64> {
        self.reduce(name, within, f64::min)
    }

    fn reduce(&self, name: &str, within: impl Fn(&[f64]) -> bool, pick: fn(f64, f64) -> f64) -> Option<f64> {
        let index = self.names.iter().position(|n| n == name)?;
        // `f64::max` and `f64::min` would drop a NaN.
        let of_both = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { pick(a, b) };
        Some(self.rows().filter(|row| within(row)).map(|row| row[index]).reduce(of_both).unwrap_or(f64::NAN))
    }

    /// Writes the table as comma-separated values: a line of names, then the rows, each number as its shortest decimal that reads back.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_csv(&self, out: &mut impl fmt::Write) -> fmt::Result {
        writeln!(out, "{}", self.names.join(","))?;
        for row in self.rows() {
            for (i, value) in row.iter().enumerate() {
                let comma = if i == 0 { "" } else { "," };
                write!(out, "{comma}{value}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_columns_and_text() {
        let mut log = Log::new(["t", "x"]);
        log.push([0.0, 1.5]);
        log.push([0.1, -2.0, 7.0]);
        assert_eq!(log.len(), 2);
        assert_eq!(log.column("x").unwrap().collect::<Vec<_>>(), [1.5, -2.0]);
        assert!(log.column("y").is_none());
        assert_eq!(log.peak("x", |row| row[0] > 0.05), Some(2.0));
        assert_eq!(
            (log.peak("x", |_| true), log.highest("x", |_| true), log.lowest("x", |_| true)),
            (Some(2.0), Some(1.5), Some(-2.0))
        );
        let mut text = String::new();
        log.write_csv(&mut text).unwrap();
        assert_eq!(text, "t,x\n0,1.5\n0.1,-2\n");
    }

    #[test]
    fn what_is_not_known_is_below_no_bound() {
        let mut log = Log::new(["x"]);
        let of_all =
            |log: &Log| [log.peak("x", |_| true), log.highest("x", |_| true), log.lowest("x", |_| true)].map(Option::unwrap);
        assert!(of_all(&log).iter().all(|x| x.is_nan()), "no row");
        [1.0, f64::NAN, -3.0].into_iter().for_each(|x| log.push([x]));
        assert!(of_all(&log).iter().all(|x| x.is_nan()), "a NaN");
        assert_eq!(log.peak("x", |row| !row[0].is_nan()), Some(3.0));
        assert_eq!(log.peak("y", |_| true), None);
    }
}
