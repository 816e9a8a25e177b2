//! MJCF, as in <https://mujoco.readthedocs.io/en/stable/XMLreference.html>: the part of it that describes a serial arm.
//!
//! A body is a link whose joints stand inside of it. Joint k of a body, about or along `axis` through `pos`, with the file's pose at
//! q = ref, moves what follows by T(pos) motion(axis, q - ref) T(-pos); the body's frame is
//!
//! ```text
//! (frames and pose of the body) · Π_k T(pos_k) motion_k(q_k - ref_k) T(-pos_k)
//! ```
//!
//! So the links here are, joint after joint, the frames that they turn about, without mass, and then the frame of the body.

mod classes;
mod effects;
mod equalities;
mod geometry;
mod names;
mod turns;

use std::cell::OnceCell;
use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::exact::{Number, Rational};
use armgen_codegen::source::Span;
use armgen_codegen::validate::impossible_inertia;
use roxmltree::Node;

use self::classes::{Classes, Element};
use self::effects::Disabled;
use self::equalities::Equality;
use crate::format::{Extent, Format, Motion, Part};
use crate::number::Decimal;
use crate::pose::{nothing, Pose, Turn};
use crate::tree::{Joint, Kind, Role, Tree};
use crate::values::Values;
use crate::written::Written;
use crate::xml::{attribute, place, shown};
use crate::Code;

/// The help for a file that has more than descriptions of bodies.
const SAVE_COMPILED: &str = "save the compiled model as XML (`mj_saveLastXML`, or \"Save xml\" in the viewer) and import that";

/// The settings of `compiler`.
struct Compiler {
    degrees: bool,
    /// Axes of Euler angles; upper case: fixed ones.
    sequence: [u8; 3],
    autolimits: bool,
    /// Groups of geometries that make up inertias.
    groups: [i64; 2],
    from_geometries: FromGeometries,
    /// Tensors that break the triangle inequality are replaced.
    balanced: bool,
}

/// The bodies whose inertias are computed from geometries.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FromGeometries {
    /// Bodies without `inertial`.
    Auto,
    Always,
    Never,
}

/// The element of a link.
enum Held<'a, 'i> {
    World,
    Body(Node<'a, 'i>),
    /// Behind a joint that another joint of the same body follows.
    Passed,
    /// Behind the last joint of a body whose frame lies elsewhere.
    Anchor,
    Site,
}

