//! Numbers of a file: their digits as they stand, in the spelling of expressions, and the float next to them for what only compares.

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::document::yaml::Scalar;
use armgen_codegen::document::{parse_expression, Expression, ExpressionKind, Operator};
use armgen_codegen::exact::{Number, Rational};
use armgen_codegen::source::Span;

use crate::xml::{is_use, shown};
use crate::Code;

/// Digits of a number.
const MAX_DIGITS: usize = 200;
/// Powers of ten, either way.
const MAX_POWER: i32 = 1000;

/// Digits of a decimal that is written exactly.
const LONGEST: usize = 30;

/// A number of the file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Decimal {
    /// As robot.yaml writes it: the digits of the file.
    pub(crate) text: String,
    /// The nearest float.
    pub(crate) value: f64,
    /// Its place.
    pub(crate) span: Span,
}

impl Decimal {
    /// 0, standing nowhere.
    pub(crate) fn zero() -> Decimal {
        Decimal { text: "0".into(), value: 0.0, span: Span::default() }
    }

    /// 1, standing nowhere.
    pub(crate) fn one() -> Decimal {
        Decimal { text: "1".into(), value: 1.0, span: Span::default() }
    }

    /// Whether it is 0.
    pub(crate) fn is_zero(&self) -> bool {
        self.value == 0.0
    }

    /// Whether its digits write a whole number.
    pub(crate) fn is_integer(&self) -> bool {
        let digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
        let (whole, fraction) =
            self.text.trim_start_matches('-').split_once('.').unwrap_or((self.text.trim_start_matches('-'), ""));
        digits(whole) && fraction.bytes().all(|b| b == b'0')
    }

    /// Its exact value; the text may be an expression of decimals and degrees.
    pub(crate) fn exact(&self) -> Number {
        if self.text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'-' | b'.' | b'e')) {
            return exact(&self.text);
        }
        let scalar = Scalar { text: self.text.clone(), plain: true, verbatim: None };
        parse_expression(&scalar, self.span).map_or_else(|_| Number::zero(), |expression| value(&expression))
    }
}

/// The exact value of sums and products of decimals and degrees.
fn value(expression: &Expression) -> Number {
    match &expression.kind {
        ExpressionKind::Decimal(x) => Number::from(x.clone()),
        ExpressionKind::Negate(a) => -&value(a),
        ExpressionKind::Degrees(a) => value(a).times(&(&Number::pi() * &Number::from(Rational::from(1) / Rational::from(180)))),
        ExpressionKind::Binary(Operator::Add, a, b) => value(a).plus(&value(b)),
        ExpressionKind::Binary(Operator::Multiply, a, b) => value(a).times(&value(b)),
        other => unreachable!("import writes no {other:?}"),
    }
}

/// The exact value of a decimal.
pub(crate) fn exact(text: &str) -> Number {
    let (mantissa, power) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: Rational = format!("{whole}{fraction}").parse().unwrap_or(Rational::ZERO);
    let power = power.parse::<i32>().unwrap_or(0) - fraction.len() as i32;
    let ten = Rational::from(10u8);
    let scale = ten.pow(power.unsigned_abs() as isize);
    Number::from(if power < 0 { digits / scale } else { digits * scale })
}

/// The number that a word is; faults are reported.
pub(crate) fn decimal(word: &str, span: Span, what: &str, diagnostics: &mut Diagnostics) -> Option<Decimal> {
    let mut fault = |code: Code, message: String, label: &str, help: &str| {
        diagnostics.push(Diagnostic::new(code, span, message, label, help));
        None
    };
    let word_shown = shown(word);
    if is_use(word) {
        let help = "write the file out and import that: `pip install xacro`, `xacro FILE.xacro > FILE.urdf`";
        return fault(Code::Xacro, format!("{what} is `{word_shown}`: this is xacro, not a URDF"), "not written out", help);
    }
    let plain = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    if matches!(plain.as_str(), "nan" | "inf" | "infinity") {
        return fault(Code::NotFinite, format!("{what} is `{word_shown}`"), "not finite", "every quantity of an arm is finite");
    }
    let Some((negative, whole, fraction, power)) = split(word) else {
        let help = "write a decimal such as `-0.5` or `1e-3`, with a point and without units";
        return fault(Code::BadNumber, format!("{what} is `{word_shown}`, which is no number"), "not a number", help);
    };
    let power = power.parse::<i32>().ok().filter(|power| power.abs() <= MAX_POWER);
    let (true, Some(power)) = (whole.len() + fraction.len() <= MAX_DIGITS, power) else {
        let help = "write at most 200 digits, and powers of ten of at most 1000";
        return fault(Code::OutOfRange, format!("{what} is too long to be kept exactly"), "too long", help);
    };
    let (whole, fraction) = (whole.trim_start_matches('0'), fraction);
    let sign = if negative { "-" } else { "" };
    let mut text = format!("{sign}{}", if whole.is_empty() { "0" } else { whole });
    if !fraction.is_empty() {
        text += &format!(".{fraction}");
    }
    if power != 0 {
        text += &format!("e{power}");
    }
    let value: f64 = text.parse().unwrap_or(f64::NAN);
    let nothing = whole.bytes().chain(fraction.bytes()).all(|digit| digit == b'0');
    if nothing {
        return Some(Decimal { span, ..Decimal::zero() });
    }
    if !value.is_finite() || value == 0.0 {
        let help = "look for a length, mass or inertia of an unlikely size: SI units throughout";
        return fault(Code::OutOfRange, format!("{what} is `{word_shown}`, which no float can hold"), "out of range", help);
    }
    Some(Decimal { text, value, span })
}

