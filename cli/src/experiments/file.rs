//! Experiment files: text -> [`Experiment`], or every fault with its place.
//!
//! Absent from here on: YAML, wrong lengths, gains that are not positive, paths that cannot be planned, quantities that do not exist.

use std::path::Path as FilePath;
use std::time::Duration;

use armgen_codegen::diagnostic::{Colour, Diagnostics};
use armgen_codegen::document::excerpt;
use armgen_codegen::document::yaml::{self, Kind, Node};
use armgen_codegen::source::{Source, Span};
use armgen_generated::{DOF, NAME, NOMINAL_PARAMETERS, PARAMETERS, PARAMETER_NAMES, TASK, TASK_ROWS};
use armgen_runtime::clik::Integration;
use armgen_runtime::control::{
    Adaptive, BoundaryLayer, Interval, InverseDynamics, OperationalSpace, PdGravity, Robust, TorqueLimits,
};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::parameters::ParameterError;
use armgen_runtime::task::{Row, Task};

use super::expectation::Expectation;
use super::motion::{self, Motion};
use super::reader::{Allowed, Fields, Reader, ROWS};
use super::{clik, control, manipulability, motion_check};

/// Samples of a run: a minute at 30 kHz.
const MAX_SAMPLES: u128 = 2_000_000;
/// Integration steps of a run: some seconds of work each million.
const MAX_STEPS: u128 = 20_000_000;
/// Postures of a grid.
const MAX_POSTURES: usize = 10_000;

/// Joint variables of the robot that this program was built with.
pub(crate) type Joints = SVector<f64, DOF>;

/// A valid experiment.
#[derive(Clone, Debug)]
pub(crate) struct Experiment {
    /// Name of its file, without the ending.
    pub(crate) name: String,
    /// One line that says what it shows.
    pub(crate) title: String,
    /// Experiments of one group are drawn into one figure, too.
    pub(crate) group: Option<String>,
    /// What is done.
    pub(crate) body: Body,
    /// What should come out.
    pub(crate) expect: Vec<Expectation>,
}

/// What an experiment does.
#[derive(Clone, Debug)]
pub(crate) enum Body {
    /// Manipulability at postures.
    Postures(Postures),
    /// A path as planned.
    Path(Sampling),
    /// Closed-loop inverse kinematics along a path.
    Clik(Box<ClikRun>),
    /// A controller along a path.
    Control(Box<ControlRun>),
}

/// Postures to be judged.
#[derive(Clone, Debug)]
pub(crate) struct Postures {
    /// Name and joint variables.
    pub(crate) list: Vec<(String, Joints)>,
    /// The two linear rows in which ellipsoids are drawn and measured.
    pub(crate) plane: [Row; 2],
    /// Further postures for a figure only: all combinations of values of the first two joints.
    pub(crate) grid: Option<[Vec<f64>; 2]>,
}

/// A path and when to look at it.
#[derive(Clone, Debug)]
pub(crate) struct Sampling {
    pub(crate) motion: Motion,
    pub(crate) period: Duration,
    pub(crate) duration: Duration,
}

/// A run of inverse kinematics.
#[derive(Clone, Debug)]
pub(crate) struct ClikRun {
    pub(crate) sampling: Sampling,
    pub(crate) start: Joints,
    /// The rows that are followed.
    pub(crate) rows: Vec<Row>,
    pub(crate) algorithm: Algorithm,
    pub(crate) gains: Vec<f64>,
}

/// Which algorithm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Algorithm {
    Inverse,
    Transpose,
    /// k_0, and the rows whose manipulability is climbed.
    PseudoInverse(f64, Option<Vec<Row>>),
    /// lambda_0, the greatest damping, and w_0, the manipulability below which it begins.
    Damped(f64, f64),
    /// K_D and the integration.
    SecondOrder(Vec<f64>, Integration),
}

