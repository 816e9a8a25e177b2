//! A position in a line, which reads words, indices and numbers.

use crate::read::reader::lexer::Fault;
use crate::values::enclosure::Float;
use crate::values::program::Literal;

/// A position in a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    pub(super) rest: &'a str,
    pub(super) line: usize,
}

impl<'a> Place<'a> {
    pub(super) fn eat(&mut self, text: &str) -> bool {
        match self.rest.strip_prefix(text) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    pub(super) fn expect(&mut self, text: &str) -> Result<(), Fault> {
        match self.eat(text) {
            true => Ok(()),
            false => Err(self.fault(&format!("`{text}` can stand"))),
        }
    }

    pub(super) fn fault(&self, wanted: &str) -> Fault {
        let found: String = self.rest.chars().take(40).collect();
        let found = if found.is_empty() { "the end of the line".into() } else { format!("`{found}`") };
        Fault { line: self.line, reason: format!("{found} where {wanted}") }
    }

    pub(super) fn word(&mut self) -> &'a str {
        let fits = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let (word, rest) = self.rest.split_at(self.rest.find(|c| !fits(c)).unwrap_or(self.rest.len()));
        self.rest = rest;
        word
    }

    pub(super) fn integer(&mut self) -> Result<usize, Fault> {
        let start = *self;
        let word = self.word();
        word.parse::<usize>().ok().filter(|value| value.to_string() == word).ok_or_else(|| start.fault("an index can stand"))
    }

    /// An unsigned number: the shortest decimal of its float, with the suffix of the language.
    pub(super) fn literal(&mut self, real: Float, suffix: &str) -> Result<Literal, Fault> {
        let start = *self;
        let bytes = self.rest.as_bytes();
        let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end += 1 + digits(end + 1);
        }
        if bytes.get(end) == Some(&b'e') {
            let sign = usize::from(bytes.get(end + 1) == Some(&b'-'));
            end += 1 + sign + digits(end + 1 + sign);
        }
        let (text, rest) = self.rest.split_at(end);
        self.rest = rest;
        self.expect(suffix).map_err(|_| start.fault(&format!("a number ends in `{suffix}`")))?;
        let value = real.read(text).filter(|value| shortest(*value, real) == text);
        let value = value.ok_or_else(|| start.fault("the shortest decimal of a float can stand"))?;
        Ok(Literal { text: text.into(), value })
    }

    pub(super) fn ends(&self) -> Result<(), Fault> {
        match self.rest {
            "" => Ok(()),
            _ => Err(self.fault("the line should end")),
        }
    }
}

fn shortest(value: f64, real: Float) -> String {
    match real {
        Float::F64 => format!("{value:?}"),
        Float::F32 => format!("{:?}", value as f32),
    }
}
