//! YAML text -> a tree of nodes, each with its place.
//!
//! The tree is built from the events of a YAML parser, not through serde. So scalars keep the text of the file, every duplicate key is
//! found (not only the first), and aliases, tags and second documents are judged at their places.
//! Absent from here on: YAML syntax, anchors and aliases (each alias becomes a copy of its node), duplicate keys.

mod cause;

use std::collections::BTreeMap;

use serde_yaml::granit_parser::{options, ErrorKind, Event, Parser, ScalarStyle, ScanError, Span as ParserSpan, StructureStyle};

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::source::{Source, Span, Spanned};

/// No description needs more text than this, in bytes.
pub const MAX_TEXT: usize = 256 * 1024;
/// No description nests deeper.
const MAX_DEPTH: usize = 24;
/// Nodes after the copying of aliases.
const MAX_NODES: usize = 200_000;
/// Bytes that the copying of aliases adds.
const MAX_COPIED: usize = 1 << 20;

/// A value in the tree.
#[derive(Clone, Debug)]
pub struct Node {
    /// Its place, without the key before it; of a copy by an alias, that of the original.
    pub span: Span,
    /// Place of the alias that this is a copy by.
    pub alias: Option<Span>,
    /// Its kind.
    pub kind: Kind,
}

/// Kinds of values.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A text, quoted or not.
    Scalar(Scalar),
    /// A list.
    List(Vec<Node>),
    /// Keys and values in the order of the file; no key twice.
    Mapping(Vec<(Spanned<String>, Node)>),
}

/// A text.
#[derive(Clone, Debug)]
pub struct Scalar {
    /// The text, quotes and escapes resolved.
    pub text: String,
    /// Whether it stands without quotes, so that YAML gives `~` and the like a meaning of their own.
    pub plain: bool,
    /// Offset of the text in the source, if the source has it letter by letter.
    pub verbatim: Option<usize>,
}

impl Node {
    /// Where it is written: of a copy by an alias, the place of the alias.
    pub fn place(&self) -> Span {
        self.alias.unwrap_or(self.span)
    }

    /// The kind of node, for a message.
    pub fn describe(&self) -> &'static str {
        match &self.kind {
            Kind::Scalar(s) if s.is_nothing() => "nothing",
            Kind::Scalar(_) => "a single value",
            Kind::List(_) => "a list",
            Kind::Mapping(_) => "a mapping",
        }
    }

    /// Number of nodes in it, and bytes of their texts.
    fn size(&self) -> (usize, usize) {
        let sum = |a: (usize, usize), b: (usize, usize)| (a.0 + b.0, a.1 + b.1);
        match &self.kind {
            Kind::Scalar(scalar) => (1, scalar.text.len()),
            Kind::List(items) => items.iter().map(Node::size).fold((1, 0), sum),
            Kind::Mapping(entries) => {
                entries.iter().map(|(key, value)| sum((1, key.value.len()), value.size())).fold((1, 0), sum)
            }
        }
    }
}

impl Scalar {
    /// Whether nothing stands here, or YAML's word for nothing.
    pub fn is_nothing(&self) -> bool {
        self.plain && matches!(self.text.as_str(), "" | "~" | "null" | "Null" | "NULL")
    }
}

/// The tree of `source`; `None` for a text without a tree.
pub fn read(source: &Source, diagnostics: &mut Diagnostics) -> Option<Node> {
    let text = source.text();
    if text.len() > MAX_TEXT {
        diagnostics.push(Diagnostic::new(
            Code::TooLarge,
            Span::new(0, 0),
            format!("the file has {} bytes, more than the {MAX_TEXT} that are read", text.len()),
            "",
            "describe one robot per file; a description of 32 joints has some 30 000 bytes",
        ));
        return None;
    }
    let options = options! {
        emit_comments: false,
        disallow_directives: true,
        flow_nesting_limit: MAX_DEPTH,
        block_nesting_limit: MAX_DEPTH,
    };
    let builder = Builder { source, diagnostics, open: Vec::new(), anchors: BTreeMap::new(), nodes: 0, copied: 0, root: None };
    builder.run(Parser::new_from_str_with_options(text, options))
}

/// A list or a mapping that has begun.
struct Open {
    start: Span,
    anchor: usize,
    flow: bool,
    content: Content,
}

enum Content {
    List(Vec<Node>),
    /// Entries, their keys (to find duplicates), and the key that waits for its value (`None` in it: no key that can be used).
    Mapping(Vec<(Spanned<String>, Node)>, BTreeMap<String, Span>, Option<Option<Spanned<String>>>),
}

