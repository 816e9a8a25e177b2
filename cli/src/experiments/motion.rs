//! Path files: where the end effector goes, how it turns, under which time laws.

use std::io::Read;
use std::path::Path as FilePath;
use std::time::Duration;

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::document::yaml::{self, Kind, Node};
use armgen_codegen::source::{Source, Span};
use armgen_runtime::nalgebra::Matrix3;
use armgen_runtime::trajectory::{Law, OperationalTrajectory, OrientationProfile, Path, PlanFault, Segment, Turn};

use super::reader::{Allowed, Fields, Reader};

/// A planned motion of the end effector.
pub(crate) type Trajectory = OperationalTrajectory<f64, Vec<Segment<f64>>, Vec<Turn<f64>>>;

/// A motion, with what is needed to draw it.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// Position and orientation over time.
    pub(crate) trajectory: Trajectory,
    /// The orientation from which angles count.
    pub(crate) frame: Matrix3<f64>,
    /// Height of the sheet that is cut, and of the cut; m.
    pub(crate) sheet: Option<Sheet>,
}

/// A sheet at right angles to z0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheet {
    /// Height of its upper side.
    pub(crate) top: f64,
    /// Height of the tip while it cuts.
    pub(crate) depth: f64,
}

const LAW: [&str; 5] = ["duration", "acceleration_time", "law", "velocity", "acceleration"];
const XYZ: &str = "x, y, z in m";

/// Reads and plans the motion of the file; what is wrong in it is rendered already.
pub(crate) fn read(path: &FilePath) -> Result<Motion, (Source, Reader)> {
    let name = path.display().to_string();
    // One character more than is taken: the reader says what a file may hold, and one without an end is not waited for.
    let text = std::fs::File::open(path).and_then(|file| {
        let mut text = String::new();
        file.take(yaml::MAX_TEXT as u64 + 1).read_to_string(&mut text).map(|_| text)
    });
    let source = match text {
        Ok(text) => Source::new(name, text),
        Err(error) => {
            let mut reader = Reader::default();
            reader.faults.add(
                "unreadable",
                Span::new(0, 0),
                format!("the path file cannot be read: {error}"),
                "",
                "`path` is relative to the experiment's file",
            );
            return Err((Source::new(name, ""), reader));
        }
    };
    parse(source)
}

/// Reads and plans a motion from its text.
pub(crate) fn parse(source: Source) -> Result<Motion, (Source, Reader)> {
    let mut reader = Reader::default();
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics);
    reader.faults.extend(&diagnostics);
    let motion = root.as_ref().and_then(|root| reader.motion(root));
    if root.is_none() && reader.faults.is_empty() {
        reader.faults.add("empty-file", Span::new(0, 0), "the file describes no path", "", "begin with `start:` and `segments:`");
    }
    match motion {
        Some(motion) if reader.faults.is_empty() => Ok(motion),
        _ => Err((source, reader)),
    }
}

/// Why a segment cannot be, in words, and what to do.
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

impl Reader {
    fn motion(&mut self, root: &Node) -> Option<Motion> {
        let first = match &root.kind {
            Kind::Mapping(entries) => entries.first().map_or(root.span, |(key, _)| key.span),
            _ => root.span,
        };
        let fields = self.mapping(root, "a path", first, &["start", "segments"], &["frame", "turns", "sheet"])?;
        let start = self.array::<3>(&fields, "start", XYZ, Allowed::Any);
        let frame = self.frame(&fields);
        let sheet = fields.get("sheet").and_then(|(at, node)| {
            let fields = self.mapping(node, "`sheet`", at, &["top", "depth"], &[])?;
            Some(Sheet { top: self.number(&fields, "top", Allowed::Any)?, depth: self.number(&fields, "depth", Allowed::Any)? })
        });
        let segments = self.elements(&fields, "segments", Self::segment);
        let turns = self.elements(&fields, "turns", Self::turn);
        if !self.faults.is_empty() {
            return None;
        }
        let places: Vec<Span> = segments.iter().map(|(span, _)| *span).collect();
        let path = match Path::plan(start?, segments.into_iter().map(|(_, s)| s).collect::<Vec<_>>()) {
            Ok(path) => Some(path),
            Err(error) => {
                let at = places.get(error.segment.wrapping_sub(1)).copied().unwrap_or(fields.place("start"));
                self.cannot(at, &format!("segment {}", error.segment), error.fault);
                None
            }
        };
        let places: Vec<Span> = turns.iter().map(|(span, _)| *span).collect();
        let orientation = match OrientationProfile::plan(frame, turns.into_iter().map(|(_, t)| t).collect::<Vec<_>>()) {
            Ok(orientation) => Some(orientation),
            Err(error) => {
                let at = places.get(error.segment.wrapping_sub(1)).copied().unwrap_or(fields.place("frame"));
                self.cannot(at, &format!("turn {}", error.segment), error.fault);
                None
            }
        };
        Some(Motion { trajectory: OperationalTrajectory { path: path?, orientation: orientation? }, frame, sheet })
    }

    fn cannot(&mut self, at: Span, what: &str, fault: PlanFault) {
        let (why, help) = explain(fault);
        self.faults.add("infeasible", at, format!("{what} cannot be planned: {why}"), "this one", help);
    }

