//! What controllers refuse, limit and hold back.

use crate::common;

use armgen_runtime::{
    clik::{Clik, Integration, JacobianInverse, JointLimits, Outcome, WithinRange},
    control::{
        Adaptive, Admittance, BoundaryLayer, ControlError, FrictionCompensation, HandGuiding, Impedance, Interval,
        InverseDynamics, NullSpace, OperationalSpace, PdGravity, Robust, TorqueLimits, Walls,
    },
    linalg::{Damping, DampingError, Limited},
    reference::{JointReference, OperationalReference, Pose, State},
    settings::{Setting, SettingError},
    simulation::{Integrator, Plant, RunError},
    task::{Row, Task, TaskError},
    trajectory::{PlanError, PlanFault},
};
use common::{below, close, ghost, scara::NOMINAL};
use nalgebra::{vector, Vector4};
use std::time::Duration;

const NAN: f64 = f64::NAN;

#[test]
fn gains_are_checked() {
    let positive = |setting, index| Some(SettingError::NotPositive { setting, index });
    let finite = |setting, index| Some(SettingError::NotFinite { setting, index });
    let (two, one) = ([2.0, 2.0], [1.0, 1.0]);
    assert_eq!(PdGravity::new([1.0, 0.0], one).err(), positive(Setting::Proportional, 1));
    assert_eq!(PdGravity::new(two, [-1.0, 1.0]).err(), positive(Setting::Derivative, 0));
    assert_eq!(InverseDynamics::new([1.0, NAN], one).err(), finite(Setting::Proportional, 1));
    assert_eq!(InverseDynamics::new(two, [f64::INFINITY, 1.0]).err(), finite(Setting::Derivative, 0));
    let layer = |rho, epsilon| BoundaryLayer { rho, epsilon };
    assert_eq!(Robust::new(two, one, one, [1.0, 0.0], layer(1.0, 1.0)).err(), positive(Setting::LyapunovWeight, 1));
    assert_eq!(Robust::new(two, one, one, one, layer(-1.0, 1.0)).err(), positive(Setting::UncertaintyBound, 0));
    assert_eq!(Robust::new(two, one, one, one, layer(1.0, 0.0)).err(), positive(Setting::BoundaryLayer, 0));
    assert_eq!(Adaptive::new(two, one, [1.0, 0.0, 1.0], [0.0; 3], 1e-3).err(), positive(Setting::Adaptation, 1));
    assert_eq!(Adaptive::new(two, one, [1.0; 3], [0.0, 0.0, NAN], 1e-3).err(), finite(Setting::Estimate, 2));
    assert_eq!(Adaptive::new([2.0, 0.0], one, [1.0; 3], [0.0; 3], 1e-3).err(), positive(Setting::Filter, 1));
    assert_eq!(Adaptive::new(two, one, [1.0; 3], [0.0; 3], 0.0).err(), positive(Setting::Period, 0));
    assert_eq!(Interval::new([0.0, 2.0], [1.0, 1.0]).err(), positive(Setting::Interval, 1));
    assert!(Interval::new([f64::MIN, 1.0], [f64::MAX, 1.0]).is_ok(), "their difference is beyond the range of the scalar");
    let operational = |k_i, h| OperationalSpace::<f64, 4, 4>::new(ghost::task(), [1.0; 4], [1.0; 4], k_i, h);
    assert_eq!(operational([0.0, 0.0, -1.0, 0.0], 1e-3).err(), positive(Setting::Integral, 2));
    assert_eq!(operational([0.0; 4], NAN).err(), finite(Setting::Period, 0));
    assert_eq!(operational([0.0; 4], 1e-3).unwrap().with_integral_limit([-1.0; 4]).err(), positive(Setting::IntegralLimit, 0));
    assert_eq!(NullSpace::new([0.0, 0.0], [1.0, 0.0], [0.0; 2]).err(), positive(Setting::NullSpace, 1));
    let impedance = |k, ratio| Impedance::<f64, 4, 4>::new(ghost::task(), k, ratio);
    assert_eq!(impedance([1.0, 1.0, 0.0, 1.0], 0.7).err(), positive(Setting::Stiffness, 2));
    assert_eq!(impedance([1.0; 4], 0.0).err(), positive(Setting::DampingRatio, 0));
    assert_eq!(impedance([1.0; 4], 0.7).unwrap().with_damping([1.0, NAN, 1.0, 1.0]).err(), finite(Setting::Derivative, 1));
    assert_eq!(impedance([1.0; 4], 0.7).unwrap().with_slowest(-1.0).err(), positive(Setting::SlowestDirection, 0));
    assert_eq!(FrictionCompensation::new(1.0, 0.01).err(), positive(Setting::FrictionShare, 0));
    assert_eq!(FrictionCompensation::new(0.9, 0.0).err(), positive(Setting::FrictionLayer, 0));
    assert_eq!(HandGuiding::new([1.0, 0.0]).err(), positive(Setting::Derivative, 1));
    assert_eq!(HandGuiding::new(one).unwrap().with_hold([1.0, 0.0], one, one).err(), positive(Setting::HoldForce, 1));
    assert_eq!(HandGuiding::new(one).unwrap().with_speed_cap([NAN, 0.0], one).err(), finite(Setting::RateLimit, 0));
    // The walls of the second joint meet.
    assert_eq!(Walls::new([0.0; 2], [1.0, 0.2], [0.1; 2], one, one).err(), positive(Setting::PositionLimit, 1));
    assert!(Walls::new([f64::NEG_INFINITY; 2], [1.0; 2], [0.1; 2], one, one).is_ok());
    let admittance = |m, k| Admittance::<f64, 4>::new(ghost::task(), m, [1.0; 4], k, 1e-3);
    assert_eq!(admittance([1.0, 0.0, 1.0, 1.0], [0.0; 4]).err(), positive(Setting::Mass, 1));
    assert_eq!(admittance([1.0; 4], [0.0, 0.0, 0.0, -1.0]).err(), positive(Setting::Stiffness, 3));
    assert_eq!(TorqueLimits::new([1.0, 0.0]).err(), positive(Setting::TorqueLimit, 1));
    assert_eq!(JointLimits::rates([1.0, NAN]).err(), finite(Setting::RateLimit, 1));
    assert_eq!(JointLimits::rates(one).unwrap().with_range([0.0, 1.0], [1.0, 1.0]).err(), positive(Setting::PositionLimit, 1));
    assert_eq!(Damping::below(0.0).at_most(1.0).err(), Some(DampingError::Threshold));
    assert_eq!(Damping::below(1.0).at_most(NAN).err(), Some(DampingError::Factor));
}

