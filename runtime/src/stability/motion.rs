//! The loop in motion: small deviations along the reference, and the run simulated.
//!
//! At rest only those directions of an estimate count that gravity excites, and C dq is of second order. In motion neither holds. So small
//! deviations x = (δq, δv, δm) of joint variables, rates and controller states m are carried along the reference as it will be run, sample by sample:
//!
//! ```text
//! x_{k+1} = A_k x_k,     A_k = d(q, dq, m)_{k+1} / d(q, dq, m)_k     at the reference of sample k, with m where the arm can rest
//! ```
//!
//! the discrete linear time-varying loop. A_k is never formed. For each deviation law and plant are evaluated twice a sample, at
//! the reference plus and minus a multiple of it. The plant starts each sample on the reference, under the reference torque plus
//! the answer of the law to the deviation. Torque limits are not active.
//!
//! An estimate that is far from the truth is no small deviation: it changes the gain of the loop, and with it whether the sampling bears it.
//! So the run itself is simulated, too, with its limits, from where it begins: without noise, one Runge-Kutta step a sample.
//!
//! The analysis proves whether the run, without noise, keeps to its reference, and how much the propagated deviations grow on
//! this motion. Another deviation may grow more at first. Every propagated deviation has a component along an exponentially
//! growing direction, which comes to dominate. The analysis proves nothing about another motion, a longer motion or another load.

use super::{delay::Delay, error::StabilityError};
use crate::{
    control::{Adaptive, Controller, InverseDynamics, Limited, OperationalSpace, PdGravity, Robust},
    linalg::lit,
    reference::{JointReference, State},
    robot::{Dynamics, Regressor},
    simulation::{Integrator, Plant},
};
use nalgebra::{RealField, SVector};
use std::collections::VecDeque;

/// Scales of deviations, from an energy, so that pure oscillations do not seem to grow.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights<T, const N: usize> {
    /// Stiffness of each joint, N m/rad or N/m.
    pub stiffness: SVector<T, N>,
    /// For each controller state, J per squared unit; zero for a state that does not move.
    pub controller_state: Vec<T>,
}

/// A controller whose state can be read and set, as the analysis of a motion needs.
pub trait LineariseInMotion<P, R: Dynamics<N>, const N: usize>: Controller<R, N> + Clone {
    /// Weights of deviations about the posture `q`.
    fn weights(&self, model: &R, q: &SVector<R::Real, N>) -> Weights<R::Real, N>;

    /// The same without torque limits, its estimate at its equilibrium under `plant`, its integral at zero.
    #[must_use]
    fn converged(&self, plant: &P) -> Self;

    /// Whether a hand leads the arm: then it has no motion of its own that could be lost.
    fn is_led(&self) -> bool {
        false
    }

    /// The estimate or the integral.
    fn controller_state(&self) -> Vec<R::Real> {
        Vec::new()
    }

    /// The same controller with this state; states beyond the end of the slice stay unchanged.
    #[must_use]
    fn with_controller_state(&self, _: &[R::Real]) -> Self {
        self.clone()
    }
}

impl<P, R: Dynamics<N>, const N: usize> LineariseInMotion<P, R, N> for PdGravity<R::Real, N> {
    fn converged(&self, _: &P) -> Self {
        Self { limits: None, ..*self }
    }

    fn weights(&self, _: &R, _: &SVector<R::Real, N>) -> Weights<R::Real, N> {
        Weights { stiffness: self.k_p, controller_state: Vec::new() }
    }
}

impl<P, R: Dynamics<N>, const N: usize> LineariseInMotion<P, R, N> for InverseDynamics<R::Real, N> {
    fn converged(&self, _: &P) -> Self {
        Self { limits: None, ..*self }
    }

    fn weights(&self, model: &R, q: &SVector<R::Real, N>) -> Weights<R::Real, N> {
        Weights { stiffness: self.k_p.component_mul(&model.inertia_matrix(q).diagonal()), controller_state: Vec::new() }
    }
}

impl<P, R: Dynamics<N>, const N: usize> LineariseInMotion<P, R, N> for Robust<R::Real, N> {
    fn converged(&self, _: &P) -> Self {
        Self { limits: None, ..*self }
    }

    fn weights(&self, model: &R, q: &SVector<R::Real, N>) -> Weights<R::Real, N> {
        Weights { stiffness: self.k_p.component_mul(&model.inertia_matrix(q).diagonal()), controller_state: Vec::new() }
    }
}

