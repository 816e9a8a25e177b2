//! The options of an identification, from a file in YAML.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Code, Diagnostics};
use armgen_codegen::document::reader::{optional, required, Fields, Key, Reader};
use armgen_codegen::document::yaml::{self, Kind, Node};
use armgen_codegen::document::{excerpt, Unit};
use armgen_codegen::source::{Source, Span};

use crate::log::Scales;
use crate::prepare::Friction;

/// The load of a log, in the end-effector frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Load {
    /// Whether there is a load; without, nothing of it is identified.
    pub is_there: bool,
    /// Its mass, kg; identified where it is not given.
    pub mass: Option<f64>,
    /// Its centre of mass, m; identified where it is not given.
    pub com: Option<[f64; 3]>,
}

/// A log that the options name.
#[derive(Clone, Debug, Default)]
pub struct LogOptions {
    /// The file.
    pub file: String,
    /// First and last stamp, s.
    pub span: [Option<f64>; 2],
    /// Logs of one session share friction.
    pub session: String,
    /// Its load.
    pub load: Load,
}

/// Where drive gains come from.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Gains {
    /// The description.
    #[default]
    File,
    /// The logs.
    Identify,
    /// These, N m/A or N/A.
    Given(Vec<f64>),
}

/// Choices of an identification.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Logs in place of those of the command line.
    pub logs: Vec<LogOptions>,
    /// Logs to judge by.
    pub validate: Vec<String>,
    /// Names of the log, and the names that they stand for.
    pub columns: BTreeMap<String, String>,
    /// Units of the logs and of their loads.
    pub scales: Scales,
    /// Drive gains.
    pub gains: Gains,
    /// Terms of friction; chosen by cross-validation where none are named.
    pub friction: Option<Vec<Friction>>,
    /// Whether torques are measured behind the gear.
    pub link_side: bool,
    /// Hz; chosen where it is not given.
    pub cutoff: Option<f64>,
    /// s, by joint or one for all; estimated where it is not given.
    pub delay: Option<Vec<f64>>,
    /// Entries that keep the values of the file, as `shoulder.friction.offset`.
    pub keep: Vec<String>,
    /// Entries with given values.
    pub fixed: Vec<(String, f64)>,
    /// Joints that are locked in all logs.
    pub without: Vec<String>,
    /// Whether columns along the reference of the drives are instruments.
    pub instruments: bool,
    /// Whether faulty rows of logs are gaps.
    pub skip_bad: bool,
}

const KEYS: [Key; 14] = [
    optional("logs"),
    optional("validate"),
    optional("columns"),
    optional("units"),
    optional("gains"),
    optional("friction"),
    optional("torque"),
    optional("cutoff"),
    optional("delay"),
    optional("keep"),
    optional("fixed"),
    optional("without"),
    optional("instruments"),
    optional("skip_bad"),
];
const LOG: [Key; 5] =
    [required("file", "file: free.csv"), optional("from"), optional("to"), optional("session"), optional("load")];
const LOAD: [Key; 2] = [optional("mass"), optional("com")];
const UNITS: [Key; 7] = [
    optional("time"),
    optional("angle"),
    optional("length"),
    optional("mass"),
    optional("torque"),
    optional("force"),
    optional("current"),
];

/// Reads options; faults go to the diagnostics.
pub fn read(source: &Source) -> (Options, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let mut options = Options::default();
    let root = yaml::read(source, &mut diagnostics);
    let mut reader = Reading { reader: Reader::new(&mut diagnostics) };
    let begin = "write for instance `cutoff: auto`";
    if let Some(root) = reader.reader.root(source, root.as_ref(), "an options file", begin) {
        if let Some(fields) = reader.reader.mapping(root, "the options", Span::new(0, 0), &KEYS) {
            reader.all(&fields, &mut options);
        }
    }
    diagnostics.sort();
    (options, diagnostics)
}

struct Reading<'d> {
    reader: Reader<'d>,
}

