//! From the base to the tips: the moving joints, the poses between them, and the bodies of each link.
//!
//! A fixed or locked joint is one more pose; branches that hang on a moving link are attached to it. Nothing is multiplied out here.

mod followers;
mod gravity;
mod locks;
mod names;
mod tips;
mod warnings;

use std::collections::btree_map::{BTreeMap, Entry};
use std::collections::BTreeSet;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::kinds::MAX_JOINTS;
use armgen_codegen::source::{Source, Span};
use armgen_codegen::suggest::did_you_mean;
use armgen_codegen::validate::{is_free_name, is_rust_name};

use crate::body::Body;
use crate::format::{Extent, Format, Motion, Part};
use crate::pose::Pose;
use crate::snap::Snap;
use crate::tree::{Kind, Role, Tree};
use crate::values::Values;
use crate::xml::{beginning, shown};
use crate::{Code, Options};
use followers::Followers;
pub(crate) use followers::Follows;
pub(crate) use locks::Lock;

/// Poses in one list of robot.yaml.
const MAX_POSES: usize = 60;
/// Characters of the name of an end effector, before a number.
const LONGEST_TIP: usize = 28;
/// Bodies of an arm: beyond, robot.yaml would be longer than may be read.
const MAX_BODIES: usize = 1000;

/// A body that is fixed to a moving link.
#[derive(Clone, Debug)]
pub(crate) struct Attached {
    pub(crate) link: String,
    pub(crate) name: String,
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
    pub(crate) motion: Motion,
    /// The row whose link carries it; `None` for the base.
    pub(crate) parent: Option<usize>,
    /// The row whose joint it follows.
    pub(crate) follows: Option<Follows>,
    /// The link's own body, if the file gives it one.
    pub(crate) body: Option<Body>,
    pub(crate) attached: Vec<Attached>,
    /// Whether a body of it has faults, which are reported.
    unreadable: bool,
}

/// An end effector.
#[derive(Debug)]
pub(crate) struct End {
    /// Its name; `None` for the only one of an arm.
    pub(crate) name: Option<String>,
    /// In the file.
    pub(crate) link: String,
    /// The row whose link carries it.
    pub(crate) row: usize,
    /// Its frame in that link's.
    pub(crate) tool: Vec<Pose>,
}

/// The chains.
#[derive(Debug)]
pub(crate) struct Arm {
    pub(crate) name: String,
    pub(crate) robot: String,
    pub(crate) base: String,
    pub(crate) ends: Vec<End>,
    pub(crate) gravity: [String; 3],
    /// Whether these are rounded.
    pub(crate) gravity_rounded: bool,
    /// Its size, and by how much snapping turned it, rad.
    pub(crate) gravity_size: f64,
    pub(crate) gravity_offset: f64,
    pub(crate) rows: Vec<Row>,
    pub(crate) snap: Snap,
    pub(crate) locked: Vec<Lock>,
    /// Links that were given no mass distribution and are taken to have mass 0.
    pub(crate) massless: Vec<String>,
    /// Links with an impossible tensor, accepted as written.
    pub(crate) impossible: Vec<String>,
    /// Bodies whose mass distributions are computed from geometries.
    pub(crate) computed: Vec<String>,
    /// How many position limits were left out since no arm has such.
    pub(crate) boundless: usize,
    /// How many efforts of 0 were left out of an arm without masses.
    pub(crate) unknown_efforts: usize,
    /// How many efforts of joints that follow others were left out.
    pub(crate) led_efforts: usize,
    /// Joints of the base that do not move anything of the chain.
    pub(crate) left_out_branches: usize,
    /// Notes for the user.
    pub(crate) notes: Vec<String>,
    /// Assumptions about absent values, and the parts of the base that have no effect on the equations.
    pub(crate) assumed: Vec<String>,
}

/// The chain under construction.
struct Builder<'r> {
    tree: &'r Tree,
    format: &'r dyn Format,
    locks: locks::Locks,
    followers: Followers,
    /// Values of the unlocked joints outside the chain, as far as requested.
    led: BTreeMap<usize, locks::Led>,
    values: Values<'r>,
    /// Which joints lie on the chain.
    on_path: BTreeSet<usize>,
    locked: Vec<Lock>,
    massless: Vec<String>,
    options: &'r Options,
    bodies: usize,
}

