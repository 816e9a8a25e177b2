//! XML as a tree with places, within bounds that hold before anything is built from it.
//!
//! A scan of the text, linear in its length, counts elements, attributes of one element, nesting and declarations of namespaces.
//! A text beyond the bounds never reaches the parser: its search for duplicate attributes is quadratic, and it keeps all namespaces at
//! each element.

use std::borrow::Cow;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::{Source, Span};
use roxmltree::{Document, Error, Node, ParsingOptions};

use crate::Code;

/// Bytes of a file.
const MAX_BYTES: usize = 16 << 20;
/// Elements of a file.
const MAX_ELEMENTS: usize = 100_000;
/// Attributes of an element.
const MAX_ATTRIBUTES: usize = 1000;
/// Elements within each other.
pub(crate) const MAX_DEPTH: usize = 256;
/// Declarations of namespaces.
const MAX_NAMESPACES: usize = 100;

/// A text whose harmless slips are blanks, so that all places stay: an XML declaration behind blank lines or comments, and `--` in a comment.
/// XML allows neither; the parsers of ROS and MuJoCo read both.
pub(crate) fn without_harmless_slips(text: &str) -> Cow<'_, str> {
    let mut blanks: Vec<(usize, usize)> = Vec::new();
    let (mut end, mut at_top) = (0, true);
    for tag in (Tags { text, at: 0 }) {
        let (start, next) = match tag {
            Tag::Comment { start, end } | Tag::Instruction { start, end } => (start, end),
            Tag::Opening { start, .. } | Tag::Closing { start } => (start, start),
        };
        at_top &= text[end..start].trim().is_empty();
        match tag {
            Tag::Comment { start, end } => {
                let inside = (start + 4).min(end)..end.saturating_sub(3).max(start + 4).min(end);
                let bytes = &text.as_bytes()[inside.clone()];
                let slips = |&k: &usize| {
                    bytes[k] == b'-' && (bytes.get(k + 1).is_none_or(|&next| next == b'-') || (k > 0 && bytes[k - 1] == b'-'))
                };
                blanks.extend((0..bytes.len()).filter(slips).map(|k| (inside.start + k, inside.start + k + 1)));
            }
            Tag::Instruction { start, end } if start > 0 && at_top && is_declaration(&text[start..end]) => {
                blanks.push((start, end));
            }
            _ => {}
        }
        end = next;
        at_top &= matches!(tag, Tag::Comment { .. });
    }
    if blanks.is_empty() {
        return Cow::Borrowed(text);
    }
    let mut bytes = text.as_bytes().to_vec();
    blanks.into_iter().for_each(|(start, end)| bytes[start..end].fill(b' '));
    String::from_utf8(bytes).map_or(Cow::Borrowed(text), Cow::Owned)
}

/// Whether an instruction is the declaration of XML.
fn is_declaration(instruction: &str) -> bool {
    instruction.strip_prefix("<?xml").is_some_and(|rest| rest.starts_with(char::is_whitespace))
}

/// The tree of a text, that of the source with blanks in it; `None` with the fault reported.
pub(crate) fn parse<'s>(text: &'s str, source: &Source, diagnostics: &mut Diagnostics) -> Option<Document<'s>> {
    if let Err((at, what)) = scan(text) {
        let help = "an arm's file has far less: take out what is not about links and joints";
        diagnostics.push(Diagnostic::new(Code::TooLarge, Span::new(at, at), format!("the file has {what}"), "", help));
        return None;
    }
    if let Some(fault) = description_instead(source) {
        diagnostics.push(fault);
        return None;
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: u32::MAX, ..ParsingOptions::default() };
    match Document::parse_with_options(text, options) {
        Ok(document) => Some(document),
        Err(error) => {
            diagnostics.push(refusal(source, &error));
            None
        }
    }
}

