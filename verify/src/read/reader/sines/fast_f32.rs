/// Largest |angle|, rad, that `sin_cos` reduces.
const SIN_COS_RANGE: f32 = 128.0;

/// Sine and cosine of an angle, |x| <= `SIN_COS_RANGE`, each within 1 unit in the last place; the sine of -0 is -0. Without branches, so that
/// a loop over angles becomes vector instructions, without fused multiply-add and without f64: the same bits wherever f32 rounds to nearest by IEEE 754.
///
/// x = n pi/2 + r - e with n the integer nearest to 2x/pi or, by rounding next to a tie, the one beside it, after Cody and Waite (1980): pi/2 is a sum
/// of three numbers, of which the first two have 17 bits. Their products with n are exact, and so is x less the first; e holds the third product less
/// what r rounds away.
#[allow(clippy::all)]
#[inline(always)]
fn sin_cos(x: f32) -> (f32, f32) {
    /// Adding 3/2 2^23 rounds to an integer, whose lowest bits are then those of the sum.
    const TO_INTEGER: f32 = 12582912.0;
    const TWO_OVER_PI: f32 = 0.63661977;
    const HALF_PI: [f32; 3] = [1.5707855, 1.0804273e-5, 6.0771005e-11];
    let shifted = x * TWO_OVER_PI + TO_INTEGER;
    let n = shifted - TO_INTEGER;
    let quadrant = shifted.to_bits();
    let first = x - n * HALF_PI[0];
    let step = n * HALF_PI[1];
    let r = first - step;
    let e = n * HALF_PI[2] - ((first - r) - step);
    sin_cos_reduced(quadrant, r, e)
}

/// Sine and cosine of n pi/2 + r - e, |r| <= pi/4 and e small beside it, n by its two lowest bits.
///
/// The polynomials are minimax on |r| <= pi/4 (Remez): sin r = r - r^3 P(r^2), relative error 2^-27; cos r = 1 - r^2/2 + r^4 Q(r^2), error 2^-31.
/// sin (r - e) = r - (e (1 - r^2/2) + r^3 P) and cos (r - e) = 1 - r^2/2 + (r e + r^4 Q), where e is so small beside r that no more of it shows. The
/// rounding error of 1 - r^2/2 is added to the terms that follow. The two lowest bits of n say which of the two is the sine, and the signs.
#[allow(clippy::all)]
#[inline(always)]
fn sin_cos_reduced(quadrant: u32, r: f32, e: f32) -> (f32, f32) {
    let z = r * r;
    let zz = z * z;
    let half = 0.5 * z;
    let near = 1.0 - half;
    let p = 0.16666655 - z * (0.008332204 + z * -0.00019520518);
    let sine = r - (e * near + (z * r) * p);
    let q = (0.041666646 + z * -0.0013887332) + zz * 2.443618e-5;
    let cosine = near + ((((1.0 - near) - half) + r * e) + zz * q);
    let exchange = (sine.to_bits() ^ cosine.to_bits()) & 0u32.wrapping_sub(quadrant & 1);
    let sine_sign = (quadrant & 2) << 30;
    let cosine_sign = (quadrant.wrapping_add(1) & 2) << 30;
    (
        f32::from_bits(sine.to_bits() ^ exchange ^ sine_sign),
        f32::from_bits(cosine.to_bits() ^ exchange ^ cosine_sign),
    )
}

/// Sine and cosine of an angle in rad.
#[allow(clippy::all)]
#[inline]
fn sin_cos_one(x: f32) -> (f32, f32) {
    if x.abs() <= SIN_COS_RANGE { sin_cos(x) } else { sin_cos_beyond(x) }
}

