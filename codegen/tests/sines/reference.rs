//! Sine and cosine to more than 200 bits, in integers scaled by 2^320, and errors in units in the last place.
//!
//! x = n pi/2 + j/64 + t with |t| <= 1/128. A table holds the sines of j/64, Taylor's series gives the sines of t, and the addition theorem
//! joins them. pi/2 comes from Machin's formula. An angle too small for a resolution of 2^-320 has its own series, relative to the angle.

use dashu_int::ops::{Abs, BitTest, DivEuclid};
use dashu_int::IBig;

/// Fractional bits.
const BITS: usize = 320;
/// Below 2^-32 the series relative to the angle is used: three terms of it then hold 200 bits.
const SMALL: f64 = 1.0 / 4294967296.0;

/// mantissa 2^exponent
pub(crate) struct Exact {
    mantissa: IBig,
    exponent: isize,
}

/// A format by its bits of mantissa and the exponent of its smallest number.
#[derive(Clone, Copy)]
pub(crate) struct Format {
    bits: isize,
    smallest: isize,
}

pub(crate) const F64: Format = Format { bits: 53, smallest: -1074 };
pub(crate) const F32: Format = Format { bits: 24, smallest: -149 };

impl Format {
    pub(crate) fn is(self, other: Format) -> bool {
        self.bits == other.bits
    }

    /// A significand of this many bits, and any exponent.
    #[allow(dead_code)] // The table of errors does without.
    pub(crate) fn of_bits(bits: isize) -> Format {
        Format { bits, smallest: isize::MIN / 4 }
    }
}

impl Exact {
    fn of(x: f64) -> Exact {
        let (bits, raw) = (x.to_bits() & ((1 << 52) - 1), (x.to_bits() >> 52 & 0x7ff) as isize);
        let (mantissa, exponent) = if raw == 0 { (bits, -1074) } else { (bits | 1 << 52, raw - 1075) };
        let mantissa = IBig::from(mantissa);
        Exact { mantissa: if x.is_sign_negative() { -mantissa } else { mantissa }, exponent }
    }

    /// How far a float is from this number, in units in the last place of the number.
    pub(crate) fn ulps(&self, computed: f64, format: Format) -> f64 {
        let Exact { mantissa, exponent } = Exact::of(computed);
        self.ulps_of(&mantissa, exponent, format)
    }

    /// The same of mantissa 2^exponent.
    pub(crate) fn ulps_of(&self, mantissa: &IBig, exponent: isize, format: Format) -> f64 {
        let top = bit_length(&self.mantissa) + self.exponent;
        let unit = (top - format.bits).max(format.smallest);
        let common = exponent.min(self.exponent);
        let difference = (mantissa << (exponent - common) as usize) - (&self.mantissa << (self.exponent - common) as usize);
        // 40 bits of the fraction are enough of it.
        let shift = unit - common - 40;
        let scaled = if shift >= 0 { difference >> shift as usize } else { difference << (-shift) as usize };
        scaled.to_f64().value().abs() / (1u64 << 40) as f64
    }
}

fn bit_length(x: &IBig) -> isize {
    x.clone().abs().bit_len() as isize
}

/// The reference and its table.
pub(crate) struct Reference {
    half_pi: IBig,
    table: Vec<(IBig, IBig)>,
}

impl Reference {
    pub(crate) fn new() -> Reference {
        // pi/4 = 4 arctan 1/5 - arctan 1/239
        let half_pi = (8 * inverse_tangent(5) - 2 * inverse_tangent(239)) >> GUARD;
        let table = (0..=52).map(|j| series(&(IBig::from(j) << (BITS - 6)))).collect();
        Reference { half_pi, table }
    }

    /// Sine and cosine of a finite angle other than zero, |x| < 2^128; beyond 1 every power of two costs a bit.
    pub(crate) fn sin_cos(&self, x: f64) -> (Exact, Exact) {
        let Exact { mantissa, exponent } = Exact::of(x);
        if x.abs() < SMALL {
            // sin x = x (1 - z/6 + z^2/120 - ...), cos x = 1 - z/2 + z^2/24 - ..., z = x^2
            let shift = 2 * exponent + BITS as isize;
            let square: IBig = &mantissa * &mantissa;
            let z = if shift >= 0 { square << shift as usize } else { square >> (-shift) as usize };
            let zz: IBig = (&z * &z) >> BITS;
            let sine = mantissa * (one() - &z / 6 + &zz / 120);
            return (Exact { mantissa: sine, exponent: exponent - BITS as isize }, fixed(one() - z / 2 + zz / 24));
        }
        let shift = BITS as isize + exponent;
        let angle = mantissa << usize::try_from(shift).expect("an angle above 2^-32 is a multiple of 2^-320");
        let nearest: IBig = &angle + (&self.half_pi >> 1);
        let n = nearest.div_euclid(&self.half_pi);
        let rest: IBig = angle - &n * &self.half_pi;
        let j = usize::try_from((rest.clone().abs() + (one() >> 7)) >> (BITS - 6)).expect("at most 52/64");
        let t = rest.clone().abs() - (IBig::from(j) << (BITS - 6));
        let ((sj, cj), (st, ct)) = (&self.table[j], series(&t));
        let sine: IBig = (sj * &ct + cj * &st) >> BITS;
        let cosine: IBig = (cj * ct - sj * st) >> BITS;
        let sine = if rest < IBig::ZERO { -sine } else { sine };
        let quadrant = u8::try_from(n & IBig::from(3)).expect("0 to 3");
        let (sine, cosine) = match quadrant {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        };
        (fixed(sine), fixed(cosine))
    }
}

fn one() -> IBig {
    IBig::ONE << BITS
}

fn fixed(mantissa: IBig) -> Exact {
    Exact { mantissa, exponent: -(BITS as isize) }
}

/// More bits while pi is formed.
const GUARD: usize = 64;

/// arctan 1/n = 1/n - 1/(3 n^3) + ...
fn inverse_tangent(n: i64) -> IBig {
    let mut power = (one() << GUARD) / n;
    let (mut sum, mut k) = (IBig::ZERO, 0i64);
    while power != IBig::ZERO {
        let term = &power / (2 * k + 1);
        sum = if k % 2 == 0 { sum + term } else { sum - term };
        power /= n * n;
        k += 1;
    }
    sum
}

/// Taylor's series of sine and cosine.
fn series(t: &IBig) -> (IBig, IBig) {
    let (mut sine, mut cosine) = (IBig::ZERO, IBig::ZERO);
    let (mut term, mut k) = (one(), 0i64);
    while term != IBig::ZERO && term != IBig::NEG_ONE {
        match k % 4 {
            0 => cosine += &term,
            1 => sine += &term,
            2 => cosine -= &term,
            _ => sine -= &term,
        }
        k += 1;
        term = ((term * t) >> BITS) / k;
    }
    (sine, cosine)
}
