//! The file of a path: points or pieces, limits, ends.

use armgen_codegen::diagnostic::{AnyCode, Code as Shared, Diagnostics};
use armgen_codegen::document::excerpt;
use armgen_codegen::document::reader::{optional, required, Fields, Key, Reader};
use armgen_codegen::document::yaml::{self, Kind, Node};
use armgen_codegen::exact::Number;
use armgen_codegen::manipulator::{self, Manipulator};
use armgen_codegen::source::{Source, Span};
use armgen_codegen::suggest::did_you_mean;
use nalgebra::Vector3;

use super::arc::Arc;
use super::code::Code;

/// How a path runs through its points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Curve {
    /// The natural cubic spline.
    #[default]
    Spline,
    /// Lines, with corners rounded where `blend` is given.
    Lines,
    /// Monotone between points.
    Through,
}

/// The form of a path.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// Points, a list of joints for each. `arcs`: between each point and the next a line, or an arc of the tip.
    Points {
        points: Vec<Vec<f64>>,
        passing: Vec<Passing>,
        arcs: Vec<Option<Arc>>,
        places: Vec<Place>,
        curve: Curve,
        blend: Option<f64>,
    },
    /// Polynomials, `[piece][joint][power]`, powers of s - knot, lowest first.
    Pieces { knots: Vec<f64>, coefficients: Vec<Vec<Vec<f64>>>, places: Vec<Place> },
}

/// How the motion passes a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passing {
    /// At most this share of each limit of speed, halfway to the points beside it.
    pub(super) speed: f64,
    /// It rests there.
    pub(super) stop: bool,
}

/// Where a point or a piece stands in the file, and its entry for each joint.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) span: Span,
    pub(super) joints: Vec<Span>,
}

impl Place {
    fn of(list: &Node) -> Place {
        let Kind::List(items) = &list.kind else { return Place { span: list.span, joints: Vec::new() } };
        Place { span: list.span, joints: items.iter().map(|item| item.span).collect() }
    }
}

/// Limits of each joint; infinite where there is none.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) velocity: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
    /// Lower and upper.
    pub(super) effort: Vec<[f64; 2]>,
    /// Speed and turn rate of the end effector.
    pub(super) tool: [f64; 2],
}

/// A path of the end effector: [`Form::Points`] has its poses, six numbers each.
#[derive(Clone, Debug)]
pub(super) struct Tip {
    /// Joint values near the first pose: the branch, and the orientation that rotation vectors count from.
    pub(super) start: Vec<f64>,
    /// How far the joint spline may be from the path, m and rad.
    pub(super) tolerance: f64,
}

/// A path as its file gives it, with limits of the description where the file has none.
#[derive(Clone, Debug)]
pub(super) struct File {
    /// `None` where the file may have limits alone, and has no more.
    pub(super) form: Option<Form>,
    /// Of a path of the end effector.
    pub(super) tip: Option<Tip>,
    pub(super) limits: Limits,
    /// ds at both ends.
    pub(super) speed: [f64; 2],
    /// Whether the arm is held at the end.
    pub(super) hold: bool,
    /// The place of the limits, or of the path.
    pub(super) limits_at: Span,
    /// The place of `ends`, or of the path.
    pub(super) ends_at: Span,
}

const KEYS: [Key; 8] = [
    optional("robot"),
    optional("points"),
    optional("curve"),
    optional("blend"),
    optional("pieces"),
    optional("tip"),
    optional("limits"),
    optional("ends"),
];
const PIECES: [Key; 2] = [required("knots", "knots: [0, 1]"), required("coefficients", "coefficients: [[[0, 1], [0.5, -1]]]")];
const TIP: [Key; 3] = [
    required("points", "points: [[0.5, 0.1, 0.3], [0.5, 0.4, 0.3]]"),
    required("start", "start: [0, 0.5]"),
    optional("tolerance"),
];
const POINT: [Key; 3] = [required("q", "q: [0, 0.5]"), optional("speed"), optional("stop")];
const TIP_POINT: [Key; 4] = [optional("via"), required("to", "to: [0.5, 0.2, 0.3]"), optional("speed"), optional("stop")];
/// Of the tip, m and rad.
const TOLERANCE: f64 = 1e-4;
const LIMITS: [Key; 4] = [optional("velocity"), optional("acceleration"), optional("effort"), optional("tool")];
const TOOL: [Key; 2] = [optional("speed"), optional("turn_rate")];
const ENDS: [Key; 2] = [optional("speed"), optional("hold")];
const NUMBER: &str = "write for instance `0.5`, `1e-3`, `pi/2` or `deg(30)`";
const UNTREATED: &str = "limits of jerk are not treated: keys here are velocity, acceleration, effort, tool";

