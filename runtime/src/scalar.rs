//! Functions computed in the precision of the scalar: f32 in f32 and in integers, so that a processor without f64 does it in hardware.
//!
//! `libm` computes f32 sines by way of f64, and so does the standard library with times.

mod sines;

use crate::linalg::{lit, to_f64};
use core::time::Duration;
use nalgebra::RealField;

const NANOSECONDS: u64 = 1_000_000_000;

/// Whether the scalar is f32; known when compiled.
#[inline(always)]
fn is_single<T: RealField>() -> bool {
    T::default_epsilon() == lit(f64::from(f32::EPSILON))
}

/// Sine and cosine of an angle, rad, within 1 unit in the last place; the same bits everywhere.
#[inline]
pub(crate) fn sin_cos<T: RealField + Copy>(x: T) -> (T, T) {
    if is_single::<T>() {
        let (sine, cosine) = sines::sin_cos_one(nalgebra::convert_unchecked(x));
        (nalgebra::convert(sine), nalgebra::convert(cosine))
    } else {
        x.sin_cos()
    }
}

/// Seconds of a duration: in f64 rounded once, in f32 within 1 unit in the last place.
#[inline]
pub(crate) fn seconds<T: RealField>(t: Duration) -> T {
    if !is_single::<T>() {
        return lit(t.as_secs_f64());
    }
    let nanoseconds = t.as_secs().checked_mul(NANOSECONDS).and_then(|n| n.checked_add(t.subsec_nanos().into()));
    let seconds: f32 = match nanoseconds {
        Some(n) => n as f32 / NANOSECONDS as f32,
        None => t.as_secs() as f32,
    };
    nalgebra::convert(seconds)
}

/// The nearest duration; `None` for a time that is negative, not finite or too long. Not inlined: a program holds it once, not at
/// every call of a plan.
#[inline(never)]
pub(crate) fn duration<T: RealField>(seconds: T) -> Option<Duration> {
    if is_single::<T>() {
        Duration::try_from_secs_f32(nalgebra::try_convert(seconds)?).ok()
    } else {
        Duration::try_from_secs_f64(to_f64(seconds)?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_of_f32_are_within_an_ulp_of_those_of_f64() {
        for k in 0..200_000u32 {
            // From the smallest to the largest, both signs.
            let x = f32::from_bits(k.wrapping_mul(2_654_435_761));
            if !x.is_finite() {
                continue;
            }
            let ((s, c), (sine, cosine)) = (sin_cos(x), sin_cos(f64::from(x)));
            for (of_f32, of_f64) in [(s, sine), (c, cosine)] {
                let ulp = f64::from((of_f64.abs() as f32).next_up() - of_f64.abs() as f32).max(f64::from(f32::from_bits(1)));
                assert!((f64::from(of_f32) - of_f64).abs() <= ulp, "{x:e}: {of_f32:e}, {of_f64:e}");
            }
        }
        assert!(sin_cos(f32::INFINITY).0.is_nan() && sin_cos(f32::NAN).1.is_nan());
    }

    #[test]
    fn sines_of_f64_are_those_of_libm() {
        for x in [0.0, -0.3, 1e5, 1e22] {
            assert_eq!(sin_cos::<f64>(x), libm::sincos(x));
        }
    }

    #[test]
    fn seconds_of_f32_are_within_an_ulp() {
        for n in [0, 1, 999_999_999, 1_000_000_000, 16_777_217, 123_456_789_012, u64::MAX] {
            let (t, exact) = (Duration::from_nanos(n), Duration::from_nanos(n).as_secs_f64());
            let s: f32 = seconds(t);
            assert!((f64::from(s) - exact).abs() <= f64::from(f32::EPSILON) * exact, "{t:?}: {s}");
            assert_eq!(duration(s), Duration::try_from_secs_f64(s.into()).ok());
        }
        assert_eq!(seconds::<f32>(Duration::MAX), u64::MAX as f32);
        assert_eq!((duration(-1.0f32), duration(f32::NAN), duration(f32::INFINITY)), (None, None, None));
    }
}
