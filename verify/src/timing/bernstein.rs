//! Inequalities on t from -1 to 1, proved by Bernstein coefficients on halves.

use super::curve::Curve;
use super::taylor::{Range, Taylor, TERMS};
use crate::values::element::Element;

/// Halvings at most: parts of 2^-20.
const DEEPEST: u32 = 20;

/// x = ds² by its three Bernstein coefficients.
#[derive(Clone, Copy)]
pub(super) struct Square(pub(super) [Range; 3]);

/// Bernstein coefficients of degree 8 of the polynomial of a model.
fn coefficients(of: &Taylor) -> [Range; TERMS] {
    // In r from 0 to 1, t = 2 r - 1: sum_k a_k (2 r - 1)^k, by Horner.
    let (two, minus) = (Range::of(2.0), Range::of(-1.0));
    let mut powers = [Range::ZERO; TERMS];
    for term in of.terms.iter().rev() {
        let mut next = [Range::ZERO; TERMS];
        for k in 0..TERMS {
            next[k] = next[k].plus(powers[k].times(minus));
            if k + 1 < TERMS {
                next[k + 1] = next[k + 1].plus(powers[k].times(two));
            }
        }
        next[0] = next[0].plus(*term);
        powers = next;
    }
    let binomial = |n: usize, k: usize| (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64);
    std::array::from_fn(|i| {
        (0..=i).fold(Range::ZERO, |sum, k| {
            let share = Range::of(binomial(i, k)).over(Range::of(binomial(TERMS - 1, k))).unwrap_or(Range::ALL);
            sum.plus(powers[k].times(share))
        })
    })
}

/// Both halves (de Casteljau).
fn halves<const K: usize>(of: &[Range; K]) -> [[Range; K]; 2] {
    let (mut row, mut left, mut right) = (*of, *of, *of);
    for k in 0..K {
        left[k] = row[0];
        right[K - 1 - k] = row[K - 1 - k];
        for i in 0..K - 1 - k {
            row[i] = row[i].plus(row[i + 1]).times(Range::of(0.5));
        }
    }
    [left, right]
}

#[derive(Clone, Copy)]
struct Part {
    smooth: [Range; TERMS],
    /// v x and v.
    rooted: Option<[[Range; TERMS]; 2]>,
    /// dq².
    y: Option<[Range; TERMS]>,
    x: [Range; 3],
    from: f64,
    width: f64,
    depth: u32,
}

/// f + v sqrt(x) + a curve of y <= 0 for t from -1 to 1, where v and x, the curve and y are given; `square` is x again.
///
/// # Errors
/// A t: within 2^-20 of it this is not proved.
pub(super) fn at_most_zero(
    f: &Taylor,
    rooted: Option<(&Taylor, &Taylor)>,
    curved: Option<&(Curve, Taylor)>,
    square: &Square,
) -> Result<(), f64> {
    let rooted = rooted.filter(|(v, _)| !v.is_zero());
    let products = rooted.map(|(v, x)| (v.times(x), v));
    // What the polynomials miss: sqrt(x) is at most that of the largest coefficient.
    let largest = square.0.iter().fold(0.0f64, |most, x| most.max(x.high));
    let line = Range { low: 0.0, high: largest.max(0.0) };
    let mut parts = vec![Part {
        smooth: coefficients(f),
        rooted: products.as_ref().map(|(product, v)| [coefficients(product), coefficients(v)]),
        y: curved.map(|(_, y)| coefficients(y)),
        x: square.0,
        from: -1.0,
        width: 2.0,
        depth: 0,
    }];
    while let Some(part) = parts.pop() {
        let straight = curved.map_or(Some((part.smooth, f.rest)), |of| part.straight(f.rest, of));
        let rests = products.as_ref().map(|(product, v)| [product.rest, v.rest]);
        let bound = straight.and_then(|(smooth, rest)| part.bound(&smooth, rest, rests, line));
        if bound.is_some_and(|bound| bound <= 0.0) {
            continue;
        }
        if part.depth == DEEPEST {
            return Err(part.from + 0.5 * part.width);
        }
        let (smooth, x) = (halves(&part.smooth), halves(&part.x));
        let rooted = part.rooted.map(|[product, v]| [halves(&product), halves(&v)]);
        let y = part.y.map(|y| halves(&y));
        for half in [1, 0] {
            let width = 0.5 * part.width;
            parts.push(Part {
                smooth: smooth[half],
                rooted: rooted.map(|[product, v]| [product[half], v[half]]),
                y: y.map(|y| y[half]),
                x: x[half],
                from: part.from + width * half as f64,
                width,
                depth: part.depth + 1,
            });
        }
    }
    Ok(())
}

