//! Which link is the tip where the user does not say: the only one that it can be.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::kinds::{MAX_JOINTS, MAX_TIPS};

use super::locks::Locks;
use super::names;
use crate::tree::{Role, Tree};
use crate::xml::shown;
use crate::Code;

/// The most names in a message.
const NAMED: usize = 12;

/// A link that may be the tip.
#[derive(Clone, Copy)]
struct Candidate {
    link: usize,
    /// The last joint above it that moves, and how many do.
    last: usize,
    joints: usize,
}

/// Leaves by the last joint above them that moves, in the order of the file.
fn leaves(tree: &Tree, base: usize, locks: &Locks) -> BTreeMap<usize, Vec<Candidate>> {
    let mut groups: BTreeMap<usize, Vec<Candidate>> = BTreeMap::new();
    let mut frames: Vec<Candidate> = Vec::new();
    let mut open: Vec<(usize, Option<usize>, usize)> = vec![(base, None, 0)];
    while let Some((link, last, joints)) = open.pop() {
        let frame = tree.links[link].role == Role::Frame;
        let mut leaf = !frame;
        for &below in &tree.links[link].below {
            let joint = &tree.joints[below];
            leaf &= tree.links[joint.child].role == Role::Frame;
            let moves = locks.let_move(tree, below);
            open.push((joint.child, if moves { Some(below) } else { last }, joints + usize::from(moves)));
        }
        let Some(last) = last else { continue };
        let candidate = Candidate { link, last, joints };
        if leaf {
            groups.entry(last).or_default().push(candidate);
        } else if frame && names::tool(&tree.links[link].name).is_some() {
            frames.push(candidate);
        }
    }
    if !groups.is_empty() {
        frames.into_iter().for_each(|frame| groups.entry(frame.last).or_default().push(frame));
    }
    groups
}

/// The only leaf with a moving joint above it, with notes; where several differ by fixed joints alone, the link of the last joint that moves.
///
/// A site whose name is that of a tool's frame counts as a leaf: it is to a MuJoCo model what a link without mass is to a URDF.
pub(super) fn only(tree: &Tree, base: usize, locks: &Locks, diagnostics: &mut Diagnostics) -> Option<(usize, Vec<String>)> {
    let mut groups = leaves(tree, base, locks);
    let mut notes = Vec::new();
    if groups.len() > 1 {
        if let Some(note) = keep_the_longest_of_a_series(tree, base, &mut groups) {
            notes.push(note);
        } else if let Some(warning) = keep_the_arm_before_its_fingers(tree, base, locks, &mut groups) {
            diagnostics.push(warning);
        } else {
            diagnostics.push(several(tree, base, locks, &groups));
            return None;
        }
    }
    let Some((&last, leaves)) = groups.iter().next() else {
        let message = format!("nothing moves below `{}`", shown(&tree.links[base].name));
        let help = "an arm has a joint that turns or slides; is the right `--base` given?";
        diagnostics.push(Diagnostic::new(Code::NoJoints, tree.links[base].span, message, "", help));
        return None;
    };
    if is_finger(tree, last) {
        diagnostics.push(finger(tree, base, last, locks));
    }
    let bodies: Vec<usize> = leaves.iter().map(|leaf| leaf.link).filter(|&link| tree.links[link].role != Role::Frame).collect();
    if let ([only], 1) = (&bodies[..], leaves.len()) {
        return Some((*only, notes));
    }
    let mut tip = tree.joints[last].child;
    // The frame of the body, not the one that its joint turns about.
    while let (Role::Between, Some(&below)) = (tree.links[tip].role, tree.links[tip].below.first()) {
        tip = tree.joints[below].child;
    }
    if let [only] = bodies[..] {
        tip = only;
    }
    let mut others: Vec<usize> = leaves.iter().map(|leaf| leaf.link).filter(|&link| link != tip).collect();
    others.sort_by_key(|&link| names::tool(&tree.links[link].name).unwrap_or(usize::MAX));
    let note = format!(
        "the end effector is the link `{}`; frames that are fixed to it may be instead, by `--tip`: {}",
        shown(&tree.links[tip].name),
        listed(others.iter().map(|&link| format!("`{}`", shown(&tree.links[link].name))))
    );
    notes.push(note);
    Some((tip, notes))
}

