//! Expressions of the file: text -> syntax tree, nothing evaluated but decimals.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = { "+" | "-" } atom
//! atom    = decimal | "pi" | name | ("deg" | "sqrt") "(" sum ")" | "(" sum ")"
//! ```
//!
//! A decimal is exactly the fraction of its digits. Every part of the tree knows its place in the file.

mod units;

pub use units::{decimal_text, Unit};

use dashu_int::{IBig, UBig};

use super::excerpt;
use super::yaml::Scalar;
use crate::diagnostic::{Code, Diagnostic};
use crate::exact::Rational;
use crate::source::{Source, Span};

/// Parentheses, functions and signs may nest so deep.
const MAX_DEPTH: usize = 32;
/// Operators between two operands: a sum of so many terms is a tree as deep, and everything that reads it goes down as deep.
const MAX_OPERATORS: usize = 128;
/// Bytes of an expression.
pub(crate) const MAX_TEXT: usize = 2000;
/// Digits of a decimal.
const MAX_DIGITS: usize = 200;
/// Powers of ten of a decimal, either way.
const MAX_POWER: i64 = 1000;

/// How comments are written.
const COMMENT: &str = "a comment begins with a blank and `#`";

/// The expression of n pi/12, in lowest terms: `-5*pi/6`.
pub fn multiple_of_pi(n: i64) -> String {
    let fraction = Rational::from(n) / Rational::from(12);
    let (numerator, denominator) = (fraction.numerator().to_string(), fraction.denominator().to_string());
    let start = match numerator.as_str() {
        "0" => return "0".to_owned(),
        "1" => "pi".to_owned(),
        "-1" => "-pi".to_owned(),
        n => format!("{n}*pi"),
    };
    if denominator == "1" {
        start
    } else {
        format!("{start}/{denominator}")
    }
}

/// An expression and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// Its kind.
    pub kind: ExpressionKind,
    /// Its place.
    pub span: Span,
}

/// Kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpressionKind {
    /// A decimal.
    Decimal(Rational),
    /// pi.
    Pi,
    /// A name of `parameters`.
    Name(String),
    /// -a.
    Negate(Box<Expression>),
    /// a + b, a - b, a * b, a / b.
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// a pi / 180.
    Degrees(Box<Expression>),
    /// The root of a.
    Root(Box<Expression>),
    /// a in a unit that the file names for it.
    InUnit(Box<Expression>, Unit),
}

/// Operators between two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// +
    Add,
    /// -
    Subtract,
    /// *
    Multiply,
    /// /
    Divide,
}

impl Expression {
    /// The names that occur, each with its place.
    pub fn named(&self) -> Vec<(&str, Span)> {
        let mut names = Vec::new();
        self.collect_names(&mut names);
        names
    }

    /// The names that occur.
    pub fn names(&self) -> Vec<&str> {
        self.named().into_iter().map(|(name, _)| name).collect()
    }

    fn collect_names<'e>(&'e self, names: &mut Vec<(&'e str, Span)>) {
        match &self.kind {
            ExpressionKind::Decimal(_) | ExpressionKind::Pi => {}
            ExpressionKind::Name(name) => names.push((name, self.span)),
            ExpressionKind::Negate(a) | ExpressionKind::Degrees(a) | ExpressionKind::Root(a) | ExpressionKind::InUnit(a, _) => {
                a.collect_names(names)
            }
            ExpressionKind::Binary(_, a, b) => {
                a.collect_names(names);
                b.collect_names(names);
            }
        }
    }

    /// The value in floating point, rounded at every operation; `Err` with the place of a name, which has no value here.
    pub fn to_f64(&self) -> Result<f64, Span> {
        Ok(match &self.kind {
            ExpressionKind::Decimal(x) => x.to_f64().value(),
            ExpressionKind::Pi => std::f64::consts::PI,
            ExpressionKind::Name(_) => return Err(self.span),
            ExpressionKind::Negate(a) => -a.to_f64()?,
            ExpressionKind::Binary(operator, a, b) => {
                let (a, b) = (a.to_f64()?, b.to_f64()?);
                match operator {
                    Operator::Add => a + b,
                    Operator::Subtract => a - b,
                    Operator::Multiply => a * b,
                    Operator::Divide => a / b,
                }
            }
            ExpressionKind::Degrees(a) => a.to_f64()?.to_radians(),
            ExpressionKind::Root(a) => a.to_f64()?.sqrt(),
            ExpressionKind::InUnit(a, unit) => a.to_f64()? * unit.to_f64(),
        })
    }