/// With the weights of V = 1/2 sigma' B sigma + e' Lambda K_D e + 1/2 (pi^ - pi)' K_pi (pi^ - pi), which decreases in continuous time.
impl<P, R, const N: usize, const K: usize> LineariseInMotion<P, R, N> for Adaptive<R::Real, N, K>
where
    P: Regressor<N, K>,
    R: Regressor<N, K, Real = P::Real>,
{
    fn converged(&self, plant: &P) -> Self {
        Self { limits: None, ..self.at_rest(&plant.parameters()) }
    }

    fn weights(&self, _: &R, _: &SVector<R::Real, N>) -> Weights<R::Real, N> {
        let weight =
            |gain: &R::Real| if *gain > nalgebra::zero() { nalgebra::one::<R::Real>() / *gain } else { nalgebra::zero() };
        let stiffness = self.lambda.component_mul(&self.k_d) * lit::<R::Real>(2.0);
        Weights { stiffness, controller_state: self.adaptation_gain.iter().map(weight).collect() }
    }

    fn controller_state(&self) -> Vec<R::Real> {
        self.estimate.as_slice().to_vec()
    }

    fn with_controller_state(&self, controller_state: &[R::Real]) -> Self {
        Self { estimate: state_or(&self.estimate, controller_state), ..*self }
    }
}

/// The weight of an integral is that of the error that asks as much: K_I int = K_P e.
impl<P, R: Dynamics<N>, const N: usize, const M: usize> LineariseInMotion<P, R, N> for OperationalSpace<R::Real, N, M> {
    fn converged(&self, _: &P) -> Self {
        Self { limits: None, integral: SVector::zeros(), integral_limit: None, ..*self }
    }

    fn weights(&self, model: &R, q: &SVector<R::Real, N>) -> Weights<R::Real, N> {
        let j = self.task.jacobian(&model.geometric_jacobian(q));
        let b = model.inertia_matrix(q).diagonal();
        let size = (j.transpose() * j).diagonal().max();
        let mass = b.max() / if size > nalgebra::zero() { size } else { nalgebra::one() };
        let controller_state = (0..M).map(|i| mass * self.k_i[i] * self.k_i[i] / self.k_p[i]).collect();
        Weights { stiffness: b * self.k_p.max(), controller_state }
    }

    fn controller_state(&self) -> Vec<R::Real> {
        self.integral.as_slice().to_vec()
    }

    fn with_controller_state(&self, controller_state: &[R::Real]) -> Self {
        Self { integral: state_or(&self.integral, controller_state), ..*self }
    }
}

/// The law that it keeps within limits, and the same without them.
impl<P, R: Dynamics<N>, const N: usize, const M: usize> LineariseInMotion<P, R, N> for Limited<R::Real, N, M> {
    fn converged(&self, plant: &P) -> Self {
        self.without_limits().with_law(LineariseInMotion::<P, R, N>::converged(&self.law, plant))
    }

    fn weights(&self, model: &R, q: &SVector<R::Real, N>) -> Weights<R::Real, N> {
        LineariseInMotion::<P, R, N>::weights(&self.law, model, q)
    }

    fn controller_state(&self) -> Vec<R::Real> {
        LineariseInMotion::<P, R, N>::controller_state(&self.law)
    }

    fn with_controller_state(&self, controller_state: &[R::Real]) -> Self {
        self.with_law(LineariseInMotion::<P, R, N>::with_controller_state(&self.law, controller_state))
    }
}

/// The values of a controller state, and the present ones where there are too few.
fn state_or<T: RealField + Copy, const K: usize>(present: &SVector<T, K>, state: &[T]) -> SVector<T, K> {
    SVector::from_fn(|i, _| state.get(i).copied().unwrap_or(present[i]))
}

/// How much small deviations grow on a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth<T> {
    /// The largest size of a deviation that began with size 1.
    pub largest: T,
    /// When it is reached, s.
    pub at: T,
    /// The rate at which it goes on growing, 1/s: from the third to the last quarter.
    pub rate: T,
    /// Whether growth continues without bound, as far as the motion shows. Either a micrometre becomes a metre, or growth beyond
    /// a factor of 10 continues at a rate that matters over the motion.
    pub unbounded: bool,
}

/// Where a simulated run leaves its reference by more than 1 rad or m, or has no torque any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceLost<T> {
    /// When, s.
    pub at: T,
    /// At which sample, counted from 0.
    pub sample: usize,
    /// Which joint is off most, counted from 0.
    pub joint: usize,
}

/// The loop in motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionReport<T> {
    /// Growth of small deviations along the reference, until the run is lost.
    pub growth: Growth<T>,
    /// Where the run itself is lost; `None` where it keeps to its reference to the end.
    pub lost: Option<ReferenceLost<T>>,
}

