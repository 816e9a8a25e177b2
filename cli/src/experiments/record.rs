//! What a run leaves behind.

use std::fmt::Write;

use armgen_runtime::simulation::Log;

/// Log, single numbers, and what has to be said.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    /// Quantities over time; the first column is `t`, s.
    pub(crate) log: Log,
    /// Numbers that belong to the whole run.
    pub(crate) singles: Vec<(String, f64)>,
    /// Why the run ended early, if it did.
    pub(crate) ended: Option<String>,
    /// Simulated time, s, and what it took, s; both zero where nothing was simulated.
    pub(crate) speed: (f64, f64),
}

/// One row in the files for so many seconds; expectations see every sample.
const CSV_STEP: f64 = 0.01;

/// Shorter runs, s, are written with every sample: there is something to see in them, or they were lost.
const SHORT: f64 = 1.0;

impl Record {
    /// The record as comma-separated values: a row every 10 ms and the last, every row of a run shorter than a second, or the single
    /// numbers if there is no log.
    pub(crate) fn csv(&self) -> String {
        let mut text = String::new();
        let written = if self.log.is_empty() {
            write!(text, "quantity,value").and_then(|()| {
                self.singles.iter().try_for_each(|(name, value)| write!(text, "\n{name},{value}"))?;
                writeln!(text)
            })
        } else {
            let mut rows = self.log.rows();
            let (first, second) = (rows.next().map_or(0.0, |row| row[0]), rows.next().map_or(CSV_STEP, |row| row[0]));
            let end = self.log.rows().last().map_or(first, |row| row[0]);
            let stride = if end - first < SHORT { 1 } else { ((CSV_STEP / (second - first)).round() as usize).max(1) };
            let mut thin = Log::new(self.log.names().iter().cloned());
            let last = self.log.len().saturating_sub(1);
            let kept = self.log.rows().enumerate().filter(|(i, _)| i % stride == 0 || *i == last);
            kept.for_each(|(_, row)| thin.push(row.iter().copied()));
            thin.write_csv(&mut text)
        };
        debug_assert!(written.is_ok(), "a text takes everything");
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_holds_the_last_sample_and_all_of_a_short_run() {
        let rows = |count: u32| {
            let mut record = Record { log: Log::new(["t", "x"].map(String::from)), ..Record::default() };
            (0..count).for_each(|k| record.log.push([f64::from(k) * 1e-3, f64::from(k)]));
            record.csv().lines().skip(1).map(|line| line.rsplit(',').next().unwrap_or_default().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(rows(4).len(), 4);
        assert_eq!(rows(1).len(), 1);
        let long = rows(1506);
        assert_eq!((long.len(), long[1].parse(), long[151].parse()), (152, Ok(10.0), Ok(1505.0)));
    }
}