    /// Whether this is a decimal, with or without a sign.
    pub fn is_decimal(&self) -> bool {
        match &self.kind {
            ExpressionKind::Decimal(_) => true,
            ExpressionKind::Negate(a) => a.is_decimal(),
            _ => false,
        }
    }

    /// Whether it is an angle in degrees: `deg(..)`, or a multiple or part of that by whole numbers. Other factors may be lengths: a rack
    /// slides by the radius of its pinion times the angle.
    pub fn is_in_degrees(&self) -> bool {
        fn is_whole(factor: &Expression) -> bool {
            match &factor.kind {
                ExpressionKind::Decimal(value) => value.is_int(),
                ExpressionKind::Negate(a) => is_whole(a),
                _ => false,
            }
        }
        match &self.kind {
            ExpressionKind::Degrees(_) => true,
            ExpressionKind::Negate(a) | ExpressionKind::InUnit(a, _) => a.is_in_degrees(),
            ExpressionKind::Binary(Operator::Multiply, a, b) if is_whole(a) => b.is_in_degrees(),
            ExpressionKind::Binary(Operator::Multiply | Operator::Divide, a, b) if is_whole(b) => a.is_in_degrees(),
            _ => false,
        }
    }

    /// The value of a decimal, with or without a sign.
    pub fn as_decimal(&self) -> Option<Rational> {
        match &self.kind {
            ExpressionKind::Decimal(value) => Some(value.clone()),
            ExpressionKind::Negate(a) => a.as_decimal().map(|value| -value),
            _ => None,
        }
    }

    /// The same value in a unit.
    #[must_use]
    pub fn in_unit(self, unit: Unit) -> Expression {
        let span = self.span;
        Expression { kind: ExpressionKind::InUnit(Box::new(self), unit), span }
    }

    /// Its text in SI units: the text of the file, or the exact conversion of a value in a unit of the file.
    pub fn text(&self, source: &Source) -> String {
        let ExpressionKind::InUnit(value, unit) = &self.kind else {
            return source.slice(self.span).trim_matches(['"', '\'']).to_owned();
        };
        let decimal = value.as_decimal().and_then(|value| decimal_text(&(value * &unit.factor)));
        match (decimal, unit.degrees) {
            (Some(decimal), true) if decimal != "0" => format!("deg({decimal})"),
            (Some(decimal), _) => decimal,
            (None, degrees) => {
                let text = value.text(source).split_whitespace().collect::<Vec<_>>().join(" ");
                let factor = decimal_text(&unit.factor).unwrap_or_else(|| unit.factor.to_string());
                match (factor.as_str(), degrees) {
                    ("1", true) => format!("deg({text})"),
                    (_, true) => format!("deg(({text})*{factor})"),
                    ("-1", false) => format!("-({text})"),
                    (_, false) => format!("({text})*{factor}"),
                }
            }
        }
    }

    /// The name, if the expression is just one, with or without a sign.
    pub fn as_name(&self) -> Option<&str> {
        match &self.kind {
            ExpressionKind::Name(name) => Some(name),
            ExpressionKind::Negate(a) => a.as_name(),
            _ => None,
        }
    }
}

/// The expression that a scalar at `span` holds. (The error is large, but rare.)
pub fn parse(scalar: &Scalar, span: Span) -> Result<Expression, Box<Diagnostic>> {
    let mut parser = Parser { text: &scalar.text, at: 0, depth: 0, operators: 0, verbatim: scalar.verbatim, whole: span };
    if scalar.text.len() > MAX_TEXT {
        let mut parts = scalar.text.split(['e', 'E']);
        let digits = |part: &str| part.trim_start_matches(['+', '-']).bytes().all(|b| b.is_ascii_digit() || b == b'.');
        let (message, help) = if parts.clone().count() <= 2 && parts.all(digits) {
            (format!("a number of {} characters", scalar.text.len()), "no quantity is known to so many digits: shorten it")
        } else {
            (format!("an expression of {} characters", scalar.text.len()), "give parts of it names under `parameters`")
        };
        return Err(Box::new(Diagnostic::new(
            Code::TooComplex,
            span,
            message + " is too long",
            format!("more than {MAX_TEXT}"),
            help,
        )));
    }
    let expression = parser.sum()?;
    parser.skip_blanks();
    if parser.at < parser.text.len() {
        return Err(parser.unexpected());
    }
    Ok(expression)
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    operators: usize,
    verbatim: Option<usize>,
    whole: Span,
}

