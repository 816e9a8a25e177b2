//! Values of constants: numbers, texts, truth values, and arrays of them.

use syn::{Expr, Lit, UnOp};

use super::text;
use crate::enclosure::Float;
use crate::program::Literal;

/// The value of a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum Constant {
    /// A text.
    Text(String),
    /// An unsigned integer.
    Integer(u64),
    /// A truth value.
    Truth(bool),
    /// A number: whether it is negated, and its digits.
    Number(bool, Literal),
    /// `Real::INFINITY`, or the negative one.
    Infinite(bool),
    /// An array.
    Array(Vec<Constant>),
}

impl Constant {
    /// Reads the expression of a constant.
    pub(super) fn read(expression: &Expr, real: Float) -> Result<Constant, String> {
        match expression {
            Expr::Array(array) => {
                let entries: Result<_, _> = array.elems.iter().map(|e| Constant::read(e, real)).collect();
                Ok(Constant::Array(entries?))
            }
            Expr::Lit(literal) => match &literal.lit {
                Lit::Str(s) => Ok(Constant::Text(s.value())),
                Lit::Bool(b) => Ok(Constant::Truth(b.value)),
                Lit::Int(i) if i.suffix().is_empty() => {
                    i.base10_parse().map(Constant::Integer).map_err(|e| format!("`{i}`: {e}"))
                }
                Lit::Float(f) => float(f, real).map(|literal| Constant::Number(false, literal)),
                other => Err(format!("`{}` is not a value that a constant has", text(other))),
            },
            Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => match Constant::read(&unary.expr, real)? {
                Constant::Number(negative, literal) => Ok(Constant::Number(!negative, literal)),
                _ => Err(format!("`{}` is not a number", text(unary))),
            },
            other => match text(other).as_str() {
                "Real::INFINITY" => Ok(Constant::Infinite(false)),
                "Real::NEG_INFINITY" => Ok(Constant::Infinite(true)),
                other => Err(format!("`{other}` is not a value that a constant has")),
            },
        }
    }
}

/// A decimal literal without a suffix.
pub(super) fn float(literal: &syn::LitFloat, real: Float) -> Result<Literal, String> {
    if !literal.suffix().is_empty() {
        return Err(format!("`{literal}` has a suffix"));
    }
    let digits = literal.base10_digits().to_string();
    let value = real.read(&digits).filter(|v| v.is_finite()).ok_or(format!("`{digits}` is no finite number"))?;
    Ok(Literal { text: digits, value })
}
