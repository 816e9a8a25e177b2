//! The whole loop at one posture, and along a path.

use super::{
    delay::Delay,
    difference::derivative,
    eigenvalues,
    error::StabilityError,
    exponential::exponential,
    feedback::{viscous, Feedback, Linearise, LineariseAtRest},
    motion::MotionReport,
};
use crate::{linalg::lit, robot::Dynamics};
use nalgebra::{linalg::balancing::balance_parlett_reinsch, DMatrix, RealField, SMatrix, SVector};

/// Up to which sampling period a loop is stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StablePeriod<T> {
    /// Stable up to this period, s, and unstable just above it.
    UpTo(T),
    /// Stable at this period, s, the longest one tried.
    AtLeast(T),
    /// Unstable even at this period, s, the shortest one tried: no sampling helps.
    NotEvenAt(T),
}

/// Stability of the sampled loop: at rest over all postures, and in motion where that was analysed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report<T> {
    /// The largest spectral radius of all postures; stable below 1.
    pub spectral_radius: T,
    /// Index of the posture where it is found.
    pub posture: usize,
    /// Up to which sampling period the loop is stable at all postures.
    pub period: StablePeriod<T>,
    /// Largest distance of the arm at rest from its reference over all postures and joints, rad or m. Rows or joints without an
    /// integral and the null space cause it. Coulomb friction is not included.
    pub offset: T,
    /// Index of the first posture near which the arm cannot rest: the gains cannot hold the torque that the model leaves out.
    pub without_rest: Option<usize>,
    /// The loop in motion, where it was asked for.
    pub motion: Option<MotionReport<T>>,
}

impl<T: RealField + Copy> Report<T> {
    /// Whether the arm can rest at all postures, and the loop is stable there.
    pub fn is_stable(&self) -> bool {
        self.spectral_radius < T::one() && self.without_rest.is_none()
    }

    /// Whether it is stable at rest and, where that is known, does not diverge in motion.
    pub fn holds(&self) -> bool {
        self.is_stable() && !self.motion.is_some_and(|motion| motion.diverges())
    }
}

/// Plant and controller about one posture.
#[derive(Clone, Debug)]
pub struct SampledLoop<T, const N: usize> {
    /// -B^-1 dg/dq and -B^-1 F_v of the plant, and B^-1.
    acceleration_by_position: SMatrix<T, N, N>,
    acceleration_by_rate: SMatrix<T, N, N>,
    inverse_inertia: SMatrix<T, N, N>,
    feedback: Feedback<T, N>,
    /// How far from its reference the arm rests; `None` where it cannot rest.
    offset: Option<T>,
}

/// Bisections: a tenth halved twenty times is below the millionth that ends them.
const TRIALS: usize = 30;

impl<T: RealField + Copy, const N: usize> SampledLoop<T, N> {
    /// The loop of `plant`, the true arm, and `controller`, which uses `model`, linearised about rest under the reference `q`.
    /// The controller has the states with which the arm can rest; without states, the arm rests off the reference.
    ///
    /// # Errors
    /// [`StabilityError::Singular`] or [`StabilityError::Inertia`], for posture 0.
    pub fn new<P, R, C>(plant: &P, model: &R, controller: &C, q: &SVector<T, N>) -> Result<Self, StabilityError>
    where
        P: Dynamics<N, Real = T>,
        R: Dynamics<N, Real = T>,
        C: LineariseAtRest<P, R, N> + ?Sized,
    {
        let rest = controller.settle(plant, model, q).ok_or(StabilityError::Singular { posture: 0 })?;
        let offset = rest.is_held.then(|| (rest.q - q).amax());
        Ok(Self { offset, ..Self::with_feedback(plant, rest.feedback, &rest.q)? })
    }

    /// The same about the present states of the controller, for instance at the start: the loop until its estimates have moved.
    /// It decides nothing about stability, since the arm cannot rest there.
    ///
    /// # Errors
    /// Those of [`SampledLoop::new`].
    pub fn at_start<P, R, C>(plant: &P, model: &R, controller: &C, q: &SVector<T, N>) -> Result<Self, StabilityError>
    where
        P: Dynamics<N, Real = T>,
        R: Dynamics<N, Real = T>,
        C: Linearise<R, N> + ?Sized,
    {
        Self::with_feedback(plant, controller.linearise(model, q).ok_or(StabilityError::Singular { posture: 0 })?, q)
    }