type Result_ = Result<Expression, Box<Diagnostic>>;

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn skip_blanks(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    /// Place in the file of a range of the text.
    fn span(&self, from: usize, to: usize) -> Span {
        self.verbatim.map_or(self.whole, |start| Span::new(start + from, start + to))
    }

    fn expression(&self, kind: ExpressionKind, from: usize) -> Expression {
        Expression { kind, span: self.span(from, self.at) }
    }

    fn error(&self, from: usize, to: usize, label: impl Into<String>, help: impl Into<String>) -> Box<Diagnostic> {
        let message = format!("`{}` is not an expression", excerpt(self.text));
        Box::new(Diagnostic::new(Code::BadExpression, self.span(from, to), message, label, help))
    }

    fn not_finite(&self, span: Span) -> Box<Diagnostic> {
        let message = format!("`{}` is not a finite number", excerpt(self.text));
        let help = "every quantity of an arm is finite; leave the key out where it is optional and unknown";
        Box::new(Diagnostic::new(Code::NotFinite, span, message, "not finite", help))
    }

    fn deeper<T>(&mut self, inner: impl FnOnce(&mut Self) -> Result<T, Box<Diagnostic>>) -> Result<T, Box<Diagnostic>> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let span = self.span(self.at, self.at + self.peek().map_or(0, char::len_utf8));
            let message = format!("an expression nests deeper than {MAX_DEPTH} levels");
            let help = "give parts of it names under `parameters`";
            return Err(Box::new(Diagnostic::new(Code::TooComplex, span, message, "too deep here", help)));
        }
        let result = inner(self);
        self.depth -= 1;
        result
    }

    fn sum(&mut self) -> Result_ {
        self.left_associative(&[('+', Operator::Add), ('-', Operator::Subtract)], Self::product)
    }

    fn product(&mut self) -> Result_ {
        self.left_associative(&[('*', Operator::Multiply), ('/', Operator::Divide)], Self::signed)
    }

    fn left_associative(&mut self, operators: &[(char, Operator)], operand: fn(&mut Self) -> Result_) -> Result_ {
        self.skip_blanks();
        let from = self.at;
        let mut left = operand(self)?;
        loop {
            let end = self.at;
            self.skip_blanks();
            let Some(&(_, operator)) = self.peek().and_then(|c| operators.iter().find(|(o, _)| *o == c)) else {
                self.at = end;
                return Ok(left);
            };
            self.at += 1;
            self.operators += 1;
            if self.operators > MAX_OPERATORS {
                let message = format!("an expression of more than {MAX_OPERATORS} operators is too long");
                let help = "give parts of it names under `parameters`";
                let span = self.span(self.at - 1, self.at);
                return Err(Box::new(Diagnostic::new(Code::TooComplex, span, message, "one too many", help)));
            }
            if self.rest().starts_with('*') {
                let (label, help) = match operator {
                    Operator::Divide if self.rest().contains("*/") || self.rest()[1..].starts_with(char::is_whitespace) => {
                        ("a comment?", COMMENT)
                    }
                    Operator::Divide => ("two operators", "write one operator between two values"),
                    _ => ("powers are not supported", "write the product out: `a*a`"),
                };
                return Err(self.error(self.at - 1, self.at + 1, label, help));
            }
            if operator == Operator::Divide && self.rest().starts_with('/') {
                return Err(self.error(self.at - 1, self.at + 1, "a comment?", COMMENT));
            }
            self.skip_blanks();
            let right = operand(self)?;
            left = self.expression(ExpressionKind::Binary(operator, Box::new(left), Box::new(right)), from);
        }
    }

    fn signed(&mut self) -> Result_ {
        self.skip_blanks();
        let from = self.at;
        match self.peek() {
            Some('-') => {
                self.at += 1;
                let inner = self.deeper(Self::signed)?;
                Ok(self.expression(ExpressionKind::Negate(Box::new(inner)), from))
            }
            Some('+') => {
                self.at += 1;
                self.deeper(Self::signed)
            }
            _ => self.atom(),
        }
    }

    fn atom(&mut self) -> Result_ {
        let from = self.at;
        match self.peek() {
            Some('(') => {
                let inner = self.parenthesised()?;
                Ok(Expression { span: self.span(from, self.at), ..inner })
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.decimal(),
            Some(c) if is_name_start(c) => {
                let name = &self.rest()[..self.rest().find(|c| !is_name_part(c)).unwrap_or(self.rest().len())];
                self.at += name.len();
                match name {
                    "\u{3c0}" => Err(self.error(from, self.at, "unexpected here", "write `pi`")),
                    "pi" => Ok(self.expression(ExpressionKind::Pi, from)),
                    "deg" | "sqrt" => {
                        self.skip_blanks();
                        if self.peek() != Some('(') {
                            let help = format!("write `{name}(...)`");
                            return Err(self.error(from, from + name.len(), format!("`{name}` is a function"), help));
                        }
                        let inner = Box::new(self.parenthesised()?);
                        let kind = if name == "deg" { ExpressionKind::Degrees(inner) } else { ExpressionKind::Root(inner) };
                        Ok(self.expression(kind, from))
                    }
                    _ => {
                        if self.rest().starts_with('(') {
                            let help = "the functions are `deg(...)` (degrees to radians) and `sqrt(...)`; work other values out by hand";
                            return Err(self.error(from, self.at, format!("no function is called `{}`", excerpt(name)), help));
                        }
                        Ok(self.expression(ExpressionKind::Name(name.into()), from))
                    }
                }
            }
            _ => Err(self.unexpected()),
        }
    }

    fn parenthesised(&mut self) -> Result_ {
        let open = self.at;
        self.at += 1;
        let inner = self.deeper(Self::sum)?;
        self.skip_blanks();
        match self.peek() {
            Some(')') => {
                self.at += 1;
                Ok(inner)
            }
            None => Err(self.error(open, open + 1, "this parenthesis is not closed", "close it with `)`")),
            Some(_) => Err(self.unexpected()),
        }
    }

    /// Digits with at most one point among them, then perhaps a power of ten.
    fn decimal(&mut self) -> Result_ {
        let from = self.at;
        let bytes = self.text.as_bytes();
        let digits = |at: &mut usize| {
            let start = *at;
            while bytes.get(*at).is_some_and(u8::is_ascii_digit) {
                *at += 1;
            }
            start..*at
        };
        let whole = digits(&mut self.at);
        let mut fraction = self.at..self.at;
        if bytes.get(self.at) == Some(&b'.') {
            self.at += 1;
            fraction = digits(&mut self.at);
        }
        if whole.is_empty() && fraction.is_empty() {
            if let Some(word) = ["inf", "nan"].iter().find(|w| self.rest().to_ascii_lowercase().starts_with(*w)) {
                return Err(self.not_finite(self.span(from, self.at + word.len())));
            }
            return Err(self.error(from, self.at, "a point without digits", "write digits beside the point: `0.5`"));
        }
        let mut power = 0i64;
        if matches!(bytes.get(self.at), Some(b'e' | b'E')) {
            let mark = self.at;
            self.at += 1;
            let negative = bytes.get(self.at) == Some(&b'-');
            if matches!(bytes.get(self.at), Some(b'+' | b'-')) {
                self.at += 1;
            }
            let range = digits(&mut self.at);
            if range.is_empty() {
                let help = "write the power of ten as in `1e-3`, or `*` between a number and a name";
                return Err(self.error(mark, self.at, "a power of ten without digits", help));
            }
            // A power that does not fit is far beyond MAX_POWER.
            let size = self.text[range].parse::<i64>().unwrap_or(i64::MAX / 2);
            power = if negative { -size } else { size };
        }
        self.no_junk_after_number(from)?;
        let text: String = [&self.text[whole], &self.text[fraction.clone()]].concat();
        let text = text.trim_start_matches('0');
        let value = if text.is_empty() {
            Rational::ZERO
        } else {
            if text.len() > MAX_DIGITS {
                let message = format!("a number of {} digits is too long", text.len());
                let help = "no quantity is known to so many digits: shorten it";
                let span = self.span(from, self.at);
                return Err(Box::new(Diagnostic::new(Code::TooComplex, span, message, format!("more than {MAX_DIGITS}"), help)));
            }
            power -= fraction.len() as i64;
            if power.abs() > MAX_POWER {
                return Err(Box::new(out_of_range(self.span(from, self.at), excerpt(&self.text[from..self.at]), power > 0)));
            }
            let digits = UBig::from_str_radix(text, 10).expect("only digits were read");
            let scale = UBig::from(10u8).pow(power.unsigned_abs() as usize);
            if power < 0 {
                Rational::from_parts(IBig::from(digits), scale)
            } else {
                Rational::from(digits * scale)
            }
        };
        Ok(self.expression(ExpressionKind::Decimal(value), from))
    }

    /// Complains about what sticks to a number: a second point, a decimal comma, a name, a unit.
    fn no_junk_after_number(&mut self, from: usize) -> Result<(), Box<Diagnostic>> {
        let Some(next) = self.peek() else { return Ok(()) };
        let number = excerpt(&self.text[from..self.at]);
        let end = self.at + self.rest().find(|c: char| !is_name_part(c) && c != '.').unwrap_or(self.rest().len());
        if next == '.' {
            return Err(self.error(from, end, "two points in one number", "write one decimal point"));
        }
        if next == '_' {
            return Err(self.error(from, end, "digits are not grouped", "write the digits without `_`"));
        }
        if is_name_part(next) {
            let (word, whole) = (&self.text[self.at..end], &self.text[from..end]);
            if number == "0" && matches!(next, 'x' | 'o' | 'b') {
                return Err(self.error(
                    from,
                    end,
                    format!("`{}` is not a decimal", excerpt(whole)),
                    "write the number in decimal digits",
                ));
            }
            let help = units::without(&self.text[..self.at], self.rest())
                .or_else(|| units::compound(self.rest()))
                .unwrap_or_else(|| format!("write `{number}*{}` if a product is meant", excerpt(word)));
            return Err(self.error(self.at, end, "letters directly behind a number", help));
        }
        Ok(())
    }

    /// The number with a point, where the text is one with a comma.
    fn decimal_with_comma(&self) -> Option<String> {
        let (whole, fraction) = self.text.trim().split_once(',')?;
        let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        let digits = fraction.split_once(['e', 'E']).map_or(fraction, |(digits, _)| digits);
        (is_number(whole.trim_start_matches('-')) && is_number(digits))
            .then(|| format!("{}.{}", excerpt(whole), excerpt(fraction)))
    }

    /// Complains about the character here, or the end.
    fn unexpected(&self) -> Box<Diagnostic> {
        let Some(c) = self.peek() else {
            if self.text.trim().is_empty() {
                return self.error(0, self.text.len(), "nothing stands here", "write a number or an expression such as `pi/2`");
            }
            let end = self.text.trim_end().len();
            let last = self.text[..end].char_indices().next_back().map_or(0, |(at, _)| at);
            return self.error(last, end, "it ends here, before it is complete", "write a number or a name after this");
        };
        if let Some(help) = units::without(&self.text[..self.at], self.rest()) {
            return self.error(self.at, self.text.trim_end().len(), "a unit", help);
        }
        let before = self.text[..self.at].char_indices().next_back().filter(|_| c == '#');
        if let Some((at, name)) = before.and_then(|(at, blank)| Some((at, super::invisible(blank)?))) {
            return self.error(at, self.at, name, "type a space instead, with which a comment begins");
        }
        if let Some(name) = super::invisible(c) {
            let help = "remove it, or type a space: it came with a text that was pasted";
            return self.error(self.at, self.at + c.len_utf8(), name, help);
        }
        if let Some(decimal) = self.decimal_with_comma() {
            return self.error(self.at, self.at + 1, "a decimal comma", format!("a decimal has a point: write `{decimal}`"));
        }
        let help = match c {
            '#' => "write a blank before `#`, with which a comment begins",
            ';' => "remove it: a value ends with its line, or with a comma between braces",
            ',' => "write a decimal point (`0.5`); a list of values stands in [ ]",
            '^' => "powers are not supported: write the product out: `a*a`",
            '\u{b0}' => units::DEGREES,
            '\u{2212}' | '\u{2013}' | '\u{2014}' => "write the minus sign `-` of the keyboard",
            '\u{d7}' | '\u{b7}' | '\u{22c5}' => "write a product with `*`",
            '\u{f7}' => "write a quotient with `/`",
            '\u{221a}' => "write a root as `sqrt(2)`",
            '%' => "write the number itself: `0.05` for 5 percent",
            ')' => "remove it, or open it with `(`",
            '$' | '{' | '}' => "write names as they are, without braces",
            '=' | '<' | '>' | '!' | '&' | '|' | '?' | ':' => "an expression has only the operators + - * /",
            '(' | '0'..='9' | '.' => "write an operator (+ - * /) between two values",
            c if is_name_start(c) => "write an operator (+ - * /) between two values",
            _ => "an expression may use + - * / ( ), decimals, 1e-3, pi, deg(90), sqrt(2) and the names under `parameters`",
        };
        self.error(self.at, self.at + c.len_utf8(), "unexpected here", help)
    }
}

/// The error about a number beyond the floats' range, `above` or below.
pub(crate) fn out_of_range(span: Span, text: String, above: bool) -> Diagnostic {
    let (message, help) = if above {
        (format!("{text} is beyond the range of the emitted numbers"), "check the power of ten: the largest f64 is about 1.8e308")
    } else {
        (
            format!("{text} is so small that it becomes 0 in the emitted numbers"),
            "write 0 if that is meant; the smallest f64 is about 5e-324",
        )
    };
    Diagnostic::new(Code::OutOfRange, span, message, if above { "too large" } else { "too small" }, help)
}

fn is_name_start(c: char) -> bool {
    c == '_' || c.is_alphabetic()
}

fn is_name_part(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

#[cfg(test)]
mod tests;