struct Builder<'a> {
    source: &'a Source,
    diagnostics: &'a mut Diagnostics,
    open: Vec<Open>,
    anchors: BTreeMap<usize, Node>,
    nodes: usize,
    copied: usize,
    root: Option<Node>,
}

impl Builder<'_> {
    fn run<'i>(mut self, events: impl Iterator<Item = Result<(Event<'i>, ParserSpan), ScanError>>) -> Option<Node> {
        let mut documents = 0;
        for event in events {
            let (event, at) = match event {
                Ok(event) => event,
                Err(error) => {
                    self.syntax_error(&error);
                    return None;
                }
            };
            let span = at.byte_range().map_or(Span::new(0, 0), |r| Span::new(r.start, r.end.max(r.start)));
            if let Some(tag) = at.tag_span().and_then(|t| t.byte_range()) {
                self.diagnostics.push(Diagnostic::new(
                    Code::YamlFeature,
                    Span::new(tag.start, tag.end),
                    "a tag has no meaning in a description",
                    "a YAML tag",
                    "remove it: the key says what kind of value is expected",
                ));
            }
            match event {
                Event::DocumentStart(..) => {
                    documents += 1;
                    if documents == 2 {
                        self.diagnostics.push(Diagnostic::new(
                            Code::YamlFeature,
                            span,
                            "a second document begins here",
                            "",
                            "describe one robot per file; remove this line and what follows it",
                        ));
                        return self.root;
                    }
                }
                Event::Scalar(text, style, anchor, _) => {
                    let plain = style == ScalarStyle::Plain;
                    let verbatim = self.verbatim(&text, span, style);
                    let node =
                        Node { span, alias: None, kind: Kind::Scalar(Scalar { text: text.into_owned(), plain, verbatim }) };
                    self.place(node, anchor)?;
                }
                Event::SequenceStart(style, anchor, _) => {
                    let flow = style == StructureStyle::Flow;
                    self.open.push(Open { start: span, anchor, flow, content: Content::List(Vec::new()) });
                }
                Event::MappingStart(style, anchor, _) => {
                    let flow = style == StructureStyle::Flow;
                    let content = Content::Mapping(Vec::new(), BTreeMap::new(), None);
                    self.open.push(Open { start: span, anchor, flow, content });
                }
                Event::SequenceEnd | Event::MappingEnd => self.close(span)?,
                Event::Alias(anchor) => match self.anchors.get(&anchor) {
                    Some(node) => {
                        let (nodes, bytes) = node.size();
                        self.nodes += nodes;
                        self.copied += bytes;
                        if self.nodes > MAX_NODES || self.copied > MAX_COPIED {
                            let much = if self.nodes > MAX_NODES {
                                format!("{MAX_NODES} values")
                            } else {
                                format!("{MAX_COPIED} bytes")
                            };
                            self.diagnostics.push(Diagnostic::new(
                                Code::TooLarge,
                                span,
                                format!("written out, the aliases of this file give more than {much}"),
                                "too much here",
                                "write the values out instead of referring to them by aliases",
                            ));
                            return None;
                        }
                        let node = Node { alias: Some(span), ..node.clone() };
                        self.place(node, 0)?;
                    }
                    None => {
                        self.diagnostics.push(Diagnostic::new(
                            Code::YamlFeature,
                            span,
                            "this alias refers to a value that contains it",
                            "an alias within its own anchor",
                            "write the value out",
                        ));
                        return None;
                    }
                },
                Event::StreamStart | Event::StreamEnd | Event::DocumentEnd => {}
                _ => {}
            }
        }
        self.root
    }

    /// Offset of a scalar's text in the source, if the source has it letter by letter.
    fn verbatim(&self, text: &str, span: Span, style: ScalarStyle) -> Option<usize> {
        let start = match style {
            ScalarStyle::Plain => span.start,
            ScalarStyle::SingleQuoted | ScalarStyle::DoubleQuoted => span.start + 1,
            ScalarStyle::Literal | ScalarStyle::Folded => return None,
        };
        (self.source.text().get(start..start + text.len()) == Some(text)).then_some(start)
    }

    /// Ends the innermost list or mapping; `end` is the place of its closing bracket, empty without a bracket.
    fn close(&mut self, end: Span) -> Option<()> {
        let Open { start, anchor, flow, content } = self.open.pop()?;
        let (kind, last) = match content {
            Content::List(items) => {
                let last = items.last().map(Node::place);
                (Kind::List(items), last)
            }
            Content::Mapping(entries, ..) => {
                let last = entries.last().map(|(key, value)| key.span.to(value.place()));
                (Kind::Mapping(entries), last)
            }
        };
        // A block ends with its last value; what the reader calls its end may be lines away.
        let span = if flow { start.to(end) } else { last.map_or(start, |last| Span::new(start.start.min(last.start), last.end)) };
        self.place(Node { span, alias: None, kind }, anchor)
    }

    /// Puts a complete node where it belongs.
    fn place(&mut self, node: Node, anchor: usize) -> Option<()> {
        if anchor != 0 {
            self.anchors.insert(anchor, node.clone());
        }
        self.nodes += 1;
        let waits_for_dash = self.lacks_dash(&node);
        let flow = self.open.last().is_some_and(|open| open.flow);
        match self.open.last_mut().map(|open| &mut open.content) {
            None => self.root = Some(node),
            Some(Content::List(items)) => items.push(node),
            Some(Content::Mapping(entries, seen, waiting)) => match waiting.take() {
                None if waits_for_dash => self.begin_entry(node),
                None => *waiting = Some(key(node, seen, self.diagnostics)),
                Some(Some(key)) => {
                    let entry = if flow { parted(self.source, &key, &node, seen, self.diagnostics) } else { None };
                    entries.push(entry.unwrap_or((key, node)));
                }
                Some(None) => {}
            },
        }
        Some(())
    }

    /// Whether a key is the one that its mapping, an entry of a list, began with: then the dash of the next entry is missing.
    fn lacks_dash(&self, node: &Node) -> bool {
        let [.., Open { flow: false, content: Content::List(_), .. }, Open { flow: false, content, anchor: 0, .. }] =
            &self.open[..]
        else {
            return false;
        };
        let (Content::Mapping(entries, _, None), Kind::Scalar(scalar)) = (content, &node.kind) else { return false };
        // A mapping of one key that stands there twice is a slip of another kind.
        entries.len() > 1 && entries[0].0.value == scalar.text
    }

    /// Ends the mapping before a key that lacks its dash, and begins the next entry of the list with it.
    fn begin_entry(&mut self, node: Node) {
        let Some(Open { start, content: Content::Mapping(entries, ..), .. }) = self.open.pop() else { return };
        let at = node.span;
        let (first, end) = (entries[0].0.span, entries.last().map_or(start.end, |(_, value)| value.place().end));
        let name = match &node.kind {
            Kind::Scalar(scalar) => super::excerpt(&scalar.text),
            _ => String::new(),
        };
        self.diagnostics.push(
            Diagnostic::new(
                Code::DuplicateKey,
                at,
                format!("a dash is missing: `{name}` stands twice in one entry of a list"),
                "the next entry begins here",
                format!("write `- {name}: ...`, the dash in the column of the dashes above"),
            )
            .also(first, "the entry begins here"),
        );
        let entry = Node { span: Span::new(start.start.min(first.start), end), alias: None, kind: Kind::Mapping(entries) };
        if let Some(Content::List(items)) = self.open.last_mut().map(|open| &mut open.content) {
            items.push(entry);
        }
        let mut seen = BTreeMap::new();
        let waiting = key(node, &mut seen, self.diagnostics);
        let content = Content::Mapping(Vec::new(), seen, Some(waiting));
        self.open.push(Open { start: at, anchor: 0, flow: false, content });
    }

    fn syntax_error(&mut self, error: &ScanError) {
        let at = error.marker().byte_offset().unwrap_or(0).min(self.source.text().len());
        let mut span = self.visible(at);
        let (mut message, mut help) = explain(error.kind());
        let text = self.source.text();
        // In brackets a tab is a blank, and the bracket says more.
        let in_brackets = self.open.iter().any(|open| open.flow);
        let quote = cause::unclosed_quote(text, at);
        let is_quote = quote.is_some();
        if let Some(cause) = quote.or_else(|| cause::find(text, at, error.kind()).filter(|_| !in_brackets)) {
            (span, message, help) = (cause.span, cause.message, cause.help);
        } else if matches!(error.kind(), ErrorKind::FlowMappingValueAdjacentCollection) {
            help = key_before(text, at).map_or(help, |(word, bracket)| format!("write `{word}: {bracket}...`"));
        }
        let code = match error.kind() {
            ErrorKind::RecursionLimitExceeded => Code::TooLarge,
            ErrorKind::DirectiveDisallowed => Code::YamlFeature,
            _ => Code::YamlSyntax,
        };
        let line = |span: Span| self.source.place(span.start).line;
        let open = self.open.iter().rev().find(|open| open.flow).map(|open| open.start).filter(|open| line(*open) < line(span));
        self.diagnostics.push(match open.filter(|_| code == Code::YamlSyntax && !is_quote) {
            // A bracket left open lines above explains more than where the reader stumbled.
            Some(open) => {
                let bracket = self.source.slice(open);
                let counterpart = if bracket == "{" { "}" } else { "]" };
                let message = format!("the bracket `{bracket}` is not closed");
                let help = format!("close it with `{counterpart}`");
                Diagnostic::new(code, open, message, "opened here", help).also(span, "this cannot stand inside it")
            }
            None => Diagnostic::new(code, span, message, "here", help),
        });
    }

    /// The character at `at`, or the last visible one before it.
    fn visible(&self, at: usize) -> Span {
        let text = self.source.text();
        match text.get(at..).and_then(|rest| rest.chars().next()) {
            Some(c) if !c.is_whitespace() || c == '\t' => Span::new(at, at + c.len_utf8()),
            _ => {
                let before = text.get(..at).unwrap_or("").trim_end().len();
                Span::new(before, before)
            }
        }
    }
}

