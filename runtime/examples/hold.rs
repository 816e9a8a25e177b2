//! Holds a posture: PD with gravity compensation, on an arm that carries a load which its model does not know.
//!
//! Replace `Scara` by your robot. A module from `armgen generate` has `robot::Nominal` for the model and
//! `robot::WithParameters { parameters }` for the true arm.

use std::error::Error;
use std::time::Duration;

use armgen_runtime::control::PdGravity;
use armgen_runtime::nalgebra::vector;
use armgen_runtime::reference::{JointReference, State};
use armgen_runtime::simulation::{run, RunOptions};

#[allow(dead_code, unreachable_pub)]
#[path = "../tests/common/scara.rs"]
mod scara;
use scara::Scara;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let (model, plant) = (Scara::<f64>::nominal(), Scara::<f64>::loaded());
    let posture = vector![-1.4, 2.1, 0.4, 0.7];
    let reference = JointReference::at_rest(posture);

    // K_P from the error that a load may leave: 5 kg on the third joint, and 10 mm of it, ask for 5 * 9.81 / 0.01 N/m.
    let controller = PdGravity::new([2000.0, 2000.0, 4905.0, 100.0], [200.0, 200.0, 300.0, 10.0])?;

    let options = RunOptions::new(Duration::from_millis(1), Duration::from_secs(3));
    let torque = |_, measured: &State<f64, 4>| controller.torque(&model, &reference, measured).map(|torque| torque.tau);
    let end = run(&plant, State::at_rest(posture), options, torque, |_| {})?;

    let error = posture - end.q;
    println!("after 3 s the joints are off by {:.2e} {:.2e} {:.2e} {:.2e}", error[0], error[1], error[2], error[3]);
    assert!((error[2] + 0.01).abs() < 1e-6, "the load hangs in the spring that K_P is");
    Ok(())
}
