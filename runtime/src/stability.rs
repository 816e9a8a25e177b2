//! Stability of the sampled loop, before anything moves.
//!
//! A proof in continuous time proves nothing about a controller that runs once a millisecond. At rest at a posture, plant and
//! controller are linear for small deviations x = (δq, δv) of joint variables and rates:
//!
//! ```text
//! plant        dx/dt = A x + B u,   A = [[0, I], [-B^-1 dg/dq, -B^-1 F_v]],   B = [0; B^-1]
//! hold         x_{k+1} = A_d x_k + B_d u_k,   exp([[A, B], [0, 0]] T_s) = [[A_d, B_d], [0, I]]
//! controller   u_k = K x_k + L m_k,   m_{k+1} = m_k + T_s E x_k                (m: integral or estimate, by forward Euler)
//! ```
//!
//! The loop is stable where all eigenvalues of the whole matrix lie within the unit circle; the largest modulus is its spectral radius. With
//! d samples of delay u_k acts d periods later, and the d torques on their way are a chain of further states. Combinations of estimated
//! parameters are states only if they are excited at rest: the others are constants, and would add eigenvalues at 1.
//!
//! The arm can rest at the posture: estimates equal the plant's parameters, and integrals compensate the model error. A law, or
//! row, without estimate and integral rests off its reference, where its error compensates the model error ([`LineariseAtRest`],
//! [`Rest`]). A start from another estimate is a transient, not a verdict ([`analyse_start`]).
//!
//! A joint that a hand leads ([`HandGuiding`](crate::control::HandGuiding)) rests wherever it is let go: nothing pulls it back. Its position
//! is no state either, and its rate is. Where a wall or a hold pulls it back, both are.
//!
//! This proves that small deviations from rest die away at these postures. It proves nothing about a motion, in which Y(q, dq,
//! dq_r, ddq_r) excites more than rest does, nor about a start far from the true parameters. A [`MotionAnalysis`] examines these.
//!
//! [`SampledLoop`] is one posture; [`analyse`] is a path at rest; [`MotionAnalysis::of`] is the motion. A run reports all of them first.
//!
//! ```
//! use armgen_runtime::control::PdGravity;
//! use armgen_runtime::nalgebra::SVector;
//! use armgen_runtime::robot::Dynamics;
//! use armgen_runtime::stability::{analyse, Delay, StabilityError, StablePeriod};
//!
//! /// The longest sampling period, s, with which a loop with a sample of delay holds these postures; none where even short ones do not.
//! fn longest<R: Dynamics<6, Real = f64>>(robot: &R, postures: &[SVector<f64, 6>]) -> Result<Option<f64>, StabilityError> {
//!     let law = PdGravity::new([2000.0; 6], [200.0; 6]).expect("positive numbers");
//!     let report = analyse(robot, robot, &law, postures, 1e-3, Delay::samples(1))?;
//!     Ok(match report.period {
//!         StablePeriod::UpTo(period) | StablePeriod::AtLeast(period) => Some(period),
//!         StablePeriod::NotEvenAt(_) => None,
//!     })
//! }
//! ```

mod by_differences;
mod delay;
mod difference;
mod eigenvalues;
mod error;
mod exponential;
mod feedback;
mod motion;
mod rest;
mod sampled_loop;

pub use by_differences::ByDifferences;
pub use delay::Delay;
pub use error::StabilityError;
pub use feedback::{Feedback, Linearise, LineariseAtRest, Rest};
pub use motion::{Growth, LineariseInMotion, MotionAnalysis, MotionReport, ReferenceLost, Weights};
pub use sampled_loop::{analyse, analyse_start, Report, SampledLoop, StablePeriod};