/// A step from a frame to the next one.
enum Step<'a, 'i> {
    /// The pose of a body, frame or site.
    Pose(Element<'a, 'i>),
    /// To the point that the axis of a joint passes through, or back.
    Anchor(Element<'a, 'i>, Direction),
    /// Back to where a joint is at 0.
    Reference(Element<'a, 'i>),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Direction {
    There,
    Back,
}

/// How a joint of the tree is placed.
struct Placed<'a, 'i> {
    /// The innermost `frame` around it, by its index.
    frame: Option<usize>,
    steps: Vec<Step<'a, 'i>>,
    /// `None`: fixed.
    joint: Option<Element<'a, 'i>>,
}

/// A MuJoCo model.
pub(crate) struct Mjcf<'a, 'i> {
    root: Node<'a, 'i>,
    compiler: Compiler,
    disabled: Disabled,
    classes: Classes<'a>,
    /// Each with the one around it.
    frames: Vec<(Node<'a, 'i>, Option<usize>)>,
    /// By index in the tree.
    links: Vec<Held<'a, 'i>>,
    joints: Vec<Placed<'a, 'i>>,
    sites: BTreeMap<&'a str, usize>,
    /// Of joints that follow others the elements that make them do so.
    equalities: BTreeMap<usize, Equality<'a, 'i>>,
    left_out: OnceCell<BTreeMap<String, usize>>,
}

/// The tree of a `mujoco`; `None` if the element is another, which is reported.
pub(crate) fn read<'a, 'i>(root: Node<'a, 'i>, diagnostics: &mut Diagnostics) -> Option<(Tree, Mjcf<'a, 'i>)> {
    let before = diagnostics.errors();
    effects::refuse_macros(root, diagnostics);
    let compiler = compiler(root, diagnostics);
    let disabled = effects::disabled(root, diagnostics);
    let classes = Classes::read(root);
    classes.refuse_unknown(root, diagnostics);
    names::warn_of_unread(root, diagnostics);
    let mjcf = Mjcf {
        root,
        compiler,
        disabled,
        classes,
        frames: Vec::new(),
        links: vec![Held::World],
        joints: Vec::new(),
        sites: BTreeMap::new(),
        equalities: BTreeMap::new(),
        left_out: OnceCell::new(),
    };
    let mut tree = Tree::new(root.attribute("model").unwrap_or("robot"));
    let worlds: Vec<Node<'a, 'i>> = sections(root, "worldbody").collect();
    let Some(first) = worlds.first() else {
        let help = "write `<worldbody>` with the bodies of the arm inside";
        diagnostics.push(Diagnostic::new(Code::MissingElement, place(root), "the model has no `worldbody`", "", help));
        return None;
    };
    tree.add_link("world", place(*first), Role::Body);
    let mut reader = Reader { mjcf, tree, diagnostics, named: BTreeMap::new() };
    for world in worlds {
        reader.inside(world, 0, None, world.attribute("childclass"));
    }
    let Reader { mut mjcf, tree, .. } = reader;
    mjcf.equalities = equalities::of_joints(&mjcf, &tree);
    (diagnostics.errors() == before).then_some((tree, mjcf))
}

/// Sections of a name; a model may have several.
fn sections<'a, 'i>(root: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    root.children().filter(move |node| node.is_element() && node.tag_name().name() == name)
}

fn compiler(root: Node<'_, '_>, diagnostics: &mut Diagnostics) -> Compiler {
    let mut compiler = Compiler {
        degrees: true,
        sequence: *b"xyz",
        autolimits: true,
        groups: [0, 5],
        from_geometries: FromGeometries::Auto,
        balanced: false,
    };
    for node in sections(root, "compiler") {
        effects::refuse_changed_inertias(node, diagnostics);
        if let Some((word, span)) = attribute(node, "angle") {
            match word {
                "degree" => compiler.degrees = true,
                "radian" => compiler.degrees = false,
                _ => effects::refuse(span, format!("`angle` is `{}`", shown(word)), "write `degree` or `radian`", diagnostics),
            }
        }
        if let Some((word, span)) = attribute(node, "eulerseq") {
            match <[u8; 3]>::try_from(word.as_bytes()) {
                Ok(letters) if letters.iter().all(|letter| b"xyzXYZ".contains(letter)) => compiler.sequence = letters,
                _ => {
                    let help = "write three of `x`, `y`, `z`, or of `X`, `Y`, `Z`";
                    effects::refuse(span, format!("`eulerseq` is `{}`", shown(word)), help, diagnostics);
                }
            }
        }
        if let Some(word) = node.attribute("autolimits") {
            compiler.autolimits = word == "true";
        }
        if let Some(word) = node.attribute("balanceinertia") {
            compiler.balanced = word == "true";
        }
        if let Some((word, span)) = attribute(node, "inertiafromgeom") {
            match word {
                "auto" => compiler.from_geometries = FromGeometries::Auto,
                "true" => compiler.from_geometries = FromGeometries::Always,
                "false" => compiler.from_geometries = FromGeometries::Never,
                _ => {
                    let help = "write `auto`, `true` or `false`";
                    effects::refuse(span, format!("`inertiafromgeom` is `{}`", shown(word)), help, diagnostics);
                }
            }
        }
        let groups: Option<Vec<i64>> =
            node.attribute("inertiagrouprange").map(|words| words.split_ascii_whitespace().flat_map(str::parse).collect());
        if let Some([low, high]) = groups.as_deref() {
            compiler.groups = [*low, *high];
        }
    }
    compiler
}

/// Walks through bodies.
struct Reader<'r, 'a, 'i> {
    mjcf: Mjcf<'a, 'i>,
    tree: Tree,
    diagnostics: &'r mut Diagnostics,
    /// Places of names by kind.
    named: BTreeMap<(&'static str, &'a str), Span>,
}

