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

impl Record {
    /// The record as comma-separated values: a row every 10 ms, or the single numbers if there is no log.
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
            let stride = ((CSV_STEP / (second - first)).round() as usize).max(1);
            let mut thin = Log::new(self.log.names().iter().cloned());
            self.log.rows().step_by(stride).for_each(|row| thin.push(row.iter().copied()));
            thin.write_csv(&mut text)
        };
        debug_assert!(written.is_ok(), "a text takes everything");
        text
    }
}
