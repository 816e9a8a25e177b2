//! Laws linearised by central differences of their torque: those without a state that the loop has to carry.
//!
//! A law names its reference at a posture, and the analyses follow from its torque. The errors are of the order of the square of the
//! step, the cube root of epsilon. Friction that a law compensates is left out at rest, as the Coulomb friction of the plant is, which
//! exceeds it; in motion it is compensated at every rate.

use super::{
    difference::derivative,
    feedback::{Feedback, Linearise, LineariseAtRest, Rest},
    motion::{LineariseInMotion, Weights},
    rest::rest,
};
use crate::{
    control::{Controller, HandGuiding, Impedance},
    linalg::{is_finite, lit},
    reference::{OperationalReference, Pose, State},
    robot::Dynamics,
};
use nalgebra::{ComplexField, SVector};

/// A law without a state that the loop has to carry.
pub trait ByDifferences<R: Dynamics<N>, const N: usize>: Controller<R, N> + Clone {
    /// The law and its reference under which an arm without model error rests at `q`; without limits of torques, and without
    /// compensation of friction.
    fn resting_at(&self, model: &R, q: &SVector<R::Real, N>) -> (Self, Self::Reference);

    /// The law in motion, without limits of torques.
    #[must_use]
    fn in_motion(&self) -> Self;

    /// The stiffness of each joint at `q`, N m/rad or N/m, positive: it scales deviations.
    fn stiffness(&self, model: &R, q: &SVector<R::Real, N>) -> SVector<R::Real, N>;

    /// Which joints nothing pulls back to `q`.
    fn free(&self, _: &SVector<R::Real, N>) -> [bool; N] {
        [false; N]
    }

    /// Whether a hand leads the arm, so that it has no motion of its own to keep to.
    fn is_led(&self) -> bool {
        false
    }
}

/// The torque of `law` under `reference`, NaN where it refuses.
fn torque<R: Dynamics<N>, C: Controller<R, N> + Clone, const N: usize>(
    (law, reference): &(C, C::Reference),
    model: &R,
    measured: &State<R::Real, N>,
) -> SVector<R::Real, N> {
    let nowhere = SVector::repeat(nalgebra::zero::<R::Real>() / nalgebra::zero());
    law.clone().torque(model, reference, measured).map_or(nowhere, |torque| torque.tau)
}

/// The feedback of `law` under `reference` about rest at `q`; `None` where the law refuses.
fn feedback<R: Dynamics<N>, C: ByDifferences<R, N>, const N: usize>(
    resting: &(C, C::Reference),
    model: &R,
    q: &SVector<R::Real, N>,
) -> Option<Feedback<R::Real, N>> {
    let position = derivative(q, |q| torque(resting, model, &State::at_rest(*q)));
    let velocity = derivative(&SVector::zeros(), |dq| torque(resting, model, &State { q: *q, dq: *dq }));
    let free = resting.0.free(q);
    (is_finite(&position) && is_finite(&velocity)).then(|| Feedback { free, ..Feedback::without_state(position, velocity) })
}

/// A rate, rad/s or m/s, at which a joint counts as just leaving rest.
const CREEP: f64 = 1e-9;

/// The static friction of each joint, N m or N: half the step of friction at rest.
fn static_friction<P: Dynamics<N>, const N: usize>(plant: &P, q: &SVector<P::Real, N>) -> SVector<P::Real, N> {
    let at = |rate: f64| {
        let dq = SVector::repeat(lit::<P::Real>(rate));
        plant.friction(&dq) + plant.load_friction(q, &dq)
    };
    (at(CREEP) - at(-CREEP)) * lit::<P::Real>(0.5)
}

