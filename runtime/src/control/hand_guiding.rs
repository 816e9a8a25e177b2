//! Hand guiding: the arm carries itself, and a hand leads it.
//!
//! ```text
//! u = g(q) + u_f - D dq + walls + cap + hold
//!
//! walls   k x - d min(x / w, 1) dq          x: how far a joint is within the width w of a limit, towards the range positive
//! cap     -d_v (|dq| - v) sign(dq)          beyond the rate v of the joint
//! hold    k_h (a - q) - d_h dq, cut to +- f_h     a: an anchor that the joint drags along where the spring is at f_h
//! ```
//!
//! Gravity is that of the model with its load, u_f the [`FrictionCompensation`]. Every other term has a potential or takes
//! energy, so the arm is passive: V = 1/2 dq' B dq + U - U^ + walls + 1/2 k_h (a - q)^2 grows by the work of the hand alone. The
//! walls hold at most 1/2 k w^2 a joint.
//!
//! Gravity of the model that is wrong moves an arm without friction. The hold is a spring that slips: Coulomb friction by
//! control, with f_h above the error of gravity. The hand feels f_h at most, and the arm rests where it is let go. Cutting the damper
//! with the spring leaves (torque - spring) dq <= 0, so it takes energy.
//!
//! The law is stable where each rate is not turned round within a sample: D, d and d_v, and sqrt(k B_ii), below B_ii/(2 T).
//! `stability::analyse` judges it with its delay.

use super::{check, issue, ControlError, FrictionCompensation, Torque, TorqueLimits};
use crate::{
    reference::State,
    robot::Dynamics,
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SVector};

/// Springs and dampers in front of the limits of the joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walls<T, const N: usize> {
    lower: SVector<T, N>,
    upper: SVector<T, N>,
    width: SVector<T, N>,
    stiffness: SVector<T, N>,
    damping: SVector<T, N>,
}

impl<T: RealField + Copy, const N: usize> Walls<T, N> {
    /// Limits of the joint variables, rad or m, of which an infinite one has no wall, and the width w before them, rad or m.
    /// Then k, N m/rad or N/m, and d, N m s/rad or N s/m. At the limit itself the spring holds k w.
    ///
    /// # Errors
    /// Where the limits leave no room between the walls, or another number is not positive and finite.
    pub fn new(lower: [T; N], upper: [T; N], width: [T; N], stiffness: [T; N], damping: [T; N]) -> Result<Self, SettingError> {
        let [lower, upper, width, stiffness, damping] = [lower, upper, width, stiffness, damping].map(SVector::from);
        settings::positive(Setting::WallWidth, &width)?;
        settings::positive(Setting::Stiffness, &stiffness)?;
        settings::positive(Setting::Derivative, &damping)?;
        settings::positive_or_infinite(Setting::PositionLimit, &(upper - lower - width - width))?;
        Ok(Self { lower, upper, width, stiffness, damping })
    }

    /// How far joint `i` is within a wall, rad or m; negative before the upper limit.
    fn depth(&self, i: usize, q: T) -> T {
        let below = (self.lower[i] + self.width[i] - q).max(T::zero());
        let above = (q - self.upper[i] + self.width[i]).max(T::zero());
        below - above
    }

    fn torque(&self, state: &State<T, N>) -> SVector<T, N> {
        SVector::from_fn(|i, _| {
            let depth = self.depth(i, state.q[i]);
            let part = (depth.abs() / self.width[i]).min(T::one());
            self.stiffness[i] * depth - self.damping[i] * part * state.dq[i]
        })
    }

    /// The energy of the springs, J: 1/2 k x^2 of each joint.
    pub fn energy(&self, q: &SVector<T, N>) -> T {
        let half = nalgebra::convert::<f64, T>(0.5);
        (0..N).fold(T::zero(), |sum, i| {
            let depth = self.depth(i, q[i]);
            sum + half * self.stiffness[i] * depth * depth
        })
    }
}

/// A spring of each joint that slips: it holds up to a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hold<T, const N: usize> {
    force: SVector<T, N>,
    stiffness: SVector<T, N>,
    damping: SVector<T, N>,
}

/// A brake beyond a rate of each joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cap<T, const N: usize> {
    rate: SVector<T, N>,
    damping: SVector<T, N>,
}

/// u = g + u_f - D dq + walls + cap + hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandGuiding<T, const N: usize> {
    pub(crate) damping: SVector<T, N>,
    pub(crate) walls: Option<Walls<T, N>>,
    pub(crate) cap: Option<Cap<T, N>>,
    pub(crate) hold: Option<Hold<T, N>>,
    pub(crate) anchor: Option<SVector<T, N>>,
    pub(crate) friction: Option<FrictionCompensation<T>>,
    pub(crate) limits: Option<TorqueLimits<T, N>>,
}

