//! Tree of nodes -> [`RobotDescription`]: which keys there are, and what kind of value stands under each.

use super::expression;
use super::yaml::{Kind, Node};
use super::{
    did_you_mean, excerpt, BodyDescription, Convention, Expression, FrictionDescription, InertiaDescription, JointDescription,
    LimitsDescription, MotorDescription, ParameterDescription, RegressorDescription, RobotDescription, ToolDescription, Value,
    INERTIA_ELEMENTS,
};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::manipulator::{JointKind, TaskRow};
use crate::source::{Source, Span, Spanned};

/// A key that a mapping may hold.
struct Key {
    name: &'static str,
    required: bool,
    /// How it is written, for the help where it is missing.
    example: &'static str,
}

const fn required(name: &'static str, example: &'static str) -> Key {
    Key { name, required: true, example }
}

const fn optional(name: &'static str) -> Key {
    Key { name, required: false, example: "" }
}

const ROBOT: &[Key] = &[
    required("name", "name: my_robot"),
    required("convention", "convention: standard"),
    required("gravity", "gravity: [0, 0, -9.81]"),
    optional("parameters"),
    required("joints", "joints:` and below it one `- name: ..."),
    optional("tool"),
    optional("payload"),
    optional("task"),
    optional("regressor"),
];
const JOINT: &[Key] = &[
    required("name", "name: shoulder"),
    required("type", "type: revolute"),
    required("a", "a: 0.5"),
    required("alpha", "alpha: pi/2"),
    required("d", "d: 0"),
    required("theta", "theta: 0"),
    optional("limits"),
    required("link", "link: {mass: 5}"),
    optional("motor"),
    optional("friction"),
];
const LIMITS: &[Key] = &[optional("position"), optional("velocity"), optional("effort")];
const LINK: &[Key] = &[required("mass", "mass: 5"), optional("com"), optional("inertia")];
const PAYLOAD: &[Key] = &[optional("mass"), optional("com"), optional("inertia")];
const INERTIA: &[Key] = &[optional("xx"), optional("yy"), optional("zz"), optional("xy"), optional("xz"), optional("yz")];
const MOTOR: &[Key] =
    &[optional("ratio"), optional("inertia"), optional("mass"), optional("position"), optional("axis"), optional("viscous")];
const FRICTION: &[Key] = &[optional("viscous"), optional("coulomb")];
const TOOL: &[Key] = &[optional("xyz"), optional("rpy")];

/// Keys that other formats use for what has another name here.
const OTHER_NAMES: &[(&str, &str)] = &[
    ("m", "mass"),
    ("r", "a"),
    ("centre_of_mass", "com"),
    ("center_of_mass", "com"),
    ("cog", "com"),
    ("kind", "type"),
    ("joint_type", "type"),
    ("links", "joints"),
    ("g", "gravity"),
    ("dh", "convention"),
    ("gear", "ratio"),
    ("gear_ratio", "ratio"),
    ("load", "payload"),
    ("torque", "effort"),
    ("lower", "position"),
    ("upper", "position"),
];

/// The keys of one mapping that are known, with their places and values.
struct Fields<'n> {
    entries: Vec<(&'static str, Span, &'n Node)>,
}

impl<'n> Fields<'n> {
    /// Place of the key and its value.
    fn get(&self, name: &str) -> Option<(Span, &'n Node)> {
        self.entries.iter().find(|(known, ..)| *known == name).map(|(_, span, node)| (*span, *node))
    }
}

/// The description that the tree holds.
pub(super) fn read(source: &Source, root: Option<&Node>, diagnostics: &mut Diagnostics) -> Option<RobotDescription> {
    let mut reader = Reader { diagnostics };
    let help = "begin with `name: my_robot`, `convention: standard`, `gravity: [0, 0, -9.81]` and `joints:`";
    let Some(root) = root.filter(|node| !matches!(&node.kind, Kind::Scalar(s) if s.is_nothing())) else {
        if !reader.diagnostics.has_errors() {
            let label = if source.text().trim().is_empty() { "" } else { "no key stands here" };
            reader.report(Code::EmptyFile, Span::new(0, 0), "the file describes nothing", label, help);
        }
        return None;
    };
    if !matches!(root.kind, Kind::Mapping(_)) {
        let message = format!("a description is a mapping of keys to values, found {}", root.describe());
        reader.report(Code::WrongKind, root.span, message, "not `key: value`", help);
        return None;
    }
    Some(reader.robot(root))
}

struct Reader<'a> {
    diagnostics: &'a mut Diagnostics,
}