/// At rest the law holds the torque that the model lacks. Joints that nothing pulls back rest where the plant's static friction bears it.
fn settle<P, R, C, const N: usize>(law: &C, plant: &P, model: &R, reference: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>>
where
    P: Dynamics<N>,
    R: Dynamics<N, Real = P::Real>,
    C: ByDifferences<R, N>,
{
    let resting = law.resting_at(model, reference);
    let own = |q: &SVector<R::Real, N>| torque(&law.resting_at(model, q), model, &State::at_rest(*q));
    let lack = |q: &SVector<R::Real, N>| plant.gravity(q) + plant.friction(&SVector::zeros()) - own(q);
    let at = |q: SVector<R::Real, N>, is_held: bool| Some(Rest { q, is_held, feedback: feedback(&resting, model, &q)? });
    let lacking = lack(reference);
    let free = law.free(reference);
    if lacking.amax() == nalgebra::zero() {
        return at(*reference, true);
    }
    if free.iter().any(|free| *free) {
        let bears = static_friction(plant, reference);
        return at(*reference, (0..N).all(|i| !free[i] || lacking[i].abs() <= bears[i]));
    }
    let held = |q: &SVector<R::Real, N>| torque(&resting, model, &State::at_rest(*q)) - own(q);
    match rest(reference, held, lack) {
        Some(q) => at(q, true),
        None => at(*reference, false),
    }
}

/// The analyses of a law by differences, one line for each.
macro_rules! by_differences {
    ($law:ty $(, $size:ident)?) => {
        impl<R: Dynamics<N>, const N: usize $(, const $size: usize)?> Linearise<R, N> for $law {
            fn linearise(&self, model: &R, q: &SVector<R::Real, N>) -> Option<Feedback<R::Real, N>> {
                feedback(&self.resting_at(model, q), model, q)
            }
        }

        impl<P: Dynamics<N>, R: Dynamics<N, Real = P::Real>, const N: usize $(, const $size: usize)?> LineariseAtRest<P, R, N> for $law {
            fn settle(&self, plant: &P, model: &R, reference: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>> {
                settle(self, plant, model, reference)
            }
        }

        impl<P, R: Dynamics<N>, const N: usize $(, const $size: usize)?> LineariseInMotion<P, R, N> for $law {
            fn weights(&self, model: &R, q: &SVector<R::Real, N>) -> Weights<R::Real, N> {
                Weights { stiffness: self.stiffness(model, q), controller_state: Vec::new() }
            }

            fn converged(&self, _: &P) -> Self {
                ByDifferences::<R, N>::in_motion(self)
            }

            fn is_led(&self) -> bool {
                ByDifferences::<R, N>::is_led(self)
            }
        }
    };
}

by_differences!(Impedance<R::Real, N, M>, M);
by_differences!(HandGuiding<R::Real, N>);

/// The reference is the pose at `q`, and the posture of the null space is `q`.
impl<R: Dynamics<N>, const N: usize, const M: usize> ByDifferences<R, N> for Impedance<R::Real, N, M> {
    fn resting_at(&self, model: &R, q: &SVector<R::Real, N>) -> (Self, OperationalReference<R::Real>) {
        let null_space = self.null_space.map(|null_space| null_space.about(*q));
        let law = Self { null_space, friction: None, limits: None, ..*self };
        (law, OperationalReference::at_rest(Pose::of(model, q)))
    }

    fn in_motion(&self) -> Self {
        Self { limits: None, friction: self.friction.map(|friction| friction.sharp()), ..*self }
    }

    /// That of the fastest direction at every joint.
    fn stiffness(&self, model: &R, q: &SVector<R::Real, N>) -> SVector<R::Real, N> {
        let b = model.inertia_matrix(q);
        let fastest = self.directions(&b, &self.task.jacobian(&model.geometric_jacobian(q)));
        let fastest = fastest.map_or(nalgebra::one(), |directions| directions.fastest());
        b.diagonal() * (fastest * fastest)
    }
}

/// The anchor of the hold is at `q`.
impl<R: Dynamics<N>, const N: usize> ByDifferences<R, N> for HandGuiding<R::Real, N> {
    fn resting_at(&self, _: &R, q: &SVector<R::Real, N>) -> (Self, ()) {
        (Self { friction: None, limits: None, ..*self }.with_anchor(*q), ())
    }

    /// The hold slips.
    fn in_motion(&self) -> Self {
        Self { limits: None, hold: None, friction: self.friction.map(|friction| friction.sharp()), ..*self }
    }

    /// D^2 / B: a joint that coasts comes to rest B / D times its rate away.
    fn stiffness(&self, model: &R, q: &SVector<R::Real, N>) -> SVector<R::Real, N> {
        self.damping.component_mul(&self.damping).component_div(&model.inertia_matrix(q).diagonal())
    }

    fn free(&self, q: &SVector<R::Real, N>) -> [bool; N] {
        HandGuiding::free(self, q)
    }

    fn is_led(&self) -> bool {
        true
    }
}
