//! Partial compensation of friction, which never drives a joint.

use crate::{
    reference::State,
    robot::Dynamics,
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SVector};

/// A share s < 1 of the model's friction, given back to the joints:
///
/// ```text
/// u_f = F(0) + s min(|dq| / epsilon, 1) (F(dq) + F_l(q, dq) - F(0))
/// ```
///
/// At and above the rate epsilon it is s times the friction of the model; below, it falls to the offset F(0) alone, since a rate
/// at rest has no sign. With s times the model's friction below that of the plant, the joint still loses energy at every rate. A
/// delay does not change that for Coulomb friction: its compensation is never larger than s F_c, whatever its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionCompensation<T> {
    share: T,
    layer: T,
}

impl<T: RealField + Copy> FrictionCompensation<T> {
    /// The share s of at most 0.9, and epsilon, rad/s or m/s. A tenth is left for the errors of the model.
    ///
    /// # Errors
    /// Where the share is not between 0 and 0.9, or epsilon not positive and finite.
    pub fn new(share: T, layer: T) -> Result<Self, SettingError> {
        settings::not_negative_scalar(Setting::FrictionShare, share)?;
        settings::not_negative_scalar(Setting::FrictionShare, nalgebra::convert::<f64, T>(0.9) - share)?;
        settings::positive_scalar(Setting::FrictionLayer, layer)?;
        Ok(Self { share, layer })
    }

    /// The same with a layer of no width, as the friction of the plant has: to linearise about a moving joint.
    #[cfg(feature = "std")]
    pub(crate) fn sharp(self) -> Self {
        Self { layer: T::zero(), ..self }
    }

    pub(super) fn torque<R: Dynamics<N, Real = T>, const N: usize>(&self, model: &R, state: &State<T, N>) -> SVector<T, N> {
        let offset = model.friction(&SVector::zeros());
        let moving = model.friction(&state.dq) + model.load_friction(&state.q, &state.dq) - offset;
        offset
            + SVector::from_fn(|i, _| {
                let rate = state.dq[i].abs();
                let part = if rate < self.layer { rate / self.layer } else { T::one() };
                moving[i] * (self.share * part)
            })
    }
}
