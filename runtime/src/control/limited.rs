//! Operational-space control within limits of torque, position, rate and acceleration.
//!
//! ```text
//! level 1:  least |J ddq - a|^2 + lambda^2 |ddq|^2,    a = a_d + K_D de + K_P e + K_I int e dt - dJ dq
//! level 2:  least |ddq - y_0|^2  among the ddq with the J ddq of level 1
//! always:   -bound <= B^ ddq + n^ <= bound,    low <= ddq <= high
//! ```
//!
//! and u = B^ ddq + n^. Where no limit acts, this is the law of [`OperationalSpace`], whose analysis of stability it shares. y_0 is that
//! of [`NullSpace`](super::NullSpace); without one the accelerations are the least.
//!
//! The box is that of [`JointLimits::acceleration_bounds`]. Its horizon is longer than the sampling period: near a limit the joint obeys
//! ddq = (w - dq)/horizon, w a rate, and a sampled loop with delay bears no such gain at a horizon of one period. Braking counts with a
//! share of the acceleration limits, and the rest is the reserve against a model that is off.
//!
//! **Conflict.** Torques within their limits always exist, B^ being regular, but a box may be out of their reach: a limit came too
//! fast, or a weight is more than a joint bears. Torques are the arm's own, so the box yields. With p(x) the nearest point of the box,
//!
//! ```text
//! least |J ddq - a|^2 + lambda^2 |ddq|^2 + w |ddq - p(ddq)|^2 + s |ddq - y_0|^2    within the torques,   w = 1e4, s = 1e-3
//! ```
//!
//! relative to the largest diagonal element of J' J. It is convex; each step of Newton's method on it is a quadratic program with the joints
//! outside the box pulled to it. [`LimitedTorque::conflict`] names these joints.

use super::{issue, operational_space::Demand, ControlError, OperationalSpace, Torque, TorqueLimits};
use crate::{
    clik::{Bounds, JointLimits},
    linalg::{lit, quadratic_program, Levels},
    reference::{OperationalReference, State},
    robot::Dynamics,
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SMatrix, SVector};

/// Torques that keep limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limited<T, const N: usize, const M: usize> {
    pub(crate) law: OperationalSpace<T, N, M>,
    torques: TorqueLimits<T, N>,
    joints: JointLimits<T, N>,
    horizon: T,
    braking: T,
}

/// The torque for one sample, and what limits made of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitedTorque<T, const N: usize> {
    /// The torque; `limited` where a limit of any kind changed it.
    pub torque: Torque<T, N>,
    /// The accelerations that the model expects of it, rad/s^2 or m/s^2.
    pub ddq: SVector<T, N>,
    /// The joints whose limits of position, rate or acceleration are out of reach of the torques.
    pub conflict: [bool; N],
}

/// Steps of Newton's method at most; each sorts the joints into those within and those outside the box.
const MOST_STEPS: usize = 24;

impl<T: RealField + Copy, const N: usize, const M: usize> Limited<T, N, M> {
    /// `law` within `torques` and `joints`. The limits count over `horizon`, s, several sampling periods, and joints brake with the share
    /// `braking` of their acceleration limits.
    ///
    /// A horizon of eight periods bears one sample of delay. The rest of the acceleration limits must exceed the accelerations that the
    /// model does not know, B^-1 (dB ddq + dn) with the errors dB and dn. A share of 0.6 serves where masses are off by a few per cent.
    ///
    /// # Errors
    /// Where the horizon is not positive and finite, or the share is not above 0 and at most 1.
    pub fn new(
        law: OperationalSpace<T, N, M>,
        torques: TorqueLimits<T, N>,
        joints: JointLimits<T, N>,
        horizon: T,
        braking: T,
    ) -> Result<Self, SettingError> {
        settings::positive_scalar(Setting::Horizon, horizon)?;
        settings::positive_scalar(Setting::BrakingShare, braking)?;
        settings::not_negative_scalar(Setting::BrakingShare, T::one() - braking)?;
        Ok(Self { law, torques, joints, horizon, braking })
    }

    /// The same with another law.
    #[cfg(feature = "std")]
    pub(crate) fn with_law(&self, law: OperationalSpace<T, N, M>) -> Self {
        Self { law, ..*self }
    }

    /// The same with limits that never act.
    #[cfg(feature = "std")]
    pub(crate) fn without_limits(&self) -> Self {
        let huge = [lit(1e12); N];
        let (torques, joints) = (TorqueLimits::new(huge), JointLimits::rates(huge));
        Self { torques: torques.unwrap_or(self.torques), joints: joints.unwrap_or(self.joints), ..*self }
    }

