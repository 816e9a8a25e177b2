//! Time laws: s(t) from 0 to 1.
//!
//! Trapezoidal speed with duration T and acceleration time t_c, for a path of length L:
//!
//! ```text
//! v = L / (T - t_c),  a = v / t_c
//! s = 1/2 t^2 / (t_c (T - t_c))              0 <= t < t_c
//!   = (t - t_c / 2) / (T - t_c)              t_c <= t < T - t_c
//!   = 1 - 1/2 (T - t)^2 / (t_c (T - t_c))    T - t_c <= t < T           (the book, Sect. 4.2.1, eq. 4.8)
//! ```
//!
//! Given T and a, t_c = T/2 - sqrt(T^2/4 - L/a) (eq. 4.6), here (L/a) / (T/2 + sqrt(T^2/4 - L/a)), without cancellation. Given T
//! and v, t_c = T - L/v (eq. 4.10). Given limits of v and a, the shortest trapezoid has t_c = v/a and T = L/v + t_c. Where L <
//! v^2/a it is a triangle, t_c = sqrt(L/a), T = 2 t_c.
//!
//! Polynomials are taken from the nearer end, with y = 1 - x: s = 1 - y^2 (3 - 2 y) and 1 - y^3 (10 - 15 y + 6 y^2) beyond the middle.

use super::{chain::span, PlanFault};
use crate::linalg::lit;
use crate::scalar::{duration, seconds};
use core::time::Duration;
use nalgebra::RealField;

/// A time law as requested; lengths in m for paths, rad for turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeLaw<T> {
    /// Trapezoidal speed of this duration and acceleration time (the deceleration takes as long).
    Trapezoidal {
        /// Duration T.
        duration: Duration,
        /// Acceleration time t_c, at most T/2.
        acceleration_time: Duration,
    },
    /// Trapezoidal speed of this duration and acceleration, |a| >= 4 L / T^2.
    TrapezoidalByAcceleration {
        /// Duration T.
        duration: Duration,
        /// Acceleration along the path.
        acceleration: T,
    },
    /// Trapezoidal speed of this duration and cruise velocity, L / T < |v| <= 2 L / T.
    TrapezoidalByVelocity {
        /// Duration T.
        duration: Duration,
        /// Velocity along the path.
        velocity: T,
    },
    /// The shortest trapezoidal (or triangular) speed within these limits.
    TrapezoidalByLimits {
        /// Greatest velocity along the path.
        velocity: T,
        /// Greatest acceleration along the path.
        acceleration: T,
    },
    /// s = 3 x^2 - 2 x^3 with x = t / T: continuous velocity, zero at both ends (the book, Sect. 4.2.1).
    Cubic {
        /// Duration T.
        duration: Duration,
    },
    /// s = 10 x^3 - 15 x^4 + 6 x^5 with x = t / T: continuous acceleration, velocity and acceleration zero at both ends.
    Quintic {
        /// Duration T.
        duration: Duration,
    },
}

/// A time law that can be run: what [`TimeLaw::resolve`] makes of a request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile<T> {
    duration: Duration,
    shape: Shape<T>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape<T> {
    /// Nothing moves.
    Rest,
    /// `slow` = T - t_c, when deceleration begins; `speed` = 1 / (T - t_c); `rise` = 1 / (t_c (T - t_c)).
    Trapezoid {
        rise_time: Duration,
        slow: Duration,
        half_rise_time: T,
        speed: T,
        rise: T,
    },
    Cubic(T),
    Quintic(T),
}

/// s and its derivatives at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<T> {
    /// s, from 0 to 1.
    pub s: T,
    /// ds/dt, 1/s.
    pub ds: T,
    /// d2s/dt2, 1/s^2.
    pub dds: T,
}

