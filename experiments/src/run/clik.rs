//! Closed-loop inverse kinematics along a path.

use std::time::Duration;

use armgen_runtime::clik::{
    Algorithm as ClikAlgorithm, Clik, ClikError, DampedLeastSquares, Integration, JacobianInverse, JacobianTranspose,
    JointLimits, Objective, Outcome, PseudoInverse, SecondOrder,
};
use armgen_runtime::linalg::Damping;
use armgen_runtime::manipulability::{manipulability, manipulability_gradient};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::State;
use armgen_runtime::robot::Kinematics;
use armgen_runtime::settings::SettingError;
use armgen_runtime::task::Row;

use super::instance::{sized, task_of, Functions};
use super::Instance;
use crate::model::{Algorithm, Body, ClikRun, Ended, Joint, JointQuantity, Quantity, Record};

/// Rate limit, rad/s or m/s, if the description has none or a higher one.
const FASTEST: f64 = 100.0;

/// Errors of rows below this, m or rad, count as converged.
const TOLERANCE: f64 = 1e-3;

/// Calls `$self.$f::<K>` with K the number of rows.
macro_rules! with_rows {
    ($len:expr, $($f:ident).+ ($($argument:expr),*), $none:expr) => {
        match $len {
            1 => $($f).+::<1>($($argument),*),
            2 => $($f).+::<2>($($argument),*),
            3 => $($f).+::<3>($($argument),*),
            4 => $($f).+::<4>($($argument),*),
            5 => $($f).+::<5>($($argument),*),
            6 => $($f).+::<6>($($argument),*),
            _ => $none,
        }
    };
}

/// Maximises the manipulability of rows chosen in the file; `None` maximises nothing.
struct Climb<'r>(Option<&'r [Row]>);

impl<R: Kinematics<N, Real = f64>, const N: usize> Objective<R, N> for Climb<'_> {
    fn gradient(&self, robot: &R, q: &SVector<f64, N>) -> Option<SVector<f64, N>> {
        let rows = self.0?;
        match rows.len() {
            1 => manipulability_gradient(robot, &task_of::<1>(rows)?, q),
            2 => manipulability_gradient(robot, &task_of::<2>(rows)?, q),
            3 => manipulability_gradient(robot, &task_of::<3>(rows)?, q),
            4 => manipulability_gradient(robot, &task_of::<4>(rows)?, q),
            5 => manipulability_gradient(robot, &task_of::<5>(rows)?, q),
            6 => manipulability_gradient(robot, &task_of::<6>(rows)?, q),
            _ => None,
        }
    }
}

/// The limits of the description: without a limit, positions are unbounded and rates limited to [`FASTEST`].
pub(super) fn limits<const N: usize>(joints: &[Joint]) -> Result<JointLimits<f64, N>, SettingError> {
    let position = |side: usize| std::array::from_fn(|i| joints[i].position[side]);
    JointLimits::rates(std::array::from_fn(|i| joints[i].velocity.min(FASTEST)))?.with_range(position(0), position(1))
}

fn refused(error: SettingError) -> String {
    format!("the gains are refused: {error}")
}

fn stopped(t: f64, error: ClikError) -> String {
    format!("ended at {t} s: {error}")
}

/// A sample of inverse kinematics.
struct Sample<'s, const N: usize> {
    t: Duration,
    q: &'s SVector<f64, N>,
    rows: &'s [Row],
    error: &'s [f64],
    manipulability: f64,
    followed: f64,
    loop_gain: f64,
}

impl<const N: usize> Sample<'_, N> {
    fn write(&self, record: &mut Record) {
        record.sample(|quantity| match quantity {
            Quantity::Time => self.t.as_secs_f64(),
            Quantity::Joint(JointQuantity::Position, i) => self.q[i],
            Quantity::TaskError(row) => self.rows.iter().position(|r| *r == row).map_or(f64::NAN, |i| self.error[i]),
            Quantity::Manipulability => self.manipulability,
            Quantity::FollowedManipulability => self.followed,
            Quantity::LoopGain => self.loop_gain,
            _ => f64::NAN,
        });
    }
}

impl<R: Functions<N, P>, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P> {
    /// Second-order inverse kinematics for the robot's task, which also computes joint references.
    pub(super) fn second_order(
        &self,
        (k_p, k_d): (&[f64], &[f64]),
        period: f64,
        integration: Integration,
    ) -> Result<SecondOrder<f64, N, M>, SettingError> {
        SecondOrder::new(self.task, sized(k_p), sized(k_d), period, integration, limits(&self.robot.joints)?, [TOLERANCE; M])
    }