    fn frame(&mut self, fields: &Fields<'_>) -> Matrix3<f64> {
        let Some((at, node)) = fields.get("frame") else { return Matrix3::identity() };
        let help = "write the rotation matrix row by row: `[[1, 0, 0], [0, 1, 0], [0, 0, 1]]`";
        let Some(items) = self.items(node, at, "frame", help) else { return Matrix3::identity() };
        if items.len() != 3 {
            self.faults.add("wrong-length", node.span, "`frame` takes 3 rows", format!("{} instead of 3", items.len()), help);
            return Matrix3::identity();
        }
        let rows: Vec<Vec<f64>> =
            items.iter().filter_map(|row| self.list(row, row.span, "frame", 3, "one row", Allowed::Any)).collect();
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
            let place = match &item.kind {
                Kind::Mapping(entries) => entries.first().map_or(item.span, |(key, _)| key.span),
                _ => item.span,
            };
            if let Some(element) = read(self, item, place) {
                all.push((place, element));
            }
        }
        all
    }

    fn law(&mut self, fields: &Fields<'_>) -> Option<Law<f64>> {
        let duration = self.seconds(fields, "duration", Allowed::Positive);
        let kind = match self.word(fields, "law") {
            Some(word) => self.choice(&word, "law", &[("trapezoidal", 0), ("cubic", 1), ("quintic", 2)])?,
            None => 0,
        };
        let rise = self.seconds(fields, "acceleration_time", Allowed::Positive);
        let velocity = self.number(fields, "velocity", Allowed::Positive);
        let acceleration = self.number(fields, "acceleration", Allowed::Positive);
        match (kind, duration, rise, velocity, acceleration) {
            (0, Some(duration), Some(acceleration_time), None, None) => Some(Law::Trapezoidal { duration, acceleration_time }),
            (0, Some(duration), None, None, Some(acceleration)) => {
                Some(Law::TrapezoidalByAcceleration { duration, acceleration })
            }
            (0, Some(duration), None, Some(velocity), None) => Some(Law::TrapezoidalByVelocity { duration, velocity }),
            (0, None, None, Some(velocity), Some(acceleration)) => Some(Law::TrapezoidalByLimits { velocity, acceleration }),
            (1, Some(duration), None, None, None) => Some(Law::Cubic { duration }),
            (2, Some(duration), None, None, None) => Some(Law::Quintic { duration }),
            _ => {
                let help = "`duration` with `acceleration_time`, `velocity` or `acceleration`; `velocity` with `acceleration`; or `duration` with `law: cubic` or `law: quintic`";
                self.faults.add("time-law", fields.at, "these keys make no time law", "no law", help);
                None
            }
        }
    }

    fn segment(&mut self, node: &Node, at: Span) -> Option<Segment<f64>> {
        let mut optional = vec!["line", "arc", "centre", "axis", "sweep", "through", "pause", "anticipation"];
        optional.extend(LAW);
        let fields = self.mapping(node, "a segment", at, &[], &optional)?;
        let anticipation = self.seconds(&fields, "anticipation", Allowed::Any).unwrap_or(Duration::ZERO);
        let segment = if fields.get("line").is_some() {
            Segment::line(self.array(&fields, "line", XYZ, Allowed::Any)?, self.law(&fields)?)
        } else if fields.get("arc").is_some() {
            let to = self.array(&fields, "arc", XYZ, Allowed::Any)?;
            if let Some(via) = self.array(&fields, "through", XYZ, Allowed::Any) {
                Segment::arc_through(via, to, self.law(&fields)?)
            } else {
                let centre = self.array(&fields, "centre", XYZ, Allowed::Any);
                let sweep = self.number(&fields, "sweep", Allowed::Any);
                let axis = self.array(&fields, "axis", "x, y, z", Allowed::Any).unwrap_or([0.0, 0.0, 1.0]);
                let (Some(centre), Some(sweep)) = (centre, sweep) else {
                    let help = "write `centre: [x, y, z], sweep: pi` (and `axis`, if not z0), or `through: [x, y, z]`";
                    self.faults.add("missing-key", at, "an arc needs `centre` and `sweep`, or `through`", "this arc", help);
                    return None;
                };
                Segment::arc_to(centre, axis, sweep, to, self.law(&fields)?)
            }
        } else if fields.get("pause").is_some() {
            Segment::pause(self.seconds(&fields, "pause", Allowed::Positive)?)
        } else {
            self.faults.add(
                "missing-key",
                at,
                "a segment is a `line`, an `arc` or a `pause`",
                "none of them",
                "for instance `{line: [0.5, 0, 0.1], duration: 1, acceleration_time: 0.2}`",
            );
            return None;
        };
        Some(segment.anticipating(anticipation))
    }

    fn turn(&mut self, node: &Node, at: Span) -> Option<Turn<f64>> {
        let mut optional = vec!["angle", "axis", "pause"];
        optional.extend(LAW);
        let fields = self.mapping(node, "a turn", at, &[], &optional)?;
        if fields.get("pause").is_some() {
            return Some(Turn::pause(self.seconds(&fields, "pause", Allowed::Positive)?));
        }
        let axis = self.array(&fields, "axis", "x, y, z", Allowed::Any).unwrap_or([0.0, 0.0, 1.0]);
        match self.number(&fields, "angle", Allowed::Any) {
            Some(angle) => Some(Turn::about(axis, angle, self.law(&fields)?)),
            None => {
                self.faults.add(
                    "missing-key",
                    at,
                    "a turn needs an `angle`",
                    "this turn",
                    "for instance `{angle: pi, duration: 10, acceleration_time: 1}`",
                );
                None
            }
        }
    }
}
