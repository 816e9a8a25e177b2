//! The permitted documentation. `cargo test` runs code blocks of documentation, so every block must be plain text, fenced as armgen fences it, and
//! nothing else may form a block. Outside a fence, no line is indented, and no two blanks are adjacent, because an indented block can be nested in
//! a list or a quotation. No `<` begins HTML, because a fence in HTML would have no effect.

use super::lexer::{Fault, Kind};
use super::parser::Parser;
use crate::values::check::Check;

/// Maximum number of documentation lines of an item; 1024 parameters have a line each.
const MOST_LINES: usize = 2048;

const OPENS: &str = " ```text";
const CLOSES: &str = " ```";

impl<'a> Parser<'a> {
    /// Takes the documentation at this place, line by line; empty without documentation.
    pub(super) fn documentation(&mut self) -> Result<Vec<&'a str>, Fault> {
        let mut lines = Vec::new();
        let mut fenced = false;
        while self.peek().kind == Kind::Documentation {
            let line = self.take()?;
            let text = line.text;
            if lines.len() == MOST_LINES {
                return Err(line.fault(format!("documentation of more than {MOST_LINES} lines")));
            }
            if !text.is_empty() && !text.starts_with(' ') {
                return Err(line.fault("documentation begins with a blank"));
            }
            if text.contains("```") || text.contains("~~~") {
                if text != (if fenced { CLOSES } else { OPENS }) && Check::Fences.is_made() {
                    let fence = line.shown();
                    return Err(line.fault(format!("{fence} can begin or end a block of code, which `cargo test` would run")));
                }
                fenced = !fenced;
            } else if !fenced && (text.contains("  ") || begins_html(text)) && Check::Indentation.is_made() {
                return Err(line.fault(
                    "documentation with two blanks in a row or a tag of HTML can hold code, which `cargo test` would run",
                ));
            }
            lines.push(text);
        }
        match fenced {
            true => Err(self.peek().fault("documentation ends inside of a block of text")),
            false => Ok(lines),
        }
    }
}

/// Whether a `<` can begin HTML: if a letter, `/`, `!` or `?` follows (CommonMark 0.31, 6.6 and 4.6).
fn begins_html(text: &str) -> bool {
    text.split('<').skip(1).any(|behind| behind.starts_with(|c: char| c.is_ascii_alphabetic() || "/!?".contains(c)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str) -> Result<usize, String> {
        let mut parser = Parser::new(text)?;
        Ok(parser.documentation()?.len())
    }

    #[test]
    fn blocks_of_plain_text_are_the_only_ones() {
        assert_eq!(check("/// A.\n///\n/// ```text\n/// a =   b <c\n///     d\n/// ```\n///\n/// - `q`: b."), Ok(8));
        assert_eq!(check("/// |r| <= pi/4, a < b, <-1"), Ok(1));
        for text in [
            "/// ```\n/// panic!()\n/// ```",
            "/// ```rust\n/// panic!()\n/// ```",
            "/// ````text\n/// a\n/// ````",
            "/// ```text\n/// ````\n/// ```",
            "/// ~~~\n/// panic!()\n/// ~~~",
            "///     panic!()",
            "/// -     panic!()",
            "/// >     panic!()",
            "/// - ```\n///   panic!()\n///   ```",
            "/// <!--\n/// ```text\n/// -->\n///\n///     panic!()\n/// ```",
            "/// a <script>",
            "/// a </pre",
            "/// <?a",
            "/// ```text\n/// a",
            "///panic!()",
        ] {
            let fault = check(text).expect_err(text);
            assert!(["code", "block", "blank"].iter().any(|word| fault.contains(word)), "{text}: {fault}");
        }
    }
}
