//! The law on a segment: x = ds², a quadratic of s, so that dds = a + b s is linear and its motion is closed.
//!
//! With the Bernstein coefficients X0, X1 = (X0 + X2)/2 + k, X2 on a segment of length h, and v = sqrt(x) at its ends:
//!
//! ```text
//! T = 2 h/(v0 + v1) A(z),   A(z) = atanh(sqrt z)/sqrt z = 1 + z/3 + z²/5 + ...,   z = -2 k/(v0 + v1)²
//! s(t) = v0 t S(b t²) + a t² E(b t²),   ds = v0 C(b t²) + a t S(b t²),   a = (X1 - X0)/h,   b = -2 k/h²
//! C, S, E = sum y^n/(2n)!, y^n/(2n+1)!, y^n/(2n+2)!
//! ```
//!
//! For z < 0, A is an arctangent; A is computed by A(z) = 2 A(w)/(1 + sqrt(1 - z)), w = z/(1 + sqrt(1 - z))², until its series is short.
//! So only + - * / and the root are used, and the bits are the same everywhere.

use crate::linalg::lit;
use nalgebra::RealField;

/// x on a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law<T> {
    /// Length in s.
    pub length: T,
    /// x at its start.
    pub x0: T,
    /// By how much the middle coefficient exceeds the mean of the ends.
    pub k: T,
    /// x at its end.
    pub x2: T,
}

impl<T: RealField + Copy> Law<T> {
    pub(super) fn middle(&self) -> T {
        (self.x0 + self.x2) * lit(0.5) + self.k
    }

    /// u = dds at both ends.
    pub(super) fn acceleration(&self) -> [T; 2] {
        let middle = self.middle();
        [(middle - self.x0) / self.length, (self.x2 - middle) / self.length]
    }

    /// x at the fraction `t` of the segment.
    pub(super) fn x(&self, t: T) -> T {
        let r = T::one() - t;
        self.x0 * r * r + self.middle() * lit::<T>(2.0) * r * t + self.x2 * t * t
    }

    /// Whether x is above zero inside, so that the duration is finite.
    pub(super) fn is_passed(&self) -> bool {
        let v = self.x0.max(T::zero()).sqrt() + self.x2.max(T::zero()).sqrt();
        if v == T::zero() {
            self.k > T::zero()
        } else {
            -lit::<T>(2.0) * self.k / (v * v) < T::one()
        }
    }

    /// How long the segment takes, s; infinite where x does not leave zero.
    pub(super) fn duration(&self) -> T {
        let two = lit::<T>(2.0);
        let v = self.x0.max(T::zero()).sqrt() + self.x2.max(T::zero()).sqrt();
        if v == T::zero() {
            if !(self.k > T::zero()) {
                return T::one() / T::zero();
            }
            return T::pi() * self.length / (two * self.k).sqrt();
        }
        let z = -two * self.k / (v * v);
        if !(z < T::one()) {
            return T::one() / T::zero();
        }
        two * self.length / v * inverse_tangent(z)
    }

    /// (s, ds, dds) a time `t` after the start.
    pub(super) fn at(&self, t: T) -> (T, T, T) {
        let v0 = self.x0.max(T::zero()).sqrt();
        let [a, _] = self.acceleration();
        let b = -lit::<T>(2.0) * self.k / (self.length * self.length);
        let [c, s, e] = series(b * t * t);
        let place = (v0 * t * s + a * t * t * e).max(T::zero()).min(self.length);
        let speed = (v0 * c + a * t * s).max(T::zero());
        (place, speed, a + b * place)
    }

    /// The law on the part from `from` to `to`, fractions of the segment (de Casteljau).
    pub(super) fn part(&self, from: T, to: T) -> Self {
        let width = to - from;
        Self { length: self.length * width, x0: self.x(from), k: self.k * width * width, x2: self.x(to) }
    }
}

/// A(z) = atanh(sqrt z)/sqrt z for z < 1.
fn inverse_tangent<T: RealField + Copy>(z: T) -> T {
    let (mut z, mut factor) = (z, T::one());
    for _ in 0..12 {
        if z.abs() <= lit(0.01) {
            break;
        }
        let d = T::one() + (T::one() - z).sqrt();
        z /= d * d;
        factor *= lit::<T>(2.0) / d;
    }
    // The tenth term of the series is below 1e-20 of the first.
    let mut sum = T::zero();
    for n in (0..10).rev() {
        sum = sum * z + lit::<T>(1.0 / f64::from(2 * n + 1));
    }
    factor * sum
}

