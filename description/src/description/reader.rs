//! Tree of nodes -> [`RobotDescription`]. [`keys`](super::keys) declares the keys and the kinds of their values.

use super::keys::{
    Entry, ATTACHED, CLOSURE, CONVENTIONS, FRICTION, GRAVITY, INERTIA, INVERSE_KINEMATICS, JOINT, JOINT_KINDS, LIMITS, LINK,
    MOST_POSES, MOTOR, PAYLOAD, POSE, PRODUCTS, REGRESSORS, ROBOT, ROTATIONS, SPRING, STRIBECK, TARGETS, TIP, URDF_JOINT,
};
use super::other_formats::{OTHER_NAMES, OTHER_PLACES};
use super::units::{UnitKey, KEYS};
use super::{
    AttachedDescription, BodyDescription, ClosureDescription, Convention, FrictionDescription, InertiaDescription,
    JointDescription, LeadersDescription, LimitsDescription, MotorDescription, NamedUnit, ParameterDescription, PoseDescription,
    PoseElement, PosturesDescription, RegressorDescription, RobotDescription, RotationDescription, SpringDescription,
    StribeckDescription, TipDescription, Value, INERTIA_ELEMENTS,
};
use crate::diagnostic::{Code, Diagnostics};
use crate::document::reader::{first_key, optional, Fields, Reader};
use crate::document::yaml::{Kind, Node};
use crate::document::{excerpt, Expression, Unit};
use crate::kinds::{TaskRow, MAX_TIPS};
use crate::source::{Source, Span, Spanned};

/// The description that the tree holds.
pub(super) fn read(source: &Source, root: Option<&Node>, diagnostics: &mut Diagnostics) -> Option<RobotDescription> {
    let mut reader = Reader::new(diagnostics).with_other_names(OTHER_NAMES).with_other_places(OTHER_PLACES);
    let begin = "begin with `name: my_robot`, `convention: standard`, `gravity: [0, 0, -9.81]` and `joints:`";
    let root = reader.root(source, root, "a description", begin)?;
    Some(reader.robot(root))
}

