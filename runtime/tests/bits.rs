//! Elementary functions come from libm whatever else the build enables, with the same bits on a host and on a microcontroller.

use armgen_runtime::simulation::Noise;
use nalgebra::{ComplexField, RealField};

/// All functions that the crate calls through nalgebra, at `x`: from nalgebra, and from libm.
fn both(x: f64) -> [(f64, f64); 9] {
    let y = x.abs() + 1e-3;
    [
        (ComplexField::sin(x), libm::sin(x)),
        (ComplexField::cos(x), libm::cos(x)),
        (ComplexField::sin_cos(x).0, libm::sincos(x).0),
        (RealField::atan2(x, y), libm::atan2(x, y)),
        (ComplexField::sqrt(y), libm::sqrt(y)),
        (ComplexField::cbrt(y), libm::cbrt(y)),
        (ComplexField::ln(y), libm::log(y)),
        (ComplexField::powf(y, -0.2), libm::pow(y, -0.2)),
        (ComplexField::hypot(x, y), libm::hypot(x, y)),
    ]
}

#[test]
fn double_precision() {
    let mut noise = Noise::new(1);
    for _ in 0..100_000 {
        let x = 10.0 * noise.normal();
        for (i, (found, expected)) in both(x).into_iter().enumerate() {
            assert_eq!(found.to_bits(), expected.to_bits(), "function {i} at {x}");
        }
    }
}

#[test]
fn single_precision() {
    let mut noise = Noise::new(2);
    for _ in 0..100_000 {
        let x = 10.0 * noise.normal() as f32;
        assert_eq!(ComplexField::sin(x).to_bits(), libm::sinf(x).to_bits());
        assert_eq!(ComplexField::cos(x).to_bits(), libm::cosf(x).to_bits());
        assert_eq!(RealField::atan2(x, 1.5).to_bits(), libm::atan2f(x, 1.5).to_bits());
        assert_eq!(ComplexField::sqrt(x.abs()).to_bits(), libm::sqrtf(x.abs()).to_bits());
    }
}
