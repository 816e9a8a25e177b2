//! URDF, as in <https://wiki.ros.org/urdf/XML>.

mod felt;

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Span;
use roxmltree::Node;

use crate::body::Body;
use crate::format::{Extent, Format, Motion, Part};
use crate::number::Decimal;
use crate::pose::{nothing, Pose, Turn};
use crate::tree::{Joint, Kind, Role, Tree};
use crate::unread;
use crate::values::Values;
use crate::written::Written;
use crate::xacro::is_of;
use crate::xml::{attribute, child, place, shown};
use crate::Code;

/// Attributes of `inertia`, in the order of [`Body::inertia`].
const ELEMENTS: [&str; 6] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
/// The rotation of an `origin` since URDF 1.1: x, y, z, w.
const QUATERNION: &str = "quat_xyzw";
/// The newest minor version of URDF 1 that is known.
const NEWEST: u32 = 2;
/// Limits since URDF 1.2: a description has one for both.
const ACCELERATIONS: [&str; 2] = ["acceleration", "deceleration"];

/// A URDF.
pub(crate) struct Urdf<'a, 'i> {
    root: Node<'a, 'i>,
    /// The version is 1 and this.
    minor: u32,
    /// By index in the tree.
    links: Vec<Node<'a, 'i>>,
    joints: Vec<Node<'a, 'i>>,
}

/// The tree of a `robot`; `None` if the element is another, which is reported.
pub(crate) fn read<'a, 'i>(root: Node<'a, 'i>, diagnostics: &mut Diagnostics) -> Option<(Tree, Urdf<'a, 'i>)> {
    let mut tree = Tree::new(root.attribute("name").unwrap_or("robot"));
    let before = diagnostics.errors();
    let minor = minor_version(root, diagnostics);
    let mut urdf = Urdf { root, minor, links: Vec::new(), joints: Vec::new() };
    let of = |tag: &'static str| root.children().filter(move |n| n.is_element() && n.tag_name().name() == tag && !is_of(*n));
    for node in of("link") {
        let Some((name, span)) = named(node, "a link", diagnostics) else { continue };
        if let Some(first) = tree.link(name) {
            duplicate("links", name, span, tree.links[first].span, diagnostics);
            continue;
        }
        tree.add_link(name, place(node), Role::Body);
        urdf.links.push(node);
    }
    let mut places: BTreeMap<&str, Span> = BTreeMap::new();
    for node in of("joint") {
        let name = named(node, "a joint", diagnostics);
        let kind = kind(node, diagnostics);
        let parent = end(&tree, node, "parent", diagnostics);
        let child = end(&tree, node, "child", diagnostics);
        let Some((name, span)) = name else { continue };
        if let Some(&first) = places.get(name) {
            duplicate("joints", name, span, first, diagnostics);
            continue;
        }
        places.insert(name, span);
        let (Some(kind), Some((parent, _)), Some((child, child_span))) = (kind, parent, child) else { continue };
        if let Some(first) = tree.links[child].above {
            let message = format!("the link `{}` hangs on two joints", shown(&tree.links[child].name));
            let help = "name another link if `child` is a slip; of a loop take one of the joints out, since an arm is a tree";
            let fault = Diagnostic::new(Code::TwoParents, child_span, message, "the second one", help);
            diagnostics.push(fault.also(tree.joints[first].span, "the first one"));
            continue;
        }
        tree.add_joint(Joint { name: name.to_owned(), span, kind, parent, child });
        urdf.joints.push(node);
    }
    if tree.links.is_empty() {
        let message = "the robot has no link";
        let help = "write `<link name=\"base\"/>` and so on, and joints between them";
        diagnostics.push(Diagnostic::new(Code::MissingElement, place(root), message, "no `link` in here", help));
    }
    (diagnostics.errors() == before).then_some((tree, urdf))
}