    /// Follows the path.
    pub(super) fn follow(&self, run: &ClikRun, body: &Body) -> Record {
        let mut record = Record::new(body.channels(&self.robot));
        let mut rate_limited_at = f64::INFINITY;
        let outcome = match &run.algorithm {
            Algorithm::SecondOrder { k_d, integration } => self.follow_second_order(run, k_d, *integration, &mut record),
            _ => {
                let followed = with_rows!(
                    run.rows.len(),
                    self.follow_first_order(run, &mut record),
                    Err("the task has too many rows".to_owned())
                );
                followed.map(|limited| rate_limited_at = limited)
            }
        };
        record.ended = outcome.err().map(Ended::untold);
        if record.ended.is_none() {
            record.numbers = body.numbers(&self.robot).into_iter().map(|channel| (channel, rate_limited_at)).collect();
        }
        record
    }

    /// Returns the time of the first limited rate, s; infinite if there is no such time.
    fn follow_first_order<const K: usize>(&self, run: &ClikRun, record: &mut Record) -> Result<f64, String> {
        let period = run.sampling.period;
        let task = task_of::<K>(&run.rows).ok_or("no task")?;
        let gains: [f64; K] = sized(&run.gains);
        let transpose = JacobianTranspose::new(gains).map_err(refused)?;
        let is_transpose = run.algorithm == Algorithm::Transpose;
        // A trait object: the loop below is compiled only once per number of rows.
        let algorithm: Box<dyn ClikAlgorithm<R, N, K> + '_> = match &run.algorithm {
            Algorithm::Inverse | Algorithm::SecondOrder { .. } => Box::new(JacobianInverse::new(gains).map_err(refused)?),
            Algorithm::Transpose => Box::new(transpose),
            Algorithm::PseudoInverse { k_0, objective } => {
                Box::new(PseudoInverse::new(gains, *k_0, Climb(objective.as_deref())).map_err(refused)?)
            }
            Algorithm::DampedLeastSquares { damping, threshold } => {
                let damping = Damping::below(*threshold).at_most(*damping).map_err(|error| error.to_string())?;
                Box::new(DampedLeastSquares::new(gains, damping).map_err(refused)?)
            }
        };
        let limits = limits(&self.robot.joints).map_err(refused)?;
        let clik = Clik::new(task, algorithm.as_ref(), period.as_secs_f64(), limits, [TOLERANCE; K]).map_err(refused)?;
        let mut q = self.start(&run.start, &run.sampling)?;
        let mut t = Duration::ZERO;
        let mut rate_limited_at = f64::INFINITY;
        while t <= run.sampling.duration {
            let seconds = t.as_secs_f64();
            let step =
                clik.step(&self.nominal, &q, &run.sampling.motion.trajectory.sample(t)).map_err(|e| stopped(seconds, e))?;
            let j = task.jacobian(&self.nominal.geometric_jacobian(&q));
            let sample = Sample {
                t,
                q: &q,
                rows: &run.rows,
                error: step.error.as_slice(),
                manipulability: self.manipulability(&q),
                followed: manipulability(&j),
                loop_gain: if is_transpose { transpose.loop_gain(&j, period.as_secs_f64()) } else { f64::NAN },
            };
            sample.write(record);
            if step.outcome == Outcome::RateLimited {
                rate_limited_at = rate_limited_at.min(seconds);
            }
            q = step.q;
            t += period;
        }
        Ok(rate_limited_at)
    }

    fn follow_second_order(
        &self,
        run: &ClikRun,
        k_d: &[f64],
        integration: Integration,
        record: &mut Record,
    ) -> Result<(), String> {
        let period = run.sampling.period;
        let clik = self.second_order((&run.gains, k_d), period.as_secs_f64(), integration).map_err(refused)?;
        let mut state = State::at_rest(self.start(&run.start, &run.sampling)?);
        let mut t = Duration::ZERO;
        while t <= run.sampling.duration {
            let reference = run.sampling.motion.trajectory.sample(t);
            let step = clik.step(&self.nominal, &state, &reference).map_err(|e| stopped(t.as_secs_f64(), e))?;
            let w = self.manipulability(&state.q);
            let (q, error) = (&state.q, step.error.as_slice());
            Sample { t, q, rows: &run.rows, error, manipulability: w, followed: w, loop_gain: f64::NAN }.write(record);
            state = step.next;
            t += period;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A continuous joint does not remove the limits of the others.
    #[test]
    fn a_joint_without_limits_takes_none_from_the_others() {
        let joint = |position| Joint { name: String::new(), revolute: true, position, velocity: 1.0, effort: f64::INFINITY };
        let joints = [joint([f64::NEG_INFINITY, f64::INFINITY]), joint([-1.0, 1.0]), joint([-1.0, f64::INFINITY])];
        let limits = limits::<3>(&joints).expect("limits");
        let (q, next) = (SVector::from([0.0; 3]), SVector::from([9.0, 1.5, 9.0]));
        assert_eq!(limits.stop(&q, &next).q, SVector::from([9.0, 1.0, 9.0]));
        assert_eq!(limits.stop(&q, &-next).q, SVector::from([-9.0, -1.0, -1.0]));
    }
}
