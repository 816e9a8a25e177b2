//! The links and joints of a URDF as a tree, each with its place; numbers are read where they are needed.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Span;
use armgen_codegen::suggest::did_you_mean;
use roxmltree::Node;

use crate::xml::{attribute, child, place, shown};
use crate::Code;

/// A link.
#[derive(Clone, Debug)]
pub(crate) struct Link<'a, 'i> {
    pub(crate) name: &'a str,
    pub(crate) node: Node<'a, 'i>,
    /// The joint above it.
    pub(crate) above: Option<usize>,
    /// The joints below it, in the order of the file.
    pub(crate) below: Vec<usize>,
}

/// Kinds of joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    /// Floating, planar, or a word that means nothing.
    Other,
}

impl Kind {
    pub(crate) fn moves(self) -> bool {
        matches!(self, Kind::Revolute | Kind::Continuous | Kind::Prismatic)
    }
}

/// A joint.
#[derive(Clone, Debug)]
pub(crate) struct Joint<'a, 'i> {
    pub(crate) name: &'a str,
    /// Its name in the file.
    pub(crate) span: Span,
    pub(crate) node: Node<'a, 'i>,
    pub(crate) kind: Kind,
    pub(crate) parent: usize,
    pub(crate) child: usize,
}

/// A robot of a URDF.
#[derive(Clone, Debug)]
pub(crate) struct Tree<'a, 'i> {
    pub(crate) name: &'a str,
    pub(crate) root: Node<'a, 'i>,
    pub(crate) links: Vec<Link<'a, 'i>>,
    pub(crate) joints: Vec<Joint<'a, 'i>>,
    link_names: BTreeMap<&'a str, usize>,
    joint_names: BTreeMap<&'a str, usize>,
}

impl<'a, 'i> Tree<'a, 'i> {
    /// The tree of a `robot`; `None` if it is none, which is reported.
    pub(crate) fn read(root: Node<'a, 'i>, diagnostics: &mut Diagnostics) -> Option<Tree<'a, 'i>> {
        let mut tree = Tree {
            name: root.attribute("name").unwrap_or("robot"),
            root,
            links: Vec::new(),
            joints: Vec::new(),
            link_names: BTreeMap::new(),
            joint_names: BTreeMap::new(),
        };
        let before = diagnostics.errors();
        for node in root.children().filter(Node::is_element) {
            if node.tag_name().namespace().is_some_and(|uri| uri.contains("xacro")) {
                diagnostics.push(crate::xml::xacro(place(node)));
            }
        }
        let of = |tag: &'static str| root.children().filter(move |n| n.is_element() && n.tag_name().name() == tag);
        for node in of("link") {
            let Some((name, span)) = named(node, "a link", diagnostics) else { continue };
            if let Some(&first) = tree.link_names.get(name) {
                duplicate("links", name, span, place(tree.links[first].node), diagnostics);
                continue;
            }
            tree.link_names.insert(name, tree.links.len());
            tree.links.push(Link { name, node, above: None, below: Vec::new() });
        }
        let mut places: BTreeMap<&str, Span> = BTreeMap::new();
        for node in of("joint") {
            let name = named(node, "a joint", diagnostics);
            let kind = kind(node, diagnostics);
            let parent = tree.end(node, "parent", diagnostics);
            let child = tree.end(node, "child", diagnostics);
            let Some((name, span)) = name else { continue };
            if let Some(&first) = places.get(name) {
                duplicate("joints", name, span, first, diagnostics);
                continue;
            }
            places.insert(name, span);
            let (Some(kind), Some((parent, _)), Some((child, child_span))) = (kind, parent, child) else { continue };
            let index = tree.joints.len();
            if let Some(first) = tree.links[child].above {
                let message = format!("the link `{}` hangs on two joints", shown(tree.links[child].name));
                let help = "an arm is a tree: take one of the joints out to open the loop";
                let fault = Diagnostic::new(Code::TwoParents, child_span, message, "the second one", help);
                diagnostics.push(fault.also(tree.joints[first].span, "the first one"));
                continue;
            }
            tree.links[child].above = Some(index);
            tree.links[parent].below.push(index);
            tree.joint_names.insert(name, index);
            tree.joints.push(Joint { name, span, node, kind, parent, child });
        }
        if tree.links.is_empty() {
            let message = "the robot has no link";
            let help = "write `<link name=\"base\"/>` and so on, and joints between them";
            diagnostics.push(Diagnostic::new(Code::MissingElement, place(root), message, "no `link` in here", help));
        }
        (diagnostics.errors() == before).then_some(tree)
    }

    /// The link that `parent` or `child` of a joint names.
    fn end(&self, joint: Node<'a, 'i>, tag: &str, diagnostics: &mut Diagnostics) -> Option<(usize, Span)> {
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
        let found = self.link(name);
        if found.is_none() {
            let message = format!("there is no link `{}`", shown(name));
            diagnostics.push(Diagnostic::new(Code::UnknownLink, span, message, "unknown link", self.meant_link(name)));
        }
        found.map(|link| (link, span))
    }

