//! The tree of links: the parent of each joint, and the frame that its row starts from.
//!
//! ```text
//! parent: torso   the link of an earlier joint      T_i = T_parent · mount · A_i
//! parent: base    the base                          T_i = base · mount · A_i
//! no parent       the link of the joint before it; of the first one, the base
//! ```
//!
//! Absent from here on: parents behind their children, and names of parents.

use std::collections::BTreeMap;

use super::{call, geometry, Context};
use crate::description::{JointDescription, PoseDescription};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::document::excerpt;
use crate::manipulator::{LinkId, Pose};
use crate::source::Spanned;
use crate::suggest::did_you_mean;

/// The base, where `parent` names it.
pub(super) const BASE: &str = "base";

/// The parent of each joint; `None` in place of a parent for the base. Faults are reported.
pub(super) fn resolve(joints: &[JointDescription], diagnostics: &mut Diagnostics) -> Option<Vec<Option<LinkId>>> {
    let mut places = BTreeMap::new();
    for (i, joint) in joints.iter().enumerate() {
        if let Some(name) = &joint.name {
            // Of a name that stands twice, which is reported, the first one counts.
            places.entry(name.value.as_str()).or_insert(i);
        }
    }
    let mut parents = Some(Vec::new());
    for (i, joint) in joints.iter().enumerate() {
        let parent = match &joint.parent {
            None => Some(i.checked_sub(1)),
            Some(name) if name.value == BASE => Some(None),
            Some(name) => match places.get(name.value.as_str()) {
                Some(&place) if place < i => Some(Some(place)),
                Some(&place) => {
                    diagnostics.push(late(i, joint, name, &joints[place]));
                    None
                }
                None => {
                    diagnostics.push(unknown(i, joint, name, &joints[..i]));
                    None
                }
            },
        };
        if let (Some(mount), None) = (&joint.mount, &joint.parent) {
            diagnostics.push(mount_alone(i, joint, mount));
            parents = None;
        }
        let link = |place: usize| LinkId(u32::try_from(place).expect("the number of joints is bounded"));
        parents = parents.zip(parent).map(|(mut all, parent)| {
            all.push(parent.map(link));
            all
        });
    }
    parents
}

/// A parent that does not precede its child.
fn late(i: usize, joint: &JointDescription, name: &Spanned<String>, parent: &JointDescription) -> Diagnostic {
    let (called, shown) = (call(i, joint), excerpt(&name.value));
    let own = joint.name.as_ref().is_some_and(|own| own.value == name.value);
    let (message, help) = match own {
        true => (
            format!("joint {called} is its own parent"),
            "name the joint whose link carries it, or `base`; leave `parent` out for the joint before it".to_owned(),
        ),
        false => (
            format!("the parent of joint {called} is further down in the list"),
            format!("write `{shown}` above {called}: a parent precedes its children"),
        ),
    };
    let fault = Diagnostic::new(Code::LateParent, name.span, message, "not above this joint", help);
    match parent.name.as_ref().filter(|_| !own) {
        Some(place) => fault.also(place.span, "its parent"),
        None => fault,
    }
}

/// A parent that does not exist.
fn unknown(i: usize, joint: &JointDescription, name: &Spanned<String>, before: &[JointDescription]) -> Diagnostic {
    let shown = excerpt(&name.value);
    let mut names: Vec<&str> = before.iter().filter_map(|joint| joint.name.as_ref()).map(|name| name.value.as_str()).collect();
    names.push(BASE);
    let help = match did_you_mean(&name.value, &names) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => "name a joint above this one, or `base`; leave `parent` out for the joint before it".into(),
    };
    let message = format!("the parent of joint {} is `{shown}`, which is no joint", call(i, joint));
    Diagnostic::new(Code::UnknownParent, name.span, message, "unknown joint", help)
}

/// A pose of a row that begins no branch.
fn mount_alone(i: usize, joint: &JointDescription, mount: &PoseDescription) -> Diagnostic {
    let message = format!("joint {} has `mount` and no `parent`", call(i, joint));
    let help = match i {
        0 => "write the pose under `base`, or add `parent: base`",
        _ => "add `parent`, the joint in whose link frame the pose is given",
    };
    Diagnostic::new(Code::MountWithoutParent, mount.key, message, "in the frame of which link?", help)
}

/// The pose in the parent's link frame, or in the base frame, that the row starts from; `base` is that of the file.
pub(super) fn start(joint: &JointDescription, called: &str, base: Option<&Pose>, context: &mut Context<'_>) -> Option<Pose> {
    let mount = geometry::pose(joint.mount.as_ref(), &format!("the mount of joint {called}"), context)?;
    let elements = base.map_or(&[][..], |base| &base.elements).iter().chain(&mount.elements);
    Some(Pose::new(elements.cloned().collect()))
}