/// The ends of all branches.
pub(super) struct Ends {
    /// Links that carry an end effector.
    pub(super) tips: Vec<usize>,
    /// Further links, without an end effector.
    pub(super) others: Vec<usize>,
    pub(super) notes: Vec<String>,
}

/// All leaves that a joint moves, those that differ by fixed joints alone once, in the order of the file. Where they are too many, those on
/// joints that follow others have no end effector; the link where their branches begin has it. Of those that are still too many, the last have
/// none.
pub(super) fn all(tree: &Tree, base: usize, locks: &Locks, diagnostics: &mut Diagnostics) -> Option<Ends> {
    let groups = leaves(tree, base, locks);
    let best = |leaves: &Vec<Candidate>| {
        let rank = |leaf: &&Candidate| names::tool(&tree.links[leaf.link].name).unwrap_or(usize::MAX);
        let named = leaves.iter().min_by_key(rank).filter(|leaf| names::tool(&tree.links[leaf.link].name).is_some());
        let only = match &leaves[..] {
            [only] => Some(only.link),
            _ => None,
        };
        let link = named.map(|leaf| leaf.link).or(only).unwrap_or(tree.joints[leaves[0].last].child);
        Candidate { link, ..leaves[0] }
    };
    // A joint whose link carries others that move ends no branch.
    let inner = |last: usize| groups.keys().any(|&other| other != last && is_above(tree, last, other));
    let mut ends: Vec<Candidate> = groups.iter().filter(|(&last, _)| !inner(last)).map(|(_, leaves)| best(leaves)).collect();
    if ends.is_empty() {
        let message = format!("nothing moves below `{}`", shown(&tree.links[base].name));
        let help = "an arm has a joint that turns or slides; is the right `--base` given?";
        diagnostics.push(Diagnostic::new(Code::NoJoints, tree.links[base].span, message, "", help));
        return None;
    }
    let named = |ends: &[Candidate]| {
        let names = ends.iter().map(|end| format!("`{}` ({})", shown(&tree.links[end.link].name), number(end.joints)));
        names.collect::<Vec<_>>().join(", ")
    };
    let (mut notes, mut others) = (Vec::new(), Vec::new());
    if ends.len() > MAX_TIPS {
        let followers = locks.all_followers();
        let (led, mut own): (Vec<Candidate>, Vec<Candidate>) = ends.iter().partition(|end| followers.contains(&end.last));
        let hands = before_followers(tree, base, locks, (&led, &own), &groups);
        if (1..=MAX_TIPS).contains(&(own.len() + hands.len())) {
            own.extend(hands);
        }
        if !led.is_empty() && (1..=MAX_TIPS).contains(&own.len()) {
            notes.push(format!("without an end effector, since the last joint follows another one: {}", named(&led)));
            (ends, others) = (own, led);
        }
    }
    // More ends than joints that a robot may have: nothing of it can be taken whole.
    if ends.len() > MAX_JOINTS {
        let more = ends.len() - MAX_TIPS;
        let message = format!(
            "{} branches end with a link that moves, more than the {MAX_TIPS} end effectors that a robot has",
            ends.len()
        );
        let help = format!("name up to {MAX_TIPS} by `--tip`, or lock joints of {more} branches with `--lock JOINT=0`");
        diagnostics.push(Diagnostic::new(Code::SeveralTips, tree.links[ends[MAX_TIPS].link].span, message, "one too many", help));
        return None;
    }
    if ends.len() > MAX_TIPS {
        // Tools first, then the longest chains; what follows last.
        let followers = locks.all_followers();
        let tool = |end: &Candidate| names::tool(&tree.links[end.link].name).unwrap_or(usize::MAX);
        ends.sort_by_key(|end| (followers.contains(&end.last), tool(end), Reverse(end.joints), end.last));
        let more = ends.split_off(MAX_TIPS);
        notes.push(format!(
            "without an end effector, since a robot has at most {MAX_TIPS}, which `--tip` chooses: {}",
            named(&more)
        ));
        others.extend(more);
    }
    ends.sort_by_key(|end| end.last);
    notes.insert(0, format!("end effectors: {}", named(&ends)));
    let links = |ends: Vec<Candidate>| ends.into_iter().map(|end| end.link).collect();
    Some(Ends { tips: links(ends), others: links(others), notes })
}

