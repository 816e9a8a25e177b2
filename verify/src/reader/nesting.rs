//! Whether a text nests so little that its parser and the reader, which follow its nesting by recursion, come to an end on any stack.
//!
//! An expression nests at most as deep as it has tokens: brackets, prefixes, and operators that associate to the left. Counted are those
//! since the last semicolon, since a comma that is none of generics or of a closure, or since a block after which something new begins, in
//! all brackets around together.

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Bytes for the recursion over what is accepted: 16 KiB for each token that can nest.
pub(super) const STACK: usize = MOST_TOKENS << 14;

/// Tokens in a row that can nest.
pub(super) const MOST_TOKENS: usize = 4096;
/// Brackets in brackets.
const MOST_BRACKETS: usize = 64;

/// An error where a text nests deeper than any emitted module does.
pub(super) fn check(source: &str) -> Result<(), String> {
    let tokens = source.parse::<TokenStream>().map_err(super::not_rust)?;
    walk(tokens, 0, 0)
}

fn walk(tokens: TokenStream, brackets: usize, around: usize) -> Result<(), String> {
    if brackets > MOST_BRACKETS {
        return Err(format!("the text nests too deeply: brackets in more than {MOST_BRACKETS} others"));
    }
    let mut row = around;
    let (mut after_block, mut commas_separate) = (false, true);
    for token in tokens {
        let begins = match &token {
            TokenTree::Punct(punct) => match punct.as_char() {
                ';' => true,
                ',' => commas_separate,
                '#' => after_block,
                _ => false,
            },
            TokenTree::Ident(word) => after_block && !["as", "else", "in"].iter().any(|other| word == other),
            _ => false,
        };
        let opens = matches!(&token, TokenTree::Punct(punct) if matches!(punct.as_char(), '<' | '|'));
        commas_separate = begins || (commas_separate && !opens);
        row = if begins { around } else { row + 1 };
        if row > MOST_TOKENS {
            return Err(format!("the text nests too deeply: an expression of more than {MOST_TOKENS} words and signs"));
        }
        after_block = false;
        if let TokenTree::Group(group) = token {
            after_block = group.delimiter() == Delimiter::Brace;
            walk(group.stream(), brackets + 1, row)?;
        }
    }
    Ok(())
}
