//! Splits the text of a module into tokens with line numbers.
//!
//! Code may contain ASCII letters, digits and signs, blanks and line feeds; comments and string literals also visible Unicode characters. The
//! lexer refuses text that rustc would normalise, join or skip: non-ASCII identifiers (two spellings can be the same name), carriage returns,
//! tabs, a byte order mark, raw identifiers, prefixed literals and block comments. It also refuses characters that are invisible or change the
//! writing direction.

use std::fmt;

pub(crate) use armgen_description::source::is_hidden;

use crate::values::check::Check;

/// A fault of a text, with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The line, counted from 1.
    pub line: usize,
    /// The reason.
    pub reason: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.reason)
    }
}

impl From<Fault> for String {
    fn from(fault: Fault) -> String {
        fault.to_string()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A name or a keyword.
    Word,
    /// A number in any spelling.
    Number,
    /// A string literal with its quotes.
    Text,
    /// A sign, as compilers tokenise it.
    Sign,
    /// A line `/// ...`.
    Documentation,
    /// A line `// ...`.
    Comment,
    /// The end of the text.
    End,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'a> {
    pub(super) kind: Kind,
    /// Its text; for documentation and comments the text after the slashes.
    pub(super) text: &'a str,
    pub(super) line: usize,
}

impl Token<'_> {
    pub(super) fn is(&self, text: &str) -> bool {
        self.text == text && matches!(self.kind, Kind::Word | Kind::Number | Kind::Sign | Kind::Text)
    }

    pub(super) fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault { line: self.line, reason: reason.into() }
    }

    /// A short form for messages.
    pub(super) fn shown(&self) -> String {
        let text: String = self.text.chars().take(60).collect();
        match self.kind {
            Kind::End => "the end of the text".into(),
            Kind::Documentation => format!("`///{text}`"),
            Kind::Comment => format!("`//{text}`"),
            _ => format!("`{text}`"),
        }
    }
}

/// Signs of several characters, longer ones first, as rustc joins them.
const JOINED: [&str; 25] = [
    "<<=", ">>=", "...", "..=", "&&", "||", "<<", ">>", "+=", "-=", "*=", "/=", "^=", "%=", "&=", "|=", "==", "!=", ">=", "<=",
    "->", "=>", "<-", "::", "..",
];
/// Whether a character can be the second of such a sign, by its code.
const SECOND: [bool; 128] = {
    let (mut second, mut i) = ([false; 128], 0);
    while i < JOINED.len() {
        second[JOINED[i].as_bytes()[1] as usize] = true;
        i += 1;
    }
    second
};
const SINGLE: &str = "#[](){}<>,;:=+-*/&|!.^%";

/// A position in a text, for reading tokens.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lexer<'a> {
    rest: &'a str,
    line: usize,
}