/// The chain of a tree; faults are reported.
pub(crate) fn arm(
    source: &Source,
    tree: &Tree,
    format: &dyn Format,
    options: &Options,
    diagnostics: &mut Diagnostics,
) -> Option<Arm> {
    let (snap, inertia_as_written) = (Snap::new(options.snap), options.inertia_as_written);
    let massless_file = (0..tree.links.len()).all(|link| !format.has_body(link) && format.lacks_body(link).is_none());
    let mut values = Values {
        source,
        diagnostics,
        snap,
        inertia_as_written,
        impossible: Vec::new(),
        computed: Vec::new(),
        boundless: 0,
        kinematics_alone: massless_file,
        unknown_efforts: 0,
    };
    let mut locks = locks::Locks::new(tree, format, &options.lock, &mut values)?;
    let diagnostics = &mut *values.diagnostics;
    let base = named_link(tree, options.base.as_deref(), "--base", diagnostics)?;
    let base = match base {
        Some(base) => base,
        None => tree.only_root(diagnostics)?,
    };
    let mut notes = Vec::new();
    let mut tips: Vec<(Option<&str>, usize)> = Vec::new();
    let mut others = Vec::new();
    for (name, link) in &options.tips {
        let found = named_link(tree, Some(link), "--tip", diagnostics)??;
        let name = name.as_deref().unwrap_or(link);
        if tips.iter().any(|(other, _)| *other == Some(name)) {
            let message = format!("two end effectors are called `{}`", shown(name));
            let help = "give each `--tip` a name of its own: `--tip left=LINK --tip right=LINK`";
            diagnostics.push(Diagnostic::new(Code::DuplicateName, beginning(), message, "", help));
            return None;
        }
        tips.push((Some(name), found));
    }
    if options.all {
        let all = tips::all(tree, base, &locks, diagnostics)?;
        tips.extend(all.tips.into_iter().map(|link| (Some(tree.links[link].name.as_str()), link)));
        (others, notes) = (all.others, all.notes);
    }
    if tips.is_empty() {
        let tip = named_link(tree, options.tip.as_deref(), "--tip", diagnostics)?;
        let (tip, noted) = match tip {
            Some(tip) => (tip, Vec::new()),
            None => tips::only(tree, base, &locks, diagnostics)?,
        };
        (tips, notes) = (vec![(None, tip)], noted);
    }
    let mut path: Vec<usize> = Vec::new();
    for tip in tips.iter().map(|(_, tip)| *tip).chain(others) {
        let of_tip = path_to(tree, base, tip, diagnostics)?;
        path.extend(of_tip.into_iter().filter(|joint| !path.contains(joint)).collect::<Vec<_>>());
    }
    let tip = tips[0].1;
    let followers = Followers::take_in((tree, format), base, &mut path, &mut locks, &mut values);
    let moving: Vec<usize> = path.iter().copied().filter(|&j| locks.let_move(tree, j)).collect();
    if let Some(&joint) = moving.get(MAX_JOINTS) {
        let others = if followers.taken.is_empty() { "" } else { ", and with them" };
        let message = format!(
            "{} joints move between base and tip{others}, more than the {MAX_JOINTS} that can be generated",
            moving.len()
        );
        let help = "lock some with `--lock JOINT=0`, or choose another `--base` or `--tip`";
        values.report(Code::TooManyJoints, tree.joints[joint].span, message, "one too many", help);
        return None;
    }
    if !followers.taken.is_empty() {
        let names: Vec<String> = followers.taken.iter().map(|&joint| format!("`{}`", shown(&tree.joints[joint].name))).collect();
        notes.push(format!("joints beside the chain that move with it: {}; `--lock JOINT=VALUE` holds one", names.join(", ")));
    }
    let extent = Extent { moving: &moving, held: locks.given(), carriers: &moved(tree, &path, &moving), tree };
    format.check(&extent, values.diagnostics);
    let on_path = path.iter().copied().collect();
    let led = BTreeMap::new();
    let mut builder = Builder {
        tree,
        format,
        locks,
        followers,
        led,
        values,
        on_path,
        locked: Vec::new(),
        massless: Vec::new(),
        options,
        bodies: 0,
    };
    let (mut rows, ends, on_base) = builder.rows(base, &path, &tips)?;
    for ((given, _), end) in options.tips.iter().zip(&ends) {
        if let (Some(given), Some(name)) = (given, end.name.as_ref().filter(|name| Some(*name) != given.as_ref())) {
            notes.push(format!("the end effector `{}` is called `{name}`, which every language takes", shown(given)));
        }
    }
    let mut led_efforts = 0;
    if rows.iter().any(|row| row.follows.is_some()) && !builder.values.diagnostics.has_errors() {
        followers::check(&mut rows, &mut builder.values);
        let led = rows.iter_mut().filter(|row| row.follows.is_some());
        led_efforts = led.filter_map(|row| row.motion.effort.take()).count();
    }
    if let (true, Some(&joint)) = (massless_file, moving.first()) {
        let message = "no link of the file has an `inertial`: the description is of kinematics alone";
        let help = "give the moving links masses, centres and inertias where forces matter";
        builder.values.report(Code::NoMass, tree.links[tree.joints[joint].child].span, message, "moves first", help);
    }
    if rows.is_empty() && !builder.values.diagnostics.has_errors() {
        let message = format!("nothing moves between `{}` and `{}`", shown(&tree.links[base].name), shown(&tree.links[tip].name));
        let help = "choose a `--tip` below a joint that turns or slides";
        builder.values.report(Code::NoJoints, tree.links[tip].span, message, "", help);
        return None;
    }
    let gravity = builder.gravity(base);
    let left_out_branches =
        on_base.iter().flat_map(|&link| &tree.links[link].below).filter(|joint| !builder.on_path.contains(joint));
    let left_out_branches = left_out_branches.filter(|&&joint| tree.links[tree.joints[joint].child].role != Role::Frame).count();
    let mut assumed = format.assumed(&moving);
    if format.has_body(base) {
        assumed.push(format!("the mass of the base link `{}` is left out: it does not move", shown(&tree.links[base].name)));
    }
    builder.values.warn_of_near_angles();
    let Builder { values: Values { snap, impossible, computed, boundless, unknown_efforts, .. }, locked, massless, .. } = builder;
    let robot_name = options.name.clone().unwrap_or_else(|| identifier(&tree.name, &mut BTreeSet::new(), is_rust_name));
    Some(Arm {
        name: robot_name,
        robot: tree.name.clone(),
        base: tree.links[base].name.clone(),
        ends,
        gravity: gravity.texts,
        gravity_rounded: gravity.rounded,
        gravity_size: gravity.size,
        gravity_offset: gravity.offset,
        rows,
        snap,
        locked,
        massless,
        impossible,
        computed,
        boundless,
        unknown_efforts,
        led_efforts,
        left_out_branches,
        notes,
        assumed,
    })
}