impl<T: RealField + Copy> TimeLaw<T> {
    /// The law for a path of this length, m, or a turn of this angle, rad; its sign does not count.
    ///
    /// Where the length is zero nothing moves for the duration asked for, whatever the law, and for no time where limits are given.
    ///
    /// # Errors
    /// Where a number is not finite (a limit of velocity may be infinite), or no such law exists; the fault gives the reason.
    pub fn resolve(&self, length: T) -> Result<Profile<T>, PlanFault> {
        if !length.is_finite() {
            return Err(PlanFault::NotFinite);
        }
        let length = length.abs();
        let still = length == T::zero();
        let finite = |x: T| if x.is_finite() { Ok(x) } else { Err(PlanFault::NotFinite) };
        let positive = |x: T, fault| finite(x).and_then(|x| if x > T::zero() { Ok(x) } else { Err(fault) });
        match *self {
            TimeLaw::Trapezoidal { duration, .. } | TimeLaw::Cubic { duration } | TimeLaw::Quintic { duration } if still => {
                Ok(Profile::rest(duration))
            }
            TimeLaw::Trapezoidal { duration, acceleration_time } => trapezoid(duration, acceleration_time),
            TimeLaw::TrapezoidalByAcceleration { duration: t, acceleration } => {
                let a = finite(acceleration.abs())?;
                if still {
                    return Ok(Profile::rest(t));
                }
                if a == T::zero() {
                    return Err(PlanFault::AccelerationTooSmall);
                }
                let half = seconds::<T>(t) * lit(0.5);
                // A margin of a few roundings: a = 4 L / T^2 itself, the triangle, is allowed.
                let (square, rest) = (half * half, length / a);
                if rest > square * (T::one() + T::default_epsilon() * lit(8.0)) {
                    return Err(PlanFault::AccelerationTooSmall);
                }
                let under_root = (square - rest).max(T::zero());
                let t_c = duration(rest / (half + under_root.sqrt())).ok_or(PlanFault::AccelerationTooSmall)?;
                trapezoid(t, t_c.min(t / 2))
            }
            TimeLaw::TrapezoidalByVelocity { duration: t, velocity } => {
                let v = finite(velocity.abs())?;
                if still {
                    return Ok(Profile::rest(t));
                }
                let whole = seconds::<T>(t);
                // A margin of a few roundings: v = 2 L / T itself, the triangle, is allowed.
                let margin = T::one() + T::default_epsilon() * lit(8.0);
                if v * whole <= length || v * whole > lit::<T>(2.0) * length * margin {
                    return Err(PlanFault::VelocityOutOfRange);
                }
                let t_c = duration(whole - length / v).ok_or(PlanFault::VelocityOutOfRange)?;
                trapezoid(t, t_c.min(t / 2))
            }
            TimeLaw::TrapezoidalByLimits { velocity, acceleration } => {
                // No limit of velocity is no fault: the law is then a triangle.
                let v = if velocity > T::one() { velocity } else { positive(velocity, PlanFault::LimitNotPositive)? };
                let a = positive(acceleration, PlanFault::LimitNotPositive)?;
                if still {
                    return Ok(Profile::rest(Duration::ZERO));
                }
                let (t_c, cover) = if length * a < v * v {
                    let t_c = (length / a).sqrt();
                    (t_c, t_c)
                } else {
                    // Where L = v^2/a they are equal, and rounding must not make the cruise time negative.
                    let t_c = v / a;
                    (t_c, (length / v).max(t_c))
                };
                // A few roundings of the scalar and one nanosecond more than the nearest: the limits are kept after rounding, too.
                let margin = T::one() + T::default_epsilon() * lit(4.0);
                let up =
                    |x: T| duration(x * margin).and_then(|d| d.checked_add(Duration::from_nanos(1))).ok_or(PlanFault::TooLong);
                let (t_c, cover) = (up(t_c)?, up(cover)?);
                trapezoid(t_c.checked_add(cover).ok_or(PlanFault::TooLong)?, t_c)
            }
            TimeLaw::Cubic { duration } if duration > Duration::ZERO => {
                Ok(Profile { duration, shape: Shape::Cubic(seconds(duration)) })
            }
            TimeLaw::Quintic { duration } if duration > Duration::ZERO => {
                Ok(Profile { duration, shape: Shape::Quintic(seconds(duration)) })
            }
            TimeLaw::Cubic { .. } | TimeLaw::Quintic { .. } => Err(PlanFault::NoDuration),
        }
    }
}

fn trapezoid<T: RealField + Copy>(duration: Duration, rise_time: Duration) -> Result<Profile<T>, PlanFault> {
    if duration.is_zero() {
        return Err(PlanFault::NoDuration);
    }
    if rise_time.is_zero() {
        return Err(PlanFault::NoAccelerationTime);
    }
    let Some(slow) = span(rise_time, duration).filter(|slow| *slow >= rise_time) else {
        return Err(PlanFault::CruiseTimeNegative);
    };
    let (t_c, cover) = (seconds::<T>(rise_time), seconds::<T>(slow));
    let shape = Shape::Trapezoid {
        rise_time,
        slow,
        half_rise_time: t_c * lit(0.5),
        speed: T::one() / cover,
        rise: T::one() / (t_c * cover),
    };
    Ok(Profile { duration, shape })
}

