//! The emitted text, as it stands in an emitted module.

pub(crate) mod f64 {
    include!("../../src/emit/sincos/fast_f64.rs");

    pub(crate) const RANGE: f64 = SIN_COS_RANGE;

    pub(crate) fn all<const N: usize>(x: [f64; N]) -> ([f64; N], [f64; N]) {
        sin_cos_all(&x)
    }

    #[allow(dead_code)] // The table of errors does without.
    pub(crate) fn few<const N: usize>(x: [f64; N]) -> ([f64; N], [f64; N]) {
        sin_cos_few(&x)
    }
}

pub(crate) mod f32 {
    include!("../../src/emit/sincos/fast_f32.rs");

    pub(crate) const RANGE: f32 = SIN_COS_RANGE;

    pub(crate) fn all<const N: usize>(x: [f32; N]) -> ([f32; N], [f32; N]) {
        sin_cos_all(&x)
    }

    #[allow(dead_code)] // The table of errors does without.
    pub(crate) fn few<const N: usize>(x: [f32; N]) -> ([f32; N], [f32; N]) {
        sin_cos_few(&x)
    }
}