impl<T: RealField + Copy, const N: usize> HandGuiding<T, N> {
    /// The diagonal of D, N m s/rad or N s/m.
    ///
    /// # Errors
    /// Where one is not positive and finite.
    pub fn new(damping: [T; N]) -> Result<Self, SettingError> {
        let damping = damping.into();
        settings::positive(Setting::Derivative, &damping)?;
        Ok(Self { damping, walls: None, cap: None, hold: None, anchor: None, friction: None, limits: None })
    }

    /// The same with walls before the limits of the joints.
    #[must_use]
    pub fn with_walls(self, walls: Walls<T, N>) -> Self {
        Self { walls: Some(walls), ..self }
    }

    /// The same with the rates v, rad/s or m/s, beyond which the joints are damped by d_v, N m s/rad or N s/m, as well.
    ///
    /// # Errors
    /// Where one is not positive and finite.
    pub fn with_speed_cap(self, rate: [T; N], damping: [T; N]) -> Result<Self, SettingError> {
        let (rate, damping) = (rate.into(), damping.into());
        settings::positive(Setting::RateLimit, &rate)?;
        settings::positive(Setting::Derivative, &damping)?;
        Ok(Self { cap: Some(Cap { rate, damping }), ..self })
    }

    /// The same with a hold of up to f_h, N m or N, by springs of k_h, N m/rad or N/m, and dampers of d_h, N m s/rad or N s/m.
    ///
    /// # Errors
    /// Where one is not positive and finite.
    pub fn with_hold(self, force: [T; N], stiffness: [T; N], damping: [T; N]) -> Result<Self, SettingError> {
        let (force, stiffness, damping) = (force.into(), stiffness.into(), damping.into());
        settings::positive(Setting::HoldForce, &force)?;
        settings::positive(Setting::Stiffness, &stiffness)?;
        settings::not_negative(Setting::Derivative, &damping)?;
        Ok(Self { hold: Some(Hold { force, stiffness, damping }), ..self })
    }

    /// The same with friction compensated in part.
    #[must_use]
    pub fn with_friction_compensation(self, friction: FrictionCompensation<T>) -> Self {
        Self { friction: Some(friction), ..self }
    }

    /// The same with torques limited.
    #[must_use]
    pub fn with_torque_limits(self, limits: TorqueLimits<T, N>) -> Self {
        Self { limits: Some(limits), ..self }
    }

    /// The same with the anchor of the hold at `q`, rad or m; without it, the first measurement is the anchor.
    #[must_use]
    pub fn with_anchor(self, q: SVector<T, N>) -> Self {
        Self { anchor: Some(q), ..self }
    }

    /// The anchor of the hold, rad or m; `None` before the first sample.
    pub fn anchor(&self) -> Option<&SVector<T, N>> {
        self.anchor.as_ref()
    }

    /// Which joints no term pulls back to `q`: those without a hold, outside of the walls.
    #[cfg(feature = "std")]
    pub(crate) fn free(&self, q: &SVector<T, N>) -> [bool; N] {
        let in_wall = |i: usize| self.walls.is_some_and(|walls| walls.depth(i, q[i]) != T::zero());
        core::array::from_fn(|i| self.hold.is_none() && !in_wall(i))
    }

    /// Torque for one sample; the anchor of the hold moves after it.
    ///
    /// # Errors
    /// Where measurement or torque is not finite; the anchor stays as it was.
    pub fn torque<R: Dynamics<N, Real = T>>(&mut self, model: &R, measured: &State<T, N>) -> Result<Torque<T, N>, ControlError> {
        check(measured, true)?;
        let State { q, dq } = measured;
        let mut tau = model.gravity(q) - self.damping.component_mul(dq);
        if let Some(walls) = &self.walls {
            tau += walls.torque(measured);
        }
        if let Some(cap) = &self.cap {
            tau -= SVector::from_fn(|i, _| {
                let beyond = dq[i] - dq[i].min(cap.rate[i]).max(-cap.rate[i]);
                cap.damping[i] * beyond
            });
        }
        if let Some(friction) = &self.friction {
            tau += friction.torque(model, measured);
        }
        let mut anchor = self.anchor;
        if let Some(hold) = &self.hold {
            let before = self.anchor.unwrap_or(*q);
            let dragged = SVector::from_fn(|i, _| {
                let most = hold.force[i] / hold.stiffness[i];
                before[i].max(q[i] - most).min(q[i] + most)
            });
            tau += SVector::from_fn(|i, _| {
                let most = hold.force[i];
                (hold.stiffness[i] * (dragged[i] - q[i]) - hold.damping[i] * dq[i]).min(most).max(-most)
            });
            anchor = Some(dragged);
        }
        let torque = issue(tau, &self.limits, false)?;
        self.anchor = anchor;
        Ok(torque)
    }
}
