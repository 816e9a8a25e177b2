//! A text with a name, and places in it.
//!
//! Places are byte ranges ([`Span`]) until somebody has to read them: [`Source::place`] turns one into line and column.

use std::fmt;
use std::ops::Range;

/// Whether a character is invisible or changes the display of others. No name and no emitted text contains such a character.
pub fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{a0}' | '\u{1680}' | '\u{2000}'..='\u{200a}' | '\u{202f}' | '\u{205f}' | '\u{3000}'
            | '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}'
            | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{fe00}'..='\u{fe0f}'
            | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}' | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}'
            | '\u{e0000}'..='\u{e0fff}')
}

/// A text and its name in diagnostics.
#[derive(Clone, Debug)]
pub struct Source {
    name: String,
    text: String,
    line_starts: Vec<usize>,
}

impl Source {
    /// A source named `name`. A byte order mark at the start of `text` is dropped: no place counts it.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        let mut text: String = text.into();
        if text.starts_with('\u{feff}') {
            text.drain(..'\u{feff}'.len_utf8());
        }
        // A line ends with a line feed, a carriage return, or the two together: as YAML counts lines.
        let bytes = text.as_bytes();
        let ends = |&at: &usize| bytes[at] == b'\n' || (bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
        let line_starts = std::iter::once(0).chain((0..bytes.len()).filter(ends).map(|at| at + 1)).collect();
        Source { name: name.into(), text, line_starts }
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text, without a byte order mark.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text at `span`; empty where `span` does not lie in the text.
    pub fn slice(&self, span: Span) -> &str {
        self.text.get(span.range()).unwrap_or("")
    }

    /// Line and column of the byte at `offset`.
    pub fn place(&self, offset: usize) -> Place {
        let offset = self.floor(offset);
        let line = self.line_starts.partition_point(|&start| start <= offset);
        let start = self.line_starts[line - 1];
        Place { line, column: self.text[start..offset].chars().count() + 1 }
    }

    /// `span` up to the end of the line in which it starts: what can be underlined in one stroke.
    pub fn first_line(&self, span: Span) -> Span {
        let start = self.floor(span.start);
        let end = self.floor(span.end.max(start));
        let within = &self.text[start..end];
        let line = within.split(['\n', '\r']).next().unwrap_or("").trim_end();
        Span::new(start, start + line.len())
    }

    /// `span` widened to whole lines, the last line break left out.
    pub fn lines(&self, span: Span) -> Span {
        let line_of = |offset: usize| self.place(offset).line - 1;
        let start = self.line_starts[line_of(span.start)];
        let end = self.line_starts.get(line_of(span.end.max(span.start)) + 1).map_or(self.text.len(), |next| next - 1);
        Span { start, end }
    }

    /// The nearest character boundary at or below `offset`.
    fn floor(&self, offset: usize) -> usize {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        offset
    }
}

/// A range of bytes in a [`Source`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// The bytes from `start` up to but without `end`.
    pub fn new(start: usize, end: usize) -> Span {
        Span { start, end }
    }

    /// As a range.
    pub fn range(self) -> Range<usize> {
        self.start..self.end
    }

    /// The smallest span that holds both.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// A value and its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Its place.
    pub span: Span,
}

impl<T> Spanned<T> {
    /// `value`, found at `span`.
    pub fn new(value: T, span: Span) -> Spanned<T> {
        Spanned { value, span }
    }
}

/// A place for people: both count from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line.
    pub line: usize,
    /// The column, in characters.
    pub column: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, offset: usize, line: usize, column: usize) {
        assert_eq!(Source::new("t", text).place(offset), Place { line, column });
    }

    #[test]
    fn columns_count_characters_and_lines_start_at_one() {
        check("", 0, 1, 1);
        check("ab\ncd", 4, 2, 2);
        check("äöü: x", 6, 1, 4);
        check("a\r\nb", 3, 2, 1);
        check("a\n", 2, 2, 1);
        check("a\rb\r\rc", 2, 2, 1);
        check("a\rb\r\rc", 5, 4, 1);
        check("a\r\n\rb", 4, 3, 1);
        check("ä", 1, 1, 1);
        check("\u{feff}name", 0, 1, 1);
        check("a", 99, 1, 2);
    }

    #[test]
    fn a_long_span_is_underlined_in_its_first_line() {
        let source = Source::new("t", "a: [1,\n2]\r\n");
        assert_eq!(source.slice(source.first_line(Span::new(3, 9))), "[1,");
        assert_eq!(source.slice(source.first_line(Span::new(7, 11))), "2]");
    }
}
