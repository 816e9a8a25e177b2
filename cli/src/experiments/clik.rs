//! Closed-loop inverse kinematics along a path, through the emitted kinematics.

use armgen_generated::{Nominal, DOF, JOINT_NAMES, POSITION_LIMITS, TASK_ROWS, VELOCITY_LIMITS};
use armgen_runtime::clik::{
    Algorithm as Law, Clik, ClikError, DampedLeastSquares, Integration, JacobianInverse, JacobianTranspose, JointLimits,
    Objective, Outcome, PseudoInverse, SecondOrder,
};
use armgen_runtime::linalg::Damping;
use armgen_runtime::manipulability::{manipulability, manipulability_gradient};
use armgen_runtime::parameters::ParameterError;
use armgen_runtime::reference::State;
use armgen_runtime::robot::Kinematics;
use armgen_runtime::simulation::Log;
use armgen_runtime::task::{Row, Task};

use super::file::{task, Algorithm, ClikRun, Joints};
use super::manipulability::w;
use super::reader::row_name;
use super::record::Record;

/// Columns of the log: joint variables, errors of the followed rows, w of the task and of the followed rows.
pub(crate) fn columns(run: &ClikRun) -> Vec<String> {
    let mut names = vec!["t".to_owned()];
    names.extend(JOINT_NAMES.iter().map(|name| format!("q_{name}")));
    names.extend(run.rows.iter().map(|row| format!("e_{}", row_name(*row))));
    names.extend(["w".to_owned(), "w_followed".to_owned()]);
    if run.algorithm == Algorithm::Transpose {
        names.push("loop_gain".to_owned());
    }
    names
}

/// The numbers of the whole run.
pub(crate) fn singles(run: &ClikRun) -> Vec<String> {
    if matches!(run.algorithm, Algorithm::SecondOrder(..)) {
        Vec::new()
    } else {
        vec!["rate_limited_at".to_owned()]
    }
}

/// Rate, rad/s or m/s, at which a motion is cut where the description gives no limit, or a higher one.
const FASTEST: f64 = 100.0;

/// The limits of the description; rates of [`FASTEST`] where it gives none.
pub(crate) fn limits() -> Result<JointLimits<f64, DOF>, ParameterError> {
    let limits = JointLimits::rates(VELOCITY_LIMITS.map(|rate| rate.min(FASTEST)))?;
    let finite = POSITION_LIMITS.iter().flatten().all(|limit| limit.is_finite());
    if finite {
        limits.with_range(POSITION_LIMITS.map(|[low, _]| low), POSITION_LIMITS.map(|[_, high]| high))
    } else {
        Ok(limits)
    }
}

/// Calls `$f::<M>` with M the number of rows.
macro_rules! with_rows {
    ($len:expr, $f:ident ($($argument:expr),*), $none:expr) => {
        match $len {
            1 => $f::<1>($($argument),*),
            2 => $f::<2>($($argument),*),
            3 => $f::<3>($($argument),*),
            4 => $f::<4>($($argument),*),
            5 => $f::<5>($($argument),*),
            6 => $f::<6>($($argument),*),
            _ => $none,
        }
    };
}

fn task_of<const M: usize>(rows: &[Row]) -> Option<Task<M>> {
    Task::new(<[Row; M]>::try_from(rows).ok()?).ok()
}

/// The manipulability of rows chosen in the file, or nothing to be climbed.
struct Climb(Option<Vec<Row>>);

impl Objective<Nominal, DOF> for Climb {
    fn gradient(&self, robot: &Nominal, q: &Joints) -> Option<Joints> {
        fn gradient<const K: usize>(robot: &Nominal, rows: &[Row], q: &Joints) -> Option<Joints> {
            manipulability_gradient(robot, &task_of::<K>(rows)?, q)
        }
        let rows = self.0.as_deref()?;
        with_rows!(rows.len(), gradient(robot, rows, q), None)
    }
}

/// Follows the path.
pub(crate) fn run(run: &ClikRun) -> Record {
    let mut record = Record { log: Log::new(columns(run)), ..Record::default() };
    let outcome = match &run.algorithm {
        Algorithm::SecondOrder(k_d, integration) => second_order(run, k_d, *integration, &mut record.log),
        _ => with_rows!(run.rows.len(), first_order(run, &mut record), Err("the task has too many rows".to_owned())),
    };
    record.ended = outcome.err();
    record
}

fn refused(error: ParameterError) -> String {
    format!("the gains are refused: {error:?}")
}