fn refusal(source: &Source, error: &Error) -> Diagnostic {
    let text = source.text();
    // The parser gives no place to what a file ends without.
    let ends = matches!(error, Error::UnclosedRootNode | Error::UnexpectedEndOfStream);
    let at = if ends { text.trim_end().char_indices().last().map_or(0, |(at, _)| at) } else { offset(source, error.pos()) };
    let span = Span::new(at, character_end(text, at));
    if let Some(fault) = conflict(text) {
        return fault;
    }
    if let Some((message, help)) = entity(text, at, error) {
        return Diagnostic::new(Code::XmlSyntax, span, message, "here", help);
    }
    let opened = unclosed_quote(text, if ends { text.len() } else { at });
    if let Some((character, entity)) = opened.and_then(|opened| unescaped(text, opened, at)) {
        let message = format!("a value holds `{character}`, which XML takes for the beginning of something else");
        return Diagnostic::new(Code::XmlSyntax, span, message, "here", format!("write `{entity}` for it"));
    }
    if let Some(opened) = opened {
        let help = "close the value with the quote that it begins with";
        let message = "an attribute's value is not closed";
        return Diagnostic::new(Code::XmlSyntax, Span::new(opened, opened + 1), message, "opened here", help)
            .also(span, if ends { "the file ends here" } else { "this cannot stand inside it" });
    }
    let (code, message, help) = match error {
        Error::UnknownNamespace(prefix, _) if prefix == "xacro" => return xacro(span, source),
        Error::UnknownNamespace(prefix, _) => (
            Code::XmlSyntax,
            format!("the prefix `{}` has no namespace", shown(prefix)),
            "take elements and attributes with this prefix out, or declare it with `xmlns:`".to_owned(),
        ),
        Error::UnexpectedDeclaration(_) => (
            Code::XmlSyntax,
            "the XML declaration does not begin the file".to_owned(),
            "take out what stands before `<?xml ...?>`, or the declaration itself: nothing needs it".to_owned(),
        ),
        Error::UnknownToken(_) if outside(text, at).is_some() => return outside(text, at).expect("it was there"),
        Error::DtdDetected => (
            Code::XmlSyntax,
            "a document type definition stands here".to_owned(),
            "write what its entities stand for out, and take the definition out".to_owned(),
        ),
        Error::NoRootNode => (
            Code::XmlSyntax,
            "the file holds no element".to_owned(),
            "a URDF begins with `<robot name=\"...\">`, a MuJoCo model with `<mujoco>`".to_owned(),
        ),
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => (
            Code::XmlSyntax,
            "the file ends before its elements are closed".to_owned(),
            "see whether the rest of it is missing: each tag that is opened is closed".to_owned(),
        ),
        other => {
            // The message holds the place, which is shown anyway.
            let text = other.to_string().replacen(&format!(" at {}", other.pos()), "", 1);
            (
                Code::XmlSyntax,
                format!("not well-formed XML: {}", shown(&text)),
                "each tag that is opened is closed, each attribute is `name=\"value\"`".to_owned(),
            )
        }
    };
    let fault = Diagnostic::new(code, span, message, if ends { "ends here" } else { "here" }, help);
    // The parser reports an open element far below it, at the next mismatch.
    let open = match error {
        Error::UnexpectedCloseTag(..) => still_open(text, at),
        _ if ends => still_open(text, text.len()),
        _ => None,
    };
    match open {
        Some(open) => fault.also(open, "opened here, and not closed"),
        None => fault,
    }
}

/// The fault of an entity at a place, and the remedy.
fn entity(text: &str, at: usize, error: &Error) -> Option<(String, String)> {
    const ENTITIES: [&str; 5] = ["amp", "lt", "gt", "quot", "apos"];
    let word = text.get(at..)?.strip_prefix('&')?;
    let word = &word[..word.find(|c: char| !(c.is_alphanumeric() || c == '#')).unwrap_or(word.len())];
    let is_number = word.strip_prefix('#').is_some_and(|digits| digits.starts_with(|c: char| c.is_ascii_digit() || c == 'x'));
    match error {
        Error::UnknownEntityReference(name, _) => Some((
            format!("there is no entity `&{};`", shown(name)),
            "write what it stands for; XML itself has `&amp;`, `&lt;`, `&gt;`, `&quot;` and `&apos;`".to_owned(),
        )),
        Error::MalformedEntityReference(_) if ENTITIES.contains(&word) || is_number => {
            Some((format!("the entity `&{}` does not end", shown(word)), format!("end it with `;`: `&{};`", shown(word))))
        }
        Error::MalformedEntityReference(_) => {
            Some(("a `&` stands here, with which XML begins an entity".to_owned(), "write `&amp;` for it".to_owned()))
        }
        _ => None,
    }
}