impl<'a, 'i> Reader<'_, 'a, 'i> {
    /// Reads the content of `worldbody`, of a body or of a `frame` on a link.
    fn inside(&mut self, node: Node<'a, 'i>, link: usize, frame: Option<usize>, class: Option<&'a str>) {
        for inner in node.children().filter(Node::is_element) {
            match inner.tag_name().name() {
                "body" => self.body(inner, link, frame, class),
                "frame" => {
                    self.mjcf.frames.push((inner, frame));
                    let index = self.mjcf.frames.len() - 1;
                    self.inside(inner, link, Some(index), inner.attribute("childclass").or(class));
                }
                "site" => {
                    let Some((name, _)) = self.name(inner, "sites") else { continue };
                    let element = Element { node: inner, class };
                    let site = self.tree.add_link(name, place(inner), Role::Frame);
                    self.mjcf.links.push(Held::Site);
                    self.mjcf.sites.insert(name, site);
                    self.fixed(link, site, frame, vec![Step::Pose(element)]);
                }
                "joint" | "freejoint" if node.tag_name().name() != "body" => {
                    let help = "put the joint directly into its body, and its place into `pos` and `axis`";
                    effects::refuse(place(inner), "a joint stands outside of a body".into(), help, self.diagnostics);
                }
                _ => {}
            }
        }
    }

    fn body(&mut self, node: Node<'a, 'i>, parent: usize, frame: Option<usize>, class: Option<&'a str>) {
        let class = node.attribute("childclass").or(class);
        let name = match self.name(node, "bodies") {
            Some((name, _)) => name.to_owned(),
            None => format!("body_{}", self.tree.links.len()),
        };
        let joints: Vec<Element<'a, 'i>> = node
            .children()
            .filter(|n| n.is_element() && matches!(n.tag_name().name(), "joint" | "freejoint"))
            .map(|node| Element { node, class })
            .collect();
        let (mut at, mut frame) = (parent, frame);
        let mut steps = vec![Step::Pose(Element { node, class })];
        let mut body = None;
        for (k, &joint) in joints.iter().enumerate() {
            let kind = self.mjcf.kind(joint);
            // A translation has no place.
            let anchored = kind != Kind::Prismatic && self.mjcf.is_given(joint, "pos");
            if anchored {
                steps.push(Step::Anchor(joint, Direction::There));
            }
            if kind.moves() && self.mjcf.is_given(joint, "ref") {
                steps.push(Step::Reference(joint));
            }
            let last = k + 1 == joints.len();
            let (held, role) = match (last, anchored) {
                (true, false) => (Held::Body(node), Role::Body),
                (true, true) => (Held::Anchor, Role::Between),
                (false, _) => (Held::Passed, Role::Between),
            };
            let link = self.link(&name, node, role, held);
            if role == Role::Body {
                body = Some(link);
            }
            let called = match self.name(joint.node, "joints") {
                Some((name, _)) => name.to_owned(),
                None if k == 0 => format!("{name}_joint"),
                None => format!("{name}_joint_{}", k + 1),
            };
            let span = attribute(joint.node, "name").map_or(place(joint.node), |(_, span)| span);
            self.tree.add_joint(Joint { name: called, span, kind, parent: at, child: link });
            self.mjcf.joints.push(Placed { frame, steps: std::mem::take(&mut steps), joint: Some(joint) });
            (at, frame) = (link, None);
            if anchored {
                steps.push(Step::Anchor(joint, Direction::Back));
            }
        }
        let body = match body {
            Some(body) => body,
            None => {
                let body = self.link(&name, node, Role::Body, Held::Body(node));
                self.fixed(at, body, frame, steps);
                body
            }
        };
        self.inside(node, body, None, class);
    }

    fn link(&mut self, name: &str, node: Node<'a, 'i>, role: Role, held: Held<'a, 'i>) -> usize {
        self.mjcf.links.push(held);
        self.tree.add_link(name, place(node), role)
    }

    fn fixed(&mut self, parent: usize, child: usize, frame: Option<usize>, steps: Vec<Step<'a, 'i>>) {
        let span = self.tree.links[child].span;
        self.tree.add_joint(Joint { name: String::new(), span, kind: Kind::Fixed, parent, child });
        self.mjcf.joints.push(Placed { frame, steps, joint: None });
    }

    /// The name of an element, if it has a name; a repeated name of its kind is reported.
    fn name(&mut self, node: Node<'a, 'i>, kinds: &'static str) -> Option<(&'a str, Span)> {
        let (name, span) = attribute(node, "name")?;
        if let Some(&first) = self.named.get(&(kinds, name)) {
            let message = format!("two {kinds} are called `{}`", shown(name));
            let fault = Diagnostic::new(Code::DuplicateName, span, message, "the second one", "give each a name of its own");
            self.diagnostics.push(fault.also(first, "the first one"));
        }
        self.named.entry((kinds, name)).or_insert(span);
        Some((name, span))
    }
}

