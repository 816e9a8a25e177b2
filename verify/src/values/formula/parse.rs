//! Parses formulas.
//!
//! ```text
//! sum = [-] product { (+|-) product }    product = power { (*|/) power }    power = primary [ ^ integer | ^( integer ) ]
//! primary = decimal | pi | sqrt(sum) | sin(sum) | cos(sum) | atan(fraction) | ( sum ) | name
//! ```

use dashu_base::{Abs, BitTest, Signed};
use dashu_int::{IBig, UBig};

use super::definitions::{self, Definitions};
use super::{Formula, Rational, Root};
use crate::values::check::Check;
use crate::values::element::Element;

const LONGEST: usize = 200_000;
const DEEPEST: usize = 64;
const LARGEST_POWER: i32 = 400;

/// Maximum number of bits of a power.
const LARGEST_BITS: usize = 1 << 14;

/// Cost estimates in nanoseconds: parsing, enclosure to some hundred bits, evaluation in some fields.
const WORK_OF_PRIMARY: u64 = 500;
const WORK_OF_FACTOR: u64 = 5_000;
const WORK_OF_WAVE: u64 = 30_000;
/// Per 64 bits of an integer: trial division by primes.
const WORK_OF_ROOT: u64 = 20_000;

/// The length of a fraction, in 64-bit words.
fn words(value: &Rational) -> u64 {
    (value.numerator().bit_len() + value.denominator().bit_len()) as u64 / 64 + 1
}

impl Formula {
    /// Parses a formula without names.
    pub fn parse(text: &str) -> Result<Formula, String> {
        Formula::parse_with(text, &Definitions::default())
    }

    /// Parses a formula that may use definitions.
    pub fn parse_with(text: &str, definitions: &Definitions) -> Result<Formula, String> {
        if text.len() > LONGEST {
            return Err(format!("a formula of {} characters is longer than any constant of a robot", text.len()));
        }
        let mut parser = Parser { rest: text, depth: 0, definitions };
        let formula = parser.sum()?;
        parser.skip();
        if parser.rest.is_empty() {
            Ok(formula)
        } else {
            Err(format!("`{}` is not part of a formula", parser.rest.chars().take(20).collect::<String>()))
        }
    }
}

struct Parser<'a> {
    rest: &'a str,
    depth: usize,
    definitions: &'a Definitions,
}

