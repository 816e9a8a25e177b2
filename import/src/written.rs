//! A number as robot.yaml has it, beside what the file said.

use armgen_codegen::source::Span;

use crate::number::Decimal;

/// A number in robot.yaml.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Written {
    /// An expression.
    pub(crate) text: String,
    /// Its value.
    pub(crate) value: f64,
    /// How far that is from what the file says.
    pub(crate) offset: f64,
    /// The number of twelfths of pi, if it is such an angle.
    pub(crate) twelfths: Option<i64>,
    /// The place of what it stands for.
    pub(crate) span: Span,
}

impl Written {
    pub(crate) fn as_is(decimal: &Decimal) -> Written {
        Written {
            text: decimal.text.clone(),
            value: decimal.value,
            offset: 0.0,
            twelfths: decimal.is_zero().then_some(0),
            span: decimal.span,
        }
    }

    pub(crate) fn zero() -> Written {
        Written::as_is(&Decimal::zero())
    }

    /// As a number that is not known to be a multiple of pi/12.
    pub(crate) fn inexact(self) -> Written {
        Written { twelfths: None, ..self }
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.text == "0"
    }
}
