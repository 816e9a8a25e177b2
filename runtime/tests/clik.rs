//! Closed-loop inverse kinematics along the ghost path, every algorithm with its gains.
//!
//! Largest errors with five digits come from the technical project, docs/technical-project.md.

use crate::common;

use armgen_runtime::{
    clik::{
        Algorithm, Clik, ClikError, DampedLeastSquares, Integration, JacobianInverse, JacobianTranspose, JointLimits,
        JointRangeDistance, Manipulability, NoObjective, Objective, Outcome, PseudoInverse, SecondOrder,
    },
    linalg::{Damping, Limited},
    manipulability::manipulability,
    reference::{OperationalReference, Pose, State},
    robot::Kinematics,
    task::{Row, Task},
};
use common::{below, close_percent, ghost, scara::Scara};
use nalgebra::{vector, SVector, Vector4};
use std::time::Duration;

fn limits() -> JointLimits<f64, 4> {
    JointLimits::rates([100.0; 4]).unwrap()
}

/// Largest |error| of each task row over the 20 s, and the last posture.
fn follow<A: Algorithm<Scara<f64>, 4, M>, const M: usize>(task: Task<M>, algorithm: A) -> (SVector<f64, M>, Vector4<f64>) {
    let (robot, trajectory) = (ghost::nominal(), ghost::ghost::<f64>());
    let clik = Clik::new(task, algorithm, 1e-3, limits(), [1e-3; M]).unwrap();
    let (mut q, mut worst) = (ghost::start(), SVector::<f64, M>::zeros());
    for k in 0..=20_000 {
        let step = clik.step(&robot, &q, &trajectory.sample(Duration::from_millis(k))).unwrap();
        worst = worst.sup(&step.error.abs());
        q = step.q;
    }
    (worst, q)
}

#[track_caller]
fn check<const M: usize>(found: SVector<f64, M>, expected: [f64; M]) {
    for i in 0..M {
        close_percent(&format!("largest error of row {i}"), found[i], expected[i], 1.0);
    }
}

#[test]
fn jacobian_inverse() {
    let (worst, _) = follow(ghost::task(), JacobianInverse::new([500.0, 500.0, 700.0, 2.0]).unwrap());
    check(worst, [5.2370e-7, 1.0831e-6, 7.2115e-7, 7.5480e-5]);
}

const TRANSPOSE: [f64; 4] = [2000.0, 1300.0, 400.0, 350.0];

#[test]
fn jacobian_transpose() {
    let (worst, _) = follow(ghost::task(), JacobianTranspose::new(TRANSPOSE).unwrap());
    check(worst, [9.3381e-4, 1.5212e-3, 3.1250e-4, 1.8641e-3]);
}

#[test]
fn the_transpose_stands_near_its_limit() {
    let (robot, transpose) = (ghost::nominal(), JacobianTranspose::new(TRANSPOSE).unwrap());
    let gain = |q: &Vector4<f64>| transpose.loop_gain(&ghost::task().jacobian(&robot.geometric_jacobian(q)), 1e-3);
    let along = ghost::joint_reference().iter().take(20_001).map(|r| gain(&r.q)).fold(0.0, f64::max);
    close_percent("loop gain along the path", along, 1.80, 0.3);
    // The whole circle of shoulder angles with the arm nearly stretched.
    let stretched = (0..360).map(|k| gain(&vector![f64::from(k).to_radians(), 0.01, 0.0, 0.0])).fold(0.0, f64::max);
    close_percent("loop gain with the arm stretched", stretched, 3.22, 0.3);
    let (worst, _) = follow(ghost::task(), JacobianTranspose::new(TRANSPOSE.map(|k| 1.2 * k)).unwrap());
    assert!(worst.max() > 0.05, "a fifth more gain must diverge: {worst}");
}

fn relaxed() -> Task<3> {
    Task::new([Row::Y, Row::Z, Row::Rz]).unwrap()
}

fn dexterous<O: Objective<Scara<f64>, 4>>(k_0: f64, objective: O) -> (SVector<f64, 3>, Vector4<f64>) {
    follow(relaxed(), PseudoInverse::new([1000.0, 1500.0, 5.0], k_0, objective).unwrap())
}

fn w<const M: usize>(task: Task<M>, q: &Vector4<f64>) -> f64 {
    manipulability(&task.jacobian(&ghost::nominal().geometric_jacobian(q)))
}

