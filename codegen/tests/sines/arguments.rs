//! Ranges of angles, each with its arguments.

use super::reference::{Format, F32};

/// Numbers without a pattern (Vigna's SplitMix64), the same in every run.
pub(crate) struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [-1, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A range of angles.
#[derive(Clone, Copy)]
pub(crate) enum Range {
    /// |x| log-uniform between these powers of two.
    Logarithmic(f64, f64),
    /// Uniform in [-x, x].
    Uniform(f64),
    /// The floats next to every multiple of pi/2 up to this angle.
    Multiples(f64),
}

pub(crate) const QUARTER_PI: f64 = std::f64::consts::FRAC_PI_4;

/// The ranges measured, for a format and its largest angle.
pub(crate) fn ranges(smallest: f64, largest: f64) -> Vec<(String, Range)> {
    let power = largest.log2();
    vec![
        (format!("near 0: log-uniform, 2^{smallest} to 2^-10"), Range::Logarithmic(smallest, -10.0)),
        ("uniform, to pi/4".into(), Range::Uniform(QUARTER_PI)),
        ("uniform, to pi".into(), Range::Uniform(4.0 * QUARTER_PI)),
        (format!("uniform, to 2^{power}"), Range::Uniform(largest)),
        (format!("log-uniform, 2^-10 to 2^{power}"), Range::Logarithmic(-10.0, power)),
        (format!("next to every multiple of pi/2 to 2^{power}"), Range::Multiples(largest)),
    ]
}

impl Range {
    /// About `count` arguments, floats of the format.
    pub(crate) fn arguments(self, count: usize, largest: f64, format: Format) -> Vec<f64> {
        let single = format.is(F32);
        let mut random = Random(1);
        let round = |x: f64| if single { f64::from(x as f32) } else { x };
        let inside = |x: &f64| *x != 0.0 && x.abs() <= largest;
        match self {
            Range::Logarithmic(low, high) => (0..count)
                .map(|_| {
                    let (exponent, sign) = ((random.unit() + 1.0) / 2.0, random.unit());
                    round((low + (high - low) * exponent).exp2().copysign(sign))
                })
                .filter(inside)
                .collect(),
            Range::Uniform(limit) => (0..count).map(|_| round(limit * random.unit())).filter(inside).collect(),
            Range::Multiples(limit) => {
                let multiples = (limit / (2.0 * QUARTER_PI)).floor() as usize;
                let each = count.div_ceil(2 * multiples).max(2) as i64;
                let near = |n: usize| {
                    // The nearest floats: n pi/2 in f64 is off by 3 of them at most.
                    let multiple = n as f64 * (2.0 * QUARTER_PI);
                    (-each..each).map(move |k| {
                        if single {
                            f64::from(f32::from_bits(((multiple as f32).to_bits() as i64 + k) as u32))
                        } else {
                            f64::from_bits((multiple.to_bits() as i64 + k) as u64)
                        }
                    })
                };
                (1..=multiples).flat_map(near).filter(inside).enumerate().map(|(i, x)| if i % 2 == 0 { x } else { -x }).collect()
            }
        }
    }
}
