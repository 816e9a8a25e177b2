//! Running a first-order algorithm: bounded, within joint limits, with a name for what happened.

use super::{Algorithm, ClikError, JointLimits, Outcome, WithinRange};
use crate::{
    linalg::{is_finite, lit, saturate, Limited},
    reference::{OperationalReference, Pose},
    robot::Kinematics,
    settings::{self, Setting, SettingError},
    task::Task,
};
use nalgebra::{RealField, SMatrix, SVector};

/// A first-order algorithm at a sampling period, with limits: q += T_s dq.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clik<A, T, const N: usize, const M: usize> {
    task: Task<M>,
    algorithm: A,
    period: T,
    limits: JointLimits<T, N>,
    tolerance: SVector<T, M>,
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<T, const N: usize, const M: usize> {
    /// Joint variables after the step, rad or m.
    pub q: SVector<T, N>,
    /// The rates that led there, rad/s or m/s, bounded.
    pub dq: SVector<T, N>,
    /// Error of the task rows before the step, desired minus actual; m or rad.
    pub error: SVector<T, M>,
    /// What happened.
    pub outcome: Outcome,
}

/// Where an approach ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached<T, const N: usize, const M: usize> {
    /// Joint variables, rad or m.
    pub q: SVector<T, N>,
    /// Error of the task rows there; m or rad.
    pub error: SVector<T, M>,
    /// Steps taken.
    pub steps: u32,
    /// [`Outcome::Converged`], or why not.
    pub outcome: Outcome,
}

impl<A, T: RealField + Copy, const N: usize, const M: usize> Clik<A, T, N, M> {
    /// `algorithm` for these task rows at the sampling period `period`, s, within `limits`; errors within `tolerance`, m or rad row by
    /// row, count as converged.
    ///
    /// # Errors
    /// Where the period or a tolerance is not positive and finite.
    pub fn new(
        task: Task<M>,
        algorithm: A,
        period: T,
        limits: JointLimits<T, N>,
        tolerance: [T; M],
    ) -> Result<Self, SettingError> {
        let tolerance = tolerance.into();
        settings::positive_scalar(Setting::Period, period)?;
        settings::positive(Setting::Tolerance, &tolerance)?;
        Ok(Self { task, algorithm, period, limits, tolerance })
    }

    /// The task.
    pub fn task(&self) -> &Task<M> {
        &self.task
    }

    fn converged(&self, error: &SVector<T, M>) -> bool {
        error.iter().zip(self.tolerance.iter()).all(|(e, tolerance)| e.abs() <= *tolerance)
    }

    /// One step from `q`, rad or m, after the reference of this sample.
    ///
    /// # Errors
    /// Where `q` or the reference is not finite, or the algorithm meets a singular posture that it cannot handle.
    pub fn step<R>(&self, robot: &R, q: &SVector<T, N>, reference: &OperationalReference<T>) -> Result<Step<T, N, M>, ClikError>
    where
        R: Kinematics<N, Real = T>,
        A: Algorithm<R, N, M>,
    {
        self.advance(robot, q, reference).map(|(step, _)| step)
    }

    /// One step, and whether a rate limit slowed it down.
    fn advance<R>(
        &self,
        robot: &R,
        q: &SVector<T, N>,
        reference: &OperationalReference<T>,
    ) -> Result<(Step<T, N, M>, bool), ClikError>
    where
        R: Kinematics<N, Real = T>,
        A: Algorithm<R, N, M>,
    {
        if !is_finite(q) {
            return Err(ClikError::StateNotFinite);
        }
        if !reference.is_finite() {
            return Err(ClikError::ReferenceNotFinite);
        }
        let error = self.task.error(&reference.pose, &Pose::of(robot, q));
        let j = self.task.jacobian(&robot.geometric_jacobian(q));
        let rates = self.algorithm.rates(robot, q, &error, &self.task.select(&reference.velocity), &j)?;
        if !is_finite(&rates.dq) {
            return Err(ClikError::RatesNotFinite);
        }
        let Limited { value: dq, is_limited: slowed } = self.limits.slow_down(&rates.dq);
        let asked = q + dq * self.period;
        let WithinRange { q: next, stopped } = self.limits.stop(q, &asked);
        // The rate of a stopped joint is its actual rate; the other rates keep every bit.
        let dq = if stopped.is_some() {
            let done = SVector::from_fn(|i, _| if next[i] == asked[i] { dq[i] } else { (next[i] - q[i]) / self.period });
            saturate(&done, self.limits.rate()).value
        } else {
            dq
        };
        let outcome = if self.converged(&error) {
            Outcome::Converged
        } else if let Some(joint) = stopped {
            Outcome::JointLimit { joint }
        } else if rates.damped && points_out(&j, &self.algorithm.gain().component_mul(&error)) {
            Outcome::OutOfReach
        } else if rates.damped {
            Outcome::Damped
        } else if slowed {
            Outcome::RateLimited
        } else {
            Outcome::Tracking
        };
        Ok((Step { q: next, dq, error, outcome }, slowed))
    }

