//! A SCARA that cuts a ghost out of a sheet under adaptive control, in f32 and without an operating system.
//!
//! Each millisecond: where the end effector should be (trajectory), which joint motion that is (second-order inverse kinematics), which
//! torques follow it (adaptive control). The arm itself carries 5 kg that the controller does not know, and is integrated by one step of
//! Runge and Kutta's fourth-order method. Host and microcontroller compile this one source; the emitted module and the runtime compute
//! its sines in f32, libm its roots.
#![no_std]

mod ghost;
mod plant;

#[allow(clippy::excessive_precision)]
pub mod robot {
    //! The emitted module and the robots of the runtime over it.
    include!(concat!(env!("OUT_DIR"), "/scara.rs"));
    include!(concat!(env!("OUT_DIR"), "/scara_runtime.rs"));
}

pub use armgen_runtime::{
    nalgebra::SVector,
    reference::{JointReference, State},
};

use armgen_runtime::{
    clik::{ClikError, Integration, JointLimits, SecondOrder},
    control::{Adaptive, ControlError},
    reference::OperationalReference,
    settings::SettingError,
    task::{Row, Task, TaskError},
    trajectory::PlanError,
};
use core::{fmt, time::Duration};

/// Steps of the run: two seconds.
pub const STEPS: u32 = 2000;
/// Sampling period of the controller.
pub const PERIOD: Duration = Duration::from_millis(1);
const PERIOD_S: f32 = 1e-3;

/// Joint variables of the ghost's first point, elbow to the left.
const START: [f32; robot::DOF] = [-1.391_31, 2.065_078_7, 0.4, 0.673_768_66];

/// Why the run ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A gain or the period is out of range.
    Gain(SettingError),
    /// The task names a row twice.
    Task(TaskError),
    /// The path cannot be planned.
    Plan(PlanError),
    /// No joint motion follows the path here.
    Clik(ClikError),
    /// No torque follows the joint motion.
    Control(ControlError),
}

/// Trajectory, inverse kinematics, controller and arm.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    trajectory: ghost::Ghost,
    clik: SecondOrder<f32, 4, 4>,
    controller: Adaptive<f32, 4, 14>,
    desired: State<f32, 4>,
    actual: State<f32, 4>,
}

impl Cell {
    /// At rest at the first point of the path, with the estimate at the nominal parameters.
    ///
    /// # Errors
    /// Where a gain or the path is impossible.
    pub fn new() -> Result<Self, Fault> {
        let task = Task::new([Row::X, Row::Y, Row::Z, Row::Rz]).map_err(Fault::Task)?;
        let limits = JointLimits::rates([50.0; 4]).map_err(Fault::Gain)?;
        let (k_p, k_d) = ([1000.0, 1000.0, 2000.0, 1.0], [10.0, 10.0, 50.0, 1.0]);
        let clik = SecondOrder::new(task, k_p, k_d, PERIOD_S, Integration::HoldConsistent, limits, [1e-3; 4]);
        // K_pi = 10 diag(1, 1, .001, 1, 1, 1, 1, 1, 50^4, 20^4, 1, 1, 50^4, 20^4): a rotor's parameter weighs as it does at its joint.
        let (third, fourth) = (6.25e7, 1.6e6);
        let k_pi = [10.0, 10.0, 0.01, 10.0, 10.0, 10.0, 10.0, 10.0, third, fourth, 10.0, 10.0, third, fourth];
        let controller = Adaptive::new([500.0; 4], [10.0, 10.0, 50.0, 1.0], k_pi, robot::NOMINAL_PARAMETERS, PERIOD_S);
        let start = State::at_rest(SVector::from(START));
        Ok(Self {
            trajectory: ghost::ghost().map_err(Fault::Plan)?,
            clik: clik.map_err(Fault::Gain)?,
            controller: controller.map_err(Fault::Gain)?,
            desired: start,
            actual: start,
        })
    }

    /// Where the end effector should be at time `t`.
    pub fn sample(&self, t: Duration) -> OperationalReference<f32> {
        self.trajectory.sample(t)
    }

    /// The joint motion that leads there.
    ///
    /// # Errors
    /// Those of the inverse kinematics.
    pub fn reference(&mut self, sample: &OperationalReference<f32>) -> Result<JointReference<f32, 4>, Fault> {
        let step = self.clik.step(&robot::Nominal, &self.desired, sample).map_err(Fault::Clik)?;
        self.desired = step.next;
        Ok(step.reference)
    }

    /// The torques that follow it, from the measured state of the arm; the estimate advances.
    ///
    /// # Errors
    /// Those of the controller.
    pub fn torque(&mut self, reference: &JointReference<f32, 4>) -> Result<SVector<f32, 4>, Fault> {
        self.controller.torque(&robot::Nominal, reference, &self.actual).map(|torque| torque.tau).map_err(Fault::Control)
    }

    /// One control step, at time `t`: the three above.
    ///
    /// # Errors
    /// Those of its parts.
    pub fn control(&mut self, t: Duration) -> Result<(JointReference<f32, 4>, SVector<f32, 4>), Fault> {
        let sample = self.sample(t);
        let reference = self.reference(&sample)?;
        Ok((reference, self.torque(&reference)?))
    }

    /// The arm moves for one period under held torques.
    pub fn advance(&mut self, tau: &SVector<f32, 4>) {
        self.actual = plant::advance(&self.actual, tau, PERIOD_S);
    }

    /// The arm is where it was measured to be.
    pub fn measured(&mut self, actual: State<f32, 4>) {
        self.actual = actual;
    }

    /// The state of the arm.
    pub fn actual(&self) -> &State<f32, 4> {
        &self.actual
    }

    /// The estimate of the third link's mass, kg; the arm carries 15.
    pub fn estimated_mass(&self) -> f32 {
        self.controller.estimate()[2]
    }
}

/// The torques of a step as they are printed on both machines: the bits.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// Number of the step.
    pub step: u32,
    /// Joint torques.
    pub tau: &'a SVector<f32, 4>,
    /// Estimated mass of the third link.
    pub mass: f32,
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "torque {}", self.step)?;
        for tau in self.tau.iter() {
            write!(f, " {:08x}", tau.to_bits())?;
        }
        write!(f, " {:08x}", self.mass.to_bits())
    }
}
