//! From base to tip: which joints move, what stands between them, and which bodies each link is made of.
//!
//! A fixed or locked joint is one more pose; what hangs on a moving link beside the chain is attached to it. Nothing is multiplied out here.

mod bodies;
mod gravity;
mod locks;
mod tips;
mod values;

use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::kinds::MAX_JOINTS;
use armgen_codegen::source::{Source, Span};
use armgen_codegen::validate::{is_free_name, is_rust_name};

use crate::number::Decimal;
use crate::snap::{Snap, Written};
use crate::tree::{Kind, Tree};
use crate::xml::{beginning, child, place, shown};
use crate::{Code, Options};
pub(crate) use bodies::{Body, ELEMENTS};
pub(crate) use locks::Lock;
use values::Values;

/// Poses in one list of robot.yaml.
const MAX_POSES: usize = 60;
/// Bodies of an arm: beyond, robot.yaml would be longer than may be read.
const MAX_BODIES: usize = 1000;

/// A translation and a rotation.
#[derive(Clone, Debug)]
pub(crate) struct Pose {
    pub(crate) xyz: [Written; 3],
    pub(crate) turn: Turn,
}

/// A rotation.
#[derive(Clone, Debug)]
pub(crate) enum Turn {
    /// About fixed x, y, z.
    Rpy([Written; 3]),
    /// About an axis, by an expression.
    AxisAngle(AxisAngle),
}

/// A rotation about an axis.
#[derive(Clone, Debug)]
pub(crate) struct AxisAngle {
    pub(crate) axis: [Written; 3],
    /// By how much snapping turned the axis, rad.
    pub(crate) axis_offset: f64,
    /// The angle, an expression.
    pub(crate) angle: String,
    /// Its value.
    pub(crate) value: f64,
}

impl Pose {
    /// By how much snapping turned it at most, rad.
    pub(crate) fn turned(&self) -> f64 {
        match &self.turn {
            Turn::Rpy(rpy) => rpy.iter().map(|angle| angle.offset).sum(),
            Turn::AxisAngle(turn) => 2.0 * turn.axis_offset,
        }
    }

    /// Whether it is the identity in the file, too.
    fn is_nothing(&self) -> bool {
        self.is_identity() && self.turned() == 0.0 && self.xyz.iter().all(|x| x.offset == 0.0)
    }

    /// Whether it is the identity in robot.yaml.
    pub(crate) fn is_identity(&self) -> bool {
        let still = match &self.turn {
            Turn::Rpy(rpy) => rpy.iter().all(Written::is_zero),
            Turn::AxisAngle(..) => false,
        };
        still && self.xyz.iter().all(Written::is_zero)
    }
}

/// A body that is fixed to a moving link.
#[derive(Clone, Debug)]
pub(crate) struct Attached {
    pub(crate) link: String,
    pub(crate) origin: Vec<Pose>,
    pub(crate) body: Body,
    pub(crate) span: Span,
}

/// A moving joint with its link.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// In robot.yaml.
    pub(crate) name: String,
    /// In the file.
    pub(crate) joint: String,
    pub(crate) link: String,
    pub(crate) span: Span,
    pub(crate) prismatic: bool,
    pub(crate) origin: Vec<Pose>,
    pub(crate) axis: [Written; 3],
    /// By how much snapping turned it, rad.
    pub(crate) axis_offset: f64,
    pub(crate) position: Option<[Decimal; 2]>,
    pub(crate) velocity: Option<Decimal>,
    pub(crate) effort: Option<Decimal>,
    pub(crate) viscous: Option<Decimal>,
    pub(crate) coulomb: Option<Decimal>,
    /// The link's own body, if the file gives it one.
    pub(crate) body: Option<Body>,
    pub(crate) attached: Vec<Attached>,
    /// Whether a body of it has faults, which are reported.
    unreadable: bool,
}

/// The chain.
#[derive(Debug)]
pub(crate) struct Arm {
    pub(crate) name: String,
    pub(crate) robot: String,
    pub(crate) base: String,
    pub(crate) tip: String,
    pub(crate) gravity: [String; 3],
    /// Whether these are rounded.
    pub(crate) gravity_rounded: bool,
    /// By how much snapping turned it, rad.
    pub(crate) gravity_offset: f64,
    pub(crate) rows: Vec<Row>,
    pub(crate) tool: Vec<Pose>,
    pub(crate) snap: Snap,
    pub(crate) locked: Vec<Lock>,
    /// Links that were given no mass distribution and are taken to have mass 0.
    pub(crate) massless: Vec<String>,
    /// Joints of the base that do not move anything of the chain.
    pub(crate) left_out_branches: usize,
    /// Notes for the user.
    pub(crate) notes: Vec<String>,
}