/// The quote of a value, in the tag that a place is in, that is open there, or that is closed by the quote of the next value: `a="1 b="2"`.
fn unclosed_quote(text: &str, at: usize) -> Option<usize> {
    let tag = text.get(..at)?.rfind('<')?;
    if text[tag..].starts_with("<!") {
        return None;
    }
    let (mut open, mut closed) = (None, None);
    for (i, c) in text[tag..at].char_indices() {
        match open {
            None if c == '>' => return None,
            None if matches!(c, '"' | '\'') => open = Some((tag + i, c)),
            Some((from, quote)) if c == quote => (open, closed) = (None, Some((from, tag + i))),
            _ => {}
        }
    }
    let holds_a_name = |&(from, to): &(usize, usize)| text[from + 1..to].trim_end().ends_with('=');
    open.map(|(from, _)| from).or_else(|| closed.filter(holds_a_name).map(|(from, _)| from))
}

/// The character at a place within an open value that must be written as an entity, and that. A `<` after a `>` begins the next
/// tag, which does not belong to the open value.
fn unescaped(text: &str, opened: usize, at: usize) -> Option<(char, &'static str)> {
    match text[at..].chars().next()? {
        '&' => Some(('&', "&amp;")),
        '<' if !text[opened..at].contains('>') => Some(('<', "&lt;")),
        _ => None,
    }
}

/// Whether a text uses a property or an argument of xacro.
pub(crate) fn is_use(text: &str) -> bool {
    text.contains("${") || text.contains("$(")
}

/// A use of xacro at a place.
pub(crate) fn xacro(span: Span, source: &Source) -> Diagnostic {
    let name = source.name().rsplit(['/', '\\']).next().unwrap_or_default();
    // Standard input has no name that can be typed.
    let name = if name.contains(' ') { "ARM.urdf.xacro" } else { name };
    let stem = name.strip_suffix(".xacro").unwrap_or(name);
    let stem = stem.strip_suffix(".urdf").unwrap_or(stem);
    let out = if name == format!("{stem}.urdf") { format!("{stem}_full.urdf") } else { format!("{stem}.urdf") };
    let help = format!("write the file out and import that: `pip install xacro`, `xacro {} > {}`", shown(name), shown(&out));
    Diagnostic::new(Code::Xacro, span, "this is xacro, not a URDF", "not written out", help)
}

/// A description instead of a URDF.
fn description_instead(source: &Source) -> Option<Diagnostic> {
    let text = source.text();
    if text.trim_start().starts_with('<') {
        return None;
    }
    let key = |line: &&str| ["name:", "convention:", "joints:", "gravity:"].iter().any(|key| line.starts_with(key));
    let line = text.lines().find(key)?;
    let start = line.as_ptr() as usize - text.as_ptr() as usize;
    let message = "this is a description already, not a URDF or a MuJoCo model";
    let help = format!("type `armgen check {}`", source.name());
    let span = Span::new(start, start + line.find(':').unwrap_or_default());
    Some(Diagnostic::new(Code::XmlSyntax, span, message, "a key of robot.yaml", help))
}

/// Both sides of a merge in one file.
fn conflict(text: &str) -> Option<Diagnostic> {
    let line = text.lines().find(|line| line.starts_with("<<<<<<<"))?;
    let start = line.as_ptr() as usize - text.as_ptr() as usize;
    let message = "the file holds both sides of a merge that was not finished";
    let help = "keep one of the sides between `<<<<<<<` and `>>>>>>>`, and take the three lines of marks out";
    Some(Diagnostic::new(Code::XmlSyntax, Span::new(start, start + 7), message, "a merge conflict begins here", help))
}