#[test]
fn an_infinite_limit_never_acts() {
    const FREE: f64 = f64::INFINITY;
    let torque = TorqueLimits::new([FREE, 1.0]).unwrap();
    assert_eq!(torque.apply(&vector![1e300, -2.0]), Limited { value: vector![1e300, -1.0], is_limited: true });
    assert!(TorqueLimits::new([NAN]).is_err() && TorqueLimits::new([-FREE]).is_err());
    let limits = JointLimits::rates([1.0, 1.0]).unwrap().with_range([-FREE, 0.0], [FREE, FREE]).unwrap();
    assert_eq!(limits.stop(&vector![0.0, 0.0], &vector![1e300, -1.0]), WithinRange { q: vector![1e300, 0.0], stopped: Some(1) });
    assert!(JointLimits::rates([1.0]).unwrap().with_range([FREE], [FREE]).is_err());
    assert!(JointLimits::rates([1.0]).unwrap().with_range([0.0], [NAN]).is_err());
    assert!(JointLimits::rates([FREE]).is_err(), "a rate always has a limit");
}

#[test]
fn a_frozen_estimate_stays_outside_the_interval() {
    let adaptive = Adaptive::new([1.0], [1.0], [1.0; 2], [5.0, 5.0], 1e-3).unwrap().with_frozen([true, false]);
    let adaptive = adaptive.with_projection(Interval::new([0.0; 2], [1.0; 2]).unwrap());
    assert_eq!(*adaptive.estimate(), vector![5.0, 1.0]);
}