/// The link that `parent` or `child` of a joint names.
fn end(tree: &Tree, joint: Node<'_, '_>, tag: &str, diagnostics: &mut Diagnostics) -> Option<(usize, Span)> {
    let Some(node) = child(joint, tag) else {
        let help = format!("write `<{tag} link=\"...\"/>` inside of it");
        diagnostics.push(Diagnostic::new(Code::MissingElement, place(joint), format!("a joint has no `{tag}`"), "", help));
        return None;
    };
    let Some((name, span)) = attribute(node, "link") else {
        let help = format!("write `<{tag} link=\"...\"/>`");
        diagnostics.push(Diagnostic::new(Code::MissingAttribute, place(node), format!("`{tag}` names no link"), "", help));
        return None;
    };
    let found = tree.link(name);
    if found.is_none() {
        let message = format!("there is no link `{}`", shown(name));
        diagnostics.push(Diagnostic::new(Code::UnknownLink, span, message, "unknown link", tree.meant_link(name)));
    }
    found.map(|link| (link, span))
}

fn named<'a>(node: Node<'a, '_>, what: &str, diagnostics: &mut Diagnostics) -> Option<(&'a str, Span)> {
    let name = attribute(node, "name");
    if name.is_none() {
        let help = format!("write `<{} name=\"...\">`", node.tag_name().name());
        diagnostics.push(Diagnostic::new(Code::MissingAttribute, place(node), format!("{what} has no name"), "", help));
    }
    name
}

fn duplicate(what: &str, name: &str, span: Span, first: Span, diagnostics: &mut Diagnostics) {
    let message = format!("two {what} are called `{}`", shown(name));
    let help = "give each a name of its own";
    diagnostics.push(Diagnostic::new(Code::DuplicateName, span, message, "the second one", help).also(first, "the first one"));
}

fn kind(node: Node<'_, '_>, diagnostics: &mut Diagnostics) -> Option<Kind> {
    let Some((word, _)) = attribute(node, "type") else {
        let help = "write `type=\"revolute\"`, `continuous`, `prismatic` or `fixed`";
        diagnostics.push(Diagnostic::new(Code::MissingAttribute, place(node), "a joint has no type", "", help));
        return None;
    };
    Some(match word {
        "revolute" => Kind::Revolute,
        "continuous" => Kind::Continuous,
        "prismatic" => Kind::Prismatic,
        "fixed" => Kind::Fixed,
        _ => Kind::Other,
    })
}

/// `origin` in an element: translation and rotation, as angles about x, y, z or, since URDF 1.1, as a quaternion.
fn origin_of(node: Node<'_, '_>, what: &str, minor: u32, values: &mut Values<'_>) -> ([Written; 3], Turn) {
    let Some(origin) = child(node, "origin") else { return (nothing(), Turn::none()) };
    let xyz = values.three(origin, "xyz", what);
    let xyz = xyz.each_ref().map(|x| values.snap.length(x));
    let quaternion = attribute(origin, QUATERNION);
    if let Some((_, span)) = quaternion.filter(|_| minor < 1) {
        let help = "write `version=\"1.1\"` in `robot` if that is meant: URDF 1.0 reads `rpy` alone";
        values.report(Code::UrdfFeature, span, format!("{what} is turned by a quaternion, in a URDF 1.0"), "", help);
    }
    if let (Some((_, span)), Some((_, rpy))) = (quaternion, attribute(origin, "rpy")) {
        let message = format!("{what} has two rotations, `rpy` and `{QUATERNION}`");
        let fault = Diagnostic::new(Code::UrdfFeature, span, message, "the second one", "take one of them out");
        values.diagnostics.push(fault.also(rpy, "the first one"));
    }
    let Some((_, span)) = quaternion else {
        let rpy = values.three(origin, "rpy", what);
        return (xyz, Turn::Rpy(rpy.each_ref().map(|angle| values.snap.angle(angle))));
    };
    let turn = values.vector::<4>(origin, QUATERNION, &format!("the rotation of {what}")).flatten();
    let turn = turn.and_then(|([x, y, z, w], _)| values.quaternion(&[w, x, y, z], span, &format!("`{QUATERNION}` of {what}")));
    (xyz, turn.unwrap_or_else(Turn::none))
}

/// The minor version of a URDF 1, 1.0 where none is given; another major one is warned of.
fn minor_version(root: Node<'_, '_>, diagnostics: &mut Diagnostics) -> u32 {
    let Some((text, span)) = attribute(root, "version") else { return 0 };
    let (major, minor) = text.trim().split_once('.').unwrap_or((text.trim(), "0"));
    match (major.parse::<u32>(), minor.parse::<u32>()) {
        (Ok(1), Ok(minor)) => minor,
        _ => {
            let message = format!("the version `{}` of URDF is not known; the file is read as URDF 1.0", shown(text));
            let help = "write the version that the file follows: `1.0`, `1.1` or `1.2`";
            diagnostics.push(Diagnostic::new(Code::UnreadAttribute, span, message, "not known", help));
            0
        }
    }
}

