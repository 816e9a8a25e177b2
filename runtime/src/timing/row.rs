//! A limit as a row m u + c x + v sqrt(x) + d <= bound on a segment, and its degree-4 Bernstein form.
//!
//! With x of Bernstein coefficients X0, X1 = (X0 + X2)/2 + k, X2 and u of U0 = (X1 - X0)/h, U1 = (X2 - X1)/h, the five coefficients of
//! m u + c x + d, m, c, d quadratics, are linear in X0, X2 and k. All five at most the bound prove the row on the whole segment.

use super::curve::{Curve, Line};
use crate::linalg::lit;
use nalgebra::RealField;

/// A quadratic on a segment: three Bernstein coefficients.
pub(super) type Quadratic<T> = [T; 3];

/// Without a case for numbers that are none, so that it is an instruction.
#[inline]
pub(super) fn least<T: PartialOrd>(a: T, b: T) -> T {
    if a < b {
        a
    } else {
        b
    }
}

/// The same.
#[inline]
pub(super) fn most<T: PartialOrd>(a: T, b: T) -> T {
    if a > b {
        a
    } else {
        b
    }
}

/// A coefficient of a row's Bernstein form: x0 X0 + x2 X2 + k k + rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Form<T> {
    pub x0: T,
    pub x2: T,
    pub k: T,
    pub rest: T,
}

/// A row, one-sided: m u + c x + v sqrt(x) + d <= bound, each function within its error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<T> {
    pub m: Quadratic<T>,
    pub c: Quadratic<T>,
    pub v: Quadratic<T>,
    pub d: Quadratic<T>,
    pub m_error: T,
    pub c_error: T,
    pub v_error: T,
    pub d_error: T,
    pub bound: T,
    /// Friction that enters otherwise.
    pub curve: Option<Curve<T>>,
}

/// Where x lies, with lines over its root: above it and below.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window<T> {
    x: [T; 2],
    touch: T,
    above: Line<T>,
    below: Line<T>,
}

impl<T: RealField + Copy> Window<T> {
    /// x from least to most; tangents touch at `touch` > 0.
    pub(super) fn new(x: [T; 2], touch: T) -> Self {
        Self { x, touch, above: Line::tangent(touch.sqrt()), below: Line::chord(x[0], x[1]) }
    }

    /// The lines over the root of x: below it and above.
    pub(super) fn lines(&self) -> [Line<T>; 2] {
        [self.below, self.above]
    }
}

impl<T: RealField + Copy> Row<T> {
    /// The sign of v on the segment.
    pub(super) fn v_sign(&self) -> T {
        let [v0, v1, v2] = self.v;
        v0 + v1 + v1 + v2
    }

    /// Whether friction enters that is no line over x.
    pub(super) fn is_curved(&self) -> bool {
        self.curve.is_some() || self.v.iter().any(|v| *v != T::zero())
    }

    /// The row with such friction replaced by lines that bound the row, for x >= 0 in a window: from above, or from below.
    pub(super) fn straight(&self, window: &Window<T>, above: bool) -> Row<T> {
        let mut row = *self;
        let line = if (self.v_sign() > T::zero()) == above { window.above } else { window.below };
        for i in 0..3 {
            row.c[i] += self.v[i] * line.slope;
            row.d[i] += self.v[i] * line.height;
        }
        if let Some(curve) = &self.curve {
            let (line, rounding) = curve.line(window.x, window.touch, above);
            let side = if above { T::one() } else { -T::one() };
            let error = line.slope.abs() * curve.error * side;
            for i in 0..3 {
                row.c[i] += line.slope * curve.square[i] + error;
                row.d[i] += line.height + rounding * side;
            }
        }
        row
    }

    /// What friction adds at an end of the segment that is no line over x.
    pub(super) fn curved(&self, end: usize, x: T) -> T {
        let at = |[start, _, last]: Quadratic<T>| if end == 0 { start } else { last };
        let value = at(self.v) * x.max(T::zero()).sqrt();
        self.curve.as_ref().map_or(value, |curve| value + curve.value(at(curve.square), x))
    }

    /// The row seen from the other end: u changes its sign.
    pub(super) fn reversed(&self) -> Row<T> {
        let turned = |[a, b, c]: Quadratic<T>| [c, b, a];
        let mut curve = self.curve;
        if let Some(curve) = &mut curve {
            curve.square = turned(curve.square);
        }
        Row { m: turned(self.m).map(|m| -m), c: turned(self.c), v: turned(self.v), d: turned(self.d), curve, ..*self }
    }

