//! Which link is the tip where the user does not say: the only one that it can be.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};

use super::locks::Locks;
use crate::tree::{Link, Role, Tree};
use crate::xml::shown;
use crate::Code;

/// So many names in a message.
const NAMED: usize = 12;

/// The only leaf with a moving joint above it, with notes; where several differ by fixed joints alone, the link of the last joint that moves.
pub(super) fn only(tree: &Tree, base: usize, locks: &Locks, diagnostics: &mut Diagnostics) -> Option<(usize, Vec<String>)> {
    // Leaves by the last joint above them that moves, in the order of the file.
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut count: BTreeMap<usize, usize> = BTreeMap::new();
    let mut open: Vec<(usize, Option<usize>, usize)> = vec![(base, None, 0)];
    while let Some((link, last, moving)) = open.pop() {
        let bodies = tree.links[link].below.iter().filter(|&&joint| tree.links[tree.joints[joint].child].role != Role::Frame);
        let mut leaf = true;
        for &below in bodies {
            leaf = false;
            let joint = &tree.joints[below];
            let moves = joint.kind.moves() && locks.of(below).is_none();
            open.push((joint.child, if moves { Some(below) } else { last }, moving + usize::from(moves)));
        }
        if let (true, Some(last)) = (leaf, last) {
            groups.entry(last).or_default().push(link);
            count.insert(last, moving);
        }
    }
    let named = |links: &[usize]| {
        let names: Vec<String> = links.iter().take(NAMED).map(|&link| format!("`{}`", shown(&tree.links[link].name))).collect();
        format!("{}{}", names.join(", "), if links.len() > NAMED { ", ..." } else { "" })
    };
    if groups.len() > 1 {
        // The arm is among the longest chains; leaves that fixed joints alone part are one choice.
        let mut chains: Vec<(&[usize], usize)> = groups.iter().map(|(last, leaves)| (leaves.as_slice(), count[last])).collect();
        chains.sort_by_key(|&(_, joints)| std::cmp::Reverse(joints));
        let chain = |&(leaves, joints): &(&[usize], usize)| {
            let others = match leaves.len() - 1 {
                0 => String::new(),
                1 => ", and 1 leaf fixed to its last link".to_owned(),
                n => format!(", and {n} leaves fixed to its last link"),
            };
            format!("`{}` ({}{others})", shown(&tree.links[leaves[0]].name), number(joints))
        };
        let all: Vec<String> = chains.iter().take(NAMED).map(chain).collect();
        let more = chains.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(", and {more} more") } else { String::new() };
        let message = format!("several links may be the tip: {}{more}", all.join(", "));
        let tips: Vec<usize> = chains.iter().map(|(leaves, _)| leaves[0]).collect();
        let mut help = format!("choose one: `--tip {}`", shown(&tree.links[tips[0]].name));
        if let Some((link, joints)) = before_branches(tree, base, tips[0], locks) {
            let (tip, joints) = (shown(&link.name), number(joints));
            help = format!("{help}; or end the arm where it branches, say before the fingers: `--tip {tip}` ({joints})");
        }
        let mut fault = Diagnostic::new(Code::SeveralTips, tree.links[tips[0]].span, message, "may be the tip", help);
        for &tip in tips.iter().skip(1).take(3) {
            fault = fault.also(tree.links[tip].span, "may be the tip, too");
        }
        diagnostics.push(fault);
        return None;
    }
    let Some((&last, leaves)) = groups.iter().next() else {
        let message = format!("nothing moves below `{}`", shown(&tree.links[base].name));
        let help = "an arm has a joint that turns or slides; is the right `--base` given?";
        diagnostics.push(Diagnostic::new(Code::NoJoints, tree.links[base].span, message, "", help));
        return None;
    };
    if let [only] = leaves[..] {
        return Some((only, Vec::new()));
    }
    let mut tip = tree.joints[last].child;
    // The frame of the body, not the one that its joint turns about.
    while let (Role::Between, Some(&below)) = (tree.links[tip].role, tree.links[tip].below.first()) {
        tip = tree.joints[below].child;
    }
    let note = format!(
        "the end effector is the link `{}`; frames that are fixed to it may be instead, by `--tip`: {}",
        shown(&tree.links[tip].name),
        named(leaves)
    );
    Some((tip, vec![note]))
}

/// `1 joint`, `2 joints`.
fn number(joints: usize) -> String {
    format!("{joints} joint{}", if joints == 1 { "" } else { "s" })
}

/// The last link above a tip on which more than one joint moves something, and how many joints move it, if some do.
fn before_branches<'t>(tree: &'t Tree, base: usize, tip: usize, locks: &Locks) -> Option<(&'t Link, usize)> {
    let moves = |joint: usize| tree.joints[joint].kind.moves() && locks.of(joint).is_none();
    // Whether a joint, or one below it, moves.
    let moving = |joint: usize| {
        let mut open = vec![joint];
        while let Some(joint) = open.pop() {
            if moves(joint) {
                return true;
            }
            open.extend(&tree.links[tree.joints[joint].child].below);
        }
        false
    };
    let path = tree.path(base, tip)?;
    let at =
        path.iter().rposition(|&joint| tree.links[tree.joints[joint].parent].below.iter().filter(|&&j| moving(j)).count() > 1)?;
    let joints = path[..at].iter().filter(|&&joint| moves(joint)).count();
    let link = &tree.links[tree.joints[path[at]].parent];
    (joints > 0 && link.role != Role::Between).then_some((link, joints))
}

/// The links above one, as a list for a message, if there are some.
pub(super) fn way_up(tree: &Tree, link: usize) -> Option<String> {
    let mut names = Vec::new();
    let mut at = link;
    while let Some(above) = tree.links[at].above {
        at = tree.joints[above].parent;
        names.push(format!("`{}`", shown(&tree.links[at].name)));
        if names.len() == NAMED {
            names.push("...".to_owned());
            break;
        }
    }
    (!names.is_empty()).then(|| names.join(", "))
}
