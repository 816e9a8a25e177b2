//! What several tests need: random numbers with a fixed seed, and each test in both scalars.
#![allow(dead_code, unreachable_pub)]

/// SplitMix64 (Steele, Lea, Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Uniform in [-pi, pi).
    pub fn angle(&mut self) -> f64 {
        self.between(-std::f64::consts::PI, std::f64::consts::PI)
    }

    /// Uniform in 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
}

/// The same items with every block's names in double and in single precision.
#[macro_export]
macro_rules! in_both_scalars {
    ($($item:item)*) => {
        #[allow(clippy::unnecessary_cast)]
        mod double {
            #[allow(unused_imports)]
            use armgen_inverse_kinematics::f64::*;
            #[allow(unused_imports)]
            use $crate::common::Random;
            $($item)*
        }
        #[allow(clippy::unnecessary_cast)]
        mod single {
            #[allow(unused_imports)]
            use armgen_inverse_kinematics::f32::*;
            #[allow(unused_imports)]
            use $crate::common::Random;
            $($item)*
        }
    };
}
