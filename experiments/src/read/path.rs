//! Path files: translation and rotation of the end effector, and their time laws.

use std::time::Duration;

use armgen_codegen::diagnostic::{Code as Shared, Diagnostics};
use armgen_codegen::document::reader::{self, first_key, optional, required, Fields};
use armgen_codegen::document::yaml::{self, Kind, Node};
use armgen_codegen::source::{Source, Span};
use armgen_runtime::nalgebra::Matrix3;
use armgen_runtime::trajectory::{OperationalTrajectory, OrientationProfile, Path, PlanError, PlanFault, Segment, TimeLaw, Turn};

use super::values::{optionals, Allowed, Numbers, Reader};
use super::Code;
use crate::model::{Motion, Robot, Sheet};

const LAW: [&str; 5] = ["duration", "acceleration_time", "law", "velocity", "acceleration"];
const XYZ: &str = "x, y, z in m";

/// Reads a path and plans its motion.
///
/// # Errors
/// All faults with their positions.
pub fn motion(source: &Source) -> Result<Motion, Diagnostics> {
    // A path does not depend on a robot.
    let robot = Robot { name: String::new(), joints: Vec::new(), parameters: Vec::new(), task: Vec::new() };
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(source, &mut diagnostics);
    let mut reader = Reader { document: reader::Reader::new(&mut diagnostics), robot: &robot };
    let root = reader.document.root(source, root.as_ref(), "a path", "begin with `start: [x, y, z]` and `segments:`");
    let motion = match root.and_then(key_of_an_experiment) {
        None => root.and_then(|root| reader.motion(root)),
        Some(place) => {
            let help = "name the file with its `start` and `segments`, which experiments have apart from theirs";
            reader.report(Code::WrongFile, place, "this is an experiment, not a path", "a key of experiments", help);
            None
        }
    };
    diagnostics.sort();
    motion.filter(|_| !diagnostics.has_errors()).ok_or(diagnostics)
}

/// The position of a key that occurs only in experiments.
fn key_of_an_experiment(root: &Node) -> Option<Span> {
    let Kind::Mapping(entries) = &root.kind else { return None };
    entries.iter().find(|(key, _)| ["robot", "expect", "path"].contains(&key.value.as_str())).map(|(key, _)| key.span)
}

/// The reason why a segment is infeasible, and a remedy.
fn explain(fault: PlanFault) -> (&'static str, &'static str) {
    match fault {
        PlanFault::NotFinite => ("a number is not finite", "write finite numbers"),
        PlanFault::NoDuration => ("its duration is zero", "give it a duration"),
        PlanFault::NoAccelerationTime => {
            ("its acceleration time is zero: the acceleration would be infinite", "give an `acceleration_time`")
        }
        PlanFault::CruiseTimeNegative => (
            "its cruise time, duration - 2 acceleration_time, is below zero",
            "lengthen `duration` or shorten `acceleration_time`",
        ),
        PlanFault::AccelerationTooSmall => {
            ("the acceleration is too small for length and duration", "at least 4 length / duration²")
        }
        PlanFault::VelocityOutOfRange => {
            ("no trapezoid has this velocity, length and duration", "above length / duration, at most twice that")
        }
        PlanFault::LimitNotPositive => ("a limit is not positive", "write positive limits"),
        PlanFault::TooLong => ("it would take longer than the clock can count", "raise the limits"),
        PlanFault::ArcRadiusZero => ("the arc starts at its own centre", "move the centre"),
        PlanFault::AxisZero => ("its axis has no direction", "for instance `axis: [0, 0, 1]`"),
        PlanFault::ArcOffPlane => {
            ("the start of the arc does not lie in its plane", "the plane goes through `centre`, at right angles to `axis`")
        }
        PlanFault::ArcEndMismatch => ("the arc does not end at the stated point", "centre, sweep and points must fit together"),
        PlanFault::ArcPointsCollinear => ("the points of the arc lie on a line", "move the point between"),
        PlanFault::NothingToAnticipate => {
            ("the first segment has nothing before it that it could anticipate", "remove `anticipation`")
        }
        PlanFault::AnticipationTooLong => {
            ("it would start before the previous segment does, or while the one before that is at work", "shorten `anticipation`")
        }
        PlanFault::OutOfReach => ("it leaves the reach of the arm", "move its points"),
        PlanFault::NotARotation => ("`frame` is not a rotation", "three orthogonal rows of length 1, right-handed"),
    }
}

/// The time laws with names.
#[derive(Clone, Copy, PartialEq)]
enum TimeLawKind {
    Trapezoidal,
    Cubic,
    Quintic,
}