pub(crate) fn name_of(c: char) -> String {
    if c.is_ascii_graphic() {
        format!("`{c}`")
    } else {
        format!("U+{:04X}", c as u32)
    }
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a str) -> Lexer<'a> {
        Lexer { rest: text, line: 1 }
    }

    fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault { line: self.line, reason: reason.into() }
    }

    fn split(&mut self, kind: Kind, length: usize) -> Token<'a> {
        let (text, rest) = self.rest.split_at(length);
        self.rest = rest;
        Token { kind, text, line: self.line }
    }

    pub(super) fn next(&mut self) -> Result<Token<'a>, Fault> {
        let bytes = self.rest.as_bytes();
        let blank = bytes.iter().position(|b| !matches!(b, b' ' | b'\n')).unwrap_or(bytes.len());
        self.line += bytes[..blank].iter().filter(|b| **b == b'\n').count();
        self.rest = &self.rest[blank..];
        let Some(first) = self.rest.chars().next() else { return Ok(Token { kind: Kind::End, text: "", line: self.line }) };
        match first {
            '/' if self.rest.starts_with("//") => self.comment(),
            '/' if self.rest.starts_with("/*") => Err(self.fault("a comment between /* and */: a comment stands behind //")),
            '"' => self.text(),
            '0'..='9' => Ok(self.number()),
            'a'..='z' | 'A'..='Z' | '_' => {
                let length = self.rest.find(|c| !is_word(c)).unwrap_or(self.rest.len());
                if self.rest[length..].starts_with(['"', '\'', '#']) {
                    let word = &self.rest[..=length];
                    return Err(self.fault(format!("`{word}` begins a raw name or a text of a special kind")));
                }
                Ok(self.split(Kind::Word, length))
            }
            _ => {
                let joins = self.rest.as_bytes().get(1).is_some_and(|&second| SECOND.get(usize::from(second)) == Some(&true));
                let joined = JOINED.iter().find(|sign| joins && self.rest.starts_with(*sign));
                match joined.map(|sign| sign.len()).or_else(|| SINGLE.contains(first).then_some(1)) {
                    Some(length) => Ok(self.split(Kind::Sign, length)),
                    None => Err(self.fault(format!("the character {} outside of comments", name_of(first)))),
                }
            }
        }
    }

    /// Checks that all characters of a comment or a literal are visible.
    fn visible(&self, text: &str) -> Result<(), Fault> {
        match text.chars().find(|c| is_hidden(*c) && Check::Visible.is_made()) {
            None => Ok(()),
            Some('\r') => Err(self.fault("a carriage return: lines end in a line feed alone")),
            Some(c) => Err(self.fault(format!("the character {}, which cannot be seen", name_of(c)))),
        }
    }

    fn comment(&mut self) -> Result<Token<'a>, Fault> {
        let line = self.rest.split('\n').next().unwrap_or("");
        self.visible(line)?;
        let (kind, slashes) = match line {
            line if line.starts_with("////") || line.starts_with("//!") => {
                let start: String = line.chars().take(4).collect();
                return Err(self.fault(format!("`{start}` begins no comment of an emitted module")));
            }
            line if line.starts_with("///") => (Kind::Documentation, 3),
            _ => (Kind::Comment, 2),
        };
        let token = self.split(kind, line.len());
        Ok(Token { text: &token.text[slashes..], ..token })
    }

    fn text(&mut self) -> Result<Token<'a>, Fault> {
        let line = self.rest.split('\n').next().unwrap_or("");
        let Some(end) = line[1..].find('"') else { return Err(self.fault("a text that does not end in its line")) };
        self.visible(&line[..end + 2])?;
        Ok(self.split(Kind::Text, end + 2))
    }

    /// A number by rustc's rules, whether or not emitted modules use this form.
    fn number(&mut self) -> Token<'a> {
        let bytes = self.rest.as_bytes();
        let word = |from: usize| from + bytes[from..].iter().position(|b| !is_word(char::from(*b))).unwrap_or(bytes.len() - from);
        let mut end = word(0);
        if bytes.get(end) == Some(&b'.') && bytes.get(end + 1).is_some_and(u8::is_ascii_digit) {
            end = word(end + 1);
        }
        let signed = matches!(bytes.get(end), Some(b'-' | b'+')) && bytes.get(end + 1).is_some_and(u8::is_ascii_digit);
        if signed && matches!(bytes[end - 1], b'e' | b'E') && !self.rest.starts_with("0x") {
            end = word(end + 1);
        }
        self.split(Kind::Number, end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Result<Vec<&str>, String> {
        let mut lexer = Lexer::new(text);
        let mut all = Vec::new();
        loop {
            match lexer.next()? {
                Token { kind: Kind::End, .. } => return Ok(all),
                token => all.push(token.text),
            }
        }
    }

    #[test]
    fn tokens_are_those_of_rustc() {
        assert_eq!(tokens("a->b: x[3]<=-1.5e-7;"), Ok(vec!["a", "->", "b", ":", "x", "[", "3", "]", "<=", "-", "1.5e-7", ";"]));
        assert_eq!(
            tokens("0..n 1.max 0u64 1e3f32 0xe-1"),
            Ok(vec!["0", "..", "n", "1", ".", "max", "0u64", "1e3f32", "0xe", "-", "1"])
        );
        assert_eq!(tokens("/// kg m²\n\"a b\"// c"), Ok(vec![" kg m²", "\"a b\"", " c"]));
    }

    #[test]
    fn what_compilers_normalise_or_skip_is_refused_with_its_line() {
        for (text, line, why) in [
            ("\u{feff}a", 1, "the character U+FEFF outside of comments"),
            ("a\n\u{e9}", 2, "the character U+00E9 outside of comments"),
            ("a\r\n", 1, "the character U+000D outside of comments"),
            ("// a\r\n", 1, "a carriage return"),
            ("a\tb", 1, "the character U+0009"),
            ("\n\n/* a */", 3, "a comment between /* and */"),
            ("//! a", 1, "`//! ` begins no comment"),
            ("//// a", 1, "`////` begins no comment"),
            ("/// a\u{202e}b", 1, "the character U+202E, which cannot be seen"),
            ("\"a\u{200b}b\"", 1, "the character U+200B, which cannot be seen"),
            ("\"a\nb\"", 1, "a text that does not end in its line"),
            ("r#fn", 1, "`r#` begins a raw name"),
            ("b\"a\"", 1, "`b\"` begins a raw name or a text of a special kind"),
            ("'a'", 1, "the character `'`"),
            ("a @ b", 1, "the character `@`"),
        ] {
            let fault = tokens(text).expect_err(text);
            assert!(fault.starts_with(&format!("line {line}: {why}")), "{text:?}: {fault}");
        }
    }
}