impl<'a, 'i> Mjcf<'a, 'i> {
    fn kind(&self, joint: Element<'a, 'i>) -> Kind {
        match self.kind_word(joint) {
            "hinge" => Kind::Revolute,
            "slide" => Kind::Prismatic,
            _ => Kind::Other,
        }
    }

    fn kind_word(&self, joint: Element<'a, 'i>) -> &'a str {
        if joint.node.tag_name().name() == "freejoint" {
            return "free";
        }
        self.classes.attribute(joint, "type").map_or("hinge", |(word, _)| word)
    }

    /// Whether an attribute holds something else than zeros.
    fn is_given(&self, element: Element<'a, 'i>, name: &str) -> bool {
        let words = self.classes.attribute(element, name).map_or("", |(words, _)| words);
        words.split_ascii_whitespace().any(|word| word.parse::<f64>() != Ok(0.0))
    }

    /// Whether an attribute of a limit is in force: as its switch says, or where that is left to the compiler.
    fn is_limited(&self, element: Element<'a, 'i>, switch: &str) -> bool {
        match self.classes.attribute(element, switch) {
            Some(("true", _)) => true,
            Some(("false", _)) => false,
            _ => self.compiler.autolimits,
        }
    }

    /// N numbers of an attribute, if it is given.
    fn numbers<const N: usize>(
        &self,
        element: Element<'a, 'i>,
        name: &str,
        what: &str,
        values: &mut Values<'_>,
    ) -> Option<[Decimal; N]> {
        let (text, span) = self.classes.attribute(element, name)?;
        values.list(text, span, name, what)
    }

    fn number(&self, element: Element<'a, 'i>, name: &str, what: &str, values: &mut Values<'_>) -> Option<Decimal> {
        let [number] = self.numbers::<1>(element, name, what, values)?;
        Some(number)
    }

    /// A joint variable or limit: in radians, or written in degrees, or a length.
    fn variable(&self, decimal: Decimal, kind: Kind) -> Decimal {
        if kind == Kind::Prismatic || !self.compiler.degrees || decimal.is_zero() {
            return decimal;
        }
        Decimal { text: format!("deg({})", decimal.text), value: decimal.value.to_radians(), span: decimal.span }
    }

    /// The pose of an element: `pos` and a rotation.
    fn pose(&self, element: Element<'a, 'i>, what: &str, values: &mut Values<'_>) -> Vec<Pose> {
        let pos = self.numbers::<3>(element, "pos", what, values);
        let xyz = pos.map_or_else(nothing, |pos| pos.each_ref().map(|x| values.snap.length(x)));
        let mut turns = self.turns(element, what, values).into_iter();
        let first = Pose { xyz, turn: turns.next().unwrap_or_else(Turn::none) };
        std::iter::once(first).chain(turns.map(Pose::rotation)).collect()
    }

    fn step(&self, step: &Step<'a, 'i>, values: &mut Values<'_>) -> Vec<Pose> {
        match *step {
            Step::Pose(element) => self.pose(element, "the pose of a body", values),
            Step::Anchor(joint, direction) => {
                let Some(pos) = self.numbers::<3>(joint, "pos", "the place of a joint", values) else { return Vec::new() };
                let there = pos.each_ref().map(|x| values.snap.length(x));
                let back = |x: Written| Written { text: opposite(&x.text), value: -x.value, ..x };
                vec![Pose::translation(if direction == Direction::There { there } else { there.map(back) })]
            }
            Step::Reference(joint) => {
                let kind = self.kind(joint);
                let at = self.number(joint, "ref", "the reference of a joint", values);
                let axis = self.axis_of(joint, values);
                let (Some(at), Some((axis, axis_offset))) = (at, axis) else { return Vec::new() };
                let at = self.variable(at, kind);
                vec![Pose::of_joint(kind == Kind::Prismatic, axis, axis_offset, &opposite(&at.text), -at.value, at.span)]
            }
        }
    }

    fn axis_of(&self, joint: Element<'a, 'i>, values: &mut Values<'_>) -> Option<([Written; 3], f64)> {
        let what = "the axis of a joint";
        let Some((text, span)) = self.classes.attribute(joint, "axis") else {
            let one = Written { text: "1".into(), value: 1.0, twelfths: None, ..Written::zero() };
            return Some(([Written::zero(), Written::zero(), one], 0.0));
        };
        let axis = values.list::<3>(text, span, "axis", what)?;
        values.direction(&axis, span, what)
    }

    /// The mass distribution that an `inertial` gives; faults are reported.
    fn of_inertial(&self, node: Node<'a, 'i>, inertial: Node<'a, 'i>, values: &mut Values<'_>) -> Option<Part> {
        let called = format!("the body `{}`", shown(node.attribute("name").unwrap_or_default()));
        let element = Element { node: inertial, class: None };
        if attribute(inertial, "mass").is_none() {
            let message = format!("the mass of {called} is missing");
            values.report(Code::MissingAttribute, place(inertial), message, "", "write `mass=\"1\"` in it");
        }
        let mass = self.number(element, "mass", &format!("the mass of {called}"), values);
        let before = values.diagnostics.errors();
        let mut poses = self.pose(element, &format!("the centre of mass of {called}"), values);
        let tensor = |name: &str| attribute(inertial, name).map(|(_, span)| span);
        let what = format!("the inertia of {called}");
        let (elements, span) = if let Some(span) = tensor("fullinertia") {
            (self.numbers::<6>(element, "fullinertia", &what, values), span)
        } else if let Some(span) = tensor("diaginertia") {
            let diagonal = self.numbers::<3>(element, "diaginertia", &what, values);
            let zero = Decimal::zero;
            (diagonal.map(|[xx, yy, zz]| [xx, yy, zz, zero(), zero(), zero()]), span)
        } else {
            let message = format!("{what} is missing");
            let help = "write `diaginertia=\"1 1 1\"` or `fullinertia=\"1 1 1 0 0 0\"` in it";
            values.report(Code::MissingAttribute, place(inertial), message, "", help);
            (None, place(inertial))
        };
        let elements = elements?;
        let readable = values.diagnostics.errors() == before;
        // A tensor takes one rotation; more are the pose of a frame.
        let (frame, com) = match poses.len() {
            1 => (Vec::new(), poses.remove(0)),
            _ => (poses, Pose::translation(nothing())),
        };
        if self.compiler.balanced && readable && !is_balanced(&elements) {
            let message = format!("with `balanceinertia` {what} is not what the file says of it");
            effects::refuse(span, message, SAVE_COMPILED, values.diagnostics);
        }
        let body = values.body(&called, mass?, (com.xyz, com.turn), &elements, readable, span);
        Some(Part { name: None, frame, body })
    }
}

