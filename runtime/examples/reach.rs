//! Finds joint variables for a pose of the end effector by closed-loop inverse kinematics, damped near singular postures.
//!
//! Replace `Scara` by your robot: `robot::Nominal` and `Task::from_indices(robot::TASK)` of a module from `armgen generate`. If
//! all solutions of the arm have a closed form, `armgen generate --ik` writes them.

use std::error::Error;

use armgen_runtime::clik::{Clik, DampedLeastSquares, JointLimits, Outcome};
use armgen_runtime::linalg::Damping;
use armgen_runtime::nalgebra::vector;
use armgen_runtime::reference::Pose;
use armgen_runtime::task::{Row, Task};

#[allow(dead_code, unreachable_pub)]
#[path = "../tests/common/scara.rs"]
mod scara;
use scara::Scara;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let robot = Scara::<f64>::nominal();
    let task = Task::new([Row::X, Row::Y, Row::Z, Row::Rz])?;

    // A sixth of the error is closed at every step; damping begins where the manipulability falls below 0.02.
    let period = 1e-3;
    let algorithm = DampedLeastSquares::new([0.15 / period; 4], Damping::below(0.02).at_most(0.05)?)?;
    let limits = JointLimits::rates([100.0; 4])?.with_range([-3.0, -2.5, 0.0, -3.0], [3.0, 2.5, 0.5, 3.0])?;
    let clik = Clik::new(task, algorithm, period, limits, [1e-5; 4])?;

    let goal = Pose::of(&robot, &vector![0.6, 1.1, 0.25, -0.4]);
    let reached = clik.approach(&robot, &vector![0.1, 0.6, 0.1, 0.0], &goal, 1000)?;
    println!("{:?} after {} steps: q = {:.4?}", reached.outcome, reached.steps, reached.q.as_slice());
    assert_eq!(reached.outcome, Outcome::Converged);

    // Two metres away there is no posture, and the outcome reports it.
    let far = Pose { position: vector![2.0, 0.0, 0.2], ..goal };
    let reached = clik.approach(&robot, &vector![0.1, 0.6, 0.1, 0.0], &far, 1000)?;
    println!("{:?}: {:.3} m are missing", reached.outcome, reached.error.fixed_rows::<3>(0).norm());
    assert_ne!(reached.outcome, Outcome::Converged);
    Ok(())
}
