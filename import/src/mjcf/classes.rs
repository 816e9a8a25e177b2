//! Attributes that an element takes from its class: `default`, nested, and the classes that bodies and frames name for what is in them.

use std::collections::BTreeMap;

use armgen_codegen::source::Span;
use roxmltree::Node;

use crate::xml::attribute;

/// An element of a body, with the class that the bodies around it give it.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 'i> {
    pub(super) node: Node<'a, 'i>,
    pub(super) class: Option<&'a str>,
}

/// A class: the `default` elements of its name, and the class around it.
#[derive(Default)]
struct Class<'a, 'i> {
    nodes: Vec<Node<'a, 'i>>,
    outer: Option<&'a str>,
}

/// All classes by name.
pub(super) struct Classes<'a, 'i> {
    by_name: BTreeMap<&'a str, Class<'a, 'i>>,
}

/// The class that holds everywhere.
const MAIN: &str = "main";

impl<'a, 'i> Classes<'a, 'i> {
    pub(super) fn read(root: Node<'a, 'i>) -> Classes<'a, 'i> {
        let mut by_name: BTreeMap<&'a str, Class<'a, 'i>> = BTreeMap::new();
        let defaults = |node: Node<'a, 'i>| node.children().filter(|n| n.is_element() && n.tag_name().name() == "default");
        let mut open: Vec<(Node<'a, 'i>, Option<&'a str>)> = defaults(root).map(|node| (node, None)).collect();
        while let Some((node, outer)) = open.pop() {
            let name = if outer.is_none() { MAIN } else { node.attribute("class").unwrap_or(MAIN) };
            // A nested class of the name of one around it would be its own outer one.
            let outer = outer.filter(|outer| *outer != name && !by_name.contains_key(name));
            open.extend(defaults(node).map(|inner| (inner, Some(name))));
            let class = by_name.entry(name).or_default();
            class.nodes.push(node);
            class.outer = class.outer.or(outer);
        }
        // The class at the top may have a name of its own, by which it is called, too.
        for node in defaults(root) {
            if let Some(name) = node.attribute("class").filter(|name| *name != MAIN && !by_name.contains_key(name)) {
                by_name.insert(name, Class { nodes: Vec::new(), outer: Some(MAIN) });
            }
        }
        Classes { by_name }
    }

    /// Text and place of an attribute: the element's own, or that of its class, or of one around that.
    pub(super) fn attribute(&self, element: Element<'a, 'i>, name: &str) -> Option<(&'a str, Span)> {
        if let Some(own) = attribute(element.node, name) {
            return Some(own);
        }
        let tag = element.node.tag_name().name();
        let mut class = element.node.attribute("class").or(element.class).or(Some(MAIN));
        for _ in 0..=self.by_name.len() {
            let found = self.by_name.get(class?).or_else(|| self.by_name.get(MAIN))?;
            let inside = found.nodes.iter().flat_map(Node::children).filter(|n| n.is_element() && n.tag_name().name() == tag);
            if let Some(given) = inside.filter_map(|node| attribute(node, name)).next_back() {
                return Some(given);
            }
            class = found.outer;
        }
        None
    }
}

/// The class that the bodies and frames around a node give it.
pub(super) fn around<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    node.ancestors().skip(1).find_map(|outer| outer.attribute("childclass"))
}
