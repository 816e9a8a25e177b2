//! Words and shapes that other formats have for what is written otherwise here: URDF, SDF, the Robotics Toolbox (RTB), MuJoCo.

use super::Convention;
use crate::diagnostic::Code;
use crate::document::excerpt;
use crate::document::reader::{Fields, Reader};
use crate::document::yaml::{Kind, Node};
use crate::source::Spanned;

/// Keys of other formats, and the keys of this format with the same meaning in the same place.
pub(super) const OTHER_NAMES: &[(&str, &str)] = &[
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
    ("G", "ratio"),
    ("Jm", "inertia"),
    ("load", "payload"),
    ("torque", "effort"),
    ("damping", "viscous"),
    ("B", "viscous"),
    ("Fv", "viscous"),
    ("Tc", "coulomb"),
    ("Fc", "coulomb"),
    ("frictionloss", "coulomb"),
    ("springref", "rest"),
    ("friction", "coulomb"),
    ("inertial", "link"),
    ("I", "inertia"),
    ("qlim", "position"),
    ("range", "position"),
    ("ee", "tool"),
    ("end_effector", "tool"),
    ("world", "base"),
];

const MOTOR: &str = "the rotor stands in a mapping of its own: `motor: {ratio: ..., inertia: ...}`";
const FRICTION: &str = "friction stands in a mapping of its own: `friction: {viscous: ..., coulomb: ...}`";
const LINK: &str =
    "the body stands in a mapping of its own: `link: {mass: ..., com: [x, y, z], inertia: {xx: ..., yy: ..., zz: ...}}`";
const LIMITS: &str =
    "limits stand in a mapping of their own: `limits: {position: [lowest, highest], velocity: ..., effort: ...}`";
const POSITION: &str = "write both limits in one list: `position: [lowest, highest]`";
const FRAMES: &str =
    "the convention `urdf` has `origin` and `axis`; `a`, `alpha`, `d`, `theta` belong to `standard` and `modified`";
const POSE: &str =
    "a pose has no mass: what is fixed to a link is one of the bodies below its `attached`, what the end effector carries is `payload`";
const ROW: &str = "rows of Denavit and Hartenberg have `a`, `alpha`, `d`, `theta`; frames of a URDF, `origin` and `axis`, belong to `convention: urdf`";

/// Keys of other formats, a key that is known where they are out of place, and what to write instead.
pub(super) const OTHER_PLACES: &[(&str, &str, &str)] = &[
    ("dynamics", "friction", "URDF's `dynamics: {damping, friction}` is `friction: {viscous: ..., coulomb: ...}` here"),
    ("damping", "friction", FRICTION),
    ("viscous", "friction", FRICTION),
    ("coulomb", "friction", FRICTION),
    ("frictionloss", "friction", FRICTION),
    ("B", "motor", "RTB's `B` is friction at the rotor: `motor: {ratio: ..., viscous: ...}`"),
    ("Tc", "friction", "RTB's `Tc` is Coulomb friction at the rotor; times the ratio it is `friction: {coulomb: ...}`"),
    ("Jm", "motor", MOTOR),
    ("G", "motor", MOTOR),
    ("gear", "motor", MOTOR),
    ("ratio", "motor", MOTOR),
    ("mass", "link", LINK),
    ("com", "link", LINK),
    ("inertia", "link", LINK),
    ("I", "link", LINK),
    ("qlim", "limits", "RTB's `qlim` is `limits: {position: ...}` here"),
    ("limit", "limits", LIMITS),
    ("range", "limits", LIMITS),
    ("position", "limits", LIMITS),
    ("velocity", "limits", LIMITS),
    ("effort", "limits", LIMITS),
    ("lower", "limits", LIMITS),
    ("upper", "limits", LIMITS),
    ("lower", "effort", POSITION),
    ("upper", "effort", POSITION),
    ("origin", "theta", ROW),
    ("axis", "theta", ROW),
    ("stiffness", "spring", "a spring stands in a mapping of its own: `spring: {stiffness: ..., rest: ...}`"),
    ("springref", "spring", "MuJoCo's `springref` is `spring: {stiffness: ..., rest: ...}` here"),
    ("mimic", "follows", "a joint that mimics another one is written `follows: {LEADER: MULTIPLIER}`, and `offset`"),
    ("sigma", "type", "RTB's `sigma` is `type: revolute` (0) or `type: prismatic` (1)"),
    ("child", "type", "a joint moves its own `link`; where that branches off, `parent` names the joint that carries it"),
    ("a", "origin", FRAMES),
    ("alpha", "origin", FRAMES),
    ("d", "origin", FRAMES),
    ("theta", "origin", FRAMES),
    ("mass", "xyz", POSE),
    ("com", "xyz", POSE),
    ("inertia", "xyz", POSE),
    (
        "origin",
        "com",
        "URDF's `origin` of an inertial is `com: [x, y, z]`, and its `rpy` stands beside the elements of `inertia`",
    ),
    ("rpy", "com", "the axes of the tensor stand beside its elements: `inertia: {xx: ..., rpy: [r, p, y]}`"),
];