impl<T: RealField + Copy> MotionReport<T> {
    /// Whether the loop diverges on this motion.
    pub fn diverges(&self) -> bool {
        self.growth.unbounded || self.lost.is_some()
    }
}

/// An error of a joint, rad or m, at which a simulated run is lost.
const LOST_ERROR: f64 = 1.0;
/// Growth from which on a loop counts as lost, whatever comes after.
const LOST_GROWTH: f64 = 1e6;
/// Transient growth below this factor is not called unbounded: a stable loop can reach it.
const TRANSIENT_GROWTH: f64 = 10.0;
/// Least rate times duration at which growth counts as continuing: a factor of e over the motion.
const LASTING_GROWTH: f64 = 1.0;
/// Part of a controller state's deviation that counts for the length of a difference.
const CONTROLLER_STATE: f64 = 1e-6;
/// In place of a size of zero, where that divides.
const TINY: f64 = 1e-30;

/// A run to analyse.
#[derive(Clone, Debug)]
pub struct MotionAnalysis<'a, P, T, const N: usize> {
    /// The arm as it is.
    pub plant: &'a P,
    /// Reference at each sample.
    pub joints: &'a [JointReference<T, N>],
    /// Where the arm begins.
    pub start: State<T, N>,
    /// The sampling period, s.
    pub period: T,
    /// Samples between measurement and torque.
    pub delay: Delay,
}

/// Answer of a law: torque, and the controller state of the next sample.
type Answer<T, const N: usize> = (SVector<T, N>, Vec<T>);

/// The law of sample k as a function of measurement and controller state; `None` where it refuses.
type AnyLaw<'l, T, const N: usize> = dyn Fn(usize, &State<T, N>, &[T]) -> Option<Answer<T, N>> + 'l;

/// A deviation of state and controller state, with the deviations of the states still to be measured, oldest first.
#[derive(Clone, Debug)]
struct Deviation<T, const N: usize> {
    state: State<T, N>,
    controller_state: Vec<T>,
    unseen: VecDeque<State<T, N>>,
}

impl<P, T, const N: usize> MotionAnalysis<'_, P, T, N>
where
    T: RealField + Copy,
    P: Dynamics<N, Real = T>,
{
    /// Analyses the motion under `controller`, which uses `model` of the arm; `references` are the controller's own, one a sample.
    ///
    /// # Errors
    /// [`StabilityError::NoSample`] without a sample, [`StabilityError::Period`] where the period is not positive and finite,
    /// [`StabilityError::NoReference`] where `references` has fewer samples than `joints`, [`StabilityError::SingularAtSample`]
    /// with the number of the sample at which the law is singular on the reference.
    pub fn of<R, C>(&self, model: &R, controller: &C, references: &[C::Reference]) -> Result<MotionReport<T>, StabilityError>
    where
        R: Dynamics<N, Real = T>,
        C: LineariseInMotion<P, R, N>,
    {
        if !(self.period > T::zero() && self.period.is_finite()) {
            return Err(StabilityError::Period);
        }
        let first = references.first().and(self.joints.first()).ok_or(StabilityError::NoSample)?;
        if references.len() < self.joints.len() {
            return Err(StabilityError::NoReference { sample: references.len() });
        }
        let law = |controller: &C, k: usize, measured: &State<T, N>, controller_state: &[T]| {
            let mut controller = controller.with_controller_state(controller_state);
            let torque = controller.torque(model, references.get(k)?, measured).ok()?;
            Some((torque.tau, controller.controller_state()))
        };
        let run = || {
            self.run(controller.controller_state(), &|k, measured, controller_state| {
                law(controller, k, measured, controller_state)
            })
        };
        let lost = if controller.is_led() { None } else { run() };
        let converged = controller.converged(self.plant);
        let loop_ = Linear {
            analysis: self,
            weights: converged.weights(model, &first.q),
            inertia: self.plant.inertia_matrix(&first.q).diagonal(),
            controller_state: converged.controller_state(),
        };
        // Where the run is lost, nothing after it counts.
        let samples = lost.map_or(self.joints.len(), |lost| lost.sample + 1);
        let growth = loop_.growth(samples, &|k, measured, controller_state| law(&converged, k, measured, controller_state))?;
        Ok(MotionReport { growth, lost })
    }

    /// The run from its start, without noise.
    fn run(&self, mut controller_state: Vec<T>, law: &AnyLaw<'_, T, N>) -> Option<ReferenceLost<T>> {
        let mut plant = Plant::new(self.plant, self.start, Integrator::RungeKutta4 { substeps: 1 });
        let mut unseen: VecDeque<State<T, N>> = vec![self.start; self.delay.count()].into();
        let mut joint = 0;
        for (k, reference) in self.joints.iter().enumerate() {
            let state = *plant.state();
            let lost = ReferenceLost { at: self.period * lit(k as f64), sample: k, joint };
            if !state.is_finite() {
                return Some(lost);
            }
            let error = (reference.q - state.q).abs();
            joint = error.imax();
            let lost = ReferenceLost { joint, ..lost };
            if error[joint] > lit(LOST_ERROR) {
                return Some(lost);
            }
            unseen.push_back(state);
            let measured = unseen.pop_front()?;
            let Some((tau, next)) = law(k, &measured, &controller_state) else { return Some(lost) };
            controller_state = next;
            if plant.advance(&tau, self.period).is_err() {
                return Some(lost);
            }
        }
        None
    }
}

