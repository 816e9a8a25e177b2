//! Experiment files: text -> [`Experiment`], or every fault with its position.
//!
//! ```text
//! values.rs        numbers, durations, lists and words under their keys
//! postures.rs path.rs clik.rs branch.rs control.rs expectation.rs     a part of the file each
//! code.rs          kinds of faults
//! ```
//!
//! After this module there are no YAML, wrong lengths, non-positive gains, unplannable paths or unknown quantities.

mod branch;
mod clik;
mod code;
mod control;
mod expectation;
mod path;
mod postures;
mod values;

use std::path::Path;

use armgen_codegen::diagnostic::{Code as Shared, Diagnostics};
use armgen_codegen::document::excerpt;
use armgen_codegen::document::reader::{self, first_key, optional, required, Fields, Key};
use armgen_codegen::document::yaml::{self, Kind, Node};
use armgen_codegen::source::{Source, Span};

use crate::model::{Body, Experiment, Robot, Sampling, Start};
use values::{Allowed, Reader};

pub use code::{Code, SHARED};
pub use path::motion;

/// The length of the longest accepted text, bytes.
pub const MAX_TEXT: usize = yaml::MAX_TEXT;
/// Maximum number of samples in a run: a minute at 30 kHz.
const MAX_SAMPLES: u128 = 2_000_000;

/// Returns the text of a file that an experiment names.
pub type Open<'o> = &'o dyn Fn(&Path) -> std::io::Result<String>;

/// The result of reading a file.
#[derive(Debug)]
pub enum Parsed {
    /// A valid experiment.
    Experiment(Box<Experiment>),
    /// An experiment for the robot with this name.
    OtherRobot(String),
    /// A path, to which experiments refer.
    Path,
    /// Faulty: each text, its own or its path's, with its diagnostics.
    Faulty(Vec<(Source, Diagnostics)>),
}

/// Reads an experiment for this robot; the path of a path file is relative to the folder of `file`.
pub fn experiment(file: &Path, source: &Source, robot: &Robot, open: Open<'_>) -> Parsed {
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(source, &mut diagnostics);
    let mut reader = Reader { document: reader::Reader::new(&mut diagnostics), robot };
    let begin = "begin with `robot:`, `title:` and `expect:`";
    let mut experiment = None;
    let mut of_path = None;
    if let Some(root) = reader.document.root(source, root.as_ref(), "an experiment", begin) {
        if let Some(place) = key_of_a_robot(root) {
            reader.report(
                Code::WrongFile,
                place,
                "this describes a robot, not an experiment",
                "a key of robot descriptions",
                "the lab moves the robot of robot.yaml: put this text there, and type `cargo run --release -- run`",
            );
        } else if is_path(root) {
            return Parsed::Path;
        } else if let Some(other) = other_robot(root, robot) {
            return Parsed::OtherRobot(other);
        } else {
            let name = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            let mut paths = Paths { file, open, faulty: &mut of_path };
            experiment = reader.experiment(root, name, &mut paths);
        }
    }
    diagnostics.sort();
    match experiment {
        Some(experiment) if of_path.is_none() && !diagnostics.has_errors() => Parsed::Experiment(Box::new(experiment)),
        _ => {
            let own = (!diagnostics.is_empty()).then(|| (source.clone(), diagnostics));
            Parsed::Faulty(of_path.into_iter().chain(own).collect())
        }
    }
}

/// Path files relative to an experiment's file.
struct Paths<'p> {
    file: &'p Path,
    open: Open<'p>,
    /// The text of a faulty path, and its diagnostics.
    faulty: &'p mut Option<(Source, Diagnostics)>,
}

/// The position of a key that occurs only in robot descriptions.
fn key_of_a_robot(root: &Node) -> Option<Span> {
    let Kind::Mapping(entries) = &root.kind else { return None };
    entries.iter().find(|(key, _)| ["joints", "convention"].contains(&key.value.as_str())).map(|(key, _)| key.span)
}

/// Whether the text is a path, to which experiments refer.
fn is_path(root: &Node) -> bool {
    let Kind::Mapping(entries) = &root.kind else { return false };
    let has = |name: &str| entries.iter().any(|(key, _)| key.value == name);
    has("segments") && !has("robot") && !has("expect")
}

fn other_robot(root: &Node, robot: &Robot) -> Option<String> {
    let Kind::Mapping(entries) = &root.kind else { return None };
    let (_, node) = entries.iter().find(|(key, _)| key.value == "robot")?;
    match &node.kind {
        Kind::Scalar(s) if s.text != robot.name && !s.is_nothing() => Some(excerpt(&s.text)),
        _ => None,
    }
}

