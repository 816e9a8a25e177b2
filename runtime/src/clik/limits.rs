//! Limits of joint variables and rates.

use crate::linalg::{saturate, Limited};
use crate::settings::{self, Setting, SettingError};
use nalgebra::{RealField, SVector};

/// How fast and how far joints may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits<T, const N: usize> {
    rate: SVector<T, N>,
    range: Option<(SVector<T, N>, SVector<T, N>)>,
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
        Ok(Self { rate, range: None })
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
