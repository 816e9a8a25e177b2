//! Contacts without a force sensor: the momentum observer (De Luca, Mattone, 2003; Haddadin, De Luca, Albu-Schaeffer, IEEE T-RO 33, 2017).
//!
//! With p = B dq the equation of motion is dp/dt = tau + C' dq - F - g + tau_ext. The residual
//!
//! ```text
//! r = K (p - p_0 - int (tau + C' dq - F - g + r) dt),      dr/dt = K (tau_ext - r)
//! ```
//!
//! is tau_ext through a filter of first order, without an acceleration. It is integrated by the backward rule: with
//! s = T (tau + C' dq - F - g), tau held over the past period and the rest at its end,
//!
//! ```text
//! r_k = K (p_k - p_0 - I_{k-1} - s_k) / (1 + K T),         I_k = I_{k-1} + s_k + T r_k
//! ```
//!
//! A joint shows a contact where |r| exceeds its threshold, which depends on the state:
//!
//! ```text
//! 4 s + 3 sqrt(y' Cov y) + resolution + rounding + 1.3 (F_c + F_l |g|) while |dq| < 0.02
//! ```
//!
//! s is the spread of the model's error in a validation, y the joint's row of the regressor whose parameters have the covariance Cov.
//! Friction at rest takes any value up to Coulomb friction. A contact is reported when it lasts. The outermost joint
//! beyond its threshold is the last one before the link in contact: links beyond it carry none.

use crate::{
    control::{ControlError, HandGuiding, PdGravity, Torque},
    linalg::{is_finite, lit},
    reference::{JointReference, State},
    robot::{CoriolisTransposeTimes, Dynamics, Momentum},
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SMatrix, SVector};

/// The rate, rad/s or m/s, below which friction counts as friction at rest.
const AT_REST: f64 = 0.02;
/// By what friction at rest exceeds Coulomb friction.
const STATIC: f64 = 1.3;

/// What a residual may be without a contact, joint by joint; N m or N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold<T, const N: usize> {
    /// s, the spread (standard deviation) of the model's error; four of them count.
    pub spread: SVector<T, N>,
    /// The resolution of the measured torques, and the bound of rounding.
    pub resolution: SVector<T, N>,
    /// Coulomb friction F_c.
    pub coulomb: SVector<T, N>,
    /// F_l, the part of |g| by which friction grows with the load.
    pub load: SVector<T, N>,
}

impl<T: RealField + Copy, const N: usize> Threshold<T, N> {
    /// The threshold at a state with gravity `gravity`; `parameters` is that of [`parameter_spread`], or zero.
    pub fn at(&self, measured: &State<T, N>, gravity: &SVector<T, N>, parameters: &SVector<T, N>) -> SVector<T, N> {
        SVector::from_fn(|i, _| {
            let rests = measured.dq[i].abs() < lit(AT_REST);
            let friction = lit::<T>(STATIC) * (self.coulomb[i] + self.load[i] * gravity[i].abs());
            let moving = self.spread[i] * lit(4.0) + parameters[i] + self.resolution[i];
            if rests {
                moving + friction
            } else {
                moving
            }
        })
    }
}

/// 3 sqrt(y' Cov y) of each joint, N m or N: y its row of the regressor `y`, `covariance` that of the parameters.
pub fn parameter_spread<T: RealField + Copy, const N: usize, const B: usize>(
    y: &SMatrix<T, N, B>,
    covariance: &SMatrix<T, B, B>,
) -> SVector<T, N> {
    SVector::from_fn(|i, _| {
        let row = y.row(i);
        let mut square = T::zero();
        for a in 0..B {
            for b in 0..B {
                square += row[a] * covariance[(a, b)] * row[b];
            }
        }
        square.max(T::zero()).sqrt() * lit(3.0)
    })
}

/// A contact, or its absence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T, const N: usize> {
    /// r, the estimate of tau_ext, N m or N.
    pub residual: SVector<T, N>,
    /// What it may be without a contact, N m or N.
    pub threshold: SVector<T, N>,
    /// Whether some joint has been beyond its threshold for the hold time.
    pub is_contact: bool,
    /// The first joint beyond its threshold at this sample, counted from 0.
    pub first: Option<usize>,
    /// The outermost one: the contact is on the link that it moves, or before that.
    pub outermost: Option<usize>,
}

