//! Expressions as formulas: plain text and LaTeX.
//!
//! Plain text is `+ - * / ^`, `sin`, `cos`, `sqrt`, `pi`, the names `q1 dq1 ddq1 dqr1 ddqr1 tau1 sign(dq1) abs(g1) sign(g1)` and parameter
//! names, with numbers as exact fractions: a formula that a computer-algebra system reads.

use std::collections::BTreeMap;
use std::rc::Rc;

use dashu_base::{Abs, Signed};

use super::field::computed::ComputedAngles;
use super::normal_form::{Harmonic, NormalForm, Powers};
use super::Symbol;
use crate::exact::{Atom, Number, Rational};

/// The notation of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    /// Plain text.
    Text,
    /// LaTeX, in mathematics mode.
    Latex,
}

/// Prints expressions in one notation, with the parameters' names.
#[derive(Clone, Copy, Debug)]
pub struct Printer<'a> {
    /// The notation.
    pub notation: Notation,
    /// Names of parameters, by index.
    pub parameters: &'a [String],
    /// Velocities of the joints' friction, of its elementary functions; 1 where it has no velocity.
    pub velocities: &'a [Number],
    /// Angles that functions compute; they are written out.
    pub computed: Option<&'a ComputedAngles>,
    /// Constants as decimals of so many digits, 1 to 17; none: exactly.
    pub digits: Option<u8>,
}

