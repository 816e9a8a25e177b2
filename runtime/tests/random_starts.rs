//! From anywhere, to anywhere: rates stay bounded, and every end has a name.

use crate::common;

use armgen_runtime::{
    clik::{Clik, ClikError, DampedLeastSquares, Integration, JacobianTranspose, JointLimits, Outcome, SecondOrder},
    control::{ControlError, OperationalSpace, TorqueLimits},
    linalg::{Damping, RightInverse},
    manipulability::{manipulability, velocity_ellipsoid},
    orientation::{quaternion, quaternion_error, rotation, rotation_vector, sine_error},
    reference::{OperationalReference, Pose, State},
    robot::Kinematics,
    simulation::{Integrator, Plant},
    trajectory::TimeLaw,
};
use common::ghost;
use nalgebra::{vector, SMatrix, Unit, Vector3, Vector4};
use proptest::{prelude::*, test_runner::RngSeed};
use std::{f64::consts::PI, time::Duration};

const RATES: [f64; 4] = [3.0, 3.0, 1.0, 6.0];
const LOWER: [f64; 4] = [-3.0, -2.6, 0.0, -7.0];
const UPPER: [f64; 4] = [3.0, 2.6, 0.5, 7.0];

fn limits() -> JointLimits<f64, 4> {
    JointLimits::rates(RATES).unwrap().with_range(LOWER, UPPER).unwrap()
}

/// Any posture within the joint limits; one in four with a joint at its limit or the elbow stretched or folded.
fn posture() -> impl Strategy<Value = Vector4<f64>> {
    let inside = (LOWER[0]..UPPER[0], LOWER[1]..UPPER[1], LOWER[2]..UPPER[2], LOWER[3]..UPPER[3]);
    (inside, 0..8usize).prop_map(|((a, b, c, d), special)| {
        let mut q = vector![a, b, c, d];
        match special {
            0 => q[1] = 0.0,
            1 => q[2] = UPPER[2],
            _ => {}
        }
        q
    })
}

/// Any goal: in reach, out of reach, above and below.
fn goal() -> impl Strategy<Value = Pose<f64>> {
    (-1.3..1.3f64, -1.3..1.3f64, -0.2..0.7f64, -PI..PI).prop_map(|(x, y, z, phi)| Pose {
        position: vector![x, y, z],
        rotation: rotation(&Vector3::z_axis(), phi) * ghost::reference_frame::<f64>(),
    })
}