/// The fault at a place outside of the root element.
fn outside(text: &str, at: usize) -> Option<Diagnostic> {
    let name_at = |start: usize| {
        let name = &text[start + 1..];
        &name[..name.find(|c: char| c.is_whitespace() || matches!(c, '>' | '/')).unwrap_or(name.len())]
    };
    let (mut depth, mut root, mut closing) = (0usize, None, None);
    for tag in (Tags { text, at: 0 }) {
        match tag {
            Tag::Opening { start, .. } if closing.is_some() => {
                if start < at {
                    return None;
                }
                break;
            }
            Tag::Opening { start, empty, .. } => {
                root = root.or(Some(start));
                depth += usize::from(!empty);
                closing = (depth == 0).then_some(start);
            }
            Tag::Closing { start } => {
                depth = depth.saturating_sub(1);
                closing = (depth == 0).then_some(start);
            }
            Tag::Comment { .. } | Tag::Instruction { .. } => {}
        }
        if closing.is_some() && root.is_some_and(|root| at < root) {
            break;
        }
    }
    let root = root?;
    let named = |start: usize| Span::new(start + 1, start + 1 + name_at(start).len());
    let first = shown(name_at(root));
    if at < root {
        let message = format!("text stands before the first element, `{first}`");
        let help = "take it out: an XML file begins with `<?xml ...?>`, a comment or its root element";
        return Some(Diagnostic::new(Code::XmlSyntax, Span::new(at, character_end(text, at)), message, "here", help));
    }
    let closing = closing.filter(|&closing| closing < at)?;
    let (span, message, help) = match text[at..].starts_with('<') {
        true if name_at(at) == name_at(root) => {
            let called = |start: usize| called(&text[start..]).map_or(String::new(), |name| format!(" `{}`", shown(name)));
            let message = format!("the file holds two of `{first}`:{} and{}", called(root), called(at));
            (named(at), message, format!("put the second one into a file of its own: a file has one `{first}`"))
        }
        true => {
            let second = shown(name_at(at));
            let message = format!("`{second}` stands behind the end of `{first}`");
            (named(at), message, format!("move `</{first}>` to the end of the file, or take what follows it out"))
        }
        false => {
            let message = format!("text stands behind the end of `{first}`");
            (Span::new(at, character_end(text, at)), message, "take it out".to_owned())
        }
    };
    let ended = Span::new(closing, character_end(text, closing));
    Some(Diagnostic::new(Code::XmlSyntax, span, message, "here", help).also(ended, "the first element ends here"))
}

/// The `name` or `model` in the tag that a text begins with.
fn called(text: &str) -> Option<&str> {
    let tag = &text[..text.find('>')?];
    let value = ["name=", "model="].iter().find_map(|key| tag.split_once(key)).map(|(_, value)| value.trim_start())?;
    let quote = value.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
    value[1..].split(quote).next()
}

/// The byte at a line and column of the parser, both from 1.
fn offset(source: &Source, place: roxmltree::TextPos) -> usize {
    let text = source.text();
    let line: usize = text.split_inclusive('\n').take(place.row.saturating_sub(1) as usize).map(str::len).sum();
    let column = place.col.saturating_sub(1) as usize;
    let within = text[line..].char_indices().nth(column).map_or(text.len() - line, |(at, _)| at);
    line + within
}

/// A text of the file for a message: not too long.
pub(crate) fn shown(text: &str) -> String {
    armgen_codegen::document::excerpt(text)
}

/// A tag of a text.
enum Tag {
    /// `<name ...>`, or `<name .../>`, which is empty.
    Opening { start: usize, attributes: usize, namespaces: usize, empty: bool },
    /// `</name>`.
    Closing { start: usize },
    /// `<!-- ... -->`.
    Comment { start: usize, end: usize },
    /// `<? ... ?>`.
    Instruction { start: usize, end: usize },
}

/// The tags of a text, well-formed or not, in one pass.
struct Tags<'t> {
    text: &'t str,
    at: usize,
}

