//! Runs the controlled SCARA on a Cortex-M4F. In addition to the lines of the library, prints the torques of each step and their cost:
//!
//! | line | fields |
//! |---|---|
//! | `torque` | step, torques and estimated mass as the bits of f32 |
//! | `ticks` | step, ticks of trajectory, inverse kinematics, controller, arm |
//! | `error` | largest difference of desired and actual joint variables, units of 1e-9 rad or m |
#![no_std]
#![no_main]

use armgen_bare_control::{Cell, Line, PERIOD, STEPS};
use armgen_bare_firmware::{timed, Costs, Output, Stopped};
use core::fmt::Write;
use core::hint::black_box;
use panic_halt as _;

/// Number of steps between two measurements of the stack of a control step at the state of the arm.
const BETWEEN_MEASUREMENTS: u32 = 100;

#[cortex_m_rt::entry]
fn main() -> ! {
    armgen_bare_firmware::run(motion)
}

fn motion(out: &mut Output) -> Result<(), Stopped> {
    let mut cell = Cell::new().map_err(|_| Stopped)?;
    let mut costs = Costs::new();
    let mut error: f32 = 0.0;
    for step in 0..=STEPS {
        let (sample, trajectory) = timed(|| cell.sample(PERIOD * step));
        let (reference, clik) = timed(|| cell.reference(&sample));
        let reference = reference.map_err(|_| Stopped)?;
        let (tau, controller) = timed(|| cell.torque(&reference));
        let tau = tau.map_err(|_| Stopped)?;
        writeln!(out, "{}", Line { step, tau: &tau, mass: cell.estimated_mass() })?;
        error = error.max((reference.q - cell.actual().q).amax());
        if step % BETWEEN_MEASUREMENTS == 0 {
            let mut copy = cell;
            let fits = costs.call("control_step", &mut || {
                let _ = black_box(copy.control(black_box(PERIOD * step)));
            });
            if !fits {
                return Err(Stopped);
            }
        }
        let ((), arm) = timed(|| cell.advance(&tau));
        writeln!(out, "ticks {step} {trajectory} {clik} {controller} {arm}")?;
    }
    writeln!(out, "error {}", (error * 1e9) as u32)?;
    costs.print("control", out)
}