impl Part {
    /// The polynomial and its rest with a line in place of a curve.
    fn straight(&self, rest: Range, (curve, model): &(Curve, Taylor)) -> Option<([Range; TERMS], Range)> {
        let y = self.y?;
        let low = (y.iter().fold(f64::INFINITY, |least, y| least.min(y.low)) + model.rest.low).next_down().max(0.0);
        let high = (y.iter().fold(f64::NEG_INFINITY, |most, y| most.max(y.high)) + model.rest.high).next_up().max(low);
        let [slope, height] = curve.line(low, high, 0.5 * (low + high))?;
        let smooth = std::array::from_fn(|k| self.smooth[k].plus(slope.times(y[k])).plus(height));
        Some((smooth, rest.plus(slope.times(model.rest))))
    }

    /// An upper bound on this part.
    fn bound(&self, smooth: &[Range; TERMS], rest: Range, rests: Option<[Range; 2]>, all: Range) -> Option<f64> {
        let most = |of: &[Range; TERMS]| of.iter().fold(f64::NEG_INFINITY, |most, x| most.max(x.high));
        let (Some([product, v]), Some([product_rest, v_rest])) = (&self.rooted, rests) else {
            return Some(Range::of(most(smooth)).plus(rest).high);
        };
        let clamp = |x: f64| x.max(0.0);
        let low = self.x.iter().fold(f64::INFINITY, |least, x| least.min(clamp(x.low)));
        let high = self.x.iter().fold(0.0f64, |most, x| most.max(clamp(x.high))).min(all.high);
        let (a, b) = (Range::of(low).root()?, Range::of(high).root()?);
        let v_low = v.iter().fold(f64::INFINITY, |least, x| least.min(x.low)) + v_rest.low;
        let v_high = v.iter().fold(f64::NEG_INFINITY, |most, x| most.max(x.high)) + v_rest.high;
        if b.high == 0.0 {
            return Some(Range::of(most(smooth)).plus(rest).high);
        }
        // v sqrt(x) by a line: a chord from below where v <= 0, a tangent from above where v >= 0, and its gap where v has both signs.
        let (slope, height, gap) = if v_high <= 0.0 {
            let sum = a.plus(b);
            (Range::of(1.0).over(sum)?, a.times(b).over(sum)?, 0.0)
        } else {
            let touch = 0.5 * (a.low + b.high);
            let slope = Range::of(0.5).over(Range::of(touch))?;
            let height = Range::of(touch).times(Range::of(0.5));
            let above = |x: f64, root: Range| slope.times(Range::of(x)).plus(height).minus(root).high;
            (slope, height, above(low, a).max(above(high, b)).max(0.0))
        };
        let mut bound = f64::NEG_INFINITY;
        for k in 0..TERMS {
            bound = bound.max(smooth[k].plus(slope.times(product[k])).plus(height.times(v[k])).high);
        }
        let missed = rest.plus(slope.times(product_rest)).plus(height.times(v_rest));
        let spread = Range::of(gap).times(Range::of((-v_low).max(0.0)));
        Some(Range::of(bound).plus(missed).plus(spread).high)
    }
}

impl Taylor {
    /// Dry friction of this size against `rate`. Within rounding of a root of the rate the joint rests, and the middle of the segment
    /// decides; where the rate has both signs, the friction may be anything up to this size.
    pub(super) fn directed(&self, rate: &Taylor) -> Taylor {
        if self.is_zero() {
            return self.clone();
        }
        match rate.direction() {
            Some(sign) => self.times(&Taylor::constant(sign)),
            None => Taylor { rest: Range::both(self.range().size()), ..Taylor::constant(Range::ZERO) },
        }
    }