/// The last links before branches that end with followers, where no other branch begins behind them; a tool's frame that is fixed to such a link
/// in its place.
fn before_followers(
    tree: &Tree,
    base: usize,
    locks: &Locks,
    (led, own): (&[Candidate], &[Candidate]),
    groups: &BTreeMap<usize, Vec<Candidate>>,
) -> Vec<Candidate> {
    let is_below = |link: usize, above: usize| tree.path(above, link).is_some();
    let carries_others = |link: usize| own.iter().any(|end| is_below(end.link, link));
    let all = led.iter().filter_map(|end| before_branches(tree, base, end.link, locks));
    let all: Vec<(usize, usize)> = all.filter(|(link, _)| !carries_others(*link)).collect();
    let mut hands: Vec<Candidate> = Vec::new();
    for &(link, joints) in &all {
        let is_outer = all.iter().all(|&(other, _)| other == link || !is_below(link, other));
        let last = tree.path(base, link).into_iter().flatten().rfind(|&j| locks.let_move(tree, j));
        let Some(last) = last.filter(|_| is_outer) else { continue };
        if hands.iter().any(|hand| hand.last == last) {
            continue;
        }
        let named = |leaf: &&Candidate| names::tool(&tree.links[leaf.link].name).map(|rank| (rank, leaf.link));
        let tool = groups.get(&last).into_iter().flatten().filter_map(|leaf| named(&leaf)).min();
        hands.push(Candidate { link: tool.map_or(link, |(_, link)| link), last, joints });
    }
    hands
}

/// Whether a joint is above another one.
fn is_above(tree: &Tree, above: usize, joint: usize) -> bool {
    let mut at = tree.joints[joint].parent;
    while let Some(next) = tree.links[at].above {
        if next == above {
            return true;
        }
        at = tree.joints[next].parent;
    }
    false
}

/// Where all moving joints follow each other, leaves on earlier links are covers or cameras: removes these, and notes them.
///
/// A finger at the end, or the frame of a tool on an earlier link, leaves the choice to the user.
fn keep_the_longest_of_a_series(tree: &Tree, base: usize, groups: &mut BTreeMap<usize, Vec<Candidate>>) -> Option<String> {
    let (&last, longest) = groups.iter().max_by_key(|(_, leaves)| leaves[0].joints)?;
    let path = tree.path(base, longest[0].link)?;
    let earlier: Vec<Candidate> =
        groups.iter().filter(|(&joint, _)| joint != last).flat_map(|(_, leaves)| leaves.clone()).collect();
    let is_series = earlier.iter().all(|leaf| path.contains(&leaf.last));
    let has_tool = earlier.iter().any(|leaf| names::tool(&tree.links[leaf.link].name).is_some());
    if !is_series || has_tool || is_finger(tree, last) {
        return None;
    }
    groups.retain(|&joint, _| joint == last);
    let named = earlier.iter().map(|leaf| format!("`{}` ({})", shown(&tree.links[leaf.link].name), number(leaf.joints)));
    Some(format!("links fixed to an earlier link are parts of it; `--tip` ends the arm at one of them: {}", listed(named)))
}

