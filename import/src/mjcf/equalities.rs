//! Equalities of two joints, `polycoef` with its first two coefficients: the first joint follows the second one.
//!
//! ```text
//! q1 - ref1 = c0 + c1 (q2 - ref2)
//! ```

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use roxmltree::Node;

use super::{opposite, sections, Mjcf};
use crate::number::Decimal;
use crate::pose::factor;
use crate::tree::Tree;
use crate::values::Values;
use crate::xml::{attribute, place, shown};
use crate::Code;

/// The most coefficients of a polynomial.
const COEFFICIENTS: usize = 5;

/// The element that makes a joint follow another one.
pub(super) struct Equality<'a, 'i> {
    pub(super) node: Node<'a, 'i>,
    pub(super) leader_name: &'a str,
    leader: usize,
}

/// The equalities that the model does not switch off.
pub(super) fn in_force<'m, 'a: 'm, 'i: 'a>(mjcf: &'m Mjcf<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> + 'm {
    let all = sections(mjcf.root, "equality").filter(|_| !mjcf.disabled.equality).flat_map(|section| section.children());
    all.filter(|node| node.is_element() && node.attribute("active") != Some("false"))
}

/// Of each joint that follows another one the first element that makes it do so.
pub(super) fn of_joints<'a, 'i>(mjcf: &Mjcf<'a, 'i>, tree: &Tree) -> BTreeMap<usize, Equality<'a, 'i>> {
    let mut found = BTreeMap::new();
    for node in in_force(mjcf).filter(|node| node.has_tag_name("joint") && is_linear(*node)) {
        let names = node.attribute("joint1").zip(node.attribute("joint2"));
        let Some((follower, leader_name)) = names else { continue };
        let Some((follower, leader)) = tree.joint(follower).zip(tree.joint(leader_name)) else { continue };
        found.entry(follower).or_insert(Equality { node, leader_name, leader });
    }
    found
}

/// Whether no coefficient of a power is a number other than 0. Words that are no numbers are reported where the joint follows.
pub(super) fn is_linear(equality: Node<'_, '_>) -> bool {
    let words = equality.attribute("polycoef").unwrap_or_default().split_ascii_whitespace();
    !words.skip(2).any(|word| word.parse::<f64>().is_ok_and(|value| value != 0.0 && value.is_finite()))
}

/// Whether an equality is that of a follower.
pub(super) fn is_taken(mjcf: &Mjcf<'_, '_>, equality: Node<'_, '_>, tree: &Tree) -> bool {
    let follower = equality.attribute("joint1").and_then(|name| tree.joint(name));
    follower.and_then(|follower| mjcf.equalities.get(&follower)).is_some_and(|taken| taken.node == equality)
}

/// Multiplier, if given, and offset of a follower; faults are reported.
pub(super) fn ratio(
    mjcf: &Mjcf<'_, '_>,
    follower: usize,
    equality: &Equality<'_, '_>,
    values: &mut Values<'_>,
) -> (Option<Decimal>, Decimal) {
    let coefficients = attribute(equality.node, "polycoef");
    if let Some((text, span)) = coefficients {
        let count = text.split_ascii_whitespace().count();
        if count > COEFFICIENTS {
            let message = format!("`polycoef` has {count} numbers, more than {COEFFICIENTS}");
            values.report(Code::WrongLength, span, message, "", "write the offset, the factor, and nothing else that is not 0");
        }
    }
    let mut coefficients = coefficients.map_or_else(Vec::new, |(text, span)| values.words(text, span, "`polycoef`")).into_iter();
    let (constant, multiplier) = (coefficients.next().unwrap_or_else(Decimal::zero), coefficients.next());
    let mut reference = |joint: usize| {
        let element = mjcf.joints[joint].joint?;
        let at = mjcf.number(element, "ref", "the reference of a joint", values)?;
        Some(mjcf.variable(at, mjcf.kind(element))).filter(|at| !at.is_zero())
    };
    let (own, of_leader) = (reference(follower), reference(equality.leader));
    let by = multiplier.clone().unwrap_or_else(Decimal::one);
    let mut offset = constant;
    for (text, value) in [
        own.map(|own| (factor(&own.text), own.value)),
        of_leader.map(|at| (format!("{}*{}", factor(&opposite(&by.text)), factor(&at.text)), -by.value * at.value)),
    ]
    .into_iter()
    .flatten()
    {
        let text = if offset.text == "0" { text } else { format!("{} + {text}", offset.text) };
        offset = Decimal { text, value: offset.value + value, span: offset.span };
    }
    (multiplier, offset)
}

