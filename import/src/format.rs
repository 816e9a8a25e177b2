//! The common part of the formats: a tree of links and joints. The numbers of each part are read when the chain needs them.

use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::source::Span;

use crate::body::Body;
use crate::number::Decimal;
use crate::pose::Pose;
use crate::tree::Tree;
use crate::values::Values;
use crate::written::Written;

/// How a joint of the chain moves.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub(crate) axis: [Written; 3],
    /// By how much snapping turned it, rad.
    pub(crate) axis_offset: f64,
    pub(crate) position: Option<[Decimal; 2]>,
    pub(crate) velocity: Option<Decimal>,
    pub(crate) acceleration: Option<Decimal>,
    pub(crate) jerk: Option<Decimal>,
    pub(crate) effort: Option<Decimal>,
    pub(crate) viscous: Option<Decimal>,
    pub(crate) coulomb: Option<Decimal>,
    pub(crate) armature: Option<Decimal>,
    /// Stiffness and rest of a spring.
    pub(crate) spring: Option<(Decimal, Option<Decimal>)>,
}

/// A mass distribution of a link.
pub(crate) struct Part {
    /// Where a link has several.
    pub(crate) name: Option<String>,
    /// The frame that it is given in, in that of the link.
    pub(crate) frame: Vec<Pose>,
    pub(crate) body: Body,
}

/// Which parts of the tree make up the arm.
pub(crate) struct Extent<'r> {
    /// Joints that move.
    pub(crate) moving: &'r [usize],
    /// Joints that the user locks.
    pub(crate) held: &'r BTreeSet<usize>,
    /// Links that move, each with the last joint above it that does.
    pub(crate) carriers: &'r BTreeMap<usize, usize>,
    /// All of it.
    pub(crate) tree: &'r Tree,
}

/// A file of a format; joints and links by their index in the tree. Whatever is read reports its faults.
pub(crate) trait Format {
    /// The format, as the report calls it.
    fn name(&self) -> &'static str;

    /// The frame of a joint in the frame of its parent link, the last element first reached by the child.
    fn origin(&self, joint: usize, values: &mut Values<'_>) -> Vec<Pose>;

    /// The axis of a joint, and by how much it was turned; `None` if faulty.
    fn axis(&self, joint: usize, values: &mut Values<'_>) -> Option<([Written; 3], f64)>;

    /// How a joint of the chain moves.
    fn motion(&self, joint: usize, values: &mut Values<'_>) -> Motion;

    /// Position limits of a joint outside the chain, if it has limits.
    fn range(&self, joint: usize, values: &mut Values<'_>) -> Option<[f64; 2]>;

    /// The kind of a joint in the words of the file.
    fn kind_of(&self, joint: usize) -> String;

    /// The joint that a joint follows.
    fn leader(&self, _joint: usize) -> Option<(&str, Span)> {
        None
    }

    /// Multiplier, if given, and offset of a joint that follows another one.
    fn ratio(&self, _joint: usize, _values: &mut Values<'_>) -> (Option<Decimal>, Decimal) {
        (None, Decimal::zero())
    }

    /// The mass distributions of a link; empty if it lacks one or has a faulty one.
    fn bodies(&self, link: usize, values: &mut Values<'_>) -> Vec<Part>;

    /// Whether the file gives a link a mass distribution.
    fn has_body(&self, link: usize) -> bool;

    /// The mass of a link in kg, for a message; `None` where no number of the file gives it.
    fn mass(&self, link: usize) -> Option<f64>;

    /// Whether a link that moves may do without one.
    fn may_be_massless(&self, _link: usize) -> bool {
        false
    }

    /// A mass distribution of a link that the file gives neither in numbers nor in shapes with a formula: the name of its form.
    fn lacks_body(&self, _link: usize) -> Option<String> {
        None
    }

    /// Gravity in the root link's frame.
    fn gravity(&self, values: &mut Values<'_>) -> [Decimal; 3];

    /// The assumptions about moving joints for absent values of the file: a line for each.
    fn assumed(&self, _moving: &[usize]) -> Vec<String> {
        Vec::new()
    }

    /// The parts that concern the whole arm.
    fn check(&self, extent: &Extent<'_>, diagnostics: &mut Diagnostics);

    /// Elements that are left out, by name.
    fn left_out(&self) -> BTreeMap<String, usize>;
}
