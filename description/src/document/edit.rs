//! New values in the text of a file; every other byte stays.
//!
//! A change names its value by keys and places in lists. A value that is there is replaced in place, its quotes kept. A key that is missing is
//! added in the style of its mapping. An alias with changes in it, or in the value that it copies, is written out.
//! Behind the line of a change comes a comment, after the user's own. In the end the new text is read again and compared with the old tree.

use std::collections::BTreeMap;

use super::excerpt;
use super::yaml::{self, Kind, Node, Scalar};
use crate::diagnostic::Diagnostics;
use crate::source::{Source, Span};

/// A step from a value to one in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// The value of a key.
    Key(String),
    /// A place in a list, from 0.
    Item(usize),
}

/// A new value.
#[derive(Clone, Debug)]
pub struct Change {
    /// Where it is.
    pub path: Vec<Step>,
    /// Its text: a number.
    pub value: String,
    /// What the comment says of it.
    pub remark: String,
}

impl Change {
    /// Its last key, and its place in a list: `com[0]`.
    pub fn label(&self) -> String {
        match self.path.as_slice() {
            [.., Step::Key(key), Step::Item(place)] => format!("{key}[{place}]"),
            [.., Step::Key(key)] => key.clone(),
            _ => String::new(),
        }
    }
}

/// A text with new values.
#[derive(Clone, Debug)]
pub struct Edited {
    /// The text.
    pub text: String,
    /// What was done beside the replacement of values, with its place in the old text.
    pub notes: Vec<(Span, String)>,
}

/// The text of a source with new values, each with the comment `# MARK: remark`. Comments of this mark from before are replaced.
///
/// # Errors
///
/// A place and the reason, if a value cannot be written there.
pub fn edit(source: &Source, mark: &str, changes: &[Change]) -> Result<Edited, (Span, String)> {
    let nowhere = || (Span::default(), "the text is not YAML".to_owned());
    let old = yaml::read(source, &mut Diagnostics::new()).ok_or_else(nowhere)?;
    let all: Vec<&Change> = changes.iter().collect();
    let mut editor = Editor { source, mark, ..Editor::new(source) };
    editor.scalars(&old);
    editor.touch(&old, &all, 0);
    editor.visit(&old, &all, 0)?;
    let edited = editor.finish();
    let new = yaml::read(&Source::new("", edited.text.as_str()), &mut Diagnostics::new());
    match new {
        Some(new) if agrees(Some(&old), &new, &all, 0) => Ok(edited),
        _ => Err((Span::default(), "the style of this file does not allow new values in place".to_owned())),
    }
}

struct Editor<'s> {
    source: &'s Source,
    mark: &'s str,
    /// Ranges of the old text with their new texts; at one place in order.
    edits: Vec<(usize, usize, String)>,
    /// By the end of a line of the old text.
    remarks: BTreeMap<usize, Vec<String>>,
    /// New lines, by the end of the line before them.
    lines: BTreeMap<usize, Vec<String>>,
    /// Places of keys and single values.
    scalars: Vec<Span>,
    /// Where values change in place.
    touched: Vec<usize>,
    notes: Vec<(Span, String)>,
}

/// Changes that go on with a step.
fn under<'c>(changes: &[&'c Change], depth: usize, step: &Step) -> Vec<&'c Change> {
    changes.iter().copied().filter(|change| change.path.get(depth) == Some(step)).collect()
}

/// Keys that changes go on with and that a mapping does not have, in their order.
fn missing<'c>(entries: &[(crate::source::Spanned<String>, Node)], changes: &[&'c Change], depth: usize) -> Vec<&'c str> {
    let mut keys: Vec<&str> = Vec::new();
    for change in changes {
        if let Some(Step::Key(key)) = change.path.get(depth) {
            if !keys.contains(&key.as_str()) && entries.iter().all(|(known, _)| known.value != *key) {
                keys.push(key);
            }
        }
    }
    keys
}