#[test]
fn the_manipulability_of_the_whole_task_keeps_the_arm_dexterous() {
    let (worst, q) = dexterous(10.0, Manipulability { task: ghost::task() });
    println!("largest errors {worst}, w at the end: {}", w(ghost::task(), &q));
    assert!(w(ghost::task(), &q) >= 0.249);
    // Rows z and phi do not see the null space.
    close_percent("largest error of z", worst[1], 5.0481e-7, 1.0);
    close_percent("largest error of phi", worst[2], 3.4674e-5, 1.0);
    below("largest error of y", worst[0], 1.0850e-6);
}

#[test]
fn the_manipulability_of_the_relaxed_task_leads_into_a_singularity() {
    let before = w(relaxed(), &ghost::start());
    let (worst, q) = dexterous(10.0, Manipulability { task: relaxed() });
    check(worst, [1.0850e-6, 5.0481e-7, 3.4674e-5]);
    println!("relaxed w: {before} -> {}, theta2 -> {}", w(relaxed(), &q), q[1]);
    close_percent("relaxed w at the start", before, 0.6253, 0.01);
    assert!(w(relaxed(), &q) >= 1.22);
    common::close("theta2 at the end", q[1], -0.012, 5e-4);
}

#[test]
fn without_an_objective_dexterity_is_left_to_chance() {
    let (worst, q) = dexterous(0.0, NoObjective);
    println!("w at the end: {}, theta2 {}", w(ghost::task(), &q), q[1]);
    assert!(worst.max() < 1e-3 && w(ghost::task(), &q) < 0.249);
}

fn second_order(integration: Integration) -> SVector<f64, 4> {
    let (robot, trajectory, clik) = (ghost::nominal(), ghost::ghost::<f64>(), ghost::second_order(integration));
    let (mut state, mut worst) = (State::at_rest(ghost::start()), SVector::<f64, 4>::zeros());
    for k in 0..=20_000 {
        let step = clik.step(&robot, &state, &trajectory.sample(Duration::from_millis(k))).unwrap();
        worst = worst.sup(&step.error.abs());
        state = step.next;
    }
    worst
}

#[test]
fn second_order_by_explicit_euler() {
    check(second_order(Integration::ExplicitEuler), [1.0603e-5, 2.0916e-5, 1.5404e-5, 1.5727e-4]);
}

#[test]
fn second_order_consistent_with_the_hold() {
    let worst = second_order(Integration::HoldConsistent);
    for (i, bound) in [4e-6, 4e-6, 1e-10, 1e-10].iter().enumerate() {
        below(&format!("largest error of row {i}"), worst[i], *bound);
    }
}

fn damped() -> DampedLeastSquares<f64, 4> {
    DampedLeastSquares::new([50.0; 4], Damping::below(0.03).at_most(0.1).unwrap()).unwrap()
}

fn bounded() -> JointLimits<f64, 4> {
    JointLimits::rates([3.0, 3.0, 1.0, 6.0]).unwrap()
}

fn goal(q: [f64; 4]) -> Pose<f64> {
    Pose::of(&ghost::nominal(), &q.into())
}

#[test]
fn the_damped_inverse_is_the_inverse_away_from_singularities() {
    let algorithm = DampedLeastSquares::new([500.0, 500.0, 700.0, 2.0], Damping::below(0.03).at_most(0.1).unwrap()).unwrap();
    check(follow(ghost::task(), algorithm).0, [5.2370e-7, 1.0831e-6, 7.2115e-7, 7.5480e-5]);
}

