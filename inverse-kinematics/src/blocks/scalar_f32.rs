// The scalar and what depends on it.

/// The scalar: single precision.
pub type Real = f32;

/// Half the distance from 1 to the next larger number: the relative error of one rounded operation.
pub const UNIT_ROUNDOFF: Real = 0.5 * Real::EPSILON;

/// Where a trigonometric polynomial stays below this many times its noise on a short arc, its values there are asked for anew.
/// About u^-0.38: roots of a polynomial larger than that keep more than a third of the digits.
pub const WEAK: Real = 1e3;

/// An arc below this half width, rad, that had to be halved so far and is then seen to have no root is next to a minimum that nearly is one.
/// Rounding of a pose by u moves a double root by sqrt(u) times a factor that depends on the arm and is seldom beyond 100.
pub const SHALLOW: Real = 4e-3;

/// k0 + k1 z + k2 z² + ... of atan t = t + t³ (k0 + k1 t² + ...) for z = t² and |t| <= tan(pi/8), by Remez's exchange: right to 2^-25 of atan t.
#[inline]
pub fn arctangent_series(z: Real) -> Real {
    (-0.333329490109481651 + 0.199777043524234629 * z) + z * z * (-0.13877610807446778 + 0.080534843564990348 * z)
}

/// The square root, correctly rounded.
#[inline]
pub fn sqrt(x: Real) -> Real {
    libm::sqrtf(x)
}

/// The largest integer that is at most x.
#[inline]
pub fn floor(x: Real) -> Real {
    libm::floorf(x)
}

/// The angle of the point (c, s) in [-pi, pi], rad.
#[inline]
pub fn atan2(s: Real, c: Real) -> Real {
    libm::atan2f(s, c)
}

/// Cosine and sine of an angle in rad, in this order.
#[inline]
pub fn cos_sin(angle: Real) -> (Real, Real) {
    let (s, c) = libm::sincosf(angle);
    (c, s)
}

/// 1/sqrt(x) for x > 0, within 2 units in the last place; finite at 0. Without branches, so that lanes side by side become vector
/// instructions, which `sqrt` does not.
///
/// The bits of x, halved, give a first value within 3.5 %; each step y (3 - x y²)/2 squares the error and multiplies it by 3/2.
#[inline]
pub fn inverse_sqrt(x: Real) -> Real {
    let mut y = Real::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1));
    let half = 0.5 * x;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y
}