/// The linear loop along the reference.
struct Linear<'a, P, T, const N: usize> {
    analysis: &'a MotionAnalysis<'a, P, T, N>,
    weights: Weights<T, N>,
    /// Diagonal of B at the start.
    inertia: SVector<T, N>,
    controller_state: Vec<T>,
}

impl<P, T, const N: usize> Linear<'_, P, T, N>
where
    T: RealField + Copy,
    P: Dynamics<N, Real = T>,
{
    fn growth(&self, samples: usize, law: &AnyLaw<'_, T, N>) -> Result<Growth<T>, StabilityError> {
        let period = self.analysis.period;
        let mut deviations = self.deviations();
        let mut logarithms = vec![T::zero(); deviations.len()];
        let (mut largest, mut at) = (T::zero(), T::zero());
        // Logarithms of the largest sizes in the third and in the last quarter.
        let mut quarters: [Option<T>; 2] = [None; 2];
        for k in 0..samples {
            let after = period * lit((k + 1) as f64);
            for (deviation, logarithm) in deviations.iter_mut().zip(&mut logarithms) {
                self.carry(k, deviation, law).ok_or(StabilityError::SingularAtSample { sample: k })?;
                let size = self.size(deviation);
                *logarithm += size.max(lit(TINY)).ln();
                if !size.is_finite() || *logarithm > largest {
                    (largest, at) = (*logarithm, after);
                }
                if let Some(quarter) = (4 * k / samples).checked_sub(2) {
                    let before = quarters[quarter].get_or_insert(*logarithm);
                    *before = before.max(*logarithm);
                }
                // Within the range where a difference is a derivative.
                deviation.scale(T::one() / size.max(lit(TINY)));
            }
            if !(largest < lit(LOST_GROWTH.ln())) {
                // The rate of the way there: nothing after it counts.
                let largest = if largest.is_finite() { largest } else { lit(f64::MAX.ln()) };
                return Ok(Growth { largest: largest.exp(), at, rate: largest / at, unbounded: true });
            }
        }
        let duration = period * lit(samples as f64);
        let rate = if let [Some(third), Some(last)] = quarters { (last - third) * lit(4.0) / duration } else { T::zero() };
        let unbounded = largest > lit(TRANSIENT_GROWTH.ln()) && rate * duration > lit(LASTING_GROWTH);
        Ok(Growth { largest: largest.exp(), at, rate, unbounded })
    }

    /// Deviations of all joint variables, of all rates, of all of these with the controller state, and of the controller state alone. Signs alternate in another
    /// way in each, so that no two joints move as one.
    fn deviations(&self) -> Vec<Deviation<T, N>> {
        let sign =
            |i: usize, kind: usize| lit::<T>(if (i * (2 * kind + 1) + i / 2 + kind).is_multiple_of(3) { -1.0 } else { 1.0 });
        let zeros = || SVector::<T, N>::zeros();
        let q = SVector::from_fn(|i, _| sign(i, 0) / self.weights.stiffness[i].sqrt());
        let v = SVector::from_fn(|i, _| sign(i, 1) / self.inertia[i].sqrt());
        let of = |(i, w): (usize, &T)| if *w > T::zero() { sign(i, 2) / w.sqrt() } else { T::zero() };
        let m: Vec<T> = self.weights.controller_state.iter().enumerate().map(of).collect();
        let none = vec![T::zero(); m.len()];
        let moves = m.iter().any(|m| *m != T::zero());
        let all = [(q, zeros(), none.clone()), (zeros(), v, none), (q, -v, m.clone()), (zeros(), zeros(), m)];
        let deviation = |(q, dq, controller_state)| {
            let unseen = vec![State::at_rest(zeros()); self.analysis.delay.count()].into();
            let mut deviation = Deviation { state: State { q, dq }, controller_state, unseen };
            deviation.scale(T::one() / self.size(&deviation));
            deviation
        };
        all.into_iter().take(if moves { 4 } else { 3 }).map(deviation).collect()
    }

    fn size(&self, deviation: &Deviation<T, N>) -> T {
        let State { q, dq } = &deviation.state;
        let state = (0..N).map(|i| self.weights.stiffness[i] * q[i] * q[i] + self.inertia[i] * dq[i] * dq[i]);
        let controller_state =
            deviation.controller_state.iter().zip(&self.weights.controller_state).map(|(m, weight)| *weight * *m * *m);
        state.chain(controller_state).fold(T::zero(), |a, b| a + b).sqrt()
    }

    /// Carries a deviation from sample k to the next one; `None` where the law refuses.
    fn carry(&self, k: usize, deviation: &mut Deviation<T, N>, law: &AnyLaw<'_, T, N>) -> Option<()> {
        let MotionAnalysis { plant, joints, delay, .. } = *self.analysis;
        let half = lit::<T>(0.5);
        deviation.unseen.push_back(deviation.state);
        let seen_deviation = deviation.unseen.pop_front()?;
        let (reference, seen) = (&joints[k], &joints[k.saturating_sub(delay.count())]);
        // The largest element of the state is moved by the cube root of epsilon. Torques are linear in a controller state, which may be moved more.
        let largest = [seen_deviation, deviation.state].iter().fold(T::zero(), |a, x| a.max(x.q.amax()).max(x.dq.amax()));
        let controller_state = deviation.controller_state.iter().fold(T::zero(), |a, b| a.max(b.abs()));
        let h = T::default_epsilon().cbrt() / largest.max(controller_state * lit(CONTROLLER_STATE)).max(lit(TINY));
        let at = |reference: &JointReference<T, N>, by: &State<T, N>, h: T| State {
            q: reference.q + by.q * h,
            dq: moving(&reference.dq) + by.dq * h,
        };
        let answer = |h: T| {
            let controller_state: Vec<T> =
                self.controller_state.iter().zip(&deviation.controller_state).map(|(m, by)| *m + *by * h).collect();
            law(k, &at(seen, &seen_deviation, h), &controller_state)
        };
        let ((high, high_state), (low, low_state)) = (answer(h)?, answer(-h)?);
        let answered = (high - low) * half;
        let held = plant.inverse_dynamics(&reference.q, &moving(&reference.dq), &reference.ddq);
        let next = |sign: T| self.advance(at(reference, &deviation.state, h * sign), &(held + answered * sign));
        let (high, low) = (next(T::one()), next(-T::one()));
        deviation.state = State { q: (high.q - low.q) * (half / h), dq: (high.dq - low.dq) * (half / h) };
        for (i, m) in deviation.controller_state.iter_mut().enumerate() {
            if self.weights.controller_state[i] > T::zero() {
                *m = (high_state[i] - low_state[i]) * (half / h);
            }
        }
        Some(())
    }

    /// The plant one period on under a held torque: Heun's method, since nothing but the arm's own motion moves within a period.
    fn advance(&self, State { q, dq }: State<T, N>, tau: &SVector<T, N>) -> State<T, N> {
        let MotionAnalysis { plant, period: h, .. } = *self.analysis;
        let half = lit::<T>(0.5);
        let a = plant.forward_dynamics(&q, &dq, tau);
        let b = plant.forward_dynamics(&(q + dq * h + a * (half * h * h)), &(dq + a * h), tau);
        let mean = (a + b) * half;
        State { q: q + dq * h + (a + mean) * (h * h / lit(4.0)), dq: dq + mean * h }
    }
}

impl<T: RealField + Copy, const N: usize> Deviation<T, N> {
    fn scale(&mut self, by: T) {
        let scale = |x: &mut State<T, N>| {
            x.q *= by;
            x.dq *= by;
        };
        scale(&mut self.state);
        self.unseen.iter_mut().for_each(scale);
        self.controller_state.iter_mut().for_each(|m| *m *= by);
    }
}

/// Rates at which Coulomb friction keeps its sign while a deviation is taken: a joint at rest counts as one that creeps.
fn moving<T: RealField + Copy, const N: usize>(dq: &SVector<T, N>) -> SVector<T, N> {
    let creep = lit::<T>(10.0) * T::default_epsilon().cbrt();
    dq.map(|v| match v.abs() > creep {
        true => v,
        false if v < T::zero() => -creep,
        false => creep,
    })
}
