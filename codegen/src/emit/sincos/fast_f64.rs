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
    const HALF_PI: [f64; 3] = [1.5707963267923333, 2.5633441515839558e-12, 1.0562999066987428e-23];
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
        + zz * ((2.7557313668040543e-6 + z * -2.5050756282937577e-8) + zz * 1.5896732662311403e-10);
    let sine = r - (e + (z * r) * (0.1666666666666663 - z * p));
    let q = (0.0416666666666666 + z * -0.0013888888888873453)
        + zz * ((2.4801587287964484e-5 + z * -2.7557313594775254e-7) + zz * (2.087558805713208e-9 + z * -1.1351822784169523e-11));
    let half = 0.5 * z;
    let near = 1.0 - half;
    let cosine = near + (((1.0 - near) - half) + (zz * q + r * e));

    let exchange = (sine.to_bits() ^ cosine.to_bits()) & 0u64.wrapping_sub(quadrant & 1);
    let sine_sign = (quadrant & 2) << 62;
    let cosine_sign = (quadrant.wrapping_add(1) & 2) << 62;
    (f64::from_bits(sine.to_bits() ^ exchange ^ sine_sign), f64::from_bits(cosine.to_bits() ^ exchange ^ cosine_sign))
}

/// Sines and cosines of angles in rad, all in one loop; those of angles beyond `SIN_COS_RANGE`, infinite or not a number are those of `libm`.
#[allow(clippy::all)]
#[inline(always)]
fn sin_cos_all<const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        (sines[i], cosines[i]) = sin_cos(x[i]);
    }
    if !x.iter().fold(true, |inside, x| inside & (x.abs() <= SIN_COS_RANGE)) {
        sin_cos_beyond(x, &mut sines, &mut cosines);
    }
    (sines, cosines)
}

/// Sines and cosines of a few angles: called, because a short loop that is taken in falls apart into single angles.
#[allow(clippy::all)]
#[inline(never)]
fn sin_cos_few<const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]) {
    sin_cos_all(x)
}

/// Replaces what `sin_cos` cannot know.
#[allow(clippy::all)]
#[cold]
#[inline(never)]
fn sin_cos_beyond(x: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    for ((x, sine), cosine) in x.iter().zip(sines).zip(cosines) {
        if !(x.abs() <= SIN_COS_RANGE) {
            (*sine, *cosine) = libm::sincos(*x);
        }
    }
}