/// The joints from the base to a tip; a fault is reported.
fn path_to(tree: &Tree, base: usize, tip: usize, diagnostics: &mut Diagnostics) -> Option<Vec<usize>> {
    let path = tree.path(base, tip);
    if path.is_none() {
        let (from, to) = (&tree.links[base].name, &tree.links[tip].name);
        let message = format!("the link `{}` is not below `{}`", shown(to), shown(from));
        let way = tips::way_up(tree, tip);
        let below = format!("a link below `{}` as `--tip`", shown(from));
        let help = match way {
            Some(way) => format!("above it are {way}: take one of them as `--base`, or {below}"),
            None => format!("it hangs on nothing: take {below}"),
        };
        let fault = Diagnostic::new(Code::NotBelow, tree.links[tip].span, message, "this is to be the tip", help);
        diagnostics.push(fault.also(tree.links[base].span, "this is to be the base"));
    }
    path
}

/// The link that an option names, `Some(None)` if the option is not given.
fn named_link(tree: &Tree, name: Option<&str>, option: &str, diagnostics: &mut Diagnostics) -> Option<Option<usize>> {
    let Some(name) = name else { return Some(None) };
    let found = tree.link(name);
    if found.is_none() {
        let message = format!("`{option}` names `{}`, which is no link of this file", shown(name));
        diagnostics.push(Diagnostic::new(Code::UnknownLink, beginning(), message, "", tree.meant_link(name)));
    }
    found.map(Some)
}

