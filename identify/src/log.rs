//! Logs: CSV with a line of names, read as a stream.
//!
//! Columns are found by name: `t`, `q_JOINT`, `dq_JOINT`, `tau_JOINT` or `current_JOINT`, and `qr_JOINT`. Every fault has its line and its place in it.

use std::collections::BTreeMap;
use std::io::BufRead;

use armgen_codegen::diagnostic::Severity;
use armgen_codegen::document::excerpt;
use armgen_codegen::suggest::did_you_mean;
use sha2::{Digest, Sha256};

use crate::finding::{Code, Finding, Findings};

/// How many of the SI unit a number of a log is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// s.
    pub time: f64,
    /// rad, of joints that turn; their rates are per second.
    pub angle: f64,
    /// m, of joints that slide and of loads; rates are per second.
    pub length: f64,
    /// kg, of loads.
    pub mass: f64,
    /// N m.
    pub torque: f64,
    /// N.
    pub force: f64,
    /// A.
    pub current: f64,
}

impl Default for Scales {
    fn default() -> Scales {
        Scales { time: 1.0, angle: 1.0, length: 1.0, mass: 1.0, torque: 1.0, force: 1.0, current: 1.0 }
    }
}

/// What a log is read as.
#[derive(Clone, Debug, Default)]
pub struct Format {
    /// Names of the joints, and whether each slides.
    pub joints: Vec<(String, bool)>,
    /// Names of the log, and the names that they stand for.
    pub columns: BTreeMap<String, String>,
    /// Units.
    pub scales: Scales,
    /// Whether a faulty row is a gap, and no error.
    pub skip_bad: bool,
    /// Whether the reference of the drives is read, too.
    pub with_reference: bool,
    /// The first and the last stamp that are used, s.
    pub span: [Option<f64>; 2],
}

/// A log.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// Its name.
    pub name: String,
    /// The first 16 digits of the SHA-256 of its bytes.
    pub digest: String,
    /// Lines of numbers in the file.
    pub samples: usize,
    /// Stamps, s, increasing.
    pub t: Vec<f64>,
    /// Positions, rad or m, by joint.
    pub q: Vec<Vec<f64>>,
    /// Rates, by joint; none where the log has none.
    pub dq: Option<Vec<Vec<f64>>>,
    /// The positions that the drives were to follow, by joint, where they are asked for.
    pub reference: Option<Vec<Vec<f64>>>,
    /// Torques (N m, N) or currents (A), by joint.
    pub effort: Vec<Vec<f64>>,
    /// Whether they are currents.
    pub is_current: bool,
    /// The line of each sample.
    pub lines: Vec<u32>,
    /// Names of columns that are not used.
    pub unused: Vec<String>,
}

impl Log {
    /// The column of the torque, or current, of a joint.
    pub fn effort_column(&self, joint: &str) -> String {
        format!("{}{joint}", if self.is_current { "current_" } else { "tau_" })
    }
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Signal {
    Time,
    Position(usize),
    Rate(usize),
    Torque(usize),
    Current(usize),
    Reference(usize),
}

const PREFIXES: [(&str, fn(usize) -> Signal); 5] = [
    ("q_", Signal::Position),
    ("dq_", Signal::Rate),
    ("tau_", Signal::Torque),
    ("current_", Signal::Current),
    ("qr_", Signal::Reference),
];

/// The fields of a line: where each begins, and its text.
fn fields(line: &str, separator: char) -> Vec<(usize, &str)> {
    let mut at = 0;
    line.split(separator)
        .map(|field| {
            let start = at + (field.len() - field.trim_start().len());
            at += field.len() + 1;
            (start + 1, field.trim().trim_matches('"'))
        })
        .collect()
}

/// Reads a log; what is wrong with it goes to the findings.
pub fn read(name: &str, mut from: impl BufRead, format: &Format) -> (Log, Findings) {
    let mut findings = Findings::default();
    let mut log = Log { name: name.to_owned(), ..Log::default() };
    let n = format.joints.len();
    log.q = vec![Vec::new(); n];
    log.effort = vec![Vec::new(); n];
    log.reference = format.with_reference.then(|| vec![Vec::new(); n]);
    let mut hash = Sha256::new();
    let mut number = 0;
    let mut bytes = Vec::new();
    let mut header: Option<Header> = None;
    let mut row = Vec::new();
    loop {
        bytes.clear();
        match from.read_until(b'\n', &mut bytes) {
            Ok(0) => break,
            Ok(_) => {}
            Err(error) => {
                findings.push(Finding::new(Code::EmptyLog, name, format!("the log cannot be read: {error}"), "").at(number, 0));
                break;
            }
        }
        hash.update(&bytes);
        number += 1;
        let is_whole = bytes.last() == Some(&b'\n');
        let text = String::from_utf8_lossy(&bytes);
        let mut text = text.trim_end_matches(['\n', '\r']);
        if number == 1 {
            text = text.trim_start_matches('\u{feff}');
        }
        if text.trim().is_empty() || text.trim_start().starts_with('#') {
            continue;
        }
        let Some(header) = &header else {
            header = Some(Header::read(name, number, text, format, &mut findings));
            if let Some(found) = &header {
                log.unused.clone_from(&found.unused);
                log.is_current = found.is_current;
                log.dq = found.has_rates.then(|| vec![Vec::new(); n]);
            }
            if findings.has_errors() {
                break;
            }
            continue;
        };
        log.samples += 1;
        if header.line_into(text, &mut row, &mut Place { log: name, number, is_whole, format }, &mut findings) {
            store(&mut log, &row, number, format, &mut findings);
        }
    }
    log.digest = hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    if header.is_none() {
        let help = "begin with a line of names: `t,q_JOINT,...,tau_JOINT,...`";
        findings.push(Finding::new(Code::EmptyLog, name, "the log holds no line of names", help));
    } else if log.t.is_empty() && !findings.has_errors() {
        findings.push(Finding::new(Code::EmptyLog, name, "the log holds no sample", "write a line of numbers for each sample"));
    }
    (log, findings)
}

/// Where a line stands.
struct Place<'a> {
    log: &'a str,
    number: usize,
    is_whole: bool,
    format: &'a Format,
}

