//! Elements that a description of a serial arm cannot hold: refused if they would change the motion, otherwise counted.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Span;
use roxmltree::Node;

use super::classes::Element;
use super::{equalities, sections, Mjcf, SAVE_COMPILED};
use crate::format::Extent;
use crate::values::Values;
use crate::xml::{attribute, place, shown};
use crate::Code;

/// Reports a part that is not taken.
pub(super) fn refuse(span: Span, message: String, help: &str, diagnostics: &mut Diagnostics) {
    diagnostics.push(Diagnostic::new(Code::MjcfFeature, span, message, "", help));
}

/// Elements that stand for others.
pub(super) fn refuse_macros(root: Node<'_, '_>, diagnostics: &mut Diagnostics) {
    const MACROS: [&str; 5] = ["include", "replicate", "attach", "composite", "flexcomp"];
    for node in root.descendants().filter(|n| n.is_element() && n.parent_element().is_some()) {
        let name = node.tag_name().name();
        let within_body = || node.parent_element().is_some_and(|outer| outer.tag_name().name() == "body");
        if MACROS.contains(&name) || (name == "plugin" && within_body()) {
            refuse(place(node), format!("`{name}` stands for what is not written out"), SAVE_COMPILED, diagnostics);
        }
    }
}

/// Settings of the compiler that change the bodies of the file.
pub(super) fn refuse_changed_inertias(compiler: Node<'_, '_>, diagnostics: &mut Diagnostics) {
    let positive = |text: &str| text.trim().parse::<f64>().is_ok_and(|value| value > 0.0);
    for (name, is_set) in [
        ("coordinate", attribute(compiler, "coordinate").is_some_and(|(word, _)| word == "global")),
        ("boundmass", attribute(compiler, "boundmass").is_some_and(|(word, _)| positive(word))),
        ("boundinertia", attribute(compiler, "boundinertia").is_some_and(|(word, _)| positive(word))),
        ("settotalmass", attribute(compiler, "settotalmass").is_some_and(|(word, _)| positive(word))),
    ] {
        if let (true, Some((word, span))) = (is_set, attribute(compiler, name)) {
            let message = format!("with `{name}=\"{}\"` the bodies are not what the file says of them", shown(word));
            refuse(span, message, SAVE_COMPILED, diagnostics);
        }
    }
}

/// Forces that `flag` switches off.
#[derive(Clone, Copy, Default)]
pub(super) struct Disabled {
    pub(super) gravity: bool,
    pub(super) spring: bool,
    pub(super) damper: bool,
    pub(super) friction: bool,
    pub(super) equality: bool,
}

/// The effects that the flags of a model switch off; the last of several equal flags holds. Constraints are friction losses and equalities, too.
pub(super) fn disabled(root: Node<'_, '_>, diagnostics: &mut Diagnostics) -> Disabled {
    let mut off: BTreeMap<&str, bool> = BTreeMap::new();
    let flags = sections(root, "option").flat_map(|option| option.children()).filter(|node| node.has_tag_name("flag"));
    for attribute in flags.flat_map(|flag| flag.attributes()).filter(|attribute| attribute.namespace().is_none()) {
        match attribute.value() {
            "disable" => _ = off.insert(attribute.name(), true),
            "enable" => _ = off.insert(attribute.name(), false),
            word => {
                let range = attribute.range_value();
                let message = format!("the flag `{}` is `{}`", shown(attribute.name()), shown(word));
                refuse(Span::new(range.start, range.end), message, "write `enable` or `disable`", diagnostics);
            }
        }
    }
    let is_off = |names: &[&str]| names.iter().any(|name| off.get(name) == Some(&true));
    Disabled {
        gravity: is_off(&["gravity"]),
        // Versions before 3.3.6 have one flag for springs and dampers.
        spring: is_off(&["spring", "passive"]),
        damper: is_off(&["damper", "passive"]),
        friction: is_off(&["frictionloss", "constraint"]),
        equality: is_off(&["equality", "constraint"]),
    }
}