impl Printer<'_> {
    /// The name of a symbol.
    pub fn symbol(&self, symbol: Symbol) -> String {
        let text = self.notation == Notation::Text;
        let (word, latex, index) = match symbol {
            Symbol::Sine(i) | Symbol::Cosine(i) => {
                let name = if matches!(symbol, Symbol::Sine(_)) { "sin" } else { "cos" };
                return match (self.computed(i), text) {
                    (Some(angle), true) => format!("{name}({angle})"),
                    (Some(angle), false) => format!("\\{name}\\left({angle}\\right)"),
                    (None, true) => format!("{name}(q{})", i + 1),
                    (None, false) => format!("\\{name} q_{{{}}}", i + 1),
                };
            }
            Symbol::SineOf(sum) | Symbol::CosineOf(sum) => {
                let name = if matches!(symbol, Symbol::SineOf(_)) { "sin" } else { "cos" };
                let sign = |(k, minus): (usize, bool)| match (k, minus) {
                    (_, true) => "-",
                    (0, false) => "",
                    (_, false) => "+",
                };
                let terms = sum.terms().enumerate().map(|(k, (i, minus))| {
                    let angle = self.symbol(Symbol::Position(i));
                    format!("{}{angle}", sign((k, minus)))
                });
                let turn = match (sum.turned, text) {
                    (false, _) => "",
                    (true, true) => "+phi",
                    (true, false) => "+\\varphi",
                };
                let angle = terms.collect::<String>() + turn;
                return if text { format!("{name}({angle})") } else { format!("\\{name}({angle})") };
            }
            Symbol::OfRate(of, i) => {
                let [plain, latex] = of.printed(usize::from(i) + 1, &|| self.number(&self.velocities[usize::from(i)]));
                return if text { plain } else { latex };
            }
            Symbol::GravitySize(i) => {
                return if text { format!("abs(g{})", i + 1) } else { format!("|g_{{{}}}|", i + 1) };
            }
            Symbol::GravitySign(i) => {
                return if text { format!("sign(g{})", i + 1) } else { format!("\\operatorname{{sign}} g_{{{}}}", i + 1) };
            }
            Symbol::Gravity(i) => {
                let axis = ['x', 'y', 'z'][usize::from(i)];
                return if text { format!("g0{axis}") } else { format!("g_{{0{axis}}}") };
            }
            Symbol::Parameter(i) => {
                let name = &self.parameters[usize::from(i)];
                return if text { name.clone() } else { latex_name(name) };
            }
            Symbol::Position(i) => ("q", "q", i),
            Symbol::Rate(i) => ("dq", "\\dot q", i),
            Symbol::Acceleration(i) => ("ddq", "\\ddot q", i),
            Symbol::ReferenceRate(i) => ("dqr", "\\dot q_{r", i),
            Symbol::ReferenceAcceleration(i) => ("ddqr", "\\ddot q_{r", i),
            Symbol::Torque(i) => ("tau", "\\tau", i),
        };
        match (text, latex.contains('{')) {
            (true, _) => format!("{word}{}", index + 1),
            (false, true) => format!("{latex}{}}}", index + 1),
            (false, false) => format!("{latex}_{{{}}}", index + 1),
        }
    }

    /// The angle of an index: a joint variable, or a computed angle as the sum that it is.
    pub fn angle_of(&self, index: u16) -> String {
        self.computed(index).unwrap_or_else(|| self.symbol(Symbol::Position(index)))
    }

    /// A computed angle as the sum that it is.
    fn computed(&self, index: u16) -> Option<String> {
        let angle = self.computed?.get(index)?;
        let factors = angle.factors.iter().map(|(a, factor)| (*a, factor));
        Some(self.angle(factors, &angle.offset))
    }

    /// A sum of coordinates and a constant.
    fn angle<'n>(&self, factors: impl IntoIterator<Item = (u16, &'n Number)>, offset: &Number) -> String {
        let mut sum = Sum::default();
        for (a, factor) in factors {
            self.product(&mut sum, factor, [self.symbol(Symbol::Position(a))]);
        }
        self.constant(&mut sum, offset);
        if sum.text.is_empty() {
            "0".into()
        } else {
            sum.text
        }
    }

    /// The angle of a harmonic with computed angles in it, as one sum of coordinates that begins with a positive factor; and whether it is the
    /// opposite angle.
    fn whole(&self, harmonic: &Harmonic) -> Option<(String, bool)> {
        let computed = self.computed?;
        harmonic.angles.iter().any(|(index, _)| computed.get(*index).is_some()).then(|| {
            let (mut factors, mut offset): (BTreeMap<u16, Number>, Number) = (BTreeMap::new(), Number::zero());
            for &(index, k) in &harmonic.angles {
                let k = Number::from(i64::from(k));
                let mut add = |a: u16, factor: &Number| {
                    let sum = factors.entry(a).or_insert_with(Number::zero);
                    *sum = sum.plus(factor);
                };
                match computed.get(index) {
                    Some(angle) => {
                        angle.factors.iter().for_each(|(a, factor)| add(*a, &k.times(factor)));
                        offset = offset.plus(&k.times(&angle.offset));
                    }
                    None => add(index, &k),
                }
            }
            factors.retain(|_, factor| !factor.is_zero());
            let opposite = factors.values().next().unwrap_or(&offset).leads_negative();
            if opposite {
                factors.values_mut().for_each(|factor| *factor = -&*factor);
                offset = -&offset;
            }
            (self.angle(factors.iter().map(|(a, factor)| (*a, factor)), &offset), opposite)
        })
    }

    /// A formula.
    pub fn form(&self, form: &NormalForm) -> String {
        let mut sum = Sum::default();
        for (harmonic, group) in form.by_harmonic() {
            if let [(factors, coefficient)] = group[..] {
                self.term(&mut sum, coefficient, factors, Some(harmonic));
            } else if harmonic.angles.is_empty() {
                group.iter().for_each(|(factors, coefficient)| self.term(&mut sum, coefficient, factors, None));
            } else {
                let content = content(&group);
                let mut inner = Sum::default();
                for (factors, coefficient) in &group {
                    let rest = *coefficient * &Number::from(Rational::ONE / &content);
                    self.term(&mut inner, &rest, factors, None);
                }
                let inner = format!("({})", inner.text);
                let (wave, negative) = self.harmonic(harmonic);
                let content = Number::from(content);
                self.product(&mut sum, &if negative { -&content } else { content }, [inner, wave]);
            }
        }
        if sum.text.is_empty() {
            "0".into()
        } else {
            sum.text
        }
    }

    fn term(&self, sum: &mut Sum, coefficient: &Number, factors: &Powers, harmonic: Option<&Harmonic>) {
        let mut parts: Vec<String> = Vec::new();
        let mut negative = false;
        if let Some(harmonic) = harmonic.filter(|w| !w.angles.is_empty()) {
            let wave;
            (wave, negative) = self.harmonic(harmonic);
            parts.push(wave);
        }
        for &(symbol, power) in factors {
            let name = self.symbol(symbol);
            parts.push(if power == 1 { name } else { self.power(&name, power as i32) });
        }
        self.product(sum, &if negative { -coefficient } else { coefficient.clone() }, parts);
    }

    fn power(&self, base: &str, power: i32) -> String {
        match (self.notation, power < 0) {
            (Notation::Text, false) => format!("{base}^{power}"),
            (Notation::Text, true) => format!("{base}^({power})"),
            (Notation::Latex, _) if base.contains(['^', ' ']) => format!("{{\\left({base}\\right)}}^{{{power}}}"),
            (Notation::Latex, _) => format!("{{{base}}}^{{{power}}}"),
        }
    }

    fn product(&self, sum: &mut Sum, coefficient: &Number, parts: impl IntoIterator<Item = String>) {
        let mut parts: Vec<String> = parts.into_iter().collect();
        if parts.is_empty() {
            // A constant of several terms joins the sum term by term, each with its own sign.
            return self.constant(sum, coefficient);
        }
        let negative = match self.digits {
            Some(_) => coefficient.to_f64() < 0.0,
            None => coefficient.leads_negative(),
        };
        let size = if negative { -coefficient } else { coefficient.clone() };
        if !size.is_one() {
            let text = self.number(&size);
            parts.insert(0, if self.digits.is_none() && size.terms().count() > 1 { format!("({text})") } else { text });
        }
        sum.push(negative, &self.joined(parts));
    }

    /// Factors beside each other. Typeset, those that are functions without parentheses stand last: what followed `\sin q_{2}` would be
    /// taken for a part of the angle.
    fn joined(&self, mut factors: Vec<String>) -> String {
        match self.notation {
            Notation::Text => factors.join("*"),
            Notation::Latex => {
                factors.sort_by_key(|factor| ["\\sin", "\\cos", "\\operatorname"].iter().any(|name| factor.starts_with(name)));
                factors.join("\\,")
            }
        }
    }

    /// An exact constant.
    pub fn number(&self, number: &Number) -> String {
        let mut sum = Sum::default();
        self.constant(&mut sum, number);
        if sum.text.is_empty() {
            "0".into()
        } else {
            sum.text
        }
    }

    fn constant(&self, sum: &mut Sum, number: &Number) {
        if let Some(digits) = self.digits {
            let value = number.to_f64();
            if value != 0.0 {
                sum.push(value < 0.0, &self.decimal(value.abs(), digits));
            }
            return;
        }
        for (monomial, coefficient) in number.terms() {
            let size = coefficient.clone().abs();
            let mut parts: Vec<String> = Vec::new();
            if !size.is_one() || monomial.is_empty() {
                parts.push(match self.notation {
                    Notation::Text => size.to_string(),
                    Notation::Latex if size.is_int() => size.to_string(),
                    Notation::Latex => format!("\\frac{{{}}}{{{}}}", size.numerator(), size.denominator()),
                });
            }
            for (atom, power) in monomial {
                let name = self.atom(atom);
                parts.push(if *power == 1 { name } else { self.power(&name, *power) });
            }
            sum.push(coefficient.is_negative(), &parts.join(if self.notation == Notation::Text { "*" } else { "\\," }));
        }
    }

    /// A decimal of so many digits, without zeros at its end: an integer or a fraction from 1e-4 on, else with a power of ten.
    fn decimal(&self, value: f64, digits: u8) -> String {
        let digits = usize::from(digits.clamp(1, 17));
        let scientific = format!("{value:.*e}", digits - 1);
        let (mantissa, power) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        let exponent: i32 = power.parse().unwrap_or(0);
        let plain = |text: &str| match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text.to_owned(),
        };
        if (-4..digits.max(6) as i32).contains(&exponent) {
            let rounded: f64 = scientific.parse().unwrap_or(value);
            return plain(&format!("{rounded:.*}", (digits as i32 - 1 - exponent).max(0) as usize));
        }
        let mantissa = plain(mantissa);
        match self.notation {
            Notation::Text => format!("{mantissa}e{exponent}"),
            Notation::Latex if mantissa == "1" => format!("10^{{{exponent}}}"),
            Notation::Latex => format!("{mantissa} \\cdot 10^{{{exponent}}}"),
        }
    }

    fn atom(&self, atom: &Atom) -> String {
        let call = |name: &str, inside: String| match self.notation {
            Notation::Text => format!("{name}({inside})"),
            Notation::Latex if name == "sqrt" => format!("\\sqrt{{{inside}}}"),
            Notation::Latex => format!("\\{name}\\left({inside}\\right)"),
        };
        match atom {
            Atom::Root(n) => call("sqrt", n.to_string()),
            Atom::RootOf(n) => call("sqrt", self.number(n)),
            Atom::Pi => if self.notation == Notation::Text { "pi" } else { "\\pi" }.into(),
            Atom::Sine(angle) => call("sin", self.number(angle)),
            Atom::Cosine(angle) => call("cos", self.number(angle)),
            Atom::Arctangent(ratio) => call(if self.notation == Notation::Text { "atan" } else { "arctan" }, ratio.to_string()),
            Atom::Sum(sum) if sum.terms().is_readable() => format!("({})", self.number(sum.terms())),
            Atom::Sum(sum) => match self.notation {
                Notation::Text => format!("(≈{:?})", sum.terms().to_f64()),
                Notation::Latex => format!("\\left(\\approx {:?}\\right)", sum.terms().to_f64()),
            },
            Atom::Inverse(n) => match self.notation {
                Notation::Text => format!("(1/({}))", self.number(n)),
                Notation::Latex => format!("\\frac{{1}}{{{}}}", self.number(n)),
            },
        }
    }

    /// A harmonic, and whether it is to be negated.
    fn harmonic(&self, harmonic: &Harmonic) -> (String, bool) {
        let name = if harmonic.sine { "sin" } else { "cos" };
        if let Some((angle, opposite)) = self.whole(harmonic) {
            let text = match self.notation {
                Notation::Text => format!("{name}({angle})"),
                Notation::Latex => format!("\\{name}\\left({angle}\\right)"),
            };
            return (text, opposite && harmonic.sine);
        }
        let mut sum = Sum::default();
        for (index, k) in &harmonic.angles {
            let size = k.unsigned_abs();
            let name = match self.notation {
                Notation::Text => format!("q{}", index + 1),
                Notation::Latex => format!("q_{{{}}}", index + 1),
            };
            let text = match (size, self.notation) {
                (1, _) => name,
                (_, Notation::Text) => format!("{size}*{name}"),
                (_, Notation::Latex) => format!("{size} {name}"),
            };
            sum.push(*k < 0, &text);
        }
        let text = match self.notation {
            Notation::Text => format!("{name}({})", sum.text),
            Notation::Latex if harmonic.order() == 1 => format!("\\{name} {}", sum.text),
            Notation::Latex => format!("\\{name}\\left({}\\right)", sum.text),
        };
        (text, false)
    }

    /// A sum of products: of each a coefficient and its factors, printed already, with their powers; those below 0 are divided by.
    pub fn sum_of_products<'t>(&self, terms: impl IntoIterator<Item = (&'t Number, &'t [(Rc<str>, i32)])>) -> String {
        let mut sum = Sum::default();
        for (coefficient, factors) in terms {
            let part = |(name, power): &(Rc<str>, i32)| match power.unsigned_abs() {
                1 => name.to_string(),
                power => self.power(name, power as i32),
            };
            let (above, below): (Vec<_>, Vec<_>) = factors.iter().partition(|(_, power)| *power > 0);
            let mut parts: Vec<String> = above.into_iter().map(part).collect();
            let below: Vec<String> = below.into_iter().map(part).collect();
            if !below.is_empty() {
                let numerator = if parts.is_empty() { "1".into() } else { self.joined(parts) };
                parts = vec![match self.notation {
                    Notation::Text => format!("{numerator}/{}", below.join("/")),
                    Notation::Latex => format!("\\frac{{{numerator}}}{{{}}}", below.join("\\,")),
                }];
            }
            self.product(&mut sum, coefficient, parts);
        }
        if sum.text.is_empty() {
            "0".into()
        } else {
            sum.text
        }
    }
}