impl Parser<'_> {
    fn skip(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn take(&mut self, symbol: char) -> bool {
        self.skip();
        match self.rest.strip_prefix(symbol) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn expect(&mut self, symbol: char) -> Result<(), String> {
        if self.take(symbol) {
            Ok(())
        } else {
            Err(format!("expected `{symbol}` before `{}`", self.rest.chars().take(20).collect::<String>()))
        }
    }

    fn sum(&mut self) -> Result<Formula, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("a formula nested more than {DEEPEST} deep"));
        }
        let negative = self.take('-');
        let first = self.product()?;
        let mut terms = vec![if negative { first.negated() } else { first }];
        loop {
            if self.take('+') {
                terms.push(self.product()?);
            } else if self.take('-') {
                terms.push(self.product()?.negated());
            } else {
                break;
            }
        }
        self.depth -= 1;
        if let Some(terms) = terms.iter().map(Formula::as_rational).collect::<Option<Vec<&Rational>>>() {
            let mut sum = Rational::ZERO;
            for term in terms {
                self.charge_words(&[words(&sum), words(term)])?;
                sum += term;
            }
            return Ok(Formula::Rational(sum));
        }
        if terms.len() == 1 {
            return Ok(terms.remove(0));
        }
        // The terms of a sum in parentheses become terms of this sum.
        Ok(Formula::Sum(terms.iter().flat_map(Formula::terms).cloned().collect()))
    }

    /// Charges the work of a product or a sum of numbers with these lengths in words.
    fn charge_words(&self, words: &[u64]) -> Result<(), String> {
        let all: u64 = words.iter().sum();
        self.definitions.charge(all.saturating_mul(all))
    }

    fn product(&mut self) -> Result<Formula, String> {
        let mut factors = vec![self.power()?];
        loop {
            if self.take('*') {
                factors.push(self.power()?);
            } else if self.take('/') {
                factors.push(match self.power()? {
                    Formula::Rational(r) if r.is_zero() => return Err("a division by zero".into()),
                    Formula::Rational(r) => Formula::Rational(Rational::ONE / r),
                    divisor => Formula::Power(Box::new(divisor), -1),
                });
            } else {
                break;
            }
        }
        if factors.len() == 1 {
            return Ok(factors.remove(0));
        }
        // Fractions and radicands are multiplied.
        let mut all = 0;
        for factor in &factors {
            let parts = if let Formula::Product(parts) = factor { &parts[..] } else { std::slice::from_ref(factor) };
            for part in parts {
                all += match part {
                    Formula::Rational(value) => words(value),
                    Formula::Root(Root::Integer(n)) => n.bit_len() as u64 / 64 + 1,
                    _ => 0,
                };
                self.charge_words(&[all])?;
            }
        }
        Ok(Formula::product_of(factors))
    }

    fn power(&mut self) -> Result<Formula, String> {
        let base = self.primary()?;
        if !self.take('^') {
            return Ok(base);
        }
        let parenthesis = self.take('(');
        let negative = self.take('-');
        let size: i32 = self.digits().parse().map_err(|_| "an exponent is a small integer".to_string())?;
        if parenthesis {
            self.expect(')')?;
        }
        if size > LARGEST_POWER {
            return Err(format!("an exponent of {size}"));
        }
        let power = Formula::Power(Box::new(base), if negative { -size } else { size });
        self.definitions.charge(size as u64 * WORK_OF_FACTOR)?;
        match definitions::size(&power) {
            bits if bits > LARGEST_BITS && Check::Powers.is_made() => {
                Err(format!("a power of about {bits} bits is no constant of a robot"))
            }
            _ => Ok(power),
        }
    }

    fn digits(&mut self) -> String {
        self.skip();
        let end = self.rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(self.rest.len());
        let (digits, rest) = self.rest.split_at(end);
        self.rest = rest;
        digits.into()
    }

    fn primary(&mut self) -> Result<Formula, String> {
        self.skip();
        self.definitions.charge(WORK_OF_PRIMARY)?;
        if self.take('(') {
            let inner = self.sum()?;
            self.expect(')')?;
            return Ok(inner);
        }
        if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
            return self.decimal();
        }
        let end = self.rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        if word == "pi" {
            self.definitions.charge(WORK_OF_WAVE)?;
            return Ok(Formula::Pi);
        }
        if word == definitions::PREFIX {
            let digits = self.digits();
            return self.definitions.get(&digits).map(Formula::Defined).ok_or(format!("`{word}{digits}` is not defined before"));
        }
        if !["sqrt", "sin", "cos", "atan"].contains(&word) {
            return Err(format!("`{word}` where a number, pi, sqrt, sin, cos or atan can stand"));
        }
        self.expect('(')?;
        let inner = self.sum()?;
        self.expect(')')?;
        if let ("sqrt", Formula::Rational(value)) = (word, &inner) {
            // Numerator and denominator are multiplied.
            return self.definitions.root(value, words(value).saturating_mul(WORK_OF_ROOT));
        }
        self.definitions.charge(WORK_OF_WAVE)?;
        Ok(match (word, inner) {
            ("sqrt", inner) => Formula::Root(Root::Nested(Box::new(inner))),
            ("sin", inner) => Formula::Sine(Box::new(inner)),
            ("atan", Formula::Rational(tangent)) if !tangent.is_negative() && tangent < Rational::ONE => {
                Formula::Arctangent(tangent)
            }
            ("atan", other) => return Err(format!("the arc tangent of `{other}`, which is no fraction between 0 and 1")),
            (_, inner) => Formula::Cosine(Box::new(inner)),
        })
    }

    fn decimal(&mut self) -> Result<Formula, String> {
        let mut digits = self.digits();
        let mut scale = 0i32;
        if self.rest.starts_with('.') {
            self.rest = &self.rest[1..];
            let fraction = self.digits();
            scale -= fraction.len() as i32;
            digits += &fraction;
        }
        if self.rest.starts_with(['e', 'E']) {
            self.rest = &self.rest[1..];
            let negative = self.take('-');
            if !negative {
                self.take('+');
            }
            let exponent: i32 = self.digits().parse().ok().filter(|&e| e <= 400).ok_or("an exponent beyond every float")?;
            scale += if negative { -exponent } else { exponent };
        }
        self.charge_words(&[digits.len() as u64 / 19 + 1, u64::from(scale.unsigned_abs()) / 19 + 1])?;
        let size: UBig = digits.parse().map_err(|_| "digits expected".to_string())?;
        let power = UBig::from(10u8).pow(scale.unsigned_abs() as usize);
        let value = if scale < 0 { Rational::from_parts(IBig::from(size), power) } else { Rational::from(size * power) };
        debug_assert!(value == value.clone().abs());
        Ok(Formula::Rational(value))
    }
}

/// The exact value of a decimal literal.
pub fn decimal(text: &str) -> Result<Formula, String> {
    let mut parser = Parser { rest: text, depth: 0, definitions: &Definitions::default() };
    let value = parser.decimal()?;
    if parser.rest.is_empty() {
        Ok(value)
    } else {
        Err(format!("`{text}` is not a decimal number"))
    }
}