#[test]
fn approaches_end_with_a_name() {
    let robot = ghost::nominal();
    let clik = Clik::new(ghost::task(), damped(), 1e-3, bounded(), [1e-6; 4]).unwrap();
    let near = |q: [f64; 4], goal: Pose<f64>| {
        let reached = clik.approach(&robot, &q.into(), &goal, 20_000).unwrap();
        assert_eq!(reached.error, ghost::task().error(&goal, &Pose::of(&robot, &reached.q)));
        reached
    };
    // Off the goal, but within reach.
    let reached = near([0.1, 1.0, 0.1, 0.0], goal([-0.5, 1.4, 0.3, 0.8]));
    assert_eq!(reached.outcome, Outcome::Converged, "{reached:?}");
    // From the stretched arm, the goal straight inwards: no joint rate points there, to first order.
    let reached = near([0.0, 0.0, 0.1, 0.0], Pose { position: vector![0.7, 0.0, 0.4], ..goal([0.0, 0.0, 0.1, 0.0]) });
    assert_eq!(reached.outcome, Outcome::Converged, "{reached:?}");
    // A tenth of a metre too far.
    let far = Pose { position: vector![0.0, 1.1, 0.4], ..goal([0.0, 1.0, 0.1, 0.0]) };
    let reached = near([0.1, 1.0, 0.1, 0.0], far);
    assert_eq!(reached.outcome, Outcome::OutOfReach, "{reached:?}");
    common::close("distance left", reached.error.norm(), 0.1, 1e-4);
    // A goal beyond a joint limit.
    let limits = bounded().with_range([-1.0, 0.2, 0.0, -3.0], [1.0, 2.5, 0.4, 3.0]).unwrap();
    let clik = Clik::new(ghost::task(), damped(), 1e-3, limits, [1e-6; 4]).unwrap();
    let reached = clik.approach(&robot, &vector![0.1, 1.0, 0.1, 0.0], &goal([0.1, 1.0, 0.7, 0.0]), 20_000).unwrap();
    assert_eq!(reached.outcome, Outcome::JointLimit { joint: 2 }, "{reached:?}");
    assert_eq!(reached.q[2], 0.4);
    // Too few steps.
    let reached = clik.approach(&robot, &vector![0.1, 1.0, 0.1, 0.0], &goal([-0.5, 1.4, 0.3, 0.8]), 10).unwrap();
    assert_eq!((reached.outcome, reached.steps), (Outcome::OutOfSteps, 10));
}

#[test]
fn errors() {
    let robot = ghost::nominal();
    let inverse = JacobianInverse::new([50.0; 4]).unwrap();
    let clik = Clik::new(ghost::task(), inverse, 1e-3, bounded(), [1e-6; 4]).unwrap();
    let rest = OperationalReference::at_rest(goal([0.1, 1.0, 0.1, 0.0]));
    let singular = vector![0.1, 0.0, 0.1, 0.0];
    assert_eq!(clik.step(&robot, &singular, &rest).unwrap_err(), ClikError::Singular);
    assert_eq!(clik.step(&robot, &vector![0.1, f64::NAN, 0.1, 0.0], &rest).unwrap_err(), ClikError::StateNotFinite);
    let mut lost = rest;
    lost.velocity[1] = f64::INFINITY;
    assert_eq!(clik.step(&robot, &vector![0.1, 1.0, 0.1, 0.0], &lost).unwrap_err(), ClikError::ReferenceNotFinite);
    let second = ghost::second_order(Integration::HoldConsistent);
    assert_eq!(second.step(&robot, &State::at_rest(singular), &rest).unwrap_err(), ClikError::Singular);
    let damping = Damping::below(0.03).at_most(0.1).unwrap();
    let start = State::at_rest(singular);
    let step = second.with_damping(damping).step(&robot, &start, &rest).unwrap();
    // ddq = J* K_P e at rest, and the state is that acceleration held for a period.
    let k_p = vector![1000.0, 1000.0, 2000.0, 1.0];
    let j = ghost::task().jacobian(&robot.geometric_jacobian(&singular));
    let ddq = damping.solve(&j, &k_p.component_mul(&step.error)).unwrap().x;
    assert!((step.reference.ddq - ddq).norm() < 1e-12 * ddq.norm() && ddq.norm() > 1.0, "{step:?}");
    assert!((step.next.dq - ddq * 1e-3).norm() < 1e-15 * ddq.norm());
    assert_eq!(step.outcome, Outcome::Damped);
}

