//! Warnings of joints at rest: outside their limits, against their couplings, and what a lock keeps from moving.

use std::collections::BTreeSet;

use super::locks::{follow, Lock};
use super::Builder;
use crate::tree::Kind;
use crate::xml::shown;
use crate::Code;

/// A locked follower may differ so much from its coupling, relative to 1 or to the value: users round.
const AGREES: f64 = 1e-6;
/// The most names in a message.
const NAMED: usize = 8;

impl Builder<'_> {
    /// Warns of a joint whose value violates its own limits.
    pub(super) fn warn_outside(&mut self, index: usize, lock: &Lock) {
        let joint = &self.tree.joints[index];
        let Some([lower, upper]) = self.format.range(index, &mut self.values) else { return };
        if lower >= upper || (lower..=upper).contains(&lock.value) {
            return;
        }
        let name = shown(&joint.name);
        let decisive = self.locks.decisive(index);
        let is_led = decisive != index && self.tree.joints[decisive].kind.moves() && !self.has_factor_zero(index);
        let (message, help) = match shown(&self.tree.joints[decisive].name) {
            leader if is_led => (
                format!("the joint `{name}` follows `{leader}` to {}, outside its limits {lower} to {upper}", digits(lock.value)),
                format!("change where its leader rests: `--lock {leader}=VALUE`"),
            ),
            _ => (
                format!("the joint `{name}` stands at {}, outside its limits {lower} to {upper}", lock.text),
                format!("say where it is to stand: `--lock {name}=VALUE`"),
            ),
        };
        self.values.report(Code::LockOutside, joint.span, message, "", help);
    }

    /// Warns of a joint that the user locks though the file moves it with another one, or puts it elsewhere.
    pub(super) fn warn_of_lock(&mut self, index: usize, lock: &Lock) {
        if !self.locks.given().contains(&index) {
            return;
        }
        match self.moving_leader(index).filter(|_| !self.has_factor_zero(index)) {
            Some(leader) => self.warn_of_frozen(index, leader),
            None => self.warn_of_contradiction(index, lock),
        }
    }

    /// Warns of a locked joint whose leader moves: with the mass that no longer moves as in the file.
    fn warn_of_frozen(&mut self, index: usize, leader: usize) {
        let also = self.locks.held_with(index);
        let all: BTreeSet<usize> = also.iter().copied().chain([index]).collect();
        let on_chain = all.iter().any(|joint| self.on_path.contains(joint));
        let mass = self.mass_below(&all);
        if mass == Some(0.0) && !on_chain {
            return;
        }
        let tree = self.tree;
        let called = |joint: usize| shown(&tree.joints[joint].name);
        let mut names: Vec<String> = also.iter().take(NAMED).map(|&joint| format!("`{}`", called(joint))).collect();
        if also.len() > NAMED {
            names.push(format!("{} more", also.len() - NAMED));
        }
        let too = match also.len() {
            0 => String::new(),
            1 => format!("; {}, which follows it, rests too", names[0]),
            _ => format!("; {}, which follow it, rest too", names.join(", ")),
        };
        let effect = match mass.filter(|mass| *mass != 0.0) {
            Some(mass) => format!("{mass} kg no longer move as in the file"),
            None => "what it carries no longer moves as in the file".into(),
        };
        let message = format!("the joint `{}` follows `{}`, and is locked{too}: {effect}", called(index), called(leader));
        let help = match on_chain {
            true => "torques, accelerations and frames of the chain are not those of the file",
            false => "torques and accelerations are not those of the file; frames of the chain are",
        };
        self.values.report(Code::ChangesMotion, tree.joints[index].span, message, "locked", help);
    }

    /// Warns of a locked joint that the file puts elsewhere, since it follows a joint at rest or has the multiplier 0.
    fn warn_of_contradiction(&mut self, index: usize, lock: &Lock) {
        let Some((leader, by_file)) = self.by_coupling(index) else { return };
        if (by_file.value - lock.value).abs() <= AGREES * lock.value.abs().max(1.0) {
            return;
        }
        let joint = &self.tree.joints[index];
        let (name, leader_name) = (shown(&joint.name), shown(&self.tree.joints[leader].name));
        let (factor, offset) = self.silent(|builder| builder.format.ratio(index, &mut builder.values));
        let factor = factor.map_or(1.0, |factor| factor.value);
        let who = if factor == 0.0 { "the file".to_owned() } else { format!("its leader `{leader_name}`") };
        let message = format!("the joint `{name}` is locked at {}, but {who} puts it at {}", lock.text, digits(by_file.value));
        let mut help = format!("the file has no such posture: leave `--lock {name}` out");
        if factor != 0.0 && self.tree.joints[leader].kind.moves() && self.format.leader(leader).is_none() {
            let at = digits((lock.value - offset.value) / factor);
            help = format!("{help}, or hold both by the leader alone: `--lock {leader_name}={at}`");
        }
        self.values.report(Code::ChangesMotion, joint.span, message, "locked", help);
    }

    /// The leader of a joint, and where the file puts the joint by it; `None` if the leader moves, or its place is not known.
    fn by_coupling(&mut self, index: usize) -> Option<(usize, Lock)> {
        let (tree, format) = (self.tree, self.format);
        let leader = tree.joint(format.leader(index)?.0)?;
        if self.has_factor_zero(index) {
            let (_, offset) = self.silent(|builder| format.ratio(index, &mut builder.values));
            return Some((leader, Lock { text: offset.text, value: offset.value, ..Lock::at_zero(&tree.joints[index]) }));
        }
        let (mut way, mut on_way, mut at) = (vec![index], BTreeSet::from([index]), leader);
        let mut lock = loop {
            let kind = tree.joints[at].kind;
            if let Some(lock) = self.locks.of(at).filter(|_| kind.moves()) {
                break lock.clone();
            }
            if kind == Kind::Fixed {
                break Lock::at_zero(&tree.joints[at]);
            }
            if !kind.moves() || self.on_path.contains(&at) || !on_way.insert(at) {
                return None;
            }
            let Some((next, _)) = format.leader(at) else {
                // What hangs on no link of the arm is not part of its posture.
                if !self.hangs_on_the_arm(at) {
                    return None;
                }
                break Lock::at_zero(&tree.joints[at]);
            };
            way.push(at);
            at = tree.joint(next)?;
        };
        for &joint in way.iter().rev() {
            lock = self.silent(|builder| follow(tree, format, joint, &lock, &mut builder.values))?;
        }
        Some((leader, lock))
    }

    /// Whether a joint of the arm is above a joint.
    fn hangs_on_the_arm(&self, joint: usize) -> bool {
        let mut at = joint;
        for _ in 0..self.tree.joints.len() {
            let Some(above) = self.tree.links[self.tree.joints[at].parent].above else { return false };
            if self.on_path.contains(&above) {
                return true;
            }
            at = above;
        }
        false
    }

    /// Whether a joint follows another one with the multiplier 0.
    fn has_factor_zero(&mut self, index: usize) -> bool {
        let (factor, _) = self.silent(|builder| builder.format.ratio(index, &mut builder.values));
        factor.is_some_and(|factor| factor.is_zero())
    }

    /// The result of reading something whose faults do not matter.
    fn silent<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        let kept = std::mem::take(self.values.diagnostics);
        let result = read(self);
        *self.values.diagnostics = kept;
        result
    }

    /// Warns of a fixed joint that the file lets follow one that moves.
    pub(super) fn warn_of_fixed_follower(&mut self, index: usize) {
        let Some((leader, (_, span))) = self.moving_leader(index).zip(self.format.leader(index)) else { return };
        let (name, leader) = (shown(&self.tree.joints[index].name), shown(&self.tree.joints[leader].name));
        let message = format!("the joint `{name}` is fixed, and its `mimic` names `{leader}`, which moves");
        let help = "it stands still, as in other programs; if it is to move, its type is `revolute` or `prismatic`";
        self.values.report(Code::ChangesMotion, span, message, "not used", help);
    }

    /// The joint of the chain that moves and that a joint follows, be it through others that no lock holds.
    fn moving_leader(&self, index: usize) -> Option<usize> {
        let mut at = index;
        for _ in 0..self.tree.joints.len() {
            at = self.tree.joint(self.format.leader(at)?.0)?;
            if self.locks.of(at).is_some() {
                return None;
            }
            if self.on_path.contains(&at) && self.tree.joints[at].kind.moves() {
                return Some(at);
            }
        }
        None
    }

    /// The mass of all that hangs on joints, each link once, in kg, for a message; `None` if it is not known.
    fn mass_below(&self, joints: &BTreeSet<usize>) -> Option<f64> {
        let (mut mass, mut links) = (0.0, BTreeSet::new());
        let mut open: Vec<usize> = joints.iter().map(|&joint| self.tree.joints[joint].child).collect();
        while let Some(link) = open.pop() {
            if links.insert(link) {
                mass += self.format.mass(link)?;
                open.extend(self.tree.links[link].below.iter().map(|&joint| self.tree.joints[joint].child));
            }
        }
        Some(mass)
    }
}

/// A number for a message, six digits at most.
fn digits(value: f64) -> String {
    format!("{value:.5e}").parse::<f64>().unwrap_or(value).to_string()
}
