//! The arm itself: state, integration over one period, energies.

use super::integrator::{dormand_prince, rk4, Integrator, Phase, StepError};
use crate::{linalg::lit, reference::State, robot::Dynamics};
use nalgebra::{RealField, SVector};

/// An arm with a state.
#[derive(Clone, Debug)]
pub struct Plant<'a, R, T, const N: usize> {
    robot: &'a R,
    state: State<T, N>,
    integrator: Integrator<T>,
    /// Next step of the adaptive integrator, s.
    step: T,
    audit: Option<Audit<T>>,
}

#[derive(Clone, Copy, Debug)]
struct Audit<T> {
    start: T,
    supplied: T,
    dissipated: T,
}

/// Where the energy went; J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy<T> {
    /// Kinetic energy T of links and rotors.
    pub kinetic: T,
    /// Potential energy U.
    pub potential: T,
    /// Work of the torques since the start, int tau' dq dt.
    pub supplied: T,
    /// Work of friction since the start, int F' dq dt with all friction in F, positive where friction brakes.
    pub dissipated: T,
    /// Imbalance of energy: T + U - (T + U at the start) - supplied + dissipated. Zero except for the error of integration.
    pub residual: T,
}

/// State and work of friction, moved together.
#[derive(Clone, Copy)]
struct Moving<T, const N: usize> {
    q: SVector<T, N>,
    dq: SVector<T, N>,
    dissipated: T,
}

impl<T: RealField + Copy, const N: usize> Phase<T> for Moving<T, N> {
    #[inline]
    fn plus(&self, h: T, rate: &Self) -> Self {
        Self { q: self.q + rate.q * h, dq: self.dq + rate.dq * h, dissipated: self.dissipated + rate.dissipated * h }
    }

    fn error(&self, scale: &Self) -> T {
        let (a, b) = (Phase::<T>::error(&self.q, &scale.q), Phase::<T>::error(&self.dq, &scale.dq));
        if a > b || !a.is_finite() {
            a
        } else {
            b
        }
    }
}

impl<'a, T: RealField + Copy, R: Dynamics<N, Real = T>, const N: usize> Plant<'a, R, T, N> {
    /// The arm in this state.
    pub fn new(robot: &'a R, state: State<T, N>, integrator: Integrator<T>) -> Self {
        Self { robot, state, integrator, step: T::zero(), audit: None }
    }

    /// The same with its energies accounted for, from now on.
    #[must_use]
    pub fn with_audit(mut self) -> Self {
        let start = self.robot.kinetic_energy(&self.state.q, &self.state.dq) + self.robot.potential_energy(&self.state.q);
        self.audit = Some(Audit { start, supplied: T::zero(), dissipated: T::zero() });
        self
    }

    /// The robot with its true parameters.
    pub fn robot(&self) -> &'a R {
        self.robot
    }

    /// The true state.
    pub fn state(&self) -> &State<T, N> {
        &self.state
    }

    /// Where the energy went; `None` without an audit.
    pub fn energy(&self) -> Option<Energy<T>> {
        let audit = self.audit?;
        let kinetic = self.robot.kinetic_energy(&self.state.q, &self.state.dq);
        let potential = self.robot.potential_energy(&self.state.q);
        let residual = kinetic + potential - audit.start - audit.supplied + audit.dissipated;
        Some(Energy { kinetic, potential, supplied: audit.supplied, dissipated: audit.dissipated, residual })
    }

    /// Moves on by `period`, s, under the held torque `tau`, N m or N.
    ///
    /// # Errors
    /// Where the integrator gives up; the state stays as it was.
    pub fn advance(&mut self, tau: &SVector<T, N>, period: T) -> Result<(), StepError> {
        let robot = self.robot;
        let audits = self.audit.is_some();
        let rate = |_: T, x: &Moving<T, N>| Moving {
            q: x.dq,
            dq: robot.forward_dynamics(&x.q, &x.dq, tau),
            dissipated: if audits { (robot.friction(&x.dq) + robot.load_friction(&x.q, &x.dq)).dot(&x.dq) } else { T::zero() },
        };
        let mut x = Moving { q: self.state.q, dq: self.state.dq, dissipated: T::zero() };
        match self.integrator {
            Integrator::RungeKutta4 { substeps: 0 } => return Err(StepError::BadOptions),
            Integrator::RungeKutta4 { substeps } => {
                let h = period / lit(f64::from(substeps));
                for _ in 0..substeps {
                    x = rk4(&x, h, rate);
                }
            }
            Integrator::DormandPrince { tolerance, most_steps } => {
                x = dormand_prince(&x, period, tolerance, most_steps, &mut self.step, rate)?;
            }
        }
        if let Some(audit) = &mut self.audit {
            // The torque is held: its work is exact.
            audit.supplied += tau.dot(&(x.q - self.state.q));
            audit.dissipated += x.dissipated;
        }
        self.state = State { q: x.q, dq: x.dq };
        Ok(())
    }
}
