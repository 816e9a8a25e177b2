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
use crate::tree::{Joint, Tree};
use crate::values::Values;
use crate::xml::{beginning, shown};
use crate::Code;

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

/// The joints that the user locks.
pub(crate) struct Locks {
    by_joint: BTreeMap<usize, Lock>,
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
        let mut open: Vec<(usize, Lock)> = by_joint.iter().map(|(joint, lock): (&usize, &Lock)| (*joint, lock.clone())).collect();
        while let Some((leader, at)) = open.pop() {
            for &follower in followers.get(&leader).into_iter().flatten() {
                if by_joint.contains_key(&follower) {
                    continue;
                }
                let Some(lock) = follow(tree, format, follower, &at, values) else { continue };
                by_joint.insert(follower, lock.clone());
                open.push((follower, lock));
            }
        }
        (values.diagnostics.errors() == before).then_some(Locks { by_joint })
    }

    /// The lock of a joint.
    pub(crate) fn of(&self, joint: usize) -> Option<&Lock> {
        self.by_joint.get(&joint)
    }
}

/// The value of an unlocked joint outside the chain that follows others.
#[derive(Clone, Debug)]
pub(super) enum Led {
    At(Lock),
    /// With this joint of the chain, which moves.
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
            let Some((leader, span)) = format.leader(at) else { break Led::At(Lock::at_zero(&tree.joints[at])) };
            if !on_way.insert(at) {
                self.report_ring(&way, at, span);
                break Led::Faulty;
            }
            let Some(next) = tree.joint(leader) else {
                self.report_unknown(at, leader, span);
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
                let mass = self.mass_below(index);
                let but = if mass > 0.0 {
                    format!("; its {mass} kg then do not move with `{leader}`, which changes torques")
                } else {
                    String::new()
                };
                let help = format!("lock it where it is to stand: `--lock {name}=0`{but}");
                self.values.report(Code::Mimic, span, format!("the joint `{name}` follows `{leader}`, which moves"), "", help);
                None
            }
        }
    }

    /// Reports joints that follow each other: those on a way from one on that is met again.
    fn report_ring(&mut self, way: &[usize], again: usize, span: Span) {
        let ring = way.iter().skip_while(|joint| **joint != again);
        let names: Vec<String> = ring.take(8).map(|&joint| format!("`{}`", shown(&self.tree.joints[joint].name))).collect();
        let message = format!("joints follow each other in a ring: {}", names.join(", "));
        let help = format!("lock one of them where it is to stand: `--lock {}=0`", shown(&self.tree.joints[again].name));
        self.values.report(Code::Mimic, span, message, "", help);
    }

    /// Reports a joint whose leader does not exist.
    fn report_unknown(&mut self, follower: usize, leader: &str, span: Span) {
        let message = format!("`mimic` names `{}`, which is no joint of this file", shown(leader));
        let (meant, name) = (self.tree.meant_joint(leader), shown(&self.tree.joints[follower].name));
        let help = format!("{meant}; or lock it where it is to stand: `--lock {name}=0`");
        self.values.report(Code::UnknownJoint, span, message, "", help);
    }
}

/// Where a joint stands whose leader stands; faults are reported.
fn follow(tree: &Tree, format: &dyn Format, follower: usize, leader: &Lock, values: &mut Values<'_>) -> Option<Lock> {
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