/// A run of a controller.
#[derive(Clone, Debug)]
pub(crate) struct ControlRun {
    pub(crate) sampling: Sampling,
    pub(crate) start: Joints,
    /// Parameters of the plant.
    pub(crate) plant: [f64; PARAMETERS],
    /// K_P and K_D of the second-order inverse kinematics that makes the joint reference.
    pub(crate) reference: ([f64; TASK_ROWS], [f64; TASK_ROWS]),
    pub(crate) law: Law,
    /// Samples between measurement and torque.
    pub(crate) delay: usize,
    /// Deviations of measured positions and rates, and the seed.
    pub(crate) noise: (f64, f64, u32),
    /// Runge-Kutta steps a sample.
    pub(crate) substeps: u32,
    /// In continuous time instead, with so many Runge-Kutta steps a sample.
    pub(crate) continuous: Option<u32>,
}

/// Which controller.
#[derive(Clone, Debug)]
pub(crate) enum Law {
    PdGravity(PdGravity<f64, DOF>),
    InverseDynamics(InverseDynamics<f64, DOF>),
    Robust(Robust<f64, DOF>),
    Adaptive(Box<Adaptive<f64, DOF, PARAMETERS>>),
    OperationalSpace(Box<OperationalSpace<f64, DOF, TASK_ROWS>>),
}

/// What a file came to.
pub(crate) enum Parsed {
    /// It can be run.
    Experiment(Box<Experiment>),
    /// It needs this robot, which the program was not built with.
    OtherRobot(String),
    /// It is faulty: the faults as text, and their number.
    Faulty(String, usize),
}

/// The rows of the task of the robot.
pub(crate) fn task_rows() -> [Row; TASK_ROWS] {
    TASK.map(|i| ROWS[i].1)
}

/// The task of the robot.
pub(crate) fn task() -> Task<TASK_ROWS> {
    Task::new(task_rows()).expect("the description has been checked: no row stands twice")
}

/// Reads an experiment from its text; a path file is looked up beside `file`.
pub(crate) fn parse(file: &FilePath, source: &Source, colour: Colour) -> Parsed {
    let mut reader = Reader::default();
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(source, &mut diagnostics);
    reader.faults.extend(&diagnostics);
    let Some(root) = root else {
        if reader.faults.is_empty() {
            reader.faults.add(
                "empty-file",
                Span::new(0, 0),
                "the file describes nothing",
                "",
                "begin with `robot:`, `title:` and `expect:`",
            );
        }
        return Parsed::Faulty(reader.faults.render(source, colour), reader.faults.len());
    };
    if let Some(place) = key_of_a_robot(&root) {
        reader.faults.add(
            "wrong-file",
            place,
            "this describes a robot, not an experiment",
            "a key of robot descriptions",
            "`armgen run` moves the robot that it was built with: put this text into robot.yaml, rebuild, and run it without a file",
        );
        return Parsed::Faulty(reader.faults.render(source, colour), 1);
    }
    if let Some(other) = other_robot(&root) {
        return Parsed::OtherRobot(other);
    }
    let name = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let mut of_path = (String::new(), 0);
    let experiment = reader.experiment(&root, name, file, colour, &mut of_path);
    match experiment {
        Some(experiment) if reader.faults.is_empty() && of_path.1 == 0 => Parsed::Experiment(Box::new(experiment)),
        _ => Parsed::Faulty(of_path.0 + &reader.faults.render(source, colour), reader.faults.len() + of_path.1),
    }
}

/// The place of a key that only descriptions of robots have.
fn key_of_a_robot(root: &Node) -> Option<Span> {
    let Kind::Mapping(entries) = &root.kind else { return None };
    entries.iter().find(|(key, _)| ["joints", "convention"].contains(&key.value.as_str())).map(|(key, _)| key.span)
}

fn other_robot(root: &Node) -> Option<String> {
    let Kind::Mapping(entries) = &root.kind else { return None };
    let (_, node) = entries.iter().find(|(key, _)| key.value == "robot")?;
    match &node.kind {
        Kind::Scalar(s) if s.text != NAME && !s.is_nothing() => Some(excerpt(&s.text)),
        _ => None,
    }
}

