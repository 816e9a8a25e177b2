//! Limits of joint variables, rates and accelerations.
//!
//! **Braking.** A joint that moves at the rate v, is sampled at T and brakes by a T a sample covers, with n = v/(a T), m its whole part and
//! f the rest,
//!
//! ```text
//! rates held, q += T v:                 d = (m + 1) (m/2 + f) a T^2
//! accelerations held, after a step:     d = (m^2/2 + m f + f/2) a T^2
//! ```
//!
//! before it rests. Both lead to the same largest next rate w, with D = d/(a T^2) of the way d that is left, less v T/2 where
//! accelerations are held:
//!
//! ```text
//! w = a T (D/(m + 1) + m/2),    m the whole part of (sqrt(1 + 8 D) - 1)/2
//! ```
//!
//! These are the bounds of Del Prete (RA-L 3, 2018) in discrete time: from a rate within them the next rate w - a T is within them again. So
//! the box of rates, or accelerations, is never empty where a joint started within its limits. The formula of continuous time,
//! w = sqrt(a^2 T^2/4 + 2 a d) - a T/2, is below w between whole n, so there a joint would have to brake harder than by a.

use crate::linalg::{lit, saturate, Limited};
use crate::reference::State;
use crate::settings::{self, Setting, SettingError};
use nalgebra::{RealField, SVector};

/// How fast and how far joints may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits<T, const N: usize> {
    rate: SVector<T, N>,
    range: Option<(SVector<T, N>, SVector<T, N>)>,
    acceleration: Option<SVector<T, N>>,
}

/// A box: from `low` to `high`, joint by joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<T, const N: usize> {
    /// The lower bounds.
    pub low: SVector<T, N>,
    /// The upper bounds, never below the lower ones.
    pub high: SVector<T, N>,
}

/// Joint variables that do not leave their range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithinRange<T, const N: usize> {
    /// The joint variables.
    pub q: SVector<T, N>,
    /// The first joint that was stopped at a limit, counted from 0.
    pub stopped: Option<usize>,
}

impl<T: RealField + Copy, const N: usize> JointLimits<T, N> {
    /// Rates up to `rate`, rad/s or m/s, to either side; joint variables without limits.
    ///
    /// An inverse of the Jacobian asks for unbounded rates near a singular posture, so every rate needs a finite limit. Choose a
    /// limit where `VELOCITY_LIMITS` of an emitted robot is infinite.
    ///
    /// # Errors
    /// Where a rate is not positive and finite.
    pub fn rates(rate: [T; N]) -> Result<Self, SettingError> {
        let rate = rate.into();
        settings::positive(Setting::RateLimit, &rate)?;
        Ok(Self { rate, range: None, acceleration: None })
    }

    /// The same with joint variables from `lower` to `upper`, rad or m; an infinite limit never acts.
    ///
    /// # Errors
    /// Where the lower limit is not below the upper one, or one is NaN.
    pub fn with_range(self, lower: [T; N], upper: [T; N]) -> Result<Self, SettingError> {
        let (lower, upper) = (SVector::from(lower), SVector::from(upper));
        settings::positive_or_infinite(Setting::PositionLimit, &(upper - lower))?;
        Ok(Self { range: Some((lower, upper)), ..self })
    }

    /// The same with accelerations up to `acceleration`, rad/s^2 or m/s^2, to either side.
    ///
    /// # Errors
    /// Where an acceleration is not positive and finite.
    pub fn with_acceleration(self, acceleration: [T; N]) -> Result<Self, SettingError> {
        let acceleration = acceleration.into();
        settings::positive(Setting::AccelerationLimit, &acceleration)?;
        Ok(Self { acceleration: Some(acceleration), ..self })
    }

    /// The rates, rad/s or m/s, to hold for the next `period`, s, after which every joint is within its limits and can still brake.
    ///
    /// `state` has the rates held until now. A joint outside its range may stay or move inwards. One that moves too fast to stay inside
    /// brakes by its acceleration limit, which is kept always.
    pub fn rate_bounds(&self, state: &State<T, N>, period: T) -> Bounds<T, N> {
        self.bounds(|i| {
            let a = self.acceleration.map(|a| a[i]);
            let (lower, upper) = self.ways(i, state.q[i]);
            let low = lower.map_or(-self.rate[i], |way| (-brake(way.max(T::zero()), a, period)).max(-self.rate[i]));
            let high = upper.map_or(self.rate[i], |way| brake(way.max(T::zero()), a, period).min(self.rate[i]));
            match a {
                Some(a) => (low, high, Some((state.dq[i] - a * period, state.dq[i] + a * period))),
                None => (low, high, None),
            }
        })
    }

