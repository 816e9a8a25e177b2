//! Parts of a URDF that nothing reads, and that would move the arm otherwise: rotors and gears of Drake, springs of Gazebo, scaled inertias.
//!
//! They are known by the words in their names, whatever program they are for.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Span;
use roxmltree::Node;

use crate::format::Extent;
use crate::xml::{place, shown};
use crate::Code;

/// Words of a name that stand for inertia, gears, springs and damping.
const WORDS: [&str; 9] = ["inertia", "ratio", "stiffness", "damping", "damper", "rotor", "spring", "armature", "compliance"];
/// Elements of Gazebo that change links or their weight.
const NAMES: [&str; 4] = ["disableFixedJointLumping", "preserveFixedJoint", "gravity", "turnGravityOff"];
/// Elements in which such words are about something else: looks, contacts, sensors.
const ELSEWHERE: [&str; 6] = ["visual", "collision", "material", "sensor", "surface", "ros2_control"];
/// Elements that are read.
const READ: [&str; 4] = ["inertial", "dynamics", "limit", "mimic"];
/// The most values in a message.
const NAMED: usize = 12;

/// Warns of them where they concern the arm, once for each name, with values.
pub(super) fn warn(root: Node<'_, '_>, extent: &Extent<'_>, diagnostics: &mut Diagnostics) {
    let mut kinds: BTreeMap<String, (Span, Vec<String>)> = BTreeMap::new();
    for part in root.children().filter(Node::is_element) {
        let about = joints_of(part);
        if !about.is_empty() && !about.iter().any(|name| concerns(extent, name)) {
            continue;
        }
        let of = about.first().map_or(String::new(), |name| format!(" (`{}`)", shown(name)));
        let mut open = vec![part];
        while let Some(node) = open.pop() {
            let inside: Vec<Node<'_, '_>> = node.children().filter(|inner| inner.is_element() && !is_skipped(*inner)).collect();
            open.extend(inside.into_iter().rev());
            if is_felt(node.tag_name().name()) {
                let name = node.tag_name().name();
                if let Some(value) = value_of(node).filter(|value| !is_nothing(name, value)) {
                    let found = kinds.entry(written_name(node)).or_insert_with(|| (place(node), Vec::new()));
                    found.1.push(format!("{value}{of}"));
                }
                continue;
            }
            // Attributes without a prefix of elements that are read have a warning of their own.
            let is_read = ["link", "joint", "robot"].contains(&node.tag_name().name());
            for attribute in node.attributes().filter(|found| !(is_read && found.namespace().is_none()) && is_felt(found.name()))
            {
                if !is_nothing(attribute.name(), attribute.value()) {
                    let range = attribute.range_qname();
                    let name = node.document().input_text()[range.clone()].to_owned();
                    let found = kinds.entry(name).or_insert_with(|| (Span::new(range.start, range.end), Vec::new()));
                    found.1.push(format!("{}{of}", shown(attribute.value())));
                }
            }
        }
    }
    for (kind, (span, values)) in kinds {
        let more = values.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let values = values[..values.len().min(NAMED)].join(", ");
        let message = format!("`{}` may change how the arm moves; it is left out: {values}{more}", shown(&kind));
        let help = "in robot.yaml a rotor's inertia times its gear ratio squared is `armature`, a spring is `spring`, damping is `friction: {viscous: ...}` of the joint";
        diagnostics.push(Diagnostic::new(Code::ChangesMotion, span, message, "left out", help));
    }
}

/// The joints or the link that an element on the top is about.
fn joints_of<'a>(part: Node<'a, '_>) -> Vec<&'a str> {
    match part.tag_name().name() {
        "link" | "joint" => part.attribute("name").into_iter().collect(),
        _ => {
            let named = part.descendants().filter(|node| node.is_element() && node.tag_name().name() == "joint");
            let joints = named.filter_map(|node| node.attribute("name").or_else(|| node.text().map(str::trim)));
            part.attribute("reference").into_iter().chain(joints).collect()
        }
    }
}

fn concerns(extent: &Extent<'_>, name: &str) -> bool {
    let joint = extent.tree.joint(name).map(|joint| extent.moving.contains(&joint));
    let link = extent.tree.link(name).map(|link| extent.carriers.contains_key(&link));
    joint == Some(true) || link == Some(true)
}

fn is_skipped(node: Node<'_, '_>) -> bool {
    let name = node.tag_name().name();
    ELSEWHERE.contains(&name) || (READ.contains(&name) && node.tag_name().namespace().is_none() && is_of_joint_or_link(node))
}

fn is_of_joint_or_link(node: Node<'_, '_>) -> bool {
    node.parent_element().is_some_and(|outer| ["link", "joint"].contains(&outer.tag_name().name()))
}

/// Whether a name has one of the words: `gear_ratio`, `springStiffness`. Those of contacts are not about joints.
fn is_felt(name: &str) -> bool {
    let words = words(name);
    let elsewhere = words.iter().any(|word| matches!(word.as_str(), "contact" | "aspect"));
    NAMES.contains(&name) || (!elsewhere && words.iter().any(|word| WORDS.contains(&word.as_str())))
}

/// The words of a name, in lower case.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for c in name.chars() {
        if !c.is_ascii_alphabetic() {
            words.push(String::new());
            continue;
        }
        if c.is_ascii_uppercase() {
            words.push(String::new());
        }
        words.last_mut().expect("there is one").push(c.to_ascii_lowercase());
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The content of an element; `None` if it has only other elements.
fn value_of(node: Node<'_, '_>) -> Option<String> {
    if let Some(value) = node.attribute("value") {
        return Some(shown(value));
    }
    let text = node.text().map(str::trim).filter(|text| !text.is_empty());
    if let Some(text) = text {
        return Some(shown(text));
    }
    let attributes: Vec<String> = node.attributes().map(|found| format!("{} {}", found.name(), shown(found.value()))).collect();
    match attributes.is_empty() {
        true => node.children().all(|inner| !inner.is_element()).then(String::new),
        false => Some(attributes.join(", ")),
    }
}

/// Whether a value leaves the motion as it is: a ratio of 1, anything else of 0.
fn is_nothing(name: &str, value: &str) -> bool {
    let neutral = if words(name).iter().any(|word| word == "ratio") { 1.0 } else { 0.0 };
    !NAMES.contains(&name) && value.trim().parse() == Ok(neutral)
}

/// The name of an element with its prefix.
fn written_name(node: Node<'_, '_>) -> String {
    let rest = &node.document().input_text()[node.range().start + 1..];
    rest[..rest.find(|c: char| c.is_whitespace() || matches!(c, '>' | '/')).unwrap_or(rest.len())].to_owned()
}