impl Reading<'_> {
    fn all(&mut self, fields: &Fields<'_>, options: &mut Options) {
        // Loads of logs are in these units.
        if let Some((key, node)) = fields.get("units") {
            self.units(node, key, &mut options.scales);
        }
        if let Some((key, node)) = fields.get("logs") {
            for item in self.list(node, key, "logs") {
                options.logs.extend(self.log(item, &options.scales));
            }
        }
        if let Some((key, node)) = fields.get("validate") {
            options.validate =
                self.list(node, key, "validate").iter().filter_map(|item| self.text(item, key, "validate")).collect();
        }
        if let Some((key, node)) = fields.get("columns") {
            options.columns = self.pairs(node, key, "columns").into_iter().collect();
        }
        if let Some((key, node)) = fields.get("gains") {
            options.gains = match &node.kind {
                Kind::List(items) => {
                    Gains::Given(items.iter().filter_map(|item| self.number(item, item.span, "a gain")).collect())
                }
                _ => {
                    let words = [("file", false), ("identify", true)];
                    let help = "`file`: those of the description; `identify`: from a log with a known load; or a list of numbers";
                    match self.reader.choice(node, key, "gains", &words, Code::WrongKind, help) {
                        Some(found) if found.value => Gains::Identify,
                        _ => Gains::File,
                    }
                }
            };
        }
        if let Some((key, node)) = fields.get("friction").filter(|(_, node)| !is_word(node, "auto")) {
            let words = Friction::ALL.map(|term| (term.key(), term));
            let help = "`auto`, or terms in brackets: `friction: [viscous, coulomb, offset]`";
            let terms = match &node.kind {
                Kind::List(items) => items
                    .iter()
                    .filter_map(|item| self.reader.choice(item, key, "a term of `friction`", &words, Code::WrongKind, help))
                    .map(|term| term.value)
                    .collect(),
                _ => {
                    self.reader.wrong_kind(node, key, "friction", "`auto` or a list of terms", help);
                    Vec::new()
                }
            };
            options.friction = Some(terms);
        }
        if let Some((key, node)) = fields.get("torque") {
            let help = "`motor`: torques in front of the gear, times the ratio; `link`: torques behind it, which feel no rotor";
            let words = [("motor", false), ("link", true)];
            options.link_side =
                self.reader.choice(node, key, "torque", &words, Code::WrongKind, help).is_some_and(|found| found.value);
        }
        if let Some((key, node)) = fields.get("cutoff").filter(|(_, node)| !is_word(node, "auto")) {
            options.cutoff = self.positive(node, key, "cutoff");
        }
        if let Some((key, node)) = fields.get("delay").filter(|(_, node)| !is_word(node, "auto")) {
            let delays: Vec<f64> = match &node.kind {
                Kind::List(items) => items.iter().filter_map(|item| self.number(item, item.span, "a delay")).collect(),
                _ => self.number(node, key, "delay").into_iter().collect(),
            };
            options.delay = Some(delays.into_iter().map(|ms| ms * 1e-3).collect());
        }
        if let Some((key, node)) = fields.get("keep") {
            options.keep = self.list(node, key, "keep").iter().filter_map(|item| self.text(item, key, "keep")).collect();
        }
        if let Some((key, node)) = fields.get("fixed") {
            if let Kind::Mapping(entries) = &node.kind {
                for (name, value) in entries {
                    if let Some(number) = self.number(value, name.span, &name.value) {
                        options.fixed.push((name.value.clone(), number));
                    }
                }
            } else {
                self.reader.wrong_kind(node, key, "fixed", "a mapping", "write for instance `fixed: {elbow.friction.offset: 0}`");
            }
        }
        if let Some((key, node)) = fields.get("without") {
            options.without = self.list(node, key, "without").iter().filter_map(|item| self.text(item, key, "without")).collect();
        }
        options.instruments = self.flag(fields, "instruments");
        options.skip_bad = self.flag(fields, "skip_bad");
    }

    fn flag(&mut self, fields: &Fields<'_>, name: &'static str) -> bool {
        let Some((key, node)) = fields.get(name) else { return false };
        let found =
            self.reader.choice(node, key, name, &[("true", true), ("false", false)], Code::WrongKind, "`true` or `false`");
        found.is_some_and(|found| found.value)
    }

    fn log(&mut self, node: &Node, scales: &Scales) -> Option<LogOptions> {
        let at = armgen_codegen::document::reader::first_key(node);
        let fields = self.reader.mapping(node, "a log", at, &LOG)?;
        let mut log = LogOptions::default();
        if let Some((key, node)) = fields.get("file") {
            log.file = self.text(node, key, "file")?;
        }
        log.span = ["from", "to"].map(|name| fields.get(name).and_then(|(key, node)| self.number(node, key, name)));
        if let Some((key, node)) = fields.get("session") {
            log.session = self.text(node, key, "session").unwrap_or_default();
        }
        if let Some((key, node)) = fields.get("load").filter(|(_, node)| !is_word(node, "none")) {
            log.load.is_there = true;
            if !is_word(node, "unknown") {
                let fields = self.reader.mapping(node, "`load`", key, &LOAD)?;
                log.load.mass =
                    fields.get("mass").and_then(|(key, node)| self.positive(node, key, "mass")).map(|m| scales.mass * m);
                log.load.com = fields.get("com").and_then(|(key, node)| {
                    let numbers: Vec<f64> = self
                        .list(node, key, "com")
                        .iter()
                        .filter_map(|item| self.number(item, item.span, "an element of `com`"))
                        .map(|c| scales.length * c)
                        .collect();
                    numbers.try_into().ok()
                });
            }
        }
        Some(log)
    }

    fn units(&mut self, node: &Node, key: Span, scales: &mut Scales) {
        let Some(fields) = self.reader.mapping(node, "`units`", key, &UNITS) else { return };
        let slots: [(&str, &str, &mut f64); 7] = [
            ("time", "s", &mut scales.time),
            ("angle", "rad", &mut scales.angle),
            ("length", "m", &mut scales.length),
            ("mass", "kg", &mut scales.mass),
            ("torque", "N m", &mut scales.torque),
            ("force", "N", &mut scales.force),
            ("current", "A", &mut scales.current),
        ];
        for (name, si, slot) in slots {
            let Some((key, node)) = fields.get(name) else { continue };
            let Some(text) = self.text(node, key, name) else { continue };
            let other = match text.as_str() {
                "ms" => Some(1e-3),
                "us" | "µs" => Some(1e-6),
                "ns" => Some(1e-9),
                "A" => Some(1.0),
                "mA" => Some(1e-3),
                "deg" | "degree" | "degrees" => Some(1f64.to_radians()),
                _ => None,
            };
            let own =
                matches!((name, text.as_str()), ("time", "ms" | "us" | "µs" | "ns") | ("current", "A" | "mA") | ("angle", _));
            let named = Unit::named(&text).filter(|(_, of)| *of == si).map(|(unit, _)| unit.to_f64());
            match named.or(other.filter(|_| own)) {
                Some(factor) => *slot = factor,
                None => {
                    let message = format!("`{}` is no unit of `{name}`", excerpt(&text));
                    let help =
                        "units are for instance time: ms, angle: deg, length: mm, mass: lb, torque: Nmm, force: N, current: mA";
                    self.reader.report(Code::UnknownUnit, node.span, message, "unknown unit", help);
                }
            }
        }
    }

    fn list<'n>(&mut self, node: &'n Node, key: Span, name: &str) -> &'n [Node] {
        self.reader.list(node, key, name, "a list", "write the elements in brackets or one a line behind `-`").unwrap_or_default()
    }

    fn pairs(&mut self, node: &Node, key: Span, name: &str) -> Vec<(String, String)> {
        let Kind::Mapping(entries) = &node.kind else {
            self.reader.wrong_kind(node, key, name, "a mapping", "write for instance `columns: {actual_q_0: q_shoulder}`");
            return Vec::new();
        };
        let pairs = entries
            .iter()
            .filter_map(|(name, value)| Some((name.value.clone(), self.text(value, name.span, name.value.as_str())?)));
        pairs.collect()
    }

    fn text(&mut self, node: &Node, key: Span, name: &str) -> Option<String> {
        self.reader.text(node, key, name, "a text", "write one text here").map(|text| text.value)
    }

    fn number(&mut self, node: &Node, key: Span, name: &str) -> Option<f64> {
        let expression = self.reader.expression(node, key, name, "write a number")?;
        match expression.to_f64() {
            Ok(number) if number.is_finite() => Some(number),
            Ok(_) => {
                self.reader.report(Code::NotFinite, node.span, format!("`{name}` is not finite"), "not finite", "write a number");
                None
            }
            Err(place) => {
                self.reader.report(Code::UnknownName, place, "names have no values here", "unknown name", "write a number");
                None
            }
        }
    }

    fn positive(&mut self, node: &Node, key: Span, name: &str) -> Option<f64> {
        let number = self.number(node, key, name)?;
        if number <= 0.0 {
            let message = format!("`{name}` is not positive");
            self.reader.report(Code::NonPositiveLimit, node.span, message, "not above 0", "write a number above 0");
            return None;
        }
        Some(number)
    }
}

fn is_word(node: &Node, word: &str) -> bool {
    matches!(&node.kind, Kind::Scalar(scalar) if scalar.text == word)
}
