//! Closed-loop inverse kinematics: joint motions that follow a motion of the end effector.
//!
//! Integrating dq = J^-1 v alone drifts, so the laws feed back the error e = x_d - x(q) of the task rows. Linear rows obey de =
//! v_d - J dq exactly. Angular rows obey it to second order in the whole rotation error, where a turn that the task leaves free
//! is 0 ([`Task::error`](crate::task::Task::error)). So
//!
//! | algorithm | law | error | the book |
//! |---|---|---|---|
//! | [`JacobianInverse`] | dq = J^-1 (v_d + K e) | de + K e = 0 | Sect. 3.7.1, eq. 3.70 |
//! | [`JacobianTranspose`] | dq = J' K e | bounded while x_d moves, 0 at rest unless it stalls at a singular posture where J' K e = 0 | Sect. 3.7.2, eq. 3.76 |
//! | [`PseudoInverse`] | dq = J^+ (v_d + K e) + (I - J^+ J) dq_0 | de + K e = 0 | Sect. 3.7.1, eq. 3.72 |
//! | [`DampedLeastSquares`] | dq = J' (J J' + lambda^2 I)^-1 (v_d + K e) | as the inverse, away from singularities | Sect. 3.5, eq. 3.59 |
//! | [`SecondOrder`] | ddq = J^+ (a_d + K_D de + K_P e - dJ dq) | dde + K_D de + K_P e = 0 | Sect. 3.7.4, eq. 3.100 |
//!
//! Sampled at T_s these hold while T_s K is small: the inverse wants T_s k < 2, the transpose T_s lambda_max(J' K J) < 2
//! ([`JacobianTranspose::loop_gain`]).
//!
//! [`Clik`] runs a first-order algorithm: it bounds the rates, stops at joint limits and names what happened ([`Outcome`]).
//! [`Limited`] finds the best rates within limits of position, rate and acceleration, for tasks in order of priority.
//!
//! ```
//! use armgen_runtime::clik::{Clik, ClikError, DampedLeastSquares, JointLimits, Outcome};
//! use armgen_runtime::linalg::Damping;
//! use armgen_runtime::nalgebra::SVector;
//! use armgen_runtime::reference::Pose;
//! use armgen_runtime::robot::Kinematics;
//! use armgen_runtime::task::{Row, Task};
//!
//! /// Joint variables that bring the end effector to a position, if there are any near `from`.
//! fn reach<R: Kinematics<6, Real = f64>>(robot: &R, goal: &Pose<f64>, from: &SVector<f64, 6>) -> Result<Option<SVector<f64, 6>>, ClikError> {
//!     let task = Task::new([Row::X, Row::Y, Row::Z]).expect("no row stands twice");
//!     let damping = Damping::below(0.02).at_most(0.05).expect("positive numbers");
//!     let law = DampedLeastSquares::new([150.0; 3], damping).expect("positive numbers");
//!     let limits = JointLimits::rates([100.0; 6]).expect("positive numbers");
//!     let clik = Clik::new(task, law, 1e-3, limits, [1e-5; 3]).expect("positive numbers");
//!     let reached = clik.approach(robot, from, goal, 1000)?;
//!     Ok((reached.outcome == Outcome::Converged).then_some(reached.q))
//! }
//! ```

mod first_order;
mod follow;
mod limited;
mod limits;
mod objective;
mod second_order;

pub use first_order::{Algorithm, DampedLeastSquares, JacobianInverse, JacobianTranspose, PseudoInverse, Rates};
pub use follow::{Clik, Reached, Step};
pub use limited::{Limited, LimitedSample, LimitedStep};
pub use limits::{Bounds, JointLimits, WithinRange};
pub use objective::{JointRangeDistance, Manipulability, NoObjective, Objective};
pub use second_order::{Integration, SecondOrder, SecondOrderStep};

/// Why there is no step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ClikError {
    /// Joint variables or rates are infinite or NaN.
    StateNotFinite,
    /// The reference is infinite or NaN.
    ReferenceNotFinite,
    /// The Jacobian of the task has lost rank and the algorithm has no damping: use [`DampedLeastSquares`], or keep away.
    Singular,
    /// The law gave infinite or NaN rates: gains or model are beyond the range of the scalar.
    RatesNotFinite,
    /// The quadratic program of a level has no solution: its numbers are infinite or NaN, or beyond the range of the scalar.
    NotSolved,
}

messages! { ClikError,
    ClikError::StateNotFinite => "joint variables or rates are infinite or NaN";
    ClikError::ReferenceNotFinite => "the reference is infinite or NaN";
    ClikError::Singular => "the Jacobian of the task has lost rank: use damped least squares, or keep away from singular postures";
    ClikError::RatesNotFinite => "the rates or accelerations are infinite or NaN: gains or model are beyond the range of the scalar";
    ClikError::NotSolved => "the quadratic program of a level has no solution: its numbers are infinite, NaN, or beyond the range of the scalar";
}

/// Outcome of a step, or of a whole approach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Outcome {
    /// Every error is within its tolerance.
    Converged,
    /// The error is above its tolerance, and the law is active.
    Tracking,
    /// A rate limit slowed the motion down, along its direction.
    RateLimited,
    /// Near a singularity: rates are damped, and the error closes more slowly than by its gain.
    Damped,
    /// Near a singularity, where the remaining error, weighted by K, points in a direction in which the arm cannot move. After a
    /// single step the goal may still be reachable, for instance inwards along a stretched arm. After an
    /// [`approach`](Clik::approach) it is out of reach: the arm, moved aside, came to rest no nearer.
    OutOfReach,
    /// This joint is at its limit and the law moves it further out.
    JointLimit {
        /// The joint, counted from 0.
        joint: usize,
    },
    /// An approach that used up its steps.
    OutOfSteps,
}
