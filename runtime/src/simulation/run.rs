//! The loop of sampled control: measure, compute, hold, move.

use super::{integrator::StepError, plant::Energy, Integrator, Plant, Sensor};
use crate::{linalg::lit, reference::State, robot::Dynamics};
use core::{error::Error, fmt, time::Duration};
use nalgebra::{RealField, SVector};

/// How a run goes.
#[derive(Clone, Debug)]
pub struct RunOptions<T, const N: usize> {
    /// Sampling period T_s.
    pub period: Duration,
    /// How long to run; the last sample is the last multiple of the period that is not beyond it.
    pub duration: Duration,
    /// How the plant is integrated between samples.
    pub integrator: Integrator<T>,
    /// Sensor between plant and controller.
    pub sensor: Sensor<T, N>,
    /// Whether energies are accounted for.
    pub audit: bool,
}

impl<T: RealField + Copy, const N: usize> RunOptions<T, N> {
    /// Ideal sensors, one Runge-Kutta step a sample, no audit.
    pub fn new(period: Duration, duration: Duration) -> Self {
        let integrator = Integrator::RungeKutta4 { substeps: 1 };
        Self { period, duration, integrator, sensor: Sensor::ideal(), audit: false }
    }
}

/// One sample of a run: the state at `time`, and the torque that is held from then on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T, const N: usize> {
    /// Number of the sample, from 0.
    pub index: u64,
    /// Time since the start.
    pub time: Duration,
    /// The true state.
    pub state: State<T, N>,
    /// The state as measured.
    pub measured: State<T, N>,
    /// The torque held from `time` on, N m or N.
    pub tau: SVector<T, N>,
    /// Energies, with an audit.
    pub energy: Option<Energy<T>>,
}

/// Joint variables, rad or m, and rates, per s, that no arm reaches: beyond, a run has diverged.
pub const DIVERGENCE_BOUND: f64 = 1e6;

/// What went beyond [`DIVERGENCE_BOUND`], or became infinite or NaN; joints count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Divergence {
    /// The rate of this joint.
    Rate(usize),
    /// The variable of this joint.
    Position(usize),
    /// The controller state, in continuous time.
    ControllerState,
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Divergence::Rate(joint) => write!(f, "joint {joint} (from 0) passed {DIVERGENCE_BOUND:e} rad/s or m/s"),
            Divergence::Position(joint) => write!(f, "joint {joint} (from 0) passed {DIVERGENCE_BOUND:e} rad or m"),
            Divergence::ControllerState => write!(f, "the controller state is no longer finite"),
        }
    }
}

/// The joint rate or joint variable beyond the divergence bound, if any; rates first, since divergence shows there first.
pub(super) fn diverged<T: RealField + Copy, const N: usize>(state: &State<T, N>) -> Option<Divergence> {
    let first = |x: &SVector<T, N>| {
        // Infinities and NaN count as largest.
        let size = |i: usize| if x[i].is_finite() { x[i].abs() } else { lit(f64::MAX) };
        let largest = (0..N).reduce(|a, b| if size(b) > size(a) { b } else { a })?;
        (size(largest) > lit(DIVERGENCE_BOUND)).then_some(largest)
    };
    first(&state.dq).map(Divergence::Rate).or_else(|| first(&state.q).map(Divergence::Position))
}

/// Why a run ended early, and when; the samples before were logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunError<E> {
    /// The controller gave an error instead of a torque.
    Controller {
        /// The sample's time.
        time: Duration,
        /// The controller's error.
        error: E,
    },
    /// The state has left what any arm does: the loop is unstable.
    Diverged {
        /// The time of the first such state.
        time: Duration,
        /// What went beyond all bounds.
        divergence: Divergence,
    },
    /// The integrator gave up.
    Integrator {
        /// The start of the period that could not be integrated.
        time: Duration,
        /// Why.
        error: StepError,
    },
    /// The period is zero, or is to be covered in no steps.
    NoPeriod,
}

impl<E: fmt::Display> fmt::Display for RunError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RunError::Controller { time, error } => write!(f, "at {} s: {error}", time.as_secs_f64()),
            RunError::Diverged { time, divergence } => write!(f, "diverged at {} s: {divergence}", time.as_secs_f64()),
            RunError::Integrator { time, error } => write!(f, "at {} s: {error}", time.as_secs_f64()),
            RunError::NoPeriod => write!(f, "the period is zero, or is to be covered in no steps"),
        }
    }
}

impl<E: Error + 'static> Error for RunError<E> {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            RunError::Controller { error, .. } => Some(error),
            RunError::Integrator { error, .. } => Some(error),
            RunError::Diverged { .. } | RunError::NoPeriod => None,
        }
    }
}

/// Runs `controller` on the arm `robot` from `start`; calls `log` at every sample.
///
/// `controller(t, measured)` returns the torque to hold from the sample at `t` on; it owns references and controller state.
/// The torque of the last sample is computed and logged, but moves nothing any more.
///
/// # Errors
/// Where the controller refuses, the state diverges or the integrator gives up; nothing after that is logged.
pub fn run<R, T, E, const N: usize>(
    robot: &R,
    start: State<T, N>,
    options: RunOptions<T, N>,
    mut controller: impl FnMut(Duration, &State<T, N>) -> Result<SVector<T, N>, E>,
    mut log: impl FnMut(&Sample<T, N>),
) -> Result<State<T, N>, RunError<E>>
where
    R: Dynamics<N, Real = T>,
    T: RealField + Copy,
{
    let RunOptions { period, duration, integrator, mut sensor, audit } = options;
    if period.is_zero() {
        return Err(RunError::NoPeriod);
    }
    let h = lit::<T>(period.as_secs_f64());
    let mut plant = Plant::new(robot, start, integrator);
    if audit {
        plant = plant.with_audit();
    }
    let (mut index, mut time) = (0, Duration::ZERO);
    loop {
        let state = *plant.state();
        if let Some(divergence) = diverged(&state) {
            return Err(RunError::Diverged { time, divergence });
        }
        let measured = sensor.measure(&state);
        let tau = controller(time, &measured).map_err(|error| RunError::Controller { time, error })?;
        log(&Sample { index, time, state, measured, tau, energy: plant.energy() });
        let next = time.saturating_add(period);
        if next > duration {
            return Ok(state);
        }
        plant.advance(&tau, h).map_err(|error| RunError::Integrator { time, error })?;
        index += 1;
        time = next;
    }
}
