//! Joints that stand still: where, and the pose that this is.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::document::parse_expression;
use armgen_codegen::document::yaml::Scalar;
use armgen_codegen::source::Span;

use super::{AxisAngle, Pose, Turn};
use crate::number::Decimal;
use crate::snap::Written;
use crate::tree::{Kind, Tree};
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

/// What the user holds.
pub(crate) struct Locks<'r> {
    by_joint: BTreeMap<usize, Lock>,
    _options: &'r [(String, String)],
}

impl<'r> Locks<'r> {
    /// The locks of the options; faults are reported.
    pub(crate) fn new(tree: &Tree<'_, '_>, options: &'r [(String, String)], diagnostics: &mut Diagnostics) -> Option<Locks<'r>> {
        let mut by_joint = BTreeMap::new();
        let before = diagnostics.errors();
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
        (diagnostics.errors() == before).then_some(Locks { by_joint, _options: options })
    }

    /// The lock of a joint.
    pub(crate) fn of(&self, joint: usize) -> Option<&Lock> {
        self.by_joint.get(&joint)
    }
}

/// Where a joint stands that follows another one: factor · leader + offset.
pub(crate) fn follow(zero: Lock, leader: Option<&Lock>, factor: Option<&Decimal>, offset: &Decimal) -> Lock {
    let (factor_text, factor) = factor.map_or(("1", 1.0), |factor| (factor.text.as_str(), factor.value));
    let (text, value) = match leader.filter(|leader| leader.value != 0.0 && factor != 0.0) {
        Some(leader) => (format!("({factor_text})*({}) + ({})", leader.text, offset.text), factor * leader.value + offset.value),
        None => (offset.text.clone(), offset.value),
    };
    Lock { text, value, ..zero }
}

/// The pose that a joint makes which stands elsewhere than at 0.
pub(crate) fn pose(kind: Kind, axis: [Written; 3], offset: f64, lock: &Lock) -> Pose {
    let zero = || std::array::from_fn(|_| Written::zero());
    if kind != Kind::Prismatic {
        return Pose {
            xyz: zero(),
            turn: Turn::AxisAngle(AxisAngle { axis, axis_offset: offset, angle: lock.text.clone(), value: lock.value }),
        };
    }
    let length = axis.iter().map(|x| x.value * x.value).sum::<f64>().sqrt();
    let given = axis.iter().filter(|x| !x.is_zero()).count();
    let squares: Vec<String> = axis.iter().filter(|x| !x.is_zero()).map(|x| format!("({0})*({0})", x.text)).collect();
    let xyz = axis.map(|x| {
        let text = match (given, x.value) {
            (_, 0.0) => "0".to_owned(),
            (1, v) if v > 0.0 => lock.text.clone(),
            (1, _) => format!("-({})", lock.text),
            _ => format!("({})*({})/sqrt({})", lock.text, x.text, squares.join(" + ")),
        };
        let value = if x.is_zero() { 0.0 } else { lock.value * x.value / length };
        Written { text, value, offset: offset * lock.value.abs(), twelfths: None, span: lock.span }
    });
    Pose { xyz, turn: Turn::Rpy(zero()) }
}