/// Where all branches are fingers of one hand, no finger is the end effector: keeps the hand, with a warning of the joints that rest.
///
/// A single finger may be meant as the last joint, and other branches may be arms: these leave the choice to the user.
fn keep_the_arm_before_its_fingers(
    tree: &Tree,
    base: usize,
    locks: &Locks,
    groups: &mut BTreeMap<usize, Vec<Candidate>>,
) -> Option<Diagnostic> {
    let moves = |joint: usize| locks.let_move(tree, joint);
    let ends: Vec<Candidate> = groups.iter().filter(|(&last, _)| is_finger(tree, last)).map(|(_, leaves)| leaves[0]).collect();
    let (first, others) = ends.split_first().filter(|(_, others)| !others.is_empty())?;
    let mut common = tree.path(base, first.link)?;
    for end in others {
        let path = tree.path(base, end.link)?;
        let same = common.iter().zip(&path).take_while(|(a, b)| a == b).count();
        common.truncate(same);
    }
    let last = common.iter().copied().rfind(|&joint| moves(joint)).filter(|&joint| !is_finger(tree, joint))?;
    let link = common.last().map(|&joint| tree.joints[joint].child).filter(|&link| tree.links[link].role != Role::Between)?;
    if groups.keys().any(|&other| other != last && !is_finger(tree, other)) {
        return None;
    }
    let joints = common.iter().filter(|&&joint| moves(joint)).count();
    let hand = groups.remove(&last).unwrap_or_else(|| vec![Candidate { link, last, joints }]);
    *groups = BTreeMap::from([(last, hand)]);
    let fingers = fingers(tree, locks, ends.iter().map(|end| end.last));
    let name = |&joint: &usize| shown(&tree.joints[joint].name);
    let rest = if fingers.len() == 1 { "rests" } else { "rest" };
    let message = format!(
        "the arm ends at `{}` ({}), before its fingers: {} {rest} at 0",
        shown(&tree.links[link].name),
        number(joints),
        listed(fingers.iter().map(|joint| format!("`{}`", name(joint))))
    );
    let help =
        format!("`--lock {}=VALUE` puts a finger elsewhere; `--all` takes all in, and `--tip LINK` one", name(&fingers[0]));
    Some(Diagnostic::new(Code::FingersAtRest, tree.links[link].span, message, "the hand", help))
}

/// The joints that hold the fingers behind these joints where they are, each once: a follower rests with its leader.
fn fingers(tree: &Tree, locks: &Locks, lasts: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut fingers: Vec<usize> = Vec::new();
    for last in lasts {
        let decisive = locks.decisive(last);
        let joint = if is_finger(tree, decisive) && tree.joints[decisive].kind.moves() { decisive } else { last };
        if !fingers.contains(&joint) {
            fingers.push(joint);
        }
    }
    fingers
}

