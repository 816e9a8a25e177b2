//! The elementary functions of emitted modules: vectorised sines and cosines, and the exponential of Stribeck friction.
//!
//! Each is one file of plain Rust. This crate compiles the files for both scalars ([`f64`](mod@f64), [`f32`](mod@f32)); a generator takes the same
//! files as text ([`texts`]) into its modules. So a program that is executed here has the bits of an emitted module.

#![no_std]

/// The files as text.
pub mod texts {
    /// Sine and cosine in double precision.
    pub const FAST_F64: &str = include_str!("fast_f64.rs");
    /// Sine and cosine in single precision.
    pub const FAST_F32: &str = include_str!("fast_f32.rs");
    /// The exponential, over an alias `Real`.
    pub const STRIBECK: &str = include_str!("stribeck.rs");
}

macro_rules! compiled {
    ($real:ident, $file:literal) => {
        #[allow(dead_code, clippy::excessive_precision)]
        mod text {
            type Real = $real;
            include!($file);
            include!("stribeck.rs");

            /// Largest |x|, rad, for which [`sin_cos_within`] holds.
            pub const RANGE: Real = SIN_COS_RANGE;

            /// (sin x, cos x) of |x| <= [`RANGE`] rad, each within 1 unit in the last place; of other angles any numbers. It has no branch, so a
            /// loop over angles becomes vector instructions.
            #[inline(always)]
            pub fn sin_cos_within(x: Real) -> (Real, Real) {
                sin_cos(x)
            }

            /// (sin x, cos x) of any angle, rad, with the bits of [`sin_cos_within`] up to [`RANGE`]; not numbers for what is infinite or not a
            /// number.
            #[inline]
            pub fn sin_cos_of_any(x: Real) -> (Real, Real) {
                sin_cos_one(x)
            }

            /// exp(-|rate| / velocity), within 2 units of roundoff; 0 below 1e-17.
            #[inline]
            pub fn fading(rate: Real, velocity: Real) -> Real {
                stribeck(rate, velocity)
            }
        }
        pub use text::{fading, sin_cos_of_any, sin_cos_within, RANGE};
    };
}

/// In double precision.
pub mod f64 {
    compiled!(f64, "fast_f64.rs");
}

/// In single precision.
pub mod f32 {
    compiled!(f32, "fast_f32.rs");
}