    fn with_feedback<P: Dynamics<N, Real = T>>(
        plant: &P,
        feedback: Feedback<T, N>,
        q: &SVector<T, N>,
    ) -> Result<Self, StabilityError> {
        let inertia = plant.inertia_matrix(q).cholesky().ok_or(StabilityError::Inertia { posture: 0 })?;
        let inverse_inertia = inertia.inverse();
        let dg = derivative(q, |q| plant.gravity(q));
        Ok(Self {
            acceleration_by_position: -(inverse_inertia * dg),
            acceleration_by_rate: -(inverse_inertia * viscous(plant)),
            inverse_inertia,
            feedback,
            offset: Some(T::zero()),
        })
    }

    /// The matrix of the whole loop, states (δq, T_s δv, m, the torques on their way, the next one first).
    ///
    /// Velocities count in units of T_s so that positions and velocities are of one size.
    fn matrix(&self, period: T, delay: Delay) -> DMatrix<T> {
        let h = period;
        // exp of [[0, I/h, 0], [h S, F, h B^-1], [0, 0, 0]] h, in these units.
        let mut generator = DMatrix::zeros(3 * N, 3 * N);
        for i in 0..N {
            generator[(i, N + i)] = T::one();
            for k in 0..N {
                generator[(N + i, k)] = self.acceleration_by_position[(i, k)] * h * h;
                generator[(N + i, N + k)] = self.acceleration_by_rate[(i, k)] * h;
                generator[(N + i, 2 * N + k)] = self.inverse_inertia[(i, k)] * h * h;
            }
        }
        let held = exponential(&generator);
        let (a, b) = (held.view((0, 0), (2 * N, 2 * N)), held.view((0, 2 * N), (2 * N, N)));
        let controller_states = self.feedback.torque_by_state.ncols();
        let law = DMatrix::from_fn(N, 2 * N + controller_states, |i, k| {
            if k < N {
                self.feedback.position[(i, k)]
            } else if k < 2 * N {
                self.feedback.velocity[(i, k - N)] / h
            } else {
                self.feedback.torque_by_state[(i, k - 2 * N)]
            }
        });
        let (size, samples) = (2 * N + controller_states, delay.count());
        // The position of a joint that nothing pulls back is no state: its row and its column go.
        let without_free = |whole: DMatrix<T>| {
            let kept: Vec<usize> = (0..whole.nrows()).filter(|i| *i >= N || !self.feedback.free[*i]).collect();
            if kept.len() < whole.nrows() {
                whole.select_rows(&kept).select_columns(&kept)
            } else {
                whole
            }
        };
        let all = size + samples * N;
        let mut whole = DMatrix::zeros(all, all);
        whole.view_mut((0, 0), (2 * N, 2 * N)).copy_from(&a);
        for k in 0..controller_states {
            whole[(2 * N + k, 2 * N + k)] = T::one();
            for i in 0..N {
                whole[(2 * N + k, i)] = self.feedback.state_by_position[(k, i)] * h;
                whole[(2 * N + k, N + i)] = self.feedback.state_by_velocity[(k, i)];
            }
        }
        if samples == 0 {
            let mut top = whole.view_mut((0, 0), (2 * N, size));
            top += b * law;
            return without_free(whole);
        }
        // The first of the chain acts, the others move up, the law's torque joins at the end.
        whole.view_mut((0, size), (2 * N, N)).copy_from(&b);
        for i in size..all - N {
            whole[(i, i + N)] = T::one();
        }
        whole.view_mut((all - N, 0), (N, size)).copy_from(&law);
        without_free(whole)
    }

    /// The largest modulus of the eigenvalues at the sampling period `period`, s.
    ///
    /// # Errors
    /// [`StabilityError::Period`], [`StabilityError::Eigenvalues`].
    pub fn spectral_radius(&self, period: T, delay: Delay) -> Result<T, StabilityError> {
        if !(period > T::zero() && period.is_finite()) {
            return Err(StabilityError::Period);
        }
        let mut m = self.matrix(period, delay);
        if !m.iter().all(|x| x.is_finite()) {
            return Err(StabilityError::Eigenvalues);
        }
        balance_parlett_reinsch(&mut m);
        let moduli = eigenvalues::moduli(m).ok_or(StabilityError::Eigenvalues)?;
        let radius = moduli.into_iter().fold(T::zero(), |a, b| if b > a || !b.is_finite() { b } else { a });
        radius.is_finite().then_some(radius).ok_or(StabilityError::Eigenvalues)
    }

