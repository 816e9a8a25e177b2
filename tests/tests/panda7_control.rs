//! The controllers of the runtime on a second robot, seven joints and all six rows, through emitted functions, without a change to them.

use std::time::Duration;

use armgen_runtime::clik::{Clik, Integration, JointLimits, Manipulability, PseudoInverse, SecondOrder};
use armgen_runtime::control::{InverseDynamics, NullSpace, OperationalSpace};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::{Pose, State};
use armgen_runtime::robot::Kinematics;
use armgen_runtime::simulation::{run, RunOptions};
use armgen_runtime::stability::{analyse, Delay};
use armgen_runtime::task::Task;
use armgen_runtime::trajectory::{OperationalTrajectory, OrientationProfile, Path, Segment, TimeLaw, Turn};
use armgen_tests::emitted::panda7;

const PERIOD: Duration = Duration::from_millis(1);
const END: Duration = Duration::from_secs(6);
const ROBOT: panda7::Nominal = panda7::Nominal;
const POSTURE: [f64; 7] = [0.0, -0.4, 0.1, -2.0, 0.1, 1.7, 0.7];

type Trajectory = OperationalTrajectory<f64, [Segment<f64>; 2], [Turn<f64>; 2]>;

/// A line of 2 s, then half a circle of 3 s in a tilted plane, turning about two axes meanwhile; 1 s of rest.
fn trajectory() -> Trajectory {
    let seconds = Duration::from_secs;
    let trapezoid =
        |duration| TimeLaw::Trapezoidal { duration: seconds(duration), acceleration_time: Duration::from_millis(400) };
    let start = Pose::of(&ROBOT, &POSTURE.into());
    let [x, y, z] = start.position.into();
    let path = Path::plan(
        [x, y, z],
        [
            Segment::line([x + 0.05, y + 0.25, z - 0.1], trapezoid(2)),
            Segment::arc([x + 0.05, y + 0.15, z - 0.1], [0.3, 0.0, 1.0], std::f64::consts::PI, trapezoid(3)),
        ],
    );
    let turns = [Turn::about([1.0, 1.0, 0.0], 0.5, trapezoid(2)), Turn::about([0.0, 0.3, 1.0], -0.8, trapezoid(3))];
    OperationalTrajectory { path: path.unwrap(), orientation: OrientationProfile::plan(start.rotation, turns).unwrap() }
}

/// Largest errors of position, m, and orientation, rad.
#[derive(Default)]
struct Errors {
    position: f64,
    orientation: f64,
}

impl Errors {
    fn add(&mut self, e: &SVector<f64, 6>) {
        self.position = self.position.max(e.fixed_rows::<3>(0).norm());
        self.orientation = self.orientation.max(e.fixed_rows::<3>(3).norm());
    }

    #[track_caller]
    fn check(&self, bound: f64) {
        println!("largest errors: {:e} m, {:e} rad", self.position, self.orientation);
        assert!(self.position <= bound && self.orientation <= bound, "{:e} m, {:e} rad", self.position, self.orientation);
    }
}

fn control(k_i: f64) -> Errors {
    let trajectory = trajectory();
    // The rest of the posture follows a spring, so that no joint drifts in the null space.
    let null_space = NullSpace::new([25.0; 7], [10.0; 7], POSTURE).unwrap();
    let mut controller =
        OperationalSpace::new(Task::full(), [1e4; 6], [200.0; 6], [k_i; 6], 1e-3).unwrap().with_null_space(null_space);
    let report = analyse(&ROBOT, &ROBOT, &controller, &[POSTURE.into()], 1e-3, Delay::NONE).unwrap();
    assert!(report.is_stable(), "{report:?}");
    let mut errors = Errors::default();
    run(
        &ROBOT,
        State::at_rest(POSTURE.into()),
        RunOptions::new(PERIOD, END),
        |t, measured| controller.torque(&ROBOT, &trajectory.sample(t), measured).map(|torque| torque.tau),
        |sample| errors.add(&Task::full().error(&trajectory.sample(sample.time).pose, &Pose::of(&ROBOT, &sample.state.q))),
    )
    .unwrap();
    errors
}

#[test]
fn operational_space_in_six_rows() {
    control(0.0).check(1e-6);
}

#[test]
fn operational_space_in_six_rows_with_integral() {
    control(1e5).check(1e-6);
}

#[test]
fn inverse_dynamics_after_second_order_inverse_kinematics() {
    let trajectory = trajectory();
    let limits = JointLimits::rates([2.0; 7]).unwrap();
    let clik =
        SecondOrder::new(Task::full(), [1e4; 6], [200.0; 6], 1e-3, Integration::HoldConsistent, limits, [1e-3; 6]).unwrap();
    let clik = clik.with_null_space_damping(5.0).unwrap();
    let controller = InverseDynamics::new([1e4; 7], [200.0; 7]).unwrap();
    let mut reference = State::at_rest(POSTURE.into());
    let mut errors = Errors::default();
    run(
        &ROBOT,
        State::at_rest(POSTURE.into()),
        RunOptions::new(PERIOD, END),
        |t, measured| {
            let step = clik.step(&ROBOT, &reference, &trajectory.sample(t)).unwrap();
            reference = step.next;
            controller.torque(&ROBOT, &step.reference, measured).map(|torque| torque.tau)
        },
        |sample| errors.add(&Task::full().error(&trajectory.sample(sample.time).pose, &Pose::of(&ROBOT, &sample.state.q))),
    )
    .unwrap();
    errors.check(1e-5);
}

#[test]
fn the_free_joint_motion_climbs_the_manipulability() {
    use armgen_runtime::manipulability::manipulability;
    let follow = |k_0: f64| {
        let trajectory = trajectory();
        let algorithm = PseudoInverse::new([200.0; 6], k_0, Manipulability { task: Task::full() }).unwrap();
        let clik = Clik::new(Task::full(), algorithm, 1e-3, JointLimits::rates([2.0; 7]).unwrap(), [1e-5; 6]).unwrap();
        let (mut q, mut errors) = (SVector::from(POSTURE), Errors::default());
        for k in 0..=6000 {
            let step = clik.step(&ROBOT, &q, &trajectory.sample(PERIOD * k)).unwrap();
            errors.add(&step.error);
            q = step.q;
        }
        errors.check(1e-5);
        manipulability(&ROBOT.geometric_jacobian(&q))
    };
    let (without, with) = (follow(0.0), follow(20.0));
    println!("w at the end: {without} without, {with} with the objective");
    assert!(with > without);
}