/// A line for each force of joints that the file gives and its flags switch off.
pub(super) fn switched_off<'a, 'i>(mjcf: &Mjcf<'a, 'i>, joints: &[(&str, Element<'a, 'i>)]) -> Vec<String> {
    let off = mjcf.disabled;
    let all: [(bool, &str, &[&str]); 3] = [
        (off.spring, "springs", &["stiffness", "springdamper"]),
        (off.damper, "damping", &["damping", "springdamper"]),
        (off.friction, "friction losses", &["frictionloss"]),
    ];
    let line = |(_, what, names): (bool, &str, &[&str])| {
        let of = |&(joint, element): &(&str, Element<'a, 'i>)| {
            let given = names.iter().filter(|name| mjcf.is_given(element, name));
            let values = given.filter_map(|name| Some(format!("`{name}` {}", shown(mjcf.classes.attribute(element, name)?.0))));
            let values: Vec<String> = values.collect();
            (!values.is_empty()).then(|| format!("{} of `{}`", values.join(", "), shown(joint)))
        };
        let joints: Vec<String> = joints.iter().filter_map(of).collect();
        (!joints.is_empty()).then(|| format!("`flag` switches {what} off, which are left out: {}", joints.join(", ")))
    };
    all.into_iter().filter(|(off, ..)| *off).filter_map(line).collect()
}

/// Springs and damping that are not linear.
pub(super) fn refuse_springs<'a, 'i>(mjcf: &Mjcf<'a, 'i>, joint: Element<'a, 'i>, values: &mut Values<'_>) {
    for name in ["stiffness", "springdamper"] {
        if mjcf.disabled.spring && (name == "stiffness" || mjcf.disabled.damper) {
            continue;
        }
        let Some((text, span)) = mjcf.classes.attribute(joint, name) else { continue };
        let numbers = values.words(text, span, name);
        // One stiffness is the description's.
        if name == "stiffness" && numbers.len() == 1 {
            continue;
        }
        if numbers.iter().any(|number| !number.is_zero()) {
            let help = "a spring of a description has one stiffness and a rest: write `stiffness` and `springref`";
            let message = format!("a joint of the chain has `{name}`");
            values.report(Code::MjcfFeature, span, message, "a spring", help);
        }
    }
    let damping = mjcf.classes.attribute(joint, "damping").filter(|_| !mjcf.disabled.damper);
    if let Some((text, span)) = damping.filter(|(text, _)| text.split_ascii_whitespace().count() > 1) {
        let message = format!("the damping of a joint of the chain is `{}`, a polynomial of its rate", shown(text));
        values.report(Code::MjcfFeature, span, message, "", "give one number: the torque is that times the rate");
    }
}

/// Bodies with compensated gravity, and bodies that a motion capture places.
pub(super) fn refuse_compensation(body: Node<'_, '_>, values: &mut Values<'_>) {
    if let Some((text, span)) = attribute(body, "gravcomp").filter(|(text, _)| text.trim().parse::<f64>() != Ok(0.0)) {
        let message = format!("gravity is compensated at a body of the arm: `gravcomp` is {}", shown(text));
        let help = "take it out: `gravity` is then what the arm feels, and the compensation is up to the controller";
        values.report(Code::MjcfFeature, span, message, "", help);
    }
    if let Some((_, span)) = attribute(body, "mocap").filter(|(word, _)| *word == "true") {
        values.report(Code::MjcfFeature, span, "a body of the arm is put where a motion capture says", "", "take `mocap` out");
    }
}