    /// The sign of a rate on all of the segment, but for rounding.
    pub(super) fn direction(&self) -> Option<Range> {
        let sign = Range::of(self.terms[0].sign());
        let slack = Taylor::constant(Range::of(1e-9 * self.range().size()));
        let against = self.times(&Taylor::constant(sign)).negated().minus(&slack);
        at_most_zero(&against, None, None, &Square([Range::ZERO; 3])).is_ok().then_some(sign)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(terms: &[f64]) -> Taylor {
        let mut of = Taylor::constant(Range::ZERO);
        for (k, term) in terms.iter().enumerate() {
            of.terms[k] = Range::of(*term);
        }
        of
    }

    const NONE: Square = Square([Range::ZERO; 3]);

    #[test]
    fn polynomials_are_judged_between_their_coefficients() {
        // (t - 0.3)² - 1e-4 is below zero only near 0.3; its largest value on the ends is 1.69.
        assert!(at_most_zero(&polynomial(&[0.09 - 1.7, -0.6, 1.0]), None, None, &NONE).is_ok());
        assert!(at_most_zero(&polynomial(&[0.09 - 1.68, -0.6, 1.0]), None, None, &NONE).is_err_and(|t| (t + 1.0).abs() < 1e-3));
        // -(t - 0.3)² touches zero: not proved at the place, but with 1e-9 to spare it is.
        assert!(at_most_zero(&polynomial(&[-0.09, 0.6, -1.0]), None, None, &NONE).is_err_and(|t| (t - 0.3).abs() < 1e-3));
        assert!(at_most_zero(&polynomial(&[-0.09 - 1e-9, 0.6, -1.0]), None, None, &NONE).is_ok());
    }

    #[test]
    fn roots_are_bounded_on_their_side() {
        // x from 0 to 4: sqrt(x) - 2 <= 0, 1 - sqrt(x) <= 0 for x from 1 to 4 only, and both signs of v.
        let x = polynomial(&[2.0, 2.0]);
        let square = |a: f64, b: f64| Square([Range::of(a), Range::of(0.5 * (a + b)), Range::of(b)]);
        let v = |v: f64| polynomial(&[v]);
        assert!(at_most_zero(&polynomial(&[-2.0 - 1e-9]), Some((&v(1.0), &x)), None, &square(0.0, 4.0)).is_ok());
        assert!(at_most_zero(&polynomial(&[-1.999]), Some((&v(1.0), &x)), None, &square(0.0, 4.0)).is_err_and(|t| t > 0.99));
        assert!(at_most_zero(&polynomial(&[1.0]), Some((&v(-1.0), &x)), None, &square(0.0, 4.0)).is_err());
        let x = polynomial(&[2.5, 1.5]);
        assert!(at_most_zero(&polynomial(&[1.0 - 1e-9]), Some((&v(-1.0), &x)), None, &square(1.0, 4.0)).is_ok());
        // Above a chord in the middle: sqrt(x) - x/2 is 0 at both ends of x from 0 to 4, and 1/2 at x = 1.
        let (x, halved) = (polynomial(&[2.0, 2.0]), |f: f64| polynomial(&[f - 1.0, -1.0]));
        assert!(at_most_zero(&halved(-0.51), Some((&v(1.0), &x)), None, &square(0.0, 4.0)).is_ok());
        assert!(at_most_zero(&halved(-0.3), Some((&v(1.0), &x)), None, &square(0.0, 4.0)).is_err());
        // t sqrt(2 - 2 t) is -2 at t = -1, where the tangent of the root at x = 1 is above it by 1/2.
        let (x, both) = (polynomial(&[2.0, -2.0]), polynomial(&[0.0, 1.0]));
        assert!(at_most_zero(&polynomial(&[-2.9, -5.0]), Some((&both, &x)), None, &square(4.0, 0.0)).is_err());
        assert!(at_most_zero(&polynomial(&[-3.1, -5.0]), Some((&both, &x)), None, &square(4.0, 0.0)).is_ok());
        let x = polynomial(&[2.5, 1.5]);
        // What the model of v misses: v from 0.5 to 1.5, sqrt(x) at most 2.
        let missing = Taylor { rest: Range::both(0.5), ..v(1.0) };
        assert!(at_most_zero(&polynomial(&[-2.9]), Some((&missing, &x)), None, &square(1.0, 4.0)).is_err());
        assert!(at_most_zero(&polynomial(&[-3.1]), Some((&missing, &x)), None, &square(1.0, 4.0)).is_ok());
        // t sqrt(x) at t = 1 is 2, at t = -1 it is -1.
        assert!(at_most_zero(&polynomial(&[-2.0 - 1e-6]), Some((&polynomial(&[0.0, 1.0]), &x)), None, &square(1.0, 4.0)).is_ok());
        assert!(at_most_zero(&polynomial(&[-1.9]), Some((&polynomial(&[0.0, 1.0]), &x)), None, &square(1.0, 4.0)).is_err());
    }

    /// With dq = 1 + t/4 the curve is a polynomial in t: less itself it is 0 everywhere. A line that is a chord where it should be a tangent
    /// lies below the curve.
    #[test]
    fn curves_are_judged_on_all_of_an_interval() {
        let rate = polynomial(&[1.0, 0.25]);
        let y = rate.times(&rate);
        let (y_of, number) = (|t: f64| (1.0 + 0.25 * t).powi(2), |x: f64| Taylor::constant(Range::of(x)));
        for (cubic, stribeck) in [(2.0, 0.0), (-2.0, 0.0), (0.0, 3.0), (0.0, -3.0), (-1.0, 2.0), (1.0, -2.0)] {
            let of = Curve { cubic: Range::of(cubic), stribeck: Range::of(stribeck), velocity: Range::of(1.0) };
            let judged = |f: Taylor| at_most_zero(&f, None, Some(&(of, y.clone())), &NONE);
            let mut exponential = Taylor::constant(Range::ZERO);
            (0..9i32).fold((-1.0f64).exp(), |term, k| {
                exponential.terms[k as usize] = Range::of(term);
                term * -0.25 / f64::from(k + 1)
            });
            let itself = rate.times(&y).times(&number(cubic)).plus(&exponential.times(&number(stribeck)));
            assert!(judged(number(-1e-6).minus(&itself)).is_ok(), "{of:?}");
            assert!(judged(number(1e-6).minus(&itself)).is_err(), "{of:?}");
            let value = |t: f64| cubic * y_of(t).powf(1.5) + stribeck * (-y_of(t).sqrt()).exp();
            assert!(judged(number(-1e-3 - value(-1.0).min(value(1.0)))).is_err(), "{of:?}");
            let line = |from: f64, slope: f64| number(value(from) - slope * y_of(from)).plus(&y.times(&number(slope)));
            let chord = line(-1.0, (value(1.0) - value(-1.0)) / (y_of(1.0) - y_of(-1.0)));
            let tangent = line(0.0, 1.5 * cubic - 0.5 * stribeck * (-1.0f64).exp());
            if cubic * stribeck == 0.0 {
                let (above, below) = if cubic + stribeck > 0.0 { (chord, tangent) } else { (tangent, chord) };
                assert!(judged(number(-1e-9).minus(&above)).is_ok(), "{of:?}");
                assert!(judged(number(-1e-3).minus(&below)).is_err(), "{of:?}");
            }
        }
        // What the model of y misses lies on one side: y from 1 to 1.2.
        let missing = Taylor { rest: Range { low: 0.0, high: 0.2 }, ..number(1.0) };
        for (cubic, f, holds) in [(1.0, -1.32, true), (1.0, -1.31, false), (-1.0, 0.99, true), (-1.0, 1.001, false)] {
            let of = Curve { cubic: Range::of(cubic), stribeck: Range::ZERO, velocity: Range::of(1.0) };
            assert_eq!(at_most_zero(&number(f), None, Some(&(of, missing.clone())), &NONE).is_ok(), holds, "{cubic} {f}");
        }
    }
}