/// What the line of names says.
struct Header {
    separator: char,
    names: Vec<String>,
    /// What each used column holds, and how many of the SI unit its numbers are; in the order time, q, dq, effort, reference.
    used: Vec<(usize, f64)>,
    unused: Vec<String>,
    is_current: bool,
    has_rates: bool,
}

impl Header {
    fn read(log: &str, number: usize, text: &str, format: &Format, findings: &mut Findings) -> Header {
        let separator = if text.contains(';') { ';' } else { ',' };
        let found = fields(text, separator);
        let names: Vec<String> = found.iter().map(|(_, name)| (*name).to_owned()).collect();
        let joints: Vec<&str> = format.joints.iter().map(|(name, _)| name.as_str()).collect();
        let mut of: BTreeMap<Signal, (usize, usize)> = BTreeMap::new();
        let mut unused = Vec::new();
        let mut strange = Vec::new();
        for (place, (at, own)) in found.iter().enumerate() {
            let name = format.columns.get(*own).map_or(*own, String::as_str);
            let signal = if name == "t" {
                Some(Signal::Time)
            } else {
                let mut known = PREFIXES.iter().filter(|(prefix, _)| format.with_reference || *prefix != "qr_");
                known.find_map(|(prefix, signal)| {
                    let joint = name.strip_prefix(prefix)?;
                    let found = joints.iter().position(|known| *known == joint);
                    if found.is_none() {
                        strange.push((place, *at, *prefix, joint.to_owned()));
                    }
                    found.map(*signal)
                })
            };
            match signal {
                None => unused.push((*own).to_owned()),
                Some(signal) => {
                    if let Some((first, _)) = of.insert(signal, (place, *at)) {
                        let text = format!("two columns are `{}`: column {} and column {}", excerpt(name), first + 1, place + 1);
                        let help = "leave one out, or rename it under `columns` of the options";
                        findings.push(Finding::new(Code::DuplicateColumn, log, text, help).at(number, *at).in_column(*own));
                    }
                }
            }
        }
        let count = |of: &BTreeMap<Signal, (usize, usize)>, signal: fn(usize) -> Signal| {
            (0..joints.len()).filter(|&i| of.contains_key(&signal(i))).count()
        };
        let is_current = count(&of, Signal::Torque) < joints.len() && count(&of, Signal::Current) > count(&of, Signal::Torque);
        let effort: (&str, fn(usize) -> Signal) =
            if is_current { ("current_", Signal::Current) } else { ("tau_", Signal::Torque) };
        let has_rates = count(&of, Signal::Rate) > 0;
        let mut wanted: Vec<(String, Signal, f64)> = vec![("t".into(), Signal::Time, format.scales.time)];
        let scale = |i: usize, turns: f64, slides: f64| if format.joints[i].1 { slides } else { turns };
        let Scales { angle, length, torque, force, current, .. } = format.scales;
        for i in 0..joints.len() {
            wanted.push((format!("q_{}", joints[i]), Signal::Position(i), scale(i, angle, length)));
        }
        for i in (0..joints.len()).filter(|_| has_rates) {
            wanted.push((format!("dq_{}", joints[i]), Signal::Rate(i), scale(i, angle, length)));
        }
        for i in 0..joints.len() {
            let unit = if is_current { current } else { scale(i, torque, force) };
            wanted.push((format!("{}{}", effort.0, joints[i]), effort.1(i), unit));
        }
        for i in (0..joints.len()).filter(|_| format.with_reference) {
            wanted.push((format!("qr_{}", joints[i]), Signal::Reference(i), scale(i, angle, length)));
        }
        let lacking: Vec<&(String, Signal, f64)> = wanted.iter().filter(|(_, signal, _)| !of.contains_key(signal)).collect();
        for (name, ..) in &lacking {
            let free: Vec<&str> = unused.iter().map(String::as_str).collect();
            let meant = did_you_mean(name, &free).map_or_else(String::new, |meant| {
                format!("did you mean column `{}`? Rename it under `columns` of the options. ", excerpt(meant))
            });
            let all: Vec<String> = names.iter().take(40).map(|name| excerpt(name)).collect();
            let either = if name.starts_with("tau_") { " (or currents, `current_JOINT`)" } else { "" };
            let text = format!("no column is `{name}`{either}");
            let help = format!("{meant}columns here: {}", all.join(", "));
            findings.push(Finding::new(Code::MissingColumn, log, text, help).at(number, 0).in_column(name));
        }
        for (place, at, prefix, joint) in strange {
            // A column that no joint lacks is another program's.
            if !lacking.iter().any(|(name, ..)| name.starts_with(prefix)) {
                continue;
            }
            let meant =
                did_you_mean(&joint, &joints).map_or_else(String::new, |meant| format!("did you mean `{prefix}{meant}`? "));
            let text = format!("the description has no joint `{}`", excerpt(&joint));
            let help = format!("{meant}joints: {}", joints.join(", "));
            findings.push(Finding::new(Code::UnknownJoint, log, text, help).at(number, at).in_column(&names[place]));
        }
        let used = wanted.iter().filter_map(|(_, signal, scale)| Some((of.get(signal)?.0, *scale))).collect();
        Header { separator, names, used, unused, is_current, has_rates }
    }

