/// Largest angle, rad, that `sin_cos` reduces itself.
const SIN_COS_RANGE: f64 = 65536.0;

/// Sine and cosine of an angle, |x| <= `SIN_COS_RANGE`, each within 1 unit in the last place; the sine of -0 is -0. Without branches, so that
/// a loop over angles becomes vector instructions, and without fused multiply-add: the same bits everywhere.
///
/// x = n pi/2 + r - e with n the nearest integer to 2x/pi, after Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two
/// have 37 bits. Their products with n are exact, and so is x less the first; e holds the third product less what r rounds away.
/// The polynomials are minimax on |r| <= pi/4 (Remez): sin r = r + r^3 P(r^2), relative error 2^-57; cos r = 1 - r^2/2 + r^4 Q(r^2), error 2^-57.
/// sin (r - e) = sin r - e and cos (r - e) = cos r + r e to what a float holds; 1 - r^2/2 is carried with its rounding.
/// The lowest bits of n say which of the two is the sine, and the signs.
#[allow(clippy::all)]
#[inline(always)]
fn sin_cos(x: f64) -> (f64, f64) {
    /// Adding 3/2 2^52 rounds to an integer, whose lowest bits are then those of the sum.
    const TO_INTEGER: f64 = 6755399441055744.0;
    const TWO_OVER_PI: f64 = 0.6366197723675814;
    const HALF_PI: [f64; 3] = [
        1.5707963267923333,
        2.5633441515839558e-12,
        1.0562999066987428e-23,
    ];
    let shifted = x * TWO_OVER_PI + TO_INTEGER;
    let n = shifted - TO_INTEGER;
    let quadrant = shifted.to_bits();
    let first = x - n * HALF_PI[0];
    let step = n * HALF_PI[1];
    let r = first - step;
    let e = n * HALF_PI[2] - ((first - r) - step);
    let z = r * r;
    let zz = z * z;
    let p = (0.008333333333322035 + z * -0.00019841269829660063)
        + zz
            * ((2.7557313668040543e-6 + z * -2.5050756282937577e-8)
                + zz * 1.5896732662311403e-10);
    let sine = r - (e + (z * r) * (0.1666666666666663 - z * p));
    let q = (0.0416666666666666 + z * -0.0013888888888873453)
        + zz
            * ((2.4801587287964484e-5 + z * -2.7557313594775254e-7)
                + zz * (2.087558805713208e-9 + z * -1.1351822784169523e-11));
    let half = 0.5 * z;
    let near = 1.0 - half;
    let cosine = near + (((1.0 - near) - half) + (zz * q + r * e));
    let exchange = (sine.to_bits() ^ cosine.to_bits()) & 0u64.wrapping_sub(quadrant & 1);
    let sine_sign = (quadrant & 2) << 62;
    let cosine_sign = (quadrant.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(sine.to_bits() ^ exchange ^ sine_sign),
        f64::from_bits(cosine.to_bits() ^ exchange ^ cosine_sign),
    )
}

/// Sine and cosine of an angle in rad.
#[allow(clippy::all)]
#[inline]
fn sin_cos_one(x: f64) -> (f64, f64) {
    if x.abs() <= SIN_COS_RANGE { sin_cos(x) } else { sin_cos_beyond(x) }
}

/// Sine and cosine of an angle that is beyond `SIN_COS_RANGE`, infinite or not a number.
#[allow(clippy::all)]
#[cold]
#[inline(never)]
fn sin_cos_beyond(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Whether the processor has vectors of floats. On others the lanes without an angle of their own are left out.
const SIN_COS_VECTORS: bool = cfg!(
    any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128")
);

/// Whether the processor has vectors of two floats and none of four: those without an angle of their own are then left out.
const SIN_COS_PAIRS: bool = SIN_COS_VECTORS && !cfg!(target_feature = "avx");

/// Sines and cosines of the first `count` of four angles, rad, all in one loop, which becomes vector instructions.
#[allow(clippy::all)]
#[inline(never)]
fn sin_cos_four(count: usize, a: f64, b: f64, c: f64, d: f64) -> ([f64; 4], [f64; 4]) {
    let (x, mut sines, mut cosines) = ([a, b, c, d], [0.0; 4], [0.0; 4]);
    let mut inside = true;
    if SIN_COS_PAIRS && count <= 2 {
        for i in 0..2 {
            (sines[i], cosines[i]) = sin_cos(x[i]);
            inside &= x[i].abs() <= SIN_COS_RANGE;
        }
    } else {
        let lanes = if SIN_COS_VECTORS { 4 } else { count.min(4) };
        for i in 0..lanes {
            (sines[i], cosines[i]) = sin_cos(x[i]);
            inside &= x[i].abs() <= SIN_COS_RANGE;
        }
    }
    if inside { (sines, cosines) } else { sin_cos_each_of_four(a, b, c, d) }
}

/// The same where one of the angles is beyond `SIN_COS_RANGE`.
#[allow(clippy::all)]
#[cold]
#[inline(never)]
fn sin_cos_each_of_four(a: f64, b: f64, c: f64, d: f64) -> ([f64; 4], [f64; 4]) {
    let pairs = [a, b, c, d].map(sin_cos_one);
    (pairs.map(|pair| pair.0), pairs.map(|pair| pair.1))
}

/// Sines and cosines of the first `count` of eight angles, rad, all in one loop, which becomes vector instructions.
#[allow(clippy::all)]
#[inline(never)]
fn sin_cos_eight(
    count: usize,
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
    f: f64,
    g: f64,
    h: f64,
) -> ([f64; 8], [f64; 8]) {
    let (x, mut sines, mut cosines) = ([a, b, c, d, e, f, g, h], [0.0; 8], [0.0; 8]);
    let mut inside = true;
    if SIN_COS_PAIRS && count <= 6 {
        for i in 0..6 {
            (sines[i], cosines[i]) = sin_cos(x[i]);
            inside &= x[i].abs() <= SIN_COS_RANGE;
        }
    } else {
        let lanes = if SIN_COS_VECTORS { 8 } else { count.min(8) };
        for i in 0..lanes {
            (sines[i], cosines[i]) = sin_cos(x[i]);
            inside &= x[i].abs() <= SIN_COS_RANGE;
        }
    }
    if inside { (sines, cosines) } else { sin_cos_each_of_eight(a, b, c, d, e, f, g, h) }
}

/// The same where one of the angles is beyond `SIN_COS_RANGE`.
#[allow(clippy::all)]
#[cold]
#[inline(never)]
fn sin_cos_each_of_eight(
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
    f: f64,
    g: f64,
    h: f64,
) -> ([f64; 8], [f64; 8]) {
    let pairs = [a, b, c, d, e, f, g, h].map(sin_cos_one);
    (pairs.map(|pair| pair.0), pairs.map(|pair| pair.1))
}
