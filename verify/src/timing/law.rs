//! The law of a segment, and of a barrier: x = ds² as a quadratic, by the digits of the file.

use super::bernstein::Square;
use super::taylor::{Range, Taylor};

/// x = ds² on a segment: its ends, and by how much the middle Bernstein coefficient exceeds their mean.
#[derive(Clone, Copy)]
pub(super) struct Law {
    pub(super) x: [f64; 2],
    pub(super) k: f64,
}

impl Law {
    /// x over t from -1 to 1.
    pub(super) fn taylor(&self) -> Taylor {
        let [a, b] = self.x.map(Range::of);
        let (half, k) = (Range::of(0.5), Range::of(self.k));
        let mut x = Taylor::constant(a.plus(b).times(half).plus(k.times(half)));
        x.terms[1] = b.minus(a).times(half);
        x.terms[2] = k.times(half).negated();
        x
    }

    /// Whether no Bernstein coefficient is negative, so that x is not.
    pub(super) fn is_square(&self) -> bool {
        self.x.iter().all(|x| *x >= 0.0) && 0.5 * (self.x[0] + self.x[1]) + self.k >= 0.0
    }

    /// u = x'/2 over t, on a segment of length h.
    pub(super) fn acceleration(&self, h: Range) -> Option<Taylor> {
        let [a, b] = self.x.map(Range::of);
        let slope = Range::of(1.0).over(h)?;
        let mut u = Taylor::constant(b.minus(a).times(Range::of(0.5)).times(slope));
        u.terms[1] = Range::of(self.k).negated().times(slope);
        Some(u)
    }

    pub(super) fn square(&self) -> Square {
        let [a, b] = self.x.map(Range::of);
        let middle = a.plus(b).times(Range::of(0.5)).plus(Range::of(self.k));
        Square([a, middle, b])
    }

    /// How long the segment takes, s: 2 h/(v_0 + v_2) A(z), z = -2 k/(v_0 + v_2)².
    pub(super) fn duration(&self, h: Range) -> Option<Range> {
        let two = Range::of(2.0);
        let v = Range::of(self.x[0]).root()?.plus(Range::of(self.x[1]).root()?);
        if v.high == 0.0 {
            return Range::PI.times(h).over(Range::of(self.k).times(two).root()?);
        }
        let z = Range::of(-self.k).times(two).over(v.times(v))?;
        // A(z) = atanh(sqrt z)/sqrt z grows with z, and so does each step towards its series.
        let [low, high] = [z.low, z.high].map(|z| inverse_tangent(Range::of(z)));
        let factor = Range { low: low?.low, high: high?.high };
        two.times(h).over(v).map(|t| t.times(factor))
    }
}

/// A(z) = 1 + z/3 + z²/5 + ..., by A(z) = 2 A(w)/(1 + sqrt(1 - z)), w = z/(1 + sqrt(1 - z))².
fn inverse_tangent(mut z: Range) -> Option<Range> {
    let (one, two, mut factor) = (Range::of(1.0), Range::of(2.0), Range::of(1.0));
    for _ in 0..12 {
        if z.size() <= 0.01 {
            break;
        }
        let d = one.plus(one.minus(z).root()?);
        z = z.over(d.times(d))?;
        factor = factor.times(two).over(d)?;
    }
    if z.size() > 0.01 {
        return None;
    }
    // What follows the tenth term is below 1e-20.
    let mut sum = Range { low: -1e-20, high: 1e-20 };
    for n in (0..10).rev() {
        sum = sum.times(z).plus(one.over(Range::of(f64::from(2 * n + 1)))?);
    }
    Some(factor.times(sum))
}