    /// The Bernstein coefficients of m u + c x + d.
    pub(super) fn forms(&self, h: T) -> [Form<T>; 5] {
        let third = lit::<T>(1.0 / 3.0);
        let (half, quarter, sixth) = (lit::<T>(0.5), lit::<T>(0.25), lit::<T>(1.0 / 6.0));
        let [m0, m1, m2] = self.m;
        let [c0, c1, c2] = self.c;
        let [d0, d1, d2] = self.d;
        let per = T::one() / h;
        let g = half * per;
        let raised = |a: T, b: T, c: T| [a, (a + b) * half, (a + c + b * lit(4.0)) * sixth, (b + c) * half, c];
        let (m, d) = (raised(m0, m1, m2).map(|m| m * g), raised(d0, d1, d2));
        let by_k = [m0 * per, m1 * g, (m2 - m0) * (sixth * per), -m1 * g, -m2 * per];
        [
            Form { x0: c0 - m[0], x2: m[0], k: by_k[0], rest: d[0] },
            Form { x0: c1 * half + c0 * quarter - m[1], x2: c0 * quarter + m[1], k: by_k[1] + c0 * half, rest: d[1] },
            Form {
                x0: c2 * sixth + c1 * third - m[2],
                x2: c0 * sixth + c1 * third + m[2],
                k: by_k[2] + c1 * (third + third),
                rest: d[2],
            },
            Form { x0: c2 * quarter - m[3], x2: c1 * half + c2 * quarter + m[3], k: by_k[3] + c2 * half, rest: d[3] },
            Form { x0: -m[4], x2: c2 + m[4], k: by_k[4], rest: d[4] },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The product of two polynomials in Bernstein form: c_k = sum C(a, i) C(b, k - i)/C(a + b, k) a_i b_{k-i} (Farouki 2012), over integers:
    /// every coefficient times C(a + b, k).
    fn product(a: &[i64], b: &[i64]) -> Vec<i64> {
        let (p, q) = (a.len() - 1, b.len() - 1);
        let choose = |n: usize, k: usize| (0..k).fold(1i64, |c, i| c * (n - i) as i64 / (i + 1) as i64);
        (0..=p + q)
            .map(|k| (0..=p).filter(|i| k >= *i && k - i <= q).map(|i| choose(p, i) * choose(q, k - i) * a[i] * b[k - i]).sum())
            .collect()
    }

    /// Forms are compared with the general product on integers, which the scalar holds exactly; 1/3 and 1/6 alone round.
    #[test]
    fn the_closed_form_is_the_general_product() {
        let mut seed = 3u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 40) % 41) as i64 - 20
        };
        for _ in 0..500 {
            let mut three = || [random(), random(), random()];
            let (m, c, d) = (three(), three(), three());
            let ([x0, k, x2], h) = (three(), 4);
            // Even, so that X1 is whole; multiples of h, so that u is.
            let (x0, k, x2) = (2 * h * x0, h * k, 2 * h * x2);
            let x1 = (x0 + x2) / 2 + k;
            let (u0, u1) = ((x1 - x0) / h, (x2 - x1) / h);
            // u of degree 2, times 2, so that m u has degree 4, like c x.
            let (mu, cx) = (product(&m, &[2 * u0, u0 + u1, 2 * u1]), product(&c, &[x0, x1, x2]));
            let ones = product(&d, &[1, 1, 1]);
            let row = Row {
                m: m.map(|x| x as f64),
                c: c.map(|x| x as f64),
                v: [0.0; 3],
                d: d.map(|x| x as f64),
                m_error: 0.0,
                c_error: 0.0,
                v_error: 0.0,
                d_error: 0.0,
                bound: 0.0,
                curve: None,
            };
            for (i, form) in row.forms(h as f64).iter().enumerate() {
                let weight = [1, 4, 6, 4, 1][i];
                let exact = (mu[i] + 2 * cx[i] + 2 * ones[i]) as f64 / (2 * weight) as f64;
                let value = form.x0 * x0 as f64 + form.x2 * x2 as f64 + form.k * k as f64 + form.rest;
                assert!((value - exact).abs() < 1e-11 * (1.0 + exact.abs()), "{i}: {value}, {exact}");
            }
        }
    }

    #[test]
    fn lines_lie_on_their_sides_of_the_root() {
        for i in 0..=100 {
            let x = 0.2 + 0.02 * f64::from(i);
            let (above, below) = (Line::tangent(1.1), Line::chord(0.2, 2.2));
            assert!(above.slope * x + above.height >= x.sqrt() - 1e-15);
            assert!(below.slope * x + below.height <= x.sqrt() + 1e-15);
        }
        for x in [0.2f64, 2.2] {
            let chord = Line::chord(0.2, 2.2);
            assert!((chord.slope * x + chord.height - x.sqrt()).abs() < 1e-15);
        }
    }
}