fn key(name: &str) -> Step {
    Step::Key(name.to_owned())
}

/// A text as a value between brackets.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04x}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

fn in_brackets(text: &str, plain: bool) -> String {
    let simple = |c: char| c.is_alphanumeric() || " _-+*/().".contains(c);
    // A minus before a space would begin an item of a list.
    let begins = |text: &str| text.starts_with(|c: char| c.is_alphanumeric() || "_+/().".contains(c));
    let is_negative =
        text.strip_prefix('-').is_some_and(|rest| rest.starts_with(|c: char| c.is_alphanumeric() || ".(".contains(c)));
    if plain && (begins(text) || is_negative) && text.chars().all(simple) && text.trim() == text {
        text.to_owned()
    } else {
        quoted(text)
    }
}

/// A value between brackets, with its changes.
fn flow(node: Option<&Node>, changes: &[&Change], depth: usize) -> String {
    if let Some(change) = changes.iter().find(|change| change.path.len() == depth) {
        return change.value.clone();
    }
    match node.map(|node| &node.kind) {
        Some(Kind::Scalar(Scalar { text, plain, .. })) => in_brackets(text, *plain),
        Some(Kind::List(items)) => {
            let items = items.iter().enumerate();
            let items: Vec<String> =
                items.map(|(k, item)| flow(Some(item), &under(changes, depth, &Step::Item(k)), depth + 1)).collect();
            format!("[{}]", items.join(", "))
        }
        None if matches!(changes.first().and_then(|change| change.path.get(depth)), Some(Step::Item(_))) => {
            let items: Vec<String> = (0..changes.len())
                .map(|k| under(changes, depth, &Step::Item(k)))
                .take_while(|own| !own.is_empty())
                .map(|own| flow(None, &own, depth + 1))
                .collect();
            format!("[{}]", items.join(", "))
        }
        mapping => {
            let entries: &[_] = match mapping {
                Some(Kind::Mapping(entries)) => entries,
                _ => &[],
            };
            let old = entries.iter().map(|(name, value)| {
                let value = flow(Some(value), &under(changes, depth, &key(&name.value)), depth + 1);
                format!("{}: {value}", in_brackets(&name.value, true))
            });
            let new = missing(entries, changes, depth);
            let new = new.iter().map(|name| format!("{name}: {}", flow(None, &under(changes, depth, &key(name)), depth + 1)));
            format!("{{{}}}", old.chain(new).collect::<Vec<_>>().join(", "))
        }
    }
}

/// Whether a new tree is the old one with the changes.
fn agrees(old: Option<&Node>, new: &Node, changes: &[&Change], depth: usize) -> bool {
    if let Some(change) = changes.iter().find(|change| change.path.len() == depth) {
        return changes.len() == 1 && matches!(&new.kind, Kind::Scalar(scalar) if scalar.text == change.value);
    }
    match (old.map(|old| &old.kind), &new.kind) {
        (Some(Kind::Scalar(old)), Kind::Scalar(new)) => {
            changes.is_empty() && old.text == new.text && old.is_nothing() == new.is_nothing()
        }
        (Some(Kind::List(_)) | None, Kind::List(new)) => {
            let old: &[Node] = match old.map(|old| &old.kind) {
                Some(Kind::List(old)) => old,
                _ => &[],
            };
            let mut all = new.iter().enumerate();
            let last = changes.iter().filter_map(|change| match change.path.get(depth) {
                Some(Step::Item(k)) => Some(k + 1),
                _ => None,
            });
            new.len() == old.len().max(last.max().unwrap_or(0))
                && all.all(|(k, new)| agrees(old.get(k), new, &under(changes, depth, &Step::Item(k)), depth + 1))
        }
        (Some(Kind::Mapping(_)) | None, Kind::Mapping(new)) => {
            let old: &[_] = match old.map(|old| &old.kind) {
                Some(Kind::Mapping(old)) => old,
                _ => &[],
            };
            let all = new.iter().map(|(name, new)| {
                let of_old = old.iter().find(|(known, _)| known.value == name.value).map(|(_, old)| old);
                let own = under(changes, depth, &key(&name.value));
                (of_old.is_some() || !own.is_empty()) && agrees(of_old, new, &own, depth + 1)
            });
            new.len() == old.len() + missing(old, changes, depth).len() && all.into_iter().all(|same| same)
        }
        _ => false,
    }
}