/// The momentum observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentumObserver<T, const N: usize> {
    gain: SVector<T, N>,
    period: T,
    threshold: Threshold<T, N>,
    hold: u32,
    /// p_0 + I.
    expected: Option<SVector<T, N>>,
    residual: SVector<T, N>,
    beyond: u32,
}

impl<T: RealField + Copy, const N: usize> MomentumObserver<T, N> {
    /// The diagonal of K, 1/s, the sampling period, s, the threshold, and the number of samples in a row that make a contact
    /// (0.1 s by custom; 0.01 s with a spread that counts half as much again).
    ///
    /// # Errors
    /// Where K or the period is not positive and finite, K T is not below 1, or a part of the threshold is negative or not finite.
    pub fn new(gain: [T; N], period: T, threshold: Threshold<T, N>, hold: u32) -> Result<Self, SettingError> {
        let gain = gain.into();
        settings::positive(Setting::ObserverGain, &gain)?;
        settings::positive_scalar(Setting::Period, period)?;
        settings::positive(Setting::ObserverGain, &gain.map(|k| T::one() - k * period))?;
        for part in [&threshold.spread, &threshold.resolution, &threshold.coulomb, &threshold.load] {
            settings::not_negative(Setting::Threshold, part)?;
        }
        Ok(Self { gain, period, threshold, hold, expected: None, residual: SVector::zeros(), beyond: 0 })
    }

    /// r after the last sample, N m or N.
    pub fn residual(&self) -> &SVector<T, N> {
        &self.residual
    }

    /// One sample: the measurement, and the torque `tau` that acted since the last one, N m or N. `parameters` is that of
    /// [`parameter_spread`], or zero. The first sample only remembers the momentum.
    ///
    /// # Errors
    /// Where measurement or torque is not finite; the observer stays as it was.
    pub fn step<R>(
        &mut self,
        model: &R,
        measured: &State<T, N>,
        tau: &SVector<T, N>,
        parameters: &SVector<T, N>,
    ) -> Result<Contact<T, N>, ControlError>
    where
        R: Dynamics<N, Real = T> + Momentum<N> + CoriolisTransposeTimes<N>,
    {
        if !(measured.is_finite() && is_finite(tau)) {
            return Err(ControlError::MeasurementNotFinite);
        }
        let State { q, dq } = measured;
        let (p, gravity) = (model.momentum(q, dq), model.gravity(q));
        let friction = model.friction(dq) + model.load_friction(q, dq);
        let step = (tau + model.coriolis_transpose_times(q, dq) - friction - gravity) * self.period;
        let (residual, expected) = match &self.expected {
            None => (SVector::zeros(), p),
            Some(before) => {
                let lacks = p - before - step;
                let residual = SVector::from_fn(|i, _| lacks[i] * self.gain[i] / (T::one() + self.gain[i] * self.period));
                (residual, before + step + residual * self.period)
            }
        };
        let threshold = self.threshold.at(measured, &gravity, parameters);
        if !(is_finite(&expected) && is_finite(&residual) && is_finite(&threshold)) {
            return Err(ControlError::StateNotFinite);
        }
        let (mut first, mut outermost) = (None, None);
        for i in 0..N {
            if residual[i].abs() > threshold[i] {
                first = first.or(Some(i));
                outermost = Some(i);
            }
        }
        self.beyond = if first.is_some() { self.beyond.saturating_add(1) } else { 0 };
        (self.residual, self.expected) = (residual, Some(expected));
        Ok(Contact { residual, threshold, is_contact: first.is_some() && self.beyond >= self.hold, first, outermost })
    }
}

/// The arm's answer to a contact. On a timed path, `Governor` of `timing` stops within the limits, and leads back on the reversed path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reaction<T, const N: usize> {
    /// The arm carries itself and gives way.
    Float(HandGuiding<T, N>),
    /// The arm holds the posture at which the contact was reported.
    Stop(PdGravity<T, N>),
}

impl<T: RealField + Copy, const N: usize> Reaction<T, N> {
    /// Torque for one sample after a contact at `posture`, rad or m.
    ///
    /// # Errors
    /// Where measurement, posture or torque is not finite.
    pub fn torque<R: Dynamics<N, Real = T>>(
        &mut self,
        model: &R,
        posture: &SVector<T, N>,
        measured: &State<T, N>,
    ) -> Result<Torque<T, N>, ControlError> {
        match self {
            Reaction::Float(law) => law.torque(model, measured),
            Reaction::Stop(law) => law.torque(model, &JointReference::at_rest(*posture), measured),
        }
    }
}
