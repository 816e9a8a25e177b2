//! Reads values of constants by type: numbers, texts, truth values, and arrays of them.

use super::lexer::{Fault, Kind, Token};
use super::parser::{Parser, Reads};
use crate::values::check::Check;
use crate::values::enclosure::Float;
use crate::values::program::Literal;

/// The value of a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum Constant {
    /// A text.
    Text(String),
    /// An unsigned integer.
    Integer(u64),
    /// A truth value.
    Truth(bool),
    /// A number: whether it is negative, and its digits.
    Number(bool, Literal),
    /// `Real::INFINITY`, or its negative.
    Infinite(bool),
    /// An array.
    Array(Vec<Constant>),
}

/// Maximum number of entries in an array of constants; there are at most 1024 parameters.
const MOST_ENTRIES: usize = 1024;

impl Constant {
    /// Takes a value of the type of a constant.
    pub(super) fn read(parser: &mut Parser<'_>, ty: &str, real: Float) -> Result<Constant, Fault> {
        if let Some((entry, _)) = ty.strip_prefix('[').and_then(|inner| inner.rsplit_once(';')) {
            let mut entries = Vec::new();
            parser.expect("[")?;
            parser.list("]", |parser| {
                if entries.len() == MOST_ENTRIES {
                    return Err(parser.peek().fault(format!("a constant of more than {MOST_ENTRIES} entries")));
                }
                entries.push(Constant::read(parser, entry, real)?);
                Ok(())
            })?;
            return Ok(Constant::Array(entries));
        }
        let token = parser.peek();
        let value = match ty {
            "&str" => (token.kind == Kind::Text).then(|| unquoted(&token)).transpose()?.map(Constant::Text),
            "usize" => Some(Constant::Integer(integer(&token)? as u64)),
            "bool" => ["false", "true"].iter().position(|word| token.is(word)).map(|truth| Constant::Truth(truth == 1)),
            _ if token.is("Real") => {
                parser.expect("Real::")?;
                let infinities = ["INFINITY", "NEG_INFINITY"];
                infinities.iter().position(|word| parser.is(word)).map(|sign| Constant::Infinite(sign == 1))
            }
            _ => {
                let negative = parser.eat("-")?;
                Some(Constant::Number(negative, decimal(&parser.peek(), real)?))
            }
        };
        let last = parser.take()?;
        value.ok_or_else(|| last.fault(format!("{} where a value of the type `{ty}` can stand", last.shown())))
    }
}

/// A text without its quotes. Characters that rustc escapes appear as `\u{301}`, and only those.
fn unquoted(token: &Token<'_>) -> Result<String, Fault> {
    let inner = &token.text[1..token.text.len() - 1];
    let mut parts = inner.split('\\');
    let mut text = parts.next().unwrap_or("").to_string();
    for part in parts {
        let (digits, rest) = part
            .strip_prefix("u{")
            .and_then(|part| part.split_once('}'))
            .ok_or_else(|| token.fault(format!("an escape in {} that is not of the form \\u{{301}}", token.shown())))?;
        let character = u32::from_str_radix(digits, 16).ok().and_then(char::from_u32);
        // No other character is written with an escape.
        let character = character.filter(|c| c.escape_debug().to_string() == format!("\\u{{{digits}}}") && !c.is_control());
        text.push(character.ok_or_else(|| token.fault(format!("the escape \\u{{{digits}}} is none that is written so")))?);
        text += rest;
    }
    Ok(text)
}

/// An unsigned integer.
pub(super) fn integer(token: &Token<'_>) -> Result<usize, Fault> {
    let value = token.text.parse::<usize>().ok().filter(|value| token.kind == Kind::Number && value.to_string() == token.text);
    value.ok_or_else(|| token.fault(format!("{} where an index or a count can stand", token.shown())))
}

/// An unsigned decimal number: the shortest one that rounds to its float, as armgen and `{:?}` write it. So it has no suffix, no superfluous
/// digits, and is neither infinite nor indistinguishable from 0.
pub(super) fn decimal(token: &Token<'_>, real: Float) -> Result<Literal, Fault> {
    if token.kind != Kind::Number {
        return Err(token.fault(format!("{} where a number can stand", token.shown())));
    }
    let shortest = |value: f64| match real {
        Float::F64 => format!("{value:?}"),
        Float::F32 => format!("{:?}", value as f32),
    };
    let value = real.read(token.text).filter(|value| shortest(*value) == token.text || !Check::Shortest.is_made());
    let value = value.ok_or_else(|| token.fault(format!("{} is not the shortest decimal of a float", token.shown())))?;
    Ok(Literal { text: token.text.into(), value })
}