impl<'s> Editor<'s> {
    fn new(source: &'s Source) -> Editor<'s> {
        Editor {
            source,
            mark: "",
            edits: Vec::new(),
            remarks: BTreeMap::new(),
            lines: BTreeMap::new(),
            scalars: Vec::new(),
            touched: Vec::new(),
            notes: Vec::new(),
        }
    }

    fn scalars(&mut self, node: &Node) {
        if node.alias.is_some() {
            return;
        }
        match &node.kind {
            Kind::Scalar(_) => self.scalars.push(node.span),
            Kind::List(items) => items.iter().for_each(|item| self.scalars(item)),
            Kind::Mapping(entries) => entries.iter().for_each(|(key, value)| {
                self.scalars.push(key.span);
                self.scalars(value);
            }),
        }
    }

    /// Notes where values change in place, since aliases of what holds them copy the new values.
    fn touch(&mut self, node: &Node, changes: &[&Change], depth: usize) {
        if node.alias.is_some() || changes.is_empty() {
            return;
        }
        match &node.kind {
            Kind::Scalar(_) => self.touched.push(node.span.start),
            Kind::List(items) => {
                for (k, item) in items.iter().enumerate() {
                    self.touch(item, &under(changes, depth, &Step::Item(k)), depth + 1);
                }
            }
            Kind::Mapping(entries) => {
                if !missing(entries, changes, depth).is_empty() {
                    self.touched.push(node.span.start);
                }
                for (name, value) in entries {
                    self.touch(value, &under(changes, depth, &key(&name.value)), depth + 1);
                }
            }
        }
    }

    fn visit(&mut self, node: &Node, changes: &[&Change], depth: usize) -> Result<(), (Span, String)> {
        if let Some(alias) = node.alias {
            let copies = self.touched.iter().any(|at| node.span.range().contains(at));
            if copies || !changes.is_empty() {
                self.edits.push((alias.start, alias.end, flow(Some(node), changes, depth)));
                let name = excerpt(self.source.slice(alias));
                self.notes.push((alias, format!("`{name}` is written out, since the values there are no longer the same")));
                changes.iter().for_each(|change| self.remark(alias.end, change));
            }
            return Ok(());
        }
        match &node.kind {
            Kind::Scalar(scalar) => match changes {
                [] => Ok(()),
                [change] if change.path.len() == depth => self.replace(node.span, scalar, change),
                _ => Err((node.span, "a list or a mapping is wanted here".to_owned())),
            },
            Kind::List(items) => {
                for (k, item) in items.iter().enumerate() {
                    self.visit(item, &under(changes, depth, &Step::Item(k)), depth + 1)?;
                }
                Ok(())
            }
            Kind::Mapping(entries) => {
                for (name, value) in entries {
                    self.visit(value, &under(changes, depth, &key(&name.value)), depth + 1)?;
                }
                for (k, name) in missing(entries, changes, depth).into_iter().enumerate() {
                    self.add(node, name, k, &under(changes, depth, &key(name)), depth + 1);
                }
                Ok(())
            }
        }
    }

    fn replace(&mut self, span: Span, scalar: &Scalar, change: &Change) -> Result<(), (Span, String)> {
        let text = self.source.slice(span);
        let (start, end) = match (scalar.plain, text.chars().next()) {
            (true, _) => (span.start, span.start + text.trim_end().len()),
            (false, Some('"' | '\'')) => (span.start + 1, span.end - 1),
            _ => return Err((span, "this number is a block text: write it behind its key, on one line".to_owned())),
        };
        self.edits.push((start, end, change.value.clone()));
        self.remark(span.start + text.trim_end().len(), change);
        Ok(())
    }

    /// Adds a key to a mapping, after `others` that were added before it.
    fn add(&mut self, node: &Node, name: &str, others: usize, changes: &[&Change], depth: usize) {
        let Kind::Mapping(entries) = &node.kind else { return };
        let entry = format!("{name}: {}", flow(None, changes, depth));
        let (first, last) = match (entries.first(), entries.last()) {
            (Some((first, _)), Some((_, last))) => (first.span, last.place().end),
            _ => {
                let at = node.span.start + 1;
                self.edits.push((at, at, if others == 0 { entry } else { format!(", {entry}") }));
                changes.iter().for_each(|change| self.remark(at, change));
                return;
            }
        };
        if self.source.slice(node.span).starts_with('{') {
            self.edits.push((last, last, format!(", {entry}")));
            changes.iter().for_each(|change| self.remark(last, change));
            return;
        }
        let text = self.source.text();
        let start = text[..first.start].rfind(['\n', '\r']).map_or(0, |at| at + 1);
        let indent = " ".repeat(text[start..first.start].chars().count());
        let remarks: Vec<String> = changes.iter().map(|change| self.worded(change, changes.len() == 1)).collect();
        let line = format!("{indent}{entry}  # {}: {}", self.mark, remarks.join("; "));
        self.lines.entry(self.end_of_line(last)).or_default().push(line);
    }

    fn worded(&self, change: &Change, alone: bool) -> String {
        if alone {
            change.remark.clone()
        } else {
            format!("{} {}", change.label(), change.remark)
        }
    }

    fn end_of_line(&self, at: usize) -> usize {
        self.source.text()[at..].find(['\n', '\r']).map_or(self.source.text().len(), |length| at + length)
    }

    fn in_a_text(&self, at: usize) -> bool {
        self.scalars.iter().any(|span| span.start < at && at < span.end)
    }

    /// A remark behind the line of a place.
    fn remark(&mut self, at: usize, change: &Change) {
        let end = self.end_of_line(at);
        if self.in_a_text(end) {
            let note = format!("no comment fits behind `{}`: {}", change.label(), change.remark);
            self.notes.push((Span::new(at, at), note));
            return;
        }
        self.remarks.entry(end).or_default().push(format!("{}\u{0}{}", change.label(), change.remark));
    }

    fn finish(mut self) -> Edited {
        let text = self.source.text();
        let newline = |end: usize| match text.get(end..).unwrap_or_default() {
            "" if text.contains("\r\n") => "\r\n",
            rest if rest.starts_with("\r\n") => "\r\n",
            rest if rest.starts_with('\r') => "\r",
            _ => "\n",
        };
        let ours = format!("# {}: ", self.mark);
        let mut edits: Vec<(usize, usize, String)> = Vec::new();
        for (end, remarks) in &self.remarks {
            let start = text[..*end].rfind(['\n', '\r']).map_or(0, |at| at + 1);
            let earlier = text[start..*end].rfind(&ours).map(|at| start + at).filter(|at| !self.in_a_text(at + 1));
            let from = earlier.map_or(*end, |at| start + text[start..at].trim_end_matches(' ').len());
            let words = |remark: &String| match (remark.split_once('\u{0}'), remarks.len()) {
                (Some((_, remark)), 1) => remark.to_owned(),
                (Some((label, remark)), _) => format!("{label} {remark}"),
                (None, _) => remark.clone(),
            };
            let words: Vec<String> = remarks.iter().map(words).collect();
            edits.push((from, *end, format!(" {ours}{}", words.join("; "))));
        }
        for (end, lines) in &self.lines {
            let lines: String = lines.iter().map(|line| format!("{}{line}", newline(*end))).collect();
            edits.push((*end, *end, lines));
        }
        self.edits.append(&mut edits);
        // Stable: at one place values come before comments, and these before new lines.
        self.edits.sort_by_key(|(start, ..)| *start);
        let (mut new, mut at) = (String::new(), 0);
        for (start, end, value) in &self.edits {
            new += text.get(at..*start).unwrap_or("");
            new += value;
            at = (*end).max(at);
        }
        new += &text[at..];
        Edited { text: new, notes: self.notes }
    }
}

#[cfg(test)]
mod tests {
    use super::{edit, Change, Step};
    use crate::source::Source;