impl Reader<'_> {
    fn robot(&mut self, root: &Node) -> RobotDescription {
        let first = first_key(root);
        let Some(fields) = self.mapping(root, "the description", first, ROBOT) else { return RobotDescription::default() };
        let convention = fields.get("convention").and_then(|(key, node)| {
            let help = "`standard`: Rz(theta) Tz(d) Tx(a) Rx(alpha) (Siciliano); `modified`: Rx(alpha) Tx(a) Rz(theta) Tz(d) (Craig, Khalil); `urdf`: `origin` and `axis`";
            self.choice(node, key, "convention", &CONVENTIONS, Code::UnknownConvention, help)
        });
        let convention = convention.filter(|convention| !self.rows_of_another_convention(convention, &fields));
        let rows = match convention.as_ref().map(|c| c.value) {
            Some(Convention::Urdf) => URDF_JOINT,
            _ => JOINT,
        };
        RobotDescription {
            name: fields.get("name").and_then(|(key, node)| self.word(node, key, "name")),
            convention,
            gravity: fields.get("gravity").and_then(|(key, node)| self.gravity(node, key)),
            gravity_is_argument: fields.get("gravity").is_some_and(|(_, node)| matches!(node.kind, Kind::Mapping(_))),
            units: fields.get("units").map_or_else(Vec::new, |(key, node)| self.units(node, key)),
            products: fields.get("products").and_then(|(key, node)| {
                let help = "`tensor`: xy is the element -∫xy dm of the inertia tensor; `integral`: xy is ∫xy dm, which has the other sign";
                self.choice(node, key, "products", &PRODUCTS, Code::UnknownProducts, help)
            }),
            parameters: fields.get("parameters").map_or_else(Vec::new, |(key, node)| self.parameters(node, key)),
            joints: fields.get("joints").and_then(|(key, node)| self.joints(node, key, rows)),
            base: fields.get("base").and_then(|(key, node)| self.pose(node, key, "base")),
            tip: fields.get("tip").and_then(|(key, node)| self.word(node, key, "tip")),
            tool: fields.get("tool").and_then(|(key, node)| self.pose(node, key, "tool")),
            payload: fields.get("payload").and_then(|(key, node)| self.body(node, key, "`payload`", PAYLOAD)),
            task: fields.get("task").and_then(|(key, node)| self.task(node, key)),
            regressor: fields.get("regressor").and_then(|(key, node)| self.regressor(node, key)),
            inverse_kinematics: fields
                .get("inverse_kinematics")
                .and_then(|(key, node)| self.inverse_kinematics(node, key))
                .unwrap_or_default(),
            tips: fields.get("tips").and_then(|(key, node)| self.tips(node, key, &fields)),
            closes: fields.get("closes").map_or_else(Vec::new, |(key, node)| self.closes(node, key)),
            allow: fields.get("allow").map_or_else(Vec::new, |(key, node)| self.allow(node, key)),
        }
    }

    /// The acceleration of free fall, or its nominal value where it is an argument.
    fn gravity(&mut self, node: &Node, key: Span) -> Option<Spanned<[Value; 3]>> {
        let parts = ["x", "y", "z"];
        match node.kind {
            Kind::Mapping(_) => {
                let (key, node) = self.mapping(node, "`gravity`", key, GRAVITY)?.get("argument")?;
                self.vector(node, key, "argument", parts)
            }
            _ => self.vector(node, key, "gravity", parts),
        }
    }

    fn units(&mut self, node: &Node, key: Span) -> Vec<NamedUnit> {
        let keys = KEYS.each_ref().map(|key| optional(key.name));
        let Some(fields) = self.mapping(node, "`units`", key, &keys) else { return Vec::new() };
        let mut named = Vec::new();
        for &UnitKey { name, si, examples, .. } in &KEYS {
            let Some((place, node)) = fields.get(name) else { continue };
            let help = format!("units of `{name}` are {examples}");
            let Some(text) = self.text(node, place, name, "a unit", &help) else { continue };
            match Unit::named(&text.value).filter(|(_, of)| *of == si) {
                Some((unit, _)) => named.push(NamedUnit { key: name, text, unit }),
                None => {
                    let message = format!("`{}` is no unit of `{name}`", excerpt(&text.value));
                    self.report(Code::UnknownUnit, text.span, message, "unknown unit", help);
                }
            }
        }
        named
    }

    fn parameters(&mut self, node: &Node, key: Span) -> Vec<ParameterDescription> {
        let Kind::Mapping(entries) = &node.kind else {
            let names = self.keys_without_space(node);
            if !names.is_empty() {
                return names.into_iter().map(|name| ParameterDescription { name, value: None }).collect();
            }
            self.wrong_kind(
                node,
                key,
                "parameters",
                "a mapping of names to values",
                "write one `name: value` per line, or leave the key out",
            );
            return Vec::new();
        };
        let read = |(name, value): &(Spanned<String>, Node)| ParameterDescription {
            name: name.clone(),
            value: self.value(value, name.span, &name.value),
        };
        entries.iter().map(read).collect()
    }

    fn joints(&mut self, node: &Node, key: Span, rows: &'static [Entry]) -> Option<Spanned<Vec<JointDescription>>> {
        let items = self.list(node, key, "joints", "a list", "write one `- name: ...` per joint, from base to tip")?;
        let joints = items.iter().filter_map(|item| self.joint(item, rows)).collect::<Vec<_>>();
        // A joint that is not a mapping is reported; afterwards the others keep their numbers only in messages.
        (!joints.is_empty() || items.is_empty()).then(|| Spanned::new(joints, key))
    }

    fn joint(&mut self, node: &Node, keys: &'static [Entry]) -> Option<JointDescription> {
        let span = first_key(node);
        let fields = self.mapping(node, "a joint", span, keys)?;
        let name = fields.get("name").and_then(|(key, node)| self.word(node, key, "name"));
        let limits = fields.get("limits").and_then(|(key, node)| self.mapping(node, "`limits`", key, LIMITS));
        let friction = fields.get("friction").and_then(|(key, node)| self.mapping(node, "`friction`", key, FRICTION));
        Some(JointDescription {
            name,
            kind: fields.get("type").and_then(|(key, node)| {
                let help = "`revolute`: turns about its z axis; `prismatic`: slides along it. Leave a fixed joint out: it is part of its link";
                self.choice(node, key, "type", &JOINT_KINDS, Code::UnknownJointType, help)
            }),
            parent: fields.get("parent").and_then(|(key, node)| self.word(node, key, "parent")),
            mount: fields.get("mount").and_then(|(key, node)| self.pose(node, key, "mount")),
            follows: fields.get("follows").and_then(|(key, node)| self.leaders(node, key, "follows")),
            adds: fields.get("adds").and_then(|(key, node)| self.leaders(node, key, "adds")),
            offset: self.field(&fields, "offset"),
            a: self.field(&fields, "a"),
            alpha: self.field(&fields, "alpha"),
            d: self.field(&fields, "d"),
            theta: self.field(&fields, "theta"),
            origin: fields.get("origin").and_then(|(key, node)| self.pose(node, key, "origin")),
            axis: fields.get("axis").and_then(|(key, node)| self.vector(node, key, "axis", ["x", "y", "z"])),
            limits: limits.map_or_else(LimitsDescription::default, |fields| LimitsDescription {
                position: fields.get("position").and_then(|(key, node)| self.vector(node, key, "position", ["lowest", "highest"])),
                velocity: self.field(&fields, "velocity"),
                acceleration: self.field(&fields, "acceleration"),
                jerk: self.field(&fields, "jerk"),
                effort: self.field(&fields, "effort"),
            }),
            link: fields.get("link").and_then(|(key, node)| self.body(node, key, "`link`", LINK)),
            motor: fields.get("motor").and_then(|(key, node)| self.motor(node, key)),
            friction: friction.map_or_else(FrictionDescription::default, |fields| {
                let stribeck = fields.get("stribeck").and_then(|(key, node)| {
                    let fields = self.mapping(node, "`stribeck`", key, STRIBECK)?;
                    let (torque, velocity) = (self.field(&fields, "torque"), self.field(&fields, "velocity"));
                    Some(StribeckDescription { key, torque, velocity })
                });
                FrictionDescription::new(|key| self.field(&fields, key), stribeck)
            }),
            spring: fields.get("spring").and_then(|(key, node)| {
                let fields = self.mapping(node, "`spring`", key, SPRING)?;
                Some(SpringDescription { key, stiffness: self.field(&fields, "stiffness"), rest: self.field(&fields, "rest") })
            }),
            armature: self.field(&fields, "armature"),
            span,
        })
    }

    /// Joints with factors.
    fn leaders(&mut self, node: &Node, key: Span, name: &str) -> Option<LeadersDescription> {
        let help = format!("write joints with factors: `{name}: {{finger: 1}}`");
        let Kind::Mapping(entries) = &node.kind else {
            self.wrong_kind(node, key, name, "a mapping of joints to factors", &help);
            return None;
        };
        if entries.is_empty() {
            self.report(Code::EmptyList, node.span, format!("`{name}` names no joint"), "empty", help);
            return None;
        }
        let leader = |(name, factor): &(Spanned<String>, Node)| (name.clone(), self.value(factor, name.span, &name.value));
        Some(LeadersDescription { key, leaders: entries.iter().map(leader).collect() })
    }

    fn body(&mut self, node: &Node, key: Span, what: &str, keys: &'static [Entry]) -> Option<BodyDescription> {
        let fields = self.mapping(node, what, key, keys)?;
        let attached = fields.get("attached").and_then(|(key, node)| {
            let help = "write one `- name: ...` per body, with `origin`, `mass`, `com` and `inertia`";
            self.list(node, key, "attached", "a list of bodies", help)
        });
        Some(BodyDescription {
            attached: attached.into_iter().flatten().filter_map(|item| self.attached(item)).collect(),
            ..self.mass_distribution(&fields, key)
        })
    }

    fn attached(&mut self, node: &Node) -> Option<AttachedDescription> {
        let key = first_key(node);
        let fields = self.mapping(node, "an attached body", key, ATTACHED)?;
        Some(AttachedDescription {
            name: fields.get("name").and_then(|(key, node)| self.text(node, key, "name", "a name", "write what the body is")),
            origin: fields.get("origin").and_then(|(key, node)| self.pose(node, key, "origin")),
            body: self.mass_distribution(&fields, key),
        })
    }

    fn mass_distribution(&mut self, fields: &Fields<'_>, key: Span) -> BodyDescription {
        BodyDescription {
            key,
            mass: self.field(fields, "mass"),
            com: fields.get("com").and_then(|(key, node)| self.vector(node, key, "com", ["x", "y", "z"])),
            inertia: fields.get("inertia").and_then(|(key, node)| {
                if self.tensor_as_list(node) {
                    return None;
                }
                let fields = self.mapping(node, "`inertia`", key, INERTIA)?;
                let elements = INERTIA_ELEMENTS.map(|name| self.field(&fields, name));
                let complete = INERTIA_ELEMENTS.iter().zip(&elements).all(|(name, e)| e.is_some() == fields.get(name).is_some());
                let (rotation, readable) = self.rotation(&fields);
                Some(InertiaDescription { key, elements, rotation, complete: complete && readable })
            }),
            attached: Vec::new(),
        }
    }

    /// One pose, or a list of poses, each in the frame of the one before it.
    fn pose(&mut self, node: &Node, key: Span, name: &str) -> Option<PoseDescription> {
        let mut pose = PoseDescription { key, elements: Vec::new(), complete: true };
        let items = match &node.kind {
            Kind::List(items) if self.pose_as_numbers(node, items, name) => return None,
            Kind::List(items) => items.as_slice(),
            _ => std::slice::from_ref(node),
        };
        if let Some(item) = items.get(MOST_POSES) {
            let message = format!("`{name}` has {} poses, more than the {MOST_POSES} that can be multiplied", items.len());
            self.report(Code::TooLarge, item.span, message, format!("pose {}", MOST_POSES + 1), "write several poses as one");
            return None;
        }
        for item in items {
            let Some(fields) = self.mapping(item, &format!("`{name}`"), key, POSE) else {
                pose.complete = false;
                continue;
            };
            let xyz = fields.get("xyz").map(|(key, node)| self.vector(node, key, "xyz", ["x", "y", "z"]));
            let (rotation, readable) = self.rotation(&fields);
            pose.complete &= readable && xyz.as_ref().is_none_or(Option::is_some);
            pose.elements.push(PoseElement { xyz: xyz.flatten(), rotation });
        }
        Some(pose)
    }

    /// The rotation among the keys of a mapping, if any, and whether the whole of it was readable.
    fn rotation(&mut self, fields: &Fields<'_>) -> (Option<RotationDescription>, bool) {
        let given: Vec<&str> = ROTATIONS.into_iter().filter(|key| fields.has(key)).collect();
        if let [first, second, ..] = given[..] {
            let message = format!("two rotations stand here: `{first}` and `{second}`");
            let help = "one pose turns once; write a list of poses for turns one after another";
            self.report(Code::SeveralRotations, fields.place(second), message, "the second one", help);
            return (None, false);
        }
        if fields.has("axis") != fields.has("angle") {
            let (there, lacking, example) =
                if fields.has("axis") { ("axis", "angle", "angle: pi/2") } else { ("angle", "axis", "axis: [0, 0, 1]") };
            let message = format!("`{there}` stands without `{lacking}`");
            let help = format!("a rotation about an axis needs both; write for instance `{example}`");
            self.report(Code::MissingKey, fields.place(there), message, format!("`{lacking}` is required beside it"), help);
            return (None, false);
        }
        let Some(&key) = given.first() else { return (None, true) };
        let (place, node) = fields.get(key).expect("a key that stands there");
        let rotation = match key {
            "rpy" => self.vector(node, place, key, ["about x", "about y", "about z"]).map(RotationDescription::Rpy),
            "quat" => self.vector(node, place, key, ["w", "x", "y", "z"]).map(RotationDescription::Quat),
            "xyaxes" => {
                let parts = ["x of the x axis", "its y", "its z", "x of the y axis", "its y", "its z"];
                self.vector(node, place, key, parts).map(RotationDescription::XyAxes)
            }
            _ => {
                let axis = self.vector(node, place, key, ["x", "y", "z"]);
                let angle = self.field(fields, "angle");
                axis.zip(angle).map(|(axis, angle)| RotationDescription::AxisAngle(axis, angle))
            }
        };
        let readable = rotation.is_some();
        (rotation, readable)
    }

    fn motor(&mut self, node: &Node, key: Span) -> Option<MotorDescription> {
        let fields = self.mapping(node, "`motor`", key, MOTOR)?;
        Some(MotorDescription {
            key,
            ratio: self.field(&fields, "ratio"),
            on: fields.get("on").and_then(|(key, node)| self.word(node, key, "on")),
            coupling: fields.get("coupling").and_then(|(key, node)| self.leaders(node, key, "coupling")),
            inertia: self.field(&fields, "inertia"),
            mass: self.field(&fields, "mass"),
            position: fields.get("position").and_then(|(key, node)| self.vector(node, key, "position", ["x", "y", "z"])),
            axis: fields.get("axis").and_then(|(key, node)| self.vector(node, key, "axis", ["x", "y", "z"])),
            viscous: self.field(&fields, "viscous"),
            gain: self.field(&fields, "gain"),
        })
    }

    fn task(&mut self, node: &Node, key: Span) -> Option<Spanned<Vec<Spanned<TaskRow>>>> {
        let items = self.list(node, key, "task", "a list", "write the rows in brackets: `task: [x, y, z]`")?;
        if items.is_empty() {
            let help = "name rows out of x y z rx ry rz, or leave the key out for all six";
            self.report(Code::EmptyList, node.span, "`task` names no row", "empty", help);
            return None;
        }
        let words = TaskRow::ALL.map(|row| (row.name(), row));
        let help = "rows are x y z (linear) and rx ry rz (angular), in the base frame";
        let rows =
            items.iter().filter_map(|item| self.choice(item, item.span, "a row of `task`", &words, Code::UnknownTaskRow, help));
        Some(Spanned::new(rows.collect(), key))
    }

    fn inverse_kinematics(&mut self, node: &Node, key: Span) -> Option<PosturesDescription> {
        let fields = self.mapping(node, "`inverse_kinematics`", key, INVERSE_KINEMATICS)?;
        let help = "`pose`: of the end effector; `position`: of its origin; `planar`: the rows of `task`, one of them angular; \
                    `pointing`: its position and the direction of its z axis";
        let target =
            fields.get("target").and_then(|(key, node)| self.choice(node, key, "target", &TARGETS, Code::UnknownTarget, help));
        let given = fields.get("given").and_then(|(key, node)| self.word(node, key, "given"));
        Some(PosturesDescription { target, given })
    }

    /// End effectors with names. The keys of a single end effector are in each of them, and not beside them.
    fn tips(&mut self, node: &Node, key: Span, beside: &Fields<'_>) -> Option<Spanned<Vec<TipDescription>>> {
        for name in ["tip", "tool", "payload", "task", "inverse_kinematics"] {
            if beside.has(name) {
                let message = format!("`{name}` stands beside `tips`");
                let help = match name {
                    "tip" => "give each end effector its `joint`, and leave `tip` out".to_owned(),
                    _ => format!("move `{name}` into the end effector that it is of"),
                };
                self.report(Code::TipsBesideTool, beside.place(name), message, "of which end effector?", help);
            }
        }
        let items = self.list(node, key, "tips", "a list", "write one `- {name: ..., joint: ...}` per end effector")?;
        if items.is_empty() {
            let help = "name an end effector, `- {name: hand, joint: ...}`, or leave the key out";
            self.report(Code::EmptyList, node.span, "`tips` names no end effector", "empty", help);
            return None;
        }
        if let Some(item) = items.get(MAX_TIPS) {
            let message = format!("{} end effectors are more than the {MAX_TIPS} of a robot", items.len());
            let help = "leave out those whose frames no program asks for: `link_frames` has a frame of each link";
            self.report(Code::TooManyTips, item.span, message, format!("end effector {}", MAX_TIPS + 1), help);
            return None;
        }
        let tips: Vec<TipDescription> = items.iter().filter_map(|item| self.tip(item)).collect();
        (!tips.is_empty()).then(|| Spanned::new(tips, key))
    }

    fn tip(&mut self, node: &Node) -> Option<TipDescription> {
        let fields = self.mapping(node, "an end effector", first_key(node), TIP)?;
        Some(TipDescription {
            name: fields.get("name").and_then(|(key, node)| self.word(node, key, "name")),
            joint: fields.get("joint").and_then(|(key, node)| self.word(node, key, "joint")),
            tool: fields.get("tool").and_then(|(key, node)| self.pose(node, key, "tool")),
            payload: fields.get("payload").and_then(|(key, node)| self.body(node, key, "`payload`", PAYLOAD)),
            task: fields.get("task").and_then(|(key, node)| self.task(node, key)),
            inverse_kinematics: fields
                .get("inverse_kinematics")
                .and_then(|(key, node)| self.inverse_kinematics(node, key))
                .unwrap_or_default(),
        })
    }

    fn closes(&mut self, node: &Node, key: Span) -> Vec<ClosureDescription> {
        let help = "write one `- {joint: rod, at: [0, 0, 1], with: forearm, there: [-0.4, 0, 0]}` per pin";
        let items = self.list(node, key, "closes", "a list", help).unwrap_or_default();
        let mut read = |item: &Node| {
            let span = first_key(item);
            let fields = self.mapping(item, "a point of `closes`", span, CLOSURE)?;
            let mut word = |name: &str| fields.get(name).and_then(|(key, node)| self.word(node, key, name));
            let [joint, with] = ["joint", "with"].map(&mut word);
            let mut point = |name: &str| fields.get(name).and_then(|(key, node)| self.vector(node, key, name, ["x", "y", "z"]));
            let [at, there] = ["at", "there"].map(&mut point);
            let name = fields.get("name").and_then(|(key, node)| self.text(node, key, "name", "a name", "write a few words"));
            Some(ClosureDescription { name, joint, at, with, there, span })
        };
        items.iter().filter_map(&mut read).collect()
    }

    fn allow(&mut self, node: &Node, key: Span) -> Vec<Spanned<String>> {
        let help = "write kinds of warnings in brackets, and why beside it: `allow: [implausible-reach]   # a crane`";
        let items = self.list(node, key, "allow", "a list", help).unwrap_or_default();
        items.iter().filter_map(|item| self.word(item, item.span, "an element of `allow`")).collect()
    }

    fn regressor(&mut self, node: &Node, key: Span) -> Option<Spanned<RegressorDescription>> {
        let help = "write `standard`, `base`, or a list of names: `regressor: [m1, m2]`";
        match &node.kind {
            Kind::Scalar(s) if s.text == REGRESSORS[0] => Some(Spanned::new(RegressorDescription::Standard, key)),
            Kind::Scalar(s) if s.text == REGRESSORS[1] => Some(Spanned::new(RegressorDescription::Base, key)),
            Kind::List(items) if items.is_empty() => {
                let help = "list names of `parameters`, or leave the key out for `standard`";
                self.report(Code::EmptyList, node.span, "`regressor` names no parameter", "empty", help);
                None
            }
            Kind::List(items) => {
                let names = items.iter().filter_map(|item| self.word(item, item.span, "an element of `regressor`")).collect();
                Some(Spanned::new(RegressorDescription::Names(names), key))
            }
            _ => {
                self.wrong_kind(node, key, "regressor", "`standard`, `base` or a list of names", help);
                None
            }
        }
    }

    fn field(&mut self, fields: &Fields<'_>, name: &str) -> Value {
        let (key, node) = fields.get(name)?;
        self.value(node, key, name)
    }

    fn value(&mut self, node: &Node, key: Span, name: &str) -> Option<Expression> {
        self.expression(node, key, name, "write for instance `0.5`, `pi/2` or the name of a parameter")
    }

    /// A list of exactly as many numbers as there are `parts`.
    fn vector<const N: usize>(&mut self, node: &Node, key: Span, name: &str, parts: [&str; N]) -> Option<Spanned<[Value; N]>> {
        // A copied example must be valid, and must not switch gravity off.
        let example = match (name, N) {
            ("gravity" | "argument", _) => "0, 0, -9.81".to_owned(),
            ("axis", _) => "0, 0, 1".to_owned(),
            ("quat", _) => "1, 0, 0, 0".to_owned(),
            ("xyaxes", _) => "1, 0, 0, 0, 1, 0".to_owned(),
            (_, 2) => "-1, 1".to_owned(),
            _ => ["0"; N].join(", "),
        };
        let help = format!("write {N} values in brackets, {}: `{name}: [{example}]`", parts.join(", "));
        let items = self.list(node, key, name, &format!("a list of {N} values"), &help)?;
        let values: Vec<Value> =
            items.iter().map(|item| self.value(item, item.span, &format!("an element of `{name}`"))).collect();
        let found = values.len();
        match <[Value; N]>::try_from(values) {
            Ok(values) => Some(Spanned::new(values, node.span)),
            Err(_) => {
                let message = format!("`{name}` takes {N} values, found {found}");
                let whole = |item: &Node| matches!(&item.kind, Kind::Scalar(s) if s.text.trim_start_matches('-').bytes().all(|b| b.is_ascii_digit()));
                let help = match found > N && items.windows(2).any(|pair| pair.iter().all(whole)) {
                    true => format!("decimals have a point, and no comma: `0.5`; {help}"),
                    false => help,
                };
                self.report(Code::WrongLength, node.span, message, format!("{found} instead of {N}"), help);
                None
            }
        }
    }

    fn word(&mut self, node: &Node, key: Span, name: &str) -> Option<Spanned<String>> {
        self.text(node, key, name, "a name", "write one word: a letter, then letters, digits and `_`")
    }
}