/// An element of `inertial`; one that is not there is reported.
fn required<'a, 'i>(node: Node<'a, 'i>, name: &str, example: &str, values: &mut Values<'_>) -> Option<Node<'a, 'i>> {
    let found = child(node, name);
    if found.is_none() {
        let message = format!("`inertial` has no `{name}`");
        values.report(Code::MissingElement, place(node), message, "", format!("write `<{name} {example}/>` in it"));
    }
    found
}

impl Urdf<'_, '_> {
    fn name_of(&self, joint: usize) -> String {
        shown(self.joints[joint].attribute("name").unwrap_or_default())
    }

    /// A number of an element of a joint.
    fn optional(&self, joint: usize, element: &str, name: &str, values: &mut Values<'_>) -> Option<Decimal> {
        let node = child(self.joints[joint], element)?;
        values.scalar(node, name, &format!("`{name}` of joint `{}`", self.name_of(joint)))
    }

    /// The mass distribution of a link; `None` if it is absent, or faulty and reported.
    fn body(&self, link: usize, values: &mut Values<'_>) -> Option<Body> {
        let inertial = child(self.links[link], "inertial")?;
        let called = format!("the link `{}`", shown(self.links[link].attribute("name").unwrap_or_default()));
        let (com, turn) = origin_of(inertial, &format!("the centre of mass of {called}"), self.minor, values);
        let mass = required(inertial, "mass", "value=\"1\"", values)?;
        if attribute(mass, "value").is_none() {
            let help = "write `<mass value=\"1\"/>`";
            values.report(Code::MissingAttribute, place(mass), format!("the mass of {called} has no value"), "", help);
        }
        let mass = values.scalar(mass, "value", &format!("the mass of {called}"));
        let example = "ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"";
        let tensor = required(inertial, "inertia", example, values)?;
        let missing: Vec<&str> = ELEMENTS.into_iter().filter(|name| attribute(tensor, name).is_none()).collect();
        if !missing.is_empty() {
            let message = format!("the inertia of {called} lacks {}, taken as 0", missing.join(", "));
            values.report(Code::MissingElementOfInertia, place(tensor), message, "", "write all six elements");
        }
        let before = values.diagnostics.errors();
        let elements =
            ELEMENTS.map(|name| values.scalar(tensor, name, &format!("`{name}` of {called}")).unwrap_or_else(Decimal::zero));
        let readable = values.diagnostics.errors() == before;
        Some(values.body(&called, mass?, (com, turn), &elements, readable, place(tensor)))
    }
}

