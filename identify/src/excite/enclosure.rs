//! Intervals with derivatives by time: programs of `armgen-numbers` are executed over them.
//!
//! Every operation rounds outwards, so a result contains the values of the program in exact arithmetic. Constants are widened by
//! a unit in the last place, since a program has the nearest float to an exact number.

use std::ops::{Add, Mul, Neg, Sub};

use armgen_evaluate::{Angle, Arithmetic, Input, Operator};

use super::tape::sign;

/// From a to b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval(pub(super) f64, pub(super) f64);

const TAU: f64 = std::f64::consts::TAU;

impl Interval {
    /// x alone.
    pub(super) fn point(x: f64) -> Interval {
        Interval(x, x)
    }

    /// middle ± radius.
    pub(super) fn around(middle: f64, radius: f64) -> Interval {
        Interval((middle - radius).next_down(), (middle + radius).next_up())
    }

    /// The largest |x|.
    pub(super) fn size(self) -> f64 {
        self.0.abs().max(self.1.abs())
    }

    /// What both contain; `self` where rounding leaves nothing.
    pub(super) fn and(self, other: Interval) -> Interval {
        let both = Interval(self.0.max(other.0), self.1.min(other.1));
        if both.0 <= both.1 {
            both
        } else {
            self
        }
    }

    /// |x|.
    pub(super) fn abs(self) -> Interval {
        if self.0 >= 0.0 {
            self
        } else if self.1 <= 0.0 {
            -self
        } else {
            Interval(0.0, self.size())
        }
    }

    /// All signs.
    pub(super) fn sign(self) -> Interval {
        Interval(sign(self.0), sign(self.1))
    }

    /// e^x of numbers of at most 0.
    pub(super) fn exp(self) -> Interval {
        Interval((self.0.exp() * (1.0 - 1e-15)).max(0.0), self.1.exp() * (1.0 + 1e-15))
    }

    fn cosine(self) -> Interval {
        if !(self.0.is_finite() && self.1 - self.0 < TAU && self.size() < 1e6) {
            return Interval(-1.0, 1.0);
        }
        // Slightly wider than the angle, so that no extreme value is missed.
        let (low, high) = (self.0 - 1e-9, self.1 + 1e-9);
        let contains = |angle: f64| ((high - angle) / TAU).floor() > ((low - angle) / TAU).floor();
        let ends = [self.0.cos(), self.1.cos()];
        let low = if contains(TAU / 2.0) { -1.0 } else { ends[0].min(ends[1]) - 4e-16 };
        let high = if contains(0.0) { 1.0 } else { ends[0].max(ends[1]) + 4e-16 };
        Interval(low.max(-1.0), high.min(1.0))
    }

    fn sine(self) -> Interval {
        // Shifted by more than the rounding of the shift.
        let quarter = TAU / 4.0;
        Interval((self.0 - quarter).next_down(), (self.1 - quarter).next_up()).cosine()
    }
}

impl Add for Interval {
    type Output = Interval;
    fn add(self, other: Interval) -> Interval {
        Interval((self.0 + other.0).next_down(), (self.1 + other.1).next_up())
    }
}

impl Sub for Interval {
    type Output = Interval;
    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl Neg for Interval {
    type Output = Interval;
    fn neg(self) -> Interval {
        Interval(-self.1, -self.0)
    }
}

impl Mul for Interval {
    type Output = Interval;
    fn mul(self, other: Interval) -> Interval {
        let [a, b, c, d] = [self.0 * other.0, self.0 * other.1, self.1 * other.0, self.1 * other.1];
        Interval(a.min(b).min(c.min(d)).next_down(), a.max(b).max(c.max(d)).next_up())
    }
}

impl Mul<Interval> for f64 {
    type Output = Interval;
    fn mul(self, other: Interval) -> Interval {
        Interval::point(self) * other
    }
}

/// Values over a stretch of time, and their derivatives by time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving {
    pub(super) value: Interval,
    pub(super) slope: Interval,
}