#[test]
fn errors_say_what_is_wrong() {
    fn message(error: impl std::error::Error) -> String {
        error.to_string()
    }
    let gain = PdGravity::new([1.0, 0.0], [1.0; 2]).unwrap_err();
    assert_eq!(message(gain), "element 1 (from 0) of K_P is negative, or zero where only a positive value makes sense");
    let plan = PlanFault::CruiseTimeNegative;
    let plan = PlanError { segment: 3, fault: plan };
    assert!(message(plan).starts_with("segment 3: the acceleration time is more than half the duration"));
    assert_eq!(message(TaskError::NoSuchRow(7)), "there is no row 7: 0 to 2 are x, y, z, and 3 to 5 the rotations about them");
    let run = RunError::Controller { time: Duration::from_millis(1500), error: ControlError::MeasurementNotFinite };
    assert_eq!(message(run), "at 1.5 s: a measured joint variable or rate is infinite or NaN");
}

#[test]
fn a_task_is_made_of_the_places_of_its_rows() {
    assert_eq!(Task::from_indices([0, 1, 2, 5]), Task::new([Row::X, Row::Y, Row::Z, Row::Rz]));
    assert_eq!(Task::from_indices([6]), Err(TaskError::NoSuchRow(6)));
    assert_eq!(Task::from_indices([1, 1]), Err(TaskError::Repeated(Row::Y)));
    assert_eq!(Task::from_indices([]), Err(TaskError::Empty));
}

/// Every way in which one number of a measurement can be lost.
fn broken() -> impl Iterator<Item = State<f64, 4>> {
    let good = State { q: ghost::start(), dq: vector![0.1, 0.2, 0.3, 0.4] };
    (0..8).flat_map(move |i| {
        [NAN, f64::INFINITY, f64::NEG_INFINITY].map(move |x| {
            let mut state = good;
            *(if i < 4 { &mut state.q[i] } else { &mut state.dq[i - 4] }) = x;
            state
        })
    })
}

#[test]
fn a_broken_measurement_gives_an_error_and_never_a_torque() {
    let model = ghost::nominal();
    let rest = JointReference::at_rest(ghost::start());
    let pose = OperationalReference::at_rest(Pose::of(&model, &ghost::start()));
    let pd = PdGravity::new([1e3; 4], [10.0; 4]).unwrap();
    let inverse = InverseDynamics::new([1e3; 4], [10.0; 4]).unwrap();
    let robust = Robust::new([1e3; 4], [10.0; 4], [1.0; 4], [1.0; 4], BoundaryLayer { rho: 10.0, epsilon: 0.2 }).unwrap();
    let mut adaptive = Adaptive::new([500.0; 4], [10.0; 4], [10.0; 14], NOMINAL, 1e-3).unwrap();
    let mut operational = OperationalSpace::new(ghost::task(), [1e3; 4], [10.0; 4], [10.0; 4], 1e-3).unwrap();
    let impedance = Impedance::new(ghost::task(), [1e3; 4], 0.7).unwrap();
    let mut guiding = HandGuiding::new([10.0; 4]).unwrap().with_hold([5.0; 4], [100.0; 4], [1.0; 4]).unwrap();
    let (controller_state, integral) = (*adaptive.estimate(), *operational.integral());
    let lost = Some(ControlError::MeasurementNotFinite);
    for measured in broken() {
        assert_eq!(pd.torque(&model, &rest, &measured).err(), lost);
        assert_eq!(inverse.torque(&model, &rest, &measured).err(), lost);
        assert_eq!(robust.torque(&model, &rest, &measured).err(), lost);
        assert_eq!(adaptive.torque(&model, &rest, &measured).err(), lost);
        assert_eq!(operational.torque(&model, &pose, &measured).err(), lost);
        assert_eq!(impedance.torque(&model, &pose, &measured).err(), lost);
        assert_eq!(guiding.torque(&model, &measured).err(), lost);
    }
    assert_eq!(guiding.anchor(), None);
    // Beyond the range of the scalar: no torque either.
    let wild = State { q: ghost::start(), dq: Vector4::repeat(1e200) };
    assert_eq!(inverse.torque(&model, &rest, &wild).err(), Some(ControlError::TorqueNotFinite));
    assert_eq!(adaptive.torque(&model, &rest, &wild).err(), Some(ControlError::StateNotFinite));
    assert_eq!(operational.torque(&model, &pose, &wild).err(), Some(ControlError::TorqueNotFinite));
    let beyond = State { q: ghost::start(), dq: Vector4::repeat(1e308) };
    assert_eq!(guiding.torque(&model, &beyond).err(), Some(ControlError::TorqueNotFinite));
    assert_eq!(guiding.anchor(), None);
    // Nothing of it stays in the controller state.
    assert_eq!(adaptive.estimate(), &controller_state);
    assert_eq!(operational.integral(), &integral);
    let nowhere = JointReference { dq: Vector4::repeat(NAN), ..rest };
    assert_eq!(robust.torque(&model, &nowhere, &State::at_rest(ghost::start())).err(), Some(ControlError::ReferenceNotFinite));
}

