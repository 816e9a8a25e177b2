//! Integration of ordinary differential equations.
//!
//! The classical Runge-Kutta method of fourth order with fixed steps, and the adaptive pair of Dormand and Prince (1980) of
//! orders 5 and 4. The difference of the pair determines the step.

use crate::linalg::lit;
use nalgebra::{RealField, SVector};

/// The state of a differential equation: a vector with an error norm.
pub trait Phase<T>: Copy {
    /// self + h rate.
    fn plus(&self, h: T, rate: &Self) -> Self;

    /// Largest |self_i| / (1 + |scale_i|): an error, absolute for small and relative for large elements.
    fn error(&self, scale: &Self) -> T;
}

impl<T: RealField + Copy, const D: usize> Phase<T> for SVector<T, D> {
    #[inline]
    fn plus(&self, h: T, rate: &Self) -> Self {
        self + rate * h
    }

    fn error(&self, scale: &Self) -> T {
        // A NaN must not hide: `max` would drop it.
        self.iter().zip(scale.iter()).map(|(e, s)| e.abs() / (T::one() + s.abs())).fold(T::zero(), |worst, e| {
            if e > worst || !e.is_finite() {
                e
            } else {
                worst
            }
        })
    }
}

/// How a plant is integrated over one sampling period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator<T> {
    /// This many equal steps of the classical method of fourth order.
    RungeKutta4 {
        /// Steps a period, at least 1.
        substeps: u32,
    },
    /// Steps of the Dormand-Prince pair, each with a local error below `tolerance`.
    DormandPrince {
        /// Bound of the local error, absolute for values below 1 and relative above.
        tolerance: T,
        /// Bound of the work: steps a period, refused ones included.
        most_steps: u32,
    },
}

/// Why a period could not be integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepError {
    /// More steps would be needed than allowed: the motion is too stiff, or not smooth.
    TooManySteps,
    /// No steps are allowed, or the tolerance is not positive.
    BadOptions,
}

messages! { StepError,
    StepError::TooManySteps => "more steps are needed than allowed: the motion is too stiff, or not smooth";
    StepError::BadOptions => "no steps are allowed, or the tolerance is not positive";
}

/// One step of length `h` of the classical Runge-Kutta method; `f(c, x)` is dx/dt at the time `c` after the start of the step.
#[inline]
pub fn rk4<T: RealField + Copy, X: Phase<T>>(x: &X, h: T, mut f: impl FnMut(T, &X) -> X) -> X {
    let half = h * lit(0.5);
    let k1 = f(T::zero(), x);
    let k2 = f(half, &x.plus(half, &k1));
    let k3 = f(half, &x.plus(half, &k2));
    let k4 = f(h, &x.plus(h, &k3));
    let (sixth, third) = (h / lit(6.0), h / lit(3.0));
    x.plus(sixth, &k1).plus(third, &k2).plus(third, &k3).plus(sixth, &k4)
}

