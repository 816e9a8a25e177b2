//! Joints that stand still: where, and the pose that this is.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::Diagnostic;
use armgen_codegen::document::parse_expression;
use armgen_codegen::document::yaml::Scalar;
use armgen_codegen::source::Span;

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
    /// Of a joint that stands at 0.
    pub(crate) fn at_zero(joint: &Joint) -> Lock {
        Lock { joint: joint.name.clone(), text: "0".into(), value: 0.0, span: joint.span }
    }
}

/// What the user holds.
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
        for (follower, joint) in tree.joints.iter().enumerate().filter(|(_, joint)| joint.kind.moves()) {
            let leader = format.leader(follower).and_then(|(leader, _)| tree.joint(leader));
            let at = leader.and_then(|leader| by_joint.get(&leader)).cloned();
            if let (Some(at), false) = (at, by_joint.contains_key(&follower)) {
                let (factor, offset) = format.ratio(follower, values);
                let lock = follow(Lock::at_zero(joint), Some(&at), factor.as_ref(), &offset);
                by_joint.insert(follower, lock);
            }
        }
        (values.diagnostics.errors() == before).then_some(Locks { by_joint })
    }

    /// The lock of a joint.
    pub(crate) fn of(&self, joint: usize) -> Option<&Lock> {
        self.by_joint.get(&joint)
    }
}

/// Where a joint stands that follows another one: factor · leader + offset.
pub(crate) fn follow(zero: Lock, leader: Option<&Lock>, ratio: Option<&Decimal>, offset: &Decimal) -> Lock {
    let (by, times) = ratio.map_or(("1", 1.0), |ratio| (ratio.text.as_str(), ratio.value));
    let (text, value) = match leader.filter(|leader| leader.value != 0.0 && times != 0.0) {
        Some(leader) => (follower(by, &leader.text, offset), times * leader.value + offset.value),
        None => (offset.text.clone(), offset.value),
    };
    Lock { text, value, ..zero }
}

/// factor · leader + offset as an expression.
fn follower(by: &str, leader: &str, offset: &Decimal) -> String {
    let turned = if by == "1" { leader.to_owned() } else { format!("{}*{}", factor(by), factor(leader)) };
    if offset.is_zero() {
        turned
    } else {
        format!("{turned} + {}", factor(&offset.text))
    }
}