/// The negative of a decimal or expression.
fn opposite(text: &str) -> String {
    match text.strip_prefix('-') {
        _ if text == "0" => text.to_owned(),
        Some(rest) => rest.to_owned(),
        None => format!("-{text}"),
    }
}

impl Format for Mjcf<'_, '_> {
    fn name(&self) -> &'static str {
        "mjcf"
    }

    fn origin(&self, joint: usize, values: &mut Values<'_>) -> Vec<Pose> {
        let placed = &self.joints[joint];
        let mut around = Vec::new();
        let mut frame = placed.frame;
        while let Some(index) = frame {
            let (node, outer) = self.frames[index];
            around.push(Step::Pose(Element { node, class: None }));
            frame = outer;
        }
        let steps = around.iter().rev().chain(&placed.steps);
        steps.flat_map(|step| self.step(step, values)).collect()
    }

    fn axis(&self, joint: usize, values: &mut Values<'_>) -> Option<([Written; 3], f64)> {
        self.axis_of(self.joints[joint].joint?, values)
    }

    fn motion(&self, joint: usize, values: &mut Values<'_>) -> Motion {
        let (axis, axis_offset) = self.axis(joint, values).unwrap_or_else(|| (nothing(), 0.0));
        let none = Motion {
            axis,
            axis_offset,
            position: None,
            velocity: None,
            acceleration: None,
            jerk: None,
            effort: None,
            viscous: None,
            coulomb: None,
            armature: None,
            spring: None,
        };
        let Some(element) = self.joints[joint].joint else { return none };
        let name = attribute(element.node, "name").map_or("", |(name, _)| name);
        let kind = self.kind(element);
        effects::refuse_springs(self, element, values);
        let range = self.is_limited(element, "limited").then(|| self.numbers::<2>(element, "range", "a range", values)).flatten();
        let position = range.and_then(|[low, high]| {
            let place = self.classes.attribute(element, "range").map_or_else(Span::default, |(_, span)| span);
            values.position(place, Some(self.variable(low, kind)), Some(self.variable(high, kind)), name)
        });
        let range = self.is_limited(element, "actuatorfrclimited");
        let range = range.then(|| self.numbers::<2>(element, "actuatorfrcrange", "a range of forces", values)).flatten();
        let effort = range.map(|[low, high]| if low.value.abs() < high.value.abs() { positive(low) } else { positive(high) });
        let effort = values.largest(effort, "effort", name);
        // A polynomial of the rate is refused as such.
        let linear = !self.disabled.damper
            && self.classes.attribute(element, "damping").is_none_or(|(text, _)| text.split_ascii_whitespace().count() < 2);
        let viscous = linear.then(|| self.number(element, "damping", "damping", values)).flatten();
        let coulomb = if self.disabled.friction { None } else { self.number(element, "frictionloss", "frictionloss", values) };
        let armature = self.number(element, "armature", "an armature", values);
        // Several numbers are a polynomial, which is refused as such.
        let one = !self.disabled.spring
            && self.classes.attribute(element, "stiffness").is_some_and(|(text, _)| text.split_ascii_whitespace().count() == 1);
        let stiffness = one.then(|| self.number(element, "stiffness", "a stiffness", values)).flatten();
        let rest = self.number(element, "springref", "springref", values);
        let spring = values
            .stiffness(stiffness, name)
            .map(|stiffness| (stiffness, rest.filter(|rest| !rest.is_zero()).map(|rest| self.variable(rest, kind))));
        Motion {
            position,
            effort,
            viscous: values.coefficient(viscous, name),
            coulomb: values.coefficient(coulomb, name),
            armature: values.armature(armature, name),
            spring,
            ..none
        }
    }

    fn range(&self, joint: usize, values: &mut Values<'_>) -> Option<[f64; 2]> {
        let element = self.joints[joint].joint.filter(|element| self.is_limited(*element, "limited"))?;
        let range = self.numbers::<2>(element, "range", "a range", values)?;
        Some(range.map(|x| self.variable(x, self.kind(element)).value))
    }

    fn kind_of(&self, joint: usize) -> String {
        self.joints[joint].joint.map_or_else(String::new, |element| shown(self.kind_word(element)))
    }

    fn leader(&self, joint: usize) -> Option<(&str, Span)> {
        self.equalities.get(&joint).map(|equality| (equality.leader_name, place(equality.node)))
    }

    fn ratio(&self, joint: usize, values: &mut Values<'_>) -> (Option<Decimal>, Decimal) {
        self.equalities.get(&joint).map_or((None, Decimal::zero()), |equality| equalities::ratio(self, joint, equality, values))
    }

    fn bodies(&self, link: usize, values: &mut Values<'_>) -> Vec<Part> {
        let Held::Body(node) = self.links[link] else { return Vec::new() };
        effects::refuse_compensation(node, values);
        match self.inertial(node) {
            Some(inertial) => self.of_inertial(node, inertial, values).into_iter().collect(),
            None => {
                let parts = self.of_geometries(node, values);
                if !parts.is_empty() {
                    values.computed.push(shown(node.attribute("name").unwrap_or_default()));
                }
                parts
            }
        }
    }

    fn has_body(&self, link: usize) -> bool {
        matches!(self.links[link], Held::Body(node) if self.inertial(node).is_some() || self.is_of_geometries(node))
    }

    fn mass(&self, link: usize) -> Option<f64> {
        match self.links[link] {
            Held::Body(node) => match self.inertial(node) {
                Some(inertial) => inertial.attribute("mass")?.trim().parse().ok(),
                None => (!self.is_of_geometries(node)).then_some(0.0),
            },
            _ => Some(0.0),
        }
    }

    fn may_be_massless(&self, link: usize) -> bool {
        matches!(self.links[link], Held::Passed)
    }

    fn lacks_body(&self, link: usize) -> Option<String> {
        let Held::Body(node) = self.links[link] else { return None };
        self.without_formula(node)
    }

    fn gravity(&self, values: &mut Values<'_>) -> [Decimal; 3] {
        let down = Decimal { text: "-9.81".into(), value: -9.81, span: Span::default() };
        let mut gravity = [Decimal::zero(), Decimal::zero(), down];
        for option in sections(self.root, "option") {
            if let Some(Some((given, _))) = values.vector::<3>(option, "gravity", "gravity") {
                gravity = given;
            }
        }
        if self.disabled.gravity {
            return std::array::from_fn(|_| Decimal::zero());
        }
        gravity
    }

    fn assumed(&self, moving: &[usize]) -> Vec<String> {
        let joints = moving.iter().filter_map(|&joint| self.joints[joint].joint);
        let named: Vec<(&str, Element<'_, '_>)> =
            joints.map(|element| (element.node.attribute("name").unwrap_or_default(), element)).collect();
        let mut lines = effects::switched_off(self, &named);
        let names: Vec<&str> = named.iter().map(|(name, _)| *name).collect();
        lines.extend(equalities::switched_off(self, &names));
        if moving.iter().any(|joint| self.equalities.contains_key(joint)) {
            lines.push("equalities of joints are rigid here: `solref` and `solimp` are left out".into());
        }
        lines
    }

    fn check(&self, extent: &Extent<'_>, diagnostics: &mut Diagnostics) {
        effects::check(self, extent, diagnostics);
    }

    fn left_out(&self) -> BTreeMap<String, usize> {
        self.left_out.get_or_init(|| effects::left_out(self.root, self.equalities.len())).clone()
    }
}

/// Whether no principal moment exceeds the sum of the other two: tr(I)/2 1 - I has no negative one.
fn is_balanced([xx, yy, zz, xy, xz, yz]: &[Decimal; 6]) -> bool {
    let [xx, yy, zz, xy, xz, yz] = [xx, yy, zz, xy, xz, yz].map(Decimal::exact);
    let half = &(&(&xx + &yy) + &zz) * &Number::from(Rational::from(1) / Rational::from(2));
    impossible_inertia(&[&half - &xx, -&xy, &half - &yy, -&xz, -&yz, &half - &zz]).is_none()
}

/// Its size.
fn positive(decimal: Decimal) -> Decimal {
    Decimal { text: decimal.text.trim_start_matches('-').to_owned(), value: decimal.value.abs(), span: decimal.span }
}