/// The row and the column of each element of a tensor in a list of nine.
const ELEMENTS: [(&str, usize, usize); 6] = [("xx", 0, 0), ("yy", 1, 1), ("zz", 2, 2), ("xy", 0, 1), ("xz", 0, 2), ("yz", 1, 2)];

/// The keys of a row of Denavit and Hartenberg.
const OF_ROWS: [&str; 4] = ["a", "alpha", "d", "theta"];

impl Reader<'_> {
    /// Whether the convention is `urdf` and the joints have rows of Denavit and Hartenberg alone, which is reported once.
    pub(super) fn rows_of_another_convention(&mut self, convention: &Spanned<Convention>, fields: &Fields<'_>) -> bool {
        let Some((_, Node { kind: Kind::List(joints), .. })) = fields.get("joints") else { return false };
        let has = |joint: &Node, names: &[&str]| match &joint.kind {
            Kind::Mapping(entries) => entries.iter().any(|(key, _)| names.contains(&key.value.as_str())),
            _ => false,
        };
        let rows = joints.iter().filter(|joint| has(joint, &OF_ROWS)).count();
        if convention.value != Convention::Urdf || rows == 0 || joints.iter().any(|joint| has(joint, &["origin", "axis"])) {
            return false;
        }
        let message = "`convention` is `urdf`, and the joints have rows of Denavit and Hartenberg";
        let help = "write `convention: standard` or `convention: modified`, as the table says; with `urdf` each joint has `origin` and `axis` instead of `a`, `alpha`, `d`, `theta`";
        self.report(Code::UnknownConvention, convention.span, message, "its joints have other keys", help);
        true
    }

    /// Whether a pose is written as numbers without names, which is reported.
    pub(super) fn pose_as_numbers(&mut self, node: &Node, items: &[Node], name: &str) -> bool {
        let texts: Option<Vec<&str>> = items
            .iter()
            .map(|item| if let Kind::Scalar(scalar) = &item.kind { Some(scalar.text.as_str()) } else { None })
            .collect();
        let Some(numbers) = texts.filter(|numbers| !numbers.is_empty()) else {
            return false;
        };
        let (xyz, rest) = numbers.split_at(numbers.len().min(3));
        let xyz = format!("xyz: [{}]", xyz.join(", "));
        let help = match (numbers.len(), rest) {
            _ if numbers.iter().any(|number| excerpt(number) != *number) => {
                format!("write `{name}: {{xyz: [0, 0, 0.1], rpy: [0, pi/2, 0]}}`")
            }
            (3, _) => format!("write `{name}: {{{xyz}}}`"),
            (6, rpy) => format!(
                "write `{name}: {{{xyz}, rpy: [{}]}}`, if the last three are angles about fixed x, y and z",
                rpy.join(", ")
            ),
            _ => format!("write `{name}: {{xyz: [0, 0, 0.1], rpy: [0, pi/2, 0]}}`"),
        };
        let message = format!("`{name}` is a list of numbers; those of a pose have names");
        self.report(Code::WrongKind, node.span, message, "not `key: value`", help);
        true
    }

    /// Whether a tensor is written as a list, which is reported with the mapping that it would be.
    pub(super) fn tensor_as_list(&mut self, node: &Node) -> bool {
        let Kind::List(items) = &node.kind else { return false };
        let rows: Vec<&[Node]> =
            items.iter().map(|item| if let Kind::List(row) = &item.kind { row.as_slice() } else { &[] }).collect();
        let texts = |nodes: &[Node]| -> Option<Vec<String>> {
            let text = |node: &Node| if let Kind::Scalar(scalar) = &node.kind { Some(scalar.text.clone()) } else { None };
            nodes.iter().map(text).collect()
        };
        let flat = match rows.iter().map(|row| texts(row)).collect::<Option<Vec<_>>>() {
            Some(rows) if rows.iter().any(|row| !row.is_empty()) => rows.concat(),
            _ => texts(items).unwrap_or_default(),
        };
        let mut message = "`inertia` is a list; its elements have names here".to_owned();
        let mut either = "";
        let help = match &flat[..] {
            nine if nine.len() == 9 => {
                let at = |i: usize, j: usize| nine[3 * i + j].as_str();
                let unsymmetric = ELEMENTS.iter().find(|(_, i, j)| !same(at(*i, *j), at(*j, *i)));
                if let Some((name, i, j)) = unsymmetric {
                    let mirrored: String = name.chars().rev().collect();
                    message = format!(
                        "the tensor is not symmetric: {name} is {}, {mirrored} is {}",
                        excerpt(at(*i, *j)),
                        excerpt(at(*j, *i))
                    );
                    either = "the two are one element; see which of them is right, and ";
                }
                let elements: Vec<(&str, &str)> = ELEMENTS.iter().map(|(name, i, j)| (*name, at(*i, *j))).collect();
                format!("{either}write `inertia: {}`", mapping(&elements))
            }
            six if six.len() == 6 => {
                let order = |names: [&'static str; 6]| {
                    mapping(&names.iter().copied().zip(six.iter().map(String::as_str)).collect::<Vec<_>>())
                };
                format!(
                    "six numbers do not say in which order they are: as [xx, yy, zz, xy, yz, xz] of RTB write `inertia: {}`, as [xx, xy, xz, yy, yz, zz] of a URDF `inertia: {}`",
                    order(["xx", "yy", "zz", "xy", "yz", "xz"]),
                    order(["xx", "xy", "xz", "yy", "yz", "zz"])
                )
            }
            [xx, yy, zz] => format!("write `inertia: {}`", mapping(&[("xx", xx), ("yy", yy), ("zz", zz)])),
            _ => "write its elements by name: `inertia: {xx: 0.01, yy: 0.02, zz: 0.015, xy: 0}`".to_owned(),
        };
        self.report(Code::WrongKind, node.span, message, "not `key: value`", help);
        true
    }
}

/// Elements by name, without zeros.
fn mapping(elements: &[(&str, &str)]) -> String {
    let kept = elements.iter().filter(|(_, text)| text.parse() != Ok(0.0));
    // A shortened text cannot be copied.
    let is_short = elements.iter().all(|(_, text)| excerpt(text) == *text);
    let entries: Vec<String> = kept.map(|(name, text)| format!("{name}: {}", if is_short { text } else { "..." })).collect();
    format!("{{{}}}", entries.join(", "))
}

/// Whether two texts are the same number, or the same text.
fn same(a: &str, b: &str) -> bool {
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a.trim() == b.trim(),
    }
}