impl Limits {
    /// Those of a description.
    pub(super) fn of(arm: &Manipulator) -> Limits {
        let all = |of: &dyn Fn(&manipulator::Limits) -> Option<Number>| -> Vec<f64> {
            arm.joints.iter().map(|joint| of(&joint.limits).map_or(f64::INFINITY, |x| x.to_f64())).collect()
        };
        Limits {
            velocity: all(&|limits| limits.velocity.clone()),
            acceleration: all(&|limits| limits.acceleration.clone()),
            effort: all(&|limits| limits.effort.clone()).into_iter().map(|x| [-x, x]).collect(),
            tool: [f64::INFINITY; 2],
        }
    }
}

/// The file. `path`: whether it must have one; otherwise limits are enough.
pub(super) fn read(source: &Source, arm: &Manipulator, path: bool) -> (Option<File>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(source, &mut diagnostics);
    let reader = Reader::new(&mut diagnostics).with_other_places(&[("jerk", "velocity", UNTREATED)]).with_other_names(&[
        ("path", "pieces"),
        ("waypoints", "points"),
        ("torque", "effort"),
        ("speed", "velocity"),
    ]);
    let mut reader = Reading { reader, arm };
    let begin = "write for instance `points: [[0, 0.5], [1, -0.5]]`";
    let mut file = None;
    if let Some(root) = reader.reader.root(source, root.as_ref(), "a path", begin) {
        if let Some(fields) = reader.reader.mapping(root, "the path", Span::new(0, 0), &KEYS) {
            file = Some(reader.all(&fields, path));
        }
    }
    diagnostics.sort();
    (file.filter(|_| !diagnostics.has_errors()), diagnostics)
}

struct Reading<'r> {
    reader: Reader<'r>,
    arm: &'r Manipulator,
}