/// Sine and cosine of an angle that is beyond `SIN_COS_RANGE`, each within 1 unit in the last place; those of what is infinite or not a number are
/// not numbers.
///
/// x 2/pi modulo 4 in integers, after Payne and Hanek (1983): x is 24 bits m times a power of two, which says where in the bits of 2/pi those
/// begin whose products with m count; 96 of them leave 62 bits behind the point, where no float comes nearer to a multiple of pi/2 than 2^-31.
#[allow(clippy::all)]
#[cold]
#[inline(never)]
fn sin_cos_beyond(x: f32) -> (f32, f32) {
    /// 2/pi 2^-18, in words of 32 bits behind the point.
    const BITS: [u32; 7] = [
        0x28be, 0x60db9391, 0x054a7f09, 0xd5f47d4d, 0x377036d8, 0xa5664f10, 0xe4107f94,
    ];
    const HALF_PI: u32 = 0xc90fdaa2;
    let bits = x.to_bits();
    let exponent = (bits >> 23) & 255;
    if exponent == 255 {
        return (f32::NAN, f32::NAN);
    }
    let m = (bits & 0x007f_ffff) | 0x0080_0000;
    let skipped = exponent.wrapping_sub(134) & 127;
    let (first, shift) = ((skipped / 32) as usize, skipped % 32);
    let word = |i: usize| {
        (BITS[first + i] << shift) | ((BITS[first + i + 1] >> 1) >> (31 - shift))
    };
    let low = u64::from(m) * u64::from(word(2));
    let middle = u64::from(m) * u64::from(word(1));
    let quarters = (u64::from(m.wrapping_mul(word(0))) << 32)
        .wrapping_add(middle)
        .wrapping_add(low >> 32);
    let n = quarters.wrapping_add(1 << 61) >> 62;
    let rest = quarters.wrapping_sub(n << 62) as i64;
    let size = rest.unsigned_abs() | 1;
    let zeros = size.leading_zeros();
    let product = ((size << zeros) >> 32) * u64::from(HALF_PI);
    let more = product.leading_zeros() & 1;
    let angle = product << more;
    let near = ((angle >> 39) + 1) >> 1;
    let less = (near << 40).wrapping_sub(angle) as i64 >> 8;
    let unit = f32::from_bits(106u32.wrapping_sub(zeros).wrapping_sub(more) << 23);
    let (r, e) = (
        near as u32 as f32 * unit,
        less as i32 as f32 * (unit * 2.3283064e-10),
    );
    let turn = |y: f32, bits: u32| f32::from_bits(y.to_bits() ^ bits);
    let back = (rest < 0) as u32;
    let (sine, cosine) = sin_cos_reduced(
        n as u32,
        turn(r, back << 31),
        turn(e, back << 31),
    );
    (turn(sine, bits & 0x8000_0000), cosine)
}

/// Whether the processor has vectors of floats. On others the lanes without an angle of their own are left out.
const SIN_COS_VECTORS: bool = cfg!(
    any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128")
);

/// Sines and cosines of the first `count` of four angles, rad, all in one loop, which becomes vector instructions.
#[allow(clippy::all)]
#[inline(never)]
fn sin_cos_four(count: usize, a: f32, b: f32, c: f32, d: f32) -> ([f32; 4], [f32; 4]) {
    let (x, mut sines, mut cosines) = ([a, b, c, d], [0.0; 4], [0.0; 4]);
    let mut inside = true;
    let lanes = if SIN_COS_VECTORS { 4 } else { count.min(4) };
    for i in 0..lanes {
        (sines[i], cosines[i]) = sin_cos(x[i]);
        inside &= x[i].abs() <= SIN_COS_RANGE;
    }
    if inside { (sines, cosines) } else { sin_cos_each_of_four(a, b, c, d) }
}

/// The same where one of the angles is beyond `SIN_COS_RANGE`.
#[allow(clippy::all)]
#[cold]
#[inline(never)]
fn sin_cos_each_of_four(a: f32, b: f32, c: f32, d: f32) -> ([f32; 4], [f32; 4]) {
    let pairs = [a, b, c, d].map(sin_cos_one);
    (pairs.map(|pair| pair.0), pairs.map(|pair| pair.1))
}

/// Sines and cosines of the first `count` of eight angles, rad, all in one loop, which becomes vector instructions.
#[allow(clippy::all)]
#[inline(never)]
fn sin_cos_eight(
    count: usize,
    a: f32,
    b: f32,
    c: f32,
    d: f32,
    e: f32,
    f: f32,
    g: f32,
    h: f32,
) -> ([f32; 8], [f32; 8]) {
    let (x, mut sines, mut cosines) = ([a, b, c, d, e, f, g, h], [0.0; 8], [0.0; 8]);
    let mut inside = true;
    let lanes = if SIN_COS_VECTORS { 8 } else { count.min(8) };
    for i in 0..lanes {
        (sines[i], cosines[i]) = sin_cos(x[i]);
        inside &= x[i].abs() <= SIN_COS_RANGE;
    }
    if inside { (sines, cosines) } else { sin_cos_each_of_eight(a, b, c, d, e, f, g, h) }
}

/// The same where one of the angles is beyond `SIN_COS_RANGE`.
#[allow(clippy::all)]
#[cold]
#[inline(never)]
fn sin_cos_each_of_eight(
    a: f32,
    b: f32,
    c: f32,
    d: f32,
    e: f32,
    f: f32,
    g: f32,
    h: f32,
) -> ([f32; 8], [f32; 8]) {
    let pairs = [a, b, c, d, e, f, g, h].map(sin_cos_one);
    (pairs.map(|pair| pair.0), pairs.map(|pair| pair.1))
}
