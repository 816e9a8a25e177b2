//! Friction that is no line over the root of x, in intervals: cubic y^(3/2) + stribeck exp(-sqrt(y)/velocity) over y = dq².

use super::taylor::Range;

/// The factors, each for one direction of the joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    pub(super) cubic: Range,
    pub(super) stribeck: Range,
    /// Above 0 unless `stribeck` is 0.
    pub(super) velocity: Range,
}

/// exp(-t) for t >= 0: the series of a part of t, and squares.
fn decay(t: f64) -> Range {
    if t > 600.0 {
        return Range { low: 0.0, high: 1e-260 };
    }
    let (mut part, mut halvings) = (t, 0);
    while part > 0.25 {
        part *= 0.5;
        halvings += 1;
    }
    let t = Range::of(part);
    // What follows is below 0.25^15/15!.
    let mut sum = Range { low: 1.0 - 1e-9, high: 1.0 + 1e-9 };
    for n in (1..15u32).rev() {
        let step = t.over(Range::of(f64::from(n))).unwrap_or(Range::ALL);
        sum = Range::of(1.0).minus(step.times(sum));
    }
    for _ in 0..halvings {
        sum = sum.times(sum);
    }
    sum
}

impl Curve {
    pub(super) fn negated(&self) -> Curve {
        Curve { cubic: self.cubic.negated(), stribeck: self.stribeck.negated(), ..*self }
    }

    pub(super) fn times(&self, by: Range) -> Curve {
        Curve { cubic: self.cubic.times(by), stribeck: self.stribeck.times(by), ..*self }
    }

    /// From below the same over x where y = rate² x, and what takes the place of Stribeck friction where the joint may rest.
    pub(super) fn over_square(&self, rate: Range) -> (Curve, Range) {
        let size = if rate.low >= 0.0 { rate } else { rate.negated() };
        let size = if size.low >= 0.0 { size } else { Range { low: 0.0, high: rate.size() } };
        let cubic = self.cubic.times(size).times(size).times(size);
        match self.velocity.over(size) {
            Some(velocity) => (Curve { cubic, velocity, ..*self }, Range::ZERO),
            None => match self.velocity.over(Range::of(size.high)).filter(|_| self.stribeck.low >= 0.0) {
                Some(velocity) => (Curve { cubic, velocity, ..*self }, Range::ZERO),
                None => (Curve { cubic, stribeck: Range::ZERO, velocity: Range::of(1.0) }, self.stribeck),
            },
        }
    }

    /// The parts at y >= 0, and their derivatives by y.
    fn parts(&self, y: f64) -> Option<[(Range, Range); 2]> {
        let root = Range::of(y).root()?;
        let cubic = (self.cubic.times(Range::of(y)).times(root), self.cubic.times(root).times(Range::of(1.5)));
        if self.stribeck == Range::ZERO {
            return Some([cubic, (Range::ZERO, Range::ZERO)]);
        }
        let t = root.over(self.velocity)?;
        let value = self.stribeck.times(Range { low: decay(t.high.max(0.0)).low, high: decay(t.low.max(0.0)).high });
        let slope = value.negated().over(self.velocity.times(root).times(Range::of(2.0)));
        Some([cubic, (value, slope.unwrap_or(Range::ALL))])
    }

    pub(super) fn value(&self, y: f64) -> Range {
        self.parts(y).map_or(Range::ALL, |[(cubic, _), (stribeck, _)]| cubic.plus(stribeck))
    }

