//! Reads tokens in sequence and compares them with the required ones.

use super::lexer::{Fault, Kind, Lexer, Token};
use crate::values::check::Check;

/// A position in a text with its token; a copy allows backtracking.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parser<'a> {
    after: Lexer<'a>,
    token: Token<'a>,
}

impl<'a> Parser<'a> {
    pub(super) fn new(text: &'a str) -> Result<Parser<'a>, Fault> {
        let mut after = Lexer::new(text);
        let token = after.next()?;
        Ok(Parser { after, token })
    }

    /// The current token.
    pub(super) fn peek(&self) -> Token<'a> {
        self.token
    }

    pub(super) fn is(&self, text: &str) -> bool {
        self.token.is(text)
    }

    /// Returns the current token and advances.
    pub(super) fn take(&mut self) -> Result<Token<'a>, Fault> {
        let token = self.token;
        self.token = self.after.next()?;
        Ok(token)
    }

    /// Takes a token if it is the current one.
    pub(super) fn eat(&mut self, text: &str) -> Result<bool, Fault> {
        let found = self.is(text);
        if found {
            self.take()?;
        }
        Ok(found)
    }

    /// Takes the tokens of a text, which must follow here; the words of its documentation are free.
    pub(super) fn expect(&mut self, text: &str) -> Result<(), Fault> {
        let mut wanted = Lexer::new(text);
        loop {
            let want = wanted.next()?;
            if want.kind == Kind::End {
                return Ok(());
            }
            // Documentation must occur at the required place within an item, with any words.
            if want.kind == Kind::Documentation {
                self.documentation()?;
                continue;
            }
            let mut found = self.token;
            while !Check::Tokens.is_made() && found.kind != Kind::End && found.text != want.text {
                self.take()?;
                found = self.token;
            }
            if (found.kind, found.text) != (want.kind, want.text) {
                let whole = text.split('\n').find(|line| !line.starts_with("///") && line.contains(want.text)).unwrap_or(text);
                let part = if whole == want.text { String::new() } else { format!(" in `{whole}`") };
                return Err(found.fault(format!("{} where an emitted module has {}{part}", found.shown(), want.shown())));
            }
            self.take()?;
        }
    }

    /// The same for a text whose brackets all contain lists; the formatter may put a comma after the last entry.
    pub(super) fn expect_lists(&mut self, text: &str) -> Result<(), Fault> {
        let mut wanted = Lexer::new(text);
        loop {
            let want = wanted.next()?;
            if want.kind == Kind::End {
                return Ok(());
            }
            if want.is(")") || want.is("}") {
                self.eat(",")?;
            }
            self.expect(want.text)?;
        }
    }

    /// Skips to the end of the current bracket; ignores other kinds of brackets.
    pub(super) fn skip(&mut self, open: &str, close: &str) -> Result<(), Fault> {
        let (first, mut deep) = (self.token, 0usize);
        loop {
            let token = self.take()?;
            if token.kind == Kind::End {
                return Err(first.fault(format!("`{open}` is never closed: the text is cut off")));
            }
            deep = if token.is(open) {
                deep + 1
            } else if token.is(close) {
                deep - 1
            } else {
                deep
            };
            if deep == 0 {
                return Ok(());
            }
        }
    }
}

/// A reader that uses a parser.
pub(super) trait Reads<'a> {
    fn parser(&mut self) -> &mut Parser<'a>;

    /// The entries up to a closing bracket, separated by commas, with an optional final comma; starts after the opening bracket.
    fn list(&mut self, close: &str, mut entry: impl FnMut(&mut Self) -> Result<(), Fault>) -> Result<(), Fault> {
        while !self.parser().eat(close)? {
            entry(self)?;
            if !self.parser().eat(",")? {
                return self.parser().expect(close);
            }
        }
        Ok(())
    }
}

impl<'a> Reads<'a> for Parser<'a> {
    fn parser(&mut self) -> &mut Parser<'a> {
        self
    }
}
