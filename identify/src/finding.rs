//! Faults of logs: code, place, text and remedy.
//!
//! A log may be longer than memory holds as text, so a finding keeps its place as numbers, and needs no text to be printed.

use std::collections::BTreeMap;
use std::fmt;

use armgen_codegen::diagnostic::Severity;

armgen_codegen::codes! {
    /// Kinds of faults of logs.
    pub enum Code {
        /// No line of names, or no line of numbers.
        EmptyLog Error "empty-log",
        /// A column that every log needs is not there.
        MissingColumn Error "missing-column",
        /// A column of a joint that the description does not have.
        UnknownJoint Error "unknown-joint",
        /// Two columns of one name.
        DuplicateColumn Error "duplicate-column",
        /// A field that holds no number.
        BadNumber Error "bad-number",
        /// NaN or an infinity.
        NotFinite Error "not-finite",
        /// A line with more fields than the header.
        WrongLength Error "wrong-length",
        /// A stamp that is not above the one before it.
        TimeNotIncreasing Error "time-not-increasing",
        /// More than three periods without a sample.
        TimeGap Warning "time-gap",
        /// A line with fewer fields than the header.
        TruncatedLine Warning "truncated-line",
        /// Torques at the effort limit, or several equal extreme ones.
        ClippedTorque Warning "clipped-torque",
        /// A signal that does not change while others do.
        StuckSignal Error "stuck-signal",
        /// Angles that look like degrees.
        DegreesSuspected Error "degrees-suspected",
        /// Stamps that look like milliseconds.
        MillisecondsSuspected Error "milliseconds-suspected",
        /// Rates that are not the derivatives of the positions.
        RateMismatch Error "rate-mismatch",
        /// Columns that fit another order of the joints.
        JointOrder Error "joint-order",
        /// A column that fits with the other sign.
        SignSuspected Error "sign-suspected",
        /// A joint that does not move.
        UnexcitedJoint Error "unexcited-joint",
        /// Too few blocks of time for the standard errors.
        ShortLog Warning "short-log",
        /// Estimates that move out of their intervals at half the cutoff.
        BiasedRegressor Warning "biased-regressor",
        /// A delay of a torque behind its position that is at the end of its range.
        DelayAtLimit Warning "delay-at-limit",
        /// Too few rows in motion for the unknowns.
        NoMotion Error "no-motion",
        /// Drive gains without a known load.
        GainScale Error "gain-scale",
        /// Currents without gains.
        NoGain Error "no-gain",
        /// A joint whose torque the model explains badly.
        PoorFit Warning "poor-fit",
        /// A line about an earlier identification that is not as it was written.
        BadBaseline Error "bad-baseline",
        /// A known load that fits better with another mass.
        LoadSuspected Warning "load-suspected",
        /// Options that do not fit the arm.
        BadOptions Error "bad-options",
    }
}

/// A fault of a log.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Its kind.
    pub code: Code,
    /// How bad it is here; a kind may be worse in one place than in another.
    pub severity: Severity,
    /// The log.
    pub log: String,
    /// The line, from 1; 0 for a fault of the whole log.
    pub line: usize,
    /// Where the field begins in its line, in bytes from 1; 0 for the whole line.
    pub at: usize,
    /// The column's name; empty for the whole line.
    pub column: String,
    /// The fault.
    pub text: String,
    /// The remedy.
    pub help: String,
}

impl Finding {
    /// A fault of a log as a whole, as bad as its code says.
    pub fn new(code: Code, log: &str, text: impl Into<String>, help: impl Into<String>) -> Finding {
        Finding {
            code,
            severity: code.severity(),
            log: log.to_owned(),
            line: 0,
            at: 0,
            column: String::new(),
            text: text.into(),
            help: help.into(),
        }
    }

    /// The same at a line, and at a place in it.
    #[must_use]
    pub fn at(self, line: usize, at: usize) -> Finding {
        Finding { line, at, ..self }
    }

    /// The same in a column.
    #[must_use]
    pub fn in_column(self, column: impl Into<String>) -> Finding {
        Finding { column: column.into(), ..self }
    }

    /// The same, as bad as that.
    #[must_use]
    pub fn as_bad_as(self, severity: Severity) -> Finding {
        Finding { severity, ..self }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}[{}]: {}", self.severity.name(), self.code, self.text)?;
        let place = match (self.line, self.at) {
            (0, _) => self.log.clone(),
            (line, 0) => format!("{}:{line}", self.log),
            (line, at) => format!("{}:{line}:{at}", self.log),
        };
        let column = if self.column.is_empty() { String::new() } else { format!(", column `{}`", self.column) };
        writeln!(f, " --> {place}{column}")?;
        if !self.help.is_empty() {
            writeln!(f, " = help: {}", self.help)?;
        }
        Ok(())
    }
}

/// Findings of one kind that are kept; more are counted.
pub const MOST_OF_A_KIND: usize = 20;

/// What was found, in order.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    all: Vec<Finding>,
    counts: BTreeMap<(String, Code), usize>,
}

impl Findings {
    /// Adds one; of a kind in one log, twenty are kept.
    pub fn push(&mut self, finding: Finding) {
        let count = self.counts.entry((finding.log.clone(), finding.code)).or_default();
        *count += 1;
        if *count <= MOST_OF_A_KIND {
            self.all.push(finding);
        }
    }

    /// Adds all of others.
    pub fn extend(&mut self, others: Findings) {
        for ((log, code), count) in &others.counts {
            let hidden = count.saturating_sub(MOST_OF_A_KIND);
            *self.counts.entry((log.clone(), *code)).or_default() += hidden;
        }
        others.all.into_iter().for_each(|finding| self.push(finding));
    }

    /// Those that are kept.
    pub fn iter(&self) -> impl Iterator<Item = &Finding> {
        self.all.iter()
    }

    /// Whether one is an error.
    pub fn has_errors(&self) -> bool {
        self.all.iter().any(|finding| finding.severity == Severity::Error)
    }

    /// Those that are kept, then how many of a kind are not.
    pub fn render(&self) -> String {
        let mut text: String = self.all.iter().map(|finding| format!("{finding}\n")).collect();
        for ((log, code), count) in self.counts.iter().filter(|(_, count)| **count > MOST_OF_A_KIND) {
            text += &format!("{log}: {} more of {code}\n", count - MOST_OF_A_KIND);
        }
        text
    }
}