/// Whether a text contains a comment.
pub fn has_comment(text: &str) -> bool {
    cause::quote_and_comment(text).1
}

/// The key that `node` is, unless it is none or stands here already.
fn key(node: Node, seen: &mut BTreeMap<String, Span>, diagnostics: &mut Diagnostics) -> Option<Spanned<String>> {
    let Kind::Scalar(scalar) = node.kind else {
        diagnostics.push(Diagnostic::new(
            Code::WrongKind,
            node.span,
            format!("a key must be a word, found {}", node.describe()),
            "not a key",
            "write `key: value`",
        ));
        return None;
    };
    if let Some(&first) = seen.get(&scalar.text) {
        diagnostics.push(
            Diagnostic::new(
                Code::DuplicateKey,
                node.span,
                format!("the key `{}` stands here twice", super::excerpt(&scalar.text)),
                "the second one",
                "keep one of the two",
            )
            .also(first, "the first one"),
        );
        return None;
    }
    seen.insert(scalar.text.clone(), node.span);
    Some(Spanned::new(scalar.text, node.span))
}

/// Key and value of `yy:0.01` between braces, where YAML takes it for a key without a value; the missing blank is reported.
fn parted(
    source: &Source,
    key: &Spanned<String>,
    nothing: &Node,
    seen: &mut BTreeMap<String, Span>,
    diagnostics: &mut Diagnostics,
) -> Option<(Spanned<String>, Node)> {
    let is_nothing = matches!(&nothing.kind, Kind::Scalar(scalar) if scalar.is_nothing());
    if !is_nothing || source.slice(key.span) != key.value {
        return None;
    }
    let (word, rest) = key.value.split_once(':')?;
    let rest = rest.trim_start_matches(':');
    if !cause::is_word(word) || rest.is_empty() || seen.contains_key(word) {
        return None;
    }
    let colon = key.span.start + word.len();
    diagnostics.push(wants_space(Span::new(colon, colon + 1), word, rest));
    let word = Spanned::new(word.to_owned(), Span::new(key.span.start, colon));
    seen.insert(word.value.clone(), word.span);
    let span = Span::new(key.span.end - rest.len(), key.span.end);
    let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''));
    let quoted = quote.and_then(|quote| rest[1..].strip_suffix(quote));
    let (text, verbatim) = (quoted.unwrap_or(rest).to_owned(), span.start + usize::from(quoted.is_some()));
    let scalar = Scalar { text, plain: quoted.is_none(), verbatim: Some(verbatim) };
    Some((word, Node { span, alias: None, kind: Kind::Scalar(scalar) }))
}