/// Sign, digits before and after the point, and power of ten.
fn split(word: &str) -> Option<(bool, &str, &str, &str)> {
    let (negative, rest) = match word.as_bytes().first()? {
        b'-' => (true, &word[1..]),
        b'+' => (false, &word[1..]),
        _ => (false, word),
    };
    let (mantissa, power) = match rest.find(['e', 'E']) {
        Some(at) => (&rest[..at], rest[at + 1..].strip_prefix('+').unwrap_or(&rest[at + 1..])),
        None => (rest, "0"),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
    let power_digits = power.strip_prefix('-').unwrap_or(power);
    let valid = digits(whole)
        && digits(fraction)
        && !(whole.is_empty() && fraction.is_empty())
        && digits(power_digits)
        && !power_digits.is_empty();
    valid.then_some((negative, whole, fraction, power))
}

/// The decimal of a fraction, if it ends soon.
pub(crate) fn ending(value: &Rational) -> Option<String> {
    let ten = Rational::from(10u8);
    let mut scaled = value.clone();
    for digits in 0..=LONGEST {
        if scaled.is_int() {
            let text = scaled.numerator().to_string();
            let (sign, whole) = text.strip_prefix('-').map_or(("", text.as_str()), |rest| ("-", rest));
            if whole.len() > LONGEST {
                return None;
            }
            let padded = format!("{whole:0>width$}", width = digits + 1);
            let (before, after) = padded.split_at(padded.len() - digits);
            return Some(if after.is_empty() { format!("{sign}{before}") } else { format!("{sign}{before}.{after}") });
        }
        scaled *= &ten;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(word: &str, expected: Result<&str, Code>) {
        let mut diagnostics = Diagnostics::new();
        let found = decimal(word, Span::default(), "x", &mut diagnostics);
        match expected {
            Ok(text) => assert_eq!(found.map(|d| d.text).as_deref(), Some(text), "{word}"),
            Err(code) => {
                assert!(found.is_none() && diagnostics.iter().all(|d| d.code == code) && diagnostics.errors() == 1, "{word}")
            }
        }
    }

    #[test]
    fn digits_stay_and_spellings_change() {
        for (word, text) in [
            ("0.0825", "0.0825"),
            ("1e-3", "1e-3"),
            ("+.5", "0.5"),
            ("1.", "1"),
            ("1E-3", "1e-3"),
            ("-1E+05", "-1e5"),
            ("007.10", "7.10"),
            ("0", "0"),
            ("-0.0", "0"),
            ("-.25e2", "-0.25e2"),
        ] {
            check(word, Ok(text));
        }
        for word in ["1,5", "1.0.0", "0x10", "", "-", ".", "e5", "1e", "--1", "1e5.0", "one", "1 2", "\u{661}"] {
            check(word, Err(Code::BadNumber));
        }
        for word in ["nan", "-inf", "Infinity"] {
            check(word, Err(Code::NotFinite));
        }
        check("1e999999999", Err(Code::OutOfRange));
        check("1e-400", Err(Code::OutOfRange));
        check(&"1".repeat(100_000), Err(Code::OutOfRange));
        check("${pi/2}", Err(Code::Xacro));
    }

    #[test]
    fn the_exact_value_is_what_the_digits_say() {
        let exact = |word: &str| decimal(word, Span::default(), "x", &mut Diagnostics::new()).map(|d| d.exact().to_string());
        assert_eq!(exact("-0.125e1").as_deref(), Some("-5/4"));
        assert_eq!(exact("2e3").as_deref(), Some("2000"));
        assert_eq!(exact(".1").as_deref(), Some("1/10"));
    }
}