/// What is being put together.
struct Builder<'r, 'a, 'i> {
    tree: &'r Tree<'a, 'i>,
    locks: locks::Locks<'r>,
    values: Values<'r>,
    /// Which joints lie on the chain.
    on_path: BTreeSet<usize>,
    locked: Vec<Lock>,
    massless: Vec<String>,
    options: &'r Options,
    bodies: usize,
}

/// The chain of a tree; faults are reported.
pub(crate) fn arm(source: &Source, tree: &Tree<'_, '_>, options: &Options, diagnostics: &mut Diagnostics) -> Option<Arm> {
    let locks = locks::Locks::new(tree, &options.lock, diagnostics)?;
    let base = named_link(tree, options.base.as_deref(), "--base", diagnostics)?;
    let base = match base {
        Some(base) => base,
        None => tree.only_root(diagnostics)?,
    };
    let tip = named_link(tree, options.tip.as_deref(), "--tip", diagnostics)?;
    let (tip, notes) = match tip {
        Some(tip) => (tip, Vec::new()),
        None => tips::only(tree, base, &locks, diagnostics)?,
    };
    let Some(path) = tree.path(base, tip) else {
        let (from, to) = (tree.links[base].name, tree.links[tip].name);
        let message = format!("the link `{}` is not below `{}`", shown(to), shown(from));
        let way = tips::way_up(tree, tip);
        let below = format!("a link below `{}` as `--tip`", shown(from));
        let help = match way {
            Some(way) => format!("above it are {way}: take one of them as `--base`, or {below}"),
            None => format!("it hangs on nothing: take {below}"),
        };
        let fault = Diagnostic::new(Code::NotBelow, place(tree.links[tip].node), message, "this is to be the tip", help);
        diagnostics.push(fault.also(place(tree.links[base].node), "this is to be the base"));
        return None;
    };
    let moving: Vec<usize> = path.iter().copied().filter(|&j| tree.joints[j].kind.moves() && locks.of(j).is_none()).collect();
    if let Some(&joint) = moving.get(MAX_JOINTS) {
        let message =
            format!("{} joints move between base and tip, more than the {MAX_JOINTS} that can be generated", moving.len());
        let help = "lock some with `--lock JOINT=0`, or choose another `--base` or `--tip`";
        diagnostics.push(Diagnostic::new(Code::TooManyJoints, tree.joints[joint].span, message, "one too many", help));
        return None;
    }
    warn_of_simulation(tree, diagnostics);
    let values = Values { source, diagnostics, snap: Snap::new(options.snap) };
    let on_path = path.iter().copied().collect();
    let mut builder = Builder { tree, locks, values, on_path, locked: Vec::new(), massless: Vec::new(), options, bodies: 0 };
    let (rows, tool) = builder.rows(&path)?;
    if rows.is_empty() && !builder.values.diagnostics.has_errors() {
        let message = format!("nothing moves between `{}` and `{}`", shown(tree.links[base].name), shown(tree.links[tip].name));
        let help = "choose a `--tip` below a joint that turns or slides";
        builder.values.report(Code::NoJoints, place(tree.links[tip].node), message, "", help);
        return None;
    }
    let (gravity, gravity_rounded, gravity_offset) = builder.gravity(base)?;
    let first = path.iter().position(|joint| moving.first() == Some(joint)).unwrap_or(0);
    let on_base = path[..first].iter().map(|&j| tree.joints[j].parent).chain(path.get(first).map(|&j| tree.joints[j].parent));
    let left_out_branches =
        on_base.flat_map(|link| &tree.links[link].below).filter(|joint| !builder.on_path.contains(joint)).count();
    builder.values.warn_of_near_angles();
    let Builder { values, locked, massless, .. } = builder;
    let robot_name = options.name.clone().unwrap_or_else(|| identifier(tree.name, &mut BTreeSet::new(), is_rust_name));
    Some(Arm {
        name: robot_name,
        robot: tree.name.to_owned(),
        base: tree.links[base].name.to_owned(),
        tip: tree.links[tip].name.to_owned(),
        gravity,
        gravity_rounded,
        gravity_offset,
        rows,
        tool,
        snap: values.snap,
        locked,
        massless,
        left_out_branches,
        notes,
    })
}