    /// The present integral of the error, m s or rad s, row by row of the task.
    pub fn integral(&self) -> &SVector<T, M> {
        self.law.integral()
    }

    /// Torque for one sample, then the step of the integral; it rests while a limit acts.
    ///
    /// # Errors
    /// Where measurement, reference or torque is not finite, or there is no solution; the integral stays as it was.
    pub fn torque<R: Dynamics<N, Real = T>>(
        &mut self,
        model: &R,
        reference: &OperationalReference<T>,
        measured: &State<T, N>,
    ) -> Result<LimitedTorque<T, N>, ControlError> {
        let Demand { j, a, e } = self.law.demand(model, reference, measured)?;
        let lambda = self.law.damping.map_or_else(T::zero, |damping| damping.at(&j));
        let b = model.inertia_matrix(&measured.q);
        let n = model.inverse_dynamics(&measured.q, &measured.dq, &SVector::zeros());
        let bounds = self.joints.acceleration_bounds(measured, self.horizon, self.braking);
        let least = -self.torques.bound() - n;
        let most = n - self.torques.bound();
        let unit = SMatrix::<T, N, N>::identity();
        let mut levels = Levels::new([unit, -unit, b, -b], [bounds.low, -bounds.high, least, most]);
        let y_0 = self.law.null_space.map(|null_space| null_space.acceleration(measured));
        let (ddq, limited, conflict) = match levels.level(&j, &a, lambda) {
            Ok(()) => {
                if let Some(y_0) = &y_0 {
                    levels.level(&unit, y_0, T::zero()).map_err(|_| ControlError::NotSolved)?;
                }
                (*levels.x(), levels.is_limited(), [false; N])
            }
            Err(_) => {
                let goal = Goal { j, a, lambda, y_0: y_0.unwrap_or_else(SVector::zeros) };
                let ddq = goal.yielding(&bounds, &[b, -b], &[least, most]).ok_or(ControlError::NotSolved)?;
                let conflict = core::array::from_fn(|i| {
                    let size = (T::one() + bounds.low[i].abs().max(bounds.high[i].abs())) * lit(1e-3);
                    ddq[i] < bounds.low[i] - size || ddq[i] > bounds.high[i] + size
                });
                (ddq, true, conflict)
            }
        };
        let damped = lambda > T::zero();
        let torque = issue(model.inverse_dynamics(&measured.q, &measured.dq, &ddq), &Some(self.torques), damped)?;
        let torque = Torque { limited: limited || torque.limited, ..torque };
        self.law.advance(&e, torque.limited)?;
        Ok(LimitedTorque { torque, ddq, conflict })
    }
}

/// The wishes of a sample.
struct Goal<T, const N: usize, const M: usize> {
    j: SMatrix<T, M, N>,
    a: SVector<T, M>,
    lambda: T,
    y_0: SVector<T, N>,
}

impl<T: RealField + Copy, const N: usize, const M: usize> Goal<T, N, M> {
    /// ddq within the rows alone, with a box that yields.
    fn yielding(&self, bounds: &Bounds<T, N>, rows: &[SMatrix<T, N, N>; 2], least: &[SVector<T, N>; 2]) -> Option<SVector<T, N>> {
        let gram = self.j.tr_mul(&self.j);
        let size = gram.diagonal().amax();
        let size = if size > T::zero() { size } else { T::one() };
        let (weight, posture) = (size * lit(1e4), size * lit(1e-3));
        let h = gram + SMatrix::from_diagonal_element(self.lambda * self.lambda + posture);
        let g = -(self.j.tr_mul(&self.a) + self.y_0 * posture);
        // Where the iterations do not settle, the best of them is kept.
        let mut best: Option<(T, SVector<T, N>)> = None;
        let mut sides = [0i8; N];
        for _ in 0..MOST_STEPS {
            let (mut pulled, mut towards) = (h, g);
            for i in 0..N {
                if sides[i] != 0 {
                    pulled[(i, i)] += weight;
                    towards[i] -= weight * if sides[i] > 0 { bounds.high[i] } else { bounds.low[i] };
                }
            }
            let x = quadratic_program(&pulled, &towards, rows, least).ok()?.x;
            let outside = SVector::<T, N>::from_fn(|i, _| x[i] - x[i].max(bounds.low[i]).min(bounds.high[i]));
            let value = (h * x).dot(&x) * lit(0.5) + g.dot(&x) + outside.norm_squared() * weight * lit(0.5);
            if best.is_none_or(|(before, _)| value < before) {
                best = Some((value, x));
            }
            let now = core::array::from_fn(|i| i8::from(outside[i] > T::zero()) - i8::from(outside[i] < T::zero()));
            if now == sides {
                break;
            }
            sides = now;
        }
        best.map(|(_, x)| x)
    }
}
