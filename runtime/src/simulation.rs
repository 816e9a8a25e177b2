//! Simulation of an arm under sampled control, on a host.
//!
//! The plant is a robot value of its own, with its own parameters: the load that the controller does not know is a second value.
//! Between samples the torque is held (zero-order hold) and the equation of motion
//!
//! ```text
//! d/dt (q, dq) = (dq, B^-1 (tau - C dq - F(dq) - g))
//! ```
//!
//! is integrated, by fixed Runge-Kutta steps or by adaptive ones. Sensors may delay and disturb the measurement, from a seed:
//! equal inputs give equal bits. The energy audit compares the change of T + U with the work of the torques and of friction.
//!
//! ```
//! use std::time::Duration;
//! use armgen_runtime::nalgebra::SVector;
//! use armgen_runtime::reference::State;
//! use armgen_runtime::robot::Dynamics;
//! use armgen_runtime::simulation::{run, RunError, RunOptions};
//!
//! /// Where an arm falls within a second without any torque.
//! fn fall<R: Dynamics<6, Real = f64>>(robot: &R, from: SVector<f64, 6>) -> Result<State<f64, 6>, RunError<()>> {
//!     let options = RunOptions::new(Duration::from_millis(1), Duration::from_secs(1));
//!     run(robot, State::at_rest(from), options, |_, _| Ok(SVector::zeros()), |_| {})
//! }
//! ```

mod continuous;
mod integrator;
mod log;
mod plant;
mod run;
mod sensor;

pub use continuous::{run_continuous, ContinuousOptions, ContinuousSample};
pub use integrator::{dormand_prince, rk4, Integrator, Phase, StepError};
pub use log::Log;
pub use plant::{Energy, Plant};
pub use run::{run, Divergence, RunError, RunOptions, Sample, DIVERGENCE_BOUND};
pub use sensor::{Noise, Sensor};
