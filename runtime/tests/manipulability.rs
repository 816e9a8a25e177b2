//! Manipulability of the SCARA at three postures, and its identities.

use crate::common;

use armgen_runtime::{
    manipulability::{
        condition_number, distance_to_singularity, force_ellipsoid, manipulability, manipulability_gradient, velocity_ellipsoid,
    },
    reference::Pose,
    robot::Kinematics,
    task::{Row, Task},
};
use common::{close, ghost};
use nalgebra::{vector, Vector4};
use std::f64::consts::PI;

/// Difference of two directions, deg, in (-90, 90]: an axis has no sign.
fn apart(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(180.0);
    if d > 90.0 {
        d - 180.0
    } else {
        d
    }
}

/// The larger root of s^2 + (d / s)^2 = n.
fn closed_form(n: f64, d: f64) -> f64 {
    ((n + (n * n - 4.0 * d * d).sqrt()) / 2.0).sqrt()
}

#[track_caller]
fn check(q: [f64; 4], x_e: [f64; 4], w: f64, velocity: [f64; 2], degrees: [f64; 2], force: [f64; 2]) {
    let (robot, q) = (ghost::nominal(), Vector4::from(q));
    let pose = Pose::of(&robot, &q);
    let x = pose.position.push(ghost::phi(&pose));
    for i in 0..4 {
        close("x_e", x[i], x_e[i], 6e-10);
    }
    let j6 = robot.geometric_jacobian(&q);
    let full = ghost::task().jacobian(&j6);
    close("w", manipulability(&full), w, 6e-13);
    let planar = Task::new([Row::X, Row::Y]).unwrap().jacobian(&j6);
    let v = velocity_ellipsoid(&planar);
    let f = force_ellipsoid(&planar).unwrap();
    for i in 0..2 {
        // The tabled semi-axes hold to 6e-9 only: their ninth digits contradict w and each other. The closed form below is exact.
        close("velocity semi-axis", v.semi_axes[i], velocity[i], 6e-9);
        close("force semi-axis", f.semi_axes[i], force[i], 6e-9);
        let direction = v.directions[(1, i)].atan2(v.directions[(0, i)]).to_degrees();
        close("direction", apart(direction, degrees[i]), 0.0, 6e-7);
        assert_eq!(v.directions, f.directions);
    }
    // sigma_1^2 + sigma_2^2 = |J|^2 and sigma_1 sigma_2 = |det J|.
    close("closed form", v.semi_axes[0], closed_form(planar.norm_squared(), q[1].sin() / 4.0), 1e-15);
    close("condition", condition_number(&planar).unwrap(), velocity[0] / velocity[1], 1e-5 * velocity[0] / velocity[1]);
    close("distance to singularity", distance_to_singularity(&planar), velocity[1], 6e-9);
    // In space the prismatic joint adds an axis of length 1 along z, and the area in the plane stays.
    let space = Task::new([Row::X, Row::Y, Row::Z]).unwrap().jacobian(&j6);
    let v3 = velocity_ellipsoid(&space);
    close("product of the semi-axes", v3.semi_axes.product(), velocity[0] * velocity[1], 6e-9);
    let z = (0..3).find(|i| v3.directions[(2, *i)].abs() > 0.999).unwrap();
    close("semi-axis along z", v3.semi_axes[z], 1.0, 1e-15);
}

#[test]
fn posture_1() {
    check(
        [0.0, PI / 2.0, 0.0, 0.0],
        [0.5, 0.5, 0.5, PI / 2.0],
        0.25,
        [0.809016994, 0.309016994],
        [-31.717474, 58.282526],
        [1.236067977, 3.236067977],
    );
}

#[test]
fn posture_2() {
    check(
        [PI / 4.0, PI / 4.0, 0.1, PI / 18.0],
        [0.353553391, 0.853553391, 0.4, 1.396263402],
        0.176776695297,
        [1.036566087, 0.170540690],
        [-17.632195, 72.367805],
        [0.964723821, 5.863703305],
    );
}

#[test]
fn posture_3() {
    check(
        [0.0, 5f64.to_radians(), 0.0, 0.0],
        [0.998097349, 0.043577871, 0.5, 0.087266463],
        0.021788935687,
        [1.117012463, 0.019506439],
        [93.000457, 3.000457],
        [0.895245160, 51.265122884],
    );
}

#[test]
fn w_is_the_sine_of_the_elbow_and_its_gradient_follows() {
    let robot = ghost::nominal();
    let relaxed = Task::new([Row::Y, Row::Z, Row::Rz]).unwrap();
    for k in -31..=31 {
        let q = vector![0.3, 0.1 * f64::from(k), 0.2, 0.4];
        let w = manipulability(&ghost::task().jacobian(&robot.geometric_jacobian(&q)));
        close("w", w, q[1].sin().abs() / 4.0, 1e-15);
        if k == 0 {
            assert!(manipulability_gradient(&robot, &ghost::task(), &q).is_none());
            continue;
        }
        let gradient = manipulability_gradient(&robot, &ghost::task(), &q).unwrap();
        let expected = vector![0.0, q[1].cos() * q[1].sin().signum() / 4.0, 0.0, 0.0];
        assert!((gradient - expected).amax() < 1e-14, "{gradient}");
        let w = |q: &Vector4<f64>| manipulability(&relaxed.jacobian(&robot.geometric_jacobian(q)));
        let gradient = manipulability_gradient(&robot, &relaxed, &q).unwrap();
        for i in 0..4 {
            let mut h = Vector4::zeros();
            h[i] = 1e-6;
            close("dw/dq of the relaxed task", gradient[i], (w(&(q + h)) - w(&(q - h))) / 2e-6, 1e-8);
        }
    }
}

#[test]
fn at_a_singular_posture() {
    let q = vector![0.3, 0.0, 0.2, 0.4];
    let j = Task::new([Row::X, Row::Y]).unwrap().jacobian(&ghost::nominal().geometric_jacobian(&q));
    assert!(distance_to_singularity(&j) < 1e-16);
    assert!(force_ellipsoid(&j).is_none() && condition_number(&j).is_none());
    assert_eq!(manipulability(&j), 0.0);
    // Rounding leaves a singular value of some 1e-17 at many of them.
    for k in 0..1000 {
        let q = vector![0.01 * f64::from(k), if k % 2 == 0 { 0.0 } else { PI }, 0.2, 0.4];
        let j = Task::new([Row::X, Row::Y]).unwrap().jacobian(&ghost::nominal().geometric_jacobian(&q));
        assert!(force_ellipsoid(&j).is_none() && condition_number(&j).is_none(), "{q} {:?}", condition_number(&j));
    }
    let near = Task::new([Row::X, Row::Y]).unwrap().jacobian(&ghost::nominal().geometric_jacobian(&vector![0.3, 1e-9, 0.2, 0.4]));
    // sigma_1^2 + sigma_2^2 = |J|^2 = 5/4 and sigma_1 sigma_2 = sin(theta2)/4.
    close("condition", condition_number(&near).unwrap(), 5e9, 1e4);
}