fn stopped(t: f64, error: ClikError) -> String {
    format!("ended at {t} s: {error:?}")
}

fn first_order<const M: usize>(run: &ClikRun, record: &mut Record) -> Result<(), String> {
    let gains = <[f64; M]>::try_from(run.gains.as_slice()).map_err(|_| "one gain per row".to_owned())?;
    match &run.algorithm {
        Algorithm::Inverse => follow(run, JacobianInverse::new(gains).map_err(refused)?, |_| None, record),
        Algorithm::Transpose => {
            let transpose = JacobianTranspose::new(gains).map_err(refused)?;
            let task = task_of::<M>(&run.rows).ok_or("no task")?;
            let period = run.sampling.period.as_secs_f64();
            let gain = |q: &Joints| Some(transpose.loop_gain(&task.jacobian(&Nominal.geometric_jacobian(q)), period));
            follow(run, transpose, gain, record)
        }
        Algorithm::PseudoInverse(k_0, rows) => {
            follow(run, PseudoInverse::new(gains, *k_0, Climb(rows.clone())).map_err(refused)?, |_| None, record)
        }
        Algorithm::Damped(damping, threshold) => {
            let damping = Damping::new(*threshold, *damping).map_err(|error| format!("{error:?}"))?;
            follow(run, DampedLeastSquares::new(gains, damping).map_err(refused)?, |_| None, record)
        }
        Algorithm::SecondOrder(..) => Ok(()),
    }
}

fn follow<A: Law<Nominal, DOF, M>, const M: usize>(
    run: &ClikRun,
    algorithm: A,
    gain: impl Fn(&Joints) -> Option<f64>,
    record: &mut Record,
) -> Result<(), String> {
    let task = task_of::<M>(&run.rows).ok_or("no task")?;
    let period = run.sampling.period;
    let clik = Clik::new(task, algorithm, period.as_secs_f64(), limits().map_err(refused)?, [1e-3; M]).map_err(refused)?;
    let mut q = run.start;
    let mut t = std::time::Duration::ZERO;
    let mut rate_limited_at = f64::INFINITY;
    while t <= run.sampling.duration {
        let seconds = t.as_secs_f64();
        let step = clik.step(&Nominal, &q, &run.sampling.motion.trajectory.sample(t)).map_err(|e| stopped(seconds, e))?;
        let followed = manipulability(&task.jacobian(&Nominal.geometric_jacobian(&q)));
        record.log.push(row(seconds, &q, step.error.as_slice(), followed).chain(gain(&q)));
        if step.outcome == Outcome::RateLimited {
            rate_limited_at = rate_limited_at.min(seconds);
        }
        q = step.q;
        t += period;
    }
    record.singles = singles(run).into_iter().zip([rate_limited_at]).collect();
    Ok(())
}

fn row<'a>(t: f64, q: &'a Joints, error: &'a [f64], followed: f64) -> impl Iterator<Item = f64> + 'a {
    [t].into_iter().chain(q.iter().copied()).chain(error.iter().copied()).chain([w(q), followed])
}

/// Second-order inverse kinematics of the task of the robot, as it makes joint references, too.
pub(crate) fn second_order_of(
    k_p: [f64; TASK_ROWS],
    k_d: [f64; TASK_ROWS],
    period: f64,
    integration: Integration,
) -> Result<SecondOrder<f64, DOF, TASK_ROWS>, ParameterError> {
    SecondOrder::new(task(), k_p, k_d, period, integration, limits()?, [1e-3; TASK_ROWS])
}

fn second_order(run: &ClikRun, k_d: &[f64], integration: Integration, log: &mut Log) -> Result<(), String> {
    let rows = |gains: &[f64]| <[f64; TASK_ROWS]>::try_from(gains).map_err(|_| "one gain per row".to_owned());
    let period = run.sampling.period;
    let clik = second_order_of(rows(&run.gains)?, rows(k_d)?, period.as_secs_f64(), integration).map_err(refused)?;
    let mut state = State::at_rest(run.start);
    let mut t = std::time::Duration::ZERO;
    while t <= run.sampling.duration {
        let seconds = t.as_secs_f64();
        let step = clik.step(&Nominal, &state, &run.sampling.motion.trajectory.sample(t)).map_err(|e| stopped(seconds, e))?;
        log.push(row(seconds, &state.q, step.error.as_slice(), w(&state.q)));
        state = step.next;
        t += period;
    }
    Ok(())
}