/// That a colon, at a place, wants a blank.
fn wants_space(colon: Span, word: &str, rest: &str) -> Diagnostic {
    let (message, _) = explain(&ErrorKind::InvalidMappingValueWhitespace);
    Diagnostic::new(Code::YamlSyntax, colon, message, "here", format!("write `{word}: {}`", super::excerpt(rest)))
}

/// The key before the colon at a place, and the bracket after the colon.
fn key_before(text: &str, at: usize) -> Option<(&str, char)> {
    let bracket = text.get(at..)?.strip_prefix(':')?.chars().next()?;
    let word = text[..at].rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next()?;
    cause::is_word(word).then_some((word, bracket))
}

/// The keys of `m:5`, where a mapping is wanted and YAML takes a text, of one line or several; the first one's missing blank is reported.
pub(super) fn keys_without_space(node: &Node, diagnostics: &mut Diagnostics) -> Vec<Spanned<String>> {
    let Kind::Scalar(Scalar { text, plain: true, .. }) = &node.kind else { return Vec::new() };
    let parts = text.split_whitespace().filter_map(|part| part.split_once(':'));
    let keys: Vec<_> = parts.filter(|(word, rest)| cause::is_word(word) && !rest.is_empty()).collect();
    let Some((first, rest)) = keys.first().filter(|(word, _)| text.starts_with(&format!("{word}:"))) else { return Vec::new() };
    let colon = node.span.start + first.len();
    diagnostics.push(wants_space(Span::new(colon, colon + 1), first, rest));
    keys.iter().map(|(word, _)| Spanned::new((*word).to_owned(), node.span)).collect()
}