/// From 0 to `period` by steps of the Dormand-Prince pair; `f(c, x)` is dx/dt at the time `c` after the start.
///
/// `step` is the first length tried, and on return the one to try next.
///
/// # Errors
/// Where `most_steps` do not suffice, or the options make no sense.
pub fn dormand_prince<T: RealField + Copy, X: Phase<T>>(
    x: &X,
    period: T,
    tolerance: T,
    most_steps: u32,
    step: &mut T,
    mut f: impl FnMut(T, &X) -> X,
) -> Result<X, StepError> {
    if !(tolerance > T::zero()) || most_steps == 0 {
        return Err(StepError::BadOptions);
    }
    let c = |n: f64, d: f64| lit::<T>(n / d);
    let (mut x, mut t) = (*x, T::zero());
    let mut k1 = f(t, &x);
    if !(*step > T::zero() && step.is_finite()) {
        *step = period;
    }
    for _ in 0..most_steps {
        let last = t + *step >= period;
        let h = if last { period - t } else { *step };
        let at = |terms: &[(T, &X)]| terms.iter().fold(x, |sum, (a, k)| sum.plus(h * *a, k));
        let k2 = f(t + h * c(1., 5.), &at(&[(c(1., 5.), &k1)]));
        let k3 = f(t + h * c(3., 10.), &at(&[(c(3., 40.), &k1), (c(9., 40.), &k2)]));
        let k4 = f(t + h * c(4., 5.), &at(&[(c(44., 45.), &k1), (c(-56., 15.), &k2), (c(32., 9.), &k3)]));
        let x5 = at(&[(c(19372., 6561.), &k1), (c(-25360., 2187.), &k2), (c(64448., 6561.), &k3), (c(-212., 729.), &k4)]);
        let k5 = f(t + h * c(8., 9.), &x5);
        let x6 = at(&[
            (c(9017., 3168.), &k1),
            (c(-355., 33.), &k2),
            (c(46732., 5247.), &k3),
            (c(49., 176.), &k4),
            (c(-5103., 18656.), &k5),
        ]);
        let k6 = f(t + h, &x6);
        let next =
            at(&[(c(35., 384.), &k1), (c(500., 1113.), &k3), (c(125., 192.), &k4), (c(-2187., 6784.), &k5), (c(11., 84.), &k6)]);
        let k7 = f(t + h, &next);
        // Difference of both solutions, built on zero: x - x.
        let zero = x.plus(-T::one(), &x);
        let difference = [
            (c(71., 57600.), &k1),
            (c(-71., 16695.), &k3),
            (c(71., 1920.), &k4),
            (c(-17253., 339200.), &k5),
            (c(22., 525.), &k6),
            (c(-1., 40.), &k7),
        ]
        .iter()
        .fold(zero, |sum, (a, k)| sum.plus(h * *a, k));
        let error = difference.error(&next) / tolerance;
        if error <= T::one() {
            (x, k1) = (next, k7);
            t += h;
        }
        // Order 5: the error of a step goes with h^5.
        let growth = if error > T::zero() && error.is_finite() {
            (lit::<T>(0.9) * error.powf(lit(-0.2))).max(lit(0.2)).min(lit(5.0))
        } else if error == T::zero() {
            lit(5.0)
        } else {
            lit(0.2)
        };
        if error <= T::one() && last {
            // A step cut short by the end of the period is no reason against the longer step.
            *step = step.max(h * growth);
            return Ok(x);
        }
        *step = h * growth;
    }
    Err(StepError::TooManySteps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    fn oscillator(_: f64, x: &Vector2<f64>) -> Vector2<f64> {
        Vector2::new(x[1], -x[0])
    }

    #[test]
    fn the_orders_are_four_and_five() {
        let error = |n: u32| {
            let mut x = Vector2::new(1.0, 0.0);
            for _ in 0..n {
                x = rk4(&x, 1.0 / f64::from(n), oscillator);
            }
            (x - Vector2::new(1f64.cos(), -1f64.sin())).norm()
        };
        assert!((error(10) / error(20)).log2() > 3.9);
        let mut step = 1.0;
        let x = dormand_prince(&Vector2::new(1.0, 0.0), 1.0, 1e-12, 1000, &mut step, oscillator).unwrap();
        assert!((x - Vector2::new(1f64.cos(), -1f64.sin())).norm() < 1e-11);
    }

    #[test]
    fn a_time_dependent_right_hand_side_is_followed() {
        let f = |t: f64, _: &Vector2<f64>| Vector2::new(5.0 * t.powi(4), t.cos());
        let mut step = 0.3;
        let x = dormand_prince(&Vector2::zeros(), 1.0, 1e-10, 1000, &mut step, f).unwrap();
        assert!((x - Vector2::new(1.0, 1f64.sin())).norm() < 1e-9);
        assert!((rk4(&Vector2::zeros(), 1.0, |t, _: &Vector2<f64>| Vector2::new(4.0 * t.powi(3), 1.0))[0] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn work_is_bounded() {
        let mut step = 1.0;
        let stiff = |_: f64, x: &Vector2<f64>| x * -1e9;
        assert_eq!(dormand_prince(&Vector2::new(1.0, 1.0), 1.0, 1e-9, 100, &mut step, stiff), Err(StepError::TooManySteps));
        let nan = |_: f64, x: &Vector2<f64>| x * f64::NAN;
        assert_eq!(dormand_prince(&Vector2::new(1.0, 1.0), 1.0, 1e-9, 100, &mut step, nan), Err(StepError::TooManySteps));
    }
}