/// The link that an option names, `Some(None)` if the option is not given.
fn named_link(tree: &Tree<'_, '_>, name: Option<&str>, option: &str, diagnostics: &mut Diagnostics) -> Option<Option<usize>> {
    let Some(name) = name else { return Some(None) };
    let found = tree.link(name);
    if found.is_none() {
        let message = format!("`{option}` names `{}`, which is no link of this file", shown(name));
        diagnostics.push(Diagnostic::new(Code::UnknownLink, beginning(), message, "", tree.meant_link(name)));
    }
    found.map(Some)
}

/// An identifier that has not been taken yet.
fn identifier(name: &str, taken: &mut BTreeSet<String>, free: fn(&str) -> bool) -> String {
    let mut plain: String = name.chars().take(100).map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.starts_with(|c: char| c.is_ascii_digit()) || plain.chars().all(|c| c == '_') {
        plain.insert(0, '_');
        plain = plain.replace("__", "_x");
    }
    let mut chosen = plain.clone();
    for count in 2.. {
        if free(&chosen) && !taken.contains(&chosen) {
            break;
        }
        chosen = format!("{plain}_{count}");
    }
    taken.insert(chosen.clone());
    chosen
}

impl Builder<'_, '_, '_> {
    /// Rows of the moving joints, and the poses after the last one.
    fn rows(&mut self, path: &[usize]) -> Option<(Vec<Row>, Vec<Pose>)> {
        let tree = self.tree;
        let mut rows: Vec<Row> = Vec::new();
        let mut pending: Vec<Pose> = Vec::new();
        let mut names = BTreeSet::new();
        for &index in path {
            let joint = &tree.joints[index];
            let origin = self.values.origin(joint.node, "the origin of a joint");
            let moves = joint.kind.moves() && self.locks.of(index).is_none();
            if moves {
                self.refuse_mimic(index);
                pending.extend(origin);
                pending.retain(|pose| !pose.is_nothing());
                let mut row = self.row(index, std::mem::take(&mut pending));
                row.name = identifier(joint.name, &mut names, is_free_name);
                rows.push(row);
            } else {
                pending.extend(origin);
                let locked = self.standing(index, true);
                pending.extend(locked);
            }
            pending.retain(|pose| !pose.is_nothing());
            self.check_length(&pending, joint.span)?;
            if let Some(row) = rows.last_mut() {
                let own = moves.then_some(joint.child);
                let (body, attached, unreadable) = self.bodies(joint.child, &pending, own)?;
                row.body = row.body.take().or(body);
                row.unreadable |= unreadable;
                row.attached.extend(attached);
            }
        }
        for row in &mut rows {
            self.complete(row);
        }
        Some((rows, pending))
    }

    /// Reports a list of poses that robot.yaml would not take.
    fn check_length(&mut self, poses: &[Pose], span: Span) -> Option<()> {
        if poses.len() <= MAX_POSES {
            return Some(());
        }
        let message = format!("more than {MAX_POSES} fixed joints stand one after another");
        self.values.report(Code::TooLarge, span, message, "", "write several fixed joints as one");
        None
    }

    /// A joint that follows another one cannot move by itself.
    fn refuse_mimic(&mut self, index: usize) {
        let joint = &self.tree.joints[index];
        if let Some(mimic) = child(joint.node, "mimic") {
            let message = format!("the joint `{}` of the chain follows another one", shown(joint.name));
            let help = format!("lock it where it is to stand: `--lock {}=0`", shown(joint.name));
            self.values.report(Code::Mimic, place(mimic), message, "", help);
        }
    }

    /// A moving joint without its bodies.
    fn row(&mut self, index: usize, origin: Vec<Pose>) -> Row {
        let joint = &self.tree.joints[index];
        let (axis, axis_offset) =
            self.values.axis(joint.node, joint.name).unwrap_or_else(|| (std::array::from_fn(|_| Written::zero()), 0.0));
        let limit = child(joint.node, "limit");
        let mut optional = |node: Option<roxmltree::Node<'_, '_>>, name: &str| {
            node.and_then(|node| self.values.scalar(node, name, &format!("`{name}` of joint `{}`", shown(joint.name))))
        };
        let (lower, upper) = (optional(limit, "lower"), optional(limit, "upper"));
        let (velocity, effort) = (optional(limit, "velocity"), optional(limit, "effort"));
        let dynamics = child(joint.node, "dynamics");
        let (viscous, coulomb) = (optional(dynamics, "damping"), optional(dynamics, "friction"));
        let position = match limit {
            Some(limit) if joint.kind != Kind::Continuous => self.values.position(limit, lower, upper, joint.name),
            _ => None,
        };
        let velocity = self.values.largest(velocity, "velocity", joint.name);
        let effort = self.values.largest(effort, "effort", joint.name);
        let viscous = self.values.coefficient(viscous, joint.name);
        let coulomb = self.values.coefficient(coulomb, joint.name);
        Row {
            name: String::new(),
            joint: joint.name.to_owned(),
            link: self.tree.links[joint.child].name.to_owned(),
            span: joint.span,
            prismatic: joint.kind == Kind::Prismatic,
            origin,
            axis,
            axis_offset,
            position,
            velocity,
            effort,
            viscous,
            coulomb,
            body: None,
            attached: Vec::new(),
            unreadable: false,
        }
    }

    /// Where a joint that stands still has its child, beyond its origin.
    fn standing(&mut self, index: usize, on_path: bool) -> Option<Pose> {
        let joint = &self.tree.joints[index];
        let lock = self.locks.of(index).cloned();
        if joint.kind == Kind::Fixed {
            // One that says that it follows another one contradicts itself where that one moves.
            if !on_path && lock.is_none() {
                self.following(index);
            }
            return None;
        }
        if joint.kind == Kind::Other {
            if lock.as_ref().is_none_or(|lock| lock.value != 0.0) {
                let word = joint.node.attribute("type").unwrap_or_default();
                let message =
                    format!("the joint `{}` is `{}`, which is no joint about or along one axis", shown(joint.name), shown(word));
                let help = match on_path {
                    true => format!("begin the arm below it with `--base`, or hold it: `--lock {}=0`", shown(joint.name)),
                    false => format!("hold it: `--lock {}=0`", shown(joint.name)),
                };
                self.values.report(Code::UnsupportedJoint, joint.span, message, "", help);
            }
            return None;
        }
        let lock = match lock {
            Some(lock) => lock,
            None => self.following(index)?,
        };
        self.values.warn_outside(joint, &lock);
        self.locked.push(lock.clone());
        if lock.value == 0.0 {
            return None;
        }
        let (axis, offset) = self.values.axis(joint.node, joint.name)?;
        Some(locks::pose(joint.kind, axis, offset, &lock))
    }

    /// Where a joint beside the chain stands that is not locked: at 0, or where the joint that it follows makes it.
    fn following(&mut self, index: usize) -> Option<Lock> {
        let joint = &self.tree.joints[index];
        let zero = Lock { joint: joint.name.to_owned(), text: "0".into(), value: 0.0, span: joint.span };
        let Some(mimic) = child(joint.node, "mimic") else { return Some(zero) };
        let leader = mimic.attribute("joint").unwrap_or_default();
        let Some(found) = self.tree.joint(leader) else {
            let message = format!("`mimic` names `{}`, which is no joint of this file", shown(leader));
            let help = self.tree.meant_joint(leader);
            self.values.report(Code::UnknownJoint, place(mimic), message, "", help);
            return None;
        };
        let factor = self.values.scalar(mimic, "multiplier", "the multiplier of `mimic`");
        let offset = self.values.scalar(mimic, "offset", "the offset of `mimic`").unwrap_or_else(Decimal::zero);
        let at = self.locks.of(found).cloned();
        if at.is_none() && self.on_path.contains(&found) && self.tree.joints[found].kind.moves() {
            let message = format!("the joint `{}` follows `{}`, which moves", shown(joint.name), shown(leader));
            let help = format!("lock it where it is to stand: `--lock {}=0`", shown(joint.name));
            self.values.report(Code::Mimic, place(mimic), message, "", help);
            return None;
        }
        Some(locks::follow(zero, at.as_ref(), factor.as_ref(), &offset))
    }

    /// What hangs on a link without moving against it: its own body if it is the moving link, and the others with their poses.
    fn bodies(&mut self, link: usize, at: &[Pose], own: Option<usize>) -> Option<(Option<Body>, Vec<Attached>, bool)> {
        let tree = self.tree;
        let (mut body, mut attached, mut unreadable) = (None, Vec::new(), false);
        let mut open = vec![(link, at.to_vec())];
        while let Some((link, poses)) = open.pop() {
            let found = self.values.body(tree.links[link].node, tree.links[link].name);
            self.bodies += usize::from(found.is_some());
            if self.bodies > MAX_BODIES {
                let span = place(tree.links[link].node);
                self.values.report(
                    Code::TooLarge,
                    span,
                    format!("the arm has more than {MAX_BODIES} bodies"),
                    "",
                    "join bodies that are fixed to each other",
                );
                return None;
            }
            match found {
                Some(found) if own == Some(link) => body = Some(found),
                Some(body) => {
                    let span = place(tree.links[link].node);
                    attached.push(Attached { link: tree.links[link].name.to_owned(), origin: poses.clone(), body, span });
                }
                None => unreadable |= child(tree.links[link].node, "inertial").is_some(),
            }
            let beside: Vec<usize> = tree.links[link].below.iter().rev().copied().filter(|j| !self.on_path.contains(j)).collect();
            for below in beside {
                let joint = &tree.joints[below];
                let mut poses = poses.clone();
                poses.extend(self.values.origin(joint.node, "the origin of a joint"));
                let locked = self.standing(below, false);
                poses.extend(locked);
                poses.retain(|pose| !pose.is_nothing());
                self.check_length(&poses, joint.span)?;
                open.push((joint.child, poses));
            }
        }
        Some((body, attached, unreadable))
    }

    /// A moving link has a mass distribution.
    fn complete(&mut self, row: &mut Row) {
        if row.body.is_some() || !row.attached.is_empty() || row.unreadable {
            return;
        }
        if self.options.massless {
            let span = place(self.tree.links[self.tree.link(&row.link).expect("it is one of the tree")].node);
            let message = format!("the moving link `{}` is taken to have no mass", shown(&row.link));
            self.values.report(Code::NoMass, span, message, "", "give its mass, centre and inertia where forces matter");
            self.massless.push(row.link.clone());
            return;
        }
        let link = self.tree.link(&row.link).expect("it is one of the tree");
        let message = format!("the moving link `{}` has no `inertial`, and nothing that is fixed to it has", shown(&row.link));
        let help = "give its mass, centre and inertia; with `--massless` its mass is 0, which is enough for kinematics";
        self.values.report(Code::MissingInertial, place(self.tree.links[link].node), message, "moves", help);
    }
}

