//! Compares the hand-written SCARA, on which the other tests rely, with the check values of its closed forms.

use crate::common;

use armgen_runtime::{
    reference::Pose,
    robot::{Dynamics, Kinematics, Regressor},
    task::Task,
};
use common::{ghost, scara::Scara};
use nalgebra::{vector, Vector4};

#[track_caller]
fn check(value: Vector4<f64>, expected: [f64; 4]) {
    assert!((value - Vector4::from(expected)).amax() < 1e-13, "{value} {expected:?}");
}

#[test]
fn the_check_state() {
    let scara = Scara::<f64>::nominal();
    let (q, dq) = (vector![0.3, 1.1, 0.2, 0.4], vector![0.5, -0.7, 0.3, 1.0]);
    let (a, r) = (vector![1.0, 2.0, -1.0, 0.5], vector![0.4, -0.6, 0.25, 0.9]);
    check(scara.inverse_dynamics(&q, &dq, &a), [48.80571515657605, 29.41995480720468, -113.85, -0.36]);
    let y = scara.regressor(&q, &dq, &r, &a) * scara.parameters();
    check(y, [48.58290831656069, 29.197157967189323, -115.1, -0.56]);
    check(scara.coriolis_matrix(&q, &dq) * dq, [0.9357677280645073, 1.1140092000767943, 0.0, 0.0]);
    check(scara.coriolis_matrix(&q, &dq) * r, [0.7129658880491484, 0.8912073600614354, 0.0, 0.0]);
    let tau = Vector4::zeros();
    let free = Scara::<f64>::loaded().forward_dynamics(&q, &dq, &tau);
    check(free, [0.05371154081148763, -0.24057622390045058, 5.076483048335555, -1.5647156976791017]);
    let pose = Pose::of(&scara, &q);
    check(pose.position.push(ghost::phi(&pose)), [0.5626518160129234, 0.6404849683248999, 0.3, 1.0]);
    let bias = ghost::task().jacobian(&scara.geometric_jacobian_dot(&q, &dq)) * dq;
    check(bias, [-0.12281640399870557, -0.056649020432436636, 0.0, 0.0]);
}

#[test]
fn link_frames_end_in_the_end_effector_and_the_jacobian_is_its_derivative() {
    let scara = Scara::<f64>::nominal();
    let (q, dq) = (vector![0.3, 1.1, 0.2, 0.4], vector![0.5, -0.7, 0.3, 1.0]);
    assert!((scara.link_frames(&q)[3] - scara.direct_kinematics(&q)).amax() < 1e-15);
    let h = 1e-6;
    let (a, b) = (Pose::of(&scara, &(q - dq * h)), Pose::of(&scara, &(q + dq * h)));
    let v = Task::full().error(&b, &a) / (2.0 * h);
    assert!((v - scara.geometric_jacobian(&q) * dq).amax() < 1e-9);
    let dj = (scara.geometric_jacobian(&(q + dq * h)) - scara.geometric_jacobian(&(q - dq * h))) / (2.0 * h);
    assert!((dj - scara.geometric_jacobian_dot(&q, &dq)).amax() < 1e-9);
}
