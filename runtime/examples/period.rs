//! Asks before anything moves whether gains and sampling period go together: the sampled loop at rest at postures of the path, and in
//! motion along it.
//!
//! Replace `Scara` by your robot. A module from `armgen generate` has `robot::Nominal` for the model and
//! `robot::WithParameters { parameters }` for the true arm.

use std::error::Error;
use std::time::Duration;

use armgen_runtime::control::InverseDynamics;
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::State;
use armgen_runtime::stability::{analyse, Delay, MotionAnalysis};
use armgen_runtime::trajectory::{JointSegment, JointTrajectory};

#[allow(dead_code, unreachable_pub)]
#[path = "../tests/common/scara.rs"]
mod scara;
use scara::Scara;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let (model, plant) = (Scara::<f64>::nominal(), Scara::<f64>::loaded());
    let start = [0.0, 1.0, 0.1, 0.0];
    let to = JointSegment::within_limits([1.0, 1.8, 0.3, 0.5], [2.0, 2.0, 0.5, 2.0], [4.0, 4.0, 1.0, 4.0]);
    let trajectory = JointTrajectory::plan(start, [to])?;

    // An arm that follows ddq = -K_D dq is sampled stably while K_D < 2 / T_s: at 1 ms K_D = 200 1/s is a tenth of that.
    let mut verdicts = Vec::new();
    for (k_d, period) in [(200.0, 1e-3), (200.0, 5e-3), (200.0, 20e-3)] {
        let controller = InverseDynamics::new([k_d * k_d / 4.0; 4], [k_d; 4])?;
        let samples = (trajectory.duration().as_secs_f64() / period) as u32;
        let joints: Vec<_> = (0..samples).map(|k| trajectory.sample(Duration::from_secs_f64(period * f64::from(k)))).collect();
        let postures: Vec<SVector<f64, 4>> =
            joints.iter().step_by(joints.len().div_ceil(8)).map(|reference| reference.q).collect();

        let mut report = analyse(&plant, &model, &controller, &postures, period, Delay::NONE)?;
        let analysis =
            MotionAnalysis { plant: &plant, joints: &joints, start: State::at_rest(start.into()), period, delay: Delay::NONE };
        report.motion = Some(analysis.of(&model, &controller, &joints)?);
        println!(
            "K_D = {k_d} 1/s at {period} s: radius {:.4} at rest, holds: {}; {:?}",
            report.spectral_radius,
            report.holds(),
            report.period
        );
        verdicts.push(report.holds());
    }
    assert_eq!(verdicts, [true, true, false]);
    Ok(())
}