impl<T: RealField + Copy> Profile<T> {
    /// A law under which nothing moves.
    pub fn rest(duration: Duration) -> Self {
        Self { duration, shape: Shape::Rest }
    }

    /// Duration T.
    pub fn duration(&self) -> Duration {
        self.duration
    }

    /// s, ds/dt and d2s/dt2 at time `t` from the start of the law; after its end s = 1 and nothing moves.
    ///
    /// At a corner the acceleration is that of the phase that begins.
    #[inline]
    pub fn at(&self, t: Duration) -> Progress<T> {
        let (zero, one, half) = (T::zero(), T::one(), lit::<T>(0.5));
        let Some(rest) = span(t, self.duration).filter(|rest| !rest.is_zero()) else {
            return Progress { s: one, ds: zero, dds: zero };
        };
        match self.shape {
            Shape::Rest => Progress { s: zero, ds: zero, dds: zero },
            Shape::Trapezoid { rise_time, slow, half_rise_time, speed, rise } => {
                if t < rise_time {
                    let t = seconds::<T>(t);
                    Progress { s: half * rise * t * t, ds: rise * t, dds: rise }
                } else if t < slow {
                    Progress { s: (seconds::<T>(t) - half_rise_time) * speed, ds: speed, dds: zero }
                } else {
                    let rest = seconds::<T>(rest);
                    Progress { s: one - half * rise * rest * rest, ds: rise * rest, dds: -rise }
                }
            }
            Shape::Cubic(whole) => {
                let (x, y) = (seconds::<T>(t) / whole, seconds::<T>(rest) / whole);
                let near = |x: T| x * x * (lit::<T>(3.0) - lit::<T>(2.0) * x);
                Progress {
                    s: if x > half { one - near(y) } else { near(x) },
                    ds: lit::<T>(6.0) * x * y / whole,
                    dds: lit::<T>(6.0) * (y - x) / (whole * whole),
                }
            }
            Shape::Quintic(whole) => {
                let (x, y) = (seconds::<T>(t) / whole, seconds::<T>(rest) / whole);
                let near = |x: T| x * x * x * (lit::<T>(10.0) + x * (lit::<T>(6.0) * x - lit(15.0)));
                Progress {
                    s: if x > half { one - near(y) } else { near(x) },
                    ds: lit::<T>(30.0) * x * x * y * y / whole,
                    dds: lit::<T>(60.0) * x * y * (y - x) / (whole * whole),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: Duration = Duration::from_millis(1500);

    fn laws() -> [TimeLaw<f64>; 6] {
        [
            TimeLaw::Trapezoidal { duration: T, acceleration_time: Duration::from_millis(200) },
            TimeLaw::TrapezoidalByAcceleration { duration: T, acceleration: 1.5 },
            TimeLaw::TrapezoidalByVelocity { duration: T, velocity: 0.4 },
            TimeLaw::TrapezoidalByLimits { velocity: 0.3, acceleration: 0.7 },
            TimeLaw::Cubic { duration: T },
            TimeLaw::Quintic { duration: T },
        ]
    }

    #[test]
    fn each_derivative_is_that_of_the_one_before() {
        for law in laws() {
            let p = law.resolve(0.5).unwrap();
            let n = p.duration().as_nanos() as u64 / 1000;
            let h = Duration::from_micros(1);
            for k in 1..999 {
                let t = Duration::from_micros(n * k / 1000);
                let (a, b, c) = (p.at(t - h), p.at(t), p.at(t + h));
                assert!(((c.s - a.s) / 2e-6 - b.ds).abs() < 1e-5, "{law:?} at {t:?}");
                // Across a corner of a trapezoid the difference quotient lies between both sides.
                let quotient = (c.ds - a.ds) / 2e-6;
                let (low, high) = (a.dds.min(b.dds).min(c.dds), a.dds.max(b.dds).max(c.dds));
                assert!(quotient > low - 1e-3 && quotient < high + 1e-3, "{law:?} at {t:?}: {quotient} {b:?}");
            }
            assert!(p.at(Duration::ZERO).s == 0.0 && p.at(p.duration()) == Progress { s: 1.0, ds: 0.0, dds: 0.0 });
        }
    }

    #[test]
    fn limits_are_kept_and_reached() {
        for (length, v, a) in [(0.5, 0.3, 0.7), (0.01, 0.3, 0.7), (3.0, 1.0, 10.0), (1e-6, 2.0, 5.0)] {
            let p = TimeLaw::TrapezoidalByLimits { velocity: v, acceleration: a }.resolve(length).unwrap();
            let peak = (0..=1000u32).map(|k| p.at(p.duration() * k / 1000).ds * length).fold(0.0, f64::max);
            assert!(peak <= v && p.at(Duration::ZERO).dds * length <= a);
            let triangle = length * a < v * v;
            assert!(p.at(Duration::ZERO).dds * length > a * (1.0 - 1e-4));
            assert!(triangle || peak > v * (1.0 - 1e-6));
        }
    }

    #[test]
    fn the_parameters_asked_for_are_the_ones_found() {
        let by_acceleration = TimeLaw::TrapezoidalByAcceleration { duration: T, acceleration: 1.5 }.resolve(0.5).unwrap();
        assert!((by_acceleration.at(Duration::ZERO).dds * 0.5 - 1.5f64).abs() < 1e-7);
        let by_velocity = TimeLaw::TrapezoidalByVelocity { duration: T, velocity: 0.4 }.resolve(0.5).unwrap();
        assert!((by_velocity.at(T / 2).ds * 0.5 - 0.4f64).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let ms = Duration::from_millis;
        let fault = |law: TimeLaw<f64>| law.resolve(0.5).unwrap_err();
        use PlanFault::*;
        assert_eq!(fault(TimeLaw::Trapezoidal { duration: T, acceleration_time: ms(751) }), CruiseTimeNegative);
        assert_eq!(fault(TimeLaw::Trapezoidal { duration: T, acceleration_time: ms(2000) }), CruiseTimeNegative);
        assert_eq!(fault(TimeLaw::Trapezoidal { duration: T, acceleration_time: ms(0) }), NoAccelerationTime);
        assert_eq!(fault(TimeLaw::Trapezoidal { duration: ms(0), acceleration_time: ms(0) }), NoDuration);
        assert_eq!(fault(TimeLaw::TrapezoidalByAcceleration { duration: T, acceleration: 0.88 }), AccelerationTooSmall);
        assert_eq!(fault(TimeLaw::TrapezoidalByVelocity { duration: T, velocity: 0.33 }), VelocityOutOfRange);
        assert_eq!(fault(TimeLaw::TrapezoidalByVelocity { duration: T, velocity: 0.67 }), VelocityOutOfRange);
        assert_eq!(fault(TimeLaw::TrapezoidalByLimits { velocity: -1.0, acceleration: 1.0 }), LimitNotPositive);
        assert_eq!(fault(TimeLaw::TrapezoidalByLimits { velocity: f64::NAN, acceleration: 1.0 }), NotFinite);
        assert_eq!(fault(TimeLaw::TrapezoidalByLimits { velocity: 1e-300, acceleration: 1.0 }), TooLong);
        assert_eq!(fault(TimeLaw::Cubic { duration: ms(0) }), NoDuration);
        // The bounds themselves are allowed.
        assert!(TimeLaw::TrapezoidalByVelocity { duration: T, velocity: 2.0 / 3.0 }.resolve(0.5).is_ok());
        assert!(TimeLaw::<f64>::Trapezoidal { duration: T, acceleration_time: ms(750) }.resolve(0.5).is_ok());
    }

    #[test]
    fn the_least_acceleration_is_that_of_the_triangle() {
        for k in 1..2000u32 {
            let (length, seconds) = (0.01 * f64::from(k % 173 + 1), 0.1 * f64::from(k % 97 + 1));
            let duration = Duration::from_secs_f64(seconds);
            let least = 4.0 * length / (seconds * seconds);
            let law = |acceleration| TimeLaw::TrapezoidalByAcceleration { duration, acceleration }.resolve(length);
            assert_eq!(law(least).map(|profile| profile.duration()), Ok(duration), "{length} m in {seconds} s");
            assert_eq!(law(least * 0.999), Err(PlanFault::AccelerationTooSmall));
        }
    }

    /// Velocities and accelerations of all sizes.
    fn pairs() -> impl Iterator<Item = (f32, f32)> {
        (1..300u32).flat_map(|i| (1..300u32).map(move |k| (0.01 * i as f32, 0.01 * k as f32)))
    }

    #[test]
    fn limits_that_are_just_reached_are_kept() {
        for (v, a) in pairs() {
            let law = TimeLaw::TrapezoidalByLimits { velocity: v, acceleration: a };
            for length in [v * v / a, 0.3 * v * v / a, 7.0 * v * v / a] {
                let p = law.resolve(length).unwrap_or_else(|fault| panic!("{length} {v} {a}: {fault}"));
                let Shape::Trapezoid { rise_time, slow, .. } = p.shape else { panic!() };
                // The largest rates: at the end of the rise, in the cruise, at the start of the braking.
                for t in [rise_time - Duration::from_nanos(1), rise_time, slow] {
                    let (speed, rate) = (p.at(t).ds * length, p.at(Duration::ZERO).dds * length);
                    assert!(speed <= v && rate <= a, "{length} {v} {a}: {speed} {rate}");
                }
            }
        }
    }

    #[test]
    fn a_short_acceleration_time_has_all_its_digits() {
        let law = TimeLaw::TrapezoidalByAcceleration { duration: Duration::from_secs(60), acceleration: 100.0 };
        for (length, nanoseconds) in [(0.01f32, 1667), (0.001, 167)] {
            // t_c = L / (a T), except for a fraction t_c / T.
            let Shape::Trapezoid { rise_time, .. } = law.resolve(length).unwrap().shape else { panic!() };
            assert_eq!(rise_time, Duration::from_nanos(nanoseconds));
        }
    }

    #[test]
    fn polynomials_never_run_back_or_beyond_1() {
        fn both<T: RealField + Copy>(duration: Duration) -> [Profile<T>; 2] {
            [TimeLaw::Cubic { duration }, TimeLaw::Quintic { duration }].map(|law| law.resolve(T::one()).unwrap())
        }
        for duration in [300, 1000, 1500, 7000].map(Duration::from_millis) {
            for (single, double) in both::<f32>(duration).iter().zip(both::<f64>(duration)) {
                let mut before = 0.0;
                for t in (0..=duration.as_millis() as u64).map(Duration::from_millis) {
                    let (p, exact) = (single.at(t), double.at(t));
                    assert!(p.s >= before && p.s <= 1.0, "{single:?} at {t:?}: {} after {before}", p.s);
                    before = p.s;
                    // A few roundings of each value, and not of 1.
                    let close = |x: f32, exact: f64| (f64::from(x) - exact).abs() <= 1e-6 * exact.abs();
                    assert!(close(p.ds, exact.ds) && close(p.s, exact.s), "{single:?} at {t:?}: {p:?} {exact:?}");
                }
                assert_eq!(before, 1.0);
            }
        }
    }

    #[test]
    fn without_a_length_nothing_moves_under_any_law() {
        let still = |law: TimeLaw<f64>| law.resolve(0.0);
        for law in [
            TimeLaw::Trapezoidal { duration: T, acceleration_time: T },
            TimeLaw::TrapezoidalByAcceleration { duration: T, acceleration: 0.0 },
            TimeLaw::TrapezoidalByVelocity { duration: T, velocity: 0.0 },
            TimeLaw::Cubic { duration: T },
            TimeLaw::Quintic { duration: T },
        ] {
            assert_eq!(still(law), Ok(Profile::rest(T)), "{law:?}");
        }
        for (velocity, acceleration) in [(f64::NAN, 1.0), (1.0, f64::NAN), (1.0, f64::INFINITY)] {
            assert_eq!(still(TimeLaw::TrapezoidalByLimits { velocity, acceleration }), Err(PlanFault::NotFinite));
        }
        assert_eq!(still(TimeLaw::TrapezoidalByVelocity { duration: T, velocity: f64::NAN }), Err(PlanFault::NotFinite));
        let by_acceleration = TimeLaw::TrapezoidalByAcceleration { duration: T, acceleration: f64::NAN };
        assert_eq!(still(by_acceleration), Err(PlanFault::NotFinite));
        assert_eq!(still(TimeLaw::TrapezoidalByLimits { velocity: 1.0, acceleration: 1.0 }), Ok(Profile::rest(Duration::ZERO)));
        assert_eq!(still(TimeLaw::Cubic { duration: Duration::ZERO }), Ok(Profile::rest(Duration::ZERO)));
    }

    #[test]
    fn without_a_limit_of_velocity_the_law_is_a_triangle() {
        let law = |velocity| {
            TimeLaw::TrapezoidalByLimits { velocity, acceleration: 4.0 }.resolve(1.0).map(|p| p.duration().as_millis())
        };
        assert_eq!(law(f64::INFINITY), Ok(1000));
        assert_eq!(law(f64::NAN), Err(PlanFault::NotFinite));
    }
}