/// Warns of what a simulator would take into account, and robot.yaml does not.
fn warn_of_simulation(tree: &Tree<'_, '_>, diagnostics: &mut Diagnostics) {
    const FELT: [&str; 6] = [
        "springStiffness",
        "springReference",
        "implicitSpringDamper",
        "disableFixedJointLumping",
        "preserveFixedJoint",
        "gravity",
    ];
    for node in tree.root.children().filter(|n| n.is_element() && n.tag_name().name() == "gazebo") {
        for felt in node.descendants().filter(|n| n.is_element() && FELT.contains(&n.tag_name().name())) {
            let message = format!("`{}` may change how a simulator moves the arm; it is left out", felt.tag_name().name());
            let help = "springs and the like are no part of a description of a rigid arm: add their torques yourself";
            diagnostics.push(Diagnostic::new(Code::ChangesMotion, place(felt), message, "left out", help));
        }
    }
}

/// Elements and attributes that are left out, by name.
pub(crate) fn left_out(tree: &Tree<'_, '_>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    let mut count = |name: &str| *counts.entry(name.to_owned()).or_default() += 1;
    for node in tree.root.children().filter(roxmltree::Node::is_element) {
        match node.tag_name().name() {
            "link" => node
                .children()
                .filter(|n| n.is_element() && n.tag_name().name() != "inertial")
                .for_each(|n| count(n.tag_name().name())),
            "joint" => {
                const TAKEN: [&str; 7] = ["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"];
                let others = node.children().filter(|n| n.is_element() && !TAKEN.contains(&n.tag_name().name()));
                others.for_each(|n| count(n.tag_name().name()));
            }
            other => count(other),
        }
    }
    counts
}
