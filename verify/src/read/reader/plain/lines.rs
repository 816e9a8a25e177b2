//! A text as lines of code, each with its preceding comment.

use crate::read::reader::lexer::{is_hidden, name_of, Fault};
use crate::read::reader::LONGEST;
use crate::values::check::Check;

/// Comment text with a meaning: escapes in Python, splices and trigraphs in C, the encoding of a Python file.
const ESCAPES: [&str; 4] = ["\\", "??/", "coding:", "coding="];

/// Whether the next line continues a line of code: in MATLAB, and in a C macro.
fn goes_on(line: &str) -> bool {
    line.ends_with("...") || line.ends_with('\\')
}

/// A line of code.
#[derive(Clone, Debug)]
pub(in crate::read::reader) struct Line<'a> {
    pub(in crate::read::reader) number: usize,
    pub(in crate::read::reader) text: &'a str,
    /// The lines of the preceding comment.
    pub(in crate::read::reader) comment: Vec<&'a str>,
}

/// The lines of code of a text, in order.
#[derive(Clone, Debug)]
pub(in crate::read::reader) struct Lines<'a> {
    pub(in crate::read::reader) all: Vec<Line<'a>>,
    pub(in crate::read::reader) at: usize,
    last: usize,
}

/// The comments of a language: each begins at the start of a line and ends at the end of a line.
#[derive(Clone, Copy, Debug)]
pub(in crate::read::reader) struct Comments {
    /// Prefix of a line comment.
    pub(in crate::read::reader) line: Option<&'static str>,
    /// Beginning and end of a block comment.
    pub(in crate::read::reader) block: Option<(&'static str, &'static str)>,
    /// End of a line of code that a block comment may follow. In Python such a comment is a string, without effect only at the start of a block.
    pub(in crate::read::reader) behind: &'static str,
}

impl<'a> Lines<'a> {
    /// The lines of a text, without comments and empty lines.
    pub(in crate::read::reader) fn new(text: &'a str, comments: Comments) -> Result<Lines<'a>, Fault> {
        let mut all = Vec::new();
        let mut comment: Vec<&str> = Vec::new();
        let mut open = None;
        let mut last = 0;
        if text.len() > LONGEST {
            return Err(Fault { line: 1, reason: format!("the text is longer than {} MiB", LONGEST >> 20) });
        }
        for (line, number) in text.split('\n').zip(1..) {
            last = number;
            if let Some(c) = line.chars().find(|c| is_hidden(*c)) {
                return Err(Fault { line: number, reason: format!("the character {}, which cannot be seen", name_of(c)) });
            }
            let commented = open.is_some()
                || comments.line.is_some_and(|begin| line.starts_with(begin))
                || comments.block.is_some_and(|(begin, _)| line.starts_with(begin));
            if let Some(escape) = ESCAPES.into_iter().find(|escape| commented && line.contains(escape)) {
                let reason = format!("`{escape}` in a comment, which a compiler can read as something else");
                return Err(Fault { line: number, reason });
            }
            if (commented || line.is_empty()) && all.last().is_some_and(|line: &Line<'_>| goes_on(line.text)) {
                let reason = "nothing of code in a line that the one before goes on in, which ends a statement".into();
                return Err(Fault { line: number, reason });
            }
            let begins = comments.block.filter(|(begin, _)| open.is_none() && line.starts_with(begin));
            let is_idle = all.last().is_some_and(|line: &Line<'_>| line.text.ends_with(comments.behind));
            if begins.is_some() && !comments.behind.is_empty() && !is_idle && Check::Strings.is_made() {
                return Err(Fault { line: number, reason: "a text that is no comment: no block begins in front of it".into() });
            }
            if let Some((begin, end)) = open.or(begins) {
                let rest = if open.is_none() { &line[begin.len()..] } else { line };
                open = match rest.split_once(end) {
                    None => Some((begin, end)),
                    Some((_, "")) => None,
                    Some(_) => return Err(Fault { line: number, reason: "something behind the end of a comment".into() }),
                };
                comment.push(rest.split_once(end).map_or(rest, |(text, _)| text));
            } else if let Some(text) = comments.line.and_then(|begin| line.strip_prefix(begin)) {
                comment.push(text);
            } else if !line.is_empty() {
                all.push(Line { number, text: line, comment: std::mem::take(&mut comment) });
            }
        }
        match open {
            Some(_) => Err(Fault { line: last, reason: "a comment that does not end".into() }),
            None => Ok(Lines { all, at: 0, last }),
        }
    }

    /// The current line, empty after the last.
    pub(in crate::read::reader) fn peek(&self) -> &'a str {
        self.all.get(self.at).map_or("", |line| line.text)
    }

    /// The same lines with numbers shifted by `before`, the lines of other files.
    pub(in crate::read::reader) fn behind(mut self, before: usize) -> Lines<'a> {
        self.all.iter_mut().for_each(|line| line.number += before);
        self.last += before;
        self
    }

    pub(in crate::read::reader) fn number(&self) -> usize {
        self.all.get(self.at).map_or(self.last, |line| line.number)
    }

    pub(in crate::read::reader) fn is(&self, text: &str) -> bool {
        !text.is_empty() && self.peek() == text
    }

    pub(in crate::read::reader) fn ended(&self) -> bool {
        self.at >= self.all.len()
    }

    /// A fault of the current line.
    pub(in crate::read::reader) fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault { line: self.number(), reason: reason.into() }
    }

    /// The line in the form for messages.
    pub(in crate::read::reader) fn shown(&self) -> String {
        if self.ended() {
            return "the end of the text".into();
        }
        let text: String = self.peek().trim().chars().take(60).collect();
        format!("`{text}`")
    }

    pub(in crate::read::reader) fn eat(&mut self, text: &str) -> bool {
        let found = self.is(text);
        self.at += usize::from(found);
        found
    }

    /// Takes a line, which must be the current one.
    pub(in crate::read::reader) fn expect(&mut self, text: &str) -> Result<(), Fault> {
        match self.eat(text) {
            true => Ok(()),
            false => Err(self.fault(format!("{} where an emitted module has `{}`", self.shown(), text.trim()))),
        }
    }

    /// Takes all lines of code of a text.
    pub(in crate::read::reader) fn expect_all(&mut self, text: &str, comments: Comments) -> Result<(), Fault> {
        let lines = Lines::new(text, comments)?;
        lines.all.iter().try_for_each(|line| self.expect(line.text))
    }

    /// Takes a line with this beginning and end; returns the text between.
    pub(in crate::read::reader) fn between(&mut self, begin: &str, end: &str) -> Result<&'a str, Fault> {
        let found = self.peek().strip_prefix(begin).and_then(|rest| rest.strip_suffix(end));
        let found = found.ok_or_else(|| {
            self.fault(format!("{} where an emitted module has `{} ... {end}`", self.shown(), begin.trim_start()))
        })?;
        self.at += 1;
        Ok(found)
    }
}