const COMMON: [&str; 3] = ["robot", "title", "expect"];
const OPTIONAL: [&str; 15] = [
    "group",
    "postures",
    "plane",
    "grid",
    "path",
    "start",
    "sampling",
    "duration",
    "task",
    "clik",
    "controller",
    "reference",
    "load",
    "sensor",
    "simulation",
];

impl Reader {
    fn experiment(
        &mut self,
        root: &Node,
        name: String,
        file: &FilePath,
        colour: Colour,
        of_path: &mut (String, usize),
    ) -> Option<Experiment> {
        let first = match &root.kind {
            Kind::Mapping(entries) => entries.first().map_or(root.span, |(key, _)| key.span),
            _ => root.span,
        };
        let fields = self.mapping(root, "an experiment", first, &COMMON, &OPTIONAL)?;
        let _ = self.word(&fields, "robot");
        let title = self.word(&fields, "title").map_or_else(String::new, |word| word.value);
        let group = self.word(&fields, "group").map(|word| word.value);
        let expect = self.expectations(&fields);
        let body = self.body(&fields, file, colour, of_path);
        let body = body?;
        let (columns, singles, end) = match &body {
            Body::Postures(postures) => (Vec::new(), manipulability::singles(postures), 0.0),
            Body::Path(sampling) => (motion_check::columns(), motion_check::singles(sampling), sampling.duration.as_secs_f64()),
            Body::Clik(run) => (clik::columns(run), clik::singles(run), run.sampling.duration.as_secs_f64()),
            Body::Control(run) => (control::columns(run), control::singles(run), run.sampling.duration.as_secs_f64()),
        };
        self.check_quantities(&expect, &columns, &singles, end);
        Some(Experiment { name, title, group, body, expect })
    }

    fn body(&mut self, fields: &Fields<'_>, file: &FilePath, colour: Colour, of_path: &mut (String, usize)) -> Option<Body> {
        if fields.get("postures").is_some() {
            self.out_of_place(
                fields,
                &[
                    "path",
                    "start",
                    "sampling",
                    "duration",
                    "task",
                    "clik",
                    "controller",
                    "reference",
                    "load",
                    "sensor",
                    "simulation",
                ],
                "an experiment with `postures` moves nothing",
            );
            return self.postures(fields).map(Body::Postures);
        }
        self.out_of_place(fields, &["plane", "grid"], "only an experiment with `postures` has them");
        let sampling = self.sampling(fields, file, colour, of_path);
        let clik = fields.get("clik").is_some();
        let controller = fields.get("controller").is_some();
        match (clik, controller) {
            (true, true) => {
                let help = "make two experiments of it";
                self.faults.add(
                    "ambiguous",
                    fields.place("controller"),
                    "an experiment has `clik` or `controller`, not both",
                    "one too many",
                    help,
                );
                None
            }
            (false, false) => {
                self.out_of_place(
                    fields,
                    &["start", "task", "reference", "load", "sensor", "simulation"],
                    "a path without `clik` or `controller` is only planned",
                );
                sampling.map(Body::Path)
            }
            (true, false) => {
                self.out_of_place(fields, &["reference", "load", "sensor", "simulation"], "`clik` knows no dynamics");
                let run = self.clik(fields, sampling);
                run.map(|run| Body::Clik(Box::new(run)))
            }
            (false, true) => {
                self.out_of_place(fields, &["task"], "a controller follows the task of the robot");
                let run = self.control(fields, sampling);
                run.map(|run| Body::Control(Box::new(run)))
            }
        }
    }

    fn out_of_place(&mut self, fields: &Fields<'_>, names: &[&str], why: &str) {
        for name in names {
            if let Some((span, _)) = fields.get(name) {
                self.faults.add(
                    "out-of-place",
                    span,
                    format!("`{name}` has no meaning here: {why}"),
                    "out of place",
                    "remove it",
                );
            }
        }
    }

    fn missing(&mut self, fields: &Fields<'_>, name: &str, example: &str) {
        if fields.get(name).is_none() {
            let message = format!("the experiment lacks `{name}`");
            self.faults.add("missing-key", fields.at, message, "required here", format!("write for instance `{example}`"));
        }
    }