    /// Up to which sampling period the loop is stable, looking from `period`, s, upwards if it is stable there, else downwards.
    ///
    /// # Errors
    /// Those of [`SampledLoop::spectral_radius`].
    pub fn largest_stable_period(&self, period: T, delay: Delay) -> Result<StablePeriod<T>, StabilityError> {
        let stable = |t: T| Ok::<_, StabilityError>(self.spectral_radius(t, delay)? < T::one());
        // Steps of a tenth are finer than any window of stability worth using.
        let up = lit::<T>(1.1);
        let (mut low, mut high) = (period, period);
        if stable(period)? {
            loop {
                high = low * up;
                if high > period * lit(1e3) {
                    return Ok(StablePeriod::AtLeast(low));
                }
                if !stable(high)? {
                    break;
                }
                low = high;
            }
        } else {
            loop {
                low = high / up;
                if low < period * lit(1e-4) {
                    return Ok(StablePeriod::NotEvenAt(high));
                }
                if stable(low)? {
                    break;
                }
                high = low;
            }
        }
        for _ in 0..TRIALS {
            let middle = (low * high).sqrt();
            if high / low <= T::one() + lit(1e-6) || middle <= low || middle >= high {
                break;
            }
            if stable(middle)? {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(StablePeriod::UpTo(low))
    }
}

/// Spectral radius and largest stable period of `controller` at all `postures`, at the sampling period `period`, s: about rest, with the
/// states of the controller where the arm can rest.
///
/// # Errors
/// With the index of the posture that has no answer; [`StabilityError::NoPosture`] without any.
pub fn analyse<P, R, C, T, const N: usize>(
    plant: &P,
    model: &R,
    controller: &C,
    postures: &[SVector<T, N>],
    period: T,
    delay: Delay,
) -> Result<Report<T>, StabilityError>
where
    T: RealField + Copy,
    P: Dynamics<N, Real = T>,
    R: Dynamics<N, Real = T>,
    C: LineariseAtRest<P, R, N> + ?Sized,
{
    worst_of(postures, |q| SampledLoop::new(plant, model, controller, q), period, delay)
}

/// The same about the states that the controller has at present: see [`SampledLoop::at_start`].
///
/// # Errors
/// Those of [`analyse`].
pub fn analyse_start<P, R, C, T, const N: usize>(
    plant: &P,
    model: &R,
    controller: &C,
    postures: &[SVector<T, N>],
    period: T,
    delay: Delay,
) -> Result<Report<T>, StabilityError>
where
    T: RealField + Copy,
    P: Dynamics<N, Real = T>,
    R: Dynamics<N, Real = T>,
    C: Linearise<R, N> + ?Sized,
{
    worst_of(postures, |q| SampledLoop::at_start(plant, model, controller, q), period, delay)
}

fn worst_of<T: RealField + Copy, const N: usize>(
    postures: &[SVector<T, N>],
    at: impl Fn(&SVector<T, N>) -> Result<SampledLoop<T, N>, StabilityError>,
    period: T,
    delay: Delay,
) -> Result<Report<T>, StabilityError> {
    let mut worst: Option<(T, usize)> = None;
    let (mut offset, mut without_rest) = (T::zero(), None);
    let mut loops = Vec::with_capacity(postures.len());
    for (posture, q) in postures.iter().enumerate() {
        let sampled = at(q).map_err(|error| match error {
            StabilityError::Singular { .. } => StabilityError::Singular { posture },
            StabilityError::Inertia { .. } => StabilityError::Inertia { posture },
            other => other,
        })?;
        let spectral_radius = sampled.spectral_radius(period, delay)?;
        if worst.is_none_or(|(before, _)| spectral_radius > before) {
            worst = Some((spectral_radius, posture));
        }
        match sampled.offset {
            Some(distance) => offset = offset.max(distance),
            None => without_rest = without_rest.or(Some(posture)),
        }
        loops.push(sampled);
    }
    let (spectral_radius, posture) = worst.ok_or(StabilityError::NoPosture)?;
    // The worst posture first; then only those that are unstable where the others are not.
    let mut limit = loops[posture].largest_stable_period(period, delay)?;
    for sampled in &loops {
        let bound = match limit {
            StablePeriod::UpTo(bound) | StablePeriod::AtLeast(bound) => bound,
            StablePeriod::NotEvenAt(_) => break,
        };
        if sampled.spectral_radius(bound, delay)? >= T::one() {
            limit = sampled.largest_stable_period(bound, delay)?;
        }
    }
    Ok(Report { spectral_radius, posture, period: limit, offset, without_rest, motion: None })
}
