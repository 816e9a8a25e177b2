//! Plain formulas: text to tree, and a tree's value in f64.
//!
//! ```text
//! sum     = [+-] product ([+-] product)*
//! product = factor ([*/] factor)*
//! factor  = [+-] factor | power
//! power   = atom [^ factor]
//! atom    = number | name | name ( sum ) | ( sum )
//! ```
//!
//! A number is digits with an optional point and exponent, kept as text: the caller decides its exact value.

use std::collections::BTreeMap;

/// A formula as written.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// A decimal, as written.
    Number(String),
    /// A name, such as `pi`.
    Name(String),
    /// A function of one argument: `sin`, `cos`, `sqrt`, ...
    Call(String, Box<Formula>),
    /// - x
    Negative(Box<Formula>),
    /// Two operands and one of `+ - * / ^`.
    Binary(char, Box<Formula>, Box<Formula>),
}

/// Reads a formula; the error names the place (1-based column) and what was found.
pub fn parse(text: &str) -> Result<Formula, String> {
    let mut parser = Parser { text, rest: text, depth: 0 };
    let formula = parser.sum()?;
    match parser.peek() {
        None => Ok(formula),
        Some(found) => parser.fail(&format!("`{found}` after the end of the formula")),
    }
}

/// Value of a formula in f64; `names` gives the names, `pi` is known.
///
/// Errors: an unknown name or function.
pub fn evaluate(formula: &Formula, names: &BTreeMap<String, f64>) -> Result<f64, String> {
    Ok(match formula {
        Formula::Number(digits) => digits.parse().map_err(|_| format!("not a number: {digits}"))?,
        Formula::Name(name) if name == "pi" => std::f64::consts::PI,
        Formula::Name(name) => *names.get(name).ok_or_else(|| format!("unknown name `{name}`"))?,
        Formula::Call(function, argument) => {
            let x = evaluate(argument, names)?;
            match function.as_str() {
                "sin" => x.sin(),
                "cos" => x.cos(),
                "sqrt" => x.sqrt(),
                "deg" => x.to_radians(),
                "exp" => x.exp(),
                "abs" => x.abs(),
                "sign" if x == 0.0 => 0.0,
                "sign" => x.signum(),
                _ => return Err(format!("unknown function `{function}`")),
            }
        }
        Formula::Negative(x) => -evaluate(x, names)?,
        Formula::Binary(operator, a, b) => {
            let (a, b) = (evaluate(a, names)?, evaluate(b, names)?);
            match operator {
                '+' => a + b,
                '-' => a - b,
                '*' => a * b,
                '/' => a / b,
                _ if b.fract() == 0.0 && b.abs() < 1e9 => a.powi(b as i32),
                _ => a.powf(b),
            }
        }
    })
}

/// Deepest nesting that is read: well above any formula, well below the stack.
const DEPTH: usize = 200;

struct Parser<'a> {
    text: &'a str,
    rest: &'a str,
    depth: usize,
}