    fn change(path: &str, value: &str) -> Change {
        let step = |part: &str| part.parse().map_or_else(|_| Step::Key(part.to_owned()), Step::Item);
        Change { path: path.split('.').map(step).collect(), value: value.to_owned(), remark: "r".to_owned() }
    }

    #[track_caller]
    fn check(text: &str, changes: &[(&str, &str)], expected: &str) {
        let changes: Vec<Change> = changes.iter().map(|(path, value)| change(path, value)).collect();
        match edit(&Source::new("t", text), "new", &changes) {
            Ok(edited) => assert_eq!(edited.text, expected),
            Err(error) => panic!("{error:?}"),
        }
    }

    #[test]
    fn values_change_in_place_and_comments_come_last() {
        check("a: 1   # mine\nb: '2'\t\n", &[("a", "3"), ("b", "4")], "a: 3   # mine # new: r\nb: '4'\t # new: r\n");
        check("a: {b: 1, c: [1, 2]}", &[("a.b", "5"), ("a.c.1", "6")], "a: {b: 5, c: [1, 6]} # new: b r; c[1] r");
        check("a: {b: 1,\r\n  c: 2}\r\n", &[("a.b", "5")], "a: {b: 5, # new: r\r\n  c: 2}\r\n");
        check("a: 1 # new: old\n", &[("a", "2")], "a: 2 # new: r\n");
        check("a: \"1\"\nb: \"# new: x\"\n", &[("b", "2")], "a: \"1\"\nb: \"2\" # new: r\n");
    }