    /// The numbers of a line, in the order of the used columns; whether they are all there.
    fn line_into(&self, text: &str, row: &mut Vec<f64>, place: &mut Place<'_>, findings: &mut Findings) -> bool {
        row.clear();
        let found = fields(text, self.separator);
        let &mut Place { log, number, is_whole, format } = place;
        let badness = if format.skip_bad { Severity::Warning } else { Severity::Error };
        if found.len() != self.names.len() {
            let text = format!("the line has {} fields, the header {}", found.len(), self.names.len());
            let (code, badness, help) = match (found.len() < self.names.len(), is_whole) {
                (true, false) => (Code::TruncatedLine, Severity::Warning, "the last line was cut off, and is left out"),
                (true, true) => (Code::TruncatedLine, badness, "complete the line, or leave such rows out with `--skip-bad`"),
                (false, _) => (
                    Code::WrongLength,
                    badness,
                    "decimals have a point: with decimal commas a number is two fields; or leave such rows out with `--skip-bad`",
                ),
            };
            findings.push(Finding::new(code, log, text, help).at(number, 0).as_bad_as(badness));
            return false;
        }
        let mut good = true;
        for &(place, scale) in &self.used {
            let (at, field) = found[place];
            let wrong = match field.parse::<f64>() {
                Ok(value) if value.is_finite() => {
                    row.push(value * scale);
                    continue;
                }
                Ok(_) => (Code::NotFinite, format!("`{}` is no finite number", excerpt(field))),
                Err(_) if field.is_empty() => (Code::BadNumber, "the field is empty".to_owned()),
                Err(_) => (Code::BadNumber, format!("`{}` is no number", excerpt(field))),
            };
            let help = "mend the field, or leave such rows out with `--skip-bad`";
            let finding = Finding::new(wrong.0, log, wrong.1, help).at(number, at).in_column(&self.names[place]);
            findings.push(finding.as_bad_as(badness));
            good = false;
        }
        good
    }
}

/// Puts the numbers of a line into the log.
fn store(log: &mut Log, row: &[f64], number: usize, format: &Format, findings: &mut Findings) {
    let n = format.joints.len();
    let t = row[0];
    if format.span[0].is_some_and(|from| t < from) || format.span[1].is_some_and(|to| t > to) {
        return;
    }
    if let Some(&last) = log.t.last() {
        if t <= last {
            let (text, help, badness) = if t < log.t[0] + 0.1 * (last - log.t[0]) {
                let text = format!("the clock starts again: {t} s after {last} s");
                (text, format!("cut the log here: its second part begins at line {number}"), Severity::Error)
            } else {
                let text = format!("the stamp {t} s is not above the one before it, {last} s");
                let help = "stamps increase from line to line: leave repeated samples out, or have them left out by `--skip-bad`";
                (text, help.to_owned(), if format.skip_bad { Severity::Warning } else { Severity::Error })
            };
            let finding = Finding::new(Code::TimeNotIncreasing, &log.name, text, help).at(number, 0).in_column("t");
            findings.push(finding.as_bad_as(badness));
            return;
        }
    }
    log.t.push(t);
    log.lines.push(u32::try_from(number).unwrap_or(u32::MAX));
    let mut rest = &row[1..];
    let mut take = |into: &mut Vec<Vec<f64>>| {
        for (column, value) in into.iter_mut().zip(&rest[..n]) {
            column.push(*value);
        }
        rest = &rest[n..];
    };
    take(&mut log.q);
    if let Some(dq) = &mut log.dq {
        take(dq);
    }
    take(&mut log.effort);
    if let Some(reference) = &mut log.reference {
        take(reference);
    }
}
