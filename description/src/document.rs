//! A text in YAML, read key by key: what descriptions of robots and files of experiments have in common.
//!
//! ```text
//! Source -> yaml.rs: tree of nodes -> reader.rs: keys and kinds of values
//!                                     expression.rs: scalar -> Expression
//! tree of nodes and new values -> edit.rs: the text with these values, all else as it was
//! ```
//!
//! Nothing here knows the kind of a file: the caller of the reader defines the keys and their values.

pub mod edit;
mod expression;
pub mod reader;
pub mod yaml;

pub use expression::{decimal_text, multiple_of_pi, parse as parse_expression, Expression, ExpressionKind, Operator, Unit};
pub(crate) use expression::{out_of_range, MAX_TEXT as MAX_EXPRESSION};

/// The name of a character that looks like a blank or is invisible, but that YAML does not treat as a space.
fn invisible(c: char) -> Option<String> {
    let name = match c {
        '\u{a0}' | '\u{202f}' => "a no-break space",
        '\u{200b}' => "a space without width",
        '\u{200c}' | '\u{200d}' | '\u{2060}' => "a joiner without width",
        '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' => "a mark of the direction of writing",
        '\u{ad}' => "a soft hyphen",
        '\u{feff}' => "a byte order mark",
        '\u{2000}'..='\u{200a}' | '\u{1680}' | '\u{205f}' | '\u{3000}' => "a space of another width",
        _ => return None,
    };
    Some(format!("{name}, U+{:04X}", u32::from(c)))
}

/// `text` shortened for a message, control characters replaced by blanks.
pub fn excerpt(text: &str) -> String {
    const LONGEST: usize = 40;
    let shown: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        format!("{shown}...")
    } else {
        shown
    }
}