#[test]
fn torques_are_limited() {
    let model = ghost::nominal();
    let bound = [5.0, 4.0, 120.0, 0.5];
    let limits = TorqueLimits::new(bound).unwrap();
    let controller = InverseDynamics::new([1e4; 4], [200.0; 4]).unwrap();
    let limited = controller.with_torque_limits(limits);
    let reference = JointReference::at_rest(ghost::start());
    let far = State::at_rest(ghost::start() + vector![0.5, -0.5, 0.1, 1.0]);
    let (free, cut) = (controller.torque(&model, &reference, &far).unwrap(), limited.torque(&model, &reference, &far).unwrap());
    assert!(cut.limited && !free.limited);
    for i in 0..4 {
        assert_eq!(cut.tau[i], free.tau[i].clamp(-bound[i], bound[i]));
    }
    let near = State::at_rest(ghost::start());
    assert_eq!(controller.torque(&model, &reference, &near), limited.torque(&model, &reference, &near));
}

#[test]
fn an_estimate_rests_while_a_torque_is_cut() {
    let model = ghost::nominal();
    let adaptive = || Adaptive::new([100.0; 4], [1000.0, 500.0, 2000.0, 100.0], [1.0; 14], NOMINAL, 1e-3).unwrap();
    let reference = JointReference::at_rest(ghost::start());
    let far = State::at_rest(ghost::start() + vector![0.0, 0.0, 0.1, 0.0]);
    let mut free = adaptive();
    free.torque(&model, &reference, &far).unwrap();
    assert_ne!(free.estimate()[2], 10.0);
    let mut cut = adaptive().with_torque_limits(TorqueLimits::new([100.0; 4]).unwrap());
    assert!(cut.torque(&model, &reference, &far).unwrap().limited);
    assert_eq!(cut.estimate()[2], 10.0);
}

/// A step of 10 cm in x, with a motor too weak for it: how far does the tip shoot over?
fn overshoot(limit_integral: bool, anti_windup: bool) -> f64 {
    let (model, arm) = (ghost::nominal(), ghost::nominal());
    let start = ghost::start();
    let mut goal = Pose::of(&model, &start);
    goal.position.x += 0.1;
    let reference = OperationalReference::at_rest(goal);
    let bound = [6.0, 4.0, 200.0, 5.0];
    let mut controller = OperationalSpace::new(ghost::task(), [400.0; 4], [40.0; 4], [4000.0; 4], 1e-3).unwrap();
    if limit_integral {
        controller = controller.with_integral_limit([1e-3; 4]).unwrap();
    }
    if anti_windup {
        controller = controller.with_torque_limits(TorqueLimits::new(bound).unwrap());
    }
    let mut plant = Plant::new(&arm, State::at_rest(start), Integrator::RungeKutta4 { substeps: 1 });
    let mut over = 0.0f64;
    for _ in 0..4000 {
        let tau = controller.torque(&model, &reference, plant.state()).unwrap().tau;
        // The motor's limit is there whether the controller knows of it or not.
        let tau = Vector4::from_fn(|i, _| tau[i].clamp(-bound[i], bound[i]));
        plant.advance(&tau, 1e-3).unwrap();
        over = over.max(Pose::of(&arm, &plant.state().q).position.x - goal.position.x);
    }
    over
}

