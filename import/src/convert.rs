//! A description in rows of another convention, exactly where numbers end.
//!
//! ```text
//! lines.rs   joint axes as lines, their common normals: a, alpha, d, theta
//! names.rs   the parameters that the geometry names
//! write.rs   exact numbers, angles and poses as expressions
//! ```
//!
//! To urdf: link frames become those on the joint axes, rows and bodies keep their expressions. To rows of Denavit and Hartenberg: joint axes are
//! lines at q = 0, and rows are what their common normals say; bodies are attached where their frames were. An arm with branches is a list of
//! chains, each with the rows of a serial arm; a branch starts from the old link frame of its parent, by `mount`.

mod lines;
mod names;
mod write;

use std::collections::BTreeSet;

use armgen_codegen::description::{
    BodyDescription, ClosureDescription, Convention, JointDescription, LeadersDescription, PoseDescription, PoseElement,
    PosturesDescription, RegressorDescription, RobotDescription, RotationDescription, SpringDescription, StribeckDescription,
    Value, INERTIA_ELEMENTS,
};
use armgen_codegen::diagnostic::{Code, Diagnostic, Diagnostics};
use armgen_codegen::document::yaml::has_comment;
use armgen_codegen::document::Expression;
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::inverse_kinematics::{self, Redundancy};
use armgen_codegen::kinds::{JointKind, TaskRow};
use armgen_codegen::manipulator::{Manipulator, Placement};
use armgen_codegen::source::{Source, Span, Spanned};
use armgen_codegen::validate;

use self::write::Writer;

/// Said of a description with comments.
pub(crate) const COMMENTS: &str = "comments of the description are left out";

/// A description in another convention.
#[derive(Clone, Debug)]
pub struct Converted {
    /// The text of robot.yaml.
    pub yaml: String,
    /// Rounded values, and parts with a new meaning, a line for each.
    pub lines: Vec<String>,
}

/// The description in rows of a convention. All faults of the description; there is a text if and only if none of them is an error.
pub fn convert(source: &Source, to: Convention) -> (Option<Converted>, Diagnostics) {
    let (valid, mut diagnostics) = validate::read(source);
    let Some((arm, places)) = valid else { return (None, diagnostics) };
    let Some(description) = RobotDescription::parse(source).0 else { return (None, diagnostics) };
    let converter = Converter {
        source,
        description: &description,
        arm: &arm,
        writer: Writer::default(),
        frozen: BTreeSet::new(),
        lines: Vec::new(),
    };
    let converted = converter.convert(to).map(Converted::without_open_loops);
    if converted.is_none() {
        let message = "the common normals of the joint axes are too complex to be kept exactly";
        let help = "stay with the convention urdf, which any arm can be written in";
        diagnostics.push(Diagnostic::new(Code::TooComplex, places.name, message, "the rows of this arm", help));
    }
    (converted, diagnostics)
}

impl Converted {
    /// Without the points of `closes` if rounded numbers of rows no longer let the loops close exactly.
    fn without_open_loops(mut self) -> Converted {
        let (_, diagnostics) = validate::read(&Source::new("robot.yaml", self.yaml.as_str()));
        if !diagnostics.iter().any(|found| found.code == Code::OpenLoop) {
            return self;
        }
        let mut in_list = false;
        let stays = |line: &&str| {
            in_list = *line == "closes:" || in_list && line.starts_with(' ');
            !in_list
        };
        let rest: String = self.yaml.lines().filter(stays).map(|line| format!("{line}\n")).collect();
        let line = "left out: `closes`, since with rounded numbers the loops do not close exactly; the convention urdf keeps it";
        self.yaml = format!("# {line}\n{rest}");
        self.lines.push(line.into());
        self
    }
}

struct Converter<'d> {
    source: &'d Source,
    description: &'d RobotDescription,
    arm: &'d Manipulator,
    writer: Writer,
    /// Parameters whose values are written where their names stood.
    frozen: BTreeSet<&'d str>,
    lines: Vec<String>,
}

/// The new content of a joint: its row, and its old link frame in the new one.
struct Row<'d> {
    /// Poses of the frame that the row starts from, in the new link frame of its parent.
    mount: Vec<String>,
    /// Lines of the row.
    keys: Vec<String>,
    /// Poses of the old link frame in the new one, as they are written.
    poses: Vec<String>,
    /// The same.
    frame: Placement,
    /// Parameters that these poses name.
    named: Vec<&'d str>,
}

