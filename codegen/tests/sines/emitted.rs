//! The emitted text, unchanged from an emitted module.

pub(crate) mod f64 {
    include!("../../src/emit/rust/sincos/fast_f64.rs");

    pub(crate) const RANGE: f64 = SIN_COS_RANGE;

    pub(crate) fn one(x: f64) -> (f64, f64) {
        sin_cos_one(x)
    }

    #[allow(dead_code)] // The table of errors does without.
    pub(crate) fn each_alone(x: f64) -> (f64, f64) {
        (sin_one(x), cos_one(x))
    }

    #[allow(dead_code)] // The table of errors does without.
    pub(crate) fn four(count: usize, [a, b, c, d]: [f64; 4]) -> ([f64; 4], [f64; 4]) {
        sin_cos_four(count, a, b, c, d)
    }

    #[allow(dead_code)] // The table of errors does without.
    pub(crate) fn eight(count: usize, [a, b, c, d, e, f, g, h]: [f64; 8]) -> ([f64; 8], [f64; 8]) {
        sin_cos_eight(count, a, b, c, d, e, f, g, h)
    }
}

pub(crate) mod f32 {
    include!("../../src/emit/rust/sincos/fast_f32.rs");

    pub(crate) const RANGE: f32 = SIN_COS_RANGE;

    pub(crate) fn one(x: f32) -> (f32, f32) {
        sin_cos_one(x)
    }

    #[allow(dead_code)] // The table of errors does without.
    pub(crate) fn four([a, b, c, d]: [f32; 4]) -> ([f32; 4], [f32; 4]) {
        sin_cos_four(4, a, b, c, d)
    }

    #[allow(dead_code)] // The table of errors does without.
    pub(crate) fn eight([a, b, c, d, e, f, g, h]: [f32; 8]) -> ([f32; 8], [f32; 8]) {
        sin_cos_eight(8, a, b, c, d, e, f, g, h)
    }
}