    /// Steps from `start`, rad or m, towards a resting goal. It ends when the goal is reached, the arm rests, or `most_steps` are used up.
    ///
    /// The arm rests where two conditions meet. First, a step without an active rate limit changed the error by at most a
    /// millionth of it, or by no more than rounding. Second, a joint limit is in its way, or J' K e = 0: the weighted error
    /// points in a direction in which the arm cannot move.
    ///
    /// A reachable goal in line with the arm can leave it at rest in a singular posture. So an arm that rests without a joint
    /// limit in its way is moved aside: by 0.01 rad or m in each joint the first time, by 0.1 afterwards. If it comes to rest no
    /// nearer after a move by 0.1, the goal is out of reach. A tolerance below the rounding of q += T_s dq under a small gain
    /// uses up the steps, above all in single precision.
    ///
    /// # Errors
    /// Those of [`Clik::step`].
    pub fn approach<R>(
        &self,
        robot: &R,
        start: &SVector<T, N>,
        goal: &Pose<T>,
        most_steps: u32,
    ) -> Result<Reached<T, N, M>, ClikError>
    where
        R: Kinematics<N, Real = T>,
        A: Algorithm<R, N, M>,
    {
        let reference = OperationalReference::at_rest(*goal);
        // How far rounding may move the error of a pose.
        let rounding = T::default_epsilon() * (T::one() + goal.position.norm());
        let mut q = *start;
        // The step that led to `q`, unless a rate limit slowed it down without stopping it; and the distance from the goal at the
        // previous rest.
        let (mut last, mut rested_at): (Option<Step<T, N, M>>, Option<T>) = (None, None);
        let [first_aside, next_aside] = [0.01, 0.1].map(lit::<T>);
        let mut aside = first_aside;
        for steps in 0..most_steps {
            let (step, slowed) = self.advance(robot, &q, &reference)?;
            let reached = |outcome| Ok(Reached { q, error: step.error, steps, outcome });
            if step.outcome == Outcome::Converged {
                return reached(Outcome::Converged);
            }
            let distance = step.error.norm();
            let rests = |last: &Step<T, N, M>| {
                let changes = (step.error - last.error).norm() > rounding.max(last.error.norm() * lit(1e-6));
                let weighted = self.algorithm.gain().component_mul(&step.error);
                !changes
                    && (matches!(last.outcome, Outcome::JointLimit { .. })
                        || points_out(&self.task.jacobian(&robot.geometric_jacobian(&q)), &weighted))
            };
            let Some(rested) = last.filter(rests) else {
                q = step.q;
                let stands = step.dq.iter().zip(self.limits.rate().iter()).all(|(dq, rate)| dq.abs() <= *rate * lit(1e-6));
                last = (!slowed || stands).then_some(step);
                continue;
            };
            if let Outcome::JointLimit { .. } = rested.outcome {
                return reached(rested.outcome);
            }
            if rested_at.is_some_and(|before| distance > before * lit(0.999)) {
                return reached(Outcome::OutOfReach);
            }
            // Near a singular posture strong damping makes the arm so slow that it seems to rest; this move is not judged.
            rested_at = (aside == next_aside).then_some(distance);
            last = None;
            let by = SVector::from_fn(|i, _| if i % 2 == 0 { aside } else { -aside });
            aside = next_aside;
            q = self.limits.stop(&q, &(q + by)).q;
        }
        let error = self.task.error(goal, &Pose::of(robot, &q));
        let outcome = if self.converged(&error) { Outcome::Converged } else { Outcome::OutOfSteps };
        Ok(Reached { q, error, steps: most_steps, outcome })
    }
}

/// Whether the law moves no joint for the weighted error e = K (x_d - x): J' e is below a hundredth of |J| |e|, the scale of a
/// direction that the arm can follow.
fn points_out<T: RealField + Copy, const M: usize, const N: usize>(j: &SMatrix<T, M, N>, e: &SVector<T, M>) -> bool {
    j.tr_mul(e).norm() <= lit::<T>(0.01) * j.norm() * e.norm()
}