impl Reader<'_> {
    fn motion(&mut self, root: &Node) -> Option<Motion> {
        let keys = [
            required("start", "start: [0.5, 0, 0.1]"),
            required("segments", "segments:` and below it one `- {line: ..., ...}"),
            optional("frame"),
            optional("turns"),
            optional("sheet"),
        ];
        let fields = self.mapping(root, "a path", first_key(root), &keys)?;
        let start = self.array::<3>(&fields, "start", XYZ, Allowed::Any);
        let frame = self.frame(&fields);
        let sheet = fields.get("sheet").and_then(|(at, node)| {
            let fields = self.mapping(node, "`sheet`", at, &[required("top", "top: 0.01"), required("depth", "depth: 0")])?;
            Some(Sheet { top: self.number(&fields, "top", Allowed::Any)?, depth: self.number(&fields, "depth", Allowed::Any)? })
        });
        let segments = self.elements(&fields, "segments", Self::segment);
        let turns = self.elements(&fields, "turns", Self::turn);
        if self.document.has_errors() {
            return None;
        }
        let places: Vec<Span> = segments.iter().map(|(span, _)| *span).collect();
        let path = match Path::plan(start?, segments.into_iter().map(|(_, s)| s).collect::<Vec<_>>()) {
            Ok(path) => Some(path),
            Err(error) => {
                self.cannot("segment", &places, fields.place("start"), error);
                None
            }
        };
        let places: Vec<Span> = turns.iter().map(|(span, _)| *span).collect();
        let orientation = match OrientationProfile::plan(frame, turns.into_iter().map(|(_, t)| t).collect::<Vec<_>>()) {
            Ok(orientation) => Some(orientation),
            Err(error) => {
                self.cannot("turn", &places, fields.place("frame"), error);
                None
            }
        };
        Some(Motion { trajectory: OperationalTrajectory { path: path?, orientation: orientation? }, frame, sheet })
    }

    /// Reports an element that cannot be planned, or the common start of all elements.
    fn cannot(&mut self, element: &str, places: &[Span], start: Span, error: PlanError) {
        let (why, help) = explain(error.fault);
        let (at, what) = match error.segment.checked_sub(1).and_then(|i| places.get(i)) {
            Some(at) => (*at, format!("{element} {}", error.segment)),
            None => (start, "the path".to_owned()),
        };
        self.report(Code::Infeasible, at, format!("{what} cannot be planned: {why}"), "this one", help);
    }

    fn frame(&mut self, fields: &Fields<'_>) -> Matrix3<f64> {
        let Some((at, node)) = fields.get("frame") else { return Matrix3::identity() };
        let help = "write the rotation matrix row by row: `[[1, 0, 0], [0, 1, 0], [0, 0, 1]]`";
        let Some(items) = self.items(node, at, "frame", help) else { return Matrix3::identity() };
        if items.len() != 3 {
            let label = format!("{} instead of 3", items.len());
            self.report(Shared::WrongLength, node.span, "`frame` takes 3 rows", label, help);
            return Matrix3::identity();
        }
        let wanted = Numbers { len: 3, each: "one row", allowed: Allowed::Any };
        let rows: Vec<Vec<f64>> = items.iter().filter_map(|row| self.list(row, row.span, "frame", wanted)).collect();
        if rows.len() == 3 {
            Matrix3::from_fn(|i, k| rows[i][k])
        } else {
            Matrix3::identity()
        }
    }

    fn elements<T>(
        &mut self,
        fields: &Fields<'_>,
        name: &str,
        read: impl Fn(&mut Self, &Node, Span) -> Option<T>,
    ) -> Vec<(Span, T)> {
        let Some((at, node)) = fields.get(name) else { return Vec::new() };
        let Some(items) = self.items(node, at, name, "write one `- {...}` per element") else { return Vec::new() };
        let mut all = Vec::new();
        for item in items {
            let place = first_key(item);
            if let Some(element) = read(self, item, place) {
                all.push((place, element));
            }
        }
        all
    }

    fn time_law(&mut self, fields: &Fields<'_>) -> Option<TimeLaw<f64>> {
        let duration = self.seconds(fields, "duration", Allowed::Positive);
        let words = [("trapezoidal", TimeLawKind::Trapezoidal), ("cubic", TimeLawKind::Cubic), ("quintic", TimeLawKind::Quintic)];
        let kind = match fields.has("law") {
            true => self.choice(fields, "law", &words)?.value,
            false => TimeLawKind::Trapezoidal,
        };
        let rise = self.seconds(fields, "acceleration_time", Allowed::Positive);
        let velocity = self.number(fields, "velocity", Allowed::Positive);
        let acceleration = self.number(fields, "acceleration", Allowed::Positive);
        match (kind, duration, rise, velocity, acceleration) {
            (TimeLawKind::Trapezoidal, Some(duration), Some(acceleration_time), None, None) => {
                Some(TimeLaw::Trapezoidal { duration, acceleration_time })
            }
            (TimeLawKind::Trapezoidal, Some(duration), None, None, Some(acceleration)) => {
                Some(TimeLaw::TrapezoidalByAcceleration { duration, acceleration })
            }
            (TimeLawKind::Trapezoidal, Some(duration), None, Some(velocity), None) => {
                Some(TimeLaw::TrapezoidalByVelocity { duration, velocity })
            }
            (TimeLawKind::Trapezoidal, None, None, Some(velocity), Some(acceleration)) => {
                Some(TimeLaw::TrapezoidalByLimits { velocity, acceleration })
            }
            (TimeLawKind::Cubic, Some(duration), None, None, None) => Some(TimeLaw::Cubic { duration }),
            (TimeLawKind::Quintic, Some(duration), None, None, None) => Some(TimeLaw::Quintic { duration }),
            _ => {
                let help = "`duration` with `acceleration_time`, `velocity` or `acceleration`; `velocity` with `acceleration`; or `duration` with `law: cubic` or `law: quintic`";
                self.report(Code::TimeLaw, fields.at(), "these keys make no time law", "no law", help);
                None
            }
        }
    }

    fn segment(&mut self, node: &Node, at: Span) -> Option<Segment<f64>> {
        let mut keys = optionals(&["line", "arc", "centre", "axis", "sweep", "through", "pause", "anticipation"]);
        keys.extend(optionals(&LAW));
        let fields = self.mapping(node, "a segment", at, &keys)?;
        let anticipation = self.seconds(&fields, "anticipation", Allowed::Any).unwrap_or(Duration::ZERO);
        let segment = if fields.has("line") {
            self.out_of_place(&fields, &["arc", "through", "centre", "axis", "sweep", "pause"], "the segment is a `line`");
            Segment::line(self.array(&fields, "line", XYZ, Allowed::Any)?, self.time_law(&fields)?)
        } else if fields.has("arc") {
            self.out_of_place(&fields, &["pause"], "the segment is an `arc`");
            self.arc(&fields)?
        } else if fields.has("pause") {
            self.out_of_place(&fields, &["through", "centre", "axis", "sweep"], "the segment is a `pause`");
            self.out_of_place(&fields, &LAW, "a `pause` has no time law");
            Segment::pause(self.seconds(&fields, "pause", Allowed::Positive)?)
        } else {
            self.report(
                Shared::MissingKey,
                at,
                "a segment is a `line`, an `arc` or a `pause`",
                "none of them",
                "for instance `{line: [0.5, 0, 0.1], duration: 1, acceleration_time: 0.2}`",
            );
            return None;
        };
        Some(segment.anticipating(anticipation))
    }

    fn arc(&mut self, fields: &Fields<'_>) -> Option<Segment<f64>> {
        let to = self.array(fields, "arc", XYZ, Allowed::Any)?;
        if fields.has("through") {
            self.out_of_place(fields, &["centre", "axis", "sweep"], "three points are an arc: its start, `through` and its end");
            let via = self.array(fields, "through", XYZ, Allowed::Any)?;
            return Some(Segment::arc_through(via, to, self.time_law(fields)?));
        }
        if !(fields.has("centre") && fields.has("sweep")) {
            let help = "write `centre: [x, y, z], sweep: pi` (and `axis`, if not z0), or `through: [x, y, z]`";
            let message = "an arc needs `centre` and `sweep`, or `through`";
            self.report(Shared::MissingKey, fields.at(), message, "this arc", help);
            return None;
        }
        let centre = self.array(fields, "centre", XYZ, Allowed::Any);
        let sweep = self.number(fields, "sweep", Allowed::Any);
        let axis = self.axis(fields)?;
        Some(Segment::arc_to(centre?, axis, sweep?, to, self.time_law(fields)?))
    }

    /// The axis of an arc or a turn; z0 by default.
    fn axis(&mut self, fields: &Fields<'_>) -> Option<[f64; 3]> {
        match fields.has("axis") {
            true => self.array(fields, "axis", "x, y, z", Allowed::Any),
            false => Some([0.0, 0.0, 1.0]),
        }
    }

    fn turn(&mut self, node: &Node, at: Span) -> Option<Turn<f64>> {
        let mut keys = optionals(&["angle", "axis", "pause"]);
        keys.extend(optionals(&LAW));
        let fields = self.mapping(node, "a turn", at, &keys)?;
        if fields.has("pause") {
            self.out_of_place(&fields, &["angle", "axis"], "the turn is a `pause`");
            self.out_of_place(&fields, &LAW, "a `pause` has no time law");
            return Some(Turn::pause(self.seconds(&fields, "pause", Allowed::Positive)?));
        }
        let example = "angle: pi, duration: 10, acceleration_time: 1";
        self.require(&fields, "angle", "a turn", example);
        let axis = self.axis(&fields);
        let angle = self.number(&fields, "angle", Allowed::Any)?;
        Some(Turn::about(axis?, angle, self.time_law(&fields)?))
    }
}
