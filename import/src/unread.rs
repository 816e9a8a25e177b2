//! Parts of a file that nothing reads: names unknown to the format, and repeated elements after the first.
//!
//! The report counts elements that are left out. So there is a warning only for an element whose name is close to a known one: with
//! `orign` a joint would have the frame of its parent. Nothing counts attributes, so every unread attribute gets a warning.

use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::Span;
use armgen_codegen::suggest::did_you_mean;
use roxmltree::Node;

use crate::xml::{attribute, place, shown};
use crate::Code;

/// The most spellings to compare with known words. No file of an arm has more unread names.
const MOST: usize = 1000;

/// The permitted names of elements, or of attributes, in an element of each name.
pub(crate) type Known = [(&'static str, &'static [&'static str])];

fn known_of<'k>(known: &'k Known, element: &str) -> Option<&'k [&'static str]> {
    known.iter().find(|(name, _)| *name == element).map(|(_, known)| *known)
}

/// Warns of elements in the given ones that are nearly one that is read, and are not. Once for each spelling.
pub(crate) fn warn_of_elements<'a, 'i: 'a>(
    parents: impl Iterator<Item = Node<'a, 'i>>,
    known: &Known,
    diagnostics: &mut Diagnostics,
) {
    let mut seen = BTreeSet::new();
    for parent in parents {
        let parent_name = parent.tag_name().name();
        let Some(known) = known_of(known, parent_name) else { continue };
        for node in parent.children().filter(Node::is_element) {
            let name = node.tag_name().name();
            if known.contains(&name) || seen.len() == MOST || !seen.insert((parent_name, name)) {
                continue;
            }
            if let Some(meant) = did_you_mean(name, known) {
                let message = format!("nothing reads `{}` in {}; it is left out", shown(name), with_article(parent_name));
                let help = format!("did you mean `{meant}`?");
                diagnostics.push(Diagnostic::new(Code::MisspeltElement, place(node), message, "left out", help));
            }
        }
    }
}

/// Warns of attributes of the given elements that nothing reads: with `iz` an inertia has no `izz`. Once for each spelling. Those with a prefix
/// are another program's.
pub(crate) fn warn_of_attributes<'a, 'i: 'a>(
    nodes: impl Iterator<Item = Node<'a, 'i>>,
    known: &Known,
    diagnostics: &mut Diagnostics,
) {
    let mut seen = BTreeSet::new();
    for node in nodes {
        let element = node.tag_name().name();
        let Some(known) = known_of(known, element) else { continue };
        let lacking: Vec<&str> = known.iter().copied().filter(|name| attribute(node, name).is_none()).collect();
        let is_unread = |name: &str| !known.contains(&name);
        for found in node.attributes().filter(|found| found.namespace().is_none() && is_unread(found.name())) {
            let (name, place) = (found.name(), found.range_qname());
            let span = Span::new(place.start, place.end);
            if !seen.insert((element, name)) {
                continue;
            }
            if seen.len() > MOST {
                let message = "there are more attributes that nothing reads; they are left out";
                let help = "see whether the file is an arm's at all";
                diagnostics.push(Diagnostic::new(Code::UnreadAttribute, span, message, "the next one", help));
                return;
            }
            let (code, more, help) = match did_you_mean(name, &lacking) {
                Some(meant) => {
                    let more = format!(", and `{meant}` is taken as not given");
                    (Code::MisspeltAttribute, more, format!("did you mean `{meant}`?"))
                }
                None => (Code::UnreadAttribute, String::new(), what_is_read(element, known)),
            };
            let message = format!("nothing reads `{}` in `{element}`; it is left out{more}", shown(name));
            diagnostics.push(Diagnostic::new(code, span, message, "left out", help));
        }
    }
}

/// The help; it does not list attributes if there are many.
fn what_is_read(element: &str, known: &[&str]) -> String {
    match known {
        [only] => format!("of `{element}` only `{only}` is read: say it with that, or take it out"),
        [all @ .., last] if known.len() <= 6 => {
            format!("of `{element}` `{}` and `{last}` are read: say it with those, or take it out", all.join("`, `"))
        }
        _ => format!("say it with an attribute that `{element}` has, or take it out"),
    }
}

/// Warns of elements that stand a second time where the first one holds, once for each name; `single` names them by their parent.
pub(crate) fn warn_of_repeated<'a, 'i: 'a>(
    parents: impl Iterator<Item = Node<'a, 'i>>,
    single: &Known,
    diagnostics: &mut Diagnostics,
) {
    let mut repeated: BTreeMap<(&str, &str), Vec<(Span, Span)>> = BTreeMap::new();
    for parent in parents {
        let Some(single) = known_of(single, parent.tag_name().name()) else { continue };
        let mut first: BTreeMap<&str, Span> = BTreeMap::new();
        for node in parent.children().filter(|node| node.is_element() && single.contains(&node.tag_name().name())) {
            let name = node.tag_name().name();
            match first.get(name) {
                None => _ = first.insert(name, place(node)),
                Some(&first) => repeated.entry((parent.tag_name().name(), name)).or_default().push((first, place(node))),
            }
        }
    }
    for ((parent, name), places) in repeated {
        let (first, second) = places[0];
        let more = match places.len() {
            1 => String::new(),
            n => format!(", {n} times in the file"),
        };
        let message = format!("a second `{name}` in {} is left out: the first one holds{more}", with_article(parent));
        let fault = Diagnostic::new(Code::RepeatedElement, second, message, "left out", "take one of the two out");
        diagnostics.push(fault.also(first, "the first one"));
    }
}

/// "a `joint`", "an `inertial`".
fn with_article(element: &str) -> String {
    let article = if element.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} `{element}`")
}