/// The exact limits of the sampled error of a linear row, e'' = -K_D e' - K_P e, on either side.
#[test]
fn second_order_is_stable_up_to_its_sampled_limits() {
    let (robot, limits, h) = (ghost::nominal(), JointLimits::rates([1e9; 4]).unwrap(), 1e-2);
    let task = Task::new([Row::Z]).unwrap();
    let goal = OperationalReference::at_rest(goal([0.1, 1.0, 0.1, 0.0]));
    let fades = |k_p: f64, k_d: f64, integration| {
        let clik = SecondOrder::new(task, [k_p], [k_d], h, integration, limits, [1e-300]).unwrap();
        let mut state = State::at_rest(vector![0.1, 1.0, 0.100001, 0.0]);
        let size = |state: &State<f64, 4>| (state.q[2] - 0.1).abs() + state.dq[2].abs() * h;
        let start = size(&state);
        for _ in 0..3000 {
            state = clik.step(&robot, &state, &goal).unwrap().next;
        }
        size(&state) < start
    };
    let (below, above) = (0.99, 1.01);
    for (k_p, k_d, integration) in [
        // k_D T = 2 and k_P T = 2 k_D.
        (100.0, 2.0 / h, Integration::HoldConsistent),
        (2.0 * 50.0 / h, 50.0, Integration::HoldConsistent),
        // k_P T = k_D, and 4 - 2 k_D T + k_P T^2 = 0 at k_D T = 3, k_P T^2 = 2.
        (50.0 / h, 50.0, Integration::ExplicitEuler),
    ] {
        let scale = |by: f64| if k_p < 200.0 { (k_p, k_d * by) } else { (k_p * by, k_d) };
        assert!(fades(scale(below).0, scale(below).1, integration), "{k_p} {k_d} {integration:?}");
        assert!(!fades(scale(above).0, scale(above).1, integration), "{k_p} {k_d} {integration:?}");
    }
    assert!(fades(2.0 / (h * h), below * 3.0 / h, Integration::ExplicitEuler));
    assert!(!fades(2.0 / (h * h), above * 3.0 / h, Integration::ExplicitEuler));
}

/// Rest is judged by the change in a step, not by the rate limits, however far these are from the requested rates.
#[test]
fn an_approach_ends_at_a_goal_within_reach_whatever_its_gain() {
    let robot = ghost::nominal();
    for (k, period, rate, tolerance) in [
        (1.0, 1e-2, 100.0, 1e-5),
        (20.0, 1e-3, 10.0, 1e-7),
        (5.0, 1e-3, 1e6, 1e-6),
        (150.0, 1e-3, 1e4, 1e-5),
        (150.0, 1e-3, 1e-2, 1e-5),
    ] {
        let damping = Damping::below(0.03).at_most(0.1).unwrap();
        let law = DampedLeastSquares::new([k; 4], damping).unwrap();
        let clik = Clik::new(ghost::task(), law, period, JointLimits::rates([rate; 4]).unwrap(), [tolerance; 4]).unwrap();
        for near in [[-0.5, 1.4, 0.3, 0.8], [0.2, 0.9, 0.12, 0.1], [0.1, 1.0, 0.1001, 0.0]] {
            let reached = clik.approach(&robot, &vector![0.1, 1.0, 0.1, 0.0], &goal(near), 200_000).unwrap();
            assert_eq!(reached.outcome, Outcome::Converged, "K {k}, T {period}, rates {rate}: {reached:?}");
        }
        let far = Pose { position: vector![0.0, 1.1, 0.4], ..goal([0.0, 1.0, 0.1, 0.0]) };
        let reached = clik.approach(&robot, &vector![0.1, 1.0, 0.1, 0.0], &far, 400_000).unwrap();
        assert_eq!(reached.outcome, Outcome::OutOfReach, "K {k}, T {period}, rates {rate}: {reached:?}");
        common::close("distance left", reached.error.norm(), 0.1, 2e-3);
    }
    // In single precision as well.
    let robot = Scara::<f32>::nominal();
    let law = DampedLeastSquares::new([150.0f32; 4], Damping::below(0.03).at_most(0.1).unwrap()).unwrap();
    let clik = Clik::new(ghost::task(), law, 1e-3, JointLimits::rates([1e6f32; 4]).unwrap(), [1e-5; 4]).unwrap();
    let goal = Pose::of(&robot, &vector![-0.5f32, 1.4, 0.3, 0.8]);
    let reached = clik.approach(&robot, &vector![0.1, 1.0, 0.1, 0.0], &goal, 20_000).unwrap();
    assert_eq!(reached.outcome, Outcome::Converged, "{reached:?}");
    let far = Pose { position: vector![0.0f32, 1.1, 0.4], ..goal };
    let reached = clik.approach(&robot, &vector![0.1, 1.0, 0.1, 0.0], &far, 20_000).unwrap();
    assert_eq!(reached.outcome, Outcome::OutOfReach, "{reached:?}");
}