impl Parser<'_> {
    fn peek(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.rest = &self.rest[wanted.len_utf8()..];
        }
        found
    }

    fn fail<T>(&self, what: &str) -> Result<T, String> {
        let column = self.text[..self.text.len() - self.rest.len()].chars().count() + 1;
        Err(format!("column {column}: {what} in `{}`", self.text))
    }

    fn sum(&mut self) -> Result<Formula, String> {
        self.depth += 1;
        if self.depth > DEPTH {
            return self.fail("nested too deeply");
        }
        let mut left = self.product()?;
        while let Some(operator @ ('+' | '-')) = self.peek() {
            self.take(operator);
            left = Formula::Binary(operator, Box::new(left), Box::new(self.product()?));
        }
        self.depth -= 1;
        Ok(left)
    }

    fn product(&mut self) -> Result<Formula, String> {
        let mut left = self.factor()?;
        while let Some(operator @ ('*' | '/')) = self.peek() {
            self.take(operator);
            left = Formula::Binary(operator, Box::new(left), Box::new(self.factor()?));
        }
        Ok(left)
    }

    fn factor(&mut self) -> Result<Formula, String> {
        let mut negative = false;
        loop {
            if self.take('-') {
                negative = !negative;
            } else if !self.take('+') {
                break;
            }
        }
        let power = self.power()?;
        Ok(if negative { Formula::Negative(Box::new(power)) } else { power })
    }

    fn power(&mut self) -> Result<Formula, String> {
        let base = self.atom()?;
        if !self.take('^') {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > DEPTH {
            return self.fail("nested too deeply");
        }
        let exponent = self.factor()?;
        self.depth -= 1;
        Ok(Formula::Binary('^', Box::new(base), Box::new(exponent)))
    }

    fn atom(&mut self) -> Result<Formula, String> {
        match self.peek() {
            Some('(') => self.parenthesis(),
            // A constant that is not written out is shown by the decimal nearest to it, sign included.
            Some('≈') => {
                self.rest = &self.rest['≈'.len_utf8()..];
                self.factor()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() || c == '_' => {
                let length = self.rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(self.rest.len());
                let name = self.rest[..length].to_owned();
                self.rest = &self.rest[length..];
                if self.peek() == Some('(') {
                    return Ok(Formula::Call(name, Box::new(self.parenthesis()?)));
                }
                Ok(Formula::Name(name))
            }
            Some(c) => self.fail(&format!("unexpected `{c}`")),
            None => self.fail("unexpected end"),
        }
    }

    fn parenthesis(&mut self) -> Result<Formula, String> {
        self.take('(');
        let inner = self.sum()?;
        if self.take(')') {
            Ok(inner)
        } else {
            self.fail("missing `)`")
        }
    }

    fn number(&mut self) -> Result<Formula, String> {
        let bytes = self.rest.as_bytes();
        let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut end = digits(0);
        let mut significant = end;
        if bytes.get(end) == Some(&b'.') {
            let fraction = digits(end + 1);
            significant += fraction;
            end += 1 + fraction;
        }
        if significant == 0 {
            return self.fail("a point without digits");
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            if exponent > 0 {
                end += 1 + sign + exponent;
            }
        }
        let number = self.rest[..end].to_owned();
        self.rest = &self.rest[end..];
        if matches!(self.rest.chars().next(), Some(c) if c.is_ascii_alphanumeric() || c == '_' || c == '.') {
            return self.fail("a number runs into something else");
        }
        Ok(Formula::Number(number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, value: f64) {
        let names = BTreeMap::from([("x".to_owned(), 3.0), ("m_l1".to_owned(), -2.0)]);
        assert_eq!(parse(text).and_then(|f| evaluate(&f, &names)), Ok(value), "{text}");
    }

    #[test]
    fn values() {
        check("1 + 2*x - 4/2", 5.0);
        check("-x^2", -9.0);
        check("2^-1", 0.5);
        check("--x", 3.0);
        check("2*-x", -6.0);
        check("8/2/2", 2.0);
        check("1-2-3", -4.0);
        check("2^(1+1)*m_l1", -8.0);
        check("1.5e-1+.5+2.E1", 20.65);
        check("sin(0) + cos(0) - sqrt(4)", -1.0);
        check("sign(m_l1) + sign(0)", -1.0);
        check("deg(180) - pi", 0.0);
    }

    #[test]
    fn faults_have_a_place() {
        for (text, column) in
            [("", 1), ("1 +", 4), ("2 x", 3), ("(1", 3), ("1)", 2), ("sin(", 5), ("1.2.3", 4), (".", 1), ("2*²", 3)]
        {
            let error = parse(text).expect_err(text);
            assert!(error.starts_with(&format!("column {column}:")), "{text}: {error}");
        }
        assert!(parse(&"(".repeat(100_000)).is_err());
        assert!(parse(&format!("2{}", "^2".repeat(100_000))).is_err());
    }
}