#[test]
fn the_integral_does_not_wind_up() {
    let (blind, aware, bounded) = (overshoot(false, false), overshoot(false, true), overshoot(true, false));
    println!("overshoot: {blind} blind, {aware} with anti-windup, {bounded} with a limit of the integral alone");
    assert!(aware < 0.2 * blind && bounded < 0.2 * blind);
}

/// While a torque is cut an integral moves towards zero and not beyond.
#[test]
fn an_integral_stops_at_zero_while_a_torque_is_cut() {
    let model = ghost::nominal();
    let q = ghost::start();
    let task = Task::new([Row::Z]).unwrap();
    let law = OperationalSpace::<f64, 4, 1>::new(task, [1.0], [1.0], [1.0], 1.0).unwrap();
    let at = |z: f64| {
        let mut goal = Pose::of(&model, &q);
        goal.position.z += z;
        OperationalReference::at_rest(goal)
    };
    for sign in [1.0, -1.0] {
        let mut law = law;
        law.torque(&model, &at(sign * 0.01), &State::at_rest(q)).unwrap();
        close("integral", law.integral()[0], sign * 0.01, 1e-15);
        // Gravity asks for 98.1 N.
        let mut cut = law.with_torque_limits(TorqueLimits::new([1.0; 4]).unwrap());
        assert!(cut.torque(&model, &at(sign * 0.02), &State::at_rest(q)).unwrap().limited);
        close("not further out", cut.integral()[0], sign * 0.01, 1e-15);
        cut.torque(&model, &at(sign * -0.004), &State::at_rest(q)).unwrap();
        close("towards zero", cut.integral()[0], sign * 0.006, 1e-15);
        cut.torque(&model, &at(sign * -0.02), &State::at_rest(q)).unwrap();
        assert_eq!(cut.integral()[0], 0.0);
        cut.torque(&model, &at(sign * -0.02), &State::at_rest(q)).unwrap();
        assert_eq!(cut.integral()[0], 0.0);
    }
}

#[test]
fn a_singular_start_is_an_error_without_damping_and_named_with_it() {
    let (model, arm) = (ghost::nominal(), ghost::nominal());
    let singular = State::at_rest(vector![0.3, 0.0, 0.2, 0.4]);
    let goal = OperationalReference::at_rest(Pose::of(&model, &vector![0.5, 1.0, 0.3, 0.0]));
    let plain = OperationalSpace::new(ghost::task(), [100.0; 4], [20.0; 4], [0.0; 4], 1e-3).unwrap();
    assert_eq!(plain.clone().torque(&model, &goal, &singular).err(), Some(ControlError::Singular));
    let limits = TorqueLimits::new([60.0, 30.0, 250.0, 10.0]).unwrap();
    let null_space = NullSpace::new([0.0; 4], [5.0; 4], [0.0; 4]).unwrap();
    let mut damped =
        plain.with_damping(Damping::below(0.05).at_most(0.2).unwrap()).with_torque_limits(limits).with_null_space(null_space);
    let first = damped.torque(&model, &goal, &singular).unwrap();
    assert!(first.damped);
    let mut plant = Plant::new(&arm, singular, Integrator::RungeKutta4 { substeps: 1 });
    let mut rates = 0.0f64;
    for _ in 0..5000 {
        plant.advance(&damped.torque(&model, &goal, plant.state()).unwrap().tau, 1e-3).unwrap();
        rates = rates.max(plant.state().dq.amax());
    }
    let e = ghost::task().error(&goal.pose, &Pose::of(&arm, &plant.state().q));
    below("largest rate", rates, 20.0);
    below("error at the end", e.norm(), 1e-6);
    assert!(!damped.torque(&model, &goal, plant.state()).unwrap().damped);
}

