//! Joints that stand still: those that are held, and where those stand that follow others: factor · leader + offset, whatever their leaders
//! follow in turn.

use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::diagnostic::Diagnostic;
use armgen_codegen::document::parse_expression;
use armgen_codegen::document::yaml::Scalar;
use armgen_codegen::source::Span;

use super::Builder;
use crate::format::Format;
use crate::number::Decimal;
use crate::pose::factor;
use crate::tree::{Joint, Kind, Tree};
use crate::values::Values;
use crate::xml::{beginning, shown};
use crate::Code;

/// Followers of followers that a message looks through.
const LONGEST_LINE: usize = 64;

/// A joint that stands still.
#[derive(Clone, Debug)]
pub(crate) struct Lock {
    pub(crate) joint: String,
    /// An expression.
    pub(crate) text: String,
    pub(crate) value: f64,
    pub(crate) span: Span,
}

impl Lock {
    /// The lock of a joint at 0.
    pub(crate) fn at_zero(joint: &Joint) -> Lock {
        Lock { joint: joint.name.clone(), text: "0".into(), value: 0.0, span: joint.span }
    }
}

/// The joints that stand still: those that the user locks, and their followers.
pub(crate) struct Locks {
    by_joint: BTreeMap<usize, Lock>,
    /// Joints that the user locks.
    given: BTreeSet<usize>,
    /// Of each joint those that follow it, in the order of the file.
    followers: BTreeMap<usize, Vec<usize>>,
    /// Of each follower its leader.
    leaders: BTreeMap<usize, usize>,
    /// Joints that follow others with the multiplier 0.
    resting: BTreeSet<usize>,
}

impl Locks {
    /// The locks of the options, and of the joints that follow a locked one; faults are reported.
    pub(crate) fn new(tree: &Tree, format: &dyn Format, options: &[(String, String)], values: &mut Values<'_>) -> Option<Locks> {
        let mut by_joint = BTreeMap::new();
        let before = values.diagnostics.errors();
        let diagnostics = &mut *values.diagnostics;
        for (name, text) in options {
            let mut fault = |code: Code, message: String, help: String| {
                diagnostics.push(Diagnostic::new(code, beginning(), message, "", help));
            };
            let Some(joint) = tree.joint(name) else {
                fault(
                    Code::UnknownJoint,
                    format!("`--lock` names `{}`, which is no joint of this file", shown(name)),
                    tree.meant_joint(name),
                );
                continue;
            };
            let text = text.trim().to_owned();
            let scalar = Scalar { text: text.clone(), plain: true, verbatim: None };
            let value = parse_expression(&scalar, beginning()).ok().and_then(|e| e.to_f64().ok()).filter(|v| v.is_finite());
            match value {
                Some(value) => {
                    let span = tree.joints[joint].span;
                    by_joint.insert(joint, Lock { joint: name.clone(), text, value, span });
                }
                None => fault(
                    Code::BadLock,
                    format!("`--lock {}` has the value `{}`, which is no number", shown(name), shown(&text)),
                    "write for instance `0.04`, `pi/4` or `deg(30)`".to_owned(),
                ),
            }
        }
        let mut followers: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (follower, _) in tree.joints.iter().enumerate().filter(|(_, joint)| joint.kind.moves()) {
            if let Some(leader) = format.leader(follower).and_then(|(leader, _)| tree.joint(leader)) {
                followers.entry(leader).or_default().push(follower);
            }
        }
        let given = by_joint.keys().copied().collect();
        let leaders = followers.iter().flat_map(|(&leader, of)| of.iter().map(move |&follower| (follower, leader))).collect();
        let mut locks = Locks { by_joint, given, followers, leaders, resting: BTreeSet::new() };
        let given = locks.by_joint.iter().map(|(joint, lock)| (*joint, lock.clone()));
        // A fixed joint holds its followers.
        let fixed = locks.followers.keys().filter(|&&leader| tree.joints[leader].kind == Kind::Fixed);
        let fixed = fixed
            .filter(|leader| !locks.by_joint.contains_key(leader))
            .map(|&leader| (leader, Lock::at_zero(&tree.joints[leader])));
        let open = given.chain(fixed).collect();
        locks.spread(tree, format, open, values);
        (values.diagnostics.errors() == before).then_some(locks)
    }

