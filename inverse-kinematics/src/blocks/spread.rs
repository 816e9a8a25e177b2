// A circle whose points are moved so that the roots of a polynomial on it lie less crowded.
//
// A trigonometric polynomial f of degree D is a form of degree 2 D in (cos q/2, sin q/2), and stays one after a linear map of the two. With
// tan(q/2) = (1 - p)/(1 + p) tan(t/2) and n = 1 + p² + 2 p cos t, n^D f(q(t)) is of degree D in t: roots that crowd about q = 0 are taken
// apart. Where they crowd f is below the rounding of its coefficients, though the determinant that gives it is not below its own.

/// A map t -> q of the circle to itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The q, as a point, about which the points are taken apart most.
    pub centre: [Real; 2],
    /// How much, 0 <= p < 1: dq/dt is (1 - p)/(1 + p) there, and the inverse of it opposite.
    pub p: Real,
}

impl Spread {
    /// q = t.
    #[inline]
    pub fn none() -> Self {
        Spread { centre: [1.0, 0.0], p: 0.0 }
    }

    /// The map that takes the mean of the 16 roots, as points, complex ones further inside the circle, to about its middle: they are those of a
    /// polynomial of degree 8 with these values at equal angles.
    ///
    /// log |sin((q - r)/2)| = -log 2 - sum_k cos(k (q - r))/k: the first Fourier coefficient of log |f| is the sum of the roots. The bits of a
    /// float are its logarithm, to a tenth.
    pub fn of_roots(samples: &[Real; 24]) -> Self {
        const LOG_2: Real = 0.693147180559945309417232121458176568;
        let (mut x, mut y) = (0.0, 0.0);
        for (j, sample) in samples.iter().enumerate() {
            let logarithm = sample.abs().to_bits() as Real * Real::EPSILON;
            x -= logarithm * cosine_of_15_degrees(j);
            y -= logarithm * cosine_of_15_degrees(j + 18);
        }
        let size = sqrt(x * x + y * y);
        if !(size > 0.0) {
            return Spread::none();
        }
        // 2/24 of a Fourier coefficient, 1/16 of a mean.
        let p = size * (LOG_2 / 192.0);
        Spread { centre: [x / size, y / size], p: if p < MOST_SPREAD { p } else { MOST_SPREAD } }
    }

    /// q at t, both as points, and (n/(1 + p)²)^8, at most 1: by this f(q) is a polynomial of degree 8 in t.
    #[inline]
    pub fn at(&self, [c, s]: [Real; 2]) -> ([Real; 2], Real) {
        let (p, [x, y]) = (self.p, self.centre);
        let n = 1.0 + p * p + 2.0 * p * c;
        let over = 1.0 / n;
        let (cq, sq) = ((2.0 * p + (1.0 + p * p) * c) * over, (1.0 - p * p) * s * over);
        let w = n / ((1.0 + p) * (1.0 + p));
        let square = w * w;
        let fourth = square * square;
        ([x * cq - y * sq, y * cq + x * sq], fourth * fourth)
    }
}

/// A mean of roots further out leaves factors of 1e15 between the values on the circle, which is enough for either scalar.
const MOST_SPREAD: Real = 0.8;