/// A goal 0.1 m beyond the stretched arm, under laws that weigh the rows differently: they stop where J' K e = 0, not where J' e = 0.
#[test]
fn unequal_gains_end_out_of_reach_as_well() {
    fn outcome<A: Algorithm<Scara<f64>, 4, 4>>(law: A) -> Outcome {
        let limits = JointLimits::rates([3.0; 4]).unwrap();
        let clik = Clik::new(ghost::task(), law, 1e-3, limits, [1e-5; 4]).unwrap();
        let far = Pose { position: vector![0.7, 0.9, 0.4], ..goal([0.0, 1.0, 0.1, 0.0]) };
        clik.approach(&ghost::nominal(), &vector![0.1, 1.0, 0.1, 0.0], &far, 60_000).unwrap().outcome
    }
    let damping = || Damping::below(0.03).at_most(0.1).unwrap();
    for second in [150.0, 100.0, 50.0] {
        let k = [150.0, second, 80.0, 20.0];
        assert_eq!(outcome(DampedLeastSquares::new(k, damping()).unwrap()), Outcome::OutOfReach, "{k:?}");
        assert_eq!(outcome(JacobianTranspose::new(k).unwrap()), Outcome::OutOfReach, "transpose, {k:?}");
    }
}

/// However strongly a law is damped, and slowly let go of a stretched arm: the goal lies inwards, in line with it.
#[test]
fn strong_damping_is_not_out_of_reach() {
    for (most, k, inwards) in [(1.0, 20.0, 0.1), (0.5, 1.0, 0.1), (1.0, 1.0, 0.3), (0.1, 20.0, 0.1)] {
        let law = DampedLeastSquares::new([k; 4], Damping::below(0.2).at_most(most).unwrap()).unwrap();
        let clik = Clik::new(ghost::task(), law, 1e-3, JointLimits::rates([3.0; 4]).unwrap(), [1e-5; 4]).unwrap();
        let start = vector![0.0, 0.0, 0.1, 0.0];
        let at = Pose::of(&ghost::nominal(), &start);
        let goal = Pose { position: at.position - vector![inwards, 0.0, 0.0], ..at };
        let reached = clik.approach(&ghost::nominal(), &start, &goal, 200_000).unwrap();
        assert_eq!(reached.outcome, Outcome::Converged, "lambda {most}, K {k}: {reached:?}");
    }
}

/// From postures to the poses of others. All are reached where the scalar has the digits. None is reported out of reach where
/// rounding keeps a small gain from its tolerance.
#[test]
fn no_goal_within_reach_is_called_out_of_reach() {
    fn outcomes<T: nalgebra::RealField + Copy>([k, period, rate, tolerance]: [f64; 4]) -> Vec<Outcome> {
        let c = |x: f64| nalgebra::convert::<f64, T>(x);
        let robot = Scara::<T>::nominal();
        let law = DampedLeastSquares::new([c(k); 4], Damping::below(c(0.03)).at_most(c(0.1)).unwrap()).unwrap();
        let limits = JointLimits::rates([c(rate); 4]).unwrap();
        let clik = Clik::new(ghost::task(), law, c(period), limits, [c(tolerance); 4]).unwrap();
        (1..=30)
            .map(|n| {
                // Spread evenly by multiples of irrational numbers.
                let r = |square: f64, from: f64, to: f64| c(from + (to - from) * (f64::from(n) * square.sqrt()).fract());
                let goal = vector![r(2.0, -3.0, 3.0), r(3.0, 0.3, 2.6), r(5.0, 0.0, 0.4), r(6.0, -3.0, 3.0)];
                let start = vector![r(7.0, -3.0, 3.0), r(10.0, -2.5, 2.5), r(11.0, 0.0, 0.4), r(13.0, -3.0, 3.0)];
                clik.approach(&robot, &start, &Pose::of(&robot, &goal), 50_000).unwrap().outcome
            })
            .collect()
    }
    for setting in [[150.0, 1e-3, 1e4, 1e-5], [20.0, 1e-3, 3.0, 1e-5], [5.0, 1e-3, 100.0, 1e-5], [1.0, 1e-3, 1e6, 1e-4]] {
        assert!(outcomes::<f64>(setting).iter().all(|outcome| *outcome == Outcome::Converged), "{setting:?}");
        let single = outcomes::<f32>(setting);
        assert!(
            single.iter().all(|outcome| matches!(outcome, Outcome::Converged | Outcome::OutOfSteps)),
            "{setting:?} {single:?}"
        );
    }
    assert!(outcomes::<f32>([150.0, 1e-3, 1e4, 1e-5]).iter().all(|outcome| *outcome == Outcome::Converged));
}

