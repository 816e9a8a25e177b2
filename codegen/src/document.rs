//! A text in YAML, read key by key: what descriptions of robots and files of experiments have in common.
//!
//! ```text
//! Source -> yaml.rs: tree of nodes -> reader.rs: keys and kinds of values
//!                                     expression.rs: scalar -> Expression
//! ```
//!
//! Nothing here knows what a file is about: which keys there are, and what stands under them, is said by whoever reads.

mod expression;
pub mod reader;
pub mod yaml;

pub(crate) use expression::out_of_range;
pub use expression::{multiple_of_pi, parse as parse_expression, Expression, ExpressionKind, Operator};

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