impl Reading<'_> {
    fn all(&mut self, fields: &Fields<'_>, path: bool) -> File {
        if let Some((key, node)) = fields.get("robot") {
            if let Some(name) = self.reader.text(node, key, "robot", "a name", "write the name of the robot, or leave it out") {
                if name.value != self.arm.name {
                    let message = format!("the path is for the robot `{}`", excerpt(&name.value));
                    let help = format!("the description is of `{}`: limits and joints are taken from it", self.arm.name);
                    self.reader.report(Code::OtherRobot, node.span, message, "another robot", help);
                }
            }
        }
        let mut limits = Limits::of(self.arm);
        if let Some((key, node)) = fields.get("limits") {
            self.limits(node, key, &mut limits);
        }
        // Squares of limits are numbers.
        let size = f64::EPSILON.powi(2);
        let effort = limits.effort.iter().flatten().map(|limit| limit.abs());
        let mut all = limits
            .velocity
            .iter()
            .chain(&limits.acceleration)
            .chain(&limits.tool)
            .copied()
            .chain(effort)
            .filter(|limit| limit.is_finite());
        if all.any(|limit| limit > 0.0 && !(size..=1.0 / size).contains(&limit)) {
            let help = "write it in rad/s, m/s, rad/s², m/s², N m or N";
            let message = "a limit is far too small or far too large to calculate with";
            self.reader.report(Code::NotPositive, fields.place("limits"), message, "", help);
        }
        let (mut speed, mut hold) = ([0.0; 2], true);
        if let Some((key, node)) = fields.get("ends") {
            if let Some(of) = self.reader.mapping(node, "`ends`", key, &ENDS) {
                if let Some((key, node)) = of.get("speed") {
                    let both = self.numbers(node, key, "speed", Some((2, "ds at the start and at the end, 1/s")));
                    if let Some([start, end]) = both.as_deref() {
                        speed = [*start, *end];
                    }
                    if speed.iter().any(|v| *v < 0.0) {
                        let help = "the motion follows the path forwards: ds is 0 or more; turn the path round to go back";
                        self.reader.report(Code::NegativeSpeed, node.span, "a speed along the path is negative", "", help);
                    }
                }
                if let Some((key, node)) = of.get("hold") {
                    let words = [("true", true), ("false", false)];
                    let help = "`hold: false` allows an end where the arm cannot hold itself";
                    let chosen = self.reader.choice(node, key, "hold", &words, Code::UnknownWord, help);
                    hold = chosen.is_none_or(|chosen| chosen.value);
                }
            }
        }
        let (form, tip) = self.form(fields, path).map_or((None, None), |(form, tip)| (Some(form), tip));
        if let Some(Form::Points { passing, places, .. }) = &form {
            let is_free = limits.velocity.iter().chain(&limits.tool).all(|limit| limit.is_infinite());
            for (i, _) in passing.iter().enumerate().filter(|(_, of)| is_free && of.speed < 1.0) {
                let message = format!("point {} has a share of the limits of speed, and there are none", i + 1);
                let help = "write for instance `limits: {velocity: [...]}`, here or in the description";
                self.reader.report(Code::MissingLimit, places[i].span, message, "", help);
            }
        }
        File { form, tip, limits, speed, hold, limits_at: fields.place("limits"), ends_at: fields.place("ends") }
    }

    fn form(&mut self, fields: &Fields<'_>, path: bool) -> Option<(Form, Option<Tip>)> {
        let mut curve = Curve::default();
        if let Some((key, node)) = fields.get("curve") {
            let words = [("spline", Curve::Spline), ("lines", Curve::Lines), ("through", Curve::Through)];
            let help = "`spline`: twice continuously differentiable; `lines`: straight, with `blend` at corners; \
                        `through`: no overshoot between points";
            curve = self.reader.choice(node, key, "curve", &words, Code::UnknownWord, help).map_or(curve, |found| found.value);
        }
        let mut blend = None;
        if let Some((key, node)) = fields.get("blend") {
            blend = self.number(node, key, "blend");
            if blend.is_some_and(|blend| blend <= 0.0) {
                let help = "write the distance at which the path passes a corner, rad or m, or leave it out";
                self.reader.report(Code::NotPositive, node.span, "the blend is not above zero", "", help);
                blend = None;
            } else if curve != Curve::Lines {
                let help = "write `curve: lines`, or leave `blend` out";
                self.reader.report(Code::UnknownWord, key, "only `curve: lines` has corners to blend", "", help);
            }
        }
        match [fields.get("points"), fields.get("pieces"), fields.get("tip")] {
            [Some((key, node)), None, None] => self.points(node, key, curve, blend, false).map(|form| (form, None)),
            [None, Some((key, node)), None] => self.pieces(node, key).map(|form| (form, None)),
            [None, None, Some((key, node))] => self.tip(node, key, curve, blend),
            [None, None, None] if !path => None,
            all => {
                let first = all.into_iter().flatten().next();
                let message = if first.is_some() { "the file has more than one path" } else { "the file has no path" };
                let help = "give one of `points: [[0, 0.5], [1, -0.5]]`, `pieces: {knots: [...], coefficients: [...]}` and \
                            `tip: {points: [...], start: [...]}`";
                self.reader.report(Code::MissingPath, first.map_or(fields.at(), |(key, _)| key), message, "", help);
                None
            }
        }
    }

    fn tip(&mut self, node: &Node, key: Span, curve: Curve, blend: Option<f64>) -> Option<(Form, Option<Tip>)> {
        let fields = self.reader.mapping(node, "`tip`", key, &TIP)?;
        if !self.arm.tips.is_empty() {
            let help = "give the path of its joints: `points: [[0, 0.5], [1, -0.5]]`";
            self.reader.report(Code::MissingPath, key, "the arm has several end effectors", "", help);
        }
        let dof = self.arm.dof();
        let start = fields.get("start").and_then(|(key, node)| {
            self.numbers(node, key, "start", Some((dof, "one value per joint, rad or m: the posture near the first point")))
        });
        let mut tolerance = TOLERANCE;
        if let Some((key, node)) = fields.get("tolerance") {
            tolerance = self.number(node, key, "tolerance")?;
            if tolerance <= 0.0 {
                let help = "write how far the tip may be from its path, m and rad";
                self.reader.report(Code::NotPositive, node.span, "the tolerance is not above zero", "", help);
            }
        }
        let form = fields.get("points").and_then(|(key, node)| self.points(node, key, curve, blend, true));
        Some((form?, Some(Tip { start: start?, tolerance })))
    }

    /// Points of joints, or of the tip.
    fn points(&mut self, node: &Node, key: Span, curve: Curve, blend: Option<f64>, of_tip: bool) -> Option<Form> {
        let (each, help) = if of_tip {
            (
                "x, y, z in m, or these and a rotation vector in rad",
                "write a position of the tip for each point: `[[0.5, 0.1, 0.3]]`",
            )
        } else {
            ("one value per joint, rad or m", "write a list of joint values for each point: `points: [[0, 0.5], [1, -0.5]]`")
        };
        let list = self.reader.list(node, key, "points", "a list of points", help)?;
        let length = |point: &Node| match &point.kind {
            _ if !of_tip => self.arm.dof(),
            Kind::List(items) if items.len() == 6 => 6,
            _ => 3,
        };
        let (mut points, mut places, mut vias, mut passing) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut complete = true;
        for (i, point) in list.iter().enumerate() {
            let name = format!("point {}", i + 1);
            let Some((point, via, how)) = self.point(point, curve, (i, list.len()), of_tip) else {
                complete = false;
                continue;
            };
            vias.push(via);
            passing.push(how);
            let length = length(point);
            match self.numbers(point, point.span, &name, Some((length, each))) {
                Some(mut q) if of_tip => {
                    q.resize(6, 0.0);
                    points.push(q);
                    places.push(Place { span: point.span, joints: Vec::new() });
                }
                Some(q) => {
                    points.push(q);
                    places.push(Place::of(point));
                }
                None => complete = false,
            }
        }
        if !complete {
            return None;
        }
        if points.len() < 2 {
            let message = format!("a path has two points at least, found {}", points.len());
            self.reader.report(Shared::WrongLength, key, message, "", "add the point where the motion ends");
            return None;
        }
        let mut arcs = vec![None; points.len() - 1];
        for i in 1..points.len() {
            if let Some(via) = vias[i] {
                let position = |q: &[f64]| Vector3::new(q[0], q[1], q[2]);
                arcs[i - 1] = Arc::new([position(&points[i - 1]), position(&via), position(&points[i])]);
                if arcs[i - 1].is_none() {
                    let message = format!("no circle passes point {i}, `via` and point {}", i + 1);
                    let help = "move `via` off the line between these points, or write the point alone for a line";
                    self.reader.report(Code::NoCircle, places[i].span, message, "they lie on a line", help);
                }
            } else if points[i] == points[i - 1] {
                let message = format!("points {i} and {} are equal", i + 1);
                let help = "leave one of them out: a pause belongs between two timings";
                self.reader.report(Code::ZeroLength, places[i].span, message, "the same point", help);
            }
        }
        Some(Form::Points { points, passing, arcs, places, curve, blend })
    }

    /// The numbers of point `i` of `count`, the position that an arc to it passes, and how the motion passes the point.
    fn point<'n>(
        &mut self,
        point: &'n Node,
        curve: Curve,
        (i, count): (usize, usize),
        of_tip: bool,
    ) -> Option<(&'n Node, Option<[f64; 3]>, Passing)> {
        let mut how = Passing { speed: 1.0, stop: false };
        let Kind::Mapping(_) = &point.kind else { return Some((point, None, how)) };
        let keys = if of_tip { &TIP_POINT[..] } else { &POINT };
        let fields = self.reader.mapping(point, "a point", point.span, keys)?;
        if let Some((key, node)) = fields.get("speed") {
            how.speed = self.number(node, key, "speed")?;
            if !(how.speed > f64::EPSILON && how.speed <= 1.0) {
                let message = format!("the speed of point {} is no share of the limits of speed", i + 1);
                let help = "write how much of each limit of speed is allowed near the point, above 0 and at most 1: `speed: 0.2`";
                self.reader.report(Code::NotPositive, node.span, message, "", help);
            }
        }
        if let Some((key, node)) = fields.get("stop") {
            let help = "`stop: true` brings the arm to rest at the point";
            let chosen = self.reader.choice(node, key, "stop", &[("true", true), ("false", false)], Code::UnknownWord, help);
            how.stop = chosen.is_some_and(|chosen| chosen.value);
            if how.stop && (i == 0 || i + 1 == count) {
                let help = "leave it out: a path begins and ends at rest, unless `ends: {speed: ...}` tells otherwise";
                self.reader.report(Code::UnknownWord, key, "a path stops between its first and its last point", "", help);
            }
        }
        let via = match fields.get("via") {
            None => None,
            Some((key, node)) => {
                if i == 0 {
                    let help = "write the point where the arc begins before it";
                    self.reader.report(Code::MissingPath, point.span, "a path begins with a point, not with an arc", "", help);
                }
                if curve != Curve::Lines {
                    self.reader.report(Code::UnknownWord, point.span, "only `curve: lines` has arcs", "", "write `curve: lines`");
                }
                Some(self.numbers(node, key, "via", Some((3, "x, y, z in m")))?.try_into().ok()?)
            }
        };
        let (_, numbers) = fields.get(if of_tip { "to" } else { "q" })?;
        Some((numbers, via, how))
    }

    fn pieces(&mut self, node: &Node, key: Span) -> Option<Form> {
        let fields = self.reader.mapping(node, "`pieces`", key, &PIECES)?;
        let knots = fields.get("knots").and_then(|(key, node)| self.numbers(node, key, "knots", None));
        if let (Some(knots), Some((_, node))) = (&knots, fields.get("knots")) {
            if let Some(i) = knots.windows(2).position(|pair| pair[0] >= pair[1]) {
                let message = format!("knot {} is not above knot {}", i + 2, i + 1);
                self.reader.report(Code::KnotOrder, node.span, message, "", "write the values of s in ascending order");
            }
        }
        let (at, node) = fields.get("coefficients")?;
        let help = "write `coefficients[piece][joint][power]`, powers of s - knot, lowest first: `[[[0, 1], [0.5, -1]]]`";
        let list = self.reader.list(node, at, "coefficients", "a list of pieces", help)?;
        let dof = self.arm.dof();
        let (mut coefficients, mut places) = (Vec::new(), Vec::new());
        let mut complete = true;
        for (i, piece) in list.iter().enumerate() {
            let name = format!("piece {}", i + 1);
            let Some(joints) = self.reader.list(piece, piece.span, &name, "a list of joints", help) else {
                complete = false;
                continue;
            };
            if joints.len() != dof {
                let message = format!("{name} has {} joints, the arm has {dof}", joints.len());
                self.reader.report(Shared::WrongLength, piece.span, message, "", help);
                complete = false;
                continue;
            }
            let mut all = Vec::new();
            for joint in joints {
                let Some(powers) = self.numbers(joint, joint.span, &name, None) else {
                    complete = false;
                    continue;
                };
                if powers.len() > 6 {
                    let message = format!("a polynomial has {} coefficients", powers.len());
                    let help = "a piece has degree 5 at most, so six coefficients: split it";
                    self.reader.report(Shared::WrongLength, joint.span, message, "too many", help);
                }
                all.push(powers);
            }
            coefficients.push(all);
            places.push(Place::of(piece));
        }
        let knots = knots.filter(|_| complete)?;
        if knots.len() != coefficients.len() + 1 || coefficients.is_empty() {
            let message = format!("{} knots do not fit {} pieces", knots.len(), coefficients.len());
            let help = "a path has one piece at least, and one knot more than pieces: where each begins, and where the last ends";
            self.reader.report(Shared::WrongLength, key, message, "", help);
            return None;
        }
        Some(Form::Pieces { knots, coefficients, places })
    }

    fn limits(&mut self, node: &Node, key: Span, limits: &mut Limits) {
        let Some(fields) = self.reader.mapping(node, "`limits`", key, &LIMITS) else { return };
        if let Some((key, node)) = fields.get("tool") {
            self.tool(node, key, &mut limits.tool);
        }
        for name in ["velocity", "acceleration", "effort"] {
            let Some((key, node)) = fields.get(name) else { continue };
            for (joint, node) in self.by_joint(node, key, name) {
                if let (Kind::List(_), "effort") = (&node.kind, name) {
                    let both = self.numbers(node, node.span, name, Some((2, "the lowest and the highest torque")));
                    if let Some([low, high]) = both.as_deref() {
                        if !(*low < 0.0 && *high > 0.0) {
                            let help = "write the lowest torque below zero, and the highest above: `[-20, 50]`";
                            self.reader.report(Code::NotPositive, node.span, "a limit of torque has the wrong sign", "", help);
                        }
                        limits.effort[joint] = [*low, *high];
                    }
                    continue;
                }
                let Some(limit) = self.number(node, node.span, name) else { continue };
                if limit <= 0.0 {
                    let message = format!("the limit of joint `{}` is not above zero", self.arm.joints[joint].name);
                    let help = "write the largest size that is allowed, in both directions";
                    self.reader.report(Code::NotPositive, node.span, message, "", help);
                }
                match name {
                    "velocity" => limits.velocity[joint] = limit,
                    "acceleration" => limits.acceleration[joint] = limit,
                    _ => limits.effort[joint] = [-limit, limit],
                }
            }
        }
    }

    /// Limits of the end effector.
    fn tool(&mut self, node: &Node, key: Span, limits: &mut [f64; 2]) {
        let Some(fields) = self.reader.mapping(node, "`tool`", key, &TOOL) else { return };
        if !self.arm.tips.is_empty() {
            let help = "limit its joints: `limits: {velocity: [...]}`";
            self.reader.report(Code::UnknownWord, key, "the arm has several end effectors: `tool` names none", "", help);
        }
        for (limit, name) in limits.iter_mut().zip(["speed", "turn_rate"]) {
            let Some((key, node)) = fields.get(name) else { continue };
            let Some(value) = self.number(node, key, name) else { continue };
            if value <= 0.0 {
                let help =
                    "write the largest length of the velocity in m/s, `speed`, or of the angular velocity in rad/s, `turn_rate`";
                self.reader.report(Code::NotPositive, node.span, format!("`{name}` of the tool is not above zero"), "", help);
            }
            *limit = value;
        }
    }

    /// The values of joints, by name or one for each.
    fn by_joint<'n>(&mut self, node: &'n Node, key: Span, name: &str) -> Vec<(usize, &'n Node)> {
        let dof = self.arm.dof();
        match &node.kind {
            Kind::Mapping(entries) => {
                let names: Vec<&str> = self.arm.joints.iter().map(|joint| joint.name.as_str()).collect();
                let mut found = Vec::new();
                for (joint, value) in entries {
                    match names.iter().position(|name| *name == joint.value) {
                        Some(place) => found.push((place, value)),
                        None => {
                            let near = did_you_mean(&joint.value, &names);
                            let near = near.map_or_else(String::new, |near| format!("did you mean `{near}`? "));
                            let message = format!("the arm has no joint `{}`", excerpt(&joint.value));
                            let help = format!("{near}its joints: {}", names.join(", "));
                            self.reader.report(Code::UnknownJoint, joint.span, message, "unknown joint", help);
                        }
                    }
                }
                found
            }
            Kind::List(items) if items.len() == dof => items.iter().enumerate().collect(),
            Kind::List(items) => {
                let message = format!("`{name}` has {} values, the arm has {dof} joints", items.len());
                let help = "write one limit for each joint, or those of some joints by name: `{elbow: 2}`";
                self.reader.report(Shared::WrongLength, node.span, message, "", help);
                Vec::new()
            }
            Kind::Scalar(_) => {
                let help = "write one limit for each joint in brackets, or those of some joints by name: `{elbow: 2}`";
                self.reader.wrong_kind(node, key, name, "a list of limits, or limits by joint", help);
                Vec::new()
            }
        }
    }

    /// Numbers, all or nothing; `length`: how many, and the meaning of them.
    fn numbers(&mut self, node: &Node, key: Span, name: &str, length: Option<(usize, &str)>) -> Option<Vec<f64>> {
        let help = length.map_or(NUMBER, |(_, each)| each);
        let items = self.reader.list(node, key, name, "a list of numbers", help)?;
        if let Some((length, each)) = length.filter(|(length, _)| *length != items.len()) {
            let message = format!("{name} has {} numbers, not {length}", items.len());
            self.reader.report(Shared::WrongLength, node.span, message, "wrong number of values", each);
            return None;
        }
        let numbers: Vec<Option<f64>> = items.iter().map(|item| self.number(item, item.span, name)).collect();
        numbers.into_iter().collect()
    }

    fn number(&mut self, node: &Node, key: Span, name: &str) -> Option<f64> {
        let number = self.reader.expression(node, key, name, NUMBER)?;
        let (code, at, message): (AnyCode, Span, &str) = match number.to_f64() {
            Ok(number) if number.is_finite() => return Some(number),
            Ok(_) => (Shared::NotFinite.into(), node.span, "the number is too large"),
            Err(place) => (Shared::UnknownName.into(), place, "a path has no named numbers"),
        };
        self.reader.report(code, at, message, "", NUMBER);
        None
    }
}