/// A sum in the making.
#[derive(Default)]
struct Sum {
    text: String,
}

impl Sum {
    fn push(&mut self, negative: bool, term: &str) {
        self.text += match (self.text.is_empty(), negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        self.text += term;
    }
}

/// The common rational factor of coefficients, with the sign of the first: 1 unless all are rational and share their size.
fn content(group: &[(&Powers, &Number)]) -> Rational {
    let first = group[0].1.as_rational().cloned();
    match first {
        Some(first) if group.iter().all(|(_, c)| c.as_rational().is_some_and(|r| r.clone().abs() == first.clone().abs())) => {
            first
        }
        Some(first) if group.iter().all(|(_, c)| c.leads_negative()) && first.is_negative() => Rational::from(-1),
        _ => Rational::ONE,
    }
}

/// `m_l1` as m_{l1}; `Ixx1` as I_{xx1}; other names upright.
fn latex_name(name: &str) -> String {
    let mut parts = name.splitn(2, '_');
    let head = parts.next().unwrap_or_default();
    let (head, tail) = match parts.next() {
        Some(tail) if !head.is_empty() && !tail.is_empty() => (head.to_string(), tail.replace('_', "\\_")),
        _ => {
            let plain = name.replace('_', "\\_");
            let digits =
                plain.find(|c: char| c.is_ascii_digit()).filter(|&at| at > 0 && plain[at..].chars().all(|c| c.is_ascii_digit()));
            match digits {
                Some(at) => (plain[..at].to_string(), plain[at..].to_string()),
                None => (plain, String::new()),
            }
        }
    };
    let head = if head.chars().count() > 1 { format!("\\mathit{{{head}}}") } else { head };
    if tail.is_empty() {
        head
    } else {
        format!("{head}_{{{tail}}}")
    }
}