    /// The link of a name.
    pub(crate) fn link(&self, name: &str) -> Option<usize> {
        self.link_names.get(name).copied()
    }

    /// The joint of a name.
    pub(crate) fn joint(&self, name: &str) -> Option<usize> {
        self.joint_names.get(name).copied()
    }

    /// What may have been meant by the name of a link that does not exist.
    pub(crate) fn meant_link(&self, name: &str) -> String {
        meant(name, &self.links.iter().map(|link| link.name).collect::<Vec<_>>())
    }

    /// What may have been meant by the name of a joint that does not exist.
    pub(crate) fn meant_joint(&self, name: &str) -> String {
        meant(name, &self.joints.iter().map(|joint| joint.name).collect::<Vec<_>>())
    }

    /// The joints from `base` down to `tip`; `None` if `tip` is not below.
    pub(crate) fn path(&self, base: usize, tip: usize) -> Option<Vec<usize>> {
        let mut path = Vec::new();
        let mut at = tip;
        while at != base {
            let above = self.links[at].above?;
            path.push(above);
            at = self.joints[above].parent;
            if path.len() > self.joints.len() {
                return None;
            }
        }
        path.reverse();
        Some(path)
    }

    /// The one link that hangs on no joint; faults are reported.
    pub(crate) fn only_root(&self, diagnostics: &mut Diagnostics) -> Option<usize> {
        let roots: Vec<usize> = (0..self.links.len()).filter(|&link| self.links[link].above.is_none()).collect();
        match roots[..] {
            [root] if self.reaches_all(root) => Some(root),
            [root] => {
                self.report_loop(root, diagnostics);
                None
            }
            [] => {
                self.report_loop(usize::MAX, diagnostics);
                None
            }
            [first, second, ..] => {
                let names: Vec<String> = roots.iter().take(8).map(|&r| format!("`{}`", shown(self.links[r].name))).collect();
                let message = format!("{} links hang on no joint: {}", roots.len(), names.join(", "));
                let help = format!("say from which link the arm starts: `--base {}`", shown(self.links[first].name));
                let fault = Diagnostic::new(Code::SeveralRoots, place(self.links[second].node), message, "another one", help);
                diagnostics.push(fault.also(place(self.links[first].node), "the first one"));
                None
            }
        }
    }

    fn reaches_all(&self, root: usize) -> bool {
        let (mut seen, mut open) = (0, vec![root]);
        while let Some(link) = open.pop() {
            seen += 1;
            open.extend(self.links[link].below.iter().map(|&joint| self.joints[joint].child));
        }
        seen == self.links.len()
    }

    /// Names a loop among the links that do not hang on `root`.
    fn report_loop(&self, root: usize, diagnostics: &mut Diagnostics) {
        let mut on_tree = vec![false; self.links.len()];
        let mut open: Vec<usize> = if root < self.links.len() { vec![root] } else { Vec::new() };
        while let Some(link) = open.pop() {
            on_tree[link] = true;
            open.extend(self.links[link].below.iter().map(|&joint| self.joints[joint].child));
        }
        // Upwards from any other link one comes into a loop.
        let Some(mut at) = (0..self.links.len()).find(|&link| !on_tree[link]) else { return };
        for _ in 0..self.links.len() {
            at = self.links[at].above.map_or(at, |joint| self.joints[joint].parent);
        }
        let (mut names, start) = (vec![self.links[at].name], at);
        let mut joint = self.links[at].above;
        while let Some(above) = joint {
            at = self.joints[above].parent;
            if at == start || names.len() == 8 {
                break;
            }
            names.push(self.links[at].name);
            joint = self.links[at].above;
        }
        let code = if root < self.links.len() { Code::ClosedChain } else { Code::NoRoot };
        let names: Vec<String> = names.iter().map(|name| format!("`{}`", shown(name))).collect();
        let message = format!("links hang on each other in a loop: {}", names.join(", "));
        let span = self.links[start].above.map_or(Span::default(), |joint| self.joints[joint].span);
        let help = "an arm is a tree: take one of the joints out to open the loop";
        diagnostics.push(Diagnostic::new(code, span, message, "this joint closes it", help));
    }
}

fn named<'a>(node: Node<'a, '_>, what: &str, diagnostics: &mut Diagnostics) -> Option<(&'a str, Span)> {
    let name = attribute(node, "name");
    if name.is_none() {
        let help = format!("write `<{} name=\"...\">`", node.tag_name().name());
        diagnostics.push(Diagnostic::new(Code::MissingAttribute, place(node), format!("{what} has no name"), "", help));
    }
    name.inspect(|(name, span)| {
        if name.contains("${") || name.contains("$(") {
            diagnostics.push(crate::xml::xacro(*span));
        }
    })
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

fn meant(name: &str, known: &[&str]) -> String {
    match did_you_mean(name, known) {
        Some(meant) => format!("did you mean `{}`?", shown(meant)),
        None => {
            let some: Vec<String> = known.iter().take(8).map(|name| format!("`{}`", shown(name))).collect();
            format!("there are {}{}", some.join(", "), if known.len() > 8 { ", ..." } else { "" })
        }
    }
}
