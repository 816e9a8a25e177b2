//! Not one allocation in any step of a controller, a trajectory or CLIK, error paths included.

use crate::common;

use allocation_counter::measure;
use armgen_runtime::{
    clik::{
        Clik, DampedLeastSquares, Integration, JacobianInverse, JacobianTranspose, JointLimits, JointRangeDistance, Limited,
        Manipulability, PseudoInverse,
    },
    control::{
        self, Adaptive, Admittance, BoundaryLayer, FrictionCompensation, HandGuiding, Impedance, Interval, InverseDynamics,
        NullSpace, OperationalSpace, PdGravity, Robust, TorqueLimits, Walls,
    },
    linalg::{quadratic_program, Damping},
    manipulability::{
        condition_number, distance_to_singularity, force_ellipsoid, manipulability, manipulability_gradient, velocity_ellipsoid,
    },
    reference::{JointReference, OperationalReference, Pose, State},
    robot::Kinematics,
    task::{Row, Task},
    trajectory::{JointSegment, JointTrajectory, Path, Segment, TimeLaw},
};
use common::{ghost, scara::NOMINAL};
use nalgebra::vector;
use std::{hint::black_box, time::Duration};

/// Runs `step` and expects no allocation at all.
#[track_caller]
fn none<T>(what: &str, step: impl FnOnce() -> T) -> T {
    let mut result = None;
    let info = measure(|| result = Some(black_box(step())));
    assert_eq!(info.count_total, 0, "{what}: {info:?}");
    result.unwrap()
}

fn states() -> [State<f64, 4>; 5] {
    let q = ghost::start();
    [
        State::at_rest(q),
        State { q, dq: vector![3.0, -2.0, 1.0, 5.0] },
        // The singular posture.
        State::at_rest(vector![0.3, 0.0, 0.2, 0.4]),
        State { q, dq: vector![0.0, f64::NAN, 0.0, 0.0] },
        State { q: vector![f64::INFINITY, 1.0, 0.0, 0.0], dq: vector![0.0, 0.0, 0.0, 0.0] },
    ]
}

#[test]
fn the_counter_counts() {
    assert!(measure(|| drop(black_box(vec![1u8; 100]))).count_total > 0);
}

#[test]
fn joint_space_controllers() {
    let model = ghost::nominal();
    let limits = TorqueLimits::new([30.0, 15.0, 120.0, 2.0]).unwrap();
    let layer = BoundaryLayer { rho: 10.0, epsilon: 0.2 };
    let (k_p, k_d) = ([1000.0, 1000.0, 2000.0, 1000.0], [10.0, 10.0, 50.0, 1.0]);
    let pd = PdGravity::new(k_p, k_d).unwrap().with_torque_limits(limits);
    let inverse = InverseDynamics::new(k_p, k_d).unwrap().with_torque_limits(limits);
    let robust = Robust::new(k_p, k_d, [1.0; 4], [1.0; 4], layer).unwrap().with_torque_limits(limits);
    let mut adaptive = Adaptive::new([500.0; 4], k_d, [10.0; 14], NOMINAL, 1e-3)
        .unwrap()
        .with_projection(Interval::new([0.0; 14], [50.0; 14]).unwrap())
        .with_torque_limits(limits);
    let good = JointReference::at_rest(ghost::start());
    let bad = JointReference { ddq: vector![0.0, 0.0, f64::NAN, 0.0], ..good };
    let (mut torques, mut errors) = (0, 0);
    for measured in states() {
        for reference in [good, bad] {
            for refused in [
                none("PD", || pd.torque(&model, &reference, &measured)).is_err(),
                none("inverse dynamics", || inverse.torque(&model, &reference, &measured)).is_err(),
                none("robust", || robust.torque(&model, &reference, &measured)).is_err(),
                none("adaptive", || adaptive.torque(&model, &reference, &measured)).is_err(),
            ] {
                *(if refused { &mut errors } else { &mut torques }) += 1;
            }
        }
    }
    assert_eq!((torques, errors), (12, 28), "three good states under one good reference, four controllers");
}