/// Rows, with `base` and `tool`.
struct Rows<'d> {
    base: Vec<String>,
    rows: Vec<Row<'d>>,
    tool: Vec<String>,
}

impl<'d> Converter<'d> {
    fn convert(mut self, to: Convention) -> Option<Converted> {
        let description = self.description;
        let from = description.convention.as_ref()?.value;
        let rows = if from == to {
            self.same()
        } else if to == Convention::Urdf {
            self.on_axes(from)
        } else {
            self.normals(to)?
        };
        let word = |convention| match convention {
            Convention::Standard => "standard",
            Convention::Modified => "modified",
            Convention::Urdf => "urdf",
        };
        let mut text = vec![format!("name: {}", description.name.as_ref()?.value), format!("convention: {}", word(to))];
        text.extend(description.gravity.as_ref().map(|gravity| {
            let vector = self.vector(&gravity.value);
            match description.gravity_is_argument {
                true => format!("gravity: {{argument: {vector}}}"),
                false => format!("gravity: {vector}"),
            }
        }));
        if !description.parameters.is_empty() {
            text.push("parameters:".into());
        }
        for parameter in &description.parameters {
            text.push(format!("  {}: {}", parameter.name.value, self.value(&parameter.value)));
        }
        text.extend(poses("base", &rows.base));
        text.push("joints:".into());
        let joints: &[JointDescription] = description.joints.as_ref().map_or(&[], |joints| &joints.value);
        for (k, (joint, row)) in joints.iter().zip(&rows.rows).enumerate() {
            self.joint(joint, k, row, &rows.rows, &mut text);
        }
        if let Some(tip) = &description.tip {
            text.push(format!("tip: {}", tip.value));
        }
        text.extend(poses("tool", &rows.tool).filter(|_| description.tips.is_none()));
        if let Some(payload) = &description.payload {
            text.push("payload:".into());
            self.body(payload, "  ", &mut text);
            if payload.mass.is_none() && payload.com.is_none() && payload.inertia.is_none() {
                *text.last_mut()? = "payload: {}".into();
            }
        }
        self.tips(&rows, &mut text)?;
        self.closes(&rows, &mut text);
        self.rest(&mut text);
        let moved = rows.rows.iter().any(|row| row.frame != Placement::identity());
        let named = matches!(description.regressor.as_ref().map(|r| &r.value), Some(RegressorDescription::Names(_)));
        if moved && !named {
            self.lines.push("link frames are others: so are link_frames and the columns of the regressor".into());
        }
        if from != to && self.swivel_is_from_another_point() {
            self.lines.push(
                "axes 3 and 4 are parallel: the elbow, from which inverse kinematics measures the swivel angle, is another point of axis 4 where d of row 3 is another".into(),
            );
        }
        let frozen: Vec<String> = description
            .parameters
            .iter()
            .map(|parameter| parameter.name.value.as_str())
            .filter(|name| self.frozen.contains(name))
            .map(|name| format!("`{name}`"))
            .collect();
        if !frozen.is_empty() {
            self.lines.push(format!(
                "where the geometry names parameters their values are written, so it no longer changes with them: {}",
                frozen.join(", ")
            ));
        }
        if !description.units.is_empty() || description.products.is_some() {
            self.lines.push("values are in SI units, and products of inertia are elements of the tensor".into());
        }
        if self.writer.rounded > 0 {
            self.lines
                .push(format!("{} numbers are rounded to 17 digits: no short expression is equal to them", self.writer.rounded));
        }
        let head = self.lines.iter().map(|line| format!("# {line}\n")).collect::<String>();
        // Of the way here, not of the description.
        if has_comment(self.source.text()) {
            self.lines.push(COMMENTS.into());
        }
        Some(Converted { yaml: head + &text.join("\n") + "\n", lines: self.lines })
    }

