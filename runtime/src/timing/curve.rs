//! Friction that is no line over the root of x: chords and tangents over y = dq² = q'² x.
//!
//! Cubic friction is F_3 y^(3/2), Stribeck friction F_s exp(-sqrt(y)/v_s). For positive factors both are convex in y: a chord bounds them
//! from above on its interval, a tangent from below. A line in y is c x + d with q'² as a part of c, which is a quadratic of the segment.

use crate::linalg::lit;
use nalgebra::RealField;

/// cubic y^(3/2) + stribeck exp(-sqrt(y)/velocity), with the sign of the joint's rate and of the row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve<T> {
    pub cubic: T,
    pub stribeck: T,
    pub velocity: T,
    /// q'² on the segment, in Bernstein form, and what that misses.
    pub square: [T; 3],
    pub error: T,
}

/// A line over sqrt(x), or over dq² for a curve: slope x + height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<T> {
    pub slope: T,
    pub height: T,
}

impl<T: RealField + Copy> Line<T> {
    /// The tangent at w² from above, w > 0: sqrt(x) <= (x/w + w)/2 for all x >= 0.
    pub(super) fn tangent(w: T) -> Self {
        let half = lit::<T>(0.5);
        Self { slope: half / w, height: half * w }
    }

    /// The chord on [a, b]: sqrt(x) >= (x + sqrt(a b))/(sqrt a + sqrt b) for x in [a, b].
    pub(super) fn chord(a: T, b: T) -> Self {
        let (a, b) = (a.max(T::zero()).sqrt(), b.max(T::zero()).sqrt());
        let sum = a + b;
        if sum > T::zero() {
            Self { slope: T::one() / sum, height: a * b / sum }
        } else {
            Self { slope: T::zero(), height: T::zero() }
        }
    }
}

/// exp(-t) and (1 - exp(-t))/t for t >= 0, by the series of a small t and doubled arguments.
fn decay<T: RealField + Copy>(t: T) -> (T, T) {
    let (one, half) = (T::one(), lit::<T>(0.5));
    let (mut t, mut halvings) = (t.max(T::zero()).min(lit(200.0)), 0);
    while t > lit(0.25) && halvings < 16 {
        t *= half;
        halvings += 1;
    }
    let mut mean = one;
    for n in (2..15u32).rev() {
        mean = one - mean * t * lit::<T>(1.0 / f64::from(n));
    }
    let mut value = one - t * mean;
    for _ in 0..halvings {
        mean *= (one + value) * half;
        value *= value;
    }
    (value, mean)
}

impl<T: RealField + Copy> Curve<T> {
    /// The same at an end of the segment alone.
    pub(super) fn at(&self, end: usize) -> Self {
        let [start, _, last] = self.square;
        Self { square: [if end == 0 { start } else { last }; 3], error: T::zero(), ..*self }
    }

    /// Its value where q'² and x are known.
    pub(super) fn value(&self, square: T, x: T) -> T {
        let rate = (square * x).max(T::zero()).sqrt();
        let mut value = self.cubic * rate * rate * rate;
        if self.stribeck != T::zero() {
            value += self.stribeck * decay(rate / self.velocity).0;
        }
        value
    }

    /// A line over y that bounds the curve for x between two values: from above, or from below. A tangent touches at `touch`.
    /// And what its numbers may be off by rounding.
    pub(super) fn line(&self, [least, most]: [T; 2], touch: T, above: bool) -> (Line<T>, T) {
        let zero = T::zero();
        let [q0, q1, q2] = self.square;
        let eps = T::default_epsilon() * lit(8.0);
        let low = (q0.min(q1).min(q2) - self.error).max(zero) * least * (T::one() - eps);
        let high = (q0.max(q1).max(q2) + self.error).max(zero) * most * (T::one() + eps);
        let middle = (q0 + q1 + q1 + q2) * lit(0.25) * touch;
        let [a, b, w] = [low, high, middle].map(|y| y.max(zero).sqrt());
        let (mut slope, mut height) = (zero, zero);
        if self.cubic != zero && b > zero {
            if (self.cubic > zero) == above {
                let (sum, product) = (a + b, a * b);
                slope += self.cubic * ((a * a + product + b * b) / sum);
                height -= self.cubic * (product / sum * product);
            } else {
                slope += self.cubic * w * lit(1.5);
                height -= self.cubic * w * w * w * lit(0.5);
            }
        }
        if self.stribeck != zero {
            let per = T::one() / self.velocity;
            // Close to rest a line over more than the interval is as good.
            let tiny: T = lit(1e-6);
            if (self.stribeck > zero) == above {
                let (a, b) = (a * per, (b * per).max(tiny));
                let ((value, _), (_, mean)) = (decay(a), decay(b - a));
                let of = value * mean / (a + b);
                slope -= self.stribeck * of * per * per;
                height += self.stribeck * (value + of * a * a);
            } else {
                let w = (w * per).max(tiny);
                let (value, _) = decay(w);
                slope -= self.stribeck * (value / (w + w)) * per * per;
                height += self.stribeck * value * (T::one() + w * lit(0.5));
            }
        }
        (Line { slope, height }, eps * lit(8.0) * (self.stribeck.abs() + self.cubic.abs() * b * b * b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decay_is_the_exponential() {
        for i in 0..2000 {
            let t = f64::from(i) * 0.013 + 1e-9;
            let (value, mean) = decay(t);
            assert!((value - (-t).exp()).abs() < 1e-15 && (mean + (-t).exp_m1() / t).abs() < 1e-15, "{t}");
            let (value, mean) = decay(t as f32);
            assert!((f64::from(value) - (-t).exp()).abs() < 1e-6 && (f64::from(mean) + (-t).exp_m1() / t).abs() < 1e-6, "{t}");
        }
        assert!(decay(1e30f64).0 < 1e-80 && decay(0.0f64) == (1.0, 1.0));
    }

    /// Lines keep their side of the curve wherever q' and x are, for factors of both signs, and chords and tangents touch.
    #[test]
    fn lines_lie_on_their_sides_of_the_curve() {
        for (cubic, stribeck) in [(2.0, 0.0), (-2.0, 0.0), (0.0, 3.0), (0.0, -3.0), (0.5, 1.0), (-0.5, -1.0)] {
            for (from, to) in [(0.0, 0.4), (0.3, 0.5), (1.0, 1.0 + 1e-9), (0.0, 1e-9)] {
                let square = [from * from, from * to, to * to];
                let curve = Curve { cubic, stribeck, velocity: 0.1, square, error: 0.0 };
                for x in [[0.0, 2.0], [1.5, 2.0], [2.0, 2.0]] {
                    for above in [true, false] {
                        let (line, slack) = curve.line(x, 0.5 * (x[0] + x[1]), above);
                        let mut nearest = f64::INFINITY;
                        for i in 0..=400 {
                            let q = from + (to - from) * f64::from(i % 21) / 20.0;
                            let at = x[0] + (x[1] - x[0]) * f64::from(i / 21) / 19.0;
                            let off = line.slope * q * q * at + line.height - curve.value(q * q, at);
                            let off = if above { off } else { -off };
                            assert!(off >= -slack, "{curve:?} {x:?} {above}: {off:e}");
                            nearest = nearest.min(off);
                        }
                        assert!(nearest < 0.02 * (cubic.abs() + stribeck.abs()), "{curve:?} {x:?} {above}: {nearest}");
                    }
                }
            }
        }
    }
}
