//! The whole loop in continuous time: plant and controller state, integrated together.
//!
//! Lyapunov proofs assume this case. A controller that is stable here may be unstable when sampled, and the comparison shows it.

use super::{
    integrator::rk4,
    run::{diverged, Divergence},
    Phase, RunError,
};
use crate::{linalg::is_finite, linalg::lit, reference::State, robot::Dynamics};
use core::time::Duration;
use nalgebra::{RealField, SVector};

/// How a run in continuous time goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContinuousOptions {
    /// Period at which the state is logged and the law receives a new sample of its reference.
    pub period: Duration,
    /// How long to run; the last sample is the last multiple of the period that is not beyond it.
    pub duration: Duration,
    /// Runge-Kutta steps a period, at least 1.
    pub substeps: u32,
}

/// State of arm and controller at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousSample<T, const N: usize, const P: usize> {
    /// Number of the sample, from 0.
    pub index: u64,
    /// Time since the start.
    pub time: Duration,
    /// The state of the arm.
    pub state: State<T, N>,
    /// Estimate or integral of the controller.
    pub controller_state: SVector<T, P>,
}

#[derive(Clone, Copy)]
struct Whole<T, const N: usize, const P: usize> {
    q: SVector<T, N>,
    dq: SVector<T, N>,
    controller_state: SVector<T, P>,
}

impl<T: RealField + Copy, const N: usize, const P: usize> Phase<T> for Whole<T, N, P> {
    #[inline]
    fn plus(&self, h: T, rate: &Self) -> Self {
        Self {
            q: self.q + rate.q * h,
            dq: self.dq + rate.dq * h,
            controller_state: self.controller_state + rate.controller_state * h,
        }
    }

    fn error(&self, scale: &Self) -> T {
        let q = Phase::<T>::error(&self.q, &scale.q);
        let dq = Phase::<T>::error(&self.dq, &scale.dq);
        let controller_state = Phase::<T>::error(&self.controller_state, &scale.controller_state);
        [dq, controller_state].into_iter().fold(q, |a, b| if b > a || !b.is_finite() { b } else { a })
    }
}

/// Runs the arm `robot` from `start` under `law`, whose controller state starts as `controller_state`; calls `log` at every sample.
///
/// `law(k, t, state, controller_state)` returns the torque, N m or N, and the rate of the controller state, at the time `t`, s, after sample `k`.
///
/// # Errors
/// Where the law refuses, or the state diverges; nothing after that is logged.
pub fn run_continuous<R, T, E, const N: usize, const P: usize>(
    robot: &R,
    start: State<T, N>,
    controller_state: SVector<T, P>,
    options: ContinuousOptions,
    mut law: impl FnMut(u64, T, &State<T, N>, &SVector<T, P>) -> Result<(SVector<T, N>, SVector<T, P>), E>,
    mut log: impl FnMut(&ContinuousSample<T, N, P>),
) -> Result<State<T, N>, RunError<E>>
where
    R: Dynamics<N, Real = T>,
    T: RealField + Copy,
{
    let ContinuousOptions { period, duration, substeps } = options;
    if period.is_zero() || substeps == 0 {
        return Err(RunError::NoPeriod);
    }
    let h = lit::<T>(period.as_secs_f64()) / lit(f64::from(substeps));
    let mut x = Whole { q: start.q, dq: start.dq, controller_state };
    let (mut index, mut time) = (0, Duration::ZERO);
    loop {
        let state = State { q: x.q, dq: x.dq };
        if let Some(divergence) =
            diverged(&state).or_else(|| (!is_finite(&x.controller_state)).then_some(Divergence::ControllerState))
        {
            return Err(RunError::Diverged { time, divergence });
        }
        log(&ContinuousSample { index, time, state, controller_state: x.controller_state });
        let next = time.saturating_add(period);
        if next > duration {
            return Ok(state);
        }
        let mut refused = None;
        for step in 0..substeps {
            let since = h * lit(f64::from(step));
            x = rk4(&x, h, |c, x: &Whole<T, N, P>| {
                match law(index, since + c, &State { q: x.q, dq: x.dq }, &x.controller_state) {
                    Ok((tau, controller_state)) => {
                        Whole { q: x.dq, dq: robot.forward_dynamics(&x.q, &x.dq, &tau), controller_state }
                    }
                    Err(error) => {
                        refused.get_or_insert(error);
                        *x
                    }
                }
            });
            if let Some(error) = refused.take() {
                return Err(RunError::Controller { time, error });
            }
        }
        index += 1;
        time = next;
    }
}