#[test]
fn second_order_stays_within_limits() {
    let robot = ghost::nominal();
    let limits =
        JointLimits::rates([2.0, 2.0, 0.5, 4.0]).unwrap().with_range([-2.0, 0.1, 0.0, -4.0], [2.0, 2.8, 0.3, 4.0]).unwrap();
    for integration in [Integration::ExplicitEuler, Integration::HoldConsistent] {
        let clik =
            armgen_runtime::clik::SecondOrder::new(ghost::task(), [400.0; 4], [40.0; 4], 1e-3, integration, limits, [1e-6; 4])
                .unwrap();
        let goal = OperationalReference::at_rest(Pose::of(&robot, &vector![0.5, 1.0, 0.5, 0.0]));
        let mut state = State::at_rest(vector![-1.5, 2.0, 0.1, 0.5]);
        let mut outcomes = Vec::new();
        for _ in 0..4000 {
            let step = clik.step(&robot, &state, &goal).unwrap();
            if integration == Integration::HoldConsistent {
                // The reference follows its held acceleration, except for a joint that meets its limit.
                let off = (step.reference.held(1e-3).q - step.next.q).abs();
                let stop = 0.5e-3 * limits.rate()[2];
                let stopped = step.outcome == Outcome::JointLimit { joint: 2 };
                assert!((0..4).all(|i| off[i] <= if stopped && i == 2 { stop } else { 1e-15 }), "{off} {step:?}");
            }
            state = step.next;
            assert!(state.q[2] <= 0.3 && (0..4).all(|i| state.dq[i].abs() <= limits.rate()[i]), "{state:?}");
            if outcomes.last() != Some(&step.outcome) {
                outcomes.push(step.outcome);
            }
        }
        println!("{outcomes:?}");
        assert_eq!(outcomes.last(), Some(&Outcome::JointLimit { joint: 2 }));
        assert!(outcomes.contains(&Outcome::RateLimited));
        assert!(outcomes.len() < 10, "no flicker");
        assert_eq!(state.q[2], 0.3);
    }
}

#[test]
fn single_precision_controls_too() {
    use armgen_runtime::simulation::{run, RunOptions};
    use common::scara::Scara;
    let (model, plant, trajectory) = (Scara::<f32>::nominal(), Scara::<f32>::loaded(), ghost::ghost::<f32>());
    let mut operational = OperationalSpace::new(ghost::task(), [5e3f32; 4], [100.0; 4], [1e4; 4], 1e-3).unwrap();
    let mut adaptive =
        Adaptive::<f32, 4, 14>::new([100.0; 4], [1000.0, 500.0, 2000.0, 100.0], [1e3; 14], NOMINAL.map(|x| x as f32), 1e-3)
            .unwrap();
    let start = State::at_rest(ghost::start().cast::<f32>());
    let mut worst = 0.0f32;
    run(
        &plant,
        start,
        RunOptions::new(ghost::PERIOD, ghost::CUT),
        |t, measured| operational.torque(&model, &trajectory.sample(t), measured).map(|torque| torque.tau),
        |sample| {
            let e = ghost::task().error(&trajectory.sample(sample.time).pose, &Pose::of(&plant, &sample.state.q));
            if sample.index > 2000 {
                worst = worst.max(e.amax());
            }
        },
    )
    .unwrap();
    below("largest error after 2 s", f64::from(worst), 2e-4);
    // At rest on the reference the torque is what gravity asks.
    let rest = JointReference::at_rest(start.q);
    let tau = adaptive.torque(&model, &rest, &start).unwrap().tau;
    assert!((tau - vector![0.0, 0.0, -98.1, 0.0]).amax() < 1e-5, "{tau}");
    let limits = JointLimits::rates([3.0f32; 4]).unwrap();
    let clik = Clik::new(ghost::task(), JacobianInverse::new([100.0f32; 4]).unwrap(), 1e-3, limits, [1e-4; 4]).unwrap();
    let (mut q, mut worst) = (start.q, 0.0f32);
    for k in 0..=20_000 {
        let step = clik.step(&model, &q, &trajectory.sample(ghost::PERIOD * k)).unwrap();
        worst = worst.max(step.error.amax());
        q = step.q;
    }
    below("largest error of CLIK", f64::from(worst), 1e-4);
}
