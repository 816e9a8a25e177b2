//! Points that two links are to share in every posture. Whether they do only the equations show.
//!
//! Absent from here on: names of joints that do not exist.

use super::choices::carrier;
use super::parents::BASE;
use super::places::Closure;
use super::{zeros, Context};
use crate::description::{ClosureDescription, JointDescription, RobotDescription, Value};
use crate::document::excerpt;
use crate::exact::Polynomial;
use crate::manipulator::LinkId;
use crate::source::Spanned;

/// The points; `None` after a fault.
pub(super) fn closures(description: &RobotDescription, context: &mut Context<'_>) -> Option<Vec<Closure>> {
    let joints = description.joints.as_ref().map_or(&[][..], |joints| &joints.value);
    // Each is read, so that all faults are reported.
    let all: Vec<Option<Closure>> = description.closes.iter().map(|one| closure(one, joints, context)).collect();
    all.into_iter().collect()
}

fn closure(description: &ClosureDescription, joints: &[JointDescription], context: &mut Context<'_>) -> Option<Closure> {
    let ClosureDescription { name, joint, at, with, there, .. } = description;
    let (one, other) = (end("joint", joint, at, joints, context), end("with", with, there, joints, context));
    let (joint, with) = (joint.as_ref()?, with.as_ref()?);
    let name = match name {
        Some(name) => format!("`{}`", excerpt(&name.value)),
        None => format!("of `{}` and `{}`", excerpt(&joint.value), excerpt(&with.value)),
    };
    Some(Closure { name, ends: [one?, other?], spans: [joint.span, with.span] })
}

/// The link that `key` names, and the point in its frame.
fn end(
    key: &str,
    named: &Option<Spanned<String>>,
    point: &Option<Spanned<[Value; 3]>>,
    joints: &[JointDescription],
    context: &mut Context<'_>,
) -> Option<(Option<LinkId>, [Polynomial; 3])> {
    let point = point.as_ref().map_or_else(|| Some(zeros()), |point| context.polynomials(&point.value));
    let named = named.as_ref()?;
    if named.value == BASE {
        return Some((None, point?));
    }
    let link = carrier(joints, named, key, "name the joint whose link has the point, or `base`", context.diagnostics);
    Some((Some(link?), point?))
}