    /// Slope and height of a line that is nowhere below the curve for y from `low` to `high`. A tangent touches at `touch`, within them.
    pub(super) fn line(&self, low: f64, high: f64, touch: f64) -> Option<[Range; 2]> {
        // A factor that may have either sign is at most its upper end.
        let positive = |x: Range| if x.low < 0.0 && x.high > 0.0 { Range::of(x.high) } else { x };
        let this = Curve { cubic: positive(self.cubic), stribeck: positive(self.stribeck), ..*self };
        let (at, ends) = (this.parts(touch)?, [this.parts(low)?, this.parts(high)?]);
        let (mut slope, mut height) = (Range::ZERO, Range::ZERO);
        for part in 0..2 {
            let factor = [this.cubic, this.stribeck][part];
            if factor == Range::ZERO {
                continue;
            }
            let [first, last] = [ends[0][part].0, ends[1][part].0];
            if factor.low >= 0.0 {
                // Convex: whatever the slope, the largest distance is at an end.
                let steep = (last.high - first.high) / (high - low);
                let steep = Range::of(if steep.is_finite() { steep } else { 0.0 });
                let over = |value: Range, y: f64| value.minus(steep.times(Range::of(y))).high;
                height = height.plus(Range::of(over(first, low).max(over(last, high))));
                slope = slope.plus(steep);
            } else {
                // Concave: below each of its tangents.
                let (value, tangent) = at[part];
                let steep = Range::of(0.5 * (tangent.low + tangent.high));
                let spread = tangent.minus(steep).times(Range { low: low - touch, high: high - touch });
                height = height.plus(value.minus(steep.times(Range::of(touch))).plus(spread));
                slope = slope.plus(steep);
            }
        }
        let is_finite = [slope.low, slope.high, height.high].iter().all(|x| x.is_finite());
        is_finite.then_some([slope, Range::of(height.high)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decay_holds_the_exponential() {
        for i in 0..6000 {
            let t = f64::from(i) * 0.11;
            let range = decay(t);
            let value = (-t).exp();
            assert!(range.low <= value * (1.0 + 1e-15) && range.high >= value * (1.0 - 1e-15), "{t}: {range:?}");
            assert!(t > 600.0 || range.high - range.low < 1e-11 * value, "{t}: {range:?}");
        }
    }

    /// Over x the curve is at most what it is over y for every rate of a range, and the same for a rate that is known.
    #[test]
    fn a_curve_over_x_is_below() {
        for [cubic, stribeck] in [[2.0, 0.0], [-2.0, 0.0], [0.0, 3.0], [0.0, -3.0], [-1.0, 2.0], [1.0, -2.0]] {
            let curve = Curve { cubic: Range::of(cubic), stribeck: Range::of(stribeck), velocity: Range::of(0.1) };
            for [low, high] in [[0.5, 0.5], [-0.5, -0.5], [0.2, 0.5], [-0.5, -0.2], [-0.1, 0.3], [-0.3, 0.1], [0.0, 0.4]] {
                let (over, rest) = curve.over_square(Range { low, high });
                for i in 0..=100 {
                    let (rate, x) = (low + (high - low) * f64::from(i % 10) / 9.0, 0.05 + 0.3 * f64::from(i / 10));
                    let speed = rate.abs() * x.sqrt();
                    let off = cubic * speed.powi(3) + stribeck * (-speed / 0.1).exp() - over.value(x).plus(rest).low;
                    assert!(off > -1e-14 && (low < high || off < 1e-10), "{curve:?} {low} {high} at {rate} {x}: {off:e}");
                }
            }
        }
    }

    #[test]
    fn lines_are_above_the_curve() {
        for [cubic, stribeck] in [[2.0, 0.0], [-2.0, 0.0], [0.0, 3.0], [0.0, -3.0], [-1.0, 2.0], [1.0, -2.0]] {
            let curve = Curve { cubic: Range::of(cubic), stribeck: Range::of(stribeck), velocity: Range::of(0.1) };
            for [low, high] in [[0.0, 1e-3], [0.01, 0.02], [1.0, 4.0], [2.0, 2.0]] {
                let [slope, height] = curve.line(low, high, 0.5 * (low + high)).expect("a line");
                let mut nearest = f64::INFINITY;
                for i in 0..=100 {
                    let y = low + (high - low) * f64::from(i) / 100.0;
                    let off = slope.low * y + height.low - cubic * y * y.sqrt() - stribeck * (-y.sqrt() / 0.1).exp();
                    assert!(off > -1e-14, "{curve:?} at {y}: {off:e}");
                    nearest = nearest.min(off);
                }
                assert!(nearest < 0.05, "{curve:?}: {nearest}");
            }
        }
    }
}