impl Iterator for Tags<'_> {
    type Item = Tag;

    fn next(&mut self) -> Option<Tag> {
        let (text, bytes) = (self.text, self.text.as_bytes());
        let after = |from: usize, end: &str| text[from..].find(end).map_or(bytes.len(), |found| from + found + end.len());
        loop {
            let start = self.at + text[self.at..].find('<')?;
            let rest = &bytes[start..];
            self.at = if rest.starts_with(b"<!--") {
                let end = after(start + 4, "-->");
                self.at = end;
                return Some(Tag::Comment { start, end });
            } else if rest.starts_with(b"<![CDATA[") {
                after(start + 9, "]]>")
            } else if rest.starts_with(b"<?") {
                let end = after(start + 2, "?>");
                self.at = end;
                return Some(Tag::Instruction { start, end });
            } else if rest.starts_with(b"</") {
                self.at = after(start + 2, ">");
                return Some(Tag::Closing { start });
            } else {
                let (mut quote, mut attributes, mut namespaces, mut end) = (None, 0, 0, start + 1);
                while let Some(&byte) = bytes.get(end) {
                    match (quote, byte) {
                        (Some(open), _) if byte == open => quote = None,
                        (Some(_), _) => {}
                        (None, b'"' | b'\'') => quote = Some(byte),
                        (None, b'=') => {
                            attributes += 1;
                            namespaces += usize::from(name_before(&text[start..end]).starts_with("xmlns"));
                        }
                        (None, b'>') => break,
                        _ => {}
                    }
                    end += 1;
                }
                self.at = (end + 1).min(bytes.len());
                let empty = bytes.get(end.wrapping_sub(1)) == Some(&b'/');
                return Some(Tag::Opening { start, attributes, namespaces, empty });
            };
        }
    }
}

/// The name of an attribute whose sign of equality ends a text.
fn name_before(text: &str) -> &str {
    text.trim_end().rsplit(|c: char| c.is_whitespace() || matches!(c, '=' | '"' | '\'' | '<')).next().unwrap_or_default()
}

/// Counts; where something is too much, the place and what.
fn scan(text: &str) -> Result<(), (usize, String)> {
    if text.len() > MAX_BYTES {
        return Err((0, format!("{} bytes, more than {MAX_BYTES}", text.len())));
    }
    let (mut elements, mut declared, mut depth) = (0, 0, 0usize);
    for tag in (Tags { text, at: 0 }) {
        let Tag::Opening { start, attributes, namespaces, empty } = tag else {
            depth = depth.saturating_sub(usize::from(matches!(tag, Tag::Closing { .. })));
            continue;
        };
        elements += 1;
        declared += namespaces;
        depth += usize::from(!empty);
        if elements > MAX_ELEMENTS {
            return Err((start, format!("more than {MAX_ELEMENTS} elements")));
        }
        if attributes > MAX_ATTRIBUTES {
            return Err((start, format!("an element with more than {MAX_ATTRIBUTES} attributes")));
        }
        if declared > MAX_NAMESPACES {
            return Err((start, format!("more than {MAX_NAMESPACES} declarations of namespaces (`xmlns`)")));
        }
        if depth > MAX_DEPTH {
            return Err((start, format!("more than {MAX_DEPTH} elements within each other")));
        }
    }
    Ok(())
}

/// The tag that is still open in front of a place, the innermost one: its name.
fn still_open(text: &str, before: usize) -> Option<Span> {
    let mut open = Vec::new();
    for tag in (Tags { text, at: 0 }) {
        match tag {
            Tag::Opening { start, .. } | Tag::Closing { start } if start >= before => break,
            Tag::Opening { empty: true, .. } => {}
            Tag::Opening { start, .. } => open.push(start),
            Tag::Closing { .. } => _ = open.pop(),
            Tag::Comment { .. } | Tag::Instruction { .. } => {}
        }
    }
    let start = open.pop()? + 1;
    let name = text[start..].find(|c: char| c.is_whitespace() || matches!(c, '>' | '/')).unwrap_or(text.len() - start);
    Some(Span::new(start, start + name))
}

/// A place that nothing in the file belongs to: its beginning.
pub(crate) fn beginning() -> Span {
    Span::new(0, 0)
}

/// The place of an element: its opening tag's name.
pub(crate) fn place(node: Node<'_, '_>) -> Span {
    let start = node.range().start;
    let end = start + node.tag_name().name().len();
    Span::new(start, character_end(node.document().input_text(), end))
}

/// The first end of a character after a place.
fn character_end(text: &str, at: usize) -> usize {
    (at + 1..text.len()).find(|&end| text.is_char_boundary(end)).unwrap_or(text.len())
}

/// The first child of a name without namespace.
pub(crate) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|n| n.is_element() && n.tag_name().name() == name)
}

/// Text and place of an attribute.
pub(crate) fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Option<(&'a str, Span)> {
    let attribute = node.attributes().find(|a| a.name() == name && a.namespace().is_none())?;
    let range = attribute.range_value();
    Some((attribute.value(), Span::new(range.start, range.end)))
}