/// The refusal of a file with several links that may be the tip, and the best of them: the frame of a tool; else the link before the fingers;
/// else the longest chain.
fn several(tree: &Tree, base: usize, locks: &Locks, groups: &BTreeMap<usize, Vec<Candidate>>) -> Diagnostic {
    // The arm is among the longest chains; leaves that fixed joints alone part are one choice.
    let best = |leaves: &[Candidate]| {
        let rank = |leaf: &&Candidate| names::tool(&tree.links[leaf.link].name).unwrap_or(usize::MAX);
        *leaves.iter().min_by_key(rank).expect("a group has a leaf")
    };
    let mut chains: Vec<(Candidate, usize)> = groups.values().map(|leaves| (best(leaves), leaves.len())).collect();
    chains.sort_by_key(|(chain, _)| std::cmp::Reverse(chain.joints));
    let tools = chains.iter().map(|(chain, _)| *chain).filter(|chain| !is_finger(tree, chain.last));
    let tool = tools.filter_map(|chain| Some((names::tool(&tree.links[chain.link].name)?, chain))).min_by_key(|(rank, _)| *rank);
    let fingers = fingers(tree, locks, chains.iter().map(|(chain, _)| chain.last).filter(|&last| is_finger(tree, last)));
    let longest = chains[0].0;
    let branch = before_branches(tree, base, longest.link, locks);
    let other = chains.iter().map(|(chain, _)| *chain).find(|chain| !is_finger(tree, chain.last));
    let (first, joints) = match (tool, branch, other) {
        (Some((_, chain)), ..) => (chain.link, chain.joints),
        (None, Some(before), _) if is_finger(tree, longest.last) => before,
        (None, None, Some(chain)) => (chain.link, chain.joints),
        _ => (longest.link, longest.joints),
    };
    // The one that is suggested is listed first.
    if let Some(at) = chains.iter().position(|(chain, _)| chain.link == first) {
        let chain = chains.remove(at);
        chains.insert(0, chain);
    }
    let chain = |&(chain, leaves): &(Candidate, usize)| {
        let others = match leaves - 1 {
            0 => String::new(),
            1 => ", and 1 leaf fixed to its last link".to_owned(),
            n => format!(", and {n} leaves fixed to its last link"),
        };
        format!("`{}` ({}{others})", shown(&tree.links[chain.link].name), number(chain.joints))
    };
    let all: Vec<String> = chains.iter().take(NAMED).map(chain).collect();
    let more = chains.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(", and {more} more") } else { String::new() };
    let message = format!("several links may be the tip: {}{more}", all.join(", "));
    let mut help = format!("choose one: `--tip {}` ({})", shown(&tree.links[first].name), number(joints));
    if !fingers.is_empty() && first != longest.link {
        let locks: Vec<String> =
            fingers.iter().take(NAMED).map(|&joint| format!("`--lock {}=0`", shown(&tree.joints[joint].name))).collect();
        help = format!("{help}; what moves beside it stands at 0, or where you say: {}", locks.join(" "));
    }
    if let Some((link, joints)) = branch.filter(|&(link, _)| link != first) {
        let (tip, joints) = (shown(&tree.links[link].name), number(joints));
        help = format!("{help}; or end the arm where it branches, say before the fingers: `--tip {tip}` ({joints})");
    }
    if groups.len() <= MAX_TIPS {
        help = format!("{help}; or take all branches: `--all`");
    }
    let mut fault = Diagnostic::new(Code::SeveralTips, tree.links[first].span, message, "may be the tip", help);
    for (chain, _) in chains.iter().filter(|(chain, _)| chain.link != first).take(3) {
        fault = fault.also(tree.links[chain.link].span, "may be the tip, too");
    }
    fault
}

/// Whether a joint moves a finger, by its name or that of its link.
fn is_finger(tree: &Tree, joint: usize) -> bool {
    let joint = &tree.joints[joint];
    names::finger(&joint.name, &tree.links[joint.child].name)
}

/// The warning that the last joint of an arm moves a finger, with the options that leave it out.
fn finger(tree: &Tree, base: usize, last: usize, locks: &Locks) -> Diagnostic {
    let moves = |joint: usize| locks.let_move(tree, joint);
    let joint = &tree.joints[last];
    let name = shown(&joint.name);
    let message = format!("the last joint, `{name}`, seems to move a finger: the arm ends there, and inverse kinematics use it");
    let mut tip = joint.parent;
    while let (Role::Between, Some(above)) = (tree.links[tip].role, tree.links[tip].above) {
        tip = tree.joints[above].parent;
    }
    let before = tree.path(base, tip).map_or(0, |path| path.into_iter().filter(|&joint| moves(joint)).count());
    let help = match before {
        0 => "keep it if that is meant".to_owned(),
        joints => format!(
            "`--tip {} --lock {name}=0` leaves it out ({}); keep it if that is meant",
            shown(&tree.links[tip].name),
            number(joints)
        ),
    };
    Diagnostic::new(Code::FingerAsTip, joint.span, message, "a finger?", help)
}

/// A list for a message, which ends where it would be long.
fn listed(names: impl Iterator<Item = String>) -> String {
    let mut names: Vec<String> = names.take(NAMED + 1).collect();
    if names.len() > NAMED {
        names[NAMED] = "...".into();
    }
    names.join(", ")
}

/// `1 joint`, `2 joints`.
fn number(joints: usize) -> String {
    format!("{joints} joint{}", if joints == 1 { "" } else { "s" })
}

/// The last link above a tip on which more than one joint moves something, and how many joints move it, if some do.
fn before_branches(tree: &Tree, base: usize, tip: usize, locks: &Locks) -> Option<(usize, usize)> {
    let moves = |joint: usize| locks.let_move(tree, joint);
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
    let link = tree.joints[path[at]].parent;
    (joints > 0 && tree.links[link].role != Role::Between).then_some((link, joints))
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