#[test]
fn operational_space_controllers() {
    let model = ghost::nominal();
    let controller = |k_i| OperationalSpace::new(ghost::task(), [1e4; 4], [200.0; 4], [k_i; 4], 1e-3).unwrap();
    let limits = TorqueLimits::new([30.0, 15.0, 120.0, 2.0]).unwrap();
    let null_space = NullSpace::new([10.0; 4], [10.0; 4], [0.0; 4]).unwrap();
    let damping = Damping::below(0.03).at_most(0.1).unwrap();
    let mut plain = controller(0.0);
    let mut full = controller(1e5)
        .with_damping(damping)
        .with_null_space(null_space)
        .with_torque_limits(limits)
        .with_integral_limit([1e-3; 4])
        .unwrap();
    let joints = JointLimits::rates([3.0, 3.0, 1.0, 6.0]).unwrap().with_acceleration([10.0; 4]).unwrap();
    let mut limited = control::Limited::new(full, limits, joints, 8e-3, 0.7).unwrap();
    let good = ghost::ghost::<f64>().sample(Duration::from_millis(4321));
    let mut bad = good;
    bad.pose.rotation[(1, 1)] = f64::NAN;
    let mut errors = 0;
    for measured in states() {
        for reference in [good, bad] {
            errors += usize::from(none("limited", || limited.torque(&model, &reference, &measured)).is_err());
            errors += usize::from(none("plain", || plain.torque(&model, &reference, &measured)).is_err());
            errors += usize::from(none("full", || full.torque(&model, &reference, &measured)).is_err());
        }
    }
    assert_eq!(errors, 7 + 7 + 8, "the plain one errs at the singular posture, too");
}

#[test]
fn laws_for_hands() {
    let model = ghost::nominal();
    let null_space = NullSpace::new([10.0; 4], [10.0; 4], [0.0; 4]).unwrap();
    let friction = FrictionCompensation::new(0.5, 0.01).unwrap();
    let impedance = Impedance::new(ghost::task(), [1e3; 4], 0.7).unwrap().with_null_space(null_space);
    let impedance = impedance.with_friction_compensation(friction).with_slowest(3.0).unwrap();
    let walls = Walls::new([-3.0, -2.6, 0.0, -6.0], [3.0, 2.6, 0.45, 6.0], [0.1; 4], [100.0; 4], [1.0; 4]).unwrap();
    let guiding = HandGuiding::new([10.0; 4]).unwrap().with_walls(walls).with_friction_compensation(friction);
    let mut guiding = guiding.with_hold([2.0; 4], [100.0; 4], [1.0; 4]).unwrap().with_speed_cap([1.0; 4], [5.0; 4]).unwrap();
    let mut admittance = Admittance::new(ghost::task(), [1.0; 4], [10.0; 4], [100.0; 4], 1e-3).unwrap();
    let good = ghost::ghost::<f64>().sample(Duration::from_millis(4321));
    let mut bad = good;
    bad.pose.rotation[(1, 1)] = f64::NAN;
    let mut errors = 0;
    for measured in states() {
        errors += usize::from(none("guiding", || guiding.torque(&model, &measured)).is_err());
        for reference in [good, bad] {
            errors += usize::from(none("impedance", || impedance.torque(&model, &reference, &measured)).is_err());
            errors += usize::from(none("admittance", || admittance.step(&reference, &measured.q)).is_err());
        }
    }
    assert_eq!(errors, 2 + 7 + 6, "two states are broken for guiding and the impedance, one force for the admittance");
    let h = nalgebra::Matrix4::identity();
    let rows = -nalgebra::Matrix4::identity();
    none("a program", || quadratic_program(&h, &vector![-1.0, 2.0, -3.0, 4.0], &[rows], &[vector![-0.5, -0.5, -0.5, -0.5]]))
        .unwrap();
    none("no point", || quadratic_program(&h, &vector![0.0, 0.0, 0.0, 0.0], &[rows * 0.0], &[vector![1.0, 0.0, 0.0, 0.0]]))
        .unwrap_err();
}

