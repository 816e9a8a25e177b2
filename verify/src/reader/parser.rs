//! Tokens one after the other, compared with what must stand there.

use super::lexer::{Fault, Kind, Lexer, Token};
use crate::check::Check;

/// A place in a text with the token that stands there; a copy is a place to come back to.
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

    /// The token that stands here.
    pub(super) fn peek(&self) -> Token<'a> {
        self.token
    }

    pub(super) fn is(&self, text: &str) -> bool {
        self.token.is(text)
    }

    /// The token that stands here; the next one is here afterwards.
    pub(super) fn take(&mut self) -> Result<Token<'a>, Fault> {
        let token = self.token;
        self.token = self.after.next()?;
        Ok(token)
    }

    /// Takes a token if it stands here.
    pub(super) fn eat(&mut self, text: &str) -> Result<bool, Fault> {
        let found = self.is(text);
        if found {
            self.take()?;
        }
        Ok(found)
    }

    /// Takes the tokens of a text, which must stand here, but for documentation.
    pub(super) fn expect(&mut self, text: &str) -> Result<(), Fault> {
        let mut wanted = Lexer::new(text);
        loop {
            let want = wanted.next()?;
            if want.kind == Kind::End {
                return Ok(());
            }
            // Within an item its documentation stands where it should, in whatever words.
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

    /// The same of a text in which all brackets hold lists, behind whose last entry the formatter may put a comma.
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

    /// Goes behind the bracket that closes the one that stands here; other kinds of brackets are not counted.
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

/// What reads from a parser.
pub(super) trait Reads<'a> {
    fn parser(&mut self) -> &mut Parser<'a>;

    /// What stands between two brackets, separated by commas, of which one more may stand at the end; behind the opening bracket.
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