    /// Locks the followers of joints that stand still, and theirs.
    fn spread(&mut self, tree: &Tree, format: &dyn Format, mut open: Vec<(usize, Lock)>, values: &mut Values<'_>) {
        while let Some((leader, at)) = open.pop() {
            for &follower in self.followers.get(&leader).into_iter().flatten() {
                if self.by_joint.contains_key(&follower) {
                    continue;
                }
                let Some(lock) = follow(tree, format, follower, &at, values) else { continue };
                self.by_joint.insert(follower, lock.clone());
                open.push((follower, lock));
            }
        }
    }

    /// Holds a joint that follows another one with the multiplier 0, and those that follow it.
    pub(super) fn rest(&mut self, tree: &Tree, format: &dyn Format, joint: usize, at: Lock, values: &mut Values<'_>) {
        self.resting.insert(joint);
        self.by_joint.insert(joint, at.clone());
        self.spread(tree, format, vec![(joint, at)], values);
    }

    /// The joints that follow a joint, in the order of the file.
    pub(super) fn followers(&self, joint: usize) -> &[usize] {
        self.followers.get(&joint).map_or(&[], Vec::as_slice)
    }

    /// All joints that follow others.
    pub(super) fn all_followers(&self) -> BTreeSet<usize> {
        self.leaders.keys().copied().collect()
    }

    /// The joint that a joint follows.
    pub(super) fn leader(&self, joint: usize) -> Option<usize> {
        self.leaders.get(&joint).copied()
    }

    /// The joints that the user locks.
    pub(super) fn given(&self) -> &BTreeSet<usize> {
        &self.given
    }

    /// The joints that a lock holds beside its own: followers, theirs and so on, in the order of the file.
    pub(super) fn held_with(&self, joint: usize) -> BTreeSet<usize> {
        let (mut held, mut open) = (BTreeSet::new(), vec![joint]);
        while let Some(leader) = open.pop() {
            let further = self.followers(leader).iter().copied().filter(|follower| !self.given.contains(follower));
            open.extend(further.filter(|&follower| held.insert(follower)));
        }
        held
    }

    /// The joint whose own position decides where a joint stands: the first one up the line that the user locks, or that follows none.
    pub(super) fn decisive(&self, joint: usize) -> usize {
        let mut at = joint;
        // A longer line is no robot's, or a ring.
        for _ in 0..LONGEST_LINE {
            let Some(leader) = self.leader(at).filter(|_| !self.given.contains(&at) && !self.resting.contains(&at)) else {
                return at;
            };
            at = leader;
        }
        joint
    }

    /// Whether a joint moves and is not locked.
    pub(crate) fn let_move(&self, tree: &Tree, joint: usize) -> bool {
        tree.joints[joint].kind.moves() && self.of(joint).is_none()
    }

    /// The lock of a joint.
    pub(crate) fn of(&self, joint: usize) -> Option<&Lock> {
        self.by_joint.get(&joint)
    }
}

/// The value of an unlocked joint outside the arm that follows others.
#[derive(Clone, Debug)]
pub(super) enum Led {
    At(Lock),
    /// With this joint of the arm, which moves.
    Moving(usize),
    /// A fault, which is reported.
    Faulty,
}

impl Builder<'_> {
    /// The value of an unlocked joint outside the chain: 0, or the value given by the joints that it follows.
    pub(super) fn following(&mut self, index: usize) -> Option<Lock> {
        let (tree, format) = (self.tree, self.format);
        let (mut way, mut at) = (Vec::new(), index);
        let mut on_way = BTreeSet::new();
        let mut led = loop {
            if let Some(known) = self.led.get(&at) {
                break known.clone();
            }
            if let Some(lock) = self.locks.of(at) {
                break Led::At(lock.clone());
            }
            if self.on_path.contains(&at) && tree.joints[at].kind.moves() {
                break Led::Moving(at);
            }
            let leader = format.leader(at).filter(|_| tree.joints[at].kind.moves());
            let Some((leader, span)) = leader else { break Led::At(Lock::at_zero(&tree.joints[at])) };
            if !on_way.insert(at) {
                report_ring(tree, &way, at, span, &mut self.values);
                break Led::Faulty;
            }
            let Some(next) = tree.joint(leader) else {
                report_unknown(tree, at, leader, span, &mut self.values);
                break Led::Faulty;
            };
            way.push(at);
            at = next;
        };
        self.led.insert(at, led.clone());
        for &joint in way.iter().rev() {
            if let Led::At(leader) = &led {
                led = follow(tree, format, joint, leader, &mut self.values).map_or(Led::Faulty, Led::At);
            }
            self.led.insert(joint, led.clone());
        }
        match led {
            Led::At(lock) => Some(lock),
            Led::Faulty => None,
            Led::Moving(leader) => {
                let (name, leader) = (shown(&tree.joints[index].name), shown(&tree.joints[leader].name));
                let span = format.leader(index).map_or(tree.joints[index].span, |(_, span)| span);
                let message = format!("the joint `{name}`, above the base, follows `{leader}`: the base would move");
                let help = format!("choose a `--base` above it, or lock it where it is to stand: `--lock {name}=0`");
                self.values.report(Code::Mimic, span, message, "", help);
                None
            }
        }
    }
}