/// The arguments of a program over a stretch of time, `arguments[argument][entry]`.
pub(super) struct Stretch<'a> {
    pub(super) arguments: [&'a [Moving]; 3],
}

impl Arithmetic<f64> for Stretch<'_> {
    type Value = Moving;

    fn input(&mut self, input: &Input<f64>) -> Moving {
        match *input {
            Input::Entry { argument, entry } => self.arguments[argument][entry],
            // Friction is no part of these programs.
            _ => Moving { value: Interval(f64::NEG_INFINITY, f64::INFINITY), slope: Interval(f64::NEG_INFINITY, f64::INFINITY) },
        }
    }

    fn sine_cosine(&mut self, angle: &Angle<f64>) -> (Moving, Moving) {
        let zero = Moving { value: Interval::point(0.0), slope: Interval::point(0.0) };
        let mut sum = angle.turn.map_or(zero, |turn| self.constant(turn));
        for (i, &(entry, minus)) in angle.terms.iter().enumerate() {
            let mut term = self.arguments[angle.argument][entry];
            if let Some(Some(factor)) = angle.factors.get(i) {
                let factor = self.constant(*factor);
                term = self.result(Operator::Multiply, &factor, &term);
            }
            let operator = if minus { Operator::Subtract } else { Operator::Add };
            sum = self.result(operator, &sum, &term);
        }
        let (sine, cosine) = (sum.value.sine(), sum.value.cosine());
        (Moving { value: sine, slope: cosine * sum.slope }, Moving { value: cosine, slope: -(sine * sum.slope) })
    }

    fn constant(&mut self, value: f64) -> Moving {
        let is_exact = value.fract() == 0.0 && value.abs() < 1e15;
        let value = if is_exact { Interval::point(value) } else { Interval(value.next_down(), value.next_up()) };
        Moving { value, slope: Interval::point(0.0) }
    }

    fn result(&mut self, operator: Operator, a: &Moving, b: &Moving) -> Moving {
        match operator {
            Operator::Add => Moving { value: a.value + b.value, slope: a.slope + b.slope },
            Operator::Subtract => Moving { value: a.value - b.value, slope: a.slope - b.slope },
            Operator::Multiply => Moving { value: a.value * b.value, slope: a.slope * b.value + a.value * b.slope },
            // Neither torques nor frames divide by more than constants.
            Operator::Divide if b.value.0 > 0.0 || b.value.1 < 0.0 => {
                let inverse = Interval((1.0 / b.value.1).next_down(), (1.0 / b.value.0).next_up());
                let value = a.value * inverse;
                Moving { value, slope: (a.slope - value * b.slope) * inverse }
            }
            _ => {
                let all = Interval(f64::NEG_INFINITY, f64::INFINITY);
                Moving { value: all, slope: all }
            }
        }
    }

    fn negated(&mut self, value: &Moving) -> Moving {
        Moving { value: -value.value, slope: -value.slope }
    }
}

#[cfg(test)]
mod tests {
    use super::Interval;

    #[test]
    fn intervals_of_sines_contain_the_sines_and_reach_their_extremes() {
        for k in 0..400 {
            let low = -7.0 + 0.035 * f64::from(k);
            for width in [0.0, 1e-3, 0.5, 2.0, 5.0, 7.0] {
                let angle = Interval(low, low + width);
                let (sine, cosine) = (angle.sine(), angle.cosine());
                for i in 0..=200 {
                    let x = low + width * f64::from(i) / 200.0;
                    assert!(sine.0 <= x.sin() && x.sin() <= sine.1, "sin {x} in {angle:?}");
                    assert!(cosine.0 <= x.cos() && x.cos() <= cosine.1, "cos {x} in {angle:?}");
                }
                let sampled = (0..=200).map(|i| (low + width * f64::from(i) / 200.0).cos());
                let highest = sampled.fold(-1.0, f64::max);
                assert!(cosine.1 - highest < 1e-2, "{angle:?}");
            }
        }
        assert_eq!(Interval(-2.0, 1.0) * Interval(-3.0, 5.0), Interval((-10.0f64).next_down(), 6.0f64.next_up()));
    }
}