/// Joints that an equality couples and a switch sets free, each with its leader, for a note.
pub(super) fn switched_off(mjcf: &Mjcf<'_, '_>, tree_names: &[&str]) -> Option<String> {
    let all = sections(mjcf.root, "equality").flat_map(|section| section.children()).filter(|node| node.has_tag_name("joint"));
    let off = all.filter(|node| mjcf.disabled.equality || node.attribute("active") == Some("false"));
    let named = |node: Node<'_, '_>| {
        let follower = node.attribute("joint1").filter(|name| tree_names.contains(name))?;
        Some(match node.attribute("joint2") {
            Some(leader) => format!("`{}` does not follow `{}`", shown(follower), shown(leader)),
            None => format!("nothing holds `{}`", shown(follower)),
        })
    };
    let free: Vec<String> = off.filter_map(named).collect();
    (!free.is_empty()).then(|| format!("equalities that the model switches off are left out: {}", free.join(", ")))
}

/// Warns of an equality that a lock of its first joint replaces, while the second one moves.
pub(super) fn warn_of_held(equality: Node<'_, '_>, diagnostics: &mut Diagnostics) {
    let [follower, leader] = ["joint1", "joint2"].map(|name| shown(equality.attribute(name).unwrap_or_default()));
    let how = if is_linear(equality) { "" } else { " by a polynomial" };
    let message =
        format!("the joint `{follower}` follows `{leader}`{how}, and is locked: what it carries no longer moves as in the file");
    let help = "torques and accelerations are not those of the file, nor are frames behind that joint";
    diagnostics.push(Diagnostic::new(Code::ChangesMotion, place(equality), message, "not used", help));
}

/// Reports words of `active` other than its two.
pub(super) fn refuse_switches(mjcf: &Mjcf<'_, '_>, diagnostics: &mut Diagnostics) {
    for node in sections(mjcf.root, "equality").flat_map(|section| section.children()) {
        if let Some((word, span)) = attribute(node, "active").filter(|(word, _)| !matches!(*word, "true" | "false")) {
            let message = format!("`active` of an equality is `{}`", shown(word));
            diagnostics.push(Diagnostic::new(Code::MjcfFeature, span, message, "", "write `true` or `false`"));
        }
    }
}

/// Reports an equality of the arm that no joint takes.
pub(super) fn refuse(mjcf: &Mjcf<'_, '_>, equality: Node<'_, '_>, tree: &Tree, diagnostics: &mut Diagnostics) {
    let what = equality.tag_name().name();
    let of_joints = what == "joint";
    for name in ["joint1", "joint2"] {
        let Some((joint, span)) = attribute(equality, name).filter(|_| of_joints) else { continue };
        if tree.joint(joint).is_none() {
            let message = format!("an equality names `{}`, which is no joint of this file", shown(joint));
            diagnostics.push(Diagnostic::new(Code::UnknownJoint, span, message, "", tree.meant_joint(joint)));
            return;
        }
    }
    let joint = |name: &str| equality.attribute(name).map(shown);
    let taken = equality.attribute("joint1").and_then(|name| mjcf.equalities.get(&tree.joint(name)?));
    let (message, help) = match (joint("joint1"), joint("joint2"), taken) {
        (Some(first), None, _) if of_joints => {
            (format!("an equality holds the joint `{first}`"), format!("take it out, and hold the joint with `--lock {first}=VALUE`"))
        }
        (Some(first), Some(_), Some(taken)) if of_joints => {
            let message = format!("the joint `{first}` follows `{}` already", shown(taken.leader_name));
            let help = format!("a joint follows one other joint: take one of the two equalities out, or hold it with `--lock {first}=VALUE`");
            let fault = Diagnostic::new(Code::MjcfFeature, place(equality), message, "not taken", help);
            diagnostics.push(fault.also(place(taken.node), "taken"));
            return;
        }
        (Some(first), Some(second), None) if of_joints => (
            format!("the joint `{first}` follows `{second}` by a polynomial that is not linear"),
            format!("a joint follows others by a factor and an offset: take it out, or hold the joint with `--lock {first}=VALUE`"),
        ),
        _ => (
            format!("an equality, `{}`, concerns the arm", shown(what)),
            "an arm is a tree of joints, which move freely or follow one other joint: take it out, or hold what it is about with `--lock JOINT=VALUE`"
                .into(),
        ),
    };
    diagnostics.push(Diagnostic::new(Code::MjcfFeature, place(equality), message, "", help));
}