/// C, S and E at y: cosh, sinh and (cosh - 1) of the root, divided so that they are entire.
fn series<T: RealField + Copy>(y: T) -> [T; 3] {
    // A fourth of y again and again, then doubled arguments: cosh 2r = 2 cosh² r - 1 = 1 + 2 sinh² r.
    let (mut y, mut halvings) = (y, 0);
    while y.abs() > T::one() && halvings < 64 {
        y *= lit(0.25);
        halvings += 1;
    }
    let [mut s, mut e] = [T::zero(); 2];
    for n in (0..10u32).rev() {
        s = T::one() + s * y * lit::<T>(1.0 / f64::from((2 * n + 2) * (2 * n + 3)));
        e = T::one() + e * y * lit::<T>(1.0 / f64::from((2 * n + 3) * (2 * n + 4)));
    }
    e *= lit(0.5);
    let mut c = T::one() + y * e;
    for _ in 0..halvings {
        // sinh 2r = 2 sinh r cosh r, so S(4 y) = S C, and E(4 y) = (cosh 2r - 1)/(4 r²) = S²/2.
        e = s * s * lit(0.5);
        s *= c;
        y *= lit(4.0);
        c = T::one() + y * e;
    }
    [c, s, e]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 4e-15 * b.abs().max(1.0), "{a}, expected {b}");
    }

    #[test]
    fn durations_are_the_closed_forms() {
        let h = 0.7;
        // Constant speed, constant acceleration from rest, and half a period of an oscillator.
        close(Law { length: h, x0: 4.0, k: 0.0, x2: 4.0 }.duration(), 0.35);
        close(Law { length: h, x0: 0.0, k: 0.0, x2: 1.4 }.duration(), 2.0 * h / f64::sqrt(1.4));
        close(Law { length: h, x0: 0.0, k: 0.5, x2: 0.0 }.duration(), std::f64::consts::PI * h);
        // dds = w² s from v0: s = v0/w sinh(w t); dds = -w² s: s = v0/w sin(w t).
        let (v0, w) = (0.3f64, 2.0f64);
        let grows = Law { length: h, x0: v0 * v0, k: -0.5 * (w * h).powi(2), x2: v0 * v0 + (w * h).powi(2) };
        close(grows.duration(), f64::asinh(w * h / v0) / w);
        let (v0, w) = (3.0f64, 2.0f64);
        let falls = Law { length: h, x0: v0 * v0, k: 0.5 * (w * h).powi(2), x2: v0 * v0 - (w * h).powi(2) };
        close(falls.duration(), f64::asin(w * h / v0) / w);
        assert_eq!(Law { length: h, x0: 0.0, k: 0.0, x2: 0.0 }.duration(), f64::INFINITY);
        assert_eq!(Law { length: h, x0: 1.0, k: -0.5, x2: 0.0 }.duration(), f64::INFINITY);
    }

    #[test]
    fn the_motion_ends_at_the_end_with_its_speed() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        for round in 0..2000 {
            let (x0, x2) = (if round % 5 == 0 { 0.0 } else { random() }, if round % 7 == 0 { 0.0 } else { random() });
            let lowest = -0.5 * (x0 + x2) - (x0 * x2).sqrt();
            let k = lowest * 0.98 * random() + if round % 2 == 0 { 3.0 * random() } else { 0.01 };
            let law = Law { length: 0.1 + random(), x0, k, x2 };
            let t = law.duration();
            if t > 20.0 {
                continue;
            }
            let (s, ds, dds) = law.at(t);
            assert!((s - law.length).abs() < 1e-9 * law.length * (1.0 + t), "{law:?}: {s}");
            assert!((ds - x2.sqrt()).abs() < 2e-7 * (1.0 + t), "{law:?}: {ds}");
            assert!((dds - law.acceleration()[1]).abs() < 1e-8 * (1.0 + t), "{law:?}");
            // In the middle of the time ds² = x(s), and two parts take as long as the whole.
            let (s, ds, _) = law.at(0.5 * t);
            assert!((ds * ds - law.x(s / law.length)).abs() < 1e-10, "{law:?}");
            let parts = law.part(0.0, 0.3).duration() + law.part(0.3, 1.0).duration();
            assert!((parts - t).abs() < 1e-9 * t, "{law:?}: {parts}, {t}");
        }
    }
}