/// Refuses elements that couple the joints of the arm with each other or with the world, or that change its motion.
pub(super) fn check(mjcf: &Mjcf<'_, '_>, extent: &Extent<'_>, diagnostics: &mut Diagnostics) {
    let root = mjcf.root;
    let moves = |name: &str| extent.tree.joint(name).is_some_and(|joint| extent.moving.contains(&joint));
    let carrier = |link: Option<usize>| link.and_then(|link| extent.carriers.get(&link).copied());
    equalities::refuse_switches(mjcf, diagnostics);
    for equality in equalities::in_force(mjcf) {
        if equalities::is_taken(mjcf, equality, extent.tree) {
            continue;
        }
        let body = |name: &str| carrier(equality.attribute(name).and_then(|name| extent.tree.link(name)));
        let site = |name: &str| carrier(equality.attribute(name).and_then(|name| mjcf.sites.get(name).copied()));
        let joints = ["joint1", "joint2"].into_iter().filter_map(|name| equality.attribute(name)).any(moves);
        let follower = equality.attribute("joint1").and_then(|name| extent.tree.joint(name));
        if joints && equality.has_tag_name("joint") && follower.is_some_and(|follower| extent.held.contains(&follower)) {
            equalities::warn_of_held(equality, diagnostics);
        } else if joints || body("body1") != body("body2") || site("site1") != site("site2") {
            equalities::refuse(mjcf, equality, extent.tree, diagnostics);
        }
    }
    for tendon in sections(root, "tendon").flat_map(|n| n.children()).filter(Node::is_element) {
        let along = |name: &'static str| tendon.children().filter_map(move |part| part.attribute(name));
        let mut ends = along("site").map(|name| carrier(mjcf.sites.get(name).copied()));
        let first = ends.next();
        if along("joint").any(moves) || ends.any(|end| Some(end) != first) {
            let help = "take it out, or hold what it is about with `--lock JOINT=VALUE`";
            refuse(place(tendon), "a tendon concerns the arm".into(), help, diagnostics);
        }
    }
    for actuator in sections(root, "actuator").flat_map(|n| n.children()).filter(Node::is_element) {
        if !["joint", "jointinparent"].into_iter().filter_map(|name| actuator.attribute(name)).any(moves) {
            continue;
        }
        for name in ["gear", "armature", "damping"] {
            let Some((text, span)) = attribute(actuator, name) else { continue };
            let first = text.split_ascii_whitespace().next().and_then(|word| word.parse::<f64>().ok());
            if first == Some(if name == "gear" { 1.0 } else { 0.0 }) {
                continue;
            }
            let message = format!("an actuator of the arm has `{name}=\"{}\"`; actuators are left out", shown(text));
            let help = "torques here are those at the joint; a rotor's inertia is `armature` of the joint";
            diagnostics.push(Diagnostic::new(Code::ChangesMotion, span, message, "left out", help));
        }
    }
    for option in sections(root, "option") {
        for name in ["density", "viscosity", "wind"] {
            let Some((text, span)) = attribute(option, name) else { continue };
            if text.split_ascii_whitespace().any(|word| word.parse::<f64>() != Ok(0.0)) {
                let message = format!("`{name}` is `{}`: the air's forces are left out", shown(text));
                let help = "the equations are those of rigid bodies in a vacuum";
                diagnostics.push(Diagnostic::new(Code::ChangesMotion, span, message, "left out", help));
            }
        }
    }
}

/// Counts of elements by their kind, or by their section; so many equalities are taken.
pub(super) fn left_out(root: Node<'_, '_>, equalities: usize) -> BTreeMap<String, usize> {
    const READ: [&str; 4] = ["compiler", "option", "default", "worldbody"];
    const TAKEN: [&str; 6] = ["body", "frame", "joint", "freejoint", "inertial", "site"];
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for section in root.children().filter(|n| n.is_element() && !READ.contains(&n.tag_name().name())) {
        let inside = section.children().filter(Node::is_element).count();
        *counts.entry(section.tag_name().name().to_owned()).or_default() += inside.max(1);
    }
    if let Some(count) = counts.get_mut("equality") {
        *count -= equalities.min(*count);
    }
    counts.retain(|_, count| *count > 0);
    for world in sections(root, "worldbody") {
        for node in world.descendants().skip(1).filter(Node::is_element) {
            let name = node.tag_name().name();
            let outer = node.parent_element().map_or("", |outer| outer.tag_name().name());
            if !TAKEN.contains(&name) && matches!(outer, "body" | "frame" | "worldbody") {
                *counts.entry(name.to_owned()).or_default() += 1;
            }
        }
    }
    counts
}
