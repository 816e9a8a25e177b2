//! Intervals of floats rounded outwards, and Taylor models over them: a polynomial in t from -1 to 1, and an interval for what it misses.

use crate::values::arithmetic::Arithmetic;
use crate::values::element::Element;
use crate::values::enclosure::{enclose, sine_cosine_of};
use crate::values::formula::{Formula, Rational};

/// The degree of the polynomials.
pub(super) const ORDER: usize = 8;
pub(super) const TERMS: usize = ORDER + 1;

/// From `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Range {
    pub(super) const ZERO: Range = Range { low: 0.0, high: 0.0 };
    pub(super) const ALL: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    /// pi lies between two neighbouring floats.
    pub(super) const PI: Range = Range { low: std::f64::consts::PI, high: f64::from_bits(std::f64::consts::PI.to_bits() + 1) };

    /// A float itself.
    pub(super) const fn of(x: f64) -> Range {
        Range { low: x, high: x }
    }

    fn is_zero(self) -> bool {
        self == Range::ZERO
    }

    fn outwards(low: f64, high: f64) -> Range {
        // A product of infinities with zero tells nothing.
        if low.is_nan() || high.is_nan() {
            return Range::ALL;
        }
        Range { low: low.next_down(), high: high.next_up() }
    }

    pub(super) fn plus(self, other: Range) -> Range {
        match (self.is_zero(), other.is_zero()) {
            (true, _) => other,
            (_, true) => self,
            _ => Range::outwards(self.low + other.low, self.high + other.high),
        }
    }

    pub(super) fn negated(self) -> Range {
        Range { low: -self.high, high: -self.low }
    }

    pub(super) fn minus(self, other: Range) -> Range {
        self.plus(other.negated())
    }

    pub(super) fn times(self, other: Range) -> Range {
        if self.is_zero() || other.is_zero() {
            return Range::ZERO;
        }
        let all = [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        if all.iter().any(|x| x.is_nan()) {
            return Range::ALL;
        }
        Range::outwards(all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    }

    /// `None` for a divisor that may be zero.
    pub(super) fn over(self, other: Range) -> Option<Range> {
        if other.low <= 0.0 && other.high >= 0.0 {
            return None;
        }
        let all = [self.low / other.low, self.low / other.high, self.high / other.low, self.high / other.high];
        if all.iter().any(|x| x.is_nan()) {
            return Some(Range::ALL);
        }
        Some(Range::outwards(
            all.iter().copied().fold(f64::INFINITY, f64::min),
            all.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ))
    }

    /// The root; `None` where a number may be negative.
    pub(super) fn root(self) -> Option<Range> {
        if self.low < 0.0 || self.low.is_nan() {
            return None;
        }
        let down = if self.low == 0.0 { 0.0 } else { self.low.sqrt().next_down() };
        let up = if self.high == 0.0 { 0.0 } else { self.high.sqrt().next_up() };
        Some(Range { low: down, high: up })
    }

    /// The largest magnitude.
    pub(super) fn size(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// From -size to size.
    pub(super) fn both(size: f64) -> Range {
        Range { low: -size, high: size }
    }

    /// 1, 0 or -1 of the middle.
    pub(super) fn sign(self) -> f64 {
        let middle = 0.5 * (self.low + self.high);
        if middle > 0.0 {
            1.0
        } else if middle < 0.0 {
            -1.0
        } else {
            0.0
        }
    }
}

/// sum of terms\[k\] t^k, and `rest`, for t from -1 to 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Taylor {
    pub(super) terms: [Range; TERMS],
    pub(super) rest: Range,
}

impl Taylor {
    pub(super) fn constant(value: Range) -> Taylor {
        let mut terms = [Range::ZERO; TERMS];
        terms[0] = value;
        Taylor { terms, rest: Range::ZERO }
    }

    /// Terms that may differ from zero.
    fn length(&self) -> usize {
        self.terms.iter().rposition(|term| !term.is_zero()).map_or(0, |last| last + 1)
    }

    fn is_constant(&self) -> bool {
        self.length() <= 1 && self.rest.is_zero()
    }

    /// All values.
    pub(super) fn range(&self) -> Range {
        let [first, others @ ..] = &self.terms;
        let spread = match self.length() {
            0 | 1 => 0.0,
            _ => others.iter().fold(0.0f64, |sum, term| (sum + term.size()).next_up()),
        };
        first.plus(Range::both(spread)).plus(self.rest)
    }

    /// Values at t.
    pub(super) fn at(&self, t: f64) -> Range {
        let t = Range::of(t);
        self.terms.iter().rev().fold(Range::ZERO, |sum, term| sum.times(t).plus(*term)).plus(self.rest)
    }

    /// |f|, exactly where the sign is known.
    pub(super) fn magnitude(&self) -> Taylor {
        let range = self.range();
        if range.low >= 0.0 {
            self.clone()
        } else if range.high <= 0.0 {
            self.negated()
        } else {
            Taylor { rest: Range { low: 0.0, high: range.size() }, ..Taylor::constant(Range::ZERO) }
        }
    }

    /// Sine and cosine; `None` of an angle beyond 2^60.
    pub(super) fn sine_cosine(&self) -> Option<(Taylor, Taylor)> {
        let middle = 0.5 * (self.terms[0].low + self.terms[0].high);
        if middle.abs() >= 1e15 || middle.is_nan() {
            return None;
        }
        let (sine, cosine, bits) = sine_cosine_of(&Rational::try_from(middle).ok()?, 64)?;
        let range = |n: dashu_int::IBig| {
            let value = Rational::from_parts(n, dashu_int::UBig::ONE << bits).to_f64().value();
            // Two units of 2^-64, and the rounding to a float.
            Range { low: (value - 1e-18).next_down(), high: (value + 1e-18).next_up() }
        };
        let (s, c) = (range(sine), range(cosine));
        let mut by = self.clone();
        by.terms[0] = by.terms[0].minus(Range::of(middle));
        let size = by.range().size();
        let square = by.times(&by);
        // sin = by (1 - by²/6 (1 - by²/20 ...)), cos = 1 - by²/2 (1 - by²/12 ...); what follows is below its first term.
        let series = |first: u32| {
            let mut sum = Taylor::constant(Range::of(1.0));
            for k in (0..6u32).rev() {
                let n = f64::from((2 * k + first) * (2 * k + first + 1));
                let factor = Range::of(-1.0).over(Range::of(n))?;
                sum = sum.times(&square).times(&Taylor::constant(factor)).plus(&Taylor::constant(Range::of(1.0)));
            }
            Some(sum)
        };
        let rest = |power: i32, factorial: f64| Range::both((size.powi(power) / factorial * 1.01).next_up());
        let (mut cos, mut sin) = (series(1)?, by.times(&series(2)?));
        cos.rest = cos.rest.plus(rest(14, 87_178_291_200.0));
        sin.rest = sin.rest.plus(rest(15, 1_307_674_368_000.0));
        let (s, c) = (Taylor::constant(s), Taylor::constant(c));
        Some((s.times(&cos).plus(&c.times(&sin)), c.times(&cos).minus(&s.times(&sin))))
    }
}

impl Element for Taylor {
    fn plus(&self, other: &Self) -> Self {
        Taylor { terms: std::array::from_fn(|k| self.terms[k].plus(other.terms[k])), rest: self.rest.plus(other.rest) }
    }

    fn minus(&self, other: &Self) -> Self {
        Taylor { terms: std::array::from_fn(|k| self.terms[k].minus(other.terms[k])), rest: self.rest.minus(other.rest) }
    }

    fn times(&self, other: &Self) -> Self {
        let mut product = Taylor::constant(Range::ZERO);
        let (a, b) = (self.length(), other.length());
        for i in 0..a {
            for j in 0..b {
                let term = self.terms[i].times(other.terms[j]);
                if i + j < TERMS {
                    product.terms[i + j] = product.terms[i + j].plus(term);
                } else {
                    product.rest = product.rest.plus(Range::both(term.size()));
                }
            }
        }
        if !self.rest.is_zero() {
            product.rest = product.rest.plus(self.rest.times(other.range()));
        }
        if !other.rest.is_zero() {
            // The rest of this one is counted above, with all of the other.
            let polynomial = Taylor { rest: Range::ZERO, ..self.clone() };
            product.rest = product.rest.plus(other.rest.times(polynomial.range()));
        }
        product
    }

    fn negated(&self) -> Self {
        Taylor { terms: self.terms.map(Range::negated), rest: self.rest.negated() }
    }

    /// The equations divide by constants alone.
    fn inverse(&self) -> Option<Self> {
        if !self.is_constant() {
            return None;
        }
        Range::of(1.0).over(self.terms[0]).map(Taylor::constant)
    }

    fn is_zero(&self) -> bool {
        self.length() == 0 && self.rest.is_zero()
    }

    fn sign(&self) -> Self {
        Taylor::constant(Range::of(self.range().sign()))
    }
}

/// The constants of an arm.
pub(super) struct Constants;

impl Arithmetic for Constants {
    type Element = Taylor;

    fn integer(&self, value: i64) -> Taylor {
        Taylor::constant(Range::of(value as f64))
    }

    fn constant(&self, formula: &Formula) -> Option<Taylor> {
        let (low, high) = enclose(formula, 80)?;
        let [low, high] = [low, high].map(|x| (Rational::try_from(x.to_f64().value()).is_ok_and(|y| y == x), x.to_f64().value()));
        let down = if low.0 { low.1 } else { low.1.next_down() };
        let up = if high.0 { high.1 } else { high.1.next_up() };
        Some(Taylor::constant(Range { low: down, high: up }))
    }

    /// Nothing is random here.
    fn draw(&mut self) -> Taylor {
        self.integer(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_hold_their_functions() {
        let mut q = Taylor::constant(Range::of(0.7));
        (q.terms[1], q.terms[3]) = (Range::of(0.2), Range::of(-0.05));
        let (s, c) = q.sine_cosine().expect("an angle");
        let circle = s.times(&s).plus(&c.times(&c));
        for k in 0..=20 {
            let t = f64::from(k) / 10.0 - 1.0;
            let angle = 0.7 + 0.2 * t - 0.05 * t * t * t;
            // Of q³/6 the power t⁹ is missed, 0.05³/6 = 2.1e-5 on both sides.
            // The squares multiply that by up to four, and drop the products of the powers three and six, 6e-5 each.
            for (model, value, width) in [(&s, angle.sin(), 1e-4), (&c, angle.cos(), 1e-4), (&circle, 1.0, 1e-3)] {
                let range = model.at(t);
                assert!(range.low <= value + 2e-16 && range.high >= value - 2e-16, "{t}: {range:?} {value}");
                assert!(range.high - range.low < width, "{range:?}");
            }
        }
        let small = Taylor {
            terms: std::array::from_fn(|k| Range::of([1.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0][k])),
            rest: Range::ZERO,
        };
        let (s, _) = small.sine_cosine().expect("an angle");
        assert!(s.rest.size() < 1e-20, "{:?}", s.rest);
    }

    #[test]
    fn ranges_are_rounded_outwards() {
        let third = Range::of(1.0).over(Range::of(3.0)).expect("not zero");
        let one = third.times(Range::of(3.0));
        assert!(one.low < 1.0 && one.high > 1.0 && third.low < third.high);
        assert!(Range::of(1.0).over(Range { low: -1.0, high: 1.0 }).is_none() && Range::of(-1.0).root().is_none());
        assert!(Range::PI.low.next_up() == Range::PI.high);
    }
}