    #[test]
    fn missing_keys_are_added_in_the_style_of_their_mapping() {
        check("a:\n  b: 1  # x\n\nc: 2\n", &[("a.d", "5")], "a:\n  b: 1  # x\n  d: 5  # new: r\n\nc: 2\n");
        check("a: {}\n", &[("a.d.e", "5")], "a: {d: {e: 5}} # new: r\n");
        check("- a: 1\r\n", &[("0.d.0", "5"), ("0.d.1", "6")], "- a: 1\r\n  d: [5, 6]  # new: d[0] r; d[1] r\r\n");
        check("a: {b: 1}", &[("a.c", "2")], "a: {b: 1, c: 2} # new: r");
    }

    #[test]
    fn aliases_are_written_out_where_values_differ() {
        check(
            "a: &x {b: 1, c: 2}\nd: *x\n",
            &[("a.b", "5"), ("d.b", "6")],
            "a: &x {b: 5, c: 2} # new: r\nd: {b: 6, c: 2} # new: r\n",
        );
        // The second is none of the changes, and keeps its value.
        check("a: &x 1\nd: *x\n", &[("a", "5")], "a: &x 5 # new: r\nd: 1\n");
        check(
            "a:\n  b: &x\n    c: 1\n  d: *x\ne: 1\n",
            &[("a.f", "5")],
            "a:\n  b: &x\n    c: 1\n  d: *x\n  f: 5  # new: r\ne: 1\n",
        );
    }

    #[test]
    fn a_comment_never_enters_a_text() {
        let text = "a: {b: 1, c: \"x\n  y\"}\n";
        let edited = edit(&Source::new("t", text), "new", &[change("a.b", "2")]).expect("a place");
        assert_eq!((edited.text.as_str(), edited.notes.len()), ("a: {b: 2, c: \"x\n  y\"}\n", 1));
        let refused = edit(&Source::new("t", "a: |\n  1\n"), "new", &[change("a", "2")]);
        assert!(refused.is_err(), "{refused:?}");
    }
}