impl Format for Urdf<'_, '_> {
    fn name(&self) -> &'static str {
        "urdf"
    }

    fn origin(&self, joint: usize, values: &mut Values<'_>) -> Vec<Pose> {
        let (xyz, turn) = origin_of(self.joints[joint], "the origin of a joint", self.minor, values);
        vec![Pose { xyz, turn }]
    }

    fn axis(&self, joint: usize, values: &mut Values<'_>) -> Option<([Written; 3], f64)> {
        let x = || {
            ["1", "0", "0"].map(|text| {
                let value = if text == "1" { 1.0 } else { 0.0 };
                Written::as_is(&Decimal { text: text.into(), value, span: Span::default() })
            })
        };
        let Some(element) = child(self.joints[joint], "axis") else { return Some((x(), 0.0)) };
        let what = format!("the axis of joint `{}`", self.name_of(joint));
        let Some(found) = values.vector::<3>(element, "xyz", &what) else { return Some((x(), 0.0)) };
        let (axis, span) = found?;
        values.direction(&axis, span, &what)
    }

    fn motion(&self, joint: usize, values: &mut Values<'_>) -> Motion {
        let node = self.joints[joint];
        let name = self.joints[joint].attribute("name").unwrap_or_default();
        let (axis, axis_offset) = self.axis(joint, values).unwrap_or_else(|| (nothing(), 0.0));
        let (lower, upper) = (self.optional(joint, "limit", "lower", values), self.optional(joint, "limit", "upper", values));
        let velocity = self.optional(joint, "limit", "velocity", values);
        let effort = self.optional(joint, "limit", "effort", values);
        let accelerations = ACCELERATIONS.map(|limit| {
            let given = self.optional(joint, "limit", limit, values);
            values.largest(given, limit, name)
        });
        let acceleration = accelerations.into_iter().flatten().min_by(|a, b| a.value.total_cmp(&b.value));
        let jerk = self.optional(joint, "limit", "jerk", values);
        let viscous = self.optional(joint, "dynamics", "damping", values);
        let coulomb = self.optional(joint, "dynamics", "friction", values);
        let position = match child(node, "limit") {
            Some(limit) if node.attribute("type") != Some("continuous") => values.position(place(limit), lower, upper, name),
            _ => None,
        };
        Motion {
            axis,
            axis_offset,
            position,
            velocity: values.largest_velocity(velocity, node.attribute("type") == Some("prismatic"), name),
            acceleration,
            jerk: values.largest(jerk, "jerk", name),
            effort: values.largest(effort, "effort", name),
            viscous: values.coefficient(viscous, name),
            coulomb: values.coefficient(coulomb, name),
            armature: None,
            spring: None,
        }
    }

    fn range(&self, joint: usize, values: &mut Values<'_>) -> Option<[f64; 2]> {
        child(self.joints[joint], "limit").filter(|_| self.joints[joint].attribute("type") != Some("continuous"))?;
        let mut bound = |name: &str| self.optional(joint, "limit", name, values).map_or(0.0, |x| x.value);
        Some([bound("lower"), bound("upper")])
    }

    fn kind_of(&self, joint: usize) -> String {
        shown(self.joints[joint].attribute("type").unwrap_or_default())
    }

    fn leader(&self, joint: usize) -> Option<(&str, Span)> {
        let mimic = child(self.joints[joint], "mimic")?;
        Some((mimic.attribute("joint").unwrap_or_default(), place(mimic)))
    }

    fn ratio(&self, joint: usize, values: &mut Values<'_>) -> (Option<Decimal>, Decimal) {
        let Some(mimic) = child(self.joints[joint], "mimic") else { return (None, Decimal::zero()) };
        let factor = values.scalar(mimic, "multiplier", "the multiplier of `mimic`");
        (factor, values.scalar(mimic, "offset", "the offset of `mimic`").unwrap_or_else(Decimal::zero))
    }

    fn bodies(&self, link: usize, values: &mut Values<'_>) -> Vec<Part> {
        let body = self.body(link, values);
        body.map(|body| Part { name: None, frame: Vec::new(), body }).into_iter().collect()
    }

    fn has_body(&self, link: usize) -> bool {
        child(self.links[link], "inertial").is_some()
    }

    fn gravity(&self, _values: &mut Values<'_>) -> [Decimal; 3] {
        let down = Decimal { text: "-9.81".into(), value: -9.81, span: Span::default() };
        [Decimal::zero(), Decimal::zero(), down]
    }

    fn assumed(&self, moving: &[usize]) -> Vec<String> {
        let lacking = |element: &str, needed: &dyn Fn(&str) -> bool| {
            let joints = moving.iter().map(|&joint| self.joints[joint]);
            let lacking =
                joints.filter(|node| child(*node, element).is_none() && needed(node.attribute("type").unwrap_or_default()));
            let names: Vec<String> =
                lacking.map(|node| format!("`{}`", shown(node.attribute("name").unwrap_or_default()))).collect();
            (!names.is_empty()).then(|| names.join(", "))
        };
        let axes = lacking("axis", &|_| true);
        let limits = lacking("limit", &|kind| kind != "continuous");
        let two = |joint: &usize| {
            let limit = child(self.joints[*joint], "limit")?;
            let [up, down] = ACCELERATIONS.map(|name| limit.attribute(name));
            let (up, down) = up.zip(down).filter(|(up, down)| up.trim() != down.trim())?;
            Some(format!("{} and {} of `{}`", shown(up), shown(down), self.name_of(*joint)))
        };
        let two: Vec<String> = moving.iter().filter_map(two).collect();
        let newer = (self.minor > NEWEST).then(|| format!("the file is of URDF 1.{}, of which 1.{NEWEST} is read", self.minor));
        let gravity = "a URDF does not say how the arm stands: gravity is 9.81 m/s² against z of its root link; turn `gravity` for another one";
        [
            Some(gravity.to_owned()),
            axes.map(|names| format!("without `axis`, taken to be (1, 0, 0): {names}")),
            limits.map(|names| {
                format!("without `limit`, taken to have none (bounds take ±π rad or ±1 m, 4 rad/s or 1 m/s): {names}")
            }),
            (!two.is_empty())
                .then(|| format!("`acceleration` is the smaller of acceleration and deceleration: {}", two.join("; "))),
            newer,
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Warns of what would move the arm otherwise and robot.yaml does not hold; once a kind, with the values.
    fn check(&self, extent: &Extent<'_>, diagnostics: &mut Diagnostics) {
        warn_of_unread(self.root, diagnostics);
        felt::warn(self.root, extent, diagnostics);
    }

    fn mass(&self, link: usize) -> Option<f64> {
        let mass = child(self.links[link], "inertial").and_then(|inertial| child(inertial, "mass"));
        Some(mass.and_then(|mass| mass.attribute("value")?.trim().parse().ok()).unwrap_or(0.0))
    }

    fn left_out(&self) -> BTreeMap<String, usize> {
        let mut counts = BTreeMap::new();
        let mut count = |name: &str| *counts.entry(name.to_owned()).or_default() += 1;
        for node in self.root.children().filter(Node::is_element) {
            match node.tag_name().name() {
                other if is_of(node) => count(&format!("xacro:{other} that nothing uses")),
                "link" => node
                    .children()
                    .filter(|n| n.is_element() && n.tag_name().name() != "inertial")
                    .for_each(|n| count(n.tag_name().name())),
                "joint" => {
                    let others = node.children().filter(|n| n.is_element() && !TAKEN.contains(&n.tag_name().name()));
                    others.for_each(|n| count(n.tag_name().name()));
                }
                "transmission" => count(&transmission(node)),
                other => count(other),
            }
        }
        counts
    }
}

/// A transmission with its reduction. A URDF has no rotor; its inertia would act at the joint times the square of the reduction.
fn transmission(node: Node<'_, '_>) -> String {
    let reduction = node.descendants().find(|n| n.has_tag_name("mechanicalReduction")).and_then(|n| n.text());
    match reduction.map(str::trim).filter(|text| text.parse() != Ok(1.0)) {
        Some(text) => format!("transmission (mechanicalReduction {})", shown(text)),
        None => "transmission".into(),
    }
}

/// Elements of a joint that are read.
const TAKEN: [&str; 7] = ["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"];

/// The permitted elements in an element of each name.
const ELEMENTS_OF: [(&str, &[&str]); 4] = [
    ("robot", &["link", "joint", "material", "transmission", "gazebo"]),
    ("link", &["inertial", "visual", "collision"]),
    ("joint", &["origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"]),
    ("inertial", INERTIAL),
];
const INERTIAL: &[&str] = &["origin", "mass", "inertia"];

/// The elements that an element of each name has once.
const SINGLE: [(&str, &[&str]); 3] = [("link", &["inertial"]), ("joint", &TAKEN), ("inertial", INERTIAL)];

/// Attributes of elements that say how the arm is made.
const ATTRIBUTES_OF: [(&str, &[&str]); 7] = [
    ("origin", &["xyz", "rpy", QUATERNION]),
    ("axis", &["xyz"]),
    ("mass", &["value"]),
    ("inertia", &ELEMENTS),
    ("limit", &["lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"]),
    ("dynamics", &["damping", "friction"]),
    ("mimic", &["joint", "multiplier", "offset"]),
];

/// Warns of what is in the robot, its links and joints, and nothing reads.
fn warn_of_unread(root: Node<'_, '_>, diagnostics: &mut Diagnostics) {
    let parts = root.children().filter(|part| ["link", "joint"].contains(&part.tag_name().name()));
    let inside = parts.clone().chain(parts.flat_map(|part| part.children()).filter(|n| n.tag_name().name() == "inertial"));
    unread::warn_of_elements(std::iter::once(root).chain(inside.clone()), &ELEMENTS_OF, diagnostics);
    unread::warn_of_repeated(inside.clone(), &SINGLE, diagnostics);
    unread::warn_of_attributes(inside.flat_map(|part| part.children()), &ATTRIBUTES_OF, diagnostics);
}
