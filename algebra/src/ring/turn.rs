//! A constant angle that adds to a joint variable.
//!
//! The axes of a link may be turned by any constant angle about its joint axis; the joint angle is then q + phi. Its sine and cosine are
//! inputs as those of q are ([`super::AngleSum`]), with sin(q + phi) = sin q cos phi + cos q sin phi. Here phi is the angle of a point with
//! rational coordinates,
//!
//! ```text
//! phi = angle of (x, y),   cos phi = x / sqrt(x² + y²),   sin phi = y / sqrt(x² + y²)
//! ```
//!
//! so that its sine and cosine are exact constants that a field with that root knows.

use crate::exact::{Number, Rational};

/// A constant angle with its sine and cosine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Turn {
    /// The angle, rad.
    pub angle: Number,
    /// Its sine.
    pub sine: Number,
    /// Its cosine.
    pub cosine: Number,
}

impl Turn {
    /// The angle from the x axis to a point; none of the origin.
    pub fn towards(x: &Rational, y: &Rational) -> Option<Turn> {
        let distance = Number::from(x * x + y * y).sqrt()?;
        let part = |coordinate: &Rational| Number::from(coordinate.clone()).checked_div(&distance);
        Some(Turn { angle: Number::angle_of(x, y), sine: part(y)?, cosine: part(x)? })
    }

    /// Sine and cosine of a + phi from those of a.
    pub fn after(&self, sine: &Number, cosine: &Number) -> (Number, Number) {
        (&(sine * &self.cosine) + &(cosine * &self.sine), &(cosine * &self.cosine) - &(sine * &self.sine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_those_of_the_angle() {
        for (x, y) in [(3, 4), (-1, 2), (5, -3), (-2, -7), (1, 1), (0, -2), (-3, 0)] {
            let turn = Turn::towards(&Rational::from(x), &Rational::from(y)).expect("not the origin");
            let angle = turn.angle.to_f64();
            assert!((angle - f64::from(y).atan2(f64::from(x))).abs() < 1e-15, "{x} {y}: {}", turn.angle);
            assert!((angle.sin() - turn.sine.to_f64()).abs() < 1e-15 && (angle.cos() - turn.cosine.to_f64()).abs() < 1e-15);
            let (zero, one) = turn.after(&-&turn.sine, &turn.cosine);
            assert!(zero.is_zero() && one.is_one(), "back by the angle and on by it");
        }
        assert_eq!(Turn::towards(&Rational::ZERO, &Rational::ZERO), None);
    }
}
