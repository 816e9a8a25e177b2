//! The links and joints of a file as a tree, each with its place; numbers are read where they are needed (`format.rs`).

use std::cell::Cell;
use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Span;
use armgen_codegen::suggest::did_you_mean;

use crate::xml::shown;
use crate::Code;

/// A link.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    pub(crate) name: String,
    /// Its place in the file.
    pub(crate) span: Span,
    pub(crate) role: Role,
    /// The joint above it.
    pub(crate) above: Option<usize>,
    /// The joints below it, in the order of the file.
    pub(crate) below: Vec<usize>,
}

/// The kind of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// A body, or one that may be.
    Body,
    /// A frame that may be named as the tip, and nothing else.
    Frame,
    /// Between two joints of one body, or between a joint and the frame of its body; has no name for the user.
    Between,
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
pub(crate) struct Joint {
    pub(crate) name: String,
    /// Its name in the file.
    pub(crate) span: Span,
    pub(crate) kind: Kind,
    pub(crate) parent: usize,
    pub(crate) child: usize,
}

/// A robot.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) name: String,
    pub(crate) links: Vec<Link>,
    pub(crate) joints: Vec<Joint>,
    link_names: BTreeMap<String, usize>,
    joint_names: BTreeMap<String, usize>,
    /// How many suggestions are still made.
    guesses: Cell<usize>,
}

/// The most suggestions: each compares a name with all others.
pub(crate) const GUESSES: usize = 8;
/// Names of so many bytes and more are not compared.
const COMPARED: usize = 256;

impl Tree {
    /// A tree without links.
    pub(crate) fn new(name: &str) -> Tree {
        Tree {
            name: name.to_owned(),
            links: Vec::new(),
            joints: Vec::new(),
            link_names: BTreeMap::new(),
            joint_names: BTreeMap::new(),
            guesses: Cell::new(GUESSES),
        }
    }

    /// Adds a link, under its name if it has one that is not taken; its index.
    pub(crate) fn add_link(&mut self, name: &str, span: Span, role: Role) -> usize {
        let index = self.links.len();
        if role != Role::Between {
            self.link_names.entry(name.to_owned()).or_insert(index);
        }
        self.links.push(Link { name: name.to_owned(), span, role, above: None, below: Vec::new() });
        index
    }

    /// Adds a joint; its index.
    pub(crate) fn add_joint(&mut self, joint: Joint) -> usize {
        let index = self.joints.len();
        self.links[joint.child].above = Some(index);
        self.links[joint.parent].below.push(index);
        // Fixed joints have no names in every format.
        if !joint.name.is_empty() || joint.kind != Kind::Fixed {
            self.joint_names.entry(joint.name.clone()).or_insert(index);
        }
        self.joints.push(joint);
        index
    }

    /// The link of a name.
    pub(crate) fn link(&self, name: &str) -> Option<usize> {
        self.link_names.get(name).copied()
    }

    /// The joint of a name.
    pub(crate) fn joint(&self, name: &str) -> Option<usize> {
        self.joint_names.get(name).copied()
    }

    /// A suggestion for the name of an unknown link: the link on a joint of that name, a link of nearly that name, or
    /// one of the last links. Only the first few names get a suggestion.
    pub(crate) fn meant_link(&self, name: &str) -> String {
        if let Some(joint) = self.joint(name).map(|joint| &self.joints[joint]) {
            let link = &self.links[joint.child];
            if link.role != Role::Between {
                return format!("`{}` is a joint; the link that it moves is `{}`", shown(name), shown(&link.name));
            }
        }
        if !self.guesses() {
            return "name one of the file's links".to_owned();
        }
        let mut named: Vec<&Link> = self.links.iter().filter(|link| link.role != Role::Between).collect();
        // Most often the tip is asked for.
        named.sort_by_key(|link| !link.below.is_empty());
        meant(name, &named.iter().map(|link| link.name.as_str()).collect::<Vec<_>>())
    }

    /// A suggestion for the name of an unknown joint. Only the first few names get a suggestion.
    pub(crate) fn meant_joint(&self, name: &str) -> String {
        if !self.guesses() {
            return "name one of the file's joints".to_owned();
        }
        meant(name, &self.joints.iter().map(|joint| joint.name.as_str()).filter(|name| !name.is_empty()).collect::<Vec<_>>())
    }

    /// Whether one more suggestion is made.
    fn guesses(&self) -> bool {
        let left = self.guesses.get();
        self.guesses.set(left.saturating_sub(1));
        left > 0
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
                let names: Vec<String> = roots.iter().take(8).map(|&r| format!("`{}`", shown(&self.links[r].name))).collect();
                let message = format!("{} links hang on no joint: {}", roots.len(), names.join(", "));
                let help = format!("say from which link the arm starts: `--base {}`", shown(&self.links[first].name));
                let fault = Diagnostic::new(Code::SeveralRoots, self.links[second].span, message, "another one", help);
                diagnostics.push(fault.also(self.links[first].span, "the first one"));
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
        let (mut names, start) = (vec![self.links[at].name.as_str()], at);
        let mut joint = self.links[at].above;
        while let Some(above) = joint {
            at = self.joints[above].parent;
            if at == start || names.len() == 8 {
                break;
            }
            names.push(&self.links[at].name);
            joint = self.links[at].above;
        }
        let code = if root < self.links.len() { Code::ClosedChain } else { Code::NoRoot };
        let names: Vec<String> = names.iter().map(|name| format!("`{}`", shown(name))).collect();
        let message = format!("links hang on each other in a loop: {}", names.join(", "));
        let span = self.links[start].above.map_or(Span::default(), |joint| self.joints[joint].span);
        let help =
            "name other links if `parent` or `child` is a slip; of a loop take one of the joints out, since an arm is a tree";
        diagnostics.push(Diagnostic::new(code, span, message, "this joint closes it", help));
    }
}

/// A suggestion for a name that is not among these.
pub(crate) fn meant(name: &str, known: &[&str]) -> String {
    let short: Vec<&str> = known.iter().copied().filter(|name| name.len() < COMPARED).collect();
    match did_you_mean(name, &short) {
        Some(meant) => format!("did you mean `{}`?", shown(meant)),
        None => {
            let some: Vec<String> = known.iter().take(8).map(|name| format!("`{}`", shown(name))).collect();
            let more = known.len().saturating_sub(8);
            format!("there are {}{}", some.join(", "), if more > 0 { format!(", and {more} more") } else { String::new() })
        }
    }
}