/// The name of an end effector, as every language can begin names with it.
fn beginning_with_a_letter(name: &str) -> String {
    let plain: String = name.trim_start_matches(|c: char| !c.is_ascii_alphabetic()).chars().take(LONGEST_TIP).collect();
    if plain.is_empty() {
        return "tip".into();
    }
    plain
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

impl Builder<'_> {
    /// Rows of the moving joints, the end effectors behind them, and the links that no joint moves.
    fn rows(&mut self, base: usize, path: &[usize], tips: &[(Option<&str>, usize)]) -> Option<(Vec<Row>, Vec<End>, Vec<usize>)> {
        let tree = self.tree;
        let mut rows: Vec<Row> = Vec::new();
        // Of each link the row that moves it, and the poses between that row's link frame and its own.
        let mut places: BTreeMap<usize, (Option<usize>, Vec<Pose>)> = BTreeMap::from([(base, (None, Vec::new()))]);
        let (mut moved, mut of_joint, mut names) = (Vec::new(), BTreeMap::new(), BTreeSet::new());
        for &index in path {
            let joint = &tree.joints[index];
            let (mut owner, mut pending) = places[&joint.parent].clone();
            let origin = self.format.origin(index, &mut self.values);
            let moves = self.locks.let_move(self.tree, index);
            pending.extend(origin);
            pending.retain(|pose| !pose.is_nothing());
            self.check_length(&pending, joint.span)?;
            if moves {
                let mut row = self.row(index, std::mem::take(&mut pending));
                row.name = identifier(&joint.name, &mut names, is_free_name);
                row.parent = owner;
                owner = Some(rows.len());
                of_joint.insert(index, rows.len());
                rows.push(row);
                moved.push(index);
            } else {
                pending.extend(self.standing(index, true));
                pending.retain(|pose| !pose.is_nothing());
            }
            if let Some(owner) = owner {
                let own = moves.then_some(joint.child);
                let (body, attached, unreadable) = self.bodies(joint.child, &pending, own)?;
                let row = &mut rows[owner];
                row.body = row.body.take().or(body);
                row.unreadable |= unreadable;
                row.attached.extend(attached);
            }
            places.insert(joint.child, (owner, pending));
        }
        for (row, joint) in rows.iter_mut().zip(moved) {
            self.complete(tree.joints[joint].child, row);
            row.follows = self.followers.of_row(joint, &of_joint);
        }
        let mut names = BTreeSet::new();
        let mut ends = Vec::new();
        for &(name, tip) in tips {
            let (owner, tool) = places.get(&tip).cloned().unwrap_or_default();
            let link = tree.links[tip].name.clone();
            let Some(row) = owner else {
                // Of one end effector the caller says that nothing moves.
                if name.is_some() && !self.values.diagnostics.has_errors() {
                    let message = format!("no joint moves the link `{}`", shown(&link));
                    let help = "choose a `--tip` below a joint that turns or slides";
                    self.values.report(Code::NoJoints, tree.links[tip].span, message, "", help);
                }
                continue;
            };
            let name = name.map(|name| identifier(&beginning_with_a_letter(name), &mut names, is_free_name));
            ends.push(End { name, link, row, tool });
        }
        let still = places.into_iter().filter(|(_, (owner, _))| owner.is_none()).map(|(link, _)| link).collect();
        Some((rows, ends, still))
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

    /// A moving joint without its bodies.
    fn row(&mut self, index: usize, origin: Vec<Pose>) -> Row {
        let joint = &self.tree.joints[index];
        Row {
            name: String::new(),
            joint: joint.name.clone(),
            link: self.tree.links[joint.child].name.clone(),
            span: joint.span,
            prismatic: joint.kind == Kind::Prismatic,
            origin,
            motion: self.format.motion(index, &mut self.values),
            parent: None,
            follows: None,
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
            self.warn_of_fixed_follower(index);
            return None;
        }
        if joint.kind == Kind::Other {
            if lock.as_ref().is_none_or(|lock| lock.value != 0.0) {
                let word = self.format.kind_of(index);
                let message =
                    format!("the joint `{}` is `{word}`, which is no joint about or along one axis", shown(&joint.name));
                let kinds = ["revolute", "continuous", "prismatic", "fixed", "hinge", "slide"];
                let help = match (did_you_mean(&word, &kinds), on_path) {
                    (Some(meant), _) => format!("did you mean `{meant}`?"),
                    (None, true) => {
                        format!("begin the arm below it with `--base`, or hold it: `--lock {}=0`", shown(&joint.name))
                    }
                    (None, false) => format!("hold it: `--lock {}=0`", shown(&joint.name)),
                };
                self.values.report(Code::UnsupportedJoint, joint.span, message, "", help);
            }
            return None;
        }
        let lock = match lock {
            Some(lock) => lock,
            None => self.following(index)?,
        };
        self.warn_outside(index, &lock);
        self.warn_of_lock(index, &lock);
        self.locked.push(lock.clone());
        if lock.value == 0.0 {
            return None;
        }
        let (axis, offset) = self.format.axis(index, &mut self.values)?;
        Some(Pose::of_joint(joint.kind == Kind::Prismatic, axis, offset, &lock.text, lock.value, lock.span))
    }

    /// The bodies that are fixed to a link: its own body if it is the moving link, and the others with their poses.
    fn bodies(&mut self, link: usize, at: &[Pose], own: Option<usize>) -> Option<(Option<Body>, Vec<Attached>, bool)> {
        let tree = self.tree;
        let (mut body, mut attached, mut unreadable) = (None, Vec::new(), false);
        let mut open = vec![(link, at.to_vec())];
        while let Some((link, poses)) = open.pop() {
            let lacking = self.format.lacks_body(link);
            let found = if lacking.is_none() { self.format.bodies(link, &mut self.values) } else { Vec::new() };
            self.bodies += found.len();
            if self.bodies > MAX_BODIES {
                let span = tree.links[link].span;
                self.values.report(
                    Code::TooLarge,
                    span,
                    format!("the arm has more than {MAX_BODIES} bodies"),
                    "",
                    "join bodies that are fixed to each other",
                );
                return None;
            }
            if found.is_empty() {
                unreadable |= self.format.has_body(link);
                if lacking.is_some() {
                    self.without_body(link);
                    unreadable = true;
                }
            }
            // Shapes of one body have names of their own.
            let several = found.len() > 1;
            for Part { name, frame, body: found } in found {
                if own == Some(link) && frame.is_empty() && body.is_none() {
                    body = Some(found);
                    continue;
                }
                let link = &tree.links[link];
                let origin = poses.iter().cloned().chain(frame).collect();
                let name = name.filter(|_| several).unwrap_or_else(|| link.name.clone());
                attached.push(Attached { link: link.name.clone(), name, origin, body: found, span: link.span });
            }
            let beside: Vec<usize> = tree.links[link].below.iter().rev().copied().filter(|j| !self.on_path.contains(j)).collect();
            for below in beside {
                let joint = &tree.joints[below];
                let mut poses = poses.clone();
                poses.extend(self.format.origin(below, &mut self.values));
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
    fn complete(&mut self, link: usize, row: &mut Row) {
        if row.body.is_some() || !row.attached.is_empty() || row.unreadable || self.format.may_be_massless(link) {
            return;
        }
        self.without_body(link);
    }

    /// Reports a moving link without the mass distribution that it should have.
    fn without_body(&mut self, link: usize) {
        let (span, name) = (self.tree.links[link].span, &self.tree.links[link].name);
        if self.values.kinematics_alone {
            self.massless.push(name.clone());
            return;
        }
        if self.options.massless {
            let message = format!("the moving link `{}` is taken to have no mass", shown(name));
            self.values.report(Code::NoMass, span, message, "", "give its mass, centre and inertia where forces matter");
            self.massless.push(name.clone());
            return;
        }
        let message = match self.format.lacks_body(link) {
            Some(kind) => {
                format!("the moving body `{}` has no `inertial`, and {kind}, whose inertia is not computed", shown(name))
            }
            None => format!("the moving link `{}` has no `inertial`, and nothing that is fixed to it has", shown(name)),
        };
        let help = "give its mass, centre and inertia; with `--massless` its mass is 0, which is enough for kinematics";
        self.values.report(Code::MissingInertial, span, message, "moves", help);
    }
}

/// The moving links: the chain and everything that hangs on it. Each comes with the nearest moving joint of the chain above it.
fn moved(tree: &Tree, path: &[usize], moving: &[usize]) -> BTreeMap<usize, usize> {
    let mut moved = BTreeMap::new();
    // From the tip upwards: what hangs on a joint further down is taken already.
    for &joint in moving.iter().rev().filter(|joint| path.contains(joint)) {
        let mut open = vec![tree.joints[joint].child];
        while let Some(link) = open.pop() {
            if let Entry::Vacant(free) = moved.entry(link) {
                free.insert(joint);
                open.extend(tree.links[link].below.iter().map(|&joint| tree.joints[joint].child));
            }
        }
    }
    moved
}
