//! Attributes that an element takes from its class: `default`, nested, and the classes that bodies and frames name for what is in them.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Span;
use roxmltree::Node;

use crate::tree::{meant, GUESSES};
use crate::xml::{attribute, shown, MAX_DEPTH};
use crate::Code;

/// An element of a body, with the class that the bodies around it give it.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 'i> {
    pub(super) node: Node<'a, 'i>,
    pub(super) class: Option<&'a str>,
}

/// A class: the values of the `default` elements of its name, by element and attribute, and the enclosing class.
#[derive(Default)]
struct Class<'a> {
    given: BTreeMap<(&'a str, &'a str), (&'a str, Span)>,
    outer: Option<&'a str>,
}

/// All classes by name.
pub(super) struct Classes<'a> {
    by_name: BTreeMap<&'a str, Class<'a>>,
}

/// The class that holds everywhere.
const MAIN: &str = "main";

impl<'a> Classes<'a> {
    pub(super) fn read<'i>(root: Node<'a, 'i>) -> Classes<'a> {
        let mut by_name: BTreeMap<&'a str, Class<'a>> = BTreeMap::new();
        let defaults = |node: Node<'a, 'i>| node.children().filter(|n| n.is_element() && n.tag_name().name() == "default");
        let mut open: Vec<(Node<'a, 'i>, Option<&'a str>)> = defaults(root).map(|node| (node, None)).collect();
        while let Some((node, outer)) = open.pop() {
            let name = if outer.is_none() { MAIN } else { node.attribute("class").unwrap_or(MAIN) };
            // A nested class of the name of one around it would be its own outer one.
            let outer = outer.filter(|outer| *outer != name && !by_name.contains_key(name));
            open.extend(defaults(node).map(|inner| (inner, Some(name))));
            let class = by_name.entry(name).or_default();
            for inner in node.children().filter(Node::is_element) {
                // The last one of several holds.
                let tag = inner.tag_name().name();
                let named = inner.attributes().filter(|attribute| attribute.namespace().is_none());
                class.given.extend(named.map(|found| {
                    let place = found.range_value();
                    ((tag, found.name()), (found.value(), Span::new(place.start, place.end)))
                }));
            }
            class.outer = class.outer.or(outer);
        }
        // The class at the top may have a name of its own, by which it is called, too.
        for node in defaults(root) {
            if let Some(name) = node.attribute("class").filter(|name| *name != MAIN && !by_name.contains_key(name)) {
                by_name.insert(name, Class { outer: Some(MAIN), ..Class::default() });
            }
        }
        Classes { by_name }
    }

    /// Reports elements that name a class that there is none of. The elements of `default` are what makes a class.
    pub(super) fn refuse_unknown(&self, root: Node<'a, '_>, diagnostics: &mut Diagnostics) {
        // The class may be in the file that is to be included, or in the one that this one is a part of: both are told.
        let tags = || root.descendants().filter(Node::is_element).map(|node| node.tag_name().name());
        if tags().any(|tag| tag == "include") || !tags().any(|tag| tag == "worldbody") {
            return;
        }
        let mut guesses = GUESSES;
        let sections = root.children().filter(|section| section.tag_name().name() != "default");
        let named = sections.flat_map(|section| section.descendants()).filter(Node::is_element);
        for (name, span) in named.flat_map(|node| ["class", "childclass"].into_iter().filter_map(move |key| attribute(node, key)))
        {
            if name == MAIN || self.by_name.contains_key(name) {
                continue;
            }
            // Of the first few only: there may be as many classes as elements.
            let help = match guesses {
                0 => "name a class that a `default` has".to_owned(),
                _ if self.by_name.is_empty() => {
                    "the file has no `default`: add the one of this class, from the file that the model was taken from".to_owned()
                }
                _ => meant(name, &self.by_name.keys().copied().collect::<Vec<_>>()),
            };
            guesses = guesses.saturating_sub(1);
            let message = format!("there is no class `{}` of defaults", shown(name));
            diagnostics.push(Diagnostic::new(Code::UnknownClass, span, message, "unknown class", help));
        }
    }

    /// Text and place of an attribute: the element's own, or that of its class, or of one around that.
    pub(super) fn attribute(&self, element: Element<'a, '_>, name: &str) -> Option<(&'a str, Span)> {
        if let Some(own) = attribute(element.node, name) {
            return Some(own);
        }
        let tag = element.node.tag_name().name();
        let mut class = element.node.attribute("class").or(element.class).or(Some(MAIN));
        // Classes stand within each other, so there are no more of them than elements may.
        for _ in 0..=MAX_DEPTH {
            let found = self.by_name.get(class?)?;
            if let Some(given) = found.given.get(&(tag, name)) {
                return Some(*given);
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