impl Reader<'_> {
    fn report(&mut self, code: Code, span: Span, message: impl Into<String>, label: impl Into<String>, help: impl Into<String>) {
        self.diagnostics.push(Diagnostic::new(code, span, message, label, help));
    }

    fn robot(&mut self, root: &Node) -> RobotDescription {
        let first = first_key(root);
        let Some(fields) = self.mapping(root, "the description", first, ROBOT) else { return RobotDescription::default() };
        RobotDescription {
            name: fields.get("name").and_then(|(key, node)| self.word(node, key, "name")),
            convention: fields.get("convention").and_then(|(key, node)| {
                let words = [("standard", Convention::Standard), ("modified", Convention::Modified)];
                let help = "`standard`: Rz(theta) Tz(d) Tx(a) Rx(alpha) (Siciliano); `modified`: Rx(alpha) Tx(a) Rz(theta) Tz(d) (Craig, Khalil)";
                self.choice(node, key, "convention", &words, Code::UnknownConvention, help)
            }),
            gravity: fields.get("gravity").and_then(|(key, node)| self.vector(node, key, "gravity", ["x", "y", "z"])),
            parameters: fields.get("parameters").map_or_else(Vec::new, |(key, node)| self.parameters(node, key)),
            joints: fields.get("joints").and_then(|(key, node)| self.joints(node, key)),
            tool: fields.get("tool").and_then(|(key, node)| {
                let fields = self.mapping(node, "`tool`", key, TOOL)?;
                Some(ToolDescription {
                    xyz: fields.get("xyz").and_then(|(key, node)| self.vector(node, key, "xyz", ["x", "y", "z"])),
                    rpy: fields.get("rpy").and_then(|(key, node)| self.vector(node, key, "rpy", ["about x", "about y", "about z"])),
                })
            }),
            payload: fields.get("payload").and_then(|(key, node)| self.body(node, key, "`payload`", PAYLOAD)),
            task: fields.get("task").and_then(|(key, node)| self.task(node, key)),
            regressor: fields.get("regressor").and_then(|(key, node)| self.regressor(node, key)),
        }
    }

    fn parameters(&mut self, node: &Node, key: Span) -> Vec<ParameterDescription> {
        let Kind::Mapping(entries) = &node.kind else {
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
            value: self.expression(value, name.span, &name.value),
        };
        entries.iter().map(read).collect()
    }

    fn joints(&mut self, node: &Node, key: Span) -> Option<Spanned<Vec<JointDescription>>> {
        let Kind::List(items) = &node.kind else {
            self.wrong_kind(node, key, "joints", "a list", "write one `- name: ...` per joint, from base to tip");
            return None;
        };
        let joints = items.iter().filter_map(|item| self.joint(item)).collect::<Vec<_>>();
        // A joint that is no mapping is reported; the others keep their numbers only in messages.
        Some(Spanned::new(joints, key))
    }

    fn joint(&mut self, node: &Node) -> Option<JointDescription> {
        let span = first_key(node);
        let fields = self.mapping(node, "a joint", span, JOINT)?;
        let name = fields.get("name").and_then(|(key, node)| self.word(node, key, "name"));
        let limits = fields.get("limits").and_then(|(key, node)| self.mapping(node, "`limits`", key, LIMITS));
        let friction = fields.get("friction").and_then(|(key, node)| self.mapping(node, "`friction`", key, FRICTION));
        Some(JointDescription {
            name,
            kind: fields.get("type").and_then(|(key, node)| {
                let words = [("revolute", JointKind::Revolute), ("prismatic", JointKind::Prismatic)];
                let help = "`revolute`: turns about its z axis; `prismatic`: slides along it. Leave a fixed joint out: it is part of its link";
                self.choice(node, key, "type", &words, Code::UnknownJointType, help)
            }),
            a: self.field(&fields, "a"),
            alpha: self.field(&fields, "alpha"),
            d: self.field(&fields, "d"),
            theta: self.field(&fields, "theta"),
            limits: limits.map_or_else(LimitsDescription::default, |fields| LimitsDescription {
                position: fields.get("position").and_then(|(key, node)| self.vector(node, key, "position", ["lowest", "highest"])),
                velocity: self.field(&fields, "velocity"),
                effort: self.field(&fields, "effort"),
            }),
            link: fields.get("link").and_then(|(key, node)| self.body(node, key, "`link`", LINK)),
            motor: fields.get("motor").and_then(|(key, node)| self.motor(node, key)),
            friction: friction.map_or_else(FrictionDescription::default, |fields| FrictionDescription {
                viscous: self.field(&fields, "viscous"),
                coulomb: self.field(&fields, "coulomb"),
            }),
            span,
        })
    }

    fn body(&mut self, node: &Node, key: Span, what: &str, keys: &'static [Key]) -> Option<BodyDescription> {
        let fields = self.mapping(node, what, key, keys)?;
        Some(BodyDescription {
            key,
            mass: self.field(&fields, "mass"),
            com: fields.get("com").and_then(|(key, node)| self.vector(node, key, "com", ["x", "y", "z"])),
            inertia: fields.get("inertia").and_then(|(key, node)| {
                let fields = self.mapping(node, "`inertia`", key, INERTIA)?;
                let elements = INERTIA_ELEMENTS.map(|name| self.field(&fields, name));
                let complete = INERTIA_ELEMENTS.iter().zip(&elements).all(|(name, e)| e.is_some() == fields.get(name).is_some());
                Some(InertiaDescription { key, elements, complete })
            }),
        })
    }

    fn motor(&mut self, node: &Node, key: Span) -> Option<MotorDescription> {
        let fields = self.mapping(node, "`motor`", key, MOTOR)?;
        Some(MotorDescription {
            key,
            ratio: self.field(&fields, "ratio"),
            inertia: self.field(&fields, "inertia"),
            mass: self.field(&fields, "mass"),
            position: fields.get("position").and_then(|(key, node)| self.vector(node, key, "position", ["x", "y", "z"])),
            axis: fields.get("axis").and_then(|(key, node)| self.vector(node, key, "axis", ["x", "y", "z"])),
            viscous: self.field(&fields, "viscous"),
        })
    }

    fn task(&mut self, node: &Node, key: Span) -> Option<Spanned<Vec<Spanned<TaskRow>>>> {
        let Kind::List(items) = &node.kind else {
            self.wrong_kind(node, key, "task", "a list", "write the rows in brackets: `task: [x, y, z]`");
            return None;
        };
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

    fn regressor(&mut self, node: &Node, key: Span) -> Option<Spanned<RegressorDescription>> {
        let help = "write `standard`, `base`, or a list of names: `regressor: [m1, m2]`";
        match &node.kind {
            Kind::Scalar(s) if s.text == "standard" => Some(Spanned::new(RegressorDescription::Standard, key)),
            Kind::Scalar(s) if s.text == "base" => Some(Spanned::new(RegressorDescription::Base, key)),
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

    /// The keys of a mapping; unknown and missing ones are reported, the latter at `at`.
    fn mapping<'n>(&mut self, node: &'n Node, what: &str, at: Span, keys: &'static [Key]) -> Option<Fields<'n>> {
        let names: Vec<&'static str> = keys.iter().map(|key| key.name).collect();
        let Kind::Mapping(entries) = &node.kind else {
            let expected = format!("{what} is a mapping of keys to values, found {}", node.describe());
            let help = format!("keys here: {}", names.join(", "));
            self.report(Code::WrongKind, visible(node, at), expected, "not `key: value`", help);
            return None;
        };
        let mut fields = Fields { entries: Vec::new() };
        let mut unknown = Vec::new();
        for (key, value) in entries {
            match names.iter().find(|name| **name == key.value) {
                Some(name) => fields.entries.push((name, key.span, value)),
                None => unknown.push((key, value)),
            }
        }
        for (key, value) in unknown {
            let absent: Vec<&'static str> = names.iter().copied().filter(|name| fields.get(name).is_none()).collect();
            let other =
                OTHER_NAMES.iter().find(|(other, name)| *other == key.value && names.contains(name)).map(|(_, name)| *name);
            let meant = other.or_else(|| did_you_mean(&key.value, &absent)).or_else(|| did_you_mean(&key.value, &names));
            let found = excerpt(&key.value);
            let allowed = format!("keys here: {}", names.join(", "));
            let help = match meant {
                _ if key.value == "<<" => "merge keys are not supported: write the values out".to_owned(),
                Some(meant) => format!("did you mean `{meant}`? {allowed}"),
                None => allowed,
            };
            self.report(Code::UnknownKey, key.span, format!("{what} has no key `{found}`"), "unknown key", help);
            // Read it as what was meant, so that its value is checked and the other key is not called missing.
            if let Some(meant) = meant.filter(|meant| fields.get(meant).is_none()) {
                fields.entries.push((meant, key.span, value));
            }
        }
        let missing: Vec<&Key> = keys.iter().filter(|key| key.required && fields.get(key.name).is_none()).collect();
        if !missing.is_empty() {
            let names: Vec<String> = missing.iter().map(|key| format!("`{}`", key.name)).collect();
            let examples: Vec<String> = missing.iter().map(|key| format!("`{}`", key.example)).collect();
            let message = format!("{what} lacks {}", and(&names));
            self.report(Code::MissingKey, at, message, "required here", format!("write for instance {}", and(&examples)));
        }
        Some(fields)
    }

    fn field(&mut self, fields: &Fields<'_>, name: &str) -> Value {
        let (key, node) = fields.get(name)?;
        self.expression(node, key, name)
    }

    /// A number or an expression.
    fn expression(&mut self, node: &Node, key: Span, name: &str) -> Option<Expression> {
        match &node.kind {
            Kind::Scalar(s) if !s.is_nothing() && !matches!(s.text.as_str(), "true" | "false") => {
                match expression::parse(s, node.span) {
                    Ok(expression) => Some(expression),
                    Err(diagnostic) => {
                        self.diagnostics.push(*diagnostic);
                        None
                    }
                }
            }
            _ => {
                self.wrong_kind(
                    node,
                    key,
                    name,
                    "a number or an expression",
                    "write for instance `0.5`, `pi/2` or the name of a parameter",
                );
                None
            }
        }
    }

    /// A list of exactly as many numbers as there are `parts`.
    fn vector<const N: usize>(&mut self, node: &Node, key: Span, name: &str, parts: [&str; N]) -> Option<Spanned<[Value; N]>> {
        // Whoever copies the help shall have what is valid, and shall not lose gravity.
        let example = match (name, N) {
            ("gravity", _) => "0, 0, -9.81".to_owned(),
            ("axis", _) => "0, 0, 1".to_owned(),
            (_, 2) => "-1, 1".to_owned(),
            _ => ["0"; N].join(", "),
        };
        let help = format!("write {N} values in brackets, {}: `{name}: [{example}]`", parts.join(", "));
        let Kind::List(items) = &node.kind else {
            self.wrong_kind(node, key, name, &format!("a list of {N} values"), &help);
            return None;
        };
        let values: Vec<Value> =
            items.iter().map(|item| self.expression(item, item.span, &format!("an element of `{name}`"))).collect();
        let found = values.len();
        match <[Value; N]>::try_from(values) {
            Ok(values) => Some(Spanned::new(values, node.span)),
            Err(_) => {
                let message = format!("`{name}` takes {N} values, found {found}");
                self.report(Code::WrongLength, node.span, message, format!("{found} instead of {N}"), help);
                None
            }
        }
    }

    /// A text that is no list and no mapping.
    fn word(&mut self, node: &Node, key: Span, name: &str) -> Option<Spanned<String>> {
        match &node.kind {
            Kind::Scalar(s) if !s.is_nothing() => Some(Spanned::new(s.text.clone(), node.span)),
            _ => {
                self.wrong_kind(node, key, name, "a name", "write one word: a letter, then letters, digits and `_`");
                None
            }
        }
    }

    /// One of a few words.
    fn choice<T: Copy>(
        &mut self,
        node: &Node,
        key: Span,
        name: &str,
        words: &[(&'static str, T)],
        code: Code,
        help: &str,
    ) -> Option<Spanned<T>> {
        let found = match &node.kind {
            Kind::Scalar(s) if !s.is_nothing() => s.text.as_str(),
            _ => {
                let names: Vec<String> = words.iter().map(|(word, _)| format!("`{word}`")).collect();
                self.wrong_kind(node, key, name, &format!("one of {}", names.join(", ")), help);
                return None;
            }
        };
        if let Some((_, value)) = words.iter().find(|(word, _)| *word == found) {
            return Some(Spanned::new(*value, node.span));
        }
        let names: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        let meant = did_you_mean(found, &names).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        let message = format!("{} cannot be `{}`", quoted(name), excerpt(found));
        self.report(code, node.span, message, format!("not {}", or(&names)), format!("{meant}{help}"));
        None
    }

    fn wrong_kind(&mut self, node: &Node, key: Span, name: &str, expected: &str, help: &str) {
        let found = match &node.kind {
            Kind::Scalar(s) if !s.is_nothing() => format!("`{}`", excerpt(&s.text)),
            _ => node.describe().to_owned(),
        };
        let message = format!("{} must be {expected}, found {found}", quoted(name));
        self.report(Code::WrongKind, visible(node, key), message, "wrong kind of value", help);
    }
}

/// A key in backquotes; a description ("an element of ...") as it is.
fn quoted(name: &str) -> String {
    if name.contains(' ') {
        name.to_owned()
    } else {
        format!("`{}`", excerpt(name))
    }
}

/// The node's place, or its key's where nothing stands.
fn visible(node: &Node, key: Span) -> Span {
    if node.span.start < node.span.end {
        node.span
    } else {
        key
    }
}

/// The first key of a mapping, or the node itself.
fn first_key(node: &Node) -> Span {
    match &node.kind {
        Kind::Mapping(entries) => entries.first().map_or(node.span, |(key, _)| key.span),
        _ => node.span,
    }
}

fn and(words: &[String]) -> String {
    join(words, "and")
}

fn or(words: &[&str]) -> String {
    join(&words.iter().map(|w| format!("`{w}`")).collect::<Vec<_>>(), "or")
}

fn join(words: &[String], last: &str) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [start @ .., end] => format!("{} {last} {end}", start.join(", ")),
    }
}