/// The meaning of the parser's error, and the remedy.
fn explain(kind: &ErrorKind) -> (String, String) {
    use ErrorKind as E;
    let (message, help): (&str, &str) = match kind {
        E::TabNotAllowed | E::TabInBlockIndentation | E::TabInIndentation | E::TabInPlainScalar | E::TabAtBlockScalarStart => {
            ("YAML does not allow a tab here", "indent with spaces, two per level")
        }
        E::InvalidIndentation | E::InvalidFlowScalarIndent | E::ExpectedBlockMappingKey | E::ExpectedBlockSequenceEntry => (
            "the indentation does not fit the lines above",
            "begin the keys of one mapping, and the dashes of one list, in the same column",
        ),
        E::SimpleKeyExpected | E::InvalidSimpleKey => ("a key must be followed by a colon", "write `key: value`, on one line"),
        E::MappingValueNotAllowed | E::MappingKeyNotAllowed | E::InvalidColonPlacement => (
            "a `key: value` cannot stand here",
            "begin it on a line of its own with the indentation of its neighbours; put a text that contains a colon in quotes",
        ),
        E::BomInsideDocument => (
            "a byte order mark, U+FEFF, stands within the text, where nobody sees it",
            "remove it: type anew what stands around it",
        ),
        E::InvalidMappingValueWhitespace | E::FlowMappingValueAdjacentCollection => {
            ("a colon must be followed by a space", "write `key: value`")
        }
        E::BlockSequenceEntryNotAllowed | E::BlockEntryInFlowCollection | E::InvalidBlockEntryWhitespace => (
            "a list entry cannot begin here",
            "begin `- value` on a line of its own; between [ and ] separate the values by commas instead",
        ),
        E::UnexpectedEofFlowSequence | E::ExpectedFlowSequenceSeparator => {
            ("a list that begins with `[` does not end", "separate its values by commas and end it with `]`")
        }
        E::UnexpectedEofFlowMapping | E::UnexpectedEofImplicitFlowMapping | E::ExpectedFlowMappingSeparator => {
            ("a mapping that begins with `{` does not end", "separate its entries by commas and end it with `}`")
        }
        E::UnclosedFlowCollection { .. } => ("a bracket is not closed", "close it with its counterpart, `]` or `}`"),
        E::MismatchedFlowCollectionEnd { .. } => {
            ("the closing bracket does not fit the open one", "close `[` with `]` and `{` with `}`")
        }
        E::MisplacedFlowCollectionEnd => ("a closing bracket without an open one", "remove it, or open it with `[` or `{`"),
        E::UnclosedQuotedScalar | E::DocumentIndicatorInQuotedScalar | E::InvalidQuotedScalarIndent => {
            ("a quoted text does not end", "end it with the quote that it begins with")
        }
        E::InvalidTrailingSingleQuotedScalar | E::InvalidTrailingDoubleQuotedScalar => {
            ("something follows the closing quote", "a quoted text must be the whole value")
        }
        E::UnknownAnchor => {
            ("this alias refers to nothing above it", "name the value with `&name` before it is used, or write it out")
        }
        E::UnexpectedCharacter { character } if character.is_control() => {
            return (
                format!("a control character, U+{:04X}, cannot stand in a description", u32::from(*character)),
                "remove it".into(),
            )
        }
        E::UnexpectedCharacter { .. } => {
            ("this character cannot begin a value", "put the text in quotes, or remove the character")
        }
        E::RecursionLimitExceeded => ("the file nests too deeply", "a description needs no more than six levels"),
        E::DirectiveDisallowed => ("a YAML directive has no meaning in a description", "remove the line that begins with `%`"),
        E::CommentNotSeparated => ("a comment must be separated by a space", "write a space before `#`"),
        _ => {
            return (
                format!("this is not YAML: {kind}"),
                "check indentation, quotes, brackets and colons here and on the line above".into(),
            )
        }
    };
    (message.into(), help.into())
}