#[test]
fn clik() {
    let robot = ghost::nominal();
    let limits =
        JointLimits::rates([3.0, 3.0, 1.0, 6.0]).unwrap().with_range([-3.0, -2.6, 0.0, -6.0], [3.0, 2.6, 0.45, 6.0]).unwrap();
    let damping = Damping::below(0.03).at_most(0.1).unwrap();
    let relaxed = Task::new([Row::Y, Row::Z, Row::Rz]).unwrap();
    let inverse = Clik::new(ghost::task(), JacobianInverse::new([50.0; 4]).unwrap(), 1e-3, limits, [1e-6; 4]).unwrap();
    let transpose = Clik::new(ghost::task(), JacobianTranspose::new([50.0; 4]).unwrap(), 1e-3, limits, [1e-6; 4]).unwrap();
    let damped = Clik::new(ghost::task(), DampedLeastSquares::new([50.0; 4], damping).unwrap(), 1e-3, limits, [1e-6; 4]).unwrap();
    let climb = PseudoInverse::new([50.0; 3], 10.0, Manipulability { task: ghost::task() }).unwrap();
    let climb = Clik::new(relaxed, climb, 1e-3, limits, [1e-6; 3]).unwrap();
    let range = JointRangeDistance::new([-3.0, -2.6, 0.0, -6.0], [3.0, 2.6, 0.45, 6.0]).unwrap();
    let range = PseudoInverse::new([50.0; 3], 10.0, range).unwrap().with_damping(damping);
    let range = Clik::new(relaxed, range, 1e-3, limits, [1e-6; 3]).unwrap();
    let limited = Limited::new(ghost::task(), [50.0; 4], 1e-3, limits.with_acceleration([10.0; 4]).unwrap()).unwrap();
    let second = ghost::second_order(Integration::HoldConsistent);
    let second_damped = ghost::second_order(Integration::ExplicitEuler).with_damping(damping);
    let good = ghost::ghost::<f64>().sample(Duration::from_millis(4321));
    let far = OperationalReference::at_rest(Pose { position: vector![3.0, 0.0, 0.0], ..good.pose });
    let mut bad = good;
    bad.velocity[0] = f64::NAN;
    let mut errors = 0;
    for state in states() {
        for reference in [good, far, bad] {
            let q = &state.q;
            errors += usize::from(none("inverse", || inverse.step(&robot, q, &reference)).is_err());
            errors += usize::from(none("transpose", || transpose.step(&robot, q, &reference)).is_err());
            errors += usize::from(none("damped", || damped.step(&robot, q, &reference)).is_err());
            errors += usize::from(none("pseudo-inverse, w", || climb.step(&robot, q, &reference)).is_err());
            errors += usize::from(none("pseudo-inverse, range", || range.step(&robot, q, &reference)).is_err());
            errors += usize::from(none("limited", || limited.step(&robot, &state, &reference)).is_err());
            errors += usize::from(none("second order", || second.step(&robot, &state, &reference)).is_err());
            errors += usize::from(none("second order, damped", || second_damped.step(&robot, &state, &reference)).is_err());
        }
        none("approach", || damped.approach(&robot, &state.q, &far.pose, 1000)).ok();
    }
    assert!(errors > 30, "{errors}");
}

#[test]
fn trajectories_manipulability_and_plans() {
    let trajectory = none("planning", ghost::ghost::<f64>);
    for k in (0..22_000).step_by(37) {
        none("sampling", || trajectory.sample(Duration::from_millis(k)));
    }
    let law = TimeLaw::Quintic { duration: Duration::from_secs(1) };
    let joints = JointTrajectory::plan(
        [0.0; 4],
        [JointSegment::to([1.0; 4], law), JointSegment::within_limits([0.0; 4], [1.0; 4], [2.0; 4])],
    )
    .unwrap();
    none("joint space", || joints.sample(Duration::from_millis(1234)));
    let error = none("a plan that cannot be", || Path::plan([0.0; 3], [Segment::line([f64::NAN, 0.0, 0.0], law)]).unwrap_err());
    assert_eq!(error.segment, 1);
    none("reach", || trajectory.check_reach(&ghost::reach(), Duration::from_millis(10))).unwrap();
    let robot = ghost::nominal();
    for state in states() {
        let j = ghost::task().jacobian(&robot.geometric_jacobian(&state.q));
        none("manipulability", || {
            (manipulability(&j), velocity_ellipsoid(&j), force_ellipsoid(&j), condition_number(&j), distance_to_singularity(&j))
        });
        none("its gradient", || manipulability_gradient(&robot, &ghost::task(), &state.q));
    }
}
