//! Places of the parts of an arm in its file, for diagnostics about its equations.

pub use crate::description::Role;
use crate::description::{RegressorDescription, RobotDescription};
use crate::exact::Polynomial;
use crate::kinds::TaskRow;
use crate::manipulator::LinkId;
use crate::source::{Span, Spanned};

/// Places of an arm's parts, in the order of the [`Manipulator`](crate::manipulator::Manipulator).
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// The robot's name.
    pub name: Span,
    /// The value of `gravity`.
    pub gravity: Span,
    /// Per joint.
    pub joints: Vec<JointPlaces>,
    /// Per end effector the rows of `task`, or the key where it has none; `None` if the file has no such key.
    pub tasks: Vec<Option<Span>>,
    /// The key `regressor`, if the file has it.
    pub regressor: Option<Span>,
    /// The names that it lists, in its order.
    pub regressor_names: Vec<Span>,
    /// Definitions of the names that are symbols, by [`ParameterId`](crate::kinds::ParameterId).
    pub parameters: Vec<Span>,
    /// Occurrences of the names in expressions, abbreviations included, by [`ParameterId`](crate::kinds::ParameterId).
    pub uses: Vec<Vec<Occurrence>>,
    /// Points that two links are to share in every posture.
    pub closures: Vec<Closure>,
}

/// A point that two links are to share in every posture.
#[derive(Clone, Debug)]
pub struct Closure {
    /// Its name, or those of the two joints.
    pub name: String,
    /// For both links the link, `None` for the base, and the point in its frame.
    pub ends: [(Option<LinkId>, [Polynomial; 3]); 2],
    /// Where the two links are named.
    pub spans: [Span; 2],
}

/// Places of a joint's parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointPlaces {
    /// Its name.
    pub name: Span,
    /// The key `link`.
    pub link: Span,
    /// The link's mass.
    pub mass: Span,
    /// The key `motor`.
    pub motor: Option<Span>,
}

/// A place where a name enters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occurrence {
    /// The name.
    pub span: Span,
    /// The quantity that it is a part of.
    pub role: Role,
}

/// The rows of a task, or its key.
fn task(task: Option<&Spanned<Vec<Spanned<TaskRow>>>>) -> Option<Span> {
    task.map(|task| task.value.iter().map(|row| row.span).reduce(Span::to).unwrap_or(task.span))
}

/// The places of a valid description, whose names that stay symbols stand and are used at `symbols`.
pub(super) fn gather(description: &RobotDescription, symbols: Vec<(Span, Vec<Occurrence>)>, closures: Vec<Closure>) -> Places {
    let joints = description.joints.iter().flat_map(|joints| &joints.value);
    let (parameters, uses) = symbols.into_iter().unzip();
    Places {
        name: description.name.as_ref().map_or_else(Span::default, |n| n.span),
        gravity: description.gravity.as_ref().map_or_else(Span::default, |g| g.span),
        joints: joints
            .map(|joint| {
                let link = joint.link.as_ref();
                JointPlaces {
                    name: joint.name.as_ref().map_or(joint.span, |n| n.span),
                    link: link.map_or(joint.span, |l| l.key),
                    mass: link.and_then(|l| l.mass.as_ref()).map_or(joint.span, |m| m.span),
                    motor: joint.motor.as_ref().map(|m| m.key),
                }
            })
            .collect(),
        tasks: match &description.tips {
            Some(tips) => tips.value.iter().map(|tip| task(tip.task.as_ref())).collect(),
            None => vec![task(description.task.as_ref())],
        },
        regressor: description.regressor.as_ref().map(|r| r.span),
        regressor_names: match description.regressor.as_ref().map(|r| &r.value) {
            Some(RegressorDescription::Names(names)) => names.iter().map(|n| n.span).collect(),
            _ => Vec::new(),
        },
        parameters,
        uses,
        closures,
    }
}