/// Where one joint is stopped the rate of another one stays what was asked, within its limit.
#[test]
fn a_stopped_joint_leaves_the_rates_of_the_others() {
    let robot = Scara::<f32>::nominal();
    let limits = JointLimits::rates([0.75f32; 4]).unwrap().with_range([-9.0, -9.0, 0.0, -9.0], [9.0, 9.0, 0.1, 9.0]).unwrap();
    let clik = Clik::new(ghost::task(), JacobianInverse::new([500.0f32; 4]).unwrap(), 1e-3, limits, [1e-6; 4]).unwrap();
    for k in 0..100 {
        let q = vector![3.0 + 0.01 * k as f32, 1.0, 0.1, 0.0];
        let goal = Pose::of(&robot, &(q + vector![0.03, 0.01, 0.01, 0.01]));
        let step = clik.step(&robot, &q, &OperationalReference::at_rest(goal)).unwrap();
        assert_eq!((step.outcome, step.dq[2]), (Outcome::JointLimit { joint: 2 }, 0.0));
        assert!((0..4).all(|i| step.dq[i].abs() <= limits.rate()[i]), "{step:?}");
    }
}

#[test]
fn a_damped_step_tells_what_is_left_of_the_error() {
    let robot = ghost::nominal();
    let clik = Clik::new(ghost::task(), damped(), 1e-3, bounded(), [1e-6; 4]).unwrap();
    let q = vector![0.0, 0.01, 0.1, 0.0];
    let at = Pose::of(&robot, &q);
    let outcome = |dx: f64, dy: f64| {
        let goal = Pose { position: at.position + vector![dx, dy, 0.0], ..at };
        clik.step(&robot, &q, &OperationalReference::at_rest(goal)).unwrap().outcome
    };
    // The arm is stretched along x: it cannot move that way, and can move across.
    assert_eq!(outcome(0.1, 0.0), Outcome::OutOfReach);
    // Nor can it move inwards now, although the goal is within reach: an approach, which moves it aside, comes there.
    assert_eq!(outcome(-0.1, 0.0), Outcome::OutOfReach);
    let inwards = Pose { position: at.position - vector![0.1, 0.0, 0.0], ..at };
    assert_eq!(clik.approach(&robot, &q, &inwards, 20_000).unwrap().outcome, Outcome::Converged);
    assert_eq!(outcome(0.0, 0.1), Outcome::Damped);
    assert_eq!(outcome(0.0, 0.0), Outcome::Converged);
}

#[test]
fn rates_are_slowed_down_along_their_direction() {
    let limits = bounded();
    let dq = vector![6.0, -12.0, 1.5, 1.0];
    let Limited { value: slow, is_limited } = limits.slow_down(&dq);
    assert!(is_limited && (slow - dq / 4.0).amax() < 1e-15, "joint 2 sets the pace: {slow}");
    assert_eq!(limits.slow_down(&(dq / 4.0)), Limited { value: dq / 4.0, is_limited: false });
}

#[test]
fn the_distance_from_joint_limits_grows_along_its_gradient() {
    let (lower, upper) = ([-1.0, 0.0, 0.0, -3.0], [3.0, 2.0, 0.4, 3.0]);
    let objective = JointRangeDistance::new(lower, upper).unwrap();
    // w = -1/(2 N) sum ((q - middle) / range)^2.
    let w = |q: &Vector4<f64>| {
        -(0..4).map(|i| ((q[i] - (lower[i] + upper[i]) / 2.0) / (upper[i] - lower[i])).powi(2)).sum::<f64>() / 8.0
    };
    let q = vector![2.0, 0.3, 0.1, -1.0];
    let gradient = objective.gradient(&ghost::nominal(), &q).unwrap();
    for i in 0..4 {
        let mut h = Vector4::zeros();
        h[i] = 1e-6;
        common::close("dw/dq", gradient[i], (w(&(q + h)) - w(&(q - h))) / 2e-6, 1e-9);
    }
    // In use: it keeps joints nearer to the middle of their ranges.
    let range = JointRangeDistance::new([-2.0, -2.6, 0.0, -3.0], [0.0, 2.6, 0.45, 3.0]).unwrap();
    let (_, with) = dexterous(10.0, range);
    let (_, without) = dexterous(0.0, NoObjective);
    println!("theta2 at the end: {} with, {} without", with[1], without[1]);
    assert!(with[1].abs() < without[1].abs());
}
