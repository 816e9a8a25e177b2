//! Equalities of two joints, `polycoef` with its first two coefficients: the first joint follows the second one.
//!
//! ```text
//! q1 - ref1 = c0 + c1 (q2 - ref2)
//! ```

use std::collections::BTreeMap;

use roxmltree::Node;

use super::{opposite, sections, Mjcf};
use crate::number::Decimal;
use crate::pose::factor;
use crate::tree::Tree;
use crate::values::Values;
use crate::xml::{attribute, shown};

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

/// Whether the coefficients of powers are 0.
fn is_linear(equality: Node<'_, '_>) -> bool {
    let words = equality.attribute("polycoef").unwrap_or_default().split_ascii_whitespace();
    words.skip(2).all(|word| word.parse::<f64>() == Ok(0.0))
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
    let mut coefficients = coefficients.map_or_else(Vec::new, |(text, span)| values.words(text, span, "polycoef")).into_iter();
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

/// Why an equality of the arm is refused, and what helps.
pub(super) fn refused(equality: Node<'_, '_>) -> (String, String) {
    let what = equality.tag_name().name();
    let joint = |name: &str| equality.attribute(name).map(shown);
    match (what, joint("joint1"), joint("joint2")) {
        ("joint", Some(first), None) => {
            (format!("an equality holds the joint `{first}`"), format!("take it out, and hold the joint with `--lock {first}=VALUE`"))
        }
        ("joint", Some(first), Some(second)) if !is_linear(equality) => (
            format!("the joint `{first}` follows `{second}` by a polynomial that is not linear"),
            format!("a joint follows others by a factor and an offset: take it out, or hold the joint with `--lock {first}=VALUE`"),
        ),
        _ => (
            format!("an equality, `{}`, concerns the arm", shown(what)),
            "an arm is a tree of joints, which move freely or follow one other joint: take it out, or hold what it is about with `--lock JOINT=VALUE`"
                .into(),
        ),
    }
}