fn within_rates(before: &Vector4<f64>, after: &Vector4<f64>) -> bool {
    (0..4).all(|i| (after[i] - before[i]).abs() <= RATES[i] * 1e-3 * (1.0 + 1e-9))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn damped_least_squares(start in posture(), goal in goal()) {
        let robot = ghost::nominal();
        let algorithm = DampedLeastSquares::new([20.0; 4], Damping::below(0.03).at_most(0.1).unwrap()).unwrap();
        let clik = Clik::new(ghost::task(), algorithm, 1e-3, limits(), [1e-6; 4]).unwrap();
        let reference = OperationalReference::at_rest(goal);
        let mut q = start;
        for _ in 0..2000 {
            let step = clik.step(&robot, &q, &reference).unwrap();
            prop_assert!(within_rates(&q, &step.q), "{step:?}");
            prop_assert!((0..4).all(|i| step.q[i] >= LOWER[i] && step.q[i] <= UPPER[i]));
            prop_assert_eq!(step.outcome == Outcome::Converged, step.error.amax() <= 1e-6);
            q = step.q;
        }
        let end = clik.approach(&robot, &start, &goal, 20_000).unwrap();
        let reachable = goal.position.xy().norm();
        match end.outcome {
            Outcome::Converged => prop_assert!(end.error.amax() <= 1e-6),
            Outcome::OutOfReach => prop_assert!(!(0.3..=0.9).contains(&reachable), "{end:?}"),
            Outcome::JointLimit { joint } => prop_assert!(
                end.q[joint] == LOWER[joint] || end.q[joint] == UPPER[joint], "{end:?}"
            ),
            Outcome::OutOfSteps => {}
            other => prop_assert!(false, "an approach does not end as {other:?}"),
        }
        if reachable > 1.0 + 1e-3 {
            prop_assert!(end.outcome != Outcome::Converged);
        }
    }

    #[test]
    fn transpose(start in posture(), goal in goal()) {
        let robot = ghost::nominal();
        let algorithm = JacobianTranspose::new([200.0, 200.0, 400.0, 100.0]).unwrap();
        let clik = Clik::new(ghost::task(), algorithm, 1e-3, limits(), [1e-6; 4]).unwrap();
        let end = clik.approach(&robot, &start, &goal, 20_000).unwrap();
        prop_assert!(end.q.iter().all(|x| x.is_finite()));
        prop_assert!((end.outcome == Outcome::Converged) == (end.error.amax() <= 1e-6), "{end:?}");
    }

    #[test]
    fn second_order(start in posture(), goal in goal(), consistent in any::<bool>()) {
        let robot = ghost::nominal();
        let integration = if consistent { Integration::HoldConsistent } else { Integration::ExplicitEuler };
        let clik = SecondOrder::new(ghost::task(), [100.0; 4], [20.0; 4], 1e-3, integration, limits(), [1e-6; 4]).unwrap();
        let reference = OperationalReference::at_rest(goal);
        let mut state = State::at_rest(start);
        for _ in 0..2000 {
            match clik.step(&robot, &state, &reference) {
                Ok(step) => {
                    prop_assert!((0..4).all(|i| step.next.dq[i].abs() <= RATES[i]), "{step:?}");
                    prop_assert!((0..4).all(|i| step.next.q[i] >= LOWER[i] && step.next.q[i] <= UPPER[i]), "{step:?}");
                    state = step.next;
                }
                Err(error) => {
                    prop_assert_eq!(error, ClikError::Singular);
                    break;
                }
            }
        }
    }

    #[test]
    fn operational_space_control(start in posture(), goal in goal(), dq in prop::array::uniform4(-2.0..2.0f64)) {
        let (model, arm) = (ghost::nominal(), ghost::loaded());
        let bound = [60.0, 30.0, 300.0, 10.0];
        let mut controller = OperationalSpace::new(ghost::task(), [100.0; 4], [20.0; 4], [10.0; 4], 1e-3)
            .unwrap()
            .with_damping(Damping::below(0.05).at_most(0.2).unwrap())
            .with_torque_limits(TorqueLimits::new(bound).unwrap());
        let reference = OperationalReference::at_rest(goal);
        let mut plant = Plant::new(&arm, State { q: start, dq: dq.into() }, Integrator::RungeKutta4 { substeps: 2 });
        for _ in 0..1000 {
            match controller.torque(&model, &reference, plant.state()) {
                Ok(torque) => {
                    prop_assert!((0..4).all(|i| torque.tau[i].abs() <= bound[i]));
                    plant.advance(&torque.tau, 1e-3).unwrap();
                    prop_assert!(plant.state().is_finite());
                    // The work of bounded torques is bounded, and so are the rates.
                    prop_assert!(plant.state().dq.amax() < 100.0, "{:?}", plant.state());
                }
                Err(error) => prop_assert!(matches!(error, ControlError::TorqueNotFinite | ControlError::StateNotFinite | ControlError::AccelerationNotFinite), "{error}"),
            }
        }
    }

    #[test]
    fn orientation_errors(axis in prop::array::uniform3(-1.0..1.0f64), angle in 0.0..PI, base in prop::array::uniform3(-1.0..1.0f64)) {
        let axis = Vector3::from(axis);
        prop_assume!(axis.norm() > 1e-3);
        let unit = Unit::new_normalize(axis);
        let actual = rotation(&Unit::new_normalize(Vector3::from(base) + Vector3::new(1e-9, 0.0, 0.0)), 1.0);
        let desired = rotation(&unit, angle) * actual;
        prop_assert!((rotation_vector(&(desired * actual.transpose())) - unit.into_inner() * angle).norm() < 1e-13);
        prop_assert!((sine_error(&desired, &actual) - unit.into_inner() * angle.sin()).norm() < 1e-14);
        let q = quaternion_error(&quaternion(&desired), &quaternion(&actual));
        prop_assert!((q - unit.into_inner() * (angle / 2.0).sin()).norm() < 1e-14);
    }

    #[test]
    fn w_is_the_product_of_the_semi_axes(rows in prop::collection::vec(-2.0..2.0f64, 15)) {
        let j = SMatrix::<f64, 3, 5>::from_iterator(rows);
        let w = manipulability(&j);
        prop_assert!((velocity_ellipsoid(&j).semi_axes.product() - w).abs() <= 1e-12 * (1.0 + w));
        if let Some(inverse) = RightInverse::new(&j) {
            let identity = j * inverse.matrix();
            let condition = armgen_runtime::manipulability::condition_number(&j).unwrap();
            prop_assert!((identity - SMatrix::<f64, 3, 3>::identity()).norm() < 1e-14 * condition);
        }
    }

    #[test]
    fn laws_run_from_0_to_1_and_keep_their_limits(length in 1e-4..10.0f64, v in 0.01..5.0f64, a in 0.01..20.0f64) {
        let profile = TimeLaw::TrapezoidalByLimits { velocity: v, acceleration: a }.resolve(length).unwrap();
        let mut before = 0.0;
        for k in 0..=200u32 {
            let p = profile.at(profile.duration() * k / 200);
            prop_assert!(p.s >= before && p.s <= 1.0 && p.ds * length <= v && p.dds.abs() * length <= a);
            before = p.s;
        }
        prop_assert_eq!(before, 1.0);
        // No shorter: with these limits it cannot be.
        let shortest = if length * a < v * v { 2.0 * (length / a).sqrt() } else { length / v + v / a };
        prop_assert!(profile.duration() <= Duration::from_secs_f64(shortest) + Duration::from_nanos(4));
    }

    #[test]
    fn the_stretched_arm_is_seen(q1 in -PI..PI, d in 0.0..0.5f64) {
        let j = ghost::task().jacobian(&ghost::nominal().geometric_jacobian(&vector![q1, 0.0, d, 0.0]));
        prop_assert!(manipulability(&j) < 1e-15);
    }
}