    /// The rows as they are.
    fn same(&mut self) -> Rows<'d> {
        let joints = self.description.joints.as_ref().map_or(&[][..], |joints| &joints.value);
        let rows = joints
            .iter()
            .map(|joint| {
                let mut keys = Vec::new();
                for (name, value) in [("a", &joint.a), ("alpha", &joint.alpha), ("d", &joint.d), ("theta", &joint.theta)] {
                    keys.extend(value.as_ref().map(|expression| format!("{name}: {}", self.text(expression))));
                }
                keys.extend(joint.origin.as_ref().and_then(|origin| poses("origin", &self.elements(Some(origin)))));
                keys.extend(joint.axis.as_ref().map(|axis| format!("axis: {}", self.vector(&axis.value))));
                let mount = self.elements(joint.mount.as_ref());
                Row { mount, keys, poses: Vec::new(), frame: Placement::identity(), named: Vec::new() }
            })
            .collect();
        Rows { base: self.elements(self.description.base.as_ref()), rows, tool: self.elements(self.description.tool.as_ref()) }
    }

    /// Rows of Denavit and Hartenberg as poses and axes.
    fn on_axes(&mut self, from: Convention) -> Rows<'d> {
        let joints = self.description.joints.as_ref().map_or(&[][..], |joints| &joints.value);
        let mut rows: Vec<Row<'d>> = Vec::new();
        let behind = |rows: &[Row<'d>], parent: usize| rows[parent].poses.clone();
        for (joint, valid) in joints.iter().zip(&self.arm.joints) {
            let twist = self.two(["xyz: [", &self.value(&joint.a), ", 0, 0]"], ["rpy: [", &self.value(&joint.alpha), ", 0, 0]"]);
            let turn = self.two(["xyz: [0, 0, ", &self.value(&joint.d), "]"], ["rpy: [0, 0, ", &self.value(&joint.theta), "]"]);
            let standard = from == Convention::Standard;
            let mut before = valid.parent.map_or_else(Vec::new, |parent| behind(&rows, parent.index()));
            before.extend(self.elements(joint.mount.as_ref()));
            before.extend(twist.clone().filter(|_| !standard).into_iter().chain(turn));
            let mut keys: Vec<String> = poses("origin", &before).into_iter().collect();
            keys.push("axis: [0, 0, 1]".into());
            let after: Vec<String> = twist.filter(|_| standard).into_iter().collect();
            let named = if standard { names::of_values([&joint.a, &joint.alpha]) } else { Vec::new() };
            rows.push(Row { mount: Vec::new(), keys, poses: after, frame: self.nominal(&valid.row.after.frame), named });
        }
        let mut tool = behind(&rows, self.arm.tip.index());
        tool.extend(self.elements(self.description.tool.as_ref()));
        Rows { base: self.elements(self.description.base.as_ref()), rows, tool }
    }

    /// A pose of a translation and a rotation, those that are not 0.
    fn two(&self, xyz: [&str; 3], rpy: [&str; 3]) -> Option<String> {
        let parts: Vec<String> = [xyz, rpy].into_iter().filter(|part| part[1] != "0").map(|part| part.concat()).collect();
        (!parts.is_empty()).then(|| format!("{{{}}}", parts.join(", ")))
    }

    /// Rows by common normals.
    fn normals(&mut self, to: Convention) -> Option<Rows<'d>> {
        let description = self.description;
        self.frozen.extend(description.joints.iter().flat_map(|joints| &joints.value).flat_map(names::of_row));
        let tools = description.tips.iter().flat_map(|tips| &tips.value).map(|tip| &tip.tool);
        let poses = [&description.base, &description.tool].into_iter().chain(tools);
        self.frozen.extend(poses.flat_map(|pose| names::of_pose(pose.as_ref())));
        let chains = self.chains();
        let several_on_base = self.arm.parents().filter(Option::is_none).count() > 1;
        let tip = self.arm.tip.index();
        let mut all = Rows { base: Vec::new(), rows: Vec::new(), tool: Vec::new() };
        let mut rows: Vec<Option<Row<'d>>> = self.arm.joints.iter().map(|_| None).collect();
        for chain in chains {
            let is_last = self.arm.tips.is_empty() && chain.last() == Some(&tip);
            let end = if is_last { self.nominal(&self.arm.tool.frame) } else { Placement::identity() };
            let Rows { base, rows: of_chain, tool } = self.normals_of(to, &chain, &end)?;
            let first = chain[0];
            for (k, row) in chain.into_iter().zip(of_chain) {
                rows[k] = Some(row);
            }
            // A chain starts from the old link frame of its parent.
            let mut mount = self.arm.joints[first]
                .parent
                .map_or_else(Vec::new, |parent| rows[parent.index()].as_ref().map_or_else(Vec::new, |row| row.poses.clone()));
            match self.arm.joints[first].parent {
                None if !several_on_base => all.base = base,
                _ => {
                    mount.extend(base);
                    rows[first].as_mut()?.mount = mount;
                }
            }
            if is_last {
                all.tool = tool;
            }
        }
        all.rows = rows.into_iter().collect::<Option<_>>()?;
        if self.arm.parents().any(|parent| parent == Some(tip)) {
            // The end effector is beside a chain, in the old link frame.
            all.tool = all.rows[tip].poses.iter().cloned().chain(self.elements(description.tool.as_ref())).collect();
        }
        Some(all)
    }

    /// The joints by chains, each from a joint that is not the first one on its parent to a link without joints; parents precede children.
    fn chains(&self) -> Vec<Vec<usize>> {
        let parents: Vec<Option<usize>> = self.arm.parents().collect();
        let first_child = |of: usize| parents.iter().position(|parent| *parent == Some(of));
        let begins = |&k: &usize| parents[k].is_none_or(|parent| first_child(parent) != Some(k));
        let chain = |first: usize| std::iter::successors(Some(first), |&k| first_child(k)).collect();
        (0..parents.len()).filter(begins).map(chain).collect()
    }

    /// The rows of a chain of joints to the frame `end` in its last link frame, by common normals.
    fn normals_of(&mut self, to: Convention, chain: &[usize], end: &Placement) -> Option<Rows<'d>> {
        let of_chain = || chain.iter().map(|&k| &self.arm.joints[k]);
        let joints: Vec<lines::Axis> = of_chain()
            .map(|joint| lines::Axis {
                before: self.nominal(&joint.row.before.frame),
                direction: joint.row.axis.clone(),
                after: self.nominal(&joint.row.after.frame),
                prismatic: joint.kind == JointKind::Prismatic,
            })
            .collect();
        let names: Vec<&str> = of_chain().map(|joint| joint.name.as_str()).collect();
        let normals = lines::normals(&joints, end)?;
        for (k, normal) in normals.iter().enumerate() {
            let turned = normal.twist.0.to_f64().abs();
            if turned > 0.0 && turned < 1e-3 && normal.twist.0.sign() != std::cmp::Ordering::Equal {
                let axis = |k: usize| match (k, names.get(k.wrapping_sub(1))) {
                    (0, _) => "the z axis of the base".to_owned(),
                    (_, Some(name)) => format!("the axis of `{name}`"),
                    _ => "the z axis of the end effector".to_owned(),
                };
                self.lines.push(format!(
                    "nearly-parallel: {} and {} are nearly, but not, parallel; their rows have huge lengths: stay with the convention urdf",
                    axis(k),
                    axis(k + 1)
                ));
            }
        }
        let standard = to == Convention::Standard;
        let n = joints.len();
        let writer = &mut self.writer;
        let mut rows = Vec::new();
        for i in 1..=n {
            let of_row = &normals[if standard { i } else { i - 1 }];
            let keys = vec![
                format!("a: {}", writer.number(&of_row.length)),
                format!("alpha: {}", writer.angle(&of_row.twist)),
                format!("d: {}", writer.number(&normals[i].offset)),
                format!("theta: {}", writer.angle(&normals[i].turn)),
            ];
            let link = if standard { &normals[i].far } else { &normals[i].near };
            let frame = link.inverse().then(&joints[i - 1].after);
            let poses = writer.pose(&frame).into_iter().collect();
            rows.push(Row { mount: Vec::new(), keys, poses, frame, named: Vec::new() });
        }
        // Rz and Tz about the z axes of base and end effector, and the twists that no row holds.
        let about_z = |writer: &mut Writer, h: &Number, turn: &(Number, Number)| {
            let (h, angle) = (writer.number(h), writer.angle(turn));
            let parts = [("xyz", &h), ("rpy", &angle)].into_iter().filter(|(_, text)| *text != "0");
            let parts: Vec<String> = parts.map(|(key, text)| format!("{key}: [0, 0, {text}]")).collect();
            (!parts.is_empty()).then(|| format!("{{{}}}", parts.join(", ")))
        };
        let about_x = |writer: &mut Writer, normal: &lines::Normal| {
            let (a, angle) = (writer.number(&normal.length), writer.angle(&normal.twist));
            let parts = [("xyz", &a), ("rpy", &angle)].into_iter().filter(|(_, text)| *text != "0");
            let parts: Vec<String> = parts.map(|(key, text)| format!("{key}: [{text}, 0, 0]")).collect();
            (!parts.is_empty()).then(|| format!("{{{}}}", parts.join(", ")))
        };
        let mut base: Vec<String> = about_z(writer, &normals[0].offset, &normals[0].turn).into_iter().collect();
        let mut tool = Vec::new();
        if standard {
            base.extend(about_x(writer, &normals[0]));
        } else {
            tool.extend(about_x(writer, &normals[n]));
        }
        tool.extend(about_z(writer, &normals[n + 1].offset, &normals[n + 1].turn));
        Some(Rows { base, rows, tool })
    }

    fn joint(&mut self, joint: &'d JointDescription, k: usize, row: &Row<'d>, rows: &[Row<'d>], text: &mut Vec<String>) {
        let kind = if self.arm.joints[k].kind == JointKind::Prismatic { "prismatic" } else { "revolute" };
        text.push(format!("  - name: {}", self.arm.joints[k].name));
        text.push(format!("    type: {kind}"));
        let parent = self.arm.parents().nth(k).flatten();
        if parent != k.checked_sub(1) || !row.mount.is_empty() {
            text.push(format!("    parent: {}", parent.map_or("base", |parent| &self.arm.joints[parent].name)));
        }
        text.extend(poses("    mount", &row.mount));
        for (key, leaders) in [("follows", &joint.follows), ("adds", &joint.adds)] {
            let Some(leaders) = leaders else { continue };
            text.push(format!("    {key}: {}", self.leaders(leaders)));
        }
        text.extend(joint.offset.as_ref().map(|offset| format!("    offset: {}", self.text(offset))));
        text.extend(row.keys.iter().map(|key| format!("    {key}")));
        let mut limits = Vec::new();
        limits.extend(joint.limits.position.as_ref().map(|limits| format!("position: {}", self.vector(&limits.value))));
        let sizes = [
            ("velocity", &joint.limits.velocity),
            ("acceleration", &joint.limits.acceleration),
            ("jerk", &joint.limits.jerk),
            ("effort", &joint.limits.effort),
        ];
        for (name, value) in sizes {
            limits.extend(value.as_ref().map(|expression| format!("{name}: {}", self.text(expression))));
        }
        if !limits.is_empty() {
            text.push(format!("    limits: {{{}}}", limits.join(", ")));
        }
        text.push("    link:".into());
        self.link(joint, k, row, text);
        self.motor(joint, k, rows, text);
        let mut friction = self.given(&joint.friction.numbers());
        friction.extend(joint.friction.stribeck.as_ref().map(|StribeckDescription { torque, velocity, .. }| {
            format!("stribeck: {{{}}}", self.given(&[("torque", torque), ("velocity", velocity)]).join(", "))
        }));
        if !friction.is_empty() {
            text.push(format!("    friction: {{{}}}", friction.join(", ")));
        }
        if let Some(SpringDescription { stiffness, rest, .. }) = &joint.spring {
            // The joint variable is the same in rows of every convention.
            self.mapping("spring", &[("stiffness", stiffness), ("rest", rest)], text);
        }
        text.extend(joint.armature.as_ref().map(|armature| format!("    armature: {}", self.text(armature))));
    }

    /// The numbers that the file gives, behind their keys.
    fn given(&self, numbers: &[(&str, &Value)]) -> Vec<String> {
        numbers.iter().filter_map(|(name, value)| Some(format!("{name}: {}", self.text(value.as_ref()?)))).collect()
    }

    /// A key of a joint with the numbers that the file gives under it, if there are any.
    fn mapping(&self, key: &str, numbers: &[(&str, &Value)], text: &mut Vec<String>) {
        let given = self.given(numbers);
        if !given.is_empty() {
            text.push(format!("    {key}: {{{}}}", given.join(", ")));
        }
    }

    /// The bodies of a link, in its new frame.
    fn link(&mut self, joint: &JointDescription, k: usize, row: &Row<'_>, text: &mut Vec<String>) {
        let Some(link) = &joint.link else { return };
        let parts = &self.arm.joints[k].link;
        let own = [(None, None, link)].into_iter();
        let others = link.attached.iter().map(|other| (other.name.as_ref(), other.origin.as_ref(), &other.body));
        let mut bodies = Vec::new();
        for ((name, origin, body), part) in own.chain(others).zip(parts) {
            let frame = row.frame.then(&self.nominal(&part.frame.frame));
            let steps = || row.poses.iter().cloned().chain(self.elements(origin)).collect();
            let named = !row.named.is_empty() || !names::of_pose(origin).is_empty();
            let written = if named {
                steps()
            } else if frame == Placement::identity() {
                Vec::new()
            } else if row.poses.is_empty() || origin.is_none() {
                steps()
            } else {
                // One pose where it is exact, else the steps.
                let before = self.writer.rounded;
                match self.writer.pose(&frame) {
                    one if self.writer.rounded == before => one.into_iter().collect(),
                    _ => {
                        self.writer.rounded = before;
                        row.poses.iter().cloned().chain(self.elements(origin)).collect()
                    }
                }
            };
            bodies.push((name.map(|name| &name.value), written, body));
        }
        // The link's own body: the first one in the link's frame that has no name.
        let own = bodies.iter().position(|(name, written, _)| name.is_none() && written.is_empty());
        match own {
            Some(own) => self.body(bodies.remove(own).2, "      ", text),
            None => text.push("      mass: 0".into()),
        }
        let nothing = |body: &BodyDescription| self.value(&body.mass) == "0" && body.inertia.is_none();
        bodies.retain(|(name, _, body)| name.is_some() || !nothing(body));
        if !bodies.is_empty() {
            text.push("      attached:".into());
        }
        for (name, written, body) in bodies {
            let mut lines = Vec::new();
            lines.extend(name.map(|name| format!("          name: {}", crate::yaml::quoted(name))));
            lines.extend(poses("          origin", &written));
            self.body(body, "          ", &mut lines);
            if let Some(first) = lines.first_mut() {
                first.replace_range(8..10, "- ");
            }
            text.extend(lines);
        }
    }

    /// Joints with factors.
    fn leaders(&self, leaders: &'d LeadersDescription) -> String {
        let all = leaders.leaders.iter().map(|(name, factor)| format!("{}: {}", name.value, self.value(factor)));
        format!("{{{}}}", all.collect::<Vec<_>>().join(", "))
    }

    /// A rotor, whose place is given in the frame of the link that carries it.
    fn motor(&mut self, joint: &'d JointDescription, k: usize, rows: &[Row<'d>], text: &mut Vec<String>) {
        let (Some(motor), Some(valid)) = (&joint.motor, &self.arm.joints[k].motor) else { return };
        text.push("    motor:".into());
        let mut line = |name: &str, words: String| text.push(format!("      {name}: {words}"));
        for (name, value) in [
            ("ratio", &motor.ratio),
            ("inertia", &motor.inertia),
            ("mass", &motor.mass),
            ("viscous", &motor.viscous),
            ("gain", &motor.gain),
        ] {
            if let Some(expression) = value {
                line(name, self.text(expression));
            }
        }
        if let Some(on) = &motor.on {
            line("on", on.value.clone());
        }
        if let Some(coupling) = &motor.coupling {
            line("coupling", self.leaders(coupling));
        }
        let moved = valid.carrier.map(|carrier| &rows[carrier.index()]).filter(|row| row.frame != Placement::identity());
        // Where none is given the mass sits at the origin of the old frame.
        let place = match (&motor.position, moved) {
            (Some(position), None) => Some(self.vector(&position.value)),
            (None, None) => None,
            (_, Some(row)) if motor.mass.is_some() || motor.position.is_some() => {
                self.frozen.extend(&row.named);
                self.frozen.extend(names::of_values(motor.position.iter().flat_map(|position| &position.value)));
                let point = row.frame.point(&valid.position.each_ref().map(|x| Polynomial::from(self.evaluated(x))));
                let texts = point.each_ref().map(|x| self.evaluated(x)).map(|x| self.writer.number(&x));
                Some(format!("[{}]", texts.join(", ")))
            }
            (_, Some(_)) => None,
        };
        if let Some(place) = place {
            line("position", place);
        }
        // The spin axis is the joint axis where none is given.
        if let Some(axis) = &motor.axis {
            line(
                "axis",
                match moved {
                    None => self.vector(&axis.value),
                    Some(row) => {
                        self.frozen.extend(&row.named);
                        self.frozen.extend(names::of_values(&axis.value));
                        let texts = row.frame.direction(&valid.axis).each_ref().map(|x| self.writer.number(x));
                        format!("[{}]", texts.join(", "))
                    }
                },
            );
        }
    }

    fn body(&self, body: &BodyDescription, indent: &str, text: &mut Vec<String>) {
        text.extend(body.mass.as_ref().map(|mass| format!("{indent}mass: {}", self.text(mass))));
        text.extend(body.com.as_ref().map(|com| format!("{indent}com: {}", self.vector(&com.value))));
        let Some(inertia) = &body.inertia else { return };
        let elements = INERTIA_ELEMENTS.iter().zip(&inertia.elements);
        let mut parts: Vec<String> =
            elements.filter_map(|(name, value)| Some(format!("{name}: {}", self.text(value.as_ref()?)))).collect();
        parts.extend(inertia.rotation.as_ref().map(|rotation| self.rotation(rotation)));
        text.push(format!("{indent}inertia: {{{}}}", parts.join(", ")));
    }

    /// The end effectors with names, each in the new frame of its link.
    fn tips(&mut self, rows: &Rows<'_>, text: &mut Vec<String>) -> Option<()> {
        let Some(tips) = &self.description.tips else { return Some(()) };
        text.push("tips:".into());
        for (tip, valid) in tips.value.iter().zip(&self.arm.tips) {
            text.push(format!("  - name: {}", valid.name));
            text.push(format!("    joint: {}", tip.joint.as_ref()?.value));
            let carried = rows.rows[valid.joint.index()].poses.iter().cloned();
            let tool: Vec<String> = carried.chain(self.elements(tip.tool.as_ref())).collect();
            text.extend(poses("tool", &tool).map(|line| format!("    {line}")));
            if let Some(payload) = &tip.payload {
                text.push("    payload:".into());
                self.body(payload, "      ", text);
                if payload.mass.is_none() && payload.com.is_none() && payload.inertia.is_none() {
                    *text.last_mut()? = "    payload: {}".into();
                }
            }
            if tip.task.is_some() {
                let rows: Vec<&str> = valid.task.iter().map(|row| row.name()).collect();
                text.push(format!("    task: [{}]", rows.join(", ")));
            }
            text.extend(self.inverse_kinematics(&tip.inverse_kinematics).map(|line| format!("    {line}")));
        }
        Some(())
    }

    /// The points that two links share, where the frames of both links stay.
    fn closes(&mut self, rows: &Rows<'_>, text: &mut Vec<String>) {
        let names: Vec<&str> = self.arm.joints.iter().map(|joint| joint.name.as_str()).collect();
        let stays = |link: &Option<Spanned<String>>| {
            let place = link.as_ref().and_then(|link| names.iter().position(|name| *name == link.value));
            place.is_none_or(|place| rows.rows[place].frame == Placement::identity())
        };
        let (kept, moved): (Vec<_>, Vec<_>) =
            self.description.closes.iter().partition(|closure| stays(&closure.joint) && stays(&closure.with));
        if !kept.is_empty() {
            text.push("closes:".into());
        }
        for ClosureDescription { name, joint, at, with, there, .. } in kept {
            let word = |key: &str, given: &Option<Spanned<String>>| given.as_ref().map(|given| format!("{key}: {}", given.value));
            let point = |key: &str, given: &Option<Spanned<[Value; 3]>>| {
                given.as_ref().map(|given| format!("{key}: {}", self.vector(&given.value)))
            };
            let name = name.as_ref().map(|name| format!("name: {}", crate::yaml::quoted(&name.value)));
            let parts = [name, word("joint", joint), point("at", at), word("with", with), point("there", there)];
            text.push(format!("  - {{{}}}", parts.into_iter().flatten().collect::<Vec<_>>().join(", ")));
        }
        if !moved.is_empty() {
            self.lines.push("left out: points of `closes` on links whose frames are others".into());
        }
    }

    /// The parts that do not depend on frames.
    fn rest(&self, text: &mut Vec<String>) {
        // Every key, so that none is left out unseen; the first ones are written before.
        let RobotDescription {
            name: _,
            convention: _,
            gravity: _,
            gravity_is_argument: _,
            units: _,
            products: _,
            parameters: _,
            joints: _,
            base: _,
            tip: _,
            tool: _,
            payload: _,
            task,
            regressor,
            inverse_kinematics,
            tips: _,
            closes: _,
            allow,
        } = self.description;
        if let Some(task) = task {
            let rows: Vec<&str> = task.value.iter().map(|row| TaskRow::name(row.value)).collect();
            text.push(format!("task: [{}]", rows.join(", ")));
        }
        text.extend(regressor.as_ref().map(|regressor| match &regressor.value {
            RegressorDescription::Standard => "regressor: standard".to_owned(),
            RegressorDescription::Base => "regressor: base".to_owned(),
            RegressorDescription::Names(names) => {
                format!("regressor: [{}]", names.iter().map(|name| name.value.as_str()).collect::<Vec<_>>().join(", "))
            }
        }));
        text.extend(self.inverse_kinematics(inverse_kinematics));
        if !allow.is_empty() {
            let kinds: Vec<&str> = allow.iter().map(|kind| kind.value.as_str()).collect();
            text.push(format!("allow: [{}]", kinds.join(", ")));
        }
    }

    /// Target and joint, which are the same in every convention.
    fn inverse_kinematics(&self, asked: &PosturesDescription) -> Option<String> {
        let PosturesDescription { target, given } = asked;
        let mut parts = Vec::new();
        parts.extend(target.as_ref().map(|target| format!("target: {}", self.written(target.span))));
        parts.extend(given.as_ref().map(|given| format!("given: {}", given.value)));
        (!parts.is_empty()).then(|| format!("inverse_kinematics: {{{}}}", parts.join(", ")))
    }

    /// Whether the swivel angle is given and rows say from where it is measured: the elbow is the point of axis 4 that is nearest to axis 3.
    fn swivel_is_from_another_point(&self) -> bool {
        let [_, _, third, fourth, ..] = &self.arm.joints[..] else { return false };
        let step = third.row.after.frame.then(&fourth.row.before.frame);
        lines::are_parallel(&third.row.axis, &step.direction(&fourth.row.axis))
            && inverse_kinematics::of(self.arm).is_ok_and(|found| matches!(found.redundancy, Some(Redundancy::Swivel)))
    }

    /// The expression as it is written, or in SI units where the file names others.
    fn text(&self, expression: &Expression) -> String {
        expression.text(self.source).split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// A scalar as it is written, without quotes.
    fn written(&self, span: Span) -> String {
        self.source.slice(span).trim_matches(['"', '\'']).split_whitespace().collect::<Vec<_>>().join(" ")
    }

    fn value(&self, value: &Value) -> String {
        value.as_ref().map_or_else(|| "0".to_owned(), |expression| self.text(expression))
    }

    fn vector(&self, values: &[Value]) -> String {
        format!("[{}]", values.iter().map(|value| self.value(value)).collect::<Vec<_>>().join(", "))
    }

    fn rotation(&self, rotation: &RotationDescription) -> String {
        match rotation {
            RotationDescription::Rpy(rpy) => format!("rpy: {}", self.vector(&rpy.value)),
            RotationDescription::Quat(quat) => format!("quat: {}", self.vector(&quat.value)),
            RotationDescription::AxisAngle(axis, angle) => {
                format!("axis: {}, angle: {}", self.vector(&axis.value), self.text(angle))
            }
            RotationDescription::XyAxes(axes) => format!("xyaxes: {}", self.vector(&axes.value)),
        }
    }

    fn elements(&self, pose: Option<&PoseDescription>) -> Vec<String> {
        let one = |element: &PoseElement| {
            let mut parts = Vec::new();
            parts.extend(element.xyz.as_ref().map(|xyz| format!("xyz: {}", self.vector(&xyz.value))));
            parts.extend(element.rotation.as_ref().map(|rotation| self.rotation(rotation)));
            format!("{{{}}}", parts.join(", "))
        };
        pose.map_or(&[][..], |pose| &pose.elements).iter().map(one).collect()
    }

    fn evaluated(&self, length: &Polynomial) -> Number {
        length.evaluate(&|id| self.arm.parameters[id.0 as usize].nominal.clone())
    }

    /// With the values of the file for names.
    fn nominal(&self, frame: &Placement) -> Placement {
        let translation = frame.translation.each_ref().map(|x| Polynomial::from(self.evaluated(x)));
        Placement { rotation: frame.rotation.clone(), translation }
    }
}

/// Poses under a key; `None` if empty.
fn poses(key: &str, list: &[String]) -> Option<String> {
    match list {
        [] => None,
        [one] => Some(format!("{key}: {one}")),
        all => Some(format!("{key}: [{}]", all.join(", "))),
    }
}