    fn joints(&mut self, node: &Node, at: Span, name: &str) -> Option<Joints> {
        let each = format!("one per joint of {NAME}, rad or m");
        let values = self.list(node, at, name, DOF, &each, Allowed::Any)?;
        Some(Joints::from_fn(|i, _| values[i]))
    }

    fn postures(&mut self, fields: &Fields<'_>) -> Option<Postures> {
        let (at, node) = fields.get("postures")?;
        let items = self.items(node, at, "postures", "write one `- {name: ..., q: [...]}` per posture")?.to_vec();
        let mut list = Vec::new();
        for item in &items {
            let fields = self.mapping(item, "a posture", item.span, &["name", "q"], &[])?;
            let name = self.word(&fields, "name")?;
            let (at, q) = fields.get("q")?;
            list.push((name.value, self.joints(q, at, "q")?));
        }
        if list.is_empty() {
            self.faults.add(
                "empty-list",
                at,
                "`postures` names no posture",
                "empty",
                "write one `- {name: ..., q: [...]}` per posture",
            );
        }
        let plane = match self.rows(fields, "plane") {
            None => [Row::X, Row::Y],
            Some(rows) => match <[Row; 2]>::try_from(rows) {
                Ok(plane) if plane.iter().all(|row| !row.is_angular()) => plane,
                _ => {
                    self.faults.add(
                        "wrong-length",
                        fields.place("plane"),
                        "`plane` takes two linear rows",
                        "here",
                        "for instance `plane: [x, y]`",
                    );
                    return None;
                }
            },
        };
        let grid = fields.get("grid").and_then(|(at, node)| {
            let fields = self.mapping(node, "`grid`", at, &["first", "second"], &[])?;
            let mut values = |name: &'static str| {
                let (at, node) = fields.get(name)?;
                let len = self.items(node, at, name, "write the values in brackets")?.len();
                self.list(node, at, name, len, "values of a joint", Allowed::Any)
            };
            let (first, second) = (values("first")?, values("second")?);
            if first.len() * second.len() > MAX_POSTURES {
                let help = format!("at most {MAX_POSTURES} combinations of both");
                let label = format!("{} combinations", first.len() * second.len());
                self.faults.add("out-of-range", at, "the grid has too many postures", label, help);
                return None;
            }
            Some([first, second])
        });
        Some(Postures { list, plane, grid })
    }

    fn sampling(
        &mut self,
        fields: &Fields<'_>,
        file: &FilePath,
        colour: Colour,
        of_path: &mut (String, usize),
    ) -> Option<Sampling> {
        self.missing(fields, "path", "path: paths/ghost.yaml");
        self.missing(fields, "sampling", "sampling: 0.001");
        let period = self.seconds(fields, "sampling", Allowed::Positive);
        let duration = self.seconds(fields, "duration", Allowed::Positive);
        let word = self.word(fields, "path")?;
        let path = file.parent().unwrap_or(FilePath::new("")).join(&word.value);
        match motion::read(&path) {
            Ok(motion) => {
                let duration = duration.unwrap_or(motion.trajectory.duration());
                let period = period?;
                if duration.as_nanos() / period.as_nanos() > MAX_SAMPLES {
                    let help = "at most two million samples";
                    self.faults.add("out-of-range", fields.place("sampling"), "the run has too many samples", "too short", help);
                    return None;
                }
                Some(Sampling { motion, period, duration })
            }
            Err((source, reader)) if source.text().is_empty() => {
                let mut faults = reader.faults;
                if faults.is_empty() {
                    faults.add("empty-file", Span::new(0, 0), "the path file is empty", "", "begin with `start:`");
                }
                self.faults.add(
                    "unreadable-path",
                    word.span,
                    format!("the path {} cannot be read", path.display()),
                    "no path there",
                    "`path` is relative to the experiment's file",
                );
                None
            }
            Err((source, reader)) => {
                *of_path = (reader.faults.render(&source, colour), reader.faults.len());
                None
            }
        }
    }

    fn start(&mut self, fields: &Fields<'_>) -> Option<Joints> {
        self.missing(fields, "start", "start: [0, pi/2, ...]");
        let (at, node) = fields.get("start")?;
        self.joints(node, at, "start")
    }

    fn clik(&mut self, fields: &Fields<'_>, sampling: Option<Sampling>) -> Option<ClikRun> {
        let start = self.start(fields);
        let rows = self.rows(fields, "task").unwrap_or_else(|| task_rows().to_vec());
        let (at, node) = fields.get("clik")?;
        let optional = ["k_0", "objective", "damping", "threshold", "k_d", "integration"];
        let keys = self.mapping(node, "`clik`", at, &["algorithm", "gains"], &optional)?;
        let word = self.word(&keys, "algorithm")?;
        let kinds = [("inverse", 0), ("transpose", 1), ("pseudo_inverse", 2), ("damped_least_squares", 3), ("second_order", 4)];
        let kind = self.choice(&word, "algorithm", &kinds)?;
        let (at, node) = keys.get("gains")?;
        let gains = self.list(node, at, "gains", rows.len(), "one per row of the task", Allowed::Positive);
        let belongs: &[&str] = match kind {
            2 => &["k_0", "objective"],
            3 => &["damping", "threshold"],
            4 => &["k_d", "integration"],
            _ => &[],
        };
        let others: Vec<&str> = optional.iter().copied().filter(|name| !belongs.contains(name)).collect();
        self.out_of_place(&keys, &others, &format!("the algorithm `{}` does not use it", word.value));
        let algorithm = match kind {
            0 => Algorithm::Inverse,
            1 => Algorithm::Transpose,
            2 => {
                let objective = self.rows(&keys, "objective");
                Algorithm::PseudoInverse(self.number(&keys, "k_0", Allowed::NotNegative).unwrap_or(0.0), objective)
            }
            3 => {
                self.missing(&keys, "damping", "damping: 0.03");
                self.missing(&keys, "threshold", "threshold: 0.1");
                let damping = self.number(&keys, "damping", Allowed::Positive);
                Algorithm::Damped(damping?, self.number(&keys, "threshold", Allowed::Positive)?)
            }
            _ => {
                self.missing(&keys, "k_d", "k_d: [20, 20, ...]");
                let integration = match self.word(&keys, "integration") {
                    None => Integration::HoldConsistent,
                    Some(word) => {
                        let words =
                            [("explicit_euler", Integration::ExplicitEuler), ("hold_consistent", Integration::HoldConsistent)];
                        self.choice(&word, "integration", &words)?
                    }
                };
                if rows != task_rows() {
                    self.out_of_place(fields, &["task"], "second order follows the task of the robot");
                }
                let (at, node) = keys.get("k_d")?;
                Algorithm::SecondOrder(
                    self.list(node, at, "k_d", rows.len(), "one per row of the task", Allowed::Positive)?,
                    integration,
                )
            }
        };
        Some(ClikRun { sampling: sampling?, start: start?, rows, algorithm, gains: gains? })
    }

    fn control(&mut self, fields: &Fields<'_>, sampling: Option<Sampling>) -> Option<ControlRun> {
        let start = self.start(fields);
        let mut plant = NOMINAL_PARAMETERS;
        self.parameters(fields, "load", &PARAMETER_NAMES, &mut plant);
        self.missing(fields, "reference", "reference: {k_p: [...], k_d: [...]}");
        let reference = fields.get("reference").and_then(|(at, node)| {
            let keys = self.mapping(node, "`reference`", at, &["k_p", "k_d"], &[])?;
            let k_p = self.array(&keys, "k_p", "one per row of the task", Allowed::Positive);
            Some((k_p?, self.array(&keys, "k_d", "one per row of the task", Allowed::Positive)?))
        });
        let (mut delay, mut noise) = (0, (0.0, 0.0, 0));
        if let Some((at, node)) = fields.get("sensor") {
            if let Some(keys) =
                self.mapping(node, "`sensor`", at, &[], &["delay", "position_deviation", "rate_deviation", "seed"])
            {
                delay = self.count(&keys, "delay", 0, 10).unwrap_or(0) as usize;
                noise.0 = self.number(&keys, "position_deviation", Allowed::NotNegative).unwrap_or(0.0);
                noise.1 = self.number(&keys, "rate_deviation", Allowed::NotNegative).unwrap_or(0.0);
                noise.2 = self.count(&keys, "seed", 0, u32::MAX).unwrap_or(0);
            }
        }
        let (mut substeps, mut continuous) = (1, None);
        if let Some((at, node)) = fields.get("simulation") {
            if let Some(keys) = self.mapping(node, "`simulation`", at, &[], &["substeps", "continuous"]) {
                substeps = self.count(&keys, "substeps", 1, 1000).unwrap_or(1);
                let yes = self
                    .word(&keys, "continuous")
                    .and_then(|word| self.choice(&word, "continuous", &[("true", true), ("false", false)]));
                if yes == Some(true) {
                    continuous = Some(substeps);
                }
            }
        }
        if let Some(Sampling { period, duration, .. }) = &sampling {
            if duration.as_nanos() / period.as_nanos() * u128::from(substeps) > MAX_STEPS {
                let help = "at most twenty million steps in all: fewer `substeps`, a longer `sampling`, a shorter `duration`";
                self.faults.add(
                    "out-of-range",
                    fields.place("simulation"),
                    "the run has too many integration steps",
                    "too many",
                    help,
                );
                return None;
            }
        }
        let period = sampling.as_ref().map(|sampling| sampling.period.as_secs_f64());
        let (at, node) = fields.get("controller")?;
        let law = self.law_of(node, at, period.unwrap_or(1e-3));
        let law = law?;
        if continuous.is_some() && !matches!(law, Law::Adaptive(_)) {
            let help = "remove `continuous`, or choose `law: adaptive`";
            self.faults.add(
                "out-of-place",
                fields.place("simulation"),
                "only the adaptive law runs in continuous time",
                "here",
                help,
            );
        }
        Some(ControlRun {
            sampling: sampling?,
            start: start?,
            plant,
            reference: reference?,
            law,
            delay,
            noise,
            substeps,
            continuous,
        })
    }

    fn law_of(&mut self, node: &Node, at: Span, period: f64) -> Option<Law> {
        let all = [
            "k_p",
            "k_d",
            "k_i",
            "p_position",
            "p_velocity",
            "rho",
            "epsilon",
            "lambda",
            "k_pi",
            "estimate",
            "adaptation",
            "lowest",
            "highest",
            "torque_limits",
        ];
        let keys = self.mapping(node, "`controller`", at, &["law"], &all)?;
        let word = self.word(&keys, "law")?;
        let kinds = [("pd_gravity", 0), ("inverse_dynamics", 1), ("robust", 2), ("adaptive", 3), ("operational_space", 4)];
        let kind = self.choice(&word, "law", &kinds)?;
        let needs: &[&str] = match kind {
            0 | 1 => &["k_p", "k_d"],
            2 => &["k_p", "k_d", "p_position", "p_velocity", "rho", "epsilon"],
            3 => &["lambda", "k_d", "k_pi"],
            _ => &["k_p", "k_d", "k_i"],
        };
        let may: &[&str] =
            if kind == 3 { &["estimate", "adaptation", "lowest", "highest", "torque_limits"] } else { &["torque_limits"] };
        let missing: Vec<String> = needs.iter().filter(|name| keys.get(name).is_none()).map(|name| format!("`{name}`")).collect();
        if !missing.is_empty() {
            let message = format!("the law `{}` lacks {}", word.value, missing.join(", "));
            self.faults.add("missing-key", keys.at, message, "required here", format!("keys of this law: {}", needs.join(", ")));
        }
        let others: Vec<&str> = all.iter().copied().filter(|name| !needs.contains(name) && !may.contains(name)).collect();
        self.out_of_place(&keys, &others, &format!("the law `{}` does not use it", word.value));
        let joint = |reader: &mut Self, name: &str| reader.array::<DOF>(&keys, name, "one per joint", Allowed::Positive);
        let limits = joint(self, "torque_limits").and_then(|bound| TorqueLimits::new(bound).ok());
        let law = match kind {
            0 => {
                let (k_p, k_d) = (joint(self, "k_p"), joint(self, "k_d"));
                PdGravity::new(k_p?, k_d?).map(|c| Law::PdGravity(limits.map_or(c, |l| c.with_torque_limits(l))))
            }
            1 => {
                let (k_p, k_d) = (joint(self, "k_p"), joint(self, "k_d"));
                InverseDynamics::new(k_p?, k_d?).map(|c| Law::InverseDynamics(limits.map_or(c, |l| c.with_torque_limits(l))))
            }
            2 => {
                let (k_p, k_d) = (joint(self, "k_p"), joint(self, "k_d"));
                let (p_position, p_velocity) = (joint(self, "p_position"), joint(self, "p_velocity"));
                let rho = self.number(&keys, "rho", Allowed::NotNegative);
                let epsilon = self.number(&keys, "epsilon", Allowed::Positive);
                let layer = BoundaryLayer { rho: rho?, epsilon: epsilon? };
                Robust::new(k_p?, k_d?, p_position?, p_velocity?, layer)
                    .map(|c| Law::Robust(limits.map_or(c, |l| c.with_torque_limits(l))))
            }
            3 => {
                let (lambda, k_d) = (joint(self, "lambda"), joint(self, "k_d"));
                let k_pi = self.array::<PARAMETERS>(&keys, "k_pi", "one per parameter of the regressor", Allowed::Positive);
                return self.adaptive(&keys, lambda?, k_d?, k_pi?, limits, period);
            }
            _ => {
                let row = |reader: &mut Self, name: &str, allowed| {
                    reader.array::<TASK_ROWS>(&keys, name, "one per row of the task", allowed)
                };
                let (k_p, k_d) = (row(self, "k_p", Allowed::Positive), row(self, "k_d", Allowed::Positive));
                let k_i = row(self, "k_i", Allowed::NotNegative);
                OperationalSpace::new(task(), k_p?, k_d?, k_i?, period)
                    .map(|c| Law::OperationalSpace(Box::new(limits.map_or(c, |l| c.with_torque_limits(l)))))
            }
        };
        law.map_err(|error| self.refused(&keys, error)).ok()
    }

    fn adaptive(
        &mut self,
        keys: &Fields<'_>,
        lambda: [f64; DOF],
        k_d: [f64; DOF],
        k_pi: [f64; PARAMETERS],
        limits: Option<TorqueLimits<f64, DOF>>,
        period: f64,
    ) -> Option<Law> {
        let mut estimate = NOMINAL_PARAMETERS;
        self.parameters(keys, "estimate", &PARAMETER_NAMES, &mut estimate);
        // Bounds as wide as numbers go where none is given.
        let (mut lowest, mut highest) = ([-f64::MAX / 4.0; PARAMETERS], [f64::MAX / 4.0; PARAMETERS]);
        let bounded = self.parameters(keys, "lowest", &PARAMETER_NAMES, &mut lowest)
            | self.parameters(keys, "highest", &PARAMETER_NAMES, &mut highest);
        let adapts = match self.word(keys, "adaptation") {
            None => true,
            Some(word) => self.choice(&word, "adaptation", &[("true", true), ("false", false)])?,
        };
        let built = Adaptive::new(lambda, k_d, k_pi, estimate, period).and_then(|c| {
            let c = limits.map_or(c, |l| c.with_torque_limits(l));
            let c = if bounded { c.with_projection(Interval::new(lowest, highest)?) } else { c };
            Ok(if adapts { c } else { c.with_frozen([true; PARAMETERS]) })
        });
        built.map(|c| Law::Adaptive(Box::new(c))).map_err(|error| self.refused(keys, error)).ok()
    }

    fn refused(&mut self, keys: &Fields<'_>, error: ParameterError) {
        let message = error.to_string();
        self.faults.add("not-positive", keys.at, message, "in this controller", "gains are positive and finite, bounds in order");
    }
}
