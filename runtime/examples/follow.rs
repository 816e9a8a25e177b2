//! Moves from posture to posture within limits, under inverse-dynamics control, and prints how far the arm was off.
//!
//! Replace `Scara` by your robot: `robot::Nominal` of a module from `armgen generate`.

use std::error::Error;
use std::time::Duration;

use armgen_runtime::control::{ControlError, InverseDynamics, TorqueLimits};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::State;
use armgen_runtime::simulation::{run, RunOptions};
use armgen_runtime::trajectory::{JointSegment, JointTrajectory};

#[allow(dead_code, unreachable_pub)]
#[path = "../tests/common/scara.rs"]
mod scara;
use scara::Scara;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let (model, plant) = (Scara::<f64>::nominal(), Scara::<f64>::loaded());
    let period = Duration::from_millis(1);

    // Two moves, as fast as 2 rad/s (0.5 m/s for the slide) and 4 rad/s² (1 m/s²) allow.
    let start = [0.0, 1.0, 0.1, 0.0];
    let to = |q| JointSegment::within_limits(q, [2.0, 2.0, 0.5, 2.0], [4.0, 4.0, 1.0, 4.0]);
    let trajectory = JointTrajectory::plan(start, [to([1.0, 1.8, 0.3, 0.5]), to(start)])?;

    // Errors die away as exp(-10 t) without overshoot: K_P = w², K_D = 2 w with w = 10 1/s.
    let limits = TorqueLimits::new([400.0, 200.0, 600.0, 50.0])?;
    let controller = InverseDynamics::new([100.0; 4], [20.0; 4])?.with_torque_limits(limits);

    let (mut sample, mut worst) = (0, SVector::<f64, 4>::zeros());
    let torque = |_, measured: &State<f64, 4>| -> Result<_, ControlError> {
        let reference = trajectory.sample(period * sample);
        sample += 1;
        worst = worst.sup(&(reference.q - measured.q).abs());
        controller.torque(&model, &reference, measured).map(|torque| torque.tau)
    };
    let options = RunOptions::new(period, trajectory.duration() + Duration::from_secs(1));
    run(&plant, State::at_rest(start.into()), options, torque, |_| {})?;

    println!("{:.2} s of motion; off by at most", trajectory.duration().as_secs_f64());
    println!("  {:.1e} rad, {:.1e} rad, {:.1e} m, {:.1e} rad", worst[0], worst[1], worst[2], worst[3]);
    assert!(worst.max() < 0.03, "what the model does not know of the load");
    Ok(())
}
