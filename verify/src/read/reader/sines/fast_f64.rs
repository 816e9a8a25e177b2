/// Largest |angle|, rad, whose sine this module computes itself.
const SIN_COS_RANGE: f64 = 65536.0;

/// x = n pi/2 + r - e, |x| <= `SIN_COS_RANGE`: a number whose two lowest bits are those of n, then r and e. n is the integer nearest to 2x/pi or, by
/// rounding next to a tie, the one beside it; |r| exceeds pi/4 by at most 1e-11.
///
/// After Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two have 37 bits. Their products with n are exact, and so is x
/// less the first; e holds the third product less what r rounds away.
#[allow(clippy::all)]
#[inline(always)]
fn sin_cos_quadrant(x: f64) -> (u64, f64, f64) {
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
    let first = x - n * HALF_PI[0];
    let step = n * HALF_PI[1];
    let r = first - step;
    (shifted.to_bits(), r, n * HALF_PI[2] - ((first - r) - step))
}

/// P and -Q of sin r = r - r^3 P(r^2) and cos r = 1 - r^2/2 + r^4 Q(r^2), from the lowest coefficient: minimax on |r| <= pi/4 (Remez), relative errors
/// of sine and cosine 2^-57.
const SIN_COS_POLYNOMIALS: [[f64; 2]; 6] = [
    [0.1666666666666663, -0.0416666666666666],
    [-0.008333333333322035, 0.0013888888888873453],
    [0.00019841269829660063, -2.4801587287964484e-5],
    [-2.7557313668040543e-6, 2.7557313594775254e-7],
    [2.5050756282937577e-8, -2.087558805713208e-9],
    [-1.5896732662311403e-10, 1.1351822784169523e-11],
];

/// P(z) for k = 0, -Q(z) for k = 1; zz = z^2.
#[allow(clippy::all)]
#[inline(always)]
fn sin_cos_polynomial(k: usize, z: f64, zz: f64) -> f64 {
    const A: [[f64; 2]; 6] = SIN_COS_POLYNOMIALS;
    (A[0][k] + z * A[1][k])
        + zz * ((A[2][k] + z * A[3][k]) + zz * (A[4][k] + z * A[5][k]))
}

/// sin (r - e) = r - (e (1 - r^2/2) + r^3 P) and cos (r - e) = 1 - r^2/2 + (r e + r^4 Q), where e is so small beside r that no more of it shows. The
/// rounding error of 1 - r^2/2 is added to the terms that follow.
///
/// `q` has the bits of -`sin_cos_polynomial(1, z, zz)`. Two of its additions are written as subtractions: LLVM would compute two polynomials with
/// the same operations side by side in a vector of two, which takes longer.
#[allow(clippy::all)]
#[inline(always)]
fn sin_cos_of_rest(r: f64, e: f64) -> (f64, f64) {
    const A: [[f64; 2]; 6] = SIN_COS_POLYNOMIALS;
    let z = r * r;
    let zz = z * z;
    let half = 0.5 * z;
    let near = 1.0 - half;
    let sine = r - (e * near + (z * r) * sin_cos_polynomial(0, z, zz));
    let q = (-A[0][1] - z * A[1][1])
        - zz * ((A[2][1] + z * A[3][1]) + zz * (A[4][1] + z * A[5][1]));
    (sine, near + ((((1.0 - near) - half) + r * e) + zz * q))
}

/// Sine and cosine of an angle, |x| <= `SIN_COS_RANGE`, each within 1 unit in the last place; the sine of -0 is -0. Without branches, so that a loop
/// over angles becomes vector instructions, and without fused multiply-add: the same bits wherever f64 rounds to nearest by IEEE 754.
///
/// The two lowest bits of n say which of the two is the sine, and the signs.
#[allow(clippy::all)]
#[inline(always)]
fn sin_cos(x: f64) -> (f64, f64) {
    let (n, r, e) = sin_cos_quadrant(x);
    let (sine, cosine) = sin_cos_of_rest(r, e);
    let exchange = (sine.to_bits() ^ cosine.to_bits()) & 0u64.wrapping_sub(n & 1);
    let sine_sign = (n & 2) << 62;
    let cosine_sign = (n.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(sine.to_bits() ^ exchange ^ sine_sign),
        f64::from_bits(cosine.to_bits() ^ exchange ^ cosine_sign),
    )
}

/// cos (n pi/2) and sin (n pi/2) by the two lowest bits of n. The zero of the first row has to be -0: the sine of x = -0 is -0 + cos (0) (-0) = -0.
const SIN_COS_QUADRANTS: [[f64; 2]; 4] = [
    [1.0, -0.0],
    [-0.0, 1.0],
    [-1.0, -0.0],
    [-0.0, -1.0],
];

/// Sine and cosine of an angle in rad, each within 1 unit in the last place for |x| <= `SIN_COS_RANGE`: by the theorems of addition, in which
/// products with 0, 1 and -1 are exact. The bits are those of a loop over several angles, which exchanges sine and cosine as integers; of one angle
/// they would have to be moved to integer registers and back.
#[allow(clippy::all)]
#[inline]
fn sin_cos_one(x: f64) -> (f64, f64) {
    if x.abs() <= SIN_COS_RANGE {
        let (n, r, e) = sin_cos_quadrant(x);
        let (sine, cosine) = sin_cos_of_rest(r, e);
        let [c, s] = SIN_COS_QUADRANTS[(n & 3) as usize];
        (sine * c + cosine * s, cosine * c - sine * s)
    } else {
        sin_cos_beyond(x)
    }
}

/// Sine of an angle in rad, with the bits of `sin_cos_one`.
#[allow(clippy::all)]
#[inline]
fn sin_one(x: f64) -> f64 {
    if x.abs() <= SIN_COS_RANGE {
        let (n, r, e) = sin_cos_quadrant(x);
        sin_alone(n, r, e)
    } else {
        sin_cos_beyond(x).0
    }
}

/// Cosine of an angle in rad, with the bits of `sin_cos_one`.
#[allow(clippy::all)]
#[inline]
fn cos_one(x: f64) -> f64 {
    if x.abs() <= SIN_COS_RANGE {
        let (n, r, e) = sin_cos_quadrant(x);
        sin_alone(n.wrapping_add(1), r, e)
    } else {
        sin_cos_beyond(x).1
    }
}

/// sin (n pi/2 + r - e) by one polynomial, whose coefficients are chosen by the lowest bit of n: no branch depends on the quadrant.
///
/// With c = cos (n pi/2) and s = sin (n pi/2), of which one is 0 and the other 1 or -1, it is c sin (r - e) + s cos (r - e). Products with c and s
/// are exact and a sum with 0 changes nothing, so that each operation rounds as in `sin_cos_of_rest`.
#[allow(clippy::all)]
#[inline(always)]
fn sin_alone(n: u64, r: f64, e: f64) -> f64 {
    let [c, s] = SIN_COS_QUADRANTS[(n & 3) as usize];
    let z = r * r;
    let p = sin_cos_polynomial((n & 1) as usize, z, z * z);
    let half = 0.5 * z;
    let near = 1.0 - half;
    let small = (half - (1.0 - near)) * s - e * (r * s - near * c);
    (r * c + near * s) - (small + (z * (r * c + z * s)) * p)
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
