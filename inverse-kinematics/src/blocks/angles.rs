// Angles of points of the circle.

/// pi.
pub const HALF_TURN: Real = 3.141592653589793238462643383279502884;

/// The angle of a point (c, s) of the circle in (-pi, pi], rad, right to 4 u of itself and to 2 u of pi beside the rounding of (c, s).
///
/// By its smaller coordinate over the larger one, of an angle a <= pi/4: tan(a/2) = sin a/(r + cos a), whose arctangent is a short series.
/// r is the point's distance from the origin, to the square of its difference from 1.
/// All that is chosen is a value, nothing branches, so angles side by side become vector instructions. NaN of a point that is not finite.
#[inline]
pub fn angle([c, s]: [Real; 2]) -> Real {
    let (x, y) = (c.abs(), s.abs());
    let long = if y > x { y } else { x };
    let short = if y < x { y } else { x };
    let r = 0.5 + 0.5 * (x * x + y * y);
    let t = short / (r + long);
    let z = t * t;
    let twice = t + t;
    // NaN of an infinity too.
    let a = twice + twice * z * (arctangent_series(z) + (r - r));
    let a = if y > x { 0.5 * HALF_TURN - a } else { a };
    let a = if c < 0.0 { HALF_TURN - a } else { a };
    // -pi is pi.
    let below = if s < 0.0 && a < HALF_TURN { a } else { 0.0 };
    a - (below + below)
}