    /// The accelerations, rad/s^2 or m/s^2, from which every joint stays within its limits if they are held for `horizon`, s.
    ///
    /// Braking counts with the share `braking` of the acceleration limits, at most 1. The rest r is a reserve against a model that is off:
    /// an acceleration up to r that the model does not know leaves a joint at rest r horizon^2 from where it was to be, so the ranges count
    /// as narrower by this. A joint outside moves inwards. The acceleration limit is kept always.
    pub fn acceleration_bounds(&self, state: &State<T, N>, horizon: T, braking: T) -> Bounds<T, N> {
        self.bounds(|i| {
            let a = self.acceleration.map(|a| a[i]);
            let share = a.map(|a| a * braking);
            let margin = a.map_or_else(T::zero, |a| a * (T::one() - braking) * horizon * horizon);
            let v = state.dq[i];
            let (lower, upper) = self.ways(i, state.q[i]);
            // Outside, or too near to stop by a held acceleration: back by the end of the horizon.
            let half = v * horizon * lit(0.5);
            let next = |way: T| if way > T::zero() { brake(way, share, horizon) } else { way * lit(2.0) / horizon };
            let low = lower.map_or(-self.rate[i], |way| (-next(way - margin + half)).max(-self.rate[i]).min(self.rate[i]));
            let high = upper.map_or(self.rate[i], |way| next(way - margin - half).min(self.rate[i]).max(-self.rate[i]));
            ((low - v) / horizon, (high - v) / horizon, a.map(|a| (-a, a)))
        })
    }

    /// The ways to the lower and the upper limit of a joint.
    fn ways(&self, i: usize, q: T) -> (Option<T>, Option<T>) {
        match &self.range {
            Some((lower, upper)) => (Some(q - lower[i]), Some(upper[i] - q)),
            None => (None, None),
        }
    }

    /// The box of bounds by position and rate, and by acceleration. Where the two exclude each other, it is the nearest of the latter.
    fn bounds(&self, of: impl Fn(usize) -> (T, T, Option<(T, T)>)) -> Bounds<T, N> {
        let (mut low, mut high) = (SVector::zeros(), SVector::zeros());
        for i in 0..N {
            let (mut least, mut most, within) = of(i);
            if least > most {
                // A range narrower than what a joint crosses in a sample.
                least = (least + most) * lit(0.5);
                most = least;
            }
            if let Some((from, to)) = within {
                least = least.max(from).min(to);
                most = most.max(from).min(to);
            }
            (low[i], high[i]) = (least, most);
        }
        Bounds { low, high }
    }

    /// The rate limits.
    pub fn rate(&self) -> &SVector<T, N> {
        &self.rate
    }

    /// `dq` slowed down, along its direction, until every rate is within its limit.
    pub fn slow_down(&self, dq: &SVector<T, N>) -> Limited<T, N> {
        let mut factor = T::one();
        for i in 0..N {
            if dq[i].abs() > self.rate[i] {
                factor = factor.min(self.rate[i] / dq[i].abs());
            }
        }
        if factor < T::one() {
            // The rounding of the product may exceed the limit by one unit: cut it.
            Limited { is_limited: true, ..saturate(&(dq * factor), &self.rate) }
        } else {
            Limited { value: *dq, is_limited: false }
        }
    }

    /// `next` kept within the range.
    ///
    /// A joint that is already outside at `q` may move inwards or stay.
    pub fn stop(&self, q: &SVector<T, N>, next: &SVector<T, N>) -> WithinRange<T, N> {
        let Some((lower, upper)) = &self.range else {
            return WithinRange { q: *next, stopped: None };
        };
        let mut stopped = None;
        let q = SVector::from_fn(|i, _| {
            let x = next[i].max(lower[i].min(q[i])).min(upper[i].max(q[i]));
            if x != next[i] && stopped.is_none() {
                stopped = Some(i);
            }
            x
        });
        WithinRange { q, stopped }
    }

    /// Whether `q` is at or beyond a limit of joint `i` and the rate `dq` leads further out.
    pub(super) fn is_outwards(&self, i: usize, q: T, dq: T) -> bool {
        self.range.as_ref().is_some_and(|(lower, upper)| (q >= upper[i] && dq > T::zero()) || (q <= lower[i] && dq < T::zero()))
    }
}

/// The largest rate at which a joint rests within `way`, not negative: rates held for `period`, less by `a` times the period each time.
fn brake<T: RealField + Copy>(way: T, a: Option<T>, period: T) -> T {
    let Some(step) = a.map(|a| a * period * period) else { return way / period };
    let d = way / step;
    if !d.is_finite() {
        // A range without a limit.
        return way / period;
    }
    let m = (((T::one() + d * lit(8.0)).sqrt() - T::one()) * lit(0.5)).floor();
    (d / (m + T::one()) + m * lit(0.5)) * (step / period)
}
