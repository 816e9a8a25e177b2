//! Why a path cannot be timed: code, place in the file, s, reason and remedy.

use armgen_codegen::diagnostic::{AnyCode, Code as Shared, Diagnostic, Diagnostics};
use armgen_codegen::document::reader::and;
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::source::Span;
use armgen_runtime::timing::{JointPath, Limit, PathError, PathFault, Piece, Timing, TimingError, TimingFault};

use super::arm::Arm;
use super::code::Code;
use super::curve::{corners, Origin};
use super::file::{Curve, File, Form, Place};
use super::result::{gap_of, short};
use super::tip::{Distance, Fault, FaultKind};

/// What messages need of a path and its file.
pub(super) struct Faults<'a> {
    pub(super) manipulator: &'a Manipulator,
    pub(super) file: &'a File,
    pub(super) form: &'a Form,
    /// Of the pieces.
    pub(super) origins: &'a [Origin],
}

/// Slow is ds² below this part of its largest value nearby, which is within this part of the path.
const SLOW: f64 = 1e-4;
const NEARBY: f64 = 0.02;
/// How far beyond its range a joint may be, of the range: rounding of splines.
const BEYOND: f64 = 1e-9;

impl Faults<'_> {
    fn name(&self, joint: usize) -> &str {
        self.manipulator.joints.get(joint).map_or("", |joint| &joint.name)
    }

    fn slides(&self, joint: usize) -> bool {
        self.manipulator.joints.get(joint).is_some_and(|joint| joint.kind == JointKind::Prismatic)
    }

    /// Of q.
    fn unit(&self, joint: usize) -> &'static str {
        if self.slides(joint) {
            "m"
        } else {
            "rad"
        }
    }

    fn torque(&self, joint: usize, torque: f64) -> String {
        format!("{} {}", short(torque), if self.slides(joint) { "N" } else { "N m" })
    }

    fn places(&self) -> &[Place] {
        match self.form {
            Form::Points { places, .. } | Form::Pieces { places, .. } => places,
        }
    }

    /// The place in words, and the point or piece of the file, counted from 0.
    fn place<const N: usize>(&self, s: f64, piece: usize, pieces: &[Piece<f64, N>]) -> (String, usize) {
        // A path of numbers that are too large has no s.
        let at = if s.is_finite() { format!("at s = {}", short(s)) } else { "somewhere".to_owned() };
        match self.origins.get(piece).copied().unwrap_or(Origin::Piece(piece)) {
            Origin::Piece(i) => (format!("{at}, piece {}", i + 1), i),
            Origin::Corner(i) => (format!("{at}, the corner of point {}", i + 1), i),
            Origin::Between(i) => {
                let of = pieces.get(piece);
                let near = |end: f64| of.is_some_and(|piece| (s - end).abs() <= 1e-6 * piece.length);
                // With blends the pieces of lines end beside the points.
                // A piece of the tip's path is a spline of many.
                let meets =
                    |other: Option<&Origin>| !matches!(other, Some(Origin::Corner(_))) && other != self.origins.get(piece);
                let before = piece.checked_sub(1).and_then(|before| self.origins.get(before));
                if of.is_some_and(|of| near(of.start)) && meets(before) {
                    (format!("{at}, point {}", i + 1), i)
                } else if of.is_some_and(|of| near(of.end())) && meets(self.origins.get(piece + 1)) {
                    (format!("{at}, point {}", i + 2), i + 1)
                } else {
                    (format!("{at}, between points {} and {}", i + 1, i + 2), i)
                }
            }
        }
    }

    /// A diagnostic at s.
    fn at<const N: usize>(
        &self,
        (s, piece, pieces): (f64, usize, &[Piece<f64, N>]),
        code: impl Into<AnyCode>,
        reason: impl AsRef<str>,
        help: impl Into<String>,
    ) -> Diagnostic {
        let (place, entry) = self.place(s, piece, pieces);
        let span = self.places().get(entry).map_or(self.file.ends_at, |place| place.span);
        let label = match self.form {
            Form::Points { .. } => format!("point {}", entry + 1),
            Form::Pieces { .. } => format!("piece {}", entry + 1),
        };
        Diagnostic::new(code, span, format!("{place}: {}", reason.as_ref()), label, help)
    }

    /// Every corner of lines without a blend, and of arcs.
    pub(super) fn of_corners(&self, diagnostics: &mut Diagnostics) {
        let Form::Points { points, passing, arcs, places, curve: Curve::Lines, blend } = self.form else { return };
        for (i, angle) in corners(points, arcs).into_iter().filter(|(i, _)| !passing[*i].stop) {
            let message = format!("point {}: the path has a corner of {} deg", i + 1, short(angle.to_degrees()));
            let help = match (arcs[i - 1].is_some() || arcs[i].is_some(), blend) {
                (true, _) => {
                    "move `via` so that the arc begins and ends along its neighbours, or rest here, `{to: [...], stop: true}`"
                }
                (false, None) => match self.file.tip {
                    None => "round it, `blend: 0.05` (rad or m from the corner), or rest here, `{q: [...], stop: true}`",
                    Some(_) => "round it, `blend: 0.05` (m or rad from the corner), or rest here, `{to: [...], stop: true}`",
                },
                (false, Some(_)) => continue,
            };
            diagnostics.push(Diagnostic::new(Code::Corner, places[i].span, message, "the direction changes", help));
        }
    }

    /// Every joint that leaves its range, by the extreme values of its polynomials.
    pub(super) fn of_positions<const N: usize>(&self, pieces: &[Piece<f64, N>], diagnostics: &mut Diagnostics) {
        for (i, joint) in self.manipulator.joints.iter().enumerate() {
            let Some([low, high]) = joint.limits.position.as_ref().map(|of| of.clone().map(|x| x.to_f64())) else { continue };
            let beyond = |q: f64| (low - q).max(q - high);
            let allowed = BEYOND * (high - low);
            let mut stretches: Vec<[f64; 2]> = Vec::new();
            let mut worst: Option<(f64, f64, usize)> = None;
            for (index, piece) in pieces.iter().enumerate() {
                let mut places: Vec<(f64, f64)> = piece.extremes(i).into_iter().flatten().collect();
                places.sort_by(|a, b| a.0.total_cmp(&b.0));
                for (s, q) in &places {
                    if beyond(*q) > allowed && worst.is_none_or(|(_, most, _)| beyond(*q) > beyond(most)) {
                        worst = Some((*s, *q, index));
                    }
                }
                // Between two of these places the joint moves one way.
                for pair in places.windows(2) {
                    let (a, b) = (pair[0], pair[1]);
                    for limit in [low, high] {
                        let out = |q: f64| if limit == low { low - q } else { q - high };
                        if out(a.1).max(out(b.1)) <= allowed {
                            continue;
                        }
                        let crossing = |mut inside: f64, mut outside: f64| {
                            for _ in 0..60 {
                                let middle = 0.5 * (inside + outside);
                                if out(piece.at(middle).q[i]) > 0.0 {
                                    outside = middle;
                                } else {
                                    inside = middle;
                                }
                            }
                            outside
                        };
                        let from = if out(a.1) > 0.0 { a.0 } else { crossing(a.0, b.0) };
                        let to = if out(b.1) > 0.0 { b.0 } else { crossing(b.0, a.0) };
                        match stretches.last_mut() {
                            Some(last) if from <= last[1] + 1e-9 * piece.length => last[1] = to,
                            _ => stretches.push([from, to]),
                        }
                    }
                }
            }
            let Some((s, q, index)) = worst else { continue };
            let (place, entry) = self.place(s, index, pieces);
            let spans = self.places().get(entry);
            let span = spans.and_then(|place| place.joints.get(i).copied()).or(spans.map(|place| place.span));
            let from: Vec<String> = stretches.iter().map(|[a, b]| format!("s = {} to {}", short(*a), short(*b))).collect();
            let message = format!(
                "{place}: joint `{}` is at {}, {} {} beyond its range",
                joint.name,
                short(q),
                short(beyond(q)),
                self.unit(i)
            );
            let curve = match self.form {
                Form::Points { curve: Curve::Spline, .. } if place.contains("between") => {
                    "; `curve: through` does not swing beyond the points"
                }
                _ => "",
            };
            let help = format!("its range is {} to {}; outside from {}{curve}", short(low), short(high), and(&from));
            diagnostics.push(Diagnostic::new(Code::OutsideLimits, span.unwrap_or(self.file.ends_at), message, "outside", help));
        }
    }

    /// Joints that move without a limit that bounds their speed.
    pub(super) fn of_missing_limits<const N: usize>(&self, pieces: &[Piece<f64, N>], diagnostics: &mut Diagnostics) {
        let limits = &self.file.limits;
        let free = |joint: &usize| {
            limits.velocity[*joint].is_infinite() && limits.effort[*joint].iter().all(|limit| limit.is_infinite())
        };
        let moves = |joint: &usize| pieces.iter().any(|piece| piece.coefficients[1..].iter().any(|c| c[*joint] != 0.0));
        let names: Vec<String> = (0..self.manipulator.dof())
            .filter(|joint| free(joint) && moves(joint))
            .map(|joint| format!("`{}`", self.name(joint)))
            .collect();
        if names.is_empty() {
            return;
        }
        let verb = if names.len() == 1 { "moves and has" } else { "move and have" };
        let message = format!("{} {verb} neither a limit of speed nor one of torque", and(&names));
        let help = format!(
            "write for instance `limits: {{velocity: {{{}: 2}}}}`, here or in the description",
            names[0].trim_matches('`')
        );
        diagnostics.push(Diagnostic::new(Code::MissingLimit, self.file.limits_at, message, "", help));
    }

    /// A path of the tip without a joint spline.
    pub(super) fn of_tip(&self, fault: &Fault, curve: &[Piece<f64, 6>]) -> Diagnostic {
        let away = |off: &Distance| format!("{} m and {} rad", short(off.metres), short(off.radians));
        let (code, reason, help) = match &fault.kind {
            FaultKind::Unreachable { off } => (
                AnyCode::from(Code::Unreachable),
                format!("no joint values reach the path from here on: {} are left to the end of this piece", away(off)),
                "the arm's reach on this branch ends here: lead the path elsewhere, or choose another `start`",
            ),
            FaultKind::Singular { least, needed } => (
                Code::Singular.into(),
                format!("the posture is singular: the least singular value of J is {least:.2e}, below {needed:.2e}"),
                "joints would have to move infinitely fast: lead the path elsewhere, or give it by joints there",
            ),
            FaultKind::Tolerance { off } => (
                Code::Tolerance.into(),
                format!("the finest joint spline still leaves the path by {}", away(off)),
                "raise `tolerance`, or lead the path farther from a singular posture",
            ),
            FaultKind::TooManyRows { rows } => (
                Shared::WrongLength.into(),
                format!("the task of the description has {rows} rows, the arm has {} joints", self.manipulator.dof()),
                "name the rows that the joints lead in `task` of the description, or give the path by joints, `points`",
            ),
        };
        self.at((fault.s, fault.piece, curve), code, reason, help)
    }

    /// Pieces that are no path.
    pub(super) fn of_path<const N: usize>(&self, pieces: &[Piece<f64, N>], error: &PathError) -> Diagnostic {
        let PathError { s, piece, fault } = *error;
        let rest = "end the path here, and time what follows by itself";
        let (code, help): (AnyCode, String) = match fault {
            PathFault::Empty | PathFault::ZeroLength => {
                (Code::ZeroLength.into(), "leave it out: a pause belongs between two timings".into())
            }
            PathFault::NotFinite => (Shared::NotFinite.into(), "write smaller numbers".into()),
            // Found in the file.
            PathFault::Speed => (Code::NotPositive.into(), "write a share above 0 and at most 1".into()),
            PathFault::Gap => (Code::Jump.into(), "begin each piece where the one before it ends".into()),
            PathFault::Jump { .. } => (
                Code::Jump.into(),
                "make both pieces meet: the value of the first at its end is the first coefficient of the next".into(),
            ),
            PathFault::Corner { .. } => (Code::Corner.into(), format!("make q' continuous in direction, or {rest}")),
            PathFault::Scale => (Code::Corner.into(), "scale s of one piece so that q' is continuous".into()),
            PathFault::TurningBack => (Code::TurningBack.into(), rest.to_owned()),
        };
        let reason = match fault {
            PathFault::Jump { joint, by } => format!("joint `{}` jumps by {} {}", self.name(joint), short(by), self.unit(joint)),
            PathFault::Corner { angle } => format!("the path has a corner of {} deg", short(angle.to_degrees())),
            PathFault::ZeroLength | PathFault::Empty => "nothing moves".to_owned(),
            PathFault::TurningBack => "all joints are at rest inside the path, which turns back or stops here".to_owned(),
            fault => fault.to_string(),
        };
        self.at((s, piece, pieces), code, reason, help)
    }

    /// A path without a motion.
    pub(super) fn of_timing<const N: usize>(&self, arm: &Arm<N>, path: &super::Curve<N>, error: &TimingError) -> Diagnostic {
        let TimingError { s, piece, fault } = *error;
        let pieces = path.pieces();
        let place = (s, piece, pieces);
        let limited = |joint: usize, limit: Limit| match limit {
            Limit::EffortHigh => format!("its torque, at most {}", self.torque(joint, self.file.limits.effort[joint][1])),
            Limit::EffortLow => format!("its torque, at least {}", self.torque(joint, self.file.limits.effort[joint][0])),
            Limit::AccelerationHigh | Limit::AccelerationLow => {
                format!("its acceleration, at most {} {}/s²", short(self.file.limits.acceleration[joint]), self.unit(joint))
            }
            Limit::Velocity => format!("its speed, at most {} {}/s", short(self.file.limits.velocity[joint]), self.unit(joint)),
            Limit::ToolSpeed => format!("its speed, at most {} m/s", short(self.file.limits.tool[0])),
            Limit::ToolTurnRate => format!("its turn rate, at most {} rad/s", short(self.file.limits.tool[1])),
        };
        let owner = |joint: usize, limit: Limit| match limit {
            Limit::ToolSpeed | Limit::ToolTurnRate => "the end effector".to_owned(),
            _ => format!("joint `{}`", self.name(joint)),
        };
        match fault {
            TimingFault::NotFinite => {
                self.at(place, Shared::NotFinite, "a torque is infinite or not a number", "write smaller joint values")
            }
            // Both are found before.
            TimingFault::MissingLimit { joint } => {
                let reason = format!("joint `{}` has neither a limit of speed nor one of torque", self.name(joint));
                self.at(place, Code::MissingLimit, reason, "write `limits`")
            }
            TimingFault::SpeedNegative => self.at(place, Code::NegativeSpeed, "a speed at an end is negative", "write 0 or more"),
            TimingFault::InfeasiblePoint { joint, limit } => {
                let q = pieces.get(piece).map(|of| of.at(s).q);
                let rest = q.map_or_else(String::new, |q| {
                    format!("; to be held at rest here it needs {}", self.torque(joint, arm.holding(&q, joint).0))
                });
                let reason = format!("at no speed does {} keep {}{rest}", owner(joint, limit), limited(joint, limit));
                self.at(place, Code::InfeasiblePoint, reason, "this is proved: lead the path elsewhere, or raise the limit")
            }
            TimingFault::InfeasibleSpeed { joint, limit, speed, needed, proved } => {
                let reason = if needed.is_finite() {
                    format!(
                        "ds is {} here, and at most {} is possible: {} is limited in {}",
                        short(needed),
                        short(speed),
                        owner(joint, limit),
                        limited(joint, limit)
                    )
                } else {
                    format!("the motion gets no farther: {} is limited in {}", owner(joint, limit), limited(joint, limit))
                };
                let known = if proved { "this is proved" } else { "no motion was found, which is not proved" };
                let help = if needed.is_finite() {
                    format!("{known}: lower `ends: {{speed: ...}}`, or raise the limit")
                } else {
                    format!("{known}: raise the limit, or begin with speed, `ends: {{speed: [1, 0]}}`")
                };
                self.at(place, Code::InfeasibleSpeed, reason, help)
            }
            TimingFault::EndNotHeld { joint, torque, limit } => {
                let reason = format!(
                    "at rest joint `{}` needs {} and has {}",
                    self.name(joint),
                    self.torque(joint, torque),
                    self.torque(joint, limit)
                );
                self.at(place, Code::EndNotHeld, reason, "the arm gets there and falls: `ends: {hold: false}` allows that")
            }
            TimingFault::TooCoarse { segments } => {
                let help = format!("try `--segments {segments}`");
                self.at(place, Code::TooCoarse, "no motion was found, and none was proved to be impossible", help)
            }
        }
    }

    /// At rest at the start the arm may be held by something else.
    pub(super) fn of_start<const N: usize>(&self, arm: &Arm<N>, path: &super::Curve<N>, diagnostics: &mut Diagnostics) {
        let Some(first) = path.pieces().first().filter(|_| self.file.speed[0] == 0.0) else { return };
        let q = first.at(first.start).q;
        let mut joints = Vec::new();
        for joint in 0..self.manipulator.dof() {
            let (torque, dry) = arm.holding(&q, joint);
            let [low, high] = self.file.limits.effort[joint];
            if torque - dry > high || torque + dry < low {
                joints.push(format!("joint `{}` needs {}", self.name(joint), self.torque(joint, torque)));
            }
        }
        if joints.is_empty() {
            return;
        }
        let reason = format!("at rest at the start {}, beyond the limit", and(&joints));
        let help = "the motion is right from its first moment on; until then something else holds the arm";
        diagnostics.push(self.at((first.start, 0, path.pieces()), Code::StartNotHeld, reason, help));
    }

    /// Places with ds² far below its largest values on either side nearby: nearly corners, or cusps.
    pub(super) fn of_slow_points<const N: usize>(
        &self,
        path: &JointPath<f64, N, Vec<Piece<f64, N>>>,
        timing: &Timing<'_, f64, N>,
        diagnostics: &mut Diagnostics,
    ) {
        let profiles: Vec<_> = (0..timing.segments()).filter_map(|i| timing.profile(i)).collect();
        let nodes: Vec<(f64, f64)> = profiles.iter().map(|profile| (profile.start, profile.x[0])).collect();
        let (Some(first), Some(last)) = (path.pieces().first(), path.pieces().last()) else { return };
        let nearby = NEARBY * (last.end() - first.start);
        let ds = |s: f64| {
            let i = profiles.partition_point(|profile| profile.start <= s).saturating_sub(1);
            timing.at(i, (s - profiles[i].start) / profiles[i].length).map_or(0.0, |at| at.ds)
        };
        // Where the path stops or has a share of its speeds, it shall be slow.
        let is_asked = |s: f64| {
            let beside = path.pieces().iter().filter(|piece| piece.start <= s + nearby && piece.end() >= s - nearby);
            beside.into_iter().any(|piece| piece.speed < 1.0 || piece.stop && (piece.start - s).abs() <= nearby)
        };
        let around = |s: f64| ds(s - nearby).min(ds(s + nearby)).powi(2);
        let is_slow =
            |(s, x): (f64, f64)| s - nearby > first.start && s + nearby < last.end() && x < SLOW * around(s) && !is_asked(s);
        let mut slowest: Option<(f64, f64)> = None;
        for (i, node) in nodes.iter().enumerate() {
            if is_slow(*node) && slowest.is_none_or(|(_, x)| node.1 < x) {
                slowest = Some(*node);
            }
            let ends = nodes.get(i + 1).is_none_or(|next| !is_slow(*next));
            let Some((s, x)) = slowest.take_if(|_| ends) else { continue };
            let piece = path.pieces().iter().rposition(|piece| piece.start <= s).unwrap_or(0);
            let share = (x.max(0.0) / around(s)).sqrt();
            let reason = format!("the motion slows down to {share:.1e} of its speed nearby: nearly a corner, or a cusp");
            let help = "round the path there: a larger `blend`, or points that do not turn back";
            diagnostics.push(self.at((s, piece, path.pieces()), Code::SlowPoint, reason, help));
        }
    }

    /// The segments were used up.
    pub(super) fn of_gap<const N: usize>(&self, timing: &Timing<'_, f64, N>, wanted: f64, diagnostics: &mut Diagnostics) {
        if timing.gap() <= wanted {
            return;
        }
        let most = (0..timing.segments()).max_by(|a, b| gap_of(timing, *a).total_cmp(&gap_of(timing, *b)));
        let at = most
            .and_then(|i| timing.profile(i))
            .map_or_else(String::new, |of| format!(", most of it at s = {}", short(of.start)));
        let message = format!("{} segments leave a gap of {} %{at}", timing.segments(), short(100.0 * timing.gap()));
        let span = self.places().first().map_or(Span::new(0, 0), |place| place.span);
        let help = "the motion is right, and faster ones may exist: allow more `--segments`";
        diagnostics.push(Diagnostic::new(Code::Gap, span, message, "", help));
    }
}