/// Reports joints that follow each other: those on a way from the joint that is met again.
pub(super) fn report_ring(tree: &Tree, way: &[usize], again: usize, span: Span, values: &mut Values<'_>) {
    let ring = way.iter().skip_while(|joint| **joint != again);
    let names: Vec<String> = ring.take(8).map(|&joint| format!("`{}`", shown(&tree.joints[joint].name))).collect();
    let message = match &names[..] {
        [only] => format!("the joint {only} follows itself"),
        names => format!("joints follow each other in a ring: {}", names.join(", ")),
    };
    let which = if names.len() == 1 { "it" } else { "one of them" };
    let help = format!("lock {which} where it is to stand: `--lock {}=0`", shown(&tree.joints[again].name));
    values.report(Code::Mimic, span, message, "", help);
}

/// Reports a joint whose leader does not exist.
pub(super) fn report_unknown(tree: &Tree, follower: usize, leader: &str, span: Span, values: &mut Values<'_>) {
    let name = shown(&tree.joints[follower].name);
    let lock = format!("lock it where it is to stand: `--lock {name}=0`");
    if leader.is_empty() {
        let help = format!("write `joint=\"...\"` with the joint that it follows, or {lock}");
        values.report(Code::MissingAttribute, span, format!("the `mimic` of joint `{name}` names no joint"), "", help);
        return;
    }
    let message = format!("`mimic` names `{}`, which is no joint of this file", shown(leader));
    let meant = tree.meant_joint(leader);
    let help = if meant.ends_with('?') { format!("{meant} Or {lock}") } else { format!("{meant}; or {lock}") };
    values.report(Code::UnknownJoint, span, message, "", help);
}

/// Where a joint stands whose leader stands; faults are reported.
pub(super) fn follow(tree: &Tree, format: &dyn Format, follower: usize, leader: &Lock, values: &mut Values<'_>) -> Option<Lock> {
    let joint = &tree.joints[follower];
    let (ratio, offset) = format.ratio(follower, values);
    let (by, times) = ratio.map_or_else(|| ("1".to_owned(), 1.0), |ratio| (ratio.text, ratio.value));
    let (text, value) = match leader.value != 0.0 && times != 0.0 {
        true => (led_by(&by, &leader.text, &offset), times * leader.value + offset.value),
        false => (offset.text, offset.value),
    };
    // Of a long line of followers the expression nests deeper than a description may.
    let factor = Scalar { text: format!("1*({text})"), plain: true, verbatim: None };
    if parse_expression(&factor, beginning()).is_err() {
        let (name, span) = (shown(&joint.name), format.leader(follower).map_or(joint.span, |(_, span)| span));
        let message = format!("the joint `{name}` follows others by an expression that is too long");
        values.report(Code::TooLarge, span, message, "", format!("lock it where it stands: `--lock {name}={value}`"));
        return None;
    }
    Some(Lock { text, value, ..Lock::at_zero(joint) })
}

/// factor · leader + offset as an expression.
fn led_by(by: &str, leader: &str, offset: &Decimal) -> String {
    let turned = if by == "1" { leader.to_owned() } else { format!("{}*{}", factor(by), factor(leader)) };
    if offset.is_zero() {
        turned
    } else {
        format!("{turned} + {}", factor(&offset.text))
    }
}
