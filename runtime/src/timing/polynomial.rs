//! Polynomials of one variable of degree at most 5, powers lowest first.

use crate::linalg::lit;
use nalgebra::RealField;

/// How many coefficients a polynomial has.
pub(super) const ORDER: usize = 6;

pub(super) type Polynomial<T> = [T; ORDER];

/// The value at `t`.
pub(super) fn value<T: RealField + Copy>(p: &Polynomial<T>, t: T) -> T {
    p.iter().rev().fold(T::zero(), |sum, c| sum * t + *c)
}

pub(super) fn derivative<T: RealField + Copy>(p: &Polynomial<T>) -> Polynomial<T> {
    let mut of = [T::zero(); ORDER];
    for (k, (to, from)) in of.iter_mut().zip(p.iter().skip(1)).enumerate() {
        *to = *from * lit((k + 1) as f64);
    }
    of
}

/// The polynomial p(t + shift).
pub(super) fn shifted<T: RealField + Copy>(p: &Polynomial<T>, shift: T) -> Polynomial<T> {
    let mut of = *p;
    // Synthetic division, once a power.
    for low in 0..ORDER {
        for k in (low..ORDER - 1).rev() {
            of[k] += of[k + 1] * shift;
        }
    }
    of
}

/// A bound of |p| on [0, length]: its largest Bernstein coefficient.
pub(super) fn largest<T: RealField + Copy>(p: &Polynomial<T>, length: T) -> T {
    bernstein(p, length).iter().fold(T::zero(), |most, c| most.max(c.abs()))
}

/// The Bernstein coefficients of p on [0, length]: b_i = sum_{k <= i} C(i, k)/C(5, k) p_k length^k (Farouki 2012).
pub(super) fn bernstein<T: RealField + Copy>(p: &Polynomial<T>, length: T) -> Polynomial<T> {
    /// C(i, k)/C(5, k).
    const WEIGHTS: [[f64; ORDER]; ORDER] = [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 0.2, 0.0, 0.0, 0.0, 0.0],
        [1.0, 0.4, 0.1, 0.0, 0.0, 0.0],
        [1.0, 0.6, 0.3, 0.1, 0.0, 0.0],
        [1.0, 0.8, 0.6, 0.4, 0.2, 0.0],
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    ];
    let mut scaled = *p;
    let mut power = T::one();
    for c in &mut scaled {
        *c *= power;
        power *= length;
    }
    WEIGHTS.map(|row| row.iter().zip(&scaled).fold(T::zero(), |sum, (w, c)| sum + *c * lit(*w)))
}

/// The roots in [0, length] at which the polynomial changes sign, in order: between two roots of the derivative lies one at most.
pub(super) fn roots<T: RealField + Copy>(p: &Polynomial<T>, length: T) -> [Option<T>; ORDER] {
    let mut chain = [[T::zero(); ORDER]; ORDER];
    chain[0] = *p;
    for i in 1..ORDER {
        chain[i] = derivative(&chain[i - 1]);
    }
    let mut roots: [Option<T>; ORDER] = [None; ORDER];
    // From the constant derivative down to p itself.
    for of in chain.iter().rev() {
        let mut found: [Option<T>; ORDER] = [None; ORDER];
        let mut places = found.iter_mut();
        // A value within its rounding has no sign: the last place before it that has one counts.
        let mut left = T::zero();
        let mut sign_left = sign(of, left);
        for right in roots.iter().flatten().copied().chain([length]) {
            let sign_right = sign(of, right);
            if sign_right == T::zero() {
                continue;
            }
            if sign_left + sign_right == T::zero() {
                if let Some(place) = places.next() {
                    *place = Some(bisected(of, left, right));
                }
            }
            (left, sign_left) = (right, sign_right);
        }
        roots = found;
    }
    roots
}

/// The sign of p(t), 0 where the value is within the rounding of Horner's rule: |error| <= 2 n u sum |p_k| t^k (Higham 2002, section 5.1).
fn sign<T: RealField + Copy>(p: &Polynomial<T>, t: T) -> T {
    let sizes = p.map(|c| c.abs());
    let rounding = value(&sizes, t.abs()) * T::default_epsilon() * lit(ORDER as f64);
    match value(p, t) {
        v if v > rounding => T::one(),
        v if v < -rounding => -T::one(),
        _ => T::zero(),
    }
}

/// The root between two places at which the polynomial has opposite signs, to the last bit.
fn bisected<T: RealField + Copy>(p: &Polynomial<T>, mut left: T, mut right: T) -> T {
    let rises = value(p, left) < T::zero();
    for _ in 0..128 {
        let middle = (left + right) * lit(0.5);
        if !(left < middle && middle < right) {
            break;
        }
        if (value(p, middle) < T::zero()) == rises {
            left = middle;
        } else {
            right = middle;
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_those_of_the_factors() {
        // (t - 1)(t - 2)(t - 3)(t - 4)
        let p = [24.0, -50.0, 35.0, -10.0, 1.0, 0.0];
        let found: Vec<f64> = roots(&p, 3.5).into_iter().flatten().collect();
        assert_eq!(found.len(), 3);
        for (root, expected) in found.iter().zip([1.0, 2.0, 3.0]) {
            assert!((root - expected).abs() < 1e-13, "{root}");
        }
        // (t - 1)²: no change of sign.
        assert_eq!(roots(&[1.0, -2.0, 1.0, 0.0, 0.0, 0.0], 3.0).into_iter().flatten().count(), 0);
        assert_eq!(roots(&[0.0; 6], 1.0), [None; 6]);
    }

    #[test]
    fn shifts_and_bernstein_coefficients_have_the_same_values() {
        let p = [3.0, -1.0, 4.0, -1.0, 5.0, -9.0];
        let moved = shifted(&p, 2.0);
        assert_eq!(value(&moved, 1.0), value(&p, 3.0));
        let b = bernstein(&p, 2.0);
        assert_eq!((b[0], b[5]), (value(&p, 0.0), value(&p, 2.0)));
        // In the middle: de Casteljau's weights C(5, i)/32.
        let middle: f64 = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0].iter().zip(b).map(|(w, c)| w * c / 32.0).sum();
        assert!((middle - value(&p, 1.0)).abs() < 1e-12);
    }
}
