//! Rigid displacements over integers modulo a prime, with Montgomery multiplication (1985): a is stored as a 2^64 mod p.

/// A prime below 2^63 with the constants for products modulo it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modulus {
    pub(super) prime: u64,
    /// -1/p mod 2^64.
    factor: u64,
    /// 2^128 mod p.
    square: u64,
    pub(super) one: u64,
}

/// A displacement x -> R x + t, stored as the rows of (R | t).
pub(super) type Frame = [[u64; 4]; 3];

impl Modulus {
    pub(super) fn new(prime: u64) -> Modulus {
        // Each step doubles the number of correct bits, initially 3.
        let mut inverse = prime;
        for _ in 0..5 {
            inverse = inverse.wrapping_mul(2u64.wrapping_sub(prime.wrapping_mul(inverse)));
        }
        let one = ((1u128 << 64) % u128::from(prime)) as u64;
        let square = (u128::from(one) * u128::from(one) % u128::from(prime)) as u64;
        Modulus { prime, factor: inverse.wrapping_neg(), square, one }
    }

    #[inline]
    pub(super) fn times(self, a: u64, b: u64) -> u64 {
        let t = u128::from(a) * u128::from(b);
        let m = (t as u64).wrapping_mul(self.factor);
        let r = ((t + u128::from(m) * u128::from(self.prime)) >> 64) as u64;
        if r >= self.prime {
            r - self.prime
        } else {
            r
        }
    }

    #[inline]
    pub(super) fn plus(self, a: u64, b: u64) -> u64 {
        let sum = a + b;
        if sum >= self.prime {
            sum - self.prime
        } else {
            sum
        }
    }

    #[inline]
    pub(super) fn minus(self, a: u64, b: u64) -> u64 {
        if a >= b {
            a - b
        } else {
            a + self.prime - b
        }
    }

    pub(super) fn negated(self, a: u64) -> u64 {
        self.minus(0, a)
    }

    /// The element with this representative.
    pub(super) fn of(self, value: u64) -> u64 {
        self.times(value % self.prime, self.square)
    }

    /// The representative of an element.
    pub(super) fn value(self, a: u64) -> u64 {
        self.times(a, 1)
    }

    pub(super) fn integer(self, value: i64) -> u64 {
        let size = self.of(value.unsigned_abs());
        if value < 0 {
            self.negated(size)
        } else {
            size
        }
    }

    /// 1/a; 0 for a = 0.
    pub(super) fn inverse(self, a: u64) -> u64 {
        self.power(a, self.prime - 2)
    }

    /// base^exponent.
    pub(super) fn power(self, mut base: u64, mut exponent: u64) -> u64 {
        let mut result = self.one;
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.times(result, base);
            }
            base = self.times(base, base);
            exponent >>= 1;
        }
        result
    }

    /// row += factor · other, up to the length of the shorter.
    pub(super) fn add_multiple(self, row: &mut [u64], factor: u64, other: &[u64]) {
        for (x, y) in row.iter_mut().zip(other) {
            *x = self.plus(*x, self.times(factor, *y));
        }
    }

    pub(super) fn dot(self, a: [u64; 3], b: [u64; 3]) -> u64 {
        a.iter().zip(b).fold(0, |sum, (x, y)| self.plus(sum, self.times(*x, y)))
    }

    pub(super) fn cross(self, a: [u64; 3], b: [u64; 3]) -> [u64; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| self.minus(self.times(a[i], b[j]), self.times(a[j], b[i])))
    }

    pub(super) fn identity(self) -> Frame {
        let (o, l) = (0, self.one);
        [[l, o, o, o], [o, l, o, o], [o, o, l, o]]
    }

    /// The composition: first `g`, then `f`.
    pub(super) fn compose(self, f: &Frame, g: &Frame) -> Frame {
        f.map(|row| {
            std::array::from_fn(|j| {
                let sum = self.dot([row[0], row[1], row[2]], [g[0][j], g[1][j], g[2][j]]);
                if j == 3 {
                    self.plus(sum, row[3])
                } else {
                    sum
                }
            })
        })
    }

    pub(super) fn inverse_frame(self, f: &Frame) -> Frame {
        let t = [f[0][3], f[1][3], f[2][3]];
        std::array::from_fn(|i| {
            let row = [f[0][i], f[1][i], f[2][i]];
            [row[0], row[1], row[2], self.negated(self.dot(row, t))]
        })
    }

    /// A joint's displacement along or about a unit vector k: R = c 1 + (1 - c) k k' + s k×.
    pub(super) fn joint(self, slides: bool, k: [u64; 3], [c, s]: [u64; 2]) -> Frame {
        let mut frame = self.identity();
        if slides {
            for (row, k) in frame.iter_mut().zip(k) {
                row[3] = self.times(c, k);
            }
            return frame;
        }
        let rest = self.minus(self.one, c);
        for i in 0..3 {
            for j in 0..3 {
                let along = self.times(rest, self.times(k[i], k[j]));
                frame[i][j] = if i == j { self.plus(c, along) } else { along };
            }
        }
        for (i, j, l) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let x = self.times(s, k[l]);
            frame[i][j] = self.minus(frame[i][j], x);
            frame[j][i] = self.plus(frame[j][i], x);
        }
        frame
    }
}