const KEYS: [Key; 19] = [
    required("robot", "robot: scara"),
    required("title", "title: Inverse dynamics along a line"),
    optional("expect"),
    optional("group"),
    optional("postures"),
    optional("plane"),
    optional("grid"),
    optional("path"),
    optional("start"),
    optional("sampling"),
    optional("duration"),
    optional("task"),
    optional("clik"),
    optional("branch"),
    optional("controller"),
    optional("reference"),
    optional("load"),
    optional("sensor"),
    optional("simulation"),
];

impl Reader<'_> {
    fn experiment(&mut self, root: &Node, name: String, paths: &mut Paths<'_>) -> Option<Experiment> {
        let fields = self.mapping(root, "an experiment", first_key(root), &KEYS)?;
        let _ = self.word(&fields, "robot");
        let title = self.word(&fields, "title").map_or_else(String::new, |word| word.value);
        let group = self.word(&fields, "group").map(|word| word.value);
        let expectations = self.expectations(&fields);
        let body = self.body(&fields, paths)?;
        let expect = self.resolve(expectations, &body);
        Some(Experiment { name, title, group, body, expect })
    }

    fn body(&mut self, fields: &Fields<'_>, paths: &mut Paths<'_>) -> Option<Body> {
        if fields.has("postures") {
            let moving = [
                "path",
                "start",
                "sampling",
                "duration",
                "task",
                "clik",
                "branch",
                "controller",
                "reference",
                "load",
                "sensor",
                "simulation",
            ];
            self.out_of_place(fields, &moving, "an experiment with `postures` moves nothing");
            return self.postures(fields).map(Body::Postures);
        }
        self.out_of_place(fields, &["plane", "grid"], "only an experiment with `postures` has them");
        let sampling = self.sampling(fields, paths);
        if fields.has("branch") {
            let others = ["clik", "controller", "task", "reference", "load", "sensor", "simulation"];
            self.out_of_place(fields, &others, "`branch` follows a posture, and knows no dynamics");
            return self.branch(fields, sampling).map(Body::Branch);
        }
        match (fields.has("clik"), fields.has("controller")) {
            (true, true) => {
                let message = "an experiment has `clik` or `controller`, not both";
                self.report(Code::Ambiguous, fields.place("controller"), message, "one too many", "make two experiments of it");
                None
            }
            (false, false) => {
                let moving = ["start", "task", "reference", "load", "sensor", "simulation"];
                self.out_of_place(fields, &moving, "a path without `clik`, `branch` or `controller` is only planned");
                sampling.map(Body::Path)
            }
            (true, false) => {
                self.out_of_place(fields, &["reference", "load", "sensor", "simulation"], "`clik` knows no dynamics");
                self.clik(fields, sampling).map(Body::Clik)
            }
            (false, true) => {
                self.out_of_place(fields, &["task"], "a controller follows the task of the robot");
                self.control(fields, sampling).map(Body::Control)
            }
        }
    }

    fn sampling(&mut self, fields: &Fields<'_>, paths: &mut Paths<'_>) -> Option<Sampling> {
        self.require(fields, "path", "the experiment", "path: paths/ghost.yaml");
        self.require(fields, "sampling", "the experiment", "sampling: 0.001");
        let period = self.seconds(fields, "sampling", Allowed::Positive);
        let duration = self.seconds(fields, "duration", Allowed::Positive);
        let word = self.word(fields, "path")?;
        let path = paths.file.parent().unwrap_or(Path::new("")).join(&word.value);
        let text = match (paths.open)(&path) {
            Ok(text) => text,
            Err(error) => {
                let message = format!("the path {} cannot be read: {error}", path.display());
                let help = "`path` is relative to the experiment's file";
                self.report(Code::UnreadablePath, word.span, message, "no path there", help);
                return None;
            }
        };
        let source = Source::new(path.display().to_string(), text);
        let motion = match motion(&source) {
            Ok(motion) => motion,
            Err(diagnostics) => {
                *paths.faulty = Some((source, diagnostics));
                return None;
            }
        };
        let (duration, period) = (duration.unwrap_or(motion.trajectory.duration()), period?);
        if duration.as_nanos() / period.as_nanos() > MAX_SAMPLES {
            let help = "at most two million samples";
            self.report(Shared::OutOfRange, fields.place("sampling"), "the run has too many samples", "too short", help);
            return None;
        }
        Some(Sampling { motion, period, duration })
    }

    /// Joint variables, or `{from: path}`.
    fn start(&mut self, fields: &Fields<'_>) -> Option<Start> {
        self.require(fields, "start", "the experiment", "start: [0, pi/2, ...]` or `start: {from: path}");
        let (at, node) = fields.get("start")?;
        if !matches!(node.kind, Kind::Mapping(_)) {
            return self.joints(fields, "start").map(Start::Joints);
        }
        let keys = self.mapping(node, "`start`", at, &[required("from", "from: path"), optional("near")])?;
        self.choice(&keys, "from", &[("path", ())])?;
        match keys.has("near") {
            true => self.joints(&keys, "near").map(|near| Start::Path(Some(near))),
            false => Some(Start::Path(None)),
        }
    }
}
